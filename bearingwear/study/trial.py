"""Solves and times the points of one sweep of the trade study on one scene."""

import statistics
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.io.netcdf import common_attributes, dataset
from bearingwear.io.variables import HOUR
from bearingwear.kernels import status as code
from bearingwear.kernels.kinematics import OUTER_CONTROL
from bearingwear.model.coupled import solve_coupled
from bearingwear.model.dynamic import Motion, exact_factors, hertz_table
from bearingwear.model.fidelity import asymmetries
from bearingwear.model.fitted import fitted_displacement, fitted_factors
from bearingwear.model.interrupt import Interrupt
from bearingwear.model.life import life
from bearingwear.model.race_control import race_control_motion
from bearingwear.model.result import Result
from bearingwear.model.scene import COUNTS, Scene
from bearingwear.model.solve import solve
from bearingwear.model.steady import ThrustProblem
from bearingwear.model.transient import Run, start_of, thrust_alone, window_values
from bearingwear.model.values import wear_values
from bearingwear.study.sweeps import Point, TradePlan

FEWEST_BALLS = 3  # that hold the race in the middle without a radial load

QUANTITIES = {
    "total_qv": ("QV of the bearing", "W"),
    "qv_inner": ("QV of an inner contact, mean over the balls", "W"),
    "qv_outer": ("QV of an outer contact, mean over the balls", "W"),
    "residual_preload": ("residual preload", "N"),
    "wear_rate": ("rate of loss of ball diameter, counted as the scene says", "m s-1"),
    "cage_wear_rate": ("wear rate of the cage, pockets and land", "m3 s-1"),
    "life": ("wear life from new, counted as the scene says", "h"),
}
"""What the errors are of."""

EXTRA = {
    "wall_time": ("duration of the solve, warm, median of the repeats", "s"),
    "wall_time_least": ("duration of the fastest repeat", "s"),
    "repeats": ("times that the solve was timed", "1"),
    "life_wall_time": ("duration of finding the life, warm, median of the repeats", "s"),
    "simulated_turns": ("shaft turns simulated until settled or used up", "1"),
    "steps": ("steps taken and repeated", "1"),
    "estimate_total_qv": ("estimated error of QV of the bearing, as the case has it", "1"),
    "estimate_residual_preload": ("estimated error of the residual preload", "1"),
    "estimate_wear_rate": ("estimated error of the rate of loss of ball diameter", "1"),
    "estimate_life": ("estimated error of the wear life", "1"),
    "coriolis_energy_share": ("work of the Coriolis force left out, of the heat", "1"),
    "azimuth_energy_share": ("work of the circumferential force left out, of the heat", "1"),
}
"""What else is kept of a point."""


def sweep(plan: TradePlan, scene_name: str, name: str) -> xr.Dataset:
    """All points of a sweep, or of a reference, on one scene."""
    points = plan.points(name)
    rows = [measured(plan, plan.scene(scene_name, point), point) for point in points]
    variables: dict[str, Any] = {
        "label": (
            "point",
            np.array([p.label for p in points], dtype=object),
            {"long_name": "setting of the point"},
        ),
        "value": (
            "point",
            np.array([p.value for p in points]),
            {"long_name": "setting as a number"},
        ),
        "settings": (
            "point",
            np.array([_setting_text(p) for p in points], dtype=object),
            {"long_name": "all settings of the point"},
        ),
        "status": (
            "point",
            np.array([row["status"] for row in rows], dtype=np.int8),
            dataset(Result({"status": code.OK}))["status"].attrs,  # the flags of a case file
        ),
    }
    for key, (long_name, units) in {**QUANTITIES, **EXTRA}.items():
        column = np.array([row.get(key, np.nan) for row in rows])
        variables[key] = ("point", column, {"long_name": long_name, "units": units})
    of = plan.sweeps.get(name)
    return xr.Dataset(variables).assign_attrs(
        common_attributes()
        | {
            "title": f"Accuracy against time: {scene_name}, {name}",
            "trade_scene": scene_name,
            "trade_sweep": name,
            "sweep_title": of.title if of else name,
            "kind": of.kind if of else "reference",
            "against": of.against if of else name,
            "comment": "Wall times differ from run to run, and with them the bytes of this file.",
        }
    )


def _setting_text(point: Point) -> str:
    special = [f"{key}={value}" for key, value in point.special.items()]
    return " ".join([*point.settings, *special])


def measured(plan: TradePlan, scene: Scene, point: Point) -> dict[str, float]:
    """What a point gives and what it takes."""
    run = runner(scene, point)
    short = replace(scene, model=replace(scene.model, simulated_turns=0.25, evaluated_turns=None))
    runner(short, point)()  # compiles
    values, wall, repeats = timed(run, plan)
    row = {"status": float(values["status"])}
    if values["status"] != code.OK:
        return row
    row |= quantities(scene, values) | {
        "wall_time": statistics.median(wall),
        "wall_time_least": min(wall),
        "repeats": float(repeats),
        "steps": float(values.get("steps_accepted", np.nan) + values.get("steps_rejected", np.nan)),
    }
    for name in ("simulated_turns", "coriolis_energy_share", "azimuth_energy_share"):
        row[name] = float(values.get(name, np.nan))
    counted = COUNTS.index(scene.wear.counts)
    if "qv_error_estimate" in values:
        row["estimate_total_qv"] = float(values["qv_error_estimate"])
        row["estimate_residual_preload"] = float(values["residual_preload_error_estimate"])
        row["estimate_wear_rate"] = float(values["wear_rate_error_estimate"][counted])
    tier = point.special.get("tier", point.fidelity)
    symmetric = not asymmetries(scene) or tier == "race_control"
    if tier in ("steady", "race_control") and symmetric and scene.wear.end_of_life:
        fresh = replace(scene, wear=replace(scene.wear, ball_diameter_loss_um=(0.0,)))
        lived, wall, _ = timed(lambda: life(fresh, tier).values, plan)
        if lived["status"] == code.OK:
            row["life"] = float(lived["life"][counted]) * HOUR
            if "life_error_estimate" in lived:
                row["estimate_life"] = float(lived["life_error_estimate"][counted])
            row["life_wall_time"] = statistics.median(wall)
    return row


def timed(run: Callable[[], dict], plan: TradePlan) -> tuple[dict, list[float], int]:
    """Answer of a solve, the durations of its repeats [s] and their number."""
    wall: list[float] = []
    values: dict = {}
    while len(wall) < plan.repeats and sum(wall) < plan.seconds:
        started = time.perf_counter()
        values = run()
        wall.append(time.perf_counter() - started)
    return values, wall, len(wall)


def quantities(scene: Scene, values: dict) -> dict[str, float]:
    """The numbers that errors are asked of."""
    qv = values["qv"].mean(axis=0)
    row = {
        "total_qv": float(values["total_qv"]),
        "qv_inner": float(qv[0]),
        "qv_outer": float(qv[1]),
        "residual_preload": float(values["residual_preload"]),
        "wear_rate": float(values["ball_diameter_loss_rate"][COUNTS.index(scene.wear.counts)]),
    }
    if "cage_wear_rate" in values:
        row["cage_wear_rate"] = float(values["cage_wear_rate"] + values["cage_land_wear_rate"])
    return row


# The ways of solving a point


def runner(scene: Scene, point: Point) -> Callable[[], dict]:
    """The solve of a point as something to call."""
    tier = point.special.get("tier", point.fidelity)
    if tier == "race_control":
        return lambda: solve(scene, tier).values
    if tier == "traction":
        return lambda: solve_coupled(scene)
    if tier == "steady":
        thrust = thrust_alone(scene)
        return lambda: solve(thrust, tier).values
    if tier == "three_balls":
        return lambda: three_balls(scene)
    trial = scene.without_cage if tier == "no_cage" else scene
    start, hertz = point.special.get("start"), point.special.get("hertz")
    if start is None and hertz is None:
        return lambda: solve(trial, "dynamic").values
    return lambda: in_time(trial, start or "steady", hertz == "fit")


def three_balls(scene: Scene) -> dict:
    """Solved in time with three balls under their share of the preload, thrust alone, no cage.

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
        balls, both = values["ball_diameter_loss_rate"]
        values["ball_diameter_loss_rate"] = np.array([balls, balls + (both - balls) / share])
    return values


def in_time(scene: Scene, start: str, fit: bool) -> dict:
    """Solved in time from a stated start, with exact or fitted Hertz factors."""
    motion = Motion.of(scene, first_motion(scene, start))
    if fit:
        fix_hertz(scene, motion)
    values: dict = {"status": motion.settle()}
    if values["status"] != code.OK:
        return values
    with Interrupt() as interrupt:
        run = Run(scene, motion, None)
        for length in run.grid.windows:
            values["status"] = run.window(length, interrupt)
            if values["status"] != code.OK:
                return values
    values |= window_values(scene, run) | run.counts(run.grid.window / run.grid.points)
    if fit:
        D = motion.run.D
        axes = values["semi_major_axis"] * major_ratio(motion, values["contact_angle"])
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


def fix_hertz(scene: Scene, motion: Motion) -> None:
    """Put the fitted Hertz factors in place of the exact ones; only without a cage."""
    g = motion.run.g
    motion.run = motion.run._replace(hertz=hertz_table(g, motion.run.D, fitted_factors))
    motion.buffers.rest[0] = fitted_displacement(g, scene.operation.preload_N)
    motion.buffers.s.delta[:] = motion.buffers.rest


def major_ratio(motion: Motion, angle: np.ndarray) -> np.ndarray:
    """Fitted semi-major axes over exact ones (n, 2), at the same load."""
    g, D = motion.run.g, motion.run.D
    return np.array(
        [
            [
                fitted_factors(g, race, D[j], c)[1] / exact_factors(g, race, D[j], c)[1]
                for race, c in zip((-1.0, 1.0), np.cos(angle[j]), strict=True)
            ]
            for j in range(len(D))
        ]
    )
