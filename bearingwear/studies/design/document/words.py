"""Requirements of the design study and what determines a preload, in words."""

import json
from collections.abc import Callable
from typing import Any

from bearingwear.kernels.status import OK
from bearingwear.measures import ENDS, LIMITED, Measure
from bearingwear.results.units import printed_unit

LIMIT_WORDS = {name: one.words for name, one in LIMITED.items()} | {
    "none": "no requirement: longest life",
    "end_of_range": "no requirement",
    "not_solved": "a neighbouring point without a solution",
    "no_preload_within_limits": "no preload satisfies all requirements",
    "end_of_life": "a switch to another end-of-life criterion",
    "impractical": "a warning: impractical design",
}
"""What keeps a preload from one with a longer life."""


def held_words(name: str, extremes: Callable[[str], Any]) -> str:
    """What keeps a preload from a longer life, and which of its kinds by the extremes there."""
    one = LIMITED.get(name)
    if one is None:
        return LIMIT_WORDS[name]
    value, which = one.critical_extreme(extremes)
    return one.words_of(which, short=True) if value == value else one.short


def ending_measure(one: Any) -> Measure | None:
    """The criterion that determines the end of life of a point; None where it is not known."""
    criterion = one["end_criterion"]
    name = criterion.attrs["flag_meanings"].split()[int(criterion)]
    return ENDS.get(name) if int(one["status"]) == OK else None


def limit_text(name: str, value: float) -> str:
    """A requirement in words."""
    one = LIMITED[name]
    side = "at least" if one.falls else "at most"
    unit = "" if one.unit == "1" else f" {printed_unit(one.unit)}"
    return f"{one.words} {side} {one.shown_limit(value):g}{unit}"


_AT_END = {"residual_preload_at_end": ("residual preload at end of life", "")}

RECOMMENDED_WORDS = {
    name: (" ".join(filter(None, (one.worst_word, one.kinds[k], one.short))), one.shown_as)
    for one in LIMITED.values()
    for k, name in enumerate(one.extremes)
} | _AT_END
"""Quantities beside a recommended life, and how they are shown where the unit does not say."""


NONE_BECAUSE = "none_because"
"""Attribute of a recommendation: for each method without a preload, why it has none."""

NO_LIMIT = "no requirement was given"
"""Why, where there is nothing to choose by."""

AS_LITTLE = f"{NO_LIMIT}; the lowest preload gives the longest life"
"""What there is to say without a requirement, in a headline."""

WHAT_LIMITS = (
    "Without a requirement, the lowest preload always causes the least wear. State what the "
    "machine requires, such as a minimum stiffness, and what the bearing can withstand, such as a "
    "maximum pressure. Only preloads that satisfy these requirements are then considered."
)
"""What a requirement does, where none was given."""


def without_limits(attribute: str) -> tuple[str, str]:
    """A headline where no requirement was given, and what one would do; of `NONE_BECAUSE`."""
    none = json.loads(attribute)
    if NO_LIMIT in none.values():
        return AS_LITTLE, WHAT_LIMITS
    return f"{NO_LIMIT}; {'; '.join(dict.fromkeys(none.values()))}", ""


GROOVE_WORDS = {"hertzian": "Hertzian", "worn": "worn"}
"""Groove models of lives."""

HERTZIAN_LIFE_WORDS = "with a Hertzian groove"
