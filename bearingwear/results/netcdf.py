"""Results to netCDF files and to `xarray` datasets, and back.

File and dataset are made from the same plain arrays. Writing uses netCDF4 alone, since a case that
is solved in a millisecond should not wait half a second for xarray to be imported.
"""

from __future__ import annotations

import contextlib
import functools
import json
import os
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bearingwear import __version__
from bearingwear.atomic import reason, whole_file
from bearingwear.provenance import source_hash
from bearingwear.results.labels import named
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
    Variable,
)
from bearingwear.scene.accuracy import STANDARD
from bearingwear.scene.scene import COUNTS

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear.model.result import Result

SOURCE = "bearingwear"
"""What the attribute `source` of every file of this package starts with."""

SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""What a netCDF-4 file starts with."""

OVER_TURNS = {
    "time: mean": ", mean over the evaluated turns",
    "time: maximum": ", largest of all instants of the evaluated turns",
    "time: minimum": ", smallest of all instants of the evaluated turns",
}
"""What the long name of a variable of a dynamic case adds, by its cell method."""

COMPRESSED_ABOVE = 100_000
"""Variables with more values than this are compressed, and histories over time always."""


class CaseFileError(ValueError):
    """A result file that cannot be read; its text is one line that names the file."""


class Entry(NamedTuple):
    """A variable as it stands in a file."""

    dims: tuple[str, ...]
    data: np.ndarray
    attrs: dict[str, Any]
    fill: float | None


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
        "numba_version": _numba_version(),
    }


@functools.cache
def _numba_version() -> str:
    import importlib.metadata as metadata

    return metadata.version("numba")


def write_result(result: Result, path: str | os.PathLike[str]) -> None:
    """Write a case or life file; the same result gives the same bytes.

    The file appears under its name only when it is complete.

    Raises
    ------
    OutputError
    """
    import netCDF4

    entries, attrs = _entries(result)
    with whole_file(path) as part, netCDF4.Dataset(part, "w", format="NETCDF4") as file:
        file.setncatts(attrs)
        _fill(file, entries)


@contextlib.contextmanager
def in_memory(result: Result) -> Iterator[Any]:
    """The `netCDF4.Dataset` of a result, open for reading, that is nowhere on the disk."""
    import netCDF4

    entries, attrs = _entries(result)
    with netCDF4.Dataset("result", "w", format="NETCDF4", diskless=True) as file:
        file.setncatts(attrs)
        _fill(file, entries)
        yield file


def _fill(file: Any, entries: Mapping[str, Entry]) -> None:
    for entry in entries.values():
        for dim, size in zip(entry.dims, entry.data.shape, strict=True):
            if dim not in file.dimensions:
                file.createDimension(dim, size)
    for name, entry in entries.items():
        variable = file.createVariable(
            name,
            entry.data.dtype,
            entry.dims,
            fill_value=entry.fill,
            compression="zlib" if _is_compressed(entry) else None,
        )
        variable.setncatts(entry.attrs)
        variable[...] = entry.data


def _is_compressed(entry: Entry) -> bool:
    return entry.data.size > COMPRESSED_ABOVE or entry.dims[: len(TIME)] == TIME


def dataset(result: Result, by_name: bool = False) -> xr.Dataset:
    """The result as an `xarray.Dataset`: what `load` gives for its file, and `wall_time_s`.

    With `by_name` its coordinates are names instead of codes, as `labelled` makes them.
    """
    import xarray as xr

    entries, attrs = _entries(result)
    variables = {}
    for name, entry in entries.items():
        own = {key: value for key, value in entry.attrs.items() if key != "coordinates"}
        encoding = {} if entry.fill is None else {"_FillValue": entry.fill}
        variables[name] = xr.Variable(entry.dims, entry.data, own, encoding)
    names = [*filter(variables.__contains__, (*COORDINATES, STRIP_POSITION.name))]
    coordinates = {name: variables.pop(name) for name in names}
    if by_name:
        coordinates = {name: named(variable) for name, variable in coordinates.items()}
    attrs["wall_time_s"] = float(result.wall_time_s)
    return xr.Dataset(variables, coordinates, attrs)


def data_array(variable: Variable, values: Any, along: Sequence[str] = ()) -> xr.DataArray:
    """Values of a variable [SI], repeated along further dimensions that come first.

    Whole numbers must have no gaps.
    """
    import xarray as xr

    data = _data(variable, values)
    return xr.DataArray(data, dims=(*along, *variable.dims), attrs=variable.attributes)


def dataset_of(
    table: Mapping[str, Variable], values: Mapping[str, Any], along: Sequence[str] = ()
) -> xr.Dataset:
    """A dataset of all that has values, in the order of the table.

    Raises
    ------
    KeyError
        Values of what is not in the table.
    """
    import xarray as xr

    _require_known(values, table)
    arrays = {n: data_array(v, values[n], along) for n, v in table.items() if n in values}
    return xr.Dataset(arrays)


def load(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read a result file into memory and close it.

    Raises
    ------
    CaseFileError
        Missing, empty, truncated, or not one of this package's files.
    """
    import xarray as xr

    readable(path)
    try:
        with xr.open_dataset(
            path, engine="netcdf4", decode_times=False, decode_timedelta=False
        ) as opened:
            found = opened.load()
    except (OSError, RuntimeError, ValueError, KeyError, AttributeError) as error:
        raise damaged(path, error) from None
    if not str(found.attrs.get("source", "")).startswith(SOURCE):
        raise foreign(path)
    return found


def header(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Global attributes of a result file; its values are not read.

    Raises
    ------
    CaseFileError
        As `load`.
    """
    with opened(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


@contextlib.contextmanager
def opened(path: str | os.PathLike[str]) -> Iterator[Any]:
    """A result file, open for reading; whatever turns out to be wrong with it takes one line.

    Yields
    ------
    netCDF4.Dataset

    Raises
    ------
    CaseFileError
    """
    import netCDF4

    readable(path)
    try:
        with netCDF4.Dataset(path) as file:
            if not str(getattr(file, "source", "")).startswith(SOURCE):
                raise foreign(path)
            yield file
    except (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError) as error:
        if isinstance(error, CaseFileError):
            raise
        raise damaged(path, error) from None


def readable(path: str | os.PathLike[str]) -> None:
    """Refuse what is no netCDF file, with a better reason than the libraries give.

    Raises
    ------
    CaseFileError
    """
    name = os.fspath(path)
    try:
        with open(path, "rb") as file:
            start = file.read(len(SIGNATURE))
        name.encode()
    except (OSError, UnicodeError) as error:
        raise CaseFileError(
            f"{name}: given a file that cannot be read ({reason(error)}); allowed a result file"
        ) from None
    if not start:
        raise CaseFileError(f"{name}: given an empty file; allowed a result file")
    if start != SIGNATURE:
        raise foreign(path)


def damaged(path: str | os.PathLike[str], error: BaseException) -> CaseFileError:
    """The error for a file that netCDF cannot read."""
    return CaseFileError(
        f"{os.fspath(path)}: given a damaged file ({reason(error)}); allowed a result file"
    )


def foreign(path: str | os.PathLike[str]) -> CaseFileError:
    """The error for a file that is none of ours."""
    return CaseFileError(
        f"{os.fspath(path)}: given a file that {SOURCE} has not written; allowed a result file"
    )


# from values to entries


def _entries(result: Result) -> tuple[dict[str, Entry], dict[str, Any]]:
    """Variables and global attributes of a result, in the order of the table."""
    values = result.values
    is_life = "end_criterion" in values
    table = LIFE if is_life else CASE
    _require_known(values, {*table, STRIP_POSITION.name, *TIME})
    scene = json.loads(result.attrs.get("scene", "{}"))
    sizes = _sizes(table, values, scene)
    solved = {
        name: _entry(variable, values.get(name), sizes)
        for name, variable in table.items()
        if name in values or variable.always
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


def _require_known(values: Iterable[str], known: Container[str]) -> None:
    if unknown := sorted(name for name in values if name not in known):
        raise KeyError(f"not in the table of variables: {', '.join(unknown)}")


def _sizes(table: Mapping[str, Variable], values: Mapping[str, Any], scene: Any) -> dict[str, int]:
    """Length of every dimension, from the values where they have it."""
    strips = scene.get("model", {}).get("strips", STANDARD.strips)
    sizes = {
        "ball": 1,
        "race": len(RACES),
        "axis": len(BALL_AXES),
        "counts": len(COUNTS),
        "strip": strips,
    }
    for name, variable in table.items():
        if name in values:
            shape = np.shape(values[name])
            if len(shape) != len(variable.dims):
                raise ValueError(f"{name} has {len(shape)} dimensions, not {len(variable.dims)}")
            sizes |= dict(zip(variable.dims, shape, strict=True))
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
            found[name] = _entry(
                variable, np.arange(sizes[name]) if value is None else value, sizes
            )
    if "strip" in used:
        strips = sizes["strip"]
        middles = (2.0 * np.arange(strips) + 1.0) / strips - 1.0
        position = values.get(STRIP_POSITION.name, middles)
        found[STRIP_POSITION.name] = _entry(STRIP_POSITION, position, sizes)
    return {name: entry._replace(fill=None) for name, entry in found.items()}


def _entry(variable: Variable, value: Any, sizes: Mapping[str, int]) -> Entry:
    shape = tuple(sizes[dim] for dim in variable.dims)
    if value is None:
        missing = len(variable.flags) - 1 if variable.flags else np.nan  # a last flag says "none"
        data = np.full(shape, missing, dtype=variable.dtype)
    else:
        data = _data(variable, value)
    if data.shape != shape:
        raise ValueError(f"{variable.name} has shape {data.shape}, not {shape}")
    attrs = variable.attributes
    if "strip" in variable.dims and len(variable.dims) > 1:
        attrs["coordinates"] = STRIP_POSITION.name
    fill = None if data.dtype.kind == "i" else data.dtype.type(np.nan)
    return Entry(variable.dims, data, attrs, fill)


def _data(variable: Variable, value: Any) -> np.ndarray:
    """Values as they stand in a file."""
    data = np.array(value, dtype=variable.dtype)
    if data.dtype.kind == "f" and variable.scale != 1.0:
        data = np.asarray(data * data.dtype.type(variable.scale))
    return data


def _cell_methods(variable: Variable) -> str | None:
    """How a variable of a dynamic case stands for the time it covers, in CF's words."""
    if variable.dims[: len(TIME)] == TIME:
        return "time: mean" if variable.name in INTERVAL_MEANS else "time: point"
    if variable.name in EXTREMES:
        return f"time: {EXTREMES[variable.name]}imum"
    is_mean = variable.averaged or (variable.always and variable.dtype == "f8")
    return "time: mean" if is_mean else None


def _attribute(value: Any) -> Any:
    """A value as a netCDF attribute that every reader takes."""
    if isinstance(value, bool | np.bool_ | int | np.integer):
        return np.int64(value)
    if isinstance(value, float | np.floating):
        return np.float64(value)
    return str(value)
