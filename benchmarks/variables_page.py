"""The page of all variables of a case and a life file.

`python benchmarks/variables_page.py docs/variables.md` makes it anew.
"""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Iterable
from pathlib import Path

from bearingwear.kernels.status import STATUS_NAMES, STATUS_SENTENCES
from bearingwear.results.entries import OVER_TURNS
from bearingwear.results.life_variables import GROWN
from bearingwear.results.pair_variables import SYSTEM
from bearingwear.results.variable import Variable
from bearingwear.results.variables import (
    ALWAYS,
    COORDINATES,
    DYNAMIC,
    EXTREMES,
    LIFE,
    STATE,
    STRIP_POSITION,
)

INTRODUCTION = """\
# Variables of a result

<!-- made by `python benchmarks/variables_page.py docs/variables.md` -->

`bearingwear solve` and `life` write these variables; `bearingwear.solve` and `life` return them in
Python. The attributes `long_name` and `units` of each variable give its meaning and unit. This also
applies to the files of studies, whose variables are not listed here. [Conventions](conventions.md)
defines signs and axes. Each item gives the name, (dimensions), [unit] and meaning."""

COORDINATES_SAID = (
    "In files, named coordinates are integers 0, 1, ... with `flag_meanings`; in Python, they are "
    'the names themselves: `case.contact_load.sel(race="inner")`.'
)


def page_of_variables() -> str:
    """The page, in Markdown."""
    others = [variable for name, variable in STATE.items() if name not in ALWAYS]
    grown = GROWN.values()
    of_a_life = [variable for name, variable in LIFE.items() if name not in GROWN]
    coordinates = [*COORDINATES.values(), STRIP_POSITION]
    sections = (
        ("Every case", "Values are NaN if the case was not solved.", ALWAYS.values()),
        ("Cases, depending on the model", "", others),
        (
            "Dynamic cases",
            "Histories contain values at the instants of `time`.",
            DYNAMIC.values(),
        ),
        ("Lives", "Histories contain values at each wear `step`.", of_a_life),
        (
            "Bearings with growth or temperature",
            "Cases and lives may include these variables.",
            grown,
        ),
        (
            "Pairs of bearings",
            "For a pair (`arrangement`), each of these variables has one value for both bearings. "
            "All other variables have `bearing` as their first dimension, except status, life, "
            "the error in the life, and time.",
            SYSTEM.values(),
        ),
        ("Coordinates", COORDINATES_SAID, coordinates),
    )
    parts = [INTRODUCTION]
    for heading, text, variables in sections:
        parts += [f"## {heading}", *filter(None, [textwrap.fill(text, 100)]), _list(variables)]
    statuses = (f"{k} `{name}`: {STATUS_SENTENCES[name]}" for k, name in enumerate(STATUS_NAMES))
    parts += ["## Status", "\n".join(map(_item, statuses))]
    return "\n\n".join(parts) + "\n"


def _list(variables: Iterable[Variable]) -> str:
    return "\n".join(map(_item, map(_sentence, variables)))


def _item(text: str) -> str:
    """An item of a list, in lines of at most 100 columns."""
    return textwrap.fill(text, 100, initial_indent="- ", subsequent_indent="  ")


def _sentence(variable: Variable) -> str:
    meaning = variable.long_name
    if variable.name in EXTREMES and variable.name in DYNAMIC:
        meaning += OVER_TURNS[f"time: {EXTREMES[variable.name]}imum"]
    if variable.flags == STATUS_NAMES:
        meaning += ": see [status](#status)"
    else:
        told = f"; {variable.comment}" if variable.comment else ""
        named = f": {', '.join(variable.flags)}" if variable.flags else ""
        meaning += named + told
    dims = f" ({', '.join(variable.dims)})" if variable.dims else ""
    units = f" [{variable.units}]" if variable.units else ""
    return f"`{variable.name}`{dims}{units}: {meaning}"


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(page_of_variables(), encoding="utf-8")
