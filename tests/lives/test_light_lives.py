"""Lives under light preloads end by a criterion, not by their solver."""

import numpy as np
import pytest
from support import ROOT, benchmark

import bearingwear
from bearingwear.kernels.status import NOT_CONVERGED, OK, STATUS_NAMES
from bearingwear.lives.grooves import EXACT_GROOVES, QUICK_GROOVES, Grooves, follow_grooves
from bearingwear.lives.life import life as solved_life
from bearingwear.scene.checking.strict_yaml import data_of, text_of
from bearingwear.solvers.worn.bearing import WornBearing
from bearingwear.solvers.worn.depths import WornPoint

SOURCE = ROOT / "tests" / "lives" / "found_light_lives.yaml"
FOUND = data_of(text_of(SOURCE), SOURCE.name)
LIGHT = benchmark("light_lives")


@pytest.mark.parametrize("found", FOUND, ids=lambda found: f"trial-{found['trial']}")
def test_a_life_found_at_random_ends_by_its_criterion(found):
    """At the loss that ends it, of the worse bearing of a pair."""
    scene = LIGHT.drawn_scene(found["draw"]).one_of_alike
    for way in found["once"]:
        wearing = Grooves(scene, QUICK_GROOVES if way == "quick" else EXACT_GROOVES)
        life = follow_grooves(wearing)
        assert STATUS_NAMES[life.status] == "ok", way
        limit = scene.wear.end_of_life.ball_diameter_loss_um
        loss = 1e6 * max(state.loss for state in life.last.states)
        assert loss > 0.98 * limit, way


def test_the_draws_are_those_of_the_benchmark():
    for found in FOUND:
        rng = np.random.default_rng((LIGHT.SEED, found["trial"]))
        assert LIGHT.drawn(rng) == found["draw"]


@pytest.mark.parametrize("designation", ["7004AC", "7204AC", "71904AC", "7006C"])
def test_lives_over_light_preloads_have_no_gaps(designation):
    """Neighbours differ by little, and no preload among them ends a life by its solver."""
    made = bearingwear.new(designation=designation, speed=20600.0)
    warm = {"inner_ring_C": 26.0, "balls_C": 26.0, "outer_ring_C": 20.0}
    changes = {"operation.preload_method": "constant_force", "temperature": warm}
    changes |= {"wear.end_of_life": {"ball_diameter_loss_um": 0.5}, "model.contact": "worn"}
    lives = []  # preload [N] and time [s]
    for preload in (8.0, 10.57, 12.14, 14.96, 17.2, 19.76, 22.71, 26.0, 30.0):
        scene = made.with_(changes | {"operation.preload_N": preload})
        life = follow_grooves(Grooves(scene))
        assert life.status == OK
        lives.append((preload, life.last.time))
    p, hours = np.log(lives).T
    assert (np.diff(hours) < 0.0).all()
    between = hours[:-2] + np.diff(p)[:-1] * (hours[2:] - hours[:-2]) / (p[2:] - p[:-2])
    assert hours[1:-1] == pytest.approx(between, abs=0.05)


def test_a_bearing_that_wears_itself_free_says_so():
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
    found = solved_life(scene)
    assert found.status == "ok" and found.values["life"] == pytest.approx(0.0)
    assert "contact pressure" in found.attrs["ended_by"]
    later = scene.with_({"wear.end_of_life": {"maximum_pressure_GPa": 5.0}})
    assert solved_life(later).status == "not_converged"
