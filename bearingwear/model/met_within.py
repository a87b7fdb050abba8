"""Criteria met within a step of SciPy's Runge-Kutta method, which integrates wear lives."""

from collections.abc import Callable

import numpy as np
from scipy.integrate import RK45
from scipy.optimize import brentq

from bearingwear.model.life_integrator import ROOT, Unsolved


def within(solver: RK45, s: float) -> np.ndarray:
    """The vector within the last step, at its end as it was solved."""
    return solver.y if s == solver.t else solver.dense_output()(s)


def first_crossing(
    solver: RK45, margin: Callable[[np.ndarray], np.ndarray]
) -> tuple[float, int] | None:
    """Where the first margin falls to zero in the last step, and which; checks its middle too.

    A solve that fails in between counts as met there. Raises `Unsolved` if one fails at the ends
    or in the middle.
    """
    a, middle = solver.t_old, solver.t_old + 0.5 * (solver.t - solver.t_old)
    for b in (middle, solver.t):
        before, after = (margin(within(solver, s)) for s in (a, b))
        roots = []
        for k in np.flatnonzero((after <= 0.0) & (before > 0.0)):

            def value(s: float, k: int = int(k)) -> float:
                try:
                    return float(margin(within(solver, s))[k])
                except Unsolved:
                    return -1.0

            root = brentq(value, a, b, xtol=ROOT * (b - a), rtol=1e-15)
            roots.append((float(root), int(k)))
        if roots:
            return min(roots)
        a = b
    return None


def at_end(solver: RK45) -> np.ndarray:
    """The vector where a solver's range ends, solved up to there."""
    while solver.status == "running":
        solver.step()
    return solver.y.copy()
