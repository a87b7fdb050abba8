"""Two integrators of the balls' motion (theory.md section 9).

`ROSENBROCK`: ROS34PW2 of Rang and Angermann, BIT 45 (2005) 761: four stages, order 3 with *any*
matrix in place of the Jacobian (a W-method), L-stable and stiffly accurate with the exact one,
embedded order 2. These hold as well for the index-1 system M y' = f(y, z), 0 = g(y, z), where z
are the ball centres and the race, found in the same stages: no equilibrium is solved in a step.
The derivatives of g must be exact for that; those of f need not be.

`RUNGE_KUTTA`: Fehlberg's 4(5) pair, NASA TR R-315 (1969); the fourth-order result is carried on, as
in the paper that the model follows.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.decorators import jit
from bearingwear.kernels.dynamic.block_solve import (
    add_ball_powers,
    add_cage_powers,
    solve_factorised,
)
from bearingwear.kernels.dynamic.block_system import BlockSystem, block_system, factorise, linearise
from bearingwear.kernels.dynamic.equilibrium import keep_places, places_size
from bearingwear.kernels.dynamic.rates import rates_here, state_rates
from bearingwear.kernels.linear import accumulate, copy
from bearingwear.kernels.status import NOT_CONVERGED, OK


class Tableau(NamedTuple):
    """A one-step method of s stages."""

    order: float  # of the error estimate that a step is chosen by
    stages: int  # evaluations a step
    implicit: bool  # linearly: `rosenbrock_step`; else `runge_kutta_step`
    A: np.ndarray  # (s, s) weights of earlier stages in the state of a stage
    C: np.ndarray  # (s, s) and in its right-hand side, over the step; implicit only
    gamma: float  # the matrix stands for 1/(gamma h) - J; implicit only
    weights: np.ndarray  # (s,) of the stages in the result
    error: np.ndarray  # (s,) and in its difference from the embedded one
    time: np.ndarray  # (s,) of the stages, over the step
    slope_time: np.ndarray  # (s,) weights of the derivatives by time, over the step; implicit only
    powers: np.ndarray  # (s,) of the stages' powers in the integrals
    power_error: np.ndarray  # (s,) and in their difference from the embedded ones


def rosenbrock_tableau(A, gamma, weights, embedded):
    """Tableau of a W-method whose stages are kept as u_i = sum gamma_ij k_j.

    That saves the products with the matrix.
    """
    inverse = np.linalg.inv(gamma)
    return Tableau(
        order=3.0,
        stages=len(weights),
        implicit=True,
        A=A @ inverse,
        C=np.diag(1.0 / np.diag(gamma)) - inverse,
        gamma=float(gamma[0, 0]),
        weights=weights @ inverse,
        error=(weights - embedded) @ inverse,
        time=A.sum(axis=1),
        slope_time=gamma.sum(axis=1),
        powers=weights,
        power_error=weights - embedded,
    )


def runge_kutta_tableau(A, weights, embedded, time):
    """Tableau of an explicit method."""
    return Tableau(
        order=5.0,
        stages=len(weights),
        implicit=False,
        A=A,
        C=np.zeros_like(A),
        gamma=0.0,
        weights=weights,
        error=weights - embedded,
        time=time,
        slope_time=np.zeros_like(time),
        powers=weights,
        power_error=weights - embedded,
    )


ROSENBROCK = rosenbrock_tableau(
    A=np.array(
        [
            [0.0, 0.0, 0.0, 0.0],
            [0.87173304301691801, 0.0, 0.0, 0.0],
            [0.84457060015369423, -0.11299064236484185, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
        ]
    ),
    gamma=np.array(
        [
            [0.43586652150845900, 0.0, 0.0, 0.0],
            [-0.87173304301691801, 0.43586652150845900, 0.0, 0.0],
            [-0.90338057013044082, 0.054180672388095326, 0.43586652150845900, 0.0],
            [0.24212380706095346, -1.2232505839045147, 0.54526025533510214, 0.43586652150845900],
        ]
    ),
    weights=np.array(
        [0.24212380706095346, -1.2232505839045147, 1.5452602553351020, 0.43586652150845900]
    ),
    embedded=np.array([0.37810903145819369, -0.096042292212423178, 0.5, 0.21793326075422950]),
)
RUNGE_KUTTA = runge_kutta_tableau(
    A=np.array(
        [
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [1 / 4, 0.0, 0.0, 0.0, 0.0, 0.0],
            [3 / 32, 9 / 32, 0.0, 0.0, 0.0, 0.0],
            [1932 / 2197, -7200 / 2197, 7296 / 2197, 0.0, 0.0, 0.0],
            [439 / 216, -8.0, 3680 / 513, -845 / 4104, 0.0, 0.0],
            [-8 / 27, 2.0, -3544 / 2565, 1859 / 4104, -11 / 40, 0.0],
        ]
    ),
    weights=np.array([25 / 216, 0.0, 1408 / 2565, 2197 / 4104, -1 / 5, 0.0]),
    embedded=np.array([16 / 135, 0.0, 6656 / 12825, 28561 / 56430, -9 / 50, 2 / 55]),
    time=np.array([0.0, 1 / 4, 3 / 8, 12 / 13, 1.0, 1 / 2]),
)


class Stages(NamedTuple):
    """Buffers of a step. States are followed by places: ball centres (n, 2), race (3,)."""

    U: np.ndarray  # (6, m) steps of states and places
    rates: np.ndarray  # (6, size) of the stages, where the step begins first
    end_rates: np.ndarray  # (size,) where it ends
    places: np.ndarray  # (2 n + 3,) buffer
    left: np.ndarray  # (2 n + 3,) forces that nothing balances where it begins [N]
    trial: np.ndarray  # (size,)
    side: np.ndarray  # (m,)
    new: np.ndarray  # (size,) result of the step
    error: np.ndarray  # (m,) and its estimated error
    qv_error: np.ndarray  # (2 n,) and that of the integrals of QV
    before: np.ndarray  # (3 n + 2,) see closures.interferences, at both ends of a step
    after: np.ndarray  # (3 n + 2,)
    closing: np.ndarray  # (n + 2,) rates of the first of these over the last step [m/s]
    kept: np.ndarray  # (places_size(n),) see dynamic_equilibrium.keep_places
    work: np.ndarray  # (n, 2, 4) see step_control.work_of_places
    system: BlockSystem


def stages(n, layout):
    """Buffers for n balls and a layout of the state."""
    size, m = layout.size, layout.qv + places_size(n)
    return Stages(
        U=np.zeros((6, m)),
        rates=np.zeros((6, size)),
        end_rates=np.zeros(size),
        places=np.zeros(places_size(n)),
        left=np.zeros(places_size(n)),
        trial=np.zeros(size),
        side=np.zeros(m),
        new=np.zeros(size),
        error=np.zeros(m),
        qv_error=np.zeros(2 * n),
        before=np.zeros(3 * n + 2),
        after=np.zeros(3 * n + 2),
        closing=np.zeros(n + 2),
        kept=np.zeros(places_size(n)),
        work=np.zeros((n, 2, 4)),
        system=block_system(n),
    )


@jit
def keep_left(balls, left):
    """Copy the forces that nothing balances into `left` (2 n + 3,)."""
    n = balls.r.size
    for j in range(n):
        left[2 * j], left[2 * j + 1] = balls.left[j, 0], balls.left[j, 1]
    for k in range(3):
        left[2 * n + k] = balls.race_left[k]


@jit
def set_places(places, balls):
    """Put balls and race at these places (2 n + 3,)."""
    n = balls.r.size
    for j in range(n):
        balls.X[j, 0], balls.X[j, 1] = places[2 * j], places[2 * j + 1]
    for k in range(3):
        balls.delta[k] = places[2 * n + k]


@jit
def move(qv, weights, count, y, bearing, buf, stage, to):
    """Put a state and its places where these weights of the first stages lead."""
    moved, places = to[:qv], stage.places
    moved[:] = 0.0
    copy(stage.kept, places)
    for j in range(count):
        accumulate(weights[j], stage.U[j], moved)
        accumulate(weights[j], stage.U[j, qv:], places)
    for k in range(qv):
        moved[k] += y[k]
    set_places(places, buf.balls)


@jit
def add_load_rate(time, weight, bearing, side):
    """Add the derivative of the load that turns, times a weight, to the race's side (3,)."""
    theta = bearing.op.omega_i * time
    rate = weight * bearing.F_rot * bearing.op.omega_i
    side[1] -= rate * math.cos(theta)
    side[2] -= rate * math.sin(theta)


@jit
def sum_powers(method, h, y, bearing, stage):
    """Integrals at the end of a step from the powers of its stages, and the errors of QV."""
    qv = bearing.layout.qv
    sums = stage.new[qv:]
    sums[:] = 0.0
    stage.qv_error[:] = 0.0
    for j in range(method.stages):
        powers = stage.rates[j, qv:]
        accumulate(method.powers[j], powers, sums)
        accumulate(h * method.power_error[j], powers, stage.qv_error)
    for k in range(sums.size):
        sums[k] = y[qv + k] + h * sums[k]


@jit
def rosenbrock_step(method, time, h, y, bearing, buf, stage):
    """One step of a W-method, see `take_step`."""
    qv, system, balls = bearing.layout.qv, stage.system, buf.balls
    shift, places = 1.0 / (h * method.gamma), stage.left.size
    if not factorise(shift, y, bearing, buf, system):
        return NOT_CONVERGED
    for i in range(method.stages):
        U, side, rates = stage.U[i], stage.side, stage.rates[i]
        if i == 0:
            copy(stage.left, side[qv:])
        else:
            move(qv, method.A[i], i, y, bearing, buf, stage, stage.trial)
            now = time + method.time[i] * h
            status = rates_here(now, stage.trial, bearing, buf, rates, False)
            if status != OK:
                return status
            keep_left(balls, side[qv:])
        add_load_rate(time, method.slope_time[i] * h, bearing, side[qv + places - 3 :])
        for k in range(qv):
            side[k] = rates[k]
        for j in range(i):
            accumulate(method.C[i, j] / h, stage.U[j], side[:qv])
        solve_factorised(shift, side, U, bearing, system)
    move(qv, method.weights, method.stages, y, bearing, buf, stage, stage.new)
    sum_powers(method, h, y, bearing, stage)
    side, error = stage.side, stage.error
    side[:] = 0.0
    error[:] = 0.0
    for j in range(method.stages):
        accumulate(method.error[j], stage.U[j], error)
        accumulate(h * method.powers[j], stage.U[j], side)
    add_ball_powers(side, y, stage.rates[0], bearing, buf, system, stage.new)
    if bearing.cage.present:
        add_cage_powers(side, y, bearing, system, stage.new)
    return OK


@jit
def runge_kutta_step(method, time, h, y, bearing, buf, stage):
    """One step of an explicit method, see `take_step`."""
    qv = bearing.layout.qv
    for i in range(1, method.stages):
        for k in range(qv):
            value = y[k]
            for j in range(i):
                value += h * method.A[i, j] * stage.rates[j, k]
            stage.trial[k] = value
        now = time + method.time[i] * h
        status = state_rates(now, stage.trial, bearing, buf, stage.rates[i], False)
        if status != OK:
            return status
    for k in range(qv):
        value = error = 0.0
        for j in range(method.stages):
            value += method.weights[j] * stage.rates[j, k]
            error += method.error[j] * stage.rates[j, k]
        stage.new[k] = y[k] + h * value
        stage.error[k] = h * error
    sum_powers(method, h, y, bearing, stage)
    return OK


@jit
def take_step(method, time, h, y, bearing, buf, stage):
    """One step of length h from y, where `begin_step` was called; returns a status.

    Fills `stage.new` and `stage.error`, and puts the places of `buf` where the step ends.
    """
    if method.implicit:
        return rosenbrock_step(method, time, h, y, bearing, buf, stage)
    return runge_kutta_step(method, time, h, y, bearing, buf, stage)


@jit
def begin_step(method, y, bearing, buf, stage):
    """Keep what steps from here need: `rates_here` has filled `stage.rates[0]` and `buf`."""
    keep_places(buf.balls, stage.kept)
    if method.implicit:
        keep_left(buf.balls, stage.left)
        linearise(y, bearing, buf, stage.system)
