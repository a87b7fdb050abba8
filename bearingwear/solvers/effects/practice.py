"""Limits of practice, and findings of bearings beyond them.

Each limit has a source or is called assumed, or a rule of thumb. The sentences stand in `table`.
"""

import math
from collections.abc import Iterator

import numpy as np

from bearingwear.measures import plain
from bearingwear.scene.new.catalogue import MAKERS, entry_of_bearing
from bearingwear.scene.new.minimum_preload import minimum_preload
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.mounted import STEEL_YIELD, yield_pressure
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

_GPA, _MPA, _MM = 1e9, 1e6, 1e-3
_CONTACT = "contact_angle", "contact_load", "semi_major_axis"


def _pressure_advice(e: Evidence) -> str:
    """States how to reduce the pressure."""
    is_tilted = abs(e.scene.operation.tilt_mrad) > MOST_TILT
    return "reduce the tilt" if is_tilted else "reduce the load or speed, or use larger balls"


def pressure_above_yield(e: Evidence) -> Finding:
    """Compares the peak pressure with the yield pressure."""
    limit, source = yield_pressure(e.scene)
    value = float(np.max(e.state["maximum_pressure"])) / _GPA
    return {"value": value, "limit": limit, "source": source, "take": _pressure_advice(e)}


def pressure_above_practice(e: Evidence) -> Finding | None:
    """Compares a peak pressure below yield with that of a long life."""
    limit, _ = yield_pressure(e.scene)
    value = float(np.max(e.state["maximum_pressure"])) / _GPA
    if value > limit:  # another warning says so
        return None
    return {"value": value, "limit": LONG_LIVED * limit, "take": _pressure_advice(e)}


def ellipse_over_shoulder(e: Evidence) -> Finding:
    """Finds the edge of an ellipse closest to its shoulder, as angles from the groove's bottom."""
    bearing = e.scene.bearing
    D, cosine = bearing.ball_diameter_mm, math.cos(math.radians(bearing.contact_angle_deg))
    angle, load, major = (e.contacts(name) for name in _CONTACT)
    if e.case is not None and "maximum_contact_load" in e.case:  # the largest load, not the mean
        with np.errstate(invalid="ignore", divide="ignore"):
            peak = np.cbrt(np.asarray(e.case["maximum_contact_load"]) / load)
        major = major * np.where(np.isfinite(peak), peak, 1.0)
    findings = []
    radii = np.array([bearing.inner_groove_factor * D, bearing.outer_groove_factor * D])
    edges = np.degrees(angle + major / (_MM * radii))
    edges = np.where(load > 0.0, edges, -np.inf).max(axis=0)  # not where a ball is lifted off
    for race, side, radius, shoulder in (
        (INNER_SIDE, -1.0, radii[INNER_SIDE], bearing.inner_shoulder_mm),
        (OUTER_SIDE, 1.0, radii[OUTER_SIDE], bearing.outer_shoulder_mm),
    ):
        limit = max(SHOULDER_DEG, bearing.contact_angle_deg + SHOULDER_ROOM_DEG)
        source = "the assumed shoulder"
        if shoulder is not None:
            centre = 0.5 * bearing.pitch_diameter_mm - side * (radius - 0.5 * D) * cosine
            rise = side * (0.5 * shoulder - centre) / radius
            limit, source = math.degrees(math.acos(min(max(rise, -1.0), 1.0))), "the shoulder"
        finding = {"value": edges[race], "limit": limit, "source": source}
        findings.append(finding | {"race": ("inner", "outer")[race]})
    return max(findings, key=lambda finding: finding["value"] / finding["limit"])


def speed_beyond_practice(e: Evidence) -> Finding:
    """Compares speed times pitch diameter with the fastest bearings on rigs."""
    operation = e.scene.operation
    relative = abs(operation.shaft_speed_rpm - operation.outer_speed_rpm)
    value = 1e-6 * relative * e.scene.bearing.pitch_diameter_mm
    return {"value": value, "limit": FASTEST}


def speed_beyond_makers(e: Evidence) -> Finding | None:
    """Compares the speed with the maker's limit.

    The limit is that under a light spring, or of a rigid pair by its preload. A starved bearing has
    no oil that cools it, so the limit with grease counts.
    """
    entry = entry_of_bearing(vars(e.scene.bearing))
    if entry is None:
        return None
    operation = e.scene.operation
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


def hoop_stress(e: Evidence) -> Finding | None:
    """Returns the hoop stress at the bore of a rotating annulus.

    It reaches out to the shoulder, or to the bottom of the groove.
    """
    bearing = e.scene.bearing
    if bearing.bore_mm is None:
        return None
    material = e.scene.materials[bearing.race_material]
    inside = 0.5 * _MM * bearing.bore_mm
    bottom = bearing.pitch_diameter_mm - bearing.ball_diameter_mm
    outside = 0.5 * _MM * (bearing.inner_shoulder_mm or bottom)
    nu, omega = material.poisson_ratio, math.pi / 30.0 * e.scene.operation.shaft_speed_rpm
    shape = (3.0 + nu) * outside**2 + (1.0 - nu) * inside**2
    value = 0.25 * material.density_kg_m3 * omega**2 * shape / _MPA
    return {"value": value, "limit": HOOP_MPA}


def inner_load_lost(e: Evidence) -> Finding | None:
    """Finds a ball that is off the inner race, or hardly driven by it."""
    if e.scene.operation.shaft_speed_rpm == e.scene.operation.outer_speed_rpm == 0.0:
        return None  # nothing skids
    load = e.contacts("contact_load")
    share = np.min(load[:, INNER_SIDE] / load[:, OUTER_SIDE])
    unloaded = e.state.values.get("unloaded_share", load == 0.0)
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


def preload_too_small(e: Evidence) -> Finding | None:
    """Compares the preload with a minimum for the balls."""
    bearing, preload = e.scene.bearing, e.scene.operation.preload_N
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


def preload_below_makers(e: Evidence) -> Finding | None:
    """Compares the preload, at speed where that is known, with the least that the maker prescribes.

    The makers' numbers are those of steel balls; ceramic ones are lighter and need less.
    """
    bearing, operation = e.scene.bearing, e.scene.operation
    least = minimum_preload(vars(bearing), vars(operation))
    density = e.scene.materials[bearing.ball_material].density_kg_m3
    if least is None or not operation.preload_N or density < CERAMIC_DENSITY:
        return None
    running = e.mean("residual_preload") if "residual_preload" in e.state.values else math.nan
    value = running if running > 0.0 else operation.preload_N
    maker, _, name = least.bearing.partition(" ")
    finding = {"maker": maker, "bearing": name, "speed": least.speed, "rule": least.rule}
    return finding | {"value": value, "limit": least.load, "excess": least.load / value}


def friction_beyond_practice(e: Evidence) -> Finding | None:
    """Compares the friction coefficient with measured ones."""
    value, (least, most) = e.scene.friction.ball_race, USUAL_FRICTION
    if not value:  # a film has none, and 0 has a status of its own
        return None
    excess, phrase = least / value, f"below {least:g}, the lowest value ever measured"
    if value > most:
        excess, phrase = value / most, f"above {most:g}, the value at which metals seize"
    return {"value": value, "phrase": phrase, "excess": excess}


def temperature_beyond_practice(e: Evidence) -> Finding | None:
    """Finds the part farthest beyond the temperatures that its material bears.

    The excess is that over the allowed span of temperatures.
    """
    bearing, cage, parts = e.scene.bearing, e.scene.cage, []
    inner, balls, outer, *_ = e.state["part_temperature"]
    for part, celsius in (("inner ring", inner), ("balls", balls), ("outer ring", outer)):
        name = bearing.ball_material if part == "balls" else bearing.race_material
        if e.scene.materials[name].density_kg_m3 >= CERAMIC_DENSITY:
            parts.append((part, name, celsius, WARMEST_STEEL))
    if cage is not None and e.scene.materials[cage.material].youngs_modulus_GPa < POLYMER_GPA:
        parts.append(("cage", cage.material, max(inner, outer), WARMEST_POLYMER))
    findings = []
    for part, name, value, warmest in parts:
        for limit, side, sign in ((warmest, "above", 1.0), (COLDEST, "below", -1.0)):
            excess = 1.0 + (value - limit) / (warmest - COLDEST) * sign
            finding = {"part": part, "name": name, "value": value, "limit": limit}
            findings.append(finding | {"side": side, "excess": excess})
    return max(findings, key=lambda finding: finding["excess"], default=None)


def radial_load_large(e: Evidence) -> Finding | None:
    """Compares the radial load with the one that unloads a ball at rest."""
    operation = e.scene.operation
    load = math.hypot(*operation.radial_load_N) + abs(operation.rotating_load_N)
    if not (load > 0.0 and operation.preload_N > 0.0):
        return None
    tangent = math.tan(math.radians(e.scene.bearing.contact_angle_deg))
    unloading = UNLOADING * operation.preload_N / tangent if tangent > 0.0 else math.inf
    excess = load * UNLOADING / (MOST_RADIAL * unloading)
    return {"load": load, "preload": operation.preload_N, "lost": unloading, "excess": excess}


def preload_grown(e: Evidence) -> Finding | None:
    """Compares the running preload of a fixed position with the one set."""
    operation = e.scene.operation
    if operation.preload_method != "fixed_position" or not operation.preload_N > 0.0:
        return None
    preload = e.mean("residual_preload")
    ratio = preload / operation.preload_N
    excess = ratio / MOST_GROWN
    when = "at speed" if operation.turns else "at rest"  # which temperatures or fits raised
    return {
        "ratio": ratio,
        "value": preload,
        "preload": operation.preload_N,
        "when": when,
        "excess": excess,
    }


def tilt_beyond_practice(e: Evidence) -> Finding:
    """Compares the tilt of the rings with that of catalogues."""
    value = abs(e.scene.operation.tilt_mrad)
    minutes = math.degrees(1e-3 * value) * 60.0
    return {"value": value, "minutes": minutes, "limit": MOST_TILT}


def contact_angle_too_small(e: Evidence) -> Finding | None:
    """Finds a contact angle that may have been given in radians."""
    angle = e.scene.bearing.contact_angle_deg
    if not angle:
        return None
    excess = LARGEST_RADIANS / angle
    return {"value": angle, "degrees": math.degrees(angle), "excess": excess}


def contact_angle_zero(e: Evidence) -> Finding | None:
    """Finds a contact angle of zero."""
    return None if e.scene.bearing.contact_angle_deg else {}


LEAST_WEAR, HARDEST_GPA, LEAST_FIT_UM, LEAST_FILL = 1e-22, 40.0, 0.05, 0.15
"""K_s/H [m2/N] a thousandth of the least bound that a source has; hardness [GPa] between boron
carbide and diamond; interference [um] below what can be measured; share of the pitch circle that
balls fill, of which bearings have three quarters. All are assumed."""


def units_in_doubt(scene: Scene) -> Iterator[str]:
    """Describes values that no bearing has, so that another unit was probably meant."""
    b = scene.bearing
    for name in dict.fromkeys((b.ball_material, b.race_material)):
        material = scene.materials[name]
        hardness = material.brinell_hardness_GPa
        factor = material.wear_coefficient / (_GPA * hardness)
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
    if b.bore_mm is not None and b.bore_mm < 0.1 * b.pitch_diameter_mm:
        yield f"a bore of {b.bore_mm:g} mm is tiny for a pitch diameter of {b.pitch_diameter_mm:g}"
    share = b.ball_count * b.ball_diameter_mm / (math.pi * b.pitch_diameter_mm)
    if share < LEAST_FILL:
        yield f"balls of {b.ball_diameter_mm:g} mm fill {100.0 * share:.2g} % of the pitch circle"


def unit_in_doubt(e: Evidence) -> Finding | None:
    """Joins the values whose units are in doubt."""
    phrases = [*units_in_doubt(e.scene)]
    return {"phrase": "; ".join(phrases)} if phrases else None


def unit_sentences(chosen: Choice) -> Iterator[str]:
    """Names the values whose units are in doubt, before a solve."""
    for sentence in units_in_doubt(chosen.scene):
        yield f"unit: {sentence}; check the unit"


def angle_sentences(chosen: Choice) -> Iterator[str]:
    """Names a contact angle that is zero or may be in radians, before a solve."""
    angle = chosen.scene.bearing.contact_angle_deg
    if angle == 0.0:
        yield "contact angle: 0 degrees, which needs a clearance of exactly 0"
    if 0.0 < angle < LARGEST_RADIANS:
        yield (
            f"contact angle: {angle:g} degrees; check the unit ({angle:g} rad would be "
            f"{math.degrees(angle):.3g} degrees)"
        )
