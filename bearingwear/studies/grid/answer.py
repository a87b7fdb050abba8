"""The answer of the main study: which preload method lasts longest, and what ends its life."""

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.document.bearing_line import bearing_line
from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import counted_words, film_lines
from bearingwear.document.study import spread_rows
from bearingwear.kernels.status import CRITERION_NOT_REACHED, OK, STATUS_NAMES
from bearingwear.measures import ENDS
from bearingwear.results.pair_variables import is_pair
from bearingwear.results.quantiles import (
    NO_QUANTILES,
    QUOTED_SHARE,
    SEE,
    Spread,
    causes_sentence,
    load_quantiles,
    spread_of,
)
from bearingwear.results.units import Estimated, Rough, in_print, span
from bearingwear.results.words import friction_text, in_words, methods, percent_in_text, scene_of
from bearingwear.scene.arrangement import PAIRS
from bearingwear.studies.dataset import loaded

NO_END = "no end-of-life criterion is met"
RANK = 1
"""Of the answer: one that recommends a preload comes before it."""


def lives_answer(lives: Sequence[Path], uncertainty: Sequence[Path] = ()) -> str:
    """Step: the answer of the study, about its first scene, as the page reads it."""
    known = [one for path in uncertainty for one in load_quantiles(path)]
    read = [loaded(path, interpolated_step=()) for path in lives]
    first = scene_of(read[0])
    return answer([life for one in read for life in lives_of(one, known)], first).stored


class MethodLife(NamedTuple):
    """The wear life of one scene, preload method and friction coefficient."""

    scene: str
    method: str  # of a pair, its kind
    friction: float
    hours: float  # nan where there is none
    error: float  # estimate of the relative numerical error, nan if not known
    end: str  # in words; the status where it was not solved
    worn: bool = False  # whether it has worn grooves
    spread: Spread | None = None
    loss: float = math.nan  # at the end [um]
    route_difference: float = math.nan  # of the interpolated life from this one, relative


def lives_of(dataset: xr.Dataset, known: Sequence[xr.Dataset] = ()) -> list[MethodLife]:
    """Every life in a file of `grid.life.wear_life`.

    `known` are files of the study of uncertainty, if there are any.
    """
    scene = scene_of(dataset)
    limits = scene.get("wear", {}).get("end_of_life") or {}
    names = dataset["end_criterion"].attrs["flag_meanings"].split()
    found = []
    for method, of_method in methods(dataset):
        for mu in dataset["friction"].values.tolist():
            one = of_method.sel(friction=mu)
            status = int(one["status"])
            criterion = names[int(one["end_criterion"])]
            end = NO_END
            if status not in (OK, CRITERION_NOT_REACHED):
                end = f"not solved: {in_words(STATUS_NAMES[status])}"
            elif criterion in ENDS:
                met = ENDS[criterion]
                way = "falls to" if met.falls else "reaches"
                end = f"{met.words} {way} {in_print(met.limit_text(limits[criterion]))}"
            found.append(
                MethodLife(
                    scene["name"],
                    PAIRS[method] if is_pair(scene) else method,
                    mu,
                    float(one["life"]),
                    float(one.get("life_error_estimate", math.nan)),
                    end,
                    "groove_depth" in one and bool(np.isfinite(one["groove_depth"]).any()),
                    spread_of(known, scene, method, mu),
                    1e6 * float(one["loss_at_end"].max()),
                    float(one["life_route_difference"]),
                )
            )
    return found


def answer(lives: Sequence[MethodLife], scene: Mapping[str, Any]) -> Document:
    """The answer of a study with at least one life.

    Two methods whose lives differ by less than their estimated numerical errors together count as
    equal.
    """
    name = lives[0].scene
    here = [life for life in lives if life.scene == name]
    others = [life for life in lives if life.scene != name]
    points = [("What ends the life", _what_ends(here))]
    contests = _contests(here)
    if contests:
        verdicts = [_compared(here), *_verdicts(contests)]
        points.insert(0, ("Comparison of preload methods", verdicts))
    if at_once := _at_once(here):
        points.append(("Uncertainty", [at_once]))
    if others:
        points.append(("Other bearings", _elsewhere(others)))
    preload = f"{scene['operation']['preload_N']:g} N"
    given = f"the given preload of {preload}"
    nominal = " in the nominal case" if scene.get("cases") else ""
    return Document(
        (f"{name}: with {given} for both methods{nominal}, {_headline(here, contests)}",),
        {
            "scene": name,
            # of the scene as it stands: no case of it was solved
            "bearing": f"{bearing_line({**scene, 'cases': None})}{nominal and f';{nominal}'}",
            # the heading after a recommendation, which may prefer the other method
            "beside": f"For comparison: both methods with the input preload of {preload}{nominal}",
        },
        (
            *(Block(title, lines=tuple(said), place="lead") for title, said in points),
            lives_block(f"{name}: lives at {given}{nominal}", here, scene),
        ),
        ("wear_life",),
        subject=f"Input preload: {preload}",
        rank=RANK,
    )


_NOT_LONGER = {None: "the methods are equal", "": "neither can be used"}


class _Contest(NamedTuple):
    """Both methods at one friction coefficient of a scene."""

    friction: float
    longest: str | None  # None: equal; empty: both lives are zero
    other: str
    ratio: float  # longer life over the shorter


def _contests(lives: Iterable[MethodLife]) -> list[_Contest]:
    by_point: dict[tuple[str, float], list[MethodLife]] = {}
    for life in lives:
        if math.isfinite(life.hours):
            by_point.setdefault((life.scene, life.friction), []).append(life)
    found = []
    for (_, mu), pair in by_point.items():
        if len(pair) > 1:
            short, long = sorted(pair, key=lambda life: life.hours)
            ratio = math.inf if long.hours > 0.0 else 1.0  # where the other has no life at all
            if short.hours > 0.0:
                ratio = long.hours / short.hours
            errors = sum(life.error for life in pair if math.isfinite(life.error))
            longest = long.method if ratio - 1.0 > errors else None
            found.append(_Contest(mu, longest if long.hours else "", short.method, ratio))
    return found


def _headline(lives: Sequence[MethodLife], contests: Sequence[_Contest]) -> str:
    if not any(math.isfinite(life.hours) for life in lives):
        return "no end of life was found"
    winners = {contest.longest for contest in contests}
    if not winners:
        known = dict.fromkeys(in_words(life.method) for life in lives)
        return f"life with {' and '.join(known)}"
    if winners == {""}:
        return "neither preload method can be used"
    winners.discard("")
    if winners == {None}:
        return "both preload methods give the same life"
    if len(winners) == 1:
        return f"{_one(str(*winners))} gives the longer life"
    return "the better preload method depends on friction"


def _compared(lives: Sequence[MethodLife]) -> str:
    """With which grooves the methods are compared."""
    worn = {life.worn for life in lives}
    grooves = "worn grooves" if True in worn else "Hertzian grooves"
    if len(worn) > 1:
        grooves += " where wear is deep"
    return (
        f"This comparison uses {grooves} and ignores the requirements. At the recommended "
        "preloads, the order of the methods may differ."
    )


def _grouped(pairs: Iterable[tuple[str, float]]) -> list[tuple[str, str]]:
    """Each text once, with the frictions that it belongs to: neighbours as a range."""
    known = sorted(pairs, key=lambda pair: pair[1])
    runs = [
        (text, [mu for _, mu in members]) for text, members in groupby(known, lambda pair: pair[0])
    ]
    ends: dict[str, list[str]] = {}
    for text, mus in runs:
        last = f" to {mus[-1]:g}" if len(mus) > 1 else ""
        ends.setdefault(text, []).append(f"{friction_text(mus[0])}{last}")
    return [(text, ", ".join(where)) for text, where in ends.items()]


def _verdicts(contests: Sequence[_Contest]) -> list[str]:
    said = []
    of_frictions = _grouped((str(contest.longest), contest.friction) for contest in contests)
    for winner in dict.fromkeys(contest.longest for contest in contests):
        won = [contest for contest in contests if contest.longest == winner]
        if not winner:
            frictions = dict(of_frictions)[str(winner)]
            equal = f"At {frictions}, the lives differ by no more than their numerical errors."
            none = (
                f"Neither method can be used at {frictions}: with both methods, an end-of-life "
                "criterion is met when the bearing is new."
            )
            said.append(equal if winner is None else none)
            continue
        by_margin = _grouped((_margin(c.ratio), c.friction) for c in won)
        margins = ", ".join(f"{margin} at {frictions}" for margin, frictions in by_margin)
        said.append(
            _sentence(f"{_one(winner)} gives a longer life than {_one(won[0].other)}: {margins}")
        )
    return said


def _one(method: str) -> str:
    """A method or a pair in a sentence."""
    return f"{'a ' * (method in PAIRS.values())}{in_words(method)}"


def _margin(ratio: float) -> str:
    if ratio == math.inf:
        return "the other method gives a life of zero"
    if ratio < 1.1:
        return f"{percent_in_text(ratio - 1.0)} longer"
    return f"{ratio:.2g} times as long"


def _at_once(lives: Sequence[MethodLife]) -> str:
    """Of which lives one in twenty is zero; nothing where there is none."""
    found = [
        (in_words(life.method), life.friction)
        for life in lives
        if life.spread and life.spread.bearings.low == 0.0
    ]
    where = ", ".join(f"{method} at {frictions}" for method, frictions in _grouped(found))
    text = f"at least one bearing in twenty meets an end-of-life criterion when new: {where}"
    return _sentence(text) if found else ""


def _note(lives: Sequence[MethodLife], scene: Mapping[str, Any]) -> str:
    """What the columns of the table are."""
    counts = f"The lives are based on the wear of {counted_words(scene)}."
    if scene.get("duty"):
        counts += (
            " They are lives over the duty; the cases of the study are those of the nominal phase."
        )
    if not any(life.spread for life in lives):
        return f"{counts} {_sentence(f'{NO_QUANTILES}; {SEE}')}"
    return (
        f"{counts} {QUOTED_SHARE} of bearings have a life within the interval, which allows for "
        f"all uncertain values in the scene. {causes_sentence(scene)}"
        + ("" if all(life.spread for life in lives) else f" If an interval is missing, {SEE}.")
    )


def _what_ends(lives: Sequence[MethodLife]) -> list[str]:
    """What ends the lives of each method; of both at once where it is the same."""
    texts: dict[str, list[str]] = {}
    for method in dict.fromkeys(life.method for life in lives):
        ends = _grouped((life.end, life.friction) for life in lives if life.method == method)
        text = "; ".join(
            end + (f" at {frictions}" if len(ends) > 1 else "") for end, frictions in ends
        )
        texts.setdefault(text, []).append(in_words(method))
    return [_sentence(f"{' and '.join(names)}: {text}") for text, names in texts.items()]


def _elsewhere(lives: Sequence[MethodLife]) -> list[str]:
    contests = _contests(lives)
    hours = _hours([life.hours for life in lives])
    said = [f"{hours}, based on the wear that each scene specifies"]
    for winner in dict.fromkeys(contest.longest for contest in contests):
        count = sum(contest.longest == winner for contest in contests)
        name = f"{in_words(winner)} gives the longer life" if winner else _NOT_LONGER[winner]
        said.append(f"{name} in {count} of {len(contests)} comparisons")
    return [_sentence(text) for text in said]


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


def lives_block(
    title: str, lives: Sequence[MethodLife], scene: Mapping[str, Any], every: bool = False
) -> Block:
    """A line for each life, with its spread and its end; `every` adds its loss and other route."""
    known = sorted(lives, key=lambda life: life.friction)
    rows = (
        Row("friction", "", tuple(life.friction for life in known), "friction", given=True),
        Row("preload method", "", tuple(in_words(life.method) for life in known)),
        Row(
            "life",
            "h",
            tuple(Estimated.of(life.hours, life.error * life.hours) for life in known),
            "life",
        ),
        *spread_rows([life.spread for life in known]),
        Row("ended by", "", tuple(life.end for life in known), "end_criterion"),
        Row("numerical error", "%", tuple(Rough(100.0 * life.error) for life in known)),
    )
    if every:
        routes = tuple(Rough(100.0 * life.route_difference) for life in known)
        rows += (
            Row("total wear depth", "um", tuple(life.loss for life in known), "loss_at_end"),
            Row("difference in the interpolated life", "%", routes, "life_route_difference"),
        )
    return Block(title, rows=rows, lines=(_note(lives, scene), *film_lines(scene)), axes=2)


def _hours(values: Iterable[float]) -> str:
    """Least and most of some lives; a dash if there is none."""
    text = span(map(Rough, values))
    return text if text == "–" else f"{text}\N{NO-BREAK SPACE}h"
