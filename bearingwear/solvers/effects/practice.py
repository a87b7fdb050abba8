"""Limits of practice, and findings of bearings beyond them.

Each limit has a source or is called assumed, or a rule of thumb. The sentences stand in `table`.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from bearingwear.measures import plain
from bearingwear.scene.new.catalogue import MAKERS, entry_of_bearing
from bearingwear.scene.new.minimum_preload import minimum_preload
from bearingwear.scene.scene import Bearing, Scene
from bearingwear.solvers.bearing.films import MPA
from bearingwear.solvers.bearing.mounted import GPA, MM, RPM, STEEL_YIELD, yield_pressure
from bearingwear.solvers.effects.choice import Choice
from bearingwear.solvers.effects.evidence import INNER_SIDE, OUTER_SIDE, Evidence, Finding

LONG_LIVED = 2.0 / STEEL_YIELD
"""Share of the yield pressure up to which a long life is usual: 2 GPa for steel."""

SHOULDER_DEG, SHOULDER_ROOM_DEG = 55.0, 15.0
"""Assumed angle of an unknown shoulder, and its least margin over the contact angle."""

FASTEST = 4.0
"""Speed times pitch diameter [million mm r/min] of the fastest steel bearings on rigs: bore times
speed of 3 million, Bamberger, Zaretsky and Signer, J. Lubr. Technol. 98 (1976) 580."""

HOOP_MPA = 200.0
"""Hoop stress [MPa] beyond which a crack runs through a hardened ring, assumed."""

LIGHTEST_INNER = 0.1
"""Least load of an inner contact over its outer one, a rule of thumb: below it the shaft hardly
drives a ball."""

LONGEST_LIFTED = 0.05
"""Share of time off the inner race that impacts of the cage may explain, assumed."""

LEAST_PRELOAD = 1.5e-3
"""Preload over ball count and diameter squared [N/mm2]: about 0.2 GPa at rest in steel, assumed."""

USUAL_FRICTION = (1e-3, 1.0)
"""Friction coefficients in practice: superlubric MoS2 in ultra-high vacuum (Martin and others,
Phys. Rev. B 48 (1993) 10583); clean metals, which seize (Bowden and Tabor 1950)."""

WARMEST_STEEL, COLDEST = 200.0, -150.0
"""Temperatures [degC] of bearing steel, a rule of thumb: hardened steel softens and grows beyond
200 (makers' class S1). Below -150 bearings run in cryogenic fluids alone, of steels like 440C."""

WARMEST_POLYMER, POLYMER_GPA = 120.0, 30.0
"""Highest temperature of a cage of phenolic resin and fabric [degC], by makers' catalogues; Young's
modulus below which a cage counts as a polymer."""

CERAMIC_DENSITY = 6000.0
"""Density [kg/m3] below which balls or races as stiff as steel count as ceramic."""

UNLOADING = 0.6
"""Radial load times tan(contact angle) over the thrust at which a ball loses its load at rest, by
Sjovall's integrals for point contact."""

MOST_RADIAL = 0.4
"""The same ratio above which there is a warning: two thirds of that, assumed."""

MOST_GROWN = 3.0
"""Running preload of a fixed position over the one set, a rule of thumb: many spindles run at
twice to three times."""

MOST_TILT = 2.9
"""Tilt of the rings [mrad]: 10 minutes of arc, the most that catalogues allow a single-row ball
bearing; one with angular contact is allowed 2 to 4."""

LARGEST_RADIANS = math.pi / 2.0
"""Contact angle [degree] below which it may have been given in radians; so small an angle needs a
clearance below 1e-4 of the ball diameter."""

_CONTACT = "contact_angle", "contact_load", "semi_major_axis"


def _pressure_advice(evidence: Evidence) -> str:
    """Returns advice, in words, on how to reduce the contact pressure."""
    is_tilted = abs(evidence.scene.operation.tilt_mrad) > MOST_TILT
    return "reduce the tilt" if is_tilted else "reduce the load or speed, or use larger balls"


def pressure_above_yield(evidence: Evidence) -> Finding:
    """Returns the finding of the peak pressure, whose limit is the yield pressure [GPa]."""
    limit, source = yield_pressure(evidence.scene)
    value = float(np.max(evidence.state["maximum_pressure"])) / GPA
    return {"value": value, "limit": limit, "source": source, "take": _pressure_advice(evidence)}


def pressure_above_practice(evidence: Evidence) -> Finding | None:
    """Returns the finding of the peak pressure, whose limit is that of a long life [GPa].

    None above the yield pressure, of which `pressure_above_yield` warns.
    """
    limit, _ = yield_pressure(evidence.scene)
    value = float(np.max(evidence.state["maximum_pressure"])) / GPA
    if value > limit:
        return None
    return {"value": value, "limit": LONG_LIVED * limit, "take": _pressure_advice(evidence)}


def ellipse_over_shoulder(evidence: Evidence) -> Finding:
    """Returns the finding of the contact ellipse that extends farthest towards its shoulder.

    Value and limit are the angles of the ellipse's edge and of the shoulder [degree].
    """
    bearing = evidence.scene.bearing
    D = bearing.ball_diameter_mm
    radii = np.array([bearing.inner_groove_factor * D, bearing.outer_groove_factor * D])
    edges = _ellipse_edges(evidence, radii)
    findings: list[Finding] = []
    for race, name in ((INNER_SIDE, "inner"), (OUTER_SIDE, "outer")):
        limit, source = _shoulder_angle(bearing, race, radii[race])
        findings.append({"value": edges[race], "limit": limit, "source": source, "race": name})
    return max(findings, key=lambda finding: finding["value"] / finding["limit"])


def _ellipse_edges(evidence: Evidence, radii: np.ndarray) -> np.ndarray:
    """Returns the largest angle of an ellipse's edge on each race (2,) [degree].

    radii: of the inner and the outer groove [mm].
    """
    angle, load, major = (evidence.contacts(name) for name in _CONTACT)
    if evidence.case is not None and "maximum_contact_load" in evidence.case:
        # the load is a mean over time; the axis of the largest one counts
        with np.errstate(invalid="ignore", divide="ignore"):
            growth = np.cbrt(np.asarray(evidence.case["maximum_contact_load"]) / load)
        major = major * np.where(np.isfinite(growth), growth, 1.0)
    edges = np.degrees(angle + major / (MM * radii))
    return np.where(load > 0.0, edges, -np.inf).max(axis=0)  # not where a ball is lifted off


def _shoulder_angle(bearing: Bearing, race: int, radius: float) -> tuple[float, str]:
    """Returns the angle of a race's shoulder [degree], and where it is from, in words.

    race: `INNER_SIDE` or `OUTER_SIDE`.
    radius: of the groove [mm].
    """
    shoulder = (bearing.inner_shoulder_mm, bearing.outer_shoulder_mm)[race]
    if shoulder is None:
        assumed = max(SHOULDER_DEG, bearing.contact_angle_deg + SHOULDER_ROOM_DEG)
        return assumed, "the assumed shoulder"
    D = bearing.ball_diameter_mm
    cosine = math.cos(math.radians(bearing.contact_angle_deg))
    side = 1.0 if race == OUTER_SIDE else -1.0
    centre = 0.5 * bearing.pitch_diameter_mm - side * (radius - 0.5 * D) * cosine
    rise = side * (0.5 * shoulder - centre) / radius
    return math.degrees(math.acos(min(max(rise, -1.0), 1.0))), "the shoulder"


def speed_beyond_practice(evidence: Evidence) -> Finding:
    """Returns the finding of speed times pitch diameter, whose limit is the fastest on rigs."""
    operation = evidence.scene.operation
    relative = abs(operation.shaft_speed_rpm - operation.outer_speed_rpm)
    value = 1e-6 * relative * evidence.scene.bearing.pitch_diameter_mm
    return {"value": value, "limit": FASTEST}


def speed_beyond_makers(evidence: Evidence) -> Finding | None:
    """Returns the finding of the speed [r/min], whose limit is the maker's; None if it has none.

    The limit is that under a light spring, or of a rigid pair by its preload. A starved bearing has
    no oil that cools it, so the limit with grease counts.
    """
    entry = entry_of_bearing(vars(evidence.scene.bearing))
    if entry is None:
        return None
    operation = evidence.scene.operation
    factor, class_name = entry.speed_factor(operation.preload_method, operation.preload_N)
    limit = factor * entry.speed_grease
    value = abs(operation.shaft_speed_rpm - operation.outer_speed_rpm)
    kind = (
        f"in a rigid pair of preload class {class_name}"
        if class_name
        else "with light spring preload"
    )
    return {
        "value": value,
        "limit": limit,
        "oil": factor * entry.speed_oil,
        "bearing": f"{entry.maker} {entry.designation}",
        "kind": kind,
        "source": MAKERS[entry.maker].source,
    }


def hoop_stress(evidence: Evidence) -> Finding | None:
    """Returns the finding of the hoop stress at the bore of the inner ring [MPa].

    The ring is a rotating annulus from the bore to the shoulder, or to the bottom of the groove if
    the shoulder is unknown. None without a bore.
    """
    bearing = evidence.scene.bearing
    if bearing.bore_mm is None:
        return None
    material = evidence.scene.materials[bearing.race_material]
    inside = 0.5 * MM * bearing.bore_mm
    bottom = bearing.pitch_diameter_mm - bearing.ball_diameter_mm
    outside = 0.5 * MM * (bearing.inner_shoulder_mm or bottom)
    nu = material.poisson_ratio
    omega = RPM * evidence.scene.operation.shaft_speed_rpm
    shape = (3.0 + nu) * outside**2 + (1.0 - nu) * inside**2
    value = 0.25 * material.density_kg_m3 * omega**2 * shape / MPA
    return {"value": value, "limit": HOOP_MPA}


def inner_load_lost(evidence: Evidence) -> Finding | None:
    """Returns the finding of a ball that is off the inner race, or hardly driven by it.

    Its excess is above 1 if there is such a ball. None if neither race turns.
    """
    if evidence.scene.operation.shaft_speed_rpm == evidence.scene.operation.outer_speed_rpm == 0.0:
        return None  # nothing skids
    load = evidence.contacts("contact_load")
    share = np.min(load[:, INNER_SIDE] / load[:, OUTER_SIDE])
    unloaded = evidence.state.values.get("unloaded_share", load == 0.0)
    lifted_share = float(np.max(unloaded[:, INNER_SIDE]))
    if lifted_share > LONGEST_LIFTED:
        time = f"{plain(100.0 * lifted_share, 2)} % of the time"
        allowed = f"rule of thumb: at most {100.0 * LONGEST_LIFTED:g} %"
        phrase = f"a ball is out of contact with the inner race for {time} ({allowed})"
        return {"excess": lifted_share / LONGEST_LIFTED, "phrase": phrase}
    least = f"{100.0 * LIGHTEST_INNER:g} %"
    phrase = (
        f"a ball's inner contact load is only {plain(100.0 * share, 2)} % of its outer contact "
        f"load (rule of thumb: at least {least})"
    )
    return {"excess": LIGHTEST_INNER / share, "phrase": phrase}


def preload_too_small(evidence: Evidence) -> Finding | None:
    """Returns the finding of the preload, with a minimum for the balls as its limit [N].

    None without a preload.
    """
    bearing, preload = evidence.scene.bearing, evidence.scene.operation.preload_N
    if not preload:
        return None
    limit = LEAST_PRELOAD * bearing.ball_count * bearing.ball_diameter_mm**2
    finding = {
        "value": preload,
        "limit": limit,
        "n": bearing.ball_count,
        "D": bearing.ball_diameter_mm,
    }
    return finding | {"excess": limit / preload}


def preload_below_makers(evidence: Evidence) -> Finding | None:
    """Returns the finding of the preload, whose limit is the least that the maker prescribes [N].

    The preload is that at speed where it is known. None without a rule of the maker, and for
    ceramic balls: the makers' numbers are those of steel balls, and lighter ones need less.
    """
    bearing, operation = evidence.scene.bearing, evidence.scene.operation
    least = minimum_preload(vars(bearing), vars(operation))
    density = evidence.scene.materials[bearing.ball_material].density_kg_m3
    if least is None or not operation.preload_N or density < CERAMIC_DENSITY:
        return None
    running = (
        evidence.mean("residual_preload")
        if "residual_preload" in evidence.state.values
        else math.nan
    )
    value = running if running > 0.0 else operation.preload_N
    maker, _, name = least.bearing.partition(" ")
    finding = {"maker": maker, "bearing": name, "speed": least.speed, "rule": least.rule}
    return finding | {"value": value, "limit": least.load, "excess": least.load / value}


def friction_beyond_practice(evidence: Evidence) -> Finding | None:
    """Returns the finding of a friction coefficient; its excess is above 1 beyond `USUAL_FRICTION`.

    None without a coefficient.
    """
    value, (least, most) = evidence.scene.friction.ball_race, USUAL_FRICTION
    if not value:  # a film has none, and 0 has a status of its own
        return None
    excess = least / value
    phrase = f"below {least:g}, the lowest value ever measured"
    if value > most:
        excess = value / most
        phrase = f"above {most:g}, the value at which metals seize"
    return {"value": value, "phrase": phrase, "excess": excess}


class _PartTemperature(NamedTuple):
    """Temperature of a part, and the highest that its material bears [degC]."""

    part: str
    material: str
    celsius: float
    warmest: float


def _part_temperatures(evidence: Evidence) -> list[_PartTemperature]:
    """Returns the parts whose material has a temperature limit: steel parts and a polymer cage."""
    bearing = evidence.scene.bearing
    cage = evidence.scene.cage
    parts = []
    inner, balls, outer, *_ = evidence.state["part_temperature"]
    for part, celsius in (("inner ring", inner), ("balls", balls), ("outer ring", outer)):
        name = bearing.ball_material if part == "balls" else bearing.race_material
        if evidence.scene.materials[name].density_kg_m3 >= CERAMIC_DENSITY:
            parts.append(_PartTemperature(part, name, celsius, WARMEST_STEEL))
    if (
        cage is not None
        and evidence.scene.materials[cage.material].youngs_modulus_GPa < POLYMER_GPA
    ):
        warmer = max(inner, outer)
        parts.append(_PartTemperature("cage", cage.material, warmer, WARMEST_POLYMER))
    return parts


def temperature_beyond_practice(evidence: Evidence) -> Finding | None:
    """Returns the finding of the part farthest beyond the temperatures that its material bears.

    Its excess is 1 at the limit and grows by the share of the allowed span that is exceeded. None
    if no part has a limit.
    """
    findings: list[Finding] = []
    for part in _part_temperatures(evidence):
        for limit, side, sign in ((part.warmest, "above", 1.0), (COLDEST, "below", -1.0)):
            findings.append(
                {
                    "part": part.part,
                    "name": part.material,
                    "value": part.celsius,
                    "limit": limit,
                    "side": side,
                    "excess": 1.0 + (part.celsius - limit) / (part.warmest - COLDEST) * sign,
                }
            )
    return max(findings, key=lambda finding: finding["excess"], default=None)


def radial_load_large(evidence: Evidence) -> Finding | None:
    """Returns the finding of the radial load and the one that unloads a ball at rest [N].

    Its excess is 1 at two thirds of that, see `MOST_RADIAL`; loads in space and rotating ones are
    added without sign. None without a radial load or a preload.
    """
    operation = evidence.scene.operation
    load = math.hypot(*operation.radial_load_N) + abs(operation.rotating_load_N)
    if not (load > 0.0 and operation.preload_N > 0.0):
        return None
    tangent = math.tan(math.radians(evidence.scene.bearing.contact_angle_deg))
    unloading = UNLOADING * operation.preload_N / tangent if tangent > 0.0 else math.inf
    excess = load * UNLOADING / (MOST_RADIAL * unloading)
    return {"load": load, "preload": operation.preload_N, "lost": unloading, "excess": excess}


def preload_grown(evidence: Evidence) -> Finding | None:
    """Returns the finding of the running preload over the one set, whose limit is `MOST_GROWN`.

    None under a spring, or without a preload.
    """
    operation = evidence.scene.operation
    if operation.preload_method != "fixed_position" or not operation.preload_N > 0.0:
        return None
    preload = evidence.mean("residual_preload")
    ratio = preload / operation.preload_N
    excess = ratio / MOST_GROWN
    when = "at speed" if operation.turns else "at rest"  # there, temperatures or fits raise it
    return {
        "ratio": ratio,
        "value": preload,
        "preload": operation.preload_N,
        "when": when,
        "excess": excess,
    }


def tilt_beyond_practice(evidence: Evidence) -> Finding:
    """Returns the finding of the tilt of the rings, whose limit is that of catalogues [mrad]."""
    value = abs(evidence.scene.operation.tilt_mrad)
    minutes = math.degrees(1e-3 * value) * 60.0
    return {"value": value, "minutes": minutes, "limit": MOST_TILT}


def contact_angle_too_small(evidence: Evidence) -> Finding | None:
    """Returns the finding of a contact angle that may have been given in radians; None for 0."""
    angle = evidence.scene.bearing.contact_angle_deg
    if not angle:
        return None
    excess = LARGEST_RADIANS / angle
    return {"value": angle, "degrees": math.degrees(angle), "excess": excess}


def contact_angle_zero(evidence: Evidence) -> Finding | None:
    """Returns a finding, which is empty, if the contact angle is zero; None otherwise."""
    return None if evidence.scene.bearing.contact_angle_deg else {}


LEAST_WEAR, HARDEST_GPA, LEAST_FIT_UM, LEAST_FILL = 1e-22, 40.0, 0.05, 0.15
"""K_s/H [m2/N] a thousandth of the least bound that a source has; hardness [GPa] between boron
carbide and diamond; interference [um] below what can be measured; share of the pitch circle that
balls fill, of which bearings have three quarters. All are assumed."""

LEAST_BORE = 0.1
"""Bore over pitch diameter below which the bore counts as a mistake, assumed."""


def units_in_doubt(scene: Scene) -> Iterator[str]:
    """Yields a sentence on each value that no bearing has: another unit was probably meant."""
    b = scene.bearing
    for name in dict.fromkeys((b.ball_material, b.race_material)):
        material = scene.materials[name]
        hardness = material.brinell_hardness_GPa
        factor = material.wear_coefficient / (GPA * hardness)
        if factor < LEAST_WEAR:
            yield (
                f"K_s/H of {name} is {factor:.2g} m2/N, below any that was measured: "
                "wear_coefficient is K_s, which is K_s/H times the hardness"
            )
        if hardness > HARDEST_GPA:
            yield f"a hardness of {hardness:g} GPa ({name}) is that of no steel; 62 HRC are 7 GPa"
    if scene.fits is not None:
        for part in ("shaft", "housing"):
            um = getattr(scene.fits, f"{part}_interference_um")
            if 0.0 < abs(um) < LEAST_FIT_UM:
                yield f"an interference of {um:g} um ({part}) is too small to be measured"
    if b.bore_mm is not None and b.bore_mm < LEAST_BORE * b.pitch_diameter_mm:
        yield f"a bore of {b.bore_mm:g} mm is tiny for a pitch diameter of {b.pitch_diameter_mm:g}"
    share = b.ball_count * b.ball_diameter_mm / (math.pi * b.pitch_diameter_mm)
    if share < LEAST_FILL:
        yield f"balls of {b.ball_diameter_mm:g} mm fill {100.0 * share:.2g} % of the pitch circle"


def unit_in_doubt(evidence: Evidence) -> Finding | None:
    """Returns the finding that names all values whose units are in doubt; None if none is."""
    phrases = [*units_in_doubt(evidence.scene)]
    return {"phrase": "; ".join(phrases)} if phrases else None


def unit_sentences(chosen: Choice) -> Iterator[str]:
    """Yields a sentence on each value whose unit is in doubt, before a solve."""
    for sentence in units_in_doubt(chosen.scene):
        yield f"unit: {sentence}; check the unit"


def angle_sentences(chosen: Choice) -> Iterator[str]:
    """Yields a sentence on a contact angle that is zero or may be in radians, before a solve."""
    angle = chosen.scene.bearing.contact_angle_deg
    if angle == 0.0:
        yield "contact angle: 0 degrees, which needs a clearance of exactly 0"
    if 0.0 < angle < LARGEST_RADIANS:
        yield (
            f"contact angle: {angle:g} degrees; check the unit ({angle:g} rad would be "
            f"{math.degrees(angle):.3g} degrees)"
        )
