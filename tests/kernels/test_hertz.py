"""Hertz point contact against SciPy's integrals, worked examples and closed forms."""

import math

import pytest
from numpy.testing import assert_allclose
from published_bearings import B218
from scipy.special import ellipe, ellipkm1

from bearingwear.kernels.contact.hertz import (
    INNER,
    OUTER,
    angle_slope,
    elliptic_integrals,
    point_contact,
    race_contact,
)
from bearingwear.solvers.bearing.parameters import geometry


def contact_ellipse(A, B, E_star, Q):
    """Returns semi-axes a and b [m], peak pressure [Pa] and approach [m] of a contact."""
    h = point_contact(A, B, E_star, math.nan)
    a, b = h.c_a * Q ** (1 / 3), h.c_b * Q ** (1 / 3)
    return a, b, 1.5 * Q / (math.pi * a * b), (Q / h.K) ** (2 / 3)


@pytest.mark.parametrize("kappa", [0.3, 1.0, 1.0 + 1e-9, 1.01, 2.0, 6.5, 30.0, 1e3, 1e6])
def test_elliptic_integrals_agree_with_scipy(kappa):
    k1 = 1.0 / kappa
    K, E, s = elliptic_integrals(k1)
    m = 1.0 - k1 * k1
    # Rounding: both are good to a few units of the last place.
    assert_allclose([K, E], [ellipkm1(k1 * k1), ellipe(m)], rtol=4e-15)
    if abs(m) > 1e-3:  # elsewhere SciPy's difference cancels
        assert_allclose(s, (1.0 - E / K) / m, rtol=1e-11)


def test_a_ball_on_an_inner_race_agrees_with_a_published_example():
    """amesweb HertzianContact example; recomputed exactly, to its five digits."""
    R, E_star = 4.90e-3, 210e9 / (2 * (1 - 0.29**2))
    A, B = 0.5 * (1 / R - 1 / 5e-3), 0.5 * (1 / R + 1 / 25e-3)
    assert_allclose(
        contact_ellipse(A, B, E_star, 1500.0),
        [2.0929e-3, 0.15585e-3, 2195.7e6, 11.904e-6],
        rtol=3e-5,
    )


def test_the_inner_race_of_a_6206_agrees_with_a_published_example():
    """Public worked example of bearing 6206; recomputed exactly, to its five digits."""
    R, E_star = 0.5 * 9.525e-3, 210e9 / (2 * (1 - 0.3**2))
    A, B = 0.5 * (1 / R - 1 / 4.89e-3), 0.5 * (1 / R + 1 / 18.2375e-3)
    a, b, p, _ = contact_ellipse(A, B, E_star, 555.6)
    assert_allclose([a, b, p], [1.3409e-3, 0.11331e-3, 1745.9e6], rtol=5e-5)


def test_a_sphere_on_a_flat_has_a_closed_form():
    """Closed form: K = (4/3) E* sqrt(R), a = b = (3 R / 4 E*)^(1/3) Q^(1/3)."""
    R, E_star = 1e-3, 208e9 / (2 * (1 - 0.3**2))
    h = point_contact(0.5 / R, 0.5 / R, E_star, math.nan)
    assert_allclose(h.K, 4 / 3 * E_star * math.sqrt(R), rtol=1e-14)
    assert_allclose([h.c_a, h.c_b], (0.75 * R / E_star) ** (1 / 3), rtol=1e-14)
    assert_allclose([h.K, h.c_a], [4.8187e9, 1.87222e-5], rtol=1e-5)  # published digits


def test_ellipses_satisfy_hertz_equations():
    """Johnson (4.26): both curvatures follow from the ellipse, by SciPy's integrals."""
    for ratio in (1.5, 10.0, 200.0, 1e4):
        A, E_star, Q = 37.0, 1.1e11, 3.0
        a, b, p, d = contact_ellipse(A, A * ratio, E_star, Q)
        m = 1.0 - (b / a) ** 2
        K, E = ellipkm1((b / a) ** 2), ellipe(m)
        assert_allclose(p / E_star * b / (m * a**2) * (K - E), A, rtol=1e-9)
        assert_allclose(p / E_star * b / (m * a**2) * ((a / b) ** 2 * E - K), A * ratio, rtol=1e-12)
        assert_allclose(d, p / E_star * b * K, rtol=1e-13)


def test_the_ellipticity_does_not_depend_on_the_start_of_newton():
    """NaN is no start; 0, 1 and 5 for ln(kappa) lead to the same contact, to rounding."""
    cold = race_contact(B218, -1.0, B218.D0, 0.8, math.nan)
    for start in (0.0, 1.0, 5.0):
        assert_allclose(race_contact(B218, -1.0, B218.D0, 0.8, start), cold, rtol=1e-13)


@pytest.mark.parametrize("side", [INNER, OUTER])
@pytest.mark.parametrize("alpha", [0.05, 0.35, 1.2])
def test_the_slope_of_the_stiffness_by_the_contact_angle_agrees_with_differences(
    scene, side, alpha
):
    """It is that of ln K; differences of 1e-5 rad have an error of 1e-10 and rounding of 1e-11."""
    g = geometry(scene("gyro_s1"))
    K = [race_contact(g, side, g.D0, math.cos(alpha + e), math.nan).K for e in (-1e-5, 1e-5)]
    hertz = race_contact(g, side, g.D0, math.cos(alpha), math.nan)
    computed = angle_slope(g, side, g.D0, math.sin(alpha), math.cos(alpha), hertz)
    assert_allclose(computed, math.log(K[1] / K[0]) / 2e-5, rtol=1e-6)
