"""One command from a bearing to its report: a study of one scene, small enough for a test."""

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time

import psutil
import pytest
import yaml
from support import ROOT, numbers_in, scene_file
from workflow.conftest import Run

from bearingwear.cli import main
from bearingwear.results.netcdf import load
from bearingwear.studies import own_study
from bearingwear.studies.design import plan as design_plan


@pytest.fixture
def study(tmp_path, monkeypatch, capfd):
    """Returns a function that runs `bearingwear study mine.yaml -o folder` with more options.

    The function returns exit status and output. mine.yaml is gyro_s1; grid, samples and map are
    small.
    """
    monkeypatch.setattr(own_study, "FRICTIONS", (1.0,))
    monkeypatch.setattr(own_study, "STATES_OF_WEAR", 2)
    monkeypatch.setattr(own_study, "SAMPLES", 16)
    monkeypatch.setattr(design_plan, "FACTORS", (0.25, 0.5, 1.0, 2.0))
    monkeypatch.chdir(tmp_path)
    shutil.copy(scene_file("gyro_s1"), tmp_path / "mine.yaml")

    def run(*arguments):
        capfd.readouterr()
        status = main(["study", "mine.yaml", "-o", "folder", *arguments])
        out, err = capfd.readouterr()
        return status, err + out

    return run


def text_of(page):
    """Returns the text of a page with plain spaces in place of those at which no line breaks."""
    text = page.read_text(encoding="utf-8").replace("\N{NO-BREAK SPACE}", " ")
    return text.replace("\N{WORD JOINER}", "")


def rules(output):
    """Returns the names of the rules in the table of jobs that a run printed."""
    return set(Run(0, output).jobs)


@pytest.mark.long
def test_a_study_of_one_scene_ends_with_its_page(study, tmp_path):
    """Run again, it does what is left: nothing, a deleted result, other limits, an edited scene.

    This is one test, as it takes minutes and each run goes on from the one before. Exit status 4
    means that no preload satisfies the limits.
    """
    folder = tmp_path / "folder"
    status, output = study("-j2", "--stiffness", "3")
    assert status == 0, output
    page = text_of(folder / "index.html")
    headline = re.search("<h1>(.*)</h1>", page)[1]
    assert output.splitlines()[-1].endswith("folder/index.html")
    assert f"gyro_s1: {headline[0].lower()}{headline[1:]}" in output
    preload, stiffness, *_ = numbers_in(headline)
    # the preload is a regression value of this page
    assert "(constant force)" in headline and preload == pytest.approx(4.1, abs=0.1)
    assert stiffness == 3.0 and "L10" in page
    dataset = load(folder / "results/mine/preload/recommendation.nc")
    assert float(dataset["system_axial_stiffness"].min()) >= 3.0e6
    # two methods, one friction, three states of wear, and two lives
    assert (folder / "results/verdict.txt").read_text() == "all 8 solved and verified\n"

    # again: nothing to do, and the same result
    last_lines = output.splitlines()[-2:]
    status, output = study("-j2", "--stiffness", "3")
    assert status == 0 and "Nothing to be done" in output
    assert output.splitlines()[-2:] == last_lines and headline[1:] in last_lines[0]

    # a deleted result that a figure is made from
    config = yaml.safe_load((folder / "config/config.yaml").read_text(encoding="utf-8"))
    worn = config["figures"]["worn_loss_um"]
    (case, *_) = sorted((folder / "results/mine").glob(f"cases/*-loss{worn:.2f}.nc"))
    contents = case.read_bytes()
    case.unlink()
    status, output = study("-j2", "--stiffness", "3")
    assert status == 0 and case.read_bytes() == contents, output

    # other limits: no case is solved again
    status, output = study("-j2", "--stiffness", "900")
    assert status == 4 and not {"solve", "solve_chunk", "spread"} & rules(output)
    assert "no preload" in output and "at least 900 N/µm" in text_of(folder / "index.html")

    # an edited scene: what depends on it, in the copy as well
    mine = tmp_path / "mine.yaml"
    mine.write_text(mine.read_text().replace("preload_N: 7.0", "preload_N: 8.0"))
    status, output = study("-n")
    assert status == 0 and rules(output) >= {"solve_chunk", "spread", "small_map"}


def test_a_dry_run_makes_no_folder(study, tmp_path):
    """It plans cases, a map of preloads and the page."""
    status, output = study("-n", "--stiffness", "3")
    assert status == 0 and rules(output) >= {"solve_chunk", "small_map", "page"}
    assert [path.name for path in tmp_path.iterdir()] == ["mine.yaml"]


# the command in a process of its own; and as the installed program finds modules
STUDY = [sys.executable, "-m", "bearingwear", "study", "mine.yaml"]
COMMAND = [sys.executable, "-P", "-m", "bearingwear", "study", "mine.yaml"]


@pytest.fixture
def in_a_folder(tmp_path):
    """Returns options of a process that runs in a folder with the scene mine.yaml alone."""
    shutil.copy(scene_file("gyro_s1"), tmp_path / "mine.yaml")
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return {"cwd": tmp_path, "env": os.environ | {"PYTHONPATH": str(ROOT)}, **pipes}


def test_an_interrupt_ends_the_command_and_all_that_it_started(in_a_folder):
    """Snakemake and its jobs end, too. The exit status is 130; the last line says interrupted."""
    run = subprocess.Popen(STUDY, **in_a_folder)
    time.sleep(4.0)  # by then Snakemake runs its first jobs
    children = psutil.Process(run.pid).children(recursive=True)
    run.send_signal(signal.SIGINT)
    _, output = run.communicate(timeout=60)
    assert run.returncode == 130 and output.endswith("interrupted\n") and "Traceback" not in output
    _, alive = psutil.wait_procs(children, timeout=30)
    # one that ended stays in the table of processes as long as no parent reads its status
    assert all(child.status() == psutil.STATUS_ZOMBIE for child in alive)


@pytest.mark.long
def test_python_files_beside_the_scene_are_not_imported(in_a_folder):
    """Each of them would end the process that imports it; they have names of modules in use."""
    for name in ("signal", "calendar", "numpy", "bearingwear"):
        (in_a_folder["cwd"] / f"{name}.py").write_text("raise SystemExit('imported')\n")
    completed = subprocess.run([*COMMAND, "-n"], timeout=300, **in_a_folder)
    assert completed.returncode == 0 and "imported" not in completed.stdout + completed.stderr


@pytest.mark.long  # of other commands: tests/test_cli.py
def test_a_closed_pipe_ends_the_study(in_a_folder):
    """`head -1` takes a line and closes the pipe; no traceback follows."""
    text = f"{shlex.join(STUDY)} -n 2>&1 | head -1"
    completed = subprocess.run(["sh", "-c", text], timeout=300, **in_a_folder)
    assert completed.stdout.count("\n") == 1 and "Traceback" not in completed.stderr


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ((), "folder: got a folder with other files, expected a new folder"),
        (("--stiffness", "-3"), "argument --stiffness: got '-3', expected a number > 0"),
        (
            ("--stifness", "3"),
            "'--stifness', which this command does not accept; did you mean --sti",
        ),
        (("--json",), "got '--json', which this command does not accept; `bearingwear recommend`"),
        (("other.yaml",), "got 'other.yaml' after the scene, expected one scene and options"),
        (("--rerun-triggers", "x"), "--rerun-triggers: invalid choice: 'x'"),
        (("-o", "mine.yaml"), "mine.yaml: got a file, expected a folder"),
    ],
)
def test_wrong_arguments_of_study_are_refused_in_one_line(study, arguments, expected, tmp_path):
    """The status is 2. Without arguments, the fault is another file in the folder."""
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "notes.txt").touch()
    status, printed = study(*arguments)
    assert status == 2 and len(printed.splitlines()) == 1 and expected in printed
    assert sorted(path.name for path in tmp_path.iterdir()) == ["folder", "mine.yaml"]


@pytest.mark.parametrize(
    "arguments",
    [["all", "--power", "3"], ["missing.yaml"], ["nothing"]],
    ids=["limits without a scene", "missing scene", "folder without a configuration"],
)
def test_a_study_of_nothing_is_refused(arguments, tmp_path, monkeypatch):
    """The status is 2, and no file is made."""
    monkeypatch.chdir(tmp_path)
    assert main(["study", *arguments]) == 2
    assert not list(tmp_path.iterdir())


@pytest.mark.long
def test_a_pair_is_studied_as_a_bearing_is(study, tmp_path):
    """A spring pair is compared with a rigid pair in map, states of wear, lives and their spread.

    Headline and tables name pairs; figures name bearings, as a force of 1 N wears them unlike.
    """
    mine = tmp_path / "mine.yaml"
    rotor = "arrangement: {kind: spring_pair, external_axial_N: 1.0}\n"
    mine.write_text(mine.read_text(encoding="utf-8") + rotor, encoding="utf-8")
    status, output = study("-j2", "--stiffness", "4")
    assert status == 0, output
    folder = tmp_path / "folder"
    log = (folder / "logs/small_map/mine.log").read_text(encoding="utf-8")
    assert any(line.startswith("mine: ") for line in log.splitlines())
    page = text_of(folder / "index.html")
    assert re.search("<h1>.*(spring|rigid) pair .* [0-9.]+ N", page)
    assert "L10 of the median batch" in page
    assert "gyro_s1, first bearing: " in page and "gyro_s1, second bearing: " in page
    assert (folder / "results/verdict.txt").read_text() == "all 8 solved and verified\n"
    text = (folder / "results/mine/preload/tables/design.md").read_text(encoding="utf-8")
    assert "|  | spring pair | rigid pair |" in text
    dataset = load(folder / "results/mine/preload/recommendation.nc")
    assert float(dataset["system_axial_stiffness"].min()) >= 4.0e6 * (1.0 - 1e-6)
    status, output = study("-j2", "--stiffness", "4")
    assert status == 0 and "Nothing to be done" in output
    # a command that is refused does not name the page that is there
    status, output = study("--no-such-option")
    assert status == 2 and "page: " not in output
