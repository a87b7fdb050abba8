"""Recommended preloads against the longest of many lives, each found as `life` finds it.

    python benchmarks/recommendations.py [-o recommendations.jsonl] [--scenes 60] [--seed 7]

draws bearings of 15, 25 and 40 degrees: single, spring pair, rigid pair; cold or warm; contacts of
Hertz or grooves that are followed; one to three limits. Each has its recommended life beside the
longest allowed one on a grid of preloads: 10 % apart, and 2 % apart beside any preload whose life,
within the limits or not, is within 10 % of the recommended one or longer, unless one limit is
passed by more than a tenth on both sides. `--whole N` takes 2 % everywhere for the first N, which
shows what that leaves out. Besides there are the bearings whose recommended life was once far below
another.

Requirements hold from rest to the speed of each bearing. A preload of the grid is allowed if its
bearing keeps to them at 17 speeds, evenly apart, new and worn, which the program itself
does not choose so; the longest life, if it is longer than the recommended one, at 65, because slip
may peak between two of the 17. `--at-speed-only` asks for the speed of each bearing alone.

A scene that is in the file is not solved again: the program may be stopped and goes on. `--again`
solves the recommendations of a file again, beside the best of its grids.
"""

import argparse
import json
import math
import random
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from comparison import table as table_text

from bearingwear.kernels.status import OK
from bearingwear.lives.many import HertzianLives, worn_life
from bearingwear.results.warnings import warnings_in
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.new.scene_file import write_scene
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.studies.design.best import SWEPT_FACTORS
from bearingwear.studies.design.choice import limit_margins
from bearingwear.studies.design.condition_extremes import new_states, state_extremes, worn_states
from bearingwear.studies.design.conditions import as_mounted, at_speed_share, is_warm
from bearingwear.studies.design.map import design_point
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.design.recommend import recommendation

SEED, SCENES = 7, 60
FINE, WIDE = 1.02, 1.10
NEAR = 0.9  # of the recommended life: above it the grid is fine
FAR = 0.1  # what a limit is passed by on both sides, where it is not
SIZES = ("7000", "7002", "7004", "7006", "7008", "7202", "7204", "7205", "7206", "7208")
ANGLES = {"C": 15, "AC": 25, "B": 40}
KINDS = ("single", "spring_pair", "rigid_pair")
STEEP = (  # contact angles of 40 degrees; gyroscopic slip ends the life at once below a preload
    ("7205B", 600, 13000, {"maximum_pressure_GPa": 1.5, "axial_stiffness_N_um": 15.0}),
    (
        "7204B",
        400,
        15000,
        {"maximum_pressure_GPa": 2.0, "friction_power_W": 60.0, "axial_stiffness_N_um": 10.0},
    ),
    ("7208B", 1200, 8500, {"maximum_pressure_GPa": 2.0, "axial_stiffness_N_um": 20.0}),
    ("7206B", 800, 11000, {"maximum_pressure_GPa": 2.0, "axial_stiffness_N_um": 20.0}),
    ("7202B", 250, 19000, {"maximum_pressure_GPa": 2.0, "axial_stiffness_N_um": 8.0}),
    ("7207B", 1000, 9500, {"maximum_pressure_GPa": 2.0, "axial_stiffness_N_um": 20.0}),
    ("7210B", 1500, 7000, {"maximum_pressure_GPa": 2.0, "axial_stiffness_N_um": 25.0}),
)
AT_SPEED_ONLY = False
FOUND = ("name", "rows", "seconds", "impractical")
SPEEDS, MORE_SPEEDS = 17, 65  # evenly apart, from rest on
COLUMNS = ("bearing", "limits", "method", "recommended N", "h", "best of all N", "h", "ratio")


def drawn(number: int, seed: int) -> dict[str, Any]:
    """A bearing and limits by chance, as plain data."""
    dice = random.Random(1000 * seed + number)
    angle = list(ANGLES)[number % 3]
    size = dice.choice(SIZES)
    outside = {"70": 1.7, "72": 2.0}[size[:2]]
    bore = {"00": 10, "02": 15}.get(size[2:], 5 * int(size[2:]))
    speed = round(dice.uniform(4e5, 9e5) / (bore * outside), -2)
    kind = KINDS[dice.randrange(3)]
    settings = [f"model.contact={('auto', 'hertz')[number % 2]}"]
    if number % 2 == 0:  # a short life of a groove that is followed costs a tenth of a whole one
        settings.append(f"wear.end_of_life.ball_diameter_loss_um={dice.choice((0.5, 1.0))}")
    if dice.random() < 0.5:
        warmer = dice.choice((3, 6, 10))
        settings += [
            f"temperature.inner_ring_C={20 + warmer}",
            f"temperature.balls_C={20 + warmer}",
            "temperature.outer_ring_C=20",
        ]
    if kind != "single":
        settings += [
            f"arrangement.kind={kind}",
            f"operation.preload_method={dict(zip(KINDS[1:], PRELOAD_METHODS, strict=True))[kind]}",
        ]
    limits = {
        "axial_stiffness_N_um": round(dice.uniform(0.2, 1.5) * bore**0.7, 1),
        "maximum_pressure_GPa": round(dice.uniform(1.2, 2.4), 2),
        "gyroscopic_slip_share": round(dice.uniform(0.15, 0.49), 2),
        "friction_power_W": round(dice.uniform(0.02, 0.2) * bore**1.5, 1),
    }
    names = dice.sample(sorted(limits), dice.randint(1, 3))
    chosen = {name: limits[name] for name in names}
    return {
        "designation": f"{size}{angle}",
        "speed": speed,
        "preload": None,
        "settings": settings,
        "limits": chosen | ({"at_speed_only": True} if AT_SPEED_ONLY else {}),
    }


def varied(number: int, seed: int) -> dict[str, Any]:
    """A film, an unlike pair under a force, or several cases, and limits by chance."""
    dice = random.Random(7000 + 1000 * seed + number)
    case = drawn(number, seed + 100)
    case["settings"] = [one for one in case["settings"] if not one.startswith("arrangement")]
    case["settings"] = [one for one in case["settings"] if "preload_method" not in one]
    case["settings"][0] = "model.contact=hertz"
    kind = ("film", "film_pair", "unlike", "cases")[number % 4]
    if kind.startswith("film"):
        film = {
            "shear_strength_MPa": dice.choice((15, 30)),
            "pressure_coefficient": 0.02,
            "thickness_um": dice.choice((0.5, 1.0)),
            "wear_coefficient": 1e-7,
            "bare_ball_race": 0.2,
        }
        case["settings"] += ["friction.ball_race=null", "uncertainty=null"]
        case["settings"] += [f"friction.film.{key}={value}" for key, value in film.items()]
        if dice.random() < 0.5:
            case["settings"].append("wear.end_of_life.film_worn_share=0.5")
    if kind == "film_pair":
        case["settings"].append("arrangement.kind=spring_pair")
    if kind == "unlike":
        force = round(dice.uniform(5.0, 40.0))
        case["settings"] += ["arrangement.kind=rigid_pair", f"arrangement.external_axial_N={force}"]
        case["settings"].append("operation.preload_method=fixed_position")
    if kind == "cases":
        slow = round(dice.uniform(0.1, 0.5) * case["speed"], -1)
        warm = {"inner_ring_C": 32, "balls_C": 31, "outer_ring_C": 26}
        case["settings"] += [f"cases.slow.operation.shaft_speed_rpm={slow}"]
        case["settings"] += [f"cases.warm.temperature.{key}={value}" for key, value in warm.items()]
    if dice.random() < 0.3:
        case["limits"]["life_h"] = 0.3
    return case


def cases(seed: int, scenes: int) -> dict[str, dict[str, Any]]:
    """All that is solved, by name."""
    known = {
        f"steep {name}": {
            "designation": name,
            "speed": speed,
            "preload": preload,
            "settings": [],
            "limits": limits,
        }
        for name, preload, speed, limits in STEEP
    }
    return known | {f"{seed}-{number:02}": drawn(number, seed) for number in range(scenes)}


def scene_of(case: dict[str, Any]) -> Scene:
    given = {"operation.shaft_speed_rpm": case["speed"], "operation.preload_N": case["preload"]}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "bearing.yaml"
        known = {key: value for key, value in given.items() if value is not None}
        write_scene(file, given=known, designation=case["designation"], bore=None, outside=None)
        return load_scene(file, case["settings"])


def solved(job: tuple[str, dict[str, Any], bool]) -> dict[str, Any]:
    """The recommendation of a case, and the best of the grid by each method."""
    name, case, whole = job
    scene, limits = scene_of(case), DesignLimits(**case["limits"])
    found = recommended(case)
    for row in found["rows"]:
        row |= grid_of(scene, row, limits, whole)
    return {"name": name, **case, **found}


def solved_again(one: dict[str, Any]) -> dict[str, Any]:
    """A case of a file with its recommendation as it is now; with its grid too, if the best of that
    is not allowed any more or lasts longer or shorter by 1e-3.
    """
    case = {key: value for key, value in one.items() if key not in FOUND}
    scene, limits, found = scene_of(case), DesignLimits(**case["limits"]), recommended(case)
    for old, new in zip(one["rows"], found["rows"], strict=True):
        new |= {key: old[key] for key in ("best_preload", "best_life", "lives")}
        if old["best_life"] > 0.0:
            life, margins = allowed_life(scene, old["method"], limits, old["best_preload"])
            if not (min(margins) >= 0.0 and abs(life / old["best_life"] - 1.0) < 1e-3):
                new |= grid_of(scene, new, limits, old["lives"] > 200)
    return one | found


def grid_of(scene: Scene, row: dict[str, Any], limits: DesignLimits, whole: bool) -> dict[str, Any]:
    """What the grid has beside a recommendation."""
    own = scene.operation.preload_N
    life = 0.0 if math.isnan(row["life"]) else row["life"]
    ends = SWEPT_FACTORS[0] * own, SWEPT_FACTORS[-1] * own
    best, lives = brute(scene, row["method"], limits, ends, life, whole)
    return {"best_preload": best[1], "best_life": best[0], "lives": lives, "whole": whole}


def recommended(case: dict[str, Any]) -> dict[str, Any]:
    """What `recommend` finds by each method, in which CPU time [s]."""
    scene = scene_of(case)
    started = time.process_time()
    found = recommendation(scene, DesignLimits(**case["limits"]))
    rows = [
        {
            "method": method,
            "preload": float(one["preload"]),
            "life": float(one["life"]),
        }
        for k, method in enumerate(PRELOAD_METHODS)
        for one in [found.isel(preload_method=k)]
    ]
    warned = [one["id"] for one in warnings_in(found.attrs) if one["impractical"]]
    spent = time.process_time() - started
    return {"rows": rows, "seconds": spent, "impractical": warned}


def brute(
    scene: Scene,
    method: str,
    limits: DesignLimits,
    ends: tuple[float, float],
    recommended: float,
    whole: bool,
) -> tuple[tuple[float, float], int]:
    """The longest allowed life of the grid [h] and its preload [N], and how many were solved."""
    known: dict[float, tuple[float, np.ndarray]] = {}

    def at(preload: float) -> tuple[float, np.ndarray]:
        if preload not in known:
            known[preload] = allowed_life(scene, method, limits, preload)
        return known[preload]

    def grid(low: float, high: float, step: float) -> list[float]:
        count = math.ceil(math.log(high / low) / math.log(step) - 1e-9)
        return [round(p, 6) for p in np.geomspace(low, high, count + 1).tolist()]

    first = grid(*ends, WIDE)
    for a, b in zip(first[:-1], first[1:], strict=True):
        (life_a, margins_a), (life_b, margins_b) = at(a), at(b)
        near = max(life_a, life_b) > NEAR * recommended
        far = margins_a.shape == margins_b.shape and np.any(np.maximum(margins_a, margins_b) < -FAR)
        if whole or (near and not far):
            for preload in grid(a, b, FINE):
                at(preload)
    allowed = [(life, p) for p, (life, left) in known.items() if min(left) >= 0.0 and life > 0.0]
    for life, p in sorted(allowed, reverse=True):
        if life <= recommended or limits.at_speed_only:
            return (life, p), len(known)
        if min(allowed_life(scene, method, limits, p, MORE_SPEEDS)[1]) >= 0.0:
            return (life, p), len(known)
    return (0.0, math.nan), len(known)


def allowed_life(
    scene: Scene, method: str, limits: DesignLimits, preload: float, speeds: int = SPEEDS
) -> tuple[float, np.ndarray]:
    """Life [h] and how far the limits are, at so many speeds from rest on."""
    held = with_method(scene, method, preload)
    alone = replace(limits, at_speed_only=True)
    values = design_point(held, alone)
    if values["status"] != OK:
        return 0.0, np.array([-math.inf])
    practical = -1.0 if values["impractical"] else 1.0
    margins = [*limit_margins(values, alone), practical]
    if not limits.at_speed_only:
        each = held.in_cases.values()
        margins.append(min(least_elsewhere(one, limits, speeds) for one in each))
    return float(values["life"]) / 3600.0, np.array(margins)


def least_elsewhere(scene: Scene, limits: DesignLimits, speeds: int) -> float:
    """The least margin at so many speeds from rest on, new and worn; -inf where something is not
    solved or carries nothing.
    """
    life = worn_life(scene, quick=False) or HertzianLives(scene)(scene)
    least = math.inf
    for solve in (new_states, worn_states(life)):
        shares = np.linspace(0.0, 1.0, speeds)[:-1].tolist()
        cold = [1.0 / speeds, 0.0] if is_warm(scene) else []
        for share, warm in [
            *((share, True) for share in shares),
            *((share, False) for share in cold),
        ]:
            one = at_speed_share(scene, share) if warm else as_mounted(at_speed_share(scene, share))
            states = solve(one)
            if warm and any(state.status != OK for state in states):
                near = at_speed_share(scene, share + 0.5 / speeds)
                states = solve(near)  # the motion may go over to another one just there
            if any(state.status != OK for state in states):
                return -math.inf
            found = state_extremes(one, states, {}, with_quasistatic=False)
            values = {name: each["value"] for name, each in found.items()}
            asked = replace(limits, life_h=None)
            least = min(least, *limit_margins(values, asked))
    return float(least)


def ratio(row: dict[str, Any]) -> float:
    """The recommended life over the best of the grid; 1 where there is neither."""
    life = 0.0 if math.isnan(row["life"]) else row["life"]
    if row["best_life"] == 0.0:
        return 1.0 if life == 0.0 else math.inf
    return float(life / row["best_life"])


def table(found: list[dict[str, Any]]) -> str:
    rows, ratios = [], []
    for one in found:
        limits = ", ".join(f"{name} {value:g}" for name, value in one["limits"].items())
        for row in one["rows"]:
            ratios.append(ratio(row))
            numbers = (row["preload"], row["life"], row["best_preload"], row["best_life"])
            shown = ["-" if math.isnan(x) else f"{x:.4g}" for x in numbers]
            rows.append(
                [
                    f"{one['name']} {one['designation']}",
                    limits,
                    row["method"],
                    *shown,
                    f"{ratios[-1]:.4f}",
                ]
            )
    worst = min(ratios)
    lives = sum(row["lives"] for one in found for row in one["rows"])
    beyond = sum(r > 1.0 for r in ratios)
    return (
        table_text(COLUMNS, rows, 3)
        + f"\n\n{len(found)} bearings, {len(ratios)} choices, {lives} lives of the grid: the least "
        f"ratio is {worst:.4f}; {sum(r < 0.99 for r in ratios)} below 0.99; {beyond} above 1.\n"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("-o", "--output", type=Path, default=Path("recommendations.jsonl"))
    parser.add_argument("--scenes", type=int, default=SCENES)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--whole", type=int, default=0, metavar="N", help="2 %% everywhere in N")
    parser.add_argument("--again", action="store_true", help="the recommendations of a file anew")
    parser.add_argument("--at-speed-only", action="store_true")
    parser.add_argument("--varied", action="store_true", help="films, unlike pairs, cases")
    parser.add_argument("--coarse", action="store_true", help="a grid half as fine")
    parser.add_argument("--no-steep", dest="steep", action="store_false", help="none of 40 degrees")
    args = parser.parse_args()
    global AT_SPEED_ONLY, FINE, WIDE
    AT_SPEED_ONLY = args.at_speed_only
    if args.coarse:
        FINE, WIDE = 1.04, 1.2
    known = {}
    if args.output.exists():
        for line in args.output.read_text().splitlines():
            one = json.loads(line)
            known[one["name"]] = one
    wanted = (
        cases(args.seed, args.scenes)
        if args.steep
        else {name: one for name, one in cases(args.seed, args.scenes).items() if name[0].isdigit()}
    )
    if args.varied:
        wanted = {f"v{k:02}": varied(k, args.seed) for k in range(args.scenes)}
    whole = [name for name in wanted if name[0].isdigit()][: args.whole]
    jobs = [(name, case, name in whole) for name, case in wanted.items() if name not in known]
    jobs.sort(key=lambda job: "model.contact=hertz" not in job[1]["settings"])  # cheap ones first
    with ProcessPoolExecutor(args.workers) as pool:
        if args.again:
            known = {one["name"]: one for one in pool.map(solved_again, known.values())}
            args.output.write_text("".join(json.dumps(one) + "\n" for one in known.values()))
        with args.output.open("a") as file:
            for one in pool.map(solved, [] if args.again else jobs):
                known[one["name"]] = one
                file.write(json.dumps(one) + "\n")
                file.flush()
    print(table([known[name] for name in wanted if name in known]))


if __name__ == "__main__":
    main()
