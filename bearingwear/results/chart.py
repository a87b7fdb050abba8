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
    """A line of a preload method.

    Attributes
    ----------
    name, method : str
        In words; its colour is the method's.
    points : sequence of (float, float or None)
        None where nothing was solved.
    notes : sequence of str
        Of each point, which limits it passes; empty within all of them.
    ends : sequence of str
        Of each point, what ends the life; empty where that is of no interest.
    beyond : sequence of (float, float)
        Where along x a limit is passed.
    star : (float, float), optional
        The point that is recommended.
    band : (float, float), optional
        Between what most bearings lie there.
    """

    name: str
    method: str
    points: Sequence[Point]
    notes: Sequence[str]
    ends: Sequence[str] = ()
    beyond: Sequence[tuple[float, float]] = ()
    star: tuple[float, float] | None = None
    band: tuple[float, float] | None = None


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Lines over one quantity.

    Attributes
    ----------
    title, x_label, y_label : str
    lines : sequence of ChartLine
    limit : float, optional
    at_least : bool
        Whether values below the limit pass it, not those above.
    log_x, log_y : bool
    """

    title: str
    x_label: str
    y_label: str
    lines: Sequence[ChartLine]
    limit: float | None = None
    at_least: bool = False
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

    Raises
    ------
    CaseFileError
        One line.
    """
    with read_as(path, "charts"):
        read = json.loads(path.read_text(encoding="utf-8"))
        charts = [
            Chart(**chart | {"lines": [ChartLine(**line) for line in chart["lines"]]})
            for chart in read["charts"]
        ]
        return Charts(question=read["question"], charts=charts)
