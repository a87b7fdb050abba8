"""What the study of uncertainty samples: config/uncertainty.yaml, checked.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from bearingwear.scene.checking.records import keyed, setting
from bearingwear.scene.coefficients import with_usual_spread
from bearingwear.scene.scene import PRELOAD_METHODS, Scene, SceneError
from bearingwear.studies.pool import Tell
from bearingwear.studies.sampling import Sampling
from bearingwear.studies.solve import life_scene

OWN, AS_RECOMMENDED = PRELOAD_CHOICES = ("own", "recommended")
"""The preloads at which lives are sampled: the scene's own, and the design study's."""


@keyed
class SampledScene:
    """A scene whose lives are sampled."""

    preload_method: tuple[str, ...] = setting(
        "Preload methods, selected from those in the design map", choices=PRELOAD_METHODS, least=1
    )


class SamplePart(NamedTuple):
    """A part of the sampled lives of a scene."""

    scene: str
    method: str
    preload_choice: str
    chunk: int

    @property
    def as_recommended(self) -> bool:
        """Whether they are at the preload that the design study recommends."""
        return self.preload_choice == AS_RECOMMENDED

    @property
    def settings(self) -> dict[str, Any]:
        """All but its scene, which is a file."""
        return {name: value for name, value in self._asdict().items() if name != "scene"}


@keyed
class UncertaintyPlan:
    """Everything in config/uncertainty.yaml."""

    scenes: Mapping[str, SampledScene] = setting("Scenes for which lives are sampled", least=1)
    sampling: Sampling = setting("Sampling of the uncertain values")

    @property
    def parts(self) -> list[SamplePart]:
        """Every part of the sampled lives."""
        return [
            SamplePart(scene, method, choice, chunk)
            for scene, sampled in self.scenes.items()
            for method in sampled.preload_method
            for choice in PRELOAD_CHOICES
            for chunk in range(self.sampling.chunks)
        ]

    def check_scenes(self, folder: str | Path = "config/scenes") -> None:
        """Read every scene and look whether its lives can be sampled. Raises ValueError."""
        for name in self.scenes:
            uncertain_scene(Path(folder) / f"{name}.yaml")


def uncertain_scene(
    path: str | Path, settings: Sequence[str] = (), tell: Tell | None = None
) -> Scene:
    """A scene whose lives can be sampled: `life_scene`, with distributions.

    tell: given what distributions are taken where the scene has none.
    """
    scene, source = life_scene(path, settings, films=True), os.fspath(path)
    scene, said = with_usual_spread(scene)
    if tell and said:
        tell(said)
    for name, given in (scene.uncertainty or {}).items():
        # not an error of the scene: other values may be set in it, which no sample is asked of
        if given.distribution == "lognormal" and (given.median or scene.nominal(name)) <= 0.0:
            raise SceneError(
                f"uncertainty.{name}.median",
                f"got {scene.nominal(name):g}, the scene's own value, expected a number > 0 for a "
                "lognormal distribution",
                source=source,
            )
    return scene
