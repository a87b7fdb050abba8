"""Numerical errors of a dynamic run, estimated by runs with other settings of accuracy."""

import math
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.dynamic.outputs import window_values
from bearingwear.solvers.dynamic.periodic import PeriodicMotion, periodic_motion
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.dynamic.windows import INTEGRATORS, RunGrid, TimeRun
from bearingwear.solvers.estimates import DOUBLED, MEASURED, changed, halved_part, measured, summed
from bearingwear.solvers.start import Start, thrust_alone
from bearingwear.solvers.steady import steady_answers
from kerneljit.interrupt import Interrupt

LOOSER = 10.0  # times the tolerance of a step, to see its error
TIGHTEST = 1e-4  # tolerance of a step: no looser in such a run
TIGHTER = 100.0  # times as tight, of a periodic motion
DRIFT = 4.0  # times the observed drift, because slower processes hide behind it
_SCATTER = 4.0  # standard errors of a mean; many, as the turns are few and not independent


def dynamic_error_estimates(
    scene: Scene,
    run: TimeRun,
    start: Start,
    slow: float,
    turns: float,
    motion: PeriodicMotion | None,
) -> dict[str, Any]:
    """Estimated numerical errors of a dynamic run; empty where none can be found.

    The end of the last window is run again with each setting of accuracy changed. That misses what
    a ball's spin axis takes hundreds of turns to do. So the steady state under the thrust alone is
    solved with that setting as well, if there is one, and the larger change counts. A periodic
    motion is found anew with each setting, which misses nothing.
    """
    slopes = run.trend.slopes()
    if slopes is None:
        return {}
    system, bearing = run.system, run.system.bearing
    v_r = 0.5 * bearing.op.v_r
    halved = {
        "op": bearing.op._replace(v_r=v_r),
        "cage": bearing.cage._replace(v_r=v_r),
    }
    twice = {
        "rule": parameters.quadrature(scene, refined=2),
        "points": parameters.spread_points(scene, refined=2),
    }
    # A new regularisation disturbs every ball; tight steps through that would take long.
    tolerance = max(run.tolerance, TIGHTEST)
    other = min(LOOSER * tolerance, 1.0) if motion is None else tolerance / TIGHTER
    settings: tuple[tuple[dict, float], ...] = (
        ({}, tolerance),
        (halved, tolerance),
        (twice, tolerance),
        ({}, other),
    )
    found = [
        rerun(scene, system.variant(**changes), run, tolerance, motion)
        for changes, tolerance in settings
    ]
    answers = [values for values in found if values is not None]
    if len(answers) < len(found):
        return {}
    now, with_half, with_twice, with_other = answers
    by_half = halved_part(now, with_half)
    by_steps = math.sqrt(run.tolerance / tolerance) * changed(now, with_other)
    if motion is not None:
        by_steps *= DOUBLED
    else:
        by_half = np.maximum(by_half, thrust_part(scene, start))
    parts = [
        by_half,
        DOUBLED * changed(now, with_twice),
        by_steps,
    ]
    drift = DRIFT * np.abs(slopes) * max(slow, turns) + _SCATTER * run.trend.scatter()
    qv, _, wear, preload, torque = drift
    return summed([*parts, np.array([qv, preload, wear, torque, torque])])


def thrust_part(scene: Scene, start: Start) -> np.ndarray:
    """Change of the steady state under the thrust alone by half the regularisation (5,)."""
    case = start.case
    if case is None or case.status != code.OK:
        return np.zeros(MEASURED)
    thrust = thrust_alone(scene)
    problem = parameters.where_bare(ThrustProblem.of(thrust), scene, start.bare)
    D = float(parameters.ball_diameters(scene).mean())
    halved, _ = problem.perturbed(thrust)
    other = halved.solve(D, start=case.motion)
    if other.status != code.OK:
        return np.zeros(MEASURED)
    return halved_part(*steady_answers(thrust, problem, D, [case, other]))


def rerun(
    scene: Scene,
    system: DynamicSystem,
    run: TimeRun,
    tolerance: float,
    motion: PeriodicMotion | None,
) -> np.ndarray | None:
    """What `measured` finds over a short stretch, see `RunGrid.short`; None if it fails."""
    state, time = run.before_last_turn
    grid = run.grid
    if motion is None:
        system.unpack(state, time)
    else:
        system.unpack(state, motion.time)
        system.balls[:] = motion.balls
        again = found_periodic(scene, system, tolerance, motion)
        if again is None:
            return None
        grid = RunGrid.of_orbit(scene, again, system.turn)
    short = grid.short(scene, system.time, system.turn)
    with Interrupt():
        shorter = TimeRun(scene, system, None, tolerance, short)
        if shorter.window(short.total) != code.OK:
            return None
    return measured(window_values(scene, shorter), scene.bearing.ball_count)


def found_periodic(
    scene: Scene,
    system: DynamicSystem,
    tolerance: float,
    near: PeriodicMotion | None = None,
) -> PeriodicMotion | None:
    """The periodic motion near a system's state; the system moves to it, if there is one."""
    begun, method = (system.packed(), system.time), INTEGRATORS[scene.model.integrator]
    motion = periodic_motion(system, tolerance, method, near)
    system.unpack(*begun)
    if motion is not None:
        system.balls[:] = motion.balls
    return motion
