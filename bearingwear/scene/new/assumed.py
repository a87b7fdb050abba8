"""Assumptions on a bearing of which little is known, each number with its rule.

Importing this file imports nothing heavy: the command line takes its options from it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.new.catalogue import (
    MAKERS,
    MAKERS_CLASSES,
    SOURCES,
    CatalogueBearing,
    entry_of,
    has_bearing,
)
from bearingwear.scene.new.designations import (
    Designation,
    clearance_range,
    designation_of,
    of_catalogue,
)
from bearingwear.scene.new.letters import CLASS_OF_LETTER, PAIR, letters_of, maker_of

GROOVES = (0.52, 0.53)
"""Groove radius of the inner and the outer race over the ball diameter that is assumed."""

SMALL_BORE = 10.0
"""Bore [mm] below which makers' groove factors differ widely."""

SMALL_GROOVES = (0.52, 0.58)
"""Least and largest groove factor of small bearings. Series S of GMN (catalogue 4000 0813 EN) has
0.52 to 0.53 there; Dynaroll (https://dynaroll.com/raceway-curvature.asp) prints 0.56 +-0.03."""

INSTRUMENT_GROOVES = (0.57, 0.57)
"""Those assumed of a bearing below `SMALL_BORE` without a designation: an instrument bearing R168
(6.35 x 9.525 mm, radial play 8 um) then has the stiffness of its maker."""

SEAT_CLASS = "js4"
"""Tolerance of the shaft that makers recommend for spindle bearings: GMN, catalogue 4000 0813 EN,
p. 71, prints +-2 to +-5 um, which is js4 rounded down; above 1.5 million mm r/min it wants more."""

HOUSING_CLASS = "H4"
"""That of the housing: SNFA, general catalogue, assembly tolerances, for ABEC 7 and 9."""

# Diameter up to [mm]: width of the tolerance IT4 (ISO 286), and how far a bore and an outside
# diameter of class P4 may lie below their nominal size (ISO 492), all [um].
_SEATS = (
    (3, 3, 4, 4), (10, 4, 4, 4), (18, 5, 4, 4), (30, 6, 5, 5), (50, 7, 6, 6), (80, 8, 7, 7),
    (120, 10, 8, 8), (150, 12, 10, 9), (180, 12, 10, 10), (250, 14, 12, 11),
)  # fmt: skip

SPEED_FACTOR = 1.0e6
"""Speed times pitch diameter [mm r/min] that is assumed: a fast spindle."""

PRELOAD_CLASSES = {"light": 0.5, "medium": 1.0, "heavy": 2.0}
"""Preload over (ball count x ball diameter squared x sine of the contact angle) [N/mm2] that is
assumed; equal for all sizes, it means an equal pressure: light, about 1 GPa between steel parts.
Medium and heavy lie within 30 % of classes M and H of a catalogue (tests/scene/test_new.py)."""

CONRAD_FILL_DEG = 186.0
"""Arc that the balls of a deep groove bearing fill when they are put between its rings."""

CLASSES = (*PRELOAD_CLASSES, *MAKERS_CLASSES)

LARGEST_ANGLE_DEG = 80.0

CONDUCTIVITY, DIFFUSIVITY, RING_MODULUS = 32.8, 8.7e-6, 2.31e11
"""Bearing steel: W/(m K), m2/s, and the reduced elastic modulus of a pair [Pa]."""


@dataclass(frozen=True)
class Origin:
    """A number, and the rule it was made by; no rule where it was given.

    What a catalogue says is not `assumed`, whether printed there or identified.
    """

    value: float
    rule: str = ""
    assumed: bool = True

    @property
    def note(self) -> str:
        """The comment beside it."""
        if not self.rule:
            return "# given"
        return f"# assumed: {self.rule}" if self.assumed else f"# {self.rule}"


def size_of(
    designation: str | None,
    bore: float | None,
    outside: float | None,
    maker: str | None = None,
    angle: float | None = None,
) -> Designation:
    """The size of a bearing, of which either the designation or the diameters [mm] are given.

    angle: contact angle [degree], which tells apart bearings of one designation there.

    SceneError where both or neither are given, or the diameters leave no room.
    """
    if maker is not None and designation is None:
        raise refused_option("--maker", maker, "only allowed with a designation such as 7010C")
    if designation is not None:
        for option, given in (("--bore", bore), ("--outside", outside)):
            if given is not None:
                raise refused_option(
                    option, given, f"only allowed without a designation (here, {designation})"
                )
        named, rest = maker_of(designation, tuple(MAKERS))
        if maker is not None and named not in ("", maker):
            raise refused_option("--maker", maker, f"{named}, as in the designation {designation}")
        if maker is None and not (named in MAKERS and has_bearing(named, rest)):
            return designation_of(rest)
        entry, ignored = entry_of(maker or named, rest, angle)
        return of_catalogue(entry, letters_of("", ignored, PAIR))
    for option, given in (("--bore", bore), ("--outside", outside)):
        if given is None:
            problem = "got nothing, expected a designation such as 7008C, or --bore and --outside"
            raise SceneError("", problem, source=option)
    assert bore is not None and outside is not None
    if not 0.0 < bore < math.inf:
        raise refused_option("--bore", bore, "a number > 0")
    if not bore < outside < math.inf:
        raise refused_option("--outside", outside, f"a number > {bore:g}, the bore")
    return Designation(bore, outside)


def numbers_of(
    size: Designation,
    given: Mapping[str, float],
    clearance: str | float | None = None,
    preload_class: str | None = None,
    preload_method: str = "constant_force",
) -> dict[str, Origin]:
    """Every number of `OPTIONS`, given, of a catalogue, or made by its rule.

    size: of a bearing with a contact angle, unless it or a contact angle of 0 says otherwise.
    given: by key of the scene, in its units.
    clearance: group of radial clearance, or the clearance itself [um], of a deep groove bearing.

    SceneError where numbers leave no room, or contradict each other.
    """
    angle_key, preload_key = "bearing.contact_angle_deg", "operation.preload_N"
    deep_groove = _is_deep_groove(size, given.get(angle_key), clearance)
    if given.get(angle_key) == 0.0:  # the nominal angle of a deep groove bearing, not the free one
        given = {key: value for key, value in given.items() if key != angle_key}
    if preload_class is not None and preload_key in given:
        raise refused_option("--preload-class", preload_class, "only allowed without --preload")
    if preload_class is None and preload_key not in given and (load := size.letters.load):
        own = size.entry is not None and size.entry.preloads
        preload_class = load if own else CLASS_OF_LETTER.get(load)
    found: dict[str, Origin] = {}

    def decide(key: str, value: float, rule: str, assumed: bool = True) -> float:
        found[key] = Origin(given[key]) if key in given else Origin(value, rule, assumed)
        return found[key].value

    bore, outside, entry = size.bore, size.outside, size.entry
    section = 0.5 * (outside - bore)
    if entry is not None:
        ball_rule = rounded_to(entry.ball, 6), SOURCES[entry.source], False
    else:
        ball_rule = rounded_to(0.6 * section), "0.3 x (outside diameter - bore)", True
    D = decide("bearing.ball_diameter_mm", *ball_rule)
    if not 0.0 < D < section:
        allowed = f"a number > 0 and < {section:g}, half of the section height"
        raise refused_option("--ball-diameter", D, allowed)
    if entry is not None and entry.pitch is not None:
        pitch_rule = entry.pitch, SOURCES[entry.source], False
    else:
        pitch_rule = 0.5 * (bore + outside), "mean of bore and outside diameter", True
    dm = decide("bearing.pitch_diameter_mm", *pitch_rule)
    if not bore + D < dm < outside - D:
        allowed = f"a number > {bore + D:g} and < {outside - D:g}"
        raise refused_option("--pitch-diameter", dm, allowed)
    inner, outer = (
        decide(f"bearing.{race}_groove_factor", groove.value, groove.rule, groove.assumed)
        for race, groove in zip(("inner", "outer"), grooves_of(size), strict=True)
    )
    if entry is not None:
        Z = decide("bearing.ball_count", entry.balls, SOURCES[entry.source], False)
        angle = decide(angle_key, entry.angle, SOURCES["printed"], False)
    else:
        Z = decide("bearing.ball_count", *_usual_balls(D, dm, deep_groove))
        angle = decide(
            angle_key, *_free_angle(size, (inner + outer - 1.0) * D, clearance, deep_groove)
        )
    if preload_class is not None or preload_key not in given:
        preload = _preload(entry, preload_class, Z * D**2 * math.sin(math.radians(angle)))
    else:
        preload = Origin(given[preload_key])
    found[preload_key] = preload
    decide("operation.shaft_speed_rpm", *_usual_speed(entry, dm, preload_method, preload.value))
    decide("friction.ball_race", 0.08, "starved or solid-lubricated steel")
    return found


def _preload(entry: CatalogueBearing | None, preload_class: str | None, size: float) -> Origin:
    """Preload [N] of a class; `size` is balls x diameter^2 x sin(contact angle) [mm2]."""
    if entry is not None and entry.preloads:
        name = preload_class or "L"
        if name not in entry.preloads:
            classes = ", ".join(entry.preloads)
            raise refused_option("--preload-class", name, f"{classes}, {entry.maker}'s")
        return Origin(entry.preloads[name], f"{entry.maker} class {name}", False)
    name = preload_class or "light"
    if name not in PRELOAD_CLASSES:
        why = "; a maker's classes require --maker"
        if entry:
            why = f"; the catalogue gives no preload class for {entry.designation}"
        raise refused_option("--preload-class", name, ", ".join(PRELOAD_CLASSES) + why)
    density = PRELOAD_CLASSES[name]
    rule = f"{name}, {density:g} N/mm2 x number of balls x ball diameter^2 x sin(contact angle)"
    return Origin(rounded_to(density * size), rule)


def _usual_speed(
    entry: CatalogueBearing | None, dm: float, method: str, preload: float
) -> tuple[float, str]:
    """Speed [r/min] that is assumed, and the rule."""
    if entry is None:
        return rounded_to(SPEED_FACTOR / dm), "one million mm r/min divided by the pitch diameter"
    factor, name = entry.speed_factor(method, preload)
    rule = f"{entry.maker}'s speed limit with grease"
    if name:
        rule += f", times {factor:g} for a rigid pair of class {name}"
    limit = factor * entry.speed_grease
    return min(rounded_to(limit, 3), limit), rule


def grooves_of(size: Designation) -> tuple[Origin, Origin]:
    """Inner and outer groove factor, and where each comes from."""
    if size.entry is not None and size.entry.grooves:
        inner, outer = map(Origin, size.entry.grooves, MAKERS[size.entry.maker].groove_rules)
        return replace(inner, assumed=False), replace(outer, assumed=False)
    factors, rule = GROOVES, "the largest factor for which ISO 281 load ratings apply"
    if not size.name and size.bore < SMALL_BORE:
        factors = INSTRUMENT_GROOVES
        rule = "instrument bearing (Dynaroll: 0.56 +-0.03 for low torque)"
    if grooves_vary(size):
        rule = f"{rule}; {_SMALL}"
    return Origin(factors[0], rule), Origin(factors[1], rule)


_SMALL = "makers of small bearings use {:g} to {:g}".format(*SMALL_GROOVES)


def grooves_vary(size: Designation) -> bool:
    """Whether the groove factors of a bearing are too uncertain for one assumption."""
    return size.bore < SMALL_BORE and not (size.entry and size.entry.grooves)


def _is_deep_groove(size: Designation, angle: float | None, clearance: str | float | None) -> bool:
    """Whether the free contact angle comes from a radial clearance."""
    if angle == 0.0 and size.name and not size.deep_groove:
        problem = f"a number > 0, because {size.name} is an angular contact bearing"
        raise refused_option("--contact-angle", angle, problem)
    if clearance is None:
        return size.deep_groove or angle == 0.0
    option = "--clearance" if isinstance(clearance, str) else "--radial-clearance-um"
    if angle:
        raise refused_option(
            option, clearance, f"only allowed without a contact angle (here, {angle:g})"
        )
    if size.name and not size.deep_groove:
        raise refused_option(
            option, clearance, f"only allowed for a deep groove bearing, not {size.name}"
        )
    if size.clearance:
        raise refused_option(option, clearance, f"only allowed without the suffix {size.clearance}")
    return True


def _usual_balls(D: float, dm: float, deep_groove: bool) -> tuple[int, str]:
    """Number of balls, and the rule."""
    half = math.asin(D / dm)
    if deep_groove:
        balls = round(1.0 + math.radians(0.5 * CONRAD_FILL_DEG) / half)
        return max(3, balls), f"the balls fill {CONRAD_FILL_DEG:g} degrees (Conrad assembly)"
    balls = round(0.75 * math.pi / half)
    return max(3, balls), "three quarters of the maximum number"


def _free_angle(
    size: Designation, distance: float, clearance: str | float | None, deep_groove: bool
) -> tuple[float, str]:
    """Free contact angle [degree], and the rule.

    Of a deep groove bearing it is what the radial clearance leaves (Harris):
    cos(angle) = 1 - clearance / (2 distance), where `distance` [mm] of the groove centres is inner
    plus outer groove radius less ball diameter.
    """
    if not deep_groove:
        if size.angle is not None:
            return size.angle, size.angle_rule
        return 15.0, "typical of high-speed bearings"
    if clearance is None or isinstance(clearance, str):
        group = clearance or size.clearance or "CN"
        ends = clearance_range(group, size.bore)
        if ends is None:
            raise refused_option(
                "--clearance", group, "a bore of at most 200 mm, or --radial-clearance-um"
            )
        um, rule = 0.5 * sum(ends), f" (mean of {group}, before mounting)"
    else:
        um, rule = clearance, ""
    play = 2e3 * distance
    widest = play * (1.0 - math.cos(math.radians(LARGEST_ANGLE_DEG)))
    if not 0.0 < um <= widest:
        raise refused_option("--radial-clearance-um", um, f"a number > 0 and <= {widest:.4g}")
    angle = math.degrees(math.acos(1.0 - um / play))
    return rounded_to(angle, 4), (
        f"from a radial clearance of {um:g} um{rule}; 0 is only the nominal angle"
    )


def seat_interference(bore: float) -> tuple[float, float] | None:
    """Least and largest interference [um] of `SEAT_CLASS` in a bore [mm] of class P4."""
    seat = _seat(bore)
    return None if seat is None else (-0.5 * seat[1], 0.5 * seat[1] + seat[2])


def housing_clearance(outside: float) -> float | None:
    """Mean clearance [um] of an outside diameter [mm] of class P4 in `HOUSING_CLASS`."""
    seat = _seat(outside)
    return None if seat is None else 0.5 * (seat[1] + seat[3])


def _seat(diameter: float) -> tuple[int, ...] | None:
    return next((seat for seat in _SEATS if diameter <= seat[0]), None)


def refused_option(option: str, value: float | str, what: str) -> SceneError:
    """The error of an option of `bearingwear new`."""
    given = value if isinstance(value, str) else f"{value:g}"
    expected = f"; {what}" if what.startswith("only") else f", expected {what}"
    return SceneError("", f"got {given}{expected}", source=option)


def race_conductance(numbers: Mapping[str, Origin]) -> float:
    """Heat conducted between all balls and a race through dry contacts [W/K], steel on steel.

    Each contact is a heat source that moves over ball and race: Jungnickel, *Simulation des
    thermischen Verhaltens von Werkzeugmaschinen* (TU Dresden 2010), p. 175. Oil adds as much again:
    Thermca (github.com/steffenschroe/Thermca, lib/bearing.py) has 3.6 where this has 2.0.
    """
    Z, D, dm, angle, rpm, preload = (
        numbers[key].value
        for key in (
            "bearing.ball_count",
            "bearing.ball_diameter_mm",
            "bearing.pitch_diameter_mm",
            "bearing.contact_angle_deg",
            "operation.shaft_speed_rpm",
            "operation.preload_N",
        )
    )
    R, r, omega = 0.5e-3 * D, 0.5e-3 * dm, math.pi / 30.0 * rpm
    load = max(preload, 1.0) / (Z * math.sin(math.radians(angle)))
    W = load / (RING_MODULUS * R**2)
    moving = math.sqrt(W) ** (1.0 / 3.0) * math.sqrt(omega * R * r / DIFFUSIVITY)
    return Z * 1.8 * CONDUCTIVITY * R * W ** (1.0 / 3.0) * (1.0 + moving)


SPECIFIC_HEAT = {"bearing_steel": 460.0, "silicon_nitride": 680.0}
"""Heat capacity by mass [J/(kg K)]."""

DENSITY = {"bearing_steel": 7800.0, "silicon_nitride": 3200.0}
"""Of the materials that `new` writes [kg/m3]."""


class PartCapacities(NamedTuple):
    """Heat capacities of a bearing's parts [J/K]."""

    inner_ring: float
    balls: float
    outer_ring: float


def heat_capacities(
    numbers: Mapping[str, Origin], size: Designation, ball_material: str
) -> PartCapacities:
    """Heat capacities of rings and balls; rings as sleeves that end at a quarter of the balls.

    Where the width is not known, it is half the difference of outside diameter and bore, as ISO 15
    has it within a fifth.
    """
    Z, D, dm = (
        numbers[f"bearing.{key}"].value
        for key in ("ball_count", "ball_diameter_mm", "pitch_diameter_mm")
    )
    width = size.width or 0.5 * (size.outside - size.bore)

    def sleeve(inside: float, outside: float) -> float:
        volume = 0.25e-9 * math.pi * max(outside**2 - inside**2, 0.0) * width
        return volume * DENSITY["bearing_steel"] * SPECIFIC_HEAT["bearing_steel"]

    balls = 1e-9 * Z * math.pi / 6.0 * D**3 * DENSITY[ball_material] * SPECIFIC_HEAT[ball_material]
    land = 0.5 * D
    return PartCapacities(sleeve(size.bore, dm - land), balls, sleeve(dm + land, size.outside))


def rounded_to(value: float, digits: int = 2) -> float:
    """A number to so many significant digits."""
    return float(f"{value:.{digits}g}")
