"""Runs a function at many points on all cores: `answers_at`, and `Workers` for several rounds."""

from __future__ import annotations

import itertools
import math
import multiprocessing
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from typing import Any, TypeVar

from bearingwear.console import LINE_EVERY
from bearingwear.studies.pool import Tell
from bearingwear.studies.sampling import usable_cores

_P = TypeVar("_P")
Answer = Mapping[str, Any]
"""Values by their names; what is asked of a point."""

REFUSED = -1
"""Status of a point that no model was asked for; files and tables call it `none`."""

PROBLEM = "problem"
"""Of a point that is refused: why, as one line."""

FAILURES = ValueError, ArithmeticError
"""Errors that belong to a point: a scene that is not valid, or that no model solves, and numbers
without a result. Others are faults of the program and end a sweep."""

_IGNORED = signal.SIGINT, signal.SIG_IGN

CHUNKS_PER_WORKER = 8
"""How finely points are shared out; a process takes more when it has answered its share."""


def answers_at(
    what: Callable[[_P], Answer],
    points: Sequence[_P],
    workers: int | None = None,
    label: str = "sweep",
    progress: bool | Tell = True,
) -> Iterator[Answer]:
    """The answers of a function at points, in their order; see `Workers`."""
    with Workers(workers, label, progress) as pool:
        yield from pool.answers_at(what, points)


class Workers:
    """Processes that answer questions at points, in any number of rounds.

    The first point of all is answered in this process, before the others are forked from it: they
    then have the kernels and modules that it loads. So do all points where there is one worker.

    workers: number of processes; one per core if none is given.
    label: what runs, for lines of progress and of errors.
    progress: whether a round of more than a few seconds says on standard error how far it is (with
        tqdm, if that is installed); or what takes these lines.
    """

    def __init__(
        self, workers: int | None = None, label: str = "sweep", progress: bool | Tell = True
    ) -> None:
        self.workers = usable_cores() if workers is None else workers
        if self.workers < 1:
            raise ValueError(f"{label}: workers: got {workers}, expected 1 or more")
        self._label, self._progress = label, progress
        self._pool: ProcessPoolExecutor | None = None
        self._before = set(multiprocessing.active_children())

    def answers_at(self, what: Callable[[_P], Answer], points: Sequence[_P]) -> Iterator[Answer]:
        """The answers of a function at points, in their order.

        A point that raises one of `FAILURES` has the status `REFUSED` and a `PROBLEM`.

        what: a function of a module, or a `functools.partial` of one; other processes call it.
        """
        answers = self._answers(partial(_answer, what), points)
        return with_progress(answers, len(points), self._label, self._progress)

    def start(self) -> None:
        """Start the processes now: all points are then answered in these."""
        if self._pool is None and self.workers > 1:
            # a terminal interrupts them, too; this process ends them
            self._pool = ProcessPoolExecutor(self.workers, None, signal.signal, _IGNORED)

    def _answers(self, answer: Callable[[_P], Answer], points: Sequence[_P]) -> Iterator:
        if self.workers == 1:
            yield from map(answer, points)
            return
        here = 1 if self._pool is None else 0
        yield from map(answer, points[:here])
        if len(points) > here:
            self.start()
            assert self._pool is not None
            size = math.ceil(len(points) / (CHUNKS_PER_WORKER * self.workers))
            yield from self._pool.map(answer, itertools.islice(points, here, None), chunksize=size)

    def __enter__(self) -> Workers:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if self._pool is None:
            return
        if kind is not None:  # do not wait for what is still being solved
            for process in set(multiprocessing.active_children()) - self._before:
                process.terminate()
        self._pool.shutdown(cancel_futures=True)
        if kind is not None and issubclass(kind, BrokenProcessPool):
            raise RuntimeError(
                f"{self._label}: a process ended unexpectedly. In a script, call this function "
                "under `if __name__ == '__main__':` (processes are started by "
                f"{multiprocessing.get_start_method()}), or set workers=1"
            ) from None


def _answer(what: Callable[[_P], Answer], point: _P) -> Answer:
    try:
        return what(point)
    except FAILURES as error:
        return {"status": REFUSED, PROBLEM: " ".join(str(error).split())}


def with_progress(
    answers: Iterable[Answer], count: int, label: str, progress: bool | Tell
) -> Iterator[Answer]:
    """The answers, while a bar or lines say how many of them there are, and the time left."""
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
    answers: Iterable[Answer], count: int, label: str, tell: bool | Tell
) -> Iterator[Answer]:
    begun = last = time.monotonic()
    for done, answer in enumerate(answers, 1):
        yield answer
        now = time.monotonic()
        if now - last > LINE_EVERY and done < count:
            left = (now - begun) * (count - done) / done
            line = f"{label}: {done} of {count} points, about {left:.0f} s left"
            if callable(tell):
                tell(line)
            else:
                print(line, file=sys.stderr)
            last = now
