"""The folder for compiled code.

It is named by the contents of the kernels: numba itself checks only the file that holds a function,
not the functions it calls nor the order of a NamedTuple's fields, and would silently go on
returning old numbers.

Whoever can write a file there can run code as whoever loads it. So it is loaded from a folder that
is the user's own, that nobody else can write to, and that nobody else can put another one in place
of.
"""

import functools
import os
import stat
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from kerneljit.versions import is_tested, numba_version

_ROOT = 0  # may do everything anyway


@dataclass(frozen=True)
class Project:
    """A package whose kernels are compiled.

    name : its import name; records of its modules are passed by address.
    folder : its folder.
    kernels_hash : hash of the contents of its kernels, and of this package, as they lie on the
        disk when it is called.
    in_checkout : whether it is imported from a checkout, and not from where pip puts it.
    """

    name: str
    folder: Path
    kernels_hash: Callable[[], str]
    in_checkout: bool

    @property
    def switch(self) -> str:
        """The environment variable that keeps away from the internals of a tested numba too."""
        return f"{self.name.upper()}_PLAIN_NUMBA"

    @functools.cached_property
    def is_plain(self) -> bool:
        """Whether kernels are compiled by `numba.njit` alone."""
        return os.environ.get(self.switch, "") not in ("", "0") or not is_tested(numba_version())

    @functools.cached_property
    def code_folder(self) -> str:
        """The folder for the machine code of the kernels as they are imported."""
        return private_code_folder(self)

    def is_compiled(self, kernel: str) -> bool:
        """Whether machine code of a kernel that Python calls is in the folder."""
        return any(Path(self.code_folder).rglob(f"*.{kernel}-*.nbc"))

    @property
    def compile_time(self) -> str:
        """How long all kernels take to compile, at most, in words."""
        return "a few minutes" if self.is_plain else "a minute"

    def tell_of_compiling(self) -> None:
        """Say on standard error, once, that something is compiled."""
        tell(f"compiling part of the solver (only once); this may take {self.compile_time} ...")


def private_code_folder(project: Project) -> str:
    """The first of these that is private.

    Below `NUMBA_CACHE_DIR` if the user set it, else beside the sources in a checkout, else below
    the user's cache folder; else in the folder for temporary files. At worst a new one, for this
    process alone.

    Never beside an installed package: pip, which does not know of it, would leave the folder there
    when it removes the package, and Python would go on to import that folder.
    """
    name = f"numba-{project.kernels_hash()}" + ("-plain" if project.is_plain else "")
    asked_for = os.environ.get("NUMBA_CACHE_DIR")
    home = Path(os.path.expanduser("~"))
    caches = Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache")
    # Who can write to these can change what Python itself runs.
    beside = project.folder / "__pycache__"
    trusted = (beside, home.resolve())
    parents = [caches / project.name]
    if asked_for:
        parents = [Path(asked_for)]
    elif project.in_checkout:
        parents.insert(0, beside)
    folders = [parent.resolve() / name for parent in parents if asked_for or parent.is_absolute()]
    temporary = Path(tempfile.gettempdir()).resolve()
    folders.append(temporary / f"{project.name}-{os.geteuid()}-{name}")
    for folder in folders:
        if _made(folder) and is_private(folder, trusted):
            break
    else:
        folder = Path(tempfile.mkdtemp(prefix=f"{project.name}-numba-"))
    if asked_for and folder != folders[0]:
        tell(
            f"NUMBA_CACHE_DIR: {asked_for} is not writable, or is writable by others; compiled "
            f"code is stored in {folder} instead"
        )
    return str(folder)


@functools.cache
def tell(line: str) -> None:
    """Print a line to standard error, once."""
    print(line, file=sys.stderr, flush=True)


def _made(folder: Path) -> bool:
    """Make a folder and what is above it, for the user alone."""
    try:
        if not folder.parent.is_dir():
            _made(folder.parent)
        folder.mkdir(mode=0o700, exist_ok=True)
    except OSError:
        return False
    return True


def is_private(folder: Path, trusted: tuple[Path, ...] = ()) -> bool:
    """Whether a folder is the user's, and only the user can write there or replace it.

    Parameters
    ----------
    folder : Path
        Without symbolic links above it.
    trusted : tuple of Path
        What is above these is not looked at.
    """
    user = os.geteuid()
    try:
        status = folder.lstat()
        is_own = status.st_uid == user and _is_closed(status.st_mode)
        if not is_own or not os.access(folder, os.W_OK):
            return False
        for above in folder.parents:
            if above in trusted:
                break
            status = above.lstat()
            # in a sticky folder, as /tmp, only the owner of an entry may rename or remove it
            is_sticky = stat.S_ISDIR(status.st_mode) and status.st_mode & stat.S_ISVTX
            if status.st_uid not in (user, _ROOT) or not (_is_closed(status.st_mode) or is_sticky):
                return False
    except OSError:
        return False
    return True


def _is_closed(mode: int) -> bool:
    """Whether it is a folder, no link to one, and only its owner can write there."""
    return stat.S_ISDIR(mode) and not mode & (stat.S_IWGRP | stat.S_IWOTH)
