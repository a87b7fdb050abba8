"""Requirements of the design study in words, and what limits a recommended preload."""

import json
import math
from collections.abc import Callable
from typing import Any

from bearingwear.kernels.status import OK
from bearingwear.measures import ENDS, LIMITED, Measure
from bearingwear.results.units import printed_unit

LIMIT_WORDS = {name: measure.words for name, measure in LIMITED.items()} | {
    "none": "no requirement: longest life",
    "end_of_range": "no requirement",
    "not_solved": "a neighbouring point without a solution",
    "no_preload_within_limits": "no preload satisfies all requirements",
    "end_of_life": "a switch to another end-of-life criterion",
    "impractical": "a warning: impractical design",
}
"""What keeps a preload from one with a longer life, by the names of `choice.ACTIVE`."""


def active_limit_words(name: str, extremes: Callable[[str], Any]) -> str:
    """Returns the words for what keeps a preload from a longer life.

    For a limited measure, they name the extreme that decides, if its value is known.

    name: of `LIMIT_WORDS`.
    extremes: function from the name of an extreme to its value at the preload.
    """
    measure = LIMITED.get(name)
    if measure is None:
        return LIMIT_WORDS[name]
    value, extreme = measure.critical_extreme(extremes)
    return measure.short if math.isnan(value) else measure.words_of(extreme, short=True)


def ending_measure(point: Any) -> Measure | None:
    """Returns the measure that ends a life; None if it was not solved or no criterion ends it.

    point: dataset of a single life.
    """
    criterion = point["end_criterion"]
    name = criterion.attrs["flag_meanings"].split()[int(criterion)]
    return ENDS.get(name) if int(point["status"]) == OK else None


def limit_text(name: str, value: float) -> str:
    """Returns a requirement in words, such as "contact pressure at most 1.5 GPa".

    name: key of `LIMITED`, in whose unit the value is.
    """
    measure = LIMITED[name]
    side = "at least" if measure.falls else "at most"
    unit = "" if measure.unit == "1" else f" {printed_unit(measure.unit)}"
    return f"{measure.words} {side} {measure.shown_limit(value):g}{unit}"


_AT_END = {"residual_preload_at_end": ("residual preload at end of life", "")}

RECOMMENDED_WORDS = {
    name: (" ".join(filter(None, (measure.worst_word, kind, measure.short))), measure.shown_as)
    for measure in LIMITED.values()
    for name, kind in zip(measure.extremes, measure.kinds, strict=True)
} | _AT_END
"""Quantities beside a recommended life, and how they are shown where the unit does not say."""


NONE_BECAUSE = "none_because"
"""Attribute of a recommendation: for each method without a preload, why it has none."""

NO_LIMIT = "no requirement was given"
"""Reason for no preload where there is nothing to choose by."""

AS_LITTLE = f"{NO_LIMIT}; as a rule, less preload gives a longer life"
"""Headline without a requirement."""

WHAT_LIMITS = (
    "Without a requirement, the lowest preload always causes the least wear. State what the "
    "machine requires, such as a minimum stiffness, and what the bearing can withstand, such as a "
    "maximum pressure. Only preloads that satisfy these requirements are then considered."
)
"""Advice where no requirement was given."""


def no_requirement_words(reasons_json: str) -> tuple[str, str]:
    """Returns a headline and advice for a recommendation without a requirement.

    If the reasons are other than `NO_LIMIT`, the headline has these, and the advice is empty.

    reasons_json: attribute `NONE_BECAUSE` of the recommendation.
    """
    reasons = dict.fromkeys(json.loads(reasons_json).values())
    if NO_LIMIT in reasons:
        return AS_LITTLE, WHAT_LIMITS
    return f"{NO_LIMIT}; {'; '.join(reasons)}", ""


GROOVE_WORDS = {"hertzian": "Hertzian", "worn": "worn"}
"""Words for the groove models of lives."""

HERTZIAN_LIFE_WORDS = "with a Hertzian groove"
