"""Results to netCDF files and to `xarray` datasets, and back.

File and dataset are made from the same plain arrays. Writing uses netCDF4 alone, since a case that
is solved in a millisecond should not wait half a second for xarray to be imported.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bearingwear import __version__
from bearingwear.io.variables import (
    CASE,
    COORDINATES,
    INTERVAL_MEANS,
    LIFE,
    STRIP_POSITION,
    TIME,
    Variable,
)
from bearingwear.io.whole import reason, whole_file
from bearingwear.provenance import source_hash

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear.model.result import Result

SOURCE = "bearingwear"
"""What the attribute `source` of every file of this package starts with."""

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
    import importlib.metadata as metadata

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
        "numba_version": metadata.version("numba"),
    }


def write(result: Result, path: str | os.PathLike[str]) -> None:
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


def dataset(result: Result) -> xr.Dataset:
    """The result as an `xarray.Dataset`: what `load` gives for its file, and `wall_time_s`."""
    import xarray as xr

    entries, attrs = _entries(result)
    variables = {}
    for name, entry in entries.items():
        own = {key: value for key, value in entry.attrs.items() if key != "coordinates"}
        encoding = {} if entry.fill is None else {"_FillValue": entry.fill}
        variables[name] = xr.Variable(entry.dims, entry.data, own, encoding)
    coordinates = {*COORDINATES, STRIP_POSITION.name} & set(variables)
    attrs["wall_time_s"] = float(result.wall_time_s)
    return xr.Dataset(variables, attrs=attrs).set_coords(sorted(coordinates))


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
    import netCDF4

    readable(path)
    try:
        with netCDF4.Dataset(path) as file:
            found = {name: file.getncattr(name) for name in file.ncattrs()}
    except (OSError, RuntimeError, ValueError, KeyError, AttributeError) as error:
        raise damaged(path, error) from None
    if not str(found.get("source", "")).startswith(SOURCE):
        raise foreign(path)
    return found


def readable(path: str | os.PathLike[str]) -> None:
    """Refuse what is no netCDF file, with a better reason than the libraries give.

    Raises
    ------
    CaseFileError
    """
    name = os.fspath(path)
    try:
        with open(path, "rb") as file:
            start = file.read(8)
        name.encode()
    except (OSError, UnicodeError) as error:
        raise CaseFileError(
            f"{name}: given a file that cannot be read ({reason(error)}); allowed a result file"
        ) from None
    if not start:
        raise CaseFileError(f"{name}: given an empty file; allowed a result file")
    if start != b"\x89HDF\r\n\x1a\n":
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
    in_time = result.attrs.get("fidelity") == "dynamic"
    table = LIFE if is_life else CASE
    known = {*table, STRIP_POSITION.name, *TIME}
    if unknown := sorted(set(values) - known):
        raise KeyError(f"not in the table of variables: {', '.join(unknown)}")
    scene = json.loads(result.attrs.get("scene", "{}"))
    sizes = _sizes(table, values, scene)

    solved: dict[str, Entry] = {}
    for name, variable in table.items():
        if name in values or variable.always:
            solved[name] = _entry(variable, values.get(name), sizes)
            if in_time and name in values and (method := _cell_methods(variable)):
                solved[name].attrs["cell_methods"] = method
    used = {dim for entry in solved.values() for dim in entry.dims}
    entries = {
        name: _coordinate(variable, values.get(name), sizes)
        for name, variable in COORDINATES.items()
        if name in used
    }
    if "ball" in entries and sizes["ball"] == 1 and "bearing" in scene:
        entries["ball"].attrs["represents"] = np.int32(scene["bearing"]["ball_count"])
    if "strip" in used:
        n = sizes["strip"]
        position = values.get(STRIP_POSITION.name, (2.0 * np.arange(n) + 1.0) / n - 1.0)
        # like a coordinate, it has a value everywhere
        entries[STRIP_POSITION.name] = _entry(STRIP_POSITION, position, sizes)._replace(fill=None)

    kind = "wear life" if is_life else "case"
    title = {"title": f"{kind} of {scene['name']}" if "name" in scene else kind}
    attrs = common_attributes() | title | result.attrs
    return entries | solved, {key: _attribute(value) for key, value in attrs.items()}


def _sizes(table: Mapping[str, Variable], values: Mapping[str, Any], scene: Any) -> dict[str, int]:
    """Length of every dimension, from the values where they have it."""
    sizes = {"ball": 1, "race": 2, "axis": 3, "counts": 2}
    sizes["strip"] = scene.get("model", {}).get("strips", 50)
    for name, variable in table.items():
        if name in values:
            shape = np.shape(values[name])
            if len(shape) != len(variable.dims):
                raise ValueError(f"{name} has {len(shape)} dimensions, not {len(variable.dims)}")
            sizes |= dict(zip(variable.dims, shape, strict=True))
    return sizes


def _entry(variable: Variable, value: Any, sizes: Mapping[str, int]) -> Entry:
    shape = tuple(sizes[dim] for dim in variable.dims)
    whole = variable.dtype[0] == "i"
    if value is None:
        missing = len(variable.flags) - 1 if variable.flags else np.nan  # a last flag says "none"
        data = np.full(shape, missing, dtype=variable.dtype)
    else:
        data = np.array(value, dtype=variable.dtype)
        if not whole and variable.scale != 1.0:
            data = data * data.dtype.type(variable.scale)
    if data.shape != shape:
        raise ValueError(f"{variable.name} has shape {data.shape}, not {shape}")
    attrs: dict[str, Any] = {"long_name": variable.long_name}
    if variable.units:
        attrs["units"] = variable.units
    if variable.flags:
        attrs["flag_values"] = np.arange(len(variable.flags), dtype=variable.dtype)
        attrs["flag_meanings"] = " ".join(variable.flags)
    if variable.comment:
        attrs["comment"] = variable.comment
    if "strip" in variable.dims and len(variable.dims) > 1:
        attrs["coordinates"] = STRIP_POSITION.name
    fill = None if whole else data.dtype.type(np.nan)
    return Entry(variable.dims, np.asarray(data), attrs, fill)


def _coordinate(variable: Variable, value: Any, sizes: Mapping[str, int]) -> Entry:
    if value is None:
        if variable.dtype[0] != "i":
            raise ValueError(f"{variable.name} is missing")
        value = np.arange(sizes[variable.name])
    return _entry(variable, value, sizes)._replace(fill=None)


def _cell_methods(variable: Variable) -> str | None:
    """How a variable of a transient stands for the time it covers, in CF's words."""
    if variable.dims[: len(TIME)] == TIME:
        return "time: mean" if variable.name in INTERVAL_MEANS else "time: point"
    is_mean = variable.averaged or (variable.always and variable.dtype == "f8")
    return "time: mean" if is_mean else None


def _attribute(value: Any) -> Any:
    """A value as a netCDF attribute that every reader takes."""
    if isinstance(value, bool | np.bool_ | int | np.integer):
        return np.int64(value)
    if isinstance(value, float | np.floating):
        return np.float64(value)
    return str(value)
