"""Root of a function of one variable. SciPy's takes 0.4 s to load, a third of a short command."""

import math
import sys
from collections.abc import Callable

_MOST = 100  # steps
_ROUNDING = 4.0 * sys.float_info.epsilon


def brent_root(
    f: Callable[[float], float], a: float, b: float, xtol: float = 2e-12, rtol: float = _ROUNDING
) -> float:
    """Root between two places at which the signs differ; each number of `scipy.optimize.brentq`.

    ValueError: equal signs, NaN, or too many steps.
    """
    before, x, other = float(a), float(b), 0.0  # `other`: beyond the root, seen from x
    y_before, y, y_other = float(f(before)), float(f(x)), 0.0
    step = last = 0.0
    if y_before == 0.0:
        return before
    if y != 0.0 and (y_before > 0.0) == (y > 0.0):
        raise ValueError(f"equal signs at {a:g} and {b:g}")
    for _ in range(_MOST):
        if math.isnan(y_before + y):
            break
        if y != 0.0 and (y_before > 0.0) != (y > 0.0):
            other, y_other, step, last = before, y_before, x - before, x - before
        if abs(y_other) < abs(y):
            before, x, other = x, other, x
            y_before, y, y_other = y, y_other, y
        least, half, trial = 0.5 * (xtol + rtol * abs(x)), 0.5 * (other - x), math.inf
        if y == 0.0 or abs(half) < least:
            return x
        if abs(last) > least and abs(y) < abs(y_before):
            if before == other:  # a secant, else a parabola
                trial = -y * (x - before) / (y - y_before)
            else:
                slope, slope_other = (y_before - y) / (before - x), (y_other - y) / (other - x)
                if divisor := slope_other * slope * (y_other - y_before):
                    trial = -y * (y_other * slope_other - y_before * slope) / divisor
        if 2.0 * abs(trial) < min(abs(last), 3.0 * abs(half) - least):
            last, step = step, trial
        else:
            last = step = half
        before, y_before = x, y
        x += step if abs(step) > least else math.copysign(least, half)
        y = float(f(x))
    raise ValueError(f"no root between {a:g} and {b:g}")
