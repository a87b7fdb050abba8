"""The reduced and the approximate models of the study of accuracy against the full ones."""

import math
from dataclasses import replace

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
    """Brewe and Hamrock state 3 to 4 % for ellipticity and elliptic integrals, at ratios to 100.

    The semi-axes c_a and c_b (at 1 N) are off by less, as they contain cube roots of these. The
    stiffness K contains a power of 3/2: at a round contact, where the fit is worst, it is off by
    8.7 %.

    ratio: of the curvatures along rolling and across it.
    """
    A, E_star = 20.0, 1.1e11  # curvature [1/m], contact modulus of steel [Pa]
    exact = point_contact(A, ratio * A, E_star, math.nan)
    K, c_a, c_b = fitted_contact(A, ratio * A, E_star)
    assert_allclose(c_a / c_b, exact.c_a / exact.c_b, rtol=0.04)
    assert_allclose([c_a, c_b], [exact.c_a, exact.c_b], rtol=0.035)
    assert_allclose(K, exact.K, rtol=0.09)
    assert abs(c_a / exact.c_a - 1.0) > 1e-6  # it is the fit, and not the exact formula


def test_static_displacement_with_the_fit_is_within_2_percent(scene):
    """The axial displacement of gyro_s1 under its preload of 7 N; it is 0.2 % off."""
    g = parameters.geometry(scene("gyro_s1"))
    exact = static_displacement(g, 7.0)
    assert_allclose(fitted_displacement(g, 7.0), exact, rtol=0.02)


@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_under_thrust_three_balls_stand_for_all(scene, method):
    """A run with three balls in place of nine starts in the steady state and stays there, to 1e-6.

    `three_balls` scales its sums over balls to nine; each ball has the QV of the steady state.
    """
    s = scene("gyro_s1", MODEL | {"operation.preload_method": method})
    few, steady = three_balls(s), solve(s, "steady").values
    for name in ("total_qv", "residual_preload", "ball_diameter_loss_rate"):
        assert_allclose(few[name], steady[name], rtol=1e-6)
    assert_allclose(few["qv"].mean(axis=0), steady["qv"][0], rtol=1e-6)


@pytest.mark.parametrize("start", ["race_control", "kinematic"])
def test_runs_from_other_starts_end_in_the_steady_state(scene, start):
    """After 12 turns, QV agrees to 1e-4. The kinematic start has outer race control."""
    s = replace(scene("gyro_s1", MODEL | {"model.simulated_turns": 12}), cage=None)
    steady = solve(s, "steady").values["total_qv"]
    assert_allclose(dynamic_values(s, start, fit=False)["total_qv"], steady, rtol=1e-4)


def test_the_kinematic_start_is_not_the_steady_state(scene):
    """The component w_x of the rotation of a ball differs by more than 1e-4."""
    s = replace(scene("gyro_s1", MODEL), cage=None)
    steady, kinematic = (first_motion(s, start).ravel()[0] for start in ("steady", "kinematic"))
    assert abs(kinematic / steady - 1.0) > 1e-4


def test_the_fit_changes_qv_by_less_than_3_percent(scene):
    """But by more than 1e-5, so that the fit is used. A constant force maintains the preload."""
    s = replace(scene("gyro_s1", MODEL | {"model.simulated_turns": 12}), cage=None)
    exact, fit = (dynamic_values(s, "steady", fit=fit) for fit in (False, True))
    assert fit["status"] == 0
    assert 1e-5 < abs(fit["total_qv"] / exact["total_qv"] - 1.0) < 0.03
    assert_allclose(fit["residual_preload"], exact["residual_preload"], rtol=1e-9)


@pytest.mark.parametrize("method", ["fixed_position", "constant_force"])
def test_scenes_of_each_machine_on_the_rotor(scene, method):
    """They are one bearing, and pairs: symmetric, under half of the preload of 7 N, unlike by wear.

    The second bearing of the last pair has lost 2e-5 of its ball diameter of 2 mm: 0.04 um.
    """
    preloaded = scene("gyro_s1", {"operation.preload_method": method})
    alone, alike, pushed, unlike = (scene_on_rotor(preloaded, machine) for machine in MACHINES)
    assert (
        alone is preloaded and alike.pair.is_symmetric and pushed.pair.external_axial_N == 0.5 * 7.0
    )
    assert unlike.sides[1].wear.ball_diameter_loss_um == pytest.approx((0.04,))


@pytest.mark.parametrize("method", ["fixed_position", "constant_force"])
def test_loads_and_unequal_wear_shorten_the_life_on_the_rotor(scene, method):
    """A force of half the preload shortens it by a fifth or more, unequal wear by any amount.

    A symmetric pair has the QV and the life of the bearing alone, as they are those of one bearing.
    The first bearing of the pair under a force has at least 10 % more preload.
    """
    preloaded = scene("gyro_s1", {"operation.preload_method": method})

    def values_on(machine):
        point = SweepPoint(label=machine, value=0.0, fidelity="steady", machine=machine,
                           settings=(), text=machine)  # fmt: skip
        return point_values(preloaded, point, 1, 1.0)  # one repeat: times do not matter here

    alone, alike, pushed, unlike = (values_on(machine) for machine in MACHINES)
    assert alike["total_qv"] == alone["total_qv"] and alike["life"] == alone["life"]
    assert pushed["residual_preload"] > 1.1 * alone["residual_preload"]
    assert pushed["life"] < 0.8 * alone["life"] and unlike["life"] < alone["life"]


def test_each_kind_of_growth_raises_the_preload(scene):
    """Speed alone raises it, and an inner ring that is 5 K warmer raises it further.

    With a thermal network that hardly warms, it is that of speed alone to 0.1 N. The scene has no
    bore; that of a usual inner ring is 4 mm.
    """
    preloaded = scene("gyro_s1", {"operation.preload_method": "fixed_position"})
    scenes = [scene_with_growth(preloaded, warmth) for warmth in WARMTHS]
    mounted, turning, warm, network = scenes
    assert mounted is preloaded and turning.bearing.bore_mm == pytest.approx(4.0)
    assert warm.temperature.inner_ring_C == 25.0 and network.thermal is not None
    preloads = [solve(scene).values["residual_preload"] for scene in scenes]
    assert preloads[0] < preloads[1] < preloads[2]
    assert abs(preloads[3] - preloads[1]) < 0.1  # N


def test_a_life_ends_at_the_wear_of_its_point_with_its_cells_and_steps(scene):
    """Wear at the end is 0.05 times the gap at the edge of the contact.

    A point with 32 x 8 cells and steps of 0.02 of that gap has the instants of such a life.
    """
    s = scene("gyro_s1", {"model.contact": "worn", "cage": None})
    point = SweepPoint(label="", value=0.0, fidelity="steady", settings=(), text="", cells="32 x 8")
    small = scene_with_end(s, "0.05")
    assert_allclose(wear_over_gap(small), 0.05, rtol=1e-12)
    values = life_of_point(small, replace(point, step="0.02"))
    mode = EXACT_GROOVES._replace(cells=(32, 8), step=0.02)
    expected = follow_grooves(StiffGrooves(small, mode)).times
    assert_allclose(values["history_time"], expected, rtol=1e-12)
    # steps of 0.02 are shorter than the usual ones
    assert len(expected) > len(life_of_point(small, point)["history_time"])
