"""The paper's statements (Zhang et al. 2018), each on the identified bearing gyro_s1.

The tests have the numbers of docs/verification.md. The paper says in words how much: "slightly",
"clear", "almost zero"; the bounds here are what gyro_s1 has, rounded up. A statement that does not
hold to the letter is tested for what does hold. `values` of tests/conftest.py solves gyro_s1.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

MUS = (0.02, 0.05, 0.08, 0.11)
LOSSES = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7)
FORCE, POSITION = "constant_force", "fixed_position"
INNER, OUTER = 0, 1


def over_loss(values, name, **fixed):
    """Returns a quantity at each of the LOSSES."""
    return np.array([values(loss=loss, **fixed)[name] for loss in LOSSES])


def test_1_qv_falls_with_friction_and_flattens(values):
    qv = {m: [values(m, mu)["total_qv"] for mu in MUS] for m in (FORCE, POSITION)}
    for series in qv.values():
        assert np.all(np.diff(series) < 0.0)
        assert series[0] / series[1] - 1.0 > 0.05  # 0.02 to 0.05: clear
        assert series[1] / series[3] - 1.0 < 0.01  # above 0.05: hardly any change
    ratio = np.divide(qv[POSITION], qv[FORCE])
    assert np.all((ratio > 1.0) & (ratio < 1.1))  # slightly above
    load = [values(m, 0.08)["contact_load"][0, INNER] for m in (FORCE, POSITION)]
    assert load[1] > load[0]  # because its running load is higher


@pytest.mark.parametrize("mu", [0.02, 0.08])
def test_2_two_pure_rolling_points_inside_and_one_outside_which_slips_and_spins_more(values, mu):
    v = values(mu=mu)
    sign_changes = [(np.diff(np.sign(v["rolling_slip"][0, k])) != 0).sum() for k in (INNER, OUTER)]
    assert sign_changes == [2, 1]
    inner, outer = np.abs(v["rolling_slip"][0]).mean(axis=1)
    assert outer > 2.0 * inner
    assert v["spin_to_roll_ratio"][0, OUTER] > 5.0 * v["spin_to_roll_ratio"][0, INNER]


def test_3_gyroscopic_slip_needs_low_friction(values):
    low, high = (np.abs(values(mu=mu)["gyroscopic_slip"]).mean() for mu in (0.02, 0.08))
    assert low > 5.0 * high
    rolling = np.abs(values(mu=0.08)["rolling_slip"]).mean()
    assert high < 0.03 * rolling  # almost zero


def test_4_preload_lost_at_half_a_micrometre(values):
    """60.33 % in the paper. The bearing was identified from this number: a fit, no validation."""
    lost = 100.0 * (1.0 - values(POSITION, 0.08, 0.5)["residual_preload"] / 7.0)
    assert abs(lost - 60.33) < 1.0
    fresh, worn = (values(POSITION, 0.08, loss)["residual_preload"] for loss in (0.0, 0.5))
    # against the running preload, as docs/verification.md says
    assert_allclose(100.0 * (1.0 - worn / fresh), 62.32, atol=0.05)
    assert_allclose(values(FORCE, 0.08, 0.5)["residual_preload"], 7.0, rtol=1e-9)


def test_5_with_wear_qv_is_flat_under_constant_force_and_falls_at_fixed_position(values):
    qv = {m: over_loss(values, "total_qv", method=m, mu=0.08) for m in (FORCE, POSITION)}
    preload = over_loss(values, "residual_preload", method=POSITION, mu=0.08)
    assert np.ptp(qv[FORCE]) < 0.01 * qv[FORCE][0]  # flat
    assert np.all(np.diff(qv[POSITION]) < 0.0)
    assert np.all(np.diff(preload) < 0.0)
    assert np.corrcoef(qv[POSITION], preload)[0, 1] > 0.99  # with its residual preload
    angle = {
        m: over_loss(values, "contact_angle", method=m, mu=0.08)[:, 0] for m in (FORCE, POSITION)
    }
    assert np.all(np.diff(angle[POSITION][:, INNER]) > 0.0)
    assert np.all(np.diff(angle[POSITION][:, OUTER]) < 0.0)
    assert np.all(np.diff(angle[FORCE], axis=0) > 0.0)
    assert np.degrees(np.ptp(angle[FORCE], axis=0)).max() < 0.6  # slowly


def test_6_at_low_friction_with_drag_qv_falls_and_rises_again_with_gyroscopic_slip(values):
    """QV is least at 0.2 to 0.4 um."""
    fixed = {"method": POSITION, "mu": 0.02, "drag": 250.0}
    qv = over_loss(values, "total_qv", **fixed)
    least = LOSSES[int(np.argmin(qv))]
    assert 0.2 <= least <= 0.4
    assert qv[LOSSES.index(least) :].max() > 1.05 * qv.min()
    gyro = np.abs(over_loss(values, "gyroscopic_slip", **fixed)).mean(axis=(1, 2, 3))
    assert gyro[-1] > 5.0 * gyro[0]
    # above 0.6 um the ball slips in the rolling direction: no pure-rolling point is left outside
    outer = over_loss(values, "rolling_slip", **fixed)[-1, 0, OUTER]
    assert np.all(outer > 0.0) or np.all(outer < 0.0)


def test_6_qv_falls_again_at_the_last_loss_and_drag_exceeds_friction(values):
    """Both depart from statement 6: QV falls a little from 0.6 to 0.7 um, and drag is so large."""
    fixed = {"method": POSITION, "mu": 0.02, "drag": 250.0}
    before_last, last = values(loss=0.6, **fixed), values(loss=0.7, **fixed)
    assert 0.97 < last["total_qv"] / before_last["total_qv"] < 1.0
    friction_power = 9 * before_last["friction_heat"].sum()  # of nine equal balls
    assert before_last["drag_power"] > 10.0 * friction_power


def test_6_without_drag_qv_never_rises(values):
    """Why the drag was identified: without it, low friction alone does not make QV rise."""
    assert np.all(np.diff(over_loss(values, "total_qv", method=POSITION, mu=0.02)) < 0.0)


def test_7_rolling_slip_is_nearly_the_same_for_both_preloads(values):
    """Nearly: 16 % (outer) and 28 % (inner) of its largest value, where the load differs 2.7-fold.

    Compared at the same place x/a of the two ellipses.
    """
    force, position = (values(m, 0.08, 0.5)["rolling_slip"][0] for m in (FORCE, POSITION))
    for k, allowed in ((INNER, 0.30), (OUTER, 0.18)):
        assert np.abs(force[k] - position[k]).max() < allowed * np.abs(force[k]).max()


def test_7_departs_above_06_um_where_the_spin_moves_to_the_inner_race(values):
    """There is no drag: the ratio of spin to roll inside over outside passes a half."""
    inner_over_outer = [
        np.divide(*values(POSITION, 0.08, loss)["spin_to_roll_ratio"][0]) for loss in (0.5, 0.7)
    ]
    assert inner_over_outer[0] < 0.5 < inner_over_outer[1]


def test_8_low_friction_and_the_other_order_at_half_a_micrometre(values):
    # "fluctuates" in the paper; QV of gyro_s1 under constant force rises by 0.55 % at most
    qv = over_loss(values, "total_qv", method=FORCE, mu=0.02)
    assert np.ptp(qv) / qv[0] < 0.0055
    assert np.all(np.diff(qv) > 0.0)
    for mu in MUS:
        assert values(POSITION, mu, 0.5)["total_qv"] < values(FORCE, mu, 0.5)["total_qv"]
