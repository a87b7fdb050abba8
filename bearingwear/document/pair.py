"""Views of each bearing in a file of two, and the block of their arrangement."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from bearingwear.document.document import Block, row_of
from bearingwear.document.rows import (
    mean_rows,
    rows_with_violations,
    side_by_side,
    variable_limits,
    variable_values,
)
from bearingwear.results.pair_variables import MODES, OF_BEARING

SYSTEM_ROWS = (
    "system_quasistatic_axial_stiffness",
    "system_axial_stiffness",
    "rotor_axial_shift",
    "spring_travel",
    "lift_off_force",
)


class BearingView:
    """An open file of a pair that reads like the file of its bearing k alone."""

    def __init__(self, file: Any, k: int):
        self._file, self._k = file, k

    def __getattr__(self, name: str) -> Any:
        """Returns an attribute of the file, which both bearings share."""
        return getattr(self._file, name)

    @property
    def scene(self) -> str:
        """Returns the scene of this bearing as JSON; in tandem, it has a share of the preload."""
        scene = json.loads(self._file.scene)
        scene["operation"]["preload_N"] /= scene["arrangement"].get("tandem", (1, 1))[self._k]
        return json.dumps(scene)

    def __getitem__(self, name: str) -> Any:
        """Returns a variable; one along the bearings is reduced to this bearing."""
        variable = self._file[name]
        if variable.dimensions[:1] != (OF_BEARING,):
            return variable
        return _VariableView(variable, self._k)


class _VariableView:
    """A variable of a pair that reads like that of bearing k alone."""

    def __init__(self, variable: Any, k: int):
        self._variable, self._k = variable, k

    def __getattr__(self, name: str) -> Any:
        """Returns an attribute of the variable."""
        return getattr(self._variable, name)

    def __getitem__(self, index: Any) -> Any:
        """Returns values of bearing k, indexed along the other dimensions."""
        return self._variable[self._k][index]


class TitledView(NamedTuple):
    """One bearing of a file, and the start of the titles of its blocks."""

    title: str  # empty if the file has only one bearing
    file: Any  # the open file, or a `BearingView`


def bearing_views(file: Any) -> list[TitledView]:
    """Returns a view of each bearing of an open file; the file itself if it has only one.

    Two bearings with equal results have one view.
    """
    # a status with dimensions is that of several cases, which have no view of their own
    if OF_BEARING not in file.dimensions or file["status"].dimensions:
        return [TitledView("", file)]
    views = [BearingView(file, k) for k in range(file.dimensions[OF_BEARING].size)]
    if all(_is_equal_in_both(file, name) for name in file.variables):
        return [TitledView("each bearing: ", views[0])]
    return [TitledView(f"bearing {k}: ", view) for k, view in enumerate(views, 1)]


def blocks_by_bearing(file: Any, blocks_of: Callable[[Any], list[Block]]) -> list[Block]:
    """Returns the blocks of the bearings of an open file; if two differ, side by side.

    blocks_of: returns the blocks of a file with one bearing.
    """
    views = bearing_views(file)
    if len(views) > 1:
        return side_by_side([blocks_of(view.file) for view in views])
    (view,) = views
    return [replace(block, title=f"{view.title}{block.title}") for block in blocks_of(view.file)]


def _is_equal_in_both(file: Any, name: str) -> bool:
    """Returns whether a variable does not distinguish the bearings of a file.

    It either has equal values for both, or is not along the dimension of the bearings. The
    coordinate of this dimension does not count.
    """
    if name == OF_BEARING or file[name].dimensions[:1] != (OF_BEARING,):
        return True
    first, second = variable_values(file, name)
    return np.array_equal(first, second, equal_nan=True)


def system_blocks(file: Any) -> list[Block]:
    """Returns a list with the block of the arrangement of both bearings.

    The list is empty if the file contains none of its variables, as that of a single bearing.
    """
    rows = rows_with_violations(mean_rows(file, SYSTEM_ROWS, variable_limits(file)), file)
    if "natural_frequency" in file.variables:
        row = row_of("natural_frequency", variable_values(file, "natural_frequency"))
        rows += tuple(
            row._replace(
                label=f"{mode} natural frequency", values=(value,), name=f"{mode}_frequency"
            )
            for mode, value in zip(MODES, row.values, strict=True)
        )
    return [Block("arrangement", (), rows)] if rows else []
