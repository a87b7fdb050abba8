"""SciPy's root finder, loaded when a root is sought: it takes 0.4 s, and many solves need none."""

from collections.abc import Callable


def brent_root(f: Callable[[float], float], a: float, b: float, **tolerances: float) -> float:
    """Returns the root of a function between two places at which its signs differ.

    Raises ValueError if the signs agree.

    tolerances: `xtol` and `rtol` of `scipy.optimize.brentq`.
    """
    from scipy.optimize import brentq

    return float(brentq(f, a, b, **tolerances))
