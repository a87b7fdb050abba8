"""Worn grooves at temperatures of a network, and on both sides of a pair."""

from dataclasses import replace

import numpy as np
import pytest
from support import scene_file

import bearingwear
from bearingwear.kernels import status as code
from bearingwear.lives.grooves import Grooves, follow_grooves
from bearingwear.lives.life import life
from bearingwear.scene.read import load_scene, variant

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


def test_a_soft_spring_is_a_constant_force():
    single = life_of("operation.preload_method=constant_force")
    spring = ("arrangement.kind=spring_pair", "arrangement.spring_stiffness_N_um=1e-5")
    pair = life_of(*spring)
    assert pair["life"] == pytest.approx(single["life"], rel=1e-3)


def test_a_rigid_pair_with_a_load_balances_and_wears_the_loaded_side_more():
    pair = life_of(*RIGID, "arrangement.external_axial_N=2.0")
    assert pair["status"] == code.OK
    first, two = pair["history_residual_preload"]
    assert first - two == pytest.approx(np.full(first.size, 2.0), abs=1e-5)
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
    first, two = pair["history_residual_preload"]
    assert first == pytest.approx(two, abs=1e-5)  # no load from outside
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
    assert worn["life"] != cold["life"]
    # warm balls and inner rings raise the preload at a fixed position, and with it the wear
    if method == "fixed_position":
        assert worn["history_residual_preload"][0] > cold["history_residual_preload"][0]


def test_temperatures_as_given_are_those_of_the_start():
    temperatures = "temperature={inner_ring_C: 25, outer_ring_C: 20, balls_C: 20, reference_C: 20}"
    worn, hertz = life_of(FIXED, temperatures), life_of(FIXED, temperatures, contact="hertz")
    assert worn["status"] == code.OK
    assert worn["history_residual_preload"][0] == pytest.approx(
        hertz["history_residual_preload"][0], rel=1e-9
    )


def test_a_pair_without_a_state_when_new_has_lifted_off():
    changes = ["arrangement.kind=spring_pair", "arrangement.external_axial_N=-8"]
    scene = load_scene(scene_file("gyro_s1"), ["model.contact=worn", END, *changes])
    groove_life = follow_grooves(Grooves(replace(scene, cage=None)))
    assert groove_life.status == code.LIFTED_OFF and len(groove_life.bearings) == 2
    assert life(replace(scene, cage=None)).values["status"] == code.LIFTED_OFF


def test_a_lightly_preloaded_pair_wears_to_its_criterion():
    """At light preload, short steps predict a rotor place far off; each life still ends at its
    criterion, and more preload still means a shorter life."""
    warm = {"inner_ring_C": 40.0, "balls_C": 40.0, "outer_ring_C": 30.0}
    pair = {
        "operation.preload_method": "fixed_position",
        "arrangement": {
            "kind": "rigid_pair",
            "orientation": "back_to_back",
            "external_axial_N": 100.0,
            "span_mm": 162.0,
        },
        "temperature": warm | {"shaft_C": 40.0, "housing_C": 30.0, "reference_C": 20.0},
    }
    spindle, lives = bearingwear.new(designation="7008C", speed=18000.0), []
    for preload in (17.5, 22.0, 28.0):
        scene = variant(spindle, pair | {"operation.preload_N": preload})
        groove_life = follow_grooves(Grooves(scene))
        assert groove_life.status == code.OK
        limit = scene.wear.end_of_life.ball_diameter_loss_um
        assert 1e6 * max(state.loss for state in groove_life.last.states) == pytest.approx(
            limit, rel=1e-3
        )
        lives.append(groove_life.last.time)
    assert lives[0] > 1.01 * lives[1]
    assert lives[1] > 1.01 * lives[2]
