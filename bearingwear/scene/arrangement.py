"""The arrangement: two bearings on one rotor, and the keys in which the second differs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from bearingwear.scene.checking.errors import SceneError, leaves, shown
from bearingwear.scene.checking.records import keyed, record_hash, reduced_record, setting

if TYPE_CHECKING:
    from bearingwear.scene.scene import Scene

ARRANGEMENTS = ("single", "rigid_pair", "spring_pair")
"""One bearing, or two against each other, held by a distance or by a spring."""

METHODS = {"rigid_pair": "fixed_position", "spring_pair": "constant_force"}
"""The preload method that each pair is made by."""

PAIRS = {method: kind for kind, method in METHODS.items()}
"""The kind of pair for each preload method."""

MOST_IN_TANDEM = 8

SHARED_KEYS = frozenset(
    {"shaft_speed_rpm", "lowest_speed_rpm", "outer_speed_rpm", "preload_method", "preload_N"}
)
"""Keys of `operation` that both bearings of a pair share."""

OWN_BLOCKS = (
    "bearing",
    "materials",
    "operation",
    "temperature",
    "thermal",
    "fits",
    "friction",
    "lubricant",
    "wear",
)
"""Blocks of a scene in which the second bearing may differ."""


ORIENTATIONS = MappingProxyType(
    {"O": "back_to_back", "DB": "back_to_back", "X": "face_to_face", "DF": "face_to_face"}
)
"""Makers' letters of an arrangement."""


@keyed
class Arrangement:
    """Bearings of the rotor and their arrangement."""

    # fmt: off
    kind: str = setting("A single bearing, a pair at a fixed distance (fixed_position), or a pair "
        "with a spring on the second bearing (constant_force)", choices=ARRANGEMENTS,
        default="single")
    orientation: str = setting("Orientation of a pair: the contact lines meet the axis outside the "
        "pair (back to back; also O or DB) or inside it (face to face; also X or DF)",
        choices=("back_to_back", "face_to_face"), synonyms=ORIENTATIONS, default="back_to_back")
    external_axial_N: float = setting("Axial force towards +X on the rotor of a pair, which loads "
        "the first bearing and unloads the second", "N", "[-1e7, 1e7]", default=0.0)
    spring_stiffness_N_um: float = setting("Stiffness of the preload spring in a spring pair",
                                           "N/um",
        "[0, 1e6]", default=0.0)
    rotor_mass_kg: float | None = setting(
        "Mass of the rotor of a pair, used to compute its natural frequencies", "kg", "(0, 1e6]",
        default=None)
    span_mm: float | None = setting(
        "Distance between the centres of the two bearings of a pair, used to compute the "
        "natural frequencies of the rotor", "mm",
        "(0, 1e5]", default=None)
    rotor_transverse_inertia_kg_mm2: float | None = setting("Moment of inertia of the rotor about "
        "a transverse axis through its centre of mass (if omitted, a slender rod of the same mass "
        "and span is assumed)", "kg mm2", "(0, 1e12]", default=None)
    rotor_offset_mm: float = setting(
        "Distance of the rotor's centre of mass from the midpoint between the bearings, towards +X",
        "mm", "[-1e5, 1e5]", default=0.0)
    stop_um: float | None = setting("Travel of the preload spring at launch, to its stop or to a "
        "snubber (unlimited if omitted)", "um", "[0, 1e5]", default=None)
    tandem: tuple[int, ...] = setting("Numbers of identical bearings in tandem on the first and "
        "second sides of a pair; bearings on the same side share its axial force. "
        "operation.preload_N is the force of a side: bearings that a maker matches for a pair give "
        "a rigid set of 2 and 1 1.36 times the pair's preload, 3 and 1 1.57, 2 and 2 2, 3 and 2 "
        "2.42",
        each=f"Whole number in [1, {MOST_IN_TANDEM}]", least=2, most=2,
        within=f"[1, {MOST_IN_TANDEM}]", default=(1, 1))
    second: Mapping[str, Any] = setting(
        "Keys whose values differ for the second bearing of a pair, with the values for that "
        "bearing",
        allowed="KEY: VALUE, wear.ball_diameter_loss_um: 0.25", default_factory=dict)
    # fmt: on

    def __post_init__(self) -> None:
        """Makes `second` a read-only mapping by whole keys, and refuses keys that it may not have.

        These are unknown keys and those that both bearings share. It also refuses keys of the block
        that only another kind of arrangement has.
        """
        values_by_key = flat_keys(self.second)
        for key, value in values_by_key.items():
            if not _may_differ(key):
                raise SceneError(
                    f"second.{key}" if key else "second",
                    f"got {shown(value)} for a key that is unknown or common to both bearings, "
                    f"expected a key of {', '.join(OWN_BLOCKS)}, except speeds, preload, counts "
                    "and end of life",
                )
        object.__setattr__(self, "second", MappingProxyType(values_by_key))
        _check_kind(self)

    def __hash__(self) -> int:
        """Returns a hash of all fields, although a mapping proxy has none of its own."""
        return record_hash(self)

    def __reduce__(self) -> tuple[Any, ...]:
        """Returns what pickle makes a copy from."""
        return reduced_record(self)

    @property
    def is_pair(self) -> bool:
        """Whether there are two bearings."""
        return self.kind in METHODS

    @property
    def is_symmetric(self) -> bool:
        """Whether two equal bearings carry nothing but the preload, so that one stands for both.

        The value for a single bearing has no meaning.
        """
        has_constant_force = self.kind == "rigid_pair" or self.spring_stiffness_N_um == 0.0
        has_tandem = max(self.tandem) > 1
        has_external_force = self.external_axial_N != 0.0
        return has_constant_force and not (has_tandem or self.second or has_external_force)


def _may_differ(key: str) -> bool:
    """Whether the second bearing of a pair may have another value of a key of a scene."""
    block, _, name = key.partition(".")
    if not name or block not in OWN_BLOCKS:
        return False
    if block == "wear":
        return name == "ball_diameter_loss_um"
    return block != "operation" or name not in SHARED_KEYS


def set_preload_ratio(tandem: Sequence[int]) -> float:
    """Returns the preload of a side of a rigid set over that of a rigid pair of its bearings [1].

    It is (2 / (n^(-2/3) + m^(-2/3)))^(3/2) for n and m bearings on the sides.
    Makers grind a bearing for the preload of a pair, so the two sides of a set share the offset of
    a pair's faces. At rest and at a constant contact angle, Hertz' law gives the ratio; for 2 and 1
    bearings it is 1.36, and makers print 1.35 or 1.36.

    tandem: number of bearings on each of the two sides.
    """
    approach = sum(count ** (-2.0 / 3.0) for count in tandem)
    return float((2.0 / approach) ** 1.5)


def flat_keys(block: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the values of nested blocks by dotted keys such as `wear.counts`; lists as tuples."""
    return {
        key: tuple(value) if isinstance(value, list) else value
        for key, value in leaves(block).items()
    }


def _check_kind(arrangement: Arrangement) -> None:
    """Refuses keys that only a pair, or only a spring pair, may have."""
    pair_values = {
        "external_axial_N": arrangement.external_axial_N,
        "spring_stiffness_N_um": arrangement.spring_stiffness_N_um,
        "tandem": list(arrangement.tandem) if max(arrangement.tandem) > 1 else None,
        "second": dict(arrangement.second),
    }
    for name, value in pair_values.items():
        allowed = {"spring_pair"} if name == "spring_stiffness_N_um" else set(METHODS)
        if value and arrangement.kind not in allowed:
            problem = f"got {shown(value)} with kind {arrangement.kind}; only allowed with "
            raise SceneError(name, problem + " or ".join(sorted(allowed)), ("kind",))


def sides_of(scene: Scene) -> tuple[Scene, ...]:
    """Returns a scene of a single bearing for each side of a pair; else the scene alone.

    These scenes keep span and orientation. A bearing in tandem has its share of the preload.

    SceneError where the second is no valid bearing.
    """
    arrangement = scene.arrangement
    if arrangement is None or not arrangement.is_pair:
        return (scene,)
    first, second = _single_bearings(scene, arrangement)
    changes, end = dict(arrangement.second), scene.wear.end_of_life
    film_ends_life = end is not None and end.film_worn_share is not None
    if film_ends_life and "friction.film" in changes and changes["friction.film"] is None:
        # the criterion holds for the first bearing alone, because the second has no film
        changes["wear.end_of_life.film_worn_share"] = None
    try:
        return first, second.with_(changes) if changes else second
    except SceneError as error:
        key = ".".join(filter(None, ("arrangement.second", error.source or error.key)))
        raise SceneError(key, error.problem, error.involved) from None


def _single_bearings(scene: Scene, arrangement: Arrangement) -> list[Scene]:
    """Returns a scene of a single bearing for each side, without the differences of the second.

    The list has two scenes, which are one object if both sides have as many bearings.
    """
    single = replace(
        arrangement,
        kind="single",
        tandem=(1, 1),
        external_axial_N=0.0,
        spring_stiffness_N_um=0.0,
        second={},
    )
    scenes: dict[int, Scene] = {}  # equal sides share a scene, and so all that is cached in it
    for count in arrangement.tandem:
        if count not in scenes:
            preload = scene.operation.preload_N / count
            operation = replace(scene.operation, preload_N=preload)
            scenes[count] = replace(
                scene, arrangement=single, operation=operation, cases=None, duty=None
            )
    return [scenes[count] for count in arrangement.tandem]


def single_bearing_scene(scene: Scene, source: object) -> Scene:
    """Returns the scene unchanged; refuses one with a pair of bearings.

    source: file of the scene, for the SceneError.
    """
    if scene.arrangement is not None and scene.arrangement.is_pair:
        raise SceneError(
            "arrangement.kind",
            f"got {scene.arrangement.kind}, expected single for the dynamic model",
            source=str(source),
        )
    return scene


def bearings_holding(method: str) -> float:
    """Returns how many bearings of a symmetric pair hold the rotor axially.

    It is 2 with the preload method `fixed_position`, and 1 with `constant_force`, where a spring
    holds the other bearing.
    """
    return 2.0 if method == "fixed_position" else 1.0


def with_method(
    scene: Scene, method: str, preload_N: float | None = None, **operation: float
) -> Scene:
    """Returns the scene with another preload method; a pair gets the kind of that method.

    A rigid pair has no stiffness of a spring.

    preload_N: by default that of the scene.
    **operation: further keys of the block `operation` and their new values.
    """
    arrangement = scene.arrangement
    if arrangement is not None and arrangement.is_pair:
        kind = PAIRS[method]
        spring = arrangement.spring_stiffness_N_um if kind == "spring_pair" else 0.0
        arrangement = replace(arrangement, kind=kind, spring_stiffness_N_um=spring)
    preload = scene.operation.preload_N if preload_N is None else preload_N
    new_operation = replace(scene.operation, preload_method=method, preload_N=preload, **operation)  # type: ignore[arg-type]
    return replace(scene, arrangement=arrangement, operation=new_operation)


def check_arrangement(scene: Scene) -> None:
    """Refuses an arrangement that does not fit the preload method, or an invalid second bearing."""
    arrangement = scene.arrangement
    if arrangement is None or not arrangement.is_pair:
        return
    method = scene.operation.preload_method
    if METHODS[arrangement.kind] != method:
        raise SceneError(
            "arrangement.kind",
            f"got {arrangement.kind} with operation.preload_method {method}, expected "
            f"{PAIRS[method]}, or preload_method {METHODS[arrangement.kind]}",
            ("operation.preload_method",),
        )
    if arrangement.second:
        _ = scene.sides  # computing them raises the error of an invalid second bearing
