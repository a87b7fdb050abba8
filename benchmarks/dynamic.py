"""Speed of the dynamic model, and where its time goes.

    python benchmarks/dynamic.py

gyro_s1 with a rotating load of 1 N, nine balls, cage of six degrees of freedom, 50 equal strips a
contact ellipse; and the balls and race alone against plain_dynamic.py. One run, one thread, warm.
Rounds of all cases follow each other, so that the machine's load moves all of them alike. CPU time
is what the program itself took; wall time has in it what others took of the core.
"""

import os

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")

import dataclasses
import platform
import statistics
import time as clock
import types
from pathlib import Path

import numpy as np
import plain_dynamic
import plain_scipy

from bearingwear.io.config import load_scene
from bearingwear.kernels import motion as right_hand_side
from bearingwear.kernels import quasistatic
from bearingwear.kernels.compile import jit
from bearingwear.kernels.coupling import add_cage_powers, factorise, solve
from bearingwear.kernels.integrators import (
    W_A,
    W_TIME,
    contacts_now,
    event_in,
    rebase,
    rosenbrock_step,
    step_error,
)
from bearingwear.kernels.motion import (
    BALL,
    ball_blocks,
    contacts_at,
    equilibrium,
    friction_sums,
    joint_equilibrium,
    motion_rates,
    race_contact_of,
    slip_of,
)
from bearingwear.kernels.quasistatic import sweep
from bearingwear.kernels.record import add_instant
from bearingwear.kernels.status import OK
from bearingwear.model.dynamic import STEPS_PER_TURN, Motion
from bearingwear.model.interrupt import Interrupt
from bearingwear.model.transient import Run, start_of, window_values

SCENE = Path(__file__).resolve().parents[1] / "config" / "scenes" / "gyro_s1.yaml"
ROUNDS = 5
REFERENCE = 1e-5  # tolerance of the runs that QV is compared with
PLAIN_RTOL = 1e-4  # of LSODA: QV is right to 1e-6 and better, and looser is not faster
PROFILE_TOLERANCE = 1e-3  # the program's default
PROFILE_AFTER, PROFILE_TURNS = 50, 20
PROFILE_STRETCHES = 40


def scene_of(turns, tolerance, integrator="rosenbrock", cage=True):
    """The benchmark's scene, averaged over all its turns."""
    keys = [
        "operation.rotating_load_N=1.0",
        "model.quadrature=strips",
        "model.strips=50",
        f"model.simulated_turns={turns}",
        f"model.evaluated_turns={turns}",
        f"model.dynamic_tolerance={tolerance:.7f}",
        f"model.integrator={integrator}",
    ]
    return load_scene(SCENE, keys if cage else [*keys, "cage=null"])


def table(header, rows):
    """Print rows of words under a header of comma-separated words."""
    columns = header.split(", ")
    lines = [columns, ["---"] + ["---:"] * (len(columns) - 1), *rows]
    lines = [[*line, *[""] * (len(columns) - len(line))] for line in lines]
    width = [max(len(line[i]) for line in lines) for i in range(len(columns))]
    print()
    for line in lines:
        _, *others = (word.rjust(w) for word, w in zip(line, width, strict=True))
        print(f"| {line[0].ljust(width[0])} | {' | '.join(others)} |")
    print()


# --- Speed -----------------------------------------------------------------------------------


@dataclasses.dataclass
class Case:
    """A run that is timed, and what its rounds left."""

    name: str
    call: object  # () -> seconds of CPU, seconds of wall, QV, energy account, tally
    turns: float
    reference: str = ""
    cpu: list = dataclasses.field(default_factory=list)  # [ms] a turn
    wall: list = dataclasses.field(default_factory=list)
    qv: float = 0.0
    account: float | None = None
    tally: tuple = ()  # steps accepted and rejected a turn

    def time(self):
        """One more round."""
        cpu, wall, self.qv, self.account, self.tally = self.call()
        self.cpu.append(1e3 * cpu / self.turns)
        self.wall.append(1e3 * wall / self.turns)


def ours(scene, start):
    """A run as solve_dynamic makes it, with its histories, without the search for its start."""
    motion = Motion.of(scene, start)
    assert motion.settle() == OK
    run = Run(scene, motion, None)
    with Interrupt() as interrupt:
        cpu, wall = clock.process_time(), clock.perf_counter()
        status = run.window(run.grid.window, interrupt)
        cpu, wall = clock.process_time() - cpu, clock.perf_counter() - wall
    assert status == OK
    values = window_values(scene, run)
    tally = tuple(run.tally[:2] / run.turns)
    return cpu, wall, values["total_qv"], values["energy_account_error"], tally


def theirs(motion, duration, by_ball):
    """The plain program over the same time."""
    cpu, wall = clock.process_time(), clock.perf_counter()
    answer = motion.run(duration, PLAIN_RTOL, by_ball)
    cpu, wall = clock.process_time() - cpu, clock.perf_counter() - wall
    turns = motion.op.speed[0] * duration / (2 * np.pi)
    return cpu, wall, answer.qv, None, (answer.steps / turns,)


def speed():
    """Time all cases and print them."""
    start = start_of(scene_of(20, REFERENCE)).u
    plain = plain_dynamic.Motion(plain_scipy.S1, plain_scipy.INSTRUMENT, 1.0)
    turn = 2 * np.pi / plain.op.speed[0]

    def run(*args, **kwargs):
        scene = scene_of(*args, **kwargs)
        return lambda: ours(scene, start)

    references = {
        "cage, 20": Case("cage, 20 turns, stiff, 1e-5", run(20, REFERENCE), 20, "cage, 20"),
        "cage, 100": Case("cage, 100 turns, stiff, 1e-5", run(100, REFERENCE), 100, "cage, 100"),
        "cage, 2": Case("cage, 2 turns, stiff, 1e-5", run(2, REFERENCE), 2, "cage, 2"),
        "none, 20": Case(
            "no cage, 20 turns, stiff, 1e-5", run(20, REFERENCE, cage=False), 20, "none, 20"
        ),
        "none, 1": Case(
            "no cage, 1 turn, stiff, 1e-5", run(1, REFERENCE, cage=False), 1, "none, 1"
        ),
    }
    tight = Case("cage, 20 turns, stiff, 1e-6", run(20, 0.1 * REFERENCE), 20, "cage, 20")
    cases = []
    for turns in (20, 100):
        for tolerance in (1e-2, 3e-3, 1e-3):
            name = f"cage, {turns} turns, stiff, {tolerance:.0e}"
            cases.append(Case(name, run(turns, tolerance), turns, f"cage, {turns}"))
    for tolerance in (1e-2, 1e-3):
        name = f"cage, 2 turns, Fehlberg, {tolerance:.0e}"
        cases.append(Case(name, run(2, tolerance, "runge_kutta"), 2, "cage, 2"))
    for turns in (20, 1):
        for tolerance in (1e-2, 1e-3):
            name = f"no cage, {turns} turn{'s' * (turns > 1)}, stiff, {tolerance:.0e}"
            cases.append(Case(name, run(turns, tolerance, cage=False), turns, f"none, {turns}"))
    mine = cases[-2]
    programs = [
        Case("no cage, 1 turn, plain, by ball", lambda: theirs(plain, turn, True), 1, "none, 1"),
        Case(
            "no cage, 1 turn, plain, LSODA's own", lambda: theirs(plain, turn, False), 1, "none, 1"
        ),
    ]
    cases += programs
    for case in (cases[0], cases[6], mine, programs[0]):
        case.call()  # compiles, warms up
    for case in (*references.values(), tight):
        case.time()
    for _ in range(ROUNDS):
        for case in cases:
            case.time()
    table(
        "case, CPU ms/turn, least, most, wall ms/turn, QV error, energy account, steps, rejected",
        [
            (
                case.name,
                f"{statistics.median(case.cpu):.2f}",
                f"{min(case.cpu):.2f}",
                f"{max(case.cpu):.2f}",
                f"{statistics.median(case.wall):.2f}",
                f"{case.qv / references[case.reference].qv - 1.0:.0e}",
                "" if case.account is None else f"{case.account:.0e}",
                *(f"{count:.0f}" for count in case.tally),
            )
            for case in (*cases, *references.values(), tight)
        ],
    )
    base = statistics.median(mine.cpu)
    for case in programs:
        ratios = sorted(p / m for p, m in zip(case.cpu, mine.cpu, strict=True))
        middle = statistics.median(case.cpu) / base
        print(f"{case.name} / {mine.name}: {middle:.0f} ({ratios[0]:.0f} to {ratios[-1]:.0f})")


# --- Where the time goes ---------------------------------------------------------------------
# Each kernel in a compiled loop of its own. What a kernel returns is stored, or the compiler would
# take the call out of the loop.


@jit
def loop_rates(count, times, states, run, b, dy, places):
    for _ in range(count):
        for i in range(times.size):
            motion_rates(times[i], states[i], run, b, dy, places)


@jit
def loop_equilibrium(count, times, states, run, b, dy, places):
    for _ in range(count):
        for i in range(times.size):
            equilibrium(times[i], states[i], run, b, places)


@jit
def loop_sweep(count, y, run, b, matrix, step):
    n = run.D.size
    for _ in range(count):
        sweep(
            run.g, run.D, run.mass, run.hertz, y[3 : BALL * n : BALL], y[4 : BALL * n : BALL],
            b.extra, b.land, b.F, run.tilt, run.first, b.s, matrix, step,
        )  # fmt: skip


@jit
def loop_cage(count, y, run, b, places):
    for _ in range(count):
        contacts_at(y, run, b, places)


@jit
def loop_friction(count, y, run, b, out):
    m = run.motion
    for _ in range(count):
        for j in range(run.D.size):
            i = BALL * j
            for k in range(2):
                contact = race_contact_of(run, b.s, j, k)
                c = slip_of(contact, y[i], y[i + 1], y[i + 2], y[i + 3], b.r[j])
                sums = friction_sums(
                    contact, 0.5 * run.D[j], c, m.mu, m.v_r, run.rule.t, run.rule.weight
                )  # fmt: skip
                for q in range(5):
                    out[j, k, q] = sums[q]


@jit
def loop_step(count, time, h, y, run, b, places, w):
    for _ in range(count):
        motion_rates(time, y, run, b, w.f, places)
        rosenbrock_step(time, h, y, run, b, places, w)


@jit
def loop_blocks(count, y, run, b):
    for _ in range(count):
        ball_blocks(y, run, b)


@jit
def loop_factorise(count, shift, y, run, b, places, w):
    for _ in range(count):
        factorise(shift, y, run, b, places, w.system)


@jit
def loop_solve(count, run, places, w):
    for _ in range(count):
        solve(w.trial, w.U[5], run, places, w.system)


@jit
def loop_powers(count, y, run, b, places, w):
    U = w.U[0]
    for _ in range(count):
        for j in range(run.D.size):
            q = BALL * j
            for v in range(4):
                w.trial[places.shaft] += b.slopes[j, 0, v] * U[q + v]
                w.trial[places.heat] += b.slopes[j, 1, v] * U[q + v]
                w.trial[places.turning] += b.slopes[j, 2, v] * U[q + v]
        add_cage_powers(U, w.trial, y, run, b, places, w.system)


@jit
def loop_control(count, h, y, run, b, places, w, out):
    for _ in range(count):
        out[0, 0, 0] = step_error(h, y, run, b, places, w, 1e-3)
        contacts_now(run, b, places, w.after)
        out[0, 0, 1], out[0, 0, 2] = event_in(w.before, w.after, run.D.size, 1e-9)
        rebase(y, run, b, places, w.f)


@jit
def loop_record(count, time, y, run, b, places, w, out, keep, log):
    for _ in range(count):
        out.before[:] = y[places.qv :]
        motion_rates(time, y, run, b, w.f, places)
        contacts_now(run, b, places, w.before)
        motion_rates(time, y, run, b, w.f, places)
        add_instant(y, run, b, places, out, keep, 0, log)


def time_of(count, loop, *args):
    """Time [us] of one of `count` passes of a loop."""
    loop(1, *args)
    marks = [clock.process_time()]
    for passes in (0, count):
        loop(passes, *args)
        marks.append(clock.process_time())
    return 1e6 * (marks[2] - 2.0 * marks[1] + marks[0]) / count


class Counts:
    """How often the equilibrium goes through balls and pockets, from its source run as Python."""

    def __init__(self):
        self.sweeps = self.passes = 0
        self.equilibrium = self.with_changed(
            joint_equilibrium, sweep=self.sweep, contacts_at=self.contacts_at
        )

    @staticmethod
    def with_changed(kernel, **names):
        """A kernel's Python function that sees other functions under these names."""
        function = kernel.py_func
        return types.FunctionType(function.__code__, function.__globals__ | names)

    def sweep(self, *args):
        self.sweeps += 1
        return quasistatic.sweep(*args)

    def contacts_at(self, *args):
        self.passes += 1
        return right_hand_side.contacts_at(*args)


def attempts(motion, duration, tolerance):
    """Steps tried over a stretch: yields their lengths, `motion` at their beginning."""
    run, b, places, w = motion.run, motion.buffers, motion.places, motion.stages
    end, longest = motion.time + duration, motion.turn / STEPS_PER_TURN
    while end - motion.time > 1e-9 * motion.turn:
        step = min(motion.h, longest, end - motion.time)
        yield step
        motion_rates(motion.time, motion.y, run, b, w.f, places)
        status = rosenbrock_step(motion.time, step, motion.y, run, b, places, w)
        error = step_error(step, motion.y, run, b, places, w, tolerance) if status == OK else 1e9
        if error <= 1.0:
            motion.time += step
            motion.y[:] = w.new
            motion_rates(motion.time, motion.y, run, b, w.f, places)
            rebase(motion.y, run, b, places, w.f)
        motion.h = step * min(4.0, max(0.2, 0.9 * max(error, 1e-9) ** (-1.0 / 3.0)))


def step_times(motion, step):
    """Times [us] of the parts of a step from here, and what was counted in it."""
    run, b, places, w = motion.run, motion.buffers, motion.places, motion.stages
    time, y = motion.time, motion.y
    assert motion_rates(time, y, run, b, w.f, places) == OK
    assert rosenbrock_step(time, step, y, run, b, places, w) == OK
    states = [y.copy()]
    states += [y + W_A[i, :i] @ w.U[:i] for i in (1, 2, 3)]
    states = np.array([*states, w.new])
    times = time + step * np.append(W_TIME, 1.0)
    out, dy = np.zeros((run.D.size, 2, 5)), np.zeros(y.size)
    matrix, vector = np.zeros((3, 3)), np.zeros(3)
    # From the beginning through three stages to the end, less the way back to the beginning.
    ends = np.ascontiguousarray(states[[0, 4]]), times[[0, 4]]
    t = {}
    for name, loop in (("rates", loop_rates), ("equilibrium", loop_equilibrium)):
        args = run, b, dy, places
        t[name] = time_of(20, loop, times, states, *args)
        t[name] -= 0.5 * time_of(20, loop, ends[1], ends[0], *args)
    step_loop = time_of(20, loop_step, time, step, y, run, b, places, w)
    step_loop -= time_of(20, loop_rates, times[:4], states[:4], run, b, dy, places)
    motion_rates(time, y, run, b, w.f, places)
    counts = Counts()
    for i in range(1, 5):
        assert counts.equilibrium(times[i], states[i], run, b, places) == OK
    motion_rates(time, y, run, b, w.f, places)
    t["sweep"] = counts.sweeps * time_of(200, loop_sweep, y, run, b, matrix, vector)
    t["cage"] = counts.passes * time_of(200, loop_cage, y, run, b, places)
    t["friction"] = 4 * time_of(100, loop_friction, y, run, b, out)
    t["blocks"] = time_of(50, loop_blocks, y, run, b)
    t["factorise"] = time_of(50, loop_factorise, 1.0 / (0.4 * step), y, run, b, places, w)
    t["solve"] = 4 * time_of(200, loop_solve, run, places, w)
    t["powers"] = 4 * time_of(200, loop_powers, y, run, b, places, w)
    t["stages"] = step_loop - t["blocks"] - t["factorise"] - t["solve"] - t["powers"]
    t["control"] = time_of(200, loop_control, step, y, run, b, places, w, out)
    touching = int(np.count_nonzero(b.cage.normal[: run.D.size] > 0.0))
    return t, (counts.passes, counts.sweeps, touching)


def profile():
    """Print the share of every part of a step."""
    scene = scene_of(PROFILE_AFTER + PROFILE_TURNS, PROFILE_TOLERANCE)
    motion = Motion.of(scene, start_of(scene).u)
    assert motion.settle() == OK
    run = Run(scene, motion, None)
    points = run.grid.points
    assert run.advance(PROFILE_AFTER * points) == OK
    begin, began = motion.packed(), motion.time
    # The stretch as it is run, once to time it and once to stop at places spread over it.
    before = run.tally.copy()
    measured = []
    for repeat in range(ROUNDS):
        motion.unpack(begin, began)
        run.done = PROFILE_AFTER * points
        cpu = clock.process_time()
        assert run.advance(PROFILE_TURNS * points) == OK
        measured.append(1e3 * (clock.process_time() - cpu) / PROFILE_TURNS)
        if repeat == 0:
            tally = (run.tally - before) / PROFILE_TURNS
    motion.unpack(begin, began)
    run.done = PROFILE_AFTER * points
    times, counted, records = [], [], []
    every = PROFILE_TURNS * points // PROFILE_STRETCHES
    for _ in range(PROFILE_STRETCHES):
        here = motion.packed(), motion.time
        records.append(
            time_of(50, loop_record, motion.time, motion.y, motion.run, motion.buffers,
                    motion.places, motion.stages, run.record, run.keep, run.log)
        )  # fmt: skip
        motion.unpack(*here)
        for step in attempts(motion, motion.turn / points, PROFILE_TOLERANCE):
            there = motion.packed(), motion.time
            part, count = step_times(motion, step)
            times.append(part)
            counted.append(count)
            motion.unpack(*there)
        motion.unpack(*here)
        assert run.advance(every) == OK
    mean = {name: float(np.mean([t[name] for t in times])) for name in times[0]}
    passes, sweeps, touching = np.array(counted).T
    steps = tally[0] + tally[1]
    rows = [
        ("ball centres and race (Newton sweeps, Hertz)", steps * mean["sweep"]),
        ("contacts of pockets and land", steps * mean["cage"]),
        (
            "their agreement with the ball centres",
            steps * (mean["equilibrium"] - mean["sweep"] - mean["cage"]),
        ),
        ("friction sums over the strips", steps * mean["friction"]),
        (
            "rates, powers and accounts",
            steps * (mean["rates"] - mean["equilibrium"] - mean["friction"]),
        ),
        ("Jacobian blocks of the balls", steps * mean["blocks"]),
        ("factorisation", steps * mean["factorise"]),
        ("solves", steps * mean["solve"]),
        ("powers in the linear system", steps * mean["powers"]),
        ("stage sums", steps * mean["stages"]),
        ("error, events, new base of the rotation", steps * mean["control"]),
        ("averages and histories", points * float(np.mean(records))),
    ]
    total = sum(row[1] for row in rows)
    print(
        f"\nturns {PROFILE_AFTER} to {PROFILE_AFTER + PROFILE_TURNS}, tolerance "
        f"{PROFILE_TOLERANCE:g}: {tally[0]:.0f} steps accepted, {tally[1]:.0f} rejected, "
        f"{tally[2]:.0f} evaluations, {tally[3]:.0f} events a turn\n"
        f"{len(times)} steps looked at: pockets touch in {np.mean(touching > 0):.0%}, "
        f"{touching.mean():.1f} of them on average, {touching.max()} at most; an evaluation takes "
        f"{passes.mean() / 4:.1f} passes over the pockets, {sweeps.mean() / 4:.1f} sweeps"
    )
    table(
        "part, us/turn, us/step tried, share",
        [(name, f"{us:.0f}", f"{us / steps:.2f}", f"{us / total:.1%}") for name, us in rows]
        + [("sum", f"{total:.0f}", f"{total / steps:.2f}", "")],
    )
    middle = statistics.median(measured)
    print(
        f"the stretch itself: {1e3 * middle:.0f} us a turn "
        f"({1e3 * min(measured):.0f} to {1e3 * max(measured):.0f}); sum / measured "
        f"{1e-3 * total / middle:.2f}"
    )


def main():
    cpu = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        cpu = names[0].split(":")[1].strip() if names else cpu
    print(f"{os.cpu_count()} cores, {cpu}, load average {os.getloadavg()[0]:.1f}; {ROUNDS} rounds")
    speed()
    profile()


if __name__ == "__main__":
    main()
