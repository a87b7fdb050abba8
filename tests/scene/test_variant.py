"""A scene with some keys changed: from Python, and as a file based on another one."""

from pathlib import Path

import pytest

from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.read import load_scene, scene_files, variant

SCENES = Path(__file__).parents[2] / "config" / "scenes"
S1 = SCENES / "gyro_s1.yaml"


def write(folder, name, text):
    """Writes a scene file with a name and further lines, and returns its path."""
    path = folder / f"{name}.yaml"
    path.write_text(f"name: {name}\n{text}")
    return path


@pytest.fixture
def folder(tmp_path):
    """Returns a folder with the file gyro_s1.yaml."""
    (tmp_path / "gyro_s1.yaml").write_bytes(S1.read_bytes())
    return tmp_path


@pytest.mark.parametrize("kind", ["path", "plain data", "scene"])
def test_a_variant_is_the_scene_that_the_option_set_makes(kind):
    source = {"path": S1, "plain data": load_scene(S1).to_dict(), "scene": load_scene(S1)}[kind]
    changes = {"operation.preload_N": 9, "model.strips": 20, "friction.ball_race": 1e-5}
    texts = ["operation.preload_N=9", "model.strips=20", "friction.ball_race=1e-5"]
    assert variant(source, changes) == load_scene(S1, texts)


def test_a_variant_does_not_change_its_plain_data():
    plain = load_scene(S1).to_dict()
    variant(plain, {"operation.preload_N": 9})
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
def test_changes_of_a_scene_and_of_its_file_give_the_same_scene(changes):
    scene, expected = load_scene(S1).with_(changes), variant(S1, changes)
    assert scene == expected and scene.json == expected.json


@pytest.mark.parametrize(
    ("key", "value", "problem"),
    [
        ("bearing.ball_count", 30, "got 30 balls"),
        ("bearing.ball_count.x", 30, "got a key under bearing.b"),
        ("friction.mu", None, "got an unknown key"),
    ],
)
def test_a_faulty_change_is_named_in_its_error(key, value, problem):
    with pytest.raises(SceneError, match=f"^--set {key}: {problem}"):
        variant(S1, {key: value})


def test_null_leaves_an_entry_out():
    scene = variant(S1, {"uncertainty.preload_N": None, "cage": None, "materials.phenolic": None})
    assert "preload_N" not in scene.uncertainty and "phenolic" not in scene.materials
    assert "ball_race" in scene.uncertainty and scene.cage is None


def test_null_for_a_required_key_is_refused():
    with pytest.raises(SceneError, match="cage.restitution: got nothing"):
        variant(S1, {"cage.restitution": None})


@pytest.fixture
def fast(folder):
    """Returns the path of a file that is based on gyro_s1, with a speed of 40 000 r/min."""
    return write(folder, "fast", "based_on: gyro_s1\nset: {operation.shaft_speed_rpm: 4e4}\n")


def test_a_file_based_on_another_has_the_values_that_it_does_not_set(fast):
    scene, base = load_scene(fast), load_scene(S1)
    assert scene.operation.shaft_speed_rpm == 40000 and scene.name == "fast"
    assert scene.description == base.description and scene.cage == base.cage


def test_a_file_may_be_based_on_one_that_is_based_on_another(folder, fast):
    faster = write(folder, "faster", "based_on: fast\nset: {operation.preload_N: 9}\n")
    operation = load_scene(faster, ["friction.cage=0"]).operation
    assert (operation.preload_N, operation.shaft_speed_rpm) == (9, 40000)
    assert scene_files(faster) == [str(path) for path in (faster, fast, folder / "gyro_s1.yaml")]


def test_a_block_under_set_replaces_the_whole_block(folder, fast):
    part = write(folder, "part", "based_on: fast\nset: {operation: {preload_N: 9}}\n")
    with pytest.raises(SceneError, match="part.yaml: operation.shaft_speed_rpm: got nothing"):
        load_scene(part)


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
def test_a_broken_file_based_on_another_is_refused(text, problem, folder):
    path = write(folder, "broken", text)
    with pytest.raises(SceneError) as caught:
        load_scene(path)
    assert str(caught.value).startswith(str(folder)) and problem in str(caught.value)
