"""Places of balls and inner race in balance with the cage's contacts, at one instant.

Newton for ball centres and race displacement at once, the balls condensed one by one, from the last
answer on. Where that fails, the nested solver of race.py, which needs no start, takes over.
"""

import math

import numpy as np

from bearingwear.kernels.cage.body import INNER_LAND
from bearingwear.kernels.cage.contacts import cage_contacts, set_race_velocity
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.dynamic.friction import find_tractions
from bearingwear.kernels.dynamic.jacobian import INNER_1, INNER_2, OUTER_1, OUTER_2
from bearingwear.kernels.dynamic.model import load_at
from bearingwear.kernels.dynamic.quasistatic import (
    FORCE_1,
    FORCE_2,
    I_11,
    I_12,
    I_21,
    I_22,
    K_11,
    K_12,
    K_21,
    K_22,
    LOG_KAPPA,
    O_11,
    O_12,
    O_21,
    O_22,
    add_traction_stiffness,
    assemble_condensed,
    back_substitute,
    find_contacts,
    nested_solution,
    solve_race,
    start_is_known,
    unbalanced_forces,
)
from bearingwear.kernels.linear import add_multiple, copy
from bearingwear.kernels.status import NOT_CONVERGED, OK

LAST_PLACE_STEP = 1e-10  # of the distance of the groove centres
LONGEST_PLACE_STEP = 0.3  # of that distance
MOST_ITERATIONS = 40
MOST_TRIALS = 200  # of an equilibrium with a cage, which usually takes three


@jit
def linearise_land(bearing, balls, contacts):
    """Linear force of the cage's land on the inner race, about its present place."""
    x, n = balls.land_linear, bearing.D.size
    x[FORCE_1], x[FORCE_2] = contacts.race_force[0], contacts.race_force[1]
    x[K_11] = x[K_12] = x[K_21] = x[K_22] = 0.0
    for k in range(n, n + 2):
        if contacts.normal[k] > 0.0:
            K = contacts.K[k]
            x[K_11] += K[1, 1]
            x[K_12] += K[1, 2]
            x[K_21] += K[2, 1]
            x[K_22] += K[2, 2]


@jit
def linearise_cage_forces(bearing, balls, contacts):
    """Linear forces of the cage on balls and inner race, about their present places."""
    if bearing.cage.land == INNER_LAND:
        linearise_land(bearing, balls, contacts)
    for j in range(bearing.D.size):
        x, K = balls.cage_linear[j], contacts.K[j]
        x[FORCE_1], x[FORCE_2] = contacts.ball_force[j, 0], contacts.ball_force[j, 2]
        if contacts.normal[j] > 0.0:
            sp, cp = balls.turn[j, 0], balls.turn[j, 1]
            x[K_11] = K[0, 0]
            x[K_12] = K[0, 2] * cp - K[0, 1] * sp
            x[K_21] = K[2, 0] * cp - K[1, 0] * sp
            x[K_22] = K[1, 1] * sp * sp - (K[1, 2] + K[2, 1]) * sp * cp + K[2, 2] * cp * cp
        else:
            x[K_11] = x[K_12] = x[K_21] = x[K_22] = 0.0


@jit
def balance(y, bearing, buf):
    """What the contacts found leave unbalanced, tractions included."""
    balls = buf.balls
    if bearing.traction:
        find_tractions(y, bearing, buf)
        add_traction_stiffness(bearing, balls)
    unbalanced_forces(y, bearing, balls)


@jit
def size_of_unbalanced(balls):
    """Root of the sum of squares of all unbalanced forces [N]."""
    total = 0.0
    for j in range(balls.r.size):
        total += balls.left[j, 0] ** 2 + balls.left[j, 1] ** 2
    for k in range(3):
        total += balls.race_left[k] ** 2
    return math.sqrt(total)


@jit
def free_equilibrium(time, y, bearing, buf):
    """Ball centres and race from the last answer on, without the cage.

    Returns
    -------
    int
        OK, or what the nested solver returned.
    """
    balls, BD = buf.balls, bearing.g.BD
    load_at(bearing, time, balls.F)
    balls.cage_linear[:, :] = 0.0
    balls.land_linear[:] = 0.0
    nested = not start_is_known(balls)
    if nested:
        status = nested_solution(y, bearing, balls)
        if status != OK:
            return status
    for _ in range(MOST_ITERATIONS):
        find_contacts(y, bearing, balls)
        balance(y, bearing, buf)
        regular = assemble_condensed(bearing, bearing.axial_is_held, True, balls)
        if regular and solve_race(bearing, balls):
            largest = back_substitute(bearing, balls)
            if largest < LONGEST_PLACE_STEP * BD:
                if largest <= LAST_PLACE_STEP * BD:
                    return OK
                continue
        if nested:
            return NOT_CONVERGED
        # Lost: a ball unloaded, or the start was too far off. Begin anew without a start.
        nested = True
        status = nested_solution(y, bearing, balls)
        if status != OK:
            return status
    return NOT_CONVERGED


@jit
def joint_equilibrium(time, y, bearing, buf):
    """Ball centres, race and cage contacts that agree with each other, from the last answer on.

    Newton for all at once. Where pockets open and close the contact law has edges, so a step is
    shortened until it leaves less force unbalanced.
    """
    BD, balls, contacts = bearing.g.BD, buf.balls, buf.cage
    X, delta = balls.X.copy(), balls.delta.copy()
    dX, d_delta = np.zeros((bearing.D.size, 2)), np.zeros(3)
    size, largest, share, done = math.inf, 0.0, 1.0, False
    load_at(bearing, time, balls.F)
    set_race_velocity(time, bearing, contacts)
    for _ in range(MOST_TRIALS):
        if done:
            return OK
        find_contacts(y, bearing, balls)
        cage_contacts(y, bearing, balls, contacts)
        linearise_cage_forces(bearing, balls, contacts)
        balance(y, bearing, buf)
        left = size_of_unbalanced(balls)
        if left < size:
            regular = assemble_condensed(bearing, bearing.axial_is_held, True, balls)
            if not (regular and solve_race(bearing, balls)):
                return NOT_CONVERGED
            size = left
            copy(balls.X, X)
            copy(balls.delta, delta)
            largest = back_substitute(bearing, balls)
            add_multiple(balls.X, -1.0, X, dX)
            add_multiple(balls.delta, -1.0, delta, d_delta)
            share = min(1.0, LONGEST_PLACE_STEP * BD / largest) if largest > 0.0 else 1.0
            done = largest <= LAST_PLACE_STEP * BD
        else:
            share *= 0.5
            if share * largest <= 1e-15 * BD:
                # Rounding allows no more, or there is no way down.
                if size > 1e-7 * balls.Q.max():
                    return NOT_CONVERGED
                share, done = 0.0, True
        add_multiple(X, share, dX, balls.X)
        add_multiple(delta, share, d_delta, balls.delta)
    return NOT_CONVERGED


@jit
def equilibrium(time, y, bearing, buf):
    """Places of balls, race and cage contacts, from the last answer on.

    From nothing, and at first without the cage, where that fails. What is found is the places
    alone: `rates.rates_here` brings the rest of the buffers there.
    """
    balls, with_cage = buf.balls, bearing.cage.present
    if not with_cage:
        status = free_equilibrium(time, y, bearing, buf)
    elif start_is_known(balls):
        status = joint_equilibrium(time, y, bearing, buf)
    else:
        status = NOT_CONVERGED
    if status != OK:
        balls.factors[:, :, :] = math.nan
        copy(buf.rest, balls.delta)
        status = free_equilibrium(time, y, bearing, buf)
        if status == OK and with_cage:
            status = joint_equilibrium(time, y, bearing, buf)
    return status


@jit
def correct_places(bearing, buf):
    """One step of Newton's method for places, from what `jacobian.ball_blocks` left.

    Returns
    -------
    bool
        False where there is no such step, or a long one.
    """
    balls = buf.balls
    if bearing.cage.present:
        linearise_cage_forces(bearing, balls, buf.cage)
    for j in range(bearing.D.size):
        block, inner, k = buf.blocks[j], buf.inner[j], balls.stiffness[j]
        k[I_11], k[I_12], k[I_21], k[I_22] = (
            inner[0, INNER_1], inner[0, INNER_2], inner[1, INNER_1], inner[1, INNER_2],
        )  # fmt: skip
        k[O_11], k[O_12], k[O_21], k[O_22] = (
            -block[0, OUTER_1], -block[0, OUTER_2], -block[1, OUTER_1], -block[1, OUTER_2],
        )  # fmt: skip
    if not (
        assemble_condensed(bearing, bearing.axial_is_held, True, balls)
        and solve_race(bearing, balls)
    ):
        return False
    return back_substitute(bearing, balls) < LONGEST_PLACE_STEP * bearing.g.BD


def places_size(n):
    """Numbers that `keep_places` writes for n balls."""
    return 2 * n + 3


@jit
def keep_places(balls, kept):
    """Copy where balls and race are into `kept` (places_size(n),)."""
    n = balls.r.size
    copy(balls.X, kept[: 2 * n].reshape(n, 2))
    copy(balls.delta, kept[2 * n :])


@jit
def restore_places(balls, kept):
    """The opposite of `keep_places`: the next equilibrium starts there."""
    n = balls.r.size
    copy(kept[: 2 * n].reshape(n, 2), balls.X)
    copy(kept[2 * n :], balls.delta)
    balls.factors[:, :, LOG_KAPPA] = 0.0  # known
