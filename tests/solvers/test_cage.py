"""The cage: what it conserves, what it gives back, and what it does to the rest."""

import dataclasses
import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from bearingwear.kernels.cage.body import angular_velocity, turn
from bearingwear.kernels.dynamic.integrators import ROSENBROCK, RUNGE_KUTTA
from bearingwear.kernels.status import OK
from bearingwear.solvers.dynamic.parts import land_damping, pocket_damping
from bearingwear.solvers.dynamic.run import solve_dynamic
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.solve import solve
from bearingwear.solvers.start import start_of

ROTATING = {"operation.rotating_load_N": 1.0}
HEAVY = {"operation.gravity_m_s2": [20.0, 30.0, -300.0], "cage.imbalance_um": 5.0}


def started(scene):
    """Returns the motion of a scene as a solve begins it."""
    return DynamicSystem.of(scene, start_of(scene).u)


def energy_change(motion, duration, *options):
    """Runs a motion on for a duration [s], and returns the changes of its energies [J] by name.

    `missing` is what was supplied less all other changes. `all heat` is the friction heat of races
    and cage and the loss in damping. options: tolerance and method of `advance`.
    """
    before = motion.energy()
    assert motion.advance(duration, *options).status == OK
    change = {name: value - before[name] for name, value in motion.energy().items()}
    # twice, because the sum has what was supplied, too
    change["missing"] = 2.0 * change["supplied"] - sum(change.values())
    change["all heat"] = change["heat"] + change["cage heat"] + change["damping"]
    return change


@pytest.mark.parametrize(
    "changes",
    [
        ROTATING,
        {"operation.radial_load_N": [0.0, 3.0], "operation.preload_method": "fixed_position"},
        {"cage.guiding_race": "inner", "cage.inner_diameter_mm": 6.2} | ROTATING,
        {"wear.ball_diameter_loss_um": [0.0, 0.1, 0.0, 0.2, 0.0, 0.0, 0.05, 0.0, 0.0]},
        {"operation.outer_speed_rpm": -10000, "lubricant.drag_density_kg_m3": 100.0},
        HEAVY,
    ],
)
def test_energy_account(scene, changes):
    """Shaft and loads supply what contacts, drag and damping take, to 1e-4 of the heat."""
    motion = started(scene("gyro_s1", changes))
    change = energy_change(motion, 8 * motion.turn)
    assert change["cage heat"] > 1e-4 * change["heat"]  # the cage did touch something
    assert abs(change["missing"]) < 1e-4 * change["all heat"], change


@pytest.mark.parametrize("method", [ROSENBROCK, RUNGE_KUTTA])
def test_free_cage_keeps_its_momentum(scene, method):
    """A tumbling cage that touches nothing keeps both momenta to 1e-9 and precesses freely.

    Its state z has its place (0:3), velocity (3:6) and angular momentum (9:12).
    """
    s = scene("gyro_s1", {"cage.pocket_clearance_mm": 0.5, "cage.guide_clearance_mm": 1.0})
    motion = started(s)
    z = motion.cage_state
    z[1:3] = 0.0
    z[9] = motion.bearing.cage.I_x * motion.balls[:, 3].mean()
    z[10] = 0.01 * z[9]  # out of its axis: it precesses
    z[3:6] = 1e-4, -2e-4, 3e-4
    momentum, linear = z[9:12].copy(), z[3:6].copy()
    cage = motion.bearing.cage
    tilts = []
    # Runge-Kutta takes far more steps: two turns are enough of it
    for _ in range(20 if method == ROSENBROCK else 2):
        assert motion.advance(motion.turn, 1e-5, method).status == OK
        R = motion.buffers.cage.R0
        tilts.append(math.acos(R[0, 0]))
    assert not motion.buffers.cage.normal.any()
    assert_allclose(z[9:12], momentum, rtol=1e-9)
    assert_allclose(z[3:6], linear, rtol=1e-9)
    assert_allclose(R.T @ R, np.eye(3), atol=1e-12)
    # Free precession of a symmetric top: its axis goes round the momentum at L / I_t.
    size = np.linalg.norm(momentum)
    rate = size / cage.I_t
    half = math.atan2(momentum[1], momentum[0])  # of the axis from the momentum, at the start
    angle = rate * motion.time
    axis = momentum / size
    start = np.array([1.0, 0.0, 0.0])
    exact = (
        start * math.cos(angle)
        + np.cross(axis, start) * math.sin(angle)
        + axis * (axis @ start) * (1.0 - math.cos(angle))
    )
    assert max(tilts) > half  # it has gone around
    assert_allclose(R[:, 0], exact, atol=2e-3 * half)  # the steps of 1e-5


def test_rotation_has_no_singularity():
    """Fifty equal steps about a random axis add up to one step of half a turn.

    Half a turn is where formulas of rotation tend to be singular.
    """
    rng, steps = np.random.default_rng(4), 50
    for _ in range(20):
        theta = rng.normal(size=3)
        theta *= math.pi / np.linalg.norm(theta)
        whole, stepped = np.empty((3, 3)), np.eye(3)
        turn(theta, np.eye(3), whole)
        for _ in range(steps):
            new = np.empty((3, 3))
            turn(theta / steps, stepped, new)
            stepped = new
        assert_allclose(stepped, whole, atol=1e-12)


def test_frictionless_undamped_bouncing_gains_nothing(scene):
    """Restitution 1, no friction at the cage: the account shows neither heat nor gain.

    What is missing is far below the cage's kinetic energy at a hundredth of the orbit speed.
    """
    s = scene("gyro_s1", {"cage.restitution": 1.0, "friction.cage": 0.0} | ROTATING)
    motion = started(s)
    tally = motion.advance(motion.turn)
    assert tally.status == OK
    change = energy_change(motion, 20 * motion.turn, 1e-4)
    assert change["cage heat"] == 0.0 and change["damping"] == 0.0
    orbit_speed = abs(motion.balls[0, 3]) * motion.buffers.balls.r[0]
    kinetic = motion.bearing.cage.mass * (1e-2 * orbit_speed) ** 2
    assert abs(change["missing"]) < 1e-5 * change["heat"] and abs(change["missing"]) < kinetic


@pytest.mark.parametrize("restitution", [0.3, 0.6, 0.9])
@pytest.mark.parametrize(("speed", "within"), [(0.02, 0.35), (0.2, 0.05)])
def test_restitution_at_the_land(scene, restitution, speed, within):
    """A cage thrown at the outer land comes back with the restitution times its speed [m/s].

    It moves along Y (z[4]) and turns with the balls. The damping comes in over a range of approach
    that a light impact hardly leaves: hence 35 %.
    """
    changes = {"cage.pocket_clearance_mm": 0.5, "cage.restitution": restitution}
    motion = started(scene("gyro_s1", changes | {"friction.cage": 0.0}))
    z = motion.cage_state
    z[:6] = 0.0
    z[4] = speed
    z[9] = motion.bearing.cage.I_x * motion.balls[:, 3].mean()
    assert motion.advance(1.2 * motion.bearing.cage.gap / speed, 1e-4).status == OK
    assert motion.buffers.cage.normal[-2:].max() == 0.0
    assert -z[4] / speed == pytest.approx(restitution, rel=within)


def rebound(damping, spring_power, damping_power):
    """Returns the speed after an impact at speed 1, by small explicit steps.

    Mass and stiffness are 1: at an approach x the force is x^spring_power + damping
    x^damping_power dx/dt.
    """
    approach, speed, h = 1e-12, 1.0, 1e-5
    while approach > 0.0:
        force = approach**spring_power + damping * approach**damping_power * speed
        if force < 0.0:  # bodies part before they pull
            break
        speed -= h * force
        approach += h * speed
    return -speed


@pytest.mark.parametrize("restitution", [0.2, 0.5, 0.9, 1.0])
def test_damping_of_land_and_pocket_gives_their_restitution(restitution):
    """The land has a linear spring and dashpot, the pocket Hertz' law and its damping."""
    of_land = rebound(2.0 * land_damping(restitution), 1.0, 0.0)
    of_pocket = rebound(pocket_damping(restitution), 1.5, 0.25)
    assert [of_land, of_pocket] == pytest.approx([restitution] * 2, abs=2e-3)


PRECISE = {"model.dynamic_tolerance": 1e-4, "model.simulated_turns": 6}


@pytest.mark.parametrize("changes", [ROTATING, HEAVY])
def test_torques_are_the_rate_of_momentum(scene, changes):
    """The mean torques on the cage add up to the mean rate of its angular momentum.

    Only the heavy cage, which has an imbalance, feels a torque of gravity.
    """
    values, _ = solve_dynamic(scene("gyro_s1", PRECISE | changes))
    torque = values["mean_pocket_torque"] + values["mean_land_torque"]
    torque = torque + values["mean_gravity_torque"]
    assert values["status"] == OK
    assert bool(values["mean_gravity_torque"]) == (changes is HEAVY)
    # pushes to and fro cancel in the mean: their torque at the pitch radius is the scale
    force = values["history_pocket_force"].mean(axis=0).sum()
    scale = force * 0.5 * 7.5e-3
    assert abs(torque - values["cage_momentum_rate"]) < 1e-4 * scale
    assert abs(torque) > 1e-3 * scale


def test_pockets_pull_and_push_balls(scene):
    """What the balls gain in angular momentum about the axis, the cage loses.

    Without friction at the races and without drag, they exchange it through the pockets alone.
    """
    motion = started(scene("gyro_s1", {"friction.ball_race": 0.0, "cage.guiding_race": "ball"}))
    assert motion.bearing.cage.present

    def momentum_of_balls():
        motion.rates()
        spin = (motion.bearing.inertia * motion.balls[:, 0]).sum()
        orbit = (motion.bearing.mass * motion.buffers.balls.r**2 * motion.balls[:, 3]).sum()
        return spin + orbit

    balls_before, cage_before = momentum_of_balls(), motion.cage_momentum()
    assert motion.advance(5 * motion.turn, 1e-4).status == OK
    of_balls = momentum_of_balls() - balls_before
    of_cage = motion.cage_momentum() - cage_before
    assert abs(of_cage) > 1e-5 * cage_before  # they did exchange some
    # the model leaves the Coriolis force out: a ball that shifts radially takes none of it along
    assert_allclose(of_balls, -of_cage, rtol=2e-2)


def test_wear_of_an_impact_does_not_depend_on_stiffness(scene):
    """A cage thrown against its land rubs off the same with half the stiffness, to 1 %.

    Over many turns the cage's own wear cannot be compared so closely: its path is chaotic.
    """
    worn = []
    for factor in (1.0, 0.5):
        changes = {"cage.pocket_clearance_mm": 0.5, "model.land_stiffness_factor": factor}
        motion = started(scene("gyro_s1", changes))
        z = motion.cage_state
        z[:6] = 0.0
        z[4] = 0.2
        z[9] = motion.bearing.cage.I_x * motion.balls[:, 3].mean()
        assert motion.advance(1.2 * motion.bearing.cage.gap / z[4], 1e-4).status == OK
        assert motion.buffers.cage.normal[-2:].max() == 0.0 and z[4] < 0.0
        worn.append(motion.y[motion.layout.land])
    assert worn[1] == pytest.approx(worn[0], rel=1e-2) and worn[0] > 0.0


def test_a_run_taken_up_again_ends_as_one_that_was_not_stopped(scene):
    """States and histories have the same bits; averages agree to rounding."""
    # a cage that bounces so much never settles: the whole length is run
    changes = {"model.evaluated_turns": 1, "cage.restitution": 0.9} | ROTATING

    def run(turns, restart=None):
        cage_scene = scene("gyro_s1", changes | {"model.simulated_turns": turns})
        return solve_dynamic(cage_scene, restart)[0]

    first, whole = run(1), run(2)
    assert whole["simulated_turns"] == 2
    second = run(1, {"state": first["final_state"], "time": first["final_time"]})
    assert second["final_time"] == whole["final_time"]
    assert (second["final_state"] == whole["final_state"]).all()
    for name in ("qv", "ball_angular_velocity", "cage_wear_rate", "mean_pocket_torque"):
        assert_allclose(second[name], whole[name], rtol=1e-12, atol=1e-30, err_msg=name)
    points_of_the_first_turn = 20  # as the scene records them
    for name in ("history_contact_qv", "history_cage_position", "history_orbit_lead"):
        assert (second[name] == whole[name][points_of_the_first_turn:]).all(), name


def test_averages_are_those_of_the_steady_state(scene):
    """They are so under thrust alone and without a cage."""
    s = dataclasses.replace(scene("gyro_s1", {"friction.ball_race": 0.05}), cage=None)
    values, _ = solve_dynamic(s)
    steady = solve(s, "steady").values
    assert values["status"] == OK
    for name in (
        "contact_load", "contact_angle", "qv", "friction_heat", "gyroscopic_slip", "rolling_slip",
        "ball_angular_velocity", "orbit_speed", "total_qv", "residual_preload", "shaft_torque",
        "axial_stiffness", "axial_displacement", "ball_wear_rate", "race_wear_rate",
        "gyroscopic_slip_share", "ball_diameter_loss_rate",
    ):  # fmt: skip
        of_one_ball = np.asarray(steady[name])
        of_all_balls = np.asarray(values[name])
        near_zero = 1e-9 * np.abs(of_one_ball).max()
        expected = np.broadcast_to(of_one_ball, of_all_balls.shape)
        assert_allclose(of_all_balls, expected, rtol=2e-6, atol=near_zero, err_msg=name)


def test_angular_velocity_of_a_tilted_top(scene):
    """It follows from the momentum by the inertia tensor in inertial axes."""
    motion = started(scene("gyro_s1", {}))
    cage, z = motion.bearing.cage, motion.cage_state
    R = np.empty((3, 3))
    turn(np.array([0.3, -0.2, 0.1]), np.eye(3), R)
    inertia = R @ np.diag([cage.I_x, cage.I_t, cage.I_t]) @ R.T
    z[9:12] = inertia @ [1.0, 2.0, 3.0]
    assert_allclose(angular_velocity(cage, z, R), [1.0, 2.0, 3.0], rtol=1e-12)
