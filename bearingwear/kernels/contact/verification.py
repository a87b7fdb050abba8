"""Checks of a finished solve, by formulas the solvers do not use.

The solvers sum the gradient of a potential in four coefficients of a contact; here every point of
the contact gets its position, both surface velocities, friction force and moment as plain vectors.
The solvers follow a ball centre; here loads and angles must close the polygon of groove
centres. Only where the points of a rule lie, and which shares of load and area are theirs, is taken
from the solvers.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.ball import ball_inertia, ball_mass, drag_force
from bearingwear.kernels.contact.hertz import INNER, OUTER, race_contact
from bearingwear.kernels.contact.points import (
    Points,
    area_shares,
    most_points,
    place_across,
    quadrature_points,
)
from bearingwear.kernels.contact.slip import race_contacts, slip_coefficients
from bearingwear.kernels.decorators import jit


@jit
def polygon_residual(g, D, state, A1, A2, largest):
    """What loads and angles leave open: force balance and groove-centre polygon.

    Parameters
    ----------
    largest : float
        Largest contact load of the bearing, the scale [N].

    Returns
    -------
    float
        Unbalanced force as a share of the largest contact load [1]; an open polygon counts as the
        force that closing it would take, less what rounding of the lengths amounts to.
    """
    K_i = race_contact(g, INNER, D, math.cos(state.alpha_i), math.nan).K
    K_o = race_contact(g, OUTER, D, math.cos(state.alpha_o), math.nan).K
    d_i, d_o = (state.Q_i / K_i) ** (2.0 / 3.0), (state.Q_o / K_o) ** (2.0 / 3.0)
    l_i, l_o = g.r_i - 0.5 * D + d_i, g.r_o - 0.5 * D + d_o
    s_i, c_i = math.sin(state.alpha_i), math.cos(state.alpha_i)
    s_o, c_o = math.sin(state.alpha_o), math.cos(state.alpha_o)
    force_1 = state.Q_i * s_i - state.Q_o * s_o + state.P_x
    force_2 = state.Q_i * c_i - state.Q_o * c_o + state.P_r
    if not largest > 0.0:
        return 0.0
    residual = max(abs(force_1), abs(force_2))
    if state.Q_i > 0.0 and state.Q_o > 0.0:
        k = 1.5 / (d_i / state.Q_i + d_o / state.Q_o)
        gap = max(abs(l_i * s_i + l_o * s_o - A1), abs(l_i * c_i + l_o * c_o - A2))
        residual = max(residual, k * (gap - 1e-15 * (l_i + l_o)))
    return residual / largest


class PlainContact(NamedTuple):
    """A contact as the check sees it, in numbers of its own."""

    side: float  # -1 inner, 1 outer
    Q: float  # load [N]
    alpha: float  # contact angle [rad]
    r_g: float  # of the groove [m]
    omega: float  # of the race [rad/s]
    a: float  # semi-axis across the groove [m]
    b: float  # along the rolling [m]
    mu: float  # friction force over the load, if all of it slips one way [1]
    pressed: float  # the part of it that goes with the local pressure [1]


class Work(NamedTuple):
    """What friction does to a ball: moments [N m], forces [N] and powers [W]."""

    m_x: float
    m_y: float
    m_z: float
    f_x: float
    f_y: float
    f_z: float
    heat: float
    qv: float
    race: float  # done by the surface of the race


@jit
def plain_law(law, Q, a, b):
    """Coefficient of what follows the pressure [1], shear strength and Hertz' peak [Pa]."""
    return law.mu, law.S, 1.5 * Q / (math.pi * a * b)


@jit
def plain_contact(g, op, state, side):
    """The contact with the inner (-1) or outer race (1)."""
    if side < 0.0:
        Q, alpha, r_g, omega = state.Q_i, state.alpha_i, g.r_i, op.omega_i
        hertz, law = state.hertz_i, op.law_i
    else:
        Q, alpha, r_g, omega = state.Q_o, state.alpha_o, g.r_o, op.omega_o
        hertz, law = state.hertz_o, op.law_o
    a, b = hertz.c_a * Q ** (1.0 / 3.0), hertz.c_b * Q ** (1.0 / 3.0)
    mu, S, peak = plain_law(law, Q, a, b)
    whole = mu + S / (2.0 / 3.0 * peak) if S > 0.0 else mu
    return PlainContact(
        side=side, Q=Q, alpha=alpha, r_g=r_g, omega=omega, a=a, b=b, mu=whole, pressed=mu
    )


@jit
def with_contact(before, one, R, r, u, v_r, t, weight, across, share, length, width):
    """Friction's work with that of one contact added to it, point by point; `race` is its own.

    Parameters
    ----------
    t, weight, across, share : ndarray
        Places and shares of the load, as `quadrature_points` and `place_across` leave them.
    length, width : ndarray
        Likewise, shares of the area.
    """
    m_x, m_y, m_z, f_x, f_y, f_z, heat, qv, _ = before
    race = 0.0
    n_x, n_z = one.side * math.sin(one.alpha), one.side * math.cos(one.alpha)
    e_x, e_z = math.cos(one.alpha), -math.sin(one.alpha)
    R_d = 2.0 * one.r_g * R / (one.r_g + R)
    a, b = one.a, one.b
    for i in range(t.size):
        x = a * t[i]
        half = b * math.sqrt(1.0 - (x / a) ** 2)
        h = math.sqrt(R_d**2 - x**2) - math.sqrt(R_d**2 - a**2) + math.sqrt(R**2 - a**2)
        p_x, p_z = h * n_x + x * e_x, h * n_z + x * e_z
        for j in range(across.size):
            y = half * across[j]
            # Ball surface: velocity of the centre, plus w x p. Race surface: omega_race x position.
            ball_x = u[1] * p_z - u[2] * y
            ball_y = -u[3] * r + u[2] * p_x - u[0] * p_z
            ball_z = u[0] * y - u[1] * p_x
            race_y, race_z = -one.omega * (r + p_z), one.omega * y
            v_1 = -ball_x * e_x + (race_z - ball_z) * e_z
            v_2 = race_y - ball_y
            v2 = v_1**2 + v_2**2
            load = one.Q * weight[i] * share[j]
            shear = one.pressed * load + (one.mu - one.pressed) * one.Q * length[i] * width[j]
            F = shear / math.sqrt(v2 + v_r**2)
            F_x, F_y, F_z = F * v_1 * e_x, F * v_2, F * v_1 * e_z
            m_x += y * F_z - p_z * F_y
            m_y += p_z * F_x - p_x * F_z
            m_z += p_x * F_y - y * F_x
            f_x += F_x
            f_y += F_y
            f_z += F_z
            heat += F * v2
            qv += math.sqrt(v2) * load
            race += F_y * race_y + F_z * race_z
    return Work(m_x=m_x, m_y=m_y, m_z=m_z, f_x=f_x, f_y=f_y, f_z=f_z, heat=heat, qv=qv, race=race)


@jit
def friction_check(g, D, op, state, u, rule, bears):
    """Balance of moments, of the orbital force and of power on a thrust-loaded ball.

    Parameters
    ----------
    u : ndarray (4,) or (6,)
        (w_x, w_y, w_z, Omega) [rad/s], and what else is unknown.
    rule : Rule
        Any for the ellipse.
    bears : bool
        Whether traction bears on the balance of normal forces: then the forces there beside these
        are the centrifugal one and it, and what else they are is counted as unbalanced.

    Returns
    -------
    residual : float
        Largest unbalanced moment (over R) or force, as a share of the friction forces [1].
    power_error : float
        Shaft power less friction heat and drag, as a share of the power put in (where the races
        turn together nothing is, and the share is that of the friction forces at the speed of the
        contacts) [1].
    power : float
        What the power error is a share of [W].
    qv : float
        Both contacts [W].
    """
    R = 0.5 * D
    r = g.R_o + state.X2
    inner, outer = plain_contact(g, op, state, -1.0), plain_contact(g, op, state, 1.0)
    w = Work(m_x=0.0, m_y=0.0, m_z=0.0, f_x=0.0, f_y=0.0, f_z=0.0, heat=0.0, qv=0.0, race=0.0)
    power = power_in = 0.0
    contacts = race_contacts(g, op, state)
    t_buffer, weight_buffer, length = np.zeros((3, most_points(rule)))
    across, share, width = np.zeros((3, rule.across.size))
    for k in range(2):
        c = slip_coefficients(contacts[k], u, r)
        t, weight = quadrature_points(rule, contacts[k], R, c, op.v_r, t_buffer, weight_buffer)
        place_across(rule, contacts[k], R, c, across, share, False)
        one = inner if k == 0 else outer
        if one.mu > one.pressed:
            width[:] = 1.0
            even = Points(t=t.copy(), weight=length, h=t, width=t, across=across, share=width)
            area_shares(rule, contacts[k], R, c, op.v_r, even)
        w = with_contact(w, one, R, r, u, op.v_r, t, weight, across, share, length, width)
        power += w.race
        power_in += abs(w.race)
    inertia = ball_inertia(ball_mass(g.rho, D), D)
    F_v = drag_force(g, D, op.drag, u[3])[0]
    m_y, m_z = w.m_y + inertia * u[3] * u[2], w.m_z - inertia * u[3] * u[1]
    capacity = outer.mu * (state.Q_i + state.Q_o) + (inner.mu - outer.mu) * state.Q_i
    residual = max(abs(w.m_x), abs(m_y), abs(m_z), abs(w.f_y + F_v) * R) / (capacity * R)
    if bears:
        centrifugal = ball_mass(g.rho, D) * r * u[3] ** 2
        left = max(abs(state.P_x - w.f_x), abs(state.P_r - centrifugal - w.f_z))
        residual = max(residual, left / capacity)
    floor = capacity * op.v_r
    if op.omega_i == op.omega_o:
        floor = max(floor, capacity * abs(op.omega_i) * r)
    scale = max(power_in, floor)
    return residual, abs(power - w.heat - F_v * r * u[3]) / scale, scale, w.qv
