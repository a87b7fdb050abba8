"""Estimates of the numerical errors of lives over a duty, by lives with other settings.

`lives/errors.py` holds what they have in common with other lives.
"""

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
from bearingwear.lives.errors import WEIGHTS, relative_life_change
from bearingwear.lives.follow import Life
from bearingwear.lives.grooves import EXACT_GROOVES, QUICK_GROOVES, GrooveMode, Grooves
from bearingwear.lives.surfaces import is_one_integral, steps_error
from bearingwear.scene.scene import Scene
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.estimates import ROUNDING


def duty_errors(scene: Scene, over_duty: DutyLife, fidelity: str) -> dict[str, float]:
    """Returns result variables of the errors of a life over a duty.

    They are `life_error_bound`, by the steps [s], and `life_error_estimate`, by all settings and
    relative to the life. With starts, `ramp_error_estimate` is the error by the points of the
    ramps, 1 where it is not known. A life without an end has only the bound. The estimate is left
    out where it is not known, as by another fidelity than `steady`.
    """
    life, cycle = over_duty.life, over_duty.cycle
    length = life.last.time
    if life.status != code.OK or not length > 0.0:
        return {"life_error_bound": life.error}
    values = {}
    if cycle.starting.any():
        errors = []
        for node in (life.nodes[0], life.last):
            losses = [state.loss for state in node.states[: cycle.bearings]]
            errors.append(ramp_error(scene, cycle.points, losses, fidelity))
        is_known = np.isfinite(errors).any()
        values["ramp_error_estimate"] = float(np.nanmax(errors)) if is_known else 1.0
    if over_duty.is_worn:
        bound, estimate = _groove_errors(cycle, life)
    else:
        wearing = DutySurfaces(cycle, [way.solver for way in life.wearing.ways])
        bound = steps_error(wearing, DutyCriteria(cycle), cycle.scenes[0], life)
        estimate = ROUNDING + bound / length
        estimate += _accuracy_error(cycle, life) if fidelity == "steady" else math.nan
    estimate += values.get("ramp_error_estimate", 0.0)
    values["life_error_bound"] = bound
    if math.isfinite(estimate):
        values["life_error_estimate"] = estimate
    return values


def _groove_errors(cycle: Cycle, life: Life) -> tuple[float, float]:
    """Returns a bound on the error of the steps [s], and the relative error of steps and cells [1].

    They come from a life with longer steps, and one that also has fewer cells. A figure is NaN
    where a life that it needs ends by another criterion or status.
    """

    def length(mode: GrooveMode) -> float:
        """Returns the length of the life in a mode [s]; NaN if it ends by another criterion."""
        other = worn_duty_life(cycle, mode, Grooves)
        return other.last.time if other.ends_like(life) else math.nan

    coarse = length(QUICK_GROOVES._replace(cells=EXACT_GROOVES.cells))
    few_cells = length(QUICK_GROOVES)
    bound = 2.0 * abs(coarse - life.last.time)
    return bound, ROUNDING + (bound + abs(few_cells - coarse)) / life.last.time


def _accuracy_error(cycle: Cycle, life: Life) -> float:
    """Returns the relative error of a life by the slip regularisation and by quadrature points [1].

    It is the weighted sum of the changes by each accuracy of `WEIGHTS`; NaN where one is not known.
    """
    total = 0.0
    for accuracy, weight in WEIGHTS.items():
        solvers = [solver_of(scene, "steady", accuracy) for scene in cycle.scenes]
        if is_one_integral(cycle.scenes[0]):
            change = _change_by_wearing(life, DutySurfaces(cycle, solvers), cycle)
        else:
            other = hertzian_duty_life(cycle, solvers, quick=True)
            is_alike = other.ends_like(life)
            change = abs(other.last.time / life.last.time - 1.0) if is_alike else math.nan
        total += weight * change
    return total


def _change_by_wearing(life: Life, wearing: DutySurfaces, cycle: Cycle) -> float:
    """Returns the magnitude of the relative change of a life by other states along it [1].

    NaN where a state is not solved, or another criterion ends the life.

    wearing: way to wear with the other states.
    """
    nodes = life.three_nodes()
    others = [node._replace(states=wearing.state(np.array([node.x]))) for node in nodes]
    if any(other.status != code.OK for other in others):
        return math.nan
    slowing = [
        life.wearing.loss_rate(node) / wearing.loss_rate(other) - 1.0
        for node, other in zip(nodes, others, strict=True)
    ]
    criteria = DutyCriteria(cycle)
    change = relative_life_change(life, np.array(slowing), nodes, others[-1].states, criteria)
    return math.nan if change is None else float(change)
