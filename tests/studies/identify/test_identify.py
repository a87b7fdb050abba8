"""The bearings that fit what the paper states: the plan, and a search of a small grid."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest
import yaml
from support import ROOT, scene_file

from bearingwear.cli import main
from bearingwear.results.netcdf import load
from bearingwear.scene.checking.check import read_record
from bearingwear.studies.dataset import write_dataset
from workflow.studies.identify import search
from workflow.studies.identify.plan import IdentifyPlan
from workflow.studies.identify.search import FIT_RESULTS, identified

PLAN_FILE = ROOT / "config" / "identify.yaml"


def test_plan_of_the_project():
    plan = read_record(IdentifyPlan, PLAN_FILE)
    plan.check_scenes(ROOT / "config" / "scenes")
    assert scene_file(plan.scene).is_file()


def test_a_scene_that_is_not_there_is_told():
    plan = replace(read_record(IdentifyPlan, PLAN_FILE), marks=("nobody",))
    with pytest.raises(ValueError, match="got the scene nobody"):
        plan.check_scenes(ROOT / "config" / "scenes")


def test_an_angle_without_a_state(scene, monkeypatch):
    """The loss changes its sign twice, the first time where no state is found."""
    stated = read_record(IdentifyPlan, PLAN_FILE)
    plan = replace(stated, contact_angle_deg=(10.0, 20.0, 30.0))

    def loss(turned, statements):
        angle = turned.bearing.contact_angle_deg
        miss = 0.01 * (angle - 14.0) * (26.0 - angle)
        return np.nan if 10.0 < angle < 20.0 else statements.preload_loss + miss

    monkeypatch.setattr(search, "preload_loss", loss)
    assert search.angles_of(scene(), plan) == pytest.approx([26.0])


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
