"""Torque margin: by hand, by every rule, and corners that stall."""

import math

import numpy as np
import pytest
from support import scene_file

import bearingwear
from bearingwear.applications.margin.sheet import margin_document
from bearingwear.cli import main
from bearingwear.document.margin import worst_corner
from bearingwear.kernels import status as code
from bearingwear.lives import margin
from bearingwear.lives.many import worse_states
from bearingwear.lives.margin import friction_interval, least_margin, life_of, torque_corners
from bearingwear.scene.read import load_scene
from bearingwear.scene.requirements import Drive
from bearingwear.scene.scene import SceneError

NONE = {"uncertainty": None}


def loss_at_end(scene):
    return life_of(scene).last.states[0].loss


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


@pytest.mark.filterwarnings("ignore::UserWarning")  # of the scene, which is not the subject
def test_margin_by_hand(scene, corners):
    """T/(2 (3 T_b + 1.1 I) + T_L) - 1, T_b by a solve of the corner's own scene."""
    mu = 0.2 * math.exp(1.6448536269514722 * math.log(1.2))
    loss = loss_at_end(scene.in_cases["cold"])
    hand = scene.in_cases["cold"].with_(
        {"friction.ball_race": mu, "wear.ball_diameter_loss_um": 1e6 * loss}
    )
    case = bearingwear.solve(hand)
    torque = float(case.shaft_torque)
    result = next(
        corner
        for corner in corners
        if (corner.case, corner.wear) == ("cold", "worn") and corner.friction == pytest.approx(mu)
    )
    assert result.torque == pytest.approx(torque, rel=1e-6)
    assert result.margin == pytest.approx(0.01 / (2.0 * 3.0 * torque) - 1.0, rel=1e-6)
    drive = Drive(torque_Nm=0.01, resistances_Nm={"inertia": 1e-3, "output": 2e-4})
    by_hand = 0.01 / (2.0 * (3.0 * torque + 1.1 * 1e-3) + 2e-4) - 1.0
    assert drive.margin(torque) == pytest.approx(by_hand, rel=1e-12)


def test_the_worst_corner_is_cold_with_much_friction(scene, corners):
    assert len(corners) == 2 * 2 * 3
    assert {(corner.case, corner.wear) for corner in corners} == {
        (case, wear) for case in ("nominal", "cold") for wear in ("new", "worn")
    }
    worst = worst_corner(corners)
    assert worst.case == "cold" and worst.friction == pytest.approx(0.2 * 1.2**1.64485, rel=1e-4)
    cold = scene.in_cases["cold"]
    states = worse_states(life_of(cold), cold)
    assert least_margin(cold, states) == pytest.approx(worst.margin, rel=1e-9)


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
def test_the_margin_is_that_of_its_rule(drive, factor):
    assert Drive(torque_Nm=1.0, **drive).margin(0.1) == pytest.approx(1.0 / (0.1 * factor) - 1.0)


def test_only_the_cold_corner_stalls_with_a_weak_drive(scene, corners):
    """The drive turns the bearing in every corner but the cold one with much friction."""
    torques = sorted(corner.torque for corner in corners)
    weak = scene.with_({"drive.torque_Nm": 0.5 * (torques[-1] + torques[-2])})
    of_weak_drive = torque_corners(weak)
    assert [corner.stalls for corner in of_weak_drive].count(True) == 1
    worst = worst_corner(of_weak_drive)
    assert worst.stalls and worst.case == "cold"
    document = margin_document(weak, of_weak_drive)
    assert "stalls" in document.heading[1] and "cold" in document.heading[1]
    assert [row.note for row in document.blocks[0].rows].count("stalls") == 1


@pytest.mark.parametrize(("torque", "status"), [(1.0, 0), (1e-9, 4)])
def test_the_exit_status_says_whether_the_margin_is_sufficient(capsys, torque, status):
    assert main(["margin", str(scene_file("gyro_s1")), "--drive", str(torque)]) == status
    assert ("stalls" in capsys.readouterr().out) == (status == 4)


def test_interval_of_the_friction(scene):
    plain = scene.with_({"cases": None})
    inputs = {"normal": {"standard_deviation": 0.01}, "uniform": {"low": 0.0, "high": 1.0}}
    for name, ends in (("normal", [0.06355, 0.08, 0.09645]), ("uniform", [0.05, 0.08, 0.95])):
        distribution = {"distribution": name} | inputs[name]
        uncertain = plain.with_(
            {"uncertainty": {"ball_race": distribution}, "friction.ball_race": 0.08}
        )
        assert friction_interval(uncertain)[1] == pytest.approx(ends, rel=1e-4)
    key, values = friction_interval(plain.with_(NONE))  # of the table of coefficients
    assert key == "friction.ball_race" and len(values) == 3
    film = load_scene(scene_file("mos2_gyro"))
    assert friction_interval(film)[0] == "friction.film.shear_strength_MPa"


@pytest.fixture(scope="module")
def filmed():
    """Of a slow bearing with MoS2 at a fixed position, whose preload wears off with the film."""
    spindle = bearingwear.new(
        designation="7004C", lubrication="mos2", speed=60.0, preload_method="fixed_position"
    )
    return spindle.with_({"friction.slip_regularisation_m_s": 1e-6, "drive.torque_Nm": 0.05})


def bare_torque(scene, loss):
    """Torque at a loss of ball diameter under the friction of the bare steel, by a plain solve."""
    friction = scene.to_dict()["friction"]
    plain = {"ball_race": friction["film"]["bare_ball_race"], "film": None}
    plain |= {"slip_regularisation_m_s": friction["slip_regularisation_m_s"]}
    worn = {"wear.ball_diameter_loss_um": 1e6 * loss, "wear.end_of_life": None}
    bare = scene.with_({"friction": plain, "cage": None, "uncertainty": None} | worn)
    return float(bearingwear.solve(bare).shaft_torque)


@pytest.mark.filterwarnings("ignore::UserWarning")  # of the scene, which is not the subject
def test_the_film_is_taken_away_when_it_is_worn_through(filmed):
    """Margins fall with the preload, and are those of plain solves, composed by hand."""
    margins = []
    for preload in (45.0, 62.0, 80.0, 100.0):
        scene = filmed.with_({"operation.preload_N": preload})
        corners = torque_corners(scene)
        assert [item.wear for item in corners[:3]] == ["new", "worn", "film worn off"]
        assert not any(corner.why for corner in corners)
        states = life_of(scene).states
        thinnest = np.array([state["film_left"][:2].min() for state in states])
        loss = np.array([state.loss for state in states])
        gone = loss[-1]
        if thinnest.min() <= 0.0:
            k = int(np.argmax(thinnest <= 0.0))
            gone = np.interp(0.0, thinnest[[k, k - 1]], loss[[k, k - 1]])
            assert gone < loss[-1]
        assert corners[2].torque == pytest.approx(bare_torque(scene, gone), rel=1e-6)
        margins.append(worst_corner(corners).margin)
        assert least_margin(scene, states) == pytest.approx(margins[-1], rel=1e-9)
    assert margins == sorted(margins, reverse=True)
    assert margins[0] > 6.0 and 0.0 < margins[-1] < 0.5


def test_a_corner_that_is_not_computed_is_named(filmed, monkeypatch):
    """A life that ends by its solver leaves no margin that is sufficient."""

    def cut(scene):
        cage_life = life_of(scene)
        gone = next(k for k, state in enumerate(cage_life.states) if state["film_left"][0] <= 0.0)
        cage_life.nodes, cage_life.status = (
            cage_life.nodes[: gone if is_early else None],
            code.NOT_CONVERGED,
        )
        return cage_life

    scene, missing = filmed.with_({"operation.preload_N": 80.0}), {}
    for is_early in (False, True):
        with monkeypatch.context() as patch:
            patch.setattr(margin, "life_of", cut)
            corners = torque_corners(scene)
        missing[is_early] = {corner.wear for corner in corners if corner.why}
        assert all(math.isnan(item.torque) == bool(item.why) for item in corners)
        sheet = margin_document(scene, corners)
        assert "unknown" in sheet.heading[1] and "sufficient" not in " ".join(sheet.heading)
        unsolved = [row for row in sheet.blocks[0].rows if row.note.startswith("not computed (")]
        assert len(unsolved) == 3 * len(missing[is_early])
    assert missing == {False: {"worn"}, True: {"worn", "film worn off"}}


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
