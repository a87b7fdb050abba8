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
    """Raises a SceneError for ends of a range that do not rise, or have no logarithm.

    log, even: lower and upper end of a logarithmic and of a linear range; None without it.
    """
    if log is not None:
        low, high = log
        if low > high or not low > 0.0:
            raise SceneError("log", f"got {list(log)}, expected two increasing numbers > 0")
    if even is not None:
        low, high = even
        if low > high:
            raise SceneError("even", f"got {list(even)}, expected two increasing numbers")


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
        """Raises a ValueError for ends that are not allowed, or for nothing to draw from."""
        check_ends(self.log, self.even)
        if not (self.log or self.even or self.of):
            raise ValueError("got nothing to draw from, expected log, even or of")

    def value(self, chance: random.Random) -> Any:
        """Returns a drawn value.

        It is from `of` if there is no range, else with the probability `share` (0 if omitted).

        chance: generator, whose state advances.
        """
        is_range = self.log is not None or self.even is not None
        if self.of and (not is_range or chance.random() < (self.share or 0.0)):
            return chance.choice(self.of)
        if self.log is not None:
            low, high = self.log
            return math.exp(chance.uniform(math.log(low), math.log(high)))
        assert self.even is not None
        return chance.uniform(*self.even)


def draws(blocks: Mapping[str, Any]) -> dict[str, Draw]:
    """Returns the distributions of the drawn values of a class, by key.

    blocks: plain data of each distribution, by keys of a scene or of `STAND_INS`.
    SceneError: the first key or block that is not allowed.
    """
    draws_by_key = {}
    for key, block in blocks.items():
        if "." not in key and key not in STAND_INS:
            raise SceneError(f"draw.{key}", f"got {key}, expected {', '.join(STAND_INS)}")
        try:
            draws_by_key[key] = record(Draw, block)
        except SceneError as error:
            place = f"draw.{key}.{error.key}" if error.key else f"draw.{key}"
            raise SceneError(place, error.problem) from None
    return draws_by_key


def drawn_values(draw: Mapping[str, Draw], seed: int, count: int) -> Iterator[dict[str, Any]]:
    """Yields the drawn values of each scene by key; the same seed gives the same values.

    draw: distributions by key.
    count: number of scenes.
    """
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
        """Raises a ValueError for ends that are not allowed, or both or neither kind of ends."""
        check_ends(self.log, self.even)
        if (self.log is None) == (self.even is None):
            raise ValueError("got both or neither of log and even, expected one of them")

    @property
    def is_log(self) -> bool:
        """Whether the points are evenly spaced in logarithm."""
        return self.log is not None

    @property
    def values(self) -> tuple[float, ...]:
        """Returns the values of the key at all points, rising."""
        shares = [k / (self.points - 1) for k in range(self.points)]
        if self.log is not None:
            low, high = self.log
            return tuple(low * (high / low) ** share for share in shares)
        assert self.even is not None
        low, high = self.even
        return tuple(low + (high - low) * share for share in shares)


def read_robustness(path: Path) -> dict[str, Any]:
    """Returns a plan like config/robustness.yaml, with defaults. Raises UsageError."""
    return validated_config(path, "robustness", check_robustness)


def check_robustness(plan: Mapping[str, Any], path: Path = ROBUSTNESS_FILE) -> None:
    """Raises a ValueError for draws, axes or a base scene that are not allowed.

    plan: data that agrees with the schema.
    path: of its file, for errors and to find the scene.
    """
    _check_scene_classes(plan["scene_classes"], f"{path}: scene_classes")
    for kind, axes in (("maps", ("x", "y")), ("branches", ("along",))):
        for name, block in plan[kind].items():
            for axis in axes:
                record(KeyAxis, block[axis], f"{path}: {kind}.{name}.{axis}")
    if plan["scene_classes"] or plan["maps"] or plan["branches"]:
        load_scene(base_scene(plan, path))


def _check_scene_classes(scene_classes: Mapping[str, Any], place: str) -> None:
    """Raises a ValueError for draws that are not allowed, or a class that is like none above it.

    scene_classes: blocks of the plan, by name.
    place: of the classes, for errors.
    """
    classes_above: list[str] = []
    for name, scene_class in scene_classes.items():
        parent = scene_class["like"]
        if parent and parent not in classes_above:
            allowed = ", ".join(classes_above) or "none, because no class precedes it"
            raise ValueError(f"{place}.{name}.like: got {parent}, expected {allowed}")
        try:
            draws(scene_class["draw"])
        except SceneError as error:
            raise ValueError(f"{place}.{name}.{error.key}: {error.problem}") from None
        classes_above.append(name)


def base_scene(plan: Mapping[str, Any], path: Path = ROBUSTNESS_FILE) -> Path:
    """Returns the file of the scene that all others change, in `scenes/` beside the plan."""
    return path.parent / "scenes" / f"{plan['scene']}.yaml"


def plan_entry(plan: Mapping[str, Any], path: Path, kind: str, name: str) -> dict[str, Any]:
    """Returns the block of a class of scenes, a map or a branch in a plan.

    path: of the plan, for errors.
    kind {"scene_classes", "maps", "branches"}
    UsageError: the plan has no such block.
    """
    if name not in plan[kind]:
        raise UsageError(f"{path}: {kind}: got {name}, expected {', '.join(plan[kind])}")
    return plan[kind][name]


def draw_blocks(plan: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Returns the blocks of the draws of a class by key, with those of the class it is like.

    Its own blocks take precedence, and that class may be like a further one.

    plan: data of config/robustness.yaml.
    """
    scene_class = plan["scene_classes"][name]
    inherited = draw_blocks(plan, scene_class["like"]) if scene_class["like"] else {}
    return inherited | scene_class["draw"]


def limit_values(plan: Mapping[str, Any], name: str) -> dict[str, float | None]:
    """Returns the values of the limits to locate in a map, by name; None for `contact`.

    plan: data of config/robustness.yaml.
    """
    return {limit: plan["limits"].get(limit) for limit in plan["maps"][name]["limits"]}
