"""Solve a scene in time: start, run until settled, averages, histories, checks."""

import math
import time as clock
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.integrators import ROSENBROCK, RUNGE_KUTTA
from bearingwear.kernels.record import (
    AXIAL,
    CAGE_SPEED,
    CENTRIFUGAL,
    DRAG_POWER,
    INNER_RACE_TORQUE,
    POSITION,
    PRELOAD,
    RADIUS,
    SHIFT,
    SPEED,
    STIFFNESS,
    TILT,
    History,
    clear,
    history,
    record,
    run_on,
)
from bearingwear.kernels.summary import ANGLE, QV
from bearingwear.kernels.thrust import ThrustCase, skid_ratio
from bearingwear.kernels.wear import archard_rate
from bearingwear.model import parameters
from bearingwear.model.dynamic import STEPS_PER_TURN, Motion
from bearingwear.model.estimate import DOUBLED, HALVED, changed, measured, summed
from bearingwear.model.fidelity import NotAvailable
from bearingwear.model.interrupt import Interrupt
from bearingwear.model.race_control import race_control_motion
from bearingwear.model.scene import Scene
from bearingwear.model.steady import ThrustProblem, steady_answer
from bearingwear.model.values import contact_values, strip_centres

INTEGRATORS = {"rosenbrock": ROSENBROCK, "runge_kutta": RUNGE_KUTTA}
LARGEST_RESIDUAL = 1e-6  # of the contact load: what balls and pockets are agreed to, and more
LOOSER = 10.0  # tolerance of a step, to see what it costs
TIGHTEST = 1e-4  # tolerance of a step of such a run
SHORT = 16  # turns of the run for each that is run again
DRIFT = 4.0  # times the drift of one process: slower ones stand behind it
SCATTER = 4.0  # standard errors of a mean: the turns are few and not independent
LARGEST_ACCOUNT = 1e-3  # of the heat: energy that may be missing from a verified run
TIGHTER = 100.0  # tolerance of a step over that of a run whose account does not close
TIGHTEST_RUN = 1e-7  # no run is tightened further from here
MOST_TRIES = 50_000  # steps: longer runs are not repeated
REPORT_EVERY = 3.0  # seconds of wall time between lines of progress


@dataclass
class Start:
    """How every ball moves at first, and what the steady solver knows of the time that takes."""

    u: np.ndarray  # (4,) or (n, 4)
    kind: str
    scales: dict[str, float]  # fast_time_scale, slow_time_scale [s], where known
    case: ThrustCase | None = None  # the steady state under the thrust alone, where there is one


def thrust_alone(scene: Scene) -> Scene:
    """The scene without the loads that keep it from a steady state."""
    operation = replace(
        scene.operation, radial_load_N=(0.0, 0.0), rotating_load_N=0.0, tilt_mrad=0.0
    )
    return replace(scene, operation=operation)


def start_of(scene: Scene) -> Start:
    """The steady state under the thrust alone, else the state of race control."""
    problem = ThrustProblem.of(thrust_alone(scene))
    if problem.undetermined() == code.OK:
        D = float(parameters.ball_diameters(scene).mean())
        case = problem.solve(D)
        if case.status in (code.OK, code.UNVERIFIED):
            eigenvalues = problem.time_scales(D, case)
            scales = {
                "fast_time_scale": 1.0 / np.abs(eigenvalues).max(),
                "slow_time_scale": 1.0 / np.abs(eigenvalues.real).min(),
            }
            return Start(case.u, "the steady state under the thrust alone", scales, case)
    u = race_control_motion(scene)
    if u is not None:
        return Start(u, "race control", {})
    return Start(problem.kinematic_start(0), "race control at the free contact angle", {})


class Trend:
    """Straight lines through what successive turns give, without keeping them.

    QV, wear of all parts, of the balls, of balls and races, preload.
    """

    def __init__(self) -> None:
        self.sums = np.zeros(3)  # 1, k, k^2
        self.values = np.zeros((3, 5))  # (value, k value, value^2) of each

    def add(self, values: np.ndarray) -> None:
        k = self.sums[0]
        self.sums += (1.0, k, k * k)
        self.values += [values, k * values, values * values]

    @property
    def known(self) -> bool:
        """Whether three turns or more say what QV and wear do."""
        return bool(self.sums[0] >= 3 and (self.values[0, :2] > 0.0).all())

    def slopes(self) -> np.ndarray | None:
        """Relative change a turn of each (5,); None if not `known`."""
        n, k, kk = self.sums
        total, weighted, _ = self.values
        if not self.known:
            return None
        mean = np.where(total != 0.0, total / n, 1.0)
        return (n * weighted - k * total) / (n * kk - k * k) / mean

    def scatter(self) -> np.ndarray:
        """Standard error of each mean, relative, were the turns independent (5,)."""
        n = self.sums[0]
        mean, square = self.values[0] / n, self.values[2] / n
        variance = np.maximum(square - mean * mean, 0.0) / max(n - 1.0, 1.0)
        return np.sqrt(variance) / np.where(mean != 0.0, np.abs(mean), 1.0)


def wear_weights(scene: Scene, motion: Motion) -> np.ndarray:
    """What a joule of each time integral of the state counts as (4, m).

    For QV in the contacts of balls and races [1]; for the wear of all parts, of the balls, of
    balls and races [m3/J].
    """
    p, b = motion.places, scene.bearing
    ball, race = (_rate(scene, name) for name in (b.ball_material, b.race_material))
    cage = _rate(scene, scene.cage.material) if scene.cage else 0.0
    weights = np.zeros((4, p.size - p.qv))
    contacts, pockets = slice(0, p.pockets - p.qv), slice(p.pockets - p.qv, p.land - p.qv)
    weights[0, contacts] = 1.0
    weights[1:, contacts] = np.array([[ball + race], [ball], [ball + race]])
    weights[1:, pockets] = np.array([[ball + cage], [ball], [ball]])
    weights[1, p.land - p.qv] = cage
    return weights


def _rate(scene: Scene, material: str) -> float:
    m = scene.materials[material]
    return archard_rate(m.wear_coefficient, m.brinell_hardness_GPa * parameters.GPA, 1.0)


class Progress:
    """Lines of progress, no more often than every few seconds."""

    def __init__(self, say: Callable[[str], None] | None, turns: float, turn: float) -> None:
        self.say, self.turns, self.turn = say, turns, turn
        self.begun = self.last = clock.monotonic()

    def __call__(self, done: float, slopes: np.ndarray | None) -> None:
        now = clock.monotonic()
        if self.say is None or now - self.last < REPORT_EVERY:
            return
        self.last = now
        passed = now - self.begun
        left = passed * (self.turns / done - 1.0)
        drift = "not known yet" if slopes is None else f"{slopes[0]:+.1e} a turn"
        self.say(
            f"{done:.0f} of {self.turns:.0f} turns, {1e3 * done * self.turn:.3g} ms simulated in "
            f"{passed:.0f} s, at most {left:.0f} s left, drift of QV {drift}"
        )


@dataclass(frozen=True)
class Grid:
    """Instants of a run: origin + k dt.

    A run that goes on from another keeps to its grid, so that both take the steps of a single one.
    """

    points: int  # a shaft turn
    dt: float  # [s]
    origin: float  # [s]
    first: int
    total: int  # intervals to simulate
    window: int  # intervals that averages are taken over

    @classmethod
    def of(cls, scene: Scene, time: float, turn: float) -> "Grid":
        points = scene.model.history_points_per_turn or STEPS_PER_TURN
        dt = turn / points
        total = max(1, round(scene.model.simulated_turns * points))
        window = min(total, max(1, round(scene.model.averaged_turns * points)))
        k = round(time / dt)
        on_grid = k * dt == time
        return cls(points, dt, 0.0 if on_grid else time, k if on_grid else 0, total, window)

    @property
    def windows(self) -> list[int]:
        """Lengths of the stretches; what does not fill whole windows comes first."""
        whole, left = divmod(self.total, self.window)
        return [left] * (left > 0) + [self.window] * whole


class Run:
    """A scene on its way through time."""

    def __init__(
        self,
        scene: Scene,
        motion: Motion,
        progress: Callable[[str], None] | None,
        tolerance: float | None = None,
    ):
        model, p, n = scene.model, motion.places, len(motion.run.D)
        self.motion = motion
        self.grid = grid = Grid.of(scene, motion.time, motion.turn)
        self.keep = model.history_points_per_turn > 0
        self.log = history(grid.total if self.keep else 0, n)
        self.record = record(n, motion.run.rule, strip_centres(scene), p.size - p.qv)
        self.method = INTEGRATORS[model.integrator]
        self.tolerance = tolerance or model.dynamic_tolerance
        self.weights = wear_weights(scene, motion)
        self.tally = np.zeros(4, dtype=int)  # steps accepted, rejected, evaluations, events
        self.done = 0
        self.trend = Trend()
        self.snapshot: tuple[np.ndarray, float] = (np.empty(0), motion.time)  # before the last turn
        self.advance(0)  # compiles before the clock of the progress starts
        self.report = Progress(progress, grid.total / grid.points, motion.turn)

    @property
    def turns(self) -> float:
        """Shaft turns simulated."""
        return self.done / self.grid.points

    def advance(self, count: int) -> int:
        """Simulate so many intervals; returns a status."""
        motion, grid = self.motion, self.grid
        result = run_on(
            self.method, grid.origin, grid.dt, grid.first + self.done, count, motion.y, motion.run,
            motion.buffers, motion.places, motion.stages, self.tolerance, motion.h,
            motion.turn / STEPS_PER_TURN, self.record, self.keep, self.done, self.log,
        )  # fmt: skip
        motion.time, motion.h = result.time, result.h
        self.tally += (result.accepted, result.rejected, result.evaluations, result.events)
        if result.status == code.OK:
            self.done += count
        return result.status

    def window(self, length: int, interrupt: Interrupt) -> int:
        """Simulate a window and record it; returns a status."""
        p, y, points = self.motion.places, self.motion.y, self.grid.points
        clear(self.record)
        before_last, self.trend = self.trend, Trend()
        self.opened = self.motion.opened()
        for at in range(0, length, points):
            count = min(points, length - at)
            if at + points >= length:
                self.snapshot = self.motion.packed(), self.motion.time
            before = y[p.qv :].copy()
            preload = self.record.whole[PRELOAD]
            status = self.advance(count)
            interrupt.check()
            if status != code.OK:
                return status
            if count == points:
                gained = y[p.qv :] - before
                pressed = self.record.whole[PRELOAD] - preload
                self.trend.add(np.array([*self.weights @ gained, pressed]))
            shown = self.trend if self.trend.known else before_last
            self.report(self.turns, shown.slopes())
        return code.OK

    def counts(self, evaluated: float) -> dict:
        """Variables that say what the run took."""
        accepted, rejected, evaluations, events = (int(number) for number in self.tally)
        return {
            "simulated_turns": self.turns,
            "evaluated_turns": evaluated,
            "steps_accepted": accepted,
            "steps_rejected": rejected,
            "evaluations": evaluations,
            "contact_events": events,
        }


def solve_dynamic(
    scene: Scene,
    restart: Mapping[str, Any] | None = None,
    progress: Callable[[str], None] | None = None,
) -> tuple[dict, dict]:
    """Values and attributes of a run in time.

    Parameters
    ----------
    scene : Scene
    restart : mapping, optional
        `state` and `time` where another run of the same scene ended (its `final_state`,
        `final_time`).
    progress : callable, optional
        Told in one line every few seconds how far the run has come.

    Returns
    -------
    values, attrs : dict
        Averages over the evaluated window under the names of the steady solution, histories of the
        whole run, checks.
    """
    start, tolerance = start_of(scene), scene.model.dynamic_tolerance
    while True:
        values, attrs = run_of(scene, start, restart, progress, tolerance)
        open_account = not abs(values.get("energy_account_error", 0.0)) <= LARGEST_ACCOUNT
        tries = values.get("steps_accepted", 0) + values.get("steps_rejected", 0)
        if not open_account or tries > MOST_TRIES or tolerance < TIGHTEST_RUN:
            return values, attrs
        # Where friction is next to nothing, or balls part from the inner race, errors that do not
        # matter to the slip do to the heat.
        tolerance /= TIGHTER
        if progress is not None:
            error = values["energy_account_error"]
            progress(f"energy account {error:.1e} of the heat: anew with tolerance {tolerance:g}")


def run_of(
    scene: Scene,
    start: Start,
    restart: Mapping[str, Any] | None,
    progress: Callable[[str], None] | None,
    tolerance: float,
) -> tuple[dict, dict]:
    """One run of `solve_dynamic` with this tolerance of a step."""
    motion = Motion.of(scene, start.u)
    if restart is not None:
        try:
            motion.unpack(np.asarray(restart["state"], dtype=float), float(restart["time"]))
        except ValueError as error:
            with_cage = "without" if scene.cage is None else "with"
            raise NotAvailable(
                f"{scene.name}: restart: given a {error}; allowed one that was solved "
                f"{with_cage} the cage, as this run is"
            ) from None
        start = replace(start, kind=f"the end of a run at {motion.time:.6g} s")
    values: dict = {
        "status": motion.why(motion.settle()),
        "ball_diameter_loss": motion.run.g.D0 - motion.run.D,
        "initial_axial_displacement": motion.buffers.rest[0],
    }
    attrs: dict = {"residual": "not solved", "start": start.kind}
    if values["status"] != code.OK:
        return values, attrs
    slow = start.scales.get("slow_time_scale", 0.0) / motion.turn
    settled = False
    with Interrupt() as interrupt:
        run = Run(scene, motion, progress, tolerance)
        if restart is not None:
            motion.unpack(np.asarray(restart["state"], dtype=float), motion.time)
        for length in run.grid.windows:
            turns = length / run.grid.points
            status = run.window(length, interrupt)
            if status != code.OK:
                stopped = {"status": motion.why(status), "final_time": motion.time}
                attrs["residual"] = f"not solved; the run stopped at {motion.time:.6g} s"
                return values | stopped | run.counts(0.0), attrs
            slopes = run.trend.slopes()
            settled = is_settled(slopes, slow, turns, scene.model.settled_drift)
            if settled and length == run.grid.window:
                break
        # Before anything else looks at the end: it would not change the answer, but its last bits.
        final_state = motion.packed()
    values |= window_values(scene, run) | start.scales | run.counts(turns)
    if slopes is not None:
        values |= {"qv_drift_per_turn": slopes[0], "wear_rate_drift_per_turn": slopes[1]}
    if run.keep:
        values |= histories(scene, run.log, run.done)
    values |= {"final_state": final_state, "final_time": motion.time}
    residual, account = values["equilibrium_residual"], values["energy_account_error"]
    if residual <= LARGEST_RESIDUAL and abs(account) <= LARGEST_ACCOUNT:
        values |= error_estimates(scene, run, start, slow, turns)
    else:
        values["status"] = motion.why(code.UNVERIFIED)
    asked = scene.model.dynamic_tolerance
    tightened = "" if tolerance == asked else f": the energy account did not close with {asked:g}"
    attrs |= {
        "residual": (
            f"normal balance {residual:.1e} of the contact load, allowed {LARGEST_RESIDUAL:.0e}; "
            f"energy account {account:.1e} of the heat, allowed {LARGEST_ACCOUNT:.0e}"
        ),
        "settled": settled_sentence(slopes, settled),
        "integrator": f"{scene.model.integrator}, tolerance {run.tolerance:g}{tightened}",
    }
    return values, attrs


def error_estimates(scene: Scene, run: Run, start: Start, slow: float, turns: float) -> dict:
    """Estimated numerical errors of a run in time; empty where they cannot be had.

    The end of the last window is run once more with each setting of accuracy changed. That misses
    what a ball's spin axis takes hundreds of turns for, so the steady state under the thrust alone
    is asked as well where there is one, and the larger change counts.
    """
    slopes = run.trend.slopes()
    if slopes is None:
        return {}
    motion, m = run.motion, run.motion.run
    v_r = 0.5 * m.motion.v_r
    halved = {"motion": m.motion._replace(v_r=v_r), "cage": m.cage._replace(v_r=v_r)}
    twice = {"rule": parameters.quadrature(scene, refined=2)}
    # A change of the regularisation upsets every ball: tight steps through that would take long.
    tolerance = max(run.tolerance, TIGHTEST)
    looser = min(LOOSER * tolerance, 1.0)
    found = [
        rerun(scene, motion.variant(**changes), run.snapshot, run.grid, tolerance)
        for changes, tolerance in (
            ({}, tolerance), (halved, tolerance), (twice, tolerance), ({}, looser),
        )
    ]  # fmt: skip
    answers = [values for values in found if values is not None]
    if len(answers) < len(found):
        return {}
    now, *others = answers
    weights = HALVED, DOUBLED, math.sqrt(run.tolerance / tolerance)
    parts = [weight * changed(now, other) for weight, other in zip(weights, others, strict=True)]
    parts[0] = np.maximum(parts[0], thrust_part(scene, start.case))
    drift = DRIFT * np.abs(slopes) * max(slow, turns) + SCATTER * run.trend.scatter()
    qv, _, balls, both, preload = drift
    return summed([*parts, np.array([qv, preload, balls, both])])


def thrust_part(scene: Scene, case: ThrustCase | None) -> np.ndarray:
    """What half the regularisation changes in the steady state under the thrust alone (4,)."""
    if case is None or case.status != code.OK:
        return np.zeros(4)
    thrust = thrust_alone(scene)
    problem, D = ThrustProblem.of(thrust), float(parameters.ball_diameters(scene).mean())
    halved, _ = problem.perturbed(thrust)
    other = halved.solve(D, start=case.u)
    if other.status != code.OK:
        return np.zeros(4)
    answers = (steady_answer(thrust, p, D, c) for p, c in ((problem, case), (halved, other)))
    return HALVED * changed(*answers)


def rerun(
    scene: Scene, motion: Motion, snapshot: tuple[np.ndarray, float], grid: Grid, tolerance: float
) -> np.ndarray | None:
    """What `measured` finds over half a turn, or less of a short run; None if it fails."""
    count = max(1, min(grid.points // 2, grid.total // SHORT))
    model = replace(scene.model, simulated_turns=count / grid.points, evaluated_turns=None)
    motion.unpack(*snapshot)
    with Interrupt() as interrupt:
        run = Run(replace(scene, model=model), motion, None, tolerance)
        if run.window(count, interrupt) != code.OK:
            return None
    return measured(window_values(scene, run))


def is_settled(slopes: np.ndarray | None, slow: float, turns: float, allowed: float) -> bool:
    """Whether what is left of the drift, over the slow time scale, no longer matters.

    Parameters
    ----------
    slow, turns : float
        Slow time scale and length of the window in shaft turns.
    allowed : float
        Largest change still to come, relative.
    """
    return slopes is not None and bool(np.abs(slopes[:2]).max() * max(slow, turns) <= allowed)


def settled_sentence(slopes: np.ndarray | None, settled: bool) -> str:
    """How settled the averages are, in words."""
    if slopes is None:
        return "not known: fewer than three whole turns were evaluated"
    verdict = "settled" if settled else "not settled; the turns were used up"
    return f"{verdict}: QV drifts {slopes[0]:+.1e}, wear {slopes[1]:+.1e} a turn"


def window_values(scene: Scene, whole_run: Run) -> dict:
    """Averages and accounts between the opening of the last window and now."""
    motion, out = whole_run.motion, whole_run.record
    p, run, n = motion.places, motion.run, len(motion.run.D)
    now, then = motion.opened(), whole_run.opened
    time, integrals, momentum = now[0] - then[0], now[1] - then[1], now[3] - then[3]
    energy = {key: value - then[2][key] for key, value in now[2].items()}
    count = out.count[0]
    ball, whole, rows = out.ball / count, out.whole / count, out.rows / count
    rows[:, :, QV] = integrals[: 2 * n].reshape(n, 2) / time
    values = contact_values(
        scene, run.g, run.motion, run.D, np.ascontiguousarray(ball[:, :4]), ball[:, RADIUS], rows,
        ball[:, AXIAL],
    )  # fmt: skip
    values |= {
        "gyroscopic_slip": out.slip[0] / count,
        "rolling_slip": out.slip[1] / count,
        "axial_displacement": whole[SHIFT],
        "residual_preload": whole[PRELOAD],
        "shaft_torque": whole[INNER_RACE_TORQUE],
        "drag_power": whole[DRAG_POWER],
        "axial_stiffness": whole[STIFFNESS],
        "centrifugal_force": ball[:, CENTRIFUGAL],
        "equilibrium_residual": out.residual[0],
        "skid_ratio": np.mean(
            [
                skid_ratio(run.motion, *rows[j, :, ANGLE], 0.5 * run.D[j], *ball[j, [RADIUS]], u)
                for j, u in enumerate(np.ascontiguousarray(ball[:, :4]))
            ]
        ),
    }
    supplied = energy.pop("supplied")
    lost = sum(energy[key] for key in ("heat", "cage heat", "damping")) + abs(energy["drag"])
    # Where nothing rubs there is no heat to compare with: what rounding makes of the motion's own.
    scale = max(lost, 1e-6 * motion.energy()["kinetic"])
    values |= {
        "energy_account_error": (supplied - sum(energy.values())) / scale,
        "coriolis_energy_share": energy["coriolis"] / scale,
        "azimuth_energy_share": energy["azimuth"] / scale,
    }
    if scene.cage is None:
        return values
    offset = p.qv
    pockets = integrals[p.pockets - offset : p.land - offset] / time
    rate, ball_rate = (_rate(scene, m) for m in (scene.cage.material, scene.bearing.ball_material))
    values["ball_wear_rate"] = values["ball_wear_rate"] + ball_rate * pockets
    values["ball_diameter_loss_rate"] = values["ball_diameter_loss_rate"] + np.mean(
        2.0 * ball_rate * pockets / (math.pi * run.D**2)
    )
    return values | {
        "cage_wear_rate": rate * pockets.sum(),
        "pocket_wear_rate": rate * pockets,
        "cage_land_wear_rate": rate * integrals[p.land - offset] / time,
        "cage_friction_heat": integrals[p.cage_heat - offset] / time,
        "cage_speed": whole[CAGE_SPEED],
        "mean_pocket_torque": integrals[p.pocket_torque - offset] / time,
        "mean_land_torque": integrals[p.land_torque - offset] / time,
        "cage_momentum_rate": momentum / time,
    }


def histories(scene: Scene, log: History, length: int) -> dict:
    """Variables of the instants kept, the first `length` of them."""
    log = History(*(column[:length] for column in log))
    b = scene.bearing
    ball, race = (_rate(scene, name) for name in (b.ball_material, b.race_material))
    values = {
        "time": log.time,
        "history_contact_load": log.load,
        "history_slip": log.slip,
        "history_contact_qv": log.qv,
        "history_orbit_lead": log.lead,
        "history_residual_preload": log.preload,
        "history_race_displacement": log.displacement,
        "history_ball_wear_rate": ball * (log.qv.sum(axis=2) + log.pocket_power),
        "history_race_wear_rate": race * log.qv.sum(axis=1),
    }
    if scene.cage is None:
        return values
    cage = _rate(scene, scene.cage.material)
    return values | {
        "history_cage_position": log.cage[:, POSITION : POSITION + 3],
        "history_cage_tilt": log.cage[:, TILT : TILT + 3],
        "history_cage_speed": log.cage[:, SPEED],
        "history_pocket_force": log.force[:, :-2],
        "history_land_force": log.force[:, -2:],
        "history_cage_pocket_wear_rate": cage * log.pocket_power.sum(axis=1),
        "history_cage_land_wear_rate": cage * log.land_power,
    }
