"""The cages that the study maps: config/cage.yaml, checked; and the size of an ensemble.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any, NamedTuple

from bearingwear.scene.blocks import GUIDES
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import NAME, keyed, setting
from bearingwear.scene.read import variant
from bearingwear.studies.axis import RisingAxis, check_rising, place_of_errors

CAGE_FILE = "config/cage.yaml"

STRETCH = 10
"""Shaft turns over which a motion is named."""

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
        for name in ("least_turns", "most_turns"):
            if (turns := getattr(self, name)) % STRETCH:
                raise SceneError(name, f"got {turns}, expected a multiple of {STRETCH}")
        if self.least_turns > self.most_turns:
            raise SceneError(
                "most_turns", f"got {self.most_turns}, expected at least {self.least_turns}"
            )


class CagePoint(NamedTuple):
    """A cage of the map, by the names of `CagePlan`."""

    gravity_m_s2: float
    guiding_race: str
    imbalance_um: float
    pocket_clearance_mm: float
    guide_clearance_mm: float
    cage_friction: float

    @property
    def name(self) -> str:
        return (
            f"g{self.gravity_m_s2:g}-{self.guiding_race}-imbalance{self.imbalance_um:g}"
            f"-pocket{self.pocket_clearance_mm:g}-guide{self.guide_clearance_mm:g}"
            f"-mu{self.cage_friction:g}"
        )

    @property
    def changes(self) -> dict[str, Any]:
        """Keys of a scene that make it this cage."""
        return {
            "operation.gravity_m_s2": [0.0, 0.0, -self.gravity_m_s2],
            "cage.guiding_race": self.guiding_race,
            "cage.imbalance_um": self.imbalance_um,
            "cage.pocket_clearance_mm": self.pocket_clearance_mm,
            "cage.guide_clearance_mm": self.guide_clearance_mm,
            "friction.cage": self.cage_friction,
        }


@keyed
class CagePlan:
    """Everything in config/cage.yaml."""

    scene: str = setting("Scene that provides all values that do not vary", pattern=NAME)
    # fmt: off
    changes: Mapping[str, Any] = setting("Keys to set in the scene", name="set",
        default_factory=dict)
    gravity_m_s2: tuple[float, ...] = setting("Gravity along -Z, which determines the "
        "cage's weight", "m/s2", within="[0, inf)", least=1)
    guiding_race: tuple[str, ...] = setting("Guiding surface of the cage", choices=GUIDES, least=1,
        default=("outer",))
    imbalance_um: tuple[float, ...] = setting("Distances of the centre of mass from the centre of "
        "the cage", "um", within="[0, inf)", least=1, default=(0.0,))
    pocket_clearance_mm: RisingAxis = setting("Diametral clearances of the pockets", "mm")
    guide_clearance_mm: RisingAxis = setting("Diametral clearances at the land", "mm")
    cage_friction: RisingAxis = setting("Coulomb friction coefficients of the pockets and land",
        "1")
    ensemble: Ensemble = setting("Ensemble of runs for each cage", default_factory=Ensemble)
    in_main_study: bool = setting(
        "Whether `snakemake` without a target computes the map and adds it to the report page",
        default=False)
    # fmt: on

    def __post_init__(self) -> None:
        for name in ("gravity_m_s2", "imbalance_um"):
            check_rising(name, getattr(self, name))

    @property
    def scene_file(self) -> str:
        return f"config/scenes/{self.scene}.yaml"

    @property
    def axes(self) -> dict[str, tuple[Any, ...]]:
        """Values along the map's dimensions, in the order of `points`."""
        return {name: getattr(self, name) for name in CagePoint._fields}

    @property
    def points(self) -> dict[str, CagePoint]:
        """The cages of the map by their names."""
        grid = itertools.product(*self.axes.values())
        return {point.name: point for point in itertools.starmap(CagePoint, grid)}

    def settings_at(self, point: CagePoint) -> dict[str, Any]:
        """Settings of the runs of a cage besides the scene."""
        return {
            "changes": {**self.changes, **point.changes},
            "ensemble": asdict(self.ensemble),
        }

    def check_scenes(self) -> None:
        """Read the scene as every cage of the map changes it. Raises ValueError."""
        for name, point in self.points.items():
            with place_of_errors(f"{CAGE_FILE}: {name}"):
                variant(self.scene_file, self.settings_at(point)["changes"])
