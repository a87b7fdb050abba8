"""Scenes that once failed, and the status or state that they end with now."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import scene_file

from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.solvers.solve import solve

STEEP = {"bearing.contact_angle_deg": 40.0, "bearing.inner_groove_factor": 0.515}


def solved(changes, fidelity=None):
    """Returns the result of gyro_s1 with changes, and without its cage, which would not fit all."""
    base = load_scene(scene_file("gyro_s1")).to_dict()
    del base["cage"]
    for key, value in changes.items():
        block, _, leaf = key.partition(".")
        base[block][leaf] = value
    return solve(scene_from_dict(base), fidelity)


@pytest.mark.parametrize("speed", [44000.0, 45000.0, 48000.0])
def test_a_ball_at_a_steep_angle_stays_in_its_groove(speed):
    """Grooves are circles to the equations, which have a state beyond 90 degrees, too.

    There the ball would orbit with the shaft, not at about half of its speed.
    """
    values = solved(STEEP | {"operation.shaft_speed_rpm": speed}).values
    assert np.degrees(values["contact_angle"]).max() < 65.0
    assert values["orbit_speed"][0] < 0.6 * speed * np.pi / 30


def test_a_ball_that_leaves_its_groove_has_a_status():
    assert solved(STEEP | {"operation.shaft_speed_rpm": 55000.0}).status == "beyond_groove"


@pytest.mark.parametrize("preload", [700.0, 3000.0])
@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
def test_ellipses_too_large_for_hertz_are_refused(preload, fidelity):
    changes = {"bearing.inner_groove_factor": 0.505, "operation.preload_N": preload}
    assert solved(changes, fidelity).status == "outside_hertz_range"


@pytest.mark.parametrize("fidelity", ["steady", "race_control"])
def test_a_spring_keeps_its_preload(fidelity):
    """7 N, of which friction carries a part under inner control."""
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
    """A loss of 5 um is more than twice the displacement by 7 N, which the spring follows."""
    result = solved(changes | {"wear.ball_diameter_loss_um": 5.0}, "race_control")
    assert result.status == "ok"
    assert_allclose(result.values["residual_preload"], 7.0, rtol=1e-9)


@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_a_tilted_race_at_low_speed_is_solved(method):
    """Unloaded balls under inner control have no equilibrium; they keep outer control."""
    changes = {
        "operation.shaft_speed_rpm": 100.0,
        "operation.tilt_mrad": 2.0,
        "operation.preload_method": method,
    }
    assert solved(changes, "race_control").status == "ok"
