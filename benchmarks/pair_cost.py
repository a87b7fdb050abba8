"""Processor time of pairs and networks: a solve over that of one bearing, lives of a design map.

python benchmarks/pair_cost.py
"""

import random
import time
from pathlib import Path

import numpy as np

from bearingwear.scene.read import load_scene
from bearingwear.solvers.solve import solve
from bearingwear.studies.design.map import life_point, scene_at

GYRO = Path(__file__).parents[1] / "config/scenes/gyro_s1.yaml"
ONE = ["operation.preload_method=fixed_position"]
TWO = [*ONE, "arrangement.kind=rigid_pair", "arrangement.external_axial_N=3.5"]
SPRING = ["arrangement.kind=spring_pair", "arrangement.external_axial_N=1"]
NETWORK = [
    f"thermal.conductance_W_K.{name}={value}"
    for name, value in (
        ("inner_ring_shaft", 0.01),
        ("outer_ring_housing", 0.02),
        ("ball_race", 0.005),
    )
]
KINDS = {
    "one bearing": ONE,
    "unlike pair": TWO,
    "one bearing with a network": ONE + NETWORK,
    "unlike pair with a network": TWO + NETWORK,
}
ROUNDS, LIVES = 50, 80


def seconds(work, *given) -> float:
    """Processor time of a call [s]."""
    start = time.process_time()
    work(*given)
    return time.process_time() - start


def solves() -> None:
    scenes = [load_scene(GYRO, changes) for changes in KINDS.values()]
    for scene in scenes:
        solve(scene)
    times = np.array([[seconds(solve, scene) for scene in scenes] for _ in range(ROUNDS)])
    least, middle = times.min(axis=0), np.median(times, axis=0)
    for k, name in enumerate(KINDS):
        over = [f"{one[k] / one[0]:.2f} times" for one in (least, middle)]
        print(f"{name}: {1e3 * least[k]:.2f} ms, {over[0]} by least times, {over[1]} by medians")


def lives() -> None:
    """Points of the map in config/design.yaml, drawn."""
    base, chance, times = load_scene(GYRO, SPRING), random.Random(5), []
    life_point(base, None)
    for _ in range(LIVES):
        method = chance.choice(["constant_force", "fixed_position"])
        mu, speed = 0.01 * chance.randint(2, 17), 2500.0 * chance.randint(4, 19)
        preload = 0.5 * chance.randint(2, 41)
        times.append(seconds(life_point, scene_at(base, method, mu, speed, preload), 0.25))
    mean = np.mean(times)
    print(
        f"life of an unlike pair: mean {1e3 * mean:.1f} ms, longest {1e3 * max(times):.0f} ms; "
        f"20 000 on two cores: {20000 * mean / 120:.1f} min"
    )


if __name__ == "__main__":
    solves()
    lives()
