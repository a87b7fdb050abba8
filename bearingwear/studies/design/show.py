"""The sheet of a recommendation: the preload to take by each method, and what holds it."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from bearingwear.results.rows import values
from bearingwear.results.sheet import Block, Row, Sheet
from bearingwear.results.units import display, in_ascii
from bearingwear.results.warnings import WARNING, warning_lines, wrapped_warnings
from bearingwear.scene.scene import COUNTS
from bearingwear.studies.design.words import (
    LIMIT_WORDS,
    NONE_BECAUSE,
    RECOMMENDED_WORDS,
    limit_text,
)


def recommendation_sheet(file: Any) -> Sheet:
    """What to take, a column for each preload method."""
    scene = json.loads(file.scene)
    names = file["preload_method"].flag_meanings.split()
    columns = tuple(names[int(flag)].replace("_", " ") for flag in values(file, "preload_method"))
    lives = values(file, "life")
    rows = [
        Row("initial preload", "N", _preloads(file), "preload", given=True),
        Row("held by", "", tuple(_held(file)), "active_limit"),
        *(
            Row(f"life, {way.replace('_and_', ' + ')}", "h", tuple(lives[:, k].tolist()), "life")
            for k, way in enumerate(COUNTS)
        ),
        *(_row(file, name, *words) for name, words in RECOMMENDED_WORDS.items()),
    ]
    given = json.loads(getattr(file, "limits", "{}"))
    limits = [in_ascii(limit_text(name, value)) for name, value in given.items() if value]
    rows = [row._replace(values=tuple(map(_known, row.values))) for row in rows]
    none = json.loads(getattr(file, NONE_BECAUSE, "{}"))
    heading = (
        f"{scene['name']}: {getattr(file, 'title', 'recommended preload').lower()} "
        f"at {scene['operation']['shaft_speed_rpm']:g} r/min, "
        f"friction {scene['friction']['ball_race']:g}",
        *(f"limit: {text}" for text in limits),
        *(
            f"none within the limits, {method.replace('_', ' ')}: {in_ascii(why)}"
            for method, why in none.items()
        ),
    )
    attributes = {"warnings": getattr(file, "warnings", "[]")}
    heading += tuple(wrapped_warnings(attributes))
    facts = {"kind": "recommendation", "scene": scene["name"], "limits": limits, NONE_BECAUSE: none}
    facts["warnings"] = [line.removeprefix(WARNING) for line in warning_lines(attributes)]
    return Sheet(heading, facts, (Block("recommended", columns, tuple(rows)),))


def _held(file: Any) -> list[str]:
    names = file["active_limit"].flag_meanings.split()
    return [LIMIT_WORDS[names[int(flag)]] for flag in values(file, "active_limit")]


def _preloads(file: Any) -> tuple[float, ...]:
    """As they are to be set; of a file that does not say it, as they were found."""
    known = "preload_to_set" if "preload_to_set" in file.variables else "preload"
    return tuple(float(value) for value in values(file, known))


def _known(value: Any) -> Any:
    """A dash where there is no preload to say it of."""
    return "–" if isinstance(value, float) and np.isnan(value) else value


def _row(file: Any, name: str, label: str, shown: str) -> Row:
    found = values(file, name)
    unit = display(str(file[name].units), found, shown=shown)
    return Row(label, unit.unit, tuple(float(x) for x in np.atleast_1d(unit.of(found))), name)
