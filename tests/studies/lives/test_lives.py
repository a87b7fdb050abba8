"""The study of lives: its plan, and what a faulty one is told. Its figure and table: results/."""

import json

import pytest
from support import ROOT

from bearingwear.scene.checking.check import read_record
from bearingwear.studies.lives.study import LIVES_FILE, LivesPlan, study_of_lives

CHANGED = {"operation.preload_method": "fixed_position"}


def test_every_life_of_the_plan_is_a_valid_scene(monkeypatch):
    monkeypatch.chdir(ROOT)
    plan = read_record(LivesPlan, LIVES_FILE)
    plan.check_scenes()
    assert len(plan.lives) >= 5
    made = study_of_lives(plan)
    solve = made.steps[0]
    assert solve.files({"life": "cage_ends"}) == {"scene": "config/scenes/gyro_s1.yaml"}
    settings = solve.given({"life": "cage_ends"})
    assert settings["fidelity"] == "dynamic"
    assert settings["changes"]["wear.end_of_life.pocket_clearance_mm"] == 0.18
    assert "results/lives/figures/cage_ends.svg" in made.targets()


@pytest.mark.parametrize(
    ("life", "said"),
    [
        ({"scene": "gyro_s1", "set": {"operation.preload": 1.0}}, "lives.a: operation.preload: "),
        ({"scene": "gyro_s1", "st": {}}, "lives.a.st: got an unknown key"),
        ({"set": CHANGED}, "lives.a.scene: got nothing"),
        ({"scene": "../gyro_s1"}, "lives.a.scene: got '../gyro_s1', expected"),
        ({"scene": "gyro_s1", "set": {"wear.end_of_life": None}}, "lives.a: "),
        ({"scene": "nowhere"}, "lives.a: "),
    ],
)
def test_a_faulty_life_is_named_in_one_line(life, said, tmp_path, monkeypatch):
    """A scene without an end of life among them."""
    monkeypatch.chdir(ROOT)
    file = tmp_path / "lives.yaml"
    file.write_text(json.dumps({"lives": {"a": life}}), encoding="utf-8")
    with pytest.raises(ValueError) as error:
        read_record(LivesPlan, file).check_scenes()
    assert said in str(error.value) and "\n" not in str(error.value)


def test_no_lives_make_nothing():
    assert study_of_lives(LivesPlan()).targets() == []
