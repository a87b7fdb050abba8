"""Scenes far beyond the study: verified or refused with a physical reason, never wrong."""

import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import ROOT, scene_file

from bearingwear.cli import main
from bearingwear.io.config import load_scene, scene_from_dict
from bearingwear.io.netcdf import load
from bearingwear.kernels import status as code
from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.model.scene import SceneError
from bearingwear.study import stress
from bearingwear.study.extremes import ExtremesPlan, changed

PLAN = ExtremesPlan.from_file(ROOT / "config" / "extremes.yaml")
BASE = PLAN.base(ROOT / "config" / "scenes")
FEW = {"model.strips": 20}  # points: what is tried here does not hang on them


def of_family(name, seed):
    """A scene of a family and what its draw holds."""
    chance = random.Random(seed)
    drawn = {key: draw(chance) for key, draw in PLAN.families[name].draw.items()} | FEW
    try:
        return stress.scene_of(BASE, drawn)
    except SceneError:
        return None


@pytest.mark.parametrize("name, unnamed", [("steady_stress", 0.01), ("race_control_stress", 0.02)])
def test_random_scenes_are_never_wrong(name, unnamed):
    """No number is wrong; ends without a physical reason stay rare."""
    without = solved = 0

    @settings(max_examples=150, deadline=None, derandomize=True, database=None)
    @given(seed=st.integers(0, 2**32))
    def one(seed):
        nonlocal without, solved
        scene = of_family(name, seed)
        if scene is None:
            return
        tier = PLAN.families[name].tier
        values = stress.solved_values(scene, tier)
        solved += 1
        if values["status"] in stress.UNNAMED:
            without += 1
        else:
            assert stress.wrongs(scene, tier, values) == []

    one()
    assert solved > 100
    assert without <= max(1.0, unnamed * solved)


@settings(max_examples=6, deadline=None, derandomize=True, database=None)
@given(seed=st.integers(0, 2**32))
def test_random_runs_in_time_end(seed):
    """They keep their account of energy or stop with a status."""
    scene = of_family("dynamic_stress", seed)
    if scene is not None and scene.bearing.ball_count <= 12:
        values = stress.solved_values(scene, "dynamic")
        if values["status"] == code.OK:
            assert stress.wrongs(scene, "dynamic", values) == []


def test_a_wrong_number_is_seen():
    scene = load_scene(scene_file("gyro_s1"))
    values = stress.solved_values(scene, "steady")
    assert stress.wrongs(scene, "steady", values) == []
    spoilt = values | {"residual_preload": 1.001 * values["residual_preload"]}
    assert stress.wrongs(scene, "steady", spoilt)
    assert stress.wrongs(scene, "steady", values | {"total_qv": np.nan}) == [
        "total_qv is not finite"
    ]
    assert stress.wrongs(scene, "steady", values | {"power_balance_error": 1e-4})


# Each once ended without a reason, or with a wrong one; the name says what was the matter.
FOUND = {
    "newton past the edge of hertz": (
        {
            "operation.preload_method": "constant_force",
            "operation.shaft_speed_rpm": 172.0,
            "operation.outer_speed_rpm": -19710.0,
            "operation.preload_N": 207.0,
            "friction.ball_race": 2.36e-3,
            "friction.slip_regularisation_m_s": 3.6e-5,
            "bearing.ball_count": 15,
            "bearing.ball_diameter_mm": 31.343,
            "bearing.pitch_diameter_mm": 252.988,
            "bearing.contact_angle_deg": 40.797,
            "bearing.inner_groove_factor": 0.58839,
            "bearing.outer_groove_factor": 0.50507,
        },
        "steady",
        ("outside_hertz_range",),
    ),
    "rounding taken for an error": (
        {"friction.slip_regularisation_m_s": 1e-8, "operation.shaft_speed_rpm": 200.0},
        "steady",
        ("ok",),
    ),
    "split points that jump": (
        {"friction.slip_regularisation_m_s": 1e-8, "model.quadrature": "split"},
        "steady",
        ("ok", "below_rounding"),
    ),
    "preload gone, a ball that slows down": (
        {
            "operation.preload_method": "fixed_position",
            "wear.ball_diameter_loss_um": 1.0,
            "friction.ball_race": 0.003,
            "lubricant.drag_density_kg_m3": 250.0,
        },
        "steady",
        ("preload_gone",),
    ),
    "a load that unseats the race": (
        {"operation.radial_load_N": [0.0, 70.0], "operation.preload_N": 0.7},
        "race_control",
        ("ok", "race_unseated", "no_race_control", "preload_gone"),
    ),
}


@pytest.mark.parametrize("name", FOUND)
def test_found(name):
    changes, tier, ends = FOUND[name]
    data = changed(BASE, changes)
    data["cage"] = data["wear"]["end_of_life"] = None
    scene = scene_from_dict(data)
    values = stress.solved_values(scene, tier)
    assert STATUS_NAMES[values["status"]] in ends
    assert stress.wrongs(scene, tier, values) == []


def test_cage_that_its_pockets_cut_through():
    """It has no mass; a run in time once stopped with a traceback."""
    with pytest.raises(SceneError, match="cage.width_mm"):
        load_scene(scene_file("gyro_s1"), ["cage.width_mm=1.0"])


def test_a_spring_beside_a_large_centrifugal_force():
    """The race's Newton stopped at a step that was small for the grooves, not for the spring."""
    data = changed(
        BASE,
        {
            "operation.preload_N": 0.1,
            "operation.shaft_speed_rpm": 2000.0,
            "bearing.ball_diameter_mm": 70.0,
            "bearing.pitch_diameter_mm": 350.0,
        },
    )
    data["cage"] = data["wear"]["end_of_life"] = None
    values = stress.solved_values(scene_from_dict(data), "race_control")
    if values["status"] == code.OK:
        assert values["residual_preload"] == pytest.approx(0.1, rel=1e-9)


def test_crossing_is_found_and_bisected():
    from bearingwear.study.extremes import Axis

    axis = Axis.of_block({"key": "k", "log": [1e-3, 1e3], "points": 13}, "")
    found = [np.log(y / 7.0) for y in axis.values]
    assert stress.crossing(axis, found, lambda y: np.log(y / 7.0)) == pytest.approx(7.0, rel=1e-4)
    assert np.isnan(stress.crossing(axis, [1.0] * 13, lambda y: 1.0))


@pytest.mark.parametrize("kind", ["families", "maps", "branches"])
def test_files_figures_and_table(kind, tmp_path):
    """A plan of a few points, from the command to the picture."""
    plan = tmp_path / "plan.yaml"
    plan.write_text(
        "scene: gyro_s1\n"
        "families: {few: {tier: steady, scenes: 3, draw: {friction.ball_race: {log: [0.01, 1]}}}}\n"
        "maps: {few: {title: t, limits: [gyroscopic_slip], "
        "x: {key: operation.shaft_speed_rpm, log: [1000, 30000], points: 2}, "
        "y: {key: operation.preload_N, log: [1, 50000], points: 3}}}\n"
        "limits: {gyroscopic_slip: 0.25, skid: 0.1}\n"
        "branches: {few: {title: t, along: {key: friction.ball_race, log: [0.01, 0.1], points: 3}}}"
        "\n"
    )
    found, table = tmp_path / "few.nc", tmp_path / "few.md"
    assert main(["extremes", kind, "few", "--plan", str(plan), "-o", str(found)]) == 0
    again = tmp_path / "again.nc"
    assert main(["extremes", kind, "few", "--plan", str(plan), "-o", str(again)]) == 0
    assert found.read_bytes() == again.read_bytes()
    picture = tmp_path / "few.png"
    figure = ["figure", "extremes", str(found), "-o", str(picture)]
    if kind == "families":
        assert main(figure) == 2
    else:
        assert main(figure) == 0 and picture.stat().st_size > 5000
    gather = ["gather-extremes", str(found), "-o", str(tmp_path / "counts.nc")]
    if kind == "branches":
        assert main(gather) == 2
        return
    assert main(gather) == 0
    counts = load(tmp_path / "counts.nc")
    assert counts["wrong"].item() == 0
    assert counts["trials"].item() == {"families": 3, "maps": 6}[kind]
    assert (counts["verified"] + counts["refused"] + counts["unnamed"] == counts["trials"]).all()
    assert main(["tables-extremes", str(tmp_path / "counts.nc"), "-o", str(table)]) == 0
    assert "| 0 |" in table.read_text()


def test_bad_plan_is_one_line(tmp_path, capsys):
    plan = tmp_path / "plan.yaml"
    plan.write_text(
        (ROOT / "config" / "extremes.yaml").read_text().replace("log: [10,", "log: [0,")
    )
    assert main(["extremes", "families", "steady", "--plan", str(plan), "-o", "x.nc"]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and "shaft_speed_rpm" in said
