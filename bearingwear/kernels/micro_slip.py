"""Elastic micro-slip of one ball/race contact by FASTSIM (theory.md section 20).

Material that enters the contact sticks at first: the slip of rigid bodies strains it instead, and
the traction grows from the leading edge on until friction's limit is reached. Kalker's simplified
theory takes the surface for a bed of springs of the flexibility L,

    dp/ds = v/(V L),  |p| <= mu p_n,

s from the leading edge on, V the rolling speed, v the slip of rigid bodies. L is such that small
slip along rolling, along the major axis, or by spin gives the forces of the half space. Where the
surfaces stick each kind has its own; where they slide all three have their mean by Kalker's
weights, so that the traction turns into the direction of the slip: large slip gives Coulomb's.

Source: Kalker, *A fast algorithm for the simplified theory of rolling contact*, Vehicle System
Dynamics 11 (1982) 1; *Three-Dimensional Elastic Bodies in Rolling Contact*, Kluwer 1990.
"""

import math
from typing import NamedTuple

from bearingwear.kernels.build.decorators import jit
from bearingwear.kernels.profile import PEAK, height, pressure, pressure_integral, profile

MEAN_PLACE = math.sqrt(0.2)  # root of the mean of (x/a)^2 by the load


class Flexibility(NamedTuple):
    """Of the surface to traction, for slip of one kind alone [m/Pa]."""

    rolling: float
    lateral: float  # along the major axis
    spin: float


class TractionGrowth(NamedTuple):
    """Of the traction, per slip and way [Pa s/m2]."""

    rolling: float  # by slip of each kind, where the surfaces stick
    lateral: float
    spin: float
    sliding: float  # by all of it, where they slide


class MicroSlip(NamedTuple):
    """Sums over a contact."""

    qv: float  # traction by the slip of rigid bodies, over the friction coefficient [W]
    full_qv: float  # the same where all of the contact slides [W]
    stuck: float  # share of the load where the surfaces stick [1]
    g_1: float  # generalised friction as `contact.traction` has it [N m]
    g_0: float  # [N]
    g_h: float  # [N m]
    g_x: float  # [N m]


@jit
def rolling_speed(contact, R, r, Omega):
    """Speed of the race through the contact along y, seen from the contact [m/s].

    Parameters
    ----------
    contact : Contact
    R, r : float
        Radii of ball and orbit [m].
    Omega : float
        Orbit rate [rad/s].
    """
    return -(contact.omega - Omega) * (r + contact.sigma * R * contact.cos_a)


@jit
def mean_flexibility(flexibility, c, h, size):
    """Flexibility to slip of several kinds [m/Pa].

    Parameters
    ----------
    c : tuple of 4 floats
        `contact.slip_coefficients`.
    h : float
        Height of the contact where the slip along rolling is taken [m].
    size : float
        Geometric mean of the semi-axes [m].
    """
    c_1, c_0, c_h, c_x = c
    rolling, lateral, spin = abs(c_0 + c_h * h), abs(c_1 * h), abs(c_x) * size
    total = math.sqrt(rolling * rolling + lateral * lateral + spin * spin)
    if not total > 0.0:
        return flexibility.rolling
    f = flexibility
    return (rolling * f.rolling + lateral * f.lateral + spin * f.spin) / total


@jit
def traction_growth(flexibility, c, h, size, V):
    """How traction grows along the material's way; `c`, `h`, `size` as in `mean_flexibility`."""
    f, speed = flexibility, abs(V)
    return TractionGrowth(
        rolling=1.0 / (f.rolling * speed),
        lateral=1.0 / (f.lateral * speed),
        spin=1.0 / (f.spin * speed),
        sliding=1.0 / (mean_flexibility(f, c, h, size) * speed),
    )


@jit
def strip_micro_slip(c, h, x, half, width, load, mu, growth, cells):
    """One strip, from its leading edge on.

    Parameters
    ----------
    c : tuple of 4 floats
        `contact.slip_coefficients`.
    h, x : float
        Height and place of its middle [m].
    half, width : float
        Half-length along rolling, negative where the material comes from +y, and width [m].
    load, mu : float
        [N] and [1].
    growth : TractionGrowth
    cells : int

    Returns
    -------
    MicroSlip
        Its `stuck` is a load [N].
    """
    c_1, c_0, c_h, c_x = c
    lateral, rolling, spin = c_1 * h, c_0 + c_h * h, c_x * x
    qv = full_qv = stuck = g_1 = g_2 = g_x = 0.0
    p_1 = p_2 = share = 0.0
    last = edge = -1.0
    for k in range(cells):
        angle = math.pi * (k + 1) / cells
        new_edge, new_share = -math.cos(angle), (angle - 0.5 * math.sin(2.0 * angle)) / math.pi
        middle = 0.5 * (edge + new_edge)
        normal, area = load * (new_share - share), abs(half) * (new_edge - edge) * width
        limit = mu * normal / area
        ds, turned = abs(half) * (middle - last), -c_x * half * 0.5 * (last + middle)
        y = half * middle
        v_1, v_2 = lateral - c_x * y, rolling + spin
        q_1 = p_1 + ds * (lateral * growth.lateral + turned * growth.spin)
        q_2 = p_2 + ds * (rolling * growth.rolling + spin * growth.spin)
        if q_1 * q_1 + q_2 * q_2 > limit * limit:
            q_1 = p_1 + ds * v_1 * growth.sliding
            q_2 = p_2 + ds * v_2 * growth.sliding
            excess = max(math.sqrt(q_1 * q_1 + q_2 * q_2) / limit, 1.0)
            p_1, p_2 = q_1 / excess, q_2 / excess
        else:
            p_1, p_2 = q_1, q_2
            stuck += normal
        F_1, F_2 = p_1 * area, p_2 * area
        qv += (F_1 * v_1 + F_2 * v_2) / mu
        full_qv += math.sqrt(v_1 * v_1 + v_2 * v_2) * normal
        g_1 += F_1
        g_2 += F_2
        g_x += F_2 * x - F_1 * y
        last, edge, share = middle, new_edge, new_share
    return MicroSlip(
        qv=qv, full_qv=full_qv, stuck=stuck, g_1=h * g_1, g_0=g_2, g_h=h * g_2, g_x=g_x
    )


@jit
def micro_slip(contact, R, c, mu, V, flexibility, strips, cells):
    """Traction with micro-slip over a contact whose slip as rigid bodies is known.

    Parameters
    ----------
    contact : Contact
    R : float
        Ball radius [m].
    c : tuple of 4 floats
        `contact.slip_coefficients`.
    mu : float
        Friction coefficient [1].
    V : float
        `rolling_speed`, not zero.
    flexibility : Flexibility
    strips, cells : int
        Strips of equal width along the major axis, and cells of each along rolling; these are
        narrower towards the edges.

    Returns
    -------
    MicroSlip
    """
    a, b = contact.a, contact.b
    surface = profile(contact.r_g, R, a)
    mean_height = height(surface, MEAN_PLACE * a)
    growth = traction_growth(flexibility, c, mean_height, math.sqrt(a * b), V)
    qv = full_qv = stuck = g_1 = g_0 = g_h = g_x = 0.0
    for i in range(strips):
        low, high = 2.0 * i / strips - 1.0, 2.0 * (i + 1) / strips - 1.0
        t = 0.5 * (low + high)
        h, half = height(surface, a * t), math.copysign(b * math.sqrt(pressure(t)), V)
        load = contact.Q * PEAK * (pressure_integral(high) - pressure_integral(low))
        s = strip_micro_slip(c, h, a * t, half, a * (high - low), load, mu, growth, cells)
        qv += s.qv
        full_qv += s.full_qv
        stuck += s.stuck / contact.Q
        g_1 += s.g_1
        g_0 += s.g_0
        g_h += s.g_h
        g_x += s.g_x
    return MicroSlip(qv=qv, full_qv=full_qv, stuck=stuck, g_1=g_1, g_0=g_0, g_h=g_h, g_x=g_x)
