"""Lines on the terminal for the jobs of a study, and points that a grid has no more."""

import io
import logging
import re
import time
from types import SimpleNamespace

import pytest

from bearingwear import console
from bearingwear.studies import pool, progress
from bearingwear.studies.progress import JobLines
from bearingwear.studies.protocol import SCENE, Study, step
from bearingwear.studies.repair import OFF_GRID, off_grid


def record(event=None, message="", **values):
    values |= {"event": event and SimpleNamespace(name=event)}
    return logging.makeLogRecord({"msg": message, "levelno": logging.INFO, **values})


def test_a_line_for_each_finished_job():
    text = io.StringIO()
    handler = logging.StreamHandler(text)
    lines = JobLines(handler)
    solve = step("solve", "{speed}.nc", "run.at", ["1", "2"], work=1.0)
    lines.begin({1: solve, 2: solve, 0: None})
    handler.handle(record(message="Select jobs to execute..."))
    for job, label in ((1, "slow"), (2, "fast"), (0, "all")):
        handler.handle(record("JOB_INFO", jobid=job, rule_msg=label, rule_name="solve"))
    lines._started = {job: start - 4.0 for job, start in lines._started.items()}
    lines._begin -= 4.0
    for job in (1, 2, 0):
        handler.handle(record("JOB_FINISHED", job_id=job))
    handler.handle(record("JOB_ERROR", jobid=2, rule_name="solve", log=["logs/fast.log"]))
    begin, first, second, third, failed = text.getvalue().splitlines()
    assert begin == "3 jobs"
    # as many seconds as the other one is expected to take, less those that it has run
    assert re.fullmatch(r"1 of 3: slow, 4 s; about [01] s left", first)
    assert second.startswith("2 of 3: fast, 4 s; about") and third == "3 of 3: all, 4 s"
    assert failed == "failed: fast; see logs/fast.log"


def test_a_job_that_waited_for_a_kernel_is_no_pace_for_the_others():
    text = io.StringIO()
    handler = logging.StreamHandler(text)
    lines = JobLines(handler)
    lines.begin(dict.fromkeys(range(10), step("solve", "{speed}.nc", "run.at", ["1"])))
    handler.handle(record("JOB_INFO", jobid=0, rule_msg="slow", rule_name="solve"))
    lines._started[0] -= 60.0
    lines._begin -= 60.0
    handler.handle(record("JOB_FINISHED", job_id=0))
    _, line = text.getvalue().splitlines()
    assert int(re.search(r"about (\d+) s left", line)[1]) < 30  # not nine minutes


def test_a_silent_study_says_that_a_job_compiles(tmp_path, monkeypatch):
    log, said = tmp_path / "job.log", []
    log.write_bytes(b"compiling part of the solver (only once) ...\n")
    monkeypatch.setattr(progress, "LINE_EVERY", 0.0)
    monkeypatch.setattr(progress, "tell_of_compiling", lambda: said.append(True))
    lines = JobLines(logging.StreamHandler(io.StringIO()))
    started = record("JOB_INFO", jobid=0, rule_msg="a", rule_name="solve", log=[str(log)])
    lines._handler.handle(started)
    lines.begin({0: None})
    end = time.monotonic() + 10.0
    while not said and time.monotonic() < end:
        time.sleep(0.05)
    lines._handler.handle(record("JOB_FINISHED", job_id=0))
    assert said


def test_points_off_the_grid_are_set_aside_and_come_back(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def study(*speeds):
        solve = step("solve", "cases/{speed}.nc", "run.at", speeds, scene=SCENE.format(scene="a"))
        return Study("toy", None, solve, step("gather", "cases/all.nc", "run.all"))

    folder = tmp_path / "results" / "toy" / "cases"
    folder.mkdir(parents=True)
    for name in ("1", "2", "all"):
        (folder / f"{name}.nc").write_text(name)
    assert list(off_grid([study("1", "2")])) == []
    (line,) = off_grid([study("1", "3")])
    assert line == "results/toy/cases: files outside the grid were moved to off_grid/ (1): 2.nc"
    assert {path.name for path in folder.iterdir()} == {"1.nc", "all.nc", OFF_GRID}
    assert list(off_grid([study("1", "2")])) == []
    assert (folder / "2.nc").read_text() == "2"


def test_time_left_of_kinds_that_follow_each_other(monkeypatch):
    """A kind that has not begun costs so many of the known ones; then its own pace counts.

    The very first result does not: it waits for kernels.
    """
    clock = [0.0]
    monkeypatch.setattr(pool.time, "monotonic", lambda: clock[0])
    left = pool.TimeLeft({"quick": (11, 1.0), "long": (4, 5.0)})
    left.expect("quick", 11)
    clock[0] = 7.0
    left.done("quick", 1)
    assert left.seconds == 0.0  # not known
    clock[0] = 9.0
    left.done("quick", 4)
    assert left.seconds == 0.5 * 6 + 0.5 * 5 * 4
    clock[0] = 10.0
    assert left.seconds == 0.5 * 6 + 0.5 * 5 * 4 - 1.0
    left.limit("quick")
    left.expect("long", 6)
    clock[0] = 13.0
    left.done("long", 1)
    pace = 5.0 / (4 * 1.0 + 1 * 5.0)
    assert left.seconds == pytest.approx(5 * (3.0 + 4 * 5.0 * pace) / (1 + 4))


def test_silence_is_broken(monkeypatch, capsys):
    """A line after a while without any, and ever fewer of them; none after the block."""
    monkeypatch.setattr(console, "SILENCE", 0.05)
    with console.ProgressLines("a.yaml") as lines:
        lines.left = SimpleNamespace(seconds=5.0)
        lines("first stage")
        time.sleep(0.5)
        lines("next stage")
    time.sleep(0.1)
    first, *silent, last = capsys.readouterr().err.splitlines()
    assert (
        first == "a.yaml: first stage, about 5 s left"
        and last == "a.yaml: next stage, about 5 s left"
    )
    assert 2 <= len(silent) <= 4
    assert set(silent) <= {
        f"a.yaml: running for {k} s, about 5 s left: first stage" for k in (0, 1)
    }


def test_a_terminal_renews_one_line(monkeypatch):
    terminal = io.StringIO()
    terminal.isatty = lambda: True
    monkeypatch.setattr(console.sys, "stderr", terminal)
    monkeypatch.setattr(console, "SILENCE", 0.05)
    with console.ProgressLines("a.yaml") as lines:
        lines("first stage")
        time.sleep(0.3)
    stage, *renewed, last = terminal.getvalue().split("\r\x1b[K")
    assert stage == "a.yaml: first stage\n" and last == ""
    assert renewed == ["a.yaml: running for 0 s: first stage\r"]
