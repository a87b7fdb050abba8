"""Time of the parts of a step of the dynamic model, each called alone again and again."""

import time as clock

import numpy as np

from bearingwear.kernels.cage.contacts import cage_contacts
from bearingwear.kernels.decorators import jit
from bearingwear.kernels.dynamic.block_solve import solve_factorised
from bearingwear.kernels.dynamic.block_system import factorise, linearise
from bearingwear.kernels.dynamic.closures import first_closure, interferences
from bearingwear.kernels.dynamic.equilibrium import equilibrium
from bearingwear.kernels.dynamic.friction import BallForces, race_friction
from bearingwear.kernels.dynamic.integrators import ROSENBROCK, take_step
from bearingwear.kernels.dynamic.jacobian import ball_blocks
from bearingwear.kernels.dynamic.quasistatic import find_contacts
from bearingwear.kernels.dynamic.rates import rates_here
from bearingwear.kernels.dynamic.record import add_instant
from bearingwear.kernels.dynamic.step_control import (
    make_ready,
    reset_rotation_vector,
    step_error,
)
from bearingwear.kernels.status import OK

PROFILE_TOLERANCE = 1e-3  # the program's default


@jit
def loop_rates(count, time, y, bearing, buf, stage, slopes):
    for _ in range(count):
        rates_here(time, y, bearing, buf, stage.end_rates, slopes)


@jit
def loop_equilibrium(count, time, y, bearing, buf):
    for _ in range(count):
        equilibrium(time, y, bearing, buf)


@jit
def loop_contacts(count, y, bearing, balls):
    for _ in range(count):
        find_contacts(y, bearing, balls)


@jit
def loop_cage(count, y, bearing, buf):
    for _ in range(count):
        cage_contacts(y, bearing, buf.balls, buf.cage)


@jit
def loop_friction(count, y, bearing, buf, qv, slopes):
    none = BallForces(M_x=0.0, M_y=0.0, M_z=0.0, F_y=0.0, heat=0.0, shaft=0.0)
    for _ in range(count):
        for j in range(bearing.D.size):
            race_friction(y, bearing, buf, j, none, qv, slopes)


@jit
def loop_step(count, method, time, h, y, bearing, buf, stage):
    for _ in range(count):
        take_step(method, time, h, y, bearing, buf, stage)


@jit
def loop_blocks(count, y, bearing, buf):
    for _ in range(count):
        ball_blocks(y, bearing, buf)


@jit
def loop_linearise(count, y, bearing, buf, stage):
    for _ in range(count):
        linearise(y, bearing, buf, stage.system)


@jit
def loop_factorise(count, shift, y, bearing, buf, stage):
    for _ in range(count):
        factorise(shift, y, bearing, buf, stage.system)


@jit
def loop_solve(count, shift, bearing, stage):
    for _ in range(count):
        solve_factorised(shift, stage.side, stage.U[5], bearing, stage.system)


@jit
def loop_control(count, control, h, y, bearing, buf, stage, out):
    n = bearing.D.size
    for _ in range(count):
        out[0] = step_error(h, y, bearing, buf.balls, stage, control)
        interferences(buf, stage.after)
        out[1], out[2] = first_closure(stage.before, stage.after, n, 1e-9)
        reset_rotation_vector(y, bearing, buf.cage, stage.end_rates)


@jit
def loop_record(count, y, bearing, buf, recorder):
    for _ in range(count):
        add_instant(y, bearing, buf, recorder, 0)


def time_of(count, loop, *args):
    """Time [us] of one of `count` passes of a loop."""
    loop(1, *args)
    marks = [clock.process_time()]
    for passes in (0, count):
        loop(passes, *args)
        marks.append(clock.process_time())
    return 1e6 * (marks[2] - 2.0 * marks[1] + marks[0]) / count


def part_times(run, step):
    """Times [us] of the parts of a step from here, and of what an instant kept takes."""
    system = run.system
    time, y, bearing, buf, stage = (
        system.time, system.y, system.bearing, system.buffers, system.stages,
    )  # fmt: skip
    here, shift, out = system.packed(), 1.0 / (ROSENBROCK.gamma * step), np.zeros(3)
    control = system.control(PROFILE_TOLERANCE)
    assert make_ready(control, time, y, bearing, buf, stage, True) == OK
    t = {
        "rates": time_of(100, loop_rates, time, y, bearing, buf, stage, False),
        "rates with slopes": time_of(100, loop_rates, time, y, bearing, buf, stage, True),
        "contacts": time_of(200, loop_contacts, y, bearing, buf.balls),
        "cage": time_of(200, loop_cage, y, bearing, buf),
        "friction": time_of(200, loop_friction, y, bearing, buf, np.empty(2), False),
        "slopes": time_of(200, loop_friction, y, bearing, buf, np.empty(2), True),
        "blocks": time_of(50, loop_blocks, y, bearing, buf),
        "linearise": time_of(50, loop_linearise, y, bearing, buf, stage),
        "factorise": time_of(50, loop_factorise, shift, y, bearing, buf, stage),
        "solve": 4 * time_of(200, loop_solve, shift, bearing, stage),
        "control": time_of(200, loop_control, control, step, y, bearing, buf, stage, out),
    }
    assert make_ready(control, time, y, bearing, buf, stage, True) == OK
    t["step"] = time_of(50, loop_step, ROSENBROCK, time, step, y, bearing, buf, stage)
    system.unpack(here, time)
    assert system.update() == OK
    t["equilibrium"] = time_of(50, loop_equilibrium, time, y, bearing, buf)
    t["instant"] = time_of(50, loop_record, y, bearing, buf, run.recorder)
    system.unpack(here, time)
    return t


def part_rows(mean, accepted, tried, points):
    """Time of each part in a turn [us], by the mean time of one call and how often it is called."""
    # A step takes three evaluations and, where its error allows, one at its end with slopes.
    inner, ends = 3 * tried, accepted + points
    friction = inner * mean["friction"] + ends * mean["slopes"]
    contacts, cage = ((inner + ends) * mean[name] for name in ("contacts", "cage"))
    rest = inner * mean["rates"] + ends * mean["rates with slopes"] - friction - contacts - cage
    others = mean["step"] - 3.0 * mean["rates"] - mean["factorise"] - mean["solve"]
    return [
        ("contacts of balls and races (Hertz)", contacts),
        ("contacts of pockets and land", cage),
        ("friction over the strips: sums", inner * mean["friction"]),
        ("friction over the strips: sums and slopes", ends * mean["slopes"]),
        ("rates, unbalanced forces, powers", rest),
        ("derivatives of the balls' forces", accepted * mean["blocks"]),
        (
            "other data kept from the start of a step",
            accepted * (mean["linearise"] - mean["blocks"]),
        ),
        ("factorisation", tried * mean["factorise"]),
        ("solves", tried * mean["solve"]),
        ("stage sums, integrals", tried * others),
        ("error, events, reset of the rotation vector", tried * mean["control"]),
        ("equilibrium at recorded instants", points * mean["equilibrium"]),
        ("averages and histories", points * mean["instant"]),
    ]
