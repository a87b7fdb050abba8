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
    "bearing_steel": {
        "youngs_modulus_GPa": "208", "poisson_ratio": "0.3", "density_kg_m3": "7800",
        "brinell_hardness_GPa": "6.6", "wear_coefficient": "5.0e-6",
        "thermal_expansion_1_K": "11.5e-6",
    },
    "silicon_nitride": {
        "youngs_modulus_GPa": "310", "poisson_ratio": "0.27", "density_kg_m3": "3200",
        "brinell_hardness_GPa": "15.0", "wear_coefficient": "1.0e-6",
        "thermal_expansion_1_K": "3.2e-6",
    },
    "phenolic": {
        "youngs_modulus_GPa": "7", "poisson_ratio": "0.3", "density_kg_m3": "1350",
        "brinell_hardness_GPa": "0.3", "wear_coefficient": "1.0e-4",
    },
}  # fmt: skip


def _materials(wear: float | None) -> dict[str, str]:
    """Returns the block of each of `MATERIALS` as YAML in one line.

    wear: K_s/H of steel and silicon nitride [m2/N]; None leaves their wear coefficients.
    """
    blocks = {}
    for name, properties in MATERIALS.items():
        written = dict(properties)
        if wear is not None and name in BALL_MATERIALS:
            hardness = 1e9 * float(properties["brinell_hardness_GPa"])
            written["wear_coefficient"] = yaml_number(float(f"{wear * hardness:.3g}"))
        pairs = ", ".join(f"{key}: {text}" for key, text in written.items())
        blocks[name] = f"{{{pairs}}}"
    return blocks


class _NewScene(NamedTuple):
    """What the text of a new scene is written from."""

    size: Designation
    numbers: Mapping[str, Origin]  # by key of the scene
    rubbing: Rubbing
    given_ball_material: str | None  # None where the user gave none
    given_method: str | None  # preload method; None where the user gave none
    method: str  # preload method of the scene
    pair: str | None  # of `PAIR_KINDS`; None for a single bearing

    @property
    def ball_material(self) -> str:
        """Returns the material of the balls: given, that of the designation, or steel."""
        return self.given_ball_material or self.size.letters.ball_material or "bearing_steel"


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
    """Returns the text of a commented scene file, and a line for each assumption in it.

    bore, outside: diameters [mm], unless a designation says them.
    given: other values by key of the scene (those of `OPTIONS`), in its units.
    ball_material, preload_method: as in a scene. Bearing steel is assumed, and a constant force; a
        fixed position where a maker's class of preload is taken, which is that of a rigid pair.
    designation: as in `designation_of`: 7008C, 608; with a maker as in its catalogue: 7010C, SEA
        60.
    clearance: radial clearance of a deep groove bearing: a group of `CLEARANCES`, or the clearance
        [um].
    preload_class: of the maker, or of `assumed.PRELOAD_CLASSES`; None for the usual one.
    maker: of `catalogue.MAKERS`, whose catalogue has the designation.
    lubrication: of `coefficients.LUBRICATIONS`: wear, friction and their spread come from its
        sources.
    pair: of `PAIR_KINDS`: two of these bearings on one rotor, with the preload method of that pair.

    `checked_scene` checks the text.
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
    method = preload_method or _usual_method(size, given)
    coefficients = _rubbing(lubrication, given, ball_material or letters.ball_material)
    has_film = coefficients.film is not None
    numbers = numbers_of(size, given, clearance, preload_class, method, has_film)
    if has_film:
        del numbers[_BALL_RACE]
    elif coefficients.friction_rule and _BALL_RACE not in given:
        rule = coefficients.friction_rule
        numbers[_BALL_RACE] = Origin(coefficients.friction, rule, assumed=False)
    _check_room(numbers)
    scene = _NewScene(
        size=size,
        numbers=numbers,
        rubbing=coefficients,
        given_ball_material=ball_material,
        given_method=preload_method,
        method=method,
        pair=pair,
    )
    lines = [f"lubrication: {coefficients.summary}", *_assumption_lines(scene)]
    return _filled_template(name, scene), lines


def _usual_method(size: Designation, given: Mapping[str, float]) -> str:
    """Returns the preload method of a scene for which none is given: by default, a spring."""
    has_preload_classes = size.entry is not None and bool(size.entry.preloads)
    if has_preload_classes and "operation.preload_N" not in given:
        return "fixed_position"  # a maker's class of preload is that of a rigid pair
    return "constant_force"


def _method_of_pair(pair: str | None, preload_method: str | None, letters: str) -> str | None:
    """Returns the preload method of a pair, or that given for a single bearing.

    SceneError where another one is given, or where the designation is a tandem.

    pair: of `PAIR_KINDS`; None for a single bearing.
    preload_method: given; None if none is.
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
    """Returns the coefficients of a lubrication.

    SceneError: no source has any for the ball material, or friction is given beside a film.

    given: values of the user by key of the scene.
    """
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
    """Raises SceneError for more balls than fit on the pitch circle."""
    D, dm, Z = _balls(numbers)
    if Z > (limit := most_balls(D, dm)):
        allowed = f"at most {limit} of {D:g} mm on a pitch circle of {dm:g} mm"
        raise refused_option("--balls", Z, allowed)


def _assumption_lines(scene: _NewScene) -> list[str]:
    """Returns the lines on assumptions that `new` prints.

    They are on diameters that may be in inches, on letters of the designation, and on each value
    that was not given. Of a bearing that is from no catalogue, a line compares it with each
    catalogue bearing of the same size and contact angle.
    """
    size, numbers = scene.size, scene.numbers
    lines = []
    if inches := metric_size(size.bore, size.outside):
        lines.append(f"--bore, --outside: taken as mm; if they are in inches, write {inches}")
    if notes := _designation_notes(scene):
        lines.append(f"designation: interpreted as {size.name}; {'; '.join(notes)}")
    for key, origin in numbers.items():
        if origin.rule:
            lines.append(f"{key}: {origin.value:g}, {origin.rule}")
    if not (scene.given_ball_material or size.letters.ball_material):
        lines.append(BALLS_ASSUMED)
    if scene.given_method is None:
        lines.append(f"operation.preload_method: {scene.method}")
    lines.append(
        "materials, cage, friction.cage, operation.gravity_m_s2, fits, wear.end_of_life, "
        "uncertainty: see the file"
    )
    if size.entry is None:
        D, _, Z = _balls(numbers)
        angle = numbers["bearing.contact_angle_deg"].value
        lines += [
            _comparison_line(entry, D, Z) for entry in same_size(size.bore, size.outside, angle)
        ]
    return lines


def _designation_notes(scene: _NewScene) -> list[str]:
    """Returns the meaning of each group of letters in a designation, and what is not known."""
    size = scene.size
    notes = size.letters.explanations(is_in_pair=scene.pair is not None)
    load = size.letters.load
    if load and load not in CLASS_OF_LETTER and not (size.entry and size.entry.preloads):
        notes.append(f"no rule for class {load}, so that of light is taken; --preload states yours")
    if size.entry is not None:
        notes.append(f"with the values of {size.entry.maker}'s catalogue")
    elif gmn_parts(size.name):
        notes.append("not in GMN's catalogue")
    return notes


def _comparison_line(entry: CatalogueBearing, D: float, Z: int) -> str:
    """Returns a line that compares a maker's bearing with one of Z balls of diameter D [mm].

    Both have the same contact angle.
    """
    rated = Z ** (2.0 / 3.0) * D ** (1.0 / 3.0)  # as `CatalogueBearing.rated`
    return (
        f"{entry.maker}'s {entry.designation} has {entry.balls} balls of {entry.ball:.4g} mm "
        f"({entry.source}); at equal preload, its axial rigidity differs by "
        f"{100.0 * (entry.rated / rated - 1.0):+.1f} %; use --maker {entry.maker} for this bearing"
    )


def write_scene(path: str | os.PathLike[str], **arguments: Any) -> list[str]:
    """Writes the text of `scene_text` to a new file, and returns its lines on assumptions.

    The scene has no name of its own, so a copy is named as its file.

    **arguments: parameters of `scene_text` except the name.

    OutputError: the file's name is no name of a scene, it is there already, or cannot be
    written.
    """
    from bearingwear.atomic import OutputError, write_text

    path = Path(path)
    if path.suffix not in SCENE_SUFFIXES or not re.search(NAME, path.stem):
        problem = f"got this name, expected NAME.yaml, where NAME consists of {NAME_RULE}"
        raise OutputError(f"{path}: {problem}")
    text, assumed = scene_text("", **arguments)
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
    """Returns requirements that a bearing at rest, with its preload, roughly satisfies.

    The axial stiffness is that of one steel bearing, by the approach 0.00044
    (Q^2/D)^(1/3)/sin(alpha) of the rings [N, mm], as makers' catalogues have it (NSK, Rolling
    Bearings), rounded to one digit. It is 1 N/um for a bearing without preload or contact angle.
    """
    pressure = FILM_PRESSURE_GPA if scene.friction.film else USUAL_PRESSURE_GPA
    bearing, preload = scene.bearing, scene.operation.preload_N
    sine = math.sin(math.radians(bearing.contact_angle_deg))
    if not (sine > 0.0 and preload > 0.0):
        return UsualLimits(1.0, pressure)
    ball_load = preload / (bearing.ball_count * sine)
    approach_um = 0.44 * (ball_load**2 / bearing.ball_diameter_mm) ** (1.0 / 3.0) / sine
    # the approach goes with the power 2/3 of the preload, so the slope is 3/2 of the quotient
    return UsualLimits(rounded_to(1.5 * preload / approach_um, 1), pressure)


@functools.cache
def _template() -> Template:
    """Loads the template of a scene file."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    folder = FileSystemLoader(Path(__file__).parent)
    jinja = Environment(loader=folder, undefined=StrictUndefined, keep_trailing_newline=True)
    return jinja.get_template("new_scene.yaml.j2")


def _filled_template(name: str, scene: _NewScene) -> str:
    """Returns the text of a scene: its template with all values filled in.

    name: of the scene; "" leaves the key out.
    """
    size, numbers = scene.size, scene.numbers
    D, dm, Z = _balls(numbers)
    gap = dm * math.sin(math.pi / Z) - D  # between neighbouring balls
    return _template().render(
        name=json.dumps(name) if name else "",  # quoted: 7008, true and null are names, too
        size=size,
        line=lambda key: _line(key, numbers[key]),
        rounded=lambda value: yaml_number(rounded_to(value, 4)),
        D=D,
        dm=dm,
        ball_race=race_conductance(numbers),
        heat=heat_capacities(numbers, size, scene.ball_material),
        groove_ends=SMALL_GROOVES if grooves_vary(size) else None,
        speed=numbers["operation.shaft_speed_rpm"],
        # assumed pocket clearance [mm]: 5 % of the ball diameter, but at most half of the gap
        # between balls, which leaves the other half for the cage; rounded down to three decimals
        pocket=yaml_number(math.floor(1e3 * min(0.05 * D, 0.5 * gap)) / 1e3),
        ball_material=scene.ball_material,
        ball_note=_ball_note(scene.given_ball_material, size),
        preload_method=scene.method,
        method_given=scene.given_method is not None,
        pair_kind=PAIRS[scene.method],
        is_pair=scene.pair is not None,
        seat_range=_seat_range(size.bore),
        housing=_housing_line(size.outside) if size.outside > dm + D else "0.0",
        materials=dict.fromkeys((scene.ball_material, "bearing_steel", "phenolic")),
        MATERIALS=_materials(scene.rubbing.wear),
        film=scene.rubbing.film,
        spread=scene.rubbing.spread,
        dry_rule=scene.rubbing.rule,
    )


def _seat_range(bore: float) -> str:
    """Returns a clause on the interference of a usual seat; "" for a bore beyond the table.

    bore: [mm].
    """
    ends = seat_interference(bore)
    if ends is None:
        return ""
    low, high = ends
    return (
        f"; a shaft {SEAT_CLASS} in a bore of class P4 gives {low:+g} to {high:+g} um, "
        f"{0.5 * (low + high):g} in the mean (ISO 286, ISO 492), and fast spindles need more"
    )


def _housing_line(outside: float) -> str:
    """Returns the assumed interference in the housing [um] with a comment on its source.

    outside: diameter [mm].
    """
    gap = housing_clearance(outside)
    if gap is None:
        return "0.0"
    return f"{-gap:.1f}  # assumed: a housing {HOUSING_CLASS} round class P4, in the mean"


def _ball_note(ball_material: str | None, size: Designation) -> str:
    """Returns a comment on the origin of the ball material.

    ball_material: given by the user; None if not.
    """
    if ball_material:
        return "given"
    letters = size.letters.ball_letters
    return f"from the designation ({letters})" if letters else "assumed"


def _balls(numbers: Mapping[str, Origin]) -> tuple[float, float, int]:
    """Returns ball diameter, pitch diameter [mm] and the number of balls."""
    return (
        numbers["bearing.ball_diameter_mm"].value,
        numbers["bearing.pitch_diameter_mm"].value,
        int(numbers["bearing.ball_count"].value),
    )


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
    """Returns a line of the scene: the last part of a key, its number, and a comment on that."""
    part = key_of_scene(key)
    is_integer = part is not None and part.kind == "integer"
    value = str(int(origin.value)) if is_integer else yaml_number(float(origin.value))
    return f"{key.rpartition('.')[2]}: {value}  {origin.note}"


def checked_scene(text: str, note: str = "") -> Scene:
    """Returns the checked scene of a text from `scene_text`, with a note after its description.

    SceneError: one line that names the option which sets the key at fault, or `--bore, --outside`.
    """
    from bearingwear.scene.checking.strict_yaml import data_of
    from bearingwear.scene.read import scene_from_dict

    data = data_of(text, "scene")
    try:
        return scene_from_dict(data | {"description": f"{data['description']} {note}"})
    except SceneError as error:
        # bore and outside diameter decide what no option names
        options = [_option(key) for key in (error.key, *error.involved)]
        option = next(filter(None, options), "--bore, --outside")
        raise SceneError(error.key, error.problem, error.involved, option) from None
