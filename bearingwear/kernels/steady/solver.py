"""Solver of the friction-balanced steady state under thrust (theory.md section 4).

Coulomb friction is saturated almost everywhere, so a Newton start from afar sees a flat residual.
The solver therefore follows the state from a nearly viscous friction law (large v_r), where the
problem is nearly linear, to the wanted v_r. Each level is solved by Newton or, where that fails, by
pseudo-transient continuation.
"""

import math

import numpy as np

from bearingwear.kernels.decorators import jit
from bearingwear.kernels.equilibrium.thrust_loaded import cold_start
from bearingwear.kernels.linear import copy
from bearingwear.kernels.status import (
    CONTACT_LOST,
    NOT_CONVERGED,
    OK,
    OUTSIDE_HERTZ_RANGE,
    PRELOAD_GONE,
)
from bearingwear.kernels.steady.balance import (
    Seat,
    motion_equilibrium,
    orbit_equilibrium,
    usable,
)
from bearingwear.kernels.steady.level_solver import (
    NEAR_ROUNDING,
    TRANSIENT_STEPS,
    UNKNOWN,
    Solution,
    newton,
    pseudo_transient,
)

# Levels of v_r on the way down
MOST_LEVELS = 90
LEVEL_TOLERANCE = 1e-6  # residual of a level, which only starts the next one, over friction
FIRST_RATIO = 0.15  # of a level to the one before; its square root after each failure, up to
LARGEST_RATIO = 0.8  # where levels lie so close that Newton's failure is not theirs
RISE = 30.0  # where the first level fails, the next lies so many times higher
LAST_RATIO = 1.5  # a level within this of the wanted v_r is left out

# A ball off the inner race is no longer driven: it slows down until it is back on.
SLOWING = 0.9
MOST_SLOWINGS = 60
SKIDDING_START = 0.1  # share of the first speeds, for a ball that skids


@jit
def cold_seat(bearing, u):
    """Ball and race at the motion u (4,), or (6,) with its tractions, found from nothing."""
    return motion_equilibrium(bearing, u, Seat(delta_a=bearing.preload.delta_a, state=cold_start()))


@jit
def seated_start(bearing, u):
    """First equilibrium for the motion u, which is slowed until the ball stays on the inner race.

    Returns
    -------
    lost, seat
        Status at the motion as given; the equilibrium at the slowed one.
    """
    seat = cold_seat(bearing, u)
    lost = seat.state.status
    for _ in range(MOST_SLOWINGS):
        if seat.state.status != CONTACT_LOST:
            break
        u *= SLOWING
        seat = cold_seat(bearing, u)
    return lost, seat


@jit
def predict(bearing, kept, before, ahead, seat, u):
    """Extrapolate u from the last two levels; where that has no equilibrium, stay at the last one.

    Where a contact sticks its slip goes as v_r, and the state with it.

    Parameters
    ----------
    kept, before : ndarray (k,)
        Motion at the last level and at the one before, with its tractions if it has them.
    ahead : float
        Distance to the new level, over that between the last two.
    seat : Seat
        Equilibrium of the last level.
    """
    for i in range(u.size):
        u[i] = kept[i] + ahead * (kept[i] - before[i])
    moved = motion_equilibrium(bearing, u, seat)
    if usable(moved.state) == OK:
        return moved
    copy(kept, u)
    return seat


@jit
def settle_from_start(p, first, tried, u):
    """Follow the ball's own motion at the wanted v_r, since the way down from viscous is blocked.

    From the first start, and from nearly at rest, as a ball that skids.

    Parameters
    ----------
    first : ndarray (4,)
        The first start.
    tried : Solution
        What was found on the way down; returned, with more iterations, where neither start serves.
    """
    status, seat, size, total = tried.status, tried.seat, tried.size, tried.iterations
    for share in (1.0, SKIDDING_START):
        if status != OK:
            for i in range(u.size):
                u[i] = share * first[i]
            seat = cold_seat(p.bearing, u)
            if usable(seat.state) == OK:
                s = pseudo_transient(p, p.bearing.op.v_r, seat, u, NEAR_ROUNDING, TRANSIENT_STEPS)
                status, seat, size = s.status, s.seat, s.size
                total += s.iterations
    return Solution(status=status, seat=seat, iterations=total, size=size)


@jit
def polish(p, v_r, s, u, tolerance):
    """Newton from a settled state to rounding, if it converges; u is improved in place."""
    trial = u.copy()
    better = newton(p, v_r, s.seat, trial, tolerance)
    total = s.iterations + better.iterations
    if better.status == OK and better.size <= s.size:
        copy(trial, u)
        return Solution(status=OK, seat=better.seat, iterations=total, size=better.size)
    return Solution(status=OK, seat=s.seat, iterations=total, size=s.size)


@jit
def without_newton(p, v, seat, first, u, tolerance):
    """A level that Newton cannot solve, or the wanted one if necessary, by pseudo-transients.

    Parameters
    ----------
    v : float
        The level [m/s].
    seat : Seat
        Equilibrium of u, the motion at the last level; u is improved in place.
    first : ndarray (4,)
        The first start.
    tolerance : float
        As in `steady_state`.

    Returns
    -------
    v, Solution
        The level solved.
    """
    target = p.bearing.op.v_r
    goal = max(tolerance if v <= target else LEVEL_TOLERANCE, NEAR_ROUNDING)
    s = pseudo_transient(p, v, seat, u, goal, TRANSIENT_STEPS)
    if s.status != OK:
        v = target
        s = settle_from_start(p, first, s, u)
    if s.status == OK and v <= target:
        # Its steps end where the balance is good; Newton's go on to rounding.
        s = polish(p, v, s, u, tolerance)
    return v, s


@jit
def newton_refusal(bearing, status):
    """Why no state was found: the status, or that the preload is gone."""
    at_rest = orbit_equilibrium(
        bearing, 0.0, Seat(delta_a=bearing.preload.delta_a, state=cold_start())
    )
    # Centrifugal force alone held the ball, and nothing drove it on.
    return PRELOAD_GONE if at_rest.state.status == PRELOAD_GONE else status


@jit
def retry_level(v, reached, ratio, target, top):
    """Level to try after Newton failed at v, and the ratio of levels from then on.

    Higher, where none was reached; else closer to the last one.
    """
    if math.isinf(reached):
        return min(RISE * v, top), ratio
    ratio = math.sqrt(ratio)
    return max(reached * ratio, target), ratio


@jit
def unknowns(p, motion):
    """The unknowns of a balance at a motion (4,), its tractions zero, or (6,) with them."""
    u = np.zeros(p.step.size)
    for i in range(min(u.size, motion.size)):
        u[i] = motion[i]
    return u


@jit
def steady_state(p, u, v_start, tolerance):
    """Steady state at the wanted v_r, followed down from the regularisation `v_start`.

    Parameters
    ----------
    u : ndarray (k,)
        Start, see `unknowns`; the answer replaces it.
    v_start : float
        Regularisation of the first solve [m/s]. With the wanted one, u must be near; where that
        fails the solver goes up by itself and comes down again.
    tolerance : float
        On the residual, as a share of the friction forces [1].
    """
    lost, seat = seated_start(p.bearing, u)
    size, total = UNKNOWN, 0
    if usable(seat.state) != OK:
        return Solution(status=usable(seat.state), seat=seat, iterations=total, size=size)
    first, kept, before = u.copy(), u.copy(), u.copy()
    op = p.bearing.op
    target = op.v_r
    # Slip can hardly exceed the surface speed: friction is viscous at the top.
    top = max(target, 0.5 * p.bearing.g.dm * abs(op.omega_i - op.omega_o))
    v, ratio = min(max(v_start, target), top), FIRST_RATIO
    reached = reached_before = math.inf  # the last two levels, where the motion was kept and before
    for _ in range(MOST_LEVELS):
        here = seat
        if not math.isinf(reached_before):
            ahead = (v - reached) / (reached - reached_before)
            here = predict(p.bearing, kept, before, ahead, seat, u)
        s = newton(p, v, here, u, tolerance if v <= target else LEVEL_TOLERANCE)
        size, total = s.size, total + s.iterations
        if s.status == OUTSIDE_HERTZ_RANGE:
            return Solution(status=s.status, seat=s.seat, iterations=total, size=size)
        if s.status != OK:
            copy(kept, u)
            if v < top and (math.isinf(reached) or ratio < LARGEST_RATIO):
                v, ratio = retry_level(v, reached, ratio, target, top)
                continue
            v, s = without_newton(p, v, seat, first, u, tolerance)
            size, total = s.size, total + s.iterations
            if s.status != OK:
                status = newton_refusal(p.bearing, s.status) if lost == OK else lost
                return Solution(status=status, seat=s.seat, iterations=total, size=size)
        seat = s.seat
        if v <= target:
            return Solution(status=OK, seat=seat, iterations=total, size=size)
        if v < reached:
            reached_before = reached
            copy(kept, before)
        reached = v
        copy(u, kept)
        v = max(target, v * ratio)
        if v < LAST_RATIO * target:
            v = target
    return Solution(status=NOT_CONVERGED, seat=seat, iterations=total, size=size)
