"""A ball between two worn grooves: forces of its contacts and their balance (theory.md section 21).

The force of a contact is Hertz' at the present angle times what its cells carry worn over unworn.
Its centre lies off the line of the centres, so that it has a part T across that line. Both derive
from one energy: the tangent of a contact's force by the ball's place is symmetric.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.ball import ball_mass
from bearingwear.kernels.compile import jit
from bearingwear.kernels.equilibrium import groove_distance
from bearingwear.kernels.hertz import INNER, OUTER, race_contact
from bearingwear.kernels.linear import solve_in_place
from bearingwear.kernels.params import Hertz
from bearingwear.kernels.profile import contact_load, semi_axis
from bearingwear.kernels.status import CONTACT_LOST, NOT_CONVERGED, OK
from bearingwear.kernels.worn_contact import Cells, ContactBuffers, worn_pressure

MOST_PLACES = 40  # of a ball and race, tried for one balance
SLOW_PLACES = 8  # after so many the stiffness is found anew
WORN_BALANCE = 1e-8  # force left, as a share of the load [1]
STIFFNESS_QUOTIENT = 1e-3  # of the approach: the step that the first stiffness is found with
LONGEST_MOVE = 0.5  # of the approach, in one step


class Arc(NamedTuple):
    """A depth as a cubic spline over equal steps of an arc or a latitude."""

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
    rise: np.ndarray  # (n,) of the pressed surface from the ball's centre, by wear [m]
    groove: Arc  # over S [m]
    band: Arc  # of the ball, over latitude; no intervals: the ball wears evenly
    alpha_ref: float  # contact angle at which S = x [rad]
    stiffness: np.ndarray  # (2, 2) of the force by the ball's place, kept from solve to solve [N/m]


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


class WornSeat(NamedTuple):
    """Where ball and race stand, and the forces there."""

    status: int
    delta_a: float  # axial displacement of the race [m]
    X1: float  # ball centre from the outer groove centre [m]
    X2: float
    inner: WornForce
    outer: WornForce
    residual: float  # force left, over the larger load [1]
    F_i: float  # friction of the races along their first axes that the balance counts [N]
    F_o: float


@jit
def arc_depth(arc, s):
    """Depth and slope at a place; beyond the ends those at the ends."""
    n = arc.c.shape[1]
    if n == 0:
        return 0.0, 0.0
    place = (s - arc.first) / arc.step
    i = min(max(int(math.floor(place)), 0), n - 1)
    x = min(max(place - i, 0.0), 1.0) * arc.step
    c = arc.c
    depth = ((c[0, i] * x + c[1, i]) * x + c[2, i]) * x + c[3, i]
    return depth, (3.0 * c[0, i] * x + 2.0 * c[1, i]) * x + c[2, i]


@jit
def arc_shift(race, r_g, sigma, alpha):
    """S - x at a contact angle [m] (theory.md Eq. 71): of opposite sign for the inner groove."""
    return sigma * r_g * (alpha - race.alpha_ref)


@jit
def latitude(sigma, alpha, beta):
    """Latitude of a contact's middle on a ball whose axis is pitched by beta [rad]."""
    return sigma * (beta - alpha)


@jit
def worn_force(g, D, race, sigma, reference, y1, y2, beta):
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
    beta : float
        Pitch of the ball's axis; matters where the ball wears in bands [rad].

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
    shift, middle = arc_shift(race, r_g, sigma, alpha), latitude(sigma, alpha, beta)
    X = race.cells.X
    for i in range(X.size):
        x = a * X[i]
        w_groove, _ = arc_depth(race.groove, x + shift)
        w_band, _ = arc_depth(race.band, middle - x / R)
        race.x[i] = x
        race.wear[i] = (w_groove + w_band - reference) / d
        race.rise[i] = 0.5 * (w_groove - w_band - reference)
    status, _ = worn_pressure(race.cells, race.wear, race.work, race.pressure)
    load, centre, slope, peak = cell_sums(race, R, a, middle)
    if status == OK and not load > 0.0:
        status = CONTACT_LOST
    p_0 = 1.5 * Q / (math.pi * a * b)
    return WornForce(
        status=status,
        Q=Q * load,
        T=-Q * load * (a * centre / R + slope),
        alpha=alpha,
        approach=d,
        a=a,
        b=b,
        peak=p_0 * peak,
        hertz=hertz,
    )


@jit
def cell_sums(race, R, a, middle):
    """Sums over the cells of a solved contact.

    Parameters
    ----------
    a : float
        Semi-major axis, the unit of the cells [m].
    middle : float
        Latitude of the contact's middle [rad].

    Returns
    -------
    load, centre, slope, peak : float
        Load and largest pressure over those unworn; centre of the load over a; mean slope of the
        ball's band along the major axis, weighted by load.
    """
    load = unworn = centre = slope = peak = highest = 0.0
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
        if race.band.c.shape[1] > 0:
            slope -= q * arc_depth(race.band, middle - race.x[i] / R)[1] / R
    if load > 0.0:
        centre, slope = centre / load, slope / load
    return load / unworn, centre, slope, peak / highest


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


@jit
def find_stiffness(g, D, race, sigma, reference, y1, y2, beta):
    """Fill `race.stiffness` by differences: how the force falls as y moves towards the ball.

    For both races -d(force on the ball)/d(ball centre).
    """
    middle = worn_force(g, D, race, sigma, reference, y1, y2, beta)
    h = STIFFNESS_QUOTIENT * max(middle.approach, STIFFNESS_QUOTIENT**2 * D)
    for j in range(2):
        u1, u2 = (h, 0.0) if j == 0 else (0.0, h)
        up = worn_force(g, D, race, sigma, reference, y1 + u1, y2 + u2, beta)
        up_x, up_r = race_parts(sigma, up, 0.0)
        down = worn_force(g, D, race, sigma, reference, y1 - u1, y2 - u2, beta)
        down_x, down_r = race_parts(sigma, down, 0.0)
        race.stiffness[0, j] = -sigma * (up_x - down_x) / (2.0 * h)
        race.stiffness[1, j] = -sigma * (up_r - down_r) / (2.0 * h)
    return middle.status


@jit
def improve_stiffness(k, sigma, dy1, dy2, dF1, dF2):
    """Broyden's update of a stiffness by a step dy and the change of force that it brought."""
    size = dy1 * dy1 + dy2 * dy2
    if size > 0.0:
        e1 = -sigma * dF1 - (k[0, 0] * dy1 + k[0, 1] * dy2)
        e2 = -sigma * dF2 - (k[1, 0] * dy1 + k[1, 1] * dy2)
        k[0, 0] += e1 * dy1 / size
        k[0, 1] += e1 * dy2 / size
        k[1, 0] += e2 * dy1 / size
        k[1, 1] += e2 * dy2 / size


class BallPush(NamedTuple):
    """What else than the contacts' pressures pushes a ball."""

    Omega: float  # orbit rate [rad/s]
    F_i: float  # friction of the inner race along its first axis [N]
    F_o: float  # and of the outer one
    beta: float  # pitch of the ball's axis [rad]


@jit
def seat_step(k_i, k_o, race_moves, matrix, step):
    """Newton's step of ball and race; `step` holds what is left of their balances, and gets it.

    Parameters
    ----------
    k_i, k_o : ndarray (2, 2)
        Stiffness of the contacts [N/m].
    race_moves : bool
        Else it is held.
    matrix : ndarray (3, 3)
        Buffer.

    Returns
    -------
    bool
        False where the stiffness is singular.
    """
    for i in range(2):
        for j in range(2):
            matrix[i, j] = k_i[i, j] + k_o[i, j]
            matrix[2, j] = k_i[0, j]
        matrix[i, 2] = -k_i[i, 0]
    matrix[2, 2] = -k_i[0, 0]
    solved = solve_in_place(matrix, step, 3 if race_moves else 2)
    if not race_moves:
        step[2] = 0.0
    return solved


@jit
def step_share(approach, d1, d2, dd):
    """Share of a step of ball (d1, d2) and race dd that is short against the approach."""
    length = max(math.hypot(d1, d2), math.hypot(dd - d1, d2))
    longest = LONGEST_MOVE * approach
    return longest / length if length > longest else 1.0


@jit
def worn_seat(g, D, races, reference, preload, push, start):
    """Balance of a ball and the race between two worn grooves, by Broyden's method.

    Parameters
    ----------
    races : tuple of 2 WornRace
        Inner, outer.
    reference : ndarray (2,)
        As in `worn_force`.
    preload : Preload
    push : BallPush
    start : WornSeat
        Of which the places are taken.

    Returns
    -------
    WornSeat
    """
    inner_race, outer_race = races
    X1, X2, delta_a = start.X1, start.X2, start.delta_a
    if not preload.constant_force:
        delta_a = preload.delta_a
    mass, share = ball_mass(g.rho, D), preload.F_x / g.n_balls
    matrix, step = np.empty((3, 3)), np.empty(3)  # `step` first holds what is left
    k_i, k_o = inner_race.stiffness, outer_race.stiffness
    inner = outer = start.inner
    size = math.inf
    i_x = i_r = o_x = o_r = d1 = d2 = dd = 0.0
    for place in range(MOST_PLACES):
        A1, A2 = groove_distance(g, 0.0, delta_a, 0.0, 0.0, 0.0)
        y1, y2 = A1 - X1, A2 - X2
        unknown = not min(k_i[0, 0] + k_i[1, 1], k_o[0, 0] + k_o[1, 1]) > 0.0
        if unknown or (place > 0 and place % SLOW_PLACES == 0):
            find_stiffness(g, D, inner_race, INNER, reference[0], y1, y2, push.beta)
            find_stiffness(g, D, outer_race, OUTER, reference[1], X1, X2, push.beta)
        inner = worn_force(g, D, inner_race, INNER, reference[0], y1, y2, push.beta)
        outer = worn_force(g, D, outer_race, OUTER, reference[1], X1, X2, push.beta)
        status = inner.status if inner.status != OK else outer.status
        if status != OK:
            return WornSeat(status, delta_a, X1, X2, inner, outer, size, push.F_i, push.F_o)
        before = (i_x, i_r, o_x, o_r)
        i_x, i_r = race_parts(INNER, inner, push.F_i)
        o_x, o_r = race_parts(OUTER, outer, push.F_o)
        if place > 0:
            improve_stiffness(k_i, INNER, dd - d1, -d2, i_x - before[0], i_r - before[1])
            improve_stiffness(k_o, OUTER, d1, d2, o_x - before[2], o_r - before[3])
        step[0] = i_x + o_x
        step[1] = i_r + o_r + mass * (g.R_o + X2) * push.Omega * push.Omega
        step[2] = i_x - share if preload.constant_force else 0.0
        size = max(abs(step[0]), abs(step[1]), abs(step[2])) / max(inner.Q, outer.Q)
        if size <= WORN_BALANCE:
            return WornSeat(OK, delta_a, X1, X2, inner, outer, size, push.F_i, push.F_o)
        if not seat_step(k_i, k_o, preload.constant_force, matrix, step):
            break
        d1, d2, dd = step[0], step[1], step[2]
        part = step_share(max(inner.approach, outer.approach), d1, d2, dd)
        d1, d2, dd = part * d1, part * d2, part * dd
        X1, X2, delta_a = X1 + d1, X2 + d2, delta_a + dd
    return WornSeat(NOT_CONVERGED, delta_a, X1, X2, inner, outer, size, push.F_i, push.F_o)
