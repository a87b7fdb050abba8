"""Datasets of studies: many solves side by side along new dimensions, and in one file."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.atomic import whole_file
from bearingwear.results.entries import check_in_table, common_attributes, stored_data
from bearingwear.results.netcdf import NETCDF_LOCK, CaseFileError, load
from bearingwear.results.variable import Variable
from bearingwear.results.words import plain_scene
from bearingwear.scene.scene import Scene
from kerneljit.interrupt import Interrupt


def dataset_of_rows(
    table: Mapping[str, Variable],
    axes: Mapping[Any, Any],
    rows: Sequence[Mapping[str, Any]],
    **attributes: Any,
) -> xr.Dataset:
    """Returns a dataset of rows along axes.

    table: variables of the dataset, in their order.
    axes: a coordinate has its Variable as key; its value is a list, or None for all flags. A
        dimension without coordinate has its name as key, and its length as value. The rows lie
        along those axes that are no dimension of a variable.
    rows: values [SI] by the names of the table, in C order. Missing values become NaN, even those
        of whole numbers and flags.
    attributes: attributes of the dataset beside those of every file; `scene` may be a Scene.
    KeyError: a value that is not in the table.
    ValueError: shapes that differ, or a wrong number of rows.
    """
    coords: dict[str, xr.Variable] = {}
    sizes: dict[str, int] = {}
    for axis, values in axes.items():
        if isinstance(axis, str):
            sizes[axis] = values
        else:
            coords |= coordinate(axis, values)
            sizes[axis.name] = coords[axis.name].size
    inner_dims = {dim for variable in table.values() for dim in variable.dims}
    outer_sizes = {name: size for name, size in sizes.items() if name not in inner_dims}
    if len(rows) != math.prod(outer_sizes.values()):
        raise ValueError(f"got {len(rows)} rows, expected {outer_sizes}")
    check_in_table({name for row in rows for name in row}, table)
    variables = {}
    for name, variable in table.items():
        data = _column(variable, [row.get(name) for row in rows], sizes)
        data = data.reshape((*outer_sizes.values(), *data.shape[1:]))
        variables[name] = xr.Variable((*outer_sizes, *variable.dims), data, variable.attributes)
    if isinstance(attributes.get("scene"), Scene):
        attributes["scene"] = attributes["scene"].json
    return xr.Dataset(variables, coords, common_attributes() | attributes)


def _column(variable: Variable, row_values: Sequence[Any], sizes: Mapping[str, int]) -> np.ndarray:
    """Returns the values (rows, *shape) of a variable in all rows, NaN where a row has none.

    row_values: of each row; None where it has no value.
    sizes: lengths of all dimensions, from which the shape follows if no row has a value.
    ValueError: values of different shapes, or of another number of dimensions than the variable.
    """
    shapes = {np.shape(value) for value in row_values if value is not None}
    if len(shapes) > 1 or any(len(shape) != len(variable.dims) for shape in shapes):
        raise ValueError(f"{variable.name}: got shapes {shapes}, expected {variable.dims}")
    shape = shapes.pop() if shapes else tuple(sizes[dim] for dim in variable.dims)
    missing = np.full(shape, np.nan)
    gaps = any(value is None for value in row_values)
    as_stored = replace(variable, dtype="f8") if gaps and variable.dtype != "O" else variable
    column = stored_data(as_stored, [missing if value is None else value for value in row_values])
    return column.reshape((len(row_values), *shape))


def stacked_dataset(
    datasets: Sequence[xr.Dataset],
    lengths: Mapping[str, int],
    leave_out: Sequence[str] = (),
    along: str = "",
) -> xr.Dataset:
    """Stacks datasets along new leading dimensions.

    datasets: in C order over the new dimensions. Missing variables and shorter dimensions are
        filled with NaN.
    lengths: names and lengths of the new dimensions.
    leave_out: names of variables, and of dimensions; all variables along these are left out.
    along: a leading dimension along which a dataset may hold several items; others hold one item.

    Returns a dataset that has the longest coordinate of each inner dimension. A coordinate along a
        dimension of another name, such as `strip_position` along `strip`, stays only if it has the
        same length in all datasets.
    """
    templates: dict[str, xr.Variable] = {}
    coords: dict[str, xr.Variable] = {}
    sizes: dict[str, int] = {}
    uneven: set[str] = set()
    previous_shapes: list[Any] = []
    for dataset in datasets:
        shapes = [(name, v.dims, v.shape) for name, v in dataset.variables.items()]
        if shapes == previous_shapes:  # as in most studies; nothing below would change
            continue
        previous_shapes = shapes
        for name, variable in _item_variables(dataset, leave_out, along).items():
            target = coords if name in dataset.coords else templates
            is_position = name in coords and name not in variable.dims
            if is_position and variable.size != coords[name].size:
                uneven.add(name)
            if name not in target or variable.size > target[name].size:
                target[name] = variable
            for dim, size in variable.sizes.items():
                sizes[str(dim)] = max(size, sizes.get(str(dim), 0))
    variables = {}
    for name, template in templates.items():
        inner_shape = tuple(sizes[str(dim)] for dim in template.dims)
        values = _concatenated_values(datasets, name, inner_shape, along)
        if template.dtype.kind in "iu" and np.isfinite(values).all():
            values = values.astype(template.dtype)
        values = values.reshape((*lengths.values(), *inner_shape))
        variables[name] = ((*lengths, *template.dims), values, template.attrs)
    used_dims = {dim for template in templates.values() for dim in template.dims}
    even_coords = {
        name: coord
        for name, coord in coords.items()
        if name not in uneven and set(coord.dims) <= used_dims
    }
    return xr.Dataset(variables, even_coords)


def _item_variables(
    dataset: xr.Dataset, leave_out: Sequence[str], along: str
) -> dict[str, xr.Variable]:
    """Returns the variables of the first item along a dimension, without coordinates along it.

    Variables without that dimension are returned whole. The arguments are those of
    `stacked_dataset`.
    """
    variables = {}
    for name, variable in dataset.variables.items():
        is_left_out = bool({name, *variable.dims} & set(leave_out))
        if is_left_out or (name in dataset.coords and along in variable.dims):
            continue
        variables[str(name)] = variable.isel({along: 0}) if along in variable.dims else variable
    return variables


_TEXT_KINDS = set("OUT")
"""Kinds of NumPy types that hold texts."""


def _concatenated_values(
    datasets: Sequence[xr.Dataset], name: str, inner_shape: tuple[int, ...], along: str
) -> np.ndarray:
    """Returns the values (items, *inner_shape) of a variable in all datasets, in their order.

    Values that a dataset lacks are NaN. A dataset without the dimension `along` is one item.
    """
    parts = [dataset.variables.get(name) for dataset in datasets]
    kinds = {part.dtype.kind for part in parts if part is not None}
    dtype = object if kinds & _TEXT_KINDS else float
    present = [part for part in parts if part is not None]
    if len(present) == len(parts) and len({(part.dims, part.shape) for part in present}) == 1:
        arrays = [part.values if along in part.dims else part.values[None] for part in present]
        return np.concatenate(arrays, dtype=dtype)
    ends = np.cumsum([dataset.sizes.get(along, 1) for dataset in datasets])
    values = np.full((ends[-1], *inner_shape), np.nan, dtype)
    for dataset, part, end in zip(datasets, parts, ends, strict=True):
        if part is not None:
            inner_slices = [slice(size) for dim, size in part.sizes.items() if dim != along]
            begin = end - dataset.sizes.get(along, 1)
            values[(slice(begin, end), *inner_slices)] = part.values
    return values


def reshaped_dataset(dataset: xr.Dataset, along: str, lengths: Mapping[str, int]) -> xr.Dataset:
    """Returns a dataset whose leading dimension is split into several, in C order.

    along: the leading dimension of every variable. Coordinates along it are left out.
    lengths: names and lengths of the new dimensions.
    """
    variables = {
        name: (
            (*lengths, *variable.dims[1:]),
            variable.values.reshape((*lengths.values(), *variable.shape[1:])),
            variable.attrs,
        )
        for name, variable in dataset.data_vars.items()
    }
    coords = {
        name: variable for name, variable in dataset.coords.items() if along not in variable.dims
    }
    return xr.Dataset(variables, coords)


def coordinate(variable: Variable, values: Any = None) -> dict[str, xr.Variable]:
    """Returns a coordinate by its name, as in the `coords` of a dataset.

    values: by default the codes of all flags of the variable.
    """
    if values is None:
        values = np.arange(len(variable.flags or ()))
    data = stored_data(variable, values)
    return {variable.name: xr.Variable(variable.dims, data, variable.attributes)}


def load_with_axes(path: str | Path, **axes: Sequence[float]) -> xr.Dataset:
    """Returns the dataset of a file, which must have certain values along its dimensions.

    axes: values by the name of a dimension; an empty sequence asks for the dimension alone.
    CaseFileError: the file lacks a dimension or a value.
    """
    dataset = load(path)
    for axis, values in axes.items():
        if axis not in dataset.dims:
            raise CaseFileError(f"{path}: got a file without {axis}, which this step requires")
        for value in values:
            if value not in dataset[axis]:
                allowed = ", ".join(f"{axis_value:g}" for axis_value in dataset[axis].values)
                raise CaseFileError(f"{path}: {axis}: got {value:g}, expected {allowed}")
    return dataset


def load_with_dynamic(steady_path: Path, dynamic_path: Path) -> tuple[xr.Dataset, xr.Dataset]:
    """Returns the datasets of the steady cases of a study, and of its dynamic cases.

    CaseFileError: cases of another scene or model, or a dynamic case without its steady twin.
    """
    dynamic_cases = load_with_axes(
        dynamic_path, preload_method=(), friction=(), ball_diameter_loss=()
    )
    if dynamic_cases.attrs.get("fidelity") != "dynamic":
        raise CaseFileError(
            f"{dynamic_path}: got cases that were not solved dynamically, expected dynamic cases"
        )
    axes = ("preload_method", "friction", "ball_diameter_loss")
    grid = {axis: dynamic_cases[axis].values.tolist() for axis in axes}
    steady = load_with_axes(steady_path, **grid)
    if plain_scene(steady)["name"] != plain_scene(dynamic_cases)["name"]:
        raise CaseFileError(
            f"{dynamic_path}: got cases from another scene, expected the scene of {steady_path}"
        )
    return steady, dynamic_cases


def write_dataset(dataset: xr.Dataset, path: str | Path) -> None:
    """Writes a dataset as netCDF, whole or not at all; the same dataset gives the same bytes.

    Missing values are NaN in the file; missing flags are the fill value of their integer type.
    Coordinates have no fill value.
    """
    encoding: dict[str, dict[str, Any]] = {}
    for name, variable in dataset.variables.items():
        encoding[str(name)] = {"_FillValue": None}
        if name in dataset.coords:
            continue
        if "flag_values" in variable.attrs and variable.dtype.kind == "f":
            # flags of a case that was not solved: missing, yet still whole numbers in the file
            dtype = np.asarray(variable.attrs["flag_values"]).dtype
            netcdf_fill_value = dtype.type(np.iinfo(dtype).min + 1)  # the default of netCDF
            encoding[str(name)] = {"dtype": dtype, "_FillValue": netcdf_fill_value}
        elif variable.dtype.kind == "f":
            encoding[str(name)] = {"_FillValue": np.nan}
    # an interrupted xarray may wait forever for its own lock
    with NETCDF_LOCK, whole_file(path) as part, Interrupt():
        dataset.drop_encoding().to_netcdf(part, engine="netcdf4", encoding=encoding)


def pareto(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Returns a mask (n,), true at the points of the Pareto front.

    A point is on the front if each other point that is not larger in `first` is larger in `second`.
    Of equal points, only the first is on it.

    first, second: coordinates (n,) of the points; smaller is better. A point with a NaN or an
        infinite coordinate is never on the front.
    """
    front = np.zeros(len(first), dtype=bool)
    lowest_second = np.inf
    usable = np.isfinite(first) & np.isfinite(second)
    for k in np.lexsort((second, first)):
        if usable[k] and second[k] < lowest_second:
            lowest_second = second[k]
            front[k] = True
    return front
