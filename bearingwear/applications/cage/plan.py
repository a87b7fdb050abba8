"""The cages that the study maps, by config/cage.yaml, and the size of an ensemble.

The keys of that file stand in workflow/schemas/cage.schema.yaml. This file imports nothing heavy:
the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from bearingwear import SceneError
from bearingwear.scene.checking.check import record
from bearingwear.scene.checking.records import keyed, setting
from bearingwear.scene.read import variant
from bearingwear.studies.axis import RisingAxis, check_rising, place_of_errors

CAGE_FILE = Path("config/cage.yaml")

STRETCH = 10
"""Shaft turns over which a motion is classified."""

FEWEST = 20
"""Runs of an ensemble before it may stop."""


@keyed
class Ensemble:
    """Runs of one cage, each with a draw of its own."""

    runs: int = setting("Maximum number of runs", within=f"[{FEWEST}, inf)", default=200)
    # fmt: off
    within: float = setting(
        "Target relative half-width of the 90 % interval for the work per turn", "1", "(0, 1)",
        default=0.1)
    seed: int = setting("Random seed for the samples", within="[0, inf)", default=1)
    least_turns: int = setting(f"Minimum number of shaft turns per run (a multiple of {STRETCH})",
        "1", within="[30, inf)", default=30)
    most_turns: int = setting("Maximum number of shaft turns in a run that has not settled",
        "1", "[30, inf)", default=150)

    worn_um: tuple[float, float] = setting(
        "Wear depths of the pocket walls and of the guiding surface", "um", within="[0, inf)",
        default=(0.0, 0.0))
    # fmt: on

    def __post_init__(self) -> None:
        """Checks the numbers of turns.

        SceneError: they are no multiples of `STRETCH`, or the least is above the most.
        """
        for name in ("least_turns", "most_turns"):
            if (turns := getattr(self, name)) % STRETCH:
                raise SceneError(name, f"got {turns}, expected a multiple of {STRETCH}")
        if self.least_turns > self.most_turns:
            raise SceneError(
                "most_turns", f"got {self.most_turns}, expected at least {self.least_turns}"
            )


class CagePoint(NamedTuple):
    """A cage of the map, by the keys of config/cage.yaml."""

    gravity_m_s2: float
    guiding_race: str
    imbalance_um: float
    pocket_clearance_mm: float
    guide_clearance_mm: float
    cage_friction: float

    @property
    def name(self) -> str:
        """Returns the name of its file without suffix, which states all values."""
        return (
            f"g{self.gravity_m_s2:g}-{self.guiding_race}-imbalance{self.imbalance_um:g}"
            f"-pocket{self.pocket_clearance_mm:g}-guide{self.guide_clearance_mm:g}"
            f"-mu{self.cage_friction:g}"
        )

    @property
    def changes(self) -> dict[str, Any]:
        """Returns the values that this cage has in a scene, by dotted keys."""
        return {
            "operation.gravity_m_s2": [0.0, 0.0, -self.gravity_m_s2],
            "cage.guiding_race": self.guiding_race,
            "cage.imbalance_um": self.imbalance_um,
            "cage.pocket_clearance_mm": self.pocket_clearance_mm,
            "cage.guide_clearance_mm": self.guide_clearance_mm,
            "friction.cage": self.cage_friction,
        }


def cage_axes(cage: Mapping[str, Any]) -> dict[str, list[Any]]:
    """Returns the values along each dimension of a map by their keys, in the order of `CagePoint`.

    cage: content of config/cage.yaml. ValueError: the numbers of a dimension do not rise.
    """
    axes = {name: [*cage[name]] for name in ("gravity_m_s2", "guiding_race", "imbalance_um")}
    for name in ("gravity_m_s2", "imbalance_um"):
        check_rising(name, axes[name])
    for name in ("pocket_clearance_mm", "guide_clearance_mm", "cage_friction"):
        with place_of_errors(name):
            axes[name] = [*RisingAxis.from_plain(cage[name])]
    return axes


def cage_points(cage: Mapping[str, Any]) -> dict[str, CagePoint]:
    """Returns the cages of the map by the names of their files; empty if the map has no `scene`.

    cage: content of config/cage.yaml. ValueError as `cage_axes`.
    """
    if "scene" not in cage:
        return {}
    points = itertools.starmap(CagePoint, itertools.product(*cage_axes(cage).values()))
    return {point.name: point for point in points}


def check_cage(cage: Mapping[str, Any], path: Path = CAGE_FILE) -> None:
    """Raises ValueError for a map with an invalid ensemble, axis or scene of any cage.

    The error names the file and the cage.

    cage: content of the file at `path`. Its scene lies in the folder `scenes` beside that file.
    """
    with place_of_errors(str(path)):
        record(Ensemble, cage["ensemble"], "ensemble")
        for name, point in cage_points(cage).items():
            scene = path.parent / "scenes" / f"{cage['scene']}.yaml"
            with place_of_errors(name):
                variant(scene, {**cage["set"], **point.changes})
