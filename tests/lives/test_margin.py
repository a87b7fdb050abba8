"""Torque margin: by hand, by every rule, and corners that stall."""

import math

import pytest
from support import scene_file

import bearingwear
from bearingwear.document.margin import margin_document, worst_corner
from bearingwear.lives.margin import friction_interval, least_margin, losses_at_end, torque_corners
from bearingwear.scene.read import load_scene
from bearingwear.scene.requirements import Drive
from bearingwear.scene.scene import SceneError

NONE = {"uncertainty": None}


@pytest.fixture(scope="module")
def scene():
    """Of one bearing, cold and hot, with a friction known to a factor."""
    plain = load_scene(scene_file("gyro_s1"))
    return plain.with_(
        {
            "uncertainty": {"ball_race": {"distribution": "lognormal", "factor": 1.2}},
            "cases": {"cold": {"friction.ball_race": 0.2, "lubricant.drag_density_kg_m3": 20.0}},
            "drive.torque_Nm": 0.01,
        }
    )


@pytest.fixture(scope="module")
def corners(scene):
    return torque_corners(scene)


def test_margin_by_hand(scene, corners):
    """T/(2 (3 T_b + 1.1 I) + T_L) - 1, T_b by a solve of the corner's own scene."""
    mu = 0.2 * math.exp(1.6448536269514722 * math.log(1.2))
    loss = losses_at_end(scene.in_cases["cold"])[0]
    hand = scene.in_cases["cold"].with_(
        {"friction.ball_race": mu, "wear.ball_diameter_loss_um": 1e6 * loss}
    )
    case = bearingwear.solve(hand)
    torque = float(case.shaft_torque)
    found = next(
        one
        for one in corners
        if (one.case, one.wear) == ("cold", "worn") and one.friction == pytest.approx(mu)
    )
    assert found.torque == pytest.approx(torque, rel=1e-6)
    assert found.margin == pytest.approx(0.01 / (2.0 * 3.0 * torque) - 1.0, rel=1e-6)
    drive = Drive(torque_Nm=0.01, resistances_Nm={"inertia": 1e-3, "output": 2e-4})
    by_hand = 0.01 / (2.0 * (3.0 * torque + 1.1 * 1e-3) + 2e-4) - 1.0
    assert drive.margin(torque) == pytest.approx(by_hand, rel=1e-12)


def test_corners(scene, corners):
    assert len(corners) == 2 * 2 * 3
    assert {(one.case, one.wear) for one in corners} == {
        (case, wear) for case in ("nominal", "cold") for wear in ("new", "worn")
    }
    worst = worst_corner(corners)
    assert worst.case == "cold" and worst.friction == pytest.approx(0.2 * 1.2**1.64485, rel=1e-4)
    losses = [(0.0,), losses_at_end(scene.in_cases["cold"])]
    assert least_margin(scene.in_cases["cold"], losses) == pytest.approx(worst.margin, rel=1e-9)


@pytest.mark.parametrize(
    ("drive", "factor"),
    [
        ({"standard": "ecss"}, 6.0),
        ({"standard": "ecss", "data": "extremes"}, 3.0),
        ({"standard": "nasa"}, 1.5),
        ({"standard": "nasa", "bearings_as": "variable"}, 3.0),
        ({"standard": "nasa", "data": "test"}, 1.35),
        ({"standard": "nasa", "data": "extremes", "bearings_as": "variable"}, 2.0),
        ({"standard": "own", "factors": {"drag": 4.0}, "bearings_as": "drag"}, 4.0),
    ],
)
def test_rules(drive, factor):
    assert Drive(torque_Nm=1.0, **drive).margin(0.1) == pytest.approx(1.0 / (0.1 * factor) - 1.0)


def test_a_cold_corner_that_stalls_is_found(scene, corners):
    """The drive turns the bearing in every corner but the cold one with much friction."""
    torques = sorted(one.torque for one in corners)
    weak = scene.with_({"drive.torque_Nm": 0.5 * (torques[-1] + torques[-2])})
    found = torque_corners(weak)
    assert [one.stalls for one in found].count(True) == 1
    worst = worst_corner(found)
    assert worst.stalls and worst.case == "cold"
    assert (
        margin_document(weak, found).heading[1].startswith("the drive stalls: the resisting torque")
    )


def test_interval_of_the_friction(scene):
    plain = scene.with_({"cases": None})
    given = {"normal": {"standard_deviation": 0.01}, "uniform": {"low": 0.0, "high": 1.0}}
    for name, ends in (("normal", [0.06355, 0.08, 0.09645]), ("uniform", [0.05, 0.08, 0.95])):
        one = {"distribution": name} | given[name]
        made = plain.with_({"uncertainty": {"ball_race": one}, "friction.ball_race": 0.08})
        assert friction_interval(made)[1] == pytest.approx(ends, rel=1e-4)
    key, values = friction_interval(plain.with_(NONE))  # of the table of coefficients
    assert key == "friction.ball_race" and len(values) == 3
    film = load_scene(scene_file("mos2_gyro"))
    assert friction_interval(film)[0] == "friction.film.shear_strength_MPa"


def test_a_film_that_is_gone_is_a_corner():
    film = load_scene(scene_file("mos2_gyro")).with_({"drive.torque_Nm": 0.01})
    found = [one for one in torque_corners(film) if one.wear == "film worn off"]
    assert found and all(one.torque > 0.0 for one in found)


@pytest.mark.parametrize(
    ("drive", "problem"),
    [
        ({"standard": "own"}, "factors: got none with own"),
        ({"factors": {"a": 1.0}}, "factors: got some with ecss"),
        ({"bearings_as": "drag"}, "bearings_as: got drag, expected inertia, spring"),
        ({"resistances_Nm": {"wire": 0.1}}, "resistances_Nm.wire: got an unknown key, expected"),
        ({"standard": "own", "factors": {"drag": 2.0}}, "bearings_as: got nothing, expected drag"),
    ],
)
def test_a_rule_that_contradicts_itself_takes_a_line(drive, problem):
    with pytest.raises(SceneError, match=problem):
        Drive(torque_Nm=1.0, **drive)
