"""Worn grooves at temperatures of a network, and on both sides of a pair."""

from dataclasses import replace

import numpy as np
import pytest
from lives.test_worn_life import scene_of
from support import scene_file

from bearingwear.kernels import status as code
from bearingwear.lives.grooves import Grooves, follow_grooves
from bearingwear.lives.life import life
from bearingwear.scene.blocks import CRITERIA, EndOfLife
from bearingwear.scene.read import load_scene

END = "wear.end_of_life={preload_fraction: 0.7, ball_diameter_loss_um: 0.3}"
NETWORK = (
    "thermal={conductance_W_K: {inner_ring_shaft: 0.1, outer_ring_housing: 0.1, ball_race: 0.05}, "
    "shaft_C: 20, housing_C: 20}"
)
FIXED = "operation.preload_method=fixed_position"
RIGID = (FIXED, "arrangement.kind=rigid_pair")


def life_of(*changes, contact="worn"):
    scene = load_scene(scene_file("gyro_s1"), [f"model.contact={contact}", END, *changes])
    return life(replace(scene, cage=None)).values


def test_two_alike_are_the_single_bearing_by_way_of_the_rotor():
    single = life_of(FIXED)
    pair = life_of(*RIGID, "arrangement.external_axial_N=1e-6")
    assert pair["status"] == single["status"] == code.OK
    assert pair["life"] == pytest.approx(single["life"], rel=1e-5)
    for name in ("history_residual_preload", "history_equivalent_loss", "history_deepest_groove"):
        for side in pair[name]:
            assert side[-1] == pytest.approx(single[name][-1], rel=1e-3)


def wears_until_gone(film):
    """Whether films (steps, race) get thinner at every step, as long as there is any."""
    steps = np.diff(film, axis=0)
    return np.all(steps[film[:-1] > 0.0] < 0.0) and np.all(steps[film[:-1] == 0.0] == 0.0)


def test_films_wear_along_in_networks_and_pairs():
    """Two alike are the single bearing, of two that differ the loaded one loses its film first."""
    film = "{shear_strength_MPa: 24.8, pressure_coefficient: 0.001, thickness_um: 0.15, "
    film += "wear_coefficient: 5.0e-6, bare_ball_race: 0.4}"
    without = ("friction.ball_race=null", "uncertainty=null")
    filmed = (FIXED, *without, f"friction.film={film}")
    single, warm = life_of(*filmed), life_of(*filmed, NETWORK)
    pair = life_of(*RIGID, *filmed[1:])
    unlike = life_of(*RIGID, *filmed[1:], "arrangement.external_axial_N=1.0")
    loaded, relieved = unlike["history_race_film"][:, 1]
    assert unlike["status"] == code.OK and np.all(loaded < relieved)
    assert single["status"] == warm["status"] == pair["status"] == code.OK
    assert pair["life"] == pytest.approx(single["life"], rel=1e-5)
    assert wears_until_gone(single["history_race_film"])
    for side in pair["history_race_film"]:
        assert side[-1] == pytest.approx(single["history_race_film"][-1], rel=1e-3)
    assert np.all(warm["history_part_temperature"][:, :3] > 20.0)
    assert abs(warm["life"][1] / single["life"][1] - 1.0) > 1e-4
    assert wears_until_gone(warm["history_race_film"])


def test_a_soft_spring_is_a_constant_force():
    single = life_of("operation.preload_method=constant_force")
    spring = ("arrangement.kind=spring_pair", "arrangement.spring_stiffness_N_um=1e-5")
    pair = life_of(*spring)
    assert pair["life"] == pytest.approx(single["life"], rel=1e-3)


def test_a_rigid_pair_with_a_load_balances_and_wears_the_loaded_side_more():
    pair = life_of(*RIGID, "arrangement.external_axial_N=2.0")
    assert pair["status"] == code.OK
    one, two = pair["history_residual_preload"]
    assert one - two == pytest.approx(np.full(one.size, 2.0), abs=1e-5)
    deepest = pair["history_deepest_groove"][:, -1]
    assert (deepest[0] > deepest[1]).all()
    # the rotor goes to the side that is worn more
    shift = pair["history_rotor_axial_shift"]
    assert shift[-1] > shift[0] > 0.0
    k = pair["history_system_axial_stiffness"]
    assert (k > 0.0).all() and k[-1] < k[0]


def test_bearings_that_differ_start_as_with_unworn_grooves():
    changes = (*RIGID, "arrangement.second={friction.ball_race: 0.05}")
    pair, hertz = life_of(*changes), life_of(*changes, contact="hertz")
    assert pair["status"] == code.OK
    one, two = pair["history_residual_preload"]
    assert one == pytest.approx(two, abs=1e-5)  # no load from outside
    for name in ("history_qv", "history_contact_load", "history_residual_preload"):
        for k in range(2):
            assert pair[name][k, 0] == pytest.approx(hertz[name][k, 0], rel=1e-5)
    qv = pair["history_qv"]
    assert qv[0, 0].sum() != pytest.approx(qv[1, 0].sum(), rel=1e-3)


@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_a_network_warms_worn_grooves_as_it_warms_unworn_ones(method):
    """The start is the Hertzian one at its own temperatures; flows balance along the life."""
    changes = (f"operation.preload_method={method}", NETWORK)
    worn, hertz = life_of(*changes), life_of(*changes, contact="hertz")
    assert worn["status"] == hertz["status"] == code.OK
    for name in ("history_part_temperature", "history_residual_preload", "history_qv"):
        assert worn[name][0] == pytest.approx(hertz[name][0], rel=1e-7)
    assert worn["heat_flow_residual"] < 1e-6
    cold = life_of(f"operation.preload_method={method}")
    assert worn["history_part_temperature"][0].max() > 20.01
    assert worn["life"][1] != cold["life"][1]
    # warm balls and inner rings raise the preload at a fixed position, and with it the wear
    if method == "fixed_position":
        assert worn["history_residual_preload"][0] > cold["history_residual_preload"][0]


def test_temperatures_as_given_are_those_of_the_start():
    given = "temperature={inner_ring_C: 25, outer_ring_C: 20, balls_C: 20, reference_C: 20}"
    worn, hertz = life_of(FIXED, given), life_of(FIXED, given, contact="hertz")
    assert worn["status"] == code.OK
    assert worn["history_residual_preload"][0] == pytest.approx(
        hertz["history_residual_preload"][0], rel=1e-9
    )


def test_a_pair_that_has_no_start_says_so():
    changes = ["arrangement.kind=spring_pair", "arrangement.external_axial_N=-8"]
    scene = load_scene(scene_file("gyro_s1"), ["model.contact=worn", END, *changes])
    found = follow_grooves(Grooves(replace(scene, cage=None)))
    assert found.status == code.LIFTED_OFF and len(found.bearings) == 2
    assert life(replace(scene, cage=None)).values["status"] == code.LIFTED_OFF


def test_the_first_side_to_meet_its_criterion_ends_the_life():
    end = EndOfLife(preload_fraction=0.7)
    scene = scene_of("fixed_position", balance="with_traction", end_of_life=end)
    found = follow_grooves(Grooves(scene))
    assert found.criterion == CRITERIA.index("preload_fraction")
