"""A chart of an answer: what a page draws, and scripts read; numbers are in the units shown."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from bearingwear.results.netcdf import read_as

Point = tuple[float, float | None]


@dataclass(frozen=True, kw_only=True)
class ChartLine:
    """A line of a preload method."""

    # in words; its colour is the method's
    name: str
    method: str
    points: Sequence[Point]  # none where nothing was solved
    notes: Sequence[str]  # of each point, which limits it passes; empty within all of them
    # of each point, what ends the life; empty where that is of no interest
    ends: Sequence[str] = ()
    beyond: Sequence[tuple[float, float]] = ()  # where along x a limit is passed
    star: tuple[float, float] | None = None  # the point that is recommended
    band: tuple[float, float] | None = None  # between what most bearings lie there


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Lines over one quantity."""

    title: str
    x_label: str
    y_label: str
    lines: Sequence[ChartLine]
    limit: float | None = None
    at_least: bool = False  # whether values below the limit pass it, not those above
    log_x: bool = False
    log_y: bool = False


@dataclass(frozen=True, kw_only=True)
class Charts:
    """Question and charts of the results; the first is the main chart of a page."""

    question: str
    charts: Sequence[Chart]

    @property
    def stored(self) -> str:
        """As `load_charts` reads it."""
        return json.dumps(asdict(self), ensure_ascii=False, indent=1) + "\n"


def load_charts(path: Path) -> Charts:
    """Charts that a step of a study wrote.

    CaseFileError: one line.
    """
    with read_as(path, "charts"):
        read = json.loads(path.read_text(encoding="utf-8"))
        charts = [
            Chart(**chart | {"lines": [ChartLine(**line) for line in chart["lines"]]})
            for chart in read["charts"]
        ]
        return Charts(question=read["question"], charts=charts)
