"""Input of the warnings: a scene, and the states of its result."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.growth import part_temperatures
from bearingwear.solvers.effects.choice import Choice
from bearingwear.solvers.state import State

INNER_SIDE, OUTER_SIDE = 0, 1

Finding = dict[str, Any]
"""Values that complete the sentence of a warning. They include `value` and `limit`, or their ratio
`excess`; a plain fact has neither."""

_UNKNOWN = (math.nan, math.nan)
_UNKNOWN_STATUS = -1


@dataclass(frozen=True)
class Evidence:
    """A scene and a state of it, of which only temperatures are known if it was not verified."""

    scene: Scene
    chosen: Choice
    state: State
    life: Mapping[str, Any] | None = None  # values of a life
    case: Mapping[str, Any] | None = None  # values of a case

    def contacts(self, name: str) -> np.ndarray:
        """Returns a variable in every contact (n, 2); NaN (1, 2) where it is not known."""
        return np.atleast_2d(self.state.values.get(name, _UNKNOWN))

    def mean(self, name: str) -> float:
        """Returns the mean of a variable over the balls; NaN where it is not known."""
        return float(np.mean(self.state[name]))


_SOLVED = (
    "contact_load",
    "contact_angle",
    "semi_major_axis",
    "maximum_pressure",
    "ball_diameter_loss",
)


def evidence_of(scene: Scene, chosen: Choice, values: Mapping[str, Any]) -> Iterator[Evidence]:
    """Yields the evidence of a case, or that of the first and of the last state of a life.

    Before a solve, and for a solve that failed or was not verified, it has only temperatures: those
    of the values, else of the scene.

    values: result variables of the case or life, or none before a solve.
    """
    status = int(values.get("status", _UNKNOWN_STATUS))
    prefix = "history_" if "end_criterion" in values else ""
    temperatures = values.get(prefix + "part_temperature", part_temperatures(scene))
    temperature_values = {"part_temperature": np.atleast_2d(temperatures)[-1]}
    is_solved = all(np.size(values.get(prefix + name, ())) for name in _SOLVED)
    is_unverified = not prefix and status not in (_UNKNOWN_STATUS, code.OK)
    if not is_solved or is_unverified:
        yield Evidence(scene, chosen, State(status, temperature_values))
    elif not prefix:
        yield Evidence(scene, chosen, State(status, temperature_values | dict(values)), case=values)
    else:
        histories = {
            name.removeprefix(prefix): value
            for name, value in values.items()
            if name.startswith(prefix)
        }
        for k in (0, -1):
            state = {name: np.asarray(value)[k] for name, value in histories.items()}
            yield Evidence(scene, chosen, State(status, temperature_values | state), life=values)
