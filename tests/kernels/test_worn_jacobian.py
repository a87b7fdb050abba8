"""The friction of worn contacts: its derivative by the motion, against differences."""

import numpy as np
import pytest
from support import in_python

from bearingwear.kernels import status as code
from bearingwear.kernels.worn.friction import place_cells, worn_friction_balance
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.worn.bearing import WornBearing
from bearingwear.solvers.worn.depths import WornDepths

place_cells, worn_friction_balance = in_python(place_cells), in_python(worn_friction_balance)

LINE = {"model.quadrature": "gauss", "uncertainty": None, "lubricant.drag_density_kg_m3": 300.0}
FILM = {
    "friction.ball_race": None,
    "friction.film.shear_strength_MPa": 24.8,
    "friction.film.pressure_coefficient": 0.001,
}


@pytest.mark.parametrize("changes", [{}, FILM], ids=["coulomb", "film"])
def test_the_jacobian_of_the_friction_of_worn_contacts_agrees_with_differences(scene, changes):
    """They differ by 1e-5 of the largest term, and 1e-4 of the largest in each row, at most."""
    problem = ThrustProblem.of(scene("gyro_s1", LINE | {"model.contact": "worn"} | changes))
    bearing = WornBearing(problem, problem.solve(problem.g.D0), 0.0, (32, 8))
    # an invented groove, 0.2 um deep, off the middle of the contact
    depth = 0.2e-6 * np.exp(-((bearing.arc / bearing.major[:, None] - 0.3) ** 2) / 0.2)
    point = bearing.solve(WornDepths(bearing.unworn().ball, grooves=depth))
    assert point.status == code.OK
    g, op, rule = problem.g, problem.op, problem.rule
    work = bearing._friction_work(problem, bearing.worn_races)
    place_cells(g, point.D, op, bearing.worn_races, point.seat, work)

    def residual(u):
        out = np.empty(4)
        worn_friction_balance(g, op, point.D, point.seat, op.v_r, rule, work, u, out)
        return out

    residual(point.u)  # which fills the Jacobian
    analytic = work.jacobian.copy()
    step = 1e-3 * op.v_r / (0.5 * point.D)  # [rad/s]: the ball's surface moves by 1e-3 of v_r
    J = np.column_stack(
        [(residual(point.u + h) - residual(point.u - h)) / (2.0 * step) for h in step * np.eye(4)]
    )
    assert np.abs(analytic - J).max() <= 1e-5 * np.abs(J).max()
    scale = np.abs(J).max(axis=1)[:, None]
    assert np.abs((analytic - J) / scale).max() <= 1e-4
