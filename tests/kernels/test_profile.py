"""Groove, pressure and contact law."""

import math

import numpy as np
from numpy.testing import assert_allclose
from scipy.integrate import quad

from bearingwear.kernels.contact.profile import (
    PEAK,
    contact_approach,
    contact_load,
    contact_stiffness,
    elastic_energy,
    height,
    middle_height,
    pressure,
    pressure_integral,
    profile,
)
from bearingwear.kernels.equilibrium.thrust_loaded import spring


def test_height_is_on_the_arc_through_both_ends_of_the_contact():
    r_g, R, a = 1.08e-3, 1e-3, 6e-5
    p = profile(r_g, R, a)
    assert_allclose(height(p, a), math.sqrt(R * R - a * a), rtol=1e-15)
    assert_allclose(height(p, 0.0), middle_height(p), rtol=1e-15)
    # Curvature in the middle: the mean of ball and groove.
    step = 0.1 * a
    curvature = (2.0 * height(p, 0.0) - height(p, step) - height(p, -step)) / step**2
    assert_allclose(curvature, 0.5 * (1.0 / R + 1.0 / r_g), rtol=1e-4)  # rounding: 1e-16 R/step^2


def test_the_integral_of_the_pressure_is_the_load():
    assert_allclose(PEAK * quad(pressure, -1.0, 1.0)[0], 1.0, rtol=1e-14)
    for t in (-1.0, -0.3, 0.8):
        assert_allclose(pressure_integral(t), quad(pressure, 0.0, t)[0], rtol=1e-13)


def test_stiffness_approach_and_energy_follow_from_the_contact_load():
    """Differences, inversion and quadrature of Q = K d^1.5 give them."""
    K, d = 3.3e9, 7e-7
    Q, step = contact_load(K, d), 1e-5 * d
    slope = (contact_load(K, d + step) - contact_load(K, d - step)) / (2.0 * step)
    assert_allclose(contact_stiffness(Q, d), slope, rtol=1e-9)
    assert_allclose(contact_approach(K, Q), d, rtol=1e-14)
    work = quad(lambda x: contact_load(K, x), 0.0, d, epsabs=0.0)[0]
    assert_allclose(elastic_energy(Q, d), work, rtol=1e-10)


def test_the_tangent_of_a_contact_spring_agrees_with_differences():
    """An open contact has neither force nor stiffness."""
    K, free, X = 3.3e9, 8e-5, np.array([3e-5, 7.5e-5])
    s = spring(K, *X, free)
    assert s.Q > 0.0
    step = 1e-6 * (np.hypot(*X) - free)

    def force(X):
        s = spring(K, *X, free)
        return s.Q * np.array([s.s, s.c])

    by_X = np.array([force(X + e) - force(X - e) for e in step * np.eye(2)]) / (2.0 * step)
    tangent = np.array([[s.k11, s.k12], [s.k12, s.k22]])
    # Rounding of the lengths, 1e-16 of 1e-4 m, over a step of 1e-12 m.
    assert_allclose(by_X, tangent, atol=1e-5 * np.abs(tangent).max())
    # across its line the spring is as stiff as its force over its length
    assert_allclose(np.linalg.eigvalsh(tangent).min(), s.Q / np.hypot(*X), rtol=1e-12)
    slack = spring(K, *X, 1e-4)
    assert (slack.Q, slack.k11, slack.k12, slack.k22) == (0.0, 0.0, 0.0, 0.0)
