"""Temperatures, thermal network and fits: what contradicts the rest is refused in one line."""

import pytest

from bearingwear.scene.errors import SceneError

NETWORK = {
    "thermal.conductance_W_K.inner_ring_shaft": 0.1,
    "thermal.conductance_W_K.outer_ring_housing": 0.1,
    "thermal.conductance_W_K.ball_race": 0.05,
}
STEEL = "materials.bearing_steel.thermal_expansion_1_K"
REFUSED = [
    ({"temperature.inner_ring_C": 1001}, "temperature.inner_ring_C: given 1001; allowed"),
    ({"temperature.inner_ring_C": -274}, "temperature.inner_ring_C: given -274; allowed"),
    ({"temperature.outer_ring_C": "hot"}, "temperature.outer_ring_C: given 'hot'"),
    ({"temperature.balls_C": float("nan")}, "temperature.balls_C: given .nan"),
    ({"temperature.shaft_C": float("inf")}, "temperature.shaft_C: given .inf"),
    ({"temperature.housing_C": True}, "temperature.housing_C: given true"),
    ({"temperature.housing_C": 1000.0, STEEL: 2e-5}, "temperature.housing_C: given a temper"),
    ({"temperature.reference_C": [20]}, "temperature.reference_C: given a list"),
    ({"temperature.ring_C": 20}, "temperature.ring_C: given an unknown key"),
    ({"temperature.inner_ring_C": 30} | NETWORK, "thermal: given with temperature"),
    (NETWORK | {"thermal.shaft_C": 1e9}, "thermal.shaft_C: given 1"),
    (NETWORK | {"thermal.housing_C": "x"}, "thermal.housing_C: given 'x'"),
    (NETWORK | {"thermal.reference_C": None}, "thermal.reference_C: "),
    ({"thermal.shaft_C": 20.0}, "thermal.conductance_W_K: given nothing"),
    ({**NETWORK, "thermal.conductance_W_K.ball_race": 0.0}, "thermal.conductance_W_K.ball_race"),
    ({**NETWORK, "thermal.conductance_W_K.inner_ring_shaft": -1}, "thermal.conductance_W_K.inner"),
    (
        {**NETWORK, "thermal.conductance_W_K.outer_ring_housing": 1e7},
        "thermal.conductance_W_K.outer_ring_housing: given 1",
    ),
    (
        {"bearing.inner_groove_factor": 0.501, "temperature.inner_ring_C": -250},
        "temperature.inner_ring_C: given -250 with balls of 20 degC; allowed only where the groove",
    ),
    (
        {"bearing.outer_groove_factor": 0.503, "temperature.balls_C": 600},
        "temperature.outer_ring_C: given 20 with balls of 600 degC; allowed only where",
    ),
    ({STEEL: -1e-6}, f"{STEEL}: given -1"),
    ({STEEL: 1e-3}, f"{STEEL}: given 0.001"),
    ({"fits.shaft_interference_um": 5}, "fits.shaft_interference_um: given 5; allowed only with"),
    ({"fits.housing_interference_um": 5}, "fits.housing_interference_um: given 5; allowed only"),
    ({"fits.shaft_bore_mm": 2}, "fits.shaft_bore_mm: given 2; allowed only with bearing.bore_mm"),
    ({"fits.shaft_interference_um": 1e4}, "fits.shaft_interference_um: given 1"),
    (
        {"fits.shaft_interference_um": 100, "bearing.bore_mm": 4.0},
        "fits.shaft_interference_um: given 100; allowed a number from -40 to 40",
    ),
    (
        {"fits.shaft_bore_mm": 4.0, "bearing.bore_mm": 4.0},
        "fits.shaft_bore_mm: given 4; allowed a number < 4",
    ),
    ({"fits.shaft_bore_mm": -1.0}, "fits.shaft_bore_mm: given -1"),
    ({"fits.shaft_material": "cheese"}, "fits.shaft_material: given 'cheese', not under materials"),
    ({"fits.housing_material": 3}, "fits.housing_material: given 3"),
    (
        {"fits.housing_material": "phenolic", "temperature.housing_C": 30},
        "materials.phenolic.thermal_expansion_1_K: given nothing, with temperatures",
    ),
    ({"bearing.bore_mm": 0.0}, "bearing.bore_mm: given 0"),
    ({"bearing.bore_mm": 5.5}, "bearing.bore_mm: given 5.5"),
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
