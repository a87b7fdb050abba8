"""Points and load shares on the major axis of a contact ellipse (theory.md section 3)."""

import numpy as np

from bearingwear.kernels.profile import PEAK, pressure, pressure_integral

SLOPE = 0.1  # ds/dz at 0 of a split rule: benchmarks/rules.py


def equal_strips(n):
    """Positions and load shares of n equal strips (the paper's way).

    The share is the strip's own part of the semi-ellipsoidal pressure, exact for constant slip.

    Returns
    -------
    t, weight : ndarray (n,)
    """
    edges = np.linspace(-1.0, 1.0, n + 1)
    t = 0.5 * (edges[1:] + edges[:-1])
    return t, np.diff(PEAK * pressure_integral(edges))


def gauss_legendre(m):
    """Gauss-Legendre points and weights (m,) on -1 to 1."""
    if m <= 100:
        return np.polynomial.legendre.leggauss(m)
    from scipy.special import roots_legendre  # numpy's cost rises with the third power of m

    return roots_legendre(m)


def gauss_halves(n):
    """Positions and load shares of Gauss-Legendre points on each half of the major axis.

    n points in all (one more if n is odd).
    """
    x, w = gauss_legendre((n + 1) // 2)
    half = 0.5 * (x + 1.0)
    t = np.concatenate([-half[::-1], half])
    w = 0.5 * np.concatenate([w[::-1], w])
    return t, PEAK * pressure(t) * w


def gathered(m):
    """Points and weights of m Gauss-Legendre points on 0 to 1 that gather at 0.

    They are s = 0.1 z + 0.9 z^3 of the points z: friction turns round at s = 0 within a width that
    is not known beforehand (anything from 1e-6 to 1), and the integrand is smooth in z at any.
    """
    x, w = gauss_legendre(m)
    z = 0.5 * (x + 1.0)
    return SLOPE * z + (1.0 - SLOPE) * z**3, 0.5 * w * (SLOPE + 3.0 * (1.0 - SLOPE) * z**2)
