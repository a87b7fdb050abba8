"""The stiffness matrix of a bearing: its properties, its limits, and differences of forces."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from published_bearings import B218, MM2, NOSAKA, geometry

from bearingwear.kernels.equilibrium.kinematics import ORBIT
from bearingwear.kernels.equilibrium.stiffness import DOF, bearing_stiffness
from bearingwear.kernels.equilibrium.thrust_loaded import (
    ball_equilibrium,
    cold_start,
    static_displacement,
    thrust_equilibrium,
)
from bearingwear.kernels.params import BallLoad
from bearingwear.kernels.status import CONTACT_LOST, NOT_CONVERGED, OK

STEP = 1e-6  # of the deformation


def orbit_load(Omega=0.0):
    """Returns the load of a ball with an orbit rate [rad/s] and nothing else."""
    return BallLoad(
        kinematics_model=ORBIT,
        Omega=Omega,
        omega_i=0.0,
        omega_o=0.0,
        P_x=0.0,
        P_r=0.0,
        T_i=0.0,
        T_o=0.0,
    )


def azimuths(g):
    """Returns the azimuths of the balls (n,) [rad]."""
    return 2.0 * np.pi * np.arange(g.n_balls) / g.n_balls


def ball_states(g, D, Omega, q):
    """Returns the balls in equilibrium with an inner race displaced and tilted by q (DOF,)."""
    states = []
    for psi, diameter in zip(azimuths(g), D, strict=True):
        s, c = math.sin(psi), math.cos(psi)
        A1 = g.BD * math.sin(g.alpha0) + q[0] + g.R_i * (q[3] * c + q[4] * s)
        A2 = g.BD * math.cos(g.alpha0) - q[1] * s + q[2] * c
        states.append(ball_equilibrium(g, diameter, orbit_load(Omega), A1, A2, cold_start()))
        assert states[-1].status != NOT_CONVERGED
    return states


def reaction(g, D, Omega, q):
    """Returns forces and moments (DOF,) of the inner race on the balls, by plain vectors."""
    total = np.zeros(DOF)
    for psi, state in zip(azimuths(g), ball_states(g, D, Omega, q), strict=True):
        radial = np.array([0.0, -math.sin(psi), math.cos(psi)])
        force = np.array([state.F_ix, 0.0, 0.0]) + state.F_ir * radial
        moment = np.cross(g.R_i * radial, [state.F_ix, 0.0, 0.0])
        total += [*force, *moment[1:]]
    return total


def stiffness(g, D, states):
    """Returns the stiffness matrix (DOF, DOF) for some states of the balls."""
    K = np.empty((DOF, DOF))
    Q = np.array([(s.Q_i, s.Q_o) for s in states])
    alpha = np.array([(s.alpha_i, s.alpha_o) for s in states])
    bearing_stiffness(g, D, azimuths(g), Q, alpha, K)
    return K


@pytest.mark.parametrize(
    ("g", "F_x", "Omega"), [(MM2, 7.0, 1260.0), (NOSAKA, 2670.0, 2143.0), (B218, 17800.0, 476.0)]
)
@pytest.mark.parametrize("part", [0.0, 0.5, 2.5])
def test_the_stiffness_matrix_agrees_with_differences_of_forces(g, F_x, Omega, part):
    """The race is under thrust (part 0), under all loads (0.5), and off some of its balls (2.5)."""
    delta = static_displacement(g, F_x)
    q = delta * np.array([1.0, 0.2 * part, 0.4 * part, -0.2 * part / g.R_i, 0.1 * part / g.R_i])
    D = g.D0 - 0.02 * delta * np.arange(g.n_balls) / g.n_balls
    K = stiffness(g, D, ball_states(g, D, Omega, q))
    scale = np.array([1.0, 1.0, 1.0, g.R_i, g.R_i])
    steps = STEP * delta * np.diag(1.0 / scale)
    computed = np.array(
        [(reaction(g, D, Omega, q + h) - reaction(g, D, Omega, q - h)) / 2.0 for h in steps]
    ) / (STEP * delta)
    # like the race's own tangent, without the part of the Hertz factors that follows the angle
    in_newton = K / np.outer(scale, scale)
    assert_allclose(computed / scale, in_newton, rtol=0, atol=3e-3 * np.abs(in_newton).max())


def test_the_stiffness_matrix_is_symmetric_and_positive_definite():
    """It is so in 500 random bearings under thrust, speed and small loads."""
    random = np.random.default_rng(6)
    count = 0
    while count < 500:
        D, Z = 10.0 ** random.uniform(-3.3, -1.5), int(random.integers(5, 25))
        dm = D / math.sin(math.pi / Z) * random.uniform(1.05, 2.0)
        g = geometry(
            D, dm, random.uniform(5.0, 60.0), *random.uniform(0.505, 0.6, 2), Z,
            random.uniform(3000.0, 8000.0), random.uniform(1e11, 3e11), 0.3,
        )  # fmt: skip
        pressed = 10.0 ** random.uniform(5.0, 7.5) * D**2  # at rest up to 2 GPa or so
        delta = static_displacement(g, pressed * Z)
        Omega = random.uniform(0.0, 1.0) * math.sqrt(pressed / (g.rho * D**3 * dm))
        q = delta * random.uniform(-0.2, 0.2, DOF) / [1.0, 1.0, 1.0, g.R_i, g.R_i]
        q[0] = delta
        states = ball_states(g, np.full(Z, D), Omega, q)
        if any(s.status in (CONTACT_LOST, NOT_CONVERGED) or s.Q_i <= 0.0 for s in states):
            continue
        K = stiffness(g, np.full(Z, D), states)
        scale = np.sqrt(np.diag(K))
        assert_allclose(K, K.T, rtol=0, atol=0)
        assert np.linalg.eigvalsh(K / np.outer(scale, scale)).min() > 1e-6
        count += 1


@pytest.mark.parametrize("alpha0", [10.0, 20.0, 40.0])
def test_stiffness_ratios_at_rest_have_closed_forms(alpha0):
    """k_r/k_a = cot^2(a)/2, and for tilt R_i^2/2, under a small thrust, where both angles agree."""
    g = geometry(8e-3, 38.5e-3, alpha0, 0.54, 0.53, 10, 7800.0, 208e9, 0.3)
    F = 1e-3
    delta, state = thrust_equilibrium(
        g, g.D0, orbit_load(), F, static_displacement(g, F), True, cold_start()
    )
    assert state.status == OK
    D = np.full(g.n_balls, g.D0)
    K = stiffness(g, D, ball_states(g, D, 0.0, np.array([delta, 0.0, 0.0, 0.0, 0.0])))
    ratio = 0.5 / math.tan(state.alpha_i) ** 2
    assert_allclose(K[1, 1] / K[0, 0], ratio, rtol=2e-4)  # sideways the load itself resists, too
    assert_allclose(K[2, 2] / K[0, 0], ratio, rtol=2e-4)
    assert_allclose(K[3, 3] / K[0, 0], 0.5 * g.R_i**2, rtol=1e-9)
    assert_allclose(K[2, 3], -K[1, 4], rtol=1e-9)
    # Balls are rows of springs along the contact line: pushing sideways tilts.
    coupling = 0.5 * g.R_i * K[0, 0] / math.tan(state.alpha_i)
    assert_allclose(K[2, 3], coupling, rtol=2e-4)
    # 1e-9: the deformation under a light load is a small difference of lengths
    assert_allclose(K[0, 0], g.n_balls * state.S_xx, rtol=1e-9)
