"""Equilibrium of all balls and the inner race at an instant of a motion (theory.md section 8).

Newton for ball centres and race displacement at once, the balls condensed one by one, from the
state of the last call: two or three iterations. Where that fails, the nested solver of race.py,
which needs no start, takes over.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.compile import jit
from bearingwear.kernels.equilibrium import groove_distance, spring
from bearingwear.kernels.kinematics import ORBIT
from bearingwear.kernels.linear import solve_in_place
from bearingwear.kernels.race import (
    LOAD_FIELDS,
    LOAD_R,
    LOAD_X,
    MODEL,
    ORBIT_RATE,
    PACKED,
    race_equilibrium,
    unpack_ball_state,
)
from bearingwear.kernels.state import BALL, OMEGA, PSI
from bearingwear.kernels.status import NOT_CONVERGED, OK

MOST_ITERATIONS = 40
# Columns of Suspension.factors.
HERTZ_K, HERTZ_A, HERTZ_B, LOG_KAPPA = range(4)
# Columns of Suspension.direction.
SIN_I, COS_I, SIN_O, COS_O = range(4)
# Columns of Suspension.cage_linear and land_linear: a force of two components, the place at which
# it was found, and how it falls as that place moves; not symmetric where it brings friction.
FORCE_1, FORCE_2, AT_1, AT_2, K_11, K_12, K_21, K_22 = range(8)
# Columns of Suspension.condensed: the step of a ball centre is STEP + BY dA, dA the (axial, radial)
# shift of the groove centres; and the stiffness of the races against its displacement [N/m].
STEP_1, STEP_2, BY_11, BY_12, BY_21, BY_22, RACES_11, RACES_12, RACES_22 = range(9)


class Suspension(NamedTuple):
    """Ball centres and inner race at an instant; the last answer is the start of the next.

    The inner race has three translations (axial, Y, Z); a fixed position holds the first.
    """

    X: np.ndarray  # (n, 2) ball centres from the outer groove centres [m]
    r: np.ndarray  # (n,) orbit radii [m]
    delta: np.ndarray  # (3,) race displacement [m]
    F: np.ndarray  # (3,) load on the race [N]
    cage_linear: np.ndarray  # (n, 8) axial and radial force of the cage on each ball, linearised
    land_linear: np.ndarray  # (8,) and of its land on the inner race (Y, Z)
    Q: np.ndarray  # (n, 2) contact loads, inner and outer [N]
    direction: np.ndarray  # (n, 4) sine and cosine of the contact angles
    factors: np.ndarray  # (n, 2, 4) Hertz K, c_a, c_b, ln kappa; NaN: no start is known
    A: np.ndarray  # (n, 2) groove-centre distances [m]
    condensed: np.ndarray  # (n, 9)
    matrix: np.ndarray  # (3, 3) condensed stiffness of the free translations [N/m]
    step: np.ndarray  # (3,) their unbalanced force [N], then their step [m]
    packed_states: np.ndarray  # (n, PACKED) buffer of the nested solver
    loads: np.ndarray  # (n, LOAD_FIELDS) buffer of the nested solver


@jit
def suspension(n):
    """Buffers for n balls, with no start known."""
    return Suspension(
        X=np.zeros((n, 2)),
        r=np.zeros(n),
        delta=np.zeros(3),
        F=np.empty(3),
        cage_linear=np.zeros((n, 8)),
        land_linear=np.zeros(8),
        Q=np.zeros((n, 2)),
        direction=np.zeros((n, 4)),
        factors=np.full((n, 2, 4), np.nan),
        A=np.zeros((n, 2)),
        condensed=np.zeros((n, 9)),
        matrix=np.zeros((3, 3)),
        step=np.zeros(3),
        packed_states=np.zeros((n, PACKED)),
        loads=np.zeros((n, LOAD_FIELDS)),
    )


@jit
def start_is_known(balls):
    """Whether there is a last answer to start from."""
    return not math.isnan(balls.factors[0, 0, LOG_KAPPA])


@jit
def nested_solution(y, bearing, balls):
    """Solve without a start, by race.py; fills `balls`. Returns a status."""
    n = bearing.D.size
    for j in range(n):
        load, x = balls.loads[j], balls.cage_linear[j]
        load[MODEL] = ORBIT
        load[ORBIT_RATE] = y[BALL * j + OMEGA]
        load[LOAD_X], load[LOAD_R] = x[FORCE_1], x[FORCE_2]
    land = balls.land_linear
    F = np.array([balls.F[0], balls.F[1] + land[FORCE_1], balls.F[2] + land[FORCE_2]])
    status, _, _ = race_equilibrium(
        bearing.g, bearing.D, balls.loads, y[PSI : BALL * n : BALL], F, bearing.tilt,
        int(bearing.axial_is_held), balls.delta, balls.packed_states,
    )  # fmt: skip
    for j in range(n):
        state = unpack_ball_state(balls.packed_states[j])
        balls.X[j, 0], balls.X[j, 1] = state.X1, state.X2
        for k in range(2):
            hertz, factors = (state.hertz_i, state.hertz_o)[k], balls.factors[j, k]
            factors[HERTZ_K] = hertz.K
            factors[HERTZ_A] = hertz.c_a
            factors[HERTZ_B] = hertz.c_b
            factors[LOG_KAPPA] = hertz.log_kappa
    return status


@jit
def hertz_at(table, cosine, f):
    """Hertz K, c_a and c_b at a contact angle from a cubic spline in its cosine, into f.

    Parameters
    ----------
    table : ndarray (intervals, 12)
        Coefficients of K, c_a and c_b on equal intervals of [0, 1], highest power first.
    """
    scaled = min(max(cosine, 0.0), 1.0) * table.shape[0]
    i = min(int(scaled), table.shape[0] - 1)
    x = scaled - i
    c = table[i]
    f[HERTZ_K] = ((c[0] * x + c[1]) * x + c[2]) * x + c[3]
    f[HERTZ_A] = ((c[4] * x + c[5]) * x + c[6]) * x + c[7]
    f[HERTZ_B] = ((c[8] * x + c[9]) * x + c[10]) * x + c[11]


@jit
def assemble_condensed(y, bearing, axial_is_held, balls):
    """One pass over the balls: forces, condensation of each ball, equations of the race.

    Fills `balls.matrix` and `balls.step` for the free translations of the race.

    Returns
    -------
    bool
        False where a ball is held by nothing.
    """
    g, first = bearing.g, int(axial_is_held)
    matrix, step, land = balls.matrix, balls.step, balls.land_linear
    matrix[:, :] = 0.0
    for i in range(3 - first):
        step[i] = balls.F[first + i]
    # The land on an inner race, like the cage's forces on the balls below.
    e1, e2 = balls.delta[1] - land[AT_1], balls.delta[2] - land[AT_2]
    k = 1 - first
    step[k] += land[FORCE_1] - land[K_11] * e1 - land[K_12] * e2
    step[k + 1] += land[FORCE_2] - land[K_21] * e1 - land[K_22] * e2
    matrix[k, k], matrix[k, k + 1] = land[K_11], land[K_12]
    matrix[k + 1, k], matrix[k + 1, k + 1] = land[K_21], land[K_22]
    for j in range(bearing.D.size):
        D, psi = bearing.D[j], y[BALL * j + PSI]
        A1, A2 = groove_distance(
            g, psi, balls.delta[0], balls.delta[1], balls.delta[2], bearing.tilt
        )
        X1, X2 = balls.X[j, 0], balls.X[j, 1]
        Y1, Y2 = A1 - X1, A2 - X2
        d = balls.direction[j]
        f_i, f_o = balls.factors[j, 0], balls.factors[j, 1]
        hertz_at(bearing.hertz[j, 0], Y2 / math.sqrt(Y1 * Y1 + Y2 * Y2), f_i)
        hertz_at(bearing.hertz[j, 1], X2 / math.sqrt(X1 * X1 + X2 * X2), f_o)
        Q_i, d[SIN_I], d[COS_I], i11, i12, i22 = spring(f_i[HERTZ_K], Y1, Y2, g.r_i - 0.5 * D)
        Q_o, d[SIN_O], d[COS_O], o11, o12, o22 = spring(f_o[HERTZ_K], X1, X2, g.r_o - 0.5 * D)
        balls.Q[j, 0], balls.Q[j, 1] = Q_i, Q_o
        balls.A[j, 0], balls.A[j, 1] = A1, A2
        # Forces of the cage, straight lines about where they were found.
        x = balls.cage_linear[j]
        e1, e2 = X1 - x[AT_1], X2 - x[AT_2]
        r1 = Q_i * d[SIN_I] - Q_o * d[SIN_O] + x[FORCE_1] - x[K_11] * e1 - x[K_12] * e2
        r2 = Q_i * d[COS_I] - Q_o * d[COS_O] + x[FORCE_2] - x[K_21] * e1 - x[K_22] * e2
        r2 += bearing.mass[j] * (g.R_o + X2) * y[BALL * j + OMEGA] ** 2
        k11, k12 = i11 + o11 + x[K_11], i12 + o12 + x[K_12]
        k21, k22 = i12 + o12 + x[K_21], i22 + o22 + x[K_22]
        det = k11 * k22 - k12 * k21
        if not abs(det) > 0.0:  # below 0 where friction in a pocket is stronger than the races
            return False
        e = balls.condensed[j]
        e[STEP_1], e[STEP_2] = (k22 * r1 - k12 * r2) / det, (k11 * r2 - k21 * r1) / det
        e[BY_11], e[BY_12] = (k22 * i11 - k12 * i12) / det, (k22 * i12 - k12 * i22) / det
        e[BY_21], e[BY_22] = (k11 * i12 - k21 * i11) / det, (k11 * i22 - k21 * i12) / det
        e[RACES_11], e[RACES_12], e[RACES_22] = i11 + o11, i12 + o12, i22 + o22
        # Inner force after the step: f + k_i (dA - dX).
        f1 = Q_i * d[SIN_I] - i11 * e[STEP_1] - i12 * e[STEP_2]
        f2 = Q_i * d[COS_I] - i12 * e[STEP_1] - i22 * e[STEP_2]
        to_y, to_z = -math.sin(psi), math.cos(psi)
        s22 = i22 - i12 * e[BY_12] - i22 * e[BY_22]
        if first == 0:
            s12 = i12 - i11 * e[BY_12] - i12 * e[BY_22]
            s21 = i12 - i12 * e[BY_11] - i22 * e[BY_21]
            step[0] -= f1
            matrix[0, 0] += i11 - i11 * e[BY_11] - i12 * e[BY_21]
            matrix[0, 1] += s12 * to_y
            matrix[0, 2] += s12 * to_z
            matrix[1, 0] += s21 * to_y
            matrix[2, 0] += s21 * to_z
        step[k] -= f2 * to_y
        step[k + 1] -= f2 * to_z
        matrix[k, k] += s22 * to_y * to_y
        matrix[k, k + 1] += s22 * to_y * to_z
        matrix[k + 1, k] += s22 * to_y * to_z
        matrix[k + 1, k + 1] += s22 * to_z * to_z
    return True


@jit
def solve_race(bearing, balls):
    """Solve the race's equations for its step; False where they are singular."""
    return solve_in_place(balls.matrix, balls.step, 3 - int(bearing.axial_is_held))


@jit
def back_substitute(y, bearing, balls):
    """Take the step of race and balls; returns its largest component [m]."""
    first, step = int(bearing.axial_is_held), balls.step
    largest = 0.0
    for i in range(3 - first):
        balls.delta[first + i] += step[i]
        largest = max(largest, abs(step[i]))
    da = step[0] if first == 0 else 0.0
    dy, dz = step[1 - first], step[2 - first]
    for j in range(bearing.D.size):
        e, psi = balls.condensed[j], y[BALL * j + PSI]
        dr = dz * math.cos(psi) - dy * math.sin(psi)
        dX1 = e[STEP_1] + e[BY_11] * da + e[BY_12] * dr
        dX2 = e[STEP_2] + e[BY_21] * da + e[BY_22] * dr
        balls.X[j, 0] += dX1
        balls.X[j, 1] += dX2
        largest = max(largest, abs(dX1), abs(dX2))
    return largest


@jit
def quasistatic_equilibrium(y, bearing, balls):
    """Equilibrium at the azimuths and orbit rates of a state.

    Parameters
    ----------
    y : ndarray
        State vector.
    bearing : BearingModel
    balls : Suspension
        The start, with the load and the cage's linearised forces; the answer replaces it.

    Returns
    -------
    int
        OK, or what the nested solver returned.
    """
    nested = not start_is_known(balls)
    if nested:
        status = nested_solution(y, bearing, balls)
        if status != OK:
            return status
    done = False
    for _ in range(MOST_ITERATIONS):
        regular = assemble_condensed(y, bearing, bearing.axial_is_held, balls)
        if done and regular:
            return OK
        if regular and solve_race(bearing, balls):
            largest = back_substitute(y, bearing, balls)
            if largest < 0.3 * bearing.g.BD:
                done = largest <= 1e-10 * bearing.g.BD
                continue
        if nested:
            return NOT_CONVERGED
        # Lost: a ball unloaded, or the start was too far off. Begin anew without a start.
        nested = True
        status = nested_solution(y, bearing, balls)
        if status != OK:
            return status
    return NOT_CONVERGED
