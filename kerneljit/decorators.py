"""The decorators of a project's kernels."""

from collections.abc import Callable
from typing import Any

from kerneljit.interrupt import Interrupt
from kerneljit.project import Project

with Interrupt():  # numba's C code would report Ctrl-C as an ImportError
    import numba
    from numba.extending import overload


class Decorators:
    """`jit` and `inlined` for the kernels of a project.

    level : LLVM's optimisation level of a function that Python calls, unless `jit` names another.
    **options : of `numba.njit`, for every kernel.
    """

    def __init__(self, project: Project, level: int = 3, **options: Any):
        self.level, self.options = level, options
        project.code_folder  # noqa: B018  named by the sources as they are imported
        if project.is_plain:
            from kerneljit.plain import announce, plain_kernel

            announce(project)
            self._kernel: Callable = lambda function, options, _: plain_kernel(
                project, function, options
            )
        else:
            from kerneljit.kernel import Kernel

            self._kernel = lambda function, options, level: Kernel(
                project, function, options, level
            )

    def jit(self, function=None, level: int | None = None, **options: Any):
        """`numba.njit` with a disk cache that a changed source invalidates.

        With `forceinline=True` a function is always compiled into its callers; the functions that
        it calls in its turn do not inherit that.
        """
        if function is None:
            return lambda f: self.jit(f, level, **options)
        if numba.config.DISABLE_JIT:
            return function
        level = self.level if level is None else level
        return self._kernel(function, self.options | options, level)


def compile_together(kernel, other, types_of) -> None:
    """Compile two kernels that Python calls as one library, in which what both call stands once.

    `types_of(*types)` gives the types of the other's arguments from those of the kernel's.
    """
    if hasattr(kernel, "companions"):
        kernel.companions.append((other, types_of))


def inlined(function):
    """Write a formula into every kernel that calls it, as if it stood there.

    It is then compiled under the caller's options, `fastmath` above all, and a loop that calls it
    vectorises. From Python it stays an ordinary function.
    """
    overload(function, inline="always", strict=False)(lambda *args: function)
    return function
