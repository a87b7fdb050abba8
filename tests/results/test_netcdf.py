"""Results in files and in memory, from results made by hand: no solver is run here."""

import json
import os
import re
import time
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

from bearingwear.atomic import OutputError, write_text
from bearingwear.document.show import sheet
from bearingwear.kernels import status as code
from bearingwear.kernels.status import STATUS_NAMES, STATUS_SENTENCES
from bearingwear.kernels.steady.thrust import BRANCH_NAMES
from bearingwear.results import netcdf, variables
from bearingwear.results.netcdf import CaseFileError, dataset_of_result, load, write_result
from bearingwear.results.units import SCALES
from bearingwear.scene.blocks import CRITERIA, EndOfLife
from bearingwear.scene.read import load_scene
from bearingwear.solvers.result import Result

SCENE = Path(__file__).parents[2] / "config" / "scenes" / "gyro_s1.yaml"
SIZES = {"ball": 1, "race": 2, "axis": 3, "strip": 50, "steady_state": 2, "step": 4}
SIZES |= {"time": 6, "direction": 3, "edge": 2, "state": 7, "part": 5}
SIZES |= {"dof": 5, "dof_column": 5, "mode": 3}
SIZES |= {"groove_state": 2, "arc": 4, "band_place": 3, "phase": 3, "surface": 4}


def attributes() -> dict:
    """Returns attributes that every result has, of a steady case of gyro_s1."""
    return {
        "scene": json.dumps(load_scene(SCENE).to_dict()),
        "fidelity": "steady",
        "modelled": '["all"]',
        "n": 3,
        "phases": "cold nominal hot",
    }


NO_CRITERION = CRITERIA.index("none")


def random_values(table, sizes=SIZES) -> dict:
    """Returns random values of 0.5 to 1.5 for all variables of a table but those of a cage."""
    random = np.random.default_rng(1)
    values = {}
    for name, variable in table.items():
        if not name.startswith("cage_"):
            numbers = random.random(tuple(sizes[dim] for dim in variable.dims)) + 0.5
            values[name] = numbers.astype(int) if variable.dtype[0] == "i" else numbers
    if any("time" in table[name].dims for name in values):
        values["time"] = 1e-4 * np.arange(float(sizes["time"]))
    return values | {"status": code.OK}


@pytest.fixture
def case() -> Result:
    """Returns a solved case of random values."""
    return Result(random_values(variables.CASE), attributes(), 0.25)


@pytest.fixture
def life() -> Result:
    """Returns a life of random values."""
    return Result(random_values(variables.LIFE) | {"end_criterion": 1}, attributes(), 0.25)


@pytest.fixture(params=["case", "life", "failed case", "failed life", "nine balls"])
def result(request) -> Result:
    """Returns a result of each kind: solved or failed, a case or a life, and one of all balls."""
    if request.param == "nine balls":
        return Result(random_values(variables.CASE, SIZES | {"ball": 9}), attributes())
    if request.param == "failed case":
        return Result({"status": code.CONTACT_LOST, "ball_diameter_loss": [1e-7]}, attributes())
    if request.param == "failed life":
        values = {"status": code.NOT_CONVERGED, "end_criterion": NO_CRITERION}
        return Result(values, attributes())
    return request.getfixturevalue(request.param)


# file and dataset


def test_file_and_dataset_are_the_same(result, tmp_path):
    write_result(result, tmp_path / "x.nc")
    read, in_memory = load(tmp_path / "x.nc"), dataset_of_result(result)
    assert in_memory.attrs.pop("wall_time_s") == result.wall_time_s
    xr.testing.assert_identical(read, in_memory)
    for name, variable in read.variables.items():
        assert variable.dtype == in_memory.variables[name].dtype, name


def test_changes_of_a_dataset_do_not_reach_others(case):
    """Datasets of like cases share their indexes, and nothing else."""
    changed, kept = dataset_of_result(case, by_name=True), dataset_of_result(case, by_name=True)
    expected = kept.copy(deep=True)
    changed["strip_position"][0] = 7.0
    changed["race"].attrs["mine"] = 1
    changed["race"] = ["first", "second"]
    changed["qv"][...] = 0.0
    assert kept.identical(expected) and dataset_of_result(case, by_name=True).identical(expected)


def test_the_same_result_gives_the_same_bytes(result, tmp_path):
    write_result(result, tmp_path / "a.nc")
    if result.wall_time_s:
        time.sleep(1.1)  # were times of change stored, they would be whole seconds
    result.wall_time_s += 1.0
    write_result(result, tmp_path / "b.nc")
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_a_file_has_angles_in_degrees_and_other_values_in_si_units(case, tmp_path):
    case.values["contact_angle"] = np.radians([[20.0, 19.0]])
    write_result(case, tmp_path / "x.nc")
    with netCDF4.Dataset(tmp_path / "x.nc") as file:
        assert file["contact_angle"].units == "degree"
        assert file["contact_angle"][0].data == pytest.approx([20.0, 19.0])
        assert file["contact_load"][...].data == pytest.approx(case.values["contact_load"])


def test_case_file_follows_the_contract(case, tmp_path):
    """Names, dimensions and units that others rely on."""
    contract = {
        ("ball", "race"): {
            "contact_load": "N", "contact_angle": "degree", "semi_major_axis": "m",
            "semi_minor_axis": "m", "maximum_pressure": "Pa", "qv": "W", "friction_heat": "W",
            "spin_to_roll_ratio": "1", "gyroscopic_slip_share": "1",
        },
        ("ball", "race", "strip"): {"gyroscopic_slip": "m s-1", "rolling_slip": "m s-1"},
        ("strip",): {"strip_position": "1"},
        ("ball", "axis"): {"ball_angular_velocity": "rad s-1"},
        ("ball",): {"orbit_speed": "rad s-1", "ball_wear_rate": "m3 s-1"},
        ("race",): {"race_wear_rate": "m3 s-1"},
        (): {
            "residual_preload": "N", "axial_displacement": "m", "total_qv": "W",
            "shaft_torque": "N m", "drag_power": "W", "axial_stiffness": "N m-1",
        },
    }  # fmt: skip
    write_result(case, tmp_path / "x.nc")
    with netCDF4.Dataset(tmp_path / "x.nc") as file:
        assert file.data_model == "NETCDF4"
        for dims, names in contract.items():
            for name, units in names.items():
                assert file[name].dimensions == dims, name
                assert file[name].units == units, name
        assert file["status"].flag_meanings.split() == list(STATUS_NAMES)
        assert file["race"].flag_meanings == "inner outer"
        assert file["axis"].flag_meanings == "axial tangential radial"
        assert file["ball"].represents == 9
        assert file["strip_position"][0] == pytest.approx(-0.98)  # the middle of the first of 50


def test_every_variable_has_a_name_and_units_or_flags(result, tmp_path):
    """Either units, or flags of one byte; floats have a fill value, except for coordinates.

    The CF conventions require it.
    """
    write_result(result, tmp_path / "x.nc")
    with netCDF4.Dataset(tmp_path / "x.nc") as file:
        for name, variable in file.variables.items():
            attrs = variable.ncattrs()
            assert "long_name" in attrs
            if "flag_meanings" in attrs:
                meanings = variable.flag_meanings.split()
                assert len(variable.flag_values) == len(meanings)
                assert variable.flag_values.dtype == variable.dtype == np.int8
                assert "units" not in attrs
            else:
                assert "units" in attrs
            is_coordinate = name in (*variables.COORDINATES, "strip_position")
            assert ("_FillValue" in attrs) == (variable.dtype.kind == "f" and not is_coordinate)


def test_the_file_of_an_unsolved_case_contains_fill_values(tmp_path):
    write_result(Result({"status": code.NOT_CONVERGED}, attributes()), tmp_path / "x.nc")
    with netCDF4.Dataset(tmp_path / "x.nc") as file:
        for name, variable in variables.CASE.items():
            assert (name in file.variables) == (variable.always or name == "status"), name
            if variable.always:
                assert file[name][...].mask.all(), name
        assert file["gyroscopic_slip"].shape == (1, 2, 50)
        assert int(file["status"][...]) == code.NOT_CONVERGED


def test_a_value_that_is_in_no_table_of_variables_is_refused(case):
    case.values["contact_laod"] = 1.0
    with pytest.raises(KeyError, match="contact_laod"):
        dataset_of_result(case)


@pytest.mark.parametrize(
    ("shape", "problem"),
    [
        ((2,), "contact_load has 1 dimensions, not 2"),
        ((1, 2, 1), "contact_load has 3 dimensions, not 2"),
        ((1, 3), "contact_load has shape (1, 3), not (1, 2)"),
    ],
)
def test_wrong_shape_is_refused(case, shape, problem):
    """Loads are by ball and race. The size of a dimension is that of the last value that has it."""
    case.values["contact_load"] = np.zeros(shape)
    with pytest.raises(ValueError, match=f"^{re.escape(problem)}$"):
        dataset_of_result(case)


def test_long_histories_are_compressed(life, tmp_path, monkeypatch):
    monkeypatch.setattr(netcdf, "COMPRESSED_ABOVE", 5)
    write_result(life, tmp_path / "x.nc")
    with netCDF4.Dataset(tmp_path / "x.nc") as file:
        assert file["history_qv"].filters()["zlib"]
        assert not file["life"].filters()["zlib"]


# the table


def test_flags_agree_with_the_model():
    assert variables.BRANCHES == BRANCH_NAMES
    assert CRITERIA == (*vars(EndOfLife()), "none")
    assert set(STATUS_SENTENCES) == set(STATUS_NAMES)


@pytest.mark.parametrize("table", [variables.CASE, variables.LIFE], ids=["case", "life"])
def test_the_table_of_variables_is_consistent(table):
    for name, variable in table.items():
        assert variable.name == name and variable.long_name
        assert bool(variable.units) != bool(variable.flags)
        assert set(variable.dims) <= set(variables.COORDINATES)
        assert variable.dtype[0] == "f" or not variable.always or variable.flags[-1] == "none"
        assert variable.scale == 1.0 or variable.units in ("degree", "h")
        assert not variable.shown or variable.shown in SCALES


# files that cannot be read


def refused(reader, path, problem) -> None:
    """Asserts that a reader refuses a file in one line that names it and matches `problem`."""
    with pytest.raises(CaseFileError, match=problem) as caught:
        reader(path)
    assert str(caught.value).startswith(f"{path}: got ") and "\n" not in str(caught.value)


@pytest.mark.parametrize("reader", [load, sheet])
@pytest.mark.parametrize(
    ("contents", "problem"),
    [
        (b"", "empty"),
        (b"status: ok\n", "not written by"),
        (b"\x89HDF\r\n\x1a\n" + b"\0" * 100, "damaged"),
        (b"CDF\x01" + b"\0" * 28, "not written by"),
    ],
    ids=["empty", "text", "header of HDF5 alone", "classic netCDF"],
)
def test_a_file_with_other_contents_is_refused(reader, contents, problem, tmp_path):
    path = tmp_path / "x.nc"
    path.write_bytes(contents)
    refused(reader, path, problem)


@pytest.mark.parametrize("reader", [load, sheet])
def test_a_missing_file_and_a_folder_are_refused(reader, tmp_path):
    refused(reader, tmp_path / "missing.nc", "cannot be read")
    (tmp_path / "folder.nc").mkdir()
    refused(reader, tmp_path / "folder.nc", "got a folder, expected a result file$")


@pytest.mark.parametrize("reader", [load, sheet])
def test_a_file_of_another_program_is_refused(reader, tmp_path):
    xr.Dataset({"temperature": 3.0}).to_netcdf(tmp_path / "x.nc", engine="netcdf4")
    refused(reader, tmp_path / "x.nc", "not written by")


@pytest.mark.parametrize("reader", [load, sheet])
@pytest.mark.parametrize("share", [0.05, 0.3, 0.6, 0.99])
def test_a_truncated_file_is_refused(reader, share, case, tmp_path):
    path = tmp_path / "x.nc"
    write_result(case, path)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    refused(reader, path, "damaged")


@pytest.mark.parametrize("reader", [load, sheet])
def test_a_file_name_that_is_not_utf8_is_refused(reader, case, tmp_path):
    write_result(case, tmp_path / "a.nc")
    (tmp_path / "a.nc").rename(tmp_path / "\udcff.nc")
    with pytest.raises(CaseFileError, match="UTF-8"):
        reader(tmp_path / "\udcff.nc")


# writing


def test_an_open_file_is_replaced_and_not_changed(case, tmp_path):
    path = tmp_path / "x.nc"
    write_result(case, path)
    with netCDF4.Dataset(path) as opened:
        case.values["total_qv"] = 42.0
        write_result(case, path)
        assert opened["total_qv"][...] != 42.0
    assert float(load(path)["total_qv"]) == 42.0


@pytest.mark.parametrize(
    "stop", [KeyboardInterrupt, MemoryError, RuntimeError("NetCDF: HDF error")]
)
def test_interrupted_writing_leaves_the_old_file(case, stop, tmp_path, monkeypatch):
    """An error of the netCDF library becomes an OutputError; the other exceptions pass on."""
    path = tmp_path / "x.nc"
    path.write_bytes(b"old")

    def interrupted(*_):
        raise stop

    monkeypatch.setattr(netcdf, "_write_contents", interrupted)
    with pytest.raises(OutputError if isinstance(stop, RuntimeError) else stop):
        write_result(case, path)
    assert os.listdir(tmp_path) == ["x.nc"] and path.read_bytes() == b"old"


@pytest.mark.parametrize("command", ["write_result", "write_text"])
def test_a_file_marked_read_only_stays(command, case, tmp_path):
    path = tmp_path / "x.nc"
    path.write_bytes(b"kept")
    path.chmod(0o444)
    with pytest.raises(OutputError) as caught:
        write_result(case, path) if command == "write_result" else write_text(path, "new")
    assert str(caught.value) == f"{path}: got a read-only file, expected a different file name"
    assert os.listdir(tmp_path) == ["x.nc"] and path.read_bytes() == b"kept"


def test_a_folder_that_cannot_be_made_is_refused_in_one_line(case, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be written") as caught:
        write_result(case, tmp_path / "file" / "x.nc")
    assert "\n" not in str(caught.value)
