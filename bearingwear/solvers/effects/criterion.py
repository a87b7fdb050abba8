"""What ended a life: the measure, its value and its limit."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from bearingwear.measures import ENDS, Measure
from bearingwear.scene.arrangement import bearings_holding
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.scene import Scene
from bearingwear.sides import OF_ARRANGEMENT, SHARED


def value_along(
    measure: Measure, life: Mapping[str, Any], k: int, scene: Scene
) -> tuple[float, str]:
    """A measure [SI] at a step of a life, of the worse bearing of a pair, and its variable."""

    def at_step(name: str) -> np.ndarray:
        history = np.asarray(life[f"history_{name}"])
        of_each = len(scene.sides) > 1 and f"history_{name}" not in SHARED
        return history[:, k] if of_each else history[k]

    initial = np.array([side.operation.preload_N for side in scene.sides])
    return measure.critical(at_step, initial)


def criteria_of_case(scene: Scene, case: Mapping[str, Any]) -> dict[str, tuple[float, str]]:
    """The measure [SI] of each criterion of a scene that a case holds, and its variable."""
    end, preload = scene.wear.end_of_life, scene.operation.preload_N
    held = dict(case)
    for system, own in OF_ARRANGEMENT.items():
        if system not in held and own in held:
            holding = bearings_holding(scene.operation.preload_method)
            held[system] = holding * np.asarray(held[own])
    return {
        name: ENDS[name].critical(lambda one: np.asarray(held.get(one, np.nan)), preload)
        for name in (end.criteria if end else ())
        if held.keys() & {*ENDS[name].variables} and (preload or not ENDS[name].over_preload)
    }


class Passed(NamedTuple):
    measure: Measure
    value: float  # [SI]
    limit: float
    variable: str

    @property
    def excess(self) -> float:
        """Ratio of value to limit, or the reverse where less is worse."""
        return self.measure.excess(self.value, self.limit)

    @property
    def words(self) -> str:
        return self.measure.passed(self.value, self.limit, self.variable)


def criteria_passed(scene: Scene, case: Mapping[str, Any]) -> list[Passed]:
    """Each criterion that a case is beyond, the farthest first."""
    end = scene.wear.end_of_life
    found = [
        Passed(ENDS[name], value, end.criteria[name], variable)
        for name, (value, variable) in criteria_of_case(scene, case).items()
        if end and ENDS[name].is_passed(value, end.criteria[name])
    ]
    return sorted(found, key=lambda one: -one.excess)


def criterion_met(scene: Scene, values: Mapping[str, Any]) -> tuple[Measure, float] | None:
    """The criterion that ends a life, and its limit; None if none does."""
    name, end = CRITERIA[int(values["end_criterion"])], scene.wear.end_of_life
    if end is None or name not in ENDS or "history_ball_diameter_loss" not in values:
        return None
    return ENDS[name], end.criteria[name]


def end_attribute(scene: Scene, values: Mapping[str, Any]) -> dict[str, str]:
    """Attribute of a life that says which criterion ended it, at what value and limit."""
    met = criterion_met(scene, values)
    if met is None:
        return {}
    measure, limit = met
    value, name = value_along(measure, values, -1, scene)
    return {"ended_by": measure.reached(value, limit, name)}
