"""Estimated errors against true ones; `benchmarks/estimates.py` does the same on many more."""

import numpy as np
import pytest
from support import benchmark

from bearingwear.lives.life import life
from bearingwear.scene.accuracy import NAMED_PRESETS, PRESETS, accuracy_preset
from bearingwear.solvers.solve import solve

NUMBERS = ("total_qv", "residual_preload", "ball_diameter_loss_rate", "shaft_torque")


def covered(rows, name) -> float:
    """Returns the share of the estimates of a number that are at least its error.

    rows: name, estimate and error of each number of each scene.
    """
    pairs = np.array([(bound, error) for key, bound, error in rows if key == name])
    assert len(pairs) > 0 and np.isfinite(pairs).all() and (pairs[:, 0] > 0.0).all()
    return float(np.mean(pairs[:, 0] >= pairs[:, 1]))


@pytest.mark.long
def test_estimates_of_random_steady_scenes_cover_the_error():
    """They do in 95 of 100 scenes; half of those of QV are below ten times the error."""
    rows = benchmark("estimates").steady_rows(100, seed=7)
    for name in (*NUMBERS, "life"):
        assert covered(rows, name) >= 0.95, name
    ratio = [bound / max(error, 1e-9) for name, bound, error in rows if name == "total_qv"]
    assert np.median(ratio) < 10.0


@pytest.mark.long  # of one in periodic motion: test_periodic.py
def test_estimates_of_marches_cover_the_error():
    """There are only three scenes: a single miss would leave less than the required share."""
    rows = benchmark("estimates").rows_in_time(3, seed=11, turns=25)
    for name in NUMBERS:
        assert covered(rows, name) >= 0.95, name


@pytest.mark.parametrize(
    ("key", "fine", "coarse"),
    [("friction.slip_regularisation_m_s", 1e-4, 1e-3), ("model.strips", 100, 20)],
)
def test_a_coarser_setting_has_a_larger_estimate(scene, key, fine, coarse):
    fine_values, coarse_values = (
        solve(scene("gyro_s1", {key: value, "model.quadrature": "strips"})).values
        for value in (fine, coarse)
    )
    for name in ("qv", "wear_rate", "friction_power", "shaft_torque"):
        estimate = f"{name}_error_estimate"
        assert (np.asarray(fine_values[estimate]) < np.asarray(coarse_values[estimate])).all(), name


def test_an_undetermined_case_has_no_estimate(scene):
    values = solve(scene("gyro_s1", {"friction.ball_race": 0.0}), "steady").values
    assert "qv_error_estimate" not in values


def test_a_life_that_reaches_no_criterion_has_no_estimate(scene):
    """A spring keeps its preload for ever."""
    end = {"ball_diameter_loss_um": None, "preload_fraction": 1e-6}
    result = life(scene("gyro_s1", {f"wear.end_of_life.{k}": v for k, v in end.items()}))
    assert result.status == "criterion_not_reached"
    assert "life_error_estimate" not in result.values


# the key `model.accuracy`


def test_the_accuracy_sets_keys_that_the_scene_omits(scene):
    bare = scene("gyro_s1", {"model.accuracy": "draft"})
    assert bare.model.dynamic_tolerance == NAMED_PRESETS["draft"].dynamic_tolerance
    assert bare.model.strips == NAMED_PRESETS["draft"].strips
    assert bare.friction.slip_regularisation_m_s == 1e-3  # the scene's own
    with_strips = scene("gyro_s1", {"model.accuracy": "draft", "model.strips": 60})
    assert with_strips.model.strips == 60
    assert with_strips.model.quadrature == NAMED_PRESETS["draft"].quadrature


def test_presets_become_finer_one_after_the_other():
    for finer, coarser in zip(PRESETS[1:], PRESETS[:-1], strict=True):
        assert finer.error < coarser.error
        assert finer.slip_regularisation_m_s <= coarser.slip_regularisation_m_s
        assert finer.dynamic_tolerance <= coarser.dynamic_tolerance
        assert finer.simulated_turns >= coarser.simulated_turns


def test_a_required_error_takes_the_coarsest_preset_that_has_it():
    """If none has it, the finest is taken."""
    assert accuracy_preset(PRESETS[1].error) is PRESETS[1]
    assert accuracy_preset(0.999 * PRESETS[1].error) is PRESETS[2]
    assert accuracy_preset(1.0) is PRESETS[0] and accuracy_preset(1e-9) is PRESETS[-1]
    assert accuracy_preset("standard") is NAMED_PRESETS["standard"]


@pytest.mark.parametrize("name", ["gyro_s1", "turbopump", "bearing218"])
def test_the_steady_error_is_what_the_preset_promises(scene, name):
    def total_qv(accuracy):
        keys = NAMED_PRESETS[accuracy].keys(scene(name).model.slip_region)
        keys["wear.ball_diameter_loss_um"] = 0.2
        return solve(scene(name, keys), "steady").values["total_qv"]

    reference = total_qv("reference")
    for accuracy in ("draft", "standard"):
        assert abs(total_qv(accuracy) / reference - 1.0) < NAMED_PRESETS[accuracy].error, accuracy
