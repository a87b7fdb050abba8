"""Results to netCDF files and to `xarray` datasets, and back.

File and dataset are made from the same plain arrays. Writing uses netCDF4 alone, since a case that
is solved in a millisecond should not wait half a second for xarray to be imported.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import os
import threading
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bearingwear.atomic import SIGNATURE, reason, whole_file
from bearingwear.results.entries import (
    SOURCE,
    Contents,
    Entry,
    contents_of,
    stacked_contents,
)
from bearingwear.results.labels import named_data
from bearingwear.results.variables import TIME

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear.solvers.result import Result

LONG_COORDINATES, MOST_KNOWN = 1000, 16
"""Most values of coordinates whose indexes are kept, and how many sets of them are."""

_SLOTS = {"_dims", "_data", "_attrs", "_encoding"}  # of a variable of xarray

COMPRESSED_ABOVE = 100_000
"""Variables with more values than this are compressed, and histories over time always."""


NETCDF_LOCK = threading.RLock()
"""Held by whoever reads or writes a netCDF file.

The C libraries of netCDF and HDF5 end the process when two threads use them at the same time.
"""
# a process that is forked meanwhile would wait forever for the thread that held it
os.register_at_fork(
    before=NETCDF_LOCK.acquire,
    after_in_parent=NETCDF_LOCK.release,
    after_in_child=NETCDF_LOCK.release,
)


class CaseFileError(ValueError):
    """A result file that cannot be read; its text is one line that names the file."""


def write_result(result: Result, path: str | os.PathLike[str]) -> None:
    """Write a case or life file; the same result gives the same bytes.

    The file appears under its name only when it is complete.
    """
    import netCDF4

    contents = contents_of(result)
    with (
        NETCDF_LOCK,
        whole_file(path) as part,
        netCDF4.Dataset(part, "w", format="NETCDF4") as file,
    ):
        _fill(file, contents)


def _fill(file: Any, contents: Contents) -> None:
    file.setncatts(contents.attrs)
    every, data = contents.layout.every, contents.data
    for name, entry in every.items():
        for dim, size in zip(entry.dims, data[name].shape, strict=True):
            if dim not in file.dimensions:
                file.createDimension(dim, size)
    # data after all definitions: netCDF rewrites those of the whole file before data
    made = {}
    for name, entry in every.items():
        is_large = data[name].size > COMPRESSED_ABOVE
        made[name] = file.createVariable(
            name,
            data[name].dtype,
            entry.dims,
            fill_value=entry.fill,
            compression="zlib" if is_large or entry.dims[: len(TIME)] == TIME else None,
        )
        made[name].setncatts(entry.attrs)
    for name, variable in made.items():
        variable[...] = data[name]


def dataset(result: Result, by_name: bool = False) -> xr.Dataset:
    """The result as an `xarray.Dataset`: what `load` gives for its file, and `wall_time_s`.

    With `by_name` it has names instead of codes, as `labelled` makes them.
    """
    contents = contents_of(result)
    contents.attrs["wall_time_s"] = float(result.wall_time_s)
    return _dataset(contents, by_name)


def datasets_of(results: Iterable[Result], dim: str) -> list[xr.Dataset]:
    """Results along a new first dimension, a dataset for neighbours of the same shapes."""
    runs = (tuple(run) for _, run in itertools.groupby(results, _shapes))
    return [_dataset(stacked_contents(run, dim)) for run in runs]


def _shapes(result: Result) -> tuple[Any, ...]:
    shapes = [(name, np.shape(value)) for name, value in result.values.items()]
    return result.attrs.get("fidelity"), shapes


def _dataset(contents: Contents, by_name: bool = False) -> xr.Dataset:
    layout, data, attrs = contents
    indexed = _indexed(layout.coordinates, data, by_name)
    return _joined(_variables(layout.variables, data, by_name), indexed, layout.sizes, attrs)


def _unchecked(
    kind: type[xr.Variable], dims: Any, data: Any, attrs: Any, encoding: Any
) -> xr.Variable:
    made = object.__new__(kind)
    made._dims, made._data, made._attrs, made._encoding = dims, data, attrs, encoding
    return made


def _variables(
    entries: Mapping[str, Entry], data: Mapping[str, np.ndarray], by_name: bool
) -> dict[str, xr.Variable]:
    """Variables of entries, which are known to be right: xarray would check each again."""
    import xarray as xr

    is_known = set(xr.Variable.__slots__) == _SLOTS
    make = functools.partial(_unchecked, xr.Variable) if is_known else xr.Variable
    made = {}
    for name, (dims, shared, fill, _) in entries.items():
        values, attrs = data[name], shared.copy()
        attrs.pop("coordinates", None)
        if by_name and "flag_meanings" in attrs:
            values, attrs = named_data(values, attrs)
        made[name] = make(dims, values, attrs, {} if fill is None else {"_FillValue": fill})
    return made


class _Indexed(NamedTuple):
    """Coordinates, and what is asked of them each time; shared, so do not write to them."""

    coordinates: xr.Coordinates
    variables: Mapping[Any, xr.Variable]
    indexes: Mapping[Any, xr.Index]


def _joined(
    variables: dict[str, xr.Variable],
    indexed: _Indexed,
    sizes: Mapping[str, int],
    attrs: dict[str, Any],
) -> xr.Dataset:
    """A dataset of variables that are known to fit together.

    xarray's public way copies each of them and looks for conflicts, for longer than a solve takes.
    """
    import xarray as xr

    construct = getattr(xr.Dataset, "_construct_direct", None)
    if construct is None or set(xr.Variable.__slots__) != _SLOTS:
        return xr.Dataset(variables, indexed.coordinates.copy(deep=True), attrs)
    every: dict[Any, xr.Variable] = {**variables}
    for name, one in indexed.variables.items():
        data = one._data if name in indexed.indexes else one.values.copy()  # an index is immutable
        every[name] = _unchecked(type(one), one._dims, data, dict(one.attrs), dict(one.encoding))
    names, indexes = set(indexed.variables), dict(indexed.indexes)
    return construct(every, coord_names=names, dims=dict(sizes), attrs=attrs, indexes=indexes)


_KNOWN_COORDINATES: dict[Any, _Indexed] = {}
"""Of steady cases and the like, which all have the same; to index them takes half a millisecond."""


def _indexed(
    entries: Mapping[str, Entry], data: Mapping[str, np.ndarray], by_name: bool
) -> _Indexed:
    if sum(data[name].size for name in entries) > LONG_COORDINATES:
        return _newly_indexed(entries, data, by_name)
    # the other attributes are those of the table
    own = ("represents", "flag_meanings")  # each phase of a duty has a name of its own
    contents = (
        (name, data[name].tobytes(), *map(entry.attrs.get, own)) for name, entry in entries.items()
    )
    key = by_name, tuple(contents)
    if key not in _KNOWN_COORDINATES:
        if len(_KNOWN_COORDINATES) >= MOST_KNOWN:
            _KNOWN_COORDINATES.clear()
        _KNOWN_COORDINATES[key] = _newly_indexed(entries, data, by_name)
    return _KNOWN_COORDINATES[key]


def _newly_indexed(
    entries: Mapping[str, Entry], data: Mapping[str, np.ndarray], by_name: bool
) -> _Indexed:
    import xarray as xr

    made = xr.Coordinates(_variables(entries, data, by_name))
    return _Indexed(made, dict(made.variables), dict(made.xindexes))


def load(path: str | os.PathLike[str]) -> xr.Dataset:
    """Read a result file into memory and close it.

    CaseFileError: missing, empty, truncated, or not one of this package's files.
    """
    import xarray as xr

    readable(path)
    try:
        with (
            NETCDF_LOCK,
            xr.open_dataset(
                path, engine="netcdf4", decode_times=False, decode_timedelta=False
            ) as opened,
        ):
            found = opened.load()
    except (OSError, RuntimeError, ValueError, KeyError, AttributeError) as error:
        raise damaged(path, error) from None
    if not str(found.attrs.get("source", "")).startswith(SOURCE):
        raise foreign(path)
    return found


def load_kind(path: str | os.PathLike[str], *kinds: str) -> xr.Dataset:
    """A result file of one of some kinds."""
    found = load(path)
    if found.attrs.get("kind") not in kinds:
        allowed = " or ".join(kinds)
        raise CaseFileError(f"{os.fspath(path)}: got a file of another kind, expected {allowed}")
    return found


def header(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Global attributes of a result file; its values are not read."""
    with opened(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


@contextlib.contextmanager
def opened(path: str | os.PathLike[str]) -> Iterator[Any]:
    """A result file, open for reading; any fault in it is reported in one line."""
    import netCDF4

    readable(path)
    try:
        with NETCDF_LOCK, netCDF4.Dataset(path) as file:
            if not str(getattr(file, "source", "")).startswith(SOURCE):
                raise foreign(path)
            yield file
    except (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError) as error:
        if isinstance(error, CaseFileError):
            raise
        raise damaged(path, error) from None


def readable(path: str | os.PathLike[str]) -> None:
    """Refuse a file that is not netCDF, with a better reason than the libraries give."""
    name = os.fspath(path)
    try:
        with open(path, "rb") as file:
            start = file.read(len(SIGNATURE))
        name.encode()
    except (OSError, UnicodeError) as error:
        raise CaseFileError(
            f"{name}: got a file that cannot be read ({reason(error)}), expected a result file"
        ) from None
    if not start:
        raise CaseFileError(f"{name}: got an empty file, expected a result file")
    if start != SIGNATURE:
        raise foreign(path)


@contextlib.contextmanager
def read_as(path: str | os.PathLike[str], what: str) -> Iterator[None]:
    """Report any fault in reading a file of JSON in one line, with what it should hold."""
    try:
        yield
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        reason = " ".join(str(error).split())
        raise CaseFileError(f"{path}: cannot be read ({reason}), expected {what}") from None


def damaged(path: str | os.PathLike[str], error: BaseException) -> CaseFileError:
    """The error for a file that netCDF cannot read."""
    return CaseFileError(
        f"{os.fspath(path)}: got a damaged file ({reason(error)}), expected a result file"
    )


def foreign(path: str | os.PathLike[str]) -> CaseFileError:
    """The error for a file that bearingwear did not write."""
    return CaseFileError(
        f"{os.fspath(path)}: got a file not written by {SOURCE}, expected a result file"
    )
