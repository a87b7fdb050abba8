"""Words and numbers of result files as texts and figures have them."""

import json
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import xarray as xr

from bearingwear.measures import plain
from bearingwear.results.netcdf import CaseFileError
from bearingwear.results.pair_variables import BEARINGS, OF_BEARING

_Data = TypeVar("_Data", xr.Dataset, xr.DataArray)


def methods(dataset: _Data) -> list[tuple[str, _Data]]:
    """Name and slice of each preload method in a dataset, or in a variable."""
    names = dataset["preload_method"].attrs["flag_meanings"].split()
    return [
        (names[int(flag)], dataset.isel(preload_method=k))
        for k, flag in enumerate(dataset["preload_method"].values)
    ]


def each_bearing(dataset: xr.Dataset) -> dict[str | None, xr.Dataset]:
    """Slice of each bearing of a pair; None: the only bearing, or either of two that are alike."""
    if OF_BEARING not in dataset.dims:
        return {None: dataset}
    first, second = (dataset.isel({OF_BEARING: k}, drop=True) for k in range(2))
    if first.equals(second):
        return {None: first}
    scene = scene_of(dataset)
    return {
        which: one.assign_attrs(
            scene=json.dumps(scene | {"name": f"{scene['name']}, {which} bearing"})
        )
        for which, one in zip(BEARINGS, (first, second), strict=True)
    }


def chosen_bearing(dataset: xr.Dataset, name: str | Path, bearing: str | None = None) -> xr.Dataset:
    """What one bearing has: the only one, either of two that are alike, or `first` or `second`.

    CaseFileError: two bearings that differ without a choice of one, or a choice where there is
    none.
    """
    known = each_bearing(dataset)
    if None in known:
        known |= dict.fromkeys(BEARINGS if OF_BEARING in dataset.dims else (), known[None])
    if bearing in known:
        return known[bearing]
    if bearing is None:
        raise CaseFileError(
            f"{name}: got a file with two different bearings, expected a choice: --bearing first "
            "or second (in Python, plot(..., bearing='first'))"
        )
    allowed = " or ".join(BEARINGS)
    if OF_BEARING not in dataset.dims:
        allowed = "no bearing, because the file contains only one"
    raise CaseFileError(f"{name}: bearing: got {bearing}, expected {allowed}")


def in_words(name: str) -> str:
    """A name of the files as it stands in a figure."""
    return name.replace("_", " ")


def scene_of(dataset: xr.Dataset) -> dict[str, Any]:
    """The scene a file was made from."""
    return json.loads(dataset.attrs["scene"])


def mu_is(mu: float) -> str:
    """A friction coefficient for a title, in one piece."""
    return f"µ\N{NO-BREAK SPACE}=\N{NO-BREAK SPACE}{mu:g}"


def percent(value: float) -> str:
    """A ratio as a percentage for a title; a dash where it is not known."""
    return f"{100.0 * value:.0f} %" if np.isfinite(value) else "– %"


def percent_in_text(value: float) -> str:
    """A ratio as a percentage with two digits, in one piece; a dash where it is not known."""
    return f"{plain(100.0 * value, 2)}\N{NO-BREAK SPACE}%" if np.isfinite(value) else "–"
