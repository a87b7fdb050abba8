"""Derivatives of the right-hand side and of the balance of normal forces, ball by ball.

The force of the races on a ball follows from the legs of its contacts and its motion. Its pocket
couples it to the cage, by the derivatives K and C of that contact (cage_law.contact_law).
"""

import math

from bearingwear.kernels.ball import drag_force
from bearingwear.kernels.contact.changes import (
    BY_ANGLE,
    BY_LOAD,
    BY_RADIUS,
    gradient_changes,
    slip_changes,
)
from bearingwear.kernels.contact.profile import contact_stiffness
from bearingwear.kernels.contact.slip import slip_coefficients
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.dynamic.model import race_contact_of
from bearingwear.kernels.dynamic.quasistatic import COS_I, COS_O, SIN_I, SIN_O
from bearingwear.kernels.layout import BALL, OMEGA, W_X, W_Y, W_Z

# Rows of a ball's block: force in the balance, moment, force against the orbit, powers.
P_AXIAL, P_RADIAL, M_X, M_Y, M_Z, F_ORBIT, SHAFT_POWER, HEAT_POWER = range(8)
# Columns: legs from the ball's centre to the inner groove's and from the outer groove's to the
# ball's, (axial, radial); then the ball's w_x, w_y, w_z, Omega.
INNER_1, INNER_2, OUTER_1, OUTER_2, MOTION = range(5)


@jit
def contact_rows(contact, k, c, r, gradient, change, v):
    """Derivatives of the eight rows of a ball's block by variable v of one contact.

    Returns
    -------
    tuple of 8 floats
    """
    sigma, s, co = contact.sigma, contact.sin_a, contact.cos_a
    d_1, d_0, d_h, d_x = change[0, v], change[1, v], change[2, v], change[3, v]
    pull = gradient.size > 4
    d_t, T = (change[4, v], gradient[4]) if pull else (0.0, 0.0)
    axial, radial = d_t * co, -d_t * s
    turning, across = sigma * co * d_h - s * d_x, sigma * s * d_h + co * d_x
    power = r * d_0 + turning
    heat = c[0] * d_1 + c[1] * d_0 + c[2] * d_h + c[3] * d_x
    side = 1.0 if k == 0 else -1.0
    if v == BY_LOAD:
        axial, radial = axial + side * s, radial + side * co
    elif v == BY_ANGLE:
        axial += side * contact.Q * co - T * s
        radial -= side * contact.Q * s + T * co
        g_h, g_x = gradient[2], gradient[3]
        turning -= sigma * s * g_h + co * g_x
        across += sigma * co * g_h - s * g_x
        power -= sigma * s * g_h + co * g_x
        heat += sigma * (c[3] * g_h - c[2] * g_x)
    elif v == BY_RADIUS:
        power += gradient[1]
        heat += gradient[1] * c[1] / r
    elif v == W_X:
        heat += sigma * co * gradient[2] - s * gradient[3]
    elif v == W_Y:
        heat -= sigma * gradient[0]
    elif v == W_Z:
        heat -= sigma * s * gradient[2] + co * gradient[3]
    else:
        heat += r * gradient[1]
    return axial, radial, -turning, sigma * d_1, across, d_0, -contact.omega * power, heat


@jit
def add_contact(bearing, buf, j, k, contact, c):
    """Add contact k of ball j to its blocks; its friction stands in `buf`, with its changes."""
    balls, block, inner = buf.balls, buf.blocks[j], buf.inner[j]
    r, R, change = balls.r[j], 0.5 * bearing.D[j], buf.change
    X, A, g, d = balls.X[j], balls.A[j], bearing.g, balls.direction[j]
    if k == 0:
        d1, d2, free, at, s, co = A[0] - X[0], A[1] - X[1], g.r_i - R, INNER_1, d[SIN_I], d[COS_I]
    else:
        d1, d2, free, at, s, co = X[0], X[1], g.r_o - R, OUTER_1, d[SIN_O], d[COS_O]
    length = math.sqrt(d1 * d1 + d2 * d2)
    stiffness = contact_stiffness(contact.Q, length - free)
    for v in range(7):
        rows = contact_rows(contact, k, c, r, buf.gradient[j, k], change, v)
        if v == BY_LOAD:
            f1, f2, to1, to2 = stiffness * s, stiffness * co, at, at + 1
        elif v == BY_ANGLE:
            f1, f2, to1, to2 = co / length, -s / length, at, at + 1
        else:
            f1, f2, to1, to2 = 1.0, 0.0, (OUTER_2 if v == BY_RADIUS else MOTION + v), 0
        for p in range(8):
            block[p, to1] += rows[p] * f1
            if f2 != 0.0:
                block[p, to2] += rows[p] * f2
            if k == 0 and p < 2:
                inner[p, to1] += rows[p] * f1
                if f2 != 0.0:
                    inner[p, to2] += rows[p] * f2


@jit
def ball_blocks(y, bearing, buf):
    """Fill `buf.blocks` and `buf.inner` for the last `rates_here`, which left its slopes.

    `blocks` (n, 8, 8): derivatives of the forces on each ball and of the powers that the integrals
    sum. A stage of a stiff step lies off the path, where friction differs much from its value on
    the path; without their slopes the sums of powers would be wrong. `inner` (n, 2, 8): axial and
    radial force of the inner race on the ball alone. Hertz factors are held.
    """
    m, balls = bearing.op, buf.balls
    for j in range(bearing.D.size):
        i, R, r = BALL * j, 0.5 * bearing.D[j], balls.r[j]
        u = (y[i + W_X], y[i + W_Y], y[i + W_Z], y[i + OMEGA])
        block = buf.blocks[j]
        block[:, :] = 0.0
        buf.inner[j, :, :] = 0.0
        for k in range(2):
            contact = race_contact_of(bearing, balls, j, k)
            if not contact.Q > 0.0:
                continue
            c = slip_coefficients(contact, u, r)
            slip_changes(contact, c, r, buf.L)
            gradient, even = buf.gradient[j, k], buf.even[j, k]
            gradient_changes(contact, R, c, gradient, even, buf.hessian[j, k], buf.L, buf.change)
            add_contact(bearing, buf, j, k, contact, c)
        Omega, mass = u[3], bearing.mass[j]
        block[P_RADIAL, OUTER_2] += mass * Omega * Omega
        block[P_RADIAL, MOTION + OMEGA] += 2.0 * mass * r * Omega
        _, dF_v = drag_force(bearing.g, bearing.D[j], m.drag, Omega)
        block[F_ORBIT, MOTION + OMEGA] += dF_v
