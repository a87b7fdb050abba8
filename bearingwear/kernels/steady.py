"""The friction-balanced steady state of a thrust-loaded bearing (theory.md section 4).

One ball stands for all. Unknown are its angular velocity and orbit rate, u = (w_x, w_y, w_z,
Omega); zero are the three moments and the orbital force on it. Coulomb friction is saturated almost
everywhere, so a Newton start from afar sees a flat residual; the solver therefore follows the state
from a nearly viscous friction law (large v_r), where the problem is nearly linear, to the wanted
v_r. Each level is solved by Newton; where Newton does not get on, implicit Euler steps on the
ball's true equations of motion carry it, and these end only in a stable state.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.compile import jit
from bearingwear.kernels.contact import (
    slip_coefficients,
    slip_map,
    surface_height,
    traction,
    traction_slope,
)
from bearingwear.kernels.ellipse import most_points, place
from bearingwear.kernels.equilibrium import (
    ball_mass,
    cold_start,
    thrust_equilibrium,
)
from bearingwear.kernels.kinematics import ORBIT
from bearingwear.kernels.linear import solve_in_place
from bearingwear.kernels.params import BallLoad, BallState, Contact
from bearingwear.kernels.status import (
    BEYOND_GROOVE,
    CONTACT_LOST,
    NO_STEADY_STATE,
    NOT_CONVERGED,
    OK,
    OUTSIDE_HERTZ_RANGE,
    PRELOAD_GONE,
)

# Hertz takes the bodies for paraboloids; at this size of ellipse the ball's own edge is near.
LARGEST_AXIS = 0.7  # a / R
NEAR_ROUNDING = 1e-11  # residual, as a share of the friction forces, that rounding may leave
LAST_BIT = 2.0**-50  # of the ball's speeds, with what the sums that make a slip of them add
LIGHTEST = 1e-4  # share of a contact's load that rounding of its place may make
STALLED = 5e-10  # and that noise of lightly loaded contacts may leave; verified after the solve


class Preload(NamedTuple):
    """How the inner race is held."""

    constant_force: bool
    F_x: float  # preload, used if constant_force [N]
    delta_a: float  # axial displacement, used if not constant_force [m]


class Workspace(NamedTuple):
    """Buffers of one solve for n points a contact."""

    t: np.ndarray  # (n,) points of the contact at hand, if they depend on it
    weight: np.ndarray  # (n,)
    h: np.ndarray  # (2, n), row 0 inner, 1 outer
    gradient: np.ndarray  # (4,)
    hessian: np.ndarray  # (4, 4)
    L: np.ndarray  # (4, 4)
    residual: np.ndarray  # (4,)
    shifted: np.ndarray  # (4,)
    jacobian: np.ndarray  # (4, 4)
    matrix: np.ndarray  # (4, 4)
    step: np.ndarray  # (4,)
    trial: np.ndarray  # (4,)


@jit
def workspace(rule):
    """Buffers for a rule."""
    n = most_points(rule)
    return Workspace(
        np.empty(n), np.empty(n), np.empty((2, n)), np.empty(4), np.empty((4, 4)), np.empty((4, 4)),
        np.empty(4), np.empty(4), np.empty((4, 4)), np.empty((4, 4)), np.empty(4), np.empty(4),
    )  # fmt: skip


@jit
def race_contacts(g, motion, state):
    """The two loaded contacts (inner, outer) of a ball in equilibrium."""
    return (
        Contact(
            -1.0, state.Q_i, state.hertz_i.c_a * state.Q_i ** (1.0 / 3.0),
            math.sin(state.alpha_i), math.cos(state.alpha_i), g.r_i, motion.omega_i,
        ),
        Contact(
            1.0, state.Q_o, state.hertz_o.c_a * state.Q_o ** (1.0 / 3.0),
            math.sin(state.alpha_o), math.cos(state.alpha_o), g.r_o, motion.omega_o,
        ),
    )  # fmt: skip


@jit
def drag_force(g, D, drag, Omega):
    """Lubricant drag along +y on a ball that orbits, and its slope (theory.md Eq. 17)."""
    c = math.pi / 8.0 * drag * D * D * (0.5 * g.dm) ** 2
    return c * Omega * abs(Omega), 2.0 * c * abs(Omega)


@jit
def friction_balance(g, D, motion, v_r, state, u, rule, work, out, slope):
    """Moments and orbital moment on the ball: its equations of motion's right-hand side.

    Parameters
    ----------
    u : ndarray (4,)
        (w_x, w_y, w_z, Omega) [rad/s].
    out : ndarray (4,)
        Filled: I dw_x/dt, I dw_y/dt, I dw_z/dt, m r^2 dOmega/dt [N m].
    slope : bool
        Whether to fill `work.jacobian` too: d out/du with the loads held.

    Returns
    -------
    int
        OUTSIDE_HERTZ_RANGE where an ellipse is as large as its ball, else OK.
    """
    r = g.R_o + state.X2
    R = 0.5 * D
    J = work.jacobian
    out[:] = 0.0
    if slope:
        J[:, :] = 0.0
    contacts = race_contacts(g, motion, state)
    for k in range(2):
        contact = contacts[k]
        if contact.a >= LARGEST_AXIS * R:
            return OUTSIDE_HERTZ_RANGE
        h = work.h[k]
        c = slip_coefficients(contact, u, r)
        t, weight = place(rule, contact, R, c, v_r, work.t, work.weight)
        surface_height(contact, R, t, h)
        slip_map(contact, r, work.L)
        L = work.L
        G = work.gradient
        if slope:
            H = work.hessian
            traction_slope(contact, c, motion.mu, v_r, t, weight, h, G, H)
            for i in range(4):
                for p in range(4):
                    if L[p, i] != 0.0:
                        out[i] -= L[p, i] * G[p]
                        for j in range(4):
                            s = 0.0
                            for q in range(4):
                                s += H[p, q] * L[q, j]
                            J[i, j] -= L[p, i] * s
        else:
            traction(contact, c, motion.mu, v_r, t, weight, h, G)
            for i in range(4):
                for p in range(4):
                    out[i] -= L[p, i] * G[p]
    inertia = 0.1 * ball_mass(g, D) * D * D
    out[1] += inertia * u[3] * u[2]
    out[2] -= inertia * u[3] * u[1]
    F_v, dF_v = drag_force(g, D, motion.drag, u[3])
    out[3] -= r * F_v
    if slope:
        J[1, 2] += inertia * u[3]
        J[1, 3] += inertia * u[2]
        J[2, 1] -= inertia * u[3]
        J[2, 3] -= inertia * u[1]
        J[3, 3] -= r * dF_v
    return OK


@jit
def balance_size(g, D, mu, state, out):
    """Largest unbalanced moment or orbital force, as a share of the friction forces [1]."""
    capacity = mu * (state.Q_i + state.Q_o)
    moment = max(abs(out[0]), abs(out[1]), abs(out[2])) / (0.5 * D)
    return max(moment, abs(out[3]) / (g.R_o + state.X2)) / capacity


@jit
def rounding(g, D, mu, state, u, J):
    """What the last bits of speeds and places make of the balance, and of its power.

    Slip is a small difference of large speeds: at a small v_r the speeds cannot be stored finely
    enough to balance friction any better. Nor can a light load, whose deformation is a small
    difference of large lengths.

    Parameters
    ----------
    J : ndarray (4, 4)
        Jacobian of the balance by u.

    Returns
    -------
    share : float
        Of the friction forces [1].
    power : float
        [W]
    light : float
        The part of `share` that is the load's [1].
    """
    capacity = mu * (state.Q_i + state.Q_o)
    d_i = (state.Q_i / state.hertz_i.K) ** (2.0 / 3.0)
    d_o = (state.Q_o / state.hertz_o.K) ** (2.0 / 3.0)
    light = 1.5 * LAST_BIT * max(g.r_i / d_i, g.r_o / d_o)
    share = light
    r, R = g.R_o + state.X2, 0.5 * D
    power = share * capacity * (r * abs(u[3]) + R * max(abs(u[0]), abs(u[2])))
    for i in range(4):
        left = 0.0
        for j in range(4):
            left += LAST_BIT * abs(J[i, j] * u[j])
        arm = R if i < 3 else r
        share = max(share, left / (arm * capacity))
        power += abs(u[i]) * left
    return share, power, light


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


@jit
def orbit_equilibrium(g, D, Omega, preload, delta_a, start):
    """Ball and race equilibrium at the orbit rate Omega."""
    load = BallLoad(ORBIT, Omega, 0.0, 0.0, 0.0, 0.0)
    if not preload.constant_force:
        delta_a = preload.delta_a
    return thrust_equilibrium(g, D, load, preload.F_x, delta_a, preload.constant_force, start)


@jit
def full_jacobian(g, D, motion, v_r, preload, delta_a, state, u, rule, work):
    """Residual and Jacobian, the loads following the orbit rate.

    That the centrifugal force follows the orbit rate enters as a difference quotient; its step
    moves the slip by far less than v_r.
    """
    status = friction_balance(g, D, motion, v_r, state, u, rule, work, work.residual, True)
    if status != OK:
        return status
    scale = max(abs(u[3]), abs(motion.omega_i), abs(motion.omega_o))
    if scale > 0.0:
        speed = scale * g.dm
        dOmega = scale * min(1e-6, max(1e-9, 1e-2 * v_r / speed))
        delta, moved = orbit_equilibrium(g, D, u[3] + dOmega, preload, delta_a, state)
        if usable(moved) == OK:
            status = friction_balance(g, D, motion, v_r, moved, u, rule, work, work.shifted, False)
            if status == OK:
                for i in range(4):
                    work.jacobian[i, 3] += (work.shifted[i] - work.residual[i]) / dOmega
    return OK


@jit
def newton(g, D, motion, v_r, preload, delta_a, state, u, rule, work, tolerance, most):
    """Damped Newton at one v_r; u is improved in place.

    Returns
    -------
    status, delta_a, state, iterations, size
    """
    trial = work.trial
    size = 1e300
    floor = 0.0
    for iteration in range(most):
        status = full_jacobian(g, D, motion, v_r, preload, delta_a, state, u, rule, work)
        if status != OK:
            return status, delta_a, state, iteration, size
        size = balance_size(g, D, motion.mu, state, work.residual)
        if size <= tolerance:
            return OK, delta_a, state, iteration, size
        floor, _, light = rounding(g, D, motion.mu, state, u, work.jacobian)
        if not light <= LIGHTEST:
            return CONTACT_LOST, delta_a, state, iteration, size
        work.matrix[:, :] = work.jacobian
        for i in range(4):
            work.step[i] = -work.residual[i]
        if not solve_in_place(work.matrix, work.step, 4):
            return NOT_CONVERGED, delta_a, state, iteration, size
        damping = 1.0
        found = False
        near = size <= max(NEAR_ROUNDING, floor)  # only the full step is worth a try
        for _ in range(1 if near else 12):
            for i in range(4):
                trial[i] = u[i] + damping * work.step[i]
            delta, moved = orbit_equilibrium(g, D, trial[3], preload, delta_a, state)
            if usable(moved) == OK:
                status = friction_balance(
                    g, D, motion, v_r, moved, trial, rule, work, work.shifted, False
                )
                if status == OK:
                    new = balance_size(g, D, motion.mu, moved, work.shifted)
                    if new < (1.0 - 1e-4 * damping) * size or new <= tolerance:
                        found = True
                        break
            damping *= 0.5
        if not found:
            if size <= max(STALLED, floor):
                return OK, delta_a, state, iteration, size
            return NOT_CONVERGED, delta_a, state, iteration, size
        u[:] = trial
        delta_a, state = delta, moved
        if near and new > 0.7 * size:
            return OK, delta_a, state, iteration, new
    return (OK if size <= max(NEAR_ROUNDING, floor) else NOT_CONVERGED), delta_a, state, most, size


@jit
def settle(g, D, motion, v_r, preload, delta_a, state, u, rule, work, tolerance, most):
    """Implicit Euler steps on the ball's equations of motion, ever longer, to a stable state.

    Slow but sure where Newton fails. Each step solves its linearised equation once and is taken if
    that left no more than half of the residual unexplained; the steps grow as long as they are
    taken, until they are Newton's. u is improved in place.

    Returns
    -------
    status, delta_a, state, iterations, size
    """
    trial = work.trial
    m = ball_mass(g, D)
    r = g.R_o + state.X2
    inertia = (0.1 * m * D * D, 0.1 * m * D * D, 0.1 * m * D * D, m * r * r)
    speed = max(abs(motion.omega_i), abs(motion.omega_o))
    dt = 1e-3 / speed if speed > 0.0 else 1e-6
    size = 1e300
    why = OK  # what the last steps that were refused ran into
    for iteration in range(most):
        status = full_jacobian(g, D, motion, v_r, preload, delta_a, state, u, rule, work)
        if status != OK:
            return status, delta_a, state, iteration, size
        size = balance_size(g, D, motion.mu, state, work.residual)
        floor, _, light = rounding(g, D, motion.mu, state, u, work.jacobian)
        if not light <= LIGHTEST:
            return CONTACT_LOST, delta_a, state, iteration, size
        if size <= max(tolerance, floor):
            return OK, delta_a, state, iteration, size
        found = False
        why = OK
        for _ in range(30):
            for i in range(4):
                work.step[i] = work.residual[i]
                for j in range(4):
                    work.matrix[i, j] = -work.jacobian[i, j]
                work.matrix[i, i] += inertia[i] / dt
            if solve_in_place(work.matrix, work.step, 4):
                for i in range(4):
                    trial[i] = u[i] + work.step[i]
                delta, moved = orbit_equilibrium(g, D, trial[3], preload, delta_a, state)
                if usable(moved) == OK:
                    status = friction_balance(
                        g, D, motion, v_r, moved, trial, rule, work, work.shifted, False
                    )
                    for i in range(4):
                        work.shifted[i] -= inertia[i] / dt * work.step[i]
                    unexplained = balance_size(g, D, motion.mu, moved, work.shifted)
                    if status == OK and unexplained <= 0.5 * size:
                        found = True
                        break
                    why = status
                else:
                    why = usable(moved)
            dt *= 0.25
        if not found:
            return (NOT_CONVERGED if why == OK else why), delta_a, state, iteration, size
        u[:] = trial
        delta_a, state = delta, moved
        dt *= 2.0 if unexplained > 0.1 * size else 4.0
    return (NO_STEADY_STATE if why == OK else why), delta_a, state, most, size


class Solution(NamedTuple):
    """Outcome of `steady_state`; the state itself is in the vector u."""

    status: int
    delta_a: float
    state: BallState
    iterations: int
    size: float  # residual, as a share of the friction forces [1]


@jit
def steady_state(g, D, motion, preload, rule, work, u, v_start, tolerance):
    """Steady state at `motion.v_r`, followed down from the regularisation `v_start`.

    Parameters
    ----------
    u : ndarray (4,)
        Start; the answer replaces it.
    v_start : float
        Regularisation of the first solve [m/s]. With the wanted one, u must be near; where that
        fails the solver goes up by itself and comes down again.
    tolerance : float
        On the residual, as a share of the friction forces [1].

    Returns
    -------
    Solution
    """
    delta_a, state = orbit_equilibrium(g, D, u[3], preload, preload.delta_a, cold_start())
    lost = state.status
    for _ in range(60):
        # A ball off the inner race is driven no more: it slows down until it is back on.
        if state.status != CONTACT_LOST:
            break
        u *= 0.9
        delta_a, state = orbit_equilibrium(g, D, u[3], preload, preload.delta_a, cold_start())
    if usable(state) != OK:
        return Solution(usable(state), delta_a, state, 0, 1e300)
    first = u.copy()
    target = motion.v_r
    surface = 0.5 * g.dm * abs(motion.omega_i - motion.omega_o)
    top = max(target, surface)  # slip can hardly exceed it: friction is viscous here
    v = min(max(v_start, target), top)
    reached = math.inf
    factor = 0.15
    total = 0
    kept, before = u.copy(), u.copy()  # the last two levels reached
    reached_before = math.inf
    kept_delta, kept_state = delta_a, state
    for _ in range(90):
        if not math.isinf(reached_before):
            # Where a contact sticks its slip goes as v_r, and the state with it.
            ahead = (v - reached) / (reached - reached_before)
            for i in range(4):
                u[i] = kept[i] + ahead * (kept[i] - before[i])
            delta_a, state = orbit_equilibrium(g, D, u[3], preload, kept_delta, kept_state)
            if usable(state) != OK:
                u[:] = kept
                delta_a, state = kept_delta, kept_state
        goal = tolerance if v <= target else 1e-6
        status, delta_a, state, n, size = newton(
            g, D, motion, v, preload, delta_a, state, u, rule, work, goal, 30
        )
        total += n
        if status == OUTSIDE_HERTZ_RANGE:
            return Solution(status, delta_a, state, total, size)
        if status != OK and v < top and (math.isinf(reached) or factor < 0.8):
            u[:] = kept
            delta_a, state = kept_delta, kept_state
            if math.isinf(reached):
                v = min(30.0 * v, top)
            else:
                factor = math.sqrt(factor)
                v = max(reached * factor, target)
            continue
        if status != OK:
            u[:] = kept
            goal = max(goal, NEAR_ROUNDING)
            status, delta_a, state, n, size = settle(
                g, D, motion, v, preload, kept_delta, kept_state, u, rule, work, goal, 1500
            )
            total += n
            for share in (1.0, 0.1):
                # The way down is blocked: follow the ball's own motion at the wanted v_r, from the
                # first start, and from nearly at rest, as a ball that skids.
                if status != OK:
                    v = target
                    u[:] = share * first
                    delta_a, state = orbit_equilibrium(
                        g, D, u[3], preload, preload.delta_a, cold_start()
                    )
                    if usable(state) == OK:
                        status, delta_a, state, n, size = settle(
                            g, D, motion, v, preload, delta_a, state, u, rule, work,
                            NEAR_ROUNDING, 1500,
                        )  # fmt: skip
                        total += n
            if status != OK:
                _, still = orbit_equilibrium(g, D, 0.0, preload, preload.delta_a, cold_start())
                if still.status == PRELOAD_GONE:
                    # Centrifugal force alone held the ball, and nothing drove it on.
                    status = PRELOAD_GONE
                return Solution(status if lost == OK else lost, delta_a, state, total, size)
            if v <= target:
                # Its steps end where the balance is good; Newton's go on to rounding.
                trial = u.copy()
                status, delta, moved, n, better = newton(
                    g, D, motion, v, preload, delta_a, state, trial, rule, work, tolerance, 30
                )
                total += n
                if status == OK and better <= size:
                    u[:] = trial
                    delta_a, state, size = delta, moved, better
        if v <= target:
            return Solution(OK, delta_a, state, total, size)
        if v < reached:
            reached_before = reached
            before[:] = kept
        reached = v
        kept[:] = u
        kept_delta, kept_state = delta_a, state
        v = max(target, v * factor)
        if v < 1.5 * target:
            v = target
    return Solution(NOT_CONVERGED, delta_a, state, total, size)
