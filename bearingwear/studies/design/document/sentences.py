"""What to say of a recommendation in sentences: which preload to take, and how far that holds."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping

import numpy as np
import xarray as xr

from bearingwear.document.document import Row
from bearingwear.document.rows import counted_words
from bearingwear.document.table import flag_names
from bearingwear.measures import ENDS, LIMITED
from bearingwear.results.pair_variables import is_pair, method_words
from bearingwear.results.quantiles import BEARINGS_BETWEEN, Spread, band_by_wear, causes
from bearingwear.results.units import Rough, digits, in_print
from bearingwear.results.words import methods, percent_in_text, scene_of
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.read import scene_from_dict
from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.solvers.bearing.parameters import static_place
from bearingwear.studies.design.beside import (
    NONE_PASSED,
    REVERSED_BY_WARMTH,
    assumptions_of,
    passed,
)
from bearingwear.studies.design.choice import ACTIVE, at_scene, limits_of, preload_text
from bearingwear.studies.design.document.held import decides_words, life_words, limit_met_words
from bearingwear.studies.design.document.words import (
    ASSUMED_WORDS,
    END_KEY,
    LIMIT_KEY,
    NONE_BECAUSE,
    ending_measure,
    limit_text,
    without_limits,
)
from bearingwear.studies.design.room import CLAIMED, NEITHER_LONGER
from bearingwear.studies.design.search import SIMILAR

TAKE = {
    "constant_force": "a spring preload of {} N (constant force)",
    "fixed_position": "a fixed-position preload of {} N",
    "spring pair": "a spring pair with a preload of {} N",
    "rigid pair": "a rigid pair with a preload of {} N",
}
"""How a preload is applied, in the words of the headline, by method or pair."""

_HELD = {
    "none": "No requirement limits the recommended preload, which gives the longest life.",
    "not_solved": "The life at the next preload in the map could not be computed, and may be "
    "longer.",
    "end_of_life": "No requirement limits the recommended preload, but at other preloads another "
    "end-of-life criterion is met earlier.",
    "impractical": "Any preload that gives a longer life would make the design impractical.",
    "cliff": "The life drops sharply near the recommended preload.",
}
"""Why no other preload has a longer life, where no requirement decides."""

NO_CLOCK = (
    "Use this life for comparison only: wear coefficients are known to an order of magnitude at "
    "best"
)

SHORT_LIFE = 500.0
"""Life [h] below which a bearing evidently has no lubricant film."""

NO_OIL = ", and lubricant films are not modelled"

_RUNS_APART = 1.5
"""Running preload over the initial one, or the reverse, that is worth a word."""

NEAREST = 3
"""Reversals of the choice that a sentence names; the table has all of them."""

CALIBRATED = (
    "Wear and friction were calibrated with {rows} tests ({tests}). The interval given for "
    "the life covers the remaining uncertainty and the scatter between bearings."
)


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
    """Which preload to take."""
    scene, lives = scene_of(found), by_life(found)
    name = scene["name"]
    if not limits_of(found).given:
        return f"{name}: {without_limits(found.attrs[NONE_BECAUSE])[0]}"
    if not lives:
        return f"{name}: no preload satisfies all requirements"
    taken = [
        TAKE[method_words(scene, method) if is_pair(scene) else method].format(preload_text(one))
        + _at_speed(one)
        for method, one, _ in lives
    ]
    if int(found["verdict"]) == NEITHER_LONGER:
        return f"{name}: neither method is preferred; use {' or '.join(taken)}"
    one = lives[0][1]
    met = limit_met_words(found, one)
    end = f"; {met}" if met else ""
    preload, below = float(one["preload"]), float(one["cliff_preload"])
    if ACTIVE[int(one["active_limit"])] == "end_of_range":
        end, _ = _at_the_end(found, one)
    if math.isfinite(below):
        near = percent_in_text(abs(below / preload - 1.0))
        life = Rough(one["cliff_life"]).text
        end += (
            f"; with {near} {'less' if below < preload else 'more'} preload, the life is only "
            f"{life} h"
        )
    return f"{name}: use {taken[0]}{end}"


def _at_speed(one: xr.Dataset) -> str:
    """The running preload of a fixed position, where it is not nearly the initial one."""
    running = float(one["residual_preload_at_start"])
    is_spring = PRELOAD_METHODS[int(one["preload_method"])] != "fixed_position"
    if is_spring or not abs(math.log(running / float(one["preload"]))) > math.log(_RUNS_APART):
        return ""
    return f" ({digits(running)} N at speed)"


def _at_the_end(found: xr.Dataset, one: xr.Dataset) -> tuple[str, str]:
    """Of a preload at an end of the range: the end of a headline, and what follows from it."""
    preload = float(one["preload"])
    lower = preload < scene_of(found)["operation"]["preload_N"]
    less, lowest = ("lower", "lowest") if lower else ("higher", "highest")
    beyond = float(one.get("beyond_preload", math.nan))
    if not math.isfinite(beyond):
        return f" or {'less' if lower else 'more'}", (
            f"No requirement limits the recommended preload, and a {less} preload extends the life "
            f"further. Use the {lowest} preload that can be set reliably, or state another "
            "requirement."
        )
    gain = float(one["beyond_life"]) / float(one["life"]) - 1.0
    said = (
        f"No requirement limits the recommended preload, but a {less} preload gains little: the "
        f"life is {percent_in_text(gain)} longer at {beyond:.7g} N"
    )
    if _at_speed(one):
        then = digits(float(one["beyond_running_preload"]))
        said += f", because the preload at speed is still {then} N"
    return f"; a {less} preload gains little", f"{said}."


def what_it_gives(found: xr.Dataset, spread: Mapping[str, Spread | None]) -> list[str]:
    """The life and its spread, beside that of the other method, and what to use it for."""
    lives, pair = by_life(found), is_pair(scene_of(found))
    method, _, life = lives[0]
    scene = scene_of(found)
    alone = scene["wear"]["counts"] == "ball"
    means = [f"wear of {counted_words(scene)}"] if alone else []
    if one := spread[method]:
        means.append(f"{BEARINGS_BETWEEN}: {one.bearings.text} h")
    where = life_words(found, lives[0][1])
    said = f"The computed life{f' {where}' if where else ''} is {Rough(life).text} h"
    said += f" ({'; '.join(means)})" if means else ""
    if len(lives) > 1:
        other, twin, less = lives[1]
        ratio = life / less if less else math.inf
        more = f"{percent_in_text(ratio - 1.0)} more than"
        times = more if ratio < 1.1 else f"{ratio:.2g} times"
        words = f"{'a ' * pair}{method_words(scene_of(found), other)}"
        said += f", {times} the {Rough(less).text} h with {words} at {preload_text(twin)} N"
    scene, end, first = scene_of(found), ending_measure(lives[0][1]), f"{said}."
    if end:
        limit = end.limit_text(scene["wear"]["end_of_life"][end.end_key or end.key])
        reaches = "falls to" if end.falls else "reaches"
        first += f" The life ends when the {end.words} {reaches} {in_print(limit)}."
    if scene.get("calibrated"):
        return [first]
    return [first, f"{NO_CLOCK}{NO_OIL if life < SHORT_LIFE else ''}."]


def what_limits_it(found: xr.Dataset, design: xr.Dataset | None = None) -> list[str]:
    """Requirements that prevent a longer life by either method, and distances to a sudden drop.

    design: the map, which tells whether a lower preload or a higher one has a longer life.
    """
    said: list[str] = []
    scene, given = scene_of(found), limits_of(found).given
    violated = ""
    for method, one, _ in by_life(found):
        name, newtons = ACTIVE[int(one["active_limit"])], preload_text(one)
        if name not in given:
            if name in LIMITED:
                said.append(f"{newtons} N: {limit_met_words(found, one)}.")
            else:
                said += [] if said else [_HELD.get(name) or _at_the_end(found, one)[1]]
            continue
        where = decides_words(found, one, name)
        required = f"a requirement: {limit_text(name, given[name])}"
        if design is not None and LIMITED[name].means:  # of a page, whose question is brief
            required += f" ({LIMITED[name].means})"
        if violated == name:
            required = "the same requirement"
        violated = name
        place = f"in {where}" if where.startswith("case ") else where
        decided = f" Its worst value is {place}." if where else ""
        longer, shorter = _longer_and_shorter(found, method, design)
        if said:  # of the other method
            other = f"{'a ' * is_pair(scene)}{method_words(scene, method)}"
            said.append(
                f"With {other}, the preload of {newtons} N is limited by {required}.{decided}"
            )
        elif longer:
            said.append(
                f"A {longer} preload gives a longer life but violates {required}.{decided} A "
                f"{shorter} preload gives a shorter life."
            )
        else:
            said.append(f"Any preload with a longer life violates {required}.{decided}")
    return [*said, *map(sentence, _cliffs(found))]


def _longer_and_shorter(
    found: xr.Dataset, method: str, design: xr.Dataset | None
) -> tuple[str, str]:
    """Which preloads of the map give a longer life, and which a shorter one: `lower`."""
    if design is None:
        return "", ""
    chosen = dict(methods(found))[method]
    best, line = float(chosen["preload"]), dict(methods(at_scene(design)))[method]
    lives = line["life"].values
    longer = line["preload"].values[lives > float(chosen["life"])]
    if longer.size and longer.max() < best:
        return "lower", "higher"
    if longer.size and longer.min() > best:
        return "higher", "lower"
    return "", ""


def how_to_set_it(found: xr.Dataset) -> list[str]:
    """What to specify: the recommended preload, of a fixed position as an offset, and its
    tolerance.
    """
    method, best, _ = by_life(found)[0]
    is_fixed, preload = method == "fixed_position", float(best["preload"])
    text = preload_text(best)
    low, high = (float(best.get(name, math.nan)) for name in ("least_preload", "most_preload"))
    asked, unit = f"a preload of {text}\N{NO-BREAK SPACE}N", "N"
    middle, ends = preload, (low, high)
    if is_fixed:
        middle, unit = spacer_offset(found, preload), "µm"
        ends = (spacer_offset(found, low), spacer_offset(found, high)) if low <= high else ends
        asked = f"a spacer offset of {middle:.3g}\N{NO-BREAK SPACE}µm"
    said = []
    if low <= high:
        minus, plus = (_rounded_down(abs(end - middle)) for end in ends)
        tolerance = f", tolerance +{plus:g}/\N{MINUS SIGN}{minus:g}\N{NO-BREAK SPACE}{unit}"
        at_rest = f" ({text} N at rest)" if is_fixed else ""
        said.append(
            f"Specify {asked}{at_rest}{tolerance}: from {digits(low)} to {digits(high)} N, all "
            f"requirements hold and the life is at least {100 * SIMILAR:g} % of this life."
        )
    elif is_fixed:
        said.append(f"Specify {asked}, which produces {text} N at rest.")
    if is_fixed:
        less, more = (spacer_offset(found, share * preload) for share in (0.9, 1.1))
        said.append(f"An offset error of {0.5 * (more - less):.2g} µm changes the preload by 10 %.")
    return said


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


def _cliffs(found: xr.Dataset) -> list[str]:
    """How near a sudden drop of the life is to each recommended preload."""
    said = []
    for name, (_, one) in zip(method_names(found), methods(found), strict=True):
        columns = ("preload", "cliff_preload", "cliff_life", "clear_preload", "clear_life")
        preload, below, life, clear, kept = (float(one[column]) for column in columns)
        if not math.isfinite(below):
            continue
        near = percent_in_text(abs(below / preload - 1.0))
        side = "less" if below < preload else "more"
        fall = f"the life falls to {Rough(life).text} h" if life > 0.0 else "the life is zero"
        text = f"{name}: at {below:.7g} N ({near} {side}), {fall}"
        if math.isfinite(clear):
            life_there = Rough(kept).text
            text += f"; {clear:.7g} N leaves a margin of 5 % and gives a life of {life_there} h"
        said.append(text)
    return said


def assumption_words(name: str) -> tuple[str, str]:
    """Label and unit of an assumption."""
    if name in ASSUMED_WORDS:
        return ASSUMED_WORDS[name], ""
    if name.startswith(LIMIT_KEY):
        one = LIMITED[name.removeprefix(LIMIT_KEY)]
        return one.words, one.unit
    one = ENDS[name.removeprefix(END_KEY)]
    return f"end: {one.words}", one.unit


def room_rows(found: xr.Dataset) -> list[Row]:
    """Range of each assumption: from, now and to, as shown."""
    rows = []
    for k, name in enumerate(flag_names(found["assumption"])):
        label, unit = assumption_words(name)
        ends = (float(found[column][k]) for column in ("holds_from", "assumed", "holds_to"))
        rows.append(Row(label, unit, tuple(100.0 * v if unit == "%" else v for v in ends), name))
    return rows


def what_would_change_it(found: xr.Dataset, beside: xr.Dataset | None = None) -> str:
    """Which assumption reverses the choice of the method."""
    lives = by_life(found)
    if len(lives) < 2:
        return "With the other method, no preload satisfies the requirements."
    near, active = [], ACTIVE[int(lives[0][1]["active_limit"])]
    for row in room_rows(found):
        low, now, high = row.values
        known = [(way, end) for way, end in (("below", low), ("above", high)) if end == end]
        if known:
            unit = f"\N{NO-BREAK SPACE}{in_print(row.unit)}" if row.unit else ""
            required = ""
            if limit := LIMITED.get(row.name.removeprefix(LIMIT_KEY)):
                required = "required " if limit.falls else "permitted "
            label = "the " + required + row.label.replace("end: ", "end-of-life criterion for the ")
            ends = " or ".join(f"{way} {digits(end)}" for way, end in known)
            away = min(abs(math.log(end / now)) if end > 0.0 else math.inf for _, end in known)
            is_active = row.name == f"{LIMIT_KEY}{active}"
            near.append(((not is_active, away), f"{label} is {ends}{unit} (now {digits(now)})"))
    near.sort(key=lambda one: one[0])
    said = [text for _, text in near]
    if beside is not None and (kelvin := beside.attrs.get(REVERSED_BY_WARMTH)):
        than = "specified" if scene_of(found).get("temperature") else "the rest of the bearing"
        said.insert(0, f"the inner ring is more than {Rough(kelvin).text} K warmer than {than}")
    if not said:
        return (
            "Within the ranges searched, no change in a requirement, an end-of-life criterion or "
            "friction makes the other method better."
        )
    other = _as_subject(found, lives[1][0])
    return f"{other} becomes the better method if {'; or if '.join(said[:NEAREST])}."


def _as_object(found: xr.Dataset, method: str) -> str:
    """A method or a pair within a sentence."""
    scene = scene_of(found)
    return f"{'a ' * is_pair(scene)}{method_words(scene, method)}"


def _as_subject(found: xr.Dataset, method: str) -> str:
    """A method or a pair at the begin of a sentence."""
    return _as_object(found, method).capitalize()


def what_others_change(beside: xr.Dataset, found: xr.Dataset, method: int) -> list[str]:
    """Assumptions with which the recommended method is not better, or violates a requirement."""
    turned, beyond, unknown, same = [], [], [], []
    for words, case in assumptions_of(beside):
        lives = case["life"].values
        limits = passed(case.isel(preload_method=method))
        if limits.startswith("not solved"):
            unknown.append(words)
        elif np.nanargmax(lives) != method:
            turned.append(words)
        elif limits != NONE_PASSED:
            beyond.append(f"{words} ({limits})")
        else:
            same.append(words)
    flag = int(found["preload_method"][method])
    name = _as_subject(found, PRELOAD_METHODS[flag])
    said = (
        ("The other method gives the longer life with {}.", turned),
        (f"{name} violates a requirement with {{}}.", beyond),
        ("No life could be computed with {}.", unknown),
        # which the temperature of a reversal says, too
        (f"{name} remains the better method and satisfies the requirements with {{}}.",
            [] if REVERSED_BY_WARMTH in beside.attrs else same),
    )  # fmt: skip
    return [text.format("; ".join(each)) for text, each in said if each]


def how_sure(found: xr.Dataset, spread: Mapping[str, Spread | None]) -> list[str]:
    """Sentences on the verdict and the spread of the life."""
    scene = scene_of(found)
    method, _, life = by_life(found)[0]
    said = []
    if int(found["verdict"]) == NEITHER_LONGER:
        said.append(
            f"Neither method is preferred: a {100 * CLAIMED:g} % change in one assumption would "
            "reverse the order."
        )
    if mine := spread[method]:
        uncertain = ", ".join(causes(scene))
        said.append(f"{mine.sentence}{f' (uncertain: {uncertain})' if uncertain else ''}.")
        if mine.longest:
            said.append(
                f"{_as_subject(found, method)} gives the longer life in "
                f"{Rough(mine.longest_share).text} % of the simulated bearings, each with the same "
                f"values for both methods ({mine.longest.text} % allowing for sample size and "
                "numerical errors). All other inputs, such as temperature, are kept at their given "
                "values."
            )
    else:
        band, taken = band_by_wear(scene, life)
        if band:
            by_table = f" ({taken})" if taken else ""
            said.append(
                f"{BEARINGS_BETWEEN} have lives of {band.text} h if only wear is "
                f"uncertain{by_table}."
            )
    calibration = scene.get("calibrated")
    return [*said, CALIBRATED.format(**calibration)] if calibration else said


def why_title(found: xr.Dataset) -> str:
    """Heading of `what_is_not_possible`: of all methods, or of the one without a preload."""
    if not by_life(found):
        return "Why no preload is recommended"
    without = json.loads(found.attrs.get(NONE_BECAUSE, "{}"))
    names = " and ".join(_as_object(found, method) for method in without)
    return f"Why no preload is recommended with {names}"


def what_is_not_possible(found: xr.Dataset) -> list[str]:
    """Why no preload is recommended, a sentence for each method without one."""
    because = found.attrs.get(NONE_BECAUSE, "{}")
    if not limits_of(found).given:
        return list(filter(None, without_limits(because)[1:]))
    return [
        f"With {_as_object(found, method)}, no preload satisfies all requirements: {why}."
        for method, why in json.loads(because).items()
    ]
