"""The posterior of the friction coefficient mu and of K_s/H after tests, by quadrature.

The unknowns are x = ln mu and y = ln k, k the K_s/H of the batch over that of the scene. Both are
normal before the tests. A test saw s, the logarithm of a life or of a torque, for which the model
has m(x) - y (wear) or m(x) (torque); its bearing differs from the median one by a normal deviate.

Theory: docs/theory.md, section 24.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.special import log_ndtr, ndtr

LogModel = Callable[[np.ndarray], np.ndarray]
"""Logarithm of the median bearing's life or torque by x, with the K_s/H of the scene."""

_FRICTIONS, _WEARS = 161, 801
"""Points of the grid along x and y."""

_WIDE = 7.0
"""Half the width of the grid before the tests are seen, in standard deviations."""

_SPACING = 0.3  # of the first grid along y, over the least scatter
_NEGLIGIBLE = 1e-16  # share of the largest density below which the grid ends


class Normal(NamedTuple):
    """A normal distribution; a known value has a deviation of zero."""

    mean: float
    deviation: float


class Conformity(NamedTuple):
    """Agreement of a test with the model and other tests."""

    probability: float  # of a result at least as far from the model, or of the run-out
    factor: float  # the result over that of the median bearing in the model


class Prior(NamedTuple):
    """Prior density of x and y."""

    x: Normal
    y: Normal
    correlation: float = 0.0

    def log_density(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Returns the log density on a grid (x, y), up to a constant."""
        u, v = (
            (values - normal.mean) / normal.deviation if normal.deviation else 0.0 * values
            for normal, values in ((self.x, x[:, None]), (self.y, y[None, :]))
        )
        rho = self.correlation
        return -0.5 * (u * u - 2.0 * rho * u * v + v * v) / (1.0 - rho * rho)


@dataclass(frozen=True, kw_only=True)
class Observation:
    """The logarithm of the result of one or several bearings."""

    seen: float
    model: LogModel
    scatter: float  # standard deviation between bearings, with that of the measurement
    of_wear: bool = True  # a life, or a loss as the time it took; else a torque
    censored: bool = False  # it had not ended by then
    count: int = 1  # number of bearings with the same result

    def deviate(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Returns measured less predicted value (x, y), in standard deviations."""
        shift = y[None, :] if self.of_wear else 0.0 * y[None, :]
        return (self.seen - self.model(x)[:, None] + shift) / self.scatter

    def log_likelihood(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Returns the log likelihood of one such bearing (x, y)."""
        z = self.deviate(x, y)
        return log_ndtr(-z) if self.censored else -0.5 * z * z


@dataclass(frozen=True)
class Posterior:
    """Shares of probability on a grid of x and y."""

    x: np.ndarray  # (n,)
    y: np.ndarray  # (m,)
    # (n, m) of y, times the share of each x: its integral over y and sum over x is 1
    density: np.ndarray
    _integral: CubicSpline = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        spline = CubicSpline(self.y, self.density, axis=1).antiderivative()
        object.__setattr__(self, "_integral", spline)

    @property
    def shares(self) -> np.ndarray:
        """Returns the weight of each point of the grid (n, m); their sum is 1."""
        step = self.y[1] - self.y[0]
        return self.density * step

    def mean(self, values: np.ndarray) -> float:
        """Returns the mean of a function given on the grid, (n, 1), (1, m) or (n, m)."""
        return float((self.shares * values).sum())

    def normal(self, axis: str) -> Normal:
        """Returns mean and standard deviation of x or y."""
        axis_values = self.x[:, None] if axis == "x" else self.y[None, :]
        mean = self.mean(axis_values)
        return Normal(mean, float(np.sqrt(max(self.mean((axis_values - mean) ** 2), 0.0))))

    def ends(self, axis: str, probabilities: Sequence[float]) -> list[float]:
        """Returns quantiles of x or y."""
        grid = self.x if axis == "x" else self.y
        if len(grid) == 1:
            return [float(grid[0])] * len(probabilities)
        density = self.shares.sum(axis=1 if axis == "x" else 0)
        below = CubicSpline(grid, density).antiderivative()
        total, limits = float(below(grid[-1])), (grid[0], grid[-1])
        return [
            float(
                brentq(lambda v, share=share: float(below(v)) - share * total, *limits, xtol=1e-13)
            )
            for share in probabilities
        ]

    def correlation(self) -> float:
        """Returns the correlation of x and y; zero if one of them is known."""
        x, y = self.normal("x"), self.normal("y")
        if 0.0 in (x.deviation, y.deviation):
            return 0.0
        product = (self.x[:, None] - x.mean) * (self.y[None, :] - y.mean)
        return self.mean(product) / (x.deviation * y.deviation)

    def below(self, model: LogModel, value: float) -> float:
        """Returns the probability that the median bearing's life, m(x) - y, is below exp(value)."""
        lower_limit = np.clip(model(self.x) - value, self.y[0], self.y[-1])
        spline = self._integral
        piece = np.clip(np.searchsorted(spline.x, lower_limit) - 1, 0, len(spline.x) - 2)
        offset, rows = lower_limit - spline.x[piece], np.arange(len(self.x))
        integral = np.zeros(len(rows))
        for coefficient in spline.c[:, piece, rows]:
            integral = integral * offset + coefficient
        return float(1.0 - integral.sum())

    def median_quantile(self, model: LogModel, probability: float, deviates: float = 0.0) -> float:
        """Returns a quantile over batches of a quantile over their bearings.

        deviates: logarithm of that quantile over the bearings, less that of their median.
        """
        m = model(self.x)
        ends = float(m.min() - self.y[-1]) - 1.0, float(m.max() - self.y[0]) + 1.0
        log_quantile = brentq(
            lambda value: self.below(model, value) - probability, *ends, xtol=1e-13
        )
        return float(np.exp(log_quantile + deviates))

    def quantile(
        self, model: LogModel, probability: float, scatter: float, of_wear: bool = True
    ) -> float:
        """Returns a quantile of a bearing's life or torque, over batches and their scatter."""
        mean = model(self.x)[:, None] - (self.y[None, :] if of_wear else 0.0 * self.y[None, :])
        wide = 9.0 * scatter + 1.0

        def excess(value: float) -> float:
            return float((self.shares * ndtr((value - mean) / scatter)).sum()) - probability

        ends = float(mean.min()) - wide, float(mean.max()) + wide
        return float(np.exp(brentq(excess, *ends, xtol=1e-13)))

    def failed_share(self, model: LogModel, life: float, scatter: float) -> float:
        """Returns the share of bearings that have failed by a life, over batches and scatter."""
        mean = model(self.x)[:, None] - self.y[None, :]
        return float((self.shares * ndtr((math.log(life) - mean) / scatter)).sum())

    def conformity(self, test: Observation) -> Conformity:
        """Returns how a test that is not part of the posterior conforms to it."""
        z = test.deviate(self.x, self.y)
        above = float((self.shares * ndtr(-z)).sum())
        probability = above if test.censored else 2.0 * min(above, 1.0 - above)
        return Conformity(probability, math.exp(test.scatter * self.mean(z)))


def posterior(prior: Prior, tests: Sequence[Observation]) -> Posterior:
    """Returns the posterior of x and y, which are normal before the tests.

    The first grid spans the prior, the second one the posterior on the first.
    """
    x, y, _ = prior
    least_scatter = (
        min((test.scatter for test in tests), default=y.deviation) if y.deviation else 1.0
    )
    fine_points = int(2.0 * _WIDE * y.deviation / (_SPACING * least_scatter)) + 1
    grids = _axis(x, _WIDE, _FRICTIONS), _axis(y, _WIDE, max(_WEARS, fine_points))
    for _ in range(2):
        log = prior.log_density(*grids)
        for test in tests:
            log = log + test.count * test.log_likelihood(*grids)
        density = np.exp(log - log.max())
        result = Posterior(*grids, density / (density.sum() * (grids[1][1] - grids[1][0])))
        grids = (
            _dense_part(grids[0], density.max(axis=1), _FRICTIONS),
            _dense_part(grids[1], density.max(axis=0), _WEARS),
        )
    return result


def conformities(prior: Prior, tests: Sequence[Observation]) -> list[Conformity]:
    """Returns how each test conforms to the others alone."""
    results = []
    for k, test in enumerate(tests):
        rest = [*tests[:k], *tests[k + 1 :]]
        if test.count > 1:
            rest.append(replace(test, count=test.count - 1))
        results.append(posterior(prior, rest).conformity(test))
    return results


def _axis(normal: Normal, wide: float, points: int) -> np.ndarray:
    """Returns points within `wide` standard deviations of the mean."""
    half = wide * normal.deviation
    if half == 0.0:
        return np.array([normal.mean])
    return np.linspace(normal.mean - half, normal.mean + half, points)


def _dense_part(grid: np.ndarray, density: np.ndarray, points: int) -> np.ndarray:
    """Returns new points over the part of a grid with some density."""
    if len(grid) == 1:
        return grid
    dense = np.flatnonzero(density > _NEGLIGIBLE * density.max())
    first, last = max(dense[0] - 1, 0), min(dense[-1] + 1, len(grid) - 1)
    return np.linspace(grid[first], grid[last], points)
