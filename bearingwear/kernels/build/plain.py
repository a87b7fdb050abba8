"""A kernel compiled by numba's public interface alone, for versions whose internals are unknown.

What `kernel` does beyond it is missing: each function is compiled as often as it is called from
another, processes do not wait for each other, and a full disk ends the process.
"""

import numba
from numba.core import event

from bearingwear.kernels.build.folder import code_folder, tell_of_compiling


class _Announcement(event.Listener):
    def on_start(self, event):
        if event.data["dispatcher"].py_func.__module__.startswith("bearingwear."):
            tell_of_compiling()

    def on_end(self, event):
        pass


event.register("numba:compile", _Announcement())


def plain_kernel(function, options, _level):
    folder, before = code_folder(), numba.config.CACHE_DIR
    numba.config.CACHE_DIR = folder
    try:
        kernel = numba.njit(cache=True, **options)(function)
    finally:
        numba.config.CACHE_DIR = before
    # Anywhere else, as beside the source, numba would load what is older than a function called.
    is_kept = kernel.stats.cache_path.startswith(folder)
    return kernel if is_kept else numba.njit(**options)(function)
