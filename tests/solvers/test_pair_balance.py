"""The search for the rotor's place, and pairs in which it is hard."""

import copy
import math
from typing import NamedTuple

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.kernels import status as code
from bearingwear.solvers.bearing.rotor_balance import Nearby, RotorTrial, balanced_place
from bearingwear.solvers.condition import Condition, SolvedBearing
from bearingwear.solvers.solve import solve

HELD = 1e6  # slope of the unbalanced force that each trial states, for constant orbit rates [N/m]
SCALE = 10.0  # of the forces that a trial states [N]


class Search(NamedTuple):
    """Where a search for the rotor's place ends [m], its status and its number of trials."""

    place: float
    status: int
    trials: int


def search(unbalanced_force, start=0.0, nearby=None):
    """Searches for the place [m] where a force [N] vanishes, and returns what it ends with.

    unbalanced_force: function of the place. Beyond 1 mm from the middle a contact is lost.
    """
    solved, lost = (
        SolvedBearing(status, Condition(0.0), None) for status in (code.OK, code.CONTACT_LOST)
    )
    places = []

    def trial(x):
        places.append(x)
        states = (lost if abs(x) > 1e-3 else solved, solved)
        return RotorTrial(states, unbalanced_force(x), HELD, SCALE)

    place, result = balanced_place(trial, start, 1e-20, nearby or Nearby())
    status = result if isinstance(result, int) else code.OK
    return Search(place, status, len(places))


@pytest.mark.parametrize("steeper", [0.2, 0.9, 1.0, 2.0, 3.5, 40.0])
def test_balance_where_forces_are_steeper_or_flatter_than_expected(steeper):
    """It takes few trials, also where each step by the stated slope leads farther away.

    That is so where the force is more than twice as steep as stated.
    """

    def unbalanced_force(x):
        return steeper * HELD * (x - 2e-6) * (1.0 + 0.1 * math.tanh(1e5 * (x - 2e-6)))

    result = search(unbalanced_force)
    assert result.status == code.OK and result.trials < 12
    assert_allclose(result.place, 2e-6, rtol=1e-9)


def test_a_force_that_falls_with_the_place_holds_no_rotor():
    """It vanishes at 2 um, but would push the rotor away from there."""
    assert search(lambda x: -0.1 * HELD * (x - 2e-6)).status == code.NO_STEADY_STATE


def test_a_rotor_that_runs_away_stops_where_the_force_rises_again():
    """-0.3 HELD x + 3e15 x^3 = 0 at 1e-5 m."""
    result = search(lambda x: -0.3 * HELD * x + 3e15 * x**3, start=1e-6)
    assert result.status == code.OK
    assert_allclose(result.place, 1e-5, rtol=1e-9)


def test_a_force_that_jumps_over_zero_balances_no_rotor():
    """It jumps from -3 to 3 N at 1 um, where the search ends."""
    result = search(lambda x: HELD * (x - 1e-6) + math.copysign(3.0, x - 1e-6))
    assert result.status == code.NO_STEADY_STATE
    assert_allclose(result.place, 1e-6, rtol=1e-8)


def test_a_rotor_whose_balance_lies_beyond_contact_lifts_off():
    """The force would vanish at 5 mm."""
    assert search(lambda x: HELD * x - 5e3).status == code.LIFTED_OFF


def test_earlier_balances_predict_the_next_one():
    """A place linear in the losses is known after two of them, and its steepness."""
    nearby = Nearby()
    trials = []
    for loss in (0.0, 1e-7, 2e-7, 3e-7):
        losses = (loss, 2.0 * loss)
        start = nearby.expected_place(losses) if nearby.has_place else 0.0
        place = 1e-6 + 0.7 * loss
        result = search(lambda x, place=place: 3.0 * HELD * (x - place), start, nearby)
        nearby.remember(losses, result.place)
        assert result.status == code.OK
        trials.append(result.trials)
    assert trials[2:] == [1, 1] and trials[0] > 1
    assert_allclose(nearby.slope @ np.array([1.0, 2.0]), 0.7, rtol=1e-6)


RIGID = {
    "operation.preload_method": "fixed_position",
    "arrangement.kind": "rigid_pair",
    "cage": None,
}
HARD_PAIRS = {
    # force three times as steep as at held orbits
    "steep": ("steady", "ok", {
        "bearing": {"ball_count": 8, "ball_diameter_mm": 0.548, "pitch_diameter_mm": 2.268,
                    "contact_angle_deg": 22.86, "inner_groove_factor": 0.5089,
                    "outer_groove_factor": 0.5438},
        "operation.shaft_speed_rpm": 528726.0, "operation.preload_N": 0.5085,
        "arrangement.external_axial_N": -0.114, "friction.ball_race": 0.00121,
        "arrangement.second": {"wear.ball_diameter_loss_um": 0.0702},
    }),
    # orbits that follow make the force fall with the place
    "runs away": ("steady", "no_steady_state", {
        "bearing": {"ball_count": 10, "ball_diameter_mm": 3.9175, "pitch_diameter_mm": 18.608,
                    "contact_angle_deg": 59.204, "inner_groove_factor": 0.52804,
                    "outer_groove_factor": 0.55524},
        "operation.shaft_speed_rpm": 147946.0, "operation.preload_N": 1.0582,
        "arrangement.external_axial_N": -2.765, "friction.ball_race": 0.0466,
        "friction.slip_regularisation_m_s": 0.0308, "lubricant.drag_density_kg_m3": 2.554,
        "arrangement.second": {"wear.ball_diameter_loss_um": 0.0486},
    }),
    # the place that the rotor wants is where the other race takes control
    "jumps": ("race_control", "no_race_control", {
        "bearing": {"ball_count": 21, "ball_diameter_mm": 68.632, "pitch_diameter_mm": 548.23,
                    "contact_angle_deg": 38.22, "inner_groove_factor": 0.55734,
                    "outer_groove_factor": 0.57098},
        "operation.shaft_speed_rpm": 1066.56, "operation.outer_speed_rpm": -1549.46,
        "operation.preload_N": 100000.0,
        "arrangement.external_axial_N": -16287.0, "friction.ball_race": 0.6833,
        "arrangement.second": {"wear.ball_diameter_loss_um": 0.419},
    }),
}  # fmt: skip


@pytest.mark.parametrize("name", HARD_PAIRS)
def test_a_hard_pair_has_its_status(scene, name):
    """The study of robustness drew these pairs, which once ended without a named status."""
    fidelity, status, changes = copy.deepcopy(HARD_PAIRS[name])
    bearing = {f"bearing.{key}": value for key, value in changes.pop("bearing").items()}
    result = solve(scene("gyro_s1", RIGID | bearing | changes), fidelity)
    assert result.status == status
    if status == "ok":
        F = result.values["residual_preload"]
        assert_allclose(F[0] - F[1], changes["arrangement.external_axial_N"], rtol=1e-8)


def test_the_last_rough_place_is_expected_next_and_changes_no_slope():
    """A rough place is too inexact for the slope between it and an exact one."""
    nearby = Nearby()
    assert not nearby.has_place
    nearby.remember_rough((0.0, 0.0), 1e-6)
    assert nearby.has_place and nearby.expected_place((1e-7, 1e-7)) == 1e-6
    nearby.remember_rough((1e-9, 0.0), 2e-6)
    assert nearby.expected_place((1e-7, 1e-7)) == 2e-6 and not nearby.slope.any()
    for loss in (0.0, 1e-7):
        nearby.remember((loss, loss), 1e-6 + 0.5 * loss)
    nearby.remember_rough((1.01e-7, 1e-7), 3e-6)  # its slope is not learned
    assert_allclose(nearby.slope.sum(), 0.5, rtol=1e-6)
