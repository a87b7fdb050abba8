"""Ctrl-C while a kernel's result becomes a Python object."""

import subprocess
import sys

# prints a result, and how many of 300 signals raised KeyboardInterrupt; each comes after 0.1 to
# 0.2 ms, in which the kernel is called again and again
INTERRUPTED = """
import signal
from typing import NamedTuple
import numpy as np
from bearingwear.kernels.decorators import jit

class Inner(NamedTuple):
    x: float
    k: int

class Outer(NamedTuple):
    inner: Inner
    array: np.ndarray
    last: Inner

@jit
def kernel(x):
    return Outer(Inner(x, 1), np.full(3, x), Inner(-x, 2))

print(kernel(2.0))
signal.signal(signal.SIGALRM, signal.default_int_handler)
count = 0
for k in range(300):
    try:
        signal.setitimer(signal.ITIMER_REAL, 1e-4 + 1e-6 * (k % 100))
        while True:
            kernel(2.0)
    except KeyboardInterrupt:
        count += 1
print(count)
"""


def test_ctrl_c_while_a_result_is_converted_raises_keyboardinterrupt(tmp_path, monkeypatch):
    """Each of 300 signals does. Unpatched, numba would end the process at about every third.

    The signal is an alarm that is handled as Ctrl-C is.
    """
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    completed = subprocess.run(
        [sys.executable, "-X", "faulthandler", "-c", INTERRUPTED],
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert completed.returncode == 0, completed.stderr[-2000:]
    result, count = completed.stdout.splitlines()
    inner = "Inner(x=2.0, k=1)", "Inner(x=-2.0, k=2)"
    assert result == f"Outer(inner={inner[0]}, array=array([2., 2., 2.]), last={inner[1]})"
    assert count == "300"
