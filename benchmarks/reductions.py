"""What each reduction of the model saves and what it costs, scene by scene.

`python benchmarks/reductions.py` prints the table of docs/accuracy.md, "What a scene requires", and
draws docs/figures/reductions.svg. Errors are against the fuller model with the same settings of
accuracy; times are CPU times of whole solves, compiled code warm, the median of five.
"""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.ticker import LogLocator

from bearingwear.plotting.drawing import SERIES, frame, key, new_figure, save
from bearingwear.results.words import name_in_words
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene
from bearingwear.solvers.solve import solve

ROOT = Path(__file__).resolve().parents[1]
FIGURE = ROOT / "docs" / "figures" / "reductions.svg"
REPEATS = 5
TURNS = 20
LEAST = 1e-9  # smaller differences are drawn there
LIGHT = 1e-3  # density of balls that have hardly any centrifugal force and gyroscopic moment


@dataclass(frozen=True)
class Reduction:
    """A simpler and a fuller way to solve a scene."""

    name: str
    reduced: Callable[[Scene], dict]
    full: Callable[[Scene], dict]
    scenes: tuple[str, ...]


def steady(scene: Scene) -> dict:
    return solve(scene, "steady").values


def in_time(scene: Scene) -> dict:
    return solve(replace(scene, cage=None), "dynamic").values


def with_cage(scene: Scene) -> dict:
    return solve(scene, "dynamic").values


def without_drag(scene: Scene) -> dict:
    return steady(replace(scene, lubricant=replace(scene.lubricant, drag_density_kg_m3=0.0)))


def without_inertia(scene: Scene) -> dict:
    name = scene.bearing.ball_material
    light = replace(
        scene.materials[name], density_kg_m3=LIGHT * scene.materials[name].density_kg_m3
    )
    return steady(replace(scene, materials={**scene.materials, name: light}))


REDUCTIONS = (
    Reduction(
        "one ball for all, steady", steady, in_time,
        ("gyro_s1", "gyro_s1_drag", "turbopump", "bearing218"),
    ),
    Reduction("cage neglected", in_time, with_cage, ("gyro_s1", "turbopump", "turbine")),
    Reduction("drag neglected", without_drag, steady, ("gyro_s1_drag",)),
    Reduction(
        "centrifugal and gyroscopic effects neglected", without_inertia, steady,
        ("gyro_s1", "gyro_s1_drag", "turbopump", "bearing218"),
    ),
)  # fmt: skip
MARKS = {
    "gyro_s1": "o", "gyro_s1_drag": "s", "turbopump": "D", "bearing218": "^", "turbine": "v",
}  # fmt: skip
ROTATING = {"gyro_s1": 1.0, "turbopump": 200.0, "turbine": 4000.0}


def scene_of(name: str, rotating: bool) -> Scene:
    load = ROTATING[name] if rotating else 0.0
    settings = [f"operation.rotating_load_N={load}", f"model.simulated_turns={TURNS}"]
    return load_scene(ROOT / "config" / "scenes" / f"{name}.yaml", settings)


def timed(run: Callable[[], dict]) -> tuple[dict, float]:
    values, durations = run(), []
    for _ in range(REPEATS):
        started = time.process_time()
        values = run()
        durations.append(time.process_time() - started)
    return values, statistics.median(durations)


def difference(one: dict, other: dict, name: str) -> float:
    a, b = np.asarray(one[name]), np.asarray(other[name])
    return float(np.abs(a / b - 1.0).max())


def main() -> None:
    figure, panels = new_figure(1, 1, 6.4, 4.0)
    axes, found = panels[0, 0], []
    heads = "wear rate of the balls | loss rate"
    print(f"| reduction | scene | times as fast | total QV | {heads} |")
    print("| --- | --- | ---: | ---: | ---: | ---: |")
    for k, reduction in enumerate(REDUCTIONS):
        for name in reduction.scenes:
            scene = scene_of(name, reduction.full is with_cage)
            reduced, short = timed(lambda r=reduction, s=scene: r.reduced(s))
            full, long = timed(lambda r=reduction, s=scene: r.full(s))
            if reduced["status"] or full["status"]:
                print(f"| {reduction.name} | {name} | no solution | | | |")
                continue
            qv = difference(reduced, full, "total_qv")
            balls = abs(reduced["ball_wear_rate"].mean() / full["ball_wear_rate"].mean() - 1.0)
            loss = difference(reduced, full, "ball_diameter_loss_rate")
            print(
                f"| {reduction.name} | {name} | {long / short:.2g} | {qv:.1e} "
                f"| {balls:.1e} | {loss:.1e} |"
            )
            found.append((reduction.name, long / short, qv))
            axes.plot(
                long / short,
                max(qv, LEAST),
                marker=MARKS[name],
                color=SERIES[k],
                linestyle="none",
            )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.axvline(1.0, color="0.6", linewidth=0.8)
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.set_xlabel("speed relative to the fuller model")
    axes.set_ylabel("relative difference of total QV")
    axes.axhline(LEAST, color="0.6", linewidth=0.8, linestyle=":")
    axes.text(1.1, 1.2 * LEAST, "differences below 1e-9 are drawn here", va="bottom")
    colours = [
        key(r.name, color=SERIES[k], linewidth=5, solid_capstyle="butt")
        for k, r in enumerate(REDUCTIONS)
    ]
    scenes = [
        key(name_in_words(name), color="0.4", marker=mark, linestyle="none")
        for name, mark in MARKS.items()
    ]
    fast, error = (
        {r.name: [row[k] for row in found if row[0] == r.name] for r in REDUCTIONS} for k in (1, 2)
    )
    one, cage, *forces = (r.name for r in REDUCTIONS)
    lost = max(e for name in forces for e in error[name])
    title = (
        f"One ball for all changes QV by up to {100 * max(error[one]):.1g} % and is "
        f"{min(fast[one]):.0f} to {max(fast[one]):.0f} times as fast; neglecting the cage changes "
        f"QV by up to {100 * max(error[cage]):.1g} %, neglecting forces by up to "
        f"{100 * lost:.0f} %"
    )
    frame(figure, title, [*colours, key("", linestyle="none"), *scenes], columns=2)
    save(figure, [FIGURE])


if __name__ == "__main__":
    main()
