"""Commands: what they print, write and exit with."""

import inspect
import json
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from support import ROOT, numbers_in, only_line, scene_file, step, without_waits

from bearingwear import cli, console
from bearingwear.application import applications
from bearingwear.arguments import command_parser
from bearingwear.atomic import SIGNATURE
from bearingwear.cli import _parsed_arguments, main
from bearingwear.kernels import status as code
from bearingwear.lives import life as life_model
from bearingwear.lives.ends import NO_CRITERION
from bearingwear.results.netcdf import load
from bearingwear.results.warnings import warnings_in
from bearingwear.solvers import solve as solve_model
from bearingwear.solvers.result import Result

SCENE = scene_file("gyro_s1")
QUICK = ["--set", "model.strips=10", "--set", "model.tolerance=1.0e-3"]


def run_solve(output, *options) -> int:
    """Runs `bearingwear solve` with a coarse model, and returns its exit status."""
    return main(["solve", str(SCENE), "-o", str(output), *QUICK, *options])


# solve


def test_solve_prints_the_sheet_that_its_file_has(tmp_path, capsys):
    assert run_solve(tmp_path / "new" / "case.nc") == 0
    sheet, err = capsys.readouterr()
    assert err.endswith("new: new folder\n")  # before it, that kernels are compiled
    assert main(["show", str(tmp_path / "new" / "case.nc")]) == 0
    assert capsys.readouterr().out == sheet and "axial stiffness" in sheet
    assert os.listdir(tmp_path / "new") == ["case.nc"]
    case = load(tmp_path / "new" / "case.nc")
    assert int(case["status"]) == code.OK
    assert case.sizes["strip"] == 10 and case.sizes["ball"] == 1
    assert float(case["residual_preload"]) == pytest.approx(7.0)
    assert "wall_time_s" not in case.attrs


def test_solve_twice_gives_the_same_bytes(tmp_path):
    assert run_solve(tmp_path / "a.nc") == run_solve(tmp_path / "b.nc") == 0
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_record_timing_stores_the_wall_time(tmp_path):
    assert run_solve(tmp_path / "a.nc", "--record-timing") == 0
    assert load(tmp_path / "a.nc").attrs["wall_time_s"] > 0.0


def failing_solve(status):
    """Returns a function to replace `solve`, whose result has a status and no values."""

    def solve_in_vain(scene, fidelity=None, restart=None, progress=None):
        return Result({"status": status}, {"fidelity": "steady"})

    return solve_in_vain


def test_a_failed_solve_has_exit_status_3_one_line_and_a_file_with_its_status(
    tmp_path, capsys, monkeypatch
):
    """With --record-failures, the exit status is 0."""
    status = code.CONTACT_LOST
    monkeypatch.setattr(solve_model, "solve", failing_solve(status))
    assert run_solve(tmp_path / "a.nc") == 3
    err = capsys.readouterr().err
    assert err.count("\n") == 1 and err.startswith(f"{SCENE}: {code.STATUS_NAMES[status]}: ")
    case = load(tmp_path / "a.nc")
    assert int(case["status"]) == status and np.isnan(case["total_qv"])
    assert run_solve(tmp_path / "b.nc", "--record-failures") == 0


# a program that sends itself a signal while it imports numba, or when a file is half written
INTERRUPTED = """
import os, signal, sys
from bearingwear import __main__, atomic, cli

number = int(sys.argv.pop())

class Finder:
    def find_spec(name, *_):
        if name == "numba":
            interrupt()

def interrupt():
    try:
        os.kill(os.getpid(), number)
    except BaseException:
        raise ImportError("as C code may do")

def write():
    with atomic.whole_file("out.nc") as part:
        part.write_text("half")
        interrupt()

if sys.argv[1] == "write":
    cli.main = write
sys.meta_path.insert(0, Finder)
__main__.run_program()
"""


@pytest.mark.parametrize(
    "arguments, number, problem",
    [
        (["write"], signal.SIGTERM, "terminated\n"),
        (["write"], signal.SIGINT, "interrupted\n"),
        (["solve", str(SCENE)], signal.SIGINT, "interrupted\n"),
    ],
)
def test_an_interrupted_import_or_write_leaves_no_trace(arguments, number, problem, tmp_path):
    """A signal comes while numba is imported, or a file is half written.

    There is one line, no traceback and no file, and the exit status is 128 + the signal's number.
    """
    completed = subprocess.run(
        [sys.executable, "-c", INTERRUPTED, *arguments, str(int(number))],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert (completed.returncode, completed.stdout, completed.stderr) == (128 + number, "", problem)
    assert os.listdir(tmp_path) == []


# a program whose command ends with status 3, and whose last object then sends a signal
ENDING = """
import os, signal, sys
from bearingwear import __main__, cli

class Last:
    def __del__(self, kill=os.kill, process=os.getpid(), number=signal.SIGINT):
        print("late", flush=True)
        kill(process, number)

last = Last()
cli.main = lambda: 3
sys.exit(__main__.run_program())
"""


def test_an_interrupt_while_python_ends_keeps_the_exit_status():
    """The command has ended with status 3 when an object that Python deletes sends the signal."""
    completed = subprocess.run([sys.executable, "-c", ENDING], capture_output=True, text=True)
    assert (completed.returncode, completed.stdout, completed.stderr) == (3, "late\n", "")


# life


def test_a_quiet_life_prints_its_warnings_alone(tmp_path, capsys):
    """Standard error has a line for each warning of the file, in the same order."""
    words = ["life", str(SCENE), "-o", str(tmp_path / "life.nc"), *QUICK]
    assert main([*words, "--quiet", "--set", "operation.preload_method=fixed_position"]) == 0
    out, err = capsys.readouterr()
    lines = without_waits(err).splitlines()
    assert out == "" and all(line.startswith("warning: ") for line in lines)
    sentences = [warning["sentence"] for warning in warnings_in(load(tmp_path / "life.nc").attrs)]
    assert sentences
    for sentence, line in zip(sentences, lines, strict=True):
        assert sentence in line


def test_a_life_writes_a_file_with_its_history(tmp_path):
    words = ["life", str(SCENE), "-o", str(tmp_path / "life.nc"), *QUICK]
    assert main([*words, "--quiet"]) == 0
    life = load(tmp_path / "life.nc")
    assert int(life["status"]) == code.OK
    assert life["life"].dims == () and float(life["life"]) > 0.0
    assert life.attrs["wear_counts"] == "ball_and_races"
    assert life.sizes["step"] > 2


def test_a_life_without_an_end_has_exit_status_3(tmp_path, monkeypatch):
    def life_without_end(scene, fidelity, progress):
        return Result({"status": code.CRITERION_NOT_REACHED, "end_criterion": NO_CRITERION})

    monkeypatch.setattr(life_model, "life", life_without_end)
    words = ["life", str(SCENE), "-o", str(tmp_path / "life.nc")]
    assert main(words) == 3
    assert main([*words, "--record-failures"]) == 0
    assert np.isnan(load(tmp_path / "life.nc")["life"]).all()


# check, show, help


def test_check_names_the_scene_and_its_model(capsys):
    assert main(["check", str(SCENE)]) == 0
    out, err = capsys.readouterr()
    title, *_ = out.splitlines()
    assert "gyro_s1" in title and "steady model" in title and not err


def test_check_states_why_a_radial_load_requires_the_dynamic_model(capsys):
    assert main(["check", str(SCENE), "--set", "operation.radial_load_N=[0, 1]"]) == 0
    out = capsys.readouterr().out
    assert "dynamic model" in out and "radial load" in out


def command_process(stdout, *words, unbuffered=""):
    """Runs a command in a process of its own, and returns the completed process.

    stdout: file to which it prints.
    unbuffered: value of PYTHONUNBUFFERED; an empty one has no effect.
    """
    return subprocess.run(
        [sys.executable, "-m", "bearingwear", *words],
        stdout=stdout,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONUNBUFFERED": unbuffered},
    )


@pytest.mark.parametrize("scene", ["{", "{}x", '{"name": 1}', "[" * 10_000])
def test_show_refuses_a_file_whose_scene_cannot_be_read(scene, tmp_path, capsys):
    """Result files may come from other people."""
    rewrite_scene(tmp_path / "a.nc", lambda text: scene)
    assert main(["show", str(tmp_path / "a.nc")]) == 2
    assert "damaged file" in only_line(capsys)


def test_show_replaces_control_characters_of_a_file(tmp_path, capsys):
    """A terminal would obey them; they are shown as `?`."""
    rewrite_scene(tmp_path / "a.nc", lambda text: text.replace("gyro_s1", "a\\u001b[2Jb", 1))
    assert main(["show", str(tmp_path / "a.nc")]) == 0
    out = capsys.readouterr().out
    assert out.startswith("a?[2Jb: 9 balls") and "\x1b" not in out


def rewrite_scene(path, change):
    """Writes a case whose attribute `scene` is changed by a function of its text."""
    import netCDF4

    assert run_solve(path, "--quiet") == 0
    with netCDF4.Dataset(path, "a") as file:
        file.scene = change(file.scene)


# Python writes buffered text when it ends, where no command can catch an error.
BUFFERING = pytest.mark.parametrize("unbuffered", ["", "1"], ids=["buffered", "unbuffered"])


@BUFFERING
def test_a_closed_pipe_ends_a_command_without_a_message(unbuffered, tmp_path):
    run_solve(tmp_path / "a.nc")
    reader, writer = os.pipe()
    os.close(reader)
    try:
        completed = command_process(writer, "show", str(tmp_path / "a.nc"), unbuffered=unbuffered)
    finally:
        os.close(writer)
    assert completed.returncode == 0 and completed.stderr == ""


@BUFFERING
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_a_full_disk_ends_a_command_with_a_message(unbuffered):
    with open("/dev/full", "w") as full:
        completed = command_process(full, "check", str(SCENE), unbuffered=unbuffered)
    assert completed.returncode == 2
    assert completed.stderr == "bearingwear: No space left on device\n"


@pytest.mark.parametrize(
    "argv",
    [
        [],
        ["prove"],
        ["solve"],
        ["solve", "a.yaml", "--json", "--csv"],
        ["check", "a.yaml", "--set", "a=1", "b"],
        ["study", "--report", "results/a.html"],
        ["study", "--report", "a.html", "a.yaml"],
    ],
)
def test_wrong_arguments_are_refused_in_one_line_that_names_help(argv, capsys):
    assert main(argv) == 2
    err = only_line(capsys)
    assert err.startswith("bearingwear") and "--help" in err


@pytest.mark.parametrize("option", ["-f", "--forcerun", "--configfile"])
def test_the_name_of_a_study_must_come_before_options_for_snakemake(option, capsys):
    assert main(["study", option, "results/a.nc"]) == 2
    assert f"got results/a.nc after {option}" in only_line(capsys)
    args = _parsed_arguments(["study", "all", option, "results/a.nc"])
    assert (args.name, args.more) == ("all", [option, "results/a.nc"])


@pytest.mark.parametrize("option", [["--at-speed-only"], ["--warmup"], ["--warmup", "3"]])
def test_an_option_on_requirements_is_refused_for_a_study_without_a_scene(option, capsys):
    assert main(["study", "all", *option]) == 2
    assert f"got {option[0]} without a scene" in only_line(capsys)


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (["-o", "x.nc", "b\nc"], "-o: got 2 files, expected one, or --each KEY=VALUE,VALUE..."),
        (["--each", "friction.ball_race=0.1,0.2", "-o", "x.nc"], "--each: got friction.ball_race="),
        (["--each", "friction.ball_race", "-o", "x.nc"], "--each: got friction.ball_race with 1"),
        (["--each", "friction.bal=1", "-o", "x.nc"], "--set friction.bal: got an unknown key"),
    ],
)
def test_each_is_refused_unless_it_has_a_file_for_each_value(
    arguments, problem, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    assert main(["solve", str(SCENE), *arguments]) == 2
    assert only_line(capsys).startswith(problem)
    assert os.listdir() == []


def test_each_writes_the_files_that_single_solves_write(tmp_path):
    """The files are equal byte for byte, and can be gathered into a study."""
    key, values = "wear.ball_diameter_loss_um", ("0", "0.5")
    case = "constant_force-mu0.050-loss{:.2f}.nc"
    files = [str(tmp_path / case.format(float(value))) for value in values]
    options = ["--set", "friction.ball_race=0.05", "--quiet"]
    each_option = ["--each", f"{key}={','.join(values)}", "-o", *files]
    assert main(["solve", str(SCENE), *options, *each_option]) == 0
    for value, file in zip(values, files, strict=True):
        single = tmp_path / "single.nc"
        single_option = ["--set", f"{key}={value}", "-o", str(single)]
        assert main(["solve", str(SCENE), *options, *single_option]) == 0
        assert single.read_bytes() == Path(file).read_bytes()
    assert main(["gather", *files, "-o", str(tmp_path / "study.nc")]) == 0
    assert load(tmp_path / "study.nc").sizes["ball_diameter_loss"] == 2


def test_each_reports_every_unsolved_value(tmp_path, capsys):
    """Each has its line; the exit status is 3, or 0 with --record-failures.

    Without friction, no value is solved.
    """
    words = ["solve", str(SCENE), "--set", "friction.ball_race=0", "--quiet"]
    words += ["--each", "wear.ball_diameter_loss_um=0,0.5"]
    words += ["-o", str(tmp_path / "a.nc"), str(tmp_path / "b.nc")]
    assert main(words) == 3
    assert capsys.readouterr().err.count("undetermined") == 2
    assert main([*words, "--record-failures"]) == 0
    assert capsys.readouterr().err.count("undetermined") == 2


# steps


def test_every_command_has_a_handler():
    """The handler is the function of that name in `commands`, or belongs to an application."""
    from bearingwear import commands
    from bearingwear.results.kinds import imported_function

    (choices,) = (action.choices for action in command_parser()._actions if action.choices)
    handlers = {
        name: imported_function(parser.get_default("run")) for name, parser in choices.items()
    }
    functions = inspect.getmembers(commands, inspect.isfunction)
    in_commands = {
        name: function
        for name, function in functions
        if function.__module__ == commands.__name__ and not name.startswith("_")
    }
    of_applications = {application.command for application in applications()}
    assert {name: handlers[name] for name in set(choices) - of_applications} == in_commands


@pytest.mark.parametrize(
    "settings", [{"changes": {"model.strips": 10}}, {"changes": {}, "fidelity": "steady"}]
)
def test_a_step_solves_as_the_command_does(tmp_path, settings, capsys):
    """The step prints nothing and writes the same bytes."""
    assert step("studies.solve.solved_case", tmp_path / "a.nc", scene=SCENE, settings=settings) == 0
    changes = settings["changes"].items()
    options = [text for key, value in changes for text in ("--set", f"{key}={value}")]
    if "fidelity" in settings:
        options += ["--fidelity", settings["fidelity"]]
    assert capsys.readouterr() == ("", "")  # rules print no sheets
    assert main(["solve", str(SCENE), "-o", str(tmp_path / "b.nc"), "--quiet", *options]) == 0
    assert capsys.readouterr() == ("", "")
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


@pytest.mark.parametrize(
    ("run", "problem"),
    [
        (
            "studies.grid.gather.nothing",
            "step: got bearingwear.studies.grid.gather.nothing, which does not exist",
        ),
        (
            "studies.nothing.gather.gathered_study",
            "step: got bearingwear.studies.nothing.gather.gathered_study, which does",
        ),
    ],
)
def test_an_unknown_step_is_refused(run, problem, tmp_path, capsys):
    assert step(run, tmp_path / "a.nc") == 2
    assert only_line(capsys).startswith(problem)
    assert os.listdir(tmp_path) == []


def test_an_unsolved_step_reports_its_status_and_ends_with_0(tmp_path, capsys):
    """A study then continues without the case, whose file has the status."""
    settings = {"changes": {"friction.ball_race": 0}}
    assert step("studies.solve.solved_case", tmp_path / "a.nc", scene=SCENE, settings=settings) == 0
    assert only_line(capsys).startswith(f"{SCENE}: undetermined: ")
    assert int(load(tmp_path / "a.nc")["status"]) == code.UNDETERMINED


def test_a_function_of_another_package_is_no_step(tmp_path, capsys):
    assert main(["step", "os.system", "command=ls", "-o", str(tmp_path / "a.nc")]) == 2
    assert only_line(capsys).startswith("step: got os.system, expected bearingwear.MODULE.FUNCTION")


@pytest.mark.parametrize(
    "words", [["scene"], ["scene=a", "b"], ["scene=a", "fidelity=steady", "c=1"], ["=a"]]
)
def test_wrong_arguments_of_a_step_are_refused_in_one_line(words, tmp_path, capsys):
    step_words = ["step", "bearingwear.studies.solve.solved_case", *words]
    assert main([*step_words, "-o", str(tmp_path / "a.nc")]) == 2
    only_line(capsys)
    assert os.listdir(tmp_path) == []


# outputs that are refused


def test_a_folder_as_output_is_refused(tmp_path, capsys):
    assert run_solve(tmp_path) == 2
    assert "a folder or a device" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["new/", ""])
def test_an_output_without_a_file_name_is_refused(name, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run_solve(name) == 2
    assert f"got {name!r}, expected a file name" in only_line(capsys)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("name", ["x" * 300, "x" * 250, "\udcff.nc"])
def test_an_output_with_an_impossible_name_is_refused(name, tmp_path, capsys):
    assert run_solve(tmp_path / name) == 2
    assert "cannot be written" in only_line(capsys)
    assert os.listdir(tmp_path) == []


def test_the_scene_itself_as_output_is_refused(tmp_path, capsys):
    mine = tmp_path / "mine.yaml"
    shutil.copy(SCENE, mine)
    assert main(["solve", str(mine), "-o", str(mine)]) == 2
    assert "the scene itself" in capsys.readouterr().err
    assert mine.read_text() == SCENE.read_text()


def test_a_table_of_points_that_is_not_utf8_is_refused_with_that_reason(tmp_path, capsys):
    table = tmp_path / "rows.csv"
    table.write_text("operation.preload_N\né\n", encoding="latin-1")
    assert main(["sweep", str(SCENE), "--rows", str(table), "-o", str(tmp_path / "a.nc")]) == 2
    problem = f"{table}: got a file that cannot be read (its text is not UTF-8)"
    assert without_waits(capsys.readouterr().err).startswith(problem)


@pytest.mark.parametrize("words", [["uncertainty"], ["solve", "--each", "friction.ball_race=0.1"]])
def test_a_missing_scene_is_refused_by_its_name_if_the_output_exists(words, tmp_path, capsys):
    """Not by the name of the output, which is compared with the scene."""
    scene, output = tmp_path / "missing.yaml", tmp_path / "a.nc"
    output.write_bytes(SIGNATURE)
    command, *options = words
    assert main([command, str(scene), *options, "-o", str(output)]) == 2
    error = without_waits(capsys.readouterr().err)
    assert error.startswith(f"{scene}: got a file that cannot be read")


@pytest.mark.parametrize("command", ["solve", "life", "uncertainty"])
def test_an_output_that_would_replace_another_file_is_refused(command, tmp_path, capsys):
    other = tmp_path / "other.yaml"
    other.write_text("name: another scene\n")
    assert main([command, str(SCENE), "-o", str(other)]) == 2
    assert "got an existing file that is not a result" in capsys.readouterr().err
    assert other.read_text() == "name: another scene\n"


@pytest.mark.parametrize("command", ["solve", "life", "uncertainty"])
def test_an_output_that_would_replace_a_read_only_file_is_refused(command, tmp_path, capsys):
    """It is refused before anything is solved, and for root, too, who could write to it."""
    result = tmp_path / "kept.nc"
    assert run_solve(result) == 0
    content = result.read_bytes()
    result.chmod(0o444)
    capsys.readouterr()
    assert main([command, str(SCENE), "-o", str(result)]) == 2
    problem = f"{result}: got a read-only file, expected a different file name"
    assert only_line(capsys).strip() == problem
    assert result.read_bytes() == content


def test_an_output_in_a_folder_without_write_permission_is_refused(tmp_path, capsys):
    if os.geteuid() == 0:
        folder = Path("/proc")  # not even root can write there
    else:
        folder = tmp_path / "closed"
        folder.mkdir(mode=0o500)
    assert run_solve(folder / "a.nc") == 2
    assert "cannot be written" in capsys.readouterr().err


# one line in all cases


@pytest.mark.parametrize(
    ("command", "meant"),
    [("slove", "solve"), ("sovle", "solve"), ("plto", "plot"), ("checks", "check")],
)
def test_a_mistyped_command_is_refused_with_the_nearest_one(command, meant, capsys):
    assert main([command]) == 2
    assert f"{command!r}; did you mean {meant}" in capsys.readouterr().err


def test_a_mistyped_option_is_refused_with_the_nearest_one(capsys):
    """No option is suggested if none is similar."""
    assert main(["recommend", "mine.yaml", "--stifness=10"]) == 2
    assert "'--stifness=10', which this command does not accept; did you mean --stiffness" in (
        capsys.readouterr().err
    )
    assert main(["solve", "mine.yaml", "--frobnicate"]) == 2
    assert "did you mean" not in capsys.readouterr().err


def test_plot_accepts_the_figure_and_the_result_in_either_order(tmp_path, capsys):
    """Without a figure, it draws beside the result. Not exactly one result is refused."""
    file, figure = tmp_path / "a.nc", tmp_path / "a.png"
    assert run_solve(file, "--quiet") == 0
    assert main(["plot", "-o", str(file), str(figure)]) == 0
    assert capsys.readouterr() == (f"{figure}: written\n", "")
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert main(["plot", str(file)]) == 0
    assert (tmp_path / "a.svg").is_file() and file.is_file()
    for argv in ([], ["-o", str(figure)], ["-o", str(file), str(file)]):
        assert main(["plot", *argv]) == 2
        assert "result files, expected one (FILE.nc)" in capsys.readouterr().err


def test_recommend_prints_limits_and_results_as_json(capsys):
    limits = ["--bearing-stiffness", "4", "--power", "0.05"]
    assert (
        main(["recommend", str(SCENE), *limits, "--json", "--set", "friction.ball_race=0.05"]) == 0
    )
    data = json.loads(capsys.readouterr().out)
    assert [numbers_in(limit) for limit in data["limits"]] == [[4.0], [0.05]]  # N/um, W
    assert list(data["none_because"]) == ["fixed_position"]
    assert {row["name"] for row in data["quantities"]} >= {"preload", "life", "axial_stiffness"}


def test_warnings_are_printed_once(capsys):
    worn = ["solve", str(SCENE), "--set", "wear.ball_diameter_loss_um=0.3"]
    assert main(worn) == 0
    output, error = capsys.readouterr()
    assert output.count("warning: ") == 1 and error == ""
    assert main([*worn, "--quiet"]) == 0
    output, error = capsys.readouterr()
    assert output == "" and error.count("warning: ") == 1 and 0.3 in numbers_in(error)


def test_commands_create_one_folder_and_report_it(tmp_path, capsys):
    folder, figure_folder = tmp_path / "cases", tmp_path / "figures"
    solve = ["solve", str(SCENE), "-o", str(folder / "case.nc"), "--quiet"]
    assert main(solve) == 0
    assert capsys.readouterr().err == f"{folder}: new folder\n"
    assert main(solve) == 0
    assert capsys.readouterr().err == ""  # the folder is not new
    assert main(["plot", str(folder / "case.nc"), "-o", str(figure_folder / "a.svg")]) == 0
    assert capsys.readouterr().err == f"{figure_folder}: new folder\n"


@pytest.mark.parametrize(
    "words",
    [
        ["solve", str(SCENE), "-o", "new/folder/case.nc"],
        ["new", "new/folder/a.yaml", "7008C"],
        ["study", str(SCENE), "-o", "new/folder/a.yaml"],
    ],
)
def test_more_than_one_new_folder_is_refused(words, tmp_path, monkeypatch, capsys):
    """The path is then probably mistyped; nothing is created."""
    monkeypatch.chdir(tmp_path)
    assert main(words) == 2
    assert "got more than one new folder, expected" in capsys.readouterr().err
    assert os.listdir() == []


def test_the_skid_ratio_has_the_same_sign_in_a_case_and_in_a_life(capsys):
    """It is the lag behind rolling: negative without drag, where the balls lead."""

    def skid_ratio_row(command):
        """Returns the row of the skid ratio as a command prints it for programs."""
        assert main([command, str(SCENE), "--json", "--set", "lubricant.drag_density_kg_m3=0"]) == 0
        rows = json.loads(capsys.readouterr().out)["quantities"]
        (row,) = [row for row in rows if row["name"] == "skid_ratio"]
        return row

    ratio = skid_ratio_row("solve")["value"]
    assert ratio < 0.0
    assert skid_ratio_row("life")["values"]["start"] == pytest.approx(ratio, rel=1e-6)


def test_uncertainty_without_a_solved_life_has_exit_status_3(tmp_path, capsys):
    scene, file = tmp_path / "a.yaml", tmp_path / "a.nc"
    text = SCENE.read_text(encoding="utf-8")
    scene.write_text(text.replace("preload_N: 7.0", "preload_N: 1.0e+6"), encoding="utf-8")
    assert main(["uncertainty", str(scene), "--samples", "4", "-o", str(file)]) == 3
    output, error = capsys.readouterr()
    assert not output and error.endswith(f"{scene}: no life could be computed (see {file})\n")


def test_recommend_without_a_solved_life_has_exit_status_3(capsys):
    assert main(["recommend", str(SCENE), "--set", "friction.ball_race=0"]) == 3
    output, error = capsys.readouterr()
    (line,) = without_waits(error).splitlines()
    assert output == "" and line.startswith(f"{SCENE}: no life")


def test_recommend_with_a_requirement_but_no_solved_life_has_exit_status_4(capsys):
    words = ["recommend", str(SCENE), "--set", "friction.ball_race=0", "--pressure", "2"]
    assert main(words) == console.INFEASIBLE
    output, error = capsys.readouterr()
    *_, line = error.splitlines()
    assert line.startswith(f"{SCENE}: no preload") and "no life" in output


@pytest.mark.parametrize(
    "arguments, problem",
    [
        (["--stiffness", "0"], "argument --stiffness: got '0', expected a number > 0"),
        (
            ["--pressure", "2000"],
            "--pressure: got '2000', expected a number > 0 and <= 20",
        ),
        (
            ["--set", "operation.rotating_load_N=1"],
            "expected one with a steady state (to compute a single life",
        ),
    ],
)
def test_recommend_refuses_impossible_requirements_and_scenes_in_one_line(
    capsys, arguments, problem
):
    assert main(["recommend", str(SCENE), *arguments]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert problem in line


def test_every_exit_status_is_documented():
    text = (ROOT / "docs" / "quickstart.md").read_text(encoding="utf-8")
    documented = {int(status) for status in re.findall(r"^\| (\d+) \|", text, re.M)}
    statuses = {console.SUCCESS, console.BAD_INPUT, console.NOT_SOLVED, console.INFEASIBLE}
    assert documented == statuses | {cli.FULL_DISK, cli.INTERRUPTED}
    epilog = command_parser().epilog
    assert all(re.search(rf"\b{status}\b", epilog) for status in documented)
