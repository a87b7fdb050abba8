"""The table of effects that `check` prints: what is on, its size and its limit."""

import json

import pytest
from support import scene_file

from bearingwear.cli import main
from bearingwear.lives.groove_life import groove_choice, wear_over_gap
from bearingwear.scene.read import load_scene
from bearingwear.solvers.effects.choice import choice
from bearingwear.solvers.effects.sizes import effect_sizes, wear_over_gap_estimate

S1 = scene_file("gyro_s1")
HELD = "operation.preload_method=fixed_position"
BY_DEPTH = "wear.end_of_life={groove_depth_um: 0.01, ball_diameter_loss_um: 0.01}"


def sizes(*changes, fidelity=None):
    """Returns the effects of gyro_s1 with some changes, by name."""
    effects = list(effect_sizes(choice(load_scene(S1, changes), fidelity)))
    assert len({effect.name for effect in effects}) == len(effects)
    return {effect.name: effect for effect in effects}


@pytest.mark.parametrize("name", ["gyro_s1", "gyro_s1_hertz", "turbopump", "bearing218"])
@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_the_estimated_wear_over_gap_is_within_5_percent_of_the_exact_one(name, method):
    """The estimate takes fitted factors of Hertz, `wear_over_gap` elliptic integrals."""
    changes = [f"operation.preload_method={method}", "wear.end_of_life.ball_diameter_loss_um=0.5"]
    scene = load_scene(scene_file(name), changes)
    assert wear_over_gap_estimate(scene) == pytest.approx(wear_over_gap(scene), rel=0.05)


@pytest.mark.parametrize(
    "changes",
    [
        [],
        ["model.contact=auto"],
        ["model.contact=auto", "wear.end_of_life={ball_diameter_loss_um: 0.001}"],
        ["model.contact=auto", BY_DEPTH],
        ["model.contact=auto", "wear.counts=ball"],
        ["model.contact=worn"],
        ["model.contact=hertz"],
    ],
)
def test_the_table_says_whether_a_life_follows_grooves(changes):
    scene = load_scene(S1, changes)
    followed = groove_choice(scene, "steady").follows
    assert sizes(*changes)["worn grooves, in a life"].is_on == followed


@pytest.mark.parametrize(
    ("name", "off", "on"),
    [
        ("growth at speed", [], ["bearing.bore_mm=4"]),
        ("temperature", [], ["temperature={inner_ring_C: 30}"]),
        ("interference fits", [], ["bearing.bore_mm=4", "fits.shaft_interference_um=1"]),
        ("slip across the ellipse", ["model.contact=paper"], ["model.contact=hertz"]),
        ("traction in normal forces", ["model.contact=paper"], ["model.contact=hertz"]),
        ("differences between balls", [], ["operation.radial_load_N=[0, 1]"]),
        ("cage", [], ["model.cage_results=true"]),
        ("lubricant drag", [], ["lubricant.drag_density_kg_m3=100"]),
    ],
)
def test_a_key_of_the_scene_turns_an_effect_on(name, off, on):
    assert not sizes(HELD, *off)[name].is_on
    assert sizes(HELD, *on)[name].is_on


def test_race_control_has_no_balance_of_friction():
    name = "friction balance of a ball"
    assert sizes()[name].is_on and not sizes(fidelity="race_control")[name].is_on


def test_a_spring_makes_temperature_an_effect_of_second_order():
    at_fixed_position = sizes(HELD)["temperature"]
    assert at_fixed_position.limit == 10.0  # % of the preload
    assert at_fixed_position.size > at_fixed_position.limit
    under_a_spring = sizes("operation.preload_method=constant_force")["temperature"]
    assert under_a_spring.size == "2nd order"


def test_check_prints_a_line_for_each_effect(capsys):
    """The line says whether the effect is on. As JSON, the table has the same rows in order."""
    assert main(["check", str(S1), "--set", HELD]) == 0
    text = capsys.readouterr().out
    assert all(len(line) < 120 for line in text.split("\n"))
    effects = sizes(HELD)
    for name, effect in effects.items():
        (line,) = (line for line in text.split("\n") if line.startswith(f"  {name} "))
        assert (" on " if effect.is_on else " off ") in line
    assert main(["check", str(S1), "--set", HELD, "--json"]) == 0
    sheet = json.loads(capsys.readouterr().out)
    assert [row["label"] for row in sheet["quantities"]] == list(effects)
    assert sheet["fidelity"] == "steady" and any("temperature" in w for w in sheet["warnings"])
