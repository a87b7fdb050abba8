"""A bearing whose cage touches three balls and its land."""

import math

import numpy as np
from support import in_python

from bearingwear.kernels.cage.contacts import cage_contacts
from bearingwear.kernels.dynamic.quasistatic import find_contacts
from bearingwear.kernels.layout import CENTRE, MOMENTUM, PSI, ROTATION, VELOCITY
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.start import start_of

find_contacts = in_python(find_contacts)

GUIDED = {
    "outer": {"cage.guide_clearance_mm": 0.05},
    "inner": {
        "cage.guiding_race": "inner",
        "cage.inner_diameter_mm": 6.2,
        "cage.guide_clearance_mm": 0.05,
    },
}
TOUCHING = 0, 4, 7  # balls in contact with their pockets
DEPTH = 1e-7  # interference of these contacts [m]


def touching_system(scene, guiding="outer", changes=None):
    """Returns a system with three balls and one edge of the land touching a tilted, moving cage.

    The balls are in equilibrium without the forces of these contacts. changes: to the scene, by
    dotted keys.
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
        for _ in range(6):  # Newton's steps ahead in the pocket, to DEPTH
            slope = 1e-9
            interference = approach(system, j)
            system.balls[j, PSI] += slope
            rate = (approach(system, j) - interference) / slope
            system.balls[j, PSI] += (DEPTH - interference) / rate - slope
    contacts(system)
    normal = system.buffers.cage.normal
    assert [j for j in range(9) if normal[j] > 0.0] == list(TOUCHING) and normal[9:].max() > 0.0
    return system


def contacts(system):
    """Updates the contacts of the cage for the present state, and returns their buffers."""
    buf = system.buffers
    find_contacts(system.y, system.bearing, buf.balls)
    cage_contacts(system.y, system.bearing, buf.balls, buf.cage)
    return buf.cage


def approach(system, j):
    """Returns the interference of pocket j [m], which is negative if the pocket is open."""
    return contacts(system).approach[j]


def azimuth_axes(psi):
    """Returns the azimuth axes of a ball as columns: x, y along the orbit, and radial z."""
    s, c = math.sin(psi), math.cos(psi)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def force_on_ball(system, j):
    """Returns the force of its pocket on ball j in inertial axes [N]."""
    return azimuth_axes(system.balls[j, PSI]) @ contacts(system).ball_force[j]
