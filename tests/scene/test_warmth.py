"""Temperatures, thermal network and fits: what contradicts the rest is refused in one line."""

import pytest

from bearingwear.scene.checking.errors import SceneError

NETWORK = {
    "thermal.conductance_W_K.inner_ring_shaft": 0.1,
    "thermal.conductance_W_K.outer_ring_housing": 0.1,
    "thermal.conductance_W_K.ball_race": 0.05,
}
STEEL = "materials.bearing_steel.thermal_expansion_1_K"
REFUSED = [
    ({"temperature.inner_ring_C": 1001}, "temperature.inner_ring_C: got 1001, expected"),
    ({"temperature.inner_ring_C": -274}, "temperature.inner_ring_C: got -274, expected"),
    ({"temperature.outer_ring_C": "hot"}, "temperature.outer_ring_C: got 'hot'"),
    ({"temperature.balls_C": float("nan")}, "temperature.balls_C: got .nan"),
    ({"temperature.shaft_C": float("inf")}, "temperature.shaft_C: got .inf"),
    ({"temperature.housing_C": True}, "temperature.housing_C: got true"),
    ({"temperature.housing_C": 1000.0, STEEL: 2e-5}, "temperature.housing_C: got a temper"),
    ({"temperature.reference_C": [20]}, "temperature.reference_C: got a list"),
    ({"temperature.ring_C": 20}, "temperature.ring_C: got an unknown key"),
    ({"temperature.inner_ring_C": 30} | NETWORK, "thermal: got thermal and temperature"),
    (NETWORK | {"thermal.shaft_C": 1e9}, "thermal.shaft_C: got 1"),
    (NETWORK | {"thermal.housing_C": "x"}, "thermal.housing_C: got 'x'"),
    (NETWORK | {"thermal.reference_C": None}, "thermal.reference_C: "),
    ({"thermal.shaft_C": 20.0}, "thermal.conductance_W_K: got nothing"),
    ({**NETWORK, "thermal.conductance_W_K.ball_race": 0.0}, "thermal.conductance_W_K.ball_race"),
    ({**NETWORK, "thermal.conductance_W_K.inner_ring_shaft": -1}, "thermal.conductance_W_K.inner"),
    (
        {**NETWORK, "thermal.conductance_W_K.outer_ring_housing": 1e7},
        "thermal.conductance_W_K.outer_ring_housing: got 1",
    ),
    (
        {"bearing.inner_groove_factor": 0.501, "temperature.inner_ring_C": -250},
        "temperature.inner_ring_C: got -250 with balls of 20 degC; only allowed where the groove",
    ),
    (
        {"bearing.outer_groove_factor": 0.503, "temperature.balls_C": 600},
        "temperature.outer_ring_C: got 20 with balls of 600 degC; only allowed where",
    ),
    ({STEEL: -1e-6}, f"{STEEL}: got -1"),
    ({STEEL: 1e-3}, f"{STEEL}: got 0.001"),
    ({"fits.shaft_interference_um": 5}, "fits.shaft_interference_um: got 5; only allowed with"),
    ({"fits.housing_interference_um": 5}, "fits.housing_interference_um: got 5; only allowed"),
    ({"fits.shaft_bore_mm": 2}, "fits.shaft_bore_mm: got 2; only allowed with bearing.bore_mm"),
    ({"fits.shaft_interference_um": 1e4}, "fits.shaft_interference_um: got 1"),
    (
        {"fits.shaft_interference_um": 100, "bearing.bore_mm": 4.0},
        "fits.shaft_interference_um: got 100, expected a number from -40 to 40",
    ),
    (
        {"fits.shaft_bore_mm": 4.0, "bearing.bore_mm": 4.0},
        "fits.shaft_bore_mm: got 4, expected a number < 4",
    ),
    ({"fits.shaft_bore_mm": -1.0}, "fits.shaft_bore_mm: got -1"),
    ({"fits.shaft_material": "cheese"}, "fits.shaft_material: got 'cheese', not under materials"),
    ({"fits.housing_material": 3}, "fits.housing_material: got 3"),
    (
        {"fits.housing_material": "phenolic", "temperature.housing_C": 30},
        "materials.phenolic.thermal_expansion_1_K: got nothing, with temperatures",
    ),
    ({"bearing.bore_mm": 0.0}, "bearing.bore_mm: got 0"),
    ({"bearing.bore_mm": 5.5}, "bearing.bore_mm: got 5.5"),
]


@pytest.mark.parametrize(("changes", "message"), REFUSED)
def test_refused_in_one_line(scene, changes, message):
    with pytest.raises(SceneError) as caught:
        scene("gyro_s1", changes)
    said = str(caught.value)
    assert message in said and "\n" not in said


def test_what_is_left_out_stays_away(scene):
    plain = scene("gyro_s1").to_dict()
    assert not {"temperature", "thermal", "fits"} & plain.keys()
    assert "thermal_expansion_1_K" not in plain["materials"]["bearing_steel"]


def test_a_warm_scene_is_the_same_when_read_again(scene):
    warm = scene("gyro_s1", NETWORK | {"bearing.bore_mm": 4.0, "fits.shaft_bore_mm": 1.0})
    assert warm.with_({}) == warm and hash(warm.with_({})) == hash(warm)
    assert warm.to_dict()["thermal"]["conductance_W_K"]["ball_race"] == 0.05
