"""Solves random scenes and reports their outcomes."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels import status as code
from bearingwear.kernels.status import STATUS_NAMES
from bearingwear.lives.life import life
from bearingwear.results.variable import Variable, table
from bearingwear.scene.read import load_scene
from bearingwear.scene.scene import Scene, SceneError
from bearingwear.sides import values_of_bearing
from bearingwear.solvers.result import MAY_BE_INFINITE
from bearingwear.solvers.solve import case_values
from bearingwear.studies.answers import REFUSED, answers_at
from bearingwear.studies.dataset import dataset_of_rows
from workflow.studies.robustness.draw import drawn_scene
from workflow.studies.robustness.lives import WORN_LIFE, life_violations
from workflow.studies.robustness.plan import (
    WITHOUT_REASON,
    base_scene,
    draw_blocks,
    drawn_values,
    draws,
    plan_entry,
    read_robustness,
)

TRIALS = table(
    Variable("status", (), "", "outcome (-1: not a valid bearing)", "i1"),
    Variable("violations", (), "", "description of the error; empty if there is none", "O"),
    Variable("states", (), "1", "number of steady states found; 0 if none or not requested", "i1"),
    Variable("largest_qv_ratio", (), "1", "maximum relative difference in QV between these states"),
)

_ESTIMATES = ("_error_estimate", "torque_lost_to_regularisation")
"""Ends of the names of estimates, which a solve may lack."""

LEAST_TOLERANCE, LARGEST_TOLERANCE = 1e-9, 1e-5
"""Limits of the tolerances that depend on rounding."""


def random_scenes(plan: Path, name: str, count: int | None = None, seed: int = 1) -> xr.Dataset:
    """Step: returns the outcomes of random scenes of a class, and their drawn values.

    plan: file of the plan.
    name: of the class in the plan.
    count: number of scenes, by default that of the plan.

    Returns the variables of `TRIALS`, and one for each drawn key, over `trial`.
    """
    robustness = read_robustness(plan)
    scene_class = plan_entry(robustness, plan, "scene_classes", name)
    count = count or scene_class["scenes"]
    base = load_scene(base_scene(robustness, plan)).to_dict()
    fidelity = scene_class["fidelity"]
    distributions = draws(draw_blocks(robustness, name))
    trials = list(drawn_values(distributions, seed, count))
    dtypes = {key: "O" if isinstance(trials[0][key], str) else "f8" for key in distributions}
    keys = table(*(Variable(key, (), "", "value drawn", dtype) for key, dtype in dtypes.items()))
    outcome = partial(outcome_of, base, fidelity=fidelity)
    outcomes = answers_at(outcome, trials, workers=1, label=name)
    rows = [{**outcome, **values} for outcome, values in zip(outcomes, trials, strict=True)]
    attributes = study_attributes("scene_classes", name) | {"fidelity": fidelity, "seed": seed}
    return dataset_of_rows(TRIALS | keys, {"trial": count}, rows, **attributes)


def outcome_of(base: Mapping[str, Any], values: Mapping[str, Any], fidelity: str) -> dict[str, Any]:
    """Solves a scene with drawn values; returns the values of `TRIALS`.

    Values that make no valid bearing have the status `REFUSED`. So has a scene whose solve raises
    an error, which is its violation ("crashed: ...").

    base: plain data of the scene that the draw changes.
    fidelity: model to solve, or `WORN_LIFE`.
    """
    outcome: dict[str, Any] = {
        "status": REFUSED,
        "violations": "",
        "states": 0,
        "largest_qv_ratio": 0.0,
    }
    try:
        scene = drawn_scene(base, values)
    except SceneError:
        return outcome
    try:
        solution = life(scene).values if fidelity == WORN_LIFE else solved_values(scene, fidelity)
    except Exception as error:  # noqa: BLE001 - a crash is an outcome, the other scenes go on
        return outcome | {"violations": f"crashed: {type(error).__name__}: {error}"}
    outcome["status"] = solution["status"]
    if fidelity == WORN_LIFE:
        return outcome | {"violations": "; ".join(life_violations(scene, solution))}
    outcome["violations"] = "; ".join(violations(scene, fidelity, solution))
    if solution["status"] == code.OK and fidelity == "steady":
        qv = np.atleast_2d(solution["steady_state_total_qv"])  # (bearings, states)
        outcome["states"] = qv.shape[1]
        outcome["largest_qv_ratio"] = np.nanmax(np.abs(qv / qv[:, :1] - 1.0))
    return outcome


def solved_values(scene: Scene, fidelity: str) -> dict[str, Any]:
    """Returns the values of a solved case by name, those of `bearingwear.solve`."""
    values, *_ = case_values(scene, fidelity, None, None)
    return values


def violations(scene: Scene, fidelity: str, values: Mapping[str, Any]) -> list[str]:
    """Returns lines on what is wrong with a solved case; the list is empty for a valid one.

    A case that was not solved is valid if its status gives a physical reason. One without a reason
    gives a line with the status.

    fidelity: model with which it was solved.
    values: of the solved case, by name.
    """
    status = int(values["status"])
    if status in WITHOUT_REASON:
        return [STATUS_NAMES[status]]
    if status != code.OK:
        return []
    if scene.pair is not None:
        return _pair_violations(scene, fidelity, values)
    problems = _bearing_violations(scene, fidelity, values)
    if scene.operation.preload_method == "constant_force":
        preload = scene.operation.preload_N
        if not abs(values["residual_preload"] / preload - 1.0) <= 1e-6:
            problems.append(
                f"residual preload {values['residual_preload']:g} N, spring force {preload:g} N"
            )
    return problems


def _pair_violations(scene: Scene, fidelity: str, values: Mapping[str, Any]) -> list[str]:
    """Returns a line for each violation in either bearing, or in the balance of the rotor.

    The list is empty for a valid pair.

    values: of the solved case, by name.
    """
    problems = []
    for k, side in enumerate(scene.sides):
        pair_values = {name: value for name, value in values.items() if name != "status"}
        # NaN pads what only one bearing has: further steady states, error estimates
        bearing_values = {
            name: value
            for name, value in values_of_bearing(pair_values, k).items()
            if not (name.startswith("steady_state_") or name.endswith(_ESTIMATES))
        }
        problems += [
            f"bearing {k + 1}: {text}"
            for text in _bearing_violations(side, fidelity, bearing_values)
        ]
    residual = values["rotor_balance_residual"]
    if not residual <= _tolerance(np.max(values["equilibrium_rounding"])):
        problems.append(f"rotor_balance_residual {residual:.1e}")
    return problems


def _bearing_violations(scene: Scene, fidelity: str, values: Mapping[str, Any]) -> list[str]:
    """Returns a line for each number of a bearing that is missing or beyond its tolerance.

    Except with the dynamic model, the friction heat of a contact must not exceed mu QV, either.

    values: of the solved case, by name.
    """
    problems = [
        f"{name} is not finite"
        for name, value in values.items()
        if not np.all(np.isfinite(finite_numbers(name, value)))
    ]
    problems += [
        f"{name} {values[name]:.1e}"
        for name, tolerance in tolerances(fidelity, values).items()
        if not abs(values[name]) <= tolerance
    ]
    heat, qv = values["friction_heat"], values["qv"]
    if fidelity != "dynamic" and not np.all(heat <= scene.friction.ball_race * qv * (1.0 + 1e-9)):
        problems.append("friction heat exceeds mu QV")
    return problems


def finite_numbers(name: str, value: Any) -> np.ndarray:
    """Returns values as an array of numbers, with 0 for positive infinity where that is allowed.

    name: of the variable; those of `MAY_BE_INFINITE` may have it.
    """
    numbers = np.asarray(value, dtype=float)
    return np.where(np.isposinf(numbers), 0.0, numbers) if name in MAY_BE_INFINITE else numbers


def tolerances(fidelity: str, values: Mapping[str, Any]) -> dict[str, float]:
    """Returns the largest magnitudes of the residuals of a correct answer, by their names.

    Those of the race control and the steady model depend on estimates of the rounding errors.

    values: of the solved case, by name.
    """
    heat_flow = {"heat_flow_residual": 1e-5} if "heat_flow_residual" in values else {}
    if fidelity == "dynamic":
        return heat_flow | {"equilibrium_residual": 1e-6, "energy_account_error": 1e-3}
    rounding_names = {"equilibrium_residual": "equilibrium_rounding"}
    if fidelity == "steady":
        rounding_names |= {
            "friction_residual": "friction_rounding",
            "power_balance_error": "power_rounding",
        }
    return heat_flow | {
        name: _tolerance(values[rounding]) for name, rounding in rounding_names.items()
    }


def _tolerance(rounding: float) -> float:
    """Returns the largest residual of a correct answer: its estimated rounding error.

    It is limited to the range from `LEAST_TOLERANCE` to `LARGEST_TOLERANCE`.
    """
    return max(LEAST_TOLERANCE, min(LARGEST_TOLERANCE, rounding))


def study_attributes(kind: str, name: str) -> dict[str, str]:
    """Returns the attributes of a file of the study: title, kind and name."""
    return {"title": f"Robustness: {kind}, {name}", "kind": kind, "name": name}
