"""Contacts of the cage with balls and guiding land (theory.md section 10)."""

import math

from bearingwear.kernels.cage.body import (
    INNER_LAND,
    NO_LAND,
    angular_velocity,
    imbalance_vector,
    turn,
)
from bearingwear.kernels.cage.law import (
    ELASTIC,
    INNER_TORQUE,
    LAND_DAMPING,
    LAND_HEAT,
    LAND_TORQUE,
    LAND_WORK,
    CageContact,
    contact_law,
    power_slopes,
)
from bearingwear.kernels.cage.pocket import add_pocket, pocket_place
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.layout import CAGE, CENTRE, ROTATION, VELOCITY
from bearingwear.kernels.vectors import cross, dot, minus, plus, store, times, triple


@jit(forceinline=True)
def land_force(cage, approach, closing):
    """Normal force of a land edge.

    Returns
    -------
    spring, F, stiffness, damping, change : float
        The elastic part and the whole [N], see `CageContact`.
    """
    part = approach / (approach + cage.ramp_land)
    c_n = 2.0 * cage.damping_land * math.sqrt(cage.k_land * cage.mass) * part
    spring = cage.k_land * approach
    F = max(spring + c_n * closing, 0.0)
    if not F > 0.0:
        return spring, F, 0.0, 0.0, 0.0
    change = c_n * (1.0 - part) / approach
    return spring, F, max(cage.k_land + change * closing, 0.0), c_n, change


@jit
def set_race_velocity(time, bearing, contacts):
    """Velocity of the inner race: of the part of its displacement that turns with the shaft.

    The equilibrium of balls and race knows displacements alone.
    """
    omega, (u1, u2) = bearing.op.omega_i, bearing.cage.turning
    s, c = math.sin(omega * time), math.cos(omega * time)
    contacts.race_velocity[0] = -omega * (s * u1 + c * u2)
    contacts.race_velocity[1] = omega * (c * u1 - s * u2)


@jit(forceinline=True)
def land_contact(cage, approach, n, slip, closing):
    """Elastic force of a closed land edge [N], and the contact."""
    spring, F, stiffness, damping, change = land_force(cage, approach, closing)
    return spring, CageContact(
        n=n,
        slip=slip,
        closing=closing,
        F=F,
        stiffness=stiffness,
        damping=damping,
        change=change,
    )


@jit(forceinline=True)
def add_land_motion(speed, slower, n, offset, h, place, contacts):
    """Add to the slopes of a land how its surface changes with the place of the edge.

    Farther out the land is faster; farther along it, normal and force have turned, while the
    cage's own velocity has not.

    Parameters
    ----------
    speed : float
        Angular velocity of the land [rad/s].
    slower : tuple of 3 floats
        Velocity of the land's axis less that of the edge's centre [m/s].
    h : tuple of 3 floats
        Force on the cage [N].
    """
    K, C, heat, loss = (
        contacts.K[place],
        contacts.C[place],
        contacts.heat[place],
        contacts.loss[place],
    )
    along = (0.0, -n[2], n[1])
    out = times(speed, along)  # change of the land's velocity against the cage's, outward
    turned = (0.0, slower[2] / offset, -slower[1] / offset)  # and along
    force = (0.0, -h[2] / offset, h[1] / offset)
    for i in range(3):
        by_out = C[i, 1] * out[1] + C[i, 2] * out[2]
        by_turn = C[i, 1] * turned[1] + C[i, 2] * turned[2] + force[i]
        for k in range(1, 3):
            K[i, k] -= by_out * n[k] + by_turn * along[k]
    for slope in (heat, loss):
        by_out = slope[1] * out[1] + slope[2] * out[2]
        by_turn = slope[1] * turned[1] + slope[2] * turned[2]
        for k in range(1, 3):
            slope[3 + k] -= by_out * n[k] + by_turn * along[k]


@jit(forceinline=True)
def add_land_edge(bearing, z, w, shift, edge, delta, contacts, load):
    """Force of one edge of the land, stored and added to the sums; returns the load on the cage.

    Parameters
    ----------
    shift : tuple of 3 floats
        Centre of mass from the cage's centre [m].
    delta : ndarray (3,)
        Displacement of the inner race [m].
    load : tuple of two tuples of 3 floats
        Force and moment on the cage so far [N, N m].
    """
    cage, R, place = bearing.cage, contacts.R, bearing.D.size + edge
    inner = cage.land == INNER_LAND
    x = cage.half_width if edge == 1 else -cage.half_width
    o = minus(times(x, (R[0, 0], R[1, 0], R[2, 0])), shift)  # from the centre of mass
    race1 = race2 = speed1 = speed2 = 0.0
    omega = bearing.op.omega_o
    if inner:
        race1, race2, omega = delta[1], delta[2], bearing.op.omega_i
        speed1, speed2 = contacts.race_velocity[0], contacts.race_velocity[1]
    e1, e2 = z[CENTRE + 1] + o[1] - race1, z[CENTRE + 2] + o[2] - race2
    offset = math.sqrt(e1 * e1 + e2 * e2)
    approach = offset - cage.gap
    contacts.approach[place] = approach
    if approach <= 0.0 or offset == 0.0:
        return load
    n1, n2 = e1 / offset, e2 / offset  # the cage is pushed along -n
    side = -1.0 if inner else 1.0
    q = (o[0], o[1] + side * cage.radius * n1, o[2] + side * cage.radius * n2)
    v_cage = plus(triple(z, VELOCITY), cross(w, q))
    # Land surface: omega about the axis of its race, which has a velocity of its own.
    l1, l2 = z[CENTRE + 1] + q[1] - race1, z[CENTRE + 2] + q[2] - race2
    s0, s1, s2 = -v_cage[0], speed1 - omega * l2 - v_cage[1], speed2 + omega * l1 - v_cage[2]
    closing = -(s1 * n1 + s2 * n2)
    slip = (s0, s1 + closing * n1, s2 + closing * n2)
    spring, contact = land_contact(cage, approach, (0.0, n1, n2), slip, closing)
    F = contact.F
    friction, speed = contact_law(contact, cage.mu, cage.v_r, contacts.K[place], contacts.C[place])
    power_slopes(contact, cage.mu, cage.v_r, contacts.heat[place], contacts.loss[place])
    h = (friction[0], friction[1] - F * n1, friction[2] - F * n2)
    v_edge = plus(triple(z, VELOCITY), cross(w, o))
    slower = minus((0.0, speed1, speed2), v_edge)
    add_land_motion(omega, slower, contact.n, offset, h, place, contacts)
    contacts.normal[place], contacts.power[place] = F, F * speed
    store(q, contacts.arm[place])
    store(o, contacts.hold[place])
    sums = contacts.sums
    sums[LAND_HEAT] += dot(friction, slip)
    sums[LAND_DAMPING] += (F - spring) * closing
    sums[ELASTIC] += 0.5 * spring * approach
    torque = l1 * h[2] - l2 * h[1]
    sums[LAND_TORQUE] += torque + race1 * h[2] - race2 * h[1]
    sums[LAND_WORK] += omega * torque
    if inner:
        contacts.race_force[0] -= h[1]
        contacts.race_force[1] -= h[2]
        sums[INNER_TORQUE] += torque
    force, moment = load
    return plus(force, h), plus(moment, cross(q, h))


@jit
def cage_contacts(y, bearing, balls, contacts):
    """Forces of pockets and land on balls, cage and inner race.

    Parameters
    ----------
    y : ndarray
        State vector.
    balls : Suspension
        Where the balls and the inner race are, after `find_contacts`.
    contacts : CageBuffers
        Filled.
    """
    n, g, cage = bearing.D.size, bearing.g, bearing.cage
    z = y[bearing.layout.cage : bearing.layout.cage + CAGE]
    turn(z[ROTATION : ROTATION + 3], contacts.R0, contacts.R)
    contacts.sums[:] = 0.0
    contacts.race_force[:] = 0.0
    w, shift = angular_velocity(cage, z, contacts.R), imbalance_vector(cage, contacts.R)
    load = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for j in range(n):
        contacts.normal[j] = contacts.power[j] = 0.0
        for k in range(3):
            contacts.ball_force[j, k] = contacts.ball_moment[j, k] = 0.0
        r = g.R_o + balls.X[j, 1]
        place = pocket_place(
            z, contacts.R, shift, contacts.pockets[j], balls.turn[j], r, balls.X[j, 0]
        )
        approach = place.offset - cage.clearance - 0.5 * (g.D0 - bearing.D[j])
        contacts.approach[j] = approach
        if approach > 0.0:
            load = add_pocket(bearing, y, z, w, j, r, place, approach, contacts, load)
    for edge in range(2):
        contacts.normal[n + edge] = contacts.power[n + edge] = 0.0
        if cage.land != NO_LAND:
            load = add_land_edge(bearing, z, w, shift, edge, balls.delta, contacts, load)
    force, moment = load
    for k in range(3):
        contacts.force[k], contacts.force[3 + k] = force[k], moment[k]
