"""Elastic contact of a ball and a groove worn along its major axis (theory.md section 17).

Lengths are in semi-axes of the Hertz ellipse that the same bodies would have unworn, the gap in its
approach, the pressure in its peak: X = x/a, Y = y/b. Unworn, the gap is then always the same,

    s X^2 + (1 - s) Y^2 - 1 + displacement of the pressure  >= 0,    s = (1 - E/K)/m,

and wear w(x) adds w/approach. The half space is cut into equal rectangles of uniform pressure. What
the contact gives is scaled by what the same cells give unworn, so that no wear is Hertz' law to the
last bit.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.compile import REORDER_SUMS, jit
from bearingwear.kernels.hertz import elliptic_integrals
from bearingwear.kernels.status import BEYOND_GROOVE, NOT_CONVERGED, OK

MOST_GRADIENTS = 400
CLOSED_GAP = 1e-8  # gap left where there is pressure, as a share of the approach [1]
FULL_WIDTH = 3.0  # of the cells together, in semi-minor axes


class Cells(NamedTuple):
    """Equal rectangles over half of a contact (it is even in Y), and what they are unworn."""

    X: np.ndarray  # (n,) centres along the major axis, over a
    Y: np.ndarray  # (m,) across, over b, all positive
    gap: np.ndarray  # (m, n) of the unworn bodies that only just touch, less 1, over the approach
    influence: np.ndarray  # (m, m, 2n - 1) approaches a row gets by the unit pressures of another
    fresh: np.ndarray  # (m, n) pressure unworn, over the peak of Hertz
    area: float  # of a cell and its mirror image, over a b
    log_kappa: float  # ln(a/b)


class ContactBuffers(NamedTuple):
    """Arrays of a solve."""

    gap: np.ndarray  # (m, n)
    direction: np.ndarray  # (m, n)
    response: np.ndarray  # (m, n)
    first: np.ndarray  # (m,) first cell of each row that is at hand
    last: np.ndarray  # (m,) and the one after the last


@jit
def corner(x, y):
    """Love's potential of a rectangle's corner: x asinh(y/|x|) + y asinh(x/|y|)."""
    along = x * math.asinh(y / abs(x)) if x != 0.0 else 0.0
    return along + (y * math.asinh(x / abs(y)) if y != 0.0 else 0.0)


@jit
def rectangle(x, y, c, d):
    """Integral of 1/rho over a rectangle 2c by 2d, seen from (x, y) off its centre (Love 1929)."""
    return corner(x + c, y + d) - corner(x + c, y - d) - corner(x - c, y + d) + corner(x - c, y - d)


@jit(fastmath=REORDER_SUMS)
def displacement(cells, pressure, first, last, out):
    """Displacement by a pressure, over the approach.

    The sum runs over the cells that carry load, each adding a stretch of `influence`. At 48 by 10
    cells that costs less than transforms, and it can be kept to the cells that matter.

    Parameters
    ----------
    pressure : ndarray (m, n)
    first, last : ndarray (m,)
        Cells of each row outside which there is no pressure and nothing is filled.
    out : ndarray (m, n)
    """
    m, n = pressure.shape
    for j in range(m):
        for i in range(first[j], last[j]):
            out[j, i] = 0.0
    for k in range(m):
        q, end = first[k], last[k]
        while q + 4 <= end:  # four at a time spare three passes over `out`
            p_0, p_1, p_2, p_3 = (
                pressure[k, q], pressure[k, q + 1], pressure[k, q + 2], pressure[k, q + 3]
            )  # fmt: skip
            if p_0 != 0.0 or p_1 != 0.0 or p_2 != 0.0 or p_3 != 0.0:
                for j in range(m):
                    for i in range(first[j], last[j]):
                        at = n - 1 - q + i
                        out[j, i] += (
                            p_0 * cells.influence[j, k, at]
                            + p_1 * cells.influence[j, k, at - 1]
                            + p_2 * cells.influence[j, k, at - 2]
                            + p_3 * cells.influence[j, k, at - 3]
                        )
            q += 4
        while q < end:
            for j in range(m):
                for i in range(first[j], last[j]):
                    out[j, i] += pressure[k, q] * cells.influence[j, k, n - 1 - q + i]
            q += 1


@jit
def contact_cells(log_kappa, low, high, n, m):
    """Cells of an ellipse with ln(a/b) = log_kappa, unworn pressure included.

    Parameters
    ----------
    low, high : float
        Ends along the major axis, over a.
    n, m : int
        Cells along it, and on each side of it.

    Returns
    -------
    status, cells
    """
    kappa = math.exp(log_kappa)
    K, _, s = elliptic_integrals(1.0 / kappa)
    dX, dY = (high - low) / n, 0.5 * FULL_WIDTH / m
    X, Y = low + dX * (np.arange(n) + 0.5), dY * (np.arange(m) + 0.5)
    gap, influence = np.empty((m, n)), np.empty((m, m, 2 * n - 1))
    for j in range(m):
        for i in range(n):
            gap[j, i] = s * X[i] * X[i] + (1.0 - s) * Y[j] * Y[j] - 1.0
    # p_0 a/(pi E*) over the approach, and the rectangle in units of a
    scale = kappa / (math.pi * K)
    c, d = 0.5 * dX, 0.5 * dY / kappa
    by_rows = np.empty(2 * m)  # by a cell so many rows away
    for q in range(n):
        for r in range(2 * m):
            by_rows[r] = scale * rectangle(q * 2.0 * c, r * 2.0 * d, c, d)
        for j in range(m):
            for k in range(m):  # and by its mirror image
                value = by_rows[abs(j - k)] + by_rows[j + k + 1]
                influence[j, k, n - 1 - q] = influence[j, k, n - 1 + q] = value
    fresh = np.zeros((m, n))
    for j in range(m):
        for i in range(n):
            fresh[j, i] = math.sqrt(max(1.0 - X[i] * X[i] - Y[j] * Y[j], 0.0))
    cells = Cells(
        X=X, Y=Y, gap=gap, influence=influence, fresh=fresh, area=2.0 * dX * dY, log_kappa=log_kappa
    )
    status, _ = worn_pressure(cells, np.zeros(n), contact_buffers(n, m), fresh)
    return status, cells


@jit
def contact_buffers(n, m):
    """ContactBuffers for n by m cells."""
    return ContactBuffers(
        gap=np.empty((m, n)),
        direction=np.empty((m, n)),
        response=np.empty((m, n)),
        first=np.empty(m, dtype=np.int64),
        last=np.empty(m, dtype=np.int64),
    )


@jit(fastmath=REORDER_SUMS)
def gap_of(cells, wear, pressure, work):
    """Gap under a pressure, over the approach, into `work.gap` between `first` and `last`."""
    displacement(cells, pressure, work.first, work.last, work.gap)
    for j in range(cells.Y.size):
        for i in range(work.first[j], work.last[j]):
            work.gap[j, i] += cells.gap[j, i] + wear[i]


@jit
def whole_range(first, last, n):
    """Set the ends of all rows to those of the cells."""
    for j in range(first.size):
        first[j], last[j] = 0, n


@jit
def loaded_range(pressure, first, last):
    """Fill the ends of the stretch with pressure of each row, the last one beyond it."""
    m, n = pressure.shape
    for j in range(m):
        first[j], last[j] = n, 0
        for i in range(n):
            if pressure[j, i] > 0.0:
                first[j], last[j] = min(first[j], i), i + 1
        first[j] = min(first[j], last[j])


@jit
def open_cells(cells, g, pressure):
    """Give pressure to cells that overlap without; whether there were any."""
    m, n = pressure.shape
    found = False
    for j in range(m):
        own = cells.influence[j, j, n - 1]
        for i in range(n):
            if not pressure[j, i] > 0.0 and not g[j, i] >= -CLOSED_GAP:  # NaN too
                pressure[j, i] = -g[j, i] / own
                found = True
    return found


@jit(fastmath=REORDER_SUMS)
def conjugate_gradients(cells, wear, pressure, work, most):
    """Lessen the gap where there is pressure until it vanishes there; cells may let go.

    Returns
    -------
    int
        Iterations.
    """
    g, t, r, first, last = work.gap, work.direction, work.response, work.first, work.last
    loaded_range(pressure, first, last)
    gap_of(cells, wear, pressure, work)
    m, n = pressure.shape
    for j in range(m):
        for i in range(n):
            t[j, i] = 0.0
    before = math.inf
    for iteration in range(most):
        size = 0.0
        for j in range(m):
            for i in range(first[j], last[j]):
                left = g[j, i] if pressure[j, i] > 0.0 else 0.0
                size += left * left
        if size <= CLOSED_GAP * CLOSED_GAP:
            return iteration
        share = size / before
        before = size
        for j in range(m):
            for i in range(first[j], last[j]):
                t[j, i] = g[j, i] + share * t[j, i] if pressure[j, i] > 0.0 else 0.0
        displacement(cells, t, first, last, r)
        above = below = 0.0
        for j in range(m):
            for i in range(first[j], last[j]):
                above += g[j, i] * t[j, i]
                below += r[j, i] * t[j, i]
        step = above / below
        released = 0
        for j in range(m):
            for i in range(first[j], last[j]):
                g[j, i] -= step * r[j, i]
                new = pressure[j, i] - step * t[j, i]
                released += 1 if new < 0.0 else 0
                pressure[j, i] = max(new, 0.0)
        if released > 0:
            gap_of(cells, wear, pressure, work)
            before = math.inf
    return most


@jit
def worn_pressure(cells, wear, work, pressure):
    """Pressure of a worn contact at a given approach.

    Conjugate gradients after Polonsky and Keer, Wear 231 (1999) 206, without their constraint on
    the load.

    Parameters
    ----------
    cells : Cells
    wear : ndarray (n,)
        Depth at the cells beyond what the approach is counted from, over the approach.
    work : ContactBuffers
        Its `gap` is that of the answer.
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
        whole_range(work.first, work.last, cells.X.size)
        gap_of(cells, wear, pressure, work)
        if total <= MOST_GRADIENTS and not open_cells(cells, work.gap, pressure):
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
