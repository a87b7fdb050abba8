"""Slip over the whole ellipse: error over points, and cost against the model of the paper.

    python benchmarks/ellipse.py [errors] [in_time] [cost]

Errors are those of QV of steady states against 100 x 32 points, at v_r = 1e-4 m/s: gyro_s1 at two
frictions, new and worn by 0.5 um, by both preload methods; turbopump and bearing218. Costs are
thread CPU times, warm, of both models in turn; each is the median of many. The dynamic model takes
points of its own: its errors are against 100 x 32 of them, over four turns after ten.
"""

import statistics
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from bearingwear.kernels.contact.summary import QV
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.parameters import ellipse_rule
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.solve import solve

SCENES = Path(__file__).resolve().parents[1] / "config" / "scenes"
ALONG = [("split", n) for n in (20, 24, 32, 48, 64)] + [("gauss", n) for n in (20, 100)]
ACROSS = (1, 4, 8, 12, 24)
SETTLED, TURNS = 30.0, 30  # turns before those that are timed, and timed


def scene_of(name: str, *settings: str) -> Scene:
    return load_scene(SCENES / f"{name}.yaml", settings)


def states() -> Iterator[tuple[ThrustProblem, float]]:
    """Problems and ball diameters."""
    common = ["model.contact=hertz", "friction.slip_regularisation_m_s=1.0e-4"]
    for method in ("constant_force", "fixed_position"):
        for mu in (0.02, 0.08):
            settings = [f"operation.preload_method={method}", f"friction.ball_race={mu}"]
            problem = ThrustProblem.of(scene_of("gyro_s1", *common, *settings))
            yield problem, problem.g.D0
            yield problem, problem.g.D0 - 0.5e-6
    for name in ("turbopump", "bearing218"):
        problem = ThrustProblem.of(scene_of(name, *common))
        yield problem, problem.g.D0


def qv(problem: ThrustProblem, D: float, *rule: str | int) -> np.ndarray:
    """QV of both contacts [W] by a rule."""
    points = ellipse_rule(*rule)
    case = replace(problem, rule=points, fine_rule=points).solve(D)
    assert case.status == 0
    return case.contacts[:, QV]


def errors() -> None:
    every = list(states())
    right = [qv(*state, "split", 100, 32) for state in every]
    print("| along | across | total QV, median | worst | QV of a contact, worst |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for name, n in ALONG:
        for m in ACROSS:
            found = [qv(*state, name, n, m) for state in every]
            pairs = list(zip(found, right, strict=True))
            total = [abs(q.sum() / r.sum() - 1.0) for q, r in pairs]
            one = max(np.abs(q / r - 1.0).max() for q, r in pairs)
            print(
                f"| {name} {n} | {m} | {np.median(total):.1e} | {max(total):.1e} | {one:.1e} |",
                flush=True,
            )


def qv_in_time(name: str, *settings: str) -> np.ndarray:
    """QV [W] of inner and outer contacts under thrust, without the cage, by the dynamic model."""
    scene = scene_of(name, "model.contact=hertz", *settings).without_cage
    problem = ThrustProblem.of(scene)
    D = problem.g.D0 - 1e-6 * float(np.mean(scene.wear.ball_diameter_loss_um))
    system = DynamicSystem.of(scene, problem.solve(D).u)
    assert system.advance(10.0 * system.turn, 1e-4).status == 0
    before = system.qv.sum(axis=0)
    assert system.advance(4.0 * system.turn, 1e-4).status == 0
    return (system.qv.sum(axis=0) - before) / (4.0 * system.turn)


def in_time() -> None:
    worn = ["wear.ball_diameter_loss_um=0.5", "operation.preload_method=fixed_position"]
    cases = [("turbopump", [])]
    cases += [
        ("gyro_s1", [f"friction.ball_race={mu}", *more])
        for mu in (0.02, 0.08)
        for more in ([], worn)
    ]
    right = [qv_in_time(n, *s, "model.strips=100", "model.points_across=32") for n, s in cases]
    print("| along | across | total QV, median | worst | QV of a contact, worst |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for along, across in ((20, 4), (20, 8), (24, 8), (48, 24)):
        rule = f"model.strips={along}", f"model.points_across={across}"
        found = [qv_in_time(n, *s, *rule) for n, s in cases]
        pairs = list(zip(found, right, strict=True))
        total = [abs(q.sum() / r.sum() - 1.0) for q, r in pairs]
        one = max(np.abs(q / r - 1.0).max() for q, r in pairs)
        print(f"| {along} | {across} | {np.median(total):.1e} | {max(total):.1e} | {one:.1e} |")


def times(both: list[Callable[[], object]], repeats: int) -> list[float]:
    """Median thread CPU times [s] of calls that take turns."""
    for call in both:
        call()
    taken: list[list[float]] = [[] for _ in both]
    for _ in range(repeats):
        for call, kept in zip(both, taken, strict=True):
            started = time.thread_time()
            call()
            kept.append(time.thread_time() - started)
    return [statistics.median(kept) for kept in taken]


def next_turn(scene: Scene, state: np.ndarray) -> Callable[[], object]:
    """The next shaft turn of a motion that began beside the steady state.

    The first turns take a third of the steps of later ones, in which the cage whirls, and the two
    models leave them at different turns.
    """
    system = DynamicSystem.of(scene, state + np.array([0.0, 50.0, 0.0, 0.0]))
    tolerance = scene.model.dynamic_tolerance
    system.advance(SETTLED * system.turn, tolerance)
    return lambda: system.advance(system.turn, tolerance)


def row(what: str, name: str, paper: float, hertz: float) -> None:
    print(f"| {what} | {name} | {1e3 * paper:.3g} | {1e3 * hertz:.3g} | {hertz / paper:.2f} |")


def cost() -> None:
    print("| case | scene | paper, ms | hertz, ms | ratio |\n| --- | --- | ---: | ---: | ---: |")
    for name in ("gyro_s1", "turbopump", "bearing218"):
        both = [scene_of(name, f"model.contact={c}") for c in ("paper", "hertz")]
        problems = [ThrustProblem.of(scene) for scene in both]
        taken = times([lambda p=p: p.solve(p.g.D0) for p in problems], 200)
        row("steady state", name, *taken)
        taken = times([lambda s=s: solve(s, "steady") for s in both], 40)
        row("the same with search and error estimates", name, *taken)
        if name == "bearing218":
            continue
        for what, cage in (("a dynamic turn", False), ("a dynamic turn with the cage", True)):
            scenes = both if cage else [scene.without_cage for scene in both]
            states = [p.solve(p.g.D0).u for p in problems]
            calls = [next_turn(s, u) for s, u in zip(scenes, states, strict=True)]
            row(what, name, *times(calls, TURNS))


if __name__ == "__main__":
    for part in sys.argv[1:] or ["errors", "in_time", "cost"]:
        {"errors": errors, "in_time": in_time, "cost": cost}[part]()
