"""Draws charts as SVG that a script can zoom: marks carry their numbers, the style has the colours.

The drawing is complete without scripts and in print; `page.js` moves its marks.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Sequence
from html import escape
from itertools import pairwise
from typing import NamedTuple

from markupsafe import Markup

from bearingwear.document.chart import Chart, ChartLine
from bearingwear.results.units import digits

LARGE_CHART, SMALL_CHART = (660.0, 350.0), (400.0, 230.0)
MARGINS = (56.0, 14.0, 24.0, 40.0)
"""Left, right, top, bottom of the field of lines [px]."""
_LEFT, _RIGHT, _TOP, _BOTTOM = MARGINS
_LOG_MARGIN, _MARGIN_SHARE = 1.15, 0.06
"""Space beyond the numbers of an axis: a factor of a logarithmic one, a share of a linear one."""
_LANE = 9.0
"""Height of the bar on the axis where a method violates a requirement [px]."""
_VIOLATED, _MAX_BAR_END = "violates a requirement", 0.65
"""Words beside the bars on the axis, and the share of the axis up to which bars leave room for
them."""
_STAR = "M0-9 2.1-2.9 8.6-2.8 3.4 1.1 5.3 7.3 0 3.6-5.3 7.3-3.4 1.1-8.6-2.8-2.1-2.9Z"
_DIAMOND = "M0-6L5 0 0 6-5 0Z"
_CAP = "M-5 0h10"
_DOT = "M-2.2 0a2.2 2.2 0 1 0 4.4 0a2.2 2.2 0 1 0-4.4 0"
"""Paths of marks about their points [px]."""
_Place = Callable[[float, float], tuple[float, float]]
"""Returns the position [px] in the field of the lines for x and y in the units of the axes."""


class ChartAxis:
    """An axis with a linear or logarithmic scale, and its range `low` to `high`.

    numbers: to show; the range exceeds them slightly.
    zero: whether a linear axis without negative numbers starts at zero.
    """

    def __init__(self, numbers: Sequence[float], log: bool, zero: bool = False) -> None:
        shown = [number for number in numbers if number > 0.0 or not log]
        low, high = min(shown, default=1.0), max(shown, default=10.0)
        self.log = log
        if log:
            self.low, self.high = low / _LOG_MARGIN, high * _LOG_MARGIN
        else:
            span = high - low
            if span == 0.0:  # a single number
                span = abs(high) if high else 1.0
            margin = _MARGIN_SHARE * span
            self.low = 0.0 if zero and low >= 0.0 else low - margin
            self.high = high + margin

    def share(self, number: float) -> float:
        """Returns the position of a number as a share of the length of the axis.

        On a logarithmic axis, zero and negative numbers are far below its start.
        """
        if self.log:
            positive = max(number, 1e-300)  # near the smallest float
            return math.log(positive / self.low) / math.log(self.high / self.low)
        return (number - self.low) / (self.high - self.low)

    @property
    def ticks(self) -> list[float]:
        """Returns the numbers with a tick, at linear steps if fewer than two are logarithmic."""
        ticks = self._log_ticks if self.log else []
        return ticks if len(ticks) > 1 else self._linear_ticks

    @property
    def _log_ticks(self) -> list[float]:
        """Returns 1, 2 and 5 times powers of ten within the axis; of many decades, only powers."""
        decades = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)))
        factors = (1, 2, 5) if len(decades) < 4 else (1,)
        ticks = [factor * 10.0**k for k in decades for factor in factors]
        return [tick for tick in ticks if self.low <= tick <= self.high]

    @property
    def _linear_ticks(self) -> list[float]:
        """Returns the ticks at steps of 1, 2 or 5 times a power of ten, at most five steps."""
        least_step = (self.high - self.low) / 5.0
        power = 10.0 ** math.floor(math.log10(least_step))
        step = min(size * power for size in (1, 2, 5, 10) if size * power >= least_step)
        first, last = math.ceil(self.low / step), math.floor(self.high / step)
        return [step * k for k in range(first, last + 1)]


def chart_html(
    chart: Chart, name: str, group: str, size: tuple[float, float] = SMALL_CHART
) -> Markup:
    """Returns HTML of a chart, its title, and the value of each line at the recommended preload.

    name: the `id` of the chart.
    group: name of the charts that share one cursor.
    size: width and height [px].
    """
    is_large = size == LARGE_CHART
    starred = [line for line in chart.lines if line.star]
    recommended = ", ".join(
        f"{line.name} {_value_and_preload_text(chart, line)}" for line in starred
    )
    words = f"{chart.title}: {chart.y_label} against {chart.x_label}"
    limit = ""
    if chart.limit is not None:
        limit = f" {'≥' if chart.at_least else '≤'} {digits(chart.limit)}{_unit(chart.y_label)}"
    star_text = _value_and_preload_text if is_large else _value_text
    keys = "".join(
        f'<span class="{line.method}"><i></i>{escape(line.name)} '
        f"<b>{escape(star_text(chart, line))}</b></span>"
        for line in chart.lines
    )
    legend = _legend(chart) if is_large else ""
    return Markup(
        f'<figure class="chart" id="{name}" data-group="{group}">'
        f"<figcaption>{escape(chart.title)}<span>{escape(limit)}</span></figcaption>"
        f'<p class="keys">{keys}</p>'
        f'<svg viewBox="0 0 {size[0]:g} {size[1]:g}" role="img" '
        f'aria-label="{escape(words + limit)}. Recommended: {escape(recommended or "none")}." '
        f"data-chart='{escape(_script_data(chart, is_large), quote=True)}'>"
        f"{_svg_content(chart, size)}</svg>{legend}</figure>"
    )


def _legend(chart: Chart) -> str:
    """Returns HTML that explains the stars, bars, dashes and diamonds that a chart contains."""
    lines, sentences = chart.lines, []
    if any(line.star for line in lines):
        sentences.append("Star: longest life with each method, subject to all requirements.")
    if any(line.band for line in lines):
        sentences.append("Error bar: range that contains the lives of 90 % of the bearings.")
    if any(line.beyond for line in lines):
        sentences.append("Dashed line and bar above the axis: preloads that violate a requirement.")
    if any(len(set(line.ends)) > 1 for line in lines):
        sentences.append(
            "Diamond: beyond this point, a different criterion determines the end of life."
        )
    return f'<p class="note">{" ".join(sentences)}</p>' if sentences else ""


def _script_data(chart: Chart, places: bool) -> str:
    """Returns JSON of the axes and lines of a chart, which the script of the page reads.

    places: whether the script states the recommended preloads while there is no cursor.
    """
    x, y = _axes(chart)
    return json.dumps(
        {
            "log": [chart.log_x, chart.log_y],
            "x": [x.low, x.high],
            "y": [y.low, y.high],
            "units": [_unit(chart.x_label), _unit(chart.y_label)],
            "places": places,
            "lines": [
                {
                    "points": line.points,
                    "notes": line.notes,
                    "star": line.star,
                    "ends": line.ends,
                }
                for line in chart.lines
            ],
        }
    )


def _value_text(chart: Chart, line: ChartLine) -> str:
    """Returns the value of a line at the recommended preload, with its unit; a dash without it."""
    if not line.star:
        return "–"
    return f"{digits(line.star[1])}{_unit(chart.y_label)}"


def _value_and_preload_text(chart: Chart, line: ChartLine) -> str:
    """Returns the value of a line at the recommended preload, and that preload."""
    text = _value_text(chart, line)
    return f"{text} at {line.star[0]:.4g}{_unit(chart.x_label)}" if line.star else text


def _unit(label: str) -> str:
    """Returns the unit in brackets at the end of a label, after a space; empty without a unit."""
    _, _, unit = label.rpartition(" (")
    return f" {unit[:-1]}" if label.endswith(")") else ""


def _ordinate_label(chart: Chart) -> str:
    """Returns the label of the ordinate; its unit alone if the title contains the rest."""
    return _unit(chart.y_label).strip() if chart.y_label.startswith(chart.title) else chart.y_label


def _axes(chart: Chart) -> tuple[ChartAxis, ChartAxis]:
    """Returns abscissa and ordinate, which contain all points, bands and the limit."""
    points = [point for line in chart.lines for point in line.points]
    ordinates = [y for _, y in points if y is not None]
    ordinates += [end for line in chart.lines for end in line.band or ()]
    ordinates += [] if chart.limit is None else [chart.limit]
    return (
        ChartAxis([x for x, _ in points], chart.log_x),
        ChartAxis(ordinates, chart.log_y, zero=True),
    )


def _svg_content(chart: Chart, size: tuple[float, float]) -> str:
    """Returns the content of the SVG; the field of the lines is an inner SVG, which clips them.

    size: width and height of the chart [px].
    """
    x_axis, y_axis = _axes(chart)
    width, height = size[0] - _LEFT - _RIGHT, size[1] - _TOP - _BOTTOM

    def place(x: float, y: float) -> tuple[float, float]:
        """Returns the position [px] of a point in the field of the lines."""
        return x_axis.share(x) * width, (1.0 - y_axis.share(y)) * height

    marks = [] if chart.limit is None else [_limit_area(chart, x_axis.low, place, width, height)]
    for k, line in enumerate(chart.lines):
        marks += _line_marks(line, k, place, height, chart.log_y)
    bar_end = max((end for line in chart.lines for _, end in line.beyond), default=None)
    # lines of a chart from zero on lie where the words would stand
    has_space = chart.log_y and size == LARGE_CHART
    if bar_end is not None and has_space and x_axis.share(bar_end) < _MAX_BAR_END:
        marks.append(
            f'<text class="lanes" data-from="{bar_end:g}" '
            f'x="{place(bar_end, 1.0)[0] + 4:.1f}" y="{height - 4:g}">{_VIOLATED}</text>'
        )
    # bars are drawn first, under all lines, and stars last
    marks.sort(key=lambda mark: ("star" in mark, "rect" not in mark))
    return (
        f'<g class="grid">{_grid(x_axis, y_axis, place, width, height)}</g>'
        f'<text x="{_LEFT + width / 2:g}" y="{size[1] - 6:g}" class="x" text-anchor="middle">'
        f"{escape(chart.x_label)}</text>"
        # above the axis: beside it, five digits in large type would lie under it
        f'<text x="2" y="14" class="y">{escape(_ordinate_label(chart))}</text>'
        f'<svg class="field" x="{_LEFT:g}" y="{_TOP:g}" width="{width:g}" height="{height:g}">'
        f'{"".join(marks)}<path class="cursor" d=""/></svg>'
    )


def _grid(x_axis: ChartAxis, y_axis: ChartAxis, place: _Place, width: float, height: float) -> str:
    """Returns SVG of the grid lines with their numbers, the vertical lines first.

    width, height: of the field of the lines [px].
    """
    lines = []
    for x in x_axis.ticks:
        left = _LEFT + place(x, y_axis.high)[0]
        lines.append(
            f'<path d="M{left:.1f} {_TOP:g}v{height:g}"/>'
            f'<text x="{left:.1f}" y="{_TOP + height + 16:g}" '
            f'text-anchor="middle">{digits(x)}</text>'
        )
    for y in y_axis.ticks:
        top = _TOP + place(x_axis.low, y)[1]
        lines.append(
            f'<path d="M{_LEFT:g} {top:.1f}h{width:g}"/>'
            f'<text x="{_LEFT - 6:g}" y="{top + 4:.1f}" text-anchor="end">{digits(y)}</text>'
        )
    return "".join(lines)


def _limit_area(chart: Chart, x: float, place: _Place, width: float, height: float) -> str:
    """Returns an SVG rectangle over the values that violate the limit of a chart.

    x: any number on the abscissa, which `place` requires.
    width, height: of the field of the lines [px].
    """
    assert chart.limit is not None
    limit_y = place(x, chart.limit)[1]
    top, area_height = (limit_y, height - limit_y) if chart.at_least else (0.0, limit_y)
    return (
        f'<rect class="limit" data-limit="{chart.limit:g}" data-least="{int(chart.at_least)}" '
        f'x="0" y="{top:.1f}" width="{width:g}" height="{max(area_height, 0.0):.1f}"/>'
    )


class _LinePoint(NamedTuple):
    """A point of a line as it is drawn."""

    x: float
    y: float | None  # None if it was not solved, or is not positive on a logarithmic axis
    is_allowed: bool  # whether it satisfies all requirements


def _line_marks(line: ChartLine, k: int, place: _Place, height: float, log: bool) -> Iterable[str]:
    """Yields the SVG marks of line k: bars of violations, strokes, band, points, and star.

    A stroke is bold if both of its points satisfy all requirements.

    place: returns the position [px] of a point.
    height: of the field of the lines [px].
    log: whether the ordinate is logarithmic.
    """
    points = [
        _LinePoint(x, None if y is not None and log and y <= 0.0 else y, is_allowed=not note)
        for (x, y), note in zip(line.points, line.notes, strict=True)
    ]
    for start, end in line.beyond:
        left, right = place(start, 1.0)[0], place(end, 1.0)[0]
        yield (
            f'<rect class="beyond {line.method}" data-x="{start:g} {end:g}" data-lane="{k}" '
            f'x="{left:.1f}" y="{height - (k + 1) * _LANE:g}" width="{right - left:.1f}" '
            f'height="{_LANE - 2:g}"/>'
        )
    for a, b in pairwise(points):
        if a.y is not None and b.y is not None:
            style = "" if a.is_allowed and b.is_allowed else " pale"
            yield _stroke(f"line {line.method}{style}", (a.x, a.y), (b.x, b.y), place)
    if line.band and line.star:
        x = line.star[0]
        yield _stroke(f"band {line.method}", (x, line.band[0]), (x, line.band[1]), place)
        for end in line.band:
            yield _mark("band", line.method, _CAP, x, end, place)
    changes = {i for i in range(1, len(line.ends)) if line.ends[i] != line.ends[i - 1]}
    for i, point in enumerate(points):
        if point.y is not None:
            kind = "dot" if point.is_allowed else "dot pale"
            shape = _DIAMOND if i in changes else _DOT
            yield _mark(kind, line.method, shape, point.x, point.y, place)
    if line.star and (line.star[1] > 0.0 or not log):
        yield _mark("star", line.method, _STAR, *line.star, place)


def _stroke(
    classes: str, start: tuple[float, float], end: tuple[float, float], place: _Place
) -> str:
    """Returns SVG of a straight line, whose attribute `data-at` states its two points.

    classes: of the style sheet.
    """
    (x0, y0), (x1, y1) = place(*start), place(*end)
    numbers = " ".join(f"{number:.6g}" for number in (*start, *end))
    path = f"M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}"
    return f'<path class="{classes}" data-at="{numbers}" d="{path}"/>'


def _mark(kind: str, method: str, shape: str, x: float, y: float, place: _Place) -> str:
    """Returns SVG of a mark, whose attribute `data-at` states its point.

    kind, method: classes of the style sheet.
    shape: path about the point [px].
    """
    left, top = place(x, y)
    return (
        f'<path class="{kind} {method}" data-at="{x:.6g} {y:.6g}" d="{shape}" '
        f'transform="translate({left:.1f} {top:.1f})"/>'
    )
