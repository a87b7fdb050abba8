"""Charts as SVG that a script can zoom: each mark carries its numbers, and the style its colours.

What is drawn here stands without scripts and in print; `page.js` places the same marks anew.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Sequence
from html import escape

from markupsafe import Markup

from bearingwear.document.chart import Chart, ChartLine
from bearingwear.results.units import Rough, digits

LARGE_CHART, SMALL_CHART = (660.0, 350.0), (400.0, 230.0)
MARGINS = (56.0, 14.0, 10.0, 40.0)
"""Left, right, top, bottom of the field of lines [px]."""
_LEFT, _RIGHT, _TOP, _BOTTOM = MARGINS
_LANE = 9.0
"""Height of the bar on the axis where a method violates a requirement."""
_VIOLATED, _ROOM = "violates a requirement", 0.65
"""Words beside the bars on the axis, and the share of the axis up to which these leave room."""
_STAR = "M0-9 2.1-2.9 8.6-2.8 3.4 1.1 5.3 7.3 0 3.6-5.3 7.3-3.4 1.1-8.6-2.8-2.1-2.9Z"
_DIAMOND = "M0-6L5 0 0 6-5 0Z"
_Place = Callable[[float, float], tuple[float, float]]
_CAP = "M-5 0h10"
_DOT = "M-2.2 0a2.2 2.2 0 1 0 4.4 0a2.2 2.2 0 1 0-4.4 0"


class ChartAxis:
    """Where numbers stand on an axis of a length in pixels."""

    def __init__(self, numbers: Sequence[float], log: bool, zero: bool = False) -> None:
        known = [number for number in numbers if number > 0.0 or not log]
        low, high = min(known, default=1.0), max(known, default=10.0)
        self.log = log
        if log:
            self.low, self.high = low / 1.15, high * 1.15
        else:
            room = 0.06 * (high - low or abs(high) or 1.0)
            self.low, self.high = (0.0 if zero and low >= 0.0 else low - room), high + room

    def share(self, number: float) -> float:
        """Of the axis, where a number stands."""
        if self.log:
            return math.log(max(number, 1e-300) / self.low) / math.log(self.high / self.low)
        return (number - self.low) / (self.high - self.low)

    @property
    def ticks(self) -> list[float]:
        """Round numbers on it, 1, 2 and 5 times powers of ten."""
        if self.log:
            decades = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)))
            many = [m * 10.0**k for k in decades for m in (1, 2, 5)]
            every = many if len(decades) < 4 else [10.0**k for k in decades]
            inside = [tick for tick in every if self.low <= tick <= self.high]
            if len(inside) > 1:
                return inside
        rough = (self.high - self.low) / 5.0
        power = 10.0 ** math.floor(math.log10(rough))
        step = next(m * power for m in (1, 2, 5, 10) if m * power >= rough)
        first, last = math.ceil(self.low / step), math.floor(self.high / step)
        return [step * k for k in range(first, last + 1)]


def chart_html(
    chart: Chart, name: str, group: str, size: tuple[float, float] = SMALL_CHART
) -> Markup:
    """A chart with its title, its lines in words and what they have at the recommended preload.

    name: its `id`.
    group: charts that have one cursor.
    size: width and height [px].
    """
    is_large = size == LARGE_CHART
    said = ", ".join(f"{line.name} {_starred(chart, line)}" for line in chart.lines if line.star)
    words = f"{chart.title}: {chart.y_label} against {chart.x_label}"
    limit = ""
    if chart.limit is not None:
        limit = f" {'≥' if chart.at_least else '≤'} {digits(chart.limit)}{_unit(chart.y_label)}"
    keys = "".join(
        f'<span class="{line.method}"><i></i>{escape(line.name)} '
        f"<b>{escape(_starred(chart, line, is_large))}</b></span>"
        for line in chart.lines
    )
    legend = _legend(chart) if is_large else ""
    return Markup(
        f'<figure class="chart" id="{name}" data-group="{group}">'
        f"<figcaption>{escape(chart.title)}<span>{escape(limit)}</span></figcaption>"
        f'<p class="keys">{keys}</p>'
        f'<svg viewBox="0 0 {size[0]:g} {size[1]:g}" role="img" '
        f'aria-label="{escape(words + limit)}. Recommended: {escape(said or "none")}." '
        f"data-chart='{escape(_numbers(chart, is_large), quote=True)}'>{_drawn(chart, size)}</svg>"
        f"{legend}</figure>"
    )


def _legend(chart: Chart) -> str:
    """What stars, bars and dashes are."""
    known = {
        "Star: longest life with each method, subject to all requirements.": any(
            c.star for c in chart.lines
        ),
        "Error bar: range that contains the lives of 90 % of the bearings.": any(
            c.band for c in chart.lines
        ),
        "Dashed line and bar above the axis: preloads that violate a requirement.": any(
            c.beyond for c in chart.lines
        ),
        "Diamond: beyond this point, a different criterion determines the end of life.": any(
            len(set(c.ends)) > 1 for c in chart.lines
        ),
    }
    said = " ".join(text for text, there in known.items() if there)
    return f'<p class="note">{said}</p>' if said else ""


def _numbers(chart: Chart, places: bool) -> str:
    """What the script needs beside the marks.

    places: whether recommended preloads are named where the cursor is at none.
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
                    "digits": 2 if line.band else 3,
                }
                for line in chart.lines
            ],
        }
    )


def _starred(chart: Chart, line: ChartLine, place: bool = True) -> str:
    """What a line has at the recommended preload, and which one that is."""
    if not line.star:
        return "–"
    x, y = line.star
    number = Rough(y).text if line.band else digits(y)
    where = f" at {x:.4g}{_unit(chart.x_label)}" if place else ""
    return f"{number}{_unit(chart.y_label)}{where}"


def _unit(label: str) -> str:
    """The unit in brackets at the end of a label."""
    _, _, unit = label.rpartition(" (")
    return f" {unit[:-1]}" if label.endswith(")") else ""


def _named_once(chart: Chart) -> str:
    """The label of the ordinate; its unit alone where the title has the rest."""
    return _unit(chart.y_label).strip() if chart.y_label.startswith(chart.title) else chart.y_label


def _axes(chart: Chart) -> tuple[ChartAxis, ChartAxis]:
    points = [point for line in chart.lines for point in line.points]
    heights = [y for _, y in points if y is not None]
    heights += [end for line in chart.lines for end in line.band or ()]
    heights += [] if chart.limit is None else [chart.limit]
    return ChartAxis([x for x, _ in points], chart.log_x), ChartAxis(
        heights, chart.log_y, zero=True
    )


def _drawn(chart: Chart, size: tuple[float, float]) -> str:
    """All inside the SVG; the field of the lines is an SVG of its own, which cuts them off."""
    x_axis, y_axis = _axes(chart)
    width, height = size[0] - _LEFT - _RIGHT, size[1] - _TOP - _BOTTOM

    def at(x: float, y: float) -> tuple[float, float]:
        return x_axis.share(x) * width, (1.0 - y_axis.share(y)) * height

    grid = [
        f'<path d="M{_LEFT + at(x, y_axis.high)[0]:.1f} {_TOP:g}v{height:g}"/>'
        f'<text x="{_LEFT + at(x, y_axis.high)[0]:.1f}" y="{_TOP + height + 16:g}" '
        f'text-anchor="middle">{digits(x)}</text>'
        for x in x_axis.ticks
    ] + [
        f'<path d="M{_LEFT:g} {_TOP + at(x_axis.low, y)[1]:.1f}h{width:g}"/>'
        f'<text x="{_LEFT - 6:g}" y="{_TOP + at(x_axis.low, y)[1] + 4:.1f}" '
        f'text-anchor="end">{digits(y)}</text>'
        for y in y_axis.ticks
    ]
    marks = []
    if chart.limit is not None:
        top = at(x_axis.low, chart.limit)[1]
        y, tall = (top, height - top) if chart.at_least else (0.0, top)
        marks.append(
            f'<rect class="limit" data-limit="{chart.limit:g}" data-least="{int(chart.at_least)}" '
            f'x="0" y="{y:.1f}" width="{width:g}" height="{max(tall, 0.0):.1f}"/>'
        )
    for k, line in enumerate(chart.lines):
        marks += _line(line, k, at, height, chart.log_y)
    ends = [b for line in chart.lines for _, b in line.beyond]
    # lines of a chart from zero on lie where the words would stand
    if ends and chart.log_y and size == LARGE_CHART and x_axis.share(max(ends)) < _ROOM:
        marks.append(
            f'<text class="lanes" data-from="{max(ends):g}" '
            f'x="{at(max(ends), 1.0)[0] + 4:.1f}" y="{height - 4:g}">{_VIOLATED}</text>'
        )
    # bars lie under all lines, stars over them
    marks.sort(key=lambda mark: ("star" in mark) - ("rect" in mark))
    return (
        f'<g class="grid">{"".join(grid)}</g>'
        f'<text x="{_LEFT + width / 2:g}" y="{size[1] - 6:g}" class="x" text-anchor="middle">'
        f"{escape(chart.x_label)}</text>"
        f'<text transform="translate(13 {_TOP + height / 2:g}) rotate(-90)" class="y" '
        f'text-anchor="middle">{escape(_named_once(chart))}</text>'
        f'<svg class="field" x="{_LEFT:g}" y="{_TOP:g}" width="{width:g}" height="{height:g}">'
        f'{"".join(marks)}<path class="cursor" d=""/></svg>'
    )


def _line(line: ChartLine, k: int, place: _Place, height: float, log: bool) -> Iterable[str]:
    """The line, bold where it satisfies all requirements; its lane, points, and recommendation.

    Nothing stands at zero on a logarithmic axis.
    """
    known = [
        (x, None if y is not None and log and y <= 0.0 else y, not note)
        for (x, y), note in zip(line.points, line.notes, strict=True)
    ]
    for a, b in line.beyond:
        left, right = place(a, 1.0)[0], place(b, 1.0)[0]
        yield (
            f'<rect class="beyond {line.method}" data-x="{a:g} {b:g}" data-lane="{k}" '
            f'x="{left:.1f}" y="{height - (k + 1) * _LANE:g}" width="{right - left:.1f}" '
            f'height="{_LANE - 2:g}"/>'
        )
    for (x0, y0, kept), (x1, y1, still) in zip(known, known[1:], strict=False):
        if y0 is not None and y1 is not None:
            look = f"line {line.method}" + ("" if kept and still else " pale")
            yield _stroke(look, (x0, y0), (x1, y1), place)
    if line.band and line.star:
        x = line.star[0]
        yield _stroke(f"band {line.method}", (x, line.band[0]), (x, line.band[1]), place)
        for end in line.band:
            yield _mark("band", line.method, _CAP, x, end, place)
    changed = {k for k in range(1, len(line.ends)) if line.ends[k] != line.ends[k - 1]}
    for k, (x, y, is_allowed) in enumerate(known):
        if y is not None:
            shape = _DIAMOND if k in changed else _DOT
            yield _mark("dot" if is_allowed else "dot pale", line.method, shape, x, y, place)
    if line.star and (line.star[1] > 0.0 or not log):
        yield _mark("star", line.method, _STAR, *line.star, place)


def _stroke(look: str, start: tuple[float, float], end: tuple[float, float], place: _Place) -> str:
    (x0, y0), (x1, y1) = place(*start), place(*end)
    numbers = " ".join(f"{number:.6g}" for number in (*start, *end))
    path = f"M{x0:.1f} {y0:.1f}L{x1:.1f} {y1:.1f}"
    return f'<path class="{look}" data-at="{numbers}" d="{path}"/>'


def _mark(kind: str, method: str, shape: str, x: float, y: float, place: _Place) -> str:
    left, top = place(x, y)
    return (
        f'<path class="{kind} {method}" data-at="{x:.6g} {y:.6g}" d="{shape}" '
        f'transform="translate({left:.1f} {top:.1f})"/>'
    )
