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
ALONE = POSITION | SHORT | THREE | {"cage": None}
COATED = {"materials.bearing_steel.wear_coefficient": 5e-8}
CAGE = POSITION | SHORT | COATED | {"model.life_run_in_turns": 10, "model.life_steps": 3}


@pytest.fixture(scope="module")
def even(scene):
    """Equal balls under thrust, no cage: what the steady life has, too."""
    return life(scene("gyro_s1", ALONE), "dynamic")


def test_agrees_with_the_steady_life(scene, even):
    values = even.values
    assert values["status"] == code.OK and CRITERIA[values["end_criterion"]] == "preload_fraction"
    steady = life(scene("gyro_s1", ALONE), "steady").values
    assert_allclose(values["steady_life"], steady["life"], rtol=1e-6)
    relative = abs(values["life"] / steady["life"] - 1.0)
    assert relative <= values["life_error_estimate"] <= 0.05
    assert relative <= 0.01  # six steps
    # The state depends on the loss alone: the preload is gone at the same one.
    assert_allclose(values["loss_at_end"], steady["loss_at_end"], rtol=1e-3)
    assert_allclose(values["steady_time_to_loss"], steady["life"], rtol=1e-3)


def test_mass_balance(even):
    """What has worn is the sum of the steps, and the volume of a ball that of its diameter."""
    values = even.values
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
    # The rate counts the pressed surface at the present fit: 0.5 um of 2 mm, squared.
    assert_allclose(values["history_ball_worn_volume"], sphere, rtol=1e-3)
    lost = worn.mean(axis=1) + values["history_groove_depth"]
    assert_allclose(values["history_ball_diameter_loss"], lost, rtol=1e-12)


def test_halved_steps_stay_within_the_bound(scene, even):
    finer = life(scene("gyro_s1", ALONE | {"model.life_steps": 12}), "dynamic").values
    change = abs(finer["life"] - even.values["life"])
    assert change <= even.values["life_error_bound"]
    assert finer["life_error_bound"] < even.values["life_error_bound"]


def test_each_run_continues_from_the_one_before(even):
    assert np.array_equal(even.values["history_start"], [0, *[1] * (even.attrs["solves"] - 1)])
    assert np.all(np.array(even.values["history_status"]) == code.OK)


def test_same_bytes_twice_and_back(scene, tmp_path):
    s = scene("gyro_s1", ALONE | {"model.life_steps": 2, "model.simulated_turns": 1,
                                  "model.evaluated_turns": 1})  # fmt: skip
    for name in "ab":
        write_result(life(s, "dynamic"), tmp_path / name)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    dataset = load(tmp_path / "a")
    assert dataset["life"].units == "h" and "cell_methods" not in dataset["life"].attrs
    assert dataset.sizes["ball"] == 3


def test_a_smaller_ball_wears_less(scene):
    """Without a cage the less loaded ball loses less, and unequal balls become more equal.

    Of three balls each would carry a third.
    """
    loss = {"wear.ball_diameter_loss_um": [0.1, *[0.0] * 8]}
    s = scene("gyro_s1", POSITION | SHORT | {"cage": None, "model.life_steps": 4} | loss)
    result = life(s, "dynamic")
    values, worn = result.values, result.values["history_worn_diameter"][-1]
    assert values["status"] == code.OK
    assert worn[0] < 0.9 * worn[1:].min()
    assert "ball diameters" in result.attrs["steady_life_of"]  # a steady life has equal ones


@pytest.fixture(scope="module")
def cage_ends(scene):
    """The cage wears as before, balls and races a hundredth as fast."""
    limit = {"wear.end_of_life.pocket_clearance_mm": 0.17}
    return life(scene("gyro_s1", CAGE | limit), "dynamic")


def test_the_cage_ends_the_life(cage_ends):
    values = cage_ends.values
    assert (
        values["status"] == code.OK and CRITERIA[values["end_criterion"]] == "pocket_clearance_mm"
    )
    assert_allclose(values["history_pocket_clearance"][-1], 0.17e-3, rtol=1e-4)
    assert values["history_pocket_clearance"][0] == pytest.approx(0.15e-3)
    assert values["life"] < 0.5 * values["steady_life"]
    # No run estimates the error of a clearance's growth.
    assert "life_error_estimate" not in values and np.isfinite(values["life_error_bound"])
    t = values["history_time"]
    worn = np.trapezoid(values["history_pocket_wear_rate"], t, axis=0)
    assert_allclose(values["history_pocket_worn_volume"][-1], worn, rtol=1e-12)


def test_a_film_of_the_cage_wears_through(scene):
    """The film, which wears a fifth as fast, then the cage itself, in the same motion."""
    caged = scene("gyro_s1", CAGE)
    material = caged.materials[caged.cage.material]
    film = {"thickness_um": 0.5, "wear_coefficient": 0.2 * material.wear_coefficient}
    limit = {
        "model.cage_results": True,
        "cage.film": film,
        "wear.end_of_life": {"pocket_clearance_mm": 0.153},
    }
    values = life(caged.with_(limit), "dynamic").values
    assert (
        values["status"] == code.OK and CRITERIA[values["end_criterion"]] == "pocket_clearance_mm"
    )
    time, share = values["history_time"], values["history_pocket_film_worn_share"]
    gone = np.flatnonzero(np.diff(time) == 0.0)[0]
    assert share[gone] == share[gone + 1] == pytest.approx(1.0, rel=1e-4)
    # 0.153 mm are three times the film
    assert share[-1] == pytest.approx(3.0, rel=1e-3)
    before, after = values["history_pocket_wear_rate"][gone : gone + 2].sum(axis=1)
    assert after / before == pytest.approx(5.0, rel=0.05)


def test_a_cage_with_a_weight_lives_longer(scene, cage_ends):
    """It hangs on its balls for these few turns, where the weightless one goes round in them."""
    changes = {"operation.gravity_m_s2": [0.0, 0.0, -9.81]}
    changes |= {"wear.end_of_life.pocket_clearance_mm": 0.17}
    values, weightless = life(scene("gyro_s1", CAGE | changes), "dynamic").values, cage_ends.values
    assert values["status"] == code.OK
    rates = [item["history_pocket_wear_rate"][0].sum() for item in (values, weightless)]
    assert rates[0] < 0.3 * rates[1]
    assert values["life"] > 1.5 * weightless["life"]


def test_the_ball_ends_the_life_where_the_cage_is_far_from_its_limit(scene):
    limits = {"pocket_clearance_mm": 0.5, "ball_diameter_loss_um": 0.1}
    values = life(scene("gyro_s1", CAGE | {"wear.end_of_life": limits}), "dynamic").values
    assert CRITERIA[values["end_criterion"]] == "ball_diameter_loss_um"
    assert 0.15e-3 < values["history_pocket_clearance"][-1] < 0.5e-3
    # The cage costs little of it: balls wear in their pockets, too.
    assert_allclose(values["life"], values["steady_life"], rtol=0.05)


def test_wear_opens_pockets_and_land(scene):
    """Volume over the share of the surface that wears, and the next run sees it."""
    parts = WornParts(scene("gyro_s1", {"cage.worn_share": 0.5}))
    p = parts.layout
    worn = np.zeros(p.size)
    wall, surface = math.pi * 2.15e-3 * 1e-3, math.pi * 8.6e-3 * 3e-3
    worn[p.pocket] = 0.5 * wall * 5e-6
    worn[p.land] = 0.5 * surface * 2e-6
    worn[p.diameter], worn[p.groove] = 0.2e-6, (0.1e-6, 0.2e-6)
    pocket, guide = parts.clearances(worn)
    assert_allclose([pocket, guide], [160.2e-6, 204e-6], rtol=1e-12)
    after = parts.worn_scene(worn)
    assert after.wear.ball_diameter_loss_um == pytest.approx([0.5])
    assert after.cage.guide_clearance_mm == pytest.approx(0.204)
    # Balls are 0.5 um smaller to the fit, but have 0.2 um of play from their own wear.
    assert after.cage.pocket_clearance_mm + 0.5e-3 == pytest.approx(0.1602)


def test_a_state_without_solution_ends_a_dynamic_life(scene, tmp_path):
    """Worn far beyond where the balls lose the inner race, in one step."""
    changes = ALONE | {"wear.end_of_life": {"ball_diameter_loss_um": 90.0}, "model.life_steps": 2}
    result = life(scene("gyro_s1", changes), "dynamic")
    values = result.values
    assert result.status in ("contact_lost", "preload_gone", "race_unseated", "beyond_groove")
    assert CRITERIA[values["end_criterion"]] == "none"
    # What was solved is kept, and so is where it stopped.
    assert (
        values["history_status"][0] == code.OK and values["history_status"][-1] == values["status"]
    )
    assert values["history_ball_wear_rate"][0] > 0.0 and np.isnan(
        values["history_ball_wear_rate"][-1]
    )
    write_result(result, tmp_path / "x.nc")
    assert load(tmp_path / "x.nc")["history_status"].values.tolist() == values["history_status"]


def test_a_cage_worn_to_pieces_is_no_traceback(scene):
    wearing = Motion(scene("gyro_s1", CAGE))
    worn = wearing.start
    worn[wearing.parts.layout.pocket] = 1.0
    (state,) = wearing.state(worn)
    assert state.status == code.CRITERION_NOT_REACHED


def test_met_from_the_start(scene):
    values = life(
        scene("gyro_s1", ALONE | {"wear.end_of_life.gyroscopic_slip_share": 0.01}), "dynamic"
    ).values
    assert CRITERIA[values["end_criterion"]] == "gyroscopic_slip_share" and values["life"] == 0.0


def test_integration_error():
    """Parabolas have no scatter; of noise the error is what it does to the sum."""
    t = np.linspace(0.0, 1.0, 9)
    smooth = integration_error(t, 1.0 + t * t)
    assert_allclose(smooth, (1.0 / 8.0) ** 2 / 6.0, rtol=1e-6)  # h^2 f''/12 over 1
    random = np.random.default_rng(0)
    within = 0
    for _ in range(200):
        noise = 0.1 * random.standard_normal(9)
        within += abs(np.trapezoid(noise, t)) <= integration_error(t, 1.0 + noise)
    assert within > 180
    assert math.isnan(integration_error(t[:2], t[:2]))
    assert integration_error(t[[0, 1, 2, 3]], np.ones(4)) < 1e-15
