"""Solves steady states over two axes, and finds the boundaries of what is possible."""

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
    """Steady states over two axes of a map of a plan, with its boundaries along y.

    Each boundary is found from solutions, and estimated by closed forms.
    """
    robustness = read_robustness(plan)
    one = entry(robustness, plan, "maps", name)
    along_x, along_y = record(KeyAxis, one["x"], "x"), record(KeyAxis, one["y"], "y")
    limits, scene = limit_values(robustness, name), base_scene(robustness, plan)
    base = bare(with_values(load_scene(scene).to_dict(), one["set"]))
    keys, axes = (along_y.key, along_x.key), {Y: along_y.values, X: along_x.values}
    points = [dict(zip(keys, values, strict=True)) for values in itertools.product(*axes.values())]
    answers = answers_at(partial(map_state, base), points, workers=1, label=name)
    states = [answer_values(answer) for answer in answers]
    borders = []
    for k, at_x in enumerate(along_x.values):
        line = MapLine(base, along_x.key, at_x, along_y)
        solutions = states[k :: len(along_x.values)]
        border = {}
        for limit, value in limits.items():
            border[f"boundary_{limit}"] = line.boundary(limit, value, solutions)
            border[f"estimate_{limit}"] = line.estimate(limit, value)
        borders.append(border)
    found = dataset_of_rows(
        MAP_STATES,
        axes,
        states,
        **study_attributes("maps", name),
        shown=one["title"],
        x_key=along_x.key,
        y_key=along_y.key,
        x_log=int(along_x.is_log),
        y_log=int(along_y.is_log),
    )
    text = "limit along y, from solutions or from a closed form"
    kinds = table(*(Variable(key, (), "", text) for key in borders[0]))
    lines = dataset_of_rows(kinds, {X: along_x.values}, borders)
    for key in lines:
        value = limits[str(key).partition("_")[2]]
        lines[key].attrs |= {} if value is None else {"limit": value}
    return found.merge(lines, combine_attrs="override")


def map_state(base: Mapping[str, Any], values: Mapping[str, float]) -> dict[str, Any]:
    """A row of `MAP_STATES` of a scene with other values of some keys."""
    scene = scene_from_dict(with_values(base, values))
    found = solved_values(scene, "steady")
    row = {"status": found["status"], "violations": "; ".join(violations(scene, "steady", found))}
    if found["status"] != code.OK:
        return row
    row |= {key: found[key] for key in _SHOWN}
    return row | {"gyroscopic_slip_share": np.max(found["gyroscopic_slip_share"])}


class MapLine:
    """The steady states of a map at one value of x."""

    def __init__(self, base: Mapping[str, Any], key: str, x: float, axis: KeyAxis) -> None:
        self.base = with_values(base, {key: x})
        self.axis = axis

    def scene(self, y: float) -> Scene:
        return scene_from_dict(with_values(self.base, {self.axis.key: y}))

    def boundary(self, limit: str, value: float | None, solutions: list[dict]) -> float:
        """Where a limit is passed, from the solutions at the points of the axis; NaN if never."""
        beyond = partial(excess, limit, value)
        return crossing(
            self.axis,
            list(map(beyond, solutions)),
            lambda y: beyond(map_state(self.base, {self.axis.key: y})),
        )

    def estimate(self, limit: str, value: float | None) -> float:
        """Where closed forms pass a limit; NaN if they do not."""

        def beyond(y: float) -> float:
            return closed_form(limit, value, self.scene(y))

        return crossing(self.axis, list(map(beyond, self.axis.values)), beyond)


def excess(limit: str, value: float | None, values: Mapping[str, Any]) -> float:
    """A number that is positive beyond a limit, NaN where a row of `MAP_STATES` does not say."""
    if value is None:
        return 1.0 if values["status"] in (code.CONTACT_LOST, code.PRELOAD_GONE) else -1.0
    if limit == "gyroscopic_slip":
        return float(values.get("gyroscopic_slip_share", math.nan)) - value
    return abs(float(values.get("skid_ratio", math.nan))) - value


def crossing(axis: KeyAxis, known: list[float], at: Callable[[float], float]) -> float:
    """Where along an axis a number changes sign for the last time, by bisection; NaN if never.

    The number is `known` at the points of the axis.
    """
    values = axis.values
    for k in range(len(known) - 2, -1, -1):
        if known[k] * known[k + 1] < 0.0:
            break
    else:
        return math.nan
    low, high, sign = values[k], values[k + 1], math.copysign(1.0, known[k])
    for _ in range(20):
        middle = math.sqrt(low * high) if axis.is_log and low > 0.0 else 0.5 * (low + high)
        value = at(middle)
        if not math.isfinite(value):
            return math.nan
        low, high = (middle, high) if value * sign > 0.0 else (low, middle)
    return 0.5 * (low + high)
