"""Names for codes: race 0 in a file is race "inner" in memory.

Files keep whole numbers with `flag_meanings`, as CF asks; a person selects by name.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

MEMORY_ALONE = ("wall_time_s", "message")
"""Attributes of a dataset in memory that its file does not have."""


NO_NAME = "none"
"""What a code has that stands for nothing: of a status, that there was nothing to solve."""


def labelled(dataset: xr.Dataset) -> xr.Dataset:
    """A dataset with names instead of codes: `race="inner"`, `status="ok"`."""
    return dataset.assign({name: named(dataset.variables[name]) for name in dataset.variables})


def named(variable: xr.Variable) -> xr.Variable:
    """A variable with names for its codes, if it has codes."""
    if "flag_meanings" not in variable.attrs or variable.dtype.kind not in "iu":
        return variable
    return type(variable)(variable.dims, *named_data(variable.values, variable.attrs))


def named_data(codes: np.ndarray, attrs: Mapping[Any, Any]) -> tuple[np.ndarray, dict[Any, Any]]:
    """Names of codes, by the `flag_meanings` in their attributes, and the attributes of names."""
    names = np.asarray(_names(attrs["flag_meanings"])[codes])
    return names, {key: value for key, value in attrs.items() if key != "flag_values"}


@functools.cache
def _names(meanings: str) -> np.ndarray:
    """Of each code; the last one of a code of -1."""
    return np.array([*meanings.split(), NO_NAME])


def coded(dataset: xr.Dataset) -> xr.Dataset:
    """A dataset as files have it: the codes that `labelled` has named.

    What has other names than its `flag_meanings` stays as it is.
    """
    codes = {}
    for name, variable in dataset.variables.items():
        meanings = str(variable.attrs.get("flag_meanings", "")).split()
        given = variable.values
        known = {NO_NAME: -1} | {label: code for code, label in enumerate(meanings)}
        if meanings and given.dtype.kind in "UOT" and set(given.flat) <= set(known):
            numbers = np.array([known[label] for label in given.flat], dtype=np.int8)
            attrs = {}
            for key, value in variable.attrs.items():  # in the order of the files of commands
                if key == "flag_meanings":
                    attrs["flag_values"] = np.arange(len(meanings), dtype=np.int8)
                attrs[key] = value
            codes[name] = (variable.dims, numbers.reshape(given.shape), attrs)
    attrs = {key: value for key, value in dataset.attrs.items() if key not in MEMORY_ALONE}
    made = dataset.assign(codes)
    made.attrs = attrs
    return made
