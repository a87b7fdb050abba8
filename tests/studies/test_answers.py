"""Functions asked at many points by several processes."""

import os
import signal
import time

import numpy as np
import pytest
from support import numbers_in, only_line, scene_file

from bearingwear.cli import main
from bearingwear.scene.checking.errors import SceneError
from bearingwear.studies import answers as module
from bearingwear.studies.answers import PROBLEM, REFUSED, Workers, answers_at


def square(x):
    return {"square": x * x, "process": os.getpid()}


def ratio_or_failure_at_two(x):
    if x == 2:
        raise SceneError("operation.preload_N", "got -1, expected more")
    return {"status": 0, "ratio": 1 / x}


def with_misspelt_attribute(x):
    return {"status": x.stat}


def killed_at_one(x):
    if x == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return {}


def sleep(seconds):
    time.sleep(seconds)
    return {"seconds": seconds}


@pytest.mark.parametrize("workers", [1, 2])
def test_answers_stand_in_the_order_of_their_points(workers):
    with Workers(workers, progress=False) as pool:
        for points in ([], [3], list(range(50)), np.arange(5.0)):
            squares = [answer["square"] for answer in pool.answers_at(square, points)]
            assert squares == [x * x for x in points]


def test_rounds_share_their_processes():
    with Workers(2, progress=False) as pool:
        rounds = [list(pool.answers_at(square, range(20))) for _ in range(4)]
    processes = [{answer["process"] for answer in answers} for answers in rounds]
    assert rounds[0][0]["process"] == os.getpid()  # the first answer says whether more are worth it
    assert len(set().union(*processes)) <= 1 + 2
    assert os.getpid() not in processes[1]


@pytest.mark.parametrize("workers", [1, 2])
def test_a_point_that_fails_leaves_the_others(workers):
    answers = list(answers_at(ratio_or_failure_at_two, [4, 2, 0, 1], workers, progress=False))
    problem = "scene: operation.preload_N: got -1, expected more"
    assert answers[0] == {"status": 0, "ratio": 0.25} and answers[3] == {"status": 0, "ratio": 1.0}
    assert answers[1] == {"status": REFUSED, PROBLEM: problem}
    assert answers[2] == {"status": REFUSED, PROBLEM: "division by zero"}


@pytest.mark.parametrize("workers", [1, 2])
def test_a_fault_of_the_function_is_raised(workers):
    with pytest.raises(AttributeError, match="stat"):
        list(answers_at(with_misspelt_attribute, [1, 2, 3], workers, progress=False))


def test_a_process_that_is_killed_is_named():
    with pytest.raises(RuntimeError, match="sweep: a process ended unexpectedly"):
        list(answers_at(killed_at_one, [0, 1, 2], 2, progress=False))


def test_a_command_says_in_one_line_that_a_process_ended(monkeypatch, capsys):
    def ended(args):
        list(answers_at(killed_at_one, [0, 1, 2], 2, "uncertainty", progress=False))

    monkeypatch.setattr("bearingwear.results.kinds.imported_function", lambda name: ended)
    assert main(["uncertainty", str(scene_file("gyro_s1"))]) == 3
    assert only_line(capsys).startswith("uncertainty: a process ended unexpectedly")


def test_closing_early_does_not_wait_for_running_processes():
    answers = answers_at(sleep, [0.0, 0.0, 60.0, 60.0], 2, progress=False)
    assert [next(answers), next(answers)] == [{"seconds": 0.0}] * 2
    started = time.monotonic()
    answers.close()
    assert time.monotonic() - started < 20.0  # of the 60 s that each of them sleeps


def test_workers_are_at_least_one():
    with pytest.raises(ValueError, match="life: workers: got 0, expected 1 or more"):
        Workers(0, "life")


def test_progress_has_a_line_every_few_seconds(monkeypatch):
    clock, lines = [0.0], []
    monkeypatch.setattr(module.time, "monotonic", lambda: clock[0])

    def every_2_seconds():
        for point in range(5):
            clock[0] += 2.0
            yield {"point": point}

    answers = list(module.with_progress(every_2_seconds(), 5, "sweep", lines.append))
    assert [answer["point"] for answer in answers] == [0, 1, 2, 3, 4]
    assert all(line.startswith("sweep: ") for line in lines)
    assert [numbers_in(line) for line in lines] == [[2, 5, 6], [4, 5, 2]]  # points, all, s left
