"""Plan of the study of robustness, read from config/robustness.yaml, and its random values.

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
"""Drawn values that are no keys of a scene; `draw.drawn_scene` describes them."""


def check_ends(log: tuple[float, float] | None, even: tuple[float, float] | None) -> None:
    """Refuses ends that do not rise, or have no logarithm."""
    for name, ends in (("log", log), ("even", even)):
        if ends is not None and (ends[0] > ends[1] or (name == "log" and not ends[0] > 0.0)):
            positive = " > 0" if name == "log" else ""
            raise SceneError(name, f"got {list(ends)}, expected two increasing numbers{positive}")


@keyed
class Draw:
    """Distribution of a drawn value: a range, a list, or both."""

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
        """Draws a value."""
        is_range = self.log is not None or self.even is not None
        if self.of and (not is_range or chance.random() < (self.share or 0.0)):
            return chance.choice(self.of)
        if self.log is not None:
            low, high = self.log
            return math.exp(chance.uniform(math.log(low), math.log(high)))
        assert self.even is not None
        return chance.uniform(*self.even)


def draws(blocks: Mapping[str, Any]) -> dict[str, Draw]:
    """Reads the draws of a class by key. Raises SceneError for the first wrong block."""
    draw_of_key = {}
    for key, block in blocks.items():
        if "." not in key and key not in STAND_INS:
            raise SceneError(f"draw.{key}", f"got {key}, expected {', '.join(STAND_INS)}")
        try:
            draw_of_key[key] = record(Draw, block)
        except SceneError as error:
            place = ".".join(filter(None, ("draw", key, error.key)))
            raise SceneError(place, error.problem) from None
    return draw_of_key


def drawn_values(draw: Mapping[str, Draw], seed: int, count: int) -> Iterator[dict[str, Any]]:
    """Yields the drawn values of so many scenes; the same seed gives the same values."""
    for k in range(count):
        chance = random.Random(f"{seed}-{k}")
        yield {key: value_draw.value(chance) for key, value_draw in draw.items()}


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
        """Whether the points are evenly spaced in logarithm."""
        return self.log is not None

    @property
    def values(self) -> tuple[float, ...]:
        """Returns the points."""
        shares = [k / (self.points - 1) for k in range(self.points)]
        if self.log is not None:
            low, high = self.log
            return tuple(low * (high / low) ** share for share in shares)
        assert self.even is not None
        low, high = self.even
        return tuple(low + (high - low) * share for share in shares)


def read_robustness(path: Path) -> dict[str, Any]:
    """Reads a plan like config/robustness.yaml, with defaults. Raises UsageError."""
    return validated_config(path, "robustness", check_robustness)


def check_robustness(plan: Mapping[str, Any], path: Path = ROBUSTNESS_FILE) -> None:
    """Reads the scene and refuses impossible draws and axes. Raises ValueError."""
    earlier: list[str] = []
    for name, scene_class in plan["scene_classes"].items():
        place, parent = f"{path}: scene_classes.{name}", scene_class["like"]
        if parent and parent not in earlier:
            allowed = ", ".join(earlier) or "none, because no class precedes it"
            raise ValueError(f"{place}.like: got {parent}, expected {allowed}")
        try:
            draws(scene_class["draw"])
        except SceneError as error:
            raise ValueError(f"{place}.{error.key}: {error.problem}") from None
        earlier.append(name)
    for kind, axes in (("maps", "xy"), ("branches", ("along",))):
        for name, entry_plan in plan[kind].items():
            for axis in axes:
                record(KeyAxis, entry_plan[axis], f"{path}: {kind}.{name}.{axis}")
    if earlier or plan["maps"] or plan["branches"]:
        load_scene(base_scene(plan, path))


def base_scene(plan: Mapping[str, Any], path: Path = ROBUSTNESS_FILE) -> Path:
    """Returns the file of the base scene of all others; it lies in `scenes/` beside the plan."""
    return path.parent / "scenes" / f"{plan['scene']}.yaml"


def entry(plan: Mapping[str, Any], path: Path, kind: str, name: str) -> dict[str, Any]:
    """Returns a class of scenes, a map or a branch of a plan. Raises UsageError without it."""
    if name not in plan[kind]:
        raise UsageError(f"{path}: {kind}: got {name}, expected {', '.join(plan[kind])}")
    return plan[kind][name]


def draw_blocks(plan: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Returns the blocks of all draws of a class, with inherited ones."""
    scene_class = plan["scene_classes"][name]
    inherited = draw_blocks(plan, scene_class["like"]) if scene_class["like"] else {}
    return inherited | scene_class["draw"]


def limit_values(plan: Mapping[str, Any], name: str) -> dict[str, float | None]:
    """Returns the limits to locate in a map, with their values; contact has none."""
    return {limit: plan["limits"].get(limit) for limit in plan["maps"][name]["limits"]}
