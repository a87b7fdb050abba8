"""The contact of a ball and a worn groove: its limits, another program, and its own check."""

import math

import numpy as np
import pytest

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.hertz import elliptic_integrals, point_contact
from bearingwear.kernels.worn.cells import contact_buffers
from bearingwear.kernels.worn.pressure import FULL_WIDTH, contact_cells, worn_pressure
from bearingwear.kernels.worn.verification import check_influence, contact_check

KAPPA = 3.07  # a/b of gyro_s1's outer contact
# depth beyond that of the reference, over the approach, at places X = x/a
PROFILES = {
    "flat": lambda X: 0.3 * np.exp(-(X**2)) - 0.2,
    "skew": lambda X: 0.25 * np.exp(-((X - 0.4) ** 2) / 0.5) - 0.1,
    "two": lambda X: (
        0.3 * np.exp(-(((X - 0.5) / 0.4) ** 2)) + 0.2 * np.exp(-(((X + 0.6) / 0.3) ** 2)) - 0.15
    ),
}
# Load over Hertz's at the same approach, and place of its centre, by tamaas 2.9.0 (PolonskyKeerRey
# with the non-periodic operator) on 256 x 128 cells: python benchmarks/worn_contact.py --judge
TAMAAS = {"flat": (0.973452, 0.0), "skew": (0.949442, -0.104369), "two": (1.011956, -0.041717)}


@pytest.fixture(scope="module")
def cells():
    """Returns cells of a contact with the ellipticity of gyro_s1's outer race."""
    status, cells = contact_cells(math.log(KAPPA), -1.9, 1.9, FULL_WIDTH, 48, 10)
    assert status == code.OK
    return cells


def solved_pressure(cells, wear, start=None):
    """Returns the pressure (m, n) over a wear profile (n,).

    start: pressure to start from, by default that of the unworn contact. It is changed.
    """
    pressure = cells.fresh.copy() if start is None else start
    m, n = pressure.shape
    status, _ = worn_pressure(cells, wear, contact_buffers(n, m), pressure)
    assert status == code.OK
    return pressure


def test_unworn_cells_have_the_pressure_of_hertz(cells):
    X, Y = np.meshgrid(cells.X, cells.Y)
    hertz = np.sqrt(np.maximum(1.0 - X**2 - Y**2, 0.0))
    assert cells.fresh.sum() * cells.area == pytest.approx(2.0 / 3.0 * math.pi, rel=1e-3)
    inside = X**2 + Y**2 < 0.7  # cells at the edge lie partly outside
    assert np.abs(cells.fresh - hertz)[inside].max() < 0.03


def test_no_wear_gives_the_unworn_pressure_from_any_start(cells):
    nothing = np.zeros(cells.X.size)
    cold = solved_pressure(cells, nothing, np.zeros_like(cells.fresh))
    assert cold.sum() == pytest.approx(cells.fresh.sum(), rel=1e-9)
    assert solved_pressure(cells, nothing).sum() == pytest.approx(cells.fresh.sum(), rel=1e-9)


def test_even_wear_gives_the_load_of_a_smaller_approach(cells):
    computed = solved_pressure(cells, np.full(cells.X.size, 0.1)).sum() / cells.fresh.sum()
    assert computed == pytest.approx(0.9**1.5, rel=2e-3)  # the error of the cells


@pytest.mark.parametrize("c", [-0.1, 0.2])
def test_parabolic_wear_gives_the_load_of_hertz_for_another_groove_radius(cells, c):
    _, _, s = elliptic_integrals(1.0 / KAPPA)
    # wear c X^2 adds c to the curvature s along X, in units of the approach and of a
    unworn, worn = (
        point_contact(s + wear, (1.0 - s) * KAPPA**2, 1.0, math.nan).K for wear in (0.0, c)
    )
    computed = solved_pressure(cells, c * cells.X**2).sum() / cells.fresh.sum()
    assert computed == pytest.approx(worn / unworn, rel=1e-3)


def test_a_mirrored_profile_gives_the_mirrored_pressure(cells):
    wear = PROFILES["skew"](cells.X)
    pressure = solved_pressure(cells, wear)
    assert solved_pressure(cells, wear[::-1].copy()) == pytest.approx(pressure[:, ::-1], abs=1e-6)


def test_pressure_does_not_depend_on_how_far_the_cells_reach(cells):
    width = cells.X[1] - cells.X[0]
    low, high = -1.9 - 2 * width, 1.9 + 4 * width
    _, wider = contact_cells(math.log(KAPPA), low, high, 1.3 * FULL_WIDTH, 54, 13)
    pressure = solved_pressure(cells, PROFILES["two"](cells.X))
    computed = solved_pressure(wider, PROFILES["two"](wider.X))
    assert computed[:10, 2:-4] == pytest.approx(pressure, abs=1e-6)
    assert not computed[10:].any()


@pytest.mark.parametrize("name", PROFILES)
def test_load_and_its_centre_agree_with_tamaas(cells, name):
    pressure = solved_pressure(cells, PROFILES[name](cells.X))
    load, centre = TAMAAS[name]
    assert pressure.sum() / cells.fresh.sum() == pytest.approx(load, rel=1e-3)
    assert (pressure * cells.X).sum() / pressure.sum() == pytest.approx(centre, abs=1e-3)


@pytest.mark.parametrize("name", PROFILES)
def test_a_solved_contact_passes_its_check(cells, name):
    wear = PROFILES[name](cells.X)
    pressure = solved_pressure(cells, wear)
    check = contact_check(cells, check_influence(cells), wear, pressure)
    assert max(check.gap, check.overlap) < 2e-8  # of the approach, as the solver leaves
    assert check.tension == 0.0
    assert check.load == pytest.approx(pressure.sum() * cells.area, rel=1e-12)


def test_the_contact_check_rejects_wrong_depths_and_pressures(cells):
    wear = PROFILES["skew"](cells.X)
    pressure = solved_pressure(cells, wear)
    # 1e-6 deeper leaves a gap of nearly as much; 0.1 less deep, the bodies overlap
    assert contact_check(cells, check_influence(cells), wear + 1e-6, pressure).gap > 0.9e-6
    assert contact_check(cells, check_influence(cells), wear - 0.1, pressure).overlap > 0.01
    pressure[0, 20] *= -1.0
    assert contact_check(cells, check_influence(cells), wear, pressure).tension > 0.5


def test_a_failed_contact_solve_has_a_status(cells):
    work = contact_buffers(48, 10)
    hill = -1.5 * np.ones(48)  # by which the contact outgrows its cells
    assert worn_pressure(cells, hill, work, cells.fresh.copy())[0] == code.BEYOND_GROOVE
    unknown = np.full(48, math.nan)
    assert worn_pressure(cells, unknown, work, cells.fresh.copy())[0] == code.NOT_CONVERGED


def test_a_ball_off_the_groove_has_no_pressure(cells):
    assert solved_pressure(cells, np.full(48, 1.1)).max() == 0.0


@pytest.mark.parametrize("spin", [0.0, 1.0])
def test_with_a_fixed_width_pressure_times_slip_becomes_even(spin):
    """Wear goes on until pressure times slip is even, to 2 %; the load stays half of Hertz's.

    Nothing wears beyond X = +-1. The slip is 1 everywhere, or sqrt(X^2 + 0.3^2) with spin.
    """
    strips = 40
    _, cells = contact_cells(math.log(KAPPA), -1.0, 1.0, FULL_WIDTH, strips, 8)
    work, pressure = contact_buffers(strips, 8), cells.fresh.copy()
    slip = np.sqrt(spin * cells.X**2 + 0.3**2) if spin else np.ones(strips)
    wear, load = np.zeros(strips), 0.5 * cells.fresh.sum()

    def load_at(shift):
        status, _ = worn_pressure(cells, wear + shift, work, pressure)
        assert status != code.NOT_CONVERGED
        return pressure.sum()

    shift, step = 0.3, 1e-4
    for _ in range(400):  # steps of wear, until the pressure no longer changes
        for _ in range(3):  # of Newton's method, to keep the load
            excess = load_at(shift) - load
            slope = (load_at(shift + step) - load - excess) / step
            shift -= excess / slope
        line_load = pressure.sum(axis=0) / load * strips  # with a mean of 1
        wear_rate = line_load * slip
        wear += 0.03 * (wear_rate - wear_rate.mean())
    assert wear_rate == pytest.approx(np.full(strips, wear_rate.mean()), rel=0.02)
    # the line load is then as 1/|v|, whose mean is 1
    assert wear_rate.mean() == pytest.approx(1.0 / np.mean(1.0 / slip), rel=1e-2)
