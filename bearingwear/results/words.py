"""Words and numbers of result files as texts and figures have them."""

import json
from typing import Any, TypeVar

import numpy as np
import xarray as xr

_Data = TypeVar("_Data", xr.Dataset, xr.DataArray)


def methods(dataset: _Data) -> list[tuple[str, _Data]]:
    """Name and slice of each preload method in a dataset, or in a variable."""
    names = dataset["preload_method"].attrs["flag_meanings"].split()
    return [
        (names[int(flag)], dataset.isel(preload_method=k))
        for k, flag in enumerate(dataset["preload_method"].values)
    ]


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
    return f"{100.0 * value:.2g}\N{NO-BREAK SPACE}%" if np.isfinite(value) else "–"
