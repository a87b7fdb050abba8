"""Quantiles of sampled lives, shares and Sobol indices, each with its confidence interval.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy import stats

from bearingwear.results.quantiles import CONFIDENCE

TAILS = 0.5 * (1.0 - CONFIDENCE), 0.5 * (1.0 + CONFIDENCE)


class Quantile(NamedTuple):
    """A quantile of lives, and its confidence interval due to the size of the sample."""

    value: float
    low: float  # NaN where the end lies beyond the sample
    high: float


def life_quantile(lives: np.ndarray, factors: np.ndarray, p: float) -> Quantile:
    """The quantile at a probability of the lives of independent bearings.

    The share of bearings below the quantile is known as well as by an effective number of bearings,
    whose binomial interval (Clopper and Pearson 1934; Korn and Graubard 1998) is carried over to
    lives (Woodruff 1952). With one factor for each life, this is the interval between two order
    statistics. Otherwise it allows for one bearing more that fails at once and one that lasts: few
    lives may all have missed an end of life that few bearings meet.

    lives (n,): NaN where one was not solved; these are left out.
    factors (n, draws): by which wear scales each life, equally probable.
    """
    solved = np.isfinite(lives)
    lives, every = lives[solved], lives[solved, None] * factors[solved]
    n = len(lives)
    if not n:
        return Quantile(np.nan, np.nan, np.nan)
    value = float(np.quantile(every, p, method="hazen"))
    if n == 1:
        return Quantile(value, np.nan, np.nan)
    if np.ptp(lives) == 0.0:  # nothing varies but wear, whose factors are known
        return Quantile(value, value, value)
    effective = float(n)
    if factors.shape[1] > 1:
        below = np.append((every <= value).mean(axis=1), [0.0, 1.0])
        effective *= p * (1.0 - p) / below.var(ddof=1)
    ends = (
        stats.beta.ppf(TAILS[0], effective * p, effective * (1.0 - p) + 1.0),
        stats.beta.ppf(TAILS[1], effective * p + 1.0, effective * (1.0 - p)),
    )
    inside = [1.0 / every.size <= end <= 1.0 - 1.0 / every.size for end in ends]
    low, high = np.quantile(every, ends, method="hazen")
    return Quantile(value, low if inside[0] else np.nan, high if inside[1] else np.nan)


def longest_shares(lives: np.ndarray) -> np.ndarray:
    """Shares (methods, 3) of bearings that live longest by each method, and their intervals.

    The intervals are those of Clopper and Pearson (1934).

    lives (methods, n): at the same sampled values; NaN where one was not solved.
    """
    lives = lives[:, np.isfinite(lives).all(axis=0)]
    count = lives.shape[1]
    if not count:
        return np.full((len(lives), 3), np.nan)
    found = []
    for m, own in enumerate(lives):
        longest = int((own > np.delete(lives, m, axis=0)).all(axis=0).sum())
        interval = stats.binomtest(longest, count).proportion_ci(CONFIDENCE)
        found.append((longest / count, interval.low, interval.high))
    return np.array(found)


RESAMPLES = 200
"""Resamples of the bootstrap that gives the errors of Sobol indices."""


def sobol_indices(lives: np.ndarray, seed: int) -> dict[str, np.ndarray]:
    """Sobol indices (answers, values) of log lives, and half-widths of their intervals.

    By `scipy.stats.sobol_indices` (Saltelli et al. 2010), which takes a power of two of base
    samples: the first of those of which every life is above zero.

    lives (values + 2, answers, n): at A, at B, and at A with each value of B.
    """
    values, answers = lives.shape[0] - 2, lives.shape[1]
    usable = (lives > 0.0).all(axis=(0, 1))
    names = "first_index", "total_index"
    if usable.sum() < 2:
        every = [f"{name}{end}" for name in names for end in ("", "_error")]
        return dict.fromkeys(every, np.full((answers, values), np.nan))
    n = 2 ** int(np.log2(usable.sum()))
    logs = np.log(lives[..., usable][..., :n])

    def indices(which: Any) -> np.ndarray:
        some = logs[..., which]
        found = stats.sobol_indices(func={"f_A": some[0], "f_B": some[1], "f_AB": some[2:]}, n=n)
        return np.stack([found.first_order, found.total_order]).reshape(2, answers, values)

    random = np.random.default_rng(seed)
    resampled = np.stack([indices(random.integers(n, size=n)) for _ in range(RESAMPLES)])
    low, high = np.quantile(resampled, TAILS, axis=0)
    found = dict(zip(names, indices(np.arange(n)), strict=True))
    errors = zip(names, 0.5 * (high - low), strict=True)
    return found | {f"{name}_error": error for name, error in errors}
