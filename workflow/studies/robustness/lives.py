"""Random lives with worn grooves: what must hold of each."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator

from bearingwear.kernels import status as code
from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters

WORN_LIFE = "worn_life"
"""The `fidelity` of a class of random lives."""

_VOLUME_ERROR = 0.05  # of the worn volume against the integral of QV through the steps of a life
_END_ERROR = 1e-3  # of the limit that ends a life
_MAY_BE_MISSING = frozenset(
    {"life_error_estimate", "life_error_bound", "history_ball_diameter_loss_rate"}
)
"""Estimates that were not found, and what is not known from a state alone."""


def life_violations(scene: Scene, values: Mapping[str, Any]) -> list[str]:
    """What is wrong with a life: nothing, where it ended as it may.

    A life that stops short says so by its status, and is a lower bound.
    """
    status = int(values["status"])
    if status == code.UNVERIFIED:
        return [STATUS_NAMES[status]]
    if status != code.OK or not values["life"] > 0.0:
        return []
    return [*_not_finite(values), *_balances(scene, values), *_wear(scene, values)]


def _not_finite(values: Mapping[str, Any]) -> list[str]:
    found = []
    for name, value in values.items():
        numbers = np.asarray(value, dtype=float)
        known = np.isfinite(numbers) | np.isposinf(numbers)
        temperatures = name.endswith("part_temperature")
        if not (name in _MAY_BE_MISSING or temperatures or known.all()):
            found.append(f"{name} is not finite")
    return found


def _balances(scene: Scene, values: Mapping[str, Any]) -> list[str]:
    preload, found = scene.operation.preload_N, []
    if scene.operation.preload_method == "constant_force":
        held = values["history_residual_preload"]
        if not np.abs(held / preload - 1.0).max() <= 1e-6:
            found.append(
                f"residual preload {held.min():g} to {held.max():g} N, spring force {preload:g} N"
            )
    end = scene.wear.end_of_life
    assert end is not None
    limit = (end.ball_diameter_loss_um or np.inf) * parameters.UM
    if not values["loss_at_end"] <= (1.0 + _END_ERROR) * limit:
        found.append(f"loss of {values['loss_at_end']:g} m exceeds the limit of {limit:g} m")
    return found


def _wear(scene: Scene, values: Mapping[str, Any]) -> list[str]:
    """Volumes by Archard's law, and depths that only grow."""
    time, found = values["history_time"], []
    ball, race = parameters.wear_factors(scene)
    worn = {
        "history_race_worn_volume": scene.bearing.ball_count * race * values["history_qv"],
        "history_one_ball_worn_volume": ball * values["history_qv"].sum(axis=1),
    }
    for name, rate in worn.items():
        # Where QV rises fivefold within eight steps, trapezoids err by 3 % themselves.
        volume = PchipInterpolator(time, rate).integrate(time[0], time[-1])
        if not np.abs(values[name][-1] / volume - 1.0).max() <= _VOLUME_ERROR:
            found.append(f"{name} {values[name][-1]} differs from {volume}, computed from QV")
    if not (np.diff(values["history_deepest_groove"], axis=0) >= 0.0).all():
        found.append("a groove becomes shallower")
    if not (np.diff(time) > 0.0).all():
        found.append("time does not increase")
    return found
