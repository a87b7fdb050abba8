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
    plain_scene,
)
from bearingwear.scene.arrangement import PAIRS
from bearingwear.studies.dataset import load_with_axes

NO_END = "no end-of-life criterion is met"
RANK = 2
"""The rank of the answer on a page; a recommended preload, and its duty, come before it."""


def lives_answer(lives: Sequence[Path], uncertainty: Sequence[Path] = ()) -> str:
    """Step: returns the answer of the study about its first scene, as JSON for the page.

    lives: wear-life files, one a scene.
    uncertainty: files of the study of uncertainty.
    """
    uncertainties = [dataset for path in uncertainty for dataset in load_quantiles(path)]
    datasets = [load_with_axes(path, interpolated_step=()) for path in lives]
    all_lives = [life for dataset in datasets for life in lives_of(dataset, uncertainties)]
    return answer(all_lives, plain_scene(datasets[0])).stored


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
    route_difference: float = math.nan  # interpolated life over this one, less 1


def lives_of(dataset: xr.Dataset, uncertainties: Sequence[xr.Dataset] = ()) -> list[MethodLife]:
    """Returns the life at each preload method and friction coefficient in a file of wear lives.

    The loss of a pair is the larger one of its bearings.

    dataset: of `grid.life.wear_life`.
    uncertainties: datasets of the study of uncertainty.
    """
    scene = plain_scene(dataset)
    lives = []
    for method, lives_with_method in methods(dataset):
        for mu in dataset["friction"].values.tolist():
            life = lives_with_method.sel(friction=mu)
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
    """Returns a phrase on the criterion that ended a life, or on why it has no end."""
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
    """Returns the answer of a study about the scene of the first life: which method lasts longer.

    The lives of two methods count as equal if they differ by less than the sum of their estimated
    numerical errors.

    lives: of all scenes of the study, at least one.
    scene: plain data of the scene of the first life.
    """
    name = lives[0].scene
    lives_here = [life for life in lives if life.scene == name]
    preload = f"{scene['operation']['preload_N']:g} N"
    given_preload = f"the given preload of {preload}"
    condition = ""
    if scene.get("duty"):
        condition = " over the duty"
    elif scene.get("cases"):
        condition = " in the nominal case"
    headline = _headline(lives_here, _comparisons(lives_here))
    # of the scene without its cases, none of which was solved
    bearing = bearing_line({**scene, "cases": None})
    return Document(
        heading=(f"{name}: with {given_preload} for both methods{condition}, {headline}",),
        facts={
            "scene": name,
            "bearing": f"{bearing};{condition}" if condition else bearing,
            # the heading after a recommendation, which may prefer the other method
            "beside": "For comparison: both methods with the input preload of "
            f"{preload}{condition}",
        },
        blocks=(
            *_sentence_blocks(lives_here, [life for life in lives if life.scene != name]),
            lives_block(f"{name}: lives at {given_preload}{condition}", lives_here, scene),
        ),
        figures=("wear_life",),
        subject=f"Input preload: {preload}",
        rank=RANK,
    )


def _sentence_blocks(
    lives: Sequence[MethodLife], lives_elsewhere: Sequence[MethodLife]
) -> list[Block]:
    """Returns the sentences of an answer, in blocks below their titles.

    lives: of the scene of the answer.
    lives_elsewhere: of other scenes.
    """
    sections: dict[str, list[str]] = {}
    comparisons = _comparisons(lives)
    if comparisons:
        sentences = [_grooves_sentence(lives), *_comparison_sentences(comparisons)]
        sections["Comparison of preload methods"] = sentences
    sections["What ends the life"] = _end_sentences(lives)
    zero_lives_sentence = _zero_lives_sentence(lives)
    if zero_lives_sentence:
        sections["Uncertainty"] = [zero_lives_sentence]
    if lives_elsewhere:
        sections["Other bearings"] = _other_scenes_sentences(lives_elsewhere)
    return [Block(title, lines=tuple(lines), place="lead") for title, lines in sections.items()]


_EQUAL = "the methods are equal"
_NEITHER = "neither can be used"
"""Results of a comparison that no method wins: equal lives, and two lives of zero."""


class _Comparison(NamedTuple):
    """Both preload methods at one friction coefficient of a scene."""

    friction: float
    winner: str  # preload method with the longer life, or `_EQUAL` or `_NEITHER`
    other_method: str
    ratio: float  # longer life over the shorter


def _comparisons(lives: Iterable[MethodLife]) -> list[_Comparison]:
    """Returns a comparison for each scene and friction coefficient with two finite lives."""
    lives_by_point: dict[tuple[str, float], list[MethodLife]] = {}
    for life in lives:
        if math.isfinite(life.hours):
            lives_by_point.setdefault((life.scene, life.friction), []).append(life)
    return [_comparison(pair) for pair in lives_by_point.values() if len(pair) > 1]


def _comparison(pair: Sequence[MethodLife]) -> _Comparison:
    """Returns the comparison of two lives of a scene at the same friction coefficient.

    The longer one wins if it exceeds the shorter by more than the sum of their relative numerical
    errors. An unknown error counts as 0. The ratio is infinite if the shorter life is 0.
    """
    shorter, longer = sorted(pair, key=lambda life: life.hours)
    ratio = longer.hours / shorter.hours if shorter.hours > 0.0 else math.inf
    errors = sum(life.error for life in pair if math.isfinite(life.error))
    if longer.hours == 0.0:
        winner = _NEITHER
    else:
        winner = longer.method if ratio - 1.0 > errors else _EQUAL
    return _Comparison(
        friction=longer.friction,
        winner=winner,
        other_method=shorter.method,
        ratio=ratio,
    )


def _headline(lives: Sequence[MethodLife], comparisons: Sequence[_Comparison]) -> str:
    """Returns the part of a title that says which method gives the longer life.

    comparisons: of the lives of the answer.
    """
    if not any(math.isfinite(life.hours) for life in lives):
        return "no end of life was found"
    winners = {comparison.winner for comparison in comparisons}
    if not winners:
        names = dict.fromkeys(name_in_words(life.method) for life in lives)
        return f"life with {' and '.join(names)}"
    if winners == {_NEITHER}:
        return "neither preload method can be used"
    winners.discard(_NEITHER)
    if winners == {_EQUAL}:
        return "both preload methods give the same life"
    if len(winners) == 1:
        return f"{_method_words(winners.pop())} gives the longer life"
    return "the better preload method depends on friction"


def _grooves_sentence(lives: Sequence[MethodLife]) -> str:
    """Returns a sentence on the grooves with which the methods were compared."""
    worn_lives = [life for life in lives if life.worn]
    grooves = "worn grooves" if worn_lives else "Hertzian grooves"
    if 0 < len(worn_lives) < len(lives):
        grooves += " where wear is deep"
    return (
        f"This comparison uses {grooves} and ignores the requirements. At the recommended "
        "preloads, the order of the methods may differ."
    )


def _frictions_by_text(pairs: Iterable[tuple[str, float]]) -> dict[str, str]:
    """Returns words for the friction coefficients at which each text applies, by the text.

    Neighbours among all coefficients become a range, such as "friction 0.05 to 0.1".

    pairs: of a text and a friction coefficient at which it applies.
    """
    rising_pairs = sorted(pairs, key=lambda pair: pair[1])
    ranges_by_text: dict[str, list[str]] = {}
    for text, neighbours in groupby(rising_pairs, lambda pair: pair[0]):
        frictions = [friction for _, friction in neighbours]
        end = f" to {frictions[-1]:g}" if len(frictions) > 1 else ""
        ranges_by_text.setdefault(text, []).append(f"{friction_text(frictions[0])}{end}")
    return {text: ", ".join(ranges) for text, ranges in ranges_by_text.items()}


def _comparison_sentences(comparisons: Sequence[_Comparison]) -> list[str]:
    """Returns a sentence for each method that wins: where, and by how much.

    Where no method wins, a sentence says so.

    comparisons: of the lives of the answer.
    """
    sentences = []
    frictions_by_winner = _frictions_by_text(
        (comparison.winner, comparison.friction) for comparison in comparisons
    )
    for winner in dict.fromkeys(comparison.winner for comparison in comparisons):
        frictions = frictions_by_winner[winner]
        if winner == _EQUAL:
            sentences.append(
                f"At {frictions}, the lives differ by no more than their numerical errors."
            )
        elif winner == _NEITHER:
            sentences.append(
                f"Neither method can be used at {frictions}: with both methods, an end-of-life "
                "criterion is met when the bearing is new."
            )
        else:
            wins = [comparison for comparison in comparisons if comparison.winner == winner]
            frictions_by_ratio = _frictions_by_text(
                (_ratio_phrase(win.ratio), win.friction) for win in wins
            )
            margins = ", ".join(f"{ratio} at {mu}" for ratio, mu in frictions_by_ratio.items())
            better = _method_words(winner)
            other = _method_words(wins[0].other_method)
            sentences.append(_sentence(f"{better} gives a longer life than {other}: {margins}"))
    return sentences


def _method_words(method: str) -> str:
    """Returns the words for a preload method, or for a kind of pair with its article."""
    words = name_in_words(method)
    return f"a {words}" if method in PAIRS.values() else words


def _ratio_phrase(ratio: float) -> str:
    """Returns a phrase on how much longer the longer of two lives is.

    ratio: of the longer to the shorter life; inf if the shorter is zero.
    """
    if ratio == math.inf:
        return "the other method gives a life of zero"
    if ratio < 1.1:  # two digits of the ratio would say little
        return f"{percent_in_text(ratio - 1.0)} longer"
    return f"{ratio:.2g} times as long"


def _zero_lives_sentence(lives: Sequence[MethodLife]) -> str:
    """Returns a sentence on where at least one bearing in twenty has no life; empty if nowhere.

    That is, where the lower end of the interval with 90 % of the bearings is a life of 0.
    """
    frictions_by_method = _frictions_by_text(
        (name_in_words(life.method), life.friction)
        for life in lives
        if life.spread and life.spread.bearings.low == 0.0
    )
    if not frictions_by_method:
        return ""
    points = ", ".join(f"{method} at {mu}" for method, mu in frictions_by_method.items())
    return _sentence(
        f"at least one bearing in twenty meets an end-of-life criterion when new: {points}"
    )


def _table_note(lives: Sequence[MethodLife], scene: Mapping[str, Any]) -> str:
    """Returns sentences on what the columns of the table of lives contain."""
    text = f"The lives are based on the wear of {counted_words(scene)}."
    if scene.get("duty"):
        text += (
            " They are lives over the duty; the cases of the study are those of the nominal phase."
        )
    if not any(life.spread for life in lives):
        return f"{text} {_sentence(f'{NO_QUANTILES}; {SEE}')}"
    text += (
        f" {QUOTED_SHARE} of bearings have a life within the interval, which allows for "
        f"all uncertain values in the scene. {causes_sentence(scene)}"
    )
    if not all(life.spread for life in lives):
        text += f" If an interval is missing, {SEE}."
    return text


def _end_sentences(lives: Sequence[MethodLife]) -> list[str]:
    """Returns a sentence on what ends the lives for each group of methods with the same ends."""
    methods_by_text: dict[str, list[str]] = {}
    for method in dict.fromkeys(life.method for life in lives):
        ends = _frictions_by_text(
            (life.end, life.friction) for life in lives if life.method == method
        )
        if len(ends) == 1:
            text = next(iter(ends))
        else:
            text = "; ".join(f"{end} at {frictions}" for end, frictions in ends.items())
        methods_by_text.setdefault(text, []).append(name_in_words(method))
    return [_sentence(f"{' and '.join(names)}: {text}") for text, names in methods_by_text.items()]


def _other_scenes_sentences(lives: Sequence[MethodLife]) -> list[str]:
    """Returns a sentence on the range of lives in other scenes, and one for each result.

    A result is the method with the longer life, that the methods are equal, or that neither can be
    used; its sentence has the number of comparisons with that result.
    """
    comparisons = _comparisons(lives)
    hours = _hours_text([life.hours for life in lives])
    phrases = [f"lives: {hours}, based on the wear that each scene specifies"]
    for winner in dict.fromkeys(comparison.winner for comparison in comparisons):
        count = sum(comparison.winner == winner for comparison in comparisons)
        is_method = winner not in (_EQUAL, _NEITHER)
        result = f"{name_in_words(winner)} gives the longer life" if is_method else winner
        phrases.append(f"{result} in {count} of {len(comparisons)} comparisons")
    return [_sentence(phrase) for phrase in phrases]


def _sentence(text: str) -> str:
    """Returns a text with a capital letter and a full stop."""
    return f"{text[0].upper()}{text[1:]}."


def lives_block(title: str, lives: Sequence[MethodLife], scene: Mapping[str, Any]) -> Block:
    """Returns a table with a line for each life: its hours, spread, end, and numerical error.

    The lives are in the order of their friction coefficients.

    scene: plain data of the scene of the lives.
    """
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
    """Returns the table of `lives_block`, with two more columns.

    They are the total wear depth at the end, and the relative difference of the interpolated life
    from the computed one.
    """
    block = lives_block(title, lives, scene)
    lives = sorted(lives, key=lambda life: life.friction)
    differences = tuple(Rough(100.0 * life.route_difference) for life in lives)
    rows = (
        Row("total wear depth", "um", tuple(life.loss for life in lives), "loss_at_end"),
        Row("difference in the interpolated life", "%", differences, "life_route_difference"),
    )
    return replace(block, rows=(*block.rows, *rows))


def _hours_text(values: Iterable[float]) -> str:
    """Returns the range of lives [h] as text with its unit; a dash if there are none."""
    text = span(map(Rough, values))
    return text if text == "–" else f"{text}\N{NO-BREAK SPACE}h"
