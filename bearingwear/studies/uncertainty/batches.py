"""Two kinds of uncertainty: what is the same for all bearings of a batch, and what scatters.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.stats import qmc

from bearingwear.results.quantiles import CONFIDENCE, INTERVAL
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.distributions import values_at
from bearingwear.scene.scene import WORN, Scene
from bearingwear.scene.uncertain import is_same_for_batch
from bearingwear.studies.sampling import Sampling
from bearingwear.studies.uncertainty.sample import wear_factor
from bearingwear.studies.uncertainty.surrogate import EXACT, Stated

PROBABILITIES = (0.05, 0.1, 0.5, 0.9, 0.95)
"""Of quantiles over the bearings of a batch."""

BATCH_PROBABILITIES = (INTERVAL[0], 0.5, INTERVAL[1])
"""Of quantiles over what is not known of the batch."""

WEAR_DRAWS = 256
"""Values of wear coefficient and hardness that each batch is taken with."""

RESAMPLED = 128
"""How often batches and bearings are drawn anew from those sampled."""


class BatchQuantiles(NamedTuple):
    """(batch_probability, probability, 2) each [h]; NaN where no life was solved."""

    quantile: np.ndarray
    error: np.ndarray  # half of its confidence interval


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

    rows (batches * bearings, values): where lives are asked for; what is not known of wear scales
        them and is as in the scene.
    """

    def __init__(self, scene: Scene, plan: Sampling):
        names = list(scene.uncertainty or {})
        fixed = [name for name in names_of(scene, True) if name in WORN]
        unknown = [name for name in names_of(scene, True) if name not in WORN]
        scatter = names_of(scene, False)
        batches, bearings = sizes(plan.samples)
        of_batches = _probabilities(len(unknown), batches, plan.seed)
        of_wear = _probabilities(len(fixed), WEAR_DRAWS, plan.seed + 2)
        outer = values_at(scene, unknown, of_batches)
        inner = values_at(scene, scatter, _probabilities(len(scatter), bearings, plan.seed + 1))
        self.shape, self.seed = (len(outer), len(inner)), plan.seed
        values = {name: np.full(self.shape, scene.nominal(name)) for name in fixed}
        values |= {name: np.tile(outer[:, [k]], len(inner)) for k, name in enumerate(unknown)}
        values |= {name: np.tile(inner[:, k], (len(outer), 1)) for k, name in enumerate(scatter)}
        self.rows = np.stack([values[name].ravel() for name in names], axis=-1)
        factor = []
        for one in of_batches:
            rows = np.column_stack([np.tile(one, (len(of_wear), 1)), of_wear])
            worn = values_at(scene, [*unknown, *fixed], rows)[:, len(unknown) :]
            factor.append(wear_factor(scene, fixed, worn))
        self.factor = np.array(factor)

    def quantiles(self, life: np.ndarray, known: Stated) -> dict[str, np.ndarray]:
        """Of lives (n, 2) [s] at the rows, with their error, widened by that of these lives."""
        hours = (life * HOURS_PER_SECOND).reshape(*self.shape, -1)
        found = quantiles_with_error(hours, self.factor, self.seed, known)
        return {
            "batch_life_quantile": found.quantile,
            "batch_life_quantile_error": found.error,
        }


def quantiles_with_error(
    hours: np.ndarray, factor: np.ndarray, seed: int, known: Stated = EXACT
) -> BatchQuantiles:
    """Quantiles of lives (batches, bearings, 2) [h] that have the same bearings in every batch.

    The error is that of a bootstrap, which draws batches and bearings anew, each with replacement.
    It takes them for independent; a Sobol sequence is spread more evenly, so it is rather large.

    hours: NaN where a life was not solved.
    factor (draws,) or (batches, draws): of the lives of a batch, which has each of them.
    known: of the lives; the error includes theirs.
    """
    some = np.isfinite(hours).any(axis=(1, 2))
    solved = hours[some]
    factor = np.broadcast_to(factor, (len(hours), np.shape(factor)[-1]))[some]
    if not len(solved):
        nothing = np.full((len(BATCH_PROBABILITIES), len(PROBABILITIES), 2), np.nan)
        return BatchQuantiles(nothing, nothing)
    random, (batches, bearings) = np.random.default_rng(seed), solved.shape[:2]
    copies = []
    for _ in range(RESAMPLED):
        batch = random.integers(batches, size=(batches, 1))
        bearing = random.integers(bearings, size=bearings)
        copies.append(_of_lives(solved[batch, bearing], factor[batch[:, 0]]))
    ends = np.nanquantile(copies, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], axis=0)
    quantile = _of_lives(solved, factor)
    worse = [_of_lives(solved, factor, shift) for shift in (-known.share, known.share)]
    error = known.error * quantile + 0.5 * (ends[1] - ends[0] + worse[1] - worse[0])
    return BatchQuantiles(quantile, error)


def _of_lives(hours: np.ndarray, factor: np.ndarray, shift: float = 0.0) -> np.ndarray:
    """Quantiles over bearings (the second axis), and of these over batches and their factors."""
    probabilities = np.clip(np.array(PROBABILITIES) + shift, 0.0, 1.0)
    quantile = np.nanquantile if np.isnan(hours).any() else np.quantile
    of_each = quantile(hours, probabilities, axis=1)  # (probability, batch, 2)
    every = (of_each[:, :, None] * factor[..., None]).reshape(len(PROBABILITIES), -1, 2)
    return quantile(every, BATCH_PROBABILITIES, axis=1)


def _probabilities(values: int, count: int, seed: int) -> np.ndarray:
    """A scrambled Sobol sequence (count, values); a single empty row without any values."""
    return qmc.Sobol(values, seed=seed).random(count) if values else np.empty((1, 0))
