"""Periodic motion found directly: against marches, and where there is none."""

import json

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.lives.life import life
from bearingwear.scene.checking.errors import NotAvailable
from bearingwear.solvers.dynamic import periodic
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.solve import solve
from bearingwear.solvers.start import start_of

BARE = {"model.history_points_per_turn": 0, "model.contact": "paper"}
RADIAL = BARE | {"operation.radial_load_N": [0.0, -1.5]}
ROTATING = BARE | {"operation.rotating_load_N": 1.0}
TILTED = BARE | {"operation.tilt_mrad": 0.3, "operation.preload_method": "fixed_position"}
TIGHT = 1e-3  # tolerance of a march that is compared with


@pytest.fixture(scope="module")
def result_of(scene):
    """Returns a function (changes, name) that solves a scene without its cage, once for each."""
    results = {}

    def solved(changes, name="gyro_s1"):
        key = json.dumps([name, changes])
        if key not in results:
            results[key] = solve(scene(name, changes).without_cage)
        return results[key]

    return solved


@pytest.mark.parametrize("changes", [RADIAL, ROTATING, TILTED], ids=["radial", "rotating", "tilt"])
def test_a_periodic_motion_has_the_qv_of_a_settled_march(scene, result_of, changes):
    """QV of inner and outer contact, the mean of all balls, over an orbit after twelve others.

    The start leaves the balls of a march unevenly spaced for good, and each with a QV of its own.
    """
    direct = result_of(changes).values
    bare = scene("gyro_s1", changes).without_cage
    system = DynamicSystem.of(bare, start_of(bare).u)
    orbit = 3.0 * direct["simulated_turns"] * system.turn  # three of nine passings are recorded
    system.advance(12.0 * orbit, TIGHT)
    before = system.qv.copy()
    system.advance(orbit, TIGHT)
    marched = (system.qv - before).mean(axis=0) / orbit
    assert_allclose(direct["qv"].mean(axis=0), marched, rtol=1e-5)
    assert direct["simulated_turns"] < 1.0


def test_all_balls_have_the_same_periodic_motion(result_of):
    values = result_of(RADIAL).values
    for name in ("qv", "maximum_contact_load", "minimum_contact_load", "orbit_speed"):
        by_ball = values[name]
        assert_allclose(by_ball, np.broadcast_to(by_ball.mean(axis=0), by_ball.shape), rtol=1e-5)
    # and yet the load of a ball changes on its way round
    assert (values["maximum_contact_load"] > 1.2 * values["minimum_contact_load"]).all()
    assert abs(values["qv_drift_per_turn"]) < 1e-6
    assert abs(values["energy_account_error"]) < 1e-5


@pytest.mark.parametrize("name, load", [("gyro_s1", 1.5), ("turbopump", 300.0)])
def test_the_estimate_covers_what_tight_steps_change(result_of, name, load):
    changes = BARE | {"operation.radial_load_N": [0.0, -load]}
    usual = result_of(changes, name).values
    tight = result_of(changes | {"model.dynamic_tolerance": 1e-5}, name).values
    error = abs(usual["total_qv"] / tight["total_qv"] - 1.0)
    assert 1e-9 < error <= usual["qv_error_estimate"]


@pytest.mark.parametrize(
    "changes, why",
    [
        ({"model.cage_results": True}, "a cage"),
        ({"wear.ball_diameter_loss_um": [0.1] * 8 + [0.2]}, "unequal ball diameters"),
        ({"operation.rotating_load_N": 1.0}, "stationary and rotating loads together"),
        ({"operation.radial_load_N": [0.0, 0.0], "model.fidelity": "dynamic"}, "pure thrust"),
    ],
)
def test_scenes_without_a_periodic_motion_are_refused(scene, changes, why):
    periodic_scene = scene("gyro_s1", RADIAL | {"model.dynamic_solution": "periodic"} | changes)
    if not periodic_scene.model.cage_results:
        periodic_scene = periodic_scene.without_cage
    with pytest.raises(NotAvailable, match=f"dynamic_solution: got periodic with {why}, expected"):
        solve(periodic_scene)


def test_without_a_periodic_motion_a_scene_has_a_status_or_is_marched(scene, monkeypatch):
    """With `periodic` it has not converged; by default it is marched. No motion is accepted."""
    monkeypatch.setattr(periodic, "ACCEPTED", 0.0)
    monkeypatch.setattr(periodic, "MARCHED", (0.0, 1.0))
    of_scene = solve(scene("gyro_s1", RADIAL | {"model.dynamic_solution": "periodic"}).without_cage)
    assert of_scene.status == "not_converged" and "periodic" in of_scene.attrs["residual"]
    marched = solve(scene("gyro_s1", RADIAL).without_cage)
    assert marched.status == "ok" and "steady state" in marched.attrs["start"]


def test_a_run_continues_from_a_periodic_motion(scene, result_of):
    """At its end each ball is back where it was, at a later time."""
    first = result_of(ROTATING).values
    again = solve(
        scene("gyro_s1", ROTATING).without_cage,
        restart={"state": first["final_state"], "time": first["final_time"]},
    ).values
    assert_allclose(again["total_qv"], first["total_qv"], rtol=1e-6)
    assert again["final_time"] == pytest.approx(2.0 * first["final_time"], rel=1e-5)


def test_dynamic_lives_use_the_periodic_motion(scene):
    """Each run takes less than three turns, is stable, and wears all balls alike."""
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 0.3}, "model.life_steps": 2}
    values = life(scene("gyro_s1", RADIAL | end).without_cage).values
    assert max(values["history_simulated_turns"]) < 3.0
    assert max(values["history_disturbance_growth_per_turn"]) < 0.0
    worn = values["history_worn_diameter"]
    assert_allclose(worn, worn[:, :1].repeat(9, axis=1), rtol=1e-5)
    # the steady life is that of thrust alone: the radial load changes it by less than a half
    assert 0.5 < np.nanmax(values["life"]) / values["steady_life"] < 1.5
