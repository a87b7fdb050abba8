"""Wear life: the integral, its end, its bound, and Archard's proportions."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from bearingwear.lives.life import life
from bearingwear.scene.blocks import CRITERIA, EndOfLife
from bearingwear.solvers.compose import solver_of

POSITION = {"operation.preload_method": "fixed_position"}


def with_tolerance(scene, tolerance):
    """Returns a scene with another `model.tolerance`, without a check of its range."""
    return replace(scene, model=replace(scene.model, tolerance=tolerance))


def with_end(scene, **criteria):
    """Returns a scene whose end of life has these criteria and no others."""
    return replace(scene, wear=replace(scene.wear, end_of_life=EndOfLife(**criteria)))


@pytest.mark.parametrize(
    ("changes", "criterion"),
    [
        ({}, "ball_diameter_loss_um"),
        (POSITION, "preload_fraction"),
        (POSITION | {"friction.ball_race": 0.02}, "gyroscopic_slip_share"),
    ],
)
def test_a_life_is_the_integral_of_the_inverse_rate_up_to_its_criterion(scene, changes, criterion):
    """SciPy's brentq and quad on single solves give the loss at the end and the life.

    Where preload or slip ends the life, brentq seeks the loss at which the criterion is met.
    """
    s = scene("gyro_s1", changes)
    values = life(s).values
    state, end = solver_of(s).at, s.wear.end_of_life
    assert CRITERIA[values["end_criterion"]] == criterion
    margins = {
        "preload_fraction": lambda x: state(x)["residual_preload"] - 7.0 * end.preload_fraction,
        "gyroscopic_slip_share": lambda x: (
            state(x)["gyroscopic_slip_share"].max() - end.gyroscopic_slip_share
        ),
    }
    last = end.ball_diameter_loss_um * 1e-6
    if criterion in margins:
        last = brentq(margins[criterion], 0.0, last, xtol=1e-18)
    assert_allclose(values["loss_at_end"], last, rtol=1e-8)
    exact, _ = quad(lambda x: 1.0 / state(x).rate, 0.0, last, epsrel=1e-9)
    assert abs(values["life"] - exact) <= values["life_error_bound"] + 1e-9 * exact
    assert_allclose(values["life"], exact, rtol=1e-6)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4])
def test_the_error_bound_covers_the_error_and_keeps_the_tolerance(scene, tolerance):
    """The error is the difference from a life with a far smaller tolerance."""
    s = scene("gyro_s1", POSITION)
    exact = life(with_tolerance(s, 1e-8)).values["life"]
    values = life(with_tolerance(s, tolerance)).values
    assert np.all(np.abs(values["life"] - exact) <= values["life_error_bound"])
    assert np.all(values["life_error_bound"] <= tolerance * values["life"])


def test_the_history_of_a_life_fits_its_end(scene):
    values = life(scene("gyro_s1", POSITION)).values
    loss, time = values["history_ball_diameter_loss"], values["history_time"]
    assert np.all(np.diff(loss) > 0.0)
    assert np.all(np.diff(time) > 0.0)
    assert_allclose(time[-1], values["life"])
    assert_allclose(loss[-1], values["loss_at_end"])
    # the clock is the integral of the inverse rate: trapezoids over the history come close
    by_trapezoids = np.trapezoid(1.0 / values["history_ball_diameter_loss_rate"], loss)
    assert_allclose(by_trapezoids, values["life"], rtol=5e-3)


def test_a_life_counts_what_its_scene_says(scene):
    """The states at a loss are the same; if only balls count, it takes longer to reach them."""
    both = life(scene("gyro_s1", POSITION))
    balls = life(scene("gyro_s1", POSITION | {"wear.counts": "ball"}))
    assert [result.attrs["wear_counts"] for result in (balls, both)] == ["ball", "ball_and_races"]
    assert_allclose(balls.values["loss_at_end"], both.values["loss_at_end"], rtol=1e-9)
    assert balls.values["life"] > 2.0 * both.values["life"]
    # QV, and with it the wear of a ball, is that of the states of the other life:
    # dD/dt = 2 dV/dt/(pi D^2)
    values = both.values
    loss = values["history_ball_diameter_loss"]
    rate_of_diameter = 2.0 * values["history_ball_wear_rate"] / (np.pi * (2e-3 - loss) ** 2)
    time_of_loss = PchipInterpolator(loss, 1.0 / rate_of_diameter).antiderivative()
    assert balls.values["life"] == pytest.approx(time_of_loss(values["loss_at_end"]), rel=1e-6)


def test_life_is_inverse_to_the_wear_coefficient(scene):
    """The normalised life, K_s/H times the life [s/Pa], does not depend on it."""
    K, H = 5e-6, 6.6e9  # of the steel of the scene; H in Pa
    s = scene("gyro_s1", POSITION)
    values = life(s).values
    key = "materials.bearing_steel.wear_coefficient"
    threefold = life(s.with_({key: 3.0 * K})).values
    assert_allclose(threefold["life"], values["life"] / 3.0, rtol=1e-9)
    assert_allclose(threefold["normalised_life"], values["normalised_life"], rtol=1e-9)
    assert_allclose(values["normalised_life"], values["life"] * K / H, rtol=1e-12)


@pytest.mark.parametrize(
    ("criteria", "first"),
    [
        ({"preload_fraction": 0.4, "ball_diameter_loss_um": 0.7}, "preload_fraction"),
        ({"preload_fraction": 0.4, "ball_diameter_loss_um": 0.3}, "ball_diameter_loss_um"),
        ({"preload_fraction": 0.4, "gyroscopic_slip_share": 0.2}, "gyroscopic_slip_share"),
    ],
)
def test_the_criterion_that_is_met_first_ends_the_life(scene, criteria, first):
    result = life(with_end(scene("gyro_s1", POSITION), **criteria))
    assert CRITERIA[result.values["end_criterion"]] == first


def test_a_criterion_met_when_new_gives_a_life_of_zero(scene):
    """gyro_s1 has a larger share of gyroscopic slip than 0.01 when new."""
    values = life(with_end(scene("gyro_s1"), gyroscopic_slip_share=0.01)).values
    assert CRITERIA[values["end_criterion"]] == "gyroscopic_slip_share"
    assert values["life"] == 0.0


def test_a_worn_bearing_lives_as_long_as_it_has_left(scene):
    """The life up to a loss of 0.2 um and the life from there on make the whole."""
    whole = life(scene("gyro_s1", POSITION)).values["life"]
    rest = life(scene("gyro_s1", POSITION | {"wear.ball_diameter_loss_um": 0.2})).values["life"]
    until = life(with_end(scene("gyro_s1", POSITION), ball_diameter_loss_um=0.2)).values["life"]
    assert_allclose(until + rest, whole, rtol=2e-6)  # twice the tolerance of a life


def test_a_life_that_leaves_the_range_of_the_solver_is_a_lower_bound(scene):
    """Centrifugal force lifts the worn balls off before any criterion is met."""
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
def test_a_bearing_at_standstill_reaches_no_criterion(contact, scene):
    keys = {"operation.shaft_speed_rpm": 0, "model.contact": contact}
    result = life(scene("gyro_s1", keys))
    assert result.status == "criterion_not_reached"
    assert "life" not in result.values


def test_a_life_by_race_control_has_no_slip_shares(scene):
    """Under a small radial load it lasts about as long as under thrust alone, within 10 %."""
    result = life(scene("gyro_s1", {"operation.radial_load_N": [0.0, 1.0]}), "race_control")
    assert result.status == "ok"
    assert result.attrs["fidelity"] == "race_control"
    thrust = life(scene("gyro_s1")).values["life"]
    assert_allclose(result.values["life"], thrust, rtol=0.1)
    assert not {"history_gyroscopic_slip_share", "history_skid_ratio"} & result.values.keys()
