"""Bearings whose contacts stay Hertzian as their surfaces wear (theory.md sections 6, 19, 23).

The state depends on what each bearing has lost, and, where films or running in decide how fast a
surface wears, on how deep that is.
"""

from collections.abc import Iterator, Sequence
from itertools import accumulate

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.ends import NO_CRITERION, Criteria, largest_loss
from bearingwear.lives.follow import Life, Method, Node, States, follow
from bearingwear.lives.methods import QUARTERS, RungeKutta, Simpson
from bearingwear.scene.friction import changes_as_it_wears
from bearingwear.scene.scene import COUNTS, Scene
from bearingwear.solvers.bearing.films import Cover, Films, mean_pressure
from bearingwear.solvers.bearing.mounted import MM, UM
from bearingwear.solvers.compose import Remembered
from bearingwear.solvers.condition import Condition
from bearingwear.solvers.state import State

FIRST_STEP = 2.5e-5  # of the ball diameter: 0.05 um on 2 mm
_LOOSER = 30.0  # tolerance of the run that shows how well the life is integrated
_UNLIKE = 3.7  # times its first step: the same steps would hide an error far below the tolerance
_LOOSEST = 1e-2


class EvenWear:
    """A bearing whose wear rate depends on its counted loss alone: worn is that loss (1,) [m]."""

    def __init__(self, scene: Scene):
        self.present = scene.wear.ball_diameter_loss_um[0] * UM
        self.largest = largest_loss(scene)
        self.start = np.array([self.present])

    @property
    def room(self) -> float:
        """Loss that can be followed [m]."""
        return self.largest - self.present

    def condition(self, worn: np.ndarray, counts: int) -> Condition:
        return Condition(float(worn[0]))

    def state(self, state: State, worn: np.ndarray) -> State:
        """The state of a condition, with what depends on how deep the surfaces are worn."""
        return state

    def rates(self, state: State, counts: int) -> np.ndarray:
        """Wear rates [m/s]."""
        return state.rate[counts : counts + 1]

    def film_left(self, worn: np.ndarray) -> list[float]:
        """Share of each film that is left; infinite where there is none."""
        return []

    def wear_through(self, film: int) -> None:
        """A film is gone: of the inner race, the outer race, or the balls."""


class FilmWear(EvenWear):
    """A bearing whose surfaces have films or run in: worn is (loss of a ball, both depths) [m]."""

    def __init__(self, scene: Scene):
        super().__init__(scene)
        self.scene, self.n_balls = scene, scene.bearing.ball_count
        self.films = Films.of(scene)
        self.cover = self.films.cover
        self.start = np.zeros(3)

    def condition(self, worn: np.ndarray, counts: int) -> Condition:
        counted = worn[0] + (worn[1] + worn[2] if counts else 0.0)
        return Condition(self.present + float(counted), self.films.bare(self.cover))

    @staticmethod
    def depths(worn: np.ndarray) -> np.ndarray:
        """Worn off the inner and the outer groove and the surface of a ball (3,) [m]."""
        return np.array([worn[1], worn[2], 0.5 * worn[0]])

    @property
    def thickness(self) -> np.ndarray:
        """Thickness left of the films on them, 0 where there is none (3,) [m]."""
        race, ball = self.films.race.thickness, self.films.ball.thickness
        return np.where(self.cover, [race, race, ball], 0.0)

    def state(self, state: State, worn: np.ndarray) -> State:
        pressed = self.films.pressed(mean_pressure(self.scene, state["semi_major_axis"]))
        wearing = self.films.wearing(self.cover, 0.5 * worn[0], worn[1:3], pressed)
        ball, race = (np.broadcast_to(part.K_s / part.H, 2) for part in wearing)
        of_ball, of_races = state["loss_per_wear"]
        off_ball, off_races = float(of_ball @ ball), of_races * race
        return state.with_values(
            {
                "ball_diameter_loss_rate": np.array([off_ball, off_ball + off_races.sum()]),
                "ball_wear_rate": float(state["qv"] @ ball),
                "race_wear_rate": self.n_balls * race * state["qv"],
                "groove_depth_rate": off_races,
                "film_left": np.maximum(self.thickness - self.depths(worn), 0.0),
                "film_worn_share": np.array(self.films.bare(self.cover), dtype=float),
            }
        )

    def rates(self, state: State, counts: int) -> np.ndarray:
        return np.array([state.rate[0], *state["groove_depth_rate"]])

    def film_left(self, worn: np.ndarray) -> list[float]:
        covered = self.thickness > 0.0
        shares = self.depths(worn) / np.where(covered, self.thickness, 1.0)
        return np.where(covered, 1.0 - shares, np.inf).tolist()

    def wear_through(self, film: int) -> None:
        gone = [*self.cover]
        gone[film] = False
        self.cover = Cover(*gone)


class Surfaces:
    """The wear of one bearing, or of two on a rotor, by one of `COUNTS`."""

    def __init__(self, scene: Scene, states: Remembered, counts: int):
        self.states, self.counts = states, counts
        self.each = [
            FilmWear(side) if changes_as_it_wears(side) else EvenWear(side) for side in scene.sides
        ]
        self.start = np.concatenate([one.start for one in self.each])
        ends = [0, *accumulate(one.start.size for one in self.each)]
        self._parts = [slice(*both) for both in zip(ends[:-1], ends[1:], strict=True)]
        self.origin, self.range = 0.0, sum(one.room for one in self.each)

    def parts(self, worn: np.ndarray) -> Iterator[tuple[EvenWear, np.ndarray]]:
        return zip(self.each, (worn[part] for part in self._parts), strict=True)

    def state(self, worn: np.ndarray) -> States:
        parts = [*self.parts(worn)]
        found = self.states(tuple(wear.condition(part, self.counts) for wear, part in parts))
        if any(one.status != code.OK for one in found):
            return found
        each = zip(found, parts, strict=True)
        return tuple(wear.state(one, part) for one, (wear, part) in each)

    def rates(self, node: Node) -> np.ndarray:
        each = zip(self.each, node.states, strict=True)
        return np.concatenate([wear.rates(one, self.counts) for wear, one in each])

    def wears(self, node: Node) -> bool:
        return min(one.rate.min() for one in node.states) > 0.0

    def events(self, node: Node) -> np.ndarray:
        room, films = [], list[float]()
        for wear, part in self.parts(node.worn):
            room.append(1.0 - wear.condition(part, self.counts).loss / wear.largest)
            films += wear.film_left(part)
        return np.array([min(room), *films])

    def passes(self, event: int, node: Node) -> bool:
        """A film is gone, and with it any other of which nothing is left."""
        film, first = event - NO_CRITERION - 1, 0
        for wear, part in self.parts(node.worn):
            left = np.array(wear.film_left(part))
            for k in np.flatnonzero((left <= 0.0) | (first + np.arange(left.size) == film)):
                wear.wear_through(int(k))
            first += left.size
        return film >= 0


def surface_life(
    scene: Scene,
    states: Remembered,
    bounded: bool = True,
    counts: Sequence[int] = range(len(COUNTS)),
    between: Sequence[float] = QUARTERS,
) -> Life:
    """The life of a scene whose contacts stay Hertzian.

    One bearing without films has both clocks from one integral. Others wear by the scene's own way
    of counting, which is among `counts`; the last time by another way is that of a life of its own,
    whose error is found by a looser one where it is `bounded`. `states` may be those of a scene
    that differs by its end.
    """
    scene = scene.one_of_alike
    ends, tolerance, own = Criteria(scene), scene.model.tolerance, COUNTS.index(scene.wear.counts)
    smallest = min(side.bearing.ball_diameter_mm for side in scene.sides) * MM
    first = len(scene.sides) * FIRST_STEP * smallest

    def along(k: int, tolerance: float, first: float) -> Life:
        return follow(Surfaces(scene, states, k), ends, RungeKutta(tolerance, first, k, between))

    if len(scene.sides) == 1 and not changes_as_it_wears(scene):
        wearing = Surfaces(scene, states, own)
        wearing.origin = float(wearing.start[0])
        method: Method = Simpson(tolerance, first)
        life = follow(wearing, ends, method)
    else:
        each = {k: along(k, tolerance, first) for k in counts}
        life = each.pop(own)
        life.error, end = np.full(len(COUNTS), np.nan), life.last.time.copy()
        for k, other in each.items():
            if other.status == life.status:
                end[k] = other.last.time[k]
        life.nodes[-1] = life.last._replace(time=end)
        if bounded:
            loose = along(own, min(_LOOSER * tolerance, _LOOSEST), _UNLIKE * first)
            life.error[own] = abs(loose.last.time[own] - end[own])
    life.solves = states.solves
    return life
