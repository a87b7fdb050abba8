"""Two kinds of uncertainty, and grooves that are followed in sampled lives."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats
from scipy.stats import qmc
from support import scene_file

from bearingwear.cli import main
from bearingwear.kernels.status import BEYOND_GROOVE
from bearingwear.lives.life import life
from bearingwear.results.netcdf import load
from bearingwear.results.quantiles import spread_at
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.scene.uncertain import UNCERTAIN, Distribution, is_same_for_batch
from bearingwear.studies.dataset import write_dataset
from bearingwear.studies.sampling import Sampling, perturbed
from bearingwear.studies.uncertainty import grooves
from bearingwear.studies.uncertainty.batches import (
    BATCH_PROBABILITIES,
    PROBABILITIES,
    Batches,
    names_of,
    of_class,
    quantiles_with_error,
    sizes,
)
from bearingwear.studies.uncertainty.grooves import found_lives
from bearingwear.studies.uncertainty.quantiles import class_indices, longest_shares, own_quantiles
from bearingwear.studies.uncertainty.sample import lives, sample
from bearingwear.studies.uncertainty.surrogate import EXACT, Stated

PLAN = Sampling(samples=64, chunks=1, seed=1)
FOLLOWED = ["model.contact=auto", "model.normal_balance=frictionless"]


def with_spread(settings=(), **spread):
    plain = load_scene(scene_file("gyro_s1"), list(settings)).to_dict()
    return scene_from_dict(plain | {"uncertainty": spread})


def test_which_values_are_those_of_a_batch():
    given = Distribution(distribution="uniform", low=1.0, high=2.0)
    of_batch = {name for name in UNCERTAIN if is_same_for_batch(name, given)}
    scatters = {"ball_diameter_mm", "contact_angle_deg", "inner_groove_factor", "preload_N"}
    scatters |= {"outer_groove_factor", "thickness_um", "wear_scatter"}
    assert of_batch == UNCERTAIN.keys() - scatters
    told = Distribution(distribution="uniform", low=1.0, high=2.0, same_for_batch=False)
    assert not is_same_for_batch("wear_coefficient", told)
    scene = with_spread(
        ball_race={"distribution": "uniform", "low": 0.06, "high": 0.1, "same_for_batch": False},
        preload_N={"distribution": "normal", "standard_deviation": 0.3, "same_for_batch": True},
        contact_angle_deg={"distribution": "normal", "standard_deviation": 0.5},
    )
    assert names_of(scene, True) == ["preload_N"]
    assert names_of(scene, False) == ["ball_race", "contact_angle_deg"]
    assert list(of_class(scene, True).uncertainty) == ["preload_N"]
    with pytest.raises(SceneError, match="same_for_batch"):
        with_spread(ball_race={"distribution": "normal", "same_for_batch": 2})


def batch_quantiles(scene, plan):
    batches = Batches(scene, plan)
    return batches.quantiles(lives(scene, batches.rows).life, EXACT).values()


def test_l10_of_a_batch_scales_with_what_is_not_known():
    """K_s of the batch times H of each bearing: both quantiles are known in closed form."""
    wear = {"distribution": "lognormal", "factor": 2.0}
    hardness = {"distribution": "uniform", "low": 5.0, "high": 8.0, "same_for_batch": False}
    scene = with_spread(wear_coefficient=wear, brinell_hardness_GPa=hardness)
    found, error = batch_quantiles(scene, PLAN)
    nominal = life(scene).values["life"] * HOURS_PER_SECOND / scene.nominal("brinell_hardness_GPa")
    of_bearings = 5.0 + 3.0 * np.array([0.05, 0.1, 0.5, 0.9, 0.95])
    of_batches = 2.0 ** stats.norm.ppf([0.05, 0.5, 0.95])
    exact = of_batches[:, None] * of_bearings * nominal
    assert_allclose(found, exact, rtol=1e-3)  # no life but one is needed
    assert_allclose(error, 0.0)
    # with nothing but scatter all batches are alike
    alone, _ = batch_quantiles(with_spread(brinell_hardness_GPa=hardness), PLAN)
    assert_allclose(alone, np.broadcast_to(alone[0], alone.shape), rtol=1e-12)
    assert sizes(1024) == (32, 64) and sizes(64) == (8, 16)


def made_up_factors(rows, draws):
    """Factors exp(z) on lives (rows, draws) by wear, at even probabilities."""
    even = (np.arange(draws) + (np.arange(rows)[:, None] + 0.5) / rows) / draws
    return np.exp(stats.norm.ppf(even))


def made_up_lives(batches, bearings, seed):
    """Lives exp(0.4 x + 0.3 y) h of batches x and bearings y, of two and four normal values."""
    x, y = (
        stats.norm.ppf(qmc.Sobol(k, seed=seed + k).random(n)).sum(axis=1) / np.sqrt(k)
        for k, n in ((2, batches), (4, bearings))
    )
    hours = np.exp(0.4 * x[:, None] + 0.3 * y)
    factors = np.ones((bearings, 1)), made_up_factors(batches, 256)
    return hours, *factors


def test_error_of_the_interval_of_l10_covers_it():
    """Closed form: quantiles of batches, 0.4 and 1.0 in quadrature, times those of bearings."""
    of_batches = np.exp(np.hypot(0.4, 1.0) * stats.norm.ppf(BATCH_PROBABILITIES))
    exact = of_batches[:, None] * np.exp(0.3 * stats.norm.ppf(PROBABILITIES))
    covered, size = [], {}
    for seed in range(12):
        found, low, high = quantiles_with_error(*made_up_lives(8, 16, seed))
        covered.append(~(low > exact) & ~(high < exact))
        size[seed] = (high / found)[[0, 1], 2]
    assert np.mean(covered) > 0.95
    assert 1.1 < np.mean(list(size.values())) < 1.6  # and says something
    found, _, high = quantiles_with_error(*made_up_lives(32, 64, 0))
    assert ((high / found)[[0, 1], 2] - 1.0 < 0.7 * (size[0] - 1.0)).all()


@pytest.mark.parametrize(("wear", "rows"), [(1.0, 128), (1.0, 32), (0.0, 128)])
def test_intervals_of_independent_bearings_cover_as_often_as_stated(wear, rows):
    """Closed form: the deviations of wear and of all else in quadrature; rows drawn at random."""
    random = np.random.default_rng(0)
    factors = made_up_factors(rows, 64) if wear else np.ones((rows, 1))
    exact = np.exp(np.hypot(0.3, wear) * stats.norm.ppf(PROBABILITIES))
    covered, widths = [], []
    for _ in range(100):
        hours = np.exp(0.3 * random.standard_normal((1, rows)))
        found = quantiles_with_error(hours, factors, np.ones((1, 1)), of_batches=[0.5])
        low, high = (end[0] for end in (found.low, found.high))
        covered.append(~(low > exact) & ~(high < exact))
        widths.append(np.log(high / low))
    assert 0.91 < np.mean(covered) < 0.98
    if wear:  # nothing but the mean of all else is sampled
        assert_allclose(np.mean(widths), 2.0 * 1.96 * 0.3 / np.sqrt(rows), rtol=0.1)


def test_error_of_the_interval_with_lives_that_were_not_solved():
    hours, *factors = made_up_lives(8, 16, 0)
    hours[2, 5:9], hours[3] = np.nan, np.nan
    found = quantiles_with_error(hours, *factors)
    assert np.isfinite(found.quantile).all() and np.isfinite(found.high[1, :3]).all()
    assert np.isnan(quantiles_with_error(np.nan * hours, *factors)).all()
    alone = quantiles_with_error(hours[:1], np.ones((16, 1)), np.ones((1, 1)))
    assert_allclose(alone.quantile[0], alone.quantile[-1])
    assert (alone.high > alone.quantile)[:, 2].all()
    # the share of lives that may be anywhere leaves the ends open
    unsure = quantiles_with_error(hours, *factors, Stated(0.1, 0.06))
    assert np.isnan(unsure.low[:, 0]).all() and np.isnan(unsure.high[:, -1]).all()
    assert (unsure.high > 1.1 * found.high)[:, 2].all()


def test_how_often_a_method_lives_longest():
    """By counting pairs one after the other; errors and unsolved lives widen the interval."""
    rng, n = np.random.default_rng(3), 400
    first, second = rng.lognormal(0.3, 1.0, n), rng.lognormal(0.0, 1.0, n)
    first[:4], second[4:8], second[8:20] = 0.0, np.nan, first[8:20]
    life = np.stack([first, second])
    pairs = [(a, b) for a, b in zip(first, second, strict=True) if b == b]
    wins = sum(a > b for a, b in pairs)
    plain = longest_shares(life, [EXACT, EXACT])
    assert_allclose(plain[0, 0], wins / len(pairs), rtol=1e-15)
    assert_allclose(plain[1, 0], sum(b > a for a, b in pairs) / len(pairs), rtol=1e-15)
    low, high = plain[0, 1:]  # at these ends 2.5 % of samples have so many wins, or so few
    assert_allclose(stats.binom.sf(wins - 1, len(pairs), low), 0.025, rtol=1e-9)
    assert_allclose(stats.binom.cdf(wins, len(pairs), high), 0.025, rtol=1e-9)
    rough = longest_shares(life, [Stated(0.05, 0.01), Stated(0.1, 0.02)])
    surely = sum(a * 0.95 > b * 1.1 for a, b in pairs)
    assert_allclose(rough[:, 0], plain[:, 0])
    assert_allclose(
        rough[0, 1], stats.binomtest(surely, len(pairs)).proportion_ci().low - 0.03, rtol=1e-12
    )
    assert rough[0, 2] > plain[0, 2] + 0.03
    assert np.isnan(longest_shares(np.nan * life, [EXACT, EXACT])).all()


@pytest.mark.parametrize("scatters", [False, True])
def test_no_l10_where_bearings_of_a_batch_are_alike(scatters, tmp_path, capsys):
    """Known answer: K_s alone; life is proportional to 1/K_s, lognormal with a factor of 3."""
    wear = {"distribution": "lognormal", "factor": 3.0, "same_for_batch": not scatters}
    scene = with_spread(wear_coefficient=wear)
    path = tmp_path / "uncertainty.nc"
    write_dataset(own_quantiles(scene, ["constant_force"], Sampling(samples=256)), path)
    found = spread_at(load(path).squeeze().isel(uncertain_inputs=0))
    nominal = float(life(scene).values["life"]) * HOURS_PER_SECOND
    ends = nominal * 3.0 ** stats.norm.ppf([0.05, 0.95])
    assert_allclose(found.bearings, ends, rtol=0.03)
    assert_allclose(found.scatter if scatters else found.unknown, ends, rtol=0.1)
    assert (found.unknown if scatters else found.scatter) is None
    assert list(found.quantiles) == (["L10", "L50"] if scatters else [])
    assert main(["show", str(path)]) == 0
    assert ("L10" in capsys.readouterr().out) == scatters
    assert main(["plot", str(path), "-o", str(tmp_path / "a.svg")]) == 0
    title = ET.parse(tmp_path / "a.svg").getroot().findtext("{http://www.w3.org/2000/svg}title")
    low, high = found.bearings.text.split(" to ")
    assert f"between {low} and {high} h" in " ".join(title.split()) and "L10" not in title


def test_indices_within_a_class_are_among_their_own():
    scene = with_spread(
        wear_coefficient={"distribution": "lognormal", "factor": 3.0},
        contact_angle_deg={"distribution": "normal", "standard_deviation": 1.0},
    )
    found = class_indices(scene, PLAN)
    # each alone in its class, whatever the other spreads
    assert_allclose(found, 1.0, atol=0.1)


@pytest.fixture
def fewer(monkeypatch):
    monkeypatch.setattr(grooves, "FOLLOWED", (16, 16))


def test_sampled_lives_follow_grooves_where_life_does(fewer):
    """Those followed are the quick lives themselves; others are as near as the error says."""
    scene = with_spread(
        FOLLOWED,
        ball_race={"distribution": "uniform", "low": 0.06, "high": 0.1},
        preload_N={"distribution": "normal", "standard_deviation": 0.3},
        wear_coefficient={"distribution": "lognormal", "factor": 2.0},
    )
    rows = sample(scene, Sampling(samples=16, chunks=1, seed=1))[:, [0, -1]].reshape(-1, 3)
    found = lives(scene, rows)
    assert found.followed == 20 and (found.status == 0).all()
    assert 0.0 < found.worn.error < 0.01 and 0.0 < found.worn.share < 0.1
    names = list(scene.uncertainty)
    for k in (0, 7, 31):
        one = perturbed(scene, dict(zip(names, map(float, rows[k]), strict=True)))
        assert_allclose(found.life[k], life(one).values["life"], rtol=0.01)
    few = lives(scene, rows[:6])
    assert few.followed == 6 and few.worn == (0.0, 0.0)
    assert_allclose(few.life, found.life[:6], rtol=3e-3)


def test_lives_of_hertzian_grooves_follow_none():
    scene = with_spread(ball_race={"distribution": "uniform", "low": 0.06, "high": 0.1})
    found = found_lives(scene, ["ball_race"], np.array([[0.06], [0.1]]))
    assert found.followed == 0 and np.isnan(found.worn.error)
    assert found.solved == 2 and found.known == (0.0, 0.0) and (found.life > 0.0).all()
    too_large = scene.bearing.ball_diameter_mm * np.array([[1.2]])
    nothing = found_lives(scene, ["ball_diameter_mm"], too_large)
    assert nothing.status.tolist() == [BEYOND_GROOVE] and np.isnan(nothing.life).all()
