"""Elastic contact of a ball and a groove worn along its major axis (theory.md section 17).

Lengths are in semi-axes of the Hertz ellipse that the same bodies would have unworn, the gap in its
approach, the pressure in its peak: X = x/a, Y = y/b. Unworn, the gap is then always the same,

    s X^2 + (1 - s) Y^2 - 1 + displacement of the pressure  >= 0,    s = (1 - E/K)/m,

and wear w(x) adds w/approach. Results are scaled by those of the same cells unworn, so that
without wear they are Hertz' law to the last bit.
"""

import math

import numpy as np

from bearingwear.kernels.contact.hertz import elliptic_integrals
from bearingwear.kernels.decorators import REORDER_SUMS, jit
from bearingwear.kernels.status import BEYOND_GROOVE, NOT_CONVERGED, OK
from bearingwear.kernels.worn.cells import (
    Cells,
    contact_buffers,
    displacement,
    displacement_at,
    fill_influence,
    nearby_pressure,
    place_at_hand,
)

MOST_GRADIENTS = 400
CLOSED_GAP = 1e-8  # gap left where there is pressure, as a share of the approach [1]
FULL_WIDTH = 3.0  # of the cells together, in semi-minor axes


@jit
def contact_cells(log_kappa, low, high, width, n, m):
    """Cells of an ellipse with ln(a/b) = log_kappa, unworn pressure included.

    Parameters
    ----------
    low, high : float
        Ends along the major axis, over a.
    width : float
        Of the cells on both sides together, over b.
    n, m : int
        Cells along it, and on each side of it.

    Returns
    -------
    status, cells
    """
    kappa = math.exp(log_kappa)
    K, _, s = elliptic_integrals(1.0 / kappa)
    dX, dY = (high - low) / n, 0.5 * width / m
    X, Y = low + dX * (np.arange(n) + 0.5), dY * (np.arange(m) + 0.5)
    gap, fresh = np.empty((m, n)), np.empty((m, n))
    for j in range(m):
        for i in range(n):
            gap[j, i] = s * X[i] * X[i] + (1.0 - s) * Y[j] * Y[j] - 1.0
            fresh[j, i] = math.sqrt(max(1.0 - X[i] * X[i] - Y[j] * Y[j], 0.0))
    # p_0 a/(pi E*) over the approach, and the rectangle in units of a
    scale, c, d = kappa / (math.pi * K), 0.5 * dX, 0.5 * dY / kappa
    influence = np.empty((m, m, 2 * n - 1))
    fill_influence(scale, c, d, influence)
    cells = Cells(
        X=X,
        Y=Y,
        gap=gap,
        influence=influence,
        nearby=nearby_pressure(scale, c, d),
        fresh=fresh,
        area=2.0 * dX * dY,
        log_kappa=log_kappa,
    )
    status, _ = worn_pressure(cells, np.zeros(n), contact_buffers(n, m), fresh)
    return status, cells


@jit(fastmath=REORDER_SUMS)
def gap_at_hand(cells, wear, pressure, work):
    """Gap under a pressure, over the approach, into `work.gap`."""
    displacement(cells, pressure, work, work.gap)
    for j in range(cells.Y.size):
        for i in range(work.first[j], work.last[j]):
            work.gap[j, i] += cells.gap[j, i] + wear[i]


@jit
def open_cells(cells, pressure, work):
    """Give pressure to the cells at hand that overlap without pressure."""
    m, n = pressure.shape
    for j in range(m):
        own = cells.influence[j, j, n - 1]
        for i in range(work.first[j], work.last[j]):
            if pressure[j, i] == 0.0 and work.gap[j, i] < -CLOSED_GAP:
                pressure[j, i] = -work.gap[j, i] / own


@jit
def open_beyond(cells, wear, pressure, work):
    """Give pressure to cells that overlap and are not at hand; whether there were any.

    Only where the bodies pass through each other under no pressure can they overlap under some.
    """
    m, n = pressure.shape
    found = False
    for j in range(m):
        own = cells.influence[j, j, n - 1]
        for i in range(n):
            free = cells.gap[j, i] + wear[i]
            beyond = i < work.first[j] or i >= work.last[j]
            if beyond and not free >= -CLOSED_GAP:  # NaN too
                gap = free + displacement_at(cells, pressure, work.first, work.last, j, i)
                if not gap >= -CLOSED_GAP:
                    work.steep[j, i] = -gap / own
                    found = True
                else:
                    work.steep[j, i] = 0.0
            else:
                work.steep[j, i] = 0.0
    if found:
        for j in range(m):
            for i in range(n):
                pressure[j, i] += work.steep[j, i]
    return found


@jit(fastmath=REORDER_SUMS)
def steepest(cells, pressure, work):
    """Into `work.steep` what pressure nearly closes the gap of the loaded cells; times that gap."""
    m, n = pressure.shape
    own, along = cells.nearby[0, 0], cells.nearby[0, 1]
    across, both = cells.nearby[1, 0], cells.nearby[1, 1]
    left, z, first, last = work.response, work.steep, work.first, work.last
    for j in range(m):
        for i in range(n):
            at_hand = first[j] <= i < last[j]
            left[j, i] = work.gap[j, i] if at_hand and pressure[j, i] > 0.0 else 0.0
    for j in range(m):
        below, above = left[max(j - 1, 0)], left[min(j + 1, m - 1)]  # even in Y
        past = 1.0 if j + 1 < m else 0.0
        for i in range(first[j], last[j]):
            ahead, behind = min(i + 1, n - 1), max(i - 1, 0)
            z[j, i] = (
                own * left[j, i]
                + along * (left[j, ahead] + left[j, behind])
                + across * (below[i] + past * above[i])
                + both * (below[ahead] + below[behind] + past * (above[ahead] + above[behind]))
            )
    return inner_product(z, left, first, last)


@jit(fastmath=REORDER_SUMS)
def inner_product(a, b, first, last):
    """Sum of the products of two fields over the cells at hand."""
    found = 0.0
    for j in range(first.size):
        for i in range(first[j], last[j]):
            found += a[j, i] * b[j, i]
    return found


@jit
def open_and_overlapping(pressure, work):
    """Sums of squares of the gap of loaded cells, and of the overlap of others at hand."""
    left = overlap = 0.0
    for j in range(work.first.size):
        for i in range(work.first[j], work.last[j]):
            g = work.gap[j, i]
            if pressure[j, i] > 0.0:
                left += g * g
            elif not g >= -CLOSED_GAP:  # NaN too
                overlap += g * g
    return left, overlap


@jit(fastmath=REORDER_SUMS)
def conjugate_gradients(cells, wear, pressure, work, most):
    """Close the gap of the loaded cells; cells may join and leave.

    Returns
    -------
    int
        Iterations.
    """
    g, t, r, z = work.gap, work.direction, work.response, work.steep
    first, last = work.first, work.last
    place_at_hand(cells, pressure, work)
    gap_at_hand(cells, wear, pressure, work)
    m, before = cells.Y.size, math.inf
    for iteration in range(most):
        left, overlap = open_and_overlapping(pressure, work)
        if left <= CLOSED_GAP * CLOSED_GAP and overlap == 0.0:
            return iteration
        if not left + overlap >= 0.0:  # NaN
            return most
        if overlap > left:
            open_cells(cells, pressure, work)
            place_at_hand(cells, pressure, work)
            gap_at_hand(cells, wear, pressure, work)
            before = math.inf
            continue
        new = steepest(cells, pressure, work)
        share = new / before
        before = new
        for j in range(m):
            for i in range(first[j], last[j]):
                kept = share * t[j, i] if share > 0.0 else 0.0
                t[j, i] = z[j, i] + kept if pressure[j, i] > 0.0 else 0.0
        displacement(cells, t, work, r)
        step = inner_product(g, t, first, last) / inner_product(r, t, first, last)
        released = 0
        for j in range(m):
            for i in range(first[j], last[j]):
                g[j, i] -= step * r[j, i]
                pressed = pressure[j, i] - step * t[j, i]
                released += 1 if pressed < 0.0 else 0
                pressure[j, i] = max(pressed, 0.0)
        if released > 0:
            gap_at_hand(cells, wear, pressure, work)
            before = math.inf
    return most


@jit
def worn_pressure(cells, wear, work, pressure):
    """Pressure of a worn contact at a given approach.

    Conjugate gradients after Polonsky and Keer, Wear 231 (1999) 206, without their constraint on
    the load, and preconditioned: what presses a cell alone reaches hardly beyond its neighbours.

    Parameters
    ----------
    cells : Cells
    wear : ndarray (n,)
        Depth at the cells beyond what the approach is counted from, over the approach.
    work : ContactBuffers
        Of these cells alone: it keeps which are at hand.
    pressure : ndarray (m, n)
        The start; replaced by the pressure, over the peak of Hertz.

    Returns
    -------
    status, iterations
        OK, NOT_CONVERGED, or BEYOND_GROOVE where the contact runs off the cells.
    """
    total = 0
    while total <= MOST_GRADIENTS:
        total += 1 + conjugate_gradients(cells, wear, pressure, work, MOST_GRADIENTS - total)
        if total <= MOST_GRADIENTS and not open_beyond(cells, wear, pressure, work):
            return (BEYOND_GROOVE if runs_off(pressure) else OK), total
    return NOT_CONVERGED, total


@jit
def runs_off(pressure):
    """Whether the contact reaches the ends of its cells."""
    m, n = pressure.shape
    for j in range(m):
        if pressure[j, 0] > 0.0 or pressure[j, n - 1] > 0.0:
            return True
    for i in range(n):
        if pressure[m - 1, i] > 0.0:
            return True
    return False
