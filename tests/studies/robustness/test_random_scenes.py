"""Scenes far beyond the study: verified or refused with a physical reason, never wrong."""

import json
import math
import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import ROOT, only_line, scene_file

from bearingwear.cli import main
from bearingwear.kernels import status as code
from bearingwear.lives.life import life
from bearingwear.results.netcdf import load
from bearingwear.scene.checking.check import read_record
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.scene.scene import SceneError
from bearingwear.studies.dataset import write_dataset
from workflow.studies.robustness.draw import drawn_scene, with_values
from workflow.studies.robustness.lives import life_violations
from workflow.studies.robustness.maps import crossing
from workflow.studies.robustness.plan import (
    WITHOUT_REASON,
    KeyAxis,
    RobustnessPlan,
    drawn,
    draws,
)
from workflow.studies.robustness.run import end_of, solved_values, violations

FILE = ROOT / "config" / "robustness.yaml"
PLAN = read_record(RobustnessPlan, FILE)
BASE = load_scene(ROOT / PLAN.scene_file).to_dict()
FEW = {"model.strips": 20}  # points: what is tried here does not hang on them


def of_class(name, seed):
    """A scene of a class."""
    chance = random.Random(seed)
    drawn = {key: draw.value(chance) for key, draw in draws(PLAN.draw(name)).items()} | FEW
    try:
        return drawn_scene(BASE, drawn)
    except SceneError:
        return None


@pytest.mark.parametrize(
    "name, unexplained",
    [
        ("steady_stress", 0.01),
        ("race_control_stress", 0.02),
        pytest.param("steady_warm", 0.01, marks=pytest.mark.long),
        pytest.param("race_control_warm", 0.02, marks=pytest.mark.long),
        ("steady_pair", 0.01),
        pytest.param("race_control_pair", 0.02, marks=pytest.mark.long),
        pytest.param("steady_hertz", 0.01, marks=pytest.mark.long),
    ],
)
def test_random_scenes_are_never_wrong(name, unexplained):
    """No number is wrong; ends without a physical reason stay rare."""
    without = solved = 0

    @settings(max_examples=40, deadline=None, derandomize=True, database=None)
    @given(seed=st.integers(0, 2**32))
    def one(seed):
        nonlocal without, solved
        scene = of_class(name, seed)
        if scene is None:
            return
        fidelity = PLAN.scene_classes[name].fidelity
        values = solved_values(scene, fidelity)
        solved += 1
        if values["status"] in WITHOUT_REASON:
            without += 1
        else:
            assert violations(scene, fidelity, values) == []

    one()
    assert solved > 26
    assert without <= max(1.0, unexplained * solved)


def test_random_lives_with_worn_grooves_are_never_wrong():
    """Each ends at its criterion, with what it says balanced, or says why it does not."""
    draw = draws(PLAN.draw("worn_life"))
    ends = [end_of(BASE, values, "worn_life") for values in drawn(draw, 7, 10)]
    assert [end["violations"] for end in ends] == [""] * 10
    assert sum(end["status"] == code.OK for end in ends) >= 9


def test_what_is_wrong_with_a_life_is_said():
    draw = draws(PLAN.draw("worn_life"))
    (values,) = drawn(draw, 1, 1)
    scene = drawn_scene(BASE, values)
    made = life(scene).values
    assert life_violations(scene, made) == []
    for wrong in (
        {"loss_at_end": 2.0 * made["loss_at_end"]},
        {"history_qv": 1.2 * made["history_qv"]},
        {"history_deepest_groove": made["history_deepest_groove"][::-1]},
        {"history_maximum_pressure": math.nan * made["history_maximum_pressure"]},
        {"status": code.UNVERIFIED},
    ):
        assert len(life_violations(scene, made | wrong)) > 0


@settings(max_examples=6, deadline=None, derandomize=True, database=None)
@given(seed=st.integers(0, 2**32))
def test_random_runs_in_time_end(seed):
    """They keep their account of energy or stop with a status."""
    scene = of_class("dynamic_stress", seed)
    if scene is not None and scene.bearing.ball_count <= 12:
        values = solved_values(scene, "dynamic")
        if values["status"] == code.OK:
            assert violations(scene, "dynamic", values) == []


def test_a_wrong_number_is_seen():
    scene = load_scene(scene_file("gyro_s1"))
    values = solved_values(scene, "steady")
    assert violations(scene, "steady", values) == []
    spoilt = values | {"residual_preload": 1.001 * values["residual_preload"]}
    assert violations(scene, "steady", spoilt)
    assert violations(scene, "steady", values | {"total_qv": np.nan}) == ["total_qv is not finite"]
    assert violations(scene, "steady", values | {"power_balance_error": 1e-4})


def test_a_spring_beside_a_large_centrifugal_force():
    """The race's Newton stopped at a step that was small for the grooves, not for the spring."""
    data = with_values(
        BASE,
        {
            "operation.preload_N": 0.1,
            "operation.shaft_speed_rpm": 2000.0,
            "bearing.ball_diameter_mm": 70.0,
            "bearing.pitch_diameter_mm": 350.0,
        },
    )
    data["cage"] = data["wear"]["end_of_life"] = None
    values = solved_values(scene_from_dict(data), "race_control")
    if values["status"] == code.OK:
        assert values["residual_preload"] == pytest.approx(0.1, rel=1e-9)


def test_crossing_is_found_and_bisected():
    axis = KeyAxis(key="k", log=(1e-3, 1e3), points=13)
    found = [np.log(y / 7.0) for y in axis.values]
    assert crossing(axis, found, lambda y: np.log(y / 7.0)) == pytest.approx(7.0, rel=1e-4)
    assert np.isnan(crossing(axis, [1.0] * 13, lambda y: 1.0))


STEPS = {
    "scene_classes": {
        "run": "run.random_scenes",
        "fidelity": "steady",
        "count": 3,
        "draw": {"friction.ball_race": {"log": [0.01, 1]}},
    },
    "maps": {
        "run": "maps.state_map",
        "title": "t",
        "changes": {},
        "limits": {"gyroscopic_slip": 0.3},
        "x": {"key": "operation.shaft_speed_rpm", "log": [1000, 30000], "points": 2},
        "y": {"key": "operation.preload_N", "log": [1, 50000], "points": 3},
    },
    "branches": {
        "run": "branches.branch",
        "title": "t",
        "changes": {},
        "along": {"key": "friction.ball_race", "log": [0.01, 0.1], "points": 3},
    },
}


def step(run, *inputs, output, **settings):
    command = ["step", f"studies.robustness.{run}", *inputs, "-o", str(output)]
    return main([*command, "--settings", json.dumps(settings)])


@pytest.mark.parametrize("kind", STEPS)
def test_files_figures_and_table(kind, tmp_path):
    """A few points, from the step to the picture."""
    solved, table = tmp_path / "few.nc", tmp_path / "few.md"
    scene, settings = f"scene={scene_file('gyro_s1')}", STEPS[kind] | {"name": "few"}
    run = settings.pop("run")
    assert step(run, scene, output=solved, **settings) == 0
    again = tmp_path / "again.nc"
    assert step(run, scene, output=again, **settings) == 0
    assert solved.read_bytes() == again.read_bytes()
    picture = tmp_path / "few.svg"
    for figure, of in (("map_figure", "maps"), ("branches_figure", "branches")):
        status = step(f"figures.{figure}", f"solved={solved}", output=picture)
        assert status == (0 if of == kind else 2)
    assert picture.exists() == (kind != "scene_classes")
    counts = tmp_path / "counts.nc"
    status = step("gather.counted_ends", f"paths+={solved}", output=counts)
    if kind == "branches":
        assert status == 2
        return
    assert status == 0
    found = load(counts)
    assert found["violations"].item() == 0
    assert found["trials"].item() == {"scene_classes": 3, "maps": 6}[kind]
    assert (found["verified"] + found["refused"] + found["unexplained"] == found["trials"]).all()
    assert step("tables.ends_table", f"counts={counts}", output=table) == 0
    assert "| 0 |" in table.read_text()
    assert step("tables.wrong_answers", f"counts={counts}", output=tmp_path / "verdict.txt") == 0


def test_a_wrong_answer_fails_after_the_table_is_written(tmp_path, capsys):
    solved, counts = tmp_path / "few.nc", tmp_path / "counts.nc"
    settings = {"name": "few", "count": 2, "seed": 3}
    plan = f"plan={FILE}"
    assert step("run.fuzz", plan, output=solved, **settings | {"name": "steady_stress"}) == 0
    found = load(solved)
    found["violations"] = ("trial", np.array(["", "friction heat exceeds mu QV"], dtype=object))
    found["status"][:] = code.OK
    write_dataset(found, solved)
    assert step("gather.counted_ends", f"paths+={solved}", output=counts) == 0
    assert step("tables.ends_table", f"counts={counts}", output=tmp_path / "table.md") == 0
    assert (tmp_path / "table.md").read_text().rstrip().endswith("| 0 | 1 |")
    capsys.readouterr()
    verdict = tmp_path / "verdict.txt"
    assert step("tables.wrong_answers", f"counts={counts}", output=verdict) == 3
    assert not verdict.exists()
    assert "incorrect results: 1 (first: friction heat exceeds mu QV)" in capsys.readouterr().err
    assert step("run.fuzz", plan, output=solved, **settings) == 2
    assert "scene_classes: got few, expected steady" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("log: [10,", "log: [0,", "shaft_speed_rpm.log: got [0.0, 500000.0], expected two incr"),
        ("stress_GPa:", "stress_MPa:", "steady_stress.draw.stress_MPa: got stress_MPa, expected"),
        ("[gyroscopic_slip]", "[slip]", "limits[0]: got 'slip', expected contact, gyroscopic_sl"),
    ],
)
def test_bad_plan_is_one_line(old, new, said, tmp_path, capsys):
    plan = tmp_path / "plan.yaml"
    text = FILE.read_text()
    assert old in text
    plan.write_text(text.replace(old, new, 1))
    settings = {"name": "steady", "count": 1, "seed": 1}
    assert step("run.fuzz", f"plan={plan}", output="x.nc", **settings) == 2
    assert said in only_line(capsys)
