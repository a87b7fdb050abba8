"""What is said of a recommendation in sentences: a headline, the life, and what to set."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping

import xarray as xr

from bearingwear.document.rows import film_lines
from bearingwear.measures import LIMITED
from bearingwear.results.pair_variables import is_pair, method_words
from bearingwear.results.quantiles import BEARINGS_BETWEEN, Spread, band_by_wear
from bearingwear.results.units import Rough, digits, printed_unit
from bearingwear.results.words import methods, percent_in_text, scene_of
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.new.minimum_preload import minimum_preload_lines, minimum_preload_words
from bearingwear.scene.read import scene_from_dict
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.solvers.bearing.parameters import static_place
from bearingwear.studies.design.choice import ACTIVE, limits_of, preload_text
from bearingwear.studies.design.document.held import deciding, life_words, limit_met_words
from bearingwear.studies.design.document.words import (
    LIMIT_WORDS,
    NONE_BECAUSE,
    ending_measure,
    without_limits,
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


def sentence(text: str) -> str:
    """A text with a capital and a full stop."""
    return f"{text[0].upper()}{text[1:]}."


def by_life(found: xr.Dataset) -> list[tuple[str, xr.Dataset, float]]:
    """Each method that has a preload, and its life [h]; the longest first."""
    known = [(name, one, float(one["life"])) for name, one in methods(found)]
    return sorted((each for each in known if math.isfinite(each[2])), key=lambda each: -each[2])


def method_names(found: xr.Dataset) -> list[str]:
    """Preload methods of a file in words."""
    return [method_words(scene_of(found), name) for name, _ in methods(found)]


def headline(found: xr.Dataset) -> str:
    """Which preload to take, and what keeps it from a longer life."""
    scene, lives = scene_of(found), by_life(found)
    name = scene["name"]
    if not limits_of(found).given:
        return f"{name}: {without_limits(found.attrs[NONE_BECAUSE])[0]}"
    if not lives:
        return f"{name}: no preload satisfies all requirements"
    method, one, _ = lives[0]
    way = method_words(scene, method) if is_pair(scene) else method
    taken = TAKE[way].format(preload_text(one)) + _at_speed(one)
    return f"{name}: use {taken}; {_why_not_longer(found, one)}"


def _at_speed(one: xr.Dataset) -> str:
    """The running preload of a fixed position, where it is not nearly the initial one."""
    running = float(one["residual_preload_at_start"])
    is_spring = PRELOAD_METHODS[int(one["preload_method"])] != "fixed_position"
    if is_spring or not abs(math.log(running / float(one["preload"]))) > math.log(_RUNS_APART):
        return ""
    return f" ({digits(running)} N at speed)"


def _why_not_longer(found: xr.Dataset, one: xr.Dataset) -> str:
    """What keeps a recommended preload from one with a longer life."""
    name = ACTIVE[int(one["active_limit"])]
    if name in LIMITED:
        return limit_met_words(found, one)
    if name != "end_of_range":
        return LIMIT_WORDS[name]
    less = "less" if float(one["preload"]) < scene_of(found)["operation"]["preload_N"] else "more"
    beyond = float(one.get("beyond_preload", math.nan))
    if not math.isfinite(beyond):
        return f"{less} preload gives an even longer life"
    gain = percent_in_text(float(one["beyond_life"]) / float(one["life"]) - 1.0)
    return f"{less} preload gains little: {gain} of the life at {beyond:.7g} N"


def life_sentence(found: xr.Dataset, spread: Mapping[str, Spread | None]) -> str:
    """The life at the recommended preload, between which lives bearings lie, and what ends it."""
    method, one, life = by_life(found)[0]
    scene, where = scene_of(found), life_words(found, one)
    text = f"The computed life{f' {where}' if where else ''} is {Rough(life).text} h"
    if known := spread[method]:
        text += f" ({BEARINGS_BETWEEN}: {known.bearings.text} h)"
    else:
        band, _ = band_by_wear(scene, life)
        text += f" ({BEARINGS_BETWEEN}, wear only: {band.text} h)" if band else ""
    if end := ending_measure(one):
        limit = end.limit_text(scene["wear"]["end_of_life"][end.end_key or end.key])
        reaches = "falls to" if end.falls else "reaches"
        text += f"; it ends when the {end.words} {reaches} {printed_unit(limit)}"
        if scene.get("duty") and (ending := deciding(found, one).get("life")):
            text += f" in the case {ending['case']}"
    return f"{text}."


def makers_minimum_sentences(found: xr.Dataset) -> list[str]:
    """The minimum preload by the maker, beside the recommended one if any, where it is known."""
    scene = scene_of(found)
    if best := by_life(found):
        operation = scene["operation"] | {"preload_N": float(best[0][1]["preload"])}
        return [sentence(line) for line in minimum_preload_lines(scene | {"operation": operation})]
    words = minimum_preload_words([scene])
    return [sentence(words)] if words else []


def trust_sentence(found: xr.Dataset) -> str:
    """What the life may be used for."""
    if calibration := scene_of(found).get("calibrated"):
        return f"{CALIBRATED.format(**calibration)}."
    if known := film_lines(scene_of(found)):
        return " ".join([f"{NO_CLOCK}.", *known])
    oil = ", and lubricant films are not modelled" if by_life(found)[0][2] < SHORT_LIFE else ""
    return f"{NO_CLOCK}{oil}."


def setting_sentence(found: xr.Dataset) -> str:
    """What to specify: the recommended preload, of a fixed position as an offset, and how far it
    may be off.
    """
    method, best, _ = by_life(found)[0]
    is_fixed, preload = method == "fixed_position", float(best["preload"])
    low, high = float(best["least_preload"]), float(best["most_preload"])
    text, unit = preload_text(best), "N"
    middle, ends = preload, (low, high)
    asked = f"a preload of {text}\N{NO-BREAK SPACE}N"
    if is_fixed:
        middle, unit = spacer_offset(found, preload), "µm"
        if low <= high:
            ends = spacer_offset(found, low), spacer_offset(found, high)
        asked = f"a spacer offset of {middle:.3g}\N{NO-BREAK SPACE}µm ({text} N at rest)"
    if not low <= high:
        return f"Specify {asked}."
    minus, plus = (_rounded_down(abs(end - middle)) for end in ends)
    return (
        f"Specify {asked}, tolerance +{plus:g}/\N{MINUS SIGN}{minus:g}\N{NO-BREAK SPACE}{unit}: "
        f"from {low:.7g} to {high:.7g} N, all requirements hold and the life is at least 90 % of "
        "this life."
    )


def _rounded_down(value: float) -> float:
    """A tolerance with two digits that is not larger than a value."""
    if not value > 0.0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.floor(value / unit * (1.0 + 1e-9)) * unit:.2g}")


def spacer_offset(found: xr.Dataset, preload: float) -> float:
    """Axial approach of both bearings under a preload, at rest and as mounted [µm]."""
    scene = held_by(scene_from_dict(scene_of(found)), "fixed_position", preload)
    sides = scene.sides
    return 1e6 * sum(map(static_place, sides)) * 2.0 / len(sides)


def none_title(found: xr.Dataset) -> str:
    """Heading of `none_sentences`: of all methods, or of the one without a preload."""
    if not by_life(found):
        return "Why no preload is recommended"
    without = json.loads(found.attrs.get(NONE_BECAUSE, "{}"))
    names = " and ".join(_method_in_sentence(found, method) for method in without)
    return f"Why no preload is recommended with {names}"


def none_sentences(found: xr.Dataset) -> list[str]:
    """Why no preload is recommended, a sentence for each method without one."""
    because = found.attrs.get(NONE_BECAUSE, "{}")
    if not limits_of(found).given:
        return list(filter(None, without_limits(because)[1:]))
    return [
        f"With {_method_in_sentence(found, method)}, no preload satisfies all requirements: {why}."
        for method, why in json.loads(because).items()
    ]


def _method_in_sentence(found: xr.Dataset, method: str) -> str:
    scene = scene_of(found)
    return f"{'a ' * is_pair(scene)}{method_words(scene, method)}"
