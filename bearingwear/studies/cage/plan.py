"""The cages that the study solves: config/cage.yaml, checked.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any, NamedTuple

from bearingwear.scene.errors import SceneError
from bearingwear.scene.records import NAME, keyed, setting
from bearingwear.scene.variant import variant
from bearingwear.studies.axis import RisingAxis, check_rising

CAGE_FILE = "config/cage.yaml"

CAGE_STARTS = ("below", "leaning", "whirling")
"""Where a cage starts: half a clearance below the axis and at rest, as a solve does; at 95 % of its
clearance and going round with the balls; there, and going round at the mean rate of balls and
shaft."""


class CagePoint(NamedTuple):
    """A cage of the map."""

    friction: float
    pocket_clearance_mm: float
    guide_clearance_mm: float
    gravity_m_s2: float

    @property
    def name(self) -> str:
        return (
            f"mu{self.friction:g}-pocket{self.pocket_clearance_mm:g}"
            f"-guide{self.guide_clearance_mm:g}-g{self.gravity_m_s2:g}"
        )

    @property
    def changes(self) -> dict[str, Any]:
        """Keys of a scene that make it this cage."""
        return {
            "friction.cage": self.friction,
            "cage.pocket_clearance_mm": self.pocket_clearance_mm,
            "cage.guide_clearance_mm": self.guide_clearance_mm,
            "operation.gravity_m_s2": [0.0, 0.0, -self.gravity_m_s2],
        }


@keyed
class CagePlan:
    """Everything in config/cage.yaml."""

    scene: str = setting("Scene that has all that is not varied", pattern=NAME)
    changes: Mapping[str, Any] = setting(
        "Keys of the scene to set", name="set", default_factory=dict
    )
    cage_friction: RisingAxis = setting("Coulomb coefficients of pockets and land", "1")
    pocket_clearance_mm: RisingAxis = setting("Diametral clearances of the pockets", "mm")
    guide_clearance_mm: RisingAxis = setting("Diametral clearances of the land", "mm")
    gravity_m_s2: tuple[float, ...] = setting(
        "Weights, gravity along -Z", "m/s2", minimum=0, least=1
    )
    starts: tuple[str, ...] = setting(
        "Where the cage starts", choices=CAGE_STARTS, least=1, default=CAGE_STARTS
    )
    turns: int = setting("Shaft turns of a run", "1", minimum=6, default=150)
    stretch_turns: int = setting(
        "Shaft turns over which a motion is told, a divisor of turns", "1", minimum=3, default=10
    )
    evaluated_stretches: int = setting(
        "Stretches at the end over which wear and whirl are averaged", "1", minimum=1, default=5
    )

    def __post_init__(self) -> None:
        try:
            check_rising(self.gravity_m_s2)
        except ValueError as error:
            raise SceneError("gravity_m_s2", str(error)) from None
        if self.turns % self.stretch_turns:
            raise SceneError(
                "stretch_turns", f"got {self.stretch_turns}, expected a divisor of {self.turns}"
            )
        most = self.turns // self.stretch_turns
        if self.evaluated_stretches > most:
            raise SceneError(
                "evaluated_stretches", f"got {self.evaluated_stretches}, expected at most {most}"
            )

    @property
    def scene_file(self) -> str:
        return f"config/scenes/{self.scene}.yaml"

    @property
    def shape(self) -> dict[str, int]:
        """Lengths of the map's dimensions, in the order of `points`."""
        return {
            "cage_friction": len(self.cage_friction),
            "pocket_clearance": len(self.pocket_clearance_mm),
            "guide_clearance": len(self.guide_clearance_mm),
            "gravity": len(self.gravity_m_s2),
        }

    @property
    def points(self) -> dict[str, CagePoint]:
        """The cages of the map by their names."""
        grid = itertools.product(
            self.cage_friction, self.pocket_clearance_mm, self.guide_clearance_mm, self.gravity_m_s2
        )
        return {point.name: point for point in itertools.starmap(CagePoint, grid)}

    def changes_at(self, point: CagePoint) -> dict[str, Any]:
        """Keys of the scene that a run of this cage sets."""
        return {
            **self.changes,
            **point.changes,
            "model.simulated_turns": self.turns,
            "model.evaluated_turns": self.stretch_turns * self.evaluated_stretches,
        }

    def settings_at(self, point: CagePoint) -> dict[str, Any]:
        """What decides the runs of a cage besides the scene."""
        return {
            "changes": self.changes_at(point),
            "starts": list(self.starts),
            "stretch_turns": self.stretch_turns,
        }

    def check_scenes(self) -> None:
        """Read the scene as every cage of the map changes it.

        Raises
        ------
        ValueError
            One line.
        """
        for name, point in self.points.items():
            try:
                variant(self.scene_file, self.changes_at(point))
            except ValueError as error:
                what = str(error).removeprefix("--set ")
                raise ValueError(f"{CAGE_FILE}: {name}: {what}") from None
