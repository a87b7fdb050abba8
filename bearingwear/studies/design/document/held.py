"""Where requirements hold and where they decide, in words."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.document.bearing_line import (
    is_answered_by_a_case,
    scenes_by_case,
    worst_case_phrase,
)
from bearingwear.measures import LIMITED
from bearingwear.results.units import printed_unit
from bearingwear.results.warnings import warnings_in
from bearingwear.results.words import scene_of
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
)

_JUST_MET = 0.01
"""Margin of a requirement, over it, that is as good as none."""


def range_words(dataset: xr.Dataset) -> str:
    """Speeds at which the requirements of a map or recommendation were looked at, and a warm-up."""
    words, seconds = _speed_range_words(dataset), limits_of(dataset).warmup_s
    if seconds is None:
        return words
    return f"{words} and during the warm-up{f' with a {seconds:g} s ramp' if seconds else ''}"


def _speed_range_words(dataset: xr.Dataset) -> str:
    each = [one["operation"] for one in scenes_by_case(scene_of(dataset)).values()]
    speeds = [abs(one["shaft_speed_rpm"]) or abs(one.get("outer_speed_rpm") or 0.0) for one in each]
    highest, lowest = max(speeds), min(speeds)
    if limits_of(dataset).at_speed_only:
        return f"at {'' if lowest == highest else f'{lowest:g} to '}{highest:g} r/min only"
    lowest = min(min(one.get("lowest_speed_rpm") or 0.0, highest) for one in each)
    if lowest == highest:
        return f"at {highest:g} r/min" if highest else "at rest"
    return f"from {f'{lowest:g}' if lowest else 'rest'} to {highest:g} r/min"


def conditions_words(dataset: xr.Dataset) -> str:
    """Cases and speeds of a map or recommendation: `worst of 2: nominal, fast; from rest to 9`."""
    cases = scenes_by_case(scene_of(dataset))
    return "; ".join(
        [*([worst_case_phrase(cases)] if len(cases) > 1 else []), range_words(dataset)]
    )


def worst_words(dataset: xr.Dataset) -> str:
    """The same as a part of a sentence, with the wear."""
    return f"{range_words(dataset)}{_in_all_cases(dataset)}, from new to the end of life"


def _in_all_cases(dataset: xr.Dataset) -> str:
    cases = scenes_by_case(scene_of(dataset))
    return f" in {len(cases)} cases" if len(cases) > 1 else ""


def deciding_of(found: xr.Dataset) -> list[Mapping[str, Any]]:
    """Of each method, where each quantity is the worst; empty where a file does not say so."""
    known: list[Mapping[str, Any]] = json.loads(found.attrs.get(DECIDING, "[]"))
    return known or [{} for _ in range(found.sizes.get("preload_method", 1))]


def deciding(found: xr.Dataset, one: xr.Dataset) -> Mapping[str, Any]:
    """Where each quantity of one method of a recommendation is the worst."""
    index = found["preload_method"].values.tolist().index(int(one["preload_method"]))
    return deciding_of(found)[index]


def decides_words(found: xr.Dataset, one: xr.Dataset, name: str, brief: bool = False) -> str:
    """Condition in which a limited measure of a method is the worst; empty where that is unknown.

    name: its key in `LIMITED`.
    brief: as of `extreme_words`.
    """
    measure = LIMITED[name]
    _, which = measure.critical_extreme(lambda extreme: float(one[extreme]))
    return extreme_words(found, one, which, brief)


def extreme_words(found: xr.Dataset, one: xr.Dataset, which: str, brief: bool = False) -> str:
    """Condition in which an extreme of a method is the worst; empty where that is unknown.

    brief: `3000 r/min, worn`, as in a table.
    """
    where = deciding(found, one).get(which)
    if where is None or not np.isfinite(where["value"]):
        return ""
    has_cases = bool(scene_of(found).get("cases"))
    if any(measure.resting and which in measure.extremes for measure in LIMITED.values()):
        case = "" if brief else "case "
        return f"{case}{where['case']}" if has_cases else ""
    return _brief_words(where, has_cases) if brief else condition_words(where, has_cases)


def _brief_words(where: Mapping[str, Any], has_cases: bool) -> str:
    wear = {NEW: "new", AT_END_OF_LIFE: "worn", BETWEEN: "during the life"}
    return ", ".join(
        filter(
            None,
            (
                where["case"] if has_cases else "",
                speed_words(where["speed_rpm"]) if where["speed_rpm"] else "at rest",
                "mounting temperature" if where["temperature"] == MOUNTING else "",
                f"{where['time_s']:.3g} s into the warm-up"
                if where["temperature"] == WARMING
                else "",
                wear.get(where.get("wear", ""), ""),
                f"bearing {where['bearing']}" if where.get("bearing") else "",
            ),
        )
    )


_OVER_DUTY = "over the duty"


def life_words(found: xr.Dataset, one: xr.Dataset) -> str:
    """Whose life that of a method is: its speed and, of several cases, the case; or the duty."""
    if scene_of(found).get("duty"):
        return _OVER_DUTY
    where = deciding(found, one).get("life")
    if where is None:
        return ""
    words = condition_words({**where, "wear": ""})
    cases = len(scenes_by_case(scene_of(found)))
    return f"{words} (case {where['case']}, the shortest of {cases})" if cases > 1 else words


def lives_words(dataset: xr.Dataset) -> str:
    """Whose lives a map or a recommendation has."""
    scene = scene_of(dataset)
    if scene.get("duty"):
        return _OVER_DUTY
    if scene.get("cases"):
        return "of the case with the shortest life"
    return f"at {scene['operation']['shaft_speed_rpm']:g} r/min"


def limit_met_words(found: xr.Dataset, one: xr.Dataset) -> str:
    """What holds a recommended preload, and where: `20 N/µm is just met at 3000 r/min, new`."""
    name = ACTIVE[int(one["active_limit"])]
    limits = limits_of(found)
    if name not in limits.held:
        return ""
    where = decides_words(found, one, name)
    where = f" {where}" if where.startswith(("at ", "during ")) else where and f" ({where})"
    if name not in limits.given:
        return f"below that, a bearing lifts off{where}"
    measure, limit = LIMITED[name], limits.given[name]
    shown = f"{measure.shown_limit(limit):g} {printed_unit(measure.unit)}"
    if float(measure.margins(one, limit)) < _JUST_MET:
        return f"{shown} is just met{where}"
    return f"limited by {shown}{where}"


def stated_warnings(found: xr.Dataset) -> list[dict[str, Any]]:
    """Warnings of a recommendation, each of which names the cases that have it.

    Where a case gives temperatures, none says that they are neglected.
    """
    cases = scenes_by_case(scene_of(found))
    stated = []
    for one in warnings_in(found.attrs):
        if is_answered_by_a_case(one, scene_of(found)):
            continue
        names = one.get("in_cases", [])
        if 0 < len(names) < len(cases):
            words = f"case{'s' * (len(names) > 1)} {', '.join(names)}"
            one = one | {"sentence": f"{words}: {one['sentence']}"}
        stated.append(one)
    return stated
