"""Equilibrium of the inner race on N balls under any load (theory.md section 2)."""

import math

import numpy as np

from bearingwear.kernels.compile import jit
from bearingwear.kernels.equilibrium import ball_equilibrium, cold_start, groove_distance
from bearingwear.kernels.linear import solve_in_place
from bearingwear.kernels.params import BallLoad, BallState, Hertz
from bearingwear.kernels.status import NOT_CONVERGED, OK, PRELOAD_GONE

LAST_BIT = 2.0**-50
NEAR_BALANCE = 1e-9  # share of the loads that noise of the ball centres may leave; verified after
ROW = 24  # floats of a stored BallState


@jit
def store_state(state, row):
    """Write a BallState into a row of ROW floats."""
    row[0] = state.status
    row[1], row[2] = state.X1, state.X2
    row[3], row[4] = state.alpha_i, state.alpha_o
    row[5], row[6] = state.Q_i, state.Q_o
    row[7], row[8], row[9], row[10], row[11] = state.hertz_i
    row[12], row[13], row[14], row[15], row[16] = state.hertz_o
    row[17], row[18] = state.F_ix, state.F_ir
    row[19], row[20], row[21] = state.S_xx, state.S_xr, state.S_rr
    row[22], row[23] = state.P_x, state.P_r


@jit
def stored_state(row):
    """The BallState of a row; its residual is not kept."""
    return BallState(
        int(row[0]), row[1], row[2], row[3], row[4], row[5], row[6],
        Hertz(row[7], row[8], row[9], row[10], row[11]),
        Hertz(row[12], row[13], row[14], row[15], row[16]),
        row[17], row[18], row[19], row[20], row[21], row[22], row[23], 0.0,
    )  # fmt: skip


@jit
def race_forces(g, D, loads, psi, delta, tilt, rows, force, stiffness):
    """Settle every ball and sum its force on the inner race.

    Parameters
    ----------
    D : ndarray (n_balls,)
        Worn diameters [m].
    loads : ndarray (n_balls, 6)
        Rows (law, Omega, omega_i, omega_o, P_x, P_r) of BallLoad.
    delta : ndarray (3,)
        Displacement (axial, Y, Z) of the inner race [m].
    rows : ndarray (n_balls, ROW)
        Ball states: the starts, replaced by the answers.
    force : ndarray (3,)
        Filled: force of the race on the balls (axial, Y, Z) [N].
    stiffness : ndarray (3, 3)
        Filled: its derivative by delta [N/m].

    Returns
    -------
    float
        Sum of the inner contact loads, the scale of the force balance [N]; NaN where a ball did
        not converge.
    """
    force[:] = 0.0
    stiffness[:, :] = 0.0
    scale = 0.0
    for j in range(D.size):
        load = BallLoad(
            int(loads[j, 0]), loads[j, 1], loads[j, 2], loads[j, 3], loads[j, 4], loads[j, 5]
        )
        A1, A2 = groove_distance(g, psi[j], delta[0], delta[1], delta[2], tilt)
        state = ball_equilibrium(g, D[j], load, A1, A2, stored_state(rows[j]))
        store_state(state, rows[j])
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
def race_equilibrium(g, D, loads, psi, F, tilt, first, delta, rows):
    """Displacement of the inner race that balances the load.

    Parameters
    ----------
    F : ndarray (3,)
        Load on the inner race (axial, Y, Z) [N].
    first : int
        First free translation: 0 for constant force, 1 where the axial displacement is given.
    delta : ndarray (3,)
        Start (and the given axial displacement) [m]; the answer replaces it.
    rows : ndarray (n_balls, ROW)
        Filled with the ball states.

    Returns
    -------
    status, residual, stiffness
        residual: force left unbalanced [N]; stiffness: of the race against translation (3, 3).
    """
    n = 3 - first
    force, stiffness = np.empty(3), np.empty((3, 3))
    trial_force, trial_stiffness = np.empty(3), np.empty((3, 3))
    matrix, step, trial = np.empty((3, 3)), np.empty(3), np.empty(3)
    for j in range(D.size):
        store_state(cold_start(), rows[j])
    scale = race_forces(g, D, loads, psi, delta, tilt, rows, force, stiffness)
    load = math.sqrt(F[0] ** 2 + F[1] ** 2 + F[2] ** 2)
    status = NOT_CONVERGED
    damping_force = 0.0
    for _ in range(400):
        if math.isnan(scale):
            break
        size = 0.0
        for i in range(n):
            step[i] = F[first + i] - force[first + i]
            size += step[i] ** 2
            for k in range(n):
                matrix[i, k] = stiffness[first + i, first + k]
            matrix[i, i] += damping_force
        size = math.sqrt(size)
        if size <= 1e-14 * (scale + load):
            status = OK
            break
        if not solve_in_place(matrix, step, n):
            # No ball resists in some direction: lean on a soft spring until one does.
            soft = 1e-3 * (g.E_star * g.D0 if damping_force == 0.0 else damping_force)
            damping_force = max(10.0 * damping_force, soft)
            if damping_force > 1e6 * g.E_star * g.D0:
                break
            continue
        length = 0.0
        for i in range(n):
            length = max(length, abs(step[i]))
        shrink = min(1.0, g.BD / length) if length > 0.0 else 1.0
        found = False
        rounding = length <= 1e-9 * g.BD  # only the full step is worth a try
        for _ in range(1 if rounding else 30):
            trial[:] = delta
            for i in range(n):
                trial[first + i] += shrink * step[i]
            new_scale = race_forces(
                g, D, loads, psi, trial, tilt, rows, trial_force, trial_stiffness
            )
            new = 0.0
            for i in range(n):
                new += (F[first + i] - trial_force[first + i]) ** 2
            new = math.sqrt(new)
            if new < size:
                found = True
                break
            shrink *= 0.5
        if not found:
            # As good as rounding of loads and places lets it be?
            places = 0.0
            for i in range(n):
                places += LAST_BIT * stiffness[first + i, first + i] * (g.r_i + g.r_o)
            if size <= NEAR_BALANCE * (scale + load) + 10.0 * places:
                status = OK
                # The rows are those of the last trial.
                scale = race_forces(g, D, loads, psi, delta, tilt, rows, force, stiffness)
                break
            # Where balls come off, the tangent misleads: follow the force itself more closely.
            stiff = 0.0
            for i in range(n):
                stiff = max(stiff, stiffness[first + i, first + i])
            damping_force = max(10.0 * damping_force, 1e-4 * stiff, 1e-9 * g.E_star * g.D0)
            if damping_force > 1e6 * g.E_star * g.D0:
                break
            continue
        damping_force = 0.1 * damping_force if damping_force > 1e-9 * g.E_star * g.D0 else 0.0
        delta[:] = trial
        scale = new_scale
        force[:] = trial_force
        stiffness[:, :] = trial_stiffness
    residual = 0.0
    for i in range(n):
        residual = max(residual, abs(F[first + i] - force[first + i]))
    if scale == 0.0:
        status = PRELOAD_GONE
    return status, residual, stiffness


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
