"""Variables of a dynamic life: length, errors, histories, and the steady life beside it."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.model import parameters
from bearingwear.model.dynamic_wear import DynamicCourse, DynamicWear
from bearingwear.model.estimate import ROUNDING
from bearingwear.model.fidelity import asymmetries
from bearingwear.model.life import life_history
from bearingwear.model.life_integrator import LifeHistory
from bearingwear.model.stability import GROWTHS
from bearingwear.model.start import thrust_alone
from bearingwear.model.state import history_values
from bearingwear.model.states_at_loss import steady_states
from bearingwear.scene.blocks import CRITERIA, OF_CAGE
from bearingwear.scene.scene import COUNTS, EndOfLife, Scene

SCATTER = 2.0  # standard errors


def integration_error(time: np.ndarray, rate: np.ndarray) -> float:
    """Bound on the error of a trapezoidal integral by steps and by scatter of the runs.

    A third of the change by steps twice as long, plus twice the standard error of the sum. The
    latter comes from the scatter of the nodes about parabolas through their neighbours.
    """
    last = len(time) - 1
    if last < 2:
        return math.nan
    kept = np.r_[0:last:2, last] if last % 2 == 0 else np.r_[0 : last - 2 : 2, last]
    coarse = np.trapezoid(rate[kept], time[kept])
    steps = abs(float(np.trapezoid(rate, time) - coarse)) / 3.0
    left = []
    for k in range(last - 2):
        t = (time[k : k + 4] - time[k]) / (time[k + 3] - time[k])
        apart = t[:, None] - t + np.eye(4)
        weights = 1.0 / apart.prod(axis=1)  # blind to parabolas
        left.append(weights @ rate[k : k + 4] / np.linalg.norm(weights))
    h = np.diff(time)
    shares = 0.5 * (np.append(h, 0.0) + np.append(0.0, h))
    deviation = math.sqrt(np.mean(np.square(left))) if left else 0.0
    return steps + SCATTER * deviation * float(np.linalg.norm(shares))


def solve_dynamic_life(
    scene: Scene, progress: Callable[[str], None] | None = None
) -> tuple[dict, dict]:
    """Wear life of a scene with a dynamic run at every step, and the steady life beside it.

    Parameters
    ----------
    scene : Scene
        With `wear.end_of_life`, and with its cage where that is to be solved.
    progress : callable, optional
        Given one line of text at each step.

    Returns
    -------
    values, attrs : dict
        Of a life file. Only one way of counting wear is followed, that of `wear.counts`, since it
        decides which wear the runs see; what belongs to the other is NaN.
    """
    integrator = DynamicWear(scene, progress)
    values = steady_life(scene)
    course = integrator.march(float(values.get("steady_life", math.nan)))
    values |= {"status": course.status, "end_criterion": course.criterion}
    attrs = {
        "solves": len(course.nodes),
        "steady_life_of": steady_told(scene),
        "residual": f"of the last run: {course.nodes[-1].residual}",
    }
    if course.solved:
        values |= ends(integrator, course) | life_histories(integrator, course)
        values |= steady_time_to_loss(scene, values["loss_at_end"])
    return values, attrs


def ends(integrator: DynamicWear, course: DynamicCourse) -> dict:
    """Life and its errors; the life is a lower bound where no criterion was met."""
    solved = course.solved
    last = solved[-1]
    life, error, estimate = (np.full(2, math.nan) for _ in range(3))
    count = integrator.parts.count
    life[count] = last.time
    values: dict[str, Any] = {"loss_at_end": float(integrator.parts.loss(last.worn).mean())}
    if course.status == code.OK and last.time > 0.0:
        time = np.array([node.time for node in solved])
        rate = np.array([integrator.end_rate(node, course.criterion) for node in solved])
        at_end = 0.5 * (rate[-2] + rate[-1])
        error[count] = integration_error(time, rate) / at_end + course.unsure
        by_runs = [
            node.values.get("wear_rate_error_estimate", [math.nan] * 2)[count] for node in solved
        ]
        # No run estimates the error of a clearance's growth.
        if CRITERIA[course.criterion] not in OF_CAGE:
            mean = np.trapezoid(by_runs, time) / last.time
            estimate[count] = ROUNDING + error[count] / last.time + mean
    factor, _ = parameters.wear_factors(integrator.scene)
    values |= {"life": life, "normalised_life": life * factor, "life_error_bound": error}
    return values | ({"life_error_estimate": estimate} if np.isfinite(estimate).any() else {})


def life_histories(integrator: DynamicWear, course: DynamicCourse) -> dict:
    """Wear and results at each node; NaN where a node was not solved."""
    p, nodes = integrator.parts.layout, course.nodes
    worn = np.array([node.worn for node in nodes])
    missing = np.full(p.size, math.nan)
    rates = np.array([node.rates if node.status == code.OK else missing for node in nodes])
    time = np.full((len(nodes), 2), math.nan)
    time[:, integrator.parts.count] = [node.time for node in nodes]
    values = history_values([integrator.state(node) for node in nodes]) | {
        "history_time": time,
        "history_status": [node.status for node in nodes],
        "history_start": [int(node.carried_on) for node in nodes],
        "history_simulated_turns": [node.values.get("simulated_turns", math.nan) for node in nodes],
        "history_worn_diameter": worn[:, p.diameter],
        "history_groove_depth": worn[:, p.groove],
        "history_ball_worn_volume": worn[:, p.ball],
        "history_race_worn_volume": worn[:, p.race],
        "history_each_ball_wear_rate": rates[:, p.ball],
    }
    if any(GROWTHS[0] in node.values for node in nodes):
        for name in GROWTHS:
            values[f"history_{name}"] = [node.values.get(name, math.nan) for node in nodes]
    if integrator.scene.cage is None:
        return values
    pocket, guide = np.array([integrator.parts.clearances(row) for row in worn]).T
    return values | {
        "history_pocket_worn_volume": worn[:, p.pocket],
        "history_land_worn_volume": worn[:, p.land],
        "history_pocket_wear_rate": rates[:, p.pocket],
        "history_land_wear_rate": rates[:, p.land],
        "history_pocket_clearance": pocket,
        "history_guide_clearance": guide,
    }


def steady_scene(scene: Scene) -> Scene:
    """The scene reduced to one with a steady life: thrust alone, no cage, the mean loss on every
    ball."""
    mean = float(np.mean(scene.wear.ball_diameter_loss_um))
    reduced = thrust_alone(scene).without_cage
    return replace(reduced, wear=replace(reduced.wear, ball_diameter_loss_um=(mean,)))


def steady_told(scene: Scene) -> str:
    """Sentence on what the steady life leaves out of a scene."""
    left = asymmetries(scene) + ([] if scene.cage is None else ["cage"])
    return f"the scene without {', '.join(left)}" if left else "the scene"


def steady_course(scene: Scene) -> LifeHistory:
    """Steady life of the reduced scene, without its own error estimate."""
    reduced = steady_scene(scene)
    return life_history(reduced, steady_states(reduced))


def steady_life(scene: Scene) -> dict:
    """Life, end and loss at the end by the steady model, counted as the scene does."""
    course = steady_course(scene)
    values: dict = {"steady_status": course.status, "steady_end_criterion": course.criterion}
    if course.status == code.OK:
        count = COUNTS.index(scene.wear.counts)
        values |= {
            "steady_life": float(course.times[-1][count]),
            "steady_loss_at_end": course.states[-1].loss,
        }
    return values


def steady_time_to_loss(scene: Scene, loss: float) -> dict:
    """Time that the steady model takes to lose what the dynamic life lost in all."""
    end = EndOfLife(ball_diameter_loss_um=loss / parameters.UM)
    if not loss > float(np.mean(scene.wear.ball_diameter_loss_um)) * parameters.UM:
        return {}
    course = steady_course(replace(scene, wear=replace(scene.wear, end_of_life=end)))
    if course.status != code.OK:
        return {}
    return {"steady_time_to_loss": float(course.times[-1][COUNTS.index(scene.wear.counts)])}
