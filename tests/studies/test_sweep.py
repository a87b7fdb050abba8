"""`bearingwear.sweep`: its datasets, warnings and errors, and sweeps in parts."""

import json
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr
from support import ROOT, numbers_in

import bearingwear
from bearingwear import SceneError
from bearingwear.results.netcdf import CaseFileError
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.studies.points import names_of_keys
from bearingwear.studies.sweep_dataset import gathered_parts

PRELOAD, FRICTION, METHOD = "operation.preload_N", "friction.ball_race", "operation.preload_method"
COARSE = {"model.strips": 8, "model.tolerance": 1e-3}


@pytest.fixture(scope="module")
def coarse():
    """Returns gyro_s1 with few strips and a loose tolerance, for speed."""
    return bearingwear.example().with_(COARSE)


def fail_if_solved(*_):
    """Stands in for a solve that must not take place."""
    raise AssertionError("solved")


def product_of_numbers(scene):
    """Returns values of a point without a solve: a number, a text and a pair of numbers."""
    operation = scene.operation
    values = {"product": operation.preload_N * scene.friction.ball_race, "name": scene.name}
    return values | {"pair": [operation.preload_N, operation.shaft_speed_rpm]}


def test_a_point_of_a_sweep_is_the_solved_case(coarse):
    """It has the same numbers and attributes, but for `flag_values`.

    In a sweep, these are the codes of all of its points.
    """
    axes = {PRELOAD: [5, 7], FRICTION: np.array([0.05, 0.1])}
    dataset = bearingwear.sweep(coarse, axes, workers=1)
    case = bearingwear.solve(coarse.with_({PRELOAD: 7, FRICTION: 0.05}))
    point = dataset.sel(preload_N=7, friction=0.05)
    for name in ("contact_load", "qv", "total_qv", "status"):
        np.testing.assert_array_equal(point[name], case[name], err_msg=name)
        of_sweep, of_case = (
            {key: value for key, value in variable.attrs.items() if key != "flag_values"}
            for variable in (dataset[name], case[name])
        )
        assert of_sweep == of_case, name
    assert (dataset.status == "ok").all() and case.status == "ok"


def test_axes_of_a_sweep_have_names_and_units(coarse):
    """A dimension has the name that studies have for its key, or else the last part of the key."""
    dataset = bearingwear.sweep(coarse, {PRELOAD: [5, 7], FRICTION: [0.05, 0.1]}, workers=1)
    assert dataset.total_qv.dims == ("preload_N", "friction")
    attrs = dataset.preload_N.attrs
    assert attrs["units"] == "N" and "preload" in attrs["long_name"]


def test_a_sweep_by_two_processes_is_that_by_one(coarse):
    """Six lives by both methods are the same; a fixed position warns of its temperature."""
    changes = {METHOD: ["fixed_position", "constant_force"], PRELOAD: [5, 6, 7]}
    results = []
    for workers in (1, 2):
        with (
            pytest.warns(UserWarning, match="6 cases, .* wear depth"),
            pytest.warns(UserWarning, match="3 cases, .* temperature is neglected"),
        ):
            results.append(bearingwear.sweep(coarse, changes, what="life", workers=workers))
    alone, shared = results
    xr.testing.assert_identical(alone, shared)
    lives = shared.life.sel(preload_method="fixed_position")
    assert lives.dims == ("preload_N",) and (lives > 0.0).all() and lives.attrs["units"] == "h"


@pytest.mark.parametrize("workers", [1, 2])
def test_warnings_of_a_sweep_are_counted(coarse, workers):
    """One warning is issued in this file, with the number of cases and their largest loss."""
    losses = {"wear.ball_diameter_loss_um": [0.0, 0.1, 0.7]}
    with pytest.warns(UserWarning, match="2 cases, .* 0.7 um") as caught:
        dataset = bearingwear.sweep(coarse, losses, workers=workers)
    assert len(caught) == 1 and caught[0].filename == __file__
    (worn,) = json.loads(dataset.attrs["warnings"])
    assert worn["id"] == "groove_worn" and worn["cases"] == 2
    assert numbers_in(worn["sentence"])[0] == 0.7


def test_the_file_of_a_sweep_has_codes_and_is_read_with_names(coarse, tmp_path):
    """xarray alone reads codes of methods and races; `load` returns the dataset that was saved.

    The attribute `message` is not stored.
    """
    methods = {METHOD: ["fixed_position", "constant_force"]}
    with pytest.warns(UserWarning, match="temperature is neglected"):
        dataset = bearingwear.sweep(coarse, methods, workers=1)
    bearingwear.save(dataset, tmp_path / "sweep.nc")
    with xr.open_dataset(tmp_path / "sweep.nc") as file:
        assert file.preload_method.values.tolist() == [1, 0] and file.race.values.tolist() == [0, 1]
    del dataset.attrs["message"]
    xr.testing.assert_identical(bearingwear.load(tmp_path / "sweep.nc"), dataset)


def test_a_point_that_is_not_solved_has_a_status_and_no_numbers(coarse):
    """Without friction, the rotation of balls is undetermined; a warning says so, with a count."""
    with pytest.warns(UserWarning, match="1 of 2 points .*undetermined 1") as caught:
        dataset = bearingwear.sweep(coarse, {FRICTION: [0.0, 0.08]}, workers=1)
    assert caught[0].filename == __file__
    assert dataset.status.values.tolist() == ["undetermined", "ok"]
    assert np.isfinite(dataset.total_qv).values.tolist() == [False, True]
    assert "undetermined 1" in dataset.attrs["message"]


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({PRELOAD: [5, -1]}, "operation.preload_N: got -1, expected"),
        ({}, "axes: got no key, expected one or more"),
        ({PRELOAD: 5}, "operation.preload_N: got 5, expected a list of values"),
        ({METHOD: "constant_force"}, "operation.preload_method: got 'constant_force', expected a"),
        ({PRELOAD: []}, "operation.preload_N: got no value, expected one or more"),
        ({"operation.preload": [5]}, "operation.preload: "),
        ({PRELOAD: [5], "wear.end_of_life": [None]}, "wear.end_of_life: got no criterion"),
    ],
)
def test_all_points_are_checked_before_any_is_solved(coarse, changes, problem, monkeypatch):
    """An error of any point is raised, in words of Python and not of the command's `--set`."""
    monkeypatch.setattr("bearingwear.studies.sweep._result", fail_if_solved)
    with pytest.raises(SceneError) as error:
        bearingwear.sweep(coarse, changes, what="life", workers=1)
    assert problem in str(error.value) and "--set" not in str(error.value)


def test_a_point_that_the_model_cannot_solve_is_left_out_unless_it_can_solve_none(coarse):
    """The steady model has no rotating load: status `none` of one point of two, or an error."""
    rotating = "operation.rotating_load_N"
    with pytest.warns(UserWarning, match="1 of 2 points .*none 1 .gyro_s1: "):
        dataset = bearingwear.sweep(coarse, {rotating: [0.0, 1.0]}, fidelity="steady", workers=1)
    assert dataset.status.values.tolist() == ["ok", "none"]
    assert np.isfinite(dataset.total_qv).values.tolist() == [True, False]
    with pytest.raises(NotAvailable):  # both points have such a load
        bearingwear.sweep(coarse, {rotating: [1.0, 2.0]}, fidelity="steady", workers=1)


def test_workers_and_what_are_checked(coarse):
    """`what` is solve, life or a function; `workers` is 1 or more."""
    with pytest.raises(ValueError, match="solve, life or a function"):
        bearingwear.sweep(coarse, {PRELOAD: [5]}, what="lives")
    with pytest.raises(ValueError, match="sweep: workers: got -1, expected 1 or more"):
        bearingwear.sweep(coarse, {PRELOAD: [5]}, workers=-1)


@pytest.mark.parametrize("workers", [1, 2])
def test_a_combination_that_makes_no_bearing_leaves_the_others(coarse, workers):
    """Ten of the larger balls fit side by side, but their pockets in the cage overlap."""
    axes = {"bearing.ball_count": [8, 10], "bearing.ball_diameter_mm": [1.9, 2.3]}
    with pytest.warns(UserWarning, match="1 of 4 points .*none 1"):
        dataset = bearingwear.sweep(coarse, axes, workers=workers)
    assert (dataset.status == "ok").values.tolist() == [[True, True], [True, False]]
    assert np.isnan(dataset.total_qv[1, 1]) and np.isfinite(dataset.total_qv).sum() == 3


def test_rows_are_points_of_their_own(coarse):
    """A list of changes is one dimension `row`; a row with a wrong value has the status `none`."""
    rows = [{PRELOAD: 5, FRICTION: 0.05}, {PRELOAD: 7, FRICTION: 0.1}, {PRELOAD: -7, FRICTION: 0.1}]
    with pytest.warns(UserWarning, match=r"1 of 3 points .* none 1 \(operation.preload_N: got -7"):
        dataset = bearingwear.sweep(coarse, rows, workers=1)
    assert dataset.total_qv.dims == ("row",) and dataset.preload_N.values.tolist() == [5, 7, -7]
    alone = bearingwear.solve(coarse.with_(rows[1]))
    np.testing.assert_array_equal(dataset.contact_load[1], alone.contact_load)
    assert dataset.friction.dims == ("row",) and dataset.status.values.tolist() == [
        "ok",
        "ok",
        "none",
    ]


@pytest.mark.parametrize(
    ("points", "problem"),
    [
        ([], "axes: got no row, expected one or more"),
        ([{PRELOAD: 5}, {FRICTION: 0.1}], "row 1: got the keys friction.ball_race, expected "),
        (7, "axes: got 7, expected axes KEY: VALUES, or a list of rows KEY: VALUE"),
        ({PRELOAD: [5, 6, 5.0]}, "operation.preload_N: got 5 twice, expected each value once"),
    ],
)
def test_points_that_are_refused(coarse, points, problem):
    with pytest.raises(SceneError, match=problem):
        bearingwear.sweep(coarse, points, workers=1)


def test_several_scenes_lie_side_by_side(coarse):
    """The dimension `scene` has their names, which must differ; an attribute has their data."""
    other = coarse.with_({"name": "faster", "operation.shaft_speed_rpm": 40000})
    dataset = bearingwear.sweep([coarse, other], {PRELOAD: [5, 7]}, workers=1)
    assert dataset.total_qv.dims == ("scene", "preload_N")
    assert dataset["scene"].values.tolist() == ["gyro_s1", "faster"]
    alone = bearingwear.solve(other.with_({PRELOAD: 7}))
    assert dataset.total_qv.sel(scene="faster", preload_N=7) == alone.total_qv
    scenes = json.loads(dataset.attrs["scenes"])
    assert [scene["name"] for scene in scenes] == ["gyro_s1", "faster"]
    with pytest.raises(SceneError, match="name: got two scenes named gyro_s1"):
        bearingwear.sweep([coarse, coarse], {PRELOAD: [5, 7]}, workers=1)


@pytest.mark.parametrize("workers", [1, 2])
def test_a_function_is_evaluated_at_each_point(coarse, workers):
    """Its values become variables; a list gets a dimension of its own, `NAME_0`."""
    axes = {PRELOAD: [5, 7], FRICTION: [0.05, 0.1]}
    dataset = bearingwear.sweep(coarse, axes, product_of_numbers, workers=workers)
    np.testing.assert_allclose(dataset["product"], [[0.25, 0.5], [0.35, 0.7]])
    assert dataset["pair"].dims == ("preload_N", "friction", "pair_0")
    assert (dataset["pair"][1, 0] == [7, 30000]).all() and (dataset["name"] == "gyro_s1").all()


def as_many_as_newtons(scene):
    """Returns as many values as there are whole newtons of preload."""
    return {"status": 0, "values": np.ones(int(scene.operation.preload_N)), "one": 1}


def test_values_of_another_shape_are_refused(coarse):
    """A point whose values differ in shape from those of the first has none; the others stay.

    A function that returns no mapping raises a TypeError.
    """
    with pytest.warns(UserWarning, match=r"none 1 \(values: got shape \(4,\), expected \(3,\)"):
        dataset = bearingwear.sweep(coarse, {PRELOAD: [3, 4, 3.5]}, as_many_as_newtons, workers=1)
    assert dataset.status.values.tolist() == ["ok", "none", "ok"]
    assert dataset["values"].isnull().all("values_0").values.tolist() == [False, True, False]
    with pytest.raises(TypeError, match="what: got a function that returns int, expected a"):
        bearingwear.sweep(coarse, {PRELOAD: [3]}, lambda scene: 1, workers=1)


def test_a_function_that_other_processes_cannot_import_is_refused(coarse):
    with pytest.raises(SceneError, match="what: got .*lambda.*, expected a function of a module"):
        bearingwear.sweep(coarse, {PRELOAD: [5, 7]}, lambda scene: {}, workers=2)


def test_only_what_is_kept_is_in_the_dataset(coarse):
    """The status is there, too; what is kept is identical to the same part of the whole dataset."""
    axes = {PRELOAD: [5, 7]}
    whole = bearingwear.sweep(coarse, axes, workers=1)
    kept = bearingwear.sweep(coarse, axes, workers=1, keep=["total_qv", "contact_load"])
    assert set(kept.data_vars) == {"status", "total_qv", "contact_load"}
    for name in kept.variables:
        xr.testing.assert_identical(kept[name].variable, whole[name].variable)


@pytest.mark.parametrize(
    ("keep", "problem"),
    [
        (["total_gv"], "keep: got total_gv, expected total_qv"),
        ("extremes", "keep: got extremes of solve, expected it of life"),
    ],
)
def test_what_a_case_has_not_cannot_be_kept(coarse, keep, problem):
    """Refused are a misspelt name, and extremes, which only a life has."""
    with pytest.raises(SceneError, match=problem):
        bearingwear.sweep(coarse, {PRELOAD: [5, 7]}, workers=1, keep=keep)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_extremes_are_the_worst_values_along_a_life(coarse):
    """They are the largest or least values, or magnitudes, of its histories, which are not kept.

    preload_kept is the least preload over the initial 7 N.
    """
    axes = {METHOD: ["fixed_position", "constant_force"], PRELOAD: [5, 7]}
    dataset = bearingwear.sweep(coarse, axes, "life", workers=1, keep="extremes")
    assert dataset.maximum_pressure.dims == ("preload_method", "preload_N")
    point = dataset.sel(preload_method="fixed_position", preload_N=7)
    alone = bearingwear.life(coarse.with_({METHOD: "fixed_position", PRELOAD: 7}))
    np.testing.assert_array_equal(point.life, alone.life)
    assert point.maximum_pressure == alone.history_maximum_pressure.max()
    assert point.gyroscopic_slip_share == alone.history_gyroscopic_slip_share.max()
    assert point.system_axial_stiffness == alone.history_system_axial_stiffness.min()
    assert point.preload_kept == alone.history_residual_preload.min() / 7
    assert point.rotor_axial_shift == abs(alone.history_rotor_axial_shift).max()
    assert dataset.maximum_pressure.attrs["units"] == "Pa"
    assert "history_time" not in dataset


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_the_worse_bearing_of_a_pair_counts(coarse):
    """Two bearings in tandem share the preload of their side, so that each has half of it.

    The preload kept is that of a side over 7 N: bearings of the first count twice.
    """
    keys = {
        METHOD: "fixed_position",
        "arrangement.kind": "rigid_pair",
        "arrangement.tandem": [2, 1],
    }
    keys["arrangement.second.wear.ball_diameter_loss_um"] = 0.1
    pair = coarse.with_(keys)
    dataset = bearingwear.sweep(pair, {PRELOAD: [7]}, "life", workers=1, keep="extremes")
    alone = bearingwear.life(pair.with_({PRELOAD: 7}))
    kept = alone.history_residual_preload.values * np.array([[2.0], [1.0]]) / 7
    assert dataset.preload_kept.dims == ("preload_N",) and dataset.preload_kept[0] == kept.min()
    assert dataset.maximum_pressure[0] == alone.history_maximum_pressure.max()


# 2 x 3 x 2 points; those without friction are not solved
TWELVE_POINTS = {"model.strips": [8, 10], PRELOAD: [5, 7, 9], FRICTION: [0.0, 0.08]}


def part_files(scene, what, folder):
    """Writes the three parts of a sweep, and returns their paths by the number of the part."""
    files = {}
    for k in (1, 2, 3):
        part = bearingwear.sweep(scene, TWELVE_POINTS, what, workers=1, part=(k, 3))
        files[k] = folder / f"{k}.nc"
        bearingwear.save(part, files[k])
    return files


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("what", ["solve", "life", product_of_numbers])
def test_parts_in_any_order_make_the_whole(coarse, what, tmp_path):
    """They make it of cases, lives and values of a function, though some points are not solved."""
    files = part_files(coarse, what, tmp_path)
    whole = bearingwear.sweep(coarse, TWELVE_POINTS, what, workers=1)
    xr.testing.assert_identical(gathered_parts([files[2], files[1], files[3]]), whole)


def test_a_part_that_is_missing_or_there_twice_is_named(coarse, tmp_path):
    files = part_files(coarse, product_of_numbers, tmp_path)
    with pytest.raises(CaseFileError, match="got 2 of 3 parts, expected also 1/3"):
        gathered_parts([files[2], files[3]])
    with pytest.raises(CaseFileError, match="got part 2/3 twice"):
        gathered_parts([files[2], files[2]])


@pytest.mark.parametrize("part", [(0, 3), (4, 3), (1, 13)])
def test_parts_that_a_sweep_has_not_are_refused(coarse, part):
    """part: K and N of the K-th of N parts, of at least one point each."""
    with pytest.raises(SceneError, match=r"part: got .*expected K/N with 1 <= K <= N <= 12"):
        bearingwear.sweep(coarse, TWELVE_POINTS, workers=1, part=part)


@pytest.mark.parametrize(
    ("keys", "used_names", "names"),  # used_names: of results
    [
        ([PRELOAD, FRICTION], set(), ["preload_N", "friction"]),
        (["wear.counts"], {"counts"}, ["wear_counts"]),
        (
            ["materials.a.density_kg_m3", "materials.b.density_kg_m3"],
            set(),
            ["materials_a_density_kg_m3", "materials_b_density_kg_m3"],
        ),
    ],
)
def test_dimensions_have_the_shortest_names_that_tell_them_apart(keys, used_names, names):
    assert list(names_of_keys(keys, used_names).values()) == names


# a script of a user; `guard` adds what starts it
SCRIPT = """
import multiprocessing
import bearingwear

def main():
    scene = bearingwear.example().with_({"model.strips": 8})
    swept = bearingwear.sweep(scene, {"operation.preload_N": [5, 7, 9, 11]}, workers=2)
    print(*swept.status.values)

"""


def run_script(folder, text):
    """Runs a script in a process of its own, and returns that process when it has ended."""
    (folder / "script.py").write_text(text)
    environment = {"PYTHONPATH": str(ROOT), "PATH": ""}
    command = [sys.executable, "script.py"]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.long
def test_a_sweep_works_with_spawned_processes(tmp_path):
    guard = "if __name__ == '__main__':\n    multiprocessing.set_start_method('spawn')\n    main()"
    completed = run_script(tmp_path, SCRIPT + guard)
    assert completed.stdout == "ok ok ok ok\n", completed.stderr


# a script that each spawned process would run again
UNGUARDED = """
import multiprocessing
from bearingwear.studies.answers import answers_at

multiprocessing.set_start_method("spawn", force=True)
list(answers_at(len, [[], []], 2))
"""


def test_a_script_without_main_guard_is_refused(tmp_path):
    """The last line of its error names the guard."""
    completed = run_script(tmp_path, UNGUARDED)
    last_line = completed.stderr.rstrip().splitlines()[-1]
    assert "ProcessEnded: sweep: " in last_line and "if __name__ == '__main__':" in last_line


def test_profiles_of_unlike_length_have_no_places():
    """Points with 10 and 20 strips share no coordinate of strips; points with 50 each do."""
    dataset = bearingwear.sweep(bearingwear.example(), {"model.strips": [10, 20]}, workers=1)
    assert "strip_position" not in dataset.coords
    alike = bearingwear.sweep(bearingwear.example(), {FRICTION: [0.05, 0.08]}, workers=1)
    assert alike["strip_position"].dims == ("strip",)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_sweep_of_pairs_has_a_column_for_each_bearing(coarse):
    """Each point holds both bearings; a key of the second alone may be swept."""
    pair = coarse.with_({METHOD: "fixed_position", "arrangement.kind": "rigid_pair"})
    loss = "arrangement.second.wear.ball_diameter_loss_um"
    dataset = bearingwear.sweep(pair, {loss: [0.0, 0.1], PRELOAD: [5, 7]}, workers=1)
    assert dataset.residual_preload.dims == ("ball_diameter_loss_um", "preload_N", "bearing")
    assert dataset.ball_diameter_loss_um.attrs["units"] == "um"
    assert dataset.rotor_axial_shift.dims == ("ball_diameter_loss_um", "preload_N")
    point = dataset.sel(preload_N=7, ball_diameter_loss_um=0.1)
    alone = bearingwear.solve(pair.with_({loss: 0.1}))
    for name in ("residual_preload", "rotor_axial_shift", "total_qv"):
        np.testing.assert_array_equal(point[name].values, alone[name].values, err_msg=name)


@pytest.mark.parametrize("kinds", [["single", "spring_pair"], ["spring_pair", "single"]])
def test_pairs_and_single_bearings_do_not_mix(coarse, kinds, monkeypatch):
    """They are refused in either order, before anything is solved."""
    monkeypatch.setattr("bearingwear.studies.sweep._result", fail_if_solved)
    with pytest.raises(SceneError, match="arrangement.kind: got .*single"):
        bearingwear.sweep(coarse, {"arrangement.kind": kinds}, workers=1)
