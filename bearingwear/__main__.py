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
    """Runs a command and returns its exit status.

    Before, it sets the environment for libraries, and handlers of Ctrl-C and SIGTERM that end the
    process at once. A signal that is ignored, or has another handler, is left alone.
    """
    process = os.getpid()
    for signal_number in (signal.SIGINT, signal.SIGTERM):
        # a shell starts a background job with Ctrl-C ignored, which must stay so
        if signal.getsignal(signal_number) in (signal.SIG_DFL, signal.default_int_handler):
            # Python restores the default handler as it ends, and a late signal would kill it
            atexit.register(signal.signal, signal_number, signal.SIG_IGN)
            signal.signal(signal_number, lambda number, _: _exit_on_signal(process, number))
    set_environment()
    from bearingwear.cli import main

    return main()


def _exit_on_signal(process: int, number: int) -> None:
    """Ends this process at once with the status of a signal, 128 plus its number.

    process: id of the process of the command, which tidies up and prints a line. A process forked
        from it has the same handler, but only ends.
    number: of the signal.
    """
    if os.getpid() == process:
        _tidy_up()
        os.write(2, b"interrupted\n" if number == signal.SIGINT else b"terminated\n")
    os._exit(128 + number)


def _tidy_up() -> None:
    """Stops worker processes and removes unfinished files."""
    if multiprocessing := sys.modules.get("multiprocessing"):
        for child in multiprocessing.active_children():
            child.terminate()
    if atomic := sys.modules.get("bearingwear.atomic"):
        atomic.remove_unfinished()


if __name__ == "__main__":
    sys.exit(run_program())
