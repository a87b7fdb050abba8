"""The rule whose points gather at the pure-rolling points of each contact."""

import dataclasses
import itertools
import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from support import in_python

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.points import FAR, most_points, quadrature_points, rolling_points
from bearingwear.kernels.contact.slip import slip_velocity, surface_height
from bearingwear.kernels.contact.summary import QV
from bearingwear.kernels.contact.traction import quick_strip_sums
from bearingwear.kernels.params import Contact
from bearingwear.solvers.bearing.parameters import ellipse_rule
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.dynamic.system import DynamicSystem

rolling_points, surface_height = in_python(rolling_points), in_python(surface_height)
slip_velocity = in_python(slip_velocity)

R = 1e-3
CONTACT = Contact(-1.0, 2.0, 6e-5, 2e-5, 0.35, math.sqrt(1.0 - 0.35**2), 1.08e-3, 3000.0, 0.1)


def slip_with_roots(first, second, c_1):
    """Returns slip coefficients of CONTACT with v2 = 0 at two points x/a, which may lie outside."""
    h = np.empty(2)
    surface_height(CONTACT, R, np.array([first, second]), h)
    c_h = 6e3
    c_x = -c_h * (h[1] - h[0]) / (CONTACT.a * (second - first))
    return c_1, -c_h * h[0] - c_x * CONTACT.a * first, c_h, c_x


def sums(rule, c, v_r, mu=0.1):
    """Returns the mean slip [m/s] and the generalised forces (4,) over mu Q times R, 1, R and a."""
    t, weight = np.empty((2, most_points(rule)))
    t, weight = quadrature_points(rule, CONTACT, R, c, v_r, t, weight)
    h = np.empty(t.size)
    surface_height(CONTACT, R, t, h)
    g_1, g_0, g_h, g_x, qv = quick_strip_sums(CONTACT, c, mu, v_r, t, weight, h)
    forces = np.array([g_1 / R, g_0, g_h / R, g_x / CONTACT.a]) / (mu * CONTACT.Q)
    return np.array([qv / CONTACT.Q, *forces])


def adaptive_sums(c, v_r):
    """Returns the numbers of `sums` by SciPy, on pieces that shrink towards both rolling points."""
    R_d = 2.0 * CONTACT.r_g * R / (CONTACT.r_g + R)

    def integrands(t):
        """Returns the slip and the terms of the forces at a place t = x/a, over the load."""
        x = CONTACT.a * t
        h = math.sqrt(R_d**2 - x**2) - math.sqrt(R_d**2 - CONTACT.a**2)
        h += math.sqrt(R**2 - CONTACT.a**2)
        v1, v2 = c[0] * h, c[1] + c[2] * h + c[3] * x
        f = 0.75 * (1.0 - t * t) / math.sqrt(v1 * v1 + v2 * v2 + v_r * v_r)
        v = 0.75 * (1.0 - t * t) * math.hypot(v1, v2)
        return v, f * v1 * h / R, f * v2, f * v2 * h / R, f * v2 * t

    near = [p for p in rolling_points(CONTACT, R, c, v_r) if abs(p) < 1.0]
    steps = np.concatenate([[0.0], 10.0 ** np.arange(-8.0, 0.5, 0.5)])
    edges = {-1.0, 1.0, *near}
    edges |= {p + s * step for p in near for s in (-1, 1) for step in steps}
    edges = sorted(e for e in edges if -1.0 <= e <= 1.0)

    def integral(i):
        def integrand(t):
            return integrands(t)[i]

        pieces = itertools.pairwise(edges)
        return sum(quad(integrand, a, b, epsabs=1e-13, epsrel=1e-10)[0] for a, b in pieces)

    return [integral(i) for i in range(5)]


# pure-rolling points x/a: in the contact, far off, close together, at its edge, on both sides of it
ROOTS = [(-0.07, 0.75), (0.001, 8.0), (-0.3, -0.28), (0.97, 1.04), (-0.999, 0.2), (-2.0, 3.0)]


@pytest.mark.parametrize("v_r", [1e-3, 1e-6])
@pytest.mark.parametrize("c_1", [0.0, 0.5, 10.0])
@pytest.mark.parametrize("roots", ROOTS)
def test_sums_over_40_points_agree_with_adaptive_quadrature(roots, c_1, v_r):
    """Without gyroscopic slip c_1, friction reverses within v_r/slope, 1e-5 of a at least.

    With it, slip vanishes nowhere. Mean slip agrees to 3e-7 (measured 1e-7), forces to 5e-5 of mu Q
    (2.6e-5). At the larger v_r, the rule takes rolling points beside the roots, where |v| has its
    kink. Without gyroscopic slip, that costs up to 1.6e-5 of the mean slip.
    """
    c = slip_with_roots(*roots, c_1)
    computed, exact = sums(ellipse_rule("split", 40), c, v_r), adaptive_sums(c, v_r)
    is_kink_missed = c_1 == 0.0 and v_r == 1e-3
    assert_allclose(computed[0], exact[0], rtol=3e-5 if is_kink_missed else 3e-7)
    assert_allclose(computed[1:], exact[1:], atol=5e-5)


@pytest.mark.parametrize("c_1", [0.0, 0.5])
def test_sums_are_continuous_where_two_rolling_points_merge_and_vanish(c_1):
    """Two roots lie 1e-6 apart; a lift of the slip parts or removes them in 41 steps.

    No step changes a sum by 0.05, and 4000 Gauss points have the forces to 3e-4, on both sides.
    """
    c_1, c_0, c_h, c_x = slip_with_roots(0.3, 0.3 + 1e-6, c_1)
    rule, fine_rule = ellipse_rule("split", 40), ellipse_rule("gauss", 4000)
    slips = [(c_1, c_0 - lift, c_h, c_x) for lift in np.linspace(-1e-4, 1e-4, 41)]
    values = np.array([sums(rule, c, 1e-4) for c in slips])
    assert np.abs(np.diff(values, axis=0)).max() < 0.05
    for c, value in zip(slips, values, strict=True):
        assert_allclose(value[1:], sums(fine_rule, c, 1e-4)[1:], atol=3e-4)


def test_sums_hardly_change_where_a_far_rolling_point_is_left_out():
    """The points of the rule jump there: mean slip changes by 1e-6, forces by 1e-4 of mu Q."""
    rule = ellipse_rule("split", 40)
    for c_1 in (0.0, 0.5):  # a root inside the ellipse, the other on either side of FAR
        inside = sums(rule, slip_with_roots(0.02, FAR - 1e-9, c_1), 1e-3)
        outside = sums(rule, slip_with_roots(0.02, FAR + 1e-9, c_1), 1e-3)
        assert_allclose(inside[0], outside[0], rtol=1e-6)
        assert_allclose(inside, outside, atol=1e-4)


@pytest.mark.parametrize("roots", ROOTS)
def test_rolling_points_are_roots_of_the_slip(roots):
    """Without gyroscopic slip, and as v_r tends to 0, v2 vanishes there to rounding."""
    c = slip_with_roots(*roots, 0.0)
    computed = np.sort(rolling_points(CONTACT, R, c, 1e-13))
    h, v1, v2 = np.empty((3, 2))
    surface_height(CONTACT, R, computed, h)
    slip_velocity(CONTACT, c, computed, h, v1, v2)
    assert_allclose(v2, 0.0, atol=1e-12)
    assert_allclose(computed, roots, rtol=1e-6)


def test_degenerate_slip_gives_finite_points():
    """Slip is zero, of spin alone, equal everywhere or gyroscopic; the weights add up to 1."""
    rule = ellipse_rule("split", 40)
    for c in (
        (0.0, 0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0, 1e3),
        (0.0, 1.0, 0.0, 0.0),
        (5.0, 0.0, 0.0, 0.0),
    ):
        for v_r in (0.0, 1e-9, 1e-3):
            t, weight = quadrature_points(
                rule, CONTACT, R, c, v_r, *np.empty((2, most_points(rule)))
            )
            assert np.abs(t).max() <= 1.0
            assert_allclose(weight.sum(), 1.0, rtol=1e-13)


@pytest.mark.parametrize("loss", [0.0, 0.7])
@pytest.mark.parametrize("mu", [0.02, 0.11])
@pytest.mark.parametrize("v_r", [1e-3, 1e-6])
def test_forty_points_give_qv_of_a_steady_state_to_3e_5(scene, mu, loss, v_r):
    """2000 Gauss points differ by 1.4e-5 at most; Newton's method takes 5 steps more at most."""
    changes = {
        "operation.preload_method": "fixed_position",
        "friction.ball_race": mu,
        "friction.slip_regularisation_m_s": v_r,
    }
    problem = ThrustProblem.of(scene("gyro_s1", changes))
    D = problem.g.D0 - loss * 1e-6
    exact = dataclasses.replace(problem, rule=ellipse_rule("gauss", 2000)).solve(D)
    split = dataclasses.replace(
        problem, rule=ellipse_rule("split", 40), fine_rule=ellipse_rule("split", 160)
    ).solve(D)
    assert exact.status == split.status == code.OK
    assert_allclose(split.contacts[:, QV], exact.contacts[:, QV], rtol=3e-5)
    assert_allclose(split.u[1], exact.u[1], rtol=1e-4)
    assert split.iterations <= exact.iterations + 5
    assert split.residuals.discretisation_qv < 1e-5


def test_forty_points_give_the_motion_of_four_hundred(scene):
    """After 1 ms, half a turn, from 3 % in spin and 50 rad/s off the steady state."""
    s = scene("gyro_s1")
    u = ThrustProblem.of(s).solve(2e-3).u * [1.03, 1.0, 1.03, 1.0] + [0.0, 50.0, 0.0, 0.0]
    motions = []
    for name, points in (("gauss", 400), ("split", 40)):
        model = dataclasses.replace(s.model, quadrature=name, strips=points)
        motion = DynamicSystem.of(dataclasses.replace(s, model=model), u)
        motion.advance(1e-3, 1e-5)
        motions.append(motion)
    gauss, split = motions
    assert_allclose(split.balls, gauss.balls, atol=1e-5 * np.abs(u).max())
    assert_allclose(split.qv, gauss.qv, rtol=1e-4)
