"""What more processes gain for `bearingwear.sweep`: `python benchmarks/sweep.py [WORKERS ...]`.

Lives of gyro_s1 over preload and friction, with one process and with more, each three times, one
after the other; the least wall time counts. Kernels are compiled before. Nothing else should run.

`python benchmarks/sweep.py states` compares 10 000 steady states by two processes with 1000 solves
one after the other.
"""

import math
import os
import sys
import time
import warnings

import numpy as np

import bearingwear

CHANGES = {
    "operation.preload_N": np.linspace(4.0, 20.0, 40),
    "friction.ball_race": [0.05, 0.08, 0.1],
}
ROUNDS = 3


def wall_time(workers: int) -> float:
    """Wall time of a sweep [s]."""
    scene = bearingwear.example()
    started = time.monotonic()
    bearingwear.sweep(scene, CHANGES, what="life", workers=workers, progress=False)
    return time.monotonic() - started


def cpu_time() -> float:
    """CPU time of this process and of those that it waited for [s]."""
    return sum(os.times()[:4])


def cost_of_states(points: int = 100, solves: int = 1000) -> None:
    """Print the cost of a state of a sweep, and of a solve."""
    scene = bearingwear.example()
    changes = {
        "operation.preload_N": np.linspace(4.0, 20.0, points),
        "friction.ball_race": np.linspace(0.04, 0.12, points),
    }
    bearingwear.solve(scene)
    cpu = cpu_time()
    for preload in np.linspace(4.0, 20.0, solves):
        bearingwear.solve(scene.with_({"operation.preload_N": preload}))
    solve = (cpu_time() - cpu) / solves
    cpu, started = cpu_time(), time.monotonic()
    bearingwear.sweep(scene, changes, workers=2, progress=False)
    cpu, wall = cpu_time() - cpu, time.monotonic() - started
    print(
        f"{points * points} states: {cpu:.1f} s of CPU time, {wall:.1f} s of wall time; "
        f"{1e3 * cpu / points**2:.2f} ms a state, {1e3 * solve:.2f} ms a solve"
    )


def main() -> None:
    if sys.argv[1:] == ["states"]:
        return cost_of_states()
    warnings.simplefilter("ignore")  # of worn grooves
    counts = [1, *(int(text) for text in sys.argv[1:] or ["2"])]
    bearingwear.life(bearingwear.example())
    best = dict.fromkeys(counts, math.inf)
    for _ in range(ROUNDS):
        for workers in counts:
            best[workers] = min(best[workers], wall_time(workers))
    lives = int(np.prod([len(values) for values in CHANGES.values()]))
    for workers, seconds in best.items():
        gain = best[1] / seconds
        print(f"{lives} lives, {workers} workers: {seconds:.2f} s, {gain:.2f} times as fast")


if __name__ == "__main__":
    main()
