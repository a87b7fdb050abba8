"""Warm-ups of random pairs: each must end in the steady network or in a named ending.

python benchmarks/random_warmups.py --count 200 --seed 1
"""

from __future__ import annotations

import argparse
import math
import time
import warnings
from collections import Counter

import numpy as np

import bearingwear
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.warmup.transient import ramp, warm_up

SIZES = [(10, 26), (20, 42), (25, 47), (30, 55), (40, 68), (50, 72), (50, 80), (70, 110)]


def drawn(rng: np.random.Generator) -> tuple[bearingwear.Scene, float]:
    """A pair with a thermal network, and the time of its ramp [s]."""

    def between(low: float, high: float) -> float:
        return float(f"{math.exp(rng.uniform(math.log(low), math.log(high))):.3g}")

    bore, outside = SIZES[rng.integers(len(SIZES))]
    dm = 0.5 * (bore + outside)
    scene = bearingwear.new(
        bore=bore,
        outside=outside,
        contact_angle=float(rng.choice([15.0, 25.0])),
        speed=between(0.1, 1.3) * 1e6 / dm,
        preload_method=str(rng.choice(["fixed_position", "constant_force"])),
    )
    G = dm / 54.0
    mass = 1e-9 * 7800.0 * 0.5 * (outside - bore) * math.pi * dm * 0.15 * (outside - bore)
    rigid = scene.operation.preload_method == "fixed_position"
    changes = {
        "operation.preload_N": scene.operation.preload_N * between(0.3, 3.0),
        "arrangement": {
            "kind": "rigid_pair" if rigid else "spring_pair",
            "orientation": str(rng.choice(["back_to_back", "face_to_face"])),
            "external_axial_N": float(rng.choice([0.0, 0.2, 0.5]) * scene.operation.preload_N),
        }
        | ({} if rigid else {"spring_stiffness_N_um": 1.0}),
        "thermal": {
            "conductance_W_K": {
                "inner_ring_shaft": between(0.05, 5.0) * G,
                "outer_ring_housing": between(0.5, 20.0) * G,
                "ball_race": between(0.3, 4.0) * G,
            },
            "heat_capacity_J_K": {
                "inner_ring": 460.0 * mass,
                "balls": 200.0 * mass,
                "outer_ring": 460.0 * mass,
            },
            "housing_C": float(rng.uniform(15.0, 45.0)),
            "shaft_C": float(rng.uniform(15.0, 45.0)),
            "housing_time_constant_s": float(rng.choice([0.0, 300.0, 3000.0])),
        },
    }
    return scene.with_(changes), float(rng.choice([0.0, 5.0, 60.0]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    rng, counts = np.random.default_rng(given.seed), Counter[str]()
    slowest = 0.0
    for trial in range(given.count):
        scene, seconds = drawn(rng)
        started = time.process_time()
        found = warm_up(scene, ramp(seconds))
        took = time.process_time() - started
        slowest = max(slowest, took)
        states = solver_of(scene)
        steady = states(states.bearings.start)
        steady_status = STATUS_NAMES[next((s.status for s in steady if s.status != OK), OK)]
        ending = "steady" if found.status == OK else STATUS_NAMES[found.status]
        if found.status != OK and found.runs_away:
            ending = "runaway"
        if ending == "steady" and steady_status == "ok":
            T = np.array([s["part_temperature"][:3] for s in steady])
            rise = np.abs(found.instants[-1].temperatures - 20.0).max()
            off = np.abs(found.instants[-1].temperatures - T).max() / rise
            ending += "" if off < 2e-3 else f", off by {off:.2g}"
            ending += "" if found.left < 1e-3 else ", not settled"
        counts[f"{ending} (network: {steady_status})"] += 1
        print(
            f"{trial:4d} {ending} network {steady_status} margin {found.margin:.3g} "
            f"{len(found.instants)} instants {found.instants[-1].time:.4g} s, "
            f"took {took:.2f} CPU s",
            flush=True,
        )
    print(f"slowest: {slowest:.2f} CPU s")
    for ending, count in counts.most_common():
        print(f"{count:4d} {ending}")


if __name__ == "__main__":
    main()
