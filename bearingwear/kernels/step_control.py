"""Control of the step by its error and by contacts that close (theory.md section 9).

An explicit step that is slightly too long does not blow up, since saturated friction only
chatters; it reports a wrong QV without a sign of trouble. The step control therefore measures the
error of slip velocities against the mean slip itself, and the error of QV.
"""

import math
from typing import NamedTuple

from bearingwear.kernels.cage import angular_velocity, turn
from bearingwear.kernels.compile import jit
from bearingwear.kernels.dynamic_equilibrium import restore_places, size_of_unbalanced
from bearingwear.kernels.integrators import Tableau, begin_step, take_step
from bearingwear.kernels.linear import copy
from bearingwear.kernels.profile import STORED
from bearingwear.kernels.quasistatic import HERTZ_K, start_is_known
from bearingwear.kernels.rates import rates_here, state_rates
from bearingwear.kernels.state import (
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
from bearingwear.kernels.status import NOT_CONVERGED, OK, TOO_STIFF

# A step that closes a contact deeper than so many times the range in which its damping comes in is
# taken anew up to where it closes.
EVENT_DEPTH = 4.0
_MOST_STEPS = 3000  # tried in the longest step's time, a hundred times what a run usually takes
CAGE_SHARE = 0.01  # of the balls' speed and the clearance: the scale of the cage's errors
AGREED = 1e-6  # share of the largest load that a balance of normal forces may leave
_FAILED = 1e9  # error of a step that could not be taken


class StepControl(NamedTuple):
    """How a run is integrated."""

    method: Tableau
    tolerance: float  # see `step_error`
    longest: float  # step [s]


class Tally(NamedTuple):
    """What an integration took."""

    status: int
    time: float  # reached [s]
    h: float  # next step [s]
    accepted: int
    rejected: int
    evaluations: int
    events: int  # contacts made and broken


class Trial(NamedTuple):
    """What a step came to."""

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
def step_error(h, y, bearing, balls, stage, tolerance):
    """Error of a step over what is allowed [1].

    Slip velocities that the errors of a ball's motion amount to, against the mean slip of all
    contacts; and QV.
    """
    n, v_r, error = bearing.D.size, bearing.op.v_r, stage.error
    load = qv = qv_error = 0.0
    for j in range(n):
        for k in range(2):
            place = bearing.layout.qv + 2 * j + k
            load += balls.Q[j, k]
            qv += (stage.new[place] - y[place]) / h
            qv_error += abs(stage.qv_error[2 * j + k]) / h
    # At rest there is no slip to compare with; v_r is the smallest that matters.
    slip = max(qv / load, v_r) if load > 0.0 else v_r
    largest = qv_error / (slip * load) if load > 0.0 else 0.0
    for j in range(n):
        i, R, r = BALL * j, 0.5 * bearing.D[j], balls.r[j]
        spin = max(abs(error[i + W_X]), abs(error[i + W_Y]), abs(error[i + W_Z]))
        largest = max(largest, R * spin / slip, r * abs(error[i + OMEGA]) / slip)
    if bearing.cage.present:
        largest = cage_error(y, bearing, balls, error, slip, largest)
    return largest / tolerance


@jit
def reset_rotation_vector(y, bearing, contacts, rates):
    """Put the cage's rotation vector back to zero, into the orientation it counts from.

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
def hertz_factor_work(balls, last):
    """Elastic energy that came with Hertz factors alone since the last call [J].

    The contact force is that of a factor which stands still: as the contact angle changes, the
    energy 2/5 K d^(5/2) changes by more than the work of the force.

    Parameters
    ----------
    last : ndarray (n, 2, 2)
        K and 2/5 d^(5/2) of the last call [N/m^1.5, m^2.5]; replaced.
    """
    total = 0.0
    for j in range(balls.r.size):
        for k in range(2):
            K = balls.factors[j, k, HERTZ_K]
            depth = STORED * (balls.Q[j, k] / K) ** (5.0 / 3.0)
            total += 0.5 * (depth + last[j, k, 1]) * (K - last[j, k, 0])
            last[j, k, 0], last[j, k, 1] = K, depth
    return total


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
def step_length(whole, left):
    """Step [s] of at most `whole` where `left` is left: two equal rather than a full and a tiny."""
    if whole >= left * (1.0 - 1e-9):
        return left
    return 0.5 * left if whole > 0.5 * left else whole


@jit
def try_step(control, time, now, step, y, bearing, buf, stage):
    """Take a step and look at its end; `stage` and `buf` are left there."""
    status = take_step(control.method, time, step, y, bearing, buf, stage)
    if status != OK:
        return Trial(status=status, error=_FAILED, events=0, fraction=1.0)
    error = step_error(step, y, bearing, buf.balls, stage, control.tolerance)
    events, fraction = 0, 1.0
    if error <= 1.0:
        if control.method.implicit:
            status = rates_here(now, stage.new, bearing, buf, stage.end_rates)
        else:
            status = state_rates(now, stage.new, bearing, buf, stage.end_rates)
        if status == OK:
            interferences(buf, stage.after)
            depth = EVENT_DEPTH * min(bearing.cage.ramp_pocket, bearing.cage.ramp_land)
            events, fraction = first_closure(stage.before, stage.after, bearing.D.size, depth)
    return Trial(status=status, error=error, events=events, fraction=fraction)


@jit
def accept_step(control, y, bearing, buf, stage):
    """Go on from the end of the step tried last."""
    copy(stage.new, y)
    copy(stage.end_rates, stage.rates[0])
    y[bearing.layout.hertz] += hertz_factor_work(buf.balls, stage.hertz)
    reset_rotation_vector(y, bearing, buf.cage, stage.rates[0])
    copy(stage.after, stage.before)
    begin_step(control.method, y, bearing, buf, stage)


@jit
def begin(control, time, y, bearing, buf, stage):
    """Bring `buf` and `stage` to a state; returns a status.

    Places that agree with it already, as where a run goes on, stay as they are to the last bit.
    """
    balls, rates = buf.balls, stage.rates[0]
    status = NOT_CONVERGED
    if start_is_known(balls):
        status = rates_here(time, y, bearing, buf, rates)
    if status != OK or size_of_unbalanced(balls) > AGREED * balls.Q.max():
        status = state_rates(time, y, bearing, buf, rates)
    if status == OK:
        interferences(buf, stage.before)
        hertz_factor_work(buf.balls, stage.hertz)
        begin_step(control.method, y, bearing, buf, stage)
    return status


@jit
def advance(control, time, end, h, y, bearing, buf, stage):
    """Integrate from `time` to `end`; y is replaced.

    Parameters
    ----------
    control : StepControl
    h : float
        First step [s].

    Returns
    -------
    Tally
    """
    power = -1.0 / control.method.order
    accepted = rejected = events = 0
    status = begin(control, time, y, bearing, buf, stage)
    located = False  # the step ends where a contact closes
    most = _MOST_STEPS * max(1.0, (end - time) / control.longest)
    while status == OK and time < end:
        if accepted + rejected > most:
            status = TOO_STIFF
            break
        left = end - time
        whole = min(h, control.longest)
        step = step_length(whole, left)
        now = end if step == left else time + step
        trial = try_step(control, time, now, step, y, bearing, buf, stage)
        usable = trial.status == OK and trial.error <= 1.0
        if usable and (located or trial.fraction == 1.0):
            time = now
            accept_step(control, y, bearing, buf, stage)
            accepted += 1
            events += trial.events
            located = False
            grown = step * min(4.0, 0.9 * max(trial.error, 1e-9) ** power)
            h = grown if step == whole else max(h, grown)
            continue
        rejected += 1
        located = usable
        if usable:
            h = max(trial.fraction, 0.05) * step
        else:
            h = step * (0.25 if trial.status != OK else max(0.2, 0.9 * trial.error**power))
        if not h > 1e-15 * max(end, 1e-9) or math.isnan(trial.error):
            status = trial.status
            if status == OK:
                status = NOT_CONVERGED if math.isnan(trial.error) else TOO_STIFF
            break
        # A step that failed leaves places that mislead.
        restore_places(buf.balls, stage.kept)
    return Tally(
        status=status,
        time=time,
        h=h,
        accepted=accepted,
        rejected=rejected,
        evaluations=control.method.stages * (accepted + rejected),
        events=events,
    )
