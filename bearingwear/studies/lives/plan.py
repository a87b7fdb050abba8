"""Which lives are solved with the dynamic model: config/lives.yaml.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from bearingwear.scene.read import for_life
from bearingwear.scene.records import NAME, Key
from bearingwear.scene.variant import variant

LIVES_FILE = "config/lives.yaml"


@dataclass(frozen=True, kw_only=True)
class DynamicLife:
    """A scene, and what is changed in it."""

    scene: Annotated[str, Key("Name of a file in config/scenes", pattern=NAME)]
    changes: Annotated[Mapping[str, Any], Key("Keys of the scene to set", name="set")] = field(
        default_factory=dict
    )

    def scene_file(self) -> str:
        return f"config/scenes/{self.scene}.yaml"

    def settings(self) -> dict[str, Any]:
        """What decides it besides the scene."""
        return {"changes": dict(self.changes), "fidelity": "dynamic"}


@dataclass(frozen=True, kw_only=True)
class LivesPlan:
    """Everything in config/lives.yaml."""

    lives: Annotated[Mapping[str, DynamicLife], Key("Lives, by the names of their files")] = field(
        default_factory=dict
    )

    def check_scenes(self) -> None:
        """Read every scene as its life changes it.

        Raises
        ------
        ValueError
            One line.
        """
        for name, life in self.lives.items():
            try:
                for_life(variant(life.scene_file(), life.changes), life.scene_file())
            except ValueError as error:
                what = str(error).removeprefix("--set ")
                raise ValueError(f"{LIVES_FILE}: lives.{name}: {what}") from None
