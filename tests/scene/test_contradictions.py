"""Friction, temperatures and arrangement: what contradicts the rest is refused in one line.

Types and ranges of single keys: test_records.py, test_hostile.py and the list in config/README.md.
"""

import re

import pytest
from support import scene_file

from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.friction import friction_changes_with_wear, has_thickness
from bearingwear.scene.read import variant

STEEL = "materials.bearing_steel"
COATING = "friction.film"
FILM = {
    "uncertainty": None,
    "friction.ball_race": None,
    f"{COATING}.shear_strength_MPa": 24.8,
    f"{COATING}.pressure_coefficient": 0.001,
}
THIN = FILM | {f"{COATING}.thickness_um": 0.5, f"{COATING}.wear_coefficient": 1e-7}
ON_STEEL = {f"{STEEL}.film.thickness_um": 0.5}
FRICTION = [
    ({"friction.ball_race": None, "uncertainty": None}, "friction.ball_race: got nothing"),
    ({f"{COATING}.shear_strength_MPa": 24.8}, "friction.ball_race: got 0.08 with friction.f"),
    ({**FILM, "uncertainty": {"ball_race": {"distribution": "normal", "standard_deviation": 0.1}}},
     "uncertainty.ball_race: got this key with friction.film"),
    (FILM | {f"{COATING}.thickness_um": 0.5}, f"{COATING}.wear_coefficient: got nothing"),
    (FILM | {f"{COATING}.bare_ball_race": 0.4}, f"{COATING}.bare_ball_race: got 0.4 with a film"),
    (THIN | ON_STEEL, f"{COATING}.thickness_um: got 0.5 with {STEEL}.film"),
    (ON_STEEL, f"{STEEL}.film.wear_coefficient: got nothing"),
    ({f"{STEEL}.film.wear_coefficient": 1e-7}, f"{STEEL}.film.thickness_um: got nothing"),
    ({"materials.phenolic.film": {"thickness_um": 1, "wear_coefficient": 1e-7}},
     "materials.phenolic.film: got a film on a material used for neither balls nor races"),
    ({f"{STEEL}.running_in": {"wear_coefficient": 1e-5}}, f"{STEEL}.running_in.depth_um: got no"),
    ({"wear.end_of_life.film_worn_share": 0.5}, "wear.end_of_life.film_worn_share: got 0.5; only"),
]  # fmt: skip

NETWORK = {
    f"thermal.conductance_W_K.{name}": 0.1
    for name in ("inner_ring_shaft", "outer_ring_housing", "ball_race")
}
EXPANSION = f"{STEEL}.thermal_expansion_1_K"
TEMPERATURES = [
    ({"temperature.housing_C": 1000.0, EXPANSION: 2e-5}, "temperature.housing_C: got a difference"),
    ({"temperature.inner_ring_C": 30} | NETWORK, "thermal: got thermal and temperature"),
    ({"thermal.shaft_C": 20.0}, "thermal.conductance_W_K: got nothing"),
    ({"bearing.inner_groove_factor": 0.501, "temperature.inner_ring_C": -250},
     "temperature.inner_ring_C: got -250 with balls at 20 degC; only allowed if the groove"),
    ({"bearing.outer_groove_factor": 0.503, "temperature.balls_C": 600},
     "temperature.outer_ring_C: got 20 with balls at 600 degC; only allowed if"),
    ({"fits.shaft_interference_um": 5}, "fits.shaft_interference_um: got 5; only allowed with"),
    ({"fits.housing_interference_um": 5}, "fits.housing_interference_um: got 5; only allowed"),
    ({"fits.shaft_bore_mm": 2}, "fits.shaft_bore_mm: got 2; only allowed with bearing.bore_mm"),
    ({"fits.shaft_interference_um": 100, "bearing.bore_mm": 4.0},
     "fits.shaft_interference_um: got 100, expected a number from -40 to 40"),
    ({"fits.shaft_bore_mm": 4.0, "bearing.bore_mm": 4.0},
     "fits.shaft_bore_mm: got 4, expected a number < 4"),
    ({"fits.shaft_material": "cheese"},
     "fits.shaft_material: got 'cheese', which is not under materials"),
    ({"fits.housing_material": "phenolic", "temperature.housing_C": 30},
     "materials.phenolic.thermal_expansion_1_K: got nothing, expected a number"),
    ({"bearing.bore_mm": 5.5}, "bearing.bore_mm: got 5.5"),
]  # fmt: skip

FIXED = {"operation.preload_method": "fixed_position"}
KIND, SECOND = "arrangement.kind", "arrangement.second"
RIGID = FIXED | {KIND: "rigid_pair"}
ARRANGEMENT = [
    ({KIND: "rigid_pair"}, f"{KIND}: got rigid_pair with operation.prelo"),
    (FIXED | {KIND: "spring_pair"}, f"{KIND}: got spring_pair with operation.prel"),
    ({"arrangement.external_axial_N": 1}, "arrangement.external_axial_N: got 1.0 with kind si"),
    (RIGID | {"arrangement.spring_stiffness_N_um": 1}, "spring_stiffness_N_um: got 1.0 w"),
    (RIGID | {"arrangement.tandem": [2]}, "arrangement.tandem: got a list of 1"),
    ({"arrangement.tandem": [2, 1]}, "arrangement.tandem: got a list of 2 with kind single"),
    ({f"{SECOND}.friction.ball_race": 0.1}, f"{SECOND}: got "),
    *(
        (RIGID | {SECOND: {key: value}}, f"{SECOND}.{key}: got ")
        for key, value in {
            "operation.preload_N": 9,
            "operation.shaft_speed_rpm": 9,
            "model.strips": 9,
            KIND: "single",
            "name": "other",
            "friction": 3,
            "friction.ball_rase": 0.1,
            "friction.ball_race": 9,
            "bearing.ball_count": 99,
            "wear.ball_diameter_loss_um": -1,
        }.items()
    ),
    (RIGID | {SECOND: {"wear.end_of_life": {"skid_ratio": 0.1}}},
     f"{SECOND}.wear.end_of_life.skid_ratio: got "),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "problem"), FRICTION + TEMPERATURES + ARRANGEMENT)
def test_a_contradiction_is_refused_in_one_line(changes, problem):
    with pytest.raises(SceneError, match=re.escape(problem)) as caught:
        variant(scene_file("gyro_s1"), changes)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "thick", "changing"),
    [
        ({}, False, False),
        (FILM, False, False),
        (ON_STEEL | {f"{STEEL}.film.wear_coefficient": 1e-7}, True, True),
        ({f"{STEEL}.running_in": {"wear_coefficient": 1e-5, "depth_um": 0.1}}, False, True),
    ],
)
def test_films_and_running_in_have_a_thickness_or_change_with_wear(scene, changes, thick, changing):
    gyro = scene("gyro_s1", changes)
    assert (has_thickness(gyro), friction_changes_with_wear(gyro)) == (thick, changing)
