"""The style, colours, marks and legends of all figures, and functions that save figures."""

import io
import math
import re
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.figure
import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogFormatter, NullFormatter

from bearingwear.atomic import OutputError, whole_file
from bearingwear.kernels.status import OK
from bearingwear.results.pair_variables import method_words
from bearingwear.results.units import Display
from bearingwear.results.words import friction_text, methods

STYLE = Path(__file__).with_name("style.mplstyle")

COLOURS = {"constant_force": "C0", "fixed_position": "C1"}
"""Colours of the preload methods in every figure; nothing else has these colours."""
SERIES = ("C2", "C3", "C4", "C5", "black", "0.55")
"""Colours of all other lines."""
MARKERS = "osd^vP"
RACE_STYLES = {
    "inner": {"linestyle": "-", "marker": "o"},
    "outer": {"linestyle": "--", "marker": "s"},
}
BALL_STYLE: dict[str, Any] = {"linestyle": ":", "marker": "^"}
FORMATS = (".svg", ".png", ".pdf")
"""Formats that can be written without a time stamp."""
DASHES = ("-", "--", ":", "-.")
CHARACTERS_PER_INCH = 14
MESSAGE = "message"
"""The id of the group with the title in an SVG."""
FOOT, SLOT = 0.03, 0.06
"""Position of the lowest row of crosses, and height of a row, as shares of a panel's height."""
HEADROOM = 1.05
"""Factor by which `start_at_zero` raises the upper end of an ordinate."""
FAILED = {"linestyle": "none", "marker": "x", "markersize": 7, "markeredgewidth": 2.0}

ABSCISSAE = {
    "friction": "ball/race friction coefficient µ",
    "ball_diameter_loss": "loss of ball diameter (µm)",
    "preload": "initial preload (N)",
    "cage_friction": "friction coefficient of the cage",
}

Figure = matplotlib.figure.Figure


class HouseFigure(Figure):
    """A figure that has the style of the package wherever it is saved or shown.

    data_files: names of the files that it was drawn from, which an SVG states.
    """

    data_files: tuple[str, ...] = ()

    def savefig(self, *args: Any, **kwargs: Any) -> None:
        """Saves the figure in the style of the package; arguments are those of Matplotlib."""
        with matplotlib.style.context(["default", STYLE]):
            super().savefig(*args, **kwargs)

    def _repr_png_(self) -> bytes:
        """Returns the figure as PNG, for a notebook."""
        file = io.BytesIO()
        self.savefig(file, format="png")
        return file.getvalue()


def new_figure(
    rows: int, columns: int, width: float, height: float, **kwargs: Any
) -> tuple[Figure, np.ndarray]:
    """Returns a figure and its panels, an array (rows, columns), in the style of the package.

    It changes `rcParams` of Matplotlib permanently, to the defaults and this style.

    width, height: of the figure [in].
    **kwargs: of `Figure.subplots`.
    """
    matplotlib.rcdefaults()
    matplotlib.style.use(STYLE)
    figure = HouseFigure(figsize=(width, height))
    return figure, figure.subplots(rows, columns, squeeze=False, **kwargs)


def with_data_files(figure: Figure, *paths: str | Path) -> Figure:
    """Stores in a figure the files that it was drawn from, and returns the figure."""
    figure.data_files = tuple(map(str, paths))  # type: ignore[attr-defined]
    return figure


DATA_SEPARATOR = "; "
"""Separator of the names of files that an SVG states as its source."""


def save(figure: Figure, paths: Iterable[str | Path]) -> None:
    """Writes a figure in the format of each suffix, without a time stamp.

    An SVG contains the message of the figure as `title`, and its labels as `description`. The
    figure itself changes: logarithmic axes get plain labels, and its layout is fixed.

    OutputError: a file cannot be written, or a suffix has no format; then nothing is written.
    """
    suffixes = {path: path.suffix.lower() for path in map(Path, paths)}
    for path, suffix in suffixes.items():
        if suffix not in FORMATS:
            allowed = ", ".join(FORMATS)
            raise OutputError(f"{path}: got the suffix {path.suffix!r}, expected {allowed}")
    metadata = {".svg": _svg_metadata(figure), ".png": {}, ".pdf": {"CreationDate": None}}
    _set_plain_log_labels(figure)
    if layout := figure.get_layout_engine():
        # once for all formats, because the layout takes longer than drawing
        layout.execute(figure)
        figure.set_layout_engine("none")
    for path, suffix in suffixes.items():
        with whole_file(path) as part:
            figure.savefig(part, format=suffix[1:], metadata=metadata[suffix])


def _set_plain_log_labels(figure: Figure) -> None:
    """Labels only the major ticks of logarithmic axes, with plain numbers.

    Matplotlib's own labels require mathtext. The style switches it off, since figures contain names
    from scenes.
    """
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if isinstance(axis.get_major_formatter(), LogFormatter):
                axis.set_major_formatter(FuncFormatter(lambda value, _: number_on_axis(value)))
                axis.set_minor_formatter(NullFormatter())


def _svg_metadata(figure: Figure) -> dict[str, str | None]:
    """Returns message, labels and data files as SVG metadata, for readers who see no figure."""
    ordinates = _distinct_texts(axes.get_ylabel() for axes in figure.axes)
    abscissae = _distinct_texts(axes.get_xlabel() for axes in figure.axes)
    panels = _distinct_texts(axes.get_title(loc="left") for axes in figure.axes)
    keys = _distinct_texts(
        text.get_text() for legend in figure.legends for text in legend.get_texts()
    )
    sentences = [f"{ordinates} against {abscissae}"]
    if panels:
        sentences.append(f"Panels: {panels}")
    if keys:
        sentences.append(f"Legend: {keys}")
    files = getattr(figure, "data_files", ())
    return {
        "Title": figure.get_suptitle().replace("\n", " "),
        "Description": ". ".join(sentences),
        "Source": DATA_SEPARATOR.join(files) or None,
        "Date": None,
    }


def _distinct_texts(texts: Iterable[str]) -> str:
    """Returns the texts that are not empty, each once, separated by commas."""
    return ", ".join(dict.fromkeys(text.replace("\n", " ") for text in texts if text))


def mark_failed(
    axes: Any, abscissae: xr.DataArray, status: xr.DataArray, color: str, slot: int
) -> bool:
    """Draws a cross at the foot of a panel for each unsolved case; returns whether there is one.

    abscissae: of each case.
    status: of each case; all but `OK` are unsolved.
    slot: row of the crosses, 0 at the foot; each line of the panel has its own, so that crosses do
        not hide each other.
    """
    failed = abscissae.values[status.values != OK]
    if failed.size:
        height = np.full(failed.size, FOOT + SLOT * slot)
        at_foot = {"transform": axes.get_xaxis_transform(), "clip_on": False, "zorder": 5}
        axes.plot(failed, height, color=color, **FAILED, **at_foot)
    return bool(failed.size)


def list_failed(axes: Any, names: list[str]) -> None:
    """Writes the names of the lines that were not solved into the upper left corner of a panel.

    names: if empty, nothing is written.
    """
    if names:
        text = "\n".join(["not solved:", *names])
        axes.text(0.02, 0.98, text, transform=axes.transAxes, color="crimson", va="top")


def key(label: str, **style: Any) -> Line2D:
    """Returns an entry of a legend: a line without points, whose style is as in Matplotlib."""
    return Line2D([], [], label=label, **style)


def method_keys(names: Iterable[str], scene: Mapping[str, Any] | None = None) -> list[Line2D]:
    """Returns a legend entry for each preload method; for a pair, under the name of its kind.

    scene: plain data; by default that of a single bearing.
    """
    return [
        key(method_words(scene or {}, name), color=COLOURS[name], linewidth=3) for name in names
    ]


def race_keys() -> list[Line2D]:
    """Returns legend entries of the contacts with each race, and of both contacts of a ball."""
    keys = [key(f"{race} contact", color="0.3", **style) for race, style in RACE_STYLES.items()]
    return [*keys, key("ball, both contacts", color="0.3", **BALL_STYLE)]


def dashes(frictions: Iterable[float]) -> dict[float, str]:
    """Returns a line style of Matplotlib for each friction coefficient; they repeat after four."""
    return {mu: DASHES[k % len(DASHES)] for k, mu in enumerate(frictions)}


def dash_keys(styles: dict[float, str]) -> list[Line2D]:
    """Returns a legend entry for each friction coefficient.

    styles: line style by friction coefficient, as from `dashes`.
    """
    return [key(friction_text(mu), color="0.3", linestyle=dash) for mu, dash in styles.items()]


def draw_lines(
    panel: Any,
    values: xr.DataArray,
    axis: str,
    label: str = "",
    unit: Display | None = None,
    status: xr.DataArray | None = None,
    **look: Any,
) -> bool:
    """Draws a quantity over an axis: a colour for each preload method, a line style for each race.

    It also sets the labels of the axes, and returns whether there is a cross for an unsolved case.

    values: over `axis` and, optionally, `preload_method` and `race`.
    axis: dimension along the abscissa, a key of `ABSCISSAE`.
    label: of the ordinate, without unit.
    unit: in which the values are shown; by default that of the values.
    status: of each case over `axis` and `preload_method`; unsolved cases get a cross at the foot.
    **look: properties of the lines, as in Matplotlib; they take precedence over the style of a
        race. Values without `preload_method` require a `color`.
    """
    has_failed = False
    has_races = "race" in values.dims
    by_method = methods(values) if "preload_method" in values.dims else [("", values)]
    for slot, (method, method_values) in enumerate(by_method):
        ordinates = method_values if unit is None else unit.of(method_values)
        colour = look.get("color") or COLOURS[method]
        abscissae = method_values[axis]
        if has_races:
            for race, style in enumerate(RACE_STYLES.values()):
                line_style = {**style, "color": colour, **look}
                panel.plot(abscissae, ordinates.isel(race=race), **line_style)
        else:
            panel.plot(abscissae, ordinates, **{"color": colour, **look})
        if status is not None:
            method_status = status.isel(preload_method=slot) if method else status
            has_failed |= mark_failed(panel, abscissae, method_status, colour, slot)
    panel.set_xlabel(ABSCISSAE[axis])
    if label:
        panel.set_ylabel(unit.label(label) if unit else label)
    return has_failed


def label_edges(panels: np.ndarray) -> None:
    """Removes the labels between panels that share their axes, so that only outer ones are left."""
    for panel in panels.flat:
        panel.label_outer()


def series_look(k: int) -> dict[str, Any]:
    """Returns colour and marker, as in Matplotlib, of line k, which is for no preload method."""
    return {"color": SERIES[k % len(SERIES)], "marker": MARKERS[k % len(MARKERS)]}


def failed_keys(any_failed: bool) -> list[Line2D]:
    """Returns the legend entry of the crosses of unsolved cases in a list; empty if none failed."""
    return [key("not solved", color="0.3", **FAILED)] if any_failed else []


def frame(figure: Figure, title: str, handles: Sequence[Artist], columns: int) -> None:
    """Adds a title above the panels, and a legend below them.

    handles: entries of the legend; if empty, there is no legend.
    columns: number of columns of the legend.
    """
    width = int(CHARACTERS_PER_INCH * figure.get_figwidth())
    figure.suptitle("\n".join(lines_of_a_title(title, width)), gid=MESSAGE)
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=columns)


_BEFORE_UNIT = re.compile(r"(?<=\d) (?=(?:%|µm|mm|N|h|r/min|kg/m³)(?!\w))")


def lines_of_a_title(title: str, width: int) -> list[str]:
    """Wraps a title into as few lines as the width [characters] allows, as even as possible.

    A number and its unit are on one line.
    """
    title = _BEFORE_UNIT.sub("\N{NO-BREAK SPACE}", title)

    def wrapped(width: int) -> list[str]:
        """Returns the lines of the title for a width [characters]."""
        return textwrap.wrap(title, width, break_long_words=False)

    fewest_lines = len(wrapped(width))
    # the narrowest width with no more lines makes them even
    while width > 1 and len(wrapped(width - 1)) <= fewest_lines:
        width -= 1
    return wrapped(width)


def start_at_zero(axes: Any) -> None:
    """Sets the lower end of the ordinate to zero, and leaves space above the marks.

    Without positive values, the upper end is 1.
    """
    top = axes.get_ylim()[1]
    axes.set_ylim(0.0, HEADROOM * top if top > 0.0 else 1.0)


def power_of_ten(values: Sequence[xr.DataArray]) -> int:
    """Returns the exponent of the power of ten in which numbers on an axis are given.

    It is a multiple of three, and the largest magnitude is 1 to below 1000 times the power. It is 0
    if all values are 0 or NaN.
    """
    magnitudes = [float(abs(array).max()) for array in values if array.notnull().any()]
    largest = max(magnitudes, default=0.0)
    return 3 * math.floor(math.log10(largest) / 3.0) if largest > 0.0 else 0


def number_on_axis(value: float) -> str:
    """Returns a tick label, with a raised power of ten if it is below 0.001 or at least 1e5."""
    mantissa, _, exponent = f"{value:.3e}".partition("e")
    if value == 0.0 or -3 <= int(exponent) < 5:
        return f"{value:g}".replace("-", "−")
    power, factor = ten_to_the(int(exponent)), f"{float(mantissa):g}"
    return power if factor == "1" else f"{factor} × {power}"


def ten_to_the(exponent: int) -> str:
    """Returns a power of ten with its exponent raised."""
    return "10" + str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
