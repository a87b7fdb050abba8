"""What the study of the extremes solves: config/extremes.yaml, checked, and its random scenes.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

import copy
import math
import random
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bearingwear.io.config import load_scene
from bearingwear.study.plan_file import known, read_plan

TIERS = ("race_control", "steady", "dynamic")

SPECIAL = (
    "ball_diameter_mm", "pitch_ratio", "fill", "loss_ratio", "stress_GPa", "speed_m_s",
    "outer_ratio", "radial_ratio", "rotating_ratio", "cage", "pocket_clearance_ratio",
    "guide_clearance_ratio",
)  # fmt: skip
"""Values drawn that are no keys of a scene; `bearingwear.study.stress` says what they stand for."""


@dataclass(frozen=True)
class Draw:
    """Where a value is drawn from."""

    scale: str | None  # log or even
    ends: tuple[float, float]
    of: tuple[Any, ...]
    share: float

    @classmethod
    def of_block(cls, given: Mapping[str, Any], where: str) -> "Draw":
        """From `{log: [1, 10], of: [0], share: 0.1}`.

        Raises
        ------
        ValueError
        """
        for key in given:
            known(key, ("log", "even", "of", "share"), where)
        scale = next((name for name in ("log", "even") if name in given), None)
        of = tuple(given.get("of", ()))
        low, high = (float(end) for end in given[scale]) if scale else (0.0, 0.0)
        if not (of or scale) or low > high or (scale == "log" and not low > 0.0):
            raise ValueError(f"{where}: given {dict(given)}; allowed two rising ends, or of")
        share = float(given.get("share", 0.0 if scale else 1.0))
        return cls(scale, (low, high), of, share)

    def __call__(self, chance: random.Random) -> Any:
        """A value."""
        if self.of and (self.scale is None or chance.random() < self.share):
            return chance.choice(self.of)
        low, high = self.ends
        if self.scale == "log":
            return math.exp(chance.uniform(math.log(low), math.log(high)))
        return chance.uniform(low, high)


@dataclass(frozen=True)
class Family:
    """Random scenes of one kind."""

    tier: str
    scenes: int
    draw: Mapping[str, Draw]

    def drawn(self, seed: int, count: int) -> Iterator[dict[str, Any]]:
        """What sets so many scenes apart; the same for the same seed."""
        for k in range(count):
            chance = random.Random(f"{seed}-{k}")
            yield {key: draw(chance) for key, draw in self.draw.items()}


@dataclass(frozen=True)
class Axis:
    """Points along a key of a scene."""

    key: str
    log: bool
    values: tuple[float, ...]

    @classmethod
    def of_block(cls, given: Mapping[str, Any], where: str) -> "Axis":
        """From `{key: operation.preload_N, log: [1, 10], points: 5}`.

        Raises
        ------
        ValueError
        """
        draw = Draw.of_block({k: v for k, v in given.items() if k not in ("key", "points")}, where)
        n = int(given["points"])
        if n < 2 or draw.scale is None:
            raise ValueError(f"{where}: given {dict(given)}; allowed two ends, 2 points or more")
        low, high = draw.ends
        shares = [k / (n - 1) for k in range(n)]
        if draw.scale == "log":
            values = [low * (high / low) ** share for share in shares]
        else:
            values = [low + (high - low) * share for share in shares]
        return cls(given["key"], draw.scale == "log", tuple(values))


@dataclass(frozen=True)
class Map:
    """Steady states over two axes."""

    title: str
    settings: Mapping[str, Any]
    x: Axis
    y: Axis
    limits: tuple[str, ...]


@dataclass(frozen=True)
class Branch:
    """Steady states followed along an axis, both ways."""

    title: str
    settings: Mapping[str, Any]
    along: Axis


LIMITS = ("contact", "gyroscopic_slip", "skid")


@dataclass(frozen=True)
class ExtremesPlan:
    """Everything in config/extremes.yaml."""

    scene: str
    families: Mapping[str, Family]
    maps: Mapping[str, Map]
    limits: Mapping[str, float]
    branches: Mapping[str, Branch]

    @classmethod
    def from_file(cls, path: str | Path) -> "ExtremesPlan":
        """Read and check the file.

        Raises
        ------
        SceneError
            One line.
        """
        return read_plan(path, cls._of)

    @classmethod
    def _of(cls, data: Mapping[str, Any]) -> "ExtremesPlan":
        return cls(
            data["scene"],
            _families(data["families"]),
            {name: _map(name, given) for name, given in data["maps"].items()},
            {name: float(data["limits"][name]) for name in LIMITS[1:]},
            {
                name: Branch(
                    given["title"],
                    given.get("set", {}),
                    Axis.of_block(given["along"], f"branches.{name}.along"),
                )
                for name, given in data["branches"].items()
            },
        )

    def jobs(self) -> list[tuple[str, str]]:
        """Kind and name of everything to solve."""
        return [
            (kind, name)
            for kind, blocks in (
                ("families", self.families),
                ("maps", self.maps),
                ("branches", self.branches),
            )
            for name in blocks
        ]

    def text(self, kind: str, name: str) -> str:
        """All that decides a job, to see when it changes."""
        return repr((self.scene, getattr(self, kind)[name], self.limits))

    def base(self, folder: str | Path = "config/scenes") -> dict[str, Any]:
        """The scene that all start from, as plain data."""
        return load_scene(Path(folder) / f"{self.scene}.yaml").to_dict()


def _families(data: Mapping[str, Any]) -> dict[str, Family]:
    families: dict[str, Family] = {}
    for name, given in data.items():
        where = f"families.{name}"
        known(given["tier"], TIERS, f"{where}.tier")
        draw: dict[str, Draw] = {}
        if "like" in given:
            known(given["like"], families, f"{where}.like")
            draw = dict(families[given["like"]].draw)
        for key, block in given["draw"].items():
            if "." not in key:
                known(key, SPECIAL, f"{where}.draw")
            draw[key] = Draw.of_block(block, f"{where}.draw.{key}")
        families[name] = Family(given["tier"], int(given["scenes"]), draw)
    return families


def _map(name: str, given: Mapping[str, Any]) -> Map:
    where = f"maps.{name}"
    for limit in given["limits"]:
        known(limit, LIMITS, f"{where}.limits")
    return Map(
        given["title"],
        given.get("set", {}),
        Axis.of_block(given["x"], f"{where}.x"),
        Axis.of_block(given["y"], f"{where}.y"),
        tuple(given["limits"]),
    )


def changed(base: Mapping[str, Any], drawn: Mapping[str, Any]) -> dict[str, Any]:
    """A scene's data with keys like `operation.preload_N` replaced."""
    data = copy.deepcopy(dict(base))
    for key, value in drawn.items():
        if "." not in key:
            continue
        *blocks, leaf = key.split(".")
        block = data
        for name in blocks:
            block = block[name]
        # the schema wants whole numbers where it says so
        block[leaf] = round(value) if key == "model.strips" else value
    return data
