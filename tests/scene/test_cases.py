"""Cases of a scene: their changed keys, and keys that no case may change."""

import json
import pickle

import pytest
from support import scene_file

import bearingwear
from bearingwear.cli import main
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.scene.scene import SceneError

CASES = {"cold": {"friction": {"ball_race": 0.2}}, "hot": {"friction.ball_race": 0.04}}


@pytest.fixture
def scene():
    return load_scene(scene_file("gyro_s1")).with_({"cases": CASES})


def test_a_case_is_the_scene_with_keys_changed(scene):
    assert [*scene.in_cases] == ["nominal", "cold", "hot"]
    plain = load_scene(scene_file("gyro_s1"))
    assert scene.in_cases["nominal"] == plain
    for name, mu in (("cold", 0.2), ("hot", 0.04)):
        assert scene.in_cases[name] == plain.with_({"friction.ball_race": mu})
    assert all(case.cases is None for case in scene.in_cases.values())


def test_a_scene_with_cases_is_a_value(scene, tmp_path):
    assert scene_from_dict(scene.to_dict()) == scene
    assert pickle.loads(pickle.dumps(scene)) == scene
    assert hash(scene) == hash(scene.with_({}))
    assert hash(scene) != hash(scene.with_({"cases.cold.friction.ball_race": 0.3}))
    bearingwear.save(scene, tmp_path / "cases.yaml")
    assert load_scene(tmp_path / "cases.yaml") == scene


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"nominal": {"friction.ball_race": 0.1}}, "cases: got .nominal., expected another name"),
        (
            {"cold": {"operation.preload_N": 3.0}},
            "cases.cold.operation.preload_N: got 3.0 for a key",
        ),
        (
            {"cold": {"friction.ball_race": -1.0}},
            "cases.cold.friction.ball_race: got -1.0, expected",
        ),
        ({"cold": {"friction.ball_rase": 0.1}}, "cases.cold.friction.ball_rase: got an unknown"),
    ],
)
def test_wrong_cases_are_refused_in_one_line(changes, problem):
    plain = load_scene(scene_file("gyro_s1")).to_dict()
    with pytest.raises(SceneError, match=problem):
        scene_from_dict(plain | {"cases": changes})


@pytest.mark.parametrize("case", ["cold", "nominal"])
def test_a_case_is_solved_by_its_name(scene, case, tmp_path, capsys):
    """The sheet has the shaft torque [uN m] of that case, which depends on its friction."""
    bearingwear.save(scene, tmp_path / "a.yaml")
    assert main(["solve", str(tmp_path / "a.yaml"), "--case", case, "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["quantities"]
    (torque,) = (row for row in rows if row["name"] == "shaft_torque")
    result = bearingwear.solve(scene.in_cases[case])
    assert torque["unit"] == "uN m"
    assert torque["value"] == pytest.approx(1e6 * float(result.shaft_torque), rel=1e-12)


def test_a_case_that_a_scene_has_not_is_refused_in_one_line(scene, tmp_path, capsys):
    bearingwear.save(scene, tmp_path / "a.yaml")
    assert main(["solve", str(tmp_path / "a.yaml"), "--case", "warm"]) == 2
    assert capsys.readouterr().err == "--case: got warm, expected nominal, cold, hot\n"
