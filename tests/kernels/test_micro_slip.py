"""Micro-slip of a contact against Kalker's linear theory, Coulomb's law, and the power put in."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.kernels.ellipse import Rule
from bearingwear.kernels.micro_slip import Flexibility, micro_slip
from bearingwear.kernels.params import Contact
from bearingwear.kernels.profile import height, profile
from bearingwear.kernels.traction import traction
from bearingwear.model.quadrature import chebyshev, gauss_halves

A, B, R, Q, V = 1.0e-4, 3.0e-5, 1.0e-3, 2.3, 5.5
CONTACT = Contact(
    sigma=1.0, Q=Q, a=A, b=B, sin_a=0.34, cos_a=0.94, r_g=1.17e-3, omega=0.0, mu=0.08
)  # fmt: skip
G, C11, C22, C23 = 8.0e10, 3.44, 2.75, 0.715
BED = Flexibility(
    rolling=8.0 * B / (3.0 * G * C11),
    lateral=8.0 * B / (3.0 * G * C22),
    spin=math.pi * B * math.sqrt(B / A) / (4.0 * G * C23),
)
MIDDLE = height(profile(CONTACT.r_g, R, A), 0.0)
NEVER = 1e12  # a friction coefficient that is not reached


def solved(c, mu=0.08, speed=V, bed=BED, size=(100, 50)):
    return micro_slip(CONTACT, R, c, mu, speed, bed, *size)


def softer(factor):
    return Flexibility(*(factor * each for each in BED))


@pytest.mark.parametrize("speed", [V, -V])
def test_small_creep_gives_the_linear_theory(speed):
    creep = 1e-4
    along = solved((0.0, creep * V, 0.0, 0.0), NEVER, speed)
    assert_allclose(along.g_0, G * A * B * C11 * creep, rtol=1e-3)
    across = solved((creep * V / MIDDLE, 0.0, 0.0, 0.0), NEVER, speed)
    assert_allclose(across.g_1 / MIDDLE, G * A * B * C22 * creep, rtol=5e-3)  # h varies a little
    spin = solved((0.0, 0.0, 0.0, creep * V / A), NEVER, speed)
    force = math.copysign(G * (A * B) ** 1.5 * C23 * creep / A, speed)
    assert_allclose(spin.g_1 / MIDDLE, force, rtol=5e-3)
    assert along.stuck == pytest.approx(1.0)


def test_linear_theory_is_converged_to():
    errors = [
        abs(
            solved((0.0, 1e-4 * V, 0.0, 0.0), NEVER, size=(n, n)).g_0 / (G * A * B * C11 * 1e-4)
            - 1.0
        )
        for n in (10, 20, 40)
    ]
    assert errors[0] > 3.0 * errors[1] > 9.0 * errors[2]


def test_force_saturates():
    """It rises with the creep to mu Q, and sticks less."""
    creeps = np.logspace(-5, -1, 20)
    sums = [solved((0.0, creep * V, 0.0, 0.0)) for creep in creeps]
    force, stuck = (np.array([getattr(s, name) for s in sums]) for name in ("g_0", "stuck"))
    assert (np.diff(force) > -1e-12).all() and (np.diff(stuck) <= 0.0).all()
    assert_allclose(force[-1], 0.08 * Q, rtol=1e-3)
    assert force.max() <= 0.08 * Q * (1.0 + 1e-12)
    # all strips stick up to the same share of their length, where k (1 + e) = sqrt(1 - e^2)
    k = creeps * B / BED.rolling / (0.08 * 1.5 * Q / (math.pi * A * B))
    e = (1.0 - k**2) / (1.0 + k**2)
    slides = 0.25 * math.pi - 0.5 * (e * np.sqrt(1.0 - e**2) + np.arcsin(e))
    exact = (0.5 * k * (1.0 + e) ** 2 + slides) / (0.5 * math.pi)
    assert_allclose(force / (0.08 * Q), exact, rtol=3e-3)


SLIPS = {
    "spin": (0.0, 0.0, 0.0, 1.0e3),
    "rolling": (0.0, 0.05, 0.0, 0.0),
    "across": (0.02 / MIDDLE, 0.0, 0.0, 3.0e2),
    "all": (0.02 / MIDDLE, 0.03, -5.0, 8.0e2),
}


@pytest.mark.parametrize("c", SLIPS.values(), ids=SLIPS)
def test_stiff_surfaces_slide_as_coulomb_has_it(c):
    """Forces, moments and QV, of all kinds of slip at once: the traction is along the slip."""
    found = solved(c, bed=softer(1e-4), size=(400, 100))
    assert_allclose(found.qv, found.full_qv, rtol=2e-3)
    rule = Rule(False, *gauss_halves(400), *chebyshev(200))
    t, weight = rule.t, rule.weight
    h = np.array([height(profile(CONTACT.r_g, R, A), A * x) for x in t])
    width = B * np.sqrt(1.0 - t**2)
    gradient = np.empty(4)
    traction(
        CONTACT, c, 0.08, 1e-9, t, weight, h, width, rule.across, rule.share, gradient
    )  # fmt: skip
    sums = np.array([found.g_1, found.g_0, found.g_h, found.g_x])
    size = 0.08 * Q * np.array([R, 1.0, R, A])
    assert_allclose(sums / size, gradient / size, atol=3e-3)
    assert found.stuck < 0.01


@pytest.mark.parametrize("c", SLIPS.values(), ids=SLIPS)
def test_qv_is_the_power_of_the_forces(c):
    found = solved(c)
    power = c[0] * found.g_1 + c[1] * found.g_0 + c[2] * found.g_h + c[3] * found.g_x
    assert_allclose(0.08 * found.qv, power, rtol=1e-12)


@pytest.mark.parametrize("name", ["spin", "rolling"])
def test_power_becomes_heat_where_the_surfaces_slide(name):
    """What is put in is lost in sliding: springs give back what they take. By other formulas."""
    c, mu, n, m = SLIPS[name], 0.08, 200, 400
    L = BED.spin if name == "spin" else BED.rolling
    heat = 0.0
    for i in range(n):
        t = (2 * i + 1) / n - 1.0
        x, half = A * t, B * math.sqrt(1.0 - t * t)
        y = half * (2.0 * (np.arange(m) + 0.5) / m - 1.0)
        peak = 1.5 * Q / (math.pi * A * B)
        limit = mu * peak * np.sqrt(np.maximum(1.0 - t * t - (y / B) ** 2, 0.0))
        ds, p = 2.0 * half / m, np.zeros(2)
        for k in range(m):
            v = np.array([c[0] * MIDDLE - c[3] * y[k], c[1] + c[3] * x])
            tried = p + v / (V * L) * ds * (0.5 if k == 0 else 1.0)
            now = tried * min(1.0, limit[k] / max(np.hypot(*tried), 1e-300))
            slip = (tried - now) * V * L / ds
            heat += now @ slip * ds * 2.0 * A / n
            p = now
    assert_allclose(mu * solved(c, size=(200, 100)).qv, heat, rtol=1e-2)


def test_no_slip_no_traction():
    found = solved((0.0, 0.0, 0.0, 0.0))
    assert found.qv == found.full_qv == found.g_0 == found.g_1 == 0.0
    assert found.stuck == pytest.approx(1.0)


def test_finer_cells_give_the_same():
    for c in SLIPS.values():
        coarse, fine = solved(c, size=(200, 60)), solved(c, size=(800, 240))
        assert_allclose(coarse.qv / coarse.full_qv, fine.qv / fine.full_qv, rtol=2e-3)
