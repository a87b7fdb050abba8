"""A scene from the few numbers of a bearing catalogue, the others assumed by stated rules.

Importing this file imports nothing heavy: the command line takes its options from it.
"""

from __future__ import annotations

import json
import math
import os
import re
from dataclasses import dataclass
from pathlib import Path

from bearingwear.scene.checking import fits
from bearingwear.scene.errors import SceneError, yaml_number
from bearingwear.scene.scene import key_of_scene, most_balls

BALL_MATERIALS = ("bearing_steel", "silicon_nitride")

OPTIONS = (
    ("--balls", "bearing.ball_count", "Z", "number of balls"),
    ("--ball-diameter", "bearing.ball_diameter_mm", "MM", "ball diameter"),
    ("--pitch-diameter", "bearing.pitch_diameter_mm", "MM", "pitch diameter"),
    ("--contact-angle", "bearing.contact_angle_deg", "DEG", "free contact angle"),
    ("--speed", "operation.shaft_speed_rpm", "RPM", "speed of the shaft"),
    ("--preload", "operation.preload_N", "N", "axial preload, initial"),
    ("--friction", "friction.ball_race", "MU", "Coulomb coefficient of ball and race"),
)
"""What `new` takes beside bore and outside diameter: option, key of the scene, metavar, meaning."""

MATERIALS = {
    "bearing_steel": "{youngs_modulus_GPa: 208, poisson_ratio: 0.3, density_kg_m3: 7800, "
    "brinell_hardness_GPa: 6.6, wear_coefficient: 5.0e-6}",
    "silicon_nitride": "{youngs_modulus_GPa: 310, poisson_ratio: 0.27, density_kg_m3: 3200, "
    "brinell_hardness_GPa: 15.0, wear_coefficient: 1.0e-6}",
    "phenolic": "{youngs_modulus_GPa: 7, poisson_ratio: 0.3, density_kg_m3: 1350, "
    "brinell_hardness_GPa: 0.3, wear_coefficient: 1.0e-4}",
}

SPEED_FACTOR = 1.0e6
"""Speed times pitch diameter [mm r/min] that is assumed: a fast spindle."""

PRELOAD_DENSITY = 0.5
"""Preload over (ball count x ball diameter squared x sine of the contact angle) [N/mm2] that is
assumed; equal for all sizes, it means an equal pressure: about 1 GPa between steel parts."""


@dataclass(frozen=True)
class Origin:
    """A number, and the rule it was made by; no rule where it was given."""

    value: float
    rule: str = ""

    @property
    def note(self) -> str:
        """The comment beside it."""
        return f"# assumed: {self.rule}" if self.rule else "# given"


def numbers_of(bore: float, outside: float, given: dict[str, float]) -> dict[str, Origin]:
    """Every number of `OPTIONS`, given or made by its rule.

    Parameters
    ----------
    bore, outside : float
        Diameters [mm].
    given : dict
        By key of the scene, in its units.

    Raises
    ------
    SceneError
        Diameters that leave no room.
    """
    if not 0.0 < bore < math.inf:
        raise _refused("--bore", bore, "a number > 0")
    if not bore < outside < math.inf:
        raise _refused("--outside", outside, f"a number > {bore:g}, the bore")
    found: dict[str, Origin] = {}

    def decide(key: str, value: float, rule: str) -> float:
        found[key] = Origin(given[key]) if key in given else Origin(value, rule)
        return found[key].value

    section = 0.5 * (outside - bore)
    D = decide(
        "bearing.ball_diameter_mm", _rounded(0.6 * section), "0.3 of (outside diameter - bore)"
    )
    if not 0.0 < D < section:
        raise _refused("--ball-diameter", D, f"a number > 0 and < {section:g}, half of the section")
    dm = decide(
        "bearing.pitch_diameter_mm", 0.5 * (bore + outside), "mean of bore and outside diameter"
    )
    if not bore + D < dm < outside - D:
        raise _refused("--pitch-diameter", dm, f"a number > {bore + D:g} and < {outside - D:g}")
    Z = decide(
        "bearing.ball_count",
        max(3, round(0.75 * math.pi / math.asin(D / dm))),
        "three quarters of the balls that would touch each other",
    )
    angle = decide("bearing.contact_angle_deg", 15.0, "usual of high-speed bearings")
    decide(
        "operation.shaft_speed_rpm",
        _rounded(SPEED_FACTOR / dm),
        "a million mm r/min over the pitch diameter",
    )
    decide(
        "operation.preload_N",
        _rounded(PRELOAD_DENSITY * Z * D**2 * math.sin(math.radians(angle))),
        f"light, {PRELOAD_DENSITY:g} N/mm2 x balls x ball diameter^2 x sin(contact angle)",
    )
    decide("friction.ball_race", 0.08, "starved or solid-lubricated steel")
    return found


def scene_text(
    name: str,
    bore: float,
    outside: float,
    given: dict[str, float],
    ball_material: str | None = None,
    preload_method: str | None = None,
) -> tuple[str, list[str]]:
    """A commented scene file, and a line for each thing in it that was assumed.

    Parameters
    ----------
    name : str
        Of the scene.
    bore, outside : float
        Diameters [mm].
    given : dict
        What else is known, by key of the scene (those of `OPTIONS`), in its units.
    ball_material, preload_method : str, optional
        As in a scene; bearing steel and a constant force are assumed.

    Returns
    -------
    text : str
        A scene that passes `bearingwear check`.
    assumed : list of str

    Raises
    ------
    SceneError
        One line that names the option, what was given and what is allowed.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    for key in given:
        _check_range(key, given[key])
    numbers = numbers_of(bore, outside, given)
    D = numbers["bearing.ball_diameter_mm"].value
    dm = numbers["bearing.pitch_diameter_mm"].value
    Z = int(numbers["bearing.ball_count"].value)
    if Z > (most := most_balls(D, dm)):
        raise _refused("--balls", Z, f"at most {most} of {D:g} mm on a pitch circle of {dm:g} mm")
    folder = FileSystemLoader(Path(__file__).parent)
    jinja = Environment(loader=folder, undefined=StrictUndefined, keep_trailing_newline=True)
    text = jinja.get_template("new_scene.yaml.j2").render(
        name=json.dumps(name),  # quoted: 7008, true and null are names, too
        bore=bore,
        outside=outside,
        line=lambda key: _line(key, numbers[key]),
        rounded=lambda value: yaml_number(_rounded(value, 4)),
        D=D,
        dm=dm,
        # pockets that leave something of the cage between them, to three decimals
        pocket=_down(min(0.05 * D, 0.5 * (dm * math.sin(math.pi / Z) - D))),
        ball_material=ball_material,
        preload_method=preload_method,
        materials=dict.fromkeys((ball_material or "bearing_steel", "bearing_steel", "phenolic")),
        MATERIALS=MATERIALS,
    )
    _check(text)
    assumed = [f"{key}: {o.value:g}, {o.rule}" for key, o in numbers.items() if o.rule]
    assumed += [
        "bearing.inner_groove_factor, bearing.outer_groove_factor: 0.52, 0.53, as ISO 281 rates",
        *(["bearing.ball_material: bearing_steel"] if ball_material is None else []),
        *(["operation.preload_method: constant_force"] if preload_method is None else []),
        "materials, cage, friction.cage, wear.end_of_life: see the file",
    ]
    return text, assumed


def write_scene(
    path: str | os.PathLike[str],
    bore: float,
    outside: float,
    given: dict[str, float],
    ball_material: str | None = None,
    preload_method: str | None = None,
) -> list[str]:
    """Write what `scene_text` makes to a file that is not there yet, named after it.

    Returns
    -------
    list of str
        What was assumed, a line each.

    Raises
    ------
    SceneError
        As `scene_text`, or the file's name makes no name for a scene.
    OutputError
        The file is there already, or cannot be written.
    """
    from bearingwear.atomic import OutputError, write_text

    path = Path(path)
    name = re.sub(r"[^A-Za-z0-9_-]+", "_", path.stem).strip("_-")[:64]
    if path.suffix not in (".yaml", ".yml") or not name:
        raise OutputError(f"{path}: given this name; allowed NAME.yaml, its name that of the scene")
    text, assumed = scene_text(name, bore, outside, given, ball_material, preload_method)
    if "\0" not in str(path) and os.path.lexists(path):
        raise OutputError(f"{path}: is there already, and is not replaced; allowed a new name")
    write_text(path, text)
    return assumed


def _refused(option: str, value: float, what: str) -> SceneError:
    return SceneError("", f"given {value:g}; allowed {what}", source=option)


def _option(key: str) -> str:
    return next((option for option, known, *_ in OPTIONS if known == key), "")


def _check_range(key: str, value: float) -> None:
    """What the scene says about one number, as an error that names the option."""
    part = key_of_scene(key)
    if part is not None and not fits(value, part):
        raise _refused(_option(key), value, part.allowed)


def _line(key: str, origin: Origin) -> str:
    """A number of the scene, and where it comes from."""
    part = key_of_scene(key)
    whole = part is not None and part.kind == "integer"
    value = str(int(origin.value)) if whole else yaml_number(float(origin.value))
    return f"{key.rpartition('.')[2]}: {value}  {origin.note}"


def _check(text: str) -> None:
    from bearingwear.scene.read import scene_from_dict
    from bearingwear.scene.strict_yaml import data_of

    try:
        scene_from_dict(data_of(text, "scene"), "scene")
    except SceneError as error:
        # bore and outside diameter decide what no option names
        option = next(filter(None, map(_option, (error.key, *error.involved))), "--bore, --outside")
        raise SceneError(error.key, error.problem, error.involved, option) from None


def _rounded(value: float, digits: int = 2) -> float:
    """A number to so many significant digits."""
    return float(f"{value:.{digits}g}")


def _down(value: float) -> str:
    """A clearance to three decimals, never above what it was."""
    return yaml_number(math.floor(1e3 * value) / 1e3)
