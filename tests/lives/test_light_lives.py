"""Lives under light preloads end by a criterion, not by their solver."""

import numpy as np
import pytest
from support import ROOT, benchmark

import bearingwear
from bearingwear.kernels.status import NOT_CONVERGED, OK, STATUS_NAMES
from bearingwear.lives.grooves import EXACT_GROOVES, QUICK_GROOVES, Grooves, follow_grooves
from bearingwear.lives.life import life as solved_life
from bearingwear.scene.checking.strict_yaml import data_of, text_of
from bearingwear.solvers.worn.bearing import CELLS_END, WornBearing
from bearingwear.solvers.worn.depths import WornPoint

SOURCE = ROOT / "tests" / "lives" / "found_light_lives.yaml"
FOUND = data_of(text_of(SOURCE), SOURCE.name)
LIGHT = benchmark("light_lives")


SLOW = (7, 37, 51, 286)
"""Trials whose lives take seconds each."""


def trials():
    for result in FOUND:
        marks = pytest.mark.long if result["trial"] in SLOW else ()
        yield pytest.param(result, marks=marks, id=f"trial-{result['trial']}")


@pytest.mark.parametrize("trial", list(trials()))
def test_a_life_found_at_random_ends_by_its_criterion(trial):
    """At the loss that ends it, of the worse bearing of a pair."""
    scene = LIGHT.drawn_scene(trial["draw"]).symmetric_half
    for way in trial["once"]:
        wearing = Grooves(scene, QUICK_GROOVES if way == "quick" else EXACT_GROOVES)
        life = follow_grooves(wearing)
        assert STATUS_NAMES[life.status] == "ok", way
        limit = scene.wear.end_of_life.ball_diameter_loss_um
        loss = 1e6 * max(state.loss for state in life.last.states)
        assert loss > 0.98 * limit, way


def test_the_draws_are_those_of_the_benchmark():
    for result in FOUND:
        rng = np.random.default_rng((LIGHT.SEED, result["trial"]))
        assert LIGHT.drawn(rng) == result["draw"]


@pytest.mark.parametrize(
    "designation",
    [
        "7004AC",
        *(pytest.param(name, marks=pytest.mark.long) for name in ("7204AC", "71904AC", "7006C")),
    ],
)
def test_lives_over_light_preloads_have_no_gaps(designation):
    """Neighbours differ by little, and no preload among them ends a life by its solver."""
    spindle = bearingwear.new(designation=designation, speed=20600.0)
    warm = {"inner_ring_C": 26.0, "balls_C": 26.0, "outer_ring_C": 20.0}
    changes = {"operation.preload_method": "constant_force", "temperature": warm}
    changes |= {"wear.end_of_life": {"ball_diameter_loss_um": 0.5}, "model.contact": "worn"}
    lives = []  # preload [N] and time [s]
    for preload in (8.0, 10.57, 12.14, 14.96, 17.2, 19.76, 22.71, 26.0, 30.0):
        scene = spindle.with_(changes | {"operation.preload_N": preload})
        life = follow_grooves(Grooves(scene))
        assert life.status == OK
        lives.append((preload, life.last.time))
    p, hours = np.log(lives).T
    assert (np.diff(hours) < 0.0).all()
    between = hours[:-2] + np.diff(p)[:-1] * (hours[2:] - hours[:-2]) / (p[2:] - p[:-2])
    assert hours[1:-1] == pytest.approx(between, abs=0.05)


def test_depths_are_kept_as_far_as_a_light_contact_grows():
    """A groove worn to 17 times the gap at the edge of the new contact is six times as long."""
    plain = bearingwear.new(designation="71906AC", speed=10390.0)
    warm = {"inner_ring_C": 26.0, "balls_C": 26.0, "outer_ring_C": 20.0}
    keys = {"temperature": warm, "model.contact": "worn", "cage": None}
    times = []
    for preload in (8.0, 9.158, 10.316, 11.474, 12.632):
        scene = plain.with_(keys | {"operation.preload_N": preload})
        wearing = Grooves(scene, QUICK_GROOVES)
        life = follow_grooves(wearing)
        assert life.status == OK, preload
        limit = 1e-6 * scene.wear.end_of_life.ball_diameter_loss_um
        assert life.last.states[0].loss == pytest.approx(limit, rel=1e-3)
        times.append(life.last.time)
        bearing, grooves = wearing.sides[0].bearing, life.last.worn[0].grooves
        is_worn = (grooves > 1e-3 * grooves.max(axis=1)[:, None]).any(axis=0)
        assert np.abs(bearing.arc[0, is_worn]).max() > 5.0 * bearing.major[0]
        assert not is_worn[[0, -1]].any()
    assert (np.diff(times) < 0.0).all()


def test_worn_grooves_that_press_on_their_shoulder_are_solved_when_slow():
    """At rest, contacts lie beside the groove that they wore at full speed, on a narrow ridge.

    The preload left there rises with the preload and hardly changes up to 3000 r/min. Cells are
    added where a contact needs them, and not without bound.
    """
    spindle = bearingwear.new(designation="7004C", speed=60000.0)
    at_rest = []
    for preload in (20.0, 28.0, 35.0, 45.0, 51.0, 60.0):
        keys = {"operation.preload_N": preload, "operation.preload_method": "fixed_position"}
        scene = spindle.with_(keys | {"model.contact": "worn", "cage": None})
        wearing = Grooves(scene, QUICK_GROOVES)
        life = follow_grooves(wearing)
        assert life.status == OK
        left = []
        for speed in (0.0, 500.0, 20000.0):
            slower = scene.with_({"operation.shaft_speed_rpm": speed})
            (state,) = wearing.states_elsewhere(slower, life.last.worn)
            assert STATUS_NAMES[state.status] == "ok", (preload, speed)
            assert state["system_axial_stiffness"] > 0.0
            left.append(state["residual_preload"])
        assert left[0] == pytest.approx(left[1], rel=0.01) and left[2] > 3.0 * left[0]
        at_rest.append(left[0])
        assert wearing.sides[0].bearing.ends.max() < 2.0 * CELLS_END
    assert (np.diff(at_rest) > 0.0).all() and at_rest[0] < 0.2 * 20.0


def test_a_bearing_that_wears_itself_free_ends_with_its_preload_gone():
    """A slow one at a fixed position loses its preload before it reaches the loss that ends it."""
    scene = LIGHT.drawn_scene(LIGHT.drawn(np.random.default_rng((LIGHT.SEED, 54))))
    life = follow_grooves(Grooves(scene, QUICK_GROOVES))
    assert STATUS_NAMES[life.status] == "preload_gone" and life.solves < 300
    assert life.last.states[0]["residual_preload"] < 0.01 * scene.operation.preload_N


def test_a_criterion_that_is_met_when_new_needs_no_worn_state(monkeypatch):
    """The life is zero, whether or not the grooves can be followed."""
    scene = bearingwear.new(designation="7008C", speed=18000.0).with_(
        {"model.contact": "worn", "wear.end_of_life": {"maximum_pressure_GPa": 0.1}}
    )

    def unsolved(bearing, wear, problem=None):
        return WornPoint(NOT_CONVERGED, wear, problem or bearing.problem)

    monkeypatch.setattr(WornBearing, "solve", unsolved)
    result = solved_life(scene)
    assert result.status == "ok" and result.values["life"] == pytest.approx(0.0)
    assert "contact pressure" in result.attrs["ended_by"]
    over_limit_later = scene.with_({"wear.end_of_life": {"maximum_pressure_GPa": 5.0}})
    assert solved_life(over_limit_later).status == "not_converged"
