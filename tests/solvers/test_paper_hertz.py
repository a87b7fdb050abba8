"""What becomes of the paper's statements with slip over the ellipse and traction in the balance.

The scene gyro_s1_hertz beside gyro_s1, whose statements are in test_paper.py; docs/verification.md
says which of them hang on the line model. Bounds are what gyro_s1_hertz has, rounded up or down.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.lives.life import life
from bearingwear.solvers.solve import solve

FORCE, POSITION = "constant_force", "fixed_position"
INNER, OUTER = 0, 1


@pytest.fixture(scope="module")
def hertz(scene):
    """Returns a function (method, mu, loss [um]) that returns the values of gyro_s1_hertz."""

    def solved(method=FORCE, mu=0.08, loss=0.0):
        changes = {
            "operation.preload_method": method,
            "friction.ball_race": mu,
            "wear.ball_diameter_loss_um": loss,
        }
        result = solve(scene("gyro_s1_hertz", changes), "steady")
        assert result.status == "ok"
        return result.values

    return solved


def test_1_qv_falls_with_friction_on_the_ellipse_too(hertz):
    """QV falls with mu, hardly changes above 0.05, and is slightly higher at fixed position.

    The paper says so in words; "hardly" is 1.1 % here, and "slightly" less than 10 %.
    """
    qv = {m: [hertz(m, mu)["total_qv"] for mu in (0.02, 0.05, 0.11)] for m in (FORCE, POSITION)}
    for low, middle, high in qv.values():
        assert low / middle > 1.1 and 1.0 < middle / high < 1.011
    ratio = np.divide(qv[POSITION], qv[FORCE])
    assert np.all((ratio > 1.0) & (ratio < 1.1))


@pytest.mark.parametrize("mu, inside", [(0.02, 1), (0.08, 2)])
def test_finding_2_needs_the_line_contact_at_low_friction(hertz, mu, inside):
    """The inner contact has two points of pure rolling at high friction, and one at low friction.

    The outer contact has one. Slip changes sign at each. On the line, the inner contact has two at
    either friction (test_paper.py).
    """
    slip = hertz(mu=mu)["rolling_slip"][0]
    assert [(np.diff(np.sign(s)) != 0).sum() for s in slip] == [inside, 1]


def test_3_gyroscopic_slip_needs_low_friction_on_the_ellipse_too(hertz):
    low, high = (np.abs(hertz(mu=mu)["gyroscopic_slip"]).mean() for mu in (0.02, 0.08))
    assert low > 5.0 * high
    assert high < 0.05 * np.abs(hertz()["rolling_slip"]).mean()


def test_4_is_a_fit_to_the_line(hertz):
    """57.47 % of the preload is lost at 0.5 um on the ellipse; in the paper it is 60.33 %.

    A regression value, which docs/verification.md quotes.
    """
    lost = 100.0 * (1.0 - hertz(POSITION, 0.08, 0.5)["residual_preload"] / 7.0)
    assert_allclose(lost, 57.47, atol=0.05)


def test_5_qv_is_flat_under_constant_force_and_falls_at_fixed_position_on_the_ellipse_too(hertz):
    """The paper says "flat", which is 1 % here; by 0.7 um QV falls to less than 0.4 of that new."""
    qv = {m: [hertz(m, 0.08, x)["total_qv"] for x in (0.0, 0.3, 0.7)] for m in (FORCE, POSITION)}
    assert np.ptp(qv[FORCE]) < 0.01 * qv[FORCE][0]
    assert qv[POSITION][2] < qv[POSITION][1] < qv[POSITION][0]
    assert qv[POSITION][2] < 0.4 * qv[POSITION][0]


def test_finding_7_needs_the_line_contact(hertz, values):
    """After 0.5 um at fixed position, about half of QV is inside on the ellipse.

    On the line it is less than a quarter.
    """
    inside = hertz(POSITION, 0.08, 0.5)["qv"][0]
    assert 0.4 < inside[INNER] / inside.sum() < 0.6
    on_line = values(POSITION, 0.08, 0.5)["qv"][0]
    assert on_line[INNER] / on_line.sum() < 0.25


def test_8_constant_force_rises_and_lies_above_fixed_position(hertz):
    qv = [hertz(FORCE, 0.02, x)["total_qv"] for x in (0.0, 0.3, 0.7)]
    assert np.all(np.diff(qv) > 0.0) and np.ptp(qv) < 0.01 * qv[0]
    for mu in (0.02, 0.08):
        assert hertz(POSITION, mu, 0.5)["total_qv"] < hertz(FORCE, mu, 0.5)["total_qv"]


@pytest.mark.parametrize("mu, longer", [(0.02, FORCE), (0.08, POSITION)])
@pytest.mark.parametrize("name", ["gyro_s1", "gyro_s1_hertz"])
def test_the_method_that_lasts_longer_is_the_same(scene, name, mu, longer):
    """It is the spring at low and the fixed position at high friction, on line and ellipse."""

    def life_s(method):
        changes = {"operation.preload_method": method, "friction.ball_race": mu}
        return life(scene(name, changes)).values["life"]

    shorter = POSITION if longer == FORCE else FORCE
    assert life_s(longer) > life_s(shorter)
