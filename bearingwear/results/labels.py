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
    """Returns the name of each code, and the attributes of a variable of names.

    codes: whole numbers of any shape; -1 has the name `NO_NAME`.
    attrs: of the codes; their `flag_meanings` are the names.
    """
    names = np.asarray(_code_names(attrs["flag_meanings"])[codes])
    return names, {key: value for key, value in attrs.items() if key != "flag_values"}


@functools.cache
def _code_names(meanings: str) -> np.ndarray:
    """Returns the names of the codes 0, 1, ..., -1 in an array; a code is the index of its name.

    meanings: names of all codes but -1, separated by spaces.
    """
    return np.array([*meanings.split(), NO_NAME])


def coded(dataset: xr.Dataset) -> xr.Dataset:
    """Returns a dataset with codes instead of names, and the attributes of files.

    It reverses `labelled`. A variable with a text that is not among its `flag_meanings` is not
    changed.
    """
    variables = {name: _coded_variable(variable) for name, variable in dataset.variables.items()}
    result = dataset.assign(
        {name: variable for name, variable in variables.items() if variable is not None}
    )
    result.attrs = {key: dataset.attrs[key] for key in dataset.attrs if key not in ONLY_IN_MEMORY}
    return result


def _coded_variable(variable: xr.Variable) -> tuple[Any, np.ndarray, dict[Any, Any]] | None:
    """Returns dimensions, codes and attributes of a variable of names; None for all others."""
    meanings = str(variable.attrs.get("flag_meanings", "")).split()
    names = variable.values
    code_of = {NO_NAME: -1} | {name: code for code, name in enumerate(meanings)}
    is_text = names.dtype.kind in "UOT"  # fixed or variable length, or objects
    if not (meanings and is_text and set(names.flat) <= code_of.keys()):
        return None
    codes = np.array([code_of[name] for name in names.flat], dtype=np.int8)
    attrs = _attributes_of_codes(variable.attrs, len(meanings))
    return variable.dims, codes.reshape(names.shape), attrs


def _attributes_of_codes(attrs: Mapping[Any, Any], count: int) -> dict[Any, Any]:
    """Returns attributes with `flag_values` before `flag_meanings`, their order in files.

    attrs: of a variable of names, without `flag_values`.
    count: number of codes.
    """
    attributes = {}
    for key, value in attrs.items():
        if key == "flag_meanings":
            attributes["flag_values"] = np.arange(count, dtype=np.int8)
        attributes[key] = value
    return attributes
