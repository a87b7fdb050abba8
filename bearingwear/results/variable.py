"""The record of a variable of a result file, and the variable `status` of every case and life."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bearingwear.kernels.status import STATUS_NAMES, STATUS_SENTENCES

DEGREE = 180.0 / math.pi
SECONDS_PER_HOUR = 3600.0
HOURS_PER_SECOND = 1.0 / SECONDS_PER_HOUR

ESTIMATE = "based on solutions with different accuracy settings; excludes modelling errors"
"""Comment of every estimate of a numerical error."""


@dataclass(frozen=True)
class Variable:
    """A variable of a result file."""

    name: str
    dims: tuple[str, ...]
    units: str  # in the file; empty for flags, which have none
    long_name: str
    dtype: str = "f8"  # `f8` and `f4` have NaN as `_FillValue`; whole numbers have no fill value
    scale: float = 1.0  # factor on the program's SI value in the file's units
    flags: tuple[str, ...] | None = None  # meanings of 0, 1 and so on
    comment: str | None = None
    # whether files of unsolved cases contain it, as `_FillValue`; others are then left out
    always: bool = False
    # whether a dynamic case contains its mean over the evaluated turns, as it does of all `always`
    averaged: bool = False
    label: str = ""  # short name for a person, as in `bearingwear show`
    shown: str = ""  # key of `units.SCALES` for its display, if `units` is not that key

    @functools.cached_property
    def stored_type(self) -> np.dtype[Any]:
        """Returns its NumPy type; cached, as parsing the name takes as long as storing a number."""
        return np.dtype(self.dtype)

    @functools.cached_property
    def missing(self) -> np.generic:
        """Returns its value if it was not solved: NaN, or the last flag, which is named "none".

        ValueError: it is a whole number without flags, which has no such value.
        """
        return self.stored_type.type(len(self.flags) - 1 if self.flags else np.nan)

    @property
    def attributes(self) -> dict[str, Any]:
        """Returns a new dictionary of its attributes in a file."""
        return self._attributes.copy()

    @functools.cached_property
    def _attributes(self) -> dict[str, Any]:
        """Returns its attributes in a file; callers share the dictionary and must not change it."""
        attributes: dict[str, Any] = {"long_name": self.long_name}
        if self.units:
            attributes["units"] = self.units
        if self.flags:
            attributes["flag_values"] = np.arange(len(self.flags), dtype=self.dtype)
            attributes["flag_meanings"] = " ".join(self.flags)
        if self.comment:
            attributes["comment"] = self.comment
        return attributes


def table(*variables: Variable, always: bool = False) -> dict[str, Variable]:
    """Returns variables by their names.

    always: whether to set `Variable.always` of all of them.
    """
    return {
        variable.name: replace(variable, always=True) if always else variable
        for variable in variables
    }


STATUS = Variable("status", (), "", "whether the values may be used", "i1", flags=STATUS_NAMES,
    comment="; ".join(f"{name}: {STATUS_SENTENCES[name]}" for name in STATUS_NAMES))  # fmt: skip
