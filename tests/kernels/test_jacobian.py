"""The matrix of the implicit integrator against differences of what it is the derivative of.

States, ball centres and race together: a W-method keeps its order with inexact derivatives of the
rates, so an order of convergence shows nothing of them.
"""

import numpy as np
import pytest
from kernels.cage_states import TOUCHING, touching_system
from numpy.testing import assert_allclose
from support import in_python

from bearingwear.kernels.dynamic.block_solve import (
    add_ball_powers,
    add_cage_powers,
    solve_factorised,
)
from bearingwear.kernels.dynamic.block_system import factorise, linearise
from bearingwear.kernels.dynamic.rates import rates_here
from bearingwear.kernels.layout import (
    BALL,
    CENTRE,
    MOMENTUM,
    OMEGA,
    PSI,
    ROTATION,
    VELOCITY,
    W_X,
)
from bearingwear.kernels.linear import factor_in_place, solve_factored
from bearingwear.kernels.status import OK
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.start import start_of

rates_here, linearise, factorise = map(in_python, (rates_here, linearise, factorise))
add_ball_powers, add_cage_powers = in_python(add_ball_powers), in_python(add_cage_powers)
solve_factorised = in_python(solve_factorised)
factor_in_place, solve_factored = in_python(factor_in_place), in_python(solve_factored)

# Fixed points, a few: those of a split rule move with the slip. Smooth enough for differences.
SMOOTH = {
    "model.quadrature": "strips",
    "model.strips": 8,
    "model.points_across": 3,
    "friction.slip_regularisation_m_s": 0.03,
    "operation.radial_load_N": [0.0, 2.0],
    "operation.tilt_mrad": 0.1,
    "lubricant.drag_density_kg_m3": 250.0,
}
HARD = {"cage.restitution": 1.0}  # a damped pocket's force depends on places in ways left out
NAMES = "shaft", "heat", "turning", "cage_heat", "damping", "pocket_torque", "land_torque"


def difference_steps(system):
    """Returns steps of differences by states and places, and changes that matter about equally."""
    n, z, qv = len(system.bearing.D), system.layout.cage, system.layout.qv
    small, typical = np.full((2, qv + 2 * n + 3), 1e-12)
    typical[:] = 1e-8
    for j in range(n):
        i = BALL * j
        small[i + W_X : i + OMEGA], small[i + OMEGA], small[i + PSI] = 1e-2, 1e-3, 1e-9
        typical[i + W_X : i + OMEGA], typical[i + OMEGA], typical[i + PSI] = 10.0, 1.0, 1e-6
    if qv > z:
        momentum = abs(system.y[z + MOMENTUM])
        for at, step, change in (
            (CENTRE, 1e-12, 1e-7),
            (VELOCITY, 1e-8, 1e-2),
            (ROTATION, 1e-9, 1e-5),
            (MOMENTUM, 1e-8 * momentum, 1e-3 * momentum),
        ):
            small[z + at : z + at + 3], typical[z + at : z + at + 3] = step, change
    return small, typical


def differences(system, small):
    """Returns central differences of rates and forces (m, m), and of the integrals' rates.

    small: step of each state and place (m,).
    """
    bearing, buf, qv = system.bearing, system.buffers, system.layout.qv
    balls, y = buf.balls, system.y
    here = np.r_[y[:qv], balls.X.ravel(), balls.delta]

    def called(u):
        moved, dy = y.copy(), np.zeros(y.size)
        moved[:qv], balls.X[:], balls.delta[:] = u[:qv], u[qv:-3].reshape(-1, 2), u[-3:]
        assert rates_here(system.time, moved, bearing, buf, dy, False) == OK
        return np.r_[dy[:qv], balls.left.ravel(), balls.race_left], dy[qv:]

    computed = []
    for k, step in enumerate(small):
        shift = np.zeros(here.size)
        shift[k] = step
        pairs = zip(called(here + shift), called(here - shift), strict=True)
        computed.append([(high - low) / (2.0 * step) for high, low in pairs])
    called(here)
    return (np.array(column).T for column in zip(*computed, strict=True))


def system_without_cage(scene, changes):
    """Returns a system without a cage, off its steady state."""
    s = scene("gyro_s1", SMOOTH | {"cage": None} | changes)
    system = DynamicSystem.of(s, start_of(s).u * [1.03, 1.0, 1.03, 1.0] + [0.0, 50.0, 0.0, 0.0])
    assert system.update() == OK
    return system


@pytest.mark.parametrize(
    ("guiding", "contact", "method"),
    [
        ("outer", "paper", "constant_force"),
        ("inner", "hertz", "fixed_position"),
        (None, "hertz", None),
    ],
)
def test_the_matrix_of_a_step_and_its_powers_agree_with_differences(
    scene, guiding, contact, method
):
    """The factors are compared with the dense matrix, powers of a step with their slopes.

    With traction in the balance (hertz) and without it; with three pockets and a land in contact,
    or without a cage.
    """
    changes = {"model.contact": contact}
    if guiding is None:
        system = system_without_cage(scene, changes)
    else:
        changes |= SMOOTH | HARD | {"operation.preload_method": method}
        system = touching_system(scene, guiding, changes)
    bearing, buf, y, stage = system.bearing, system.buffers, system.y, system.stages
    assert bearing.traction == (contact == "hertz")
    assert rates_here(system.time, y, bearing, buf, stage.rates[0], True) == OK
    small, typical = difference_steps(system)
    linearise(y, bearing, buf, stage.system)
    assert stage.system.touching.sum() == (len(TOUCHING) + 1 if guiding else 0)
    J, slopes = differences(system, small)
    qv, z, held = system.layout.qv, system.layout.cage, bearing.axial_is_held
    for shift in (1e5, 1e7):
        assert factorise(shift, y, bearing, buf, stage.system)
        dense = np.diag(np.r_[np.full(qv, shift), np.zeros(J.shape[0] - qv)]) - J
        if held:
            dense[-3], dense[:, -3] = 0.0, 0.0
            dense[-3, -3] = 1.0
        inverse = np.empty(J.shape)
        for k in range(J.shape[0]):
            side, U = np.zeros((2, J.shape[0]))
            side[k] = 1.0 if not (held and k == J.shape[0] - 3) else 0.0
            solve_factorised(shift, side, U, bearing, stage.system)
            inverse[:, k] = U
        if held:
            inverse[-3, -3] = 1.0
        apart = (np.linalg.inv(inverse) - dense) * typical
        share = np.abs(apart) / np.abs(dense * typical).max(axis=1, keepdims=True)
        assert share[qv:].max() < 5e-4  # the algebraic equations have to be exact
        balls = share[:z]
        assert balls.max() < 2e-3
        if guiding:  # the cage's own turning is left out, and the arm of a land that moves
            assert share[z:qv].max() < 6e-2
    random = np.random.default_rng(5).normal(size=J.shape[0]) * typical
    powers = np.zeros(y.size)
    if held:
        random[-3] = 0.0
    add_ball_powers(random, y, stage.rates[0], bearing, buf, stage.system, powers)
    if guiding:
        add_cage_powers(random, y, bearing, stage.system, powers)
    for name in NAMES if guiding else NAMES[:3]:
        row = slopes[getattr(system.layout, name) - qv] * typical
        computed = powers[getattr(system.layout, name)]
        scale = np.abs(row).max()
        assert abs(computed - row @ (random / typical)) <= 3e-2 * scale, name


def test_factoring_pivots_and_refuses_a_singular_matrix():
    """A matrix whose diagonal vanishes is factored; a singular one is refused."""
    random = np.random.default_rng(3)
    A, b, pivots = random.normal(size=(9, 9)), random.normal(size=9), np.zeros(9, dtype=int)
    np.fill_diagonal(A, 0.0)
    exact, factors = np.linalg.solve(A, b), A.copy()
    assert factor_in_place(factors, pivots, 9)
    solve_factored(factors, pivots, b, 9)
    assert_allclose(b, exact, rtol=1e-9)
    assert not factor_in_place(np.ones((9, 9)), pivots, 9)
