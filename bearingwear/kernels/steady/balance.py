"""Friction balance of a ball under thrust: its equations of motion (theory.md section 4).

One ball stands for all. Unknown are its angular velocity and orbit rate, u = (w_x, w_y, w_z,
Omega); zero are the three moments and the orbital force on it. Where ball and race stand follows
from the orbit rate. With traction in the balance of normal forces it follows from the two tractions
along the first contact axes as well: these are unknown too, u = (..., T_i, T_o), and zero is what
friction gives more than them.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.ball import ball_inertia, ball_mass, drag_force
from bearingwear.kernels.contact.changes import BY_RADIUS, gradient_changes, slip_changes
from bearingwear.kernels.contact.film_friction import add_even_part
from bearingwear.kernels.contact.friction import friction_capacity, friction_coefficients
from bearingwear.kernels.contact.points import Points, Rule, contact_points, point_buffers
from bearingwear.kernels.contact.profile import contact_approach
from bearingwear.kernels.contact.slip import LARGEST_AXIS, race_contacts, slip_coefficients
from bearingwear.kernels.contact.traction import traction, traction_slope
from bearingwear.kernels.decorators import inlined, jit
from bearingwear.kernels.equilibrium.ball_response import joined_equilibrium, load_rates
from bearingwear.kernels.equilibrium.thrust_loaded import (
    ball_equilibrium,
    groove_distance,
    orbit_load,
    thrust_equilibrium,
)
from bearingwear.kernels.params import BallState, Geometry, OperatingPoint
from bearingwear.kernels.status import BEYOND_GROOVE, CONTACT_LOST, OK, OUTSIDE_HERTZ_RANGE

LAST_BIT = 2.0**-50  # of the ball's speeds, with what the sums that make a slip of them add


class Preload(NamedTuple):
    """How the inner race is held."""

    constant_force: bool
    F_x: float  # preload, used if constant_force [N]
    delta_a: float  # axial displacement, used if not constant_force [m]


class ThrustBearing(NamedTuple):
    """A bearing under thrust, worn and turning; no arrays, which are expensive to pass."""

    g: Geometry
    D: float  # worn ball diameter [m]
    op: OperatingPoint
    preload: Preload
    traction: bool  # whether the balance of normal forces has it


class BalanceProblem(NamedTuple):
    """What a solve under thrust holds constant, and its buffers."""

    bearing: ThrustBearing
    rule: Rule  # for the contact ellipses
    points: Points  # of the contact at hand
    gradient: np.ndarray  # (2, 4), with traction (2, 5)
    hessian: np.ndarray  # (4, 4) or (5, 5)
    even: np.ndarray  # (2, 4) or (2, 5), the part of `gradient` of a film that shears evenly
    even_hessian: np.ndarray  # (4, 4) or (5, 5)
    L: np.ndarray  # (2, 4, 6) see contact_changes.slip_changes
    change: np.ndarray  # (2, 5, 7) see contact_changes.gradient_changes
    rates: np.ndarray  # (3, 2, 3) see ball_response.load_rates
    residual: np.ndarray  # (k,) of the k = 4 unknowns, with traction 6
    shifted: np.ndarray  # (k,)
    jacobian: np.ndarray  # (k, k)
    matrix: np.ndarray  # (k, k)
    step: np.ndarray  # (k,)
    trial: np.ndarray  # (k,)


class Seat(NamedTuple):
    """Places of the inner race and the ball."""

    delta_a: float  # axial displacement of the race [m]
    state: BallState


class Rounding(NamedTuple):
    """Effect of rounding of speeds and places on the balance."""

    share: float  # of the friction forces [1]
    power: float  # [W]
    light: float  # the part of `share` that comes from a light load [1]


@jit
def balance_problem(bearing, rule, traction):
    """The balance of a bearing by a rule, tractions unknown or left out; its buffers are empty."""
    k, f = (6, 5) if traction else (4, 4)
    return BalanceProblem(
        bearing=bearing,
        rule=rule,
        points=point_buffers(rule),
        gradient=np.empty((2, f)),
        hessian=np.empty((f, f)),
        even=np.zeros((2, f)),
        even_hessian=np.empty((f, f)),
        L=np.zeros((2, 4, 6)),
        change=np.empty((2, 5, 7)),
        rates=np.empty((3, 2, 3)),
        residual=np.empty(k),
        shifted=np.empty(k),
        jacobian=np.empty((k, k)),
        matrix=np.empty((k, k)),
        step=np.empty(k),
        trial=np.empty(k),
    )


@jit
def orbit_equilibrium(bearing, Omega, near):
    """Ball and race at the orbit rate Omega [rad/s].

    Parameters
    ----------
    near : Seat
        The start.
    """
    return loaded_equilibrium(bearing, orbit_load(Omega, 0.0, 0.0), near)


@jit
def motion_equilibrium(bearing, u, near):
    """Ball and race at the motion u (4,), or (6,) with its tractions, from the start `near`."""
    return loaded_equilibrium(bearing, motion_load(u), near)


@jit
def loaded_equilibrium(bearing, load, near):
    """Ball and race under the load of a ball, from the start `near`."""
    g, D, preload = bearing.g, bearing.D, bearing.preload
    start = near.delta_a if preload.constant_force else preload.delta_a
    args = g, D, load, preload.F_x, start, preload.constant_force
    if bearing.traction:
        state = near.state
        if state.status != OK:  # the ball alone first: both together take half as long then
            A1, A2 = groove_distance(g, 0.0, start, 0.0, 0.0, 0.0)
            state = ball_equilibrium(g, D, load, A1, A2, state)
        if state.status == OK and state.Q_i > 0.0:
            delta_a, state = joined_equilibrium(*args, state)
            if state.status == OK:
                return Seat(delta_a=delta_a, state=state)
    delta_a, state = thrust_equilibrium(*args, near.state)
    return Seat(delta_a=delta_a, state=state)


@jit
def usable(state):
    """Status of a ball equilibrium: OK only with both contacts closed, within the grooves."""
    if state.status == OK and not (state.Q_i > 0.0 and state.Q_o > 0.0):
        return CONTACT_LOST
    if state.status == OK and not (
        0.0 < state.alpha_i < 0.5 * math.pi and 0.0 <= state.alpha_o < 0.5 * math.pi
    ):
        return BEYOND_GROOVE
    return state.status


@inlined
def subtract_gradient(L, gradient, out):
    """out -= L^T gradient."""
    for i in range(4):
        for p in range(4):
            out[i] -= L[p, i] * gradient[p]


@inlined
def subtract_projected(L, H, J):
    """J -= L^T H L."""
    for i in range(4):
        for p in range(4):
            if L[p, i] != 0.0:
                for j in range(4):
                    s = 0.0
                    for q in range(4):
                        s += H[p, q] * L[q, j]
                    J[i, j] -= L[p, i] * s


@jit
def add_gyration_and_drag(g, D, op, u, r, out, J, slope):
    """Add the gyroscopic moment and the drag on a ball to `out`, and where asked to `J` by u."""
    inertia = ball_inertia(ball_mass(g.rho, D), D)
    out[1] += inertia * u[3] * u[2]
    out[2] -= inertia * u[3] * u[1]
    F_v, dF_v = drag_force(g, D, op.drag, u[3])
    out[3] -= r * F_v
    if slope:
        J[1, 2] += inertia * u[3]
        J[1, 3] += inertia * u[2]
        J[2, 1] -= inertia * u[3]
        J[2, 3] -= inertia * u[1]
        J[3, 3] -= r * dF_v


@jit
def friction_balance(p, v_r, state, u, out, slope):
    """Moments and orbital moment on the ball: its equations of motion's right-hand side.

    Parameters
    ----------
    v_r : float
        Regularisation, which may differ from that of the operating point [m/s].
    u : ndarray (k,)
        (w_x, w_y, w_z, Omega) [rad/s], and (T_i, T_o) [N].
    out : ndarray (k,)
        Filled: I dw_x/dt, I dw_y/dt, I dw_z/dt, m r^2 dOmega/dt; and R times what friction gives
        more than T_i and T_o [N m].
    slope : bool
        Whether to fill `p.jacobian` too: d out/du with the loads held.

    Returns
    -------
    int
        OUTSIDE_HERTZ_RANGE where an ellipse is as large as its ball, else OK.
    """
    g, D, op = p.bearing.g, p.bearing.D, p.bearing.op
    r, R = g.R_o + state.X2, 0.5 * D
    J = p.jacobian
    out[:] = 0.0
    if slope:
        J[:, :] = 0.0
    contacts = race_contacts(g, op, state)
    for k in range(2):
        contact = contacts[k]
        if contact.a >= LARGEST_AXIS * R:
            return OUTSIDE_HERTZ_RANGE
        c = slip_coefficients(contact, u, r)
        points = contact_points(p.rule, contact, R, c, v_r, p.points)
        L, gradient = p.L[k], p.gradient[k]
        slip_changes(contact, c, r, L)
        mu = contact.mu - contact.mu_even
        if slope:
            traction_slope(contact, c, mu, v_r, points, gradient, p.hessian)
        else:
            traction(contact, c, mu, v_r, points, gradient)
        if contact.mu_even > 0.0:
            add_even_part(
                p.rule, contact, R, c, v_r, points, p.even[k], p.even_hessian, gradient, p.hessian,
                slope,
            )  # fmt: skip
        if slope:
            subtract_projected(L, p.hessian, J)
            gradient_changes(contact, R, c, gradient, p.even[k], p.hessian, L, p.change[k])
        subtract_gradient(L, gradient, out)
        if u.size > 4:
            out[4 + k] = R * (gradient[4] - u[4 + k])
            if slope:
                J[4 + k, 4 + k] = -R
                for j in range(4):
                    J[4 + k, j] += R * p.change[k, 4, j]
    add_gyration_and_drag(g, D, op, u, r, out, J, slope)
    return OK


@jit
def add_friction_change(p, u, rates, J, column):
    """Add to a column of J how the balance follows changes of the contacts, the motion held.

    From the changes of the friction of both contacts that `friction_balance` has left in `p`.

    Parameters
    ----------
    rates : ndarray (2, 3)
        Of orbit radius, angle and load of each contact, see `ball_response.contact_rates`.
    """
    b, R, dr = p.bearing, 0.5 * p.bearing.D, rates[0, 0]
    F_v, _ = drag_force(b.g, b.D, b.op.drag, u[3])
    J[3, column] -= dr * F_v
    for k in range(2):
        L, G, dalpha = p.L[k], p.gradient[k], rates[k, 1]
        for row in range(G.size):
            by = 0.0
            for q in range(3):
                by += p.change[k, row, BY_RADIUS + q] * rates[k, q]
            if row < 4:
                for i in range(4):
                    J[i, column] -= L[row, i] * by
            else:
                J[4 + k, column] += R * by
        # the levers change as well: L turns with the contact, and its arm is the orbit
        J[0, column] -= dalpha * (L[2, 2] * G[2] + L[3, 2] * G[3])
        J[2, column] += dalpha * (L[2, 0] * G[2] + L[3, 0] * G[3])
        J[3, column] -= dr * G[1]


@jit
def add_load_columns(p, seat, u):
    """Add to the Jacobian what the loads make of the orbit rate and the tractions."""
    b, load = p.bearing, motion_load(u)
    load_rates(b.g, b.D, load, seat.delta_a, b.preload.constant_force, seat.state, p.rates)
    for v in range(u.size - 3):
        add_friction_change(p, u, p.rates[v], p.jacobian, 3 + v)


@jit
def motion_load(u):
    """Load of a ball by its motion (4,), or (6,) with its tractions."""
    T_i, T_o = (u[4], u[5]) if u.size > 4 else (0.0, 0.0)
    return orbit_load(u[3], T_i, T_o)


@jit
def full_jacobian(p, v_r, seat, u):
    """Residual and Jacobian into `p`, the loads following the orbit rate and the tractions.

    Returns
    -------
    int
        As `friction_balance`.
    """
    status = friction_balance(p, v_r, seat.state, u, p.residual, True)
    if status == OK:
        add_load_columns(p, seat, u)
    return status


@jit
def balance_size(bearing, state, out):
    """Largest unbalanced moment or orbital force, as a share of the friction forces [1]."""
    mu_i, mu_o = friction_coefficients(bearing.op, state)
    r = bearing.g.R_o + state.X2
    return balance_share(bearing.D, r, friction_capacity(mu_i, mu_o, state.Q_i, state.Q_o), out)


@jit
def balance_share(D, r, capacity, out):
    """`balance_size` of a ball of diameter D on the orbit r [m] that friction holds with [N]."""
    moment = max(abs(out[0]), abs(out[1]), abs(out[2])) / (0.5 * D)
    for i in range(4, out.size):
        moment = max(moment, abs(out[i]) / (0.5 * D))
    return max(moment, abs(out[3]) / r) / capacity


@jit
def rounding(bearing, state, u, J):
    """Effect of rounding of speeds and places on the balance and its power.

    Slip is a small difference of large speeds: at a small v_r the speeds cannot be stored finely
    enough to balance friction any better. Nor can a light load, whose deformation is a small
    difference of large lengths.

    Parameters
    ----------
    J : ndarray (k, k)
        Jacobian of the balance by u.
    """
    g = bearing.g
    mu_i, mu_o = friction_coefficients(bearing.op, state)
    capacity = friction_capacity(mu_i, mu_o, state.Q_i, state.Q_o)
    d_i = contact_approach(state.hertz_i.K, state.Q_i)
    d_o = contact_approach(state.hertz_o.K, state.Q_o)
    light = 1.5 * LAST_BIT * max(g.r_i / d_i, g.r_o / d_o)
    share = light
    r, R = g.R_o + state.X2, 0.5 * bearing.D
    power = share * capacity * (r * abs(u[3]) + R * max(abs(u[0]), abs(u[2])))
    for i in range(u.size):
        left = 0.0
        for j in range(u.size):
            left += LAST_BIT * abs(J[i, j] * u[j])
        arm = r if i == 3 else R
        share = max(share, left / (arm * capacity))
        power += abs(u[i]) * left if i < 4 else 0.0
    return Rounding(share=share, power=power, light=light)
