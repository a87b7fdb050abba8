"""Friction and wear of a ball between two worn grooves (theory.md section 21).

The friction of a worn contact is that of the Hertz contact it would be unworn, by the rule of the
ellipse, and what its cells add to it: those worn less those unworn. Without wear nothing is added.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.ball import ball_mass
from bearingwear.kernels.compile import jit
from bearingwear.kernels.contact import (
    LARGEST_AXIS,
    dissipation,
    hertz_contact,
    point_slip,
    slip_coefficients,
    slip_map,
    surface_height,
    traction_slope,
)
from bearingwear.kernels.ellipse import contact_points, most_points
from bearingwear.kernels.level_solver import DESCENT, HALVINGS, NEWTON_STEPS, STALLED
from bearingwear.kernels.linear import copy, solve_in_place
from bearingwear.kernels.profile import contact_load
from bearingwear.kernels.status import NOT_CONVERGED, OK, OUTSIDE_HERTZ_RANGE
from bearingwear.kernels.steady_balance import (
    add_gyration_and_drag,
    balance_share,
    subtract_gradient,
    subtract_projected,
)
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
    cell_h: np.ndarray  # (2, most cells along) heights of the cells, unworn and worn
    row_width: np.ndarray  # (most cells along,)
    row_weight: np.ndarray


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
        cell_h=np.empty((2, n)), row_width=np.empty(n), row_weight=np.empty(n),
    )  # fmt: skip


@jit
def unworn_contact(g, op, k, force):
    """The Hertz contact that a worn one is counted from."""
    Q = contact_load(force.hertz.K, force.approach)
    return hertz_contact(g, op, k, Q, force.alpha, force.hertz)


@jit
def cell_heights(race, contact, R, work):
    """Heights of the cells along the major axis, unworn and worn, into `work.cell_h`."""
    unworn, worn = work.cell_h
    surface_height(contact, R, race.cells.X, unworn)
    for i in range(race.rise.size):
        worn[i] = unworn[i] + race.rise[i]


@jit
def cell_row(race, contact, j, worn, total, work):
    """Weights and widths of a row of cells into `work`; whether it carries any load.

    Parameters
    ----------
    worn : bool
        Its pressure worn, or unworn.
    total : float
        Sum of the unworn pressure.
    """
    loaded = False
    for i in range(race.cells.X.size):
        p = race.pressure[j, i] if worn else race.cells.fresh[j, i]
        loaded = loaded or p != 0.0
        work.row_weight[i] = p / total
        work.row_width[i] = contact.b * race.cells.Y[j]
    return loaded


@jit
def worn_slope(race, contact, R, c, op, v_r, rule, work):
    """Gradient and second derivatives of the friction potential of a worn contact, into `work`."""
    across, share = work.across, work.share
    t, weight = contact_points(
        rule, contact, R, c, v_r, work.t, work.weight, work.h, work.width, across, share
    )
    traction_slope(
        contact, c, op.mu, v_r, t, weight, work.h, work.width, across, share, work.gradient,
        work.hessian,
    )  # fmt: skip
    cell_heights(race, contact, R, work)
    total = race.cells.fresh.sum()
    for worn in (True, False):
        for j in range(race.cells.Y.size):
            if cell_row(race, contact, j, worn, total, work):
                traction_slope(
                    contact, c, op.mu, v_r, race.cells.X, work.row_weight,
                    work.cell_h[1 if worn else 0], work.row_width, work.ones,
                    work.halves, work.part_gradient, work.part_hessian,
                )  # fmt: skip
                sign = 1.0 if worn else -1.0
                for i in range(5):
                    work.gradient[i] += sign * work.part_gradient[i]
                    for k in range(5):
                        work.hessian[i, k] += sign * work.part_hessian[i, k]


@jit
def worn_friction_balance(g, op, D, races, seat, v_r, rule, work, u, out):
    """Moments and orbital moment on a ball, and their derivatives by u into `work.jacobian`.

    As `steady_balance.friction_balance`, with worn contacts.

    Returns
    -------
    F_i, F_o : float
        Friction of the races on the ball along the first contact axes [N].
    """
    F_i = 0.0
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
        if k == 0:
            F_i = work.gradient[4]
    add_gyration_and_drag(g, D, op, u, r, out, work.jacobian, True)
    return F_i, work.gradient[4]


@jit
def friction_newton(g, op, D, races, seat, v_r, rule, work, u):
    """The ball's motion with the loads held, by damped Newton; u is improved in place.

    Returns
    -------
    status, F_i, F_o
        Friction as in `worn_friction_balance`.
    """
    r, Q_i, Q_o = g.R_o + seat.X2, seat.inner.Q, seat.outer.Q
    out = work.residual
    F_i, F_o = worn_friction_balance(g, op, D, races, seat, v_r, rule, work, u, out)
    size = balance_share(op, D, r, Q_i, Q_o, out)
    for _ in range(NEWTON_STEPS):
        if size <= FRICTION_LEFT:
            return OK, F_i, F_o
        copy(work.jacobian, work.matrix)
        for i in range(4):
            work.step[i] = -work.residual[i]
        if not solve_in_place(work.matrix, work.step, 4):
            return NOT_CONVERGED, F_i, F_o
        damping, found, new = 1.0, False, size
        T_i, T_o = F_i, F_o
        for _ in range(HALVINGS):
            for i in range(4):
                work.trial[i] = u[i] + damping * work.step[i]
            T_i, T_o = worn_friction_balance(
                g, op, D, races, seat, v_r, rule, work, work.trial, out
            )
            new = balance_share(op, D, r, Q_i, Q_o, out)
            if new < (1.0 - DESCENT * damping) * size or new <= FRICTION_LEFT:
                found = True
                break
            damping *= 0.5
            if size <= STALLED:
                break
        if not found:
            break
        copy(work.trial, u)
        size, F_i, F_o = new, T_i, T_o
    return (OK if size <= STALLED else NOT_CONVERGED), F_i, F_o


@jit
def settled_motion(g, op, D, races, seat, rule, work, u):
    """`friction_newton` at the wanted v_r; where that fails from u, down from a larger one."""
    kept = u.copy()
    found = friction_newton(g, op, D, races, seat, op.v_r, rule, work, u)
    if found[0] == OK:
        return found
    copy(kept, u)
    for level in range(LEVELS, -1, -1):
        v_r = op.v_r * LEVEL_RATIO**level
        found = friction_newton(g, op, D, races, seat, v_r, rule, work, u)
    return found


@jit
def pitch(u):
    """Pitch of the ball's axis from the bearing's [rad]."""
    return math.atan2(u[2], u[3] - u[0])


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
    status, seat
    """
    mass = ball_mass(g.rho, D)
    push = BallPush(Omega=u[3], F_i=seat.F_i, F_o=seat.F_o, beta=pitch(u))
    tried = off = 0.0  # pitch of the last round, and how far the motion's own was from it
    low, high = -math.inf, math.inf  # of the pitch
    for rounds in range(WORN_ROUNDS):
        seat = worn_seat(g, D, races, reference, preload, push, seat)
        if seat.status != OK:
            return seat.status, seat
        if max(seat.inner.a, seat.outer.a) >= LARGEST_AXIS * 0.5 * D:
            return OUTSIDE_HERTZ_RANGE, seat
        status, F_i, F_o = settled_motion(g, op, D, races, seat, rule, work, u)
        if status != OK:
            return status, seat
        if not traction:
            F_i = F_o = 0.0
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
        push = BallPush(Omega=u[3], F_i=F_i, F_o=F_o, beta=beta)
        if change <= ROUND_LEFT * max(seat.inner.Q, seat.outer.Q):
            return OK, seat
    return NOT_CONVERGED, seat


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
        across, share = work.across, work.share
        t, weight = contact_points(
            rule, contact, R, c, op.v_r, work.t, work.weight, work.h, work.width, across, share
        )
        qv, heat, gyro, torque = dissipation(
            contact, c, op.mu, op.v_r, r, t, weight, work.h, work.width, across, share
        )
        gyro *= qv
        cell_heights(race, contact, R, work)
        X, total = race.cells.X, race.cells.fresh.sum()
        n = X.size
        rates[k, :] = 0.0
        for worn in (True, False):
            for j in range(race.cells.Y.size):
                if cell_row(race, contact, j, worn, total, work):
                    h = work.cell_h[1 if worn else 0]
                    part = dissipation(
                        contact, c, op.mu, op.v_r, r, X, work.row_weight, h, work.row_width,
                        work.ones, work.halves,
                    )  # fmt: skip
                    sign = 1.0 if worn else -1.0
                    qv += sign * part[0]
                    heat += sign * part[1]
                    gyro += sign * part[2] * part[0]
                    torque += sign * part[3]
                    if worn:
                        for i in range(n):
                            v1, v2 = point_slip(c, h[i], race.x[i])
                            spin = c[3] * work.row_width[i]
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
