"""Which lives are solved with the dynamic model: config/lives.yaml.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from bearingwear.scene.checking.records import NAME, keyed, setting
from bearingwear.scene.read import for_life
from bearingwear.scene.variant import variant

LIVES_FILE = "config/lives.yaml"


@keyed
class DynamicLife:
    """A scene, and what is changed in it."""

    scene: str = setting("Name of a file in config/scenes", pattern=NAME)
    changes: Mapping[str, Any] = setting(
        "Keys of the scene to set", name="set", default_factory=dict
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
        "Lives, by the names of their files", default_factory=dict
    )

    def check_scenes(self) -> None:
        """Read every scene as its life changes it. Raises ValueError."""
        for name, life in self.lives.items():
            try:
                for_life(variant(life.scene_file(), life.changes), life.scene_file())
            except ValueError as error:
                what = str(error).removeprefix("--set ")
                raise ValueError(f"{LIVES_FILE}: lives.{name}: {what}") from None
