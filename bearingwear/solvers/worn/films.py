"""Films and running in along worn grooves: point by point on the races, even on the balls."""

from dataclasses import dataclass

import numpy as np

from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.films import Films, Surface
from bearingwear.solvers.worn.depths import WornDepths

FILM_EDGE = 0.05
"""Share of its thickness below which a film no longer covers all of its place, assumed."""

FILM_END_SHARE = 1e-3
"""Share of its thickness that may be left where a film counts as gone."""

LEAST_WANDER = 0.1
"""Least rms of a track's wander at the edge of a film, in semi-major axes: about a cell."""

AS_WITH_FILM = -1.0
"""Stands for a friction coefficient that does not change where no film is left."""


def film_cover(surface: Surface, depth: np.ndarray | float) -> np.ndarray:
    """Returns the share of each place that its film still covers at a worn depth [m].

    It falls from 1 to 0 over the last `FILM_EDGE` of the film; 0 without a film.
    """
    if surface.film is None:
        return np.zeros_like(depth, dtype=float)
    remaining = np.maximum(surface.thickness - np.asarray(depth, dtype=float), 0.0)
    if np.isinf(surface.thickness):
        return np.ones_like(remaining)
    return np.minimum(remaining / (FILM_EDGE * surface.thickness), 1.0)


@dataclass(frozen=True)
class WornFilms:
    """Films of a scene whose balls wear evenly."""

    films: Films
    bare_friction: float  # coefficient where no film is left, or `AS_WITH_FILM` [1]

    @classmethod
    def of(cls, scene: Scene) -> "WornFilms":
        """Returns the films of a scene."""
        film = scene.friction.film
        films = Films.of(scene)
        if film is None or not films.wear_through or film.bare_ball_race is None:
            return cls(films, AS_WITH_FILM)
        return cls(films, film.bare_ball_race)

    def cover_of_race(self, depth: np.ndarray, spread: float) -> np.ndarray:
        """Returns the share of each place that its film covers, averaged over the track's wander.

        depth: at equal steps of the groove [m].
        spread: rms of the wander in these steps.
        """
        from scipy.ndimage import gaussian_filter1d  # loads slowly; most bearings have no film

        return gaussian_filter1d(film_cover(self.films.race, depth), spread, truncate=6.0)

    def bare(self, race_depth: np.ndarray, ball_depth: float, spread: float) -> np.ndarray:
        """Returns the share of each place of a groove on which no film is left [1].

        A place is covered by the race's film or by the balls', whichever covers more. 0 where no
        film can wear through.

        race_depth, spread: as `depth` and `spread` of `cover_of_race`.
        ball_depth: worn off the balls [m].
        """
        if not self.films.wear_through:
            return np.zeros_like(race_depth)
        on_race = self.cover_of_race(race_depth, spread)
        return 1.0 - np.maximum(on_race, film_cover(self.films.ball, ball_depth))

    def factors(
        self,
        on_race: np.ndarray,
        race_depth: np.ndarray,
        ball_depth: float,
        pressure: float = np.nan,
        temperature: float = np.nan,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Returns K_s/H of ball and race at each place of a track [1/Pa].

        They are in proportion to the cover of each film.

        on_race: share of each place that the film of the race covers.
        race_depth, ball_depth: worn off [m].
        pressure: peak pressure of the unworn contact [Pa].
        temperature: of the contact [degC].
        """
        on_ball = film_cover(self.films.ball, ball_depth)
        table_factor = self.films.table_factor(pressure, temperature)
        return self.films.factors(on_ball, on_race, ball_depth, race_depth, table_factor)

    def bare_parts(self, wear: WornDepths) -> np.ndarray:
        """Returns whether the deepest place of each film begins to be bare, and is bare (2, 3).

        Columns: inner race, outer race, balls; False for a part without a film.
        """
        ends = np.array([[1.0 - FILM_EDGE], [1.0]])
        thickness = self.films.thickness
        return (thickness > 0.0) & (wear.deepest > (ends - FILM_END_SHARE) * thickness)

    def longest_time(self, wear: WornDepths, rate: WornDepths, share: float, least: float) -> float:
        """Returns the time in which a film wears by a share of its thickness, or begins to go [s].

        While its deepest place becomes bare, it is half of the time from the first bare share to
        the whole. Once it is bare, the film beside it goes: half of the share is allowed, but at
        least the time `least` [s]. Infinite without a film that wears.

        rate: wear per second.
        """
        shortest = np.inf
        bare_parts = self.bare_parts(wear)
        balls = np.array([0.5 * wear.ball]), np.array([0.5 * rate.ball])
        grooves = zip(wear.grooves, rate.grooves, strict=True)
        parts: list[tuple[np.ndarray, np.ndarray]] = [*grooves, balls]
        for k, (depth, speed) in enumerate(parts):
            thickness = self.films.thickness[k]
            deepest = int(np.argmax(depth if depth.any() else speed))
            edge = (1.0 - FILM_EDGE) * thickness
            if not (0.0 < thickness < np.inf and speed[deepest] > 0.0):
                continue
            if not bare_parts[0, k]:
                time = min(share * thickness, edge - depth[deepest]) / speed[deepest]
            elif not bare_parts[1, k]:
                time = 0.5 * (thickness - edge) / speed[deepest]
            else:
                fastest = speed[depth < edge].max(initial=0.0)
                time = max(0.5 * share * thickness / fastest, least) if fastest > 0.0 else np.inf
            shortest = min(shortest, time)
        return float(shortest)
