"""What ended a life: the measure, its value and its limit."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from bearingwear.measures import ENDS, Measure
from bearingwear.scene.arrangement import bearings_holding
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.scene import Scene
from bearingwear.sides import OF_ARRANGEMENT, SHARED


def criteria_of_case(scene: Scene, case: Mapping[str, Any]) -> dict[str, tuple[float, str]]:
    """The measure [SI] of each criterion of a scene that a case holds, and its variable."""
    end, preload = scene.wear.end_of_life, scene.operation.preload_N
    held = dict(case)
    for system, own in OF_ARRANGEMENT.items():
        if system not in held and own in held:
            holding = bearings_holding(scene.operation.preload_method)
            held[system] = holding * np.asarray(held[own])
    return {
        name: ENDS[name].critical(lambda one: held.get(one, np.nan), preload)
        for name in (end.criteria if end else ())
        if held.keys() & {*ENDS[name].variables} and (preload or not ENDS[name].over_preload)
    }


class Reached(NamedTuple):
    """A criterion, and a value that has reached its limit."""

    measure: Measure
    limit: float
    value: float  # [SI]
    variable: str

    @property
    def excess(self) -> float:
        """Ratio of value to limit, or the reverse where less is worse."""
        return self.measure.excess(self.value, self.limit)

    @property
    def words(self) -> str:
        return self.measure.violation_phrase(self.value, self.limit, self.variable)


def criteria_passed(scene: Scene, case: Mapping[str, Any]) -> list[Reached]:
    """Each criterion that a case is beyond, the farthest first."""
    end = scene.wear.end_of_life
    found = [
        Reached(ENDS[name], end.criteria[name], *critical)
        for name, critical in criteria_of_case(scene, case).items()
        if end and ENDS[name].is_passed(critical[0], end.criteria[name])
    ]
    return sorted(found, key=lambda one: -one.excess)


def criterion_met(scene: Scene, life: Mapping[str, Any], k: int) -> Reached | None:
    """The criterion that ends a life, with its value at a step; None if none does.

    The value is that of the worse bearing of a pair.
    """
    name, end = CRITERIA[int(life["end_criterion"])], scene.wear.end_of_life
    if end is None or name not in ENDS or "history_ball_diameter_loss" not in life:
        return None

    def at_step(variable: str) -> np.ndarray:
        history = np.asarray(life[f"history_{variable}"])
        of_each = len(scene.sides) > 1 and f"history_{variable}" not in SHARED
        return history[:, k] if of_each else history[k]

    initial = np.array([side.operation.preload_N for side in scene.sides])
    return Reached(ENDS[name], end.criteria[name], *ENDS[name].critical(at_step, initial))


def end_attribute(scene: Scene, values: Mapping[str, Any]) -> dict[str, str]:
    """Attribute of a life that says which criterion ended it, at what value and limit."""
    met = criterion_met(scene, values, -1)
    if met is None:
        return {}
    return {"ended_by": met.measure.criterion_phrase(met.value, met.limit, met.variable)}
