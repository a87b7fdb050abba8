"""The search for the rotor's place, and pairs in which it is hard."""

import copy
import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.kernels import status as code
from bearingwear.solvers.bearing.rotor_balance import Nearby, RotorTrial, balanced_place
from bearingwear.solvers.condition import Condition, SolvedBearing
from bearingwear.solvers.solve import solve

HELD = 1e6  # slope that each trial says [N/m]


def search(left, start=0.0, nearby=None):
    """Place or status where a force `left(place)` vanishes, and how many trials it took."""
    solved, lost = (
        SolvedBearing(status, Condition(0.0), None) for status in (code.OK, code.CONTACT_LOST)
    )
    trials = []

    def trial(x):
        trials.append(x)
        beyond = abs(x) > 1e-3
        states = (lost if beyond else solved, solved)
        return RotorTrial(states, left(x), HELD, 10.0)

    x, result = balanced_place(trial, start, 1e-20, nearby or Nearby())
    return x, result if isinstance(result, int) else code.OK, len(trials)


@pytest.mark.parametrize("steeper", [0.2, 0.9, 1.0, 2.0, 3.5, 40.0])
def test_balance_where_forces_are_steeper_or_flatter_than_expected(steeper):
    """Also where each step by the slope at held orbits leads farther away: 2 times and more."""

    def left(x):
        return steeper * HELD * (x - 2e-6) * (1.0 + 0.1 * math.tanh(1e5 * (x - 2e-6)))

    x, status, trials = search(left)
    assert status == code.OK and trials < 12
    assert_allclose(x, 2e-6, rtol=1e-9)


def test_rotor_that_runs_away():
    """A force that falls with the place holds no rotor, though somewhere nothing is left."""
    assert search(lambda x: -0.1 * HELD * (x - 2e-6))[1] == code.NO_STEADY_STATE
    # it stops where the force rises again
    x, status, _ = search(lambda x: -0.3 * HELD * x + 3e15 * x**3, start=1e-6)
    assert status == code.OK
    assert_allclose(x, 1e-5, rtol=1e-9)


def test_force_that_jumps():
    x, status, _ = search(lambda x: HELD * (x - 1e-6) + math.copysign(3.0, x - 1e-6))
    assert status == code.NO_STEADY_STATE
    assert_allclose(x, 1e-6, rtol=1e-8)


def test_rotor_that_leaves_a_bearing():
    assert search(lambda x: HELD * x - 5e3)[1] == code.LIFTED_OFF


def test_earlier_balances_predict_the_next_one():
    """A place linear in the losses is known after two of them, and its steepness."""
    nearby = Nearby()
    trials = []
    for loss in (0.0, 1e-7, 2e-7, 3e-7):
        losses = (loss, 2.0 * loss)
        start = nearby.expected_place(losses) if nearby.has_place else 0.0
        x, status, n = search(lambda x, t=loss: 3.0 * HELD * (x - 1e-6 - 0.7 * t), start, nearby)
        nearby.remember(losses, x)
        assert status == code.OK
        trials.append(n)
    assert trials[2:] == [1, 1] and trials[0] > 1
    assert_allclose(nearby.slope @ np.array([1.0, 2.0]), 0.7, rtol=1e-6)


RIGID = {
    "operation.preload_method": "fixed_position",
    "arrangement.kind": "rigid_pair",
    "cage": None,
}
FOUND_BY_RANDOM_PAIRS = {
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


@pytest.mark.parametrize("name", FOUND_BY_RANDOM_PAIRS)
def test_found_by_random_pairs(scene, name):
    """None of them ended with a name before."""
    fidelity, status, changes = copy.deepcopy(FOUND_BY_RANDOM_PAIRS[name])
    bearing = {f"bearing.{key}": value for key, value in changes.pop("bearing").items()}
    result = solve(scene("gyro_s1", RIGID | bearing | changes), fidelity)
    assert result.status == status
    if status == "ok":
        F = result.values["residual_preload"]
        assert_allclose(F[0] - F[1], changes["arrangement.external_axial_N"], rtol=1e-8)


def test_rough_places_alone_lead_to_the_next_without_a_slope():
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
