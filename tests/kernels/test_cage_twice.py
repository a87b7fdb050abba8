"""A cage's forces and powers against two programs written from theory.md alone.

`cage_states.json` holds states of five scenes and the numbers of the first program. Its laws were
earlier ones: friction of a pocket left out its damping, and the land of an inner race moved with
its displacement. `plain_cage.py` is the second: it has both laws, `STORED` and `TODAY`.
"""

import functools
import json
from pathlib import Path

import numpy as np
import pytest
from kernels.plain_cage import STORED, TODAY, rotation, solve
from numpy.testing import assert_allclose

from bearingwear.kernels.cage.law import (
    LAND_DAMPING,
    LAND_HEAT,
    LAND_TORQUE,
    POCKET_DAMPING,
    POCKET_HEAT,
    POCKET_TORQUE,
)
from bearingwear.kernels.layout import CENTRE, MOMENTUM, PSI, VELOCITY
from bearingwear.kernels.status import OK
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.start import start_of

STATES = json.loads(Path(__file__).with_suffix("").with_name("cage_states.json").read_text())
# scenes with their first and their last state
CASES = [(name, k) for name, states in STATES["states"].items() for k in (0, len(states) - 1)]
BALLS, POSE = 45, 58  # numbers of the balls; of balls and cage, with a quaternion


def assert_close(actual, expected, name):
    """Asserts that numbers agree to 1e-8 of the largest of them."""
    expected = np.asarray(expected, float)
    assert_allclose(actual, expected, rtol=0, atol=1e-8 * np.abs(expected).max(), err_msg=name)


@pytest.fixture(scope="module")
def systems(scene):
    """Returns a function that makes the system of a scene of `STATES`, with an imbalance [um]."""

    @functools.cache
    def system_of(name, imbalance):
        changes = dict(STATES["scenes"][name])
        time = changes.pop("time_s", 0.0)
        changes |= {"friction.slip_regularisation_m_s": 1e-2, "cage.imbalance_um": imbalance}
        s = scene("gyro_s1", changes)
        system = DynamicSystem.of(s, start_of(s).u)
        system.time = time
        return system

    return system_of


def set_state(system, y):
    """Sets a system to a stored state, and returns the arguments of `plain_cage.solve` but `laws`.

    y: balls, centre and velocity of the cage, quaternion, angular momentum. Moves the stored centre
    to the centre of mass, which an imbalance shifts.
    """
    R, cage = rotation(y[BALLS + 6 : BALLS + 10]), np.r_[y[BALLS : BALLS + 6], y[POSE - 3 : POSE]]
    bearing, buf = system.bearing, system.buffers
    system.y[:] = 0.0
    system.y[:BALLS] = y[:BALLS]
    z = system.cage_state
    z[CENTRE : CENTRE + 3] = cage[:3] = cage[:3] + bearing.cage.imbalance * R[:, 2]
    z[VELOCITY : VELOCITY + 3], z[MOMENTUM : MOMENTUM + 3] = cage[3:6], cage[6:]
    buf.cage.R0[:] = R
    assert system.update() == OK
    return bearing, system.balls, cage, R, buf.balls.F, buf.balls.X, buf.balls.delta


@pytest.mark.parametrize(("name", "k"), CASES)
def test_the_plain_program_with_the_earlier_laws_gives_the_stored_numbers(systems, name, k):
    """They agree to 1e-8 of the largest number of each kind."""
    stored = STATES["states"][name][k]
    rates = np.array(stored["dy"])
    contacts, delta = solve(*set_state(systems(name, 0.0), np.array(stored["y"])), STORED)
    # After QV: a power for each pocket, the land, heat of both, damping, torque of both.
    pockets = rates[POSE + 18 : POSE + 27]
    land, *sums = rates[POSE + 27 :]
    assert_close(contacts.force, stored["f"], "force")
    assert_close(contacts.moment, stored["t_cage"], "moment")
    assert_close(delta, stored["delta"], "displacement")
    assert_close(contacts.pocket_power, pockets, "pockets")
    assert_close(contacts.land_power, land, "land")
    assert_close([*contacts.heat, contacts.damping], sums[:3], "heat and damping")
    assert_close(contacts.torque, sums[3:], "torque")


@pytest.mark.parametrize(("name", "k"), CASES)
def test_the_kernels_agree_with_the_plain_program(systems, name, k):
    """With the laws of today, to 1e-8 of the largest number of each kind.

    In the last states the cage has an imbalance of 5 um.
    """
    system = systems(name, 5.0 if k else 0.0)
    expected, delta = solve(*set_state(system, np.array(STATES["states"][name][k]["y"])), TODAY)
    contacts, sums = system.buffers.cage, system.buffers.cage.sums
    assert_close(contacts.force[:3], expected.force, "force")
    assert_close(contacts.force[3:], expected.moment, "moment")
    assert_close(system.buffers.balls.delta, delta, "displacement")
    assert_close(contacts.ball_moment, expected.turning_balls, "moments on balls")
    psi = system.balls[:, PSI]
    in_azimuth_axes = contacts.ball_force
    inertial = (
        in_azimuth_axes[:, 0],
        in_azimuth_axes[:, 1] * np.cos(psi) - in_azimuth_axes[:, 2] * np.sin(psi),
        in_azimuth_axes[:, 1] * np.sin(psi) + in_azimuth_axes[:, 2] * np.cos(psi),
    )
    assert_close(np.transpose(inertial), expected.on_balls, "forces on balls")
    assert_close(contacts.power[:9], expected.pocket_power, "pockets")
    assert_close(contacts.power[9:].sum(), expected.land_power, "land")
    damping = sums[POCKET_DAMPING] + sums[LAND_DAMPING]
    heat = [sums[POCKET_HEAT], sums[LAND_HEAT], damping]
    assert_close(heat, [*expected.heat, expected.damping], "heat and damping")
    assert_close(sums[[POCKET_TORQUE, LAND_TORQUE]], expected.torque, "torque")


@pytest.mark.parametrize("name", STATES["paths_from_start"])
def test_the_first_impacts_follow_the_stored_paths(scene, name):
    """The cage's centre is within 10 nm after half a turn, and 100 nm later on.

    The work in the pockets is 0.5 to 1.5 % more than stored, as damping now adds to the friction.
    """
    changes = {"friction.slip_regularisation_m_s": 1e-2} | STATES["scenes"][name]
    s = scene("gyro_s1", changes)
    system = DynamicSystem.of(s, start_of(s).u)
    for stored in STATES["paths_from_start"][name][:3]:
        assert system.advance(stored["turn"] * system.turn - system.time, 1e-5).status == OK
        apart = np.abs(system.cage_state[CENTRE : CENTRE + 3] - stored["c"]).max()
        assert apart < (1e-8 if stored["turn"] == 0.5 else 1e-7)
        pockets = system.y[system.layout.pockets : system.layout.land]
        assert 1.005 < pockets.sum() / np.sum(stored["pocket"]) < 1.015
