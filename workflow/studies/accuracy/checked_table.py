"""Tables of docs/accuracy.md: their text, and its differences from another run."""

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
"""Difference of two numbers of a table, in their unit, that their digits may round off."""

ROUNDED_DIGITS = 1.05
"""Factor on tolerances of errors, which tables give with two digits."""

TableCells = dict[tuple[str, ...], list[str]]
"""Cells of numbers, by the title of the table and the first cells of their row."""


class Agreement(NamedTuple):
    """Required agreement of numbers of two runs: within a factor, above a floor."""

    factor: float = ANSWER
    floor: float = 0.0
    unit: str = ""

    def is_met(self, old: str, new: str) -> bool:
        """Whether two cells agree: numbers within the factor, words if they are the same.

        A cell "< x" gives only an upper bound, and numbers below the floor do not matter: the
        magnitudes of both numbers are raised to the largest of bounds and floor. Their ratio must
        then not exceed the factor, or their difference `_ROUNDING`. The smaller of two numbers of
        different signs counts as that largest of bounds and floor.

        old, new: cells as text.
        """
        cells = old, new
        try:
            numbers = [float(cell.removeprefix("< ")) for cell in cells]
        except ValueError:
            return old == new
        bounds = [number for number, cell in zip(numbers, cells, strict=True) if "<" in cell]
        least = max([self.floor, *bounds])
        smaller, larger = sorted(numbers, key=abs)
        if abs(larger) <= least:
            return True
        # a smaller number of the other sign is negative here
        low = max(smaller * math.copysign(1.0, larger), least)
        high = abs(larger)
        return high <= self.factor * low or math.isclose(low, high, abs_tol=_ROUNDING)


@dataclass(frozen=True, kw_only=True)
class CheckedTable:
    """Table of numbers, and how closely another run must agree with each of its columns."""

    title: str
    axes: Sequence[str] = ("case", "scene")  # heads of the first cells, which name a row
    columns: Mapping[str, Agreement]  # by the heads of the other cells
    rows: Sequence[Sequence[Any]]

    @property
    def block(self) -> Block:
        """Returns the table as a block of a document."""
        column_units = {name: agreement.unit for name, agreement in self.columns.items()}
        units = dict.fromkeys(self.axes, "") | column_units
        title = self.title[0].upper() + self.title[1:]
        return points_block(title, units, self.rows, axes=len(self.axes))

    @property
    def text(self) -> str:
        """Returns the table as Markdown, below its title in bold."""
        return block_markdown(self.block, "**{}**")

    def differences(self, text: str) -> Iterator[str]:
        """Yields a line for each number of the table that a Markdown text lacks or contradicts.

        A row that the text lacks, or has with another number of cells, gives one line. Rows of the
        text that the table lacks give none.
        """
        old_rows = table_cells(text, len(self.axes))
        for row, new_cells in table_cells(self.text, len(self.axes)).items():
            place = ": ".join([row[0], ", ".join(row[1:])])
            if len(old_rows.get(row, ())) != len(new_cells):
                yield f"{place}: missing"
                continue
            for (name, agreement), old_cell, new_cell in zip(
                self.columns.items(), old_rows[row], new_cells, strict=True
            ):
                if not agreement.is_met(old_cell, new_cell):
                    problem = f"the table contains {old_cell}, the run gives {new_cell}"
                    yield f"{place}: {name}: {problem}"


def table_cells(text: str, axes: int = 1) -> TableCells:
    """Returns the cells of all tables in a Markdown text whose titles stand above in bold.

    The heads of a table are a row, too. Of equal rows, the last one counts.

    axes: number of first cells, which name a row.
    """
    cells_by_row = TableCells()
    title = ""
    for line in text.splitlines():
        bold_line = re.fullmatch(r"\*\*(.+)\*\*", line)
        if bold_line:
            title = bold_line[1]
        elif line.startswith("| "):
            cells = html.unescape(line.strip("| ")).split(" | ")
            cells_by_row[title, *cells[:axes]] = cells[axes:]
    return cells_by_row


def answer_tolerance_text() -> str:
    """Returns the largest difference of answers that agree, in percent."""
    return f"{digits(100.0 * (ANSWER - 1.0))} %"
