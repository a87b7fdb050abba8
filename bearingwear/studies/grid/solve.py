"""Solves the points of a grid, a line of it at a time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from bearingwear.scene.read import as_data, changed_scene
from bearingwear.studies.grid.grid import Case, Line
from bearingwear.studies.solve import told

if TYPE_CHECKING:
    from bearingwear.solvers.result import Result


def solved_line(
    scene: Path, method: str, friction: float, losses_um: Sequence[float]
) -> Iterator[Result]:
    """Step: the cases of a line, one for each loss of ball diameter [um]."""
    return solved_cases(scene, cases_of([(method, friction)], losses_um))


def cases_of(lines: Sequence[Line], losses_um: Sequence[float]) -> list[Case]:
    """Every point of some lines, the loss of ball diameter [um] fastest."""
    return [Case(method, friction, loss) for method, friction in lines for loss in losses_um]


def solved_cases(scene: Path, cases: Sequence[Case]) -> Iterator[Result]:
    """Each case of a scene, whose file is read once."""
    from bearingwear.solvers.solve import solve

    data, source = as_data(scene)
    for case in cases:
        yield told(solve(changed_scene(data, case.changes, source)), scene)
