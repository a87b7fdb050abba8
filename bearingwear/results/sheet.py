"""A result sheet: as text for people, as JSON or CSV for programs."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from bearingwear.results.units import Interval, Rough, digits

NOT_SOLVED = "not solved"
LABEL_WIDTH, UNIT_WIDTH, VALUE_WIDTH = 28, 11, 13


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


@dataclass(frozen=True)
class Block:
    """Rows below a title, and sentences below them."""

    title: str
    columns: tuple[str, ...] = ()
    rows: tuple[Row, ...] = ()
    lines: tuple[str, ...] = ()
    unit: str = ""
    given: bool = False
    """Whether its numbers were given, and stand as they were."""


@dataclass(frozen=True)
class Sheet:
    """Heading lines, facts for programs, and blocks of rows."""

    heading: tuple[str, ...] = ()
    facts: Mapping[str, Any] = field(default_factory=dict)
    blocks: tuple[Block, ...] = ()

    @property
    def text(self) -> str:
        """For a person."""
        lines = list(self.heading)
        for block in self.blocks:
            lines += ["", *_lines(block)]
        return "\n".join(line.rstrip() for line in lines).strip("\n")

    @property
    def json(self) -> str:
        """For a program: facts, and `quantities` with plain numbers in the unit beside them."""
        quantities = [
            {"block": block.title, "name": row.name or row.label, "label": row.label}
            | {"unit": row.unit}
            | _valued(block, row)
            | _limited(block, row)
            for block in self.blocks
            for row in block.rows
            if row.values
        ]
        return json.dumps({**self.facts, "quantities": quantities}, indent=1, ensure_ascii=False)

    @property
    def csv(self) -> str:
        """For a program: a line for each number; facts stand first."""
        text = io.StringIO()
        table = csv.writer(text, lineterminator="\n")
        table.writerow(["block", "name", "label", "column", "unit", "value"])
        for name, value in self.facts.items():
            for one in value if isinstance(value, list) else [value]:
                table.writerow(["", name, "", "", "", one])
        for block in self.blocks:
            for row in block.rows:
                for k, value in enumerate(map(_plain, row.values)):
                    column = block.columns[k] if k < len(block.columns) else ""
                    several = value if isinstance(value, list) else [value]
                    ends = ("_low", "_high") if len(several) > 1 else ("",)
                    for end, number in zip(ends, several, strict=True):
                        name = (row.name or row.label) + end
                        table.writerow([block.title, name, row.label, column, row.unit, number])
                own = row.name or row.label, row.label
                if row.limit is not None:
                    table.writerow([block.title, *own, "limit", row.unit, row.limit])
                for column, limit in zip(block.columns, row.limits, strict=False):
                    table.writerow([block.title, *own, f"limit, {column}", row.unit, limit])
        return text.getvalue().rstrip("\n")


def _valued(block: Block, row: Row) -> dict[str, Any]:
    values = [_plain(value) for value in row.values]
    if not block.columns:
        return {"value": values[0]} if len(values) == 1 else {"values": values}
    return {"values": dict(zip(block.columns, values, strict=False))}


def _limited(block: Block, row: Row) -> dict[str, Any]:
    if row.limits:
        return {"limit": dict(zip(block.columns, row.limits, strict=False))}
    return {} if row.limit is None else {"limit": row.limit}


def _plain(value: Any) -> Any:
    """A number as JSON has it, or two of an interval; none where there is no number."""
    if isinstance(value, Interval):
        return [_plain(end) for end in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value


def _lines(block: Block) -> list[str]:
    cells = [
        [_shown(value, row.unit, block.given or row.given) for value in row.values]
        for row in block.rows
    ]
    longest = max((len(t) for texts in [block.columns, *cells] for t in texts), default=0)
    label_width = max([LABEL_WIDTH, *(len(row.label) + 2 for row in block.rows)])
    value_width = max(VALUE_WIDTH, longest + 2)

    def line(label: str, unit: str, texts: Iterable[str]) -> str:
        columns = "".join(f"{text:>{value_width}}" for text in texts)
        return f"  {label:<{label_width}}{unit:<{UNIT_WIDTH}}{columns}"

    lines = [line(block.title, block.unit, block.columns)] if block.title else []
    for row, texts in zip(block.rows, cells, strict=True):
        limit = "" if row.limit is None else f"limit {digits(row.limit, row.unit)}"
        each = ", ".join("–" if one is None else digits(one, row.unit) for one in row.limits)
        notes = ", ".join(filter(None, (limit, each and f"limits {each}", row.note)))
        text = line(row.label, row.unit, texts)
        lines.append(f"{text}  {notes}" if notes else text)
    return [*lines, *(f"  {text}" for text in block.lines)]


def _shown(value: Any, unit: str, given: bool) -> str:
    if isinstance(value, Interval) or (isinstance(value, Rough) and math.isfinite(value)):
        return value.text
    if not isinstance(value, float):
        return str(value)
    if given:
        return f"{value:.6g}"
    return NOT_SOLVED if math.isnan(value) else digits(value, unit)
