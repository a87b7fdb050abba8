"""The checks after a solve reject wrong states."""

import numpy as np
import pytest
from support import balance_of, in_python

from bearingwear.kernels import status as code
from bearingwear.kernels.contact.verification import friction_check, polygon_residual
from bearingwear.kernels.equilibrium.thrust_loaded import (
    cold_start,
    groove_distance,
    thrust_equilibrium,
)
from bearingwear.kernels.steady.balance import Seat, orbit_equilibrium
from bearingwear.kernels.steady.thrust import LARGEST_RESIDUAL, Residuals, case_status
from bearingwear.solvers.bearing import thrust_problem
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.solve import solve

friction_check, case_status = in_python(friction_check), in_python(case_status)
orbit_equilibrium = in_python(orbit_equilibrium, thrust_equilibrium)

DRAG = {"lubricant.drag_density_kg_m3": 300.0}


@pytest.fixture(scope="module")
def solved_case(scene):
    """Returns the balance of a problem with drag, the state of its ball, and its case."""
    problem = ThrustProblem.of(scene("gyro_s1", DRAG))
    case = problem.solve(problem.g.D0)
    assert case.status == code.OK
    p = balance_of(problem, problem.g.D0)
    seat = orbit_equilibrium(p.bearing, case.u[3], Seat(delta_a=case.delta_a, state=cold_start()))
    return p, seat.state, case


def friction_and_power_error(p, state, u, op=None):
    """Returns the friction residual and the power error of a state, of `p` or another operation."""
    residual, power, _, _ = friction_check(
        p.bearing.g, p.bearing.D, op or p.bearing.op, state, u, p.rule, False
    )
    return residual, power


def test_a_solved_state_passes(solved_case):
    p, state, case = solved_case
    assert max(friction_and_power_error(p, state, case.u)) <= LARGEST_RESIDUAL


@pytest.mark.parametrize("component", [0, 2, 3])
def test_a_wrong_speed_breaks_the_friction_balance(solved_case, component):
    """One component of the motion, w_x, w_z or Omega, is wrong by one part in a million."""
    p, state, case = solved_case
    u = case.u.copy()
    u[component] *= 1.0 + 1e-6
    residual, _ = friction_and_power_error(p, state, u)
    assert residual > LARGEST_RESIDUAL
    assert residual > 1e3 * friction_and_power_error(p, state, case.u)[0]


def test_a_motion_that_is_too_fast_breaks_the_friction_balance(solved_case):
    """All its components are wrong by one part in a million."""
    p, state, case = solved_case
    assert friction_and_power_error(p, state, case.u * (1.0 + 1e-6))[0] > LARGEST_RESIDUAL


def test_missing_drag_breaks_the_friction_balance(solved_case):
    """A state solved with drag is checked without."""
    p, state, case = solved_case
    residual, _ = friction_and_power_error(p, state, case.u, p.bearing.op._replace(drag=0.0))
    assert residual > LARGEST_RESIDUAL


def test_a_motion_that_is_too_fast_breaks_the_power_balance(solved_case):
    """Shaft power differs from heat and drag if the moments are not in balance."""
    p, state, case = solved_case
    _, power = friction_and_power_error(p, state, case.u * (1.0 + 1e-6))
    assert power > LARGEST_RESIDUAL


def polygon_error(p, state, delta_a):
    """Returns the residual of a ball's polygon with the race at a displacement [m]."""
    A1, A2 = groove_distance(p.bearing.g, 0.0, delta_a, 0.0, 0.0, 0.0)
    return polygon_residual(p.bearing.g, p.bearing.D, state, A1, A2, max(state.Q_i, state.Q_o))


@pytest.mark.parametrize(
    "changes",
    [
        lambda s: {"Q_i": s.Q_i * (1.0 + 1e-7)},
        lambda s: {"Q_o": s.Q_o * (1.0 + 1e-7)},
        lambda s: {"alpha_i": s.alpha_i + 1e-7},
        lambda s: {"alpha_o": s.alpha_o - 1e-7},
        lambda s: {"P_r": s.P_r * (1.0 + 1e-6)},
        lambda s: {"P_x": s.P_x + 1e-7 * s.Q_i},
    ],
    ids=["Q_i", "Q_o", "alpha_i", "alpha_o", "P_r", "P_x"],
)
def test_a_wrong_load_angle_or_traction_breaks_the_normal_balance(solved_case, changes):
    p, state, case = solved_case
    assert polygon_error(p, state, case.delta_a) <= LARGEST_RESIDUAL
    changed_state = state._replace(**changes(state))
    assert polygon_error(p, changed_state, case.delta_a) > LARGEST_RESIDUAL


def test_an_open_polygon_breaks_the_normal_balance(solved_case):
    """The forces are in balance, but the race is a picometre from its place."""
    p, state, case = solved_case
    assert polygon_error(p, state, case.delta_a + 1e-12) > LARGEST_RESIDUAL


NO_RESIDUAL = dict.fromkeys(Residuals._fields, 0.0)


@pytest.mark.parametrize("name", ["equilibrium", "friction", "power"])
@pytest.mark.parametrize("residual", [1.1 * LARGEST_RESIDUAL, np.nan])
def test_a_case_with_one_large_residual_is_unverified(name, residual):
    assert case_status(Residuals(**NO_RESIDUAL)) == code.OK
    assert case_status(Residuals(**NO_RESIDUAL | {name: residual})) == code.UNVERIFIED


def test_residuals_up_to_1e_5_may_be_explained_by_rounding():
    """A larger one has the status of its reason: rounding, or a contact that is all but lost."""
    noisy = NO_RESIDUAL | {"friction": 1e-6, "friction_rounding": 2e-6}
    assert case_status(Residuals(**noisy)) == code.OK
    lost = NO_RESIDUAL | {"friction": 1e-4, "friction_rounding": 2e-4}
    assert case_status(Residuals(**lost)) == code.BELOW_ROUNDING
    light = lost | {"equilibrium_rounding": 2e-4}
    assert case_status(Residuals(**light)) == code.CONTACT_LOST


def test_a_solve_that_stops_early_is_unverified(scene, monkeypatch):
    """With a tolerance of 1e-5, the solver returns a state that its check refuses."""
    monkeypatch.setattr(thrust_problem, "FRICTION_TOLERANCE", 1e-5)
    problem = ThrustProblem.of(scene("gyro_s1", {"model.quadrature": "gauss"}))
    case = problem.solve(problem.g.D0)
    assert case.status == code.UNVERIFIED
    assert LARGEST_RESIDUAL < case.residuals.friction <= 1e-5
    result = solve(scene("gyro_s1", {"model.quadrature": "gauss"}), "steady")
    assert result.status == "unverified"
