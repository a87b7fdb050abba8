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
from bearingwear.results.words import plain_scene
from bearingwear.scene.arrangement import with_method
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
from bearingwear.studies.design.infeasible import (
    infeasibility_text,
    least_violations,
    short_life_text,
)
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
    """Step: returns the recommendation for a scene by the requirements of its design map.

    design: file of the map. A CaseFileError is raised if it belongs to another scene.
    """
    base = life_scene(scene, films=True)
    lives = load(design)
    if not is_of_scene(lives, base):
        raise CaseFileError(f"{design}: belongs to another scene")
    return recommendation(base, limits_of(lives))


def small_map(
    scene: Path, axes: Mapping[str, Any], limits: Mapping[str, Any], workers: int = 1
) -> tuple[xr.Dataset, xr.Dataset]:
    """Step: returns a design map of a scene, and its recommendation.

    Lines of progress go to stderr.

    axes: fields of `MapAxes`.
    limits: fields of `DesignLimits`.
    workers: number of processes that solve lives.
    """

    def tell(text: str) -> None:
        """Writes a line of progress, which begins with the name of the scene's file."""
        print(f"{scene.stem}: {text}", file=sys.stderr)

    base = life_scene(scene, films=True)
    requirements = DesignLimits(**limits)
    with Workers(workers, "recommend", tell) as pool:
        return (
            preload_map(base, MapAxes(**axes), requirements, pool.answers_at),
            recommendation(base, requirements, pool.answers_at, tell),
        )


def preload_map(
    scene: Scene, axes: MapAxes, limits: DesignLimits, answers_at: AnswersAt = map
) -> xr.Dataset:
    """Returns the map of a scene over some axes, with the best preload of each line of it.

    answers_at: evaluates a function at points: `map` or `Workers.answers_at`.
    """
    scenes = scenes_of_map(scene, axes.values)
    points = answers_at(partial(design_point, limits=limits), scenes)
    design = map_dataset(scene, axes.values, limits, list(points))
    return with_choices(design.assign_attrs(limits=json.dumps(limits.stored)))


def recommendation_and_map(
    scene: Scene,
    limits: DesignLimits,
    source: str = "scene",
    workers: int = 1,
    tell: Tell | None = None,
) -> tuple[xr.Dataset, xr.Dataset | None]:
    """Returns the recommendation at the scene's own friction and speed, and a map or None.

    The map contains lives over preload, for a choice by hand. It is None if any requirement is
    given.

    source: file of the scene, for errors.
    workers: number of processes that solve lives.
    tell: takes lines of progress.
    SceneError: a preload of zero, or a requirement that needs more of the scene.
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
    """Returns the recommended preload of each method, and what would change the choice.

    The dataset has the variables of `POINT` at the recommended preload and those of
    `_recommendation_dataset` over `preload_method`, and those of `CHANGES` over `change`. Lives at
    the preloads in it are exact. Without a requirement, no preload is recommended. A method without
    a preload has NaN, the status -1, and a reason in the attribute `NONE_BECAUSE`.

    answers_at: evaluates a function at points: `map` or `Workers.answers_at`.
    tell: takes lines of progress.
    """
    tell = tell or (lambda text: None)
    search = PreloadSearch(scene, limits, answers_at)
    best: list[PreloadPoint | None] = [None] * len(search.lines)
    if limits.given:
        tell("lives over preload")
        search.run()
        best = [line.best(limits) for line in search.lines]
    rows: list[dict[str, Any]] = []
    rows_with_preload: list[dict[str, Any]] = []
    chosen: list[_ChosenPreload] = []
    reasons: dict[str, str] = {}
    for line, point in zip(search.lines, best, strict=True):
        if point is None:
            rows.append({"active_limit": NO_PRELOAD, "status": -1})
            reasons[line.method] = no_preload_reason(search, line) if limits.given else NO_LIMIT
            longest = line.best(search.other_limits)  # without a requirement no life is solved
            if longest:
                rows[-1] |= {"longest_preload": longest.preload, "longest_life": longest.life}
        else:
            rows.append(_recommended_values(search, line, point))
            rows_with_preload.append(rows[-1])
            held = with_method(scene, line.method, point.preload)
            chosen.append(_ChosenPreload(held, point.values))
    if chosen:
        tell("what would change the choice")
    answers = list(answers_at(_chosen_answers, chosen))
    changes = changes_dataset(choice_changes(search, best))
    for row, answer in zip(rows_with_preload, answers, strict=True):
        row.update(answer)
    dataset = _recommendation_dataset(scene, limits, rows, reasons)
    return dataset.merge(changes, combine_attrs="override")


def no_preload_reason(search: PreloadSearch, line: PreloadLine) -> str:
    """Returns the reason why no preload of a line is allowed, and how near one comes, as text.

    Before that, quick lives at the preloads in the text are replaced in the line by exact ones.

    line: of the search, without an allowed preload.
    """
    limits = search.other_limits
    if longest := line.best(limits):
        active = ACTIVE[search.active_limit(line, longest)]
        return short_life_text(longest, active, search.limits)

    def nearest_quick_preloads(other: PreloadLine) -> list[float]:
        """Returns the preloads [N] of the line that are nearly allowed by quick lives."""
        points = line.points(limits) if other is line else []
        violations, _ = least_violations(points, limits)
        nearest = [points[k] for k in set(violations.values())]
        return [point.preload for point in nearest if point.solved == QUICK_LIFE]

    for _ in line.grid:  # at most as often as there are preloads
        if not search.solve(nearest_quick_preloads, EXACT_LIFE):
            break
    return infeasibility_text(line.points(limits), limits, bool(search.scene.cases))


def _recommended_values(
    search: PreloadSearch, line: PreloadLine, best: PreloadPoint
) -> dict[str, Any]:
    """Returns the values of a recommended preload by the names of variables.

    They are those of its design point, the preload, its active limit, the range of preloads that
    may be set in its place, and a preload far outside the range of the search with a longer life.
    The range is left out unless the lives at its ends are exact.

    best: the recommended point of the line.
    """
    values = dict(best.values) | {
        "preload": best.preload,
        "active_limit": search.active_limit(line, best),
    }
    settable = search.settable_points(line)
    lowest, highest = settable[0], settable[-1]
    if lowest.solved == highest.solved == EXACT_LIFE:
        values |= {"least_preload": lowest.preload, "most_preload": highest.preload}
    beyond = line.best_beyond_end
    if beyond is not None:
        values |= {"beyond_preload": beyond.preload, "beyond_life": beyond.life}
    return values


class _ChosenPreload(NamedTuple):
    """A scene at its recommended preload, and its design point."""

    scene: Scene
    point: Mapping[str, Any]


def _chosen_answers(chosen: _ChosenPreload) -> dict[str, Any]:
    """Returns the values of `_life_answers` and, by the key `MACHINE`, of `machine_answers`."""
    return _life_answers(chosen.scene, chosen.point) | {MACHINE: machine_answers(chosen.scene)}


def _life_answers(scene: Scene, point: Mapping[str, Any]) -> dict[str, Any]:
    """Returns `life_error_estimate`, `warnings` as JSON and, of several cases, `worst_cases`.

    Over several cases, the error is the largest one, and each warning names its cases. The error is
    relative [1], and NaN where there is no estimate.

    point: design point of the scene.
    """
    worst = {WORST_CASES: worst_cases(point)} if scene.cases else {}
    if scene.cases and scene.duty is None:
        points = point[CASE_POINTS]
        answers = {name: _life_answers(case, points[name]) for name, case in scene.in_cases.items()}
        errors = [answers[name]["life_error_estimate"] for name in cases_that_wear(scene)]
        warnings = _warnings_with_cases(answers)
        return {"life_error_estimate": max(errors), "warnings": warnings, **worst}
    groove_scene = groove_choice(scene, "steady").scene if scene.duty is None else None
    if groove_scene is not None and POINT_WARNINGS in point:
        values = groove_errors(groove_scene, float(point["life"]), int(point["end_criterion"]))
        warnings = point[POINT_WARNINGS]
    else:
        result = life(scene)
        values = result.values
        warnings = result.attrs["warnings"]
    error = values.get("life_error_estimate", math.nan)
    return {"life_error_estimate": error, "warnings": warnings, **worst}


def _warnings_with_cases(answers: Mapping[str, Mapping[str, Any]]) -> str:
    """Returns the warnings of all cases as JSON, each with the names of its cases as `in_cases`.

    answers: of `_life_answers`, by the names of cases.
    """
    warnings = json.loads(merged_warnings(answers.values()))
    for warning in warnings:
        warning["in_cases"] = [
            name
            for name, answer in answers.items()
            if any(warning["id"] == other["id"] for other in warnings_in(answer))
        ]
    return json.dumps(warnings)


def _recommendation_dataset(
    scene: Scene,
    limits: DesignLimits,
    rows: Sequence[dict[str, Any]],
    reasons: Mapping[str, str],
) -> xr.Dataset:
    """Returns a recommendation over `preload_method`, without `CHANGES`.

    Its attributes contain as JSON what is no variable: warnings, worst cases, deciding conditions,
    all conditions of the requirements, what the machine requires, and the reasons.

    rows: values of variables and of `ATTRIBUTES` for each of `PRELOAD_METHODS`.
    reasons: texts on why no preload is recommended, by the methods without one.
    """
    variables = table(
        RECOMMENDED_PRELOAD,
        ACTIVE_LIMIT,
        LIFE_ERROR,
        *BEYOND_RANGE.values(),
        *SETTABLE.values(),
        *TOO_SHORT.values(),
    )
    dataset = dataset_of_points(
        {MAP_AXES["preload_method"]: range(len(PRELOAD_METHODS))},
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
    """Returns whether a dataset is of a scene, by the values that determine a life."""
    return decisive_data(plain_scene(dataset)) == decisive_data(scene.to_dict())


def recommended_for(scene: Scene, recommendation: xr.Dataset | None) -> xr.Dataset:
    """Returns a recommendation unchanged; raises a CaseFileError if it is none for the scene."""
    if recommendation is None or recommendation.attrs.get("kind") != RECOMMENDATION:
        raise CaseFileError("the recommended preload requires a recommendation file")
    if not is_of_scene(recommendation, scene):
        raise CaseFileError("the recommendation belongs to another scene")
    return recommendation


def best_method(recommendation: xr.Dataset) -> int | None:
    """Returns the index of the method with the longest life; None if no preload is allowed."""
    lives = recommendation["life"].values
    return int(np.nanargmax(lives)) if np.isfinite(lives).any() else None
