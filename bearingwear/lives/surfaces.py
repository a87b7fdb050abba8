"""Bearings whose contacts stay Hertzian as their surfaces wear (theory.md sections 6, 19, 23).

The state depends on what each bearing has lost, and, where films or running in decide how fast a
surface wears, on how deep that is.
"""

from collections.abc import Iterable, Mapping
from itertools import accumulate, pairwise
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

FIRST_STEP = 2.5e-5  # loss over the ball diameter: 0.05 um on 2 mm
ABOVE_ROUNDING = 1.0 + 1e-15  # factor on the limit of a loss that is met despite rounding
_QUICK = 1e-4  # tolerance of quick lives
_LONGER_FIRST = 4.0  # their first step, over that of others
RUNNING_IN_STEP = 0.25  # wear of a step, over the running-in depth plus what has worn below films
# a life in looser steps shows how well another is integrated
_LOOSER_TOLERANCE = 30.0  # over that of the life
_LOOSEST_TOLERANCE = 1e-2
_LOOSER_FIRST = 3.7  # first step, over that of the life: like steps would hide a small error


class Coating:
    """Films of some parts of a bearing, and whether each is left.

    thickness: of the new film of each part (n,) [m]; 0 without one, infinite if it never wears.
    """

    def __init__(self, thickness: np.ndarray):
        self.new_thickness = thickness
        self.is_left = thickness > 0.0

    @property
    def thickness(self) -> np.ndarray:
        """Returns the unworn thickness of the films that are left; 0 where none is [m]."""
        return np.where(self.is_left, self.new_thickness, 0.0)

    def share_left(self, depths: np.ndarray) -> np.ndarray:
        """Returns the share of each film that is left (n,) [1]; infinite without a film.

        It is negative where more has worn than the film.

        depths: worn off each part (n,) [m].
        """
        thickness = np.where(self.is_left, self.new_thickness, 1.0)
        return np.where(self.is_left, 1.0 - depths / thickness, np.inf)

    def remove(self, part: int, depths: np.ndarray) -> None:
        """Removes the film of one part, and any other that is worn through.

        part: index of the part; one out of range is no part of this coating.
        depths: worn off each part [m].
        """
        self.is_left &= (self.share_left(depths) > 0.0) & (np.arange(self.is_left.size) != part)


def remove_film(films: Iterable[tuple[Coating, np.ndarray]], film: int) -> None:
    """Removes a film by its index along all coatings, and any film that is worn through.

    films: coatings, and the depths of their parts [m].
    """
    for coating, depths in films:
        coating.remove(film, depths)
        film -= coating.is_left.size


class EvenWear:
    """A bearing whose wear rate depends on its loss alone.

    `worn` is its loss of ball diameter (1,) [m], which includes what it has lost before.
    """

    coating = Coating(np.empty(0))

    def __init__(self, scene: Scene):
        self.present_loss = scene.wear.ball_diameter_loss_um[0] * UM
        self.largest_loss = largest_loss(scene)
        self.start = np.array([self.present_loss])

    @property
    def loss_range(self) -> float:
        """Returns the further loss that can be followed [m]."""
        return self.largest_loss - self.present_loss

    def condition(self, worn: np.ndarray) -> Condition:
        """Returns the condition to solve the bearing in, with the loss `worn`."""
        return Condition(float(worn[0]))

    def state(self, state: State, worn: np.ndarray) -> State:
        """Returns the state as it is: no value depends on how deep surfaces are worn."""
        return state

    def rates(self, state: State) -> np.ndarray:
        """Returns the rate of `worn` (1,) [m/s]."""
        return np.array([state.rate])

    def depths(self, worn: np.ndarray) -> np.ndarray:
        """Returns the depths of the surfaces that may have a film: none here (0,) [m]."""
        return np.empty(0)


class FilmWear(EvenWear):
    """A bearing whose depths are followed, counted from the start of the life.

    `worn` is (loss of ball diameter, depth of the inner, of the outer groove) [m]. Depths of
    grooves are means over the width of the track. Where greatest depths may end the life, those of
    the inner and of the outer groove come after these. Surfaces may have films or run in.
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
        """Returns whether the inner and the outer contact have no film left, on race and ball."""
        return self.films.bare(self.coating.is_left)

    def condition(self, worn: np.ndarray) -> Condition:
        """Returns the condition of the bearing with some wear, and without films that are gone.

        worn: loss of ball diameter, and depths of inner and outer groove [m].
        """
        counted = worn[0] + (worn[1] + worn[2] if self.scene.wear.counts_races else 0.0)
        return Condition(self.present_loss + float(counted), self.bare)

    def depths(self, worn: np.ndarray) -> np.ndarray:
        """Returns the depths of inner groove, outer groove and ball surface (3,) [m].

        worn: loss of ball diameter, and depths of inner and outer groove [m].
        """
        return np.array([worn[1], worn[2], 0.5 * worn[0]])

    def running_in_time(self, worn: np.ndarray, rates: np.ndarray) -> float:
        """Returns the shortest time in which a surface that runs in wears by `RUNNING_IN_STEP` [s].

        Infinite where no surface without film runs in.

        worn, rates: loss of ball diameter and depths of both grooves [m], and their rates [m/s].
        """
        times = [np.inf]
        for surface, has_film, depth, rate in zip(
            (self.films.race, self.films.race, self.films.ball),
            self.coating.is_left,
            self.depths(worn),
            self.depths(rates),
            strict=True,
        ):
            if surface.running_in and not has_film and rate > 0.0:
                below_film = max(depth - surface.thickness, 0.0)
                times.append(RUNNING_IN_STEP * (surface.running_in + below_film) / rate)
        return min(times)

    def wear_factors(self, values: Mapping[str, Any], worn: np.ndarray) -> Factors:
        """Returns K_s/H of balls and races at the pressures and temperatures of a state [1/Pa].

        values: result variables of the state.
        worn: in the form of this class.
        """
        table_factor: Any = 1.0
        if self.films.table is not None:
            pressure = PEAK_OVER_MEAN * mean_pressure(self.scene, values["semi_major_axis"])
            temperature = contact_temperatures(self.scene, values.get("part_temperature"))
            table_factor = self.films.table_factor(pressure, temperature)
        return self.films.contact_factors(
            self.coating.is_left, 0.5 * worn[0], worn[1:3], table_factor
        )

    def film_values(self, worn: np.ndarray) -> dict[str, Any]:
        """Returns result variables of the films.

        `film_left` is the thickness left on inner race, outer race and balls (3,) [m].
        `film_worn_share` is 1 for a contact without film, else 0 (2,).
        """
        return {
            "film_left": np.maximum(self.coating.thickness - self.depths(worn), 0.0),
            "film_worn_share": np.array(self.bare, dtype=float),
        }

    def state(self, state: State, worn: np.ndarray) -> State:
        """Returns the state of a condition, with wear rates and films at some depths.

        state: with `loss_per_wear`, the rates of depths over K_s/H.
        """
        factors = self.wear_factors(state.values, worn)
        ball_factor, race_factor = (np.broadcast_to(factor, 2) for factor in factors)
        ball_loss_per_factor, race_depth_per_factor = state["loss_per_wear"]
        ball_rate = float(ball_loss_per_factor @ ball_factor)
        race_rates = race_depth_per_factor * race_factor
        values = {
            "ball_diameter_loss_rate": self.loss_rate(ball_rate, race_rates),
            "ball_depth_rate": ball_rate,
            "ball_wear_rate": float(state["qv"] @ ball_factor),
            "race_wear_rate": self.scene.bearing.ball_count * race_factor * state["qv"],
            "groove_depth_rate": race_rates,
        }
        values |= self.film_values(worn)
        if worn.size > 3:
            values["greatest_depth"] = worn[3:].max()
        return state.with_values(values)

    def loss_rate(self, ball_rate: float, race_rates: np.ndarray) -> float:
        """Returns the rate of the loss that counts [m/s].

        It is that of the ball diameter, and of both grooves if the scene counts them.

        ball_rate, race_rates: of the ball diameter, and of the depths of both grooves [m/s].
        """
        return ball_rate + float(race_rates.sum()) if self.scene.wear.counts_races else ball_rate

    def rates(self, state: State) -> np.ndarray:
        """Returns the wear rates of a state, in the order of `worn` [m/s]."""
        grooves = state["groove_depth_rate"]
        deepest = state["depth_peak"] * grooves if self.start.size > 3 else ()
        return np.array([state["ball_depth_rate"], *grooves, *deepest])


class Surfaces:
    """A way to wear: the surfaces of one bearing, or of two on a rotor, with Hertzian contacts.

    `worn` is that of the bearings, one after the other. `Node.x` is the sum of their losses: from
    the start of the life on, or with the present loss where the life is one integral.

    scene: with one bearing, or two that differ: see `Scene.symmetric_half`.
    """

    def __init__(self, scene: Scene, solver: Remembered):
        self.solver = solver
        self.bearings = [
            FilmWear(side) if follows_depths(side) else EvenWear(side) for side in scene.sides
        ]
        self.start = np.concatenate([bearing.start for bearing in self.bearings])
        self.origin = 0.0
        self.range = sum(bearing.loss_range for bearing in self.bearings)
        ends = [0, *accumulate(bearing.start.size for bearing in self.bearings)]
        self._parts = [
            (bearing, slice(*part))
            for bearing, part in zip(self.bearings, pairwise(ends), strict=True)
        ]

    def with_wear(self, worn: np.ndarray) -> list[tuple[EvenWear, np.ndarray]]:
        """Returns each bearing with its part of the wear."""
        return [(bearing, worn[part]) for bearing, part in self._parts]

    def state(self, worn: np.ndarray) -> States:
        """Returns the states of the bearings with some wear; their status says if they fail."""
        with_wear = self.with_wear(worn)
        states = self.solver(tuple(bearing.condition(part) for bearing, part in with_wear))
        if any(state.status != code.OK for state in states):
            return states
        pairs = zip(states, with_wear, strict=True)
        return tuple(bearing.state(state, part) for state, (bearing, part) in pairs)

    def rates(self, node: Node) -> np.ndarray:
        """Returns the wear per second of all bearings, in the order of `worn`."""
        pairs = zip(self.bearings, node.states, strict=True)
        return np.concatenate([bearing.rates(state) for bearing, state in pairs])

    def loss_rate(self, node: Node) -> float:
        """Returns the sum of `State.rate` of the bearings [m/s]."""
        return sum(state.rate for state in node.states)

    def wears(self, node: Node) -> bool:
        """Returns whether every bearing has a loss that grows."""
        return min(state.rate for state in node.states) > 0.0

    def films_at(self, worn: np.ndarray) -> list[tuple[Coating, np.ndarray]]:
        """Returns the films of each bearing, with the depths of its surfaces [m]."""
        return [(bearing.coating, bearing.depths(part)) for bearing, part in self.with_wear(worn)]

    def events(self, node: Node) -> np.ndarray:
        """Returns the share of the largest loss that is left, then that of each film [1].

        The former is that of the most worn bearing. Films follow by bearing: inner race, outer race
        and balls, infinite without a film.
        """
        with_wear = self.with_wear(node.worn)
        losses_left = [
            1.0 - bearing.condition(part).loss / bearing.largest_loss for bearing, part in with_wear
        ]
        films_left = [
            bearing.coating.share_left(bearing.depths(part))
            for bearing, part in with_wear
            if bearing.coating.new_thickness.size
        ]
        return np.concatenate([[min(losses_left)], *films_left])

    def pass_event(self, event: int, node: Node) -> bool:
        """Removes a film that is gone; returns False where the largest loss is reached.

        event: index among the `events`.
        """
        if event < 1:  # the largest loss, before all films
            return False
        remove_film(self.films_at(node.worn), event - 1)
        return True


def _loss_limit(scene: Scene) -> float:
    """Returns the limit of the loss, beyond which no life goes on [m]; infinite without one."""
    end = scene.wear.end_of_life
    if end is None or end.ball_diameter_loss_um is None:
        return np.inf
    return ABOVE_ROUNDING * end.ball_diameter_loss_um * UM


def is_one_integral(scene: Scene) -> bool:
    """Returns whether a life whose contacts stay Hertzian is an integral over one loss.

    It is that of one bearing, or of two alike, without films, running in or limits of depth.
    """
    sides = scene.symmetric_half.sides
    return len(sides) == 1 and not follows_depths(sides[0])


def surface_life(scene: Scene, solver: Remembered, quick: bool = False) -> Life:
    """Returns the life of a scene whose contacts stay Hertzian.

    solver: of the scene, or of one that differs by its end.
    quick: whether steps are longer where the life is one integral, and have fewer states between
        them where it is not.
    """
    scene = scene.symmetric_half
    life = follow_surfaces(Surfaces(scene, solver), Criteria(scene), scene, quick)
    life.solves = solver.solves
    return life


def follow_surfaces(wearing: Any, ends: Criteria, scene: Scene, quick: bool = False) -> Life:
    """Returns the life by a way to wear whose contacts stay Hertzian, of one bearing or of two.

    wearing: `Surfaces`, or those over a duty; its `origin` is set to the present loss where the
        life is one integral.
    scene: with the tolerance and the balls of the life.
    quick: as in `surface_life`.
    """
    tolerance, first = _tolerance_and_first_step(scene)
    if is_one_integral(scene):
        wearing.origin = float(wearing.start[0])
        if quick:
            tolerance = max(tolerance, _QUICK)
            first = _LONGER_FIRST * first
        method: Method = Simpson(tolerance, first, _loss_limit(scene), quick)
    else:
        method = RungeKutta(tolerance, first, (0.5,) if quick else QUARTERS)
    return follow(wearing, ends, method)


def surface_steps_error(scene: Scene, solver: Remembered, life: Life) -> float:
    """Returns the error by its steps of a life whose contacts stay Hertzian [s]; see `steps_error`.

    scene, solver: those of the life, which the solver follows once more if need be.
    """
    return steps_error(Surfaces(scene, solver), Criteria(scene), scene, life)


def steps_error(wearing: Any, ends: Criteria, scene: Scene, life: Life) -> float:
    """Returns the error of the length of a life by its steps [s].

    It is `life.error` if the life is one integral. Otherwise it is the difference from a life in
    looser steps, which follows `wearing` to its end.

    wearing: a new way to wear, at the start of the life.
    """
    if is_one_integral(scene):
        return life.error
    tolerance, first = _tolerance_and_first_step(scene)
    looser = min(_LOOSER_TOLERANCE * tolerance, _LOOSEST_TOLERANCE)
    other = follow(wearing, ends, RungeKutta(looser, _LOOSER_FIRST * first, ()))
    return abs(other.last.time - life.last.time)


def _tolerance_and_first_step(scene: Scene) -> tuple[float, float]:
    """Returns the relative tolerance of a life, and the loss of its first step [m].

    Two bearings have twice the step of one, as their losses are added.
    """
    smallest = min(side.bearing.ball_diameter_mm for side in scene.sides) * MM
    return scene.model.tolerance, len(scene.sides) * FIRST_STEP * smallest
