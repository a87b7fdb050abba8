"""The kind of a result file, and registries of functions for each kind.

A registry maps kinds to functions by their dotted names, `module:function`, so that nothing is
imported before it is needed. Studies, which this part of the package does not import, pass a
registry of their own kinds.
"""

from __future__ import annotations

import importlib
import re
from collections.abc import Callable, Mapping
from typing import Any

CASE_KIND, LIFE_KIND, STUDY_KIND, WEAR_LIFE_KIND = "case", "life", "study", "wear life"
SWEEP_KIND = "sweep"

ONLY_IN_CASES = ("strip", "steady_state", "time", "state", "final_time", "ball_diameter_loss")
"""Variables, and dimensions of variables, that only case files contain.

They are profiles, histories, states to restart from, lists whose length differs from case to case,
and the worn diameter, which is an axis of a study.
"""

Registry = Mapping[str, str]
"""Dotted name of a function for each kind of file."""


def kind_of(file: Any) -> str:
    """Returns the kind of an open file or dataset: case, life, wear life, or a kind of study.

    Cases and lives are recognised by their variables. Every other file states its kind in its
    attribute `kind`, or else in its title, up to the first ` of ` or colon.

    file: `netCDF4.Dataset`, `ContentsView` or `xarray.Dataset`.
    """
    if _is_scalar(file, "end_criterion"):
        return LIFE_KIND
    if "contact_load" in file.variables and _is_scalar(file, "status"):
        return CASE_KIND
    attributes = file.attrs if hasattr(file, "attrs") else file.__dict__
    title = str(attributes.get("title", "result"))
    return str(attributes.get("kind", re.split(" of |:", title)[0].lower()))


def _is_scalar(file: Any, name: str) -> bool:
    """Whether a file contains a variable with a single value."""
    return name in file.variables and file[name].ndim == 0


def imported_function(dotted_name: str) -> Callable[..., Any]:
    """Imports the function of a dotted name, `module:function`, and returns it."""
    module, _, name = dotted_name.partition(":")
    imported: Callable[..., Any] = getattr(importlib.import_module(module), name)
    return imported
