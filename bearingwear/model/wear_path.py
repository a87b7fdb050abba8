"""Wear lives that are initial-value problems, of one bearing or of two (theory.md sections 19, 23).

The state depends on what each bearing has lost, and, where films or running in decide how fast a
surface wears, on how deep that is. All of it is integrated over the loss s that is counted,

    d(what is worn, t)/ds = their rates over the sum of the counted loss rates,

by SciPy's explicit Runge-Kutta method, from one film that wears through to the next. Each way of
counting wear takes its own path.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.integrate import RK45
from scipy.optimize import brentq

from bearingwear.kernels import status as code
from bearingwear.model.films import COVERED, Bare, Cover, Films, mean_pressure
from bearingwear.model.life_integrator import (
    FIRST_STEP,
    REASONLESS,
    ROOT,
    SHORTEST_STEP,
    Unsolved,
)
from bearingwear.model.mounted import MM, UM
from bearingwear.model.state import State
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.friction import changes_as_it_wears
from bearingwear.scene.scene import COUNTS, LARGEST_LOSS, Scene

QUARTERS = (0.25, 0.5, 0.75)
_LOOSER = 30.0  # tolerance of the run that shows how well the life is integrated
_UNLIKE = 3.7  # times its first step: the same steps would hide an error far below the tolerance
_MOST_STEPS = 2000
_NO_CRITERION = len(CRITERIA) - 1
_FIRST_FILM = _NO_CRITERION + 1  # in the margins, behind the criteria and the room left

States = tuple[State, ...]


class Condition(NamedTuple):
    """What decides the state of a bearing along its life."""

    loss: float  # of ball diameter [m]
    bare: Bare = COVERED


class KnownStates:
    """States of one bearing or two by their conditions, each solved once."""

    def __init__(self, solve: Callable[[tuple[Condition, ...]], States]):
        self._solve = solve
        self._known: dict[tuple[Condition, ...], States] = {}

    def __call__(self, conditions: tuple[Condition, ...]) -> States:
        if conditions not in self._known:
            self._known[conditions] = self._solve(conditions)
        return self._known[conditions]

    @property
    def solves(self) -> int:
        return len(self._known)

    @property
    def failed(self) -> int:
        """How many of them were not found."""
        return sum(first.status != code.OK for first, *_ in self._known.values())


class EvenWear:
    """A bearing whose wear rate depends on its counted loss alone: worn is (loss,) [m]."""

    def __init__(self, scene: Scene):
        self.present = scene.wear.ball_diameter_loss_um[0] * UM
        self.ball_diameter = scene.bearing.ball_diameter_mm * MM
        self.start = np.array([self.present])

    @property
    def room(self) -> float:
        """Loss that can be followed [m]."""
        return LARGEST_LOSS * self.ball_diameter - self.present

    def condition(self, worn: np.ndarray, counts: int) -> Condition:
        return Condition(float(worn[0]))

    def state(self, state: State, worn: np.ndarray) -> State:
        """The state of a condition, with what depends on how deep the surfaces are worn."""
        return state

    def rates(self, state: State, counts: int) -> np.ndarray:
        """What is worn off per second [m/s]."""
        return state.rate[counts : counts + 1]

    def film_left(self, worn: np.ndarray) -> np.ndarray:
        """Share of each film that is left; infinite where there is none."""
        return np.full(0, np.inf)

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

    def film_left(self, worn: np.ndarray) -> np.ndarray:
        covered = self.thickness > 0.0
        shares = self.depths(worn) / np.where(covered, self.thickness, 1.0)
        return np.where(covered, 1.0 - shares, np.inf)

    def wear_through(self, film: int) -> None:
        gone = [*self.cover]
        gone[film] = False
        self.cover = Cover(*gone)


def wear_of(scene: Scene) -> EvenWear:
    """How the surfaces of a bearing wear."""
    return FilmWear(scene) if changes_as_it_wears(scene) else EvenWear(scene)


@dataclass
class Course:
    """States of each bearing along a path, when they are reached, and how it ended."""

    states: list[States] = field(default_factory=list)
    times: list[float] = field(default_factory=list)  # [s]
    criterion: int = _NO_CRITERION
    status: int = code.CRITERION_NOT_REACHED


class WearPath:
    """The path of one bearing, or of two on a rotor, through life, by one way of counting wear.

    Parameters
    ----------
    scenes : sequence of Scene
        Of each bearing.
    states : callable
        From the condition of each bearing to its state.
    margins : callable
        From the states to how far each criterion is from being met.
    counts : int
        Index into `COUNTS`.
    tolerance : float
        Relative, of a step.
    first_step : float
        Over the smallest ball diameter, for each bearing.
    between : sequence of float
        Shares of each step after which a state is kept, too.
    """

    def __init__(
        self,
        scenes: Sequence[Scene],
        states: Callable[[tuple[Condition, ...]], States],
        margins: Callable[[States], np.ndarray],
        counts: int,
        tolerance: float,
        first_step: float = FIRST_STEP,
        between: Sequence[float] = QUARTERS,
    ):
        self.wear = [wear_of(scene) for scene in scenes]
        self.states, self.margins, self.counts = states, margins, counts
        self.tolerance, self.between = tolerance, between
        smallest = min(one.ball_diameter for one in self.wear)
        self.first_step = len(self.wear) * first_step * smallest
        self.bound = sum(one.room for one in self.wear)
        sizes = [one.start.size for one in self.wear]
        self._ends = np.cumsum(sizes)

    def _parts(self, y: np.ndarray) -> list[tuple[EvenWear, np.ndarray]]:
        """Each bearing, and what is worn of it; the time is last."""
        return list(zip(self.wear, np.split(y[:-1], self._ends[:-1]), strict=True))

    def at(self, y: np.ndarray) -> States:
        """The states with so much worn off; raises `Unsolved`."""
        parts = self._parts(y)
        found = self.states(tuple(wear.condition(part, self.counts) for wear, part in parts))
        for one in found:
            if one.status != code.OK:
                raise Unsolved(one.status)
        each = zip(found, parts, strict=True)
        return tuple(wear.state(one, part) for one, (wear, part) in each)

    def rates(self, s: float, y: np.ndarray) -> np.ndarray:
        """Derivative of what is worn, and of the time, by the sum of the counted losses."""
        found = self.at(y)
        each = [w.rates(one, self.counts) for w, one in zip(self.wear, found, strict=True)]
        return np.concatenate([*each, [1.0]]) / self._counted(found)

    def _counted(self, found: States) -> float:
        return sum(one.rate[self.counts] for one in found)

    def margin(self, y: np.ndarray) -> np.ndarray:
        """How far each criterion, the largest loss followed, and each film's end are."""
        room, films = [], []
        for wear, part in self._parts(y):
            largest = LARGEST_LOSS * wear.ball_diameter
            room.append(1.0 - wear.condition(part, self.counts).loss / largest)
            films.append(wear.film_left(part))
        return np.concatenate([self.margins(self.at(y)), [min(room)], *films])

    def integrate(self) -> Course:
        """From the present wear to the first criterion, or to where the solver or range ends."""
        course, s = Course(), 0.0
        y = np.concatenate([*(one.start for one in self.wear), [0.0]])
        try:
            met = self._met_at_start(course, y)
            while met is None:
                s, y, met = self._extend(course, s, y)
                if met > _NO_CRITERION:
                    self._wear_through(y, met - _FIRST_FILM)
                    met = self._met_at_start(course, y)
            course.criterion = met
            if met != _NO_CRITERION:
                course.status = code.OK
        except Unsolved as failure:
            course.status = failure.status
            if not course.states:
                lost = (State.unsolved(failure.status, one.present) for one in self.wear)
                course.states.append(tuple(lost))
                course.times.append(0.0)
        return course

    def _met_at_start(self, course: Course, y: np.ndarray) -> int | None:
        """What is met when new, or just after a film is worn through; None where wear goes on."""
        self._keep(course, y)
        met = np.flatnonzero(self.margin(y)[:_FIRST_FILM] <= 0.0)
        if met.size:
            return int(met[0])
        wears = min(one.rate.min() for one in course.states[-1]) > 0.0
        return None if wears else _NO_CRITERION

    def _wear_through(self, y: np.ndarray, film: int) -> None:
        """A film is gone, and with it any other of which nothing is left."""
        first = 0
        for wear, part in self._parts(y):
            left = wear.film_left(part)
            for k in np.flatnonzero((left <= 0.0) | (first + np.arange(left.size) == film)):
                wear.wear_through(int(k))
            first += left.size

    def _keep(self, course: Course, y: np.ndarray) -> None:
        course.states.append(self.at(y))
        course.times.append(float(y[-1]))

    def _solver(self, s: float, y: np.ndarray, bound: float, step: float) -> RK45:
        small = self.tolerance * self.first_step
        atol = np.full(y.size, small)
        atol[-1] /= self._counted(self.at(y))
        first = min(step, bound - s)
        return RK45(self.rates, s, y, bound, rtol=self.tolerance, first_step=first, atol=atol)

    def _extend(self, course: Course, s: float, y: np.ndarray) -> tuple[float, np.ndarray, int]:
        """Take steps until something is met.

        Returns
        -------
        s, y, int
            Where, and the index of what is met in `margin`; no criterion where the range ends.
        """
        step = self.first_step
        solver = self._solver(s, y, self.bound, step)
        for _ in range(_MOST_STEPS):
            try:
                solver.step()
                crossing = self._first_crossing(solver)
                end = solver.t if crossing is None else crossing[0]
                between = [_within(solver, s + share * (end - s)) for share in self.between]
                for one in between:
                    self.at(one)
            except Unsolved as failure:
                # What ends the solver's range lies within this step.
                if course.status in REASONLESS:
                    course.status = failure.status
                step = 0.25 * min(step, solver.h_abs)
                if step < SHORTEST_STEP * self.first_step:
                    return s, y, _NO_CRITERION
                solver = self._solver(s, y, self.bound, step)
                continue
            for one in between:
                self._keep(course, one)
            if crossing is not None:
                y = self._exactly(s, y, end)
                self._keep(course, y)
                return end, y, crossing[1]
            s, y, step = float(solver.t), solver.y.copy(), float(solver.h_abs)
            self._keep(course, y)
            if solver.status == "finished":
                break
        return s, y, _NO_CRITERION

    def _first_crossing(self, solver: RK45) -> tuple[float, int] | None:
        """Where the first margin falls to zero in the last step, and which; also in its middle.

        A solve that fails in between counts as met there. Raises `Unsolved` if one fails at the
        ends or in the middle.
        """
        a, middle = solver.t_old, solver.t_old + 0.5 * (solver.t - solver.t_old)
        for b in (middle, solver.t):
            before, after = (self.margin(_within(solver, s)) for s in (a, b))
            roots = []
            for k in np.flatnonzero((after <= 0.0) & (before > 0.0)):

                def value(s: float, k: int = int(k)) -> float:
                    try:
                        return float(self.margin(_within(solver, s))[k])
                    except Unsolved:
                        return -1.0

                root = brentq(value, a, b, xtol=ROOT * (b - a), rtol=1e-15)
                roots.append((float(root), int(k)))
            if roots:
                return min(roots)
            a = b
        return None

    def _exactly(self, s: float, y: np.ndarray, end: float) -> np.ndarray:
        """What is worn at the end of a shortened step: within it that is known less well."""
        if not end > s:
            return y
        solver = self._solver(s, y, end, end - s)
        while solver.status == "running":
            solver.step()
        return solver.y.copy()


def _within(solver: RK45, s: float) -> np.ndarray:
    """The vector within the last step, at its end as it was solved."""
    return solver.y if s == solver.t else solver.dense_output()(s)


class PathLives(NamedTuple):
    """The path by a scene's own way of counting wear, and the other's end.

    Attributes
    ----------
    course : Course
    times : (steps, 2) ndarray
        By both ways of counting, the other at the end alone [s].
    error : (2,) ndarray
        Bound on the last time, of the scene's own way [s].
    """

    course: Course
    times: np.ndarray
    error: np.ndarray


def path_lives(
    scene: Scene, path: Callable[[int, float, float], WearPath], bounded: bool = True
) -> PathLives:
    """Lives by both ways of counting wear, and how well the scene's own is integrated.

    Parameters
    ----------
    scene : Scene
    path : callable
        A path from an index into `COUNTS`, a tolerance and a first step, as of `WearPath`.
    bounded : bool
        Whether the error is found, by a looser run.
    """
    tolerance, own = scene.model.tolerance, COUNTS.index(scene.wear.counts)
    courses = [path(k, tolerance, FIRST_STEP).integrate() for k in range(len(COUNTS))]
    course = courses[own]
    times = np.full((len(course.times), len(COUNTS)), np.nan)
    times[:, own] = course.times
    times[-1] = [one.times[-1] if one.status == course.status else np.nan for one in courses]
    error = np.full(len(COUNTS), np.nan)
    if bounded:
        loose = path(own, min(_LOOSER * tolerance, 1e-2), _UNLIKE * FIRST_STEP).integrate()
        error[own] = abs(loose.times[-1] - times[-1, own])
    return PathLives(course, times, error)
