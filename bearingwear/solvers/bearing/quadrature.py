"""Points over a contact ellipse, their shares of its load and of its area (theory.md section 3)."""

import functools
import math

import numpy as np
from numpy.polynomial.legendre import legval, legvander

from bearingwear.kernels.contact.ellipse_friction import EllipsePoints
from bearingwear.kernels.contact.points import Rule
from bearingwear.kernels.contact.profile import MIDDLE_WIDTH, PEAK, pressure, pressure_integral

FEWEST_ACROSS = 6  # of `spread_ellipse`
MANY_ACROSS = 16  # likewise
NEAR = 0.25  # share of a segment, beyond which friction is smooth across a strip
NEAR_SHARE, FAR_SHARE = 0.75, 0.25  # points across over those asked for: near, and at least beyond
MOST_BY_NUMPY = 100  # points of a rule; NumPy's cost rises with the third power of them
SLOPE = 0.1  # ds/dz at 0 of a split rule: benchmarks/rules.py


def equal_strips(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns positions and load shares (n,) of n equal strips, as in the published model.

    The share is the strip's own part of the semi-ellipsoidal pressure, exact for constant slip.
    """
    edges = np.linspace(-1.0, 1.0, n + 1)
    t = 0.5 * (edges[1:] + edges[:-1])
    return t, np.diff(PEAK * pressure_integral(edges))


def strip_area_factors(n: int) -> np.ndarray:
    """Returns the area of n equal strips over width in their middle times length (n,)."""
    edges = np.linspace(-1.0, 1.0, n + 1)
    area = np.diff(edges * np.sqrt(pressure(edges)) + np.arcsin(edges)) / np.pi
    t, weight = equal_strips(n)
    return area / (MIDDLE_WIDTH / PEAK * weight / np.sqrt(pressure(t)))


def uniform_weights(y: np.ndarray, low: float = -1.0, high: float = 1.0) -> np.ndarray:
    """Returns weights of n points for a uniform density, exact for polynomials of degree n - 1.

    y: points (n,) from low to high.
    """
    z = (2.0 * y - low - high) / (high - low)
    moments = np.zeros(y.size)
    moments[0] = high - low
    return np.linalg.solve(legvander(z, y.size - 1).T, moments)


def root_factors(m: int) -> np.ndarray:
    """Returns factors on the weights of m Gauss-Legendre points on 0 to 1 under sqrt(1 - z).

    With them the root times a polynomial of the degree m - 1 is integrated exactly: the factors are
    the root's Legendre series, as far as m terms go, over the root. In x = 2 z - 1 the root is
    sqrt((1 - x)/2), whose coefficients are -2/((2 k - 1)(2 k + 3)).
    """
    x, _ = gauss_legendre(m)
    k = np.arange(m)
    return legval(x, -2.0 / ((2 * k - 1) * (2 * k + 3))) / np.sqrt(0.5 * (1.0 - x))


def gauss_legendre(m: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns Gauss-Legendre points and weights (m,) on -1 to 1."""
    if m <= MOST_BY_NUMPY:
        return np.polynomial.legendre.leggauss(m)
    from scipy.special import roots_legendre  # loads slowly; few rules have so many points

    return roots_legendre(m)


def gauss_halves(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns positions and load shares of Gauss-Legendre points on each half of the major axis.

    There are n points in all, one more if n is odd.
    """
    x, w = gauss_legendre((n + 1) // 2)
    half = 0.5 * (x + 1.0)
    t = np.concatenate([-half[::-1], half])
    w = 0.5 * np.concatenate([w[::-1], w])
    return t, PEAK * pressure(t) * w


def gathered_points(m: int, power: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Returns points and weights of m Gauss-Legendre points on 0 to 1 that gather at 0.

    They are s = 0.1 z + 0.9 z^power of the points z. Friction turns round at s = 0 within a width
    that is not known beforehand (anything from 1e-6 to 1); the integrand is smooth in z at any.
    Where spin across the ellipse makes that width large, the power 2 takes fewer points than 3.
    """
    x, w = gauss_legendre(m)
    z = 0.5 * (x + 1.0)
    slope = SLOPE + power * (1.0 - SLOPE) * z ** (power - 1)
    return SLOPE * z + (1.0 - SLOPE) * z**power, 0.5 * w * slope


def normalised_weights(t: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Returns slightly changed weights of points on 0 to 1 that integrate 1, t and t^2 exactly.

    The load over an ellipse, the integral of 1 - t^2, is then exact, which it must be.

    t, weight: points and weights of a rule (n,).
    """
    powers = np.array([np.ones_like(t), t, t * t])
    missing = 1.0 / np.arange(1.0, 4.0) - powers @ weight
    return weight + weight * (powers.T @ np.linalg.solve(powers * weight @ powers.T, missing))


def chebyshev(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns places across a strip over its half-width, and shares of its load, at n points.

    Gauss-Chebyshev points of the second kind: exact for polynomials of the degree 2 n - 1 under the
    semi-ellipse that Hertz' pressure is across the contact. One point is the line model.
    """
    angle = np.pi * np.arange(1, n + 1) / (n + 1)
    across = np.cos(angle)
    across[n // 2 : n - n // 2] = 0.0  # the middle of an odd number, but for rounding
    return across, 2.0 / (n + 1) * np.sin(angle) ** 2


def area_shares_across(across: np.ndarray, halves: bool) -> np.ndarray:
    """Returns the shares (n,) of a strip's area at its points; their sum is 1.

    across: places of the points over the half-width (n,).
    halves: whether each half of the strip is integrated by itself.
    """
    if not halves or across.size == 1:
        return 0.5 * uniform_weights(across)
    half = 0.5 * uniform_weights(across[across.size // 2 :], 0.0, 1.0)
    return np.concatenate([half[::-1], half])


def chebyshev_halves(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Returns Gauss points on each half of the strip and their shares, for a bend in its middle.

    There are n points in all, one more if n is odd and not 1. They are exact under the semi-ellipse
    on either half: the eigenvalues of the Jacobi matrix of the polynomials orthogonal there (Golub
    and Welsch 1969), found by Stieltjes' procedure.
    """
    if n == 1:
        return chebyshev(1)
    m = (n + 1) // 2
    angle, weight = gauss_legendre(max(MOST_BY_NUMPY, 2 * m))  # integrates the moments exactly
    angle = 0.25 * np.pi * (angle + 1.0)
    y = np.cos(angle)
    weight = weight * np.sin(angle) ** 2
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


@functools.cache
def spread_ellipse(m: int, across: int) -> EllipsePoints:
    """Returns the points of a split rule over the ellipse for the motion in time.

    They are as accurate as the rule with half its points (benchmarks/ellipse.py). Near the
    pure-rolling point there are three for four across; farther off, where friction is smooth, there
    are fewer and fewer. In a segment too short for that, the error concerns little load. From
    `MANY_ACROSS` on, all strips are alike. With fewer than `FEWEST_ACROSS`, the motion of the
    points would disturb the balance that they measure, so there are never fewer. Callers share the
    points and must not write to them.

    m: points in a segment.
    across: points across the ellipse.
    """
    t, weight = gathered_points(m, power=2)
    across = max(across, FEWEST_ACROSS)
    strips = []
    columns = t, PEAK * normalised_weights(t, weight), MIDDLE_WIDTH * weight, root_factors(m)
    for s, w, length, tip in zip(*columns, strict=True):
        near = s < NEAR or across >= MANY_ACROSS
        if near:
            y, share = chebyshev_halves(2 * math.ceil(NEAR_SHARE * across / 2))
        else:
            # fewer with the distance, as measured in benchmarks/ellipse.py
            y, share = chebyshev(round(across * max(FAR_SHARE, 0.55 - 0.5 * s)))
        ones = np.ones(y.size)
        strips.append(
            EllipsePoints(
                split=True,
                s=s * ones,
                weight=w * share,
                y=y,
                moved=float(near) * ones,
                area=length * area_shares_across(y, near),
                tip=tip * ones,
            )
        )
    return EllipsePoints(
        split=True,
        s=np.concatenate([strip.s for strip in strips]),
        weight=np.concatenate([strip.weight for strip in strips]),
        y=np.concatenate([strip.y for strip in strips]),
        moved=np.concatenate([strip.moved for strip in strips]),
        area=np.concatenate([strip.area for strip in strips]),
        tip=np.concatenate([strip.tip for strip in strips]),
    )


def spread_fixed(rule: Rule) -> EllipsePoints:
    """Returns all points over the ellipse of a rule with fixed points, strip after strip.

    Each field is (strips x points across,).
    """
    n = rule.across.size
    density = rule.weight / pressure(rule.t)
    loads = np.outer(density, rule.share)
    areas = np.outer(MIDDLE_WIDTH / PEAK * density * rule.tip, rule.even)
    return EllipsePoints(
        split=False,
        s=rule.t.repeat(n),
        weight=loads.ravel(),
        y=np.tile(rule.across, rule.t.size),
        moved=np.zeros(loads.size),
        area=areas.ravel(),
        tip=np.ones(loads.size),
    )
