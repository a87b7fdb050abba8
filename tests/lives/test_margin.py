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
from bearingwear.scene.coefficients import usual_spread
from bearingwear.scene.read import load_scene
from bearingwear.scene.requirements import Drive
from bearingwear.scene.scene import SceneError

FACTORS_TO_95_PERCENT = 1.6448536269514722
"""Standard deviations, or powers of the factor of a lognormal, to the 95 % point of a normal."""


def loss_at_end(scene):
    """Returns the loss of ball diameter at the end of the life [m]."""
    return life_of(scene).last.states[0].loss


@pytest.fixture(scope="module")
def scene():
    """Returns gyro_s1 with a case of high friction and drag, and a drive of 10 mN m.

    Its friction has a lognormal distribution with a geometric standard deviation of 1.2.
    """
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
def test_the_margin_of_a_corner_is_that_by_hand(scene, corners):
    """The margin of ECSS is T/(2 (3 T_b + 1.1 I) + T_L) - 1.

    T is the torque of the drive, T_b that of the bearings, by a solve of the corner's own scene. I
    is that of inertia and T_L that of the output; the scene has neither.
    """
    mu = 0.2 * 1.2**FACTORS_TO_95_PERCENT
    loss = loss_at_end(scene.in_cases["cold"])
    worn_scene = scene.in_cases["cold"].with_(
        {"friction.ball_race": mu, "wear.ball_diameter_loss_um": 1e6 * loss}
    )
    torque = float(bearingwear.solve(worn_scene).shaft_torque)
    (corner,) = (
        corner
        for corner in corners
        if (corner.case, corner.wear) == ("cold", "worn") and corner.friction == pytest.approx(mu)
    )
    assert corner.torque == pytest.approx(torque, rel=1e-6)
    assert corner.margin == pytest.approx(0.01 / (2.0 * 3.0 * torque) - 1.0, rel=1e-6)
    drive = Drive(torque_Nm=0.01, resistances_Nm={"inertia": 1e-3, "output": 2e-4})
    by_hand = 0.01 / (2.0 * (3.0 * torque + 1.1 * 1e-3) + 2e-4) - 1.0
    assert drive.margin(torque) == pytest.approx(by_hand, rel=1e-12)


def test_corners_are_each_case_new_and_worn_with_three_frictions(corners):
    assert sorted({(corner.case, corner.wear) for corner in corners}) == [
        ("cold", "new"), ("cold", "worn"), ("nominal", "new"), ("nominal", "worn"),
    ]  # fmt: skip
    assert len(corners) == 2 * 2 * 3


def test_the_worst_corner_is_cold_with_much_friction(scene, corners):
    worst = worst_corner(corners)
    assert worst.case == "cold"
    assert worst.friction == pytest.approx(0.2 * 1.2**FACTORS_TO_95_PERCENT)
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
    """Factors on the torque of a bearing, as docs/theory/26-torque-margin.md lists them."""
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
    """A drive of 1 N m turns this bearing of micronewtonmetres, one of 1 nN m does not."""
    assert main(["margin", str(scene_file("gyro_s1")), "--drive", str(torque)]) == status
    assert ("stalls" in capsys.readouterr().out) == (status == 4)


@pytest.mark.parametrize(
    ("distribution", "low", "high"),
    [
        (
            {"distribution": "normal", "standard_deviation": 0.01},
            0.08 - 0.01 * FACTORS_TO_95_PERCENT,
            0.08 + 0.01 * FACTORS_TO_95_PERCENT,
        ),
        ({"distribution": "uniform", "low": 0.0, "high": 1.0}, 0.05, 0.95),
    ],
)
def test_the_friction_varies_from_its_5_to_its_95_percent_point(scene, distribution, low, high):
    uncertain = scene.with_(
        {
            "cases": None,
            "uncertainty": {"ball_race": distribution},
            "friction.ball_race": 0.08,
        }
    )
    assert friction_interval(uncertain)[1] == pytest.approx([low, 0.08, high], rel=1e-6)


def test_without_a_distribution_the_friction_varies_as_the_table_of_coefficients_says(scene):
    without = scene.with_({"cases": None, "uncertainty": None})
    spread, _ = usual_spread(without.to_dict())
    as_stated = without.with_({"uncertainty": {"ball_race": spread["ball_race"]}})
    key, values = friction_interval(without)
    assert (key, values) == friction_interval(as_stated)
    assert key == "friction.ball_race" and values[0] < values[1] < values[2]


def test_the_shear_strength_of_a_film_varies():
    film = load_scene(scene_file("mos2_gyro"))
    assert friction_interval(film)[0] == "friction.film.shear_strength_MPa"


@pytest.fixture(scope="module")
def filmed_scene():
    """Returns a slow bearing with MoS2 at a fixed position: its preload wears off with the film."""
    spindle = bearingwear.new(
        designation="7004C", lubrication="mos2", speed=60.0, preload_method="fixed_position"
    )
    return spindle.with_({"friction.slip_regularisation_m_s": 1e-6, "drive.torque_Nm": 0.05})


def bare_torque(scene, loss):
    """Returns the torque [N m] at a loss [m] with the friction of bare steel, by a plain solve."""
    friction = scene.to_dict()["friction"]
    plain = {"ball_race": friction["film"]["bare_ball_race"], "film": None}
    plain |= {"slip_regularisation_m_s": friction["slip_regularisation_m_s"]}
    worn = {"wear.ball_diameter_loss_um": 1e6 * loss, "wear.end_of_life": None}
    bare = scene.with_({"friction": plain, "cage": None, "uncertainty": None} | worn)
    return float(bearingwear.solve(bare).shaft_torque)


@pytest.mark.filterwarnings("ignore::UserWarning")  # of the scene, which is not the subject
def test_the_film_is_taken_away_when_it_is_worn_through(filmed_scene):
    """Margins fall with the preload, and are those of plain solves, composed by hand."""
    margins = []
    for preload in (45.0, 62.0, 80.0, 100.0):
        scene = filmed_scene.with_({"operation.preload_N": preload})
        corners = torque_corners(scene)
        assert [corner.wear for corner in corners[:3]] == ["new", "worn", "film worn off"]
        assert not any(corner.why for corner in corners)
        states = life_of(scene).states
        thinnest = np.array([state["film_left"][:2].min() for state in states])
        loss = np.array([state.loss for state in states])
        loss_when_bare = loss[-1]
        if thinnest.min() <= 0.0:
            k = int(np.argmax(thinnest <= 0.0))  # the film is gone before this state
            loss_when_bare = np.interp(0.0, thinnest[[k, k - 1]], loss[[k, k - 1]])
            assert loss_when_bare < loss[-1]
        assert corners[2].torque == pytest.approx(bare_torque(scene, loss_when_bare), rel=1e-6)
        margins.append(worst_corner(corners).margin)
        assert least_margin(scene, states) == pytest.approx(margins[-1], rel=1e-9)
    assert margins == sorted(margins, reverse=True)
    assert margins[0] > 6.0 and 0.0 < margins[-1] < 0.5  # from ample to next to nothing


@pytest.mark.parametrize(
    ("ends_with_film", "missing"),
    [(False, {"worn"}), (True, {"worn", "film worn off"})],
    ids=["after the film", "with the film"],
)
def test_a_corner_that_is_not_computed_is_named(filmed_scene, ends_with_film, missing, monkeypatch):
    """A life that ends by its solver leaves no margin that is sufficient."""

    def life_cut_short(scene):
        life = life_of(scene)
        if ends_with_film:
            bare = next(k for k, state in enumerate(life.states) if state["film_left"][0] <= 0.0)
            life.nodes = life.nodes[:bare]
        life.status = code.NOT_CONVERGED
        return life

    scene = filmed_scene.with_({"operation.preload_N": 80.0})
    monkeypatch.setattr(margin, "life_of", life_cut_short)
    corners = torque_corners(scene)
    assert {corner.wear for corner in corners if corner.why} == missing
    assert all(math.isnan(corner.torque) == bool(corner.why) for corner in corners)
    sheet = margin_document(scene, corners)
    assert "unknown" in sheet.heading[1] and "sufficient" not in " ".join(sheet.heading)
    unsolved = [row for row in sheet.blocks[0].rows if row.note.startswith("not computed (")]
    assert len(unsolved) == 3 * len(missing)  # a row for each friction


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
def test_a_rule_that_contradicts_itself_is_refused_in_one_line(drive, problem):
    with pytest.raises(SceneError, match=problem):
        Drive(torque_Nm=1.0, **drive)
