"""Quantiles of sampled lives, shares and Sobol indices, each with its confidence interval.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import stats

from bearingwear.results.quantiles import CONFIDENCE

TAILS = 0.5 * (1.0 - CONFIDENCE), 0.5 * (1.0 + CONFIDENCE)
"""Probabilities at both ends of a confidence interval."""


class Quantile(NamedTuple):
    """A quantile of lives, and its confidence interval due to the size of the sample."""

    value: float  # in the unit of the lives; NaN of no life
    low: float  # lower end of the interval; NaN where it lies beyond the sample
    high: float  # upper end, likewise


def life_quantile(lives: np.ndarray, factors: np.ndarray, p: float) -> Quantile:
    """Returns the quantile at a probability of the lives of independent bearings.

    It is NaN without a solved life, and so is an end of the interval that the sample cannot give.
    If all lives are equal, so that only wear varies, the interval has no width.

    The share of bearings below the quantile is known as well as by an effective number of bearings,
    whose binomial interval (Clopper and Pearson 1934; Korn and Graubard 1998) is carried over to
    lives (Woodruff 1952). With one factor for each life, this is the interval between two order
    statistics. Otherwise it allows for one bearing more that fails at once and one that lasts: few
    lives may all have missed an end of life that few bearings meet.

    lives: NaN where one was not solved; these are left out (n,).
    factors: by which wear scales each life, equally probable (n, draws).
    p: probability of a shorter life, between 0 and 1.
    """
    solved = np.isfinite(lives)
    scaled = lives[solved, None] * factors[solved]
    lives = lives[solved]
    n = len(lives)
    if not n:
        return Quantile(np.nan, np.nan, np.nan)
    value = float(np.quantile(scaled, p, method="hazen"))
    if n == 1:
        return Quantile(value, np.nan, np.nan)
    if np.ptp(lives) == 0.0:  # nothing varies but wear, whose factors are known
        return Quantile(value, value, value)
    effective = float(n)
    if factors.shape[1] > 1:
        # of each life; of one bearing more that lasts, and of one that fails at once
        shares_below = np.append((scaled <= value).mean(axis=1), [0.0, 1.0])
        effective *= p * (1.0 - p) / shares_below.var(ddof=1)
    probabilities = (
        stats.beta.ppf(TAILS[0], effective * p, effective * (1.0 - p) + 1.0),
        stats.beta.ppf(TAILS[1], effective * p + 1.0, effective * (1.0 - p)),
    )
    low, high = np.quantile(scaled, probabilities, method="hazen")
    share_of_member = 1.0 / scaled.size  # an end beyond the outermost members is not known
    has_low, has_high = (share_of_member <= end <= 1.0 - share_of_member for end in probabilities)
    return Quantile(value, low if has_low else np.nan, high if has_high else np.nan)


def longest_shares(lives: np.ndarray) -> np.ndarray:
    """Returns the share of bearings that live longest with each preload method (methods, 3).

    A row is the share and the ends of its confidence interval (Clopper and Pearson 1934); NaN if no
    bearing has a life with all methods. Bearings without a life with some method are left out. One
    that lives equally long with several methods counts for none of these.

    lives: of the same bearings with each method; NaN where one was not solved (methods, n).
    """
    lives = lives[:, np.isfinite(lives).all(axis=0)]
    count = lives.shape[1]
    if not count:
        return np.full((len(lives), 3), np.nan)
    shares = []
    for m, method_lives in enumerate(lives):
        other_lives = np.delete(lives, m, axis=0)
        longest = int((method_lives > other_lives).all(axis=0).sum())
        interval = stats.binomtest(longest, count).proportion_ci(CONFIDENCE)
        shares.append((longest / count, interval.low, interval.high))
    return np.array(shares)


RESAMPLES = 200
"""Resamples of the bootstrap that gives the errors of Sobol indices."""


def sobol_indices(lives: np.ndarray, seed: int) -> dict[str, np.ndarray]:
    """Returns Sobol indices of log lives, and half-widths of their intervals (outputs, values).

    The arrays have the names `first_index`, `total_index`, and these with `_error`. The indices are
    those of `scipy.stats.sobol_indices` (Saltelli et al. 2010), which requires a power of two of
    base samples. They are the first ones whose lives are all above zero; with fewer than two such
    samples, all arrays are NaN. Half-widths come from a bootstrap of the base samples.

    lives: at A, at B, and at A with each value from B; NaN where not solved (values + 2, outputs,
        n).
    seed: of the bootstrap.
    """
    count_of_values = lives.shape[0] - 2
    outputs = lives.shape[1]
    usable = (lives > 0.0).all(axis=(0, 1))  # False for NaN
    if usable.sum() < 2:
        unknown = np.full((outputs, count_of_values), np.nan)
        names = "first_index", "total_index", "first_index_error", "total_index_error"
        return dict.fromkeys(names, unknown)
    n = 2 ** int(np.log2(usable.sum()))
    logs = np.log(lives[..., usable][..., :n])

    def indices(samples: np.ndarray) -> np.ndarray:
        """Returns first and total indices of some base samples (2, outputs, values).

        samples: indices of base samples, which may repeat (n,).
        """
        chosen = logs[..., samples]
        outputs_at = {"f_A": chosen[0], "f_B": chosen[1], "f_AB": chosen[2:]}
        result = stats.sobol_indices(func=outputs_at, n=n)
        both_orders = np.stack([result.first_order, result.total_order])
        return both_orders.reshape(2, outputs, count_of_values)

    random = np.random.default_rng(seed)
    resampled = np.stack([indices(random.integers(n, size=n)) for _ in range(RESAMPLES)])
    low, high = np.quantile(resampled, TAILS, axis=0)
    first, total = indices(np.arange(n))
    first_error, total_error = 0.5 * (high - low)
    return {
        "first_index": first,
        "total_index": total,
        "first_index_error": first_error,
        "total_index_error": total_error,
    }
