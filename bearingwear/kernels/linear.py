"""Small dense linear systems of the solvers, and copies of arrays, without allocation."""

import numpy as np

from bearingwear.kernels.decorators import jit


@jit
def copy(values, out):
    """Write an array into another of its shape.

    `out[:] = values` would compile a library of strings with it, for a message about shapes.
    """
    for place in np.ndindex(values.shape):
        out[place] = values[place]


@jit
def add_multiple(a, factor, b, out):
    """out = a + factor b, for arrays of one shape."""
    for place in np.ndindex(out.shape):
        out[place] = a[place] + factor * b[place]


@jit
def accumulate(factor, row, out):
    """out += factor row, for as many numbers as `out` has."""
    for k in range(out.size):
        out[k] += factor * row[k]


@jit
def solve_in_place(A, b, n):
    """Solve A x = b by Gaussian elimination with row pivoting; x replaces b, A is destroyed.

    Parameters
    ----------
    A : ndarray (>= n, >= n)
    b : ndarray (>= n,)

    Returns
    -------
    bool
        False where A is singular.
    """
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(A[i, k]) > abs(A[pivot, k]):
                pivot = i
        if not abs(A[pivot, k]) > 0.0:
            return False
        if pivot != k:
            for j in range(k, n):
                A[k, j], A[pivot, j] = A[pivot, j], A[k, j]
            b[k], b[pivot] = b[pivot], b[k]
        for i in range(k + 1, n):
            factor = A[i, k] / A[k, k]
            for j in range(k + 1, n):
                A[i, j] -= factor * A[k, j]
            b[i] -= factor * b[k]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            b[k] -= A[k, j] * b[j]
        b[k] /= A[k, k]
    return True


@jit
def factor_in_place(A, pivots, n):
    """LU factors of the leading n x n of A with row pivoting, in its place; False where singular.

    Parameters
    ----------
    pivots : ndarray of int (>= n,)
        Filled: the row that each one was swapped with.
    """
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(A[i, k]) > abs(A[pivot, k]):
                pivot = i
        pivots[k] = pivot
        if not abs(A[pivot, k]) > 0.0:
            return False
        if pivot != k:
            for j in range(n):
                A[k, j], A[pivot, j] = A[pivot, j], A[k, j]
        for i in range(k + 1, n):
            factor = A[i, k] / A[k, k]
            A[i, k] = factor
            if factor != 0.0:
                for j in range(k + 1, n):
                    A[i, j] -= factor * A[k, j]
    return True


@jit
def solve_factored(A, pivots, b, n):
    """Solve with the factors of `factor_in_place`; x replaces b (>= n,)."""
    for k in range(n):
        pivot = pivots[k]
        b[k], b[pivot] = b[pivot], b[k]
    for k in range(n):
        value = b[k]
        for j in range(k):
            value -= A[k, j] * b[j]
        b[k] = value
    for k in range(n - 1, -1, -1):
        value = b[k]
        for j in range(k + 1, n):
            value -= A[k, j] * b[j]
        b[k] = value / A[k, k]
