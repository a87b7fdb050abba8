"""The other steady states of a ball under thrust, sought over its orbit rate (theory.md section 4).

At a held orbit rate loads and geometry are held too. Friction is then minus the gradient of a
convex potential of the ball's angular velocity, to which the gyroscopic moment adds a skew part:
exactly one angular velocity balances the three moments. So every steady state is a root of one
function of one number, the force that is left along the orbit,

    F(Omega) = (traction + drag along the orbit) / (friction capacity of the lighter contact),

and it can be stable only where F falls through zero. The search follows F from a known state to
both ends of the range of orbit rates, and lets the ball settle wherever F indicates another state.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.ball import ball_inertia, ball_mass
from bearingwear.kernels.contact.friction import friction_coefficients
from bearingwear.kernels.decorators import inlined, jit
from bearingwear.kernels.equilibrium.thrust_loaded import cold_start
from bearingwear.kernels.linear import copy, solve_in_place
from bearingwear.kernels.status import NO_STEADY_STATE, NOT_CONVERGED, OK
from bearingwear.kernels.steady.balance import (
    Seat,
    balance_problem,
    friction_balance,
    orbit_equilibrium,
    usable,
)
from bearingwear.kernels.steady.level_solver import pseudo_transient

# Balance of moments at a held orbit rate, by pseudo-transients that begin with Newton's step
BALANCED_MOMENTS = 1e-2  # moments left, as a share of the friction forces
MOMENT_STEPS = 100
DAMPINGS, DAMPING = 30, 4.0  # of a step, at the most, each so many times stronger; the first one is
FIRST_DAMPING = 1e-4  # inertia by the faster race's speed, times this
MOST_LEFT, LITTLE_LEFT = 0.5, 0.1  # shares of the moments that a step may leave; with less
EASING, FAST_EASING = 0.5, 0.1  # the next one is damped by so much less

# Steps of the orbit rate, as shares of the range from the slowest part to the fastest
BEYOND = 0.02  # by which the range is passed
SHORTEST_RATE_STEP, FIRST_RATE_STEP, LONGEST_RATE_STEP = 0.002, 0.01, 0.3
STEEPEST_RISE = 3.0  # rise of F over the whole range that steps are made for
NEUTRAL = 0.03  # |F| below which the coarser points and larger v_r may have hidden a root
MOST_RATES = 100
RETREAT = 0.25  # of a step that led to no balance
FEW, SEVERAL = 3, 6  # steps of a balance of moments after which the next step of the rate may be
LONGER, NEARLY_SAME, SHORTER = 3.0, 1.5, 0.7  # so many times as long; the last with more steps

# Settling
SETTLED = 1e-9  # residual, over friction
SETTLING_STEPS = 1500


class RatePoint(NamedTuple):
    """The balance at an orbit rate."""

    status: int
    seat: Seat
    F: float  # force left along the orbit [1]
    slope: float  # dF/dOmega with the loads held [s]
    steps: int


@inlined
def largest_moment(moments):
    """Largest of the three moments."""
    return max(abs(moments[0]), abs(moments[1]), abs(moments[2]))


@inlined
def angular_response(p, damping, moments, response):
    """Change of the ball's angular velocity (3,) that takes away moments (3,)."""
    for i in range(3):
        response[i] = moments[i]
        for j in range(3):
            p.matrix[i, j] = -p.jacobian[i, j]
        p.matrix[i, i] += damping
    return solve_in_place(p.matrix, response, 3)


@jit
def balance_moments(p, v_r, state, u, allowed):
    """Balance the three moments at the orbit rate u[3]; u[:3] is improved in place.

    Parameters
    ----------
    p : BalanceProblem
        Its `residual` and `jacobian` are those of u afterwards.
    v_r : float
        Regularisation [m/s].
    allowed : float
        What may be left of the largest moment [N m].

    Returns
    -------
    status, steps
    """
    bearing = p.bearing
    speed = max(abs(bearing.op.omega_i), abs(bearing.op.omega_o))
    least = FIRST_DAMPING * ball_inertia(ball_mass(bearing.g.rho, bearing.D), bearing.D) * speed
    damping, left = 0.0, 0.0
    for step in range(1, MOMENT_STEPS + 1):
        status = friction_balance(p, v_r, state, u, p.residual, True)
        size = largest_moment(p.residual)
        if status != OK or size <= allowed:
            return status, step
        for _ in range(DAMPINGS):
            left = math.inf
            if angular_response(p, damping, p.residual, p.step):
                for i in range(3):
                    p.trial[i] = u[i] + p.step[i]
                p.trial[3] = u[3]
                friction_balance(p, v_r, state, p.trial, p.shifted, False)
                for i in range(3):
                    p.shifted[i] -= damping * p.step[i]
                left = largest_moment(p.shifted)
            if left <= MOST_LEFT * size:
                break
            damping = max(DAMPING * damping, least)
        if not left <= MOST_LEFT * size:
            break
        copy(p.trial, u)
        damping *= EASING if left > LITTLE_LEFT * size else FAST_EASING
    return NOT_CONVERGED, MOMENT_STEPS


@jit
def balance_at_rate(p, v_r, near, u, tangent, balanced):
    """The force left at the orbit rate u[3] [rad/s].

    Parameters
    ----------
    v_r : float
        Regularisation [m/s].
    near : Seat
        Equilibrium at a rate nearby.
    u : ndarray (4,)
        u[:3] is a start, and is improved in place.
    tangent : ndarray (3,)
        Filled: du[:3]/du[3] with the loads held.
    balanced : float
        Moments that may be left, as a share of the friction forces; what they would still change
        is put in to first order [1].
    """
    bearing, J = p.bearing, p.jacobian
    seat = orbit_equilibrium(bearing, u[3], near)
    status, steps, F, slope = usable(seat.state), 0, math.nan, math.nan
    if status == OK:
        mu_i, mu_o = friction_coefficients(bearing.op, seat.state)
        capacity = 2.0 * min(mu_i * seat.state.Q_i, mu_o * seat.state.Q_o)
        allowed = balanced * 0.5 * bearing.D * capacity
        status, steps = balance_moments(p, v_r, seat.state, u, allowed)
        if status == OK:
            for i in range(3):
                tangent[i] = J[i, 3]
            if not angular_response(p, 0.0, tangent, tangent):
                status = NOT_CONVERGED
            elif angular_response(p, 0.0, p.residual, p.step):
                F, slope = p.residual[3], J[3, 3]
                for i in range(3):
                    u[i] += p.step[i]
                    F += J[3, i] * p.step[i]
                    slope += J[3, i] * tangent[i]
                scale = capacity * (bearing.g.R_o + seat.state.X2)
                F, slope = F / scale, slope / scale
    return RatePoint(status=status, seat=seat, F=F, slope=slope, steps=steps)


@jit
def next_step(point, way, step, span):
    """Step of the orbit rate from a point on, after one of the length `step` [rad/s].

    Longer, the farther F is from zero; towards zero, half of the distance.
    """
    longest = min(
        LONGEST_RATE_STEP * span, max(FIRST_RATE_STEP * span, abs(point.F) * span / STEEPEST_RISE)
    )
    towards = -way * point.slope * math.copysign(1.0, point.F)
    if towards * longest > 0.5 * abs(point.F):
        longest = max(0.5 * abs(point.F) / towards, SHORTEST_RATE_STEP * span)
    growth = LONGER if point.steps <= FEW else NEARLY_SAME if point.steps <= SEVERAL else SHORTER
    return min(longest, growth * step)


@jit
def settle(p, near, u, motions, count):
    """Let a ball that moves as u settle; append the motion it reaches.

    Parameters
    ----------
    near : Seat
        Equilibrium nearby.
    u : ndarray (4,)
        Kept.
    motions : ndarray (n, 4)
    count : int
        How many motions are there.

    Returns
    -------
    int
        How many there are now.
    """
    seat = orbit_equilibrium(p.bearing, u[3], near)
    if count == len(motions) or usable(seat.state) != OK:
        return count
    copy(u, motions[count])
    v_r = p.bearing.op.v_r
    status = pseudo_transient(p, v_r, seat, motions[count], SETTLED, SETTLING_STEPS).status
    # At a tiny v_r the steps may end before the ball has settled: Newton goes on.
    return count + (status == OK or status == NO_STEADY_STATE)


@jit
def search_towards(end, p, coarse, v_r, known, u_known, tangent, unstable, motions, count):
    """Follow F from a known state to an end, and settle where there may be another state.

    That is where F falls through zero with the orbit rate, on the far side of each stretch where F
    is about zero, and next to an unstable state.

    Parameters
    ----------
    end : float
        Orbit rate [rad/s].
    p, coarse : BalanceProblem
        To settle by, and to search by.
    v_r : float
        Regularisation of the search [m/s].
    u_known, tangent : ndarray (4,), (3,)
        Motion of the known state, and as in `balance_at_rate`.
    unstable : bool
        Whether a ball leaves the known state.
    motions, count
        As in `settle`.
    """
    span = orbit_range(p.bearing.op)[1]
    here, last, u = known, u_known.copy(), u_known.copy()
    ahead, turn = tangent.copy(), np.empty(3)
    way = math.copysign(1.0, end - u_known[3])
    step, first, neutral = FIRST_RATE_STEP * span, True, not unstable
    for _ in range(MOST_RATES):
        if last[3] == end:
            break
        u[3] = last[3] + way * step
        if way * (end - u[3]) < SHORTEST_RATE_STEP * span:
            u[3] = end
        for i in range(3):
            u[i] = last[i] + (u[3] - last[3]) * ahead[i]
        new = balance_at_rate(coarse, v_r, here.seat, u, turn, BALANCED_MOMENTS)
        if new.status != OK:
            if step <= FIRST_RATE_STEP * span:
                break
            step *= RETREAT
            continue
        falls = here.F * new.F <= 0.0 and way * new.F < 0.0
        leaves = neutral and abs(new.F) > NEUTRAL
        if (first and unstable) or (not first and (falls or leaves)):
            share = here.F / (here.F - new.F) if falls else 1.0
            for i in range(4):
                last[i] += share * (u[i] - last[i])
            count = settle(p, new.seat, last, motions, count)
        first, neutral = False, abs(new.F) <= NEUTRAL
        here = new
        copy(u, last)
        copy(turn, ahead)
        step = next_step(here, way, step, span)
    return settle(p, here.seat, last, motions, count) if neutral and not first else count


@inlined
def orbit_range(op):
    """Least orbit rate that a ball may have between its races, and the range of them [rad/s]."""
    low = min(op.omega_i, op.omega_o, 0.0)
    return low, max(op.omega_i, op.omega_o, 0.0) - low


@jit
def settled_elsewhere(bearing, rule, coarse_rule, v_r, delta_a, u_known, unstable, most):
    """Motions in which a ball settles from where there may be steady states besides a known one.

    Parameters
    ----------
    rule, coarse_rule : Rule
        For the ellipse: to settle by, and to search by.
    v_r : float
        Regularisation of the search, no smaller than that of the operating point [m/s].
    delta_a, u_known : float, ndarray (4,)
        Axial displacement [m], and (w_x, w_y, w_z, Omega) of the known state [rad/s].
    unstable : bool
        Whether a ball leaves it.
    most : int
        Motions to settle from, at the most.

    Returns
    -------
    ndarray (n, 4)
    """
    # Without traction on the normal forces, which moves a state, but makes none.
    p, coarse = balance_problem(bearing, rule, False), balance_problem(bearing, coarse_rule, False)
    return settled_motions(p, coarse, v_r, delta_a, u_known, unstable, most)


@jit
def settled_motions(p, coarse, v_r, delta_a, u_known, unstable, most):
    """`settled_elsewhere` of both balances: references to their buffers are not counted here."""
    low, span = orbit_range(p.bearing.op)
    u, tangent, motions = u_known.copy(), np.empty(3), np.empty((most, 4))
    near = Seat(delta_a=delta_a, state=cold_start())
    known = balance_at_rate(coarse, v_r, near, u, tangent, BALANCED_MOMENTS)
    count = 0
    if known.status == OK:
        for end in (low - BEYOND * span, low + (1.0 + BEYOND) * span):
            count = search_towards(end, p, coarse, v_r, known, u, tangent, unstable, motions, count)
    return motions[:count]
