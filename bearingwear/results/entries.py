"""Contents of a result file: its variables and attributes, from the values of a result."""

from __future__ import annotations

import functools
from collections.abc import Container, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bearingwear import __version__
from bearingwear.provenance import source_hash
from bearingwear.results.pair_variables import BEARINGS, OF_BEARING, is_pair, of_pair
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
"""What the attribute `source` of every file of this package starts with."""

OVER_TURNS = {
    "time: mean": ", mean over the evaluated turns",
    "time: maximum": ", maximum over all instants of the evaluated turns",
    "time: minimum": ", minimum over all instants of the evaluated turns",
}
"""What the long name of a variable of a dynamic case adds, by its cell method."""


ALL_COORDINATES = COORDINATES | {STRIP_POSITION.name: STRIP_POSITION}
"""Variables along a dimension: its coordinate, and the places of strips."""

_GIVEN = np.empty(0)
"""Stands for data that a value replaces."""


class Entry(NamedTuple):
    """A variable of a file, apart from its data."""

    dims: tuple[str, ...]
    attrs: dict[str, Any]
    fill: np.generic | None
    default: np.ndarray  # where a result has no value


class Layout(NamedTuple):
    """The variables of a file; shared by results with values of the same shapes."""

    coordinates: Mapping[str, Entry]
    variables: Mapping[str, Entry]
    sizes: Mapping[str, int]  # of their dimensions

    @property
    def every(self) -> dict[str, Entry]:
        return {**self.coordinates, **self.variables}


class Contents(NamedTuple):
    """Contents of a file: layout, data by the names of variables, and global attributes."""

    layout: Layout
    data: dict[str, np.ndarray]
    attrs: dict[str, Any]


def common_attributes() -> dict[str, Any]:
    """Global attributes of every file: conventions, origin, versions of what made it."""
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
    """Contents of the file of a result, in the order of the table."""
    values, scene = result.values, result.scene
    is_life, fidelity = "end_criterion" in values, result.attrs.get("fidelity")
    table = _table(is_life, is_pair(scene))
    require_known(values, table)
    given = {name: stored_data(table[name], value) for name, value in values.items()}
    layout = _with_phases(
        result.attrs.get("phases"),
        _layout(
            is_life=is_life,
            of_two=is_pair(scene),
            over_turns=fidelity == "dynamic" and not is_life,
            shapes=tuple((name, data.shape) for name, data in given.items()),
            strips=scene.get("model", {}).get("strips", STANDARD.strips),
            balls=scene["bearing"]["ball_count"] if "bearing" in scene else 0,
        ),
    )
    data = {
        name: given[name] if name in given else entry.default.copy()
        for name, entry in layout.every.items()
    }
    kind = "wear life" if is_life else "case"
    title = {"title": f"{kind} of {scene['name']}" if "name" in scene else kind}
    attrs = common_attributes() | title | result.attrs
    return Contents(layout, data, {key: _attribute(value) for key, value in attrs.items()})


def _with_phases(names: str | None, layout: Layout) -> Layout:
    """A layout whose coordinate of phases names those of a duty, as flags."""
    if names is None or "phase" not in layout.coordinates:
        return layout
    phase = layout.coordinates["phase"]
    codes = np.arange(layout.sizes["phase"], dtype=phase.default.dtype)
    named = phase._replace(attrs=phase.attrs | {"flag_values": codes, "flag_meanings": names})
    return layout._replace(coordinates={**layout.coordinates, "phase": named})


def stacked_contents(results: Sequence[Result], dim: str) -> Contents:
    """`contents_of` results of the same shapes, variables along a new first dimension."""
    layout, data, attrs = contents_of(results[0])
    given = results[0].values
    table = _table("end_criterion" in given, is_pair(results[0].scene))
    for name in layout.variables:
        if name in given:
            data[name] = stored_data(table[name], [result.values[name] for result in results])
        else:
            data[name] = np.repeat(data[name][None], len(results), axis=0)
    along = {
        name: entry._replace(dims=(dim, *entry.dims)) for name, entry in layout.variables.items()
    }
    sizes = {dim: len(results), **layout.sizes}
    return Contents(layout._replace(variables=along, sizes=sizes), data, attrs)


@functools.cache
def _table(is_life: bool, of_two: bool) -> Mapping[str, Variable]:
    """Variables of a file, its coordinates first."""
    table = LIFE if is_life else CASE
    return ALL_COORDINATES | (of_pair(table) if of_two else table)


def require_known(values: Iterable[str], known: Container[str]) -> None:
    if unknown := sorted(name for name in values if name not in known):
        raise KeyError(f"not in the table of variables: {', '.join(unknown)}")


@functools.lru_cache(maxsize=16)  # results in a loop are alike
def _layout(
    is_life: bool,
    of_two: bool,
    over_turns: bool,
    shapes: tuple[tuple[str, tuple[int, ...]], ...],
    strips: int,
    balls: int,
) -> Layout:
    """Layout of a result whose values have these shapes; shared, so do not write to it."""
    table, given = _table(is_life, of_two), dict(shapes)
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
    solved = {
        name: _entry(variable, given.get(name), sizes)
        for name, variable in table.items()
        if name not in ALL_COORDINATES and (name in given or variable.always)
    }
    if over_turns:
        for name, entry in solved.items():
            if name in given and (method := _cell_methods(table[name])):
                entry.attrs["cell_methods"] = method
                if entry.dims[: len(TIME)] != TIME:
                    entry.attrs["long_name"] += OVER_TURNS[method]
    used = dict.fromkeys(dim for entry in solved.values() for dim in entry.dims)
    coordinates = _coordinates(used, given, sizes)
    if balls and "ball" in coordinates and sizes["ball"] == 1:
        coordinates["ball"].attrs["represents"] = np.int32(balls)
    return Layout(coordinates, solved, {dim: sizes[dim] for dim in used})


def _coordinates(
    used: Container[str], given: Mapping[str, tuple[int, ...]], sizes: Mapping[str, int]
) -> dict[str, Entry]:
    """Coordinates of the dimensions that are used; they have a value everywhere."""
    found = {}
    for name, variable in ALL_COORDINATES.items():
        dim = variable.dims[0]
        if dim not in used:
            continue
        data = None
        if variable is STRIP_POSITION:
            data = (2.0 * np.arange(sizes[dim]) + 1.0) / sizes[dim] - 1.0
        elif variable.dtype[0] == "i":
            data = np.arange(sizes[dim], dtype=variable.dtype)
        elif name not in given:
            raise ValueError(f"{name} is missing")
        found[name] = _entry(variable, given.get(name), sizes, data)._replace(fill=None)
    return found


def _entry(
    variable: Variable,
    given: tuple[int, ...] | None,
    sizes: Mapping[str, int],
    default: np.ndarray | None = None,
) -> Entry:
    dims = variable.dims
    shape = tuple(map(sizes.__getitem__, dims))
    if given is not None and given != shape:
        raise ValueError(f"{variable.name} has shape {given}, not {shape}")
    attrs = variable.attributes
    if len(dims) > 1 and "strip" in dims:
        attrs["coordinates"] = STRIP_POSITION.name
    if default is None:
        default = _GIVEN if given is not None else np.full(shape, variable.missing)
    return Entry(dims, attrs, None if variable.dtype[0] == "i" else variable.missing, default)


def stored_data(variable: Variable, value: Any) -> np.ndarray:
    """Values as they stand in a file."""
    data = np.array(value, dtype=variable.stored_type)
    if variable.scale != 1.0 and data.dtype.kind == "f":
        data = np.asarray(data * data.dtype.type(variable.scale))
    return data


def _cell_methods(variable: Variable) -> str | None:
    """CF cell method of a variable of a dynamic case."""
    if variable.dims[: len(TIME)] == TIME:
        return "time: mean" if variable.name in INTERVAL_MEANS else "time: point"
    if variable.name in EXTREMES:
        return f"time: {EXTREMES[variable.name]}imum"
    is_mean = variable.averaged or (variable.always and variable.dtype == "f8")
    return "time: mean" if is_mean else None


def _attribute(value: Any) -> Any:
    """A value as a netCDF attribute that every reader understands."""
    if isinstance(value, bool | np.bool_ | int | np.integer):
        return np.int64(value)
    if isinstance(value, float | np.floating):
        return np.float64(value)
    return str(value)
