"""What the design study calculates: config/design.yaml, checked.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from bearingwear.study.grid import PRELOAD_METHODS
from bearingwear.study.plan_file import read_plan

AT = ("given", "recommended")
"""The preloads at which life is spread: the scene's own, and the recommended one."""

CHECKED = ("0.80", "1.00", "1.25")
"""Preloads at which the recommended one is solved in time as well, over it; as in file names."""

MOST_POINTS = 1000
SAMPLES = 256
"""Base samples of the spread of a single life, where none are given."""


@dataclass(frozen=True)
class Limits:
    """What a design must keep to from new to the end of its life; None where there is no limit."""

    gyroscopic_slip_share: float | None = None
    axial_stiffness_N_um: float | None = None
    maximum_pressure_GPa: float | None = None
    friction_power_W: float | None = None

    @property
    def given(self) -> dict[str, float]:
        """The limits that there are."""
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        return {name: value for name, value in values.items() if value is not None}


@dataclass(frozen=True)
class DesignMap:
    """Axes of a map of lives, and the limits to choose by."""

    preload_method: tuple[str, ...]
    friction: tuple[float, ...]
    shaft_speed_rpm: tuple[float, ...]
    preload_N: tuple[float, ...]
    limits: Limits

    @property
    def lives(self) -> int:
        """How many lives the map holds."""
        axes = (self.preload_method, self.friction, self.shaft_speed_rpm, self.preload_N)
        return math.prod(map(len, axes))

    def chunks(self) -> list[str]:
        """Names of the parts of the map, each a job: one method and one friction coefficient."""
        return [f"{method}-mu{mu:.3f}" for method in self.preload_method for mu in self.friction]

    def text(self) -> str:
        """All that decides a part of the map, to see when it changes."""
        return json.dumps([self.shaft_speed_rpm, self.preload_N, self.limits.gyroscopic_slip_share])


@dataclass(frozen=True)
class Sampling:
    """How the uncertain values are sampled.

    Attributes
    ----------
    samples : int
        Base samples, a power of two.
    chunks : int
        Jobs that share them.
    seed : int
    """

    samples: int
    chunks: int
    seed: int


@dataclass(frozen=True)
class Statements:
    """What a text states about a bearing; all at fixed position."""

    preload_loss: float
    preload_loss_at_um: float
    high_friction: float
    low_friction: float
    qv_least_um: tuple[float, float]
    qv_rise: float
    qv_rise_at_um: float


@dataclass(frozen=True)
class Family:
    """Bearings to look through for those that fit what is stated."""

    scene: str
    marks: tuple[str, ...]
    pitch_diameter_mm: tuple[float, ...]
    ball_count: tuple[int, ...]
    inner_groove_factor: tuple[float, ...]
    contact_angle_deg: tuple[float, ...]
    drag_density_kg_m3: tuple[float, ...]
    statements: Statements

    def text(self) -> str:
        """All that decides the family, to see when it changes."""
        return str(self)


@dataclass(frozen=True)
class DesignPlan:
    """Everything in config/design.yaml."""

    scenes: Mapping[str, DesignMap]
    sampling: Sampling
    family: Family

    @classmethod
    def from_file(cls, path: str | Path) -> DesignPlan:
        """Read and check the file.

        Raises
        ------
        SceneError
            One line: file, key, what was given, what is allowed.
        """
        return read_plan(path, cls._of)

    @classmethod
    def _of(cls, data: Any) -> DesignPlan:
        _keys(data, ("scenes", "uncertainty", "family"), "")
        scenes = {
            str(name): _map(given, f"scenes.{name}")
            for name, given in _block(data["scenes"], "scenes").items()
        }
        return cls(scenes, _sampling(data["uncertainty"]), _family(data["family"]))

    def check_scenes(self, folder: str | Path = "config/scenes") -> None:
        """Read every scene and look whether its map can be solved.

        Raises
        ------
        ValueError
            One line.
        """
        for name in self.scenes:
            design_scene(Path(folder) / f"{name}.yaml")
        for name in (self.family.scene, *self.family.marks):
            if not (Path(folder) / f"{name}.yaml").is_file():
                raise ValueError(f"config/design.yaml: family: there is no scene {name}")


def design_scene(path: str | Path, settings: Sequence[str] = ()) -> Any:
    """A scene whose lives can be mapped: it has an end of life and a steady state.

    Raises
    ------
    SceneError
        One line.
    """
    from bearingwear.io.config import for_life, load_scene
    from bearingwear.model.fidelity import choice_for_life
    from bearingwear.model.scene import SceneError

    scene = for_life(load_scene(path, settings), os.fspath(path))
    tier = choice_for_life(scene).tier
    if tier != "steady":
        raise SceneError(
            "",
            f"given a scene whose life is found by {tier}; allowed one with a steady state",
            source=os.fspath(path),
        )
    if not scene.uncertainty:
        raise SceneError(
            "uncertainty",
            "given nothing; allowed at least one distribution",
            source=os.fspath(path),
        )
    for name, given in scene.uncertainty.items():
        # not an error of the scene: other values may be set in it, which no spread is asked of
        if given.distribution == "lognormal" and (given.median or scene.nominal(name)) <= 0.0:
            raise SceneError(
                f"uncertainty.{name}.median",
                f"given {scene.nominal(name):g}, the scene's own value; allowed, for a lognormal, "
                "a number > 0",
                source=os.fspath(path),
            )
    return scene


def _map(given: Any, where: str) -> DesignMap:
    _keys(given, ("map", "limits"), where)
    axes = _keys(
        given["map"],
        ("preload_method", "friction", "shaft_speed_rpm", "preload_N"),
        f"{where}.map",
    )
    methods = axes["preload_method"]
    if not isinstance(methods, list) or not methods or not set(methods) <= set(PRELOAD_METHODS):
        raise ValueError(
            f"{where}.map.preload_method: given {methods}; allowed {', '.join(PRELOAD_METHODS)}"
        )
    names = [f.name for f in fields(Limits)]
    frictions = _axis(axes["friction"], f"{where}.map.friction")
    if any(mu != round(mu, 3) for mu in frictions):  # as the files are named
        raise ValueError(f"{where}.map.friction: allowed numbers of at most three decimals")
    limits = _block(given["limits"], f"{where}.limits")
    for name, value in limits.items():
        if name not in names:
            raise ValueError(f"{where}.limits.{name}: unknown key; allowed {', '.join(names)}")
        _positive(value, f"{where}.limits.{name}")
    return DesignMap(
        tuple(dict.fromkeys(methods)),
        frictions,
        _axis(axes["shaft_speed_rpm"], f"{where}.map.shaft_speed_rpm"),
        _axis(axes["preload_N"], f"{where}.map.preload_N"),
        Limits(**{name: float(value) for name, value in limits.items()}),
    )


def _axis(given: Any, where: str) -> tuple[float, ...]:
    """Rising values: a list of them, or first, last and step."""
    if isinstance(given, list):
        values = [_positive(value, where) for value in given]
        if not values or values != sorted(set(values)):
            raise ValueError(f"{where}: given {given}; allowed rising numbers > 0")
        return tuple(values)
    _keys(given, ("first", "last", "step"), where)
    first, last, step = (
        _positive(given[key], f"{where}.{key}") for key in ("first", "last", "step")
    )
    count = round((last - first) / step) + 1
    if not 1 <= count <= MOST_POINTS or abs(first + (count - 1) * step - last) > 1e-6 * step:
        raise ValueError(
            f"{where}: given {first:g} to {last:g} by {step:g}; allowed at most {MOST_POINTS} "
            "steps that end at the last value"
        )
    return tuple(round(first + k * step, 9) for k in range(count))


def _sampling(given: Any) -> Sampling:
    _keys(given, ("samples", "chunks", "seed"), "uncertainty")
    return checked_sampling(given, "uncertainty.")


def checked_sampling(given: Mapping[str, Any], before: str) -> Sampling:
    """A sampling from its numbers; `before` stands before their names in messages.

    Raises
    ------
    ValueError
        One line.
    """
    for key, value in given.items():
        least = 0 if key == "seed" else 1
        if not isinstance(value, int) or isinstance(value, bool) or value < least:
            raise ValueError(f"{before}{key}: given {value}; allowed a whole number >= {least}")
    if given["samples"] & (given["samples"] - 1):
        raise ValueError(f"{before}samples: given {given['samples']}; allowed a power of two")
    if given["chunks"] > given["samples"]:
        raise ValueError(f"{before}chunks: given {given['chunks']}; allowed at most the samples")
    return Sampling(given["samples"], given["chunks"], given["seed"])


def _family(given: Any) -> Family:
    where = "family"
    _keys(given, tuple(f.name for f in fields(Family)), where)
    stated = _keys(
        given["statements"], tuple(f.name for f in fields(Statements)), f"{where}.statements"
    )
    for name in (given["scene"], *given["marks"]):
        if not isinstance(name, str):
            raise ValueError(f"{where}: given {name}; allowed names of scenes")
    axes = {
        name: _axis(given[name], f"{where}.{name}")
        for name in (
            "pitch_diameter_mm", "ball_count", "inner_groove_factor", "contact_angle_deg",
            "drag_density_kg_m3",
        )
    }  # fmt: skip
    least = _axis(stated["qv_least_um"], f"{where}.statements.qv_least_um")
    if len(least) != 2:
        raise ValueError(f"{where}.statements.qv_least_um: allowed two rising numbers")
    numbers = {
        name: _positive(value, f"{where}.statements.{name}")
        for name, value in stated.items()
        if name != "qv_least_um"
    }
    return Family(
        scene=given["scene"],
        marks=tuple(given["marks"]),
        ball_count=tuple(map(int, axes.pop("ball_count"))),
        statements=Statements(qv_least_um=(least[0], least[1]), **numbers),
        **axes,
    )


def _block(given: Any, where: str) -> Mapping[str, Any]:
    if not isinstance(given, dict) or not given:
        raise ValueError(f"{where}: given {given}; allowed a block of keys")
    return given


def _keys(given: Any, names: tuple[str, ...], where: str) -> Mapping[str, Any]:
    """A block with just these keys."""
    _block(given, where or "the file")
    for key in [*names, *given]:
        if key not in given or key not in names:
            path = f"{where}.{key}" if where else str(key)
            what = "unknown key" if key in given else "given nothing"
            raise ValueError(f"{path}: {what}; allowed {', '.join(names)}")
    return given


def _positive(value: Any, where: str) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool) or not 0 < value < math.inf:
        raise ValueError(f"{where}: given {value}; allowed a number > 0")
    return float(value)
