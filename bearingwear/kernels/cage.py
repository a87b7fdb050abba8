"""Cage of six degrees of freedom: pockets, guiding land, motion (theory.md section 10).

State (12 numbers): centre c, velocity v, rotation vector theta since the orientation `R0` that was
fixed at the start of the step, and angular momentum L about the centre; all in the inertial frame.
A rotation vector that is put back to zero at each step has no singularity and no length to keep;
the momentum of a cage that nothing touches stays to the last digit.

Contacts are described by what they do to the relative motion of two points: a force, and its
derivatives K by displacement and C by velocity. The same assembly then serves pockets and land.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.compile import jit

CAGE = 12  # states of a cage
NO_LAND, OUTER_LAND, INNER_LAND = 0, 1, 2


class Cage(NamedTuple):
    """Geometry, inertia and contact laws of a cage; no cage if `present` is False."""

    present: bool
    mass: float  # [kg]
    I_x: float  # moment of inertia about its axis [kg m2]
    I_t: float  # and across it
    clearance: float  # radial pocket clearance of the unworn ball [m]
    K_pocket: float  # Hertz factor of ball and pocket [N/m^1.5]
    land: int  # NO_LAND, OUTER_LAND or INNER_LAND
    radius: float  # of the cage's guiding surface [m]
    gap: float  # radial clearance at the land [m]
    half_width: float  # [m]
    k_land: float  # stiffness of one edge [N/m]
    mu: float  # Coulomb coefficient at pockets and land [1]
    v_r: float  # its slip regularisation [m/s]
    damping_pocket: float  # of damping sqrt(m* K) d^(1/4) times the speed along the orbit [1]
    damping_land: float  # critical-damping ratio of the land [1]
    # Interference over which the damping comes in [m]: without it a land's force would jump, and
    # the fourth root of the pocket's law would make rounding of a ball's place a force.
    ramp_pocket: float
    ramp_land: float


class CageBuffers(NamedTuple):
    """What the cage's contacts leave for forces, outputs and the Jacobian."""

    R0: np.ndarray  # (3, 3) orientation at the start of the step
    R: np.ndarray  # (3, 3) orientation now
    ball_force: np.ndarray  # (n, 3) on the ball: axial, along y, radially outward [N]
    ball_moment: np.ndarray  # (n, 3) on the ball in its azimuth frame [N m]
    approach: np.ndarray  # (n + 2,) interference: pockets, then both land edges; < 0: open [m]
    normal: np.ndarray  # (n + 2,) normal forces [N]
    power: np.ndarray  # (n + 2,) normal force times slip, for wear [W]
    race_force: np.ndarray  # (2,) of the land on the inner race along Y, Z [N]
    sums: np.ndarray  # (9,) places below
    K: np.ndarray  # (n + 2, 3, 3) derivative of the contact force by displacement [N/m]
    C: np.ndarray  # (n + 2, 3, 3) and by velocity [N s/m]
    heat: np.ndarray  # (n + 2, 6) derivative of friction heat by velocity and displacement
    loss: np.ndarray  # (n + 2, 6) and of the power lost to damping
    arm: np.ndarray  # (n + 2, 3) contact point from the cage's centre [m]
    reach: np.ndarray  # (n, 3) contact point from the ball's centre, inertial [m]


# Places in CageBuffers.sums.
POCKET_HEAT, POCKET_DAMPING, LAND_HEAT, LAND_DAMPING, LAND_WORK = 0, 1, 2, 3, 4
POCKET_TORQUE, LAND_TORQUE, ELASTIC, INNER_TORQUE = 5, 6, 7, 8


@jit
def cage_buffers(n):
    """Buffers for n pockets."""
    return CageBuffers(
        np.eye(3), np.eye(3), np.zeros((n, 3)), np.zeros((n, 3)), np.full(n + 2, -1.0),
        np.zeros(n + 2), np.zeros(n + 2), np.zeros(2), np.zeros(9), np.zeros((n + 2, 3, 3)),
        np.zeros((n + 2, 3, 3)), np.zeros((n + 2, 6)), np.zeros((n + 2, 6)), np.zeros((n + 2, 3)),
        np.zeros((n, 3)),
    )  # fmt: skip


@jit
def cross(a0, a1, a2, b0, b1, b2):
    """Vector product."""
    return a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0


@jit
def turn(theta, R0, R):
    """R = exp(theta) R0, by Rodrigues' formula."""
    x, y, z = theta[0], theta[1], theta[2]
    angle2 = x * x + y * y + z * z
    if angle2 > 1e-12:
        angle = math.sqrt(angle2)
        s, c = math.sin(angle) / angle, (1.0 - math.cos(angle)) / angle2
    else:
        s, c = 1.0 - angle2 / 6.0, 0.5 - angle2 / 24.0
    for k in range(3):
        a, b, d = R0[0, k], R0[1, k], R0[2, k]
        p, q, r = cross(x, y, z, a, b, d)
        u, v, w = cross(x, y, z, p, q, r)
        R[0, k] = a + s * p + c * u
        R[1, k] = b + s * q + c * v
        R[2, k] = d + s * r + c * w


@jit
def angular_velocity(cage, z, R):
    """Angular velocity (3) of the cage in inertial axes, from its angular momentum [rad/s]."""
    a0, a1, a2 = R[0, 0], R[1, 0], R[2, 0]
    along = a0 * z[9] + a1 * z[10] + a2 * z[11]
    back = along * (1.0 / cage.I_x - 1.0 / cage.I_t)
    return z[9] / cage.I_t + back * a0, z[10] / cage.I_t + back * a1, z[11] / cage.I_t + back * a2


@jit
def contact_law(F, stiffness, damping, n0, n1, n2, s0, s1, s2, mu, v_r, K, C):
    """Friction at a contact and the derivatives of its whole force.

    Parameters
    ----------
    F, stiffness, damping : float
        Normal force [N], its derivatives by approach [N/m] and approach speed [N s/m].
    n0, n1, n2 : float
        Unit normal.
    s0, s1, s2 : float
        Slip of the partner against the body, tangential [m/s].
    K, C : ndarray (3, 3)
        Filled.

    Returns
    -------
    f0, f1, f2 : float
        Friction on the body [N].
    slip : float
        [m/s]
    """
    slip = math.sqrt(s0 * s0 + s1 * s1 + s2 * s2)
    W = math.sqrt(slip * slip + v_r * v_r)
    t = mu * F / W
    n = (n0, n1, n2)
    s = (s0 / W, s1 / W, s2 / W)
    for i in range(3):
        for j in range(3):
            nn = n[i] * n[j]
            pushed = nn - mu * s[i] * n[j]  # the normal force and the friction it brings
            K[i, j] = stiffness * pushed
            C[i, j] = damping * pushed + t * ((1.0 if i == j else 0.0) - nn - s[i] * s[j])
    return t * s0, t * s1, t * s2, slip


@jit
def power_slopes(
    F, stiffness, damping, change, closing, n0, n1, n2, s0, s1, s2, mu, v_r, heat, loss
):
    """Derivatives of a contact's friction heat and damping power by the relative motion.

    Parameters
    ----------
    F, stiffness, damping : float
        As in `contact_law`.
    change : float
        Derivative of the damping by approach [N s/m2].
    closing : float
        Approach speed [m/s]
    n0, n1, n2, s0, s1, s2 : float
        Unit normal, slip [m/s].
    heat, loss : ndarray (6,)
        Filled: by velocity, by displacement.
    """
    slip2 = s0 * s0 + s1 * s1 + s2 * s2
    W = math.sqrt(slip2 + v_r * v_r)
    by_slip = mu * F * (2.0 - slip2 / (W * W)) / W  # over the slip itself
    by_force = mu * slip2 / W
    n = (n0, n1, n2)
    s = (s0, s1, s2)
    for i in range(3):
        heat[i] = by_slip * s[i] - by_force * damping * n[i]
        heat[3 + i] = -by_force * stiffness * n[i]
        loss[i] = -2.0 * damping * closing * n[i]
        loss[3 + i] = -change * closing * closing * n[i]


@jit
def cage_contacts(cage, z, y_balls, stride, D0, D, mass, r, X1, delta, omega_i, omega_o, b):
    """Forces of pockets and land on balls, cage and inner race.

    Parameters
    ----------
    z : ndarray (12,)
        State of the cage.
    y_balls : ndarray
        States of the balls, `stride` numbers each: w_x, w_y, w_z, Omega, psi.
    D, mass, r, X1 : ndarray (n,)
        Ball diameters, masses, orbit radii, axial positions [m, kg].
    delta : ndarray (3,)
        Displacement of the inner race [m].
    b : CageBuffers
        Filled.

    Returns
    -------
    f : tuple of 6 floats
        Force and moment about its centre on the cage [N, N m].
    """
    n = D.size
    turn(z[6:9], b.R0, b.R)
    R = b.R
    b.sums[:] = 0.0
    b.race_force[:] = 0.0
    f0 = f1 = f2 = t0 = t1 = t2 = 0.0
    wx, wy, wz = angular_velocity(cage, z, R)
    for j in range(n):
        i = stride * j
        b.normal[j] = b.power[j] = 0.0
        for k in range(3):
            b.ball_force[j, k] = b.ball_moment[j, k] = 0.0
        psi, Omega = y_balls[i + 4], y_balls[i + 3]
        sp, cp = math.sin(psi), math.cos(psi)
        phi = 2.0 * math.pi * j / n
        u1, u2 = -math.sin(phi), math.cos(phi)
        a0 = R[0, 1] * u1 + R[0, 2] * u2
        a1 = R[1, 1] * u1 + R[1, 2] * u2
        a2 = R[2, 1] * u1 + R[2, 2] * u2
        d0, d1, d2 = X1[j] - z[0], -r[j] * sp - z[1], r[j] * cp - z[2]
        along = d0 * a0 + d1 * a1 + d2 * a2
        e0, e1, e2 = d0 - along * a0, d1 - along * a1, d2 - along * a2
        offset = math.sqrt(e0 * e0 + e1 * e1 + e2 * e2)
        approach = offset - cage.clearance - 0.5 * (D0 - D[j])
        b.approach[j] = approach
        if approach <= 0.0:
            continue
        n0, n1, n2 = e0 / offset, e1 / offset, e2 / offset
        R_b = 0.5 * D[j]
        # Contact point from the ball's centre and from the cage's.
        p0, p1, p2 = R_b * n0, R_b * n1, R_b * n2
        q0, q1, q2 = d0 + p0, d1 + p1, d2 + p2
        # Ball surface: centre moves along (0, -cos psi, -sin psi); w from azimuth to inertial axes.
        w0, w_y, w_z = y_balls[i], y_balls[i + 1], y_balls[i + 2]
        w1, w2 = w_y * cp - w_z * sp, w_y * sp + w_z * cp
        c0, c1, c2 = cross(w0, w1, w2, p0, p1, p2)
        vb0, vb1, vb2 = c0, c1 - r[j] * Omega * cp, c2 - r[j] * Omega * sp
        c0, c1, c2 = cross(wx, wy, wz, q0, q1, q2)
        vc0, vc1, vc2 = z[3] + c0, z[4] + c1, z[5] + c2
        s0, s1, s2 = vc0 - vb0, vc1 - vb1, vc2 - vb2
        # A ball has inertia along the orbit alone, elsewhere the races hold it as a spring without
        # mass: damping acts on its centre along the orbit, and less the further the contact looks
        # away from it.
        along_orbit = (
            r[j] * Omega + (z[4] + wz * d0 - wx * d2) * cp + (z[5] + wx * d1 - wy * d0) * sp
        )
        n_y = n1 * cp + n2 * sp
        closing = -(s0 * n0 + s1 * n1 + s2 * n2)
        s0, s1, s2 = s0 + closing * n0, s1 + closing * n1, s2 + closing * n2
        root = math.sqrt(approach)
        F = cage.K_pocket * approach * root
        m_eff = mass[j] * cage.mass / (mass[j] + cage.mass)
        part = approach / (approach + cage.ramp_pocket)
        c_n = cage.damping_pocket * math.sqrt(m_eff * cage.K_pocket) * math.sqrt(root) * part
        c_n *= n_y * n_y
        drag = c_n * along_orbit
        if drag * n_y > F * n_y * n_y:  # nothing pulls
            drag, c_n = F * n_y, 0.0
        slope = 1.5 * cage.K_pocket * root
        K, C = b.K[j], b.C[j]
        g0, g1, g2, slip = contact_law(
            F, slope, 0.0, n0, n1, n2, s0, s1, s2, cage.mu, cage.v_r, K, C
        )  # fmt: skip
        # The normal turns as the ball moves across it in the pocket.
        a, nn, turning = (a0, a1, a2), (n0, n1, n2), F / offset
        # And with it the contact point, where the surfaces have other speeds: friction turns.
        W = math.sqrt(slip * slip + cage.v_r * cage.v_r)
        drift, lever, s = cage.mu * F / W, R_b / offset, (s0 / W, s1 / W, s2 / W)
        # The cage against the ball at a point that moves over the ball, and at one fixed to it.
        o0, o1, o2 = lever * (wx - w0), lever * (wy - w1), lever * (wz - w2)
        for v in range(3):
            e = (1.0 if v == 0 else 0.0, 1.0 if v == 1 else 0.0, 1.0 if v == 2 else 0.0)
            t = (
                e[0] - a0 * a[v] - n0 * nn[v],
                e[1] - a1 * a[v] - n1 * nn[v],
                e[2] - a2 * a[v] - n2 * nn[v],
            )
            c0, c1, c2 = cross(o0, o1, o2, t[0], t[1], t[2])
            u0, u1, u2 = cross(wx, wy, wz, e[0], e[1], e[2])
            # Less what is normal, which turns with the place.
            c0, c1, c2 = c0 + u0, c1 + u1, c2 + u2
            back = c0 * n0 + c1 * n1 + c2 * n2 + (s0 * t[0] + s1 * t[1] + s2 * t[2]) / offset
            ahead = closing / offset
            c = (
                c0 + ahead * t[0] - back * n0,
                c1 + ahead * t[1] - back * n1,
                c2 + ahead * t[2] - back * n2,
            )
            along = c[0] * s[0] + c[1] * s[1] + c[2] * s[2]
            for u in range(3):
                K[u, v] += turning * t[u] - drift * (c[u] - along * s[u])
        C[1, 1] += c_n * cp * cp
        C[1, 2] += c_n * cp * sp
        C[2, 1] += c_n * cp * sp
        C[2, 2] += c_n * sp * sp
        power_slopes(
            F, slope, 0.0, 0.0, closing, n0, n1, n2, s0, s1, s2, cage.mu, cage.v_r, b.heat[j],
            b.loss[j],
        )  # fmt: skip
        b.loss[j, 1], b.loss[j, 2] = 2.0 * c_n * along_orbit * cp, 2.0 * c_n * along_orbit * sp
        # On the ball: pushed back along -n, dragged by the cage's slip.
        h0, h1, h2 = g0 - F * n0, g1 - F * n1, g2 - F * n2
        b.ball_force[j, 0] = h0
        b.ball_force[j, 1] = h1 * cp + h2 * sp + drag
        b.ball_force[j, 2] = -h1 * sp + h2 * cp
        c0, c1, c2 = cross(p0, p1, p2, g0, g1, g2)
        b.ball_moment[j, 0] = c0
        b.ball_moment[j, 1] = c1 * cp + c2 * sp
        b.ball_moment[j, 2] = -c1 * sp + c2 * cp
        b.normal[j] = F
        b.power[j] = F * slip
        b.arm[j, 0], b.arm[j, 1], b.arm[j, 2] = q0, q1, q2
        b.reach[j, 0], b.reach[j, 1], b.reach[j, 2] = p0, p1, p2
        b.sums[POCKET_HEAT] += g0 * s0 + g1 * s1 + g2 * s2
        b.sums[POCKET_DAMPING] += drag * along_orbit
        b.sums[ELASTIC] += 0.4 * F * approach
        f0, f1, f2 = f0 - h0, f1 - h1, f2 - h2
        c0, c1, c2 = cross(q0, q1, q2, -h0, -h1, -h2)
        t0, t1, t2 = t0 + c0, t1 + c1, t2 + c2
        e1, e2 = -drag * cp, -drag * sp
        f1, f2 = f1 + e1, f2 + e2
        t0, t1, t2 = t0 + d1 * e2 - d2 * e1, t1 - d0 * e2, t2 + d0 * e1
        # Torque about the bearing axis, for the account of who tows whom.
        b.sums[POCKET_TORQUE] -= (z[1] + q1) * h2 - (z[2] + q2) * h1
        b.sums[POCKET_TORQUE] += (z[1] + d1) * e2 - (z[2] + d2) * e1
    for edge in range(2):
        place = n + edge
        b.normal[place] = b.power[place] = 0.0
        if cage.land == NO_LAND:
            continue
        inner = cage.land == INNER_LAND
        x = cage.half_width if edge == 1 else -cage.half_width
        o0, o1, o2 = x * R[0, 0], x * R[1, 0], x * R[2, 0]
        e1, e2 = z[1] + o1, z[2] + o2
        omega = omega_o
        if inner:
            e1, e2, omega = e1 - delta[1], e2 - delta[2], omega_i
        offset = math.sqrt(e1 * e1 + e2 * e2)
        approach = offset - cage.gap
        b.approach[place] = approach
        if approach <= 0.0 or offset == 0.0:
            continue
        n1, n2 = e1 / offset, e2 / offset  # the cage is pushed along -n
        side = -1.0 if inner else 1.0
        q0, q1, q2 = o0, o1 + side * cage.radius * n1, o2 + side * cage.radius * n2
        c0, c1, c2 = cross(wx, wy, wz, q0, q1, q2)
        vc0, vc1, vc2 = z[3] + c0, z[4] + c1, z[5] + c2
        # Land surface: omega about X at the contact point.
        l1, l2 = z[1] + q1, z[2] + q2
        vl1, vl2 = -omega * l2, omega * l1
        s0, s1, s2 = -vc0, vl1 - vc1, vl2 - vc2
        closing = -(s1 * n1 + s2 * n2)
        s1, s2 = s1 + closing * n1, s2 + closing * n2
        part = approach / (approach + cage.ramp_land)
        c_n = 2.0 * cage.damping_land * math.sqrt(cage.k_land * cage.mass) * part
        spring = cage.k_land * approach
        F = max(spring + c_n * closing, 0.0)
        slope, change = cage.k_land, c_n * (1.0 - part) / approach
        if F > 0.0:
            slope = max(slope + change * closing, 0.0)
        else:
            c_n = slope = change = 0.0
        g0, g1, g2, slip = contact_law(
            F, slope, c_n, 0.0, n1, n2, s0, s1, s2, cage.mu, cage.v_r, b.K[place], b.C[place]
        )
        power_slopes(
            F, slope, c_n, change, closing, 0.0, n1, n2, s0, s1, s2, cage.mu, cage.v_r,
            b.heat[place], b.loss[place],
        )  # fmt: skip
        h0, h1, h2 = g0, g1 - F * n1, g2 - F * n2
        f0, f1, f2 = f0 + h0, f1 + h1, f2 + h2
        c0, c1, c2 = cross(q0, q1, q2, h0, h1, h2)
        t0, t1, t2 = t0 + c0, t1 + c1, t2 + c2
        b.normal[place] = F
        b.power[place] = F * slip
        b.arm[place, 0], b.arm[place, 1], b.arm[place, 2] = q0, q1, q2
        b.sums[LAND_HEAT] += g0 * s0 + g1 * s1 + g2 * s2
        b.sums[LAND_DAMPING] += (F - spring) * closing
        b.sums[ELASTIC] += 0.5 * spring * approach
        torque = l1 * h2 - l2 * h1
        b.sums[LAND_TORQUE] += torque
        b.sums[LAND_WORK] += omega * torque
        if inner:
            b.race_force[0] -= h1
            b.race_force[1] -= h2
            b.sums[INNER_TORQUE] += torque
    return f0, f1, f2, t0, t1, t2


@jit
def cage_motion(cage, z, f, R, dz):
    """Time derivative of the cage's state under force and moment f (6)."""
    x, y, s = z[6], z[7], z[8]
    w0, w1, w2 = angular_velocity(cage, z, R)
    for k in range(3):
        dz[k] = z[3 + k]
        dz[3 + k] = f[k] / cage.mass
        dz[9 + k] = f[3 + k]
    # theta' = omega - theta x omega / 2 + theta x (theta x omega) / 12, next term of order 4.
    c0, c1, c2 = cross(x, y, s, w0, w1, w2)
    d0, d1, d2 = cross(x, y, s, c0, c1, c2)
    dz[6] = w0 - 0.5 * c0 + d0 / 12.0
    dz[7] = w1 - 0.5 * c1 + d1 / 12.0
    dz[8] = w2 - 0.5 * c2 + d2 / 12.0


@jit
def cage_energy(cage, z, R):
    """Kinetic energy of the cage [J]."""
    w0, w1, w2 = angular_velocity(cage, z, R)
    return 0.5 * (
        cage.mass * (z[3] ** 2 + z[4] ** 2 + z[5] ** 2) + w0 * z[9] + w1 * z[10] + w2 * z[11]
    )
