"""The versions of numba whose internals are known here."""

import functools
import re
import sys

TESTED = ((0, 67), (0, 68))
"""The oldest and the newest version whose internals `kernel` and `code` are tested with.

Bug-fix releases belong to their version. Older and newer ones compile by numba's public interface.
"""


def is_tested(version: str) -> bool:
    """Whether the internals of a version of numba are known."""
    oldest, newest = TESTED
    return oldest <= tuple(int(part) for part in re.findall(r"\d+", version)[:2]) <= newest


@functools.cache
def numba_version() -> str:
    """The installed version, without importing numba."""
    if "numba" in sys.modules:  # quicker than asking the installed packages
        return sys.modules["numba"].__version__
    from importlib import metadata

    return metadata.version("numba")
