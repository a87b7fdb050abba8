"""The matrix of the implicit integrator against differences of rates and unbalanced forces.

It is that of states, ball centres and race together. A W-method keeps its order with inexact
derivatives of the rates, so that no order of convergence would show an error in them.
"""

from typing import NamedTuple

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

# A few fixed points, as those of a split rule move with the slip; v_r is wide, for differences.
SMOOTH = {
    "model.quadrature": "strips",
    "model.strips": 8,
    "model.points_across": 3,
    "friction.slip_regularisation_m_s": 0.03,
    "operation.radial_load_N": [0.0, 2.0],
    "operation.tilt_mrad": 0.1,
    "lubricant.drag_density_kg_m3": 250.0,
}
UNDAMPED = {"cage.restitution": 1.0}  # the matrix leaves out how damping depends on places
AXIAL = -3  # place of the axial displacement of the race
# integrals in the state, by their fields of the layout; the first three without a cage
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
        for first, step, change in (
            (CENTRE, 1e-12, 1e-7),
            (VELOCITY, 1e-8, 1e-2),
            (ROTATION, 1e-9, 1e-5),
            (MOMENTUM, 1e-8 * momentum, 1e-3 * momentum),
        ):
            small[z + first : z + first + 3], typical[z + first : z + first + 3] = step, change
    return small, typical


def differences(system, small):
    """Returns central differences of rates and forces (m, m), and of the integrals' rates.

    small: step of each state and place (m,).
    """
    bearing, buf, qv = system.bearing, system.buffers, system.layout.qv
    balls, y = buf.balls, system.y
    point = np.r_[y[:qv], balls.X.ravel(), balls.delta]

    def rates_at(u):
        state, dy = y.copy(), np.zeros(y.size)
        state[:qv], balls.X[:], balls.delta[:] = u[:qv], u[qv:-3].reshape(-1, 2), u[-3:]
        assert rates_here(system.time, state, bearing, buf, dy, False) == OK
        return np.r_[dy[:qv], balls.left.ravel(), balls.race_left], dy[qv:]

    J, integral_slopes = [], []
    for k, step in enumerate(small):
        shift = np.zeros(point.size)
        shift[k] = step
        (high, high_integrals), (low, low_integrals) = (
            rates_at(point + shift),
            rates_at(point - shift),
        )
        J.append((high - low) / (2.0 * step))
        integral_slopes.append((high_integrals - low_integrals) / (2.0 * step))
    rates_at(point)
    return np.array(J).T, np.array(integral_slopes).T


def system_without_cage(scene, changes):
    """Returns a system without a cage, off its steady state."""
    s = scene("gyro_s1", SMOOTH | {"cage": None} | changes)
    system = DynamicSystem.of(s, start_of(s).u * [1.03, 1.0, 1.03, 1.0] + [0.0, 50.0, 0.0, 0.0])
    assert system.update() == OK
    return system


class Linearised(NamedTuple):
    """A system that is linearised at its state, and differences to compare with."""

    system: DynamicSystem
    has_cage: bool
    J: np.ndarray  # of rates and unbalanced forces (m, m)
    integral_slopes: np.ndarray  # of the rates of the integrals (integrals, m)
    typical: np.ndarray  # changes of states and places (m,) that matter about equally


@pytest.fixture(
    scope="module",
    params=[
        ("outer", "paper", "constant_force"),
        ("inner", "hertz", "fixed_position"),
        (None, "hertz", None),
    ],
    ids=["outer, without traction", "inner, with traction", "without a cage, with traction"],
)
def linearised(request, scene):
    """Returns a linearised system with three pockets and a land in contact, or without a cage."""
    guiding, contact, method = request.param
    changes = {"model.contact": contact}
    if guiding is None:
        system = system_without_cage(scene, changes)
    else:
        changes |= SMOOTH | UNDAMPED | {"operation.preload_method": method}
        system = touching_system(scene, guiding, changes)
    bearing, buf, stage = system.bearing, system.buffers, system.stages
    assert bearing.traction == (contact == "hertz")
    assert rates_here(system.time, system.y, bearing, buf, stage.rates[0], True) == OK
    small, typical = difference_steps(system)
    linearise(system.y, bearing, buf, stage.system)
    assert stage.system.touching.sum() == (len(TOUCHING) + 1 if guiding else 0)
    J, integral_slopes = differences(system, small)
    return Linearised(system, guiding is not None, J, integral_slopes, typical)


def factorised_matrix(linearised, shift):
    """Returns the matrix of a step (m, m) that its factors stand for, by solving for unit vectors.

    Where the race is held axially, its place AXIAL has a row and a column of the unit matrix.
    """
    system, m = linearised.system, len(linearised.J)
    bearing, held = system.bearing, system.bearing.axial_is_held
    assert factorise(shift, system.y, bearing, system.buffers, system.stages.system)
    inverse = np.empty((m, m))
    for k in range(m):
        side, solution = np.zeros((2, m))
        side[k] = 0.0 if held and k == m + AXIAL else 1.0
        solve_factorised(shift, side, solution, bearing, system.stages.system)
        inverse[:, k] = solution
    if held:
        inverse[AXIAL, AXIAL] = 1.0
    return np.linalg.inv(inverse)


@pytest.mark.parametrize("shift", [1e5, 1e7])
def test_the_factors_of_a_step_are_those_of_the_matrix_of_differences(linearised, shift):
    """Errors are shares of the largest term of a row, for typical changes.

    Rows of the algebraic equations have to be exact: 5e-4 is the error of the differences. Rows of
    the balls agree to 2e-3. Rows of the cage agree to 6e-2: the matrix leaves out the turning
    of the cage itself and the arm of a land that moves.
    """
    system, J, typical = linearised.system, linearised.J, linearised.typical
    cage, algebraic = system.layout.cage, system.layout.qv  # first rows
    dense = np.diag(np.r_[np.full(algebraic, shift), np.zeros(len(J) - algebraic)]) - J
    if system.bearing.axial_is_held:
        dense[AXIAL], dense[:, AXIAL] = 0.0, 0.0
        dense[AXIAL, AXIAL] = 1.0
    errors = np.abs(factorised_matrix(linearised, shift) - dense) * typical
    errors /= np.abs(dense * typical).max(axis=1, keepdims=True)
    assert errors[algebraic:].max() < 5e-4
    assert errors[:cage].max() < 2e-3
    if linearised.has_cage:
        assert errors[cage:algebraic].max() < 6e-2


def test_the_powers_of_a_step_agree_with_their_slopes(linearised):
    """The power of a random step is its product with the slopes, to 3 % of the largest slope."""
    system, typical = linearised.system, linearised.typical
    bearing, stage = system.bearing, system.stages
    step = np.random.default_rng(5).normal(size=typical.size) * typical
    if bearing.axial_is_held:
        step[AXIAL] = 0.0
    powers = np.zeros(system.y.size)
    add_ball_powers(step, system.y, stage.rates[0], bearing, system.buffers, stage.system, powers)
    if linearised.has_cage:
        add_cage_powers(step, system.y, bearing, stage.system, powers)
    for name in NAMES if linearised.has_cage else NAMES[:3]:
        place = getattr(system.layout, name)
        slopes = linearised.integral_slopes[place - system.layout.qv]
        largest = np.abs(slopes * typical).max()
        assert abs(powers[place] - slopes @ step) <= 3e-2 * largest, name


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
