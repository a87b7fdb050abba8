"""Points and load shares on the major axis of a contact ellipse (theory.md section 3)."""

import numpy as np


def equal_strips(n):
    """Positions and load shares of n equal strips (the paper's way).

    The share is the strip's own part of the semi-ellipsoidal pressure, exact for constant slip.

    Returns
    -------
    t, weight : ndarray (n,)
    """
    edges = np.linspace(-1.0, 1.0, n + 1)
    t = 0.5 * (edges[1:] + edges[:-1])
    cumulative = 0.75 * (edges - edges**3 / 3.0)
    return t, np.diff(cumulative)


def gauss_halves(n):
    """Positions and load shares of Gauss-Legendre points on each half of the major axis.

    n points in all (one more if n is odd).
    """
    m = (n + 1) // 2
    if m <= 100:
        x, w = np.polynomial.legendre.leggauss(m)
    else:  # numpy's cost rises with the third power of the count
        from scipy.special import roots_legendre

        x, w = roots_legendre(m)
    half = 0.5 * (x + 1.0)
    t = np.concatenate([-half[::-1], half])
    w = 0.5 * np.concatenate([w[::-1], w])
    return t, 0.75 * (1.0 - t * t) * w
