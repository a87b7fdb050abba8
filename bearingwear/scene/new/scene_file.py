"""A scene from a few numbers of a catalogue; stated rules assume the others.

Importing this file imports nothing heavy: the command line takes its options from it.
"""

from __future__ import annotations

import functools
import json
import math
import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from bearingwear.scene.arrangement import METHODS, PAIRS
from bearingwear.scene.checking.check import fits, misfit_words
from bearingwear.scene.checking.errors import SceneError, yaml_number
from bearingwear.scene.checking.records import NAME, NAME_RULE, SCENE_SUFFIXES
from bearingwear.scene.coefficients import Rubbing, rubbing
from bearingwear.scene.new.assumed import (
    HOUSING_CLASS,
    SEAT_CLASS,
    SMALL_GROOVES,
    Designation,
    Origin,
    grooves_vary,
    heat_capacities,
    housing_clearance,
    numbers_of,
    race_conductance,
    refused_option,
    rounded_to,
    seat_interference,
    size_of,
)
from bearingwear.scene.new.catalogue import CatalogueBearing, same_size
from bearingwear.scene.new.designations import metric_size
from bearingwear.scene.new.letters import CLASS_OF_LETTER, gmn_parts
from bearingwear.scene.scene import key_of_scene, most_balls

if TYPE_CHECKING:
    from jinja2 import Template

    from bearingwear.scene.scene import Scene

BALL_MATERIALS = ("bearing_steel", "silicon_nitride")

PAIR_KINDS = {"spring": "spring_pair", "rigid": "rigid_pair"}
"""Kinds of an arrangement by their names in `new --pair`."""

BALLS_ASSUMED = "bearing.ball_material: bearing_steel"

OPTIONS = (
    ("--balls", "bearing.ball_count", "Z", "number of balls"),
    ("--ball-diameter", "bearing.ball_diameter_mm", "MM", "ball diameter"),
    ("--pitch-diameter", "bearing.pitch_diameter_mm", "MM", "pitch diameter"),
    (
        "--contact-angle",
        "bearing.contact_angle_deg",
        "DEG",
        "free contact angle (0: a deep groove "
        "bearing, whose free angle follows from its clearance)",
    ),
    ("--speed", "operation.shaft_speed_rpm", "RPM", "shaft speed"),
    ("--preload", "operation.preload_N", "N", "initial axial preload"),
    ("--friction", "friction.ball_race", "MU", "Coulomb ball-race friction coefficient"),
)
"""What `new` takes beside bore and outside diameter: option, key of the scene, metavar, meaning."""

_BALL_RACE = "friction.ball_race"

MATERIALS = {
    "bearing_steel": "{youngs_modulus_GPa: 208, poisson_ratio: 0.3, density_kg_m3: 7800, "
    "brinell_hardness_GPa: 6.6, wear_coefficient: 5.0e-6, thermal_expansion_1_K: 11.5e-6}",
    "silicon_nitride": "{youngs_modulus_GPa: 310, poisson_ratio: 0.27, density_kg_m3: 3200, "
    "brinell_hardness_GPa: 15.0, wear_coefficient: 1.0e-6, thermal_expansion_1_K: 3.2e-6}",
    "phenolic": "{youngs_modulus_GPa: 7, poisson_ratio: 0.3, density_kg_m3: 1350, "
    "brinell_hardness_GPa: 0.3, wear_coefficient: 1.0e-4}",
}


def _materials(wear: float | None) -> dict[str, str]:
    """Returns `MATERIALS` with a common K_s/H [m2/N] of steel and silicon nitride."""
    if wear is None:
        return MATERIALS
    materials = dict(MATERIALS)
    for name in BALL_MATERIALS:
        hardness = float(re.findall(r"brinell_hardness_GPa: ([\d.]+)", materials[name])[0])
        coefficient = yaml_number(float(f"{wear * hardness * 1e9:.3g}"))
        materials[name] = re.sub(
            r"wear_coefficient: [\de.+-]+", f"wear_coefficient: {coefficient}", materials[name]
        )
    return materials


def scene_text(
    name: str,
    bore: float | None,
    outside: float | None,
    given: Mapping[str, float],
    ball_material: str | None = None,
    preload_method: str | None = None,
    *,
    designation: str | None = None,
    clearance: str | float | None = None,
    preload_class: str | None = None,
    maker: str | None = None,
    lubrication: str | None = None,
    pair: str | None = None,
) -> tuple[str, list[str]]:
    """Writes a commented scene file as text, and a line for each assumption in it.

    bore, outside: diameters [mm], unless a designation says them.
    given: other values by key of the scene (those of `OPTIONS`), in its units.
    ball_material, preload_method: as in a scene. Bearing steel is assumed, and a constant force; a
        fixed position where a maker's class of preload is taken, which is that of a rigid pair.
    designation: as in `designation_of`: 7008C, 608; with a maker as in its catalogue: 7010C, SEA
        60.
    clearance: radial clearance of a deep groove bearing: a group of `CLEARANCES`, or the clearance
        [um].
    lubrication: of `coefficients.LUBRICATIONS`: wear, friction and their spread come from its
        sources.
    pair: of `PAIR_KINDS`: two of these bearings on one rotor, with the preload method of that pair.

    Returns `text`: to be checked by `checked_scene`.
    SceneError: one line that names the option, what was given and what is allowed.
    """
    angle = given.get("bearing.contact_angle_deg")
    size = size_of(designation, bore, outside, maker, angle)
    letters = size.letters
    if letters.ball_material is not None and ball_material not in (None, letters.ball_material):
        expected = f"{letters.ball_material}, because of {letters.ball_letters} in the designation"
        raise refused_option("--ball-material", ball_material or "", expected)
    for key in given:
        _check_range(key, given[key])
    preload_method = _method_of_pair(pair, preload_method, letters.pair)
    # a maker's class of preload is that of a rigid pair
    rigid = size.entry is not None and size.entry.preloads and "operation.preload_N" not in given
    method = preload_method or ("fixed_position" if rigid else "constant_force")
    rubs = _rubbing(lubrication, given, ball_material or letters.ball_material)
    numbers = numbers_of(size, given, clearance, preload_class, method, rubs.film is not None)
    if rubs.friction_rule and _BALL_RACE not in given:
        numbers[_BALL_RACE] = Origin(rubs.friction, rubs.friction_rule, assumed=False)
    if rubs.film:
        del numbers[_BALL_RACE]
    _check_room(numbers)
    text = _filled_template(name, size, numbers, ball_material, preload_method, method, rubs, pair)
    lubricated = f"lubrication: {rubs.summary}"
    return text, [
        lubricated,
        *_assumption_lines(size, numbers, ball_material, preload_method, method, pair),
    ]


def _method_of_pair(pair: str | None, preload_method: str | None, letters: str) -> str | None:
    """Returns the preload method of a pair, or that given for a single bearing.

    letters: those of the arrangement in the designation.
    """
    if pair is None:
        return preload_method
    method = METHODS[PAIR_KINDS[pair]]
    if preload_method not in (None, method):
        raise refused_option("--preload-method", preload_method or "", f"{method} in a {pair} pair")
    if letters == "DT":
        problem = (
            "only allowed without DT (tandem): the two bearings share a force, and none preloads"
        )
        raise refused_option("--pair", pair, f"{problem} the other")
    return method


def _rubbing(
    lubrication: str | None, given: Mapping[str, float], ball_material: str | None
) -> Rubbing:
    """Returns the coefficients of a lubrication; refuses one for which no source has any."""
    if lubrication == "mos2" and _BALL_RACE in given:
        raise refused_option(
            "--friction", given[_BALL_RACE], f"only allowed without --lubrication {lubrication}"
        )
    try:
        return rubbing(lubrication, ball_material)
    except KeyError:
        expected = f"bearing_steel with --lubrication {lubrication}"
        raise refused_option("--ball-material", ball_material or "", expected) from None


def _check_room(numbers: Mapping[str, Origin]) -> None:
    """Refuses more balls than there is room for."""
    D, dm, Z = _balls(numbers)
    if Z > (limit := most_balls(D, dm)):
        allowed = f"at most {limit} of {D:g} mm on a pitch circle of {dm:g} mm"
        raise refused_option("--balls", Z, allowed)


def _assumption_lines(
    size: Designation,
    numbers: Mapping[str, Origin],
    ball_material: str | None,
    preload_method: str | None,
    method: str,
    pair: str | None,
) -> list[str]:
    """Returns a line for each value that was not given."""
    lines = []
    notes = size.letters.meanings(is_in_pair=pair is not None)
    load = size.letters.load
    if load and load not in CLASS_OF_LETTER and not (size.entry and size.entry.preloads):
        notes.append(f"no rule for class {load}, so that of light is taken; --preload states yours")
    if size.entry is None and gmn_parts(size.name):
        notes.append("not in GMN's catalogue")
    if inches := metric_size(size.bore, size.outside):
        lines.append(f"--bore, --outside: taken as mm; if they are in inches, write {inches}")
    if notes:
        lines.append(f"designation: interpreted as {size.name}; {'; '.join(notes)}")
    lines += [
        *(f"{key}: {o.value:g}, {o.rule}" for key, o in numbers.items() if o.rule),
        *([] if ball_material or size.letters.ball_material else [BALLS_ASSUMED]),
        *([f"operation.preload_method: {method}"] if preload_method is None else []),
        "materials, cage, friction.cage, operation.gravity_m_s2, fits, wear.end_of_life, "
        "uncertainty: "
        "see the file",
    ]
    if size.entry is None:
        D, dm, Z = _balls(numbers)
        same_size_bearings = same_size(
            size.bore, size.outside, numbers["bearing.contact_angle_deg"].value
        )
        lines += [_comparison_line(entry, D, Z) for entry in same_size_bearings]
    return lines


def _comparison_line(entry: CatalogueBearing, D: float, Z: int) -> str:
    """Compares a maker's bearing of the size with Z balls of diameter D [mm], in one line."""
    rated = Z ** (2.0 / 3.0) * D ** (1.0 / 3.0)
    return (
        f"{entry.maker}'s {entry.designation} has {entry.balls} balls of {entry.ball:.4g} mm "
        f"({entry.source}); at equal preload, its axial rigidity differs by "
        f"{100.0 * (entry.rated / rated - 1.0):+.1f} %; use --maker {entry.maker} for this bearing"
    )


def write_scene(path: str | os.PathLike[str], **known: Any) -> list[str]:
    """Writes the text of `scene_text` to a new file.

    The scene has no name of its own, so a copy is named as its file.

    Returns: what was assumed, a line each.
    OutputError: the file's name is no name of a scene, it is there already, or cannot be
    written.
    """
    from bearingwear.atomic import OutputError, write_text

    path = Path(path)
    if path.suffix not in SCENE_SUFFIXES or not re.search(NAME, path.stem):
        problem = f"got this name, expected NAME.yaml, where NAME consists of {NAME_RULE}"
        raise OutputError(f"{path}: {problem}")
    text, assumed = scene_text("", **known)
    checked_scene(text)
    if "\0" not in str(path) and os.path.lexists(path):
        raise OutputError(
            f"{path}: already exists and will not be overwritten; choose another name"
        )
    write_text(path, text)
    return assumed


USUAL_PRESSURE_GPA, FILM_PRESSURE_GPA = 2.0, 1.5
"""Contact pressure that `new` suggests as a requirement: the usual maximum for a long life of steel
(assumed), and that of the tests of sputtered MoS2, above which its life falls steeply."""


class UsualLimits(NamedTuple):
    """Requirements that `new` suggests."""

    stiffness: float  # of the arrangement [N/um]
    pressure: float  # [GPa]


def usual_limits(scene: Scene) -> UsualLimits:
    """Returns requirements that a bearing with its preload at rest about satisfies.

    The axial stiffness is that of one steel bearing, by the approach 0.00044
    (Q^2/D)^(1/3)/sin(alpha) of the rings [N, mm], as makers' catalogues have it (NSK, Rolling
    Bearings).
    """
    pressure = FILM_PRESSURE_GPA if scene.friction.film else USUAL_PRESSURE_GPA
    b, preload = scene.bearing, scene.operation.preload_N
    sine = math.sin(math.radians(b.contact_angle_deg))
    if not (sine > 0.0 and preload > 0.0):
        return UsualLimits(1.0, pressure)
    load = preload / (b.ball_count * sine)
    approach_um = 0.44 * (load**2 / b.ball_diameter_mm) ** (1.0 / 3.0) / sine
    return UsualLimits(rounded_to(1.5 * preload / approach_um, 1), pressure)


@functools.cache
def _template() -> Template:
    """Loads the template of a scene file."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    folder = FileSystemLoader(Path(__file__).parent)
    jinja = Environment(loader=folder, undefined=StrictUndefined, keep_trailing_newline=True)
    return jinja.get_template("new_scene.yaml.j2")


def _filled_template(
    name: str,
    size: Designation,
    numbers: Mapping[str, Origin],
    ball_material: str | None,
    preload_method: str | None,
    method: str,
    rubs: Rubbing,
    pair: str | None,
) -> str:
    """Fills in the template of a scene."""
    D, dm, Z = _balls(numbers)
    room = dm * math.sin(math.pi / Z) - D
    return _template().render(
        name=name and json.dumps(name),  # quoted: 7008, true and null are names, too
        size=size,
        line=lambda key: _line(key, numbers[key]),
        rounded=lambda value: yaml_number(rounded_to(value, 4)),
        D=D,
        dm=dm,
        ball_race=race_conductance(numbers),
        heat=heat_capacities(
            numbers, size, ball_material or size.letters.ball_material or "bearing_steel"
        ),
        groove_ends=SMALL_GROOVES if grooves_vary(size) else None,
        speed=numbers["operation.shaft_speed_rpm"],
        # pockets that leave something of the cage between them, rounded down to three decimals
        pocket=yaml_number(math.floor(1e3 * min(0.05 * D, 0.5 * room)) / 1e3),
        ball_material=ball_material or size.letters.ball_material or "bearing_steel",
        ball_note=_ball_note(ball_material, size),
        preload_method=method,
        method_given=preload_method is not None,
        pair_kind=PAIRS[method],
        is_pair=pair is not None,
        seat_range=_seat_range(size.bore),
        housing=_housing_line(size.outside) if size.outside > dm + D else "0.0",
        materials=dict.fromkeys(
            (
                ball_material or size.letters.ball_material or "bearing_steel",
                "bearing_steel",
                "phenolic",
            )
        ),
        MATERIALS=_materials(rubs.wear),
        film=rubs.film,
        spread=rubs.spread,
        dry_rule=rubs.rule,
    )


def _seat_range(bore: float) -> str:
    """Returns words on the usual seat of a spindle bearing; "" for a bore beyond the table."""
    ends = seat_interference(bore)
    if ends is None:
        return ""
    low, high = ends
    return (
        f"; a shaft {SEAT_CLASS} in a bore of class P4 gives {low:+g} to {high:+g} um, "
        f"{0.5 * (low + high):g} in the mean (ISO 286, ISO 492), and fast spindles need more"
    )


def _housing_line(outside: float) -> str:
    """Returns the assumed clearance in the housing and its source as a line of the scene."""
    gap = housing_clearance(outside)
    if gap is None:
        return "0.0"
    return f"{-gap:.1f}  # assumed: a housing {HOUSING_CLASS} round class P4, in the mean"


def _ball_note(ball_material: str | None, size: Designation) -> str:
    """Returns a comment on the origin of the ball material."""
    if ball_material:
        return "given"
    letters = size.letters.ball_letters
    return f"from the designation ({letters})" if letters else "assumed"


def _balls(numbers: Mapping[str, Origin]) -> tuple[float, float, int]:
    """Returns ball diameter, pitch diameter [mm] and the number of balls."""
    D, dm, Z = (
        numbers[f"bearing.{key}"].value
        for key in ("ball_diameter_mm", "pitch_diameter_mm", "ball_count")
    )
    return D, dm, int(Z)


def _option(key: str) -> str:
    """Returns the option of a key of the scene; "" if it has none."""
    return next((option for option, option_key, *_ in OPTIONS if option_key == key), "")


def _check_range(key: str, value: float) -> None:
    """Refuses a number that its key of the scene does not allow; the error names the option."""
    part = key_of_scene(key)
    if part is not None and not fits(value, part):
        problem = misfit_words(value, part, key.rpartition(".")[2])
        raise SceneError("", problem, source=_option(key))


def _line(key: str, origin: Origin) -> str:
    """Writes a number of the scene with a comment on its origin."""
    part = key_of_scene(key)
    is_integer = part is not None and part.kind == "integer"
    value = str(int(origin.value)) if is_integer else yaml_number(float(origin.value))
    return f"{key.rpartition('.')[2]}: {value}  {origin.note}"


def checked_scene(text: str, note: str = "") -> Scene:
    """Checks a text from `scene_text` and returns its scene, with a note after its description.

    SceneError: one line that names the option.
    """
    from bearingwear.scene.checking.strict_yaml import data_of
    from bearingwear.scene.read import scene_from_dict

    data = data_of(text, "scene")
    try:
        return scene_from_dict(data | {"description": f"{data['description']} {note}"})
    except SceneError as error:
        # bore and outside diameter decide what no option names
        option = next(filter(None, map(_option, (error.key, *error.involved))), "--bore, --outside")
        raise SceneError(error.key, error.problem, error.involved, option) from None
