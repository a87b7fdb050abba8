"""Views of a file of two bearings: each bearing, and the arrangement."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from bearingwear.document.document import Block, Row, row_of
from bearingwear.document.rows import limits_of_rows, marked, mean_rows, side_by_side, values
from bearingwear.results.pair_variables import MODES, OF_BEARING

SYSTEM_ROWS = (
    "system_quasistatic_axial_stiffness",
    "system_axial_stiffness",
    "rotor_axial_shift",
    "lift_off_force",
)


class OfBearing:
    """An open file as one bearing of its pair has it."""

    def __init__(self, file: Any, k: int):
        self._file, self._k = file, k

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)

    @property
    def scene(self) -> str:
        """The scene as this bearing has it: in tandem, with its share of the preload."""
        scene = json.loads(self._file.scene)
        scene["operation"]["preload_N"] /= scene["arrangement"].get("tandem", (1, 1))[self._k]
        return json.dumps(scene)

    def __getitem__(self, name: str) -> Any:
        variable = self._file[name]
        return (
            _OfBearing(variable, self._k) if variable.dimensions[:1] == (OF_BEARING,) else variable
        )


class _OfBearing:
    """A variable of a pair as one bearing has it."""

    def __init__(self, variable: Any, k: int):
        self._variable, self._k = variable, k

    def __getattr__(self, name: str) -> Any:
        return getattr(self._variable, name)

    def __getitem__(self, index: Any) -> Any:
        return self._variable[self._k][index]


def bearings_of(file: Any) -> list[tuple[str, Any]]:
    """Titles and views of the bearings of a file, the file itself if it is of one.

    Two that are alike are shown once.
    """
    if OF_BEARING not in file.dimensions or file["status"].dimensions:
        return [("", file)]
    views = [OfBearing(file, k) for k in range(file.dimensions[OF_BEARING].size)]
    alike = all(
        np.array_equal(each[0], each[1], equal_nan=True)
        for name in file.variables
        if (each := _each(file, name)) is not None
    )
    if alike:
        return [("each bearing: ", views[0])]
    return [(f"bearing {k}: ", view) for k, view in enumerate(views, 1)]


def of_bearings(file: Any, blocks_of: Callable[[Any], list[Block]]) -> list[Block]:
    """Blocks of each bearing of a file: of two that differ, side by side."""
    titles, views = zip(*bearings_of(file), strict=True)
    of_each = [blocks_of(one) for one in views]
    if len(of_each) > 1:
        return side_by_side(of_each)
    return [replace(block, title=f"{titles[0]}{block.title}") for block in of_each[0]]


def _each(file: Any, name: str) -> np.ndarray | None:
    variable = file[name]
    if variable.dimensions[:1] != (OF_BEARING,) or variable.dimensions == (OF_BEARING,) == (name,):
        return None
    return values(file, name)


def system_blocks(file: Any) -> list[Block]:
    """Block of the arrangement of both bearings."""
    rows: tuple[Row, ...] = marked(mean_rows(file, SYSTEM_ROWS, limits_of_rows(file)), file)
    if "natural_frequency" in file.variables:
        found = row_of("natural_frequency", values(file, "natural_frequency"))
        rows += tuple(
            found._replace(
                label=f"{mode} natural frequency", values=(value,), name=f"{mode}_frequency"
            )
            for mode, value in zip(MODES, found.values, strict=True)
        )
    return [Block("arrangement", (), rows)] if rows else []
