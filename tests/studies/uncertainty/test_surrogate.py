"""Interpolation between solved places, and the error it states."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats

from bearingwear.studies.uncertainty.surrogate import (
    Spline,
    interpolated,
    monomials,
    relative_error,
    stated,
)


def smooth(x):
    return np.stack([np.sin(x[:, 0]) + 0.3 * x[:, 1] ** 2, x.sum(axis=1)], axis=-1)


def of_function(places, log, kind, solved=None):
    """A `solve` that notes what is asked of it."""

    def solve(which):
        if solved is not None:
            solved.extend(which.tolist())
        return log[which], kind[which]

    return solve


@pytest.mark.parametrize(("power", "degree"), [(3, 2), (3, 1), (1, 1), (1, 0)])
def test_left_out_values_are_those_of_fits_without_them(power, degree):
    x = np.random.default_rng(3).normal(size=(20, 2))
    whole = Spline(x, smooth(x), power, degree)
    for k in (0, 7, 19):
        others = np.delete(np.arange(20), k)
        without = Spline(x[others], smooth(x[others]), power, degree)
        assert_allclose(
            whole.left_out[k], (without(x[[k]]) - smooth(x[[k]]))[0], rtol=1e-5, atol=1e-11
        )


def test_trend_is_exact():
    x = np.random.default_rng(3).normal(size=(30, 3))
    assert monomials(x, 2).shape == (30, 10)
    values = monomials(x, 2) @ np.random.default_rng(5).normal(size=(10, 1))
    there = np.random.default_rng(4).normal(size=(5, 3))
    found = Spline(x, values, 3, 2)
    exact = np.linalg.lstsq(monomials(x, 2), values, rcond=None)[0]
    assert_allclose(found(there), monomials(there, 2) @ exact, rtol=1e-6)


def test_error_of_a_smooth_function_is_the_one_stated():
    places = np.random.default_rng(3).uniform(-2.0, 2.0, size=(3000, 2))
    log, kind = smooth(places), np.zeros((3000, 1), dtype=int)
    found = interpolated(places, of_function(places, log, kind), 16, 512, 1e-3)
    assert 16 < found.solved < 600
    true = relative_error(found.log, log)
    assert 0.0 < np.sqrt(np.mean(true**2)) < 1e-3
    assert 0.0 < np.mean(true > found.stated.error) < found.stated.share < 0.05


def test_kinks_jumps_and_zeros_are_resolved():
    """Of one coordinate, as a life: 0 at first, a steep branch, a jump."""
    places = np.sort(np.random.default_rng(3).normal(size=(2000, 1)), axis=0)
    x = places[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        log = np.select([x < -2.0, x < -1.8], [-np.inf, np.log(x + 2.0)], np.sin(x))
    log[x > 1.0] += 1.0
    log[x > 2.5] = np.nan
    kind = np.digitize(x, [-1.8, 1.0, 2.5])[:, None]
    asked = []
    found = interpolated(places, of_function(places, log[:, None], kind, asked), 16, 256, 1e-3)
    assert found.solved == len(asked) == len(set(asked)) <= 256
    right = (found.kind == kind).all(axis=1) & (np.isfinite(found.log[:, 0]) == np.isfinite(log))
    assert right.mean() > 0.99 and found.stated.error <= 2e-3
    known = right & np.isfinite(log) & (x > -1.8)  # at -2 a logarithm is steep without end
    assert_allclose(found.log[known, 0], log[known], atol=3e-3)  # beyond the ends of branches


def test_along_a_line_all_errors_are_below_the_one_stated():
    places = np.random.default_rng(3).normal(size=(4000, 1))
    log, kind = np.sin(2.0 * places), np.zeros((4000, 1), dtype=int)
    found = interpolated(places, of_function(places, log, kind), 16, 512, 1e-3)
    assert found.solved < 3.0 * np.sqrt(4000)  # as many as are random where several values vary
    assert 0.0 < relative_error(found.log, log).max() < found.stated.error <= 1e-3


def test_a_jump_between_solved_places_of_a_line_is_within_the_share():
    places = np.sort(np.random.default_rng(3).normal(size=(1000, 1)), axis=0)
    log, kind, asked = np.sin(places), np.zeros((1000, 1), dtype=int), []
    interpolated(places, of_function(places, log, kind, asked), 16, 512, 1e-3)
    known = np.sort(asked)
    k = np.argmax(np.diff(known))
    log[known[k] + 1 : known[k + 1]] += 1.0
    again = []
    found = interpolated(places, of_function(places, log, kind, again), 16, 512, 1e-3)
    assert again == asked
    wrong = np.mean(relative_error(found.log, log) > 1e-3)
    assert 0.01 < wrong <= found.stated.share < 0.05


def test_few_places_are_all_solved():
    places = np.arange(5.0)[:, None]
    log, kind = smooth(np.hstack([places, places])), np.zeros((5, 1), dtype=int)
    found = interpolated(places, of_function(places, log, kind), 16, 32, 1e-9)
    assert found.solved == 5 and found.stated == (0.0, 0.0)
    assert_allclose(found.log, log, rtol=0.0)


@pytest.mark.parametrize("coordinates", [1, 3])
def test_a_function_without_smoothness_states_a_large_error(coordinates):
    places = np.random.default_rng(3).normal(size=(400, coordinates))
    log, kind = np.random.default_rng(4).normal(size=(400, 1)), np.zeros((400, 1), dtype=int)
    found = interpolated(places, of_function(places, log, kind), 16, 64, 1e-3)
    assert found.solved == 64 and sum(found.stated) > 0.8


def test_the_earliest_of_two_ends_counts_where_nearest_places_are_of_another():
    places = np.random.default_rng(3).uniform(-1.0, 1.0, size=(2000, 5))
    ends = np.stack([places[:, 0], 2.0 * places[:, 1] + 0.3], axis=-1)
    log, kind = ends.min(axis=1)[:, None], ends.argmin(axis=1)[:, None]
    found = interpolated(places, of_function(places, log, kind), 32, 256, 1e-6)
    assert found.solved < 256
    assert_allclose(found.log, log, atol=1e-5)
    assert (found.kind == kind).all()


def test_stated_share_is_that_of_clopper_and_pearson():
    assert stated(np.zeros(58)) == (0.0, pytest.approx(1.0 - 0.05 ** (1 / 58)))
    few = np.where(np.arange(300) < 2, 1.0, 1e-3)
    share = stats.binomtest(2, 300).proportion_ci(0.9).high  # 95 % on one side
    assert stated(few) == (1e-3, pytest.approx(share))
