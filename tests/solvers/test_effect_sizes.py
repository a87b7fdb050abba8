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
    effects = list(effect_sizes(choice(load_scene(S1, changes), fidelity)))
    assert len({effect.name for effect in effects}) == len(effects)
    return {item.name: item for item in effects}


@pytest.mark.parametrize("name", ["gyro_s1", "gyro_s1_hertz", "turbopump", "bearing218"])
@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_wear_over_gap_against_exact_factors_of_hertz(name, method):
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
    ("name", "off", "on", "fidelity"),
    [
        ("growth at speed", [], ["bearing.bore_mm=4"], None),
        ("temperature", [], ["temperature={inner_ring_C: 30}"], None),
        ("interference fits", [], ["bearing.bore_mm=4", "fits.shaft_interference_um=1"], None),
        ("slip across the ellipse", ["model.contact=paper"], ["model.contact=hertz"], None),
        ("traction in normal forces", ["model.contact=paper"], ["model.contact=hertz"], None),
        ("differences between balls", [], ["operation.radial_load_N=[0, 1]"], None),
        ("cage", [], ["model.cage_results=true"], None),
        ("lubricant drag", [], ["lubricant.drag_density_kg_m3=100"], None),
    ],
)
def test_a_key_of_the_scene_turns_an_effect_on(name, off, on, fidelity):
    assert not sizes(HELD, *off, fidelity=fidelity)[name].is_on
    assert sizes(HELD, *on, fidelity=fidelity)[name].is_on


def test_race_control_has_no_balance_of_friction():
    name = "friction balance of a ball"
    assert sizes()[name].is_on and not sizes(fidelity="race_control")[name].is_on


def test_a_spring_makes_up_for_growth():
    held, sprung = sizes(HELD)["temperature"], sizes("operation.preload_method=constant_force")
    assert held.size > held.limit == 10.0
    assert sprung["temperature"].size == "2nd order"


def test_check_prints_a_line_for_each_effect(capsys):
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
