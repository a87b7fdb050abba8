"""Solvers of the steady balance at one regularisation v_r (theory.md section 4).

Newton, and pseudo-transient continuation where Newton fails: implicit Euler steps on the ball's
true equations of motion, which end only in a stable state.
"""

from typing import NamedTuple

from bearingwear.kernels.ball import ball_inertia, ball_mass
from bearingwear.kernels.decorators import inlined, jit
from bearingwear.kernels.linear import copy, solve_in_place
from bearingwear.kernels.status import CONTACT_LOST, NO_STEADY_STATE, NOT_CONVERGED, OK
from bearingwear.kernels.steady.balance import (
    Seat,
    balance_size,
    friction_balance,
    full_jacobian,
    motion_equilibrium,
    rounding,
    usable,
)

UNKNOWN = 1e300  # size of a residual that was never found

# Residuals, as shares of the friction forces.
NEAR_ROUNDING = 1e-11  # that rounding may leave
STALLED = 5e-10  # and that noise of lightly loaded contacts may leave; verified after the solve
LIGHTEST = 1e-4  # share of a contact's load that rounding of its place may make

# Newton
NEWTON_STEPS = 30
HALVINGS = 12  # of a step, at the most
DESCENT = 1e-4  # share of the promised decrease that a step must bring
SLOW = 0.7  # a decrease by less than this, near rounding, is the last one

# Pseudo-transient continuation
TRANSIENT_STEPS = 1500
FIRST_TURN = 1e-3  # first step, as the angle that the faster race turns by [rad]
FIRST_STEP_AT_REST = 1e-6  # [s]
SHORTENINGS = 30  # of a step, at the most, each by
SHORTENING = 0.25
UNEXPLAINED = 0.5  # share of the residual that the linearised step may leave; with
WELL_EXPLAINED = 0.1  # or less the next step is
GROWTH, FAST_GROWTH = 2.0, 4.0  # times as long


class Solution(NamedTuple):
    """Outcome of a solve; the motion itself is in the vector u."""

    status: int
    seat: Seat
    iterations: int
    size: float  # residual, as a share of the friction forces [1]


@inlined
def line_search(p, v_r, seat, u, size, tolerance, halvings):
    """Shorten Newton's step in `p.step` until it lessens the residual.

    Most full steps do, so the Jacobian, which the next step needs, is found with the residual.

    Returns
    -------
    found, size, seat
        Whether it does; the residual and the equilibrium at `p.trial`.
    """
    damping, new, moved = 1.0, UNKNOWN, seat
    for _ in range(halvings):
        for i in range(u.size):
            p.trial[i] = u[i] + damping * p.step[i]
        moved = motion_equilibrium(p.bearing, p.trial, seat)
        if usable(moved.state) == OK:
            if full_jacobian(p, v_r, moved, p.trial) == OK:
                new = balance_size(p.bearing, moved.state, p.residual)
                if new < (1.0 - DESCENT * damping) * size or new <= tolerance:
                    return True, new, moved
        damping *= 0.5
    return False, new, moved


@jit
def newton(p, v_r, seat, u, tolerance):
    """Damped Newton at one v_r; u is improved in place.

    Parameters
    ----------
    seat : Seat
        Equilibrium of u.
    tolerance : float
        On the residual, as a share of the friction forces [1].
    """
    status, floor = full_jacobian(p, v_r, seat, u), 0.0
    if status != OK:
        return Solution(status=status, seat=seat, iterations=0, size=UNKNOWN)
    size = balance_size(p.bearing, seat.state, p.residual)
    for iteration in range(NEWTON_STEPS):
        if size <= tolerance:
            return Solution(status=OK, seat=seat, iterations=iteration, size=size)
        noise = rounding(p.bearing, seat.state, u, p.jacobian)
        floor = noise.share
        if not noise.light <= LIGHTEST:
            return Solution(status=CONTACT_LOST, seat=seat, iterations=iteration, size=size)
        copy(p.jacobian, p.matrix)
        for i in range(u.size):
            p.step[i] = -p.residual[i]
        if not solve_in_place(p.matrix, p.step, u.size):
            return Solution(status=NOT_CONVERGED, seat=seat, iterations=iteration, size=size)
        near = size <= max(NEAR_ROUNDING, floor)  # only the full step is worth a try
        found, new, moved = line_search(p, v_r, seat, u, size, tolerance, 1 if near else HALVINGS)
        if not found:
            status = OK if size <= max(STALLED, floor) else NOT_CONVERGED
            return Solution(status=status, seat=seat, iterations=iteration, size=size)
        copy(p.trial, u)
        seat = moved
        if near and new > SLOW * size:
            return Solution(status=OK, seat=seat, iterations=iteration, size=new)
        size = new
    status = OK if size <= max(NEAR_ROUNDING, floor) else NOT_CONVERGED
    return Solution(status=status, seat=seat, iterations=NEWTON_STEPS, size=size)


@inlined
def implicit_step(p, v_r, seat, u, size, inertia, dt):
    """One implicit Euler step, linearised, as long as it explains the residual.

    Returns
    -------
    found, why, unexplained, seat, dt
        Whether a step was found; the status of the last one refused; the residual it leaves;
        the equilibrium at `p.trial`; its length [s].
    """
    why, unexplained, moved = OK, UNKNOWN, seat
    for _ in range(SHORTENINGS):
        for i in range(u.size):
            p.step[i] = p.residual[i]
            for j in range(u.size):
                p.matrix[i, j] = -p.jacobian[i, j]
            if i < 4:  # tractions have none
                p.matrix[i, i] += inertia[i] / dt
        if solve_in_place(p.matrix, p.step, u.size):
            for i in range(u.size):
                p.trial[i] = u[i] + p.step[i]
            moved = motion_equilibrium(p.bearing, p.trial, seat)
            status = usable(moved.state)
            if status == OK:
                status = friction_balance(p, v_r, moved.state, p.trial, p.shifted, False)
                for i in range(4):
                    p.shifted[i] -= inertia[i] / dt * p.step[i]
                unexplained = balance_size(p.bearing, moved.state, p.shifted)
                if status == OK and unexplained <= UNEXPLAINED * size:
                    return True, why, unexplained, moved, dt
            why = status
        dt *= SHORTENING
    return False, why, unexplained, moved, dt


@jit
def pseudo_transient(p, v_r, seat, u, tolerance, most):
    """Pseudo-transient continuation to a stable state; u is improved in place.

    Slow but safe where Newton fails. Each implicit Euler step on the ball's equations of motion
    solves its linearised equation once. It is accepted if that leaves at most half of the residual
    unexplained. Accepted steps grow until they are Newton's.

    Parameters
    ----------
    most : int
        Number of steps at the most; otherwise as `newton`.
    """
    g, D, op = p.bearing.g, p.bearing.D, p.bearing.op
    m = ball_mass(g.rho, D)
    r = g.R_o + seat.state.X2
    spin = ball_inertia(m, D)
    inertia = (spin, spin, spin, m * r * r)
    speed = max(abs(op.omega_i), abs(op.omega_o))
    dt = FIRST_TURN / speed if speed > 0.0 else FIRST_STEP_AT_REST
    size, why = UNKNOWN, OK
    for iteration in range(most):
        status = full_jacobian(p, v_r, seat, u)
        if status != OK:
            return Solution(status=status, seat=seat, iterations=iteration, size=size)
        size = balance_size(p.bearing, seat.state, p.residual)
        noise = rounding(p.bearing, seat.state, u, p.jacobian)
        if not noise.light <= LIGHTEST:
            return Solution(status=CONTACT_LOST, seat=seat, iterations=iteration, size=size)
        if size <= max(tolerance, noise.share):
            return Solution(status=OK, seat=seat, iterations=iteration, size=size)
        found, why, unexplained, moved, dt = implicit_step(p, v_r, seat, u, size, inertia, dt)
        if not found:
            status = NOT_CONVERGED if why == OK else why
            return Solution(status=status, seat=seat, iterations=iteration, size=size)
        copy(p.trial, u)
        seat = moved
        dt *= GROWTH if unexplained > WELL_EXPLAINED * size else FAST_GROWTH
    status = NO_STEADY_STATE if why == OK else why
    return Solution(status=status, seat=seat, iterations=most, size=size)
