"""A scene with some keys changed: from Python, and as a file based on another one."""

from pathlib import Path

import pytest

from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.read import load_scene, scene_files, variant

SCENES = Path(__file__).parents[2] / "config" / "scenes"
S1 = SCENES / "gyro_s1.yaml"


def write(folder, name, text):
    path = folder / f"{name}.yaml"
    path.write_text(f"name: {name}\n{text}")
    return path


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "gyro_s1.yaml").write_bytes(S1.read_bytes())
    return tmp_path


def test_variants_are_what_set_makes():
    changes = {"operation.preload_N": 9, "model.strips": 20, "friction.ball_race": 1e-5}
    texts = ["operation.preload_N=9", "model.strips=20", "friction.ball_race=1e-5"]
    scene = load_scene(S1, texts)
    plain = load_scene(S1).to_dict()
    assert variant(S1, changes) == variant(plain, changes) == scene
    assert variant(load_scene(S1), changes) == scene
    assert plain == load_scene(S1).to_dict()


@pytest.mark.parametrize(
    "changes",
    [
        {"operation.preload_N": 9, "operation.preload_method": "fixed_position"},
        {"materials.bearing_steel.density_kg_m3": 7000.0, "bearing.bore_mm": 3.0},
        {"wear.ball_diameter_loss_um": 0.1, "friction.slip_regularisation_m_s": 1e-4},
        {"arrangement.kind": "spring_pair", "arrangement.second": {"friction.ball_race": 0.05}},
        {"temperature": {"inner_ring_C": 24.0}, "temperature.outer_ring_C": 20.0, "cage": None},
        {"lubricant.drag_density_kg_m3": 0.1, "operation.radial_load_N": [1, 0]},
        {"wear.end_of_life.pocket_clearance_mm": 0.3, "cage.pocket_clearance_mm": 0.11},
    ],
)
def test_new_values_of_a_checked_scene_are_those_of_its_file(changes):
    scene, expected = load_scene(S1).with_(changes), variant(S1, changes)
    assert scene == expected and scene.json == expected.json


def test_a_faulty_change_is_named_in_its_error():
    with pytest.raises(SceneError, match="^--set bearing.ball_count: got 30 balls"):
        variant(S1, {"bearing.ball_count": 30})
    with pytest.raises(SceneError, match="^--set bearing.ball_count.x: got a key under bearing.b"):
        variant(S1, {"bearing.ball_count.x": 30})
    with pytest.raises(SceneError, match="^--set friction.mu: got an unknown key"):
        variant(S1, {"friction.mu": None})


def test_null_leaves_an_entry_out():
    scene = variant(S1, {"uncertainty.preload_N": None, "cage": None, "materials.phenolic": None})
    assert "preload_N" not in scene.uncertainty and "phenolic" not in scene.materials
    assert "ball_race" in scene.uncertainty and scene.cage is None
    with pytest.raises(SceneError, match="cage.restitution: got nothing"):
        variant(S1, {"cage.restitution": None})


def test_file_based_on_another(folder):
    fast = write(folder, "fast", "based_on: gyro_s1\nset: {operation.shaft_speed_rpm: 4e4}\n")
    both = write(
        folder, "Both", "description: assumed\nbased_on: fast\nset: {operation: {preload_N: 9}}\n"
    )
    scene, base = load_scene(fast), load_scene(S1)
    assert scene.operation.shaft_speed_rpm == 40000 and scene.name == "fast"
    assert scene.description == base.description and scene.cage == base.cage
    with pytest.raises(SceneError, match="Both.yaml: operation.shaft_speed_rpm: got nothing"):
        load_scene(both)
    write(folder, "Both", "based_on: fast\nset: {operation.preload_N: 9}\n")
    assert load_scene(both, ["friction.cage=0"]).operation.preload_N == 9
    files = [both, fast, folder / "gyro_s1.yaml"]
    assert scene_files(both) == list(map(str, files))


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("based_on: ../gyro_s1\n", "based_on: got '../gyro_s1', expected a-z"),
        ("based_on: other\n", "other.yaml: got a file that cannot be read"),
        ("based_on: broken\n", "based_on: got broken, based on itself"),
        ("based_on: gyro_s1\nset: {bearing.ball_count: 30}\n", "bearing.ball_count: got 30"),
        ("based_on: gyro_s1\nset: {a..b: 30}\n", "set: got 'a..b', expected keys"),
    ],
)
def test_broken_file_based_on_another(text, problem, folder):
    path = write(folder, "broken", text)
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    assert str(caught.value).startswith(str(folder)) and problem in str(caught.value)
