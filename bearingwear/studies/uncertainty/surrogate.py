"""A function of many places from its values at some, with its error where it was not fitted.

Polyharmonic splines with a polynomial trend; the error is that of leave-one-out cross-validation,
in closed form (Rippa 1999). Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import combinations_with_replacement
from typing import NamedTuple

import numpy as np
from scipy.linalg import inv
from scipy.spatial import KDTree
from scipy.spatial.distance import cdist

SPLINES = ((3, 2), (3, 1), (1, 1), (1, 0))
"""Powers of the distance and degrees of the trend, of which the most accurate one is taken."""

PER_TERM = 1.5
"""Places for each term of a trend, at least."""

LEAST = 4
"""Places of a spline, at least."""

UNSURE = 10.0
"""Distance of a place of another kind over that of the nearest one, below which a kind is unsure.
"""

LEAST_SOUGHT = 8
"""Places of unsure kind that are solved at a time, at least."""

SOUGHT = 0.25
"""Share of the most places that is solved for unsure kinds where the error is small."""

SMOOTHING = 1e-6
"""On the diagonal, so that places which nearly coincide do no harm."""

_AT_ONCE = 2**22  # distances in memory
_SEED = 0  # of the choice of places


def monomials(x: np.ndarray, degree: int) -> np.ndarray:
    """All products of at most `degree` coordinates of places (n, values)."""
    every = (
        columns
        for order in range(degree + 1)
        for columns in combinations_with_replacement(range(x.shape[1]), order)
    )
    return np.stack([x[:, columns].prod(axis=1) for columns in every], axis=-1)


class Spline:
    """Polyharmonic spline through values (n, m) at places (n, values).

    Attributes
    ----------
    left_out : ndarray (n, m)
        Value at each place by a fit to all others, less the value there.
    """

    def __init__(self, places: np.ndarray, values: np.ndarray, power: int, degree: int):
        self.places, self.power, self.degree = places, power, degree
        trend = monomials(places, degree)
        n, terms = trend.shape
        matrix = np.zeros((n + terms, n + terms))
        matrix[:n, :n] = self._kernel(places) + SMOOTHING * np.eye(n)
        matrix[:n, n:], matrix[n:, :n] = trend, trend.T
        inverse = inv(matrix)
        self.weights = inverse[:, :n] @ values
        self.left_out = -self.weights[:n] / np.diag(inverse)[:n, None]

    def _kernel(self, places: np.ndarray) -> np.ndarray:
        return np.asarray((-1 if self.power == 1 else 1) * cdist(places, self.places) ** self.power)

    def __call__(self, places: np.ndarray) -> np.ndarray:
        """Values (n, m) at places (n, values)."""
        parts = math.ceil(len(places) * len(self.places) / _AT_ONCE)
        return np.concatenate(
            [
                np.hstack([self._kernel(part), monomials(part, self.degree)]) @ self.weights
                for part in np.array_split(places, max(parts, 1))
            ]
        )


class Branches:
    """A spline through the values of each kind; a place is of the kind of the nearest one known.

    Where values are not finite or too few the value is that of the nearest place, too.

    Attributes
    ----------
    left_out : ndarray (n, m)
        As of `Spline`, by what counts at a left-out place; infinite where only one of value and
        interpolation is finite.
    unsure : ndarray (n,)
        Whether a left-out place may be of another kind than the nearest one.
    """

    def __init__(self, x: np.ndarray, logs: np.ndarray, labels: np.ndarray):
        self.x, self.logs, self.labels = x, logs, labels
        every = np.unique(labels)
        self.trees = {label: (KDTree(x[labels == label]), labels == label) for label in every}
        self.splines = {
            label: _best(x[own], logs[own]) if np.isfinite(logs[own]).all() else None
            for label, (_, own) in self.trees.items()
        }
        nearest, self.unsure = self.nearest(x, left_out=True)
        found = self.at(x, nearest)
        for label, (_, own) in self.trees.items():
            spline = self.splines[label]
            if spline is not None:
                inside = own & (labels[nearest] == label)
                found[inside] = logs[inside] + spline.left_out[inside[own]]
        with np.errstate(invalid="ignore"):
            alike = (found == logs) | (np.isnan(found) & np.isnan(logs))
            self.left_out = np.where(alike, 0.0, np.nan_to_num(found - logs, nan=np.inf))

    def nearest(self, places: np.ndarray, left_out: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Number of the nearest place known (n,), and whether one of another kind is near, too.

        With `left_out` the places are those that are known, each without itself.
        """
        far, near = [], []
        for tree, own in self.trees.values():
            distance, which = tree.query(places)
            if left_out:
                other, of_other = (one[:, 0] for one in tree.query(places[own], k=[2]))
                distance[own], which[own] = other, np.minimum(of_other, own.sum() - 1)
            far.append(distance)
            near.append(np.flatnonzero(own)[which])
        first, *more = np.sort(far, axis=0)
        unsure = more[0] < UNSURE * first if more else np.zeros(len(places), dtype=bool)
        return np.array(near)[np.argmin(far, axis=0), np.arange(len(places))], unsure

    def at(self, places: np.ndarray, nearest: np.ndarray) -> np.ndarray:
        """Logarithms (n, m) at places of which the nearest ones known are given."""
        logs, labels = self.logs[nearest], self.labels[nearest]
        for label, spline in self.splines.items():
            if spline is not None:
                logs[labels == label] = spline(places[labels == label])
        return logs

    def error(self, some: np.ndarray) -> float:
        """Of some left-out places (n,): root mean square, relative, at most 1 of each."""
        with np.errstate(over="ignore"):
            each = np.minimum(np.abs(np.expm1(self.left_out[some])), 1.0)
        return float(np.sqrt(np.mean(each**2))) if each.size else np.inf


class Interpolated(NamedTuple):
    """A function at all places, solved at some of them."""

    log: np.ndarray  # (n, m) logarithms of values
    kind: np.ndarray  # (n, kinds) what else was found, of the nearest place that was solved
    solved: int
    error: float  # root mean square, relative, of the others; zero without any


def interpolated(
    places: np.ndarray,
    solve: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    first: int,
    most: int,
    known_to: float,
) -> Interpolated:
    """A function at places (n, values), solved at as few as its error allows.

    Those at the ends of each coordinate are solved and random ones, twice as many each time, until
    the error of these, left out, is small; and some of those whose kind is unsure, which count in
    that error as long as there are any others.

    Parameters
    ----------
    solve : callable
        From numbers of places (k,) to logarithms (k, m), which need not be finite, and kinds
        (k, kinds), whole numbers. The function is smooth within a kind.
    first, most : int
        Random places solved at least, and all that are solved at most.
    known_to : float
        Relative error (root mean square) for which no more are solved.
    """
    varied = np.ptp(places, axis=0) > 0.0
    x = (places[:, varied] - places[:, varied].mean(axis=0)) / places[:, varied].std(axis=0)
    ends = np.unique([x.argmin(axis=0), x.argmax(axis=0)]).astype(int)
    others = np.random.default_rng(_SEED).permutation(len(places))
    others = np.append(ends, others[~np.isin(others, ends)])
    known, drawn = np.empty(0, dtype=int), others[ends.size : ends.size + first]
    new, parts, sought = others[: ends.size + first], [], 0
    while True:
        parts.append(solve(new))
        known, others = np.append(known, new), others[~np.isin(others, new)]
        logs, kinds = map(np.concatenate, zip(*parts, strict=True))
        finite = np.isfinite(logs).all(axis=1)
        _, labels = np.unique(np.column_stack([kinds, finite]), axis=0, return_inverse=True)
        if not others.size:
            error = 0.0
            break
        branches = Branches(x[known], logs, labels.ravel())
        nearest, unsure = branches.nearest(x[others])
        of_drawn = np.isin(known, drawn)
        sure, left = branches.error(of_drawn & ~branches.unsure), most - known.size
        error = branches.error(of_drawn) if unsure.any() else sure
        if left <= 0 or (error <= known_to and (not unsure.any() or sought >= SOUGHT * most)):
            break
        more = others[: 0 if sure <= known_to else known.size]
        doubtful = others[unsure][: max(LEAST_SOUGHT, known.size // 4)]
        new = np.append(doubtful, more[~np.isin(more, doubtful)])[:left]
        drawn, sought = np.append(drawn, more), sought + doubtful.size
    log = np.empty((len(places), logs.shape[1]))
    kind = np.empty((len(places), kinds.shape[1]), dtype=int)
    log[known], kind[known] = logs, kinds
    if others.size:
        log[others], kind[others] = branches.at(x[others], nearest), kinds[nearest]
    return Interpolated(log, kind, known.size, error)


def _best(x: np.ndarray, logs: np.ndarray) -> Spline | None:
    """The spline with the least error of left-out places; None with too few places."""
    tried = [
        Spline(x, logs, power, degree)
        for power, degree in SPLINES
        if len(x) >= max(PER_TERM * math.comb(x.shape[1] + degree, degree), LEAST)
    ]
    return min(tried, key=lambda spline: np.abs(spline.left_out).mean(), default=None)
