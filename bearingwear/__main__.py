"""The program: `bearingwear`, `python -m bearingwear`.

Ctrl-C ends it at once with 130, SIGTERM with 143. Neither raises an exception, since imports of
modules, compiled code and callbacks catch exceptions or turn them into others.
"""

import atexit
import os
import signal
import sys

from bearingwear.process import set_environment


def run_program() -> int:
    """Run a command; return its exit status."""
    process = os.getpid()
    for number in (signal.SIGINT, signal.SIGTERM):
        # a shell has Ctrl-C ignored for what runs in the background
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            # Python restores the default as it ends: the signal would kill it after its work
            atexit.register(signal.signal, number, signal.SIG_IGN)
            signal.signal(number, lambda n, _: _end(process, n))
    set_environment()
    from bearingwear.cli import main

    return main()


def _end(process: int, number: int) -> None:
    if os.getpid() == process:  # else forked from it, and ended with it
        _tidy_up()
        os.write(2, b"interrupted\n" if number == signal.SIGINT else b"terminated\n")
    os._exit(128 + number)


def _tidy_up() -> None:
    """Stop other processes and remove what is half written."""
    if multiprocessing := sys.modules.get("multiprocessing"):
        for child in multiprocessing.active_children():
            child.terminate()
    if atomic := sys.modules.get("bearingwear.atomic"):
        atomic.remove_unfinished()


if __name__ == "__main__":
    sys.exit(run_program())
