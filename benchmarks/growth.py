"""What growth at speed, temperature or a second bearing change, scene by scene, and their cost.

`python benchmarks/growth.py` prints the table of docs/accuracy.md, "Growth and temperature",
`python benchmarks/growth.py machine` that of "Two bearings". Each row is against the bearing as
mounted, alone; times are CPU times of whole steady solves and lives, compiled code warm, the median
of five.
"""

import statistics
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from bearingwear.model.life import life
from bearingwear.model.result import Result
from bearingwear.model.solve import solve
from bearingwear.scene.blocks import PRELOAD_METHODS
from bearingwear.scene.checking import read_record
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import COUNTS, Scene
from bearingwear.sides import of_bearing
from bearingwear.studies.accuracy.machine import on_a_rotor
from bearingwear.studies.accuracy.plan import ACCURACY_FILE, MACHINES, WARMTHS, AccuracyPlan
from bearingwear.studies.accuracy.warmth import grown_scene

STEPS = {"growth": (WARMTHS, grown_scene), "machine": (MACHINES, on_a_rotor)}
ROOT = Path(__file__).resolve().parents[1]
SCENES = ("gyro_fresh", "turbopump", "bearing218")
REPEATS = 5


def timed(run: Callable[[], Result]) -> tuple[dict[str, Any], float]:
    found, durations = run(), []
    for _ in range(REPEATS):
        started = time.process_time()
        found = run()
        durations.append(time.process_time() - started)
    return found.values | {"name": found.status}, statistics.median(durations)


def row(scene: Scene) -> tuple[dict[str, float], str]:
    """Preload, QV and life, times of solve and life; or the status of what was not solved."""
    case, solving = timed(lambda: solve(scene, "steady"))
    if case["status"]:
        return {}, case["name"]
    lived, living = timed(lambda: life(scene, "steady"))
    if lived["status"]:
        return {}, lived["name"]
    if scene.pair is not None:
        case = of_bearing({key: value for key, value in case.items() if key != "name"}, 0)
    return {
        "preload": float(case["residual_preload"]),
        "QV": float(case["total_qv"]),
        "life": float(lived["life"][COUNTS.index(scene.wear.counts)]),
        "solve": solving,
        "life's time": living,
    }, "ok"


def main() -> None:
    steps, changed = STEPS[sys.argv[1] if len(sys.argv) > 1 else "growth"]
    plan = read_record(AccuracyPlan, ROOT / ACCURACY_FILE)
    print("| scene, preload | what | preload | QV | life | time of a solve | time of a life |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: |")
    for name in SCENES:
        settings = [f"{key}={value}" for key, value in plan.scene_settings(name).items()]
        scene = load_scene(ROOT / plan.scene_file(name), settings)
        for method in PRELOAD_METHODS:
            held = replace(scene, operation=replace(scene.operation, preload_method=method))
            mounted, _ = row(held)
            for step in steps[1:]:
                found, status = row(changed(held, step))
                cells = [f"{found[key] / mounted[key]:.3g}" for key in found] or [status, *4 * " "]
                where = f"{name}, {method.replace('_', ' ')}"
                print(f"| {where} | {step.replace('_', ' ')} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
