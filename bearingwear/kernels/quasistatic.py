"""Equilibrium of all balls and the inner race at an instant of a motion (theory.md section 8).

Newton for ball centres and race displacement at once, the balls eliminated one by one, from the
state of the last call: two or three sweeps. Where that fails, the nested solver of race.py, which
needs no start, takes over.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.compile import jit
from bearingwear.kernels.equilibrium import groove_distance, spring
from bearingwear.kernels.kinematics import ORBIT
from bearingwear.kernels.linear import solve_in_place
from bearingwear.kernels.race import ROW, race_equilibrium
from bearingwear.kernels.status import NOT_CONVERGED, OK


class Suspension(NamedTuple):
    """Ball centres and inner race at an instant; the buffers keep the last answer as a start."""

    X: np.ndarray  # (n, 2) ball centres from the outer groove centres [m]
    delta: np.ndarray  # (3,) race displacement (axial, Y, Z) [m]
    Q: np.ndarray  # (n, 2) contact loads, inner and outer [N]
    direction: np.ndarray  # (n, 4) sin and cos of the inner, sin and cos of the outer angle
    factors: np.ndarray  # (n, 2, 3) Hertz K, c_a, ln kappa
    A: np.ndarray  # (n, 2) groove-centre distances [m]
    elimination: np.ndarray  # (n, 9) buffer; the last three are the races' stiffness of the ball
    rows: np.ndarray  # (n, ROW) buffer of the nested solver
    loads: np.ndarray  # (n, 6) buffer of the nested solver


@jit
def suspension(n):
    """Buffers for n balls, with no start known (ln kappa is NaN)."""
    factors = np.full((n, 2, 3), np.nan)
    return Suspension(
        np.zeros((n, 2)), np.zeros(3), np.zeros((n, 2)), np.zeros((n, 4)), factors,
        np.zeros((n, 2)), np.zeros((n, 9)), np.zeros((n, ROW)), np.zeros((n, 6)),
    )  # fmt: skip


@jit
def nested_solution(g, D, Omega, psi, extra, F, tilt, first, s):
    """Solve without a start, by race.py; fills `s`. Returns a status."""
    for j in range(D.size):
        s.loads[j, 0] = ORBIT
        s.loads[j, 1] = Omega[j]
        s.loads[j, 4], s.loads[j, 5] = extra[j, 0], extra[j, 1]
    status, residual, _ = race_equilibrium(g, D, s.loads, psi, F, tilt, first, s.delta, s.rows)
    for j in range(D.size):
        row = s.rows[j]
        s.X[j, 0], s.X[j, 1] = row[1], row[2]
        s.factors[j, 0, 0], s.factors[j, 0, 1], s.factors[j, 0, 2] = row[7], row[8], row[10]
        s.factors[j, 1, 0], s.factors[j, 1, 1], s.factors[j, 1, 2] = row[12], row[13], row[15]
    return status


@jit
def hertz_at(table, cosine, f):
    """Hertz K and c_a at a contact angle from a cubic spline in its cosine, into f[0], f[1].

    Parameters
    ----------
    table : ndarray (intervals, 8)
        Coefficients of K and of c_a on equal intervals of [0, 1], highest power first.
    """
    scaled = min(max(cosine, 0.0), 1.0) * table.shape[0]
    i = min(int(scaled), table.shape[0] - 1)
    x = scaled - i
    c = table[i]
    f[0] = ((c[0] * x + c[1]) * x + c[2]) * x + c[3]
    f[1] = ((c[4] * x + c[5]) * x + c[6]) * x + c[7]


@jit
def sweep(g, D, mass, hertz, Omega, psi, extra, land, F, tilt, first, s, matrix, step):
    """One pass over the balls: forces, elimination, and the race's reduced equations.

    Returns
    -------
    bool
        False where a ball is held by nothing.
    """
    matrix[:, :] = 0.0
    for i in range(3 - first):
        step[i] = F[first + i]
    # The land on an inner race, like the cage's forces on the balls below.
    e1, e2 = s.delta[1] - land[2], s.delta[2] - land[3]
    k = 1 - first
    step[k] += land[0] - land[4] * e1 - land[5] * e2
    step[k + 1] += land[1] - land[6] * e1 - land[7] * e2
    matrix[k, k], matrix[k, k + 1] = land[4], land[5]
    matrix[k + 1, k], matrix[k + 1, k + 1] = land[6], land[7]
    for j in range(D.size):
        A1, A2 = groove_distance(g, psi[j], s.delta[0], s.delta[1], s.delta[2], tilt)
        X1, X2 = s.X[j, 0], s.X[j, 1]
        Y1, Y2 = A1 - X1, A2 - X2
        d = s.direction[j]
        f_i, f_o = s.factors[j, 0], s.factors[j, 1]
        hertz_at(hertz[j, 0], Y2 / math.sqrt(Y1 * Y1 + Y2 * Y2), f_i)
        hertz_at(hertz[j, 1], X2 / math.sqrt(X1 * X1 + X2 * X2), f_o)
        Q_i, d[0], d[1], i11, i12, i22 = spring(f_i[0], Y1, Y2, g.r_i - 0.5 * D[j])
        Q_o, d[2], d[3], o11, o12, o22 = spring(f_o[0], X1, X2, g.r_o - 0.5 * D[j])
        s.Q[j, 0], s.Q[j, 1] = Q_i, Q_o
        s.A[j, 0], s.A[j, 1] = A1, A2
        # Forces of the cage, straight lines about where they were found.
        x = extra[j]
        e1, e2 = X1 - x[2], X2 - x[3]
        r1 = Q_i * d[0] - Q_o * d[2] + x[0] - x[4] * e1 - x[5] * e2
        r2 = Q_i * d[1] - Q_o * d[3] + x[1] - x[6] * e1 - x[7] * e2
        r2 += mass[j] * (g.R_o + X2) * Omega[j] ** 2
        k11, k12, k21, k22 = i11 + o11 + x[4], i12 + o12 + x[5], i12 + o12 + x[6], i22 + o22 + x[7]
        det = k11 * k22 - k12 * k21
        if not abs(det) > 0.0:  # below 0 where friction in a pocket is stronger than the races
            return False
        # The ball's step is dX = e[0:2] + e[2:6] dA, dA = (axial, radial) of the groove centres.
        e = s.elimination[j]
        e[0], e[1] = (k22 * r1 - k12 * r2) / det, (k11 * r2 - k21 * r1) / det
        e[2], e[3] = (k22 * i11 - k12 * i12) / det, (k22 * i12 - k12 * i22) / det
        e[4], e[5] = (k11 * i12 - k21 * i11) / det, (k11 * i22 - k21 * i12) / det
        e[6], e[7], e[8] = i11 + o11, i12 + o12, i22 + o22
        # Inner force after it: f + k_i (dA - dX).
        f1 = Q_i * d[0] - i11 * e[0] - i12 * e[1]
        f2 = Q_i * d[1] - i12 * e[0] - i22 * e[1]
        y, z = -math.sin(psi[j]), math.cos(psi[j])
        s22 = i22 - i12 * e[3] - i22 * e[5]
        if first == 0:
            s12 = i12 - i11 * e[3] - i12 * e[5]
            s21 = i12 - i12 * e[2] - i22 * e[4]
            step[0] -= f1
            matrix[0, 0] += i11 - i11 * e[2] - i12 * e[4]
            matrix[0, 1] += s12 * y
            matrix[0, 2] += s12 * z
            matrix[1, 0] += s21 * y
            matrix[2, 0] += s21 * z
        step[k] -= f2 * y
        step[k + 1] -= f2 * z
        matrix[k, k] += s22 * y * y
        matrix[k, k + 1] += s22 * y * z
        matrix[k + 1, k] += s22 * y * z
        matrix[k + 1, k + 1] += s22 * z * z
    return True


@jit
def move(psi, first, step, s):
    """Take the step of race and balls; returns its largest component [m]."""
    largest = 0.0
    for i in range(3 - first):
        s.delta[first + i] += step[i]
        largest = max(largest, abs(step[i]))
    da = step[0] if first == 0 else 0.0
    dy, dz = step[1 - first], step[2 - first]
    for j in range(psi.size):
        e = s.elimination[j]
        dr = dz * math.cos(psi[j]) - dy * math.sin(psi[j])
        dX1 = e[0] + e[2] * da + e[3] * dr
        dX2 = e[1] + e[4] * da + e[5] * dr
        s.X[j, 0] += dX1
        s.X[j, 1] += dX2
        largest = max(largest, abs(dX1), abs(dX2))
    return largest


@jit
def settle(g, D, mass, hertz, Omega, psi, extra, land, F, tilt, first, s):
    """Equilibrium at given azimuths and orbit rates.

    Parameters
    ----------
    g : Geometry
    D, mass : ndarray (n,)
        Ball diameters [m] and masses [kg].
    hertz : ndarray (n, 2, intervals, 8)
        See `hertz_at`; inner and outer contact of each ball.
    Omega, psi : ndarray (n,)
        Orbit rates [rad/s] and azimuths [rad].
    extra : ndarray (n, 8)
        Further axial and radial forces on the balls (cage) [N], the ball centre at which they were
        found [m], and how they fall as it moves: a 2 x 2 matrix by rows, not symmetric where the
        force brings friction [N/m].
    land : ndarray (8,)
        The same for the radial force (Y, Z) of the cage's land on the inner race.
    F : ndarray (3,)
        Load on the inner race (axial, Y, Z) [N].
    tilt : float
        [rad]
    first : int
        First free translation of the race: 0 constant force, 1 fixed position.
    s : Suspension
        The start; the answer replaces it.

    Returns
    -------
    int
        OK, or what the nested solver returned.
    """
    free = 3 - first
    matrix, step = np.empty((3, 3)), np.empty(3)
    total = np.array([F[0], F[1] + land[0], F[2] + land[1]])
    nested = math.isnan(s.factors[0, 0, 2])
    if nested:
        status = nested_solution(g, D, Omega, psi, extra, total, tilt, first, s)
        if status != OK:
            return status
    done = False
    for _ in range(40):
        regular = sweep(g, D, mass, hertz, Omega, psi, extra, land, F, tilt, first, s, matrix, step)
        if done and regular:
            return OK
        if regular and solve_in_place(matrix, step, free):
            largest = move(psi, first, step, s)
            if largest < 0.3 * g.BD:
                done = largest <= 1e-10 * g.BD
                continue
        if nested:
            return NOT_CONVERGED
        # Lost: a ball unloaded, or the start was too far off. Begin anew without a start.
        nested = True
        status = nested_solution(g, D, Omega, psi, extra, total, tilt, first, s)
        if status != OK:
            return status
    return NOT_CONVERGED
