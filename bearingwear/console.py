"""Text for a terminal: printable lines, and lines on the progress of a command."""

from __future__ import annotations

import contextlib
import shutil
import sys
import threading
import time
import unicodedata
from typing import TextIO

SUCCESS, BAD_INPUT, NOT_SOLVED, INFEASIBLE = 0, 2, 3, 4
"""Exit statuses of commands (`cli`)."""

LINE_EVERY = 2.0
"""Seconds between two lines of progress, and before the first."""

SILENCE = 2.6
"""Seconds without a line after which a file or pipe gets one that states what runs.

With the time between two checks of the clock, it appears within 3 s.
"""

TERMINAL_SILENCE = 1.0
"""Seconds without a line after which a terminal shows what runs."""

POLL_SECONDS = 0.2
"""Seconds between two checks of the clock."""

_CLEAR_LINE = "\r\x1b[K"  # on a terminal: to the start of the line, and delete it


class UsageError(ValueError):
    """A command that cannot be carried out as it was typed; its text is one line."""


class ProcessEnded(RuntimeError):
    """A process that ended before it answered; its text is one line."""


def printable(text: str) -> str:
    """Returns a text with question marks for control characters; no-break spaces stay."""
    return "".join(c if c.isprintable() or unicodedata.category(c) == "Zs" else "?" for c in text)


def one_line(text: str) -> str:
    """Returns a text as one printable line."""
    return printable(text) + "\n"


class ProgressLines:
    """Lines of progress on standard error and, while there are none, what runs for how long.

    A terminal shows the latter in one line, which is renewed each second. Elsewhere, a line is
    printed after 3, 5, 10, ... s. Used as a context, it writes nothing after its block.

    source: file whose name begins each line; "" for none.
    """

    def __init__(self, source: str = "") -> None:
        self._source = f"{source}: " if source else ""
        self._last = time.monotonic()  # of the last line
        self._running = ""  # what runs, in words
        self._since = self._last  # the time since which that runs
        self._lock = threading.RLock()
        self._ended = threading.Event()
        self._shown = ""  # in the line that is renewed
        self._thread = threading.Thread(target=self._break_silence, daemon=True)

    def __enter__(self) -> ProgressLines:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        self._thread.join()
        self._write("")

    def __call__(self, text: str) -> None:
        """Prints a line of progress, and sets what runs.

        A line that cannot be written, as on a closed terminal, is left out.

        text: the line. What runs is its part before an estimate, which starts with `, about `.
        """
        self.running = text.partition(", about ")[0]
        # a closed terminal must not end the run
        with contextlib.suppress(OSError, ValueError):
            self.print_line(one_line(f"{self._source}{text}"))

    @property
    def running(self) -> str:
        """Returns what runs, in words."""
        return self._running

    @running.setter
    def running(self, text: str) -> None:
        """Sets what runs; a change restarts the count of its time."""
        if text != self._running:
            self._running, self._since = text, time.monotonic()

    def print_line(self, text: str, stream: TextIO | None = None) -> None:
        """Prints a text that ends with a line break, in place of the line that is renewed.

        stream: by default standard error.
        """
        with self._lock:
            self._write("")
            stream = stream or sys.stderr
            stream.write(text)
            stream.flush()
            self._last = time.monotonic()

    def _write(self, text: str) -> None:
        """Shows a text as the line that is renewed; "" removes the line."""
        with self._lock, contextlib.suppress(OSError, ValueError):
            if text != self._shown:
                sys.stderr.write(f"{_CLEAR_LINE}{text}\r" if text else _CLEAR_LINE)
                sys.stderr.flush()
            self._shown = text

    def _break_silence(self) -> None:
        """Shows what runs for how long, while there are no other lines; runs in a thread."""
        is_terminal = sys.stderr.isatty()
        next_line = SILENCE  # seconds of silence
        while not self._ended.wait(POLL_SECONDS):
            silence = time.monotonic() - self._last
            if is_terminal and silence > TERMINAL_SILENCE:
                self._write(printable(self._status())[: shutil.get_terminal_size().columns - 1])
            elif silence < SILENCE:
                next_line = SILENCE
            elif silence > next_line and not is_terminal:
                next_line *= 2.0
                with contextlib.suppress(OSError, ValueError):
                    sys.stderr.write(one_line(self._status()))
                    sys.stderr.flush()

    def _status(self) -> str:
        """Returns what runs, and for how long."""
        seconds = time.monotonic() - self._since
        running = f": {self.running}" if self.running else ""
        return f"{self._source}running for {seconds:.0f} s{running}"
