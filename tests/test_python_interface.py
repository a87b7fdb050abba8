"""The functions of `bearingwear` against its commands, and their datasets read by plain xarray."""

import json

import pytest
import xarray as xr
from support import scene_file, warm_spindle

import bearingwear
from bearingwear.applications.cage import ensemble
from bearingwear.applications.cage.ensemble import MEANS
from bearingwear.cli import main
from bearingwear.document.data import as_json

S1 = str(scene_file("gyro_s1"))
DRAFT = {"model.accuracy": "draft"}
GRAVITY = 9.80665


@pytest.fixture(scope="module")
def scene():
    """Returns the scene gyro_s1 with a draft accuracy."""
    return bearingwear.load(S1).with_(DRAFT)


@pytest.fixture(scope="module")
def rotor_file(tmp_path_factory):
    """Returns a scene file of a rotor on a pair, with a drive, a launch and a cold case."""
    spindle = bearingwear.new("7008C", preload=140, preload_method="fixed_position").with_(
        {
            "arrangement": {
                "kind": "rigid_pair",
                "orientation": "back_to_back",
                "rotor_mass_kg": 3.0,
                "span_mm": 100.0,
            },
            "launch.axial_g": 60.0,
            "launch.radial_g": 20.0,
            "drive.torque_Nm": 0.3,
            "cases": {"cold": {"friction.ball_race": 0.1}},
        }
    )
    path = tmp_path_factory.mktemp("rotor") / "rotor.yaml"
    bearingwear.save(spindle, path)
    return path


def assert_read_by_xarray(dataset, folder):
    """Asserts that xarray alone writes and reads a dataset without change."""
    dataset.to_netcdf(folder / "plain.nc")
    with xr.open_dataset(folder / "plain.nc", decode_timedelta=False) as read:
        xr.testing.assert_identical(read.load().drop_encoding(), dataset)


def printed_json(capsys, *argv, status=0):
    """Returns the JSON that a command prints, which must end with an exit status."""
    capsys.readouterr()
    assert main([*map(str, argv), "--json"]) == status
    return json.loads(capsys.readouterr().out)


def assert_same_as_command(dataset, folder, *words):
    """Asserts that a dataset is that of the file which a command writes."""
    path = folder / "command.nc"
    assert main([*map(str, words), "-o", str(path), "--quiet"]) == 0
    xr.testing.assert_identical(bearingwear.load(path), dataset)
    assert_read_by_xarray(dataset, folder)


def values_by_name(values):
    """Returns the values along one dimension by the names of its coordinate."""
    return dict(zip(values[values.dims[0]].values.tolist(), values.values.tolist(), strict=True))


def test_tab_lists_only_the_public_names():
    assert dir(bearingwear) == sorted(bearingwear.__all__)
    assert set(dir(bearingwear)) >= {"recommend", "uncertainty", "launch", "margin", "calibrate"}
    for name in bearingwear.__all__:
        assert getattr(bearingwear, name).__doc__, name


def test_a_case_of_a_scene_is_solved_like_the_option_case(rotor_file, tmp_path):
    """Both have the same values and as many warnings."""
    scene = bearingwear.load(rotor_file).case("cold")
    assert scene.friction.ball_race == 0.1 and scene.cases is None
    solve = ["solve", str(rotor_file), "--case", "cold", "--quiet", "-o", str(tmp_path / "cold.nc")]
    assert main(solve) == 0
    with pytest.warns(UserWarning) as caught:
        by_function = bearingwear.solve(scene)
    by_command = bearingwear.load(tmp_path / "cold.nc")
    assert by_command.equals(by_function)
    warnings_in_file = json.loads(by_command.attrs["warnings"])
    assert warnings_in_file and len(caught) == len(warnings_in_file)


def test_an_unknown_case_of_a_scene_is_refused(rotor_file):
    with pytest.raises(bearingwear.SceneError, match="^case: got hot, expected nominal, cold$"):
        bearingwear.load(rotor_file).case("hot")


def test_recommend_gives_what_its_command_prints(scene, capsys, tmp_path):
    sheet = printed_json(capsys, "recommend", S1, "--set", "model.accuracy=draft", "--stiffness", 3)
    dataset = bearingwear.recommend(scene, stiffness=3)
    assert_read_by_xarray(dataset, tmp_path)
    assert json.loads(as_json(bearingwear.show(dataset))) == sheet
    assert dataset.preload.sel(preload_method="constant_force") > 0.0


def test_recommend_without_a_requirement_is_a_design_map(scene, capsys, tmp_path):
    assert printed_json(capsys, "recommend", S1, "--set", "model.accuracy=draft")
    dataset = bearingwear.recommend(scene)
    assert_read_by_xarray(dataset, tmp_path)
    assert dataset.attrs["kind"] == "design map" and dataset.sizes["preload"] > 5


def test_a_requirement_that_no_preload_satisfies_gives_nan_and_a_warning(scene):
    with pytest.warns(UserWarning, match="gyro_s1: no preload"):
        dataset = bearingwear.recommend(scene, stiffness=900)
    assert dataset.preload.size and dataset.preload.isnull().all()


def test_a_misspelt_requirement_is_named(scene):
    with pytest.raises(TypeError, match="recommend: got 'stifness', expected .*stiffness"):
        bearingwear.recommend(scene, stifness=3)


def test_a_negative_requirement_is_refused(scene):
    with pytest.raises(bearingwear.SceneError) as error:
        bearingwear.recommend(scene, stiffness=-3)
    assert "got -3, expected a number" in str(error.value)


def test_uncertainty_gives_what_its_command_writes(scene, tmp_path):
    dataset = bearingwear.uncertainty(scene, samples=8, seed=2)
    path = tmp_path / "draft.yaml"
    bearingwear.save(scene, path)
    options = "--samples", "8", "--seed", "2"
    assert_same_as_command(dataset, tmp_path, "uncertainty", path, *options)


def test_launch_gives_what_its_command_prints(rotor_file, capsys, tmp_path):
    """The sheet of the dataset, which xarray alone can read, is the one that is printed."""
    sheet = printed_json(capsys, "launch", rotor_file)
    dataset = bearingwear.launch(rotor_file)
    assert_read_by_xarray(dataset, tmp_path)
    assert json.loads(as_json(bearingwear.show(dataset))) == sheet


def test_launch_gives_in_si_units_what_its_sheet_shows(rotor_file):
    """Blocks of the sheet are `rotor, STATE` and `bearing N, STATE`, with a column per load."""
    dataset = bearingwear.launch(rotor_file)
    factors = {"um": 1e6, "mrad": 1e3, "GPa": 1e-9, "N": 1.0, "": 1.0}
    compared = set()
    for row in json.loads(as_json(bearingwear.show(dataset)))["quantities"]:
        name, (part, _, state) = row["name"], row["block"].partition(", ")
        if name.endswith("_g"):
            values = dataset[f"{name.removesuffix('_g')}_acceleration"] / GRAVITY
        elif part == "rotor":
            values = dataset[name].sel(state=state) * factors[row["unit"]]
        elif part in ("bearing 1", "bearing 2"):
            number = int(part.removeprefix("bearing "))
            values = dataset[name].sel(state=state, bearing=number) * factors[row["unit"]]
        else:
            continue  # natural frequencies
        assert row["values"] == pytest.approx(values_by_name(values), rel=1e-9, abs=1e-9), name
        compared.add(name)
    assert {"opening_g", "denting_g", "axial_force", "shift", "gap", "pressure_inner"} <= compared


def test_arguments_of_launch_replace_accelerations_of_the_scene(rotor_file):
    """The scene has 60 g."""
    force, larger_force = (
        dataset.axial_force.values[0, 0]
        for dataset in (bearingwear.launch(rotor_file), bearingwear.launch(rotor_file, axial=90.0))
    )
    assert larger_force == pytest.approx(1.5 * force)


def test_launch_refuses_a_scene_without_a_rotor():
    with pytest.raises(bearingwear.SceneError, match="arrangement.rotor_mass_kg: got nothing"):
        bearingwear.launch(S1)


def test_margin_gives_what_its_command_prints(rotor_file, capsys, tmp_path):
    """The sheet of the dataset, which xarray alone can read, is the one that is printed."""
    sheet = printed_json(capsys, "margin", rotor_file, "--drive", "0.5")
    dataset = bearingwear.margin(rotor_file, drive=0.5)
    assert_read_by_xarray(dataset, tmp_path)
    assert json.loads(as_json(bearingwear.show(dataset))) == sheet


def test_margin_gives_in_si_units_what_its_sheet_shows(rotor_file):
    """A corner is one of 2 cases, new or worn, with one of the frictions; it has a row.

    Torques of the sheet have one unit, margins are in %.
    """
    dataset = bearingwear.margin(rotor_file, drive=0.5)
    rows = json.loads(as_json(bearingwear.show(dataset)))["quantities"]
    assert len(rows) == dataset.sizes["corner"]
    assert len(rows) == 2 * 2 * 3  # three frictions: the nominal one, and the ends of its interval
    factors = {"N m": 1.0, "N mm": 1e3, "mN m": 1e3}
    for k, row in enumerate(rows):
        corner = dataset.isel(corner=k)
        assert row["name"].startswith(f"{corner.case.item()}, {corner.wear.item()}, friction ")
        (torque_head, torque), (_, required), (_, margin) = row["values"].items()
        factor = factors[torque_head.removeprefix("torque, ")]
        assert torque == pytest.approx(factor * corner.torque.item(), rel=1e-9)
        assert required == pytest.approx(factor * corner.required_torque.item(), rel=1e-9)
        assert margin == pytest.approx(100.0 * corner.torque_margin.item(), rel=1e-9)


def test_a_torque_margin_is_the_drive_torque_over_the_required_one_less_one(rotor_file):
    dataset = bearingwear.margin(rotor_file, drive=0.5)
    expected = 0.5 / dataset.required_torque - 1.0
    assert dataset.torque_margin.values == pytest.approx(expected.values, rel=1e-12)


def test_margin_refuses_a_scene_without_a_drive():
    with pytest.raises(bearingwear.SceneError, match="gyro_s1: drive: got nothing, expected"):
        bearingwear.margin(S1)


def test_calibrate_gives_what_its_command_writes(tmp_path, capsys):
    spread = {
        "uncertainty.wear_coefficient": {"distribution": "lognormal", "factor": 3.0},
        "uncertainty.wear_scatter": {"distribution": "lognormal", "factor": 1.3},
    }
    scene, tests = tmp_path / "scene.yaml", tmp_path / "tests.csv"
    bearingwear.save(bearingwear.load(S1).with_(DRAFT | spread), scene)
    tests.write_text("life_h\n1.2\n1.6\n")
    calibration = bearingwear.calibrate(scene, tests)
    assert main(["calibrate", str(scene), str(tests), "-o", str(tmp_path / "new.yaml")]) == 0
    xr.testing.assert_identical(bearingwear.load(tmp_path / "new.nc"), calibration.data)
    assert bearingwear.load(tmp_path / "new.yaml") == calibration.scene
    assert_read_by_xarray(calibration.data, tmp_path)


def test_cage_gives_what_its_command_writes(tmp_path, monkeypatch):
    """Its runs are not solved here: their results follow from their draws."""

    def run_without_solving(scene, start, least_turns, most_turns):
        work = {"work": scene.friction.cage * (1.0 + start.offset), "turns": float(most_turns)}
        return dict.fromkeys(MEANS, 0.5) | work | {"status": 0, "motion": 1, "centre": [0.0, 1.0]}

    monkeypatch.setattr(ensemble, "cage_run", run_without_solving)
    dataset = bearingwear.cage(S1, runs=60, within=0.2, seed=3, turns=50)
    options = "--runs", "60", "--within", "0.2", "--seed", "3", "--turns", "50", "-j", "1"
    assert_same_as_command(dataset, tmp_path, "cage", S1, *options)
    assert dataset.turns.values.tolist() == [50.0] * dataset.sizes["run"]


def test_warmup_gives_what_its_command_writes(tmp_path):
    path = tmp_path / "spindle.yaml"
    bearingwear.save(warm_spindle(), path)
    dataset = bearingwear.warmup(path, seconds=20.0)
    assert_same_as_command(dataset, tmp_path, "warmup", path, "--seconds", "20")


def test_new_takes_a_designation(tmp_path):
    assert main(["new", str(tmp_path / "bearing.yaml"), "7008C"]) == 0
    by_command = bearingwear.load(tmp_path / "bearing.yaml")
    by_function = bearingwear.new("7008C")
    description = {"description": by_command.description}
    assert by_function.to_dict() | description == by_command.to_dict()


def test_new_refuses_what_is_no_designation():
    with pytest.raises(TypeError, match="new: got 40, expected a designation such as '7008C'"):
        bearingwear.new(40)
    with pytest.raises(bearingwear.SceneError, match="^designation: got "):
        bearingwear.new("70x8")
