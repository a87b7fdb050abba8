"""Scene files, scenes, and the schema they share."""

import copy
import dataclasses
import json
import pickle
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import yaml
from support import benchmark

from bearingwear.scene import read as config
from bearingwear.scene.accuracy import STANDARD
from bearingwear.scene.arrangement import PAIRS
from bearingwear.scene.checking.errors import yaml_number
from bearingwear.scene.checking.records import file_part, keys
from bearingwear.scene.checking.strict_yaml import data_of
from bearingwear.scene.read import variant
from bearingwear.scene.scene import Scene, SceneError, key_of_scene, most_balls

key_lists = benchmark("key_lists")
schema = benchmark("scene_schema").schema

CONFIG = Path(__file__).parents[2] / "config"
SCENES = sorted((CONFIG / "scenes").glob("*.yaml"))
S1 = CONFIG / "scenes" / "gyro_s1.yaml"


@pytest.fixture
def scene() -> Scene:
    """Returns the scene gyro_s1."""
    return config.load_scene(S1)


@pytest.fixture
def plain(scene) -> dict:
    """Returns the scene gyro_s1 as plain data, which a test may change."""
    return scene.to_dict()


# the scenes that come with the project


def test_there_are_scenes_of_the_project():
    assert len(SCENES) > 10


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_scene_of_the_project_is_the_same_when_read_again(path):
    scene = config.load_scene(path)
    plain = scene.to_dict()
    again = config.scene_from_dict(json.loads(json.dumps(plain)))
    assert again == scene and list(again.to_dict()) == list(plain)
    assert config.as_scene(scene) == config.as_scene(path) == config.as_scene(plain) == scene


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_scene_of_the_project_has_the_name_of_its_file_and_says_what_is_assumed(path):
    scene = config.load_scene(path)
    assert scene.name == path.stem and scene.name in repr(scene)
    assert "assumed" in scene.description


@pytest.mark.parametrize("key", ["cage", "lubricant", "wear", "model"])
def test_null_is_the_same_as_leaving_out(key, plain):
    left_out = {name: value for name, value in plain.items() if name != key}
    assert config.scene_from_dict(plain | {key: None}) == config.scene_from_dict(left_out)


def test_numpy_values_are_accepted(plain):
    plain["operation"]["preload_N"] = np.float32(7.0)
    plain["bearing"]["ball_count"] = np.int64(9)
    plain["wear"]["ball_diameter_loss_um"] = np.linspace(0.1, 0.2, 9)
    scene = config.scene_from_dict(plain)
    assert scene.bearing.ball_count == 9
    assert scene.wear.ball_diameter_loss_um[8] == pytest.approx(0.2)


def test_plain_data_are_left_alone(plain):
    unchanged = copy.deepcopy(plain)
    config.scene_from_dict(plain)
    assert plain == unchanged


def test_equal_losses_are_one_loss(plain):
    plain["wear"]["ball_diameter_loss_um"] = [0.3] * 9
    scene = config.scene_from_dict(plain)
    assert scene.wear.ball_diameter_loss_um == (0.3,)
    assert scene.to_dict()["wear"]["ball_diameter_loss_um"] == 0.3


# the objects


def test_a_scene_cannot_be_changed(scene):
    with pytest.raises(dataclasses.FrozenInstanceError):
        scene.name = "another"
    with pytest.raises(TypeError):
        scene.materials["bearing_steel"] = None


def test_equal_scenes_have_one_hash(scene):
    """Keys in another order, and 1 in place of 1.0, make no other scene."""

    def backwards(data):
        """Returns data with the keys of all blocks reversed, and whole numbers without a point."""
        if isinstance(data, dict):
            return {key: backwards(data[key]) for key in reversed(data)}
        return int(data) if isinstance(data, float) and data.is_integer() else data

    changes = {
        "operation.preload_method": "fixed_position",
        "arrangement": {
            "kind": "rigid_pair",
            "second": {"wear.ball_diameter_loss_um": 1.0, "bearing.ball_count": 9},
        },
        "cases": {"slow": {"operation.shaft_speed_rpm": 9e3}, "fast": {}},
        "duty": {"phases": {"slow": {"hours": 1.0}, "fast": {"hours": 2.0}}},
        "drive": {
            "torque_Nm": 1.0,
            "standard": "own",
            "factors": {"bearings": 3.0, "cables": 2.0},
            "bearings_as": "bearings",
        },
    }
    changed = scene.with_(changes)
    same = config.scene_from_dict(backwards(changed.to_dict()))
    assert same == changed and hash(same) == hash(changed)
    for name in ("arrangement", "duty", "drive"):
        assert hash(getattr(same, name)) == hash(getattr(changed, name)), name


def test_a_scene_survives_pickling_and_copying(scene):
    assert pickle.loads(pickle.dumps(scene)) == copy.deepcopy(scene) == scene


def test_a_scene_built_in_python_is_checked(scene):
    with pytest.raises(SceneError, match="bearing.ball_count: got 30 balls"):
        dataclasses.replace(scene, bearing=dataclasses.replace(scene.bearing, ball_count=30))
    backwards = dataclasses.replace(scene.operation, shaft_speed_rpm=-1.0)
    with pytest.raises(SceneError, match="operation.shaft_speed_rpm: got -1.0"):
        config.as_scene(dataclasses.replace(scene, operation=backwards))


@pytest.mark.parametrize("count", [3, 7, 11, 24, 100])
def test_balls_that_just_touch_fit_on_the_pitch_circle(count):
    """Centres of balls that touch are a diameter apart: D = d_m sin(pi/Z)."""
    diameter = 2.0
    pitch_diameter = diameter / np.sin(np.pi / count)
    assert most_balls(diameter, pitch_diameter) == count
    assert most_balls(diameter, pitch_diameter * (1 - 1e-6)) == count - 1


def test_an_error_survives_pickling():
    error = pickle.loads(pickle.dumps(SceneError("a.b", "got 1, expected 2", ("c",), "f.yaml")))
    assert str(error) == "f.yaml: a.b: got 1, expected 2" and error.involved == ("c",)


def test_plain_data_that_contain_themselves_are_refused(plain):
    plain["bearing"]["ball_count"] = plain
    with pytest.raises(SceneError, match="nested blocks"):
        config.scene_from_dict(plain)


# overrides


def test_overrides_are_read_as_yaml():
    scene = config.load_scene(
        S1,
        [
            "operation.preload_N=9",
            "operation.preload_method=fixed_position",
            "operation.radial_load_N=[0, 1.5]",
            "wear.end_of_life={skid_ratio: 0.2}",
            "model.cage_results=false",
            "cage=null",
        ],
    )
    assert scene.operation.preload_N == 9.0
    assert scene.operation.preload_method == "fixed_position"
    assert scene.operation.radial_load_N == (0.0, 1.5)
    assert scene.wear.end_of_life.criteria == {"skid_ratio": 0.2}
    assert scene.cage is None


@pytest.mark.parametrize("indent", [None, 2, "\t"])
def test_json_is_read_as_a_scene(indent, plain, tmp_path):
    """The scene has a number and a text that JSON writes differently from YAML."""
    plain["friction"]["slip_regularisation_m_s"] = 5e-06
    plain["description"] = 'assumed: "\u03bc/2" \\ 5'
    path = tmp_path / "scene.yaml"
    path.write_text(json.dumps(plain, indent=indent))
    scene = config.load_scene(path)
    assert scene.to_dict() == plain and "5e-06" in path.read_text()


# strict YAML


@pytest.mark.parametrize(
    "text, value",
    [("7", 7), ("-7", -7), ("7.", 7.0), (".5", 0.5), ("1.0e-5", 1e-5), ("1.5E+3", 1500.0),
     ("0.1", 0.1), ("true", True), ("~", None), ("'7'", "7"), ("1e-5", 1e-5), ("5e-06", 5e-6),
     ("1E3", 1e3), ("1.0e5", 1e5), (".5e1", 5.0), ("-1e+2", -100.0)],
)  # fmt: skip
def test_yaml_values_have_the_types_that_people_mean(text, value):
    read = data_of(f"x: {text}", "scene")["x"]
    assert read == value and type(read) is type(value)


@pytest.mark.parametrize(
    "text", ["e5", "1e", "010", "0x10", "1_000", "1:30", "yes", "2018-01-01", "="]
)
def test_yaml_keeps_what_looks_like_another_type_as_text(text):
    assert data_of(f"x: {text}", "scene")["x"] == text


@pytest.mark.parametrize("value", [1e-5, 3e-12, 1.5e22, 1e16, 0.1, 7.0, -2.5e-7])
def test_written_numbers_are_read_as_numbers(value):
    assert yaml.safe_load(yaml_number(value)) == value
    assert data_of(yaml_number(value), "scene") == value


def test_a_byte_order_mark_is_ignored(tmp_path):
    path = tmp_path / "bom.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + S1.read_bytes())
    assert config.load_scene(path) == config.load_scene(S1)


# the schema


def blocks(part: dict, path: str = ""):
    """Yields the dotted path and the schema of a part and of all parts below it, depth first."""
    yield path, part
    for name, below in part.get("properties", {}).items():
        yield from blocks(below, f"{path}.{name}" if path else name)
    for word in ("items", "additionalProperties"):
        if isinstance(part.get(word), dict):
            yield from blocks(part[word], f"{path}.x")


def test_the_schema_allows_no_unknown_key():
    with_keys = [(path, part) for path, part in blocks(schema()) if "properties" in part]
    assert len(with_keys) > 10
    for path, part in with_keys:
        assert part["additionalProperties"] is False, path


def test_defaults_decided_by_the_accuracy_are_those_of_standard_accuracy():
    by_accuracy = {
        path for path, part in keys(file_part(Scene)) if part.key.default_by == "model.accuracy"
    }
    standard = STANDARD.keys("ellipse")
    assert by_accuracy == set(standard)
    for path, value in standard.items():
        assert key_of_scene(path).default == value


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, 1e-2),
        ({"model.cage_results": True}, 1e-3),
        ({"model.cage_results": True, "model.accuracy": "draft"}, 1e-3),
        ({"model.cage_results": True, "model.accuracy": "reference"}, 1e-5),
        ({"model.cage_results": True, "model.dynamic_tolerance": 3e-2}, 3e-2),
        ({"wear.end_of_life.guide_clearance_mm": 0.5}, 1e-3),
    ],
)
def test_wear_of_a_cage_takes_finer_steps(changes, expected):
    """The step tolerance of a preset is meant for balls; one that the scene has is kept."""
    gyro = variant(S1, changes)
    assert gyro.model.dynamic_tolerance == expected
    assert config.as_scene(gyro) == gyro


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_the_schema_alone_accepts_the_scenes_of_the_project(path):
    """Editors use the schema without this program."""
    data = yaml.safe_load(path.read_text())
    record = config.BasedOn if "based_on" in data else Scene
    jsonschema.Draft202012Validator(schema(record)).validate(data)


def test_the_schema_alone_accepts_a_scene_as_plain_data(plain):
    jsonschema.Draft202012Validator(schema()).validate(plain)


def test_key_list_is_up_to_date():
    text = (CONFIG / "README.md").read_text(encoding="utf-8")
    assert key_lists.key_list() in text
    assert key_lists.renewed(text) == text, "run: python benchmarks/key_lists.py config/README.md"


@pytest.mark.parametrize(
    ("text", "orientation"),
    [("O", "back_to_back"), ("DB", "back_to_back"), ("X", "face_to_face"), ("DF", "face_to_face")],
)
def test_makers_letters_of_an_orientation_make_the_same_scene(text, orientation, plain):
    """The schema accepts the letters, too."""
    kind = PAIRS[plain["operation"]["preload_method"]]
    data = plain | {"arrangement": {"kind": kind, "orientation": text}}
    jsonschema.Draft202012Validator(schema()).validate(data)
    with_word = plain | {"arrangement": {"kind": kind, "orientation": orientation}}
    assert config.scene_from_dict(data) == config.scene_from_dict(with_word)
    assert config.scene_from_dict(data).to_dict()["arrangement"]["orientation"] == orientation
