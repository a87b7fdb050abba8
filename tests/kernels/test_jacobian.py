"""The matrix of the implicit integrator against differences and against dense linear algebra.

A W-method keeps its order with any matrix, so an order of convergence shows nothing of it.
"""

import numpy as np
import pytest
from kernels.cage_states import TOUCHING, axes, ball_point, cage_point, touching_system
from numpy.testing import assert_allclose

from bearingwear.kernels.ball import drag_force
from bearingwear.kernels.bearing_model import race_contact_of
from bearingwear.kernels.block_system import add_cage_powers, factorise, solve_factorised
from bearingwear.kernels.cage import INNER_LAND
from bearingwear.kernels.contact import (
    ellipse_sums,
    half_width,
    slip_coefficients,
    surface_height,
)
from bearingwear.kernels.jacobian import ball_blocks
from bearingwear.kernels.quasistatic import RACES_11
from bearingwear.kernels.state import BALL, CAGE, CENTRE, MOMENTUM, OMEGA, PSI, ROTATION, VELOCITY
from bearingwear.model.dynamic import DynamicSystem
from bearingwear.model.start import start_of

# Fixed points: those of a split rule move with the slip. Smooth enough for differences.
SMOOTH = {
    "model.quadrature": "strips",
    "friction.slip_regularisation_m_s": 0.03,
    "operation.radial_load_N": [0.0, 2.0],
    "lubricant.drag_density_kg_m3": 250.0,
}


def held_rates(system, j, u):
    """Rates of (w, Omega) of ball j with its contact loads held, then shaft power, heat, turning.

    The friction of the races is summed by force and moment of each contact, as theory.md has it.
    """
    bearing, balls = system.bearing, system.buffers.balls
    m, rule, r, R = bearing.op, bearing.rule, balls.r[j], 0.5 * bearing.D[j]
    moment, force, shaft, heat = np.zeros(3), 0.0, 0.0, 0.0
    for k in range(2):
        contact = race_contact_of(bearing, balls, j, k)
        c = slip_coefficients(contact, tuple(u.tolist()), r)
        h, width = np.empty((2, rule.t.size))
        surface_height(contact, R, rule.t, h)
        half_width(contact, rule.t, width)
        *g, _, _ = ellipse_sums(
            contact, c, m.mu, m.v_r, rule.t, rule.weight, h, width, rule.across, rule.share
        )
        normal = contact.sigma * np.array([contact.sin_a, 0.0, contact.cos_a])
        along = np.array([contact.cos_a, 0.0, -contact.sin_a])
        arm = g[2] * normal + g[3] * along  # sum of point times force along y
        friction = np.cross(arm, [0.0, 1.0, 0.0]) + contact.sigma * g[0] * np.array([0.0, 1.0, 0.0])
        moment += friction
        force += g[1]
        heat += np.dot(c, g)
        shaft += -contact.omega * (r * g[1] + arm[2])
    drag, _ = drag_force(bearing.g, bearing.D[j], m.drag, u[3])
    rates = moment / bearing.inertia[j] + u[3] * np.array([0.0, u[2], -u[1]])
    orbit = -(force + drag) / (bearing.mass[j] * r)
    return np.array([*rates, orbit, shaft, heat, 2.0 * bearing.mass[j] * r**2 * u[3] * orbit])


@pytest.mark.parametrize("contact", ["paper", "hertz"])
@pytest.mark.parametrize("j", [0, 3])
def test_ball_blocks(scene, j, contact):
    """Blocks and slopes of the powers against central differences."""
    s = scene("gyro_s1", SMOOTH | {"cage": None, "model.contact": contact})
    system = DynamicSystem.of(s, start_of(s).u * [1.03, 1.0, 1.03, 1.0] + [0.0, 50.0, 0.0, 0.0])
    system.update()
    u = system.balls[j, :4].copy()
    assert_allclose(held_rates(system, j, u)[:4], system.dy[BALL * j :][:4], rtol=1e-9)
    ball_blocks(system.y, system.bearing, system.buffers)
    found = np.empty((7, 4))
    for v in range(4):
        step = np.zeros(4)
        step[v] = 1e-2
        found[:, v] = (held_rates(system, j, u + step) - held_rates(system, j, u - step)) / 2e-2
    exact = np.vstack([system.buffers.blocks[j], system.buffers.slopes[j]])
    scale = np.abs(found).max(axis=1, keepdims=True)
    assert_allclose(exact / scale, found / scale, rtol=1e-5, atol=1e-7)


def condensed(K, heat, races, T):
    """K (3, 3) and the slopes of powers by displacement, once the ball centre has given way."""
    P = T[:, [0, 2]]  # axial, radial
    S = np.array([[races[0], races[1]], [races[1], races[2]]])
    left = np.eye(3) - P @ np.linalg.solve(S + P.T @ K @ P, P.T @ K)
    return K @ left, heat @ left


def dense(system):
    """J of balls and cage, and the rows of the integrals that the cage's contacts feed."""
    bearing, buf, contacts = system.bearing, system.buffers, system.buffers.cage
    n, cage, z = len(bearing.D), bearing.cage, system.layout.cage
    J = np.zeros((z + CAGE, z + CAGE))
    names = "cage_heat", "damping", "pocket_torque", "land_torque", "turning", "shaft"
    rows = dict.fromkeys(names, 0.0)
    m = bearing.op
    land_speed = m.omega_i if cage.land == INNER_LAND else m.omega_o
    inertia = contacts.R @ np.diag([cage.I_x, cage.I_t, cage.I_t]) @ contacts.R.T
    J[z + CENTRE : z + VELOCITY, z + VELOCITY : z + ROTATION] = np.eye(3)
    J[z + ROTATION : z + MOMENTUM, z + MOMENTUM : z + CAGE] = np.linalg.inv(inertia)
    for j in range(n):
        i = BALL * j
        J[i : i + 4, i : i + 4] = buf.blocks[j]
        J[i + PSI, i + OMEGA] = 1.0
    for k in np.flatnonzero(contacts.normal):
        speed, place = np.zeros((2, 3, z + CAGE))
        speed[:, z:], place[:, z:] = cage_point(system, k)
        K, heat, loss = contacts.K[k], contacts.heat[k], contacts.loss[k]
        by_place = np.array([heat[3:], loss[3:]])
        if k < n:
            own, T = slice(BALL * k, BALL * k + BALL), axes(system.balls[k, PSI])
            of_ball = ball_point(system, k)
            speed[:, own] -= of_ball[0]
            place[:, own] -= of_ball[1]
            K, by_place = condensed(K, by_place, buf.balls.condensed[k, RACES_11:], T)
        else:
            speed, place = -speed, -place  # of the land against the cage
        force = K @ place + contacts.C[k] @ speed  # on the ball, or of the land on the cage
        on_cage = -force if k < n else force
        J[z + VELOCITY : z + ROTATION] += on_cage / cage.mass
        J[z + MOMENTUM : z + CAGE] += np.cross(contacts.arm[k], on_cage, axisb=0, axisc=0)
        if k < n:
            r = buf.balls.r[k]
            moment = np.cross(contacts.reach[k], force, axisb=0, axisc=0)
            J[own][:3] += T.T @ moment / bearing.inertia[k]
            J[own][OMEGA] -= T[:, 1] @ force / (bearing.mass[k] * r)
            Omega = system.balls[k, OMEGA]
            rows["turning"] = rows["turning"] - 2.0 * r * Omega * (T[:, 1] @ force)
        for name, by_speed, row in zip(
            ("cage_heat", "damping"), (heat[:3], loss[:3]), by_place, strict=True
        ):
            rows[name] = rows[name] + by_speed @ speed + row @ place
        point = system.cage_state[CENTRE : CENTRE + 3] + contacts.arm[k]
        torque = point[1] * on_cage[2] - point[2] * on_cage[1]
        name = "pocket_torque" if k < n else "land_torque"
        rows[name] = rows[name] + torque
        if k >= n:
            rows["shaft"] = rows["shaft"] + land_speed * torque
    return J, rows


@pytest.mark.parametrize("guiding", ["outer", "inner"])
@pytest.mark.parametrize("shift", [1e5, 1e8])
def test_factorise_and_solve(scene, guiding, shift):
    """Balls eliminated one by one against the whole matrix, for a random right-hand side."""
    system = touching_system(scene, guiding)
    bearing, buf, y = system.bearing, system.buffers, system.y
    ball_blocks(y, bearing, buf)
    J, rows = dense(system)
    z, factors = system.layout.cage, system.stages.system
    assert factorise(shift, y, bearing, buf, factors)
    assert np.count_nonzero(factors.touching) == len(TOUCHING) + 1
    random = np.random.default_rng(5)
    # Of sizes at which balls and cage matter to each other.
    scale = np.ones(z + CAGE)
    scale[z + CENTRE : z + VELOCITY] = scale[z + ROTATION : z + MOMENTUM] = 1e-6
    scale[z + MOMENTUM : z + CAGE] = 1e-7
    scale[PSI:z:BALL] = 1e-6
    side, U = scale * random.normal(size=z + CAGE), np.zeros(y.size)
    solve_factorised(np.append(side, np.zeros(y.size - side.size)), U, bearing, factors)
    exact = np.linalg.solve(shift * np.eye(z + CAGE) - J, side)
    group = np.abs(exact) + np.abs(side) / shift
    assert_allclose(U[: z + CAGE] / group, exact / group, rtol=1e-7, atol=1e-9)
    powers = np.zeros(y.size)
    add_cage_powers(U, powers, y, bearing, buf, factors)
    for name, row in rows.items():
        assert_allclose(powers[getattr(system.layout, name)], row @ exact, rtol=1e-6, err_msg=name)
