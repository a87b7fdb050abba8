"""What the study of robustness solves: config/robustness.yaml, and its random values.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

from bearingwear.kernels.status import NOT_CONVERGED, UNVERIFIED
from bearingwear.scene.checking.check import record
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import NAME, keyed, setting
from bearingwear.scene.read import load_scene

ROBUSTNESS_FILE = "config/robustness.yaml"

WITHOUT_REASON = (NOT_CONVERGED, UNVERIFIED)
"""Statuses that give no physical reason."""

REFUSED = -1
"""Status of a draw that makes no bearing and is refused before any solve."""

RANDOM_FIDELITIES = ("race_control", "steady", "dynamic", "worn_life")
LIMIT_NAMES = ("contact", "gyroscopic_slip", "skid")

STAND_INS = (
    "ball_diameter_mm",
    "pitch_ratio",
    "fill",
    "loss_ratio",
    "stress_GPa",
    "speed_m_s",
    "outer_ratio",
    "radial_ratio",
    "rotating_ratio",
    "cage",
    "pocket_clearance_ratio",
    "guide_clearance_ratio",
    "warmth",
    "bore_ratio",
    "outside_ratio",
    "fit_ratio",
    "pair",
    "external_ratio",
    "spring_ratio",
    "second_loss_ratio",
    "in_tandem",
    "worn_ratio",
)
"""Values drawn that are no keys of a scene; `draw.drawn_scene` says what they stand for."""


def check_ends(log: tuple[float, float] | None, even: tuple[float, float] | None) -> None:
    """Refuse ends that do not rise, or have no logarithm."""
    for name, ends in (("log", log), ("even", even)):
        if ends is not None and (ends[0] > ends[1] or (name == "log" and not ends[0] > 0.0)):
            positive = " > 0" if name == "log" else ""
            raise SceneError(name, f"got {list(ends)}, expected two increasing numbers{positive}")


@keyed
class Draw:
    """Where a value is drawn from: between two ends, or from a list."""

    log: tuple[float, float] | None = setting("Ends of a log-uniform range", default=None)
    even: tuple[float, float] | None = setting("Ends of a uniform range", default=None)
    of: tuple[Any, ...] = setting("Values, one of which is drawn", default=())
    share: float | None = setting(
        "Share of the scenes that draw from `of` (if omitted, all)", within="[0, 1]", default=None
    )

    def __post_init__(self) -> None:
        check_ends(self.log, self.even)
        if not (self.log or self.even or self.of):
            raise ValueError("got nothing to draw from, expected log, even or of")

    def value(self, chance: random.Random) -> Any:
        is_range = self.log is not None or self.even is not None
        if self.of and (not is_range or chance.random() < (self.share or 0.0)):
            return chance.choice(self.of)
        if self.log is not None:
            low, high = self.log
            return math.exp(chance.uniform(math.log(low), math.log(high)))
        assert self.even is not None
        return chance.uniform(*self.even)


@keyed
class SceneClass:
    """Random scenes of one kind."""

    fidelity: str = setting("Model with which the scenes are solved", choices=RANDOM_FIDELITIES)
    scenes: int = setting("Number of scenes", within="[1, inf)")
    draw: Mapping[str, Any] = setting(
        "Quantities to draw: keys of a scene, and values from which other keys are derived"
    )
    like: str = setting("Earlier class whose draws are inherited", default="")

    def __post_init__(self) -> None:
        draws(self.draw)


def draws(blocks: Mapping[str, Any]) -> dict[str, Draw]:
    """Draws by the keys of their values; SceneError for the first block that is wrong."""
    found = {}
    for key, block in blocks.items():
        if "." not in key and key not in STAND_INS:
            raise SceneError(f"draw.{key}", f"got {key}, expected {', '.join(STAND_INS)}")
        try:
            found[key] = record(Draw, block)
        except SceneError as error:
            where = ".".join(filter(None, ("draw", key, error.key)))
            raise SceneError(where, error.problem) from None
    return found


def drawn(draw: Mapping[str, Draw], seed: int, count: int) -> Iterator[dict[str, Any]]:
    """What sets so many scenes apart; the same for the same seed."""
    for k in range(count):
        chance = random.Random(f"{seed}-{k}")
        yield {key: one.value(chance) for key, one in draw.items()}


@keyed
class KeyAxis:
    """Points along a key of a scene."""

    key: str = setting("Key of the scene")
    log: tuple[float, float] | None = setting("Ends of a logarithmic axis", default=None)
    even: tuple[float, float] | None = setting("Ends of a linear axis", default=None)
    points: int = setting("Number of points", within="[2, inf)")

    def __post_init__(self) -> None:
        check_ends(self.log, self.even)
        if (self.log is None) == (self.even is None):
            raise ValueError("got both or neither of log and even, expected one of them")

    @property
    def is_log(self) -> bool:
        return self.log is not None

    @property
    def values(self) -> tuple[float, ...]:
        shares = [k / (self.points - 1) for k in range(self.points)]
        if self.log is not None:
            low, high = self.log
            return tuple(low * (high / low) ** share for share in shares)
        assert self.even is not None
        low, high = self.even
        return tuple(low + (high - low) * share for share in shares)


@keyed
class StateMap:
    """Steady states over two axes."""

    title: str = setting("Title of the figure")
    changes: Mapping[str, Any] = setting(
        "Keys of the scene to set", name="set", default_factory=dict
    )
    x: KeyAxis = setting("Horizontal axis")
    y: KeyAxis = setting("Vertical axis")
    limits: tuple[str, ...] = setting("Limits to locate along y", choices=LIMIT_NAMES)


@keyed
class Branch:
    """Steady states followed along an axis, both ways."""

    title: str = setting("Title of the figure")
    changes: Mapping[str, Any] = setting(
        "Keys of the scene to set", name="set", default_factory=dict
    )
    along: KeyAxis = setting("Key along which the branches are followed")


@keyed
class LimitValues:
    """What counts as the limit."""

    gyroscopic_slip: float = setting("Gyroscopic slip share", within="(0, inf)")
    skid: float = setting("Skid ratio", within="(0, inf)")


@keyed
class RobustnessPlan:
    """Everything in config/robustness.yaml."""

    scene: str = setting("Base of all scenes", pattern=NAME)
    scene_classes: Mapping[str, SceneClass] = setting("Random scenes, by class")
    maps: Mapping[str, StateMap] = setting("Maps of steady states")
    limits: LimitValues = setting("Values that define the limits of a map")
    branches: Mapping[str, Branch] = setting("Branches of steady states")

    def __post_init__(self) -> None:
        before: list[str] = []
        for name, scene_class in self.scene_classes.items():
            if scene_class.like and scene_class.like not in before:
                allowed = ", ".join(before) or "none, because no class precedes it"
                raise SceneError(
                    f"scene_classes.{name}.like", f"got {scene_class.like}, expected {allowed}"
                )
            before.append(name)

    @property
    def scene_file(self) -> str:
        return f"config/scenes/{self.scene}.yaml"

    def check_scenes(self) -> None:
        """Read the scene."""
        load_scene(self.scene_file)

    def draw(self, name: str) -> dict[str, Any]:
        """Blocks of all draws of a class, those it takes over among them."""
        of = self.scene_classes[name]
        return (self.draw(of.like) if of.like else {}) | dict(of.draw)

    def class_settings(self, name: str) -> dict[str, Any]:
        """What decides the random scenes of a class besides the scene."""
        of = self.scene_classes[name]
        return {
            "name": name,
            "fidelity": of.fidelity,
            "count": of.scenes,
            "draw": self.draw(name),
        }

    def map_settings(self, name: str) -> dict[str, Any]:
        """What decides a map besides the scene."""
        of, limits = self.maps[name], asdict(self.limits)
        return {
            "name": name,
            "title": of.title,
            "changes": of.changes,
            "x": asdict(of.x),
            "y": asdict(of.y),
            "limits": {limit: limits.get(limit) for limit in of.limits},
        }

    def branch_settings(self, name: str) -> dict[str, Any]:
        """What decides branches besides the scene."""
        of = self.branches[name]
        return {
            "name": name,
            "title": of.title,
            "changes": of.changes,
            "along": asdict(of.along),
        }
