"""The study of lives: wear is followed with the dynamic model, cage and all, to the end of life.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bearingwear.scene.checking.check import read_record
from bearingwear.scene.checking.records import NAME, keyed, setting
from bearingwear.scene.read import for_life, variant
from bearingwear.studies.axis import place_of_errors
from bearingwear.studies.protocol import Study, figure_step, step, table_step

LIVES_FILE = "config/lives.yaml"


@keyed
class DynamicLife:
    """A scene, and what is changed in it."""

    scene: str = setting("Name of a scene file in config/scenes", pattern=NAME)
    changes: Mapping[str, Any] = setting(
        "Keys to set in the scene", name="set", default_factory=dict
    )

    def scene_file(self) -> str:
        return f"config/scenes/{self.scene}.yaml"

    def settings(self) -> dict[str, Any]:
        """Settings besides the scene."""
        return {"changes": dict(self.changes), "fidelity": "dynamic"}


@keyed
class LivesPlan:
    """Everything in config/lives.yaml."""

    lives: Mapping[str, DynamicLife] = setting(
        "Life calculations, by the names of their result files", default_factory=dict
    )

    def check_scenes(self) -> None:
        """Read every scene as its life changes it. Raises ValueError."""
        for name, life in self.lives.items():
            with place_of_errors(f"{LIVES_FILE}: lives.{name}"):
                for_life(variant(life.scene_file(), life.changes), life.scene_file())


def study(config: Mapping[str, Any]) -> Study:
    """The study of config/lives.yaml."""
    return study_of_lives(read_record(LivesPlan, LIVES_FILE))


def study_of_lives(plan: LivesPlan) -> Study:
    """A life each, its figure, and one table."""
    return Study(
        "lives",
        plan,
        step("solve", "{life}.nc", "studies.solve.solved_life", plan.lives,
            scene=DynamicLife.scene_file, settings=DynamicLife.settings, work=1.0),
        figure_step("{life}", "figures.wear_history", life="{life}.nc"),
        table_step("lives", "tables.lives_table", lives="{life}.nc"),
    )  # fmt: skip
