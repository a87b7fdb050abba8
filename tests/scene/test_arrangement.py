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
    return load_scene(scene_file(name), settings)


def test_keys_of_the_second_bearing_change_it_alone():
    """Keys may stand as one, or as blocks; what they leave alone is as in the first."""
    flat = read(*RIGID, f"arrangement.second={{{LOSS}: 0.25, friction.ball_race: 0.1}}")
    nested = read(
        *RIGID, f"arrangement.second.{LOSS}=0.25", "arrangement.second.friction.ball_race=0.1"
    )
    assert flat == nested
    first, second = flat.sides
    assert (first.friction.ball_race, second.friction.ball_race) == (0.08, 0.1)
    assert (first.wear.ball_diameter_loss_um, second.wear.ball_diameter_loss_um) == ((0,), (0.25,))
    assert first.pair is None and second.pair is None
    assert second.bearing == first.bearing
    with_each_loss = read(
        *RIGID, f"arrangement.second={{{LOSS}: [{', '.join(map(str, range(1, 10)))}]}}"
    )
    assert with_each_loss.sides[1].wear.ball_diameter_loss_um == tuple(range(1, 10))


def test_scene_of_a_pair_is_whole():
    result = read(*RIGID, f"arrangement.second={{{LOSS}: 0.25}}", "arrangement.span_mm=20")
    assert as_scene(result.to_dict()) == result == as_scene(result)
    assert pickle.loads(pickle.dumps(result)) == copy.deepcopy(result) == result
    assert hash(result) == hash(as_scene(result.to_dict()))
    assert hash(result) != hash(read(*RIGID))
    assert result.sides[0].arrangement.span_mm == 20.0


def test_held_by_another_method():
    rigid = read(*RIGID, "arrangement.external_axial_N=2")
    spring = with_method(rigid, "constant_force", 9.0)
    assert spring.arrangement.kind == "spring_pair"
    assert spring.arrangement.external_axial_N == 2.0
    assert spring.operation.preload_N == 9.0
    soft = read("arrangement.kind=spring_pair", "arrangement.spring_stiffness_N_um=0.1")
    assert with_method(soft, "fixed_position").arrangement.spring_stiffness_N_um == 0.0
    assert with_method(read(), "fixed_position").arrangement is None


def test_dynamic_cases_of_a_study_are_of_one_bearing():
    assert single_bearing_scene(read(), "x").pair is None
    with pytest.raises(SceneError, match="arrangement.kind: got rigid_pair"):
        single_bearing_scene(read(*RIGID), "mine.yaml")
