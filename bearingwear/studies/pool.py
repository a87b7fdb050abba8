"""Work shared by several processes, and lines that say how far it is."""

from __future__ import annotations

import contextlib
import multiprocessing
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import Any

Tell = Callable[[str], None]
"""What takes a line of progress."""

LINE_EVERY = 3.0
"""Seconds between two lines of progress, and before the first."""


def one_by_one(result: Any) -> int:
    """Share of the work in a result: each counts as one."""
    return 1


def to_stderr(text: str) -> None:
    print(text, file=sys.stderr)


@contextlib.contextmanager
def processes(workers: int, caller: str) -> Iterator[Callable[..., Iterator[Any]]]:
    """A `map` whose calls share processes; with one worker in this process.

    Parameters
    ----------
    caller : str
        What has `workers`, for the message where processes cannot be started.
    """
    if workers <= 1:
        yield map
        return
    # a terminal signals them, too; this process ends them
    pool = ProcessPoolExecutor(workers, None, signal.signal, (signal.SIGINT, signal.SIG_IGN))
    try:
        yield pool.map
    except BrokenProcessPool:
        raise RuntimeError(
            f"{caller}: a process has ended. Call this below `if __name__ == '__main__':` in a "
            f"script, since processes are started by {multiprocessing.get_start_method()}; "
            "or workers=1"
        ) from None
    except BaseException:  # Ctrl-C: do not wait for what is still being solved
        for process in list(pool._processes.values()):
            process.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def in_processes(
    function: Callable[[Any], Any], jobs: Sequence[Any], workers: int, caller: str
) -> Iterator[Any]:
    """Results of a function for each of some jobs, in their order; as `processes`."""
    with processes(workers, caller) as each:
        yield from each(function, jobs)


def told_in_lines(
    results: Iterator[Any],
    count: int,
    what: str,
    size: Callable[[Any], int] = one_by_one,
    tell: Tell = to_stderr,
) -> Iterator[Any]:
    """Results, with a line every few seconds: number of `count` done, time left.

    Parameters
    ----------
    what : str
        `CALLER: {} of {} THINGS`, filled with what is done and all there is.
    """
    started = last = time.monotonic()
    done = 0
    for result in results:
        yield result
        done += size(result)
        now = time.monotonic()
        if now - last > LINE_EVERY and done < count:
            left = (now - started) * (count - done) / done
            tell(f"{what.format(done, count)}, about {left:.0f} s left")
            last = now
