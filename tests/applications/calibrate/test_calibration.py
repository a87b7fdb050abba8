"""Tests of bearings in a CSV file, and the scene that they calibrate."""

import hashlib
import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.stats import norm
from support import numbers_in, scene_file

import bearingwear
from bearingwear.applications.calibrate.bearing_tests import bearing_tests
from bearingwear.applications.calibrate.calibration import calibration_by_tests
from bearingwear.cli import main
from bearingwear.lives.life import life
from bearingwear.results.netcdf import CaseFileError
from bearingwear.results.quantiles import ALL_INPUTS, BATCH_ONLY, SCATTER_ONLY
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.solvers.solve import solve
from bearingwear.studies.sampling import Sampling, scene_with_values
from bearingwear.studies.uncertainty.plan import OWN
from bearingwear.studies.uncertainty.quantiles import life_quantiles

SPREAD = {
    "wear_coefficient": {"distribution": "lognormal", "factor": 3.0},
    "wear_scatter": {"distribution": "lognormal", "factor": 1.3},
    "ball_race": {"distribution": "lognormal", "factor": 1.2},
}


def with_spread(settings=(), **spread):
    plain = load_scene(scene_file("gyro_s1"), list(settings)).to_dict()
    return scene_from_dict(plain | {"uncertainty": SPREAD | spread})


def written(folder, *lines):
    path = folder / "tests.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def hours(scene):
    balls_life = life(scene).values["life"]  # of balls and races
    return balls_life * HOURS_PER_SECOND


@pytest.mark.parametrize(
    "line, problem",
    [
        ("7,,,", "row 2: got nothing, expected one of life_h, run_out_h"),
        ("7,3,4,", "row 2: got life_h and loss_um, expected one of"),
        ("7,two,,", "row 2: life_h: got 'two', expected a number > 0"),
        ("7,3,,5", "row 2: after_h: got '5', only allowed with loss_um or preload_left_N"),
        ("7,3,,,9", "row 2: got 5 cells, expected 4"),
    ],
)
def test_a_bad_row_is_refused_in_one_line(tmp_path, line, problem):
    path = written(tmp_path, "operation.preload_N,life_h,loss_um,after_h", line)
    with pytest.raises(CaseFileError) as refused:
        bearing_tests(path, with_spread())
    assert str(refused.value).startswith(f"{path}: {problem}") and "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "lines, problem",
    [
        (["life", "3"], "got the column 'life', expected a scene key"),
        (["life_h,life_h", "3,4"], "got the column 'life_h' twice"),
        (
            ["preload_left_N,after_h", "4,1"],
            "row 2: preload_left_N: got this result with constant",
        ),
        (
            ["operation.preload_method,preload_left_N,after_h", "fixed_position,8,1"],
            "row 2: preload_left_N: got 8, expected a number < 7",
        ),
    ],
)
def test_a_bad_file_is_refused_in_one_line(tmp_path, lines, problem):
    with pytest.raises(CaseFileError) as refused:
        bearing_tests(written(tmp_path, *lines), with_spread())
    assert problem in str(refused.value) and "\n" not in str(refused.value)


def test_a_table_of_excel_in_europe(tmp_path):
    """Semicolons between columns, commas in numbers, a mark of the byte order before all."""
    rows = [("operation.preload_N", "life_h"), ("7.25", "4.5"), ("", "1.5e2")]
    plain = written(tmp_path, *(",".join(row) for row in rows))
    expected = bearing_tests(plain, with_spread())
    european = [";".join(row).replace(".", ",") for row in rows[1:]]
    path = written(tmp_path, "\ufeff" + ";".join(rows[0]), *european)
    assert bearing_tests(path, with_spread()) == expected
    assert [item.value for item in expected] == [4.5, 150.0]


def test_columns_may_be_separated_by_semicolons_or_tabs(tmp_path):
    rows = ("operation.preload_N,life_h", "7,5")
    by_separator = [
        bearing_tests(written(tmp_path, *[row.replace(",", apart) for row in rows]), with_spread())
        for apart in ",;\t"
    ]
    assert by_separator[0] == by_separator[1] == by_separator[2] and by_separator[0][0].value == 5.0
    with pytest.raises(SceneError, match="cannot be read .*expected a CSV file"):
        bearing_tests(tmp_path / "none.csv", with_spread())


def test_a_scene_without_what_tests_tell_of_is_refused(tmp_path):
    path = written(tmp_path, "torque_Nmm", "0.1")
    unknown = with_spread().to_dict()
    for name, expected in (
        (
            "wear_coefficient",
            "uncertainty.wear_coefficient: got no value that tests could determine",
        ),
        ("wear_scatter", "uncertainty: got no value that varies"),
        ("ball_race", "row 2: torque_Nmm: got a result that would determine uncertainty.ball_race"),
    ):
        spread = {n: value for n, value in unknown["uncertainty"].items() if n != name}
        with pytest.raises((SceneError, CaseFileError), match=expected):
            calibration_by_tests(scene_from_dict(unknown | {"uncertainty": spread}), path)


@pytest.mark.long
def test_each_kind_of_test_finds_what_made_it(tmp_path):
    """A batch of 0.4 times the wear and mu 0.095, seen without error in every way."""
    scene, K, mu = (
        with_spread(wear_scatter={"distribution": "lognormal", "factor": 1.001}),
        0.4,
        0.095,
    )
    fixed = scene.with_({"operation.preload_method": "fixed_position"})
    batch = scene_with_values(scene, {"ball_race": mu})
    lost = batch.with_({"wear.end_of_life": {"ball_diameter_loss_um": 0.3}})
    left = scene_with_values(fixed, {"ball_race": mu}).with_(
        {"wear.end_of_life": {"preload_fraction": 5.0 / 7.0}}
    )
    torque = 1e3 * float(solve(batch).values["shaft_torque"])
    for seen in (
        f",{hours(batch) / K},,,,",
        f",,0.3,,{hours(lost) / K},",
        f"fixed_position,,,5,{hours(left) / K},",
    ):
        path = written(
            tmp_path,
            "operation.preload_method,life_h,loss_um,preload_left_N,after_h,torque_Nmm,error_percent",
            f"{seen},0.1",
            f",,,,,{torque},0.1",
        )
        calibration = calibration_by_tests(scene, path)
        assert_allclose(calibration.scene.friction.ball_race, mu, rtol=2e-3)
        ratio = calibration.scene.nominal("wear_coefficient") / scene.nominal("wear_coefficient")
        assert_allclose(ratio, K, rtol=1e-2)
        assert float(calibration.data["interpolation_error"]) < 5e-3


@pytest.mark.long  # of a model in closed form: test_posterior.py
def test_two_lives_of_a_sampled_batch(tmp_path):
    """The interval of L10 shrinks to that of the mean of two lives."""
    scene = with_spread(preload_N={"distribution": "normal", "standard_deviation": 0.35})
    random, K = np.random.default_rng(3), 1.7
    batch = replace(scene_with_values(scene, {"ball_race": 0.074}), uncertainty=None)
    of_bearings = [
        hours(batch.with_({"operation.preload_N": 7.0 + 0.35 * random.normal()}))
        / (K * 1.3 ** random.normal())
        for _ in range(2)
    ]
    path = written(tmp_path, "life_h", *map(str, of_bearings))
    calibration = calibration_by_tests(scene, path)
    before, after = calibration.data["batch_life_quantile"].values
    scatter = float(calibration.data["scatter"])
    assert math.log(1.3) < scatter < 0.32  # the preload adds some
    # log L10 is normal about the mean of both; friction is seen through the same lives
    theory = math.exp(2.0 * 1.6449 * scatter / math.sqrt(2.0))
    assert before[-1] / before[0] > 35.0
    assert_allclose(after[-1] / after[0], theory, rtol=0.05)


def test_the_calibrated_scene_carries_it_all(tmp_path, capsys):
    scene = with_spread()
    base = tmp_path / "mine.yaml"
    bearingwear.save(scene, base)
    path = written(tmp_path, "torque_Nmm,life_h,run_out_h,bearings", "0.017,,,", ",5,,", ",,4,2")
    out = tmp_path / "calibrated.yaml"
    assert main(["calibrate", str(base), str(path), "-o", str(out)]) == 0
    assert "tests.csv" in capsys.readouterr().out
    carried = load_scene(out)
    assert carried.calibrated.sha256 == hashlib.sha256(path.read_bytes()).hexdigest()
    assert carried.calibrated.rows == 3
    # a study of it takes three decimals
    assert carried.friction.ball_race == round(carried.friction.ball_race, 3)
    assert carried.uncertainty["wear_coefficient"].factor < 1.5
    assert carried.uncertainty["wear_scatter"].factor == 1.3
    data = bearingwear.load(tmp_path / "calibrated.nc")
    # a second time would count the tests twice
    assert main(["calibrate", str(out), str(path), "-o", str(tmp_path / "again.yaml")]) == 2
    assert "got the tests used to calibrate the scene" in capsys.readouterr().err
    # `uncertainty` of the scene has the same interval, by a sample and by lognormal marginals
    spread = tmp_path / "u.nc"
    assert main(["uncertainty", str(out), "-o", str(spread), "--quiet"]) == 0
    sampled = bearingwear.load(spread)["life_quantile"].isel(
        preload_method=0, preload_choice=0, uncertain_inputs=0
    )
    for p in (0.1, 0.5):
        quantile = float(data["life_quantile"].sel(stage="after", probability=p))
        assert_allclose(float(sampled.sel(probability=p)), quantile, rtol=0.06)
    # the same tests give the same bytes
    assert main(["calibrate", str(base), str(path), "-o", str(tmp_path / "b.yaml")]) == 0
    assert (tmp_path / "b.yaml").read_bytes() == out.read_bytes()
    assert (tmp_path / "b.nc").read_bytes() == (tmp_path / "calibrated.nc").read_bytes()
    bearingwear.plot(data)


def l10_of_batches(scene, correlation):
    """L10 of a batch (h), at probabilities 0.05, 0.5 and 0.95, by quadrature over friction.

    The logarithm of a batch's median life is m(x) - y. Lives are solved at 13 values of friction,
    and given friction, K_s/H is lognormal.
    """
    spread = scene.uncertainty
    deviation = {name: math.log(value.factor) for name, value in spread.items()}
    middle = math.log(scene.friction.ball_race)
    nodes = np.linspace(-4.0, 4.0, 13)
    frictions = np.exp(middle + deviation["ball_race"] * nodes)
    logs = [
        math.log(hours(replace(scene_with_values(scene, {"ball_race": mu}), uncertainty=None)))
        for mu in frictions
    ]
    u = np.linspace(-4.0, 4.0, 2001)
    weights = norm.pdf(u) / norm.pdf(u).sum()
    wear = deviation["wear_coefficient"]
    means = CubicSpline(nodes, logs)(u) - correlation * wear * u
    rest = wear * math.sqrt(1.0 - correlation**2)

    def excess(log_life, probability):
        return float(weights @ norm.cdf((log_life - means) / rest)) - probability

    medians = [brentq(excess, -20.0, 20.0, args=(p,)) for p in (0.05, 0.5, 0.95)]
    return np.exp(np.array(medians) + norm.ppf(0.1) * deviation["wear_scatter"])


@pytest.mark.long
def test_the_calibrated_scene_keeps_the_correlation_with_friction(tmp_path):
    """Where friction decides a life, lives tell K_s/H and friction together alone.

    A sample of the calibrated scene has the L10 of its batches that a quadrature finds, and the
    lives of bearings that the posterior has, within 2.5 %; without the correlation they are more
    than 15 % off. The scene carries normal deviates. The posterior follows the
    life, whose slope with friction goes here from 0.1 to 1.9, so that the scene's L10 of a batch
    spans somewhat more than the posterior's (a factor of 1.66 instead of 1.54).
    """
    settings = ["friction.ball_race=0.06", "model.contact=paper"]
    plain = load_scene(scene_file("bearing218"), settings).to_dict()
    path = written(tmp_path, "life_h", "0.11", "0.13", "0.10", "0.12")
    calibration = calibration_by_tests(scene_from_dict(plain | {"uncertainty": SPREAD}), path)
    coefficient = calibration.scene.uncertainty["wear_coefficient"]
    assert 0.8 < coefficient.friction_correlation < 0.9
    alone = dict(calibration.scene.uncertainty) | {
        "wear_coefficient": replace(coefficient, friction_correlation=None)
    }
    plan, point = Sampling(samples=256), calibration.data.isel(stage=1)
    spans = []
    for scene in (calibration.scene, replace(calibration.scene, uncertainty=alone)):
        preloads = {("constant_force", OWN): scene.operation.preload_N}
        spread_of_lives = life_quantiles([scene], preloads, plan).squeeze()
        of_batch = spread_of_lives.sel(uncertain_inputs=BATCH_ONLY, probability=[0.05, 0.5, 0.95])
        within = spread_of_lives.life_quantile.sel(uncertain_inputs=SCATTER_ONLY)
        # bearings scatter by wear alone: in each batch in the same ratio
        L10 = float(within.sel(probability=0.1) / within.sel(probability=0.5))
        correlation = scene.uncertainty["wear_coefficient"].friction_correlation or 0.0
        exact = l10_of_batches(scene, correlation)
        assert (L10 * of_batch.life_quantile_low < exact).all()
        assert (L10 * of_batch.life_quantile_high > exact).all()
        of_all = spread_of_lives.sel(uncertain_inputs=ALL_INPUTS)
        tails = {"probability": [0.05, 0.1, 0.95]}
        off = np.abs(np.log(of_all.life_quantile.sel(tails) / point.life_quantile.sel(tails)))
        assert (off < 0.025).all() if scene is calibration.scene else (off > 0.15).all()
        spans.append(float(of_batch.life_quantile[-1] / of_batch.life_quantile[0]))
    posterior = float(point.batch_life_quantile[-1] / point.batch_life_quantile[0])
    assert posterior < spans[0] < 1.1 * posterior
    assert spans[1] > 1.9 * posterior


def test_tests_far_from_the_scene_are_a_conflict(tmp_path, capsys):
    """Lives a hundred times as long as expected: the sheets name it, and the scene carries it."""
    base, out = tmp_path / "mine.yaml", tmp_path / "calibrated.yaml"
    bearingwear.save(with_spread(), base)
    path = written(tmp_path, "life_h", "150", "180")
    assert main(["calibrate", str(base), str(path), "-o", str(out), "--json"]) == 0
    (conflict,) = json.loads(capsys.readouterr().out)["conflicts"]
    data = bearingwear.load(tmp_path / "calibrated.nc")
    deviations = data.attrs["wear_moved"]
    assert deviations < -2.0
    assert conflict.startswith("K_s/H ")
    assert numbers_in(conflict) == [pytest.approx(-deviations, rel=0.05)]
    assert main(["show", str(tmp_path / "calibrated.nc")]) == 0
    assert conflict in capsys.readouterr().out
    wear = load_scene(out).nominal("wear_coefficient") / load_scene(base).nominal(
        "wear_coefficient"
    )
    factor = load_scene(out).uncertainty["wear_coefficient"].factor
    carried = data["wear_over_hardness_carried"].values
    before = data["wear_over_hardness_interval"].sel(stage="before").values
    assert_allclose(carried[1] / carried[0], factor ** (2.0 * 1.644854), rtol=1e-4)
    assert_allclose(math.sqrt(np.prod(carried / before)), wear, rtol=1e-4)


@pytest.mark.parametrize(
    "lines, rows, unit",
    [
        # N m in place of N mm; the run-out is likely
        (["torque_Nmm,run_out_h", "1.7e-5,", ",3"], r"row 2, torque: 0.00\d+ [^;]*", "N mm"),
        # each is likely in the scene, but not the other one beside it
        (["life_h", "1", "40"], r"row 2, life: 0.0\d+ [^;]*; row 3, life: [\d.]+ [^;]*", None),
        (["life_h,bearings", "1200,1"], r"row 2, life: \d+ [^;]*", "h"),
    ],
)
def test_impossible_results_are_refused(tmp_path, capsys, lines, rows, unit):
    """The line names the rows, their ratio to what is expected, and a unit they may lack."""
    base, out = tmp_path / "mine.yaml", tmp_path / "calibrated.yaml"
    bearingwear.save(with_spread(), base)
    path = written(tmp_path, *lines)
    assert main(["calibrate", str(base), str(path), "-o", str(out)]) == 2
    output, errors = capsys.readouterr()
    *_, line = errors.strip().splitlines()
    assert output == "" and not out.exists()
    assert line.startswith(f"{path}: got ") and re.search(f": {rows}; ", line)
    assert (f"expected {unit})" in line) == (unit is not None)
