"""The block `arrangement`."""

import copy
import pickle

import pytest
from support import scene_file

from bearingwear.scene.arrangement import single_bearing_scene, with_method
from bearingwear.scene.read import SceneError, as_scene, load_scene

FIXED = "operation.preload_method=fixed_position"
RIGID = (FIXED, "arrangement.kind=rigid_pair")
LOSS = "wear.ball_diameter_loss_um"


def read(*settings, name="gyro_s1"):
    """Returns a scene of the project with settings, as texts KEY=VALUE."""
    return load_scene(scene_file(name), settings)


def test_keys_of_the_second_bearing_change_it_alone():
    """All other keys are as in the first bearing."""
    second_keys = f"arrangement.second={{{LOSS}: 0.25, friction.ball_race: 0.1}}"
    first, second = read(*RIGID, second_keys).sides
    assert (first.friction.ball_race, second.friction.ball_race) == (0.08, 0.1)
    assert (first.wear.ball_diameter_loss_um, second.wear.ball_diameter_loss_um) == ((0,), (0.25,))
    assert first.pair is None and second.pair is None
    assert second.bearing == first.bearing


def test_keys_of_the_second_bearing_may_stand_with_dots_or_as_blocks():
    with_dots = read(*RIGID, f"arrangement.second={{{LOSS}: 0.25, friction.ball_race: 0.1}}")
    as_blocks = read(
        *RIGID, f"arrangement.second.{LOSS}=0.25", "arrangement.second.friction.ball_race=0.1"
    )
    assert with_dots == as_blocks


def test_the_second_bearing_may_have_a_loss_for_each_ball():
    scene = read(*RIGID, f"arrangement.second={{{LOSS}: [1, 2, 3, 4, 5, 6, 7, 8, 9]}}")
    assert scene.sides[1].wear.ball_diameter_loss_um == tuple(range(1, 10))


def test_a_scene_of_a_pair_is_a_value():
    """A scene that is read again, pickled or copied is equal to it and has the same hash."""
    scene = read(*RIGID, f"arrangement.second={{{LOSS}: 0.25}}", "arrangement.span_mm=20")
    assert as_scene(scene.to_dict()) == scene == as_scene(scene)
    assert pickle.loads(pickle.dumps(scene)) == copy.deepcopy(scene) == scene
    assert hash(scene) == hash(as_scene(scene.to_dict()))
    assert hash(scene) != hash(read(*RIGID))
    assert scene.sides[0].arrangement.span_mm == 20.0


def test_a_rigid_pair_with_constant_force_becomes_a_spring_pair():
    rigid = read(*RIGID, "arrangement.external_axial_N=2")
    spring = with_method(rigid, "constant_force", 9.0)
    assert spring.arrangement.kind == "spring_pair"
    assert spring.arrangement.external_axial_N == 2.0
    assert spring.operation.preload_N == 9.0


def test_a_spring_pair_with_fixed_position_has_no_spring():
    soft = read("arrangement.kind=spring_pair", "arrangement.spring_stiffness_N_um=0.1")
    assert with_method(soft, "fixed_position").arrangement.spring_stiffness_N_um == 0.0


def test_a_single_bearing_with_fixed_position_stays_single():
    assert with_method(read(), "fixed_position").arrangement is None


def test_a_scene_with_a_pair_is_refused_where_a_single_bearing_is_needed():
    assert single_bearing_scene(read(), "mine.yaml").pair is None
    with pytest.raises(SceneError, match="arrangement.kind: got rigid_pair"):
        single_bearing_scene(read(*RIGID), "mine.yaml")
