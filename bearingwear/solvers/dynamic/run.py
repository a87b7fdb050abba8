"""Solves a scene by the dynamic model: start, run until settled, averages, histories, checks."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.kernels.dynamic.integrators import ROSENBROCK
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.films import COVERED, Bare
from bearingwear.solvers.dynamic.errors import TIGHTER, dynamic_error_estimates, move_to_periodic
from bearingwear.solvers.dynamic.outputs import histories, window_values
from bearingwear.solvers.dynamic.periodic import PeriodicMotion
from bearingwear.solvers.dynamic.stability import LEAST_GROWTH, seeks_periodic
from bearingwear.solvers.dynamic.system import STEPS_PER_TURN, DynamicSystem
from bearingwear.solvers.dynamic.windows import FAR_FROM_LAND, RunGrid, TimeRun
from bearingwear.solvers.start import Start, start_of
from kerneljit.interrupt import Interrupt

LARGEST_UNBALANCED = 1e-6  # of the contact load; the solver leaves less
LARGEST_ACCOUNT = 1e-3  # of the heat: error of the energy balance of a verified run
TIGHTEST_RUN = 1e-9  # tolerance below which no run is repeated
MOSTLY_LONGEST = 4.0  # times the fewest steps: with fewer, the longest step is shortened as well
MOST_TRIES = 50_000  # steps of a run that may be repeated
DRIFTS = "qv_drift_per_turn", "wear_rate_drift_per_turn"


def solve_dynamic(
    scene: Scene,
    restart: Mapping[str, Any] | None = None,
    progress: Callable[[str], None] | None = None,
    bare: Bare = COVERED,
) -> tuple[dict, dict]:
    """Returns values and attributes of a dynamic run, some of its contacts without film.

    They are averages over the evaluated window with the names of the steady solution, histories of
    the whole run, and checks. A run whose energy balance does not close is repeated with a tighter
    tolerance, down to `TIGHTEST_RUN`, if it has few enough steps. A run that fails has its status
    and few other values, see `dynamic_run`.

    restart: `state` and `time` where another run of the scene ended (its `final_state`,
        `final_time`). NotAvailable if that was a system with other parts.
    progress: receives lines on the run, and on each repetition.
    """
    start = start_of(scene, bare)
    tolerance = scene.model.dynamic_tolerance
    longest = 1.0  # step, over the usual longest one
    while True:
        values, attrs = dynamic_run(scene, start, restart, progress, tolerance, longest)
        is_open = not abs(values.get("energy_account_error", 0.0)) <= LARGEST_ACCOUNT
        steps = values.get("steps_accepted", 0) + values.get("steps_rejected", 0)
        if not is_open or steps > MOST_TRIES or tolerance < TIGHTEST_RUN:
            return values, attrs
        # With hardly any friction, or balls off the inner race, errors that hardly change the slip
        # change the heat, or the work that goes to and fro and is far larger.
        tolerance /= TIGHTER
        if steps * longest < MOSTLY_LONGEST * STEPS_PER_TURN * values["simulated_turns"]:
            longest /= TIGHTER ** (1.0 / ROSENBROCK.order)
        if progress is not None:
            error = values["energy_account_error"]
            progress(
                f"the error in the energy balance is {error:.1e} of the energy dissipated; the run "
                f"is repeated with tolerance {tolerance:g}"
            )


def system_at_start(
    scene: Scene, start: Start, restart: Mapping[str, Any] | None
) -> tuple[DynamicSystem, str]:
    """Returns the system at the start of a run, and a description of this start.

    restart: as in `solve_dynamic`; NotAvailable if it is of a system with other parts.
    """
    system = DynamicSystem.of(scene, start.u, start.bare)
    if restart is None:
        return system, start.kind
    try:
        system.unpack(np.asarray(restart["state"], dtype=float), float(restart["time"]))
    except ValueError as error:
        with_cage = "without" if scene.cage is None else "with"
        raise NotAvailable(
            f"{scene.name}: restart: got a {error}, expected a case solved {with_cage} a cage, "
            "like this run"
        ) from None
    return system, f"the end of a run at {system.time:.6g} s"


@dataclass(frozen=True)
class LastWindow:
    """The window that a run ends with."""

    status: int
    turns: float
    slopes: np.ndarray | None = None  # see `Trend.slopes`
    settled: bool = False
    to_land: float = math.inf  # turns until the cage meets its land, see `Trend.turns_to_land`


def run_until_settled(scene: Scene, run: TimeRun, slow: float) -> LastWindow:
    """Simulates windows until the averages have settled or the turns are used up.

    Returns the last window. Its status is OK in both cases, which `settled` tells apart, and that
    of the failure if a window fails. A first window shorter than the others never ends the run.

    slow: slow time scale in shaft turns, 0 if it is not known.
    """
    for length in run.grid.windows:
        turns = length / run.grid.points * run.grid.turns
        status = run.window(length)
        if status != code.OK:
            return LastWindow(status=status, turns=turns)
        slopes, to_land = run.trend.slopes(), run.trend.turns_to_land()
        # the change that remains, if the drift goes on for the slow time scale
        remaining = math.inf if slopes is None else np.abs(slopes[:2]).max() * max(slow, turns)
        is_settled = bool(remaining <= scene.model.settled_drift) and to_land > FAR_FROM_LAND
        if is_settled and length == run.grid.window:
            break
    return LastWindow(
        status=status, turns=turns, slopes=slopes, settled=is_settled, to_land=to_land
    )


def dynamic_run(
    scene: Scene,
    start: Start,
    restart: Mapping[str, Any] | None,
    progress: Callable[[str], None] | None,
    tolerance: float,
    longest: float,
) -> tuple[dict, dict]:
    """Returns values and attributes of one run of `solve_dynamic`.

    A run may have no equilibrium at its start, or no periodic motion where the scene requires one.
    The values are then status, loss of diameter and initial displacement. A run that stops adds its
    final time and the counts of its steps. One whose checks fail is UNVERIFIED, or has the reason
    as its status, and all values but the error estimates.

    restart: as in `solve_dynamic`.
    tolerance: of a step.
    longest: longest step, see `TimeRun`.
    """
    system, start_words = system_at_start(scene, start, restart)
    values: dict = {
        "status": system.diagnose(system.update()),
        "ball_diameter_loss": system.bearing.g.D0 - system.bearing.D,
        "initial_axial_displacement": system.buffers.rest[0],
    }
    attrs: dict = {"residual": "not solved", "start": start_words}
    if values["status"] != code.OK:
        return values, attrs
    slow = start.scales.get("slow_time_scale", 0.0) / system.turn
    motion = grid = None
    if seeks_periodic(scene):
        motion, attrs["start"] = usable_periodic(scene, system, tolerance, start_words)
        if motion is not None:
            grid = RunGrid.of_orbit(scene, motion, system.turn)
            values |= motion.growth.values if motion.growth else {}
        elif scene.model.dynamic_solution == "periodic":
            attrs["residual"] = "not solved: no periodic motion was found"
            return values | {"status": code.NOT_CONVERGED}, attrs
    start_state = system.packed(), system.time
    with Interrupt():
        run = TimeRun(scene, system, progress, tolerance, grid, longest)
        if restart is not None or motion is not None:
            system.unpack(*start_state)  # compiling has moved it
        last = run_until_settled(scene, run, slow)
        if last.status != code.OK:
            failure = {"status": system.diagnose(last.status), "final_time": system.time}
            attrs["residual"] = f"not solved; the run stopped at {system.time:.6g} s"
            return values | failure | run.counts(0.0), attrs
        # First of all, because every other evaluation of the end changes the last bits.
        final_state = system.packed()
    values |= window_values(scene, run) | start.scales | run.counts(last.turns)
    if last.slopes is not None:
        values |= dict(zip(DRIFTS, last.slopes, strict=False))  # the first two of `Trend.slopes`
    if run.keeps_history:
        values |= histories(scene, run.recorder.history, run.done)
    values |= {"final_state": final_state, "final_time": system.time}
    residual, energy_error = values["equilibrium_residual"], values["energy_account_error"]
    if residual <= LARGEST_UNBALANCED and abs(energy_error) <= LARGEST_ACCOUNT:
        values |= dynamic_error_estimates(scene, run, start, slow, last.turns, motion)
    else:
        values["status"] = system.diagnose(code.UNVERIFIED)
    attrs |= {
        "residual": _balance_sentence(residual, energy_error),
        "settled": settled_sentence(last) if motion is None else periodic_sentence(motion, last),
        "integrator": integrator_sentence(scene, run, tolerance),
    }
    return values, attrs


def _balance_sentence(residual: float, energy_error: float) -> str:
    """Returns the errors of the two balances that check a run, in words."""
    return (
        f"error in the normal force balance: {residual:.1e} of the contact load (allowed: "
        f"{LARGEST_UNBALANCED:.0e}); error in the energy balance: {energy_error:.1e} of the energy "
        f"dissipated (allowed: {LARGEST_ACCOUNT:.0e})"
    )


def usable_periodic(
    scene: Scene, system: DynamicSystem, tolerance: float, start_words: str
) -> tuple[PeriodicMotion | None, str]:
    """Returns the periodic motion that a run records, or None, and a description of the start.

    The system is moved to that motion, or stays as it is. An unstable motion is not used unless the
    scene requests it.

    start_words: description of the start of the system.
    """
    start_state = system.packed(), system.time
    motion = move_to_periodic(scene, system, tolerance)
    if motion is None:
        return None, start_words
    # instability of the spacing does not count, because a cage keeps it
    is_unstable = motion.growth is not None and motion.growth.slip_and_spin > LEAST_GROWTH
    if is_unstable and scene.model.dynamic_solution == "auto":
        system.unpack(*start_state)
        unused = f"a periodic motion was found but not used, because it is {motion.sentence}"
        return None, f"{start_words}; {unused}"
    return motion, f"a periodic motion, found from {start_words} in {motion.turns:.3g} turns"


def integrator_sentence(scene: Scene, run: TimeRun, tolerance: float) -> str:
    """Returns the tolerance of a run, and why it differs from the one requested, in words."""
    requested = scene.model.dynamic_tolerance
    tightened = (
        "" if tolerance == requested else f": the energy balance did not close with {requested:g}"
    )
    return f"{scene.model.integrator}, tolerance {run.tolerance:g}{tightened}"


def periodic_sentence(motion: PeriodicMotion, last: LastWindow) -> str:
    """Returns how well a periodic motion repeats itself, and whether it is stable, in words."""
    drift = (
        "" if last.slopes is None else f"; the recorded QV drifts by {last.slopes[0]:+.1e} per turn"
    )
    return (
        f"periodic: after {1e3 * motion.passing:.4g} ms, each ball reaches the initial state "
        f"of its neighbour to within {motion.error:.1e} of the maximum speed; "
        f"{motion.sentence}{drift}"
    )


def settled_sentence(last: LastWindow) -> str:
    """Returns whether the averages of a run have settled, in words."""
    if last.slopes is None:
        return "unknown: fewer than three complete turns were evaluated"
    verdict = "settled" if last.settled else "not settled; the turn limit was reached"
    qv, wear = last.slopes[:2]
    sentence = f"{verdict}: QV drifts by {qv:+.1e} and wear by {wear:+.1e} per turn"
    if last.to_land <= FAR_FROM_LAND:
        sentence += (
            f"; the cage drifts towards its land and would reach it in {last.to_land:.0f} turns"
        )
    return sentence
