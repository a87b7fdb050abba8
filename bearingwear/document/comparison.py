"""The sheets of two result files as one, with a column for each and the difference in percent."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import count
from types import MappingProxyType
from typing import Any

import numpy as np

from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import in_one_unit
from bearingwear.document.show import sheet
from bearingwear.results.kinds import Registry, kind_of
from bearingwear.results.netcdf import CaseFileError, opened
from bearingwear.results.units import Percent
from bearingwear.scene.checking.errors import leaves

A_AND_B = "A", "B", "difference, %"

ELSEWHERE = frozenset({"scene", "warnings", "modelled", "residual"})
"""Attributes that are shown as keys of the scene, in the heading, or with `--all`."""


def comparison_sheet(
    first: str, second: str, more: Registry = MappingProxyType({}), every: bool = False
) -> Document:
    """The sheets of two files of one kind; below, keys of the scene and attributes that differ.

    more, every: as of `sheet`. May raise CaseFileError.
    """
    paths, kinds, attributes = (first, second), [], []
    for path in paths:
        with opened(path) as file:
            kinds.append(kind_of(file))
            attributes.append({n: np.asarray(file.getncattr(n)).tolist() for n in file.ncattrs()})
    if kinds[0] != kinds[1]:
        problem = f"got the kinds {kinds[1]} and {kinds[0]}, expected two files of the same kind"
        raise CaseFileError(f"{second}: {problem}")
    sheets = [sheet(path, more, every) for path in paths]
    blocks = list(_blocks(*sheets))
    differ = sum(len(row.values) > 2 for block in blocks for row in block.rows)
    scenes = [leaves(json.loads(file.get("scene", "{}"))) for file in attributes]
    keys = tuple(_row(Row(key, given=True), a, b) for key, a, b in _apart(*scenes))
    others = [one for one in _apart(*attributes) if one[0] not in ELSEWHERE and not every]
    blocks += [
        Block("keys of the scene that differ", A_AND_B, keys),
        Block("attributes that differ", lines=tuple(f"{n}: A {a}; B {b}" for n, a, b in others)),
    ]
    told = _lines(*(one.heading for one in sheets))
    heading = f"A {first}", f"B {second}", *told, f"{differ} rows of the sheets differ"
    facts = {"kind": kinds[0], "A": first, "B": second, "differences": differ}
    return Document(heading, facts, tuple(one for one in blocks if one.rows or one.lines))


def _blocks(a: Document, b: Document) -> Iterator[Block]:
    """Each block of either sheet."""
    of_a, of_b = _by_subject(a.blocks), _by_subject(b.blocks)
    for subject in dict.fromkeys((*of_a, *of_b)):
        pair = in_one_unit([of_a.get(subject, Block()), of_b.get(subject, Block())])
        rows, lines = tuple(_rows(*pair)), _lines(*(block.lines for block in pair))
        title = pair[0].title or pair[1].title
        yield Block(title, A_AND_B if rows else (), rows, lines, given=pair[0].given)


def _by_subject(blocks: Sequence[Block]) -> dict[tuple[str, int], Block]:
    """Blocks by what their titles name, and by number where several name the same.

    A title may count something: `contact (mean of 16 balls)`.
    """
    subjects = [block.title.partition(" (")[0] for block in blocks]
    return {(name, subjects[:k].count(name)): blocks[k] for k, name in enumerate(subjects)}


def _rows(a: Block, b: Block) -> Iterator[Row]:
    """A row for each quantity and column of either block."""
    of_a, of_b = ({row.name or row.label: row for row in one.rows[one.axes :]} for one in (a, b))
    for name in dict.fromkeys((*of_a, *of_b)):
        values_a, values_b = _values(a, of_a.get(name)), _values(b, of_b.get(name))
        of_name = of_a.get(name) or of_b[name]
        for head in dict.fromkeys((*values_a, *values_b)):
            label, own = ", ".join(filter(None, (of_name.label, head))), f"{name}.{head}"
            row = Row(label, of_name.unit, (), own.rstrip("."), given=of_name.given)
            yield _row(row, values_a.get(head, math.nan), values_b.get(head, math.nan))


def _values(block: Block, row: Row | None) -> dict[str, Any]:
    """Values of a row by the heads of their columns, or by their numbers where there are none."""
    if row is None:
        return {}
    heads = block.heads or ([""] if len(row.values) == 1 else map(str, count(1)))
    return dict(zip(heads, row.values, strict=False))


def _row(row: Row, a: Any, b: Any) -> Row:
    """A row with the values of both files; the difference where there is one."""
    if a == b or (a != a and b != b):  # not a number in both
        return row._replace(values=(a, b))
    numbers = all(isinstance(x, int | float) and math.isfinite(x) for x in (a, b))
    return row._replace(
        values=(a, b, Percent(100.0 * (b - a) / abs(a)) if numbers and a else "differs")
    )


def _lines(a: Sequence[str], b: Sequence[str]) -> tuple[str, ...]:
    """Sentences of both files, then those of one of them."""
    only_a, only_b = ([s for s in x if s not in y] for x, y in ((a, b), (b, a)))
    both = (line for line in a if line in b)
    return (*both, *(f"A: {line}" for line in only_a), *(f"B: {line}" for line in only_b))


def _apart(a: Mapping[str, Any], b: Mapping[str, Any]) -> Iterator[tuple[str, Any, Any]]:
    """Name and values of what differs; a dash for what one file lacks."""
    for name in dict.fromkeys((*a, *b)):
        if a.get(name) != b.get(name):
            first, second = ("–" if x.get(name) is None else x[name] for x in (a, b))
            yield name, first, second
