"""Contact of a ball with its cage pocket (theory.md section 10)."""

import math
from typing import NamedTuple

from bearingwear.kernels.cage.law import (
    ELASTIC,
    POCKET_DAMPING,
    POCKET_HEAT,
    POCKET_TORQUE,
    CageContact,
    contact_law,
    power_slopes,
)
from bearingwear.kernels.contact.profile import contact_load, elastic_energy
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.layout import BALL, CENTRE, OMEGA, VELOCITY, W_X, W_Y, W_Z
from bearingwear.kernels.vectors import cross, dot, minus, plus, store, times, triple, unit


class PocketPlace(NamedTuple):
    """Where a ball is in its pocket; vectors in inertial axes."""

    sin_psi: float  # of the ball's azimuth
    cos_psi: float
    axis: tuple[float, float, float]  # of the pocket, a unit vector
    d: tuple[float, float, float]  # ball centre from the cage's centre of mass [m]
    across: tuple[float, float, float]  # ball centre from the pocket's axis [m]
    offset: float  # its length [m]


@jit(forceinline=True)
def pocket_place(z, R, shift, pocket, turn, r, X1):
    """Place of a ball of axial position X1 on a circle of radius r.

    Parameters
    ----------
    shift : tuple of 3 floats
        Centre of mass from the cage's centre, which the pockets' axes meet in [m].
    pocket, turn : ndarray (2,)
        Sine and cosine of the azimuths of the pocket in the cage and of the ball.
    """
    sp, cp = turn[0], turn[1]
    u1, u2 = -pocket[0], pocket[1]
    axis = (
        R[0, 1] * u1 + R[0, 2] * u2,
        R[1, 1] * u1 + R[1, 2] * u2,
        R[2, 1] * u1 + R[2, 2] * u2,
    )
    d = minus((X1, -r * sp, r * cp), triple(z, CENTRE))
    e = plus(d, shift)
    across = minus(e, times(dot(e, axis), axis))
    offset = math.sqrt(dot(across, across))
    return PocketPlace(sin_psi=sp, cos_psi=cp, axis=axis, d=d, across=across, offset=offset)


class PocketMotion(NamedTuple):
    """How ball and cage move against each other where they touch; vectors in inertial axes."""

    n: tuple[float, float, float]  # unit normal, from the pocket's axis outward
    reach: tuple[float, float, float]  # contact point from the ball's centre [m]
    arm: tuple[float, float, float]  # and from the cage's centre of mass [m]
    w_ball: tuple[float, float, float]  # angular velocity of the ball [rad/s]
    slip: tuple[float, float, float]  # of the cage against the ball, tangential [m/s]
    closing: float  # approach speed [m/s]
    along_orbit: float  # speed of the cage over the ball's centre along the orbit [m/s]


@jit(forceinline=True)
def pocket_motion(y, i, z, w, place, r, R_b):
    """Motion at the contact of the ball whose states begin at y[i] and radius is R_b."""
    sp, cp, d = place.sin_psi, place.cos_psi, place.d
    e, offset = place.across, place.offset
    n = (e[0] / offset, e[1] / offset, e[2] / offset)
    p = times(R_b, n)
    q = plus(d, p)
    # Ball surface: centre moves along (0, -cos psi, -sin psi); w from azimuth to inertial axes.
    Omega, w_y, w_z = y[i + OMEGA], y[i + W_Y], y[i + W_Z]
    w_ball = (y[i + W_X], w_y * cp - w_z * sp, w_y * sp + w_z * cp)
    spin = cross(w_ball, p)
    v_ball = (spin[0], spin[1] - r * Omega * cp, spin[2] - r * Omega * sp)
    v = triple(z, VELOCITY)
    slip = minus(plus(v, cross(w, q)), v_ball)
    # A ball has inertia along the orbit alone, elsewhere the races hold it as a spring without
    # mass: damping acts on its centre along the orbit, and less the further the contact looks
    # away from it.
    along_orbit = (
        r * Omega
        + (v[1] + w[2] * d[0] - w[0] * d[2]) * cp
        + (v[2] + w[0] * d[1] - w[1] * d[0]) * sp
    )
    closing = -dot(slip, n)
    return PocketMotion(
        n=n,
        reach=p,
        arm=q,
        w_ball=w_ball,
        slip=plus(slip, times(closing, n)),
        closing=closing,
        along_orbit=along_orbit,
    )


class PocketForce(NamedTuple):
    """Elastic force of a pocket, its damping along the orbit, and both along the normal."""

    elastic: float  # [N]
    stiffness: float  # its derivative by approach [N/m]
    damping: float  # damping force on the ball, along the orbit's y [N]
    c_n: float  # its derivative by the speed along the orbit [N s/m]
    normal: float  # elastic force and the damping's normal part: what rubs [N]
    change: float  # derivative of `normal` by approach [N/m]


@jit(forceinline=True)
def pocket_force(cage, mass, approach, n_y, along_orbit):
    """Force of a pocket whose normal has the component n_y along the orbit.

    Parameters
    ----------
    mass : float
        Of the ball [kg].
    """
    root = math.sqrt(approach)
    F = contact_load(cage.K_pocket, approach)
    m_eff = mass * cage.mass / (mass + cage.mass)
    part = approach / (approach + cage.ramp_pocket)
    c_n = cage.damping_pocket * math.sqrt(m_eff * cage.K_pocket) * math.sqrt(root) * part
    c_n *= n_y * n_y
    damping, stiffness = c_n * along_orbit, 1.5 * cage.K_pocket * root
    change = stiffness - n_y * damping * (1.25 / approach - 1.0 / (approach + cage.ramp_pocket))
    if damping * n_y > F * n_y * n_y:  # nothing pulls
        damping, c_n, change = F * n_y, 0.0, stiffness * max(1.0 - n_y * n_y, 0.0)
    return PocketForce(
        elastic=F,
        stiffness=stiffness,
        damping=damping,
        c_n=c_n,
        normal=max(F - damping * n_y, 0.0),
        change=change,
    )


@jit(forceinline=True)
def add_geometric_stiffness(cage, w, place, motion, force, R_b, speed, K):
    """Add to K what turns with the ball's place: the normal, and with it the contact point.

    At another point the surfaces have other speeds: friction turns.
    """
    a, n, slip, offset = place.axis, motion.n, motion.slip, place.offset
    turning = force.elastic / offset
    W = math.sqrt(speed * speed + cage.v_r * cage.v_r)
    drift, lever = cage.mu * force.normal / W, R_b / offset
    s = (slip[0] / W, slip[1] / W, slip[2] / W)
    # The cage against the ball at a point that moves over the ball, and at one fixed to it.
    over = times(lever, minus(w, motion.w_ball))
    ahead = motion.closing / offset
    for v in range(3):
        e = unit(v)
        t = (
            e[0] - a[0] * a[v] - n[0] * n[v],
            e[1] - a[1] * a[v] - n[1] * n[v],
            e[2] - a[2] * a[v] - n[2] * n[v],
        )
        # Less what is normal, which turns with the place.
        c = plus(cross(over, t), cross(w, e))
        back = dot(c, n) + dot(slip, t) / offset
        c = minus(plus(c, times(ahead, t)), times(back, n))
        along = dot(c, s)
        for u in range(3):
            K[u, v] += turning * t[u] - drift * (c[u] - along * s[u])


@jit(forceinline=True)
def store_pocket_slopes(cage, motion, force, n_y, y_axis, contacts, j):
    """Friction of pocket j and its speed of slip; derivatives of its force and powers, stored.

    Friction sees the whole normal force, of which only the elastic part acts along the normal: the
    damping acts along `y_axis`, against the orbit.
    """
    n, slip, damping = motion.n, motion.slip, force.c_n * motion.along_orbit
    rubbing = CageContact(
        n=n,
        slip=slip,
        closing=motion.closing,
        F=force.normal,
        stiffness=force.change,
        damping=0.0,
        change=0.0,
    )
    K, C, heat, loss = contacts.K[j], contacts.C[j], contacts.heat[j], contacts.loss[j]
    friction, speed = contact_law(rubbing, cage.mu, cage.v_r, K, C)
    power_slopes(rubbing, cage.mu, cage.v_r, heat, loss)
    W = math.sqrt(speed * speed + cage.v_r * cage.v_r)
    less = cage.mu * n_y * force.c_n / W  # of the friction, as the cage goes along the orbit's y
    for i in range(3):
        for k in range(3):
            K[i, k] += (force.stiffness - force.change) * n[i] * n[k]
            C[i, k] += (force.c_n * y_axis[i] - less * slip[i]) * y_axis[k]
        heat[i] -= less * speed * speed * y_axis[i]
        loss[i] = 2.0 * damping * y_axis[i]
    return friction, speed


@jit(forceinline=True)
def add_pocket(bearing, y, z, w, j, r, place, approach, contacts, load):
    """Force of the closed pocket j, stored and added to the sums; returns the load on the cage.

    Parameters
    ----------
    load : tuple of two tuples of 3 floats
        Force and moment on the cage so far [N, N m].
    """
    cage, R_b = bearing.cage, 0.5 * bearing.D[j]
    motion = pocket_motion(y, BALL * j, z, w, place, r, R_b)
    sp, cp, d, n = place.sin_psi, place.cos_psi, place.d, motion.n
    n_y = n[1] * cp + n[2] * sp
    whole = pocket_force(cage, bearing.mass[j], approach, n_y, motion.along_orbit)
    F, damping = whole.elastic, whole.damping
    friction, speed = store_pocket_slopes(cage, motion, whole, n_y, (0.0, cp, sp), contacts, j)
    add_geometric_stiffness(cage, w, place, motion, whole, R_b, speed, contacts.K[j])
    # On the ball: pushed back along -n, dragged by the cage's slip.
    h = minus(friction, times(F, n))
    store((h[0], h[1] * cp + h[2] * sp + damping, -h[1] * sp + h[2] * cp), contacts.ball_force[j])
    moment = cross(motion.reach, friction)
    store(
        (moment[0], moment[1] * cp + moment[2] * sp, -moment[1] * sp + moment[2] * cp),
        contacts.ball_moment[j],
    )
    contacts.normal[j] = whole.normal
    contacts.power[j] = whole.normal * speed
    store(motion.arm, contacts.arm[j])
    store(d, contacts.hold[j])
    store(motion.reach, contacts.reach[j])
    sums = contacts.sums
    sums[POCKET_HEAT] += dot(friction, motion.slip)
    sums[POCKET_DAMPING] += damping * motion.along_orbit
    sums[ELASTIC] += elastic_energy(F, approach)
    # Torque about the bearing axis, for the account of who tows whom.
    q, e1, e2 = motion.arm, -damping * cp, -damping * sp
    sums[POCKET_TORQUE] -= (z[CENTRE + 1] + q[1]) * h[2] - (z[CENTRE + 2] + q[2]) * h[1]
    sums[POCKET_TORQUE] += (z[CENTRE + 1] + d[1]) * e2 - (z[CENTRE + 2] + d[2]) * e1
    force, moment = load
    force = minus(force, h)
    moment = plus(moment, cross(q, (-h[0], -h[1], -h[2])))
    force = (force[0], force[1] + e1, force[2] + e2)
    moment = (moment[0] + d[1] * e2 - d[2] * e1, moment[1] - d[0] * e2, moment[2] + d[0] * e1)
    return force, moment
