"""Two kinds of not knowing: what is the same for all bearings of a batch, and what scatters.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import qmc

from bearingwear.kernels.status import OK
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.scene import WORN, Scene
from bearingwear.scene.uncertain import is_same_for_batch
from bearingwear.studies.sampling import Sampling
from bearingwear.studies.uncertainty.sample import lives, value_at, wear_factor

PROBABILITIES = (0.1, 0.5, 0.9)
"""Of quantiles over the bearings of a batch."""

BATCH_PROBABILITIES = (0.05, 0.5, 0.95)
"""Of quantiles over what is not known of the batch."""

WEAR_DRAWS = 256
"""Values of wear coefficient and hardness that each batch is taken with."""


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


def batch_quantiles(scene: Scene, plan: Sampling, workers: int = 1) -> np.ndarray:
    """Quantiles over the bearings of a batch, and of these over what is not known of the batch.

    Returns
    -------
    (batch_probability, probability, 2) ndarray
        [h]; NaN where no life was solved.
    """
    names = list(scene.uncertainty or {})
    fixed = [name for name in names_of(scene, True) if name in WORN]
    unknown = [name for name in names_of(scene, True) if name not in WORN]
    scatter = names_of(scene, False)
    batches, bearings = sizes(plan.samples)
    outer = sobol_values(scene, unknown, batches, plan.seed)
    inner = sobol_values(scene, scatter, bearings, plan.seed + 1)
    wear = sobol_values(scene, fixed, WEAR_DRAWS, plan.seed + 2)
    values = {name: np.full((len(outer), len(inner)), scene.nominal(name)) for name in fixed}
    values |= {name: np.tile(outer[:, [k]], len(inner)) for k, name in enumerate(unknown)}
    values |= {name: np.tile(inner[:, k], (len(outer), 1)) for k, name in enumerate(scatter)}
    rows = np.stack([values[name].ravel() for name in names], axis=-1)
    found = lives(scene, rows, workers)
    hours = np.where((found.status == OK)[:, None], found.life, np.nan) * HOURS_PER_SECOND
    hours = hours.reshape(len(outer), len(inner), -1)
    solved = hours[np.isfinite(hours).any(axis=(1, 2))]
    if not len(solved):
        return np.full((len(BATCH_PROBABILITIES), len(PROBABILITIES), 2), np.nan)
    of_each = np.nanquantile(solved, PROBABILITIES, axis=1)  # (probability, batch, 2)
    factor = wear_factor(scene, fixed, wear)
    every = (of_each[:, :, None] * factor[:, None]).reshape(len(PROBABILITIES), -1, 2)
    return np.quantile(every, BATCH_PROBABILITIES, axis=1)


def sobol_values(scene: Scene, names: Sequence[str], count: int, seed: int) -> np.ndarray:
    """Values (count, values) of a scrambled Sobol sequence; a single empty row without any."""
    if not names:
        return np.empty((1, 0))
    unit = qmc.Sobol(len(names), seed=seed).random(count)
    return np.stack([value_at(scene, name, unit[:, k]) for k, name in enumerate(names)], axis=-1)
