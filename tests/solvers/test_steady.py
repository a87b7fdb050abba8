"""The friction-balanced steady state against two independent programs, and its own balances.

`values` of tests/conftest.py solves gyro_s1 with some keys changed.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from support import balance_of, benchmark, in_python

from bearingwear.kernels import status as code
from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, thrust_equilibrium
from bearingwear.kernels.steady.balance import Seat, friction_balance, orbit_equilibrium
from bearingwear.solvers.bearing.parameters import ball_diameters, ellipse_rule
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.solve import solve

# The 2 mm bearing of the Jones-Harris benchmark, constant force 7 N, v_r = 1e-3 m/s. Two programs
# agree to 0.2 % in speeds and 1 % in QV; these are the digits of the one converged in quadrature.
MM2 = {
    "bearing.ball_count": 10,
    "bearing.pitch_diameter_mm": 9.0,
    "bearing.contact_angle_deg": 25.0,
    "bearing.inner_groove_factor": 0.565,
}
REFERENCE = {
    0.02: {
        "Q": [1.53155294, 1.74212319],
        "alpha": [27.197069, 23.691289],
        "orbit": 1258.81449,
        "w": [-5025.8535, 12.82119, 2653.6474],
        "qv": [0.05361315, 0.02791847],
        "gyro": 0.01281,
    },
    0.08: {
        "Q": [1.53142539, 1.74227097],
        "alpha": [27.199522, 23.689156],
        "orbit": 1259.63691,
        "w": [-5074.0308, 0.959261, 2551.2052],
        "qv": [0.05174884, 0.01090247],
        "gyro": 0.0009585,
    },
}


def values_of_2_mm_bearing(scene, mu, quadrature, points):
    """Returns the values of the solved bearing MM2, without a cage, which would not fit."""
    changes = {"friction.ball_race": mu, "model.quadrature": quadrature, "model.strips": points}
    result = solve(scene("gyro_s1", MM2 | {"cage": None} | changes))
    assert result.status == "ok"
    return result.values


@pytest.mark.parametrize("mu", REFERENCE)
@pytest.mark.parametrize(
    ("quadrature", "points", "rtol", "qv_rtol"),
    [
        ("gauss", 50, 1e-6, 1e-6),  # the reference's own rule: all its digits
        ("strips", 200, 1e-3, 5e-3),  # required of 200 equal strips
    ],
)
def test_values_agree_with_the_reference_of_the_quadratures(
    scene, mu, quadrature, points, rtol, qv_rtol
):
    """Of the angular velocity, only the size is compared here: w_y, in the next test, is small."""
    v, ref = values_of_2_mm_bearing(scene, mu, quadrature, points), REFERENCE[mu]
    assert_allclose(v["contact_load"][0], ref["Q"], rtol=rtol)
    assert_allclose(np.degrees(v["contact_angle"][0]), ref["alpha"], rtol=rtol)
    assert_allclose(v["orbit_speed"][0], ref["orbit"], rtol=rtol)
    w = v["ball_angular_velocity"][0]
    assert_allclose(np.linalg.norm(w), np.linalg.norm(ref["w"]), rtol=rtol)
    assert_allclose(v["qv"][0], ref["qv"], rtol=qv_rtol)


@pytest.mark.parametrize("mu", REFERENCE)
def test_gyroscopic_rotation_and_slip_agree_with_the_reference(scene, mu):
    """The tolerance of the slip is 1e-3, as the reference has four digits of it.

    That of the rotation is 5e-6: w_y, small beside w_x, follows from a difference of large moments.
    """
    v, ref = values_of_2_mm_bearing(scene, mu, "gauss", 50), REFERENCE[mu]
    assert_allclose(v["ball_angular_velocity"][0], ref["w"], rtol=5e-6)
    assert_allclose(np.abs(v["gyroscopic_slip"]).mean(), ref["gyro"], rtol=1e-3)


GRID = [
    (method, mu, loss, drag)
    for method in ("constant_force", "fixed_position")
    for mu in (0.02, 0.08, 0.11)
    for loss in (0.0, 0.3, 0.7)
    for drag in (0.0, 250.0)
]


@pytest.mark.parametrize(("method", "mu", "loss", "drag"), GRID)
def test_balances_close(values, method, mu, loss, drag):
    """Residuals are recomputed by other formulas; shaft power is compared with heat and drag."""
    v = values(method, mu, loss, drag)
    assert v["friction_residual"] <= 1e-9
    assert v["equilibrium_residual"] <= 1e-9
    assert v["power_balance_error"] <= 1e-9
    omega = 30000 * math.pi / 30
    heat = 9 * v["friction_heat"].sum()
    assert_allclose(v["shaft_torque"] * omega, heat + v["drag_power"], rtol=1e-9)


@pytest.mark.parametrize(("method", "loss"), [("constant_force", 0.0), ("fixed_position", 0.5e-6)])
def test_balls_settle_from_anywhere(scene, method, loss):
    """Unlike starts end in the state that the solver follows down from viscous friction."""
    search = benchmark("search")
    # plain Python, as compiling them takes longer
    for name in ("balance_problem", "motion_equilibrium", "pseudo_transient", "unknowns"):
        setattr(search, name, in_python(getattr(search, name), thrust_equilibrium))
    changes = {"operation.preload_method": method, "friction.ball_race": 0.02}
    problem = ThrustProblem.of(scene("gyro_s1", changes))
    D = problem.g.D0 - loss
    case = problem.solve(D)
    assert case.status == code.OK
    ends_elsewhere = search.settled_from_starts(problem, D, case, 4)
    assert ends_elsewhere == []
    assert problem.other_states(D, case, True, 8) == []


def test_a_disturbed_ball_returns_at_the_rate_of_the_slow_eigenvalue(scene):
    """A factor of e is left of it after the time of the slowest eigenvalue.

    SciPy's Radau integrates the residual of the balance as an acceleration.
    """
    problem = ThrustProblem.of(scene("gyro_s1", {"friction.ball_race": 0.08}))
    D = problem.g.D0
    case = problem.solve(D)
    m = problem.g.rho * math.pi / 6 * D**3
    inertia = np.array([0.1 * m * D * D] * 3 + [m * case.r**2])
    eigenvalues, vectors = np.linalg.eig(case.jacobian / inertia[:, None])
    slow = np.argmin(np.abs(eigenvalues))
    p, out = balance_of(problem, D), np.empty(4)
    equilibrium = in_python(orbit_equilibrium, thrust_equilibrium)
    balance = in_python(friction_balance)
    seat = equilibrium(p.bearing, case.u[3], Seat(delta_a=case.delta_a, state=cold_start()))

    def acceleration(_, u):
        state = equilibrium(p.bearing, u[3], seat).state
        balance(p, p.bearing.op.v_r, state, u, out, False)
        return out / inertia

    mode = vectors[:, slow].real
    start = case.u + 1e-3 * mode / np.abs(mode).max()
    span = 1.0 / abs(eigenvalues[slow].real)
    # the disturbance is small against v_r, so that the linear theory is good to 1e-2
    path = solve_ivp(acceleration, (0.0, span), start, method="Radau", rtol=1e-9, atol=1e-10)
    left = (path.y[:, -1] - case.u) @ mode / ((start - case.u) @ mode)
    assert_allclose(left, math.exp(-1.0), rtol=1e-2)


def converged_rates(few, D, case, within):
    """Returns the decay rates [1/s] with 1024 points, sorted.

    Checks that all are below zero, and that 512 points have the same, but for a share `within`.
    """
    rates = {}
    for points in (512, 1024):
        many = replace(few, rule=ellipse_rule("split", points))
        rates[points] = np.sort(many.decay_rates(D, many.solve(D, start=case.u)).real)
    assert np.all(rates[1024] < 0.0)
    assert_allclose(rates[512], rates[1024], rtol=within)
    return rates[1024]


@pytest.mark.parametrize(("mu", "v_r"), [(1e-6, 1e-8), (1e-6, 1e-6), (4.8e-6, 4e-6)])
def test_slow_damping_that_few_points_underestimate_is_stable(scene, mu, v_r):
    """With 32 points a motion seems to last minutes or hours; its rates converge to faster ones."""
    few_strips = scene(
        "gyro_s1",
        {
            "operation.preload_method": "fixed_position",
            "wear.ball_diameter_loss_um": 0.5,
            "friction.ball_race": mu,
            "friction.slip_regularisation_m_s": v_r,
            "model.strips": 32,
        },
    )
    D = float(ball_diameters(few_strips)[0])
    few = ThrustProblem.of(few_strips)
    case = few.solve(D)
    slowest = few.decay_rates(D, case).real.max()
    rates = converged_rates(few, D, case, within=0.1)
    assert 5e-3 * rates.max() < slowest < 0.0  # rates are negative: up to 200 times slower
    assert few.stable(D, case) and solve(few_strips).values["status"] == code.OK


@pytest.mark.parametrize(
    ("quadrature", "strips", "v_r"), [("gauss", 8, 1e-7), ("gauss", 4, 1e-8), ("strips", 4, 1e-8)]
)
def test_growth_that_only_few_points_show_is_not_taken_for_instability(
    scene, quadrature, strips, v_r
):
    """With few fixed points and traction a disturbance seems to grow; with many all decay."""
    few_strips = scene(
        "gyro_s1",
        {
            "operation.shaft_speed_rpm": 3500,
            "friction.ball_race": 0.003,
            "friction.slip_regularisation_m_s": v_r,
            "model.normal_balance": "with_traction",
            "model.quadrature": quadrature,
            "model.strips": strips,
        },
    )
    D = float(ball_diameters(few_strips)[0])
    few = ThrustProblem.of(few_strips)
    case = few.solve(D)
    assert case.status == code.OK and few.decay_rates(D, case).real.max() > 0.0
    converged_rates(few, D, case, within=1e-3)
    assert few.stable(D, case) and solve(few_strips).values["stable"] == 1


def test_a_bearing_at_rest_has_no_friction_heat(scene):
    """It has the static equilibrium, with the same angle at both races."""
    values = solve(scene("gyro_s1", {"operation.shaft_speed_rpm": 0})).values
    assert values["status"] == code.OK
    assert values["total_qv"] == 0.0
    assert values["orbit_speed"][0] == 0.0
    assert_allclose(values["axial_displacement"], values["initial_axial_displacement"], rtol=1e-9)
    assert_allclose(*values["contact_angle"][0], rtol=1e-9)


def test_a_bearing_whose_races_turn_together_turns_as_one_body(scene):
    """Both turn at 30 000 r/min: balls orbit with them, and nothing slips."""
    values = solve(scene("gyro_s1", {"operation.outer_speed_rpm": 30000})).values
    assert values["status"] == code.OK
    omega = 30000 * math.pi / 30
    assert_allclose(values["orbit_speed"][0], omega, rtol=1e-9)
    assert_allclose(values["total_qv"], 0.0, atol=1e-9)


@pytest.mark.parametrize(("rpm", "status"), [(30000, "contact_lost"), (0, "preload_gone")])
def test_a_bearing_worn_far_beyond_its_preload_has_its_status(scene, rpm, status):
    """At speed the ball leaves the inner race, at rest both."""
    changes = {"operation.preload_method": "fixed_position", "wear.ball_diameter_loss_um": 60.0}
    changes["operation.shaft_speed_rpm"] = rpm
    assert solve(scene("gyro_s1", changes)).status == status
