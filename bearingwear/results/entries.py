"""The contents of a result file: its variables and attributes, from the values of a result."""

from __future__ import annotations

import functools
from collections.abc import Container, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bearingwear import __version__
from bearingwear.provenance import source_hash
from bearingwear.results.pair_variables import BEARINGS, OF_BEARING, is_pair, pair_table
from bearingwear.results.variable import Variable
from bearingwear.results.variables import (
    BALL_AXES,
    CASE,
    COORDINATES,
    EXTREMES,
    INTERVAL_MEANS,
    LIFE,
    RACES,
    STRIP_POSITION,
    TIME,
)
from bearingwear.scene.accuracy import STANDARD
from kerneljit.versions import numba_version

if TYPE_CHECKING:
    from bearingwear.solvers.result import Result

SOURCE = "bearingwear"
"""The start of the attribute `source` of every file of this package."""

OVER_TURNS = {
    "time: mean": ", mean over the evaluated turns",
    "time: maximum": ", maximum over all instants of the evaluated turns",
    "time: minimum": ", minimum over all instants of the evaluated turns",
}
"""Suffix of the long name of a variable of a dynamic case, by its cell method."""

ALL_COORDINATES = COORDINATES | {STRIP_POSITION.name: STRIP_POSITION}
"""Variables that describe dimensions: the coordinates, and the positions of strips."""

_REPLACED = np.empty(0)
"""Default data of a variable for which the result has a value."""


class Entry(NamedTuple):
    """A variable of a file without its data."""

    dims: tuple[str, ...]
    attrs: dict[str, Any]
    fill: np.generic | None
    default: np.ndarray  # data if a result has no value


class Layout(NamedTuple):
    """The variables of a file without data; results with values of the same shapes share it."""

    coordinates: Mapping[str, Entry]
    variables: Mapping[str, Entry]
    sizes: Mapping[str, int]  # of their dimensions

    @property
    def entries(self) -> dict[str, Entry]:
        """Returns all variables by name, the coordinates first."""
        return {**self.coordinates, **self.variables}


class Contents(NamedTuple):
    """The contents of a file: layout, data by the names of variables, and global attributes."""

    layout: Layout
    data: dict[str, np.ndarray]
    attrs: dict[str, Any]


def common_attributes() -> dict[str, Any]:
    """Returns the global attributes of every file: conventions, origin, and versions."""
    return {
        "Conventions": "CF-1.11",
        "source": f"{SOURCE} {__version__}",
        "history": f"made by {SOURCE} {__version__}",
        "references": "Zhang, Chen, Gu, Wang (2018): Influences of preload on the friction and "
        "wear properties of high-speed instrument angular contact ball bearings",
        "comment": "Equations and their sources: docs/theory.md; axes, signs and symbols: "
        "docs/conventions.md",
        "package_version": __version__,
        "source_hash": source_hash(),
        "numpy_version": np.__version__,
        "numba_version": numba_version(),
    }


def contents_of(result: Result) -> Contents:
    """Returns the contents of the file of a result, with variables in the order of their table.

    Variables that every file contains and the result lacks have missing values.

    KeyError: a value is in no table of variables. ValueError: a value has a wrong shape.
    """
    values, scene = result.values, result.scene
    is_life = "end_criterion" in values
    table = _variable_table(is_life, is_pair(scene))
    check_in_table(values, table)
    solved = {name: stored_data(table[name], value) for name, value in values.items()}
    layout = _layout(
        is_life=is_life,
        is_of_pair=is_pair(scene),
        is_averaged=result.attrs.get("fidelity") == "dynamic" and not is_life,
        shapes=tuple((name, data.shape) for name, data in solved.items()),
        strips=scene.get("model", {}).get("strips", STANDARD.strips),
        balls=scene["bearing"]["ball_count"] if "bearing" in scene else 0,
    )
    if "phases" in result.attrs:
        layout = _with_phase_names(layout, result.attrs["phases"])
    data = {
        name: solved[name] if name in solved else entry.default.copy()
        for name, entry in layout.entries.items()
    }
    kind = "wear life" if is_life else "case"
    title = f"{kind} of {scene['name']}" if "name" in scene else kind
    attrs = common_attributes() | {"title": title} | result.attrs
    return Contents(layout, data, {key: _attribute(value) for key, value in attrs.items()})


def _with_phase_names(layout: Layout, names: str) -> Layout:
    """Returns a layout whose coordinate `phase`, if it has one, has names as flags.

    names: of the phases of a duty, separated by spaces.
    """
    if "phase" not in layout.coordinates:
        return layout
    phase = layout.coordinates["phase"]
    codes = np.arange(layout.sizes["phase"], dtype=phase.default.dtype)
    named = phase._replace(attrs=phase.attrs | {"flag_values": codes, "flag_meanings": names})
    return layout._replace(coordinates={**layout.coordinates, "phase": named})


def stacked_contents(results: Sequence[Result], dim: str) -> Contents:
    """Returns the contents of results of the same shapes, stacked along a new first dimension.

    Attributes and missing variables are those of the first result.

    results: at least one, all of one model, with values of the same names and shapes.
    dim: name of the new dimension.
    """
    layout, data, attrs = contents_of(results[0])
    values = results[0].values
    table = _variable_table("end_criterion" in values, is_pair(results[0].scene))
    for name in layout.variables:
        if name in values:
            data[name] = stored_data(table[name], [result.values[name] for result in results])
        else:
            data[name] = np.repeat(data[name][None], len(results), axis=0)
    variables = {
        name: entry._replace(dims=(dim, *entry.dims)) for name, entry in layout.variables.items()
    }
    sizes = {dim: len(results), **layout.sizes}
    return Contents(layout._replace(variables=variables, sizes=sizes), data, attrs)


@functools.cache
def _variable_table(is_life: bool, is_of_pair: bool) -> Mapping[str, Variable]:
    """Returns the variables that a file of a case or life may contain, the coordinates first."""
    table = LIFE if is_life else CASE
    return ALL_COORDINATES | (pair_table(table) if is_of_pair else table)


def check_in_table(names: Iterable[str], table: Container[str]) -> None:
    """Raises KeyError if a name is not in a table of variables."""
    if unknown := sorted(name for name in names if name not in table):
        raise KeyError(f"not in the table of variables: {', '.join(unknown)}")


@functools.lru_cache(maxsize=16)  # results in a loop are alike
def _layout(
    is_life: bool,
    is_of_pair: bool,
    is_averaged: bool,
    shapes: tuple[tuple[str, tuple[int, ...]], ...],
    strips: int,
    balls: int,
) -> Layout:
    """Returns the layout of the file of a result; it is shared, so do not write to it.

    ValueError: the dimensions of a value are not those of the table.

    is_averaged: whether the values are means over the evaluated turns of a dynamic case.
    shapes: name and shape of each value.
    balls: number of balls that a value for one ball represents; 0 if it is not known.
    """
    table, shape_of = _variable_table(is_life, is_of_pair), dict(shapes)
    sizes = {
        "ball": 1,
        "race": len(RACES),
        "axis": len(BALL_AXES),
        "strip": strips,
        OF_BEARING: len(BEARINGS),
    }
    for name, shape in shapes:
        dims = table[name].dims
        if len(shape) != len(dims):
            raise ValueError(f"{name} has {len(shape)} dimensions, not {len(dims)}")
        sizes.update(zip(dims, shape, strict=True))
    variables = {
        name: _entry(variable, shape_of.get(name), sizes)
        for name, variable in table.items()
        if name not in ALL_COORDINATES and (name in shape_of or variable.always)
    }
    if is_averaged:
        for name in variables.keys() & shape_of.keys():
            _describe_averaging(variables[name], table[name])
    used_dims = dict.fromkeys(dim for entry in variables.values() for dim in entry.dims)
    coordinates = _coordinates(used_dims, shape_of, sizes)
    if balls and "ball" in coordinates and sizes["ball"] == 1:
        coordinates["ball"].attrs["represents"] = np.int32(balls)
    return Layout(coordinates, variables, {dim: sizes[dim] for dim in used_dims})


def _describe_averaging(entry: Entry, variable: Variable) -> None:
    """Adds to the attributes of a variable how a dynamic case averages it."""
    method = _cell_method(variable)
    if method is None:
        return
    entry.attrs["cell_methods"] = method
    if entry.dims[: len(TIME)] != TIME:
        entry.attrs["long_name"] += OVER_TURNS[method]


def _coordinates(
    used_dims: Container[str], shape_of: Mapping[str, tuple[int, ...]], sizes: Mapping[str, int]
) -> dict[str, Entry]:
    """Returns the coordinates of the dimensions that are used; these never have missing values.

    ValueError: a coordinate that is no index, such as a time, has no value in the result.

    shape_of: shapes of the values of a result, by name.
    sizes: of all dimensions.
    """
    coordinates = {}
    for name, variable in ALL_COORDINATES.items():
        dim = variable.dims[0]
        if dim not in used_dims:
            continue
        data = None
        if variable is STRIP_POSITION:  # centres of equal strips, from -1 to 1
            data = (2.0 * np.arange(sizes[dim]) + 1.0) / sizes[dim] - 1.0
        elif variable.dtype[0] == "i":
            data = np.arange(sizes[dim], dtype=variable.dtype)
        elif name not in shape_of:
            raise ValueError(f"{name} is missing")
        entry = _entry(variable, shape_of.get(name), sizes, data)
        coordinates[name] = entry._replace(fill=None)
    return coordinates


def _entry(
    variable: Variable,
    solved_shape: tuple[int, ...] | None,
    sizes: Mapping[str, int],
    default: np.ndarray | None = None,
) -> Entry:
    """Returns the entry of a variable. ValueError: its value does not have the sizes of its dims.

    solved_shape: shape of its value in a result; None if there is none.
    sizes: of all dimensions.
    default: data if there is no value; by default missing values.
    """
    dims = variable.dims
    shape = tuple(sizes[dim] for dim in dims)
    if solved_shape is not None and solved_shape != shape:
        raise ValueError(f"{variable.name} has shape {solved_shape}, not {shape}")
    attrs = variable.attributes
    if len(dims) > 1 and "strip" in dims:
        attrs["coordinates"] = STRIP_POSITION.name
    if default is None:
        default = _REPLACED if solved_shape is not None else np.full(shape, variable.missing)
    fill = None if variable.dtype[0] == "i" else variable.missing
    return Entry(dims=dims, attrs=attrs, fill=fill, default=default)


def stored_data(variable: Variable, value: Any) -> np.ndarray:
    """Returns a value [SI, radians] as an array in the type and unit of its variable in a file."""
    data = np.array(value, dtype=variable.stored_type)
    if variable.scale != 1.0 and data.dtype.kind == "f":
        data = np.asarray(data * data.dtype.type(variable.scale))
    return data


def _cell_method(variable: Variable) -> str | None:
    """Returns the CF cell method of a variable of a dynamic case; None if it has none."""
    if variable.dims[: len(TIME)] == TIME:
        return "time: mean" if variable.name in INTERVAL_MEANS else "time: point"
    if variable.name in EXTREMES:
        return f"time: {EXTREMES[variable.name]}imum"
    is_mean = variable.averaged or (variable.always and variable.dtype == "f8")
    return "time: mean" if is_mean else None


def _attribute(value: Any) -> Any:
    """Returns a value in a type that every reader of netCDF understands as an attribute.

    These types are 64-bit numbers, and text. Boolean values become 0 and 1.
    """
    if isinstance(value, bool | np.bool_ | int | np.integer):
        return np.int64(value)
    if isinstance(value, float | np.floating):
        return np.float64(value)
    return str(value)
