"""Traction in the balance of normal forces of the steady state."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import balance_of, in_python

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.hertz import race_contact
from bearingwear.kernels.contact.verification import friction_check
from bearingwear.kernels.equilibrium.ball_response import joined_equilibrium, load_rates
from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, orbit_load, thrust_equilibrium
from bearingwear.kernels.steady.balance import (
    Seat,
    friction_balance,
    full_jacobian,
    motion_equilibrium,
)
from bearingwear.kernels.steady.thrust import motion_jacobian
from bearingwear.lives.life import life
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.quadrature import gauss_legendre
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.effects.choice import choice
from bearingwear.solvers.effects.motion import gyroscopic_share
from bearingwear.solvers.solve import solve
from bearingwear.solvers.steady import axial_force

full_jacobian, friction_balance = in_python(full_jacobian), in_python(friction_balance)
motion_equilibrium = in_python(motion_equilibrium, thrust_equilibrium)
joined_equilibrium, load_rates = in_python(joined_equilibrium), in_python(load_rates)
motion_jacobian, friction_check = in_python(motion_jacobian), in_python(friction_check)

LINE = {
    "model.contact": "paper",
    "model.normal_balance": "with_traction",
    "model.quadrature": "gauss",
    "model.strips": 1000,
}
HERTZ = {"model.contact": "hertz"}
HELD = {"operation.preload_method": "fixed_position"}
FILM = HERTZ | {
    "friction.ball_race": None,
    "friction.film.shear_strength_MPa": 24.8,
    "friction.film.pressure_coefficient": 0.001,
    "uncertainty": None,
}


@pytest.mark.parametrize(
    "name, changes",
    [
        ("gyro_s1", {}),
        ("gyro_s1", HELD | {"friction.ball_race": 0.05}),
        ("turbopump", {"friction.slip_regularisation_m_s": 1e-3}),
    ],
)
def test_the_solved_state_satisfies_the_equations_written_as_plain_vectors(scene, name, changes):
    """Forces and moments on a ball vanish, and the race has its preload, to 1e-6 of their sizes.

    The sums over 2000 points on the line are written out here.
    """
    s = scene(name, LINE | changes)
    g, op = parameters.geometry(s), parameters.operating_point(s)
    case = ThrustProblem.of(s).solve(g.D0)
    values = solve(s, "steady").values
    assert case.status == values["status"] == code.OK
    load, angle = values["contact_load"][0], values["contact_angle"][0]
    w, Omega, r = case.u[:3], case.u[3], case.r
    R, mass = 0.5 * g.D0, g.rho * math.pi / 6.0 * g.D0**3
    x01, weight = gauss_legendre(2000)
    force, moment, race = np.array([0.0, 0.0, mass * r * Omega**2]), np.zeros(3), 0.0
    for k, (side, r_g, speed) in enumerate(((-1, g.r_i, op.omega_i), (1, g.r_o, op.omega_o))):
        sine, cosine = math.sin(angle[k]), math.cos(angle[k])
        c_a = race_contact(g, float(side), g.D0, cosine, math.nan).c_a
        a = c_a * load[k] ** (1 / 3)
        R_d, x = 2 * r_g * R / (r_g + R), a * x01
        h = np.sqrt(R_d**2 - x**2) - math.sqrt(R_d**2 - a**2) + math.sqrt(R**2 - a**2)
        normal, along = side * np.array([sine, 0, cosine]), np.array([cosine, 0, -sine])
        p = h[:, None] * normal + x[:, None] * along
        ball = np.cross(w, p) + [0.0, -r * Omega, 0.0]
        v = np.column_stack([0 * x, -speed * (r + p[:, 2]), 0 * x]) - ball
        v -= (v @ normal)[:, None] * normal  # slip lies in the contact's plane
        dQ = 0.75 * load[k] * (1 - x01**2) * weight
        mu = (op.law_i, op.law_o)[k].mu
        pull = (mu * dQ / np.sqrt((v**2).sum(axis=1) + op.v_r**2))[:, None] * v
        on_ball = pull.sum(axis=0) - load[k] * normal
        force, moment = force + on_ball, moment + np.cross(p, pull).sum(axis=0)
        race = on_ball[0] if side < 0 else race
    spin = 0.1 * mass * g.D0**2 * Omega * np.array([0.0, w[2], -w[1]])
    assert np.abs(force).max() < 1e-7 * load.max()
    assert np.abs(moment + spin).max() < 1e-6 * op.law_o.mu * load.max() * R
    assert_allclose(g.n_balls * race, values["residual_preload"], rtol=1e-6)
    if s.operation.preload_method == "constant_force":
        assert_allclose(values["residual_preload"], s.operation.preload_N, rtol=1e-8)
    without = solve(s.with_({"model.normal_balance": "frictionless"}), "steady").values["total_qv"]
    assert 1e-3 < abs(values["total_qv"] / without - 1.0) < 0.2  # and it matters


@pytest.fixture(
    scope="module", params=[({}, HERTZ), (HELD, LINE), ({}, FILM), (HELD, FILM)], ids=repr
)
def solved_balance(request, scene):
    """Returns a balance solved at fixed quadrature points, its seat and its unknowns (6,)."""
    method, contact = request.param
    drag = {"lubricant.drag_density_kg_m3": 300.0, "model.quadrature": "gauss"}
    problem = ThrustProblem.of(scene("gyro_s1", method | contact | drag))
    case = problem.solve(problem.g.D0)
    assert case.status == code.OK
    p = balance_of(problem, problem.g.D0)
    u = np.array([*case.u, case.T_i, case.T_o])
    seat = motion_equilibrium(p.bearing, u, Seat(delta_a=case.delta_a, state=cold_start()))
    return p, seat, u


def test_jacobian_of_all_six_unknowns_is_their_derivative(solved_balance):
    """Differences solve the equilibrium of the ball at each orbit rate and traction."""
    p, seat, u = solved_balance
    assert full_jacobian(p, p.bearing.op.v_r, seat, u) == code.OK
    jacobian = p.jacobian.copy()
    R, v_r = 0.5 * p.bearing.D, p.bearing.op.v_r
    steps = np.array([1e-2 * v_r / R] * 4 + [1e-5 * seat.state.Q_o] * 2)
    J = np.empty((6, 6))
    for k in range(6):
        low, high = np.empty((2, 6))
        for sign, out in ((-1.0, low), (1.0, high)):
            shifted = u + sign * steps[k] * np.eye(6)[k]
            state = motion_equilibrium(p.bearing, shifted, seat).state
            assert friction_balance(p, v_r, state, shifted, out, False) == code.OK
        J[:, k] = (high - low) / (2.0 * steps[k])
    scale = np.abs(J * steps).max(axis=1)[:, None] / steps
    assert np.abs((jacobian - J) / scale).max() <= 1e-3  # the error of the differences


def test_jacobian_of_the_motion_lets_tractions_follow(solved_balance):
    """It is the Schur complement of the tractions."""
    p, seat, u = solved_balance
    assert full_jacobian(p, p.bearing.op.v_r, seat, u) == code.OK
    J = p.jacobian
    followed = J[:4, :4] - J[:4, 4:] @ np.linalg.solve(J[4:, 4:], J[4:, :4])
    assert_allclose(motion_jacobian(p), followed, rtol=1e-9, atol=1e-12 * np.abs(followed).max())


@pytest.mark.parametrize(
    ("k", "step"), [(0, 3e-2), (1, 1e-5), (2, 1e-5)], ids=["orbit rate", "inner", "outer traction"]
)
def test_response_of_a_ball_is_that_of_its_equilibrium(solved_balance, k, step):
    """Orbit radius, angles and loads respond as in differences of the nested solver."""
    p, seat, u = solved_balance
    b, is_force = p.bearing, p.bearing.preload.constant_force

    def radius_angles_and_loads(shift):
        load = orbit_load(*(u[3:] + shift * np.eye(3)[k]))
        _, s = thrust_equilibrium(
            b.g, b.D, load, b.preload.F_x, seat.delta_a, is_force, cold_start()
        )
        return np.array([[s.X2, s.alpha_i, s.Q_i], [s.X2, s.alpha_o, s.Q_o]])

    expected = (radius_angles_and_loads(step) - radius_angles_and_loads(-step)) / (2.0 * step)
    rates = np.empty((3, 2, 3))
    load_rates(b.g, b.D, orbit_load(*u[3:]), seat.delta_a, is_force, seat.state, rates)
    scale = np.abs(expected).max(axis=0)
    assert_allclose(rates[k] / scale, expected / scale, atol=1e-5)


def test_ball_and_race_together_have_the_equilibrium_of_the_nested_solver(solved_balance):
    """Newton's steps lead there from nearby, but not from a ball 10 um off the outer race."""
    p, seat, u = solved_balance
    b, load = p.bearing, orbit_load(u[3] * 1.01, u[4] * 1.1, u[5])
    inputs = b.g, b.D, load, b.preload.F_x, seat.delta_a, b.preload.constant_force
    place, joined = joined_equilibrium(*inputs, seat.state)
    nested_place, nested = thrust_equilibrium(*inputs, cold_start())
    assert joined.status == nested.status == code.OK
    assert_allclose(place, nested_place, rtol=1e-10)
    for name in ("X1", "X2", "alpha_i", "alpha_o", "Q_i", "Q_o", "F_ix", "P_x", "P_r"):
        assert_allclose(getattr(joined, name), getattr(nested, name), rtol=1e-9, err_msg=name)
    far = seat.state._replace(X2=seat.state.X2 - 1e-5)
    assert joined_equilibrium(*inputs, far)[1].status == code.NOT_CONVERGED


def test_the_check_rejects_another_traction(solved_balance):
    """Friction has to give the traction that the balance of normal forces was solved with."""
    p, seat, u = solved_balance
    b = p.bearing
    args = b.g, b.D, b.op
    assert friction_check(*args, seat.state, u, p.rule, True)[0] < 1e-9
    wrong = seat.state._replace(P_x=seat.state.P_x * (1.0 + 1e-6))
    assert friction_check(*args, wrong, u, p.rule, True)[0] > 1e-8
    assert friction_check(*args, wrong, u, p.rule, False)[0] < 1e-9


def test_newton_converges_in_six_steps_from_nearby(scene):
    """It starts from the state of balls that have lost 1 nm."""
    problem = ThrustProblem.of(scene("gyro_s1", HERTZ))
    start = problem.solve(problem.g.D0 - 1e-9).u
    assert problem.solve(problem.g.D0, start=start).iterations <= 6


@pytest.mark.parametrize("name", ["gyro_s1", "turbopump", "bearing218"])
@pytest.mark.parametrize("method", ["constant_force", "fixed_position"])
def test_power_and_the_race_are_in_balance(scene, name, method):
    """Residuals are small, contact forces give the preload, and shaft power is heat plus drag."""
    s = scene(name, HERTZ | {"operation.preload_method": method})
    problem = ThrustProblem.of(s)
    case, n = problem.solve(problem.g.D0), problem.g.n_balls
    assert case.residuals.power < 1e-9 and case.residuals.friction < 1e-9
    if method == "constant_force":
        assert_allclose(axial_force(case, n), s.operation.preload_N, rtol=1e-9)
    values = solve(s, "steady").values
    assert_allclose(values["residual_preload"], axial_force(case, n), rtol=1e-9)
    heat, drag = values["friction_heat"].sum() * n, values["drag_power"]
    assert_allclose(values["shaft_torque"] * problem.op.omega_i, heat + drag, rtol=1e-8)
    # the moment about y is carried by what pushes the ball along its contacts
    gyroscopic = values["gyroscopic_moment"][0] / (0.5 * problem.g.D0)
    assert_allclose(abs(case.T_i - case.T_o), gyroscopic, rtol=1e-2)
    assert values["stable"] == 1


def test_a_life_has_the_traction_in_its_normal_balance(scene):
    """It begins at the steady state with traction, and differs from one without by over 0.1 %."""
    with_traction, frictionless = (
        scene("gyro_s1", HERTZ | HELD | {"model.normal_balance": balance})
        for balance in ("with_traction", "frictionless")
    )
    values, frictionless_values = life(with_traction).values, life(frictionless).values
    preload_when_new = solve(with_traction, "steady").values["residual_preload"]
    assert_allclose(values["history_residual_preload"][0], preload_when_new, rtol=1e-9)
    assert abs(values["life"] / frictionless_values["life"] - 1.0) > 1e-3


@pytest.mark.parametrize("name, most", [("gyro_s1", 1.1), ("turbopump", 2.0), ("bearing218", 1.5)])
def test_the_gyroscopic_share_before_the_solve_is_an_upper_estimate(scene, name, most):
    """It assumes a ball that rolls on the inner race; one on the outer race has less to carry.

    most: largest factor by which the estimate exceeds the solved share in each bearing.
    """
    s = scene(name, HERTZ)
    values = solve(s, "steady").values
    axial = s.operation.preload_N / s.bearing.ball_count
    share = values["gyroscopic_moment"][0] / (0.5e-3 * s.bearing.ball_diameter_mm) / axial
    assert 0.95 * share < gyroscopic_share(s) < most * share
    (reason,) = (line for line in choice(s).reasons if line.startswith("traction: "))
    assert "included" in reason
