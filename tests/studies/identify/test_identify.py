"""The bearings that fit what the paper states: the plan, and a search of a small grid."""

import json
from dataclasses import asdict, replace

import pytest
import yaml
from support import ROOT, scene_file, with_value

from bearingwear.cli import main
from bearingwear.results.netcdf import load
from bearingwear.scene.checking.check import read_record
from bearingwear.studies.dataset import write_dataset
from workflow.studies.identify.plan import IdentifyPlan
from workflow.studies.identify.search import FIT_RESULTS, identified

PLAN_FILE = ROOT / "config" / "identify.yaml"


def test_plan_of_the_project():
    plan = read_record(IdentifyPlan, PLAN_FILE)
    plan.check_scenes(ROOT / "config" / "scenes")
    assert scene_file(plan.scene).is_file()


@pytest.mark.parametrize(
    "path, value, told",
    [
        ("statements.preload_loss", 0, "preload_loss: got 0, expected a number > 0"),
        ("statements.qv_least_um", [0.5, 0.3], "qv_least_um: got 0.5, 0.3, expected increasing"),
        ("ball_count", [7, 7], "ball_count: got 7, 7, expected increasing numbers"),
        ("pitch_diameter_mm.step", 0, "pitch_diameter_mm: step: got 0, expected a number > 0"),
    ],
)
def test_bad_plan_takes_one_line(tmp_path, path, value, told):
    file = with_value(PLAN_FILE, path, value, tmp_path)
    with pytest.raises(ValueError) as error:
        read_record(IdentifyPlan, file)
    assert told in str(error.value) and "\n" not in str(error.value)


def test_a_scene_that_is_not_there_is_told():
    plan = replace(read_record(IdentifyPlan, PLAN_FILE), marks=("nobody",))
    with pytest.raises(ValueError, match="there is no scene nobody"):
        plan.check_scenes(ROOT / "config" / "scenes")


def test_the_scene_is_found_among_the_bearings(tmp_path):
    """gyro_s1 was chosen on the ridge: a grid of its own values alone finds it."""
    plan = read_record(IdentifyPlan, PLAN_FILE)
    bearing = yaml.safe_load(scene_file("gyro_s1").read_text())["bearing"]
    angle = bearing["contact_angle_deg"]
    small = replace(
        plan,
        marks=("gyro_s1",),
        pitch_diameter_mm=(bearing["pitch_diameter_mm"],),
        ball_count=(bearing["ball_count"], 60),
        inner_groove_factor=(bearing["inner_groove_factor"],),
        contact_angle_deg=(angle - 2.0, angle + 2.0),
    )
    settings = json.loads(json.dumps(asdict(small)))
    found = identified(scene_file("gyro_s1"), [scene_file("gyro_s1")], settings)
    fit, full = (found.isel(candidate=k) for k in range(2))
    assert FIT_RESULTS[int(fit["fit_result"])] == "fits"
    assert float(fit["contact_angle"]) == pytest.approx(angle, abs=0.5)
    assert FIT_RESULTS[int(full["fit_result"])] == "balls_do_not_fit"
    candidates, figure, table = (tmp_path / name for name in ("c.nc", "c.svg", "c.md"))
    write_dataset(found, candidates)
    assert load(candidates).sizes["candidate"] == 2
    for step, output in (("figures.candidates_figure", figure), ("tables.candidates_table", table)):
        given = [f"candidates={candidates}", "-o", str(output)]
        assert main(["step", f"studies.identify.{step}", *given]) == 0
    assert "| fits | 1 |" in table.read_text() and figure.stat().st_size > 10_000
