"""Two integrators of the balls' motion, with one step control (theory.md section 9).

`rosenbrock_step`: ROS34PW2 of Rang and Angermann, BIT 45 (2005) 761: four stages, order 3 with
*any* matrix in place of the Jacobian (a W-method), L-stable and stiffly accurate with the exact
one, embedded order 2. The matrix here is one 4 x 4 block a ball with the loads held.

`runge_kutta_step`: Fehlberg's 4(5) pair, NASA TR R-315 (1969); the fourth-order result is carried
on, as in the paper that the model follows.

An explicit step that is slightly too long does not blow up, since saturated friction only
chatters; it reports a wrong QV without a sign of trouble. The step control therefore measures the
error of slip velocities against the mean slip itself, and the error of QV.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.compile import jit
from bearingwear.kernels.linear import solve_in_place
from bearingwear.kernels.motion import BALL, ball_blocks, balls_motion
from bearingwear.kernels.status import NOT_CONVERGED, OK

ROSENBROCK, RUNGE_KUTTA = 0, 1

_A = np.array(
    [
        [0.0, 0.0, 0.0, 0.0],
        [0.87173304301691801, 0.0, 0.0, 0.0],
        [0.84457060015369423, -0.11299064236484185, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
    ]
)
_GAMMA = np.array(
    [
        [0.43586652150845900, 0.0, 0.0, 0.0],
        [-0.87173304301691801, 0.43586652150845900, 0.0, 0.0],
        [-0.90338057013044082, 0.054180672388095326, 0.43586652150845900, 0.0],
        [0.24212380706095346, -1.2232505839045147, 0.54526025533510214, 0.43586652150845900],
    ]
)
_B = np.array([0.24212380706095346, -1.2232505839045147, 1.5452602553351020, 0.43586652150845900])
_B_LOW = np.array([0.37810903145819369, -0.096042292212423178, 0.5, 0.21793326075422950])

# Stages are kept as u_i = sum gamma_ij k_j, which saves the products with the matrix.
_INVERSE = np.linalg.inv(_GAMMA)
W_GAMMA = float(_GAMMA[0, 0])
W_A = _A @ _INVERSE
W_C = np.diag(1.0 / np.diag(_GAMMA)) - _INVERSE
W_M = _B @ _INVERSE
W_E = (_B - _B_LOW) @ _INVERSE
W_TIME = _A.sum(axis=1)

F_A = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0],
        [1 / 4, 0.0, 0.0, 0.0, 0.0],
        [3 / 32, 9 / 32, 0.0, 0.0, 0.0],
        [1932 / 2197, -7200 / 2197, 7296 / 2197, 0.0, 0.0],
        [439 / 216, -8.0, 3680 / 513, -845 / 4104, 0.0],
        [-8 / 27, 2.0, -3544 / 2565, 1859 / 4104, -11 / 40],
    ]
)
F_B = np.array([25 / 216, 0.0, 1408 / 2565, 2197 / 4104, -1 / 5, 0.0])
F_E = F_B - np.array([16 / 135, 0.0, 6656 / 12825, 28561 / 56430, -9 / 50, 2 / 55])
F_TIME = np.array([0.0, 1 / 4, 3 / 8, 12 / 13, 1.0, 1 / 2])


class Stages(NamedTuple):
    """Buffers of a step."""

    U: np.ndarray  # (6, size)
    f: np.ndarray  # (size,)
    trial: np.ndarray  # (size,)
    new: np.ndarray  # (size,)
    error: np.ndarray  # (size,)
    matrix: np.ndarray  # (4, 4)
    side: np.ndarray  # (4,)


@jit
def stages(size):
    """Buffers for states of so many numbers."""
    return Stages(
        np.zeros((6, size)), np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size),
        np.zeros((4, 4)), np.zeros(4),
    )  # fmt: skip


class Tally(NamedTuple):
    """What an integration took."""

    status: int
    time: float  # reached [s]
    h: float  # next step [s]
    accepted: int
    rejected: int
    evaluations: int


@jit
def rosenbrock_step(time, h, y, run, b, places, w):
    """One W-method step from y; fills `w.new` and `w.error`. Returns a status."""
    n, size = run.D.size, y.size
    status = balls_motion(time, y, run, b, w.f, places)
    if status != OK:
        return status
    ball_blocks(y, run, b)
    shift = 1.0 / (h * W_GAMMA)
    for i in range(4):
        U = w.U[i]
        if i > 0:
            for k in range(size):
                value = y[k]
                for j in range(i):
                    value += W_A[i, j] * w.U[j, k]
                w.trial[k] = value
            status = balls_motion(time + W_TIME[i] * h, w.trial, run, b, w.f, places)
            if status != OK:
                return status
        for k in range(size):
            value = w.f[k]
            for j in range(i):
                value += W_C[i, j] / h * w.U[j, k]
            w.trial[k] = value
        for j in range(n):
            q = BALL * j
            for u in range(4):
                w.side[u] = w.trial[q + u]
                for v in range(4):
                    w.matrix[u, v] = -b.blocks[j, u, v]
                w.matrix[u, u] += shift
            if not solve_in_place(w.matrix, w.side, 4):
                return NOT_CONVERGED
            for u in range(4):
                U[q + u] = w.side[u]
            U[q + 4] = (w.trial[q + 4] + w.side[3]) / shift  # dpsi/dt = Omega
        for j in range(n):
            q = BALL * j
            for v in range(4):
                w.trial[places.shaft] += b.slopes[j, 0, v] * U[q + v]
                w.trial[places.heat] += b.slopes[j, 1, v] * U[q + v]
                w.trial[places.turning] += b.slopes[j, 2, v] * U[q + v]
        for k in range(BALL * n, size):
            U[k] = w.trial[k] / shift
    for k in range(size):
        value = error = 0.0
        for j in range(4):
            value += W_M[j] * w.U[j, k]
            error += W_E[j] * w.U[j, k]
        w.new[k] = y[k] + value
        w.error[k] = error
    return OK


@jit
def runge_kutta_step(time, h, y, run, b, places, w):
    """One Fehlberg 4(5) step from y; fills `w.new` and `w.error`. Returns a status."""
    size = y.size
    for i in range(6):
        for k in range(size):
            value = y[k]
            for j in range(i):
                value += h * F_A[i, j] * w.U[j, k]
            w.trial[k] = value
        status = balls_motion(time + F_TIME[i] * h, w.trial, run, b, w.U[i], places)
        if status != OK:
            return status
    for k in range(size):
        value = error = 0.0
        for j in range(6):
            value += F_B[j] * w.U[j, k]
            error += F_E[j] * w.U[j, k]
        w.new[k] = y[k] + h * value
        w.error[k] = h * error
    return OK


@jit
def step_error(h, y, run, b, places, w, tolerance):
    """Error of a step over what is allowed [1].

    Slip velocities that the errors of a ball's motion amount to, against the mean slip of all
    contacts; and QV.
    """
    n = run.D.size
    load = qv = qv_error = 0.0
    for j in range(n):
        for k in range(2):
            place = places.qv + 2 * j + k
            load += b.s.Q[j, k]
            qv += (w.new[place] - y[place]) / h
            qv_error += abs(w.error[place]) / h
    # At rest there is no slip to compare with; v_r is the smallest that matters.
    slip = max(qv / load, run.motion.v_r) if load > 0.0 else run.motion.v_r
    largest = qv_error / (slip * load) if load > 0.0 else 0.0
    for j in range(n):
        R, r = 0.5 * run.D[j], run.g.R_o + b.s.X[j, 1]
        e = w.error[BALL * j : BALL * j + 4]
        largest = max(
            largest, R * max(abs(e[0]), abs(e[1]), abs(e[2])) / slip, r * abs(e[3]) / slip
        )
    return largest / tolerance


@jit
def advance(method, time, end, y, run, b, places, w, tolerance, h, longest):
    """Integrate from `time` to `end`; y is replaced.

    Parameters
    ----------
    method : int
        ROSENBROCK or RUNGE_KUTTA.
    tolerance : float
        See `step_error`.
    h, longest : float
        First and longest step [s].

    Returns
    -------
    Tally
    """
    accepted = rejected = evaluations = 0
    order = 3.0 if method == ROSENBROCK else 5.0
    cost = 4 if method == ROSENBROCK else 6
    status = OK
    while time < end:
        left = end - time
        whole = min(h, longest)
        # Two equal steps rather than a full and a tiny one.
        step = (
            left
            if whole >= left * (1.0 - 1e-12)
            else min(whole, 0.5 * left)
            if whole > 0.5 * left
            else whole
        )
        if method == ROSENBROCK:
            status = rosenbrock_step(time, step, y, run, b, places, w)
        else:
            status = runge_kutta_step(time, step, y, run, b, places, w)
        evaluations += cost
        error = step_error(step, y, run, b, places, w, tolerance) if status == OK else 1e9
        if error <= 1.0:
            time = end if step == left else time + step
            y[:] = w.new
            accepted += 1
            h = (
                step * min(4.0, 0.9 * max(error, 1e-9) ** (-1.0 / order))
                if step == whole
                else max(h, step)
            )
        else:
            rejected += 1
            h = step * max(0.2, 0.9 * error ** (-1.0 / order)) if error < 1e9 else 0.25 * step
            if not h > 1e-15 * max(end, 1e-9) or math.isnan(error):
                return Tally(
                    NOT_CONVERGED if status == OK else status,
                    time,
                    h,
                    accepted,
                    rejected,
                    evaluations,
                )
    return Tally(OK, time, h, accepted, rejected, evaluations)
