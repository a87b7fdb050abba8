"""Breaks a study on purpose; the commands of the README then finish it, and no result is lost.

The results are compared, byte by byte, with those of an undisturbed study. `make test-faults` runs
these tests.
"""

import base64
import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import psutil
import pytest
from support import ROOT

# a study of four lines, each of two cases, which one job solves
METHODS = ["constant_force", "fixed_position"]
TINY = {
    "studies": [
        {
            "scenes": ["gyro_s1"],
            "preload_method": METHODS,
            "friction": [0.05, 0.08],
            "ball_diameter_loss_um": [0, 0.5],
        },
    ],
    "figures": {"worn_loss_um": 0.5, "friction": [0.08]},
}
LINES = [f"{method}-mu{mu}" for method in METHODS for mu in ("0.050", "0.080")]
CASES = [f"{line}-loss{loss}" for line in LINES for loss in ("0.00", "0.50")]
# words before a command that root runs without its rights
WITHOUT_PRIVILEGES = ("setpriv", "--bounding-set=-all", "--inh-caps=-all")


@pytest.fixture(scope="session")
def undisturbed(new_project):
    """Returns a project whose tiny study was run without a fault; no test may change it."""
    project = tiny(new_project())
    run = project.run()
    assert run.status == 0, run.text
    return project


@pytest.fixture
def project(new_project):
    """Returns a project with the tiny study, not yet run."""
    return tiny(new_project())


def tiny(project):
    """Configures a project for TINY, and returns it.

    It has no map of preloads, which would take longer than all the rest.
    """
    project.configure(TINY)
    (project.root / "config/design.yaml").write_text("scenes: {}\n", encoding="utf-8")
    return project


@pytest.fixture
def solved_tiny_study(undisturbed, tmp_path):
    """Returns a copy of the tiny study after its run, which a test may break."""
    shutil.copytree(undisturbed.root, tmp_path / "study")
    return type(undisturbed)(tmp_path / "study")


def wait(condition, seconds=120.0):
    """Returns what a condition returns once that is true; fails after some seconds."""
    deadline = time.monotonic() + seconds
    while not (answer := condition()):
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.02)
    return answer


def finished(project):
    """Returns pairs (date [ns], bytes) of all cases that Snakemake knows to be finished, by path.

    Snakemake marks files of running jobs by names that are their paths in base64.
    """
    markers = (project.root / ".snakemake/incomplete").glob("*")
    running = {base64.b64decode(marker.name).decode() for marker in markers if marker.is_file()}
    paths = [p for p in project.cases() if p.relative_to(project.root).as_posix() not in running]
    return {path: (path.stat().st_mtime_ns, path.read_bytes()) for path in paths}


def jobs_below(process, word):
    """Returns the processes below another whose command line has a word, such as a step.

    Those that end meanwhile are left out.
    """
    jobs = []
    with suppress(psutil.Error):
        for child in psutil.Process(process.pid).children(recursive=True):
            with suppress(psutil.Error):
                if word in child.cmdline():
                    jobs.append(child)
    return jobs


def solver_processes(process):
    """Returns the processes below another that solve a line of cases, by their option."""
    return jobs_below(process, "--each")


def whole_lines(paths):
    """Returns those paths of cases whose line is whole: both of its cases are among the paths."""
    paths = list(paths)
    stems = {path.stem for path in paths}
    whole = [line for line in LINES if {case for case in CASES if line in case} <= stems]
    return {path for path in paths if path.stem.rpartition("-")[0] in whole}


def resumes(project, before, undisturbed, *arguments, ran_on=0):
    """Runs a study again, and checks that it ends with the results of the undisturbed one.

    It must not solve finished lines again, nor change their files.

    before: result of `finished` after the fault.
    ran_on: number of jobs that ran on when Snakemake was gone. They may have finished lines that
        are not in `before`, if Snakemake had not marked them as begun.
    """
    run = project.run(*arguments)
    assert run.status == 0, run.text
    kept = whole_lines(before)
    unsolved = len(LINES) - len(kept) / 2  # two cases to a line
    assert unsolved - ran_on <= run.jobs.get("solve", 0) <= unsolved
    after = finished(project)
    assert {path: after[path] for path in kept} == {path: before[path] for path in kept}
    # a process that is killed while it writes leaves a file .part
    results = project.results()
    whole = {name: data for name, data in results.items() if not name.endswith(".part")}
    assert whole == undisturbed.results()


@pytest.mark.faults
def test_a_study_goes_on_after_a_job_is_killed(project, undisturbed):
    """Snakemake fails when some cases are finished; the next run solves the others."""
    process = project.start()
    victim = wait(lambda: finished(project) and solver_processes(process))[0]
    victim.kill()
    assert process.wait(timeout=120) != 0
    before = finished(project)
    assert 1 <= len(before) < len(CASES)
    resumes(project, before, undisturbed)


@pytest.mark.faults
def test_a_study_goes_on_after_snakemake_alone_is_killed(project, undisturbed):
    """Its jobs end, too. The next run is refused, and names an option that helps.

    After `--unlock`, one with `--rerun-incomplete` goes on.
    """
    process = project.start()
    left = wait(lambda: finished(project) and solver_processes(process))
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    psutil.wait_procs(left, timeout=60)
    before = finished(project)
    assert 1 <= len(before) < len(CASES)
    refused = project.run()
    # which of the two commands it asks for depends on whether a job has ended by itself by now
    assert refused.status == 1
    assert "--rerun-incomplete" in refused.text or "--unlock" in refused.text
    assert project.run("--unlock").status == 0
    resumes(project, before, undisturbed, "--rerun-incomplete", ran_on=len(left))


@pytest.mark.faults
def test_a_study_goes_on_after_all_its_processes_are_killed(project, undisturbed):
    """The user runs `--unlock`, and then the study with `--rerun-incomplete`."""
    process = project.start()
    wait(lambda: finished(project) and solver_processes(process))
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    before = finished(project)
    assert project.run("--unlock").status == 0
    resumes(project, before, undisturbed, "--rerun-incomplete")


@pytest.mark.faults
def test_a_second_run_at_once_is_refused(project, undisturbed):
    """The lock of the first run refuses it, and the first ends with the usual results."""
    first = project.start()
    wait(lambda: list((project.root / ".snakemake/locks").glob("*")))
    second = project.run()
    assert second.status != 0 and "lock" in second.text.lower()
    assert first.wait(timeout=300) == 0
    assert project.results() == undisturbed.results()


@pytest.mark.faults
def test_a_case_that_is_written_by_several_at_once_is_whole(project, undisturbed):
    """Three commands write it without a lock: it has the bytes of a study, and no part is left."""
    case = CASES[0]
    target = f"results/gyro_s1/cases/{case}.nc"
    (project.root / target).parent.mkdir(parents=True)
    scene = "config/scenes/gyro_s1.yaml"
    settings = ["operation.preload_method=constant_force", "friction.ball_race=0.050"]
    command = [*project.command()[:1], "-m", "bearingwear", "solve", scene, "-o", target]
    command += ["--set", *settings, "wear.ball_diameter_loss_um=0.00"]
    writers = [
        subprocess.Popen(command, cwd=project.root, env=project.environment) for _ in range(3)
    ]
    assert [writer.wait(timeout=120) for writer in writers] == [0, 0, 0]
    assert project.case(case).read_bytes() == undisturbed.case(case).read_bytes()
    assert os.listdir(project.case(case).parent) == [f"{case}.nc"]


def can_mount():
    """Returns whether a process may mount a file system in a name space of its own."""
    if os.geteuid() != 0 or shutil.which("unshare") is None:
        return False
    script = "mount -t tmpfs -o size=64k none /mnt"
    return (
        subprocess.run(["unshare", "-m", "sh", "-c", script], capture_output=True).returncode == 0
    )


@pytest.mark.faults
@pytest.mark.parametrize("room", ["60k", "120k", "250k"])
def test_a_study_goes_on_after_its_results_filled_the_disk(project, undisturbed, room):
    """The first run fails on a file system of the size `room`: its files are whole, logs say why.

    The second run, with more room, solves only lines that are not whole, and has all results.
    """
    if not can_mount():
        pytest.skip("needs the right to mount a small file system of its own")
    (project.root / "results").mkdir()
    run = " ".join(project.command())
    script = f"""
        mount -t tmpfs -o size={room} none results
        mkdir results/lost+found  # else Snakemake tries to remove the empty mount point
        {run} > first.txt 2>&1 && exit 1
        cp -a results full
        cp -a logs full_logs
        mount -o remount,size=20m results
        {run} > second.txt 2>&1
        cp -a results with_room
    """
    completed = subprocess.run(
        ["unshare", "-m", "sh", "-e", "-c", script],
        cwd=project.root, env=project.environment, capture_output=True, text=True, timeout=900,
    )  # fmt: skip
    assert completed.returncode == 0, completed.stderr

    def files(folder):
        """Returns the bytes of all files below a folder of the project, by path."""
        paths = [path for path in (project.root / folder).rglob("*") if path.is_file()]
        return {p.relative_to(project.root / folder).as_posix(): p.read_bytes() for p in paths}

    logs = b"".join(files("full_logs").values())
    assert b"No space left on device" in logs
    assert b"Traceback" not in logs + (project.root / "first.txt").read_bytes()
    # each file is whole, and no half-written one is left
    full, expected = files("full"), undisturbed.results()
    assert full.items() < expected.items()
    kept = whole_lines(Path(name) for name in full if "/cases/" in name)
    assert project.last_jobs.get("solve", 0) == len(LINES) - len(kept) / 2
    assert files("with_room") == expected


@pytest.mark.faults
def test_a_study_on_a_full_disk_goes_on_with_more_room(tmp_path, undisturbed):
    """Configuration, logs and notes of Snakemake are on that disk, too; each run has more room.

    Runs that fail report it without a traceback, and leave whole files. The first run fails, the
    last succeeds. Pages are not compared.
    """
    if not can_mount():
        pytest.skip("needs the right to mount a small file system of its own")
    (tmp_path / "config/scenes").mkdir(parents=True)
    for name in ("config.yaml", "scenes/gyro_s1.yaml"):
        shutil.copy(undisturbed.root / "config" / name, tmp_path / "config" / name)
    rooms = ["20k", "36k", "60k", "120k", "250k", "500k", "800k", "20m"]
    script = f"""
        mkdir study
        mount -t tmpfs -o size={rooms[0]} none study
        cp -r config study
        for room in {" ".join(rooms)}; do
            mount -o remount,size=$room study
            (cd study; {sys.executable} -m bearingwear study -j2) > $room.txt 2>&1 || touch $room
            # the server of its jobs ends a moment later
            while ls study/.snakemake/bearingwear-*/socket 2> /dev/null; do sleep 0.1; done
            cp -a study study-$room
        done
    """
    completed = subprocess.run(
        ["unshare", "-m", "sh", "-e", "-c", script],
        cwd=tmp_path, env=undisturbed.environment, capture_output=True, text=True, timeout=900,
    )  # fmt: skip
    assert completed.returncode == 0, completed.stderr
    expected = {k: data for k, data in undisturbed.results().items() if "report/" not in k}
    for room in rooms:
        text, folder = (tmp_path / f"{room}.txt").read_text(), tmp_path / f"study-{room}"
        failed = (tmp_path / room).exists()
        logs = "".join(path.read_text() for path in folder.glob("logs/**/*.log"))
        assert "Traceback" not in text + logs, (room, text, logs)
        assert not failed or "No space left on device" in text + logs, (room, text)
        results = type(undisturbed)(folder).results()
        results = {name: data for name, data in results.items() if "report/" not in name}
        assert results.items() <= expected.items()
    assert (tmp_path / rooms[0]).exists() and not (tmp_path / rooms[-1]).exists()
    # results of the last run have all cases
    assert {name for name in results if "/cases/" in name} == {
        name for name in expected if "/cases/" in name
    }


# how a job dies as soon as it starts, and what its log says last
DEATHS = {
    "import nothing_of_that_name": "No module named 'nothing_of_that_name'",
    "raise RuntimeError('broken')": "RuntimeError: broken",
    "raise SystemExit('gone')": "gone",
    "import os; os._exit(5)": "ended with status 5 without a message",
    "import os; os.kill(os.getpid(), 9)": "ended with status 137 (by signal 9)",
}


@pytest.mark.faults
@pytest.mark.parametrize("death", DEATHS)
def test_the_log_says_why_the_process_of_a_job_ended(project, death):
    """The last line of its log says it, and so does the terminal.

    Jobs import a module that is edited to end the process of a job that solves lines (`--each`).
    """
    line = "import time\n"
    # Snakemake's own process and the job that compiles kernels import it, too
    project.edit(
        "bearingwear/solvers/solve.py",
        line,
        f"{line}import sys\nif '--each' in sys.argv: {death}\n",
    )
    case = f"results/gyro_s1/cases/{CASES[0]}.nc"
    run = project.run(case)
    assert run.status == 1
    log = project.root / f"logs/solve/gyro_s1/{LINES[0]}.log"
    assert DEATHS[death] in log.read_text(encoding="utf-8").splitlines()[-1]
    assert DEATHS[death] in run.text


@pytest.mark.faults
@pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="elsewhere jobs have no server")
def test_a_killed_command_ends_all_that_it_started(tmp_path, request):
    """Each of four signals is sent as Snakemake starts, in the map, and in the samples.

    All processes below the command end within a minute.
    """
    # a command below `nohup` ignores SIGHUP, and is right to go on
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    request.addfinalizer(lambda: signal.signal(signal.SIGHUP, before))
    shutil.copy(ROOT / "config/scenes/gyro_s1.yaml", tmp_path / "mine.yaml")
    command = [sys.executable, "-m", "bearingwear", "study", "mine.yaml", "--stiffness", "3"]

    # words of the jobs at these moments, in the order in which the study runs them
    moments = "snakemake", "bearingwear.studies.design.recommend.small_map", "uncertainty"
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGINT, signal.SIGKILL):
        shutil.rmtree(tmp_path / "mine", ignore_errors=True)
        for word in moments:
            nothing = subprocess.DEVNULL
            run = subprocess.Popen(command, cwd=tmp_path, stdout=nothing, stderr=nothing)
            wait(lambda run=run, word=word: run.poll() is not None or jobs_below(run, word), 600.0)
            assert run.poll() is None, (number, word)
            children = psutil.Process(run.pid).children(recursive=True)
            run.send_signal(number)
            run.wait()
            _, alive = psutil.wait_procs(children, timeout=60)
            assert children and not alive, (number, word, alive)


@pytest.mark.faults
def test_results_that_cannot_be_written_are_reported_in_one_line(solved_tiny_study, undisturbed):
    """The folder of two removed cases is not writable; the log of their job has one line on that.

    Once the folder is writable, the study goes on.
    """
    unprivileged = () if os.geteuid() else WITHOUT_PRIVILEGES
    if unprivileged and shutil.which(unprivileged[0]) is None:
        pytest.skip("root may write everywhere, and there is no setpriv to take that right away")
    first_case = solved_tiny_study.case(CASES[0])
    for case in CASES[:2]:  # both of a line, as Snakemake itself removes what is left of one
        solved_tiny_study.case(case).unlink()
    before = finished(solved_tiny_study)
    first_case.parent.chmod(0o555)
    run = solved_tiny_study.run(prefix=unprivileged)
    first_case.parent.chmod(0o755)
    assert run.status == 1 and "Traceback" not in run.text
    name = first_case.relative_to(solved_tiny_study.root)
    log = (solved_tiny_study.root / f"logs/solve/gyro_s1/{LINES[0]}.log").read_text()
    assert log == f"{name}: cannot be written (Permission denied)\n"
    resumes(solved_tiny_study, before, undisturbed)


@pytest.mark.faults
def test_unsolved_cases_are_solved_once_the_solver_is_mended(solved_tiny_study, undisturbed):
    """The solver is edited to take no iterations: no case is solved, and the study says so.

    Its tables and figures name them; a second run repeats the verdict alone. With the solver as
    before, it solves all four lines, to the bytes of the undisturbed study.
    """
    source = "bearingwear/kernels/steady/level_solver.py"
    for limit in ("NEWTON_STEPS", "most"):  # Newton's iterations, and those of the method after it
        solved_tiny_study.edit(
            source, f"for iteration in range({limit}):", f"for iteration in range(0 * {limit}):"
        )
    run = solved_tiny_study.run()
    assert run.status == 1
    assert all(f"{case}.nc: no_steady_state: " in run.text for case in CASES), run.text
    results = solved_tiny_study.results()
    assert set(results) == set(undisturbed.results()) - {"verdict.txt"}
    assert results["gyro_s1/tables/summary.md"].decode().count(": no steady state\n") == len(CASES)
    for name in ("fig09_slip", "fig10_wear", "wear_life"):
        assert b"not solved" in results[f"gyro_s1/figures/{name}.svg"]
    again = solved_tiny_study.run()
    assert again.status == 1 and again.jobs == {"verdict": 1}
    shutil.copy(ROOT / source, solved_tiny_study.root / source)
    mended = solved_tiny_study.run()
    assert mended.status == 0 and mended.jobs["solve"] == 4
    assert solved_tiny_study.results() == undisturbed.results()


@pytest.mark.faults
def test_one_job_at_a_time_gives_the_same_bytes(project, undisturbed):
    """The undisturbed study was solved by two jobs at a time."""
    run = project.run(jobs=1)
    assert run.status == 0, run.text
    assert project.results() == undisturbed.results()
