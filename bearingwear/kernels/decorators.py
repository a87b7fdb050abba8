"""The decorators of all kernels."""

from bearingwear.kernels.project import PROJECT
from kerneljit.decorators import Decorators, compile_together, inlined

__all__ = ["ESTIMATE_ROOTS", "REORDER_SUMS", "compile_together", "inlined", "jit"]

# Reductions may be summed in any order (the strip sums vectorise only then); NaN, infinity and
# signed zero keep their meaning, so that a broken number is still seen. A loop that sums stores
# nothing: LLVM would test at run time how far its arrays lie apart, and take the sum in another
# order where they happen to lie close, so that last bits change from run to run.
REORDER_SUMS = {"reassoc", "contract", "nsz"}
# And a root may begin with the processor's estimate of it, see friction.inverse_root.
ESTIMATE_ROOTS = REORDER_SUMS | {"afn", "arcp"}

# The check for division by zero would stop vectorisation.
jit = Decorators(PROJECT, error_model="numpy").jit
"""`numba.njit` with a disk cache. Of a function that Python calls, `level` is LLVM's optimisation
level; level 1 compiles in two thirds of the time that level 3, the default, takes."""
