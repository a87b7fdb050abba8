"""Gathering, figures and tables of cases solved dynamically, with cases made up here."""

import csv
import json

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose
from support import ROOT, only_line, scene_file, step

from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.scene.read import variant
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.grid.figures.dynamic import mean_so_far, running_average_figure
from bearingwear.studies.grid.gather import gathered_study
from bearingwear.studies.grid.grid import Case, Grid
from bearingwear.studies.unsolved import unsolved_lines

STEADY = Grid.from_lists(PRELOAD_METHODS, [0.02, 0.05, 0.08], [0.0, 0.1, 0.5, 0.7])
DYNAMIC = Grid.from_lists(PRELOAD_METHODS, [0.02, 0.08], [0.0, 0.5, 0.7])
NOT_CONVERGED = 1  # status
# steps
GATHER = "studies.grid.gather.gathered_study"
TABLES = "studies.grid.dynamic_tables.dynamic_comparison"
COMPARED = "studies.grid.figures.draw.draw_dynamic"
AVERAGE = "studies.grid.figures.draw.draw_running_average"
# names of the flags of variables
FLAGS = {
    "status": "ok not_converged",
    "race": "inner outer",
    "edge": "at_negative_x at_positive_x",
    "direction": "axial Y Z",
}


def flag(name, dims, values):
    """Returns a variable of a dataset, (dims, codes, attributes), with the names of FLAGS."""
    meanings = FLAGS[name].split()
    values = np.asarray(values, dtype=np.int8)
    attrs = {"flag_values": np.arange(len(meanings), dtype=np.int8), "flag_meanings": FLAGS[name]}
    return (dims, values, attrs)


# attributes of variables
ONE, WATT, WEAR_RATE = {"units": "1"}, {"units": "W"}, {"units": "m3 s-1"}


def invented_case(case: Case, scene="gyro_s1", fidelity="steady", status=0, **changes):
    """Returns the dataset of a case file with plausible numbers.

    QV is 1.4 W and wear rates are some 1e-16 m3/s, times 0.9 + friction, times the share of the
    preload that is left. A fixed position loses 1.2 of it per um of loss. Dynamic numbers are 1 %
    higher.

    status: a case that was not solved has no numbers. changes: of attributes.
    """
    is_dynamic = fidelity == "dynamic"
    plain = variant(scene_file(scene), case.changes).to_dict()
    n = plain["bearing"]["ball_count"] if is_dynamic else 1
    is_fixed = case.preload_method == "fixed_position"
    left = 1.0 - (1.2 * case.ball_diameter_loss_um if is_fixed else 0.0)
    size = (1.01 if is_dynamic else 1.0) * left * (0.9 + case.friction)
    values = {
        "total_qv": ((), 1.4 * size, WATT),
        "qv": (("ball", "race"), np.full((n, 2), 0.07 * size), WATT),
        "residual_preload": ((), 7.0 * left, {"units": "N"}),
        "ball_wear_rate": (("ball",), np.full(n, 1e-17 * size), WEAR_RATE),
        "race_wear_rate": (("race",), np.array([2e-16, 3e-16]) * size, WEAR_RATE),
    }
    coords = {"ball": np.arange(n), "race": flag("race", ("race",), [0, 1])}
    if status:  # as the solver writes it: all NaN, and without the values of the dynamic model
        values = {
            name: (dims, np.full_like(numbers, np.nan), attrs)
            for name, (dims, numbers, attrs) in values.items()
        }
    elif is_dynamic:
        dynamic_values, dynamic_coords = invented_run(size, n, drift=0.02 if is_fixed else 0.0)
        values |= dynamic_values
        coords |= dynamic_coords
    values["status"] = flag("status", (), status)
    attrs = {name: "1" for name in ("source_hash", "package_version", "numpy_version")}
    attrs |= {"scene": json.dumps(plain), "fidelity": fidelity, "numba_version": "1"}
    attrs |= {"source": "bearingwear 1", "Conventions": "CF-1.11"}
    return xr.Dataset(values, coords, attrs | changes)


def invented_run(size, ball_count, drift):
    """Returns the further variables and coordinates of a case that is solved dynamically.

    Histories settle on the means of the case.

    size: factor of wear rates, as in `invented_case`. drift: of the wear rate per turn [1].
    """
    time = np.linspace(1e-4, 0.04, 400)
    settling = size * (1.0 + 2.0 * np.exp(-time / 0.004) + 0.3 * np.sin(3e3 * time))
    ball_rates = np.repeat((1e-17 * settling)[:, None], ball_count, axis=1)
    values = {
        "simulated_turns": ((), 20.0, ONE),
        "evaluated_turns": ((), 10.0, ONE),
        "qv_drift_per_turn": ((), 1e-4, ONE),
        "wear_rate_drift_per_turn": ((), drift, ONE),
        "steps_accepted": ((), np.int32(1000), ONE),
        "final_state": (("state",), np.arange(7.0), ONE),
        "final_time": ((), 0.04, {"units": "s"}),
        "cage_wear_rate": ((), 4e-15 * size, WEAR_RATE),
        "cage_land_wear_rate": ((), 5e-17 * size, WEAR_RATE),
        "history_cage_pocket_wear_rate": (("time",), (4e-15 * settling).astype("f4"), WEAR_RATE),
        "history_cage_land_wear_rate": (("time",), (5e-17 * settling).astype("f4"), WEAR_RATE),
        "history_ball_wear_rate": (("time", "ball"), ball_rates.astype("f4"), WEAR_RATE),
        "history_land_force": (("time", "edge"), np.zeros((400, 2), dtype="f4"), {"units": "N"}),
    }
    edge = flag("edge", ("edge",), [0, 1])
    return values, {"time": ("time", time, {"units": "s"}), "edge": edge}


def write_cases(folder, grid, fidelity, failed=(), **changes):
    """Writes invented case files of a grid, and returns their paths.

    failed: names of cases that were not solved.
    """
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for case_id, case in grid.cases().items():
        status = NOT_CONVERGED if case_id in failed else 0
        case_file = invented_case(case, fidelity=fidelity, status=status, **changes)
        case_file.to_netcdf(folder / f"{case_id}.nc")
        paths.append(folder / f"{case_id}.nc")
    return paths


FAILED = ("fixed_position-mu0.020-loss0.70", "fixed_position-mu0.080-loss0.70")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Returns the folder of a study, `study.nc`, and of some of its cases solved dynamically.

    These are in `dynamic.nc`. There both cases of FAILED are not solved, in the study the first.
    """
    folder = tmp_path_factory.mktemp("both")
    for grid, fidelity, cases, file in (
        (STEADY, "steady", "cases", "study.nc"),
        (DYNAMIC, "dynamic", "dynamic", "dynamic.nc"),
    ):
        failed = FAILED if fidelity == "dynamic" else FAILED[:1]
        paths = write_cases(folder / cases, grid, fidelity, failed)
        assert step(GATHER, folder / file, paths=paths) == 0
    return folder


def steady_and_dynamic(folder):
    """Returns the paths of the study and of its dynamic cases, by the arguments of steps."""
    return {"study": folder / "study.nc", "dynamic": folder / "dynamic.nc"}


# gathering and verdict


def test_a_study_of_dynamic_cases_holds_their_means_without_histories(folder):
    """It has means of each of nine balls, without the dimensions and variables of a run in time.

    Cases that were not solved have NaN.
    """
    gathered = load(folder / "dynamic.nc")
    assert gathered.attrs["fidelity"] == "dynamic"
    assert gathered.sizes["ball"] == 9
    assert not {"time", "state", "edge"} & set(gathered.dims)
    assert "final_time" not in gathered and "history_ball_wear_rate" not in gathered
    assert gathered["cage_wear_rate"].dims == ("preload_method", "friction", "ball_diameter_loss")
    failed = gathered.sel(preload_method=1, ball_diameter_loss=0.7)
    assert np.all(failed["status"] == NOT_CONVERGED) and np.all(np.isnan(failed["cage_wear_rate"]))


def test_steady_and_dynamic_cases_are_not_mixed(folder, tmp_path):
    """A steady file among dynamic ones is named."""
    paths = write_cases(tmp_path, DYNAMIC, "dynamic")
    invented_case(DYNAMIC.cases()[paths[3].stem]).to_netcdf(paths[3])
    with pytest.raises(CaseFileError, match=f"{paths[3].name}: fidelity differs from"):
        gathered_study(paths)


def test_the_verdict_names_unsolved_files_of_steady_and_dynamic_cases(folder):
    """It names the files of unsolved cases, and counts all cases of both studies."""
    checked, unsolved = unsolved_lines([folder / "study.nc", folder / "dynamic.nc"])
    assert checked == len(STEADY.cases()) + len(DYNAMIC.cases())
    assert [line.partition(": ")[0] for line in unsolved] == [
        str(folder / "cases" / f"{FAILED[0]}.nc"),
        *(str(folder / "dynamic" / f"{case_id}.nc") for case_id in FAILED),
    ]


# beside the steady cases


def test_tables_compare_steady_and_dynamic_cases(folder, tmp_path):
    """Numbers of the first case follow from `invented_case`; cells of unsolved cases are empty.

    The wear rate of fixed positions drifts by 2 % per turn, so by 20 % over ten evaluated turns.
    """
    outputs = [tmp_path / "dynamic.csv", tmp_path / "dynamic.md"]
    assert step(TABLES, *outputs, **steady_and_dynamic(folder)) == 0
    with outputs[0].open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 12
    first = rows[0]
    steady = float(first["total_qv.steady (W)"])
    assert_allclose(steady, 1.4 * 0.92, rtol=1e-8)  # friction 0.02
    assert_allclose(float(first["total_qv.dynamic (W)"]), 1.01 * steady, rtol=1e-8)
    assert_allclose(float(first["race_wear_rate.dynamic.outer (m3 s-1)"]), 3.03e-16 * 0.92)
    assert first["status.steady"] == first["status.dynamic"] == "ok"
    assert rows[-1]["status.steady"] == "ok" and rows[-1]["total_qv.steady (W)"]
    assert rows[-1]["status.dynamic"] == "not_converged" and not rows[-1]["cage_wear_rate (m3 s-1)"]
    text = outputs[1].read_text(encoding="utf-8")
    assert "| constant force | 0.02 | 0 | 1.29 | 1.3 | 1 | 7 | 7 |" in text
    assert "| QV, steady (W) |" in text and "land (mm³/1000\N{NO-BREAK SPACE}h) |" in text
    assert "nan" not in text + outputs[0].read_text(encoding="utf-8")
    assert text.count("drifts by +20 %") == 4  # of six fixed positions, those solved
    assert text.count("dynamic: not converged") == 2 and text.count("steady: not converged") == 1


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("has_cage", [True, False], ids=["not solved", "no cage"])
def test_a_case_that_is_not_solved_or_without_a_cage_is_drawn_and_tabulated(
    folder, has_cage, tmp_path
):
    """A single case has a cage but is not solved, or is solved but has no cage.

    Its table names no cage and has no NaN.
    """
    grid = Grid.from_lists(PRELOAD_METHODS[:1], [0.08], [0.0])
    failed = tuple(grid.cases()) if has_cage else ()
    (path,) = write_cases(tmp_path, grid, "dynamic", failed)
    if not has_cage:
        case = load(path)
        path.unlink()
        case.drop_vars([name for name in case if "cage" in name]).to_netcdf(path)
    assert step(GATHER, tmp_path / "dynamic.nc", paths=[path]) == 0
    files = {"study": folder / "study.nc", "dynamic": tmp_path / "dynamic.nc"}
    assert step(COMPARED, tmp_path / "a.svg", **files) == 0
    assert step(AVERAGE, tmp_path / "b.svg", case=path) == 0
    assert step(TABLES, tmp_path / "a.csv", tmp_path / "a.md", **files) == 0
    text = (tmp_path / "a.md").read_text(encoding="utf-8")
    assert "cage" not in text and "nan" not in text


def test_files_that_do_not_belong_together_are_refused_in_one_line(folder, tmp_path, capsys):
    """Refused are steady cases in place of dynamic ones, other frictions, and another scene.

    A running average is refused for a study and for a case that was not solved. Nothing is drawn.
    """
    steady, dynamic = steady_and_dynamic(folder).values()
    output = tmp_path / "a.svg"
    assert step(COMPARED, output, study=steady, dynamic=steady) == 2
    problem = "got cases that were not solved dynamically, expected dynamic cases"
    assert capsys.readouterr().err == f"{steady}: {problem}\n"
    paths = write_cases(tmp_path / "few", Grid.from_lists(PRELOAD_METHODS, [0.02], [0.0]), "steady")
    assert step(GATHER, tmp_path / "few.nc", paths=paths) == 0
    assert step(COMPARED, output, study=tmp_path / "few.nc", dynamic=dynamic) == 2
    assert "few.nc: friction: got 0.08, expected 0.02" in capsys.readouterr().err
    other = write_cases(tmp_path / "other", DYNAMIC, "dynamic", scene="gyro_s1_drag")
    assert step(GATHER, tmp_path / "other.nc", paths=other) == 0
    assert step(COMPARED, output, study=steady, dynamic=tmp_path / "other.nc") == 2
    assert capsys.readouterr().err.endswith(f"expected the scene of {steady}\n")
    for path in (steady, folder / "cases" / f"{FAILED[1]}.nc"):
        assert step(AVERAGE, output, case=path) == 2
        assert only_line(capsys).startswith(f"{path}: ")
    assert not output.exists()


# averages as they settle


def test_the_mean_so_far_is_that_of_the_intervals_up_to_each_time():
    """A rate stands at the end of its interval; intervals here are equally long."""
    rate = xr.DataArray([3.0, 5.0, 1.0, 7.0], {"time": [0.1, 0.2, 0.3, 0.4]}, ("time",))
    assert_allclose(mean_so_far(rate), [3.0, 4.0, 3.0, 4.0], rtol=1e-14)


@pytest.mark.filterwarnings("error")
def test_running_average_draws_the_reference_where_there_is_one(folder, tmp_path):
    """The file of the project has no values, so that the legend has no reference.

    With a file of two values, that of a ball lies on the axes of balls.
    """
    case = load(folder / "dynamic" / "constant_force-mu0.080-loss0.00.nc")
    without = running_average_figure(case, ROOT / "config" / "reference" / "gupta_no2.csv")
    labels = [text.get_text() for text in without.legends[0].get_texts()]
    assert labels == ["ball 1", "cage, pockets and land", "pockets", "land"]
    file = tmp_path / "values.csv"
    file.write_text("# a comment\npart,time_s,wear_rate_m3_s\nball_1,0.02,2e-17\ncage,0.01,5e-15\n")
    drawn = running_average_figure(case, file)
    assert drawn.legends[0].get_texts()[-1].get_text() == "reference: values"
    ball = drawn.axes[0].lines
    assert_allclose(ball[-1].get_xydata(), [[20.0, 20.0]])  # ms, 1e-18 m3/s
    rate = case["history_ball_wear_rate"].isel(ball=0)
    assert_allclose(ball[0].get_ydata()[-1], 1e18 * rate.mean(), rtol=1e-5)
    assert drawn.get_suptitle().startswith("gyro_s1: ") and "%" in drawn.get_suptitle()


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("", "expected a table with the header part,time_s,wear_rate_m3_s"),
        ("part,time_s,wear_rate_m3_s\nball,1,2\n", "got ball,1,2, expected ball_1 or cage"),
        ("part,time_s,wear_rate_m3_s\ncage,1,x\n", "got cage,1,x, expected"),
    ],
)
def test_a_broken_reference_is_refused(folder, text, problem, tmp_path, capsys):
    """A line names the file and its problem, or says that a missing file cannot be read."""
    file = tmp_path / "values.csv"
    file.write_text(text)
    inputs = {"case": folder / "dynamic" / f"{FAILED[0]}.nc", "reference": file}
    assert step(AVERAGE, tmp_path / "a.svg", **inputs) == 2
    error = only_line(capsys)
    assert error.startswith(f"{file}: ") and problem in error
    file.unlink()
    assert step(AVERAGE, tmp_path / "a.svg", **inputs) == 2
    assert capsys.readouterr().err.startswith(f"{file}: cannot be read")
