"""Puts the datasets of many solves side by side along new dimensions, and into one file."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.io.whole import whole_file
from bearingwear.study.grid import PRELOAD_METHODS, Grid


def stacked(
    datasets: Sequence[xr.Dataset], lengths: Mapping[str, int], leave_out: Sequence[str] = ()
) -> xr.Dataset:
    """Datasets as one, along new leading dimensions.

    Parameters
    ----------
    datasets : sequence of Dataset
        In C order over the new dimensions. What one of them lacks is NaN there, and a dimension
        that is shorter in one of them is filled up with NaN.
    lengths : mapping
        Names and lengths of the new dimensions.
    leave_out : sequence of str
        Variables to leave out, and dimensions whose variables to leave out.

    Returns
    -------
    Dataset
        With the coordinates of the inner dimensions, which the longest decides.
    """
    templates: dict[str, xr.DataArray] = {}
    coords: dict[str, xr.DataArray] = {}
    sizes: dict[str, int] = {}
    for dataset in datasets:
        for name, variable in dataset.variables.items():
            if not {name, *variable.dims} & set(leave_out):
                target = coords if name in dataset.coords else templates
                if name not in target or variable.size > target[str(name)].size:
                    target[str(name)] = dataset[name].reset_coords(drop=True)
                for dim, size in zip(variable.dims, variable.shape, strict=True):
                    sizes[str(dim)] = max(size, sizes.get(str(dim), 0))
    variables = {}
    for name, template in templates.items():
        inner = tuple(sizes[str(dim)] for dim in template.dims)
        values = np.full((len(datasets), *inner), np.nan)
        for k, dataset in enumerate(datasets):
            if name in dataset:
                filled: tuple = tuple(slice(size) for size in dataset[name].shape)
                values[(k, *filled)] = dataset[name].values
        if np.issubdtype(template.dtype, np.integer) and np.isfinite(values).all():
            values = values.astype(template.dtype)
        values = values.reshape((*lengths.values(), *inner))
        variables[name] = ((*lengths, *template.dims), values, template.attrs)
    used = {dim for template in templates.values() for dim in template.dims}
    return xr.Dataset(variables, {n: c for n, c in coords.items() if set(c.dims) <= used})


def axis_coordinates(grid: Grid) -> dict[str, tuple[str, np.ndarray, dict[str, Any]]]:
    """Coordinates of a grid's axes.

    CF wants numbers along a dimension, so the preload methods are flags.
    """
    flags = [PRELOAD_METHODS.index(method) for method in grid.preload_method]
    return {
        "preload_method": (
            "preload_method",
            np.array(flags, dtype=np.int8),
            {
                "long_name": "how the preload is applied",
                "flag_values": np.arange(len(PRELOAD_METHODS), dtype=np.int8),
                "flag_meanings": " ".join(PRELOAD_METHODS),
            },
        ),
        "friction": (
            "friction",
            np.array(grid.friction),
            {"long_name": "ball/race friction coefficient", "units": "1"},
        ),
        "ball_diameter_loss": (
            "ball_diameter_loss",
            np.array(grid.ball_diameter_loss_um),
            {"long_name": "loss of ball diameter by wear", "units": "um"},
        ),
    }


def write(dataset: xr.Dataset, path: str | Path) -> None:
    """Write a dataset whole or not at all; the same dataset gives the same bytes."""
    encoding: dict[str, dict[str, Any]] = {}
    for name, variable in dataset.variables.items():
        variable.encoding.clear()
        encoding[str(name)] = {"_FillValue": None}
        if name in dataset.coords:
            continue
        if "flag_values" in variable.attrs and variable.dtype.kind == "f":
            # flags of a case that was not solved: missing, yet still whole numbers in the file
            kind = np.asarray(variable.attrs["flag_values"]).dtype
            encoding[str(name)] = {"dtype": kind, "_FillValue": kind.type(np.iinfo(kind).min + 1)}
        elif variable.dtype.kind == "f":
            encoding[str(name)] = {"_FillValue": np.nan}
    with whole_file(path) as part:
        dataset.to_netcdf(part, engine="netcdf4", encoding=encoding)
