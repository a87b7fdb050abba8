"""Every key of a scene against values that nobody should give it."""

import math

import pytest
from support import scene_file

from bearingwear.scene.errors import SceneError
from bearingwear.scene.keys import scene_keys
from bearingwear.scene.read import as_scene, load_scene
from bearingwear.scene.scene import key_of_scene

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
KEYS = [key for key in scene_keys() if ".NAME" not in key and "[]" not in key]


@pytest.fixture(scope="module")
def base():
    return load_scene(scene_file("gyro_s1"))


@pytest.mark.parametrize("key", KEYS)
def test_one_line_or_a_scene(base, key):
    """Each is refused in one line, or a scene that is the same when it is read again."""
    around = PAIR if key.startswith("arrangement.") else {}
    around = NETWORK if key.startswith("thermal.") else around
    start, refused = base.with_(around), 0
    for value in HOSTILE:
        try:
            made = start.with_({key: value})
        except SceneError as error:
            said = str(error)
            assert "\n" not in said and len(said) < 400, (value, said)
            refused += 1
        else:
            assert as_scene(made.to_dict()) == made, value
    assert refused > len(HOSTILE) // 3


@pytest.mark.parametrize("key", [key for key in KEYS if key_of_scene(key).kind == "number"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, "x", True, [1.0, 2.0], {"a": 1}])
def test_what_is_no_number_is_refused(base, key, value):
    around = PAIR if key.startswith("arrangement.") else {}
    with pytest.raises(SceneError):
        base.with_(around | {key: value})


def test_keys_there_are():
    """The keys of the newer blocks are among them."""
    for key in ("arrangement.tandem", "temperature.balls_C", "fits.shaft_bore_mm",
                "thermal.conductance_W_K.ball_race", "bearing.outer_shoulder_mm",
                "wear.end_of_life.rotor_shift_um", "operation.gravity_m_s2"):  # fmt: skip
        assert key in KEYS
