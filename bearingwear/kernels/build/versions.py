"""The versions of numba whose internals are known here."""

import functools
import os
import re
import sys

TESTED = ((0, 67), (0, 68))
"""The oldest and the newest version whose internals `kernel` and `code` are tested with.

Bug-fix releases belong to their version. pyproject.toml allows older and newer ones.
"""

SWITCH = "BEARINGWEAR_PLAIN_NUMBA"
"""The environment variable that keeps away from the internals of a tested version too."""


def is_tested(version: str) -> bool:
    oldest, newest = TESTED
    return oldest <= tuple(int(part) for part in re.findall(r"\d+", version)[:2]) <= newest


@functools.cache
def is_plain() -> bool:
    """Whether kernels are compiled by `numba.njit` alone."""
    return os.environ.get(SWITCH, "") not in ("", "0") or not is_tested(numba_version())


@functools.cache
def numba_version() -> str:
    """The installed one, without importing numba."""
    if "numba" in sys.modules:  # quicker than asking the installed packages
        return sys.modules["numba"].__version__
    from importlib import metadata

    return metadata.version("numba")
