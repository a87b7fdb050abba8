"""The decorators of all kernels."""

import contextlib

import numba
from numba.core.caching import FunctionCache
from numba.extending import overload

from bearingwear.provenance import kernel_cache_folder

# Reductions may be summed in any order (the strip sums vectorise only then); NaN, infinity and
# signed zero keep their meaning, so that a broken number is still seen.
REORDER_SUMS = {"reassoc", "contract", "nsz"}


class _Cache(FunctionCache):
    """numba's disk cache, from a disk that may be full or have lost what it held."""

    def load_overload(self, sig, target_context):
        try:
            return super().load_overload(sig, target_context)
        except Exception:  # whatever a truncated file unpickles to: it can be compiled again
            with contextlib.suppress(OSError):
                self.flush()
            return None

    def save_overload(self, sig, data):
        with contextlib.suppress(OSError):  # compiled code also runs where it cannot be kept
            super().save_overload(sig, data)


def jit(function=None, **options):
    """`numba.njit` with a disk cache that a changed source invalidates.

    `error_model="numpy"` because the check for division by zero would stop vectorisation. With
    `forceinline=True` a function is always compiled into its callers; the functions that it calls
    in its turn do not inherit that.
    The cache folder is numba's global setting; it is put back so that other users of numba in
    the same process keep theirs.
    """
    if function is None:
        return lambda f: jit(f, **options)
    options = {"error_model": "numpy", "forceinline": False} | options
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = kernel_cache_folder()
    try:
        compiled = numba.njit(**options)(function)
        if not numba.config.DISABLE_JIT:
            compiled._cache = _Cache(function)
        return compiled
    finally:
        numba.config.CACHE_DIR = before


def inlined(function):
    """Write a formula into every kernel that calls it, as if it stood there.

    It is then compiled under the caller's options, `fastmath` above all, and a loop that calls it
    vectorises. From Python it stays an ordinary function.
    """
    overload(function, inline="always", strict=False)(lambda *args: function)
    return function
