"""The criterion that ends a life: its measure, value and limit."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from bearingwear.measures import ENDS, Measure
from bearingwear.scene.arrangement import bearings_holding
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.scene import Scene
from bearingwear.sides import OF_ARRANGEMENT, SHARED


def criteria_of_case(scene: Scene, case: Mapping[str, Any]) -> dict[str, tuple[float, str]]:
    """Returns the critical value [SI] and its variable by the names of a scene's criteria.

    A criterion is left out if the case contains none of its variables, or if it compares with a
    preload and the scene has none.

    case: result variables of the solved scene.
    """
    end, preload = scene.wear.end_of_life, scene.operation.preload_N
    values = dict(case)
    for system_name, bearing_name in OF_ARRANGEMENT.items():
        if system_name not in values and bearing_name in values:
            holding = bearings_holding(scene.operation.preload_method)
            values[system_name] = holding * np.asarray(values[bearing_name])

    def known_value(variable: str) -> Any:
        """Returns the value of a variable; NaN if the case does not contain it."""
        return values.get(variable, np.nan)

    critical = {}
    for name in end.criteria if end else ():
        measure = ENDS[name]
        is_known = any(variable in values for variable in measure.variables)
        if is_known and (preload or not measure.over_preload):
            critical[name] = measure.critical(known_value, preload)
    return critical


class Reached(NamedTuple):
    """A criterion, and a value that has reached its limit."""

    measure: Measure
    limit: float  # [as in the scene]
    value: float  # [SI]
    variable: str

    @property
    def excess(self) -> float:
        """Returns the ratio of value to limit, or its inverse where less is worse."""
        return self.measure.excess(self.value, self.limit)

    @property
    def phrase(self) -> str:
        """Returns value and limit in words."""
        return self.measure.violation_phrase(self.value, self.limit, self.variable)


def criteria_passed(scene: Scene, case: Mapping[str, Any]) -> list[Reached]:
    """Returns the criteria whose limits a case violates, the most violated one first.

    A limit that is met exactly does not count. Empty without criteria.

    case: result variables of the solved scene.
    """
    end = scene.wear.end_of_life
    if end is None:
        return []
    reached = [
        Reached(measure=ENDS[name], limit=end.criteria[name], value=value, variable=variable)
        for name, (value, variable) in criteria_of_case(scene, case).items()
        if ENDS[name].is_passed(value, end.criteria[name])  # beyond the limit: a failure
    ]
    return sorted(reached, key=lambda criterion: -criterion.excess)


def criterion_met(scene: Scene, life: Mapping[str, Any], k: int) -> Reached | None:
    """Returns the criterion that ends a life, with its value at a step; None if none does.

    None also if the life has no histories. In a pair, the value is that of the worse bearing.

    life: result variables of the life.
    k: index of the step in the histories.
    """
    name, end = CRITERIA[int(life["end_criterion"])], scene.wear.end_of_life
    if end is None or name not in ENDS or "history_ball_diameter_loss" not in life:
        return None

    def at_step(variable: str) -> np.ndarray:
        """Returns a variable at the step; (2, ...) if each bearing of a pair has its own."""
        history = np.asarray(life[f"history_{variable}"])
        is_by_bearing = len(scene.sides) > 1 and f"history_{variable}" not in SHARED
        return history[:, k] if is_by_bearing else history[k]

    initial = np.array([side.operation.preload_N for side in scene.sides])
    value, variable = ENDS[name].critical(at_step, initial)
    return Reached(measure=ENDS[name], limit=end.criteria[name], value=value, variable=variable)


def end_attribute(scene: Scene, values: Mapping[str, Any]) -> dict[str, str]:
    """Returns the attribute `ended_by` of a life: its criterion with value and limit, in words.

    It is left out if no criterion ends the life.
    """
    met = criterion_met(scene, values, -1)
    if met is None:
        return {}
    return {"ended_by": met.measure.criterion_phrase(met.value, met.limit, met.variable)}
