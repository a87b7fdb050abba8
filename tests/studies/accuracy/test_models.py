"""The reduced and the approximate models of the study of accuracy against the full ones."""

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

# settings of a dynamic run: four turns, without a history
MODEL = {"model.history_points_per_turn": 0, "model.simulated_turns": 4}


@pytest.mark.parametrize("ratio", [1.0, 2.0, 5.0, 20.0, 60.0])
def test_the_fit_is_within_the_percents_its_authors_state(ratio):
    """Brewe and Hamrock: ellipticity and integrals are each within 3 to 4 %, over 1 to 100.

    The stiffness takes K^-3/2 E^1/2 kappa of them, so at a round contact, where all are at their
    worst, it is 8.7 % off. Here K is the stiffness, c_a and c_b scale the half-axes of the ellipse.

    ratio: of the curvatures.
    """
    A, E_star = 20.0, 1.1e11  # smaller curvature [1/m], contact modulus of steel [Pa]
    exact = point_contact(A, ratio * A, E_star, math.nan)
    K, c_a, c_b = fitted_contact(A, ratio * A, E_star)
    assert_allclose(c_a / c_b, exact.c_a / exact.c_b, rtol=0.04)
    assert_allclose([c_a, c_b], [exact.c_a, exact.c_b], rtol=0.035)
    assert_allclose(K, exact.K, rtol=0.09)
    assert abs(c_a / exact.c_a - 1.0) > 1e-6  # it is the fit, and not the exact formula


def test_static_displacement_with_the_fit_is_within_2_percent(scene):
    """It is the axial displacement of gyro_s1 under its preload of 7 N."""
    g = parameters.geometry(scene("gyro_s1"))
    exact = static_displacement(g, 7.0)
    assert_allclose(fitted_displacement(g, 7.0), exact, rtol=0.02)


@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_under_thrust_three_balls_stand_for_all(scene, method):
    """A run with three balls in place of nine starts in the steady state and stays there, to 1e-6.

    Sums over balls are scaled to nine; the steady state has the same QV at each ball.
    """
    s = scene("gyro_s1", MODEL | {"operation.preload_method": method})
    reduced, full = three_balls(s), solve(s, "steady").values
    for name in ("total_qv", "residual_preload", "ball_diameter_loss_rate"):
        assert_allclose(reduced[name], full[name], rtol=1e-6)
    assert_allclose(reduced["qv"].mean(axis=0), full["qv"][0], rtol=1e-6)


@pytest.mark.parametrize("start", ["race_control", "kinematic"])
def test_runs_from_other_starts_end_in_the_steady_state(scene, start):
    """QV agrees to 1e-4 after 12 turns. The kinematic start rolls as by outer race control."""
    s = replace(scene("gyro_s1", MODEL | {"model.simulated_turns": 12}), cage=None)
    steady = solve(s, "steady").values["total_qv"]
    assert_allclose(dynamic_values(s, start, False)["total_qv"], steady, rtol=1e-4)


def test_the_kinematic_start_is_not_the_steady_state(scene):
    """The component w_x of the rotation of a ball, the first of four, differs by over 1e-4."""
    s = replace(scene("gyro_s1", MODEL), cage=None)
    steady, kinematic = (first_motion(s, start) for start in ("steady", "kinematic"))
    assert np.abs(kinematic / np.broadcast_to(steady, 4) - 1.0)[0] > 1e-4


def test_the_fit_changes_qv_by_less_than_3_percent(scene):
    """It changes QV by more than 1e-5, as it is used; a constant force keeps the preload."""
    s = replace(scene("gyro_s1", MODEL | {"model.simulated_turns": 12}), cage=None)
    exact, fit = dynamic_values(s, "steady", False), dynamic_values(s, "steady", True)
    assert fit["status"] == 0
    assert 1e-5 < abs(fit["total_qv"] / exact["total_qv"] - 1.0) < 0.03
    assert_allclose(fit["residual_preload"], exact["residual_preload"], rtol=1e-9)


@pytest.mark.parametrize("method", ["fixed_position", "constant_force"])
def test_scenes_of_each_machine_on_the_rotor(scene, method):
    """They are a bearing; a symmetric pair; a pair pushed by half of its preload; a pair, one worn.

    The preload is 7 N; the second bearing has lost 0.04 um of ball diameter.
    """
    base = scene("gyro_s1", {"operation.preload_method": method})
    alone, alike, pushed, unlike = (scene_on_rotor(base, machine) for machine in MACHINES)
    assert alone is base and alike.pair.is_symmetric and pushed.pair.external_axial_N == 0.5 * 7.0
    assert unlike.sides[1].wear.ball_diameter_loss_um == pytest.approx((0.04,))


@pytest.mark.parametrize("method", ["fixed_position", "constant_force"])
def test_loads_and_unequal_wear_shorten_the_life_on_the_rotor(scene, method):
    """A push of half the preload shortens it by a fifth or more, unequal wear by any amount.

    A symmetric pair has QV and life of the bearing alone, as they are given for one bearing.
    """
    base = scene("gyro_s1", {"operation.preload_method": method})

    def values(machine):
        point = SweepPoint(label=machine, value=0.0, fidelity="steady", machine=machine,
                           settings=(), text=machine)  # fmt: skip
        return point_values(base, point, 1, 1.0)  # one repeat: times do not matter here

    alone, alike, pushed, unlike = map(values, MACHINES)
    assert alike["total_qv"] == alone["total_qv"] and alike["life"] == alone["life"]
    assert pushed["residual_preload"] > 1.1 * alone["residual_preload"]
    assert pushed["life"] < 0.8 * alone["life"] and unlike["life"] < alone["life"]


def test_each_kind_of_growth_raises_the_preload(scene):
    """Speed alone raises it; with a ring that is 5 K warmer, it rises by more.

    With a thermal network that hardly warms, it is that of speed alone to 0.1 N.
    """
    base = scene("gyro_s1", {"operation.preload_method": "fixed_position"})
    mounted, turning, warm, network = (scene_with_growth(base, warmth) for warmth in WARMTHS)
    assert mounted is base and turning.bearing.bore_mm == pytest.approx(4.0)
    assert warm.temperature.inner_ring_C == 25.0 and network.thermal is not None
    of_mounted, of_turning, of_warm, of_network = (
        solve(grown).values["residual_preload"] for grown in (mounted, turning, warm, network)
    )
    assert of_mounted < of_turning < of_warm and abs(of_network - of_turning) < 0.1  # N


def test_a_life_ends_at_so_many_gaps_with_the_cells_asked_for(scene):
    """Wear at the end is 0.05 times the gap beside the contact, to 1e-12.

    A point with 32 x 8 cells and steps of 0.02 has the instants of that life.
    """
    s = scene("gyro_s1", {"model.contact": "worn", "cage": None})
    point = SweepPoint(label="", value=0.0, fidelity="steady", settings=(), text="", cells="32 x 8")
    small = scene_with_end(s, "0.05")
    assert_allclose(wear_over_gap(small), 0.05, rtol=1e-12)
    values = life_of_point(small, replace(point, step="0.02"))
    mode = EXACT_GROOVES._replace(cells=(32, 8), step=0.02)
    expected = follow_grooves(StiffGrooves(small, mode)).times
    assert_allclose(values["history_time"], expected, rtol=1e-12)
    # shorter steps than by default
    assert len(expected) > len(life_of_point(small, point)["history_time"])
