"""Check of a worn contact by a formula its solver does not use (theory.md section 17).

The solver sums over half of the cells and takes the gap along as it goes. Here every cell of the
whole contact is loaded by itself, and Love's displacement is in its other form, with logarithms.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.contact.hertz import elliptic_integrals
from bearingwear.kernels.decorators import REORDER_SUMS, jit


class ContactCheck(NamedTuple):
    """What a pressure leaves open."""

    gap: float  # largest where there is pressure, over the approach [1]
    overlap: float  # largest where there is none, over the approach [1]
    tension: float  # largest, over the peak of Hertz [1]
    load: float  # over the peak of Hertz times a b [1]


@jit
def love(x, y, c, d):
    """Integral of 1/rho over the rectangle |x| < c, |y| < d, seen from (x, y)."""
    right, left, up, down = x + c, x - c, y + d, y - d
    right_up, right_down = math.hypot(right, up), math.hypot(right, down)
    left_up, left_down = math.hypot(left, up), math.hypot(left, down)
    return (
        right * math.log((up + right_up) / (down + right_down))
        + up * math.log((right + right_up) / (left + left_up))
        + left * math.log((down + left_down) / (up + left_up))
        + down * math.log((left + left_down) / (right + right_down))
    )


@jit
def check_influence(cells):
    """Love's displacement of one loaded cell (2 m, 2 n - 1), by the distance across and along.

    Parameters
    ----------
    cells : Cells
        Of which only the places are taken.
    """
    kappa = math.exp(cells.log_kappa)
    elliptic_K, _, _ = elliptic_integrals(1.0 / kappa)
    dX, dY = cells.X[1] - cells.X[0], 2.0 * cells.Y[0]
    n = cells.X.size
    table = np.empty((2 * cells.Y.size, 2 * n - 1))
    for j in range(table.shape[0]):
        for i in range(n):
            seen = love(i * dX, j * dY / kappa, 0.5 * dX, 0.5 * dY / kappa)
            table[j, n - 1 + i] = table[j, n - 1 - i] = kappa / (math.pi * elliptic_K) * seen
    return table


@jit(fastmath=REORDER_SUMS)
def contact_check(cells, influence, wear, pressure):
    """Gap, overlap, tension and load of a pressure (m, n).

    Parameters
    ----------
    cells : Cells
        Of which only the places and the unworn gap are taken.
    influence : ndarray (2 m, 2 n - 1)
        Of `check_influence`.
    wear : ndarray (n,)
        As in `worn_contact.worn_pressure`.

    Returns
    -------
    ContactCheck
    """
    m, n = pressure.shape
    dX, dY = cells.X[1] - cells.X[0], 2.0 * cells.Y[0]
    largest_gap = overlap = tension = load = 0.0
    deflection = np.zeros((m, n))
    for k in range(-m, m):
        row = k if k >= 0 else -1 - k
        for q in range(n):
            p = pressure[row, q]
            load += p
            tension = max(tension, -p)
            if p != 0.0:
                for j in range(m):
                    for i in range(n):
                        deflection[j, i] += p * influence[abs(j - k), n - 1 - q + i]
    for j in range(m):
        for i in range(n):
            gap = cells.gap[j, i] + wear[i] + deflection[j, i]
            if pressure[j, i] > 0.0:
                largest_gap = max(largest_gap, abs(gap))
            else:
                overlap = max(overlap, -gap)
    return ContactCheck(gap=largest_gap, overlap=overlap, tension=tension, load=load * dX * dY)


@jit
def friction_of_cells(pressure, fresh, law, bare, without):
    """Friction coefficient of a worn contact, mean over its load [1], by plain sums over its cells.

    Parameters
    ----------
    pressure, fresh : ndarray (m, n)
        Worn and unworn, over the peak of Hertz.
    law : tuple of 3 floats
        `plain_law` of the unworn contact.
    bare : ndarray (n,)
        Share of the cells without film [1].
    without : float
        Coefficient there, below zero as with film [1].
    """
    constant, S, peak = law
    m, n = pressure.shape
    load = old_load = old_area = filmed_area = bare_load = 0.0
    for i in range(n):
        uncovered = bare[i] if without >= 0.0 else 0.0
        for j in range(m):
            load += pressure[j, i]
            bare_load += uncovered * pressure[j, i]
            filmed_area += (1.0 - uncovered) * min(pressure[j, i] / 0.3, 1.0)
            old_load += fresh[j, i]
            old_area += min(fresh[j, i] / 0.3, 1.0)
    # Hertz' mean pressure, two thirds of the peak, is that over the unworn area.
    sheared = S / (2.0 / 3.0 * peak) * (filmed_area / old_area) * old_load
    return (constant * (load - bare_load) + sheared + without * bare_load) / load
