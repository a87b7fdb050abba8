"""Names for codes: what is race 0 in a file is race "inner" in memory.

Files keep whole numbers with `flag_meanings`, as CF asks; a person selects by name.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

MEMORY_ALONE = ("wall_time_s", "message")
"""Attributes of a dataset in memory that its file does not have."""


def labelled(dataset: xr.Dataset) -> xr.Dataset:
    """A dataset whose coordinates are names instead of codes; data variables keep their codes."""
    return dataset.assign_coords({name: named(dataset.variables[name]) for name in dataset.coords})


def named(coordinate: xr.Variable) -> xr.Variable:
    """A coordinate with names for its codes, if it has codes."""
    if "flag_meanings" not in coordinate.attrs or coordinate.dtype.kind not in "iu":
        return coordinate
    meanings = np.array(coordinate.attrs["flag_meanings"].split())
    attrs = {key: value for key, value in coordinate.attrs.items() if key != "flag_values"}
    return type(coordinate)(coordinate.dims, meanings[coordinate.values], attrs)


def coded(dataset: xr.Dataset) -> xr.Dataset:
    """A dataset as files have it: the codes that `labelled` has named.

    A coordinate with other names than its `flag_meanings` stays as it is.
    """
    codes = {}
    for name, coordinate in dataset.coords.items():
        meanings = str(coordinate.attrs.get("flag_meanings", "")).split()
        given = coordinate.values
        if meanings and given.dtype.kind in "UOT" and set(given.flat) <= set(meanings):
            numbers = np.array([meanings.index(label) for label in given.flat], dtype=np.int8)
            flags = {"flag_values": np.arange(len(meanings), dtype=np.int8)}
            attrs = {**coordinate.attrs, **flags, "flag_meanings": " ".join(meanings)}
            codes[name] = (coordinate.dims, numbers.reshape(given.shape), attrs)
    attrs = {key: value for key, value in dataset.attrs.items() if key not in MEMORY_ALONE}
    made = dataset.assign_coords(codes)
    made.attrs = attrs
    return made
