"""Vectors of three components as tuples, which stay in registers."""

from bearingwear.kernels.decorators import jit


@jit
def cross(a, b):
    """Vector product."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@jit
def dot(a, b):
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@jit
def plus(a, b):
    """Sum."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@jit
def minus(a, b):
    """Difference."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@jit
def times(factor, a):
    """Multiple."""
    return factor * a[0], factor * a[1], factor * a[2]


@jit
def unit(i):
    """Unit vector along axis i."""
    return 1.0 if i == 0 else 0.0, 1.0 if i == 1 else 0.0, 1.0 if i == 2 else 0.0


@jit
def triple(array, start):
    """Three components of a flat array from `start` on."""
    return array[start], array[start + 1], array[start + 2]


@jit
def store(a, out):
    """Write a vector into an array (3,)."""
    out[0], out[1], out[2] = a[0], a[1], a[2]
