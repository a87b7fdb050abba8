"""Writes results to netCDF files, converts them to `xarray` datasets, and reads files.

File and dataset are made from the same plain arrays. Writing uses netCDF4 alone, since a case that
is solved in a millisecond should not wait half a second for xarray to be imported.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import threading
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bearingwear.atomic import SIGNATURE, reason, whole_file
from bearingwear.results.entries import (
    SOURCE,
    Contents,
    Entry,
    Layout,
    contents_of,
    stacked_contents,
)
from bearingwear.results.labels import named_data
from bearingwear.results.variables import TIME
from bearingwear.scene.checking.records import SCENE_SUFFIXES

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear.solvers.result import Result


LONG_COORDINATES, MOST_TEMPLATES = 1000, 16
"""Largest number of values in the coordinates of a template, and of templates stored for reuse."""

COMPRESSED_ABOVE = 100_000
"""Number of values above which a variable is compressed; histories over time always are."""

NETCDF_LOCK = threading.RLock()
"""The lock that all code holds while it reads or writes a netCDF file.

The C libraries of netCDF and HDF5 end the process when two threads use them at the same time.
"""
# otherwise, a process forked while a thread holds the lock would wait for it forever
os.register_at_fork(
    before=NETCDF_LOCK.acquire,
    after_in_parent=NETCDF_LOCK.release,
    after_in_child=NETCDF_LOCK.release,
)


class CaseFileError(ValueError):
    """A result file that cannot be read; its text is one line that names the file."""


def write_result(result: Result, path: str | os.PathLike[str]) -> None:
    """Writes a case or life file, of which the same result gives the same bytes.

    The file appears under its name only when it is complete. OutputError: it cannot be written.
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


def dataset_of_result(result: Result, by_name: bool = False) -> xr.Dataset:
    """Returns the dataset that `load` returns for the file of a result, and `wall_time_s`.

    by_name: whether to replace codes by names, as `labelled` does.
    """
    contents = contents_of(result)
    contents.attrs["wall_time_s"] = float(result.wall_time_s)
    data = {}
    for name, entry in contents.layout.variables.items():
        data[name], _ = _values_and_attrs(entry, contents.data[name], by_name)
    # the constructor of a dataset takes longer than a solve, so an earlier one is copied
    filled = _template(contents, by_name).copy(deep=False, data=data)
    for name, entry in contents.layout.coordinates.items():
        if entry.dims != (name,):  # a coordinate without an index, which a user may change
            filled.variables[name].data = contents.data[name]
    filled.attrs = contents.attrs
    return filled


def stacked_datasets(results: Iterable[Result], dim: str) -> list[xr.Dataset]:
    """Returns datasets of results along a new first dimension, in the order of the results.

    Successive results of the same model and shapes are in one dataset.

    dim: name of the dimension.
    """
    groups = itertools.groupby(results, _fidelity_and_shapes)
    return [_contents_dataset(stacked_contents(tuple(group), dim)) for _, group in groups]


def _fidelity_and_shapes(result: Result) -> tuple[str | None, list[tuple[str, tuple[int, ...]]]]:
    """Returns what determines the layout of a file: the model, and name and shape of each value."""
    shapes = [(name, np.shape(value)) for name, value in result.values.items()]
    return result.attrs.get("fidelity"), shapes


def _contents_dataset(contents: Contents, by_name: bool = False) -> xr.Dataset:
    """Returns the contents of a file as a dataset, with names instead of codes if `by_name`."""
    import xarray as xr

    layout, data = contents.layout, contents.data
    return xr.Dataset(
        _variables(layout.variables, data, by_name),
        _variables(layout.coordinates, data, by_name),
        contents.attrs,
    )


def _variables(
    entries: Mapping[str, Entry], data: Mapping[str, np.ndarray], by_name: bool
) -> dict[str, xr.Variable]:
    """Returns entries and their data as variables of a dataset, by name."""
    import xarray as xr

    variables = {}
    for name, entry in entries.items():
        values, attrs = _values_and_attrs(entry, data[name], by_name)
        attrs = {key: value for key, value in attrs.items() if key != "coordinates"}
        encoding = {} if entry.fill is None else {"_FillValue": entry.fill}
        variables[name] = xr.Variable(entry.dims, values, attrs, encoding)
    return variables


def _values_and_attrs(
    entry: Entry, values: np.ndarray, by_name: bool
) -> tuple[np.ndarray, dict[str, Any]]:
    """Returns the values and attributes of a variable, with names instead of codes if `by_name`."""
    if by_name and "flag_meanings" in entry.attrs:
        return named_data(values, entry.attrs)
    return values, entry.attrs


_TEMPLATES: dict[Any, tuple[Layout, xr.Dataset]] = {}
"""Datasets of earlier results by the ids of their layouts and the bytes of their coordinates.

Each entry refers to its layout, so that no other layout gets the same id.
"""


def _template(contents: Contents, by_name: bool) -> xr.Dataset:
    """Returns a dataset of the same layout and coordinates, without attributes.

    It may be shared, so do not write to it.
    """
    layout = contents.layout
    coordinates = [contents.data[name] for name in layout.coordinates]
    if sum(values.size for values in coordinates) > LONG_COORDINATES:
        return _contents_dataset(contents, by_name)
    key = id(layout), by_name, *(values.tobytes() for values in coordinates)
    if key not in _TEMPLATES:
        if len(_TEMPLATES) >= MOST_TEMPLATES:
            _TEMPLATES.clear()
        _TEMPLATES[key] = layout, _contents_dataset(contents, by_name).drop_attrs(deep=False)
    _, template = _TEMPLATES[key]
    return template


def load(path: str | os.PathLike[str]) -> xr.Dataset:
    """Returns the contents of a result file; flags are codes, and missing values NaN.

    CaseFileError: the file is missing, empty, damaged, or not written by this package.
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
    """Returns the contents of a result file whose attribute `kind` is one of `kinds`.

    CaseFileError: as of `load`, or the file is of another kind.
    """
    dataset = load(path)
    if dataset.attrs.get("kind") not in kinds:
        allowed = " or ".join(kinds)
        raise CaseFileError(f"{os.fspath(path)}: got a file of another kind, expected {allowed}")
    return dataset


def header(path: str | os.PathLike[str]) -> dict[str, Any]:
    """Returns the global attributes of a result file. May raise CaseFileError."""
    with open_result(path) as file:
        return {name: file.getncattr(name) for name in file.ncattrs()}


@contextlib.contextmanager
def open_result(path: str | os.PathLike[str]) -> Iterator[Any]:
    """Yields a result file that is open for reading (`netCDF4.Dataset`); the file is then closed.

    Any fault in the file, and in what the `with` block reads from it, becomes a CaseFileError of
    one line. Until the block ends, `NETCDF_LOCK` is held.
    """
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
    """Raises CaseFileError, with a likely reason, for a file that cannot be read or is not netCDF.

    Its contents are not read: a file that only begins like netCDF passes.
    """
    name = os.fspath(path)
    try:
        with open(path, "rb") as file:
            start = file.read(len(SIGNATURE))
        name.encode()
    except IsADirectoryError:
        files = sorted(file for file in Path(path).rglob("*.nc") if file.is_file())
        advice = f", such as {files[0]}" if files else ""
        raise CaseFileError(f"{name}: got a folder, expected a result file{advice}") from None
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
    """Turns any error while a `with` block reads a JSON file into a CaseFileError of one line.

    path: of the file, for the message; the block opens it.
    expected: words for the content that the file should have, for the message.
    """
    try:
        yield
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        problem = f"cannot be read ({' '.join(str(error).split())}), expected {expected}"
        raise CaseFileError(f"{path}: {problem}") from None


def damaged_file_error(path: str | os.PathLike[str], error: BaseException) -> CaseFileError:
    """Returns the error for a file that netCDF cannot read."""
    return CaseFileError(
        f"{os.fspath(path)}: got a damaged file ({reason(error)}), expected a result file"
    )


def foreign_file_error(path: str | os.PathLike[str]) -> CaseFileError:
    """Returns the error for a file that bearingwear did not write."""
    name = os.fspath(path)
    what, advice = f"a file not written by {SOURCE}", ""
    if name.endswith(SCENE_SUFFIXES):
        what = "a scene"
        advice = f", as `bearingwear solve {name} -o {Path(name).with_suffix('.nc')}` writes one"
    return CaseFileError(f"{name}: got {what}, expected a result file{advice}")
