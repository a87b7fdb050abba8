"""Processor time of lives over a duty beside those of its phases alone, and of a recommendation.

python benchmarks/duty_cost.py gyro.yaml    # that of docs/duty.md
"""

from __future__ import annotations

import argparse
import time
import warnings
from collections.abc import Callable
from typing import Any

import bearingwear
from bearingwear.lives.duty.lives import duty_life, lives_alone
from bearingwear.lives.many import HertzianLives, worn_life
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene

ROUNDS = 3
STIFFNESS = 4.0  # of the arrangement [N/um]


def seconds(work: Callable[[], Any], rounds: int = ROUNDS) -> float:
    """Least processor time of a call [s], after one that compiles what is not yet compiled."""
    times = []
    for _ in range(rounds + 1):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times[1:])


def quick(scene: Scene) -> Any:
    return worn_life(scene) or HertzianLives(scene, quick=True)(scene)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", help="a scene with a duty")
    args = parser.parse_args()
    warnings.simplefilter("ignore")
    scene = load_scene(args.scene)
    over_duty = duty_life(scene)
    cases = [scene.in_cases[name] for name in over_duty.cycle.cases]
    rows = {
        "states of a life": (
            seconds(lambda: duty_life(scene)),
            seconds(lambda: lives_alone(over_duty)),
        ),
        "quick life": (
            seconds(lambda: quick(scene)),
            seconds(lambda: [quick(case) for case in cases]),
        ),
        "bearingwear.life": (
            seconds(lambda: bearingwear.life(scene)),
            seconds(lambda: [bearingwear.life(case) for case in cases]),
        ),
    }
    for name, (over, alone) in rows.items():
        print(
            f"{name}: {over:.2f} s over the duty, {alone:.2f} s for the {len(cases)} cases alone, "
            f"{over / alone:.2f} times"
        )
    one = seconds(lambda: bearingwear.recommend(cases[0], stiffness=STIFFNESS), rounds=1)
    over = seconds(lambda: bearingwear.recommend(scene, stiffness=STIFFNESS), rounds=1)
    print(f"recommend: {over:.1f} s over the duty, {one:.1f} s for the first case alone")


if __name__ == "__main__":
    main()
