"""Control of the step by its error and by contacts that close (theory.md section 9).

An explicit step that is slightly too long does not blow up, because saturated friction only
chatters. It gives a wrong QV without any sign of trouble. The step control therefore measures the
error of slip velocities against the mean slip itself, and the error of QV.
"""

import math
from typing import NamedTuple

from bearingwear.kernels.cage.body import angular_velocity, turn
from bearingwear.kernels.contact.profile import STORED
from bearingwear.kernels.decorators import inlined, jit
from bearingwear.kernels.dynamic.closures import (
    first_closure,
    impact_time,
    interferences,
    predicted_closure,
)
from bearingwear.kernels.dynamic.equilibrium import (
    correct_places,
    restore_places,
    size_of_unbalanced,
)
from bearingwear.kernels.dynamic.integrators import Tableau, begin_step, take_step
from bearingwear.kernels.dynamic.jacobian import ball_blocks
from bearingwear.kernels.dynamic.quasistatic import HERTZ_K
from bearingwear.kernels.dynamic.rates import agreed_rates, corrected_rates, rates_here, state_rates
from bearingwear.kernels.layout import (
    BALL,
    CAGE,
    CENTRE,
    MOMENTUM,
    OMEGA,
    PSI,
    ROTATION,
    VELOCITY,
    W_X,
    W_Y,
    W_Z,
)
from bearingwear.kernels.linear import copy
from bearingwear.kernels.status import NOT_CONVERGED, OK, TOO_STIFF

# A step that closes a contact deeper than so many times the range in which its damping comes in is
# repeated up to where it closes.
EVENT_DEPTH = 4.0
_MOST_STEPS = 3000  # tried in the longest step's time, a hundred times what a run usually takes
FIRST_OF_IMPACT = 0.3  # of its duration: the step that begins an impact, at the tolerance 1
PATIENCE = 12  # steps refused before places are found again
SAFETY = 0.8  # of the step that the error allows
LONGEST_GROWTH, LEAST_SHARE = 4.0, 0.2  # than the last step, at the most
UNUSABLE = 0.25  # of a step that could not be taken
SHORTEST_LOCATED = 0.05  # of a step repeated up to where a contact closes
CAGE_SHARE = 0.01  # of the balls' speed and the clearance: the scale of the cage's errors
LEFT = 0.1  # of the tolerance: share of the largest load that a step may leave unbalanced
# Of the longest step: shorter ones are asked for no smaller a share of the error of QV. Where a
# pure-rolling point is so far out that a split rule leaves it alone, QV jumps by the error of the
# quadrature, and no step is so short that its power changes by less.
BRIEF = 1e-3
_FAILED = 1e9  # error of a step that could not be taken


class StepControl(NamedTuple):
    """How a run is integrated."""

    method: Tableau
    tolerance: float  # see `step_error`
    longest: float  # step [s]


class Tally(NamedTuple):
    """Cost of an integration."""

    status: int
    time: float  # reached [s]
    h: float  # next step [s]
    accepted: int
    rejected: int
    evaluations: int
    events: int  # contacts made and broken


class Trial(NamedTuple):
    """Result of a step."""

    status: int
    error: float  # over what is allowed [1]
    events: int  # see `first_closure`
    fraction: float


@jit
def cage_error(y, bearing, balls, error, slip, largest):
    """`largest`, or a larger error of the cage's speeds and places over their scales [1]."""
    cage, z = bearing.cage, bearing.layout.cage
    # The cage's speeds against a hundredth of the balls' speed, places against the clearance.
    speed = CAGE_SHARE * balls.r[0] * abs(y[OMEGA]) + slip
    gap = CAGE_SHARE * max(cage.clearance, 1e-3 * bearing.D[0])
    arm = cage.radius
    e = error[z : z + CAGE]
    for k in range(3):
        largest = max(largest, abs(e[CENTRE + k]) / gap, arm * abs(e[ROTATION + k]) / gap)
        largest = max(largest, abs(e[VELOCITY + k]) / speed)
        largest = max(largest, arm * abs(e[MOMENTUM + k]) / (cage.I_t * speed))
    for j in range(bearing.D.size):
        largest = max(largest, balls.r[j] * abs(error[BALL * j + PSI]) / gap)
    return largest


@jit
def step_error(h, y, bearing, balls, stage, control):
    """Error of a step over what is allowed [1].

    Slip velocities that the errors of a ball's motion amount to, against the mean slip of all
    contacts; and QV.
    """
    counted = max(h, BRIEF * control.longest)
    n, v_r, error = bearing.D.size, bearing.op.v_r, stage.error
    load = qv = qv_error = 0.0
    for j in range(n):
        for k in range(2):
            place = bearing.layout.qv + 2 * j + k
            load += balls.Q[j, k]
            qv += (stage.new[place] - y[place]) / h
            qv_error += abs(stage.qv_error[2 * j + k]) / counted
    # At rest there is no slip to compare with; v_r is the smallest that matters.
    slip = max(qv / load, v_r) if load > 0.0 else v_r
    largest = qv_error / (slip * load) if load > 0.0 else 0.0
    for j in range(n):
        i, R, r = BALL * j, 0.5 * bearing.D[j], balls.r[j]
        spin = max(abs(error[i + W_X]), abs(error[i + W_Y]), abs(error[i + W_Z]))
        largest = max(largest, R * spin / slip, r * abs(error[i + OMEGA]) / slip)
    if bearing.cage.present:
        largest = cage_error(y, bearing, balls, error, slip, largest)
    return largest / control.tolerance


@jit
def reset_rotation_vector(y, bearing, contacts, rates):
    """Reset the cage's rotation vector to zero and update the orientation it counts from.

    And its rate of change into that of a vector at zero.
    """
    if bearing.cage.present:
        z = y[bearing.layout.cage : bearing.layout.cage + CAGE]
        theta = z[ROTATION : ROTATION + 3]
        turn(theta, contacts.R0, contacts.R)
        copy(contacts.R, contacts.R0)
        theta[:] = 0.0
        w = angular_velocity(bearing.cage, z, contacts.R)
        for k in range(3):
            rates[bearing.layout.cage + ROTATION + k] = w[k]


@jit
def work_of_places(balls, last):
    """Two terms of the energy account that come with the places of the balls, since the last call.

    The contact force is that of a Hertz factor which stands still: as the contact angle changes,
    the energy 2/5 K d^(5/2) changes by more than the work of the force. And tractions that bear on
    the balance of normal forces work as their contacts turn.

    Parameters
    ----------
    last : ndarray (n, 2, 4)
        K, 2/5 d^(5/2), contact angle, traction times the distance of ball and groove centres at
        the last call [N/m^1.5, m^2.5, rad, N m]; replaced.

    Returns
    -------
    hertz, traction : float
        [J]
    """
    hertz = traction = 0.0
    for j in range(balls.r.size):
        X, A = balls.X[j], balls.A[j]
        for k in range(2):
            K, Q, row = balls.factors[j, k, HERTZ_K], balls.Q[j, k], last[j, k]
            depth = STORED * (Q / K) ** (5.0 / 3.0) if Q > 0.0 else 0.0
            hertz += 0.5 * (depth + row[1]) * (K - row[0])
            row[0], row[1] = K, depth
            if balls.T[j, k] != 0.0 or row[3] != 0.0:
                d1, d2 = (A[0] - X[0], A[1] - X[1]) if k == 0 else (X[0], X[1])
                angle, moment = math.atan2(d1, d2), balls.T[j, k] * math.sqrt(d1 * d1 + d2 * d2)
                side = 1.0 if k == 0 else -1.0
                traction += side * 0.5 * (moment + row[3]) * (angle - row[2])
                row[2], row[3] = angle, moment
    return hertz, traction


@jit
def first_step_of_impact(control, bearing, stage, step, h):
    """Step [s], at most h, after one that made contacts."""
    n = bearing.D.size
    for i in range(n + 2):
        if stage.before[i] <= 0.0 and stage.after[i] > 0.0:
            speed = (stage.after[i] - stage.before[i]) / step
            mass = bearing.mass[min(i, n - 1)]
            time = impact_time(bearing.cage, mass, i, n, speed)
            h = min(h, FIRST_OF_IMPACT * control.tolerance ** (1.0 / control.method.order) * time)
    return h


@jit
def step_length(whole, left):
    """Step [s] of at most `whole` where `left` is left: two equal rather than a full and a tiny."""
    if whole >= left * (1.0 - 1e-9):
        return left
    return 0.5 * left if whole > 0.5 * left else whole


@jit
def try_step(control, time, now, step, depth, y, bearing, buf, stage, last):
    """Take a step and evaluate its end; `stage` and `buf` are left there.

    Parameters
    ----------
    last : bool
        Whether `make_ready` follows. Slopes are then needed for tractions alone, see `accept_step`.
    """
    status = take_step(control.method, time, step, y, bearing, buf, stage)
    if status == OK:
        error = step_error(step, y, bearing, buf.balls, stage, control)
        if math.isnan(error):
            status = NOT_CONVERGED
    if status != OK:
        return Trial(status=status, error=_FAILED, events=0, fraction=1.0)
    events, fraction = 0, 1.0
    if error <= 1.0:
        status = NOT_CONVERGED
        implicit = control.method.implicit
        slopes = implicit and (bearing.traction or not last)
        if implicit:
            status = rates_here(now, stage.new, bearing, buf, stage.end_rates, slopes)
        left = LEFT * control.tolerance * buf.balls.Q.max()
        if status == OK and size_of_unbalanced(buf.balls) > left:
            status = NOT_CONVERGED
            if slopes and bearing.traction:
                # After the last step places are corrected in any case.
                status = (
                    OK if last else corrected_rates(now, stage.new, bearing, buf, stage.end_rates)
                )
        if status != OK:
            status = state_rates(now, stage.new, bearing, buf, stage.end_rates, slopes)
        if status == OK:
            interferences(buf, stage.after)
            events, fraction = first_closure(stage.before, stage.after, bearing.D.size, depth)
    return Trial(status=status, error=error, events=events, fraction=fraction)


@jit
def accept_step(control, step, y, bearing, buf, stage, last):
    """Go on from the end of the step tried last; after the `last` one, `make_ready` follows.

    It finds balls and race nearly in balance where tractions bear on that.
    """
    for i in range(stage.closing.size):
        stage.closing[i] = (stage.after[i] - stage.before[i]) / step
    copy(stage.new, y)
    copy(stage.end_rates, stage.rates[0])
    hertz, traction = work_of_places(buf.balls, stage.work)
    y[bearing.layout.hertz] += hertz
    y[bearing.layout.traction] += traction
    reset_rotation_vector(y, bearing, buf.cage, stage.rates[0])
    copy(stage.after, stage.before)
    if not last:
        begin_step(control.method, y, bearing, buf, stage)
    elif control.method.implicit and bearing.traction:
        ball_blocks(y, bearing, buf)
        correct_places(bearing, buf)


@jit
def make_ready(control, time, y, bearing, buf, stage, settled):
    """Bring `buf` and `stage` to a state; returns a status.

    Parameters
    ----------
    settled : bool
        Whether places that agree with the state stay as they are, to the last bit, as where a run
        goes on; else they are found anew, from there on.
    """
    implicit = control.method.implicit
    if settled:
        status = agreed_rates(time, y, bearing, buf, stage.rates[0], implicit)
    else:
        status = state_rates(time, y, bearing, buf, stage.rates[0], implicit)
    if status == OK:
        interferences(buf, stage.before)
        work_of_places(buf.balls, stage.work)
        begin_step(control.method, y, bearing, buf, stage)
    return status


@jit
def shortened(trial, power):
    """Share of a step that was refused to try next: up to where a contact closes, or for its error.

    Parameters
    ----------
    power : float
        Of the error that the step goes by.
    """
    if trial.status != OK:
        return UNUSABLE
    if trial.error <= 1.0:
        return max(trial.fraction, SHORTEST_LOCATED)
    return max(LEAST_SHARE, SAFETY * trial.error**power)


@inlined
def step_after(control, bearing, stage, trial, h, step, whole):
    """Length to try after a good step, of `whole` unless something cut it short [s]."""
    power = -1.0 / control.method.order
    grown = step * min(LONGEST_GROWTH, SAFETY * max(trial.error, 1e-9) ** power)
    # A step that was cut short says nothing about longer ones.
    h = grown if step == whole else max(h, grown)
    if trial.events > 0:
        h = first_step_of_impact(control, bearing, stage, step, h)
    return h


@jit
def march(control, time, end, h, y, bearing, buf, stage):
    """Integrate from `time`, where `make_ready` was called, to `end`; y is replaced.

    Parameters
    ----------
    h : float
        First step [s].
    """
    n = bearing.D.size
    accepted = rejected = events = 0
    status = OK
    stage.closing[:] = 0.0
    located = False  # the step ends where a contact closes
    failed = 0  # steps refused one after the other
    most = _MOST_STEPS * max(1.0, (end - time) / control.longest)
    depth = EVENT_DEPTH * min(bearing.cage.ramp_pocket, bearing.cage.ramp_land)
    while status == OK and time < end:
        if accepted + rejected > most:
            status = TOO_STIFF
            break
        left = end - time
        whole = min(h, control.longest)
        step = step_length(whole, left)
        if not located:
            step = predicted_closure(stage.before, stage.closing, n, depth, step)
        now = end if step == left else time + step
        trial = try_step(control, time, now, step, depth, y, bearing, buf, stage, now >= end)
        usable = trial.status == OK and trial.error <= 1.0
        if usable and (located or trial.fraction == 1.0):
            time = now
            h = step_after(control, bearing, stage, trial, h, step, whole)
            accept_step(control, step, y, bearing, buf, stage, time >= end)
            accepted, events = accepted + 1, events + trial.events
            located, failed = False, 0
            continue
        rejected, failed = rejected + 1, failed + 1
        located = usable
        h = step * shortened(trial, -1.0 / control.method.order)
        if not h > 1e-15 * max(end, 1e-9):
            status = TOO_STIFF if trial.status == OK else trial.status
            break
        # A step that failed leaves places that mislead.
        restore_places(buf.balls, stage.kept)
        if failed == PATIENCE and control.method.implicit:
            # Balls and race may have to jump to where they are in balance.
            status = make_ready(control, time, y, bearing, buf, stage, False)
    return Tally(
        status=status,
        time=time,
        h=h,
        accepted=accepted,
        rejected=rejected,
        evaluations=control.method.stages * (accepted + rejected),
        events=events,
    )
