"""Why no preload is recommended: which requirements none meets, how near one comes, and where."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.measures import LIMITED
from bearingwear.results.units import digits
from bearingwear.results.words import name_in_words
from bearingwear.studies.design.best import NEW_BEARING, PreloadPoint
from bearingwear.studies.design.conditions import DECIDING, condition_words
from bearingwear.studies.design.document.words import limit_text
from bearingwear.studies.design.map import NOT_SOLVED_AT
from bearingwear.studies.design.plan import DesignLimits

NO_LIFE_SOLVED = "no life could be computed"


def why_none(order: Sequence[PreloadPoint], limits: DesignLimits, cases: bool) -> str:
    """Which requirements no preload meets, how near one comes, and where.

    cases: whether the scene has several, which are then named.
    """
    solved = [one for one in order if one.values["status"] == OK]
    if not solved:
        return f"{NO_LIFE_SOLVED}{_unsolved_words(order, cases)}"
    usable = [one for one in solved if _may_live(one)]
    if not usable:
        where = solved[0].values.get(DECIDING, {}).get("life")
        at_once = "an end-of-life criterion is met when the bearing is new"
        return f"{at_once} (case {where['case']})" if where and cases else at_once
    if all(one.values.get("impractical") for one in usable):
        return "the design is impractical at every preload"
    failed, is_together = least_violations(order, limits)
    if not failed:
        return f"{NO_LIFE_SOLVED} at a preload that satisfies them{_unsolved_words(order, cases)}"
    before, but = "", "at best "
    if is_together:
        before = "each requirement can be satisfied individually, but not all of them together: "
        but = "but "
    return before + "; ".join(
        f"{_required_text(name, limits)}, {but}"
        f"{digits(float(LIMITED[name].shown(LIMITED[name].worst(order[k].values))))} "
        f"at {digits(order[k].preload)} N{_where_words(order[k].values, name, cases)}"
        for name, k in failed.items()
    )


def least_violations(
    order: Sequence[PreloadPoint], limits: DesignLimits
) -> tuple[dict[str, int], bool]:
    """Requirements that no preload meets, each with the number of the point that comes nearest.

    Where each is met somewhere, those that are violated where all together are violated the least:
    by worn bearings if any preload is allowed new, because wear is then what rules it out.
    Returns the requirements, each with the number of its point, and whether they are such.
    """
    usable = [
        k
        for k, one in enumerate(order)
        if one.values["status"] == OK and _may_live(one) and not one.values.get("impractical")
    ]
    if not usable:
        return {}, False
    margin = np.array([order[k].margins(limits)[:-1] for k in usable])
    # new bearings alone say nothing of a life
    margin = np.where(np.isinf(margin), -np.inf, margin)
    nearest = margin.argmax(axis=0)
    failed = {
        name: usable[nearest[k]]
        for k, name in enumerate(limits.held)
        if -np.inf < margin[nearest[k], k] < 0.0
    }
    if failed:
        return failed, False
    worn = [k for k in range(len(usable)) if order[usable[k]].solved != NEW_BEARING]
    together = worn or [*range(len(usable))]
    best = together[int(margin[together].min(axis=1).argmax())]
    violated = {
        name: usable[best] for k, name in enumerate(limits.held) if -np.inf < margin[best, k] < 0.0
    }
    return violated, True


def _may_live(one: PreloadPoint) -> bool:
    return one.solved == NEW_BEARING or one.life > 0.0


def _required_text(name: str, limits: DesignLimits) -> str:
    """A requirement in words, and what for if nobody asked for it."""
    text = limit_text(name, limits.held[name])
    return text if name in limits.given else f"no bearing lifts off ({text})"


def _where_words(point: Mapping[str, Any], name: str, cases: bool) -> str:
    """Where a measure is the worst, after its value."""
    measure, deciding = LIMITED[name], point.get(DECIDING, {})
    known = [deciding[one] for one in measure.extremes if one in deciding]
    if not known or not measure.of_speed:
        return ""
    worst = (min if measure.falls else max)(known, key=lambda one: abs(one["value"]))
    return f" ({condition_words(worst, cases)})"


def _unsolved_words(order: Sequence[PreloadPoint], cases: bool) -> str:
    """Where most of some points were not solved, and why; nothing where no point says so."""
    words = [
        f"{condition_words(one, cases)}: {name_in_words(one.get('status', STATUS_NAMES[OK]))}"
        for point in order
        if (one := point.values.get(NOT_SOLVED_AT))
    ]
    return f" ({max(words, key=words.count)})" if words else ""
