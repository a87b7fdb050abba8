"""What the runs of an ensemble draw: values of the scene, gravity, and where the cage starts.

A run depends on the seed and its number alone, so that any share of the work gives the same runs.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bearingwear.applications.cage.plan import Ensemble
from bearingwear.scene.coefficients import ASSUMED_FRICTION, ASSUMED_WEAR
from bearingwear.scene.distributions import possible_range, quantile, values_at
from bearingwear.scene.scene import WORN, Distribution, Scene
from bearingwear.scene.uncertain import UNCERTAIN_CAGE
from bearingwear.solvers.dynamic.system import CageStart
from bearingwear.studies.sampling import scene_with_values

CLOSE = 0.95
"""Of its clearance: a cage starts anywhere within."""

ASSUMED_CLEARANCE = 0.05
"""Standard deviation of a clearance over itself where the scene has none."""

WEAR, GRAVITY_ANGLE = "wear_coefficient", "gravity_angle_deg"


class CageDraw(NamedTuple):
    """Input of a run; no scene if the sampled values are impossible."""

    scene: Scene | None
    start: CageStart
    values: dict[str, float]  # drawn, by their names


def cage_spread(scene: Scene) -> tuple[dict[str, Distribution], str]:
    """Distributions of the values of a cage, and what they are; empty where they are its own."""
    if scene.cage_uncertainty is not None:
        return dict(scene.cage_uncertainty), ""
    cage = scene.cage
    assert cage is not None
    friction, wear = f"{ASSUMED_FRICTION.factor:.2g}", f"{ASSUMED_WEAR.factor:.2g}"
    names = ["pocket_clearance_mm", "guide_clearance_mm"][: 1 + (cage.guiding_race != "ball")]
    found = {
        name: Distribution(
            distribution="normal", standard_deviation=ASSUMED_CLEARANCE * getattr(cage, name)
        )
        for name in names
    }
    found["cage"] = Distribution(distribution="lognormal", factor=float(friction))
    found[WEAR] = Distribution(distribution="lognormal", factor=float(wear))
    said = (
        f"assumed scatter in the cage parameters: friction by a factor of {friction}, clearances "
        f"by {100.0 * ASSUMED_CLEARANCE:g} %, K_s/H by a factor of {wear}"
    )
    return found, said


def cage_value(scene: Scene, name: str) -> float:
    """A scene's own value of a name of `UNCERTAIN_CAGE`."""
    if name == WEAR:
        return 1.0
    if name == GRAVITY_ANGLE:
        axial, *across = scene.operation.gravity_m_s2
        return math.degrees(math.atan2(math.hypot(*across), abs(axial)))
    return float(getattr(getattr(scene, UNCERTAIN_CAGE[name]), name))


def cage_drawn(
    scene: Scene, spread: Mapping[str, Distribution], plan: Ensemble, run: int
) -> CageDraw:
    """The draw of a run of an ensemble.

    spread: of the new cage, as `cage_spread` has it.
    """
    random = np.random.default_rng([plan.seed, run])
    offset, angle, whirl, about = random.random(4)
    start = CageStart(CLOSE * math.sqrt(offset), 2.0 * math.pi * angle, whirl)
    names = [name for name in scene.uncertainty or {} if name not in WORN]
    of_bearing = values_at(scene, names, random.random((1, len(names))))[0].tolist()
    values = dict(zip(names, of_bearing, strict=True))
    of_cage = {}
    for name, given in spread.items():
        probability = np.array(random.random())
        if name != WEAR:
            own, key = cage_value(scene, name), f"{UNCERTAIN_CAGE[name]}.{name}"
            ends = (0.0, 180.0) if name == GRAVITY_ANGLE else possible_range(key)
            of_cage[name] = float(quantile(given, own, ends, probability))
    changed = scene_with_values(scene, values)
    if changed is not None:
        changed = worn_cage(_with_cage(changed, of_cage, 2.0 * math.pi * about), plan.worn_um)
    return CageDraw(changed, start, values | of_cage)


def _with_cage(scene: Scene, values: Mapping[str, float], about: float) -> Scene:
    """The scene with other values of its cage, gravity at an angle `about` the shaft."""
    parts = {
        block: {name: value for name, value in values.items() if UNCERTAIN_CAGE[name] == block}
        for block in ("friction", "cage")
    }
    changed = {block: replace(getattr(scene, block), **part) for block, part in parts.items()}
    if GRAVITY_ANGLE in values:
        size, angle = math.hypot(*scene.operation.gravity_m_s2), math.radians(values[GRAVITY_ANGLE])
        across = size * math.sin(angle)
        gravity = (size * math.cos(angle), across * math.cos(about), across * math.sin(about))
        changed["operation"] = replace(scene.operation, gravity_m_s2=gravity)
    return replace(scene, **changed)


def worn_cage(scene: Scene, depth_um: Sequence[float]) -> Scene:
    """The scene with depths worn off the walls of its pockets and off its guiding surface [um]."""
    cage = scene.cage
    assert cage is not None
    pocket, guide = (2e-3 * depth for depth in depth_um)
    worn = replace(
        cage,
        pocket_clearance_mm=cage.pocket_clearance_mm + pocket,
        guide_clearance_mm=cage.guide_clearance_mm + guide,
    )
    return replace(scene, cage=worn)
