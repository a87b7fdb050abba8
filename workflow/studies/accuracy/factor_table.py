"""Tables of numbers over those of another point, in marked parts of docs/accuracy.md."""

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bearingwear.results.units import digits, display
from workflow.studies.accuracy.marked import MarkedPart
from workflow.studies.accuracy.plan import Tolerance

FACTOR, ERROR, TIME_FACTOR, WHETHER = "factor", "error", "time", "whether"
"""Kinds of a column. Errors stand in percent."""
_ANSWER = 1.02
"""Factor within which two runs of the same program give the same answer."""
_LEAST_ERROR = 1e-4
_PERCENT = display("1", shown="%")
_WORDS = ("no", "yes")


@dataclass(frozen=True)
class FactorTable:
    """Rows of what and on which scene; columns by title."""

    title: str
    columns: dict[str, str]  # kind of each
    rows: list[tuple[str, str, list[float]]]

    def text(self) -> str:
        """As Markdown, with its title."""
        lines = ["| " + " | ".join(["what", "scene", *self.columns]) + " |"]
        lines.append("| --- | --- |" + " ---: |" * len(self.columns))
        for what, scene, numbers in self.rows:
            cells = cell_texts(numbers, list(self.columns.values()))
            lines.append("| " + " | ".join([what, f"`{scene}`", *cells]) + " |")
        return f"**{self.title[0].upper()}{self.title[1:]}**\n\n" + "\n".join(lines)

    def differences(self, text: str, tolerance: Tolerance) -> Iterator[str]:
        """Where a text that should hold this table differs from it; a line each."""
        said = _said(text)
        for what, scene, numbers in self.rows:
            where = f"{self.title}: {what}, {scene}"
            if (self.title.lower(), what, scene) not in said:
                yield f"{where}: missing"
                continue
            cells = said[self.title.lower(), what, scene]
            for (name, kind), cell, value in zip(self.columns.items(), cells, numbers, strict=True):
                if not _alike(cell, value, kind, tolerance):
                    given = digits(100.0 * value if kind == ERROR else value)
                    yield f"{where}: {name}: says {cell}, a run gives {given}"


def tables_text(tables: Iterable[FactorTable]) -> str:
    """Tables one below the other, as Markdown."""
    return "\n\n".join(table.text() for table in tables)


def table_differences(
    tables: Iterable[FactorTable], part: MarkedPart, docs: Path, tolerance: Tolerance
) -> list[str]:
    """Where a part of the docs differs from tables; a line each."""
    _, old, _ = part.split(docs)
    return [f"{docs}: {line}" for table in tables for line in table.differences(old, tolerance)]


def cell_texts(numbers: Sequence[float], kinds: Sequence[str]) -> list[str]:
    """Numbers as cells; what takes time is known to two digits at best."""
    return [_cell(number, kind) for number, kind in zip(numbers, kinds, strict=True)]


def _cell(number: float, kind: str) -> str:
    if not math.isfinite(number):
        return digits(number)
    if kind == WHETHER:
        return _WORDS[int(number)]
    if kind == ERROR:
        return f"{_PERCENT.text(float(f'{number:.2g}'))} %"
    return digits(float(f"{number:.2g}") if kind == TIME_FACTOR else number)


def _said(text: str) -> dict[tuple[str, str, str], list[str]]:
    """Cells of all tables of a text, by title, first cell and scene."""
    said, title = {}, ""
    for line in text.splitlines():
        if bold := re.fullmatch(r"\*\*(.+)\*\*", line):
            title = bold[1].lower()
        elif line.startswith("| "):
            what, scene, *cells = line.strip("| ").split(" | ")
            said[title, what, scene.strip("`")] = cells
    return said


def _alike(said: str, value: float, kind: str, tolerance: Tolerance) -> bool:
    """Whether a cell says a number, as well as another run finds it."""
    if said == "–" or not math.isfinite(value):
        return said == "–" and not math.isfinite(value)
    if kind == WHETHER:
        return said == _WORDS[int(value)]
    if kind == ERROR:
        number = 0.01 * float(said.removesuffix(" %").removeprefix("< "))
        low, high = sorted((max(number, _LEAST_ERROR), max(abs(value), _LEAST_ERROR)))
        return bool(high <= 1.05 * tolerance.error * low)  # and what the digits round off
    low, high = sorted((float(said), value))
    factor = tolerance.time if kind == TIME_FACTOR else _ANSWER
    return bool(high <= factor * low or np.isclose(low, high, atol=1e-3))


def answers_agree_within() -> str:
    """How well answers of two runs agree, as the docs say it."""
    return f"{100.0 * (_ANSWER - 1.0):.0f} %"
