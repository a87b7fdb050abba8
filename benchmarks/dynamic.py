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
from pathlib import Path

import numpy as np
import plain_dynamic
import plain_scipy
from before import scene_keys
from dynamic_parts import PROFILE_TOLERANCE, part_rows, part_times

from bearingwear.kernels.status import OK
from bearingwear.scene.read import load_scene
from bearingwear.solvers.dynamic.outputs import window_values
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.dynamic.windows import TimeRun
from bearingwear.solvers.start import start_of
from kerneljit.interrupt import Interrupt

SCENE = Path(__file__).resolve().parents[1] / "config" / "scenes" / "gyro_s1.yaml"
ROUNDS = 5
REFERENCE = 1e-5  # tolerance of the runs that QV is compared with
PLAIN_RTOL = 1e-4  # of LSODA: QV is right to 1e-6 and better, and looser is not faster
PROFILE_AFTER, PROFILE_TURNS = 50, 20
PROFILE_STRETCHES = 40


def scene_of(turns, tolerance, integrator="rosenbrock", cage=True):
    """The benchmark's scene, averaged over all its turns."""
    keys = [*scene_keys(turns, tolerance, cage), f"model.integrator={integrator}"]
    return load_scene(SCENE, keys)


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
    call: object  # () -> seconds of CPU, seconds of wall, QV, energy balance, tally
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
    system = DynamicSystem.of(scene, start)
    assert system.update() == OK
    run = TimeRun(scene, system, None)
    with Interrupt():
        cpu, wall = clock.process_time(), clock.perf_counter()
        status = run.window(run.grid.window)
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


def our_cases(run):
    """References by name, the cases compared with them, and one in between."""
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
    return references, cases, tight


def speed():
    """Time all cases and print them."""
    start = start_of(scene_of(20, REFERENCE)).u
    plain = plain_dynamic.Motion(plain_scipy.S1, plain_scipy.INSTRUMENT, 1.0)
    turn = 2 * np.pi / plain.op.speed[0]

    def run(*args, **kwargs):
        scene = scene_of(*args, **kwargs)
        return lambda: ours(scene, start)

    references, cases, tight = our_cases(run)
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
        "case, CPU ms/turn, least, most, wall ms/turn, QV error, energy balance, steps, rejected",
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


def profile():
    """Print the share of every part of a turn."""
    scene = scene_of(PROFILE_AFTER + PROFILE_TURNS, PROFILE_TOLERANCE)
    system = DynamicSystem.of(scene, start_of(scene).u)
    assert system.update() == OK
    run = TimeRun(scene, system, None)
    points = run.grid.points
    assert run.advance(PROFILE_AFTER * points) == OK
    kept, began = system.packed(), system.time
    before = run.tally.copy()
    measured = []
    for repeat in range(ROUNDS):
        system.unpack(kept, began)
        run.done = PROFILE_AFTER * points
        cpu = clock.process_time()
        assert run.advance(PROFILE_TURNS * points) == OK
        measured.append(1e3 * (clock.process_time() - cpu) / PROFILE_TURNS)
        if repeat == 0:
            tally = (run.tally - before) / PROFILE_TURNS
    accepted, rejected, _, events = tally
    system.unpack(kept, began)
    run.done = PROFILE_AFTER * points
    times = []
    for _ in range(PROFILE_STRETCHES):
        times.append(part_times(run, system.turn / accepted))
        assert run.advance(PROFILE_TURNS * points // PROFILE_STRETCHES) == OK
    mean = {name: float(np.mean([t[name] for t in times])) for name in times[0]}
    tried = accepted + rejected
    rows = part_rows(mean, accepted, tried, points)
    total = sum(row[1] for row in rows)
    print(
        f"\nturns {PROFILE_AFTER} to {PROFILE_AFTER + PROFILE_TURNS}, tolerance "
        f"{PROFILE_TOLERANCE:g}: {accepted:.0f} steps accepted, {rejected:.0f} rejected, "
        f"{events:.0f} events a turn; {len(times)} places looked at"
    )
    table(
        "part, us/turn, us/step tried, share",
        [(name, f"{us:.0f}", f"{us / tried:.2f}", f"{us / total:.1%}") for name, us in rows]
        + [("sum", f"{total:.0f}", f"{total / tried:.2f}", "")],
    )
    middle = statistics.median(measured)
    print(
        f"the run itself: {1e3 * middle:.0f} us a turn "
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
