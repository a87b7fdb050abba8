"""A turn of the motion in time against that of another commit.

    git worktree add FOLDER COMMIT
    python benchmarks/before.py FOLDER

The scene is that of dynamic.py. Each program runs in a process of its own; rounds of both follow
each other, so that the machine's load moves both alike. CPU time of runs as `solve_dynamic` makes
them, their histories kept, without the search for the start. Errors of QV are against the same
program at 1e-6.
"""

import json
import os
import statistics
import subprocess
import sys
import time as clock
from pathlib import Path

ROUNDS = 5
REFERENCE = 1e-6  # tolerance of the runs that QV is compared with
CASES = [
    (cage, turns, tolerance)
    for cage, turns in ((True, 20), (True, 100), (False, 20))
    for tolerance in (1e-2, 3e-3, 1e-3)
]


def scene_keys(turns: int, tolerance: float, cage: bool = True) -> list[str]:
    """What the benchmarks of the motion in time change in gyro_s1: averaged over all its turns."""
    keys = [
        "operation.rotating_load_N=1.0",
        "model.quadrature=strips",
        "model.strips=50",
        f"model.simulated_turns={turns}",
        f"model.evaluated_turns={turns}",
        f"model.dynamic_tolerance={tolerance:.7f}",
    ]
    return keys if cage else [*keys, "cage=null"]


def answer() -> None:
    """Run the cases that standard input asks for; one line of JSON each."""
    from bearingwear.kernels.status import OK
    from bearingwear.scene.read import load_scene
    from bearingwear.solvers.dynamic.outputs import window_values
    from bearingwear.solvers.dynamic.run import Interrupt  # in commits of any age
    from bearingwear.solvers.dynamic.system import DynamicSystem
    from bearingwear.solvers.dynamic.windows import TimeRun
    from bearingwear.solvers.start import start_of

    start = None
    for line in sys.stdin:
        cage, turns, tolerance = json.loads(line)
        scene = load_scene("config/scenes/gyro_s1.yaml", scene_keys(turns, tolerance, cage))
        start = start_of(scene).u if start is None else start
        system = DynamicSystem.of(scene, start)
        assert system.update() == OK
        run = TimeRun(scene, system, None)
        with Interrupt() as block:
            more = [block] * (TimeRun.window.__code__.co_argcount - 2)  # of older commits
            begun = clock.process_time()
            assert run.window(run.grid.window, *more) == OK
            cpu = clock.process_time() - begun
        values, steps = window_values(scene, run), run.tally[:2] / turns
        found = 1e3 * cpu / turns, values["total_qv"], values["energy_account_error"], *steps
        print(json.dumps([float(value) for value in found]), flush=True)


class Program:
    """A work tree's program, which answers for as long as this one runs."""

    def __init__(self, folder: Path) -> None:
        names = "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"
        self.process = subprocess.Popen(
            [sys.executable, Path(__file__).resolve(), "--answer"],
            cwd=folder,
            env=os.environ | dict.fromkeys(names, "1") | {"PYTHONPATH": str(folder)},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def run(self, case: tuple) -> list[float]:
        """CPU time [ms a turn], QV [W], energy balance, steps accepted and refused a turn."""
        assert self.process.stdin is not None and self.process.stdout is not None
        print(json.dumps(case), file=self.process.stdin, flush=True)
        return json.loads(self.process.stdout.readline())


def main() -> None:
    programs = [Program(Path(sys.argv[1]).resolve()), Program(Path(__file__).resolve().parents[1])]
    kinds = {case[:2] for case in CASES}
    right = [{kind: p.run((*kind, REFERENCE))[1] for kind in kinds} for p in programs]
    found: dict = {case: ([], []) for case in CASES}
    for _ in range(ROUNDS):
        for case in CASES:
            for program, rounds in zip(programs, found[case], strict=True):
                rounds.append(program.run(case))
    print(
        "| case | old, ms/turn (least) | new (least) | ratio | QV error, old | new |",
        end="",
    )
    print(" steps, old | new |\n| --- |" + " ---: |" * 7)
    for case, pair in found.items():
        cage, turns, tolerance = case
        cpu = [[r[0] for r in rounds] for rounds in pair]
        middle = [statistics.median(c) for c in cpu]
        ratios = sorted(a / b for a, b in zip(*cpu, strict=True))
        columns = [
            f"{'cage' if cage else 'no cage'}, {turns} turns, {tolerance:.0e}",
            *(f"{m:.2f} ({min(c):.2f})" for m, c in zip(middle, cpu, strict=True)),
            f"{statistics.median(ratios):.1f} ({ratios[0]:.1f} to {ratios[-1]:.1f})",
            *(
                f"{rounds[0][1] / r[case[:2]] - 1.0:.0e}"
                for rounds, r in zip(pair, right, strict=True)
            ),
            *(f"{rounds[0][3]:.0f} + {rounds[0][4]:.0f}" for rounds in pair),
        ]
        print("| " + " | ".join(columns) + " |")


if __name__ == "__main__":
    answer() if sys.argv[1] == "--answer" else main()
