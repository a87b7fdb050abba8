"""The default regularisation of friction, which depends on the mean slip of a scene."""

import numpy as np
import pytest

import bearingwear
from bearingwear.scene.accuracy import NAMED_PRESETS
from bearingwear.scene.new.scene_file import checked_scene, scene_text
from bearingwear.scene.read import load_scene, scene_from_dict, variant
from bearingwear.scene.slip import default_regularisation, mean_slip
from bearingwear.solvers.solve import solve

SPINDLE, _ = scene_text("spindle", 40.0, 68.0, {"operation.shaft_speed_rpm": 18_000.0})

SPEED, KEY = "operation.shaft_speed_rpm", "friction.slip_regularisation_m_s"
STANDARD = NAMED_PRESETS["standard"].slip_regularisation_m_s


@pytest.fixture
def spindle():
    """Returns a scene of `new` at 18 000 r/min."""
    return checked_scene(SPINDLE)


def random_slow_scene(draw: np.random.Generator):
    """Returns a random scene of `new` at 0.1 to 100 r/min, whose outer ring may turn, too."""
    bore = draw.choice([4.0, 10.0, 25.0, 40.0, 100.0])
    text, _ = scene_text(
        "slow",
        bore,
        bore * draw.uniform(1.6, 2.0) + 3.0,
        {"bearing.contact_angle_deg": draw.uniform(8.0, 45.0)},
        ball_material=str(draw.choice(["bearing_steel", "silicon_nitride"])),
        preload_method=str(draw.choice(["constant_force", "fixed_position"])),
    )
    scene = checked_scene(text)
    rpm = 10.0 ** draw.uniform(-1.0, 2.0)
    return scene.with_(
        {
            SPEED: rpm,
            "operation.outer_speed_rpm": draw.choice([0.0, rpm * draw.uniform(-1.0, 0.9)]),
            "operation.preload_N": scene.operation.preload_N * 10.0 ** draw.uniform(-2.0, 1.0),
            "friction.ball_race": 10.0 ** draw.uniform(-2.0, -0.4),
            "model.contact": str(draw.choice(["hertz", "paper"])),
        }
    )


def test_the_default_regularisation_keeps_coulombs_torque_in_slow_scenes():
    """A regularisation ten times smaller changes the torque by less than 0.1 %; nothing warns.

    The allowed error is 0.01 % with balls that slide as much everywhere (docs/verification.md).
    """
    draw = np.random.default_rng(5)
    for _ in range(40):
        scene = random_slow_scene(draw)
        result = solve(scene)
        assert result.values["status"] == 0 and "slip_rounded" not in result.attrs["warnings"]
        v_r = scene.friction.slip_regularisation_m_s
        assert v_r < STANDARD
        finer = solve(variant(scene, {KEY: max(0.1 * v_r, 1e-9)})).values
        assert abs(result.values["shaft_torque"] / finer["shaft_torque"] - 1.0) < 1e-3


def test_the_estimated_slip_is_near_that_of_the_solve():
    """It is 1.04 to 1.61 times the slip of the solve, QV over the load, in these 20 scenes.

    The limits of 1 and 1.8 allow somewhat more, as the estimate may be rough.
    """
    draw = np.random.default_rng(6)
    for _ in range(20):
        scene = random_slow_scene(draw)
        values = solve(scene).values
        load = scene.bearing.ball_count * values["contact_load"].sum()
        assert 1.0 < mean_slip(scene) / (values["total_qv"] / load) < 1.8


def test_the_estimated_slip_is_the_same_for_either_sign_of_a_rotating_load(spindle):
    """1000 N outweigh the preload; the sign of the load only turns it by 180 degrees."""
    ahead, behind = (spindle.with_({"operation.rotating_load_N": F}) for F in (1000.0, -1000.0))
    assert mean_slip(ahead) == mean_slip(behind) > mean_slip(spindle)


@pytest.mark.parametrize("name", sorted(NAMED_PRESETS))
def test_the_default_regularisation_is_that_of_the_preset_at_speed_and_at_rest(spindle, name):
    scene = variant(spindle, {"model.accuracy": name})
    preset = NAMED_PRESETS[name].slip_regularisation_m_s
    assert scene.friction.slip_regularisation_m_s == preset
    assert scene.with_({SPEED: 0.0}).friction.slip_regularisation_m_s == preset
    slow = scene.with_({SPEED: 60.0}).friction.slip_regularisation_m_s
    assert slow == default_regularisation(scene.with_({SPEED: 60.0}))
    assert slow < 0.05 * preset  # 60 r/min are a 300th of the speed


def test_the_default_regularisation_follows_the_speed_of_variants_and_cases(spindle):
    slow = spindle.with_({SPEED: 60.0})
    assert slow.with_({SPEED: 18_000.0}).friction.slip_regularisation_m_s == STANDARD
    with_cases = spindle.with_({"cases": {"slow": {SPEED: 60.0}}})
    v_r = with_cases.in_cases["slow"].friction.slip_regularisation_m_s
    assert v_r == slow.friction.slip_regularisation_m_s
    assert v_r < STANDARD


# the first is also the default at the speed of the spindle
GIVEN = pytest.mark.parametrize("given", [STANDARD, 1e-3, 1e-6])


@GIVEN
def test_a_given_regularisation_is_kept_when_a_scene_is_changed(spindle, given):
    """It stays at a speed that is set alone, with other keys, in a case or after `to_dict`."""
    scene = spindle.with_({KEY: given})
    for slow in (
        scene.with_({SPEED: 60.0}),
        scene.with_({"operation.preload_N": 50.0}).with_({SPEED: 60.0, "model.strips": 30}),
        scene.with_({"friction.ball_race": 0.1, SPEED: 60.0}),
        scene.with_({"cases": {"slow": {SPEED: 60.0}}}).in_cases["slow"],
        scene_from_dict(scene.to_dict()).with_({SPEED: 60.0}),
    ):
        assert slow.friction.slip_regularisation_m_s == given


@GIVEN
def test_a_regularisation_given_in_a_file_is_kept(given, tmp_path):
    file = tmp_path / "given.yaml"
    block = f"\nfriction:\n  slip_regularisation_m_s: {given:f}"
    file.write_text(SPINDLE.replace("\nfriction:", block, 1), encoding="utf-8")
    assert load_scene(file, [f"{SPEED}=60"]).friction.slip_regularisation_m_s == given


@pytest.mark.parametrize("changes", [{}, {KEY: STANDARD}], ids=["default", "given"])
def test_a_written_scene_remembers_whether_its_regularisation_was_given(spindle, changes, tmp_path):
    scene = spindle.with_(changes)
    bearingwear.save(scene, tmp_path / "a.yaml")
    slow = load_scene(tmp_path / "a.yaml").with_({SPEED: 60.0})
    assert slow.friction == scene.with_({SPEED: 60.0}).friction
