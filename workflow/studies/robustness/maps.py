"""Solves steady states over two axes, and finds the boundaries at limits."""

import itertools
import math
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels import status as code
from bearingwear.results.variable import STATUS, Variable, table
from bearingwear.results.variables import CASE
from bearingwear.scene.checking.check import record
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.scene.scene import Scene
from bearingwear.studies.answers import answer_values, answers_at
from bearingwear.studies.dataset import dataset_of_rows
from workflow.studies.robustness.closed_forms import closed_form
from workflow.studies.robustness.draw import bare, with_values
from workflow.studies.robustness.plan import (
    KeyAxis,
    base_scene,
    entry,
    limit_values,
    read_robustness,
)
from workflow.studies.robustness.run import solved_values, study_attributes, violations

_SHOWN = ("total_qv", "skid_ratio", "residual_preload")
MAP_STATES = table(
    STATUS,
    Variable("violations", (), "", "description of the error; empty if there is none", "O"),
    *(CASE[name] for name in _SHOWN),
    Variable("gyroscopic_slip_share", (), "1", "gyroscopic slip share, larger of the two contacts"),
)
X, Y = (Variable(name, (name,), "", "value of a key") for name in "xy")


def state_map(plan: Path, name: str) -> xr.Dataset:
    """Solves the steady states of a map of a plan, and finds its boundaries along y.

    Each boundary is found from solutions, and estimated by closed forms.
    """
    robustness = read_robustness(plan)
    map_plan = entry(robustness, plan, "maps", name)
    x_axis, y_axis = record(KeyAxis, map_plan["x"], "x"), record(KeyAxis, map_plan["y"], "y")
    limits, scene = limit_values(robustness, name), base_scene(robustness, plan)
    base = bare(with_values(load_scene(scene).to_dict(), map_plan["set"]))
    keys, axes = (y_axis.key, x_axis.key), {Y: y_axis.values, X: x_axis.values}
    points = [dict(zip(keys, values, strict=True)) for values in itertools.product(*axes.values())]
    answers = answers_at(partial(map_state, base), points, workers=1, label=name)
    states = [answer_values(answer) for answer in answers]
    borders = []
    for k, x in enumerate(x_axis.values):
        line = MapLine(base, x_axis.key, x, y_axis)
        solutions = states[k :: len(x_axis.values)]
        border = {}
        for limit, value in limits.items():
            border[f"boundary_{limit}"] = line.boundary(limit, value, solutions)
            border[f"estimate_{limit}"] = line.estimate(limit, value)
        borders.append(border)
    states_map = dataset_of_rows(
        MAP_STATES,
        axes,
        states,
        **study_attributes("maps", name),
        shown=map_plan["title"],
        x_key=x_axis.key,
        y_key=y_axis.key,
        x_log=int(x_axis.is_log),
        y_log=int(y_axis.is_log),
    )
    text = "limit along y, from solutions or from a closed form"
    limit_variables = table(*(Variable(key, (), "", text) for key in borders[0]))
    lines = dataset_of_rows(limit_variables, {X: x_axis.values}, borders)
    for key in lines:
        value = limits[str(key).partition("_")[2]]
        lines[key].attrs |= {} if value is None else {"limit": value}
    return states_map.merge(lines, combine_attrs="override")


def map_state(base: Mapping[str, Any], values: Mapping[str, float]) -> dict[str, Any]:
    """Solves a scene with other values of some keys; returns a row of `MAP_STATES`."""
    scene = scene_from_dict(with_values(base, values))
    solution = solved_values(scene, "steady")
    problems = "; ".join(violations(scene, "steady", solution))
    row = {"status": solution["status"], "violations": problems}
    if solution["status"] != code.OK:
        return row
    row |= {key: solution[key] for key in _SHOWN}
    return row | {"gyroscopic_slip_share": np.max(solution["gyroscopic_slip_share"])}


class MapLine:
    """The steady states of a map at one value of x."""

    def __init__(self, base: Mapping[str, Any], key: str, x: float, axis: KeyAxis) -> None:
        self.base = with_values(base, {key: x})
        self.axis = axis

    def scene(self, y: float) -> Scene:
        """Returns the scene at a value of y."""
        return scene_from_dict(with_values(self.base, {self.axis.key: y}))

    def boundary(self, limit: str, value: float | None, solutions: list[dict]) -> float:
        """Returns y where a limit is passed, from the solutions on the axis; NaN if never."""
        beyond = partial(excess, limit, value)
        return crossing(
            self.axis,
            list(map(beyond, solutions)),
            lambda y: beyond(map_state(self.base, {self.axis.key: y})),
        )

    def estimate(self, limit: str, value: float | None) -> float:
        """Returns y where closed forms pass a limit; NaN if they do not."""

        def beyond(y: float) -> float:
            return closed_form(limit, value, self.scene(y))

        return crossing(self.axis, list(map(beyond, self.axis.values)), beyond)


def excess(limit: str, value: float | None, values: Mapping[str, Any]) -> float:
    """Returns a number that is positive beyond a limit; NaN if a row of `MAP_STATES` lacks it."""
    if value is None:
        return 1.0 if values["status"] in (code.CONTACT_LOST, code.PRELOAD_GONE) else -1.0
    if limit == "gyroscopic_slip":
        return float(values.get("gyroscopic_slip_share", math.nan)) - value
    return abs(float(values.get("skid_ratio", math.nan))) - value


def crossing(axis: KeyAxis, numbers: list[float], number_at: Callable[[float], float]) -> float:
    """Returns where a number changes sign for the last time along an axis; NaN if never.

    numbers: at the points of the axis. number_at: computes it elsewhere, for bisection.
    """
    values = axis.values
    for k in range(len(numbers) - 2, -1, -1):
        if numbers[k] * numbers[k + 1] < 0.0:
            break
    else:
        return math.nan
    low, high, sign = values[k], values[k + 1], math.copysign(1.0, numbers[k])
    for _ in range(20):
        middle = math.sqrt(low * high) if axis.is_log and low > 0.0 else 0.5 * (low + high)
        value = number_at(middle)
        if not math.isfinite(value):
            return math.nan
        low, high = (middle, high) if value * sign > 0.0 else (low, middle)
    return 0.5 * (low + high)
