"""A preload is chosen by lives that follow the wear of the grooves, where `life` follows it."""

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
"""Settings with which lives follow grooves as they wear, where they wear enough."""
STIFF = DesignLimits(system_axial_stiffness_N_um=5.0)


def slip_limit(share):
    """Returns a requirement on the slip share, at the speed of the scene alone.

    share: None for no requirement.
    """
    return DesignLimits(gyroscopic_slip_share=share, at_speed_only=True)


@pytest.fixture(scope="module")
def scene():
    """Returns gyro_s1 with SETTINGS, in place of the fixture of tests/conftest.py."""
    return load_scene(scene_file("gyro_s1"), SETTINGS)


@pytest.fixture(scope="module")
def design_map(scene):
    """Returns a map of three preloads by both methods."""
    axes = MapAxes(
        preload_method=METHODS,
        friction=RisingAxis([0.08]),
        shaft_speed_rpm=RisingAxis([30000.0]),
        preload_N=RisingAxis([4.0, 7.0, 12.0]),
    )
    return preload_map(scene, axes, STIFF)


@pytest.fixture(scope="module")
def recommended(scene):
    """Returns the recommendation of both methods for a system stiffness of 5 N/um."""
    return recommendation(scene, STIFF)


BY_METHOD = pytest.mark.parametrize(("k", "method"), [*enumerate(METHODS)])


@BY_METHOD
def test_the_recommended_life_is_that_of_life(scene, recommended, k, method):
    """They are equal but for rounding and have the same criterion; files have hours."""
    point = recommended.isel(preload_method=k)
    values = life(with_method(scene, method, float(point["preload"]))).values
    assert_allclose(point["life"], values["life"] / 3600.0, rtol=1e-15)
    assert int(point["end_criterion"]) == values["end_criterion"]


@BY_METHOD
def test_a_recommendation_has_the_life_with_a_hertzian_groove_beside_its_own(
    scene, recommended, k, method
):
    """The two lives differ by more than 2 %.

    The stiffness with worn grooves is the required 5 N/um or up to 1 % more.
    """
    point = recommended.isel(preload_method=k)
    assert point["groove"] == WORN_GROOVE
    hertzian = life_point(with_method(scene, method, float(point["preload"])), None)["life"]
    assert_allclose(point["hertzian_life"], hertzian / 3600.0, rtol=1e-12)
    assert abs(float(point["life"] / point["hertzian_life"]) - 1.0) > 0.02
    assert 5e6 <= float(LIMITED["system_axial_stiffness_N_um"].worst(point)) < 5e6 * 1.01


def test_a_map_has_lives_with_grooves_as_life_follows_them(scene, design_map):
    """All points have worn grooves; the point of a constant force of 7 N has the life of `life`."""
    assert (design_map["groove"] == WORN_GROOVE).all() and (design_map["status"] == 0).all()
    point = design_map.sel(preload=7.0).isel(preload_method=0, friction=0, shaft_speed=0)
    values = life(with_method(scene, METHODS[0], 7.0)).values
    assert_allclose(point["life"], values["life"] / 3600.0, rtol=1e-15)


@BY_METHOD
def test_no_preload_of_the_map_within_the_limit_lives_longer(design_map, recommended, k, method):
    """The recommended preload of the same method has at least the longest of those lives."""
    line = design_map.isel(preload_method=k, friction=0, shaft_speed=0)
    within = line["life"].where(line["system_axial_stiffness"] >= 5e6)
    assert float(recommended["life"][k]) >= float(within.max())


def test_a_scene_of_the_paper_has_the_hertzian_groove(scene):
    """gyro_s1 itself has `model.contact: paper`: `worn_life` is None, as it follows no grooves."""
    paper = with_method(load_scene(scene_file("gyro_s1")), METHODS[0], 7.0)
    assert design_point(paper, slip_limit(0.1))["groove"] == HERTZIAN_GROOVE
    assert worn_life(paper) is None


def test_a_life_with_too_little_wear_to_change_the_contact_follows_no_groove(scene):
    """For a life that ends with a loss of 0.01 um, `worn_life` is None."""
    assert worn_life(scene.with_({"wear.end_of_life.ball_diameter_loss_um": 0.01})) is None


def test_a_life_that_ends_when_new_needs_no_groove(scene):
    """A new bearing exceeds a slip share of 0.001: the life is zero, with no wear to follow."""
    slipping = scene.with_({"wear.end_of_life.gyroscopic_slip_share": 0.001})
    assert design_point(slipping, slip_limit(None))["life"] == 0.0


@pytest.mark.parametrize("method", METHODS)
def test_quick_lives_are_those_of_life(scene, method):
    """Lives agree to 3e-3 and the least stiffness to 2 %, by fewer cells and longer steps."""
    preloaded = with_method(scene, method, 7.0)
    quick, exact = (
        design_point(preloaded, slip_limit(0.12), is_quick) for is_quick in (True, False)
    )
    assert_allclose(quick["life"], exact["life"], rtol=3e-3)
    assert quick["end_criterion"] == exact["end_criterion"]
    assert_allclose(quick["axial_stiffness"], exact["axial_stiffness"], rtol=2e-2)


@pytest.fixture(scope="module")
def preloaded(scene):
    """Returns a fixed position of 7 N, whose life ends with 40 % of the preload left."""
    return with_method(scene, "fixed_position", 7.0)


def with_limits(scene, **limits):
    """Returns a scene with other criteria of the end of life, by their names."""
    return scene.with_({f"wear.end_of_life.{name}": value for name, value in limits.items()})


@pytest.mark.parametrize("limits", [{}, {"preload_fraction": 0.3}, {"preload_fraction": 0.6}])
def test_a_life_to_the_farthest_end_has_the_lives_to_all_others(preloaded, limits):
    """The times at which it passes other ends agree to 3e-3 with lives followed to these alone."""
    farthest = with_limits(preloaded, ball_diameter_loss_um=1.4, preload_fraction=0.2)
    life_to = lives_by_end(preloaded, farthest.wear.end_of_life)
    limited = with_limits(preloaded, **limits)
    expected = design_point(limited, slip_limit(None))["life"]
    assert life_to(limited.wear.end_of_life) == pytest.approx(expected, rel=3e-3)


def test_the_time_to_an_end_met_when_new_is_zero_and_to_one_not_reached_is_nan(preloaded):
    """New bearings exceed a slip share of 1e-4; a life ends before 1 % of the preload is left."""
    life_to = lives_by_end(preloaded, preloaded.wear.end_of_life)
    assert life_to(with_limits(preloaded, gyroscopic_slip_share=1e-4).wear.end_of_life) == 0.0
    never = with_limits(preloaded, preload_fraction=0.01).wear.end_of_life
    assert np.isnan(worn_life(preloaded).time_to(Criteria(with_end(preloaded, never))))
