"""Reads the warnings in the attributes of results and files, merges them, and states them.

`bearingwear.solvers.effects.table` determines when a warning is given.
"""

import json
from collections.abc import Iterable, Mapping
from typing import Any

WARNING = "warning: "
"""The start of a line about a warning."""


def warnings_in(attributes: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Returns the warnings in the global attributes of a result or of a file.

    Each has an `id`, a `sentence`, an `advice`, and an `excess` over its limit, which may be None.
    In a file of several cases, `cases` is the number of cases with the warning.
    """
    warnings: list[dict[str, Any]] = json.loads(attributes.get("warnings", "[]"))
    return warnings


def merged_warnings(attributes: Iterable[Mapping[str, Any]]) -> str:
    """Returns the attribute `warnings` of a file of many results, as JSON.

    It has one warning of each id, the one of the largest excess, and the number of cases with that
    id. An excess of None counts as 0, and among equal ones the first warning is kept.

    attributes: of each result.
    """
    worst: dict[str, dict[str, Any]] = {}
    for result_attributes in attributes:
        for warning in warnings_in(result_attributes):
            previous = worst.get(warning["id"], warning | {"cases": 0})
            cases = previous["cases"] + warning.get("cases", 1)
            is_worse = (warning["excess"] or 0.0) > (previous["excess"] or 0.0)
            worst[warning["id"]] = (warning if is_worse else previous) | {"cases": cases}
    return json.dumps(list(worst.values()))


def warning_lines(attributes: Mapping[str, Any]) -> list[str]:
    """Returns a line for each warning in the attributes of a result or of a file."""
    return [warning_line(warning) for warning in warnings_in(attributes)]


def warning_line(warning: Mapping[str, Any]) -> str:
    """Returns a warning as text, with the number of cases that have it if there are several."""
    cases = warning.get("cases", 1)
    count = f"{cases} cases, at worst: " if cases > 1 else ""
    return f"{WARNING}{count}{warning['sentence']}; {warning['advice']}"
