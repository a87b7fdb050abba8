"""How kernels become machine code: the decorators, numba behind them, and the folder for the code.

Nothing else in the package imports numba. `kernel` and `code` build on numba's internals, and serve
the versions that they are tested with (`versions`); any other version compiles by its public
interface alone, with the same numbers.
"""
