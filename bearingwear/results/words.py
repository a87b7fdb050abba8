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
    """Returns the name of each preload method in a dataset or variable, and the part for it."""
    names = dataset["preload_method"].attrs["flag_meanings"].split()
    return [
        (names[int(flag)], dataset.isel(preload_method=k))
        for k, flag in enumerate(dataset["preload_method"].values)
    ]


def datasets_by_bearing(dataset: xr.Dataset) -> dict[str | None, xr.Dataset]:
    """Returns the datasets of the bearings of a pair, by `first` and `second`.

    A single bearing, or two with equal values, have one dataset with the key None. Otherwise, the
    bearing is part of the name of the scene: `NAME, first bearing`.
    """
    if OF_BEARING not in dataset.dims:
        return {None: dataset}
    first = dataset.isel({OF_BEARING: 0}, drop=True)
    second = dataset.isel({OF_BEARING: 1}, drop=True)
    if first.equals(second):
        return {None: first}
    scene = plain_scene(dataset)
    datasets: dict[str | None, xr.Dataset] = {}
    for bearing, bearing_dataset in zip(BEARINGS, (first, second), strict=True):
        bearing_scene = scene | {"name": f"{scene['name']}, {bearing} bearing"}
        datasets[bearing] = bearing_dataset.assign_attrs(scene=json.dumps(bearing_scene))
    return datasets


def dataset_of_bearing(
    dataset: xr.Dataset, name: str | Path, bearing: str | None = None
) -> xr.Dataset:
    """Returns the dataset of one bearing.

    name: of the file, for messages.
    bearing: `first` or `second` of a pair; None for a single bearing, or two with equal values.

    CaseFileError: two bearings that differ without a choice of one, or a choice in a file of a
    single bearing.
    """
    datasets = datasets_by_bearing(dataset)
    if bearing in datasets:
        return datasets[bearing]
    if bearing in BEARINGS and OF_BEARING in dataset.dims:  # two with equal values
        return datasets[None]
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
    """Returns a name from a file as words, with spaces for underscores."""
    return name.replace("_", " ")


def plain_scene(dataset: xr.Dataset) -> dict[str, Any]:
    """Returns the scene of a dataset as plain data, in the form of `Scene.to_dict`."""
    return json.loads(dataset.attrs["scene"])


def friction_text(mu: float) -> str:
    """Returns a friction coefficient as `µ = 0.1` with no-break spaces, for a title."""
    return f"µ\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}{mu:g}"


def percent(value: float) -> str:
    """Returns a ratio as a whole percentage, for a title; `– %` if it is not finite."""
    return f"{100.0 * value:.0f} %" if np.isfinite(value) else "– %"


def percent_in_text(value: float) -> str:
    """Returns a ratio as a percentage of two digits, for a text; a dash if it is not finite."""
    return f"{plain(100.0 * value, 2)}\N{NO-BREAK SPACE}%" if np.isfinite(value) else "–"
