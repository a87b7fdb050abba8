"""Quantiles of the lives of a scene with uncertain values, and the share of each value in them.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
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
"""Number of lives in a file that represent their distribution."""


class MethodLives(NamedTuple):
    """Sampled lives with a preload method at one preload.

    Where no preload is recommended, there are no lives, and the row has the preload NaN alone.
    """

    row: dict[str, Any]  # values of `ANALYSED` by their names
    life: np.ndarray  # of bearings in which everything uncertain varies (n,) [h]


def uncertain_lives(
    scene: Source,
    frictions: Sequence[float] = (),
    methods: Sequence[str] = (),
    samples: int = SAMPLES,
    seed: int = 1,
    workers: int = 1,
    tell: Tell | None = None,
) -> xr.Dataset:
    """Returns quantiles of the life at a scene's own preload [h], as a dataset.

    Its variables are those of `ANALYSED` without the effects of single values, over friction,
    preload method, choice of preload, inputs that vary, and probability. Where the scene has no
    `uncertainty`, usual distributions are assumed, and the attribute `ASSUMED_SPREAD` describes
    them.

    frictions: coefficients of ball and race [1], which replace that of the scene. Without any, the
        dataset has no dimension `friction`.
    methods: preload methods; without any, that of the scene alone.
    samples: number of bearings in each sample, a power of two.
    seed: of the samples.
    workers: processes that solve lives.
    tell: takes lines of progress, and a line on distributions that are assumed.

    SceneError: as `uncertain_scene`; or `samples` or `seed` is invalid.
    NotAvailable: no life could be solved by any model.
    """
    plan = sampling_of(samples, seed)
    assumptions: list[str] = []
    # the changes `KEY=VALUE` of each scene: one for each friction, or the scene without changes
    settings = [[f"friction.ball_race={mu!r}"] for mu in frictions] if len(frictions) else [[]]
    scenes = [uncertain_scene(scene, changes, assumptions.append) for changes in settings]
    # all scenes have the same assumption
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
    """Step: returns quantiles of the life at the recommended preload of each method that has one.

    Without any, the dataset has no method.

    recommendation: file of `bearingwear recommend`.
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

    They are NaN at a recommended preload where none is recommended.

    recommendation: file of `bearingwear recommend`.
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

    The dataset has the variables of `ANALYSED` over the axes of `_quantile_axes`.

    scenes: one at each of `frictions`, or a single one.
    preloads: [N] by preload method and choice, of `PRELOAD_CHOICES`; NaN where none is recommended.
    plan: size and seed of the samples.
    workers, tell: as of `uncertain_lives`.
    with_indices: whether to compute the indices, too, which takes many more lives.
    """
    rows = []
    with Workers(workers, "uncertainty", tell or False) as pool:
        for scene in scenes:
            rows += _rows_at_preloads(scene, preloads, plan, pool, tell, with_indices)
    present = {name: ANALYSED[name] for name in ANALYSED if any(name in row for row in rows)}
    quantities = tuple(scenes[0].uncertainty or {}) if with_indices else ()
    return dataset_of_rows(
        present,
        _quantile_axes(preloads, frictions, quantities),
        rows,
        title=f"Uncertainty in life: {scenes[0].name}",
        kind=KIND,
        scene=scenes[0],
        samples=np.int64(plan.samples),
        seed=np.int64(plan.seed),
        confidence=CONFIDENCE,
    )


def _quantile_axes(
    preloads: Iterable[tuple[str, str]], frictions: Sequence[float], quantities: tuple[str, ...]
) -> dict[Variable, Any]:
    """Returns the values of each axis of a file of quantiles; None stands for all flags of an axis.

    preloads: pairs of a preload method and a choice of preload.
    frictions: without any, there is no axis of friction.
    quantities: names of uncertain values; without any, there is no axis of these.
    """
    methods = dict.fromkeys(method for method, _ in preloads)
    choices = dict.fromkeys(choice for _, choice in preloads)
    axes: dict[Variable, Any] = {FRICTION_AXIS: list(frictions)} if len(frictions) else {}
    axes |= {
        METHOD: [PRELOAD_METHODS.index(method) for method in methods],
        CHOICE: [PRELOAD_CHOICES.index(choice) for choice in choices or [AS_RECOMMENDED]],
        INPUTS: None,
        PROBABILITY: PROBABILITIES,
        STATUSES: None,
    }
    if quantities:
        quantity = Variable(
            "quantity", ("quantity",), "", "uncertain value", "i1", flags=quantities
        )
        axes[quantity] = None
    return axes


def _rows_at_preloads(
    scene: Scene,
    preloads: Mapping[tuple[str, str], float],
    plan: Sampling,
    pool: Workers,
    tell: Tell | None,
    with_indices: bool,
) -> list[dict[str, Any]]:
    """Returns the values of `ANALYSED` at each preload, in their order.

    The arguments are those of `life_quantiles`; the processes of `pool` solve the lives.
    """
    lives_by_choice: dict[str, list[MethodLives]] = {}
    rows = []
    for (method, choice), preload in preloads.items():
        lives = MethodLives({"preload": preload}, np.empty(0))
        if np.isfinite(preload):
            at_preload = with_preload(scene, method, preload)
            lives = _method_lives(at_preload, plan, pool, tell)
            if with_indices:
                lives.row.update(_effects_of_values(at_preload, plan, pool))
        lives_by_choice.setdefault(choice, []).append(lives)
        rows.append(lives.row)
    for lives_by_method in lives_by_choice.values():
        _add_longest_shares(lives_by_method)
    return rows


def _method_lives(scene: Scene, plan: Sampling, pool: Workers, tell: Tell | None) -> MethodLives:
    """Returns lives at the scene's preload, with the row of their quantiles and statuses.

    The first two rows of quantiles (inputs, probabilities) have all values varied, and all but the
    wear coefficient and hardness. The other two are those within a batch, and over batches.
    """
    if tell:
        tell(
            f"{scene.operation.preload_method}: sampling {plan.samples} bearings, "
            f"{plan.samples} within a batch, and {plan.samples} batches"
        )
    solved_inputs = ALL_INPUTS, SCATTER_ONLY, BATCH_ONLY
    samples = {inputs: sample_of(scene, inputs, plan) for inputs in solved_inputs}
    medians = np.array([_medians(scene)])  # the first row, whose life is the nominal one
    rows = np.vstack([medians, *(sample.rows for sample in samples.values())])
    solved = sampled_lives(scene, rows, pool)
    all_hours = solved.life * HOURS_PER_SECOND
    hours = dict(zip(samples, np.split(all_hours[1:], len(samples)), strict=True))
    hours[ALL_BUT_WEAR] = hours[ALL_INPUTS]
    factors = {inputs: sample.factors for inputs, sample in samples.items()}
    factors[ALL_BUT_WEAR] = np.ones((plan.samples, 1))
    statuses = LIFE_STATUSES.values()
    flags = sorted(hours)  # the order of the axis of inputs
    row = {
        "preload": scene.operation.preload_N,
        "evaluations": solved.solves,
        "solved_share": solved.solved_share,
        "status_count": [np.count_nonzero(solved.status == status) for status in statuses],
        "nominal_life": all_hours[0],
        "life_sample": [_evenly_spaced_lives(hours[flag], factors[flag]) for flag in flags],
    }
    quantiles = np.array(
        [[life_quantile(hours[flag], factors[flag], p) for p in PROBABILITIES] for flag in flags]
    )
    row |= dict(zip(QUANTILE, np.moveaxis(quantiles, -1, 0), strict=True))
    return MethodLives(row, hours[ALL_INPUTS] * factors[ALL_INPUTS][:, 0])


def _evenly_spaced_lives(hours: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """Returns `MEMBERS` quantiles of scaled lives, at evenly spaced probabilities; NaN for no life.

    hours: lives (n,); NaN where one was not solved.
    factors: (n, draws) by which each life is scaled.
    """
    solved = np.isfinite(hours)
    if not solved.any():
        return np.full(MEMBERS, np.nan)
    scaled = hours[solved, None] * factors[solved]
    return np.quantile(scaled, (np.arange(MEMBERS) + 0.5) / MEMBERS, method="hazen")


def _add_longest_shares(methods: Sequence[MethodLives]) -> None:
    """Adds to the row of each method the share of bearings that it gives the longest life.

    Methods without lives are left out. If only one has lives, no share is added.

    methods: lives with each method at the same choice of preload.
    """
    sampled = [method for method in methods if len(method.life)]
    if len(sampled) > 1:
        shares = longest_shares(np.array([method.life for method in sampled]))
        for method, share in zip(sampled, shares, strict=True):
            method.row.update(dict(zip(LONGEST_SHARE, share, strict=True)))


def _medians(scene: Scene) -> list[float]:
    """Returns the median of each uncertain value, in the order and units of `uncertainty`."""
    return [float(value_quantiles(scene, name, np.array(0.5))) for name in scene.uncertainty or {}]


def _effects_of_values(scene: Scene, plan: Sampling, pool: Workers) -> dict[str, Any]:
    """Returns how much each uncertain value changes the life, by the names of `ANALYSED`.

    These are Sobol indices of the lives with their errors (inputs, values), and the share of base
    samples that they use. Further lives [h] have one value at its 10 or 90 % quantile, and the
    others at their medians (values, 2). Indices are NaN for inputs that vary within a batch or over
    batches alone.
    """
    names = list(scene.uncertainty or {})
    base_rows = sobol_rows(scene, plan)
    changed_rows = np.tile(_medians(scene), (2 * len(names), 1))
    for k, name in enumerate(names):
        changed_rows[2 * k : 2 * k + 2, k] = value_quantiles(scene, name, np.array([0.1, 0.9]))
    rows = np.vstack([base_rows.reshape(-1, len(names)), changed_rows])
    lives = sampled_lives(scene, rows, pool).life
    base_lives = lives[: -len(changed_rows)].reshape(base_rows.shape[:2])
    changed_lives = lives[-len(changed_rows) :] * HOURS_PER_SECOND
    wear_columns = [k for k, name in enumerate(names) if name in WORN]
    wear_names = [names[k] for k in wear_columns]
    wear_values = base_rows[..., wear_columns].reshape(-1, len(wear_columns))
    factors = wear_factor(scene, wear_names, wear_values).reshape(base_lives.shape)
    outputs = np.stack([base_lives, base_lives / factors], axis=1)  # all inputs, all but wear
    unknown = np.full((2, len(names)), np.nan)  # of scatter only and of batch only
    effects: dict[str, Any] = {
        name: np.vstack([indices, unknown])
        for name, indices in sobol_indices(outputs, plan.seed).items()
    }
    effects["index_share"] = (outputs > 0.0).all(axis=(0, 1)).mean()
    effects["life_one_at_a_time"] = changed_lives.reshape(-1, 2)
    return effects


def sobol_rows(scene: Scene, plan: Sampling) -> np.ndarray:
    """Returns the base samples of Sobol indices (values + 2, samples, values).

    The first index counts the samples A, B, and A with each value in turn from B (Saltelli et al.
    2010). Values are those of `uncertainty`, in its order and units.
    """
    names = list(scene.uncertainty or {})
    columns = np.arange(len(names))
    points = qmc.Sobol(2 * len(names), seed=plan.seed).random(plan.samples)
    a, b = np.hsplit(points, 2)  # probabilities, of which `sampled_values` makes values
    matrices = [a, b, *(np.where(columns == k, b, a) for k in columns)]
    return np.stack([sampled_values(scene, names, matrix) for matrix in matrices])
