"""Where a requirement must hold: from the lowest speed to the full one, as warm as then and cold.

Nothing heavy is imported: sheets name conditions by this file.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.duty import cases_of_use
from bearingwear.scene.scene import Scene
from bearingwear.scene.slip import at_share

SPEED_SHARES = (0.0, 0.0625, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875)
"""Speeds that are looked at beside the full one: of the way from the lowest speed to that."""

SLOW_SHARE = 0.125
"""Speeds up to this share of the full one are looked at with all parts as cold as mounted, too."""

_MOST_COLD = 2  # speeds
AS_RUNNING, MOUNTING, WARMING = "running", "mounting", "warming"
NEW, BETWEEN, AT_END_OF_LIFE = "new", "between", "worn"

DECIDING = "deciding"
"""Attribute of a recommendation: of each method and quantity where it is the worst; of a point,
the same of its quantities."""

CONDITIONS = "conditions"
"""Attribute of a recommendation: the conditions that were looked at, as plain data."""

AT_SPEED_ONLY = "at_speed_only"
"""Attribute of a recommendation: 1 where each case was looked at at its own speed alone."""

_WARMTH = ("temperature", "thermal")


class OperatingCondition(NamedTuple):
    """A scene at a speed and at temperatures at which it may have to work."""

    scene: Scene
    temperature: str = AS_RUNNING

    def where(self, **more: Any) -> dict[str, Any]:
        """The place as plain data."""
        speed = speed_of(self.scene)
        return {
            "case": NOMINAL,
            "speed_rpm": speed,
            "temperature": self.temperature,
            "bearing": 0,
            **more,
        }


def speed_of(scene: Scene) -> float:
    """Speed by which a condition is named: of the shaft, or of the outer race that alone turns."""
    operation = scene.operation
    return operation.shaft_speed_rpm or abs(operation.outer_speed_rpm)


def lowest_share(scene: Scene) -> float:
    """The lowest speed of a scene over its full one."""
    operation = scene.operation
    full = operation.shaft_speed_rpm
    return operation.lowest_speed_rpm / full if full else 0.0


def as_mounted(scene: Scene) -> Scene:
    """A scene with all parts at mounting temperature."""
    a = scene.arrangement
    if a is not None and a.second:
        kept = {key: v for key, v in a.second.items() if key.partition(".")[0] not in _WARMTH}
        # two bearings that differ by their wear alone stay two
        nothing = {"operation.tilt_mrad": scene.operation.tilt_mrad}
        a = replace(a, second=kept or nothing)
    return replace(scene, arrangement=a, temperature=None, thermal=None)


def is_warm(scene: Scene) -> bool:
    """Whether some part is not at mounting temperature."""
    second = scene.arrangement.second if scene.arrangement is not None else {}
    return bool(scene.temperature or scene.thermal) or any(
        key.partition(".")[0] in _WARMTH for key in second
    )


def shares_beside(scene: Scene) -> list[float]:
    """Shares of its speed at which a scene is looked at beside the full one, the lowest first."""
    lowest = lowest_share(scene)
    if not scene.operation.fastest_rpm or lowest >= 1.0:
        return []
    return [lowest + share * (1.0 - lowest) for share in SPEED_SHARES]


def cold_places(scene: Scene) -> list[OperatingCondition]:
    """Rest and slow speeds with all parts at mounting temperature, of a scene that is warmer."""
    if not is_warm(scene):
        return []
    shares = [share for share in shares_beside(scene) if share <= SLOW_SHARE][:_MOST_COLD]
    if not scene.operation.fastest_rpm:
        shares = [1.0]  # at rest
    return [OperatingCondition(as_mounted(at_share(scene, share)), MOUNTING) for share in shares]


def conditions_of(
    scene: Scene, at_speed_only: bool = False, warms_up: bool = False
) -> list[dict[str, Any]]:
    """All conditions of a scene and its cases, as plain data."""
    found = []
    for name, one in cases_of_use(scene).items():
        places = [OperatingCondition(one)]
        if not at_speed_only:
            places += [OperatingCondition(at_share(one, share)) for share in shares_beside(one)]
            places += cold_places(one)
        places += [OperatingCondition(one, WARMING)] if warms_up else []
        found += [
            {"case": name, "speed_rpm": speed_of(p.scene), "temperature": p.temperature}
            for p in places
        ]
    return found


def speed_words(speed: float) -> str:
    """A speed [r/min] in as many digits as name it, without a power of ten."""
    return f"{speed:.0f} r/min" if speed >= 100.0 else f"{speed:.3g} r/min"


def warm_up_time(where: Mapping[str, Any]) -> str:
    """The time of an instant of a warm-up."""
    return f"{where['time_s']:.3g} s"


def condition_words(where: Mapping[str, Any], cases: bool = False) -> str:
    """A condition in words, `at 3000 r/min, new`; its case too, if that is asked for."""
    speed = where["speed_rpm"]
    words = f"at {speed_words(speed)}" if speed else "at rest"
    if where["temperature"] == MOUNTING:
        words += " and mounting temperature"
    if where["temperature"] == WARMING:
        words += f", {warm_up_time(where)} into the warm-up"
    wear = {NEW: "new", AT_END_OF_LIFE: "at the end of life", BETWEEN: "during the life"}
    if where.get("wear"):
        words += f", {wear[where['wear']]}"
    if where.get("bearing"):
        words += f", bearing {where['bearing']}"
    return f"{words} (case {where['case']})" if cases else words
