"""Contacts that close within a step: where, and how long what follows takes."""

import math

from bearingwear.kernels.decorators import jit
from bearingwear.kernels.linear import copy

IMPACT = 2.94 * 1.25**0.4  # duration of an impact on a Hertz spring over (m/K)^0.4 v^-0.2


@jit
def interferences(buf, out):
    """Interference of every contact: pockets and land edges [m], load of every race contact [N].

    Positive where closed.
    """
    n = buf.balls.r.size
    copy(buf.cage.approach, out[: n + 2])
    for j in range(n):
        for k in range(2):
            out[n + 2 + 2 * j + k] = buf.balls.Q[j, k]


@jit
def first_closure(before, after, n, depth):
    """Events between two instants, and where in between the first deep contact is made.

    Returns
    -------
    count : int
        Contacts made or broken.
    fraction : float
        Of the step, to where the first pocket or land closes that is `depth` deep at its
        end; 1 where none is.
    """
    count, fraction = 0, 1.0
    for i in range(before.size):
        if (before[i] > 0.0) != (after[i] > 0.0):
            count += 1
            if i < n + 2 and after[i] > depth:
                fraction = min(fraction, before[i] / (before[i] - after[i]))
    return count, fraction


@jit
def predicted_closure(before, rate, n, depth, step):
    """Step [s], no longer than `step`, at the end of which no contact is deeper than it may be.

    Parameters
    ----------
    before, rate : ndarray
        Interferences where it begins, and their rates over the last step.
    """
    for i in range(n + 2):
        if before[i] < 0.0 and before[i] + rate[i] * step > depth:
            step = min(step, (0.5 * depth - before[i]) / rate[i])
    return step


@jit
def impact_time(cage, mass, i, n, speed):
    """Duration of an impact of this speed at contact i of a cage, undamped [s].

    Hertz' impact of a free ball on a free cage at a pocket; half a period at a land.
    """
    if i >= n:
        return math.pi * math.sqrt(cage.mass / cage.k_land)
    m_eff = mass * cage.mass / (mass + cage.mass)
    return IMPACT * (m_eff / cage.K_pocket) ** 0.4 * speed**-0.2
