"""What a run in time leaves behind: sums for averages, histories, checks of every instant kept."""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.cage import CAGE, INNER_TORQUE
from bearingwear.kernels.compile import jit
from bearingwear.kernels.contact import slip, slip_coefficients, surface_height
from bearingwear.kernels.hertz import INNER, OUTER, race_contact
from bearingwear.kernels.integrators import Tally, advance
from bearingwear.kernels.motion import BALL, motion_rates
from bearingwear.kernels.params import BallState, Contact
from bearingwear.kernels.quasistatic import sweep
from bearingwear.kernels.race import axial_stiffness
from bearingwear.kernels.status import OK
from bearingwear.kernels.steady import Workspace, drag_force, workspace
from bearingwear.kernels.summary import COLUMNS, LOAD, QV, TORQUE, contact_summary
from bearingwear.kernels.verification import polygon_residual

# Columns of Record.ball and Record.whole.
W_X, W_Y, W_Z, OMEGA, RADIUS, AXIAL, CENTRIFUGAL = range(7)
SHIFT, PRELOAD, INNER_RACE_TORQUE, DRAG_POWER, STIFFNESS, CAGE_SPEED = 0, 3, 4, 5, 6, 7
# Columns of History.cage: position, tilt, speed.
POSITION, TILT, SPEED = 0, 3, 6


class History(NamedTuple):
    """Instants and what was found there; powers are means over the interval that ends there."""

    time: np.ndarray  # (T,) [s]
    load: np.ndarray  # (T, n, 2) [N]
    slip: np.ndarray  # (T, n, 2) mean slip QV/Q at the instant [m/s]
    qv: np.ndarray  # (T, n, 2) [W]
    lead: np.ndarray  # (T, n) of a ball before the middle of its pocket [rad]
    preload: np.ndarray  # (T,) [N]
    displacement: np.ndarray  # (T, 3) [m]
    cage: np.ndarray  # (T, 7)
    force: np.ndarray  # (T, n + 2) normal forces of pockets and land edges [N]
    pocket_power: np.ndarray  # (T, n) normal force times slip [W]
    land_power: np.ndarray  # (T,) [W]


class Record(NamedTuple):
    """Sums over the instants of a window."""

    rows: np.ndarray  # (n, 2, COLUMNS)
    slip: np.ndarray  # (2, n, 2, strips) along both axes [m/s]
    ball: np.ndarray  # (n, 7)
    whole: np.ndarray  # (8,)
    residual: np.ndarray  # (1,) largest normal balance left, a share of the largest load
    count: np.ndarray  # (1,) instants
    strips: np.ndarray  # positions x/a of the slip profiles
    before: np.ndarray  # integrals at the last instant
    row: np.ndarray  # (2, COLUMNS) buffer
    work: Workspace
    profile: np.ndarray  # (3, strips) buffer


@jit
def history(length, n):
    """Room for so many instants."""
    f = np.float32
    return History(
        np.zeros(length), np.zeros((length, n, 2), f), np.zeros((length, n, 2), f),
        np.zeros((length, n, 2), f), np.zeros((length, n), f), np.zeros(length, f),
        np.zeros((length, 3), f), np.zeros((length, 7), f), np.zeros((length, n + 2), f),
        np.zeros((length, n), f), np.zeros(length, f),
    )  # fmt: skip


@jit
def record(n, rule, strips, integrals):
    """Sums at zero, for n balls, an ellipse rule, the slip profiles at `strips`."""
    return Record(
        np.zeros((n, 2, COLUMNS)), np.zeros((2, n, 2, strips.size)), np.zeros((n, 7)), np.zeros(8),
        np.zeros(1), np.zeros(1, np.int64), strips, np.zeros(integrals), np.zeros((2, COLUMNS)),
        workspace(rule), np.zeros((3, strips.size)),
    )  # fmt: skip


@jit
def clear(out):
    """Begin a window anew."""
    out.rows[:, :, :] = 0.0
    out.slip[:, :, :, :] = 0.0
    out.ball[:, :] = 0.0
    out.whole[:] = 0.0
    out.residual[0] = 0.0
    out.count[0] = 0


@jit
def ball_state(run, b, j, Omega):
    """The equilibrium of ball j as the thrust solvers describe it."""
    g, s = run.g, b.s
    d = s.direction[j]
    force_x, force_r = b.cage.ball_force[j, 0], b.cage.ball_force[j, 2]
    return BallState(
        OK, s.X[j, 0], s.X[j, 1], math.atan2(d[0], d[1]), math.atan2(d[2], d[3]),
        s.Q[j, 0], s.Q[j, 1],
        race_contact(g, INNER, run.D[j], d[1], math.nan),
        race_contact(g, OUTER, run.D[j], d[3], math.nan),
        s.Q[j, 0] * d[0], s.Q[j, 0] * d[1], 0.0, 0.0, 0.0,
        force_x, force_r + run.mass[j] * b.r[j] * Omega**2, 0.0,
    )  # fmt: skip


@jit
def add_instant(y, run, b, places, out, keep, place, history):
    """Add the instant of the last `motion_rates` call to the sums, and to the history at `place`.

    Parameters
    ----------
    keep : bool
        Whether there is a history.
    """
    g, m, s = run.g, run.motion, b.s
    n = run.D.size
    largest = 0.0
    for j in range(n):
        largest = max(largest, s.Q[j, 0], s.Q[j, 1])
    race_x = race_y = race_z = torque = power = preload = mean_lead = 0.0
    for j in range(n):
        u = y[BALL * j : BALL * j + 4]
        psi = y[BALL * j + 4]
        sp, cp = math.sin(psi), math.cos(psi)
        state = ball_state(run, b, j, u[3])
        residual = polygon_residual(g, run.D[j], state, s.A[j, 0], s.A[j, 1], largest)
        out.residual[0] = max(out.residual[0], residual)
        contact_summary(
            g, run.D[j], m, state, u, b.r[j], run.rule, out.work, out.row
        )  # fmt: skip
        for k in range(2):
            row = out.row[k]
            for i in range(COLUMNS):
                out.rows[j, k, i] += row[i]
            if keep:
                history.load[place, j, k] = row[LOAD]
                history.slip[place, j, k] = row[QV] / row[LOAD] if row[LOAD] > 0.0 else 0.0
            if row[LOAD] > 0.0:
                outer = k == 1
                sigma, r_g, omega = (1.0, g.r_o, m.omega_o) if outer else (-1.0, g.r_i, m.omega_i)
                angle = state.alpha_o if outer else state.alpha_i
                contact = Contact(
                    sigma, row[LOAD], row[2], math.sin(angle), math.cos(angle), r_g, omega
                )
                surface_height(contact, 0.5 * run.D[j], out.strips, out.profile[2])
                c = slip_coefficients(contact, u, b.r[j])
                slip(contact, c, out.strips, out.profile[2], out.profile[0], out.profile[1])
                for i in range(out.strips.size):
                    out.slip[0, j, k, i] += out.profile[0, i]
                    out.slip[1, j, k, i] += out.profile[1, i]
        for i in range(4):
            out.ball[j, i] += u[i]
        out.ball[j, RADIUS] += b.r[j]
        out.ball[j, AXIAL] += state.F_ix
        out.ball[j, CENTRIFUGAL] += run.mass[j] * b.r[j] * u[3] ** 2
        race_x += state.F_ix
        race_y -= state.F_ir * sp
        race_z += state.F_ir * cp
        preload += state.F_ix
        torque += out.row[0, TORQUE]
        F_v, _ = drag_force(g, run.D[j], m.drag, u[3])
        power += F_v * b.r[j] * u[3]
        mean_lead += (psi - 2.0 * math.pi * j / n) / n
    land = b.cage.race_force
    left = max(abs(race_y - b.F[1] - land[0]), abs(race_z - b.F[2] - land[1]))
    if run.first == 0:
        left = max(left, abs(race_x - b.F[0]))
    if largest > 0.0:
        out.residual[0] = max(out.residual[0], left / (n * largest))
    matrix, step = np.empty((3, 3)), np.empty(3)
    sweep(
        g, run.D, run.mass, run.hertz, y[3 : BALL * n : BALL], y[4 : BALL * n : BALL], b.extra,
        b.land, b.F, run.tilt, 0, s, matrix, step,
    )  # fmt: skip
    whole = out.whole
    for i in range(3):
        whole[SHIFT + i] += s.delta[i]
    whole[PRELOAD] += preload
    whole[INNER_RACE_TORQUE] += torque + b.cage.sums[INNER_TORQUE]
    whole[DRAG_POWER] += power
    whole[STIFFNESS] += axial_stiffness(matrix)
    R = b.cage.R
    if run.cage.present:
        z = y[places.cage : places.cage + CAGE]
        whole[CAGE_SPEED] += (z[9] * R[0, 0] + z[10] * R[1, 0] + z[11] * R[2, 0]) / run.cage.I_x
    out.count[0] += 1
    if not keep:
        return
    for i in range(3):
        history.displacement[place, i] = s.delta[i]
    history.preload[place] = preload
    if run.cage.present:
        z = y[places.cage : places.cage + CAGE]
        mean_lead = math.atan2(-R[1, 2], R[2, 2])
        for i in range(3):
            history.cage[place, POSITION + i] = z[i]
        # The small turn that takes the X axis to the cage's.
        history.cage[place, TILT + 1] = -math.asin(R[2, 0])
        history.cage[place, TILT + 2] = math.asin(R[1, 0])
        along = z[9] * R[0, 0] + z[10] * R[1, 0] + z[11] * R[2, 0]
        history.cage[place, SPEED] = along / run.cage.I_x
        for i in range(n + 2):
            history.force[place, i] = b.cage.normal[i]
    for j in range(n):
        lead = y[BALL * j + 4] - 2.0 * math.pi * j / n - mean_lead
        history.lead[place, j] = lead - 2.0 * math.pi * math.floor(lead / (2.0 * math.pi) + 0.5)


@jit
def run_on(
    method,
    origin,
    dt,
    first,
    count,
    y,
    run,
    b,
    places,
    w,
    tolerance,
    h,
    longest,
    out,
    keep,
    place,
    history,
):
    """Integrate over `count` intervals of length dt, the first beginning at origin + first dt.

    Every interval's end is an instant of `out`, and of the history from `place` on.

    Returns
    -------
    Tally
        Of the whole; its `time` is the end of the last interval that was finished.
    """
    n = run.D.size
    accepted = rejected = evaluations = events = 0
    status = OK
    time = origin + first * dt
    for k in range(count):
        out.before[:] = y[places.qv :]
        start, end = origin + (first + k) * dt, origin + (first + k + 1) * dt
        tally = advance(method, start, end, y, run, b, places, w, tolerance, h, longest)
        accepted += tally.accepted
        rejected += tally.rejected
        evaluations += tally.evaluations
        events += tally.events
        h = tally.h
        time = tally.time
        status = tally.status
        if status != OK:
            break
        status = motion_rates(end, y, run, b, w.f, places)
        if status != OK:
            break
        add_instant(y, run, b, places, out, keep, place + k, history)
        if keep:
            history.time[place + k] = end
            for j in range(n):
                i = 2 * j
                history.qv[place + k, j, 0] = (y[places.qv + i] - out.before[i]) / dt
                history.qv[place + k, j, 1] = (y[places.qv + i + 1] - out.before[i + 1]) / dt
                i = places.pockets + j
                history.pocket_power[place + k, j] = (y[i] - out.before[i - places.qv]) / dt
            i = places.land
            history.land_power[place + k] = (y[i] - out.before[i - places.qv]) / dt
    return Tally(status, time, h, accepted, rejected, evaluations, events)
