"""The checks after a solve must say no: each is fed a wrong state."""

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
def solved(scene):
    """A problem with drag, its state (seat) and its case."""
    problem = ThrustProblem.of(scene("gyro_s1", DRAG))
    case = problem.solve(problem.g.D0)
    assert case.status == code.OK
    p = balance_of(problem, problem.g.D0)
    seat = orbit_equilibrium(p.bearing, case.u[3], Seat(delta_a=case.delta_a, state=cold_start()))
    return p, seat.state, case


def check(p, state, u, op=None):
    """Friction residual and power error of a state."""
    residual, power, _, _ = friction_check(
        p.bearing.g, p.bearing.D, op or p.bearing.op, state, u, p.rule, False
    )
    return residual, power


def test_a_solved_state_passes(solved):
    p, state, case = solved
    assert max(check(p, state, case.u)) <= LARGEST_RESIDUAL


@pytest.mark.parametrize("component", [0, 2, 3])
def test_a_wrong_speed_breaks_the_friction_balance(solved, component):
    """One part in a million of one component of the motion, w_x, w_z or Omega."""
    p, state, case = solved
    u = case.u.copy()
    u[component] *= 1.0 + 1e-6
    residual, _ = check(p, state, u)
    assert residual > 1e-9
    assert residual > 1e3 * check(p, state, case.u)[0]


def test_every_speed_in_proportion_breaks_the_friction_balance(solved):
    p, state, case = solved
    assert check(p, state, case.u * (1.0 + 1e-6))[0] > 1e-9


def test_drag_left_out_breaks_both_balances(solved):
    """A state solved with drag, checked without."""
    p, state, case = solved
    residual, power = check(p, state, case.u, p.bearing.op._replace(drag=0.0))
    assert residual > LARGEST_RESIDUAL


def test_heat_that_nothing_supplies_breaks_the_power_balance(solved):
    """Shaft power differs from heat and drag as soon as the moments are not in balance."""
    p, state, case = solved
    _, power = check(p, state, case.u * (1.0 + 1e-6))
    assert power > LARGEST_RESIDUAL


def residual_of_polygon(p, state, delta_a):
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
def test_a_wrong_load_or_angle_breaks_the_normal_balance(solved, changes):
    p, state, case = solved
    assert residual_of_polygon(p, state, case.delta_a) <= LARGEST_RESIDUAL
    wrong = state._replace(**changes(state))
    assert residual_of_polygon(p, wrong, case.delta_a) > LARGEST_RESIDUAL


def test_an_open_polygon_breaks_the_normal_balance(solved):
    """Forces in balance, but the grooves are a picometre from where the ball's springs end."""
    p, state, case = solved
    assert residual_of_polygon(p, state, case.delta_a + 1e-12) > LARGEST_RESIDUAL


GOOD = dict.fromkeys(Residuals._fields, 0.0)


@pytest.mark.parametrize("name", ["equilibrium", "friction", "power"])
@pytest.mark.parametrize("found", [1.1e-9, np.nan])
def test_verdict_refuses_each_residual(name, found):
    assert case_status(Residuals(**GOOD)) == code.OK
    assert case_status(Residuals(**GOOD | {name: found})) == code.UNVERIFIED


def test_verdict_lets_rounding_explain_a_little():
    """Up to 1e-5; beyond, the state is refused and rounding named as the reason."""
    noisy = GOOD | {"friction": 1e-6, "friction_rounding": 2e-6}
    assert case_status(Residuals(**noisy)) == code.OK
    lost = GOOD | {"friction": 1e-4, "friction_rounding": 2e-4}
    assert case_status(Residuals(**lost)) == code.BELOW_ROUNDING
    light = lost | {"equilibrium_rounding": 2e-4}
    assert case_status(Residuals(**light)) == code.CONTACT_LOST


def test_a_solve_that_stops_early_is_unverified(scene, monkeypatch):
    """A solver content with a residual of 1e-5 hands over a state that its own check refuses."""
    monkeypatch.setattr(thrust_problem, "FRICTION_TOLERANCE", 1e-5)
    problem = ThrustProblem.of(scene("gyro_s1", {"model.quadrature": "gauss"}))
    case = problem.solve(problem.g.D0)
    assert case.status == code.UNVERIFIED
    assert LARGEST_RESIDUAL < case.residuals.friction <= 1e-5
    result = solve(scene("gyro_s1", {"model.quadrature": "gauss"}), "steady")
    assert result.status == "unverified"
