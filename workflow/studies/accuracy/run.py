"""Solves and times the points of one sweep of the study of accuracy on one scene."""

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.kernels import status as code
from bearingwear.kernels.equilibrium.kinematics import OUTER_CONTROL
from bearingwear.lives.groove_life import wear_over_gap
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene
from bearingwear.sides import of_bearing
from bearingwear.solvers.bearing.fitted_hertz import fitted_displacement, fitted_factors
from bearingwear.solvers.bearing.outputs import wear_values
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.dynamic.outputs import window_values
from bearingwear.solvers.dynamic.parts import exact_factors, hertz_table
from bearingwear.solvers.dynamic.system import DynamicSystem
from bearingwear.solvers.dynamic.windows import TimeRun
from bearingwear.solvers.effects.choice import asymmetries
from bearingwear.solvers.race_control import race_control_motion
from bearingwear.solvers.solve import solve
from bearingwear.solvers.start import start_of, thrust_alone
from bearingwear.studies.answers import answer_values, answers_at
from bearingwear.studies.dataset import dataset_of_rows
from kerneljit.interrupt import Interrupt
from workflow.studies.accuracy.plan import (
    SweepPoint,
    against,
    check_known,
    read_accuracy,
    scene_settings,
    sweep_points,
)
from workflow.studies.accuracy.quantities import SWEEP
from workflow.studies.accuracy.scenes import ended_scene, grown_scene, lived_through, on_a_rotor

FEWEST_BALLS = 3  # that hold the race in the middle without a radial load


def solved_sweep(plan: Path, scene: str, sweep: str) -> xr.Dataset:
    """All points of a sweep of a plan, or of a reference, on one of its scenes.

    A solve is timed as often as the plan says, unless these repeats have taken its `seconds`.
    """
    accuracy = read_accuracy(plan)
    check_known(scene, accuracy["scenes"], f"{plan}: scenes")
    check_known(sweep, (*accuracy["references"], *accuracy["sweeps"]), f"{plan}: sweeps")
    file = plan.parent / "scenes" / f"{accuracy['scenes'][scene]['file']}.yaml"
    settings, points = scene_settings(accuracy, scene), list(sweep_points(accuracy, sweep))
    timed_as = accuracy["repeats"], accuracy["seconds"]
    what = partial(_values_at, file, settings, timed_as)
    # one after the other: points that share the cores would take longer
    answers = answers_at(what, points, workers=1, label=f"{scene}, {sweep}")
    rows = [
        {"label": point.label, "value": point.value, "settings": point.text} | answer_values(answer)
        for point, answer in zip(points, answers, strict=True)
    ]
    given = accuracy["sweeps"].get(sweep)
    return dataset_of_rows(
        SWEEP,
        {"point": len(rows)},
        rows,
        title=f"Accuracy against time: {scene}, {sweep}",
        scene_name=scene,
        sweep_name=sweep,
        sweep_title=given["title"] if given else sweep,
        sweep_kind=given["kind"] if given else "reference",
        against=against(given) if given else sweep,
        comment="Wall times vary from run to run, so the file is not reproducible byte for byte.",
    )


def _values_at(
    file: Path, settings: Mapping[str, str], timed_as: tuple[int, float], point: SweepPoint
) -> dict[str, float]:
    return point_values(load_scene(file, point.overrides(settings)), point, *timed_as)


def point_values(scene: Scene, point: SweepPoint, repeats: int, seconds: float) -> dict[str, float]:
    """What a point gives and what it takes, by the names of the variables."""
    grown = grown_scene(scene, point.warmth)
    grown = ended_scene(grown, point.end)
    scene = on_a_rotor(grown, point.machine)
    run = runner(scene, point)
    short = replace(scene, model=replace(scene.model, simulated_turns=0.25, evaluated_turns=None))
    runner(short, point)()  # compiles
    values, wall, processor = timed(run, repeats, seconds)
    row = {"status": float(values["status"])}
    if values["status"] != code.OK:
        return row
    row |= quantities(scene, values) | {
        "wall_time": statistics.median(wall),
        "wall_time_least": min(wall),
        "processor_time": statistics.median(processor),
        "repeats": float(len(wall)),
        "steps": float(values.get("steps_accepted", np.nan) + values.get("steps_rejected", np.nan)),
    }
    for name in ("simulated_turns", "coriolis_energy_share", "azimuth_energy_share"):
        row[name] = float(values.get(name, np.nan))
    if "qv_error_estimate" in values:
        own = values if scene.pair is None else of_bearing(values, 0)
        row["estimate_total_qv"] = float(own["qv_error_estimate"])
        row["estimate_residual_preload"] = float(own["residual_preload_error_estimate"])
        row["estimate_wear_rate"] = float(own["wear_rate_error_estimate"])
    fresh = replace(grown, wear=replace(grown.wear, ball_diameter_loss_um=(0.0,)))
    return row | life_quantities(on_a_rotor(fresh, point.machine), point, repeats, seconds)


def life_quantities(
    fresh: Scene, point: SweepPoint, repeats: int, seconds: float
) -> dict[str, float]:
    """What a life from new gives and takes; nothing where the model has none."""
    if point.fidelity != "steady" or asymmetries(fresh) or not fresh.wear.end_of_life:
        return {}
    row = {"wear_over_gap": wear_over_gap(fresh)}
    lived, wall, processor = timed(lambda: lived_through(fresh, point), repeats, seconds)
    if lived["status"] == code.OK:
        row["life"] = float(lived["life"]) * HOURS_PER_SECOND
        if "life_error_estimate" in lived:
            row["estimate_life"] = float(lived["life_error_estimate"])
        if "history_total_qv" in lived:
            own = lived if fresh.pair is None else of_bearing(lived, 0)
            row["end_qv"] = float(own["history_total_qv"][-1])
        row["life_wall_time"] = statistics.median(wall)
        row["life_processor_time"] = statistics.median(processor)
    return row


def timed(
    run: Callable[[], dict], repeats: int, seconds: float
) -> tuple[dict, list[float], list[float]]:
    """Answer of a solve, and durations and processor times of its repeats [s]."""
    wall: list[float] = []
    processor: list[float] = []
    values: dict = {}
    while len(wall) < repeats and sum(wall) < seconds:
        started, used = time.perf_counter(), time.process_time()
        values = run()
        processor.append(time.process_time() - used)
        wall.append(time.perf_counter() - started)
    return values, wall, processor


def quantities(scene: Scene, values: dict) -> dict[str, float]:
    """The numbers that errors are asked of, of the first bearing of two."""
    if scene.pair is not None:
        values = of_bearing(values, 0)
    qv = values["qv"].mean(axis=0)
    row = {
        "total_qv": float(values["total_qv"]),
        "qv_inner": float(qv[0]),
        "qv_outer": float(qv[1]),
        "residual_preload": float(values["residual_preload"]),
        "wear_rate": float(values["ball_diameter_loss_rate"]),
    }
    if "cage_wear_rate" in values:
        row["cage_wear_rate"] = float(values["cage_wear_rate"] + values["cage_land_wear_rate"])
    return row


# The ways of solving a point


def runner(scene: Scene, point: SweepPoint) -> Callable[[], dict]:
    """The solve of a point as something to call."""
    fidelity = point.fidelity
    if fidelity == "race_control":
        return lambda: solve(scene, fidelity).values
    if fidelity == "steady":
        thrust = thrust_alone(scene)
        return lambda: solve(thrust, fidelity).values
    if fidelity == "three_balls":
        return lambda: three_balls(scene)
    trial = scene.without_cage if fidelity == "no_cage" else scene
    if not (point.start or point.hertz):
        return lambda: solve(trial, "dynamic").values
    return lambda: dynamic_values(trial, point.start or "steady", point.hertz == "fit")


def three_balls(scene: Scene) -> dict:
    """Solved dynamically with three balls under their share of the preload, thrust alone, no cage.

    A single ball would push the race aside. The numbers are those of the whole bearing again.
    """
    n = scene.bearing.ball_count
    share = FEWEST_BALLS / n
    whole = thrust_alone(scene)
    few = replace(
        whole,
        bearing=replace(whole.bearing, ball_count=FEWEST_BALLS),
        operation=replace(whole.operation, preload_N=share * whole.operation.preload_N),
        cage=None,
    )
    values = dict(solve(few, "dynamic").values)
    if values["status"] == code.OK:
        for name in ("total_qv", "residual_preload", "race_wear_rate"):
            values[name] = values[name] / share
        # the balls lose as much as those of the whole bearing, a groove is worn by fewer
        D = 1e-3 * few.bearing.ball_diameter_mm - values["ball_diameter_loss"]
        balls = np.mean(2.0 * values["ball_wear_rate"] / (np.pi * D * D))
        rate = values["ball_diameter_loss_rate"]
        values["ball_diameter_loss_rate"] = balls + (rate - balls) / share
    return values


def dynamic_values(scene: Scene, start: str, fit: bool) -> dict:
    """Solved dynamically from a stated start, with exact or fitted Hertz factors."""
    system = DynamicSystem.of(scene, first_motion(scene, start))
    if fit:
        fix_hertz(scene, system)
    values: dict = {"status": system.update()}
    if values["status"] != code.OK:
        return values
    with Interrupt():
        run = TimeRun(scene, system, None)
        for length in run.grid.windows:
            values["status"] = run.window(length)
            if values["status"] != code.OK:
                return values
    values |= window_values(scene, run) | run.counts(run.grid.window / run.grid.points)
    if fit:
        D = system.bearing.D
        axes = values["semi_major_axis"] * major_ratio(system, values["contact_angle"])
        values |= wear_values(scene, D, values["qv"], axes, values["contact_track_radius"])
    return values


def first_motion(scene: Scene, start: str) -> np.ndarray:
    """(w_x, w_y, w_z, Omega) of all balls, or of each, to start from."""
    if start == "kinematic":
        return ThrustProblem.of(scene).kinematic_start(OUTER_CONTROL)
    if start == "race_control":
        u = race_control_motion(scene)
        if u is not None:
            return u
    return start_of(scene).u


def fix_hertz(scene: Scene, system: DynamicSystem) -> None:
    """Puts the fitted Hertz factors in place of the exact ones; only without a cage."""
    bearing = system.bearing
    table = hertz_table(bearing.g, bearing.D, fitted_factors)
    system.bearing = bearing._replace(hertz=table)
    system.buffers.rest[0] = fitted_displacement(bearing.g, scene.operation.preload_N)
    system.buffers.balls.delta[:] = system.buffers.rest


def major_ratio(system: DynamicSystem, angle: np.ndarray) -> np.ndarray:
    """Fitted semi-major axes over exact ones (n, 2), at the same load."""
    g, D = system.bearing.g, system.bearing.D
    return np.array(
        [
            [
                fitted_factors(g, race, D[j], c)[1] / exact_factors(g, race, D[j], c)[1]
                for race, c in zip((-1.0, 1.0), np.cos(angle[j]), strict=True)
            ]
            for j in range(len(D))
        ]
    )
