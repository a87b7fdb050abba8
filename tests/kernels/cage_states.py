"""A bearing whose cage touches three balls and its land, and its contacts written out in NumPy."""

import math

import numpy as np

from bearingwear.kernels.cage_contacts import cage_contacts
from bearingwear.kernels.state import CENTRE, MOMENTUM, OMEGA, PSI, ROTATION, VELOCITY
from bearingwear.model.dynamic import DynamicSystem
from bearingwear.model.start import start_of

GUIDED = {
    "outer": {"cage.guide_clearance_mm": 0.05},
    "inner": {
        "cage.guiding_race": "inner",
        "cage.inner_diameter_mm": 6.2,
        "cage.guide_clearance_mm": 0.05,
    },
}
TOUCHING = 0, 4, 7
DEPTH = 1e-7  # [m]


def touching_system(scene, guiding="outer", changes=None):
    """A system with three balls and one edge of the land in contact with a tilted, moving cage.

    The contacts are those of the places now; the balls' equilibrium does not know of them.
    """
    keys = {"friction.cage": 0.3, "operation.rotating_load_N": 1.0} | GUIDED[guiding]
    s = scene("gyro_s1", keys | (changes or {}))
    system = DynamicSystem.of(s, start_of(s).u)
    system.update()
    z, cage = system.cage_state, system.bearing.cage
    z[CENTRE : CENTRE + 3] = 2e-6, 0.3e-6, -cage.gap
    z[ROTATION : ROTATION + 3] = 0.0, 2e-4, -1e-4
    z[VELOCITY : VELOCITY + 3] = 0.01, -0.02, -0.03
    z[MOMENTUM + 1 : MOMENTUM + 3] += 1e-3 * z[MOMENTUM]
    for j in TOUCHING:
        for _ in range(6):  # down to DEPTH, ahead in the pocket
            slope = 1e-9
            before = approach(system, j)
            system.balls[j, PSI] += slope
            rate = (approach(system, j) - before) / slope
            system.balls[j, PSI] += (DEPTH - before) / rate - slope
    contacts(system)
    normal = system.buffers.cage.normal
    assert [j for j in range(9) if normal[j] > 0.0] == list(TOUCHING) and normal[9:].max() > 0.0
    return system


def contacts(system):
    """Find the cage's contacts anew; returns their buffers."""
    buf = system.buffers
    cage_contacts(system.y, system.bearing, buf.balls, buf.cage)
    return buf.cage


def approach(system, j):
    """Interference of pocket j [m], without its threshold."""
    return contacts(system).approach[j]


def axes(psi):
    """Azimuth axes of a ball as columns: x, along the orbit's y, radial z."""
    s, c = math.sin(psi), math.cos(psi)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def force_on_ball(system, j):
    """Force of its pocket on ball j in inertial axes [N]."""
    return axes(system.balls[j, PSI]) @ contacts(system).ball_force[j]


def ball_point(system, j):
    """Velocity and displacement (3, 5) of ball j at its contact point, by its states."""
    T, reach = axes(system.balls[j, PSI]), system.buffers.cage.reach[j]
    r = system.buffers.balls.r[j]
    velocity, place = np.zeros((3, 5)), np.zeros((3, 5))
    for i in range(3):
        velocity[:, i] = np.cross(T[:, i], reach)
    velocity[:, OMEGA] = -r * T[:, 1]
    place[:, PSI] = -r * T[:, 1]
    return velocity, place


def cage_point(system, k):
    """Velocity and displacement (3, 12) of the cage at contact k, by its states."""
    cage, R, arm = system.bearing.cage, system.buffers.cage.R, system.buffers.cage.arm[k]
    inverse = np.linalg.inv(R @ np.diag([cage.I_x, cage.I_t, cage.I_t]) @ R.T)
    velocity, place = np.zeros((3, 12)), np.zeros((3, 12))
    for i, e in enumerate(np.eye(3)):
        velocity[:, VELOCITY + i] = e
        velocity[:, MOMENTUM + i] = np.cross(inverse @ e, arm)
        place[:, CENTRE + i] = e
        place[:, ROTATION + i] = np.cross(e, arm)
    return velocity, place
