"""Cells of a worn contact and how they deform under each other's pressure (theory.md section 17).

The half space is cut into equal rectangles of uniform pressure; half of them do, since the contact
is even across. Those that carry load, and the ones around them, are *at hand*: in each row the
cells from `first` up to `last`. Their influence on each other is written out as a matrix once, and
kept as long as the contact stays within them.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.decorators import REORDER_SUMS, inlined, jit
from bearingwear.kernels.linear import solve_in_place

MARGIN = 1  # cells around those with load that are at hand too
MOST_WRITTEN = 500  # cells at hand that a matrix is written for
ROOMY = 1.2  # times as many cells at hand as needed are too many
PATCH = 2  # cells on each side of one, of which `nearby` is found
DOMINANT = 0.95  # largest share of a cell in `nearby` that the cells about it may have together


class Cells(NamedTuple):
    """Equal rectangles over half of a contact (it is even in Y), and what they are unworn."""

    X: np.ndarray  # (n,) centres along the major axis, over a
    Y: np.ndarray  # (m,) across, over b, all positive
    gap: np.ndarray  # (m, n) of the unworn bodies that only just touch, less 1, over the approach
    influence: np.ndarray  # (m, m, 2n - 1) approaches a row gets by the unit pressures of another
    nearby: np.ndarray  # (2, 2) pressure of a cell and those next to it that lifts the cell alone
    fresh: np.ndarray  # (m, n) pressure unworn, over the peak of Hertz
    area: float  # of a cell and its mirror image, over a b
    log_kappa: float  # ln(a/b)


class ContactBuffers(NamedTuple):
    """Arrays of a solve."""

    gap: np.ndarray  # (m, n) at hand
    direction: np.ndarray  # (m, n)
    response: np.ndarray  # (m, n)
    steep: np.ndarray  # (m, n)
    first: np.ndarray  # (m,) first cell of each row that is at hand
    last: np.ndarray  # (m,) and the one after the last
    packed: np.ndarray  # (most written,) pressure of the cells at hand, row after row
    moved: np.ndarray  # (most written,) their displacement
    written: np.ndarray  # (most written squared,) influence of the cells at hand, row after row


@inlined
def contact_buffers(n, m):
    """ContactBuffers for n by m cells, none of them at hand."""
    most = min(n * m, MOST_WRITTEN)
    return ContactBuffers(
        gap=np.zeros((m, n)),
        direction=np.zeros((m, n)),
        response=np.zeros((m, n)),
        steep=np.zeros((m, n)),
        first=np.zeros(m, dtype=np.int64),
        last=np.zeros(m, dtype=np.int64),
        packed=np.empty(most),
        moved=np.empty(most),
        written=np.empty(most * most),
    )


@jit
def corner(x, y):
    """Love's potential of a rectangle's corner: x asinh(y/|x|) + y asinh(x/|y|)."""
    along = x * math.asinh(y / abs(x)) if x != 0.0 else 0.0
    return along + (y * math.asinh(x / abs(y)) if y != 0.0 else 0.0)


@jit
def rectangle(x, y, c, d):
    """Integral of 1/rho over a rectangle 2c by 2d, seen from (x, y) off its centre (Love 1929)."""
    return corner(x + c, y + d) - corner(x + c, y - d) - corner(x - c, y + d) + corner(x - c, y - d)


@jit
def fill_influence(scale, c, d, influence):
    """Fill `Cells.influence` of rectangles 2c by 2d in units of a."""
    m, n = influence.shape[0], (influence.shape[2] + 1) // 2
    by_rows = np.empty(2 * m)  # by a cell so many rows away
    for q in range(n):
        for r in range(2 * m):
            by_rows[r] = scale * rectangle(q * 2.0 * c, r * 2.0 * d, c, d)
        for j in range(m):
            for k in range(m):  # and by its mirror image
                value = by_rows[abs(j - k)] + by_rows[j + k + 1]
                influence[j, k, n - 1 - q] = influence[j, k, n - 1 + q] = value


@jit
def nearby_pressure(scale, c, d):
    """Pressures of a cell and its neighbours that nearly lift the cell alone.

    The inverse of the half space is steep: 1/rho^3. Its middle, found on a patch of cells, is what
    conjugate gradients need to take all wavelengths at once.

    Returns
    -------
    ndarray (2, 2)
        Of the cell itself, of the next along [0, 1], across [1, 0], and over the corner.
    """
    side = 2 * PATCH + 1
    size = side * side
    matrix, lift = np.empty((size, size)), np.zeros(size)
    for p in range(size):
        for q in range(size):
            x, y = 2.0 * c * (p % side - q % side), 2.0 * d * (p // side - q // side)
            matrix[p, q] = scale * rectangle(x, y, c, d)
    middle = PATCH * side + PATCH
    lift[middle] = 1.0
    solve_in_place(matrix, lift, size)
    along, across, both = lift[middle + 1], lift[middle + side], lift[middle + side + 1]
    around = 2.0 * abs(along) + 2.0 * abs(across) + 4.0 * abs(both)
    part = min(1.0, DOMINANT * lift[middle] / around)  # else it might not be positive
    nearby = np.empty((2, 2))
    nearby[0, 0], nearby[0, 1] = lift[middle], part * along
    nearby[1, 0], nearby[1, 1] = part * across, part * both
    return nearby


@jit(fastmath=REORDER_SUMS)
def place_at_hand(cells, pressure, work):
    """Make sure that the cells with pressure, and those around them, are at hand."""
    m, n = pressure.shape
    first, last = work.first, work.last
    count = needed = 0
    covered = True
    for j in range(m):
        start, end = loaded_stretch(pressure, j)
        if end > start:
            needed += min(end + MARGIN, n) - max(start - MARGIN, 0)
            covered = covered and first[j] <= start and end <= last[j]
        count += last[j] - first[j]
    if covered and 0 < count <= ROOMY * needed:
        return
    for j in range(m):
        first[j], last[j] = n, 0
    for j in range(m):
        start, end = loaded_stretch(pressure, j)
        if end > start:
            for k in range(max(j - MARGIN, 0), min(j + MARGIN + 1, m)):
                first[k] = min(first[k], max(start - MARGIN, 0))
                last[k] = max(last[k], min(end + MARGIN, n))
    for j in range(m):
        first[j] = min(first[j], last[j])
    if at_hand(work) <= work.packed.size:
        write_influence(cells, work)


@jit
def loaded_stretch(pressure, j):
    """First cell with pressure in row j, and the one after the last."""
    start, end = pressure.shape[1], 0
    for i in range(pressure.shape[1]):
        if pressure[j, i] > 0.0:
            start, end = min(start, i), i + 1
    return start, end


@jit
def at_hand(work):
    """Number of cells at hand."""
    count = 0
    for j in range(work.first.size):
        count += work.last[j] - work.first[j]
    return count


@jit
def write_influence(cells, work):
    """Fill `work.written`."""
    m, n, place = cells.Y.size, cells.X.size, 0
    for j in range(m):
        for i in range(work.first[j], work.last[j]):
            for k in range(m):
                start = n - 1 - i + work.first[k]
                count = work.last[k] - work.first[k]
                copy_stretch(cells.influence[j, k], start, count, work.written, place)
                place += count


@jit
def copy_stretch(values, start, count, out, place):
    """Copy `count` values from `start` on to `place` on."""
    p, q = max(start, 0), max(place, 0)
    for k in range(count):
        out[q + k] = values[p + k]


@jit(fastmath=REORDER_SUMS)
def displacement(cells, pressure, work, out):
    """Displacement of the cells at hand by a pressure within them, over the approach.

    Summed directly: at some hundred cells that costs less than transforms.
    """
    first, last, count = work.first, work.last, at_hand(work)
    if count > work.packed.size:
        plain_displacement(cells, pressure, first, last, out)
        return
    place = 0
    for j in range(first.size):
        for i in range(first[j], last[j]):
            work.packed[place] = pressure[j, i]
            place += 1
    product(work.written, work.packed, count, work.moved)
    place = 0
    for j in range(first.size):
        for i in range(first[j], last[j]):
            out[j, i] = work.moved[place]
            place += 1


@jit(fastmath=REORDER_SUMS)
def product(matrix, vector, n, out):
    """Matrix, row after row, by vector, of n each."""
    start = 0
    for row in range(n):
        total = 0.0
        for k in range(n):
            total += matrix[start + k] * vector[k]
        out[row] = total
        start += n


@jit(fastmath=REORDER_SUMS)
def plain_displacement(cells, pressure, first, last, out):
    """`displacement` without a matrix."""
    m, n = pressure.shape
    for j in range(m):
        for i in range(first[j], last[j]):
            out[j, i] = displacement_at(cells, pressure, first, last, j, i)


@jit(fastmath=REORDER_SUMS)
def displacement_at(cells, pressure, first, last, j, i):
    """Displacement of one cell by a pressure within `first` and `last`, over the approach."""
    total = 0.0
    for k in range(first.size):
        total += stretch_sum(
            pressure[k], cells.influence[j, k], first[k], cells.X.size - 1 - i, last[k] - first[k]
        )
    return total


@jit(fastmath=REORDER_SUMS)
def stretch_sum(pressure, influence, first, shift, count):
    """Displacement by `count` cells of a row from `first` on; `shift`: of `influence` to them."""
    p, q = max(first, 0), max(first + shift, 0)
    total = 0.0
    for k in range(count):
        total += pressure[p + k] * influence[q + k]
    return total
