"""Numbers of others beside the program's own: a row, the total of a group, tables and scatter."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "validation.md"
FIGURES = ROOT / "docs" / "figures"


@dataclass(frozen=True)
class Row:
    """A number of others beside the program's own, and how near it has to be.

    The difference is relative, or in the unit where it is `absolute`.
    """

    source: str
    what: str
    unit: str
    expected: float
    found: float
    tolerance: float
    absolute: bool = False

    @property
    def difference(self) -> float:
        if self.absolute:
            return self.found - self.expected
        return self.found / self.expected - 1.0

    @property
    def kept(self) -> bool:
        return abs(self.difference) <= self.tolerance

    def said(self, value: float, sign: str = "") -> str:
        """A difference in words."""
        if self.absolute:
            return f"{value:{sign}.2g} {self.unit}"
        return f"{100 * value:{sign}.2g} %"


@dataclass(frozen=True)
class Group:
    """Rows of one kind, and the root of their mean square difference that is allowed.

    A group that `fails` is known to differ by more; it stands on the page with the others.
    """

    name: str
    source: str
    rows: Sequence[Row]
    allowed: float
    fails: bool = False

    @property
    def differences(self) -> np.ndarray:
        return np.array([row.difference for row in self.rows])

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean(self.differences**2)))

    @property
    def suspects(self) -> list[Row]:
        """Rows further off than theirs may be: misprints, or faults of the program."""
        return [row for row in self.rows if not row.kept]


def table(heads: Sequence[str], lines: Iterable[Sequence[str]], left: int) -> str:
    """Markdown; the first columns are text."""
    marks = ["---"] * left + ["---:"] * (len(heads) - left)
    return "\n".join(f"| {' | '.join(line)} |" for line in (heads, marks, *lines))


def totals(groups: Iterable[Group]) -> str:
    """One line a group."""
    lines = []
    for group in groups:
        one, d = group.rows[0], group.differences
        largest = float(d[np.argmax(np.abs(d))])
        lines.append(
            (group.name, group.source, str(len(d)), one.said(group.rms), one.said(d.mean(), "+"),
             one.said(largest, "+"),
             f"{one.said(group.allowed)}{': fails' * group.fails}")
        )  # fmt: skip
    heads = ("quantity", "source", "rows", "rms", "mean", "largest", "allowed rms")
    return table(heads, lines, 2)


def row_table(rows: Iterable[Row]) -> str:
    """One line a row."""
    heads = ("source", "quantity", "unit", "reference", "computed", "difference", "allowed")
    lines = [
        (row.source, row.what, row.unit, f"{row.expected:.6g}", f"{row.found:.6g}",
         row.said(row.difference, "+"), row.said(row.tolerance))
        for row in rows
    ]  # fmt: skip
    return table(heads, lines, 3)


def with_block(text: str, name: str, block: str) -> str:
    """A page with what stands between the markers of a name replaced."""
    marks = f"<!-- {name}: begin -->\n", f"\n<!-- {name}: end -->"
    pattern = re.compile(f"{re.escape(marks[0])}.*?{re.escape(marks[1].strip())}", re.S)
    if not pattern.search(text):
        raise ValueError(f"{PAGE}: got no block {name}, expected {marks[0].strip()}")
    return pattern.sub(lambda _: marks[0] + "\n" + block + "\n" + marks[1], text)


def scatter(axes: Any, rows: Sequence[Row], log: bool) -> None:
    """Computed values over those of a maker, with the line of equality."""
    theirs, ours = [row.expected for row in rows], [row.found for row in rows]
    ends = min(theirs + ours), max(theirs + ours)
    axes.plot(ends, ends, color="0.4", linewidth=0.8)
    axes.plot(theirs, ours, color="C2", marker="o", markersize=2.5, linestyle="none")
    if log:
        axes.set_xscale("log")
        axes.set_yscale("log")


def histogram(axes: Any, values: np.ndarray, step: float) -> None:
    """How often differences of a size are, zero in the middle of a bar."""
    reach = step * (np.ceil(np.abs(values).max() / step) + 0.5)
    axes.hist(values, bins=np.arange(-reach, reach + step, step), color="C2")
    axes.set_ylabel("number of values")
    axes.axvline(0.0, color="0.4", linewidth=0.8)
