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
"""Limits that are not numbers."""

SECOND_ORDER = "2nd order"
"""Size of a change of the preload that a spring compensates."""

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
    note: str = ""  # what the size is a share of, or the key that turns the effect on


def effect_sizes(chosen: Choice) -> Iterator[EffectSize]:
    """Yields every effect of a scene: whether the model has it, its size and its limit."""
    scene, fidelity = chosen.scene, chosen.fidelity
    yield from _force_effects(scene, fidelity)
    yield _slip_effect(scene)
    yield EffectSize(
        name="elastic micro-slip",
        is_on=False,
        size="2 to 5",
        limit=NEVER_ON,
        unit="%",
        note="of QV, which it reduces",
    )
    yield from _growth_effects(scene.sides[0])
    yield _groove_effect(scene, fidelity)
    unequal = " and ".join(asymmetries(scene)) or "radial load, tilt, diameters"
    yield EffectSize(
        name="differences between balls",
        is_on=fidelity != "steady",
        size=UNSIZED,
        limit="if any",
        note=unequal,
    )
    yield EffectSize(
        name="cage", is_on=chosen.cage, size=UNSIZED, limit=IF_ASKED, note="model.cage_results"
    )
    yield EffectSize(
        name="lubricant drag",
        is_on=scene.lubricant.drag_density_kg_m3 > 0.0 and fidelity != "race_control",
        size=UNSIZED,
        limit=IF_GIVEN,
        note="lubricant.drag_density_kg_m3",
    )
    if fidelity == "dynamic":
        yield EffectSize(name="Coriolis force", is_on=False, size=UNSIZED, limit=NEVER_ON)


def _force_effects(scene: Scene, fidelity: str) -> Iterator[EffectSize]:
    """Yields the effects of forces on a ball.

    Neglecting one saves no time: race control alone has no friction balance, and traction is
    neglected only on request.
    """
    load_note, axial_note = "of the contact load at rest", "of a ball's axial load"
    centrifugal = centrifugal_share(scene)
    gyroscopic = 100.0 * gyroscopic_share(scene)
    yield EffectSize(
        name="centrifugal force",
        is_on=True,
        size=100.0 * centrifugal,
        limit=ALWAYS_ON,
        unit="%",
        note=load_note,
    )
    yield EffectSize(
        name="gyroscopic moment",
        is_on=True,
        size=gyroscopic,
        limit=ALWAYS_ON,
        unit="%",
        note=axial_note,
    )
    is_balanced = fidelity != "race_control"
    yield EffectSize(
        name="friction balance of a ball",
        is_on=is_balanced,
        size=UNSIZED,
        limit=ALWAYS_ON,
        note="but for race control",
    )
    model = scene.model
    is_included = model.includes_traction or not is_balanced
    key = "model.normal_balance" if model.normal_balance else "model.contact"
    yield EffectSize(
        name="traction in normal forces",
        is_on=is_included,
        size=gyroscopic,
        limit=ALWAYS_ON if is_included else IF_ASKED,
        unit="%",
        note=axial_note if is_included else f"{axial_note}; {key}",
    )


def _slip_effect(scene: Scene) -> EffectSize:
    """Returns the effect of slip across the ellipse, by its share of spin friction."""
    model = scene.model
    note = "of spin friction"
    is_included = model.slip_region != "line"
    key = "model.slip_over" if model.slip_over else "model.contact"
    return EffectSize(
        name="slip across the ellipse",
        is_on=is_included,
        size=100.0 * spin_across_share(scene),
        limit=ALWAYS_ON if is_included else IF_ASKED,
        unit="%",
        note=note if is_included else f"{note}; {key}",
    )


def _growth_effects(scene: Scene) -> Iterator[EffectSize]:
    """Yields the effects of speed, heat and fits, by their changes of a fixed-position preload."""
    limit = 100.0 * MOST_LEFT_OUT
    is_fixed = is_held(scene)

    def effect(name: str, is_on: bool, change: float, note: str) -> EffectSize:
        """Returns an effect by its relative change of the preload [1]."""
        if not is_fixed:
            return EffectSize(name=name, is_on=is_on, size=SECOND_ORDER, limit=IF_GIVEN, note=note)
        return EffectSize(
            name=name,
            is_on=is_on,
            size=100.0 * change,
            limit=limit,
            unit="%",
            note=f"of preload; {note}",
        )

    at_speed = change_at_speed(scene) if is_fixed else UNSIZED
    yield effect("growth at speed", scene.bearing.bore_mm is not None, at_speed, "bearing.bore_mm")
    by_warmth = change_by_warmth(scene) if is_fixed else UNSIZED
    if scene.temperature is not None or scene.thermal is not None:
        yield effect("temperature", True, by_warmth, "thermal" if scene.thermal else "as given")
    else:
        note = f"inner ring {WARMER:g} K warmer" if is_fixed else "temperature or thermal"
        yield effect("temperature", False, by_warmth, note)
    by_fits = change_by_fits(scene) if is_fixed else UNSIZED
    yield effect("interference fits", has_interference(scene), by_fits, "fits")


def _groove_effect(scene: Scene, fidelity: str) -> EffectSize:
    """Returns the effect of wear of the grooves, by loss over gap, and whether a life models it."""
    share = max(wear_over_gap_estimate(side) for side in scene.sides)
    end, model = scene.wear.end_of_life, scene.model
    is_possible = (
        fidelity == "steady"
        and scene.wear.counts == "ball_and_races"
        and model.contact == "auto"
        and model.slip_region != "line"
    )
    ends_by_depth = end is not None and end.groove_depth_um is not None
    is_on = model.contact == "worn" or (is_possible and (ends_by_depth or share > FLAT_GROOVE))
    return EffectSize(
        name="worn grooves, in a life",
        is_on=is_on,
        size=share,
        limit=FLAT_GROOVE if is_possible or is_on else IF_ASKED,
        note="wear over gap" + ("" if is_possible or is_on else "; model.contact"),
    )


def wear_over_gap_estimate(scene: Scene) -> float:
    """Estimates the loss at the end of life over the gap at the contact's edge [1].

    The contacts are those under the preload at rest, by fitted Hertz factors. The loss is the least
    at which a criterion ends the life, the gap that of the race with the smaller one. NaN if the
    scene does not limit the loss or has no preload.
    """
    g = mounted_geometry(scene)
    end = scene.wear.end_of_life
    operation = scene.operation
    sine, cosine = math.sin(g.alpha0), math.cos(g.alpha0)
    if end is None or not (sine > 0.0 and operation.preload_N > 0.0):
        return math.nan
    Q = operation.preload_N / (g.n_balls * sine)
    gaps = []
    approach = 0.0  # of both contacts [m]
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
