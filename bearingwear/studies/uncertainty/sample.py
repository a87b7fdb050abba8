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
from bearingwear.results.quantiles import ALL_BUT_WEAR, ALL_INPUTS, BATCH_ONLY
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.distributions import sampled_values
from bearingwear.scene.scene import WORN, Scene
from bearingwear.scene.uncertain import is_same_for_batch
from bearingwear.studies.answers import PROBLEM, Workers
from bearingwear.studies.sampling import Sampling, scene_with_values, wear_factor

POOLED = 2**15
"""Least number of lives from which a quantile is taken if wear varies: each solved life is scaled
by several wear factors."""


class SampledLives(NamedTuple):
    """Lives of the members of a sample."""

    life: np.ndarray  # NaN where it was not solved (n,) [s]
    status: np.ndarray  # REFUSED where no model takes the values (n,)
    solves: int  # number of lives tried; members that differ in K_s and H alone share one

    @property
    def solved_share(self) -> float:
        """Returns the share of the lives that could be computed."""
        return float((self.status == OK).mean())


class Sample(NamedTuple):
    """Bearings of which some of the uncertain values vary; the others are at their medians.

    With `ALL_BUT_WEAR`, wear is as the scene states it.
    """

    rows: np.ndarray  # values, with the wear coefficient and hardness of the scene (n, names)
    factors: np.ndarray  # by which wear coefficient and hardness scale each life (n, draws)


def varied_names(scene: Scene, inputs: int) -> list[str]:
    """Returns the names of the uncertain values that vary in a sample.

    inputs: flag of `UNCERTAIN_INPUTS`, for all values or for a class of them.
    """
    spreads = scene.uncertainty or {}
    if inputs == ALL_INPUTS:
        return list(spreads)
    if inputs == ALL_BUT_WEAR:
        return [name for name in spreads if name not in WORN]
    common_to_batch = [name for name, spread in spreads.items() if is_same_for_batch(name, spread)]
    if inputs == BATCH_ONLY:
        return common_to_batch
    return [name for name in spreads if name not in common_to_batch]


def _wear_columns(names: Sequence[str]) -> list[int]:
    """Returns the positions of wear coefficients and hardness among uncertain values."""
    return [k for k, name in enumerate(names) if name in WORN]


def _other_columns(names: Sequence[str]) -> list[int]:
    """Returns the positions of uncertain values other than of wear."""
    return [k for k, name in enumerate(names) if name not in WORN]


def sample_of(scene: Scene, inputs: int, plan: Sampling) -> Sample:
    """Returns a sample of bearings in which some uncertain values vary.

    Samples of a scene share their points, so that a life which two of them need is solved once.
    Wear coefficient and hardness vary by the factors, not in the rows.

    inputs: flag of `UNCERTAIN_INPUTS`, see `varied_names`.
    plan: size and seed.
    """
    names = list(scene.uncertainty or {})
    is_varied = np.isin(names, varied_names(scene, inputs))
    wear, others = _wear_columns(names), _other_columns(names)
    points = np.full((plan.samples, len(names)), 0.5)
    points[:, others] = _sobol_points(len(others), plan.samples, plan.seed)
    points[:, ~is_varied] = 0.5
    rows = sampled_values(scene, names, points)
    rows[:, wear] = [scene.nominal(names[k]) for k in wear]
    if inputs == ALL_BUT_WEAR or not wear:
        return Sample(rows, np.ones((plan.samples, 1)))
    return Sample(rows, _wear_factors(scene, points, is_varied, plan))


def _wear_factors(
    scene: Scene, points: np.ndarray, is_varied: np.ndarray, plan: Sampling
) -> np.ndarray:
    """Returns factors (n, draws) by which wear coefficient and hardness scale each life.

    If these vary, there are enough factors for `POOLED` lives; else each life has one.

    points: in the unit cube, one for each life (n, names). Each factor has the friction of its
        life, with which the wear coefficient may correlate.
    is_varied: by name (names,).
    """
    names = list(scene.uncertainty or {})
    wear = _wear_columns(names)
    draws = max(POOLED // plan.samples, 1) if is_varied[wear].any() else 1
    # Each life gets a block of consecutive Sobol points, which spread evenly over the factors. In
    # their own order, blocks would correlate with `points`: both are scrambled from one sequence.
    blocks = _sobol_points(len(wear), plan.samples * draws, plan.seed + 1)
    blocks = np.random.default_rng(plan.seed).permutation(blocks.reshape(plan.samples, draws, -1))
    drawn_points = np.repeat(points, draws, axis=0)
    drawn_points[:, wear] = blocks.reshape(len(drawn_points), -1)
    drawn_points[:, ~is_varied] = 0.5
    wear_values = sampled_values(scene, names, drawn_points)[:, wear]
    factors = wear_factor(scene, [names[k] for k in wear], wear_values)
    return factors.reshape(plan.samples, draws)


def _sobol_points(dimensions: int, count: int, seed: int) -> np.ndarray:
    """Returns scrambled Sobol points (count, dimensions), which depend on the seed alone."""
    if not dimensions:
        return np.empty((count, 0))
    return qmc.Sobol(dimensions, seed=seed).random(count)


def sampled_lives(scene: Scene, rows: np.ndarray, pool: Workers | None = None) -> SampledLives:
    """Returns quick lives at sampled values, with the grooves that the full model would follow.

    Life is proportional to H/K_s, exactly: rows that differ in these alone are solved once.

    rows: values of the keys of `uncertainty`, in its order (n, names).
    pool: processes that solve the lives; without one, this process does.
    NotAvailable: no model takes the values of any row.
    """
    names = list(scene.uncertainty or {})
    wear = _wear_columns(names)
    others = _other_columns(names)
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
    """Returns the `status` of a quick life at uncertain values, and the `life` [s] if it is OK.

    The life has the grooves that the full model would follow. Where balls become too large for the
    play between the grooves, the status is BEYOND_GROOVE.

    names, values: keys of `uncertainty`, and values that replace those of the scene.
    """
    changed = scene_with_values(scene, dict(zip(names, values, strict=True)))
    if changed is None:
        return {"status": BEYOND_GROOVE}
    life = worn_life(changed) or HertzianLives(changed, quick=True)(changed)
    if life.status != OK:
        return {"status": life.status}
    return {"status": OK, "life": float(life.last.time)}
