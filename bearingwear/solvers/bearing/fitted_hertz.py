"""Hamrock and Brewe's fit of Hertz' factors, for estimates before a solve.

Source: Brewe and Hamrock, *Simplified solution for elliptical-contact deformation between two
elastic solids*, J. Lubr. Technol. 99 (1977) 485. No kernel uses it: the exact solution is as cheap.
"""

import math

from bearingwear.kernels.params import Geometry

INNER_RACE, OUTER_RACE = -1.0, 1.0
_MOST_SECANTS = 100
_CLOSE = 1e-15  # relative step of the angle below which it is found: rounding
FIRST_TILT = 1e-3  # first step of the angle [rad]
STEEPEST = 0.5 * math.pi - 1e-3  # largest angle, just below that of a pure thrust bearing [rad]


def fitted_contact(A: float, B: float, E_star: float) -> tuple[float, float, float]:
    """Returns K [N/m^1.5], c_a and c_b [m/N^(1/3)] of a point contact, like `hertz.point_contact`.

    The numbers are those of Brewe and Hamrock's fit (1977).

    A, B: half the sum of the curvatures along the major axis and along rolling, B >= A [1/m].
    E_star: contact modulus [Pa].
    """
    ratio = B / A
    kappa = 1.0339 * ratio**0.636
    E = 1.0003 + 0.5968 / ratio
    K = 1.5277 + 0.6023 * math.log(ratio)
    c_b = (3.0 * E / (2.0 * math.pi * kappa * E_star * (A + B))) ** (1.0 / 3.0)
    flexibility = 3.0 * K / (2.0 * math.pi * kappa * c_b * E_star)
    return flexibility**-1.5, kappa * c_b, c_b


def fitted_factors(g: Geometry, race: float, D: float, cos_alpha: float) -> tuple[float, ...]:
    """Returns K [N/m^1.5], c_a and c_b [m/N^(1/3)] of a contact with a race, by the fit.

    race: `INNER_RACE` or `OUTER_RACE`.
    D, cos_alpha: ball diameter [m], and cosine of the contact angle.
    """
    A, B = curvatures(g, race, D, cos_alpha)
    return fitted_contact(A, B, g.E_star)


def curvatures(g: Geometry, race: float, D: float, cos_alpha: float) -> tuple[float, float]:
    """Returns half the sums of the curvatures: A along the major axis, B along rolling [1/m].

    race: `INNER_RACE` or `OUTER_RACE`.
    D, cos_alpha: ball diameter [m], and cosine of the contact angle.
    """
    r_g = g.r_o if race > 0.0 else g.r_i
    B = 0.5 * (2.0 / D - race * 2.0 * cos_alpha / (g.dm + race * D * cos_alpha))
    return 0.5 * (2.0 / D - 1.0 / r_g), B


def fitted_preload(g: Geometry, A1: float) -> float:
    """Returns the thrust of the unworn bearing at rest [N].

    Both contacts of a ball then lie on one line, so their deformations add up.

    A1: axial distance of the groove centres [m].
    """
    A2 = g.BD * math.cos(g.alpha0)
    length = math.hypot(A1, A2)
    d = max(length - (g.r_i + g.r_o - g.D0), 0.0)
    cosine = min(max(A2 / length, 0.0), 1.0)
    K_i, _, _ = fitted_factors(g, INNER_RACE, g.D0, cosine)
    K_o, _, _ = fitted_factors(g, OUTER_RACE, g.D0, cosine)
    Q = sum(K ** (-2.0 / 3.0) for K in (K_i, K_o)) ** -1.5 * d**1.5
    return g.n_balls * Q * A1 / length


def fitted_displacement(g: Geometry, F_x: float) -> float:
    """Returns the axial displacement of the unworn bearing at rest under its preload alone [m].

    The contact angle is found by secants, and by halves where one leaves its bracket: to rounding,
    or as far as `_MOST_SECANTS` steps lead. Below the free angle the bearing has no thrust.

    F_x: preload [N].
    """
    radial = g.BD * math.cos(g.alpha0)

    def excess(alpha: float) -> float:
        """Returns the thrust at a contact angle beyond the preload, both to the power 2/3."""
        # the power 2/3 of the thrust rises about linearly with the angle, which suits secants
        return fitted_preload(g, radial * math.tan(alpha)) ** (2.0 / 3.0) - F_x ** (2.0 / 3.0)

    low, high = g.alpha0, STEEPEST
    last = g.alpha0
    alpha = g.alpha0 + FIRST_TILT
    last_value = excess(last)
    for _ in range(_MOST_SECANTS):
        value = excess(alpha)
        if value < 0.0:
            low = alpha
        else:
            high = alpha
        secant = math.nan
        if value != last_value:
            secant = alpha - value * (alpha - last) / (value - last_value)
        last, last_value = alpha, value
        alpha = secant if low < secant < high else 0.5 * (low + high)
        if abs(alpha - last) <= _CLOSE * alpha:
            break
    return radial * math.tan(alpha) - g.BD * math.sin(g.alpha0)
