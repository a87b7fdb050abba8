"""Right-hand side of the motion of balls, inner race and cage (theory.md section 8)."""

import math
from typing import NamedTuple

from bearingwear.kernels.ball import drag_force
from bearingwear.kernels.bearing_model import race_contact_of
from bearingwear.kernels.cage import cage_rates
from bearingwear.kernels.cage_law import (
    LAND_DAMPING,
    LAND_HEAT,
    LAND_TORQUE,
    LAND_WORK,
    POCKET_DAMPING,
    POCKET_HEAT,
    POCKET_TORQUE,
)
from bearingwear.kernels.compile import jit
from bearingwear.kernels.contact import (
    LARGEST_AXIS,
    ellipse_sums,
    slip_coefficients,
    strip_sums,
)
from bearingwear.kernels.dynamic_equilibrium import equilibrium
from bearingwear.kernels.ellipse import contact_points, quadrature_points
from bearingwear.kernels.quasistatic import COS_I, SIN_I
from bearingwear.kernels.state import BALL, CAGE, CENTRE, OMEGA, PSI, W_X, W_Y, W_Z
from bearingwear.kernels.status import BEYOND_GROOVE, OK, OUTSIDE_HERTZ_RANGE


class BallForces(NamedTuple):
    """Moment and force on a ball that its rates follow from, and powers summed over all balls."""

    M_x: float  # [N m] in the ball's azimuth frame
    M_y: float
    M_z: float
    F_y: float  # against the orbit for the races' part of it [N]
    heat: float  # of friction [W]
    shaft: float  # put in by the races [W]


@jit(forceinline=True)
def contact_status(contact, R):
    """Whether a closed contact of a ball of radius R is one that the model describes."""
    if contact.a >= LARGEST_AXIS * R:
        return OUTSIDE_HERTZ_RANGE
    if contact.cos_a < 0.0:
        return BEYOND_GROOVE
    return OK


@jit(forceinline=True)
def with_friction(bearing, buf, contact, c, R, r, f):
    """Forces f and the friction of a contact, and its QV [W].

    Parameters
    ----------
    c : tuple of 4 floats
        Slip coefficients.
    """
    m, rule = bearing.op, bearing.rule
    if rule.across.size == 1:
        t, weight = quadrature_points(rule, contact, R, c, m.v_r, buf.t, buf.weight)
        g_1, g_0, g_h, g_x, qv = strip_sums(contact, R, c, contact.mu, m.v_r, t, weight)
    else:
        t, weight = contact_points(
            rule, contact, R, c, m.v_r, buf.t, buf.weight, buf.h, buf.width, buf.across, buf.share
        )
        g_1, g_0, g_h, g_x, _, qv = ellipse_sums(
            contact, c, contact.mu, m.v_r, t, weight, buf.h, buf.width, buf.across, buf.share
        )
    sigma, sine, cosine = contact.sigma, contact.sin_a, contact.cos_a
    forces = BallForces(
        M_x=f.M_x - (sigma * cosine * g_h - sine * g_x),
        M_y=f.M_y + sigma * g_1,
        M_z=f.M_z + (sigma * sine * g_h + cosine * g_x),
        F_y=f.F_y + g_0,
        heat=f.heat + (c[0] * g_1 + c[1] * g_0 + c[2] * g_h + c[3] * g_x),
        shaft=f.shaft - contact.omega * (r * g_0 + sigma * cosine * g_h - sine * g_x),
    )
    return forces, qv


@jit(forceinline=True)
def add_ball_rates(y, bearing, balls, j, r, f, dy):
    """Rates of ball j under the forces f, and its part in the integrals that are sums."""
    g, layout, i = bearing.g, bearing.layout, BALL * j
    Omega, psi = y[i + OMEGA], y[i + PSI]
    drag, _ = drag_force(g, bearing.D[j], bearing.op.drag, Omega)
    inertia = bearing.inertia[j]
    dy[i + W_X] = f.M_x / inertia
    dy[i + W_Y] = f.M_y / inertia + Omega * y[i + W_Z]
    dy[i + W_Z] = f.M_z / inertia - Omega * y[i + W_Y]
    dy[i + OMEGA] = -(f.F_y + drag) / (bearing.mass[j] * r)
    dy[i + PSI] = Omega
    dy[layout.drag] += drag * r * Omega
    dy[layout.turning] += 2.0 * bearing.mass[j] * r * r * Omega * dy[i + OMEGA]
    # dU/dpsi at a fixed race: the inner force times the shift of the groove centres.
    sp, cp = math.sin(psi), math.cos(psi)
    Q, d = balls.Q[j, 0], balls.direction[j]
    dA1 = -bearing.tilt * g.R_i * sp
    dA2 = -balls.delta[2] * sp - balls.delta[1] * cp
    dy[layout.azimuth] += Omega * (Q * d[SIN_I] * dA1 + Q * d[COS_I] * dA2)


@jit
def store_cage_rates(y, bearing, contacts, dy):
    """Rates of the cage and of the integrals that its contacts feed."""
    n, layout, sums = bearing.D.size, bearing.layout, contacts.sums
    for j in range(n):
        dy[layout.pockets + j] = contacts.power[j]
    dy[layout.land] = contacts.power[n] + contacts.power[n + 1]
    dy[layout.cage_heat] = sums[POCKET_HEAT] + sums[LAND_HEAT]
    dy[layout.damping] = sums[POCKET_DAMPING] + sums[LAND_DAMPING]
    dy[layout.pocket_torque] = sums[POCKET_TORQUE]
    dy[layout.land_torque] = sums[LAND_TORQUE]
    dy[layout.gravity_torque] = 0.0
    if bearing.cage.present:
        begin, end, g = layout.cage, layout.cage + CAGE, bearing.cage.gravity
        cage_rates(bearing.cage, y[begin:end], contacts.force, contacts.R, dy[begin:end])
        off_y, off_z = y[begin + CENTRE + 1], y[begin + CENTRE + 2]
        dy[layout.gravity_torque] = bearing.cage.mass * (off_y * g[2] - off_z * g[1])


@jit
def state_rates(time, y, bearing, buf, dy):
    """Time derivative of the states of balls and cage and of the integrals.

    Parameters
    ----------
    time : float
        [s]
    y : ndarray
        State vector, see state.StateLayout.
    bearing : BearingModel
    buf : Buffers
    dy : ndarray
        Filled.

    Returns
    -------
    int
        Status of the equilibrium.
    """
    m, balls, contacts, layout = bearing.op, buf.balls, buf.cage, bearing.layout
    status = equilibrium(time, y, bearing, buf)
    if status != OK:
        return status
    heat = shaft = 0.0
    dy[layout.drag] = dy[layout.turning] = dy[layout.azimuth] = 0.0
    for j in range(bearing.D.size):
        i, R, r = BALL * j, 0.5 * bearing.D[j], balls.r[j]
        u = (y[i + W_X], y[i + W_Y], y[i + W_Z], y[i + OMEGA])
        moment = contacts.ball_moment[j]
        forces = BallForces(
            M_x=moment[0],
            M_y=moment[1],
            M_z=moment[2],
            F_y=contacts.ball_force[j, 1],
            heat=heat,
            shaft=shaft,
        )
        for k in range(2):
            contact, qv = race_contact_of(bearing, balls, j, k), 0.0
            if contact.Q > 0.0:
                status = contact_status(contact, R)
                if status != OK:
                    return status
                c = slip_coefficients(contact, u, r)
                forces, qv = with_friction(bearing, buf, contact, c, R, r, forces)
            dy[layout.qv + 2 * j + k] = qv
        heat, shaft = forces.heat, forces.shaft
        add_ball_rates(y, bearing, balls, j, r, forces, dy)
    store_cage_rates(y, bearing, contacts, dy)
    dy[layout.shaft] = shaft + contacts.sums[LAND_WORK]
    dy[layout.heat] = heat
    dy[layout.hertz] = 0.0  # see integrators.hertz_factor_work
    theta, rate = m.omega_i * time, m.omega_i * bearing.F_rot
    dy[layout.load] = -rate * (balls.delta[1] * math.cos(theta) + balls.delta[2] * math.sin(theta))
    return OK
