"""The document of a recommendation: the preload to take, and what would change the choice.

`show`, `recommend`, the page's answer and design.md are this one document.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.document.bearing_line import bearing_line
from bearingwear.document.document import Block, Document, Row, quantity_row
from bearingwear.document.markdown import as_markdown
from bearingwear.document.rows import bound_lines
from bearingwear.document.study import by_wear_row, spread_rows
from bearingwear.document.table import dataset_csv, flag_names
from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.measures import LIMITED, Measure
from bearingwear.results.netcdf import load
from bearingwear.results.pair_variables import method_words
from bearingwear.results.quantiles import RECOMMENDED, Spread, load_quantiles, spread_of
from bearingwear.results.units import Rough, ascii_text, digits
from bearingwear.results.variable import SECONDS_PER_HOUR
from bearingwear.results.warnings import WARNING, warning_line
from bearingwear.results.words import methods, name_in_words, scene_of
from bearingwear.scene.read import scene_from_dict
from bearingwear.studies.design.changes import (
    FRICTION_KEY,
    GROOVE_KEY,
    LIMIT_KEY,
    SHEAR_KEY,
    WARMTH_KEY,
)
from bearingwear.studies.design.choice import (
    ACTIVE,
    design_files,
    limit_margins,
    limits_of,
    line_of_scene,
)
from bearingwear.studies.design.conditions import DECIDING
from bearingwear.studies.design.document.sentences import (
    headline,
    life_sentence,
    makers_minimum_sentences,
    method_names,
    none_sentences,
    none_title,
    recommended_points,
    sentence,
    setting_sentence,
    similar_life_sentences,
    spacer_offset,
    trust_sentence,
)
from bearingwear.studies.design.document.words import (
    GROOVE_WORDS,
    HERTZIAN_LIFE_WORDS,
    NONE_BECAUSE,
    RECOMMENDED_WORDS,
    active_limit_words,
    ending_measure,
    limit_text,
)
from bearingwear.studies.design.document.worst_conditions import (
    brief_condition_words,
    conditions_words,
    critical_extreme,
    deciding_by_method,
    extent_words,
    lives_condition_words,
    stated_warnings,
)
from bearingwear.studies.design.machine import machine_blocks
from bearingwear.studies.design.map import IMPRACTICAL_FLAGS, MAP_AXES
from bearingwear.studies.design.sampled import sampled_blocks

SHORT_TABLE = [measure for measure in LIMITED.values() if measure.brief]
"""Measures in short tables, each by the worst of its kinds; the residual preload follows them."""

AT_END = "residual_preload_at_end"
NO_TOLERANCE = "not sought"
"""Cell of a method whose life is not the longest: its tolerance would take further lives."""
NONE_VIOLATED = "none"

SAME = 1e-6
"""Relative excess over a limit that counts as rounding."""

CHANGE_WORDS = {
    FRICTION_KEY: ("ball-race friction, preloads kept", ""),
    SHEAR_KEY: ("shear strength of the film, preloads kept", "MPa"),
    WARMTH_KEY: ("warming of the inner ring, preloads kept", "K"),
    GROOVE_KEY: ("groove model", ""),
}


def design_answer(
    design: Path,
    recommendation: Path,
    uncertainty: Path | None = None,
    spread: Path | None = None,
) -> str:
    """Step: returns which preload to take, as the page reads it.

    design, recommendation, uncertainty: as of `design_files`.
    spread: quantiles of lives at the recommended preloads, in place of `uncertainty`.
    """
    lives, recommended, sampled = design_files(design, recommendation, uncertainty)
    sampled = sampled if spread is None else load_quantiles(spread)[0]
    return preload_document(recommended, lives, sampled).stored


def tables(design: Path, recommendation: Path, uncertainty: Path | None = None) -> tuple[str, str]:
    """Step: returns the whole map as CSV, and which preload to take as Markdown."""
    lives, recommended, sampled = design_files(design, recommendation, uncertainty)
    heads = ("preload_method", "friction", "shaft_speed (rpm)", "preload (N)")
    document = preload_document(recommended, lives, sampled)
    return dataset_csv(lives, dict(zip(MAP_AXES, heads, strict=True))), as_markdown(document)


def recommendation_sheet(file: Any) -> Document:
    """Returns the sheet of an open file of a recommendation."""
    return preload_document(load(file.filepath()))


def preload_document(
    recommendation: xr.Dataset,
    design: xr.Dataset | None = None,
    uncertainty: xr.Dataset | None = None,
) -> Document:
    """Returns which preload to take for a scene.

    design: a map of lives beside the recommendation.
    uncertainty: quantiles of the lives at the recommended preloads.
    """
    scene = scene_of(recommendation)
    stated = stated_warnings(recommendation)
    spreads = recommended_spreads(recommendation, uncertainty)
    has_preload = bool(recommended_points(recommendation))
    blocks = []
    if has_preload:
        expected_life = life_sentence(recommendation, spreads)
        lines = (expected_life, *bound_lines(scene), *similar_life_sentences(recommendation))
        blocks.append(Block("Expected life", lines=lines, place="verdict"))
        blocks.append(_setting_block(recommendation))
    blocks += _none_blocks(recommendation)
    if has_preload:
        blocks += [_recommended_block(recommendation, spreads), _changes_block(recommendation)]
    if stated:
        lines = tuple(f"{sentence(w['sentence'])} {sentence(w['advice'])}" for w in stated)
        blocks.append(Block("Warnings (worst values)", lines=lines, place="strip"))
    blocks += machine_blocks(recommendation)
    blocks += [] if design is None else [_map_block(design)]
    blocks += [] if uncertainty is None else sampled_blocks(uncertainty)
    subtitle = f"{conditions_words(recommendation)}; {_friction_words(scene)}"
    figures = ("design", "map", "uncertainty")
    heading = (headline(recommendation), subtitle)
    facts = _facts(recommendation, stated)
    subject = "Recommended preload" if has_preload else "Preload"
    return Document(heading, facts, tuple(blocks), figures, subject)


def _facts(recommendation: xr.Dataset, stated: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Returns the facts of the document, with the warnings that it states."""
    scene, limits = scene_of(recommendation), limits_of(recommendation).given
    return {
        "kind": "recommendation",
        "scene": scene["name"],
        "bearing": bearing_line(scene),
        "limits": [ascii_text(limit_text(name, value)) for name, value in limits.items()],
        NONE_BECAUSE: json.loads(recommendation.attrs.get(NONE_BECAUSE, "{}")),
        "conditions": conditions_words(recommendation),
        "worst": extent_words(recommendation),
        "life_at": lives_condition_words(recommendation),
        DECIDING: deciding_by_method(recommendation),
        "warnings": [warning_line(warning).removeprefix(WARNING) for warning in stated],
    }


def _setting_block(recommendation: xr.Dataset) -> Block:
    """Returns what to specify, and what the life may be used for."""
    lines = (
        setting_sentence(recommendation),
        *makers_minimum_sentences(recommendation),
        trust_sentence(recommendation),
    )
    return Block("Setting the preload", lines=lines, place="lead")


def _none_blocks(recommendation: xr.Dataset) -> list[Block]:
    """Returns why a method has no preload, or what a requirement would do; empty otherwise."""
    reasons = none_sentences(recommendation)
    if not reasons:
        return []
    has_limits = bool(limits_of(recommendation).given)
    title = none_title(recommendation) if has_limits else "Effect of a requirement"
    has_preload = bool(recommended_points(recommendation))
    minimum = [] if has_preload else makers_minimum_sentences(recommendation)
    return [Block(title, lines=(*reasons, *minimum), place="lead")]


def _friction_words(scene: Mapping[str, Any]) -> str:
    """Returns the friction coefficient of a scene in words."""
    mu = scene["friction"].get("ball_race")
    return "friction of a film" if mu is None else f"friction {mu:g}"


def recommended_spreads(
    recommendation: xr.Dataset, uncertainty: xr.Dataset | None
) -> dict[str, Spread | None]:
    """Returns the spread of the life at each recommended preload, by method; None if unknown."""
    scene = scene_of(recommendation)
    uncertainties = [] if uncertainty is None else [uncertainty]
    mu = scene["friction"].get("ball_race")
    return {
        method: spread_of(uncertainties, scene, method, mu, RECOMMENDED)
        for method, _ in methods(recommendation)
    }


def _recommended_block(recommendation: xr.Dataset, spreads: Mapping[str, Spread | None]) -> Block:
    """Returns the preload of each method, what limits it, its life, and the worst values there."""
    rows = [
        *_preload_rows(recommendation),
        *_life_rows(recommendation, spreads),
        *_worst_value_rows(recommendation),
    ]
    rows = [row._replace(note=_worst_note(recommendation, row.name)) for row in rows]
    names = method_names(recommendation)
    notes = "worst condition"
    if any(" / " in row.note for row in rows):
        notes += f" ({' / '.join(names)})"
    return Block("recommended", tuple(names), tuple(rows), place="open", notes=notes)


def _preload_rows(recommendation: xr.Dataset) -> list[Row]:
    """Returns rows of the preload of each method, its range, its offset, and what limits it."""

    def row(label: str, name: str) -> Row:
        return Row(label, "N", _floats(recommendation[name]), name, given=True)

    points = methods(recommendation)
    offsets = tuple(
        spacer_offset(recommendation, float(point["preload"]))
        if method == "fixed_position" and point["status"] == OK
        else math.nan
        for method, point in points
    )
    rows = [
        row("initial preload", "preload"),
        _tolerance_row(recommendation, "  lower tolerance limit", "least_preload"),
        _tolerance_row(recommendation, "  upper tolerance limit", "most_preload"),
    ]
    if np.isfinite(offsets).any():
        rows.append(Row("  spacer offset", "um", offsets, "spacer_offset"))
    limited_by = tuple(_limited_by_words(point) for _, point in points)
    return [*rows, Row("limited by", "", limited_by, "active_limit")]


def _tolerance_row(recommendation: xr.Dataset, label: str, name: str) -> Row:
    """Returns an end of the tolerance of each preload, which the longest life alone has."""
    has_preload = np.isfinite(recommendation["preload"])
    values = tuple(
        NO_TOLERANCE if math.isnan(limit) and recommended else limit
        for limit, recommended in zip(_floats(recommendation[name]), has_preload, strict=True)
    )
    return Row(label, "N", values, name, given=True)


def _limited_by_words(point: xr.Dataset) -> str:
    """Returns what keeps the preload of a method from one with a longer life."""
    name = ACTIVE[int(point["active_limit"])]
    return active_limit_words(name, lambda extreme: float(point[extreme]))


def _life_rows(recommendation: xr.Dataset, spreads: Mapping[str, Spread | None]) -> list[Row]:
    """Returns rows of the lives, their numerical error, their grooves and their spread."""
    scene, lives = scene_of(recommendation), _floats(recommendation["life"])
    counts = scene["wear"]["counts"].replace("_and_", " + ")
    rows = [Row(f"life, {counts}", "h", lives, "life")]
    if np.count_nonzero(np.array(lives) > 0.0) > 1:
        longest = float(np.nanmax(lives))
        relative = tuple(life / longest for life in lives)
        rows.append(Row("  relative life, for any K_s/H", "", relative, "relative_life"))
    if duty := scene_from_dict(scene).duty:
        cycles = tuple(life * SECONDS_PER_HOUR / duty.cycle_s for life in lives)
        rows.append(Row("  in cycles of the duty", "", cycles, "life_cycles"))
    rows.append(Row("  ended by", "", _endings(recommendation), "end_criterion"))
    errors = tuple(Rough(100.0 * error) for error in _floats(recommendation["life_error_estimate"]))
    rows.append(Row("  numerical error", "%", errors, "life_error_estimate"))
    rows += _groove_rows(recommendation)
    if not any(spreads.values()):  # those sampled contain the wear
        rows += by_wear_row(scene, lives)
    return [*rows, *spread_rows([*spreads.values()])]


def _endings(recommendation: xr.Dataset) -> tuple[str, ...]:
    """Returns the criterion that ends the life of each method, in words."""
    endings = (ending_measure(point) for _, point in methods(recommendation))
    return tuple(ending.words if ending else "" for ending in endings)


def _groove_rows(recommendation: xr.Dataset) -> list[Row]:
    """Returns rows of the groove model and, for worn grooves, of the life with Hertzian ones."""
    grooves = flag_names(recommendation["groove"])
    lives = _floats(recommendation["life"])
    words = tuple(
        GROOVE_WORDS[name] if math.isfinite(life) else ""
        for name, life in zip(grooves, lives, strict=True)
    )
    rows = [Row("  groove model", "", words, "groove")]
    if "worn" in grooves and recommendation["hertzian_life"].notnull().any():
        hertzian = _floats(recommendation["hertzian_life"])
        rows.append(Row(f"  {HERTZIAN_LIFE_WORDS}", "h", hertzian, "hertzian_life"))
    return rows


def _worst_value_rows(recommendation: xr.Dataset) -> list[Row]:
    """Returns rows of the worst values from new to the end of life, and of the preload then."""
    limits = limits_of(recommendation).given
    rows = []
    for measure in LIMITED.values():
        if not (measure.brief or measure.key in limits):
            continue
        for name in measure.extremes:
            # of a rotor without mass there is no frequency; an older file lacks newer measures
            is_known = name in recommendation and np.isfinite(recommendation[name]).any()
            if name != "life" and is_known:
                label, _ = RECOMMENDED_WORDS[name]
                rows.append(_measure_row(measure, label, recommendation[name].values, name))
    label, _ = RECOMMENDED_WORDS[AT_END]
    at_end = recommendation[AT_END].values
    return [*rows, quantity_row(label, "N", at_end, AT_END)] if np.isfinite(at_end).any() else rows


def _measure_row(measure: Measure, label: str, values: Iterable[Any], name: str) -> Row:
    """Returns values [SI] of a measure in the unit in which it is required."""
    unit = "" if measure.unit == "1" else measure.unit
    return Row(label, unit, tuple(float(measure.shown(value)) for value in values), name)


def _worst_note(recommendation: xr.Dataset, name: str) -> str:
    """Returns where a quantity is the worst, by each method that has a preload.

    A life over a duty that ends by a depth of wear ends in all phases.
    """
    words, has_duty = [], bool(scene_of(recommendation).get("duty"))
    for _, point in methods(recommendation):
        if name == "life" and has_duty and (end := ending_measure(point)) and end.of_wear:
            words.append("all phases")
            continue
        active = ACTIVE[int(point["active_limit"])]
        is_of_limit = name == "active_limit" and active in LIMITED
        extreme = critical_extreme(point, active) if is_of_limit else name
        words.append(brief_condition_words(recommendation, point, extreme))
    return " / ".join(dict.fromkeys(filter(None, words)))


def _floats(values: Any) -> tuple[float, ...]:
    return tuple(float(value) for value in values)


def _changes_block(recommendation: xr.Dataset) -> Block:
    """Returns values of assumptions at which the other method becomes better."""
    title = "What would change the choice"
    names = flag_names(recommendation["change"])
    rows = tuple(_change_row(recommendation.isel(change=k), name) for k, name in enumerate(names))
    if not rows:
        return Block(title, lines=("No other method to compare.",))
    return Block(title, ("now", "other method better"), rows, place="lead")


def _change_row(change: xr.Dataset, name: str) -> Row:
    """Returns the value of an assumption now, and those at which the other method is better."""
    words, unit = change_words(name)
    below, above = float(change["other_better_below"]), float(change["other_better_above"])
    if name == GROOVE_KEY:
        which = "with" if math.isfinite(below) else "not with"
        return Row(words, unit, ("worn", f"{which} a Hertzian groove"), name)

    def text(value: float) -> str:
        return digits((100.0 if unit == "%" else 1.0) * value)

    ends = [
        f"{side} {text(end)}"
        for side, end in (("below", below), ("above", above))
        if math.isfinite(end)
    ]
    low, high = (text(float(change[end])) for end in ("tried_from", "tried_to"))
    other_better = " or ".join(ends) or f"not within {low} to {high}"
    return Row(words, unit, (text(float(change["value_now"])), other_better), name)


def change_words(name: str) -> tuple[str, str]:
    """Returns words and unit of what may be otherwise than assumed."""
    if name in CHANGE_WORDS:
        return CHANGE_WORDS[name]
    measure = LIMITED[name.removeprefix(LIMIT_KEY)]
    return f"{'required' if measure.falls else 'permitted'} {measure.words}", measure.unit


def brief_rows(points: Sequence[xr.Dataset]) -> list[Row]:
    """Returns the lives at points, the worst of some measures, and the violated requirements."""
    life_row = Row("life", "h", tuple(float(point["life"]) for point in points), "life")
    rows = []
    for measure in SHORT_TABLE:
        worst = [measure.worst(point) for point in points]
        rows.append(_measure_row(measure, measure.short, worst, measure.key))
    end_label, _ = RECOMMENDED_WORDS[AT_END]
    end = quantity_row(end_label, "N", [point[AT_END] for point in points], AT_END)
    violations = Row("requirements violated", "", tuple(map(violated_words, points)))
    return [life_row, *rows, end, violations]


def violated_words(point: xr.Dataset) -> str:
    """Returns which requirements a point violates, or why it has no life."""
    if int(point["status"]) != OK:
        return f"not solved: {name_in_words(STATUS_NAMES[int(point['status'])])}"
    limits = limits_of(point)
    margins = zip(limits.effective, limit_margins(point, limits), strict=True)
    violated = [LIMITED[name].words for name, margin in margins if not margin >= -SAME]
    if flag := int(point["impractical"]):
        violated.append(f"impractical design: {name_in_words(IMPRACTICAL_FLAGS[flag])}")
    if float(point["life"]) == 0.0 and (ending := ending_measure(point)) is not None:
        violated.append(f"{ending.words}: end-of-life criterion met when new")
    return ", ".join(violated) or NONE_VIOLATED


def _map_block(design: xr.Dataset) -> Block:
    """Returns every preload of the map, by each method, at the scene's friction and speed."""
    scene, lines = scene_of(design), methods(line_of_scene(design))
    preloads, names, points = [], [], []
    for k, preload in enumerate(design["preload"].values):
        for method, line in lines:
            preloads.append(float(preload))
            names.append(method_words(scene, method))
            points.append(line.isel(preload=k))
    rows = [
        Row("preload", "N", tuple(preloads), "preload", given=True),
        Row("preload method", "", tuple(names), "preload_method"),
        *brief_rows(points),
    ]
    return Block("Life and requirements against preload", rows=tuple(rows), axes=2, place="charted")
