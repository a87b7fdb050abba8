"""Steady state of a ball between two worn grooves (theory.md section 21).

The unknowns are the places of ball and race. Each trial solves both contacts there and the ball's
motion under their loads. The residuals are the forces on ball and race. Their derivatives are kept
from trial to trial and from state to state, and improved by each step.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.ball import ball_mass
from bearingwear.kernels.contact.hertz import INNER, OUTER
from bearingwear.kernels.contact.slip import LARGEST_AXIS
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.equilibrium.thrust_loaded import groove_distance
from bearingwear.kernels.linear import copy, solve_in_place
from bearingwear.kernels.status import NOT_CONVERGED, OK, OUTSIDE_HERTZ_RANGE
from bearingwear.kernels.steady.level_solver import SHORTENING
from bearingwear.kernels.worn.balance import WornForce, race_parts, worn_force
from bearingwear.kernels.worn.friction import place_cells, settled_motion, worn_dissipation

UNKNOWNS = 3  # X1, X2, delta_a, in this order; of a race that is held the last one is none
MOST_SEATS = 60
MOST_POOR = 20  # of them that leave much, though the derivatives are new: the state lies far off
PROGRESS = 0.1  # share of what was left before them, below which they may go on
PLACES_TRIED = 5  # along a step with new derivatives
SLOW_BALANCE = 0.3  # share of what was left, above which a step calls for derivatives found anew
WORN_BALANCE = 1e-8  # force left, as a share of the load, of states that are kept [1]
QUOTIENT_PLACE = 3e-6  # of the approach: derivatives are found with; near a fold they turn fast
QUOTIENT_ACROSS = 1e-4  # likewise across the contacts, where forces change by far less
LONGEST_MOVE = 0.5  # of the approach, in one step


class WornSeat(NamedTuple):
    """Places of ball and race, and the forces there."""

    status: int
    X1: float  # ball centre from the outer groove centre [m]
    X2: float
    delta_a: float  # axial displacement of the race [m]
    inner: WornForce
    outer: WornForce
    F_i: float  # friction of the races along their first axes that the balance counts [N]
    F_o: float


class StateWork(NamedTuple):
    """Buffers of a state; its derivatives serve the next one too."""

    slope: np.ndarray  # (3, 3) of what is left by the unknowns [1/m]; [0, 0] zero: not known
    left: np.ndarray  # (3,) forces over the load
    shifted: np.ndarray  # (3,)
    step: np.ndarray  # (3,) [m]
    matrix: np.ndarray  # (3, 3)
    active: np.ndarray  # (3,) which of the unknowns there are
    u: np.ndarray  # (4,) motion at the place tried [rad/s]
    balance: float  # largest force left, as a share of the load [1]


def state_work():
    """StateWork with unknown derivatives."""
    return StateWork(
        slope=np.zeros((UNKNOWNS, UNKNOWNS)),
        left=np.zeros(UNKNOWNS),
        shifted=np.zeros(UNKNOWNS),
        step=np.zeros(UNKNOWNS),
        matrix=np.zeros((UNKNOWNS, UNKNOWNS)),
        active=np.ones(UNKNOWNS, dtype=np.bool_),
        u=np.zeros(4),
        balance=WORN_BALANCE,
    )


@jit
def moved_seat(seat, step, share):
    """A seat whose places are moved by a share of a step; its forces stay."""
    return WornSeat(
        status=seat.status,
        X1=seat.X1 + share * step[0],
        X2=seat.X2 + share * step[1],
        delta_a=seat.delta_a + share * step[2],
        inner=seat.inner,
        outer=seat.outer,
        F_i=seat.F_i,
        F_o=seat.F_o,
    )


@jit
def seat_with(at, status, inner, outer, F_i, F_o):
    """The seat at the places of another, with forces of its own."""
    return WornSeat(
        status=status,
        X1=at.X1,
        X2=at.X2,
        delta_a=at.delta_a,
        inner=inner,
        outer=outer,
        F_i=F_i,
        F_o=F_o,
    )


@jit
def worn_seat(bearing, races, reference, rule, work, state, at, u, left):
    """Contacts and motion at the places of a seat, and the residuals of the balances.

    Parameters
    ----------
    bearing : ThrustBearing
    races : tuple of 2 WornRace
        Inner, outer.
    reference : ndarray (2,)
        Depths from which the approaches are counted [m].
    work : FrictionWork
    state : StateWork
        Of which the unknowns are taken that there are.
    at : WornSeat
        Of which the places are taken.
    u : ndarray (4,)
        Start of the motion; improved in place [rad/s].
    left : ndarray (3,)
        Filled: axial and radial force on the ball and axial force on the race, over the load. Zero
        for what is no unknown.

    Returns
    -------
    WornSeat
    """
    g, D, op, preload = bearing.g, bearing.D, bearing.op, bearing.preload
    A1, A2 = groove_distance(g, 0.0, at.delta_a, 0.0, 0.0, 0.0)
    inner = worn_force(g, D, races[0], INNER, reference[0], A1 - at.X1, A2 - at.X2)
    outer = worn_force(g, D, races[1], OUTER, reference[1], at.X1, at.X2)
    status = inner.status if inner.status != OK else outer.status
    if status == OK and max(inner.a, outer.a) >= LARGEST_AXIS * 0.5 * D:
        status = OUTSIDE_HERTZ_RANGE
    seat = seat_with(at, status, inner, outer, 0.0, 0.0)
    if status != OK:
        return seat
    place_cells(g, D, op, races, seat, work)
    status, F_i, F_o = settled_motion(g, op, D, seat, rule, work, u)
    if not bearing.traction:
        F_i = F_o = 0.0
    i_x, i_r = race_parts(INNER, inner, F_i)
    o_x, o_r = race_parts(OUTER, outer, F_o)
    load = max(inner.Q, outer.Q)
    # `unbalanced_force` once more: the contacts are no springs, their pressure has a pitch
    left[0] = (i_x + o_x) / load
    left[1] = (i_r + o_r + ball_mass(g.rho, D) * (g.R_o + at.X2) * u[3] * u[3]) / load
    left[2] = (i_x - preload.F_x / g.n_balls) / load if state.active[2] else 0.0
    return seat_with(at, status, inner, outer, F_i, F_o)


@jit
def largest(values):
    """Largest magnitude."""
    found = 0.0
    for i in range(values.size):
        found = max(found, abs(values[i]))
    return found


@jit
def find_slope(bearing, races, reference, rule, work, state, seat, u):
    """Derivatives of what is left by the unknowns, into `state.slope`, by differences.

    Returns
    -------
    bool
        False where a place nearby has no state.
    """
    size = max(seat.inner.approach, seat.outer.approach)
    s, c = math.sin(seat.outer.alpha), math.cos(seat.outer.alpha)
    for j in range(UNKNOWNS):
        for i in range(UNKNOWNS):
            state.slope[i, j] = 1.0 if i == j else 0.0
            state.step[i] = 0.0
        if state.active[j]:
            h = size * (QUOTIENT_ACROSS if j == 1 else QUOTIENT_PLACE)
            if j < 2:  # the ball moves along the contact line, and across it
                state.step[0], state.step[1] = (h * s, h * c) if j == 0 else (h * c, -h * s)
            else:
                state.step[j] = h
            copy(u, state.u)
            near = moved_seat(seat, state.step, 1.0)
            near = worn_seat(
                bearing, races, reference, rule, work, state, near, state.u, state.shifted
            )
            if near.status != OK:
                state.slope[0, 0] = 0.0
                return False
            for i in range(UNKNOWNS):
                if state.active[i]:
                    state.slope[i, j] = (state.shifted[i] - state.left[i]) / h
    for i in range(UNKNOWNS):
        along, across = state.slope[i, 0], state.slope[i, 1]
        state.slope[i, 0], state.slope[i, 1] = s * along + c * across, c * along - s * across
    return True


@jit
def contact_share(distance, approach, alpha, d1, d2):
    """Share of a move by which a contact may follow: along its line, and, longer, around it.

    Parameters
    ----------
    distance : float
        Of the centres of groove and ball, which a move across turns [m].
    d1, d2 : float
        Axial and radial part of the move [m].
    """
    s, c = math.sin(alpha), math.cos(alpha)
    along, across = abs(d1 * s + d2 * c), abs(d1 * c - d2 * s)
    share, longest = 1.0, LONGEST_MOVE * approach
    if along > longest:
        share = longest / along
    longest = math.sqrt(2.0 * distance * longest)  # which lengthens the line by as much
    return min(share, longest / across if across > longest else 1.0)


@jit
def newton_step(g, R, state, seat):
    """Fill `state.step`; what it is to be shortened by, or zero where the slope is singular."""
    copy(state.slope, state.matrix)
    for i in range(UNKNOWNS):
        state.step[i] = -state.left[i]
    if not solve_in_place(state.matrix, state.step, UNKNOWNS):
        return 0.0
    d1, d2, dd = state.step[0], state.step[1], state.step[2]
    size = max(seat.inner.approach, seat.outer.approach)
    return min(
        contact_share(g.r_i - R, size, seat.inner.alpha, dd - d1, -d2),
        contact_share(g.r_o - R, size, seat.outer.alpha, d1, d2),
    )


@jit
def improve_slope(state, share):
    """Broyden's update by the step that was taken."""
    size = 0.0
    for j in range(UNKNOWNS):
        state.step[j] *= share
        size += state.step[j] * state.step[j]
    for i in range(UNKNOWNS):
        unexplained = state.shifted[i] - state.left[i]
        for j in range(UNKNOWNS):
            unexplained -= state.slope[i, j] * state.step[j]
        for j in range(UNKNOWNS):
            state.slope[i, j] += unexplained * state.step[j] / size


@jit
def shortened_step(bearing, races, reference, rule, work, state, seat, u, share, halvings):
    """Shorten a step until it lessens what is left.

    Returns
    -------
    seat, share
        At the end of the step, motion and balance of which are in `state`; zero where none was
        found.
    """
    size = largest(state.left)
    for _ in range(halvings):
        copy(u, state.u)
        tried = moved_seat(seat, state.step, share)
        tried = worn_seat(
            bearing, races, reference, rule, work, state, tried, state.u, state.shifted
        )
        if tried.status == OK and largest(state.shifted) < size:
            return tried, share
        share *= SHORTENING
    return seat, 0.0


@jit
def balanced_seat(bearing, races, reference, rule, work, state, seat, u):
    """`worn_seat` with nothing left, by Broyden's method; u is improved in place."""
    seat = worn_seat(bearing, races, reference, rule, work, state, seat, u, state.left)
    poor, first = 0, largest(state.left)  # where poor steps are counted from
    for _ in range(MOST_SEATS):
        size = largest(state.left)
        if seat.status != OK or size <= state.balance:
            return seat
        fresh = state.slope[0, 0] == 0.0
        if fresh and not find_slope(bearing, races, reference, rule, work, state, seat, u):
            break
        share = newton_step(bearing.g, 0.5 * bearing.D, state, seat)
        tries = PLACES_TRIED if fresh else 1
        seat, share = shortened_step(
            bearing, races, reference, rule, work, state, seat, u, share, tries
        )
        if share == 0.0:
            if fresh:
                break
            state.slope[0, 0] = 0.0
            continue
        improve_slope(state, share)
        copy(state.shifted, state.left)
        copy(state.u, u)
        if largest(state.left) > SLOW_BALANCE * size:
            if fresh:  # what the step showed may serve better than differences over less
                poor += 1
            else:
                state.slope[0, 0] = 0.0
            if poor > MOST_POOR:
                if largest(state.left) > PROGRESS * first:
                    break
                poor, first = 0, largest(state.left)
    state.slope[0, 0] = 0.0
    return seat_with(seat, NOT_CONVERGED, seat.inner, seat.outer, seat.F_i, seat.F_o)


@jit
def add_ball_forces(g, D, seat, u, F_i, F_o, share, out):
    """Add a share of the forces (3,) on a ball: axial and radial, and axial of the inner race.

    Parameters
    ----------
    u : ndarray (4,)
        Motion, of whose orbit rate the centrifugal force is.
    F_i, F_o : float
        Friction along the first axes [N].
    """
    i_x, i_r = race_parts(INNER, seat.inner, F_i)
    o_x, o_r = race_parts(OUTER, seat.outer, F_o)
    out[0] += share * (i_x + o_x)
    out[1] += share * (i_r + o_r + ball_mass(g.rho, D) * (g.R_o + seat.X2) * u[3] * u[3])
    out[2] += share * i_x


@jit
def find_force_changes(bearing, races, reference, rule, work, state, seat, u, moves, changes):
    """Changes of the forces of a state as its places move; returns a status.

    Parameters
    ----------
    moves : ndarray (n, 3)
        Of X1, X2 and delta_a.
    changes : ndarray (n, 2, 3)
        Filled: with the motion held and without friction, and with both following. Columns: those
        of `add_ball_forces`.
    """
    g, D = bearing.g, bearing.D
    changes[:, :, :] = 0.0
    for j in range(moves.shape[0]):
        copy(u, state.u)
        near = moved_seat(seat, moves[j], 1.0)
        near = worn_seat(bearing, races, reference, rule, work, state, near, state.u, state.shifted)
        if near.status != OK:
            return near.status
        add_ball_forces(g, D, near, u, 0.0, 0.0, 1.0, changes[j, 0])
        add_ball_forces(g, D, seat, u, 0.0, 0.0, -1.0, changes[j, 0])
        add_ball_forces(g, D, near, state.u, near.F_i, near.F_o, 1.0, changes[j, 1])
        add_ball_forces(g, D, seat, u, seat.F_i, seat.F_o, -1.0, changes[j, 1])
    return OK


@jit
def worn_state(bearing, races, reference, rule, work, state, seat, u, moves, changes):
    """Steady state of a ball between two worn grooves, and its `worn_dissipation`.

    Parameters
    ----------
    bearing, races, reference, rule, work, state
        As in `worn_seat`.
    seat : WornSeat
        Of which the places are the start.
    u : ndarray (4,)
        The start of the motion; improved in place [rad/s].
    moves, changes : ndarray (n, 3), (n, 2, 3)
        As in `find_force_changes`, of a state that is solved; none: it is solved.

    Returns
    -------
    WornSeat
    """
    if moves.shape[0] > 0:
        status = find_force_changes(
            bearing, races, reference, rule, work, state, seat, u, moves, changes
        )
        return seat_with(seat, status, seat.inner, seat.outer, seat.F_i, seat.F_o)
    state.active[2] = bearing.preload.constant_force
    found = balanced_seat(bearing, races, reference, rule, work, state, seat, u)
    if found.status == OK:
        worn_dissipation(bearing.g, bearing.op, bearing.D, races, found, rule, work, u)
    return found
