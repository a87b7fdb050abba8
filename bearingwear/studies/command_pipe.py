"""Ends Snakemake and its jobs when the command that started it has ended, however it did.

The command keeps the one end of a pipe open, and Snakemake reads the other one. Its end is that of
the command: by a signal that no program can catch, too.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import threading
import time

_PIPE = "BEARINGWEAR_COMMAND_PIPE"
"""Variable of the environment: the number of the file that Snakemake reads."""

_GRACE = 6.0  # seconds in which Snakemake tidies up: it removes outputs of jobs, and its lock

_EVERY = 0.5  # seconds after which jobs are looked for that began meanwhile


class CommandPipe:
    """The pipe of a command that is about to start Snakemake.

    file: the number of the file that Snakemake must inherit.
    environment: what tells it of the file.
    """

    def __init__(self) -> None:
        self.file, self._held = os.pipe()
        self.environment = {_PIPE: str(self.file)}

    def started(self) -> None:
        """Leave the reading end to Snakemake."""
        os.close(self.file)

    def tell_of_interrupt(self) -> None:
        """Tell that Snakemake has been interrupted already: twice, and it does not tidy up."""
        with contextlib.suppress(OSError):  # it has ended
            os.write(self._held, b"i")

    def close(self) -> None:
        """Close the end that is held; Snakemake ends if it has not yet."""
        os.close(self._held)


def end_with_command() -> None:
    """Called in Snakemake's process: ends it with the command that started it, if one did."""
    if file := os.environ.pop(_PIPE, None):
        threading.Thread(target=_end_after, args=[int(file)], daemon=True).start()


def _end_after(file: int) -> None:
    told = False
    with contextlib.suppress(OSError):
        while os.read(file, 1):
            told = True
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for output in (1, 2):  # nobody reads it any more
        os.dup2(nowhere, output)
    last = time.monotonic() + _GRACE
    if not told:
        os.kill(os.getpid(), signal.SIGINT)
    while time.monotonic() < last:
        _signal_jobs(signal.SIGINT)
        time.sleep(_EVERY)
    shutil.rmtree(os.path.join(".snakemake", "locks"), ignore_errors=True)
    _signal_jobs(signal.SIGKILL)
    os._exit(128 + signal.SIGINT)


def _signal_jobs(number: int) -> None:
    """Signal all processes below this one."""
    import psutil

    with contextlib.suppress(psutil.NoSuchProcess):
        for job in psutil.Process().children(recursive=True):
            with contextlib.suppress(psutil.NoSuchProcess):
                job.send_signal(number)
