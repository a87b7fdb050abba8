"""Sobol indices: of all uncertain values together, and within each class of them.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from SALib.analyze import sobol as sobol_analysis

from bearingwear.results.quantiles import CONFIDENCE
from bearingwear.scene.scene import Scene
from bearingwear.studies.sampling import Sampling
from bearingwear.studies.uncertainty.batches import names_of, of_class
from bearingwear.studies.uncertainty.sample import lives, problem, sample

CLASS_SAMPLES = 256
"""Most base samples of the indices within a class."""

RESAMPLES = 200  # of the bootstrap that the errors of the indices come from


def indices(scene: Scene, y: np.ndarray, seed: int) -> dict[str, np.ndarray]:
    """Sobol indices (values,) of an answer y (samples, values + 2) in the order of `sample`."""
    found = sobol_analysis.analyze(
        problem(scene), y.ravel(), calc_second_order=False, num_resamples=RESAMPLES,
        conf_level=CONFIDENCE, seed=seed,
    )  # fmt: skip
    names = {"first_index": "S1", "total_index": "ST"}
    return {name: np.asarray(found[key]) for name, key in names.items()} | {
        f"{name}_error": np.asarray(found[f"{key}_conf"]) for name, key in names.items()
    }


def class_indices(scene: Scene, plan: Sampling) -> np.ndarray:
    """Total indices (values, 2) of log life, each value among those of its class."""
    names = list(scene.uncertainty or {})
    found = np.full((len(names), 2), np.nan)
    for of_batch in (False, True):
        own = names_of(scene, of_batch)
        if not own:
            continue
        one = of_class(scene, of_batch)
        fewer = replace(plan, samples=min(plan.samples, CLASS_SAMPLES), chunks=1)
        rows = sample(one, fewer)
        of_rows = lives(one, rows.reshape(-1, len(own)))
        life = of_rows.life.reshape(*rows.shape[:2], 2)
        usable = (np.isfinite(life) & (life > 0.0)).all(axis=(1, 2))
        for c in range(2):
            y = np.log(life[usable, :, c])
            if y.size and np.ptp(y) > 0.0:
                of_each = indices(one, y, plan.seed)["total_index"]
                found[[names.index(name) for name in own], c] = of_each
    return found
