"""Runs a function at many points on all cores: `answers_at`, and `Workers` for several rounds."""

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
"""Values by their names; what is asked of a point."""

Tell = Callable[[str], None]
"""What takes a line of progress."""

REFUSED = -1
"""Status of a point that no model was asked for; files and tables call it `none`."""

PROBLEM = "problem"
"""Of a point that is refused: why, as one line."""

FAILURES = ValueError, ArithmeticError
"""Errors that belong to a point: a scene that is not valid, or that no model solves, and numbers
without a result. Others are faults of the program and end a sweep."""

_IGNORED = signal.SIGINT, signal.SIG_IGN

_CHUNKS_PER_WORKER, _MOST_AT_ONCE = 8, 32
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

    def answers_at(
        self, what: Callable[[_P], Answer], points: Sequence[_P], at_once: int = _MOST_AT_ONCE
    ) -> Iterator[Answer]:
        """The answers of a function at points, in their order.

        A point that raises one of `FAILURES` has the status `REFUSED` and a `PROBLEM`.

        what: a function of a module, or a `functools.partial` of one; other processes call it.
        at_once: how many points a process takes at most; few where not all answers may be needed.
        """
        answers = self._answers(what, points, at_once)
        return with_progress(answers, len(points), self._label, self._progress)

    def start(self) -> None:
        """Start the processes now: all points are then answered in these."""
        if self._pool is None and self.workers > 1:
            # a terminal interrupts them, too; this process ends them
            self._pool = ProcessPoolExecutor(self.workers, None, signal.signal, _IGNORED)

    def _answers(
        self, what: Callable[[_P], Answer], points: Sequence[_P], at_once: int
    ) -> Iterator[Answer]:
        here = len(points) if self.workers == 1 else 1 if self._pool is None else 0
        yield from map(functools.partial(answer_of, what), points[:here])
        if len(points) > here:
            self.start()
            assert self._pool is not None
            size = min(points_at_once(len(points), self.workers), at_once)
            answer = functools.partial(_answer_of_sent, pickle.dumps(what))
            others = itertools.islice(points, here, None)
            yield from self._pool.map(answer, others, chunksize=size)

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
            problem = f"{self._label}: a process ended unexpectedly, as when memory runs out"
            if multiprocessing.get_start_method() != "fork":
                problem += (
                    "; a script has to call this under `if __name__ == '__main__':`, "
                    "or with workers=1"
                )
            raise ProcessEnded(problem) from None


def points_at_once(count: int, workers: int) -> int:
    """How many of some points a process takes at once."""
    share = math.ceil(count / (_CHUNKS_PER_WORKER * max(workers, 1)))
    return min(max(share, 1), _MOST_AT_ONCE)


def answer_of(what: Callable[[_P], Answer], point: _P) -> Answer:
    """The answer of a function at a point; see `Workers.answers_at`."""
    try:
        return what(point)
    except FAILURES as error:
        return {"status": REFUSED, PROBLEM: " ".join(str(error).split())}


def _answer_of_sent(sent: bytes, point: Any) -> Answer:
    return answer_of(_received(sent), point)


@functools.lru_cache(maxsize=4)
def _received(sent: bytes) -> Any:
    """A function as another process sent it; all its points share what its scenes remember."""
    return pickle.loads(sent)


def answer_values(answer: Answer) -> dict[str, Any]:
    """The values of an answer, without its problem."""
    return {name: value for name, value in answer.items() if name != PROBLEM}


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
