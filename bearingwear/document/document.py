"""What is said to people about a result, written once: text, tables and figures.

Renderers: `text.py` for a terminal, `markdown.py`, `html.py`, and `data.py` (JSON and CSV) for
programs.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from bearingwear.results.netcdf import read_as
from bearingwear.results.units import (
    Display,
    Estimated,
    Interval,
    Percent,
    Rough,
    digits,
    display,
    in_print,
)
from bearingwear.results.variables import CASE, LIFE

VARIABLES = CASE | LIFE

PLACES = ("", "verdict", "strip", "lead", "more", "open", "charted")
"""Where a block stands on a page: folded away, under the headline, above all else, beside the first
chart, there where no charts say it, below all of these, or folded below charts that draw it."""


class Row(NamedTuple):
    """A quantity, its values in the unit that is shown.

    `values` are numbers or words, one for each column of the block; `limit` is in the same unit,
    and so are `limits` of each column where they differ. Numbers that are `given` stand as they
    are.
    """

    label: str
    unit: str = ""
    values: tuple[Any, ...] = ()
    name: str = ""
    limit: float | None = None
    note: str = ""
    given: bool = False
    limits: tuple[float | None, ...] = ()

    @property
    def head(self) -> str:
        """Its label with the unit in brackets."""
        label = self.label.strip()
        return f"{label} ({in_print(self.unit)})" if self.unit else label


@dataclass(frozen=True)
class Block:
    """A table below a title, and sentences below the table; either may be missing."""

    title: str = ""
    columns: tuple[str, ...] = ()
    rows: tuple[Row, ...] = ()
    lines: tuple[str, ...] = ()  # sentences
    unit: str = ""
    given: bool = False  # whether its numbers were given, and stand as they were
    # the first rows that name a point, where the table has a line for each point and a column for
    # each row
    axes: int = 0
    place: str = ""  # one of `PLACES`

    @property
    def heads(self) -> tuple[str, ...]:
        """Names of its columns; of points, as their axes are shown."""
        points = zip(*self.cells[: self.axes], strict=True)
        return tuple(map(", ".join, points)) if self.axes else self.columns

    @property
    def cells(self) -> list[list[str]]:
        """Texts of the values of each row."""
        return [
            [shown_value(value, row.unit, self.given or row.given) for value in row.values]
            for row in self.rows
        ]

    @property
    def table(self) -> tuple[list[str], list[list[str]]]:
        """Heads and lines of its table, for a page or Markdown."""
        cells = self.cells
        if self.axes:
            return [row.head for row in self.rows], [
                list(line) for line in zip(*cells, strict=True)
            ]
        notes = [row_notes(row) for row in self.rows]
        lines = [
            [row.head, *texts, *([note] if any(notes) else [])]
            for row, texts, note in zip(self.rows, cells, notes, strict=True)
        ]
        width = max((len(line) for line in lines), default=0)
        return ["", *self.columns, *[""] * (width - 1 - len(self.columns))], lines


@dataclass(frozen=True)
class Document:
    """Heading lines, the first its title; facts for programs; blocks, and names of figures.

    A page shows it in the navigation by its `subject`; of several, the one of the least `rank`
    leads. Its facts then name the `scene` and its `bearing`.
    """

    heading: tuple[str, ...] = ()
    facts: Mapping[str, Any] = field(default_factory=dict)
    blocks: tuple[Block, ...] = ()
    figures: tuple[str, ...] = ()
    subject: str = ""
    rank: int = 0

    def __str__(self) -> str:
        from bearingwear.document.text import as_text

        return as_text(self)

    def _repr_html_(self) -> str:
        from bearingwear.document.html import as_html

        return as_html(self)

    @property
    def title(self) -> str:
        """The first line."""
        return self.heading[0] if self.heading else ""

    def placed(self, *places: str) -> list[Block]:
        """Blocks of some places."""
        return [block for block in self.blocks if block.place in places]

    @property
    def stored(self) -> str:
        """As `load_document` and `sheet_in_file` read it."""
        return json.dumps(_encoded(asdict(self)), ensure_ascii=False, indent=1) + "\n"


def row_of(
    name: str, numbers: Iterable[Any], limit: float | None = None, unit: Display | None = None
) -> Row:
    """The row of a variable of a case or life, from values of the file."""
    known = VARIABLES[name]
    found = [float(number) for number in numbers]
    unit = unit or display(known.units, found, [] if limit is None else limit, shown=known.shown)
    return Row(
        known.label or name.replace("_", " "),
        unit.unit,
        tuple(unit.of(number) for number in found),
        name,
        None if limit is None else unit.of(limit),
    )


def quantity_row(
    label: str, units: str, numbers: Iterable[Any], name: str = "", shown: str = ""
) -> Row:
    """A row of numbers in the units of files, in the unit that they are shown in together."""
    found = [float(number) for number in numbers]
    unit = display(units, found, shown=shown)
    return Row(label, unit.unit, tuple(unit.of(number) for number in found), name)


def shown_value(value: Any, unit: str = "", given: bool = False) -> str:
    """The text of a value in the unit that is shown."""
    if isinstance(value, Rough):
        return value.in_unit(unit)
    if isinstance(value, Interval | Percent) or (
        isinstance(value, Estimated) and math.isfinite(value)
    ):
        return value.text
    if not isinstance(value, float):
        return str(value)
    if given and math.isfinite(value):
        return f"{value:.7g}"
    return digits(value, unit)


def row_notes(row: Row) -> str:
    """Notes of a row: its end-of-life criterion, those of each column, and its own."""
    limit = "" if row.limit is None else f"criterion {digits(row.limit, row.unit)}"
    each = ", ".join("–" if one is None else digits(one, row.unit) for one in row.limits)
    return ", ".join(filter(None, (limit, each and f"criteria {each}", row.note)))


def load_document(path: Path) -> Document:
    """A document that a step of a study wrote. Raises CaseFileError."""
    with read_as(path, "a document"):
        return _document(path.read_text(encoding="utf-8"))


def sheet_in_file(file: Any) -> Document:
    """The sheet that an open result file has as its attribute `sheet`."""
    return _document(file.sheet)


def _document(stored: str) -> Document:
    read = _decoded(json.loads(stored))
    blocks = tuple(
        Block(**block | {"rows": tuple(Row(**row) for row in block["rows"])})
        for block in read.pop("blocks")
    )
    return Document(blocks=blocks, **read)


def _encoded(value: Any) -> Any:
    """A value as JSON has it; what is no plain number says what it is."""
    if isinstance(value, Rough):
        return {"rough": float(value)}
    if isinstance(value, Estimated):
        return {"estimated": [float(value), value.error]}
    if isinstance(value, Interval):
        return {"interval": [*value]}
    if isinstance(value, Row):
        value = value._asdict()
    if isinstance(value, Mapping):
        return {key: _encoded(one) for key, one in value.items()}
    return [_encoded(one) for one in value] if isinstance(value, tuple | list) else value


def _decoded(value: Any) -> Any:
    """What `_encoded` was given; lists come back as tuples."""
    if isinstance(value, dict):
        if value.keys() == {"rough"}:
            return Rough(value["rough"])
        if value.keys() == {"estimated"}:
            return Estimated.of(*value["estimated"])
        if value.keys() == {"interval"}:
            return Interval(*value["interval"])
        return {key: _decoded(one) for key, one in value.items()}
    return tuple(_decoded(one) for one in value) if isinstance(value, list) else value
