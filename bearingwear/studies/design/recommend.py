"""The preload to take by each method: the longest life within the requirements.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.lives.errors import groove_errors
from bearingwear.lives.groove_life import groove_choice
from bearingwear.lives.life import life
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.variable import HOURS_PER_SECOND, Variable, table
from bearingwear.results.warnings import merged_warnings, warnings_in
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.cases import cases_that_wear
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.decisive import decisive_data
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.studies.answers import Tell, Workers
from bearingwear.studies.design.best import (
    EXACT_LIFE,
    NEW_BEARING,
    AnswersAt,
    PreloadLine,
    PreloadPoint,
    PreloadSearch,
)
from bearingwear.studies.design.changes import changes_dataset, choice_changes
from bearingwear.studies.design.choice import (
    ACTIVE_LIMIT,
    NO_PRELOAD,
    limits_of,
    with_choices,
)
from bearingwear.studies.design.conditions import (
    AT_SPEED_ONLY,
    CONDITIONS,
    DECIDING,
    conditions_of,
)
from bearingwear.studies.design.document.words import NO_LIMIT, NONE_BECAUSE
from bearingwear.studies.design.infeasible import least_violations, why_none
from bearingwear.studies.design.machine import MACHINE, machine_answers
from bearingwear.studies.design.map import (
    CASE_POINTS,
    MAP_AXES,
    POINT_WARNINGS,
    dataset_of_points,
    design_point,
    map_dataset,
    scenes_of_map,
    worst_cases,
)
from bearingwear.studies.design.plan import COARSE, NO_FRICTION, DesignLimits, MapAxes, axes_around
from bearingwear.studies.solve import life_scene

RECOMMENDATION = "recommendation"
RECOMMENDED_PRELOAD = Variable("preload", (), "N", "recommended initial axial preload",
    comment="rounded to three significant digits, or to more if the requirements or the life "
        "demand it"
)  # fmt: skip
LIFE_ERROR = Variable("life_error_estimate", (), "1", "estimated numerical error in the life")
BEYOND_RANGE = table(
    Variable("beyond_preload", (), "N",
        "preload far outside the range in which the recommended preload lies"),
    Variable("beyond_life", (), "h", "wear life at beyond_preload", scale=HOURS_PER_SECOND),
)  # fmt: skip
SETTABLE = table(
    Variable("least_preload", (), "N", "least preload that may be set in place of the recommended "
        "one: requirements hold, and the life is at least 90 % as long"),
    Variable("most_preload", (), "N", "most preload that may be set in place of the recommended "
        "one: requirements hold, and the life is at least 90 % as long"),
)  # fmt: skip
WORST_CASES = "worst_cases"
"""Attribute of a recommendation: for each method, the case that is the worst of each quantity."""

ATTRIBUTES = ("warnings", WORST_CASES, MACHINE)
"""What is found of a recommended preload and is no variable."""


def recommendation_of(scene: Path, design: Path) -> xr.Dataset:
    """Step: the preload to take, by the requirements that a design map was made with."""
    base, lives = life_scene(scene, films=True), load(design)
    if not is_of_scene(lives, base):
        raise CaseFileError(f"{design}: belongs to another scene")
    return recommendation(base, limits_of(lives))


def small_map(
    scene: Path, axes: Mapping[str, Any], limits: Mapping[str, Any], workers: int = 1
) -> tuple[xr.Dataset, xr.Dataset]:
    """Step: a map and the preload to take.

    axes, limits: `MapAxes` and `DesignLimits` by their names.
    """

    def tell(text: str) -> None:
        print(f"{scene.stem}: {text}", file=sys.stderr)

    base, required = life_scene(scene, films=True), DesignLimits(**limits)
    with Workers(workers, "recommend", tell) as pool:
        return (
            preload_map(base, MapAxes(**axes), required, pool.answers_at),
            recommendation(base, required, pool.answers_at, tell),
        )


def preload_map(
    scene: Scene, axes: MapAxes, limits: DesignLimits, answers_at: AnswersAt = map
) -> xr.Dataset:
    """Lives of a scene over the axes of a map, and the best preload of each line of it."""
    scenes = scenes_of_map(scene, axes.values)
    lives = answers_at(partial(design_point, limits=limits), scenes)
    design = map_dataset(scene, axes.values, limits, list(lives))
    return with_choices(design.assign_attrs(limits=json.dumps(limits.stored)))


def recommended(
    scene: Scene,
    limits: DesignLimits,
    source: str = "scene",
    workers: int = 1,
    tell: Tell | None = None,
) -> tuple[xr.Dataset, xr.Dataset | None]:
    """The preload to take at the scene's own friction and speed and, where no requirement is given,
    lives over preload beside it.

    source: what error messages name.
    tell: given a line of text now and then.
    """
    limits.check(scene, source)
    if scene.operation.preload_N <= 0.0:
        problem = f"got {scene.operation.preload_N:g}, expected a number > 0 to search around"
        raise SceneError("operation.preload_N", problem, source=source)
    with Workers(workers, "recommend", progress=False) as pool:
        found = recommendation(scene, limits, pool.answers_at, tell)
        if limits.given:
            return found, None
        mu = NO_FRICTION if scene.friction.film else scene.friction.coefficient
        axes = axes_around(scene, [mu], source, COARSE)
        return found, preload_map(scene, axes, limits, pool.answers_at)


def recommendation(
    scene: Scene, limits: DesignLimits, answers_at: AnswersAt = map, tell: Tell | None = None
) -> xr.Dataset:
    """The preload to take by each method, and what would change the choice between them.

    Lives, at the preloads that are named, are those that `life` prints. Without a requirement no
    preload is recommended.

    tell: given a line of text now and then.
    """
    tell = tell or (lambda text: None)
    search = PreloadSearch(scene, limits, answers_at)
    best: list[PreloadPoint | None] = [None] * len(search.lines)
    if limits.given:
        tell("lives over preload")
        search.run()
        best = [line.best(limits) for line in search.lines]
    rows, none = [], {}
    for line, one in zip(search.lines, best, strict=True):
        if one is None:
            rows.append({"active_limit": NO_PRELOAD, "status": -1})
            none[line.method] = none_because(search, line) if limits.given else NO_LIMIT
        else:
            rows.append(_row(search, line, one))
    taken = [
        (held_by(scene, line.method, one.preload), one.values)
        for line, one in zip(search.lines, best, strict=True)
        if one is not None
    ]
    if taken:
        tell("what would change the choice")
    printed = iter([*answers_at(_printed, taken)])
    changes = changes_dataset(choice_changes(search, best))
    for row, one in zip(rows, best, strict=True):
        row |= {} if one is None else next(printed)
    return _dataset(scene, limits, rows, none).merge(changes, combine_attrs="override")


def none_because(search: PreloadSearch, line: PreloadLine) -> str:
    """Why no preload of a line is allowed, and how near one comes; by exact lives where it counts.

    A preload at which new bearings break a requirement stands with what these reach.
    """
    limits = search.limits
    for _ in line.grid:
        order = line.points(limits)
        failed, _ = least_violations(order, limits)
        named = [order[k] for k in set(failed.values())]
        rough = [one.preload for one in named if one.solved not in (NEW_BEARING, EXACT_LIFE)]
        if not rough:
            break
        search.solve(lambda other, rough=rough: rough if other is line else [], EXACT_LIFE)  # type: ignore[misc]
    return why_none(line.points(limits), limits, bool(search.scene.cases))


def _row(search: PreloadSearch, line: PreloadLine, best: PreloadPoint) -> dict[str, Any]:
    """A recommended preload, what holds it, and where it may be set."""
    row = dict(best.values) | {
        "preload": best.preload,
        "active_limit": search.active_limit(line, best),
    }
    similar = search.settable_points(line)
    if similar[0].solved == similar[-1].solved == EXACT_LIFE:
        row |= {"least_preload": similar[0].preload, "most_preload": similar[-1].preload}
    if one := line.beyond:
        row |= {"beyond_preload": one.preload, "beyond_life": one.life}
    return row


def _printed(taken: tuple[Scene, Mapping[str, Any]]) -> dict[str, Any]:
    """What stands beside a recommended preload, of a scene and what was found of it."""
    scene, point = taken
    return {**_as_printed(scene, point), MACHINE: machine_answers(scene)}


def _as_printed(scene: Scene, point: Mapping[str, Any]) -> dict[str, Any]:
    """What `life` says beside a life of the map: its numerical error, and the warnings.

    Of several cases the largest error, the warnings of all, and which is the worst.
    """
    if scene.duty is not None:
        answer = life(scene)
        error = answer.values.get("life_error_estimate", math.nan)
        kept = {"life_error_estimate": error, "warnings": answer.attrs["warnings"]}
        return kept | ({WORST_CASES: worst_cases(point)} if scene.cases else {})
    if scene.cases:
        points = point[CASE_POINTS]
        parts = {name: _as_printed(one, points[name]) for name, one in scene.in_cases.items()}
        errors = [parts[name]["life_error_estimate"] for name in cases_that_wear(scene)]
        return {
            "life_error_estimate": max(errors),
            "warnings": _with_cases(merged_warnings(parts.values()), parts),
            WORST_CASES: worst_cases(point),
        }
    grooves = groove_choice(scene, "steady").scene
    if grooves is not None and POINT_WARNINGS in point:
        found = groove_errors(grooves, float(point["life"]), int(point["end_criterion"]))
        error = found.get("life_error_estimate", math.nan)
        return {"life_error_estimate": error, POINT_WARNINGS: point[POINT_WARNINGS]}
    answer = life(scene)
    error = answer.values.get("life_error_estimate", math.nan)
    return {"life_error_estimate": error, "warnings": answer.attrs["warnings"]}


def _with_cases(gathered: str, parts: Mapping[str, Mapping[str, Any]]) -> str:
    """Warnings of all cases, each with the names of those in which it stands."""
    found = json.loads(gathered)
    for one in found:
        one["in_cases"] = [
            name
            for name, part in parts.items()
            if any(one["id"] == other["id"] for other in warnings_in(part))
        ]
    return json.dumps(found)


def _dataset(
    scene: Scene,
    limits: DesignLimits,
    rows: Sequence[dict[str, Any]],
    none: Mapping[str, str],
) -> xr.Dataset:
    more = table(
        RECOMMENDED_PRELOAD, ACTIVE_LIMIT, LIFE_ERROR, *BEYOND_RANGE.values(), *SETTABLE.values()
    )
    flags = [PRELOAD_METHODS.index(method) for method in PRELOAD_METHODS]
    known = [{name: row[name] for name in row if name not in ATTRIBUTES} for row in rows]
    axes = {MAP_AXES["preload_method"]: flags}
    made = dataset_of_points(
        axes,
        known,
        more,
        title="Recommended preload",
        kind=RECOMMENDATION,
        scene=scene,
        limits=json.dumps(limits.stored),
    )
    made["status"].attrs["missing"] = "-1: nothing to solve"
    made.attrs["warnings"] = merged_warnings({"warnings": r.get("warnings", "[]")} for r in rows)
    if any(row.get(MACHINE) for row in rows):
        made.attrs[MACHINE] = json.dumps([row.get(MACHINE, {}) for row in rows])
    if scene.cases:
        made.attrs[WORST_CASES] = json.dumps([row.get(WORST_CASES, {}) for row in rows])
    made.attrs[DECIDING] = json.dumps([row.get(DECIDING, {}) for row in rows])
    made.attrs[CONDITIONS] = json.dumps(
        conditions_of(scene, limits.at_speed_only, limits.warmup_s is not None)
    )
    made.attrs[AT_SPEED_ONLY] = int(limits.at_speed_only)
    return made.assign_attrs({NONE_BECAUSE: json.dumps(none)} if none else {})


def is_of_scene(found: xr.Dataset, scene: Scene) -> bool:
    """Whether a file was computed for a scene: all agrees that decides a life."""
    return decisive_data(json.loads(found.attrs["scene"])) == decisive_data(scene.to_dict())


def recommended_for(scene: Scene, recommendation: xr.Dataset | None) -> xr.Dataset:
    """The same, if it is the recommendation of this scene.

    CaseFileError: where it is not.
    """
    if recommendation is None or recommendation.attrs.get("kind") != RECOMMENDATION:
        raise CaseFileError("the recommended preload requires a recommendation file")
    if not is_of_scene(recommendation, scene):
        raise CaseFileError("the recommendation belongs to another scene")
    return recommendation


def best_method(recommendation: xr.Dataset) -> int | None:
    """Number of the method with the longest recommended life; None if no preload is allowed."""
    lives = recommendation["life"].values
    return int(np.nanargmax(lives)) if np.isfinite(lives).any() else None
