"""What the workflow reads: faults of configurations, and the values of scenes that jobs read."""

import copy

import pytest
import yaml
from support import ROOT, scene_file

from bearingwear.console import UsageError
from bearingwear.measures import LIMITED
from bearingwear.scene.checking.records import file_part
from bearingwear.scene.checking.strict_yaml import yaml_of
from bearingwear.scene.decisive import reads_cage
from bearingwear.scene.read import load_scene, variant
from bearingwear.studies import configuration
from bearingwear.studies.axis import GRID_KEYS
from bearingwear.studies.design.plan import DesignLimits

# a right configuration of a study, and a right block of dynamic cases
CONFIG = {
    "studies": [
        {
            "scenes": ["gyro_s1"],
            "preload_method": ["constant_force", "fixed_position"],
            "friction": [0.02, 0.08],
            "ball_diameter_loss_um": [0, 0.5],
        }
    ],
    "dynamic": [],
    "uncertain_lives": {"scenes": []},
    "figures": {
        "friction": [],
        "wear_columns": [],
        "spreads": {},
        "lives": {},
        "running_averages": {},
    },
}
DYNAMIC = {
    "scenes": ["gyro_s1"],
    "preload_method": ["constant_force"],
    "friction": [0.02],
    "ball_diameter_loss_um": [0],
    "model": {"simulated_turns": 1},
}


@pytest.fixture(autouse=True)
def in_the_project(monkeypatch):
    """Makes the project the present folder, as configurations name files below it."""
    monkeypatch.chdir(ROOT)


# where a fault is (keys and indices from the top), the wrong value, and words of the error
FAULTS = (
    (["studies", 0, "friction"], [1 / 3], "studies[0]: friction: got 0.333"),
    (["studies", 0, "scenes"], ["gyro_s1", "gyro_s1"], "scenes: got gyro_s1 twice"),
    (["studies", 0, "scenes"], ["no_such"], "config/scenes/no_such.yaml"),
    (
        ["studies", 0, "ball_diameter_loss_um"],
        [0, 500],
        "loss500.00: wear.ball_diameter_loss_um: got 500, expected a number < 200",
    ),
    (["figures", "friction"], [0.5], "figures.friction: got 0.5, expected 0.02, 0.08"),
    (
        ["figures", "spreads"],
        {"a": {"scenes": ["other"], "friction": 0.02}},
        "spreads.a: got other",
    ),
    (
        ["figures", "wear_columns"],
        [{"scene": "gyro_s1", "friction": 0.03}],
        "figures.wear_columns[0]: gyro_s1: got 0.03, expected 0.02, 0.08",
    ),
    (
        ["figures", "running_averages"],
        {"gyro_s1": None},
        "averages: got gyro_s1",
    ),
    (["uncertain_lives", "scenes"], ["gyro_s2"], "uncertain_lives.scenes: got gyro_s2"),
    (
        ["dynamic"],
        [{**DYNAMIC, "friction": [0.03]}],
        "got gyro_s1, constant_force-mu0.03",
    ),
    (
        ["dynamic"],
        [{**DYNAMIC, "model": {"simulated_turns": "1; touch x"}}],
        "loss0.00: model.simulated_turns: got '1; touch x', text, not a number",
    ),
)


def faulty(keys, value):
    """Returns CONFIG with another value at a place, by keys and indices from the top."""
    config = place = copy.deepcopy(CONFIG)
    for key in keys[:-1]:
        place = place[key]
    place[keys[-1]] = value
    return config


def test_a_right_configuration_passes():
    """The check of CONFIG raises nothing, so that other tests fail only by its FAULTS."""
    configuration.check_config(CONFIG)


@pytest.mark.parametrize(("keys", "value", "problem"), FAULTS, ids=lambda value: None)
def test_a_faulty_configuration_is_refused_in_one_line(keys, value, problem):
    with pytest.raises(ValueError, match="^[^\n]*$") as error:
        configuration.check_config(faulty(keys, value))
    assert problem in str(error.value)


@pytest.mark.parametrize(
    ("keys", "value", "problem"),
    [
        (["studies", 0, "frictoin"], [0.1], "studies[0]: Additional properties are not allowed"),
        (["studies", 0, "friction"], 0.1, "studies[0].friction: 0.1 is not of type 'array'"),
        (["studies", 0, "scenes"], ["../a"], "studies[0].scenes[0]: '../a' does not match"),
    ],
)
def test_configurations_against_the_schema_are_refused_in_one_line(keys, value, problem, tmp_path):
    """The schema is checked first: an unknown key, a number for a list, a path for a scene."""
    path = tmp_path / "config.yaml"
    path.write_text(yaml.safe_dump(faulty(keys, value)), encoding="utf-8")
    with pytest.raises(UsageError, match="^[^\n]*$") as error:
        configuration.validated_config(path, "config", lambda data, path: None)
    assert str(error.value).startswith(f"{path}: {problem}")


def test_the_configurations_of_the_project_pass_their_checks():
    """They are the files of design, lives and uncertainty.

    Files may omit `set` and `limits`; their schema makes these empty, as the test does here.
    """
    lives = configuration.read_config("config/lives.yaml")["lives"]
    configuration.check_lives({"lives": {name: {"set": {}} | lives[name] for name in lives}})
    scenes = configuration.read_config("config/design.yaml")["scenes"]
    configuration.check_design({"scenes": {name: {"limits": {}} | scenes[name] for name in scenes}})
    configuration.check_sampled(configuration.read_config("config/uncertainty.yaml"))


def test_a_missing_configuration_is_empty():
    assert configuration.read_config("config/none.yaml") == {}


@pytest.mark.parametrize(
    ("life", "problem"),
    [
        ({"scene": "gyro_s1", "set": {"operation.preload": 1.0}}, "lives.a: operation.preload: "),
        ({"scene": "gyro_s1", "set": {"wear.end_of_life": None}}, "lives.a: "),
        ({"scene": "nowhere", "set": {}}, "lives.a: "),
    ],
)
def test_a_faulty_life_is_named_in_one_line(life, problem):
    """Faults are an unknown key, a life without an end, and a scene that is not there."""
    with pytest.raises(ValueError, match="^[^\n]*$") as error:
        configuration.check_lives({"lives": {"a": life}})
    assert problem in str(error.value)


def test_a_required_frequency_of_a_scene_without_a_rotor_is_refused_in_one_line():
    """The line names `arrangement`, the block that is missing."""
    limits = {"lowest_frequency_Hz": 100}
    with pytest.raises(ValueError, match="^[^\n]*arrangement[^\n]*$"):
        configuration.check_design({"scenes": {"gyro_s1": {"limits": limits}}})


def test_limits_of_the_schema_are_those_of_the_measures():
    """The schema of config/design.yaml has all keys of `DesignLimits`, measures among them."""
    schema = yaml.safe_load((ROOT / "workflow/schemas/design.schema.yaml").read_text())
    scene = schema["properties"]["scenes"]["additionalProperties"]
    keys = set(file_part(DesignLimits).below)
    assert set(scene["properties"]["limits"]["properties"]) == keys
    assert keys >= set(LIMITED)


# axes of a map, as in config/design.yaml
AXES = {
    "preload_method": ["constant_force"],
    "friction": [0.08],
    "shaft_speed_rpm": [30000],
    "preload_N": {"first": 1.0, "last": 3.0, "step": 1.0},
}


def test_an_axis_of_a_map_may_be_its_ends_and_step():
    assert configuration.map_axes(AXES)["preload_N"] == [1.0, 2.0, 3.0]


def test_an_axis_of_a_map_must_rise():
    with pytest.raises(ValueError, match="expected increasing numbers"):
        configuration.map_axes(AXES | {"preload_N": [2.0, 1.0]})


# a key of a scene, its new value, and the jobs that read it
CHANGES = (
    ("operation.preload_N", 8.0, {"solve", "spread", "dynamic"}),
    ("friction.ball_race", 0.07, {"spread", "dynamic"}),
    ("uncertainty", None, {"spread"}),
    ("cage.pocket_clearance_mm", 0.16, {"dynamic"}),
    ("model.cage_results", True, {"solve", "spread", "dynamic"}),
    ("description", "Another bearing", set()),
)


@pytest.mark.parametrize(("key", "value", "jobs"), CHANGES)
def test_a_change_of_a_scene_concerns_only_the_jobs_that_read_it(key, value, jobs, tmp_path):
    """A case, sampled lives and a job of the dynamic model each have a hash of what they read.

    A case does not read the friction of its scene, which is an axis of the grid.
    """

    def hashes(name, scene):
        """Returns the hash of a scene for each kind of job."""
        path = str(tmp_path / f"{name}.yaml")
        (tmp_path / f"{name}.yaml").write_text(yaml_of(scene.to_dict()), encoding="utf-8")
        return {
            # keys that a grid overrides, whether the cage and the uncertain values are read
            "solve": configuration.scene_hash(path, tuple(GRID_KEYS.values()), False, False),
            "spread": configuration.scene_hash(path, (), False, True),
            "dynamic": configuration.scene_hash(path, (), True, False),
        }

    before = hashes("before", load_scene(scene_file("gyro_s1")))
    after = hashes("after", variant(scene_file("gyro_s1"), {key: value}))
    assert {name for name in before if before[name] != after[name]} == jobs


def test_a_cage_is_read_where_its_results_or_the_dynamic_model_are_required():
    """A cage that is only described is not read. Scenes are plain data here."""
    assert reads_cage({"model": {"cage_results": True}})
    assert reads_cage({"model": {"fidelity": "dynamic"}})
    assert not reads_cage({"cage": {}, "model": None})
