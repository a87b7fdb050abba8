"""Linear systems of the implicit integrator: one block a ball, bordered by the cage.

The matrix stands for `shift - J`, with the loads held. A ball that touches its pocket couples to
the cage by what the contact makes of their relative motion (cage.contact_law); the balls are
eliminated one by one and the twelve numbers of the cage remain.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.cage import CAGE, INNER_LAND, cross
from bearingwear.kernels.compile import jit
from bearingwear.kernels.motion import BALL


class System(NamedTuple):
    """Factors of the matrix, and buffers."""

    inverse: np.ndarray  # (n, 5, 5) inverses of the balls' blocks
    across: np.ndarray  # (n, 5, 12) those times the coupling to the cage
    back: np.ndarray  # (n, 12, 5) coupling of the cage to the ball
    border: np.ndarray  # (12, 12) inverse of the cage's reduced block
    matrix: np.ndarray  # (12, 12)
    centre: np.ndarray  # (3, 2) directions in which a ball's centre gives way
    yielding: np.ndarray  # (3, 3)
    side: np.ndarray  # (12,)
    B_v: np.ndarray  # (3, 5) velocity and displacement of the ball's contact point
    B_x: np.ndarray
    Z_v: np.ndarray  # (3, 12) and of the cage's
    Z_x: np.ndarray
    force_b: np.ndarray  # (3, 5) derivative of the force on the ball
    force_z: np.ndarray  # (3, 12)
    touching: np.ndarray  # (n + 2,) pockets and land edges, when the matrix was factored
    r: np.ndarray  # (n,) and what the cage's contacts were then: see cage.CageBuffers
    arm: np.ndarray  # (n + 2, 3)
    reach: np.ndarray  # (n, 3)
    K: np.ndarray  # (n + 2, 3, 3)
    C: np.ndarray  # (n + 2, 3, 3)
    heat: np.ndarray  # (n + 2, 6)
    loss: np.ndarray  # (n + 2, 6)
    gain_b: np.ndarray  # (5, 3) what that force does to the ball's rates
    gain_z: np.ndarray  # (12, 3) and its opposite to the cage's


@jit
def system(n):
    """Buffers for n balls."""
    return System(
        np.zeros((n, 5, 5)), np.zeros((n, 5, 12)), np.zeros((n, 12, 5)), np.zeros((12, 12)),
        np.zeros((12, 12)), np.zeros((3, 2)), np.zeros((3, 3)), np.zeros(12), np.zeros((3, 5)),
        np.zeros((3, 5)), np.zeros((3, 12)),
        np.zeros((3, 12)), np.zeros((3, 5)), np.zeros((3, 12)), np.zeros(n + 2, dtype=np.bool_),
        np.zeros(n), np.zeros((n + 2, 3)), np.zeros((n, 3)), np.zeros((n + 2, 3, 3)),
        np.zeros((n + 2, 3, 3)), np.zeros((n + 2, 6)), np.zeros((n + 2, 6)), np.zeros((5, 3)),
        np.zeros((12, 3)),
    )  # fmt: skip


@jit
def invert(A, n, out):
    """Inverse of the leading n x n of A (destroyed) by Gauss-Jordan with partial pivoting.

    For the small systems here. False where singular.
    """
    for i in range(n):
        for j in range(n):
            out[i, j] = 1.0 if i == j else 0.0
    for k in range(n):
        best, row = abs(A[k, k]), k
        for i in range(k + 1, n):
            if abs(A[i, k]) > best:
                best, row = abs(A[i, k]), i
        if not best > 0.0:
            return False
        if row != k:
            for j in range(n):
                A[k, j], A[row, j] = A[row, j], A[k, j]
                out[k, j], out[row, j] = out[row, j], out[k, j]
        pivot = 1.0 / A[k, k]
        for j in range(n):
            A[k, j] *= pivot
            out[k, j] *= pivot
        for i in range(n):
            factor = A[i, k]
            if i != k and factor != 0.0:
                for j in range(n):
                    A[i, j] -= factor * A[k, j]
                    out[i, j] -= factor * out[k, j]
    return True


@jit
def cage_point(cage, R, arm, Z_v, Z_x, gain):
    """Motion of a point fixed to the cage, and what a force there does to the cage's rates."""
    Z_v[:, :] = 0.0
    Z_x[:, :] = 0.0
    gain[:, :] = 0.0
    a0, a1, a2 = arm[0], arm[1], arm[2]
    # omega x arm as a matrix on omega.
    skew = ((0.0, a2, -a1), (-a2, 0.0, a0), (a1, -a0, 0.0))
    for i in range(3):
        Z_x[i, i] = 1.0
        Z_v[i, 3 + i] = 1.0
        gain[3 + i, i] = 1.0 / cage.mass
        for j in range(3):
            Z_x[i, 6 + j] = skew[i][j]
            gain[9 + i, j] = skew[j][i]  # the moment arm x force
            for k in range(3):
                Z_v[i, 9 + j] += skew[i][k] * inverse_inertia(cage, R, k, j)


@jit
def inverse_inertia(cage, R, i, j):
    """Element of the inverse inertia in inertial axes [1/(kg m2)]."""
    value = (1.0 / cage.I_x - 1.0 / cage.I_t) * R[i, 0] * R[j, 0]
    return value + 1.0 / cage.I_t if i == j else value


@jit
def yield_to_contact(elimination, K, sp, cp, f, j):
    """Let a ball's centre give way, axially and radially, to the force of its pocket.

    The races hold it softly along their contacts' tangent. Static condensation of its two
    displacements from the derivatives of the contact by displacement.
    """
    P = f.centre
    P[0, 0], P[1, 0], P[2, 0] = 1.0, 0.0, 0.0
    P[0, 1], P[1, 1], P[2, 1] = 0.0, -sp, cp
    a, b, c, d = elimination[6], elimination[7], elimination[7], elimination[8]
    for i in range(3):
        for k in range(3):
            a += P[i, 0] * K[i, k] * P[k, 0]
            b += P[i, 0] * K[i, k] * P[k, 1]
            c += P[i, 1] * K[i, k] * P[k, 0]
            d += P[i, 1] * K[i, k] * P[k, 1]
    det = a * d - b * c
    T = f.yielding
    for i in range(3):
        for k in range(3):
            T[i, k] = 1.0 if i == k else 0.0
    if det > 0.0:
        for k in range(3):
            along = radial = 0.0
            for q in range(3):
                along += P[q, 0] * K[q, k]
                radial += P[q, 1] * K[q, k]
            x, y = (d * along - b * radial) / det, (a * radial - c * along) / det
            for i in range(3):
                T[i, k] -= P[i, 0] * x + P[i, 1] * y
    for k in range(3):
        heat = loss = 0.0
        for q in range(3):
            heat += f.heat[j, 3 + q] * T[q, k]
            loss += f.loss[j, 3 + q] * T[q, k]
        f.side[k], f.side[3 + k] = heat, loss
    for k in range(3):
        f.heat[j, 3 + k], f.loss[j, 3 + k] = f.side[k], f.side[3 + k]
        for i in range(3):
            value = 0.0
            for q in range(3):
                value += K[i, q] * T[q, k]
            f.K[j, i, k] = value


@jit
def factorise(shift, y, run, b, places, f):
    """Factor `shift - J` for the state of the last call of motion_rates and ball_blocks.

    Returns
    -------
    bool
        False where the matrix is singular.
    """
    n = run.D.size
    cage, c = run.cage, b.cage
    border = f.border
    border[:, :] = 0.0
    if cage.present:
        f.r[:] = b.r
        f.arm[:, :] = c.arm
        f.reach[:, :] = c.reach
        f.K[:, :, :] = c.K
        f.C[:, :, :] = c.C
        f.heat[:, :] = c.heat
        f.loss[:, :] = c.loss
        for k in range(3):
            border[k, k] = border[3 + k, 3 + k] = shift
            border[6 + k, 6 + k] = border[9 + k, 9 + k] = shift
            border[k, 3 + k] = -1.0
            for i in range(3):
                border[6 + k, 9 + i] = -inverse_inertia(cage, c.R, k, i)
        for edge in range(2):
            f.touching[n + edge] = c.normal[n + edge] > 0.0
            if f.touching[n + edge]:
                cage_point(cage, c.R, c.arm[n + edge], f.Z_v, f.Z_x, f.gain_z)
                force = f.force_z
                for i in range(3):
                    for k in range(CAGE):
                        value = 0.0
                        for q in range(3):
                            value += c.K[n + edge, i, q] * f.Z_x[q, k]
                            value += c.C[n + edge, i, q] * f.Z_v[q, k]
                        force[i, k] = value
                for i in range(CAGE):
                    for k in range(CAGE):
                        for q in range(3):
                            border[i, k] += f.gain_z[i, q] * force[q, k]
    for j in range(n):
        A = f.matrix
        for u in range(4):
            for v in range(4):
                A[u, v] = -b.blocks[j, u, v]
            A[u, u] += shift
            A[u, 4] = 0.0
            A[4, u] = 0.0
        A[4, 3] = -1.0
        A[4, 4] = shift
        touching = cage.present and c.normal[j] > 0.0
        f.touching[j] = touching
        if touching:
            psi = y[BALL * j + 4]
            sp, cp = math.sin(psi), math.cos(psi)
            p0, p1, p2 = c.reach[j, 0], c.reach[j, 1], c.reach[j, 2]
            B_v, B_x, G = f.B_v, f.B_x, f.gain_b
            B_v[:, :] = 0.0
            B_x[:, :] = 0.0
            # w x p by the azimuth axes x = (1,0,0), y = (0,c,s), z = (0,-s,c).
            B_v[1, 0], B_v[2, 0] = -p2, p1
            B_v[0, 1], B_v[1, 1], B_v[2, 1] = cp * p2 - sp * p1, sp * p0, -cp * p0
            B_v[0, 2], B_v[1, 2], B_v[2, 2] = -sp * p2 - cp * p1, cp * p0, sp * p0
            B_v[1, 3], B_v[2, 3] = -b.r[j] * cp, -b.r[j] * sp
            B_x[1, 4], B_x[2, 4] = -b.r[j] * cp, -b.r[j] * sp
            for q in range(3):
                for u in range(3):
                    G[u, q] = B_v[q, u] / run.inertia[j]
                G[3, q] = B_v[q, 3] / (run.mass[j] * b.r[j] * b.r[j])
                G[4, q] = 0.0
            cage_point(cage, c.R, c.arm[j], f.Z_v, f.Z_x, f.gain_z)
            yield_to_contact(b.s.elimination[j], c.K[j], sp, cp, f, j)
            K = f.K[j]
            for i in range(3):
                for k in range(5):
                    value = 0.0
                    for q in range(3):
                        value += K[i, q] * B_x[q, k] + c.C[j, i, q] * B_v[q, k]
                    f.force_b[i, k] = value
                for k in range(CAGE):
                    value = 0.0
                    for q in range(3):
                        value += K[i, q] * f.Z_x[q, k] + c.C[j, i, q] * f.Z_v[q, k]
                    f.force_z[i, k] = value
            for u in range(5):
                for k in range(5):
                    for q in range(3):
                        A[u, k] += G[u, q] * f.force_b[q, k]
            for i in range(CAGE):
                for k in range(CAGE):
                    for q in range(3):
                        border[i, k] += f.gain_z[i, q] * f.force_z[q, k]
                for k in range(5):
                    value = 0.0
                    for q in range(3):
                        value -= f.gain_z[i, q] * f.force_b[q, k]
                    f.back[j, i, k] = value
        if not invert(A, 5, f.inverse[j]):
            return False
        if touching:
            # across = inverse (-G force_z); border -= back across.
            for u in range(5):
                for k in range(CAGE):
                    value = 0.0
                    for p in range(5):
                        coupling = 0.0
                        for q in range(3):
                            coupling -= f.gain_b[p, q] * f.force_z[q, k]
                        value += f.inverse[j, u, p] * coupling
                    f.across[j, u, k] = value
            for i in range(CAGE):
                for k in range(CAGE):
                    for u in range(5):
                        border[i, k] -= f.back[j, i, u] * f.across[j, u, k]
    if cage.present:
        f.matrix[:, :] = border
        return invert(f.matrix, CAGE, border)
    return True


@jit
def solve(side, U, run, places, f):
    """Solve with the factors: U of balls and cage from the right-hand side `side`."""
    n = run.D.size
    z = places.cage
    if run.cage.present:
        for i in range(CAGE):
            f.side[i] = side[z + i]
        for j in range(n):
            if f.touching[j]:
                for u in range(5):
                    value = 0.0
                    for k in range(5):
                        value += f.inverse[j, u, k] * side[BALL * j + k]
                    for i in range(CAGE):
                        f.side[i] -= f.back[j, i, u] * value
        for i in range(CAGE):
            value = 0.0
            for k in range(CAGE):
                value += f.border[i, k] * f.side[k]
            U[z + i] = value
    for j in range(n):
        touching = f.touching[j]
        for u in range(5):
            value = 0.0
            for k in range(5):
                value += f.inverse[j, u, k] * side[BALL * j + k]
            if touching:
                for k in range(CAGE):
                    value -= f.across[j, u, k] * U[z + k]
            U[BALL * j + u] = value


@jit
def add_cage_powers(U, side, y, run, b, places, f):
    """Add to `side` what a step U of balls and cage makes of the cage's heats, torques and work.

    For the contacts of the last call of `factorise`: the integrals' rows of the same matrix.
    """
    if not run.cage.present:
        return
    n = run.D.size
    c = b.cage
    z = places.cage
    land_speed = run.motion.omega_i if run.cage.land == INNER_LAND else run.motion.omega_o
    for j in range(n + 2):
        if not f.touching[j]:
            continue
        a0, a1, a2 = f.arm[j, 0], f.arm[j, 1], f.arm[j, 2]
        d0, d1, d2 = cross(U[z + 6], U[z + 7], U[z + 8], a0, a1, a2)
        w0 = w1 = w2 = 0.0
        for k in range(3):
            w0 += inverse_inertia(run.cage, c.R, 0, k) * U[z + 9 + k]
            w1 += inverse_inertia(run.cage, c.R, 1, k) * U[z + 9 + k]
            w2 += inverse_inertia(run.cage, c.R, 2, k) * U[z + 9 + k]
        u0, u1, u2 = cross(w0, w1, w2, a0, a1, a2)
        d0, d1, d2 = d0 + U[z], d1 + U[z + 1], d2 + U[z + 2]
        u0, u1, u2 = u0 + U[z + 3], u1 + U[z + 4], u2 + U[z + 5]
        if j < n:
            i = BALL * j
            sp, cp = math.sin(y[i + 4]), math.cos(y[i + 4])
            w0, w1, w2 = U[i], U[i + 1] * cp - U[i + 2] * sp, U[i + 1] * sp + U[i + 2] * cp
            p0, p1, p2 = cross(w0, w1, w2, f.reach[j, 0], f.reach[j, 1], f.reach[j, 2])
            r = f.r[j]
            u0, u1, u2 = u0 - p0, u1 - p1 + r * cp * U[i + 3], u2 - p2 + r * sp * U[i + 3]
            d1, d2 = d1 + r * cp * U[i + 4], d2 + r * sp * U[i + 4]
            sign = -1.0
        else:
            # A land does not move with the state: the motion is that of the land against the cage.
            u0, u1, u2, d0, d1, d2 = -u0, -u1, -u2, -d0, -d1, -d2
            sign = 1.0
        u = (u0, u1, u2)
        d = (d0, d1, d2)
        h1 = h2 = 0.0
        for k in range(3):
            h1 += f.C[j, 1, k] * u[k] + f.K[j, 1, k] * d[k]
            h2 += f.C[j, 2, k] * u[k] + f.K[j, 2, k] * d[k]
            side[places.cage_heat] += f.heat[j, k] * u[k] + f.heat[j, 3 + k] * d[k]
            side[places.damping] += f.loss[j, k] * u[k] + f.loss[j, 3 + k] * d[k]
        torque = sign * ((y[z + 1] + a1) * h2 - (y[z + 2] + a2) * h1)
        if j < n:
            side[places.pocket_torque] += torque
            i = BALL * j
            tangential = h1 * math.cos(y[i + 4]) + h2 * math.sin(y[i + 4])
            side[places.turning] -= 2.0 * f.r[j] * y[i + 3] * tangential
        else:
            side[places.land_torque] += torque
            side[places.shaft] += land_speed * torque
