"""An ensemble of cage runs: draws, intervals, interruption, and the command."""

import numpy as np
import pytest
from support import ROOT, numbers_in, only_line

import bearingwear
from bearingwear.applications.cage import ensemble
from bearingwear.applications.cage.draws import ASSUMED_CLEARANCE, CLOSE, cage_draw, cage_spread
from bearingwear.applications.cage.ensemble import (
    Journal,
    cage_ensemble,
    resumed_ensemble,
    share_interval,
)
from bearingwear.applications.cage.motion import JAMS, WHIRLS
from bearingwear.applications.cage.plan import Ensemble
from bearingwear.applications.cage.run import CageStart, cage_run
from bearingwear.cli import main
from bearingwear.kernels.status import BEYOND_GROOVE, CAGE_JAMMED, NOT_CONVERGED
from bearingwear.solvers.dynamic.windows import wear_per_joule
from bearingwear.studies.dataset import write_dataset

S1 = ROOT / "config/scenes/gyro_s1.yaml"
NO_UNCERTAIN_VALUES = {"uncertainty": None, "cage_uncertainty": {}}
GRAVITY = 9.81  # [m/s2]


def run_with_random_work(scene, start, least_turns, most_turns):
    """Returns the results of a run in place of `cage_run`: a whirl with a random work.

    The work is uniform from 0.425 to 1.575 J: its mean is 1, its standard deviation a third.
    """
    row = dict.fromkeys(ensemble.MEANS, 1.0)
    work = 1.0 + (start.whirl - 0.5) * 1.15
    return row | {"status": 0, "motion": WHIRLS, "work": work, "centre": [0.0, 0.0]}


@pytest.fixture
def without_solving(monkeypatch):
    """Replaces the solution of each run by `run_with_random_work`."""
    monkeypatch.setattr(ensemble, "cage_run", run_with_random_work)


def test_assumed_scatter_of_a_cage_is_stated(scene):
    spread, sentence = cage_spread(scene("gyro_s1"))
    factors = spread["cage"].factor, 100.0 * ASSUMED_CLEARANCE, spread["wear_coefficient"].factor
    assert numbers_in(sentence) == list(factors)


def test_draws_depend_on_seed_and_number_alone(scene):
    gyro = scene("gyro_s1")
    spread, _ = cage_spread(gyro)
    draw, repeated, next_draw = (cage_draw(gyro, spread, Ensemble(seed=3), k) for k in (7, 7, 8))
    assert draw == repeated and draw.values != next_draw.values


def test_the_scene_of_a_draw_has_the_drawn_values(scene):
    """Those of bearing and cage, but not K_s of the cage, which scales the wear afterwards."""
    gyro = scene("gyro_s1")
    draw = cage_draw(gyro, cage_spread(gyro)[0], Ensemble(), 0)
    assert "wear_coefficient" not in draw.values
    assert draw.scene.operation.preload_N == draw.values["preload_N"]
    assert draw.scene.friction.cage == draw.values["cage"]
    assert draw.scene.cage.guide_clearance_mm == draw.values["guide_clearance_mm"]


def test_cages_start_anywhere_in_their_clearance(scene):
    starts = [cage_draw(scene("gyro_s1"), {}, Ensemble(), k).start for k in range(200)]
    offsets = np.array([start.offset for start in starts])
    assert offsets.max() < CLOSE
    # evenly over a disc: the mean square is half of the largest, of 200 draws to 0.04 (one sigma)
    assert np.mean(offsets**2) == pytest.approx(0.5 * CLOSE**2, rel=0.1)


def test_drawn_values_follow_their_distributions(scene):
    inputs = {
        "cage_uncertainty.cage": {"distribution": "uniform", "low": 0.02, "high": 0.06},
        "cage_uncertainty.gravity_angle_deg": {
            "distribution": "uniform", "low": 30.0, "high": 60.0,
        },
        "operation.gravity_m_s2": [0.0, 0.0, -GRAVITY],
    }  # fmt: skip
    gyro = scene("gyro_s1", inputs)
    spread, sentence = cage_spread(gyro)
    assert not sentence
    draws = [cage_draw(gyro, spread, Ensemble(), k).scene for k in range(150)]
    mu = np.array([draw.friction.cage for draw in draws])
    assert mu.min() > 0.02 and mu.max() < 0.06
    # the mean of 150 uniform values has a standard deviation of 0.04 / sqrt(12 150) = 0.001
    assert mu.mean() == pytest.approx(0.04, abs=0.002)
    gravity = np.array([draw.operation.gravity_m_s2 for draw in draws])
    assert np.linalg.norm(gravity, axis=1) == pytest.approx(GRAVITY)
    angle = np.degrees(np.arccos(gravity[:, 0] / GRAVITY))
    assert angle.min() > 30.0 and angle.max() < 60.0
    # directions about the shaft are even, so that their mean nearly vanishes
    assert abs(gravity[:, 1:].mean()) < 0.1 * GRAVITY


def test_wear_opens_both_clearances_of_a_drawn_cage(scene):
    """A diametral clearance grows by twice the depth of wear."""
    gyro = scene("gyro_s1", NO_UNCERTAIN_VALUES)
    worn = cage_draw(gyro, {}, Ensemble(worn_um=(1.0, 2.0)), 0).scene.cage
    assert worn.pocket_clearance_mm == pytest.approx(gyro.cage.pocket_clearance_mm + 2e-3)
    assert worn.guide_clearance_mm == pytest.approx(gyro.cage.guide_clearance_mm + 4e-3)


def test_the_90_percent_interval_contains_the_mean_in_90_percent_of_ensembles(scene):
    """Of 200 ensembles of 25 runs with a known mean work, to 2.5 standard deviations."""
    gyro = scene("gyro_s1", NO_UNCERTAIN_VALUES)
    count = 0
    for seed in range(200):
        starts = [cage_draw(gyro, {}, Ensemble(seed=seed), k).start for k in range(25)]
        work = np.array([run_with_random_work(gyro, start, 0, 0)["work"] for start in starts])
        count += abs(work.mean() - 1.0) <= ensemble.half_interval(work)
    assert abs(count - 180) <= 2.5 * np.sqrt(200 * 0.9 * 0.1)


@pytest.mark.usefixtures("without_solving")
def test_an_ensemble_stops_once_its_interval_is_narrow_enough(scene):
    gyro = scene("gyro_s1", NO_UNCERTAIN_VALUES)
    counts = []
    for within in (0.15, 0.05):
        dataset = cage_ensemble(gyro, Ensemble(within=within, runs=120))
        low, high = dataset["mean_work_interval"].values[0]
        assert dataset.attrs["met"] == 1
        assert high - low <= 2.0 * within * float(dataset["mean_work"][0])
        counts.append(dataset.sizes["run"])
    assert counts[0] < counts[1] < 120


@pytest.mark.usefixtures("without_solving")
def test_an_ensemble_that_misses_its_interval_has_all_runs_and_says_so(scene):
    gyro = scene("gyro_s1", NO_UNCERTAIN_VALUES)
    dataset = cage_ensemble(gyro, Ensemble(within=0.01, runs=30))
    assert dataset.sizes["run"] == 30 and dataset.attrs["met"] == 0


@pytest.mark.parametrize(("count", "ends"), [(3, (0.0616, 0.3218)), (0, (0.0, 0.1192))])
def test_share_intervals_are_wilsons(count, ends):
    """Of 20 runs, at 90 %, to the four digits of the expected numbers."""
    assert share_interval(count, 20) == pytest.approx(ends, abs=1e-4)


def test_jammed_and_unsolved_runs_are_counted(scene, monkeypatch):
    """A jammed run has a motion, but no work; one that was not solved has neither."""

    def jammed_or_unsolved(scene, start, least_turns, most_turns):
        if start.whirl < 0.5:
            return {"status": CAGE_JAMMED, "motion": JAMS}
        return {"status": NOT_CONVERGED}

    monkeypatch.setattr(ensemble, "cage_run", jammed_or_unsolved)
    dataset = cage_ensemble(scene("gyro_s1", NO_UNCERTAIN_VALUES), Ensemble(runs=20))
    jams = int((dataset["status"] == CAGE_JAMMED).sum())
    assert 0 < jams < 20 and float(dataset["share"][JAMS]) == 1.0
    assert dataset["mean_work"].isnull().all() and dataset.attrs["met"] == 0


@pytest.mark.usefixtures("without_solving")
def test_draws_with_impossible_dimensions_have_the_status_beyond_groove(scene):
    too_large = {"distribution": "normal", "mean": 2.2, "standard_deviation": 0.01}
    gyro = scene(
        "gyro_s1", {"uncertainty": {"ball_diameter_mm": too_large}, "cage_uncertainty": {}}
    )
    assert (cage_ensemble(gyro, Ensemble(runs=20))["status"] == BEYOND_GROOVE).all()


# by the command, and with solved runs


def ensemble_file(path, *options):
    """Writes a file of twenty runs by the command, and returns its path."""
    keys = ["friction.cage=0.1", "model.dynamic_tolerance=1e-3", "uncertainty=null"]
    assert main(["cage", str(S1), "--set", *keys, "--runs", "20", *options, "-o", str(path)]) == 0
    return path


@pytest.mark.usefixtures("without_solving")
def test_an_ensemble_is_shown_and_plotted(tmp_path, capsys):
    path = ensemble_file(tmp_path / "cage.nc", "--quiet")
    assert main(["show", str(path)]) == 0
    text = capsys.readouterr().out
    title, *_ = text.splitlines()
    assert title.startswith("gyro_s1: ") and "20 runs" in title and "whirls" in title
    assert "step tolerance 0.001" in text  # above the default one, which is stated
    assert main(["plot", str(path), "-o", str(path.with_suffix(".svg"))]) == 0


@pytest.mark.long  # the next test solves one run; those above need no solved run
def test_most_cages_whirl_at_a_friction_of_a_tenth(tmp_path):
    """They whirl at 0.6 to 0.8 of the speed of the shaft; the limits leave a tenth beside that."""
    dataset = bearingwear.load(ensemble_file(tmp_path / "cage.nc", "--within", "0.5"))
    assert (dataset["status"] == "ok").all()
    assert float(dataset["share"].sel(of_motion="whirls")) > 0.6
    assert 0.55 < float(dataset["mean_whirl_ratio"].sel(group="whirls")) < 0.85
    assert float(abs(dataset["energy_account_error"]).max()) <= 1e-3


def test_a_cage_run_moves_as_in_the_dynamic_solver(scene):
    """`solve` gives the same work and torque for the same start.

    Both average the last 20 of 80 turns. The tolerance is half of the interval's half-width that an
    ensemble aims at.
    """
    changes = {
        "friction.cage": 0.1,
        "model.cage_results": True,
        "model.simulated_turns": 80,
        "model.evaluated_turns": 20,
        "model.strips": 10,
    }
    gyro = scene("gyro_s1", NO_UNCERTAIN_VALUES | changes)
    with pytest.warns(UserWarning, match="gravity is not specified"):
        solved = bearingwear.solve(gyro, fidelity="dynamic")
    row = cage_run(gyro, CageStart(), 80, 80)
    seconds_per_turn = 60.0 / gyro.operation.fastest_rpm
    wear_per_turn = wear_per_joule(gyro, gyro.cage.material) * row["pocket_work"]  # [m3]
    expected_wear = float(solved["cage_wear_rate"]) * seconds_per_turn
    assert wear_per_turn == pytest.approx(expected_wear, rel=0.05)
    assert row["shaft_torque"] == pytest.approx(float(solved["shaft_torque"]), rel=0.05)


PLAN_OF_20 = Ensemble(runs=20, within=1e-3)


@pytest.fixture
def complete_file(scene, tmp_path, without_solving):
    """Returns the file of an ensemble of 20 runs that was not interrupted."""
    path = tmp_path / "complete.nc"
    with resumed_ensemble(path, scene("gyro_s1", NO_UNCERTAIN_VALUES), PLAN_OF_20) as dataset:
        write_dataset(dataset, path)
    return path


def test_an_ensemble_interrupted_in_a_run_continues_to_the_same_bytes(
    complete_file, scene, tmp_path, monkeypatch
):
    """It is interrupted in run 7, of which a part of the line is in the journal."""
    gyro, path = scene("gyro_s1", NO_UNCERTAIN_VALUES), tmp_path / "interrupted.nc"
    solve_run, runs = ensemble._run_row, []

    def interrupted_at_first(job):
        runs.append(job.run)
        if len(runs) == 8:
            raise KeyboardInterrupt
        return solve_run(job)

    monkeypatch.setattr(ensemble, "_run_row", interrupted_at_first)
    with pytest.raises(KeyboardInterrupt), resumed_ensemble(path, gyro, PLAN_OF_20):
        pass
    journal = Journal(path, bearingwear.load(complete_file).attrs)
    with journal.path.open("a", encoding="utf-8") as file:
        file.write('[7, {"status": 0, "wor')
    with resumed_ensemble(path, gyro, PLAN_OF_20) as dataset:
        write_dataset(dataset, path)
    assert runs == [*range(8), *range(7, 20)]
    assert path.read_bytes() == complete_file.read_bytes() and not journal.path.exists()


def test_more_runs_are_added_to_those_of_a_file(complete_file, scene):
    plan = Ensemble(runs=22, within=1e-3)
    earlier = bearingwear.load(complete_file)
    gyro = scene("gyro_s1", NO_UNCERTAIN_VALUES)
    with resumed_ensemble(complete_file, gyro, plan) as dataset:
        assert dataset.sizes["run"] == 22
        np.testing.assert_array_equal(dataset["work"][:20], earlier["work"])


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        (["--runs", "5"], "runs: got 5, expected a whole number >= 20"),
        (["--turns", "35"], "most_turns: got 35, expected a multiple of 10"),
        (["--set", "cage=null"], "cage: got nothing, expected a cage"),
        (["--life"], "cage.film: got neither a film nor a limit"),
    ],
)
def test_wrong_options_of_cage_are_refused_in_one_line(tmp_path, capsys, options, problem):
    assert main(["cage", str(S1), *options, "-o", str(tmp_path / "cage.nc")]) == 2
    assert problem in only_line(capsys)
