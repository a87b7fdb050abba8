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
"""Standard deviation of a clearance over its value where the scene has no `cage_uncertainty`."""

WEAR, GRAVITY_ANGLE = "wear_coefficient", "gravity_angle_deg"


class CageDraw(NamedTuple):
    """Input of a run."""

    scene: Scene | None  # with the drawn values; None if they are impossible
    start: CageStart
    values: dict[str, float]  # drawn, by their names [in the units of these]


def cage_spread(scene: Scene) -> tuple[dict[str, Distribution], str]:
    """Returns the distributions of a cage's uncertain values by their names, and a sentence.

    The names are keys of `UNCERTAIN_CAGE`. The sentence states distributions that are assumed; it
    is empty if the scene contains them.

    scene: with a cage.
    """
    if scene.cage_uncertainty is not None:
        return dict(scene.cage_uncertainty), ""
    cage = scene.cage
    assert cage is not None
    # two digits, so that the sentence states the factors that are used
    friction_factor, wear_factor = (
        float(f"{assumed.factor:.2g}") for assumed in (ASSUMED_FRICTION, ASSUMED_WEAR)
    )
    clearances = ["pocket_clearance_mm"]
    if cage.guiding_race != "ball":
        clearances.append("guide_clearance_mm")
    spread = {
        name: Distribution(
            distribution="normal", standard_deviation=ASSUMED_CLEARANCE * getattr(cage, name)
        )
        for name in clearances
    }
    spread["cage"] = Distribution(distribution="lognormal", factor=friction_factor)
    spread[WEAR] = Distribution(distribution="lognormal", factor=wear_factor)
    sentence = (
        f"assumed scatter in the cage parameters: friction by a factor of {friction_factor:.2g}, "
        f"clearances by {100.0 * ASSUMED_CLEARANCE:g} %, K_s/H by a factor of {wear_factor:.2g}"
    )
    return spread, sentence


def cage_value(scene: Scene, name: str) -> float:
    """Returns the nominal value of an uncertain value of the cage, in the unit of its name.

    The angle of gravity counts from the shaft, in either direction: it is 0 to 90 degrees. The wear
    coefficient is relative to that of the scene, and so is 1.

    name: a key of `UNCERTAIN_CAGE`.
    """
    if name == WEAR:
        return 1.0
    if name == GRAVITY_ANGLE:
        axial, *across = scene.operation.gravity_m_s2
        return math.degrees(math.atan2(math.hypot(*across), abs(axial)))
    return float(getattr(getattr(scene, UNCERTAIN_CAGE[name]), name))


def cage_draw(
    scene: Scene, spread: Mapping[str, Distribution], plan: Ensemble, run: int
) -> CageDraw:
    """Returns random input of a run, the same for the same scene, plan, spread and number.

    The cage is worn by `worn_um` of the plan. The wear coefficient is not drawn.

    spread: distributions of the new cage by their names, from `cage_spread`.
    run: number of the run in its ensemble, from 0.
    """
    random = np.random.default_rng([plan.seed, run])
    offset, angle, whirl, gravity_turn = random.random(4)
    # the root makes all places in the circle equally likely
    start = CageStart(CLOSE * math.sqrt(offset), 2.0 * math.pi * angle, whirl)
    names = [name for name in scene.uncertainty or {} if name not in WORN]
    bearing_values = sampled_values(scene, names, random.random((1, len(names))))[0].tolist()
    drawn_values = dict(zip(names, bearing_values, strict=True))
    cage_values = {}
    for name, distribution in spread.items():
        probability = np.array(random.random())
        if name != WEAR:  # which changes no run, but the life computed from its work
            nominal, key = cage_value(scene, name), f"{UNCERTAIN_CAGE[name]}.{name}"
            limits = (0.0, 180.0) if name == GRAVITY_ANGLE else possible_range(key)
            cage_values[name] = float(quantile(distribution, nominal, limits, probability))
    drawn_scene = scene_with_values(scene, drawn_values)
    if drawn_scene is not None:
        drawn_scene = worn_cage(
            _with_cage(drawn_scene, cage_values, 2.0 * math.pi * gravity_turn), plan.worn_um
        )
    return CageDraw(drawn_scene, start, drawn_values | cage_values)


def _with_cage(scene: Scene, values: Mapping[str, float], gravity_turn: float) -> Scene:
    """Returns the scene with other values of its cage, and gravity turned about the shaft.

    values: by their names in `UNCERTAIN_CAGE`, in the units of these names. With an angle, gravity
        points along the shaft (+X) at 0 degrees.
    gravity_turn: angle of gravity about the shaft, from Y towards Z [rad]; used only if the angle
        of gravity to the shaft is among the values.
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
        gravity = (
            size * math.cos(angle),
            across * math.cos(gravity_turn),
            across * math.sin(gravity_turn),
        )
        changed_blocks["operation"] = replace(scene.operation, gravity_m_s2=gravity)
    return replace(scene, **changed_blocks)


def worn_cage(scene: Scene, depth_um: Sequence[float]) -> Scene:
    """Returns the scene with worn pocket walls and a worn guiding surface.

    depth_um: wear depths of the pocket walls and of the guiding surface [um].
    """
    cage = scene.cage
    assert cage is not None
    # a diametral clearance [mm] grows by twice the depth [um]
    pocket_growth_mm, guide_growth_mm = (2e-3 * depth for depth in depth_um)
    worn = replace(
        cage,
        pocket_clearance_mm=cage.pocket_clearance_mm + pocket_growth_mm,
        guide_clearance_mm=cage.guide_clearance_mm + guide_growth_mm,
    )
    return replace(scene, cage=worn)
