"""Where requirements hold and where they decide, in words."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.document.bearing_line import (
    scenes_by_case,
    warning_with_cases,
    worst_case_phrase,
)
from bearingwear.measures import LIMITED
from bearingwear.results.units import printed_unit
from bearingwear.results.warnings import warnings_in
from bearingwear.results.words import plain_scene
from bearingwear.studies.design.choice import ACTIVE, limits_of
from bearingwear.studies.design.conditions import (
    AT_END_OF_LIFE,
    BETWEEN,
    DECIDING,
    MOUNTING,
    NEW,
    WARMING,
    condition_words,
    speed_words,
    warm_up_time_words,
)

_JUST_MET = 0.01
"""Relative margin below which a requirement counts as just met."""

_OVER_DUTY = "over the duty"

_WEAR_WORDS = {NEW: "new", AT_END_OF_LIFE: "worn", BETWEEN: "during the life"}
"""States of wear in tables and at a launch, which may precede the end of life."""


def _speed_and_warm_up_words(dataset: xr.Dataset) -> str:
    """Returns the speeds at which the requirements of a file apply, and whether in a warm-up."""
    words = _speed_range_words(dataset)
    seconds = limits_of(dataset).warmup_s
    if seconds is None:
        return words
    words += " and during the warm-up"
    return f"{words} with a {seconds:g} s ramp" if seconds else words


def _speed_range_words(dataset: xr.Dataset) -> str:
    """Returns the speeds at which requirements apply in words, such as "from rest to 9000 r/min".

    The range is over all cases of the scene.
    """
    operations = [case["operation"] for case in scenes_by_case(plain_scene(dataset)).values()]
    speeds = [
        abs(operation["shaft_speed_rpm"]) or abs(operation.get("outer_speed_rpm") or 0.0)
        for operation in operations
    ]
    lowest, highest = min(speeds), max(speeds)
    if limits_of(dataset).at_speed_only:
        if lowest == highest:
            return f"at {highest:g} r/min only"
        return f"at {lowest:g} to {highest:g} r/min only"
    lowest_speeds = [operation.get("lowest_speed_rpm") or 0.0 for operation in operations]
    lowest = min(*lowest_speeds, highest)
    if lowest == highest:
        return f"at {highest:g} r/min" if highest else "at rest"
    start = f"{lowest:g}" if lowest else "rest"
    return f"from {start} to {highest:g} r/min"


def conditions_words(dataset: xr.Dataset) -> str:
    """Returns cases and speeds, as "worst of 2: nominal, fast; from rest to 9000 r/min"."""
    cases = scenes_by_case(plain_scene(dataset))
    phrases = [worst_case_phrase(cases)] if len(cases) > 1 else []
    return "; ".join([*phrases, _speed_and_warm_up_words(dataset)])


def extent_words(dataset: xr.Dataset) -> str:
    """Returns in words the speeds, cases and wear over which values of a file are the worst."""
    cases = scenes_by_case(plain_scene(dataset))
    case_words = f" in {len(cases)} cases" if len(cases) > 1 else ""
    return f"{_speed_and_warm_up_words(dataset)}{case_words}, from new to the end of life"


def deciding_by_method(recommendation: xr.Dataset) -> list[Mapping[str, Any]]:
    """Returns for each method the condition in which each quantity is the worst, by its name.

    The mappings are empty if the file lacks the conditions.
    """
    deciding: list[Mapping[str, Any]] = json.loads(recommendation.attrs.get(DECIDING, "[]"))
    return deciding or [{} for _ in range(recommendation.sizes.get("preload_method", 1))]


def worst_condition(
    recommendation: xr.Dataset, point: xr.Dataset, quantity: str
) -> Mapping[str, Any] | None:
    """Returns the condition in which a quantity of one method is the worst; None if not known.

    point: recommendation of the method.
    quantity: name of an extreme, or "life".
    """
    methods = recommendation["preload_method"].values.tolist()
    deciding = deciding_by_method(recommendation)[methods.index(int(point["preload_method"]))]
    return deciding.get(quantity)


def critical_extreme(point: xr.Dataset, name: str) -> str:
    """Returns the name of the extreme that decides a limit at a point.

    point: recommendation of a method.
    name: key of the limit in `LIMITED`.
    """
    _, extreme = LIMITED[name].critical_extreme(lambda extreme: float(point[extreme]))
    return extreme


def critical_condition_words(recommendation: xr.Dataset, point: xr.Dataset, name: str) -> str:
    """Returns the condition in which a limited measure is the worst, in words; empty if not known.

    point: recommendation of a method.
    name: key of the limit in `LIMITED`.
    """
    return extreme_condition_words(recommendation, point, critical_extreme(point, name))


def extreme_condition_words(recommendation: xr.Dataset, point: xr.Dataset, extreme: str) -> str:
    """Returns the condition in which an extreme is the worst, in words; empty if not known.

    An example is "at 3000 r/min, at the end of life".

    point: recommendation of a method.
    """
    where = worst_condition(recommendation, point, extreme)
    if where is None or not np.isfinite(where["value"]):
        return ""
    has_cases = _has_cases(recommendation)
    if not _is_resting(extreme):
        return condition_words(where, has_cases)
    wear_words = _WEAR_WORDS.get(where.get("wear", ""))
    words = [wear_words] if wear_words else []
    if has_cases:
        words.append(f"case {where['case']}")
    return ", ".join(words)


def brief_condition_words(recommendation: xr.Dataset, point: xr.Dataset, extreme: str) -> str:
    """Returns the condition in which an extreme is the worst for a table; empty if not known.

    An example is "3000 r/min, worn".

    point: recommendation of a method.
    """
    where = worst_condition(recommendation, point, extreme)
    if where is None or not np.isfinite(where["value"]):
        return ""
    words = [where["case"]] if _has_cases(recommendation) else []
    if not _is_resting(extreme):
        words.append(speed_words(where["speed_rpm"]) if where["speed_rpm"] else "at rest")
        if where["temperature"] == MOUNTING:
            words.append("mounting temperature")
        if where["temperature"] == WARMING:
            words.append(f"{warm_up_time_words(where)} into the warm-up")
    wear_words = _WEAR_WORDS.get(where.get("wear", ""))
    if wear_words:
        words.append(wear_words)
    if where.get("bearing") and not _is_resting(extreme):
        words.append(f"bearing {where['bearing']}")
    return ", ".join(words)


def _has_cases(dataset: xr.Dataset) -> bool:
    """Returns whether the scene of a file has cases beside the nominal one."""
    return bool(plain_scene(dataset).get("cases"))


def _is_resting(extreme: str) -> bool:
    """Returns whether an extreme is of a measure that is computed at rest."""
    return any(measure.resting and extreme in measure.extremes for measure in LIMITED.values())


def life_condition_words(recommendation: xr.Dataset, point: xr.Dataset) -> str:
    """Returns the speed of a method's life in words, and its case if there are several.

    The words are "over the duty" for a scene with a duty, and empty if the condition is not known.

    point: recommendation of a method.
    """
    if plain_scene(recommendation).get("duty"):
        return _OVER_DUTY
    where = worst_condition(recommendation, point, "life")
    if where is None:
        return ""
    words = condition_words({**where, "wear": ""})
    cases = len(scenes_by_case(plain_scene(recommendation)))
    return f"{words} (case {where['case']}, the shortest of {cases})" if cases > 1 else words


def lives_condition_words(dataset: xr.Dataset) -> str:
    """Returns the condition of the lives of a map or a recommendation: speed, case or duty."""
    scene = plain_scene(dataset)
    if scene.get("duty"):
        return _OVER_DUTY
    if scene.get("cases"):
        return "of the case with the shortest life"
    return f"at {scene['operation']['shaft_speed_rpm']:g} r/min"


def limit_met_words(recommendation: xr.Dataset, point: xr.Dataset) -> str:
    """Returns what limits a recommended preload, as "20 N/µm is just met at 3000 r/min, new".

    The text is empty if the active limit is no requirement.

    point: recommendation of a method.
    """
    name = ACTIVE[int(point["active_limit"])]
    limits = limits_of(recommendation)
    if name not in limits.effective:
        return ""
    where = critical_condition_words(recommendation, point, name)
    if where:
        where = f" {where}" if where.startswith(("at ", "during ")) else f" ({where})"
    if name not in limits.given:
        return f"below that, a bearing lifts off{where}"
    measure = LIMITED[name]
    limit = limits.given[name]
    text = f"{measure.shown_limit(limit):g} {printed_unit(measure.unit)}"
    if float(measure.margins(point, limit)) < _JUST_MET:
        return f"{text} is just met{where}"
    return f"limited by {text}{where}"


def stated_warnings(recommendation: xr.Dataset) -> list[dict[str, Any]]:
    """Returns the warnings of a recommendation, each with the names of the cases that have it."""
    scene = plain_scene(recommendation)
    return [
        warning_with_cases(warning, scene, warning.get("in_cases", ()))
        for warning in warnings_in(recommendation.attrs)
    ]
