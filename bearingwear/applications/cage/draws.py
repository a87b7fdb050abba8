"""Random input of the runs of an ensemble: values of the scene, gravity, start of the cage.

A run depends on the seed and its number alone, so that any share of the work gives the same runs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bearingwear import Scene
from bearingwear.applications.cage.plan import Ensemble
from bearingwear.scene.coefficients import ASSUMED_FRICTION, ASSUMED_WEAR
from bearingwear.scene.distributions import possible_range, quantile, sampled_values
from bearingwear.scene.scene import WORN, Distribution
from bearingwear.scene.uncertain import UNCERTAIN_CAGE
from bearingwear.solvers.dynamic.system import CageStart
from bearingwear.studies.sampling import scene_with_values

CLOSE = 0.95
"""Share of its clearance within which a cage starts anywhere."""

ASSUMED_CLEARANCE = 0.05
"""Standard deviation of a clearance over itself where the scene has none."""

WEAR, GRAVITY_ANGLE = "wear_coefficient", "gravity_angle_deg"


class CageDraw(NamedTuple):
    """Input of a run; no scene if the sampled values are impossible."""

    scene: Scene | None
    start: CageStart
    values: dict[str, float]  # drawn, by their names


def cage_spread(scene: Scene) -> tuple[dict[str, Distribution], str]:
    """Returns the distributions of a cage's values, and a sentence if they are assumed."""
    if scene.cage_uncertainty is not None:
        return dict(scene.cage_uncertainty), ""
    cage = scene.cage
    assert cage is not None
    friction, wear = f"{ASSUMED_FRICTION.factor:.2g}", f"{ASSUMED_WEAR.factor:.2g}"
    names = ["pocket_clearance_mm", "guide_clearance_mm"][: 1 + (cage.guiding_race != "ball")]
    spread = {
        name: Distribution(
            distribution="normal", standard_deviation=ASSUMED_CLEARANCE * getattr(cage, name)
        )
        for name in names
    }
    spread["cage"] = Distribution(distribution="lognormal", factor=float(friction))
    spread[WEAR] = Distribution(distribution="lognormal", factor=float(wear))
    sentence = (
        f"assumed scatter in the cage parameters: friction by a factor of {friction}, clearances "
        f"by {100.0 * ASSUMED_CLEARANCE:g} %, K_s/H by a factor of {wear}"
    )
    return spread, sentence


def cage_value(scene: Scene, name: str) -> float:
    """Returns the value that the scene itself has for a name of `UNCERTAIN_CAGE`."""
    if name == WEAR:
        return 1.0
    if name == GRAVITY_ANGLE:
        axial, *across = scene.operation.gravity_m_s2
        return math.degrees(math.atan2(math.hypot(*across), abs(axial)))
    return float(getattr(getattr(scene, UNCERTAIN_CAGE[name]), name))


def cage_draw(
    scene: Scene, spread: Mapping[str, Distribution], plan: Ensemble, run: int
) -> CageDraw:
    """Draws the input of a run.

    spread: distributions of the new cage, from `cage_spread`.
    """
    random = np.random.default_rng([plan.seed, run])
    offset, angle, whirl, gravity_turn = random.random(4)
    start = CageStart(CLOSE * math.sqrt(offset), 2.0 * math.pi * angle, whirl)
    names = [name for name in scene.uncertainty or {} if name not in WORN]
    bearing_values = sampled_values(scene, names, random.random((1, len(names))))[0].tolist()
    drawn_values = dict(zip(names, bearing_values, strict=True))
    cage_values = {}
    for name, distribution in spread.items():
        probability = np.array(random.random())
        if name != WEAR:
            nominal, key = cage_value(scene, name), f"{UNCERTAIN_CAGE[name]}.{name}"
            limits = (0.0, 180.0) if name == GRAVITY_ANGLE else possible_range(key)
            cage_values[name] = float(quantile(distribution, nominal, limits, probability))
    drawn_scene = scene_with_values(scene, drawn_values)
    if drawn_scene is not None:
        drawn_scene = worn_cage(
            _with_cage(drawn_scene, cage_values, 2.0 * math.pi * gravity_turn), plan.worn_um
        )
    return CageDraw(drawn_scene, start, drawn_values | cage_values)


def _with_cage(scene: Scene, values: Mapping[str, float], about: float) -> Scene:
    """Returns the scene with other values of its cage, and gravity turned about the shaft.

    about: angle of gravity about the shaft [rad].
    """
    parts = {
        block: {name: value for name, value in values.items() if UNCERTAIN_CAGE[name] == block}
        for block in ("friction", "cage")
    }
    changed_blocks = {
        block: replace(getattr(scene, block), **part) for block, part in parts.items()
    }
    if GRAVITY_ANGLE in values:
        size, angle = math.hypot(*scene.operation.gravity_m_s2), math.radians(values[GRAVITY_ANGLE])
        across = size * math.sin(angle)
        gravity = (size * math.cos(angle), across * math.cos(about), across * math.sin(about))
        changed_blocks["operation"] = replace(scene.operation, gravity_m_s2=gravity)
    return replace(scene, **changed_blocks)


def worn_cage(scene: Scene, depth_um: Sequence[float]) -> Scene:
    """Returns the scene with worn pocket walls and a worn guiding surface.

    depth_um: wear depths of the pocket walls and of the guiding surface [um].
    """
    cage = scene.cage
    assert cage is not None
    pocket, guide = (2e-3 * depth for depth in depth_um)
    worn = replace(
        cage,
        pocket_clearance_mm=cage.pocket_clearance_mm + pocket,
        guide_clearance_mm=cage.guide_clearance_mm + guide,
    )
    return replace(scene, cage=worn)
