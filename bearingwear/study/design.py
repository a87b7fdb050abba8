"""The design map: many lives over preload, method, friction and speed, and what to choose.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import brentq, minimize_scalar

from bearingwear.io.netcdf import CaseFileError, common_attributes, load
from bearingwear.io.variables import CRITERIA, HOUR, STATUS
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.model.life import WearState, course_of, life, steady_states
from bearingwear.model.scene import COUNTS, EndOfLife, Scene
from bearingwear.study.design_plan import DesignMap, Limits
from bearingwear.study.grid import PRELOAD_METHODS
from bearingwear.study.tradeoff import pareto

COUNTED = "what wear counts as loss"

LIFE_VALUES: dict[str, tuple[str, str]] = {
    "residual_preload_at_start": ("running preload when new", "N"),
    "residual_preload_at_end": ("residual preload at the end of life", "N"),
    "loss_at_end": ("loss of ball diameter at the end of life", "m"),
    "gyroscopic_slip_share": (
        "largest gyroscopic slip share of a contact from new to the end of life",
        "1",
    ),
    "axial_stiffness": ("least axial stiffness from new to the end of life", "N m-1"),
    "maximum_pressure": ("largest contact pressure from new to the end of life", "Pa"),
    "friction_power": (
        "largest power of friction and drag of the whole bearing from new to the end of life",
        "W",
    ),
    "friction_power_at_start": ("power of friction and drag of the whole bearing when new", "W"),
    "axial_stiffness_at_start": ("axial stiffness when new", "N m-1"),
}
"""What a life has besides its durations; NaN where it was not solved."""

LIMITED: dict[str, tuple[str, float, float]] = {
    "gyroscopic_slip_share": ("gyroscopic_slip_share", 1.0, 1.0),
    "axial_stiffness_N_um": ("axial_stiffness", -1.0, 1e6),
    "maximum_pressure_GPa": ("maximum_pressure", 1.0, 1e9),
    "friction_power_W": ("friction_power", 1.0, 1.0),
}
"""Which value a limit is for, whether from above (1) or below (-1), and its unit in SI."""

ACTIVE = (*LIMITED, "none", "end_of_range", "not_solved", "no_preload_within_limits")
"""What keeps the recommended preload from another one with a longer life."""
NONE, END_OF_RANGE, NOT_SOLVED, NO_PRELOAD = range(len(LIMITED), len(ACTIVE))

PRELOAD_TOLERANCE = 1e-6  # relative, of the recommended preload
AT_LIMIT = 5e-3  # what is left to a limit, relative, that counts as nothing


def life_point(scene: Scene, slip_limit: float | None) -> dict[str, Any]:
    """One life by the steady model, and what the bearing goes through on its way.

    Parameters
    ----------
    scene : Scene
        With a steady state and an end of life.
    slip_limit : float, optional
        Gyroscopic slip share whose passing is timed.

    Returns
    -------
    dict
        `status` and `end_criterion` of the life, `solves` and `failed_solves` on the way, and where
        the status is ok: `life` and `time_to_slip_limit` (2,) [s] by both ways of counting wear
        (infinite where the share stays below its limit), and `LIFE_VALUES`.
    """
    known: dict[float, WearState] = {}
    solve = steady_states(scene)

    def state(loss: float) -> WearState:
        if loss not in known:
            known[loss] = solve(loss)
        return known[loss]

    course = course_of(scene, state)
    found: dict[str, Any] = {"status": course.status, "end_criterion": course.criterion}
    if course.status == OK:
        way = course.states
        found |= {
            "life": course.times[-1],
            "residual_preload_at_start": way[0].preload,
            "residual_preload_at_end": way[-1].preload,
            "loss_at_end": way[-1].loss,
            "gyroscopic_slip_share": max(s.share.max() for s in way),
            "axial_stiffness": min(s.stiffness for s in way),
            "maximum_pressure": max(s.pressure for s in way),
            "friction_power": max(s.friction_power for s in way),
            "friction_power_at_start": way[0].friction_power,
            "axial_stiffness_at_start": way[0].stiffness,
        }
        if slip_limit is not None:
            found["time_to_slip_limit"] = np.full(2, np.inf)
            if found["gyroscopic_slip_share"] >= slip_limit:
                # the same march, ended by the share: it meets the states solved already
                share = EndOfLife(gyroscopic_slip_share=slip_limit)
                until = replace(scene, wear=replace(scene.wear, end_of_life=share))
                found["time_to_slip_limit"] = course_of(until, state).times[-1]
    found["solves"] = len(known)
    found["failed_solves"] = sum(s.status != OK for s in known.values())
    return found


def at(scene: Scene, method: str, mu: float, speed_rpm: float, preload_N: float) -> Scene:
    """The scene at a point of the map."""
    operation = replace(
        scene.operation, preload_method=method, shaft_speed_rpm=speed_rpm, preload_N=preload_N
    )
    return replace(scene, operation=operation, friction=replace(scene.friction, ball_race=mu))


def chunk(scene: Scene, plan: DesignMap, method: str, mu: float) -> xr.Dataset:
    """Lives over preload and speed, for one method and one friction coefficient."""
    shape = (1, 1, len(plan.shaft_speed_rpm), len(plan.preload_N))
    dims = ("preload_method", "friction", "shaft_speed", "preload")
    points = [
        life_point(at(scene, method, mu, speed, preload), plan.limits.gyroscopic_slip_share)
        for speed in plan.shaft_speed_rpm
        for preload in plan.preload_N
    ]
    coords = {
        "preload_method": (
            "preload_method", np.array([PRELOAD_METHODS.index(method)], dtype=np.int8),
            flags("how the preload is applied", PRELOAD_METHODS),
        ),
        "friction": ("friction", [mu], attrs("ball/race friction coefficient", "1")),
        "shaft_speed": ("shaft_speed", list(plan.shaft_speed_rpm), attrs("shaft speed", "rpm")),
        "preload": ("preload", list(plan.preload_N), attrs("initial axial preload", "N")),
        "counts": ("counts", np.arange(2, dtype=np.int8), flags(COUNTED, COUNTS)),
    }  # fmt: skip
    return xr.Dataset(life_variables(points, shape, dims), coords, file_attributes(scene, plan))


def life_variables(
    points: list[dict[str, Any]], shape: tuple[int, ...], dims: tuple[str, ...]
) -> dict[str, tuple]:
    """Variables of a file from what `life_point` gives, points in C order."""

    def column(name: str, missing: Any, dtype: Any = float) -> np.ndarray:
        return np.array([p.get(name, missing) for p in points], dtype=dtype)

    both, unknown = (*shape, 2), np.full(2, np.nan)
    variables: dict[str, tuple] = {
        "status": (
            dims, column("status", None, np.int8).reshape(shape),
            flags(STATUS.long_name, STATUS_NAMES) | {"comment": str(STATUS.comment)},
        ),
        "end_criterion": (
            dims, column("end_criterion", None, np.int8).reshape(shape),
            flags("criterion that ends the life", CRITERIA),
        ),
        "solves": (
            dims, column("solves", 0, np.int32).reshape(shape),
            attrs("steady states solved on the way", "1"),
        ),
        "failed_solves": (
            dims, column("failed_solves", 0, np.int32).reshape(shape),
            attrs("steady states on the way that were not found", "1"),
        ),
        "life": (
            (*dims, "counts"), (column("life", unknown) * HOUR).reshape(both),
            attrs("wear life", "h"),
        ),
    }  # fmt: skip
    if any("time_to_slip_limit" in p for p in points):
        times = np.reshape(column("time_to_slip_limit", unknown) * HOUR, both)
        comment = "infinite where the life ends before"
        variables["time_to_slip_limit"] = (
            (*dims, "counts"),
            times,
            attrs("time until the gyroscopic slip share reaches its limit", "h")
            | {"comment": comment},
        )
    for name, (long_name, units) in LIFE_VALUES.items():
        variables[name] = (dims, column(name, np.nan).reshape(shape), attrs(long_name, units))
    return variables


def gathered(paths: Iterable[str | Path]) -> xr.Dataset:
    """All parts of a map as one dataset, with the best preload of every line of it.

    Raises
    ------
    CaseFileError
        One line: no part of a map, parts that do not belong together, or parts missing.
    """
    parts = [(Path(path), load(path)) for path in paths]
    for path, part in parts:
        if part.attrs.get("kind") != "design map":
            raise CaseFileError(f"{path}: not a part of a design map")
        if part.attrs != parts[0][1].attrs:
            raise CaseFileError(f"{path}: not of the scene, limits or sources of {parts[0][0]}")
    try:
        whole = xr.combine_by_coords(
            [part for _, part in parts], combine_attrs="drop_conflicts", join="exact",
            compat="equals", data_vars="all",
        )  # fmt: skip
    except ValueError as error:
        raise CaseFileError(f"parts of a design map: {' '.join(str(error).split())}") from None
    assert isinstance(whole, xr.Dataset)
    if whole["status"].dtype.kind == "f":  # combining fills holes with NaN
        raise CaseFileError("parts of a design map: some are missing")
    index, active = chosen(whole, limits_of(whole), counted(whole))
    none = index < 0
    best = whole.isel(preload=xr.where(none, 0, index))
    whole["recommended_preload"] = (
        best["preload"].where(~none).assign_attrs(attrs("preload with the longest life", "N"))
    )
    whole["recommended_life"] = (
        best["life"].where(~none).assign_attrs(attrs("life at the recommended preload", "h"))
    )
    whole["active_limit"] = active
    return whole


def limits_of(design: xr.Dataset) -> Limits:
    """The limits a map was made with."""
    return Limits(**json.loads(design.attrs["limits"]))


def counted(design: xr.Dataset) -> int:
    """Which way of counting wear the scene of a file takes."""
    return COUNTS.index(json.loads(design.attrs["scene"])["wear"]["counts"])


def margins(values: Any, limits: Limits) -> list[Any]:
    """How far each limit is from being passed, relative to it; below zero where it is.

    In the order of `limits.given`; `values` is a Dataset or a dict of `LIFE_VALUES`.
    """
    return [
        LIMITED[name][1] * (1.0 - values[LIMITED[name][0]] / (limit * LIMITED[name][2]))
        for name, limit in limits.given.items()
    ]


def chosen(design: xr.Dataset, limits: Limits, counts: int) -> tuple[xr.DataArray, xr.DataArray]:
    """Index of the preload with the longest life within the limits, and the limit that holds it.

    Lives that were not solved are never chosen. The active limit is what keeps the choice from the
    neighbouring preload whose life is longer: the limit passed there by most, the end of the range,
    a neighbour that was not solved, or nothing (the life itself is longest there).

    Returns
    -------
    index, active : DataArray
        Over the dimensions of the map but `preload`; index -1 where no preload is within the
        limits.
    """
    others = [str(dim) for dim in design["status"].dims if dim != "preload"]
    order = (*others, "preload")
    solved = (design["status"] == OK).transpose(*order).values
    lives = design["life"].isel(counts=counts).transpose(*order).values
    each = [m.transpose(*order).values for m in margins(design, limits)]
    names = list(limits.given)
    index = np.full(solved.shape[:-1], -1)
    active = np.full(solved.shape[:-1], NO_PRELOAD, dtype=np.int8)
    for line in np.ndindex(index.shape):
        of = np.array([m[line] for m in each]).reshape(len(names), solved.shape[-1])
        allowed = solved[line] & (lives[line] > 0.0) & np.all(of >= 0.0, axis=0)
        if allowed.any():
            best = int(np.argmax(np.where(allowed, lives[line], -np.inf)))
            index[line] = best
            active[line] = _held_by(best, solved[line], lives[line], of, names)
    coords = {dim: design[dim] for dim in others}
    return (
        xr.DataArray(index, coords, others),
        xr.DataArray(
            active, coords, others, attrs=flags("what keeps the preload from a longer life", ACTIVE)
        ),
    )


def _held_by(
    best: int, solved: np.ndarray, lives: np.ndarray, margin: np.ndarray, names: list[str]
) -> int:
    """What keeps a line's best preload from its neighbour with the longer life."""
    neighbours = [k for k in (best - 1, best + 1) if 0 <= k < len(lives)]
    longer = [k for k in neighbours if solved[k] and lives[k] > lives[best]]
    if longer:  # passes a limit, or it would have been chosen
        beyond = max(longer, key=lambda k: lives[k])
        return ACTIVE.index(names[int(np.argmin(margin[:, beyond]))])
    if any(not solved[k] for k in neighbours):
        return NOT_SOLVED
    return END_OF_RANGE if len(neighbours) < 2 else NONE


def recommendation(scene: Scene, design: xr.Dataset) -> xr.Dataset:
    """The preload to take for each method at the scene's own friction and speed, between the
    map's preloads.

    The limit that holds the best preload of the map is followed to where it is met exactly; where
    none does, the longest life between the neighbours is looked for.

    Raises
    ------
    CaseFileError
        Where the map is of another scene or does not hold its friction and speed.
    """
    if json.loads(design.attrs["scene"]) != scene.to_dict():
        raise CaseFileError("the design map is not of this scene")
    point = {"friction": scene.friction.ball_race, "shaft_speed": scene.operation.shaft_speed_rpm}
    for axis, value in point.items():
        if value not in design[axis]:
            raise CaseFileError(f"the design map has no {axis} {value:g}, which is the scene's")
    limits, counts = limits_of(design), counted(design)
    line = design.sel(point, drop=True)
    rows = []
    for k, flag in enumerate(line["preload_method"].values):
        of = line.isel(preload_method=k)
        method = PRELOAD_METHODS[int(flag)]
        index, active = (int(found) for found in chosen(of, limits, counts))
        row: dict[str, Any] = {"active_limit": active, "preload": np.nan, "status": -1}
        if index >= 0:
            row |= _refined(scene, method, of, index, active, limits, counts)
        rows.append(row)
    return _recommended(rows, line, design)


def _refined(
    scene: Scene,
    method: str,
    line: xr.Dataset,
    index: int,
    active: int,
    limits: Limits,
    counts: int,
) -> dict[str, Any]:
    preloads, lives = line["preload"].values, line["life"].isel(counts=counts).values

    def point(preload: float) -> dict[str, Any]:
        op = scene.operation
        given = at(scene, method, scene.friction.ball_race, op.shaft_speed_rpm, preload)
        return life_point(given, limits.gyroscopic_slip_share)

    def margin(preload: float) -> float:
        found = point(preload)
        return min(margins(found, limits)) if found["status"] == OK else -1.0

    best = float(preloads[index])
    if active < NONE:
        ends = [k for k in (index - 1, index + 1) if 0 <= k < len(lives)]
        beyond = max((k for k in ends if lives[k] > lives[index]), key=lambda k: lives[k])
        a, b = best, float(preloads[beyond])
        if margin(a) > 0.0:  # else it stands on the limit already
            root = brentq(margin, a, b, rtol=PRELOAD_TOLERANCE)
            # the side of the root that keeps to the limits
            near = (root, root + PRELOAD_TOLERANCE * (a - b), root + 1e-3 * (a - b), a)
            best = next(p for p in near if margin(p) >= 0.0)
    elif active == NONE:
        found = minimize_scalar(
            lambda p: -_life_within(point(p), limits, counts),
            bounds=(float(preloads[index - 1]), float(preloads[index + 1])),
            method="bounded",
            options={"xatol": 1e-3 * best},
        )
        if -found.fun > lives[index] / HOUR:
            best = float(found.x)
    values = point(best)
    if active == NONE:  # the life may fall off so fast beyond a limit that the map misses it
        left = margins(values, limits)
        if left and min(left) < AT_LIMIT:
            active = ACTIVE.index(list(limits.given)[int(np.argmin(left))])
    answer = life(
        at(scene, method, scene.friction.ball_race, scene.operation.shaft_speed_rpm, best)
    )
    error = answer.values.get("life_error_estimate", np.full(2, np.nan))
    return values | {"preload": best, "active_limit": active, "life_error_estimate": error}


def _life_within(point: dict[str, Any], limits: Limits, counts: int) -> float:
    """The life of a point [s]; nothing where it was not solved or passes a limit."""
    within = point["status"] == OK and all(m >= 0.0 for m in margins(point, limits))
    return float(point["life"][counts]) if within else 0.0


def _recommended(rows: list[dict[str, Any]], line: xr.Dataset, design: xr.Dataset) -> xr.Dataset:
    shape, dims = (len(rows),), ("preload_method",)
    unknown = {"end_criterion": len(CRITERIA) - 1}
    variables = life_variables([unknown | row for row in rows], shape, dims)
    error = [row.get("life_error_estimate", np.full(2, np.nan)) for row in rows]
    preload = np.array([row["preload"] for row in rows])
    active = np.array([row["active_limit"] for row in rows], dtype=np.int8)
    status = variables["status"]
    variables |= {
        "status": (status[0], status[1], status[2] | {"missing": "-1: there was none to solve"}),
        "preload": (dims, preload, attrs("recommended initial axial preload", "N")),
        "active_limit": (dims, active, flags("what keeps it from a longer life", ACTIVE)),
        "life_error_estimate": (
            (*dims, "counts"), np.array(error), attrs("estimated numerical error of the life", "1"),
        ),
    }  # fmt: skip
    coords = {name: line[name] for name in ("preload_method", "counts")}
    return xr.Dataset(
        variables, coords, design.attrs | {"kind": "recommendation", "title": "Recommended preload"}
    )


def recommended_for(scene: Scene, recommendation: xr.Dataset | None) -> xr.Dataset:
    """The same, if it is the recommendation of this scene.

    Raises
    ------
    CaseFileError
        Where it is not.
    """
    if recommendation is None or recommendation.attrs.get("kind") != "recommendation":
        raise CaseFileError("the recommended preload needs the file of a recommendation")
    if json.loads(recommendation.attrs["scene"]) != scene.to_dict():
        raise CaseFileError("the recommendation is not of this scene")
    return recommendation


def best_method(recommendation: xr.Dataset) -> int | None:
    """Number of the method with the longest recommended life; None if no preload is allowed."""
    lives = recommendation["life"].isel(counts=counted(recommendation)).values
    return int(np.nanargmax(lives)) if np.isfinite(lives).any() else None


def front(design: xr.Dataset, counts: int) -> xr.DataArray:
    """Which points of a map no other beats in both life and stiffness (dimensions of the map)."""
    solved = design["status"] == OK
    lives = design["life"].isel(counts=counts).where(solved)
    stiffness = design["axial_stiffness"].where(solved).transpose(*lives.dims)
    best = pareto(-stiffness.values.ravel(), -lives.values.ravel()).reshape(lives.shape)
    return xr.DataArray(best, lives.coords, lives.dims) & (lives > 0.0)


def attrs(long_name: str, units: str) -> dict[str, Any]:
    return {"long_name": long_name, "units": units}


def flags(long_name: str, meanings: tuple[str, ...]) -> dict[str, Any]:
    return {
        "long_name": long_name,
        "flag_values": np.arange(len(meanings), dtype=np.int8),
        "flag_meanings": " ".join(meanings),
    }


def file_attributes(scene: Scene, plan: DesignMap) -> dict[str, Any]:
    return common_attributes() | {
        "title": f"Design map of {scene.name}",
        "kind": "design map",
        "scene": json.dumps(scene.to_dict()),
        "limits": json.dumps({k: v for k, v in asdict(plan.limits).items() if v is not None}),
    }
