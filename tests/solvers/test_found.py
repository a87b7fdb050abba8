"""Scenes that once failed; each line says how."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import scene_file

from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.solvers.solve import solve

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


STEEP = {"bearing.contact_angle_deg": 40.0, "bearing.inner_groove_factor": 0.515}


def solved(changes, fidelity=None):
    base = load_scene(scene_file("gyro_s1")).to_dict()
    del base["cage"]  # it would not fit every one of these
    for key, value in changes.items():
        block, _, leaf = key.partition(".")
        base[block][leaf] = value
    return solve(scene_from_dict(base), fidelity)


@pytest.mark.parametrize("speed", [44000.0, 45000.0, 48000.0])
def test_ball_stays_in_its_groove(speed):
    """Grooves are circles to the equations: a verified state beyond 90 degrees is none."""
    values = solved(STEEP | {"operation.shaft_speed_rpm": speed}).values
    assert np.degrees(values["contact_angle"]).max() < 65.0
    assert values["orbit_speed"][0] < 0.6 * speed * np.pi / 30


def test_ball_that_leaves_its_groove_is_named():
    assert solved(STEEP | {"operation.shaft_speed_rpm": 55000.0}).status == "beyond_groove"


@pytest.mark.parametrize("preload", [700.0, 3000.0])
def test_race_control_refuses_large_ellipses_too(preload):
    changes = {"bearing.inner_groove_factor": 0.505, "operation.preload_N": preload}
    for fidelity in ("steady", "race_control"):
        assert solved(changes, fidelity).status == "outside_hertz_range"


@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
def test_a_spring_keeps_its_preload(fidelity):
    """Under inner control part of the axial force is friction; it counts."""
    values = solved({}, fidelity).values
    assert_allclose(values["residual_preload"], 7.0, rtol=1e-9)


@pytest.mark.parametrize(
    "changes",
    [
        {"operation.shaft_speed_rpm": 0.0, "operation.radial_load_N": [0.0, 1.0]},
        {"operation.radial_load_N": [0.0, 0.05]},
    ],
)
def test_worn_balls_under_a_spring_stay_loaded(changes):
    result = solved(changes | {"wear.ball_diameter_loss_um": 5.0}, "race_control")
    assert result.status == "ok"
    assert_allclose(result.values["residual_preload"], 7.0, rtol=1e-9)


@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_tilted_race_at_low_speed(method):
    """Unloaded balls under inner control have no equilibrium; they keep outer control."""
    changes = {
        "operation.shaft_speed_rpm": 100.0,
        "operation.tilt_mrad": 2.0,
        "operation.preload_method": method,
    }
    assert solved(changes, "race_control").status == "ok"


@pytest.mark.parametrize("name", FOUND)
def test_is_solved_now(name):
    changes = FOUND[name]
    fidelity = "race_control" if "operation.radial_load_N" in changes else "steady"
    assert solved(changes, fidelity).status == "ok"
