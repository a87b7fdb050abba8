"""The answer of a study: which preload method lasts longest, how long, and what ends the life."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import xarray as xr

from bearingwear.kernels.status import CRITERION_NOT_REACHED, OK, STATUS_NAMES
from bearingwear.plotting.drawing import in_words, methods, mu_is, percent_in_text, scene_of
from bearingwear.results.quantiles import (
    NO_QUANTILES,
    QUANTILES_TEXT,
    SEE,
    Quantiles,
    hours_of,
    quantiles_of,
    quantiles_text,
)
from bearingwear.results.units import span
from bearingwear.scene.scene import COUNTS

ENDS = {  # words for a criterion, and by how much its limit in the scene is multiplied
    "preload_fraction": ("residual preload down to {:g}\N{NO-BREAK SPACE}%", 100.0),
    "gyroscopic_slip_share": ("gyroscopic share of slip up to {:g}\N{NO-BREAK SPACE}%", 100.0),
    "skid_ratio": ("skid ratio up to {:g}\N{NO-BREAK SPACE}%", 100.0),
    "ball_diameter_loss_um": ("{:g}\N{NO-BREAK SPACE}µm of ball diameter lost", 1.0),
}
WORDS = {"ball_and_races": "balls and races", "ball": "the balls alone"}
NO_END = "no end of life is met"


class Life(NamedTuple):
    """The wear life of one scene, preload method and friction coefficient."""

    scene: str
    method: str
    friction: float
    hours: dict[str, float]  # by what counts as wear; nan where there is none
    counts: str  # what counts in the scene
    error: float  # estimate of the relative numerical error, nan if not known
    end: str  # in words; the status where it was not solved
    spread: Quantiles | None = None  # L10 and L50, by what counts as wear

    @property
    def counted(self) -> float:
        """Life in the scene's own way of counting wear [h]."""
        return self.hours[self.counts]


def lives_of(dataset: xr.Dataset, known: Sequence[xr.Dataset] = ()) -> list[Life]:
    """Every life in a file of `bearingwear wear-life`.

    `known` are files of the study of uncertainty, if there are any.
    """
    scene = scene_of(dataset)
    wear = scene.get("wear", {})
    limits = wear.get("end_of_life") or {}
    ways = [COUNTS[int(flag)] for flag in dataset["counts"].values]
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
                words, factor = ENDS[criterion]
                end = words.format(factor * limits[criterion])
            counts = wear.get("counts", COUNTS[-1])
            error = one.get("life_error_estimate", one["life"] * math.nan)
            found.append(
                Life(
                    scene["name"],
                    method,
                    mu,
                    dict(zip(ways, one["life"].values.tolist(), strict=True)),
                    counts,
                    float(error[ways.index(counts)]),
                    end,
                    quantiles_of(known, scene, method, mu),
                )
            )
    return found


@dataclass(frozen=True)
class Answer:
    """The answer of a study, in sentences; the first scene is what it is about."""

    headline: str
    facts: list[tuple[str, list[str]]]  # question and sentences
    rows: list[dict[str, str]]  # one for each friction and method of the first scene


def answer(lives: Sequence[Life]) -> Answer | None:
    """What a study says about preload, or None if it has no lives.

    Two methods whose lives differ by less than their estimated numerical errors together count as
    equal.
    """
    if not lives:
        return None
    name = lives[0].scene
    here = [life for life in lives if life.scene == name]
    others = [life for life in lives if life.scene != name]
    facts = [("How long", _how_long(here)), ("What ends it", _what_ends(here))]
    contests = _contests(here)
    if contests:
        facts.insert(0, ("Which preload method", _verdicts(contests)))
    facts.append(("How sure that is", _how_sure(here)))
    if others:
        facts.append(("On the other bearings", _elsewhere(others)))
    facts.append(
        (
            "How much preload",
            ["Not varied in this study; bearingwear recommend finds one in seconds."],
        )
    )
    rows = [_row(life, lives) for life in sorted(here, key=lambda life: life.friction)]
    return Answer(_headline(name, here, contests), facts, rows)


class _Contest(NamedTuple):
    """Both methods at one friction coefficient of a scene."""

    friction: float
    longest: str | None  # None: equal
    other: str
    ratio: float  # longer life over the shorter


def _contests(lives: Iterable[Life]) -> list[_Contest]:
    by_point: dict[tuple[str, float], list[Life]] = {}
    for life in lives:
        if math.isfinite(life.counted):
            by_point.setdefault((life.scene, life.friction), []).append(life)
    found = []
    for (_, mu), pair in by_point.items():
        if len(pair) > 1:
            short, long = sorted(pair, key=lambda life: life.counted)
            ratio = math.inf if long.counted > 0.0 else 1.0  # where the other has no life at all
            if short.counted > 0.0:
                ratio = long.counted / short.counted
            errors = sum(life.error for life in pair if math.isfinite(life.error))
            found.append(
                _Contest(mu, long.method if ratio - 1.0 > errors else None, short.method, ratio)
            )
    return found


def _headline(name: str, lives: Sequence[Life], contests: Sequence[_Contest]) -> str:
    if not any(math.isfinite(life.counted) for life in lives):
        return f"{name}: no end of life was found"
    winners = {contest.longest for contest in contests}
    if not winners:
        return f"{name}: life with {' and '.join(_distinct(lives, 'method'))}"
    if winners == {None}:
        return f"{name}: both preload methods last equally long"
    if len(winners) == 1:
        return f"{name}: {in_words(str(*winners))} lasts longest"
    return f"{name}: which preload lasts longest depends on friction"


def _distinct(lives: Iterable[Life], what: str) -> list[str]:
    return list(dict.fromkeys(in_words(str(getattr(life, what))) for life in lives))


def _verdicts(contests: Sequence[_Contest]) -> list[str]:
    said = []
    for winner in dict.fromkeys(contest.longest for contest in contests):
        won = [contest for contest in contests if contest.longest == winner]
        if winner is None:
            at = ", ".join(mu_is(contest.friction) for contest in won)
            said.append(f"No difference beyond the numerical error at {at}.")
            continue
        margins = ", ".join(f"{_margin(c.ratio)} at {mu_is(c.friction)}" for c in won)
        said.append(_sentence(f"{in_words(winner)} outlasts {in_words(won[0].other)}: {margins}"))
    return said


def _margin(ratio: float) -> str:
    if ratio == math.inf:
        return "it alone is within the limits when new"
    if ratio < 1.1:
        return f"by {percent_in_text(ratio - 1.0)}"
    return f"{ratio:.2g} times as long"


def _how_long(lives: Sequence[Life]) -> list[str]:
    counts = lives[0].counts
    said = [
        f"{_hours([life.hours[way] for life in lives])} if the wear of {WORDS[way]} counts"
        for way in sorted(WORDS, key=lambda way: way != counts)
    ]
    spread = ", over the methods and frictions studied" if len(lives) > 1 else ""
    errors = [life.error for life in lives if math.isfinite(life.error)]
    return [
        _sentence("; ".join(said) + spread),
        *([f"Numerical error: {percent_in_text(max(errors))} at most."] if errors else []),
    ]


def _how_sure(lives: Sequence[Life]) -> list[str]:
    """Ranges of L10 and L50 where they were computed; the table has each."""
    counts = lives[0].counts
    said = []
    for way in sorted(WORDS, key=lambda way: way != counts):
        known = hours_of((life.spread for life in lives), way)
        ranges = ", ".join(f"{name}\N{NO-BREAK SPACE}{_hours(h)}" for name, h in known.items())
        said += [_sentence(f"{ranges} if the wear of {WORDS[way]} counts")] if known else []
    at_once = [
        f"{in_words(life.method)} at {mu_is(life.friction)}"
        for life in lives
        if life.spread and any(one.hours == 0.0 for one in life.spread[counts])
    ]
    if at_once:
        said.append(
            _sentence(f"one in ten or more is beyond a limit when new: {', '.join(at_once)}")
        )
    if said:
        said.append(QUANTILES_TEXT)
    if not all(life.spread for life in lives):
        said.append(_sentence(f"{NO_QUANTILES}{' for the others' if said else ''}, {SEE}"))
    return said


def _what_ends(lives: Sequence[Life]) -> list[str]:
    said = []
    for method in dict.fromkeys(life.method for life in lives):
        of_method = [life for life in lives if life.method == method]
        ends: dict[str, list[str]] = {}
        for life in of_method:
            ends.setdefault(life.end, []).append(mu_is(life.friction))
        text = "; ".join(
            end + (f" at {', '.join(where)}" if len(ends) > 1 else "")
            for end, where in ends.items()
        )
        said.append(_sentence(f"{in_words(method)}: {text}"))
    return said


def _elsewhere(lives: Sequence[Life]) -> list[str]:
    contests = _contests(lives)
    said = [f"{_hours([life.counted for life in lives])}, each in its scene's way of counting wear"]
    for winner in dict.fromkeys(contest.longest for contest in contests):
        count = sum(contest.longest == winner for contest in contests)
        name = f"{in_words(winner)} lasts longer" if winner else "the methods are equal"
        said.append(f"{name} in {count} of {len(contests)} comparisons")
    return [_sentence(text) for text in said]


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


def _row(life: Life, lives: Sequence[Life]) -> dict[str, str]:
    """Life of one point, and its range over all scenes that have this method and friction."""
    twins = [one for one in lives if (one.method, one.friction) == (life.method, life.friction)]
    row = {"friction": f"{life.friction:g}", "preload method": in_words(life.method)}
    for way, words in (("ball_and_races", "balls and races"), ("ball", "ball alone")):
        row[f"life, {words}"] = _hours([life.hours[way]])
        row[f"spread, {words}"] = quantiles_text((life.spread or {}).get(way, ()))
        if len({one.scene for one in lives}) > 1:
            row[f"{words}, all bearings"] = _hours([one.hours[way] for one in twins])
    return row | {"numerical error": percent_in_text(life.error), "ended by": life.end}


def _hours(values: Iterable[float]) -> str:
    """Least and most of some lives; a dash if there is none."""
    text = span(values)
    return text if text == "–" else f"{text}\N{NO-BREAK SPACE}h"
