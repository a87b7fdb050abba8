"""Wear life of two bearings: each integrates its own loss of ball diameter (theory.md section 19).

The state depends on both losses, so the life is an initial-value problem over their sum s,

    dL_k/ds = r_k/(r_1 + r_2),   dt/ds = 1/(r_1 + r_2),

which SciPy's explicit Runge-Kutta method integrates. Each way of counting wear takes its own path.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.integrate import RK45

from bearingwear.kernels import status as code
from bearingwear.model import parameters
from bearingwear.model.estimate import DOUBLED, HALVED, ROUNDING, changed
from bearingwear.model.life import (
    error_estimate,
    history_values,
    life_history,
    life_values,
    margins,
)
from bearingwear.model.life_integrator import (
    FIRST_STEP,
    REASONLESS,
    SHORTEST_STEP,
    Unsolved,
    WearState,
)
from bearingwear.model.met_within import at_end, first_crossing, within
from bearingwear.model.pair import Pair, SteadySide
from bearingwear.model.pair_case import stacked_sides
from bearingwear.model.states_at_loss import race_control_states, steady_states
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.scene import COUNTS, LARGEST_LOSS, EndOfLife, Scene
from bearingwear.sides import SHARED

NO_CRITERION = len(CRITERIA) - 1
LOOSER_LIFE = 30.0  # tolerance of the run that shows how well the life is integrated
LIFE_BALANCED = 1e-9  # force left on the rotor in a state of a life, over the larger one
_MOST_STEPS = 2000

Both = tuple[WearState, WearState]


@dataclass
class PairHistory:
    """States of both bearings up to the end of life, and when they are reached."""

    states: list[Both]
    times: list[float] = field(default_factory=lambda: [0.0])  # [s]
    criterion: int = NO_CRITERION
    status: int = code.CRITERION_NOT_REACHED


class PairStates:
    """States of both bearings by their losses [m], each solved once."""

    def __init__(self, pair: Pair):
        self.pair = pair
        self._known: dict[tuple[float, float], Both] = {}

    @property
    def solves(self) -> int:
        return len(self._known)

    @property
    def failed(self) -> int:
        """How many of them were not found."""
        return sum(first.status != code.OK for first, _ in self._known.values())

    def __call__(self, losses: tuple[float, float]) -> Both:
        if losses not in self._known:
            self._known[losses] = self._solved(losses)
        return self._known[losses]

    def _solved(self, losses: tuple[float, float]) -> Both:
        found = self.pair.solve(losses)
        if found.status != code.OK:
            first, second = (WearState(loss, found.status) for loss in losses)
            return first, second
        system: dict[str, Any] = {"system_stiffness": found.stiffness, "shift": found.shift}
        first, second = (
            replace(side.wear_state(loss, state), **system)
            for side, loss, state in zip(self.pair.sides, losses, found.sides, strict=True)
        )
        return first, second


class PairLife:
    """The path of a pair through its life by one way of counting wear.

    Parameters
    ----------
    states : PairStates
    scene : Scene
        Of the pair; its end of life may be another one.
    counts : int
        Index into `COUNTS`.
    tolerance : float
        Relative, of a step.
    between : sequence of float
        Shares of each step after which a state is kept, too.
    """

    def __init__(
        self,
        states: PairStates,
        scene: Scene,
        counts: int,
        tolerance: float,
        between: Sequence[float] = (0.25, 0.5, 0.75),
    ):
        self.states, self.pair, self.scene = states, states.pair, scene
        self.counts, self.tolerance, self.between = counts, tolerance, between
        self.end = scene.wear.end_of_life or EndOfLife()
        self.largest = [
            LARGEST_LOSS * side.scene.bearing.ball_diameter_mm * parameters.MM
            for side in self.pair.sides
        ]

    def at(self, y: np.ndarray) -> Both:
        """States at (L_1, L_2, t); raises `Unsolved`."""
        found = self.states((float(y[0]), float(y[1])))
        failed = next((one.status for one in found if one.status != code.OK), code.OK)
        if failed != code.OK:
            raise Unsolved(failed)
        return found

    def rates(self, s: float, y: np.ndarray) -> np.ndarray:
        """Derivative of (L_1, L_2, t) by the sum of the losses."""
        r_1, r_2 = (one.rate[self.counts] for one in self.at(y))
        return np.array([r_1, r_2, 1.0]) / (r_1 + r_2)

    def margin(self, y: np.ndarray) -> np.ndarray:
        """How far each criterion, and the largest loss that is followed, is from being met."""
        each = zip(self.at(y), self.pair.sides, strict=True)
        left = [margins(one, self.end, s.scene.operation.preload_N) for one, s in each]
        worst = np.min(left, axis=0)
        room = min(1.0 - loss / most for loss, most in zip(y, self.largest, strict=False))
        return np.append(worst, room)

    def integrate(self) -> PairHistory:
        """From the present losses to the first criterion, or to where the solver ends."""
        y = np.array([*self.pair.losses, 0.0])
        start = self.states(self.pair.losses)
        history = PairHistory(states=[start])
        failed = next((one.status for one in start if one.status != code.OK), code.OK)
        if failed != code.OK:
            history.status = failed
        elif min(one.rate.min() for one in start) > 0.0:
            met = np.flatnonzero(self.margin(y) <= 0.0)
            if met.size:
                history.criterion, history.status = _ended(int(met[0]))
            else:
                self._follow(history, y)
        return history

    def _solver(self, s: float, y: np.ndarray, bound: float, step: float) -> RK45:
        rate = sum(one.rate[self.counts] for one in self.at(y))
        small = self.tolerance * self.first_step
        return RK45(
            self.rates, s, y, bound, rtol=self.tolerance, first_step=min(step, bound - s),
            atol=np.array([small, small, small / rate]),
        )  # fmt: skip

    @property
    def first_step(self) -> float:
        """In the sum of the losses [m]."""
        return 2.0 * FIRST_STEP * min(self.largest) / LARGEST_LOSS

    def _follow(self, history: PairHistory, y: np.ndarray) -> None:
        """Take steps up to the first criterion."""
        s, step, bound = 0.0, self.first_step, sum(self.largest)
        solver = self._solver(s, y, bound, step)
        for _ in range(_MOST_STEPS):
            try:
                solver.step()
                crossing = first_crossing(solver, self.margin)
                end = solver.t if crossing is None else crossing[0]
                between = [within(solver, s + share * (end - s)) for share in self.between]
                for one in between:
                    self.at(one)
            except Unsolved as failure:
                # What ends the solver's range lies within this step.
                if history.status in REASONLESS:
                    history.status = failure.status
                step = 0.25 * min(step, solver.h_abs)
                if step < SHORTEST_STEP * self.first_step:
                    return
                solver = self._solver(s, y, bound, step)
                continue
            self._keep(history, between)
            if crossing is not None:
                self._keep(history, [self._exactly(s, y, crossing[0])])
                history.criterion, history.status = _ended(crossing[1])
                return
            s, y, step = float(solver.t), solver.y.copy(), float(solver.h_abs)
            self._keep(history, [y])

    def _keep(self, history: PairHistory, reached: Sequence[np.ndarray]) -> None:
        """Keep what has been reached; raises `Unsolved`."""
        for y in reached:
            history.states.append(self.at(y))
            history.times.append(float(y[2]))

    def _exactly(self, s: float, y: np.ndarray, end: float) -> np.ndarray:
        """(L_1, L_2, t) at the end of a shortened step: within it they are known less well."""
        if not end > s:
            return y
        return at_end(self._solver(s, y, end, end - s))


def _ended(criterion: int) -> tuple[int, int]:
    """Index and status of what has been met: a criterion, or the largest loss."""
    return criterion, code.CRITERION_NOT_REACHED if criterion == NO_CRITERION else code.OK


def pair_life(scene: Scene, fidelity: str) -> tuple[dict, dict]:
    """Values and attributes of a life of two bearings whose contacts stay Hertzian."""
    a = scene.pair
    assert a is not None
    if a.is_symmetric:
        side = scene.sides[0]
        states = steady_states if fidelity == "steady" else race_control_states
        history = life_history(side, states(side))
        values = life_values(side, history)
        values |= error_estimate(side, history) if fidelity == "steady" else {}
        return of_both(values, values), {"solves": history.solves}
    return _unequal_life(scene, fidelity)


def pair_states(scene: Scene, fidelity: str, balance: float = LIFE_BALANCED) -> PairStates:
    """States of a pair, balanced as well as a life needs."""
    pair = Pair.of(scene, fidelity, balance)
    for side in pair.sides:
        if isinstance(side, SteadySide):
            side.problem = side.problem.without_finer
    return PairStates(pair)


def _unequal_life(scene: Scene, fidelity: str) -> tuple[dict, dict]:
    tolerance, own = scene.model.tolerance, COUNTS.index(scene.wear.counts)
    state = pair_states(scene, fidelity)
    runs = [PairLife(state, scene, c, tolerance).integrate() for c in range(len(COUNTS))]
    history = runs[own]
    values: dict = {"status": history.status, "end_criterion": history.criterion}
    start = history.states[0]
    if any(one.status != code.OK or not one.rate.min() > 0.0 for one in start):
        return values, {"solves": state.solves}
    factor, _ = parameters.wear_factors(scene)
    lives = np.array([run.times[-1] if run.status == history.status else np.nan for run in runs])
    loose = PairLife(state, scene, own, min(LOOSER_LIFE * tolerance, 1e-2)).integrate()
    bound = np.full(len(COUNTS), np.nan)
    bound[own] = abs(loose.times[-1] - lives[own])
    times = np.full((len(history.times), len(COUNTS)), np.nan)
    times[:, own] = history.times
    values |= {
        "life": lives,
        "normalised_life": lives * factor,
        "life_error_bound": bound,
        "history_time": times,
    }
    each = [
        history_values([states[k] for states in history.states])
        | {"loss_at_end": history.states[-1][k].loss}
        for k in range(2)
    ]
    values |= of_both(*each)
    if fidelity == "steady" and history.status == code.OK and lives[own] > 0.0:
        values |= _error_estimate(scene, own, history, bound[own] / lives[own])
    return values, {"solves": state.solves}


def of_both(first: dict, second: dict) -> dict:
    """Values of two lives as those of one pair; what they share is that of the first."""
    shared = {name: value for name, value in first.items() if name in SHARED}
    own = [{n: v for n, v in one.items() if n not in SHARED} for one in (first, second)]
    return shared | stacked_sides(own)


def _error_estimate(scene: Scene, own: int, history: PairHistory, integration: float) -> dict:
    """Estimated numerical error of a life: the same with other settings (see `estimate`)."""
    total = np.full(len(COUNTS), np.nan)
    total[own] = ROUNDING + integration
    for weight, k in ((HALVED, 0), (DOUBLED, 1)):
        state = pair_states(scene, "steady")
        for side in state.pair.sides:
            assert isinstance(side, SteadySide)
            side.problem = side.problem.perturbed(side.scene)[k]
        other = PairLife(state, scene, own, scene.model.tolerance).integrate()
        if (other.status, other.criterion) != (history.status, history.criterion):
            return {}
        now = np.array(history.times[-1])
        total[own] += weight * float(changed(now, np.array(other.times[-1])))
    return {"life_error_estimate": total}
