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

from bearingwear.kernels.cage import CAGE, angular_velocity, turn
from bearingwear.kernels.compile import jit
from bearingwear.kernels.coupling import System, add_cage_powers, factorise, solve, system
from bearingwear.kernels.motion import (
    BALL,
    ball_blocks,
    keep_places,
    motion_rates,
    restore_places,
)
from bearingwear.kernels.status import NOT_CONVERGED, OK, TOO_STIFF

ROSENBROCK, RUNGE_KUTTA = 0, 1
# A step that closes a contact deeper than so many times the range in which its damping comes in is
# taken anew up to where it closes.
EVENT_DEPTH = 4.0
MOST_STEPS = 3000  # tried in the longest step's time, a hundred times what a run usually takes

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
    before: np.ndarray  # (3 n + 2,) see `contacts_now`, at both ends of a step
    after: np.ndarray  # (3 n + 2,)
    kept: np.ndarray  # (10 n + 11,) see motion.keep_places
    hertz: np.ndarray  # (n, 2, 2) see `stiffened`
    system: System


@jit
def stages(n, size):
    """Buffers for n balls and states of so many numbers in all."""
    return Stages(
        np.zeros((6, size)), np.zeros(size), np.zeros(size), np.zeros(size), np.zeros(size),
        np.zeros(3 * n + 2), np.zeros(3 * n + 2), np.zeros(10 * n + 11),
        np.zeros((n, 2, 2)), system(n),
    )  # fmt: skip


class Tally(NamedTuple):
    """What an integration took."""

    status: int
    time: float  # reached [s]
    h: float  # next step [s]
    accepted: int
    rejected: int
    evaluations: int
    events: int  # contacts made and broken


@jit
def rosenbrock_step(time, h, y, run, b, places, w):
    """One W-method step from y; fills `w.new` and `w.error`. Returns a status.

    `w.f` and `b` come from `motion_rates` at (time, y).
    """
    n, size = run.D.size, y.size
    ball_blocks(y, run, b)
    shift = 1.0 / (h * W_GAMMA)
    if not factorise(shift, y, run, b, places, w.system):
        return NOT_CONVERGED
    for i in range(4):
        U = w.U[i]
        if i > 0:
            for k in range(size):
                value = y[k]
                for j in range(i):
                    value += W_A[i, j] * w.U[j, k]
                w.trial[k] = value
            status = motion_rates(time + W_TIME[i] * h, w.trial, run, b, w.f, places)
            if status != OK:
                return status
        for k in range(size):
            value = w.f[k]
            for j in range(i):
                value += W_C[i, j] / h * w.U[j, k]
            w.trial[k] = value
        solve(w.trial, U, run, places, w.system)
        for j in range(n):
            q = BALL * j
            for v in range(4):
                w.trial[places.shaft] += b.slopes[j, 0, v] * U[q + v]
                w.trial[places.heat] += b.slopes[j, 1, v] * U[q + v]
                w.trial[places.turning] += b.slopes[j, 2, v] * U[q + v]
        add_cage_powers(U, w.trial, y, run, b, places, w.system)
        for k in range(places.qv, size):
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
    """One Fehlberg 4(5) step from y; fills `w.new` and `w.error`. Returns a status.

    `w.f` comes from `motion_rates` at (time, y).
    """
    size = y.size
    w.U[0, :] = w.f
    for i in range(1, 6):
        for k in range(size):
            value = y[k]
            for j in range(i):
                value += h * F_A[i, j] * w.U[j, k]
            w.trial[k] = value
        status = motion_rates(time + F_TIME[i] * h, w.trial, run, b, w.U[i], places)
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
    if run.cage.present:
        # The cage's speeds against a hundredth of the balls' speed, places against the clearance.
        z = places.cage
        speed = 0.01 * b.r[0] * abs(y[3]) + slip
        gap = 0.01 * max(run.cage.clearance, 1e-3 * run.D[0])
        arm = run.cage.radius
        e = w.error[z : z + CAGE]
        for k in range(3):
            largest = max(largest, abs(e[k]) / gap, arm * abs(e[6 + k]) / gap)
            largest = max(largest, abs(e[3 + k]) / speed)
            largest = max(largest, arm * abs(e[9 + k]) / (run.cage.I_t * speed))
        for j in range(n):
            largest = max(largest, b.r[j] * abs(w.error[BALL * j + 4]) / gap)
    return largest / tolerance


@jit
def rebase(y, run, b, places, f):
    """Put the cage's rotation vector back to zero, into the orientation it counts from.

    And its rate of change f into that of a vector at zero.
    """
    if run.cage.present:
        theta = y[places.cage + 6 : places.cage + 9]
        turn(theta, b.cage.R0, b.cage.R)
        b.cage.R0[:, :] = b.cage.R
        theta[:] = 0.0
        z = places.cage
        w = angular_velocity(run.cage, y[z : z + CAGE], b.cage.R)
        for k in range(3):
            f[z + 6 + k] = w[k]


@jit
def contacts_now(run, b, places, touch):
    """Interference of every contact: pockets and land edges [m], load of every race contact [N].

    Positive where closed.
    """
    n = run.D.size
    touch[: n + 2] = b.cage.approach
    for j in range(n):
        touch[n + 2 + 2 * j] = b.s.Q[j, 0]
        touch[n + 3 + 2 * j] = b.s.Q[j, 1]


@jit
def stiffened(b, last):
    """Elastic energy that came with Hertz factors alone since the last call [J].

    The contact force is that of a factor which stands still: as the contact angle changes, the
    energy 2/5 K d^(5/2) changes by more than the work of the force.

    Parameters
    ----------
    last : ndarray (n, 2, 2)
        K and 2/5 d^(5/2) of the last call [N/m^1.5, m^2.5]; replaced.
    """
    total = 0.0
    for j in range(b.r.size):
        for k in range(2):
            K = b.s.factors[j, k, 0]
            depth = 0.4 * (b.s.Q[j, k] / K) ** (5.0 / 3.0)
            total += 0.5 * (depth + last[j, k, 1]) * (K - last[j, k, 0])
            last[j, k, 0], last[j, k, 1] = K, depth
    return total


@jit
def event_in(before, after, n, depth):
    """Events between two instants, and where in between the first deep contact is made.

    Returns
    -------
    count : int
        Contacts made or broken.
    fraction : float
        Of the step, to where the first pocket or land closes that is `depth` deep at its
        end; 1 where none is.
    """
    count, fraction = 0, 1.0
    for i in range(before.size):
        if (before[i] > 0.0) != (after[i] > 0.0):
            count += 1
            if i < n + 2 and after[i] > depth:
                fraction = min(fraction, before[i] / (before[i] - after[i]))
    return count, fraction


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
    n = run.D.size
    accepted = rejected = evaluations = events = 0
    order = 3.0 if method == ROSENBROCK else 5.0
    cost = 4 if method == ROSENBROCK else 6
    status = motion_rates(time, y, run, b, w.f, places)
    contacts_now(run, b, places, w.before)
    located = False
    depth = EVENT_DEPTH * min(run.cage.ramp_pocket, run.cage.ramp_land)
    most = MOST_STEPS * max(1.0, (end - time) / longest)
    keep_places(b, w.kept)
    stiffened(b, w.hertz)
    while status == OK and time < end:
        if accepted + rejected > most:
            status = TOO_STIFF
            break
        left = end - time
        whole = min(h, longest)
        # Two equal steps rather than a full and a tiny one.
        step = whole
        if whole >= left * (1.0 - 1e-9):
            step = left
        elif whole > 0.5 * left:
            step = 0.5 * left
        now = end if step == left else time + step
        if method == ROSENBROCK:
            trial = rosenbrock_step(time, step, y, run, b, places, w)
        else:
            trial = runge_kutta_step(time, step, y, run, b, places, w)
        evaluations += cost
        error = step_error(step, y, run, b, places, w, tolerance) if trial == OK else 1e9
        fraction, count = 1.0, 0
        if error <= 1.0:
            trial = motion_rates(now, w.new, run, b, w.f, places)
            if trial == OK:
                contacts_now(run, b, places, w.after)
                count, fraction = event_in(w.before, w.after, n, depth)
        if error <= 1.0 and trial == OK and (located or fraction == 1.0):
            time = now
            y[:] = w.new
            y[places.hertz] += stiffened(b, w.hertz)
            rebase(y, run, b, places, w.f)
            w.before[:] = w.after
            keep_places(b, w.kept)
            accepted += 1
            events += count
            located = False
            grown = step * min(4.0, 0.9 * max(error, 1e-9) ** (-1.0 / order))
            h = grown if step == whole else max(h, grown)
        else:
            rejected += 1
            if error <= 1.0 and trial == OK:
                h, located = max(fraction, 0.05) * step, True
            else:
                located = False
                shrunk = 0.25 if trial != OK else max(0.2, 0.9 * error ** (-1.0 / order))
                h = shrunk * step
            if not h > 1e-15 * max(end, 1e-9) or math.isnan(error):
                if trial == OK:
                    trial = NOT_CONVERGED if math.isnan(error) else TOO_STIFF
                status = trial
                break
            # A step that failed leaves places that mislead.
            restore_places(b, w.kept)
            status = motion_rates(time, y, run, b, w.f, places)
    return Tally(status, time, h, accepted, rejected, evaluations, events)
