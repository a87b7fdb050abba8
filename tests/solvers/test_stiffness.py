"""Quasi-static and dynamic stiffness: independent numbers, slopes of solves, motion in time."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import balance_of, in_python

from bearingwear.api import new
from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, thrust_equilibrium
from bearingwear.kernels.status import OK
from bearingwear.kernels.steady.balance import Seat, friction_balance, motion_equilibrium
from bearingwear.solvers.bearing.race_control_problem import RaceControlProblem
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.race_control import solve_race_control
from bearingwear.solvers.solve import solve
from bearingwear.solvers.steady import axial_force

friction_balance = in_python(friction_balance)
motion_equilibrium = in_python(motion_equilibrium, thrust_equilibrium)

N_UM = 1e-6
AXIAL = ("axial_stiffness", "quasistatic_axial_stiffness")
SYSTEM = ("system_axial_stiffness", "system_quasistatic_axial_stiffness")
FIXED = {"operation.preload_method": "fixed_position"}
ALONG = 1e-5  # error of a difference along which the points of a split rule move


def dynamic_and_quasistatic(values, names=AXIAL):
    """Returns both stiffnesses [N/um]; of two bearings the larger one of each."""
    return [N_UM * float(np.max(values[name])) for name in names]


# numbers [N/um] of a program written apart from this one, from the equations alone; two decimals
DIGITS = 6e-3


@pytest.mark.parametrize(
    ("speed", "dynamic", "quasistatic"),
    [(100.0, 25.36, 25.36), (9000.0, 13.42, 13.63), (18000.0, 6.32, 7.64), (25000.0, 7.64, 9.79)],
)
def test_stiffness_of_a_spindle_bearing_over_speed_agrees_with_another_program(
    speed, dynamic, quasistatic
):
    scene = new(designation="7008C", speed=speed, preload=140.0, friction=0.08)
    assert_allclose(
        dynamic_and_quasistatic(solve(scene).values), [dynamic, quasistatic], atol=DIGITS
    )


@pytest.mark.parametrize(
    ("preload", "dynamic", "quasistatic"),
    [(2.5, 1.00, 0.70), (3.0, 1.85, 1.06), (3.5, 2.84, 1.92), (7.0, 4.68, 4.69)],
)
def test_stiffness_of_an_instrument_bearing_over_preload_agrees_with_another_program(
    scene, preload, dynamic, quasistatic
):
    values = solve(scene("gyro_s1_hertz", {"operation.preload_N": preload})).values
    assert_allclose(dynamic_and_quasistatic(values), [dynamic, quasistatic], atol=DIGITS)
    slow = 1.0 / (2.0 * np.pi * values["slow_time_scale"])
    assert_allclose(values["stiffness_transition_frequency"], slow, rtol=1e-12)


# the slope of the force over place, by solves at places nearby


def slope(problem, D, case, share):
    """Returns the central difference of the axial force of a ball over the place [N/m].

    share: step of the place over the axial deformation, force over stiffness.
    """
    held = problem.preload._replace(constant_force=False)
    h = share * axial_force(case) / case.S_xx
    ends = []
    for place in (case.delta_a - h, case.delta_a + h):
        near = replace(problem, preload=held._replace(delta_a=place)).solve(D, case.u)
        assert near.status == OK
        ends.append(axial_force(near))
    return (ends[1] - ends[0]) / (2.0 * h)


@pytest.mark.parametrize("method", [{}, FIXED], ids=["force", "position"])
@pytest.mark.parametrize(
    ("name", "changes", "rtol"),
    [
        ("gyro_s1_hertz", {"operation.preload_N": 3.0}, ALONG),
        ("gyro_s1_hertz", {"operation.preload_N": 3.0, "model.quadrature": "gauss"}, 1e-7),
        ("gyro_s1_hertz", {"model.normal_balance": "frictionless"}, ALONG),
        ("gyro_s1", {"operation.preload_N": 3.0}, 1e-7),
        ("mos2_gyro", {"model.quadrature": "gauss"}, 1e-7),
        ("bearing218", {}, ALONG),
        ("turbopump", {}, ALONG),
    ],
)
def test_quasistatic_stiffness_is_the_slope_of_further_solves(scene, name, changes, rtol, method):
    problem = ThrustProblem.of(scene(name, changes | method))
    D = problem.g.D0
    case = problem.solve(D)
    assert case.status == OK
    coarse, fine = (slope(problem, D, case, share) for share in (1e-3, 5e-4))
    extrapolated = (4.0 * fine - coarse) / 3.0  # by Richardson, of central differences
    assert_allclose(case.S_quasistatic, extrapolated, rtol=rtol)


@pytest.mark.parametrize("contact", ["hertz", "paper"])
@pytest.mark.parametrize("method", [{}, FIXED], ids=["force", "position"])
def test_the_linear_response_is_the_derivative_of_the_balance_and_of_the_inner_force(
    scene, contact, method
):
    """Each column agrees with central differences to 1e-4."""
    changes = {"operation.preload_N": 3.0, "model.quadrature": "gauss", "model.contact": contact}
    problem = ThrustProblem.of(scene("gyro_s1_hertz", changes | method))
    held = problem.preload._replace(constant_force=False)
    case = problem.solve(problem.g.D0)
    k = len(case.response) - 2
    u = np.append(case.u, [case.T_i, case.T_o])[:k]

    def balance_and_force(column, step):
        """Returns balance (k,) and inner force (2,) with an unknown, or the place, shifted."""
        shifted, place = u.copy(), case.delta_a
        if column < k:
            shifted[column] += step
        else:
            place += step
        p = balance_of(replace(problem, preload=held._replace(delta_a=place)), problem.g.D0)
        state = motion_equilibrium(p.bearing, shifted, Seat(place, cold_start())).state
        out = np.empty(k)
        assert friction_balance(p, problem.op.v_r, state, shifted, out, False) == OK
        return np.append(out, [state.F_ix, state.F_ir])

    # a hundredth of the width of the friction law, as in the tests of the Jacobian
    steps = [1e-2 * problem.op.v_r / problem.g.D0] * 4 + [1e-6 * abs(u).min()] * (k - 4) + [1e-10]
    expected = np.empty((k + 2, k + 1))
    for j, h in enumerate(steps):
        difference = balance_and_force(j, h) - balance_and_force(j, -h)
        expected[:, j] = difference / (2.0 * h)
    # rows and columns have units of their own: relative to the largest of each
    rows = np.abs(expected).max(axis=1, keepdims=True)
    columns = np.abs(expected / rows).max(axis=0)
    error = np.abs(case.response[:, : k + 1] - expected) / rows / columns
    assert error.max() <= 1e-4


# two bearings


@pytest.mark.parametrize(
    ("force", "dynamic", "quasistatic"), [(0.0, 5.8430, 7.1156), (40.0, 7.5604, 8.8810)]
)
def test_system_stiffness_of_a_spindle_on_a_spring(force, dynamic, quasistatic):
    """These are regression values [N/um] of the tutorial, computed with 16 times the points.

    A program written apart has 5.86 and 7.12 without a force. The points of the scene err by 3e-4.
    """
    scene = new(
        bore=40.0, outside=68.0, contact_angle=15.0, balls=16, ball_diameter=7.938,
        speed=18000.0, preload=120.0, friction=0.08,
    ).with_({"arrangement": {"kind": "spring_pair", "external_axial_N": force}})  # fmt: skip
    assert_allclose(
        dynamic_and_quasistatic(solve(scene).values, SYSTEM), [dynamic, quasistatic], atol=3e-4
    )


SOFT = {"arrangement.kind": "spring_pair", "arrangement.spring_stiffness_N_um": 0.4}
RIGID = FIXED | {"arrangement.kind": "rigid_pair"}


@pytest.mark.parametrize(
    "changes",
    [
        RIGID,
        RIGID | {"arrangement.second": {"friction.ball_race": 0.05}, "arrangement.tandem": [2, 1]},
        RIGID | {"temperature.inner_ring_C": 22.0, "temperature.balls_C": 21.0},
        SOFT,
        SOFT | {"arrangement.second": {"wear.ball_diameter_loss_um": 0.3}},
    ],
    ids=["rigid", "mixed", "warm", "spring", "unlike"],
)
def test_the_stiffness_of_a_pair_is_the_slope_of_force_over_its_shift(scene, changes):
    def values(force):
        loads = {"operation.preload_N": 5.0, "arrangement.external_axial_N": force}
        return solve(scene("gyro_s1_hertz", loads | changes)).values

    h = 2e-3
    shifts = [values(1.0 + s * h)["rotor_axial_shift"] for s in (-1, 1)]
    stiffness = values(1.0)["system_quasistatic_axial_stiffness"]
    assert_allclose(2.0 * h / (shifts[1] - shifts[0]), stiffness, rtol=2.0 * ALONG)


# race control: its forces follow the place at once


@pytest.mark.parametrize("radial", [[0.0, 0.0], [0.3, -0.5]])
def test_quasistatic_stiffness_of_race_control_is_the_slope_of_further_solves(scene, radial):
    """Under thrust and with a radial load; the inner race is held a little to either side."""
    pump = scene("turbopump", {"operation.radial_load_N": radial, "model.fidelity": "race_control"})
    problem = RaceControlProblem.of(pump)
    values, _ = solve_race_control(pump, problem)
    stiffness = values["quasistatic_axial_stiffness"]
    h = 1e-4 * float(values["residual_preload"]) / stiffness
    ends = []
    for place in (-h, h):
        held = replace(
            problem, constant_force=False, delta_a=float(values["axial_displacement"]) + place
        )
        ends.append(float(solve_race_control(pump, held)[0]["residual_preload"]))
    assert_allclose((ends[1] - ends[0]) / (2.0 * h), stiffness, rtol=1e-6)
    # unlike in the dynamic stiffness, forces follow the race, so that the two differ
    assert abs(stiffness / values["axial_stiffness"] - 1.0) > 1e-5


# all five displacements


def test_dynamic_and_quasistatic_matrices_agree_at_creep(scene):
    """At 50 r/min balls have no gyroscopic moment, and friction is the same wherever they are.

    To 0.2 % of the diagonal, because only the quasi-static one lets the Hertz factors follow the
    angle, and balls bunch (section 2 of theory.md).
    """
    changes = {"operation.shaft_speed_rpm": 50.0, "friction.slip_regularisation_m_s": 1e-6}
    values = solve(scene("gyro_s1_hertz", changes | {"model.contact": "paper"})).values
    dynamic, quasistatic = values["stiffness_matrix"], values["quasistatic_stiffness_matrix"]
    scale = np.sqrt(np.outer(np.diag(dynamic), np.diag(dynamic)))
    assert np.abs((quasistatic - dynamic) / scale).max() < 2e-3
    assert_allclose(quasistatic[0, 0], values["quasistatic_axial_stiffness"], rtol=1e-12)


@pytest.mark.parametrize("balance", ["frictionless", "with_traction"])
def test_the_race_of_a_dynamic_solve_moves_as_the_quasistatic_matrix_says(scene, balance):
    """The race is under a radial load, or tilted.

    The load of 4 mN and the tilt of 1 urad are small, so that the answer is linear. A tilt acts as
    the radial force -K_.3 tilt.
    """
    changes = {"operation.preload_N": 4.0, "model.normal_balance": balance}
    steady = solve(scene("gyro_s1_hertz", changes)).values
    K, dynamic = steady["quasistatic_stiffness_matrix"], steady["stiffness_matrix"]
    changes |= {"model.history_points_per_turn": 20, "model.dynamic_solution": "periodic",
                "model.dynamic_tolerance": 1e-3}  # fmt: skip
    F, tilt = 4e-3, 1e-6
    for load, force in (
        ({"operation.radial_load_N": [0.0, F]}, np.array([0.0, F])),
        ({"operation.tilt_mrad": 1e3 * tilt}, -K[1:3, 3] * tilt),
    ):
        moving = solve(scene("gyro_s1_hertz", changes | load).without_cage, "dynamic").values
        place = moving["history_race_displacement"][:, 1:].mean(axis=0)
        by_quasistatic = np.linalg.solve(K[1:3, 1:3], force)
        size = np.abs(by_quasistatic).max()
        assert_allclose(place, by_quasistatic, atol=1e-3 * size)
        by_dynamic = np.linalg.solve(dynamic[1:3, 1:3], force)
        if balance == "with_traction" and "operation.tilt_mrad" not in load:
            assert np.abs(place - by_dynamic).max() > 5e-3 * size  # balls do follow
