"""The record of a variable of a result file, and the one variable of every file: its status."""

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
    """One variable of a result file."""

    name: str
    dims: tuple[str, ...]
    units: str  # in the file; empty for flags, which have none
    long_name: str
    dtype: str = "f8"  # `f8` and `f4` have NaN as `_FillValue`; whole numbers have no fill value
    scale: float = 1.0  # factor on the program's SI value in the file's units
    flags: tuple[str, ...] | None = None  # meanings of 0, 1 and so on
    comment: str | None = None
    # written also where it was not solved, as `_FillValue`; others are then left out
    always: bool = False
    # of a dynamic case, this is the mean over the evaluated turns; so is all that is `always`
    averaged: bool = False
    label: str = ""  # short name for a person, as in `bearingwear show`
    shown: str = ""  # what it is shown as (`units.SCALES`), where its unit does not say

    @functools.cached_property
    def stored_type(self) -> np.dtype[Any]:
        """`dtype`, which takes NumPy as long to read as to store a number."""
        return np.dtype(self.dtype)

    @functools.cached_property
    def missing(self) -> np.generic:
        """Its value where it was not solved."""
        # a last flag says "none"
        return self.stored_type.type(len(self.flags) - 1 if self.flags else np.nan)

    @property
    def attributes(self) -> dict[str, Any]:
        """Its attributes in a file."""
        return self._attributes.copy()

    @functools.cached_property
    def _attributes(self) -> dict[str, Any]:
        found: dict[str, Any] = {"long_name": self.long_name}
        if self.units:
            found["units"] = self.units
        if self.flags:
            found["flag_values"] = np.arange(len(self.flags), dtype=self.dtype)
            found["flag_meanings"] = " ".join(self.flags)
        if self.comment:
            found["comment"] = self.comment
        return found


def table(*variables: Variable, always: bool = False) -> dict[str, Variable]:
    """Variables by their names; `always` holds for all of them."""
    return {v.name: replace(v, always=True) if always else v for v in variables}


STATUS = Variable("status", (), "", "whether the values may be used", "i1", flags=STATUS_NAMES,
    comment="; ".join(f"{name}: {STATUS_SENTENCES[name]}" for name in STATUS_NAMES))  # fmt: skip
