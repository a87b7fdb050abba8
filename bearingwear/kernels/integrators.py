"""Two integrators of the balls' motion (theory.md section 9).

`ROSENBROCK`: ROS34PW2 of Rang and Angermann, BIT 45 (2005) 761: four stages, order 3 with *any*
matrix in place of the Jacobian (a W-method), L-stable and stiffly accurate with the exact one,
embedded order 2. The matrix here is one 4 x 4 block a ball with the loads held.

`RUNGE_KUTTA`: Fehlberg's 4(5) pair, NASA TR R-315 (1969); the fourth-order result is carried on, as
in the paper that the model follows.
"""

from typing import NamedTuple

import numpy as np

from bearingwear.kernels.block_system import (
    BlockSystem,
    add_cage_powers,
    block_system,
    factorise,
    solve_factorised,
)
from bearingwear.kernels.compile import jit
from bearingwear.kernels.dynamic_equilibrium import places_size
from bearingwear.kernels.jacobian import add_ball_powers, ball_blocks
from bearingwear.kernels.linear import copy
from bearingwear.kernels.rates import state_rates
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
    """Buffers of a step."""

    U: np.ndarray  # (6, size)
    rates: np.ndarray  # (size,) where the step begins, then of the stage at hand
    trial: np.ndarray  # (size,)
    new: np.ndarray  # (size,) result of the step
    error: np.ndarray  # (size,) and its estimated error
    before: np.ndarray  # (3 n + 2,) see step_control.interferences, at both ends of a step
    after: np.ndarray  # (3 n + 2,)
    kept: np.ndarray  # (places_size(n),) see dynamic_equilibrium.keep_places
    hertz: np.ndarray  # (n, 2, 2) see step_control.hertz_factor_work
    system: BlockSystem


@jit
def stages(n, size):
    """Buffers for n balls and states of `size` numbers in all."""
    return Stages(
        U=np.zeros((6, size)),
        rates=np.zeros(size),
        trial=np.zeros(size),
        new=np.zeros(size),
        error=np.zeros(size),
        before=np.zeros(3 * n + 2),
        after=np.zeros(3 * n + 2),
        kept=np.zeros(places_size(n)),
        hertz=np.zeros((n, 2, 2)),
        system=block_system(n),
    )


@jit
def rosenbrock_step(method, time, h, y, bearing, buf, stage):
    """One step of a W-method, see `take_step`."""
    size, qv = y.size, bearing.layout.qv
    ball_blocks(y, bearing, buf)
    shift = 1.0 / (h * method.gamma)
    if not factorise(shift, y, bearing, buf, stage.system):
        return NOT_CONVERGED
    for i in range(method.stages):
        U = stage.U[i]
        if i > 0:
            for k in range(size):
                value = y[k]
                for j in range(i):
                    value += method.A[i, j] * stage.U[j, k]
                stage.trial[k] = value
            now = time + method.time[i] * h
            status = state_rates(now, stage.trial, bearing, buf, stage.rates)
            if status != OK:
                return status
        for k in range(size):
            value = stage.rates[k]
            for j in range(i):
                value += method.C[i, j] / h * stage.U[j, k]
            stage.trial[k] = value
        solve_factorised(stage.trial, U, bearing, stage.system)
        add_ball_powers(U, stage.trial, bearing, buf)
        add_cage_powers(U, stage.trial, y, bearing, buf, stage.system)
        for k in range(qv, size):
            U[k] = stage.trial[k] / shift
    for k in range(size):
        value = error = 0.0
        for j in range(method.stages):
            value += method.weights[j] * stage.U[j, k]
            error += method.error[j] * stage.U[j, k]
        stage.new[k] = y[k] + value
        stage.error[k] = error
    return OK


@jit
def runge_kutta_step(method, time, h, y, bearing, buf, stage):
    """One step of an explicit method, see `take_step`."""
    size = y.size
    copy(stage.rates, stage.U[0])
    for i in range(1, method.stages):
        for k in range(size):
            value = y[k]
            for j in range(i):
                value += h * method.A[i, j] * stage.U[j, k]
            stage.trial[k] = value
        now = time + method.time[i] * h
        status = state_rates(now, stage.trial, bearing, buf, stage.U[i])
        if status != OK:
            return status
    for k in range(size):
        value = error = 0.0
        for j in range(method.stages):
            value += method.weights[j] * stage.U[j, k]
            error += method.error[j] * stage.U[j, k]
        stage.new[k] = y[k] + h * value
        stage.error[k] = h * error
    return OK


@jit
def take_step(method, time, h, y, bearing, buf, stage):
    """One step of length h from y; fills `stage.new` and `stage.error`. Returns a status.

    `stage.rates` and `buf` come from `state_rates` at (time, y).
    """
    if method.implicit:
        return rosenbrock_step(method, time, h, y, bearing, buf, stage)
    return runge_kutta_step(method, time, h, y, bearing, buf, stage)
