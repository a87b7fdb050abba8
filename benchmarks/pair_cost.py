"""Processor time of a pair's steady solve over that of one bearing's, interleaved.

python benchmarks/pair_cost.py
"""

import time
from pathlib import Path

import numpy as np

from bearingwear.model.solve import solve
from bearingwear.scene.read import load_scene

GYRO = Path(__file__).parents[1] / "config/scenes/gyro_s1.yaml"
ONE = ["operation.preload_method=fixed_position"]
TWO = [*ONE, "arrangement.kind=rigid_pair", "arrangement.external_axial_N=3.5"]
ROUNDS = 50


def seconds(scene) -> float:
    """Processor time of one solve [s]."""
    start = time.process_time()
    solve(scene)
    return time.process_time() - start


one, two = (load_scene(GYRO, changes) for changes in (ONE, TWO))
solve(one), solve(two)
times = np.array([(seconds(one), seconds(two)) for _ in range(ROUNDS)])
least, middle = times.min(axis=0), np.median(times, axis=0)
print(f"one bearing {1e3 * least[0]:.2f} ms, unlike pair {1e3 * least[1]:.2f} ms")
print(f"ratio of least times {least[1] / least[0]:.2f}, of medians {middle[1] / middle[0]:.2f}")
