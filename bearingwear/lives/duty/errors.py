"""Numerical errors of lives over a duty, by lives with other settings (see `lives/errors.py`)."""

import math

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.duty.cycle import Cycle
from bearingwear.lives.duty.lives import (
    DutyLife,
    hertzian_duty_life,
    ramp_error,
    worn_duty_life,
)
from bearingwear.lives.duty.wearing import DutyCriteria, DutySurfaces
from bearingwear.lives.errors import WEIGHTS, changed_by
from bearingwear.lives.follow import Life
from bearingwear.lives.grooves import EXACT_GROOVES, QUICK_GROOVES, Grooves
from bearingwear.lives.surfaces import is_one_integral, steps_error
from bearingwear.scene.scene import Scene
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.estimates import ROUNDING


def duty_errors(scene: Scene, found: DutyLife, fidelity: str) -> dict[str, float]:
    """Bound on the error of the steps [s], and estimates of all and of the ramps alone."""
    life, cycle = found.life, found.cycle
    length = life.last.time
    if life.status != code.OK or not length > 0.0:
        return {"life_error_bound": life.error}
    values = {}
    if cycle.starting.any():
        losses = [[state.loss for state in node.states] for node in (life.nodes[0], life.last)]
        each = [ramp_error(scene, cycle.points, one[: cycle.bearings], fidelity) for one in losses]
        values["ramp_error_estimate"] = float(np.nanmax(each)) if np.isfinite(each).any() else 1.0
    if found.is_worn:
        bound, estimate = _groove_errors(cycle, life)
    else:
        solvers = [way.states for way in life.wearing.each]
        wearing = DutySurfaces(cycle, solvers)
        bound = steps_error(wearing, DutyCriteria(cycle), cycle.scenes[0], life)
        estimate = ROUNDING + bound / length
        estimate += _of_accuracies(cycle, life) if fidelity == "steady" else math.nan
    estimate += values.get("ramp_error_estimate", 0.0)
    values["life_error_bound"] = bound
    return values | ({"life_error_estimate": estimate} if math.isfinite(estimate) else {})


def _groove_errors(cycle: Cycle, life: Life) -> tuple[float, float]:
    """Bound on the error of the steps [s], and estimate of that of steps and cells."""
    modes = QUICK_GROOVES._replace(cells=EXACT_GROOVES.cells), QUICK_GROOVES
    lives = [worn_duty_life(cycle, mode, Grooves) for mode in modes]
    coarse, few = (
        one.last.time if (one.status, one.criterion) == (life.status, life.criterion) else math.nan
        for one in lives
    )
    bound = 2.0 * abs(coarse - life.last.time)
    return bound, ROUNDING + (bound + abs(few - coarse)) / life.last.time


def _of_accuracies(cycle: Cycle, life: Life) -> float:
    """Relative error of a life by v_r and by points; NaN where it is not known."""
    total = 0.0
    for accuracy, weight in WEIGHTS.items():
        solvers = [solver_of(one, "steady", accuracy) for one in cycle.scenes]
        if is_one_integral(cycle.scenes[0]):
            change = _changed_along(DutySurfaces(cycle, solvers), cycle, life)
        else:
            other = hertzian_duty_life(cycle, solvers, quick=True)
            is_alike = (other.status, other.criterion) == (life.status, life.criterion)
            change = abs(other.last.time / life.last.time - 1.0) if is_alike else math.nan
        total += weight * change
    return total


def _changed_along(other: DutySurfaces, cycle: Cycle, life: Life) -> float:
    """Relative change of a life by other states at its start, middle and end; or NaN."""
    nodes = [life.nodes[k] for k in (0, len(life.nodes) // 2, -1)]
    others = [node._replace(states=other.state(np.array([node.x]))) for node in nodes]
    if any(node.status != code.OK for node in others):
        return math.nan
    each = zip(nodes, others, strict=True)
    longer = [life.wearing.loss_rate(node) / other.loss_rate(one) - 1.0 for node, one in each]
    change = changed_by(life, np.array(longer), nodes, others[-1].states, DutyCriteria(cycle))
    return math.nan if change is None else float(change)
