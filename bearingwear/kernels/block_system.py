"""Linear systems of the implicit integrator: one block a ball, bordered by the cage.

The matrix stands for `shift - J`, with the loads held. The balls are eliminated one by one; the
twelve states of the cage remain, with the Schur complement of the balls' blocks.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.cage import INNER_LAND, inverse_inertia
from bearingwear.kernels.compile import jit
from bearingwear.kernels.jacobian import ball_point, cage_point, condense_ball_centre
from bearingwear.kernels.linear import copy
from bearingwear.kernels.state import (
    BALL,
    CAGE,
    CENTRE,
    MOMENTUM,
    OMEGA,
    PSI,
    ROTATION,
    VELOCITY,
    W_X,
    W_Y,
    W_Z,
)
from bearingwear.kernels.vectors import cross, minus, plus, triple


class BlockSystem(NamedTuple):
    """Factors of the matrix, the contacts of the cage when it was factored, and buffers."""

    inverse: np.ndarray  # (n, 5, 5) inverses of the balls' blocks
    inverse_ball_cage: np.ndarray  # (n, 5, 12) those times the coupling of a ball to the cage
    cage_ball: np.ndarray  # (n, 12, 5) coupling of the cage to a ball
    schur: np.ndarray  # (12, 12) inverse of the Schur complement
    touching: np.ndarray  # (n + 2,) pockets and land edges, see cage_law.CageBuffers
    r: np.ndarray  # (n,) orbit radii [m]
    arm: np.ndarray  # (n + 2, 3)
    reach: np.ndarray  # (n, 3)
    K: np.ndarray  # (n + 2, 3, 3) ball centres condensed
    C: np.ndarray  # (n + 2, 3, 3)
    heat: np.ndarray  # (n + 2, 6)
    loss: np.ndarray  # (n + 2, 6)
    matrix: np.ndarray  # (12, 12) buffer, as are all that follow
    side: np.ndarray  # (12,)
    ball_cage: np.ndarray  # (5, 12)
    B_v: np.ndarray  # (3, 5) see jacobian.ball_point
    B_x: np.ndarray  # (3, 5)
    ball_gain: np.ndarray  # (5, 3)
    ball_force: np.ndarray  # (3, 5) derivative of the force on the ball by its state
    Z_v: np.ndarray  # (3, 12) see jacobian.cage_point
    Z_x: np.ndarray  # (3, 12)
    cage_gain: np.ndarray  # (12, 3)
    cage_force: np.ndarray  # (3, 12) derivative of the force on the cage by its state


@jit
def block_system(n):
    """Buffers for n balls."""
    return BlockSystem(
        inverse=np.zeros((n, 5, 5)),
        inverse_ball_cage=np.zeros((n, 5, 12)),
        cage_ball=np.zeros((n, 12, 5)),
        schur=np.zeros((12, 12)),
        touching=np.zeros(n + 2, dtype=np.bool_),
        r=np.zeros(n),
        arm=np.zeros((n + 2, 3)),
        reach=np.zeros((n, 3)),
        K=np.zeros((n + 2, 3, 3)),
        C=np.zeros((n + 2, 3, 3)),
        heat=np.zeros((n + 2, 6)),
        loss=np.zeros((n + 2, 6)),
        matrix=np.zeros((12, 12)),
        side=np.zeros(12),
        ball_cage=np.zeros((5, 12)),
        B_v=np.zeros((3, 5)),
        B_x=np.zeros((3, 5)),
        ball_gain=np.zeros((5, 3)),
        ball_force=np.zeros((3, 5)),
        Z_v=np.zeros((3, 12)),
        Z_x=np.zeros((3, 12)),
        cage_gain=np.zeros((12, 3)),
        cage_force=np.zeros((3, 12)),
    )


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


@jit(forceinline=True)
def add_product(A, B, rows, inner, columns, out):
    """out += A B of these sizes."""
    for i in range(rows):
        for k in range(columns):
            for q in range(inner):
                out[i, k] += A[i, q] * B[q, k]


@jit(forceinline=True)
def subtract_product(A, B, rows, inner, columns, out):
    """out -= A B of these sizes."""
    for i in range(rows):
        for k in range(columns):
            for q in range(inner):
                out[i, k] -= A[i, q] * B[q, k]


@jit(forceinline=True)
def contact_slope(K, C, X, V, columns, out):
    """Derivative K X + C V (3, columns) of a contact's force by the states behind it."""
    for i in range(3):
        for k in range(columns):
            value = 0.0
            for q in range(3):
                value += K[i, q] * X[q, k] + C[i, q] * V[q, k]
            out[i, k] = value


@jit
def keep_contacts(balls, contacts, system):
    """Keep what `add_cage_powers` needs of the contacts while the stages move on."""
    copy(balls.r, system.r)
    copy(contacts.arm, system.arm)
    copy(contacts.reach, system.reach)
    copy(contacts.K, system.K)
    copy(contacts.C, system.C)
    copy(contacts.heat, system.heat)
    copy(contacts.loss, system.loss)


@jit
def free_cage_block(shift, cage, R, out):
    """Block of a cage that nothing touches."""
    out[:, :] = 0.0
    for k in range(3):
        for begin in (CENTRE, VELOCITY, ROTATION, MOMENTUM):
            out[begin + k, begin + k] = shift
        out[CENTRE + k, VELOCITY + k] = -1.0
        for i in range(3):
            out[ROTATION + k, MOMENTUM + i] = -inverse_inertia(cage, R, k, i)


@jit
def add_land_edge_block(cage, contacts, place, system):
    """Add a closed edge of the land to the block of the cage."""
    K, C, Z_x, Z_v = contacts.K[place], contacts.C[place], system.Z_x, system.Z_v
    cage_point(cage, contacts.R, contacts.arm[place], Z_v, Z_x, system.cage_gain)
    for i in range(3):
        for k in range(CAGE):
            value = 0.0
            for q in range(3):
                value += K[i, q] * Z_x[q, k]
                value += C[i, q] * Z_v[q, k]
            system.cage_force[i, k] = value
    add_product(system.cage_gain, system.cage_force, CAGE, 3, CAGE, system.schur)


@jit
def free_ball_block(shift, block, out):
    """Block of a ball that does not touch its pocket."""
    for u in range(4):
        for v in range(4):
            out[u, v] = -block[u, v]
        out[u, u] += shift
        out[u, PSI] = 0.0
        out[PSI, u] = 0.0
    out[PSI, OMEGA] = -1.0
    out[PSI, PSI] = shift


@jit
def add_pocket_blocks(y, bearing, balls, contacts, j, system):
    """Add a closed pocket to the blocks of its ball and the cage, and couple the two."""
    psi = y[BALL * j + PSI]
    sp, cp = math.sin(psi), math.cos(psi)
    B_v, B_x, Z_v, Z_x = system.B_v, system.B_x, system.Z_v, system.Z_x
    ball_gain, cage_gain = system.ball_gain, system.cage_gain
    K, C = system.K[j], contacts.C[j]
    ball_point(bearing, j, balls.r[j], contacts.reach[j], sp, cp, B_v, B_x, ball_gain)
    cage_point(bearing.cage, contacts.R, contacts.arm[j], Z_v, Z_x, cage_gain)
    condense_ball_centre(balls.condensed[j], contacts, j, sp, cp, K, system.heat[j], system.loss[j])
    contact_slope(K, C, B_x, B_v, BALL, system.ball_force)
    contact_slope(K, C, Z_x, Z_v, CAGE, system.cage_force)
    add_product(ball_gain, system.ball_force, BALL, 3, BALL, system.matrix)
    add_product(cage_gain, system.cage_force, CAGE, 3, CAGE, system.schur)
    # The force on the cage is opposite to that on the ball.
    system.cage_ball[j, :, :] = 0.0
    subtract_product(cage_gain, system.ball_force, CAGE, 3, BALL, system.cage_ball[j])
    system.ball_cage[:, :] = 0.0
    subtract_product(ball_gain, system.cage_force, BALL, 3, CAGE, system.ball_cage)


@jit
def eliminate_ball(j, system):
    """Take a ball whose block is inverted out of the block of the cage."""
    product = system.inverse_ball_cage[j]
    product[:, :] = 0.0
    add_product(system.inverse[j], system.ball_cage, BALL, BALL, CAGE, product)
    subtract_product(system.cage_ball[j], product, CAGE, BALL, CAGE, system.schur)


@jit
def factorise(shift, y, bearing, buf, system):
    """Factor `shift - J` for the state of the last call of state_rates and ball_blocks.

    Returns
    -------
    bool
        False where the matrix is singular.
    """
    n, cage, contacts = bearing.D.size, bearing.cage, buf.cage
    if cage.present:
        keep_contacts(buf.balls, contacts, system)
        free_cage_block(shift, cage, contacts.R, system.schur)
        for place in range(n, n + 2):
            system.touching[place] = contacts.normal[place] > 0.0
            if system.touching[place]:
                add_land_edge_block(cage, contacts, place, system)
    for j in range(n):
        free_ball_block(shift, buf.blocks[j], system.matrix)
        touching = cage.present and contacts.normal[j] > 0.0
        system.touching[j] = touching
        if touching:
            add_pocket_blocks(y, bearing, buf.balls, contacts, j, system)
        if not invert(system.matrix, BALL, system.inverse[j]):
            return False
        if touching:
            eliminate_ball(j, system)
    if cage.present:
        copy(system.schur, system.matrix)
        return invert(system.matrix, CAGE, system.schur)
    return True


@jit
def solve_factorised(side, U, bearing, system):
    """Solve with the factors: U of balls and cage from the right-hand side `side`."""
    n = bearing.D.size
    z = bearing.layout.cage
    if bearing.cage.present:
        for i in range(CAGE):
            system.side[i] = side[z + i]
        for j in range(n):
            if system.touching[j]:
                for u in range(BALL):
                    value = 0.0
                    for k in range(BALL):
                        value += system.inverse[j, u, k] * side[BALL * j + k]
                    for i in range(CAGE):
                        system.side[i] -= system.cage_ball[j, i, u] * value
        for i in range(CAGE):
            value = 0.0
            for k in range(CAGE):
                value += system.schur[i, k] * system.side[k]
            U[z + i] = value
    for j in range(n):
        touching = system.touching[j]
        for u in range(BALL):
            value = 0.0
            for k in range(BALL):
                value += system.inverse[j, u, k] * side[BALL * j + k]
            if touching:
                for k in range(CAGE):
                    value -= system.inverse_ball_cage[j, u, k] * U[z + k]
            U[BALL * j + u] = value


@jit(forceinline=True)
def cage_point_step(U, bearing, R, j, system):
    """Change of velocity and place, in a step U, of the cage's point at contact j."""
    z, cage = bearing.layout.cage, bearing.cage
    arm = triple(system.arm[j], 0)
    w0 = w1 = w2 = 0.0
    for k in range(3):
        w0 += inverse_inertia(cage, R, 0, k) * U[z + MOMENTUM + k]
        w1 += inverse_inertia(cage, R, 1, k) * U[z + MOMENTUM + k]
        w2 += inverse_inertia(cage, R, 2, k) * U[z + MOMENTUM + k]
    place = plus(cross(triple(U, z + ROTATION), arm), triple(U, z + CENTRE))
    return plus(cross((w0, w1, w2), arm), triple(U, z + VELOCITY)), place


@jit(forceinline=True)
def over_ball_step(U, j, sin_psi, cos_psi, velocity, place, system):
    """Those changes less the ball's at its contact point."""
    i, r, sp, cp = BALL * j, system.r[j], sin_psi, cos_psi
    w_y, w_z, Omega, psi = U[i + W_Y], U[i + W_Z], U[i + OMEGA], U[i + PSI]
    w = (U[i + W_X], w_y * cp - w_z * sp, w_y * sp + w_z * cp)
    u = minus(velocity, cross(w, triple(system.reach[j], 0)))
    velocity = (u[0], u[1] + r * cp * Omega, u[2] + r * sp * Omega)
    return velocity, (place[0], place[1] + r * cp * psi, place[2] + r * sp * psi)


@jit
def add_cage_powers(U, side, y, bearing, buf, system):
    """Add to `side` what a step U of balls and cage makes of the cage's heats, torques and work.

    For the contacts of the last call of `factorise`: the integrals' rows of the same matrix.
    """
    if not bearing.cage.present:
        return
    n, layout, m = bearing.D.size, bearing.layout, bearing.op
    y_cage, z_cage = y[layout.cage + CENTRE + 1], y[layout.cage + CENTRE + 2]
    land_speed = m.omega_i if bearing.cage.land == INNER_LAND else m.omega_o
    for j in range(n + 2):
        if not system.touching[j]:
            continue
        u, d = cage_point_step(U, bearing, buf.cage.R, j, system)
        in_pocket = j < n
        sp = cp = 0.0
        if in_pocket:
            psi = y[BALL * j + PSI]
            sp, cp = math.sin(psi), math.cos(psi)
            u, d = over_ball_step(U, j, sp, cp, u, d, system)
            sign = -1.0
        else:
            # A land does not move with the state: the motion is that of the land against the cage.
            u, d = (-u[0], -u[1], -u[2]), (-d[0], -d[1], -d[2])
            sign = 1.0
        h1 = h2 = 0.0
        for k in range(3):
            h1 += system.C[j, 1, k] * u[k] + system.K[j, 1, k] * d[k]
            h2 += system.C[j, 2, k] * u[k] + system.K[j, 2, k] * d[k]
            side[layout.cage_heat] += system.heat[j, k] * u[k] + system.heat[j, 3 + k] * d[k]
            side[layout.damping] += system.loss[j, k] * u[k] + system.loss[j, 3 + k] * d[k]
        arm = system.arm[j]
        torque = sign * ((y_cage + arm[1]) * h2 - (z_cage + arm[2]) * h1)
        if in_pocket:
            side[layout.pocket_torque] += torque
            side[layout.turning] -= 2.0 * system.r[j] * y[BALL * j + OMEGA] * (h1 * cp + h2 * sp)
        else:
            side[layout.land_torque] += torque
            side[layout.shaft] += land_speed * torque
