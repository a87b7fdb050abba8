"""Quasi-static stiffness against the slope of further solves, in random steady scenes.

    python benchmarks/stiffness.py [SCENES [SEED]]

Bearings of the catalogue, single and in pairs, Hertzian and as the paper has them, cold and warm.
The slope is that of solves at places nearby (a pair: under forces nearby), central differences
extrapolated to no distance. It must be that to 1e-4.
"""

import sys
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from bearingwear.api import new
from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene, SceneError
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.condition import Accuracy
from bearingwear.solvers.rotor import OnRotor
from bearingwear.solvers.steady import axial_force

SIZES = (
    "7000C",
    "7003C",
    "7004AC",
    "7005C",
    "7008C",
    "7205B",
    "7206AC",
    "7208B",
    "7014C",
    "7016AC",
)
STEPS = 1e-3, 1e-4, 1e-5  # of the deformation, or of the preload: the longest that is smooth
SMOOTH = 1e-5  # by so much the difference of a step and of half of it may differ
ALLOWED = 1e-4
ALMOST = 1e-9  # symmetric, but solved as two bearings


def drawn(random: np.random.Generator) -> Scene:
    """A scene from a catalogue size."""
    size = str(random.choice(SIZES))
    position = bool(random.random() < 0.5)
    made = new(
        designation=size,
        speed=1e3,
        preload=100.0,
        friction=round(float(random.uniform(0.03, 0.15)), 3),
        preload_method="fixed_position" if position else "constant_force",
        ball_material=str(random.choice(["bearing_steel", "silicon_nitride"])),
    )
    D, dm = made.bearing.ball_diameter_mm, made.bearing.pitch_diameter_mm
    changes: dict = {
        "operation.shaft_speed_rpm": float(10.0 ** random.uniform(4.0, 5.9) / dm),
        "operation.preload_N": float(10.0 ** random.uniform(-0.7, 0.7) * D * D),
        "model.contact": str(random.choice(["hertz", "hertz", "paper"])),
        "wear.ball_diameter_loss_um": float(random.choice([0.0, 0.3])),
        "cage": None,
    }
    if random.random() < 0.3:
        inner = float(random.uniform(20.0, 40.0))
        changes["temperature"] = {"inner_ring_C": inner, "balls_C": inner, "outer_ring_C": 22.0}
    kind = random.choice(["single", "single", "symmetric", "loaded", "unlike"])
    if kind != "single":
        share = ALMOST if kind == "symmetric" else float(random.uniform(-0.5, 0.8))
        arrangement = {
            "kind": "rigid_pair" if position else "spring_pair",
            "external_axial_N": share * changes["operation.preload_N"],
        }
        if not position:
            arrangement["spring_stiffness_N_um"] = float(random.choice([0.0, 1.0]))
        if kind == "unlike":
            arrangement["second"] = {"friction.ball_race": 0.06, "wear.ball_diameter_loss_um": 0.5}
            arrangement["tandem"] = [2, 1]
        changes["arrangement"] = arrangement
    return made.with_(changes)


def slope(value: Callable[[float], float], scale: float) -> float:
    """Derivative at 0; NaN where no step is smooth."""
    for share in STEPS:
        h = share * scale
        whole, half = ((value(s) - value(-s)) / (2.0 * s) for s in (h, 0.5 * h))
        if abs(half / whole - 1.0) <= SMOOTH:
            return (4.0 * half - whole) / 3.0
    return np.nan


def of_single(scene: Scene) -> tuple[float, float, float]:
    """Reported quasi-static stiffness, slope of solves, and dynamic stiffness."""
    problem = ThrustProblem.of(scene).without_finer
    D = problem.g.D0 - scene.wear.ball_diameter_loss_um[0] * 1e-6
    case = problem.solve(D)
    if case.status != code.OK or not problem.stable(D, case):
        raise ArithmeticError

    def force(step: float) -> float:
        held = problem.preload._replace(constant_force=False, delta_a=case.delta_a + step)
        return axial_force(replace(problem, preload=held).solve(D, case.u))

    found = slope(force, axial_force(case) / case.S_xx)
    return case.S_quasistatic, found, case.S_xx


def of_pair(scene: Scene) -> tuple[float, float, float]:
    """The same of an arrangement."""
    assert scene.arrangement is not None
    pair = solver_of(scene, "steady", Accuracy.CHECKED).bearings
    assert isinstance(pair, OnRotor)
    state = pair.solve(pair.start)
    if state.status != code.OK:
        raise ArithmeticError
    F = scene.arrangement.external_axial_N

    def shift(step: float) -> float:
        pair.arrangement = replace(scene.arrangement, external_axial_N=F + step)
        return pair.solve(pair.start).shift

    found = 1.0 / slope(shift, scene.operation.preload_N)
    return state.quasistatic, found, state.stiffness


def row(name: str, errors: list[float]) -> str:
    """Of the table."""
    cells = " | ".join(f"{q:.0e}" for q in np.quantile(errors, (0.5, 0.95, 1.0)))
    return f"| {name} | {len(errors)} | {cells} |"


def main(scenes: int = 200, seed: int = 1) -> int:
    """Print the table; 1 where an error is not allowed."""
    random, unsolved, differ = np.random.default_rng(seed), 0, 0
    errors: dict[str, list[float]] = {}
    while sum(map(len, errors.values())) < scenes:
        scene = drawn(random)
        try:
            reported, found, dynamic = (of_pair if scene.pair else of_single)(scene)
        except (ArithmeticError, SceneError):
            unsolved += 1
            continue
        name = f"{'pairs' if scene.pair else 'single'}, {scene.model.contact}"
        error = abs(reported / found - 1.0)
        errors.setdefault(name, []).append(error)
        differ += abs(reported / dynamic - 1.0) > 0.05
        if not error <= ALLOWED:
            print(f"{scene.description}\n{scene.operation}\n{name}: {error:.1e}", file=sys.stderr)
    print("| scenes | number | median | 95 % | largest |")
    print("|---|---|---|---|---|")
    for name in sorted(errors):
        print(row(name, errors[name]))
    every = [error for some in errors.values() for error in some]
    print(row("all", every))
    print(
        f"{differ} differ from the dynamic stiffness by more than 5 %; {unsolved} were not solved"
    )
    return int(not max(every) <= ALLOWED)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
