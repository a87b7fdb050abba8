"""The answer of the main study: which preload method lasts longest, and what ends its life."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.document.bearing_line import bearing_line
from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import caveat_lines, counted_words
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
from bearingwear.results.units import Rough, printed_unit, span
from bearingwear.results.words import (
    friction_text,
    methods,
    name_in_words,
    percent_in_text,
    scene_of,
)
from bearingwear.scene.arrangement import PAIRS
from bearingwear.studies.dataset import load_with_axes

NO_END = "no end-of-life criterion is met"
RANK = 2
"""The rank of the answer on a page; a recommended preload, and its duty, come before it."""


def lives_answer(lives: Sequence[Path], uncertainty: Sequence[Path] = ()) -> str:
    """Step: returns the answer of the study about its first scene, as JSON for the page.

    lives: wear-life files, one a scene. uncertainty: files of the study of uncertainty.
    """
    uncertainties = [dataset for path in uncertainty for dataset in load_quantiles(path)]
    datasets = [load_with_axes(path, interpolated_step=()) for path in lives]
    method_lives = [life for dataset in datasets for life in lives_of(dataset, uncertainties)]
    return answer(method_lives, scene_of(datasets[0])).stored


class MethodLife(NamedTuple):
    """The wear life of one scene, preload method and friction coefficient."""

    scene: str
    method: str  # of a pair, its kind
    friction: float
    hours: float  # nan where there is none
    error: float  # estimate of the relative numerical error, nan if not known
    end: str  # in words; the status where it was not solved
    worn: bool = False  # whether it was computed with worn grooves
    spread: Spread | None = None
    loss: float = math.nan  # at the end [um]
    route_difference: float = math.nan  # of the interpolated life from this one, relative


def lives_of(dataset: xr.Dataset, uncertainties: Sequence[xr.Dataset] = ()) -> list[MethodLife]:
    """Returns every life in a file of `grid.life.wear_life`.

    uncertainties: files of the study of uncertainty.
    """
    scene = scene_of(dataset)
    lives = []
    for method, of_method in methods(dataset):
        for mu in dataset["friction"].values.tolist():
            life = of_method.sel(friction=mu)
            is_worn = "groove_depth" in life and bool(np.isfinite(life["groove_depth"]).any())
            lives.append(
                MethodLife(
                    scene=scene["name"],
                    method=PAIRS[method] if is_pair(scene) else method,
                    friction=mu,
                    hours=float(life["life"]),
                    error=float(life.get("life_error_estimate", math.nan)),
                    end=_end_phrase(life, scene),
                    worn=is_worn,
                    spread=spread_of(uncertainties, scene, method, mu),
                    loss=1e6 * float(life["loss_at_end"].max()),
                    route_difference=float(life["life_route_difference"]),
                )
            )
    return lives


def _end_phrase(life: xr.Dataset, scene: Mapping[str, Any]) -> str:
    """States the criterion that ended a life, or why it has no end."""
    status = int(life["status"])
    if status not in (OK, CRITERION_NOT_REACHED):
        return f"not solved: {name_in_words(STATUS_NAMES[status])}"
    names = life["end_criterion"].attrs["flag_meanings"].split()
    criterion = names[int(life["end_criterion"])]
    if criterion not in ENDS:
        return NO_END
    measure = ENDS[criterion]
    limit_text = measure.limit_text(scene["wear"]["end_of_life"][criterion])
    return (
        f"{measure.words} {'falls to' if measure.falls else 'reaches'} {printed_unit(limit_text)}"
    )


def answer(lives: Sequence[MethodLife], scene: Mapping[str, Any]) -> Document:
    """Returns the answer of a study with at least one life, about the scene of the first life.

    The lives of two methods count as equal if they differ by less than the sum of their estimated
    numerical errors.
    """
    name = lives[0].scene
    lives_here = [life for life in lives if life.scene == name]
    preload = f"{scene['operation']['preload_N']:g} N"
    given_preload = f"the given preload of {preload}"
    nominal = " in the nominal case" if scene.get("cases") else ""
    nominal = " over the duty" if scene.get("duty") else nominal
    headline = _headline(lives_here, _comparisons(lives_here))
    return Document(
        heading=(f"{name}: with {given_preload} for both methods{nominal}, {headline}",),
        facts={
            "scene": name,
            # of the scene without its cases, none of which was solved
            "bearing": f"{bearing_line({**scene, 'cases': None})}{nominal and f';{nominal}'}",
            # the heading after a recommendation, which may prefer the other method
            "beside": f"For comparison: both methods with the input preload of {preload}{nominal}",
        },
        blocks=(
            *_sentence_blocks(lives_here, [life for life in lives if life.scene != name]),
            lives_block(f"{name}: lives at {given_preload}{nominal}", lives_here, scene),
        ),
        figures=("wear_life",),
        subject=f"Input preload: {preload}",
        rank=RANK,
    )


def _sentence_blocks(
    lives: Sequence[MethodLife], lives_elsewhere: Sequence[MethodLife]
) -> list[Block]:
    """Returns the sentences of an answer, below their titles.

    lives: of the scene of the answer. lives_elsewhere: of other scenes.
    """
    sections = []
    if comparisons := _comparisons(lives):
        sentences = [_grooves_sentence(lives), *_comparison_sentences(comparisons)]
        sections.append(("Comparison of preload methods", sentences))
    sections.append(("What ends the life", _end_sentences(lives)))
    if zero_lives := _zero_lives_sentence(lives):
        sections.append(("Uncertainty", [zero_lives]))
    if lives_elsewhere:
        sections.append(("Other bearings", _other_scenes_sentences(lives_elsewhere)))
    return [Block(title, lines=tuple(lines), place="lead") for title, lines in sections]


_NOT_LONGER = {None: "the methods are equal", "": "neither can be used"}


class _Comparison(NamedTuple):
    """Both preload methods at one friction coefficient of a scene."""

    friction: float
    better_method: str | None  # None: equal; empty: both lives are zero
    other_method: str
    ratio: float  # longer life over the shorter


def _comparisons(lives: Iterable[MethodLife]) -> list[_Comparison]:
    """Returns a comparison for each scene and friction coefficient with two lives."""
    by_point: dict[tuple[str, float], list[MethodLife]] = {}
    for life in lives:
        if math.isfinite(life.hours):
            by_point.setdefault((life.scene, life.friction), []).append(life)
    return [_comparison(pair) for pair in by_point.values() if len(pair) > 1]


def _comparison(pair: Sequence[MethodLife]) -> _Comparison:
    """Returns the comparison of two lives of a scene at the same friction coefficient."""
    shorter, longer = sorted(pair, key=lambda life: life.hours)
    ratio = math.inf if longer.hours > 0.0 else 1.0
    if shorter.hours > 0.0:
        ratio = longer.hours / shorter.hours
    errors = sum(life.error for life in pair if math.isfinite(life.error))
    better_method = longer.method if ratio - 1.0 > errors else None
    return _Comparison(
        friction=longer.friction,
        better_method=better_method if longer.hours else "",
        other_method=shorter.method,
        ratio=ratio,
    )


def _headline(lives: Sequence[MethodLife], comparisons: Sequence[_Comparison]) -> str:
    """States which method gives the longer life, for a title."""
    if not any(math.isfinite(life.hours) for life in lives):
        return "no end of life was found"
    winners = {comparison.better_method for comparison in comparisons}
    if not winners:
        names = dict.fromkeys(name_in_words(life.method) for life in lives)
        return f"life with {' and '.join(names)}"
    if winners == {""}:
        return "neither preload method can be used"
    winners.discard("")
    if winners == {None}:
        return "both preload methods give the same life"
    if len(winners) == 1:
        return f"{_method_words(str(*winners))} gives the longer life"
    return "the better preload method depends on friction"


def _grooves_sentence(lives: Sequence[MethodLife]) -> str:
    """States with which grooves the methods were compared."""
    worn = {life.worn for life in lives}
    grooves = "worn grooves" if True in worn else "Hertzian grooves"
    if len(worn) > 1:
        grooves += " where wear is deep"
    return (
        f"This comparison uses {grooves} and ignores the requirements. At the recommended "
        "preloads, the order of the methods may differ."
    )


def _frictions_by_text(pairs: Iterable[tuple[str, float]]) -> dict[str, str]:
    """Returns the friction coefficients of each text, neighbours as a range.

    pairs: a text and its friction coefficient.
    """
    by_friction = sorted(pairs, key=lambda pair: pair[1])
    ranges: dict[str, list[str]] = {}
    for text, run in groupby(by_friction, lambda pair: pair[0]):
        frictions = [friction for _, friction in run]
        end = f" to {frictions[-1]:g}" if len(frictions) > 1 else ""
        ranges.setdefault(text, []).append(f"{friction_text(frictions[0])}{end}")
    return {text: ", ".join(parts) for text, parts in ranges.items()}


def _comparison_sentences(comparisons: Sequence[_Comparison]) -> list[str]:
    """States for each better method where and by how much it is better, or that none is."""
    sentences = []
    frictions_of = _frictions_by_text((str(c.better_method), c.friction) for c in comparisons)
    for winner in dict.fromkeys(comparison.better_method for comparison in comparisons):
        frictions = frictions_of[str(winner)]
        if winner is None:
            sentences.append(
                f"At {frictions}, the lives differ by no more than their numerical errors."
            )
        elif not winner:
            sentences.append(
                f"Neither method can be used at {frictions}: with both methods, an end-of-life "
                "criterion is met when the bearing is new."
            )
        else:
            won = [comparison for comparison in comparisons if comparison.better_method == winner]
            ratios = _frictions_by_text((_ratio_phrase(c.ratio), c.friction) for c in won)
            margins = ", ".join(f"{ratio} at {where}" for ratio, where in ratios.items())
            better, other = _method_words(winner), _method_words(won[0].other_method)
            sentences.append(_sentence(f"{better} gives a longer life than {other}: {margins}"))
    return sentences


def _method_words(method: str) -> str:
    """Returns the words for a preload method, or for a pair with its article."""
    return f"{'a ' * (method in PAIRS.values())}{name_in_words(method)}"


def _ratio_phrase(ratio: float) -> str:
    """States how much longer the longer life is."""
    if ratio == math.inf:
        return "the other method gives a life of zero"
    if ratio < 1.1:
        return f"{percent_in_text(ratio - 1.0)} longer"
    return f"{ratio:.2g} times as long"


def _zero_lives_sentence(lives: Sequence[MethodLife]) -> str:
    """States for which lives at least one bearing in twenty has none; empty if there are none."""
    frictions_of = _frictions_by_text(
        (name_in_words(life.method), life.friction)
        for life in lives
        if life.spread and life.spread.bearings.low == 0.0
    )
    if not frictions_of:
        return ""
    points = ", ".join(f"{method} at {frictions}" for method, frictions in frictions_of.items())
    return _sentence(
        f"at least one bearing in twenty meets an end-of-life criterion when new: {points}"
    )


def _table_note(lives: Sequence[MethodLife], scene: Mapping[str, Any]) -> str:
    """States what the columns of the table of lives contain."""
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


def _end_sentences(lives: Sequence[MethodLife]) -> list[str]:
    """States what ends the lives of each method, in one sentence for methods with the same ends."""
    methods_of: dict[str, list[str]] = {}
    for method in dict.fromkeys(life.method for life in lives):
        ends = _frictions_by_text(
            (life.end, life.friction) for life in lives if life.method == method
        )
        phrases = [f"{end} at {frictions}" for end, frictions in ends.items()]
        text = "; ".join(phrases if len(ends) > 1 else ends)
        methods_of.setdefault(text, []).append(name_in_words(method))
    return [_sentence(f"{' and '.join(names)}: {text}") for text, names in methods_of.items()]


def _other_scenes_sentences(lives: Sequence[MethodLife]) -> list[str]:
    """States the range of lives in other scenes, and how often each method is better there."""
    comparisons = _comparisons(lives)
    hours = _hours_text([life.hours for life in lives])
    phrases = [f"lives: {hours}, based on the wear that each scene specifies"]
    for winner in dict.fromkeys(comparison.better_method for comparison in comparisons):
        count = sum(comparison.better_method == winner for comparison in comparisons)
        name = f"{name_in_words(winner)} gives the longer life" if winner else _NOT_LONGER[winner]
        phrases.append(f"{name} in {count} of {len(comparisons)} comparisons")
    return [_sentence(phrase) for phrase in phrases]


def _sentence(text: str) -> str:
    """Returns a text with a capital letter and a full stop."""
    return f"{text[0].upper()}{text[1:]}."


def lives_block(title: str, lives: Sequence[MethodLife], scene: Mapping[str, Any]) -> Block:
    """Returns a table with a line for each life: its hours, spread, end, and numerical error."""
    lives = sorted(lives, key=lambda life: life.friction)
    rows = (
        Row("friction", "", tuple(life.friction for life in lives), "friction", given=True),
        Row("preload method", "", tuple(name_in_words(life.method) for life in lives)),
        Row("life", "h", tuple(life.hours for life in lives), "life"),
        *spread_rows([life.spread for life in lives]),
        Row("ended by", "", tuple(life.end for life in lives), "end_criterion"),
        Row("numerical error", "%", tuple(Rough(100.0 * life.error) for life in lives)),
    )
    return Block(title, rows=rows, lines=(_table_note(lives, scene), *caveat_lines(scene)), axes=2)


def detailed_lives_block(
    title: str, lives: Sequence[MethodLife], scene: Mapping[str, Any]
) -> Block:
    """Returns the table of `lives_block` with the wear depths and the interpolated lives."""
    block = lives_block(title, lives, scene)
    lives = sorted(lives, key=lambda life: life.friction)
    differences = tuple(Rough(100.0 * life.route_difference) for life in lives)
    rows = (
        Row("total wear depth", "um", tuple(life.loss for life in lives), "loss_at_end"),
        Row("difference in the interpolated life", "%", differences, "life_route_difference"),
    )
    return replace(block, rows=(*block.rows, *rows))


def _hours_text(values: Iterable[float]) -> str:
    """Returns the range of some lives [h]; a dash if there is none."""
    text = span(map(Rough, values))
    return text if text == "–" else f"{text}\N{NO-BREAK SPACE}h"
