"""Lives of the design map against the life itself, and uncertainty against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats
from support import scene_file

import bearingwear
from bearingwear.cli import main
from bearingwear.lives.life import life
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.scene.scene import EndOfLife
from bearingwear.studies.design.map import life_point, scene_at
from bearingwear.studies.sampling import Sampling, perturbed
from bearingwear.studies.uncertainty.quantiles import indices, own_quantiles
from bearingwear.studies.uncertainty.sample import independent_rows, lives, sample, sample_part

PLAN = Sampling(samples=1024, chunks=1, seed=1)


def with_spread(**spread):
    plain = load_scene(scene_file("gyro_s1")).to_dict()
    return scene_from_dict(plain | {"uncertainty": spread})


def test_life_of_the_map_is_the_life():
    scene = scene_at(load_scene(scene_file("gyro_s1")), "fixed_position", 0.05, 25000.0, 6.0)
    point, whole = life_point(scene, 0.25), life(scene).values
    assert_allclose(point["life"], whole["life"], rtol=1e-12)
    assert point["end_criterion"] == whole["end_criterion"]
    assert point["gyroscopic_slip_share"] == whole["history_gyroscopic_slip_share"].max()
    share = replace(scene.wear, end_of_life=EndOfLife(gyroscopic_slip_share=0.25))
    until = life(replace(scene, wear=share)).values["life"]
    assert_allclose(point["time_to_slip_limit"], until, rtol=1e-12)
    assert np.all(until < whole["life"])


def test_life_is_inverse_to_the_wear_coefficient():
    """Known answer: with K_s alone uncertain, life is C/K_s, and K_s explains all of it."""
    scene = with_spread(wear_coefficient={"distribution": "uniform", "low": 2e-6, "high": 8e-6})
    sampled = sample_part(scene, PLAN, "constant_force")
    y = sampled["life"].values
    K_s = sample(scene, PLAN)[..., 0]
    constant = life(scene).values["life"] * HOURS_PER_SECOND * 5e-6
    assert_allclose(y * K_s, y.flat[0] * K_s.flat[0], rtol=1e-12)
    assert_allclose(y * K_s, constant, rtol=1e-9)  # sampled lives have longer steps
    found = indices(scene, np.log(y), seed=1)
    assert_allclose(found["first_index"], 1.0, atol=0.03)  # sampling error, a few/sqrt(1024)
    assert_allclose(found["total_index"], 1.0, atol=0.03)
    # quantiles need one life: their intervals are those of the numbers of the wear factor
    found = own_quantiles(scene, ["constant_force"], replace(PLAN, samples=64))
    low, middle, high = (
        found[f"life_quantile{end}"].values[0, 0, 0] for end in ("_low", "", "_high")
    )
    exact = constant / (8e-6 - np.array([0.05, 0.1, 0.5, 0.9, 0.95]) * 6e-6)
    assert_allclose(middle, exact, rtol=2e-4)
    assert_allclose([low, high], [exact, exact], rtol=1e-3)
    members = found["life_sample"].values[0, 0, 0]
    even = (np.arange(len(members)) + 0.5) / len(members)
    assert_allclose(members, constant / (8e-6 - even * 6e-6), rtol=5e-4)


def test_scaled_lives_are_the_solved_ones():
    """Rows that differ in K_s and H are solved once; solving them anyhow gives the same."""
    scene = with_spread(
        wear_coefficient={"distribution": "lognormal", "factor": 2.0},
        brinell_hardness_GPa={"distribution": "uniform", "low": 5.0, "high": 8.0},
        ball_race={"distribution": "normal", "standard_deviation": 0.01},
    )
    rows = sample(scene, Sampling(samples=1, chunks=1, seed=5))[0]
    found = lives(scene, rows)
    names = list(scene.uncertainty)
    for row, hours, state in zip(rows, found.life, found.status, strict=True):
        one = life(perturbed(scene, dict(zip(names, map(float, row), strict=True))))
        assert state == 0
        assert_allclose(hours, one.values["life"], rtol=1e-9)


def test_indices_of_a_product_are_shares_of_log_variance():
    """log life = log H - log K_s + constant: the indices are the shares of the variance."""
    scene = with_spread(
        wear_coefficient={"distribution": "lognormal", "factor": 1.5},
        brinell_hardness_GPa={"distribution": "uniform", "low": 4.0, "high": 9.0},
    )
    sampled = sample_part(scene, Sampling(samples=4096, chunks=1, seed=1), "fixed_position")
    found = indices(scene, np.log(sampled["life"].values), seed=1)
    of_hardness = np.var(np.log(stats.uniform(4.0, 5.0).ppf((np.arange(1e5) + 0.5) / 1e5)))
    variance = np.array([np.log(1.5) ** 2, of_hardness])
    share = variance / variance.sum()
    for kind in ("first_index", "total_index"):
        assert np.all(np.abs(found[kind] - share) <= 2.0 * found[f"{kind}_error"])
        assert_allclose(found[kind], share, atol=0.03)


@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_same_seed_same_lives(method):
    scene = load_scene(scene_file("gyro_s1"))
    plan = Sampling(samples=2, chunks=2, seed=1)
    first, again = (sample_part(scene, plan, method, chunk=1) for _ in range(2))
    assert first.identical(again)
    other = sample_part(scene, Sampling(samples=2, chunks=2, seed=2), method, chunk=1)
    assert not np.array_equal(first["life"], other["life"])


def test_spread_of_a_life_is_that_of_the_design_study():
    """Same base samples: the lives of the one are those of the other."""
    scene, plan = load_scene(scene_file("gyro_s1")), Sampling(samples=4, chunks=1, seed=1)
    rows = sample(scene, plan)[:, [0, -1]].reshape(-1, len(scene.uncertainty))
    assert_allclose(rows, independent_rows(scene, plan), rtol=1e-12)


FILM = ["friction.film.thickness_um=0.15", "model.contact=hertz"]
UNKNOWN_FILM = {
    "wear_coefficient": {"distribution": "lognormal", "factor": 3.0},
    "shear_strength_MPa": {"distribution": "lognormal", "factor": 1.2},
    "thickness_um": {"distribution": "normal", "standard_deviation": 0.02},
}


def film_scene(**changed):
    plain = load_scene(scene_file("mos2_gyro"), FILM)
    return scene_from_dict(plain.to_dict() | changed)


def test_lives_with_films_are_those_of_life():
    """Film and steel wear in proportion, so K_s scales a life exactly, through a film's end too."""
    scene = film_scene(
        uncertainty=UNKNOWN_FILM,
        wear={"end_of_life": {"ball_diameter_loss_um": 1.0}, "counts": "ball_and_races"},
    )
    rows = sample(scene, Sampling(samples=1, chunks=1, seed=3))[0]
    found = lives(scene, rows)
    assert (found.status == 0).all()
    names, through = list(scene.uncertainty), 0
    for row, hours in zip(rows, found.life, strict=True):
        one = life(perturbed(scene, dict(zip(names, map(float, row), strict=True)))).values
        assert_allclose(hours, one["life"], rtol=1e-9)
        through += np.isfinite(one["race_film_worn_through"]).any()
    assert through > 0 and np.ptp(found.life / found.wear_factor) > 0.0


def test_thickness_is_that_of_a_film_that_has_one():
    endless = film_scene().to_dict()
    for key in ("thickness_um", "bare_ball_race"):
        del endless["friction"]["film"][key]
    del endless["wear"]["end_of_life"]["film_worn_share"]
    with pytest.raises(
        SceneError, match="uncertainty.thickness_um: got this key without friction.film"
    ):
        scene_from_dict(endless | {"uncertainty": UNKNOWN_FILM})


@pytest.mark.parametrize(
    "name, settings, said",
    [
        (
            "gyro_s1",
            [],
            "spread for steel/steel, dry, from archard, dry_steel: K_s/H by",
        ),
        ("mos2_gyro", FILM, "spread for steel/steel, film mos2 (no source for other films), from"),
        ("turbopump", ["model.contact=hertz"], "spread assumed, because no source covers"),
    ],
)
def test_a_scene_without_distributions_takes_those_of_the_table(
    name, settings, said, tmp_path, capsys
):
    plain = load_scene(scene_file(name), settings).to_dict()
    plain.pop("uncertainty", None)
    path, out = tmp_path / "mine.yaml", tmp_path / "uncertainty.nc"
    bearingwear.save(scene_from_dict(plain), path)
    assert main(["uncertainty", str(path), "-o", str(out), "--samples", "8"]) == 0
    shown, told = capsys.readouterr()
    assert said in shown and said in told and "90 % of bearings" in shown
    # the sheet of the life has the interval beside it, and the band by wear that holds without
    assert main(["life", str(path), "-o", str(tmp_path / "life.nc")]) == 0
    shown = capsys.readouterr().out
    assert "scatter within a batch" in shown and shown.count(said) == 2
    out.unlink()
    assert main(["show", str(tmp_path / "life.nc")]) == 0
    shown = capsys.readouterr().out
    assert "90 % of bearings, wear only" in shown and said in shown
