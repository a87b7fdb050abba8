"""The balls' motion by the dynamic model: where it ends, how fast, and what it does with energy."""

import dataclasses

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from bearingwear.kernels.contact.summary import QV
from bearingwear.kernels.dynamic.integrators import ROSENBROCK, RUNGE_KUTTA
from bearingwear.kernels.equilibrium.race import PACKED, race_equilibrium
from bearingwear.kernels.layout import BALL
from bearingwear.kernels.status import OK
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.dynamic.system import DynamicSystem

HERTZ = {"model.contact": "hertz"}  # with traction in the balance of normal forces
WHATEVER_THE_ERROR = 1e12  # tolerance of steps that are as long as they are allowed to be
METHODS = {"rosenbrock": ROSENBROCK, "runge_kutta": RUNGE_KUTTA}


def steady(scene):
    """Returns the problem and the steady state of a scene under its thrust alone."""
    o = scene.operation
    thrust = dataclasses.replace(o, radial_load_N=(0.0, 0.0), rotating_load_N=0.0, tilt_mrad=0.0)
    problem = ThrustProblem.of(dataclasses.replace(scene, operation=thrust))
    case = problem.solve(problem.g.D0 - scene.wear.ball_diameter_loss_um[0] * 1e-6)
    assert case.status == OK
    return problem, case


def started(scene):
    """Returns the motion of a scene without its cage, at the steady state of its thrust."""
    scene = dataclasses.replace(scene, cage=None)
    return DynamicSystem.of(scene, steady(scene)[1].u)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"operation.preload_method": "fixed_position", "friction.ball_race": 0.02},
        {"lubricant.drag_density_kg_m3": 250.0, "friction.ball_race": 0.02},
        # With few points, the steady and the dynamic model place theirs differently about those of
        # pure rolling, and their states differ by 3e-4.
        HERTZ | {"model.strips": 48, "model.points_across": 24},
    ],
)
def test_disturbed_balls_return_to_the_steady_state(scene, changes):
    """Balls without a cage come back to the steady motion and its QV, at its slowest rate.

    They are disturbed by 3 % in spin and 50 rad/s in gyroscopic rotation.
    """
    s = scene("gyro_s1", changes)
    problem, case = steady(s)
    decay_rates = np.sort(-problem.decay_rates(problem.g.D0, case).real)  # [1/s]
    slow_time = 1.0 / decay_rates[0]
    disturbed = case.u * [1.03, 1.0, 1.03, 1.0] + [0.0, 50.0, 0.0, 0.0]
    motion = DynamicSystem.of(dataclasses.replace(s, cage=None), disturbed)
    first_ball = []  # after each slow time; 14 leave e^-14, a millionth, of the disturbance
    for _ in range(14):
        assert motion.advance(slow_time, 1e-5).status == OK
        first_ball.append(motion.balls[0, :4].copy())
    assert_allclose(motion.balls[:, :4], np.tile(case.u, (9, 1)), atol=1e-4 * np.abs(case.u).max())

    # at last along the slow eigenvector: a factor e in each of the three slow times from the sixth,
    # when faster motions have gone, to the ninth, well before the end
    distance = np.abs(np.array(first_ball) - first_ball[-1]).max(axis=1)
    assert_allclose(np.log(distance[5] / distance[8]), 3.0, rtol=0.02)

    before = motion.qv.copy()
    motion.advance(motion.turn)
    qv = (motion.qv - before) / motion.turn
    assert_allclose(qv, np.tile(case.contacts[:, QV], (9, 1)), rtol=1e-3)


@pytest.mark.parametrize(
    ("contact", "method", "counts", "lowest", "highest"),
    [
        # of third order
        ("paper", ROSENBROCK, (8, 16, 32, 64), 2.7, 3.3),
        ("hertz", ROSENBROCK, (8, 16, 32, 64), 2.7, 3.3),
        # Fehlberg's fourth-order result has so small a leading error that the fifth order shows
        ("paper", RUNGE_KUTTA, (32, 64, 128), 3.9, 5.1),
    ],
)
def test_order_of_convergence(scene, contact, method, counts, lowest, highest):
    """Fixed steps along a smooth motion (v_r 3e-2 m/s) are compared with a far finer solution."""
    smooth = {"friction.slip_regularisation_m_s": 3e-2, "operation.radial_load_N": [0.0, 2.0]}
    s = scene("gyro_s1", smooth | {"model.contact": contact, "model.quadrature": "strips"})

    def end(method, count, span=1e-4):
        motion = started(s)
        motion.advance(2e-4, 1e-6)  # past the first transient
        motion.h = span / count
        tally = motion.advance(span, WHATEVER_THE_ERROR, method, motion.h)
        assert tally.status == OK and (tally.accepted, tally.rejected) == (count, 0)
        return motion.balls[:, :4].copy()

    exact = end(RUNGE_KUTTA, 4096)
    errors = [np.abs(end(method, count) - exact).max() for count in counts]
    order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert lowest < order < highest, errors


@pytest.mark.parametrize("contact", ["paper", "hertz"])
def test_integrators_agree_with_scipy(scene, contact):
    """A quarter of a turn under radial load, from the same start: QV to their tolerance of 1e-4."""
    s = scene("gyro_s1", {"operation.radial_load_N": [0.0, 2.0], "model.contact": contact})
    qv_by_method = {}
    for name, method in METHODS.items():
        motion = started(s)
        assert motion.advance(0.25 * motion.turn, 1e-4, method).status == OK
        qv_by_method[name] = motion.qv.copy()
    reference = started(s)
    states = BALL * 9

    def rate(time, y):
        reference.time, reference.y[:] = time, y
        assert reference.update() == OK
        return reference.dy.copy()

    # The integrals feed back on nothing: integrating them with the states costs little.
    path = solve_ivp(
        rate, (0.0, 0.25 * reference.turn), reference.y, method="LSODA", rtol=1e-9,
        atol=np.r_[np.full(states, 1e-6), np.full(reference.y.size - states, 1e-13)],
    )  # fmt: skip
    assert path.success
    exact = path.y[reference.layout.qv : reference.layout.pockets, -1].reshape(-1, 2)
    for name, qv in qv_by_method.items():
        assert_allclose(qv, exact, rtol=1e-4, err_msg=name)


@pytest.mark.parametrize(
    "changes",
    [
        {"operation.rotating_load_N": 2.0},
        {"operation.radial_load_N": [1.0, 2.0], "operation.tilt_mrad": 0.2},
        {
            "operation.preload_method": "fixed_position",
            "operation.rotating_load_N": 3.0,
            "lubricant.drag_density_kg_m3": 250.0,
        },
        {"operation.radial_load_N": [0.0, 10.0]},  # balls unload and load again
        HERTZ | {"operation.radial_load_N": [1.0, 2.0], "operation.rotating_load_N": 1.0},
    ],
)
def test_energy_that_shaft_and_loads_supply_is_accounted_for(scene, changes):
    """It equals what the other energies gain over six turns, to 1e-5 of the heat."""
    motion = started(scene("gyro_s1", changes))
    before = motion.energy()
    assert motion.advance(6 * motion.turn, 3e-5).status == OK
    change = {name: value - before[name] for name, value in motion.energy().items()}
    supplied = change.pop("supplied")
    assert abs(supplied - sum(change.values())) < 1e-5 * change["heat"]
    # The two terms that the model's simplifications carry are small, but not nothing.
    assert abs(change["coriolis"]) < 1e-2 * change["heat"]
    assert abs(change["azimuth"]) < 1e-2 * change["heat"]


def test_static_load_distribution_as_speed_goes_to_zero(scene):
    """At 1 r/min the balls have the inner loads of the equilibrium at rest."""
    s = scene("gyro_s1", {"operation.shaft_speed_rpm": 1.0, "operation.radial_load_N": [0.0, 3.0]})
    motion = started(s)
    motion.rates()
    n = 9
    rows, delta = np.empty((n, PACKED)), np.zeros(3)
    psi = motion.balls[:, 4].copy()
    force = np.array([7.0, 0.0, 3.0])  # preload and radial load [N]
    # no loads of the balls' own, no tilt, and a race that moves from direction 0 on: all three
    race_equilibrium(
        motion.bearing.g, motion.bearing.D, np.zeros((n, 6)), psi, force, 0.0, 0, delta, rows
    )
    inner_load = rows[:, 5]  # of a packed state
    assert_allclose(motion.buffers.balls.Q[:, 0], inner_load, rtol=1e-6)
