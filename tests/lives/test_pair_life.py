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


STIFFNESSES = ("history_system_axial_stiffness", "history_system_quasistatic_axial_stiffness")


def criterion(result):
    """Returns the name of the criterion that ends a life."""
    return CRITERIA[result.values["end_criterion"]]


@pytest.fixture(scope="module")
def life_result(scene):
    """Returns a function (changes) that returns the result of a life of gyro_s1."""
    return lambda changes: life(scene("gyro_s1", changes))


@pytest.mark.parametrize(("single", "pair"), [(POSITION, RIGID), ({}, SPRING)])
def test_each_of_a_symmetric_pair_lives_as_the_single_bearing(life_result, single, pair):
    end = {"wear.end_of_life": {"preload_fraction": 0.4, "ball_diameter_loss_um": 0.7}}
    single_result, pair_result = (life_result(changes | end) for changes in (single, pair))
    assert criterion(single_result) == criterion(pair_result)
    for k in range(2):
        of_one = values_of_bearing(pair_result.values, k)
        assert set(of_one) == set(single_result.values)
        for name, value in single_result.values.items():
            assert_allclose(of_one[name], value, rtol=1e-12, err_msg=name)


WORN = {"model.contact": "worn", "wear.end_of_life": {"ball_diameter_loss_um": 0.05}}


def test_grooves_of_a_symmetric_pair_are_those_of_the_single_bearing(life_result):
    """All values of the second bearing agree to rounding, and files have a dimension `bearing`."""
    single_result, pair_result = life_result(POSITION | WORN), life_result(RIGID | WORN)
    assert single_result.status == pair_result.status == "ok"
    assert "groove_depth" in single_result.values
    second = values_of_bearing(pair_result.values, 1)
    for name, value in single_result.values.items():
        assert_allclose(second[name], value, rtol=1e-12, err_msg=name)
    in_file = dataset_of_result(pair_result)
    for name in ("groove_depth", "history_residual_preload"):
        assert in_file[name].dims[0] == "bearing"


def test_grooves_of_unlike_bearings_are_followed_one_by_one(life_result):
    unlike = life_result(FORCED | WORN)
    assert unlike.status == "ok" and unlike.values["groove_depth"].shape[0] == 2


def test_losses_of_a_pair_are_those_of_a_plain_integration(life_result, scene):
    """Six steps of the classical Runge-Kutta method, over the rates of single cases of the pair."""
    result = life_result(FORCED)
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
    assert_allclose(values["loss_at_end"], y, rtol=2e-5)  # of six steps
    assert y[0] > 1.2 * y[1]  # the loaded bearing wears more


def test_histories_of_a_pair_balance_its_external_force_to_the_end(life_result):
    values = life_result(FORCED).values
    F = values["history_residual_preload"]
    assert values["history_time"].shape[0] == F.shape[1]
    assert F.shape[1] >= 9  # enough states to be a history
    assert (np.diff(values["history_time"]) > 0.0).all()
    assert_allclose(F[0] - F[1], 2.0, atol=1e-9)  # the external force [N]
    assert_allclose(F[:, -1].min() / 7.0, 0.4, atol=1e-6)  # the criterion of gyro_s1
    for name in values.keys() - SHARED:
        assert np.shape(values[name])[0] == 2, name


def test_errors_of_a_life_of_a_pair_are_bounded(life_result):
    values = life_result(FORCED).values
    assert values["life_error_bound"] < 1e-3 * values["life"]
    assert 0.0 < values["life_error_estimate"] < 0.05


@pytest.mark.parametrize("kind", [RIGID | {"arrangement.external_axial_N": 1.0}, SPRING])
@pytest.mark.parametrize(
    ("limit", "value"),
    [
        ("system_axial_stiffness_N_um", 4.2),
        ("rotor_shift_um", 0.5),
        ("friction_used_by_gyroscopic_moment", 0.14),
        ("gyroscopic_slip_share", 0.13),
    ],
)
def test_a_functional_limit_ends_a_life_where_the_worse_bearing_meets_it(
    life_result, kind, limit, value
):
    """The values lie between those of the new and of the worn pairs."""
    result = life_result(kind | {"wear.end_of_life": {limit: value}})
    assert result.status == "ok" and criterion(result) == limit
    assert "ended_by" in result.attrs
    values = {name: np.asarray(history) for name, history in result.values.items()}
    at_end = {
        "system_axial_stiffness_N_um": 1e-6 * min(values[name][-1] for name in STIFFNESSES),
        "rotor_shift_um": 1e6 * abs(values["history_rotor_axial_shift"][-1]),
        "friction_used_by_gyroscopic_moment": values["history_friction_used_by_gyroscopic_moment"][
            :, -1
        ].max(),
        "gyroscopic_slip_share": values["history_gyroscopic_slip_share"][:, -1].max(),
    }
    assert_allclose(at_end[limit], value, rtol=1e-5)


def test_the_system_of_a_single_bearing_is_the_symmetric_pair(life_result):
    end = {"wear.end_of_life": {"system_axial_stiffness_N_um": 8.0}}
    single_result, pair_result = life_result(POSITION | end), life_result(RIGID | end)
    values = single_result.values
    assert_allclose(values["life"], pair_result.values["life"], rtol=1e-12)
    assert_allclose(min(values[name][-1] for name in STIFFNESSES), 8e6, rtol=1e-6)
    assert (values["history_rotor_axial_shift"] == 0.0).all()


def test_a_bearing_that_lifts_off_ends_a_life_without_a_criterion(life_result):
    """Its status names that, and the time until then is a lower bound."""
    far = {"arrangement.external_axial_N": 25.0, "wear.end_of_life": {"skid_ratio": 0.9}}
    result = life_result(RIGID | far)
    assert result.status in ("lifted_off", "contact_lost")
    assert criterion(result) == "none"
    assert result.values["life"] > 0.0


def test_a_limit_passed_when_new_gives_a_life_of_zero_and_a_warning(life_result):
    end = {"wear.end_of_life": {"system_axial_stiffness_N_um": 50.0}}  # five times that of the pair
    result = life_result(RIGID | {"arrangement.external_axial_N": 5.0} | end)
    assert result.status == "ok" and result.values["life"] == 0.0
    assert "over_limit_when_new" in result.attrs["warnings"]


@pytest.mark.parametrize(
    ("changes", "status"),
    [
        ({"operation.preload_N": 0.0, "wear.end_of_life": {"skid_ratio": 0.1}}, "preload_gone"),
        ({"friction.ball_race": 0.0}, "undetermined"),
    ],
)
def test_a_pair_without_preload_or_friction_has_a_status(life_result, changes, status):
    forced = RIGID | {"arrangement.external_axial_N": 1.0} | changes
    assert life_result(forced).status == status
