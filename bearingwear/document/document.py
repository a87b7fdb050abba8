"""A document: the headings, tables, sentences and facts that report a result.

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

from bearingwear.results.netcdf import json_faults
from bearingwear.results.units import (
    Display,
    Estimated,
    Interval,
    Percent,
    Rough,
    digits,
    display,
    printed_unit,
)
from bearingwear.results.variables import CASE, LIFE

VARIABLES = CASE | LIFE

PLACES = (
    "",  # folded away below the charts
    "verdict",  # below the headline and the question
    "strip",  # below the verdict
    "lead",  # beside the first chart
    "more",  # sentences as in `lead`, but only if there are no charts
    "open",  # below the charts, and not folded away
    "charted",  # as without a place, but the charts draw the same
)
"""Places of a block on a page."""


class Row(NamedTuple):
    """A quantity of a table, with its values in the unit that is shown.

    `values` are numbers or words, one for each column of the block. `limit` is in the same unit,
    and so are the `limits` of the columns, if these differ. If `given`, the numbers are inputs and
    are shown with all of their digits.
    """

    label: str
    unit: str = ""
    values: tuple[Any, ...] = ()
    name: str = ""  # for programs
    limit: float | None = None
    note: str = ""  # beside the values
    given: bool = False
    limits: tuple[float | None, ...] = ()

    @property
    def head(self) -> str:
        """Returns the label, with the unit in brackets."""
        label = self.label.strip()
        return f"{label} ({printed_unit(self.unit)})" if self.unit else label


@dataclass(frozen=True)
class Block:
    """A title, a table below it, and sentences below the table; any of these may be missing."""

    title: str = ""
    columns: tuple[str, ...] = ()
    rows: tuple[Row, ...] = ()
    lines: tuple[str, ...] = ()  # sentences
    unit: str = ""  # beside the title, in text
    given: bool = False  # whether its numbers are inputs, shown with all of their digits
    # Not zero: the table has a line for each point and a column for each row; this number of first
    # rows name the point.
    axes: int = 0
    place: str = ""  # one of `PLACES`
    notes: str = ""  # head of the column of notes

    @property
    def heads(self) -> tuple[str, ...]:
        """Returns the heads of the columns; in a table of points, the words for each point."""
        if not self.axes:
            return self.columns
        return tuple(", ".join(point) for point in zip(*self.cells[: self.axes], strict=True))

    @property
    def cells(self) -> list[list[str]]:
        """Returns the values as texts, a list for each row."""
        return [
            [shown_value(value, row.unit, self.given or row.given) for value in row.values]
            for row in self.rows
        ]

    @property
    def table(self) -> tuple[list[str], list[list[str]]]:
        """Returns the heads of the columns and the lines of the table, for a page or Markdown.

        The last column has the notes, if any row has some.
        """
        cells = self.cells
        if self.axes:
            heads = [row.head for row in self.rows]
            return heads, [list(line) for line in zip(*cells, strict=True)]
        lines = [[row.head, *texts] for row, texts in zip(self.rows, cells, strict=True)]
        width = max((len(line) for line in lines), default=0)
        heads = ["", *self.columns, *[""] * (width - 1 - len(self.columns))]
        notes = [row_notes(row) for row in self.rows]
        if any(notes):
            heads.append(self.notes)
            lines = [[*line, note] for line, note in zip(lines, notes, strict=True)]
        return heads, lines


@dataclass(frozen=True)
class Document:
    """A report: heading lines (the first is the title), facts for programs, blocks and figures.

    The navigation of a page names it by its `subject`, and documents follow each other by `rank`.
    On a page, the facts contain the name of the `scene`, and a line on its `bearing`.
    """

    heading: tuple[str, ...] = ()
    facts: Mapping[str, Any] = field(default_factory=dict)
    blocks: tuple[Block, ...] = ()
    figures: tuple[str, ...] = ()
    subject: str = ""
    rank: int = 0

    def __str__(self) -> str:
        """Returns the document as text for a terminal."""
        from bearingwear.document.text import as_text

        return as_text(self)

    def _repr_html_(self) -> str:
        """Returns the document as HTML, which a notebook shows."""
        from bearingwear.document.html import as_html

        return as_html(self)

    @property
    def title(self) -> str:
        """Returns the first heading line."""
        return self.heading[0] if self.heading else ""

    def blocks_in(self, *places: str) -> list[Block]:
        """Returns the blocks whose place is one of `places`."""
        return [block for block in self.blocks if block.place in places]

    @property
    def stored(self) -> str:
        """Returns the document as JSON, which `load_document` and `sheet_in_file` read back."""
        return (
            json.dumps(_encoded(asdict(self)), ensure_ascii=False, indent=1, allow_nan=False) + "\n"
        )


def row_of(
    name: str, numbers: Iterable[Any], limit: float | None = None, unit: Display | None = None
) -> Row:
    """Returns the row of a variable of a case or life, converted from units of files.

    name: of the variable, which determines the label.
    numbers, limit: in the unit of the variable in files.
    unit: in which they are shown; by default one that suits their size.
    """
    variable = VARIABLES[name]
    values = [float(number) for number in numbers]
    limits = [] if limit is None else [limit]
    unit = unit or display(variable.units, values, limits, shown=variable.shown)
    return Row(
        label=variable.label or name.replace("_", " "),
        unit=unit.unit,
        values=tuple(unit.of(value) for value in values),
        name=name,
        limit=None if limit is None else unit.of(limit),
    )


def quantity_row(
    label: str, units: str, numbers: Iterable[Any], name: str = "", shown: str = ""
) -> Row:
    """Returns a row of numbers that are in no table of variables, converted to one shown unit.

    units: of the numbers, as in files.
    name: of the row, for programs.
    shown: key of `units.SCALES` for their display; by default `units`.
    """
    values = [float(number) for number in numbers]
    unit = display(units, values, shown=shown)
    return Row(label, unit.unit, tuple(unit.of(value) for value in values), name)


def shown_value(value: Any, unit: str = "", given: bool = False) -> str:
    """Returns the text of a value.

    unit: shown unit of the value.
    given: whether the value is an input, which is shown with seven digits instead of three.
    """
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
    """Returns the notes of a row: its criterion, the criteria of its columns, and its own note."""
    notes = []
    if row.limit is not None:
        notes.append(f"criterion {digits(row.limit, row.unit)}")
    if row.limits:
        limits = ("–" if limit is None else digits(limit, row.unit) for limit in row.limits)
        notes.append(f"criteria {', '.join(limits)}")
    if row.note:
        notes.append(row.note)
    return ", ".join(notes)


def load_document(path: Path) -> Document:
    """Returns the document in a JSON file (`Document.stored`). CaseFileError: it cannot be read."""
    with json_faults(path, "a document"):
        return _document(path.read_text(encoding="utf-8"))


def sheet_in_file(file: Any) -> Document:
    """Returns the sheet that an open result file stores in its attribute `sheet`."""
    return _document(file.sheet)


def _document(stored: str) -> Document:
    """Returns the document that a text describes, which is `Document.stored`."""
    content = _decoded(json.loads(stored))
    blocks = tuple(
        Block(**block | {"rows": tuple(Row(**row) for row in block["rows"])})
        for block in content.pop("blocks")
    )
    return Document(blocks=blocks, **content)


def _encoded(value: Any) -> Any:
    """Returns a value in types of JSON, from which `_decoded` restores it.

    A number of a special class, or one that is not finite, becomes an object with a single key.
    """
    if isinstance(value, Rough):
        return {"rough": _encoded(float(value))}
    if isinstance(value, Estimated):
        return {"estimated": _encoded([float(value), value.error])}
    if isinstance(value, Interval):
        return {"interval": _encoded([*value])}
    if isinstance(value, float) and not math.isfinite(value):
        return {"number": str(value)}
    if isinstance(value, Row):
        value = value._asdict()
    if isinstance(value, Mapping):
        return {key: _encoded(item) for key, item in value.items()}
    return [_encoded(item) for item in value] if isinstance(value, tuple | list) else value


def _decoded(value: Any) -> Any:
    """Returns the value that `_encoded` has converted to this one; lists become tuples."""
    if isinstance(value, dict):
        if value.keys() == {"rough"}:
            return Rough(_decoded(value["rough"]))
        if value.keys() == {"estimated"}:
            return Estimated.of(*_decoded(value["estimated"]))
        if value.keys() == {"interval"}:
            return Interval(*_decoded(value["interval"]))
        if value.keys() == {"number"}:
            return float(value["number"])
        return {key: _decoded(item) for key, item in value.items()}
    return tuple(_decoded(item) for item in value) if isinstance(value, list) else value
