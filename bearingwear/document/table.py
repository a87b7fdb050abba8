"""Points of a dataset: as a table of a document, and as CSV."""

from __future__ import annotations

import csv
import io
import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from bearingwear.document.document import VARIABLES, Block, Row
from bearingwear.results.units import Estimated, display
from bearingwear.results.variables import STIFFNESS_UNITS

if TYPE_CHECKING:
    import xarray as xr


def table_of(
    dataset: xr.Dataset,
    axes: Sequence[str],
    columns: Sequence[tuple[xr.DataArray | str, str]],
    title: str = "",
    lines: tuple[str, ...] = (),
    errors: Sequence[xr.DataArray | None] = (),
) -> Block:
    """A table with a line for each point along some axes; labels and units are the variables' own.

    axes: dimensions that points lie along; each has a column.
    columns: a variable over the axes, or its name, which may go on after a point; and what tells
        the column from others of the same variable. All columns of a variable have one unit.
    title, lines: of the block.
    errors: relative error of each column, which decides its digits; None if it is not known.
    """
    found = [(dataset[v] if isinstance(v, str) else v, words) for v, words in columns]
    points = itertools.product(*(_axis_texts(dataset[axis]) for axis in axes))
    rows = []
    for axis, texts in zip(axes, zip(*points, strict=True), strict=True):
        words = tuple(text.replace("_", " ") for text in texts)
        units = display(dataset[axis].attrs.get("units", "1")).unit
        rows.append(Row(axis.replace("_", " "), units, words, axis))
    for (variable, which), error in zip(found, errors or [None] * len(found), strict=True):
        name, units, shown = _kind(variable)
        known = VARIABLES.get(name)
        label = ", ".join(filter(None, (known.label if known else name.replace("_", " "), which)))
        alike = [v for v, _ in found if _kind(v) == (name, units, shown)]
        unit = display(units, *alike, shown=shown)
        numbers = unit.of(variable.transpose(*axes).values.ravel()).tolist()
        if error is not None:
            relative = error.transpose(*axes).values.ravel().tolist()
            pairs = zip(numbers, relative, strict=True)
            numbers = [Estimated.of(number, abs(number) * share) for number, share in pairs]
        own = ".".join(filter(None, (name, which.replace(", ", "."))))
        rows.append(Row(label, unit.unit, tuple(numbers), own))
    return Block(title, rows=tuple(rows), lines=lines, axes=len(axes))


def points_block(
    title: str,
    columns: Mapping[str, str],
    points: Sequence[Sequence[Any]],
    axes: int = 1,
) -> Block:
    """A table of points, each with a value for each column; columns by label, with their units."""
    rows = (
        Row(label, unit, tuple(point[k] for point in points))
        for k, (label, unit) in enumerate(columns.items())
    )
    return Block(title, rows=tuple(rows) if points else (), axes=axes)


def _kind(variable: xr.DataArray) -> tuple[str, str, str]:
    """Name in the table of variables, unit of the file, and what it is shown as."""
    name, units = str(variable.name).partition(".")[0], variable.attrs.get("units", "1")
    known = VARIABLES.get(name)
    own = known.shown if known and known.units == units else ""
    return name, units, variable.attrs.get("shown", own)


def dataset_csv(dataset: xr.Dataset, axes: Mapping[str, str]) -> str:
    """A row for each point of a dataset and a column for each number, its unit in the header.

    A variable over further dimensions has a column for each of their flags.

    axes: the head of the column of each dimension that points lie along.
    """
    columns = {
        head: texts for name in dataset.data_vars for head, texts in _of(dataset, name, axes)
    }
    axis_texts = [_axis_texts(dataset[axis]) for axis in axes]
    points = itertools.product(*axis_texts)
    rows = zip(*columns.values(), strict=True)
    lines = [[*point, *row] for point, row in zip(points, rows, strict=True)]
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([[*axes.values(), *columns], *lines])
    return text.getvalue()


def _of(dataset: xr.Dataset, name: Any, axes: Mapping[str, str]) -> Iterator[tuple[str, list[str]]]:
    """Head and texts of each column of a variable, if it lies along the axes."""
    variable = dataset[name]
    if not set(axes) <= set(variable.dims):
        return
    values = variable.transpose(*axes, ...)
    inner = values.dims[len(axes) :]
    flags = variable.attrs.get("flag_meanings", "").split()
    for index in np.ndindex(*values.shape[len(axes) :]):
        words = [flag_names(dataset[dim])[k] for dim, k in zip(inner, index, strict=True)]
        numbers = values.values[(..., *index)].ravel()
        unit = variable.attrs.get("units", "1")
        if "dof_column" in inner:
            unit = STIFFNESS_UNITS[sum(word.startswith("tilt") for word in words)]
        head = ".".join([str(name), *words]) + (f" ({unit})" if unit != "1" else "")
        yield head, [cell_text(x, flags) for x in numbers]


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
    names = coordinate.attrs.get("flag_meanings", "").split()
    return [names[int(flag)] for flag in coordinate.values]
