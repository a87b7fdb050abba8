"""How often the error estimates that results carry are above the true error.

`python benchmarks/estimates.py [STEADY] [DYNAMIC]` tries so many random scenes (200 and 20), solved
with random settings of accuracy; the truth is the same scene solved with settings far finer.
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.life import life
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene
from bearingwear.solvers.solve import solve

SCENES = Path(__file__).resolve().parents[1] / "config" / "scenes"
NAMES = ("gyro_s1", "gyro_s2", "gyro_s3", "gyro_s1_drag", "turbopump", "bearing218")
IN_TIME = ("gyro_s1", "gyro_s1_drag", "turbopump", "turbine")
CASE = {
    "qv_error_estimate": "total_qv",
    "residual_preload_error_estimate": "residual_preload",
    "wear_rate_error_estimate": "ball_diameter_loss_rate",
    "shaft_torque_error_estimate": "shaft_torque",
}
LIFE = {"life_error_estimate": "life"}
RIGHT = ["model.quadrature=split", "model.strips=200", "model.points_across=32"]
TRUE_STEADY = [*RIGHT, "friction.slip_regularisation_m_s=1.0e-6", "model.tolerance=1.0e-9"]
TRUE_IN_TIME = [*RIGHT, "friction.slip_regularisation_m_s=1.0e-5", "model.dynamic_tolerance=1.0e-5"]


def scene_of(name: str, *settings: str) -> Scene:
    """A scene of the project with settings, as `--set` takes them."""
    return load_scene(SCENES / f"{name}.yaml", settings)


def worn(scene: Scene, share: float) -> Scene:
    """The scene with a share of the loss of diameter that ends its life."""
    end = scene.wear.end_of_life
    loss = share * (end.ball_diameter_loss_um if end else 0.0)
    return replace(scene, wear=replace(scene.wear, ball_diameter_loss_um=(loss,)))


def steady_trial(random: np.random.Generator) -> tuple[str, list[str], float]:
    """A scene, settings of accuracy, and how worn it is."""
    rule = random.choice(["split", "gauss", "strips"])
    points = int(random.integers(20, 120)) if rule == "split" else int(random.integers(8, 200))
    mu = round(float(random.uniform(0.02, 0.12)), 3)
    method = random.choice(["constant_force", "fixed_position"])
    settings = [
        f"operation.preload_method={method}",
        f"friction.ball_race={mu}",
        f"model.contact={random.choice(['paper', 'hertz'])}",
        f"model.points_across={int(random.integers(4, 17))}",
        f"model.quadrature={rule}",
        f"model.strips={points}",
        f"friction.slip_regularisation_m_s={10 ** random.uniform(-5.0, -2.0):.7f}",
        f"model.tolerance={10 ** random.uniform(-6.0, -2.0):.9f}",
    ]
    return str(random.choice(NAMES)), settings, float(random.uniform(0.0, 0.8))


def trial_in_time(random: np.random.Generator) -> tuple[str, list[str], float]:
    """The same for a dynamic run with a rotating load, half of them with the scene's cage."""
    name = str(random.choice(IN_TIME))
    load = {"turbine": 4000.0, "turbopump": 200.0}.get(name, 1.0) * random.uniform(0.2, 1.0)
    settings = [
        f"operation.rotating_load_N={load:.3f}",
        f"model.cage_results={random.choice(['true', 'false'])}",
        f"model.contact={random.choice(['paper', 'hertz'])}",
        "model.quadrature=split",
        f"model.strips={int(random.integers(20, 60))}",
        f"friction.slip_regularisation_m_s={10 ** random.uniform(-4.5, -2.5):.7f}",
        f"model.dynamic_tolerance={10 ** random.uniform(-3.0, -1.0):.7f}",
        f"model.simulated_turns={int(random.integers(6, 25))}",
        "model.settled_drift=1.0e-3",
    ]
    return name, settings, float(random.uniform(0.0, 0.4))


def compared(trial: dict, truth: dict, names: dict[str, str]) -> list[tuple[str, float, float]]:
    """Name, estimate and true error of each estimate that was made."""
    rows = []
    for estimate, name in names.items():
        if estimate in trial:
            right = np.asarray(truth[name])
            error = np.abs(np.asarray(trial[name]) / right - 1.0)
            bound = np.broadcast_to(trial[estimate], error.shape)
            rows += [
                (name, float(b), float(e)) for b, e in zip(bound.flat, error.flat, strict=True)
            ]
    return rows


def steady_rows(trials: int, seed: int = 1) -> list[tuple[str, float, float]]:
    """Estimates and errors of random steady solves and lives."""
    random, rows = np.random.default_rng(seed), []
    for _ in range(trials):
        name, settings, share = steady_trial(random)
        some = worn(scene_of(name, *settings), share)
        right = worn(scene_of(name, *settings[:3], *TRUE_STEADY), share)
        one, other = solve(some, "steady").values, solve(right, "steady").values
        if one["status"] == other["status"] == code.OK:
            rows += compared(one, other, CASE)
        one, other = life(some, "steady").values, life(right, "steady").values
        same = one["end_criterion"] == other["end_criterion"]
        if one["status"] == other["status"] == code.OK and same:
            rows += compared(one, other, LIFE)
    return rows


def rows_in_time(trials: int, seed: int = 2, turns: int = 150) -> list[tuple[str, float, float]]:
    """Estimates and errors of random dynamic runs."""
    random, rows = np.random.default_rng(seed), []
    long = [f"model.simulated_turns={turns}", "model.settled_drift=1.0e-6"]
    for _ in range(trials):
        name, settings, share = trial_in_time(random)
        some = worn(scene_of(name, *settings), share)
        right = worn(scene_of(name, *settings[:3], *TRUE_IN_TIME, *long), share)
        one = solve(some, "auto").values
        other = solve(right, "auto").values
        if one["status"] == other["status"] == code.OK:
            rows += compared(one, other, CASE)
    return rows


def table(title: str, rows: list[tuple[str, float, float]]) -> str:
    """Coverage by quantity, and how far above the error the estimate is."""
    lines = [f"{title:<28} compared  covered  estimate over error, median"]
    for name in dict.fromkeys(name for name, *_ in rows):
        pairs = np.array([(b, e) for n, b, e in rows if n == name])
        covered = 100.0 * np.mean(pairs[:, 0] >= pairs[:, 1])
        ratio = np.median(pairs[:, 0] / np.maximum(pairs[:, 1], 1e-12))
        lines.append(f"{name:<28} {len(pairs):8d} {covered:7.1f}%  {ratio:.1f}")
    return "\n".join(lines)


def main() -> None:
    given = [int(text) for text in sys.argv[1:]]
    steady, in_time = [*given, *(200, 20)[len(given) :]]
    if steady:
        print(table("steady", steady_rows(steady)))
    if in_time:
        print(table("in time", rows_in_time(in_time)))


if __name__ == "__main__":
    main()
