"""Conversion between codes and names: race 0 in a file is race "inner" in memory.

Files contain whole numbers with `flag_meanings`, as CF requires; a person selects by name.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

ONLY_IN_MEMORY = ("wall_time_s", "message")
"""Attributes of a dataset in memory that its file does not have."""


NO_NAME = "none"
"""The name of the code -1; as a status, it means that there was nothing to solve."""


def labelled(dataset: xr.Dataset) -> xr.Dataset:
    """Returns a dataset with names instead of codes: `race="inner"`, `status="ok"`."""
    return dataset.assign(
        {name: _labelled_variable(dataset.variables[name]) for name in dataset.variables}
    )


def _labelled_variable(variable: xr.Variable) -> xr.Variable:
    """Returns a variable with names instead of codes, if it has codes."""
    if "flag_meanings" not in variable.attrs or variable.dtype.kind not in "iu":
        return variable
    return type(variable)(variable.dims, *named_data(variable.values, variable.attrs))


def named_data(codes: np.ndarray, attrs: Mapping[Any, Any]) -> tuple[np.ndarray, dict[Any, Any]]:
    """Returns the names of codes and their attributes.

    attrs: of the codes; their `flag_meanings` are the names.
    """
    names = np.asarray(_code_names(attrs["flag_meanings"])[codes])
    return names, {key: value for key, value in attrs.items() if key != "flag_values"}


@functools.cache
def _code_names(meanings: str) -> np.ndarray:
    """Returns an array with the name of each code, and with that of -1 as its last item."""
    return np.array([*meanings.split(), NO_NAME])


def coded(dataset: xr.Dataset) -> xr.Dataset:
    """Reverses `labelled`: returns a dataset with the codes and attributes of files.

    A variable with other names than its `flag_meanings` is not changed.
    """
    codes = {}
    for name, variable in dataset.variables.items():
        meanings = str(variable.attrs.get("flag_meanings", "")).split()
        labels = variable.values
        code_of = {NO_NAME: -1} | {label: code for code, label in enumerate(meanings)}
        if meanings and labels.dtype.kind in "UOT" and set(labels.flat) <= set(code_of):
            numbers = np.array([code_of[label] for label in labels.flat], dtype=np.int8)
            attrs = _attributes_of_codes(variable.attrs, len(meanings))
            codes[name] = (variable.dims, numbers.reshape(labels.shape), attrs)
    result = dataset.assign(codes)
    result.attrs = {key: dataset.attrs[key] for key in dataset.attrs if key not in ONLY_IN_MEMORY}
    return result


def _attributes_of_codes(attrs: Mapping[Any, Any], count: int) -> dict[Any, Any]:
    """Returns the attributes of names with `flag_values`, in the order of the files of commands.

    count: the number of flags.
    """
    attributes = {}
    for key, value in attrs.items():
        if key == "flag_meanings":
            attributes["flag_values"] = np.arange(count, dtype=np.int8)
        attributes[key] = value
    return attributes
