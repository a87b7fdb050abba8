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
from bearingwear.results.units import digits, printed_unit
from bearingwear.results.words import methods, percent_in_text, scene_of
from bearingwear.scene.arrangement import held_by
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
    without_limits,
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
"""Running preload over the initial one, or the reverse, that is worth a word."""

CALIBRATED = "Wear and friction were calibrated with {rows} tests ({tests})"


class RecommendedPoint(NamedTuple):
    """The recommended preload of a method."""

    method: str
    point: xr.Dataset
    life: float  # [h]

    @property
    def preload(self) -> float:
        """The initial preload [N]."""
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

    The preloads of the points are those of these lives.
    """
    if "longest_life" not in recommendation:  # an older file
        return []
    points = [
        RecommendedPoint(method, point.assign(preload=point["longest_preload"]), float(life))
        for method, point in methods(recommendation)
        if math.isfinite(life := point["longest_life"])
    ]
    return sorted(points, key=lambda point: -point.life)


def method_names(dataset: xr.Dataset) -> list[str]:
    """Returns the preload methods of a file in words."""
    return [method_words(scene_of(dataset), method) for method, _ in methods(dataset)]


def headline(recommendation: xr.Dataset) -> str:
    """States which preload to take, and what keeps it from a longer life."""
    scene, points = scene_of(recommendation), recommended_points(recommendation)
    name = scene["name"]
    if not limits_of(recommendation).given:
        return f"{name}: {without_limits(recommendation.attrs[NONE_BECAUSE])[0]}"
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
    """Returns how a preload is applied: `a spring pair with a preload of 14.7 N`."""
    device = method_words(scene, point.method) if is_pair(scene) else point.method
    return TAKE[device].format(preload_text(point.point))


def _running_preload_words(point: xr.Dataset) -> str:
    """Returns the running preload of a fixed position, unless it is nearly the initial one."""
    running = float(point["residual_preload_at_start"])
    is_spring = PRELOAD_METHODS[int(point["preload_method"])] != "fixed_position"
    if is_spring or not abs(math.log(running / float(point["preload"]))) > math.log(_RUNS_APART):
        return ""
    return f" ({digits(running)} N at speed)"


def _why_not_longer(recommendation: xr.Dataset, point: xr.Dataset) -> str:
    """States what keeps a recommended preload from one with a longer life."""
    name = ACTIVE[int(point["active_limit"])]
    if name in LIMITED:
        return limit_met_words(recommendation, point)
    if name != "end_of_range":
        return LIMIT_WORDS[name]
    scene_preload = scene_of(recommendation)["operation"]["preload_N"]
    less = "less" if float(point["preload"]) < scene_preload else "more"
    beyond = float(point.get("beyond_preload", math.nan))
    if not math.isfinite(beyond):
        return f"{less} preload gives an even longer life"
    gain = percent_in_text(float(point["beyond_life"]) / float(point["life"]) - 1.0)
    return f"{less} preload gains little: {gain} of the life at {beyond:.7g} N"


def life_sentence(recommendation: xr.Dataset, spreads: Mapping[str, Spread | None]) -> str:
    """States the life at the recommended preload, its spread, and what ends it.

    spreads: of the life, by method; None where it was not sampled.
    """
    method, point, life = recommended_points(recommendation)[0]
    scene, where = scene_of(recommendation), life_condition_words(recommendation, point)
    text = f"The computed life{f' {where}' if where else ''} is {digits(life)} h"
    if spread := spreads[method]:
        text += f" ({BEARINGS_BETWEEN}: {spread.bearings.text} h)"
    elif band := band_by_wear(scene, life)[0]:
        text += f" ({BEARINGS_BETWEEN}, wear only: {band.text} h)"
    if end := ending_measure(point):
        limit_text = end.limit_text(scene["wear"]["end_of_life"][end.end_key or end.key])
        reaches = "falls to" if end.falls else "reaches"
        text += f"; it ends when the {end.words} {reaches} {printed_unit(limit_text)}"
        ending = worst_condition(recommendation, point, "life")
        if scene.get("duty") and ending and not end.of_wear:
            text += f" in the case {ending['case']}"
    return f"{text}."


def similar_life_sentences(recommendation: xr.Dataset) -> list[str]:
    """States that the other method gives about the same life; empty if its life is much shorter."""
    best, *others = recommended_points(recommendation)
    if not others or others[0].life < SIMILAR * best.life:
        return []
    other = setting_words(scene_of(recommendation), others[0])
    hours = digits(others[0].life)
    return [f"Within the spread of lives, {other} gives the same life: {hours} h."]


def makers_minimum_sentences(recommendation: xr.Dataset) -> list[str]:
    """States the minimum preload by the maker if known, beside the recommended one if any."""
    scene = scene_of(recommendation)
    if points := recommended_points(recommendation):
        operation = scene["operation"] | {"preload_N": points[0].preload}
        return [sentence(line) for line in minimum_preload_lines(scene | {"operation": operation})]
    words = minimum_preload_words([scene])
    return [sentence(words)] if words else []


def trust_sentence(recommendation: xr.Dataset) -> str:
    """States what the life may be used for."""
    scene = scene_of(recommendation)
    if calibration := scene.get("calibrated"):
        return f"{CALIBRATED.format(**calibration)}."
    if film_sentences := film_lines(scene):
        return " ".join([f"{NO_CLOCK}.", *film_sentences])
    is_short = recommended_points(recommendation)[0].life < SHORT_LIFE
    return f"{NO_CLOCK}{', and lubricant films are not modelled' if is_short else ''}."


def setting_sentence(recommendation: xr.Dataset) -> str:
    """States the recommended preload, of a fixed position as an offset, and its tolerance."""
    best = recommended_points(recommendation)[0]
    low, high = float(best.point["least_preload"]), float(best.point["most_preload"])
    has_tolerance = low <= high
    text, unit = preload_text(best.point), "N"
    middle, ends = best.preload, (low, high)
    side = _side_words(recommendation, best)
    setting = f"a preload of {text}\N{NO-BREAK SPACE}N{side}"
    if best.method == "fixed_position":
        middle, unit = spacer_offset(recommendation, best.preload), "µm"
        if has_tolerance:
            ends = spacer_offset(recommendation, low), spacer_offset(recommendation, high)
        setting = f"a spacer offset of {middle:.3g}\N{NO-BREAK SPACE}µm ({text} N at rest{side})"
    if not has_tolerance:
        return f"Specify {setting}."
    minus, plus = (_rounded_down(abs(end - middle)) for end in ends)
    return (
        f"Specify {setting}, tolerance +{plus:g}/\N{MINUS SIGN}{minus:g}\N{NO-BREAK SPACE}{unit}. "
        f"From {low:.7g} to {high:.7g} N, all requirements are satisfied, and the life is at least "
        "90 % of this life."
    )


def _side_words(recommendation: xr.Dataset, best: RecommendedPoint) -> str:
    """States that a preload is that of each side of a tandem set, and of which pair if rigid."""
    arrangement = scene_of(recommendation).get("arrangement") or {}
    if max(arrangement.get("tandem") or [1]) == 1:
        return ""
    words = " on each side"
    if best.method == "fixed_position":
        pair_N = digits(pair_preload_N(arrangement, best.preload))
        words += f", as bearings matched for a pair of {pair_N} N give"
    return words


def _rounded_down(tolerance: float) -> float:
    """Returns a tolerance with two digits that is not larger."""
    if not tolerance > 0.0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(tolerance)) - 1)
    return float(f"{math.floor(tolerance / unit * (1.0 + 1e-9)) * unit:.2g}")


def spacer_offset(recommendation: xr.Dataset, preload: float) -> float:
    """Returns the approach of both bearings under a preload, at rest and as mounted [µm]."""
    scene = held_by(scene_from_dict(scene_of(recommendation)), "fixed_position", preload)
    sides = scene.sides
    return 1e6 * sum(map(static_place, sides)) * 2.0 / len(sides)


def none_title(recommendation: xr.Dataset) -> str:
    """Returns the heading of `none_sentences`, which names the methods without a preload."""
    if not recommended_points(recommendation):
        return "Why no preload is recommended"
    reasons = json.loads(recommendation.attrs.get(NONE_BECAUSE, "{}"))
    names = " and ".join(_method_in_sentence(recommendation, method) for method in reasons)
    return f"Why no preload is recommended with {names}"


def none_sentences(recommendation: xr.Dataset) -> list[str]:
    """States why no preload is recommended, in a sentence for each method without one."""
    reasons = recommendation.attrs.get(NONE_BECAUSE, "{}")
    if not limits_of(recommendation).given:
        _, advice = without_limits(reasons)
        return [advice] if advice else []
    return [
        f"With {_method_in_sentence(recommendation, method)}, no preload satisfies all "
        f"requirements: {reason}."
        for method, reason in json.loads(reasons).items()
    ]


def _method_in_sentence(recommendation: xr.Dataset, method: str) -> str:
    """Returns the words of a method, with an article if it is a kind of pair."""
    scene = scene_of(recommendation)
    return f"{'a ' * is_pair(scene)}{method_words(scene, method)}"
