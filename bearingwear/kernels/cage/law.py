"""Law of the cage's contacts, and what forces, outputs and the Jacobian take from them.

Contacts are described by what they do to the relative motion of two points: a force, and its
derivatives K by displacement and C by velocity. The same assembly then serves pockets and land.
Contacts 0 to n - 1 are the pockets, n and n + 1 the two edges of the land.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.decorators import jit
from bearingwear.kernels.vectors import dot, times

# Columns of CageBuffers.sums.
(
    POCKET_HEAT,
    POCKET_DAMPING,
    LAND_HEAT,
    LAND_DAMPING,
    LAND_WORK,
    POCKET_TORQUE,
    LAND_TORQUE,
    ELASTIC,
    INNER_TORQUE,
) = range(9)


class CageBuffers(NamedTuple):
    """Results of the cage's contacts for forces, outputs and the Jacobian."""

    R0: np.ndarray  # (3, 3) orientation at the start of the step
    R: np.ndarray  # (3, 3) orientation now
    force: np.ndarray  # (6,) force and moment about its centre on the cage [N, N m]
    ball_force: np.ndarray  # (n, 3) on the ball: axial, along y, radially outward [N]
    ball_moment: np.ndarray  # (n, 3) on the ball in its azimuth frame [N m]
    approach: np.ndarray  # (n + 2,) interference; < 0: open [m]
    normal: np.ndarray  # (n + 2,) normal forces, elastic and of damping: what rubs [N]
    power: np.ndarray  # (n + 2,) normal force times slip, for wear [W]
    race_velocity: np.ndarray  # (2,) of the inner race along Y, Z [m/s]
    race_force: np.ndarray  # (2,) of the land on the inner race along Y, Z [N]
    sums: np.ndarray  # (9,) powers [W], torques about the bearing axis [N m], elastic energy [J]
    K: np.ndarray  # (n + 2, 3, 3) derivative of the contact force by displacement [N/m]
    C: np.ndarray  # (n + 2, 3, 3) and by velocity [N s/m]
    heat: np.ndarray  # (n + 2, 6) derivative of friction heat by velocity and displacement
    loss: np.ndarray  # (n + 2, 6) and of the power lost to damping
    arm: np.ndarray  # (n + 2, 3) contact point from the cage's centre of mass [m]
    hold: np.ndarray  # (n + 2, 3) and the point whose displacement K is by: ball centre, edge [m]
    reach: np.ndarray  # (n, 3) contact point from the ball's centre, inertial [m]
    pockets: np.ndarray  # (n, 2) sine and cosine of their azimuths in the cage


def cage_buffers(n):
    """Buffers for n pockets."""
    pockets = np.zeros((n, 2))
    for j in range(n):
        phi = 2.0 * math.pi * j / n
        pockets[j, 0], pockets[j, 1] = math.sin(phi), math.cos(phi)
    return CageBuffers(
        R0=np.eye(3),
        R=np.eye(3),
        force=np.zeros(6),
        ball_force=np.zeros((n, 3)),
        ball_moment=np.zeros((n, 3)),
        approach=np.full(n + 2, -1.0),
        normal=np.zeros(n + 2),
        power=np.zeros(n + 2),
        race_velocity=np.zeros(2),
        race_force=np.zeros(2),
        sums=np.zeros(9),
        K=np.zeros((n + 2, 3, 3)),
        C=np.zeros((n + 2, 3, 3)),
        heat=np.zeros((n + 2, 6)),
        loss=np.zeros((n + 2, 6)),
        arm=np.zeros((n + 2, 3)),
        hold=np.zeros((n + 2, 3)),
        reach=np.zeros((n, 3)),
        pockets=pockets,
    )


class CageContact(NamedTuple):
    """A closed contact of the cage: what determines its force and derivatives."""

    n: tuple[float, float, float]  # unit normal
    slip: tuple[float, float, float]  # of the partner against the body, tangential [m/s]
    closing: float  # approach speed [m/s]
    F: float  # normal force [N]
    stiffness: float  # its derivative by approach [N/m]
    damping: float  # and by approach speed [N s/m]
    change: float  # derivative of the damping by approach [N s/m2]


@jit(forceinline=True)
def contact_law(contact, mu, v_r, K, C):
    """Friction at a contact and the derivatives of its whole force.

    Parameters
    ----------
    K, C : ndarray (3, 3)
        Filled.

    Returns
    -------
    friction : tuple of 3 floats
        On the body [N].
    speed : float
        Of the slip [m/s].
    """
    n, slip = contact.n, contact.slip
    speed = math.sqrt(dot(slip, slip))
    W = math.sqrt(speed * speed + v_r * v_r)
    t = mu * contact.F / W
    s = (slip[0] / W, slip[1] / W, slip[2] / W)
    for i in range(3):
        for j in range(3):
            nn = n[i] * n[j]
            pushed = nn - mu * s[i] * n[j]  # the normal force and the friction it brings
            K[i, j] = contact.stiffness * pushed
            C[i, j] = contact.damping * pushed + t * ((1.0 if i == j else 0.0) - nn - s[i] * s[j])
    return times(t, slip), speed


@jit(forceinline=True)
def power_slopes(contact, mu, v_r, heat, loss):
    """Derivatives of a contact's friction heat and damping power by the relative motion.

    Parameters
    ----------
    heat, loss : ndarray (6,)
        Filled: by velocity, by displacement.
    """
    n, s = contact.n, contact.slip
    slip2 = dot(s, s)
    W = math.sqrt(slip2 + v_r * v_r)
    by_slip = mu * contact.F * (2.0 - slip2 / (W * W)) / W  # over the slip itself
    by_force = mu * slip2 / W
    for i in range(3):
        heat[i] = by_slip * s[i] - by_force * contact.damping * n[i]
        heat[3 + i] = -by_force * contact.stiffness * n[i]
        loss[i] = -2.0 * contact.damping * contact.closing * n[i]
        loss[3 + i] = -contact.change * contact.closing * contact.closing * n[i]
