"""Friction over the ellipse as the motion in time sums it: against the steady sums, and errors."""

import itertools

import numpy as np
import pytest
from kernels.test_ellipse import CONTACT, MU, SCALE, SLIPS, STEPS, V_R, R, points_of
from numpy.testing import assert_allclose
from support import by_differences

from bearingwear.kernels.contact.ellipse_friction import ellipse_friction, places
from bearingwear.kernels.contact.traction import ellipse_slopes, ellipse_sums
from bearingwear.solvers.bearing.parameters import ellipse_rule, line_points
from bearingwear.solvers.bearing.quadrature import (
    gathered_points,
    normalised_weights,
    spread_ellipse,
    spread_fixed,
)

# points of the motion in time: fixed ones, a few that move with the slip, many, and on a line
FIXED = spread_fixed(ellipse_rule("gauss", 40, 5))
SPREAD = spread_ellipse(5, 8)
FINE = spread_ellipse(25, 32)
LINE = line_points(ellipse_rule("split", 40))


def friction(points, c, v_r=V_R, size=5, contact=CONTACT, even=False):
    """Returns five generalised forces and QV (6,) at a slip c, and the Hessian (size, size).

    Checks that they are the same with and without slopes. even: whether the force of a film is
    spread over the area.
    """
    gradient, hessian = np.zeros(size), np.zeros((size, size))
    args = points, contact, R, c, v_r, even
    sums = ellipse_friction(*args, False, places(points), gradient, hessian)
    sums_with_slopes = ellipse_friction(*args, True, places(points), gradient, hessian)
    assert_allclose(sums_with_slopes, sums, rtol=1e-12, atol=1e-15)
    assert_allclose(gradient, sums[:size], rtol=1e-12, atol=1e-15)
    return np.array(sums), hessian


@pytest.mark.parametrize("c", SLIPS)
def test_fixed_points_give_the_sums_of_the_steady_rule(c):
    """Both take the same points, so that sums and slopes agree to rounding."""
    points = points_of(ellipse_rule("gauss", 40, 5), c)
    gradient, hessian = np.empty(5), np.empty((5, 5))
    ellipse_slopes(CONTACT, c, MU, V_R, points, gradient, hessian)
    sums, computed = friction(FIXED, c)
    assert_allclose(sums, ellipse_sums(CONTACT, c, MU, V_R, points), rtol=1e-11, atol=1e-14)
    scale = SCALE[:, None] * SCALE
    size = np.abs(hessian / scale).max()
    assert_allclose(computed / scale, hessian / scale, rtol=1e-10, atol=1e-12 * size)
    four = friction(FIXED, c, size=4)[1]
    assert_allclose(four, computed[:4, :4], rtol=1e-13)


@pytest.mark.parametrize("c", SLIPS)
def test_points_on_a_line_give_the_sums_of_the_steady_rule(c):
    points = points_of(ellipse_rule("split", 40), c)
    expected = ellipse_sums(CONTACT, c, MU, V_R, points)
    assert_allclose(friction(LINE, c)[0], expected, rtol=1e-11, atol=1e-14)


@pytest.mark.parametrize("c", SLIPS)
def test_friction_at_many_points_agrees_with_fixed_points(c):
    """Sums agree with those at many fixed points, and slopes with finite differences."""
    many, hessian = friction(FINE, c)
    right = ellipse_sums(CONTACT, c, MU, V_R, points_of(ellipse_rule("split", 200, 64), c))
    assert_allclose(many[:5] / SCALE, np.array(right[:5]) / SCALE, atol=1e-6 * MU * CONTACT.Q)
    assert_allclose(many[5], right[5], rtol=1e-6)
    scale = SCALE[:, None] * SCALE
    numerical = by_differences(lambda moved: friction(FINE, moved)[0][:5], c, STEPS)
    size = np.abs(hessian / scale).max()
    assert_allclose(numerical / scale[:4], hessian[:4] / scale[:4], atol=2e-4 * size)


# gyroscopic slip [m/s], place x/a of pure rolling and sense of the spin
SPINS = list(itertools.product((0.0, 0.02, -0.2), (-0.9, -0.2, 0.0, 0.5), (1.0, -1.0)))


def spin_slip(gyroscopic, rolling, sign):
    """Returns the slip of a spin of 5e3 rad/s that rolls at x/a, with a gyroscopic slip [m/s]."""
    spin = 5e3 * sign
    return gyroscopic / R, -spin * rolling * CONTACT.a, 0.0, spin


@pytest.mark.parametrize("spin", SPINS)
def test_few_points_give_qv_within_a_thousandth(spin):
    """So do 20 x 8 points of the steady state. Forces in time err by 5e-3 mu Q at most."""
    c = spin_slip(*spin)
    few, many = friction(SPREAD, c, 1e-4)[0], friction(FINE, c, 1e-4)[0]
    steady = ellipse_sums(
        CONTACT, c, MU, 1e-4, points_of(ellipse_rule("split", 20, 8), c, v_r=1e-4)
    )
    assert abs(few[5] / many[5] - 1.0) < 1e-3
    assert abs(steady[5] / many[5] - 1.0) < 1e-3
    assert np.abs((few - many)[:5] / SCALE).max() < 5e-3 * MU * CONTACT.Q


def test_the_weights_of_points_add_up_to_the_load():
    """QV of a gross slip of 3 m/s is load times slip.

    The 1e-9 only place the points. With a little spin they stay, and the sum is exact; with a
    little gyroscopic slip they move as far as they may, and their weights are good to 2e-4.
    """
    assert_allclose(friction(SPREAD, (0.0, 3.0, 0.0, 1e-9))[0][5], 3.0 * CONTACT.Q, rtol=1e-12)
    assert_allclose(friction(SPREAD, (1e-9, 3.0, 0.0, 0.0))[0][5], 3.0 * CONTACT.Q, rtol=2e-4)


def test_normalised_weights_integrate_parabolas_exactly():
    """The integrals of 1, t and t^2 from 0 to 1 are exact. Weights change by 2 % at most."""
    t, weight = gathered_points(4, power=2)
    exact = normalised_weights(t, weight)
    assert_allclose([exact @ t**k for k in range(3)], [1.0, 1 / 2, 1 / 3], rtol=1e-13)
    assert_allclose(exact, weight, rtol=2e-2)
