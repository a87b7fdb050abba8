"""A cage with a weight and an imbalance, on races that are displaced, and when it is settled."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.kernels.cage.body import imbalance_vector
from bearingwear.kernels.cage.law import LAND_DAMPING, LAND_HEAT
from bearingwear.kernels.cage.pocket import pocket_force
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.layout import CENTRE, MOMENTUM, OMEGA, VELOCITY
from bearingwear.kernels.status import OK
from bearingwear.solvers.dynamic.run import solve_dynamic
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.dynamic.windows import Trend
from bearingwear.solvers.start import start_of

WIDE = {"cage.pocket_clearance_mm": 0.5, "cage.guide_clearance_mm": 1.0}
INNER = {
    "cage.guiding_race": "inner",
    "cage.inner_diameter_mm": 6.2,
    "cage.guide_clearance_mm": 0.1,
}


def started(scene, changes):
    """Returns the motion of gyro_s1 with these changes, as a solve begins it."""
    s = scene("gyro_s1", changes)
    return DynamicSystem.of(s, start_of(s).u)


def test_a_free_cage_falls_along_a_parabola(scene):
    """The centre of mass of a turning cage that touches nothing does, to rounding.

    The centre goes round it at the distance of the imbalance.
    """
    gravity = np.array([1.0, 2.0, -9.81])
    changes = {"operation.gravity_m_s2": gravity.tolist(), "cage.imbalance_um": 20.0}
    system = started(scene, WIDE | changes)
    z = system.cage_state
    z[:6] = 0.0
    z[MOMENTUM] = system.bearing.cage.I_x * system.balls[:, OMEGA].mean()
    energy = system.energy()
    assert system.advance(1.6 * system.turn).status == OK
    t = system.time
    assert not system.buffers.cage.normal.any()
    assert_allclose(z[CENTRE : CENTRE + 3], 0.5 * gravity * t**2, rtol=1e-9)
    assert_allclose(z[VELOCITY : VELOCITY + 3], gravity * t, rtol=1e-9)
    shift = imbalance_vector(system.bearing.cage, system.buffers.cage.R)
    angle = z[MOMENTUM] / system.bearing.cage.I_x * t
    assert_allclose(shift, 2e-5 * np.array([0.0, -math.sin(angle), math.cos(angle)]), atol=1e-10)
    gained = system.energy()["supplied"] - energy["supplied"] - system.y[system.layout.shaft]
    work = system.bearing.cage.mass * 0.5 * (gravity @ gravity) * t**2
    assert_allclose(gained, work, rtol=1e-6)


@jit
def force_of(cage, mass, approach, speed):
    """Returns the forces [N] of a pocket's spring, and of spring and damping, on a ball.

    approach: [m]; speed: at which the bodies close [m/s].
    """
    result = pocket_force(cage, mass, approach, 1.0, -speed)
    return result.elastic, result.normal


@pytest.mark.parametrize(
    ("restitution", "elastic_share"), [(0.2, 0.822), (0.5, 0.957), (0.8, 0.995)]
)
def test_the_normal_force_of_friction_has_the_whole_impulse_of_an_impact(
    scene, restitution, elastic_share
):
    """A ball hits its pocket at a right angle; its impulse is (1 + e) times the momentum.

    Friction goes with the normal force of spring and damping, which has this impulse. The spring
    alone has `elastic_share` of it, a regression value of this integration. As the bodies part,
    damping takes the force of the spring at most, because a pocket does not pull.
    """
    bearing = started(scene, {"cage.restitution": restitution}).bearing
    cage, mass = bearing.cage, bearing.mass[0]
    reduced = mass * cage.mass / (mass + cage.mass)
    speed, dt = 20.0, 1e-10  # so fast that the ramp of the damping does not matter
    approach, closing_speed = 1e-12, speed
    spring_impulse = normal_impulse = 0.0
    while approach > 0.0:
        spring, normal = force_of(cage, mass, approach, closing_speed)
        spring_impulse += spring * dt
        normal_impulse += normal * dt
        closing_speed -= normal / reduced * dt
        approach += closing_speed * dt
    assert -closing_speed / speed == pytest.approx(restitution, abs=1e-3)
    assert normal_impulse == pytest.approx(reduced * speed * (1.0 + restitution), rel=1e-3)
    assert spring_impulse / normal_impulse == pytest.approx(elastic_share, abs=1e-3)


@pytest.mark.parametrize(
    ("changes", "turns", "allowed"),
    [
        ({"operation.radial_load_N": [2.0, 0.0]}, False, 1e-12),
        ({"operation.rotating_load_N": 2.0}, True, 1e-2),  # the centre moves along a chord
    ],
    ids=["radial", "rotating"],
)
def test_a_cage_resting_on_a_displaced_inner_land_is_not_damped(scene, changes, turns, allowed):
    """It only rubs there.

    Under a load fixed in space, the axis of the race and the cage stand still. Under one that
    turns, both go round with the shaft.
    """
    system = started(scene, INNER | changes)
    cage, z, balls = system.bearing.cage, system.cage_state, system.buffers.balls
    assert system.update() == OK
    delta, omega = balls.delta.copy(), system.bearing.op.omega_i
    across = np.array([0.0, -delta[2], delta[1]])
    assert np.hypot(*delta[1:]) > 1e-8
    for angle in np.linspace(0.0, 2.0 * math.pi, 8, endpoint=False):
        n = np.array([0.0, math.cos(angle), math.sin(angle)])
        z[CENTRE : CENTRE + 3] = [z[CENTRE], *delta[1:]] + (cage.gap + 1e-7) * n
        z[VELOCITY : VELOCITY + 3] = omega * across if turns else 0.0
        assert system.update() == OK
        sums = system.buffers.cage.sums
        # friction of both edges, each pressed in by 0.1 um: at least a twentieth of it shows
        friction_heat = cage.mu * 2.0 * cage.k_land * 1e-7 * omega * cage.radius
        assert sums[LAND_HEAT] > 0.05 * friction_heat
        # what both edges would damp at a normal speed of omega delta
        damping = 2.0 * 2.0 * cage.damping_land * math.sqrt(cage.k_land * cage.mass)
        damping *= (omega * np.hypot(*delta[1:])) ** 2
        assert abs(sums[LAND_DAMPING]) < allowed * damping


def turns_to_land(rooms):
    """Returns the turns after which a cage would meet its land; infinity for never.

    rooms: between cage and land in each turn so far, as a share of the clearance.
    """
    trend = Trend()
    for room in rooms:  # the last of the values of a turn; the others do not matter
        trend.add(np.r_[np.ones(trend.values.shape[1] - 1), room])
    return trend.turns_to_land()


TURNS = np.arange(40)
NOISE = 0.01 * np.sin(7.0 * TURNS)


def test_turns_until_a_drifting_cage_meets_its_land():
    """At the last turn 0.51 are left, and 0.01 go with each."""
    turns = turns_to_land(0.9 - 0.01 * TURNS + NOISE)
    assert turns == pytest.approx((0.9 - 0.39) / 0.01, rel=0.02)


def test_noise_is_no_drift_to_the_land():
    assert turns_to_land(0.5 + NOISE) > 1000.0


@pytest.mark.parametrize(
    "rooms",
    [
        pytest.param(0.3 + 0.01 * TURNS, id="drifts away"),
        pytest.param(0.01 - 1e-3 * NOISE, id="rides on its land"),
        pytest.param([1.0, 0.9], id="too few turns"),
    ],
)
def test_a_cage_that_does_not_drift_to_its_land_never_meets_it(rooms):
    assert turns_to_land(rooms) == math.inf


def test_a_drift_to_the_land_is_not_settled(scene):
    """A weightless cage with little friction leans ever further, so that all turns are run.

    It orbits at the balls' rate and has not met its land by then, but would.
    """
    changes = {
        "friction.cage": 0.02,
        "model.simulated_turns": 60,
        "model.evaluated_turns": 20,
        "model.settled_drift": 1.0,  # drifts of QV and wear settle at once
    }
    values, attrs = solve_dynamic(scene("gyro_s1", changes))
    assert values["status"] == OK and values["simulated_turns"] == 60
    assert "land" in attrs["settled"] and values["cage_land_wear_rate"] == 0.0
