"""A dynamic run: windows of recorded time, their trend, lines of progress."""

import math
import time as clock
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.cage.body import INNER_LAND, NO_LAND
from bearingwear.kernels.dynamic import record
from bearingwear.kernels.dynamic.integrators import ROSENBROCK, RUNGE_KUTTA
from bearingwear.measures import plain
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.films import Archard
from bearingwear.solvers.bearing.outputs import strip_centres
from bearingwear.solvers.dynamic.periodic import PeriodicMotion
from bearingwear.solvers.dynamic.system import STEPS_PER_TURN, DynamicSystem
from kerneljit.interrupt import check_interrupt

INTEGRATORS = {"rosenbrock": ROSENBROCK, "runge_kutta": RUNGE_KUTTA}
REPORT_EVERY = 3.0  # seconds of wall time between lines of progress
FAR_FROM_LAND = 200.0  # turns: a cage that drifts to its land more slowly counts as settled
RIDING = 0.02  # of its clearance: mean distance at which a cage rides on its land
FEWEST_OF_TREND = 3  # turns, or passings of a periodic motion
_SIGNIFICANT = 3.0  # standard errors of a slope
TREND_OF_TORQUE = 4  # column of `Trend`: the shaft's torque, summed over the instants of a turn
SHORT = 16  # turns of the run for each turn that is run again
RECENT_REPORTS = 3  # lines of progress from which the remaining time is estimated


class Trend:
    """Straight lines through the values of successive turns, or passings, without keeping them.

    The six values are QV, wear of all parts, wear as counted, preload, shaft torque and room. The
    room is the distance of the cage from its land, as a share of their clearance.

    turns: shaft turns of each value.
    """

    def __init__(self, turns: float = 1.0) -> None:
        self.turns = turns
        self.sums = np.zeros(3)  # 1, k, k^2
        self.values = np.zeros((3, 6))  # (value, k value, value^2) of each

    def add(self, values: np.ndarray) -> None:
        """Adds the six values (6,) of a turn."""
        k = self.sums[0]
        self.sums += (1.0, k, k * k)
        self.values += [values, k * values, values * values]

    @property
    def is_known(self) -> bool:
        """Returns whether there are enough turns for slopes, in which something slips and wears."""
        return bool(self.sums[0] >= FEWEST_OF_TREND and (self.values[0, :2] > 0.0).all())

    def slopes(self) -> np.ndarray | None:
        """Returns relative changes per turn of all values but the room (5,); None if not known.

        For a value whose mean is 0, it is the change itself.
        """
        n, k, kk = self.sums
        total, weighted, _ = self.values[:, :-1]
        if not self.is_known:
            return None
        mean = np.where(total != 0.0, total / n, 1.0)
        return (n * weighted - k * total) / (n * kk - k * k) / mean / self.turns

    def scatter(self) -> np.ndarray:
        """Returns the relative standard error of each mean, as of independent turns (5,)."""
        n = self.sums[0]
        mean, square = self.values[0, :-1] / n, self.values[2, :-1] / n
        variance = np.maximum(square - mean * mean, 0.0) / max(n - 1.0, 1.0)
        return np.sqrt(variance) / np.where(mean != 0.0, np.abs(mean), 1.0)

    def turns_to_land(self) -> float:
        """Returns the turns until a drifting cage meets its land.

        Infinite with too few turns, and for a cage that rides on its land already. Infinite also
        where the slope towards it is below `_SIGNIFICANT` of its standard errors.
        """
        n, k, kk = self.sums
        total, weighted, square = self.values[:, -1]
        if n < FEWEST_OF_TREND:
            return math.inf
        spread = kk - k * k / n
        slope = (weighted - k * total / n) / spread
        residual_squares = max(square - total * total / n - slope * slope * spread, 0.0)
        error = math.sqrt(residual_squares / ((n - 2.0) * spread))
        room = total / n + 0.5 * slope * (n - 1.0)
        if room <= RIDING or -slope <= _SIGNIFICANT * error:
            return math.inf
        return -room / slope


def wear_per_joule(scene: Scene, material: str) -> float:
    """Returns K_s/H of a material without films: worn volume per normal force times slip [m3/J]."""
    m = scene.materials[material]
    return Archard(m.wear_coefficient, m.brinell_hardness_GPa * parameters.GPA).factor


def wear_weights(scene: Scene, system: DynamicSystem) -> np.ndarray:
    """Returns weights (3, m) that turn time integrals of the state [J] into QV and worn volumes.

    The rows are QV in the contacts of balls and races [J], wear of all parts [m3], and wear as
    counted [m3]: that of the balls, or of balls and races.
    """
    layout = system.layout
    ball, race = parameters.wear_factors(scene)
    ball_in_pocket = wear_per_joule(scene, scene.bearing.ball_material)
    cage = wear_per_joule(scene, scene.cage.material) if scene.cage else 0.0
    weights = np.zeros((3, layout.size - layout.qv))
    contacts = slice(0, layout.pockets - layout.qv)
    pockets = slice(layout.pockets - layout.qv, layout.land - layout.qv)
    weights[0, contacts] = 1.0
    counted = ball + race if scene.wear.counts_races else ball
    weights[1:, contacts] = np.array([[ball + race], [counted]])
    weights[1:, pockets] = np.array([[ball_in_pocket + cage], [ball_in_pocket]])
    weights[1, layout.land - layout.qv] = cage
    return weights


class LoadRange:
    """Range of the loads of each contact (n, 2) over the instants of a window."""

    def __init__(self, balls: int) -> None:
        self.largest = np.zeros((balls, 2))  # [N]
        self.smallest = np.full((balls, 2), np.inf)  # [N]
        self.unloaded = np.zeros((balls, 2))  # instants without load
        self.roots = np.zeros((balls, 2))  # sum of the loads' cube roots, as of the pressure

    def add(self, loads: np.ndarray) -> None:
        """Adds loads (instants, n, 2) [N]."""
        self.largest = np.maximum(self.largest, loads.max(axis=0))
        self.smallest = np.minimum(self.smallest, loads.min(axis=0))
        self.unloaded += (loads == 0.0).sum(axis=0)
        self.roots += np.cbrt(loads, dtype=float).sum(axis=0)

    def of_like_balls(self) -> "LoadRange":
        """Returns the range with the values of all balls for each, as they all move alike."""
        alike = LoadRange(len(self.largest))
        alike.largest[:] = self.largest.max(axis=0)
        alike.smallest[:] = self.smallest.min(axis=0)
        alike.unloaded[:] = self.unloaded.mean(axis=0)
        alike.roots[:] = self.roots.mean(axis=0)
        return alike

    def largest_pressure(self, mean: np.ndarray, count: int) -> np.ndarray:
        """Returns the largest pressure (n, 2), given its mean over a number of instants [Pa].

        Hertz' law is applied at the mean contact angle, which changes the curvatures by a few
        thousandths at most.
        """
        mean_root = self.roots / count
        ratio = np.cbrt(self.largest) / np.where(mean_root > 0.0, mean_root, 1.0)
        return mean * np.where(mean_root > 0.0, ratio, 0.0)


class _Progress:
    """Lines of progress, no more often than every few seconds.

    say: receives a line; None for no lines.
    turns: shaft turns of the whole run.
    turn: duration of a shaft turn [s].
    """

    def __init__(self, say: Callable[[str], None] | None, turns: float, turn: float) -> None:
        self.say, self.turns, self.turn = say, turns, turn
        self.start = self.last = clock.monotonic()
        self.recent = deque([(self.start, 0.0)], maxlen=RECENT_REPORTS)  # clock, turns

    def __call__(self, done: float, slopes: np.ndarray | None) -> None:
        """Writes a line if the last one is old enough.

        done: turns simulated.
        slopes: see `Trend.slopes`.
        """
        now = clock.monotonic()
        if self.say is None or now - self.last < REPORT_EVERY:
            return
        self.last = now
        last_time, last_done = self.recent[0]
        self.recent.append((now, done))
        seconds_left = (self.turns - done) * (now - last_time) / (done - last_done)
        drift = "not yet known" if slopes is None else f"{slopes[0]:+.1e} per turn"
        self.say(
            f"{done:.0f} of {self.turns:.0f} turns, {plain(1e3 * done * self.turn)} ms simulated "
            f"in {now - self.start:.0f} s, about {seconds_left:.0f} s left, QV drift {drift}"
        )


@dataclass(frozen=True)
class RunGrid:
    """Instants of a run: origin + k dt.

    A continued run keeps to the grid of the first, so both take the steps of a single run.
    """

    points: int  # instants per shaft turn, or per passing of a periodic motion
    dt: float  # [s]
    origin: float  # [s]
    first: int  # number k of the first instant
    total: int  # intervals to simulate
    window: int  # intervals of a window for averages
    turns: float = 1.0  # duration of `points` intervals

    @classmethod
    def of(cls, scene: Scene, time: float, turn: float) -> "RunGrid":
        """Returns the grid of a scene's run from a time [s].

        turn: duration of a shaft turn [s].
        """
        points = scene.model.history_points_per_turn or STEPS_PER_TURN
        dt = turn / points
        total = max(1, round(scene.model.simulated_turns * points))
        window = min(total, max(1, round(scene.model.averaged_turns * points)))
        k = round(time / dt)
        is_on_grid = k * dt == time
        return cls(
            points=points,
            dt=dt,
            origin=0.0 if is_on_grid else time,
            first=k if is_on_grid else 0,
            total=total,
            window=window,
        )

    @classmethod
    def of_orbit(cls, scene: Scene, motion: PeriodicMotion, turn: float) -> "RunGrid":
        """Returns the grid of a run through passings of a periodic motion.

        They make an orbit if histories are kept, else they are enough for a trend.

        turn: duration of a shaft turn [s].
        """
        turns = motion.passing / turn
        balls = len(motion.balls)
        per_turn = scene.model.history_points_per_turn or STEPS_PER_TURN
        points = math.ceil(per_turn * turns)
        passings = balls if scene.model.history_points_per_turn else min(balls, FEWEST_OF_TREND)
        total = passings * points
        return cls(
            points=points,
            dt=motion.passing / points,
            origin=motion.time,
            first=0,
            total=total,
            window=total,
            turns=turns,
        )

    def short(self, scene: Scene, time: float, turn: float) -> "RunGrid":
        """Returns the grid of half a turn or less, or of a passing of a periodic motion.

        time: of the first instant [s].
        turn: duration of a shaft turn [s].
        """
        if self.is_periodic:
            return replace(self, origin=time, total=self.points, window=self.points)
        count = max(1, min(self.points // 2, self.total // SHORT))
        model = replace(scene.model, simulated_turns=count / self.points, evaluated_turns=None)
        return RunGrid.of(replace(scene, model=model), time, turn)

    @property
    def is_periodic(self) -> bool:
        """Returns whether the grid is that of a periodic motion, whose balls all move alike."""
        return self.turns != 1.0  # any other grid has instants per shaft turn

    @property
    def windows(self) -> list[int]:
        """Returns the lengths of the windows in intervals; a rest that fills none comes first."""
        count, rest = divmod(self.total, self.window)
        windows = [self.window] * count
        return [rest, *windows] if rest else windows


class TimeRun:
    """A dynamic run of a scene.

    progress: receives lines on the run.
    tolerance, grid: of a step, and the instants; by default those of the scene.
    longest: longest step, over the usual one of a twentieth of a turn.
    """

    def __init__(
        self,
        scene: Scene,
        system: DynamicSystem,
        progress: Callable[[str], None] | None,
        tolerance: float | None = None,
        grid: RunGrid | None = None,
        longest: float = 1.0,
    ):
        model = scene.model
        layout = system.layout
        n = len(system.bearing.D)
        self.system = system
        self.grid = grid = grid or RunGrid.of(scene, system.time, system.turn)
        self.tolerance = tolerance or model.dynamic_tolerance
        self.control = system.control(
            self.tolerance, INTEGRATORS[model.integrator], longest * system.turn / STEPS_PER_TURN
        )
        self.keeps_history = model.history_points_per_turn > 0
        integrals = layout.size - layout.qv
        self.recorder = record.Recorder(
            sums=record.empty_sums(
                n, system.bearing.rule, strip_centres(scene.model.strips), integrals
            ),
            # without histories one turn is recorded, for the range of the loads
            history=record.empty_history(grid.total if self.keeps_history else grid.points, n),
            keep=True,
        )
        self.loads = LoadRange(n)
        self.room = 1.0  # of the cage, see `Trend`, over the stretch simulated last
        self.weights = wear_weights(scene, system)
        self.tally = np.zeros(4, dtype=int)  # steps accepted, rejected, evaluations, events
        self.done = 0
        self.trend = Trend(grid.turns)
        self.before_last_turn: tuple[np.ndarray, float] = (np.empty(0), system.time)
        self.advance(0)  # compiles before the clock of the progress starts
        self.report = _Progress(progress, grid.total / grid.points * grid.turns, system.turn)

    @property
    def turns(self) -> float:
        """Returns the shaft turns simulated."""
        return self.done / self.grid.points * self.grid.turns

    def advance(self, count: int) -> int:
        """Simulates and records a number of intervals; returns OK or the status of a failure.

        Time, step and `tally` go on in any case; `done`, `loads` and `room` only if all succeed.
        Without histories, `count` is at most that of a turn.
        """
        system, grid, first = self.system, self.grid, self.done
        time_grid = record.TimeGrid(origin=grid.origin, dt=grid.dt, first=grid.first)
        if not self.keeps_history:
            assert count <= grid.points
            time_grid = time_grid._replace(first=time_grid.first + first)
            first = 0
        tally = record.advance_and_record(
            self.control,
            time_grid,
            first,
            count,
            system.h,
            system.y,
            system.bearing,
            system.buffers,
            system.stages,
            self.recorder,
        )
        system.time, system.h = tally.time, tally.h
        self.tally += (tally.accepted, tally.rejected, tally.evaluations, tally.events)
        if tally.status == code.OK:
            self.done += count
            if count:
                self.loads.add(self.recorder.history.load[first : first + count])
                self.room = self.land_room(slice(first, first + count))
        return tally.status

    def land_room(self, stretch: slice) -> float:
        """Returns the mean room of the cage to its land over a stretch, over the clearance [1].

        1 without a cage, a land or a clearance.
        """
        cage = self.system.bearing.cage
        if not cage.present or cage.land == NO_LAND or not cage.gap > 0.0:
            return 1.0
        return 1.0 - float(np.hypot(*self.cage_offset(stretch).T).mean()) / cage.gap

    def cage_offset(self, stretch: slice) -> np.ndarray:
        """Returns positions (n, 2) of the cage's centre from the axis of its guide [m]."""
        history = self.recorder.history
        offset = history.cage[stretch, record.POSITION + 1 : record.POSITION + 3].astype(float)
        if self.system.bearing.cage.land == INNER_LAND:
            offset -= history.displacement[stretch, 1:]
        return offset

    def window(self, length: int) -> int:
        """Simulates a window of a number of intervals, turn by turn; returns a status.

        It is OK, or that of a failure, at which the window ends. Renews `trend`, `loads`, the sums,
        and `opening`; sets `before_last_turn`. Raises KeyboardInterrupt after Ctrl-C.
        """
        integrals = self.system.y[self.system.layout.qv :]
        sums, points = self.recorder.sums, self.grid.points
        record.clear(sums)
        self.loads = LoadRange(len(self.system.bearing.D))
        before_last = self.trend
        self.trend = Trend(self.grid.turns)
        self.opening = self.system.snapshot()
        for first in range(0, length, points):
            count = min(points, length - first)
            if first + points >= length:
                self.before_last_turn = self.system.packed(), self.system.time
            integrals_before, sums_before = integrals.copy(), sums.bearing.copy()
            status = self.advance(count)
            check_interrupt()
            if status != code.OK:
                return status
            if count == points:
                gain = integrals - integrals_before
                sums_gain = sums.bearing - sums_before
                preload, torque = sums_gain[[record.PRELOAD, record.INNER_RACE_TORQUE]]
                self.trend.add(np.array([*self.weights @ gain, preload, torque, self.room]))
            reported_trend = self.trend if self.trend.is_known else before_last
            self.report(self.turns, reported_trend.slopes())
        return code.OK

    def counts(self, evaluated: float) -> dict:
        """Returns numbers of turns and steps as result variables.

        evaluated: turns of the window that was averaged.
        """
        accepted, rejected, evaluations, events = (int(number) for number in self.tally)
        return {
            "simulated_turns": self.turns,
            "evaluated_turns": evaluated,
            "steps_accepted": accepted,
            "steps_rejected": rejected,
            "evaluations": evaluations,
            "contact_events": events,
        }
