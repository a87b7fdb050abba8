"""Linear systems of the implicit integrator: one block a ball, bordered by cage and race.

The unknowns of a stage are the steps of all states and, beside them, of the ball centres and the
inner race: the balance of normal forces is solved with the motion. Azimuths, and place and rotation
of the cage, follow from speeds and are eliminated first. Then the balls are eliminated one by one,
each with the two coordinates of its centre. Velocity and momentum of the cage and the place of the
race remain.
"""

from typing import NamedTuple

import numpy as np

from bearingwear.kernels.cage.body import INNER_LAND, inverse_inertia
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.dynamic.jacobian import (
    INNER_1,
    INNER_2,
    MOTION,
    OUTER_1,
    OUTER_2,
    ball_blocks,
)
from bearingwear.kernels.dynamic.quasistatic import inner_force
from bearingwear.kernels.layout import (
    BALL,
    OMEGA,
    W_Y,
    W_Z,
)
from bearingwear.kernels.linear import copy, factor_in_place

# Unknowns of a ball: the steps of its centre (axial, radial), then of w_x, w_y, w_z, Omega.
ALGEBRAIC, LOCAL = 2, 6
SPIN_Y, SPIN_Z, ORBIT_STEP = ALGEBRAIC + W_Y, ALGEBRAIC + W_Z, ALGEBRAIC + OMEGA
# What it yields to: the groove's shift (axial, radial), the force of its pocket.
GROOVE_SHIFT, FORCE, BALL_INPUTS = 0, 2, 5
# What it returns: the inner race's force (axial, radial, along the orbit's y), the pocket's.
RACE, POCKET, BALL_OUTPUTS = 0, 3, 6
CAGE_BORDER = 6  # velocity and momentum of the cage
BORDER = CAGE_BORDER + 3  # and the race


class BlockSystem(NamedTuple):
    """Linearised contacts where a step begins, factors of the matrix, buffers."""

    touching: np.ndarray  # (n + 2,) pockets and land edges
    r: np.ndarray  # (n,) orbit radii [m]
    turn: np.ndarray  # (n, 2) sine and cosine of the azimuths
    groove_turn: np.ndarray  # (n, 2) derivative of the groove distances by the azimuth [m]
    radial: np.ndarray  # (n,) radial force of the inner race [N]
    inertia: np.ndarray  # (3, 3) inverse, of the cage
    arm: np.ndarray  # (n + 2, 3), as all to `loss` see cage_law.CageBuffers
    hold: np.ndarray  # (n + 2, 3)
    reach: np.ndarray  # (n, 3)
    K: np.ndarray  # (n + 2, 3, 3)
    C: np.ndarray  # (n + 2, 3, 3)
    heat: np.ndarray  # (n + 2, 6)
    loss: np.ndarray  # (n + 2, 6)
    inverse: np.ndarray  # (n, LOCAL, LOCAL) of the balls' blocks
    gain: np.ndarray  # (n, LOCAL, BALL_INPUTS) what groove and pocket do to a ball's equations
    response: np.ndarray  # (n, LOCAL, BALL_INPUTS) and to its unknowns
    reading: np.ndarray  # (n, BALL_OUTPUTS, LOCAL) forces on race and cage by its unknowns
    passing: np.ndarray  # (n, BALL_OUTPUTS, BALL_INPUTS) and groove and pocket, the ball eliminated
    by_azimuth: np.ndarray  # (n, LOCAL) of a ball's equations
    race_by_azimuth: np.ndarray  # (n, 3) of the inner race's force on it
    cage_slope: np.ndarray  # (n + 2, 3, CAGE_BORDER) force on a partner by the cage's unknowns
    border: np.ndarray  # (BORDER, BORDER) factored
    pivots: np.ndarray  # (BORDER,)
    matrix: np.ndarray  # (LOCAL, LOCAL) buffer, as are all that follow
    rows: np.ndarray  # (3, BORDER)
    side: np.ndarray  # (BORDER,)
    alone: np.ndarray  # (n, LOCAL) unknowns of a ball whose race and cage stand still
    known: np.ndarray  # (n + 2, 3) force of a contact that follows from places known beforehand


def block_system(n):
    """Buffers for n balls."""
    return BlockSystem(
        touching=np.zeros(n + 2, dtype=np.bool_),
        r=np.zeros(n),
        turn=np.zeros((n, 2)),
        groove_turn=np.zeros((n, 2)),
        radial=np.zeros(n),
        inertia=np.zeros((3, 3)),
        arm=np.zeros((n + 2, 3)),
        hold=np.zeros((n + 2, 3)),
        reach=np.zeros((n, 3)),
        K=np.zeros((n + 2, 3, 3)),
        C=np.zeros((n + 2, 3, 3)),
        heat=np.zeros((n + 2, 6)),
        loss=np.zeros((n + 2, 6)),
        inverse=np.zeros((n, LOCAL, LOCAL)),
        gain=np.zeros((n, LOCAL, BALL_INPUTS)),
        response=np.zeros((n, LOCAL, BALL_INPUTS)),
        reading=np.zeros((n, BALL_OUTPUTS, LOCAL)),
        passing=np.zeros((n, BALL_OUTPUTS, BALL_INPUTS)),
        by_azimuth=np.zeros((n, LOCAL)),
        race_by_azimuth=np.zeros((n, 3)),
        cage_slope=np.zeros((n + 2, 3, CAGE_BORDER)),
        border=np.zeros((BORDER, BORDER)),
        pivots=np.zeros(BORDER, np.int64),
        matrix=np.zeros((LOCAL, LOCAL)),
        rows=np.zeros((3, BORDER)),
        side=np.zeros(BORDER),
        alone=np.zeros((n, LOCAL)),
        known=np.zeros((n + 2, 3)),
    )


@jit
def linearise(y, bearing, buf, system):
    """Keep what `factorise` needs of the state and places of the last `rates_here`."""
    n, balls, contacts = bearing.D.size, buf.balls, buf.cage
    ball_blocks(y, bearing, buf)
    lean = bearing.tilt * bearing.g.R_i
    for j in range(n):
        sp, cp = balls.turn[j, 0], balls.turn[j, 1]
        system.turn[j, 0], system.turn[j, 1], system.r[j] = sp, cp, balls.r[j]
        system.groove_turn[j, 0] = -lean * sp
        system.groove_turn[j, 1] = -balls.delta[2] * sp - balls.delta[1] * cp
        _, system.radial[j] = inner_force(balls, j)
    if not bearing.cage.present:
        return
    for i in range(3):
        for k in range(3):
            system.inertia[i, k] = inverse_inertia(bearing.cage, contacts.R, i, k)
    for j in range(n + 2):
        touching = contacts.normal[j] > 0.0
        system.touching[j] = touching
        if touching:
            copy(contacts.arm[j], system.arm[j])
            copy(contacts.hold[j], system.hold[j])
            copy(contacts.K[j], system.K[j])
            copy(contacts.C[j], system.C[j])
            copy(contacts.heat[j], system.heat[j])
            copy(contacts.loss[j], system.loss[j])
            if j < n:
                copy(contacts.reach[j], system.reach[j])


@jit
def invert_in_place(A):
    """Inverse of A (LOCAL, LOCAL) by Gauss-Jordan on its diagonal; False where a pivot is 0.

    The row of the pivot is held in registers: it could be any other one for all that LLVM knows.
    """
    for k in range(LOCAL):
        if not abs(A[k, k]) > 0.0:
            return False
        pivot = 1.0 / A[k, k]
        A[k, k] = 1.0
        p0, p1, p2 = pivot * A[k, 0], pivot * A[k, 1], pivot * A[k, 2]
        p3, p4, p5 = pivot * A[k, 3], pivot * A[k, 4], pivot * A[k, 5]
        for i in range(LOCAL):
            row, factor = A[i], A[i, k]
            if i != k:
                row[k] = 0.0
                row[0], row[1], row[2] = (
                    row[0] - factor * p0, row[1] - factor * p1, row[2] - factor * p2,
                )  # fmt: skip
                row[3], row[4], row[5] = (
                    row[3] - factor * p3, row[4] - factor * p4, row[5] - factor * p5,
                )  # fmt: skip
        row = A[k]
        row[0], row[1], row[2], row[3], row[4], row[5] = p0, p1, p2, p3, p4, p5
    return True


@jit
def multiply(A, B, rows, inner, columns, out):
    """out = A B of these sizes."""
    for i in range(rows):
        for k in range(columns):
            value = 0.0
            for q in range(inner):
                value += A[i, q] * B[q, k]
            out[i, k] = value


@jit
def race_block(shift, y, bearing, buf, j, system):
    """Block of a ball between its races, into `system`."""
    block, inner, A = buf.blocks[j], buf.inner[j], system.matrix
    gain, reading, inverse = system.gain[j], system.reading[j], system.inverse[j]
    a1, a2 = system.groove_turn[j, 0], system.groove_turn[j, 1]
    spin, orbit = 1.0 / bearing.inertia[j], -1.0 / (bearing.mass[j] * system.r[j])
    for p in range(LOCAL):
        scale = 1.0 if p < ALGEBRAIC else (orbit if p == ORBIT_STEP else spin)
        y1, y2 = scale * block[p, INNER_1], scale * block[p, INNER_2]
        gain[p, GROOVE_SHIFT], gain[p, GROOVE_SHIFT + 1] = y1, y2
        turned = y1 * a1 + y2 * a2
        system.by_azimuth[j, p] = turned
        A[p, 0], A[p, 1] = y1 - scale * block[p, OUTER_1], y2 - scale * block[p, OUTER_2]
        for v in range(4):
            A[p, ALGEBRAIC + v] = -scale * block[p, MOTION + v]
        A[p, ORBIT_STEP] -= turned / shift
        if p >= ALGEBRAIC:
            A[p, p] += shift
    i = BALL * j
    Omega = y[i + OMEGA]
    A[SPIN_Y, SPIN_Z] -= Omega
    A[SPIN_Y, ORBIT_STEP] -= y[i + W_Z]
    A[SPIN_Z, SPIN_Y] += Omega
    A[SPIN_Z, ORBIT_STEP] += y[i + W_Y]
    for p in range(2):
        turned = inner[p, INNER_1] * a1 + inner[p, INNER_2] * a2
        system.race_by_azimuth[j, p] = turned
        reading[p, 0] = inner[p, OUTER_1] - inner[p, INNER_1]
        reading[p, 1] = inner[p, OUTER_2] - inner[p, INNER_2]
        for v in range(4):
            reading[p, ALGEBRAIC + v] = inner[p, MOTION + v]
        reading[p, ORBIT_STEP] += turned / shift
    # The force turns with the ball.
    system.race_by_azimuth[j, 2] = -system.radial[j]
    for v in range(LOCAL):
        reading[2, v] = 0.0
    reading[2, ORBIT_STEP] = -system.radial[j] / shift
    copy(A, inverse)


@jit
def pocket_block(shift, y, bearing, j, system):
    """Add the closed pocket of ball j to its block."""
    sp, cp, r = system.turn[j, 0], system.turn[j, 1], system.r[j]
    K, C, p = system.K[j], system.C[j], system.reach[j]
    gain, slope, Omega = system.gain[j], system.reading[j], y[BALL * j + OMEGA]
    spin, orbit = 1.0 / bearing.inertia[j], -1.0 / (bearing.mass[j] * r)
    # Velocity of the contact point by the ball's w: axes x = (1,0,0), y = (0,c,s), z = (0,-s,c).
    w_x = (0.0, -p[2], p[1])
    w_y = (cp * p[2] - sp * p[1], sp * p[0], -cp * p[0])
    w_z = (-sp * p[2] - cp * p[1], cp * p[0], sp * p[0])
    axial, along, radial = (1.0, 0.0, 0.0), (0.0, cp, sp), (0.0, -sp, cp)
    for q in range(3):
        gain[0, FORCE + q] = axial[q]
        gain[1, FORCE + q] = radial[q]
        gain[2, FORCE + q] = spin * w_x[q]
        gain[3, FORCE + q] = spin * w_y[q]
        gain[4, FORCE + q] = spin * w_z[q]
        gain[5, FORCE + q] = orbit * along[q]
    for i in range(3):
        k_axial = k_along = k_radial = c_along = c_x = c_y = c_z = 0.0
        for q in range(3):
            k_axial += K[i, q] * axial[q]
            k_along += K[i, q] * along[q]
            k_radial += K[i, q] * radial[q]
            c_along += C[i, q] * along[q]
            c_x += C[i, q] * w_x[q]
            c_y += C[i, q] * w_y[q]
            c_z += C[i, q] * w_z[q]
        row = slope[POCKET + i]
        row[0], row[1] = -k_axial, Omega * c_along - k_radial
        row[2], row[3], row[4] = -c_x, -c_y, -c_z
        row[5] = r * (c_along + k_along / shift)
    A = system.inverse[j]
    for u in range(LOCAL):
        for v in range(LOCAL):
            value = 0.0
            for q in range(3):
                value += gain[u, FORCE + q] * slope[POCKET + q, v]
            A[u, v] -= value


@jit
def slope_by_cage(shift, j, system):
    """Fill the derivative of the force of contact j on its partner by the cage's unknowns."""
    out = system.cage_slope[j]
    for i in range(3):
        c, k = system.C[j, i], system.K[j, i]
        arm, hold, inertia = system.arm[j], system.hold[j], system.inertia
        out[i, 0], out[i, 1], out[i, 2] = (
            k[0] / shift + c[0],
            k[1] / shift + c[1],
            k[2] / shift + c[2],
        )
        # By the cage's angular velocity, which moves points by omega x arm.
        w0 = c[2] * arm[1] - c[1] * arm[2] + (k[2] * hold[1] - k[1] * hold[2]) / shift
        w1 = c[0] * arm[2] - c[2] * arm[0] + (k[0] * hold[2] - k[2] * hold[0]) / shift
        w2 = c[1] * arm[0] - c[0] * arm[1] + (k[1] * hold[0] - k[0] * hold[1]) / shift
        for q in range(3):
            out[i, 3 + q] = w0 * inertia[0, q] + w1 * inertia[1, q] + w2 * inertia[2, q]


@jit
def add_cage_rows(bearing, arm, rows, border):
    """Apply the opposite of the force `rows` (3, BORDER) on a partner to the cage."""
    for v in range(BORDER):
        h0, h1, h2 = rows[0, v], rows[1, v], rows[2, v]
        border[0, v] += h0 / bearing.cage.mass
        border[1, v] += h1 / bearing.cage.mass
        border[2, v] += h2 / bearing.cage.mass
        border[3, v] += arm[1] * h2 - arm[2] * h1
        border[4, v] += arm[2] * h0 - arm[0] * h2
        border[5, v] += arm[0] * h1 - arm[1] * h0


@jit
def add_ball_to_border(bearing, j, system):
    """Add the Schur complement of an eliminated ball to the equations of race and cage."""
    sp, cp = system.turn[j, 0], system.turn[j, 1]
    S, rows, border, first = system.passing[j], system.rows, system.border, CAGE_BORDER
    touching = system.touching[j]
    for begin in (RACE, POCKET):
        if begin == POCKET and not touching:
            continue
        for i in range(3):
            p = begin + i
            rows[i, first] = S[p, 0]
            rows[i, first + 1], rows[i, first + 2] = -sp * S[p, 1], cp * S[p, 1]
            for v in range(CAGE_BORDER):
                value = 0.0
                if touching:
                    for q in range(3):
                        value += S[p, FORCE + q] * system.cage_slope[j, q, v]
                rows[i, v] = value
        if begin == RACE:
            for v in range(BORDER):
                border[first, v] += rows[0, v]
                border[first + 1, v] += cp * rows[2, v] - sp * rows[1, v]
                border[first + 2, v] += cp * rows[1, v] + sp * rows[2, v]
        else:
            add_cage_rows(bearing, system.arm[j], rows, border)


@jit
def add_land_edge_rows(bearing, j, system):
    """Add a closed edge of the land to the equations of race and cage."""
    rows, border, first = system.rows, system.border, CAGE_BORDER
    inner = bearing.cage.land == INNER_LAND
    for i in range(3):
        for v in range(CAGE_BORDER):
            rows[i, v] = system.cage_slope[j, i, v]
        rows[i, first] = 0.0
        for q in range(1, 3):
            rows[i, first + q] = -system.K[j, i, q] if inner else 0.0
    add_cage_rows(bearing, system.arm[j], rows, border)
    if inner:
        for v in range(BORDER):
            border[first + 1, v] -= rows[1, v]
            border[first + 2, v] -= rows[2, v]


@jit
def factorise(shift, y, bearing, buf, system):
    """Factor the matrix of a stage, 1/(gamma h) = `shift`, from what `linearise` kept.

    Returns
    -------
    bool
        False where the matrix is singular.
    """
    n, border = bearing.D.size, system.border
    border[:, :] = 0.0
    for k in range(CAGE_BORDER):
        border[k, k] = shift
    for j in range(n + 2):
        if system.touching[j]:
            slope_by_cage(shift, j, system)
            if j >= n:
                add_land_edge_rows(bearing, j, system)
    for j in range(n):
        race_block(shift, y, bearing, buf, j, system)
        inputs, outputs = FORCE, POCKET
        if system.touching[j]:
            pocket_block(shift, y, bearing, j, system)
            inputs, outputs = BALL_INPUTS, BALL_OUTPUTS
        if not invert_in_place(system.inverse[j]):
            return False
        passing, inner = system.passing[j], buf.inner[j]
        multiply(system.inverse[j], system.gain[j], LOCAL, LOCAL, inputs, system.response[j])
        multiply(system.reading[j], system.response[j], outputs, LOCAL, inputs, passing)
        for p in range(2):
            passing[p, 0] += inner[p, INNER_1]
            passing[p, 1] += inner[p, INNER_2]
        if system.touching[j]:
            for q in range(3):
                passing[POCKET + q, FORCE + q] += 1.0
        add_ball_to_border(bearing, j, system)
    if bearing.axial_is_held:
        for v in range(BORDER):
            border[CAGE_BORDER, v] = border[v, CAGE_BORDER] = 0.0
        border[CAGE_BORDER, CAGE_BORDER] = 1.0
    return factor_in_place(border, system.pivots, BORDER)
