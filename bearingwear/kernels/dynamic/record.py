"""What a run in time keeps: sums for averages, histories, checks of every instant kept."""

import math
from typing import NamedTuple

import numpy as np

from bearingwear.kernels.ball import drag_force
from bearingwear.kernels.cage.body import axial_momentum, imbalance_vector
from bearingwear.kernels.cage.law import INNER_TORQUE
from bearingwear.kernels.contact.points import Points, point_buffers
from bearingwear.kernels.contact.summary import (
    COLUMNS,
    LOAD,
    QV,
    TORQUE,
    contact_summary,
    slip_profile,
)
from bearingwear.kernels.contact.verification import polygon_residual
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.dynamic.quasistatic import (
    COS_I,
    COS_O,
    HERTZ_A,
    HERTZ_B,
    HERTZ_K,
    LOG_KAPPA,
    SIN_I,
    SIN_O,
    assemble_condensed,
    inner_force,
)
from bearingwear.kernels.dynamic.step_control import Tally, make_ready, march
from bearingwear.kernels.equilibrium.race import axial_stiffness
from bearingwear.kernels.layout import BALL, CAGE, CENTRE, OMEGA, PSI
from bearingwear.kernels.linear import copy
from bearingwear.kernels.params import BallState, Hertz
from bearingwear.kernels.status import OK

# Columns of Sums.ball after a ball's angular velocity and orbit rate.
RADIUS, AXIAL, CENTRIFUGAL = 4, 5, 6
# Columns of Sums.bearing; the first three are the displacement of the race.
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


class Sums(NamedTuple):
    """Sums over the instants of a window."""

    contacts: np.ndarray  # (n, 2, COLUMNS) see summary.contact_summary
    slip: np.ndarray  # (2, n, 2, strips) along both axes [m/s]
    ball: np.ndarray  # (n, 7)
    bearing: np.ndarray  # (8,)
    residual: np.ndarray  # (1,) largest normal balance left, a share of the largest load
    count: np.ndarray  # (1,) instants
    strips: np.ndarray  # positions x/a of the slip profiles
    before: np.ndarray  # integrals at the last instant
    row: np.ndarray  # (2, COLUMNS) buffer
    points: Points
    profile: np.ndarray  # (3, strips) buffer


class Recorder(NamedTuple):
    """Where the instants of a run are written."""

    sums: Sums
    history: History
    keep: bool  # whether there is a history


class TimeGrid(NamedTuple):
    """Instants of a run: origin + k dt, interval 0 of the run ending at k = first + 1."""

    origin: float  # [s]
    dt: float  # [s]
    first: int


def empty_history(length, n):
    """Room for so many instants."""
    f = np.float32
    return History(
        time=np.zeros(length),
        load=np.zeros((length, n, 2), f),
        slip=np.zeros((length, n, 2), f),
        qv=np.zeros((length, n, 2), f),
        lead=np.zeros((length, n), f),
        preload=np.zeros(length, f),
        displacement=np.zeros((length, 3), f),
        cage=np.zeros((length, 7), f),
        force=np.zeros((length, n + 2), f),
        pocket_power=np.zeros((length, n), f),
        land_power=np.zeros(length, f),
    )


def empty_sums(n, rule, strips, integrals):
    """Sums at zero, for n balls, an ellipse rule, the slip profiles at `strips`."""
    return Sums(
        contacts=np.zeros((n, 2, COLUMNS)),
        slip=np.zeros((2, n, 2, strips.size)),
        ball=np.zeros((n, 7)),
        bearing=np.zeros(8),
        residual=np.zeros(1),
        count=np.zeros(1, np.int64),
        strips=strips,
        before=np.zeros(integrals),
        row=np.zeros((2, COLUMNS)),
        points=point_buffers(rule),
        profile=np.zeros((3, strips.size)),
    )


def clear(sums):
    """Reset the sums for a new window."""
    sums.contacts[:, :, :] = 0.0
    sums.slip[:, :, :, :] = 0.0
    sums.ball[:, :] = 0.0
    sums.bearing[:] = 0.0
    sums.residual[0] = 0.0
    sums.count[0] = 0


@jit
def hertz_of(factors):
    """Record of Hertz factors (4,); its E is not known."""
    return Hertz(
        K=factors[HERTZ_K],
        c_a=factors[HERTZ_A],
        c_b=factors[HERTZ_B],
        log_kappa=factors[LOG_KAPPA],
        E=math.nan,
    )


@jit
def ball_state(bearing, buf, j, Omega):
    """The equilibrium of ball j as the thrust solvers describe it."""
    balls, force, d = buf.balls, buf.cage.ball_force[j], buf.balls.direction[j]
    Q_i, Q_o = balls.Q[j, 0], balls.Q[j, 1]
    T_i, T_o = balls.T[j, 0], balls.T[j, 1]
    F_ix, F_ir = inner_force(balls, j)
    return BallState(
        status=OK,
        X1=balls.X[j, 0],
        X2=balls.X[j, 1],
        alpha_i=math.atan2(d[SIN_I], d[COS_I]),
        alpha_o=math.atan2(d[SIN_O], d[COS_O]),
        Q_i=Q_i,
        Q_o=Q_o,
        hertz_i=hertz_of(balls.factors[j, 0]),
        hertz_o=hertz_of(balls.factors[j, 1]),
        F_ix=F_ix,
        F_ir=F_ir,
        S_xx=0.0,
        S_xr=0.0,
        S_rr=0.0,
        P_x=force[0] + T_i * d[COS_I] + T_o * d[COS_O],
        P_r=(force[2] + bearing.mass[j] * balls.r[j] * Omega**2 - T_i * d[SIN_I] - T_o * d[SIN_O]),
        residual=0.0,
    )


@jit
def add_slip_profiles(bearing, u, r, j, k, sums):
    """Add the slip along both axes of contact k of ball j."""
    profile = sums.profile
    slip_profile(
        bearing.g, bearing.D[j], bearing.op, u, r, k, sums.row[k], sums.strips,
        profile[2], profile[0], profile[1],
    )  # fmt: skip
    for i in range(sums.strips.size):
        sums.slip[0, j, k, i] += profile[0, i]
        sums.slip[1, j, k, i] += profile[1, i]


@jit
def add_contacts(bearing, state, u, r, j, recorder, place):
    """Add both race contacts of ball j; leaves their summaries in `recorder.sums.row`."""
    sums, history = recorder.sums, recorder.history
    contact_summary(
        bearing.g, bearing.D[j], bearing.op, state, u, r, bearing.rule, sums.points, sums.row, True
    )
    for k in range(2):
        row = sums.row[k]
        for i in range(COLUMNS):
            sums.contacts[j, k, i] += row[i]
        if recorder.keep:
            history.load[place, j, k] = row[LOAD]
            history.slip[place, j, k] = row[QV] / row[LOAD] if row[LOAD] > 0.0 else 0.0
        if row[LOAD] > 0.0:
            add_slip_profiles(bearing, u, r, j, k, sums)


@jit
def race_residual(bearing, buf, race_force, largest):
    """Force on the inner race that nothing balances, as a share of the ball loads [1].

    Parameters
    ----------
    race_force : tuple of 3 floats
        Of the race on the balls (axial, Y, Z) [N].
    """
    F, land = buf.balls.F, buf.cage.race_force
    left = max(abs(race_force[1] - F[1] - land[0]), abs(race_force[2] - F[2] - land[1]))
    if not bearing.axial_is_held:
        left = max(left, abs(race_force[0] - F[0]))
    return left / (bearing.D.size * largest) if largest > 0.0 else 0.0


@jit
def add_instant(y, bearing, buf, recorder, place):
    """Add the instant of the last `state_rates` call to the sums, and to the history at `place`."""
    g, balls, sums, history = bearing.g, buf.balls, recorder.sums, recorder.history
    n = bearing.D.size
    largest = 0.0
    for j in range(n):
        largest = max(largest, balls.Q[j, 0], balls.Q[j, 1])
    race_x = race_y = race_z = torque = power = mean_lead = 0.0
    for j in range(n):
        u, psi, r = y[BALL * j : BALL * j + 4], y[BALL * j + PSI], balls.r[j]
        state = ball_state(bearing, buf, j, u[OMEGA])
        residual = polygon_residual(g, bearing.D[j], state, balls.A[j, 0], balls.A[j, 1], largest)
        sums.residual[0] = max(sums.residual[0], residual)
        add_contacts(bearing, state, u, r, j, recorder, place)
        ball = sums.ball[j]
        for i in range(4):
            ball[i] += u[i]
        ball[RADIUS] += r
        ball[AXIAL] += state.F_ix
        ball[CENTRIFUGAL] += bearing.mass[j] * r * u[OMEGA] ** 2
        race_x += state.F_ix
        race_y -= state.F_ir * math.sin(psi)
        race_z += state.F_ir * math.cos(psi)
        torque += sums.row[0, TORQUE]
        drag, _ = drag_force(g, bearing.D[j], bearing.op.drag, u[OMEGA])
        power += drag * r * u[OMEGA]
        mean_lead += (psi - 2.0 * math.pi * j / n) / n
    left = race_residual(bearing, buf, (race_x, race_y, race_z), largest)
    sums.residual[0] = max(sums.residual[0], left)
    assemble_condensed(bearing, False, False, balls)  # stiffness of the bearing alone
    for i in range(3):
        sums.bearing[SHIFT + i] += balls.delta[i]
    sums.bearing[PRELOAD] += race_x
    sums.bearing[INNER_RACE_TORQUE] += torque + buf.cage.sums[INNER_TORQUE]
    sums.bearing[DRAG_POWER] += power
    sums.bearing[STIFFNESS] += axial_stiffness(balls.matrix)
    R, cage_speed = buf.cage.R, 0.0
    if bearing.cage.present:
        z = y[bearing.layout.cage : bearing.layout.cage + CAGE]
        cage_speed = axial_momentum(z, R) / bearing.cage.I_x
        sums.bearing[CAGE_SPEED] += cage_speed
        mean_lead = math.atan2(-R[1, 2], R[2, 2])
    sums.count[0] += 1
    if not recorder.keep:
        return
    for i in range(3):
        history.displacement[place, i] = balls.delta[i]
    history.preload[place] = race_x
    for j in range(n):
        lead = y[BALL * j + PSI] - 2.0 * math.pi * j / n - mean_lead
        history.lead[place, j] = lead - 2.0 * math.pi * math.floor(lead / (2.0 * math.pi) + 0.5)
    if bearing.cage.present:
        keep_cage(y, bearing, buf.cage, cage_speed, history, place)


@jit
def keep_cage(y, bearing, contacts, speed, history, place):
    """Put the cage's pose, speed and forces into the history."""
    R, row = contacts.R, history.cage[place]
    shift = imbalance_vector(bearing.cage, R)
    for i in range(3):
        row[POSITION + i] = y[bearing.layout.cage + CENTRE + i] - shift[i]
    # The small turn that takes the X axis to the cage's.
    row[TILT + 1] = -math.asin(R[2, 0])
    row[TILT + 2] = math.asin(R[1, 0])
    row[SPEED] = speed
    for i in range(bearing.D.size + 2):
        history.force[place, i] = contacts.normal[i]


@jit
def keep_powers(y, bearing, before, dt, history, place):
    """Put mean powers over an interval of length dt into the history.

    Parameters
    ----------
    before : ndarray
        The integrals at its beginning.
    """
    layout = bearing.layout
    for j in range(bearing.D.size):
        for k in range(2):
            i = 2 * j + k
            history.qv[place, j, k] = (y[layout.qv + i] - before[i]) / dt
        i = layout.pockets + j
        history.pocket_power[place, j] = (y[i] - before[i - layout.qv]) / dt
    i = layout.land
    history.land_power[place] = (y[i] - before[i - layout.qv]) / dt


@jit
def advance_and_record(control, grid, begin, count, h, y, bearing, buf, stage, recorder):
    """Integrate over `count` intervals of the grid from interval `begin` on.

    The end of each is an instant of the recorder. None are left to do where `count` is not
    positive: nothing is done at 0, and only `make_ready` below.

    Parameters
    ----------
    control : step_control.StepControl
    h : float
        First step [s].

    Returns
    -------
    Tally
        Of all intervals; its `time` is the end of the last one that was finished.
    """
    accepted = rejected = evaluations = events = 0
    time = grid.origin + (grid.first + begin) * grid.dt
    status = OK if count == 0 else make_ready(control, time, y, bearing, buf, stage, True)
    before, history = recorder.sums.before, recorder.history
    for place in range(begin, begin + count):
        if status != OK:
            break
        copy(y[bearing.layout.qv :], before)
        start = grid.origin + (grid.first + place) * grid.dt
        end = grid.origin + (grid.first + place + 1) * grid.dt
        tally = march(control, start, end, h, y, bearing, buf, stage)
        accepted += tally.accepted
        rejected += tally.rejected
        evaluations += tally.evaluations
        events += tally.events
        h = tally.h
        time = tally.time
        status = tally.status
        if status != OK:
            break
        status = make_ready(control, end, y, bearing, buf, stage, False)
        if status != OK:
            break
        add_instant(y, bearing, buf, recorder, place)
        if recorder.keep:
            history.time[place] = end
            keep_powers(y, bearing, before, grid.dt, history, place)
    return Tally(
        status=status,
        time=time,
        h=h,
        accepted=accepted,
        rejected=rejected,
        evaluations=evaluations,
        events=events,
    )
