"""Scenes whose lives the study of uncertainty samples, checked.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Sequence

from bearingwear.scene.coefficients import with_usual_spread
from bearingwear.scene.read import Source, source_name
from bearingwear.scene.scene import Scene, SceneError
from bearingwear.studies.answers import Tell
from bearingwear.studies.solve import life_scene

OWN, AS_RECOMMENDED = PRELOAD_CHOICES = ("own", "recommended")
"""The preloads at which lives are sampled: the scene's own, and that of the design study."""


def uncertain_scene(scene: Source, settings: Sequence[str] = (), tell: Tell | None = None) -> Scene:
    """Returns a scene whose lives can be sampled: one for the steady model, with distributions.

    A scene without `uncertainty` gets the usual spread of the table of coefficients.

    settings: changes `KEY=VALUE`.
    tell: takes a line on the distributions that are assumed, if any are.
    SceneError: the life requires another model, or a lognormal distribution is one about a value
        that is not above 0.
    """
    source = source_name(scene)
    scene, assumption = with_usual_spread(life_scene(scene, settings, films=True))
    if tell and assumption:
        tell(assumption)
    for name, spread in (scene.uncertainty or {}).items():
        # not an error of the scene itself: other values may be set in it before it is sampled
        if spread.distribution == "lognormal" and (spread.median or scene.nominal(name)) <= 0.0:
            raise SceneError(
                f"uncertainty.{name}.median",
                f"got {scene.nominal(name):g}, the scene's own value, expected a number > 0 for a "
                "lognormal distribution",
                source=source,
            )
    return scene
