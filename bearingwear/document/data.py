"""A document for programs: JSON and CSV."""

from __future__ import annotations

import csv
import io
import itertools
import json
import math
from collections.abc import Iterator
from typing import Any

from bearingwear.document.document import Block, Document, Row
from bearingwear.results.units import Interval


def as_json(document: Document) -> str:
    """Facts, `sentences` by their titles, and `quantities`: plain numbers, the unit beside them.

    All in ASCII, other characters escaped, so that any locale passes it on unchanged.
    """
    quantities = [
        {"block": block.title, "name": row.name or row.label, "label": row.label}
        | {"unit": row.unit}
        | _valued(block, row)
        | _limited(block, row)
        for block in document.blocks
        for row in block.rows
        if row.values
    ]
    said = {block.title: block.lines for block in document.blocks if not block.rows and block.title}
    data = {**document.facts, **({"sentences": said} if said else {}), "quantities": quantities}
    return json.dumps(data, indent=1)


def _valued(block: Block, row: Row) -> dict[str, Any]:
    values = [_plain(value) for value in row.values]
    if not block.heads:
        return {"value": values[0]} if len(values) == 1 else {"values": values}
    return {"values": dict(zip(block.heads, values, strict=False))}


def _limited(block: Block, row: Row) -> dict[str, Any]:
    if row.limits:
        return {"limit": dict(zip(block.heads, row.limits, strict=False))}
    return {} if row.limit is None else {"limit": row.limit}


def _plain(value: Any) -> Any:
    """A number as JSON has it, or two of an interval; none where there is no number."""
    if isinstance(value, Interval):
        return [_plain(end) for end in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value


def as_csv(document: Document) -> str:
    """A line for each number; facts stand first."""
    lines: list[list[Any]] = [["block", "name", "label", "column", "unit", "value"]]
    for name, value in document.facts.items():
        for one in value if isinstance(value, list | tuple) else [value]:
            lines.append(["", name, "", "", "", one])
    for block in document.blocks:
        for row in block.rows:
            lines += [[block.title, *line] for line in _numbers(block, row)]
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(lines)
    return text.getvalue().rstrip("\n")


def _numbers(block: Block, row: Row) -> Iterator[tuple[Any, ...]]:
    """Of each number of a row: name, label, column, unit, value."""
    name = row.name or row.label
    for column, value in itertools.zip_longest(block.heads, map(_plain, row.values), fillvalue=""):
        several = value if isinstance(value, list) else [value]
        ends = ("_low", "_high") if len(several) > 1 else ("",)
        for end, number in zip(ends, several, strict=True):
            yield name + end, row.label, column, row.unit, number
    if row.limit is not None:
        yield name, row.label, "limit", row.unit, row.limit
    for column, limit in zip(block.heads, row.limits, strict=False):
        yield name, row.label, f"limit, {column}", row.unit, limit
