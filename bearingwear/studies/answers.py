"""Evaluates a function at many points on all cores: `answers_at`, `Workers` for several rounds."""

from __future__ import annotations

import functools
import itertools
import math
import multiprocessing
import pickle
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

from bearingwear.console import LINE_EVERY, ProcessEnded
from bearingwear.studies.sampling import usable_cores

_P = TypeVar("_P")
Answer = Mapping[str, Any]
"""Values by their names: the result of a function at a point."""

Tell = Callable[[str], None]
"""A function that takes a line of progress."""

REFUSED = -1
"""Status of a point that was not solved because it is invalid; `none` in files and tables."""

PROBLEM = "problem"
"""Key of an answer that says in one line why its point was refused."""

FAILURES = ValueError, ArithmeticError
"""Errors that belong to a point: a scene that is not valid, or that no model solves, and numbers
without a result. Others are faults of the program and end a sweep."""

_CHUNKS_PER_WORKER = 8
"""Number of shares of the points per process, which takes a share when it has answered another."""

_MOST_AT_ONCE = 32
"""Most points in such a share."""


def answers_at(
    function: Callable[[_P], Answer],
    points: Sequence[_P],
    workers: int | None = None,
    label: str = "sweep",
    progress: bool | Tell = True,
) -> Iterator[Answer]:
    """Yields the answers of a function at points, in their order.

    The arguments are those of `Workers` and of its method `answers_at`.
    """
    with Workers(workers, label, progress) as pool:
        yield from pool.answers_at(function, points)


class Workers:
    """Processes that evaluate functions at points, in any number of rounds.

    The first point is evaluated in this process, before the workers are forked from it: they then
    have the kernels and modules that it loaded. With one worker, all points are evaluated here.
    Used as a context, it ends the processes after its block. An error in the block terminates them
    at once; if it is due to a killed process, it becomes a `ProcessEnded`.

    workers: number of processes, at least 1 (default: one per core).
    label: name of the computation in lines of progress and of errors.
    progress: whether a round of more than a few seconds reports its progress on standard error
        (with tqdm, if installed); or a function that takes the lines of progress.
    """

    def __init__(
        self, workers: int | None = None, label: str = "sweep", progress: bool | Tell = True
    ) -> None:
        self.workers = usable_cores() if workers is None else workers
        if self.workers < 1:
            raise ValueError(f"{label}: workers: got {workers}, expected 1 or more")
        self._label, self._progress = label, progress
        self._pool: ProcessPoolExecutor | None = None
        self._other_processes = set(multiprocessing.active_children())

    def answers_at(
        self, function: Callable[[_P], Answer], points: Sequence[_P], at_once: int = _MOST_AT_ONCE
    ) -> Iterator[Answer]:
        """Yields the answers of a function at points, in their order.

        The answer of a point that raises one of `FAILURES` has status `REFUSED` and a `PROBLEM`.

        function: of a module, or a `functools.partial` of one; other processes call it.
        at_once: how many points a process takes at most; few where not all answers may be needed.
        """
        answers = self._answers(function, points, at_once)
        return with_progress(answers, len(points), self._label, self._progress)

    def start(self) -> None:
        """Starts the processes now; they then evaluate all points. A single worker has none."""
        if self._pool is None and self.workers > 1:
            # a terminal interrupts them, too; they ignore it, and this process ends them
            self._pool = ProcessPoolExecutor(
                self.workers,
                initializer=signal.signal,
                initargs=(signal.SIGINT, signal.SIG_IGN),
            )

    def _answers(
        self, function: Callable[[_P], Answer], points: Sequence[_P], at_once: int
    ) -> Iterator[Answer]:
        """Yields the answers: the first from this process before it forks, the rest from the forks.

        With one worker, all are from this process; after `start`, all are from the forks.
        """
        if self.workers == 1:
            count_here = len(points)
        else:
            count_here = 1 if self._pool is None else 0
        yield from map(functools.partial(answer_of, function), points[:count_here])
        if len(points) > count_here:
            self.start()
            assert self._pool is not None
            chunk_size = min(points_at_once(len(points), self.workers), at_once)
            answer = functools.partial(_answer_of_pickled, pickle.dumps(function))
            points_left = itertools.islice(points, count_here, None)
            yield from self._pool.map(answer, points_left, chunksize=chunk_size)

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Ends the processes; after an error, without waiting for what they solve.

        kind: of an error in the block, which goes on; None without one.
        ProcessEnded: replaces the error of a process that ended before it answered.
        """
        if self._pool is None:
            return
        if kind is not None:  # do not wait for what is still being solved
            for process in set(multiprocessing.active_children()) - self._other_processes:
                process.terminate()
        self._pool.shutdown(cancel_futures=True)
        if kind is not None and issubclass(kind, BrokenProcessPool):
            problem = f"{self._label}: a process ended unexpectedly, as when memory runs out"
            if multiprocessing.get_start_method() != "fork":
                problem += (
                    "; a script has to call this under `if __name__ == '__main__':`, "
                    "or with workers=1"
                )
            raise ProcessEnded(problem) from None


def points_at_once(count: int, workers: int) -> int:
    """Returns how many of some points a process takes at once, from 1 to `_MOST_AT_ONCE`.

    Each process has about `_CHUNKS_PER_WORKER` turns, so that all end at about the same time.

    count: number of points.
    workers: number of processes; 0 counts as 1.
    """
    share = math.ceil(count / (_CHUNKS_PER_WORKER * max(workers, 1)))
    return min(max(share, 1), _MOST_AT_ONCE)


def answer_of(function: Callable[[_P], Answer], point: _P) -> Answer:
    """Returns the answer of a function at a point.

    If it raises one of `FAILURES`, the answer has the status `REFUSED` and the error as `PROBLEM`.
    """
    try:
        return function(point)
    except FAILURES as error:
        return {"status": REFUSED, PROBLEM: " ".join(str(error).split())}


def _answer_of_pickled(pickled_function: bytes, point: Any) -> Answer:
    """Returns the answer of a pickled function at a point; another process calls it."""
    return answer_of(_unpickled(pickled_function), point)


@functools.lru_cache(maxsize=4)
def _unpickled(pickled_function: bytes) -> Any:
    """Returns a function, unpickled once, so that all its points share the caches of its scenes."""
    return pickle.loads(pickled_function)


def answer_values(answer: Answer) -> dict[str, Any]:
    """Returns the values of an answer, without its problem."""
    return {name: value for name, value in answer.items() if name != PROBLEM}


def with_progress(
    answers: Iterable[Answer], count: int, label: str, progress: bool | Tell
) -> Iterator[Answer]:
    """Yields the answers, and reports their number and the time left by a bar or by lines.

    The bar is that of tqdm, if it is installed and the lines are not taken by a function.

    count: number of answers to come.
    label: name of the computation.
    progress: whether to report on standard error, or a function that takes the lines.
    """
    if not progress:
        yield from answers
        return
    try:
        from tqdm.auto import tqdm
    except ImportError:
        tqdm = None
    if callable(progress) or tqdm is None:
        yield from _with_lines(answers, count, label, progress)
    else:
        yield from tqdm(answers, total=count, desc=label, delay=LINE_EVERY)


def _with_lines(
    answers: Iterable[Answer], count: int, label: str, progress: bool | Tell
) -> Iterator[Answer]:
    """Yields the answers, and reports progress by a line every `LINE_EVERY` seconds.

    The arguments are those of `with_progress`.
    """
    start = last_line_time = time.monotonic()
    for number, answer in enumerate(answers, 1):
        yield answer
        now = time.monotonic()
        if now - last_line_time > LINE_EVERY and number < count:
            seconds_left = (now - start) * (count - number) / number
            line = f"{label}: {number} of {count} points, about {seconds_left:.0f} s left"
            if callable(progress):
                progress(line)
            else:
                print(line, file=sys.stderr)
            last_line_time = now
