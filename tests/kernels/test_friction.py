"""The friction law and its sums over a contact: every derivative against differences."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import by_differences

from bearingwear.kernels.contact.friction import force_per_slip, force_slope, potential
from bearingwear.kernels.contact.profile import height, profile
from bearingwear.kernels.contact.slip import point_slip
from bearingwear.kernels.contact.traction import (
    quick_strip_slopes,
    quick_strip_sums,
    strip_slopes,
    strip_sums,
)
from bearingwear.kernels.params import Contact
from bearingwear.solvers.bearing.quadrature import gauss_halves

R, MU, V_R = 1e-3, 0.07, 2e-3
CONTACT = Contact(
    sigma=-1.0,
    Q=2.0,
    a=6e-5,
    b=2e-5,
    sin_a=0.35,
    cos_a=math.sqrt(1.0 - 0.35**2),
    r_g=1.08e-3,
    omega=3000.0,
    mu=MU,
)
# Slip coefficients of sticking, of rolling with two pure-rolling points, of gross slip along each
# axis; steps that change the slip by about 1e-4 v_r.
SLIPS = [(2.0, 1e-4, 0.3, 20.0), (9.0, -6.001, 6000.0, 10.0), (3e3, 0.2, -5.0, 40.0)]
STEPS = (2e-4, 2e-7, 2e-4, 4e-3)

# A central difference of step e is wrong by e^2/6 of the third derivative and by rounding over e:
# with e = 1e-4 of the width v_r of the law's bend, some 1e-8 and 1e-11.
DIFFERENCE = 1e-6


def sums(c):
    """Returns potential, gradient and Hessian of CONTACT at the slip coefficients c.

    Checks that all kernels with these sums agree.
    """
    t, weight = gauss_halves(40)
    p = profile(CONTACT.r_g, R, CONTACT.a)
    x = CONTACT.a * t
    h = np.array([height(p, position) for position in x])
    gradient, hessian = np.empty(4), np.empty((4, 4))
    assert strip_slopes(CONTACT, c, MU, V_R, t, weight, h, gradient, hessian) == 0.0
    *forces, slip_sum = strip_sums(CONTACT, c, MU, V_R, t, weight, h)
    assert slip_sum == 0.0
    assert_allclose(forces, gradient, rtol=1e-13, atol=1e-15 * np.abs(gradient).max())
    *quick_forces, qv = quick_strip_sums(CONTACT, c, MU, V_R, t, weight, h)
    assert_allclose(quick_forces, gradient, rtol=1e-12, atol=1e-15 * np.abs(gradient).max())
    quick, slopes = np.empty(4), np.empty((4, 4))
    quick_qv = quick_strip_slopes(CONTACT, c, MU, V_R, t, weight, h, quick, slopes)
    assert_allclose([*quick, quick_qv], [*quick_forces, qv], rtol=1e-12, atol=1e-15 * qv)
    assert_allclose(slopes, hessian, rtol=1e-12, atol=1e-15 * np.abs(hessian).max())
    phi = 0.0
    for k in range(t.size):
        v1, v2 = point_slip(c, h[k], x[k])
        phi += potential(MU * CONTACT.Q * weight[k], v1 * v1 + v2 * v2, V_R * V_R)
    return phi, gradient, hessian


def differences(c, result):
    """Returns central differences of one result of `sums` by the four slip coefficients."""
    return by_differences(lambda moved: sums(moved)[result], c, STEPS)


@pytest.mark.parametrize("c", SLIPS)
def test_gradient_is_the_slope_of_the_potential(c):
    scale = np.array([R, 1.0, R, CONTACT.a])  # levers of the generalised forces
    _, gradient, _ = sums(c)
    # The potential is up to 1e3 times the change that a step makes: rounding leaves 1e-5 of it.
    assert_allclose(
        differences(c, 0) / scale, gradient / scale, atol=1e-5 * np.abs(gradient / scale).max()
    )


@pytest.mark.parametrize("c", SLIPS)
def test_hessian_is_the_slope_of_the_gradient(c):
    """It is symmetric to the last bit and positive definite, and agrees with differences."""
    scale = np.array([R, 1.0, R, CONTACT.a])
    scale = scale[:, None] * scale
    _, _, hessian = sums(c)
    assert_allclose(hessian, hessian.T, rtol=0, atol=0)
    computed = differences(c, 1) / scale
    assert np.abs(computed - hessian / scale).max() <= DIFFERENCE * np.abs(hessian / scale).max()
    # And each element against its own scale, by Cauchy-Schwarz for a positive definite matrix.
    diagonal = np.sqrt(np.diag(hessian / scale))
    assert_allclose((computed - hessian / scale) / np.outer(diagonal, diagonal), 0.0, atol=1e-4)
    assert np.linalg.eigvalsh(hessian / scale).min() > 0.0


@pytest.mark.parametrize("v1, v2", [(0.0, 0.0), (1e-3, 0.0), (0.0, 5.0), (2e-3, -3e-3), (4.0, 3.0)])
def test_slopes_of_the_friction_law_agree_with_differences(v1, v2):
    """dF1/dv1, dF1/dv2 and dF2/dv2 against central differences of v F/|v|."""
    step = 1e-4 * max(V_R, math.hypot(v1, v2))

    def force(a, b):
        return force_per_slip(0.3, a * a + b * b, V_R * V_R) * np.array([a, b])

    f, p_11, p_12, p_22 = force_slope(0.3, v1, v2, V_R * V_R)
    assert_allclose(f, force_per_slip(0.3, v1 * v1 + v2 * v2, V_R * V_R), rtol=1e-15)
    by_1 = (force(v1 + step, v2) - force(v1 - step, v2)) / (2.0 * step)
    by_2 = (force(v1, v2 + step) - force(v1, v2 - step)) / (2.0 * step)
    # The largest slope is F/|v|; along the slip it is smaller by (v_r/v)^2, below the difference.
    assert_allclose([p_11, p_12, p_12, p_22], [*by_1, *by_2], atol=1e-7 * f)


def test_friction_is_coulombs_for_large_slip():
    slip = np.array([1e-3, 1.0, 1e3])
    force = [force_per_slip(0.3, v * v, V_R * V_R) * v for v in slip]
    assert_allclose(force, 0.3 * slip / np.hypot(slip, V_R), rtol=1e-15)
    assert 0.3 - force[-1] < 1e-11
