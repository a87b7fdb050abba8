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
from pathlib import Path

from bearingwear.kernels.build.versions import is_plain
from bearingwear.provenance import IN_CHECKOUT, PACKAGE, kernels_hash

_ROOT = 0  # may do everything anyway


@functools.cache
def code_folder() -> str:
    """The first of these that is private.

    Below `NUMBA_CACHE_DIR` if the user set it, else beside the sources in a checkout, else below
    the user's cache folder; else in the folder for temporary files. At worst a new one, for this
    process alone.

    Never beside an installed package: pip, which does not know of it, would leave the folder there
    when it removes the package, and Python would go on to import that folder.
    """
    name = f"numba-{kernels_hash()}" + ("-plain" if is_plain() else "")
    given = os.environ.get("NUMBA_CACHE_DIR")
    home = Path(os.path.expanduser("~"))
    caches = Path(os.environ.get("XDG_CACHE_HOME") or home / ".cache")
    # Who can write to these can change what Python itself runs.
    trusted = (PACKAGE / "__pycache__", home.resolve())
    parents = [caches / "bearingwear"]
    if given:
        parents = [Path(given)]
    elif IN_CHECKOUT:
        parents.insert(0, PACKAGE / "__pycache__")
    folders = [parent.resolve() / name for parent in parents if given or parent.is_absolute()]
    folders.append(Path(tempfile.gettempdir()).resolve() / f"bearingwear-{os.geteuid()}-{name}")
    for folder in folders:
        if _made(folder) and is_private(folder, trusted):
            break
    else:
        folder = Path(tempfile.mkdtemp(prefix="bearingwear-numba-"))
    if given and folder != folders[0]:
        tell(
            f"NUMBA_CACHE_DIR: {given} is not writable, or is writable by others; compiled code is "
            f"stored in {folder} instead"
        )
    return str(folder)


def tell_of_compiling() -> None:
    tell(f"compiling part of the solver (only once); this may take {compile_time()} ...")


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
        own = folder.lstat()
        if own.st_uid != user or not _is_closed(own.st_mode) or not os.access(folder, os.W_OK):
            return False
        for above in folder.parents:
            if above in trusted:
                break
            found = above.lstat()
            # in a sticky folder, as /tmp, only the owner of an entry may rename or remove it
            is_sticky = stat.S_ISDIR(found.st_mode) and found.st_mode & stat.S_ISVTX
            if found.st_uid not in (user, _ROOT) or not (_is_closed(found.st_mode) or is_sticky):
                return False
    except OSError:
        return False
    return True


def _is_closed(mode: int) -> bool:
    """Whether it is a folder, no link to one, and only its owner can write there."""
    return stat.S_ISDIR(mode) and not mode & (stat.S_IWGRP | stat.S_IWOTH)


def is_compiled(kernel: str) -> bool:
    """Whether machine code of a kernel that Python calls is in the folder."""
    return any(Path(code_folder()).rglob(f"*.{kernel}-*.nbc"))


def compile_time() -> str:
    """How long the solver takes to compile, at most, in words."""
    return "a few minutes" if is_plain() else "a minute"
