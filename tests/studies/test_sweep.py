"""`bearingwear.sweep`: values of a scene side by side."""

import json
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray as xr
from support import ROOT

import bearingwear
from bearingwear import SceneError
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.studies import pool
from bearingwear.studies import sweep as module

PRELOAD, FRICTION, METHOD = "operation.preload_N", "friction.ball_race", "operation.preload_method"
COARSE = {"model.strips": 8, "model.tolerance": 1e-3}


@pytest.fixture(scope="module")
def coarse():
    return bearingwear.example().with_(COARSE)


def not_to_be_solved(*_):
    raise AssertionError("solved")


def test_a_point_is_what_solve_finds(coarse):
    made = bearingwear.sweep(coarse, {PRELOAD: [5, 7], FRICTION: np.array([0.05, 0.1])}, workers=1)
    assert made.total_qv.dims == ("preload_N", "friction")
    assert made.preload_N.attrs["units"] == "N" and "preload" in made.preload_N.attrs["long_name"]
    assert made.attrs["message"] == "all points solved and verified"
    alone = bearingwear.solve(coarse.with_({PRELOAD: 7, FRICTION: 0.05}))
    point = made.sel(preload_N=7, friction=0.05, race="inner")
    for name in ("contact_load", "qv", "total_qv", "status"):
        there = alone[name].sel(race="inner") if "race" in alone[name].dims else alone[name]
        np.testing.assert_array_equal(point[name], there)
        assert {**made[name].attrs, "flag_values": 0} == {**alone[name].attrs, "flag_values": 0}
    assert (made.status == "ok").all() and alone.status == "ok"


def test_processes_find_the_same(coarse):
    changes = {METHOD: ["fixed_position", "constant_force"], PRELOAD: [5, 6, 7]}
    alone, shared = (
        bearingwear.sweep(coarse, changes, what="life", workers=workers) for workers in (1, 2)
    )
    xr.testing.assert_identical(alone, shared)
    lives = shared.life.sel(preload_method="fixed_position")
    assert lives.dims == ("preload_N",) and (lives > 0.0).all() and lives.attrs["units"] == "h"


def test_warnings_of_a_sweep_are_counted(coarse):
    losses = {"wear.ball_diameter_loss_um": [0.0, 0.1, 0.7]}
    for workers in (1, 2):
        with pytest.warns(UserWarning, match="2 cases, at worst: a wear depth of 0.7 um") as told:
            made = bearingwear.sweep(coarse, losses, workers=workers)
        assert len(told) == 1 and told[0].filename == __file__
        (worn,) = json.loads(made.attrs["warnings"])
        assert worn["id"] == "groove_worn" and worn["cases"] == 2
        assert worn["sentence"].startswith("a wear depth of 0.7 um")


def test_file_of_a_sweep(coarse, tmp_path):
    made = bearingwear.sweep(coarse, {METHOD: ["fixed_position", "constant_force"]}, workers=1)
    bearingwear.save(made, tmp_path / "sweep.nc")
    with xr.open_dataset(tmp_path / "sweep.nc") as file:
        assert file.preload_method.values.tolist() == [1, 0] and file.race.values.tolist() == [0, 1]
    del made.attrs["message"]
    xr.testing.assert_identical(bearingwear.load(tmp_path / "sweep.nc"), made)


def test_a_point_that_fails(coarse):
    """Without friction the balls may spin in any way."""
    with pytest.warns(UserWarning, match="1 of 2 points were not solved: undetermined 1") as told:
        made = bearingwear.sweep(coarse, {FRICTION: [0.0, 0.08]}, workers=1)
    assert told[0].filename == __file__
    assert made.status.values.tolist() == ["undetermined", "ok"]
    assert np.isfinite(made.total_qv).values.tolist() == [False, True]
    assert "undetermined 1" in made.attrs["message"]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({PRELOAD: [5, -1]}, "operation.preload_N: got -1, expected"),
        ({}, "changes: got no key, expected one or more"),
        ({PRELOAD: 5}, "operation.preload_N: got 5, expected a list of values"),
        ({METHOD: "constant_force"}, "operation.preload_method: got 'constant_force', expected a"),
        ({PRELOAD: []}, "operation.preload_N: got no value, expected one or more"),
        ({"operation.preload": [5]}, "operation.preload: "),
        ({PRELOAD: [5], "wear.end_of_life": [None]}, "wear.end_of_life: got no criterion"),
    ],
)
def test_nothing_is_solved_before_all_is_checked(coarse, changes, said, monkeypatch):
    monkeypatch.setattr(module, "_solved", not_to_be_solved)
    with pytest.raises(SceneError) as error:
        bearingwear.sweep(coarse, changes, what="life", workers=1)
    assert said in str(error.value) and "--set" not in str(error.value)


def test_a_model_that_cannot_solve_a_point(coarse, monkeypatch):
    monkeypatch.setattr(module, "_solved", not_to_be_solved)
    with pytest.raises(NotAvailable):
        changes = {"operation.rotating_load_N": [0.0, 1.0]}
        bearingwear.sweep(coarse, changes, fidelity="steady", workers=1)
    with pytest.raises(ValueError, match="solve or life"):
        bearingwear.sweep(coarse, {PRELOAD: [5]}, what="lives")
    with pytest.raises(ValueError, match="sweep: workers: got -1, expected 1 or more"):
        bearingwear.sweep(coarse, {PRELOAD: [5]}, workers=-1)


def test_names_of_the_dimensions():
    def names(*keys, taken=()):
        return list(module._dimensions(keys, set(taken)).values())

    assert names(PRELOAD, FRICTION) == ["preload_N", "friction"]
    assert names("wear.counts", taken=["counts"]) == ["wear_counts"]
    assert names("materials.a.density_kg_m3", "materials.b.density_kg_m3") == [
        "materials_a_density_kg_m3",
        "materials_b_density_kg_m3",
    ]


def parts(*lengths):
    return [xr.Dataset({"a": ("point", np.zeros(length))}) for length in lengths]


def test_progress(monkeypatch, capsys):
    clock = [0.0]
    monkeypatch.setattr(pool.time, "monotonic", lambda: clock[0])

    def every_2_seconds():
        for part in parts(1, 2, 2, 3, 2):
            clock[0] += 2.0
            yield part

    assert len(list(module._told_in_lines(every_2_seconds(), 10))) == 5
    lines = "sweep: 3 of 10 points\nsweep: 8 of 10 points, about 2 s left\n"
    assert capsys.readouterr().err == lines


def test_an_interrupt_waits_for_no_process():
    results = pool.in_processes(time.sleep, [0.0, 60.0, 60.0, 60.0], 2, "sweep")
    next(results)
    started = time.monotonic()
    results.close()
    assert time.monotonic() - started < 20.0


SCRIPT = """
import multiprocessing
import bearingwear

def main():
    scene = bearingwear.example().with_({"model.strips": 8})
    found = bearingwear.sweep(scene, {"operation.preload_N": [5, 7, 9, 11]}, workers=2)
    print(found.attrs["message"])

"""


def run_script(folder, text):
    (folder / "script.py").write_text(text)
    environment = {"PYTHONPATH": str(ROOT), "PATH": ""}
    command = [sys.executable, "script.py"]
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.long
def test_where_processes_start_anew(tmp_path):
    guard = "if __name__ == '__main__':\n    multiprocessing.set_start_method('spawn')\n    main()"
    done = run_script(tmp_path, SCRIPT + guard)
    assert done.stdout == "all points solved and verified\n", done.stderr


UNGUARDED = """
import multiprocessing
from bearingwear.studies.pool import in_processes

multiprocessing.set_start_method("spawn", force=True)
list(in_processes(len, [[]], 2, "sweep"))
"""


def test_a_script_without_its_guard_is_told(tmp_path):
    done = run_script(tmp_path, UNGUARDED)
    last = done.stderr.rstrip().splitlines()[-1]
    assert last.startswith("RuntimeError: sweep: ") and "if __name__ == '__main__':" in last


def test_profiles_of_unlike_length_have_no_places():
    """The places of twenty strips are not those of ten."""
    found = bearingwear.sweep(bearingwear.example(), {"model.strips": [10, 20]}, workers=1)
    assert "strip_position" not in found.coords
    same = bearingwear.sweep(bearingwear.example(), {"friction.ball_race": [0.05, 0.08]}, workers=1)
    assert same["strip_position"].dims == ("strip",)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_pairs(coarse):
    """Each point holds both bearings; a key of the second alone may be swept."""
    pair = coarse.with_({METHOD: "fixed_position", "arrangement.kind": "rigid_pair"})
    loss = "arrangement.second.wear.ball_diameter_loss_um"
    made = bearingwear.sweep(pair, {loss: [0.0, 0.1], PRELOAD: [5, 7]}, workers=1)
    assert made.residual_preload.dims == ("ball_diameter_loss_um", "preload_N", "bearing")
    assert made.ball_diameter_loss_um.attrs["units"] == "um"
    assert made.rotor_axial_shift.dims == ("ball_diameter_loss_um", "preload_N")
    point = made.sel(preload_N=7, ball_diameter_loss_um=0.1)
    alone = bearingwear.solve(pair.with_({loss: 0.1}))
    for name in ("residual_preload", "rotor_axial_shift", "total_qv"):
        np.testing.assert_array_equal(point[name].values, alone[name].values, err_msg=name)


@pytest.mark.parametrize("kinds", [["single", "spring_pair"], ["spring_pair", "single"]])
def test_pairs_and_single_bearings_do_not_mix(coarse, kinds, monkeypatch):
    monkeypatch.setattr(module, "_solved", not_to_be_solved)
    with pytest.raises(SceneError, match="arrangement.kind: got .*single"):
        bearingwear.sweep(coarse, {"arrangement.kind": kinds}, workers=1)
