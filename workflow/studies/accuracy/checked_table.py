"""Tables of docs/accuracy.md: their text, and where it differs from another run."""

import html
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from bearingwear.document.document import Block
from bearingwear.document.markdown import block_markdown
from bearingwear.document.table import points_block
from bearingwear.results.units import digits

ANSWER = 1.02
"""Factor within which two runs of the same program give the same answer."""
_ROUNDING = 1e-3

TableCells = dict[tuple[str, ...], list[str]]
"""TableCells of numbers by the title and the first cells of their row."""


class Agreement(NamedTuple):
    """How well numbers of two runs agree: within a factor, where they exceed a floor."""

    factor: float = ANSWER
    floor: float = 0.0
    unit: str = ""

    def holds(self, old: str, new: str) -> bool:
        """Whether two cells agree; words do where they are the same."""
        try:
            numbers = [float(text.removeprefix("< ")) for text in (old, new)]
        except ValueError:
            return old == new
        limits = [number for number, text in zip(numbers, (old, new), strict=True) if "<" in text]
        low, high = sorted(max(number, self.floor, *limits) for number in numbers)
        return high <= self.factor * low or math.isclose(low, high, abs_tol=_ROUNDING)


@dataclass(frozen=True, kw_only=True)
class CheckedTable:
    """Rows of what and on which scene, and numbers; how well the columns agree, by their heads."""

    title: str
    axes: Sequence[str] = ("case", "scene")
    columns: Mapping[str, Agreement]
    rows: Sequence[Sequence[Any]]

    @property
    def block(self) -> Block:
        units = dict.fromkeys(self.axes, "") | {k: one.unit for k, one in self.columns.items()}
        title = self.title[0].upper() + self.title[1:]
        return points_block(title, units, self.rows, axes=len(self.axes))

    @property
    def text(self) -> str:
        """As Markdown, for a larger text."""
        return block_markdown(self.block, "**{}**")

    def differences(self, text: str) -> Iterator[str]:
        """Where a text that should contain this table differs from it; a line each."""
        old = table_cells(text, len(self.axes))
        for row, new in table_cells(self.text, len(self.axes)).items():
            where = ": ".join([row[0], ", ".join(row[1:])])
            if len(old.get(row, ())) != len(new):
                yield f"{where}: missing"
                continue
            for (name, agreement), one, other in zip(
                self.columns.items(), old[row], new, strict=True
            ):
                if not agreement.holds(one, other):
                    yield f"{where}: {name}: the table contains {one}, the run gives {other}"


def table_cells(text: str, axes: int = 1) -> TableCells:
    """TableCells of all tables of a Markdown text that stand below a line in bold."""
    found, title = TableCells(), ""
    for line in text.splitlines():
        if bold := re.fullmatch(r"\*\*(.+)\*\*", line):
            title = bold[1]
        elif line.startswith("| "):
            cells = html.unescape(line.strip("| ")).split(" | ")
            found[title, *cells[:axes]] = cells[axes:]
    return found


def answers_agree_within() -> str:
    return f"{digits(100.0 * (ANSWER - 1.0))} %"
