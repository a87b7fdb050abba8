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
    entry,
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
    """Solves random scenes of a class of a plan; returns `TRIALS` and the drawn keys over `trial`.

    count: number of scenes, by default that of the plan.
    """
    robustness = read_robustness(plan)
    scene_class = entry(robustness, plan, "scene_classes", name)
    count = count or scene_class["scenes"]
    base = load_scene(base_scene(robustness, plan)).to_dict()
    fidelity, draw = scene_class["fidelity"], draw_blocks(robustness, name)
    trials = list(drawn_values(draws(draw), seed, count))
    kinds = {key: "O" if isinstance(trials[0][key], str) else "f8" for key in draw}
    keys = table(*(Variable(key, (), "", "value drawn", kind) for key, kind in kinds.items()))
    ends = answers_at(partial(outcome_of, base, fidelity=fidelity), trials, workers=1, label=name)
    rows = [{**end, **values} for end, values in zip(ends, trials, strict=True)]
    attributes = study_attributes("scene_classes", name) | {"fidelity": fidelity, "seed": seed}
    return dataset_of_rows(TRIALS | keys, {"trial": count}, rows, **attributes)


def outcome_of(base: Mapping[str, Any], values: Mapping[str, Any], fidelity: str) -> dict[str, Any]:
    """Solves a random scene; returns a value for each variable over `trial`."""
    end: dict[str, Any] = {
        "status": REFUSED,
        "violations": "",
        "states": 0,
        "largest_qv_ratio": 0.0,
    }
    try:
        scene = drawn_scene(base, values)
    except SceneError:
        return end
    try:
        solution = life(scene).values if fidelity == WORN_LIFE else solved_values(scene, fidelity)
    except Exception as error:  # noqa: BLE001 - a crash is a finding, the others go on
        return end | {"violations": f"crashed: {type(error).__name__}: {error}"}
    end["status"] = solution["status"]
    if fidelity == WORN_LIFE:
        return end | {"violations": "; ".join(life_violations(scene, solution))}
    end["violations"] = "; ".join(violations(scene, fidelity, solution))
    if solution["status"] == code.OK and fidelity == "steady":
        # along the states found, of a pair those of both bearings
        qv = np.atleast_2d(solution["steady_state_total_qv"])
        end["states"] = qv.shape[1]
        end["largest_qv_ratio"] = np.nanmax(np.abs(qv / qv[:, :1] - 1.0))
    return end


def solved_values(scene: Scene, fidelity: str) -> dict[str, Any]:
    """Returns values of a solve, as `bearingwear.solve` finds them."""
    return case_values(scene, fidelity, None, None)[0]


def violations(scene: Scene, fidelity: str, values: Mapping[str, Any]) -> list[str]:
    """Returns what is wrong with a solve; the list is empty for a valid one."""
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
    """
    problems = []
    for k, side in enumerate(scene.sides):
        by_bearing = {name: value for name, value in values.items() if name != "status"}
        bearing_values = values_of_bearing(by_bearing, k)
        # NaN pads what only one bearing has: further steady states, error estimates
        finite_values = {
            name: value
            for name, value in bearing_values.items()
            if not (name.startswith("steady_state_") or name.endswith(_ESTIMATES))
        }
        problems += [
            f"bearing {k + 1}: {text}"
            for text in _bearing_violations(side, fidelity, finite_values)
        ]
    residual = values["rotor_balance_residual"]
    if not residual <= _tolerance(np.max(values["equilibrium_rounding"])):
        problems.append(f"rotor_balance_residual {residual:.1e}")
    return problems


def _bearing_violations(scene: Scene, fidelity: str, values: Mapping[str, Any]) -> list[str]:
    """Returns a line for each number of a bearing that is missing or beyond its tolerance."""
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
    """Returns values as numbers, with 0 for an infinite value where that is allowed."""
    numbers = np.asarray(value, dtype=float)
    return np.where(np.isposinf(numbers), 0.0, numbers) if name in MAY_BE_INFINITE else numbers


def tolerances(fidelity: str, values: Mapping[str, Any]) -> dict[str, float]:
    """Returns the largest residuals of a correct answer, which depend on rounding."""
    flows = {"heat_flow_residual": 1e-5} if "heat_flow_residual" in values else {}
    if fidelity == "dynamic":
        return flows | {"equilibrium_residual": 1e-6, "energy_account_error": 1e-3}
    rounding = {"equilibrium_residual": "equilibrium_rounding"}
    if fidelity == "steady":
        rounding |= {
            "friction_residual": "friction_rounding",
            "power_balance_error": "power_rounding",
        }
    return flows | {name: _tolerance(values[key]) for name, key in rounding.items()}


def _tolerance(rounding: float) -> float:
    """Returns the largest residual of a correct answer with an estimated rounding error."""
    return max(LEAST_TOLERANCE, min(LARGEST_TOLERANCE, rounding))


def study_attributes(kind: str, name: str) -> dict[str, str]:
    """Returns attributes that distinguish the files of the study."""
    return {"title": f"Robustness: {kind}, {name}", "kind": kind, "name": name}
