"""Friction, films and running in: what contradicts the rest is refused in one line."""

import json

import pytest
from support import scene_file

from bearingwear.cli import main
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.friction import changes_as_it_wears, has_thickness
from bearingwear.scene.read import scene_from_dict

FILM = {
    "uncertainty": None,
    "friction.ball_race": None,
    "friction.film.shear_strength_MPa": 24.8,
    "friction.film.pressure_coefficient": 0.001,
}
THIN = FILM | {"friction.film.thickness_um": 0.5, "friction.film.wear_coefficient": 1e-7}
ON_STEEL = {"materials.bearing_steel.film.thickness_um": 0.5}
STEEL = "materials.bearing_steel"
LAW = "friction.film"
REFUSED = [
    ({"friction.ball_race": None, "uncertainty": None}, "friction.ball_race: got nothing"),
    ({"friction.film.shear_strength_MPa": 24.8}, "friction.ball_race: got 0.08 with friction.f"),
    ({**FILM, "uncertainty": {"ball_race": {"distribution": "normal", "standard_deviation": 0.1}}},
     "uncertainty.ball_race: got it with friction.film"),
    (FILM | {f"{LAW}.shear_strength_MPa": -1}, f"{LAW}.shear_strength_MPa: got -1, expected"),
    (FILM | {f"{LAW}.shear_strength_MPa": 1e5}, f"{LAW}.shear_strength_MPa: got 1"),
    (FILM | {f"{LAW}.shear_strength_MPa": "MoS2"}, f"{LAW}.shear_strength_MPa: got 'MoS2'"),
    (FILM | {f"{LAW}.pressure_coefficient": 2.1}, f"{LAW}.pressure_coefficient: got 2.1"),
    (FILM | {f"{LAW}.pressure_coefficient": float("nan")}, f"{LAW}.pressure_coefficient: got"),
    (FILM | {f"{LAW}.thickness_um": 0}, f"{LAW}.thickness_um: got 0, expected a number > 0"),
    (FILM | {f"{LAW}.thickness_um": 0.5}, f"{LAW}.wear_coefficient: got nothing"),
    (THIN | {f"{LAW}.wear_coefficient": 0}, f"{LAW}.wear_coefficient: got 0"),
    (THIN | {f"{LAW}.brinell_hardness_GPa": True}, f"{LAW}.brinell_hardness_GPa: got true"),
    (THIN | {f"{LAW}.bare_ball_race": -0.1}, f"{LAW}.bare_ball_race: got -0.1"),
    (FILM | {f"{LAW}.bare_ball_race": 0.4}, f"{LAW}.bare_ball_race: got 0.4 with a film that n"),
    (FILM | {f"{LAW}.mu": 0.4}, f"{LAW}.mu: got an unknown key"),
    (THIN | ON_STEEL, f"{LAW}.thickness_um: got 0.5 with {STEEL}.film"),
    (ON_STEEL, f"{STEEL}.film.wear_coefficient: got nothing"),
    ({f"{STEEL}.film.wear_coefficient": 1e-7}, f"{STEEL}.film.thickness_um: got nothing"),
    (ON_STEEL | {f"{STEEL}.film.thickness_um": 1001}, f"{STEEL}.film.thickness_um: got 1001"),
    ({"materials.phenolic.film": {"thickness_um": 1, "wear_coefficient": 1e-7}},
     "materials.phenolic.film: got a film of a material of neither balls nor races"),
    ({f"{STEEL}.running_in": {"wear_coefficient": 1e-5}}, f"{STEEL}.running_in.depth_um: got no"),
    ({f"{STEEL}.running_in": {"wear_coefficient": 1e-5, "depth_um": -1}},
     f"{STEEL}.running_in.depth_um: got -1"),
    ({f"{STEEL}.running_in": {"wear_coefficient": 2, "depth_um": 1}},
     f"{STEEL}.running_in.wear_coefficient: got 2"),
    ({"wear.end_of_life.film_worn_share": 0.5}, "wear.end_of_life.film_worn_share: got 0.5; only"),
    (THIN | {"wear.end_of_life.film_worn_share": 1.5}, "film_worn_share: got 1.5"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "message"), REFUSED)
def test_refused_in_one_line(scene, changes, message):
    with pytest.raises(SceneError) as caught:
        scene("gyro_s1", changes)
    said = str(caught.value)
    assert message in said and "\n" not in said


def test_a_film_is_a_plain_block(scene):
    given = scene("gyro_s1", THIN)
    assert has_thickness(given) and changes_as_it_wears(given)
    plain = given.to_dict()
    assert "ball_race" not in plain["friction"]
    assert plain["friction"]["film"]["thickness_um"] == 0.5
    assert scene_from_dict(json.loads(json.dumps(plain))) == given


@pytest.mark.parametrize(
    ("changes", "thick", "changing"),
    [
        ({}, False, False),
        (FILM, False, False),
        (ON_STEEL | {f"{STEEL}.film.wear_coefficient": 1e-7}, True, True),
        ({f"{STEEL}.running_in": {"wear_coefficient": 1e-5, "depth_um": 0.1}}, False, True),
    ],
)
def test_what_wears_through(scene, changes, thick, changing):
    given = scene("gyro_s1", changes)
    assert (has_thickness(given), changes_as_it_wears(given)) == (thick, changing)


def test_recommend_refuses_a_film_in_one_line(capsys):
    assert main(["recommend", str(scene_file("mos2_gyro"))]) == 2
    said = capsys.readouterr().err.strip().splitlines()[-1]
    assert "friction.film" in said and "expected, for a study" in said
