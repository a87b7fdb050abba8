"""A preload is chosen by lives with grooves that are followed as they wear, where `life` does."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import scene_file

from bearingwear.lives.ends import Criteria, with_end
from bearingwear.lives.life import life
from bearingwear.lives.many import lives_by_end, worn_life
from bearingwear.measures import LIMITED
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.read import load_scene
from bearingwear.studies.axis import RisingAxis
from bearingwear.studies.design.map import (
    HERTZIAN_GROOVE,
    WORN_GROOVE,
    design_point,
    life_point,
)
from bearingwear.studies.design.plan import DesignLimits, MapAxes
from bearingwear.studies.design.recommend import preload_map, recommendation

METHODS = ("constant_force", "fixed_position")
SETTINGS = ["model.contact=auto", "model.normal_balance=frictionless"]
STIFF = DesignLimits(system_axial_stiffness_N_um=5.0)


def at_speed(share):
    return DesignLimits(gyroscopic_slip_share=share, at_speed_only=True)


@pytest.fixture(scope="module")
def scene():
    """The studied bearing, its grooves followed where that is required."""
    return load_scene(scene_file("gyro_s1"), SETTINGS)


@pytest.fixture(scope="module")
def map_and_recommendation(scene):
    """Map and recommendation."""
    axes = MapAxes(
        preload_method=METHODS,
        friction=RisingAxis([0.08]),
        shaft_speed_rpm=RisingAxis([30000.0]),
        preload_N=RisingAxis([4.0, 7.0, 12.0]),
    )
    return preload_map(scene, axes, STIFF), recommendation(scene, STIFF)


def test_recommended_life_is_what_life_finds(scene, map_and_recommendation):
    """To the last bit."""
    _, chosen = map_and_recommendation
    for k, method in enumerate(METHODS):
        point = chosen.isel(preload_method=k)
        values = life(with_method(scene, method, float(point["preload"]))).values
        assert_allclose(point["life"], values["life"] / 3600.0, rtol=1e-15)
        assert int(point["end_criterion"]) == values["end_criterion"]


def test_lives_with_both_grooves(scene, map_and_recommendation):
    design, chosen = map_and_recommendation
    assert (chosen["groove"] == WORN_GROOVE).all()
    for k, method in enumerate(METHODS):
        point = chosen.isel(preload_method=k)
        hertzian = life_point(with_method(scene, method, float(point["preload"])), None)["life"]
        assert_allclose(point["hertzian_life"], hertzian / 3600.0, rtol=1e-12)
        assert abs(float(point["life"] / point["hertzian_life"]) - 1.0) > 0.02
        # the choice is within the limit by the groove as it wears, and on it
        assert 5e6 <= float(LIMITED["system_axial_stiffness_N_um"].worst(point)) < 5e6 * 1.01
    assert (design["groove"] == WORN_GROOVE).all() and (design["status"] == 0).all()


def test_the_map_is_of_lives_as_life_prints_them(scene, map_and_recommendation):
    design, chosen = map_and_recommendation
    line = design.isel(friction=0, shaft_speed=0)
    values = life(with_method(scene, METHODS[0], 7.0)).values
    assert_allclose(line["life"][0, 1], values["life"] / 3600.0, rtol=1e-15)
    # no preload of the map within the limit lasts longer
    for k in range(2):
        within = line.isel(preload_method=k)
        within = within["life"].where(within["system_axial_stiffness"] >= 5e6)
        assert float(chosen["life"][k]) >= float(within.max())


def test_scenes_that_follow_no_groove_have_the_hertzian_one(scene):
    paper = with_method(load_scene(scene_file("gyro_s1")), METHODS[0], 7.0)
    assert design_point(paper, at_speed(0.1))["groove"] == HERTZIAN_GROOVE
    assert worn_life(paper) is None
    few = scene.with_({"wear.end_of_life.ball_diameter_loss_um": 0.01})
    assert worn_life(few) is None  # too little wear for the contact to feel
    # what is beyond a limit when new needs no groove
    slippery = scene.with_({"wear.end_of_life.gyroscopic_slip_share": 0.001})
    assert design_point(slippery, at_speed(None))["life"] == 0.0


def test_quick_lives_are_those_of_life(scene):
    """Fewer cells and longer steps: 3e-3 of the life, and 2 % of the minimum stiffness."""
    for method in METHODS:
        at = with_method(scene, method, 7.0)
        quick, whole = (design_point(at, at_speed(0.12), q) for q in (True, False))
        assert_allclose(quick["life"], whole["life"], rtol=3e-3)
        assert quick["end_criterion"] == whole["end_criterion"]
        assert_allclose(quick["axial_stiffness"], whole["axial_stiffness"], rtol=2e-2)


def test_one_march_has_the_lives_of_all_ends(scene):
    """Against lives that are followed to each end anew."""
    at = with_method(scene, "fixed_position", 7.0)
    end = at.wear.end_of_life
    loose = {"ball_diameter_loss_um": 1.4, "preload_fraction": 0.2}
    farthest = at.with_({f"wear.end_of_life.{k}": v for k, v in loose.items()}).wear.end_of_life
    lived = lives_by_end(at, farthest)
    for changes in ({}, {"preload_fraction": 0.3}, {"preload_fraction": 0.6}):
        moved = at.with_({f"wear.end_of_life.{k}": v for k, v in changes.items()})
        anew = design_point(moved, at_speed(None))["life"]
        assert lived(moved.wear.end_of_life) == pytest.approx(anew, rel=3e-3)
    beyond = at.with_({"wear.end_of_life.gyroscopic_slip_share": 1e-4}).wear.end_of_life
    assert lived(beyond) == 0.0
    history = worn_life(at)
    assert history is not None
    never = at.with_({"wear.end_of_life.preload_fraction": 0.01}).wear.end_of_life
    assert np.isnan(history.time_to(Criteria(with_end(at, never)))) and end.preload_fraction == 0.4
