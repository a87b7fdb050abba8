"""Contacts and balance of all balls and the inner race at an instant (theory.md section 8).

`dynamic_equilibrium.py` iterates on what stands here; where it has no start, the nested solver of
race.py, which needs none, makes one.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.decorators import jit
from bearingwear.kernels.equilibrium.kinematics import ORBIT
from bearingwear.kernels.equilibrium.race import (
    LOAD_FIELDS,
    LOAD_R,
    LOAD_X,
    MODEL,
    ORBIT_RATE,
    PACKED,
    race_equilibrium,
    unpack_ball_state,
)
from bearingwear.kernels.equilibrium.thrust_loaded import spring
from bearingwear.kernels.layout import BALL, OMEGA, PSI
from bearingwear.kernels.linear import solve_in_place

# Columns of Suspension.factors.
HERTZ_K, HERTZ_A, HERTZ_B, LOG_KAPPA = range(4)
# Columns of Suspension.direction.
SIN_I, COS_I, SIN_O, COS_O = range(4)
# Columns of Suspension.cage_linear and land_linear: a force of two components, and how it falls as
# the place that it acts at moves; not symmetric where it brings friction.
FORCE_1, FORCE_2, K_11, K_12, K_21, K_22 = range(6)
# Columns of Suspension.stiffness: of the inner race's force on the ball by the groove's
# displacement, of the outer one's by that of the ball [N/m].
I_11, I_12, I_21, I_22, O_11, O_12, O_21, O_22 = range(8)
# Columns of Suspension.condensed: the step of a ball centre is STEP + BY dA, dA the (axial, radial)
# shift of the groove centres.
STEP_1, STEP_2, BY_11, BY_12, BY_21, BY_22 = range(6)


class Suspension(NamedTuple):
    """Ball centres and inner race at an instant, their contacts, and how they yield.

    The inner race has three translations (axial, Y, Z); a fixed position holds the first.
    """

    X: np.ndarray  # (n, 2) ball centres from the outer groove centres [m]
    delta: np.ndarray  # (3,) race displacement [m]
    F: np.ndarray  # (3,) load on the race [N]
    T: np.ndarray  # (n, 2) traction along the first contact axes that bears on the balance [N]
    cage_linear: np.ndarray  # (n, 6) axial and radial force of the cage on each ball, linearised
    land_linear: np.ndarray  # (6,) and of its land on the inner race (Y, Z)
    r: np.ndarray  # (n,) orbit radii [m]
    turn: np.ndarray  # (n, 2) sine and cosine of the azimuths
    Q: np.ndarray  # (n, 2) contact loads, inner and outer [N]
    direction: np.ndarray  # (n, 4) sine and cosine of the contact angles
    factors: np.ndarray  # (n, 2, 4) Hertz K, c_a, c_b, ln kappa; NaN: no start is known
    A: np.ndarray  # (n, 2) groove-centre distances [m]
    stiffness: np.ndarray  # (n, 8)
    left: np.ndarray  # (n, 2) axial and radial force on each ball that nothing balances [N]
    race_left: np.ndarray  # (3,) and on the race (axial, Y, Z)
    condensed: np.ndarray  # (n, 6)
    matrix: np.ndarray  # (3, 3) condensed stiffness of the free translations [N/m]
    step: np.ndarray  # (3,) their unbalanced force [N], then their step [m]
    packed_states: np.ndarray  # (n, PACKED) buffer of the nested solver
    loads: np.ndarray  # (n, LOAD_FIELDS) buffer of the nested solver


def suspension(n):
    """Buffers for n balls, with no start known."""
    return Suspension(
        X=np.zeros((n, 2)),
        delta=np.zeros(3),
        F=np.zeros(3),
        T=np.zeros((n, 2)),
        cage_linear=np.zeros((n, 6)),
        land_linear=np.zeros(6),
        r=np.zeros(n),
        turn=np.zeros((n, 2)),
        Q=np.zeros((n, 2)),
        direction=np.zeros((n, 4)),
        factors=np.full((n, 2, 4), np.nan),
        A=np.zeros((n, 2)),
        stiffness=np.zeros((n, 8)),
        left=np.zeros((n, 2)),
        race_left=np.zeros(3),
        condensed=np.zeros((n, 6)),
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
    """Solve without a start and without traction, by race.py; fills `balls`. Returns a status."""
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
def find_contacts(y, bearing, balls):
    """Contacts of balls and races where the places of `balls` put them.

    Fills r, turn, A, Q, direction, factors and, without traction, stiffness.
    """
    g, delta = bearing.g, balls.delta
    axial, radial = g.BD * math.sin(g.alpha0) + delta[0], g.BD * math.cos(g.alpha0)
    lean = bearing.tilt * g.R_i
    for j in range(bearing.D.size):
        psi, R = y[BALL * j + PSI], 0.5 * bearing.D[j]
        sp, cp = math.sin(psi), math.cos(psi)
        balls.turn[j, 0], balls.turn[j, 1] = sp, cp
        X1, X2 = balls.X[j, 0], balls.X[j, 1]
        A1, A2 = axial + lean * cp, radial + delta[2] * cp - delta[1] * sp
        Y1, Y2 = A1 - X1, A2 - X2
        balls.A[j, 0], balls.A[j, 1] = A1, A2
        balls.r[j] = g.R_o + X2
        d, k = balls.direction[j], balls.stiffness[j]
        f_i, f_o = balls.factors[j, 0], balls.factors[j, 1]
        hertz_at(bearing.hertz[j, 0], Y2 / math.sqrt(Y1 * Y1 + Y2 * Y2), f_i)
        hertz_at(bearing.hertz[j, 1], X2 / math.sqrt(X1 * X1 + X2 * X2), f_o)
        Q_i, d[SIN_I], d[COS_I], k[I_11], k[I_12], k[I_22] = spring(f_i[HERTZ_K], Y1, Y2, g.r_i - R)
        Q_o, d[SIN_O], d[COS_O], k[O_11], k[O_12], k[O_22] = spring(f_o[HERTZ_K], X1, X2, g.r_o - R)
        k[I_21], k[O_21] = k[I_12], k[O_12]
        balls.Q[j, 0], balls.Q[j, 1] = Q_i, Q_o


@jit
def add_traction_stiffness(bearing, balls):
    """Turn the tractions `balls.T` with their contacts and scale them with their loads."""
    for j in range(bearing.D.size):
        X, A, k = balls.X[j], balls.A[j], balls.stiffness[j]
        for race in range(2):
            Q, T = balls.Q[j, race], balls.T[j, race]
            if not Q > 0.0:
                continue
            sign, at = (1.0, I_11) if race == 0 else (-1.0, O_11)
            d1, d2 = (A[0] - X[0], A[1] - X[1]) if race == 0 else (X[0], X[1])
            length = math.sqrt(d1 * d1 + d2 * d2)
            s, c = d1 / length, d2 / length
            grows = T / Q * (k[at] * s * s + 2.0 * k[at + 1] * s * c + k[at + 3] * c * c)
            turns = T / length
            k[at] += sign * (grows - turns) * s * c
            k[at + 1] += sign * (grows * c * c + turns * s * s)
            k[at + 2] -= sign * (grows * s * s + turns * c * c)
            k[at + 3] -= sign * (grows - turns) * s * c


@jit
def inner_force(balls, j):
    """Axial and radial force of the inner race on ball j [N]."""
    Q, T, s, c = balls.Q[j, 0], balls.T[j, 0], balls.direction[j, SIN_I], balls.direction[j, COS_I]
    return Q * s + T * c, Q * c - T * s


@jit
def unbalanced_forces(y, bearing, balls):
    """Forces on balls and race that nothing balances, into `balls`, at the contacts found there."""
    land, n = balls.land_linear, bearing.D.size
    F_0, F_1, F_2 = balls.F[0], balls.F[1] + land[FORCE_1], balls.F[2] + land[FORCE_2]
    for j in range(n):
        d, cage = balls.direction[j], balls.cage_linear[j]
        Q, T = balls.Q[j, 1], balls.T[j, 1]
        axial, radial = inner_force(balls, j)
        # `unbalanced_force` once more: the race takes its part, and the cage joins in
        centrifugal = bearing.mass[j] * balls.r[j] * y[BALL * j + OMEGA] ** 2
        balls.left[j, 0] = axial - Q * d[SIN_O] + T * d[COS_O] + cage[FORCE_1]
        balls.left[j, 1] = radial - Q * d[COS_O] - T * d[SIN_O] + cage[FORCE_2] + centrifugal
        F_0 -= axial
        F_1 += radial * balls.turn[j, 0]
        F_2 -= radial * balls.turn[j, 1]
    balls.race_left[0] = 0.0 if bearing.axial_is_held else F_0
    balls.race_left[1], balls.race_left[2] = F_1, F_2


@jit
def assemble_condensed(bearing, axial_is_held, cage, balls):
    """One pass over the balls: condensation of each ball, equations of the race.

    Fills `balls.matrix` and `balls.step` for the free translations of the race, from the contacts
    and unbalanced forces of `balls`.

    Parameters
    ----------
    cage : bool
        Whether pockets and land hold balls and race too.

    Returns
    -------
    bool
        False where a ball is held by nothing.
    """
    first = int(axial_is_held)
    matrix, step, land = balls.matrix, balls.step, balls.land_linear
    matrix[:, :] = 0.0
    for i in range(3 - first):
        step[i] = balls.race_left[first + i]
    k = 1 - first
    if cage:
        matrix[k, k], matrix[k, k + 1] = land[K_11], land[K_12]
        matrix[k + 1, k], matrix[k + 1, k + 1] = land[K_21], land[K_22]
    for j in range(bearing.D.size):
        r1, r2 = balls.left[j, 0], balls.left[j, 1]
        x, s = balls.cage_linear[j], balls.stiffness[j]
        i11, i12, i21, i22 = s[I_11], s[I_12], s[I_21], s[I_22]
        k11, k12, k21, k22 = i11 + s[O_11], i12 + s[O_12], i21 + s[O_21], i22 + s[O_22]
        if cage:
            k11, k12, k21, k22 = k11 + x[K_11], k12 + x[K_12], k21 + x[K_21], k22 + x[K_22]
        det = k11 * k22 - k12 * k21
        if not abs(det) > 0.0:  # below 0 where friction in a pocket is stronger than the races
            return False
        e = balls.condensed[j]
        e[STEP_1], e[STEP_2] = (k22 * r1 - k12 * r2) / det, (k11 * r2 - k21 * r1) / det
        e[BY_11], e[BY_12] = (k22 * i11 - k12 * i21) / det, (k22 * i12 - k12 * i22) / det
        e[BY_21], e[BY_22] = (k11 * i21 - k21 * i11) / det, (k11 * i22 - k21 * i12) / det
        # Inner force after the step: f + k_i (dA - dX).
        f1 = i11 * e[STEP_1] + i12 * e[STEP_2]
        f2 = i21 * e[STEP_1] + i22 * e[STEP_2]
        to_y, to_z = -balls.turn[j, 0], balls.turn[j, 1]
        s22 = i22 - i21 * e[BY_12] - i22 * e[BY_22]
        if first == 0:
            s12 = i12 - i11 * e[BY_12] - i12 * e[BY_22]
            s21 = i21 - i21 * e[BY_11] - i22 * e[BY_21]
            step[0] += f1
            matrix[0, 0] += i11 - i11 * e[BY_11] - i12 * e[BY_21]
            matrix[0, 1] += s12 * to_y
            matrix[0, 2] += s12 * to_z
            matrix[1, 0] += s21 * to_y
            matrix[2, 0] += s21 * to_z
        step[k] += f2 * to_y
        step[k + 1] += f2 * to_z
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
def back_substitute(bearing, balls):
    """Take the step of race and balls; returns its largest component [m]."""
    first, step = int(bearing.axial_is_held), balls.step
    largest = 0.0
    for i in range(3 - first):
        balls.delta[first + i] += step[i]
        largest = max(largest, abs(step[i]))
    da = step[0] if first == 0 else 0.0
    dy, dz = step[1 - first], step[2 - first]
    for j in range(bearing.D.size):
        e = balls.condensed[j]
        dr = dz * balls.turn[j, 1] - dy * balls.turn[j, 0]
        dX1 = e[STEP_1] + e[BY_11] * da + e[BY_12] * dr
        dX2 = e[STEP_2] + e[BY_21] * da + e[BY_22] * dr
        balls.X[j, 0] += dX1
        balls.X[j, 1] += dX2
        largest = max(largest, abs(dX1), abs(dX2))
    return largest
