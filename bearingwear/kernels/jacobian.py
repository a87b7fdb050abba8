"""Derivatives of the right-hand side: a block for each ball, and its contact with the cage.

Contact loads are held in a ball's block. What its pocket does couples it to the cage, by the
derivatives K and C of that contact (cage_law.contact_law).
"""

from bearingwear.kernels.ball import drag_force
from bearingwear.kernels.bearing_model import race_contact_of
from bearingwear.kernels.cage import inverse_inertia
from bearingwear.kernels.compile import jit
from bearingwear.kernels.contact import (
    slip_coefficients,
    slip_map,
    traction_slope,
)
from bearingwear.kernels.ellipse import contact_points
from bearingwear.kernels.quasistatic import RACES_11, RACES_12, RACES_22
from bearingwear.kernels.state import (
    BALL,
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

# Rows of Buffers.slopes.
SHAFT, _HEAT, TURNING = range(3)


@jit(forceinline=True)
def subtract_congruence(L, H, J):
    """J -= L^T H L for 4 x 4 matrices, L with few elements other than 0."""
    for q in range(4):
        for v in range(4):
            if L[q, v] != 0.0:
                for p in range(4):
                    for u in range(4):
                        J[u, v] -= L[p, u] * H[p, q] * L[q, v]


@jit(forceinline=True)
def add_power_slopes(contact, c, r, gradient, H, L, S):
    """Add a contact's part to the derivatives S of shaft power and heat by (w, Omega)."""
    reach, lever = contact.sigma * contact.cos_a, -contact.sin_a
    for q in range(4):
        torque = -contact.omega * (r * H[1, q] + reach * H[2, q] + lever * H[3, q])
        heat = gradient[q] + c[0] * H[0, q] + c[1] * H[1, q] + c[2] * H[2, q] + c[3] * H[3, q]
        for v in range(4):
            if L[q, v] != 0.0:
                S[SHAFT, v] += torque * L[q, v]
                S[_HEAT, v] += heat * L[q, v]


@jit
def ball_blocks(y, bearing, buf):
    """Fill `buf.blocks`: derivative of each ball's (w, Omega) rates by (w, Omega), loads held.

    And `buf.slopes`, that of the powers which the integrals sum: a stage of a stiff step lies off
    the path, where friction is far from its value on it, and their sum would feel that. For the
    state of the last call of `state_rates`.
    """
    g, m, balls = bearing.g, bearing.op, buf.balls
    H, L = buf.hessian, buf.L
    for j in range(bearing.D.size):
        i, R, r = BALL * j, 0.5 * bearing.D[j], balls.r[j]
        w_y, w_z, Omega = y[i + W_Y], y[i + W_Z], y[i + OMEGA]
        J, S = buf.blocks[j], buf.slopes[j]
        J[:, :] = 0.0
        S[:, :] = 0.0
        F_y = 0.0
        for k in range(2):
            contact = race_contact_of(bearing, balls, j, k)
            if not contact.Q > 0.0:
                continue
            c = slip_coefficients(contact, (y[i + W_X], w_y, w_z, Omega), r)
            across, share = buf.across, buf.share
            t, weight = contact_points(
                bearing.rule, contact, R, c, m.v_r, buf.t, buf.weight, buf.h, buf.width, across,
                share,
            )  # fmt: skip
            traction_slope(
                contact, c, contact.mu, m.v_r, t, weight, buf.h, buf.width, across, share,
                buf.gradient, H,
            )  # fmt: skip
            slip_map(contact, r, L)
            F_y += buf.gradient[1]
            add_power_slopes(contact, c, r, buf.gradient, H, L, S)
            subtract_congruence(L, H, J)
        inertia = bearing.inertia[j]
        orbit = bearing.mass[j] * r * r
        F_v, dF_v = drag_force(g, bearing.D[j], m.drag, Omega)
        for v in range(4):
            for u in range(3):
                J[u, v] /= inertia
            J[OMEGA, v] /= orbit
            S[TURNING, v] = 2.0 * orbit * Omega * J[OMEGA, v]
        S[TURNING, OMEGA] -= 2.0 * r * (F_y + F_v) + 2.0 * r * Omega * dF_v
        J[W_Y, W_Z] += Omega
        J[W_Y, OMEGA] += w_z
        J[W_Z, W_Y] -= Omega
        J[W_Z, OMEGA] -= w_y
        J[OMEGA, OMEGA] -= dF_v / (bearing.mass[j] * r)


@jit
def add_ball_powers(U, side, bearing, buf):
    """Add to `side` what a step U of the balls makes of shaft power, heat and turning."""
    layout = bearing.layout
    for j in range(bearing.D.size):
        i, S = BALL * j, buf.slopes[j]
        for v in range(4):
            side[layout.shaft] += S[SHAFT, v] * U[i + v]
            side[layout.heat] += S[_HEAT, v] * U[i + v]
            side[layout.turning] += S[TURNING, v] * U[i + v]


@jit
def cage_point(cage, R, arm, Z_v, Z_x, gain):
    """Motion of a point fixed to the cage, and what a force there does to the cage's rates.

    Parameters
    ----------
    arm : ndarray (3,)
        Of the point from the cage's centre [m].
    Z_v, Z_x : ndarray (3, 12)
        Filled: derivatives of velocity and displacement of the point by the cage's state.
    gain : ndarray (12, 3)
        Filled.
    """
    Z_v[:, :] = 0.0
    Z_x[:, :] = 0.0
    gain[:, :] = 0.0
    a0, a1, a2 = arm[0], arm[1], arm[2]
    # omega x arm as a matrix on omega.
    skew = ((0.0, a2, -a1), (-a2, 0.0, a0), (a1, -a0, 0.0))
    for i in range(3):
        Z_x[i, CENTRE + i] = 1.0
        Z_v[i, VELOCITY + i] = 1.0
        gain[VELOCITY + i, i] = 1.0 / cage.mass
        for j in range(3):
            Z_x[i, ROTATION + j] = skew[i][j]
            gain[MOMENTUM + i, j] = skew[j][i]  # the moment arm x force
            for k in range(3):
                Z_v[i, MOMENTUM + j] += skew[i][k] * inverse_inertia(cage, R, k, j)


@jit(forceinline=True)
def ball_point(bearing, j, r, reach, sin_psi, cos_psi, B_v, B_x, gain):
    """The same for the contact point of ball j, by its five states.

    Parameters
    ----------
    reach : ndarray (3,)
        Of the point from the ball's centre, inertial [m].
    B_v, B_x : ndarray (3, 5)
        Filled.
    gain : ndarray (5, 3)
        Filled.
    """
    p0, p1, p2, sp, cp = reach[0], reach[1], reach[2], sin_psi, cos_psi
    B_v[:, :] = 0.0
    B_x[:, :] = 0.0
    # w x p by the azimuth axes x = (1,0,0), y = (0,c,s), z = (0,-s,c).
    B_v[1, W_X], B_v[2, W_X] = -p2, p1
    B_v[0, W_Y], B_v[1, W_Y], B_v[2, W_Y] = cp * p2 - sp * p1, sp * p0, -cp * p0
    B_v[0, W_Z], B_v[1, W_Z], B_v[2, W_Z] = -sp * p2 - cp * p1, cp * p0, sp * p0
    B_v[1, OMEGA], B_v[2, OMEGA] = -r * cp, -r * sp
    B_x[1, PSI], B_x[2, PSI] = -r * cp, -r * sp
    for q in range(3):
        for u in range(3):
            gain[u, q] = B_v[q, u] / bearing.inertia[j]
        gain[OMEGA, q] = B_v[q, OMEGA] / (bearing.mass[j] * r * r)
        gain[PSI, q] = 0.0


@jit
def condense_ball_centre(condensed, contacts, j, sin_psi, cos_psi, K, heat, loss):
    """Let a ball's centre give way, axially and radially, to the force of its pocket.

    The races hold it softly along their contacts' tangent. Static condensation of its two
    displacements from the derivatives of the contact by displacement.

    Parameters
    ----------
    condensed : ndarray (9,)
        A row of quasistatic.Suspension.condensed.
    K, heat, loss : ndarray (3, 3), (6,), (6,)
        Filled by displacement with those derivatives, condensed.
    """
    K_pocket = contacts.K[j]
    axial, radial = (1.0, 0.0, 0.0), (0.0, -sin_psi, cos_psi)
    a, b, c, d = condensed[RACES_11], condensed[RACES_12], condensed[RACES_12], condensed[RACES_22]
    for i in range(3):
        for k in range(3):
            a += axial[i] * K_pocket[i, k] * axial[k]
            b += axial[i] * K_pocket[i, k] * radial[k]
            c += radial[i] * K_pocket[i, k] * axial[k]
            d += radial[i] * K_pocket[i, k] * radial[k]
    det = a * d - b * c
    for k in range(3):
        # What is left of a unit displacement k once the centre has given way.
        t0, t1, t2 = 1.0 if k == 0 else 0.0, 1.0 if k == 1 else 0.0, 1.0 if k == 2 else 0.0
        if det > 0.0:
            f_axial = f_radial = 0.0
            for q in range(3):
                f_axial += axial[q] * K_pocket[q, k]
                f_radial += radial[q] * K_pocket[q, k]
            x, z = (d * f_axial - b * f_radial) / det, (a * f_radial - c * f_axial) / det
            t0 -= axial[0] * x + radial[0] * z
            t1 -= axial[1] * x + radial[1] * z
            t2 -= axial[2] * x + radial[2] * z
        left = (t0, t1, t2)
        by_heat = by_loss = 0.0
        for q in range(3):
            by_heat += contacts.heat[j, 3 + q] * left[q]
            by_loss += contacts.loss[j, 3 + q] * left[q]
        heat[3 + k], loss[3 + k] = by_heat, by_loss
        for i in range(3):
            value = 0.0
            for q in range(3):
                value += K_pocket[i, q] * left[q]
            K[i, k] = value
