"""Contents of a result file: its variables and attributes, from the values of a result."""

from __future__ import annotations

import functools
import json
from collections.abc import Container, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bearingwear import __version__
from bearingwear.kernels.build.versions import numba_version
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
from bearingwear.scene.scene import COUNTS

if TYPE_CHECKING:
    from bearingwear.solvers.result import Result

SOURCE = "bearingwear"
"""What the attribute `source` of every file of this package starts with."""

OVER_TURNS = {
    "time: mean": ", mean over the evaluated turns",
    "time: maximum": ", largest of all instants of the evaluated turns",
    "time: minimum": ", smallest of all instants of the evaluated turns",
}
"""What the long name of a variable of a dynamic case adds, by its cell method."""


class Entry(NamedTuple):
    """A variable as it stands in a file."""

    dims: tuple[str, ...]
    data: np.ndarray
    attrs: dict[str, Any]
    fill: np.generic | None


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


def entries_of(result: Result) -> tuple[dict[str, Entry], dict[str, Any]]:
    """Variables and global attributes of a result, in the order of the table."""
    values, scene = result.values, _scene(result.attrs.get("scene", "{}"))
    table, is_life = _table(values, scene), "end_criterion" in values
    require_known(values, {*table, STRIP_POSITION.name, *TIME})
    given = {name: stored_data(table[name], values[name]) for name in table if name in values}
    sizes = _sizes(table, given, scene)
    solved = {
        name: _entry(variable, given.get(name), sizes)
        for name, variable in table.items()
        if name in given or variable.always
    }
    if result.attrs.get("fidelity") == "dynamic" and not is_life:
        for name, entry in solved.items():
            if name in values and (method := _cell_methods(table[name])):
                entry.attrs["cell_methods"] = method
                if entry.dims[: len(TIME)] != TIME:
                    entry.attrs["long_name"] += OVER_TURNS[method]
    coordinates = _coordinates({dim for e in solved.values() for dim in e.dims}, values, sizes)
    if "ball" in coordinates and sizes["ball"] == 1 and "bearing" in scene:
        coordinates["ball"].attrs["represents"] = np.int32(scene["bearing"]["ball_count"])
    kind = "wear life" if is_life else "case"
    title = {"title": f"{kind} of {scene['name']}" if "name" in scene else kind}
    attrs = common_attributes() | title | result.attrs
    return coordinates | solved, {key: _attribute(value) for key, value in attrs.items()}


def stacked_entries(results: Sequence[Result], dim: str) -> tuple[dict[str, Entry], dict[str, Any]]:
    """`entries_of` results of the same shapes, variables along a new first dimension."""
    entries, attrs = entries_of(results[0])
    given = results[0].values
    table = _table(given, _scene(results[0].attrs.get("scene", "{}")))
    for name, (dims, data, attributes, fill) in entries.items():
        if name in table:  # no coordinate
            if name in given:
                data = stored_data(table[name], [result.values[name] for result in results])
            else:
                data = np.repeat(data[None], len(results), axis=0)
            entries[name] = Entry((dim, *dims), data, attributes, fill)
    return entries, attrs


def _table(values: Mapping[str, Any], scene: Mapping[str, Any]) -> Mapping[str, Variable]:
    table = LIFE if "end_criterion" in values else CASE
    return of_pair(table) if is_pair(scene) else table


@functools.lru_cache(maxsize=4)
def _scene(text: str) -> Mapping[str, Any]:
    """The scene of a result; shared, so do not write to it."""
    return json.loads(text)


def require_known(values: Iterable[str], known: Container[str]) -> None:
    if unknown := sorted(name for name in values if name not in known):
        raise KeyError(f"not in the table of variables: {', '.join(unknown)}")


def _sizes(
    table: Mapping[str, Variable], given: Mapping[str, np.ndarray], scene: Any
) -> dict[str, int]:
    """Length of every dimension, from the values where they have it."""
    strips = scene.get("model", {}).get("strips", STANDARD.strips)
    sizes = {
        "ball": 1,
        "race": len(RACES),
        "axis": len(BALL_AXES),
        "counts": len(COUNTS),
        "strip": strips,
        OF_BEARING: len(BEARINGS),
    }
    for name, data in given.items():
        dims, shape = table[name].dims, data.shape
        if len(shape) != len(dims):
            raise ValueError(f"{name} has {len(shape)} dimensions, not {len(dims)}")
        if dims:
            sizes.update(zip(dims, shape, strict=True))
    return sizes


def _coordinates(
    used: Container[str], values: Mapping[str, Any], sizes: Mapping[str, int]
) -> dict[str, Entry]:
    """Coordinates of the dimensions that are used; they have a value everywhere."""
    found = {}
    for name, variable in COORDINATES.items():
        if name in used:
            value = values.get(name)
            if value is None and variable.dtype[0] != "i":
                raise ValueError(f"{name} is missing")
            value = np.arange(sizes[name]) if value is None else value
            found[name] = _entry(variable, stored_data(variable, value), sizes)
    if "strip" in used:
        strips = sizes["strip"]
        middles = (2.0 * np.arange(strips) + 1.0) / strips - 1.0
        position = values.get(STRIP_POSITION.name, middles)
        position = stored_data(STRIP_POSITION, position)
        found[STRIP_POSITION.name] = _entry(STRIP_POSITION, position, sizes)
    return {name: entry._replace(fill=None) for name, entry in found.items()}


def _entry(variable: Variable, data: np.ndarray | None, sizes: Mapping[str, int]) -> Entry:
    dims = variable.dims
    shape = tuple(map(sizes.__getitem__, dims))
    if data is None:
        data = np.full(shape, variable.missing)
    elif data.shape != shape:
        raise ValueError(f"{variable.name} has shape {data.shape}, not {shape}")
    attrs = variable.attributes
    if len(dims) > 1 and "strip" in dims:
        attrs["coordinates"] = STRIP_POSITION.name
    return Entry(dims, data, attrs, None if variable.dtype[0] == "i" else variable.missing)


def stored_data(variable: Variable, value: Any) -> np.ndarray:
    """Values as they stand in a file."""
    data = np.array(value, dtype=variable.dtype)
    if data.dtype.kind == "f" and variable.scale != 1.0:
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
