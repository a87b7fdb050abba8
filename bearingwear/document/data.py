"""Renders a document for programs: JSON and CSV."""

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
    """Returns a JSON object: the facts, `sentences` by titles of blocks, and `quantities`.

    A quantity has its numbers without rounding, and their unit; a number that is not finite is
    null. The text is in ASCII, with other characters escaped, so that it is the same in any locale.
    """
    quantities = [
        {
            "block": block.title,
            "name": row.name or row.label,
            "label": row.label,
            "unit": row.unit,
        }
        | _value_entry(block, row)
        | _limit_entry(block, row)
        for block in document.blocks
        for row in block.rows
        if row.values
    ]
    sentences = {
        block.title: block.lines for block in document.blocks if not block.rows and block.title
    }
    data = dict(document.facts)
    if sentences:
        data["sentences"] = sentences
    data["quantities"] = quantities
    return json.dumps(_plain(data), indent=1, allow_nan=False)


def _value_entry(block: Block, row: Row) -> dict[str, Any]:
    """Returns the values of a row as an entry of JSON.

    With heads of columns, it is `values`, a dict by these heads. Without heads, it is `value` for a
    single value, and `values` for a list of several.
    """
    values = [_plain(value) for value in row.values]
    if not block.heads:
        return {"value": values[0]} if len(values) == 1 else {"values": values}
    # not strict: in a comparison, a row of equal values has none in the column of differences
    return {"values": dict(zip(block.heads, values, strict=False))}


def _limit_entry(block: Block, row: Row) -> dict[str, Any]:
    """Returns the limit of a row as an entry of JSON, `limit`; empty without a limit.

    Limits that differ between the columns are a dict by the heads of these.
    """
    if row.limits:  # one for each value, of which a row may have fewer than there are columns
        return {"limit": dict(zip(block.heads, row.limits, strict=False))}
    return {} if row.limit is None else {"limit": row.limit}


def _plain(value: Any) -> Any:
    """Returns a value in types of JSON, which has neither intervals nor NaN nor infinity.

    An interval becomes a list of two numbers, and a number that is not finite becomes None, also
    within dicts and lists.
    """
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, Interval | list | tuple):
        return [_plain(item) for item in value]
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value


def as_csv(document: Document) -> str:
    """Returns CSV: a line of heads, then one for each fact and for each number of a table.

    Headings and sentences are left out. A fact that is a list has a line for each item, and a dict
    is written as JSON.
    """
    lines: list[list[Any]] = [["block", "name", "label", "column", "unit", "value"]]
    for name, value in document.facts.items():
        for item in value if isinstance(value, list | tuple) else [value]:
            text = json.dumps(_plain(item)) if isinstance(item, dict) else item
            lines.append(["", name, "", "", "", text])
    for block in document.blocks:
        for row in block.rows:
            lines += [[block.title, *line] for line in _number_lines(block, row)]
    table = io.StringIO()
    csv.writer(table, lineterminator="\n").writerows(lines)
    return table.getvalue().rstrip("\n")


def _number_lines(block: Block, row: Row) -> Iterator[tuple[Any, ...]]:
    """Yields name, label, column, unit and value of each number of a row and of its limits.

    An interval has two, whose names end in `_low` and `_high`. Without heads, the column is "".
    """
    name = row.name or row.label
    values = [_plain(value) for value in row.values]
    for column, value in itertools.zip_longest(block.heads, values, fillvalue=""):
        numbers = value if isinstance(value, list) else [value]
        suffixes = ("_low", "_high") if len(numbers) > 1 else ("",)
        for suffix, number in zip(suffixes, numbers, strict=True):
            yield name + suffix, row.label, column, row.unit, number
    if row.limit is not None:
        yield name, row.label, "limit", row.unit, row.limit
    for column, limit in zip(block.heads, row.limits, strict=False):  # most rows have none
        yield name, row.label, f"limit, {column}", row.unit, limit
