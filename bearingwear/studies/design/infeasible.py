"""Why no preload is recommended: which requirements none meets, how near one comes, and where."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.measures import ENDS, LIMITED, plain
from bearingwear.results.units import digits
from bearingwear.results.words import name_in_words
from bearingwear.scene.blocks import CRITERIA
from bearingwear.studies.design.best import NEW_BEARING, PreloadPoint
from bearingwear.studies.design.conditions import DECIDING, condition_words
from bearingwear.studies.design.document.words import limit_text
from bearingwear.studies.design.map import NOT_SOLVED_AT
from bearingwear.studies.design.plan import DesignLimits

_LIFE = LIMITED["life_h"]
NO_LIFE_SOLVED = "no life could be computed"


def why_none(points: Sequence[PreloadPoint], limits: DesignLimits, has_cases: bool) -> str:
    """Returns which requirements no preload meets, how near one comes, and where.

    has_cases: whether the scene has several, which are then named.
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
        return "the design is impractical at every preload"
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
    text = introduction + "; ".join(
        f"{_required_text(name, limits)}, but "
        f"{_value_text(name, points[k], limits, is_together, has_cases)}"
        for name, k in violations.items()
    )
    return text + _conflict_with_ends(without_life)


def life_too_short(longest: PreloadPoint, active: str, limits: DesignLimits) -> str:
    """Returns that the life is shorter than required, by how much, and what it is limited by.

    longest: the point with the longest life within the other requirements.
    active: what keeps it from a longer life, an item of `ACTIVE`.
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
    """Returns at which preloads only a criterion stands against the requirements; "" at none."""
    if not points:
        return ""
    ends = dict.fromkeys(CRITERIA[point.end_criterion or 0] for point in points)
    names = " and ".join(ENDS[name].words for name in ends if name in ENDS)
    low, high = (digits(points[k].preload) for k in (0, -1))
    where = f"at {low} N" if low == high else f"from {low} to {high} N"
    keys = ", ".join(f"wear.end_of_life.{name}" for name in ends)
    return (
        f"; {where}, all requirements are satisfied, but an end-of-life criterion of the scene is "
        f"met when the bearing is new: {names} ({keys})"
    )


def least_violations(
    points: Sequence[PreloadPoint], limits: DesignLimits
) -> tuple[dict[str, int], bool]:
    """Returns requirements that no preload meets, each with the number of the nearest point.

    Where each is met somewhere, these are those violated by the point that violates all of them
    together the least: a worn one if any preload is allowed new, because wear then rules it out.

    Returns: the requirements with the numbers of points, and whether each is met somewhere.
    """
    usable = [
        k
        for k, point in enumerate(points)
        if point.values["status"] == OK and _may_live(point) and not point.values.get("impractical")
    ]
    if not usable:
        return {}, False
    margins = np.array([points[k].margins(limits)[:-1] for k in usable])
    # new bearings alone say nothing of a life
    margins = np.where(np.isinf(margins), -np.inf, margins)
    nearest = margins.argmax(axis=0)
    never_met = {
        name: usable[nearest[k]]
        for k, name in enumerate(limits.effective)
        if -np.inf < margins[nearest[k], k] < 0.0
    }
    if never_met:
        return never_met, False
    worn = [k for k in range(len(usable)) if points[usable[k]].solved != NEW_BEARING]
    candidates = worn or [*range(len(usable))]
    best = candidates[int(margins[candidates].min(axis=1).argmax())]
    violated = {
        name: usable[best]
        for k, name in enumerate(limits.effective)
        if -np.inf < margins[best, k] < 0.0
    }
    return violated, True


def _may_live(point: PreloadPoint) -> bool:
    """Whether a point has a life, or new bearings do not rule one out."""
    return point.solved == NEW_BEARING or point.life > 0.0


def _required_text(name: str, limits: DesignLimits) -> str:
    """Returns a requirement in words, and what for if nobody asked for it."""
    text = limit_text(name, limits.effective[name])
    return text if name in limits.given else f"no bearing lifts off ({text})"


def _value_text(
    name: str, point: PreloadPoint, limits: DesignLimits, is_together: bool, has_cases: bool
) -> str:
    """Returns the worst value of a measure at a preload, and where it is.

    is_together: whether other preloads meet the requirement.
    """
    measure = LIMITED[name]
    worst = float(measure.shown(measure.worst(point.values)))
    # more digits where it rounds to what is required
    required = plain(float(measure.shown_limit(limits.effective[name])), 7)
    texts = (plain(worst, count) for count in range(3, 8))
    text = next((text for text in texts if text != required), plain(worst, 7))
    side = "" if is_together else f"at {'most' if measure.falls else 'least'} "
    return f"{side}{text} at {digits(point.preload)} N{_where_words(point.values, name, has_cases)}"


def _where_words(values: Mapping[str, Any], name: str, has_cases: bool) -> str:
    """Returns where a measure is the worst; empty where that is not known."""
    measure, deciding = LIMITED[name], values.get(DECIDING, {})
    conditions = [deciding[extreme] for extreme in measure.extremes if extreme in deciding]
    if not conditions or not measure.of_speed:
        return ""
    worst = (min if measure.falls else max)(conditions, key=lambda where: abs(where["value"]))
    return f" ({condition_words(worst, has_cases)})"


def _unsolved_words(points: Sequence[PreloadPoint], has_cases: bool) -> str:
    """Returns where most of some points were not solved, and why; empty where none says so."""
    conditions = [where for point in points if (where := point.values.get(NOT_SOLVED_AT))]
    words = [
        f"{condition_words(where, has_cases)}: "
        f"{name_in_words(where.get('status', STATUS_NAMES[OK]))}"
        for where in conditions
    ]
    return f" ({max(words, key=words.count)})" if words else ""
