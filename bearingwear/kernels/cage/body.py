"""The cage as a rigid body of six degrees of freedom (theory.md section 10).

State (12 numbers): centre of mass and its velocity, rotation vector since the orientation `R0` that
was fixed at the start of the step, and angular momentum about the centre of mass; all in the
inertial frame. The rotation vector is reset to zero at each step, so it has no singularity and no
length to preserve. A free cage without weight keeps its momentum to the last digit.
"""

import math
from typing import NamedTuple

from bearingwear.kernels.decorators import jit
from bearingwear.kernels.layout import MOMENTUM, ROTATION, VELOCITY
from bearingwear.kernels.vectors import cross, dot, times, triple

NO_LAND, OUTER_LAND, INNER_LAND = 0, 1, 2


class CageModel(NamedTuple):
    """Geometry, inertia and contact laws of a cage; no cage if `present` is False."""

    present: bool
    mass: float  # [kg]
    gravity: tuple[float, float, float]  # inertial axes [m/s2]
    imbalance: float  # of the centre of mass from the centre, towards the first pocket [m]
    I_x: float  # moment of inertia about its axis [kg m2]
    I_t: float  # and across it
    clearance: float  # radial pocket clearance of the unworn ball [m]
    K_pocket: float  # Hertz factor of ball and pocket [N/m^1.5]
    land: int  # NO_LAND, OUTER_LAND or INNER_LAND
    radius: float  # of the cage's guiding surface [m]
    gap: float  # radial clearance at the land [m]
    half_width: float  # [m]
    k_land: float  # stiffness of one edge [N/m]
    mu: float  # Coulomb coefficient at pockets and land [1]
    v_r: float  # its slip regularisation [m/s]
    damping_pocket: float  # of damping sqrt(m* K) d^(1/4) times the speed along the orbit [1]
    damping_land: float  # critical-damping ratio of the land [1]
    # Interference over which the damping comes in [m]: without it a land's force would jump, and
    # the fourth root of the pocket's law would make rounding of a ball's place a force.
    ramp_pocket: float
    ramp_land: float
    # Displacement (Y, Z) at t = 0 of the race that guides the cage, the part that turns with the
    # shaft [m]: it alone has a velocity.
    turning: tuple[float, float]


@jit
def turn(theta, R0, R):
    """R = exp(theta) R0, by Rodrigues' formula."""
    x = triple(theta, 0)
    angle2 = dot(x, x)
    if angle2 > 1e-12:
        angle = math.sqrt(angle2)
        s, c = math.sin(angle) / angle, (1.0 - math.cos(angle)) / angle2
    else:
        s, c = 1.0 - angle2 / 6.0, 0.5 - angle2 / 24.0
    for k in range(3):
        a = (R0[0, k], R0[1, k], R0[2, k])
        once = cross(x, a)
        twice = cross(x, once)
        R[0, k] = a[0] + s * once[0] + c * twice[0]
        R[1, k] = a[1] + s * once[1] + c * twice[1]
        R[2, k] = a[2] + s * once[2] + c * twice[2]


@jit
def imbalance_vector(cage, R):
    """Centre of mass from the cage's centre, in inertial axes [m]."""
    return times(cage.imbalance, (R[0, 2], R[1, 2], R[2, 2]))


@jit
def axial_momentum(z, R):
    """Angular momentum of the cage along its own axis [kg m2/s]."""
    return R[0, 0] * z[MOMENTUM] + R[1, 0] * z[MOMENTUM + 1] + R[2, 0] * z[MOMENTUM + 2]


@jit
def angular_velocity(cage, z, R):
    """Angular velocity (3) of the cage in inertial axes, from its angular momentum [rad/s]."""
    back = axial_momentum(z, R) * (1.0 / cage.I_x - 1.0 / cage.I_t)
    return (
        z[MOMENTUM] / cage.I_t + back * R[0, 0],
        z[MOMENTUM + 1] / cage.I_t + back * R[1, 0],
        z[MOMENTUM + 2] / cage.I_t + back * R[2, 0],
    )


@jit
def inverse_inertia(cage, R, i, j):
    """Element of the inverse inertia in inertial axes [1/(kg m2)]."""
    value = (1.0 / cage.I_x - 1.0 / cage.I_t) * R[i, 0] * R[j, 0]
    return value + 1.0 / cage.I_t if i == j else value


@jit
def cage_rates(cage, z, force, R, dz):
    """Time derivative of the cage's state under force and moment (6,), into dz."""
    theta = triple(z, ROTATION)
    w = angular_velocity(cage, z, R)
    for k in range(3):
        dz[k] = z[VELOCITY + k]
        dz[VELOCITY + k] = force[k] / cage.mass + cage.gravity[k]
        dz[MOMENTUM + k] = force[3 + k]
    # theta' = omega - theta x omega / 2 + theta x (theta x omega) / 12, next term of order 4.
    once = cross(theta, w)
    twice = cross(theta, once)
    for k in range(3):
        dz[ROTATION + k] = w[k] - 0.5 * once[k] + twice[k] / 12.0


@jit
def cage_energy(cage, z, R):
    """Kinetic energy of the cage [J]."""
    w = angular_velocity(cage, z, R)
    v = triple(z, VELOCITY)
    L = triple(z, MOMENTUM)
    return 0.5 * (
        cage.mass * (v[0] ** 2 + v[1] ** 2 + v[2] ** 2) + w[0] * L[0] + w[1] * L[1] + w[2] * L[2]
    )
