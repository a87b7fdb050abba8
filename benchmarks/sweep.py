"""What more processes gain for `bearingwear.sweep`: `python benchmarks/sweep.py [WORKERS ...]`.

Lives of gyro_s1 over preload and friction, with one process and with more, each three times, one
after the other; the least wall time counts. Kernels are compiled before. Nothing else should run.
"""

import math
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


def main() -> None:
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
