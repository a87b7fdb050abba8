"""Wear life of a bearing whose films wear through, or whose surfaces run in (theory.md section 23).

The rate of loss then depends on how deep each part is worn, so the life is an initial-value problem
over the loss L that is counted,

    d(loss of a ball, depths of the grooves, t)/dL = their rates over that of L,

which SciPy's explicit Runge-Kutta method integrates from one film that wears through to the next.
Each way of counting wear takes its own path.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.integrate import RK45

from bearingwear.kernels import status as code
from bearingwear.model.films import Bare, Cover, Films
from bearingwear.model.life_integrator import (
    FIRST_STEP,
    REASONLESS,
    SHORTEST_STEP,
    LifeHistory,
    Unsolved,
    WearState,
)
from bearingwear.model.met_within import at_end, first_crossing
from bearingwear.model.mounted import MM, UM
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.scene import COUNTS, LARGEST_LOSS, Scene

_LOOSER = 30.0  # tolerance of the run that shows how well the life is integrated
_UNLIKE = 3.7  # times its first step
_MOST_STEPS = 2000
_TIME = 3  # index of the time in a path's vector, after the ball and both grooves
_NO_CRITERION = len(CRITERIA) - 1

States = Callable[[float, Bare], WearState]
"""From loss of ball diameter [m], and the contacts without film, to the bearing's state."""

Margins = Callable[[WearState], np.ndarray]


@dataclass
class FilmPath:
    """States along a life by one way of counting, and when they are reached."""

    states: list[WearState] = field(default_factory=list)
    times: list[float] = field(default_factory=list)  # [s]
    criterion: int = _NO_CRITERION
    status: int = code.CRITERION_NOT_REACHED


class FilmLife:
    """Life of a bearing by one way of counting wear, step by step.

    Parameters
    ----------
    scene : Scene
    states : callable
        See `States`.
    margins : callable
        From a state to how far each criterion is from being met.
    counts : int
        Index into `COUNTS`.
    tolerance : float
        Relative, of a step.
    first_step : float
        Of the ball diameter.
    """

    def __init__(
        self,
        scene: Scene,
        states: States,
        margins: Margins,
        counts: int,
        tolerance: float,
        first_step: float = FIRST_STEP,
    ):
        self.states, self.margins, self.counts = states, margins, counts
        self.tolerance, self.n_balls = tolerance, scene.bearing.ball_count
        self.films = Films.of(scene)
        self.cover = self.films.cover
        self.present = scene.wear.ball_diameter_loss_um[0] * UM
        D0 = scene.bearing.ball_diameter_mm * MM
        self.bound, self.first_step = LARGEST_LOSS * D0 - self.present, first_step * D0

    def depths(self, y: np.ndarray) -> np.ndarray:
        """Worn off the inner and the outer groove and the surface of a ball (3,) [m]."""
        return np.array([y[1], y[2], 0.5 * y[0]])

    @property
    def thickness(self) -> np.ndarray:
        """Thickness left of the films on them, 0 where there is none (3,) [m]."""
        race, ball = self.films.race.thickness, self.films.ball.thickness
        return np.where(self.cover, [race, race, ball], 0.0)

    def at(self, y: np.ndarray) -> WearState:
        """The state with so much worn off; raises `Unsolved`."""
        counted = y[0] + (y[1] + y[2] if self.counts else 0.0)
        bare = self.films.bare(self.cover)
        state = self.states(self.present + float(counted), bare)
        if state.status != code.OK:
            raise Unsolved(state.status)
        wearing = self.films.wearing(self.cover, 0.5 * y[0], y[1:3])
        ball, race = (np.broadcast_to(part.K_s / part.H, 2) for part in wearing)
        off_ball = float(state.per_wear[0] @ ball)
        off_races = state.per_wear[1] * race
        return replace(
            state,
            rate=np.array([off_ball, off_ball + off_races.sum()]),
            ball_rate=float(state.qv @ ball),
            race_rate=self.n_balls * race * state.qv,
            depth_rate=off_races,
            film=np.maximum(self.thickness - self.depths(y), 0.0),
            film_worn=np.array(bare, dtype=float),
        )

    def rates(self, s: float, y: np.ndarray) -> np.ndarray:
        """Derivative of (loss of a ball, depths of both grooves, t) by the counted loss."""
        state = self.at(y)
        return np.array([state.rate[0], *state.depth_rate, 1.0]) / state.rate[self.counts]

    def margin(self, y: np.ndarray) -> np.ndarray:
        """How far each criterion is from being met, and each film from being worn through."""
        thickness = self.thickness
        left = np.where(thickness > 0.0, 1.0, np.inf)
        shares = self.depths(y) / np.where(thickness > 0.0, thickness, 1.0)
        return np.append(self.margins(self.at(y)), left - np.where(thickness > 0.0, shares, 0.0))

    def integrate(self) -> FilmPath:
        """From the present loss to the first criterion, or to where the solver or range ends."""
        path, y, s = FilmPath(), np.zeros(4), 0.0
        try:
            while self._starts(path, y) and s < self.bound:
                s, y, met = self._follow(path, s, y)
                if met < 0:
                    break
                if met < _NO_CRITERION:
                    path.criterion, path.status = met, code.OK
                    break
                worn = [*self.cover]
                worn[met - _NO_CRITERION] = False
                self.cover = Cover(*worn)
        except Unsolved as failure:
            path.status = failure.status
            if not path.states:
                path.states.append(WearState(self.present, failure.status))
        return path

    def _starts(self, path: FilmPath, y: np.ndarray) -> bool:
        """Begin, new or with a film worn through; whether anything wears, and no criterion is met.

        Raises `Unsolved`.
        """
        self._keep(path, y)
        met = np.flatnonzero(self.margins(path.states[-1]) <= 0.0)
        if met.size:
            path.criterion, path.status = int(met[0]), code.OK
        return not met.size and path.states[-1].rate.min() > 0.0

    def _keep(self, path: FilmPath, y: np.ndarray) -> None:
        path.states.append(self.at(y))
        path.times.append(float(y[_TIME]))

    def _solver(self, s: float, y: np.ndarray, bound: float, step: float) -> RK45:
        small = self.tolerance * self.first_step
        atol = np.array([small] * 3 + [small / self.at(y).rate[self.counts]])
        first = min(step, bound - s)
        return RK45(self.rates, s, y, bound, rtol=self.tolerance, first_step=first, atol=atol)

    def _follow(self, path: FilmPath, s: float, y: np.ndarray) -> tuple[float, np.ndarray, int]:
        """Take steps until something is met.

        Returns
        -------
        s, y, int
            Where, and the index of what was met in `margin`; -1 where the range ends.
        """
        step = self.first_step
        solver = self._solver(s, y, self.bound, step)
        for _ in range(_MOST_STEPS):
            try:
                solver.step()
                crossing = first_crossing(solver, self.margin)
                end = solver.t if crossing is None else crossing[0]
                dense = solver.dense_output()
                between = [dense(x) for x in s + (end - s) * np.array([0.25, 0.5, 0.75])]
                for one in between:
                    self.at(one)
            except Unsolved as failure:
                # What ends the solver's range lies within this step.
                if path.status in REASONLESS:
                    path.status = failure.status
                step = 0.25 * min(step, solver.h_abs)
                if step < SHORTEST_STEP * self.first_step:
                    return s, y, -1
                solver = self._solver(s, y, self.bound, step)
                continue
            for one in between:
                self._keep(path, one)
            if crossing is not None:
                y = self._exactly(s, y, end, step)
                self._keep(path, y)
                return end, y, crossing[1]
            s, y, step = float(solver.t), solver.y.copy(), float(solver.h_abs)
            self._keep(path, y)
            if solver.status == "finished":
                break
        return s, y, -1

    def _exactly(self, s: float, y: np.ndarray, end: float, step: float) -> np.ndarray:
        """What is worn at the end of a shortened step."""
        if not end > s:
            return y
        return at_end(self._solver(s, y, end, step))


def film_history(scene: Scene, states: States, margins: Margins) -> LifeHistory:
    """Wear states of a scene up to its end of life, and the bound of how they are integrated."""
    known: dict[tuple[float, Bare], WearState] = {}

    def state(loss: float, bare: Bare) -> WearState:
        if (loss, bare) not in known:
            known[loss, bare] = states(loss, bare)
        return known[loss, bare]

    def path(counts: int, tolerance: float, first_step: float = FIRST_STEP) -> FilmPath:
        return FilmLife(scene, state, margins, counts, tolerance, first_step).integrate()

    tolerance, own = scene.model.tolerance, COUNTS.index(scene.wear.counts)
    paths = [path(counts, tolerance) for counts in range(len(COUNTS))]
    chosen = paths[own]
    ends = [p.times[-1] if p.times and p.status == chosen.status else np.nan for p in paths]
    times = np.full((len(chosen.states), len(COUNTS)), np.nan)
    times[: len(chosen.times), own] = chosen.times
    if len(times):
        times[-1] = ends
    error = np.full(len(COUNTS), np.nan)
    # in other steps; the same ones would hide an error far below the tolerance
    loose = path(own, min(_LOOSER * tolerance, 1e-2), _UNLIKE * FIRST_STEP)
    if loose.times and ends[own] == ends[own]:
        error[own] = abs(loose.times[-1] - ends[own])
    return LifeHistory(
        states=chosen.states,
        times=list(times),
        error=error,
        criterion=chosen.criterion,
        status=chosen.status,
        solves=len(known),
    )
