"""Two kinds of uncertainty: what is the same for all bearings of a batch, and what scatters.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from bearingwear.results.quantiles import CONFIDENCE, INTERVAL
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.distributions import values_at
from bearingwear.scene.scene import WORN, Scene
from bearingwear.scene.uncertain import is_same_for_batch
from bearingwear.studies.sampling import Sampling
from bearingwear.studies.uncertainty.sample import POOLED, independent, pooled_wear_factors
from bearingwear.studies.uncertainty.surrogate import EXACT, Stated

PROBABILITIES = (0.05, 0.1, 0.5, 0.9, 0.95)
"""Of quantiles over the bearings of a batch."""

BATCH_PROBABILITIES = (INTERVAL[0], 0.5, INTERVAL[1])
"""Of quantiles over what is not known of the batch."""

_DEVIATIONS = float(ndtri(0.5 + 0.5 * CONFIDENCE))


class Quantiles(NamedTuple):
    """(batch_probability, probability) each [h]; NaN where no life was solved."""

    quantile: np.ndarray
    low: np.ndarray  # ends of its confidence interval; NaN where the sample has none
    high: np.ndarray


def names_of(scene: Scene, of_batch: bool) -> list[str]:
    """Uncertain values that are the same for all bearings of a batch, or those that are not."""
    given = scene.uncertainty or {}
    return [name for name, one in given.items() if is_same_for_batch(name, one) == of_batch]


def of_class(scene: Scene, of_batch: bool) -> Scene:
    """The scene with one class of its uncertain values; the others are as the scene has them."""
    names, given = names_of(scene, of_batch), scene.uncertainty or {}
    return replace(scene, uncertainty={name: given[name] for name in names})


def sizes(samples: int) -> tuple[int, int]:
    """Batches, and bearings of each, of about twice as many lives as base samples."""
    power = int(math.log2(2 * samples))
    return 2 ** (power // 2), 2 ** (power - power // 2)


class Batches:
    """The same bearings in each of several batches: a sample in two stages.

    rows (batches * bearings, values): where lives are asked for, with K_s and H of the scene.
    """

    def __init__(self, scene: Scene, plan: Sampling):
        names = list(scene.uncertainty or {})
        batches, bearings = sizes(plan.samples)
        outer, self.unknown = _sampled(scene, True, batches, plan)
        inner, self.scatter = _sampled(scene, False, bearings, plan, len(self.unknown))
        self.shape = len(self.unknown), len(self.scatter)
        values = {name: np.full(self.shape, scene.nominal(name)) for name in names}
        values |= {name: np.tile(one[:, None], self.shape[1]) for name, one in outer.items()}
        values |= {name: np.tile(one, (self.shape[0], 1)) for name, one in inner.items()}
        self.rows = np.stack([values[name].ravel() for name in names], axis=-1)

    def quantiles(self, life: np.ndarray, known: Stated) -> dict[str, np.ndarray]:
        """Of lives (n,) [s] at the rows, with their error, widened by that of these lives."""
        hours = (life * HOURS_PER_SECOND).reshape(self.shape)
        found = quantiles_with_error(hours, self.scatter, self.unknown, known)
        return {
            "batch_life_quantile": found.quantile,
            "batch_life_quantile_error": np.fmax(
                found.high - found.quantile, found.quantile - found.low
            ),
        }


def _sampled(
    scene: Scene, of_batch: bool, count: int, plan: Sampling, times: int = 1
) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Values (n,) of a class by name, and the factors (n, draws) of its K_s and H on lives.

    times: that many samples are pooled.
    """
    names = list(scene.uncertainty or {})
    rest = [name for name in names_of(scene, of_batch) if name not in WORN]
    if rest and not set(names_of(scene, not of_batch)) <= set(WORN):
        unit = qmc.Sobol(len(rest), seed=plan.seed + of_batch).random(count)
    elif rest:  # lives of independent bearings are all that is needed
        unit = independent(scene, plan)[:, [names.index(name) for name in rest]]
    else:
        unit = np.empty((1, 0))
    worn = [name for name in names_of(scene, of_batch) if name in WORN]
    values = dict(zip(rest, values_at(scene, rest, unit).T, strict=True))
    return values, pooled_wear_factors(scene, worn, rest, unit, POOLED // times)


def quantiles_with_error(
    hours: np.ndarray,
    scatter: np.ndarray,
    unknown: np.ndarray,
    known: Stated = EXACT,
    of_batches: Sequence[float] = BATCH_PROBABILITIES,
) -> Quantiles:
    """Quantiles over bearings, and of these over batches, of lives (batches, bearings) [h].

    The intervals are those of Woodruff (1952): the error of the share of lives below a quantile,
    times the slope of the quantile. They take batches and bearings for independent; a Sobol
    sequence is spread more evenly, so they are rather wide. The share of lives whose error is not
    known may lie at either end of them.

    hours: with the same bearings in every batch; NaN where a life was not solved.
    scatter (bearings, draws), unknown (batches, draws): factors on lives, equally probable.
    known: of the lives.
    of_batches: probabilities over batches.
    """
    solved = np.isfinite(hours)
    some, of_some = solved.any(axis=1), solved.any(axis=0)
    found = np.full((3, len(of_batches), len(PROBABILITIES)), np.nan)
    if solved.any():
        hours, scatter, unknown = hours[some][:, of_some], scatter[of_some], unknown[some]
        for k, p in enumerate(PROBABILITIES):
            each = hours[:, :, None] * scatter
            found[..., k] = _with_ends(each, unknown, p, np.array(of_batches), known)
    return Quantiles(*found)


def _with_ends(
    each: np.ndarray, unknown: np.ndarray, p: float, q: np.ndarray, known: Stated
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Quantiles q over batches of quantiles p of lives (batches, bearings, draws), with ends."""

    def at(p: float, q: np.ndarray) -> np.ndarray:
        return _quantile((_quantile(pooled, p)[:, None] * unknown).ravel(), q)

    pooled = each.reshape(len(each), -1)
    of_each = _quantile(pooled, p)[:, None]
    below = np.where(np.isnan(each), np.nan, each <= of_each[..., None])
    by_bearing = _half_width(np.nanmean(below, axis=(0, 2))) + known.share
    middle, ends = at(p, q), []
    by_batch = np.array([_half_width((of_each * unknown <= t).mean(axis=1)) for t in middle])
    for sign in (-1.0, 1.0):
        P, Q = p + sign * by_bearing, q + sign * by_batch
        apart = np.hypot(at(P, q) - middle, at(p, Q) - middle)
        inside = (0.0 < P < 1.0) & (Q > 0.0) & (Q < 1.0)
        end = (middle + sign * apart) * (1.0 + sign * known.error)
        ends.append(np.where(inside, end, np.nan))
    return middle, ends[0], ends[1]


def _half_width(shares: np.ndarray) -> float:
    """Of the confidence interval of the mean of shares (n,); zero where nothing varies."""
    n = len(shares)
    return _DEVIATIONS * float(np.std(shares, ddof=1)) / math.sqrt(n) if n > 1 else 0.0


def _quantile(values: np.ndarray, p: float | np.ndarray) -> np.ndarray:
    """Along the last axis; the least or the largest value beyond the sample."""
    quantile = np.nanquantile if np.isnan(values).any() else np.quantile
    return quantile(values, np.clip(p, 0.0, 1.0), axis=-1, method="hazen")
