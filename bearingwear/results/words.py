"""Converts names and numbers of result files for texts and figures, and selects from datasets."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from bearingwear.measures import plain
from bearingwear.results.netcdf import CaseFileError
from bearingwear.results.pair_variables import BEARINGS, OF_BEARING

if TYPE_CHECKING:
    import xarray as xr

_Data = TypeVar("_Data", "xr.Dataset", "xr.DataArray")


def methods(dataset: _Data) -> list[tuple[str, _Data]]:
    """Returns name and slice of each preload method in a dataset or variable."""
    names = dataset["preload_method"].attrs["flag_meanings"].split()
    return [
        (names[int(flag)], dataset.isel(preload_method=k))
        for k, flag in enumerate(dataset["preload_method"].values)
    ]


def datasets_by_bearing(dataset: xr.Dataset) -> dict[str | None, xr.Dataset]:
    """Returns the slice of each bearing of a pair, by `first` and `second`.

    The key is None for a single bearing, and for two that are alike.
    """
    if OF_BEARING not in dataset.dims:
        return {None: dataset}
    first, second = (dataset.isel({OF_BEARING: k}, drop=True) for k in range(2))
    if first.equals(second):
        return {None: first}
    scene = scene_of(dataset)
    return {
        bearing: slice_of_bearing.assign_attrs(
            scene=json.dumps(scene | {"name": f"{scene['name']}, {bearing} bearing"})
        )
        for bearing, slice_of_bearing in zip(BEARINGS, (first, second), strict=True)
    }


def dataset_of_bearing(
    dataset: xr.Dataset, name: str | Path, bearing: str | None = None
) -> xr.Dataset:
    """Returns the slice of one bearing: `first` or `second`, or None for the only one.

    name: of the file, for messages.
    CaseFileError: two bearings that differ without a choice of one, or a choice in a file of a
    single bearing.
    """
    slices = datasets_by_bearing(dataset)
    if None in slices and OF_BEARING in dataset.dims:  # two that are alike
        slices |= dict.fromkeys(BEARINGS, slices[None])
    if bearing in slices:
        return slices[bearing]
    if bearing is None:
        raise CaseFileError(
            f"{name}: got a file with two different bearings, expected a choice: --bearing first "
            "or second (in Python, plot(..., bearing='first'))"
        )
    allowed = " or ".join(BEARINGS)
    if OF_BEARING not in dataset.dims:
        allowed = "no bearing, because the file contains only one"
    raise CaseFileError(f"{name}: bearing: got {bearing}, expected {allowed}")


def name_in_words(name: str) -> str:
    """Returns a name in files as words."""
    return name.replace("_", " ")


def scene_of(dataset: xr.Dataset) -> dict[str, Any]:
    """Returns the scene of a dataset as plain data."""
    return json.loads(dataset.attrs["scene"])


def friction_text(mu: float) -> str:
    """Returns `µ = 0.1` without breaks, for a title."""
    return f"µ\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}{mu:g}"


def percent(value: float) -> str:
    """Returns a ratio as a whole percentage, for a title; a dash for NaN."""
    return f"{100.0 * value:.0f} %" if np.isfinite(value) else "– %"


def percent_in_text(value: float) -> str:
    """Returns a ratio as a percentage of two digits without breaks, for a text; a dash for NaN."""
    return f"{plain(100.0 * value, 2)}\N{NO-BREAK SPACE}%" if np.isfinite(value) else "–"
