"""Quantiles, shares and Sobol indices against closed forms, and how often intervals cover them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats
from scipy.stats import qmc
from support import scene_file

from bearingwear.results.quantiles import ALL_BUT_WEAR, ALL_INPUTS
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.studies.sampling import Sampling
from bearingwear.studies.uncertainty.intervals import (
    life_quantile,
    longest_shares,
    sobol_indices,
)
from bearingwear.studies.uncertainty.sample import sample_of
from bearingwear.studies.uncertainty.variables import PROBABILITIES

SEEDS = 40


def covers(found, exact):
    """Whether an interval holds the exact value; an end that the sample has not is open."""
    return not (found.low > exact) and not (found.high < exact)


@pytest.mark.parametrize(("wear", "rows"), [(1.0, 128), (1.0, 32), (0.0, 128), (0.0, 32)])
def test_intervals_of_independent_bearings_cover_as_often_as_stated(wear, rows):
    """Closed form: the deviations of wear and of all else in quadrature; rows drawn at random."""
    draws = 64 if wear else 1
    even = (np.arange(draws) + (np.arange(rows)[:, None] + 0.5) / rows) / draws
    factors = np.exp(wear * stats.norm.ppf(even))
    exact = np.exp(np.hypot(0.3, wear) * stats.norm.ppf(PROBABILITIES))
    covered, widths = [], []
    for seed in range(SEEDS):
        random = np.random.default_rng(seed)
        lives = np.exp(0.3 * random.standard_normal(rows))
        quantiles = [life_quantile(lives, factors, p) for p in PROBABILITIES]
        covered.append([covers(value, life) for value, life in zip(quantiles, exact, strict=True)])
        widths.append([np.log(item.high / item.low) for item in quantiles])
    # so few of 200 intervals that hold with 95 % miss with a probability of 1e-3 at most
    assert np.sum(covered) >= stats.binom.ppf(1e-3, np.size(covered), 0.95)
    # with wear, nothing but the mean of all else is sampled
    normal = 2.0 * 1.96 * 0.3 / np.sqrt(rows)
    normal *= 1.0 if wear else 0.5 / stats.norm.pdf(0.0)
    assert normal < np.mean(widths, axis=0)[2] < 1.6 * normal


def test_interval_of_one_factor_is_that_of_order_statistics():
    """Clopper and Pearson (1934): the binomial interval of the share below, as lives."""
    lives = np.exp(np.random.default_rng(5).standard_normal(200))
    quantile = life_quantile(lives, np.ones((200, 1)), 0.1)
    ends = stats.binomtest(20, 200).proportion_ci(0.95)
    assert_allclose(quantile[1:], np.quantile(lives, ends, method="hazen"), rtol=1e-12)


def with_spread(**spread):
    plain = load_scene(scene_file("gyro_s1")).to_dict()
    return scene_from_dict(plain | {"uncertainty": spread})


@pytest.mark.parametrize("inputs", [ALL_INPUTS, ALL_BUT_WEAR])
def test_intervals_of_sobol_samples_cover_the_quantiles(inputs):
    """Closed form: a life mu^-3 H/K_s, of lognormal mu and K_s, is lognormal."""
    spread = {"ball_race": 1.2, "preload_N": 1.1, "wear_coefficient": 3.0}
    scene = with_spread(
        **{name: {"distribution": "lognormal", "factor": by} for name, by in spread.items()}
    )
    deviation = np.hypot(3.0 * np.log(1.2), 2.0 * np.log(1.1))
    if inputs == ALL_INPUTS:
        deviation = np.hypot(deviation, np.log(3.0))
    exact = np.exp(deviation * stats.norm.ppf(PROBABILITIES))
    covered, errors = [], []
    for seed in range(SEEDS):
        sample = sample_of(scene, inputs, Sampling(samples=128, seed=seed))
        mu, preload = sample.rows[:, 0] / scene.friction.ball_race, sample.rows[:, 1] / 7.0
        quantiles = [life_quantile(mu**-3 * preload**2, sample.factors, p) for p in PROBABILITIES]
        covered.append([covers(value, life) for value, life in zip(quantiles, exact, strict=True)])
        errors.append(
            [np.log(item.value / life) for item, life in zip(quantiles, exact, strict=True)]
        )
    # Sobol points are spread more evenly than random ones
    assert np.mean(covered) > 0.97
    assert np.abs(np.mean(errors, axis=0)).max() < 0.03


@pytest.mark.parametrize("samples", [16, 128])
@pytest.mark.parametrize("share", [0.003, 0.02])
def test_intervals_allow_for_an_end_of_life_that_few_bearings_meet(samples, share):
    """Closed form: a share of the bearings, of low friction, lives a hundredth of the others."""
    spread = {"ball_race": 1.2, "wear_coefficient": 3.0}
    scene = with_spread(
        **{name: {"distribution": "lognormal", "factor": by} for name, by in spread.items()}
    )
    deviate = np.linspace(-12.0, 4.0, 100001)
    failed = share * stats.norm.cdf(deviate + np.log(100.0) / np.log(3.0))
    failed += (1.0 - share) * stats.norm.cdf(deviate)
    exact = 3.0 ** np.interp(PROBABILITIES, failed, deviate)
    covered = []
    for seed in range(SEEDS):
        sample = sample_of(scene, ALL_INPUTS, Sampling(samples=samples, seed=seed))
        low = np.log(sample.rows[:, 0] / scene.friction.ball_race) / np.log(1.2)
        lives = np.where(low < stats.norm.ppf(share), 0.01, 1.0 - 1e-6 * low)
        quantiles = [life_quantile(lives, sample.factors, p) for p in PROBABILITIES]
        covered.append([covers(value, life) for value, life in zip(quantiles, exact, strict=True)])
    assert np.mean(covered, axis=0).min() >= 0.95


def test_quantiles_leave_out_lives_that_were_not_solved():
    lives, factors = np.exp(np.random.default_rng(1).standard_normal(64)), np.ones((64, 3))
    left = np.delete(np.arange(64), np.s_[3:9])
    some = lives.copy()
    some[3:9] = np.nan
    assert life_quantile(some, factors, 0.5) == life_quantile(lives[left], factors[left], 0.5)
    assert np.isnan(life_quantile(np.nan * lives, factors, 0.5)).all()
    # nothing varies; one life says nothing of others; an end beyond the sample
    assert life_quantile(np.full(4, 3.0), factors[:4], 0.5) == (3.0, 3.0, 3.0)
    assert np.isnan(life_quantile(lives[:1], factors[:1], 0.5)[1:]).all()
    few = life_quantile(lives[:16], factors[:16, :1], 0.05)
    assert np.isnan(few.low) and few.high > few.value


def test_shares_in_which_a_method_has_the_longest_life():
    """By counting pairs one after the other; unsolved lives are left out."""
    rng, n = np.random.default_rng(3), 400
    first, second = rng.lognormal(0.3, 1.0, n), rng.lognormal(0.0, 1.0, n)
    first[:4], second[4:8], second[8:20] = 0.0, np.nan, first[8:20]
    life = np.stack([first, second])
    pairs = [(a, b) for a, b in zip(first, second, strict=True) if b == b]
    wins = sum(a > b for a, b in pairs)
    shares = longest_shares(life)
    assert_allclose(shares[0, 0], wins / len(pairs), rtol=1e-15)
    assert_allclose(shares[1, 0], sum(b > a for a, b in pairs) / len(pairs), rtol=1e-15)
    low, high = shares[0, 1:]  # at these ends 2.5 % of samples have so many wins, or so few
    assert_allclose(stats.binom.sf(wins - 1, len(pairs), low), 0.025, rtol=1e-9)
    assert_allclose(stats.binom.cdf(wins, len(pairs), high), 0.025, rtol=1e-9)
    assert np.isnan(longest_shares(np.nan * life)).all()


def saltelli(n, k, seed=1):
    """Normal deviates (k + 2, n, k): A, B, and A with each column of B."""
    a, b = np.hsplit(stats.norm.ppf(qmc.Sobol(2 * k, seed=seed).random(n)), 2)
    return np.stack([a, b, *(np.where(np.arange(k) == j, b, a) for j in range(k))])


def test_indices_of_a_sum_with_an_interaction():
    """Closed form: log life x + 2 y + x z; Var 1 + 4 + 1."""
    x, y, z = np.moveaxis(saltelli(2048, 3), -1, 0)
    lives = np.exp(np.stack([x + 2.0 * y + x * z, 2.0 * x], axis=1))
    indices = sobol_indices(lives, seed=1)
    first, total = np.array([1.0, 4.0, 0.0]) / 6.0, np.array([2.0, 4.0, 1.0]) / 6.0
    for name, exact in (("first_index", first), ("total_index", total)):
        assert_allclose(indices[name][0], exact, atol=0.03)
        assert (np.abs(indices[name][0] - exact) < 2.0 * indices[f"{name}_error"][0]).all()
        assert_allclose(indices[name][1], [1.0, 0.0, 0.0], atol=0.03)
    # those of base samples with a life of zero or without a life are left out
    lives[0, 0, 5], lives[3, 1, 8] = 0.0, np.nan
    some = sobol_indices(lives, seed=1)
    assert_allclose(some["total_index"], indices["total_index"], atol=0.05)
    assert np.isnan(sobol_indices(0.0 * lives, seed=1)["total_index"]).all()


def test_index_of_a_single_value():
    lives = np.exp(saltelli(64, 1)[..., 0])[:, None, :].repeat(2, axis=1)
    indices = sobol_indices(lives, seed=1)
    assert indices["total_index"].shape == (2, 1)
    assert_allclose(indices["total_index"], 1.0, atol=0.1)
