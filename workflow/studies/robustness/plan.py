"""What the study of robustness solves, by config/robustness.yaml, and its random values.

The keys of that file stand in workflow/schemas/robustness.schema.yaml. This file imports nothing
heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from bearingwear.console import UsageError
from bearingwear.kernels.status import NOT_CONVERGED, UNVERIFIED
from bearingwear.scene.checking.check import record
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import keyed, setting
from bearingwear.scene.read import load_scene
from bearingwear.studies.configuration import validated_config

ROBUSTNESS_FILE = Path("config/robustness.yaml")

WITHOUT_REASON = (NOT_CONVERGED, UNVERIFIED)
"""Statuses that give no physical reason."""

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
    """Refuses ends that do not rise, or have no logarithm."""
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


def read_robustness(path: Path) -> dict[str, Any]:
    """The plan in a file like config/robustness.yaml, with defaults. Raises UsageError."""
    return validated_config(path, "robustness", check_robustness)


def check_robustness(plan: Mapping[str, Any], path: Path = ROBUSTNESS_FILE) -> None:
    """Reads the scene and refuses impossible draws and axes. Raises ValueError."""
    before: list[str] = []
    for name, scene_class in plan["scene_classes"].items():
        place, like = f"{path}: scene_classes.{name}", scene_class["like"]
        if like and like not in before:
            allowed = ", ".join(before) or "none, because no class precedes it"
            raise ValueError(f"{place}.like: got {like}, expected {allowed}")
        try:
            draws(scene_class["draw"])
        except SceneError as error:
            raise ValueError(f"{place}.{error.key}: {error.problem}") from None
        before.append(name)
    for kind, axes in (("maps", "xy"), ("branches", ("along",))):
        for name, one in plan[kind].items():
            for axis in axes:
                record(KeyAxis, one[axis], f"{path}: {kind}.{name}.{axis}")
    if before or plan["maps"] or plan["branches"]:
        load_scene(base_scene(plan, path))


def base_scene(plan: Mapping[str, Any], path: Path = ROBUSTNESS_FILE) -> Path:
    """The scene that all others differ from; it lies in `scenes/` beside the plan."""
    return path.parent / "scenes" / f"{plan['scene']}.yaml"


def entry(plan: Mapping[str, Any], path: Path, kind: str, name: str) -> dict[str, Any]:
    """A class of scenes, a map or a branch of a plan. Raises UsageError where it is not there."""
    if name not in plan[kind]:
        raise UsageError(f"{path}: {kind}: got {name}, expected {', '.join(plan[kind])}")
    return plan[kind][name]


def draw_blocks(plan: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Blocks of all draws of a class, those that it inherits among them."""
    one = plan["scene_classes"][name]
    return (draw_blocks(plan, one["like"]) if one["like"] else {}) | one["draw"]


def limit_values(plan: Mapping[str, Any], name: str) -> dict[str, float | None]:
    """The limits to locate in a map, and the values that define them; contact has none."""
    return {limit: plan["limits"].get(limit) for limit in plan["maps"][name]["limits"]}
