"""Wear life of two bearings on a rotor: each has its own losses (theory.md section 19)."""

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.model import parameters
from bearingwear.model.estimate import DOUBLED, HALVED, ROUNDING, changed
from bearingwear.model.film_values import film_values
from bearingwear.model.life import (
    error_estimate,
    life_history,
    life_values,
    lives_along,
    wear_path,
)
from bearingwear.model.pair import Pair, SteadySide
from bearingwear.model.pair_case import stacked_sides
from bearingwear.model.state import State, history_values
from bearingwear.model.states_at_loss import race_control_states, steady_states
from bearingwear.model.wear_path import Condition, Course, KnownStates, States
from bearingwear.scene.scene import COUNTS, Scene
from bearingwear.sides import SHARED

LIFE_BALANCED = 1e-9  # force left on the rotor in a state of a life, over the larger one


def pair_life(scene: Scene, fidelity: str) -> tuple[dict, dict]:
    """Values and attributes of a life of two bearings whose contacts stay Hertzian."""
    a = scene.pair
    assert a is not None
    if a.is_symmetric:
        side = scene.sides[0]
        states = steady_states if fidelity == "steady" else race_control_states
        history = life_history(side, states(side))
        values = life_values(side, history)
        values |= error_estimate(side, history) if fidelity == "steady" else {}
        return of_both(values, values), {"solves": history.solves}
    return _unequal_life(scene, fidelity)


def pair_states(
    scene: Scene,
    fidelity: str,
    balance: float = LIFE_BALANCED,
    perturbed: int | None = None,
) -> KnownStates:
    """States of a pair, balanced as well as a life needs.

    `perturbed` is which of `ThrustProblem.perturbed` is solved, instead of the scene's own problem.
    """
    pair = Pair.of(scene, fidelity, balance)
    for side in pair.sides:
        if not isinstance(side, SteadySide):
            continue
        if perturbed is None:
            side.problem = side.problem.without_finer
        else:
            side.problem = side.problem.perturbed(side.scene)[perturbed]

    def solve(conditions: tuple[Condition, ...]) -> States:
        for side, one in zip(pair.sides, conditions, strict=True):
            side.bare = one.bare
        first, second = (one.loss for one in conditions)
        found = pair.solve((first, second))
        if found.status != code.OK:
            return tuple(State.unsolved(found.status, one.loss) for one in conditions)
        each = zip(pair.sides, conditions, found.sides, strict=True)
        return tuple(
            side.life_state(one.loss, state).with_values(found.of_arrangement)
            for side, one, state in each
        )

    return KnownStates(solve)


def _unequal_life(scene: Scene, fidelity: str) -> tuple[dict, dict]:
    states, own = pair_states(scene, fidelity), COUNTS.index(scene.wear.counts)
    course, times, error = lives_along(scene, states)
    values: dict = {"status": course.status, "end_criterion": course.criterion}
    start = course.states[0]
    if any(one.status != code.OK or not one.rate.min() > 0.0 for one in start):
        return values, {"solves": states.solves}
    factor, _ = parameters.wear_factors(scene)
    values |= {
        "life": times[-1],
        "normalised_life": times[-1] * factor,
        "life_error_bound": error,
        "history_time": times,
    }
    each = []
    for side, along in zip(scene.sides, zip(*course.states, strict=True), strict=True):
        each.append(history_values(list(along)) | film_values(side, along, times))
        each[-1]["loss_at_end"] = along[-1].loss
    values |= of_both(*each)
    if fidelity == "steady" and course.status == code.OK and times[-1, own] > 0.0:
        values |= _error_estimate(scene, own, course, error[own] / times[-1, own])
    return values, {"solves": states.solves}


def of_both(first: dict, second: dict) -> dict:
    """Values of two lives as those of one pair; what they share is that of the first."""
    shared = {name: value for name, value in first.items() if name in SHARED}
    own = [{n: v for n, v in one.items() if n not in SHARED} for one in (first, second)]
    return shared | stacked_sides(own)


def _error_estimate(scene: Scene, own: int, course: Course, integration: float) -> dict:
    """Estimated numerical error of a life: the same with other settings (see `estimate`)."""
    total, now = np.full(len(COUNTS), np.nan), np.array(course.times[-1])
    total[own] = ROUNDING + integration
    for weight, k in ((HALVED, 0), (DOUBLED, 1)):
        states = pair_states(scene, "steady", perturbed=k)
        other = wear_path(scene, states, own, scene.model.tolerance).integrate()
        if (other.status, other.criterion) != (course.status, course.criterion):
            return {}
        total[own] += weight * float(changed(now, np.array(other.times[-1])))
    return {"life_error_estimate": total}
