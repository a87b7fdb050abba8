"""Estimate of the time and memory of a sweep from a few of its points."""

from __future__ import annotations

import time
from collections.abc import Sequence

from bearingwear.studies.answers import PROBLEM, Answer, answer_of
from bearingwear.studies.points import ScenePoint
from bearingwear.studies.sampling import usable_cores
from bearingwear.studies.sweep import Sweep
from bearingwear.studies.sweep_dataset import points_dataset

_MOST_TIMED = 5
"""Largest number of timed points, without the first point of all, which loads the kernels."""

_LONGEST = 20.0
"""Time [s] after which no further point is timed."""


def cost_lines(sweep: Sweep, workers: int | None = None, parts: int = 1) -> list[str]:
    """Returns lines on the number of points of a sweep, its CPU time, wall time and memory.

    It compiles the kernels of the sweep, and solves a few points in this process, which takes up to
    some tens of seconds. There is no line on memory if all of these points were refused.

    workers: processes that are to solve it, by default one per core.
    parts: number of jobs that are to share the points.
    """
    cores = usable_cores() if workers is None else workers
    points = sweep.in_even_order()
    sweep.compile(points)
    answers, seconds = _timed_answers(sweep, points)
    count = len(points)
    mean = sum(seconds) / len(seconds)
    lengths = ", ".join(f"{name} {n}" for name, n in sweep.points.lengths(()).items())
    lines = [
        f"{count} points ({lengths}); {len(seconds)} timed: {_duration(min(seconds))} to "
        f"{_duration(max(seconds))} of CPU time, {_duration(mean)} in the mean",
        f"expected: {_duration(mean * count)} of CPU time, "
        f"{_duration(mean * count / min(cores, count))} on {cores} cores",
    ]
    if parts > 1:
        lines.append(f"each of {parts} parts: {_duration(mean * count / parts)} of CPU time")
    if any(PROBLEM not in answer for answer in answers):
        # [bytes]; with the answer that was not timed
        size = points_dataset(sweep.question.kept, answers).nbytes / len(answers) * count
        lines.append(f"about {max(size / 1e6, 0.1):.3g} MB of memory for the dataset")
    return lines


def _timed_answers(sweep: Sweep, points: Sequence[ScenePoint]) -> tuple[list[Answer], list[float]]:
    """Returns the answers of a sweep at its first points, and the CPU time [s] of the timed ones.

    The first point, which loads the kernels, is timed only if it stays the only one; otherwise
    there is one time less than answers. Further points are solved for up to `_LONGEST`.
    """
    answers, seconds = [], []
    start = time.monotonic()
    for point in points[: _MOST_TIMED + 1]:
        point_start = time.process_time()
        answers.append(answer_of(sweep.question, point))
        seconds.append(time.process_time() - point_start)
        if time.monotonic() - start > _LONGEST:
            break
    return answers, seconds if len(seconds) == 1 else seconds[1:]


def _duration(seconds: float) -> str:
    """Returns a time with its unit: milliseconds, seconds, minutes or hours."""
    if seconds < 1.0:
        return f"{1e3 * seconds:.2g} ms"
    if seconds < 120.0:
        return f"{seconds:.3g} s"
    return f"{seconds / 60.0:.3g} min" if seconds < 7200.0 else f"{seconds / 3600.0:.3g} h"
