"""The force of a ball's contact with a worn groove (theory.md section 21).

The force of a contact is Hertz' at the present angle times what its cells carry worn over unworn.
Its centre lies off the line of the centres, so that it has a part T across that line. Both derive
from one energy: the tangent of a contact's force by the ball's place is symmetric.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.contact.hertz import race_contact
from bearingwear.kernels.contact.profile import contact_load, semi_axis
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.params import Hertz
from bearingwear.kernels.status import CONTACT_LOST, OK
from bearingwear.kernels.worn.cells import Cells, ContactBuffers
from bearingwear.kernels.worn.pressure import worn_pressure


class Arc(NamedTuple):
    """A depth as a cubic spline over equal steps of an arc."""

    first: float
    step: float
    c: np.ndarray  # (4, intervals) as in scipy.interpolate.PPoly


class WornRace(NamedTuple):
    """One race's groove where a ball runs, and the contact's cells."""

    cells: Cells
    work: ContactBuffers
    pressure: np.ndarray  # (m, n) the last one found, over the peak of Hertz
    wear: np.ndarray  # (n,) depth at the cells beyond the reference, over the approach
    x: np.ndarray  # (n,) cells along the major axis [m]
    bare: np.ndarray  # (n,) share of the cells along the major axis that has no film [1]
    rise: np.ndarray  # (n,) of the pressed surface from the ball's centre, by wear [m]
    groove: Arc  # over S [m]
    alpha_ref: float  # contact angle at which S = x [rad]
    uncovered: Arc  # share without film, over S [1]
    without: float  # friction coefficient there, below zero as with film [1]


class WornForce(NamedTuple):
    """What a worn contact does to its ball."""

    status: int
    Q: float  # load [N]
    T: float  # force across the line of the centres, along the first contact axis [N]
    alpha: float  # contact angle [rad]
    approach: float  # Hertz' approach at which the cells are scaled [m]
    a: float  # semi-axes of Hertz at that approach: the units of the cells [m]
    b: float
    peak: float  # largest pressure [Pa]
    hertz: Hertz


@jit
def spline_pieces(step, depth, c):
    """Fill c (4, n - 1) with the cubic spline through n depths at equal steps, level at its ends.

    Slopes follow from slope[i-1] + 4 slope[i] + slope[i+1] = 3 (depth[i+1] - depth[i-1])/step.
    """
    n = depth.size
    slope, ratio = np.zeros(n), np.zeros(n)
    for i in range(1, n - 1):
        ratio[i] = 1.0 / (4.0 - ratio[i - 1])
        slope[i] = (3.0 * (depth[i + 1] - depth[i - 1]) / step - slope[i - 1]) * ratio[i]
    for i in range(n - 2, 0, -1):
        slope[i] -= ratio[i] * slope[i + 1]
    for i in range(n - 1):
        mean = (depth[i + 1] - depth[i]) / step
        c[0, i] = (slope[i] + slope[i + 1] - 2.0 * mean) / (step * step)
        c[1, i] = (3.0 * mean - 2.0 * slope[i] - slope[i + 1]) / step
        c[2, i] = slope[i]
        c[3, i] = depth[i]


@jit
def arc_depth(arc, s):
    """Depth at a place; beyond the ends that at the ends."""
    n = arc.c.shape[1]
    if n == 0:
        return 0.0
    place = (s - arc.first) / arc.step
    i = min(max(int(math.floor(place)), 0), n - 1)
    x = min(max(place - i, 0.0), 1.0) * arc.step
    c = arc.c
    return ((c[0, i] * x + c[1, i]) * x + c[2, i]) * x + c[3, i]


@jit
def arc_shift(race, r_g, sigma, alpha):
    """S - x at a contact angle [m] (theory.md Eq. 71): of opposite sign for the inner groove."""
    return sigma * r_g * (alpha - race.alpha_ref)


@jit
def worn_force(g, D, race, sigma, reference, y1, y2):
    """Force of a worn contact.

    Parameters
    ----------
    race : WornRace
        Its `pressure` is the start, and is replaced.
    sigma : float
        +1 outer, -1 inner race.
    reference : float
        Depth from which the approach that scales the cells is counted [m].
    y1, y2 : float
        Axial and radial distance of the ball's centre from the outer groove's, or of the inner
        groove's centre from the ball's [m].

    Returns
    -------
    WornForce
    """
    r_g = g.r_o if sigma > 0.0 else g.r_i
    R = 0.5 * D
    length = math.sqrt(y1 * y1 + y2 * y2)
    alpha = math.atan2(y1, y2)
    hertz = race_contact(g, sigma, D, y2 / length, race.cells.log_kappa)
    d = length - (r_g - R) - reference
    if not d > 0.0:
        return no_force(CONTACT_LOST, alpha, hertz)
    Q = contact_load(hertz.K, d)
    a, b = semi_axis(hertz.c_a, Q), semi_axis(hertz.c_b, Q)
    shift = arc_shift(race, r_g, sigma, alpha)
    X = race.cells.X
    for i in range(X.size):
        x = a * X[i]
        depth = arc_depth(race.groove, x + shift)
        race.x[i] = x
        race.wear[i] = (depth - reference) / d
        race.rise[i] = 0.5 * (depth - reference)
        if race.without >= 0.0:
            bare = arc_depth(race.uncovered, x + shift)
            race.bare[i] = min(max(bare, 0.0), 1.0)
    status, _ = worn_pressure(race.cells, race.wear, race.work, race.pressure)
    load, centre, peak = cell_sums(race)
    if status == OK and not load > 0.0:
        status = CONTACT_LOST
    p_0 = 1.5 * Q / (math.pi * a * b)
    return WornForce(
        status=status,
        Q=Q * load,
        T=-Q * load * (a * centre / R),
        alpha=alpha,
        approach=d,
        a=a,
        b=b,
        peak=p_0 * peak,
        hertz=hertz,
    )


@jit
def cell_sums(race):
    """Sums over the cells of a solved contact.

    Returns
    -------
    load, centre, peak : float
        Load and largest pressure over those unworn; centre of the load over the semi-major axis.
    """
    load = unworn = centre = peak = highest = 0.0
    m, n = race.pressure.shape
    for i in range(n):
        q = 0.0
        for j in range(m):
            q += race.pressure[j, i]
            unworn += race.cells.fresh[j, i]
            peak = max(peak, race.pressure[j, i])
            highest = max(highest, race.cells.fresh[j, i])
        load += q
        centre += q * race.cells.X[i]
    if load > 0.0:
        centre /= load
    return load / unworn, centre, peak / highest


@jit
def no_force(status, alpha, hertz):
    """An open contact."""
    return WornForce(
        status=status, Q=0.0, T=0.0, alpha=alpha, approach=0.0, a=0.0, b=0.0, peak=0.0, hertz=hertz
    )


@jit
def race_parts(sigma, force, F_1):
    """Axial and radial force of a race on the ball, with the friction F_1 along the first axis."""
    s, c = math.sin(force.alpha), math.cos(force.alpha)
    across = force.T + F_1
    return -sigma * force.Q * s + across * c, -sigma * force.Q * c - across * s
