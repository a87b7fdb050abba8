"""Worn grooves at temperatures of a network, and on both sides of a pair."""

from dataclasses import replace

import pytest
from numpy.testing import assert_allclose
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

BALANCED_TO = 1e-5
"""Force [N] to which a rotor on worn grooves is balanced."""


def life_values(*changes, contact="worn"):
    """Returns the values of a life of gyro_s1 with worn grooves, or with Hertzian contacts."""
    scene = load_scene(scene_file("gyro_s1"), [f"model.contact={contact}", END, *changes])
    return life(replace(scene, cage=None)).values


def test_a_pair_on_a_soft_spring_lives_as_under_a_constant_force():
    """Lives agree within 0.1 %: the spring of 10 N/m relaxes as balls wear, and steps differ."""
    single = life_values("operation.preload_method=constant_force")
    spring = ("arrangement.kind=spring_pair", "arrangement.spring_stiffness_N_um=1e-5")
    assert life_values(*spring)["life"] == pytest.approx(single["life"], rel=1e-3)


def test_a_rigid_pair_with_a_load_balances_and_wears_the_loaded_side_more():
    """2 N load the first bearing: its grooves become deeper. Stiffness falls with wear."""
    pair = life_values(*RIGID, "arrangement.external_axial_N=2.0")
    assert pair["status"] == code.OK
    first, second = pair["history_residual_preload"]
    assert_allclose(first - second, 2.0, atol=BALANCED_TO)
    deepest = pair["history_deepest_groove"][:, -1]
    assert (deepest[0] > deepest[1]).all()
    # the rotor goes to the side that is worn more
    shift = pair["history_rotor_axial_shift"]
    assert shift[-1] > shift[0] > 0.0
    stiffness = pair["history_system_axial_stiffness"]
    assert (stiffness > 0.0).all() and stiffness[-1] < stiffness[0]


def test_bearings_that_differ_start_as_with_unworn_grooves():
    """The friction of the second one is 0.05, so that their QV differs."""
    changes = (*RIGID, "arrangement.second={friction.ball_race: 0.05}")
    pair, hertz = life_values(*changes), life_values(*changes, contact="hertz")
    assert pair["status"] == code.OK
    first, second = pair["history_residual_preload"]
    assert_allclose(first, second, atol=BALANCED_TO)  # no load from outside
    for name in ("history_qv", "history_contact_load", "history_residual_preload"):
        assert_allclose(pair[name][:, 0], hertz[name][:, 0], rtol=1e-5, err_msg=name)
    qv = pair["history_qv"][:, 0].sum(axis=-1)
    assert abs(qv[0] / qv[1] - 1.0) > 1e-3  # of unlike friction


@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_a_network_warms_worn_grooves_as_it_warms_unworn_ones(method):
    """The start is the Hertzian one at its own temperatures; flows balance along the life."""
    changes = (f"operation.preload_method={method}", NETWORK)
    worn, hertz = life_values(*changes), life_values(*changes, contact="hertz")
    assert worn["status"] == hertz["status"] == code.OK
    for name in ("history_part_temperature", "history_residual_preload", "history_qv"):
        assert worn[name][0] == pytest.approx(hertz[name][0], rel=1e-7)
    assert worn["heat_flow_residual"] < 1e-6
    cold = life_values(f"operation.preload_method={method}")
    assert worn["history_part_temperature"][0].max() > 20.01  # it warms itself
    assert worn["life"] != cold["life"]
    # warm balls and inner rings raise the preload at a fixed position, and with it the wear
    if method == "fixed_position":
        assert worn["history_residual_preload"][0] > cold["history_residual_preload"][0]


def test_temperatures_as_given_are_those_of_the_start():
    temperatures = "temperature={inner_ring_C: 25, outer_ring_C: 20, balls_C: 20, reference_C: 20}"
    worn = life_values(FIXED, temperatures)
    hertz = life_values(FIXED, temperatures, contact="hertz")
    assert worn["status"] == code.OK
    start = hertz["history_residual_preload"][0]
    assert worn["history_residual_preload"][0] == pytest.approx(start, rel=1e-9)


def test_a_pair_without_a_state_when_new_has_lifted_off():
    changes = ["arrangement.kind=spring_pair", "arrangement.external_axial_N=-8"]
    scene = load_scene(scene_file("gyro_s1"), ["model.contact=worn", END, *changes])
    groove_life = follow_grooves(Grooves(replace(scene, cage=None)))
    assert groove_life.status == code.LIFTED_OFF and len(groove_life.bearings) == 2
    assert life(replace(scene, cage=None)).values["status"] == code.LIFTED_OFF


def test_a_lightly_preloaded_pair_wears_to_its_criterion():
    """Each life ends at its criterion, and more preload means a shorter one, by over 1 %.

    At light preload, short steps predict a rotor place far off.
    """
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
