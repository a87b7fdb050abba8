"""How studies sample uncertain values, and a scene with such values in place."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bearingwear.scene.checking.check import record
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import keyed, setting
from bearingwear.scene.scene import UNCERTAIN, WORN, Bearing, Scene


def usable_cores() -> int:
    """Returns the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


SAMPLES = 128
"""Default number of sampled bearings for quantiles."""

INDEX_SAMPLES = 256
"""Default number of base samples for Sobol indices."""


@keyed
class Sampling:
    """Size and seed of a sample."""

    samples: int = setting(
        "Number of bearings sampled, a power of two", within="[1, 1048576]", default=SAMPLES
    )
    seed: int = setting("Random seed for the sequence", within="[0, inf)", default=1)

    def __post_init__(self) -> None:
        if self.samples & (self.samples - 1):
            raise SceneError("samples", f"got {self.samples}, expected a power of two, such as 128")


def sampling_of(samples: int, seed: int) -> Sampling:
    """Checks sample size and seed given as options. Raises SceneError."""
    try:
        return record(Sampling, {"samples": samples, "seed": seed})
    except SceneError as error:
        raise SceneError(f"--{error.key}", error.problem, source="") from None


DIAMETER = "ball_diameter_mm"


def scene_with_values(scene: Scene, values: Mapping[str, float]) -> Scene | None:
    """Returns the scene with other values under keys of `UNCERTAIN`.

    Groove factors and contact angle are those of nominal balls. A ball diameter then changes only
    the balls, like a batch out of tolerance: grooves and their centres keep their places
    (theory.md Eq. 54).

    values: in the units of the keys. A wear coefficient or a hardness is that of the races; those
        of the balls and of films change in proportion.

    Returns None where the balls become too large for the play between the grooves.
    """
    blocks: dict[str, dict[str, Any]] = {}
    for name, value in values.items():
        if name not in WORN and name != DIAMETER:
            block, _, inner_block = UNCERTAIN[name].partition(".")
            if inner_block:
                new_block = replace(getattr(getattr(scene, block), inner_block), **{name: value})
                blocks.setdefault(block, {})[inner_block] = new_block
            else:
                blocks.setdefault(block, {})[name] = value
    changed = {block: replace(getattr(scene, block), **new) for block, new in blocks.items()}
    ratios = {name: values[name] / scene.nominal(name) for name in WORN if name in values}
    if ratios:
        K_s = ratios.get("wear_coefficient", 1.0) * ratios.get("wear_scatter", 1.0)
        worn_scene = with_wear(
            replace(scene, **changed),
            {"wear_coefficient": K_s, "brinell_hardness_GPa": ratios.get(WORN[0], 1.0)},
        )
        changed |= {"materials": worn_scene.materials, "friction": worn_scene.friction}
    if DIAMETER in values:
        bearing = with_balls(changed.get("bearing", scene.bearing), values[DIAMETER])
        if bearing is None:
            return None
        changed["bearing"] = bearing
    if scene.cases:
        changed["cases"] = _cases_with(scene, values)
    return replace(scene, **changed)


def _cases_with(scene: Scene, values: Mapping[str, float]) -> dict[str, dict[str, Any]]:
    """Returns the cases of a scene with other values; those that a case gives change in proportion.

    Wear coefficients and hardness stay; `with_wear` and `wear_factor` apply them.
    """
    assert scene.cases is not None
    ratios = {
        f"{UNCERTAIN[name]}.{name}": value / nominal
        for name, value in values.items()
        if name not in WORN and name != DIAMETER and (nominal := scene.nominal(name))
    }
    return {
        case: {
            key: value * ratios[key] if key in ratios and value else value
            for key, value in changes.items()
        }
        for case, changes in scene.cases.items()
    }


def wear_factor(scene: Scene, names: Sequence[str], values: np.ndarray) -> np.ndarray:
    """Returns the factor (n,) on lives by values (n, names) of K_s and H instead of the scene's."""
    factor = np.ones(len(values))
    for k, name in enumerate(names):
        ratio = values[:, k] / scene.nominal(name)
        factor = factor * (ratio if name == "brinell_hardness_GPa" else 1.0 / ratio)
    return factor


def with_wear(scene: Scene, factors: Mapping[str, float]) -> Scene:
    """Multiplies wear coefficients or hardness of balls, races and films by factors."""

    def scaled(part: Any) -> Any:
        """Returns a material or a film with scaled values, also in its film and running-in."""
        values = {name: getattr(part, name, None) for name in (*factors, "film", "running_in")}
        scaled_values = {
            name: scaled(old_value) if name not in factors else old_value * factors[name]
            for name, old_value in values.items()
            if old_value is not None
        }
        return replace(part, **scaled_values)

    pair = {scene.bearing.ball_material, scene.bearing.race_material}
    materials = {n: scaled(m) if n in pair else m for n, m in scene.materials.items()}
    film = scene.friction.film
    friction = scene.friction if film is None else replace(scene.friction, film=scaled(film))
    return replace(scene, materials=materials, friction=friction)


def with_balls(bearing: Bearing, ball_diameter_mm: float) -> Bearing | None:
    """Returns the bearing with other balls between the same grooves; None if they have no play."""
    D, D0 = ball_diameter_mm, bearing.ball_diameter_mm
    r_i, r_o = bearing.inner_groove_factor * D0, bearing.outer_groove_factor * D0
    cos_a0 = math.cos(math.radians(bearing.contact_angle_deg))
    cosine = (r_i + r_o - D0) * cos_a0 / (r_i + r_o - D)
    if not 0.0 < cosine <= 1.0 or min(r_i, r_o) <= 0.5 * D:
        return None
    # the outer groove's centre stays at R_o = dm/2 - (r_o - D/2) cos a0
    shift = 2.0 * ((r_o - 0.5 * D) * cosine - (r_o - 0.5 * D0) * cos_a0)
    return replace(
        bearing,
        ball_diameter_mm=D,
        pitch_diameter_mm=bearing.pitch_diameter_mm + shift,
        contact_angle_deg=math.degrees(math.acos(cosine)),
        inner_groove_factor=r_i / D,
        outer_groove_factor=r_o / D,
    )
