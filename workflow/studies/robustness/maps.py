"""Solves steady states over two axes, and finds the boundaries at limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
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
from workflow.studies.robustness.draw import with_values, without_cage_and_end
from workflow.studies.robustness.plan import (
    KeyAxis,
    base_scene,
    limit_values,
    plan_entry,
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

_BISECTIONS = 20
"""Halvings of an interval of an axis, to a millionth of it."""


def state_map(plan: Path, name: str) -> xr.Dataset:
    """Step: returns the steady states of a map, and the boundaries along y at its limits.

    plan: file of the plan.
    name: of the map in the plan.

    Returns the variables of `MAP_STATES` over y and x, and over x the boundary of each limit by
        solutions and its estimate by closed forms.
    """
    robustness = read_robustness(plan)
    map_plan = plan_entry(robustness, plan, "maps", name)
    x_axis = record(KeyAxis, map_plan["x"], "x")
    y_axis = record(KeyAxis, map_plan["y"], "y")
    scene_data = load_scene(base_scene(robustness, plan)).to_dict()
    base = without_cage_and_end(with_values(scene_data, map_plan["set"]))
    points = [{y_axis.key: y, x_axis.key: x} for y in y_axis.values for x in x_axis.values]
    answers = answers_at(partial(map_state, base), points, workers=1, label=name)
    states = [answer_values(answer) for answer in answers]
    limits = limit_values(robustness, name)
    boundaries = []
    for k, x in enumerate(x_axis.values):
        line = MapLine(base, x_axis.key, x, y_axis)
        solutions = states[k :: len(x_axis.values)]  # those at x, for rising y
        boundaries.append(_line_boundaries(line, limits, solutions))
    states_map = dataset_of_rows(
        MAP_STATES,
        {Y: y_axis.values, X: x_axis.values},
        states,
        **study_attributes("maps", name),
        shown=map_plan["title"],
        x_key=x_axis.key,
        y_key=y_axis.key,
        x_log=int(x_axis.is_log),
        y_log=int(y_axis.is_log),
    )
    text = "limit along y, from solutions or from a closed form"
    limit_variables = table(*(Variable(key, (), "", text) for key in boundaries[0]))
    lines = dataset_of_rows(limit_variables, {X: x_axis.values}, boundaries)
    for key in lines:
        _, _, limit = str(key).partition("_")
        value = limits[limit]
        if value is not None:
            lines[key].attrs["limit"] = value
    return states_map.merge(lines, combine_attrs="override")


def _line_boundaries(
    line: MapLine, limits: Mapping[str, float | None], solutions: Sequence[Mapping[str, Any]]
) -> dict[str, float]:
    """Returns `boundary_LIMIT` and `estimate_LIMIT` for each limit: values of y, NaN for none.

    limits: values by name; contact has none.
    solutions: rows of `MAP_STATES` on the line.
    """
    boundaries = {}
    for limit, value in limits.items():
        boundaries[f"boundary_{limit}"] = line.boundary(limit, value, solutions)
        boundaries[f"estimate_{limit}"] = line.estimate(limit, value)
    return boundaries


def map_state(base: Mapping[str, Any], values: Mapping[str, float]) -> dict[str, Any]:
    """Returns the values of `MAP_STATES` of a scene with other values of some keys.

    Where the case is not solved, these are `status` and `violations` alone.

    base: plain data of the scene.
    """
    scene = scene_from_dict(with_values(base, values))
    solution = solved_values(scene, "steady")
    problems = "; ".join(violations(scene, "steady", solution))
    row = {"status": solution["status"], "violations": problems}
    if solution["status"] != code.OK:
        return row
    row |= {key: solution[key] for key in _SHOWN}
    return row | {"gyroscopic_slip_share": np.max(solution["gyroscopic_slip_share"])}


class MapLine:
    """The steady states of a map at a value of x.

    base: plain data of the scene of the map.
    key: of x.
    axis: along y.
    """

    def __init__(self, base: Mapping[str, Any], key: str, x: float, axis: KeyAxis) -> None:
        """Sets the scene data of the line: those of the map with a value of the key of x."""
        self.base = with_values(base, {key: x})
        self.axis = axis

    def scene(self, y: float) -> Scene:
        """Returns the scene at a value of y."""
        return scene_from_dict(with_values(self.base, {self.axis.key: y}))

    def boundary(
        self, limit: str, value: float | None, solutions: Sequence[Mapping[str, Any]]
    ) -> float:
        """Returns the largest y at which a limit is crossed, by solutions; NaN if none is.

        It lies between two neighbouring points, and is found by bisection with further solves.

        solutions: rows of `MAP_STATES` at the points of the axis.
        value: of the limit; None for loss of contact.
        """

        def excess_at(y: float) -> float:
            """Returns the excess over the limit at y, by a solve."""
            return excess(limit, value, map_state(self.base, {self.axis.key: y}))

        numbers = [excess(limit, value, solution) for solution in solutions]
        return crossing(self.axis, numbers, excess_at)

    def estimate(self, limit: str, value: float | None) -> float:
        """Returns the largest y at which a limit is crossed, by a closed form; NaN if none is.

        value: of the limit; None for loss of contact.
        """

        def excess_at(y: float) -> float:
            """Returns the excess over the limit at y, by the closed form."""
            return closed_form(limit, value, self.scene(y))

        return crossing(self.axis, [excess_at(y) for y in self.axis.values], excess_at)


def excess(limit: str, value: float | None, values: Mapping[str, Any]) -> float:
    """Returns a number that is positive beyond a limit; NaN if the state lacks the quantity.

    It is the gyroscopic slip share, or the magnitude of the skid ratio, less the limit. For loss of
    contact it is 1 or -1.

    value: of the limit; None for loss of contact.
    values: of `MAP_STATES` of the state.
    """
    if value is None:
        return 1.0 if values["status"] in (code.CONTACT_LOST, code.PRELOAD_GONE) else -1.0
    if limit == "gyroscopic_slip":
        return float(values.get("gyroscopic_slip_share", math.nan)) - value
    return abs(float(values.get("skid_ratio", math.nan))) - value


def crossing(axis: KeyAxis, numbers: list[float], number_at: Callable[[float], float]) -> float:
    """Returns where a number changes sign for the last time along an axis; NaN if never.

    Points where it is NaN have no sign.

    numbers: at the points of the axis.
    number_at: computes it elsewhere, for bisection; where it is not finite, NaN is returned.
    """
    changes = [k for k in range(len(numbers) - 1) if numbers[k] * numbers[k + 1] < 0.0]
    if not changes:
        return math.nan
    k = changes[-1]
    low, high = axis.values[k], axis.values[k + 1]
    sign = math.copysign(1.0, numbers[k])
    for _ in range(_BISECTIONS):
        middle = math.sqrt(low * high) if axis.is_log and low > 0.0 else 0.5 * (low + high)
        number = number_at(middle)
        if not math.isfinite(number):
            return math.nan
        if number * sign > 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
