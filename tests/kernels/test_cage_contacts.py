"""Derivatives of the cage's contacts against differences.

The steps of a W-method keep their order with wrong derivatives, so no run would show them.
"""

import numpy as np
import pytest
from kernels.cage_states import TOUCHING, contacts, force_on_ball, touching_system
from numpy.testing import assert_allclose
from support import in_python

from bearingwear.kernels.cage.law import CageContact, power_slopes
from bearingwear.kernels.dynamic.equilibrium import linearise_cage_forces
from bearingwear.kernels.dynamic.quasistatic import K_11
from bearingwear.kernels.layout import CENTRE, VELOCITY

power_slopes, linearise_cage_forces = in_python(power_slopes), in_python(linearise_cage_forces)

MU, V_R = 0.3, 1e-3


def difference(call, array, place, step):
    """Returns the central difference of `call()` by the number `array[place]`."""
    computed = []
    value = array[place]
    for sign in (1.0, -1.0):
        array[place] = value + sign * step
        computed.append(np.array(call()))
    array[place] = value
    return (computed[0] - computed[1]) / (2.0 * step)


def by_vector(call, state, first, step):
    """Returns central differences of `call()` by three numbers of a state, as columns."""
    return np.array([difference(call, state, first + i, step) for i in range(3)]).T


def assert_close(actual, expected, rtol=1e-5):
    """Asserts that numbers agree to a share of the largest one."""
    assert_allclose(actual, expected, rtol=rtol, atol=rtol * np.abs(expected).max())


def powers(velocity, place, n, stiffness, damping):
    """Returns friction heat and damping power [W] of a contact with F = k d + c d closing."""
    closing, d = -velocity @ n, 1e-6 - place @ n
    F = stiffness * d + damping * d * closing
    slip = velocity + closing * n
    return MU * F * slip @ slip / np.sqrt(slip @ slip + V_R**2), damping * d * closing**2


@pytest.mark.parametrize("speed", [1e-4, 1e-3, 1e-1])
def test_slopes_of_friction_heat_and_damping_power_agree_with_differences(speed):
    """Slopes are by velocity and place of a contact, at speeds around the regularisation."""
    random = np.random.default_rng(3)
    n, velocity = random.normal(size=(2, 3))
    n, velocity, place = n / np.linalg.norm(n), speed * velocity, np.zeros(3)
    k, c = 1e6, 1e7
    closing, d = -velocity @ n, 1e-6
    contact = CageContact(
        n=tuple(n.tolist()),
        slip=tuple((velocity + closing * n).tolist()),
        closing=float(closing),
        F=float(k * d + c * d * closing),
        stiffness=float(k + c * closing),
        damping=c * d,
        change=c,
    )
    heat, loss = np.empty((2, 6))
    power_slopes(contact, MU, V_R, heat, loss)

    def call():
        return powers(velocity, place, n, k, c)

    steps = (velocity, 1e-5 * speed), (place, 1e-11)
    computed = np.array([difference(call, x, i, h) for x, h in steps for i in range(3)]).T
    assert_close(heat, computed[0])
    assert_close(loss, computed[1])


@pytest.mark.parametrize("j", TOUCHING)
def test_the_stiffness_of_a_pocket_agrees_with_differences(scene, j):
    """It is the slope of the force on a ball by the place of the cage, here without damping.

    The matrix leaves out how the force of a damped contact depends on the place.
    """
    system = touching_system(scene, changes={"cage.restitution": 1.0})
    K = system.buffers.cage.K[j].copy()
    numerical = by_vector(lambda: force_on_ball(system, j), system.cage_state, CENTRE, 1e-12)
    assert_close(K, numerical, 1e-4)


@pytest.mark.parametrize("j", TOUCHING)
def test_the_damping_of_a_pocket_agrees_with_differences(scene, j):
    """It is the slope of the force on a ball by the velocity of the cage: friction and damping."""
    system = touching_system(scene)
    C = system.buffers.cage.C[j].copy()
    numerical = by_vector(lambda: force_on_ball(system, j), system.cage_state, VELOCITY, 1e-8)
    assert_close(C, numerical)


def land_edge(system):
    """Returns the number of the edge of the land that touches, and its normal."""
    buffers = system.buffers.cage
    edge = 9 + int(np.argmax(buffers.normal[9:]))
    x = system.bearing.cage.half_width * (1.0 if edge == 10 else -1.0)
    across = system.cage_state[CENTRE : CENTRE + 3] + x * buffers.R[:, 0]
    if system.bearing.cage.land == 2:  # an inner one, which moves with the race
        across = across - system.buffers.balls.delta
    across[0] = 0.0
    return edge, across / np.linalg.norm(across)


def force_of_land(system):
    """Returns the force of the land on the cage: the whole one less that of the pockets [N]."""
    buffers = contacts(system)
    return buffers.force[:3] + sum(force_on_ball(system, j) for j in TOUCHING)


@pytest.mark.parametrize("guiding", ["outer", "inner"])
def test_the_damping_of_the_land_agrees_with_differences(scene, guiding):
    """It is the slope of the force on the cage by its velocity, of friction and damping."""
    system = touching_system(scene, guiding)
    edge, _ = land_edge(system)
    assert system.buffers.cage.normal[9:].min() == 0.0  # one edge alone
    C = system.buffers.cage.C[edge].copy()
    numerical = by_vector(lambda: force_of_land(system), system.cage_state, VELOCITY, 1e-7)
    assert_close(C, -numerical, 1e-4)


@pytest.mark.parametrize("guiding", ["outer", "inner"])
def test_the_stiffness_of_the_land_agrees_with_differences(scene, guiding):
    """It is the slope by the place of the cage, which also changes slip and normal."""
    system = touching_system(scene, guiding)
    edge, _ = land_edge(system)
    K = system.buffers.cage.K[edge].copy()
    numerical = by_vector(lambda: force_of_land(system), system.cage_state, CENTRE, 1e-12)
    assert_close(-K[:, 1:], numerical[:, 1:], 1e-4)


def test_the_linear_force_of_an_inner_land_agrees_with_differences(scene):
    """It is the force on the race, by the displacement of the race along the normal."""
    system = touching_system(scene, "inner")
    balls, buffers = system.buffers.balls, system.buffers.cage
    _, n = land_edge(system)
    linearise_cage_forces(system.bearing, balls, buffers)
    lines = balls.land_linear[K_11:].reshape(2, 2).copy()
    shift, delta = np.zeros(1), balls.delta.copy()

    def call():
        balls.delta[:] = delta + shift * n
        return contacts(system).race_force

    assert_close(lines @ n[1:], -difference(call, shift, 0, 1e-12), 1e-4)


@pytest.mark.parametrize("j", TOUCHING)
def test_the_linear_force_of_a_pocket_agrees_with_differences(scene, j):
    """It has the axial and radial force, by the axial and radial displacement of the ball."""
    system = touching_system(scene, changes={"cage.restitution": 1.0})
    balls, buffers = system.buffers.balls, system.buffers.cage
    linearise_cage_forces(system.bearing, balls, buffers)
    lines = balls.cage_linear[j, K_11:].reshape(2, 2).copy()

    def call():
        return contacts(system).ball_force[j, [0, 2]]

    # A ball that goes outward also moves faster along its orbit, which the lines leave out: 1 %.
    computed = np.array([difference(call, balls.X, (j, k), 1e-12) for k in range(2)]).T
    assert_close(lines[:, 0], -computed[:, 0], 1e-4)
    assert_allclose(lines[:, 1], -computed[:, 1], rtol=1e-2, atol=1e-3 * np.abs(computed).max())
