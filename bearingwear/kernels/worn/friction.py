"""Friction and wear of a ball between two worn grooves (theory.md section 21).

The friction of a worn contact is that of the Hertz contact it would be unworn, by the rule of the
ellipse, and what its cells add to it: those worn less those unworn. Without wear nothing is added.
The friction of cells is rounded below a slip that they resolve.
"""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.contact.film_friction import add_even_part, even_dissipation
from bearingwear.kernels.contact.friction import force_slope, friction_capacity
from bearingwear.kernels.contact.points import Points, area_shares, contact_points, point_buffers
from bearingwear.kernels.contact.profile import contact_load, profile
from bearingwear.kernels.contact.slip import (
    dissipation,
    hertz_contact,
    point_slip,
    slip_coefficients,
    slip_map,
    surface_height,
)
from bearingwear.kernels.contact.traction import (
    store_slopes,
    store_traction_slopes,
    traction_slope,
)
from bearingwear.kernels.decorators import REORDER_SUMS, jit
from bearingwear.kernels.linear import copy, solve_in_place
from bearingwear.kernels.status import NOT_CONVERGED, OK
from bearingwear.kernels.steady.balance import (
    add_gyration_and_drag,
    balance_share,
    subtract_gradient,
    subtract_projected,
)
from bearingwear.kernels.steady.level_solver import DESCENT, NEWTON_STEPS, STALLED

FRICTION_LEFT = 1e-12  # as a share of the friction forces, where Newton ends [1]
LEVELS = (2, 5)  # of v_r, each
LEVEL_RATIO = 4.0  # times the next, where Newton fails from the last motion; fewer are tried first
TRIES = 6  # along a step, of half the length each
NATURAL_DESCENT = 0.25  # share of the promised decrease of the next step that a step must bring
OF_UNWORN, OF_WORN = range(2)
# Rows of the cells written down: place x/a, share of the load, height and place across [m], number
# of the cell along the major axis, share of the friction, how many cells there are.
CELL_X, CELL_WEIGHT, CELL_HEIGHT, CELL_WIDTH, CELL_COLUMN, CELL_FRICTION, CELL_COUNT = range(7)
CELL_ROUNDING = 0.2  # of what slip changes by over a cell at the contact's edge
THIN_PRESSURE = 0.3  # of Hertz' peak: cells with less count in proportion to the area in contact


class FrictionWork(NamedTuple):
    """Buffers of the friction balance."""

    points: Points
    gradient: np.ndarray  # (5,), with the force along the major axis
    hessian: np.ndarray  # (5, 5)
    part_gradient: np.ndarray
    part_hessian: np.ndarray
    L: np.ndarray  # (4, 4)
    residual: np.ndarray  # (4,)
    jacobian: np.ndarray  # (4, 4) with the points of the ellipse held
    moving: np.ndarray  # (4, 4) what is added to it as these follow the motion, by earlier steps
    earlier: np.ndarray  # residual (4,) and, below, jacobian before a step
    matrix: np.ndarray
    step: np.ndarray
    trial: np.ndarray
    ones: np.ndarray  # (2,) the two sides of the cells: places,
    halves: np.ndarray  # (2,) and shares
    h_along: np.ndarray  # (most cells along,) heights of the cells unworn
    cells: np.ndarray  # (race, unworn or worn, row as below, most cells)
    rounded: np.ndarray  # (2,) slip below which the friction of cells is rounded [m/s]
    slip: np.ndarray  # (race, 5) of a state: QV [W], heat [W], gyroscopic share [1],
    # torque of the race [N m] and friction coefficient, mean over the load [1]
    rates: np.ndarray  # (race, most cells along) its QV per length [W/m], scaled to the sum


def friction_work(rule, n, m_cells):
    """Buffers for a rule and n by m_cells cells at the most."""
    ones = np.ones(2)
    ones[1] = -1.0
    return FrictionWork(
        points=point_buffers(rule), gradient=np.empty(5), hessian=np.empty((5, 5)),
        part_gradient=np.empty(5), part_hessian=np.empty((5, 5)), L=np.empty((4, 4)),
        residual=np.empty(4), jacobian=np.empty((4, 4)), moving=np.zeros((4, 4)),
        earlier=np.empty((5, 4)), matrix=np.empty((4, 4)), step=np.empty(4), trial=np.empty(4),
        ones=ones, halves=np.full(2, 0.5), h_along=np.empty(n),
        cells=np.zeros((2, 2, 7, n * m_cells)), rounded=np.zeros(2), slip=np.zeros((2, 5)),
        rates=np.zeros((2, n)),
    )  # fmt: skip


@jit
def unworn_contact(g, op, k, force):
    """The Hertz contact that a worn one is counted from."""
    Q = contact_load(force.hertz.K, force.approach)
    return hertz_contact(g, op, k, Q, force.alpha, force.hertz)


@jit
def place_cells(g, D, op, races, seat, work):
    """Write down the cells with load of both contacts, worn and unworn, for the sums over them."""
    for k in range(2):
        race, force = (races[0], seat.inner) if k == 0 else (races[1], seat.outer)
        contact = unworn_contact(g, op, k, force)
        surface_height(contact, 0.5 * D, race.cells.X, work.h_along)
        total = race.cells.fresh.sum()
        work.rounded[k] = slip_of_a_cell(g, D, op, race.cells, contact)
        for worn in range(2):
            pressure = race.pressure if worn == OF_WORN else race.cells.fresh
            fill_cells(race, pressure, worn, contact.b, total, work, work.cells[k, worn])
            if contact.mu_even > 0.0 or race.without >= 0.0:
                film_friction(race, pressure, worn, contact, total, work.cells[k, worn])


@jit
def slip_of_a_cell(g, D, op, cells, contact):
    """Slip below which friction of cells is rounded (theory.md Eq. 87) [m/s].

    Over a cell the curvature of the contact changes slip by more than v_r: sums over cells would
    jump where a line of pure rolling passes one.
    """
    rolling = abs(op.omega_i - op.omega_o) * 0.5 * g.dm / D
    dx = contact.a * (cells.X[1] - cells.X[0])
    return CELL_ROUNDING * rolling * contact.a * dx / profile(contact.r_g, 0.5 * D, contact.a).R_d


@jit
def area_in_contact(pressure):
    """Cells in contact; those with little pressure in proportion, so that none comes at once."""
    area = 0.0
    for j in range(pressure.shape[0]):
        for i in range(pressure.shape[1]):
            area += min(pressure[j, i] / THIN_PRESSURE, 1.0)
    return area


@jit
def film_friction(race, pressure, worn, contact, total, cells):
    """Shares of friction of cells: a film's, its even part by their area, or bare.

    Parameters
    ----------
    contact : Contact
        The unworn one, whose friction the shares are of.
    total : float
        Sum of the unworn pressure.
    cells : ndarray
        Rows of the cells with load.
    """
    in_contact, constant = area_in_contact(race.cells.fresh), contact.mu - contact.mu_even
    for p in range(int(cells[CELL_COUNT, 0])):
        load = cells[CELL_WEIGHT, p]
        area = min(load * total / THIN_PRESSURE, 1.0) / in_contact
        friction = constant * load + contact.mu_even * area
        if worn == OF_WORN and race.without >= 0.0:
            bare = race.bare[int(cells[CELL_COLUMN, p])]
            friction += bare * (race.without * load - friction)
        cells[CELL_FRICTION, p] = friction / contact.mu


@jit
def fill_cells(race, pressure, worn, b, total, work, cells):
    """The cells of one contact into the rows of `cells`."""
    n, count = race.cells.X.size, 0
    for j in range(race.cells.Y.size):
        for i in range(n):
            if pressure[j, i] != 0.0:  # NaN too
                cells[CELL_X, count] = race.cells.X[i]
                cells[CELL_WEIGHT, count] = pressure[j, i] / total
                cells[CELL_HEIGHT, count] = work.h_along[i] + (
                    race.rise[i] if worn == OF_WORN else 0.0
                )
                cells[CELL_WIDTH, count] = b * race.cells.Y[j]
                cells[CELL_COLUMN, count] = i
                cells[CELL_FRICTION, count] = cells[CELL_WEIGHT, count]
                count += 1
    cells[CELL_COUNT, 0] = count


@jit
def loaded_cells(cells):
    """Places, shares of load and of friction, heights, widths, columns of cells written down."""
    n = int(cells[CELL_COUNT, 0])
    return (
        cells[CELL_X, :n],
        cells[CELL_WEIGHT, :n],
        cells[CELL_FRICTION, :n],
        cells[CELL_HEIGHT, :n],
        cells[CELL_WIDTH, :n],
        cells[CELL_COLUMN, :n],
    )


@jit(fastmath=REORDER_SUMS)
def cell_slopes(a, c, v_r, cells):
    """Sums of `ellipse_slopes` over cells and their mirror images.

    Its loop over the points across would be too short for vector instructions.

    Returns
    -------
    gradient, by_c_1, by_others, traction : tuples of 5, 4, 6 and 5 floats
        As `store_slopes` and `store_traction_slopes` take them.
    """
    v_r2 = v_r * v_r
    c_1, c_0, c_h, c_x = c
    g_1 = g_0 = g_h = g_x = g_t = 0.0
    p_00 = p_0h = p_0x = p_hh = p_hx = p_xx = 0.0
    s_0 = s_h = s_x = s_1 = 0.0
    t_1 = t_0 = t_x = t_t = 0.0
    for k in range(cells.shape[1]):
        h, x, y = cells[CELL_HEIGHT, k], a * cells[CELL_X, k], cells[CELL_WIDTH, k]
        load = 0.5 * cells[CELL_FRICTION, k]
        v2, gyroscopic, spin = c_0 + c_h * h + c_x * x, c_1 * h, c_x * y
        f, p_11, p_12, p_22 = force_slope(load, gyroscopic - spin, v2, v_r2)
        m_f, m_11, m_12, m_22 = force_slope(load, gyroscopic + spin, v2, v_r2)
        upper, lower = f * (gyroscopic - spin), m_f * (gyroscopic + spin)
        f1, f1y, f2 = upper + lower, (upper - lower) * y, (f + m_f) * v2
        q_11, q_12, q_22 = p_11 + m_11, p_12 + m_12, p_22 + m_22
        q_11y, q_12y = (p_11 - m_11) * y, (p_12 - m_12) * y
        by_x, across_by_x = q_22 * x - q_12y, q_12 * x - q_11y
        g_t += f1
        g_1 += f1 * h
        g_0 += f2
        g_h += f2 * h
        g_x += f2 * x - f1y
        p_00 += q_22
        p_0h += q_22 * h
        p_hh += q_22 * h * h
        p_0x += by_x
        p_hx += by_x * h
        p_xx += by_x * x - q_12y * x + q_11 * y * y
        s_0 += q_12 * h
        s_h += q_12 * h * h
        s_x += across_by_x * h
        s_1 += q_11 * h * h
        t_t += q_11
        t_1 += q_11 * h
        t_0 += q_12
        t_x += across_by_x
    return (
        (g_1, g_0, g_h, g_x, g_t),
        (s_1, s_0, s_h, s_x),
        (p_00, p_0h, p_0x, p_hh, p_hx, p_xx),
        (t_1, t_0, s_0, t_x, t_t),
    )


@jit
def worn_slope(k, contact, R, c, v_r, rule, work):
    """Gradient and second derivatives of the friction potential of a worn contact, into `work`."""
    points = contact_points(rule, contact, R, c, v_r, work.points)
    mu = contact.mu - contact.mu_even
    traction_slope(contact, c, mu, v_r, points, work.gradient, work.hessian)
    if contact.mu_even > 0.0:
        add_even_part(
            rule, contact, R, c, v_r, points, work.part_gradient, work.part_hessian, work.gradient,
            work.hessian, True,
        )  # fmt: skip
    rounded = math.hypot(v_r, work.rounded[k])
    for worn in range(2):
        cells = work.cells[k, worn, :, : int(work.cells[k, worn, CELL_COUNT, 0])]
        scale = contact.mu * contact.Q * (1.0 if worn == OF_WORN else -1.0)
        g, s, p, t = cell_slopes(contact.a, c, rounded, cells)
        store_slopes(scale, g[:4], s, p, work.part_gradient, work.part_hessian)
        store_traction_slopes(scale, g[4], t, work.part_gradient, work.part_hessian)
        for i in range(5):
            work.gradient[i] += work.part_gradient[i]
            for j in range(5):
                work.hessian[i, j] += work.part_hessian[i, j]


@jit
def worn_friction_balance(g, op, D, seat, v_r, rule, work, u, out):
    """Moments and orbital moment on a ball, and their derivatives by u into `work.jacobian`.

    As `steady_balance.friction_balance`, with worn contacts: those of `place_cells`.

    Returns
    -------
    F_i, F_o : float
        Friction of the races on the ball along the first contact axes [N].
    """
    F_i = 0.0
    r, R = g.R_o + seat.X2, 0.5 * D
    out[:] = 0.0
    work.jacobian[:, :] = 0.0
    for k in range(2):
        contact = unworn_contact(g, op, k, seat.inner if k == 0 else seat.outer)
        c = slip_coefficients(contact, u, r)
        worn_slope(k, contact, R, c, v_r, rule, work)
        slip_map(contact, r, work.L)
        subtract_projected(work.L, work.hessian, work.jacobian)
        subtract_gradient(work.L, work.gradient, out)
        if k == 0:
            F_i = work.gradient[4]
    add_gyration_and_drag(g, D, op, u, r, out, work.jacobian, True)
    return F_i, work.gradient[4]


@jit
def improve_moving(work, damping):
    """What the last step shows of `moving`: Broyden's update beside the mean jacobian."""
    size = 0.0
    for j in range(4):
        work.step[j] *= damping
        size += work.step[j] * work.step[j]
    for i in range(4):
        unexplained = work.residual[i] - work.earlier[0, i]
        for j in range(4):
            mean = 0.5 * (work.jacobian[i, j] + work.earlier[1 + i, j])
            unexplained -= (mean + work.moving[i, j]) * work.step[j]
        for j in range(4):
            work.moving[i, j] += unexplained * work.step[j] / size


@jit
def natural_share(g, op, D, seat, v_r, rule, work, u, tries):
    """How much of `work.step` leads nearer to the root, though residuals grow; zero for none.

    With the same derivatives, the next step is then shorter (Deuflhard's natural monotonicity). At
    a small v_r one direction is so much softer than the others that the residual tells nothing.
    """
    length = math.sqrt(squared(work.step))
    share = 1.0
    for _ in range(tries):
        for i in range(4):
            work.trial[i] = u[i] + share * work.step[i]
        worn_friction_balance(g, op, D, seat, v_r, rule, work, work.trial, work.residual)
        for i in range(4):
            work.trial[i] = -work.residual[i]
            for j in range(4):
                work.matrix[i, j] = work.earlier[1 + i, j] + work.moving[i, j]
        if not solve_in_place(work.matrix, work.trial, 4):
            return 0.0
        if math.sqrt(squared(work.trial)) < (1.0 - NATURAL_DESCENT * share) * length:
            return share
        share *= 0.5
    return 0.0


@jit
def squared(values):
    """Sum of squares."""
    found = 0.0
    for i in range(values.size):
        found += values[i] * values[i]
    return found


@jit
def friction_newton(g, op, D, seat, v_r, rule, work, u):
    """The ball's motion with the loads held, by damped Newton; u is improved in place.

    Returns
    -------
    status, F_i, F_o
        Friction as in `worn_friction_balance`.
    """
    r, out = g.R_o + seat.X2, work.residual
    mu_i, mu_o = unworn_contact(g, op, 0, seat.inner).mu, unworn_contact(g, op, 1, seat.outer).mu
    capacity = friction_capacity(mu_i, mu_o, seat.inner.Q, seat.outer.Q)
    F_i, F_o = worn_friction_balance(g, op, D, seat, v_r, rule, work, u, out)
    size = balance_share(D, r, capacity, out)
    learned = True  # whether `moving` may be what leads the wrong way
    for _ in range(NEWTON_STEPS):
        if size <= FRICTION_LEFT:
            return OK, F_i, F_o
        for i in range(4):
            work.step[i], work.earlier[0, i] = -out[i], out[i]
            for j in range(4):
                work.earlier[1 + i, j] = work.jacobian[i, j]
                work.matrix[i, j] = work.jacobian[i, j] + work.moving[i, j]
        damping, found, new = 1.0, False, size
        T_i, T_o = F_i, F_o
        solved = solve_in_place(work.matrix, work.step, 4)
        if solved:
            for _ in range(2 if learned else TRIES):
                for i in range(4):
                    work.trial[i] = u[i] + damping * work.step[i]
                T_i, T_o = worn_friction_balance(g, op, D, seat, v_r, rule, work, work.trial, out)
                new = balance_share(D, r, capacity, out)
                if new < (1.0 - DESCENT * damping) * size or new <= FRICTION_LEFT:
                    found = True
                    break
                damping *= 0.5
                if size <= STALLED:
                    break
        if solved and not found and (size <= STALLED or not learned):
            tries = 1 if size <= STALLED else TRIES
            damping = natural_share(g, op, D, seat, v_r, rule, work, u, tries)
            if damping > 0.0:
                for i in range(4):
                    work.trial[i] = u[i] + damping * work.step[i]
                T_i, T_o = worn_friction_balance(g, op, D, seat, v_r, rule, work, work.trial, out)
                new, found = balance_share(D, r, capacity, out), True
        if found:
            if size > STALLED:
                improve_moving(work, damping)
                learned = True
            copy(work.trial, u)
            size, F_i, F_o = new, T_i, T_o
        elif learned and size > STALLED:
            learned = False
            work.moving[:, :] = 0.0
            copy(work.earlier[0], out)
            for i in range(4):
                copy(work.earlier[1 + i], work.jacobian[i])
        else:
            break
    return (OK if size <= STALLED else NOT_CONVERGED), F_i, F_o


@jit
def settled_motion(g, op, D, seat, rule, work, u):
    """`friction_newton` at the wanted v_r; where that fails from u, down from a larger one."""
    kept = u.copy()
    found = friction_newton(g, op, D, seat, op.v_r, rule, work, u)
    if found[0] == OK:
        return found
    for levels in LEVELS:
        copy(kept, u)
        for level in range(levels, -1, -1):
            v_r = op.v_r * LEVEL_RATIO**level
            found = friction_newton(g, op, D, seat, v_r, rule, work, u)
        if found[0] == OK:
            break
    return found


@jit
def scale_rates(rates, qv, race):
    """Scale QV along the cells of a race so that its integral is `qv` [W]."""
    found = 0.0
    n, step = race.x.size, race.x[1] - race.x[0]
    for i in range(n):
        found += rates[i]
    if found > 0.0:
        for i in range(n):
            rates[i] *= qv / (found * step)


@jit
def worn_dissipation(g, op, D, races, seat, rule, work, u):
    """QV and heat of both contacts into `work.slip`, and their distribution into `work.rates`."""
    r, R, out, rates = g.R_o + seat.X2, 0.5 * D, work.slip, work.rates
    place_cells(g, D, op, races, seat, work)
    for k in range(2):
        race, force = (races[0], seat.inner) if k == 0 else (races[1], seat.outer)
        contact = unworn_contact(g, op, k, force)
        c = slip_coefficients(contact, u, r)
        points = contact_points(rule, contact, R, c, op.v_r, work.points)
        mu = contact.mu - contact.mu_even
        qv, heat, gyro, torque = dissipation(contact, c, mu, op.v_r, r, points)
        gyro *= qv
        if contact.mu_even > 0.0:
            area_shares(rule, contact, R, c, op.v_r, points)
            even_heat, even_torque = even_dissipation(contact, c, op.v_r, r, points)
            heat += even_heat
            torque += even_torque
        rounded = math.hypot(op.v_r, work.rounded[k])
        for worn in range(2):
            t, weight, friction, h, width, column = loaded_cells(work.cells[k, worn])
            cells = Points(
                t=t, weight=weight, h=h, width=width, across=work.ones, share=work.halves
            )
            part = dissipation(contact, c, contact.mu, rounded, r, cells)
            sign = 1.0 if worn == OF_WORN else -1.0
            qv += sign * part[0]
            gyro += sign * part[2] * part[0]
            out[k, 4] = contact.mu * (friction.sum() / weight.sum())
            if contact.mu_even > 0.0 or race.without >= 0.0:
                rubbing = Points(
                    t=t, weight=friction, h=h, width=width, across=work.ones, share=work.halves
                )
                part = dissipation(contact, c, contact.mu, rounded, r, rubbing)
            heat += sign * part[1]
            torque += sign * part[3]
        rates[k, :] = 0.0
        for p in range(t.size):  # of the worn cells
            v1, v2 = point_slip(c, h[p], contact.a * t[p])
            spin = c[3] * width[p]
            slip = math.hypot(v1 - spin, v2) + math.hypot(v1 + spin, v2)
            rates[k, int(column[p])] += 0.5 * weight[p] * slip
        out[k, 0], out[k, 1] = qv, heat
        out[k, 2], out[k, 3] = gyro / qv if qv > 0.0 else 0.0, torque
        scale_rates(rates[k], qv, race)
