"""The environment of a command, and how it starts Python for other processes of its own."""

from __future__ import annotations

import contextlib
import os
import pwd
import sys
from pathlib import Path

ONE_THREAD = "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"
"""Variables that set the number of threads of OpenMP, OpenBLAS and MKL. On small matrices, several
threads take several times the CPU time of one."""

_CACHES = "bearingwear", "snakemake/source-cache/snakemake-runtime-cache"
"""Folders that are made below the user's folder for caches."""


def set_environment() -> None:
    """Sets the environment of this process and its children, before libraries are imported.

    It sets the backend of figures, a safe search path of modules and, unless the user has set it,
    one thread for each library. It also sets folders for caches and a user name if the usual ones
    are missing.
    """
    # figures go to files: a user's backend may need a display, or not be installed
    os.environ["MPLBACKEND"] = "agg"
    os.environ["PYTHONSAFEPATH"] = "1"  # a file `signal.py` of the user is not imported
    for name in ONE_THREAD:
        os.environ.setdefault(name, "1")
    _set_home()
    _set_user()


def _set_home() -> None:
    """Sets a private folder for the caches of libraries if the usual ones cannot be used.

    The variables are `XDG_CACHE_HOME`, `MPLCONFIGDIR` unless it is set, and `HOME` if that is no
    readable folder. If home and usual folders can be used, none is changed.
    """
    home = os.path.expanduser("~")
    is_home = os.path.isabs(home) and os.path.isdir(home) and os.access(home, os.R_OK | os.X_OK)
    caches = os.environ.get("XDG_CACHE_HOME") or os.path.join(home, ".cache")
    folders = [os.path.join(caches, name) for name in _CACHES]
    if is_home and os.path.isabs(caches) and all(_can_be_written(folder) for folder in folders):
        return
    private_folder = _private_folder()
    os.environ["XDG_CACHE_HOME"] = private_folder
    os.environ.setdefault("MPLCONFIGDIR", os.path.join(private_folder, "matplotlib"))
    if not is_home:
        os.environ["HOME"] = private_folder


def _can_be_written(folder: str) -> bool:
    """Returns whether a folder can be written to, or could be made.

    folder: an absolute path.
    """
    while not os.path.lexists(folder):
        folder = os.path.dirname(folder)
    return os.path.isdir(folder) and os.access(folder, os.W_OK | os.X_OK)


def _private_folder() -> str:
    """Makes a folder that only this user can write to, below that for temporary files; returns it.

    It is the same one each time. Only if another user has taken its name is it a new one.
    """
    import tempfile

    from kerneljit.project import is_private

    folder = Path(tempfile.gettempdir()).resolve() / f"bearingwear-{os.geteuid()}"
    with contextlib.suppress(OSError):
        folder.mkdir(mode=0o700, exist_ok=True)
    return str(folder) if is_private(folder) else tempfile.mkdtemp(prefix="bearingwear-")


def _set_user() -> None:
    """Sets LOGNAME to the user's number if the user has no name, since Snakemake asks for one."""
    if not any(os.environ.get(name) for name in ("LOGNAME", "USER", "LNAME", "USERNAME")):
        try:
            pwd.getpwuid(os.getuid())
        except KeyError:
            os.environ["LOGNAME"] = str(os.getuid())


def python_command(module: str, *arguments: str) -> list[str]:
    """Returns the command that runs a module of this copy of the package in another process.

    module: its dotted name, such as `bearingwear`.
    *arguments: of the module's command line.
    """
    script = Path(__file__).with_name("run_module.py")
    return [sys.executable, "-P", str(script), module, *arguments]
