"""An ensemble of cages: what is drawn, intervals, going on, and the command."""

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
from bearingwear.kernels.status import BEYOND_GROOVE, CAGE_JAMMED
from bearingwear.studies.dataset import write_dataset

S1 = ROOT / "config/scenes/gyro_s1.yaml"
NOTHING = {"uncertainty": None, "cage_uncertainty": {}}


def noisy_run(scene, start, least, most):
    """A made-up run: its work scatters by a third of its mean, 1."""
    row = dict.fromkeys(ensemble.MEANS, 1.0)
    spread = 1.0 + (start.whirl - 0.5) * 1.15
    return row | {"status": 0, "motion": WHIRLS, "work": spread, "centre": [0.0, 0.0]}


def test_draws_depend_on_seed_and_number_alone(scene):
    s = scene("gyro_s1")
    spread, sentence = cage_spread(s)
    factors = spread["cage"].factor, 100.0 * ASSUMED_CLEARANCE, spread["wear_coefficient"].factor
    assert numbers_in(sentence) == list(factors)
    plan = Ensemble(seed=3)
    first, again, other = (cage_draw(s, spread, plan, k) for k in (7, 7, 8))
    assert first == again and first.values != other.values
    assert "wear_coefficient" not in first.values and "preload_N" in first.values
    assert first.scene.friction.cage == first.values["cage"]
    assert first.scene.cage.guide_clearance_mm == first.values["guide_clearance_mm"]
    starts = [cage_draw(s, {}, plan, k).start for k in range(200)]
    assert max(start.offset for start in starts) < CLOSE
    # evenly over the disc
    assert np.mean([item.offset**2 for item in starts]) == pytest.approx(0.5 * CLOSE**2, rel=0.1)


def test_drawn_values_follow_their_distributions(scene):
    inputs = {
        "cage_uncertainty.cage": {"distribution": "uniform", "low": 0.02, "high": 0.06},
        "cage_uncertainty.gravity_angle_deg": {
            "distribution": "uniform", "low": 30.0, "high": 60.0,
        },
        "operation.gravity_m_s2": [0.0, 0.0, -9.81],
    }  # fmt: skip
    s = scene("gyro_s1", inputs)
    spread, sentence = cage_spread(s)
    assert not sentence
    draws = [cage_draw(s, spread, Ensemble(worn_um=(1.0, 2.0)), k).scene for k in range(150)]
    mu = np.array([draw.friction.cage for draw in draws])
    assert mu.min() > 0.02 and mu.max() < 0.06
    assert mu.mean() == pytest.approx(0.04, abs=0.002)
    gravity = np.array([item.operation.gravity_m_s2 for item in draws])
    assert np.hypot(*gravity.T[1:]) ** 2 + gravity[:, 0] ** 2 == pytest.approx(9.81**2)
    angle = np.degrees(np.arccos(gravity[:, 0] / 9.81))
    assert angle.min() > 30.0 and angle.max() < 60.0
    assert abs(gravity[:, 1:].mean()) < 1.0  # in every direction about the shaft
    assert all(draw.cage.guide_clearance_mm == pytest.approx(0.204) for draw in draws)


def test_the_mean_lies_in_its_interval_as_often_as_it_says(scene, monkeypatch):
    """200 ensembles of made-up runs: 90 % of the intervals hold the true mean, to 2.5 sigma."""
    monkeypatch.setattr(ensemble, "cage_run", noisy_run)
    s, held = scene("gyro_s1", NOTHING), 0
    rows = [
        [{"work": noisy_run(s, cage_draw(s, {}, Ensemble(seed=seed), k).start, 0, 0)["work"]}
         for k in range(25)]
        for seed in range(200)
    ]  # fmt: skip
    for row in rows:
        values = ensemble.work_per_turn(row)
        held += abs(values.mean() - 1.0) <= ensemble.half_interval(values)
    assert abs(held - 180) <= 2.5 * np.sqrt(200 * 0.9 * 0.1)


def test_an_ensemble_stops_once_its_interval_is_narrow_enough(scene, monkeypatch):
    monkeypatch.setattr(ensemble, "cage_run", noisy_run)
    s = scene("gyro_s1", NOTHING)
    loose, tight = (cage_ensemble(s, Ensemble(within=w, runs=120)) for w in (0.15, 0.05))
    assert loose.sizes["run"] < tight.sizes["run"] < 120
    for result, within in ((loose, 0.15), (tight, 0.05)):
        low, high = result["mean_work_interval"].values[0]
        assert result.attrs["met"] == 1 and high - low <= 2.0 * within * float(
            result["mean_work"][0]
        )
    unmet = cage_ensemble(s, Ensemble(within=0.01, runs=30))
    assert unmet.sizes["run"] == 30 and unmet.attrs["met"] == 0


def test_share_intervals():
    """Wilson's interval at 90 %: 3 of 20, and none of 20."""
    assert share_interval(3, 20) == pytest.approx((0.0616, 0.3218), abs=1e-4)
    assert share_interval(0, 20) == pytest.approx((0.0, 0.1192), abs=1e-4)


def test_jammed_and_unsolved_runs_are_counted(scene, monkeypatch):
    def ends(scene, start, least, most):
        return {"status": CAGE_JAMMED, "motion": JAMS} if start.whirl < 0.5 else {"status": 5}

    monkeypatch.setattr(ensemble, "cage_run", ends)
    result = cage_ensemble(scene("gyro_s1", NOTHING), Ensemble(runs=20))
    jams = int((result["status"] == CAGE_JAMMED).sum())
    assert 0 < jams < 20 and float(result["share"][JAMS]) == 1.0
    assert result["mean_work"].isnull().all() and result.attrs["met"] == 0


def test_values_that_make_no_bearing_are_a_status(scene, monkeypatch):
    monkeypatch.setattr(ensemble, "cage_run", noisy_run)
    big = {"distribution": "normal", "mean": 2.2, "standard_deviation": 0.01}
    s = scene("gyro_s1", {"uncertainty": {"ball_diameter_mm": big}, "cage_uncertainty": {}})
    assert (cage_ensemble(s, Ensemble(runs=20))["status"] == BEYOND_GROOVE).all()


# real runs


def ensemble_file(path, *options):
    """File of twenty runs, by the command."""
    keys = ["friction.cage=0.1", "model.dynamic_tolerance=1e-3", "uncertainty=null"]
    assert main(["cage", str(S1), "--set", *keys, "--runs", "20", *options, "-o", str(path)]) == 0
    return path


def test_sheet_and_figure_of_an_ensemble(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(ensemble, "cage_run", noisy_run)
    path = ensemble_file(tmp_path / "cage.nc", "--quiet")
    assert main(["show", str(path)]) == 0
    text = capsys.readouterr().out
    title, *_ = text.splitlines()
    assert title.startswith("gyro_s1: ") and "20 runs" in title and "whirls" in title
    assert "step tolerance 0.001" in text  # one that is larger than the usual one is named
    assert main(["plot", str(path), "-o", str(path.with_suffix(".svg"))]) == 0


@pytest.mark.long  # of a real run the next test, of ensembles of made-up runs those above
def test_an_ensemble_of_real_runs(tmp_path):
    """A whirl at 0.6 to 0.8 of the shaft's rate is what most cages have at a friction of 0.1."""
    dataset = bearingwear.load(ensemble_file(tmp_path / "cage.nc", "--within", "0.5"))
    assert (dataset["status"] == "ok").all()
    assert float(dataset["share"].sel(of_motion="whirls")) > 0.6
    assert 0.55 < float(dataset["mean_whirl_ratio"].sel(group="whirls")) < 0.85
    assert float(abs(dataset["energy_account_error"]).max()) <= 1e-3


def test_a_cage_run_moves_as_in_the_dynamic_solver(scene):
    """The same cage by `solve`, from the start that a solve has: work of the last turns to 5 %."""
    changes = {"friction.cage": 0.1, "model.cage_results": True, "model.simulated_turns": 80}
    changes["model.strips"] = 10
    s = scene("gyro_s1", NOTHING | changes | {"model.evaluated_turns": 20})
    with pytest.warns(UserWarning, match="gravity is not specified"):
        solved = bearingwear.solve(s, fidelity="dynamic")
    row = cage_run(s, CageStart(), 80, 80)
    per_joule = 1e-4 / 0.3e9
    turn = 60.0 / 30000.0
    assert row["pocket_work"] == pytest.approx(
        float(solved["cage_wear_rate"]) / per_joule * turn, rel=0.05
    )
    assert row["shaft_torque"] == pytest.approx(float(solved["shaft_torque"]), rel=0.05)


def test_a_killed_ensemble_continues_to_the_same_bytes(scene, tmp_path, monkeypatch):
    """Killed at its eighth run, whose line is torn; more runs are added to those of a file."""
    monkeypatch.setattr(ensemble, "cage_run", noisy_run)
    s, plan = scene("gyro_s1", NOTHING), Ensemble(runs=20, within=1e-3)
    whole, torn, runs, done = tmp_path / "whole.nc", tmp_path / "torn.nc", [], ensemble._run_row
    with resumed_ensemble(whole, s, plan) as result:
        write_dataset(result, whole)

    def killed(job):
        runs.append(job.run)
        if runs == list(range(8)):
            raise KeyboardInterrupt
        return done(job)

    monkeypatch.setattr(ensemble, "_run_row", killed)
    with pytest.raises(KeyboardInterrupt), resumed_ensemble(torn, s, plan):
        pass
    journal = Journal(torn, result.attrs)
    with journal.path.open("a", encoding="utf-8") as file:
        file.write('[7, {"status": 0, "wor')
    with resumed_ensemble(torn, s, plan) as resumed:
        write_dataset(resumed, torn)
    assert runs[8:] == list(range(7, 20))
    assert torn.read_bytes() == whole.read_bytes() and not journal.path.exists()
    with resumed_ensemble(torn, s, Ensemble(runs=22, within=1e-3)) as more:
        assert more.sizes["run"] == 22 and (more["work"][:20] == result["work"]).all()


def test_wrong_options_of_cage_are_refused_in_one_line(tmp_path, capsys):
    out = ["-o", str(tmp_path / "cage.nc")]
    for options, expected in (
        (["--runs", "5"], "runs: got 5, expected a whole number >= 20"),
        (["--turns", "35"], "most_turns: got 35, expected a multiple of 10"),
        (["--set", "cage=null"], "cage: got nothing, expected a cage"),
        (["--life"], "cage.film: got neither a film nor a limit"),
    ):
        assert main(["cage", str(S1), *options, *out]) == 2
        assert expected in only_line(capsys)
