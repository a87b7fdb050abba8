"""What is constant while a bearing moves, and the work space of its right-hand side."""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.cage.body import CageModel
from bearingwear.kernels.cage.law import CageBuffers, cage_buffers
from bearingwear.kernels.contact.ellipse_friction import EllipsePoints, Places, places
from bearingwear.kernels.contact.points import Rule, most_points
from bearingwear.kernels.contact.profile import semi_axis
from bearingwear.kernels.contact.slip import loaded_contact
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.dynamic.quasistatic import (
    COS_I,
    COS_O,
    HERTZ_A,
    HERTZ_B,
    SIN_I,
    SIN_O,
    Suspension,
    suspension,
)
from bearingwear.kernels.layout import StateLayout
from bearingwear.kernels.params import Geometry, OperatingPoint


class BearingModel(NamedTuple):
    """Bearing, loads and speeds of a run in time."""

    g: Geometry
    op: OperatingPoint
    D: np.ndarray  # (n,) worn ball diameters [m]
    mass: np.ndarray  # (n,) [kg]
    inertia: np.ndarray  # (n,) [kg m2]
    hertz: np.ndarray  # (n, 2, intervals, 12) see quasistatic.hertz_at
    axial_is_held: bool  # fixed position of the race; else constant force
    F_x: float  # preload [N]
    F_y: float  # load fixed in space [N]
    F_z: float
    F_rot: float  # load that turns with the shaft, along +Z at t = 0 [N]
    tilt: float  # [rad]
    cage: CageModel
    traction: bool  # enters the balance of normal forces
    rule: Rule  # for the contact ellipses
    points: (
        EllipsePoints  # from which the motion sums friction, but on a line that bears no traction
    )
    layout: StateLayout


class Buffers(NamedTuple):
    """Work space of the right-hand side and its Jacobian."""

    balls: Suspension
    cage: CageBuffers
    rest: np.ndarray  # (3,) displacement of the race at rest, a safe start [m]
    t: np.ndarray  # (points,) of the contact at hand, if they depend on it
    weight: np.ndarray  # (points,)
    h: np.ndarray  # (points,)
    places: Places  # of the points of the contact at hand
    L: np.ndarray  # (4, 6) derivative of the slip coefficients, see contact_changes.slip_changes
    gradient: np.ndarray  # (n, 2, 4) of the friction potentials, or (n, 2, 5) with traction
    hessian: np.ndarray  # (n, 2, 4, 4) or (n, 2, 5, 5)
    even: np.ndarray  # (n, 2, 4) or (n, 2, 5), the part of a film that shears evenly
    even_hessian: np.ndarray  # (4, 4) or (5, 5), of the contact at hand
    change: np.ndarray  # (5, 7) derivative of the gradient
    blocks: np.ndarray  # (n, 8, 8) see jacobian.ball_blocks
    inner: np.ndarray  # (n, 2, 8) likewise


def buffers(n, rule, points, traction):
    """Work space for n balls, a rule and spread points, with or without traction in the balance."""
    length, size = most_points(rule), 5 if traction else 4
    return Buffers(
        balls=suspension(n),
        cage=cage_buffers(n),
        rest=np.zeros(3),
        t=np.empty(length),
        weight=np.empty(length),
        h=np.empty(length),
        places=places(points),
        L=np.zeros((4, 6)),
        gradient=np.zeros((n, 2, size)),
        hessian=np.zeros((n, 2, size, size)),
        even=np.zeros((n, 2, size)),
        even_hessian=np.zeros((size, size)),
        change=np.zeros((5, 7)),
        blocks=np.empty((n, 8, 8)),
        inner=np.empty((n, 2, 8)),
    )


@jit
def load_at(bearing, time, F):
    """Load (axial, Y, Z) on the inner race at an instant, into F."""
    theta = bearing.op.omega_i * time
    F[0] = bearing.F_x
    F[1] = bearing.F_y - bearing.F_rot * math.sin(theta)
    F[2] = bearing.F_z + bearing.F_rot * math.cos(theta)


@jit
def race_contact_of(bearing, balls, j, k):
    """Contact of ball j with race k (0 inner, 1 outer)."""
    Q, d = balls.Q[j, k], balls.direction[j]
    factors = balls.factors[j, k]
    a, b = semi_axis(factors[HERTZ_A], Q), semi_axis(factors[HERTZ_B], Q)
    sine, cosine = (d[SIN_I], d[COS_I]) if k == 0 else (d[SIN_O], d[COS_O])
    return loaded_contact(bearing.g, bearing.op, k, Q, a, b, sine, cosine)
