"""Tables of the points of a dataset: as a block of a document, and as CSV."""

from __future__ import annotations

import csv
import io
import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bearingwear.document.document import VARIABLES, Block, Row
from bearingwear.results.units import Estimated, display
from bearingwear.results.variables import STIFFNESS_UNITS

if TYPE_CHECKING:
    import xarray as xr


def dataset_table(
    dataset: xr.Dataset,
    axes: Sequence[str],
    columns: Sequence[tuple[xr.DataArray | str, str]],
    title: str = "",
    lines: tuple[str, ...] = (),
    errors: Sequence[xr.DataArray | None] = (),
) -> Block:
    """Returns a table with a line for each point along `axes`.

    axes: dimensions along which the points lie; each has a column.
    columns: for each column, a variable over the axes or its name, and words that distinguish the
        column from others of the same variable. The name may have a suffix after a point. All
        columns of a variable have one unit.
    title, lines: of the block.
    errors: for each column, the relative errors, which determine the digits, or None.
    """
    variables = [
        dataset[variable] if isinstance(variable, str) else variable for variable, _ in columns
    ]
    rows = _axis_rows(dataset, axes)
    column_errors = errors or [None] * len(columns)
    for variable, (_, words), error in zip(variables, columns, column_errors, strict=True):
        quantity = _quantity(variable)
        table_entry = VARIABLES.get(quantity.name)
        label = table_entry.label if table_entry else quantity.name.replace("_", " ")
        same_quantity = [other for other in variables if _quantity(other) == quantity]
        unit = display(quantity.units, *same_quantity, shown=quantity.shown)
        numbers = unit.of(variable.transpose(*axes).values.ravel()).tolist()
        if error is not None:
            relative = error.transpose(*axes).values.ravel().tolist()
            numbers = [
                Estimated.of(number, abs(number) * share)
                for number, share in zip(numbers, relative, strict=True)
            ]
        row = Row(label=label, unit=unit.unit, values=tuple(numbers), name=quantity.name)
        if words:
            name = f"{quantity.name}.{words.replace(', ', '.')}"
            row = row._replace(label=f"{label}, {words}", name=name)
        rows.append(row)
    return Block(title, rows=tuple(rows), lines=lines, axes=len(axes))


def _axis_rows(dataset: xr.Dataset, axes: Sequence[str]) -> list[Row]:
    """Returns a row for each axis, with the coordinate of every point as text.

    The points are all combinations of the coordinates; those of the last axis change fastest.
    """
    points = itertools.product(*(_axis_texts(dataset[axis]) for axis in axes))
    texts_by_axis = zip(*points, strict=True)
    rows = []
    for axis, texts in zip(axes, texts_by_axis, strict=True):
        words = tuple(text.replace("_", " ") for text in texts)
        unit = display(dataset[axis].attrs.get("units", "1")).unit
        rows.append(Row(axis.replace("_", " "), unit, words, axis))
    return rows


def points_block(
    title: str,
    columns: Mapping[str, str],
    points: Sequence[Sequence[Any]],
    axes: int = 1,
) -> Block:
    """Returns a table with a line for each point; without points, it has no rows.

    columns: unit of each column, by its label.
    points: the values of each point, in the order of the columns.
    axes: number of first columns that name a point.
    """
    rows = (
        Row(label, unit, tuple(point[k] for point in points))
        for k, (label, unit) in enumerate(columns.items())
    )
    return Block(title, rows=tuple(rows) if points else (), axes=axes)


class _Quantity(NamedTuple):
    """The properties of a variable that determine the unit of its columns."""

    name: str  # in the table of variables
    units: str  # of the file
    shown: str  # `Variable.shown`


def _quantity(variable: xr.DataArray) -> _Quantity:
    """Returns the quantity of a variable, without a suffix of the name after a point."""
    name = str(variable.name).partition(".")[0]
    units = variable.attrs.get("units", "1")
    table_entry = VARIABLES.get(name)
    shown = table_entry.shown if table_entry and table_entry.units == units else ""
    return _Quantity(name=name, units=units, shown=variable.attrs.get("shown", shown))


def dataset_csv(dataset: xr.Dataset, axes: Mapping[str, str]) -> str:
    """Returns CSV with a row for each point of a dataset and a column for each number.

    A variable over further dimensions has a column for each of their flags, and one that lacks an
    axis is left out.

    axes: dimensions along which the points lie, each with the head of its column.
    """
    columns = {
        head: texts
        for name in dataset.data_vars
        for head, texts in _variable_columns(dataset, name, axes)
    }
    axis_texts = [_axis_texts(dataset[axis]) for axis in axes]
    points = itertools.product(*axis_texts)
    rows = zip(*columns.values(), strict=True)
    lines = [[*point, *row] for point, row in zip(points, rows, strict=True)]
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([[*axes.values(), *columns], *lines])
    return text.getvalue()


def _variable_columns(
    dataset: xr.Dataset, name: Any, axes: Mapping[str, str]
) -> Iterator[tuple[str, list[str]]]:
    """Yields head and texts of each column of a variable; nothing if it lacks one of the axes."""
    variable = dataset[name]
    if not set(axes) <= set(variable.dims):
        return
    values = variable.transpose(*axes, ...)
    further_dims = values.dims[len(axes) :]
    flags = variable.attrs.get("flag_meanings", "").split()
    for index in np.ndindex(*values.shape[len(axes) :]):
        words = [flag_names(dataset[dim])[k] for dim, k in zip(further_dims, index, strict=True)]
        numbers = values.values[(..., *index)].ravel()
        unit = variable.attrs.get("units", "1")
        if "dof_column" in further_dims:
            # of a stiffness matrix: none, one or both of row and column are tilts
            tilts = [word for word in words if word.startswith("tilt")]
            unit = STIFFNESS_UNITS[len(tilts)]
        head = ".".join([str(name), *words]) + (f" ({unit})" if unit != "1" else "")
        yield head, [cell_text(number, flags) for number in numbers]


def _axis_texts(coordinate: xr.DataArray) -> list[str]:
    """Returns the values of a coordinate as texts; flags by their names."""
    if "flag_meanings" in coordinate.attrs:
        return flag_names(coordinate)
    return [f"{value:g}" for value in coordinate.values]


def cell_text(number: float, flags: Sequence[str] | None) -> str:
    """Returns the text of a cell: nine digits, the name of a flag, or "" for NaN and infinity.

    number: a number or a flag.
    flags: names of the flags 0, 1, ...; empty or None if it is a number.
    """
    if not np.isfinite(number):
        return ""
    return flags[int(number)] if flags else f"{number:.9g}"


def flag_names(coordinate: xr.DataArray) -> list[str]:
    """Returns the name of each flag along a dimension."""
    names = coordinate.attrs.get("flag_meanings", "").split()
    return [names[int(flag)] for flag in coordinate.values]
