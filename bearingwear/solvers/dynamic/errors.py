"""Numerical errors of a dynamic run, estimated by runs with other settings of accuracy."""

import math
from typing import Any, NamedTuple

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.dynamic.outputs import window_values
from bearingwear.solvers.dynamic.periodic import PeriodicMotion, periodic_motion
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.dynamic.windows import INTEGRATORS, RunGrid, TimeRun
from bearingwear.solvers.estimates import (
    DOUBLED,
    QUANTITY_COUNT,
    error_values,
    estimated_quantities,
    regularisation_error,
    relative_change,
)
from bearingwear.solvers.start import Start, thrust_alone
from bearingwear.solvers.steady import steady_quantities
from kerneljit.interrupt import Interrupt

LOOSER = 10.0  # factor on the tolerance of a step that shows its error
TIGHTEST = 1e-4  # least tolerance of a step in such a run
TIGHTER = 100.0  # divisor of the tolerance of a periodic motion
DRIFT = 4.0  # factor on the observed drift, because slower processes hide behind it
_SCATTER = 4.0  # standard errors of a mean; many, as the turns are few and not independent


def dynamic_error_estimates(
    scene: Scene,
    run: TimeRun,
    start: Start,
    slow: float,
    turns: float,
    motion: PeriodicMotion | None,
) -> dict[str, Any]:
    """Returns result variables of the numerical errors of a dynamic run.

    Empty if the drift is not known (`Trend.is_known`), if one of the reruns fails, or if an error
    is infinite, see `error_values`.

    The end of the last window is run again with each setting of accuracy changed. That misses the
    motion of a ball's spin axis, which takes hundreds of turns. So the steady state under the
    thrust alone is solved with that setting too, if there is one, and the larger change counts. A
    periodic motion is found anew with each setting, which misses nothing.

    slow: slow time scale in shaft turns, 0 if it is not known.
    turns: shaft turns of the last window.
    motion: the periodic motion, None if the run was not one.
    """
    slopes = run.trend.slopes()
    if slopes is None:
        return {}
    # A new regularisation disturbs every ball; tight steps through that would take long.
    tolerance = max(run.tolerance, TIGHTEST)
    other_tolerance = min(LOOSER * tolerance, 1.0) if motion is None else tolerance / TIGHTER
    reruns = [
        rerun_quantities(scene, rerun.system, run, rerun.tolerance, motion)
        for rerun in _reruns(scene, run.system, tolerance, other_tolerance)
    ]
    answers = [values for values in reruns if values is not None]
    if len(answers) < len(reruns):
        return {}
    as_run, with_half_slip, with_twice_points, with_other_steps = answers
    slip_error = regularisation_error(as_run, with_half_slip)
    step_error = math.sqrt(run.tolerance / tolerance) * relative_change(as_run, with_other_steps)
    if motion is not None:
        step_error *= DOUBLED
    else:
        slip_error = np.maximum(slip_error, thrust_slip_error(scene, start))
    point_error = DOUBLED * relative_change(as_run, with_twice_points)
    drift = DRIFT * np.abs(slopes) * max(slow, turns) + _SCATTER * run.trend.scatter()
    qv, _, wear, preload, torque = drift  # the values of `Trend`, without the room of the cage
    # in the order of `QUANTITY_COUNT`; friction power drifts as the torque does
    drift_error = np.array([qv, preload, wear, torque, torque])
    return error_values([slip_error, point_error, step_error, drift_error])


class _Rerun(NamedTuple):
    """A run with one setting of accuracy changed."""

    system: DynamicSystem  # with that setting, at no state of its own
    tolerance: float  # of a step


def _reruns(
    scene: Scene, system: DynamicSystem, tolerance: float, other_tolerance: float
) -> list[_Rerun]:
    """Returns four runs: as it was, with half v_r, with twice the points, and with other steps.

    tolerance, other_tolerance: of a step, in the first three and in the last.
    """
    bearing = system.bearing
    v_r = 0.5 * system.bearing.op.v_r
    half_slip = system.variant(op=bearing.op._replace(v_r=v_r), cage=bearing.cage._replace(v_r=v_r))
    twice_points = system.variant(
        rule=parameters.quadrature(scene, refined=2),
        points=parameters.spread_points(scene, refined=2),
    )
    return [
        _Rerun(system.variant(), tolerance),
        _Rerun(half_slip, tolerance),
        _Rerun(twice_points, tolerance),
        _Rerun(system.variant(), other_tolerance),
    ]


def thrust_slip_error(scene: Scene, start: Start) -> np.ndarray:
    """Returns the relative error (5,) by the regularisation in the steady state under thrust alone.

    It is 0 where there is no such state, or none with half the regularisation. The order is that of
    `QUANTITY_COUNT`.

    start: of the run, with the steady state if there is one.
    """
    case = start.case
    if case is None or case.status != code.OK:
        return np.zeros(QUANTITY_COUNT)
    thrust = thrust_alone(scene)
    problem = parameters.where_bare(ThrustProblem.of(thrust), scene, start.bare)
    D = float(parameters.ball_diameters(scene).mean())
    halved, _ = problem.perturbed(thrust)
    half_case = halved.solve(D, start=case.motion)
    if half_case.status != code.OK:
        return np.zeros(QUANTITY_COUNT)
    reference, with_half = steady_quantities(thrust, problem, D, [case, half_case])
    return regularisation_error(reference, with_half)


def rerun_quantities(
    scene: Scene,
    system: DynamicSystem,
    run: TimeRun,
    tolerance: float,
    motion: PeriodicMotion | None,
) -> np.ndarray | None:
    """Returns the `estimated_quantities` over a short stretch of another run; None if it fails.

    system: with another setting of accuracy; it is put at the end of `run`.
    tolerance: of a step.
    motion: periodic motion to start from, found anew; None for a run from its last turn.
    """
    state, time = run.before_last_turn
    grid = run.grid
    if motion is None:
        system.unpack(state, time)
    else:
        system.unpack(state, motion.time)
        system.balls[:] = motion.balls
        new_motion = move_to_periodic(scene, system, tolerance, motion)
        if new_motion is None:
            return None
        grid = RunGrid.of_orbit(scene, new_motion, system.turn)
    short_grid = grid.short(scene, system.time, system.turn)
    with Interrupt():
        short_run = TimeRun(scene, system, None, tolerance, short_grid)
        if short_run.window(short_grid.total) != code.OK:
            return None
    return estimated_quantities(window_values(scene, short_run), scene.bearing.ball_count)


def move_to_periodic(
    scene: Scene,
    system: DynamicSystem,
    tolerance: float,
    near: PeriodicMotion | None = None,
) -> PeriodicMotion | None:
    """Moves a system to the periodic motion near its state, and returns that; None without one.

    Only the balls move; time, step and all other states are those of the start. A system without
    such a motion stays as it is.

    near: motion of much the same system, at which the balls already are.
    """
    start_state = system.packed(), system.time
    motion = periodic_motion(system, tolerance, INTEGRATORS[scene.model.integrator], near)
    system.unpack(*start_state)
    if motion is not None:
        system.balls[:] = motion.balls
    return motion
