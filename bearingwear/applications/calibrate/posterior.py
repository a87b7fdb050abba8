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
_TOLERANCE = 1e-13  # of logarithms that roots determine; lives are then exact to twelve digits
_CERTAIN = 9.0  # standard deviations, within which all of a normal distribution lies
_BRACKET_MARGIN = 1.0  # beyond all possible logarithms, so that a bracket contains the root


class Normal(NamedTuple):
    """A normal distribution; a known value has a standard deviation of zero."""

    mean: float
    deviation: float

    def deviates(self, values: np.ndarray) -> np.ndarray:
        """Returns the distances of values from the mean in standard deviations; 0 if known."""
        if self.deviation == 0.0:
            return np.zeros_like(values)
        return (values - self.mean) / self.deviation


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
        u, v = self.x.deviates(x)[:, None], self.y.deviates(y)[None, :]
        rho = self.correlation
        return -0.5 * (u * u - 2.0 * rho * u * v + v * v) / (1.0 - rho * rho)


@dataclass(frozen=True, kw_only=True)
class Observation:
    """The logarithm of the result of one or several bearings."""

    seen: float  # of the result [h] or [N m]
    model: LogModel  # of the same result
    scatter: float  # standard deviation between bearings, with that of the measurement
    depends_on_wear: bool = True  # a life, or the time to a loss; otherwise a torque
    censored: bool = False  # the run had not ended at the time `seen`
    count: int = 1  # number of bearings with the same result

    def deviate(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Returns measured less predicted value on a grid (x, y), in standard deviations."""
        wear = y if self.depends_on_wear else np.zeros_like(y)
        return (self.seen - self.model(x)[:, None] + wear[None, :]) / self.scatter

    def log_likelihood(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Returns the log likelihood of one such bearing on a grid (x, y), up to a constant.

        That of a run that had not ended is the probability of a longer life.
        """
        z = self.deviate(x, y)
        return log_ndtr(-z) if self.censored else -0.5 * z * z


def _predicted(model: LogModel, x: np.ndarray, y: np.ndarray, depends_on_wear: bool) -> np.ndarray:
    """Returns the logarithm of the median bearing's life or torque on a grid (x, y).

    depends_on_wear: false for a torque.
    """
    wear = y if depends_on_wear else np.zeros_like(y)
    return model(x)[:, None] - wear[None, :]


@dataclass(frozen=True)
class Posterior:
    """The joint distribution of x and y on a grid; y is continuous, x has weights at its points."""

    x: np.ndarray  # (n,)
    y: np.ndarray  # (m,), evenly spaced
    density: np.ndarray  # of y at each x (n, m); summed over x and integrated over y it is 1
    _integral: CubicSpline = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        spline = CubicSpline(self.y, self.density, axis=1).antiderivative()
        object.__setattr__(self, "_integral", spline)

    @property
    def shares(self) -> np.ndarray:
        """Returns the weight of each point of the grid (n, m); their sum is 1."""
        step = self.y[1] - self.y[0]
        return self.density * step

    def expectation(self, values: np.ndarray) -> float:
        """Returns the expectation of a function of x and y.

        values: of the function on the grid, (n, 1), (1, m) or (n, m).
        """
        return float((self.shares * values).sum())

    def normal(self, axis: str) -> Normal:
        """Returns mean and standard deviation of the axis `x` or `y`."""
        axis_values = self.x[:, None] if axis == "x" else self.y[None, :]
        mean = self.expectation(axis_values)
        variance = max(self.expectation((axis_values - mean) ** 2), 0.0)
        return Normal(mean, math.sqrt(variance))

    def axis_quantiles(self, axis: str, probabilities: Sequence[float]) -> list[float]:
        """Returns the quantiles of the axis `x` or `y` at some probabilities.

        All are the value itself if it is known.
        """
        grid = self.x if axis == "x" else self.y
        if len(grid) == 1:
            return [float(grid[0])] * len(probabilities)
        density = self.shares.sum(axis=1 if axis == "x" else 0)
        distribution = CubicSpline(grid, density).antiderivative()
        total = float(distribution(grid[-1]))

        def axis_quantile(probability: float) -> float:
            """Returns the value below which a share of the distribution lies."""

            def excess(value: float) -> float:
                """Returns the distribution at a value, less the wanted share of its total."""
                return float(distribution(value)) - probability * total

            return float(brentq(excess, grid[0], grid[-1], xtol=_TOLERANCE))

        return [axis_quantile(probability) for probability in probabilities]

    def correlation(self) -> float:
        """Returns the correlation of x and y; zero if one of them is known."""
        x, y = self.normal("x"), self.normal("y")
        if 0.0 in (x.deviation, y.deviation):
            return 0.0
        product = (self.x[:, None] - x.mean) * (self.y[None, :] - y.mean)
        return self.expectation(product) / (x.deviation * y.deviation)

    def share_of_medians_below(self, model: LogModel, value: float) -> float:
        """Returns the probability that the median life of a batch is below exp(value).

        Its logarithm is m(x) - y, so y has to be above m(x) - value.

        model: m(x).
        """
        lower_limit = np.clip(model(self.x) - value, self.y[0], self.y[-1])
        spline = self._integral
        # each row of the grid is integrated up to a limit of its own, by Horner's method
        piece = np.clip(np.searchsorted(spline.x, lower_limit) - 1, 0, len(spline.x) - 2)
        offset, rows = lower_limit - spline.x[piece], np.arange(len(self.x))
        integral = np.zeros(len(rows))
        for coefficient in spline.c[:, piece, rows]:
            integral = integral * offset + coefficient
        return float(1.0 - integral.sum())

    def median_quantile(self, model: LogModel, probability: float, deviates: float = 0.0) -> float:
        """Returns a quantile over batches of a quantile over their bearings.

        The life is in the unit of the model.

        probability: of a batch with a lower life.
        deviates: logarithm of the quantile over the bearings, less that of their median.
        """
        log_medians = model(self.x)
        low = float(log_medians.min() - self.y[-1]) - _BRACKET_MARGIN
        high = float(log_medians.max() - self.y[0]) + _BRACKET_MARGIN

        def excess(value: float) -> float:
            """Returns the share of batches with a lower log life, less the wanted one."""
            return self.share_of_medians_below(model, value) - probability

        return float(np.exp(brentq(excess, low, high, xtol=_TOLERANCE) + deviates))

    def quantile(
        self, model: LogModel, probability: float, scatter: float, depends_on_wear: bool = True
    ) -> float:
        """Returns a quantile of a bearing's life or torque, over batches and their scatter.

        It is in the unit of the model.

        scatter: standard deviation of the logarithm within a batch, above 0.
        depends_on_wear: false for a torque.
        """
        medians = _predicted(model, self.x, self.y, depends_on_wear)
        reach = _CERTAIN * scatter + _BRACKET_MARGIN

        def excess(value: float) -> float:
            """Returns the share of bearings with a lower logarithm, less the wanted one."""
            return float((self.shares * ndtr((value - medians) / scatter)).sum()) - probability

        low, high = float(medians.min()) - reach, float(medians.max()) + reach
        return float(np.exp(brentq(excess, low, high, xtol=_TOLERANCE)))

    def failed_share(self, model: LogModel, life: float, scatter: float) -> float:
        """Returns the share of bearings with a shorter life, over batches and their scatter.

        life: in the unit of the model.
        scatter: standard deviation of the logarithm within a batch, above 0.
        """
        medians = _predicted(model, self.x, self.y, depends_on_wear=True)
        return float((self.shares * ndtr((math.log(life) - medians) / scatter)).sum())

    def conformity(self, test: Observation) -> Conformity:
        """Returns how well a test agrees with this distribution.

        The probability is two-sided; of a run that had not ended, it is that of a longer life.

        test: one that this posterior does not use.
        """
        z = test.deviate(self.x, self.y)
        share_above = float((self.shares * ndtr(-z)).sum())
        if test.censored:
            probability = share_above
        else:
            probability = 2.0 * min(share_above, 1.0 - share_above)
        return Conformity(probability, math.exp(test.scatter * self.expectation(z)))


def posterior(prior: Prior, tests: Sequence[Observation]) -> Posterior:
    """Returns the posterior of x and y; without tests it is the prior.

    Its grid spans the part of a wider one on which the density is not negligible. The latter spans
    the prior, with points that are close enough for the scatter of the tests.
    """
    wear_points = _WEARS
    if tests and prior.y.deviation:
        least_scatter = min(test.scatter for test in tests)
        fine_points = int(2.0 * _WIDE * prior.y.deviation / (_SPACING * least_scatter)) + 1
        wear_points = max(_WEARS, fine_points)
    first = _posterior_on_grid(
        prior, tests, _axis(prior.x, _FRICTIONS), _axis(prior.y, wear_points)
    )
    x = _dense_part(first.x, first.density.max(axis=1), _FRICTIONS)
    y = _dense_part(first.y, first.density.max(axis=0), _WEARS)
    return _posterior_on_grid(prior, tests, x, y)


def _posterior_on_grid(
    prior: Prior, tests: Sequence[Observation], x: np.ndarray, y: np.ndarray
) -> Posterior:
    """Returns the posterior on a grid of x (n,) and y (m,), m at least 2."""
    log = prior.log_density(x, y)
    for test in tests:
        log = log + test.count * test.log_likelihood(x, y)
    density = np.exp(log - log.max())
    return Posterior(x, y, density / (density.sum() * (y[1] - y[0])))


def conformities(prior: Prior, tests: Sequence[Observation]) -> list[Conformity]:
    """Returns how well each test agrees with the prior and the other tests.

    Of several bearings with one result, all but one are among the other tests.
    """
    results = []
    for k, test in enumerate(tests):
        other_tests = [*tests[:k], *tests[k + 1 :]]
        if test.count > 1:
            other_tests.append(replace(test, count=test.count - 1))
        results.append(posterior(prior, other_tests).conformity(test))
    return results


def _axis(normal: Normal, points: int) -> np.ndarray:
    """Returns evenly spaced points within `_WIDE` standard deviations; the mean if it is known."""
    half_width = _WIDE * normal.deviation
    if half_width == 0.0:
        return np.array([normal.mean])
    return np.linspace(normal.mean - half_width, normal.mean + half_width, points)


def _dense_part(grid: np.ndarray, density: np.ndarray, points: int) -> np.ndarray:
    """Returns evenly spaced points over the part of a grid whose density is not negligible.

    density: at the points of the grid, in any unit.
    """
    if len(grid) == 1:
        return grid
    dense = np.flatnonzero(density > _NEGLIGIBLE * density.max())
    first, last = max(dense[0] - 1, 0), min(dense[-1] + 1, len(grid) - 1)
    return np.linspace(grid[first], grid[last], points)
