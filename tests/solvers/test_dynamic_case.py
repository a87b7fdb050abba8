"""Cases solved dynamically, from the command to the file and back, with a solver made up here."""

import os
import re
import signal
import subprocess
import sys
import threading
import time
from types import SimpleNamespace

import netCDF4
import numpy as np
import pytest
import xarray as xr
from support import ROOT, only_line, scene_file

import bearingwear
from bearingwear.cli import main
from bearingwear.kernels import status as code
from bearingwear.results import variables
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.restart import restart_from
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.scene.read import load_scene
from bearingwear.solvers.dynamic import run as dynamic_run
from bearingwear.solvers.dynamic import windows as time_run
from bearingwear.solvers.effects.choice import choice, choice_for_life
from kerneljit.interrupt import Interrupt, check_interrupt

S1 = scene_file("gyro_s1")
BALLS, TURN = 9, 0.002
TURNS = 40  # of accuracy standard


def invented_solution(scene, restart=None, progress=None):
    """Returns values and attributes as the dynamic solver does, with random numbers.

    Its final state counts simulated turns, on from those of a restart. It reports progress twice;
    the first report has a line break within.
    """
    start = 0.0 if restart is None else restart["time"]
    count = np.zeros(12) if restart is None else restart["state"]  # of any length
    if progress is not None:
        progress("turn 10 of 20, simulated 0.02 s\nin 1 s")
        progress("turn 20 of 20")
    model = scene.model
    points = int(model.history_points_per_turn * model.simulated_turns)
    sizes = {"ball": BALLS, "race": 2, "axis": 3, "strip": model.strips}
    sizes |= {"time": points, "direction": 3, "edge": 2, "state": count.size}
    random = np.random.default_rng(2)
    values = {"status": code.OK}
    for name, variable in variables.CASE.items():
        solved = variable.always or variable.averaged or name in variables.DYNAMIC
        if not solved or name in ("status", "axial_stiffness", "skid_ratio"):
            continue
        if not points and "time" in variable.dims:
            continue
        numbers = 1.0 + random.random([sizes[dim] for dim in variable.dims])
        values[name] = numbers.astype(int) if variable.dtype[0] == "i" else numbers
    if points:
        values["time"] = start + TURN * (1.0 + np.arange(points)) / model.history_points_per_turn
    values |= {
        "simulated_turns": model.simulated_turns,
        "evaluated_turns": model.averaged_turns,
        "orbit_speed": np.full(BALLS, 1000.0),
        "cage_speed": 990.0,
        "final_time": start + TURN * model.simulated_turns,
        "final_state": count + model.simulated_turns,
        "slow_time_scale": 0.3,
    }
    kind = "rest" if restart is None else f"the end of a run at {start:.6g} s"
    return values, {"start": kind, "settled": "settled: QV drifts +1.0e-04 per turn"}


@pytest.fixture
def solver(monkeypatch):
    """Replaces the dynamic solver by `invented_solution`."""
    monkeypatch.setattr(dynamic_run, "solve_dynamic", invented_solution)


def solve(output, *more) -> int:
    """Runs `bearingwear solve` with the dynamic model, and returns its exit status."""
    return main(["solve", str(S1), "-o", str(output), "--fidelity", "dynamic", *more])


@pytest.fixture
def case(solver, tmp_path):
    """Returns the file of a case that is "solved" by `invented_solution`."""
    path = tmp_path / "case.nc"
    assert solve(path) == 0
    return path


# the file


def test_python_returns_the_dataset_of_the_command(case):
    with pytest.warns(UserWarning, match="gravity is not specified"):
        result = bearingwear.solve(S1, fidelity="dynamic")
    assert result.attrs.pop("wall_time_s") > 0.0
    read = bearingwear.load(case)
    xr.testing.assert_identical(result, read)
    for name in result.variables:
        assert result[name].dtype == read[name].dtype, name


def test_histories_have_their_dimensions_units_and_numbers(case):
    """Names, dimensions and units that others rely on; values are those of `invented_solution`.

    Histories are single floats, to 1e-6; angles are in degrees in the file.
    """
    contact, ball, direction = ("time", "ball", "race"), ("time", "ball"), ("time", "direction")
    contract = {
        "contact_load": (contact, "N"), "slip": (contact, "m s-1"), "contact_qv": (contact, "W"),
        "orbit_lead": (ball, "degree"), "residual_preload": (("time",), "N"),
        "race_displacement": (direction, "m"), "ball_wear_rate": (ball, "m3 s-1"),
        "race_wear_rate": (("time", "race"), "m3 s-1"), "cage_position": (direction, "m"),
        "cage_tilt": (direction, "degree"), "cage_speed": (("time",), "rad s-1"),
        "pocket_force": (ball, "N"), "land_force": (("time", "edge"), "N"),
        "cage_pocket_wear_rate": (("time",), "m3 s-1"),
        "cage_land_wear_rate": (("time",), "m3 s-1"),
    }  # fmt: skip
    values, _ = invented_solution(load_scene(S1))
    with netCDF4.Dataset(case) as file:
        histories = [name for name in file.variables if name.startswith("history_")]
        assert sorted(histories) == sorted(f"history_{name}" for name in contract)
        for name, (dims, units) in contract.items():
            variable = file[f"history_{name}"]
            assert variable.dimensions == dims and variable.units == units, name
            assert variable.dtype == np.float32 and variable.filters()["zlib"]
            mean = "wear_rate" in name or name == "contact_qv"
            assert variable.cell_methods == ("time: mean" if mean else "time: point")
            scale = 180.0 / np.pi if units == "degree" else 1.0
            np.testing.assert_allclose(variable[...], scale * values[f"history_{name}"], rtol=1e-6)
        time = file["time"]
        assert time.dtype == np.float64 and time.units == "s"
        assert not {"_FillValue", "standard_name"} & set(time.ncattrs())
        # 20 points a turn, as the scene has it
        assert time.size == 20 * TURNS and time[-1] == pytest.approx(TURNS * TURN)
        assert file["direction"].flag_meanings == "axial Y Z"
        assert file["edge"].flag_meanings == "at_negative_x at_positive_x"


def test_averaged_variables_have_cell_methods(case, tmp_path):
    with netCDF4.Dataset(case) as file:
        for name in ("contact_load", "total_qv", "cage_wear_rate", "mean_land_torque"):
            assert file[name].cell_methods == "time: mean", name
        for name in ("status", "qv_drift_per_turn", "final_state", "axial_stiffness", "ball"):
            assert "cell_methods" not in file[name].ncattrs(), name
    assert main(["solve", str(S1), "-o", str(tmp_path / "steady.nc")]) == 0
    with netCDF4.Dataset(tmp_path / "steady.nc") as file:
        assert not any("cell_methods" in v.ncattrs() for v in file.variables.values())


def test_without_points_a_turn_the_file_has_no_histories(solver, tmp_path):
    assert solve(tmp_path / "x.nc", "--set", "model.history_points_per_turn=0") == 0
    dataset = load(tmp_path / "x.nc")
    assert "time" not in dataset.variables and "final_state" in dataset
    assert not any(str(name).startswith("history_") for name in dataset.variables)


def test_an_unsolved_dynamic_case_is_no_start(monkeypatch, solver, tmp_path, capsys):
    """The command names its status, and so does a run that would go on from its file."""

    def unsolved(scene, **_):
        return {"status": code.CONTACT_LOST}, {"residual": "not solved"}

    monkeypatch.setattr(dynamic_run, "solve_dynamic", unsolved)
    assert solve(tmp_path / "x.nc") == 3
    assert "contact_lost" in capsys.readouterr().err
    with pytest.raises(CaseFileError, match="status contact_lost, expected status ok"):
        restart_from(tmp_path / "x.nc")


# progress


def test_each_progress_is_one_line(solver, tmp_path, capsys):
    """The two reports of `invented_solution`; a line break within the first is shown as `?`."""
    # without gravity, the warning that it is not specified would be on stderr, too
    assert solve(tmp_path / "x.nc", "--set", "operation.gravity_m_s2=[0,0,-9.81]") == 0
    assert capsys.readouterr().err.splitlines() == [
        f"{S1}: turn 10 of 20, simulated 0.02 s?in 1 s",
        f"{S1}: turn 20 of 20",
    ]


def test_a_run_goes_on_where_nobody_reads_its_progress(solver, tmp_path, monkeypatch):
    class ClosedPipe:
        def write(self, text):
            raise BrokenPipeError

        def isatty(self):
            return False

    monkeypatch.setattr(sys, "stderr", ClosedPipe())
    assert solve(tmp_path / "x.nc") == 0
    assert int(load(tmp_path / "x.nc")["status"]) == code.OK


def test_the_remaining_time_follows_the_recent_rate(monkeypatch):
    """Of 100 turns 30 take 0.5 s each, and the others 5 s, which the estimate follows."""
    now, lines = [0.0], []
    monkeypatch.setattr(time_run, "clock", SimpleNamespace(monotonic=lambda: now[0]))
    report = time_run._Progress(lines.append, turns=100.0, turn=2e-3)
    for turn in range(1, 61):
        now[0] += 0.5 if turn <= 30 else 5.0
        report(float(turn), None)
    left = [int(re.search(r"about (\d+) s left", line)[1]) for line in lines]
    assert "at most" not in "".join(lines)
    assert left[0] == pytest.approx(0.5 * 94, abs=1.0)  # after the first six turns
    assert left[-1] == pytest.approx(5.0 * 40, abs=1.0)


# going on from a state


def test_a_restart_continues_in_time(case, tmp_path):
    """Five turns follow the 40 of the case, in time as in the state that counts them."""
    again = tmp_path / "more.nc"
    assert solve(again, "--restart", str(case), "--set", "model.simulated_turns=5") == 0
    continued = load(again)
    assert float(continued["final_time"]) == pytest.approx((TURNS + 5) * TURN)
    assert continued["time"][0] > load(case)["time"][-1]
    np.testing.assert_array_equal(continued["final_state"], np.full(12, TURNS + 5.0))
    assert continued.attrs["start"] == "the end of a run at 0.08 s"
    scene = load_scene(S1, ["model.simulated_turns=5"])
    with pytest.warns(UserWarning, match="gravity is not specified"):
        result = bearingwear.solve(scene, "dynamic", restart=case)
    del result.attrs["wall_time_s"]
    xr.testing.assert_identical(result, bearingwear.load(again))


def refused(capsys, argv) -> str:
    """Returns the only line of a command that refuses its input with exit status 2."""
    assert main(argv) == 2
    err = only_line(capsys)
    assert "got " in err and "expected" in err and len(err) < 500
    return err


@pytest.mark.parametrize(
    "setting, key",
    [
        ("operation.preload_N=9", "operation.preload_N: got a case with 7.0"),
        ("operation.radial_load_N=[0, 1]", "operation.radial_load_N"),
        ("name=other", "name"),
    ],
)
def test_a_restart_of_another_scene_is_refused(setting, key, case, tmp_path, capsys):
    argv = ["solve", str(S1), "-o", str(tmp_path / "x.nc"), "--fidelity", "dynamic"]
    line = refused(capsys, [*argv, "--restart", str(case), "--set", setting])
    assert (
        line.startswith(f"{case}: {key}")
        and "only wear, model and friction.slip_regularisation_m_s may differ" in line
    )
    assert not (tmp_path / "x.nc").exists()


@pytest.mark.parametrize(
    "setting",
    ["wear.counts=ball", "model.strips=20"],
)
def test_a_restart_may_change_wear_and_model(setting, case, tmp_path):
    assert solve(tmp_path / "x.nc", "--restart", str(case), "--set", setting) == 0


@pytest.mark.parametrize(
    ("options", "fidelity"), [([], "steady"), (["--fidelity", "race_control"], "race_control")]
)
def test_a_restart_by_another_model_is_refused(options, fidelity, case, tmp_path, capsys):
    argv = ["solve", str(S1), "-o", str(tmp_path / "x.nc"), "--restart", str(case)]
    line = refused(capsys, [*argv, *options])
    assert line.startswith("--restart: got a scene solved with fidelity " + fidelity)
    with pytest.raises(NotAvailable, match="restart: got a scene"):
        bearingwear.solve(S1, restart=case, fidelity=fidelity)


def test_a_restart_of_a_file_that_is_no_dynamic_case_is_refused(solver, tmp_path, capsys):
    """A steady case, a life, a text and a missing file; each line begins with the file."""
    steady, life, text = tmp_path / "steady.nc", tmp_path / "life.nc", tmp_path / "text.nc"
    assert main(["solve", str(S1), "-o", str(steady)]) == 0
    assert main(["life", str(S1), "-o", str(life)]) == 0
    text.write_text("turn 20\n")
    capsys.readouterr()  # warnings of the life
    argv = ["solve", str(S1), "-o", str(tmp_path / "x.nc"), "--fidelity", "dynamic", "--restart"]
    for file, problem in (
        (steady, "fidelity steady, expected a dynamic case"),
        (life, "fidelity steady, expected a dynamic case"),
        (text, "not written by"),
        (tmp_path / "none.nc", "cannot be read"),
    ):
        line = refused(capsys, [*argv, str(file)])
        assert line.startswith(f"{file}: got ") and problem in line


@pytest.mark.parametrize(
    "change, problem",
    [
        (lambda file: file.setncattr("source_hash", "0" * 16), "another version of the solver"),
        (lambda file: file.renameVariable("final_state", "state_once"), "damaged"),
        (lambda file: file.setncattr("scene", "{"), "damaged"),
        (lambda file: file["final_state"].__setitem__(3, np.nan), "without a final state"),
    ],
)
def test_a_restart_of_a_file_that_was_changed_is_refused(change, problem, case):
    with netCDF4.Dataset(case, "a") as file:
        change(file)
    with pytest.raises(CaseFileError, match=problem) as caught:
        restart_from(case, load_scene(S1))
    assert str(caught.value).startswith(f"{case}: got ") and "\n" not in str(caught.value)


# which model


@pytest.mark.parametrize(
    "settings, fidelity, why",
    [
        ([], "steady", "pure thrust load"),
        (["operation.radial_load_N=[0, 1]"], "dynamic", "radial load"),
        (["operation.rotating_load_N=1"], "dynamic", "rotating load"),
        (["operation.tilt_mrad=1"], "dynamic", "tilt"),
        ([f"wear.ball_diameter_loss_um={[0.1] + [0.0] * 8}"], "dynamic", "ball diameters"),
        (["model.cage_results=true"], "dynamic", "cage"),
        (["model.fidelity=dynamic"], "dynamic", "requested"),
        (["operation.tilt_mrad=1", "model.fidelity=race_control"], "race_control", "requested"),
        (["operation.tilt_mrad=1", "operation.shaft_speed_rpm=0"], "race_control", "at rest"),
    ],
)
def test_the_model_is_chosen_by_what_the_scene_has(settings, fidelity, why):
    chosen = choice(load_scene(S1, settings))
    assert chosen.fidelity == fidelity
    assert chosen.reasons[0].startswith(f"{fidelity}: ") and why in chosen.reasons[0]


@pytest.mark.parametrize(
    "settings, fidelity, cage",
    [
        (["operation.rotating_load_N=1"], None, False),
        (["operation.rotating_load_N=1", "model.cage_results=true"], None, True),
        (["operation.rotating_load_N=1"], "dynamic", True),
        (["cage=null"], "dynamic", False),
        ([], None, False),
    ],
)
def test_the_cage_is_solved_where_it_is_requested(settings, fidelity, cage):
    scene = load_scene(S1, settings)
    chosen = choice(scene, fidelity)
    assert chosen.cage == cage
    if chosen.fidelity == "dynamic":  # other models ignore it
        assert (chosen.reduced(scene).cage is not None) == cage
    left_out = any("neglected" in r for r in chosen.reasons if r.startswith("cage: "))
    assert left_out == (scene.cage is not None and not cage)


@pytest.mark.parametrize(
    "settings, fidelity, problem",
    [
        (["operation.tilt_mrad=1"], "steady", "model.fidelity: got 'steady'; a scene with tilt"),
        (["model.cage_results=true"], "steady", "model.fidelity: got 'steady'; cage motion"),
        (["model.cage_results=true"], "race_control", "model.fidelity: got 'race_control'"),
        (["operation.shaft_speed_rpm=0"], "dynamic", "operation.shaft_speed_rpm: got 0"),
    ],
)
def test_models_that_cannot_solve_a_scene_are_refused(settings, fidelity, problem):
    with pytest.raises(NotAvailable, match=f"^gyro_s1: {problem}.*, expected"):
        choice(load_scene(S1, settings), fidelity)


def test_limits_of_the_cage_need_its_wear():
    """Only the dynamic model has it: elsewhere such a limit is left out, or refused if alone."""
    limit = "wear.end_of_life.guide_clearance_mm=0.3"
    scene = load_scene(S1, [limit])
    assert "guide_clearance_mm" in choice_for_life(scene).reasons[-1]
    in_time = choice_for_life(scene, "dynamic")
    assert not any("guide_clearance_mm" in reason for reason in in_time.reasons)
    alone = load_scene(S1, ["wear.end_of_life={guide_clearance_mm: 0.3}"])
    assert choice_for_life(alone, "dynamic").fidelity == "dynamic"
    with pytest.raises(NotAvailable, match="only guide_clearance_mm,.* expected.*fidelity dynamic"):
        choice_for_life(alone)


def test_limits_of_slip_need_a_balance_of_friction():
    """Race control has none: such limits are left out, or refused if there is no other."""
    radial = "operation.radial_load_N=[0, 1]"
    scene = load_scene(S1, [radial])
    last_reason = choice_for_life(scene, "race_control").reasons[-1]
    assert re.findall(r"\w+_\w+", last_reason) == ["gyroscopic_slip_share", "skid_ratio"]
    alone = load_scene(S1, [radial, "wear.end_of_life={skid_ratio: 0.1}"])
    with pytest.raises(NotAvailable, match="only skid_ratio,.* expected.*fidelity auto"):
        choice_for_life(alone, "race_control")
    pair = alone.with_({"operation.preload_method": "fixed_position"})
    pair = pair.with_({"arrangement": {"kind": "rigid_pair", "span_mm": 30.0}})
    with pytest.raises(NotAvailable, match="only skid_ratio,.* expected another criterion$"):
        choice_for_life(pair)  # no other model solves it


@pytest.mark.parametrize("changes", [[], ["arrangement.kind=spring_pair"]])
def test_no_life_by_race_control_where_the_steady_model_solves(changes):
    scene = load_scene(S1, changes)
    assert choice(scene, "race_control").fidelity == "race_control"  # a solve stays
    assert choice_for_life(scene, "steady").fidelity == "steady"
    with pytest.raises(NotAvailable, match="model.fidelity: got 'race_control'.* expected.*steady"):
        choice_for_life(scene, "race_control")


def test_half_of_a_run_is_averaged_but_20_turns_at_most():
    assert load_scene(S1).model.averaged_turns == 20.0
    assert load_scene(S1, ["model.simulated_turns=3"]).model.averaged_turns == 1.5
    assert load_scene(S1, ["model.evaluated_turns=4"]).model.averaged_turns == 4.0


# the solver itself


def test_an_interrupt_ends_nested_blocks_and_restores_the_handler():
    """In Python, `solve` and a dynamic run have such blocks, one within the other."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    with pytest.raises(KeyboardInterrupt), Interrupt(), Interrupt():
        signal.raise_signal(signal.SIGINT)
        check_interrupt()
        pytest.fail("ran on")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


RUN_WITH_FREQUENT_REPORTS = """
from bearingwear.__main__ import run_program
from bearingwear.solvers.dynamic import windows

windows.REPORT_EVERY = 0.1
raise SystemExit(run_program())
"""


def test_ctrl_c_ends_a_run_that_would_take_hours(tmp_path):
    """Its last line is `interrupted`, its exit status 130, and there is no file."""
    argv = ["solve", str(S1), "-o", str(tmp_path / "x.nc"), "--fidelity", "dynamic"]
    argv += ["--set", "model.simulated_turns=1000000", "model.history_points_per_turn=0"]
    argv += ["--set", "operation.rotating_load_N=1"]
    run = subprocess.Popen(
        [sys.executable, "-c", RUN_WITH_FREQUENT_REPORTS, *argv],
        cwd=ROOT,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    )
    limit = threading.Timer(300.0, run.kill)  # kernels are compiled first
    limit.start()
    try:
        first = run.stderr.readline()  # progress: it is in the midst
        if first.startswith("compiling"):
            first = run.stderr.readline()
        time.sleep(0.2)
        run.send_signal(signal.SIGINT)
        _, rest = run.communicate()
    finally:
        limit.cancel()
        run.kill()
    assert first.startswith(f"{S1}: ")
    assert run.returncode == 130 and rest.splitlines()[-1] == "interrupted"
    assert "Traceback" not in rest and os.listdir(tmp_path) == []


def test_stiffness_is_that_of_the_bearing_without_its_cage():
    """A ball that its pocket holds tightly is no stiffer against the race."""
    short = ["model.simulated_turns=3", "model.history_points_per_turn=0", "friction.cage=0.0"]

    def stiffness(clearance_mm):
        changes = [f"cage.pocket_clearance_mm={clearance_mm}", *short]
        return dynamic_run.solve_dynamic(load_scene(S1, changes))[0]["axial_stiffness"]

    assert stiffness(1e-4) == pytest.approx(stiffness(0.15), rel=1e-2)
