"""Slip over the whole ellipse: points across the strips, sums, slopes and closed forms."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import brentq
from scipy.special import ellipe
from support import by_differences, in_python

from bearingwear.kernels.contact.friction import potential
from bearingwear.kernels.contact.points import (
    EDGE,
    Points,
    most_points,
    place_across,
    quadrature_points,
)
from bearingwear.kernels.contact.slip import dissipation, half_width, slip_velocity, surface_height
from bearingwear.kernels.contact.traction import (
    ellipse_slopes,
    ellipse_sums,
    quick_strip_sums,
    strip_slopes,
    strip_sums,
    traction,
)
from bearingwear.kernels.params import Contact
from bearingwear.solvers.bearing.parameters import ellipse_rule
from bearingwear.solvers.bearing.quadrature import chebyshev, chebyshev_halves, gauss_halves

dissipation, traction, strip_slopes = map(in_python, (dissipation, traction, strip_slopes))
half_width, slip_velocity, strip_sums = map(in_python, (half_width, slip_velocity, strip_sums))
surface_height = in_python(surface_height)

R, MU, V_R = 1e-3, 0.07, 2e-3
CONTACT = Contact(-1.0, 2.0, 6e-5, 2e-5, 0.35, math.sqrt(1.0 - 0.35**2), 1.08e-3, 3000.0, MU)
# Slip coefficients of sticking, of rolling, of spin with gyroscopic slip, of gross slip, and their
# steps in differences.
SLIPS = [(2.0, 1e-4, 0.3, 20.0), (9.0, -6.001, 6000.0, 10.0), (20.0, 0.02, 5.0, 4e3)]
SLIPS += [(3e3, 0.2, -5.0, 40.0)]
STEPS = (2e-4, 2e-7, 2e-4, 4e-3)
SCALE = np.array([R, 1.0, R, CONTACT.a, 1.0])  # levers of the generalised forces


def points_of(rule, c, contact=CONTACT, v_r=V_R):
    """Returns the points of a rule on a contact, and their weights, as the sums take them."""
    n, m = most_points(rule), rule.across.size
    t, weight = quadrature_points(rule, contact, R, c, v_r, *np.empty((2, n)))
    across, share = np.empty((2, m))
    place_across(rule, contact, R, c, across, share, False)
    h, width = np.empty(t.size), np.zeros(t.size)
    surface_height(contact, R, t, h)
    half_width(contact, t, width)
    return Points(t=t, weight=weight, h=h, width=width, across=across, share=share)


def test_places_across_have_the_same_bits_wherever_they_lie_in_memory():
    """Two arrays lie n to 199 numbers apart in memory; their order of summation is the same."""
    rule, c = ellipse_rule("split", 5, 8), (3.0, 0.02, 5.0, 4e5)
    n, memory, results = rule.across.size, np.zeros(512), set()
    for distance in range(n, 200):
        across, share = memory[:n], memory[distance : distance + n]
        place_across(rule, CONTACT, R, c, across, share, False)
        results.add(across.tobytes() + share.tobytes())
    assert len(results) == 1


def sums(c, points):
    """Returns potential, gradient and Hessian of the friction of CONTACT over some points.

    Checks that sums of four and of five forces, and QV, agree with them.
    """
    gradient, hessian = np.empty(5), np.empty((5, 5))
    ellipse_slopes(CONTACT, c, MU, V_R, points, gradient, hessian)
    four = np.empty(4), np.empty((4, 4))
    ellipse_slopes(CONTACT, c, MU, V_R, points, *four)
    assert (four[0] == gradient[:4]).all() and (four[1] == hessian[:4, :4]).all()
    *forces, qv = ellipse_sums(CONTACT, c, MU, V_R, points)
    assert_allclose(forces, gradient, rtol=1e-12, atol=1e-14 * np.abs(gradient / SCALE).max())
    t, weight, h, width, across, share = points
    y = np.outer(width, across)
    v_2 = (c[0] * h[:, None] - c[3] * y) ** 2
    v_2 += (c[1] + c[2] * h + c[3] * CONTACT.a * t)[:, None] ** 2
    load = MU * CONTACT.Q * np.outer(weight, share)
    phi = sum(potential(p, v, V_R * V_R) for p, v in zip(load.flat, v_2.flat, strict=True))
    assert_allclose(qv, (load * np.sqrt(v_2)).sum() / MU, rtol=1e-12)
    return phi, gradient, hessian


def differences(c, points, result):
    """Returns central differences of one result of `sums` by the four slip coefficients."""
    return by_differences(lambda moved: sums(moved, points)[result], c, STEPS)


@pytest.mark.parametrize("rule", [ellipse_rule("gauss", 16, 5), ellipse_rule("split", 24, 8)])
@pytest.mark.parametrize("c", SLIPS)
def test_gradient_and_hessian_of_the_potential_agree_with_differences(c, rule):
    """Points are held. The differences err by 1e-5 (rounding of the potential) and by 1e-6."""
    points = points_of(rule, c)
    _, gradient, hessian = sums(c, points)
    size = np.abs(gradient / SCALE).max()
    by_c = differences(c, points, 0) / SCALE[:4]
    assert_allclose(by_c, (gradient / SCALE)[:4], atol=1e-5 * size)
    scale = SCALE[:, None] * SCALE
    computed, hessian = differences(c, points, 1) / scale[:4], hessian / scale
    assert np.abs(computed - hessian[:4]).max() <= 1e-6 * np.abs(hessian).max()
    assert_allclose(hessian, hessian.T, rtol=0, atol=0)
    assert np.linalg.eigvalsh(hessian[:4, :4]).min() > 0.0  # convex
    assert np.linalg.eigvalsh(hessian).min() > -1e-12 * np.abs(hessian).max()


@pytest.mark.parametrize("c", SLIPS)
def test_one_point_across_the_ellipse_gives_the_sums_along_a_line(c):
    """A point in the middle of each strip, without width, is the line of the strips.

    Sums, gradient, Hessian and QV agree to rounding. The fifth force is the first over the mean
    height, to 2e-3.
    """
    t, weight = gauss_halves(30)
    h = np.empty(t.size)
    surface_height(CONTACT, R, t, h)
    points = Points(t, weight, h, np.zeros(t.size), np.zeros(1), np.ones(1))
    *computed, rolling_force, qv = ellipse_sums(CONTACT, c, MU, V_R, points)
    assert_allclose(rolling_force, computed[0] / h.mean(), rtol=2e-3)
    *line, line_qv = quick_strip_sums(CONTACT, c, MU, V_R, t, weight, h)
    gradient, hessian = np.empty((2, 4)), np.empty((2, 4, 4))
    traction(CONTACT, c, MU, V_R, points, gradient[0])
    assert_allclose(computed, line, rtol=1e-12)
    assert_allclose(gradient[0], line, rtol=1e-12)
    assert_allclose(qv, line_qv, rtol=1e-13)
    ellipse_slopes(CONTACT, c, MU, V_R, points, gradient[0], hessian[0])
    strip_slopes(CONTACT, c, MU, V_R, t, weight, h, gradient[1], hessian[1])
    assert_allclose(hessian[0], hessian[1], rtol=1e-11, atol=1e-13 * np.abs(hessian[1]).max())


@pytest.mark.parametrize("rule", [ellipse_rule("gauss", 16, 5), ellipse_rule("split", 24, 8)])
@pytest.mark.parametrize("c", SLIPS)
def test_an_opposite_gyroscopic_slip_gives_the_mirrored_friction(c, rule):
    """Its force changes sign, and nothing else changes."""
    mirrored = (-c[0], *c[1:])
    *forces, qv = ellipse_sums(CONTACT, c, MU, V_R, points_of(rule, c))
    *mirrored_forces, mirrored_qv = ellipse_sums(
        CONTACT, mirrored, MU, V_R, points_of(rule, mirrored)
    )
    expected = np.array(mirrored_forces) * [-1.0, 1.0, 1.0, 1.0, -1.0]
    assert_allclose([*expected, mirrored_qv], [*forces, qv], rtol=1e-11, atol=1e-18)


@pytest.mark.parametrize("make", [chebyshev, chebyshev_halves])
@pytest.mark.parametrize("n", [1, 2, 4, 7, 12])
def test_points_across_integrate_a_semi_ellipse(make, n):
    """The weights sum to 1, the mean of y^2 is 1/4, and places are symmetric.

    Only the rule of two halves has the mean of |y|, 4/(3 pi), exactly.
    """
    across, share = make(n)
    assert_allclose(share.sum(), 1.0, rtol=1e-13)
    assert_allclose(across, -across[::-1], atol=1e-16)
    assert np.abs(across).max() < 1.0
    if n > 3:
        assert_allclose((share * across**2).sum(), 0.25, rtol=1e-12)
    if n > 1 and make is chebyshev_halves:
        assert_allclose((share * np.abs(across)).sum(), 4.0 / (3.0 * np.pi), rtol=1e-12)


@pytest.mark.parametrize(
    "c, turning_point",
    [
        pytest.param((0.0, 0.0, 0.0, 1e3), 0.0, id="spin alone"),
        pytest.param((5.0, 0.0, 0.0, 1e3), 5.0 * R / (1e3 * CONTACT.b), id="spin and gyroscopic"),
        pytest.param((-500.0, 0.0, 0.0, 1e3), -500.0 * R / (1e3 * CONTACT.b), id="beyond the edge"),
        pytest.param((500.0, 0.0, 0.0, 0.0), math.inf, id="gyroscopic alone"),
    ],
)
def test_points_across_follow_where_the_slip_turns_round(c, turning_point):
    """Their middle is moved there, but no further from the middle of the ellipse than EDGE."""
    rule = ellipse_rule("split", 24, 8)
    *_, across, share = points_of(rule, c)
    assert_allclose(share.sum(), 1.0, rtol=1e-13)
    assert np.abs(across).max() < 1.0
    shift = np.clip(turning_point, -EDGE, EDGE)
    unshifted = (across - shift) / (1.0 - shift * across)  # inverse Moebius map of place_across
    # map and inverse agree to rounding: places are below 1, and |shift| is at most 1/2
    assert_allclose(unshifted, rule.across, atol=1e-14)


def test_points_across_a_contact_without_slip_lie_within_it():
    *_, across, share = points_of(ellipse_rule("split", 24, 8), (0.0, 0.0, 0.0, 0.0))
    assert_allclose(share.sum(), 1.0, rtol=1e-13)
    assert np.abs(across).max() < 1.0


SPIN_RATE = 1e3  # [rad/s]
SPIN = (0.0, 0.0, 0.0, SPIN_RATE)
COULOMB = 1e-9  # [m/s], a regularisation that leaves Coulomb's law


@pytest.mark.parametrize("kappa", [1.0, 1.5, 3.07, 6.0, 20.0])
def test_torque_and_qv_of_pure_spin_on_an_ellipse_have_a_closed_form(kappa):
    """The torque is (3/8) mu Q a E(m): Poritsky, Hewlett and Coleman (1947)."""
    contact = CONTACT._replace(b=CONTACT.a / kappa)
    points = points_of(ellipse_rule("split", 200, 64), SPIN, contact, COULOMB)
    *_, torque, _, qv = ellipse_sums(contact, SPIN, MU, COULOMB, points)
    exact = 3 / 8 * contact.Q * contact.a * ellipe(1.0 - kappa**-2)
    assert_allclose(torque, MU * exact, rtol=1e-6)
    assert_allclose(qv, SPIN_RATE * exact, rtol=1e-6)


def test_the_torque_of_pure_spin_on_a_line_has_a_closed_form():
    """It is (3/8) mu Q a, as of a very long ellipse."""
    rule = ellipse_rule("split", 200, 64)
    buffers = np.empty((2, most_points(rule)))
    t, weight = quadrature_points(rule, CONTACT, R, SPIN, COULOMB, *buffers)
    h = np.empty(t.size)
    surface_height(CONTACT, R, t, h)
    _, _, _, torque, _ = quick_strip_sums(CONTACT, SPIN, MU, COULOMB, t, weight, h)
    assert_allclose(torque, 3 / 8 * MU * CONTACT.Q * CONTACT.a, rtol=1e-9)


@pytest.mark.parametrize(
    ("rule", "error"),
    [(ellipse_rule("split", 20, 8), 1e-3), (ellipse_rule("gauss", 200, 8), 2.8e-4)],
    ids=["default points", "fixed points"],
)
def test_few_points_give_the_torque_of_pure_spin(rule, error):
    """The ellipticity is that of gyro_s1's outer contact; fixed points err by 2.5e-4."""
    kappa = 3.07
    contact = CONTACT._replace(b=CONTACT.a / kappa)
    exact = 3 / 8 * MU * contact.Q * contact.a * ellipe(1.0 - kappa**-2)
    *_, torque, _, _ = ellipse_sums(contact, SPIN, MU, COULOMB, points_of(rule, SPIN, contact))
    assert_allclose(torque, exact, rtol=error)


def test_heathcote_slip_agrees_with_johnson():
    """There is no spin and no gyroscopic slip: Contact Mechanics, 8.5 (line, close conformity).

    Without a net force there is no slip at 0.34730 a, and the moment is 0.08057 mu Q a^2/R.
    """
    contact = CONTACT._replace(r_g=R * (1.0 + 1e-9), a=0.02 * R)
    rule, v_r, c_h = ellipse_rule("split", 200), 1e-12, 1.0
    gradient = np.empty(4)

    def net_force(c_0):
        c = (0.0, c_0, c_h, 0.0)
        t, weight = quadrature_points(rule, contact, R, c, v_r, *np.empty((2, most_points(rule))))
        h = np.empty(t.size)
        surface_height(contact, R, t, h)
        gradient[:] = strip_sums(contact, c, MU, v_r, t, weight, h)[:4]
        return gradient[1]

    ends = np.empty(2)
    surface_height(contact, R, np.array([0.0, 1.0]), ends)
    c_0 = brentq(net_force, -c_h * ends[0], -c_h * ends[1], xtol=1e-18, rtol=1e-15)
    zero = brentq(lambda t: slip_at(contact, (0.0, c_0, c_h, 0.0), t), 0.0, 1.0)
    assert_allclose(zero, 0.34730, rtol=1e-3)
    moment = gradient[2] - ends[0] * gradient[1]
    assert_allclose(abs(moment), 0.08057 * MU * contact.Q * contact.a**2 / R, rtol=1e-3)


def slip_at(contact, c, t):
    """Returns the slip along the rolling direction at a place t = x/a [m/s]."""
    h, v1, v2 = np.empty((3, 1))
    places = np.array([t])
    surface_height(contact, R, places, h)
    slip_velocity(contact, c, places, h, v1, v2)
    return v2[0]


@pytest.mark.parametrize("c", SLIPS)
def test_share_of_gyroscopic_slip_counts_no_spin(c):
    """It is |c_1 h| over |v|; heat and torque are those of the generalised friction."""
    points, r = points_of(ellipse_rule("split", 24, 8), c), 3.5e-3
    qv, heat, share, torque = dissipation(CONTACT, c, MU, V_R, r, points)
    *g, _, total = ellipse_sums(CONTACT, c, MU, V_R, points)
    assert_allclose(qv, total, rtol=1e-12)
    assert_allclose(heat, np.dot(c, g), rtol=1e-10)
    on_ball = r * g[1] + CONTACT.sigma * CONTACT.cos_a * g[2] - CONTACT.sin_a * g[3]
    assert_allclose(torque, -on_ball, rtol=1e-9)
    _, weight, h, *_ = points
    assert_allclose(share * qv, CONTACT.Q * (weight * np.abs(c[0] * h)).sum(), rtol=1e-10)
