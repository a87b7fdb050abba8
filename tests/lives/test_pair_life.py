"""Wear life of two bearings: the limits in which it is a single one's, and a plain integration."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.lives.life import life
from bearingwear.results.netcdf import dataset_of_result
from bearingwear.scene.blocks import CRITERIA
from bearingwear.sides import SHARED, values_of_bearing
from bearingwear.solvers.solve import solve

POSITION = {"operation.preload_method": "fixed_position"}
RIGID = {**POSITION, "arrangement.kind": "rigid_pair"}
SPRING = {"arrangement.kind": "spring_pair"}
LOSS = "wear.ball_diameter_loss_um"
FORCED = RIGID | {
    "arrangement.external_axial_N": 2.0,
    "arrangement.second": {"friction.ball_race": 0.05},
}


def criterion(result):
    return CRITERIA[result.values["end_criterion"]]


@pytest.fixture(scope="module")
def lived(scene):
    """Function (changes) -> life of gyro_s1."""
    return lambda changes: life(scene("gyro_s1", changes))


@pytest.mark.parametrize(("single", "pair"), [(POSITION, RIGID), ({}, SPRING)])
def test_symmetric_pair_lives_as_the_single_bearing(lived, single, pair):
    end = {"wear.end_of_life": {"preload_fraction": 0.4, "ball_diameter_loss_um": 0.7}}
    alone, two = (lived(changes | end) for changes in (single, pair))
    assert criterion(alone) == criterion(two)
    for k in range(2):
        other = values_of_bearing(two.values, k)
        assert set(other) == set(alone.values)
        for name, value in alone.values.items():
            assert_allclose(other[name], value, rtol=1e-12, err_msg=name)


def test_grooves_of_a_symmetric_pair_are_followed(lived):
    """As those of the single bearing; in a file, too."""
    worn = {"model.contact": "worn", "wear.end_of_life": {"ball_diameter_loss_um": 0.05}}
    alone, two = lived(POSITION | worn), lived(RIGID | worn)
    assert alone.status == two.status == "ok" and "groove_depth" in alone.values
    for name, value in alone.values.items():
        assert_allclose(values_of_bearing(two.values, 1)[name], value, rtol=1e-12, err_msg=name)
    result = dataset_of_result(two)
    assert result["groove_depth"].dims[0] == result["history_residual_preload"].dims[0] == "bearing"
    unlike = lived(FORCED | worn)
    assert unlike.status == "ok" and unlike.values["groove_depth"].shape[0] == 2


def test_plain_integration(lived, scene):
    """The classical Runge-Kutta method in time, over the rates of single cases of the pair."""
    result = lived(FORCED)
    values, steps = result.values, 6
    h = float(values["life"]) / steps

    def rates(losses):
        second = FORCED["arrangement.second"] | {LOSS: losses[1] * 1e6}
        case = solve(
            scene("gyro_s1", FORCED | {LOSS: losses[0] * 1e6, "arrangement.second": second})
        )
        assert case.status == "ok"
        return case.values["ball_diameter_loss_rate"]

    y = np.zeros(2)
    for _ in range(steps):
        k1 = rates(y)
        k2 = rates(y + 0.5 * h * k1)
        k3 = rates(y + 0.5 * h * k2)
        k4 = rates(y + h * k3)
        y = y + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    assert_allclose(values["loss_at_end"], y, rtol=2e-5)
    assert y[0] > 1.2 * y[1]


def test_histories_and_bounds(lived):
    values = lived(FORCED).values
    assert values["history_time"].shape[0] == values["history_residual_preload"].shape[1] >= 9
    assert (np.diff(values["history_time"]) > 0.0).all()
    assert values["life_error_bound"] < 1e-3 * values["life"]
    assert 0.0 < values["life_error_estimate"] < 0.05
    F = values["history_residual_preload"]
    assert_allclose(F[0] - F[1], 2.0, atol=1e-9)
    least = F.min(axis=0)[-1] / 7.0
    assert_allclose(least, 0.4, atol=1e-6)
    own = {name for name in values if name not in SHARED}
    assert all(np.shape(values[name])[0] == 2 for name in own)


@pytest.mark.parametrize("kind", [RIGID | {"arrangement.external_axial_N": 1.0}, SPRING])
@pytest.mark.parametrize(
    ("limit", "value", "history", "factor"),
    [
        ("system_axial_stiffness_N_um", 4.2, "system_axial_stiffness", 1e-6),
        ("rotor_shift_um", 0.5, "rotor_axial_shift", 1e6),
        ("friction_used_by_gyroscopic_moment", 0.14, "friction_used_by_gyroscopic_moment", 1.0),
        ("gyroscopic_slip_share", 0.13, "gyroscopic_slip_share", 1.0),
    ],
)
def test_functional_limits(lived, kind, limit, value, history, factor):
    """Each ends the life of both kinds where it is met."""
    result = lived(kind | {"wear.end_of_life": {limit: value}})
    assert result.status == "ok" and criterion(result) == limit
    computed = factor * np.asarray(result.values[f"history_{history}"])
    if history == "system_axial_stiffness":  # the smaller of the two
        computed = np.fmin(
            computed, factor * result.values["history_system_quasistatic_axial_stiffness"]
        )
    at_end = computed[..., -1] if history != "gyroscopic_slip_share" else computed[:, -1, :]
    # friction and slip share are met from below by the worse bearing
    assert_allclose(np.max(np.abs(at_end)), value, rtol=1e-5)
    assert "ended_by" in result.attrs


def test_single_bearing_is_half_of_a_pair(lived):
    """Limits of the arrangement hold for it, too."""
    end = {"wear.end_of_life": {"system_axial_stiffness_N_um": 8.0}}
    alone, two = lived(POSITION | end), lived(RIGID | end)
    assert_allclose(alone.values["life"], two.values["life"], rtol=1e-12)
    both = ("history_system_axial_stiffness", "history_system_quasistatic_axial_stiffness")
    assert_allclose(min(alone.values[name][-1] for name in both), 8e6, rtol=1e-6)
    assert_allclose(alone.values["history_rotor_axial_shift"], 0.0)


def test_life_that_ends_with_lift_off(lived):
    far = {"arrangement.external_axial_N": 25.0, "wear.end_of_life": {"skid_ratio": 0.9}}
    result = lived(RIGID | far)
    assert result.status in ("lifted_off", "contact_lost")
    assert criterion(result) == "none"
    assert result.values["life"] > 0.0


def test_limits_passed_when_new(lived):
    result = lived(RIGID | {"arrangement.external_axial_N": 5.0,
                            "wear.end_of_life": {"system_axial_stiffness_N_um": 50.0}})  # fmt: skip
    assert result.status == "ok" and result.values["life"] == 0.0
    assert "over_limit_when_new" in result.attrs["warnings"]


def test_without_preload_or_friction(lived):
    for changes, status in (
        ({"operation.preload_N": 0.0, "wear.end_of_life": {"skid_ratio": 0.1}}, "preload_gone"),
        ({"friction.ball_race": 0.0}, "undetermined"),
    ):
        forced = RIGID | {"arrangement.external_axial_N": 1.0} | changes
        assert lived(forced).status == status
