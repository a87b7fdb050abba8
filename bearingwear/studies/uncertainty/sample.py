"""Lives at sampled values of the uncertain keys of a scene.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from SALib.sample import sobol as sobol_sample

from bearingwear.kernels.status import BEYOND_GROOVE, OK
from bearingwear.lives.many import HertzianLives
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.quantiles import PRELOAD_CHOICE
from bearingwear.results.variable import HOURS_PER_SECOND, STATUS, Variable, table
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.distributions import values_at
from bearingwear.scene.scene import PRELOAD_METHODS, WORN, Scene
from bearingwear.studies.dataset import LOSS_BASIS, filled
from bearingwear.studies.design.recommend import recommended_for
from bearingwear.studies.pool import Tell, told_in_lines
from bearingwear.studies.sampling import Sampling, perturbed
from bearingwear.studies.uncertainty.grooves import FollowedLives, with_followed_grooves
from bearingwear.studies.uncertainty.plan import OWN, uncertain_scene

PART_KIND = "sampled lives"
BASE = Variable("base", ("base",), "1", "index of the base sample", dtype="i8")

SAMPLED = table(
    replace(STATUS, comment=None),
    Variable("end_criterion", (), "", "criterion that ends the life", dtype="i1", flags=CRITERIA),
    Variable("wear_factor", (), "1", "life over the one with the scene's own K_s and hardness"),
    Variable("life", LOSS_BASIS.dims, "h", "wear life", scale=HOURS_PER_SECOND),
)
"""What is found at sampled values."""


def problem(scene: Scene) -> dict[str, Any]:
    """The uncertain values as SALib takes them, by their probabilities."""
    names = list(scene.uncertainty or {})
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}


def sample(scene: Scene, plan: Sampling) -> np.ndarray:
    """Values (samples, values + 2, values): of each base sample A, A with one value of B each, B.

    A scrambled Sobol sequence in Saltelli's arrangement; the same for the same seed.
    """
    of = problem(scene)
    unit = sobol_sample.sample(of, plan.samples, calc_second_order=False, seed=plan.seed)
    return values_at(scene, of["names"], unit).reshape(plan.samples, -1, of["num_vars"])


@dataclass(frozen=True, kw_only=True)
class SampledLives:
    """Lives at sampled values.

    Attributes
    ----------
    life : (n, 2) ndarray
        By both ways of counting wear [s]; NaN where it was not solved.
    status, end_criterion : (n,) ndarray
    wear_factor : (n,) ndarray
        Factor on the life by its K_s and H in place of the scene's.
    followed : int
        Lives whose grooves were followed as they wear.
    groove_error : float
        As `FollowedLives.error`.
    """

    life: np.ndarray
    status: np.ndarray
    end_criterion: np.ndarray
    wear_factor: np.ndarray
    followed: int
    groove_error: float


def lives(
    scene: Scene, rows: np.ndarray, workers: int = 1, tell: Tell | None = None
) -> SampledLives:
    """Lives at values (n, values), with the groove that `life` would follow.

    Life is proportional to H/K_s, exactly: rows that differ in these alone are solved once.
    `workers` are the processes that follow grooves.
    """
    names = list(scene.uncertainty or {})
    shape = [k for k, name in enumerate(names) if name not in WORN]
    worn = [k for k, name in enumerate(names) if name in WORN]
    factor = wear_factor(scene, [names[k] for k in worn], rows[:, worn])
    unlike, which = np.unique(rows[:, shape], axis=0, return_inverse=True)
    scenes = [
        perturbed(scene, {names[k]: float(v) for k, v in zip(shape, row, strict=True)})
        for row in unlike
    ]
    solved: Iterator[Any] = map(_life, scenes)
    if tell:
        solved = told_in_lines(solved, len(scenes), "{} of {} lives, Hertzian", tell=tell)
    parts = zip(*solved, strict=True)
    life, status, criterion = (np.array(part) for part in parts)
    hertzian = FollowedLives(life=life, status=status, end_criterion=criterion)
    found = with_followed_grooves(scenes, unlike, hertzian, workers, tell)
    each = which.ravel()
    return SampledLives(
        life=found.life[each] * factor[:, None],
        status=found.status[each],
        end_criterion=found.end_criterion[each],
        wear_factor=factor,
        followed=found.followed,
        groove_error=found.error,
    )


def wear_factor(scene: Scene, names: Sequence[str], values: np.ndarray) -> np.ndarray:
    """Factor (n,) on lives by values (n, names) of K_s and H in place of the scene's."""
    factor = np.ones(len(values))
    for k, name in enumerate(names):
        ratio = values[:, k] / scene.nominal(name)
        factor = factor * (ratio if name == "brinell_hardness_GPa" else 1.0 / ratio)
    return factor


def _life(other: Scene | None) -> tuple[np.ndarray, int, int]:
    """Life (2,) with Hertzian grooves [s], status and end criterion."""
    if other is None:
        return np.full(2, np.nan), BEYOND_GROOVE, len(CRITERIA) - 1
    life = HertzianLives(other)(other)
    times = life.last.time if life.status == OK else np.full(2, np.nan)
    return times, life.status, life.criterion


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
        raise CaseFileError(f"the recommendation has no {method}")
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

    Parameters
    ----------
    scene : path
    method : str
        How the preload is applied.
    preload_choice : str
        `own` or `recommended`.
    chunk : int
        Number of the part, from 0.
    sampling : mapping
        `Sampling` by its fields.
    recommendation : path, optional
        Of the design study, for the recommended preload.
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
        "title": f"Sampled lives of {scene.name}: {method}, {choice} preload",
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
        {BASE: base, "row": rows.shape[1], LOSS_BASIS: None},
        [dict(zip(SAMPLED, values, strict=True)) for values in zip(*columns, strict=True)],
        **attributes,
        followed_lives=np.int64(found.followed),
        groove_error=np.float64(found.groove_error),
    )
