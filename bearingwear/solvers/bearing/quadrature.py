"""Points over a contact ellipse, their shares of its load and of its area (theory.md section 3)."""

import numpy as np
from numpy.polynomial.legendre import legval, legvander

from bearingwear.kernels.contact.profile import MIDDLE_WIDTH, PEAK, pressure, pressure_integral

FEWEST_ACROSS = 6  # of `spread_ellipse`
MANY_ACROSS = 16  # likewise
NEAR = 0.25  # share of a segment, beyond which friction is smooth across a strip
SLOPE = 0.1  # ds/dz at 0 of a split rule: benchmarks/rules.py


def equal_strips(n):
    """Returns positions and load shares (n,) of n equal strips, as in the paper.

    The share is the strip's own part of the semi-ellipsoidal pressure, exact for constant slip.
    """
    edges = np.linspace(-1.0, 1.0, n + 1)
    t = 0.5 * (edges[1:] + edges[:-1])
    return t, np.diff(PEAK * pressure_integral(edges))


def strip_tips(n):
    """Returns the area of n equal strips over width in their middle times length (n,)."""
    edges = np.linspace(-1.0, 1.0, n + 1)
    area = np.diff(edges * np.sqrt(pressure(edges)) + np.arcsin(edges)) / np.pi
    t, weight = equal_strips(n)
    return area / (MIDDLE_WIDTH / PEAK * weight / np.sqrt(pressure(t)))


def uniform(y, low=-1.0, high=1.0):
    """Returns weights of n points for a uniform density, exact for polynomials of degree n - 1."""
    z = (2.0 * y - low - high) / (high - low)
    moments = np.zeros(y.size)
    moments[0] = high - low
    return np.linalg.solve(legvander(z, y.size - 1).T, moments)


def tips(m):
    """Returns factors on the weights of m Gauss-Legendre points on 0 to 1 under sqrt(1 - z).

    With them the root times a polynomial of the degree m - 1 is integrated exactly: the factors are
    the root's Legendre series, as far as m terms go, over the root.
    """
    x, _ = gauss_legendre(m)
    k = np.arange(m)
    return legval(x, -2.0 / ((2 * k - 1) * (2 * k + 3))) / np.sqrt(0.5 * (1.0 - x))


def gauss_legendre(m):
    """Returns Gauss-Legendre points and weights (m,) on -1 to 1."""
    if m <= 100:
        return np.polynomial.legendre.leggauss(m)
    from scipy.special import roots_legendre  # numpy's cost rises with the third power of m

    return roots_legendre(m)


def gauss_halves(n):
    """Returns positions and load shares of Gauss-Legendre points on each half of the major axis.

    n points in all (one more if n is odd).
    """
    x, w = gauss_legendre((n + 1) // 2)
    half = 0.5 * (x + 1.0)
    t = np.concatenate([-half[::-1], half])
    w = 0.5 * np.concatenate([w[::-1], w])
    return t, PEAK * pressure(t) * w


def gathered(m, power=3):
    """Returns points and weights of m Gauss-Legendre points on 0 to 1 that gather at 0.

    They are s = 0.1 z + 0.9 z^3 of the points z: friction turns round at s = 0 within a width that
    is not known beforehand (anything from 1e-6 to 1), and the integrand is smooth in z at any.
    Where spin across the ellipse makes that width large, the square of z takes fewer points.
    """
    x, w = gauss_legendre(m)
    z = 0.5 * (x + 1.0)
    slope = SLOPE + power * (1.0 - SLOPE) * z ** (power - 1)
    return SLOPE * z + (1.0 - SLOPE) * z**power, 0.5 * w * slope


def normalised(t, weight):
    """Returns slightly changed weights of points on 0 to 1 that integrate up to t^2 exactly.

    The load over an ellipse is then exact, which it must be.
    """
    powers = np.array([np.ones_like(t), t, t * t])
    missing = 1.0 / np.arange(1.0, 4.0) - powers @ weight
    return weight + weight * (powers.T @ np.linalg.solve(powers * weight @ powers.T, missing))


def chebyshev(n):
    """Returns places across a strip over its half-width, and shares of its load, at n points.

    Gauss-Chebyshev points of the second kind: exact for polynomials of the degree 2 n - 1 under the
    semi-ellipse that Hertz' pressure is across the contact. One point is the line model.
    """
    angle = np.pi * np.arange(1, n + 1) / (n + 1)
    across = np.cos(angle)
    across[n // 2 : n - n // 2] = 0.0  # the middle of an odd number, but for rounding
    return across, 2.0 / (n + 1) * np.sin(angle) ** 2


def even_shares(across, halves):
    """Returns the shares of a strip's area at its points.

    halves: whether each half of the strip is integrated by itself.
    """
    if not halves or across.size == 1:
        return 0.5 * uniform(across)
    half = 0.5 * uniform(across[across.size // 2 :], 0.0, 1.0)
    return np.concatenate([half[::-1], half])


def chebyshev_halves(n):
    """Returns Gauss points on each half of the strip and their shares, for a bend in its middle.

    n points in all (one more if n is odd, but for 1), exact under the semi-ellipse on either half.
    They are the eigenvalues of the Jacobi matrix of the polynomials orthogonal there (Golub and
    Welsch 1969), found by Stieltjes' procedure.
    """
    if n == 1:
        return chebyshev(1)
    m = (n + 1) // 2
    angle, weight = gauss_legendre(max(100, 2 * m))
    angle = 0.25 * np.pi * (angle + 1.0)
    y, weight = np.cos(angle), weight * np.sin(angle) ** 2
    mean, norm = np.zeros(m), np.empty(m)
    previous, current = np.zeros(y.size), np.ones(y.size)
    for k in range(m):
        norm[k] = (weight * current * current).sum()
        mean[k] = (weight * y * current * current).sum() / norm[k]
        ratio = norm[k] / norm[k - 1] if k else 0.0
        previous, current = current, (y - mean[k]) * current - ratio * previous
    off_diagonal = np.sqrt(norm[1:] / norm[:-1])
    half, vectors = np.linalg.eigh(
        np.diag(mean) + np.diag(off_diagonal, 1) + np.diag(off_diagonal, -1)
    )
    share = 0.5 * vectors[0] ** 2
    return np.concatenate([-half[::-1], half]), np.concatenate([share[::-1], share])


def spread_ellipse(m, across):
    """Returns the points of a split rule over the ellipse for the motion in time.

    They are as accurate as the rule with half its points (benchmarks/ellipse.py). Near the
    pure-rolling point there are three for four across; farther off, where friction is smooth, there
    are fewer and fewer. In a segment too short for that, the error concerns little load. From
    `MANY_ACROSS` on, all strips are alike. With fewer than `FEWEST_ACROSS`, the motion of the
    points would disturb the balance that they measure, so there are never fewer.

    m: points in a segment.
    across: points across the ellipse.
    """
    t, weight = gathered(m, power=2)
    across = max(across, FEWEST_ACROSS)
    rows = []
    columns = t, PEAK * normalised(t, weight), MIDDLE_WIDTH * weight, tips(m)
    for s, w, length, tip in zip(*columns, strict=True):
        count = round(across * max(0.25, 0.55 - 0.5 * s))
        near = s < NEAR or across >= MANY_ACROSS
        y, share = chebyshev_halves(2 * -(-3 * across // 8)) if near else chebyshev(count)
        area = length * even_shares(y, near)
        ones = np.ones(y.size)
        rows.append((s * ones, w * share, y, float(near) * ones, area, tip * ones))
    return tuple(np.concatenate(column) for column in zip(*rows, strict=True))


def spread_fixed(t, weight, tip, across, share, even):
    """Returns the points of a rule with fixed points as the fields of `EllipsePoints`."""
    density = weight / pressure(t)
    loads, areas = np.outer(density, share), np.outer(MIDDLE_WIDTH / PEAK * density * tip, even)
    n = across.size
    ones, zeros = np.ones(loads.size), np.zeros(loads.size)
    return t.repeat(n), loads.ravel(), np.tile(across, t.size), zeros, areas.ravel(), ones
