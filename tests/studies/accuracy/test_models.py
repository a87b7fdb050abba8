"""The reduced and the approximate models of the trade study against the full ones."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.kernels.contact.hertz import point_contact
from bearingwear.kernels.equilibrium.thrust_loaded import static_displacement
from bearingwear.lives.groove_life import wear_over_gap
from bearingwear.lives.grooves import EXACT_GROOVES, StiffGrooves, follow_grooves
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.fitted_hertz import fitted_contact, fitted_displacement
from bearingwear.solvers.solve import solve
from workflow.studies.accuracy.plan import MACHINES, WARMTHS, SweepPoint
from workflow.studies.accuracy.run import dynamic_values, first_motion, point_values, three_balls
from workflow.studies.accuracy.scenes import (
    life_of_point,
    scene_on_rotor,
    scene_with_end,
    scene_with_growth,
)

MODEL = {"model.history_points_per_turn": 0, "model.simulated_turns": 4}


@pytest.mark.parametrize("ratio", [1.0, 2.0, 5.0, 20.0, 60.0])
def test_the_fit_is_within_the_percents_its_authors_state(ratio):
    # Brewe and Hamrock: ellipticity and integrals each within 3 to 4 %, over 1 to 100. The
    # stiffness takes K^-3/2 E^1/2 kappa of them, so at a round contact, where all are at their
    # worst, it is 8.7 % off.
    A, E_star = 20.0, 1.1e11
    exact = point_contact(A, ratio * A, E_star, math.nan)
    K, c_a, c_b = fitted_contact(A, ratio * A, E_star)
    assert_allclose(c_a / c_b, exact.c_a / exact.c_b, rtol=0.04)
    assert_allclose([c_a, c_b], [exact.c_a, exact.c_b], rtol=0.035)
    assert_allclose(K, exact.K, rtol=0.09)
    assert abs(c_a / exact.c_a - 1.0) > 1e-6  # and it is a fit


def test_static_displacement_with_the_fit(scene):
    g = parameters.geometry(scene("gyro_s1"))
    exact = static_displacement(g, 7.0)
    assert_allclose(fitted_displacement(g, 7.0), exact, rtol=0.02)


@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_three_balls_stand_for_all(scene, method):
    # Thrust alone: they start in the steady state and stay there, to the tolerance of a step.
    s = scene("gyro_s1", MODEL | {"operation.preload_method": method})
    few, values = three_balls(s), solve(s, "steady").values
    for name in ("total_qv", "residual_preload"):
        assert_allclose(few[name], values[name], rtol=1e-6)
    assert_allclose(few["qv"].mean(axis=0), values["qv"][0], rtol=1e-6)
    assert_allclose(few["ball_diameter_loss_rate"], values["ball_diameter_loss_rate"], rtol=1e-6)


def test_unlike_starts_end_alike(scene):
    s = replace(scene("gyro_s1", MODEL | {"model.simulated_turns": 12}), cage=None)
    right = solve(s, "steady").values["total_qv"]
    starts = [first_motion(s, start) for start in ("steady", "race_control", "kinematic")]
    assert np.abs(starts[2] / np.broadcast_to(starts[0], 4) - 1.0)[0] > 1e-4
    for start in ("race_control", "kinematic"):
        assert_allclose(dynamic_values(s, start, False)["total_qv"], right, rtol=1e-4)


def test_the_fit_moves_the_answer_a_little(scene):
    s = replace(scene("gyro_s1", MODEL | {"model.simulated_turns": 12}), cage=None)
    exact, fit = dynamic_values(s, "steady", False), dynamic_values(s, "steady", True)
    assert fit["status"] == 0
    assert 1e-5 < abs(fit["total_qv"] / exact["total_qv"] - 1.0) < 0.03
    assert_allclose(fit["residual_preload"], exact["residual_preload"], rtol=1e-9)


@pytest.mark.parametrize("method", ["fixed_position", "constant_force"])
def test_scenes_of_each_machine_on_the_rotor(scene, method):
    held = scene("gyro_s1", {"operation.preload_method": method})
    alone, alike, pushed, apart = (scene_on_rotor(held, machine) for machine in MACHINES)
    assert alone is held and alike.pair.is_symmetric and pushed.pair.external_axial_N == 3.5
    assert apart.sides[1].wear.ball_diameter_loss_um == pytest.approx((0.04,))
    points = [SweepPoint(label=m, value=0.0, fidelity="steady", machine=m, settings=(), text=m)
              for m in MACHINES]  # fmt: skip
    rows = [point_values(held, point, 1, 1.0) for point in points]
    assert rows[1]["total_qv"] == rows[0]["total_qv"] and rows[1]["life"] == rows[0]["life"]
    assert rows[2]["residual_preload"] > 1.1 * rows[0]["residual_preload"]
    assert rows[2]["life"] < 0.8 * rows[0]["life"] and rows[3]["life"] < rows[0]["life"]


def test_each_kind_of_growth_raises_the_preload(scene):
    held = scene("gyro_s1", {"operation.preload_method": "fixed_position"})
    mounted, turning, warm, network = (scene_with_growth(held, warmth) for warmth in WARMTHS)
    assert mounted is held and turning.bearing.bore_mm == pytest.approx(4.0)
    assert warm.temperature.inner_ring_C == 25.0 and network.thermal is not None
    result = [solve(s).values["residual_preload"] for s in (mounted, turning, warm, network)]
    assert result[0] < result[1] < result[2] and abs(result[3] - result[1]) < 0.1


def test_a_life_ends_at_so_many_gaps_with_the_cells_asked_for(scene):
    s = scene("gyro_s1", {"model.contact": "worn", "cage": None})
    point = SweepPoint(label="", value=0.0, fidelity="steady", settings=(), text="", cells="32 x 8")
    small = scene_with_end(s, "0.05")
    assert_allclose(wear_over_gap(small), 0.05, rtol=1e-12)
    lived = life_of_point(small, replace(point, step="0.02"))
    mode = EXACT_GROOVES._replace(cells=(32, 8), step=0.02)
    right = follow_grooves(StiffGrooves(small, mode)).times
    assert_allclose(lived["history_time"], right, rtol=1e-12)
    assert len(right) > len(life_of_point(small, point)["history_time"])
