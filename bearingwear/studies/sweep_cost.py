"""What a sweep will cost, from a few of its points."""

from __future__ import annotations

import time

from bearingwear.studies.answers import answer_of
from bearingwear.studies.sampling import usable_cores
from bearingwear.studies.sweep import Sweep
from bearingwear.studies.sweep_dataset import points_dataset

_MOST_TIMED, _LONGEST = 5, 20.0
"""Points that are timed, and the time [s] after which no other one is.

One before them loads what they have in common, unless it takes that long by itself.
"""


def cost_lines(sweep: Sweep, workers: int | None = None, parts: int = 1) -> list[str]:
    """How many points a sweep has, and its CPU time, wall time and memory by a few of them."""
    cores = usable_cores() if workers is None else workers
    every = sweep.in_even_order()
    sweep.compile(every)
    seconds, answers = [], []
    begun = time.monotonic()
    for point in every[: _MOST_TIMED + 1]:
        started = time.process_time()
        answers.append(answer_of(sweep.asked, point))
        seconds.append(time.process_time() - started)
        if time.monotonic() - begun > _LONGEST:
            break
    seconds = seconds[1:] or seconds
    mean, count = sum(seconds) / len(seconds), len(every)
    lengths = ", ".join(f"{name} {n}" for name, n in sweep.points.lengths(()).items())
    lines = [
        f"{count} points ({lengths}); {len(seconds)} timed: {_duration(min(seconds))} to "
        f"{_duration(max(seconds))} of CPU time, {_duration(mean)} in the mean",
        f"expected: {_duration(mean * count)} of CPU time, "
        f"{_duration(mean * count / min(cores, count))} on {cores} cores",
    ]
    if parts > 1:
        lines.append(f"each of {parts} parts: {_duration(mean * count / parts)} of CPU time")
    if any("problem" not in one for one in answers):
        size = points_dataset(sweep.asked.kept, answers).nbytes / len(answers) * count
        lines.append(f"about {max(size / 1e6, 0.1):.3g} MB of memory for the dataset")
    return lines


def _duration(seconds: float) -> str:
    if seconds < 1.0:
        return f"{1e3 * seconds:.2g} ms"
    if seconds < 120.0:
        return f"{seconds:.3g} s"
    return f"{seconds / 60.0:.3g} min" if seconds < 7200.0 else f"{seconds / 3600.0:.3g} h"
