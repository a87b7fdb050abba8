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
    """Result variables of a life; both bearings of an unlike pair are along `bearing`."""
    values: dict = {"status": life.status, "end_criterion": life.criterion}
    start = life.nodes[0]
    if start.status != code.OK:
        return values
    wears = all(state.rate > 0.0 for state in start.states)
    if not wears and life.status != code.OK:  # no time is a lower bound of it
        return values
    factor, _ = parameters.wear_factors(scene)
    times = life.times
    values |= {
        "life": times[-1],
        "normalised_life": times[-1] * factor,
        "life_error_bound": life.error,
        "history_time": times,
    }
    each = []
    for side, states in zip(scene.sides, life.bearings, strict=True):
        histories = history_values(states) | film_values(side, states, times)
        each.append(histories | {"loss_at_end": states[-1].loss})
    return values | joined(each)


def joined(each: Sequence[dict]) -> dict:
    """Values of one bearing; of two those of the pair, and what they share from the first."""
    if len(each) == 1:
        return each[0]
    shared = {name: value for name, value in each[0].items() if name in SHARED}
    own = [{n: v for n, v in one.items() if n not in SHARED} for one in each]
    return shared | stacked_sides(own)


def film_values(scene: Scene, states: Sequence[State], times: np.ndarray) -> dict:
    """Friction coefficients, films left and when each is worn through; empty without any film."""
    films = Films.of(scene)
    values: dict = {}
    if scene.friction.film is not None:
        values |= history_values(states, ["friction_coefficient"])
    if not films.wear_through:
        return values
    left = history_values(states, ["film_left"])["history_film_left"]  # (steps, 3)
    wear_through_times = [_time_of_nothing(times, part) for part in left.T]
    left = np.maximum(left, 0.0)
    values |= history_values(states, ["film_worn_share"])
    if films.race.film is not None:
        values["history_race_film"] = left[:, :2]
        values["race_film_worn_through"] = np.array(wear_through_times[:2])
    if films.ball.film is not None:
        values["history_ball_film"] = left[:, 2]
        values["ball_film_worn_through"] = wear_through_times[2]
    return values


def _time_of_nothing(time: np.ndarray, left: np.ndarray) -> float:
    """When a film is gone, between the steps about it; NaN where it is not."""
    gone = np.flatnonzero(left <= 0.0)
    if not gone.size:
        return float("nan")
    about = slice(max(gone[0] - 1, 0), gone[0] + 1)
    return float(np.interp(0.0, -left[about], time[about]))
