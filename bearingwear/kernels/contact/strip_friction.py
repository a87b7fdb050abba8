"""Friction of a contact in the line model as the motion in time sums it: in one pass, no buffer."""

import math

from bearingwear.kernels.build.decorators import ESTIMATE_ROOTS, jit
from bearingwear.kernels.contact.friction import quick_force_per_slip, quick_force_slope
from bearingwear.kernels.contact.profile import height, profile
from bearingwear.kernels.contact.slip import point_slip
from bearingwear.kernels.contact.traction import store_slopes


@jit(fastmath=ESTIMATE_ROOTS)
def strip_sums(contact, R, c, mu, v_r, t, weight):
    """Gradient of Phi by c, and QV.

    Returns
    -------
    g_1, g_0, g_h, g_x, qv
        As in `traction.strip_traction`; qv in W.
    """
    a, v_r2 = contact.a, v_r * v_r
    p = profile(contact.r_g, R, a)
    g_1 = g_0 = g_h = g_x = qv = 0.0
    for k in range(t.size):
        x = a * t[k]
        h = height(p, x)
        v1, v2 = point_slip(c, h, x)
        v_2 = v1 * v1 + v2 * v2
        f = quick_force_per_slip(weight[k], v_2, v_r2)
        qv += weight[k] * math.sqrt(v_2)
        g_1 += f * v1 * h
        f2 = f * v2
        g_0 += f2
        g_h += f2 * h
        g_x += f2 * x
    s = mu * contact.Q
    return s * g_1, s * g_0, s * g_h, s * g_x, contact.Q * qv


@jit(fastmath=ESTIMATE_ROOTS)
def strip_slope_sums(contact, R, c, mu, v_r, t, weight, gradient, hessian):
    """Gradient (4,) and second derivatives (4, 4) of Phi by c; returns QV [W]."""
    a, v_r2 = contact.a, v_r * v_r
    p_R = profile(contact.r_g, R, a)
    g_1 = g_0 = g_h = g_x = qv = 0.0
    p_00 = p_0h = p_0x = p_hh = p_hx = p_xx = 0.0
    s_0 = s_h = s_x = s_1 = 0.0
    for k in range(t.size):
        x = a * t[k]
        h = height(p_R, x)
        v1, v2 = point_slip(c, h, x)
        f, p_11, p_12, p = quick_force_slope(weight[k], v1, v2, v_r2)
        qv += weight[k] * math.sqrt(v1 * v1 + v2 * v2)
        g_1 += f * v1 * h
        f2 = f * v2
        g_0 += f2
        g_h += f2 * h
        g_x += f2 * x
        p_00 += p
        ph = p * h
        p_0h += ph
        p_hh += ph * h
        p_hx += ph * x
        px = p * x
        p_0x += px
        p_xx += px * x
        s = p_12 * h
        s_0 += s
        s_h += s * h
        s_x += s * x
        s_1 += p_11 * h * h
    store_slopes(
        mu * contact.Q, (g_1, g_0, g_h, g_x), (s_1, s_0, s_h, s_x),
        (p_00, p_0h, p_0x, p_hh, p_hx, p_xx), gradient, hessian,
    )  # fmt: skip
    return contact.Q * qv
