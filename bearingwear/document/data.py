"""A document for programs: JSON and CSV."""

from __future__ import annotations

import csv
import io
import itertools
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from bearingwear.document.document import Block, Document, Row
from bearingwear.results.units import Interval

if TYPE_CHECKING:
    import xarray as xr


def as_json(document: Document) -> str:
    """Facts, and `quantities` with plain numbers in the unit beside them."""
    quantities = [
        {"block": block.title, "name": row.name or row.label, "label": row.label}
        | {"unit": row.unit}
        | _valued(block, row)
        | _limited(block, row)
        for block in document.blocks
        for row in block.rows
        if row.values
    ]
    data = {**document.facts, "quantities": quantities}
    return json.dumps(data, indent=1, ensure_ascii=False)


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
    return _csv(lines).rstrip("\n")


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


def _csv(lines: Sequence[Sequence[Any]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(lines)
    return text.getvalue()


def dataset_csv(dataset: xr.Dataset, axes: Mapping[str, str]) -> str:
    """A row for each point of a dataset and a column for each number, its unit in the header.

    A variable over further dimensions has a column for each of their flags.

    Parameters
    ----------
    dataset : Dataset
    axes : mapping
        The head of the column of each dimension that points lie along.
    """
    columns = {
        head: texts for name in dataset.data_vars for head, texts in _of(dataset, name, axes)
    }
    along = [_axis_texts(dataset[axis]) for axis in axes]
    points = itertools.product(*along)
    rows = zip(*columns.values(), strict=True)
    lines = [[*point, *row] for point, row in zip(points, rows, strict=True)]
    return _csv([[*axes.values(), *columns], *lines])


def _of(dataset: xr.Dataset, name: Any, axes: Mapping[str, str]) -> Iterator[tuple[str, list[str]]]:
    """Head and texts of each column of a variable, if it lies along the axes."""
    variable = dataset[name]
    if not set(axes) <= set(variable.dims):
        return
    values = variable.transpose(*axes, ...)
    inner = values.dims[len(axes) :]
    unit = f" ({variable.attrs['units']})" if variable.attrs.get("units", "1") != "1" else ""
    flags = variable.attrs.get("flag_meanings", "").split()
    for index in np.ndindex(*values.shape[len(axes) :]):
        words = [flag_names(dataset[dim])[k] for dim, k in zip(inner, index, strict=True)]
        numbers = values.values[(..., *index)].ravel()
        yield ".".join([str(name), *words]) + unit, [cell_text(x, flags) for x in numbers]


def _axis_texts(coordinate: xr.DataArray) -> list[str]:
    if "flag_meanings" in coordinate.attrs:
        return flag_names(coordinate)
    return [f"{value:g}" for value in coordinate.values]


def cell_text(number: float, flags: Sequence[str] | None) -> str:
    """A number with nine digits, a flag by its name, nothing where it is missing."""
    if not np.isfinite(number):
        return ""
    return flags[int(number)] if flags else f"{number:.9g}"


def flag_names(coordinate: xr.DataArray) -> list[str]:
    """The names of the flags along a dimension."""
    names = coordinate.attrs["flag_meanings"].split()
    return [names[int(flag)] for flag in coordinate.values]
