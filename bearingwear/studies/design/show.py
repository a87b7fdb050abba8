"""The sheet of a recommendation: the preload to take by each method, and what holds it."""

from __future__ import annotations

import json
import textwrap
from typing import Any

import numpy as np

from bearingwear.model.criterion import IN_WORDS
from bearingwear.results.rows import values
from bearingwear.results.sheet import Block, Row, Sheet
from bearingwear.results.units import display, in_ascii
from bearingwear.results.warnings import WARNING, warning_lines, wrapped_warnings
from bearingwear.scene.scene import COUNTS
from bearingwear.studies.design.room import CRITERIA_FARTHEST, FARTHEST
from bearingwear.studies.design.words import (
    LIMIT_WORDS,
    NONE_BECAUSE,
    RECOMMENDED_WORDS,
    ROOM,
    in_percent,
    limit_text,
    limit_unit,
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
    return Sheet(heading, facts, (Block("recommended", columns, tuple(rows)), *_room(file)))


ROOM_COLUMNS = ("from", "now", "to")
ROOM_TOLD = (
    "Between these the method with the longer life stays the same. A dash: as far as lives were "
    f"found, at most {FARTHEST:g} times a limit and {CRITERIA_FARTHEST:g} times an end of life. A "
    "limit moves with preloads chosen anew between those of the map, an end of life with the "
    "preloads above."
)


def _room(file: Any) -> list[Block]:
    """How far each limit and each end of life may move before the other method is better."""
    attributes = (getattr(file, name, "{}") for name in (ROOM, "limits", "scene"))
    rows = [
        Row(label, unit, tuple(map(_known, numbers)), name)
        for name, label, unit, numbers in room_rows(*attributes)
    ]
    told = (textwrap.fill(ROOM_TOLD, 108, subsequent_indent="  "),)
    return [Block("how far the choice holds", ROOM_COLUMNS, tuple(rows), told)] if rows else []


def room_rows(
    room: str, limits: str, scene: str
) -> list[tuple[str, str, str, tuple[float, float, float]]]:
    """Name, label, unit and values (from, now, to) of each row, from attributes of a file."""
    found = json.loads(room)
    given = {
        "limits": json.loads(limits),
        "ends": json.loads(scene)["wear"].get("end_of_life") or {},
    }
    rows = []
    for kind, at_now in given.items():
        for name, (low, high) in found.get(kind, {}).items():
            numbers = (np.nan if v is None else float(v) for v in (low, at_now[name], high))
            shown = tuple(in_percent(name, value) for value in numbers)
            label = LIMIT_WORDS[name] if kind == "limits" else f"end: {IN_WORDS[name].words}"
            rows.append((name, label, limit_unit(name), shown))
    return rows  # type: ignore[return-value]


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
