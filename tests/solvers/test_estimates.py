"""Estimated errors against true ones; `benchmarks/estimates.py` does the same on many more."""

from dataclasses import replace

import numpy as np
import pytest
from support import benchmark

from bearingwear.lives.life import life
from bearingwear.scene.accuracy import NAMED_PRESETS, PRESETS, accuracy_preset
from bearingwear.solvers.solve import solve

NUMBERS = ("total_qv", "residual_preload", "ball_diameter_loss_rate", "shaft_torque")


def covered(rows, name) -> float:
    pairs = np.array([(bound, error) for key, bound, error in rows if key == name])
    assert len(pairs) > 0 and np.isfinite(pairs).all() and (pairs[:, 0] > 0.0).all()
    return float(np.mean(pairs[:, 0] >= pairs[:, 1]))


@pytest.mark.long
def test_estimates_of_random_steady_scenes():
    rows = benchmark("estimates").steady_rows(100, seed=7)
    for name in (*NUMBERS, "life"):
        assert covered(rows, name) >= 0.95
    # and they are no empty promises: half of them are within ten times the error
    ratio = [bound / max(error, 1e-9) for name, bound, error in rows if name == "total_qv"]
    assert np.median(ratio) < 10.0


@pytest.mark.long  # of one in periodic motion: test_periodic.py
def test_estimates_in_time():
    rows = benchmark("estimates").rows_in_time(3, seed=11, turns=25)
    for name in NUMBERS:
        assert covered(rows, name) >= 0.95


@pytest.mark.parametrize("key", ["slip_regularisation_m_s", "strips"])
def test_a_coarser_setting_has_a_larger_estimate(scene, key):
    fine, coarse = {"slip_regularisation_m_s": (1e-4, 1e-3), "strips": (100, 20)}[key]
    where = f"{'friction' if key != 'strips' else 'model'}.{key}"
    result = [
        solve(scene("gyro_s1", {where: value, "model.quadrature": "strips"})).values
        for value in (fine, coarse)
    ]
    names = ("qv_error_estimate", "wear_rate_error_estimate", "friction_power_error_estimate")
    for name in (*names, "shaft_torque_error_estimate"):
        assert (np.asarray(result[0][name]) < np.asarray(result[1][name])).all()


def test_no_estimate_without_an_answer(scene):
    s = scene("gyro_s1", {"friction.ball_race": 0.0})
    assert "qv_error_estimate" not in solve(s, "steady").values
    end = replace(s.wear.end_of_life, ball_diameter_loss_um=None, preload_fraction=1e-6)
    never = replace(scene("gyro_s1"), wear=replace(s.wear, end_of_life=end))
    values = life(never).values
    assert ("life_error_estimate" in values) == (values["status"] == 0)


# the dial


def test_the_accuracy_sets_keys_that_the_scene_omits(scene):
    bare = scene("gyro_s1", {"model.accuracy": "draft"})
    assert bare.model.dynamic_tolerance == NAMED_PRESETS["draft"].dynamic_tolerance
    assert bare.model.strips == NAMED_PRESETS["draft"].strips
    assert bare.friction.slip_regularisation_m_s == 1e-3  # the scene's own
    with_strips = scene("gyro_s1", {"model.accuracy": "draft", "model.strips": 60})
    assert with_strips.model.strips == 60
    assert with_strips.model.quadrature == NAMED_PRESETS["draft"].quadrature


def test_targets_take_the_cheapest_rung_that_is_meant_for_them():
    for finer, coarser in zip(PRESETS[1:], PRESETS[:-1], strict=True):
        assert finer.error < coarser.error
        assert finer.slip_regularisation_m_s <= coarser.slip_regularisation_m_s
        assert finer.dynamic_tolerance <= coarser.dynamic_tolerance
        assert finer.simulated_turns >= coarser.simulated_turns
    assert accuracy_preset(PRESETS[1].error) is PRESETS[1]
    assert accuracy_preset(0.999 * PRESETS[1].error) is PRESETS[2]
    assert accuracy_preset(1.0) is PRESETS[0] and accuracy_preset(1e-9) is PRESETS[-1]
    assert accuracy_preset("standard") is NAMED_PRESETS["standard"]


@pytest.mark.parametrize("name", ["gyro_s1", "turbopump", "bearing218"])
def test_the_steady_error_is_what_the_dial_promises(scene, name):
    def answer(accuracy):
        model = scene(name).model
        keys = NAMED_PRESETS[accuracy].keys(model.slip_region)
        keys["wear.ball_diameter_loss_um"] = 0.2
        return solve(scene(name, keys), "steady").values["total_qv"]

    right = answer("reference")
    for accuracy in ("draft", "standard"):
        assert abs(answer(accuracy) / right - 1.0) < NAMED_PRESETS[accuracy].error
