"""Wear life: the integral, its end, its bound, and Archard's proportions."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from bearingwear.lives.life import life
from bearingwear.scene.blocks import CRITERIA
from bearingwear.solvers.compose import solver_of

POSITION = {"operation.preload_method": "fixed_position"}


def with_tolerance(scene, tolerance):
    return replace(scene, model=replace(scene.model, tolerance=tolerance))


def with_end(scene, **criteria):
    from bearingwear.scene.scene import EndOfLife

    return replace(scene, wear=replace(scene.wear, end_of_life=EndOfLife(**criteria)))


@pytest.mark.parametrize("changes", [{}, POSITION, POSITION | {"friction.ball_race": 0.02}])
def test_against_adaptive_quadrature(scene, changes):
    """Life and its end against SciPy's quad and brentq on single solves."""
    s = scene("gyro_s1", changes)
    v = life(s).values
    state, end = solver_of(s).at, s.wear.end_of_life
    name = CRITERIA[v["end_criterion"]]
    beyond = {
        "preload_fraction": lambda x: state(x)["residual_preload"] - 7.0 * end.preload_fraction,
        "gyroscopic_slip_share": lambda x: (
            state(x)["gyroscopic_slip_share"].max() - end.gyroscopic_slip_share
        ),
    }
    if name in beyond:
        last = brentq(beyond[name], 0.0, 0.7e-6, xtol=1e-18)
    else:
        last = end.ball_diameter_loss_um * 1e-6
    assert_allclose(v["loss_at_end"], last, rtol=1e-8)
    exact, _ = quad(lambda x: 1.0 / state(x).rate, 0.0, last, epsrel=1e-9)
    assert abs(v["life"] - exact) <= v["life_error_bound"] + 1e-9 * exact
    assert_allclose(v["life"], exact, rtol=1e-6)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_error_bound_holds(scene, tolerance):
    s = scene("gyro_s1", POSITION)
    exact = life(with_tolerance(s, 1e-8)).values["life"]
    v = life(with_tolerance(s, tolerance)).values
    assert np.all(np.abs(v["life"] - exact) <= v["life_error_bound"])
    assert np.all(v["life_error_bound"] <= tolerance * v["life"])


def test_the_history_of_a_life_fits_its_end(scene):
    v = life(scene("gyro_s1", POSITION)).values
    loss, time = v["history_ball_diameter_loss"], v["history_time"]
    assert np.all(np.diff(loss) > 0.0)
    assert np.all(np.diff(time) > 0.0)
    assert_allclose(time[-1], v["life"])
    assert_allclose(loss[-1], v["loss_at_end"])
    # The clock is the integral: trapezoids over the history come close.
    slow = np.trapezoid(1 / v["history_ball_diameter_loss_rate"], loss)
    assert_allclose(slow, v["life"], rtol=5e-3)


def test_a_life_counts_what_its_scene_says(scene):
    """The states at a loss are the same; counting the balls alone, they follow more slowly."""
    both = life(scene("gyro_s1", POSITION))
    balls = life(scene("gyro_s1", POSITION | {"wear.counts": "ball"}))
    assert [item.attrs["wear_counts"] for item in (balls, both)] == ["ball", "ball_and_races"]
    assert balls.values["loss_at_end"] == pytest.approx(both.values["loss_at_end"], rel=1e-9)
    assert balls.values["life"] > 2.0 * both.values["life"]
    # QV, and with it the wear of a ball, is that of the states of the other life
    v = both.values
    factor = 2.0 / (np.pi * (2e-3 - v["history_ball_diameter_loss"]) ** 2)
    slow = PchipInterpolator(
        v["history_ball_diameter_loss"], 1.0 / (factor * v["history_ball_wear_rate"])
    )
    assert balls.values["life"] == pytest.approx(slow.integrate(0.0, v["loss_at_end"]), rel=1e-6)


def test_life_is_inverse_to_the_wear_coefficient(scene):
    s = scene("gyro_s1", POSITION)
    steel = s.materials["bearing_steel"]
    other = replace(
        s, materials={**s.materials, "bearing_steel": replace(steel, wear_coefficient=1.5e-5)}
    )
    a, b = life(s).values, life(other).values
    assert_allclose(b["life"], a["life"] / 3.0, rtol=1e-9)
    assert_allclose(b["normalised_life"], a["normalised_life"], rtol=1e-9)
    assert_allclose(a["normalised_life"], a["life"] * 5e-6 / 6.6e9, rtol=1e-12)


def test_first_criterion_counts(scene):
    s = scene("gyro_s1", POSITION)
    ends = {
        "preload_fraction": {"preload_fraction": 0.4, "ball_diameter_loss_um": 0.7},
        "ball_diameter_loss_um": {"preload_fraction": 0.4, "ball_diameter_loss_um": 0.3},
        "gyroscopic_slip_share": {"preload_fraction": 0.4, "gyroscopic_slip_share": 0.2},
    }
    for name, criteria in ends.items():
        assert CRITERIA[life(with_end(s, **criteria)).values["end_criterion"]] == name


def test_met_from_the_start(scene):
    v = life(with_end(scene("gyro_s1"), gyroscopic_slip_share=0.01)).values
    assert CRITERIA[v["end_criterion"]] == "gyroscopic_slip_share"
    assert_allclose(v["life"], 0.0)


def test_starts_from_the_present_wear(scene):
    values = life(scene("gyro_s1", POSITION)).values
    rest = life(scene("gyro_s1", POSITION | {"wear.ball_diameter_loss_um": 0.2})).values
    done = life(with_end(scene("gyro_s1", POSITION), ball_diameter_loss_um=0.2)).values
    assert_allclose(done["life"] + rest["life"], values["life"], rtol=2e-6)


def test_solver_range_ends_first(scene):
    """Worn until centrifugal force lifts the balls: a lower bound of the life, and said so."""
    result = life(with_end(scene("gyro_s1", POSITION), ball_diameter_loss_um=90.0))
    assert result.status == "contact_lost"
    assert CRITERIA[result.values["end_criterion"]] == "none"
    assert np.all(result.values["life"] > 0.0)


def test_without_friction_there_is_no_life(scene):
    result = life(scene("gyro_s1", {"friction.ball_race": 0}))
    assert result.status == "undetermined"
    assert "life" not in result.values


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("contact", ["hertz", "worn"])
def test_standstill_never_wears(contact, scene):
    keys = {"operation.shaft_speed_rpm": 0, "model.contact": contact}
    result = life(scene("gyro_s1", keys))
    assert result.status == "criterion_not_reached"
    assert "life" not in result.values


def test_race_control_life(scene):
    """Where it is asked for, a life is that of the race-control estimate; no slip shares there."""
    result = life(scene("gyro_s1", {"operation.radial_load_N": [0.0, 1.0]}), "race_control")
    assert result.status == "ok"
    assert result.attrs["fidelity"] == "race_control"
    thrust = life(scene("gyro_s1")).values["life"]
    assert_allclose(result.values["life"], thrust, rtol=0.1)
    assert not {"history_gyroscopic_slip_share", "history_skid_ratio"} & result.values.keys()
