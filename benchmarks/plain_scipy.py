"""The same bearing in plain NumPy and SciPy: an independent check and the speed to beat.

Nothing here imports bearingwear. Every equation is written again from its statement, with general
SciPy solvers and finite-difference Jacobians, so that an error would have to be made twice to stay
hidden. SI units and radians throughout. Arrays of two are ordered (inner race, outer race).

Frames: x axial, z radially outward, y = z x x; the ball moves towards -y with speed r Omega.
"""

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root
from scipy.special import ellipe, ellipkm1

MM, UM, RPM = 1e-3, 1e-6, np.pi / 30


@dataclass(frozen=True)
class Bearing:
    """Unworn geometry and material of an angular contact ball bearing."""

    count: int  # balls
    D0: float  # nominal ball diameter [m]
    dm: float  # pitch diameter [m]
    a0: float  # free contact angle [rad]
    f: tuple[float, float]  # groove radius over ball diameter, inner and outer
    E: float = 208e9  # Young's modulus of balls and races [Pa]
    nu: float = 0.3
    rho: float = 7800.0  # ball density [kg m-3]

    @property
    def E_star(self):
        """Effective modulus of two equal bodies [Pa]."""
        return self.E / (2 * (1 - self.nu**2))

    @property
    def grooves(self):
        """Groove radii [m]; they do not follow the ball's wear."""
        return np.array(self.f) * self.D0

    @property
    def BD(self):
        """Distance of the groove-curvature centres [m]."""
        return (sum(self.f) - 1) * self.D0

    @property
    def loci(self):
        """Radii of the circles of groove centres, inner and outer [m]."""
        shift = (np.array(self.f) - 0.5) * self.D0 * np.cos(self.a0)
        return self.dm / 2 + shift * np.array([1, -1])

    def inertia(self, D):
        """Mass [kg] and moment of inertia [kg m2] of a ball of diameter D."""
        mass = self.rho * np.pi * D**3 / 6
        return mass, mass * D**2 / 10


@dataclass(frozen=True)
class Operation:
    """What the bearing is asked to do, and how friction and wear are described."""

    preload: float  # static, unworn axial preload [N]
    speed: tuple[float, float]  # race speeds, inner and outer [rad/s]
    mu: float = 0.08
    method: str = "constant_force"  # or "fixed_position"
    loss: float = 0.0  # loss of ball diameter [m]
    drag: float = 0.0  # effective density times drag coefficient [kg m-3]
    v_r: float = 1e-3  # slip speed that rounds off Coulomb's law [m/s]
    wear_coefficient: float = 5e-6
    hardness: float = 6.6e9  # [Pa]


NOSAKA = Bearing(10, 7.938e-3, 38.5e-3, np.radians(20), (0.56, 0.52), 199.948e9, 0.25, 7750.37)
B218 = Bearing(16, 22.225e-3, 125.26e-3, np.radians(40), (0.5232, 0.5232), 207.5e9)
MINIATURE = Bearing(10, 2e-3, 9e-3, np.radians(25), (0.565, 0.585))
S1 = Bearing(9, 2e-3, 7.5e-3, np.radians(20), (0.54, 0.585))
S2 = Bearing(10, 2e-3, 9e-3, np.radians(15), (0.54, 0.585))
S3 = Bearing(9, 2e-3, 8e-3, np.radians(18), (0.54, 0.585))
INSTRUMENT = Operation(preload=7.0, speed=(30000 * RPM, 0.0))


# --- Hertz -----------------------------------------------------------------------------------


def hertz(across, along, E_star):
    """Elliptic point contact from the curvature sums across and along the rolling direction [1/m].

    Returns c_a, c_b (semi-axes are c Q^(1/3)), K (load is K d^1.5) and E(m), m = 1 - (b/a)^2.
    The major axis lies across the rolling direction: across <= along.
    """
    total = across + along
    ratio = (along - across) / total

    def mismatch(k):
        m1 = 1 / k**2
        second = ellipe(1 - m1)
        return ((k**2 + 1) * second - 2 * ellipkm1(m1)) / ((k**2 - 1) * second) - ratio

    k = 1.0
    if ratio > 1e-9:
        k = brentq(mismatch, 1 + 1e-7, 1e4, xtol=1e-15, rtol=4 * np.finfo(float).eps)
    first, second = ellipkm1(1 / k**2), ellipe(1 - 1 / k**2)
    c_a = (3 * k**2 * second / (np.pi * total * E_star)) ** (1 / 3)
    K = (2 * np.pi * c_a * E_star / (3 * first)) ** 1.5
    return c_a, c_a / k, K, second


def race_hertz(bearing, D, race, angle):
    """Hertz constants of a ball of diameter D on race 0 (inner) or 1 (outer)."""
    side = -1 if race == 0 else 1
    rolling = -side * 2 * np.cos(angle) / (bearing.dm + side * D * np.cos(angle))
    return hertz(2 / D - 1 / bearing.grooves[race], 2 / D + rolling, bearing.E_star)


@dataclass
class Contacts:
    """The two contacts of one ball."""

    angle: np.ndarray
    load: np.ndarray
    semi_major: np.ndarray
    semi_minor: np.ndarray
    ellipse: np.ndarray  # E(m)
    radius: float  # of the ball's orbit [m]


def contacts(bearing, D, A, X):
    """Contacts of a ball at X = (axial, radial) from the outer groove centre, A the inner one."""
    gap = np.array([A[0] - X[0], A[1] - X[1]]), np.array(X)
    angle = np.array([np.arctan2(g[0], g[1]) for g in gap])
    depth = np.array([np.hypot(*g) for g in gap]) - (bearing.grooves - D / 2)
    c = np.array([race_hertz(bearing, D, race, angle[race]) for race in (0, 1)]).T
    load = c[2] * np.maximum(depth, 0) ** 1.5
    third = np.cbrt(load)
    return Contacts(angle, load, c[0] * third, c[1] * third, c[3], bearing.loci[1] + X[1])


# --- Equilibrium -----------------------------------------------------------------------------


def ball_forces(bearing, D, c, Omega):
    """Axial and radial force left over on a ball orbiting at Omega [N], traction left out."""
    (Q_i, Q_o), (a_i, a_o) = c.load, c.angle
    F_c = bearing.inertia(D)[0] * c.radius * Omega**2
    return np.array(
        [
            Q_i * np.sin(a_i) - Q_o * np.sin(a_o),
            Q_i * np.cos(a_i) - Q_o * np.cos(a_o) + F_c,
        ]
    )


def solution(function, start, accept=1e-9, what="equations"):
    """Root of a scaled system; what counts is the residual, not the solver's own verdict."""
    found = root(function, start, method="hybr", options={"xtol": 1e-14})
    if not np.max(np.abs(function(found.x))) < accept:
        raise RuntimeError(f"{what}: residual {np.max(np.abs(found.fun)):.1e}, {found.message}")
    return found.x


def static_displacement(bearing, force):
    """Axial displacement of the unworn bearing at rest under a thrust force [m]."""
    D, BD, a0 = bearing.D0, bearing.BD, bearing.a0

    def load(delta):
        axial, radial = BD * np.sin(a0) + delta, BD * np.cos(a0)
        Q, angle = static_load(bearing, D, axial, radial)
        return bearing.count * Q * np.sin(angle) / force - 1

    return brentq(load, 0, 0.2 * BD, xtol=1e-18, rtol=4 * np.finfo(float).eps)


def static_load(bearing, D, axial, radial):
    """Load and angle of a ball at rest between groove centres this far apart (in line)."""
    angle = np.arctan2(axial, radial)
    depth = np.hypot(axial, radial) - (bearing.grooves.sum() - D)
    K = [race_hertz(bearing, D, race, angle)[2] for race in (0, 1)]
    return max(depth, 0) ** 1.5 / sum(k ** (-2 / 3) for k in K) ** 1.5, angle


def static_position(bearing, D, axial, radial):
    """Ball centre from the outer groove centre when the ball is at rest."""
    Q, angle = static_load(bearing, D, axial, radial)
    length = bearing.grooves[1] - D / 2 + (Q / race_hertz(bearing, D, 1, angle)[2]) ** (2 / 3)
    return length * np.sin(angle), length * np.cos(angle)


def thrust_start(bearing, op):
    """Position of ball and race at rest: start of every thrust solve, as (X1, X2, delta_a)."""
    delta = static_displacement(bearing, op.preload)
    if op.method == "constant_force":
        # A smaller ball lets the race move on until the grooves grip it again.
        delta += op.loss / np.sin(bearing.a0)
    axial, radial = bearing.BD * np.sin(bearing.a0) + delta, bearing.BD * np.cos(bearing.a0)
    return np.array([*static_position(bearing, bearing.D0 - op.loss, axial, radial), delta])


def thrust_contacts(bearing, op, position):
    """Contacts for (X1, X2, delta_a), one ball standing for all."""
    X1, X2, delta = position
    A = bearing.BD * np.sin(bearing.a0) + delta, bearing.BD * np.cos(bearing.a0)
    return contacts(bearing, bearing.D0 - op.loss, A, (X1, X2))


def thrust_residual(bearing, op, c, Omega):
    """Scaled balance of the ball, and of the inner race where it is free to move axially."""
    share = op.preload / bearing.count
    balance = ball_forces(bearing, bearing.D0 - op.loss, c, Omega) / share
    if op.method == "fixed_position":
        return balance
    return np.append(balance, c.load[0] * np.sin(c.angle[0]) / share - 1)


def thrust_equilibrium(bearing, op, Omega, start=None):
    """Position (X1, X2, delta_a) of one ball standing for all at a given orbit rate."""
    start = thrust_start(bearing, op) if start is None else np.asarray(start, float)
    unknowns = 2 if op.method == "fixed_position" else 3
    unit = 5e-4 * bearing.D0

    def residual(x):
        c = thrust_contacts(bearing, op, np.append(x * unit, start[unknowns:]))
        return thrust_residual(bearing, op, c, Omega)

    x = solution(residual, start[:unknowns] / unit, what="thrust equilibrium")
    return np.append(x * unit, start[unknowns:])


def loaded_equilibrium(
    bearing, force, *, Omega=0.0, D=None, tilt=0.0, free_tilt=False, lever=None, start=None
):
    """Equilibrium of the inner race and all balls under a force (F_x, F_y, F_z) [N].

    Returns (delta_a, delta_y, delta_z, tilt) and the loads (balls, 2). The tilt about Y is given
    unless `free_tilt`, which asks for zero moment. Ball 0 stands at +Z.
    """
    D = bearing.D0 if D is None else D
    lever = bearing.loci[0] if lever is None else lever
    psi = 2 * np.pi * np.arange(bearing.count) / bearing.count
    size = np.linalg.norm(force)
    unit = np.array([5e-4 * bearing.D0] * 3 + [1e-3])
    last = {}

    def balls(displacement):
        delta_a, delta_y, delta_z, theta = displacement
        axial = bearing.BD * np.sin(bearing.a0) + delta_a + theta * lever * np.cos(psi)
        radial = bearing.BD * np.cos(bearing.a0) + delta_z * np.cos(psi) - delta_y * np.sin(psi)
        load, angle = np.zeros((2, bearing.count, 2))
        for j, A in enumerate(zip(axial, radial, strict=True)):
            if Omega == 0:
                load[j], angle[j] = static_load(bearing, D, *A)
                continue

            def residual(x, A=A):
                return ball_forces(bearing, D, contacts(bearing, D, A, x * unit[0]), Omega) / size

            first = last.get(j, np.array(static_position(bearing, D, *A)) / unit[0])
            last[j] = solution(residual, first, what=f"ball {j}")
            c = contacts(bearing, D, A, last[j] * unit[0])
            load[j], angle[j] = c.load, c.angle
        return load, angle

    def residual(x):
        displacement = np.append(x, [tilt / unit[3]] * (4 - x.size)) * unit
        load, angle = balls(displacement)
        axial, radial = load[:, 0] * np.sin(angle[:, 0]), load[:, 0] * np.cos(angle[:, 0])
        # A ball pushes the race along n_i = -(sin a, 0, cos a) of its own azimuth frame.
        out = [
            force[0] - axial.sum(),
            force[1] + (radial * np.sin(psi)).sum(),
            force[2] - (radial * np.cos(psi)).sum(),
        ]
        if free_tilt:
            out.append((axial * np.cos(psi)).sum())
        return np.array(out) / size

    unknowns = 4 if free_tilt else 3
    start = np.array([UM, 0.0, UM, 0.0] if start is None else start) / unit
    x = solution(residual, start[:unknowns], what="loaded equilibrium")
    displacement = np.append(x, [tilt / unit[3]] * (4 - unknowns)) * unit
    return displacement, *balls(displacement)


# --- Jones-Harris race control ---------------------------------------------------------------


def rolling(bearing, D, angle, speed, control):
    """Orbit rate, ball spin (relative to the orbiting frame) and pitch angle under race control.

    No slip at either contact centre; no spin on race `control` (0 inner, 1 outer).
    """
    g = D / bearing.dm
    a_i, a_o = angle
    a, side = (a_i, -1) if control == 0 else (a_o, 1)
    beta = np.arctan2(np.sin(a), np.cos(a) + side * g)
    inner = (1 - g * np.cos(a_i)) / np.cos(beta - a_i)
    outer = (1 + g * np.cos(a_o)) / np.cos(beta - a_o)
    Omega = (inner * speed[0] + outer * speed[1]) / (inner + outer)
    return Omega, (Omega - speed[1]) * outer / g, beta


def race_control(bearing, op, control=None):
    """Thrust solution with all spin on one race; `control` None lets the spin moments decide."""
    if control is None:
        trial = race_control(bearing, op, control=1)
        c = trial["contacts"]
        moment = c.load * c.semi_major * c.ellipse
        if moment[1] * np.cos(c.angle[0] - c.angle[1]) > moment[0]:
            return trial
        return race_control(bearing, op, control=0)
    D = bearing.D0 - op.loss
    mass, inertia = bearing.inertia(D)
    start = thrust_start(bearing, op)
    unknowns = 2 if op.method == "fixed_position" else 3
    unit, share = 5e-4 * bearing.D0, op.preload / bearing.count

    def state(x):
        position = np.append(x * unit, start[unknowns:])
        c = thrust_contacts(bearing, op, position)
        Omega, spin, beta = rolling(bearing, D, c.angle, op.speed, control)
        M_g = inertia * spin * Omega * np.sin(beta)
        return position, c, Omega, spin, beta, M_g, mass * bearing.dm / 2 * Omega**2

    def forces(c, M_g, F_c):
        """Balance of the ball and axial force of the inner race on it."""
        (Q_i, Q_o), (a_i, a_o) = c.load, c.angle
        # The traction that carries M_g points along -first axis outside, along +first axis inside.
        T_i, T_o = (2 * M_g / D, 0.0) if control == 0 else (0.0, 2 * M_g / D)
        inner = Q_i * np.sin(a_i) + T_i * np.cos(a_i)
        axial = inner - Q_o * np.sin(a_o) - T_o * np.cos(a_o)
        radial = Q_i * np.cos(a_i) - T_i * np.sin(a_i) - Q_o * np.cos(a_o) + T_o * np.sin(a_o)
        return axial, radial + F_c, inner

    def residual(x):
        _, c, *_, M_g, F_c = state(x)
        axial, radial, inner = forces(c, M_g, F_c)
        return np.array([axial / share, radial / share, inner / share - 1])[:unknowns]

    x = solution(residual, start[:unknowns] / unit, what="race control")
    position, c, Omega, spin, beta, M_g, F_c = state(x)
    # Ball against race, resolved on the normal (spin) and the first axis (roll), race by race.
    relative = np.array([-spin * np.cos(beta) + Omega, spin * np.sin(beta)])
    ratio = [
        ((relative[0] - op.speed[race]) * np.sin(a) + relative[1] * np.cos(a))
        / ((relative[0] - op.speed[race]) * np.cos(a) - relative[1] * np.sin(a))
        for race, a in enumerate(c.angle)
    ]
    return {
        "delta_a": position[2],
        "contacts": c,
        "Omega": Omega,
        "spin": spin,
        "beta": beta,
        "M_g": M_g,
        "F_c": F_c,
        "spin_to_roll": np.abs(ratio),
        "control": control,
        "residual_preload": bearing.count * forces(c, M_g, F_c)[2],
    }


# --- Slip, traction, QV ----------------------------------------------------------------------


def gauss(points):
    """Gauss-Legendre rule with this many points on each half of the major axis, on (-1, 1)."""
    x, w = np.polynomial.legendre.leggauss(points)
    return np.concatenate([(x - 1) / 2, (x + 1) / 2]), np.concatenate([w, w]) / 2


def strips(points):
    """Equal strips over the whole major axis: mid-points, on (-1, 1)."""
    return (np.arange(points) + 0.5) * 2 / points - 1, np.full(points, 2 / points)


@dataclass
class Traction:
    """Slip, force and moment of both contacts on one ball; per-contact values are arrays of two."""

    F_y: float
    moment: np.ndarray
    qv: np.ndarray
    heat: np.ndarray
    share: np.ndarray  # of gyroscopic slip
    torque: np.ndarray  # of each race on the ball, about the bearing axis
    slip: tuple = field(repr=False, default=())  # (gyroscopic, rolling) slip and strip load


def traction(bearing, op, c, w, Omega, rule):
    """Traction of both races on a ball turning at w (absolute, azimuth frame)."""
    xi, weight = rule
    R = (bearing.D0 - op.loss) / 2
    side = np.array([[-1.0], [1.0]])  # the inner contact lies on the ball's inward side
    sin, cos = np.sin(c.angle)[:, None], np.cos(c.angle)[:, None]
    a, Q = c.semi_major[:, None], c.load[:, None]
    R_d = (2 * bearing.grooves * R / (bearing.grooves + R))[:, None]
    x = a * xi
    h = np.sqrt(R_d**2 - x**2) - np.sqrt(R_d**2 - a**2) + np.sqrt(R**2 - a**2)
    p_x, p_z = x * cos + side * h * sin, -x * sin + side * h * cos
    dQ = 0.75 * Q * (1 - xi**2) * weight
    radius = c.radius + p_z
    v1 = -side * w[1] * h
    v2 = c.radius * Omega - np.array(op.speed)[:, None] * radius - (w[2] * p_x - w[0] * p_z)
    speed = np.hypot(v1, v2)
    pull = op.mu * dQ / np.sqrt(speed**2 + op.v_r**2)
    f1, f2 = pull * v1, pull * v2
    qv = (speed * dQ).sum(axis=1)
    return Traction(
        F_y=f2.sum(),
        moment=np.array([-(p_z * f2).sum(), (side * h * f1).sum(), (p_x * f2).sum()]),
        qv=qv,
        heat=(pull * speed**2).sum(axis=1),
        share=(np.abs(v1) * dQ).sum(axis=1) / qv,
        torque=-(radius * f2).sum(axis=1),
        slip=(v1, v2, dQ),
    )


def drag_force(bearing, op, Omega):
    """Lubricant drag on one ball along +y [N]."""
    area = np.pi / 8 * (bearing.D0 - op.loss) ** 2
    return op.drag * area * (bearing.dm * Omega / 2) ** 2 * np.sign(Omega)


def accelerations(bearing, op, c, w, Omega, rule):
    """Rates of (w_x, w_y, w_z, Omega) of one ball [rad/s2]."""
    mass, inertia = bearing.inertia(bearing.D0 - op.loss)
    t = traction(bearing, op, c, w, Omega, rule)
    turning = t.moment / inertia + Omega * np.array([0.0, w[2], -w[1]])
    return np.append(turning, -(t.F_y + drag_force(bearing, op, Omega)) / (mass * c.radius))


# --- Friction-balanced steady state ----------------------------------------------------------


def steady_state(bearing, op, rule=None, start=None, levels=None):
    """State in which friction balances gyroscopic moment and drag, one ball standing for all.

    Position (X1, X2, delta_a), spin and orbit rate are solved together. Friction starts nearly
    viscous (large v_r), where the equations are almost linear, and is followed down to `op.v_r`;
    the drag comes in as friction grows stiff enough to carry it. With a `start` (position, w,
    Omega) and one level it is a plain Newton solve from there.
    """
    rule = gauss(25) if rule is None else rule
    D = bearing.D0 - op.loss
    free = 2 if op.method == "fixed_position" else 3
    unit = 5e-4 * bearing.D0
    rate = np.max(np.abs(op.speed))
    mass, inertia = bearing.inertia(D)
    if start is None:
        Omega, spin, beta = rolling(bearing, D, [bearing.a0] * 2, op.speed, 1)
        position = thrust_equilibrium(bearing, op, Omega)
        start = position, (Omega - spin * np.cos(beta), 0.0, spin * np.sin(beta)), Omega
    position, w, Omega = start
    x = np.concatenate([position[:free] / unit, np.array([*w, Omega]) / rate])
    if levels is None:
        steps = max(int(np.ceil(np.log10(10 / op.v_r) * 2)), 1)
        levels = np.geomspace(10, op.v_r, steps + 1)

    def unpack(x):
        return np.append(x[:free] * unit, position[free:]), x[free:-1] * rate, x[-1] * rate

    for v_r in levels:
        level = replace(op, v_r=v_r, drag=op.drag * min(1.0, max(op.v_r, 0.03) / v_r))
        # Weigh friction up while it is weak, so that the accepted residual means the same.
        weight = max(1.0, v_r / 0.1)

        def residual(x, level=level, weight=weight):
            where, w, Omega = unpack(x)
            c = thrust_contacts(bearing, level, where)
            rates = accelerations(bearing, level, c, w, Omega, rule)
            size = op.mu * op.preload / bearing.count * D / 2
            scale = np.array([inertia, inertia, inertia, mass * c.radius * D / 2]) / size
            balance = thrust_residual(bearing, level, c, Omega)
            return np.concatenate([balance, rates * scale * weight])

        x = solution(residual, x, accept=1e-8, what=f"steady state at v_r = {v_r:.2g} m/s")
    where, w, Omega = unpack(x)
    return steady_values(bearing, op, where, w, Omega, rule, np.max(np.abs(residual(x))))


def steady_values(bearing, op, position, w, Omega, rule, residual):
    """Everything that is reported of a steady state."""
    D = bearing.D0 - op.loss
    c = thrust_contacts(bearing, op, position)
    t = traction(bearing, op, c, w, Omega, rule)
    power_in = t.torque @ np.array(op.speed)
    drag_power = drag_force(bearing, op, Omega) * c.radius * Omega
    pure, _, _ = rolling(bearing, D, c.angle, op.speed, 1)
    return {
        "position": position,
        "contacts": c,
        "w": w,
        "Omega": Omega,
        "traction": t,
        "residual_preload": bearing.count * c.load[0] * np.sin(c.angle[0]),
        "shaft_torque": bearing.count * t.torque[0],
        "drag_power": bearing.count * drag_power,
        "power_balance_error": power_in / (t.heat.sum() + drag_power) - 1,
        "skid_ratio": 1 - Omega / pure,
        "residual": residual,
        **wear(bearing, op, c, t),
    }


def wear(bearing, op, c, t):
    """Archard wear rates and the two ways of counting the loss of ball diameter [m/s]."""
    R = (bearing.D0 - op.loss) / 2
    volume = op.wear_coefficient / op.hardness * t.qv  # of one body in one contact [m3/s]
    R_d = 2 * bearing.grooves * R / (bearing.grooves + R)
    h0 = R_d - np.sqrt(R_d**2 - c.semi_major**2) + np.sqrt(R**2 - c.semi_major**2)
    track = c.radius + np.array([-1, 1]) * h0 * np.cos(c.angle)
    depth = bearing.count * volume / (2 * np.pi * track * 2 * c.semi_major)
    ball = 2 * volume.sum() / (np.pi * (2 * R) ** 2)
    return {
        "ball_wear_rate": volume.sum(),
        "race_wear_rate": bearing.count * volume,
        "track_radius": track,
        "loss_rate_ball": ball,
        "loss_rate_ball_and_races": ball + depth.sum(),
    }


# --- Dynamics of one ball under thrust -------------------------------------------------------


def load_table(bearing, op, Omega, degree=16, width=0.25):
    """Chebyshev polynomials of position against orbit rate, so that a time step solves nothing."""
    domain = [(1 - width) * Omega, (1 + width) * Omega]
    nodes = np.polynomial.chebyshev.chebpts1(degree + 1)
    rates = domain[0] + (nodes + 1) / 2 * (domain[1] - domain[0])
    solved, where = [], None
    for rate in rates:
        where = thrust_equilibrium(bearing, op, rate, where)
        solved.append(where)
    fit = np.polynomial.chebyshev.chebfit(nodes, np.array(solved), degree)

    def position(Omega):
        if not domain[0] <= Omega <= domain[1]:
            raise RuntimeError(f"orbit rate {Omega:.1f} rad/s is outside the table of loads")
        s = 2 * (Omega - domain[0]) / (domain[1] - domain[0]) - 1
        return np.polynomial.chebyshev.chebval(s, fit)

    return position


def motion(bearing, op, start, duration, position, rule=None, method="LSODA", rtol=1e-9):
    """Integrate (w_x, w_y, w_z, Omega) of one ball; normal loads follow the orbit rate at once."""
    rule = gauss(25) if rule is None else rule

    def rates(_, y):
        c = thrust_contacts(bearing, op, position(y[3]))
        return accelerations(bearing, op, c, y[:3], y[3], rule)

    done = solve_ivp(rates, (0, duration), start, method=method, rtol=rtol, atol=1e-7)
    if not done.success:
        raise RuntimeError(f"motion: {done.message}")
    return done


def time_scales(bearing, op, state, rule=None):
    """Eigenvalues of the linearised motion about a steady state [1/s]; stable if all are < 0."""
    rule = gauss(25) if rule is None else rule

    def rates(y):
        where = thrust_equilibrium(bearing, op, y[3], state["position"])
        return accelerations(bearing, op, thrust_contacts(bearing, op, where), y[:3], y[3], rule)

    y = np.array([*state["w"], state["Omega"]])
    step = 1e-5 * op.v_r / (bearing.D0 / 2)
    jacobian = [(rates(y + step * e) - rates(y - step * e)) / (2 * step) for e in np.eye(4)]
    return np.linalg.eigvals(np.array(jacobian).T)
