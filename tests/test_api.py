"""bearingwear as a Python library."""

import warnings
from dataclasses import replace

import matplotlib
import numpy as np
import pytest
import xarray as xr
from support import scene_file

import bearingwear
from bearingwear.cli import main
from bearingwear.results import netcdf
from bearingwear.results.netcdf import CaseFileError
from bearingwear.scene.read import variant
from bearingwear.studies import STUDY_PLOTS

S1 = scene_file("gyro_s1")
COARSE = {"model.strips": 8, "model.tolerance": 1e-3}


@pytest.fixture(scope="module")
def scene():
    """Returns the scene gyro_s1 with few strips and a loose tolerance."""
    return bearingwear.load(S1).with_(COARSE)


def test_public_names_exist_and_have_docstrings():
    assert set(bearingwear.__all__) <= set(dir(bearingwear))
    for name in bearingwear.__all__:
        assert getattr(bearingwear, name).__doc__, name


def test_an_unknown_name_raises_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'solv'"):
        bearingwear.solv  # noqa: B018


# scenes


def test_with_returns_a_changed_scene_and_keeps_the_original(scene):
    changed = scene.with_({"operation.preload_N": 9, "cage": None})
    assert changed.operation.preload_N == 9.0 and changed.cage is None
    assert scene.operation.preload_N == 7.0 and scene.cage is not None


def test_with_refuses_an_invalid_value(scene):
    with pytest.raises(bearingwear.SceneError) as error:
        scene.with_({"operation.preload_N": -9})
    assert str(error.value).startswith("operation.preload_N: got -9, expected a number from 0")


def test_keyword_arguments_of_with_are_refused(scene):
    with pytest.raises(TypeError, match="with_: got preload_N, expected a mapping of whole k"):
        scene.with_(preload_N=3)


def test_a_change_of_accuracy_changes_the_keys_it_decides():
    """Values that the former accuracy decided do not count as set by the user."""
    reference = bearingwear.example().with_({"model.accuracy": "reference"})
    assert reference == variant(S1, {"model.accuracy": "reference"})
    assert reference.model.strips == 1000  # of the preset `reference`
    draft = bearingwear.example().with_({"model.strips": 60}).with_({"model.accuracy": "draft"})
    assert (draft.model.strips, draft.model.steady_starts) == (60, 2)  # the user's, the draft's


def test_the_example_is_the_scene_gyro_s1():
    assert bearingwear.example() == bearingwear.load(S1)


def test_new_gives_the_scene_that_its_command_writes(tmp_path):
    """The scenes are equal, except that the function's description states assumed values, too."""
    argv = [str(tmp_path / "mine.yaml"), "--bore", "40", "--outside", "68", "--ball-diameter", "8"]
    assert main(["new", *argv, "--ball-material", "silicon_nitride"]) == 0
    by_function = bearingwear.new(
        bore=40, outside=68, ball_diameter=8, name="mine", ball_material="silicon_nitride"
    )
    by_command = bearingwear.load(tmp_path / "mine.yaml")
    assert by_function.description.startswith(by_command.description)
    assert "operation.shaft_speed_rpm: 19000" in by_function.description  # an assumed value
    description = {"description": by_command.description}
    assert by_function.to_dict() | description == by_command.to_dict()


@pytest.mark.parametrize(
    ("numbers", "problem"),
    [
        ({"bore": 40, "outside": 30}, "outside: got 30, expected a number > 40, the bore"),
        (
            {"bore": 40, "outside": 68, "ball_material": "wood"},
            "ball_material: got 'wood', expected",
        ),
        (
            {"designation": "7008C", "preload_class": "x"},
            "preload_class: got 'x', expected light,",
        ),
        ({}, "bore: got nothing, expected a designation"),
    ],
)
def test_new_refuses_an_invalid_argument_in_one_line(numbers, problem):
    with pytest.raises(bearingwear.SceneError) as error:
        bearingwear.new(**numbers)
    assert str(error.value).startswith(problem)


def test_new_refuses_an_unknown_argument():
    with pytest.raises(TypeError, match="got 'balls_count', expected ball_diameter, "):
        bearingwear.new(bore=40, outside=68, balls_count=15)
    with pytest.raises(TypeError, match="got 'given', expected"):
        bearingwear.new(bore=40, outside=68, given={})


@pytest.mark.parametrize("name", ["gyro_s1", "010"])
def test_a_saved_scene_is_loaded_without_change(name, tmp_path):
    """The name 010, which other readers of YAML would take for a number, stays a text."""
    scene = replace(bearingwear.example(), name=name)
    path = tmp_path / "new" / "mine.yaml"
    bearingwear.save(scene, path)
    assert bearingwear.load(path) == scene
    assert main(["check", str(path)]) == 0


def test_save_refuses_a_suffix_that_does_not_fit_the_object(tmp_path):
    scene = bearingwear.example()
    with pytest.raises(
        OSError, match="a.nc: got a scene, expected a file name with the suffix .yaml"
    ):
        bearingwear.save(scene, tmp_path / "a.nc")
    with pytest.raises(
        OSError, match="a.yaml: got a dataset, expected a file name without the suffix .yaml"
    ):
        bearingwear.save(xr.Dataset(), tmp_path / "a.yaml")
    assert not list(tmp_path.iterdir())


# results


def test_races_and_axes_are_selected_by_name(scene):
    case = bearingwear.solve(scene)
    assert case.status == "ok"
    inner, outer = (case.contact_load.sel(race=race).item() for race in ("inner", "outer"))
    assert 0.0 < inner < outer  # the centrifugal force loads the outer race
    spin = case.ball_angular_velocity.sel(axis="tangential")
    assert spin.item() == pytest.approx(case.ball_angular_velocity.values[0, 1])


@pytest.mark.filterwarnings("ignore::UserWarning")  # of the scene, which is not the subject
@pytest.mark.parametrize("command", ["solve", "life"])
def test_a_function_gives_the_dataset_that_its_command_writes(command, scene, tmp_path):
    """A file that `save` writes has the same content, too."""
    by_command, saved = tmp_path / "command.nc", tmp_path / "saved.nc"
    settings = [f"{key}={value}" for key, value in COARSE.items()]
    assert main([command, str(S1), "-o", str(by_command), "--set", *settings]) == 0
    dataset = getattr(bearingwear, command)(scene)
    loaded = bearingwear.load(by_command)
    assert dataset.attrs.pop("wall_time_s") > 0.0
    xr.testing.assert_identical(dataset, loaded)
    bearingwear.save(loaded, saved)
    xr.testing.assert_identical(netcdf.load(by_command), netcdf.load(saved))


def test_an_unsolved_scene_issues_a_warning(scene):
    """It names the line of the caller; a solved scene issues none."""
    slippery = scene.with_({"friction.ball_race": 0.0})
    for function in (bearingwear.solve, bearingwear.life):
        with pytest.warns(UserWarning, match="^gyro_s1: undetermined: ") as caught:
            result = function(slippery)
        assert caught[0].filename == __file__
        assert result.attrs["message"] in str(caught[0].message)
        assert result.status == "undetermined"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bearingwear.solve(scene)


# figures


@pytest.mark.filterwarnings("ignore::UserWarning")  # of the scene, which is not the subject
def test_plot_draws_a_dataset_and_a_file_alike(scene, tmp_path):
    """It leaves the settings of Matplotlib as they were."""
    case = bearingwear.solve(scene)
    bearingwear.save(case, tmp_path / "case.nc")
    settings = dict(matplotlib.rcParams)
    of_dataset, of_file = bearingwear.plot(case), bearingwear.plot(tmp_path / "case.nc")
    assert of_dataset.get_suptitle() == of_file.get_suptitle()
    assert of_file.get_suptitle()
    for dataset_axes, file_axes in zip(of_dataset.axes, of_file.axes, strict=True):
        for dataset_line, file_line in zip(dataset_axes.lines, file_axes.lines, strict=True):
            np.testing.assert_array_equal(dataset_line.get_xydata(), file_line.get_xydata())
    assert dict(matplotlib.rcParams) == settings
    figure = bearingwear.plot.case(tmp_path / "case.nc")
    assert figure.get_suptitle() == of_dataset.get_suptitle()


@pytest.mark.filterwarnings("ignore::UserWarning")  # of the scene, which is not the subject
def test_plot_refuses_files_of_other_kinds(scene):
    life = bearingwear.life(scene)
    assert bearingwear.plot(life).axes and bearingwear.plot.life(life).axes
    with pytest.raises(CaseFileError, match="plot: got a file of kind life, expected case"):
        bearingwear.plot.case(life)
    with pytest.raises(CaseFileError, match="kind sweep, expected case, life"):
        bearingwear.plot(bearingwear.sweep(scene, {"operation.preload_N": [7]}, workers=1))


def test_plot_has_a_function_for_each_kind_of_file():
    names = {kind.replace(" ", "_") for kind in STUDY_PLOTS}
    assert {"case", "life", "study", "wear_life", "design_map"} <= names
    assert names <= set(dir(bearingwear.plot))
    for name in names:
        assert getattr(bearingwear.plot, name).__doc__
    with pytest.raises(AttributeError, match="got 'cases', expected case, life"):
        bearingwear.plot.cases  # noqa: B018


def test_an_unknown_fidelity_is_refused():
    with pytest.raises(ValueError, match="fidelity: got 'fancy', expected auto, race_control"):
        bearingwear.solve(bearingwear.example(), fidelity="fancy")
