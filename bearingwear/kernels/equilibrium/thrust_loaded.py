"""Normal-force equilibrium of the balls and of the inner race (theory.md section 2).

With the Hertz factors held, each contact is a spring that only pulls the groove centres together
(the energy is a convex function of ball centre and race displacement), so the equilibrium is
unique and damped Newton finds it from anywhere. The factors follow the contact angle so weakly
(1e-4 of the stiffness) that they are refreshed in every step and left out of the tangent.
"""

import math
from typing import NamedTuple

from bearingwear.kernels.contact.hertz import INNER, OUTER, race_contact
from bearingwear.kernels.contact.profile import contact_approach, contact_load, contact_stiffness
from bearingwear.kernels.decorators import inlined, jit
from bearingwear.kernels.equilibrium.body_forces import (
    body_forces,
    body_forces_at,
    unbalanced_force,
)
from bearingwear.kernels.equilibrium.kinematics import ORBIT
from bearingwear.kernels.params import BallLoad, BallState, Hertz
from bearingwear.kernels.status import (
    CONTACT_LOST,
    NOT_CONVERGED,
    OK,
    PRELOAD_GONE,
)

# The force balance hangs on differences of lengths, so rounding sets its floor: Newton is done when
# the last step was so short that the next would be below rounding.
LAST_STEP = 1e-11  # of the distance of the groove centres
QUOTIENT = 1e-7  # step of a difference quotient, of the free length of the outer spring
LONGEST_STEP = 2.0  # of the bead's slack, see `ball_newton`
PROMISED = 0.5  # share of the energy's slope that a step must leave
MOST_STEPS = 200
PATIENT = 30  # steps of the race after which every other one is a bisection
FORCE_BALANCED = 1e-12  # share of the preload that may be left, or
ROUNDED_STEP = 1e-16  # a step of the race, over the distance of the groove centres
UNBOUNDED = 1e300


class Spring(NamedTuple):
    """A contact as a spring between groove centre and ball centre."""

    Q: float  # load [N]
    s: float  # sine and cosine of the contact angle
    c: float
    k11: float  # stiffness [N/m]
    k12: float
    k22: float


@jit
def orbit_load(Omega, T_i, T_o):
    """Load of a ball at a given orbit rate [rad/s] with given tractions [N] alone."""
    return BallLoad(
        kinematics_model=ORBIT,
        Omega=Omega,
        omega_i=0.0,
        omega_o=0.0,
        P_x=0.0,
        P_r=0.0,
        T_i=T_i,
        T_o=T_o,
    )


@inlined
def loaded_spring(Q, d, length, s, c):
    """A closed contact as a spring, from its load, approach, length, sine and cosine."""
    k, t = contact_stiffness(Q, d), Q / length
    return Spring(
        Q=Q,
        s=s,
        c=c,
        k11=k * s * s + t * c * c,
        k12=(k - t) * s * c,
        k22=k * c * c + t * s * s,
    )


@jit
def spring(K, X1, X2, free):
    """Contact of the Hertz factor K as a spring along (X1, X2), its length `free` without load."""
    length = math.sqrt(X1 * X1 + X2 * X2)
    s, c = X1 / length, X2 / length
    d = length - free
    if d <= 0.0:
        return Spring(Q=0.0, s=s, c=c, k11=0.0, k12=0.0, k22=0.0)
    Q = contact_load(K, d)
    return loaded_spring(Q, d, length, s, c)


@jit
def cold_start():
    """A start for `ball_equilibrium` without a known solution nearby."""
    unknown = Hertz(K=0.0, c_a=0.0, c_b=0.0, log_kappa=math.nan, E=0.0)
    return open_ball(NOT_CONVERGED, 0.0, 0.0, 0.0, 0.0, 0.0, unknown, unknown)


@jit
def open_ball(status, X1, X2, alpha_i, alpha_o, P_r, hertz_i, hertz_o):
    """A ball off the inner race: held on the outer race by P_r, or loose."""
    return BallState(
        status=status,
        X1=X1,
        X2=X2,
        alpha_i=alpha_i,
        alpha_o=alpha_o,
        Q_i=0.0,
        Q_o=P_r,
        hertz_i=hertz_i,
        hertz_o=hertz_o,
        F_ix=0.0,
        F_ir=0.0,
        S_xx=0.0,
        S_xr=0.0,
        S_rr=0.0,
        P_x=0.0,
        P_r=P_r,
        residual=0.0,
    )


@inlined
def series_stiffness(inner, outer):
    """Stiffness (S_xx, S_xr, S_rr) of the inner force with the ball centre free [N/m].

    S = k_i - k_i (k_i + k_o)^-1 k_i, which for one spring k_i behind another k_o is
    k_o (k_i + k_o)^-1 k_i; nothing for a ball that touches nothing.
    """
    k11, k12, k22 = inner.k11 + outer.k11, inner.k12 + outer.k12, inner.k22 + outer.k22
    det = k11 * k22 - k12 * k12
    u1 = u2 = v1 = v2 = 0.0
    if det > 0.0:
        u1 = (k22 * inner.k11 - k12 * inner.k12) / det
        u2 = (k11 * inner.k12 - k12 * inner.k11) / det
        v1 = (k22 * inner.k12 - k12 * inner.k22) / det
        v2 = (k11 * inner.k22 - k12 * inner.k12) / det
    return (
        outer.k11 * u1 + outer.k12 * u2,
        outer.k11 * v1 + outer.k12 * v2,
        outer.k12 * v1 + outer.k22 * v2,
    )


@inlined
def closed_ball(status, X1, X2, inner, outer, hertz_i, hertz_o, P_x, P_r, T_i, residual):
    """The record of a ball between two springs."""
    S_xx, S_xr, S_rr = series_stiffness(inner, outer)
    return BallState(
        status=status,
        X1=X1,
        X2=X2,
        alpha_i=math.atan2(inner.s, inner.c),
        alpha_o=math.atan2(outer.s, outer.c),
        Q_i=inner.Q,
        Q_o=outer.Q,
        hertz_i=hertz_i,
        hertz_o=hertz_o,
        F_ix=inner.Q * inner.s + T_i * inner.c,
        F_ir=inner.Q * inner.c - T_i * inner.s,
        S_xx=S_xx,
        S_xr=S_xr,
        S_rr=S_rr,
        P_x=P_x,
        P_r=P_r,
        residual=residual,
    )


@inlined
def ball_tangent(g, D, load, A1, A2, X1, X2, inner, outer, P_x, P_r):
    """Stiffness (k11, k12, k21, k22) of the forces on a ball against its own displacement [N/m].

    Tractions turn with the contact angles; that of race control as a difference quotient.
    """
    k11, k12, k22 = inner.k11 + outer.k11, inner.k12 + outer.k12, inner.k22 + outer.k22
    k21 = k12
    if load.T_i != 0.0 or load.T_o != 0.0:
        t_i = -load.T_i / math.sqrt((A1 - X1) ** 2 + (A2 - X2) ** 2)
        t_o = load.T_o / math.sqrt(X1 * X1 + X2 * X2)
        k11 += t_i * inner.s * inner.c + t_o * outer.s * outer.c
        k12 -= t_i * inner.s * inner.s + t_o * outer.s * outer.s
        k21 += t_i * inner.c * inner.c + t_o * outer.c * outer.c
        k22 -= t_i * inner.s * inner.c + t_o * outer.s * outer.c
    if load.kinematics_model != ORBIT:
        h = QUOTIENT * (g.r_o - 0.5 * D)
        p1, p2 = body_forces_at(g, D, load, A1, A2, X1 + h, X2)
        q1, q2 = body_forces_at(g, D, load, A1, A2, X1, X2 + h)
        k11, k21 = k11 - (p1 - P_x) / h, k21 - (p2 - P_r) / h
        k12, k22 = k12 - (q1 - P_x) / h, k22 - (q2 - P_r) / h
    return k11, k12, k21, k22


@jit
def ball_newton(g, D, load, A1, A2, X1, X2, hertz_i, hertz_o):
    """Damped Newton for the centre of a ball from (X1, X2).

    Across the line of the grooves a lightly loaded ball hangs like a bead on a slack string: the
    tangent promises steps that would stretch the string far beyond its deformation. Steps are
    therefore kept short against that, and halved where the energy, convex along the step, has
    turned upwards.
    """
    free_i, free_o = g.r_i - 0.5 * D, g.r_o - 0.5 * D
    small = LAST_STEP * math.sqrt(A1 * A1 + A2 * A2)
    status = NOT_CONVERGED
    slope = 0.0  # of the energy along the last full step, negative [N m]
    step1 = step2 = size = 0.0
    shortened = True
    inner = outer = Spring(Q=0.0, s=0.0, c=0.0, k11=1.0, k12=1.0, k22=1.0)
    P_x = P_r = T_i = 0.0
    for _ in range(MOST_STEPS):
        outer = spring(hertz_o.K, X1, X2, free_o)
        inner = spring(hertz_i.K, A1 - X1, A2 - X2, free_i)
        P_x, P_r, T_i = body_forces(g, D, load, X2, inner.s, inner.c, outer.s, outer.c)
        r1, r2 = unbalanced_force(inner, outer, P_x, P_r)
        size = math.sqrt(r1 * r1 + r2 * r2)
        if not shortened and abs(step1) + abs(step2) <= small:
            status = OK
            break
        k11, k12, k21, k22 = ball_tangent(g, D, load, A1, A2, X1, X2, inner, outer, P_x, P_r)
        det = k11 * k22 - k12 * k21
        if not det > 0.0 or r1 * step1 + r2 * step2 < PROMISED * slope:
            if slope == 0.0:
                break
            step1, step2, slope = 0.5 * step1, 0.5 * step2, 0.5 * slope
            X1, X2 = X1 - step1, X2 - step2
            shortened = True
            continue
        step1 = (k22 * r1 - k12 * r2) / det
        step2 = (k11 * r2 - k21 * r1) / det
        d_P = contact_approach(hertz_o.K, abs(P_r))
        d = contact_approach(hertz_i.K, inner.Q) + contact_approach(hertz_o.K, outer.Q) + d_P
        longest = LONGEST_STEP * math.sqrt(d * min(free_i, free_o))
        length = math.sqrt(step1 * step1 + step2 * step2)
        shortened = length > longest
        if shortened:
            step1, step2 = step1 * longest / length, step2 * longest / length
        slope = -(r1 * step1 + r2 * step2)
        X1, X2 = X1 + step1, X2 + step2
        hertz_o = race_contact(g, OUTER, D, direction_cosine(X1, X2), hertz_o.log_kappa)
        hertz_i = race_contact(g, INNER, D, direction_cosine(A1 - X1, A2 - X2), hertz_i.log_kappa)
    return closed_ball(status, X1, X2, inner, outer, hertz_i, hertz_o, P_x, P_r, T_i, size)


@jit
def direction_cosine(X1, X2):
    """Cosine of the contact angle of a ball centre at (X1, X2) from a groove's."""
    return X2 / math.sqrt(X1 * X1 + X2 * X2)


@jit
def ball_equilibrium(g, D, load, A1, A2, start):
    """Ball centre between two given groove centres.

    Parameters
    ----------
    D : float
        Worn ball diameter [m].
    A1, A2 : float
        Axial and radial distance of the groove centres [m].
    start : BallState
        Of a solve nearby, or `cold_start()`.

    Returns
    -------
    BallState
        status OK, CONTACT_LOST (held by the outer race alone), PRELOAD_GONE (no load at all) or
        NOT_CONVERGED.
    """
    free_i, free_o = g.r_i - 0.5 * D, g.r_o - 0.5 * D
    length = math.sqrt(A1 * A1 + A2 * A2)
    if start.status == OK:
        X1, X2 = start.X1, start.X2
        hertz_i = race_contact(
            g, INNER, D, direction_cosine(A1 - X1, A2 - X2), start.hertz_i.log_kappa
        )
        hertz_o = race_contact(g, OUTER, D, direction_cosine(X1, X2), start.hertz_o.log_kappa)
        state = ball_newton(g, D, load, A1, A2, X1, X2, hertz_i, hertz_o)
        if state.status == OK and state.Q_i > 0.0:
            return state
    # Where would the ball lie on the outer race alone? Out of the inner race's reach, it stays.
    sine, cosine = A1 / length, A2 / length
    alpha = math.atan2(A1, A2)
    hertz_i = race_contact(g, INNER, D, cosine, start.hertz_i.log_kappa)
    hertz_o = race_contact(g, OUTER, D, 1.0, start.hertz_o.log_kappa)
    P_x, P_r, T_i = body_forces(g, D, load, free_o, sine, cosine, 0.0, 1.0)
    X2 = free_o
    if P_r > 0.0:
        X2 = free_o + contact_approach(hertz_o.K, P_r)
        if A1 * A1 + (A2 - X2) ** 2 <= free_i * free_i:
            alpha_i = math.atan2(A1, A2 - X2)
            return open_ball(CONTACT_LOST, 0.0, X2, alpha_i, 0.0, P_r, hertz_i, hertz_o)
    elif length <= free_i + free_o:
        share = free_o / (free_i + free_o)
        X1, X2 = share * A1, share * A2
        return open_ball(PRELOAD_GONE, X1, X2, alpha, alpha, 0.0, hertz_i, hertz_o)
    # Two springs in series: exact without centrifugal force, and near it where that is small.
    c_i, c_o = hertz_i.K ** (-2.0 / 3.0), hertz_o.K ** (-2.0 / 3.0)
    series = (length - free_i - free_o) / (c_i + c_o)
    if series > 0.0 and series**1.5 > P_r:
        l_o = free_o + series * c_o
        X1, X2 = l_o * sine, l_o * cosine
        hertz_o = race_contact(g, OUTER, D, cosine, hertz_o.log_kappa)
    else:
        X1 = 0.0
    return ball_newton(g, D, load, A1, A2, X1, X2, hertz_i, hertz_o)


@jit
def groove_distance(g, psi, delta_a, delta_y, delta_z, tilt):
    """Axial and radial distance of the groove centres at azimuth psi (theory.md Eq. 5) [m]."""
    A1 = g.BD * math.sin(g.alpha0) + delta_a + tilt * g.R_i * math.cos(psi)
    A2 = g.BD * math.cos(g.alpha0) + delta_z * math.cos(psi) - delta_y * math.sin(psi)
    return A1, A2


@inlined
def thrust_step(g, D, P, A2, delta_a, state):
    """Newton's step of the race towards the load P [N] of a ball [m]; a guess if it has no load."""
    F = state.F_ix
    if F > 0.0 and state.S_xx > 0.0:
        # The load rises about with the 3/2 power: its power 2/3 is nearly a straight line.
        step = (P ** (2.0 / 3.0) - F ** (2.0 / 3.0)) * 1.5 * F ** (1.0 / 3.0) / state.S_xx
        return min(max(step, -g.BD), g.BD)
    # No load yet: to where the grooves touch the ball, and a typical deformation more.
    free = g.r_i + g.r_o - D
    touch = math.sqrt(max(free * free - A2 * A2, 0.0)) - g.BD * math.sin(g.alpha0)
    return max(touch - delta_a, 0.0) + contact_approach(state.hertz_i.K, P)


@jit
def thrust_equilibrium(g, D, load, F_x, delta_a, constant_force, start):
    """Bearing under thrust alone: one ball stands for all.

    Parameters
    ----------
    F_x : float
        Preload, used if `constant_force` [N].
    delta_a : float
        Axial displacement of the inner race: kept, or the start if `constant_force` [m].

    Returns
    -------
    delta_a : float
        [m]
    state : BallState
    """
    A1, A2 = groove_distance(g, 0.0, delta_a, 0.0, 0.0, 0.0)
    state = ball_equilibrium(g, D, load, A1, A2, start)
    if not constant_force:
        return delta_a, state
    # The inner force rises with the displacement: Newton within a bracket.
    P = F_x / g.n_balls
    low, high = -UNBOUNDED, UNBOUNDED
    for steps in range(MOST_STEPS):
        if state.F_ix < P:
            low = max(low, delta_a)
        else:
            high = min(high, delta_a)
        new = delta_a + thrust_step(g, D, P, A2, delta_a, state)
        # A guess made without a load may lead back to where the load was too large, for ever; and
        # friction that follows the contact angles, which the tangent leaves out, to either side.
        lost = (state.F_ix <= 0.0 and new >= high) or (steps >= PATIENT and steps % 2 == 0)
        if not low <= new <= high or (lost and high - low < UNBOUNDED):
            new = 0.5 * (low + high)
        step = new - delta_a
        delta_a = new
        A1, A2 = groove_distance(g, 0.0, delta_a, 0.0, 0.0, 0.0)
        state = ball_equilibrium(g, D, load, A1, A2, state)
        if state.status == NOT_CONVERGED:
            break
        # Beside a large centrifugal force, a step that is small for the grooves is none for the
        # spring.
        if abs(step) <= LAST_STEP * g.BD and (
            abs(state.F_ix - P) <= FORCE_BALANCED * P or abs(step) <= ROUNDED_STEP * g.BD
        ):
            break
    return delta_a, state


def static_displacement(g, F_x):
    """Axial displacement of the static, unworn bearing under its initial preload alone [m]."""
    load = orbit_load(0.0, 0.0, 0.0)
    return thrust_equilibrium(g, g.D0, load, F_x, 0.0, True, cold_start())[0]
