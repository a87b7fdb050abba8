"""The document of a recommendation: the preload to take, what holds it, how far that holds.

`show`, `recommend`, the page's answer and design.md are this one document.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.document.bearing_line import bearing_line
from bearingwear.document.document import Block, Document, Row, quantity_row
from bearingwear.document.markdown import as_markdown
from bearingwear.document.study import by_wear_row, spread_rows
from bearingwear.document.table import dataset_csv, flag_names
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.measures import LIMITED
from bearingwear.results.netcdf import load
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import (
    RECOMMENDED,
    Spread,
    causes_told,
    load_quantiles,
    spread_of,
)
from bearingwear.results.units import Estimated, Rough, in_ascii
from bearingwear.results.warnings import WARNING, warning_line
from bearingwear.results.words import in_words, methods, scene_of
from bearingwear.scene.scene import Scene
from bearingwear.studies.design.beside import assumptions_of, load_beside, passed
from bearingwear.studies.design.choice import (
    ACTIVE,
    NO_LIFE_SOLVED,
    at_scene,
    design_files,
    limits_of,
)
from bearingwear.studies.design.conditions import DECIDING
from bearingwear.studies.design.document.held import (
    conditions_words,
    decides_words,
    deciding_of,
    extreme_words,
    lives_words,
    stated_warnings,
    worst_words,
)
from bearingwear.studies.design.document.sentences import (
    by_life,
    headline,
    how_sure,
    how_to_set_it,
    method_names,
    room_rows,
    sentence,
    spacer_offset,
    what_is_not_possible,
    what_it_gives,
    what_limits_it,
    what_others_change,
    what_would_change_it,
    why_title,
)
from bearingwear.studies.design.document.words import (
    GROOVE_WORDS,
    HERTZIAN_LIFE_WORDS,
    NONE_BECAUSE,
    RECOMMENDED_WORDS,
    held_words,
    limit_text,
    required_words,
)
from bearingwear.studies.design.machine import machine_blocks
from bearingwear.studies.design.map import MAP_AXES, WORN_GROOVE
from bearingwear.studies.design.plan import COARSE, DesignLimits, axes_around
from bearingwear.studies.design.recommend import best_method, mapped
from bearingwear.studies.design.room import CRITERIA_FARTHEST, FARTHEST, VERDICTS
from bearingwear.studies.design.sampled import sampled_blocks
from bearingwear.studies.pool import Tell

SHORT_TABLE = [one for one in LIMITED.values() if one.brief]
"""Measures in short tables, each by the worst of its kinds; the residual preload follows them."""

AT_END = "residual_preload_at_end"

ROOM_COLUMNS = ("from", "now", "to")
ROOM_WORDS = (
    "Between the listed values, the same method gives the longer life. A dash means no reversal "
    f"for changes by a factor of {FARTHEST:g} in a requirement or {CRITERIA_FARTHEST:g} in any "
    "other value. If a requirement changes, the preloads are re-optimised."
)


def design_answer(
    design: Path,
    recommendation: Path,
    uncertainty: Path | None = None,
    beside: Path | None = None,
    spread: Path | None = None,
) -> str:
    """Step: which preload to take, as the page reads it.

    design, recommendation, uncertainty: as of `design_files`.
    beside: lives at the recommended preloads with other assumptions (`lives_beside`).
    spread: quantiles of lives at the recommended preloads, in place of `uncertainty`.
    """
    lives, found, sampled = design_files(design, recommendation, uncertainty)
    others = None if beside is None else load_beside(beside, found)
    sampled = sampled if spread is None else load_quantiles(spread)
    return preload_document(found, lives, sampled, others).stored


def tables(design: Path, recommendation: Path, uncertainty: Path | None = None) -> tuple[str, str]:
    """Step: the whole map as CSV, and which preload to take as Markdown."""
    lives, found, sampled = design_files(design, recommendation, uncertainty)
    heads = ("preload_method", "friction", "shaft_speed (rpm)", "preload (N)")
    made = preload_document(found, lives, sampled)
    return dataset_csv(lives, dict(zip(MAP_AXES, heads, strict=True))), as_markdown(made)


def recommendation_sheet(file: Any) -> Document:
    """Sheet of an open file of a recommendation."""
    return preload_document(load(file.filepath()))


def recommended_sheet(
    scene: Scene,
    limits: DesignLimits,
    source: str = "scene",
    workers: int = 1,
    tell: Tell | None = None,
) -> tuple[Document, bool]:
    """The preload to take at the scene's own friction and speed, found in seconds.

    And whether any life was solved at all.

    scene: with a steady state and an end of life.
    source: what error messages name.
    workers, tell: as of `recommend.mapped`.
    """
    limits.check(scene, source)
    axes = axes_around(scene, [scene.friction.coefficient], source, COARSE)
    design, found = mapped(scene, axes, limits, workers, tell, quick=bool(limits.given))
    # a map with requirements has few lives: those that the search needed
    made = preload_document(found, None if limits.given else design)
    reasons = json.loads(found.attrs.get(NONE_BECAUSE, "{}")).values()
    others = any(not reason.startswith(NO_LIFE_SOLVED) for reason in reasons)
    return made, others or bool((found["status"] == OK).any())


def preload_document(
    found: xr.Dataset,
    design: xr.Dataset | None = None,
    uncertainty: xr.Dataset | None = None,
    beside: xr.Dataset | None = None,
) -> Document:
    """Which preload to take for a scene.

    found: the recommendation.
    design: the map that it was found on.
    uncertainty: quantiles of the lives at the recommended preloads.
    beside: lives there with other assumptions.
    """
    scene, given = scene_of(found), limits_of(found).given
    limits = [in_ascii(limit_text(name, value)) for name, value in given.items()]
    facts = {
        "kind": "recommendation",
        "scene": scene["name"],
        "bearing": bearing_line(scene),
        "limits": limits,
        NONE_BECAUSE: json.loads(found.attrs.get(NONE_BECAUSE, "{}")),
        "verdict": VERDICTS[int(np.nan_to_num(found["verdict"]))],
        "conditions": conditions_words(found),
        "worst": worst_words(found),
        "life_at": lives_words(found),
        DECIDING: deciding_of(found),
        "warnings": [warning_line(one).removeprefix(WARNING) for one in stated_warnings(found)],
    }
    where = f"{conditions_words(found)}; friction {scene['friction']['ball_race']:g}"
    known = by_life(found)
    spread = _spreads(found, uncertainty)
    blocks = [*_points(found, design, beside, spread)]
    blocks += [_recommended(found, spread), _new_and_worn(found)] if known else []
    blocks += machine_blocks(found)
    blocks += [] if beside is None else [_beside(beside, found)]
    blocks += [] if design is None else [_over_preload(design)]
    blocks += _room(found) if known else []
    blocks += [] if uncertainty is None else sampled_blocks(uncertainty)
    blocks += [] if design is None else [_statuses(design)]
    return Document(
        (headline(found), where),
        facts,
        tuple(blocks),
        ("design", "map", "uncertainty"),
        subject="Recommended preload",
    )


def _spreads(found: xr.Dataset, uncertainty: xr.Dataset | None) -> dict[str, Spread | None]:
    """Of the life at the recommended preload of each method, where it was sampled."""
    scene = scene_of(found)
    known = [] if uncertainty is None else [uncertainty]
    mu = scene["friction"]["ball_race"]
    return {
        method: spread_of(known, scene, method, mu, RECOMMENDED) for method, _ in methods(found)
    }


def _points(
    found: xr.Dataset,
    design: xr.Dataset | None,
    beside: xr.Dataset | None,
    spread: Mapping[str, Spread | None],
) -> list[Block]:
    """What it gives, what limits it, what would change it, uncertainty; requirements, warnings."""
    best, given = best_method(found), limits_of(found).given
    said: list[tuple[str, list[str], str]] = []
    if best is not None:
        others = [] if beside is None else what_others_change(beside, found, best)
        changes, limits = what_would_change_it(found, beside), what_limits_it(found, design)
        said = [
            ("Expected life", what_it_gives(found, spread), "verdict"),
            ("What limits the preload", limits, "lead"),
            ("Setting the preload", how_to_set_it(found), "lead"),
            ("What would change the choice", [changes, *others], "lead"),
            ("Uncertainty", how_sure(found, spread), "lead"),
        ]
    missing = why_title(found) if given else "Effect of a requirement"
    required = "; ".join(required_words(given))
    warned = [sentence(f"{one['sentence']}; {one['advice']}") for one in stated_warnings(found)]
    if given:
        said.insert(0, (f"Requirements, {worst_words(found)}", [sentence(required)], "more"))
    said += [
        (missing, what_is_not_possible(found), "lead"),
        ("Warnings (worst values)", warned, "strip"),
    ]
    return [Block(title, lines=tuple(lines), place=place) for title, lines, place in said if lines]


def _recommended(found: xr.Dataset, spread: Mapping[str, Spread | None]) -> Block:
    """The preload to take by each method, and the bearing with it."""
    scene, each = scene_of(found), [one for _, one in methods(found)]
    counts = scene["wear"]["counts"]
    held = [
        held_words(ACTIVE[int(one["active_limit"])], lambda name, one=one: float(one[name]))  # type: ignore[misc]
        for one in each
    ]
    grooves = flag_names(found["groove"])
    rows = [
        Row("initial preload", "N", _floats(found["preload"]), "preload", given=True),
        *_setting_rows(found),
        Row("limited by", "", tuple(held), "active_limit"),
        Row(f"life, {counts.replace('_and_', ' + ')}", "h", _lives(found), "life"),
        *(spread_rows([one.rows if one else {} for one in spread.values()])),
        *(() if any(spread.values()) else by_wear_row(scene, _floats(found["life"]))),
        Row("  groove model", "", tuple(GROOVE_WORDS[name] for name in grooves), "groove"),
    ]  # fmt: skip
    if "worn" in grooves:
        hertzian = _floats(found["hertzian_life"])
        rows.append(Row(f"  {HERTZIAN_LIFE_WORDS}", "h", hertzian, "hertzian_life"))
    errors = tuple(Rough(100.0 * e) for e in found["life_error_estimate"].values)
    rows.append(Row("  its numerical error", "%", errors, "life_error_estimate"))
    for name, (label, shown) in RECOMMENDED_WORDS.items():
        # of a rotor without mass there is no frequency; an older file lacks newer measures
        if name in found and np.isfinite(found[name]).any():
            rows.append(quantity_row(label, found[name].attrs["units"], found[name], name, shown))
    rows = [row._replace(note=_where_worst(found, row.name)) for row in rows]
    notes = [f"Minimum and maximum values are the worst {worst_words(found)}."]
    notes += [causes_told(scene)] if any(spread.values()) else []
    return Block("recommended", tuple(method_names(found)), tuple(rows), tuple(notes), place="lead")


def _setting_rows(found: xr.Dataset) -> list[Row]:
    """Spacer offset of a fixed position, and the range in which the best preload may be set."""
    offsets = tuple(
        spacer_offset(found, float(one["preload"]))
        if name == "fixed_position" and one["status"] == OK
        else math.nan
        for name, one in methods(found)
    )
    rows = [Row("  spacer offset", "um", offsets, "spacer_offset")]
    for name, words in (("least_preload", "lowest"), ("most_preload", "highest")):
        values = _floats(found[name]) if name in found else (math.nan,)
        rows.append(Row(f"  {words} within the tolerance", "N", values, name, given=True))
    return [row for row in rows if any(value == value for value in row.values)]


def _lives(found: xr.Dataset) -> tuple[float, ...]:
    """Lives [h], in the digits that their errors leave, three at most."""
    columns = (found[name].values for name in ("life", "life_error_estimate"))
    return tuple(
        Estimated.of(life, max(error * life, 10.0 ** (math.floor(math.log10(life)) - 2)))
        if life > 0.0 and error > 0.0
        else life
        for life, error in np.transpose(list(columns)).tolist()
    )


def _where_worst(found: xr.Dataset, name: str) -> str:
    """Where a quantity is the worst, by each method that has a preload."""
    words = []
    for _, one in methods(found):
        active = ACTIVE[int(one["active_limit"])]
        if name == "active_limit" and active in LIMITED:
            words.append(decides_words(found, one, active, brief=True))
        else:
            words.append(extreme_words(found, one, name, brief=True))
    return " / ".join(dict.fromkeys(filter(None, words)))


def _floats(values: Any) -> tuple[float, ...]:
    return tuple(float(value) for value in values)


def _new_and_worn(found: xr.Dataset) -> Block:
    """Of the recommended bearings, when new and at the end of life."""
    columns = {
        f"{words}, {state}": (lambda name, one=one, end=end: float(one[f"{name}_at_{end}"]))
        for words, (_, one) in zip(method_names(found), methods(found), strict=True)
        if one["status"] == OK
        for state, end in (("new", "start"), ("worn", "end"))
    }
    value_of = columns.values()
    rows = [quantity_row("residual preload", "N", (each("residual_preload") for each in value_of))]
    rows += [
        quantity_row(
            one.short,
            one.si_unit,
            (one.critical(each)[0] for each in value_of),
            one.key,
            one.shown_as,
        )
        for one in SHORT_TABLE
    ]
    where = "each case at its own speed" if scene_of(found).get("cases") else lives_words(found)
    return Block(f"new and worn, {where}", tuple(columns), tuple(rows))


def brief_rows(points: Sequence[xr.Dataset]) -> list[Row]:
    """Life, the worst of each measure of short tables, and violated requirements, at points."""
    life = Row("life", "h", tuple(float(one["life"]) for one in points), "life")
    rows = [
        quantity_row(one.short, one.si_unit, map(one.worst, points), one.key, one.shown_as)
        for one in SHORT_TABLE
    ]
    end = quantity_row(RECOMMENDED_WORDS[AT_END][0], "N", [one[AT_END] for one in points], AT_END)
    return [life, *rows, end, Row("requirements violated", "", tuple(map(passed, points)))]


def _over_preload(design: xr.Dataset) -> Block:
    """Every preload of the map, by each method, at the scene's friction and speed."""
    points = [
        (float(preload), method, one.isel(preload=k))
        for k, preload in enumerate(design["preload"].values)
        for method, one in methods(at_scene(design))
    ]
    names = tuple(method_words(scene_of(design), method) for _, method, _ in points)
    rows = [
        Row("preload", "N", tuple(preload for preload, _, _ in points), "preload", given=True),
        Row("preload method", "", names, "preload_method"),
        *brief_rows([one for _, _, one in points]),
    ]
    return Block(
        "Life and requirements against preload",
        rows=tuple(rows),
        axes=2,
        place="charted",
    )


def _beside(beside: xr.Dataset, found: xr.Dataset) -> Block:
    """Lives at the recommended preloads, as studied and with other assumptions."""
    points = [
        (words, method_words(scene_of(found), method), one)
        for words, case in [("as above", found), *assumptions_of(beside)]
        for method, one in methods(case)
        if int(one["status"]) >= 0
    ]
    rows = [
        Row("assumption", "", tuple(words for words, _, _ in points)),
        Row("preload method", "", tuple(name for _, name, _ in points), "preload_method"),
        *brief_rows([one for _, _, one in points]),
    ]
    title = "Effect of other assumptions at the recommended preloads"
    return Block(title, rows=tuple(rows), axes=2)


def _room(found: xr.Dataset) -> list[Block]:
    """How far each assumption may move before the other method is better."""
    rows = tuple(room_rows(found))
    return [Block("robustness of the choice", ROOM_COLUMNS, rows, (ROOM_WORDS,))] if rows else []


def _statuses(design: xr.Dataset) -> Block:
    """How many lives and states the map took, and what was not solved."""
    codes, counts = np.unique(design["status"].values, return_counts=True)
    worn = int((design["groove"] == WORN_GROOVE).sum())
    grooves = "All lives were computed with"
    if worn:
        grooves = f"{worn} lives were computed with worn grooves, the others with"
    solves, failed = (int(design[name].sum()) for name in ("solves", "failed_solves"))
    said = (
        f"{design['status'].size} lives for combinations of preload, method, friction and speed "
        f"were computed from {solves} steady states; {failed} states could not be found. {grooves} "
        "Hertzian grooves.",
        "If a life could not be computed, its status gives the reason, and the corresponding "
        "preload is never recommended.",
    )
    rows = (
        Row("status", "", tuple(in_words(STATUS_NAMES[int(k)]) for k in codes)),
        Row("lives", "", tuple(map(int, counts)), "lives"),
    )
    known = len(codes) == 1 and codes[0] == OK
    lines = said[: 2 - known]
    return Block("Number of computed lives", rows=() if known else rows, axes=1, lines=lines)
