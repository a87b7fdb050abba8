"""A kernel compiled by numba's public interface alone, for versions whose internals are unknown.

What `kernel` does beyond it is missing: each function is compiled as often as it is called from
another, processes do not wait for each other, and a full disk ends the process.
"""

import numba
from numba.core import event

from kerneljit.project import Project


class _Announcement(event.Listener):
    def __init__(self, project: Project):
        self.project = project

    def on_start(self, event):
        if event.data["dispatcher"].py_func.__module__.startswith(f"{self.project.name}."):
            self.project.tell_of_compiling()

    def on_end(self, event):
        pass


def announce(project: Project) -> None:
    """Say on standard error when a kernel of the project is compiled."""
    event.register("numba:compile", _Announcement(project))


def plain_kernel(project: Project, function, options):
    """A function compiled by `numba.njit`, and kept in the project's folder."""
    folder, before = project.code_folder, numba.config.CACHE_DIR
    numba.config.CACHE_DIR = folder
    try:
        kernel = numba.njit(cache=True, **options)(function)
    finally:
        numba.config.CACHE_DIR = before
    # Anywhere else, as beside the source, numba would load what is older than a function called.
    is_kept = kernel.stats.cache_path.startswith(folder)
    return kernel if is_kept else numba.njit(**options)(function)
