"""Wear life with grooves that are followed as they wear (theory.md section 21)."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.optimize import brentq

from bearingwear.kernels import status as code
from bearingwear.model import parameters
from bearingwear.model.heat import SteadyHeat
from bearingwear.model.life import margins
from bearingwear.model.life_integrator import LifeHistory
from bearingwear.model.outputs import wear_values
from bearingwear.model.pair import Pair
from bearingwear.model.pair_balance import SideState
from bearingwear.model.state import State
from bearingwear.model.states_at_loss import in_half_of_pair
from bearingwear.model.steady import ThrustProblem
from bearingwear.model.thermal import warmed
from bearingwear.model.worn_depths import WornDepths, WornPoint
from bearingwear.model.worn_side import WornSide
from bearingwear.model.worn_states import WornBearing
from bearingwear.scene.blocks import CRITERIA, EndOfLife
from bearingwear.scene.scene import LARGEST_LOSS, Scene

WORN_CELLS = (48, 10)  # along the major axis, and on each side of it
FEWER_CELLS = (32, 8)  # to see the error of the others
STEP = 0.08  # deepest wear of a step, over the gap A a^2
WORN_ROTOR_BALANCED = 1e-6  # force left on a rotor, over the larger one
ON_THE_WAY_BALANCED = 1e-4  # the same in the middle of a step
_MOST_STEPS = 1000
_SHORTENINGS = 6  # of a step that fails, each by half
_SHORT = 0.3  # of the step before
_END = 1e-4  # of the last step, to which its end is found

Wears = tuple[WornDepths, ...]


@dataclass(frozen=True)
class WornLifeHistory:
    """A bearing's life step by step: states, what the rotor sees of them, and the profiles."""

    history: LifeHistory
    points: list[WornPoint]
    approach_loss: np.ndarray  # (steps,) L [m]
    bearing: WornBearing | None


@dataclass(frozen=True)
class Instant:
    """The bearing, or both, with some wear."""

    status: int
    wears: Wears
    sides: tuple[SideState, ...] = ()
    states: tuple[State, ...] = ()

    @property
    def points(self) -> list[WornPoint]:
        """What has been solved, of each bearing."""
        return [side.answer for side in self.sides]


@dataclass
class _Course:
    """Instants on the way, and when they are reached [s]."""

    instants: list[Instant]
    times: list[float] = field(default_factory=lambda: [0.0])
    criterion: int = len(CRITERIA) - 1
    status: int = code.CRITERION_NOT_REACHED


class WornLife:
    """Heun steps of the wear of a bearing, or of two on a rotor, watching the criteria.

    Parameters
    ----------
    scene : Scene
    cells, step
        Instead of the usual ones.
    perturbed : int, optional
        Which of `ThrustProblem.perturbed` is solved, instead of the scene's own problem.
    only_times : bool
        Whether states have no stiffness where nothing ends by it.
    """

    def __init__(
        self,
        scene: Scene,
        cells: tuple[int, int] = WORN_CELLS,
        step: float = STEP,
        perturbed: int | None = None,
        only_times: bool = False,
    ):
        self.scene, self.step, self.cells, self.perturbed = scene, step, cells, perturbed
        self.end = scene.wear.end_of_life or EndOfLife()
        self.solves = 0
        self.before: tuple[Instant, float] | None = None  # the last step: its start and time
        self.pair: Pair | None = None
        self.by_stiffness = self.end.system_axial_stiffness_N_um is not None
        self.only_times = only_times
        self._last: Instant | None = None  # solved, not on the way
        self.status = code.OK
        self.sides: tuple[WornSide, ...] = self._pair() if scene.pair else self._single()

    def _single(self) -> tuple[WornSide, ...]:
        problem = self._problem(self.scene)
        self.status = problem.undetermined()
        if self.status != code.OK:
            return ()
        loss = float(self.scene.wear.ball_diameter_loss_um[0]) * parameters.UM
        case = problem.solve(problem.g.D0 - loss)
        if self.scene.thermal is not None:
            heat = SteadyHeat(loss, problem)
            found = warmed(self.scene, heat)
            if found.status != code.OK:
                self.status = found.status
                return ()
            problem, case = heat.problem, heat.case
        self.status = case.status
        if self.status != code.OK:
            return ()
        return (WornSide(self.scene, 1, problem, case, self.cells),)

    def _pair(self) -> tuple[WornSide, ...]:
        pair = self.scene.pair
        assert pair is not None
        hertz = Pair.of(self.scene, "steady")
        found = hertz.solve(hertz.losses)
        self.status = found.status
        if self.status != code.OK:
            return ()
        sides = []
        for scene, n, state in zip(self.scene.sides, pair.tandem, found.sides, strict=True):
            problem = replace(self._problem(scene), g=state.problem.g)
            problem = replace(problem, preload=state.problem.preload)
            sides.append(WornSide(scene, n, problem, state.answer, self.cells))
        self.pair = Pair(self.scene, sides, WORN_ROTOR_BALANCED)
        return tuple(sides)

    def _problem(self, scene: Scene) -> ThrustProblem:
        problem = ThrustProblem.of(scene)
        return problem if self.perturbed is None else problem.perturbed(scene)[self.perturbed]

    def at(self, wears: Wears, on_the_way: bool = False) -> Instant:
        """The state with some wear; what a life is told of it only if it is not on the way on."""
        self.solves += 1
        for side, wear in zip(self.sides, wears, strict=True):
            side.wear = wear
        shift = np.nan
        if self.pair is None:
            states: tuple[SideState, ...] = (self.sides[0].alone(),)
            status = states[0].status
        else:
            self.pair.tolerance = ON_THE_WAY_BALANCED if on_the_way else WORN_ROTOR_BALANCED
            found = self.pair.solve((self.sides[0].progress, self.sides[1].progress))
            states, status, shift = found.sides, found.status, found.shift
        if status != code.OK:
            return Instant(status, wears)
        for side, state in zip(self.sides, states, strict=True):
            side.bearing.count_from(state.answer)
        if on_the_way:
            return Instant(status, wears, states)
        made = []
        for side, state in zip(self.sides, states, strict=True):
            one = side.life_state(0.0, state)
            if self.pair is None:
                one = in_half_of_pair(self.scene, side.mounted, one)
            else:
                one = one.with_values({"rotor_axial_shift": shift})
            made.append(one)
        self._last = Instant(status, wears, states, tuple(made))
        if self.by_stiffness:
            self._last = self.with_stiffness(self._last)
        return self._last

    def with_stiffness(self, now: Instant) -> Instant:
        """The instant last solved, with both stiffnesses of its states."""
        each = zip(self.sides, now.sides, strict=True)
        sides = tuple(side.with_stiffness(state) for side, state in each)
        both, made = {}, []
        if self.pair is not None:
            both["system_axial_stiffness"] = self.pair.stiffness(*(s.stiffness for s in sides))
            of_each = (s.quasistatic for s in sides)
            both["system_quasistatic_axial_stiffness"] = self.pair.stiffness(*of_each)
        for side, one, state in zip(self.sides, sides, now.states, strict=True):
            own = {
                "axial_stiffness": one.stiffness / side.tandem,
                "quasistatic_axial_stiffness": one.quasistatic / side.tandem,
            }
            found = state.with_values(own | both)
            alone = self.pair is None
            made.append(in_half_of_pair(self.scene, side.mounted, found) if alone else found)
        return replace(now, sides=sides, states=tuple(made))

    def kept(self, now: Instant) -> Instant:
        """An instant that the history keeps, which has its stiffnesses; not if only times count."""
        if self.by_stiffness or self.only_times or now.status != code.OK:
            return now
        return self.with_stiffness(now if now is self._last else self.at(now.wears))

    def rates(self, now: Instant) -> Wears:
        """Wear per second of each bearing."""
        return tuple(side.rate(point) for side, point in zip(self.sides, now.points, strict=True))

    def heun(self, now: Instant, rates: Wears, dt: float) -> Instant:
        """The state after the time dt; the one that failed, if one does."""
        if self.before is not None:
            earlier, passed = self.before
            for side, was, point in zip(self.sides, earlier.points, now.points, strict=True):
                side.bearing.start_ahead(was, point, dt / passed)
        ahead = self.at(_after(now.wears, dt, rates), on_the_way=True)
        if ahead.status != code.OK:
            return ahead
        mean = tuple(a.mean(b) for a, b in zip(rates, self.rates(ahead), strict=True))
        return self.at(_after(now.wears, dt, mean))

    def longest_step(self, now: Instant, rates: Wears) -> float:
        """Time in which the deepest place wears by `step` of the gap at the edge [s]."""
        lengths = []
        for side, point, rate in zip(self.sides, now.points, rates, strict=True):
            deepest = rate.grooves.max(axis=1) + rate.band.max(initial=0.0) + 0.5 * rate.ball
            lengths.append(self.step / (deepest / side.bearing.gap_at_edge(point)).max())
        return float(min(lengths))

    def _too_deep(self, now: Instant, new: Instant) -> bool:
        both = zip(self.sides, now.points, new.points, strict=True)
        return any(side.too_deep(before, after, self.step) for side, before, after in both)

    def margin(self, now: Instant) -> np.ndarray:
        """How far each criterion is from being met, as `life.margins`."""
        left = [
            margins(state, self.end, side.scene.operation.preload_N)
            for side, state in zip(self.sides, now.states, strict=True)
        ]
        return np.min(left, axis=0)

    def march(self) -> tuple[WornLifeHistory, ...]:
        """Steps to the first criterion, or to where the solver or the range ends.

        Returns
        -------
        tuple of WornLifeHistory
            One of each bearing.
        """
        if self.status == code.OK:
            self.status = next(
                (s.bearing.status for s in self.sides if s.bearing.status != code.OK), code.OK
            )
        start = Instant(self.status, ())
        if self.status == code.OK:
            start = self.kept(self.at(tuple(side.bearing.unworn() for side in self.sides)))
        if start.status != code.OK:
            return self._nothing(start.status)
        course = _Course([start])
        met = np.flatnonzero(self.margin(start) <= 0.0)
        if met.size:
            course.criterion, course.status = int(met[0]), code.OK
        elif max(max(side.factors) for side in self.sides) > 0.0:
            self._extend(course)
        return tuple(self._history(k, course) for k in range(len(self.sides)))

    def _nothing(self, status: int) -> tuple[WornLifeHistory, ...]:
        """Histories of a life that has no start."""
        scenes = self.scene.sides if self.scene.pair else (self.scene,)
        found = []
        for scene in scenes:
            loss = float(scene.wear.ball_diameter_loss_um[0]) * parameters.UM
            history = LifeHistory(
                states=[State.unsolved(status, loss)],
                times=[np.zeros(2)],
                error=np.zeros(2),
                criterion=len(CRITERIA) - 1,
                status=status,
                solves=self.solves,
            )
            found.append(WornLifeHistory(history, [], np.zeros(0), None))
        return tuple(found)

    def _history(self, k: int, course: _Course) -> WornLifeHistory:
        side, points = self.sides[k], [now.points[k] for now in course.instants]
        states = [now.states[k] for now in course.instants]
        history = LifeHistory(
            states=_with_rates(side, points, states, np.array(course.times)),
            times=[np.array([np.nan, t]) for t in course.times],
            error=np.zeros(2),
            criterion=course.criterion,
            status=course.status,
            solves=self.solves,
        )
        losses = np.array([side.approach_loss(point) for point in points])
        return WornLifeHistory(history, points, losses, side.bearing)

    def _extend(self, course: _Course) -> None:
        """Take steps until a criterion is met."""
        largest = [
            LARGEST_LOSS * side.scene.bearing.ball_diameter_mm * parameters.MM
            for side in self.sides
        ]
        for _ in range(_MOST_STEPS):
            now = course.instants[-1]
            rates = self.rates(now)
            dt = self.longest_step(now, rates)
            new = self.heun(now, rates, dt)
            for _ in range(_SHORTENINGS):
                if new.status == code.OK and not self._too_deep(now, new):
                    break
                dt *= 0.5
                new = self.heun(now, rates, dt)
            if new.status != code.OK:
                course.status = new.status
                return
            before, after = self.margin(now), self.margin(new)
            met = np.flatnonzero(after <= 0.0)
            if met.size:
                shares = before[met] / (before[met] - after[met])
                k = int(met[np.argmin(shares)])
                dt, new = self._end_of(now, rates, dt, k, (before[k], after[k]), new)
                course.criterion, course.status = k, code.OK
            self.before = now, dt
            course.instants.append(self.kept(new))
            course.times.append(course.times[-1] + dt)
            far = any(s.loss > most for s, most in zip(new.states, largest, strict=True))
            if met.size or far:
                return

    def _end_of(self, now, rates, dt, k, margins_at, new):
        """Length and end of the step that meets criterion k."""
        reached = {dt: new}

        def value(part: float) -> float:
            if part == 0.0:
                return margins_at[0]
            if part == dt:
                return margins_at[1]
            reached[part] = self.heun(now, rates, part)
            return self.margin(reached[part])[k] if reached[part].status == code.OK else -1.0

        root = brentq(value, 0.0, dt, xtol=_END * dt, rtol=1e-12)
        solved = {part: p for part, p in reached.items() if p.status == code.OK}
        part = min(solved, key=lambda length: abs(length - root))
        return part, solved[part]


def _after(wears: Wears, dt: float, rates: Wears) -> Wears:
    """Wear after the time dt."""
    return tuple(wear.plus(dt, rate) for wear, rate in zip(wears, rates, strict=True))


def _with_rates(
    side: WornSide, points: Sequence[WornPoint], states: Sequence[State], times: np.ndarray
) -> list[State]:
    """States of a bearing, with the rate at which its even loss grows."""
    loss = np.array([s.loss for s in states])
    if len(states) < 2:
        p, first = points[0], states[0]
        worn_by = first["qv"][None], first["semi_major_axis"][None], p.track[None]
        wear = wear_values(side.scene, np.array([p.D]), *worn_by)
        return [_losing(first, wear["ball_diameter_loss_rate"])]
    # A last step that is short says nothing of a rate.
    steps = np.diff(times)
    n = len(times) - (len(times) > 2 and steps[-1] < _SHORT * steps[-2])
    rates = np.gradient(loss[:n], times[:n], edge_order=2 if n > 2 else 1)
    rates = np.append(rates, rates[-1:])[: len(times)]
    each = zip(states, rates, strict=True)
    return [_losing(state, np.array([np.nan, rate])) for state, rate in each]


def _losing(state: State, rate: np.ndarray) -> State:
    """A state with the rate of its loss, by both ways of counting [m/s]."""
    return state.with_values({"ball_diameter_loss_rate": rate})
