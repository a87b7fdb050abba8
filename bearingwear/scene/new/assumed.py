"""Assumptions on a bearing of which little is known, each number with its rule.

Importing this file imports nothing heavy: the command line takes its options from it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

from bearingwear.scene.checking.check import fits, misfit_words
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import Key, Part
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
from bearingwear.scene.new.letters import CLASS_OF_LETTER, PAIR, WORDS, letters_of, maker_of

BORE = Part("number", Key("", "mm", "[0.5, 5000]"))
OUTSIDE = Part("number", Key("", "mm", "[1, 10000]"))
"""Diameters of a bearing without a designation."""

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


class SeatTolerance(NamedTuple):
    """Tolerances of seats up to a diameter [um]."""

    largest_diameter: float  # [mm]
    it4: float  # width of the tolerance IT4 (ISO 286)
    # how far a bore and an outside diameter of class P4 may lie below their nominal size (ISO 492)
    bore: float
    outside: float


_SEATS = tuple(
    SeatTolerance(*row)
    for row in (
        (3, 3, 4, 4), (10, 4, 4, 4), (18, 5, 4, 4), (30, 6, 5, 5), (50, 7, 6, 6), (80, 8, 7, 7),
        (120, 10, 8, 8), (150, 12, 10, 9), (180, 12, 10, 10), (250, 14, 12, 11),
    )
)  # fmt: skip

SPEED_FACTOR = 1.0e6
"""Speed times pitch diameter [mm r/min] that is assumed: a fast spindle."""

FILM_SPEED_FACTOR = 6.0e4
"""That with a sputtered film: 1750 r/min of a pitch diameter of 33.5 mm, the one published test of
such a film in an angular contact bearing (docs/film_tests.md)."""

PRELOAD_CLASSES = {"light": 0.5, "medium": 1.0, "heavy": 2.0}
"""Preload over (ball count x ball diameter squared x sine of the contact angle) [N/mm2] that is
assumed; equal for all sizes, it means an equal pressure: light, about 1 GPa between steel parts.
Medium and heavy lie within 30 % of classes M and H of a catalogue (tests/scene/test_new.py)."""

_EXCESSIVE = 20.0
"""Preload over that of class heavy above which it is doubted; about 4 GPa, where balls dent races
at rest."""

CONRAD_FILL_DEG = 186.0
"""Arc that the balls of a deep groove bearing fill when they are put between its rings."""

CLASSES = (*PRELOAD_CLASSES, *MAKERS_CLASSES)

LARGEST_ANGLE_DEG = 80.0

_ANGLE, _PRELOAD = "bearing.contact_angle_deg", "operation.preload_N"

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
        """Returns the comment that follows the number in a scene file."""
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
    """Returns the size of a bearing by its designation or by its diameters [mm].

    maker: whose catalogue has the designation; if None, the maker that the designation names, if
        any.
    angle: contact angle [degree], which tells apart catalogue bearings of one designation.

    SceneError where both or neither are given, the diameters leave no room, the designation is not
    known, or words in it are what an option states.
    """
    if designation is None:
        if maker is not None:
            raise refused_option("--maker", maker, "only allowed with a designation such as 7010C")
        return _size_of_diameters(bore, outside)
    for option, diameter in (("--bore", bore), ("--outside", outside)):
        if diameter is not None:
            raise refused_option(
                option, diameter, f"only allowed without a designation (here, {designation})"
            )
    maker_in_text, plain_designation = maker_of(designation, tuple(MAKERS))
    if maker is not None and maker_in_text not in ("", maker):
        expected = f"{maker_in_text}, as in the designation {designation}"
        raise refused_option("--maker", maker, expected)
    if maker is None and maker_in_text in MAKERS and has_bearing(maker_in_text, plain_designation):
        maker = maker_in_text
    if maker is None:
        return _without_words(designation_of(plain_designation))
    entry, ignored = entry_of(maker, plain_designation, angle)
    return _without_words(of_catalogue(entry, letters_of("", ignored, PAIR)))


def _size_of_diameters(bore: float | None, outside: float | None) -> Designation:
    """Returns the size of a bearing without a designation by its diameters [mm].

    SceneError where one is missing or out of its range, or where they leave no room.
    """
    for option, diameter in (("--bore", bore), ("--outside", outside)):
        if diameter is None:
            problem = "got nothing, expected a designation such as 7008C, or --bore and --outside"
            raise SceneError("", problem, source=option)
    assert bore is not None and outside is not None
    for option, diameter, part in (("--bore", bore, BORE), ("--outside", outside, OUTSIDE)):
        if not fits(diameter, part):
            raise SceneError("", misfit_words(diameter, part), source=option)
    if not bore < outside:
        raise refused_option("--outside", outside, f"a number > {bore:g}, the bore")
    return Designation(bore, outside)


def _without_words(size: Designation) -> Designation:
    """Returns the size unchanged; refuses words after its designation that an option states."""
    for word in size.letters.ignored.split():
        if option := WORDS.get(word):
            problem = f"got {word.lower()}, expected {size.name} {option}"
            raise SceneError("", problem, source="designation")
        if word.isdecimal():
            option = "--speed" if int(word) > LARGEST_ANGLE_DEG else "--contact-angle"
            problem = f"got the number {word}, expected {size.name} {option} {word}"
            raise SceneError("", problem, source="designation")
    return size


def numbers_of(
    size: Designation,
    given: Mapping[str, float],
    clearance: str | float | None = None,
    preload_class: str | None = None,
    preload_method: str = "constant_force",
    has_film: bool = False,
) -> dict[str, Origin]:
    """Returns geometry, preload, speed and friction by key of the scene, each with its origin.

    An origin is the user, a catalogue, or a rule.

    size: an angular contact bearing, unless it is a deep groove one or a contact angle of 0 is
        given.
    given: values of the user by key of the scene, in its units.
    clearance: group of radial clearance, or the clearance itself [um], of a deep groove bearing.
    preload_class: of `PRELOAD_CLASSES`, or of the maker; if None, that of a letter in the
        designation, else `light` or the maker's L.
    preload_method: of the scene; a fixed position reduces a maker's speed limit.
    has_film: whether a sputtered film lubricates, for which a low speed is assumed.

    SceneError where numbers leave no room, or contradict each other.
    """
    deep_groove = _is_deep_groove(size, given.get(_ANGLE), clearance)
    if given.get(_ANGLE) == 0.0:  # the nominal angle of a deep groove bearing, not the free one
        given = {key: value for key, value in given.items() if key != _ANGLE}
    numbers = _geometry(size, given, deep_groove, clearance)
    area = _class_area(numbers)
    preload = _usual_preload(size, given, preload_class, area)
    dm = numbers["bearing.pitch_diameter_mm"].value
    speed = _usual_speed(size.entry, dm, preload_method, preload.value, has_film)
    # `coefficients.ASSUMED_FRICTION`
    friction = Origin(0.08, "starved or solid-lubricated steel")
    return numbers | {
        _PRELOAD: preload,
        "operation.shaft_speed_rpm": _given_or(given, "operation.shaft_speed_rpm", speed),
        "friction.ball_race": _given_or(given, "friction.ball_race", friction),
    }


def _given_or(given: Mapping[str, float], key: str, usual: Origin) -> Origin:
    """Returns the number that the user gives for a key, else the usual one."""
    return Origin(given[key]) if key in given else usual


def _geometry(
    size: Designation,
    given: Mapping[str, float],
    deep_groove: bool,
    clearance: str | float | None,
) -> dict[str, Origin]:
    """Returns balls, pitch diameter, groove factors and contact angle by key of the scene.

    Parameters are those of `numbers_of`. SceneError where the balls leave no room.
    """
    bore, outside, entry = size.bore, size.outside, size.entry
    section = 0.5 * (outside - bore)
    ball_diameter = _given_or(
        given, "bearing.ball_diameter_mm", _usual_ball_diameter(entry, section)
    )
    D = ball_diameter.value
    if not 0.0 < D < section:
        allowed = f"a number > 0 and < {section:g}, half of the section height"
        raise refused_option("--ball-diameter", D, allowed)
    pitch_diameter = _given_or(
        given, "bearing.pitch_diameter_mm", _usual_pitch_diameter(entry, bore, outside)
    )
    dm = pitch_diameter.value
    if not bore + D < dm < outside - D:
        allowed = f"a number > {bore + D:g} and < {outside - D:g}"
        raise refused_option("--pitch-diameter", dm, allowed)
    usual_inner, usual_outer = grooves_of(size)
    inner = _given_or(given, "bearing.inner_groove_factor", usual_inner)
    outer = _given_or(given, "bearing.outer_groove_factor", usual_outer)
    if entry is not None:
        ball_count = Origin(entry.balls, SOURCES[entry.source], assumed=False)
        free_angle = Origin(entry.angle, SOURCES["printed"], assumed=False)
    else:
        ball_count = _usual_balls(D, dm, deep_groove)
        distance = (inner.value + outer.value - 1.0) * D
        free_angle = _clearance_angle(size, distance, clearance) if deep_groove else _angle(size)
    return {
        "bearing.ball_diameter_mm": ball_diameter,
        "bearing.pitch_diameter_mm": pitch_diameter,
        "bearing.inner_groove_factor": inner,
        "bearing.outer_groove_factor": outer,
        "bearing.ball_count": _given_or(given, "bearing.ball_count", ball_count),
        _ANGLE: _given_or(given, _ANGLE, free_angle),
    }


def _class_area(numbers: Mapping[str, Origin]) -> float:
    """Returns balls x diameter^2 x sin(angle) [mm2], over which a class has one preload."""
    Z = numbers["bearing.ball_count"].value
    D = numbers["bearing.ball_diameter_mm"].value
    return Z * D**2 * math.sin(math.radians(numbers[_ANGLE].value))


def _usual_preload(
    size: Designation, given: Mapping[str, float], preload_class: str | None, area: float
) -> Origin:
    """Returns the preload [N] that is given, else that of a class.

    The class is that of the option, else of a letter in the designation, else a usual one.

    given: values of the user by key of the scene.
    preload_class: of the option `--preload-class`; None without it.
    area: that of `_class_area` [mm2].
    """
    if _PRELOAD in given:
        if preload_class is not None:
            raise refused_option("--preload-class", preload_class, "only allowed without --preload")
        return _given_preload(given[_PRELOAD], area)
    letter = size.letters.load
    if preload_class is None and letter:
        has_maker_classes = size.entry is not None and size.entry.preloads
        preload_class = letter if has_maker_classes else CLASS_OF_LETTER.get(letter)
    return _class_preload(size.entry, preload_class, area)


def _usual_ball_diameter(entry: CatalogueBearing | None, section: float) -> Origin:
    """Returns the ball diameter [mm] of the catalogue, or by the height of the section [mm]."""
    if entry is not None:
        return Origin(rounded_to(entry.ball, 6), SOURCES[entry.source], assumed=False)
    return Origin(rounded_to(0.6 * section), "0.3 x (outside diameter - bore)")


def _usual_pitch_diameter(entry: CatalogueBearing | None, bore: float, outside: float) -> Origin:
    """Returns the pitch diameter [mm] of the catalogue, or in the middle of the section."""
    if entry is not None and entry.pitch is not None:
        return Origin(entry.pitch, SOURCES[entry.source], assumed=False)
    return Origin(0.5 * (bore + outside), "mean of bore and outside diameter")


def _given_preload(preload: float, area: float) -> Origin:
    """Returns a given preload [N], with a note where it looks like one in another unit.

    area: that of `_class_area` [mm2].
    """
    heavy = PRELOAD_CLASSES["heavy"] * area
    if not preload > _EXCESSIVE * heavy > 0.0:
        return Origin(preload)
    note = f"{preload / heavy:.0f} times a heavy preload; is it in N?"
    return Origin(preload, note, assumed=False)


def _class_preload(
    entry: CatalogueBearing | None, preload_class: str | None, area: float
) -> Origin:
    """Returns the preload [N] of a class; if None, of a maker's class L, or of `light`.

    SceneError: a class that the bearing does not have.

    entry: bearing of a catalogue; if that prints no preloads, or without one, a rule gives it.
    area: balls x diameter^2 x sin(angle) [mm2].
    """
    if entry is not None and entry.preloads:
        name = preload_class or "L"  # a class that every maker has
        if name not in entry.preloads:
            classes = ", ".join(entry.preloads)
            raise refused_option("--preload-class", name, f"{classes}, {entry.maker}'s")
        return Origin(entry.preloads[name], f"{entry.maker} class {name}", assumed=False)
    name = preload_class or "light"
    if name not in PRELOAD_CLASSES:
        why = "; a maker's classes require --maker"
        if entry:
            why = f"; the catalogue gives no preload class for {entry.designation}"
        raise refused_option("--preload-class", name, ", ".join(PRELOAD_CLASSES) + why)
    density = PRELOAD_CLASSES[name]
    rule = f"{name}, {density:g} N/mm2 x number of balls x ball diameter^2 x sin(contact angle)"
    return Origin(rounded_to(density * area), rule)


def _usual_speed(
    entry: CatalogueBearing | None, dm: float, method: str, preload: float, has_film: bool
) -> Origin:
    """Returns the assumed speed [r/min]: the catalogue's limit with grease, or that of a rule.

    dm: pitch diameter [mm].
    method, preload: of the scene [N]; they reduce the limit of a catalogue.
    has_film: whether a sputtered film lubricates.
    """
    if has_film:
        rule = "60 000 mm r/min over the pitch diameter, as in a test of a film"
        return Origin(rounded_to(FILM_SPEED_FACTOR / dm), f"{rule} (docs/film_tests.md)")
    if entry is None:
        rule = "one million mm r/min divided by the pitch diameter"
        return Origin(rounded_to(SPEED_FACTOR / dm), rule)
    factor, name = entry.speed_factor(method, preload)
    rule = f"{entry.maker}'s speed limit with grease"
    if name:
        rule += f", times {factor:g} for a rigid pair of class {name}"
    limit = factor * entry.speed_grease
    return Origin(min(rounded_to(limit, 3), limit), rule)


def grooves_of(size: Designation) -> tuple[Origin, Origin]:
    """Returns the factors of the inner and the outer groove, each with its origin."""
    if size.entry is not None and size.entry.grooves:
        inner, outer = size.entry.grooves
        inner_rule, outer_rule = MAKERS[size.entry.maker].groove_rules
        return Origin(inner, inner_rule, assumed=False), Origin(outer, outer_rule, assumed=False)
    factors, rule = GROOVES, "the largest factor for which ISO 281 load ratings apply"
    if not size.name and size.bore < SMALL_BORE:
        factors = INSTRUMENT_GROOVES
        rule = "instrument bearing (Dynaroll: 0.56 +-0.03 for low torque)"
    if grooves_vary(size):
        least, largest = SMALL_GROOVES
        rule = f"{rule}; makers of small bearings use {least:g} to {largest:g}"
    inner_factor, outer_factor = factors
    return Origin(inner_factor, rule), Origin(outer_factor, rule)


def grooves_vary(size: Designation) -> bool:
    """Whether the groove factors of a bearing are too uncertain for one assumption."""
    return size.bore < SMALL_BORE and not (size.entry and size.entry.grooves)


def _is_deep_groove(size: Designation, angle: float | None, clearance: str | float | None) -> bool:
    """Whether the free contact angle comes from a radial clearance; refuses contradictions.

    angle, clearance: those of the user; None if not given.
    """
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


def _usual_balls(D: float, dm: float, deep_groove: bool) -> Origin:
    """Returns the assumed number of balls of diameter D on a pitch circle dm [mm]."""
    half_angle = math.asin(D / dm)  # of the arc that a ball takes on the pitch circle
    if deep_groove:
        # the arc lies between the centres of the first and the last ball
        balls = round(1.0 + math.radians(0.5 * CONRAD_FILL_DEG) / half_angle)
        rule = f"the balls fill {CONRAD_FILL_DEG:g} degrees (Conrad assembly)"
    else:
        balls = round(0.75 * math.pi / half_angle)
        rule = "three quarters of the maximum number"
    return Origin(max(3, balls), rule)


def _angle(size: Designation) -> Origin:
    """Returns the free contact angle [degree] of an angular contact bearing.

    It is that of the designation, else 15 degrees.
    """
    if size.angle is not None:
        return Origin(size.angle, size.angle_rule)
    return Origin(15.0, "typical of high-speed bearings")


def _clearance_angle(size: Designation, distance: float, clearance: str | float | None) -> Origin:
    """Returns the free contact angle [degree] of a deep groove bearing by its radial clearance.

    By Harris, cos(angle) = 1 - clearance / (2 distance), where `distance` [mm] of the groove
    centres is inner plus outer groove radius less ball diameter.
    """
    if clearance is None or isinstance(clearance, str):
        group = clearance or size.clearance or "CN"
        ends = clearance_range(group, size.bore)
        if ends is None:
            raise refused_option(
                "--clearance", group, "a bore of at most 200 mm, or --radial-clearance-um"
            )
        clearance_um, group_note = 0.5 * sum(ends), f" (mean of {group}, before mounting)"
    else:
        clearance_um, group_note = clearance, ""
    play = 2e3 * distance
    widest = play * (1.0 - math.cos(math.radians(LARGEST_ANGLE_DEG)))
    if not 0.0 < clearance_um <= widest:
        raise refused_option(
            "--radial-clearance-um", clearance_um, f"a number > 0 and <= {widest:.4g}"
        )
    angle = math.degrees(math.acos(1.0 - clearance_um / play))
    rule = f"from a radial clearance of {clearance_um:g} um{group_note}"
    return Origin(rounded_to(angle, 4), f"{rule}; 0 is only the nominal angle")


def seat_interference(bore: float) -> tuple[float, float] | None:
    """Returns least and largest interference [um] of `SEAT_CLASS` in a bore [mm] of class P4.

    A least one below 0 is a clearance. None for a bore above the table.
    """
    seat = _seat(bore)
    return None if seat is None else (-0.5 * seat.it4, 0.5 * seat.it4 + seat.bore)


def housing_clearance(outside: float) -> float | None:
    """Returns the mean clearance [um] of an outside diameter [mm], class P4, in `HOUSING_CLASS`.

    None for a diameter above the table.
    """
    seat = _seat(outside)
    return None if seat is None else 0.5 * (seat.it4 + seat.outside)


def _seat(diameter: float) -> SeatTolerance | None:
    """Returns the tolerances of a diameter [mm]; None above the table."""
    return next((seat for seat in _SEATS if diameter <= seat.largest_diameter), None)


def refused_option(option: str, value: float | str, allowed: str) -> SceneError:
    """Returns the error of an option of `bearingwear new`, to be raised, with the allowed values.

    allowed: words such as `a number > 0`, or a sentence that begins with `only`.
    """
    got = value if isinstance(value, str) else f"{value:g}"
    expected = f"; {allowed}" if allowed.startswith("only") else f", expected {allowed}"
    return SceneError("", f"got {got}{expected}", source=option)


def race_conductance(numbers: Mapping[str, Origin]) -> float:
    """Returns the conductance [W/K] of the dry contacts, steel on steel, of all balls with a race.

    Each contact is a heat source that moves over ball and race: Jungnickel, *Simulation des
    thermischen Verhaltens von Werkzeugmaschinen* (TU Dresden 2010), p. 175. Oil adds as much again:
    Thermca (github.com/steffenschroe/Thermca, lib/bearing.py) has 3.6 where this has 2.0.

    numbers: those of `numbers_of`.
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
    # a bearing without preload is taken to conduct as with 1 N
    load = max(preload, 1.0) / (Z * math.sin(math.radians(angle)))
    # load and speed as numbers without dimension, and the source's fit to them
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
    """Returns the heat capacities of rings and balls of a bearing with steel rings.

    The rings are taken for sleeves that end a quarter of a ball diameter from the pitch circle.
    A width that is not known is half the difference of outside diameter and bore, as in ISO 15
    within a fifth.
    """
    Z = numbers["bearing.ball_count"].value
    D = numbers["bearing.ball_diameter_mm"].value
    dm = numbers["bearing.pitch_diameter_mm"].value
    width = size.width or 0.5 * (size.outside - size.bore)

    def sleeve_capacity(inside: float, outside: float) -> float:
        """Returns the heat capacity [J/K] of a steel sleeve by its diameters [mm]."""
        volume = 0.25e-9 * math.pi * max(outside**2 - inside**2, 0.0) * width
        return volume * DENSITY["bearing_steel"] * SPECIFIC_HEAT["bearing_steel"]

    ball_volume = 1e-9 * math.pi / 6.0 * D**3
    return PartCapacities(
        inner_ring=sleeve_capacity(size.bore, dm - 0.5 * D),
        balls=Z * ball_volume * DENSITY[ball_material] * SPECIFIC_HEAT[ball_material],
        outer_ring=sleeve_capacity(dm + 0.5 * D, size.outside),
    )


def rounded_to(value: float, digits: int = 2) -> float:
    """Rounds a number to so many significant digits."""
    return float(f"{value:.{digits}g}")
