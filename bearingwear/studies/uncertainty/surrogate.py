"""A function of many places from its values at some, with its error where it was not fitted.

Polyharmonic splines with a polynomial trend, one for each kind; leave-one-out cross-validation in
closed form (Rippa 1999). Theory: docs/theory.md, section 15.
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
from scipy.special import betaincinv

from bearingwear.results.quantiles import CONFIDENCE

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
"""Places of doubtful kind that are solved at a time, at least."""

SOUGHT = 0.25
"""Share of the most places that is solved for doubtful kinds or kinks where errors are small."""

ALL_FROM = 2.0
"""Places over those solved, below which all others are solved if more are needed."""

BAD = 5.0
"""Error of a place left out over the one asked for, beyond which there is a kink."""

PER_ROOT = 3.0
"""Random places solved over the root of their number, if the most allows: what may be worse is then
a share no larger than the error of the sample itself."""

ALONG_PER_ROOT = 2.0
"""Evenly spread places along one coordinate over the root of their number, likewise: what may be
worse is a gap between two of them."""

SMOOTHING = 1e-6
"""On the diagonal, so that places which nearly coincide do no harm."""

_AT_ONCE = 2**22  # distances in memory
_SEED = 0  # of the choice of places
_POOL = 8192  # places that are looked at for the next ones


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

    left_out (n, m): value at each place by a fit to all others, less the value there.
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
        r = cdist(places, self.places)
        return -r if self.power == 1 else r * r * r

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
    """A spline through the values of each kind.

    A place is of the kind of the nearest one known; or, near places of other kinds, of the one with
    the least value, if that is more accurate: of several ends the earliest one counts. Where values
    are not finite or too few, the value is that of the nearest place, too.

    left_out (n,): relative error at each place, at most 1, where it is left out of the fit.
    doubtful (n,): whether its kind is doubtful, then.
    """

    def __init__(self, x: np.ndarray, logs: np.ndarray, labels: np.ndarray):
        self.x, self.logs, self.labels = x, logs, labels
        self.kinds = np.unique(labels)
        own = [np.flatnonzero(labels == label) for label in self.kinds]
        self.known = [(KDTree(x[one]), one) for one in own]
        self.splines = [
            _best(x[one], logs[one]) if np.isfinite(logs[one]).all() else None for one in own
        ]
        values = self._values(x)
        for spline, one, of_kind in zip(self.splines, own, values, strict=True):
            if spline is not None:
                of_kind[one] = logs[one] + spline.left_out
        distances, fits = self._distances(x, left_out=True), []
        for earliest in (False, True):
            log, _, doubtful = self._joined(values, *distances, earliest)
            fits.append((relative_error(log, logs), doubtful))
        self.earliest = _rms(fits[True][0]) < _rms(fits[False][0])
        self.left_out, self.doubtful = fits[self.earliest]

    def _values(self, places: np.ndarray) -> np.ndarray:
        """Logarithms (kinds, n, m) by each spline; NaN without one."""
        nothing = np.full((len(places), self.logs.shape[1]), np.nan)
        return np.array([nothing if one is None else one(places) for one in self.splines])

    def _distances(
        self, places: np.ndarray, left_out: bool = False
    ) -> tuple[np.ndarray, np.ndarray]:
        """Distance of the nearest place of each kind, and its number, each (kinds, n).

        With `left_out` the places are those that are known, each without itself.
        """
        far, near = [], []
        for tree, own in self.known:
            distance, which = tree.query(places)
            if left_out:
                other, of_other = (one[:, 0] for one in tree.query(places[own], k=[2]))
                distance[own], which[own] = other, np.minimum(of_other, own.size - 1)
            far.append(distance)
            near.append(own[which])
        return np.array(far), np.array(near)

    def _joined(
        self, values: np.ndarray, far: np.ndarray, near: np.ndarray, earliest: bool
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """As `at`, from values and distances of each kind."""
        n, close = np.arange(far.shape[1]), far < UNSURE * far.min(axis=0)
        kind = nearest = far.argmin(axis=0)
        if earliest:
            trend = [one is not None and one.degree > 0 for one in self.splines]
            apt = np.array(trend)[:, None] & close
            last = np.where(apt, values[..., -1], np.inf)
            kind = np.where(apt[kind, n], last.argmin(axis=0), kind)
        log = values[kind, n]
        none = np.array([one is None for one in self.splines])[:, None]
        doubtful = (kind != nearest) | ((close & none).any(axis=0) & (close.sum(axis=0) > 1))
        return np.where(np.isnan(log), self.logs[near[kind, n]], log), self.kinds[kind], doubtful

    def at(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Logarithms (n, m), kinds (n,), and whether the kind is doubtful, at places.

        It is doubtful where the nearest place known is of another kind, and near another one where
        there is no spline.
        """
        return self._joined(self._values(places), *self._distances(places), self.earliest)


def relative_error(log: np.ndarray, true: np.ndarray) -> np.ndarray:
    """Largest relative error (n,) of logarithms (n, m), at most 1."""
    with np.errstate(invalid="ignore", over="ignore"):
        alike = (log == true) | (np.isnan(log) & np.isnan(true))
        each = np.where(alike, 0.0, np.abs(np.expm1(np.nan_to_num(log - true, nan=np.inf))))
    return np.minimum(each, 1.0).max(axis=1)


class Stated(NamedTuple):
    """All but a share of places are known within a relative error, with `CONFIDENCE` from random
    places, or as estimated along a line.
    """

    error: float
    share: float


EXACT = Stated(0.0, 0.0)


def stated(errors: np.ndarray) -> Stated:
    """Of errors (n,) at random places that no fit has seen: the pair with the least sum.

    The share is the upper bound of Clopper and Pearson (1934) where so many errors are larger.
    """
    each = np.sort(errors)[::-1]
    larger = np.arange(each.size)
    shares = betaincinv(larger + 1, each.size - larger, CONFIDENCE)
    k = np.argmin(each + shares)
    return Stated(float(each[k]), float(shares[k]))


class Interpolated(NamedTuple):
    """A function at all places, solved at some of them."""

    log: np.ndarray  # (n, m) logarithms of values
    kind: np.ndarray  # (n, kinds) what else was found
    solved: int
    stated: Stated  # of all; zero where all are solved


def fewest(places: np.ndarray, first: int, most: int) -> int:
    """How many of the places (n, values) are solved at least: random ones, or along a line."""
    root = math.sqrt(len(places))
    if np.count_nonzero(np.ptp(places, axis=0)) == 1:
        return min(max(first, math.ceil(ALONG_PER_ROOT * root) + 1), most // 2, len(places))
    return min(max(2 * first, math.ceil(PER_ROOT * root)), most, len(places))


def interpolated(
    places: np.ndarray,
    solve: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    first: int,
    most: int,
    known_to: float,
) -> Interpolated:
    """A function at places (n, values), solved at as few as its error allows.

    Those at the ends of each coordinate are solved and random ones, twice as many each time, until
    their error is small: of the last ones by the fit before they were solved, and of each by a fit
    to all others. Some of those whose kind is doubtful are solved, too. Once half of all places are
    solved and more are needed, all are. Where one coordinate alone varies, see `_along`.

    solve: from numbers of places (k,) to logarithms (k, m), which need not be finite, and kinds (k,
        kinds), whole numbers. The function is smooth within a kind.
    first, most: random places solved at least, and all that are solved at most.
    known_to: relative error of 95 in 100 for which no more are solved, but for kinks.
    """
    count, checked = len(places), fewest(places, first, most)
    varied = np.ptp(places, axis=0) > 0.0
    x = (places[:, varied] - places[:, varied].mean(axis=0)) / places[:, varied].std(axis=0)
    if x.shape[1] == 1:
        return _along(x, solve, checked, most, known_to)
    ends = np.unique([x.argmin(axis=0), x.argmax(axis=0)]).astype(int)
    others = np.random.default_rng(_SEED).permutation(count)
    others = others[~np.isin(others, ends)]
    log = kind = np.empty(0)
    known, hard = np.zeros((2, count), dtype=bool)
    error = np.full(count, np.nan)  # of drawn ones, by a fit without them
    doubtful, drawn, sought = ends, others[:first], 0
    while True:
        logs, kinds = solve(new := np.append(doubtful, drawn))
        if not known.any():
            log = np.full((count, logs.shape[1]), np.nan)
            kind = np.zeros((count, kinds.shape[1]), dtype=int)
        if drawn.size:
            before = ~np.isnan(error) | ~known.any()  # the first ones have no fit but later ones
            error[drawn] = relative_error(log[drawn], logs[doubtful.size :])
            unseen = error[drawn[~hard[drawn]]]
        log[new], kind[new], known[new] = logs, kinds, True
        others = others[~known[others]]
        if not others.size:
            return Interpolated(log, kind, count, EXACT)
        every, labels = _labelled(log[known], kind[known])
        branches = Branches(x[known], log[known], labels)
        left_out, checks = np.full(count, np.nan), ~np.isnan(error)
        left_out[known], hard[known] = branches.left_out, branches.doubtful
        error[before] = left_out[before]
        pool = np.append(others[:most], others[most:][-_POOL:])
        log[pool], _, hard[pool] = branches.at(x[pool])
        lacking = max(checked - checks.sum(), first if _most(unseen) > known_to else 0)
        if _most(left_out[checks & ~hard]) > known_to:
            lacking = known.sum()
        left = most - known.sum()
        nearest = np.flatnonzero(known)[KDTree(x[known]).query(x[pool])[1]]
        bad = pool[hard[pool] | (left_out[nearest] > BAD * known_to)][::-1]
        if left <= 0 or (lacking <= 0 and (not bad.size or sought >= SOUGHT * most)):
            break
        # random ones from the front, whatever they are; doubtful and bad ones from the rear
        lacking = others.size if count <= ALL_FROM * known.sum() else lacking
        drawn = pool[: max(min(lacking, left - LEAST_SOUGHT), 0)]
        bad = bad[~np.isin(bad, drawn)]
        doubtful = bad[: min(max(LEAST_SOUGHT, known.sum() // 4), left - drawn.size)]
        if not drawn.size + doubtful.size:
            break
        sought += doubtful.size
    log[others], label, _ = branches.at(x[others])
    kind[others] = every[label, :-1]
    found = stated(error[checks])
    share = found.share * others.size / count
    return Interpolated(log, kind, count - others.size, found._replace(share=share))


def _along(
    x: np.ndarray,
    solve: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    evenly: int,
    most: int,
    known_to: float,
) -> Interpolated:
    """`interpolated` over one coordinate x (n, 1), along which places are known to lie close.

    After evenly spread places, the middle between two neighbours is solved if they differ in kind,
    or if either has a large error when it is left out. The error between them is smaller than that.
    What lies between two neighbours and shows at neither goes unseen: the widest gap is a share.

    evenly: places solved at first.
    """
    count, order = len(x), np.argsort(x[:, 0])
    x, known = x[order], np.zeros(count, dtype=bool)
    new = np.unique(np.linspace(0, count - 1, evenly).round().astype(int))
    log = kind = np.empty(0)
    while True:
        logs, kinds = solve(order[new])
        if not known.any():
            log = np.full((count, logs.shape[1]), np.nan)
            kind = np.zeros((count, kinds.shape[1]), dtype=int)
        log[new], kind[new], known[new] = logs, kinds, True
        solved = np.flatnonzero(known)
        gaps = np.diff(solved) - 1
        every, labels = _labelled(log[solved], kind[solved])
        branches = Branches(x[solved], log[solved], labels)
        error = np.fmax(branches.left_out[1:], branches.left_out[:-1])
        error[labels[1:] != labels[:-1]] = 1.0
        known_between = (gaps == 0) | (error <= known_to)
        wide = np.flatnonzero(~known_between)
        wide = wide[np.argsort(-gaps[wide], kind="stable")][: max(most - solved.size, 0)]
        if not wide.size:
            break
        new = np.sort((solved[1:] + solved[:-1])[wide] // 2)
    others, back = np.flatnonzero(~known), np.argsort(order)
    found = EXACT
    if others.size:
        log[others], label, _ = branches.at(x[others])
        kind[others] = every[label, :-1]
        most_error = error[known_between & (gaps > 0)].max(initial=0.0)
        share = (gaps[~known_between].sum() + gaps.max()) / count
        found = Stated(float(most_error), min(float(share), 1.0))
    return Interpolated(log[back], kind[back], solved.size, found)


def _labelled(log: np.ndarray, kind: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Kinds that differ, or in whether values are finite (kinds, m), and the number of each."""
    marks = np.column_stack([kind, np.isfinite(log).all(axis=1)])
    every, labels = np.unique(marks, axis=0, return_inverse=True)
    return every, labels.ravel()


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2))) if values.size else 0.0


def _most(errors: np.ndarray) -> float:
    """Error that 95 of 100 do not exceed."""
    return float(np.quantile(errors, CONFIDENCE)) if errors.size else 0.0


def _best(x: np.ndarray, logs: np.ndarray) -> Spline | None:
    """The spline with the least error of left-out places; None with too few places."""
    tried = [
        Spline(x, logs, power, degree)
        for power, degree in SPLINES
        if len(x) >= max(PER_TERM * math.comb(x.shape[1] + degree, degree), LEAST)
    ]
    return min(tried, key=lambda spline: np.abs(spline.left_out).mean(), default=None)
