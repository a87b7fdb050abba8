"""What the design study calculates: config/design.yaml, checked.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from bearingwear.measures import LIMITED, Measure
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import Key, keyed, optional_numbers, setting
from bearingwear.scene.scene import PRELOAD_METHODS, Scene, key_of_scene
from bearingwear.scene.warmth import check_heat_capacities
from bearingwear.studies.axis import RisingAxis

FACTORS = tuple(2.0 ** (k / 2) for k in range(-6, 11))
"""Preloads of a map, over the scene's own preload: an eighth to 32 times."""

COARSE = FACTORS[::2]
"""Preloads of a map that only guides to the best preload, over the scene's own."""

CHECKED = ("0.80", "1.00", "1.25")
"""Preloads that both models solve, over the recommended one; as in file names."""

CHECKED_FIDELITIES = ("steady", "dynamic")
"""Models that solve these preloads."""


def _limit_key(measure: Measure) -> Key:
    """Returns the key of a scene file or an option that sets the limit of a measure."""
    meaning, bounds = measure.limit
    text = f"{meaning} ({measure.note})" if measure.note else meaning
    return Key(text, measure.key_unit, bounds)


NO_FRICTION = 0.0
"""Coordinate `friction` of a scene with friction.film, which has no single coefficient."""

LEAST_KEPT = 0.01
"""Share of its initial preload that each bearing must keep, so that its balls roll: below it, it
counts as lifted off."""

_LIMITS: Any = optional_numbers({name: _limit_key(measure) for name, measure in LIMITED.items()})


@dataclass(frozen=True, kw_only=True)
class DesignLimits(_LIMITS):
    """Limits of a design from new to the end of its life; None without a limit.

    Its keys are those of `bearingwear.measures.LIMITED`.
    """

    # fmt: off
    at_speed_only: bool = setting("Whether requirements hold at the speed of each case alone, not "
        "from its lowest speed to that", default=False)
    warmup_s: float | None = setting("Time from rest to the full speed of a warm-up in which new "
        "bearings must satisfy the requirements, too (if omitted, no warm-up)", "s", "[0, 1e9]",
        default=None)
    # fmt: on

    def check(self, scene: Scene, source: str) -> None:
        """Raises a SceneError for a limit or a warm-up that requires a key that a scene lacks.

        source: file of the scene.
        """
        for key in self.given:
            measure = LIMITED[key]
            for name in measure.needs:
                if scene.arrangement is None or getattr(scene.arrangement, name) is None:
                    problem = f"got nothing, expected a value for the required {measure.words}"
                    raise SceneError(f"arrangement.{name}", problem, source=source)
            if measure.block and getattr(scene, measure.block) is None:
                problem = f"got nothing, expected a block for the required {measure.words}"
                raise SceneError(measure.block, problem, source=source)
        if self.warmup_s is not None:
            for case in scene.in_cases.values():
                check_heat_capacities(case.sides, source)

    @property
    def given(self) -> dict[str, float]:
        """Returns the limits that are not None, by their keys."""
        limits = {name: getattr(self, name) for name in LIMITED}
        return {name: limit for name, limit in limits.items() if limit is not None}

    @property
    def effective(self) -> dict[str, float]:
        """Returns the limits that apply, by their keys: those given, and that no bearing lifts off.

        The latter is left out where limits apply at the speed of each case alone, without a
        warm-up. A given limit of the preload kept replaces it.
        """
        limits = self.given
        if not self.at_speed_only or self.warmup_s is not None:
            limits = {"preload_kept": LEAST_KEPT} | limits
        return {name: limits[name] for name in LIMITED if name in limits}

    @property
    def stored(self) -> dict[str, Any]:
        """Returns the settings that differ from their defaults, as plain data by their keys.

        `DesignLimits(**stored)` makes the same limits again.
        """
        stored: dict[str, Any] = dict(self.given)
        if self.at_speed_only:
            stored["at_speed_only"] = True
        if self.warmup_s is not None:
            stored["warmup_s"] = self.warmup_s
        return stored


@keyed
class MapAxes:
    """Values along the axes of a map."""

    preload_method: tuple[str, ...] = setting("Preload method", choices=PRELOAD_METHODS, least=1)
    friction: RisingAxis = setting("Ball-race friction coefficients", "1")
    shaft_speed_rpm: RisingAxis = setting("Shaft speeds", "rpm")
    preload_N: RisingAxis = setting("Initial axial preloads", "N")

    def __post_init__(self) -> None:
        """Raises SceneError for a method that is there twice."""
        if len(set(self.preload_method)) < len(self.preload_method):
            raise SceneError("preload_method", "got a method twice, expected each method once")

    @property
    def values(self) -> tuple[Sequence[Any], ...]:
        """Returns the values along each axis; the methods in the order of their flags."""
        methods = sorted(self.preload_method, key=PRELOAD_METHODS.index)
        return methods, self.friction, self.shaft_speed_rpm, self.preload_N


def largest_permitted_preload() -> float:
    """Returns the largest preload that a scene may have [N]."""
    preload_part = key_of_scene("operation.preload_N")
    assert preload_part is not None
    return preload_part.key.ends[1]


DIGITS = 3
"""Significant digits of a recommended preload, at least."""

_MOST_DECIMALS = 11
"""Most decimals of a recommended preload."""

_ROUNDING = 1e-9
"""Relative distance within which two preloads are the same."""


def round_number(target: float, low: float, high: float) -> float:
    """Returns the number with the fewest digits between two others, the nearest to a target.

    It has at least `DIGITS` significant digits, and lies strictly between low and high. If 11
    decimals are not enough, the target is returned.

    target: above 0.
    """
    for decimals in range(DIGITS - 1 - math.floor(math.log10(target)), _MOST_DECIMALS + 1):
        unit = 10.0**-decimals
        candidates = [round(target + k * unit, decimals) for k in (0, -1, 1)]
        inside = [p for p in candidates if low * (1.0 + _ROUNDING) < p < high * (1.0 - _ROUNDING)]
        if inside:
            return min(inside, key=lambda p: abs(p - target))
    return target


def scaled_preload(factor: float, preload: float) -> float:
    """Returns a preload times a factor, rounded to three significant digits [N].

    With a factor of 1, it is the preload with all its digits.
    """
    return preload if factor == 1.0 else float(f"{factor * preload:.3g}")


def axes_around(
    scene: Scene,
    frictions: Sequence[float],
    source: str = "scene",
    factors: Sequence[float] = FACTORS,
) -> MapAxes:
    """Returns the axes of a map with both methods, around a scene's own preload at its own speed.

    frictions: coefficients of the map.
    source: of the scene, for errors.
    factors: preloads over the scene's own.
    SceneError: a preload of zero.
    """
    centre = scene.operation.preload_N
    if centre <= 0.0:
        problem = f"got {centre:g}, expected a number > 0 as the centre of a map"
        raise SceneError("operation.preload_N", problem, source=source)
    around = {scaled_preload(factor, centre) for factor in factors}
    largest = largest_permitted_preload()
    preloads = {centre, *(preload for preload in around if preload <= largest)}
    return MapAxes(
        preload_method=PRELOAD_METHODS,
        friction=RisingAxis(frictions),
        shaft_speed_rpm=RisingAxis([scene.operation.shaft_speed_rpm]),
        preload_N=RisingAxis(sorted(preloads)),
    )
