"""Which sources decide the numbers, and a hash of them.

The hash has two uses: every result file carries it, and numba's disk cache lives in a folder named
by it. numba itself checks only the file that holds a function, not the functions it calls nor the
order of a NamedTuple's fields, and would silently go on returning old numbers.
"""

import functools
import hashlib
import os
import tempfile
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent


def solver_sources() -> list[Path]:
    """Source files that decide the numbers in a case file (not figures, not commands)."""
    return sorted(
        [
            *PACKAGE.glob("kernels/*.py"),
            *PACKAGE.glob("model/*.py"),
            *PACKAGE.glob("io/variables.py"),
        ]
    )


SOLVER_SOURCES = solver_sources()


@functools.cache
def source_hash() -> str:
    """Hash of the contents of `SOLVER_SOURCES`, 16 hexadecimal digits."""
    digest = hashlib.sha256()
    for path in SOLVER_SOURCES:
        digest.update(path.relative_to(PACKAGE).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


@functools.cache
def contents_hash(*paths: str) -> str:
    """Hash of the contents of files, 16 hexadecimal digits; a missing one counts as empty."""
    digest = hashlib.sha256()
    for path in map(Path, paths):
        digest.update(hashlib.sha256(path.read_bytes() if path.is_file() else b"").digest())
    return digest.hexdigest()[:16]


@functools.cache
def kernel_cache_folder() -> str:
    """Folder for numba's compiled code, named by `source_hash`.

    Below `NUMBA_CACHE_DIR` if the user set it, else beside the package, else (package folder not
    writable) below the user's cache folder, else below the folder for temporary files.
    """
    given = os.environ.get("NUMBA_CACHE_DIR")
    home = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    parents = [given] if given else [PACKAGE / "__pycache__", Path(home) / "bearingwear"]
    for parent in [*parents, Path(tempfile.gettempdir()) / f"bearingwear-{os.getuid()}"]:
        folder = Path(parent) / f"numba-{source_hash()}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(folder, os.W_OK):
            return str(folder)
    return tempfile.mkdtemp(prefix="bearingwear-numba-")
