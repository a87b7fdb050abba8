"""The scene: one bearing, how it runs, and how worn it is.

The fields of `Scene` and of its blocks are the one table of keys: meaning, unit, range and default
of each (`bearingwear.scene.checking.records`). What several values must fulfil together is checked
here, whoever builds the scene.
"""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from html import escape
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

from bearingwear.scene.accuracy import FIDELITIES, Model, check_model
from bearingwear.scene.arrangement import Arrangement, check_arrangement, sides_of
from bearingwear.scene.blocks import (
    COUNTS,
    PRELOAD_METHODS,
    Bearing,
    Cage,
    Calibrated,
    EndOfLife,
    Lubricant,
    Material,
    Operation,
    Wear,
)
from bearingwear.scene.cases import checked_cases, scenes_of_cases
from bearingwear.scene.checking.errors import SceneError, did_you_mean, leaves
from bearingwear.scene.checking.records import (
    NAME,
    Part,
    file_part,
    keyed,
    part_at,
    record_hash,
    reduced_record,
    setting,
)
from bearingwear.scene.duty import Duty, check_duty
from bearingwear.scene.friction import Friction, check_films
from bearingwear.scene.requirements import Drive, Launch
from bearingwear.scene.uncertain import (
    PARAMETERS,
    UNCERTAIN,
    UNCERTAIN_CAGE,
    WORN,
    Distribution,
    check_uncertainty,
    nominal_value,
)
from bearingwear.scene.warmth import Fits, Temperature, Thermal, check_warmth

__all__ = [
    "COUNTS",
    "FIDELITIES",
    "LARGEST_LOSS",
    "PARAMETERS",
    "PRELOAD_METHODS",
    "UNCERTAIN",
    "WORN",
    "Arrangement",
    "Bearing",
    "Cage",
    "Distribution",
    "EndOfLife",
    "Friction",
    "Lubricant",
    "Material",
    "Model",
    "Operation",
    "Scene",
    "SceneError",
    "Wear",
    "key_of_scene",
    "most_balls",
    "cached_in_scene",
]

LARGEST_LOSS = 0.1
"""Largest loss of ball diameter that is accepted, as a fraction of the ball diameter."""

IS_CHECKED = "_is_checked"
"""Marks a scene that was checked; `dataclasses.replace` makes one without it."""

Value = TypeVar("Value")

NO_CONTROL = r"^[^\u0000-\u0008\u000b-\u001f\u007f-\u009f\u2028\u2029]*$"


@keyed
class Scene:
    """A bearing, its operating conditions and its state of wear.

    Contradictory values raise a SceneError, such as balls that do not fit on the pitch circle, or a
    missing material.
    """

    # fmt: off
    name: str = setting("Name of the scene (if omitted, the name of its file)", pattern=NAME,
        default="bearing")
    description: str = setting("Description of the scene and of the sources of its values",
        pattern=NO_CONTROL, longest=4000,
        allowed="text of at most 4000 characters without control characters", default="")
    bearing: Bearing = setting("Nominal, unworn geometry and materials of the bearing")
    materials: Mapping[str, Material] = setting("Materials, each in a block under its own name",
        least=1, each="One material, under a name of your choice (letters, digits, _ and -)",
        example="{bearing_steel: {youngs_modulus_GPa: 208, poisson_ratio: 0.3, "
        "density_kg_m3: 7800, brinell_hardness_GPa: 6.6, wear_coefficient: 5.0e-6}}")
    cage: Cage | None = setting(
        "The cage (none if omitted; a cage alone does not require the dynamic model)",
        default=None)
    operation: Operation = setting("Speeds, preload and loads")
    arrangement: Arrangement | None = setting("Bearings on the rotor (default: a single bearing)",
        default=None)
    launch: Launch | None = setting(
        "Accelerations of the stationary rotor at launch (none if omitted)", default=None)
    drive: Drive | None = setting("Shaft drive whose torque margin is computed (none if omitted)",
        default=None)
    temperature: Temperature | None = setting(
        "Temperatures of the parts (if omitted, the mounting temperature)", default=None)
    thermal: Thermal | None = setting(
        "Thermal network that determines the temperatures of the rings and balls from the "
        "friction heat",
        default=None)
    fits: Fits | None = setting(
        "Fits of the rings on their seats (if omitted, the rings expand freely)",
        default=None)
    friction: Friction = setting("Friction", example="{ball_race: 0.08}")
    lubricant: Lubricant = setting("Lubricant (no drag if omitted)", default_factory=Lubricant)
    wear: Wear = setting("State of wear and end of life", default_factory=Wear)
    uncertainty: Mapping[str, Distribution] | None = setting(
        "Distributions of uncertain values in the scene, each in a block named after its key",
        least=1, names=tuple(UNCERTAIN), each="Distribution of one value in the scene",
        default=None)
    cage_uncertainty: Mapping[str, Distribution] | None = setting("Distributions of uncertain "
        "values of the cage for `bearingwear cage` (if omitted, they are assumed; {} means none)",
        names=tuple(UNCERTAIN_CAGE), each="Distribution of one value of the cage", default=None)
    calibrated: Calibrated | None = setting(
        "Tests from which `bearingwear calibrate` determined friction and wear coefficients",
        default=None)
    cases: Mapping[str, Mapping[str, Any]] | None = setting("Further operating conditions, each a "
        "named case that contains the changed keys and their new values", least=1,
        each="Keys of the scene and their values (except the preload and the kind of arrangement)",
        allowed="NAME: {KEY: VALUE}", default=None)
    duty: Duty | None = setting("Cycle of use that repeats until the life ends, in phases with "
        "operating conditions of their own (if omitted, the life is that of the scene itself)",
        default=None)
    model: Model = setting("Model and accuracy settings, which override the automatic choice",
        default_factory=Model)
    # fmt: on

    def __post_init__(self) -> None:
        """Makes mappings read-only, and raises SceneError for values that contradict each other.

        Diameter losses of the balls become one number if they are equal.
        """
        object.__setattr__(self, "materials", MappingProxyType(dict(self.materials)))
        for name in ("uncertainty", "cage_uncertainty"):
            if (distributions := getattr(self, name)) is not None:
                object.__setattr__(self, name, MappingProxyType(dict(distributions)))
        if self.cases is not None:
            object.__setattr__(self, "cases", checked_cases(self.cases))
        _check_materials(self)
        _check_balls(self)
        _check_rings(self)
        _check_speeds(self)
        _check_loss_count(self)
        losses = self.wear.ball_diameter_loss_um
        if len(set(losses)) == 1:  # equal losses are one number
            object.__setattr__(self, "wear", replace(self.wear, ball_diameter_loss_um=losses[:1]))
        _check_largest_loss(self)
        _check_cage_limits(self)
        if self.cage is not None:
            _check_cage_ring(self, self.cage)
            _check_pockets(self, self.cage)
        check_films(self)
        check_uncertainty(self)
        check_warmth(self)
        check_model(self)
        check_arrangement(self)
        check_duty(self)

    def __repr__(self) -> str:
        bearing, operation = self.bearing, self.operation
        method = operation.preload_method.replace("_", " ")
        coefficient = self.friction.ball_race
        friction = "of a film" if coefficient is None else f"{coefficient:g}"
        return (
            f"<Scene {self.name}: {bearing.ball_count} balls of {bearing.ball_diameter_mm:g} mm, "
            f"{operation.shaft_speed_rpm:g} r/min, {method} preload {operation.preload_N:g} N, "
            f"friction {friction}>"
        )

    def _repr_html_(self) -> str:
        """Returns HTML for a notebook: the line of `repr`, which unfolds to a table of all keys."""
        rows = "".join(
            f"<tr><td>{escape(key)}</td><td>{escape(str(value))}</td></tr>"
            for key, value in leaves(self.to_dict()).items()
        )
        return f"<details><summary>{escape(repr(self))}</summary><table>{rows}</table></details>"

    def __hash__(self) -> int:
        """Returns a hash of all fields, although a mapping proxy has none of its own."""
        return record_hash(self)

    def __reduce__(self) -> tuple[Any, ...]:
        """Returns what pickle makes a copy from, which is checked if the scene is."""
        state = {IS_CHECKED: True} if IS_CHECKED in self.__dict__ else None
        return (*reduced_record(self), state)

    def nominal(self, name: str) -> float:
        """Returns the value of a key of `UNCERTAIN`, in the unit of the key.

        A property of a material is that of the races. The value of `wear_scatter` is 1.
        """
        return nominal_value(self, name)

    @property
    def pair(self) -> Arrangement | None:
        """Returns the arrangement of a pair; None for a single bearing."""
        return self.arrangement if self.arrangement and self.arrangement.is_pair else None

    @property
    def start_s(self) -> float:
        """Returns the time of a start from rest to full speed [s]: that of its duty, else 0."""
        return self.duty.start_s if self.duty else 0.0

    @functools.cached_property
    def in_cases(self) -> dict[str, Scene]:
        """Returns the scene in each of its cases by name, all without cases and duty.

        `nominal` is the scene with its own values.
        """
        return scenes_of_cases(self)

    @functools.cached_property
    def sides(self) -> tuple[Scene, ...]:
        """Returns a scene of a single bearing for each side: two of a pair, otherwise one."""
        return sides_of(self)

    @property
    def symmetric_half(self) -> Scene:
        """Returns the scene of one bearing for a symmetric pair, whose bearings are alike.

        Any other scene is returned as it is.
        """
        return self.sides[0] if self.pair is not None and self.pair.is_symmetric else self

    @functools.cached_property
    def without_cage(self) -> Scene:
        """Returns the scene without its cage, the cage's results and the limits of its wear."""
        wear = self.wear
        if wear.end_of_life is not None:
            wear = replace(wear, end_of_life=wear.end_of_life.without_cage)
        model = replace(self.model, cage_results=False)
        return replace(self, cage=None, cage_uncertainty=None, wear=wear, model=model)

    def with_(self, changes: Mapping[str, Any] | None = None, **typed: Any) -> Scene:
        """Returns a copy of the scene with some values replaced and checked.

        Parameters
        ----------
        changes : mapping
            Such as `{"operation.preload_N": 9.0}`, in the units of a scene file. Missing blocks are
            created; None removes an optional key.

        Raises
        ------
        SceneError
            A ValueError with a one-line message that names the key.
        TypeError
            No changes, or changes by keyword: whole keys are no names in Python.
        """
        from bearingwear.scene.read import variant

        if changes is None or typed:
            names = ", ".join(typed) or "nothing"
            example = "{'operation.preload_N': 9.0}"
            raise TypeError(
                f"with_: got {names}, expected a mapping of whole keys such as {example}"
            )
        try:
            return variant(self, changes)
        except SceneError as error:  # the command line names a changed key as `--set KEY`
            raise error.in_source(error.source.removeprefix("--set ")) from None

    def case(self, name: str) -> Scene:
        """Returns the scene in one of its cases, like `--case`, without its other cases and duty.

        `nominal` is the scene with its own values.

        Raises
        ------
        SceneError
            A ValueError with a one-line message that lists the cases.
        """
        from bearingwear.scene.cases import scene_in_case

        return scene_in_case(self, name, "case")

    def to_dict(self) -> dict[str, Any]:
        """Returns the scene as plain nested data in the order of a scene file, with all defaults.

        What a scene does without (cage, end of life or one of its criteria) is left out.
        """
        return plain_data(self)

    @property
    def plain(self) -> Mapping[str, Any]:
        """Returns the data of `to_dict`; other scenes share parts of it, so do not write to it."""
        return self._serialised.plain

    @property
    def json(self) -> str:
        """Returns `to_dict` as JSON: the attribute `scene` of a result."""
        return self._serialised.json

    @functools.cached_property
    def _serialised(self) -> _Serialised:
        """Returns plain data and JSON of the scene, with blocks that other scenes share."""
        field_values = {name: getattr(self, name) for name in _field_names(Scene)}
        return _serialised_mapping(
            {name: part for name, part in field_values.items() if part is not None}
        )


@functools.cache
def _field_names(record_type: type) -> tuple[str, ...]:
    """Returns the names of the fields of a dataclass; none for any other type."""
    return tuple(f.name for f in fields(record_type)) if is_dataclass(record_type) else ()


_UNCHANGED = frozenset({float, int, bool, str})
"""Types of values that are plain data. Looking up the exact type is faster than `isinstance`."""


def plain_data(value: Any) -> Any:
    """Returns a part of a scene as plain nested data, without its omitted keys."""
    if value.__class__ in _UNCHANGED:
        return value
    if names := _field_names(value.__class__):
        field_values, plain = value.__dict__, {}
        for name in names:
            part = field_values[name]
            if part.__class__ in _UNCHANGED:
                plain[name] = part
            elif part is not None:
                plain[name] = plain_data(part)
        if value.__class__ is Wear and len(value.ball_diameter_loss_um) == 1:
            plain["ball_diameter_loss_um"] = value.ball_diameter_loss_um[0]  # as files have it
        return plain
    if isinstance(value, Mapping):
        return {key: plain_data(part) for key, part in value.items()}
    if isinstance(value, tuple):
        return [plain_data(part) for part in value]
    return value


class _Serialised(NamedTuple):
    """A part of a scene in the two forms in which results hold it."""

    plain: Any
    json: str


_MOST_CACHED = 256
_BLOCK_CACHE: dict[int, tuple[Any, _Serialised]] = {}
"""Blocks by their id: scenes in a loop have most of them in common.

Each entry holds its block, so that no other object gets the id meanwhile.
"""


def _serialised_block(block: Any) -> _Serialised:
    """Returns plain data and JSON of a block, which are computed once for each block."""
    if id(block) not in _BLOCK_CACHE:
        if len(_BLOCK_CACHE) >= _MOST_CACHED:
            _BLOCK_CACHE.clear()
        plain = plain_data(block)
        _BLOCK_CACHE[id(block)] = block, _Serialised(plain, json.dumps(plain))
    _, serialised = _BLOCK_CACHE[id(block)]
    return serialised


_name_as_json = functools.lru_cache(maxsize=1024)(json.dumps)


def _serialised_mapping(mapping: Mapping[str, Any]) -> _Serialised:
    """Returns plain data and JSON of a mapping of blocks, mappings and values."""
    plain, texts = {}, []
    for name, part in mapping.items():
        if _field_names(part.__class__):
            serialised = _serialised_block(part)
        elif isinstance(part, Mapping):
            serialised = _serialised_mapping(part)
        else:
            data = plain_data(part)
            serialised = _Serialised(data, json.dumps(data))
        plain[name] = serialised.plain
        texts.append(f"{_name_as_json(name)}: {serialised.json}")
    return _Serialised(plain, f"{{{', '.join(texts)}}}")


def cached_in_scene(of_scene: Callable[[Scene], Value]) -> Callable[[Scene], Value]:
    """Wraps a function of a scene so that its value is computed once and cached in the scene.

    The cache is the scene's `__dict__`, under the function's dotted name.
    """
    name = f"{of_scene.__module__}.{of_scene.__qualname__}"

    @functools.wraps(of_scene)
    def cached_value(scene: Scene) -> Value:
        cache = scene.__dict__
        if name not in cache:
            cache[name] = of_scene(scene)
        value: Value = cache[name]
        return value

    return cached_value


def key_of_scene(path: str) -> Part | None:
    """Returns the field of a scene at a path, `materials.steel.density_kg_m3`; None for no key."""
    return part_at(file_part(Scene), path)


def _check_materials(scene: Scene) -> None:
    """Refuses the name of a material that the scene does not define."""
    blocks = {"bearing": scene.bearing, "cage": scene.cage, "fits": scene.fits}
    for block, record in blocks.items():
        if record is None:
            continue
        for key, name in vars(record).items():
            if key.endswith("material") and name is not None and name not in scene.materials:
                problem = (
                    f"got {name!r}, which is not under materials, "
                    f"expected {', '.join(scene.materials)}{_material_advice(name, scene)}"
                )
                raise SceneError(f"{block}.{key}", problem, ("materials",))


def _material_advice(name: str, scene: Scene) -> str:
    """Returns advice on the name of a material that the scene lacks, after a semicolon."""
    if advice := did_you_mean(name, scene.materials):
        return advice
    if did_you_mean(name, ("silicon_nitride",)):
        return (
            "; `bearingwear new --ball-material silicon_nitride` writes a block of silicon nitride"
        )
    return ""


_BALL_CIRCLE = ("bearing.ball_diameter_mm", "bearing.pitch_diameter_mm")


def most_balls(diameter: float, pitch_diameter: float) -> int:
    """Returns how many balls (or pockets) fit side by side on the pitch circle.

    diameter, pitch_diameter: in the same unit.
    """
    if diameter >= pitch_diameter:
        return 0
    # without the tolerance, rounding would refuse the last of balls that touch exactly
    return math.floor(math.pi / math.asin(diameter / pitch_diameter) + 1e-9)


def _check_balls(scene: Scene) -> None:
    """Refuses balls that do not fit on the pitch circle."""
    count, D = scene.bearing.ball_count, scene.bearing.ball_diameter_mm
    dm = scene.bearing.pitch_diameter_mm
    keys = ("bearing.ball_count", *_BALL_CIRCLE)
    if D >= dm:
        raise SceneError(
            "bearing.pitch_diameter_mm",
            f"got {dm:g} with balls of {D:g} mm, expected a number > {D:g}",
            keys,
        )
    limit = most_balls(D, dm)
    if count > limit:
        raise SceneError(
            "bearing.ball_count",
            f"got {count} balls of {D:g} mm that do not fit on a pitch circle of {dm:g} mm, "
            f"expected at most {limit}",
            keys,
        )


def _check_rings(scene: Scene) -> None:
    """Refuses diameters of the rings that are not in their order from bore to outside diameter."""
    dm, D = scene.bearing.pitch_diameter_mm, scene.bearing.ball_diameter_mm
    for name, above, below in (
        ("bore_mm", 0.0, dm - D),
        ("inner_shoulder_mm", dm - D, dm),
        ("outer_shoulder_mm", dm, dm + D),
        ("outside_diameter_mm", dm + D, math.inf),
    ):
        value = getattr(scene.bearing, name)
        if value is not None and not above < value < below:
            ends = []
            if above > 0.0:
                ends.append(f"> {above:g}")
            if below < math.inf:
                ends.append(f"< {below:g}")
            raise SceneError(
                f"bearing.{name}",
                f"got {value:g} with balls of {D:g} mm on a pitch circle of {dm:g} mm, "
                f"expected a number {' and '.join(ends)}",
                _BALL_CIRCLE,
            )


def _check_speeds(scene: Scene) -> None:
    """Refuses a lowest speed above that of the shaft."""
    lowest, speed = scene.operation.lowest_speed_rpm, scene.operation.shaft_speed_rpm
    if lowest > max(speed, 0.0):  # the range of shaft_speed_rpm refuses a speed below zero
        raise SceneError(
            "operation.lowest_speed_rpm",
            f"got {lowest:g}, expected a number <= {speed:g}, the speed of the shaft",
            ("operation.shaft_speed_rpm",),
        )


def _check_loss_count(scene: Scene) -> None:
    """Refuses diameter losses that are neither one number nor one for each ball."""
    losses, ball_count = scene.wear.ball_diameter_loss_um, scene.bearing.ball_count
    if len(losses) not in (1, ball_count):
        raise SceneError(
            "wear.ball_diameter_loss_um",
            f"got {len(losses)} values, expected one number or a list with one number for each of "
            f"the {ball_count} balls",
            ("bearing.ball_count",),
        )


def _check_largest_loss(scene: Scene) -> None:
    """Refuses diameter losses, now or at the end of life, that are too large for the ball."""
    largest = LARGEST_LOSS * 1e3 * scene.bearing.ball_diameter_mm  # [um], of a diameter in mm
    losses = {"wear.ball_diameter_loss_um": max(scene.wear.ball_diameter_loss_um)}
    if scene.wear.end_of_life is not None:
        loss_at_end = scene.wear.end_of_life.ball_diameter_loss_um
        losses["wear.end_of_life.ball_diameter_loss_um"] = loss_at_end or 0.0
    for key, value in losses.items():
        if value >= largest:
            raise SceneError(
                key,
                f"got {value:g}, expected a number < {largest:g} "
                f"({100 * LARGEST_LOSS:g} % of the ball diameter)",
                ("bearing.ball_diameter_mm",),
            )


def _check_cage_limits(scene: Scene) -> None:
    """Refuses end-of-life criteria of a cage, a land or a cage film that the scene lacks."""
    end, cage = scene.wear.end_of_life or EndOfLife(), scene.cage
    guided = cage is not None and cage.guiding_race != "ball"
    for name, applies, condition in (
        ("pocket_clearance_mm", cage is not None, "with a cage"),
        ("guide_clearance_mm", guided, "with a cage guided by a race"),
        ("cage_film_worn_share", cage is not None and cage.film is not None, "with cage.film"),
    ):
        value = getattr(end, name)
        if value is not None and not applies:
            raise SceneError(
                f"wear.end_of_life.{name}", f"got {value:g}; only allowed {condition}", ("cage",)
            )


def _check_cage_ring(scene: Scene, cage: Cage) -> None:
    """Refuses a cage ring of no thickness or away from the balls, and a cage without clearance."""
    bearing, ring_keys = scene.bearing, ("cage.inner_diameter_mm", "cage.outer_diameter_mm")
    if cage.inner_diameter_mm >= cage.outer_diameter_mm:
        raise SceneError(
            "cage.inner_diameter_mm",
            f"got {cage.inner_diameter_mm:g}, expected a number < {cage.outer_diameter_mm:g}, "
            "the cage's outer diameter",
            ring_keys,
        )
    inside = bearing.pitch_diameter_mm - bearing.ball_diameter_mm
    outside = bearing.pitch_diameter_mm + bearing.ball_diameter_mm
    if cage.inner_diameter_mm >= outside or cage.outer_diameter_mm <= inside:
        raise SceneError(
            "cage.inner_diameter_mm",
            f"got a cage from {cage.inner_diameter_mm:g} to {cage.outer_diameter_mm:g} mm that "
            f"does not reach the balls, expected a ring that overlaps the range from {inside:g} to "
            f"{outside:g} mm",
            ring_keys + _BALL_CIRCLE,
        )
    clearances = {"pocket_clearance_mm": cage.pocket_clearance_mm}
    if cage.guiding_race != "ball":
        clearances["guide_clearance_mm"] = cage.guide_clearance_mm
    for name, clearance in clearances.items():
        if not clearance > 0.0:
            raise SceneError(
                f"cage.{name}", "got 0, expected a number > 0, because a cage requires clearance"
            )


def _check_pockets(scene: Scene, cage: Cage) -> None:
    """Refuses pockets that overlap, or that cut through the ring of the cage."""
    bearing = scene.bearing
    pocket = bearing.ball_diameter_mm + cage.pocket_clearance_mm
    if bearing.ball_count > most_balls(pocket, bearing.pitch_diameter_mm):
        spacing = bearing.pitch_diameter_mm * math.sin(math.pi / bearing.ball_count)
        raise SceneError(
            "cage.pocket_clearance_mm",
            f"got {cage.pocket_clearance_mm:g}, which makes the pockets overlap, expected a "
            f"number <= {spacing - bearing.ball_diameter_mm:.4g}",
            ("bearing.ball_count", *_BALL_CIRCLE),
        )
    # the dynamic model gives the cage the mass of the ring between its pockets
    pockets_area = bearing.ball_count * math.pi * (0.5 * pocket) ** 2
    circumference = math.pi * (cage.outer_diameter_mm + cage.inner_diameter_mm) / 2.0
    if pockets_area >= circumference * cage.width_mm:
        raise SceneError(
            "cage.width_mm",
            f"got {cage.width_mm:g}, at which the pockets cut through the ring, expected a "
            f"number > {pockets_area / circumference:.4g}",
            ("cage.pocket_clearance_mm", "bearing.ball_count", *_BALL_CIRCLE),
        )
