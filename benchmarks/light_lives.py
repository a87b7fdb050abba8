"""Lives under light preloads, drawn at random: how many end by their solver.

    python benchmarks/light_lives.py
    python benchmarks/light_lives.py --count 1000 --seed 3 --only 17,120

Each scene is a bearing of `bearingwear new` at a small part of its light preload, whose grooves are
followed to a loss of ball diameter; exactly, and quickly as `recommend` does. A quick life whose
states are not found is followed exactly, which the table counts. A life that ends otherwise is
followed again at preloads 1 % below and above. It fails *alone* where both of these end as they
should: then no physics ends it. Lives whose new bearing has no state are not counted.

Prints a line for each life that ends by its solver, and a table. Three minutes of CPU time for 300.
"""

import argparse
import json
import time
import warnings
from collections import Counter
from functools import partial
from typing import Any

import numpy as np

import bearingwear
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.lives.follow import Life
from bearingwear.lives.grooves import EXACT_GROOVES, Grooves, follow_grooves, quick_groove_life
from bearingwear.scene.scene import Scene

SEED, COUNT = 48, 300
SERIES, SUFFIXES = ("719", "70", "72"), {"C": 15.0, "E": 18.0, "AC": 25.0}
BORE_CODES = (0, 10)  # bores of 10 to 50 mm
RACE_SPEED = (0.1e6, 0.9e6)  # shaft speed by pitch diameter [mm r/min]
FILM_SPEED = (30.0, 3000.0)  # [r/min], of bearings with a film
PRELOAD = (0.02, 0.3)  # of the light preload
LOSS = (0.02e-3, 0.12e-3)  # at the end of life, over the diameter of a ball
WARMER = (0.0, 12.0)  # inner ring and balls than the outer ring [K]
EXTERNAL = (0.0, 0.5)  # axial force on a rigid pair, over its preload
NEIGHBOURS = 0.98, 0.99, 1.01, 1.02  # preloads beside one at which a life failed, over that
ENDED = ("ok", "criterion_not_reached")
WAYS = ("exact", "quick")


def drawn(rng: np.random.Generator) -> dict[str, Any]:
    """What makes one scene, in round numbers."""

    def log_uniform(low: float, high: float) -> float:
        return float(f"{np.exp(rng.uniform(np.log(low), np.log(high))):.4g}")

    series, suffix = str(rng.choice(SERIES)), str(rng.choice([*SUFFIXES]))
    return {
        "designation": f"{series}{rng.integers(*BORE_CODES, endpoint=True):02d}{suffix}",
        "ball_material": str(rng.choice(["steel", "steel", "silicon_nitride"])),
        "film": bool(rng.random() < 0.15),
        "race_speed": log_uniform(*RACE_SPEED),
        "film_speed": log_uniform(*FILM_SPEED),
        "method": str(rng.choice(["constant_force", "fixed_position"])),
        "preload": log_uniform(*PRELOAD),
        "loss": log_uniform(*LOSS),
        "warmer": round(float(rng.choice([0.0, rng.uniform(*WARMER)])), 2),
        "friction": log_uniform(0.03, 0.2),
        "is_pair": bool(rng.random() < 0.15),
        "external": round(float(rng.uniform(*EXTERNAL)), 3),
    }


def drawn_scene(draw: dict[str, Any], share: float = 1.0) -> Scene:
    """The scene of a draw at a share of its preload."""
    known: dict[str, Any] = {"designation": draw["designation"], "speed": 100.0}
    if draw["film"]:
        known["lubrication"] = "mos2"
    elif draw["ball_material"] != "steel":
        known["ball_material"] = draw["ball_material"]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = bearingwear.new(**known)
    bearing, light = scene.bearing, scene.operation.preload_N
    speed = draw["race_speed"] / bearing.pitch_diameter_mm
    preload = share * draw["preload"] * light
    method = "fixed_position" if draw["is_pair"] else draw["method"]
    keys: dict[str, Any] = {
        "operation.shaft_speed_rpm": draw["film_speed"] if draw["film"] else speed,
        "operation.preload_N": preload,
        "operation.preload_method": method,
        "wear.end_of_life": {
            "ball_diameter_loss_um": 1e3 * draw["loss"] * bearing.ball_diameter_mm
        },
        "model.contact": "worn",
        "cage": None,
    }
    if not draw["film"]:
        keys["friction.ball_race"] = draw["friction"]
    if draw["warmer"]:
        warm = 20.0 + draw["warmer"]
        keys["temperature"] = {"inner_ring_C": warm, "balls_C": warm, "outer_ring_C": 20.0}
    if draw["is_pair"]:
        keys["arrangement"] = {
            "kind": "rigid_pair",
            "orientation": "back_to_back",
            "external_axial_N": draw["external"] * draw["preload"] * light,
            "span_mm": 3.0 * bearing.pitch_diameter_mm,
        }
        if draw["warmer"]:
            keys["temperature"] |= {"shaft_C": warm, "housing_C": 20.0, "reference_C": 20.0}
    return scene.with_(keys)


def life_of(scene: Scene, way: str) -> Life:
    """Returns the exact or the quick life of a scene."""
    grooves = partial(Grooves, scene.symmetric_half)
    return follow_grooves(grooves()) if way == "exact" else quick_groove_life(grooves)


def ends_as_it_should(life: Life) -> bool:
    """Returns whether a life is not ended by its solver."""
    return STATUS_NAMES[life.status] in ENDED


def main() -> None:
    options = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    options.add_argument("--count", type=int, default=COUNT)
    options.add_argument("--seed", type=int, default=SEED)
    options.add_argument("--only", help="these trials alone, separated by commas")
    options.add_argument("--lives", help="file for a line of JSON for each life")
    asked = options.parse_args()
    only = [int(k) for k in asked.only.split(",")] if asked.only else range(asked.count)
    draws = [drawn(np.random.default_rng((asked.seed, k))) for k in range(max(only) + 1)]
    totals: dict[str, Counter[str]] = {way: Counter() for way in WAYS}
    started = time.process_time()
    for k in only:
        for way in WAYS:
            life, count = life_of(drawn_scene(draws[k]), way), totals[way]
            status, is_new_solved = STATUS_NAMES[life.status], life.nodes[0].status == OK
            line: dict[str, Any] = {
                "trial": k, "way": way, "status": status, "life_s": life.last.time,
            }  # fmt: skip
            count["lives" if is_new_solved else "no state when new"] += 1
            if is_new_solved and not ends_as_it_should(life):
                beside = [life_of(drawn_scene(draws[k], share), way) for share in NEIGHBOURS]
                line |= {
                    "nodes": len(life.nodes),
                    "beside": [STATUS_NAMES[other.status] for other in beside],
                    "draw": draws[k],
                }
                count[f"end {status}"] += 1
                below, above = beside[:2], beside[2:]
                count["end alone"] += all(
                    any(map(ends_as_it_should, side)) for side in (below, above)
                )
            elif way == "quick" and life.wearing.mode is EXACT_GROOVES:
                count["followed exactly"] += 1
                print(json.dumps(line), flush=True)
            if asked.lives:
                with open(asked.lives, "a", encoding="utf-8") as file:
                    file.write(json.dumps(line) + "\n")
    columns = sorted({name for count in totals.values() for name in count}, key=str.lower)
    print(f"\n| life | {' | '.join(columns)} |\n| --- |" + " ---: |" * len(columns))
    for way, count in totals.items():
        print(f"| {way} | {' | '.join(str(count[name]) for name in columns)} |")
    print(f"\n{time.process_time() - started:.0f} s of CPU time")


if __name__ == "__main__":
    main()
