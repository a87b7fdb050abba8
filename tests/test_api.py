"""bearingwear as a Python library."""

import warnings

import matplotlib
import numpy as np
import pytest
import xarray as xr
from support import scene_file

import bearingwear
from bearingwear.cli import main
from bearingwear.results import netcdf
from bearingwear.results.netcdf import CaseFileError
from bearingwear.scene.variant import variant

S1 = scene_file("gyro_s1")
COARSE = {"model.strips": 8, "model.tolerance": 1e-3}


@pytest.fixture(scope="module")
def scene():
    return bearingwear.load(S1).with_(COARSE)


def test_what_the_package_offers():
    assert set(bearingwear.__all__) <= set(dir(bearingwear))
    for name in bearingwear.__all__:
        assert getattr(bearingwear, name).__doc__
    with pytest.raises(AttributeError, match="no attribute 'solv'"):
        bearingwear.solv  # noqa: B018


# scenes


def test_a_scene_with_other_values(scene):
    changed = scene.with_({"operation.preload_N": 9, "cage": None})
    assert changed.operation.preload_N == 9.0 and changed.cage is None
    assert scene.operation.preload_N == 7.0 and scene.cage is not None
    with pytest.raises(bearingwear.SceneError) as error:
        scene.with_({"operation.preload_N": -9})
    assert str(error.value).startswith("operation.preload_N: given -9; allowed a number from 0")


def test_another_accuracy_sets_its_keys():
    """A scene holds what its own accuracy has decided; that shall not count as asked for."""
    fine = bearingwear.example().with_({"model.accuracy": "reference"})
    assert fine == variant(S1, {"model.accuracy": "reference"}) and fine.model.strips == 1000
    mine = bearingwear.example().with_({"model.strips": 60}).with_({"model.accuracy": "draft"})
    assert (mine.model.strips, mine.model.steady_starts) == (60, 2)


def test_example():
    assert bearingwear.example() == bearingwear.load(S1)


def test_new_is_that_of_the_command(tmp_path):
    argv = [str(tmp_path / "mine.yaml"), "--bore", "40", "--outside", "68", "--ball-diameter", "8"]
    assert main(["new", *argv, "--ball-material", "silicon_nitride"]) == 0
    made = bearingwear.new(
        bore=40, outside=68, ball_diameter=8, name="mine", ball_material="silicon_nitride"
    )
    typed = bearingwear.load(tmp_path / "mine.yaml")
    assert made.description.startswith(typed.description)
    assert "operation.shaft_speed_rpm: 19000, a million mm r/min" in made.description
    assert made.to_dict() | {"description": typed.description} == typed.to_dict()


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ({"bore": 40, "outside": 30}, "outside: given 30; allowed a number > 40, the bore"),
        ({"bore": 40, "outside": 68, "contact_angle": 95}, "contact_angle: given 95; allowed"),
        ({"bore": 40, "outside": 68, "ball_material": "wood"}, "ball_material: given 'wood'; all"),
        (
            {"designation": "7008C", "preload_class": "x"},
            "preload_class: given 'x'; allowed light,",
        ),
        ({"designation": "6008", "clearance": "C9"}, "clearance: given 'C9'; allowed C2, CN, C3"),
        ({"designation": "70"}, "designation: given '70'; allowed 70xx"),
        ({}, "bore: given nothing; allowed a designation"),
    ],
)
def test_new_refuses(numbers, said):
    with pytest.raises(bearingwear.SceneError) as error:
        bearingwear.new(**numbers)
    assert str(error.value).startswith(said)


def test_new_by_designation():
    made = bearingwear.new(designation="7008C", preload_class="medium")
    light = bearingwear.new(designation="7008C", preload_class="light")
    assert "ISO 15" in made.description and made.bearing.contact_angle_deg == 15.0
    assert made.operation.preload_N > light.operation.preload_N
    assert bearingwear.new(designation="6008", clearance="C3").bearing.contact_angle_deg > 0.0


def test_new_knows_its_arguments():
    with pytest.raises(TypeError, match="given 'balls_count'; allowed ball_diameter, "):
        bearingwear.new(bore=40, outside=68, balls_count=15)
    with pytest.raises(TypeError, match="given 'given'; allowed"):
        bearingwear.new(bore=40, outside=68, given={})


# results


def test_coordinates_by_name(scene):
    case = bearingwear.solve(scene)
    assert case.attrs["message"] == "solved and verified"
    inner, outer = (float(case.contact_load.sel(race=r).item()) for r in ("inner", "outer"))
    assert 0.0 < inner < outer  # by the centrifugal force
    spin = case.ball_angular_velocity.sel(axis="tangential")
    assert spin.item() == pytest.approx(case.ball_angular_velocity.values[0, 1])
    life = bearingwear.life(scene)
    assert (life.life.sel(counts="ball") > life.life.sel(counts="ball_and_races")).all()


@pytest.mark.parametrize("command", ["solve", "life"])
def test_files_of_the_command_and_back(command, scene, tmp_path):
    first, second = tmp_path / "first.nc", tmp_path / "second.nc"
    settings = [f"{key}={value}" for key, value in COARSE.items()]
    assert main([command, str(S1), "-o", str(first), "--set", *settings]) == 0
    made = getattr(bearingwear, command)(scene)
    read = bearingwear.load(first)
    assert made.attrs.pop("wall_time_s") > 0.0
    xr.testing.assert_identical(made, read)
    bearingwear.save(read, second)
    xr.testing.assert_identical(netcdf.load(first), netcdf.load(second))
    assert main(["compare", str(first), str(second)]) == 0


def test_what_is_not_solved_warns(scene):
    slippery = scene.with_({"friction.ball_race": 0.0})
    for function in (bearingwear.solve, bearingwear.life):
        with pytest.warns(UserWarning, match="^gyro_s1: undetermined: without friction") as told:
            made = function(slippery)
        assert told[0].filename == __file__
        assert made.attrs["message"].startswith("without friction") and made.status != 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bearingwear.solve(scene)


def test_load_refuses(tmp_path):
    (tmp_path / "a.nc").write_text("no file of ours")
    with pytest.raises(CaseFileError, match="a.nc: given a file that bearingwear has not written"):
        bearingwear.load(tmp_path / "a.nc")


# figures


def test_plot(scene, tmp_path):
    case = bearingwear.solve(scene)
    bearingwear.save(case, tmp_path / "case.nc")
    before = dict(matplotlib.rcParams)
    drawn, read = bearingwear.plot(case), bearingwear.plot(tmp_path / "case.nc")
    assert drawn.get_suptitle() == read.get_suptitle() != ""
    for one, other in zip(drawn.axes, read.axes, strict=True):
        for line, same in zip(one.lines, other.lines, strict=True):
            np.testing.assert_array_equal(line.get_xydata(), same.get_xydata())
    assert dict(matplotlib.rcParams) == before
    assert bearingwear.plot(bearingwear.life(scene)).axes
    with pytest.raises(CaseFileError, match="kind sweep; allowed case, life"):
        bearingwear.plot(bearingwear.sweep(scene, {"operation.preload_N": [7]}, workers=1))


def test_a_fidelity_that_is_none():
    with pytest.raises(ValueError, match="fidelity: given 'fancy'; allowed auto, race_control"):
        bearingwear.solve(bearingwear.example(), fidelity="fancy")
