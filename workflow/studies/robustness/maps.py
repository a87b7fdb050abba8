"""Solves steady states over two axes, and finds the boundaries of what is possible."""

import math
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels import status as code
from bearingwear.scene.checking.check import record
from bearingwear.scene.read import load_scene, scene_from_dict
from bearingwear.scene.scene import Scene
from workflow.studies.robustness.closed_forms import closed_form
from workflow.studies.robustness.draw import bare, with_values
from workflow.studies.robustness.plan import KeyAxis
from workflow.studies.robustness.run import attributes, solved_values, violations

_SHOWN = ("total_qv", "skid_ratio", "residual_preload")


def state_map(
    scene: Path,
    name: str,
    title: str,
    changes: Mapping[str, Any],
    x: Mapping[str, Any],
    y: Mapping[str, Any],
    limits: Mapping[str, float | None],
) -> xr.Dataset:
    """Step: steady states over two axes, boundaries along y, closed-form estimates of them.

    Parameters
    ----------
    scene : path
        Where all start from.
    name, title : str
        Of the map.
    changes : mapping
        Keys of the scene to set.
    x, y : mapping
        Blocks of the axes.
    limits : mapping
        What is sought along y, and beyond which value; None where it needs none.
    """
    along_x, along_y = record(KeyAxis, x, "x"), record(KeyAxis, y, "y")
    base = bare(with_values(load_scene(scene).to_dict(), changes))
    shape = (len(along_y.values), len(along_x.values))
    status, wrong = np.zeros(shape, dtype=np.int8), np.full(shape, "", dtype=object)
    shown = {key: np.full(shape, np.nan) for key in (*_SHOWN, "gyroscopic_slip_share")}
    lines = {
        f"{kind}_{limit}": np.full(len(along_x.values), np.nan)
        for kind in ("boundary", "estimate")
        for limit in limits
    }
    for i, at_x in enumerate(along_x.values):
        line = MapLine(base, along_x.key, at_x, along_y)
        column = []
        for j, at_y in enumerate(along_y.values):
            varied = line.scene(at_y)
            solution = solved_values(varied, "steady")
            status[j, i] = solution["status"]
            wrong[j, i] = "; ".join(violations(varied, "steady", solution))
            if solution["status"] == code.OK:
                for key in _SHOWN:
                    shown[key][j, i] = solution[key]
                shown["gyroscopic_slip_share"][j, i] = share_of(solution)
            column.append(solution)
        for limit, value in limits.items():
            lines[f"boundary_{limit}"][i] = line.boundary(limit, value, column)
            lines[f"estimate_{limit}"][i] = line.estimate(limit, value)
    variables = _variables({"status": status, "violations": wrong} | shown, lines, limits)
    axes = {
        "shown": title,
        "x_key": along_x.key,
        "y_key": along_y.key,
        "x_log": int(along_x.is_log),
        "y_log": int(along_y.is_log),
    }
    coordinates = {"x": list(along_x.values), "y": list(along_y.values)}
    return xr.Dataset(variables, coordinates, attrs=attributes("maps", name, axes))


def _variables(
    over: Mapping[str, np.ndarray],
    lines: Mapping[str, np.ndarray],
    limits: Mapping[str, float | None],
) -> dict[str, Any]:
    """Values over both axes, and lines along x with the limit that each is of."""
    variables: dict[str, Any] = {key: (("y", "x"), values) for key, values in over.items()}
    for key, values in lines.items():
        beyond = limits[key.partition("_")[2]]
        variables[key] = ("x", values, {} if beyond is None else {"limit": beyond})
    return variables


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
            lambda y: beyond(solved_values(self.scene(y), "steady")),
        )

    def estimate(self, limit: str, value: float | None) -> float:
        """Where closed forms pass a limit; NaN if they do not."""

        def beyond(y: float) -> float:
            return closed_form(limit, value, self.scene(y))

        return crossing(self.axis, list(map(beyond, self.axis.values)), beyond)


def share_of(values: Mapping[str, Any]) -> float:
    """Larger gyroscopic share of the slip of both contacts, NaN where nothing was solved."""
    if int(values["status"]) != code.OK:
        return math.nan
    return float(np.max(values["gyroscopic_slip_share"]))


def excess(limit: str, value: float | None, values: Mapping[str, Any]) -> float:
    """A number that is positive beyond a limit, NaN where that cannot be said."""
    if value is None:
        return 1.0 if values["status"] in (code.CONTACT_LOST, code.PRELOAD_GONE) else -1.0
    if limit == "gyroscopic_slip":
        return share_of(values) - value
    return abs(float(values.get("skid_ratio", math.nan))) - value


def crossing(axis: KeyAxis, known: list[float], at: Callable[[float], float]) -> float:
    """Where along an axis a number changes sign for the last time, by bisection; NaN if never.

    Parameters
    ----------
    known : list of float
        The number at the points of the axis.
    at : callable
        The number anywhere.
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
