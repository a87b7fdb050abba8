"""Friction and wear of a ball between two worn grooves (theory.md section 21).

The friction of a worn contact is that of the Hertz contact it would be unworn, by the rule of the
ellipse, and what its cells add to it: those worn less those unworn. Without wear nothing is added.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.ball import ball_inertia, drag_force
from bearingwear.kernels.compile import jit
from bearingwear.kernels.contact import (
    LARGEST_AXIS,
    dissipation,
    half_width,
    loaded_contact,
    slip_coefficients,
    slip_map,
    surface_height,
    traction_slope,
)
from bearingwear.kernels.ellipse import most_points, place_across, quadrature_points
from bearingwear.kernels.friction import friction_capacity
from bearingwear.kernels.level_solver import DESCENT, HALVINGS, NEWTON_STEPS, STALLED
from bearingwear.kernels.linear import copy, solve_in_place
from bearingwear.kernels.profile import contact_load
from bearingwear.kernels.status import NOT_CONVERGED, OK, OUTSIDE_HERTZ_RANGE
from bearingwear.kernels.steady_balance import subtract_gradient, subtract_projected
from bearingwear.kernels.worn_balance import BallPush, worn_seat

FRICTION_LEFT = 1e-12  # as a share of the friction forces, where Newton ends [1]
WORN_ROUNDS = 60  # of normal and friction balance
ROUND_LEFT = 1e-8  # change of the ball's other forces from round to round, over the load [1]
SHALLOW = 0.05  # least slope that a secant on the pitch of the axis is taken with
NARROW = 1e-11  # bracket of the pitch that is none [rad]
LARGEST_TURN = 0.02  # of the axis from round to round [rad]
LEVELS = 5  # of v_r, each
LEVEL_RATIO = 4.0  # times the next, where Newton fails from the last motion


class FrictionWork(NamedTuple):
    """Buffers of the friction balance."""

    t: np.ndarray
    weight: np.ndarray
    h: np.ndarray
    width: np.ndarray
    across: np.ndarray
    share: np.ndarray
    gradient: np.ndarray  # (5,), with the force along the major axis
    hessian: np.ndarray  # (5, 5)
    part_gradient: np.ndarray
    part_hessian: np.ndarray
    L: np.ndarray  # (4, 4)
    residual: np.ndarray  # (4,)
    jacobian: np.ndarray  # (4, 4)
    matrix: np.ndarray
    step: np.ndarray
    trial: np.ndarray
    ones: np.ndarray  # (2,) the two sides of the cells: places,
    halves: np.ndarray  # (2,) and shares
    row_h: np.ndarray  # (most cells along,)
    row_width: np.ndarray
    row_weight: np.ndarray
    row_t: np.ndarray


@jit
def friction_work(rule, n):
    """Buffers for a rule and n cells along the major axis."""
    k, m = most_points(rule), rule.across.size
    ones = np.ones(2)
    ones[1] = -1.0
    return FrictionWork(
        t=np.empty(k), weight=np.empty(k), h=np.empty(k), width=np.zeros(k),
        across=np.zeros(m), share=np.ones(m), gradient=np.empty(5), hessian=np.empty((5, 5)),
        part_gradient=np.empty(5), part_hessian=np.empty((5, 5)), L=np.empty((4, 4)),
        residual=np.empty(4), jacobian=np.empty((4, 4)), matrix=np.empty((4, 4)),
        step=np.empty(4), trial=np.empty(4), ones=ones, halves=np.full(2, 0.5),
        row_h=np.empty(n), row_width=np.empty(n), row_weight=np.empty(n), row_t=np.empty(n),
    )  # fmt: skip


@jit
def unworn_contact(g, op, k, force):
    """The Hertz contact that a worn one is counted from."""
    Q = contact_load(force.hertz.K, force.approach)
    s, c = math.sin(force.alpha), math.cos(force.alpha)
    return loaded_contact(g, op, k, Q, force.a, force.b, s, c)


@jit
def cell_row(race, contact, R, j, worn, total, work):
    """Weights, heights and widths of a row of cells into `work`; whether it carries any load.

    Parameters
    ----------
    worn : bool
        Its pressure worn, or unworn.
    total : float
        Sum of the unworn pressure.
    """
    n = race.cells.X.size
    t, h, width, weight = work.row_t[:n], work.row_h[:n], work.row_width[:n], work.row_weight[:n]
    loaded = False
    surface_height(contact, R, race.cells.X, h)
    for i in range(n):
        p = race.pressure[j, i] if worn else race.cells.fresh[j, i]
        loaded = loaded or p != 0.0
        t[i] = race.cells.X[i]
        weight[i] = p / total
        width[i] = contact.b * race.cells.Y[j]
        if worn:
            h[i] += race.rise[i]
    return loaded


@jit
def worn_slope(race, contact, R, c, op, v_r, rule, work):
    """Gradient and second derivatives of the friction potential of a worn contact, into `work`."""
    t, weight = quadrature_points(rule, contact, R, c, v_r, work.t, work.weight)
    surface_height(contact, R, t, work.h)
    across, share = work.across, work.share
    if across.size > 1:
        place_across(rule, contact, R, c, across, share)
        half_width(contact, t, work.width)
    traction_slope(
        contact, c, op.mu, v_r, t, weight, work.h, work.width, across, share, work.gradient,
        work.hessian,
    )  # fmt: skip
    total = race.cells.fresh.sum()
    for worn in (True, False):
        for j in range(race.cells.Y.size):
            if cell_row(race, contact, R, j, worn, total, work):
                traction_slope(
                    contact, c, op.mu, v_r, race.cells.X, work.row_weight, work.row_h,
                    work.row_width, work.ones, work.halves, work.part_gradient, work.part_hessian,
                )  # fmt: skip
                sign = 1.0 if worn else -1.0
                for i in range(5):
                    work.gradient[i] += sign * work.part_gradient[i]
                    for k in range(5):
                        work.hessian[i, k] += sign * work.part_hessian[i, k]


@jit
def worn_friction_balance(g, op, D, races, seat, mass, v_r, rule, work, u, out):
    """Moments and orbital moment on a ball, and their derivatives by u into `work.jacobian`.

    As `steady_balance.friction_balance`, with worn contacts.
    """
    r, R = g.R_o + seat.X2, 0.5 * D
    out[:] = 0.0
    work.jacobian[:, :] = 0.0
    for k in range(2):
        race, force = (races[0], seat.inner) if k == 0 else (races[1], seat.outer)
        contact = unworn_contact(g, op, k, force)
        c = slip_coefficients(contact, u, r)
        worn_slope(race, contact, R, c, op, v_r, rule, work)
        slip_map(contact, r, work.L)
        subtract_projected(work.L, work.hessian, work.jacobian)
        subtract_gradient(work.L, work.gradient, out)
    inertia = ball_inertia(mass, D)
    F_v, dF_v = drag_force(g, D, op.drag, u[3])
    out[1] += inertia * u[3] * u[2]
    out[2] -= inertia * u[3] * u[1]
    out[3] -= r * F_v
    J = work.jacobian
    J[1, 2] += inertia * u[3]
    J[1, 3] += inertia * u[2]
    J[2, 1] -= inertia * u[3]
    J[2, 3] -= inertia * u[1]
    J[3, 3] -= r * dF_v


@jit
def friction_size(g, op, D, seat, out):
    """Largest unbalanced moment or orbital force, over the friction forces [1]."""
    capacity = friction_capacity(op.mu, seat.inner.Q, seat.outer.Q)
    moment = max(abs(out[0]), abs(out[1]), abs(out[2])) / (0.5 * D)
    return max(moment, abs(out[3]) / (g.R_o + seat.X2)) / capacity


@jit
def friction_newton(g, op, D, races, seat, mass, v_r, rule, work, u):
    """The ball's motion with the loads held, by damped Newton; u is improved in place.

    Returns
    -------
    status, size
    """
    worn_friction_balance(g, op, D, races, seat, mass, v_r, rule, work, u, work.residual)
    size = friction_size(g, op, D, seat, work.residual)
    for _ in range(NEWTON_STEPS):
        if size <= FRICTION_LEFT:
            return OK, size
        copy(work.jacobian, work.matrix)
        for i in range(4):
            work.step[i] = -work.residual[i]
        if not solve_in_place(work.matrix, work.step, 4):
            return NOT_CONVERGED, size
        damping, found, new = 1.0, False, size
        for _ in range(HALVINGS):
            for i in range(4):
                work.trial[i] = u[i] + damping * work.step[i]
            worn_friction_balance(
                g, op, D, races, seat, mass, v_r, rule, work, work.trial, work.residual
            )
            new = friction_size(g, op, D, seat, work.residual)
            if new < (1.0 - DESCENT * damping) * size or new <= FRICTION_LEFT:
                found = True
                break
            damping *= 0.5
            if size <= STALLED:
                break
        if not found:
            return (OK if size <= STALLED else NOT_CONVERGED), size
        copy(work.trial, u)
        size = new
    return (OK if size <= STALLED else NOT_CONVERGED), size


@jit
def settled_motion(g, op, D, races, seat, mass, rule, work, u):
    """`friction_newton` at the wanted v_r; where that fails from u, down from a larger one."""
    kept = u.copy()
    status, size = friction_newton(g, op, D, races, seat, mass, op.v_r, rule, work, u)
    if status == OK:
        return status, size
    copy(kept, u)
    for level in range(LEVELS, -1, -1):
        v_r = op.v_r * LEVEL_RATIO**level
        status, size = friction_newton(g, op, D, races, seat, mass, v_r, rule, work, u)
    return status, size


@jit
def pitch(u):
    """Pitch of the ball's axis from the bearing's [rad]."""
    return math.atan2(u[2], u[3] - u[0])


@jit
def across_friction(g, op, D, races, seat, rule, work, u, k):
    """Friction of race k on the ball along the first contact axis [N]."""
    r, R = g.R_o + seat.X2, 0.5 * D
    race, force = (races[0], seat.inner) if k == 0 else (races[1], seat.outer)
    contact = unworn_contact(g, op, k, force)
    c = slip_coefficients(contact, u, r)
    worn_slope(race, contact, R, c, op, op.v_r, rule, work)
    return work.gradient[4]


@jit
def next_pitch(beta, away, tried, off, low, high, known):
    """Pitch of the ball's axis to try next, by secants within a bracket.

    The axis moves the bands, and the bands the axis, further than it was moved: turns by turns
    they would part.

    Parameters
    ----------
    beta, away : float
        Pitch tried last, and how far that of the motion was from it [rad].
    tried, off : float
        The same of the try before, if `known`.
    low, high : float
        Bracket [rad].
    """
    turned = beta - tried
    slope = (away - off) / turned if known and turned != 0.0 else -1.0
    step = away / max(-slope, SHALLOW)
    new = beta + min(max(step, -LARGEST_TURN), LARGEST_TURN)
    return new if low < new < high else 0.5 * (low + high)


@jit
def worn_state(g, op, D, races, reference, preload, traction, rule, work, seat, u):
    """Steady state of a ball between two worn grooves.

    Normal balance with the ball's motion held and friction balance with the loads held, in turns:
    the one hardly follows the other.

    Parameters
    ----------
    races : tuple of 2 WornRace
    reference : ndarray (2,)
        Depths from which the approaches are counted [m].
    traction : bool
        Whether friction along the major axes takes part in the balance of normal forces.
    seat : WornSeat
        The start.
    u : ndarray (4,)
        The start of the motion; improved in place [rad/s].

    Returns
    -------
    status, seat, size, rounds
    """
    mass = g.rho * math.pi / 6.0 * D**3
    push = BallPush(mass=mass, Omega=u[3], F_i=seat.F_i, F_o=seat.F_o, beta=pitch(u))
    size = math.inf
    tried = off = 0.0  # pitch of the last round, and how far the motion's own was from it
    low, high = -math.inf, math.inf  # of the pitch
    for rounds in range(WORN_ROUNDS):
        seat = worn_seat(g, D, races, reference, preload, push, seat)
        if seat.status != OK:
            return seat.status, seat, size, rounds
        if max(seat.inner.a, seat.outer.a) >= LARGEST_AXIS * 0.5 * D:
            return OUTSIDE_HERTZ_RANGE, seat, size, rounds
        status, size = settled_motion(g, op, D, races, seat, mass, rule, work, u)
        if status != OK:
            return status, seat, size, rounds
        F_i = F_o = 0.0
        if traction:
            F_i = across_friction(g, op, D, races, seat, rule, work, u, 0)
            F_o = across_friction(g, op, D, races, seat, rule, work, u, 1)
        beta = pitch(u)
        r = g.R_o + seat.X2
        change = mass * r * abs(u[3] ** 2 - push.Omega**2)
        change = max(change, abs(F_i - push.F_i), abs(F_o - push.F_o))
        if races[0].band.c.shape[1] > 0:
            away = beta - push.beta
            if high - low > NARROW:
                change = max(change, abs(away) * max(seat.inner.Q, seat.outer.Q))
            if away > 0.0:
                low = max(low, push.beta)
            else:
                high = min(high, push.beta)
            beta = next_pitch(push.beta, away, tried, off, low, high, rounds > 0)
            tried, off = push.beta, away
        push = BallPush(mass=mass, Omega=u[3], F_i=F_i, F_o=F_o, beta=beta)
        if change <= ROUND_LEFT * max(seat.inner.Q, seat.outer.Q):
            return OK, seat, size, rounds + 1
    return NOT_CONVERGED, seat, size, WORN_ROUNDS


@jit
def worn_dissipation(g, op, D, races, seat, rule, work, u, out, rates):
    """What slip costs in both contacts, and how it spreads over them.

    Parameters
    ----------
    out : ndarray (2, 4)
        Filled, one row a race: QV [W], heat [W], gyroscopic share [1], torque of the race [N m].
    rates : ndarray (2, n)
        Filled: QV per length along the cells [W/m], scaled to the sum of `out`.
    """
    r, R = g.R_o + seat.X2, 0.5 * D
    for k in range(2):
        race, force = (races[0], seat.inner) if k == 0 else (races[1], seat.outer)
        contact = unworn_contact(g, op, k, force)
        c = slip_coefficients(contact, u, r)
        t, weight = quadrature_points(rule, contact, R, c, op.v_r, work.t, work.weight)
        surface_height(contact, R, t, work.h)
        across, share = work.across, work.share
        if across.size > 1:
            place_across(rule, contact, R, c, across, share)
            half_width(contact, t, work.width)
        qv, heat, gyro, torque = dissipation(
            contact, c, op.mu, op.v_r, r, t, weight, work.h, work.width, across, share
        )
        gyro *= qv
        X, total = race.cells.X, race.cells.fresh.sum()
        n = X.size
        rates[k, :] = 0.0
        for worn in (True, False):
            for j in range(race.cells.Y.size):
                if cell_row(race, contact, R, j, worn, total, work):
                    part = dissipation(
                        contact, c, op.mu, op.v_r, r, X, work.row_weight, work.row_h,
                        work.row_width, work.ones, work.halves,
                    )  # fmt: skip
                    sign = 1.0 if worn else -1.0
                    qv += sign * part[0]
                    heat += sign * part[1]
                    gyro += sign * part[2] * part[0]
                    torque += sign * part[3]
                    if worn:
                        for i in range(n):
                            v2 = c[1] + c[2] * work.row_h[i] + c[3] * race.x[i]
                            v1, spin = c[0] * work.row_h[i], c[3] * work.row_width[i]
                            slip = math.hypot(v1 - spin, v2) + math.hypot(v1 + spin, v2)
                            rates[k, i] += 0.5 * work.row_weight[i] * slip
        out[k, 0], out[k, 1] = qv, heat
        out[k, 2] = gyro / qv if qv > 0.0 else 0.0
        out[k, 3] = torque
        found = 0.0
        step = race.x[1] - race.x[0]
        for i in range(n):
            found += rates[k, i]
        if found > 0.0:
            for i in range(n):
                rates[k, i] *= qv / (found * step)
