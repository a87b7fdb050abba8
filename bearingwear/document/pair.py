"""Views of each bearing in a file of two, and the block of their arrangement."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from bearingwear.document.document import Block, row_of
from bearingwear.document.rows import (
    mean_rows,
    rows_with_violations,
    side_by_side,
    values,
    variable_limits,
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
    """An open file of a pair, reduced to its bearing k: reads like the file of one bearing."""

    def __init__(self, file: Any, k: int):
        self._file, self._k = file, k

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)

    @property
    def scene(self) -> str:
        """Returns the scene of this bearing as JSON; in tandem, with its share of the preload."""
        scene = json.loads(self._file.scene)
        scene["operation"]["preload_N"] /= scene["arrangement"].get("tandem", (1, 1))[self._k]
        return json.dumps(scene)

    def __getitem__(self, name: str) -> Any:
        variable = self._file[name]
        if variable.dimensions[:1] != (OF_BEARING,):
            return variable
        return _VariableView(variable, self._k)


class _VariableView:
    """A variable of a pair, reduced to bearing k."""

    def __init__(self, variable: Any, k: int):
        self._variable, self._k = variable, k

    def __getattr__(self, name: str) -> Any:
        return getattr(self._variable, name)

    def __getitem__(self, index: Any) -> Any:
        return self._variable[self._k][index]


def bearing_views(file: Any) -> list[tuple[str, Any]]:
    """Returns the title and a view of each bearing of a file; the file itself if it has only one.

    Two bearings that are alike have one view.
    """
    if OF_BEARING not in file.dimensions or file["status"].dimensions:
        return [("", file)]
    views = [BearingView(file, k) for k in range(file.dimensions[OF_BEARING].size)]
    if all(_is_equal_in_both(file, name) for name in file.variables):
        return [("each bearing: ", views[0])]
    return [(f"bearing {k}: ", view) for k, view in enumerate(views, 1)]


def blocks_by_bearing(file: Any, blocks_of: Callable[[Any], list[Block]]) -> list[Block]:
    """Returns the blocks of each bearing of a file; those of two that differ, side by side."""
    (title, first), *others = bearing_views(file)
    if others:
        return side_by_side([blocks_of(view) for view in (first, *(view for _, view in others))])
    return [replace(block, title=f"{title}{block.title}") for block in blocks_of(first)]


def _is_equal_in_both(file: Any, name: str) -> bool:
    """Whether a variable is equal for both bearings; one that is not of a bearing counts as equal.

    The coordinate of the bearings themselves does not count.
    """
    if name == OF_BEARING or file[name].dimensions[:1] != (OF_BEARING,):
        return True
    first, second = values(file, name)
    return np.array_equal(first, second, equal_nan=True)


def system_blocks(file: Any) -> list[Block]:
    """Returns the block of the arrangement of both bearings."""
    rows = rows_with_violations(mean_rows(file, SYSTEM_ROWS, variable_limits(file)), file)
    if "natural_frequency" in file.variables:
        row = row_of("natural_frequency", values(file, "natural_frequency"))
        rows += tuple(
            row._replace(
                label=f"{mode} natural frequency", values=(value,), name=f"{mode}_frequency"
            )
            for mode, value in zip(MODES, row.values, strict=True)
        )
    return [Block("arrangement", (), rows)] if rows else []
