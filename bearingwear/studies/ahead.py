"""Compiles what lives with worn grooves call, while a command compiles the steady solver.

A command starts this module in a process of its own (`compiled_beside`), which finds the types of
all arguments by calling the kernels: once from a rough state, which needs no steady solve, then for
the life itself. Each kernel is compiled by one process; the other one waits for it.
"""

import contextlib
import fcntl
import os
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from typing import Any

from bearingwear.kernels.build.folder import code_folder, is_compiled
from bearingwear.kernels.build.versions import is_plain
from bearingwear.process import python_command
from bearingwear.studies.sampling import usable_cores

_STEADY, _WORN = "thrust_case", "worn_state"
_CELLS = 8, 2  # numbers and sizes matter little here: types do
_MAJOR = 0.05  # of the ball diameter


@contextlib.contextmanager
def compiled_beside(file: str, settings: Sequence[str]) -> Iterator[None]:
    """Compile the kernels of a scene's life beside the work in this block, where they are missing.

    The process ends by itself, or with the block where that fails or is interrupted.
    """
    if usable_cores() < 2 or is_plain() or is_compiled(_STEADY) or is_compiled(_WORN):
        yield
        return
    process = _started(file, settings)
    try:
        yield
    except BaseException:
        if process is not None:
            process.kill()
            process.wait()
        raise
    if process is not None and process.stdin is not None:
        with contextlib.suppress(OSError):
            process.stdin.write(b"\n")
            process.stdin.close()


def _started(file: str, settings: Sequence[str]) -> subprocess.Popen | None:
    """The process, or none where another command has started one."""
    try:
        lock = open(os.path.join(code_folder(), "ahead.lock"), "w")
    except OSError:
        return None
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return None
        with contextlib.suppress(OSError, ValueError):  # of a name that no process can be given
            return subprocess.Popen(
                python_command("bearingwear.studies.ahead", file, *settings),
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,  # Ctrl-C is for the command
                pass_fds=[lock.fileno()],  # which is locked until the process ends
            )
    return None


def _end_with_command() -> None:
    """Wait for a line from the command; it ended early without one."""
    if not sys.stdin.readline():
        os._exit(1)


def compile_life(file: str, settings: Sequence[str]) -> None:
    """Call the kernels of a life with worn grooves; nothing where the scene's life has none."""
    import numpy as np

    from bearingwear.kernels.contact.summary import ANGLE, COLUMNS, LOAD, MAJOR
    from bearingwear.kernels.equilibrium.kinematics import OUTER_CONTROL
    from bearingwear.kernels.steady.thrust import ThrustCase
    from bearingwear.kernels.worn.pressure import contact_cells
    from bearingwear.lives.groove_life import grooves_followed
    from bearingwear.lives.life import life
    from bearingwear.scene.read import for_life, load_scene
    from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
    from bearingwear.solvers.effects.choice import choice_for_life
    from bearingwear.solvers.worn.bearing import WornBearing

    scene = for_life(load_scene(file, settings), file)
    followed, _ = grooves_followed(scene, choice_for_life(scene, None).fidelity)
    if followed is None:
        return
    contact_cells(
        0.0, -1.0, 1.0, 3.0, *_CELLS
    )  # the command compiles what a problem needs meanwhile
    problem = ThrustProblem.of(followed.sides[0])
    contacts = np.zeros((2, COLUMNS))
    contacts[:, ANGLE], contacts[:, LOAD] = problem.g.alpha0, problem.preload.F_x
    contacts[:, MAJOR] = _MAJOR * problem.g.D0
    rough: dict[str, Any] = dict.fromkeys(ThrustCase._fields, 0.0) | {
        "delta_a": problem.preload.delta_a,
        "u": problem.kinematic_start(OUTER_CONTROL),
        "contacts": contacts,
    }
    bearing = WornBearing(problem, ThrustCase(**rough), 0.0)
    bearing.solve(bearing.unworn())  # whether it is found or not
    life(scene)


if __name__ == "__main__":
    threading.Thread(target=_end_with_command, daemon=True).start()
    with contextlib.suppress(Exception):  # reported by the command itself
        compile_life(sys.argv[1], sys.argv[2:])
