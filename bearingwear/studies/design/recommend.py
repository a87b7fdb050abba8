"""The preload to take, between those of a design map.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.results.netcdf import CaseFileError, data_array, load
from bearingwear.results.variable import Variable
from bearingwear.results.warnings import gathered_warnings
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.studies.dataset import LOSS_BASIS, counted, dataset_with
from bearingwear.studies.design.choice import (
    ACTIVE_LIMIT,
    best_within,
    limits_of,
    whole_map,
    why_none,
)
from bearingwear.studies.design.followed import (
    as_followed,
    followed_lines,
    with_grooves,
)
from bearingwear.studies.design.map import life_point, part_of, scenes_of_part
from bearingwear.studies.design.plan import DesignLimits, MapAxes
from bearingwear.studies.design.preload_line import PreloadLine, best_point
from bearingwear.studies.design.room import (
    Room,
    criteria_room,
    friction_room,
    limit_room,
    lives_by_track,
)
from bearingwear.studies.design.verdict import held, verdict_on
from bearingwear.studies.design.words import NONE_BECAUSE
from bearingwear.studies.life_scene import life_scene
from bearingwear.studies.pool import Tell, in_processes, to_stderr, told_in_lines

RECOMMENDATION = "recommendation"
RECOMMENDED_PRELOAD = Variable(
    "preload",
    (),
    "N",
    "recommended initial axial preload",
    comment="in three digits, or as many more as keep to the limits and to the life",
)
HERTZIAN_PRELOAD = Variable(
    "hertzian_preload", (), "N", "preload of the map, of Hertzian grooves, with the longest life"
)
LIFE_ERROR = Variable(
    "life_error_estimate", LOSS_BASIS.dims, "1", "estimated numerical error of the life"
)


def recommendation_of(scene: Path, design: Path) -> xr.Dataset:
    """Step: the preload to take, from a scene and its design map."""
    return recommendation(life_scene(scene), load(design))


def small_map(
    scene: Path, axes: Mapping[str, Any], limits: Mapping[str, float], workers: int = 1
) -> tuple[xr.Dataset, xr.Dataset]:
    """Step: a map and the preload to take of it.

    Parameters
    ----------
    scene : path
    axes, limits : mapping
        `MapAxes` and `DesignLimits` by their names.
    workers : int
        Processes that share the lives.
    """

    def tell(text: str) -> None:
        to_stderr(f"{scene.stem}: {text}")

    return mapped(life_scene(scene), MapAxes(**axes), DesignLimits(**limits), workers, tell)


def mapped(
    scene: Scene,
    axes: MapAxes,
    limits: DesignLimits,
    workers: int = 1,
    tell: Tell | None = None,
) -> tuple[xr.Dataset, xr.Dataset]:
    """A map and the preload to take of it; `workers` and `tell` as of `recommendation`."""
    slip_limit = limits.gyroscopic_slip_share
    parts = [
        (method, friction, axes.shaft_speed_rpm, axes.preload_N)
        for method in axes.preload_method
        for friction in axes.friction
    ]
    scenes = [one for part in parts for one in scenes_of_part(scene, *part)]
    many = 1 if scene.pair is None else workers  # a pair's life takes a second
    lives = in_processes(partial(life_point, slip_limit=slip_limit), scenes, many, "recommend")
    if tell is not None:
        lives = told_in_lines(lives, len(scenes), "{} of {} lives with Hertzian grooves", tell=tell)
    points = iter(list(lives))
    each = len(scenes) // len(parts)
    made = [part_of(scene, *part, slip_limit, list(islice(points, each))) for part in parts]
    design = whole_map(made, limits.given)
    return design, recommendation(scene, design, workers, tell)


def recommendation(
    scene: Scene, design: xr.Dataset, workers: int = 1, tell: Tell | None = None
) -> xr.Dataset:
    """The preload to take for each method at the scene's own friction and speed, between the
    map's preloads.

    Where the scene's life follows the grooves as they wear, so do all lives of the lines of
    preloads at its friction and speed, and the choice is made by those. The limit that holds the
    best preload is followed to where it is met exactly; where none does, the longest life between
    the neighbours is looked for.

    Parameters
    ----------
    scene : Scene
    design : Dataset
        The map.
    workers : int
        Processes that share the lives whose grooves are followed.
    tell : callable, optional
        Given a line of text now and then, where grooves are followed.

    Raises
    ------
    CaseFileError
        Where the map is of another scene or does not hold its friction and speed.
    """
    if json.loads(design.attrs["scene"]) != scene.to_dict():
        raise CaseFileError("the design map is not of this scene")
    point = {"friction": scene.friction.coefficient, "shaft_speed": scene.operation.shaft_speed_rpm}
    for axis, value in point.items():
        if value not in design[axis]:
            raise CaseFileError(f"the design map has no {axis} {value:g}, which is the scene's")
    limits, basis = limits_of(design), counted(design)
    at_scene = design.sel(point, drop=True)
    lines = followed_lines(scene, at_scene, limits.gyroscopic_slip_share, workers, tell)
    if lines is at_scene and scene.pair is None:  # quick
        workers, tell = 1, None
    if tell:
        tell("the best preloads between those of the map")
    rows, none = _best_of_each(scene, lines, limits, basis, workers)
    for row, preload in zip(rows, at_scene["recommended_preload"].values.tolist(), strict=True):
        row["hertzian_preload"] = preload
    found = _dataset(rows, at_scene, design)
    if tell:
        tell("how far the choice holds")
    held_so = _held(scene, lines, found, limits, basis, workers)
    found = found.merge(held_so, combine_attrs="override")
    if lines is not at_scene:
        found = found.assign(as_followed(lines))
    found.attrs["warnings"] = gathered_warnings({"warnings": r.get("warnings", "[]")} for r in rows)
    return found.assign_attrs({NONE_BECAUSE: json.dumps(none)} if none else {})


def _best_of_each(
    scene: Scene, lines: xr.Dataset, limits: DesignLimits, basis: int, workers: int
) -> tuple[list[dict[str, Any]], dict[str, str]]:
    """What is best of each method; and by method why there is nothing."""
    rows: list[dict[str, Any]] = []
    none, places, searched = {}, [], []
    for k, flag in enumerate(lines["preload_method"].values):
        one, method = lines.isel(preload_method=k), PRELOAD_METHODS[int(flag)]
        index, active = (int(found) for found in best_within(one, limits, basis))
        rows.append({"active_limit": active, "preload": np.nan, "status": -1})
        if index < 0:
            none[method] = why_none(one, limits, basis)
            continue
        line = PreloadLine(
            scene=scene,
            method=method,
            limits=limits,
            basis=basis,
            preloads=one["preload"].values,
            lives=one["life"].isel(loss_basis=basis).values,
        )
        searched.append((line, index, active))
        places.append(k)
    better = in_processes(best_point, searched, min(workers, len(searched)), "recommend")
    for k, row in zip(places, better, strict=True):
        rows[k] |= row
    return rows, none


def _held(
    scene: Scene,
    lines: xr.Dataset,
    found: xr.Dataset,
    limits: DesignLimits,
    basis: int,
    workers: int,
) -> xr.Dataset:
    """How far the choice holds: limits with new preloads, all else at the recommended ones."""
    pairs = zip(found["preload_method"].values, found["preload"].values.tolist(), strict=True)
    scenes = [
        held_by(scene, PRELOAD_METHODS[int(flag)], preload) if np.isfinite(preload) else None
        for flag, preload in pairs
    ]
    room: Room = limit_room(lines, limits, basis)
    both = [one for one in scenes if one is not None]
    asked: list[Callable[[], Any]] = [partial(lives_by_track, scenes, basis)]
    if len(both) == 2:
        asked += [partial(criteria_room, both, basis), partial(friction_room, both, basis)]
    tracks, *rooms = in_processes(_called, asked, workers, "recommend")
    for one in rooms:
        room |= one
    lives = found["life"].isel(loss_basis=basis).values.tolist()
    errors = found["life_error_estimate"].isel(loss_basis=basis).values.tolist()
    return held(room, tracks, verdict_on(lives, errors, room, tracks))


def _called(asked: Callable[[], Any]) -> Any:
    return asked()


def _dataset(
    rows: Sequence[dict[str, Any]], at_scene: xr.Dataset, design: xr.Dataset
) -> xr.Dataset:
    along = ("preload_method",)
    unknown: dict[str, Any] = {"end_criterion": len(CRITERIA) - 1}
    unknown |= {"life_error_estimate": np.full(2, np.nan)}
    rows = [unknown | row for row in rows]
    variables = with_grooves(rows, {"preload_method": len(rows)})
    variables["status"].attrs["missing"] = "-1: there was none to solve"
    for variable in (
        RECOMMENDED_PRELOAD,
        HERTZIAN_PRELOAD,
        replace(ACTIVE_LIMIT, long_name="what keeps it from a longer life"),
        LIFE_ERROR,
    ):
        column = np.array([row[variable.name] for row in rows])
        variables[variable.name] = data_array(variable, column, along)
    return dataset_with(
        variables,
        {name: at_scene[name].variable for name in ("preload_method", "loss_basis")},
        design.attrs | {"kind": RECOMMENDATION, "title": "Recommended preload"},
    )


def recommended_for(scene: Scene, recommendation: xr.Dataset | None) -> xr.Dataset:
    """The same, if it is the recommendation of this scene.

    Raises
    ------
    CaseFileError
        Where it is not.
    """
    if recommendation is None or recommendation.attrs.get("kind") != RECOMMENDATION:
        raise CaseFileError("the recommended preload needs the file of a recommendation")
    if json.loads(recommendation.attrs["scene"]) != scene.to_dict():
        raise CaseFileError("the recommendation is not of this scene")
    return recommendation


def best_method(recommendation: xr.Dataset) -> int | None:
    """Number of the method with the longest recommended life; None if no preload is allowed."""
    lives = recommendation["life"].isel(loss_basis=counted(recommendation)).values
    return int(np.nanargmax(lives)) if np.isfinite(lives).any() else None
