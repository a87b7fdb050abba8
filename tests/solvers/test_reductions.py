"""What `fidelity: auto` leaves out, against the fuller model, within the tolerance claimed.

The claims are those of docs/accuracy.md, "What a scene requires"; `benchmarks/reductions.py`
measures what each saves.
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.solvers.effects.choice import choice
from bearingwear.solvers.effects.motion import centrifugal_share
from bearingwear.solvers.solve import solve

FEW = {"model.simulated_turns": 8, "model.history_points_per_turn": 0}
MANY = {"model.strips": 100, "model.points_across": 32}
PRECISE = FEW | {"model.dynamic_tolerance": 1e-3}


@pytest.mark.parametrize("name", ["gyro_s1", "gyro_s1_drag", "turbopump"])
@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_one_ball_steady_against_all_in_time(scene, name, method):
    # Thrust alone: claimed to be the same, to the tolerance of a step. With points enough: over the
    # ellipse the two do not take the same.
    alike = {"operation.preload_method": method, "model.normal_balance": "with_traction"} | MANY
    s = replace(scene(name, PRECISE | alike), cage=None)
    assert choice(s).fidelity == "steady"
    reduced, full = solve(s).values, solve(s, "dynamic").values
    assert full["status"] == 0
    for key in ("total_qv", "residual_preload", "shaft_torque"):
        assert_allclose(reduced[key], full[key], rtol=1e-5)
    assert_allclose(reduced["ball_diameter_loss_rate"], full["ball_diameter_loss_rate"], rtol=1e-5)
    assert_allclose(
        np.broadcast_to(reduced["qv"], full["qv"].shape), full["qv"], rtol=1e-4, atol=1e-9
    )


@pytest.mark.parametrize("name, load", [("gyro_s1", 1.0), ("gyro_s1_drag", 1.0)])
def test_the_cage_left_out(scene, name, load):
    # Claimed: 1 % of QV, 2 % of the loss rate that counts balls and races. The balls' wear in the
    # pockets is left out with the cage: 8 % of what they lose in the first twenty turns of S1.
    changes = {"operation.rotating_load_N": load, "model.simulated_turns": 20}
    s = scene(name, changes)
    assert choice(s).fidelity == "dynamic" and not choice(s).cage
    reduced, full = solve(s).values, solve(s, "dynamic").values
    assert "cage_wear_rate" in full and "cage_wear_rate" not in reduced
    assert_allclose(reduced["total_qv"], full["total_qv"], rtol=0.01)
    rate, other = reduced["ball_diameter_loss_rate"], full["ball_diameter_loss_rate"]
    assert_allclose(rate, other, rtol=0.02)
    balls, in_pockets = reduced["ball_wear_rate"].mean(), full["ball_wear_rate"].mean()
    assert 0.85 * in_pockets < balls < in_pockets
    assert reduced["total_qv"] != full["total_qv"]  # and it is a reduction


@pytest.mark.parametrize("name", ["gyro_s1", "gyro_s1_drag", "turbopump", "bearing218"])
def test_estimated_forces(scene, name):
    # Stated before any solve as kinematics at the free contact angle: right within a factor 2.
    s = scene(name)
    values = solve(s, "steady").values
    load = values["contact_load"].mean()
    assert 0.5 < centrifugal_share(s) / (values["centrifugal_force"][0] / load) < 2.0
