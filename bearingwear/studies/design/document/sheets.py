"""The document of a recommendation: the preload to take, and what would change the choice.

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
from bearingwear.results.quantiles import RECOMMENDED, Spread, load_quantiles, spread_of
from bearingwear.results.units import Estimated, Rough, ascii_text, digits
from bearingwear.results.warnings import WARNING, warning_line
from bearingwear.results.words import methods, name_in_words, scene_of
from bearingwear.studies.design.changes import (
    FRICTION_KEY,
    GROOVE_KEY,
    LIMIT_KEY,
    SHEAR_KEY,
    WARMTH_KEY,
)
from bearingwear.studies.design.choice import (
    ACTIVE,
    at_scene,
    design_files,
    limit_margins,
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
    life_sentence,
    makers_minimum_sentences,
    method_names,
    none_sentences,
    none_title,
    sentence,
    setting_sentence,
    spacer_offset,
    trust_sentence,
)
from bearingwear.studies.design.document.words import (
    GROOVE_WORDS,
    HERTZIAN_LIFE_WORDS,
    NONE_BECAUSE,
    RECOMMENDED_WORDS,
    held_words,
    limit_text,
)
from bearingwear.studies.design.machine import machine_blocks
from bearingwear.studies.design.map import IMPRACTICAL, MAP_AXES
from bearingwear.studies.design.sampled import sampled_blocks

SHORT_TABLE = [one for one in LIMITED.values() if one.brief]
"""Measures in short tables, each by the worst of its kinds; the residual preload follows them."""

AT_END = "residual_preload_at_end"
NONE_VIOLATED = "none"

SAME = 1e-6
"""Relative excess over a limit that counts as rounding."""

CHANGE_WORDS = {
    FRICTION_KEY: ("ball-race friction coefficient", ""),
    SHEAR_KEY: ("shear strength of the film", "MPa"),
    WARMTH_KEY: ("warming of the inner ring alone", "K"),
    GROOVE_KEY: ("groove model", ""),
}


def design_answer(
    design: Path,
    recommendation: Path,
    uncertainty: Path | None = None,
    spread: Path | None = None,
) -> str:
    """Step: which preload to take, as the page reads it.

    design, recommendation, uncertainty: as of `design_files`.
    spread: quantiles of lives at the recommended preloads, in place of `uncertainty`.
    """
    lives, found, sampled = design_files(design, recommendation, uncertainty)
    sampled = sampled if spread is None else load_quantiles(spread)[0]
    return preload_document(found, lives, sampled).stored


def tables(design: Path, recommendation: Path, uncertainty: Path | None = None) -> tuple[str, str]:
    """Step: the whole map as CSV, and which preload to take as Markdown."""
    lives, found, sampled = design_files(design, recommendation, uncertainty)
    heads = ("preload_method", "friction", "shaft_speed (rpm)", "preload (N)")
    made = preload_document(found, lives, sampled)
    return dataset_csv(lives, dict(zip(MAP_AXES, heads, strict=True))), as_markdown(made)


def recommendation_sheet(file: Any) -> Document:
    """Sheet of an open file of a recommendation."""
    return preload_document(load(file.filepath()))


def preload_document(
    found: xr.Dataset, design: xr.Dataset | None = None, uncertainty: xr.Dataset | None = None
) -> Document:
    """Which preload to take for a scene.

    found: the recommendation.
    design: a map of lives beside it.
    uncertainty: quantiles of the lives at the recommended preloads.
    """
    scene, given = scene_of(found), limits_of(found).given
    limits = [ascii_text(limit_text(name, value)) for name, value in given.items()]
    facts = {
        "kind": "recommendation",
        "scene": scene["name"],
        "bearing": bearing_line(scene),
        "limits": limits,
        NONE_BECAUSE: json.loads(found.attrs.get(NONE_BECAUSE, "{}")),
        "conditions": conditions_words(found),
        "worst": worst_words(found),
        "life_at": lives_words(found),
        DECIDING: deciding_of(found),
        "warnings": [warning_line(one).removeprefix(WARNING) for one in stated_warnings(found)],
    }
    spread, blocks = _spreads(found, uncertainty), []
    if by_life(found):
        blocks += [
            Block("Expected life", lines=(life_sentence(found, spread),), place="verdict"),
            Block(
                "Setting the preload",
                lines=(
                    setting_sentence(found),
                    *makers_minimum_sentences(found),
                    trust_sentence(found),
                ),
                place="lead",
            ),
        ]
    if why := none_sentences(found):
        title = none_title(found) if given else "Effect of a requirement"
        minimum = [] if by_life(found) else makers_minimum_sentences(found)
        blocks.append(Block(title, lines=(*why, *minimum), place="lead"))
    if by_life(found):
        blocks += [_recommended(found, spread), _changes(found)]
    warned = [sentence(f"{one['sentence']}; {one['advice']}") for one in stated_warnings(found)]
    if warned:
        blocks.append(Block("Warnings (worst values)", lines=tuple(warned), place="strip"))
    blocks += machine_blocks(found)
    blocks += [] if design is None else [_over_preload(design)]
    blocks += [] if uncertainty is None else sampled_blocks(uncertainty)
    where = f"{conditions_words(found)}; {_friction_words(scene)}"
    figures = ("design", "map", "uncertainty")
    return Document((headline(found), where), facts, tuple(blocks), figures, "Recommended preload")


def _friction_words(scene: Mapping[str, Any]) -> str:
    mu = scene["friction"].get("ball_race")
    return "friction of a film" if mu is None else f"friction {mu:g}"


def _spreads(found: xr.Dataset, uncertainty: xr.Dataset | None) -> dict[str, Spread | None]:
    """Of the life at the recommended preload of each method, where it was sampled."""
    scene = scene_of(found)
    known = [] if uncertainty is None else [uncertainty]
    mu = scene["friction"].get("ball_race")
    return {
        method: spread_of(known, scene, method, mu, RECOMMENDED) for method, _ in methods(found)
    }


def _recommended(found: xr.Dataset, spread: Mapping[str, Spread | None]) -> Block:
    """The preload to take by each method, what limits it, its life, and the worst values there."""
    each = [one for _, one in methods(found)]
    counts = scene_of(found)["wear"]["counts"].replace("_and_", " + ")
    held = [
        held_words(ACTIVE[int(one["active_limit"])], lambda name, one=one: float(one[name]))  # type: ignore[misc]
        for one in each
    ]
    offsets = tuple(
        spacer_offset(found, float(one["preload"]))
        if name == "fixed_position" and one["status"] == OK
        else math.nan
        for name, one in methods(found)
    )
    rows = [
        Row("initial preload", "N", _floats(found["preload"]), "preload", given=True),
        Row("  may be set from", "N", _floats(found["least_preload"]), "least_preload", given=True),
        Row("  to", "N", _floats(found["most_preload"]), "most_preload", given=True),
        Row("  spacer offset", "um", offsets, "spacer_offset"),
        Row("limited by", "", tuple(held), "active_limit"),
        Row(f"life, {counts}", "h", _lives(found), "life"),
        *_relative_lives(found),
    ]
    if any(spread.values()):
        rows += spread_rows([*spread.values()])
    else:
        rows += by_wear_row(scene_of(found), _floats(found["life"]))
    errors = tuple(Rough(100.0 * error) for error in _floats(found["life_error_estimate"]))
    rows.append(Row("  its numerical error", "%", errors, "life_error_estimate"))
    grooves = flag_names(found["groove"])
    rows.append(Row("  groove model", "", tuple(GROOVE_WORDS[name] for name in grooves), "groove"))
    if "worn" in grooves:
        hertzian = _floats(found["hertzian_life"])
        rows.append(Row(f"  {HERTZIAN_LIFE_WORDS}", "h", hertzian, "hertzian_life"))
    given = limits_of(found).given
    shown = [one for one in LIMITED.values() if one.brief or one.key in given]
    for name in [name for one in shown for name in one.extremes if name != "life"] + [AT_END]:
        label, kind = RECOMMENDED_WORDS[name]
        # of a rotor without mass there is no frequency; an older file lacks newer measures
        if name in found and np.isfinite(found[name]).any():
            rows.append(quantity_row(label, found[name].attrs["units"], found[name], name, kind))
    rows = [row._replace(note=_where_worst(found, row.name)) for row in rows]
    rows = [row for row in rows if row.name != "spacer_offset" or np.isfinite(row.values).any()]
    names = method_names(found)
    notes = "worst condition"
    if any(" / " in row.note for row in rows):
        notes += f" ({' / '.join(names)})"
    return Block("recommended", tuple(names), tuple(rows), place="open", notes=notes)


def _lives(found: xr.Dataset) -> tuple[float, ...]:
    """Lives [h], in the digits that their errors leave, three at most."""
    columns = (found[name].values for name in ("life", "life_error_estimate"))
    return tuple(
        Estimated.of(life, max(error * life, 10.0 ** (math.floor(math.log10(life)) - 2)))
        if life > 0.0 and error > 0.0
        else life
        for life, error in np.transpose(list(columns)).tolist()
    )


def _relative_lives(found: xr.Dataset) -> tuple[Row, ...]:
    """Each life over the longest, whatever K_s/H: a row where two methods have a life."""
    lives = found["life"].values
    if np.count_nonzero(lives > 0.0) < 2:
        return ()
    label = "  relative, whatever K_s/H"
    return (Row(label, "", _floats(lives / np.nanmax(lives)), "relative_life"),)


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


def _changes(found: xr.Dataset) -> Block:
    """Values at which the other method becomes better: of each requirement, friction, warmth."""
    rows = []
    for k, name in enumerate(flag_names(found["change"])):
        words, unit = change_words(name)
        columns = ("value_now", "other_better_below", "other_better_above")
        ends = *columns, "tried_from", "tried_to"
        now, below, above, low, high = (float(found[column][k]) for column in ends)
        if name == GROOVE_KEY:
            which = "with" if math.isfinite(below) else "not with"
            rows.append(Row(words, unit, ("worn", f"{which} a Hertzian groove"), name))
            continue
        factor = 100.0 if unit == "%" else 1.0
        places = (("below", below), ("above", above))
        known = [f"{side} {digits(factor * end)}" for side, end in places if math.isfinite(end)]
        none = f"not within {digits(factor * low)} to {digits(factor * high)}"
        rows.append(Row(words, unit, (digits(factor * now), " or ".join(known) or none), name))
    if not rows:
        return Block("What would change the choice", lines=("No other method to compare.",))
    heads = ("now", "other method better")
    return Block("What would change the choice", heads, tuple(rows), place="lead")


def change_words(name: str) -> tuple[str, str]:
    """Words and unit of what may be otherwise than assumed."""
    if name in CHANGE_WORDS:
        return CHANGE_WORDS[name]
    one = LIMITED[name.removeprefix(LIMIT_KEY)]
    return f"{'required' if one.falls else 'permitted'} {one.words}", one.unit


def brief_rows(points: Sequence[xr.Dataset]) -> list[Row]:
    """Life, the worst of each measure of short tables, and violated requirements, at points."""
    life = Row("life", "h", tuple(float(one["life"]) for one in points), "life")
    rows = [
        quantity_row(one.short, one.si_unit, map(one.worst, points), one.key, one.shown_as)
        for one in SHORT_TABLE
    ]
    end = quantity_row(RECOMMENDED_WORDS[AT_END][0], "N", [one[AT_END] for one in points], AT_END)
    return [life, *rows, end, Row("requirements violated", "", tuple(map(violated, points)))]


def violated(one: xr.Dataset) -> str:
    """Which requirements a point violates, or why it has no life."""
    if int(one["status"]) != OK:
        return f"not solved: {name_in_words(STATUS_NAMES[int(one['status'])])}"
    limits = limits_of(one)
    margins = zip(limits.held, limit_margins(one, limits), strict=True)
    beyond = [LIMITED[name].words for name, left in margins if not left >= -SAME]
    if number := int(one["impractical"]):
        beyond.append(f"impractical design: {name_in_words(IMPRACTICAL[number - 1])}")
    return ", ".join(beyond) or NONE_VIOLATED


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
    return Block("Life and requirements against preload", rows=tuple(rows), axes=2, place="charted")
