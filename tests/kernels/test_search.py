"""The search for other steady states over the orbit rate."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import balance_of, benchmark, in_python

from bearingwear.kernels import status as code
from bearingwear.kernels.equilibrium.thrust_loaded import cold_start, thrust_equilibrium
from bearingwear.kernels.steady.balance import Seat
from bearingwear.kernels.steady.search import balance_at_rate
from bearingwear.solvers.bearing.parameters import ball_diameters
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem, is_new

balance_at_rate = in_python(balance_at_rate, thrust_equilibrium)

# The size of a dental drill's bearing, at high friction (docs/verification.md, "Multiple steady
# states"): it has two steady states.
DRILL = {
    "cage": None,
    "operation.preload_N": 7.46,
    "operation.shaft_speed_rpm": 544000,
    "friction.slip_regularisation_m_s": 5.0e-5,
    "friction.ball_race": 0.306,
    "bearing.ball_count": 5,
    "bearing.ball_diameter_mm": 0.948,
    "bearing.pitch_diameter_mm": 2.494,
    "bearing.contact_angle_deg": 25.07,
    "bearing.inner_groove_factor": 0.5097,
    "bearing.outer_groove_factor": 0.559,
    "wear.ball_diameter_loss_um": 1.07,
}


def solved_problem(scene, **geometry):
    """Returns the problem of a scene, its ball diameter [m] and the case that it solves.

    geometry: fields of the geometry to replace.
    """
    problem, D = ThrustProblem.of(scene), float(ball_diameters(scene)[0])
    problem = replace(problem, g=problem.g._replace(**geometry))
    case = problem.solve(D)
    assert case.status == code.OK
    return problem, D, case


def balance_at_share(problem, D, case, share, w=None, v_r=0.03):
    """Returns the balance at a share of the case's orbit rate, and the motion (4,) there.

    w: angular velocity to start from, by default that of the case. v_r: regularisation [m/s].
    """
    u = np.array([*(case.u[:3] if w is None else w), share * case.u[3]])
    near = Seat(delta_a=case.delta_a, state=cold_start())
    tangent, moments_left = np.empty(3), 1e-10  # of the friction forces
    return balance_at_rate(balance_of(problem, D), v_r, near, u, tangent, moments_left), u


@pytest.mark.parametrize("share", [0.3, 0.9, 1.0, 1.2, 2.0])
def test_each_orbit_rate_has_one_angular_velocity(scene, share):
    """Eight unlike starts lead to the same angular velocity and the same force on the orbit."""
    problem, D, case = solved_problem(scene("gyro_s1"))
    computed, motion = balance_at_share(problem, D, case, share)
    assert computed.status == code.OK
    for start in benchmark("search").unlike_starts(problem, 8):
        repeated, repeated_motion = balance_at_share(problem, D, case, share, start[:3])
        assert repeated.status == code.OK
        assert_allclose(repeated.F, computed.F, atol=1e-8)
        assert_allclose(repeated_motion, motion, atol=1e-6 * np.abs(motion).max())


def test_the_force_on_the_orbit_changes_sign_at_the_steady_state(scene):
    """F is relative to friction: 0 at the steady rate, over 0.5 at a tenth to either side of it."""
    problem, D, case = solved_problem(scene("gyro_s1"))
    v_r = problem.op.v_r
    assert abs(balance_at_share(problem, D, case, 1.0, v_r=v_r)[0].F) < 1e-9
    below, above = (balance_at_share(problem, D, case, share)[0].F for share in (0.9, 1.1))
    assert below > 0.5 and above < -0.5


@pytest.mark.parametrize("share", [0.6, 0.97, 1.01, 1.4])
def test_the_slope_of_the_force_on_the_orbit_agrees_with_differences(scene, share):
    """The balls are so light that the loads do not depend on the orbit rate."""
    problem, D, case = solved_problem(scene("gyro_s1"), rho=1e-3)
    computed, u = balance_at_share(problem, D, case, share)
    step = 1e-5
    ends = [balance_at_share(problem, D, case, share + s, u[:3])[0].F for s in (-step, step)]
    assert_allclose(computed.slope * case.u[3], (ends[1] - ends[0]) / (2 * step), rtol=1e-3)


def test_without_gyroscopic_moment_the_force_on_the_orbit_only_falls(scene):
    """Its slope is never positive (1e-12 for rounding), so that there is one steady state."""
    problem, D, case = solved_problem(scene("gyro_s1"), rho=1e-3)
    for share in np.linspace(0.05, 2.5, 40):
        assert balance_at_share(problem, D, case, share)[0].slope <= 1e-12


def test_each_of_two_states_leads_to_the_other(scene):
    """The ratio of their orbit rates is a regression value."""
    problem, D, case = solved_problem(scene("gyro_s1", DRILL))
    starts = 4
    (second_case,) = problem.other_states(D, case, True, starts)
    assert second_case.u[3] / case.u[3] == pytest.approx(1.18234, abs=1e-5)
    assert problem.stable(D, case) and problem.stable(D, second_case)
    (first_case,) = problem.other_states(D, second_case, True, starts)
    assert not is_new(first_case.u, [case])


def test_a_search_without_starts_finds_no_state(scene):
    problem, D, case = solved_problem(scene("gyro_s1", DRILL))
    assert problem.other_states(D, case, True, 0) == []
