"""Warnings beside a result: solved, but beyond what bearings withstand or the model covers.

`CAUTIONS` is the one table: the value, its limit, the sentence and the advice. Each limit has a
source or is called assumed. No warning is an error. A result has its warnings in the attribute
`warnings`, which `bearingwear.results.warnings` reads.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from bearingwear.measures import ENDS
from bearingwear.model.criterion import criteria_passed, criterion_met, value_along
from bearingwear.model.evidence import INNER_SIDE, OUTER_SIDE, Evidence
from bearingwear.model.fidelity import unwatched
from bearingwear.model.films_told import film_worn
from bearingwear.model.growth_told import fit_lost, growth_left_out, temperature_left_out
from bearingwear.model.stability import unstable_told
from bearingwear.scene.catalogue import MAKERS, entry_of_bearing

STEEL_YIELD = 4.2
"""Contact pressure [GPa] that dents hardened steel by 1e-4 of the ball diameter: ISO 76."""

LONG_LIVED = 2.0 / STEEL_YIELD
"""Share of the yield pressure up to which a long life is usual: 2 GPa for steel."""

SHOULDER_DEG, SHOULDER_ROOM_DEG = 55.0, 15.0
"""Assumed angle of an unknown shoulder, and its least margin over the contact angle."""

FASTEST = 4.0
"""Speed times pitch diameter [million mm r/min] of the fastest steel bearings on rigs: bore times
speed of 3 million, Bamberger, Zaretsky and Signer, J. Lubr. Technol. 98 (1976) 580."""

HOOP_MPA = 200.0
"""Hoop stress [MPa] beyond which a crack runs through a hardened ring, assumed."""

LIGHTEST_INNER = 0.05
"""Least load of an inner contact over its outer one, assumed: below it the shaft hardly drives a
ball."""

LONGEST_LIFTED = 0.05
"""Share of time off the inner race that knocks of the cage explain, assumed."""

LEAST_PRELOAD = 1.5e-3
"""Preload over ball count and diameter squared [N/mm2]: about 0.2 GPa at rest in steel, assumed."""

FLAT_GROOVE = 0.1
"""Loss over the gap at the ellipse's edge above which a worn groove's contact is not Hertzian."""

ROUNDED_SLIP = 0.25
"""Slip below which friction is rounded, over the balls' mean slip. Above this ratio the rounding
takes a few per cent off the friction torque (docs/warnings.md)."""

SPEED_ASSUMED = "Speed assumed: {:.12g} r/min."
"""Part of a scene's description while its speed is the one that `new` assumed."""

JUST_MET = math.nextafter(1.0, 2.0)
"""Excess of a criterion that is met exactly; that ends a life too."""

_GPA, _MPA, _UM, _MM = 1e9, 1e6, 1e-6, 1e-3

Finding = tuple[float | None, Mapping[str, Any]]
"""The value over its limit (None for a fact), and what fills the sentence."""


@dataclass(frozen=True)
class Caution:
    """A warning: its id, what it looks at, its sentence, and what to do.

    `look` returns None where the warning does not apply. A fact is always warned of, a value beyond
    its limit. `impractical` says that nobody would build or run such a bearing; the others speak of
    what the model leaves out, or of what the user may want.
    """

    id: str
    look: Callable[[Evidence], Finding | None]
    sentence: str
    advice: str
    impractical: bool = False


def _yield_pressure(e: Evidence) -> tuple[float, str]:
    """Yield pressure of the weaker of balls and races [GPa], and its source."""
    b = e.scene.bearing
    known = []
    for name in (b.race_material, b.ball_material):
        given = e.scene.materials[name].yield_pressure_GPa
        source = "the scene's" if given else "assumed as ISO 76 has it for steel"
        known.append((given or STEEL_YIELD, f"the yield pressure of {name} ({source})"))
    return min(known, key=lambda one: one[0])


def _yield(e: Evidence) -> Finding:
    limit, source = _yield_pressure(e)
    value = e.pressure / _GPA
    return value / limit, {"value": value, "limit": limit, "source": source}


def _practice(e: Evidence) -> Finding | None:
    limit, _ = _yield_pressure(e)
    value = e.pressure / _GPA
    if value > limit:  # another warning says so
        return None
    return value / (LONG_LIVED * limit), {"value": value, "limit": LONG_LIVED * limit}


def _shoulder(e: Evidence) -> Finding:
    """The edge of the ellipse that comes closest to its shoulder, as angles from the bottom."""
    b = e.scene.bearing
    D, cosine = b.ball_diameter_mm, math.cos(math.radians(b.contact_angle_deg))
    found = []
    for race, side, factor, shoulder in (
        (INNER_SIDE, -1.0, b.inner_groove_factor, b.inner_shoulder_mm),
        (OUTER_SIDE, 1.0, b.outer_groove_factor, b.outer_shoulder_mm),
    ):
        r = factor * D
        edges = np.degrees(e.angle[:, race] + e.major[:, race] / (r * _MM))
        edges = np.where(e.load[:, race] > 0.0, edges, -np.inf)  # not where a ball is lifted off
        limit = max(SHOULDER_DEG, b.contact_angle_deg + SHOULDER_ROOM_DEG)
        source = "where a shoulder is assumed"
        if shoulder is not None:
            centre = 0.5 * b.pitch_diameter_mm - side * (factor - 0.5) * D * cosine
            rise = side * (0.5 * shoulder - centre) / r
            limit, source = math.degrees(math.acos(min(max(rise, -1.0), 1.0))), "its shoulder"
        words = {"value": edges.max(), "limit": limit, "source": source}
        found.append((edges.max() / limit, words | {"race": ("inner", "outer")[race]}))
    return max(found, key=lambda one: one[0])


def _speed(e: Evidence) -> Finding:
    o = e.scene.operation
    relative = abs(o.shaft_speed_rpm - o.outer_speed_rpm)
    value = 1e-6 * relative * e.scene.bearing.pitch_diameter_mm
    return value / FASTEST, {"value": value, "limit": FASTEST}


def _makers_speed(e: Evidence) -> Finding | None:
    """Of one under a light spring, or of a rigid pair by its preload; a starved bearing has no
    oil that cools it, so the limit with grease counts."""
    entry = entry_of_bearing(asdict(e.scene.bearing))
    if entry is None:
        return None
    o = e.scene.operation
    factor, name = entry.speed_factor(o.preload_method, o.preload_N)
    limit, value = factor * entry.speed_grease, abs(o.shaft_speed_rpm - o.outer_speed_rpm)
    kind = f"a rigid pair of class {name}" if name else "one under a light spring"
    return value / limit, {
        "value": value,
        "limit": limit,
        "oil": factor * entry.speed_oil,
        "bearing": f"{entry.maker} {entry.designation}",
        "kind": kind,
        "source": MAKERS[entry.maker].source,
    }


def _hoop(e: Evidence) -> Finding | None:
    """Hoop stress at the bore of a rotating annulus, out to the shoulder or the groove's bottom."""
    b = e.scene.bearing
    if b.bore_mm is None:
        return None
    steel = e.scene.materials[b.race_material]
    inside = 0.5 * _MM * b.bore_mm
    bottom = b.pitch_diameter_mm - b.ball_diameter_mm
    outside = 0.5 * _MM * (b.inner_shoulder_mm or bottom)
    nu, omega = steel.poisson_ratio, math.pi / 30.0 * e.scene.operation.shaft_speed_rpm
    squares = (3.0 + nu) * outside**2 + (1.0 - nu) * inside**2
    value = 0.25 * steel.density_kg_m3 * omega**2 * squares / _MPA
    return value / HOOP_MPA, {"value": value, "limit": HOOP_MPA}


def _inner(e: Evidence) -> Finding | None:
    if e.scene.operation.shaft_speed_rpm == e.scene.operation.outer_speed_rpm == 0.0:
        return None  # nothing skids
    share = np.min(e.load[:, INNER_SIDE] / e.load[:, OUTER_SIDE])
    if e.lifted > LONGEST_LIFTED:
        said = f"a ball is off the inner race {e.lifted:.2g} of the time, above {LONGEST_LIFTED:g}"
        return e.lifted / LONGEST_LIFTED, {"said": said}
    said = f"a ball's inner load is {share:.2g} of its outer one, below {LIGHTEST_INNER:g}"
    return LIGHTEST_INNER / share, {"said": said}


def _preload(e: Evidence) -> Finding | None:
    b, preload = e.scene.bearing, e.scene.operation.preload_N
    if not preload:
        return None
    limit = LEAST_PRELOAD * b.ball_count * b.ball_diameter_mm**2
    words = {"value": preload, "limit": limit, "n": b.ball_count, "D": b.ball_diameter_mm}
    return limit / preload, words


def _groove(e: Evidence) -> Finding | None:
    if e.life is not None and "groove_depth" in e.life:
        return None  # it was followed
    b = e.scene.bearing
    radii = _MM * b.ball_diameter_mm * np.array([b.inner_groove_factor, b.outer_groove_factor])
    curvature = 0.5 * (2.0 / (_MM * b.ball_diameter_mm) - 1.0 / radii)
    value = e.loss / np.min(curvature * e.major.mean(axis=0) ** 2)
    words = {"loss": e.loss / _UM, "value": value, "limit": FLAT_GROOVE}
    return value / FLAT_GROOVE, words


def _rounded(e: Evidence) -> Finding | None:
    """Whether the balls slip so slowly that the friction law is not yet Coulomb's."""
    if not e.slip > 0.0:
        return None
    v_r = e.scene.friction.slip_regularisation_m_s
    by = f", by about {100.0 * e.torque_error:.2g} %" if e.torque_error < 1.0 else ""
    words = {"v_r": v_r, "slip": e.slip, "by": by, "better": 0.01 * e.slip}
    return v_r / (ROUNDED_SLIP * e.slip), words


def _unwatched(e: Evidence) -> Finding | None:
    names = [ENDS[name].words for name in unwatched(e.scene, e.chosen)]
    return (None, {"names": ", ".join(names), "fidelity": e.chosen.fidelity}) if names else None


def _assumed(e: Evidence) -> Finding | None:
    speed = e.scene.operation.shaft_speed_rpm
    told = SPEED_ASSUMED.format(speed) in e.scene.description
    return (None, {"value": speed}) if told else None


def _weightless(e: Evidence) -> Finding | None:
    return None if not e.chosen.cage or any(e.scene.operation.gravity_m_s2) else (None, {})


def _when_new(e: Evidence) -> Finding | None:
    """The criterion that ends a life at its start."""
    if e.life is None or len(e.life.get("history_ball_diameter_loss", ())) != 1:
        return None
    met = criterion_met(e.scene, e.life)
    if met is None:
        return None
    measure, limit = met
    value = value_along(measure, e.life, 0, e.scene)
    new = "when new" if max(e.scene.wear.ball_diameter_loss_um) == 0.0 else "from the start"
    excess = max(measure.excess(value, limit), JUST_MET)
    return excess, {"said": measure.passed(value, limit), "new": new, "advice": measure.advice}


def _limit_passed(e: Evidence) -> Finding | None:
    """The criteria that a case is beyond, the one that is passed by most first."""
    found = [] if e.case is None else criteria_passed(e.scene, e.case)
    if not found:
        return None
    said = ", ".join(measure.passed(value, limit) for measure, value, limit in found)
    return found[0][0].excess(*found[0][1:]), {"said": said, "advice": found[0][0].advice}


CAUTIONS = (
    Caution(
        "over_limit_when_new",
        _when_new,
        "over the limit {new}: {said}",
        "{advice}",
    ),
    Caution(
        "limit_passed",
        _limit_passed,
        "a life would end at once: {said}",
        "{advice}",
    ),
    Caution(
        "criterion_not_watched",
        _unwatched,
        "the model {fidelity} does not watch the end of life by {names}",
        "fidelity dynamic watches all",
    ),
    Caution(
        "pressure_above_yield",
        _yield,
        "the peak pressure of {value:.3g} GPa is above {limit:.3g} GPa, {source}",
        "balls and races dent: take less load or speed, or larger balls",
        impractical=True,
    ),
    Caution(
        "pressure_above_practice",
        _practice,
        "the peak pressure of {value:.3g} GPa is above {limit:.3g} GPa, usual for a long life "
        "(assumed)",
        "fatigue is not modelled: take less load or speed, or larger balls",
    ),
    Caution(
        "ellipse_over_shoulder",
        _shoulder,
        "the {race} contact ellipse reaches {value:.3g} degrees up its groove, past {limit:.3g}, "
        "{source}",
        "pressure at the edge is not modelled: take less thrust, or higher shoulders",
        impractical=True,
    ),
    Caution(
        "speed_beyond_practice",
        _speed,
        "speed times pitch diameter is {value:.3g} million mm r/min, above {limit:g}, the most "
        "that steel bearings reached on rigs",
        "check the speed and its unit, r/min",
        impractical=True,
    ),
    Caution(
        "speed_beyond_makers",
        _makers_speed,
        "{value:.6g} r/min is above the limit for {kind} of {bearing}: {limit:.0f} with grease, "
        "{oil:.0f} with oil ({source})",
        "take less speed or preload, or ask the maker",
    ),
    Caution(
        "hoop_stress",
        _hoop,
        "rotation alone stresses the inner ring to {value:.0f} MPa, above {limit:g} MPa (assumed "
        "for hardened steel)",
        "take less speed, or a ring of tough steel",
        impractical=True,
    ),
    Caution(
        "inner_load_lost",
        _inner,
        "{said} (assumed)",
        "it may skid: take more preload, less speed or radial load, or ceramic balls",
        impractical=True,
    ),
    Caution(
        "preload_too_small",
        _preload,
        "a preload of {value:.3g} N is next to nothing for {n} balls of {D:g} mm: below "
        "{limit:.2g} N (assumed)",
        "check its unit, newtons",
        impractical=True,
    ),
    Caution(
        "groove_worn",
        _groove,
        "a loss of {loss:.3g} um is {value:.2g} times the gap between ball and groove at the edge "
        "of the ellipse; above {limit:g} the contact is no longer Hertzian",
        "pressure, slip and wear are estimates",
    ),
    Caution(
        "film_worn",
        lambda e: film_worn(e.scene, e.life),
        "the film is worn through ({races} race, {share:.0f} % of the track), and the life "
        "goes on with the film's friction",
        "set friction.film.bare_ball_race, or end the life by film_worn_share",
    ),
    Caution(
        "growth_left_out",
        lambda e: growth_left_out(e.scene),
        "growth of the inner ring at speed is left out: with a bore of {bore:.3g} mm (assumed) it "
        "would change the preload of the fixed position by about {value:+.0f} %",
        "set bearing.bore_mm",
    ),
    Caution(
        "temperature_left_out",
        lambda e: temperature_left_out(e.scene),
        "temperature is left out: an inner ring {kelvin:g} K warmer than the rest would change the "
        "preload of the fixed position by about {value:+.0f} %",
        "set temperature or thermal",
    ),
    Caution(
        "fit_lost",
        lambda e: fit_lost(e.scene),
        "the ring is loose on its seat ({seats}): heat and speed have used up the interference",
        "take more interference, or less speed",
        impractical=True,
    ),
    Caution(
        "cage_weightless",
        _weightless,
        "the cage has no weight: gravity may change its motion, and the wear of pockets and land "
        "tenfold or more",
        "set operation.gravity_m_s2, [0, 0, -9.81] for a horizontal shaft",
    ),
    Caution(
        "motion_unstable",
        lambda e: unstable_told(e.scene, e.growth),
        "the periodic motion does not last: {said}",
        "{advice}",
    ),
    Caution(
        "slip_rounded",
        _rounded,
        "friction is rounded below a slip of {v_r:g} m/s, and the balls slip at {slip:.2g} m/s on "
        "average: friction torque and power come out too small{by}",
        "set friction.slip_regularisation_m_s to {better:.0e} or less",
    ),
    Caution(
        "speed_assumed",
        _assumed,
        "the speed of {value:.6g} r/min is assumed by `bearingwear new`",
        "set operation.shaft_speed_rpm",
    ),
)
"""The table; the warnings that decide a result come first."""
