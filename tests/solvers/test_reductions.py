"""What `fidelity: auto` leaves out, against the fuller model, within the tolerance claimed.

The claims are those of docs/accuracy.md, "What a scene requires"; `benchmarks/reductions.py`
measures what each saves.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.kernels.status import OK
from bearingwear.solvers.effects.choice import choice
from bearingwear.solvers.effects.motion import centrifugal_share
from bearingwear.solvers.solve import solve

FEW = {"model.simulated_turns": 8, "model.history_points_per_turn": 0}
MANY = {"model.strips": 100, "model.points_across": 32}
PRECISE = FEW | {"model.dynamic_tolerance": 1e-3}


@pytest.mark.parametrize("name", ["gyro_s1", "gyro_s1_drag", "turbopump"])
@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_under_thrust_one_steady_ball_stands_for_all_in_motion(scene, name, method):
    """Numbers agree to 1e-5, by the tolerance of the steps in time, QV of single contacts to 1e-4.

    The scene has many points (MANY), because the two models place theirs differently over the
    ellipse.
    """
    alike = {"operation.preload_method": method, "model.normal_balance": "with_traction"} | MANY
    s = replace(scene(name, PRECISE | alike), cage=None)
    assert choice(s).fidelity == "steady"
    reduced, full = solve(s).values, solve(s, "dynamic").values
    assert full["status"] == OK
    for key in ("total_qv", "residual_preload", "shaft_torque", "ball_diameter_loss_rate"):
        assert_allclose(reduced[key], full[key], rtol=1e-5, err_msg=key)
    of_one_ball = np.broadcast_to(reduced["qv"], full["qv"].shape)
    assert_allclose(of_one_ball, full["qv"], rtol=1e-4, atol=1e-9)


@pytest.mark.parametrize("name", ["gyro_s1", "gyro_s1_drag"])
def test_without_its_cage_a_scene_has_the_claimed_qv_and_loss_rate(scene, name):
    """It has QV within 1 %, and the loss rate that counts balls and races within 2 %.

    The balls' wear in the pockets is left out with the cage: 8 % of what they lose in the first
    twenty turns of gyro_s1.
    """
    changes = {"operation.rotating_load_N": 1.0, "model.simulated_turns": 20}
    s = scene(name, changes)
    assert choice(s).fidelity == "dynamic" and not choice(s).cage
    reduced, full = solve(s).values, solve(s, "dynamic").values
    assert "cage_wear_rate" in full and "cage_wear_rate" not in reduced
    assert_allclose(reduced["total_qv"], full["total_qv"], rtol=0.01)
    loss_rate = full["ball_diameter_loss_rate"]
    assert_allclose(reduced["ball_diameter_loss_rate"], loss_rate, rtol=0.02)
    without_pockets, with_pockets = (v["ball_wear_rate"].mean() for v in (reduced, full))
    assert 0.85 * with_pockets < without_pockets < with_pockets
    assert reduced["total_qv"] != full["total_qv"]  # the cage does change something


@pytest.mark.parametrize("name", ["gyro_s1", "gyro_s1_drag", "turbopump", "bearing218"])
def test_the_estimated_centrifugal_force_is_right_within_a_factor_of_two(scene, name):
    """It is stated before any solve, by kinematics at the free contact angle."""
    s = scene(name)
    values = solve(s, "steady").values
    load = values["contact_load"].mean()
    assert 0.5 < centrifugal_share(s) / (values["centrifugal_force"][0] / load) < 2.0
