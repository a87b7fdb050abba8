"""Quantiles of sampled lives, and the uncertain value that decides.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy import stats

from bearingwear.kernels.status import OK
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.quantiles import CONFIDENCE, KIND, PRELOAD_CHOICE, TAKEN
from bearingwear.results.variable import HOURS_PER_SECOND, Variable
from bearingwear.scene.checking.check import record
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.distributions import value_at
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.studies.dataset import filled
from bearingwear.studies.design.recommend import recommended_for
from bearingwear.studies.pool import Tell
from bearingwear.studies.sampling import INDEX_SAMPLES, SAMPLES, Sampling
from bearingwear.studies.uncertainty.batches import (
    BATCH_PROBABILITIES,
    PROBABILITIES,
    Batches,
    names_of,
    of_class,
    quantiles_with_error,
)
from bearingwear.studies.uncertainty.plan import (
    AS_RECOMMENDED,
    OWN,
    PRELOAD_CHOICES,
    uncertain_scene,
)
from bearingwear.studies.uncertainty.sample import (
    PART_KIND,
    STATED,
    independent_rows,
    independent_wear_factors,
    lives,
    problem,
    sample,
    with_preload,
    worse,
)
from bearingwear.studies.uncertainty.surrogate import EXACT, Stated
from bearingwear.studies.uncertainty.variables import (
    ANALYSED,
    BATCH,
    CHOICE,
    INDEX,
    INPUTS,
    LONGEST_SHARE,
    METHOD,
    PROBABILITY,
    UNCERTAINTY_AXES,
)

MEMBERS = 512
"""Lives by which a file gives their distribution."""


class Analysed(NamedTuple):
    """Lives of a method at one preload."""

    row: dict[str, Any]  # `ANALYSED`
    life: np.ndarray  # (n,) of independent bearings; NaN where none was found
    known: Stated


def quantiles_and_indices(
    scene: Path, parts: Sequence[Path], sampling: Mapping[str, int]
) -> xr.Dataset:
    """Step: quantiles of life and Sobol indices of its logarithm, from all parts of a sample.

    parts: sampled lives.
    sampling: `Sampling` by its fields.
    CaseFileError: a file that is no such part, of another scene or sampling, or parts missing.
    """
    problem_scene, plan = uncertain_scene(scene), Sampling(**sampling)
    found = _parts(parts, problem_scene, plan)
    methods = list(dict.fromkeys(method for method, _ in found))
    table = {
        (method, choice): _analysed(problem_scene, method, found[method, choice], plan)
        for method in methods
        for choice in PRELOAD_CHOICES
    }
    for choice in PRELOAD_CHOICES:
        _add_longest([table[method, choice] for method in methods])
    names = tuple(problem_scene.uncertainty or {})
    quantity = Variable("quantity", ("quantity",), "", "uncertain value", dtype="i1", flags=names)
    rows = [one.row for one in table.values()]
    return _dataset(problem_scene, plan, methods, PRELOAD_CHOICES, rows, {quantity: None})


def _parts(
    paths: Sequence[Path], scene: Scene, plan: Sampling
) -> dict[tuple[str, str], list[xr.Dataset]]:
    """Sampled lives by method and choice of preload, in the order of the chunks."""
    parts: dict[tuple[str, str], list[xr.Dataset]] = {}
    for path in paths:
        part = load(path)
        if part.attrs.get("kind") != PART_KIND:
            raise CaseFileError(
                f"{path}: got a file of another kind, expected a part of the sampled lives"
            )
        sampled = {name: int(part.attrs[name]) for name in ("samples", "seed", "chunks")}
        if json.loads(part.attrs["scene"]) != scene.to_dict() or Sampling(**sampled) != plan:
            raise CaseFileError(
                f"{path}: got a different scene or sampling, expected those of the study"
            )
        parts.setdefault((part.attrs["preload_method"], part.attrs[PRELOAD_CHOICE]), []).append(
            part
        )
    ordered = {}
    for method in (m for m in PRELOAD_METHODS if any(m == known for known, _ in parts)):
        for choice in PRELOAD_CHOICES:
            some = sorted(
                parts.get((method, choice), []), key=lambda part: int(part.attrs["chunk"])
            )
            if [int(part.attrs["chunk"]) for part in some] != list(range(plan.chunks)):
                raise CaseFileError(
                    f"sampled lives for {method}, {choice} preload: some parts are missing"
                )
            ordered[method, choice] = some
    return ordered


def life_quantiles(
    scene: str | Path,
    friction: float | None = None,
    methods: Sequence[str] = (),
    samples: int = SAMPLES,
    seed: int = 1,
    workers: int = 1,
    tell: Tell | None = None,
) -> xr.Dataset:
    """Step: quantiles of the life at a scene's own preload.

    friction: coefficient of ball and race, if not the scene's own [1].
    methods: preload methods, if not the scene's own alone.
    samples: half of the number of lives, a power of two.
    workers: processes that follow grooves.
    tell: what takes lines of progress.
    """
    try:
        plan = record(Sampling, {"samples": samples, "seed": seed})
    except SceneError as error:
        raise CaseFileError(f"--{error.key}: {error.problem}") from None
    settings = [] if friction is None else [f"friction.ball_race={friction!r}"]
    said: list[str] = []
    base = uncertain_scene(scene, settings, said.append)
    if tell and said:
        tell(said[0])
    methods = list(dict.fromkeys(methods or [base.operation.preload_method]))
    found = own_quantiles(base, methods, plan, workers, tell)
    return found.assign_attrs({TAKEN: said[0]} if said else {})


def own_quantiles(
    scene: Scene,
    methods: Sequence[str],
    plan: Sampling,
    workers: int = 1,
    tell: Tell | None = None,
) -> xr.Dataset:
    """Quantiles of the life at the scene's own preload: 2 x samples lives, and no indices."""
    preloads = dict.fromkeys(methods, scene.operation.preload_N)
    return _quantiles_at(scene, preloads, plan, OWN, workers, tell)


def recommended_life_quantiles(
    scene: Path, recommendation: Path, samples: int = SAMPLES, seed: int = 1
) -> xr.Dataset:
    """Step: quantiles of the life at the recommended preload of each method that has one.

    samples, seed: as of `life_quantiles`.
    """
    base, found = uncertain_scene(scene), load(recommendation)
    preloads = {
        PRELOAD_METHODS[int(flag)]: float(preload)
        for flag, preload in zip(found["preload_method"], found["preload"], strict=True)
        if np.isfinite(preload)
    }
    recommended_for(base, found)
    return _quantiles_at(base, preloads, Sampling(samples=samples, seed=seed), AS_RECOMMENDED)


def _quantiles_at(
    scene: Scene,
    preloads: Mapping[str, float],
    plan: Sampling,
    choice: str,
    workers: int = 1,
    tell: Tell | None = None,
) -> xr.Dataset:
    """Quantiles of the life at a preload [N] of each method."""
    table = []
    for method, preload in preloads.items():
        preloaded = with_preload(scene, method, preload)
        rows, batches = independent_rows(preloaded, plan), Batches(preloaded, plan)
        if tell:
            tell(
                f"{method}: sampling the lives of {len(rows)} independent bearings and of the same "
                "number of bearings in batches"
            )
        found = lives(preloaded, np.vstack([_middle(preloaded), rows, batches.rows]), workers, tell)
        independent, known = slice(1, len(rows) + 1), worse(found.cost)
        life, solved = found.life[independent], found.status[independent] == OK
        hours = life * HOURS_PER_SECOND / found.wear_factor[independent]
        row = {
            "preload": preload,
            "evaluations": solved.size,
            "solved_share": solved.mean(),
            "nominal_life": found.life[0] * HOURS_PER_SECOND,
            **found.cost,
            **batches.quantiles(found.life[len(rows) + 1 :], known),
            **_quantiles_of(preloaded, plan, hours, known),
        }
        table.append(Analysed(row, life, known))
    _add_longest(table)
    return _dataset(scene, plan, list(preloads), [choice], [one.row for one in table])


def _dataset(
    scene: Scene,
    plan: Sampling,
    methods: Sequence[str],
    choices: Sequence[str],
    table: Sequence[Mapping[str, Any]],
    more: Mapping[Variable, Any] = MappingProxyType({}),
) -> xr.Dataset:
    """What was found, by method and choice of preload, and further axes, as a file."""
    axes: dict[str, Any] = {
        METHOD: [PRELOAD_METHODS.index(method) for method in methods],
        CHOICE: [PRELOAD_CHOICES.index(one) for one in choices],
        INPUTS: None,
        PROBABILITY: PROBABILITIES,
        BATCH: BATCH_PROBABILITIES,
    }
    known = {name: one for name, one in ANALYSED.items() if any(name in row for row in table)}
    return filled(
        known,
        {UNCERTAINTY_AXES[name]: values for name, values in axes.items()} | dict(more),
        table,
        title=f"Uncertainty in life: {scene.name}",
        kind=KIND,
        scene=scene,
        samples=np.int64(plan.samples),
        seed=np.int64(plan.seed),
        confidence=CONFIDENCE,
    )


def _analysed(scene: Scene, method: str, parts: Sequence[xr.Dataset], plan: Sampling) -> Analysed:
    """Of the parts of a sample; nothing where there is no preload."""
    found: dict[str, Any] = {"preload": float(parts[0].attrs["preload_N"]), "evaluations": 0}
    if "life" not in parts[0]:
        return Analysed(found, np.empty(0), EXACT)
    whole = xr.concat(parts, "base")
    solved = whole["status"].values == OK
    life, factor = whole["life"].values, whole["wear_factor"].values
    usable = (solved & (life > 0.0)).all(axis=1)
    found["evaluations"] = solved.size
    found["solved_share"] = solved.mean()
    for name in ("solved_lives", "followed_lives"):
        found[name] = sum(int(part.attrs[name]) for part in parts)
    for name in STATED:
        found[name] = max(float(part.attrs[name]) for part in parts)
    found["index_share"] = usable.mean()
    # of A and B; the others repeat them
    halves, factors = ((x[:, [0, -1]]).ravel() for x in (life, factor))
    known, at_preload = worse(found), with_preload(scene, method, found["preload"])
    found |= _quantiles_of(at_preload, plan, halves / factors, known)
    shape = 2, len(scene.uncertainty or {})
    for name, variable in ANALYSED.items():
        if variable.dims == INDEX:
            found[name] = np.full(shape, np.nan)
    for k, one in enumerate((life, life / factor)):  # as `uncertain_inputs`
        y = np.log(one[usable])
        if y.size and np.ptp(y) > 0.0:
            for name, values in indices(scene, y, plan.seed).items():
                found[name][k] = values
    batches = Batches(at_preload, plan)
    of_batches = lives(at_preload, batches.rows)
    found |= batches.quantiles(of_batches.life, worse(of_batches.cost))
    found["class_index"] = class_indices(at_preload, plan)
    return Analysed(found | _one_at_a_time(at_preload), halves, known)


def _add_longest(methods: Sequence[Analysed]) -> None:
    """Add to each method how often it gives the longest life, where there are several."""
    some = [one for one in methods if len(one.life)]
    if len(some) > 1:
        shares = longest_shares(np.array([one.life for one in some]), [one.known for one in some])
        for one, share in zip(some, shares, strict=True):
            one.row.update(dict(zip(LONGEST_SHARE, share, strict=True)))


def longest_shares(life: np.ndarray, known: Sequence[Stated]) -> np.ndarray:
    """Shares (methods, 3) of bearings that live longest by each method, and their intervals.

    The intervals are those of Clopper and Pearson (1934). A bearing whose lives differ by less than
    their errors may be longest by either; so may the share of lives whose error is not known.

    life (methods, n): at the same sampled values; NaN where none was found.
    known: of the lives of each method.
    """
    found = np.full((len(life), 3), np.nan)
    error = np.array([one.error for one in known])[:, None]
    share = sum(one.share for one in known)
    lives = life[:, np.isfinite(life).all(axis=0)]
    if not lives.size:
        return found
    least, most = lives * (1.0 - error), lives * (1.0 + error)
    for m in range(len(lives)):
        others = np.arange(len(lives)) != m
        is_longest, is_surely, is_maybe = (
            (own[m] > other[others]).all(axis=0)
            for own, other in ((lives, lives), (least, most), (most, least))
        )
        found[m] = (
            is_longest.mean(),
            max(_interval(is_surely).low - share, 0.0),
            min(_interval(is_maybe).high + share, 1.0),
        )
    return found


def _interval(happened: np.ndarray) -> Any:
    """Confidence interval of a probability, by what happened how often."""
    return stats.binomtest(int(happened.sum()), happened.size).proportion_ci(CONFIDENCE)


def _one_at_a_time(scene: Scene) -> dict[str, np.ndarray]:
    """The nominal life, and lives with one value at its 10 % and 90 % quantile [h]."""
    names, middle = list(scene.uncertainty or {}), _middle(scene)
    rows = [middle]
    for j, name in enumerate(names):
        for p in (0.1, 0.9):
            value = float(value_at(scene, name, np.array(p)))
            rows.append([value if i == j else v for i, v in enumerate(middle)])
    nominal, *around = lives(scene, np.array(rows)).life * HOURS_PER_SECOND
    return {
        "nominal_life": nominal,
        "life_one_at_a_time": np.array(around).reshape(len(names), 2),
    }


def _middle(scene: Scene) -> list[float]:
    """Every uncertain value at its median."""
    return [float(value_at(scene, name, np.array(0.5))) for name in scene.uncertainty or {}]


def _quantiles_of(
    scene: Scene, plan: Sampling, hours: np.ndarray, known: Stated
) -> dict[str, np.ndarray]:
    """Of the lives (2 samples,) of `independent_rows` with K_s and H of the scene.

    With all uncertain values, and without those of K_s and H.
    """
    found, members, solved = [], [], np.isfinite(hours)
    for factors in (independent_wear_factors(scene, plan), np.ones((len(hours), 1))):
        # one batch, of independent bearings
        found.append(quantiles_with_error(hours[None], factors, np.ones((1, 1)), known, (0.5,)))
        every = (hours[solved, None] * factors[solved]).ravel()
        even = (np.arange(MEMBERS) + 0.5) / MEMBERS
        nothing = np.full(MEMBERS, np.nan)
        members.append(np.quantile(every, even, method="hazen") if solved.any() else nothing)
    names = ("life_quantile", "life_quantile_low", "life_quantile_high")
    ends = {name: np.array([one[k][0] for one in found]) for k, name in enumerate(names)}
    return ends | {"life_sample": np.array(members)}


RESAMPLES = 200  # of the bootstrap that the errors of the indices come from


def indices(scene: Scene, y: np.ndarray, seed: int) -> dict[str, np.ndarray]:
    """Sobol indices (values,) of an answer y (samples, values + 2) in the order of `sample`."""
    from SALib.analyze import sobol as sobol_analysis  # takes a second, and few ask for indices

    found = sobol_analysis.analyze(
        problem(scene), y.ravel(), calc_second_order=False, num_resamples=RESAMPLES,
        conf_level=CONFIDENCE, seed=seed,
    )  # fmt: skip
    names = {"first_index": "S1", "total_index": "ST"}
    return {name: np.asarray(found[key]) for name, key in names.items()} | {
        f"{name}_error": np.asarray(found[f"{key}_conf"]) for name, key in names.items()
    }


def class_indices(scene: Scene, plan: Sampling) -> np.ndarray:
    """Total indices (values,) of log life, each value among those of its class."""
    names = list(scene.uncertainty or {})
    found = np.full(len(names), np.nan)
    for of_batch in (False, True):
        own = names_of(scene, of_batch)
        if not own:
            continue
        one = of_class(scene, of_batch)
        fewer = replace(plan, samples=min(plan.samples, INDEX_SAMPLES), chunks=1)
        rows = sample(one, fewer)
        of_rows = lives(one, rows.reshape(-1, len(own)))
        life = of_rows.life.reshape(rows.shape[:2])
        usable = (np.isfinite(life) & (life > 0.0)).all(axis=1)
        y = np.log(life[usable])
        if y.size and np.ptp(y) > 0.0:
            of_each = indices(one, y, plan.seed)["total_index"]
            found[[names.index(name) for name in own]] = of_each
    return found
