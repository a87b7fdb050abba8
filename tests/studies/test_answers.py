"""Functions that several processes evaluate at many points."""

import os
import signal
import time

import numpy as np
import pytest
from support import numbers_in, only_line, scene_file

from bearingwear.cli import main
from bearingwear.scene.checking.errors import SceneError
from bearingwear.studies import answers as answers_module
from bearingwear.studies.answers import PROBLEM, REFUSED, Workers, answers_at


def square(x):
    """Returns the square, and the process that computed it."""
    return {"square": x * x, "process": os.getpid()}


def ratio_or_failure_at_two(x):
    """Returns 1/x; raises a SceneError at 2, and a ZeroDivisionError at 0."""
    if x == 2:
        raise SceneError("operation.preload_N", "got -1, expected more")
    return {"status": 0, "ratio": 1 / x}


def with_misspelt_attribute(x):
    """Raises an AttributeError, as a fault of a program does."""
    return {"status": x.stat}


def killed_at_one(x):
    """Ends its own process at 1, as the system does when memory is short."""
    if x == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return {}


def sleep(seconds):
    """Returns its argument [s], after that time."""
    time.sleep(seconds)
    return {"seconds": seconds}


@pytest.mark.parametrize("workers", [1, 2])
def test_answers_stand_in_the_order_of_their_points(workers):
    """Points are none, one or many, in a list or an array."""
    with Workers(workers, progress=False) as pool:
        for points in ([], [3], list(range(50)), np.arange(5.0)):
            squares = [answer["square"] for answer in pool.answers_at(square, points)]
            assert squares == [x * x for x in points]


def test_rounds_share_their_processes():
    """Four rounds by two workers use at most two processes beside the test's own.

    Its own evaluates only the first point of the first round; the workers are then forked from it.
    """
    with Workers(2, progress=False) as pool:
        rounds = [list(pool.answers_at(square, range(20))) for _ in range(4)]
    processes = [{answer["process"] for answer in answers} for answers in rounds]
    assert rounds[0][0]["process"] == os.getpid()
    assert len(set().union(*processes)) <= 1 + 2
    assert os.getpid() not in processes[1]


@pytest.mark.parametrize("workers", [1, 2])
def test_a_point_that_fails_leaves_the_others(workers):
    """Its answer is the status `REFUSED` with the problem in words."""
    answers = list(answers_at(ratio_or_failure_at_two, [4, 2, 0, 1], workers, progress=False))
    problem = "scene: operation.preload_N: got -1, expected more"
    assert answers[0] == {"status": 0, "ratio": 0.25} and answers[3] == {"status": 0, "ratio": 1.0}
    assert answers[1] == {"status": REFUSED, PROBLEM: problem}
    assert answers[2] == {"status": REFUSED, PROBLEM: "division by zero"}


@pytest.mark.parametrize("workers", [1, 2])
def test_a_fault_of_the_function_is_raised(workers):
    """An AttributeError is no answer for a point, as every point would have it."""
    with pytest.raises(AttributeError, match="stat"):
        list(answers_at(with_misspelt_attribute, [1, 2, 3], workers, progress=False))


def test_a_process_that_is_killed_is_named():
    """The error names the command, by default `sweep`."""
    with pytest.raises(RuntimeError, match="sweep: a process ended unexpectedly"):
        list(answers_at(killed_at_one, [0, 1, 2], 2, progress=False))


def test_a_command_says_in_one_line_that_a_process_ended(monkeypatch, capsys):
    """The status is 3. The function of the command is replaced by one whose worker is killed."""

    def command_with_killed_worker(args):
        list(answers_at(killed_at_one, [0, 1, 2], 2, "uncertainty", progress=False))

    monkeypatch.setattr(
        "bearingwear.results.kinds.imported_function", lambda name: command_with_killed_worker
    )
    assert main(["uncertainty", str(scene_file("gyro_s1"))]) == 3
    assert only_line(capsys).startswith("uncertainty: a process ended unexpectedly")


def test_closing_early_does_not_wait_for_running_processes():
    """Two of four answers are read; the other two would take 60 s."""
    answers = answers_at(sleep, [0.0, 0.0, 60.0, 60.0], 2, progress=False)
    assert [next(answers), next(answers)] == [{"seconds": 0.0}] * 2
    start = time.monotonic()
    answers.close()
    assert time.monotonic() - start < 20.0  # s


def test_a_number_of_workers_below_one_is_refused():
    with pytest.raises(ValueError, match="life: workers: got 0, expected 1 or more"):
        Workers(0, "life")


def test_progress_has_a_line_every_few_seconds(monkeypatch):
    """Five points take 2 s each: lines appear after 4 s and 8 s, with the seconds that are left.

    After 2 s no line is due yet, and after 10 s nothing is left to report.
    """
    clock, lines = [0.0], []
    monkeypatch.setattr(answers_module.time, "monotonic", lambda: clock[0])

    def every_2_seconds():
        for point in range(5):
            clock[0] += 2.0
            yield {"point": point}

    answers = list(answers_module.with_progress(every_2_seconds(), 5, "sweep", lines.append))
    assert [answer["point"] for answer in answers] == [0, 1, 2, 3, 4]
    assert all(line.startswith("sweep: ") for line in lines)
    assert [numbers_in(line) for line in lines] == [[2, 5, 6], [4, 5, 2]]  # points, all, s left
