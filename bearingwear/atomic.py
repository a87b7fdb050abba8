"""Writes files that appear under their names only when complete, and checks what they replace."""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
import threading
from collections.abc import Iterator
from pathlib import Path

SIGNATURE = b"\x89HDF\r\n\x1a\n"
"""The first bytes of a netCDF-4 file."""

PROBE_BYTES = 16_000_000
"""Bytes written to a disk to find out whether it is full.

They are more than other processes free when their own writing to this disk fails.
"""

_WRITABLE = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH

UNFINISHED: set[Path] = set()
"""Files and folders that are removed if this process is interrupted."""


class OutputError(OSError):
    """A file that cannot be written; its text is one line that names the file."""


@contextlib.contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yields a temporary name to write to; at the end, its file is renamed to `path`.

    Missing folders are made. After an error, an existing file is as it was, and the temporary one
    is removed.

    OutputError: no permission, a file marked read-only, a full disk, an impossible name.
    """
    path = Path(path)
    if "\0" in str(path):
        raise OutputError(f"{path}: cannot be written (the file name contains a null character)")
    # the number of a thread is unique among all threads of all processes
    part = path.with_name(f".{path.name}.{threading.get_native_id()}.part")
    UNFINISHED.add(part)
    try:
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            _check_writable(path)
            # netCDF4 would call every fault "Permission denied", so each is raised here first
            part.open("wb").close()
            os.fspath(part).encode()  # fails for a name that is not UTF-8
            try:
                yield part
            except (OSError, RuntimeError):
                _check_disk_space(part)
                raise
            os.replace(part, path)
        finally:
            with contextlib.suppress(OSError):
                part.unlink(missing_ok=True)
            UNFINISHED.discard(part)
    except OutputError:
        raise
    except (OSError, RuntimeError, UnicodeError) as error:
        raise OutputError(f"{path}: cannot be written ({reason(error)})") from None


def remove_unfinished() -> None:
    """Removes the temporary files and folders of an interrupted process."""
    for part in UNFINISHED:
        if part.is_dir():
            shutil.rmtree(part, ignore_errors=True)
        else:
            part.unlink(missing_ok=True)


def _check_writable(path: Path) -> None:
    """Refuses to replace a file that is marked read-only, even for root, who could write to it."""
    if path.is_file() and not (path.stat().st_mode & _WRITABLE and os.access(path, os.W_OK)):
        raise OutputError(f"{path}: got a read-only file, expected a different file name")


def _check_disk_space(part: Path) -> None:
    """Appends bytes to a file, which raises OSError with the right reason if the disk is full.

    HDF5 raises a RuntimeError without a reason there, or calls it "Permission denied".
    """
    with part.open("ab") as file:
        file.write(bytes(PROBE_BYTES))


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Writes a text as UTF-8 to a file that appears only when it is complete.

    OutputError: it cannot be written.
    """
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8", newline="\n")


def reason(error: BaseException) -> str:
    """Returns why a file could not be read or written, on one line."""
    if isinstance(error, UnicodeDecodeError):
        return "its text is not UTF-8"
    if isinstance(error, UnicodeError):
        return "netCDF accepts only UTF-8 names"
    text = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return " ".join(str(text).split())


def check_output(path: Path, scene: str) -> None:
    """Refuses, before anything is solved, an output that cannot or must not be written.

    OutputError: a folder, the scene itself, an existing file that is no result or is read-only,
    more than one new folder.

    scene: file of the scene, which the output must not replace; it may be missing.
    """
    try:
        check_folder(path)
        if path.exists():
            if not path.is_file():
                raise OutputError(f"{path}: got a folder or a device, expected a file name")
            if os.path.exists(scene) and path.samefile(scene):
                raise OutputError(f"{path}: got the scene itself, expected a different file name")
            _check_replaceable(path)
            _check_writable(path)
    except OutputError:
        raise
    except OSError as error:  # a name that is too long
        raise OutputError(f"{path}: cannot be written ({error.strerror})") from None


def check_folder(path: Path) -> None:
    """Raises OutputError if a file needs more than one new folder, or if its folder is a file.

    A path with several new folders is probably mistyped.
    """
    if path.parent.exists() and not path.parent.is_dir():
        raise OutputError(f"{path.parent}: got a file, expected a folder")
    if not path.parent.parent.exists():
        raise OutputError(f"{path}: got more than one new folder, expected at most one")


def _check_replaceable(path: Path) -> None:
    """Refuses to write a result over a file of another kind, such as a scene."""
    with path.open("rb") as file:
        start = file.read(len(SIGNATURE))
    if start and start != SIGNATURE:
        raise OutputError(
            f"{path}: got an existing file that is not a result, expected a different file name"
        )
