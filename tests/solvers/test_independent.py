"""Kernels against benchmarks/plain_scipy.py, written apart from them from the same equations.

The plain program stops at residuals of 1e-9 or so. Soft values, such as w_y and QV of the race with
little slip, then differ by up to 1e-6.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import benchmark

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.summary import ANGLE, HEAT, LOAD, QV, TORQUE
from bearingwear.kernels.equilibrium.kinematics import INNER_CONTROL, OUTER_CONTROL
from bearingwear.kernels.equilibrium.race import PACKED, race_equilibrium
from bearingwear.kernels.equilibrium.thrust_loaded import static_displacement
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.race_control import RaceControlProblem


@pytest.fixture(scope="module")
def plain():
    return benchmark("plain_scipy")


def scene_and_plain_inputs(plain, scene, name, method, mu, loss, drag):
    """Returns a scene, and its bearing and operation as inputs of the plain program.

    loss: of ball diameter [um]. drag: density [kg/m3].
    """
    s = scene(
        name,
        {
            "operation.preload_method": method,
            "friction.ball_race": mu,
            "wear.ball_diameter_loss_um": loss,
            "lubricant.drag_density_kg_m3": drag,
            "model.quadrature": "gauss",  # as the plain program has it
        },
    )
    b = s.bearing
    bearing = plain.Bearing(
        b.ball_count,
        b.ball_diameter_mm * 1e-3,
        b.pitch_diameter_mm * 1e-3,
        np.radians(b.contact_angle_deg),
        (b.inner_groove_factor, b.outer_groove_factor),
    )
    speed = (s.operation.shaft_speed_rpm * np.pi / 30, 0.0)
    operation = plain.Operation(s.operation.preload_N, speed, mu, method, loss * 1e-6, drag)
    return s, bearing, operation


def orbiting_balls(n, Omega):
    """Returns the loads (n, 6) of balls with an orbit rate [rad/s] alone, and their azimuths."""
    loads = np.column_stack([np.zeros(n), np.full(n, Omega), *np.zeros((4, n))])
    return loads, 2 * np.pi * np.arange(n) / n


@pytest.mark.parametrize(
    ("name", "method", "mu", "loss", "drag"),
    [
        ("gyro_s1", "constant_force", 0.08, 0.0, 0.0),
        ("gyro_s1", "fixed_position", 0.08, 0.5, 0.0),
        ("gyro_s1", "constant_force", 0.02, 0.0, 0.0),
        ("gyro_s1", "fixed_position", 0.02, 0.7, 250.0),
        ("gyro_s2", "fixed_position", 0.11, 0.3, 0.0),
        ("gyro_s3", "constant_force", 0.05, 0.6, 100.0),
    ],
)
def test_steady_states_agree_with_the_plain_program(plain, scene, name, method, mu, loss, drag):
    """Loads, angles and orbit to 1e-8; the soft spin axis, QV, heat and torque to 1e-6."""
    s, bearing, operation = scene_and_plain_inputs(plain, scene, name, method, mu, loss, drag)
    problem = ThrustProblem.of(s)
    case = problem.solve(problem.g.D0 - loss * 1e-6)
    assert case.status == code.OK
    ref = plain.steady_state(bearing, operation)
    contacts, traction = ref["contacts"], ref["traction"]
    c = case.contacts
    assert_allclose(c[:, LOAD], contacts.load, rtol=1e-8)
    assert_allclose(c[:, ANGLE], contacts.angle, rtol=1e-8)
    assert_allclose(case.u[3], ref["Omega"], rtol=1e-8)
    assert_allclose(case.u[:3], ref["w"], rtol=1e-6)
    assert_allclose(c[:, QV], traction.qv, rtol=1e-6)
    assert_allclose(c[:, HEAT], traction.heat, rtol=1e-6)
    assert_allclose(c[:, TORQUE], traction.torque, rtol=1e-6)


@pytest.mark.parametrize(("law", "control"), [(OUTER_CONTROL, 1), (INNER_CONTROL, 0)])
@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_race_control_agrees_with_the_plain_program(plain, scene, law, control, method):
    s, bearing, operation = scene_and_plain_inputs(plain, scene, "gyro_s1", method, 0.08, 0.3, 0.0)
    problem = RaceControlProblem.of(s)
    balance = problem.balance(np.array([law]))
    ref = plain.race_control(bearing, operation, control=control)
    (state,) = balance.states
    assert_allclose([state.Q_i, state.Q_o], ref["contacts"].load, rtol=1e-7)
    assert_allclose([state.alpha_i, state.alpha_o], ref["contacts"].angle, rtol=1e-7)


@pytest.mark.parametrize(
    ("force", "tilt", "Omega"),
    [
        ((7.0, 0.0, 3.0), 0.0, 0.0),
        ((7.0, 2.0, -4.0), 5e-4, 0.0),
        ((7.0, 1.0, 2.0), -3e-4, 1180.0),
        ((7.0, 0.0, 12.0), 0.0, 1180.0),  # the far balls leave the inner race
    ],
)
def test_a_loaded_bearing_agrees_with_the_plain_program(plain, scene, force, tilt, Omega):
    """Nine balls under axial and radial load [N] and tilt [rad], at rest or orbiting [rad/s]."""
    s, bearing, _ = scene_and_plain_inputs(
        plain, scene, "gyro_s1", "constant_force", 0.08, 0.0, 0.0
    )
    g = parameters.geometry(s)
    # The tilt lever is the locus of the inner groove centres in both.
    displacement, load = plain.loaded_equilibrium(bearing, force, Omega=Omega, tilt=tilt)[:2]
    n = g.n_balls
    loads, psi = orbiting_balls(n, Omega)
    rows, delta = np.empty((n, PACKED)), np.zeros(3)
    D = np.full(n, g.D0)
    status, _, _ = race_equilibrium(g, D, loads, psi, np.array(force), tilt, 0, delta, rows)
    assert status == code.OK
    assert_allclose(rows[:, 5:7], load, rtol=1e-6, atol=1e-9)  # Q_i and Q_o of packed states
    assert_allclose(delta, displacement[:3], atol=1e-12)


@pytest.mark.parametrize(
    ("loss", "radial", "axial"),
    [
        (0.0, 2.0, 7.39219144),
        (0.0, 6.0, 7.74064334),
        (0.5, 2.0, 3.12696385),
        (0.5, 6.0, 4.50359182),
    ],
)
def test_a_fixed_position_under_radial_load_agrees_with_another_program(scene, loss, radial, axial):
    """Axial sum [N] of the contact forces of gyro_s1 orbiting at 1200 rad/s, to its nine digits."""
    g = parameters.geometry(scene("gyro_s1"))
    n = g.n_balls
    loads, psi = orbiting_balls(n, 1200.0)
    rows, delta = np.empty((n, PACKED)), np.array([static_displacement(g, 7.0), 0.0, 0.0])
    D = np.full(n, g.D0 - loss * 1e-6)
    force = np.array([7.0, 0.0, radial])
    # the race moves from direction 1 on: across the axis alone
    status, _, _ = race_equilibrium(g, D, loads, psi, force, 0.0, 1, delta, rows)
    assert status == code.OK
    inner_load, inner_angle = rows[:, 5], rows[:, 3]
    assert_allclose((inner_load * np.sin(inner_angle)).sum(), axial, rtol=2e-9)
