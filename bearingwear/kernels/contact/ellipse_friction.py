"""Friction over a contact ellipse as the motion in time sums it (theory.md section 3).

Point by point in one loop, which no strip interrupts: the points of all segments, from a
pure-rolling point to the end or to the middle between two, follow each other in memory.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.contact.friction import quick_force_per_slip, quick_force_slope
from bearingwear.kernels.contact.points import SEGMENTS, middle_shift, pure_rolling
from bearingwear.kernels.contact.profile import base, pressure, profile
from bearingwear.kernels.contact.traction import store_slopes, store_traction_slopes
from bearingwear.kernels.decorators import ESTIMATE_ROOTS, inlined, jit

X_OVER_A, LOAD_SHARE, Y_OVER_B = range(3)  # of `Places`
AT_TIP = 1e-9  # x/a of a segment's end less than that from the tip of the ellipse is there


class EllipsePoints(NamedTuple):
    """Points over a contact ellipse one by one; of a split rule, those of one segment."""

    split: bool
    s: np.ndarray  # (n,) x/a; split: distances from a pure-rolling point, over 0 to 1
    weight: np.ndarray  # (n,) shares of the load over `pressure`; split: for the length 1
    y: np.ndarray  # (n,) places across over the half-width
    moved: np.ndarray  # (n,) 1 where these gather about v1 = 0, else 0
    area: np.ndarray  # (n,) shares of the area over the root of `pressure`, as `weight` has them
    tip: np.ndarray  # (n,) factors on `area`, as in ellipse.Rule


class Places(NamedTuple):
    """Buffers: the points of a contact, segment after segment. Both are the same memory.

    Along the first axis: x/a, share of the load over `pressure`, y over the half-width. After the
    last segment comes one of the length 1, which the others are copied from.
    """

    segments: np.ndarray  # (3, SEGMENTS + 1, n)
    flat: np.ndarray  # (3, (SEGMENTS + 1) n)


def places(points):
    """Buffers for points spread."""
    segments = np.zeros((3, SEGMENTS + 1, points.s.size))
    return Places(segments, segments.reshape(3, -1))


class PressedSurface(NamedTuple):
    """What a point of a contact needs of it."""

    a: float  # semi-axes [m]
    b: float
    R_d2: float  # see profile.Profile [m2]
    base: float  # see profile.base [m]


@jit(forceinline=True)
def place_segment(points, i, start, length, segments):
    """Put the points of segment i."""
    share = abs(length)
    for p in range(points.s.size):
        segments[X_OVER_A, i, p] = start + length * points.s[p]
        segments[LOAD_SHARE, i, p] = share * segments[LOAD_SHARE, SEGMENTS, p]
        segments[Y_OVER_B, i, p] = segments[Y_OVER_B, SEGMENTS, p]


@jit
def place_areas(points, contact, R, c, n, segments):
    """Put shares of the area in place of those of the load of the n points that are placed."""
    e = middle_shift(contact, R, c)
    for p in range(points.s.size):
        by = e * points.moved[p]
        scale = 1.0 / (1.0 + by * points.y[p])
        segments[LOAD_SHARE, SEGMENTS, p] = points.area[p] * (1.0 - by * by) * scale * scale
    last = points.s.size - 1
    for i in range(n // points.s.size):
        length, ends = 1.0, True
        if points.split:
            length = segments[X_OVER_A, i, last] - segments[X_OVER_A, i, 0]
            length /= points.s[last] - points.s[0]
            end = segments[X_OVER_A, i, last] + length * (1.0 - points.s[last])
            ends = abs(end) > 1.0 - AT_TIP
        for p in range(points.s.size):
            share = abs(length) * segments[LOAD_SHARE, SEGMENTS, p]
            root = math.sqrt(pressure(segments[X_OVER_A, i, p]))
            segments[LOAD_SHARE, i, p] = share * (points.tip[p] if ends else 1.0) / root


@jit(fastmath=ESTIMATE_ROOTS, forceinline=True)
def place_moved(points, e, segments):
    """Fill places across and loads of a segment of length 1.

    Points about v1 = 0 are moved as by `ellipse.place_across`.

    Parameters
    ----------
    e : float
        `ellipse.middle_shift`.
    """
    kept = math.sqrt(1.0 - e * e)
    whole = kept * kept * kept - 1.0  # the map divides the load of a strip by the cube of that
    for p in range(points.s.size):
        by = e * points.moved[p]
        scale = 1.0 / (1.0 + by * points.y[p])
        segments[Y_OVER_B, SEGMENTS, p] = (points.y[p] + by) * scale
        load = points.weight[p] * scale * scale * scale
        segments[LOAD_SHARE, SEGMENTS, p] = load + load * points.moved[p] * whole


@jit
def place_points(points, contact, R, c, v_r, segments):
    """Place the points of a contact; returns how many there are."""
    place_moved(points, middle_shift(contact, R, c), segments)
    if not points.split:
        place_segment(points, 0, 0.0, 1.0, segments)
        return points.s.size
    low, high = pure_rolling(contact, R, c, v_r)
    middle, i = 0.5 * (low + high), 0
    if low > -1.0:
        place_segment(points, i, low, -1.0 - low, segments)
        i += 1
    if high > low:
        place_segment(points, i, low, middle - low, segments)
        place_segment(points, i + 1, high, middle - high, segments)
        i += 2
    if high < 1.0:
        place_segment(points, i, high, 1.0 - high, segments)
        i += 1
    return i * points.s.size


@inlined
def point_at(surface, t, load, across):
    """x, y, height [m] and load share of a point."""
    q = pressure(t)
    x = surface.a * t
    h = surface.base + math.sqrt(surface.R_d2 - x * x)
    return x, surface.b * across * math.sqrt(q), h, load * q


@jit(fastmath=ESTIMATE_ROOTS)
def point_sums(surface, c, v_r2, flat, n):
    """`ellipse_friction` without its scales."""
    c_1, c_0, c_h, c_x = c
    g_1 = g_0 = g_h = g_x = g_t = qv = 0.0
    for p in range(n):
        x, y, h, w = point_at(surface, flat[X_OVER_A, p], flat[LOAD_SHARE, p], flat[Y_OVER_B, p])
        v1, v2 = c_1 * h - c_x * y, c_0 + c_h * h + c_x * x
        v_2 = v1 * v1 + v2 * v2
        f = quick_force_per_slip(w, v_2, v_r2)
        f1, f2 = f * v1, f * v2
        g_t += f1
        g_1 += f1 * h
        g_0 += f2
        g_h += f2 * h
        g_x += f2 * x - f1 * y
        qv += w * math.sqrt(v_2)
    return g_1, g_0, g_h, g_x, g_t, qv


@jit(fastmath=ESTIMATE_ROOTS)
def point_slopes(surface, c, v_r2, flat, n, scale, gradient, hessian):
    """Gradient (4 or 5) and second derivatives of Phi by c; returns as `point_sums`."""
    c_1, c_0, c_h, c_x = c
    g_1 = g_0 = g_h = g_x = g_t = qv = 0.0
    p_00 = p_0h = p_0x = p_hh = p_hx = p_xx = 0.0
    s_0 = s_h = s_x = s_1 = 0.0
    t_1 = t_0 = t_x = t_t = 0.0
    for p in range(n):
        x, y, h, w = point_at(surface, flat[X_OVER_A, p], flat[LOAD_SHARE, p], flat[Y_OVER_B, p])
        v1, v2 = c_1 * h - c_x * y, c_0 + c_h * h + c_x * x
        f, p_11, p_12, p_22 = quick_force_slope(w, v1, v2, v_r2)
        f1, f2 = f * v1, f * v2
        g_t += f1
        g_1 += f1 * h
        g_0 += f2
        g_h += f2 * h
        g_x += f2 * x - f1 * y
        qv += w * math.sqrt(v1 * v1 + v2 * v2)
        # By the spin c_x, which moves a point along both axes.
        by_1, by_2 = p_12 * x - p_11 * y, p_22 * x - p_12 * y
        p_00 += p_22
        p_0h += p_22 * h
        p_hh += p_22 * h * h
        p_0x += by_2
        p_hx += by_2 * h
        p_xx += by_2 * x - by_1 * y
        s_0 += p_12 * h
        s_h += p_12 * h * h
        s_x += by_1 * h
        s_1 += p_11 * h * h
        t_t += p_11
        t_1 += p_11 * h
        t_0 += p_12
        t_x += by_1
    store_slopes(
        scale, (g_1, g_0, g_h, g_x), (s_1, s_0, s_h, s_x), (p_00, p_0h, p_0x, p_hh, p_hx, p_xx),
        gradient, hessian,
    )  # fmt: skip
    store_traction_slopes(scale, g_t, (t_1, t_0, s_0, t_x, t_t), gradient, hessian)
    return g_1, g_0, g_h, g_x, g_t, qv


@jit
def ellipse_friction(points, contact, R, c, v_r, even, slopes, buffers, gradient, hessian):
    """Gradient of Phi by the slip coefficients c, force along the major axis, and QV.

    Parameters
    ----------
    even : bool
        Whether the even part of a film's friction is summed, not the part that follows the load;
        QV is of no use then.
    slopes : bool
        Whether `gradient` and `hessian` (of 4 or 5) are filled too, as by
        `traction.traction_slope`.

    Returns
    -------
    g_1, g_0, g_h, g_x, g_t, qv
        As `traction.ellipse_sums`.
    """
    n = place_points(points, contact, R, c, v_r, buffers.segments)
    mu = contact.mu - contact.mu_even
    if even:
        mu = contact.mu_even
        place_areas(points, contact, R, c, n, buffers.segments)
    p_R = profile(contact.r_g, R, contact.a)
    surface = PressedSurface(a=contact.a, b=contact.b, R_d2=p_R.R_d * p_R.R_d, base=base(p_R))
    s, v_r2 = mu * contact.Q, v_r * v_r
    if slopes:
        g_1, g_0, g_h, g_x, g_t, qv = point_slopes(
            surface, c, v_r2, buffers.flat, n, s, gradient, hessian
        )
    else:
        g_1, g_0, g_h, g_x, g_t, qv = point_sums(surface, c, v_r2, buffers.flat, n)
    return s * g_1, s * g_0, s * g_h, s * g_x, s * g_t, contact.Q * qv
