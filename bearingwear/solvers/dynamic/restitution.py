"""Damping for a stated coefficient of restitution, without tension as bodies separate."""

import math
from functools import lru_cache

from scipy.integrate import solve_ivp
from scipy.optimize import brentq

LARGEST_LAND, LARGEST_POCKET = 0.99, 3.0  # damping at which an impact returns hardly anything


def land_restitution(ratio: float) -> float:
    """Restitution of a spring and a dashpot of that critical-damping ratio below 1.

    delta'' + 2 ratio delta' + delta = 0 from delta = 0, delta' = 1 to where the force ends.
    """
    w = math.sqrt(1.0 - ratio**2)
    end = (math.pi - math.atan2(2.0 * ratio * w, 1.0 - 2.0 * ratio**2)) / w
    speed = math.cos(w * end) - ratio / w * math.sin(w * end)
    return -math.exp(-ratio * end) * speed


def pocket_restitution(damping: float) -> float:
    """Restitution of a Hertz contact: delta'' + damping delta^(1/4) delta' + delta^(3/2) = 0.

    From delta = 0, delta' = 1 to where the force ends.
    """

    def rates(_, y):
        d = max(y[0], 0.0)
        return y[1], -damping * d**0.25 * y[1] - d**1.5

    def pull(_, y):
        d = max(y[0], 0.0)
        return damping * y[1] + d**1.25  # the force over delta^(1/4)

    setattr(pull, "terminal", True)  # noqa: B010
    setattr(pull, "direction", -1.0)  # noqa: B010
    path = solve_ivp(rates, (0.0, 50.0), (0.0, 1.0), events=pull, rtol=1e-9, atol=1e-12)
    return -path.y[1, -1]


@lru_cache
def land_damping(restitution: float) -> float:
    """Critical-damping ratio of a land for a coefficient of restitution."""
    return _damping(land_restitution, restitution, LARGEST_LAND)


@lru_cache
def pocket_damping(restitution: float) -> float:
    """Damping of `pocket_restitution` for a coefficient of restitution."""
    return _damping(pocket_restitution, restitution, LARGEST_POCKET)


def _damping(law, restitution: float, largest: float) -> float:
    if restitution >= 1.0:
        return 0.0
    if restitution <= law(largest):
        return largest
    return brentq(lambda damping: law(damping) - restitution, 0.0, largest, xtol=1e-9)
