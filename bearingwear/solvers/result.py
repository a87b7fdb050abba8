"""The result of a solve, independent of any file format."""

import functools
import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bearingwear.kernels.status import STATUS_NAMES, STATUS_SENTENCES
from bearingwear.sides import SHARED
from bearingwear.solvers.state import HISTORY

WITHOUT_PRELOAD = "no preload is set (operation.preload_N is 0), so the balls carry no load"


UNKNOWN_PARTS = frozenset({"part_temperature", "thermal_growth"})
"""NaN for a shaft or housing whose temperature is not known."""

MAY_BE_INFINITE = frozenset({"friction_used_by_gyroscopic_moment", "thermal_margin"})
"""Without load there is no friction to use, and where no heat grows there is no margin."""

_STIFFNESS = "axial_stiffness"
"""End of the names of stiffnesses, which need not be known between new and the end of life: a place
nearby may have no state."""

_OF_A_LIFE = frozenset({"life", "normalised_life", "loss_at_end"}) | {
    f"history_{name}" for name in {*HISTORY, "time"} - UNKNOWN_PARTS - MAY_BE_INFINITE
}


@dataclass
class Result:
    """Values of a solve, by the names of `bearingwear.results.variables`, in SI and radians."""

    values: dict[str, Any]
    attrs: dict[str, Any] = field(default_factory=dict)
    wall_time_s: float = 0.0  # of the solve alone

    @property
    def status(self) -> str:
        """Returns the name of the status."""
        return STATUS_NAMES[int(self.values["status"])]

    @functools.cached_property
    def scene(self) -> Mapping[str, Any]:
        """Returns the scene as plain data, empty if unknown; do not write to it."""
        return json.loads(self.attrs.get("scene", "{}"))

    @property
    def reason(self) -> str:
        """Returns the meaning of the status for this scene."""
        sentence = status_sentence(self.status, self.scene)
        phase = self.attrs.get("unsolved_phase")
        return f"in phase {phase}: {sentence}" if phase else sentence


def status_sentence(status: str, scene: Mapping[str, Any]) -> str:
    """Returns the meaning of a status for a scene, which may be empty if unknown."""
    if status == "preload_gone" and scene.get("operation", {}).get("preload_N") == 0.0:
        return WITHOUT_PRELOAD
    return STATUS_SENTENCES[status]


def not_finite(values: Mapping[str, Any], scene: Mapping[str, Any]) -> list[str]:
    """Returns the names of values of a solved case or life that must be finite and are not.

    One bearing of a pair may lack a value that the other one has; it is then NaN.

    values: result variables.
    scene: as plain data, see `Result.scene`.
    """
    if "end_criterion" not in values and _all_finite(values):
        return []  # this takes a tenth of the time of a look at every value
    is_pair = scene.get("arrangement") is not None
    return [
        name
        for name, value in _values_to_check(values)
        if not np.isfinite(value).all()
        and not (is_pair and name not in SHARED and _is_finite_in_a_bearing(value))
    ]


def _all_finite(values: Mapping[str, Any]) -> bool:
    """Returns whether every number is finite."""
    total = 0.0
    arrays = [np.empty(0)]
    for value in values.values():
        if isinstance(value, float):
            total += 0.0 * value  # NaN if the value is not finite
        else:
            arrays.append(np.asarray(value))
    return not math.isnan(total) and bool(np.isfinite(np.concatenate(arrays, axis=None)).all())


def _values_to_check(values: Mapping[str, Any]) -> Iterator[tuple[str, np.ndarray]]:
    """Yields names and values that must be finite, with 0 in place of permitted infinity.

    Of a life they are the values in `_OF_A_LIFE`, of whose stiffnesses the first and last alone.
    """
    is_life = "end_criterion" in values
    for name, any_value in values.items():
        if name in UNKNOWN_PARTS or (is_life and name not in _OF_A_LIFE):
            continue
        value = np.asarray(any_value)
        if value.dtype.kind != "f":
            continue
        if is_life and name.endswith(_STIFFNESS):
            value = value[..., [0, -1]]
        if name in MAY_BE_INFINITE:
            value = np.where(np.isposinf(value), 0.0, value)
        yield name, value


def _is_finite_in_a_bearing(value: np.ndarray) -> bool:
    """Returns whether a value of a pair is finite for one of its bearings at least.

    value: (2, ...), of both bearings.
    """
    return value.ndim > 0 and len(value) == 2 and any(np.isfinite(side).all() for side in value)
