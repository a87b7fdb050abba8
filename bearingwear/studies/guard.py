"""Runs a command, and interrupts it with all its children when standard input closes.

`bearingwear study` starts Snakemake this way, as the leader of a session. However `bearingwear
study` ends, its end of the pipe closes, and no job runs on.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading

GRACE = 10.0
"""Time after which an interrupted command is killed [s]."""


def run_guarded() -> int:
    """Runs the command in the arguments of this process, and returns its exit status.

    After the end by signal N, it is 128 + N. This process ignores interrupts from here on.
    """
    # an interrupt reaches the children too: they end, and this process waits for them
    signal.signal(signal.SIGINT, lambda *_: None)
    process = subprocess.Popen(sys.argv[1:], stdin=subprocess.DEVNULL, close_fds=False)
    threading.Thread(target=_interrupt_at_closed_input, daemon=True).start()
    status = process.wait()
    return status if status >= 0 else 128 - status  # as a shell reports the end by a signal


def _interrupt_at_closed_input() -> None:
    """Waits until standard input closes, interrupts the children, and kills them after `GRACE`.

    Both signals reach the whole process group, so that the second also kills this process.
    """
    while os.read(0, 1):  # until the command that started this ends
        pass
    os.killpg(0, signal.SIGINT)
    threading.Event().wait(GRACE)
    os.killpg(0, signal.SIGKILL)


if __name__ == "__main__":
    os._exit(run_guarded())  # its thread may still wait
