"""Quantiles of the lives of a scene by what is uncertain in it, and which uncertain value decides.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.stats import qmc

from bearingwear.results.quantiles import (
    ALL_BUT_WEAR,
    ALL_INPUTS,
    ASSUMED_SPREAD,
    BATCH_ONLY,
    CONFIDENCE,
    KIND,
    SCATTER_ONLY,
)
from bearingwear.results.variable import HOURS_PER_SECOND, Variable
from bearingwear.scene.distributions import value_at, values_at
from bearingwear.scene.read import Source
from bearingwear.scene.scene import PRELOAD_METHODS, WORN, Scene
from bearingwear.studies.answers import Tell, Workers
from bearingwear.studies.dataset import dataset_of_rows
from bearingwear.studies.sampling import (
    INDEX_SAMPLES,
    SAMPLES,
    Sampling,
    sampling_of,
    wear_factor,
)
from bearingwear.studies.uncertainty.intervals import life_quantile, longest_shares, sobol_indices
from bearingwear.studies.uncertainty.plan import (
    AS_RECOMMENDED,
    OWN,
    PRELOAD_CHOICES,
    uncertain_scene,
)
from bearingwear.studies.uncertainty.preloads import recommended_preloads, with_preload
from bearingwear.studies.uncertainty.sample import sample_of, sampled_lives
from bearingwear.studies.uncertainty.variables import (
    ANALYSED,
    CHOICE,
    FRICTION_AXIS,
    INPUTS,
    LIFE_STATUSES,
    LONGEST_SHARE,
    METHOD,
    PROBABILITIES,
    PROBABILITY,
    QUANTILE,
    STATUSES,
)

MEMBERS = 512
"""Lives by which a file gives their distribution."""


class MethodLives(NamedTuple):
    """Lives of a method at one preload."""

    row: dict[str, Any]  # `ANALYSED`
    life: np.ndarray  # (n,) [s] of bearings in which everything uncertain varies


def uncertain_lives(
    scene: Source,
    frictions: Sequence[float] = (),
    methods: Sequence[str] = (),
    samples: int = SAMPLES,
    seed: int = 1,
    workers: int = 1,
    tell: Tell | None = None,
) -> xr.Dataset:
    """Quantiles of the life at a scene's own preload.

    frictions: coefficients of ball and race [1]; without any, that of the scene. With some, the
        dataset has the dimension `friction`.
    methods: preload methods, if not the scene's own alone.
    samples: number of bearings in each sample, a power of two.
    workers: processes that solve lives.
    tell: what takes lines of progress.
    """
    plan = sampling_of(samples, seed)
    taken: list[str] = []
    settings = [[f"friction.ball_race={mu!r}"] for mu in frictions] or [[]]
    scenes = [uncertain_scene(scene, one, taken.append) for one in settings]
    if tell and taken:
        tell(taken[0])
    own = scenes[0].operation
    preloads = {(m, OWN): own.preload_N for m in dict.fromkeys(methods or [own.preload_method])}
    found = life_quantiles(scenes, preloads, plan, workers, tell, frictions)
    return found.assign_attrs({ASSUMED_SPREAD: taken[0]} if taken else {})


def recommended_life_quantiles(
    scene: Path, recommendation: Path, samples: int = SAMPLES, seed: int = 1, workers: int = 1
) -> xr.Dataset:
    """Step: quantiles of the life at the recommended preload of each method that has one.

    samples, seed, workers: as of `uncertain_lives`.
    """
    base = uncertain_scene(scene)
    preloads = {
        (method, AS_RECOMMENDED): preload
        for method, preload in recommended_preloads(base, recommendation).items()
        if np.isfinite(preload)
    }
    return life_quantiles([base], preloads, sampling_of(samples, seed), workers)


def quantiles_and_indices(
    scene: Path,
    recommendation: Path,
    methods: Sequence[str],
    samples: int = INDEX_SAMPLES,
    seed: int = 1,
    workers: int = 1,
) -> xr.Dataset:
    """Step: quantiles and Sobol indices of the life, at the own and the recommended preload.

    methods: preload methods.
    samples: number of bearings in each sample and of base samples of the indices, a power of two.
    seed, workers: as of `uncertain_lives`.
    """
    base = uncertain_scene(scene)
    recommended = recommended_preloads(base, recommendation, methods)
    preloads = {}
    for method in methods:
        preloads[method, OWN] = base.operation.preload_N
        preloads[method, AS_RECOMMENDED] = recommended[method]
    plan = sampling_of(samples, seed)
    return life_quantiles([base], preloads, plan, workers, with_indices=True)


def life_quantiles(
    scenes: Sequence[Scene],
    preloads: Mapping[tuple[str, str], float],
    plan: Sampling,
    workers: int = 1,
    tell: Tell | None = None,
    frictions: Sequence[float] = (),
    with_indices: bool = False,
) -> xr.Dataset:
    """Quantiles of the lives of a scene, and Sobol indices if asked for.

    scenes: one at each of `frictions`, or a single one.
    preloads: by method and choice of preload [N]; NaN where none is recommended.
    """
    rows = []
    with Workers(workers, "uncertainty", tell or False) as pool:
        for scene in scenes:
            lives = {key: MethodLives({"preload": n}, np.empty(0)) for key, n in preloads.items()}
            for (method, choice), preload in preloads.items():
                if np.isfinite(preload):
                    at_preload = with_preload(scene, method, preload)
                    lives[method, choice] = _lives_at(at_preload, plan, pool, tell)
                    if with_indices:
                        lives[method, choice].row.update(_causes(at_preload, plan, pool))
            for choice in {choice for _, choice in preloads}:
                _add_longest([one for key, one in lives.items() if key[1] == choice])
            rows += [one.row for one in lives.values()]
    axes: dict[Variable, Any] = {
        METHOD: [PRELOAD_METHODS.index(one) for one in dict.fromkeys(m for m, _ in preloads)],
        CHOICE: [PRELOAD_CHOICES.index(one) for one in dict.fromkeys(c for _, c in preloads)]
        or [PRELOAD_CHOICES.index(AS_RECOMMENDED)],
        INPUTS: None,
        PROBABILITY: PROBABILITIES,
        STATUSES: None,
    }
    if len(frictions):
        axes = {FRICTION_AXIS: list(frictions)} | axes
    if with_indices:
        names = tuple(scenes[0].uncertainty or {})
        axes[Variable("quantity", ("quantity",), "", "uncertain value", "i1", flags=names)] = None
    known = {name: one for name, one in ANALYSED.items() if any(name in row for row in rows)}
    return dataset_of_rows(
        known,
        axes,
        rows,
        title=f"Uncertainty in life: {scenes[0].name}",
        kind=KIND,
        scene=scenes[0],
        samples=np.int64(plan.samples),
        seed=np.int64(plan.seed),
        confidence=CONFIDENCE,
    )


def _lives_at(scene: Scene, plan: Sampling, pool: Workers, tell: Tell | None) -> MethodLives:
    """Lives and their quantiles: of all bearings, within a batch, and of the bearing of a batch."""
    if tell:
        tell(
            f"{scene.operation.preload_method}: sampling {plan.samples} bearings, "
            f"{plan.samples} within a batch, and {plan.samples} batches"
        )
    varied = ALL_INPUTS, SCATTER_ONLY, BATCH_ONLY
    samples = [sample_of(scene, inputs, plan) for inputs in varied]
    rows = [np.array([_medians(scene)]), *(one.rows for one in samples)]
    found = sampled_lives(scene, np.vstack(rows), pool)
    nominal, *lives = np.split(
        found.life * HOURS_PER_SECOND, np.cumsum([len(r) for r in rows[:-1]])
    )
    hours = dict(zip(varied, lives, strict=True)) | {ALL_BUT_WEAR: lives[0]}
    factors = {inputs: one.factors for inputs, one in zip(varied, samples, strict=True)}
    factors[ALL_BUT_WEAR] = np.ones((plan.samples, 1))
    row = {
        "preload": scene.operation.preload_N,
        "evaluations": found.solves,
        "solved_share": found.solved_share,
        "status_count": [np.count_nonzero(found.status == s) for s in LIFE_STATUSES.values()],
        "nominal_life": nominal[0],
        "life_sample": [_evenly_spaced(hours[i], factors[i]) for i in sorted(hours)],
    }
    quantiles = np.array(
        [[life_quantile(hours[i], factors[i], p) for p in PROBABILITIES] for i in sorted(hours)]
    )
    row |= dict(zip(QUANTILE, np.moveaxis(quantiles, -1, 0), strict=True))
    return MethodLives(row, lives[0] * samples[0].factors[:, 0])


def _evenly_spaced(hours: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """Quantiles of lives (n,) times factors (n, draws) at evenly spaced probabilities."""
    solved = np.isfinite(hours)
    if not solved.any():
        return np.full(MEMBERS, np.nan)
    every = hours[solved, None] * factors[solved]
    return np.quantile(every, (np.arange(MEMBERS) + 0.5) / MEMBERS, method="hazen")


def _add_longest(methods: Sequence[MethodLives]) -> None:
    """Add to each method how often it gives the longest life, where there are several."""
    some = [one for one in methods if len(one.life)]
    if len(some) > 1:
        for one, share in zip(some, longest_shares(np.array([o.life for o in some])), strict=True):
            one.row.update(dict(zip(LONGEST_SHARE, share, strict=True)))


def _medians(scene: Scene) -> list[float]:
    """Every uncertain value at its median."""
    return [float(value_at(scene, name, np.array(0.5))) for name in scene.uncertainty or {}]


def _causes(scene: Scene, plan: Sampling, pool: Workers) -> dict[str, Any]:
    """Sobol indices of the lives, and lives with one value at its 10 % and 90 % quantile [h]."""
    names = list(scene.uncertainty or {})
    rows = sobol_rows(scene, plan)
    around = np.tile(_medians(scene), (2 * len(names), 1))
    for k, name in enumerate(names):
        around[2 * k : 2 * k + 2, k] = value_at(scene, name, np.array([0.1, 0.9]))
    found = sampled_lives(scene, np.vstack([rows.reshape(-1, len(names)), around]), pool)
    lives = found.life[: -len(around)].reshape(rows.shape[:2])
    worn = [k for k, name in enumerate(names) if name in WORN]
    values = rows[..., worn].reshape(-1, len(worn))
    factor = wear_factor(scene, [names[k] for k in worn], values).reshape(lives.shape)
    answers = np.stack([lives, lives / factor], axis=1)  # with all inputs, and all but wear
    nothing = np.full((2, len(names)), np.nan)  # of the samples that vary one class
    indices: dict[str, Any] = {
        name: np.vstack([of_each, nothing])
        for name, of_each in sobol_indices(answers, plan.seed).items()
    }
    indices["index_share"] = (answers > 0.0).all(axis=(0, 1)).mean()
    hours = found.life[-len(around) :] * HOURS_PER_SECOND
    return indices | {"life_one_at_a_time": hours.reshape(-1, 2)}


def sobol_rows(scene: Scene, plan: Sampling) -> np.ndarray:
    """Values (values + 2, samples, values): A, B, and A with each value of B (Saltelli 2010)."""
    names = list(scene.uncertainty or {})
    columns = np.arange(len(names))
    unit = qmc.Sobol(2 * len(names), seed=plan.seed).random(plan.samples)
    a, b = np.hsplit(unit, 2)
    every = [a, b, *(np.where(columns == k, b, a) for k in columns)]
    return np.stack([values_at(scene, names, one) for one in every])
