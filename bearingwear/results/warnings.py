"""The warnings in the attributes of results and files: read, counted over many, as lines of text.

What is warned of is decided in `bearingwear.solvers.effects.table`.
"""

import json
from collections.abc import Iterable, Mapping
from typing import Any

WARNING = "warning: "
"""How a line about a warning begins."""


def warnings_in(attributes: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The warnings in the global attributes of a result or of a file."""
    found: list[dict[str, Any]] = json.loads(attributes.get("warnings", "[]"))
    return found


def gathered_warnings(attributes: Iterable[Mapping[str, Any]]) -> str:
    """The attribute `warnings` of many results together: the worst of each id, and its `cases`."""
    worst: dict[str, dict[str, Any]] = {}
    for one in (one for each in attributes for one in warnings_in(each)):
        known = worst.setdefault(one["id"], one | {"cases": 0})
        cases = known["cases"] + one.get("cases", 1)
        if (one["excess"] or 0.0) > (known["excess"] or 0.0):
            known = one
        worst[one["id"]] = known | {"cases": cases}
    return json.dumps(list(worst.values()))


def warning_lines(attributes: Mapping[str, Any]) -> list[str]:
    """A line for each warning in the attributes of a result or of a file."""
    return [warning_line(one) for one in warnings_in(attributes)]


def warning_line(one: Mapping[str, Any]) -> str:
    """A warning as text; if many results share it, the worst."""
    cases = one.get("cases", 1)
    where = f"{cases} cases, at worst: " if cases > 1 else ""
    return f"{WARNING}{where}{one['sentence']}; {one['advice']}"
