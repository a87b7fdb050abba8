"""Places of balls and inner race that agree with the cage's contacts, at an instant of a motion."""

import math

import numpy as np

from bearingwear.kernels.bearing_model import load_at
from bearingwear.kernels.cage import INNER_LAND
from bearingwear.kernels.cage_contacts import cage_contacts, set_race_velocity
from bearingwear.kernels.compile import jit
from bearingwear.kernels.linear import add_multiple, copy
from bearingwear.kernels.quasistatic import (
    AT_1,
    AT_2,
    COS_I,
    COS_O,
    FORCE_1,
    FORCE_2,
    K_11,
    K_12,
    K_21,
    K_22,
    LOG_KAPPA,
    SIN_I,
    SIN_O,
    assemble_condensed,
    back_substitute,
    quasistatic_equilibrium,
    solve_race,
    start_is_known,
)
from bearingwear.kernels.state import BALL, OMEGA, PSI
from bearingwear.kernels.status import NOT_CONVERGED, OK

MOST_TRIALS = 200  # of an equilibrium with a cage, which usually takes three


@jit
def linearise_land(bearing, balls, contacts):
    """Linear force of the cage's land on the inner race, about its present place."""
    x, n = balls.land_linear, bearing.D.size
    x[FORCE_1], x[FORCE_2] = contacts.race_force[0], contacts.race_force[1]
    x[AT_1], x[AT_2] = balls.delta[1], balls.delta[2]
    x[K_11] = x[K_12] = x[K_21] = x[K_22] = 0.0
    for k in range(n, n + 2):
        if contacts.normal[k] > 0.0:
            K = contacts.K[k]
            x[K_11] += K[1, 1]
            x[K_12] += K[1, 2]
            x[K_21] += K[2, 1]
            x[K_22] += K[2, 2]


@jit
def linearise_cage_forces(y, bearing, balls, contacts):
    """Linear forces of the cage on balls and inner race, about their present places."""
    if bearing.cage.land == INNER_LAND:
        linearise_land(bearing, balls, contacts)
    for j in range(bearing.D.size):
        x, K = balls.cage_linear[j], contacts.K[j]
        x[FORCE_1], x[FORCE_2] = contacts.ball_force[j, 0], contacts.ball_force[j, 2]
        x[AT_1], x[AT_2] = balls.X[j, 0], balls.X[j, 1]
        if contacts.normal[j] > 0.0:
            psi = y[BALL * j + PSI]
            sp, cp = math.sin(psi), math.cos(psi)
            x[K_11] = K[0, 0]
            x[K_12] = K[0, 2] * cp - K[0, 1] * sp
            x[K_21] = K[2, 0] * cp - K[1, 0] * sp
            x[K_22] = K[1, 1] * sp * sp - (K[1, 2] + K[2, 1]) * sp * cp + K[2, 2] * cp * cp
        else:
            x[K_11] = x[K_12] = x[K_21] = x[K_22] = 0.0


@jit
def unbalanced(y, bearing, balls):
    """Force on balls and race that nothing balances, and the largest load that bears on it.

    For contacts found by `assemble_condensed` and forces of the cage linearised at the same places.

    Returns
    -------
    left, load : float
        Root of the sum of squares [N], largest load of a ball on its outer race [N].
    """
    land = balls.land_linear
    f0, f1, f2 = balls.F[0], balls.F[1] + land[FORCE_1], balls.F[2] + land[FORCE_2]
    total = load = 0.0
    for j in range(bearing.D.size):
        Omega, psi = y[BALL * j + OMEGA], y[BALL * j + PSI]
        d, x = balls.direction[j], balls.cage_linear[j]
        Q_i, Q_o = balls.Q[j, 0], balls.Q[j, 1]
        axial, radial = Q_i * d[SIN_I], Q_i * d[COS_I]
        total += (axial - Q_o * d[SIN_O] + x[FORCE_1]) ** 2
        centrifugal = bearing.mass[j] * (bearing.g.R_o + balls.X[j, 1]) * Omega**2
        total += (radial - Q_o * d[COS_O] + x[FORCE_2] + centrifugal) ** 2
        load = max(load, Q_o)
        f0 -= axial
        f1 += radial * math.sin(psi)
        f2 -= radial * math.cos(psi)
    if not bearing.axial_is_held:
        total += f0 * f0
    return math.sqrt(total + f1 * f1 + f2 * f2), load


@jit
def free_equilibrium(time, y, bearing, balls):
    """Ball centres and race from the last answer on, forces of the cage as linearised."""
    load_at(bearing, time, balls.F)
    return quasistatic_equilibrium(y, bearing, balls)


@jit
def joint_equilibrium(time, y, bearing, balls, contacts):
    """Ball centres, race and cage contacts that agree with each other, from the last answer on.

    Newton for all at once; a step is shortened until it leaves less force unbalanced, for the
    edges of the contact law where pockets open and close.
    """
    BD = bearing.g.BD
    X, delta = balls.X.copy(), balls.delta.copy()
    dX, d_delta = np.zeros((bearing.D.size, 2)), np.zeros(3)
    size, largest, share, done = math.inf, 0.0, 1.0, False
    load_at(bearing, time, balls.F)
    set_race_velocity(time, bearing, contacts)
    for _ in range(MOST_TRIALS):
        cage_contacts(y, bearing, balls, contacts)
        linearise_cage_forces(y, bearing, balls, contacts)
        regular = assemble_condensed(y, bearing, bearing.axial_is_held, balls)
        if done:
            return OK
        left, load = unbalanced(y, bearing, balls)
        if left < size:
            if not (regular and solve_race(bearing, balls)):
                return NOT_CONVERGED
            size = left
            copy(balls.X, X)
            copy(balls.delta, delta)
            largest = back_substitute(y, bearing, balls)
            add_multiple(balls.X, -1.0, X, dX)
            add_multiple(balls.delta, -1.0, delta, d_delta)
            share = min(1.0, 0.3 * BD / largest) if largest > 0.0 else 1.0
            done = largest <= 1e-10 * BD
        else:
            share *= 0.5
            if share * largest <= 1e-15 * BD:
                # Rounding allows no more, or there is no way down.
                if size > 1e-7 * load:
                    return NOT_CONVERGED
                share, done = 0.0, True
        add_multiple(X, share, dX, balls.X)
        add_multiple(delta, share, d_delta, balls.delta)
    return NOT_CONVERGED


@jit
def equilibrium(time, y, bearing, buf):
    """Places of balls, race and cage contacts, from the last answer on.

    From nothing, and at first without the cage, where that fails.
    """
    balls, with_cage = buf.balls, bearing.cage.present
    if not with_cage:
        status = free_equilibrium(time, y, bearing, balls)
    elif start_is_known(balls):
        status = joint_equilibrium(time, y, bearing, balls, buf.cage)
    else:
        status = NOT_CONVERGED
    if status != OK:
        balls.cage_linear[:, :] = 0.0
        balls.land_linear[:] = 0.0
        balls.factors[:, :, :] = math.nan
        copy(buf.rest, balls.delta)
        status = free_equilibrium(time, y, bearing, balls)
        if status == OK and with_cage:
            status = joint_equilibrium(time, y, bearing, balls, buf.cage)
    if status == OK:
        for j in range(bearing.D.size):
            balls.r[j] = bearing.g.R_o + balls.X[j, 1]
    return status


@jit
def places_size(n):
    """Numbers that `keep_places` writes for n balls."""
    return 10 * n + 11


@jit
def keep_places(balls, kept):
    """Copy where balls, race and cage contacts were found into `kept` (places_size(n),)."""
    n = balls.r.size
    copy(balls.X, kept[: 2 * n].reshape(n, 2))
    copy(balls.cage_linear, kept[2 * n : 10 * n].reshape(n, 8))
    copy(balls.delta, kept[10 * n : 10 * n + 3])
    copy(balls.land_linear, kept[10 * n + 3 :])


@jit
def restore_places(balls, kept):
    """The opposite of `keep_places`: the next equilibrium starts there."""
    n = balls.r.size
    copy(kept[: 2 * n].reshape(n, 2), balls.X)
    copy(kept[2 * n : 10 * n].reshape(n, 8), balls.cage_linear)
    copy(kept[10 * n : 10 * n + 3], balls.delta)
    copy(kept[10 * n + 3 :], balls.land_linear)
    balls.factors[:, :, LOG_KAPPA] = 0.0  # known
