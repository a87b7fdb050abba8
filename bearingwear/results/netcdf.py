"""Writes results to netCDF files, converts them to `xarray` datasets, and reads files.

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
"""Most values of coordinates whose indexes are stored for reuse, and most sets of them."""

_SLOTS = {"_dims", "_data", "_attrs", "_encoding"}  # of a variable of xarray

COMPRESSED_ABOVE = 100_000
"""Largest number of values that are stored uncompressed; histories over time always are."""


NETCDF_LOCK = threading.RLock()
"""The lock that all code holds while it reads or writes a netCDF file.

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
    """Writes a case or life file; the same result gives the same bytes.

    The file appears under its name only when it is complete.
    """
    import netCDF4

    contents = contents_of(result)
    with (
        NETCDF_LOCK,
        whole_file(path) as part,
        netCDF4.Dataset(part, "w", format="NETCDF4") as file,
    ):
        _write_contents(file, contents)


def _write_contents(file: Any, contents: Contents) -> None:
    """Writes the contents of a result into an empty netCDF file, open for writing."""
    file.setncatts(contents.attrs)
    entries, data = contents.layout.entries, contents.data
    for name, entry in entries.items():
        for dim, size in zip(entry.dims, data[name].shape, strict=True):
            if dim not in file.dimensions:
                file.createDimension(dim, size)
    # data after all definitions: netCDF rewrites those of the whole file before data
    variables = {}
    for name, entry in entries.items():
        is_large = data[name].size > COMPRESSED_ABOVE
        variables[name] = file.createVariable(
            name,
            data[name].dtype,
            entry.dims,
            fill_value=entry.fill,
            compression="zlib" if is_large or entry.dims[: len(TIME)] == TIME else None,
        )
        variables[name].setncatts(entry.attrs)
    for name, variable in variables.items():
        variable[...] = data[name]


def dataset(result: Result, by_name: bool = False) -> xr.Dataset:
    """Returns the dataset that `load` returns for the file of a result, with `wall_time_s`.

    by_name: replaces codes by names, as `labelled` does.
    """
    contents = contents_of(result)
    contents.attrs["wall_time_s"] = float(result.wall_time_s)
    return _contents_dataset(contents, by_name)


def stacked_datasets(results: Iterable[Result], dim: str) -> list[xr.Dataset]:
    """Stacks results along a new first dimension; one dataset for neighbours of the same shapes."""
    runs = (tuple(run) for _, run in itertools.groupby(results, _fidelity_and_shapes))
    return [_contents_dataset(stacked_contents(run, dim)) for run in runs]


def _fidelity_and_shapes(result: Result) -> tuple[str | None, list[tuple[str, tuple[int, ...]]]]:
    """Returns what determines the layout of a file: the model, and the shape of each value."""
    shapes = [(name, np.shape(value)) for name, value in result.values.items()]
    return result.attrs.get("fidelity"), shapes


def _contents_dataset(contents: Contents, by_name: bool = False) -> xr.Dataset:
    """Returns the contents of a file as a dataset."""
    layout, data = contents.layout, contents.data
    coordinates = _indexed_coordinates(layout.coordinates, data, by_name)
    variables = _variables(layout.variables, data, by_name)
    return _joined_dataset(variables, coordinates, layout.sizes, contents.attrs)


def _unchecked_variable(
    kind: type[xr.Variable], dims: Any, data: Any, attrs: Any, encoding: Any
) -> xr.Variable:
    """Returns a variable without the checks of xarray, whose private attributes it sets."""
    variable = object.__new__(kind)
    variable._dims, variable._data = dims, data
    variable._attrs, variable._encoding = attrs, encoding
    return variable


def _variables(
    entries: Mapping[str, Entry], data: Mapping[str, np.ndarray], by_name: bool
) -> dict[str, xr.Variable]:
    """Returns the variables of a dataset, which the layout has checked already."""
    import xarray as xr

    has_known_slots = set(xr.Variable.__slots__) == _SLOTS
    new_variable = (
        functools.partial(_unchecked_variable, xr.Variable) if has_known_slots else xr.Variable
    )
    variables = {}
    for name, entry in entries.items():
        values, attrs = data[name], entry.attrs.copy()
        attrs.pop("coordinates", None)
        if by_name and "flag_meanings" in attrs:
            values, attrs = named_data(values, attrs)
        encoding = {} if entry.fill is None else {"_FillValue": entry.fill}
        variables[name] = new_variable(entry.dims, values, attrs, encoding)
    return variables


class _IndexedCoordinates(NamedTuple):
    """Coordinates with their variables and indexes; shared, so do not write to them."""

    coordinates: xr.Coordinates
    variables: Mapping[Any, xr.Variable]
    indexes: Mapping[Any, xr.Index]


def _joined_dataset(
    variables: dict[str, xr.Variable],
    indexed: _IndexedCoordinates,
    sizes: Mapping[str, int],
    attrs: dict[str, Any],
) -> xr.Dataset:
    """Returns a dataset of variables that are known to fit together.

    xarray's public constructor copies each of them and looks for conflicts, which takes longer
    than a solve.
    """
    import xarray as xr

    construct = getattr(xr.Dataset, "_construct_direct", None)
    if construct is None or set(xr.Variable.__slots__) != _SLOTS:
        return xr.Dataset(variables, indexed.coordinates.copy(deep=True), attrs)
    all_variables: dict[Any, xr.Variable] = {**variables}
    for name, variable in indexed.variables.items():
        # an index is immutable
        data = variable._data if name in indexed.indexes else variable.values.copy()
        all_variables[name] = _unchecked_variable(
            type(variable), variable._dims, data, dict(variable.attrs), dict(variable.encoding)
        )
    names, indexes = set(indexed.variables), dict(indexed.indexes)
    return construct(
        all_variables, coord_names=names, dims=dict(sizes), attrs=attrs, indexes=indexes
    )


_KNOWN_COORDINATES: dict[Any, _IndexedCoordinates] = {}
"""Coordinates of earlier datasets; those of steady cases are equal, and indexing takes 0.5 ms."""


def _indexed_coordinates(
    entries: Mapping[str, Entry], data: Mapping[str, np.ndarray], by_name: bool
) -> _IndexedCoordinates:
    """Returns the coordinates of a dataset; equal short ones are indexed only once."""
    if sum(data[name].size for name in entries) > LONG_COORDINATES:
        return _newly_indexed(entries, data, by_name)
    # all other attributes are those of the table of variables
    varying_attrs = ("represents", "flag_meanings")
    contents = (
        (name, data[name].tobytes(), *map(entry.attrs.get, varying_attrs))
        for name, entry in entries.items()
    )
    key = by_name, tuple(contents)
    if key not in _KNOWN_COORDINATES:
        if len(_KNOWN_COORDINATES) >= MOST_KNOWN:
            _KNOWN_COORDINATES.clear()
        _KNOWN_COORDINATES[key] = _newly_indexed(entries, data, by_name)
    return _KNOWN_COORDINATES[key]


def _newly_indexed(
    entries: Mapping[str, Entry], data: Mapping[str, np.ndarray], by_name: bool
) -> _IndexedCoordinates:
    """Indexes coordinates with xarray."""
    import xarray as xr

    coordinates = xr.Coordinates(_variables(entries, data, by_name))
    return _IndexedCoordinates(
        coordinates=coordinates,
        variables=dict(coordinates.variables),
        indexes=dict(coordinates.xindexes),
    )


def load(path: str | os.PathLike[str]) -> xr.Dataset:
    """Reads a result file into memory and closes it.

    CaseFileError: missing, empty, truncated, or not one of this package's files.
    """
    import xarray as xr

    check_readable(path)
    try:
        with (
            NETCDF_LOCK,
            xr.open_dataset(
                path, engine="netcdf4", decode_times=False, decode_timedelta=False
            ) as file,
        ):
            dataset = file.load()
    except (OSError, RuntimeError, ValueError, KeyError, AttributeError) as error:
        raise damaged_file_error(path, error) from None
    if not str(dataset.attrs.get("source", "")).startswith(SOURCE):
        raise foreign_file_error(path)
    return dataset


def load_kind(path: str | os.PathLike[str], *kinds: str) -> xr.Dataset:
    """Reads a result file of one of some kinds. May raise CaseFileError."""
    dataset = load(path)
    if dataset.attrs.get("kind") not in kinds:
        allowed = " or ".join(kinds)
        raise CaseFileError(f"{os.fspath(path)}: got a file of another kind, expected {allowed}")
    return dataset


def header(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Reads the global attributes of a result file, without its values."""
    with open_result(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


@contextlib.contextmanager
def open_result(path: str | os.PathLike[str]) -> Iterator[Any]:
    """Opens a result file for reading; any fault in it becomes a CaseFileError of one line."""
    import netCDF4

    check_readable(path)
    try:
        with NETCDF_LOCK, netCDF4.Dataset(path) as file:
            if not str(getattr(file, "source", "")).startswith(SOURCE):
                raise foreign_file_error(path)
            yield file
    except (OSError, RuntimeError, LookupError, ValueError, TypeError, AttributeError) as error:
        if isinstance(error, CaseFileError):
            raise
        raise damaged_file_error(path, error) from None


def check_readable(path: str | os.PathLike[str]) -> None:
    """Refuses a file that is not netCDF, with a better reason than the libraries give."""
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
        raise foreign_file_error(path)


@contextlib.contextmanager
def json_faults(path: str | os.PathLike[str], expected: str) -> Iterator[None]:
    """Turns any fault in reading a JSON file into a CaseFileError of one line.

    expected: words for the content that the file should have.
    """
    try:
        yield
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        reason = " ".join(str(error).split())
        raise CaseFileError(f"{path}: cannot be read ({reason}), expected {expected}") from None


def damaged_file_error(path: str | os.PathLike[str], error: BaseException) -> CaseFileError:
    """Returns the error for a file that netCDF cannot read."""
    return CaseFileError(
        f"{os.fspath(path)}: got a damaged file ({reason(error)}), expected a result file"
    )


def foreign_file_error(path: str | os.PathLike[str]) -> CaseFileError:
    """Returns the error for a file that bearingwear did not write."""
    return CaseFileError(
        f"{os.fspath(path)}: got a file not written by {SOURCE}, expected a result file"
    )
