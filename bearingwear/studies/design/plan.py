"""What the design study calculates: config/design.yaml, checked.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bearingwear.measures import LIMITED, Measure
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import Key, keyed, optional_numbers, setting
from bearingwear.scene.read import for_life, variant
from bearingwear.scene.scene import PRELOAD_METHODS, Scene, key_of_scene
from bearingwear.studies.axis import MOST_DECIMALS, RisingAxis, in_name, place_of_errors
from bearingwear.studies.solve import life_scene

FACTORS = tuple(2.0 ** (k / 2) for k in range(-6, 11))
"""Preloads of a map around a scene's own, over that one: an eighth to 32 times."""

COARSE = FACTORS[::2]
"""The same where the map is but a guide to the best preload."""

CHECKED = ("0.80", "1.00", "1.25")
"""Preloads that the dynamic model solves, over the recommended one; as in file names."""

CHECKED_FIDELITIES = ("steady", "dynamic")
"""By which they are solved."""


def _limit(one: Measure) -> Key:
    meaning, bounds = one.limit
    return Key(f"{meaning} ({one.note})" if one.note else meaning, one.key_unit, bounds)


LEAST_KEPT = 0.01
"""Share of its initial preload that each bearing must keep, so that its balls roll: below it, it
counts as lifted off."""

_LIMITS: Any = optional_numbers({name: _limit(one) for name, one in LIMITED.items()})


@dataclass(frozen=True, kw_only=True)
class DesignLimits(_LIMITS):
    """Limits of a design from new to the end of its life; None without a limit.

    Its keys are those of `bearingwear.measures.LIMITED`.
    """

    # fmt: off
    at_speed_only: bool = setting("Whether requirements hold at the speed of each case alone, not "
        "from its lowest speed to that", default=False)
    # fmt: on

    def check(self, scene: Scene, source: str) -> None:
        """Refuse a limit of what a scene does not have. Raises SceneError."""
        for key in self.given:
            one = LIMITED[key]
            for name in one.needs:
                if scene.arrangement is None or getattr(scene.arrangement, name) is None:
                    problem = f"got nothing, expected a value for the required {one.words}"
                    raise SceneError(f"arrangement.{name}", problem, source=source)
            if one.block and getattr(scene, one.block) is None:
                problem = f"got nothing, expected a block for the required {one.words}"
                raise SceneError(one.block, problem, source=source)

    @property
    def given(self) -> dict[str, float]:
        """The limits that are asked for."""
        return {name: limit for name in LIMITED if (limit := getattr(self, name)) is not None}

    @property
    def held(self) -> dict[str, float]:
        """The limits that there are: no bearing may lift off between the lowest speed and the full
        one.
        """
        standing = {} if self.at_speed_only else {"preload_kept": LEAST_KEPT}
        all_of_them = standing | self.given
        return {name: all_of_them[name] for name in LIMITED if name in all_of_them}

    @property
    def stored(self) -> dict[str, Any]:
        """What is asked for, as plain data."""
        return self.given | ({"at_speed_only": True} if self.at_speed_only else {})


@keyed
class MapAxes:
    preload_method: tuple[str, ...] = setting("Preload method", choices=PRELOAD_METHODS, least=1)
    friction: RisingAxis = setting("Ball-race friction coefficients", "1")
    shaft_speed_rpm: RisingAxis = setting("Shaft speeds", "rpm")
    preload_N: RisingAxis = setting("Initial axial preloads", "N")

    def __post_init__(self) -> None:
        if len(set(self.preload_method)) < len(self.preload_method):
            raise SceneError("preload_method", "got a method twice, expected each method once")

    @property
    def values(self) -> tuple[Sequence[Any], ...]:
        """Values along each axis; the methods in the order of their flags."""
        methods = sorted(self.preload_method, key=PRELOAD_METHODS.index)
        return methods, self.friction, self.shaft_speed_rpm, self.preload_N


def most_preload() -> float:
    """The largest preload that a scene may have [N]."""
    preload = key_of_scene("operation.preload_N")
    assert preload is not None
    return preload.key.ends[1]


def round_factor(factor: float, own: float) -> float:
    """A preload of a map around a scene's own, by the factor over that [N]."""
    return own if factor == 1.0 else float(f"{factor * own:.3g}")


def axes_around(
    scene: Scene,
    frictions: Sequence[float],
    source: str = "scene",
    factors: Sequence[float] = FACTORS,
) -> MapAxes:
    """A map by both methods around a scene's own preload, at its own speed.

    SceneError: a preload of nothing, which has nothing around it.
    """
    own = scene.operation.preload_N
    if own <= 0.0:
        problem = f"got {own:g}, expected a number > 0 as the centre of a map"
        raise SceneError("operation.preload_N", problem, source=source)
    around = {round_factor(factor, own) for factor in factors}
    return MapAxes(
        preload_method=PRELOAD_METHODS,
        friction=RisingAxis(frictions),
        shaft_speed_rpm=RisingAxis([scene.operation.shaft_speed_rpm]),
        preload_N=RisingAxis(
            sorted({own, *(value for value in around if value <= most_preload())})
        ),
    )


@keyed
class Beside:
    """Bearing under another assumption."""

    words: str = setting("The assumption, in words")
    changes: Mapping[str, Any] = setting("Keys to set in the scene", name="set")


@keyed
class Design:
    """The maps of a scene, and the limits to choose by."""

    map: MapAxes | None = setting("Axes of the design map", default=None)
    # fmt: off
    small_map: MapAxes | None = setting("Axes of a small design map, with at most a few hundred "
        "life calculations; the map is part of the main study if that study includes the scene",
        default=None)
    limits: DesignLimits = setting("Requirements, which apply from new to the end of life",
        default_factory=DesignLimits)
    beside: Mapping[str, Beside] = setting(
        "Assumptions under which the lives at the recommended preloads are recomputed",
        default_factory=dict)
    # fmt: on

    def __post_init__(self) -> None:
        if self.map and any(mu != round(mu, MOST_DECIMALS) for mu in self.map.friction):
            # as the files of its parts are named
            raise SceneError("map.friction", f"expected at most {MOST_DECIMALS} decimal places")
        if self.beside and not self.small_map:
            raise SceneError("beside", "got this key without small_map, expected both")


@keyed
class DesignPlan:
    """Everything in config/design.yaml."""

    scenes: Mapping[str, Design] = setting("Scenes for which a preload is chosen", least=1)

    @property
    def maps(self) -> dict[str, MapAxes]:
        return {name: one.map for name, one in self.scenes.items() if one.map}

    @property
    def small_maps(self) -> dict[str, MapAxes]:
        return {name: one.small_map for name, one in self.scenes.items() if one.small_map}

    @property
    def map_parts(self) -> dict[tuple[str, ...], tuple[str, str, float]]:
        """Scene, method and friction coefficient of each part of the maps, by its names."""
        return {
            (scene, method, in_name(mu, 3)): (scene, method, mu)
            for scene, axes in self.maps.items()
            for method in axes.preload_method
            for mu in axes.friction
        }

    def part_settings(self, part: tuple[str, str, float]) -> dict[str, Any]:
        """Settings of a part of a map besides the scene."""
        scene, method, mu = part
        return {
            "method": method,
            "friction": mu,
            "shaft_speed_rpm": self.maps[scene].shaft_speed_rpm,
            "preload_N": self.maps[scene].preload_N,
            "slip_limit": self.scenes[scene].limits.gyroscopic_slip_share,
        }

    def beside(self, scene: str) -> dict[str, dict[str, Any]]:
        """Other assumptions about a scene, as plain data by their names."""
        return {
            name: {"words": one.words, "set": dict(one.changes)}
            for name, one in self.scenes[scene].beside.items()
        }

    def check_scenes(self, folder: str | Path = "config/scenes") -> None:
        """Read every scene and look whether its map can be solved. Raises ValueError."""
        for name, design in self.scenes.items():
            path = Path(folder) / f"{name}.yaml"
            design.limits.check(life_scene(path), str(path))
            for other, one in design.beside.items():
                with place_of_errors(f"config/design.yaml: scenes.{name}.beside.{other}"):
                    for_life(variant(path, one.changes), str(path))
