"""Hertz' elliptic point contact, exact (theory.md section 1).

Sources: Johnson, *Contact Mechanics* (1985), sections 4.2; Abramowitz & Stegun 17.6 for the
arithmetic-geometric mean. The sums below are arranged so that nothing cancels, from the circle
(kappa = 1) to needles (kappa = 1e6).
"""

import math

from bearingwear.kernels.decorators import inlined, jit
from bearingwear.kernels.params import Hertz

OUTER = 1.0
INNER = -1.0


@jit
def elliptic_integrals(k1):
    """Complete elliptic integrals by the arithmetic-geometric mean.

    Parameters
    ----------
    k1 : float
        Complementary modulus b/a > 0 (above 1 is allowed: the long axis then lies across).

    Returns
    -------
    K, E : float
        Of the first and second kind, parameter m = 1 - k1^2 [1].
    s : float
        (1 - E/K)/m, without the cancellation of that formula; 1/2 for the circle [1].
    """
    m = (1.0 - k1) * (1.0 + k1)
    a, b = 0.5 * (1.0 + k1), math.sqrt(k1)
    q = (1.0 - k1) / (4.0 * (1.0 + k1))  # c_1^2 / m
    s, weight = 0.5 + q, 1.0
    while abs(a - b) > 1e-9 * a:  # converges quadratically: the next term is below rounding
        a, b = 0.5 * (a + b), math.sqrt(a * b)
        q = q * q * m / (16.0 * a * a)
        weight *= 2.0
        s += weight * q
    K = math.pi / (a + b)
    return K, K * (1.0 - m * s), s


@inlined
def ratio_slope(k1, s):
    """Derivative of ln(B/A) by ln(a/b) (theory.md Eq. 3), k1 = b/a."""
    m = (1.0 - k1) * (1.0 + k1)
    if abs(m) < 1e-3:
        ds_dm = 0.0625 + 0.03125 * m
    else:
        S = m * s
        ds_dm = ((1.0 - S) * 0.5 * (1.0 - s) / (1.0 - m) + 0.5 * s - s) / m
    return 2.0 - 2.0 * k1 * k1 * ds_dm / (s * (1.0 - s))


@jit
def log_ellipticity(log_ratio, log_kappa):
    """Solve for ln(a/b), given ln(B/A) of the curvatures; `log_kappa` is the start.

    Newton on ln(B/A) = 2 ln kappa + ln((1-s)/s) (theory.md Eq. 3), which is nearly a straight
    line: two to four steps suffice.

    Returns
    -------
    log_kappa, K, E : float
    """
    K, E, s = elliptic_integrals(math.exp(-log_kappa))
    for _ in range(40):
        slope = ratio_slope(math.exp(-log_kappa), s)
        step = (2.0 * log_kappa + math.log((1.0 - s) / s) - log_ratio) / slope
        log_kappa -= step
        K, E, s = elliptic_integrals(math.exp(-log_kappa))
        if abs(step) < 1e-8:  # quadratic: the error left is below 1e-15
            break
    return log_kappa, K, E


@jit
def point_contact(A, B, E_star, log_kappa):
    """Hertz factors of two bodies whose gap is A x^2 + B y^2.

    Parameters
    ----------
    A, B : float
        Half the sum of the curvatures along the major axis x and along y [1/m].
    E_star : float
        Contact modulus, 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2 [Pa].
    log_kappa : float
        Start for ln(a/b); NaN to start from a fit.
    """
    log_ratio = math.log(B / A)
    if math.isnan(log_kappa):
        log_kappa = 0.636 * log_ratio
    log_kappa, K, E = log_ellipticity(log_ratio, log_kappa)
    kappa = math.exp(log_kappa)
    c_b = (3.0 * E / (2.0 * math.pi * kappa * E_star * (A + B))) ** (1.0 / 3.0)
    flexibility = 3.0 * K / (2.0 * math.pi * kappa * c_b * E_star)  # d = flexibility Q^(2/3)
    return Hertz(flexibility**-1.5, kappa * c_b, c_b, log_kappa, E)


@inlined
def gap_curvatures(g, side, D, cos_alpha):
    """A and B of the gap A x^2 + B y^2 of a ball of diameter D in a groove [1/m].

    theory.md Eq. (1): across the groove 1/R and -1/r_g, along the rolling direction 1/R and
    +2 cos a/(dm - D cos a) (inner) or -2 cos a/(dm + D cos a) (outer).
    """
    r_g = g.r_o if side > 0.0 else g.r_i
    A = 0.5 * (2.0 / D - 1.0 / r_g)
    B = 0.5 * (2.0 / D - side * 2.0 * cos_alpha / (g.dm + side * D * cos_alpha))
    return A, B


@jit
def race_contact(g, side, D, cos_alpha, log_kappa):
    """Hertz factors of a ball of diameter D in a groove, at the operating contact angle."""
    A, B = gap_curvatures(g, side, D, cos_alpha)
    return point_contact(A, B, g.E_star, log_kappa)


@inlined
def curvature_turn(g, side, D, sin_a, cos_a):
    """Derivative of B of `gap_curvatures` by the contact angle [1/m]."""
    return side * g.dm * sin_a / (g.dm + side * D * cos_a) ** 2


@jit
def axes_by_angle(g, side, D, sin_a, cos_a, hertz):
    """Derivatives of ln a and ln b by the contact angle at a held load [1]."""
    A, B = gap_curvatures(g, side, D, cos_a)
    dB, k1 = curvature_turn(g, side, D, sin_a, cos_a), math.exp(-hertz.log_kappa)
    K, E, s = elliptic_integrals(k1)
    longer = dB / (B * ratio_slope(k1, s))  # of ln(a/b)
    # b^3 = 3 E Q/(2 pi kappa E* (A + B)), and dE/dm = -K s/2
    by_b = (-(1.0 + k1 * k1 * K * s / E) * longer - dB / (A + B)) / 3.0
    return by_b + longer, by_b


@jit
def angle_slope(g, side, D, sin_a, cos_a, hertz):
    """Derivative of ln K of `race_contact` by the contact angle [1].

    At a held approach d the energy (2/5) K d^(5/2) of the contact falls by the moment Q b^2/5 of
    its pressure as B grows: d ln K/dB = -(1/2) c_b^2 K^(2/3) (theory.md Eq. 86).
    """
    turn = curvature_turn(g, side, D, sin_a, cos_a)
    return -0.5 * hertz.c_b**2 * hertz.K ** (2.0 / 3.0) * turn
