"""Result variables of films along a life."""

from collections.abc import Sequence

import numpy as np

from bearingwear.model.films import Films
from bearingwear.model.state import State, history_values
from bearingwear.scene.scene import COUNTS, Scene


def film_values(scene: Scene, states: Sequence[State], times: np.ndarray) -> dict:
    """Friction coefficients, films left and when each is worn through; empty without any film."""
    films = Films.of(scene)
    values: dict = {}
    if scene.friction.film is not None:
        values |= history_values(states, ["friction_coefficient"])
    if not films.wear_through:
        return values
    left = np.array([state["film_left"] for state in states])  # (steps, 3)
    time = times[:, COUNTS.index(scene.wear.counts)]
    through = [_time_of_nothing(time, part) for part in left.T]
    left = np.maximum(left, 0.0)
    values |= history_values(states, ["film_worn_share"])
    if films.race.film is not None:
        values["history_race_film"] = left[:, :2]
        values["race_film_worn_through"] = np.array(through[:2])
    if films.ball.film is not None:
        values["history_ball_film"] = left[:, 2]
        values["ball_film_worn_through"] = through[2]
    return values


def _time_of_nothing(time: np.ndarray, left: np.ndarray) -> float:
    """When a film is gone, between the steps about it; NaN where it is not."""
    gone = left <= 0.0
    if not gone.any():
        return float("nan")
    k = int(np.argmax(gone))
    if k == 0 or left[k] == 0.0:
        return float(time[k])
    share = left[k - 1] / (left[k - 1] - left[k])
    return float(time[k - 1] + share * (time[k] - time[k - 1]))
