"""Checks of random lives with worn grooves."""

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
"""Estimates, which a life may lack, and a rate that is not known from a state alone."""


def life_violations(scene: Scene, values: Mapping[str, Any]) -> list[str]:
    """Returns lines on what is wrong with a life; the list is empty for a valid one.

    A life that stops early, and has a status that says so, is valid; one that failed verification
    is not. A life of 0 is not checked.

    values: of the result of the life.
    """
    status = int(values["status"])
    if status == code.UNVERIFIED:
        return [STATUS_NAMES[status]]
    if status != code.OK or not values["life"] > 0.0:
        return []
    return [
        *_finiteness_violations(values),
        *_balance_violations(scene, values),
        *_wear_violations(scene, values),
    ]


def _finiteness_violations(values: Mapping[str, Any]) -> list[str]:
    """Returns a line for each value that is neither finite nor positive infinity.

    Estimates and temperatures, which a life may lack, are left out.

    values: of the result of the life, by name.
    """
    problems = []
    for name, value in values.items():
        if name in _MAY_BE_MISSING or name.endswith("part_temperature"):
            continue
        numbers = np.asarray(value, dtype=float)
        if not (np.isfinite(numbers) | np.isposinf(numbers)).all():
            problems.append(f"{name} is not finite")
    return problems


def _balance_violations(scene: Scene, values: Mapping[str, Any]) -> list[str]:
    """Returns lines on a preload that is not the spring's, and on a loss beyond the limit.

    The preload is compared under a constant force alone.

    values: of the result of the life, by name.
    """
    problems = []
    spring_force = scene.operation.preload_N
    if scene.operation.preload_method == "constant_force":
        preloads = values["history_residual_preload"]
        if not np.abs(preloads / spring_force - 1.0).max() <= 1e-6:
            problems.append(
                f"residual preload {preloads.min():g} to {preloads.max():g} N, "
                f"spring force {spring_force:g} N"
            )
    end = scene.wear.end_of_life
    assert end is not None
    limit = (end.ball_diameter_loss_um or np.inf) * parameters.UM
    if not values["loss_at_end"] <= (1.0 + _END_ERROR) * limit:
        problems.append(f"loss of {values['loss_at_end']:g} m exceeds the limit of {limit:g} m")
    return problems


def _wear_violations(scene: Scene, values: Mapping[str, Any]) -> list[str]:
    """Returns a line for each volume that breaks Archard's law, and for what does not increase.

    A worn volume at the end is compared with the integral of its rate over time. The deepest place
    of a groove must not become shallower, and time must increase.

    values: of the result of the life, by name.
    """
    problems = []
    time = values["history_time"]
    ball_factor, race_factor = parameters.wear_factors(scene)  # volume over the integral of QV
    volume_rates = {
        "history_race_worn_volume": scene.bearing.ball_count * race_factor * values["history_qv"],
        "history_one_ball_worn_volume": ball_factor * values["history_qv"].sum(axis=1),
    }
    for name, rate in volume_rates.items():
        # Where QV rises fivefold within eight steps, trapezoids err by 3 % themselves.
        volume = PchipInterpolator(time, rate).integrate(time[0], time[-1])
        if not np.abs(values[name][-1] / volume - 1.0).max() <= _VOLUME_ERROR:
            problems.append(f"{name} {values[name][-1]} differs from {volume}, computed from QV")
    if not (np.diff(values["history_deepest_groove"], axis=0) >= 0.0).all():
        problems.append("a groove becomes shallower")
    if not (np.diff(time) > 0.0).all():
        problems.append("time does not increase")
    return problems
