"""Compares two result files: their sheets side by side, and what else differs."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import blocks_in_one_unit
from bearingwear.document.show import sheet
from bearingwear.results.kinds import Registry, kind_of
from bearingwear.results.netcdf import CaseFileError, open_result
from bearingwear.results.units import Percent
from bearingwear.scene.checking.errors import leaves

A_AND_B = "A", "B", "difference, %"

NOT_COMPARED = frozenset({"scene", "warnings", "modelled", "residual"})
"""Attributes that are compared as keys of the scene or in the heading, or only with `--all`."""


def comparison_sheet(
    first: str, second: str, more: Registry = MappingProxyType({}), every: bool = False
) -> Document:
    """Returns the sheets of two files of one kind side by side.

    Keys of the scene and attributes that differ follow. With `every`, the sheets contain the
    attributes, which are then not repeated.

    more: for kinds of files that studies define, the dotted name of the function that returns the
        sheet of an open file.
    every: whether to add residuals, error estimates, counts of steps, and versions.
    CaseFileError: a file cannot be read, or their kinds differ.
    """
    kind_a, attributes_a = _kind_and_attributes(first)
    kind_b, attributes_b = _kind_and_attributes(second)
    if kind_a != kind_b:
        problem = f"got the kinds {kind_b} and {kind_a}, expected two files of the same kind"
        raise CaseFileError(f"{second}: {problem}")
    sheet_a, sheet_b = sheet(first, more, every), sheet(second, more, every)
    blocks = list(_compared_blocks(sheet_a, sheet_b))
    # a row of equal values has no third one, the difference
    differing_rows = sum(len(row.values) > 2 for block in blocks for row in block.rows)
    blocks += [
        Block("keys of the scene that differ", A_AND_B, _key_rows(attributes_a, attributes_b)),
        Block(
            "attributes that differ",
            lines=() if every else _attribute_lines(attributes_a, attributes_b),
        ),
    ]
    heading = (
        f"A {first}",
        f"B {second}",
        *_compared_lines(sheet_a.heading, sheet_b.heading),
        f"{differing_rows} rows of the sheets differ",
    )
    facts = {"kind": kind_a, "A": first, "B": second, "differences": differing_rows}
    return Document(heading, facts, tuple(block for block in blocks if block.rows or block.lines))


def _kind_and_attributes(path: str) -> tuple[str, dict[str, Any]]:
    """Returns the kind of a result file, and its global attributes as plain Python values."""
    with open_result(path) as file:
        names = file.ncattrs()
        return kind_of(file), {name: np.asarray(file.getncattr(name)).tolist() for name in names}


def _key_rows(attributes_a: Mapping[str, Any], attributes_b: Mapping[str, Any]) -> tuple[Row, ...]:
    """Returns a row for each key of the scene that differs between the attributes of two files."""
    scene_a, scene_b = (
        leaves(json.loads(attributes.get("scene", "{}")))
        for attributes in (attributes_a, attributes_b)
    )
    differences = _differences(scene_a, scene_b)
    return tuple(_compared_row(Row(key, given=True), a, b) for key, a, b in differences)


def _attribute_lines(
    attributes_a: Mapping[str, Any], attributes_b: Mapping[str, Any]
) -> tuple[str, ...]:
    """Returns a line for each attribute that differs, except those of `NOT_COMPARED`."""
    return tuple(
        f"{name}: A {a}; B {b}"
        for name, a, b in _differences(attributes_a, attributes_b)
        if name not in NOT_COMPARED
    )


def _compared_blocks(sheet_a: Document, sheet_b: Document) -> Iterator[Block]:
    """Yields each block that at least one of the sheets contains, with the values of both."""
    blocks_a, blocks_b = _by_subject(sheet_a.blocks), _by_subject(sheet_b.blocks)
    for subject in dict.fromkeys((*blocks_a, *blocks_b)):
        a, b = blocks_in_one_unit([blocks_a.get(subject, Block()), blocks_b.get(subject, Block())])
        rows, lines = tuple(_compared_rows(a, b)), _compared_lines(a.lines, b.lines)
        yield Block(a.title or b.title, A_AND_B if rows else (), rows, lines, given=a.given)


def _by_subject(blocks: Sequence[Block]) -> dict[tuple[str, int], Block]:
    """Returns blocks by their subjects, and their numbers from 0 among those of the same subject.

    The title `contact (mean of 16 balls)` has the subject `contact`, since the number may differ.
    """
    by_subject: dict[tuple[str, int], Block] = {}
    counts: Counter[str] = Counter()
    for block in blocks:
        subject = block.title.partition(" (")[0]
        by_subject[subject, counts[subject]] = block
        counts[subject] += 1
    return by_subject


def _compared_rows(a: Block, b: Block) -> Iterator[Row]:
    """Yields a row for each quantity and column of the blocks, with the values of both.

    A value that one block lacks is NaN.
    """
    rows_a, rows_b = _rows_by_name(a), _rows_by_name(b)
    for name in dict.fromkeys((*rows_a, *rows_b)):
        values_a = _values_by_column(a, rows_a.get(name))
        values_b = _values_by_column(b, rows_b.get(name))
        row = rows_a.get(name) or rows_b[name]
        for head in dict.fromkeys((*values_a, *values_b)):
            column_row = Row(
                label=f"{row.label}, {head}" if head else row.label,
                unit=row.unit,
                name=f"{name}.{head}" if head else name,
                given=row.given,
            )
            value_a, value_b = values_a.get(head, math.nan), values_b.get(head, math.nan)
            yield _compared_row(column_row, value_a, value_b)


def _rows_by_name(block: Block) -> dict[str, Row]:
    """Returns the rows of a block by their names or labels, without rows that name points."""
    return {row.name or row.label: row for row in block.rows[block.axes :]}


def _values_by_column(block: Block, row: Row | None) -> dict[str, Any]:
    """Returns the values of a row by the heads of its columns; empty without a row.

    Without heads, several values are numbered from `1`, and a single one has an empty head.
    """
    if row is None:
        return {}
    heads: Sequence[str] = block.heads
    if not heads:
        count = len(row.values)
        heads = [""] if count == 1 else [str(number) for number in range(1, count + 1)]
    # not strict: a row may have fewer values than columns
    return dict(zip(heads, row.values, strict=False))


def _compared_row(row: Row, a: Any, b: Any) -> Row:
    """Returns a row with the values of both files and, if they differ, the relative difference [%].

    For words, and relative to zero, it is the word `differs`.
    """
    if a == b or (_is_nan(a) and _is_nan(b)):
        return row._replace(values=(a, b))
    are_numbers = all(isinstance(value, int | float) and math.isfinite(value) for value in (a, b))
    is_relative = are_numbers and a != 0.0
    difference = Percent(100.0 * (b - a) / abs(a)) if is_relative else "differs"
    return row._replace(values=(a, b, difference))


def _is_nan(value: Any) -> bool:
    """Returns whether a cell is NaN, a number that was not computed."""
    return isinstance(value, float) and math.isnan(value)


def _compared_lines(a: Sequence[str], b: Sequence[str]) -> tuple[str, ...]:
    """Returns the lines that both files have, then those of one alone, marked `A: ` or `B: `."""
    common = (line for line in a if line in b)
    only_a = (f"A: {line}" for line in a if line not in b)
    only_b = (f"B: {line}" for line in b if line not in a)
    return (*common, *only_a, *only_b)


def _differences(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[tuple[str, Any, Any]]:
    """Yields the name and both values of each entry that differs.

    An entry that is None counts as missing, and is a dash.
    """
    for name in dict.fromkeys((*a, *b)):
        value_a, value_b = a.get(name), b.get(name)
        if value_a != value_b:
            yield name, _or_dash(value_a), _or_dash(value_b)


def _or_dash(value: Any) -> Any:
    """Returns a value, or a dash for None."""
    return "–" if value is None else value
