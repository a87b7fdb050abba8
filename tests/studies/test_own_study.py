"""The study of one scene: its plan, and the folder that is made for it."""

import dataclasses

import pytest
import yaml
from support import scene_file

from bearingwear.applications.cage.plan import cage_axes, check_cage
from bearingwear.console import UsageError
from bearingwear.lives.life import life
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.read import load_scene
from bearingwear.studies.configuration import validated_config
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.own_study import requirements_in_words, study_files, write_study

LIMITS = DesignLimits(axial_stiffness_N_um=3.0)


def plans(scene):
    """Returns the configuration of a scene's study, and that of its choice of a preload."""
    files = study_files(scene, "mine", LIMITS, "mine.yaml")
    return files["config/config.yaml"], files["config/design.yaml"]["scenes"]["mine"]


@pytest.fixture
def scene():
    """Returns gyro_s1, here in place of the fixture of tests/conftest.py."""
    return load_scene(scene_file("gyro_s1"))


def with_friction(scene, mu):
    """Returns a scene with another friction coefficient of ball and races."""
    return dataclasses.replace(scene, friction=dataclasses.replace(scene.friction, ball_race=mu))


def test_the_grid_of_cases_is_around_the_scene(scene):
    """It has both preload methods, and four frictions from half to twice the 0.08 of the scene."""
    config, _ = plans(scene)
    (block,) = config["studies"]
    assert block["scenes"] == config["uncertain_lives"]["scenes"] == ["mine"]
    assert block["preload_method"] == ["constant_force", "fixed_position"]
    assert block["friction"] == [0.04, 0.08, 0.12, 0.16]
    assert config["figures"]["friction"] == [0.08]


def test_the_states_of_wear_go_to_the_end_of_the_scene_s_own_life(scene):
    """There are nine losses of ball diameter from zero; the last is rounded up to 0.01 um."""
    config, _ = plans(scene)
    losses = config["studies"][0]["ball_diameter_loss_um"]
    end = 1e6 * float(life(scene).values["loss_at_end"])
    assert losses[0] == 0.0 and end <= losses[-1] <= end + 0.01 and len(losses) == 9
    assert config["figures"]["worn_loss_um"] in losses


def test_the_map_of_preloads_is_around_the_scene(scene):
    """Preloads go from an eighth to 32 times its 7 N; speed, friction and limits are its own.

    The configuration is plain data, which YAML reads back as it was.
    """
    _, design = plans(scene)
    axes = design["small_map"]
    assert axes["shaft_speed_rpm"] == [30000.0] and 0.08 in axes["friction"]
    assert 7.0 in axes["preload_N"]
    assert axes["preload_N"][0] < 1.0 and axes["preload_N"][-1] > 200.0
    assert design["limits"] == {"axial_stiffness_N_um": 3.0}
    assert yaml.safe_load(yaml.safe_dump(design)) == design


def test_the_states_of_wear_of_a_pair_go_to_the_end_of_its_life(scene):
    """The last loss is that of the bearing that loses more, rounded up to 0.01 um."""
    pair = scene.with_({"arrangement.kind": "spring_pair", "arrangement.external_axial_N": 1.0})
    config, _ = plans(pair)
    (block,) = config["studies"]
    end = 1e6 * float(max(life(pair).values["loss_at_end"]))
    assert end <= block["ball_diameter_loss_um"][-1] <= end + 0.01


def test_the_preload_method_of_a_pair_decides_its_kind(scene):
    """A change of the method alone, as by the grid of cases, changes the kind of pair with it.

    A kind that contradicts the method is refused.
    """
    pair = scene.with_({"arrangement.kind": "spring_pair", "arrangement.external_axial_N": 1.0})
    rigid = pair.with_({"operation.preload_method": "fixed_position"})
    assert rigid.arrangement.kind == "rigid_pair"
    with pytest.raises(SceneError, match="arrangement.kind"):
        rigid.with_(
            {"operation.preload_method": "fixed_position", "arrangement.kind": "spring_pair"}
        )


@pytest.mark.parametrize(
    ("phases", "samples"),
    [(["nominal"], 128), (["nominal", "idle"], 64), (["nominal", "idle", "fast"], 32)],
)
def test_fewer_bearings_are_sampled_over_a_duty(scene, phases, samples):
    """A life over a duty takes the solves of all its phases.

    The number of samples is the power of two that keeps the solves at those of 128 lives or fewer.
    """
    idle, fast = ({"operation.shaft_speed_rpm": speed} for speed in (6000.0, 36000.0))
    changes = {"cases": {"idle": idle, "fast": fast}}
    duty = {"duty.phases": {name: {"hours": 1.0} for name in phases}}
    config, _ = plans(scene.with_(changes | duty))
    assert config["uncertain_lives"]["samples"] == samples


def test_a_duty_is_studied_at_its_own_friction(scene):
    """Phases may have their own friction, so a grid of it would mean little and cost four times."""
    config, design = plans(scene.with_({"duty.phases": {"nominal": {"hours": 1.0}}}))
    assert config["studies"][0]["friction"] == design["small_map"]["friction"] == [0.08]


def test_a_scene_with_a_film_has_no_grid_of_cases(scene):
    """A film has no single friction coefficient: the map has zero for it (`NO_FRICTION`)."""
    film = {"shear_strength_MPa": 30.0, "thickness_um": 1.0, "wear_coefficient": 1e-7}
    inputs = {f"friction.film.{key}": value for key, value in film.items()}
    config, design = plans(scene.with_({"friction.ball_race": None, "uncertainty": None} | inputs))
    assert config["studies"] == [] and "uncertain_lives" not in config
    assert design["small_map"]["friction"] == [0.0]


@pytest.mark.parametrize(
    "mu, frictions", [(0.001, [0.001, 0.002]), (0.064, [0.032, 0.064, 0.096, 0.128])]
)
def test_own_friction_is_among_those_studied(scene, mu, frictions):
    """So are half, 1.5 times and twice it, rounded to thousandths; none is zero or there twice."""
    config, _ = plans(with_friction(scene, mu))
    assert config["studies"][0]["friction"] == frictions


def test_a_scene_with_uncertain_cages_has_a_map_of_cages(scene, tmp_path):
    """With the block `cage_uncertainty` there is a plan, which passes the checks of the workflow.

    Axes are around the cage of gyro_s1, with a guide clearance of 0.1 mm and a friction of 0.05.
    """
    assert "config/cage.yaml" not in study_files(scene, "mine", LIMITS, "mine.yaml")
    with_cage_study = scene.with_({"cage_uncertainty": {}})
    plan = study_files(with_cage_study, "mine", LIMITS, "mine.yaml")["config/cage.yaml"]
    (tmp_path / "cage.yaml").write_text(yaml.safe_dump(plan), encoding="utf-8")
    (tmp_path / "scenes").mkdir()
    (tmp_path / "scenes/mine.yaml").write_bytes(scene_file("gyro_s1").read_bytes())
    axes = cage_axes(validated_config(tmp_path / "cage.yaml", "cage", check_cage))
    assert axes["guide_clearance_mm"] == [0.1, 0.2]
    assert axes["cage_friction"] == [0.025, 0.05, 0.075]


def test_without_friction_there_is_no_study(scene):
    """The error names the file and the key."""
    with pytest.raises(SceneError, match=r"mine.yaml: friction.ball_race: got 0, expected"):
        plans(with_friction(scene, 0.0))


def test_without_preload_there_is_no_study(scene):
    """A scene without preload is valid once its end of life is not a share of it."""
    end = dataclasses.replace(scene.wear.end_of_life, preload_fraction=None)
    scene = dataclasses.replace(
        scene,
        operation=dataclasses.replace(scene.operation, preload_N=0.0),
        wear=dataclasses.replace(scene.wear, end_of_life=end),
    )
    with pytest.raises(SceneError, match=r"operation.preload_N: got 0, expected.*a number > 0"):
        plans(scene)


# the folder


@pytest.fixture
def mine(tmp_path):
    """Returns the path of a scene that is based on another, beside it."""
    (tmp_path / "base.yaml").write_bytes(scene_file("gyro_s1").read_bytes())
    file = tmp_path / "mine.yaml"
    file.write_text("name: mine\nbased_on: base\nset: {uncertainty: null}\n")
    return file


def contents(folder):
    """Returns the bytes of all files of a folder, by path."""
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_folder_holds_all_that_the_study_needs(mine, tmp_path):
    """It has two plans and copies of both scenes; the first line of each names the command."""
    folder = tmp_path / "study"
    write_study(mine, folder, LIMITS)
    names = {path.relative_to(folder).as_posix() for path in contents(folder)}
    plan_names = {"config/config.yaml", "config/design.yaml"}
    assert names == plan_names | {"config/scenes/base.yaml", "config/scenes/mine.yaml"}
    assert load_scene(folder / "config/scenes/mine.yaml") == load_scene(mine)
    for text in contents(folder).values():
        assert text.startswith(b"# Written by `bearingwear study mine.yaml`")


def test_same_command_writes_nothing_and_an_edit_of_the_scene_renews_the_copy(mine, tmp_path):
    """Without an edit, dates stay; with one, the copy has the new preload and the same base."""
    folder = tmp_path / "study"
    write_study(mine, folder, LIMITS)
    before = contents(folder)
    times = {path: path.stat().st_mtime_ns for path in before}
    write_study(mine, folder, LIMITS)
    assert {path: path.stat().st_mtime_ns for path in before} == times
    mine.write_text(mine.read_text().replace("null}", "null, operation.preload_N: 9}"))
    write_study(mine, folder, LIMITS)
    copy = folder / "config/scenes/mine.yaml"
    assert load_scene(copy).operation.preload_N == 9.0
    base = copy.with_name("base.yaml")
    assert base.read_bytes() == before[base]


def test_other_requirements_than_before_are_known(mine, tmp_path):
    """They are returned, so that a command can report that other requirements are replaced."""
    folder = tmp_path / "study"
    assert write_study(mine, folder, LIMITS) == ""
    assert write_study(mine, folder, DesignLimits()) == "axial_stiffness_N_um 3"
    assert requirements_in_words(folder, "mine") == "none"


@pytest.mark.parametrize("name", ["scenes/mine.yaml", "scenes/base.yaml", "design.yaml"])
def test_an_edited_file_of_a_study_is_not_replaced(mine, tmp_path, name):
    """This applies even if scene and limits have changed; the error names the file."""
    folder = tmp_path / "study"
    write_study(mine, folder, LIMITS)
    edited = folder / "config" / name
    edited.write_text(edited.read_text() + "# mine\n")
    before = contents(folder)
    mine.write_text(mine.read_text() + "# another\n")
    with pytest.raises(UsageError, match=rf"{name}: got an edited file, expected"):
        write_study(mine, folder, DesignLimits())
    assert contents(folder) == before


def test_a_folder_with_other_files_is_refused(mine, tmp_path):
    folder = tmp_path / "study"
    folder.mkdir()
    (folder / "notes.txt").touch()
    with pytest.raises(UsageError, match="got a folder with other files"):
        write_study(mine, folder, LIMITS)


def test_the_folder_of_another_scene_is_refused(mine, tmp_path):
    """This applies even to equal contents; the error has the command for a folder of its own."""
    write_study(mine, tmp_path / "study", LIMITS)
    other = mine.with_name("other.yaml")
    other.write_bytes(mine.read_bytes())
    with pytest.raises(UsageError, match="bearingwear study other.yaml"):
        write_study(other, tmp_path / "study", LIMITS)


def test_a_file_in_place_of_the_folder_is_refused(mine):
    """The file is the scene itself."""
    with pytest.raises(UsageError, match="cannot be used"):
        write_study(mine, mine, LIMITS)


def test_a_scene_of_the_dynamic_model_is_refused_with_an_alternative(mine, tmp_path):
    """A rotating load needs it. The error has the command for a life; no folder is made."""
    mine.write_text(mine.read_text().replace("null}", "null, operation.rotating_load_N: 1}"))
    with pytest.raises(SceneError) as error:
        write_study(mine, tmp_path / "study", LIMITS)
    assert f"bearingwear life {mine} --fidelity dynamic" in str(error.value)
    assert not (tmp_path / "study").exists()
