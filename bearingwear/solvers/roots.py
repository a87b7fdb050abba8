"""A root between two places, and the cubic in which it may be looked for.

Both are in SciPy, whose packages take 0.4 s to load.
"""

import math
import sys
from collections.abc import Callable

import numpy as np

_MOST = 100  # steps
RTOL = 4.0 * sys.float_info.epsilon


def brent_root(
    f: Callable[[float], float], a: float, b: float, xtol: float = 2e-12, rtol: float = RTOL
) -> float:
    """Root of a function between two places at which its signs differ, by Brent's method.

    Each number is that of `scipy.optimize.brentq`.

    ValueError: equal signs, NaN, or too many steps.
    """

    def value(x: float) -> float:
        y = float(f(x))
        if math.isnan(y):
            raise ValueError(f"the function is NaN at {x:g}")
        return y

    before, x, other = float(a), float(b), 0.0  # `other`: beyond the root, seen from x
    y_before, y, y_other = value(before), value(x), 0.0
    if y_before == 0.0 or y == 0.0:
        return before if y_before == 0.0 else x
    if (y_before > 0.0) == (y > 0.0):
        raise ValueError(f"equal signs at {a:g} and {b:g}")
    step = last_step = 0.0
    for _ in range(_MOST):
        if y_before != 0.0 and y != 0.0 and (y_before > 0.0) != (y > 0.0):
            other, y_other = before, y_before
            step = last_step = x - before
        if abs(y_other) < abs(y):
            before, x, other = x, other, x
            y_before, y, y_other = y, y_other, y
        delta, half = 0.5 * (xtol + rtol * abs(x)), 0.5 * (other - x)
        if y == 0.0 or abs(half) < delta:
            return x
        trial = math.inf
        if abs(last_step) > delta and abs(y) < abs(y_before):
            if before == other:
                trial = -y * (x - before) / (y - y_before)
            else:
                slope, slope_other = (y_before - y) / (before - x), (y_other - y) / (other - x)
                divisor = slope_other * slope * (y_other - y_before)
                if divisor != 0.0:
                    trial = -y * (y_other * slope_other - y_before * slope) / divisor
        if 2.0 * abs(trial) < min(abs(last_step), 3.0 * abs(half) - delta):
            last_step, step = step, trial
        else:
            last_step = step = half
        before, y_before = x, y
        x += step if abs(step) > delta else math.copysign(delta, half)
        y = value(x)
    raise ValueError(f"no root after {_MOST} steps between {a:g} and {b:g}")


def monotone_cubic(x: np.ndarray, y: np.ndarray, k: int) -> Callable[[float], float]:
    """Piecewise cubic through places (n,), between the numbers k and k + 1 of them.

    That of `scipy.interpolate.PchipInterpolator`: monotone where the values are.
    """
    h = np.diff(x)
    m = np.diff(y) / h

    def slope(i: int) -> float:
        if 0 < i < len(m):
            w_1, w_2 = 2.0 * h[i] + h[i - 1], h[i] + 2.0 * h[i - 1]
            return (w_1 + w_2) / (w_1 / m[i - 1] + w_2 / m[i]) if m[i - 1] * m[i] > 0.0 else 0.0
        if len(m) == 1:
            return m[0]
        end, next_one = (0, 1) if i == 0 else (-1, -2)
        found = m[end] + h[end] * (m[end] - m[next_one]) / (h[end] + h[next_one])
        if found * m[end] <= 0.0:
            return 0.0
        turns = m[end] * m[next_one] <= 0.0
        return 3.0 * m[end] if turns and abs(found) > 3.0 * abs(m[end]) else found

    d_0, d_1 = slope(k), slope(k + 1)
    c_2, c_3 = (3.0 * m[k] - 2.0 * d_0 - d_1) / h[k], (d_0 + d_1 - 2.0 * m[k]) / h[k] ** 2

    def value(place: float) -> float:
        s = place - x[k]
        return float(y[k] + s * (d_0 + s * (c_2 + s * c_3)))

    return value
