"""Sentences on a recommendation: a headline, the life, and what to set."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import xarray as xr

from bearingwear.document.bearing_line import pair_preload_N
from bearingwear.document.rows import film_lines
from bearingwear.measures import LIMITED
from bearingwear.results.pair_variables import is_pair, method_words
from bearingwear.results.quantiles import BEARINGS_BETWEEN, Spread, band_by_wear
from bearingwear.results.units import counted_tests, digits, printed_unit
from bearingwear.results.words import methods, percent_in_text, plain_scene
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.new.minimum_preload import minimum_preload_lines, minimum_preload_words
from bearingwear.scene.read import scene_from_dict
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.solvers.bearing.parameters import static_place
from bearingwear.studies.design.best import SIMILAR
from bearingwear.studies.design.choice import ACTIVE, limits_of, preload_text
from bearingwear.studies.design.document.words import (
    LIMIT_WORDS,
    NONE_BECAUSE,
    ending_measure,
    no_requirement_words,
)
from bearingwear.studies.design.document.worst_conditions import (
    life_condition_words,
    limit_met_words,
    worst_condition,
)

TAKE = {
    "constant_force": "a spring preload of {} N (constant force)",
    "fixed_position": "a fixed-position preload of {} N",
    "spring pair": "a spring pair with a preload of {} N",
    "rigid pair": "a rigid pair with a preload of {} N",
}
"""How a preload is applied, in the words of the headline, by method or pair."""

NO_CLOCK = (
    "Use this life for comparison only: wear coefficients are known to an order of magnitude at "
    "best"
)

SHORT_LIFE = 500.0
"""Life [h] below which a bearing evidently has no lubricant film."""

_RUNS_APART = 1.5
"""Ratio of running and initial preload, the larger over the smaller, above which both are named."""

CALIBRATED = "Wear and friction were calibrated with {count} ({tests})"


class RecommendedPoint(NamedTuple):
    """The recommended preload of a method."""

    method: str
    point: xr.Dataset
    life: float  # [h]

    @property
    def preload(self) -> float:
        """Returns the initial preload [N]."""
        return float(self.point["preload"])


def sentence(text: str) -> str:
    """Returns a text with a capital and a full stop."""
    return f"{text[0].upper()}{text[1:]}."


def recommended_points(recommendation: xr.Dataset) -> list[RecommendedPoint]:
    """Returns the recommended preload of each method that has one; the longest life first."""
    points = [
        RecommendedPoint(method, point, float(point["life"]))
        for method, point in methods(recommendation)
    ]
    with_life = [point for point in points if math.isfinite(point.life)]
    return sorted(with_life, key=lambda point: -point.life)


def points_with_short_life(recommendation: xr.Dataset) -> list[RecommendedPoint]:
    """Returns the longest life of each method that only the required life rules out, longest first.

    Points have the preload and the life of `longest_preload` and `longest_life`.
    """
    if "longest_life" not in recommendation:  # an older file
        return []
    names = {"preload": "longest_preload", "life": "longest_life"}
    longest = {name: recommendation[variable] for name, variable in names.items()}
    return recommended_points(recommendation.assign(longest))


def method_names(dataset: xr.Dataset) -> list[str]:
    """Returns the preload methods of a file in words."""
    return [method_words(plain_scene(dataset), method) for method, _ in methods(dataset)]


def headline(recommendation: xr.Dataset) -> str:
    """Returns a title that says which preload to take, and what keeps it from a longer life."""
    scene = plain_scene(recommendation)
    points = recommended_points(recommendation)
    name = scene["name"]
    if not limits_of(recommendation).given:
        text, _ = no_requirement_words(recommendation.attrs[NONE_BECAUSE])
        return f"{name}: {text}"
    if points:
        point = points[0].point
        text = setting_words(scene, points[0]) + _running_preload_words(point)
        return f"{name}: use {text}; {_why_not_longer(recommendation, point)}"
    if short := points_with_short_life(recommendation):
        limits = limits_of(recommendation)
        others = " within the other requirements" if len(limits.given) > 1 else ""
        return (
            f"{name}: no preload lasts {limits.life_h:.7g} h{others}; at most "
            f"{digits(short[0].life)} h ({method_words(scene, short[0].method)}, "
            f"{short[0].preload:.7g} N)"
        )
    return f"{name}: no preload satisfies all requirements"


def setting_words(scene: Mapping[str, Any], point: RecommendedPoint) -> str:
    """Returns how a preload is applied, as "a spring pair with a preload of 14.7 N"."""
    device = method_words(scene, point.method) if is_pair(scene) else point.method
    return TAKE[device].format(preload_text(point.point))


def _running_preload_words(point: xr.Dataset) -> str:
    """Returns the running preload of a fixed position, in brackets.

    It is empty if it is nearly the initial preload, and for a constant force.

    point: recommendation of a method.
    """
    if PRELOAD_METHODS[int(point["preload_method"])] != "fixed_position":
        return ""
    running = float(point["residual_preload_at_start"])
    log_ratio = math.log(running / float(point["preload"]))
    if abs(log_ratio) > math.log(_RUNS_APART):
        return f" ({digits(running)} N at speed)"
    return ""


def _why_not_longer(recommendation: xr.Dataset, point: xr.Dataset) -> str:
    """Returns a phrase on what keeps a recommended preload from one with a longer life.

    point: recommendation of a method.
    """
    name = ACTIVE[int(point["active_limit"])]
    if name in LIMITED:
        return limit_met_words(recommendation, point)
    if name != "end_of_range":
        return LIMIT_WORDS[name]
    scene_preload = plain_scene(recommendation)["operation"]["preload_N"]
    less = "less" if float(point["preload"]) < scene_preload else "more"
    beyond = float(point.get("beyond_preload", math.nan))
    if not math.isfinite(beyond):
        return f"{less} preload gives an even longer life"
    gain = percent_in_text(float(point["beyond_life"]) / float(point["life"]) - 1.0)
    return f"{less} preload gains little: {gain} of the life at {beyond:.7g} N"


def life_sentence(recommendation: xr.Dataset, spreads: Mapping[str, Spread | None]) -> str:
    """Returns a sentence on the life at the recommended preload, its spread, and what ends it.

    recommendation: with at least one preload.
    spreads: of the life, by method; None where it was not sampled.
    """
    method, point, life = recommended_points(recommendation)[0]
    scene = plain_scene(recommendation)
    where = life_condition_words(recommendation, point)
    subject = f"The computed life {where}" if where else "The computed life"
    text = f"{subject} is {digits(life)} h"
    if spread := spreads[method]:
        text += f" ({BEARINGS_BETWEEN}: {spread.bearings.text} h)"
    elif band := band_by_wear(scene, life)[0]:
        text += f" ({BEARINGS_BETWEEN}, wear only: {band.text} h)"
    end = ending_measure(point)
    if end is not None:
        limit_text = end.limit_text(scene["wear"]["end_of_life"][end.end_key or end.key])
        verb = "falls to" if end.falls else "reaches"
        text += f"; it ends when the {end.words} {verb} {printed_unit(limit_text)}"
        ending_condition = worst_condition(recommendation, point, "life")
        if scene.get("duty") and ending_condition and not end.of_wear:
            text += f" in the case {ending_condition['case']}"
    return f"{text}."


def similar_life_sentences(recommendation: xr.Dataset) -> list[str]:
    """Returns a sentence on the other method if its life is similar, in a list; else none."""
    best, *others = recommended_points(recommendation)
    if not others or others[0].life < SIMILAR * best.life:
        return []
    other = setting_words(plain_scene(recommendation), others[0])
    hours = digits(others[0].life)
    return [f"Within the spread of lives, {other} gives the same life: {hours} h."]


def makers_minimum_sentences(recommendation: xr.Dataset) -> list[str]:
    """Returns sentences on the maker's minimum preload, compared with the recommended one if any.

    The list is empty if that minimum is not known.
    """
    scene = plain_scene(recommendation)
    points = recommended_points(recommendation)
    if points:
        operation = scene["operation"] | {"preload_N": points[0].preload}
        return [sentence(line) for line in minimum_preload_lines(scene | {"operation": operation})]
    words = minimum_preload_words([scene])
    return [sentence(words)] if words else []


def trust_sentence(recommendation: xr.Dataset) -> str:
    """Returns sentences on how far to trust the life: its calibration, or that it only compares.

    recommendation: with at least one preload.
    """
    scene = plain_scene(recommendation)
    calibration = scene.get("calibrated")
    if calibration:
        count = counted_tests(calibration["rows"])
        return f"{CALIBRATED.format(count=count, tests=calibration['tests'])}."
    film_sentences = film_lines(scene)
    if film_sentences:
        return " ".join([f"{NO_CLOCK}.", *film_sentences])
    if recommended_points(recommendation)[0].life < SHORT_LIFE:
        return f"{NO_CLOCK}, and lubricant films are not modelled."
    return f"{NO_CLOCK}."


def setting_sentence(recommendation: xr.Dataset) -> str:
    """Returns a sentence on the recommended preload and its tolerance, if that is known.

    A fixed position is specified as a spacer offset.

    recommendation: with at least one preload.
    """
    best = recommended_points(recommendation)[0]
    low, high = float(best.point["least_preload"]), float(best.point["most_preload"])
    has_tolerance = low <= high  # both may be NaN
    text = preload_text(best.point)
    side = _side_words(recommendation, best)
    if best.method == "fixed_position":
        unit = "µm"
        middle = spacer_offset(recommendation, best.preload)
        setting = f"a spacer offset of {middle:.3g}\N{NO-BREAK SPACE}µm ({text} N at rest{side})"
    else:
        unit = "N"
        middle = best.preload
        setting = f"a preload of {text}\N{NO-BREAK SPACE}N{side}"
    if not has_tolerance:
        return f"Specify {setting}."
    ends = [low, high]
    if best.method == "fixed_position":
        ends = [spacer_offset(recommendation, end) for end in ends]
    minus, plus = (_rounded_down(abs(end - middle)) for end in ends)
    return (
        f"Specify {setting}, tolerance +{plus:g}/\N{MINUS SIGN}{minus:g}\N{NO-BREAK SPACE}{unit}. "
        f"From {low:.7g} to {high:.7g} N, all requirements are satisfied, and the life is at least "
        "90 % of this life."
    )


def _side_words(recommendation: xr.Dataset, best: RecommendedPoint) -> str:
    """Returns words for a tandem set: that the preload is on each side, and of which pair if rigid.

    They are empty for other arrangements.
    """
    arrangement = plain_scene(recommendation).get("arrangement") or {}
    if max(arrangement.get("tandem") or [1]) == 1:
        return ""
    words = " on each side"
    if best.method == "fixed_position":
        pair_N = digits(pair_preload_N(arrangement, best.preload))
        words += f", as bearings matched for a pair of {pair_N} N give"
    return words


def _rounded_down(tolerance: float) -> float:
    """Returns a tolerance rounded down to two significant digits; zero unless it is above zero."""
    if not tolerance > 0.0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(tolerance)) - 1)
    units = math.floor(tolerance / unit * (1.0 + 1e-9))  # beyond rounding errors
    return float(f"{units * unit:.2g}")


def spacer_offset(recommendation: xr.Dataset, preload: float) -> float:
    """Returns the approach [µm] of both bearings of a rigid pair under a preload [N], as mounted.

    The approach of a single bearing counts twice.
    """
    scene = with_method(scene_from_dict(plain_scene(recommendation)), "fixed_position", preload)
    sides = scene.sides
    return 1e6 * sum(map(static_place, sides)) * 2.0 / len(sides)


def no_preload_title(recommendation: xr.Dataset) -> str:
    """Returns the title of `no_preload_sentences`, which names the methods without a preload."""
    if not recommended_points(recommendation):
        return "Why no preload is recommended"
    reasons = json.loads(recommendation.attrs.get(NONE_BECAUSE, "{}"))
    names = " and ".join(_method_in_sentence(recommendation, method) for method in reasons)
    return f"Why no preload is recommended with {names}"


def no_preload_sentences(recommendation: xr.Dataset) -> list[str]:
    """Returns a sentence for each method without a preload on why it has none.

    Without requirements, the list has advice to state some, or is empty.
    """
    reasons = recommendation.attrs.get(NONE_BECAUSE, "{}")
    if not limits_of(recommendation).given:
        _, advice = no_requirement_words(reasons)
        return [advice] if advice else []
    return [
        f"With {_method_in_sentence(recommendation, method)}, no preload satisfies all "
        f"requirements: {reason}."
        for method, reason in json.loads(reasons).items()
    ]


def _method_in_sentence(recommendation: xr.Dataset, method: str) -> str:
    """Returns the words for a preload method, with an article if it is a kind of pair."""
    scene = plain_scene(recommendation)
    words = method_words(scene, method)
    return f"a {words}" if is_pair(scene) else words
