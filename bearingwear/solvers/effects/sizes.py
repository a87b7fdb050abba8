"""The effects on a bearing: whether a model has each, its size before a solve, and its limit."""

import math
from collections.abc import Iterator
from typing import NamedTuple

from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.fitted_hertz import (
    INNER_RACE,
    OUTER_RACE,
    curvatures,
    fitted_factors,
)
from bearingwear.solvers.bearing.growth import is_held
from bearingwear.solvers.bearing.mounted import UM, mounted_geometry
from bearingwear.solvers.effects.choice import Choice, asymmetries
from bearingwear.solvers.effects.growth import (
    MOST_LEFT_OUT,
    WARMER,
    change_at_speed,
    change_by_fits,
    change_by_warmth,
    has_interference,
)
from bearingwear.solvers.effects.motion import (
    centrifugal_share,
    gyroscopic_share,
    spin_across_share,
)
from bearingwear.solvers.effects.table import FLAT_GROOVE

ALWAYS_ON, NEVER_ON, IF_ASKED, IF_GIVEN = "always", "never", "if asked", "if given"
"""Limits that are no numbers."""

SECOND_ORDER = "2nd order"
"""Size of a change of the preload that a spring makes up for."""

UNSIZED = math.nan


class EffectSize(NamedTuple):
    """An effect, whether it is modelled, its estimated size and the limit of the same unit.

    Beyond the limit an effect is modelled, or warned of where the scene lacks what it takes.
    """

    name: str
    is_on: bool
    size: float | str
    limit: float | str
    unit: str = ""
    note: str = ""  # what it is a share of, or the key that turns it on


def effect_sizes(chosen: Choice) -> Iterator[EffectSize]:
    """The effects of a scene and its model."""
    scene, fidelity = chosen.scene, chosen.fidelity
    yield from _forces(scene, fidelity)
    yield _slip(scene)
    yield EffectSize(
        "elastic micro-slip", False, "2 to 5", NEVER_ON, "%", "of QV, which it reduces"
    )
    yield from _growth(scene.sides[0])
    yield _grooves(scene, fidelity)
    unequal = " and ".join(asymmetries(scene)) or "radial load, tilt, diameters"
    yield EffectSize(
        "differences between balls", fidelity != "steady", UNSIZED, "if any", "", unequal
    )
    yield EffectSize("cage", chosen.cage, UNSIZED, IF_ASKED, "", "model.cage_results")
    key = "drag_density_kg_m3"
    drag = getattr(scene.lubricant, key) > 0.0 and fidelity != "race_control"
    yield EffectSize("lubricant drag", drag, UNSIZED, IF_GIVEN, "", f"lubricant.{key}")
    if fidelity == "dynamic":
        yield EffectSize("Coriolis force", False, UNSIZED, NEVER_ON)


def _forces(scene: Scene, fidelity: str) -> Iterator[EffectSize]:
    """Forces on a ball; neglecting one saves no time, so that all but one are always modelled."""
    of_load, of_axial = "of the contact load at rest", "of a ball's axial load"
    centrifugal, gyroscopic = centrifugal_share(scene), 100.0 * gyroscopic_share(scene)
    yield EffectSize("centrifugal force", True, 100.0 * centrifugal, ALWAYS_ON, "%", of_load)
    yield EffectSize("gyroscopic moment", True, gyroscopic, ALWAYS_ON, "%", of_axial)
    balanced = fidelity != "race_control"
    yield EffectSize(
        "friction balance of a ball", balanced, UNSIZED, ALWAYS_ON, "", "but for race control"
    )
    model, name = scene.model, "traction in normal forces"
    if model.traction_bears or not balanced:
        yield EffectSize(name, True, gyroscopic, ALWAYS_ON, "%", of_axial)
    else:
        key = "model.normal_balance" if model.normal_balance else "model.contact"
        yield EffectSize(name, False, gyroscopic, IF_ASKED, "%", f"{of_axial}; {key}")


def _slip(scene: Scene) -> EffectSize:
    model, name = scene.model, "slip across the ellipse"
    share, of_spin = 100.0 * spin_across_share(scene), "of spin friction"
    if model.slip_is_over != "line":
        return EffectSize(name, True, share, ALWAYS_ON, "%", of_spin)
    key = "model.slip_over" if model.slip_over else "model.contact"
    return EffectSize(name, False, share, IF_ASKED, "%", f"{of_spin}; {key}")


def _growth(scene: Scene) -> Iterator[EffectSize]:
    """Growth by speed, heat and fits, each by its change of a preload at fixed position."""
    limit = 100.0 * MOST_LEFT_OUT

    def effect(name: str, is_on: bool, change: float, note: str) -> EffectSize:
        if not is_held(scene):
            return EffectSize(name, is_on, SECOND_ORDER, IF_GIVEN, "", note)
        return EffectSize(name, is_on, 100.0 * change, limit, "%", f"of preload; {note}")

    held = is_held(scene)
    at_speed = change_at_speed(scene) if held else UNSIZED
    yield effect("growth at speed", scene.bearing.bore_mm is not None, at_speed, "bearing.bore_mm")
    warm = change_by_warmth(scene) if held else UNSIZED
    if scene.temperature is not None or scene.thermal is not None:
        yield effect("temperature", True, warm, "thermal" if scene.thermal else "as given")
    else:
        note = f"inner ring {WARMER:g} K warmer" if held else "temperature or thermal"
        yield effect("temperature", False, warm, note)
    fits = change_by_fits(scene) if held else UNSIZED
    yield effect("interference fits", has_interference(scene), fits, "fits")


def _grooves(scene: Scene, fidelity: str) -> EffectSize:
    """Grooves as they wear, which a life follows or not."""
    share = max(wear_over_gap_estimate(side) for side in scene.sides)
    end, model = scene.wear.end_of_life, scene.model
    may = fidelity == "steady" and scene.wear.counts == "ball_and_races"
    may = may and model.contact == "auto" and model.slip_is_over != "line"
    by_depth = end is not None and end.groove_depth_um is not None
    is_on = model.contact == "worn" or (may and (by_depth or share > FLAT_GROOVE))
    return EffectSize(
        "worn grooves, in a life",
        is_on,
        share,
        FLAT_GROOVE if may or is_on else IF_ASKED,
        "",
        "wear over gap" + ("" if may or is_on else "; model.contact"),
    )


def wear_over_gap_estimate(scene: Scene) -> float:
    """Loss at the end of life over the gap at the edge of the contact, by fitted Hertz factors.

    NaN where the scene says nothing of the loss or has no preload.
    """
    g, end, operation = mounted_geometry(scene), scene.wear.end_of_life, scene.operation
    sine, cosine = math.sin(g.alpha0), math.cos(g.alpha0)
    if end is None or not (sine > 0.0 and operation.preload_N > 0.0):
        return math.nan
    Q, gaps, approach = operation.preload_N / (g.n_balls * sine), [], 0.0
    for race in (INNER_RACE, OUTER_RACE):
        K, c_a, _ = fitted_factors(g, race, g.D0, cosine)
        gaps.append(curvatures(g, race, g.D0, cosine)[0] * c_a * c_a * Q ** (2.0 / 3.0))
        approach += (Q / K) ** (2.0 / 3.0)
    losses = []
    if end.ball_diameter_loss_um is not None:
        present = sum(scene.wear.ball_diameter_loss_um) / len(scene.wear.ball_diameter_loss_um)
        losses.append((end.ball_diameter_loss_um - present) * UM)
    if end.preload_fraction is not None and operation.preload_method != "constant_force":
        losses.append((1.0 - end.preload_fraction ** (2.0 / 3.0)) * approach)
    return min(losses) / min(gaps) if losses else math.nan
