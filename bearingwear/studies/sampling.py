"""Sampling of uncertain values in studies, and scenes with sampled values in place."""

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
        """Raises a SceneError if the number of samples is no power of two."""
        if self.samples & (self.samples - 1):
            raise SceneError("samples", f"got {self.samples}, expected a power of two, such as 128")


def sampling_of(samples: int, seed: int) -> Sampling:
    """Returns the checked sample size and seed of the options `--samples` and `--seed`.

    SceneError: one line that names the option.
    """
    try:
        return record(Sampling, {"samples": samples, "seed": seed})
    except SceneError as error:
        raise SceneError(f"--{error.key}", error.problem, source="") from None


DIAMETER = "ball_diameter_mm"
"""Key of `UNCERTAIN` that changes more than itself; see `with_balls`."""


def scene_with_values(scene: Scene, values: Mapping[str, float]) -> Scene | None:
    """Returns the scene with other values under keys of `UNCERTAIN`, also in its cases.

    The groove factors and contact angle of the scene apply to nominal balls. Another ball diameter
    changes only the balls, like a batch out of tolerance: grooves and their centres keep their
    places (theory.md Eq. 54).

    values: in the units of the keys. A wear coefficient or a hardness is that of the races; those
        of the balls and of films change in proportion.

    Returns None where the balls become too large for the play between the grooves.
    """
    changed = _changed_blocks(scene, values)
    ratios = {name: values[name] / scene.nominal(name) for name in WORN if name in values}
    if ratios:
        factors = {
            "wear_coefficient": ratios.get("wear_coefficient", 1.0)
            * ratios.get("wear_scatter", 1.0),
            "brinell_hardness_GPa": ratios.get("brinell_hardness_GPa", 1.0),
        }
        worn_scene = with_wear(replace(scene, **changed), factors)
        changed |= {"materials": worn_scene.materials, "friction": worn_scene.friction}
    if DIAMETER in values:
        bearing = with_balls(changed.get("bearing", scene.bearing), values[DIAMETER])
        if bearing is None:
            return None
        changed["bearing"] = bearing
    if scene.cases:
        changed["cases"] = _scaled_cases(scene, values)
    return replace(scene, **changed)


def _changed_blocks(scene: Scene, values: Mapping[str, float]) -> dict[str, Any]:
    """Returns the blocks of a scene that have new values, by name.

    values: by keys of `UNCERTAIN`; wear coefficients, hardness and ball diameter are ignored.
    """
    new_values: dict[str, dict[str, Any]] = {}
    for name, value in values.items():
        if name in WORN or name == DIAMETER:
            continue
        block, _, inner_block = UNCERTAIN[name].partition(".")
        block_values = new_values.setdefault(block, {})
        if inner_block:
            # which another value may have changed already
            inner = block_values.get(inner_block, getattr(getattr(scene, block), inner_block))
            block_values[inner_block] = replace(inner, **{name: value})
        else:
            block_values[name] = value
    return {block: replace(getattr(scene, block), **new) for block, new in new_values.items()}


def _scaled_cases(scene: Scene, values: Mapping[str, float]) -> dict[str, dict[str, Any]]:
    """Returns the cases of a scene, with the values that they set scaled like those of the scene.

    values: new values of the scene by key of `UNCERTAIN`. Wear coefficients and hardness stay;
        `with_wear` and `wear_factor` apply them.
    """
    assert scene.cases is not None
    ratios = {
        f"{UNCERTAIN[name]}.{name}": value / scene.nominal(name)
        for name, value in values.items()
        if name not in WORN and name != DIAMETER and scene.nominal(name)
    }
    return {
        case: {
            key: value * ratios[key] if key in ratios and value else value  # None and 0 stay
            for key, value in changes.items()
        }
        for case, changes in scene.cases.items()
    }


def wear_factor(scene: Scene, names: Sequence[str], values: np.ndarray) -> np.ndarray:
    """Returns the factors (n,) by which other wear coefficients and hardness change a life.

    Life is proportional to hardness over wear coefficient (Archard).

    names: keys of `WORN`.
    values: (n, len(names)) in the units of the keys, which replace those of the scene.
    """
    factor = np.ones(len(values))
    for k, name in enumerate(names):
        ratio = values[:, k] / scene.nominal(name)
        factor = factor * (ratio if name == "brinell_hardness_GPa" else 1.0 / ratio)
    return factor


def with_wear(scene: Scene, factors: Mapping[str, float]) -> Scene:
    """Returns the scene with scaled wear coefficients or hardness of balls, races and films.

    factors: by the names of the fields, `wear_coefficient` and `brinell_hardness_GPa`.
    """
    materials = dict(scene.materials)
    for name in {scene.bearing.ball_material, scene.bearing.race_material}:
        materials[name] = _with_scaled_fields(materials[name], factors)
    friction = scene.friction
    if friction.film is not None:
        friction = replace(friction, film=_with_scaled_fields(friction.film, factors))
    return replace(scene, materials=materials, friction=friction)


def _with_scaled_fields(part: Any, factors: Mapping[str, float]) -> Any:
    """Returns a material or a film with scaled values, also in its film and running-in.

    part: material, film or running-in. A field that it lacks or that is None stays so.
    factors: by the names of fields.
    """
    changed = {
        name: getattr(part, name) * factor
        for name, factor in factors.items()
        if getattr(part, name, None) is not None
    }
    for name in ("film", "running_in"):
        inner_part = getattr(part, name, None)
        if inner_part is not None:
            changed[name] = _with_scaled_fields(inner_part, factors)
    return replace(part, **changed)


def with_balls(bearing: Bearing, ball_diameter_mm: float) -> Bearing | None:
    """Returns the bearing with other balls between the same grooves.

    The grooves keep their radii and their places. Contact angle, pitch diameter and groove factors
    of the bearing follow.

    Returns None where the balls are too large for the play between the grooves, or for the radius
    of a groove.
    """
    # r_i, r_o: radii of the grooves; cosine: of the new free contact angle
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
