"""Samples of bearings: uncertain values at scrambled Sobol points, and the life of each member.

Theory: docs/theory.md, section 15.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.stats import qmc

from bearingwear.kernels.status import BEYOND_GROOVE, OK
from bearingwear.lives.many import HertzianLives, worn_life
from bearingwear.results.quantiles import ALL_BUT_WEAR, ALL_INPUTS, BATCH_ONLY, SCATTER_ONLY
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.distributions import sampled_values
from bearingwear.scene.scene import WORN, Scene
from bearingwear.scene.uncertain import is_same_for_batch
from bearingwear.studies.answers import PROBLEM, Workers
from bearingwear.studies.sampling import Sampling, scene_with_values, wear_factor

POOLED = 2**15
"""Lives that a quantile is taken from, at least: each life solved, times many wear factors."""


class SampledLives(NamedTuple):
    """Lives of the members of a sample."""

    life: np.ndarray  # (n,) [s]; NaN where it was not solved
    status: np.ndarray  # (n,); REFUSED where no model takes the values
    solves: int  # lives that were solved; members that differ in K_s and H alone share one

    @property
    def solved_share(self) -> float:
        """Share of the lives that could be computed."""
        return float((self.status == OK).mean())


class Sample(NamedTuple):
    """Bearings of which some of the uncertain values vary; the others are at their medians."""

    rows: np.ndarray  # (n, names) values, with the wear coefficient and hardness of the scene
    factors: np.ndarray  # (n, draws) by which the wear coefficient and hardness scale each life


def varied_names(scene: Scene, inputs: int) -> list[str]:
    """Returns the uncertain values that vary in a sample, by the flag of `UNCERTAIN_INPUTS`."""
    spreads = scene.uncertainty or {}
    varies = {
        ALL_INPUTS: lambda name: True,
        ALL_BUT_WEAR: lambda name: name not in WORN,
        SCATTER_ONLY: lambda name: not is_same_for_batch(name, spreads[name]),
        BATCH_ONLY: lambda name: is_same_for_batch(name, spreads[name]),
    }[inputs]
    return [name for name in spreads if varies(name)]


def _columns(names: Sequence[str]) -> tuple[list[int], list[int]]:
    """Returns the columns of wear coefficient and hardness, and those of other uncertain values."""
    wear_columns = [k for k, name in enumerate(names) if name in WORN]
    return wear_columns, [k for k in range(len(names)) if k not in wear_columns]


def sample_of(scene: Scene, inputs: int, plan: Sampling) -> Sample:
    """Returns a sample in which the values of `varied_names` vary.

    Samples of a scene share their points, so that a life which two of them need is solved once.
    """
    names, varied = list(scene.uncertainty or {}), varied_names(scene, inputs)
    wear, others = _columns(names)
    is_varied = np.isin(names, varied)
    points = np.full((plan.samples, len(names)), 0.5)
    points[:, others] = _sobol_points(len(others), plan.samples, plan.seed)
    points[:, ~is_varied] = 0.5
    rows = sampled_values(scene, names, points)
    rows[:, wear] = [scene.nominal(names[k]) for k in wear]
    if inputs == ALL_BUT_WEAR or not wear:
        return Sample(rows, np.ones((plan.samples, 1)))
    draws = max(POOLED // plan.samples, 1) if is_varied[wear].any() else 1
    # consecutive Sobol points are evenly spread: each life meets the whole distribution of factors;
    # in random order, as the places in a block go with its number, and so do the other values
    blocks = _sobol_points(len(wear), plan.samples * draws, plan.seed + 1)
    blocks = np.random.default_rng(plan.seed).permutation(blocks.reshape(plan.samples, draws, -1))
    drawn_points = np.repeat(points, draws, axis=0)
    drawn_points[:, wear] = blocks.reshape(len(drawn_points), -1)
    drawn_points[:, ~is_varied] = 0.5
    wear_values = sampled_values(scene, names, drawn_points)[:, wear]
    factors = wear_factor(scene, [names[k] for k in wear], wear_values)
    return Sample(rows, factors.reshape(plan.samples, draws))


def _sobol_points(dimensions: int, count: int, seed: int) -> np.ndarray:
    """Returns scrambled Sobol points (count, dimensions), which depend on the seed alone."""
    if not dimensions:
        return np.empty((count, 0))
    return qmc.Sobol(dimensions, seed=seed).random(count)


def sampled_lives(scene: Scene, rows: np.ndarray, pool: Workers | None = None) -> SampledLives:
    """Returns quick lives at values (n, names) of the uncertain keys, with the grooves of `life`.

    Life is proportional to H/K_s, exactly: rows that differ in these alone are solved once.
    """
    names = list(scene.uncertainty or {})
    wear, others = _columns(names)
    unique_rows, row_of_member = np.unique(rows[:, others], axis=0, return_inverse=True)
    row_of_member = row_of_member.ravel()
    solve = partial(quick_life_answer, scene, [names[k] for k in others])
    pool = pool or Workers(1, progress=False)
    answers = list(pool.answers_at(solve, unique_rows.tolist()))
    if all(PROBLEM in answer for answer in answers):
        raise NotAvailable(answers[0][PROBLEM])
    life = np.array([answer.get("life", np.nan) for answer in answers])[row_of_member]
    status = np.array([answer["status"] for answer in answers])[row_of_member]
    factor = wear_factor(scene, [names[k] for k in wear], rows[:, wear])
    return SampledLives(life=life * factor, status=status, solves=len(unique_rows))


def quick_life_answer(
    scene: Scene, names: Sequence[str], values: Sequence[float]
) -> dict[str, float]:
    """Returns the status of a quick life at uncertain values, and the life [s] if it was solved.

    The life has the grooves that `life` follows.
    """
    changed = scene_with_values(scene, dict(zip(names, values, strict=True)))
    if changed is None:
        return {"status": BEYOND_GROOVE}
    life = worn_life(changed) or HertzianLives(changed, quick=True)(changed)
    if life.status != OK:
        return {"status": life.status}
    return {"status": OK, "life": float(life.last.time)}
