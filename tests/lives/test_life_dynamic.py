"""Dynamic wear life: against the steady life, its accounts, its end by ball or cage."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.kernels import status as code
from bearingwear.lives.errors import integration_error
from bearingwear.lives.life import life
from bearingwear.lives.motion import Motion
from bearingwear.lives.worn_parts import WornParts
from bearingwear.results.netcdf import load, write_result
from bearingwear.scene.blocks import CRITERIA

POSITION = {"operation.preload_method": "fixed_position"}
# Few turns are enough where no cage moves: the state under thrust alone is steady from the start.
SHORT = {"model.simulated_turns": 6, "model.evaluated_turns": 3, "model.life_steps": 6}
# Three balls move as nine do, each under the same load, in a third of the time.
THREE = {"bearing.ball_count": 3, "operation.preload_N": 7.0 / 3.0}
WITHOUT_CAGE = POSITION | SHORT | THREE | {"cage": None}
COATED = {"materials.bearing_steel.wear_coefficient": 5e-8}
"""Races and balls that wear a hundredth as fast, so that the cage may end the life."""
WITH_CAGE = POSITION | SHORT | COATED | {"model.life_run_in_turns": 10, "model.life_steps": 3}


@pytest.fixture(scope="module")
def equal_balls_life(scene):
    """Returns the dynamic life of equal balls under thrust without a cage."""
    return life(scene("gyro_s1", WITHOUT_CAGE), "dynamic")


def test_a_dynamic_life_of_equal_balls_is_the_steady_one(scene, equal_balls_life):
    """Its error is within its own estimate, which is 5 % at most; it ends at the same loss."""
    values = equal_balls_life.values
    assert values["status"] == code.OK and CRITERIA[values["end_criterion"]] == "preload_fraction"
    steady = life(scene("gyro_s1", WITHOUT_CAGE), "steady").values
    assert_allclose(values["steady_life"], steady["life"], rtol=1e-6)
    error = abs(values["life"] / steady["life"] - 1.0)
    assert error <= values["life_error_estimate"] <= 0.05
    assert error <= 0.01  # what six steps leave out
    # the state depends on the loss alone: the preload is gone at the same one
    assert_allclose(values["loss_at_end"], steady["loss_at_end"], rtol=1e-3)
    assert_allclose(values["steady_time_to_loss"], steady["life"], rtol=1e-3)


def test_worn_volumes_add_up_and_are_those_of_the_worn_diameters(equal_balls_life):
    """A step adds its mean rate times its time. What is left of a ball is a sphere."""
    values = equal_balls_life.values
    t = values["history_time"]
    for volume, rate in (
        ("history_ball_worn_volume", "history_each_ball_wear_rate"),
        ("history_race_worn_volume", "history_race_wear_rate"),
    ):
        steps = np.diff(values[volume], axis=0)
        means = 0.5 * (values[rate][1:] + values[rate][:-1])
        assert_allclose(steps, means * np.diff(t)[:, None], rtol=1e-10)
        assert_allclose(values[volume][-1], np.trapezoid(values[rate], t, axis=0), rtol=1e-12)
        assert np.all(steps > 0.0)
    D0, worn = 2e-3, values["history_worn_diameter"]
    sphere = math.pi / 6.0 * (D0**3 - (D0 - worn) ** 3)
    # the rate takes the surface of the present ball, which 0.5 um less of 2 mm change by 5e-4
    assert_allclose(values["history_ball_worn_volume"], sphere, rtol=1e-3)
    lost = worn.mean(axis=1) + values["history_groove_depth"]
    assert_allclose(values["history_ball_diameter_loss"], lost, rtol=1e-12)


def test_halved_steps_stay_within_the_bound(scene, equal_balls_life):
    """Twelve steps change a life of six by less than its stated bound, and have a smaller one."""
    values = equal_balls_life.values
    finer = life(scene("gyro_s1", WITHOUT_CAGE | {"model.life_steps": 12}), "dynamic").values
    assert abs(finer["life"] - values["life"]) <= values["life_error_bound"]
    assert finer["life_error_bound"] < values["life_error_bound"]


def test_each_run_continues_from_the_one_before(equal_balls_life):
    """`history_start` is 0 for a run from its own start, and 1 for one that goes on."""
    values, runs = equal_balls_life.values, equal_balls_life.attrs["solves"]
    assert np.array_equal(values["history_start"], [0, *[1] * (runs - 1)])
    assert np.all(np.array(values["history_status"]) == code.OK)


def test_a_dynamic_life_is_written_to_the_same_bytes_and_read_with_units(scene, tmp_path):
    few = {"model.life_steps": 2, "model.simulated_turns": 1, "model.evaluated_turns": 1}
    s = scene("gyro_s1", WITHOUT_CAGE | few)
    for name in "ab":
        write_result(life(s, "dynamic"), tmp_path / name)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    dataset = load(tmp_path / "a")
    assert dataset["life"].units == "h" and "cell_methods" not in dataset["life"].attrs
    assert dataset.sizes["ball"] == 3


def test_a_smaller_ball_wears_less(scene):
    """Without a cage the less loaded ball loses less, and unequal balls become more equal.

    There are nine balls, because each of three would carry a third, whatever its diameter. The
    first is 0.1 um smaller and loses a tenth less than any other: a bound, not a figure.
    """
    loss = {"wear.ball_diameter_loss_um": [0.1, *[0.0] * 8]}
    s = scene("gyro_s1", POSITION | SHORT | {"cage": None, "model.life_steps": 4} | loss)
    result = life(s, "dynamic")
    values, worn = result.values, result.values["history_worn_diameter"][-1]
    assert values["status"] == code.OK
    assert worn[0] < 0.9 * worn[1:].min()
    assert "ball diameters" in result.attrs["steady_life_of"]  # a steady life has equal ones


@pytest.fixture(scope="module")
def life_ended_by_its_cage(scene):
    """Returns a life that ends when the pockets are 0.02 mm wider than when new."""
    limit = {"wear.end_of_life.pocket_clearance_mm": 0.17}
    return life(scene("gyro_s1", WITH_CAGE | limit), "dynamic")


def test_the_cage_ends_the_life(life_ended_by_its_cage):
    """It ends at the limit of the clearance, before the balls would end it.

    The worn volume is the integral of its rate.
    """
    values = life_ended_by_its_cage.values
    assert values["status"] == code.OK
    assert CRITERIA[values["end_criterion"]] == "pocket_clearance_mm"
    assert_allclose(values["history_pocket_clearance"][-1], 0.17e-3, rtol=1e-4)  # the limit
    assert values["history_pocket_clearance"][0] == pytest.approx(0.15e-3)  # of the scene
    assert values["life"] < 0.5 * values["steady_life"]
    # no run estimates the error of a clearance's growth
    assert "life_error_estimate" not in values and np.isfinite(values["life_error_bound"])
    t = values["history_time"]
    worn = np.trapezoid(values["history_pocket_wear_rate"], t, axis=0)
    assert_allclose(values["history_pocket_worn_volume"][-1], worn, rtol=1e-12)


def test_a_film_of_the_cage_wears_through(scene):
    """The film wears a fifth as fast as the cage, which wears after it in the same motion."""
    caged = scene("gyro_s1", WITH_CAGE)
    material = caged.materials[caged.cage.material]
    film = {"thickness_um": 0.5, "wear_coefficient": 0.2 * material.wear_coefficient}
    limit = {
        "model.cage_results": True,
        "cage.film": film,
        "wear.end_of_life": {"pocket_clearance_mm": 0.153},
    }
    values = life(caged.with_(limit), "dynamic").values
    assert values["status"] == code.OK
    assert CRITERIA[values["end_criterion"]] == "pocket_clearance_mm"
    time, share = values["history_time"], values["history_pocket_film_worn_share"]
    gone = np.flatnonzero(np.diff(time) == 0.0)[0]  # two states at the time of the wear-through
    assert share[gone] == share[gone + 1] == pytest.approx(1.0, rel=1e-4)
    # pockets that are 3 um wider have lost 1.5 um at each side, three times the film
    assert share[-1] == pytest.approx(3.0, rel=1e-3)
    filmed, bare = values["history_pocket_wear_rate"][gone : gone + 2].sum(axis=1)
    assert bare / filmed == pytest.approx(5.0, rel=0.05)  # as the wear coefficients


def test_a_cage_with_a_weight_lives_longer(scene, life_ended_by_its_cage):
    """It hangs on its balls for these few turns, where the weightless one goes round in them."""
    changes = {"operation.gravity_m_s2": [0.0, 0.0, -9.81]}
    changes |= {"wear.end_of_life.pocket_clearance_mm": 0.17}  # as of the weightless cage
    heavy = life(scene("gyro_s1", WITH_CAGE | changes), "dynamic").values
    weightless = life_ended_by_its_cage.values
    assert heavy["status"] == code.OK
    heavy_rate, weightless_rate = (
        values["history_pocket_wear_rate"][0].sum() for values in (heavy, weightless)
    )
    assert heavy_rate < 0.3 * weightless_rate
    assert heavy["life"] > 1.5 * weightless["life"]


def test_the_ball_ends_the_life_where_the_cage_is_far_from_its_limit(scene):
    limits = {"pocket_clearance_mm": 0.5, "ball_diameter_loss_um": 0.1}
    values = life(scene("gyro_s1", WITH_CAGE | {"wear.end_of_life": limits}), "dynamic").values
    assert CRITERIA[values["end_criterion"]] == "ball_diameter_loss_um"
    assert 0.15e-3 < values["history_pocket_clearance"][-1] < 0.5e-3
    # the cage costs little of it: balls wear in their pockets, too
    assert_allclose(values["life"], values["steady_life"], rtol=0.05)


def test_wear_opens_pockets_and_land(scene):
    """A depth is the worn volume over half of a surface (`worn_share`); the next run has it.

    Pockets are 2.15 mm wide, the land 8.6 mm in diameter, with play of 0.15 and 0.2 mm when new.
    """
    parts = WornParts(scene("gyro_s1", {"cage.worn_share": 0.5}))
    p = parts.layout
    worn = np.zeros(p.size)
    # pocket: diameter of ball and clearance, 1 mm of wall; land: outer diameter, width
    pocket_area, land_area = math.pi * 2.15e-3 * 1e-3, math.pi * 8.6e-3 * 3e-3
    worn[p.pocket] = 0.5 * pocket_area * 5e-6
    worn[p.land] = 0.5 * land_area * 2e-6
    worn[p.diameter], worn[p.groove] = 0.2e-6, (0.1e-6, 0.2e-6)
    pocket, guide = parts.clearances(worn)
    # twice the depths of 5 and 2 um, and for the pocket what the ball has lost
    assert_allclose([pocket, guide], [150e-6 + 10e-6 + 0.2e-6, 200e-6 + 4e-6], rtol=1e-12)
    after = parts.worn_scene(worn)
    assert after.wear.ball_diameter_loss_um == pytest.approx([0.2 + 0.1 + 0.2])
    assert after.cage.guide_clearance_mm == pytest.approx(0.204)
    # balls are 0.5 um smaller to the fit, but have 0.2 um of play from their own wear
    assert after.cage.pocket_clearance_mm + 0.5e-3 == pytest.approx(0.1602)


def test_a_state_without_solution_ends_a_dynamic_life(scene, tmp_path):
    """In one step, the balls wear far beyond where they lose the inner race.

    The status depends on which contact is lost first; any of four is right.
    """
    end = {"wear.end_of_life": {"ball_diameter_loss_um": 90.0}, "model.life_steps": 2}
    changes = WITHOUT_CAGE | end
    result = life(scene("gyro_s1", changes), "dynamic")
    values = result.values
    assert result.status in ("contact_lost", "preload_gone", "race_unseated", "beyond_groove")
    assert CRITERIA[values["end_criterion"]] == "none"
    # what was solved is kept, and so is where it stopped
    statuses, rates = values["history_status"], values["history_ball_wear_rate"]
    assert statuses[0] == code.OK and statuses[-1] == values["status"]
    assert rates[0] > 0.0 and np.isnan(rates[-1])
    write_result(result, tmp_path / "x.nc")
    assert load(tmp_path / "x.nc")["history_status"].values.tolist() == values["history_status"]


def test_a_cage_worn_to_pieces_has_a_status(scene):
    wearing = Motion(scene("gyro_s1", WITH_CAGE))
    worn = wearing.start
    worn[wearing.parts.layout.pocket] = 1.0  # [m3], far more than there is
    (state,) = wearing.state(worn)
    assert state.status == code.CRITERION_NOT_REACHED


def test_a_criterion_met_when_new_gives_a_dynamic_life_of_zero(scene):
    """The balls of gyro_s1 have more than a share of 1 % of gyroscopic slip from the start."""
    limit = {"wear.end_of_life.gyroscopic_slip_share": 0.01}
    values = life(scene("gyro_s1", WITHOUT_CAGE | limit), "dynamic").values
    assert CRITERIA[values["end_criterion"]] == "gyroscopic_slip_share" and values["life"] == 0.0


NINE_TIMES = np.linspace(0.0, 1.0, 9)


def test_the_integration_error_of_a_parabola_is_that_of_trapezoids():
    error = integration_error(NINE_TIMES, 1.0 + NINE_TIMES**2)
    h, second_derivative = 1.0 / 8.0, 2.0
    assert_allclose(error, h**2 * second_derivative / 12.0, rtol=1e-6)


def test_the_integration_error_covers_what_noise_does_to_the_sum():
    """It covers 90 % of the sums of nine noisy rates: 0.900 of 20 000 other draws.

    Two standard errors would cover 95 %, if the deviation of the noise were known. Here it is
    estimated from six third differences. The draws here may miss 90 % by three standard deviations
    of their share.
    """
    expected, draws = 0.9, 2000
    noises = 0.1 * np.random.default_rng(0).standard_normal((draws, NINE_TIMES.size))
    covered = [
        abs(np.trapezoid(noise, NINE_TIMES)) <= integration_error(NINE_TIMES, 1.0 + noise)
        for noise in noises
    ]
    scatter = math.sqrt(expected * (1.0 - expected) / draws)
    assert np.mean(covered) > expected - 3.0 * scatter


def test_the_integration_error_is_zero_of_a_constant_and_unknown_of_two_points():
    assert integration_error(NINE_TIMES[:4], np.ones(4)) < 1e-15  # rounding
    assert math.isnan(integration_error(NINE_TIMES[:2], NINE_TIMES[:2]))
