"""Why no preload is recommended: which requirements none meets, how near one comes, and where."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bearingwear.kernels.status import OK
from bearingwear.measures import ENDS, LIMITED, plain
from bearingwear.results.units import digits
from bearingwear.results.words import name_in_words
from bearingwear.scene.blocks import CRITERIA
from bearingwear.studies.design.best import NEW_BEARING, PreloadPoint
from bearingwear.studies.design.conditions import DECIDING, condition_words
from bearingwear.studies.design.document.words import limit_text
from bearingwear.studies.design.map import IMPRACTICAL_FLAGS, NOT_SOLVED_AT
from bearingwear.studies.design.plan import DesignLimits

_LIFE = LIMITED["life_h"]
NO_LIFE_SOLVED = "no life could be computed"


def infeasibility_text(
    points: Sequence[PreloadPoint], limits: DesignLimits, has_cases: bool
) -> str:
    """Returns which requirements no preload meets, how near one comes, and in which condition.

    Without a point that was solved, or that has a life, the text says so instead.

    points: solved preloads, none of which is allowed.
    has_cases: whether the scene has several cases, which are then named.
    """
    solved = [point for point in points if point.values["status"] == OK]
    if not solved:
        return f"{NO_LIFE_SOLVED}{_unsolved_words(points, has_cases)}"
    usable = [point for point in solved if _may_live(point)]
    if not usable:
        where = solved[0].values.get(DECIDING, {}).get("life")
        text = "an end-of-life criterion is met when the bearing is new"
        return f"{text} (case {where['case']})" if where and has_cases else text
    if all(point.values.get("impractical") for point in usable):
        return f"the design is impractical at every preload: {_usual_fault(usable)}"
    violations, is_together = least_violations(points, limits)
    if not violations:
        unsolved = _unsolved_words(points, has_cases)
        return f"{NO_LIFE_SOLVED} at a preload that satisfies them{unsolved}"
    without_life = _points_without_life(points, limits)
    introduction = ""
    if is_together and not without_life:
        introduction = (
            "each requirement can be satisfied individually, but not all of them together: "
        )
    phrases = []
    for name, k in violations.items():
        value_text = _value_text(name, points[k], limits, is_together, has_cases)
        if not is_together and points[k].preload == max(point.preload for point in points):
            value_text += ", the largest preload tried"
        value_text += _impractical_words(usable, name, limits)
        phrases.append(f"{_required_text(name, limits)}, but {value_text}")
    return introduction + "; ".join(phrases) + _conflict_with_ends(without_life)


def short_life_text(longest: PreloadPoint, active: str, limits: DesignLimits) -> str:
    """Returns a text on a life that is shorter than required: its length, and what limits it.

    longest: the point with the longest life within the other requirements.
    active: item of `ACTIVE`: what keeps that point from a longer life.
    """
    life = float(_LIFE.shown(longest.life))
    text = (
        f"where the others are satisfied, the life is at most {digits(life)} h "
        f"(at {longest.preload:.7g} N), not {limits.life_h:.7g} h"
    )
    if active not in limits.effective:
        return text
    return f"{text}. A longer life is prevented by {_required_text(active, limits)}"


def _points_without_life(
    points: Sequence[PreloadPoint], limits: DesignLimits
) -> list[PreloadPoint]:
    """Returns points that meet all requirements, but at which a criterion ends the life at once."""
    return [
        point
        for point in points
        if point.values["status"] == OK
        and not _may_live(point)
        and point.end_criterion is not None
        and point.margins(limits)[:-1].min() >= 0.0
    ]


def _conflict_with_ends(points: Sequence[PreloadPoint]) -> str:
    """Returns a phrase on preloads that only an end-of-life criterion rules out; "" without any.

    points: as from `_points_without_life`, rising in preload.
    """
    if not points:
        return ""
    flags = [point.end_criterion for point in points]
    ends = dict.fromkeys(CRITERIA[flag] for flag in flags if flag is not None)
    names = " and ".join(ENDS[name].words for name in ends if name in ENDS)
    low = digits(points[0].preload)
    high = digits(points[-1].preload)
    where = f"at {low} N" if low == high else f"from {low} to {high} N"
    keys = ", ".join(f"wear.end_of_life.{name}" for name in ends)
    return (
        f"; {where}, all requirements are satisfied, but an end-of-life criterion of the scene is "
        f"met when the bearing is new: {names} ({keys})"
    )


def least_violations(
    points: Sequence[PreloadPoint], limits: DesignLimits
) -> tuple[dict[str, int], bool]:
    """Returns the requirements that rule out all preloads, and whether they do so only together.

    If some requirements are met at no preload, the dictionary has these, each with the index of the
    point that comes nearest to it, and the bool is False. Otherwise the bool is True, and the
    dictionary has the requirements that the best point violates, each with the index of that point.
    The best point has the largest least margin, among points with a life if there are any.
    Only practical points count that are of new bearings or have a life; without any, the result is
    empty and False.
    """
    usable = [
        k
        for k, point in enumerate(points)
        if point.values["status"] == OK and _may_live(point) and not point.values.get("impractical")
    ]
    if not usable:
        return {}, False
    margins = np.array([points[k].margins(limits)[:-1] for k in usable])
    # margins are infinite for measures of a life, which new bearings do not have
    margins = np.where(np.isinf(margins), -np.inf, margins)
    nearest = margins.argmax(axis=0)
    never_met = {
        name: usable[nearest[k]]
        for k, name in enumerate(limits.effective)
        if -np.inf < margins[nearest[k], k] < 0.0
    }
    if never_met:
        return never_met, False
    with_life = [k for k in range(len(usable)) if points[usable[k]].solved != NEW_BEARING]
    candidates = with_life or [*range(len(usable))]
    best = candidates[int(margins[candidates].min(axis=1).argmax())]
    violated = {
        name: usable[best]
        for k, name in enumerate(limits.effective)
        if -np.inf < margins[best, k] < 0.0
    }
    return violated, True


def _impractical_words(points: Sequence[PreloadPoint], name: str, limits: DesignLimits) -> str:
    """Returns a phrase on the impractical designs that meet a requirement, with their usual fault.

    It is empty if no impractical design meets the requirement.

    name: of the measure, a key of `LIMITED`.
    """
    index = list(limits.effective).index(name)
    impractical = [
        point
        for point in points
        if point.values.get("impractical") and point.margins(limits)[index] >= 0.0
    ]
    if not impractical:
        return ""
    return f", as every preload that meets it is an impractical design: {_usual_fault(impractical)}"


def _usual_fault(points: Sequence[PreloadPoint]) -> str:
    """Returns the warning that most of some impractical designs have, in words."""
    flags = [int(point.values["impractical"]) for point in points]
    return name_in_words(IMPRACTICAL_FLAGS[max(flags, key=flags.count)])


def _may_live(point: PreloadPoint) -> bool:
    """Returns whether a point has a life above zero, or is of new bearings alone."""
    return point.solved == NEW_BEARING or point.life > 0.0


def _required_text(name: str, limits: DesignLimits) -> str:
    """Returns a requirement in words, with its limit.

    If the limit on the preload kept was not given, the words say that no bearing lifts off.

    name: of the measure, a key of `LIMITED`.
    """
    text = limit_text(name, limits.effective[name])
    return text if name in limits.given else f"no bearing lifts off ({text})"


def _value_text(
    name: str, point: PreloadPoint, limits: DesignLimits, is_together: bool, has_cases: bool
) -> str:
    """Returns a text on the worst value of a measure at a preload, and on the condition with it.

    name: of the measure, a key of `LIMITED`.
    is_together: whether other preloads meet the requirement; otherwise "at most" or "at least"
        precedes the value.
    has_cases: whether to name the case.
    """
    measure = LIMITED[name]
    worst = float(measure.shown(measure.worst(point.values)))
    required = plain(float(measure.shown_limit(limits.effective[name])), 7)
    digit_count = 3
    while digit_count < 7 and plain(worst, digit_count) == required:
        digit_count += 1  # rounded to fewer digits, it would be what is required
    text = plain(worst, digit_count)
    side = "" if is_together else f"at {'most' if measure.falls else 'least'} "
    return f"{side}{text} at {digits(point.preload)} N{_where_words(point.values, name, has_cases)}"


def _where_words(values: Mapping[str, Any], name: str, has_cases: bool) -> str:
    """Returns the condition in which a measure is the worst, in brackets.

    It is empty if the condition is not known, and for a measure that does not depend on the speed.

    values: of a design point.
    name: of the measure, a key of `LIMITED`.
    has_cases: whether to name the case.
    """
    measure = LIMITED[name]
    if not measure.of_speed:
        return ""
    _, extreme = measure.critical_extreme(lambda key: values.get(key, math.nan))
    condition = values.get(DECIDING, {}).get(extreme)
    return f" ({condition_words(condition, has_cases)})" if condition else ""


def _unsolved_words(points: Sequence[PreloadPoint], has_cases: bool) -> str:
    """Returns the condition in which most points were not solved, and why, in brackets.

    It is empty if no such condition is known.

    has_cases: whether to name the case.
    """
    phrases = []
    for point in points:
        where = point.values.get(NOT_SOLVED_AT)
        if where:
            status_words = name_in_words(where["status"])
            phrases.append(f"{condition_words(where, has_cases)}: {status_words}")
    return f" ({max(phrases, key=phrases.count)})" if phrases else ""
