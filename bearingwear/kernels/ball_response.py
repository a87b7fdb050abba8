"""How a ball between its grooves gives way to small changes of its load (theory.md section 4).

Exact derivatives of the equilibrium, but for the Hertz factors, which follow the contact angles so
weakly that equilibrium.py leaves them out of the tangent as well. They make a Jacobian for the
price of one look at the contacts, where solving the equilibrium anew would take ten.
"""

import math

from bearingwear.kernels.ball import ball_mass
from bearingwear.kernels.compile import inlined, jit
from bearingwear.kernels.equilibrium import (
    ball_tangent,
    body_forces,
    closed_ball,
    direction_cosine,
    groove_distance,
    spring,
)
from bearingwear.kernels.hertz import INNER, OUTER, race_contact
from bearingwear.kernels.status import OK


@inlined
def race_tangent(load, inner, length):
    """Derivative of the inner race's force on a ball by the place of its groove centre [N/m].

    Returns
    -------
    k11, k12, k21 : float
    """
    t = load.T_i / length
    return (
        inner.k11 - t * inner.s * inner.c,
        inner.k12 + t * inner.s * inner.s,
        inner.k12 - t * inner.c * inner.c,
    )


@jit
def shifted_state(g, D, load, delta_a, constant_force, state, dOmega, dT_i, dT_o):
    """A ball in equilibrium under thrust, after small changes of its load, to first order.

    Parameters
    ----------
    load : BallLoad
        Before the changes; of a given orbit.
    delta_a : float
        Displacement of the race, which follows if `constant_force` [m].
    state : BallState
        Before the changes, both contacts closed.
    dOmega : float
        Change of the orbit rate [rad/s].
    dT_i, dT_o : float
        Changes of the tractions [N].

    Returns
    -------
    BallState
    """
    free_i, free_o = g.r_i - 0.5 * D, g.r_o - 0.5 * D
    X1, X2, hertz_i, hertz_o = state.X1, state.X2, state.hertz_i, state.hertz_o
    A1, A2 = groove_distance(g, 0.0, delta_a, 0.0, 0.0, 0.0)
    outer = spring(hertz_o.K, X1, X2, free_o)
    inner = spring(hertz_i.K, A1 - X1, A2 - X2, free_i)
    m, r = ball_mass(g.rho, D), g.R_o + X2
    P_1 = dT_i * inner.c + dT_o * outer.c
    P_2 = 2.0 * m * r * load.Omega * dOmega - dT_i * inner.s - dT_o * outer.s
    k11, k12, k21, k22 = ball_tangent(
        g, D, load, A1, A2, X1, X2, inner, outer, state.P_x, state.P_r
    )
    k22 -= m * load.Omega * load.Omega
    det = k11 * k22 - k12 * k21
    dX1, dX2 = (k22 * P_1 - k12 * P_2) / det, (k11 * P_2 - k21 * P_1) / det
    if constant_force:
        length = math.sqrt((A1 - X1) ** 2 + (A2 - X2) ** 2)
        i11, i12, i21 = race_tangent(load, inner, length)
        by_1, by_2 = (k22 * i11 - k12 * i21) / det, (k11 * i21 - k21 * i11) / det
        step = (i11 * dX1 + i12 * dX2 - dT_i * inner.c) / (i11 - i11 * by_1 - i12 * by_2)
        A1 += step
        dX1, dX2 = dX1 + by_1 * step, dX2 + by_2 * step
    X1, X2 = X1 + dX1, X2 + dX2
    hertz_o = race_contact(g, OUTER, D, direction_cosine(X1, X2), hertz_o.log_kappa)
    hertz_i = race_contact(g, INNER, D, direction_cosine(A1 - X1, A2 - X2), hertz_i.log_kappa)
    outer = spring(hertz_o.K, X1, X2, free_o)
    inner = spring(hertz_i.K, A1 - X1, A2 - X2, free_i)
    P_x, P_r, T_i = body_forces(g, D, load, X2, inner.s, inner.c, outer.s, outer.c)
    return closed_ball(OK, X1, X2, inner, outer, hertz_i, hertz_o, P_x, P_r, T_i, 0.0)
