"""Linear response of a steady ball to displacements of its inner groove (theory.md section 2).

The balance of motion and the force of the inner race, both linearised about the state, make one
bordered matrix. Its Schur complement is the stiffness against displacements slower than the motion
follows.
"""

import math

from bearingwear.kernels.ball import ball_mass
from bearingwear.kernels.contact.changes import add_axis_changes, exact_changes
from bearingwear.kernels.contact.hertz import axes_by_angle
from bearingwear.kernels.contact.points import area_shares, contact_points
from bearingwear.kernels.contact.profile import contact_approach
from bearingwear.kernels.contact.slip import race_contacts, slip_coefficients
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.equilibrium.ball_response import (
    contact_rates,
    further_force,
    joined_step,
    seated_legs,
    tangent_at,
)
from bearingwear.kernels.linear import copy, solve_in_place
from bearingwear.kernels.status import OK
from bearingwear.kernels.steady.balance import (
    Preload,
    ThrustBearing,
    add_friction_change,
    friction_balance,
    motion_equilibrium,
    motion_load,
)

ALONG = 1e-5  # of the inner approach: the step of a difference


@jit
def find_exact_changes(p, state, u, by_axes):
    """Make `p.change`, as `friction_balance` has left it at a state, exact.

    Parameters
    ----------
    by_axes : ndarray (2, 5)
        A buffer.
    """
    g, D, op, R = p.bearing.g, p.bearing.D, p.bearing.op, 0.5 * p.bearing.D
    contacts, v_r = race_contacts(g, op, state), op.v_r
    for k in range(2):
        contact = contacts[k]
        hertz = state.hertz_i if k == 0 else state.hertz_o
        c = slip_coefficients(contact, u, g.R_o + state.X2)
        points = contact_points(p.rule, contact, R, c, v_r, p.points)
        by_axes[:, :] = 0.0
        by_a, by_b = by_axes[0], by_axes[1]
        add_axis_changes(contact, c, contact.mu - contact.mu_even, R, v_r, points, by_a, by_b)
        if contact.mu_even > 0.0:
            area_shares(p.rule, contact, R, c, v_r, points)
            add_axis_changes(contact, c, contact.mu_even, R, v_r, points, by_a, by_b)
        axes = axes_by_angle(g, contact.sigma, D, contact.sin_a, contact.cos_a, hertz)
        exact_changes(contact.Q, axes, p.gradient[k], p.even[k], by_a, by_b, p.change[k])


@jit
def linear_response(p, seat, u, out):
    """How balance and inner force follow the motion and displacements of the inner groove.

    Parameters
    ----------
    p : BalanceProblem
        As `friction_balance` has left it at this state, with its slope.
    u : ndarray (k,)
        Motion (w_x, w_y, w_z, Omega), and tractions.
    out : ndarray (k + 2, k + 2)
        Filled: rows are the residuals of the balance, and the axial and radial force of the inner
        race on the ball; columns the unknowns u, and the axial and radial displacement.
    """
    g, D, state, load, k = p.bearing.g, p.bearing.D, seat.state, motion_load(u), u.size
    m, rates = ball_mass(g.rho, D), p.rates[0]
    legs = seated_legs(g, D, seat.delta_a, state)
    t = tangent_at(m, load, legs)
    out[:, :] = 0.0
    copy(p.jacobian, out[:k, :k])
    for v in range(k - 3):
        dX1, dX2, _ = joined_step(t, False, *further_force(g, m, load, legs, state.X2, v), 0.0)
        out[k, 3 + v] = -t.i11 * dX1 - t.i12 * dX2
        out[k + 1, 3 + v] = -t.i21 * dX1 - t.i22 * dX2
        contact_rates(g, D, legs, dX1, dX2, 0.0, 0.0, rates)
        add_friction_change(p, u, rates, out, 3 + v)
    if k > 4:  # the inner traction bears on the race itself
        out[k, 4] += legs.inner.c
        out[k + 1, 4] -= legs.inner.s
    for d in range(2):
        i1, i2 = (t.i11, t.i21) if d == 0 else (t.i12, t.i22)
        dX1, dX2, _ = joined_step(t, False, i1, i2, 0.0)
        out[k, k + d] = i1 - t.i11 * dX1 - t.i12 * dX2
        out[k + 1, k + d] = i2 - t.i21 * dX1 - t.i22 * dX2
        contact_rates(g, D, legs, dX1, dX2, 1.0 - d, d, rates)
        add_friction_change(p, u, rates, out, k + d)


@jit
def quasistatic_stiffness(p, v_r, seat, u, response):
    """Axial stiffness of one ball's inner force, its motion following the place [N/m].

    The response holds the points of a split rule, which gather where slip reverses. What their
    moves change is one difference along the way of place and motion that the response leads to.

    Parameters
    ----------
    p : BalanceProblem
        With the residual of this state; its buffers are overwritten.
    response : ndarray (k + 2, k + 2)
        See `linear_response`.
    """
    k, b, state = p.step.size, p.bearing, seat.state
    S = response[k, k]
    copy(response[:k, k], p.step)
    if not solve_motion(p, response):
        return math.nan
    if p.rule.split and p.rule.across.size > 1:  # those along move too little to show
        way = ALONG * contact_approach(state.hertz_i.K, state.Q_i)
        for v in range(k):
            p.trial[v] = u[v] - way * p.step[v]
        held = Preload(constant_force=False, F_x=0.0, delta_a=seat.delta_a + way)
        near = motion_equilibrium(held_bearing(b, held), p.trial, seat).state
        status = near.status
        if status == OK:
            status = friction_balance(p, v_r, near, p.trial, p.shifted, False)
        if status != OK:
            return math.nan
        S = (near.F_ix - state.F_ix) / way
        for v in range(k):
            p.step[v] = (p.shifted[v] - p.residual[v]) / way
        solve_motion(p, response)
    for v in range(k):
        S -= response[k, v] * p.step[v]
    return S


@jit
def solve_motion(p, response):
    """Divide `p.step` by the Jacobian of a response; False where it is singular."""
    k = p.step.size
    copy(response[:k, :k], p.matrix)
    return solve_in_place(p.matrix, p.step, k)


@jit
def held_bearing(b, preload):
    """A bearing with another preload."""
    return ThrustBearing(g=b.g, D=b.D, op=b.op, preload=preload, traction=b.traction)
