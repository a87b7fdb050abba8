"""Equilibrium of the inner race on N balls under any load (theory.md section 2)."""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.contact.profile import contact_approach, contact_stiffness
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.equilibrium.thrust_loaded import (
    ball_equilibrium,
    cold_start,
    groove_distance,
)
from bearingwear.kernels.linear import copy, solve_in_place
from bearingwear.kernels.params import BallLoad, BallState, Geometry, Hertz
from bearingwear.kernels.status import NOT_CONVERGED, OK, PRELOAD_GONE

_LAST_BIT = 2.0**-50
NEAR_BALANCE = 1e-9  # share of the loads that noise of the ball centres may leave; verified after
PLACE_MARGIN = 10.0  # by which the estimate of the places' rounding may be too low
BALANCED = 1e-14  # share of the loads left over in an exact balance
_MOST_STEPS = 400
_HALVINGS = 30  # of a step, at the most
_ROUNDED_STEP = 1e-9  # a step below this, over the distance of the groove centres, is tried once

# Damping: a soft spring on the race; its stiffness over E* D0 or over the race's own.
SOFTEST = 1e-9  # below this there is none
HARDEST = 1e6  # above this the solve is given up
LEANING = 1e-3  # first spring where no ball resists in some direction
FOLLOWING = 1e-4  # first spring where balls come off, over the race's stiffness
FIRMER, SOFTER = 10.0, 0.1  # after a failed step, after a good one

# Columns of a packed BallState; its residual is not kept.
_STATUS, X1, X2, ALPHA_I, ALPHA_O, Q_I, Q_O, HERTZ_I, HERTZ_O = 0, 1, 2, 3, 4, 5, 6, 7, 12
F_IX, F_IR, S_XX, S_XR, S_RR, P_X, P_R = range(17, 24)
PACKED = 24  # floats
# Columns of a packed Hertz record, from HERTZ_I or HERTZ_O on.
K, C_A, C_B, _LOG_KAPPA, E = range(5)
# Columns of a packed BallLoad.
MODEL, ORBIT_RATE, OMEGA_I, OMEGA_O, LOAD_X, LOAD_R = range(6)
LOAD_FIELDS = 6  # floats


class RaceProblem(NamedTuple):
    """What the equilibrium of the race holds constant, and the states of its balls."""

    g: Geometry
    D: np.ndarray  # (n_balls,) worn diameters [m]
    loads: np.ndarray  # (n_balls, LOAD_FIELDS) packed BallLoads
    psi: np.ndarray  # (n_balls,) azimuths [rad]
    F: np.ndarray  # (3,) load on the inner race (axial, Y, Z) [N]
    tilt: float  # [rad]
    first: int  # first free translation: 0 for constant force, 1 where the axial one is given
    packed_states: np.ndarray  # (n_balls, PACKED) the starts, replaced by the answers


class RaceForces(NamedTuple):
    """Buffers of `race_forces`."""

    force: np.ndarray  # (3,) of the race on the balls (axial, Y, Z) [N]
    stiffness: np.ndarray  # (3, 3) its derivative by the displacement [N/m]


@jit
def empty_forces():
    """Buffers to fill."""
    return RaceForces(force=np.empty(3), stiffness=np.empty((3, 3)))


@jit
def pack_hertz(hertz, row, at):
    """Write a Hertz record into a row from column `at` on."""
    row[at + K] = hertz.K
    row[at + C_A] = hertz.c_a
    row[at + C_B] = hertz.c_b
    row[at + _LOG_KAPPA] = hertz.log_kappa
    row[at + E] = hertz.E


@jit
def unpack_hertz(row, at):
    """The Hertz record of a row from column `at` on."""
    return Hertz(
        K=row[at + K],
        c_a=row[at + C_A],
        c_b=row[at + C_B],
        log_kappa=row[at + _LOG_KAPPA],
        E=row[at + E],
    )


@jit
def pack_ball_state(state, row):
    """Write a BallState into a row of PACKED floats."""
    row[_STATUS] = state.status
    row[X1], row[X2] = state.X1, state.X2
    row[ALPHA_I], row[ALPHA_O] = state.alpha_i, state.alpha_o
    row[Q_I], row[Q_O] = state.Q_i, state.Q_o
    pack_hertz(state.hertz_i, row, HERTZ_I)
    pack_hertz(state.hertz_o, row, HERTZ_O)
    row[F_IX], row[F_IR] = state.F_ix, state.F_ir
    row[S_XX], row[S_XR], row[S_RR] = state.S_xx, state.S_xr, state.S_rr
    row[P_X], row[P_R] = state.P_x, state.P_r


@jit
def unpack_ball_state(row):
    """The BallState of a row; its residual is not kept."""
    return BallState(
        status=int(row[_STATUS]),
        X1=row[X1],
        X2=row[X2],
        alpha_i=row[ALPHA_I],
        alpha_o=row[ALPHA_O],
        Q_i=row[Q_I],
        Q_o=row[Q_O],
        hertz_i=unpack_hertz(row, HERTZ_I),
        hertz_o=unpack_hertz(row, HERTZ_O),
        F_ix=row[F_IX],
        F_ir=row[F_IR],
        S_xx=row[S_XX],
        S_xr=row[S_XR],
        S_rr=row[S_RR],
        P_x=row[P_X],
        P_r=row[P_R],
        residual=0.0,
    )


@jit
def unpack_ball_load(row):
    """The BallLoad of a row."""
    return BallLoad(
        kinematics_model=int(row[MODEL]),
        Omega=row[ORBIT_RATE],
        omega_i=row[OMEGA_I],
        omega_o=row[OMEGA_O],
        P_x=row[LOAD_X],
        P_r=row[LOAD_R],
        T_i=0.0,
        T_o=0.0,
    )


@jit
def race_forces(p, delta, out):
    """Find the equilibrium of every ball and sum its force on the inner race.

    Parameters
    ----------
    delta : ndarray (3,)
        Displacement (axial, Y, Z) of the inner race [m].
    out : RaceForces
        Filled.

    Returns
    -------
    float
        Sum of the inner contact loads, the scale of the force balance [N]; NaN where a ball did
        not converge.
    """
    g, psi, force, stiffness = p.g, p.psi, out.force, out.stiffness
    force[:] = 0.0
    stiffness[:, :] = 0.0
    scale = 0.0
    for j in range(p.D.size):
        row = p.packed_states[j]
        A1, A2 = groove_distance(g, psi[j], delta[0], delta[1], delta[2], p.tilt)
        state = ball_equilibrium(
            g, p.D[j], unpack_ball_load(p.loads[j]), A1, A2, unpack_ball_state(row)
        )
        pack_ball_state(state, row)
        if state.status == NOT_CONVERGED:
            return math.nan
        y, z = -math.sin(psi[j]), math.cos(psi[j])
        force[0] += state.F_ix
        force[1] += state.F_ir * y
        force[2] += state.F_ir * z
        stiffness[0, 0] += state.S_xx
        stiffness[0, 1] += state.S_xr * y
        stiffness[0, 2] += state.S_xr * z
        stiffness[1, 1] += state.S_rr * y * y
        stiffness[1, 2] += state.S_rr * y * z
        stiffness[2, 2] += state.S_rr * z * z
        scale += state.Q_i
    stiffness[1, 0] = stiffness[0, 1]
    stiffness[2, 0] = stiffness[0, 2]
    stiffness[2, 1] = stiffness[1, 2]
    return scale


@jit
def free_residual(F, force, first, step):
    """Force left over in the free translations, into `step`; returns its length [N]."""
    size = 0.0
    for i in range(3 - first):
        step[i] = F[first + i] - force[first + i]
        size += step[i] ** 2
    return math.sqrt(size)


@jit
def step_within_reach(step, n, reach):
    """Largest component of a step, and the share of it that stays within `reach`."""
    length = 0.0
    for i in range(n):
        length = max(length, abs(step[i]))
    return length, (min(1.0, reach / length) if length > 0.0 else 1.0)


@jit
def load_noise(Q, K, r):
    """What the last bits of a ball's place make of a load Q in a groove of the radius r [N]."""
    return _LAST_BIT * r * contact_stiffness(Q, contact_approach(K, Q)) if Q > 0.0 else 0.0


@jit
def as_good_as_rounding(p, size, largest, stiffness):
    """Whether rounding of loads and places explains a residual `size` of forces `largest` [N]."""
    g, places, loads = p.g, 0.0, 0.0
    for i in range(p.first, 3):
        places += _LAST_BIT * stiffness[i, i] * (g.r_i + g.r_o)
    for j in range(p.D.size):
        row = p.packed_states[j]
        inner = load_noise(row[Q_I], row[HERTZ_I + K], g.r_i)
        loads += max(inner, load_noise(row[Q_O], row[HERTZ_O + K], g.r_o))
    return size <= max(NEAR_BALANCE * largest + PLACE_MARGIN * places, loads)


@jit
def firmer_spring(softest, damping, stiffness, first):
    """Damping after a step that lessened nothing [N/m].

    Where balls come off, the tangent misleads: follow the force itself more closely.
    """
    stiff = 0.0
    for i in range(first, 3):
        stiff = max(stiff, stiffness[i, i])
    return max(FIRMER * damping, FOLLOWING * stiff, softest)


@jit
def race_line_search(p, delta, step, size, out, trial):
    """Shorten the step until it lessens the force left over.

    Parameters
    ----------
    size : float
        Force left over at `delta` [N].
    out : RaceForces
        Filled at the last trial.
    trial : ndarray (3,)
        The last trial [m].

    Returns
    -------
    found, scale
        Whether it does; as `race_forces`.
    """
    n, left = 3 - p.first, np.empty(3)
    length, share = step_within_reach(step, n, p.g.BD)
    scale = 0.0
    for _ in range(1 if length <= _ROUNDED_STEP * p.g.BD else _HALVINGS):
        copy(delta, trial)
        for i in range(n):
            trial[p.first + i] += share * step[i]
        scale = race_forces(p, trial, out)
        if free_residual(p.F, out.force, p.first, left) < size:
            return True, scale
        share *= 0.5
    return False, scale


@jit
def race_equilibrium(g, D, loads, psi, F, tilt, first, delta, packed_states):
    """Displacement of the inner race that balances the load: Newton with a line search.

    Parameters
    ----------
    delta : ndarray (3,)
        Start (and the given axial displacement) [m]; the answer replaces it.
    packed_states : ndarray (n_balls, PACKED)
        Filled with the ball states; for the others see RaceProblem.

    Returns
    -------
    status, residual, stiffness
        residual: force left unbalanced [N]; stiffness: of the race against translation (3, 3).
    """
    p = RaceProblem(
        g=g, D=D, loads=loads, psi=psi, F=F, tilt=tilt, first=first, packed_states=packed_states
    )
    n, firmness = 3 - first, g.E_star * g.D0
    now, next_ = empty_forces(), empty_forces()
    matrix, step, trial = np.empty((3, 3)), np.empty(3), np.empty(3)
    for j in range(D.size):
        pack_ball_state(cold_start(), packed_states[j])
    scale = race_forces(p, delta, now)
    load = math.sqrt((F[first:] ** 2).sum())  # where the race is free to move
    status = NOT_CONVERGED
    damping = 0.0  # [N/m]
    for _ in range(_MOST_STEPS):
        if math.isnan(scale):
            break
        size = free_residual(F, now.force, first, step)
        if size <= BALANCED * (scale + load):
            status = OK
            break
        copy(now.stiffness[first:, first:], matrix[:n, :n])
        for i in range(n):
            matrix[i, i] += damping
        if not solve_in_place(matrix, step, n):
            # No ball resists in some direction: a soft spring holds the race until one does.
            lean = LEANING * (firmness if damping == 0.0 else damping)
            damping = max(FIRMER * damping, lean)
        else:
            found, new_scale = race_line_search(p, delta, step, size, next_, trial)
            if found:
                damping = SOFTER * damping if damping > SOFTEST * firmness else 0.0
                copy(trial, delta)
                copy(next_.force, now.force)
                copy(next_.stiffness, now.stiffness)
                scale = new_scale
                continue
            if as_good_as_rounding(p, size, scale, now.stiffness):
                status = OK
                scale = race_forces(p, delta, now)  # the packed states are the last trial's
                break
            damping = firmer_spring(SOFTEST * firmness, damping, now.stiffness, first)
        if damping > HARDEST * firmness:
            break
    if scale == 0.0:
        status = PRELOAD_GONE
    return status, np.abs(F - now.force)[first:].max(), now.stiffness


@jit
def axial_stiffness(stiffness):
    """Axial stiffness with the race free to yield radially under a constant radial load [N/m]."""
    a, b, d = stiffness[1, 1], stiffness[1, 2], stiffness[2, 2]
    det = a * d - b * b
    k = stiffness[0, 0]
    if det > 0.0:
        p, q = stiffness[0, 1], stiffness[0, 2]
        k -= (d * p * p - 2.0 * b * p * q + a * q * q) / det
    return k
