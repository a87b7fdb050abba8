"""Work shared by several processes, and lines that say how far it is."""

from __future__ import annotations

import contextlib
import multiprocessing
import signal
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from itertools import chain
from typing import Any

from bearingwear.console import LINE_EVERY
from bearingwear.studies.answers import Tell


def to_stderr(text: str) -> None:
    print(text, file=sys.stderr)


@contextlib.contextmanager
def processes(
    workers: int, caller: str, some_here: bool = False
) -> Iterator[Callable[..., Iterator[Any]]]:
    """A `map` whose calls share processes; with one worker in this process.

    caller: what has `workers`, for the message where processes cannot be started.
    some_here: whether this process does some jobs: the first one, before others are forked, which
        then have the kernels and modules that it loads; and those that find all others busy.
    """
    if workers < 1:
        raise ValueError(f"{caller}: workers: got {workers}, expected 1 or more")
    if workers == 1:
        yield map
        return
    # a terminal signals them, too; this process ends them
    pool = ProcessPoolExecutor(workers, None, signal.signal, (signal.SIGINT, signal.SIG_IGN))
    try:
        yield partial(_mapped, pool, workers) if some_here else pool.map
    except BrokenProcessPool:
        raise RuntimeError(
            f"{caller}: a process ended unexpectedly. In a script, call this function under "
            "`if __name__ == '__main__':` (processes are started by "
            f"{multiprocessing.get_start_method()}), or set workers=1"
        ) from None
    except BaseException:  # Ctrl-C: do not wait for what is still being solved
        for process in list(pool._processes.values()):
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _mapped(
    pool: ProcessPoolExecutor, workers: int, function: Callable[..., Any], *jobs: Any
) -> Iterator[Any]:
    calls = list(zip(*jobs, strict=True))
    is_busy = len(pool._pending_work_items) >= workers
    count = len(calls) if is_busy else 0 if pool._processes else 1
    here = [function(*call) for call in calls[:count]]
    calls = calls[count:]
    return chain(here, pool.map(function, *zip(*calls, strict=True)) if calls else ())


_ENOUGH = 3
"""Results from which on a time left is stated: the first ones include the start of processes."""


_FEW = 4.0
"""Results of a kind after which their pace counts as much as the one assumed."""


class TimeLeft:
    """Of work of several kinds, each at its own pace as far as it is known.

    The first of all tells nothing of the pace: it waits for kernels and processes.

    ahead: of each kind how many are expected, and the cost of one in any unit, assumed.
    """

    def __init__(self, ahead: Mapping[str, tuple[float, float]]) -> None:
        self._ahead = dict(ahead)
        self._done: dict[str, float] = {}
        self._timed: dict[str, tuple[float, float]] = {}  # how many, seconds
        self._last = time.monotonic()

    def expect(self, kind: str, more: float) -> None:
        """At least so many more of a kind come, from now on."""
        count, cost = self._ahead.get(kind, (0.0, 1.0))
        self._ahead[kind] = max(count, self._done.get(kind, 0.0) + more), cost
        self._last = time.monotonic()

    def done(self, kind: str, count: float) -> None:
        """So many of a kind were done since the last time."""
        now, (before, seconds) = time.monotonic(), self._timed.get(kind, (0.0, 0.0))
        self._ahead.setdefault(kind, (0.0, 1.0))
        if self._done:
            self._timed[kind] = before + count, seconds + now - self._last
        self._done[kind] = self._done.get(kind, 0.0) + count
        self._last = now

    def limit(self, kind: str, count: float = 0.0) -> None:
        """No more than so many of a kind come in all; without a number, none from now on."""
        cost = self._ahead.get(kind, (0.0, 1.0))[1]
        self._ahead[kind] = max(count, self._done.get(kind, 0.0)), cost

    @property
    def seconds(self) -> float:
        """How long the rest takes [s]."""
        spent = sum(seconds for _, seconds in self._timed.values())
        cost = sum(count * self._ahead[kind][1] for kind, (count, _) in self._timed.items())
        pace, left = spent / max(cost, 1e-9), 0.0
        for kind, (count, assumed) in self._ahead.items():
            timed, seconds = self._timed.get(kind, (0.0, 0.0))
            each = (seconds + _FEW * assumed * pace) / (timed + _FEW)
            left += max(count - self._done.get(kind, 0.0), 0.0) * each
        return max(left - (time.monotonic() - self._last), 0.0)


def told_in_lines(
    results: Iterator[Any],
    count: int,
    what: str,
    size: Callable[[Any], int] = lambda _: 1,
    tell: Tell = to_stderr,
    kind: str = "",
    left: TimeLeft | None = None,
    timed: bool = True,
) -> Iterator[Any]:
    """Results, with a line every few seconds: number of `count` done, time left if `timed`.

    what: `CALLER: {} of {} THINGS`, filled with what is done and all there is.
    kind, left: of which kind they are, where others come after them.
    """
    left = left or TimeLeft({kind: (count, 1.0)})
    left.expect(kind, count)
    last, done = time.monotonic(), 0
    for number, result in enumerate(results, 1):
        yield result
        done += size(result)
        left.done(kind, size(result))
        now = time.monotonic()
        if now - last > LINE_EVERY and left.seconds:
            known = timed and number >= _ENOUGH
            seconds = f", about {left.seconds:.0f} s left" if known else ""
            tell(f"{what.format(done, count)}{seconds}")
            last = now
