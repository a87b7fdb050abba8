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
"""Samples of a test of coverage; it has an interval for each of the five PROBABILITIES."""


def covers(quantile, exact):
    """Returns whether an interval contains the exact value; an end of NaN counts as infinite."""
    # a comparison with NaN is false
    return not (quantile.low > exact) and not (quantile.high < exact)


def quantiles_of(lives, factors):
    """Returns the quantiles of lives at PROBABILITIES, with their intervals of 95 %."""
    return [life_quantile(lives, factors, p) for p in PROBABILITIES]


def covered(quantiles, exact):
    """Returns for each quantile whether its interval contains the exact life."""
    return [covers(quantile, life) for quantile, life in zip(quantiles, exact, strict=True)]


@pytest.mark.parametrize(("wear", "rows"), [(1.0, 128), (1.0, 32), (0.0, 128), (0.0, 32)])
def test_intervals_of_independent_bearings_cover_as_often_as_stated(wear, rows):
    """Lives are lognormal: their log has the standard deviation 0.3 without wear.

    With wear factors, its variance is the sum of both variances. Without, each life stands once.

    wear: standard deviation of the log of the wear factor. rows: number of lives, drawn at random.
    """
    draws = 64 if wear else 1
    # probabilities (rows, draws) of wear factors: evenly spread in each row and over all rows
    even = (np.arange(draws) + (np.arange(rows)[:, None] + 0.5) / rows) / draws
    factors = np.exp(wear * stats.norm.ppf(even))
    exact = np.exp(np.hypot(0.3, wear) * stats.norm.ppf(PROBABILITIES))
    cover, widths_of_median = [], []
    for seed in range(SEEDS):
        random = np.random.default_rng(seed)
        quantiles = quantiles_of(np.exp(0.3 * random.standard_normal(rows)), factors)
        cover.append(covered(quantiles, exact))
        median = quantiles[len(PROBABILITIES) // 2]
        widths_of_median.append(np.log(median.high / median.low))
    # of 200 independent intervals of 95 %, 179 or more cover in all but 1 of 1000 samples
    assert np.sum(cover) >= stats.binom.ppf(1e-3, np.size(cover), 0.95)
    # width in log life of the interval of the mean of normal values; of their median, divided by
    # twice their density there. Binomial intervals of few rows are up to 1.5 times as wide.
    width = 2.0 * 1.96 * 0.3 / np.sqrt(rows)
    if not wear:
        width *= 0.5 / stats.norm.pdf(0.0)
    assert width < np.mean(widths_of_median) < 1.6 * width


def test_interval_of_one_factor_is_that_of_order_statistics():
    """Clopper and Pearson (1934): the binomial interval of the share below, as lives."""
    lives = np.exp(np.random.default_rng(5).standard_normal(200))
    quantile = life_quantile(lives, np.ones((200, 1)), 0.1)  # 20 of the 200 lie below
    ends = stats.binomtest(20, 200).proportion_ci(0.95)
    assert_allclose(quantile[1:], np.quantile(lives, ends, method="hazen"), rtol=1e-12)


def with_lognormal(**factors):
    """Returns gyro_s1 with lognormal inputs, by their names and factors exp(standard deviation)."""
    spread = {name: {"distribution": "lognormal", "factor": by} for name, by in factors.items()}
    plain = load_scene(scene_file("gyro_s1")).to_dict()
    return scene_from_dict(plain | {"uncertainty": spread})


@pytest.mark.parametrize("inputs", [ALL_INPUTS, ALL_BUT_WEAR])
def test_intervals_of_sobol_samples_cover_the_quantiles(inputs):
    """Closed form: a life mu^-3 F^2 H/K_s, of lognormal mu, F and K_s, is lognormal.

    Sobol points are spread more evenly than random ones: none of the 200 intervals misses, though
    10 of random samples would. The mean of 40 errors has a scatter of 0.7 % at most.
    """
    scene = with_lognormal(ball_race=1.2, preload_N=1.1, wear_coefficient=3.0)
    deviation = np.hypot(3.0 * np.log(1.2), 2.0 * np.log(1.1))
    if inputs == ALL_INPUTS:
        deviation = np.hypot(deviation, np.log(3.0))
    exact = np.exp(deviation * stats.norm.ppf(PROBABILITIES))
    cover, errors = [], []
    for seed in range(SEEDS):
        sample = sample_of(scene, inputs, Sampling(samples=128, seed=seed))
        # columns in the order of with_lognormal, over their medians; wear stands in the factors
        mu = sample.rows[:, 0] / scene.friction.ball_race
        preload = sample.rows[:, 1] / scene.operation.preload_N
        quantiles = quantiles_of(mu**-3 * preload**2, sample.factors)
        cover.append(covered(quantiles, exact))
        errors.append(np.log([quantile.value for quantile in quantiles] / exact))
    assert np.mean(cover) > 0.97  # random samples: 0.95, with a scatter of 0.015
    assert np.abs(np.mean(errors, axis=0)).max() < 0.03  # of log life


@pytest.mark.parametrize("samples", [16, 128])
@pytest.mark.parametrize("share", [0.003, 0.02])
def test_intervals_allow_for_an_end_of_life_that_few_bearings_meet(samples, share):
    """The bearings with the lowest friction, a share of all, live a hundredth of the others' life.

    Closed form: the distribution of lives is the sum of two lognormal ones, inverted by a table.
    """
    scene = with_lognormal(ball_race=1.2, wear_coefficient=3.0)
    deviate = np.linspace(-12.0, 4.0, 100001)  # log life, over log 3 of the wear coefficient
    failed = share * stats.norm.cdf(deviate + np.log(100.0) / np.log(3.0))
    failed += (1.0 - share) * stats.norm.cdf(deviate)
    exact = 3.0 ** np.interp(PROBABILITIES, failed, deviate)
    cover = []
    for seed in range(SEEDS):
        sample = sample_of(scene, ALL_INPUTS, Sampling(samples=samples, seed=seed))
        friction_deviate = np.log(sample.rows[:, 0] / scene.friction.ball_race) / np.log(1.2)
        has_low_friction = friction_deviate < stats.norm.ppf(share)
        # lives of the others differ by a millionth, as equal lives have an interval of no width
        lives = np.where(has_low_friction, 0.01, 1.0 - 1e-6 * friction_deviate)
        cover.append(covered(quantiles_of(lives, sample.factors), exact))
    # the widened intervals of each quantile cover in all 40 samples; two may miss
    assert np.mean(cover, axis=0).min() >= 0.95


LIVES, FACTORS = np.exp(np.random.default_rng(1).standard_normal(64)), np.ones((64, 3))
"""Lognormal lives, and wear factors (lives, draws) that leave them as they are."""


def test_quantiles_leave_out_lives_that_were_not_solved():
    """Six NaN of 64 lives change no quantile of the others; without any life, quantiles are NaN."""
    is_solved = np.ones(64, dtype=bool)
    is_solved[3:9] = False
    with_unsolved = np.where(is_solved, LIVES, np.nan)
    of_solved = life_quantile(LIVES[is_solved], FACTORS[is_solved], 0.5)
    assert life_quantile(with_unsolved, FACTORS, 0.5) == of_solved
    assert np.isnan(life_quantile(np.nan * LIVES, FACTORS, 0.5)).all()


def test_equal_lives_have_an_interval_of_no_width():
    assert life_quantile(np.full(4, 3.0), FACTORS[:4], 0.5) == (3.0, 3.0, 3.0)


def test_one_life_has_no_interval():
    """Both of its ends are NaN."""
    assert np.isnan(life_quantile(LIVES[:1], FACTORS[:1], 0.5)[1:]).all()


def test_an_end_of_an_interval_beyond_the_sample_is_not_known():
    """The shortest of 16 lives exceeds the 5 % quantile in 44 % of samples (0.95^16)."""
    quantile = life_quantile(LIVES[:16], FACTORS[:16, :1], 0.05)
    assert np.isnan(quantile.low) and quantile.high > quantile.value


def test_shares_in_which_a_method_has_the_longest_life():
    """Shares are counted over pairs of lives, without pairs of which one life is not solved.

    Equal lives count as longest for neither method.
    """
    rng, n = np.random.default_rng(3), 400
    first, second = rng.lognormal(0.3, 1.0, n), rng.lognormal(0.0, 1.0, n)
    first[:4], second[4:8], second[8:20] = 0.0, np.nan, first[8:20]  # lost, unsolved, and equal
    life = np.stack([first, second])
    pairs = [(a, b) for a, b in zip(first, second, strict=True) if not np.isnan(b)]
    wins = sum(a > b for a, b in pairs)
    shares = longest_shares(life)
    assert_allclose(shares[0, 0], wins / len(pairs), rtol=1e-15)
    assert_allclose(shares[1, 0], sum(b > a for a, b in pairs) / len(pairs), rtol=1e-15)
    low, high = shares[0, 1:]
    # Clopper and Pearson: 2.5 % of samples have so many wins or more with the low share, and 2.5 %
    # so many or fewer with the high one
    assert_allclose(stats.binom.sf(wins - 1, len(pairs), low), 0.025, rtol=1e-9)
    assert_allclose(stats.binom.cdf(wins, len(pairs), high), 0.025, rtol=1e-9)
    assert np.isnan(longest_shares(np.nan * life)).all()


def saltelli_deviates(n, k, seed=1):
    """Returns Saltelli's normal deviates (k + 2, n, k): A, B, and A with each column of B in turn.

    n: base samples. k: uncertain values.
    """
    a, b = np.hsplit(stats.norm.ppf(qmc.Sobol(2 * k, seed=seed).random(n)), 2)
    return np.stack([a, b, *(np.where(np.arange(k) == j, b, a) for j in range(k))])


@pytest.fixture(scope="module")
def interacting_lives():
    """Returns lives (5, 2, 2048) whose logarithms are x + 2 y + x z and 2 x, by 2048 base samples.

    x, y and z are independent and standard normal.
    """
    x, y, z = np.moveaxis(saltelli_deviates(2048, 3), -1, 0)
    return np.exp(np.stack([x + 2.0 * y + x * z, 2.0 * x], axis=1))


@pytest.mark.parametrize(
    ("name", "of_sum"), [("first_index", [1.0, 4.0, 0.0]), ("total_index", [2.0, 4.0, 1.0])]
)
def test_indices_of_a_sum_with_an_interaction(interacting_lives, name, of_sum):
    """Closed form: x, 2 y and x z have the variances 1, 4 and 1; x z counts in both totals.

    Within 0.03, and within twice the half-width of their stated 95 % intervals.
    """
    indices, exact = sobol_indices(interacting_lives, seed=1), np.array(of_sum) / 6.0
    assert_allclose(indices[name][0], exact, atol=0.03)
    assert (np.abs(indices[name][0] - exact) < 2.0 * indices[f"{name}_error"][0]).all()
    assert_allclose(indices[name][1], [1.0, 0.0, 0.0], atol=0.03)  # of 2 x alone


def test_indices_leave_out_base_samples_with_a_life_of_zero_or_without_one(interacting_lives):
    """SciPy takes a power of two: of 2046 usable samples 1024, hence 0.05 in place of 0.03."""
    lives = interacting_lives.copy()
    lives[0, 0, 5], lives[3, 1, 8] = 0.0, np.nan
    whole = sobol_indices(interacting_lives, seed=1)
    assert_allclose(sobol_indices(lives, seed=1)["total_index"], whole["total_index"], atol=0.05)
    assert np.isnan(sobol_indices(0.0 * lives, seed=1)["total_index"]).all()


def test_the_index_of_a_single_value_is_one():
    """64 base samples give it to 0.1, for each of two methods with equal lives."""
    lives = np.exp(saltelli_deviates(64, 1)[..., 0])[:, None, :].repeat(2, axis=1)
    indices = sobol_indices(lives, seed=1)
    assert indices["total_index"].shape == (2, 1)
    assert_allclose(indices["total_index"], 1.0, atol=0.1)
