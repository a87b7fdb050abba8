"""Normal-force equilibrium of the balls and of the inner race (theory.md section 2).

With the Hertz factors held, each contact is a spring that only pulls the groove centres together
(the energy is a convex function of ball centre and race displacement), so the equilibrium is
unique and damped Newton finds it from anywhere. The factors follow the contact angle so weakly
(1e-4 of the stiffness) that they are refreshed in every step and left out of the tangent.
"""

import math

from bearingwear.kernels.compile import jit
from bearingwear.kernels.hertz import INNER, OUTER, race_contact
from bearingwear.kernels.kinematics import INNER_CONTROL, ORBIT, race_control
from bearingwear.kernels.params import BallLoad, BallState, Hertz
from bearingwear.kernels.status import (
    CONTACT_LOST,
    NOT_CONVERGED,
    OK,
    PRELOAD_GONE,
)

PI = math.pi


@jit
def ball_mass(g, D):
    """Mass of a ball [kg]."""
    return g.rho * PI / 6.0 * D**3


@jit
def other_forces(g, D, load, X2, s_i, c_i, s_o, c_o):
    """Forces on a ball beside the normal ones, and the inner race's share of them.

    Centrifugal force of a given orbit (ORBIT), or Jones-Harris: centrifugal force at dm/2 and the
    friction force that carries the gyroscopic moment at the controlling race.

    Returns
    -------
    P_x, P_r, T_i : float
        Axial, radially outward; tangential force of the inner race along the first contact axis
        [N].
    """
    m = ball_mass(g, D)
    if load.law == ORBIT:
        return load.P_x, m * (g.R_o + X2) * load.Omega * load.Omega + load.P_r, 0.0
    alpha_i, alpha_o = math.atan2(s_i, c_i), math.atan2(s_o, c_o)
    k = race_control(load.law, load.omega_i, load.omega_o, D / g.dm, alpha_i, alpha_o)
    F_c = m * 0.5 * g.dm * k.Omega * k.Omega
    M_g = 0.1 * m * D * D * k.w_R * k.Omega * math.sin(k.beta)
    T = 2.0 * M_g / D
    if load.law == INNER_CONTROL:
        return T * c_i, F_c - T * s_i, T
    return -T * c_o, F_c + T * s_o, 0.0


@jit
def moved_forces(g, D, load, A1, A2, X1, X2):
    """`other_forces`, axial and radially outward, with the ball centre at (X1, X2) [N]."""
    l_i = math.sqrt((A1 - X1) ** 2 + (A2 - X2) ** 2)
    l_o = math.sqrt(X1 * X1 + X2 * X2)
    P_x, P_r, _ = other_forces(g, D, load, X2, (A1 - X1) / l_i, (A2 - X2) / l_i, X1 / l_o, X2 / l_o)
    return P_x, P_r


@jit
def spring(K, X1, X2, free):
    """Contact as a spring along (X1, X2): load, direction, tangent stiffness.

    Returns
    -------
    Q, e1, e2, k11, k12, k22 : float
        Load [N], direction cosines, stiffness [N/m].
    """
    length = math.sqrt(X1 * X1 + X2 * X2)
    e1, e2 = X1 / length, X2 / length
    d = length - free
    if d <= 0.0:
        return 0.0, e1, e2, 0.0, 0.0, 0.0
    Q = K * d * math.sqrt(d)
    k, t = 1.5 * Q / d, Q / length
    return Q, e1, e2, k * e1 * e1 + t * e2 * e2, (k - t) * e1 * e2, k * e2 * e2 + t * e1 * e1


@jit
def cold_start():
    """A start for `ball_equilibrium` where no solve nearby is known."""
    unknown = Hertz(0.0, 0.0, 0.0, math.nan, 0.0)
    return BallState(
        NOT_CONVERGED, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, unknown, unknown,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    )  # fmt: skip


@jit
def open_ball(status, X1, X2, alpha_i, alpha_o, P_r, hertz_i, hertz_o):
    """A ball off the inner race: held on the outer race by P_r, or loose."""
    return BallState(
        status, X1, X2, alpha_i, alpha_o, 0.0, P_r, hertz_i, hertz_o,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, P_r, 0.0,
    )  # fmt: skip


@jit
def settle_ball(g, D, load, A1, A2, X1, X2, hertz_i, hertz_o):
    """Damped Newton for the centre of a ball from (X1, X2).

    Across the line of the grooves a lightly loaded ball hangs like a bead on a slack string: the
    tangent promises steps that would stretch the string far beyond its deformation. Steps are
    therefore kept short against that, and halved where the energy, convex along the step, has
    turned upwards.
    """
    free_i, free_o = g.r_i - 0.5 * D, g.r_o - 0.5 * D
    # The force balance hangs on differences of lengths, so rounding sets its floor: Newton is done
    # when the last step was so short that the next would be below rounding.
    small = 1e-11 * math.sqrt(A1 * A1 + A2 * A2)
    h = 1e-7 * free_o  # for the tangent of race control's friction force
    status = NOT_CONVERGED
    slope = 0.0  # of the energy along the last full step, negative [N m]
    step1 = step2 = size = 0.0
    shortened = True
    i11 = i12 = i22 = o11 = o12 = o22 = 1.0
    Q_i = Q_o = s_i = c_i = s_o = c_o = P_x = P_r = T_i = 0.0
    for _ in range(200):
        Q_o, s_o, c_o, o11, o12, o22 = spring(hertz_o.K, X1, X2, free_o)
        Q_i, s_i, c_i, i11, i12, i22 = spring(hertz_i.K, A1 - X1, A2 - X2, free_i)
        P_x, P_r, T_i = other_forces(g, D, load, X2, s_i, c_i, s_o, c_o)
        r1 = Q_i * s_i - Q_o * s_o + P_x
        r2 = Q_i * c_i - Q_o * c_o + P_r
        size = math.sqrt(r1 * r1 + r2 * r2)
        if not shortened and abs(step1) + abs(step2) <= small:
            status = OK
            break
        k11, k12, k22 = i11 + o11, i12 + o12, i22 + o22
        k21 = k12
        if load.law != ORBIT:
            p1, p2 = moved_forces(g, D, load, A1, A2, X1 + h, X2)
            q1, q2 = moved_forces(g, D, load, A1, A2, X1, X2 + h)
            k11, k21 = k11 - (p1 - P_x) / h, k21 - (p2 - P_r) / h
            k12, k22 = k12 - (q1 - P_x) / h, k22 - (q2 - P_r) / h
        det = k11 * k22 - k12 * k21
        if not det > 0.0 or r1 * step1 + r2 * step2 < 0.5 * slope:
            if slope == 0.0:
                break
            step1, step2, slope = 0.5 * step1, 0.5 * step2, 0.5 * slope
            X1, X2 = X1 - step1, X2 - step2
            shortened = True
            continue
        step1 = (k22 * r1 - k12 * r2) / det
        step2 = (k11 * r2 - k21 * r1) / det
        d_P = (abs(P_r) / hertz_o.K) ** (2.0 / 3.0)
        d = (Q_i / hertz_i.K) ** (2.0 / 3.0) + (Q_o / hertz_o.K) ** (2.0 / 3.0) + d_P
        longest = 2.0 * math.sqrt(d * min(free_i, free_o))
        length = math.sqrt(step1 * step1 + step2 * step2)
        shortened = length > longest
        if shortened:
            step1, step2 = step1 * longest / length, step2 * longest / length
        slope = -(r1 * step1 + r2 * step2)
        X1, X2 = X1 + step1, X2 + step2
        hertz_o = race_contact(g, OUTER, D, direction_cosine(X1, X2), hertz_o.log_kappa)
        hertz_i = race_contact(g, INNER, D, direction_cosine(A1 - X1, A2 - X2), hertz_i.log_kappa)
    # Stiffness of the inner force with the ball centre free: S = k_i - k_i (k_i + k_o)^-1 k_i,
    # which for one spring k_i behind another k_o is k_o (k_i + k_o)^-1 k_i.
    k11, k12, k22 = i11 + o11, i12 + o12, i22 + o22
    det = k11 * k22 - k12 * k12
    u1 = u2 = v1 = v2 = 0.0  # of a ball that touches nothing
    if det > 0.0:
        u1, u2 = (k22 * i11 - k12 * i12) / det, (k11 * i12 - k12 * i11) / det
        v1, v2 = (k22 * i12 - k12 * i22) / det, (k11 * i22 - k12 * i12) / det
    return BallState(
        status, X1, X2, math.atan2(s_i, c_i), math.atan2(s_o, c_o), Q_i, Q_o, hertz_i, hertz_o,
        Q_i * s_i + T_i * c_i, Q_i * c_i - T_i * s_i,
        o11 * u1 + o12 * u2, o11 * v1 + o12 * v2, o12 * v1 + o22 * v2,
        P_x, P_r, size,
    )  # fmt: skip


@jit
def direction_cosine(X1, X2):
    return X2 / math.sqrt(X1 * X1 + X2 * X2)


@jit
def ball_equilibrium(g, D, load, A1, A2, start):
    """Ball centre between two given groove centres.

    Parameters
    ----------
    g : Geometry
    D : float
        Worn ball diameter [m].
    load : BallLoad
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
        state = settle_ball(g, D, load, A1, A2, X1, X2, hertz_i, hertz_o)
        if state.status == OK and state.Q_i > 0.0:
            return state
    # Where would the ball lie on the outer race alone? Out of the inner race's reach, it stays.
    sine, cosine = A1 / length, A2 / length
    alpha = math.atan2(A1, A2)
    hertz_i = race_contact(g, INNER, D, cosine, start.hertz_i.log_kappa)
    hertz_o = race_contact(g, OUTER, D, 1.0, start.hertz_o.log_kappa)
    P_x, P_r, T_i = other_forces(g, D, load, free_o, sine, cosine, 0.0, 1.0)
    X2 = free_o
    if P_r > 0.0:
        X2 = free_o + (P_r / hertz_o.K) ** (2.0 / 3.0)
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
    return settle_ball(g, D, load, A1, A2, X1, X2, hertz_i, hertz_o)


@jit
def groove_distance(g, psi, delta_a, delta_y, delta_z, tilt):
    """Axial and radial distance of the groove centres at azimuth psi (theory.md Eq. 5) [m]."""
    A1 = g.BD * math.sin(g.alpha0) + delta_a + tilt * g.R_i * math.cos(psi)
    A2 = g.BD * math.cos(g.alpha0) + delta_z * math.cos(psi) - delta_y * math.sin(psi)
    return A1, A2


@jit
def thrust_equilibrium(g, D, load, F_x, delta_a, constant_force, start):
    """Bearing under thrust alone: one ball stands for all.

    Parameters
    ----------
    F_x : float
        Preload, used if `constant_force` [N].
    delta_a : float
        Axial displacement of the inner race: kept, or the start if `constant_force` [m].
    constant_force : bool

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
    low, high = -1e300, 1e300
    for _ in range(200):
        F = state.F_ix
        if F > 0.0 and state.S_xx > 0.0:
            # The load rises about with the 3/2 power: its power 2/3 is nearly a straight line.
            step = (P ** (2.0 / 3.0) - F ** (2.0 / 3.0)) * 1.5 * F ** (1.0 / 3.0) / state.S_xx
            step = min(max(step, -g.BD), g.BD)
        else:
            # No load yet: to where the grooves touch the ball, and a typical deformation more.
            free = g.r_i + g.r_o - D
            touch = math.sqrt(max(free * free - A2 * A2, 0.0)) - g.BD * math.sin(g.alpha0)
            step = max(touch - delta_a, 0.0) + (P / state.hertz_i.K) ** (2.0 / 3.0)
        if F < P:
            low = max(low, delta_a)
        else:
            high = min(high, delta_a)
        new = delta_a + step
        if not low <= new <= high:
            new = 0.5 * (low + high)
        step = new - delta_a
        delta_a = new
        A1, A2 = groove_distance(g, 0.0, delta_a, 0.0, 0.0, 0.0)
        state = ball_equilibrium(g, D, load, A1, A2, state)
        if state.status == NOT_CONVERGED:
            break
        # Beside a large centrifugal force, a step that is small for the grooves is none for the
        # spring.
        if abs(step) <= 1e-11 * g.BD and (
            abs(state.F_ix - P) <= 1e-12 * P or abs(step) <= 1e-16 * g.BD
        ):
            break
    return delta_a, state


@jit
def static_displacement(g, F_x):
    """Axial displacement of the static, unworn bearing under its initial preload alone [m]."""
    load = BallLoad(ORBIT, 0.0, 0.0, 0.0, 0.0, 0.0)
    delta_a, state = thrust_equilibrium(g, g.D0, load, F_x, 0.0, True, cold_start())
    return delta_a
