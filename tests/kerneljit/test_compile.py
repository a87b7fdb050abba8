"""While kernels are compiled: a line says so, Ctrl-C is answered, other processes wait."""

import ctypes
import fcntl
import gc
import os
import signal
import subprocess
import sys
import time

import numba
import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys
from support import scene_file, without_waits

from bearingwear.cli import main
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.linear import copy
from bearingwear.kernels.params import Geometry
from bearingwear.scene.read import load_scene
from bearingwear.solvers.solve import solve

GYRO = str(scene_file("gyro_s1"))
# the only line that is printed while code is compiled, and a program that needs a small kernel
LINE = "compiling part of the solver (only once); this may take a minute ...\n"
SMALL = """
from bearingwear.kernels.equilibrium.kinematics import rolling_orbit
print(rolling_orbit(1.0, 0.0, 9.0, 9.0, 0.0, 0.0))
"""

# calls a kernel from compiled code, and then from Python
BOTH_WAYS = """
import numba, sys
from bearingwear.kernels.layout import state_layout
# Names count what was compiled before: once without the kernel, once with it.
first = (lambda n: state_layout(n, False).cage) if "called" in sys.argv else (lambda n: 0)
numba.njit(first)(2)
print(state_layout(2, False).cage)
"""


def start_python(folder, *arguments):
    """Starts Python with a folder for compiled code; returns the process, with pipes of text."""
    return subprocess.Popen(
        [sys.executable, *arguments],
        env={**os.environ, "NUMBA_CACHE_DIR": str(folder)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def test_ctrl_c_while_code_is_loaded_raises_keyboardinterrupt(monkeypatch):
    """LLVM calls Python there by `ctypes`, and would lose the exception.

    A function that is called by C, and sends the signal, stands in for LLVM.
    """
    interrupted = ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(signal.SIGINT))
    monkeypatch.setattr(copy.disk, "load_overload", lambda args, target: interrupted())
    with pytest.raises(KeyboardInterrupt):
        copy._known(("no", "types"))


def test_ctrl_c_ends_a_command_that_compiles_within_two_seconds(tmp_path):
    """Status 130, one line, and only indices, code and locks of the cache: no temporary file."""
    output = tmp_path / "out.nc"
    process = start_python(tmp_path, "-m", "bearingwear", "solve", GYRO, "-o", str(output))
    while not without_waits(line := process.stderr.readline()) and line:
        pass  # over lines that say how long it has run
    assert line == LINE
    time.sleep(0.5)
    sent = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, message = process.communicate(timeout=30)
    assert time.monotonic() - sent < 2.0
    assert (process.returncode, without_waits(message)) == (130, "interrupted\n")
    assert {file.suffix for file in tmp_path.rglob("*.*") if file.is_file()} <= {
        ".nbi", ".nbc", ".lock",
    }  # fmt: skip


def test_one_process_compiles_and_the_others_wait(tmp_path):
    """Only the process with the lock compiles. If all code is on disk, nothing is printed.

    With the code removed and the lock taken here, a process waits, and then compiles.
    """
    compiling = start_python(tmp_path, "-c", SMALL)
    numbers, output = compiling.communicate(timeout=60)
    assert output == LINE
    assert start_python(tmp_path, "-c", SMALL).communicate(timeout=60) == (numbers, "")
    (lock,) = tmp_path.rglob("*.lock")
    for file in tmp_path.rglob("*.nb?"):
        file.unlink()
    with open(lock, "w") as lock_file:
        fcntl.flock(lock_file, fcntl.LOCK_EX)
        waiting = start_python(tmp_path, "-c", SMALL)
        assert waiting.stderr.readline() == LINE
    assert waiting.communicate(timeout=60) == (numbers, "")


def test_a_kernel_stored_as_a_callee_can_be_called_from_python(tmp_path):
    """Compiled for kernels alone, its code in the cache lacks the conversion of arrays for Python.

    10 is where the state of a cage begins in the layout of two balls.
    """
    for arguments in ((), ("called",)):
        process = start_python(tmp_path, "-c", BOTH_WAYS, *arguments)
        assert process.communicate(timeout=60)[0] == "10\n"
        assert process.returncode == 0


def test_check_does_not_mention_compilation_if_all_is_compiled(capsys):
    """Its line on the computing time is then that of a second solve."""
    solve(load_scene(GYRO))
    assert main(["check", GYRO]) == 0
    (line,) = (text for text in capsys.readouterr().out.splitlines() if "computing time" in text)
    assert "compil" not in line


@pytest.mark.parametrize("fidelity", ["race_control", "steady", "dynamic"])
def test_every_array_that_kernels_make_is_freed(fidelity):
    """Most kernels count no references; a wrong one would leak arrays, or free those in use."""
    scene = load_scene(GYRO, ["model.simulated_turns=0.1"])

    def array_count():
        """Returns how many arrays numba has made and not freed."""
        gc.collect()
        stats = rtsys.get_allocation_stats()
        return stats.mi_alloc - stats.mi_free

    solve(scene, fidelity)  # loads kernels, and fills caches
    _nrt_python.memsys_enable_stats()
    try:
        initial_count = array_count()
        for _ in range(3):
            solve(scene, fidelity)
        assert array_count() == initial_count
    finally:
        _nrt_python.memsys_disable_stats()


def test_other_numba_code_can_call_a_kernel():
    """numba's linking finds the code of the kernel, `copy`, which copies an array."""

    @numba.njit
    def doubled(values):
        out = np.empty(values.size)
        copy(values, out)
        return 2.0 * out

    assert doubled(np.arange(3.0)).tolist() == [0.0, 2.0, 4.0]


@jit
def diameter_ratio(record, other):
    """Returns the ratio of ball diameters of two records, which are passed by address."""
    return record.D0 / other.D0


@jit
def ratios(g, count, out):
    """Doubles the diameter of a record in a loop, and returns the last record.

    Writes to `out` the diameter over the last but one, plus the last diameter over the present one.
    """
    last = g
    for k in range(count):
        last_but_one, last = last, g
        g = Geometry(*g[:1], 2.0 * g.D0, *g[2:])
        out[k] = diameter_ratio(g, last_but_one) + diameter_ratio(last, g)
    return g


def test_a_kernel_gets_the_record_as_it_is_at_the_call():
    """Large records are passed by an address that another record may have afterwards.

    A sum of ratios is 2 + 1/2 in the first step, which has no last but one, and 4 + 1/2 later.
    """
    g = Geometry(9, 2e-3, 7.5e-3, 0.3, 2.5e-4, 3.5e-3, 3.6e-3, 1.1e-3, 1.2e-3, 1e11, 7800.0)
    result, expected = np.empty(4), np.empty(4)
    assert ratios(g, 4, result) == ratios.py_func(g, 4, expected) == g._replace(D0=16.0 * g.D0)
    assert result.tolist() == expected.tolist() == [2.5, 4.5, 4.5, 4.5]
