"""Variables of a dynamic life: length, errors, histories, and the steady life beside it."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.ends import Criteria, with_end
from bearingwear.lives.errors import integration_error
from bearingwear.lives.follow import Life, follow
from bearingwear.lives.history import film_values
from bearingwear.lives.methods import Trapezoid
from bearingwear.lives.motion import Motion, run_at
from bearingwear.lives.surfaces import surface_life
from bearingwear.scene.scene import EndOfLife, Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.dynamic.stability import GROWTHS
from bearingwear.solvers.effects.choice import asymmetries
from bearingwear.solvers.estimates import ROUNDING
from bearingwear.solvers.start import thrust_alone
from bearingwear.solvers.state import history_values

_MOST_STEPS = 20  # times the steps asked for, because rates may fall on the way


def motion_life(scene: Scene, progress: Callable[[str], None] | None = None) -> tuple[dict, dict]:
    """Returns values and attributes of a life with a dynamic run at every step.

    Values have the names of result variables; `status` and `end_criterion` are always there. A life
    whose first run fails has only these and the life by the steady model, which is there for
    comparison.

    progress: receives a line of text at each step.
    """
    values = steady_life_values(scene)
    wearing = Motion(scene, float(values.get("steady_life", math.nan)), progress)
    method = Trapezoid(_MOST_STEPS * wearing.steps)
    life = follow(wearing, Criteria(scene), method)
    values |= {"status": life.status, "end_criterion": life.criterion}
    left_out = asymmetries(scene) + ([] if scene.cage is None else ["cage"])
    attrs = {
        "solves": len(life.tried_nodes),
        "steady_life_of": f"the scene without {', '.join(left_out)}" if left_out else "the scene",
        "residual": f"last run: {run_at(life.tried_nodes[-1]).residual}",
    }
    if life.nodes[0].status == code.OK:
        values |= length_and_errors(life) | life_histories(life)
        values |= steady_time_to_loss(scene, values["loss_at_end"])
    return values, attrs


def length_and_errors(life: Life) -> dict:
    """Returns result variables of the length of a life [s], its errors and its last loss [m].

    The length is a lower bound where no criterion was met. The error bound [s] is NaN then, and the
    estimate [1] is left out; it is left out also where it is not finite or the cage ends the life.
    """
    wearing, last = life.wearing, life.last
    error = estimate = math.nan
    if life.status == code.OK and last.x > 0.0:
        error = _error_bound(life)
        # No run estimates the error of a clearance's growth.
        if not wearing.is_of_cage(life.criterion):
            run_errors = [
                run_at(node).values.get("wear_rate_error_estimate", math.nan) for node in life.nodes
            ]
            time = np.array([node.x for node in life.nodes])
            mean_run_error = float(np.trapezoid(run_errors, time)) / last.x
            estimate = ROUNDING + error / last.x + mean_run_error
    factor, _ = parameters.wear_factors(wearing.scene)
    values: dict[str, Any] = {
        "loss_at_end": float(wearing.parts.loss(last.worn).mean()),
        "life": last.time,
        "normalised_life": last.time * factor,
        "life_error_bound": error,
    }
    if math.isfinite(estimate):
        values["life_error_estimate"] = estimate
    return values


def _error_bound(life: Life) -> float:
    """Returns a bound on the error of a life [s]; NaN where a part of it has only two nodes.

    It is the error of the root search plus the integration errors of the parts. A part ends where a
    film is gone or the life ends. Its error is that of the depth or measure that ends it, over the
    rate at that time.
    """
    wearing: Motion = life.wearing
    time = np.array([node.x for node in life.nodes])
    # two nodes have the same time where a film is gone: rates have a jump there
    starts = [0, *(np.flatnonzero(np.diff(time) == 0.0) + 1).tolist()]
    ends = [*starts[1:], time.size]
    error = life.error
    for start, end, film in zip(starts, ends, [*wearing.films_gone, None], strict=True):
        if end - start > 1:
            nodes = life.nodes[start:end]
            rate = np.array([wearing.end_rate(node, life.criterion, film) for node in nodes])
            rate_at_end = 0.5 * (rate[-2] + rate[-1])
            error += integration_error(time[start:end], rate) / rate_at_end
    return error


def life_histories(life: Life) -> dict:
    """Returns the result variables along a life, with one entry for each node that was tried.

    A node that was not solved is the last one. Its rates and the values of its run are NaN.
    """
    wearing: Motion = life.wearing
    layout = wearing.parts.layout
    nodes = life.tried_nodes
    runs = [run_at(node) for node in nodes]
    worn = np.array([node.worn for node in nodes])
    missing = np.full(layout.size, math.nan)
    rates = np.array([run.rates if run.status == code.OK else missing for run in runs])
    states = [node.states[0] for node in nodes]
    times = np.array([node.time for node in nodes])
    values = history_values(states) | {
        "history_time": times,
        "history_status": [run.status for run in runs],
        "history_start": [int(run.carried_on) for run in runs],
        "history_simulated_turns": [run.values.get("simulated_turns", math.nan) for run in runs],
        "history_worn_diameter": worn[:, layout.diameter],
        "history_groove_depth": worn[:, layout.groove].sum(axis=1),
        "history_ball_worn_volume": worn[:, layout.ball],
        "history_race_worn_volume": worn[:, layout.race],
        "history_each_ball_wear_rate": rates[:, layout.ball],
    }
    values |= film_values(wearing.scene, states, times)
    if any(GROWTHS[0] in run.values for run in runs):
        for name in GROWTHS:
            values[f"history_{name}"] = [run.values.get(name, math.nan) for run in runs]
    if wearing.scene.cage is None:
        return values
    return values | {
        "history_pocket_worn_volume": worn[:, layout.pocket],
        "history_land_worn_volume": worn[:, layout.land],
        "history_pocket_wear_rate": rates[:, layout.pocket],
        "history_land_wear_rate": rates[:, layout.land],
        **history_values(states, wearing.parts.cage_values(nodes[0].worn)),
    }


def steady_life(scene: Scene) -> Life:
    """Returns the life by the steady model of a scene reduced to what that model can solve.

    The reduced scene has thrust alone, no cage, and the mean loss on all balls. Its contacts stay
    Hertzian.
    """
    mean = float(np.mean(scene.wear.ball_diameter_loss_um))
    reduced = thrust_alone(scene).without_cage
    reduced = replace(reduced, wear=replace(reduced.wear, ball_diameter_loss_um=(mean,)))
    return surface_life(reduced, solver_of(reduced))


def steady_life_values(scene: Scene) -> dict:
    """Returns result variables of the life by the steady model.

    They are its status and criterion, and if it ends by that criterion its length [s] and its loss
    at the end [m].
    """
    life = steady_life(scene)
    values: dict = {"steady_status": life.status, "steady_end_criterion": life.criterion}
    if life.status == code.OK:
        values |= {
            "steady_life": life.last.time,
            "steady_loss_at_end": life.last.states[0].loss,
        }
    return values


def steady_time_to_loss(scene: Scene, loss: float) -> dict:
    """Returns the result variable of the time in which the steady model reaches a loss [s].

    The dictionary is empty where the model does not reach it, or where it is not above the present
    mean loss.

    loss: mean loss of ball diameter [m].
    """
    end = EndOfLife(ball_diameter_loss_um=loss / parameters.UM)
    if not loss > float(np.mean(scene.wear.ball_diameter_loss_um)) * parameters.UM:
        return {}
    life = steady_life(with_end(scene, end))
    if life.status != code.OK:
        return {}
    return {"steady_time_to_loss": life.last.time}
