"""Ball and inner race under thrust as one system, and how they give way (theory.md section 4).

The tangent is exact: tractions turn with the contact angles, and the Hertz factors follow them. So
Newton's method finds the equilibrium of both from a state nearby in a few steps, and derivatives of
the equilibrium cost one look at the contacts, where solving it anew would take ten.
"""

import math
from typing import NamedTuple

from bearingwear.kernels.ball import ball_mass
from bearingwear.kernels.contact.hertz import INNER, OUTER, angle_slope, race_contact
from bearingwear.kernels.contact.profile import contact_stiffness
from bearingwear.kernels.decorators import inlined, jit
from bearingwear.kernels.equilibrium.body_forces import body_forces, unbalanced_force
from bearingwear.kernels.equilibrium.thrust_loaded import (
    FORCE_BALANCED,
    LAST_STEP,
    Spring,
    closed_ball,
    cold_start,
    direction_cosine,
    groove_distance,
    spring,
)
from bearingwear.kernels.status import OK

JOINED_STEPS = 12  # from nearby four or five do


class Legs(NamedTuple):
    """Both contacts of a ball as springs."""

    inner: Spring
    outer: Spring
    length_i: float  # [m]
    length_o: float
    follow_i: float  # derivative of the load by the contact angle, the length held [N]
    follow_o: float


class Tangent(NamedTuple):
    """Derivatives of forces by places [N/m]."""

    k11: float  # of the force on the ball, against its own displacement
    k12: float
    k21: float
    k22: float
    i11: float  # of the inner race's force on the ball, by the displacement of the race
    i12: float
    i21: float
    i22: float
    det: float


@inlined
def legs_at(g, D, A1, A2, X1, X2, hertz_i, hertz_o):
    """The contacts of a ball whose centre is at (X1, X2)."""
    inner = spring(hertz_i.K, A1 - X1, A2 - X2, g.r_i - 0.5 * D)
    outer = spring(hertz_o.K, X1, X2, g.r_o - 0.5 * D)
    return Legs(
        inner=inner,
        outer=outer,
        length_i=math.sqrt((A1 - X1) ** 2 + (A2 - X2) ** 2),
        length_o=math.sqrt(X1 * X1 + X2 * X2),
        follow_i=inner.Q * angle_slope(g, INNER, D, inner.s, inner.c, hertz_i),
        follow_o=outer.Q * angle_slope(g, OUTER, D, outer.s, outer.c, hertz_o),
    )


@inlined
def tangent_at(m, load, legs):
    """Tangent of a ball of mass m [kg] and of its race."""
    inner, outer = legs.inner, legs.outer
    # what the forces gain across themselves as they turn [N/m]
    t_i, t_o = (
        (legs.follow_i - load.T_i) / legs.length_i,
        (legs.follow_o + load.T_o) / legs.length_o,
    )
    i11, i12 = inner.k11 + t_i * inner.s * inner.c, inner.k12 - t_i * inner.s * inner.s
    i21, i22 = inner.k12 + t_i * inner.c * inner.c, inner.k22 - t_i * inner.s * inner.c
    k11, k12 = i11 + outer.k11 + t_o * outer.s * outer.c, i12 + outer.k12 - t_o * outer.s * outer.s
    k21, k22 = i21 + outer.k12 + t_o * outer.c * outer.c, i22 + outer.k22 - t_o * outer.s * outer.c
    k22 -= m * load.Omega * load.Omega
    det = k11 * k22 - k12 * k21
    return Tangent(k11=k11, k12=k12, k21=k21, k22=k22, i11=i11, i12=i12, i21=i21, i22=i22, det=det)


@jit
def joined_step(k, constant_force, P_1, P_2, P):
    """Steps of a ball and its race that answer further forces on them.

    Parameters
    ----------
    constant_force : bool
        Whether the race follows.
    P_1, P_2 : float
        On the ball, axial and radial [N].
    P : float
        On the race, axial, from one ball [N].

    Returns
    -------
    dX1, dX2, d_delta : float
        [m]
    """
    dX1, dX2 = (k.k22 * P_1 - k.k12 * P_2) / k.det, (k.k11 * P_2 - k.k21 * P_1) / k.det
    step = 0.0
    if constant_force:
        by_1 = (k.k22 * k.i11 - k.k12 * k.i21) / k.det
        by_2 = (k.k11 * k.i21 - k.k21 * k.i11) / k.det
        step = (P + k.i11 * dX1 + k.i12 * dX2) / (k.i11 - k.i11 * by_1 - k.i12 * by_2)
        dX1, dX2 = dX1 + by_1 * step, dX2 + by_2 * step
    return dX1, dX2, step


@jit
def joined_equilibrium(g, D, load, F_x, delta_a, constant_force, start):
    """`equilibrium.thrust_equilibrium` from a state nearby, both contacts closed all the way.

    Parameters
    ----------
    load : BallLoad
        Of a given orbit.

    Returns
    -------
    delta_a : float
        [m]
    state : BallState
        status NOT_CONVERGED where Newton's steps do not lead there: the start was not near.
    """
    m, P = ball_mass(g.rho, D), F_x / g.n_balls
    X1, X2, hertz_i, hertz_o = start.X1, start.X2, start.hertz_i, start.hertz_o
    size = math.inf
    for _ in range(JOINED_STEPS):
        A1, A2 = groove_distance(g, 0.0, delta_a, 0.0, 0.0, 0.0)
        hertz_i = race_contact(g, INNER, D, direction_cosine(A1 - X1, A2 - X2), hertz_i.log_kappa)
        hertz_o = race_contact(g, OUTER, D, direction_cosine(X1, X2), hertz_o.log_kappa)
        legs = legs_at(g, D, A1, A2, X1, X2, hertz_i, hertz_o)
        inner, outer = legs.inner, legs.outer
        if not (inner.Q > 0.0 and outer.Q > 0.0):
            break
        P_x, P_r, T_i = body_forces(g, D, load, X2, inner.s, inner.c, outer.s, outer.c)
        r1, r2 = unbalanced_force(inner, outer, P_x, P_r)
        left = P - inner.Q * inner.s - T_i * inner.c if constant_force else 0.0
        if size <= LAST_STEP * math.sqrt(A1 * A1 + A2 * A2) and abs(left) <= FORCE_BALANCED * P:
            residual = math.sqrt(r1 * r1 + r2 * r2)
            return delta_a, closed_ball(
                OK, X1, X2, inner, outer, hertz_i, hertz_o, P_x, P_r, T_i, residual
            )
        k = tangent_at(m, load, legs)
        if not k.det > 0.0:
            break
        dX1, dX2, d_delta = joined_step(k, constant_force, r1, r2, left)
        X1, X2, delta_a = X1 + dX1, X2 + dX2, delta_a + d_delta
        size = abs(dX1) + abs(dX2) + abs(d_delta)
    return delta_a, cold_start()


@jit
def seated_legs(g, D, delta_a, state):
    """The contacts of a ball in equilibrium, the race at `delta_a` [m]."""
    A1, A2 = groove_distance(g, 0.0, delta_a, 0.0, 0.0, 0.0)
    return legs_at(g, D, A1, A2, state.X1, state.X2, state.hertz_i, state.hertz_o)


@jit
def further_force(g, m, load, legs, X2, v):
    """Axial and radial force on a ball by its orbit rate (v = 0), T_i (1) and T_o (2)."""
    if v == 0:
        return 0.0, 2.0 * m * (g.R_o + X2) * load.Omega
    leg = legs.inner if v == 1 else legs.outer
    return leg.c, -leg.s


@jit
def contact_rates(g, D, legs, dX1, dX2, d1, d2, rates):
    """Changes of orbit radius [m], contact angles [rad] and loads [N] as ball and groove move.

    Parameters
    ----------
    dX1, dX2, d1, d2 : float
        Displacements of the ball's centre and of the inner groove's, axial and radial [m].
    rates : ndarray (2, 3)
        Filled, a row for each contact.
    """
    inner, outer = legs.inner, legs.outer
    d1, d2 = d1 - dX1, d2 - dX2
    turn_i = (inner.c * d1 - inner.s * d2) / legs.length_i
    turn_o = (outer.c * dX1 - outer.s * dX2) / legs.length_o
    stiff_i = contact_stiffness(inner.Q, legs.length_i - g.r_i + 0.5 * D)
    stiff_o = contact_stiffness(outer.Q, legs.length_o - g.r_o + 0.5 * D)
    rates[0, 0] = rates[1, 0] = dX2
    rates[0, 1], rates[1, 1] = turn_i, turn_o
    rates[0, 2] = stiff_i * (inner.s * d1 + inner.c * d2) + legs.follow_i * turn_i
    rates[1, 2] = stiff_o * (outer.s * dX1 + outer.c * dX2) + legs.follow_o * turn_o


@jit
def load_rates(g, D, load, delta_a, constant_force, state, rates):
    """How a ball's contacts follow its orbit rate and its tractions.

    Parameters
    ----------
    load : BallLoad
        Of a given orbit.
    delta_a : float
        Displacement of the race, which follows if `constant_force` [m].
    state : BallState
        Its equilibrium, both contacts closed.
    rates : ndarray (3, 2, 3)
        Filled: `contact_rates` by Omega, T_i and T_o.
    """
    m = ball_mass(g.rho, D)
    legs = seated_legs(g, D, delta_a, state)
    k = tangent_at(m, load, legs)
    for v in range(3):
        P_1, P_2 = further_force(g, m, load, legs, state.X2, v)
        P = -legs.inner.c if v == 1 else 0.0
        dX1, dX2, step = joined_step(k, constant_force, P_1, P_2, P)
        contact_rates(g, D, legs, dX1, dX2, step, 0.0, rates[v])
