"""What all figures share: style, colours, marks, words, saving."""

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
"""Of the preload methods, in every figure; nothing else has them."""
SERIES = ("C2", "C3", "C4", "C5", "black", "0.55")
"""Colours of anything else."""
MARKERS = "osd^vP"
RACE_STYLES = {
    "inner": {"linestyle": "-", "marker": "o"},
    "outer": {"linestyle": "--", "marker": "s"},
}
BALL_STYLE: dict[str, Any] = {"linestyle": ":", "marker": "^"}
FORMATS = (".svg", ".png", ".pdf")
"""Formats that can be written without a clock time."""
DASHES = ("-", "--", ":", "-.")
CHARACTERS_PER_INCH = 14
MESSAGE = "message"
"""Name, in an SVG, of the group with the title."""
FOOT, SLOT = 0.03, 0.06
"""Height of the lowest row of crosses in a panel, and of a row, as shares of the panel's."""
HEADROOM = 1.05
"""Upper end of an axis over what is drawn."""
FAILED = {"linestyle": "none", "marker": "x", "markersize": 7, "markeredgewidth": 2.0}

ABSCISSAE = {
    "friction": "ball/race friction coefficient µ",
    "ball_diameter_loss": "loss of ball diameter (µm)",
    "preload": "initial preload (N)",
    "cage_friction": "friction coefficient of the cage",
}

Figure = matplotlib.figure.Figure


class HouseFigure(Figure):
    """A figure that keeps the house style wherever it is saved or shown.

    data_files: the files it was drawn from, which an SVG names.
    """

    data_files: tuple[str, ...] = ()

    def savefig(self, *args: Any, **kwargs: Any) -> None:
        with matplotlib.style.context(["default", STYLE]):
            super().savefig(*args, **kwargs)

    def _repr_png_(self) -> bytes:
        file = io.BytesIO()
        self.savefig(file, format="png")
        return file.getvalue()


def new_figure(
    rows: int, columns: int, width: float, height: float, **kwargs: Any
) -> tuple[Figure, np.ndarray]:
    """Figure and its panels (rows, columns) in the house style, drawn without a display."""
    matplotlib.rcdefaults()
    matplotlib.style.use(STYLE)
    figure = HouseFigure(figsize=(width, height))
    return figure, figure.subplots(rows, columns, squeeze=False, **kwargs)


def drawn_from(figure: Figure, *paths: str | Path) -> Figure:
    """The figure, which names the files it was drawn from."""
    figure.data_files = tuple(map(str, paths))  # type: ignore[attr-defined]
    return figure


DATA_SEPARATOR = "; "
"""Between the files that an SVG names as its source."""


def save(figure: Figure, paths: Iterable[str | Path]) -> None:
    """Write a figure in the format that each suffix names; no clock time goes in.

    An SVG says in its `title` and `description` what the figure states and shows.
    Mathtext is off in the style, since names from scenes stand in figures; matplotlib's own labels
    of a logarithmic axis need it, and get plain numbers here.

    OutputError: also a suffix that names no format is refused before anything is written.
    """
    kinds = {path: path.suffix.lower() for path in map(Path, paths)}
    for path, kind in kinds.items():
        if kind not in FORMATS:
            allowed = ", ".join(FORMATS)
            raise OutputError(f"{path}: got the suffix {path.suffix!r}, expected {allowed}")
    metadata = {".svg": _in_words(figure), ".png": {}, ".pdf": {"CreationDate": None}}
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if isinstance(axis.get_major_formatter(), LogFormatter):
                axis.set_major_formatter(FuncFormatter(lambda value, _: number_on_axis(value)))
                axis.set_minor_formatter(NullFormatter())
    if layout := figure.get_layout_engine():  # takes longer than drawing: once for all formats
        layout.execute(figure)
        figure.set_layout_engine("none")
    for path, kind in kinds.items():
        with whole_file(path) as part:
            figure.savefig(part, format=kind[1:], metadata=metadata[kind])


def _in_words(figure: Figure) -> dict[str, str | None]:
    """Message and contents of a figure, for readers who cannot see it."""
    axes = figure.axes

    def distinct(texts: Iterable[str]) -> str:
        return ", ".join(dict.fromkeys(text.replace("\n", " ") for text in texts if text))

    ordinates, abscissae = (
        distinct(a.get_ylabel() for a in axes),
        distinct(a.get_xlabel() for a in axes),
    )
    panels = distinct(a.get_title(loc="left") for a in axes)
    keys = distinct(text.get_text() for legend in figure.legends for text in legend.get_texts())
    parts = (
        f"{ordinates} against {abscissae}",
        f"Panels: {panels}" if panels else "",
        f"Legend: {keys}" if keys else "",
    )
    files = getattr(figure, "data_files", ())
    return {
        "Title": figure.get_suptitle().replace("\n", " "),
        "Description": ". ".join(part for part in parts if part),
        "Source": DATA_SEPARATOR.join(files) or None,
        "Date": None,
    }


def mark_failed(
    axes: Any, where: xr.DataArray, status: xr.DataArray, color: str, slot: int
) -> bool:
    """Put a cross at the foot of a panel for each case of a line that was not solved.

    slot: row of the crosses, so that several lines do not hide each other's.

    Returns: whether there was any.
    """
    failed = where.values[status.values != OK]
    if failed.size:
        height = np.full(failed.size, FOOT + SLOT * slot)
        at_foot = {"transform": axes.get_xaxis_transform(), "clip_on": False, "zorder": 5}
        axes.plot(failed, height, color=color, **FAILED, **at_foot)
    return bool(failed.size)


def list_failed(axes: Any, names: list[str]) -> None:
    """Name in a corner of a panel the lines that are missing because they were not solved."""
    if names:
        text = "\n".join(["not solved:", *names])
        axes.text(0.02, 0.98, text, transform=axes.transAxes, color="crimson", va="top")


def key(label: str, **style: Any) -> Line2D:
    """Entry of a legend."""
    return Line2D([], [], label=label, **style)


def method_keys(names: Iterable[str], scene: Mapping[str, Any] | None = None) -> list[Line2D]:
    """Legend of the colours; of the pairs that are made so, where a scene is of one."""
    return [key(method_words(scene or {}, n), color=COLOURS[n], linewidth=3) for n in names]


def race_keys() -> list[Line2D]:
    """Legend of the races, and of what a ball has in both contacts."""
    keys = [key(f"{race} contact", color="0.3", **style) for race, style in RACE_STYLES.items()]
    return [*keys, key("ball, both contacts", color="0.3", **BALL_STYLE)]


def dashes(frictions: Iterable[float]) -> dict[float, str]:
    """Line style of each friction coefficient."""
    return {mu: DASHES[k % len(DASHES)] for k, mu in enumerate(frictions)}


def dash_keys(styles: dict[float, str]) -> list[Line2D]:
    """Legend of the friction coefficients."""
    return [key(friction_text(mu), color="0.3", linestyle=dash) for mu, dash in styles.items()]


def lines(
    panel: Any,
    values: xr.DataArray,
    axis: str,
    label: str = "",
    unit: Display | None = None,
    status: xr.DataArray | None = None,
    **look: Any,
) -> bool:
    """Lines of a quantity over an axis: a colour for each preload method, a dash for each race.

    values: over `axis` and, where it has them, `preload_method` and `race`.
    label: of the ordinate, without unit.
    unit: in which the values are shown; without one they are drawn as they are.
    status: of each case over `axis` and `preload_method`: a cross at the foot where it was not
        solved.
    **look: of the lines; it comes after that of a race.

    Returns: whether there was a cross.
    """
    failed = False
    every = methods(values) if "preload_method" in values.dims else [("", values)]
    for slot, (name, one) in enumerate(every):
        shown = one if unit is None else unit.of(one)
        colour = look.get("color") or COLOURS[name]
        styles = list(RACE_STYLES.values()) if "race" in one.dims else [{}]
        for k, style in enumerate(styles):
            line = shown.isel(race=k) if "race" in one.dims else shown
            panel.plot(one[axis], line, **{**style, "color": colour, **look})
        if status is not None:
            here = status.isel(preload_method=slot) if name else status
            failed |= mark_failed(panel, one[axis], here, colour, slot)
    panel.set_xlabel(ABSCISSAE[axis])
    if label:
        panel.set_ylabel(unit.label(label) if unit else label)
    return failed


def label_edges(panels: np.ndarray) -> None:
    """Leave labels of panels that share their axes to the outer ones."""
    for panel in panels.flat:
        panel.label_outer()


def series_look(k: int) -> dict[str, Any]:
    """Colour and marker of one of several that are no preload methods."""
    return {"color": SERIES[k % len(SERIES)], "marker": MARKERS[k % len(MARKERS)]}


def failed_keys(any_failed: bool) -> list[Line2D]:
    """Legend of the crosses, if there are any."""
    return [key("not solved", color="0.3", **FAILED)] if any_failed else []


def frame(figure: Figure, title: str, handles: Sequence[Artist], columns: int) -> None:
    """Title above and legend below the panels, where they hide nothing."""
    width = int(CHARACTERS_PER_INCH * figure.get_figwidth())
    figure.suptitle("\n".join(lines_of_a_title(title, width)), gid=MESSAGE)
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=columns)


_BEFORE_UNIT = re.compile(r"(?<=\d) (?=(?:%|µm|mm|N|h|r/min|kg/m³)(?!\w))")


def lines_of_a_title(title: str, width: int) -> list[str]:
    """As few lines as the width allows, and as even as they can be: no single word is left over.

    A number and its unit are on one line.
    """
    title = _BEFORE_UNIT.sub("\N{NO-BREAK SPACE}", title)

    def lines(width: int) -> list[str]:
        return textwrap.wrap(title, width, break_long_words=False)

    narrowest = next(w for w in range(1, width + 1) if len(lines(w)) <= len(lines(width)))
    return lines(narrowest)


def from_zero(axes: Any) -> None:
    """Let the ordinate start at zero, with room above for the marks."""
    top = axes.get_ylim()[1]
    axes.set_ylim(0.0, HEADROOM * top if top > 0.0 else 1.0)


def power_of_ten(values: Sequence[xr.DataArray]) -> int:
    """Power of ten, a multiple of three, that brings the largest value to 1 to 1000."""
    largest = max((float(abs(v).max()) for v in values if v.size and v.notnull().any()), default=0)
    return 3 * math.floor(math.log10(largest) / 3.0) if largest > 0.0 else 0


def number_on_axis(value: float) -> str:
    """A number for a tick label, with a raised power of ten if it is below 0.001 or from 1e5 on."""
    digits, _, exponent = f"{value:.3e}".partition("e")
    if value == 0.0 or -3 <= int(exponent) < 5:
        return f"{value:g}".replace("-", "−")
    power, factor = ten_to_the(int(exponent)), f"{float(digits):g}"
    return power if factor == "1" else f"{factor} × {power}"


def ten_to_the(exponent: int) -> str:
    """A power of ten with its exponent raised."""
    return "10" + str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
