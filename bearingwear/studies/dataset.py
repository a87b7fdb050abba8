"""Datasets of studies: many solves side by side along new dimensions, and in one file."""

import json
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
from bearingwear.scene.scene import Scene
from kerneljit.interrupt import Interrupt


def filled(
    table: Mapping[str, Variable],
    axes: Mapping[Any, Any],
    rows: Sequence[Mapping[str, Any]],
    **attributes: Any,
) -> xr.Dataset:
    """A dataset of rows along axes.

    table: variables of the dataset, in their order.
    axes: values of each coordinate, a Variable, or None for all of its flags; the length of a
        dimension without one, a name. The rows lie along those that are no dimension of a variable.
    rows: values [SI] by the names of the table, in C order. What a row lacks is NaN, also of whole
        numbers and flags.
    attributes: of the dataset, after those of every file; `scene` may be a Scene.
    KeyError: values of what is not in the table.
    ValueError: shapes that differ, or not as many rows as places.
    """
    coords: dict[str, xr.Variable] = {}
    sizes: dict[str, int] = {}
    for axis, values in axes.items():
        if isinstance(axis, str):
            sizes[axis] = values
        else:
            coords |= coordinate(axis, values)
            sizes[axis.name] = coords[axis.name].size
    inner = {dim for variable in table.values() for dim in variable.dims}
    outer = {name: size for name, size in sizes.items() if name not in inner}
    if len(rows) != math.prod(outer.values()):
        raise ValueError(f"got {len(rows)} rows, expected {outer}")
    check_in_table({name for row in rows for name in row}, table)
    variables = {}
    for name, variable in table.items():
        data = _column(variable, [row.get(name) for row in rows], sizes)
        data = data.reshape((*outer.values(), *data.shape[1:]))
        variables[name] = xr.Variable((*outer, *variable.dims), data, variable.attributes)
    if isinstance(attributes.get("scene"), Scene):
        attributes["scene"] = attributes["scene"].json
    return xr.Dataset(variables, coords, common_attributes() | attributes)


def _column(variable: Variable, found: Sequence[Any], sizes: Mapping[str, int]) -> np.ndarray:
    """Values of a variable in all rows, NaN where one has none."""
    shapes = {np.shape(value) for value in found if value is not None}
    if len(shapes) > 1 or any(len(shape) != len(variable.dims) for shape in shapes):
        raise ValueError(f"{variable.name}: got shapes {shapes}, expected {variable.dims}")
    shape = shapes.pop() if shapes else tuple(sizes[dim] for dim in variable.dims)
    missing = np.full(shape, np.nan)
    gaps = any(value is None for value in found)
    as_stored = replace(variable, dtype="f8") if gaps and variable.dtype != "O" else variable
    column = stored_data(as_stored, [missing if value is None else value for value in found])
    return column.reshape((len(found), *shape))


def stacked(
    datasets: Sequence[xr.Dataset],
    lengths: Mapping[str, int],
    leave_out: Sequence[str] = (),
    along: str = "",
) -> xr.Dataset:
    """Datasets as one, along new leading dimensions.

    datasets: in C order over the new dimensions. What one of them lacks is NaN there; a dimension
        that is shorter in one of them is padded with NaN.
    lengths: names and lengths of the new dimensions.
    leave_out: variables to leave out, and dimensions whose variables to leave out.
    along: a first dimension along which a dataset may hold several of what others hold one of.

    Returns: with the coordinates of the inner dimensions, which the longest decides; places along
        one (of strips) only where all have as many.
    """
    templates: dict[str, xr.Variable] = {}
    coords: dict[str, xr.Variable] = {}
    sizes: dict[str, int] = {}
    uneven: set[str] = set()
    shapes: list[Any] = []
    for dataset in datasets:
        before, shapes = shapes, [(name, v.dims, v.shape) for name, v in dataset.variables.items()]
        if shapes == before:
            continue
        for name, variable in dataset.variables.items():
            if {name, *variable.dims} & set(leave_out):
                continue
            if name in dataset.coords and along in variable.dims:
                continue
            one = variable.isel({along: 0}) if along in variable.dims else variable
            target = coords if name in dataset.coords else templates
            if name in coords and name not in one.dims and one.size != coords[str(name)].size:
                uneven.add(str(name))
            if name not in target or one.size > target[str(name)].size:
                target[str(name)] = one
            for dim, size in zip(one.dims, one.shape, strict=True):
                sizes[str(dim)] = max(size, sizes.get(str(dim), 0))
    variables = {}
    for name, template in templates.items():
        inner = tuple(sizes[str(dim)] for dim in template.dims)
        values = _one_after_the_other(datasets, name, inner, along)
        if template.dtype.kind in "OUT":
            pass
        elif np.issubdtype(template.dtype, np.integer) and np.isfinite(values).all():
            values = values.astype(template.dtype)
        values = values.reshape((*lengths.values(), *inner))
        variables[name] = ((*lengths, *template.dims), values, template.attrs)
    coords = {name: one for name, one in coords.items() if name not in uneven}
    used = {dim for template in templates.values() for dim in template.dims}
    return xr.Dataset(variables, {n: c for n, c in coords.items() if set(c.dims) <= used})


def _one_after_the_other(
    datasets: Sequence[xr.Dataset], name: str, inner: tuple[int, ...], along: str
) -> np.ndarray:
    """Values of a variable in all datasets, NaN where one has none or fewer."""
    every = [dataset.variables.get(name) for dataset in datasets]
    kinds = {one.dtype.kind for one in every if one is not None}
    dtype = object if kinds & set("OUT") else float
    known = [one for one in every if one is not None]
    if len(known) == len(every) and len({(one.dims, one.shape) for one in known}) == 1:
        parts = [one.values if along in one.dims else one.values[None] for one in known]
        return np.concatenate(parts, dtype=dtype)
    ends = np.cumsum([dataset.sizes.get(along, 1) for dataset in datasets])
    values = np.full((ends[-1], *inner), np.nan, dtype)
    for dataset, held, end in zip(datasets, every, ends, strict=True):
        if held is not None:
            shape = tuple(held.sizes[dim] for dim in held.dims if dim != along)
            filled = tuple(slice(size) for size in shape)
            begin = end - dataset.sizes.get(along, 1)
            values[(slice(begin, end), *filled)] = held.values
    return values


def reshaped(dataset: xr.Dataset, along: str, lengths: Mapping[str, int]) -> xr.Dataset:
    """A dataset whose leading dimension is split in several, in C order."""
    variables = {
        name: (
            (*lengths, *one.dims[1:]),
            one.values.reshape((*lengths.values(), *one.shape[1:])),
            one.attrs,
        )
        for name, one in dataset.data_vars.items()
    }
    coords = {name: one for name, one in dataset.coords.items() if along not in one.dims}
    return xr.Dataset(variables, coords)


def coordinate(variable: Variable, values: Any = None) -> dict[str, xr.Variable]:
    """A coordinate by its name; without values it has all of its flags."""
    if values is None:
        values = np.arange(len(variable.flags or ()))
    data = stored_data(variable, values)
    return {variable.name: xr.Variable(variable.dims, data, variable.attributes)}


def loaded(path: str | Path, **axes: Sequence[float]) -> xr.Dataset:
    """A file that has the given dimensions and, along them, the given values."""
    dataset = load(path)
    for axis, values in axes.items():
        if axis not in dataset.dims:
            raise CaseFileError(f"{path}: got a file without {axis}, which this step requires")
        for value in values:
            if value not in dataset[axis]:
                allowed = ", ".join(f"{known:g}" for known in dataset[axis].values)
                raise CaseFileError(f"{path}: {axis}: got {value:g}, expected {allowed}")
    return dataset


def both_ways(study: Path, dynamic: Path) -> tuple[xr.Dataset, xr.Dataset]:
    """A study, and cases solved dynamically, all of which are also in the study."""
    motion = loaded(dynamic, preload_method=(), friction=(), ball_diameter_loss=())
    if motion.attrs.get("fidelity") != "dynamic":
        raise CaseFileError(
            f"{dynamic}: got cases that were not solved dynamically, expected dynamic cases"
        )
    axes = ("preload_method", "friction", "ball_diameter_loss")
    steady = loaded(study, **{axis: motion[axis].values.tolist() for axis in axes})
    if json.loads(steady.attrs["scene"])["name"] != json.loads(motion.attrs["scene"])["name"]:
        raise CaseFileError(
            f"{dynamic}: got cases from another scene, expected the scene of {study}"
        )
    return steady, motion


def write_dataset(dataset: xr.Dataset, path: str | Path) -> None:
    """Write a dataset whole or not at all; the same dataset gives the same bytes."""
    encoding: dict[str, dict[str, Any]] = {}
    for name, variable in dataset.variables.items():
        encoding[str(name)] = {"_FillValue": None}
        if name in dataset.coords:
            continue
        if "flag_values" in variable.attrs and variable.dtype.kind == "f":
            # flags of a case that was not solved: missing, yet still whole numbers in the file
            kind = np.asarray(variable.attrs["flag_values"]).dtype
            encoding[str(name)] = {"dtype": kind, "_FillValue": kind.type(np.iinfo(kind).min + 1)}
        elif variable.dtype.kind == "f":
            encoding[str(name)] = {"_FillValue": np.nan}
    # an interrupted xarray may wait forever for its own lock
    with NETCDF_LOCK, whole_file(path) as part, Interrupt():
        dataset.drop_encoding().to_netcdf(part, engine="netcdf4", encoding=encoding)


def pareto(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Which points no other beats in both coordinates, the smaller the better (n,).

    Points with a NaN do not count.
    """
    front = np.zeros(len(first), dtype=bool)
    least = np.inf
    usable = np.isfinite(first) & np.isfinite(second)
    for k in np.lexsort((second, first)):
        if usable[k] and second[k] < least:
            least = second[k]
            front[k] = True
    return front
