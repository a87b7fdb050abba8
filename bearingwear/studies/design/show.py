"""The sheet of a recommendation: the preload to take by each method, and what holds it."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import values
from bearingwear.measures import ENDS, LIMITED
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import BY_WEAR, band_by_wear
from bearingwear.results.units import Rough, digits, display, in_ascii
from bearingwear.results.warnings import WARNING, warning_lines
from bearingwear.scene.scene import COUNTS
from bearingwear.studies.design.room import CRITERIA_FARTHEST, FARTHEST
from bearingwear.studies.design.verdict import CLAIMED, NO_COMPARISON, ONE_LONGER, VERDICTS
from bearingwear.studies.design.words import (
    ASSUMED_WORDS,
    END_KEY,
    GROOVE_WORDS,
    HERTZIAN_LIFE_WORDS,
    LIMIT_KEY,
    NONE_BECAUSE,
    RECOMMENDED_WORDS,
    TRACK_WORDS,
    held_words,
    limit_text,
    without_limits,
)


class RoomRow(NamedTuple):
    """How far an assumption may move, as shown."""

    name: str
    label: str
    unit: str
    low: float
    now: float
    high: float

    @property
    def numbers(self) -> tuple[float, float, float]:
        """In the order of `ROOM_COLUMNS`."""
        return self.low, self.now, self.high


def _lives(scene: Mapping[str, Any], lives: np.ndarray) -> Iterator[Row]:
    """Lives (methods, 2) [h], and between which those that count lie by what is unknown of wear."""
    for k, way in enumerate(COUNTS):
        each = tuple(lives[:, k].tolist())
        yield Row(f"life, {way.replace('_and_', ' + ')}", "h", each, "life")
        found = [band_by_wear(scene, life)[0] for life in each]
        if way == scene["wear"].get("counts", COUNTS[-1]) and any(found):
            yield Row(BY_WEAR, "h", tuple(b or math.nan for b in found), "life_by_wear_alone")


def recommendation_sheet(file: Any) -> Document:
    """What to take, one column per preload method."""
    scene = json.loads(file.scene)
    columns = tuple(methods_told(file))
    rows = [
        Row("initial preload", "N", _numbers(file, "preload"), "preload", given=True),
        Row("held by", "", tuple(_held(file)), "active_limit"),
        *_lives(scene, values(file, "life")),
        *_grooves(file),
        *(_row(file, name, *words) for name, words in quantities_told(file).items()),
    ]
    given = json.loads(getattr(file, "limits", "{}"))
    limits = [in_ascii(limit_text(name, value)) for name, value in given.items() if value]
    rows = [row._replace(values=tuple(map(_known, row.values))) for row in rows]
    because = getattr(file, NONE_BECAUSE, "{}")
    none = json.loads(because)
    told = () if limits else without_limits(because)
    heading = (
        f"{scene['name']}: {getattr(file, 'title', 'recommended preload').lower()} "
        f"at {scene['operation']['shaft_speed_rpm']:g} r/min, "
        f"friction {scene['friction']['ball_race']:g}",
        *filter(None, [in_ascii(verdict_told(file))]),
        *(line for text in cliffs_told(file) for line in textwrap.wrap(in_ascii(text), 110)),
        *(f"limit: {text}" for text in limits),
        *(
            f"none within the limits, {method_words(scene, method)}: {in_ascii(why)}"
            for method, why in none.items()
            if limits
        ),
        *(line for text in told for line in textwrap.wrap(text, 110)),
    )
    attributes = {"warnings": getattr(file, "warnings", "[]")}
    heading += tuple(warning_lines(attributes))
    facts = {"kind": "recommendation", "scene": scene["name"], "limits": limits, NONE_BECAUSE: none}
    facts["verdict"] = VERDICTS[int(np.nan_to_num(values(file, "verdict")))]
    facts["warnings"] = [line.removeprefix(WARNING) for line in warning_lines(attributes)]
    if len(none) == len(columns):  # nothing but dashes
        return Document(heading, facts, ())
    return Document(heading, facts, (Block("recommended", columns, tuple(rows)), *_room(file)))


ROOM_COLUMNS = ("from", "now", "to")
ROOM_TOLD = (
    "Between these values the same method lasts longer. A dash: no change as far as lives were "
    f"found, at most {FARTHEST:g} times a limit and {CRITERIA_FARTHEST:g} times the others. With a "
    "limit moved the preloads are chosen anew; otherwise they stay as above. Both lives are "
    "inversely proportional to the wear coefficient."
)


def _room(file: Any) -> list[Block]:
    """How far each assumption may move before the other method is better."""
    rows = [
        Row(one.label, in_ascii(one.unit), tuple(map(_known, one.numbers)), one.name)
        for one in room_rows(file)
    ]
    if not rows:
        return []
    texts = [ROOM_TOLD, *track_told(file)]
    told = tuple(textwrap.fill(in_ascii(text), 108, subsequent_indent="  ") for text in texts)
    return [Block("how far the choice holds", ROOM_COLUMNS, tuple(rows), told)]


def room_rows(file: Any) -> list[RoomRow]:
    """How far each assumption in a recommendation may move."""
    columns = [values(file, name) for name in ("holds_from", "assumed", "holds_to")]
    rows = []
    for k, name in enumerate(flag_words(file, "assumption")):
        numbers = [column[k] for column in columns]
        label, unit = assumption_words(name)
        shown = (100.0 * v if unit == "%" else float(v) for v in numbers)
        rows.append(RoomRow(name, label, unit, *shown))
    return rows


def assumption_words(name: str) -> tuple[str, str]:
    """Label and unit of an assumption."""
    if name in ASSUMED_WORDS:
        return ASSUMED_WORDS[name], ""
    if name.startswith(LIMIT_KEY):
        one = LIMITED[name.removeprefix(LIMIT_KEY)]
        return one.words, one.unit
    one = ENDS[name.removeprefix(END_KEY)]
    return f"end: {one.words}", one.unit


def flag_words(file: Any, name: str) -> list[str]:
    """Meanings of a coordinate of flags, along it."""
    words = str(getattr(file[name], "flag_meanings", "")).split()  # none where nothing was found
    return [words[int(flag)] for flag in np.atleast_1d(values(file, name))]


def methods_told(file: Any) -> list[str]:
    """What holds the preload, along the methods of a file."""
    scene = json.loads(file.scene)
    return [method_words(scene, name) for name in flag_words(file, "preload_method")]


def quantities_told(file: Any) -> dict[str, tuple[str, str]]:
    """Those of `RECOMMENDED_WORDS` that a file knows; of a rotor without mass, no frequency."""
    words = RECOMMENDED_WORDS.items()
    return {name: told for name, told in words if np.isfinite(values(file, name)).any()}


def track_told(file: Any) -> list[str]:
    """Which method is the better by each track of a ball, where grooves are followed."""
    lives = np.asarray(values(file, "life_by_ball_track"))
    if len(lives) < 2 or not np.isfinite(lives).all():
        return []
    names = methods_told(file)
    told = [
        f"{' and '.join(map(digits, column))} h with balls that wear {TRACK_WORDS[track]}"
        for track, column in zip(flag_words(file, "ball_track"), lives.T.tolist(), strict=True)
    ]
    return [f"{' and '.join(names)} last {', '.join(told)}.".capitalize()]


def verdict_told(file: Any) -> str:
    """Whether one method can be said to last longer, in a sentence; empty with one method."""
    said = int(np.nan_to_num(values(file, "verdict")))
    if said == NO_COMPARISON:
        return ""
    counts = json.loads(file.scene)["wear"]["counts"]
    lives = np.asarray(values(file, "life"))[:, COUNTS.index(counts)]
    names = methods_told(file)
    best = int(np.argmax(lives))
    if said == ONE_LONGER:
        return f"{names[best]} lasts {lives[best] / lives[1 - best]:.3g} times as long"
    turned = [
        f"{one.label} {digits(one.now)} to {digits(end)} {one.unit}".rstrip()
        for one in room_rows(file)
        for end in (one.low, one.high)
        if abs(end / one.now - 1.0) < CLAIMED
    ]
    why = (
        f"the order reverses with {' or '.join(turned)}"
        if turned
        else "see how far the choice holds"
    )
    return f"neither method can be said to last longer: {why}"


def cliffs_told(file: Any) -> list[str]:
    """How near a sudden fall of the life is to each recommended preload, a sentence each."""
    said = []
    columns = ("preload", "cliff_preload", "cliff_life", "clear_preload", "clear_life")
    rows = zip(*(np.atleast_1d(values(file, name)) for name in columns), strict=True)
    for name, (preload, below, life, clear, kept) in zip(methods_told(file), rows, strict=True):
        if not np.isfinite(below):
            continue
        side = "less" if below < preload else "more"
        near = f"{100.0 * abs(below / preload - 1.0):.2g} % {side}"
        fall = f"the life falls to {Rough(life).text} h" if life > 0.0 else "there is no life"
        text = f"{name}: at {below:.7g} N, {near}, {fall}"
        if np.isfinite(clear):
            text += f"; {clear:.7g} N keeps 5 % away from it and lasts {Rough(kept).text} h"
        said.append(text)
    return said


def _held(file: Any) -> list[str]:
    names = file["active_limit"].flag_meanings.split()
    return [
        held_words(names[int(flag)], lambda name, k=k: float(values(file, name)[k]))  # type: ignore[misc]
        for k, flag in enumerate(values(file, "active_limit"))
    ]


def _numbers(file: Any, name: str) -> tuple[float, ...]:
    return tuple(float(value) for value in values(file, name))


def _grooves(file: Any) -> list[Row]:
    """Which groove the numbers have, and the life and the preload with the other one."""
    found = flag_words(file, "groove")
    rows = [Row("  its groove", "", tuple(GROOVE_WORDS[name] for name in found), "groove")]
    if "worn" in found:
        counts = COUNTS.index(json.loads(file.scene)["wear"]["counts"])
        hertzian = np.asarray(values(file, "hertzian_life"))[:, counts]
        rows += [Row(f"  {HERTZIAN_LIFE_WORDS}", "h", tuple(hertzian.tolist()), "hertzian_life")]
    return rows


def _known(value: Any) -> Any:
    """A dash where there is no preload to say it of."""
    return "–" if isinstance(value, float) and np.isnan(value) else value


def _row(file: Any, name: str, label: str, shown: str) -> Row:
    found = values(file, name)
    unit = display(str(file[name].units), found, shown=shown)
    return Row(label, unit.unit, tuple(float(x) for x in np.atleast_1d(unit.of(found))), name)
