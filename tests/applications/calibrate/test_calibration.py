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


DEVIATE_95 = 1.644854  # of the normal distribution at 95 %


def scene_with_spread(**distributions):
    """Returns the scene gyro_s1 with the distributions `SPREAD`, some of them replaced."""
    plain = load_scene(scene_file("gyro_s1")).to_dict()
    return scene_from_dict(plain | {"uncertainty": SPREAD | distributions})


def csv_file(folder, *lines):
    """Writes a CSV file of tests, and returns its path."""
    path = folder / "tests.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def life_hours(scene):
    """Returns the life of a scene [h]."""
    return life(scene).values["life"] * HOURS_PER_SECOND


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
    path = csv_file(tmp_path, "operation.preload_N,life_h,loss_um,after_h", line)
    with pytest.raises(CaseFileError) as error:
        bearing_tests(path, scene_with_spread())
    assert str(error.value).startswith(f"{path}: {problem}") and "\n" not in str(error.value)


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
    with pytest.raises(CaseFileError) as error:
        bearing_tests(csv_file(tmp_path, *lines), scene_with_spread())
    assert problem in str(error.value) and "\n" not in str(error.value)


def test_numbers_may_have_decimal_commas_if_semicolons_separate_columns(tmp_path):
    """A European Excel writes such CSV, with a byte-order mark at its start."""
    scene = scene_with_spread()
    english = ["operation.preload_N,life_h", "7.25,4.5", ",1.5e2"]
    european = ["\ufeffoperation.preload_N;life_h", "7,25;4,5", ";1,5e2"]
    tests = bearing_tests(csv_file(tmp_path, *european), scene)
    assert tests == bearing_tests(csv_file(tmp_path, *english), scene)
    assert [test.value for test in tests] == [4.5, 150.0]


@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_columns_may_be_separated_by_semicolons_or_tabs(tmp_path, separator):
    path = csv_file(tmp_path, f"operation.preload_N{separator}life_h", f"7{separator}5")
    (test,) = bearing_tests(path, scene_with_spread())
    assert test.scene.operation.preload_N == 7.0 and test.value == 5.0


def test_a_missing_file_of_tests_is_refused(tmp_path):
    with pytest.raises(SceneError, match="cannot be read .*expected a CSV file"):
        bearing_tests(tmp_path / "none.csv", scene_with_spread())


@pytest.mark.parametrize(
    "name, problem",
    [
        ("wear_coefficient", "uncertainty.wear_coefficient: got no value that tests could"),
        ("wear_scatter", "uncertainty: got no value that varies"),
        ("ball_race", "row 2: torque_Nmm: got a torque, expected uncertainty.ball_race in the sc"),
    ],
)
def test_a_scene_without_a_distribution_that_tests_need_is_refused(tmp_path, name, problem):
    plain = scene_with_spread().to_dict()
    del plain["uncertainty"][name]
    path = csv_file(tmp_path, "torque_Nmm", "0.1")
    with pytest.raises((SceneError, CaseFileError), match=problem):
        calibration_by_tests(scene_from_dict(plain), path)


@pytest.mark.long
@pytest.mark.parametrize("kind", ["life", "loss", "preload"])
def test_friction_and_wear_that_made_exact_tests_are_recovered(tmp_path, kind):
    """The tested batch has 0.4 times the K_s and mu 0.095; its bearings hardly scatter."""
    wear_ratio, mu = 0.4, 0.095
    scene = scene_with_spread(wear_scatter={"distribution": "lognormal", "factor": 1.001})
    batch = scene_with_values(scene, {"ball_race": mu})
    header = (
        "operation.preload_method,life_h,loss_um,preload_left_N,after_h,torque_Nmm,error_percent"
    )
    torque = 1e3 * float(solve(batch).values["shaft_torque"])
    if kind == "life":
        row = f",{life_hours(batch) / wear_ratio},,,,,0.1"
    elif kind == "loss":
        ended = batch.with_({"wear.end_of_life": {"ball_diameter_loss_um": 0.3}})
        row = f",,0.3,,{life_hours(ended) / wear_ratio},,0.1"
    else:
        fixed = batch.with_({"operation.preload_method": "fixed_position"})
        ended = fixed.with_({"wear.end_of_life": {"preload_fraction": 5.0 / 7.0}})
        row = f"fixed_position,,,5,{life_hours(ended) / wear_ratio},,0.1"
    path = csv_file(tmp_path, header, row, f",,,,,{torque},0.1")
    calibration = calibration_by_tests(scene, path)
    # 0.1 % of error in each test, and the interpolation over friction
    assert_allclose(calibration.scene.friction.ball_race, mu, rtol=2e-3)
    ratio = calibration.scene.nominal("wear_coefficient") / scene.nominal("wear_coefficient")
    assert_allclose(ratio, wear_ratio, rtol=1e-2)
    assert float(calibration.data["interpolation_error"]) < 5e-3


@pytest.mark.long  # of a model in closed form: test_posterior.py
def test_after_two_lives_l10_is_as_uncertain_as_their_mean(tmp_path):
    """The lives are of two bearings of a random batch."""
    scene = scene_with_spread(preload_N={"distribution": "normal", "standard_deviation": 0.35})
    random, wear_ratio = np.random.default_rng(3), 1.7
    batch = replace(scene_with_values(scene, {"ball_race": 0.074}), uncertainty=None)
    lives = []
    for _ in range(2):
        bearing = batch.with_({"operation.preload_N": 7.0 + 0.35 * random.normal()})
        lives.append(life_hours(bearing) / (wear_ratio * 1.3 ** random.normal()))
    calibration = calibration_by_tests(scene, csv_file(tmp_path, "life_h", *map(str, lives)))
    before, after = calibration.data["batch_life_quantile"].values
    scatter = float(calibration.data["scatter"])
    assert math.log(1.3) < scatter < 0.32  # K_s scatters by 1.3; the preload adds some
    # a factor of 3 in K_s alone spans 3^(2 x 1.645) = 37 from 5 to 95 %
    assert before[-1] / before[0] > 35.0
    # log L10 is normal about the mean of both lives; friction acts on both alike
    theory = math.exp(2.0 * DEVIATE_95 * scatter / math.sqrt(2.0))
    assert_allclose(after[-1] / after[0], theory, rtol=0.05)


@pytest.fixture(scope="module")
def calibrated_folder(tmp_path_factory):
    """Returns a folder with a scene, its tests.csv, and calibrated.yaml and .nc by the command."""
    folder = tmp_path_factory.mktemp("calibrated")
    bearingwear.save(scene_with_spread(), folder / "mine.yaml")
    header = "torque_Nmm,life_h,run_out_h,bearings"
    csv_file(folder, header, "0.017,,,", ",5,,", ",,4,2")
    calibrate(folder, "mine.yaml", "calibrated.yaml")
    return folder


def calibrate(folder, scene, output, status=0):
    """Calibrates a scene with tests.csv of its folder by the command, which ends with a status."""
    words = [folder / scene, folder / "tests.csv", "-o", folder / output]
    assert main(["calibrate", *map(str, words)]) == status


def test_the_calibrated_scene_has_medians_and_factors_and_names_its_tests(calibrated_folder):
    tests = (calibrated_folder / "tests.csv").read_bytes()
    scene = load_scene(calibrated_folder / "calibrated.yaml")
    assert scene.calibrated.sha256 == hashlib.sha256(tests).hexdigest()
    assert scene.calibrated.rows == 3
    # three decimals, as the axis of friction of a study
    assert scene.friction.ball_race == round(scene.friction.ball_race, 3)
    assert scene.uncertainty["wear_coefficient"].factor < 1.5  # 3 before the tests
    assert scene.uncertainty["wear_scatter"].factor == 1.3


def test_tests_are_not_counted_twice(calibrated_folder, capsys):
    calibrate(calibrated_folder, "calibrated.yaml", "again.yaml", status=2)
    assert "got the tests used to calibrate the scene" in capsys.readouterr().err


def test_uncertainty_of_the_calibrated_scene_is_that_of_the_posterior(calibrated_folder):
    """A sample of its lognormal distributions has the quantiles of life after the tests."""
    spread = calibrated_folder / "uncertainty.nc"
    scene = str(calibrated_folder / "calibrated.yaml")
    assert main(["uncertainty", scene, "-o", str(spread), "--quiet"]) == 0
    sampled = bearingwear.load(spread)["life_quantile"].isel(
        preload_method=0, preload_choice=0, uncertain_inputs=0
    )
    data = bearingwear.load(calibrated_folder / "calibrated.nc")
    for probability in (0.1, 0.5):
        quantile = float(data["life_quantile"].sel(stage="after", probability=probability))
        # scatter of the sample
        assert_allclose(float(sampled.sel(probability=probability)), quantile, rtol=0.06)


def test_the_same_tests_give_the_same_bytes(calibrated_folder):
    calibrate(calibrated_folder, "mine.yaml", "repeated.yaml")
    for suffix in (".yaml", ".nc"):
        first, second = (
            (calibrated_folder / name).with_suffix(suffix).read_bytes()
            for name in ("calibrated.yaml", "repeated.yaml")
        )
        assert first == second, suffix


def test_a_calibration_is_plotted(calibrated_folder):
    figure = bearingwear.plot(bearingwear.load(calibrated_folder / "calibrated.nc"))
    assert figure.axes and figure.get_suptitle()


def l10_of_batches(scene, correlation):
    """Returns L10 of a batch [h] at probabilities 0.05, 0.5 and 0.95, by quadrature over friction.

    The logarithm of a batch's median life is that of a life at its friction less that of its K_s/H
    relative to the scene's. Lives are solved at 13 values of friction; for a known friction, K_s/H
    is lognormal.

    correlation: of ln K_s/H with ln mu.
    """
    spread = scene.uncertainty
    deviation = {name: math.log(value.factor) for name, value in spread.items()}
    log_median = math.log(scene.friction.ball_race)
    nodes = np.linspace(-4.0, 4.0, 13)
    frictions = np.exp(log_median + deviation["ball_race"] * nodes)
    log_lives = [
        math.log(life_hours(replace(scene_with_values(scene, {"ball_race": mu}), uncertainty=None)))
        for mu in frictions
    ]
    deviates = np.linspace(-4.0, 4.0, 2001)  # of ln mu, standard normal
    weights = norm.pdf(deviates) / norm.pdf(deviates).sum()
    wear = deviation["wear_coefficient"]
    means = CubicSpline(nodes, log_lives)(deviates) - correlation * wear * deviates
    remaining_deviation = wear * math.sqrt(1.0 - correlation**2)

    def excess(log_life, probability):
        """Returns by how much the share of batches with a shorter median life is too large."""
        return float(weights @ norm.cdf((log_life - means) / remaining_deviation)) - probability

    medians = [brentq(excess, -20.0, 20.0, args=(p,)) for p in (0.05, 0.5, 0.95)]
    return np.exp(np.array(medians) + norm.ppf(0.1) * deviation["wear_scatter"])


@pytest.mark.long
def test_the_calibrated_scene_keeps_the_correlation_with_friction(tmp_path):
    """Where a life depends much on friction, lives determine K_s/H and friction only together.

    A sample of the calibrated scene has the L10 of its batches that a quadrature finds. It has the
    lives of bearings that the posterior has within 2.5 %; without the correlation they are more
    than 15 % off. The posterior follows the life, whose slope with friction goes here from 0.1 to
    1.9, while the scene has lognormal distributions. The scene's L10 of a batch therefore spans
    somewhat more than the posterior's (a factor of 1.66 instead of 1.54).
    """
    settings = ["friction.ball_race=0.06", "model.contact=paper"]
    plain = load_scene(scene_file("bearing218"), settings).to_dict()
    path = csv_file(tmp_path, "life_h", "0.11", "0.13", "0.10", "0.12")
    calibration = calibration_by_tests(scene_from_dict(plain | {"uncertainty": SPREAD}), path)
    coefficient = calibration.scene.uncertainty["wear_coefficient"]
    assert 0.8 < coefficient.friction_correlation < 0.9
    uncorrelated = replace(
        calibration.scene,
        uncertainty=dict(calibration.scene.uncertainty)
        | {"wear_coefficient": replace(coefficient, friction_correlation=None)},
    )
    after = calibration.data.isel(stage=1)
    spans, tail_errors = [], []
    for scene in (calibration.scene, uncorrelated):
        preloads = {("constant_force", OWN): scene.operation.preload_N}
        lives = life_quantiles([scene], preloads, Sampling(samples=256)).squeeze()
        batch = lives.sel(uncertain_inputs=BATCH_ONLY, probability=[0.05, 0.5, 0.95])
        in_batch = lives.life_quantile.sel(uncertain_inputs=SCATTER_ONLY)
        # the bearings of any batch scatter by wear alone, and so in the same ratio
        L10 = float(in_batch.sel(probability=0.1) / in_batch.sel(probability=0.5))
        correlation = scene.uncertainty["wear_coefficient"].friction_correlation or 0.0
        exact = l10_of_batches(scene, correlation)
        assert (L10 * batch.life_quantile_low < exact).all()
        assert (L10 * batch.life_quantile_high > exact).all()
        tails = {"probability": [0.05, 0.1, 0.95]}
        sampled_tails = lives.life_quantile.sel(uncertain_inputs=ALL_INPUTS, **tails)
        tail_errors.append(np.abs(np.log(sampled_tails / after.life_quantile.sel(tails))))
        spans.append(float(batch.life_quantile[-1] / batch.life_quantile[0]))
    assert (tail_errors[0] < 0.025).all() and (tail_errors[1] > 0.15).all()
    posterior_span = float(after.batch_life_quantile[-1] / after.batch_life_quantile[0])
    assert posterior_span < spans[0] < 1.1 * posterior_span
    assert spans[1] > 1.9 * posterior_span


def test_tests_far_from_the_scene_are_a_conflict(tmp_path, capsys):
    """Lives a hundred times as long as expected are more than two standard deviations away."""
    scene, output = tmp_path / "mine.yaml", tmp_path / "calibrated.yaml"
    bearingwear.save(scene_with_spread(), scene)
    path = csv_file(tmp_path, "life_h", "150", "180")
    assert main(["calibrate", str(scene), str(path), "-o", str(output), "--json"]) == 0
    (conflict,) = json.loads(capsys.readouterr().out)["conflicts"]
    shift = bearingwear.load(tmp_path / "calibrated.nc").attrs["wear_moved"]
    assert shift < -2.0
    assert conflict.startswith("K_s/H ")
    assert numbers_in(conflict) == [pytest.approx(-shift, rel=0.05)]  # it has two digits
    assert main(["show", str(tmp_path / "calibrated.nc")]) == 0
    assert conflict in capsys.readouterr().out


def test_the_stated_interval_of_wear_is_that_of_the_calibrated_scene(tmp_path):
    """The distribution is lognormal, its interval from 5 to 95 %; a scene file has five digits."""
    scene = scene_with_spread()
    calibration = calibration_by_tests(scene, csv_file(tmp_path, "life_h", "150", "180"))
    factor = calibration.scene.uncertainty["wear_coefficient"].factor
    carried = calibration.data["wear_over_hardness_carried"].values
    assert_allclose(carried[1] / carried[0], factor ** (2.0 * DEVIATE_95), rtol=1e-4)
    before = calibration.data["wear_over_hardness_interval"].isel(stage=0).values
    ratio = calibration.scene.nominal("wear_coefficient") / scene.nominal("wear_coefficient")
    assert_allclose(math.sqrt(np.prod(carried / before)), ratio, rtol=1e-4)


@pytest.mark.parametrize(
    "lines, rows, unit",
    [
        # N m in place of N mm; the run-out is likely
        (["torque_Nmm,run_out_h", "1.7e-5,", ",3"], r"row 2, torque: 0.00\d+ [^;]*", "N mm"),
        # each is likely in the scene, but not the other one beside it
        (["life_h", "1", "40"], r"row 2, life: 0.0\d+ [^;]*; row 3, life: [\d.]+ [^;]*", None),
        # minutes in place of hours would be 60 times the life; this is more
        (["life_h,bearings", "1200,1"], r"row 2, life: \d+ [^;]*", "h"),
    ],
)
def test_impossible_results_are_refused(tmp_path, capsys, lines, rows, unit):
    """The line names the rows, their ratio to the expected result, and a unit that may be wrong."""
    scene, calibrated = tmp_path / "mine.yaml", tmp_path / "calibrated.yaml"
    bearingwear.save(scene_with_spread(), scene)
    path = csv_file(tmp_path, *lines)
    assert main(["calibrate", str(scene), str(path), "-o", str(calibrated)]) == 2
    output, errors = capsys.readouterr()
    *_, line = errors.strip().splitlines()
    assert output == "" and not calibrated.exists()
    assert line.startswith(f"{path}: got ") and re.search(f": {rows}; ", line)
    if unit is None:
        assert "wrong unit" not in line
    else:
        assert f"suggests a wrong unit; expected {unit})" in line
