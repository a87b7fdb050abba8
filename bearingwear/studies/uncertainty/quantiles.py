"""Quantiles of the lives of a scene with uncertain values, and the share of each value in them.

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
from bearingwear.scene.distributions import sampled_values, value_quantiles
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
    """Lives of a method at one preload; without any where no preload is recommended."""

    row: dict[str, Any]  # values of `ANALYSED`
    life: np.ndarray  # (n,) [h] of bearings in which everything uncertain varies


def uncertain_lives(
    scene: Source,
    frictions: Sequence[float] = (),
    methods: Sequence[str] = (),
    samples: int = SAMPLES,
    seed: int = 1,
    workers: int = 1,
    tell: Tell | None = None,
) -> xr.Dataset:
    """Returns quantiles of the life at a scene's own preload.

    frictions: coefficients of ball and race [1]; without any, that of the scene. With some, the
        dataset has the dimension `friction`.
    methods: preload methods, if not the scene's own alone.
    samples: number of bearings in each sample, a power of two.
    workers: processes that solve lives.
    tell: what takes lines of progress.
    """
    plan = sampling_of(samples, seed)
    assumptions: list[str] = []
    settings = [[f"friction.ball_race={mu!r}"] for mu in frictions] or [[]]
    scenes = [uncertain_scene(scene, setting, assumptions.append) for setting in settings]
    if tell and assumptions:
        tell(assumptions[0])
    operation = scenes[0].operation
    preloads = {
        (method, OWN): operation.preload_N for method in methods or [operation.preload_method]
    }
    quantiles = life_quantiles(scenes, preloads, plan, workers, tell, frictions)
    return quantiles.assign_attrs({ASSUMED_SPREAD: assumptions[0]} if assumptions else {})


def recommended_life_quantiles(
    scene: Path, recommendation: Path, samples: int = SAMPLES, seed: int = 1, workers: int = 1
) -> xr.Dataset:
    """Step: returns quantiles of the life at the recommended preload of each method with one.

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
    """Step: returns quantiles and Sobol indices of the life, at the own and recommended preload.

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
    """Returns quantiles of the lives of a scene, and Sobol indices if asked for.

    scenes: one at each of `frictions`, or a single one.
    preloads: by method and choice of preload [N]; NaN where none is recommended.
    """
    rows = []
    with Workers(workers, "uncertainty", tell or False) as pool:
        for scene in scenes:
            rows += _rows_at_preloads(scene, preloads, plan, pool, tell, with_indices)
    methods = dict.fromkeys(method for method, _ in preloads)
    choices = dict.fromkeys(choice for _, choice in preloads)
    axes: dict[Variable, Any] = {
        METHOD: [PRELOAD_METHODS.index(method) for method in methods],
        CHOICE: [PRELOAD_CHOICES.index(choice) for choice in choices or [AS_RECOMMENDED]],
        INPUTS: None,
        PROBABILITY: PROBABILITIES,
        STATUSES: None,
    }
    if len(frictions):
        axes = {FRICTION_AXIS: list(frictions)} | axes
    if with_indices:
        names = tuple(scenes[0].uncertainty or {})
        axes[Variable("quantity", ("quantity",), "", "uncertain value", "i1", flags=names)] = None
    present = {name: ANALYSED[name] for name in ANALYSED if any(name in row for row in rows)}
    return dataset_of_rows(
        present,
        axes,
        rows,
        title=f"Uncertainty in life: {scenes[0].name}",
        kind=KIND,
        scene=scenes[0],
        samples=np.int64(plan.samples),
        seed=np.int64(plan.seed),
        confidence=CONFIDENCE,
    )


def _rows_at_preloads(
    scene: Scene,
    preloads: Mapping[tuple[str, str], float],
    plan: Sampling,
    pool: Workers,
    tell: Tell | None,
    with_indices: bool,
) -> list[dict[str, Any]]:
    """Returns the values of `ANALYSED` at each preload, in their order."""
    lives_by_choice: dict[str, list[MethodLives]] = {}
    rows = []
    for (method, choice), preload in preloads.items():
        lives = MethodLives({"preload": preload}, np.empty(0))
        if np.isfinite(preload):
            at_preload = with_preload(scene, method, preload)
            lives = _lives_at(at_preload, plan, pool, tell)
            if with_indices:
                lives.row.update(_causes(at_preload, plan, pool))
        lives_by_choice.setdefault(choice, []).append(lives)
        rows.append(lives.row)
    for of_methods in lives_by_choice.values():
        _add_longest(of_methods)
    return rows


def _lives_at(scene: Scene, plan: Sampling, pool: Workers, tell: Tell | None) -> MethodLives:
    """Returns lives and their quantiles: of all bearings, within a batch, and over batches."""
    if tell:
        tell(
            f"{scene.operation.preload_method}: sampling {plan.samples} bearings, "
            f"{plan.samples} within a batch, and {plan.samples} batches"
        )
    classes = ALL_INPUTS, SCATTER_ONLY, BATCH_ONLY
    samples = [sample_of(scene, inputs, plan) for inputs in classes]
    medians = np.array([_medians(scene)])
    solved = sampled_lives(scene, np.vstack([medians, *(sample.rows for sample in samples)]), pool)
    all_hours = solved.life * HOURS_PER_SECOND
    hours = dict(zip(classes, np.split(all_hours[1:], len(classes)), strict=True))
    hours[ALL_BUT_WEAR] = hours[ALL_INPUTS]
    factors = {inputs: sample.factors for inputs, sample in zip(classes, samples, strict=True)}
    factors[ALL_BUT_WEAR] = np.ones((plan.samples, 1))
    statuses = LIFE_STATUSES.values()
    row = {
        "preload": scene.operation.preload_N,
        "evaluations": solved.solves,
        "solved_share": solved.solved_share,
        "status_count": [np.count_nonzero(solved.status == status) for status in statuses],
        "nominal_life": all_hours[0],
        "life_sample": [_evenly_spaced(hours[key], factors[key]) for key in sorted(hours)],
    }
    quantiles = np.array(
        [
            [life_quantile(hours[key], factors[key], p) for p in PROBABILITIES]
            for key in sorted(hours)
        ]
    )
    row |= dict(zip(QUANTILE, np.moveaxis(quantiles, -1, 0), strict=True))
    return MethodLives(row, hours[ALL_INPUTS] * factors[ALL_INPUTS][:, 0])


def _evenly_spaced(hours: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """Returns quantiles of lives (n,) times factors (n, draws), at evenly spaced probabilities."""
    solved = np.isfinite(hours)
    if not solved.any():
        return np.full(MEMBERS, np.nan)
    scaled = hours[solved, None] * factors[solved]
    return np.quantile(scaled, (np.arange(MEMBERS) + 0.5) / MEMBERS, method="hazen")


def _add_longest(methods: Sequence[MethodLives]) -> None:
    """Adds to each method how often it gives the longest life, where there are several."""
    sampled = [method for method in methods if len(method.life)]
    if len(sampled) > 1:
        shares = longest_shares(np.array([method.life for method in sampled]))
        for method, share in zip(sampled, shares, strict=True):
            method.row.update(dict(zip(LONGEST_SHARE, share, strict=True)))


def _medians(scene: Scene) -> list[float]:
    """Returns every uncertain value at its median."""
    return [float(value_quantiles(scene, name, np.array(0.5))) for name in scene.uncertainty or {}]


def _causes(scene: Scene, plan: Sampling, pool: Workers) -> dict[str, Any]:
    """Returns Sobol indices of the lives, and lives with one value at its 10 and 90 % quantile."""
    names = list(scene.uncertainty or {})
    base_rows = sobol_rows(scene, plan)
    changed_rows = np.tile(_medians(scene), (2 * len(names), 1))
    for k, name in enumerate(names):
        changed_rows[2 * k : 2 * k + 2, k] = value_quantiles(scene, name, np.array([0.1, 0.9]))
    rows = np.vstack([base_rows.reshape(-1, len(names)), changed_rows])
    lives = sampled_lives(scene, rows, pool).life
    base_lives = lives[: -len(changed_rows)].reshape(base_rows.shape[:2])
    changed_lives = lives[-len(changed_rows) :] * HOURS_PER_SECOND
    columns = [k for k, name in enumerate(names) if name in WORN]
    wear_values = base_rows[..., columns].reshape(-1, len(columns))
    factor = wear_factor(scene, [names[k] for k in columns], wear_values).reshape(base_lives.shape)
    answers = np.stack([base_lives, base_lives / factor], axis=1)  # all inputs, all but wear
    unknown = np.full((2, len(names)), np.nan)  # for the samples that vary one class
    causes: dict[str, Any] = {
        name: np.vstack([indices, unknown])
        for name, indices in sobol_indices(answers, plan.seed).items()
    }
    causes["index_share"] = (answers > 0.0).all(axis=(0, 1)).mean()
    return causes | {"life_one_at_a_time": changed_lives.reshape(-1, 2)}


def sobol_rows(scene: Scene, plan: Sampling) -> np.ndarray:
    """Returns the rows A, B, and A with each value of B (values + 2, samples, values).

    They are those of Saltelli et al. (2010).
    """
    names = list(scene.uncertainty or {})
    columns = np.arange(len(names))
    points = qmc.Sobol(2 * len(names), seed=plan.seed).random(plan.samples)
    a, b = np.hsplit(points, 2)
    matrices = [a, b, *(np.where(columns == k, b, a) for k in columns)]
    return np.stack([sampled_values(scene, names, matrix) for matrix in matrices])
