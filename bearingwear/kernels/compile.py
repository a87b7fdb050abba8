"""The one decorator all kernels use."""

import numba

from bearingwear.provenance import kernel_cache_folder

# Reductions may be summed in any order (the strip sums vectorise only then); NaN, infinity and
# signed zero keep their meaning, so that a broken number is still seen.
REORDER_SUMS = {"reassoc", "contract", "nsz"}


def jit(function=None, **options):
    """`numba.njit` with a disk cache that a changed source invalidates.

    `error_model="numpy"` because the check for division by zero would stop vectorisation.
    The cache folder is numba's global setting; it is put back so that other users of numba in
    the same process keep theirs.
    """
    if function is None:
        return lambda f: jit(f, **options)
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = kernel_cache_folder()
    try:
        return numba.njit(cache=True, error_model="numpy", **options)(function)
    finally:
        numba.config.CACHE_DIR = before
