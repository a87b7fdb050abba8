"""The decorators of all kernels."""

from bearingwear.interrupt import Interrupt

with Interrupt():  # numba's C code would report Ctrl-C as an ImportError
    import numba
    from numba.extending import overload

from bearingwear.kernels.build.versions import is_plain

# Reductions may be summed in any order (the strip sums vectorise only then); NaN, infinity and
# signed zero keep their meaning, so that a broken number is still seen. A loop that sums stores
# nothing: LLVM would test at run time how far its arrays lie apart, and take the sum in another
# order where they happen to lie close, so that last bits change from run to run.
REORDER_SUMS = {"reassoc", "contract", "nsz"}
# And a root may begin with the processor's estimate of it, see friction.inverse_root.
ESTIMATE_ROOTS = REORDER_SUMS | {"afn", "arcp"}

if is_plain():
    from bearingwear.kernels.build.plain import plain_kernel as _compiled
else:
    from bearingwear.kernels.build.kernel import Kernel as _compiled


def jit(function=None, level=3, **options):
    """`numba.njit` with a disk cache that a changed source invalidates.

    `level` is LLVM's optimisation level of a function that Python calls. Level 1 takes two thirds
    of the time that level 3 takes.

    `error_model="numpy"` because the check for division by zero would stop vectorisation. With
    `forceinline=True` a function is always compiled into its callers; the functions that it calls
    in its turn do not inherit that.
    """
    if function is None:
        return lambda f: jit(f, level, **options)
    if numba.config.DISABLE_JIT:
        return function
    return _compiled(function, {"error_model": "numpy"} | options, level)


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
