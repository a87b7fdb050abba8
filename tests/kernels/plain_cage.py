"""A cage's contacts and the places of balls and race, written out again in NumPy."""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.contact.hertz import INNER, OUTER, race_contact


class Laws(NamedTuple):
    """The laws in which the present model and that of the stored states differ."""

    damping_rubs: bool  # whether friction and wear of a pocket include the force of its damping
    race_stands: bool  # whether an inner land has no speed but its rotation


TODAY, STORED = Laws(True, True), Laws(False, False)


class Contacts(NamedTuple):
    """Forces [N], moments [N m] and powers [W] of all contacts of a cage."""

    force: np.ndarray  # (3,) on the cage
    moment: np.ndarray  # (3,) about its centre of mass
    on_balls: np.ndarray  # (n, 3) inertial
    turning_balls: np.ndarray  # (n, 3) moment about their centres, in their azimuth axes
    on_race: np.ndarray  # (3,)
    pocket_power: np.ndarray  # (n,) normal force times slip
    land_power: float
    heat: np.ndarray  # (2,) friction heat of pockets and land
    damping: float
    torque: np.ndarray  # (2,) on the cage about the bearing's axis, of pockets and land


def rotation(q):
    """Returns the rotation matrix of a unit quaternion (w, x, y, z)."""
    w, x, y, z = q
    u = np.array([x, y, z])
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return (w * w - u @ u) * np.eye(3) + 2.0 * np.outer(u, u) + 2.0 * w * K


def cage_contacts(bearing, balls, cage, R, X, delta, laws):
    """Returns the contacts of the cage in the orientation R.

    balls: angular velocity (x, y, z), orbit rate and azimuth of each ball (n, 5). cage: centre,
    velocity and angular momentum (9,). X: axial and radial places of the balls (n, 2). delta:
    displacement of the inner race (3,). laws: `TODAY` or `STORED`.
    """
    c, g = bearing.cage, bearing.g
    centre, v, L = cage[:3], cage[3:6], cage[6:]
    w = R @ np.diag([1.0 / c.I_x, 1.0 / c.I_t, 1.0 / c.I_t]) @ R.T @ L
    middle = centre - c.imbalance * R[:, 2]
    n = len(bearing.D)
    force, moment = np.zeros(3), np.zeros(3)
    on_balls, turning_balls, on_race = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(3)
    power = np.zeros(n)
    heat, torque, damping, land_power = np.zeros(2), np.zeros(2), 0.0, 0.0

    def rub(N, slip):
        return c.mu * N * slip / math.sqrt(slip @ slip + c.v_r**2)

    for j, (w_x, w_y, w_z, Omega, psi) in enumerate(balls):
        y_axis = np.array([0.0, math.cos(psi), math.sin(psi)])
        z_axis = np.array([0.0, -math.sin(psi), math.cos(psi)])
        r = g.R_o + X[j, 1]
        ball = np.array([X[j, 0], 0.0, 0.0]) + r * z_axis
        phi = 2.0 * math.pi * j / n
        axis = R @ np.array([0.0, -math.sin(phi), math.cos(phi)])
        e = ball - middle
        e = e - (e @ axis) * axis
        offset = np.linalg.norm(e)
        d = offset - c.clearance - 0.5 * (g.D0 - bearing.D[j])
        if d <= 0.0:
            continue
        normal = e / offset
        reach = 0.5 * bearing.D[j] * normal
        arm = ball - centre
        w_ball = w_x * np.array([1.0, 0.0, 0.0]) + w_y * y_axis + w_z * z_axis
        apart = v + np.cross(w, arm + reach) + r * Omega * y_axis - np.cross(w_ball, reach)
        slip = apart - (apart @ normal) * normal
        along = (v + np.cross(w, arm)) @ y_axis + r * Omega
        n_y = normal @ y_axis
        m = 1.0 / (1.0 / bearing.mass[j] + 1.0 / c.mass)
        F = c.K_pocket * d**1.5
        drag = c.damping_pocket * math.sqrt(m * c.K_pocket) * d**0.25 * d / (d + c.ramp_pocket)
        drag *= n_y**2 * along
        if drag * n_y > F * n_y**2:
            drag = F * n_y
        N = F - drag * n_y if laws.damping_rubs else F
        friction = rub(N, slip)
        at_contact, at_centre = friction - F * normal, drag * y_axis
        on_balls[j] = at_contact + at_centre
        turn = np.cross(reach, friction)
        turning_balls[j] = turn[0], turn @ y_axis, turn @ z_axis
        force -= on_balls[j]
        moment -= np.cross(arm + reach, at_contact) + np.cross(arm, at_centre)
        whole = np.cross(ball + reach, at_contact) + np.cross(ball, at_centre)
        torque[0] -= whole[0]
        power[j] = N * np.linalg.norm(slip)
        heat[0] += friction @ slip
        damping += drag * along
    for x in (-c.half_width, c.half_width) if c.land else ():
        inner = c.land == 2
        race = np.array([0.0, delta[1], delta[2]]) if inner else np.zeros(3)
        omega = np.array([bearing.op.omega_i if inner else bearing.op.omega_o, 0.0, 0.0])
        edge = middle + x * R[:, 0]
        e = np.array([0.0, *(edge - race)[1:]])
        offset = np.linalg.norm(e)
        d = offset - c.gap
        if d <= 0.0:
            continue
        normal = e / offset
        point = edge + (-c.radius if inner else c.radius) * normal
        about = race if laws.race_stands else np.zeros(3)
        apart = np.cross(omega, point - about) - v - np.cross(w, point - centre)
        closing = -apart @ normal
        slip = apart + closing * normal
        c_n = 2.0 * c.damping_land * math.sqrt(c.k_land * c.mass) * d / (d + c.ramp_land)
        F = max(c.k_land * d + c_n * closing, 0.0)
        friction = rub(F, slip)
        on_cage = friction - F * normal
        on_race -= [0.0, *on_cage[1:]] if inner else 0.0
        force += on_cage
        moment += np.cross(point - centre, on_cage)
        torque[1] += np.cross(point, on_cage)[0]
        land_power += F * np.linalg.norm(slip)
        heat[1] += friction @ slip
        damping += (F - c.k_land * d) * closing
    return Contacts(
        force=force,
        moment=moment,
        on_balls=on_balls,
        turning_balls=turning_balls,
        on_race=on_race,
        pocket_power=power,
        land_power=land_power,
        heat=heat,
        damping=damping,
        torque=torque,
    )


def unbalanced(bearing, balls, F, X, delta, contacts):
    """Returns the force (2 n + 3,) on ball centres (axial, radial) and on the inner race [N].

    F: load on the inner race (3,) [N]. The others: `cage_contacts`, which returns `contacts`.
    """
    g, ball_forces, race = bearing.g, [], F + contacts.on_race
    for j, (_, _, _, Omega, psi) in enumerate(balls):
        s, c, D = math.sin(psi), math.cos(psi), bearing.D[j]
        A = np.array(
            [
                g.BD * math.sin(g.alpha0) + delta[0] + bearing.tilt * g.R_i * c,
                g.BD * math.cos(g.alpha0) + delta[2] * c - delta[1] * s,
            ]
        )
        pushed = []
        for race_code, to, r in ((INNER, A - X[j], g.r_i), (OUTER, -X[j], g.r_o)):
            length = np.linalg.norm(to)
            d = max(length - (r - 0.5 * D), 0.0)
            K = race_contact(g, race_code, D, abs(to[1]) / length, math.nan).K
            pushed.append(K * d**1.5 * to / length)
        centrifugal = bearing.mass[j] * (g.R_o + X[j, 1]) * Omega**2
        cage = contacts.on_balls[j]
        radial = cage[2] * c - cage[1] * s + centrifugal
        ball_forces.append(pushed[0] + pushed[1] + [cage[0], radial])
        race = race - [pushed[0][0], -pushed[0][1] * s, pushed[0][1] * c]
    return np.r_[np.ravel(ball_forces), race]


def solve(bearing, balls, cage, R, F, X, delta, laws):
    """Returns the contacts with balls and race in equilibrium, and the displacement of the race.

    By Newton's method in micrometres, which starts from X and delta. F: load on the inner race (3,)
    [N]; the other arguments are those of `cage_contacts`.
    """
    x, n = np.r_[X.ravel(), delta] * 1e6, 2 * len(balls)

    def places(x):
        return x[:n].reshape(-1, 2) * 1e-6, x[n:] * 1e-6

    def residual(x):
        X, delta = places(x)
        contacts = cage_contacts(bearing, balls, cage, R, X, delta, laws)
        return unbalanced(bearing, balls, F, X, delta, contacts)

    for _ in range(5):
        residual_here = residual(x)
        slope = np.array(
            [(residual(x + 1e-6 * e) - residual_here) / 1e-6 for e in np.eye(x.size)]
        ).T
        x = x - np.linalg.solve(slope, residual_here)
    X, delta = places(x)
    return cage_contacts(bearing, balls, cage, R, X, delta, laws), delta
