"""Solves and times the points of a sweep of the study of accuracy on a scene."""

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from bearingwear.kernels import status as code
from bearingwear.kernels.equilibrium.kinematics import OUTER_CONTROL
from bearingwear.lives.groove_life import wear_over_gap
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene
from bearingwear.sides import values_of_bearing
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
    check_allowed,
    read_accuracy,
    reference_name,
    scene_settings,
    sweep_points,
)
from workflow.studies.accuracy.quantities import SWEEP
from workflow.studies.accuracy.scenes import (
    life_of_point,
    scene_on_rotor,
    scene_with_end,
    scene_with_growth,
)

FEWEST_BALLS = 3  # that hold the race in the middle without a radial load


def solved_sweep(plan: Path, scene: str, sweep: str) -> xr.Dataset:
    """Step: returns the solved and timed points of a sweep, or of a reference, on a scene.

    A solve is repeated as often as the plan states, or until the repeats have taken its `seconds`.

    plan: file of the plan, which names the scene and the sweep.

    Returns the variables of `SWEEP` over `point`.
    """
    accuracy = read_accuracy(plan)
    check_allowed(scene, accuracy["scenes"], f"{plan}: scenes")
    check_allowed(sweep, (*accuracy["references"], *accuracy["sweeps"]), f"{plan}: sweeps")
    file = plan.parent / "scenes" / f"{accuracy['scenes'][scene]['file']}.yaml"
    points = sweep_points(accuracy, sweep)
    values_at = partial(
        _values_at,
        file=file,
        settings=scene_settings(accuracy, scene),
        repeats=accuracy["repeats"],
        seconds=accuracy["seconds"],
    )
    # one after the other: points that share the cores would take longer
    answers = answers_at(values_at, points, workers=1, label=f"{scene}, {sweep}")
    # of a refused point, the only value is the status
    rows = [
        {"label": point.label, "value": point.value, "settings": point.text} | answer_values(answer)
        for point, answer in zip(points, answers, strict=True)
    ]
    sweep_plan = accuracy["sweeps"].get(sweep)
    return dataset_of_rows(
        SWEEP,
        {"point": len(rows)},
        rows,
        title=f"Accuracy against time: {scene}, {sweep}",
        scene_name=scene,
        sweep_name=sweep,
        sweep_title=sweep_plan["title"] if sweep_plan else sweep,
        sweep_kind=sweep_plan["kind"] if sweep_plan else "reference",
        against=reference_name(sweep_plan) if sweep_plan else sweep,
        comment="Wall times vary from run to run, so the file is not reproducible byte for byte.",
    )


def _values_at(
    point: SweepPoint, file: Path, settings: Mapping[str, str], repeats: int, seconds: float
) -> dict[str, float]:
    """Returns `point_values` of a point of a scene in a file.

    settings: changes of the scene at all points, as YAML texts by key.
    """
    scene = load_scene(file, point.overrides(settings))
    return point_values(scene, point, repeats, seconds)


def point_values(scene: Scene, point: SweepPoint, repeats: int, seconds: float) -> dict[str, float]:
    """Solves and times a point; returns its values by the names of `SWEEP`.

    Where it was not solved, they are the status alone. In a pair, they are those of the first
    bearing. A short solve before the timed ones compiles the kernels.

    repeats, seconds: as of `timed_solve`.
    """
    base_scene = scene_with_end(scene_with_growth(scene, point.warmth), point.end)
    scene = scene_on_rotor(base_scene, point.machine)
    run = runner(scene, point)
    # a quarter of a turn calls all kernels
    short_model = replace(scene.model, simulated_turns=0.25, evaluated_turns=None)
    runner(replace(scene, model=short_model), point)()
    values, wall, processor = timed_solve(run, repeats, seconds)
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
        bearing_values = values if scene.pair is None else values_of_bearing(values, 0)
        row["estimate_total_qv"] = float(bearing_values["qv_error_estimate"])
        row["estimate_residual_preload"] = float(bearing_values["residual_preload_error_estimate"])
        row["estimate_wear_rate"] = float(bearing_values["wear_rate_error_estimate"])
    new_scene = replace(base_scene, wear=replace(base_scene.wear, ball_diameter_loss_um=(0.0,)))
    return row | life_quantities(scene_on_rotor(new_scene, point.machine), point, repeats, seconds)


def life_quantities(
    new_scene: Scene, point: SweepPoint, repeats: int, seconds: float
) -> dict[str, float]:
    """Computes and times the life from new; returns its values by the names of `SWEEP`.

    Only the steady model computes a life here: the dict is empty for other points, for scenes that
    are not symmetric about the axis, and for those without an end of life. A life that was not
    solved has `wear_over_gap` alone. In a pair, `end_qv` is that of the first bearing.

    new_scene: scene without wear.
    point: setting of the sweep.
    repeats, seconds: as of `timed_solve`.
    """
    if point.fidelity != "steady" or asymmetries(new_scene) or not new_scene.wear.end_of_life:
        return {}
    row = {"wear_over_gap": wear_over_gap(new_scene)}
    life_values, wall, processor = timed_solve(
        lambda: life_of_point(new_scene, point), repeats, seconds
    )
    if life_values["status"] == code.OK:
        row["life"] = float(life_values["life"]) * HOURS_PER_SECOND
        if "life_error_estimate" in life_values:
            row["estimate_life"] = float(life_values["life_error_estimate"])
        if "history_total_qv" in life_values:
            bearing_values = (
                life_values if new_scene.pair is None else values_of_bearing(life_values, 0)
            )
            row["end_qv"] = float(bearing_values["history_total_qv"][-1])
        row["life_wall_time"] = statistics.median(wall)
        row["life_processor_time"] = statistics.median(processor)
    return row


class TimedSolve(NamedTuple):
    """Values of a solve, and wall and processor times of its repeats [s]."""

    values: dict
    wall: list[float]
    processor: list[float]


def timed_solve(run: Callable[[], dict], repeats: int, seconds: float) -> TimedSolve:
    """Runs a solve several times, at least once, and returns the last values and all times.

    run: solves, and returns the values by name.
    repeats: largest number of solves, 1 or more.
    seconds: wall time [s] of all solves after which no further one is started, above 0.
    """
    wall: list[float] = []
    processor: list[float] = []
    values: dict = {}
    while len(wall) < repeats and sum(wall) < seconds:
        wall_start = time.perf_counter()
        processor_start = time.process_time()
        values = run()
        processor.append(time.process_time() - processor_start)
        wall.append(time.perf_counter() - wall_start)
    return TimedSolve(values, wall, processor)


def quantities(scene: Scene, values: dict) -> dict[str, float]:
    """Returns `QUANTITIES` of a solve by name, in a pair those of the first bearing.

    values: of the solve.
    """
    if scene.pair is not None:
        values = values_of_bearing(values, 0)
    qv = values["qv"].mean(axis=0)  # (balls, races): inner, outer
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


# Solvers of a point


def runner(scene: Scene, point: SweepPoint) -> Callable[[], dict]:
    """Returns a function without arguments that solves a scene as a point states.

    That function returns the values of the solve by name. The steady model and three balls solve
    the scene under thrust alone.
    """
    fidelity = point.fidelity
    if fidelity == "race_control":
        return lambda: solve(scene, fidelity).values
    if fidelity == "steady":
        thrust = thrust_alone(scene)
        return lambda: solve(thrust, fidelity).values
    if fidelity == "three_balls":
        return lambda: three_balls(scene)
    dynamic_scene = scene.without_cage if fidelity == "no_cage" else scene
    if not (point.start or point.hertz):
        return lambda: solve(dynamic_scene, "dynamic").values
    start = point.start or "steady"
    return lambda: dynamic_values(dynamic_scene, start, fit=point.hertz == "fit")


def three_balls(scene: Scene) -> dict:
    """Returns values of the dynamic model with three balls under their share of the preload.

    Only thrust acts, and there is no cage. A single ball would push the race aside. Total QV,
    preload, and wear rates of races and of the loss are converted to those of the whole bearing;
    values over balls are of three balls. Where the status is not OK, nothing is converted.
    """
    share = FEWEST_BALLS / scene.bearing.ball_count
    full = thrust_alone(scene)
    three = replace(
        full,
        bearing=replace(full.bearing, ball_count=FEWEST_BALLS),
        operation=replace(full.operation, preload_N=share * full.operation.preload_N),
        cage=None,
    )
    values = dict(solve(three, "dynamic").values)
    if values["status"] == code.OK:
        for name in ("total_qv", "residual_preload", "race_wear_rate"):
            values[name] = values[name] / share
        # A ball wears as in the whole bearing; the grooves, the rest of the loss, by fewer balls.
        # of the diameter D [m]: twice the volume rate of the ball over its surface
        D = 1e-3 * three.bearing.ball_diameter_mm - values["ball_diameter_loss"]
        ball_rate = np.mean(2.0 * values["ball_wear_rate"] / (np.pi * D * D))
        groove_rate = values["ball_diameter_loss_rate"] - ball_rate
        values["ball_diameter_loss_rate"] = ball_rate + groove_rate / share
    return values


def dynamic_values(scene: Scene, start: str, fit: bool) -> dict:
    """Returns values of the dynamic model from a start, with exact or fitted Hertz factors.

    Where the status is not OK, it may be the only value. With the fit, the values of wear are those
    of its semi-major axes, and `semi_major_axis` itself remains the exact one.

    start: of `STARTS`.
    fit: whether the Hertz factors are those of Hamrock and Brewe's fit.
    """
    system = DynamicSystem.of(scene, first_motion(scene, start))
    if fit:
        use_fitted_hertz(scene, system)
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
    """Returns the motion w_x, w_y, w_z, Omega (4,) or (n, 4) [rad/s] from which balls start.

    start: of `STARTS`; the steady motion stands in for one by race control that does not exist.
    """
    if start == "kinematic":
        return ThrustProblem.of(scene).kinematic_start(OUTER_CONTROL)
    if start == "race_control":
        u = race_control_motion(scene)
        if u is not None:
            return u
    return start_of(scene).u


def use_fitted_hertz(scene: Scene, system: DynamicSystem) -> None:
    """Replaces the exact Hertz factors of a system by fitted ones, in place.

    The race starts from the axial displacement [m] at which the fit carries the preload. The system
    has no cage.
    """
    bearing = system.bearing
    table = hertz_table(bearing.g, bearing.D, fitted_factors)
    system.bearing = bearing._replace(hertz=table)
    system.buffers.rest[0] = fitted_displacement(bearing.g, scene.operation.preload_N)
    system.buffers.balls.delta[:] = system.buffers.rest


def major_ratio(system: DynamicSystem, angle: np.ndarray) -> np.ndarray:
    """Returns the ratios (n, 2) of fitted to exact semi-major axes at the same load.

    angle: contact angles (n, 2) [rad] of n balls at both races.
    """
    g = system.bearing.g
    ratios = np.empty(angle.shape)
    for j, D in enumerate(system.bearing.D):
        for k, race in enumerate((-1.0, 1.0)):  # inner, outer
            cosine = np.cos(angle[j, k])
            _, fitted_axis, *_ = fitted_factors(g, race, D, cosine)
            _, exact_axis, *_ = exact_factors(g, race, D, cosine)
            ratios[j, k] = fitted_axis / exact_axis
    return ratios
