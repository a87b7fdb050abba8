"""Right-hand side of the motion of balls, inner race and cage (theory.md section 8)."""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.cage import (
    CAGE,
    INNER_LAND,
    LAND_DAMPING,
    LAND_HEAT,
    LAND_TORQUE,
    LAND_WORK,
    POCKET_DAMPING,
    POCKET_HEAT,
    POCKET_TORQUE,
    Cage,
    CageBuffers,
    cage_buffers,
    cage_contacts,
    cage_motion,
)
from bearingwear.kernels.compile import REORDER_SUMS, jit
from bearingwear.kernels.contact import slip_map, traction_slope
from bearingwear.kernels.ellipse import Rule, most_points, place
from bearingwear.kernels.linear import solve_in_place
from bearingwear.kernels.params import Contact, Geometry, Motion
from bearingwear.kernels.quasistatic import Suspension, move, settle, suspension, sweep
from bearingwear.kernels.status import BEYOND_GROOVE, NOT_CONVERGED, OK, OUTSIDE_HERTZ_RANGE
from bearingwear.kernels.steady import LARGEST_AXIS, drag_force

MOST_TRIALS = 200  # of an equilibrium with a cage, which usually takes three
BALL = 5  # states of a ball: w_x, w_y, w_z, Omega, psi


class Run(NamedTuple):
    """What stays the same during a run."""

    g: Geometry
    motion: Motion
    D: np.ndarray  # (n,) worn ball diameters [m]
    mass: np.ndarray  # (n,) [kg]
    inertia: np.ndarray  # (n,) [kg m2]
    hertz: np.ndarray  # (n, 2, intervals, 8) see quasistatic.hertz_at
    first: int  # first free translation of the race
    F_x: float  # preload [N]
    F_y: float  # load fixed in space [N]
    F_z: float
    F_rot: float  # load that turns with the shaft, along +Z at t = 0 [N]
    tilt: float  # [rad]
    cage: Cage
    rule: Rule  # for the contact ellipses


@jit
def load_at(run, time, F):
    """Load (axial, Y, Z) on the inner race at an instant, into F."""
    theta = run.motion.omega_i * time
    F[0] = run.F_x
    F[1] = run.F_y - run.F_rot * math.sin(theta)
    F[2] = run.F_z + run.F_rot * math.cos(theta)


@jit(fastmath=REORDER_SUMS)
def friction_sums(contact, R, c, mu, v_r, t, weight):
    """Gradient of the friction potential by c, and QV, in one pass.

    Returns
    -------
    g_1, g_0, g_h, g_x, qv
        As in contact.traction; qv in W.
    """
    c_1, c_0, c_h, c_x = c
    a, v_r2 = contact.a, v_r * v_r
    R_d = 2.0 * contact.r_g * R / (contact.r_g + R)
    base = math.sqrt(R * R - a * a) - math.sqrt(R_d * R_d - a * a)
    R_d2 = R_d * R_d
    g_1 = g_0 = g_h = g_x = qv = 0.0
    for k in range(t.size):
        x = a * t[k]
        h = math.sqrt(R_d2 - x * x) + base
        v1 = c_1 * h
        v2 = c_0 + c_h * h + c_x * x
        v_2 = v1 * v1 + v2 * v2
        f = weight[k] / math.sqrt(v_2 + v_r2)
        qv += weight[k] * math.sqrt(v_2)
        g_1 += f * v1 * h
        f2 = f * v2
        g_0 += f2
        g_h += f2 * h
        g_x += f2 * x
    s = mu * contact.Q
    return s * g_1, s * g_0, s * g_h, s * g_x, contact.Q * qv


class Account(NamedTuple):
    """Places in the state vector: the balls' states, the cage's, then the time integrals."""

    cage: int  # states of the cage, if there is one
    qv: int  # 2 n: of each ball, inner and outer [J]
    pockets: int  # n: normal force times slip in each pocket [J]
    land: int  # normal force times slip at the land, both edges [J]
    shaft: int  # work of both races on balls and cage [J]
    heat: int  # friction heat of the ball/race contacts [J]
    drag: int  # work of the drag [J]
    turning: int  # sum of m r^2 2 Omega dOmega/dt, for the Coriolis term [J]
    azimuth: int  # sum of Omega dU/dpsi: the circumferential force left out [J]
    load: int  # delta . dF/dt of the loads that change [J]
    hertz: int  # elastic energy from Hertz factors that change with the contact angle [J]
    cage_heat: int  # friction heat of pockets and land [J]
    damping: int  # of pockets and land [J]
    pocket_torque: int  # angular impulse of the pockets on the cage [N m s]
    land_torque: int  # and of the land
    size: int


@jit
def account(n, with_cage):
    """Places for n balls."""
    cage = BALL * n
    qv = cage + (CAGE if with_cage else 0)
    pockets = qv + 2 * n
    i = pockets + n
    return Account(
        cage, qv, pockets, i, i + 1, i + 2, i + 3, i + 4, i + 5, i + 6, i + 7, i + 8, i + 9,
        i + 10, i + 11, i + 12,
    )  # fmt: skip


class Buffers(NamedTuple):
    """Work space of the right-hand side and its Jacobian."""

    s: Suspension
    F: np.ndarray  # (3,)
    extra: np.ndarray  # (n, 8) the cage's forces on each ball, see quasistatic.settle
    land: np.ndarray  # (8,) and those of an inner land on the race
    r: np.ndarray  # (n,) orbit radii [m]
    axial: np.ndarray  # (n,) and axial places of the balls [m]
    f: np.ndarray  # (6,) force and moment on the cage
    rest: np.ndarray  # (3,) displacement of the race at rest, a safe start [m]
    cage: CageBuffers
    c: np.ndarray  # (n, 2, 4) slip coefficients
    t: np.ndarray  # (points,) of the contact at hand, if they depend on it
    weight: np.ndarray  # (points,)
    h: np.ndarray  # (points,)
    L: np.ndarray  # (4, 4)
    gradient: np.ndarray  # (4,)
    hessian: np.ndarray  # (4, 4)
    blocks: np.ndarray  # (n, 4, 4) Jacobian of a ball's (w, Omega) with the loads held [1/s]
    slopes: np.ndarray  # (n, 3, 4) derivative of shaft power, heat and turning by (w, Omega)


@jit
def race_contact_of(run, s, j, k):
    """Contact of ball j with race k (0 inner, 1 outer)."""
    g, m = run.g, run.motion
    Q = s.Q[j, k]
    a = s.factors[j, k, 1] * Q ** (1.0 / 3.0)
    d = s.direction[j]
    if k == 0:
        return Contact(-1.0, Q, a, d[0], d[1], g.r_i, m.omega_i)
    return Contact(1.0, Q, a, d[2], d[3], g.r_o, m.omega_o)


@jit
def slip_of(contact, w_x, w_y, w_z, Omega, r):
    """Slip coefficients (c_1, c_0, c_h, c_x) of a contact, as contact.slip_coefficients."""
    w_rel = w_x - contact.omega
    return (
        -contact.sigma * w_y,
        (Omega - contact.omega) * r,
        contact.sigma * (w_rel * contact.cos_a - w_z * contact.sin_a),
        -(w_rel * contact.sin_a + w_z * contact.cos_a),
    )


@jit
def contacts_at(y, run, b, places):
    """Cage contacts where the balls and the race are now."""
    g, s, m = run.g, b.s, run.motion
    for j in range(run.D.size):
        b.axial[j] = s.X[j, 0]
        b.r[j] = g.R_o + s.X[j, 1]
    z = y[places.cage : places.cage + CAGE]
    f = cage_contacts(
        run.cage, z, y, BALL, g.D0, run.D, run.mass, b.r, b.axial, s.delta, m.omega_i, m.omega_o,
        b.cage,
    )  # fmt: skip
    for k in range(6):
        b.f[k] = f[k]


@jit
def lines_here(psi, run, b):
    """Straight lines of the cage's forces on balls and inner race, about their present places."""
    s, n = b.s, run.D.size
    force = b.cage.race_force
    if run.cage.land == INNER_LAND:
        x = b.land
        x[0], x[1], x[2], x[3] = force[0], force[1], s.delta[1], s.delta[2]
        x[4:] = 0.0
        for k in range(n, n + 2):
            if b.cage.normal[k] > 0.0:
                for i in range(2):
                    x[4 + i] += b.cage.K[k, 1, 1 + i]
                    x[6 + i] += b.cage.K[k, 2, 1 + i]
    for j in range(n):
        x, K = b.extra[j], b.cage.K[j]
        x[0], x[1] = b.cage.ball_force[j, 0], b.cage.ball_force[j, 2]
        x[2], x[3] = s.X[j, 0], s.X[j, 1]
        if b.cage.normal[j] > 0.0:
            sp, cp = math.sin(psi[j]), math.cos(psi[j])
            x[4] = K[0, 0]
            x[5] = K[0, 2] * cp - K[0, 1] * sp
            x[6] = K[2, 0] * cp - K[1, 0] * sp
            x[7] = K[1, 1] * sp * sp - (K[1, 2] + K[2, 1]) * sp * cp + K[2, 2] * cp * cp
        else:
            x[4] = x[5] = x[6] = x[7] = 0.0


@jit
def unbalanced(Omega, psi, run, b):
    """Force on balls and race that nothing balances, and the largest load that bears on it.

    For contacts found by `sweep` and forces of the cage by `lines_here` at the same places.

    Returns
    -------
    left, load : float
        Root of the sum of squares [N], largest load of a ball on its outer race [N].
    """
    s = b.s
    f0, f1, f2 = b.F[0], b.F[1] + b.land[0], b.F[2] + b.land[1]
    total = load = 0.0
    for j in range(psi.size):
        d, x = s.direction[j], b.extra[j]
        axial, radial = s.Q[j, 0] * d[0], s.Q[j, 0] * d[1]
        total += (axial - s.Q[j, 1] * d[2] + x[0]) ** 2
        centrifugal = run.mass[j] * (run.g.R_o + s.X[j, 1]) * Omega[j] ** 2
        total += (radial - s.Q[j, 1] * d[3] + x[1] + centrifugal) ** 2
        load = max(load, s.Q[j, 1])
        f0 -= axial
        f1 += radial * math.sin(psi[j])
        f2 -= radial * math.cos(psi[j])
    if run.first == 0:
        total += f0 * f0
    return math.sqrt(total + f1 * f1 + f2 * f2), load


@jit
def free_equilibrium(time, y, run, b):
    """Ball centres and race from the last answer on, forces of the cage as the lines say."""
    load_at(run, time, b.F)
    n = run.D.size
    status = settle(
        run.g, run.D, run.mass, run.hertz, y[3 : BALL * n : BALL], y[4 : BALL * n : BALL],
        b.extra, b.land, b.F, run.tilt, run.first, b.s,
    )  # fmt: skip
    if status == OK:
        for j in range(n):
            b.r[j] = run.g.R_o + b.s.X[j, 1]
    return status


@jit
def joint_equilibrium(time, y, run, b, places):
    """Ball centres, race and cage contacts that agree with each other, from the last answer on.

    Newton for all at once; a step is shortened until it leaves less force unbalanced, for the
    edges of the contact law where pockets open and close.
    """
    g, s, n = run.g, b.s, run.D.size
    Omega, psi = y[3 : BALL * n : BALL], y[4 : BALL * n : BALL]
    free = 3 - run.first
    matrix, step = np.empty((3, 3)), np.empty(3)
    X, delta = s.X.copy(), s.delta.copy()
    dX, d_delta = np.zeros((n, 2)), np.zeros(3)
    size, largest, share, done = math.inf, 0.0, 1.0, False
    load_at(run, time, b.F)
    for _ in range(MOST_TRIALS):
        contacts_at(y, run, b, places)
        lines_here(psi, run, b)
        regular = sweep(
            g, run.D, run.mass, run.hertz, Omega, psi, b.extra, b.land, b.F, run.tilt, run.first,
            s, matrix, step,
        )  # fmt: skip
        if done:
            return OK
        left, load = unbalanced(Omega, psi, run, b)
        if left < size:
            if not (regular and solve_in_place(matrix, step, free)):
                return NOT_CONVERGED
            size = left
            X[:, :], delta[:] = s.X, s.delta
            largest = move(psi, run.first, step, s)
            dX[:, :] = s.X - X
            d_delta[:] = s.delta - delta
            share = min(1.0, 0.3 * g.BD / largest) if largest > 0.0 else 1.0
            done = largest <= 1e-10 * g.BD
        else:
            share *= 0.5
            if share * largest <= 1e-15 * g.BD:
                # Rounding allows no more, or there is no way down.
                if size > 1e-7 * load:
                    return NOT_CONVERGED
                share, done = 0.0, True
        s.X[:, :] = X + share * dX
        s.delta[:] = delta + share * d_delta
    return NOT_CONVERGED


@jit
def keep_places(b, kept):
    """Copy where balls, race and cage contacts were found into `kept` (10 n + 11,)."""
    s, n = b.s, b.r.size
    for j in range(n):
        kept[10 * j : 10 * j + 2] = s.X[j]
        kept[10 * j + 2 : 10 * j + 10] = b.extra[j]
    kept[10 * n : 10 * n + 3] = s.delta
    kept[10 * n + 3 :] = b.land


@jit
def restore_places(b, kept):
    """The opposite of `keep_places`: the next equilibrium starts there."""
    s, n = b.s, b.r.size
    for j in range(n):
        s.X[j] = kept[10 * j : 10 * j + 2]
        b.extra[j] = kept[10 * j + 2 : 10 * j + 10]
    s.delta[:] = kept[10 * n : 10 * n + 3]
    b.land[:] = kept[10 * n + 3 :]
    s.factors[:, :, 2] = 0.0  # known


@jit
def equilibrium(time, y, run, b, places):
    """Places of balls, race and cage contacts, from the last answer on.

    From nothing, and at first without the cage, where that fails.
    """
    if not run.cage.present:
        status = free_equilibrium(time, y, run, b)
    elif math.isnan(b.s.factors[0, 0, 2]):
        status = NOT_CONVERGED  # there is no last answer
    else:
        status = joint_equilibrium(time, y, run, b, places)
    if status != OK:
        b.extra[:, :] = 0.0
        b.land[:] = 0.0
        b.s.factors[:, :, :] = math.nan
        b.s.delta[:] = b.rest
        status = free_equilibrium(time, y, run, b)
        if status == OK and run.cage.present:
            status = joint_equilibrium(time, y, run, b, places)
    return status


@jit
def motion_rates(time, y, run, b, dy, places):
    """Time derivative of the states of balls and cage and of the integrals.

    Parameters
    ----------
    time : float
        [s]
    y : ndarray
        State: BALL numbers a ball, CAGE numbers of the cage, the integrals at `places`.
    b : Buffers
    dy : ndarray
        Filled.

    Returns
    -------
    int
        Status of the equilibrium.
    """
    g, m, s, rule = run.g, run.motion, b.s, run.rule
    n = run.D.size
    psi = y[4 : BALL * n : BALL]
    status = equilibrium(time, y, run, b, places)
    if status != OK:
        return status
    p = places
    shaft = heat = drag = turning = azimuth = 0.0
    for j in range(n):
        i = BALL * j
        R = 0.5 * run.D[j]
        r = b.r[j]
        w_x, w_y, w_z, W = y[i], y[i + 1], y[i + 2], y[i + 3]
        M_x, M_y, M_z = b.cage.ball_moment[j, 0], b.cage.ball_moment[j, 1], b.cage.ball_moment[j, 2]
        F_y = b.cage.ball_force[j, 1]
        for k in range(2):
            contact = race_contact_of(run, s, j, k)
            dy[p.qv + 2 * j + k] = 0.0
            if not contact.Q > 0.0:
                continue
            if contact.a >= LARGEST_AXIS * R:
                return OUTSIDE_HERTZ_RANGE
            if contact.cos_a < 0.0:
                return BEYOND_GROOVE
            c = slip_of(contact, w_x, w_y, w_z, W, r)
            if rule.split:
                t, weight = place(rule, contact, R, c, m.v_r, b.t, b.weight)
                g_1, g_0, g_h, g_x, qv = friction_sums(contact, R, c, m.mu, m.v_r, t, weight)
            else:  # not by `place`: counting references to the arrays takes 2 % of a run
                g_1, g_0, g_h, g_x, qv = friction_sums(
                    contact, R, c, m.mu, m.v_r, rule.t, rule.weight
                )
            sigma, sine, cosine = contact.sigma, contact.sin_a, contact.cos_a
            M_x -= sigma * cosine * g_h - sine * g_x
            M_y += sigma * g_1
            M_z += sigma * sine * g_h + cosine * g_x
            F_y += g_0
            dy[p.qv + 2 * j + k] = qv
            heat += c[0] * g_1 + c[1] * g_0 + c[2] * g_h + c[3] * g_x
            shaft -= contact.omega * (r * g_0 + sigma * cosine * g_h - sine * g_x)
        F_v, _ = drag_force(g, run.D[j], m.drag, W)
        inertia = run.inertia[j]
        dy[i] = M_x / inertia
        dy[i + 1] = M_y / inertia + W * w_z
        dy[i + 2] = M_z / inertia - W * w_y
        dy[i + 3] = -(F_y + F_v) / (run.mass[j] * r)
        dy[i + 4] = W
        drag += F_v * r * W
        turning += 2.0 * run.mass[j] * r * r * W * dy[i + 3]
        # dU/dpsi at a fixed race: the inner force times the shift of the groove centres.
        sp, cp = math.sin(psi[j]), math.cos(psi[j])
        f_x, f_r = s.Q[j, 0] * s.direction[j, 0], s.Q[j, 0] * s.direction[j, 1]
        dA1 = -run.tilt * g.R_i * sp
        dA2 = -s.delta[2] * sp - s.delta[1] * cp
        azimuth += W * (f_x * dA1 + f_r * dA2)
    sums = b.cage.sums
    for j in range(n):
        dy[p.pockets + j] = b.cage.power[j]
    dy[p.land] = b.cage.power[n] + b.cage.power[n + 1]
    dy[p.cage_heat] = sums[POCKET_HEAT] + sums[LAND_HEAT]
    dy[p.damping] = sums[POCKET_DAMPING] + sums[LAND_DAMPING]
    dy[p.pocket_torque] = sums[POCKET_TORQUE]
    dy[p.land_torque] = sums[LAND_TORQUE]
    if run.cage.present:
        z = y[p.cage : p.cage + CAGE]
        cage_motion(run.cage, z, b.f, b.cage.R, dy[p.cage : p.cage + CAGE])
    dy[p.shaft] = shaft + sums[LAND_WORK]
    dy[p.heat] = heat
    dy[p.drag] = drag
    dy[p.turning] = turning
    dy[p.azimuth] = azimuth
    dy[p.hertz] = 0.0  # see integrators.stiffened
    theta, rate = m.omega_i * time, m.omega_i * run.F_rot
    dy[p.load] = -rate * (s.delta[1] * math.cos(theta) + s.delta[2] * math.sin(theta))
    return OK


@jit
def ball_blocks(y, run, b):
    """Fill `b.blocks`: derivative of each ball's (w, Omega) rates by (w, Omega), loads held.

    And `b.slopes`, that of the powers which the integrals sum: a stage of a stiff step lies off the
    path, where friction is far from its value on it, and their sum would feel that. For the state
    of the last call of `motion_rates`.
    """
    g, m, s = run.g, run.motion, b.s
    for j in range(run.D.size):
        i = BALL * j
        R = 0.5 * run.D[j]
        r = g.R_o + s.X[j, 1]
        w_x, w_y, w_z, W = y[i], y[i + 1], y[i + 2], y[i + 3]
        J, S = b.blocks[j], b.slopes[j]
        J[:, :] = 0.0
        S[:, :] = 0.0
        F_y = 0.0
        for k in range(2):
            contact = race_contact_of(run, s, j, k)
            if not contact.Q > 0.0:
                continue
            a = contact.a
            R_d = 2.0 * contact.r_g * R / (contact.r_g + R)
            base = math.sqrt(R * R - a * a) - math.sqrt(R_d * R_d - a * a)
            c = slip_of(contact, w_x, w_y, w_z, W, r)
            t, weight = place(run.rule, contact, R, c, m.v_r, b.t, b.weight)
            for q in range(t.size):
                x = a * t[q]
                b.h[q] = math.sqrt(R_d * R_d - x * x) + base
            traction_slope(contact, c, m.mu, m.v_r, t, weight, b.h, b.gradient, b.hessian)
            slip_map(contact, r, b.L)
            L, H, G = b.L, b.hessian, b.gradient
            F_y += G[1]
            reach, lever = contact.sigma * contact.cos_a, -contact.sin_a
            for q in range(4):
                torque = -contact.omega * (r * H[1, q] + reach * H[2, q] + lever * H[3, q])
                heat = G[q] + c[0] * H[0, q] + c[1] * H[1, q] + c[2] * H[2, q] + c[3] * H[3, q]
                for v in range(4):
                    if L[q, v] != 0.0:
                        S[0, v] += torque * L[q, v]
                        S[1, v] += heat * L[q, v]
                        for p in range(4):
                            for u in range(4):
                                J[u, v] -= L[p, u] * H[p, q] * L[q, v]
        inertia = run.inertia[j]
        orbit = run.mass[j] * r * r
        F_v, dF_v = drag_force(g, run.D[j], m.drag, W)
        for v in range(4):
            for u in range(3):
                J[u, v] /= inertia
            J[3, v] /= orbit
            S[2, v] = 2.0 * orbit * W * J[3, v]
        S[2, 3] -= 2.0 * r * (F_y + F_v) + 2.0 * r * W * dF_v
        J[1, 2] += W
        J[1, 3] += w_z
        J[2, 1] -= W
        J[2, 3] -= w_y
        J[3, 3] -= dF_v / (run.mass[j] * r)


@jit
def buffers(n, rule):
    """Work space for n balls and a rule."""
    points = most_points(rule)
    return Buffers(
        suspension(n), np.empty(3), np.zeros((n, 8)), np.zeros(8), np.zeros(n), np.zeros(n),
        np.zeros(6), np.zeros(3), cage_buffers(n), np.empty((n, 2, 4)), np.empty(points),
        np.empty(points), np.empty(points), np.empty((4, 4)), np.empty(4), np.empty((4, 4)),
        np.empty((n, 4, 4)), np.empty((n, 3, 4)),
    )  # fmt: skip
