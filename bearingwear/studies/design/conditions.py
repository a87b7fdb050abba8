"""Conditions in which requirements must hold: all speeds up to the full one, warm and cold.

Nothing heavy is imported: sheets name conditions by this file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.duty import cases_of_use
from bearingwear.scene.scene import Scene
from bearingwear.scene.slip import at_speed_share

SPEED_SHARES = (0.0, 0.0625, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875)
"""Speeds at which limits apply beside the full one, as shares of the way to it from the lowest."""

FINE_SHARES = tuple(k / 16.0 for k in range(16))
"""The same as `SPEED_SHARES`, but finer: for worn bearings at the end of an exact life.

Slip has a peak where the balls change over from one motion to another, which may hide between two
eighths.
"""

SLOW_SHARE = 0.125
"""Share of the full speed up to which limits apply at mounting temperature, too."""

_MOST_COLD_SPEEDS = 2  # the lowest speed and one above it
AS_RUNNING, MOUNTING, WARMING = "running", "mounting", "warming"
NEW, BETWEEN, AT_END_OF_LIFE = "new", "between", "worn"

DECIDING = "deciding"
"""Attribute of a recommendation: for each method, the condition in which each quantity is worst.
Key of a point: the condition in which each of its quantities is worst."""

CONDITIONS = "conditions"
"""Attribute of a recommendation: the conditions in which limits apply, as plain data."""

AT_SPEED_ONLY = "at_speed_only"
"""Attribute of a recommendation: 1 where limits apply at the speed of each case alone."""

_WARMTH_BLOCKS = ("temperature", "thermal")  # of a scene


class OperatingCondition(NamedTuple):
    """A scene at a speed and at temperatures at which limits apply."""

    scene: Scene
    temperature: str = AS_RUNNING

    def where(self, **more: Any) -> dict[str, Any]:
        """Returns the condition as plain data, with further keys.

        The keys are `case` (the nominal one), `speed_rpm`, `temperature` and `bearing` (0, which
        stands for all bearings). Each key of `more` is added, or replaces one of these.
        """
        return {
            "case": NOMINAL,
            "speed_rpm": speed_of(self.scene),
            "temperature": self.temperature,
            "bearing": 0,
            **more,
        }


def speed_of(scene: Scene) -> float:
    """Returns the speed that names a condition [r/min].

    It is the shaft speed or, if the shaft stands, the magnitude of the speed of the outer race.
    """
    operation = scene.operation
    return operation.shaft_speed_rpm or abs(operation.outer_speed_rpm)


def lowest_share(scene: Scene) -> float:
    """Returns the lowest shaft speed of a scene over its full one; zero if the shaft stands."""
    operation = scene.operation
    full_speed = operation.shaft_speed_rpm
    return operation.lowest_speed_rpm / full_speed if full_speed else 0.0


def as_mounted(scene: Scene) -> Scene:
    """Returns a scene with all parts at mounting temperature.

    As many bearings are solved as before, even if the second differs in its temperatures alone.
    """
    arrangement = scene.arrangement
    if arrangement is not None and arrangement.second:
        second = {key: value for key, value in arrangement.second.items() if not _is_of_warmth(key)}
        # a second bearing without a difference would not be solved, and its wear would be lost
        no_difference = {"operation.tilt_mrad": scene.operation.tilt_mrad}
        arrangement = replace(arrangement, second=second or no_difference)
    return replace(scene, arrangement=arrangement, temperature=None, thermal=None)


def _is_of_warmth(key: str) -> bool:
    """Returns whether a key of a scene belongs to a block on temperatures."""
    return key.partition(".")[0] in _WARMTH_BLOCKS


def is_warm(scene: Scene) -> bool:
    """Returns whether some part is not at mounting temperature."""
    second = scene.arrangement.second if scene.arrangement is not None else {}
    return bool(scene.temperature or scene.thermal) or any(map(_is_of_warmth, second))


def lower_speed_shares(scene: Scene, shares: Sequence[float] = SPEED_SHARES) -> list[float]:
    """Returns shares of the full speed, below 1 and rising, at which limits apply as well.

    The list is empty at rest, and where the lowest speed is the full one.

    shares: of the way from the lowest speed to the full one.
    """
    lowest = lowest_share(scene)
    if not scene.operation.fastest_rpm or lowest >= 1.0:
        return []
    return [lowest + share * (1.0 - lowest) for share in shares]


def cold_conditions(scene: Scene) -> list[OperatingCondition]:
    """Returns the conditions at the lowest speeds at mounting temperature.

    The list is empty if no part has another temperature, or if the lowest speed is above
    `SLOW_SHARE` of the full one.
    """
    if not is_warm(scene):
        return []
    shares = [1.0]  # a scene at rest has no lower speed
    if scene.operation.fastest_rpm:
        shares = [share for share in lower_speed_shares(scene) if share <= SLOW_SHARE]
    return [
        OperatingCondition(as_mounted(at_speed_share(scene, share)), MOUNTING)
        for share in shares[:_MOST_COLD_SPEEDS]
    ]


def conditions_of(
    scene: Scene, at_speed_only: bool = False, warms_up: bool = False
) -> list[dict[str, Any]]:
    """Returns all conditions of a scene and its cases, as plain data.

    Their keys are `case`, `speed_rpm` and `temperature`.

    at_speed_only: whether to leave out lower speeds and mounting temperature.
    warms_up: whether to add a warm-up of each case.
    """
    plain_conditions = []
    for name, case in cases_of_use(scene).items():
        conditions = [OperatingCondition(case)]
        if not at_speed_only:
            shares = lower_speed_shares(case)
            conditions += [OperatingCondition(at_speed_share(case, share)) for share in shares]
            conditions += cold_conditions(case)
        if warms_up:
            conditions.append(OperatingCondition(case, WARMING))
        for condition in conditions:
            plain_conditions.append(
                {
                    "case": name,
                    "speed_rpm": speed_of(condition.scene),
                    "temperature": condition.temperature,
                }
            )
    return plain_conditions


def speed_words(speed: float) -> str:
    """Returns a speed [r/min] as text without a power of ten."""
    return f"{speed:.0f} r/min" if speed >= 100.0 else f"{speed:.3g} r/min"


def warm_up_time_words(where: Mapping[str, Any]) -> str:
    """Returns the time of an instant of a warm-up as text, such as "12.3 s".

    where: the instant as plain data, with the key `time_s`.
    """
    return f"{where['time_s']:.3g} s"


def condition_words(where: Mapping[str, Any], has_cases: bool = False) -> str:
    """Returns a condition in words, such as "at 3000 r/min, new"; a speed of 0 is "at rest".

    where: plain data with the keys of `OperatingCondition.where` and, if known, `wear`.
    has_cases: whether to name the case.
    """
    speed = where["speed_rpm"]
    words = f"at {speed_words(speed)}" if speed else "at rest"
    if where["temperature"] == MOUNTING:
        words += " and mounting temperature"
    if where["temperature"] == WARMING:
        words += f", {warm_up_time_words(where)} into the warm-up"
    wear_words = {NEW: "new", AT_END_OF_LIFE: "at the end of life", BETWEEN: "during the life"}
    if where.get("wear"):
        words += f", {wear_words[where['wear']]}"
    if where.get("bearing"):
        words += f", bearing {where['bearing']}"
    return f"{words} (case {where['case']})" if has_cases else words
