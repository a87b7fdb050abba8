"""Result variables of films along a life."""

import numpy as np

from bearingwear.model.films import Films
from bearingwear.model.life_integrator import LifeHistory
from bearingwear.scene.scene import COUNTS, Scene


def film_values(scene: Scene, history: LifeHistory) -> dict:
    """Friction coefficients, films left and when each is worn through; empty without any film."""
    films, states = Films.of(scene), history.states
    values: dict = {}
    if scene.friction.film is not None:
        values["history_friction_coefficient"] = np.array([s.friction for s in states])
    if not films.wear_through:
        return values
    left = np.array([s.film for s in states])  # (steps, 3)
    time = np.array(history.times)[:, COUNTS.index(scene.wear.counts)]
    through = [time[np.argmax(gone)] if gone.any() else np.nan for gone in (left <= 0.0).T]
    values["history_film_worn_share"] = np.array([s.film_worn for s in states])
    if films.race.film is not None:
        values["history_race_film"] = left[:, :2]
        values["race_film_worn_through"] = np.array(through[:2])
    if films.ball.film is not None:
        values["history_ball_film"] = left[:, 2]
        values["ball_film_worn_through"] = through[2]
    return values
