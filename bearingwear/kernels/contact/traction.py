"""Sums of the friction of a contact over its points: traction and its slopes (theory.md section 3).

They are those of the potential Phi by the slip coefficients c, see slip.py. The line model, one
point across, has loops of its own: over a strip's points the inner loop of the ellipse would not
vectorise. Over the ellipse the motion in time sums other points, in one loop: ellipse_friction.py.
"""

import math

from bearingwear.kernels.contact.friction import (
    force_per_slip,
    force_slope,
    quick_force_per_slip,
    quick_force_slope,
)
from bearingwear.kernels.contact.slip import point_slip
from bearingwear.kernels.decorators import ESTIMATE_ROOTS, REORDER_SUMS, inlined, jit


def strip_loops(force_per_slip, force_slope, flags, with_qv):
    """The sums of the line model by a way to take the roots; without QV this is zero."""

    @jit(fastmath=flags)
    def strip_sums(contact, c, mu, v_r, t, weight, h):
        """Gradient of Phi by c, as `ellipse_sums` has it, and QV [W]."""
        a, v_r2 = contact.a, v_r * v_r
        g_1 = g_0 = g_h = g_x = qv = 0.0
        for k in range(t.size):
            hk, x = h[k], a * t[k]
            v1, v2 = point_slip(c, hk, x)
            v_2 = v1 * v1 + v2 * v2
            f = force_per_slip(weight[k], v_2, v_r2)
            if with_qv:
                qv += weight[k] * math.sqrt(v_2)
            g_1 += f * v1 * hk
            f2 = f * v2
            g_0 += f2
            g_h += f2 * hk
            g_x += f2 * x
        s = mu * contact.Q
        return s * g_1, s * g_0, s * g_h, s * g_x, contact.Q * qv

    @jit(fastmath=flags)
    def strip_slopes(contact, c, mu, v_r, t, weight, h, gradient, hessian):
        """Gradient (4,) and second derivatives (4, 4) of Phi by c; returns QV [W]."""
        a, v_r2 = contact.a, v_r * v_r
        g_1 = g_0 = g_h = g_x = qv = 0.0
        p_00 = p_0h = p_0x = p_hh = p_hx = p_xx = 0.0
        s_0 = s_h = s_x = s_1 = 0.0
        for k in range(t.size):
            hk, x = h[k], a * t[k]
            v1, v2 = point_slip(c, hk, x)
            f, p_11, p_12, p = force_slope(weight[k], v1, v2, v_r2)
            if with_qv:
                qv += weight[k] * math.sqrt(v1 * v1 + v2 * v2)
            g_1 += f * v1 * hk
            f2 = f * v2
            g_0 += f2
            g_h += f2 * hk
            g_x += f2 * x
            p_00 += p
            ph = p * hk
            p_0h += ph
            p_hh += ph * hk
            p_hx += ph * x
            px = p * x
            p_0x += px
            p_xx += px * x
            s = p_12 * hk
            s_0 += s
            s_h += s * hk
            s_x += s * x
            s_1 += p_11 * hk * hk
        store_slopes(
            mu * contact.Q, (g_1, g_0, g_h, g_x), (s_1, s_0, s_h, s_x),
            (p_00, p_0h, p_0x, p_hh, p_hx, p_xx), gradient, hessian,
        )  # fmt: skip
        return contact.Q * qv

    return strip_sums, strip_slopes


@inlined
def store_slopes(scale, g, s, p, gradient, hessian):
    """Fill gradient and second derivatives of Phi by c from their sums.

    Parameters
    ----------
    scale : float
        Of all sums.
    g : tuple of 4 floats
        Gradient.
    s : tuple of 4 floats
        Second derivatives by c_1 and each of (c_1, c_0, c_h, c_x).
    p : tuple of 6 floats
        Those by (c_0, c_h, c_x), row by row from the diagonal.
    """
    g_1, g_0, g_h, g_x = g
    s_1, s_0, s_h, s_x = s
    p_00, p_0h, p_0x, p_hh, p_hx, p_xx = p
    gradient[0] = scale * g_1
    gradient[1] = scale * g_0
    gradient[2] = scale * g_h
    gradient[3] = scale * g_x
    hessian[0, 0] = scale * s_1
    hessian[0, 1] = hessian[1, 0] = scale * s_0
    hessian[0, 2] = hessian[2, 0] = scale * s_h
    hessian[0, 3] = hessian[3, 0] = scale * s_x
    hessian[1, 1] = scale * p_00
    hessian[1, 2] = hessian[2, 1] = scale * p_0h
    hessian[1, 3] = hessian[3, 1] = scale * p_0x
    hessian[2, 2] = scale * p_hh
    hessian[2, 3] = hessian[3, 2] = scale * p_hx
    hessian[3, 3] = scale * p_xx


@inlined
def store_traction_slopes(scale, g_t, t, gradient, hessian):
    """Fill the force along the major axis and its slopes, where there is room for them.

    Parameters
    ----------
    scale : float
        Of all sums.
    g_t : float
        Force.
    t : tuple of 5 floats
        Its derivatives by c_1, c_0, c_h, c_x and by a further slip along that axis.
    """
    if gradient.size > 4:
        t_1, t_0, t_h, t_x, t_t = t
        gradient[4] = scale * g_t
        hessian[0, 4] = hessian[4, 0] = scale * t_1
        hessian[1, 4] = hessian[4, 1] = scale * t_0
        hessian[2, 4] = hessian[4, 2] = scale * t_h
        hessian[3, 4] = hessian[4, 3] = scale * t_x
        hessian[4, 4] = scale * t_t


strip_sums, strip_slopes = strip_loops(force_per_slip, force_slope, REORDER_SUMS, with_qv=False)
"""Of the steady state: to the last bits, and no QV."""

quick_strip_sums, quick_strip_slopes = strip_loops(
    quick_force_per_slip, quick_force_slope, ESTIMATE_ROOTS, with_qv=True
)
"""Of the motion in time."""


@jit(fastmath=REORDER_SUMS)
def ellipse_sums(contact, c, mu, v_r, points):
    """Gradient of Phi by c, and QV, over the whole ellipse.

    Returns
    -------
    g_1, g_0, g_h, g_x, g_t, qv
        As in `traction`; qv in W.
    """
    t, weight, h, width, across, share = points
    a, v_r2 = contact.a, v_r * v_r
    c_1, c_0, c_h, c_x = c
    g_1 = g_0 = g_h = g_x = g_t = qv = 0.0
    for k in range(t.size):
        hk, x, y_k, w = h[k], a * t[k], width[k], weight[k]
        v2 = c_0 + c_h * hk + c_x * x
        gyroscopic, spin, v2_2 = c_1 * hk, c_x * y_k, v2 * v2
        f = f1 = f1y = v = 0.0
        for j in range(across.size):
            v1 = gyroscopic - spin * across[j]
            v_2 = v1 * v1 + v2_2
            p = force_per_slip(share[j], v_2, v_r2)
            p1 = p * v1
            f += p
            f1 += p1
            f1y += p1 * across[j]
            v += share[j] * math.sqrt(v_2)
        f2 = w * f * v2
        f1 *= w
        g_t += f1
        g_1 += f1 * hk
        g_0 += f2
        g_h += f2 * hk
        g_x += f2 * x - w * f1y * y_k
        qv += w * v
    s = mu * contact.Q
    return s * g_1, s * g_0, s * g_h, s * g_x, s * g_t, contact.Q * qv


@jit(fastmath=REORDER_SUMS)
def ellipse_slopes(contact, c, mu, v_r, points, gradient, hessian):
    """Gradient and second derivatives of Phi by c over the whole ellipse.

    Of the size 4, or 5 with the force along the major axis (see `traction`).
    """
    t, weight, h, width, across, share = points
    a, v_r2 = contact.a, v_r * v_r
    c_1, c_0, c_h, c_x = c
    g_1 = g_0 = g_h = g_x = g_t = 0.0
    p_00 = p_0h = p_0x = p_hh = p_hx = p_xx = 0.0
    s_0 = s_h = s_x = s_1 = 0.0
    t_1 = t_0 = t_x = t_t = 0.0
    for k in range(t.size):
        hk, x, y_k, w = h[k], a * t[k], width[k], weight[k]
        v2 = c_0 + c_h * hk + c_x * x
        gyroscopic, spin = c_1 * hk, c_x * y_k
        f = f1 = f1y = 0.0
        q_11 = q_11y = q_11yy = q_12 = q_12y = q_22 = 0.0
        for j in range(across.size):
            y = across[j]
            v1 = gyroscopic - spin * y
            p, p_11, p_12, p_22 = force_slope(share[j], v1, v2, v_r2)
            p1 = p * v1
            f += p
            f1 += p1
            f1y += p1 * y
            q_11 += p_11
            p_11 *= y
            q_11y += p_11
            q_11yy += p_11 * y
            q_12 += p_12
            q_12y += p_12 * y
            q_22 += p_22
        f2 = w * f * v2
        f1 *= w
        g_t += f1
        g_1 += f1 * hk
        g_0 += f2
        g_h += f2 * hk
        g_x += f2 * x - w * f1y * y_k
        q_11, q_12, q_22 = w * q_11, w * q_12, w * q_22
        w *= y_k
        q_11y, q_12y, q_11yy = w * q_11y, w * q_12y, w * y_k * q_11yy
        p_00 += q_22
        p_0h += q_22 * hk
        p_hh += q_22 * hk * hk
        by_x = q_22 * x - q_12y
        p_0x += by_x
        p_hx += by_x * hk
        p_xx += by_x * x - q_12y * x + q_11yy
        s_0 += q_12 * hk
        s_h += q_12 * hk * hk
        s_x += (q_12 * x - q_11y) * hk
        s_1 += q_11 * hk * hk
        t_t += q_11
        t_1 += q_11 * hk
        t_0 += q_12
        t_x += q_12 * x - q_11y
    scale = mu * contact.Q
    store_slopes(
        scale, (g_1, g_0, g_h, g_x), (s_1, s_0, s_h, s_x), (p_00, p_0h, p_0x, p_hh, p_hx, p_xx),
        gradient, hessian,
    )  # fmt: skip
    store_traction_slopes(scale, g_t, (t_1, t_0, s_0, t_x, t_t), gradient, hessian)


@jit
def traction(contact, c, mu, v_r, points, gradient):
    """Gradient of Phi by c: generalised friction of one contact.

    Parameters
    ----------
    c : tuple of 4 floats
        `slip_coefficients`.
    gradient : ndarray (4,) or (5,)
        Filled: sums of h F1, F2, h F2, x F2 - y F1, and F1, F the force of the race on the ball
        [N m; F1 and F2 in N].
    """
    g_t = 0.0
    if points.across.size == 1 and gradient.size == 4:
        t, weight, h = points.t, points.weight, points.h
        g_1, g_0, g_h, g_x, _ = strip_sums(contact, c, mu, v_r, t, weight, h)
    else:
        g_1, g_0, g_h, g_x, g_t, _ = ellipse_sums(contact, c, mu, v_r, points)
    gradient[0], gradient[1], gradient[2], gradient[3] = g_1, g_0, g_h, g_x
    if gradient.size > 4:
        gradient[4] = g_t


@jit
def traction_slope(contact, c, mu, v_r, points, gradient, hessian):
    """Gradient and second derivatives (both of 4 or 5) of Phi by c, as `traction`."""
    if points.across.size == 1 and gradient.size == 4:
        t, weight, h = points.t, points.weight, points.h
        strip_slopes(contact, c, mu, v_r, t, weight, h, gradient, hessian)
    else:
        ellipse_slopes(contact, c, mu, v_r, points, gradient, hessian)
