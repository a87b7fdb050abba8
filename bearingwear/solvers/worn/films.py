"""Films and running in along worn grooves: point by point on the races, even on the balls."""

from dataclasses import dataclass

import numpy as np

from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.films import Films, Surface
from bearingwear.solvers.worn.depths import WornDepths

FILM_EDGE = 0.05
"""Share of its thickness below which a film no longer covers all of its place, assumed."""

FILM_END_SHARE = 1e-3
"""Share of its thickness to which it is known when a film goes."""

LEAST_WANDER = 0.1
"""rms of a track over the edge of a film at the least, in semi-major axes: about a cell."""

AS_WITH_FILM = -1.0
"""Friction coefficient where no film is left, if it stays."""


def cover(surface: Surface, depth: np.ndarray | float) -> np.ndarray:
    """Share of each place that its film still covers, worn so deep [m] (theory.md section 23)."""
    if surface.film is None:
        return np.zeros_like(depth, dtype=float)
    left = np.maximum(surface.thickness - np.asarray(depth, dtype=float), 0.0)
    if np.isinf(surface.thickness):
        return np.ones_like(left)
    return np.minimum(left / (FILM_EDGE * surface.thickness), 1.0)


@dataclass(frozen=True)
class WornFilms:
    """Films of a scene whose balls wear evenly."""

    films: Films
    without: float  # friction coefficient where none is left, or `AS_WITH_FILM` [1]

    @classmethod
    def of(cls, scene: Scene) -> "WornFilms":
        given, films = scene.friction.film, Films.of(scene)
        bare = None if given is None or not films.wear_through else given.bare_ball_race
        return cls(films, AS_WITH_FILM if bare is None else bare)

    def cover_of_race(self, depth: np.ndarray, spread: float) -> np.ndarray:
        """Share of each place of a track that its film covers, as a track sees it that wanders.

        Depths [m] stand over equal steps of the groove; `spread` is the rms of the wander in these
        steps.
        """
        from scipy.ndimage import gaussian_filter1d  # loads slowly; most bearings have no film

        return gaussian_filter1d(cover(self.films.race, depth), spread, truncate=6.0)

    def bare(self, race_depth: np.ndarray, ball_depth: float, spread: float) -> np.ndarray:
        """Share of each place of a groove on which no film is left; as `cover_of_race`."""
        if not self.films.wear_through:
            return np.zeros_like(race_depth)
        on_race = self.cover_of_race(race_depth, spread)
        return 1.0 - np.maximum(on_race, cover(self.films.ball, ball_depth))

    def factors(
        self,
        on_race: np.ndarray,
        race_depth: np.ndarray,
        ball_depth: float,
        pressure: float = np.nan,
        temperature: float = np.nan,
    ) -> tuple[np.ndarray, np.ndarray]:
        """K_s/H of ball and race at each place of a track [1/Pa].

        In proportion to what each film still covers, under the peak pressure of the unworn contact
        [Pa] and at a temperature [degC].
        """
        on_ball = cover(self.films.ball, ball_depth)
        table_factor = self.films.table_factor(pressure, temperature)
        return self.films.factors(on_ball, on_race, ball_depth, race_depth, table_factor)

    def bare_parts(self, wear: WornDepths) -> np.ndarray:
        """Whether each film has begun to leave its deepest place bare, and has left it (2, 3)."""
        ends = np.array([[1.0 - FILM_EDGE], [1.0]])
        thickness = self.films.thickness
        return (thickness > 0.0) & (wear.deepest > (ends - FILM_END_SHARE) * thickness)

    def longest_time(self, wear: WornDepths, rate: WornDepths, share: float, least: float) -> float:
        """Time in which a film wears by a share of its thickness, or to where it begins to go [s].

        While it leaves its deepest place, half of that way at most. Where it is bare there, it goes
        on to go beside it: half of the share, but at the least so long a time.
        """
        shortest, begun = np.inf, self.bare_parts(wear)
        balls = np.array([0.5 * wear.ball]), np.array([0.5 * rate.ball])
        grooves = zip(wear.grooves, rate.grooves, strict=True)
        parts: list[tuple[np.ndarray, np.ndarray]] = [*grooves, balls]
        for k, (depth, speed) in enumerate(parts):
            thickness = self.films.thickness[k]
            at = int(np.argmax(depth if depth.any() else speed))
            edge = (1.0 - FILM_EDGE) * thickness
            if not (0.0 < thickness < np.inf and speed[at] > 0.0):
                continue
            if not begun[0, k]:
                time = min(share * thickness, edge - depth[at]) / speed[at]
            elif not begun[1, k]:
                time = 0.5 * (thickness - edge) / speed[at]
            else:
                fastest = speed[depth < edge].max(initial=0.0)
                time = max(0.5 * share * thickness / fastest, least) if fastest > 0.0 else np.inf
            shortest = min(shortest, time)
        return float(shortest)
