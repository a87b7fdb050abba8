"""Results that are stored as solved have finite numbers: `not_finite` checks each of them."""

import math

import numpy as np
import pytest

from bearingwear.kernels.status import OK
from bearingwear.lives.life import life
from bearingwear.solvers import steady
from bearingwear.solvers.result import not_finite
from bearingwear.solvers.solve import solve

FIXED = {"operation.preload_method": "fixed_position"}


@pytest.mark.parametrize("wrong", [math.nan, math.inf])
def test_a_solve_with_a_number_that_is_not_finite_is_not_ok(scene, monkeypatch, wrong):
    monkeypatch.setattr(steady, "drag_power", lambda *args: wrong)
    result = solve(scene("gyro_s1"), "steady")
    assert result.status == "unverified"
    assert result.attrs["residual"].endswith(": drag_power")


def test_an_unknown_value_of_a_case_is_detected(scene):
    """NaN as a plain number, or as the last one of an array, is named as not finite."""
    result = solve(scene("gyro_s1", {"bearing.bore_mm": 5.0}), "steady")
    assert result.status == "ok" and not not_finite(result.values, result.scene)
    arrays = {name: np.array(value) for name, value in result.values.items()}
    for name, spoilt in arrays.items():
        if spoilt.dtype.kind == "f":
            spoilt.flat[-1] = math.nan
            value = spoilt if spoilt.ndim else float(spoilt)
            assert not_finite(result.values | {name: value}, result.scene) == [name]


@pytest.mark.parametrize(
    ("name", "value", "is_allowed"),
    [
        # infinite of a ball without load
        ("friction_used_by_gyroscopic_moment", [math.inf], True),
        ("friction_used_by_gyroscopic_moment", [math.nan], False),
        ("friction_used_by_gyroscopic_moment", [-math.inf], False),
        # a scene without temperatures of shaft and housing
        ("part_temperature", [60.0, 50.0, 55.0, math.nan, math.nan], True),
    ],
)
def test_values_that_may_be_infinite_or_unknown(scene, name, value, is_allowed):
    result = solve(scene("gyro_s1"), "steady")
    assert (not_finite(result.values | {name: value}, result.scene) == []) == is_allowed


@pytest.mark.parametrize(
    ("name", "value", "is_allowed"),
    [
        pytest.param("qv_error_estimate", [1e-3, math.nan], True, id="of one bearing alone"),
        pytest.param("qv_error_estimate", [math.nan, math.nan], False, id="of neither"),
        pytest.param("natural_frequency", [1e3, math.nan], False, id="of the rotor"),
    ],
)
def test_an_estimate_of_a_pair_may_be_unknown_of_one_bearing(scene, name, value, is_allowed):
    pair = scene("gyro_s1", {"arrangement.kind": "spring_pair"}).to_dict()
    assert (not_finite({"status": OK, name: np.array(value)}, pair) == []) == is_allowed


def test_an_unknown_value_of_a_life_is_detected(scene):
    result = life(scene("gyro_s1", FIXED))
    assert result.status == "ok" and not not_finite(result.values, result.scene)
    for name, k in (("life", ()), ("history_time", -1), ("history_total_qv", 0)):
        spoilt = np.array(result.values[name])
        spoilt[k] = math.nan
        assert not_finite(result.values | {name: spoilt}, result.scene) == [name]


def test_a_stiffness_may_be_unknown_between_the_ends_of_a_life(scene):
    """At the first and the last state it may not."""
    result = life(scene("gyro_s1", FIXED | {"arrangement.kind": "rigid_pair"}))
    for name in ("system_axial_stiffness", "system_quasistatic_axial_stiffness"):
        name = f"history_{name}"
        for k, unknown in ((2, []), (0, [name]), (-1, [name])):
            spoilt = np.array(result.values[name])
            spoilt[k] = math.nan
            assert not_finite(result.values | {name: spoilt}, result.scene) == unknown


def test_balls_that_do_not_orbit_have_no_quasistatic_matrix(scene):
    """Their answer across the axis is undefined; the file leaves it out.

    The outer speed at which they stand still lies between the two where they orbit to and fro.
    """

    def orbit(ratio):
        changes = {"operation.outer_speed_rpm": 30000.0 * ratio}
        return solve(scene("gyro_s1", changes), "steady").values

    low, high = -0.9, -0.4
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if orbit(middle)["orbit_speed"][0] > 0.0 else (middle, high)
    standing = orbit(middle)
    assert standing["status"] == OK and "quasistatic_stiffness_matrix" not in standing
    assert standing["quasistatic_axial_stiffness"] > 0.0
    assert "quasistatic_stiffness_matrix" in orbit(low + 0.01)
