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
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.lives.errors import groove_errors
from bearingwear.lives.groove_life import groove_choice
from bearingwear.lives.life import life
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.variable import HOURS_PER_SECOND, Variable, table
from bearingwear.results.warnings import merged_warnings, warnings_in
from bearingwear.results.words import scene_of
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.cases import cases_that_wear
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.decisive import decisive_data
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.studies.answers import Tell, Workers
from bearingwear.studies.design.best import (
    EXACT_LIFE,
    QUICK_LIFE,
    AnswersAt,
    PreloadLine,
    PreloadPoint,
    PreloadSearch,
)
from bearingwear.studies.design.changes import changes_dataset, choice_changes
from bearingwear.studies.design.choice import (
    ACTIVE,
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
from bearingwear.studies.design.infeasible import least_violations, life_too_short, why_none
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
TOO_SHORT = table(
    Variable("longest_preload", (), "N", "preload with the longest life within all requirements "
        "but that on the life, which is too short there"),
    Variable("longest_life", (), "h", "wear life at longest_preload", scale=HOURS_PER_SECOND),
)  # fmt: skip
WORST_CASES = "worst_cases"
"""Attribute of a recommendation: for each method, the case that is the worst of each quantity."""

ATTRIBUTES = ("warnings", WORST_CASES, MACHINE)
"""Keys of a recommended preload that are no variables of a file."""


def recommendation_of(scene: Path, design: Path) -> xr.Dataset:
    """Step: returns the preload to take by the requirements of a design map."""
    base, lives = life_scene(scene, films=True), load(design)
    if not is_of_scene(lives, base):
        raise CaseFileError(f"{design}: belongs to another scene")
    return recommendation(base, limits_of(lives))


def small_map(
    scene: Path, axes: Mapping[str, Any], limits: Mapping[str, Any], workers: int = 1
) -> tuple[xr.Dataset, xr.Dataset]:
    """Step: returns a map and the preload to take.

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
    """Returns the map of a scene over some axes, with the best preload of each line of it."""
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
    """Returns the preload to take at the scene's own friction and speed, and a map or None.

    The map contains lives over preload, for a choice where no requirement is given.

    source: what error messages name.
    tell: given a line of text now and then.
    """
    limits.check(scene, source)
    if scene.operation.preload_N <= 0.0:
        problem = f"got {scene.operation.preload_N:g}, expected a number > 0 to search around"
        raise SceneError("operation.preload_N", problem, source=source)
    with Workers(workers, "recommend", progress=False) as pool:
        dataset = recommendation(scene, limits, pool.answers_at, tell)
        if limits.given:
            return dataset, None
        mu = NO_FRICTION if scene.friction.film else scene.friction.coefficient
        axes = axes_around(scene, [mu], source, COARSE)
        return dataset, preload_map(scene, axes, limits, pool.answers_at)


def recommendation(
    scene: Scene, limits: DesignLimits, answers_at: AnswersAt = map, tell: Tell | None = None
) -> xr.Dataset:
    """Returns the preload to take by each method, and what would change the choice between them.

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
    rows: list[dict[str, Any]] = []
    chosen: list[_ChosenPreload] = []
    reasons: dict[str, str] = {}
    for line, point in zip(search.lines, best, strict=True):
        if point is None:
            rows.append({"active_limit": NO_PRELOAD, "status": -1})
            reasons[line.method] = no_preload_reason(search, line) if limits.given else NO_LIMIT
            if limits.given and (longest := line.best(search.but_life)):
                rows[-1] |= {"longest_preload": longest.preload, "longest_life": longest.life}
        else:
            rows.append(_row(search, line, point))
            held = held_by(scene, line.method, point.preload)
            chosen.append(_ChosenPreload(held, point.values))
    if chosen:
        tell("what would change the choice")
    answers = iter([*answers_at(_chosen_answers, chosen)])
    changes = changes_dataset(choice_changes(search, best))
    for row, point in zip(rows, best, strict=True):
        row |= {} if point is None else next(answers)
    return _dataset(scene, limits, rows, reasons).merge(changes, combine_attrs="override")


def no_preload_reason(search: PreloadSearch, line: PreloadLine) -> str:
    """Returns why no preload of a line is allowed, and how near one comes.

    The preloads that it names have exact lives; those at which new bearings break a requirement
    stand with the values of these.
    """
    limits = search.but_life
    if longest := line.best(limits):
        active = ACTIVE[search.active_limit(line, longest)]
        return life_too_short(longest, active, search.limits)

    def rough_preloads(other: PreloadLine) -> list[float]:
        """Returns preloads that the reason would name by quick lives."""
        points = line.points(limits) if other is line else []
        violations, _ = least_violations(points, limits)
        nearest = [points[k] for k in set(violations.values())]
        return [point.preload for point in nearest if point.solved == QUICK_LIFE]

    for _ in line.grid:
        if not search.solve(rough_preloads, EXACT_LIFE):
            break
    return why_none(line.points(limits), limits, bool(search.scene.cases))


def _row(search: PreloadSearch, line: PreloadLine, best: PreloadPoint) -> dict[str, Any]:
    """Returns the values of a recommended preload, what holds it, and where it may be set."""
    row = dict(best.values) | {
        "preload": best.preload,
        "active_limit": search.active_limit(line, best),
    }
    settable = search.settable_points(line)
    if settable[0].solved == settable[-1].solved == EXACT_LIFE:
        row |= {"least_preload": settable[0].preload, "most_preload": settable[-1].preload}
    if beyond := line.best_beyond_end:
        row |= {"beyond_preload": beyond.preload, "beyond_life": beyond.life}
    return row


class _ChosenPreload(NamedTuple):
    """A scene at its recommended preload, and its design point."""

    scene: Scene
    point: Mapping[str, Any]


def _chosen_answers(chosen: _ChosenPreload) -> dict[str, Any]:
    """Returns what stands beside a recommended preload: errors, warnings, and the machine's."""
    return _life_answers(chosen.scene, chosen.point) | {MACHINE: machine_answers(chosen.scene)}


def _life_answers(scene: Scene, point: Mapping[str, Any]) -> dict[str, Any]:
    """Returns what `life` says beside the life of a point: its numerical error, and the warnings.

    Of several cases: the largest error, the warnings of all, and which is the worst.
    """
    worst = {WORST_CASES: worst_cases(point)} if scene.cases else {}
    if scene.cases and scene.duty is None:
        points = point[CASE_POINTS]
        answers = {name: _life_answers(case, points[name]) for name, case in scene.in_cases.items()}
        errors = [answers[name]["life_error_estimate"] for name in cases_that_wear(scene)]
        warnings = _warnings_with_cases(answers)
        return {"life_error_estimate": max(errors), "warnings": warnings, **worst}
    grooves = groove_choice(scene, "steady").scene if scene.duty is None else None
    if grooves is not None and POINT_WARNINGS in point:
        values = groove_errors(grooves, float(point["life"]), int(point["end_criterion"]))
        warnings = point[POINT_WARNINGS]
    else:
        answer = life(scene)
        values, warnings = answer.values, answer.attrs["warnings"]
    error = values.get("life_error_estimate", math.nan)
    return {"life_error_estimate": error, "warnings": warnings, **worst}


def _warnings_with_cases(answers: Mapping[str, Mapping[str, Any]]) -> str:
    """Returns the warnings of all cases as JSON, each with the names of its cases."""
    warnings = json.loads(merged_warnings(answers.values()))
    for warning in warnings:
        warning["in_cases"] = [
            name
            for name, answer in answers.items()
            if any(warning["id"] == other["id"] for other in warnings_in(answer))
        ]
    return json.dumps(warnings)


def _dataset(
    scene: Scene,
    limits: DesignLimits,
    rows: Sequence[dict[str, Any]],
    reasons: Mapping[str, str],
) -> xr.Dataset:
    """Returns a recommendation from its rows, one for each method.

    reasons: why no preload is recommended, by the methods without one.
    """
    variables = table(
        RECOMMENDED_PRELOAD,
        ACTIVE_LIMIT,
        LIFE_ERROR,
        *BEYOND_RANGE.values(),
        *SETTABLE.values(),
        *TOO_SHORT.values(),
    )
    flags = [PRELOAD_METHODS.index(method) for method in PRELOAD_METHODS]
    dataset = dataset_of_points(
        {MAP_AXES["preload_method"]: flags},
        [{name: row[name] for name in row if name not in ATTRIBUTES} for row in rows],
        variables,
        title="Recommended preload",
        kind=RECOMMENDATION,
        scene=scene,
        limits=json.dumps(limits.stored),
    )
    dataset["status"].attrs["missing"] = "-1: nothing to solve"
    attributes = dataset.attrs
    attributes["warnings"] = merged_warnings({"warnings": r.get("warnings", "[]")} for r in rows)
    if any(row.get(MACHINE) for row in rows):
        attributes[MACHINE] = json.dumps([row.get(MACHINE, {}) for row in rows])
    if scene.cases:
        attributes[WORST_CASES] = json.dumps([row.get(WORST_CASES, {}) for row in rows])
    attributes[DECIDING] = json.dumps([row.get(DECIDING, {}) for row in rows])
    attributes[CONDITIONS] = json.dumps(
        conditions_of(scene, limits.at_speed_only, limits.warmup_s is not None)
    )
    attributes[AT_SPEED_ONLY] = int(limits.at_speed_only)
    return dataset.assign_attrs({NONE_BECAUSE: json.dumps(reasons)} if reasons else {})


def is_of_scene(dataset: xr.Dataset, scene: Scene) -> bool:
    """Whether a file was computed for a scene: all agrees that decides a life."""
    return decisive_data(scene_of(dataset)) == decisive_data(scene.to_dict())


def recommended_for(scene: Scene, recommendation: xr.Dataset | None) -> xr.Dataset:
    """Returns a dataset that is the recommendation of this scene.

    Raises CaseFileError where it is not.
    """
    if recommendation is None or recommendation.attrs.get("kind") != RECOMMENDATION:
        raise CaseFileError("the recommended preload requires a recommendation file")
    if not is_of_scene(recommendation, scene):
        raise CaseFileError("the recommendation belongs to another scene")
    return recommendation


def best_method(recommendation: xr.Dataset) -> int | None:
    """Returns the number of the method with the longest life; None if no preload is allowed."""
    lives = recommendation["life"].values
    return int(np.nanargmax(lives)) if np.isfinite(lives).any() else None
