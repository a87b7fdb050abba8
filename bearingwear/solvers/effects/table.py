"""The table of effects: included and neglected effects of a solve, and limits of practice.

A row defines the sentences before a solve and the warning after it; `practice` contains the limits
of practice with their sources. No warning is an error. A result stores its warnings in the
attribute `warnings`, which `bearingwear.results.warnings` reads.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.measures import ENDS, plain
from bearingwear.solvers.bearing.mounted import MM, UM
from bearingwear.solvers.dynamic.stability import instability
from bearingwear.solvers.effects import films, growth, motion, practice
from bearingwear.solvers.effects.choice import Choice, unevaluated_criteria
from bearingwear.solvers.effects.criterion import criteria_passed, criterion_met
from bearingwear.solvers.effects.evidence import Evidence, Finding
from bearingwear.solvers.estimates import COULOMB_SLIP, ROUNDED_SLIP

FLAT_GROOVE = 0.1
"""Loss over the gap at the ellipse's edge above which a worn groove's contact is not Hertzian."""

SPEED_ASSUMED = "Speed assumed: {:.12g} r/min."
"""Part of a scene's description while its speed is the one that `new` assumed."""

JUST_MET = math.nextafter(1.0, 2.0)
"""Excess of a criterion that is met exactly; that ends a life too."""


@dataclass(frozen=True)
class Effect:
    """An effect on the bearing, or a limit, with its sentences.

    `size` returns its finding in a state, which completes sentence and advice; None where it does
    not apply. A finding without a value is always a warning, one with a value if it exceeds its
    limit. `impractical` marks designs that cannot be built or run; other warnings concern neglected
    effects or the user's intent. `modelled` writes the sentences before the solve: whether the
    effect is included, and its magnitude.
    """

    id: str
    size: Callable[[Evidence], Finding | None] = lambda evidence: None
    sentence: str = ""
    advice: str = ""
    impractical: bool = False
    modelled: Callable[[Choice], Iterable[str]] = lambda chosen: ()


def _groove_worn(evidence: Evidence) -> Finding | None:
    """Returns the finding of the wear depth, over the gap at the edge of the contact ellipse.

    None if the life follows the depth of the grooves.
    """
    if evidence.life is not None and "groove_depth" in evidence.life:
        return None
    bearing = evidence.scene.bearing
    D = MM * bearing.ball_diameter_mm
    radii = D * np.array([bearing.inner_groove_factor, bearing.outer_groove_factor])
    curvature = 0.5 * (2.0 / D - 1.0 / radii)
    loss = evidence.mean("ball_diameter_loss")
    major = evidence.contacts("semi_major_axis").mean(axis=0)
    value = loss / np.min(curvature * major**2)
    return {"loss": loss / UM, "value": value, "limit": FLAT_GROOVE}


def _slip_rounded(evidence: Evidence) -> Finding | None:
    """Returns the finding of slip so low that the friction law is not Coulomb's.

    Its excess is the regularisation over `ROUNDED_SLIP` of the mean slip. None without slip.
    """
    load = evidence.contacts("contact_load").sum()
    slip = evidence.contacts("qv").sum() / load if load else math.nan
    if not slip > 0.0:
        return None
    v_r = evidence.scene.friction.slip_regularisation_m_s
    lost_share = evidence.state["torque_lost_to_regularisation"]
    torque_words = (
        f", the torque by {plain(100.0 * lost_share)} %" if math.isfinite(lost_share) else ""
    )
    excess, recommended = v_r / (ROUNDED_SLIP * slip), COULOMB_SLIP * slip
    return {"v_r": v_r, "slip": slip, "by": torque_words, "better": recommended, "excess": excess}


def _criterion_not_watched(evidence: Evidence) -> Finding | None:
    """Returns the finding that names criteria the model cannot evaluate; None if there are none."""
    names = [ENDS[name].words for name in unevaluated_criteria(evidence.scene, evidence.chosen)]
    return {"names": ", ".join(names), "fidelity": evidence.chosen.fidelity} if names else None


def _criteria_sentences(chosen: Choice) -> Iterator[str]:
    """Yields a sentence on the end-of-life criteria that a life does not evaluate."""
    unevaluated = unevaluated_criteria(chosen.scene, chosen)
    if chosen.of_life and unevaluated:
        yield f"end-of-life criteria not evaluated: {', '.join(unevaluated)}"


def _speed_assumed(evidence: Evidence) -> Finding | None:
    """Returns the finding of a speed that `bearingwear new` assumed; None if the user gave it."""
    speed = evidence.scene.operation.shaft_speed_rpm
    return {"value": speed} if SPEED_ASSUMED.format(speed) in evidence.scene.description else None


def _over_limit_when_new(evidence: Evidence) -> Finding | None:
    """Returns the finding of a criterion that ends a life at its start; None if none does."""
    if evidence.life is None or len(evidence.life.get("history_ball_diameter_loss", ())) != 1:
        return None
    criterion = criterion_met(evidence.scene, evidence.life, 0)
    if criterion is None:
        return None
    time_words = (
        "when new" if max(evidence.scene.wear.ball_diameter_loss_um) == 0.0 else "from the start"
    )
    excess = max(criterion.excess, JUST_MET)
    return {
        "phrase": criterion.phrase,
        "new": time_words,
        "advice": criterion.measure.advice,
        "excess": excess,
    }


def _nothing_wears(evidence: Evidence) -> Finding | None:
    """Returns an empty finding for a life without end whose races turn alike; else None."""
    operation = evidence.scene.operation
    at_rest = evidence.chosen.of_life and operation.shaft_speed_rpm == operation.outer_speed_rpm
    return {} if at_rest and evidence.state.status == code.CRITERION_NOT_REACHED else None


def _limit_passed(evidence: Evidence) -> Finding | None:
    """Returns the finding of all criteria that a case violates; None if it violates none.

    Advice and excess are those of the most violated one.
    """
    criteria = [] if evidence.case is None else criteria_passed(evidence.scene, evidence.case)
    if not criteria:
        return None
    phrase = ", ".join(criterion.phrase for criterion in criteria)
    return {"phrase": phrase, "advice": criteria[0].measure.advice, "excess": criteria[0].excess}


EFFECTS = (
    Effect(
        "over_limit_when_new",
        _over_limit_when_new,
        "end-of-life criterion met {new}: {phrase}",
        "{advice}",
    ),
    Effect(
        "nothing_wears",
        _nothing_wears,
        "nothing wears, because the races turn at the same speed: no criterion ends the life",
        "set operation.shaft_speed_rpm",
    ),
    Effect(
        "limit_passed",
        _limit_passed,
        "a life calculation would end immediately: {phrase}",
        "{advice}",
    ),
    Effect(
        "criterion_not_watched",
        _criterion_not_watched,
        "the {fidelity} model cannot evaluate the following end-of-life criteria: {names}",
        "use fidelity dynamic, which evaluates all criteria",
    ),
    Effect(
        "tilt_beyond_practice",
        practice.tilt_beyond_practice,
        "the rings are tilted by {value:.3g} mrad ({minutes:.2g} arc minutes); catalogues permit "
        "at most {limit:g} mrad (rule of thumb)",
        "align the seats, or check the unit (mrad)",
        impractical=True,
    ),
    Effect(
        "pressure_above_yield",
        practice.pressure_above_yield,
        "the peak pressure of {value:.3g} GPa is above {limit:.3g} GPa, {source}",
        "to prevent dents in the balls and races, {take}",
        impractical=True,
    ),
    Effect(
        "pressure_above_practice",
        practice.pressure_above_practice,
        "the peak pressure of {value:.3g} GPa is above {limit:.3g} GPa, the usual maximum for a "
        "long life (assumed)",
        "to prevent fatigue, which is not modelled, {take}",
    ),
    Effect(
        "ellipse_over_shoulder",
        practice.ellipse_over_shoulder,
        "the {race} contact ellipse extends {value:.3g} degrees up the groove, beyond "
        "{source} at {limit:.3g} degrees",
        "to prevent edge pressure, which is not modelled, reduce the thrust or use higher "
        "shoulders",
        impractical=True,
    ),
    Effect(
        "speed_beyond_practice",
        practice.speed_beyond_practice,
        "speed times pitch diameter is {value:.3g} million mm r/min, above {limit:g}, the "
        "highest value reached by steel bearings on test rigs",
        "check the speed and its unit (r/min)",
        impractical=True,
    ),
    Effect(
        "speed_beyond_makers",
        practice.speed_beyond_makers,
        "{value:.6g} r/min is above the speed limit for the {bearing} {kind}: {limit:.0f} r/min "
        "with grease, {oil:.0f} r/min with oil ({source})",
        "reduce the speed or the preload, or consult the maker",
    ),
    Effect(
        "hoop_stress",
        practice.hoop_stress,
        "rotation alone causes a hoop stress of {value:.0f} MPa in the inner ring, above {limit:g} "
        "MPa (assumed limit for hardened steel)",
        "reduce the speed, or use a tougher steel",
        impractical=True,
    ),
    Effect(
        "inner_load_lost",
        practice.inner_load_lost,
        "{phrase}",
        "to prevent skidding, increase the preload, reduce the speed or the radial load, or use "
        "ceramic balls",
        impractical=True,
    ),
    Effect(
        "preload_too_small",
        practice.preload_too_small,
        "a preload of {value:.3g} N is negligible for {n} balls with a diameter of {D:g} mm "
        "(assumed minimum: {limit:.2g} N)",
        "check the unit of the preload (N)",
        impractical=True,
    ),
    Effect(
        "preload_below_makers",
        practice.preload_below_makers,
        "the preload at speed, {value:.3g} N, is below {maker}'s minimum for a {bearing} at "
        "{speed:g} r/min: {limit:.3g} N ({rule})",
        "to prevent slip of the balls, increase the preload or reduce the speed, or consult the "
        "maker",
    ),
    Effect(
        "radial_load_large",
        practice.radial_load_large,
        "a radial load of {load:.4g} N is large compared with a preload of {preload:.4g} N: at "
        "rest, {lost:.3g} N is enough to unload the first ball",
        "increase the preload or the contact angle",
    ),
    Effect(
        "preload_grown",
        practice.preload_grown,
        "the fixed-position preload {when}, {value:.3g} N, is {ratio:.2g} times the "
        "initial {preload:.4g} N (rule of thumb: at most three times)",
        "the results account for this increase; a spring would keep the preload constant",
    ),
    Effect(
        "temperature_beyond_practice",
        practice.temperature_beyond_practice,
        "the temperature of the {part} ({name}) is {value:.4g} degC, {side} the limit of {limit:g} "
        "degC (rule of thumb)",
        "use a suitable material; the hardness, wear and friction values apply at room temperature",
        impractical=True,
    ),
    Effect(
        "friction_beyond_practice",
        practice.friction_beyond_practice,
        "a friction coefficient of {value:.3g} is {phrase}",
        "check friction.ball_race",
    ),
    Effect(
        "groove_worn",
        _groove_worn,
        "a wear depth of {loss:.3g} um is {value:.2g} times the gap between ball and groove at "
        "the edge of the contact ellipse (at most {limit:g} in a Hertzian contact)",
        "treat the computed pressure, slip and wear as estimates",
    ),
    Effect("model", modelled=lambda chosen: [f"{chosen.fidelity}: {chosen.why}"]),
    Effect(
        "contact_angle_too_small",
        practice.contact_angle_too_small,
        "a contact angle of {value:.3g} degrees is too small for any real clearance",
        "check the unit: {value:.3g} rad would be {degrees:.3g} degrees",
        impractical=True,
        modelled=practice.angle_sentences,
    ),
    Effect(
        "contact_angle_zero",
        practice.contact_angle_zero,
        "a free contact angle of 0 degrees needs a clearance of exactly 0",
        "give the angle that the clearance leaves (`bearingwear new --clearance` computes it)",
    ),
    Effect(
        "unit_in_doubt",
        practice.unit_in_doubt,
        "{phrase}",
        "check the unit",
        modelled=practice.unit_sentences,
    ),
    Effect("pair", modelled=motion.pair_sentences),
    Effect(
        "film_worn",
        films.film_worn,
        "the film is worn through ({races} race, {share:.0f} % of the track), but the "
        "calculation continues with the film's friction",
        "set friction.film.bare_ball_race, or use film_worn_share as an end-of-life criterion",
        modelled=films.film_sentences,
    ),
    Effect(
        "film_beyond_tests",
        films.film_beyond_tests,
        "a {what} is beyond the tests of its film's wear ({range}), so the wear coefficient of the "
        "nearest test is used",
        "{advice}; give friction.film.wear_table rows for it",
    ),
    Effect(
        "film_too_fast",
        films.film_too_fast,
        "speed times pitch diameter is {value:.3g} million mm r/min, above {limit:g}, ten times "
        "that of the one published test of a sputtered film in a bearing",
        "expect a life of hours and slip of the balls; reduce the speed, or check it",
    ),
    Effect("balls", modelled=motion.ball_sentences),
    Effect(
        "growth_left_out",
        growth.growth_left_out,
        "growth of the inner ring at speed is neglected: with a bore of {bore:.3g} mm (assumed), "
        "it would change the preload ({held}) by {newtons:+.3g} N ({value:+.0f} %)",
        "set bearing.bore_mm",
        modelled=growth.speed_growth_sentences,
    ),
    Effect(
        "temperature_left_out",
        growth.temperature_left_out,
        "temperature is neglected: an inner ring {kelvin:g} K warmer than the rest of the bearing "
        "would change the preload set at rest ({held}) by {newtons:+.3g} N ({value:+.0f} %)",
        "set temperature.inner_ring_C, balls_C and outer_ring_C in the scene file",
        modelled=growth.temperature_sentences,
    ),
    Effect(
        "thermal_margin_low",
        growth.thermal_margin_low,
        "the thermal margin is {value:.3g}: a little more heat or less cooling makes the "
        "temperatures run away",
        "cool better, reduce the preload or the speed, or use a spring",
    ),
    Effect(
        "fit_left_out",
        growth.fit_left_out,
        "no interference fit is included in the preload ({held}), {sizes}",
        "set fits.shaft_interference_um",
    ),
    Effect(
        "fit_lost",
        growth.fit_lost,
        "the ring is loose on its seat ({seats}): heat and speed have eliminated the interference",
        "increase the interference, or reduce the speed",
        impractical=True,
        modelled=growth.fit_sentences,
    ),
    Effect(
        "cage_weightless",
        lambda evidence: (
            {} if evidence.chosen.cage and not any(evidence.scene.operation.gravity_m_s2) else None
        ),
        "gravity is not specified; it may alter the motion of the cage and change pocket and land "
        "wear by a factor of ten or more",
        "set operation.gravity_m_s2 (for a horizontal shaft: [0, 0, -9.81])",
        modelled=motion.cage_sentences,
    ),
    Effect(
        "motion_unstable",
        lambda evidence: instability(evidence.scene, evidence.state.values),
        "the periodic motion is unstable: {phrase}",
        "{advice}",
        modelled=motion.solution_sentences,
    ),
    Effect(
        "slip_rounded",
        _slip_rounded,
        "friction is regularised at slip speeds below {v_r:g} m/s, but the mean slip speed is only "
        "{slip:.2g} m/s: the computed friction torque and power are too low{by}",
        "set friction.slip_regularisation_m_s to {better:.0e} or less",
        modelled=motion.slip_sentences,
    ),
    Effect("traction", modelled=motion.traction_sentences),
    Effect("criteria", modelled=_criteria_sentences),
    Effect("grooves", modelled=lambda chosen: [chosen.grooves] if chosen.grooves else []),
    Effect(
        "speed_assumed",
        _speed_assumed,
        "the speed of {value:.6g} r/min was assumed by `bearingwear new`",
        "set operation.shaft_speed_rpm",
    ),
)
"""The table: sentences before a solve in this order, and warnings by importance."""

WARNINGS = tuple(effect for effect in EFFECTS if effect.sentence)
"""The warnings that a result may contain."""
