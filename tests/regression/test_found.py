"""Scenes that once failed; each line says how."""

import pytest
from support import scene_file

from bearingwear.io.config import load_scene, scene_from_dict
from bearingwear.model.solve import solve

FOUND = {
    # A ball hanging nearly slack between the grooves: Newton's steps stretched the string.
    "slack ball": {
        "operation.preload_method": "fixed_position",
        "operation.shaft_speed_rpm": 7782.993641255683,
        "operation.preload_N": 8.955328363895358,
        "friction.ball_race": 0.09873174419423836,
        "bearing.contact_angle_deg": 30.013420618940764,
        "wear.ball_diameter_loss_um": 0.6814235358890226,
        "lubricant.drag_density_kg_m3": 92.22285167637554,
    },
    # Outer control has no equilibrium at the start of the race's Newton.
    "large gyroscopic moments": {
        "operation.shaft_speed_rpm": 58046.62324378757,
        "operation.preload_N": 5.179024546908266,
        "bearing.contact_angle_deg": 36.798916456957755,
        "operation.radial_load_N": [0.0, 2.2449209918645936],
    },
    # Race control left out of the tangent converged by a factor a step, and stopped too early.
    "slow convergence": {
        "operation.preload_method": "fixed_position",
        "operation.shaft_speed_rpm": 27000.44380562422,
        "operation.preload_N": 3.2379087403063647,
        "bearing.contact_angle_deg": 30.448828955219142,
        "wear.ball_diameter_loss_um": 0.4071181816463284,
        "operation.radial_load_N": [0.0, 0.05900416423607213],
    },
    # Newton went on for fifty steps at rounding level and then gave up a solved state.
    "rounding": {
        "operation.preload_method": "fixed_position",
        "operation.shaft_speed_rpm": 19785.387275887268,
        "operation.preload_N": 16.906922598696795,
        "friction.ball_race": 0.08220055384210345,
        "bearing.contact_angle_deg": 15.596468969367855,
        "wear.ball_diameter_loss_um": 0.09506809229218618,
    },
    # No contact at the orbit rate of pure rolling; a skidding ball keeps it.
    "skidding on the brink": {
        "operation.preload_method": "fixed_position",
        "wear.ball_diameter_loss_um": 37.976,
    },
}


@pytest.mark.parametrize("name", FOUND)
def test_is_solved_now(name):
    base = load_scene(scene_file("gyro_s1")).to_dict()
    del base["cage"]  # it would not fit every one of these
    for key, value in FOUND[name].items():
        block, _, leaf = key.partition(".")
        base[block][leaf] = value
    assert solve(scene_from_dict(base)).status == "ok"
