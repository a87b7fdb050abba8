"""Derivatives of the steady balance, of the ball's and of the race's equilibrium."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support import balance_of, in_python

from bearingwear.kernels.contact.friction import Law
from bearingwear.kernels.equilibrium.kinematics import INNER_CONTROL, ORBIT, OUTER_CONTROL
from bearingwear.kernels.equilibrium.race import (
    LOAD_FIELDS,
    LOAD_X,
    MODEL,
    ORBIT_RATE,
    PACKED,
    RaceForces,
    RaceProblem,
    axial_stiffness,
    pack_ball_state,
    race_forces,
    unpack_ball_state,
)
from bearingwear.kernels.equilibrium.thrust_loaded import (
    ball_equilibrium,
    cold_start,
    groove_distance,
    orbit_load,
    static_displacement,
    thrust_equilibrium,
)
from bearingwear.kernels.status import OK
from bearingwear.kernels.steady.balance import (
    Seat,
    friction_balance,
    full_jacobian,
    orbit_equilibrium,
)
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem

full_jacobian, friction_balance = in_python(full_jacobian), in_python(friction_balance)
orbit_equilibrium = in_python(orbit_equilibrium, thrust_equilibrium)
race_forces = in_python(race_forces)
pack_ball_state, unpack_ball_state = in_python(pack_ball_state), in_python(unpack_ball_state)


@pytest.fixture(
    params=[(m, c) for m in ("constant_force", "fixed_position") for c in ("paper", "hertz")]
)
def solved_balance(request, scene):
    """Returns a solved balance with drag, its seat and its motion (4,). Its points are fixed."""
    problem = ThrustProblem.of(
        scene(
            "gyro_s1",
            {
                "operation.preload_method": request.param[0],
                "model.contact": request.param[1],
                "model.normal_balance": "frictionless",
                "model.quadrature": "gauss",
                "lubricant.drag_density_kg_m3": 300.0,
            },
        )
    )
    case = problem.solve(problem.g.D0)
    assert case.status == OK
    p = balance_of(problem, problem.g.D0)
    seat = orbit_equilibrium(p.bearing, case.u[3], Seat(delta_a=case.delta_a, state=cold_start()))
    return p, seat, case.u


def balance_residual(p, seat, u):
    """Returns the residual (4,) of the friction balance at a motion."""
    out = np.empty(4)
    assert friction_balance(p, p.bearing.op.v_r, seat.state, u, out, False) == OK
    return out


def test_the_jacobian_of_the_steady_balance_agrees_with_differences(solved_balance):
    """The equilibrium of the ball is solved at each orbit rate."""
    p, seat, u = solved_balance
    assert full_jacobian(p, p.bearing.op.v_r, seat, u) == OK
    analytic = p.jacobian.copy()
    assert_allclose(
        p.residual, balance_residual(p, seat, u), atol=1e-12 * np.abs(analytic * u).max()
    )
    # Slip changes by the step times a length: 1e-2 of v_r, as linear as the balance is.
    step = 1e-2 * p.bearing.op.v_r / (0.5 * p.bearing.D)
    J = np.empty((4, 4))
    for k in range(4):
        motions = np.array([u + s * step * np.eye(4)[k] for s in (-1.0, 1.0)])
        low, high = (
            balance_residual(p, orbit_equilibrium(p.bearing, motion[3], seat), motion)
            for motion in motions
        )
        J[:, k] = (high - low) / (2.0 * step)
    # The third derivative of the law over a hundredth of its width: 1e-4/6 of the largest slope.
    rows = np.abs(analytic).max(axis=1)
    assert np.abs((analytic - J) / rows[:, None]).max() <= 1e-3


def test_the_jacobian_of_inertia_and_drag_agrees_with_differences(solved_balance):
    """Friction, a million times as stiff, is taken away.

    The balance is then quadratic in the motion, so that central differences are exact.
    """
    p, seat, u = solved_balance
    none = Law(mu=0.0, S=0.0)
    bearing = p.bearing._replace(op=p.bearing.op._replace(law_i=none, law_o=none))
    p = p._replace(bearing=bearing)
    friction_balance(p, bearing.op.v_r, seat.state, u, np.empty(4), True)
    step = 1e-2 * np.abs(u).max()
    J = np.array(
        [
            balance_residual(p, seat, u + e) - balance_residual(p, seat, u - e)
            for e in step * np.eye(4)
        ]
    )
    computed = p.jacobian
    assert_allclose(computed, J.T / (2.0 * step), rtol=1e-10, atol=1e-12 * np.abs(computed).max())
    # gyroscopic moments about y and z, drag on the orbit
    assert np.count_nonzero(computed) == 5


def ball_load(model, **changes):
    """Returns the load of a ball with an orbit of 1300 rad/s, by a model of kinematics."""
    load = orbit_load(1300.0, 0.0, 0.0)
    return load._replace(kinematics_model=model, omega_i=3000.0, **changes)


def test_the_stiffness_of_a_ball_agrees_with_differences(scene):
    """S_xx, S_xr and S_rr are slopes of the inner force; the centre of the ball is free."""
    g = parameters.geometry(scene("gyro_s1"))
    A = np.array(groove_distance(g, 0.0, 1.2 * static_displacement(g, 7.0), 0.0, 0.0, 0.0))
    state = ball_equilibrium(g, g.D0, ball_load(ORBIT), *A, cold_start())
    assert state.status == OK
    step = 1e-10  # [m], of deformations of 1e-6 m

    def force(A):
        s = ball_equilibrium(g, g.D0, ball_load(ORBIT), *A, state)
        return np.array([s.F_ix, s.F_ir])

    S = np.array([force(A + e) - force(A - e) for e in step * np.eye(2)]) / (2.0 * step)
    # The Hertz factors follow the contact angle, which the tangent leaves out: 1e-3 of it.
    tangent = np.array([[state.S_xx, state.S_xr], [state.S_xr, state.S_rr]])
    assert_allclose(S, tangent, atol=2e-3 * np.abs(tangent).max())


@pytest.mark.parametrize("model", [ORBIT, OUTER_CONTROL, INNER_CONTROL])
def test_a_packed_ball_state_is_unpacked_without_loss(scene, model):
    """Only its residual is not packed."""
    g = parameters.geometry(scene("gyro_s1"))
    A1, A2 = groove_distance(g, 0.0, static_displacement(g, 7.0), 0.0, 0.0, 0.0)
    state = ball_equilibrium(g, g.D0, ball_load(model), A1, A2, cold_start())
    row = np.full(PACKED, np.nan)
    pack_ball_state(state, row)
    assert unpack_ball_state(row) == state._replace(residual=0.0)
    assert np.isfinite(row).all()
    assert len(set(row)) > PACKED - 3  # fields differ, so that one exchanged for another shows


def race_of_gyro_s1(scene):
    """Returns the geometry of gyro_s1 and a function of the displacement of its race.

    The function returns force (3,), stiffness (3, 3) and scale of the force. The race is tilted,
    the balls differ and have axial forces.
    """
    g = parameters.geometry(scene("gyro_s1"))
    n = g.n_balls
    loads = np.zeros((n, LOAD_FIELDS))
    loads[:, MODEL], loads[:, ORBIT_RATE] = ORBIT, 1300.0
    loads[:, LOAD_X] = 0.01 * np.sin(np.arange(n))
    packed = np.empty((n, PACKED))
    for row in packed:
        pack_ball_state(cold_start(), row)

    psi = 2.0 * math.pi * np.arange(n) / n
    problem = RaceProblem(
        g=g,
        D=g.D0 - 6e-7 * (np.cos(2.0 * psi - 1.0) < 0.0),  # stiff along one direction
        loads=loads,
        psi=psi,
        F=np.zeros(3),
        tilt=1e-4,
        first=0,
        packed_states=packed,
    )

    def forces(delta):
        out = RaceForces(force=np.empty(3), stiffness=np.empty((3, 3)))
        scale = race_forces(problem, delta, out)
        return *out, scale

    return g, forces


def test_the_stiffness_of_the_race_agrees_with_differences(scene):
    """To 2e-3: the stiffness leaves out how the Hertz factors follow the contact angle."""
    g, forces = race_of_gyro_s1(scene)
    delta = np.array([1.5 * static_displacement(g, 7.0), 3e-7, -2e-7])
    _, stiffness, scale = forces(delta)
    assert scale > 0.0
    assert_allclose(stiffness, stiffness.T, rtol=0, atol=0)
    step = 1e-10
    S = np.array([forces(delta + e)[0] - forces(delta - e)[0] for e in step * np.eye(3)]) / (
        2.0 * step
    )
    assert_allclose(S, stiffness, atol=2e-3 * np.abs(stiffness).max())
    radial = stiffness[1:, 1:]
    assert_allclose(S[1:, 1:], radial, atol=2e-3 * np.abs(radial).max())
    assert np.abs(radial[0, 1]) > 0.1 * np.abs(radial).max()  # unequal balls couple Y and Z


def test_the_axial_stiffness_is_that_of_a_race_that_yields_radially(scene):
    """It is the Schur complement: force over displacement without a radial force."""
    g, forces = race_of_gyro_s1(scene)
    _, k, _ = forces(np.array([1.5 * static_displacement(g, 7.0), 3e-7, -2e-7]))
    yielding = np.linalg.solve(k[1:, 1:], -k[1:, 0])
    assert_allclose(axial_stiffness(k), k[0] @ [1.0, *yielding], rtol=1e-13)
