"""Bearings whose contacts stay Hertzian as their surfaces wear (theory.md sections 6, 19, 23).

The state depends on what each bearing has lost, and, where films or running in decide how fast a
surface wears, on how deep that is.
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import accumulate
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.ends import Criteria, largest_loss
from bearingwear.lives.follow import Life, Method, Node, States, follow
from bearingwear.lives.methods import QUARTERS, RungeKutta, Simpson
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.films import (
    PEAK_OVER_MEAN,
    Bare,
    Factors,
    Films,
    contact_temperatures,
    follows_depths,
    limits_depth,
    mean_pressure,
)
from bearingwear.solvers.bearing.mounted import MM, UM
from bearingwear.solvers.compose import Remembered
from bearingwear.solvers.condition import Condition
from bearingwear.solvers.state import State

FIRST_STEP = 2.5e-5  # of the ball diameter: 0.05 um on 2 mm
_QUICK = 1e-4  # tolerance of quick lives
_LONGER_FIRST = 4.0  # their first step, over that of others
RUNNING_IN_STEP = 0.25  # of the depth of running in, and of what has worn
_LOOSER = 30.0  # tolerance of the run that shows how well the life is integrated
_UNLIKE = 3.7  # times its first step: the same steps would hide an error far below the tolerance
_LOOSEST = 1e-2


class Coating:
    """Films of some parts of a bearing, of a thickness each (n,), 0 without one [m]."""

    def __init__(self, thickness: np.ndarray):
        self.whole = thickness
        self.cover = thickness > 0.0  # where a film is left

    @property
    def thickness(self) -> np.ndarray:
        """Of what is left, as if unworn; 0 where nothing is [m]."""
        return np.where(self.cover, self.whole, 0.0)

    def left(self, depths: np.ndarray) -> np.ndarray:
        """Share of each film that is left, worn so deep [m]; infinite where there is none."""
        return np.where(self.cover, 1.0 - depths / np.where(self.cover, self.whole, 1.0), np.inf)

    def wear_through(self, part: int, depths: np.ndarray) -> None:
        """The film of a part is gone, if it is one of these, and any other with nothing left."""
        self.cover &= (self.left(depths) > 0.0) & (np.arange(self.cover.size) != part)


def wear_through(films: Iterable[tuple[Coating, np.ndarray]], film: int) -> None:
    """A film is gone, by its number along coatings with their depths [m]; see `Coating`."""
    for coating, depths in films:
        coating.wear_through(film, depths)
        film -= coating.cover.size


class EvenWear:
    """A bearing whose wear rate depends on its loss alone: worn is that loss (1,) [m]."""

    coating = Coating(np.empty(0))

    def __init__(self, scene: Scene):
        self.present = scene.wear.ball_diameter_loss_um[0] * UM
        self.largest = largest_loss(scene)
        self.start = np.array([self.present])

    @property
    def room(self) -> float:
        """Loss that can be followed [m]."""
        return self.largest - self.present

    def condition(self, worn: np.ndarray) -> Condition:
        return Condition(float(worn[0]))

    def state(self, state: State, worn: np.ndarray) -> State:
        """The state of a condition, with what depends on how deep the surfaces are worn."""
        return state

    def rates(self, state: State) -> np.ndarray:
        """Wear rates [m/s]."""
        return np.array([state.rate])

    def depths(self, worn: np.ndarray) -> np.ndarray:
        """Depths of what may have a film [m]."""
        return np.empty(0)


class FilmWear(EvenWear):
    """A bearing whose depths are followed: worn is (loss of a ball, both depths) [m].

    Surfaces may have films or run in. Depths of grooves are means over the width of the track,
    followed by the greatest ones where these may end the life.
    """

    def __init__(self, scene: Scene):
        super().__init__(scene)
        self.scene = scene
        self.films = Films.of(scene)
        self.changes = self.films.changes
        self.coating = Coating(self.films.thickness)
        self.start = np.zeros(5 if limits_depth(scene) else 3)

    @property
    def bare(self) -> Bare:
        return self.films.bare(self.coating.cover)

    def condition(self, worn: np.ndarray) -> Condition:
        counted = worn[0] + (worn[1] + worn[2] if self.scene.wear.counts_races else 0.0)
        return Condition(self.present + float(counted), self.bare)

    def depths(self, worn: np.ndarray) -> np.ndarray:
        """Worn off the inner and the outer groove and the surface of a ball (3,) [m]."""
        return np.array([worn[1], worn[2], 0.5 * worn[0]])

    def running_in_time(self, worn: np.ndarray, rates: np.ndarray) -> float:
        """Time in which the coefficients of surfaces that run in change by a part [s]."""
        parts = (self.films.race, self.films.race, self.films.ball)
        each = zip(parts, self.coating.cover, self.depths(worn), self.depths(rates), strict=True)
        times = [
            RUNNING_IN_STEP * (part.running_in + max(deep - part.thickness, 0.0)) / rate
            for part, is_covered, deep, rate in each
            if part.running_in and not is_covered and rate > 0.0
        ]
        return min(times, default=np.inf)

    def wearing(self, values: Mapping[str, Any], worn: np.ndarray) -> Factors:
        """K_s/H of balls and races under the pressures and at the temperatures of a state."""
        table_factor: Any = 1.0
        if self.films.table is not None:
            pressure = PEAK_OVER_MEAN * mean_pressure(self.scene, values["semi_major_axis"])
            temperature = contact_temperatures(self.scene, values.get("part_temperature"))
            table_factor = self.films.table_factor(pressure, temperature)
        return self.films.contact_factors(
            self.coating.cover, 0.5 * worn[0], worn[1:3], table_factor
        )

    def film_values(self, worn: np.ndarray) -> dict[str, Any]:
        """What a state has of its films."""
        return {
            "film_left": np.maximum(self.coating.thickness - self.depths(worn), 0.0),
            "film_worn_share": np.array(self.bare, dtype=float),
        }

    def state(self, state: State, worn: np.ndarray) -> State:
        wearing = self.wearing(state.values, worn)
        ball, race = (np.broadcast_to(part, 2) for part in wearing)
        of_ball, of_races = state["loss_per_wear"]
        off_ball, off_races = float(of_ball @ ball), of_races * race
        return state.with_values(
            {
                "ball_diameter_loss_rate": self.loss_rate(off_ball, off_races),
                "ball_depth_rate": off_ball,
                "ball_wear_rate": float(state["qv"] @ ball),
                "race_wear_rate": self.scene.bearing.ball_count * race * state["qv"],
                "groove_depth_rate": off_races,
            }
            | self.film_values(worn)
            | ({"greatest_depth": worn[3:].max()} if worn.size > 3 else {})
        )

    def loss_rate(self, off_ball: float, off_races: np.ndarray) -> float:
        """Rate of the loss, as counted, by the rates of ball diameter and of both depths [m/s]."""
        return off_ball + float(off_races.sum()) if self.scene.wear.counts_races else off_ball

    def rates(self, state: State) -> np.ndarray:
        grooves = state["groove_depth_rate"]
        deepest = state["depth_peak"] * grooves if self.start.size > 3 else ()
        return np.array([state["ball_depth_rate"], *grooves, *deepest])


class Surfaces:
    """The wear of one bearing, or of two on a rotor."""

    def __init__(self, scene: Scene, states: Remembered):
        self.states = states
        self.each = [
            FilmWear(side) if follows_depths(side) else EvenWear(side) for side in scene.sides
        ]
        self.start = np.concatenate([one.start for one in self.each])
        ends = [0, *accumulate(one.start.size for one in self.each)]
        self._parts = [slice(*bounds) for bounds in zip(ends[:-1], ends[1:], strict=True)]
        self.origin, self.range = 0.0, sum(one.room for one in self.each)

    def parts(self, worn: np.ndarray) -> Iterator[tuple[EvenWear, np.ndarray]]:
        return zip(self.each, (worn[part] for part in self._parts), strict=True)

    def state(self, worn: np.ndarray) -> States:
        parts = [*self.parts(worn)]
        found = self.states(tuple(wear.condition(part) for wear, part in parts))
        if any(one.status != code.OK for one in found):
            return found
        each = zip(found, parts, strict=True)
        return tuple(wear.state(one, part) for one, (wear, part) in each)

    def rates(self, node: Node) -> np.ndarray:
        each = zip(self.each, node.states, strict=True)
        return np.concatenate([wear.rates(one) for wear, one in each])

    def loss_rate(self, node: Node) -> float:
        """Sum of the rates at which the bearings lose, as counted [m/s]."""
        return sum(one.rate for one in node.states)

    def wears(self, node: Node) -> bool:
        return min(one.rate for one in node.states) > 0.0

    def films_at(self, worn: np.ndarray) -> list[tuple[Coating, np.ndarray]]:
        """Films of each bearing, with the depths there [m]."""
        return [(one.coating, one.depths(part)) for one, part in self.parts(worn)]

    def events(self, node: Node) -> np.ndarray:
        parts = self.parts(node.worn)
        room = (1.0 - one.condition(part).loss / one.largest for one, part in parts)
        films = [film.left(depths) for film, depths in self.films_at(node.worn) if depths.size]
        return np.concatenate([[min(room)], *films])

    def passes(self, event: int, node: Node) -> bool:
        """A film is gone."""
        if event < 1:
            return False
        wear_through(self.films_at(node.worn), event - 1)
        return True


def _largest_permitted(scene: Scene) -> float:
    """Loss at which the life ends at the latest [m]; infinite where the scene gives none."""
    end = scene.wear.end_of_life
    if end is None or end.ball_diameter_loss_um is None:
        return np.inf
    return (1.0 + 1e-15) * end.ball_diameter_loss_um * UM  # met despite rounding


def is_one_integral(scene: Scene) -> bool:
    """Whether a life whose contacts stay Hertzian is an integral over the loss alone."""
    sides = scene.one_of_alike.sides
    return len(sides) == 1 and not follows_depths(sides[0])


def surface_life(scene: Scene, states: Remembered, quick: bool = False) -> Life:
    """The life of a scene whose contacts stay Hertzian.

    `states` may be those of a scene that differs by its end. A `quick` life has longer steps where
    it is one integral, and fewer states between them where it is not.
    """
    scene = scene.one_of_alike
    life = follow_surfaces(Surfaces(scene, states), Criteria(scene), scene, quick)
    life.solves = states.solves
    return life


def follow_surfaces(wearing: Any, ends: Criteria, scene: Scene, quick: bool = False) -> Life:
    """The life by a way to wear whose contacts stay Hertzian, of one bearing or of two."""
    tolerance, first = _steps(scene)
    if is_one_integral(scene):
        wearing.origin = float(wearing.start[0])
        if quick:
            tolerance, first = max(tolerance, _QUICK), _LONGER_FIRST * first
        method: Method = Simpson(tolerance, first, _largest_permitted(scene), quick)
    else:
        method = RungeKutta(tolerance, first, (0.5,) if quick else QUARTERS)
    return follow(wearing, ends, method)


def surface_steps_error(scene: Scene, states: Remembered, life: Life) -> float:
    """Error by its steps of a life whose contacts stay Hertzian [s]."""
    return steps_error(Surfaces(scene, states), Criteria(scene), scene, life)


def steps_error(wearing: Any, ends: Criteria, scene: Scene, life: Life) -> float:
    """Error of a life by its steps [s]: of one integral its own, else by a life in looser ones.

    `wearing` is a way to wear of the life, at its start.
    """
    if is_one_integral(scene):
        return life.error
    tolerance, first = _steps(scene)
    looser = RungeKutta(min(_LOOSER * tolerance, _LOOSEST), _UNLIKE * first, ())
    return abs(follow(wearing, ends, looser).last.time - life.last.time)


def _steps(scene: Scene) -> tuple[float, float]:
    """Tolerance of a life, and its first step [m]."""
    smallest = min(side.bearing.ball_diameter_mm for side in scene.sides) * MM
    return scene.model.tolerance, len(scene.sides) * FIRST_STEP * smallest
