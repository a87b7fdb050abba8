"""Charts of an answer, which a page draws and scripts may read; numbers are in shown units."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from bearingwear.results.netcdf import json_faults

Point = tuple[float, float | None]
"""Abscissa and ordinate of a point of a line; the ordinate is None if it was not solved."""


@dataclass(frozen=True, kw_only=True)
class ChartLine:
    """A line for a preload method, which determines its colour."""

    name: str  # of the method, in words
    method: str
    points: Sequence[Point]
    notes: Sequence[str]  # for each point, the limits that it violates; empty if none
    ends: Sequence[str] = ()  # for each point, the criterion that ends the life, if it is shown
    beyond: Sequence[tuple[float, float]] = ()  # ranges of x in which a limit is violated
    star: tuple[float, float] | None = None  # the recommended point
    band: tuple[float, float] | None = None  # range of y of most bearings at the recommended point


@dataclass(frozen=True, kw_only=True)
class Chart:
    """A diagram of lines over one quantity."""

    title: str
    x_label: str
    y_label: str
    lines: Sequence[ChartLine]
    limit: float | None = None
    at_least: bool = False  # whether values below the limit violate it, not those above
    log_x: bool = False
    log_y: bool = False


@dataclass(frozen=True, kw_only=True)
class Charts:
    """The charts of an answer, and its question; the first chart is the main one of a page."""

    question: str
    charts: Sequence[Chart]

    @property
    def stored(self) -> str:
        """Returns the charts as JSON, which `load_charts` reads."""
        return json.dumps(asdict(self), ensure_ascii=False, indent=1) + "\n"


def load_charts(path: Path) -> Charts:
    """Returns the charts in a JSON file (`Charts.stored`). CaseFileError: it cannot be read."""
    with json_faults(path, "charts"):
        content = json.loads(path.read_text(encoding="utf-8"))
        charts = [
            Chart(**chart | {"lines": [ChartLine(**line) for line in chart["lines"]]})
            for chart in content["charts"]
        ]
        return Charts(question=content["question"], charts=charts)
