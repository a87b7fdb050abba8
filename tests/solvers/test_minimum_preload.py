"""Friction and slip at the least preloads of two makers, and starved lives as a bound."""

import math

import numpy as np
import pytest
from support import benchmark

import bearingwear
from bearingwear.scene.coefficients import M2_PER_N, MEASURED_WEAR
from bearingwear.scene.new.catalogue import entry_of

pytestmark = pytest.mark.long  # 324 bearings of catalogues


@pytest.fixture(scope="module")
def minimum():
    return benchmark("minimum_preload")


@pytest.fixture(scope="module")
def gmn(minimum):
    return minimum.gmn_groups()


@pytest.fixture(scope="module")
def skf(minimum):
    return minimum.skf_groups()


def test_the_page_has_these_numbers(minimum, gmn, skf):
    """Sentences and rows that the program writes, and the range of the frictions."""
    page = minimum.PAGE.read_text(encoding="utf-8")
    assert minimum.sentences(gmn, skf) in page and minimum.lines(gmn, skf) in page
    assert minimum.open_group_sentence(gmn) in page and minimum.skf_sentence(skf) in page
    means = [minimum.mean(friction) for friction in minimum.gmn_frictions(gmn).values()]
    means += [minimum.mean(minimum.skf_frictions(group)) for group in skf.values()]
    assert f": friction {min(means):.3f} to {max(means):.3f} |" in page


def test_every_bearing_with_a_printed_minimum_is_compared(gmn, skf):
    """The tables of both makers in benchmarks/catalogue have so many rows."""
    assert sum(map(len, gmn.values())) == 267 and sum(map(len, skf.values())) == 57


def test_least_preload_of_gmn_needs_one_friction(minimum, gmn):
    """It is 0.02 to 0.05 (BETWEEN) in each group; with growth of the rings, the least is 0.0199.

    No single bearing of a group is further than 30 % below.
    """
    low, high = minimum.BETWEEN
    for group, friction in minimum.gmn_frictions(gmn, rigid=True).items():
        assert low < minimum.mean(friction) < high, group
    for group, friction in minimum.gmn_frictions(gmn).items():
        assert 0.99 * low < minimum.mean(friction) < high, group
        assert friction.min() > 0.7 * low and friction.max() < high, group


def test_least_preload_of_gmn_is_a_share_of_the_rating(minimum):
    """Each series and angle has one share, within the rounding of printed values: 2.6 %.

    The medians [N/N] of the ratios from `minimum.preloads_over_rating()` are regression values, in
    its order.
    """
    shares = (0.0257, 0.0364, 0.0303, 0.0342, 0.0382, 0.0360, 0.0479)
    for (group, ratio), share in zip(minimum.preloads_over_rating().items(), shares, strict=True):
        assert np.median(ratio) == pytest.approx(share, rel=0.015), group
        assert np.std(np.log(ratio)) < 0.026, group


@pytest.mark.parametrize(("suffix", "scatter"), [("AC", 0.05), ("B", 0.10)])
def test_least_loads_of_skf_need_one_friction(minimum, skf, suffix, scatter):
    """It scatters by 5 or 10 %, although balls and grooves are assumed by the size alone."""
    friction = minimum.skf_frictions(skf[suffix])
    assert minimum.BETWEEN[0] < minimum.mean(friction) < minimum.BETWEEN[1]
    assert np.std(np.log(friction)) < scatter
    assert friction.min() > 0.03 and friction.max() < 0.053


def test_common_sizes_of_skf_need_the_same_friction_to_5_percent(skf):
    sizes = ("7208", "7209", "7210", "7212", "7213", "7307", "7308", "7309", "7311", "7312")
    friction = np.array([skf["AC"][f"{size}AC"][-1].friction for size in sizes])
    assert np.abs(friction / friction.mean() - 1.0).max() < 0.05


def test_a_least_load_of_skf_is_converted_to_newtons(minimum):
    """It is A (n/1000)^2 kN: a 7208 AC at 5000 r/min, with A = 0.00419, needs 0.00419 x 25 kN."""
    speed_times_pitch = 5000.0 * 60.0  # r/min mm: (40 + 80)/2 mm
    scene = minimum.skf_scene("7208AC", speed_times_pitch, 0.08)
    assert scene.operation.shaft_speed_rpm == pytest.approx(5000.0)
    assert scene.operation.preload_N == pytest.approx(1e3 * 0.00419 * 25.0)


@pytest.mark.parametrize("designation", ["S 6007 C", "KH 6007 E"])
def test_the_friction_that_holds_the_balls_has_a_closed_form(minimum, designation):
    """It is M_g/((Q_i + Q_o) R) in SI units, with the spin axis of outer race control.

    Angles and loads are those of the solve; orbit, spin and moment are written once more.
    """
    entry = entry_of("GMN", designation)[0]
    scene = minimum.gmn_scene(entry, entry.speed_oil, 0.08)
    with pytest.warns(UserWarning):
        result = bearingwear.solve(scene, "race_control")
    D, dm = 1e-3 * entry.ball, 1e-3 * entry.pitch
    omega = entry.speed_oil * math.pi / 30.0
    inner, outer = (math.radians(float(a)) for a in np.ravel(result.contact_angle)[:2])
    gamma = D / dm
    pitch = math.atan2(math.sin(outer), math.cos(outer) + gamma)
    # Harris, outer race control, the inner ring turns
    a = (math.cos(outer) + math.tan(pitch) * math.sin(outer)) / (1.0 + gamma * math.cos(outer))
    b = (math.cos(inner) + math.tan(pitch) * math.sin(inner)) / (1.0 - gamma * math.cos(inner))
    spin = omega / ((a + b) * gamma * math.cos(pitch))
    orbit = omega * (1.0 - gamma * math.cos(inner)) / (1.0 + math.cos(inner - outer))
    mass = 7800.0 * math.pi / 6.0 * D**3
    moment = 0.1 * mass * D**2 * spin * orbit * math.sin(pitch)
    load = float(np.ravel(result.contact_load)[:2].sum())
    expected = moment / (load * 0.5 * D)
    friction = 0.08 * float(np.max(result.friction_used_by_gyroscopic_moment))
    # 2 %: growth of the rings, and the angle of outer control for the balls of a solve
    assert friction == pytest.approx(expected, rel=0.02)


def test_starved_lives_are_a_bound():
    """Their rows of the coefficients say so, and have the bound computed from the tested lives."""
    bounds = benchmark("bounds")
    for name, balls in (("nesc_r4", "bearing_steel"), ("nesc_r4_hybrid", "silicon_nitride")):
        row = MEASURED_WEAR[name]
        assert row.conditions.startswith("bound: ") and math.isnan(row.wear[0])
        bound = bounds.starved_bound(balls)
        assert M2_PER_N * row.wear[1] == pytest.approx(bound, rel=0.03, abs=0.0)  # two digits
    assert bounds.starved_sentence() in bounds.PAGE.read_text(encoding="utf-8")
