"""Traction in the balance of normal forces, to see what leaving it out costs.

The model of the package leaves the friction forces out of the ball's axial and radial balance, as
its source does. Here they are in it, for the steady state under thrust: the position of ball and
race with the traction held, the motion of the ball with the loads held, in turn until both stay.
"""

import math

import numpy as np
from scipy.optimize import root

from bearingwear.kernels import status as code
from bearingwear.kernels.contact import (
    race_contacts,
    slip_coefficients,
    slip_velocity,
    surface_height,
)
from bearingwear.kernels.ellipse import quadrature_points
from bearingwear.kernels.equilibrium import cold_start, thrust_equilibrium
from bearingwear.kernels.friction import force_per_slip, friction_capacity
from bearingwear.kernels.kinematics import ORBIT
from bearingwear.kernels.params import BallLoad, BallState
from bearingwear.kernels.steady_balance import friction_balance
from bearingwear.kernels.summary import COLUMNS, MAJOR, QV, TRACK, contact_summary, workspace
from bearingwear.model import parameters
from bearingwear.model.steady import ThrustProblem
from bearingwear.model.values import wear_values
from bearingwear.scene.scene import Scene

MOST_ROUNDS = 60
_SETTLED = 1e-10  # change of the ball's motion in a round, relative


def traction_along(problem: ThrustProblem, D: float, state: BallState, u: np.ndarray) -> np.ndarray:
    """Friction forces on the ball in the plane of the axis (2, 2): race, axial and radial [N]."""
    R, r, op = 0.5 * D, problem.g.R_o + state.X2, problem.op
    work = workspace(problem.rule)
    force = np.zeros((2, 2))
    for k, contact in enumerate(race_contacts(problem.g, op, state)):
        c = slip_coefficients(contact, u, r)
        t, weight = quadrature_points(problem.rule, contact, R, c, op.v_r, work.t, work.weight)
        h, v1, v2 = np.empty((3, t.size))
        surface_height(contact, R, t, h)
        slip_velocity(contact, c, t, h, v1, v2)
        points = zip(weight * v1, v1**2 + v2**2, strict=True)
        shares = np.array([force_per_slip(p, v_2, op.v_r**2) for p, v_2 in points])
        pull = op.mu * contact.Q * float(shares.sum())
        force[k] = pull * contact.cos_a, -pull * contact.sin_a
    return force


def solve_coupled(scene: Scene) -> dict:
    """Steady state with traction in the normal balance: status, QV, preload, loss rate."""
    problem = ThrustProblem.of(scene)
    g, op, preload = problem.g, problem.op, problem.preload
    D = float(parameters.ball_diameters(scene)[0])
    if problem.undetermined() != code.OK:
        return {"status": problem.undetermined()}
    case = problem.solve(D)
    if case.status != code.OK:
        return {"status": case.status}
    u, delta_a, p = case.u.copy(), case.delta_a, problem.balance(D)
    state, force, scale = cold_start(), np.zeros((2, 2)), np.abs(case.u).max()

    def balance(x: np.ndarray) -> np.ndarray:
        out = np.empty(4)
        friction_balance(p, op.v_r, state, scale * x, out, False)
        return out / (friction_capacity(op.mu, state.Q_i, state.Q_o) * 0.5 * D)

    for turn in range(MOST_ROUNDS):
        pushed = force.sum(axis=0)
        load = BallLoad(ORBIT, u[3], 0.0, 0.0, float(pushed[0]), float(pushed[1]))
        carried = preload.F_x - g.n_balls * float(force[0, 0])  # by the normal forces alone
        delta_a, state = thrust_equilibrium(
            g, D, load, carried, delta_a, preload.constant_force, state
        )
        if state.status != code.OK:
            return {"status": state.status}
        found = root(balance, u / scale, method="hybr", options={"xtol": 1e-13})
        before, u = u, scale * found.x
        # half way: where friction holds the ball, the whole way swings from side to side
        force = 0.5 * (force + traction_along(problem, D, state, u))
        if turn > 0 and np.abs(u - before).max() <= _SETTLED * scale:
            break
    else:
        return {"status": code.NOT_CONVERGED}
    rows = np.empty((2, COLUMNS))
    contact_summary(g, D, op, state, u, g.R_o + state.X2, problem.rule, p, rows)
    qv, a, track = (rows[None, :, column] for column in (QV, MAJOR, TRACK))
    axial = state.Q_i * math.sin(state.alpha_i) + force[0, 0]
    return {
        "status": code.OK,
        "contact_load": np.array([[state.Q_i, state.Q_o]]),
        "contact_angle": np.array([[state.alpha_i, state.alpha_o]]),
        "orbit_radius": g.R_o + state.X2,
        "ball_motion": u,
        "qv": qv,
        "total_qv": g.n_balls * qv.sum(),
        "residual_preload": g.n_balls * axial,
    } | wear_values(scene, np.array([D]), qv, a, track)
