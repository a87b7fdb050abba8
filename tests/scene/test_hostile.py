"""Every key of a scene against values of wrong types and extreme sizes."""

import math

import pytest
from support import scene_file

from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import file_part, keys
from bearingwear.scene.read import as_scene, load_scene
from bearingwear.scene.scene import Scene, key_of_scene

HOSTILE = (
    math.nan, math.inf, -math.inf, 1e308, -1e308, 5e-324, -5e-324, 10**40, -1, 0, -0.0,
    True, None, "", "x", "nan", "1e3", " 7", [], [[]], [None], [math.nan], [1] * 1001, {}, {"": 1},
    {"a": {"b": {"c": 1}}}, b"bytes", object(), 1j,
)  # fmt: skip
PAIR = {"operation.preload_method": "fixed_position", "arrangement.kind": "rigid_pair"}
NETWORK = {
    f"thermal.conductance_W_K.{name}": 0.1
    for name in ("inner_ring_shaft", "outer_ring_housing", "ball_race")
}
KEYS = [
    key
    for key, part in keys(file_part(Scene))
    if part.kind != "block" and ".NAME" not in key and "[]" not in key
]


@pytest.fixture(scope="module")
def gyro():
    """Returns the scene gyro_s1."""
    return load_scene(scene_file("gyro_s1"))


def is_no_number(value):
    """Returns whether a value is no finite number, as True and False are none."""
    return not (type(value) in (int, float) and math.isfinite(value))


def test_every_key_of_the_schema_is_tried():
    assert len(KEYS) > 100


def test_a_hostile_value_is_refused_in_one_line_or_survives_being_read_again(gyro):
    """Only numbers are accepted as numbers, or null, which may leave out a key.

    A line has less than 400 characters, five lines of a screen.
    """
    faults = []
    for key in KEYS:
        required = {"arrangement": PAIR, "thermal": NETWORK}.get(key.partition(".")[0], {})
        start, is_number = gyro.with_(required), key_of_scene(key).kind == "number"
        for value in HOSTILE:
            try:
                scene = start.with_({key: value})
            except SceneError as error:
                if "\n" in str(error) or len(str(error)) >= 400:
                    faults.append((key, value, str(error)))
            else:
                if is_number and is_no_number(value) and value is not None:
                    faults.append((key, value, "accepted as a number"))
                if as_scene(scene.to_dict()) != scene:
                    faults.append((key, value, "changed when read again"))
    assert not faults
