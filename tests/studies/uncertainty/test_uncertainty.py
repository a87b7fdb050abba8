"""Lives of the design map against the life itself, and uncertainty against closed forms."""

import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats
from support import scene_file

import bearingwear
from bearingwear.cli import main
from bearingwear.lives.life import life
from bearingwear.results.netcdf import load
from bearingwear.results.quantiles import (
    ALL_BUT_WEAR,
    ALL_INPUTS,
    BATCH_ONLY,
    MEDIAN_BATCH,
    SCATTER_ONLY,
    load_quantiles,
    spread_at,
)
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.results.words import plain_scene
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.scene.scene import EndOfLife
from bearingwear.studies.dataset import write_dataset
from bearingwear.studies.design.figures.uncertainty_figure import uncertainty_figure
from bearingwear.studies.design.map import life_point, scene_at
from bearingwear.studies.sampling import Sampling, scene_with_values
from bearingwear.studies.uncertainty.plan import OWN
from bearingwear.studies.uncertainty.preloads import with_preload
from bearingwear.studies.uncertainty.quantiles import life_quantiles, sobol_rows
from bearingwear.studies.uncertainty.sample import sample_of, sampled_lives
from bearingwear.studies.uncertainty.variables import PROBABILITIES

FOLLOWED = ["model.contact=auto", "model.normal_balance=frictionless"]
"""Settings with which lives follow grooves as they wear."""


def with_spread(**spread):
    """Returns gyro_s1 with these distributions of its uncertain values, by their names."""
    plain = load_scene(scene_file("gyro_s1")).to_dict()
    return scene_from_dict(plain | {"uncertainty": spread})


def own_quantiles(scene, plan, workers=1):
    """Returns the dataset of quantiles of lives at the preload and by the method of the scene."""
    operation = scene.operation
    return life_quantiles(
        [scene], {(operation.preload_method, OWN): operation.preload_N}, plan, workers
    )


def scene_life(scene, values=None):
    """Returns the life [h] of a scene.

    values: of its uncertain inputs, in the order of `scene.uncertainty`; None for the nominal ones.
    """
    if values is not None:
        scene = scene_with_values(
            scene, dict(zip(scene.uncertainty, map(float, values), strict=True))
        )
    return float(life(scene).values["life"]) * HOURS_PER_SECOND


def test_a_point_of_the_map_has_the_life_of_life_and_its_time_to_a_slip_limit():
    """The time is the life with that limit as a criterion; a slip share of 0.25 ends it earlier."""
    # friction, r/min, N
    scene = scene_at(load_scene(scene_file("gyro_s1")), "fixed_position", 0.05, 25000.0, 6.0)
    point, values = life_point(scene, 0.25), life(scene).values
    assert_allclose(point["life"], values["life"], rtol=1e-12)
    assert point["end_criterion"] == values["end_criterion"]
    assert point["gyroscopic_slip_share"] == values["history_gyroscopic_slip_share"].max()
    wear = replace(scene.wear, end_of_life=EndOfLife(gyroscopic_slip_share=0.25))
    life_to_slip_limit = life(replace(scene, wear=wear)).values["life"]
    assert_allclose(point["time_to_slip_limit"], life_to_slip_limit, rtol=1e-12)
    assert np.all(life_to_slip_limit < values["life"])


def test_life_is_inverse_to_the_wear_coefficient():
    """Known answer: with K_s alone uncertain, life is C/K_s, and one solve is enough.

    Quantiles are those of evenly spaced factors, to 2e-4; as nothing else varies, so are both ends
    of their intervals.
    """
    scene = with_spread(wear_coefficient={"distribution": "uniform", "low": 2e-6, "high": 8e-6})
    quantiles = own_quantiles(scene, Sampling(samples=64)).squeeze()
    assert quantiles["evaluations"] == 1
    # three samples, of batches, scatter and both, and the nominal life
    assert quantiles["status_count"].values.tolist()[0] == 3 * 64 + 1
    constant = scene_life(scene) * 5e-6  # the K_s of gyro_s1, in the middle of its range
    exact = constant / (8e-6 - np.array(PROBABILITIES) * 6e-6)
    at = {"uncertain_inputs": ALL_INPUTS}
    assert_allclose(quantiles["life_quantile"].sel(at), exact, rtol=2e-4)
    for end in ("low", "high"):
        assert_allclose(quantiles[f"life_quantile_{end}"].sel(at), exact, rtol=1e-3)
    members = quantiles["life_sample"].sel(at).values
    even = (np.arange(len(members)) + 0.5) / len(members)
    assert_allclose(members, constant / (8e-6 - even * 6e-6), rtol=5e-4)
    # K_s is the same for a batch: with its nominal value, and within the median batch, all lives
    # are equal, exact[2] being the median
    for inputs, expected in ((ALL_BUT_WEAR, constant / 5e-6), (SCATTER_ONLY, exact[2])):
        alike = quantiles["life_quantile"].sel(uncertain_inputs=inputs)
        assert_allclose(alike, expected, rtol=1e-9)


def test_scaled_lives_are_the_solved_ones():
    """Rows that differ only in K_s and H share one solve; a solve of each row gives its life."""
    scene = with_spread(
        wear_coefficient={"distribution": "lognormal", "factor": 2.0},
        brinell_hardness_GPa={"distribution": "uniform", "low": 5.0, "high": 8.0},
        ball_race={"distribution": "normal", "standard_deviation": 0.01},
    )
    rows = sobol_rows(scene, Sampling(samples=1, seed=5))[:, 0]
    sampled = sampled_lives(scene, rows)
    assert (sampled.status == 0).all() and sampled.solves < len(rows)
    for row, time in zip(rows, sampled.life, strict=True):
        assert_allclose(time, scene_life(scene, row) / HOURS_PER_SECOND, rtol=1e-9)


def test_samples_of_a_batch_and_of_scatter_vary_their_own_values():
    """Closed form: K_s of batches is lognormal, H of bearings uniform; life is C H/K_s.

    64 evenly spaced samples give quantiles to 2e-3.
    """
    scene = with_spread(
        wear_coefficient={"distribution": "lognormal", "factor": 2.0},
        brinell_hardness_GPa={
            "distribution": "uniform", "low": 5.0, "high": 8.0, "same_for_batch": False
        },
    )  # fmt: skip
    quantiles = own_quantiles(scene, Sampling(samples=64)).squeeze()
    nominal = scene_life(scene) / scene.nominal("brinell_hardness_GPa")  # h/GPa; 6.5 is the mean
    of_bearings = nominal * (5.0 + 3.0 * np.array(PROBABILITIES))
    of_batches = nominal * 6.5 * 2.0 ** stats.norm.ppf(PROBABILITIES)
    for inputs, exact in ((SCATTER_ONLY, of_bearings), (BATCH_ONLY, of_batches)):
        quantile = quantiles["life_quantile"].sel(uncertain_inputs=inputs)
        assert_allclose(quantile, exact, rtol=2e-3)
    assert float(quantiles["nominal_life"]) == pytest.approx(6.5 * nominal)


@pytest.mark.parametrize("scatters", [False, True])
def test_no_l10_where_bearings_of_a_batch_are_alike(scatters, tmp_path, capsys):
    """Known answer: K_s alone; life is proportional to 1/K_s, lognormal with a factor of 3.

    64 samples give the 5 and 95 % points to 1 %.

    scatters: whether K_s differs between the bearings of a batch, or from batch to batch alone.
    """
    wear = {"distribution": "lognormal", "factor": 3.0, "same_for_batch": not scatters}
    scene, path = with_spread(wear_coefficient=wear), tmp_path / "uncertainty.nc"
    write_dataset(own_quantiles(scene, Sampling(samples=64)), path)
    spread = spread_at(load(path).squeeze())
    ends = scene_life(scene) * 3.0 ** stats.norm.ppf([0.05, 0.95])
    assert_allclose(spread.bearings, ends, rtol=0.01)
    assert_allclose(spread.scatter if scatters else spread.unknown, ends, rtol=0.01)
    assert (spread.unknown if scatters else spread.scatter) is None
    assert list(spread.quantiles) == (list(MEDIAN_BATCH) if scatters else [])
    assert main(["show", str(path)]) == 0
    assert ("L10" in capsys.readouterr().out) == scatters
    assert main(["plot", str(path), "-o", str(tmp_path / "a.svg")]) == 0
    title = ET.parse(tmp_path / "a.svg").getroot().findtext("{http://www.w3.org/2000/svg}title")
    low, high = spread.bearings.text.split(" to ")
    assert f"between {low} and {high} h" in " ".join(title.split()) and "L10" not in title


@pytest.mark.parametrize(("rho", "expected"), [(0.9, -0.9), (None, 0.0)])
def test_wear_factors_go_with_the_friction_of_their_life(rho, expected):
    """Logs of friction and of the wear factors of its life have the correlation rho, negated.

    Factors are those of a life, H/K_s, hence the sign. A sample of 2048 gives it to 0.01.
    """
    friction = {"distribution": "lognormal", "factor": 1.3}
    wear = {"distribution": "lognormal", "factor": 3.0, "friction_correlation": rho}
    scene = with_spread(ball_race=friction, wear_coefficient=wear)
    sample = sample_of(scene, ALL_INPUTS, Sampling(samples=2048))
    # the first column is friction; each row has several factors
    mu = np.repeat(np.log(sample.rows[:, :1]), sample.factors.shape[1], axis=1)
    correlation = np.corrcoef(mu.ravel(), np.log(sample.factors).ravel())[0, 1]
    assert_allclose(correlation, expected, atol=0.01)
    assert_allclose(np.log(sample.factors).std(), np.log(3.0), rtol=0.01)


def test_indices_of_a_product_are_shares_of_log_variance():
    """log life = log H - log K_s + constant: the indices are the shares of the variance.

    Within 0.03, and within twice the half-width of their stated intervals.
    """
    scene = with_spread(
        wear_coefficient={"distribution": "lognormal", "factor": 1.5},
        brinell_hardness_GPa={"distribution": "uniform", "low": 4.0, "high": 9.0},
    )
    preloads = {("constant_force", OWN): 7.0}
    plan = Sampling(samples=1024)
    quantiles = life_quantiles([scene], preloads, plan, with_indices=True).squeeze()
    # of a uniform distribution from 4 to 9, at 1e5 even points
    of_hardness = np.var(np.log(stats.uniform(4.0, 5.0).ppf((np.arange(1e5) + 0.5) / 1e5)))
    variance = np.array([np.log(1.5) ** 2, of_hardness])
    for kind in ("first_index", "total_index"):
        index, error = (
            quantiles[f"{kind}{end}"].sel(uncertain_inputs=ALL_INPUTS) for end in ("", "_error")
        )
        assert_allclose(index, variance / variance.sum(), atol=0.03)
        assert (np.abs(index - variance / variance.sum()) <= 2.0 * error).all()
    assert quantiles["index_share"] == 1.0 and quantiles["evaluations"] == 1
    # over the nominal, with K_s alone at its 10 and 90 % points: a life is longer at the lower one
    factors = 1.5 ** stats.norm.ppf([0.9, 0.1])
    one_at_a_time = quantiles["life_one_at_a_time"] / quantiles["nominal_life"]
    assert_allclose(one_at_a_time[0], factors, rtol=1e-9)


def test_a_life_that_was_not_solved_has_a_dash_among_the_changes():
    """The changes in the figure are those of one value at its 10 and its 90 % quantile."""
    wear = {"distribution": "lognormal", "factor": 1.5}
    scene = with_spread(wear_coefficient=wear, brinell_hardness_GPa=wear)
    preloads = {("constant_force", OWN): 7.0}
    dataset = life_quantiles([scene], preloads, Sampling(samples=16), with_indices=True)
    dataset["life_one_at_a_time"][..., 0, 0] = np.nan
    _, tornado, _ = uncertainty_figure(dataset).axes
    factors = sorted(100.0 * (1.5 ** stats.norm.ppf([0.1, 0.9]) - 1.0))
    texts = [text.get_text() for text in tornado.texts]
    assert texts[0] == f"{factors[0]:+.1f} … – %"
    assert texts[1] == f"{factors[0]:+.1f} … {factors[1]:+.1f} %"


def test_a_seed_decides_the_lives_whatever_the_processes():
    """One process and two give the same dataset; another seed gives other lives."""
    scene = load_scene(scene_file("gyro_s1"))
    plan = Sampling(samples=4)
    first, again = (own_quantiles(scene, plan, workers) for workers in (1, 2))
    assert first.identical(again)
    other = own_quantiles(scene, Sampling(samples=4, seed=2))
    assert not np.array_equal(first["life_sample"], other["life_sample"])


@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_sampled_lives_follow_grooves_where_life_does(method):
    """Lives agree to 1 %, as sampled ones have fewer cells and longer steps."""
    preloaded = with_preload(load_scene(scene_file("gyro_s1"), FOLLOWED), method, 7.0)
    rows = sample_of(preloaded, ALL_BUT_WEAR, Sampling(samples=4)).rows
    sampled = sampled_lives(preloaded, rows)
    for row, time in zip(rows, sampled.life, strict=True):
        assert_allclose(time, scene_life(preloaded, row) / HOURS_PER_SECOND, rtol=0.01)


def test_lives_that_fail_are_counted(tmp_path, capsys):
    """Balls that are too large for the grooves have no life; the others make the quantiles.

    There are 16 bearings in each of three samples, and the nominal one. The median ball is too
    large, as in the nominal bearing and all of the sample of batches, whose diameters do not vary.
    """
    diameter = {"distribution": "uniform", "low": 1.99, "high": 2.1}
    plain = load_scene(scene_file("gyro_s1")).to_dict()
    path, out = tmp_path / "mine.yaml", tmp_path / "uncertainty.nc"
    bearingwear.save(scene_from_dict(plain | {"uncertainty": {"ball_diameter_mm": diameter}}), path)
    assert main(["uncertainty", str(path), "-o", str(out), "--samples", "16"]) == 0
    dataset = load(out).squeeze()
    names = dataset["life_status"].attrs["flag_meanings"].split()
    counts = dict(zip(names, dataset["status_count"].values.tolist(), strict=True))
    # grooves with radii of 1.08 and 1.17 mm hold balls up to 2.25 - 0.25 cos 20 deg = 2.015 mm,
    # beyond which 13 of the 16 diameters lie
    assert counts["beyond_groove"] == 2 * 13 + 16 + 1 and counts["ok"] == 2 * 3
    assert float(dataset["solved_share"]) == pytest.approx(counts["ok"] / (3 * 16 + 1))
    medians = dataset["life_quantile"].sel(probability=0.5)
    assert medians.sel(uncertain_inputs=ALL_INPUTS) > 0.0
    assert np.isnan(medians.sel(uncertain_inputs=BATCH_ONLY)) and np.isnan(dataset["nominal_life"])
    assert "beyond groove" in capsys.readouterr().out


def test_a_scene_that_no_model_solves_is_refused_in_one_line(tmp_path, capsys):
    """Worn contacts cannot be combined with slip over a line."""
    path, out = tmp_path / "mine.yaml", tmp_path / "uncertainty.nc"
    settings = ["model.contact=worn", "model.slip_over=line"]
    bearingwear.save(load_scene(scene_file("gyro_s1"), settings), path)
    assert main(["uncertainty", str(path), "-o", str(out), "--samples", "4"]) == 2
    output = capsys.readouterr().err.strip().splitlines()[-1]
    assert "model.contact: got worn" in output and not out.exists()


def test_the_spread_at_each_friction_is_that_of_the_scene_with_it(tmp_path):
    """A file of two frictions has for each what a file of that friction alone has."""
    out, path = tmp_path / "uncertainty.nc", str(scene_file("gyro_s1"))
    few = ["--samples", "8", "--quiet", "-o"]
    assert main(["uncertainty", path, *few, str(out), "--friction", "0.02", "0.08"]) == 0
    both = load_quantiles(out)
    assert [plain_scene(spread)["friction"]["ball_race"] for spread in both] == [0.02, 0.08]
    for of_both, mu in zip(both, ("0.02", "0.08"), strict=True):
        file = tmp_path / f"{mu}.nc"
        assert main(["uncertainty", path, *few, str(file), "--friction", mu]) == 0
        (of_one_friction,) = load_quantiles(file)
        assert of_both.equals(of_one_friction)


# a film of a thickness [um], whose wear the contacts do not follow
FILM = ["friction.film.thickness_um=0.15", "model.contact=hertz"]
UNKNOWN_FILM = {
    "wear_coefficient": {"distribution": "lognormal", "factor": 3.0},
    "shear_strength_MPa": {"distribution": "lognormal", "factor": 1.2},
    "thickness_um": {"distribution": "normal", "standard_deviation": 0.02},
}


def film_scene(**changed):
    """Returns mos2_gyro with a film of finite thickness, and with other blocks of the scene."""
    plain = load_scene(scene_file("mos2_gyro"), FILM)
    return scene_from_dict(plain.to_dict() | changed)


def test_lives_with_films_are_those_of_life():
    """Film and steel wear in proportion, so K_s scales a life exactly, through a film's end too.

    Rows of one base sample; the film of a race is worn through within at least one of the lives.
    """
    scene = film_scene(
        uncertainty=UNKNOWN_FILM,
        wear={"end_of_life": {"ball_diameter_loss_um": 1.0}, "counts": "ball_and_races"},
    )
    rows = sobol_rows(scene, Sampling(samples=1, seed=3))[:, 0]
    sampled = sampled_lives(scene, rows)
    assert (sampled.status == 0).all() and np.ptp(sampled.life) > 0.0
    wear_through = []
    for row, time in zip(rows, sampled.life, strict=True):
        inputs = dict(zip(scene.uncertainty, map(float, row), strict=True))
        values = life(scene_with_values(scene, inputs)).values
        assert_allclose(time, values["life"], rtol=1e-9)
        wear_through.append(np.isfinite(values["race_film_worn_through"]).any())
    assert any(wear_through)


def test_an_uncertain_thickness_of_an_endless_film_is_refused():
    """A film without a thickness lasts, so that no criterion may be its wearing through."""
    endless = film_scene().to_dict()
    for key in ("thickness_um", "bare_ball_race"):
        del endless["friction"]["film"][key]
    del endless["wear"]["end_of_life"]["film_worn_share"]
    with pytest.raises(
        SceneError, match="uncertainty.thickness_um: got this key without friction.film"
    ):
        scene_from_dict(endless | {"uncertainty": UNKNOWN_FILM})


@pytest.mark.parametrize(
    "name, settings, source",
    [
        ("gyro_s1", [], "archard, dry_steel"),
        ("mos2_gyro", FILM, "film mos2"),
        ("turbopump", ["model.contact=hertz"], "spread assumed"),
    ],
)
def test_a_scene_without_distributions_takes_those_of_the_table(
    name, settings, source, tmp_path, capsys
):
    """The sheets of the spread and of the life name the rows of the table (`source`).

    The table is that of assumed distributions, by the kind of wear or film of a scene.
    """
    plain = load_scene(scene_file(name), settings).to_dict()
    plain.pop("uncertainty", None)
    path, out = tmp_path / "mine.yaml", tmp_path / "uncertainty.nc"
    bearingwear.save(scene_from_dict(plain), path)
    assert main(["uncertainty", str(path), "-o", str(out), "--samples", "8"]) == 0
    output, errors = (" ".join(text.split()) for text in capsys.readouterr())
    assert source in output and source in errors
    # beside the file of the spread, the sheet of a life has the interval of that file as well, with
    # its source; without the file, it has only the interval due to the wear coefficient
    assert main(["life", str(path), "-o", str(tmp_path / "life.nc")]) == 0
    output = " ".join(capsys.readouterr().out.split())
    assert "within a batch" in output and output.count(source) == 2
    out.unlink()
    assert main(["show", str(tmp_path / "life.nc")]) == 0
    output = " ".join(capsys.readouterr().out.split())
    assert "wear only" in output and output.count(source) == 1
