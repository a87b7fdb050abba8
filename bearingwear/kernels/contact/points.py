"""Rules for the integrals over a contact ellipse (theory.md section 3).

A rule has points along the major axis, in the middle of as many strips, and points across each
strip. One point across is the line model: slip as in the strip's middle.

A rule is either fixed points, the same for every contact, or *split*: its points along the major
axis gather, from both sides, at the pure-rolling points v2 = 0 of the contact at hand, where
friction reverses within so small a part of the ellipse that fixed points miss it. Those across
gather about v1 = 0.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.contact.profile import MIDDLE_WIDTH, PEAK, base, pressure, profile
from bearingwear.kernels.contact.slip import half_width, surface_height
from bearingwear.kernels.decorators import REORDER_SUMS, inlined, jit

EDGE = 0.5  # points across gather no nearer to the edge of the ellipse than this share
SEGMENTS = 4  # two pure-rolling points at the most, one segment on each side of each
FAR = 1.5  # a pure-rolling point at |x/a| above this is left alone


MIDDLE, WHOLE = np.zeros(1), np.ones(1)  # across: the line model


class Rule(NamedTuple):
    """Points x/a and load shares, or what they are made from; and those across.

    The root in the ellipse's width ends steeply at its tips. `tip` corrects the area of the points
    of a half, or of a segment that ends there.
    """

    split: bool
    t: np.ndarray  # (n,) points x/a; split: distances from a pure-rolling point, over 0 to 1
    weight: np.ndarray  # (n,) shares of the load; split: of the length
    tip: np.ndarray  # (n,) factors on shares of the area [1]
    across: np.ndarray = MIDDLE  # (m,) places across a strip over its half-width; split: moved
    share: np.ndarray = WHOLE  # (m,) shares of the strip's load
    even: np.ndarray = WHOLE  # (m,) shares of its area


class Points(NamedTuple):
    """The points of a contact, or buffers for them.

    With one point across, `width`, `across` and `share` keep their initial values.
    """

    t: np.ndarray  # (n,) positions x/a
    weight: np.ndarray  # (n,) shares of the load, or of the area
    h: np.ndarray  # (>= n,) heights, see slip.surface_height [m]
    width: np.ndarray  # (>= n,) half-widths of the ellipse [m]
    across: np.ndarray  # (m,) places across a strip over its half-width
    share: np.ndarray  # (m,) shares of its load, or of its area


@inlined
def most_points(rule):
    """Points a contact may get, the length of the buffers for `quadrature_points`."""
    return (SEGMENTS if rule.split else 1) * rule.t.size


@inlined
def point_buffers(rule):
    """`Points` for any contact."""
    n, m = most_points(rule), rule.across.size
    return Points(
        t=np.empty(n), weight=np.empty(n), h=np.empty(n), width=np.zeros(n), across=np.zeros(m),
        share=np.ones(m),
    )  # fmt: skip


@jit
def real_part_of_abscissa(n_r, n_i, d_r, d_i):
    """Real part of q/(1 + q^2) = n d/(n^2 + d^2) for a complex q = n/d."""
    top_r, top_i = n_r * d_r - n_i * d_i, n_r * d_i + n_i * d_r
    below_r = n_r * n_r - n_i * n_i + d_r * d_r - d_i * d_i
    below_i = 2.0 * (n_r * n_i + d_r * d_i)
    return (top_r * below_r + top_i * below_i) / (below_r * below_r + below_i * below_i)


@jit
def rolling_points(contact, R, c, v_r):
    """Where the slip along rolling is least, as real parts of complex x/a.

    With e = sqrt(v1^2 + v_r^2), the integrands are singular where v2 = i e. On the arc of the
    pressed surface, x = 2 R_d q/(1 + q^2), that is a quadratic equation in q with two roots.
    Their real parts move smoothly where two pure-rolling points meet and vanish.
    """
    c_1, c_0, c_h, c_x = c
    a = contact.a
    p = profile(contact.r_g, R, a)
    R_d, h_0 = p.R_d, base(p)
    e = math.sqrt((c_1 * (R_d + h_0)) ** 2 + v_r * v_r)
    q_0 = c_0 + c_h * (h_0 + R_d)  # and -i e, as q_2
    q_1 = c_x * R_d
    q_2 = c_0 + c_h * (h_0 - R_d)
    # The root of q_1^2 - (q_2 - i e)(q_0 - i e) on the side of q_1, so that s cannot cancel.
    D_r = q_1 * q_1 - q_2 * q_0 + e * e
    D_i = e * (q_2 + q_0)
    size = math.sqrt(D_r * D_r + D_i * D_i)
    s_r = math.copysign(math.sqrt(max(0.5 * (size + D_r), 0.0)), q_1)
    s_i = math.copysign(math.sqrt(max(0.5 * (size - D_r), 0.0)), D_i * s_r)
    s_r, s_i = -q_1 - s_r, -s_i
    scale = 2.0 * R_d / a
    return (
        scale * real_part_of_abscissa(s_r, s_i, q_2, -e),
        scale * real_part_of_abscissa(q_0, -e, s_r, s_i),
    )


@jit
def cluster_points(rule, start, end, n, t, weight, even):
    """Put the points of one segment, close together at its start; returns their new count."""
    length = end - start
    share = (MIDDLE_WIDTH if even else PEAK) * abs(length)
    for k in range(rule.t.size):
        x = start + length * rule.t[k]
        t[n + k] = x
        if even:
            tip = rule.tip[k] if abs(end) == 1.0 else 1.0
            weight[n + k] = share * rule.weight[k] * tip * math.sqrt(pressure(x))
        else:
            weight[n + k] = share * rule.weight[k] * pressure(x)
    return n + rule.t.size


@jit
def pure_rolling(contact, R, c, v_r):
    """Both pure-rolling points x/a of a contact, the lower one first, none beyond its ends.

    A point that lies far out is taken to be where the other is, and both far out in the middle.
    """
    low, high = rolling_points(contact, R, c, v_r)
    if low > high:
        low, high = high, low
    if not abs(low) < FAR:  # NaN too
        low = high
    if not abs(high) < FAR:
        high = low
    if not abs(low) < FAR:
        low = high = 0.0
    return min(max(low, -1.0), 1.0), min(max(high, -1.0), 1.0)


@jit
def fill_points(rule, contact, R, c, v_r, t, weight, even):
    """Fill the buffers of `quadrature_points`; returns how many points they have got.

    Parameters
    ----------
    even : bool
        Whether `weight` gets shares of the area, not of the load.
    """
    if not rule.split:
        for k in range(rule.t.size):
            t[k], weight[k] = rule.t[k], rule.weight[k]
            if even:
                weight[k] *= MIDDLE_WIDTH / PEAK * rule.tip[k] / math.sqrt(pressure(t[k]))
        return rule.t.size
    low, high = pure_rolling(contact, R, c, v_r)
    n = 0
    if low > -1.0:
        n = cluster_points(rule, low, -1.0, n, t, weight, even)
    if high > low:
        middle = 0.5 * (low + high)
        n = cluster_points(rule, low, middle, n, t, weight, even)
        n = cluster_points(rule, high, middle, n, t, weight, even)
    if high < 1.0:
        n = cluster_points(rule, high, 1.0, n, t, weight, even)
    return n


@inlined
def quadrature_points(rule, contact, R, c, v_r, t, weight):
    """Points x/a and load shares for a contact with the slip c.

    Written into its callers: references to arrays that a kernel returns would be counted, which
    takes four times as long as the friction of a contact.

    Parameters
    ----------
    c : tuple of 4 floats
        `contact.slip_coefficients`.
    t, weight : ndarray (most_points(rule),)
        Buffers, filled by a split rule.

    Returns
    -------
    t, weight : ndarray (n,)
        Parts of the buffers, or those of fixed points.
    """
    n = fill_points(rule, contact, R, c, v_r, t, weight, False) if rule.split else 0
    points = t[:n] if rule.split else rule.t
    shares = weight[:n] if rule.split else rule.weight
    return points, shares


@jit
def middle_shift(contact, R, c):
    """How far, over the half-width, the middle of the places across is carried: see below."""
    e = c[0] * R / (c[3] * contact.b)
    return e if abs(e) < EDGE else math.copysign(EDGE, e)  # NaN too


@jit
def place_across(rule, contact, R, c, across, share, even):
    """Places across the strips of a contact with the slip c, and their shares of a strip's load.

    A split rule moves its own by a Moebius map, which keeps both edges and carries the middle,
    about which they lie, to where slip along the major axis turns round, c_1 h = c_x y.

    Parameters
    ----------
    across, share : ndarray (rule.across.size,)
        Filled.
    even : bool
        Whether `share` gets shares of the strip's area, not of its load.
    """
    e = 0.0
    if rule.split and across.size > 1:
        e = middle_shift(contact, R, c)
    for j in range(across.size):
        y = rule.across[j]
        by = 1.0 / (1.0 + e * y)
        across[j] = (y + e) * by
        share[j] = rule.even[j] * by * by if even else rule.share[j] * by * by * by
    scale = 1.0 / share_sum(share)
    for j in range(across.size):
        share[j] *= scale


@jit(fastmath=REORDER_SUMS)
def share_sum(share):
    """Sum of the shares, apart from the loop that writes them: see `REORDER_SUMS`."""
    found = 0.0
    for part in share:
        found += part
    return found


@jit
def fill_contact_points(rule, contact, R, c, v_r, p):
    """Fill the buffers of `contact_points`; returns how many points there are."""
    n = fill_points(rule, contact, R, c, v_r, p.t, p.weight, False)
    surface_height(contact, R, p.t[:n], p.h)
    if p.across.size > 1:
        place_across(rule, contact, R, c, p.across, p.share, False)
        half_width(contact, p.t[:n], p.width)
    return n


@inlined
def contact_points(rule, contact, R, c, v_r, buffers):
    """`Points` of a contact with the slip c, in buffers."""
    n = fill_contact_points(rule, contact, R, c, v_r, buffers)
    return Points(
        t=buffers.t[:n], weight=buffers.weight[:n], h=buffers.h, width=buffers.width,
        across=buffers.across, share=buffers.share,
    )  # fmt: skip


@jit
def area_shares(rule, contact, R, c, v_r, p):
    """Put shares of the area in place of those of the load."""
    fill_points(rule, contact, R, c, v_r, p.t, p.weight, True)
    if p.across.size > 1:
        place_across(rule, contact, R, c, p.across, p.share, True)
