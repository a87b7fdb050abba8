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
from bearingwear.kernels.ball_response import shifted_state
from bearingwear.kernels.compile import inlined, jit
from bearingwear.kernels.contact import (
    LARGEST_AXIS,
    race_contacts,
    slip_coefficients,
    slip_map,
    traction,
    traction_slope,
)
from bearingwear.kernels.ellipse import Rule, contact_points, most_points
from bearingwear.kernels.equilibrium import orbit_load, thrust_equilibrium
from bearingwear.kernels.friction import friction_capacity, friction_coefficients
from bearingwear.kernels.params import BallState, Geometry, OperatingPoint
from bearingwear.kernels.profile import contact_approach
from bearingwear.kernels.status import BEYOND_GROOVE, CONTACT_LOST, OK, OUTSIDE_HERTZ_RANGE

LAST_BIT = 2.0**-50  # of the ball's speeds, with what the sums that make a slip of them add

# The step in orbit rate that differentiates the centrifugal force, as a share of the speeds: small
# enough to move the slip by this share of v_r, but above rounding.
QUOTIENT_SLIP = 1e-2
LARGEST_QUOTIENT, SMALLEST_QUOTIENT = 1e-6, 1e-9
QUOTIENT_TRACTION = 1e-6  # the step in traction, as a share of the contact loads


class Preload(NamedTuple):
    """How the inner race is held."""

    constant_force: bool
    F_x: float  # preload, used if constant_force [N]
    delta_a: float  # axial displacement, used if not constant_force [m]


class ThrustBearing(NamedTuple):
    """A bearing under thrust, worn and turning; no arrays, which are dear to pass on."""

    g: Geometry
    D: float  # worn ball diameter [m]
    op: OperatingPoint
    preload: Preload
    traction: bool  # whether the balance of normal forces has it


class BalanceProblem(NamedTuple):
    """What a solve under thrust holds constant, and its buffers for n points a contact.

    The buffers lie side by side here: numba counts references to every array of a record within a
    record whenever it is read, which took 16 % of a solve.
    """

    bearing: ThrustBearing
    rule: Rule  # for the contact ellipses
    t: np.ndarray  # (n,) points of the contact at hand, if they depend on it
    weight: np.ndarray  # (n,)
    h: np.ndarray  # (2, n), row 0 inner, 1 outer
    width: np.ndarray  # (n,) see contact.half_width
    across: np.ndarray  # (m,) points across, likewise
    share: np.ndarray  # (m,)
    gradient: np.ndarray  # (4,), with traction (5,)
    hessian: np.ndarray  # (4, 4) or (5, 5)
    L: np.ndarray  # (4, 4)
    residual: np.ndarray  # (k,) of the k = 4 unknowns, with traction 6
    shifted: np.ndarray  # (k,)
    jacobian: np.ndarray  # (k, k)
    matrix: np.ndarray  # (k, k)
    step: np.ndarray  # (k,)
    trial: np.ndarray  # (k,)


class Seat(NamedTuple):
    """Where the inner race and the ball stand."""

    delta_a: float  # axial displacement of the race [m]
    state: BallState


class Rounding(NamedTuple):
    """What the last bits of speeds and places make of the balance."""

    share: float  # of the friction forces [1]
    power: float  # [W]
    light: float  # the part of `share` that comes from a light load [1]


@jit
def balance_problem(bearing, rule):
    """The balance of a bearing by a rule, its buffers not yet filled."""
    n, m = most_points(rule), rule.across.size
    k, f = (6, 5) if bearing.traction else (4, 4)
    return BalanceProblem(
        bearing=bearing,
        rule=rule,
        t=np.empty(n),
        weight=np.empty(n),
        h=np.empty((2, n)),
        width=np.zeros(n),
        across=np.zeros(m),
        share=np.ones(m),
        gradient=np.empty(f),
        hessian=np.empty((f, f)),
        L=np.empty((4, 4)),
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
    bearing : ThrustBearing
    near : Seat
        The start.

    Returns
    -------
    Seat
    """
    return loaded_equilibrium(bearing, orbit_load(Omega, 0.0, 0.0), near)


@jit
def motion_equilibrium(bearing, u, near):
    """Ball and race at the motion u (4,), or (6,) with its tractions, from the start `near`."""
    T_i, T_o = (u[4], u[5]) if u.size > 4 else (0.0, 0.0)
    return loaded_equilibrium(bearing, orbit_load(u[3], T_i, T_o), near)


@jit
def loaded_equilibrium(bearing, load, near):
    """Ball and race under the load of a ball, from the start `near`."""
    preload = bearing.preload
    delta_a = near.delta_a if preload.constant_force else preload.delta_a
    delta_a, state = thrust_equilibrium(
        bearing.g, bearing.D, load, preload.F_x, delta_a, preload.constant_force, near.state
    )
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
    p : BalanceProblem
    v_r : float
        Regularisation, which may differ from that of the operating point [m/s].
    state : BallState
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
    rule = p.rule
    r = g.R_o + state.X2
    R = 0.5 * D
    J = p.jacobian
    L = p.L
    out[:] = 0.0
    if slope:
        J[:, :] = 0.0
    contacts = race_contacts(g, op, state)
    for k in range(2):
        contact = contacts[k]
        if contact.a >= LARGEST_AXIS * R:
            return OUTSIDE_HERTZ_RANGE
        h = p.h[k]
        c = slip_coefficients(contact, u, r)
        across, share = p.across, p.share
        t, weight = contact_points(
            rule, contact, R, c, v_r, p.t, p.weight, h, p.width, across, share
        )
        slip_map(contact, r, L)
        if slope:
            traction_slope(
                contact, c, contact.mu, v_r, t, weight, h, p.width, across, share, p.gradient,
                p.hessian,
            )  # fmt: skip
            subtract_projected(L, p.hessian, J)
        else:
            traction(contact, c, contact.mu, v_r, t, weight, h, p.width, across, share, p.gradient)
        subtract_gradient(L, p.gradient, out)
        if u.size > 4:
            out[4 + k] = R * (p.gradient[4] - u[4 + k])
            if slope:
                J[4 + k, 4 + k] = -R
                for j in range(4):
                    for q in range(4):
                        J[4 + k, j] += R * p.hessian[4, q] * L[q, j]
    add_gyration_and_drag(g, D, op, u, r, out, J, slope)
    return OK


@jit
def add_quotient(p, v_r, seat, u, column, change):
    """Add to a column of the Jacobian what the loads make of a change of its unknown."""
    bearing = p.bearing
    if bearing.traction:
        load, by = orbit_load(u[3], u[4], u[5]), change
        moved = shifted_state(
            bearing.g, bearing.D, load, seat.delta_a, bearing.preload.constant_force, seat.state,
            by if column == 3 else 0.0, by if column == 4 else 0.0, by if column == 5 else 0.0,
        )  # fmt: skip
    else:
        moved = orbit_equilibrium(bearing, u[3] + change, seat).state
    if usable(moved) == OK:
        status = friction_balance(p, v_r, moved, u, p.shifted, False)
        if status == OK:
            for i in range(u.size):
                p.jacobian[i, column] += (p.shifted[i] - p.residual[i]) / change


@jit
def full_jacobian(p, v_r, seat, u):
    """Residual and Jacobian into `p`, the loads following the orbit rate.

    How the loads follow the orbit rate, and tractions, enters as a difference quotient.

    Returns
    -------
    int
        As `friction_balance`.
    """
    g, op = p.bearing.g, p.bearing.op
    status = friction_balance(p, v_r, seat.state, u, p.residual, True)
    if status != OK:
        return status
    scale = max(abs(u[3]), abs(op.omega_i), abs(op.omega_o))
    if scale > 0.0:
        by_slip = QUOTIENT_SLIP * v_r / (scale * g.dm)
        dOmega = scale * min(LARGEST_QUOTIENT, max(SMALLEST_QUOTIENT, by_slip))
        add_quotient(p, v_r, seat, u, 3, dOmega)
    if u.size > 4:
        dT = QUOTIENT_TRACTION * (seat.state.Q_i + seat.state.Q_o)
        add_quotient(p, v_r, seat, u, 4, dT)
        add_quotient(p, v_r, seat, u, 5, dT)
    return OK


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
    """What the last bits of speeds and places make of the balance, and of its power.

    Slip is a small difference of large speeds: at a small v_r the speeds cannot be stored finely
    enough to balance friction any better. Nor can a light load, whose deformation is a small
    difference of large lengths.

    Parameters
    ----------
    J : ndarray (k, k)
        Jacobian of the balance by u.

    Returns
    -------
    Rounding
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
