"""Lives at sampled values of the uncertain keys of a scene.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.stats import qmc

from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.quantiles import PRELOAD_CHOICE
from bearingwear.results.variable import HOURS_PER_SECOND, STATUS, Variable, table
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.distributions import values_at
from bearingwear.scene.scene import PRELOAD_METHODS, WORN, Scene
from bearingwear.scene.uncertain import friction_correlation
from bearingwear.studies.dataset import filled
from bearingwear.studies.design.recommend import recommended_for
from bearingwear.studies.pool import Tell
from bearingwear.studies.sampling import Sampling, wear_factor
from bearingwear.studies.uncertainty.grooves import FoundLives, found_lives
from bearingwear.studies.uncertainty.plan import OWN, uncertain_scene
from bearingwear.studies.uncertainty.surrogate import Stated

PART_KIND = "sampled lives"
BASE = Variable("base", ("base",), "1", "index of the base sample", dtype="i8")

SAMPLED = table(
    replace(STATUS, comment=None),
    Variable(
        "end_criterion", (), "", "criterion that determines the end of life", "i1", flags=CRITERIA
    ),
    Variable(
        "wear_factor",
        (),
        "1",
        "ratio of the life to that computed with the K_s and hardness in the scene",
    ),
    Variable("life", (), "h", "wear life", scale=HOURS_PER_SECOND),
)
"""What is found at sampled values."""


def problem(scene: Scene) -> dict[str, Any]:
    """The uncertain values as SALib takes them, by their probabilities."""
    names = list(scene.uncertainty or {})
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}


def independent(scene: Scene, plan: Sampling) -> np.ndarray:
    """Probabilities (2 samples, values) of A and B of `sample`."""
    count = len(scene.uncertainty or {})
    return qmc.Sobol(2 * count, seed=plan.seed).random(plan.samples).reshape(-1, count)


def independent_rows(scene: Scene, plan: Sampling) -> np.ndarray:
    """Values (2 samples, values) of A and B of `sample`."""
    return values_at(scene, list(scene.uncertainty or {}), independent(scene, plan))


def independent_wear_factors(scene: Scene, plan: Sampling) -> np.ndarray:
    """`pooled_wear_factors` (2 samples, draws) of `independent_rows`."""
    names = list(scene.uncertainty or {})
    worn = [name for name in names if name in WORN]
    return pooled_wear_factors(scene, worn, names, independent(scene, plan))


def sample(scene: Scene, plan: Sampling) -> np.ndarray:
    """Values (samples, values + 2, values): of each base sample A, A with one value of B each, B.

    A scrambled Sobol sequence in Saltelli's arrangement; the same for the same seed.
    """
    sampled = problem(scene)
    from SALib.sample import sobol as sobol_sample  # takes a second, and few ask for indices

    unit = sobol_sample.sample(sampled, plan.samples, calc_second_order=False, seed=plan.seed)
    return values_at(scene, sampled["names"], unit).reshape(plan.samples, -1, sampled["num_vars"])


@dataclass(frozen=True, kw_only=True)
class SampledLives(FoundLives):
    """Lives at sampled values; `wear_factor` (n,) is that on the life by K_s and H."""

    wear_factor: np.ndarray

    @property
    def cost(self) -> dict[str, float]:
        """How many were solved, and how well the others are known, by names of variables."""
        return {
            "solved_lives": self.solved,
            "followed_lives": self.followed,
            **dict(zip(STATED, (*self.known, *self.worn), strict=True)),
        }


STATED = "interpolation_error", "interpolation_share", "groove_error", "groove_share"


def worse(cost: Mapping[str, float]) -> Stated:
    """Of lives with Hertzian and with worn grooves, by which intervals of quantiles are widened."""
    error, share, groove_error, groove_share = (cost[name] for name in STATED)
    return Stated(np.fmax(error, groove_error), np.fmax(share, groove_share))


def lives(
    scene: Scene, rows: np.ndarray, workers: int = 1, tell: Tell | None = None
) -> SampledLives:
    """Lives at values (n, values), with the groove that `life` would follow.

    Life is proportional to H/K_s, exactly: rows that differ in these alone are solved once.
    """
    names = list(scene.uncertainty or {})
    shape = [k for k, name in enumerate(names) if name not in WORN]
    worn = [k for k, name in enumerate(names) if name in WORN]
    factor = wear_factor(scene, [names[k] for k in worn], rows[:, worn])
    unlike, which = np.unique(rows[:, shape], axis=0, return_inverse=True)
    found = found_lives(scene, [names[k] for k in shape], unlike, workers, tell)
    each = which.ravel()
    of_each = {"life": found.life[each] * factor, "wear_factor": factor}
    of_each |= {name: getattr(found, name)[each] for name in ("status", "end_criterion")}
    return SampledLives(**(vars(found) | of_each))


POOLED = 2**15
"""Lives of a pooled distribution, at least: those solved, each with many values of the wear factor.
"""

_FINE = 2**13  # values of the wear factor that its distribution is known from


def pooled_wear_factors(
    scene: Scene,
    names: Sequence[str],
    others: Sequence[str],
    probabilities: np.ndarray,
    pooled: int = POOLED,
) -> np.ndarray:
    """Factors (n, draws) on lives by uncertain values of K_s and H, at even probabilities.

    names: those values; without any there is one draw, and the factor is 1.
    others, probabilities (n, others): what else was sampled; K_s may go with friction.
    pooled: least number of factors, except that no row has fewer than eight.
    """
    count = len(probabilities)
    if not names:
        return np.ones((count, 1))
    friction, rho = friction_correlation(scene.uncertainty or {})
    given = [name for name in others if rho and name == friction]
    unit = qmc.Sobol(len(names), seed=0).random(_FINE)
    rows = probabilities[:, [others.index(name) for name in given]]
    sorted_factors = []
    for row in rows if given else rows[:1]:
        every = np.column_stack([np.tile(row, (_FINE, 1)), unit])
        values = values_at(scene, [*given, *names], every)[:, len(given) :]
        sorted_factors.append(np.sort(wear_factor(scene, names, values)))
    draws = max(pooled // count, 8)
    # each row between the others: rows alike give the distribution as finely as all their draws
    even = (np.arange(draws) + (np.arange(count)[:, None] + 0.5) / count) / draws
    parts = zip(np.array_split(even, len(sorted_factors)), sorted_factors, strict=True)
    middles = (np.arange(_FINE) + 0.5) / _FINE
    return np.concatenate([np.interp(part, middles, one) for part, one in parts])


def with_preload(scene: Scene, method: str, preload_N: float) -> Scene:
    """The scene with a method and a preload, whose distribution is scaled with it."""
    distributions = dict(scene.uncertainty or {})
    if "preload_N" in distributions:
        share, old = preload_N / scene.operation.preload_N, distributions["preload_N"]
        parts = {
            part: getattr(old, part) * share
            for part in ("mean", "standard_deviation", "median", "low", "high")
            if getattr(old, part) is not None
        }
        distributions["preload_N"] = replace(old, **parts)
    return replace(held_by(scene, method, preload_N), uncertainty=distributions)


def preload_at(scene: Scene, method: str, choice: str, recommendation: xr.Dataset | None) -> float:
    """The scene's own or the recommended preload [N]; NaN if none is recommended."""
    if choice == OWN:
        return scene.operation.preload_N
    flag = PRELOAD_METHODS.index(method)
    recommendation = recommended_for(scene, recommendation)
    if flag not in recommendation["preload_method"]:
        raise CaseFileError(f"the recommendation does not contain {method}")
    return float(recommendation["preload"].sel(preload_method=flag))


def sampled_lives(
    scene: Path,
    method: str,
    preload_choice: str,
    chunk: int,
    sampling: Mapping[str, int],
    recommendation: Path | None = None,
) -> xr.Dataset:
    """Step: one part of the sampled lives.

    method: how the preload is applied.
    preload_choice: `own` or `recommended`.
    chunk: number of the part, from 0.
    sampling: `Sampling` by its fields.
    recommendation: of the design study, for the recommended preload.
    """
    plan = Sampling(**sampling)
    if not 0 <= chunk < plan.chunks:
        raise CaseFileError(f"chunk: got {chunk}, expected 0 to {plan.chunks - 1}")
    found = None if recommendation is None else load(recommendation)
    return sample_part(uncertain_scene(scene), plan, method, preload_choice, chunk, found)


def sample_part(
    scene: Scene,
    plan: Sampling,
    method: str,
    choice: str = OWN,
    chunk: int = 0,
    recommendation: xr.Dataset | None = None,
) -> xr.Dataset:
    """One part of the sampled lives; empty where there is no preload to take."""
    preload = preload_at(scene, method, choice, recommendation)
    base = np.array_split(np.arange(plan.samples), plan.chunks)[chunk]
    attributes: dict[str, Any] = {
        "title": f"Sampled lives: {scene.name}, {method}, {choice} preload",
        "kind": PART_KIND,
        "scene": scene,
        "preload_method": method,
        PRELOAD_CHOICE: choice,
        "samples": np.int64(plan.samples),
        "seed": np.int64(plan.seed),
        "chunk": np.int64(chunk),
        "chunks": np.int64(plan.chunks),
        "preload_N": np.float64(preload),
    }
    if np.isnan(preload):
        return filled({}, {}, [{}], **attributes)
    at_preload = with_preload(scene, method, preload)
    rows = sample(at_preload, plan)[base]
    found = lives(at_preload, rows.reshape(-1, rows.shape[-1]))
    columns = (getattr(found, name) for name in SAMPLED)
    return filled(
        SAMPLED,
        {BASE: base, "row": rows.shape[1]},
        [dict(zip(SAMPLED, values, strict=True)) for values in zip(*columns, strict=True)],
        **attributes,
        **{name: np.array(value)[()] for name, value in found.cost.items()},
    )
