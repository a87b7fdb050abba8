"""Result variables of a life: its length, and the states along it."""

from collections.abc import Sequence

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.follow import Life
from bearingwear.scene.scene import Scene
from bearingwear.sides import SHARED
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.arrangement import stacked_sides
from bearingwear.solvers.bearing.films import Films
from bearingwear.solvers.state import State, history_values


def life_values(scene: Scene, life: Life) -> dict:
    """Returns the result variables of a life [SI]; those of two bearings are stacked by `joined`.

    They are its status and criterion alone if its start is not solved, or if a bearing does not
    wear and no criterion is met.
    """
    values: dict = {"status": life.status, "end_criterion": life.criterion}
    start = life.nodes[0]
    if start.status != code.OK:
        return values
    wears = all(state.rate > 0.0 for state in start.states)
    if not wears and life.status != code.OK:  # the length is not even a lower bound
        return values
    factor, _ = parameters.wear_factors(scene)
    times = life.times
    values |= {
        "life": times[-1],
        "normalised_life": times[-1] * factor,
        "life_error_bound": life.error,
        "history_time": times,
    }
    values_by_bearing = [
        history_values(states) | film_values(side, states, times) | {"loss_at_end": states[-1].loss}
        for side, states in zip(scene.sides, life.bearings, strict=True)
    ]
    return values | joined(values_by_bearing)


def joined(values_by_bearing: Sequence[dict]) -> dict:
    """Returns the values of one bearing, or those of two stacked along a first dimension.

    Values that the bearings of a pair share, those of `SHARED`, are not stacked: they are taken
    from the first.

    values_by_bearing: result variables of one or two bearings, by name.
    """
    if len(values_by_bearing) == 1:
        return values_by_bearing[0]
    shared = {name: value for name, value in values_by_bearing[0].items() if name in SHARED}
    unshared = [
        {name: value for name, value in values.items() if name not in SHARED}
        for values in values_by_bearing
    ]
    return shared | stacked_sides(unshared)


def film_values(scene: Scene, states: Sequence[State], times: np.ndarray) -> dict:
    """Returns result variables of films along a life [m], and times when they are worn through [s].

    A time is NaN where a film outlasts the life. Without any film the dictionary is empty; with one
    that never wears through, it has the friction coefficient alone.

    times: of the states [s].
    """
    films = Films.of(scene)
    values: dict = {}
    if scene.friction.film is not None:
        values |= history_values(states, ["friction_coefficient"])
    if not films.wear_through:
        return values
    left = history_values(states, ["film_left"])["history_film_left"]  # (steps, 3)
    wear_through_times = [_time_worn_through(times, part) for part in left.T]
    left = np.maximum(left, 0.0)
    values |= history_values(states, ["film_worn_share"])
    if films.race.film is not None:
        values["history_race_film"] = left[:, :2]
        values["race_film_worn_through"] = np.array(wear_through_times[:2])
    if films.ball.film is not None:
        values["history_ball_film"] = left[:, 2]
        values["ball_film_worn_through"] = wear_through_times[2]
    return values


def _time_worn_through(time: np.ndarray, left: np.ndarray) -> float:
    """Returns the time at which a film is gone [s], linear between two states; NaN if it never is.

    time: of the states (n,) [s].
    left: thickness left in them (n,) [m]; negative by what has worn beyond the film.
    """
    without = np.flatnonzero(left <= 0.0)
    if not without.size:
        return float("nan")
    around = slice(max(without[0] - 1, 0), without[0] + 1)
    return float(np.interp(0.0, -left[around], time[around]))
