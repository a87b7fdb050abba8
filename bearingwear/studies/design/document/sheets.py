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
from bearingwear.results.quantiles import RECOMMENDED, Spread, load_quantiles, spread_of
from bearingwear.results.units import Rough, ascii_text, digits
from bearingwear.results.variable import SECONDS_PER_HOUR
from bearingwear.results.warnings import WARNING, warning_line
from bearingwear.results.words import methods, name_in_words, plain_scene
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
    no_preload_sentences,
    no_preload_title,
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
    """Step: returns the document of a recommended preload as JSON for the page.

    design, recommendation, uncertainty: files of a map, of its recommendation and of the study of
        uncertainty.
    spread: file of quantiles of lives at the recommended preloads, in place of `uncertainty`.
    """
    lives, recommended, sampled = design_files(design, recommendation, uncertainty)
    if spread is not None:
        sampled = load_quantiles(spread)[0]
    return preload_document(recommended, lives, sampled).stored


def tables(design: Path, recommendation: Path, uncertainty: Path | None = None) -> tuple[str, str]:
    """Step: returns the whole map as CSV, and the document of the recommendation as Markdown.

    The arguments are those of `design_answer`.
    """
    lives, recommended, sampled = design_files(design, recommendation, uncertainty)
    heads = ("preload_method", "friction", "shaft_speed (rpm)", "preload (N)")
    document = preload_document(recommended, lives, sampled)
    return dataset_csv(lives, dict(zip(MAP_AXES, heads, strict=True))), as_markdown(document)


def recommendation_sheet(file: Any) -> Document:
    """Returns the document of a recommendation alone.

    file: open netCDF file.
    """
    return preload_document(load(file.filepath()))


def preload_document(
    recommendation: xr.Dataset,
    design: xr.Dataset | None = None,
    uncertainty: xr.Dataset | None = None,
) -> Document:
    """Returns the document of the recommended preload of a scene.

    design: a map of lives beside the recommendation.
    uncertainty: quantiles of the lives at the recommended preloads.
    """
    scene = plain_scene(recommendation)
    warnings = stated_warnings(recommendation)
    spreads = recommended_spreads(recommendation, uncertainty)
    has_preload = bool(recommended_points(recommendation))
    blocks = []
    if has_preload:
        expected_life = life_sentence(recommendation, spreads)
        lines = (expected_life, *bound_lines(scene), *similar_life_sentences(recommendation))
        blocks.append(Block("Expected life", lines=lines, place="verdict"))
        blocks.append(_setting_block(recommendation))
    blocks += _no_preload_blocks(recommendation)
    if has_preload:
        blocks += [_recommended_block(recommendation, spreads), _changes_block(recommendation)]
    if warnings:
        lines = tuple(f"{sentence(w['sentence'])} {sentence(w['advice'])}" for w in warnings)
        blocks.append(Block("Warnings (worst values)", lines=lines, place="strip"))
    blocks += machine_blocks(recommendation)
    if design is not None:
        blocks.append(_map_block(design))
    if uncertainty is not None:
        blocks += sampled_blocks(uncertainty)
    subtitle = f"{conditions_words(recommendation)}; {_friction_words(scene)}"
    return Document(
        heading=(headline(recommendation), subtitle),
        facts=_facts(recommendation, warnings),
        blocks=tuple(blocks),
        figures=("design", "map", "uncertainty"),
        subject="Recommended preload" if has_preload else "Preload",
    )


def _facts(recommendation: xr.Dataset, warnings: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Returns the facts of the document, by the keys under which JSON shows them.

    warnings: of `stated_warnings`.
    """
    scene = plain_scene(recommendation)
    limits = limits_of(recommendation).given
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
        "warnings": [warning_line(warning).removeprefix(WARNING) for warning in warnings],
    }


def _setting_block(recommendation: xr.Dataset) -> Block:
    """Returns sentences on what to specify, the maker's minimum, and how far to trust the life."""
    lines = (
        setting_sentence(recommendation),
        *makers_minimum_sentences(recommendation),
        trust_sentence(recommendation),
    )
    return Block("Setting the preload", lines=lines, place="lead")


def _no_preload_blocks(recommendation: xr.Dataset) -> list[Block]:
    """Returns a list with a block on why a method has no preload, or why to state a requirement.

    It is empty if each method has a preload.
    """
    reasons = no_preload_sentences(recommendation)
    if not reasons:
        return []
    has_limits = bool(limits_of(recommendation).given)
    title = no_preload_title(recommendation) if has_limits else "Effect of a requirement"
    has_preload = bool(recommended_points(recommendation))
    minimum = [] if has_preload else makers_minimum_sentences(recommendation)
    return [Block(title, lines=(*reasons, *minimum), place="lead")]


def _friction_words(scene: Mapping[str, Any]) -> str:
    """Returns words for the ball-race friction of a scene: a coefficient, or a film."""
    mu = scene["friction"].get("ball_race")
    return "friction of a film" if mu is None else f"friction {mu:g}"


def recommended_spreads(
    recommendation: xr.Dataset, uncertainty: xr.Dataset | None
) -> dict[str, Spread | None]:
    """Returns the spread of the life at each recommended preload, by method; None without one."""
    scene = plain_scene(recommendation)
    uncertainties = [] if uncertainty is None else [uncertainty]
    mu = scene["friction"].get("ball_race")
    return {
        method: spread_of(uncertainties, scene, method, mu, RECOMMENDED)
        for method, _ in methods(recommendation)
    }


def _recommended_block(recommendation: xr.Dataset, spreads: Mapping[str, Spread | None]) -> Block:
    """Returns a table of the preload of each method, its limit, its life, and its worst values.

    spreads: of the lives, as from `recommended_spreads`.
    """
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

    def preload_row(label: str, name: str) -> Row:
        return Row(label, "N", _floats(recommendation[name]), name, given=True)

    points = methods(recommendation)
    offsets = tuple(
        spacer_offset(recommendation, float(point["preload"]))
        if method == "fixed_position" and point["status"] == OK
        else math.nan
        for method, point in points
    )
    rows = [
        preload_row("initial preload", "preload"),
        _tolerance_row(recommendation, "  lower tolerance limit", "least_preload"),
        _tolerance_row(recommendation, "  upper tolerance limit", "most_preload"),
    ]
    if np.isfinite(offsets).any():
        rows.append(Row("  spacer offset", "um", offsets, "spacer_offset"))
    limited_by = tuple(_limited_by_words(point) for _, point in points)
    return [*rows, Row("limited by", "", limited_by, "active_limit")]


def _tolerance_row(recommendation: xr.Dataset, label: str, name: str) -> Row:
    """Returns a row of one end of the tolerance, which the preload with the longest life has alone.

    name: of the variable with that end.
    """
    has_preload = np.isfinite(recommendation["preload"])
    values = tuple(
        NO_TOLERANCE if math.isnan(limit) and recommended else limit
        for limit, recommended in zip(_floats(recommendation[name]), has_preload, strict=True)
    )
    return Row(label, "N", values, name, given=True)


def _limited_by_words(point: xr.Dataset) -> str:
    """Returns the words for what keeps the preload of a method from one with a longer life.

    point: recommendation of the method.
    """
    name = ACTIVE[int(point["active_limit"])]
    return active_limit_words(name, lambda extreme: float(point[extreme]))


def _life_rows(recommendation: xr.Dataset, spreads: Mapping[str, Spread | None]) -> list[Row]:
    """Returns rows of the lives, their numerical error, their grooves and their spread.

    spreads: of the lives by method; None where it was not sampled.
    """
    scene = plain_scene(recommendation)
    lives = _floats(recommendation["life"])
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
    if not any(spreads.values()):  # sampled spreads include the uncertainty of wear
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
    """Returns rows of the worst values from new to the end of life, and of the preload at the end.

    The values are of the measures of short tables and of limited measures, if they are known.
    """
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
    preloads_at_end = recommendation[AT_END].values
    if np.isfinite(preloads_at_end).any():
        label, _ = RECOMMENDED_WORDS[AT_END]
        rows.append(quantity_row(label, "N", preloads_at_end, AT_END))
    return rows


def _measure_row(measure: Measure, label: str, values: Iterable[Any], name: str) -> Row:
    """Returns the row of values [SI] of a measure, in the unit of its limit."""
    unit = "" if measure.unit == "1" else measure.unit
    return Row(label, unit, tuple(float(measure.shown(value)) for value in values), name)


def _worst_note(recommendation: xr.Dataset, name: str) -> str:
    """Returns the conditions in which a quantity is the worst with each method, in words.

    A life over a duty that ends by a depth of wear ends in all phases.

    name: of the quantity, or `active_limit` for the quantity that limits the preload.
    """
    words = []
    is_life_over_duty = name == "life" and bool(plain_scene(recommendation).get("duty"))
    for _, point in methods(recommendation):
        if is_life_over_duty and (end := ending_measure(point)) and end.of_wear:
            words.append("all phases")
            continue
        active = ACTIVE[int(point["active_limit"])]
        is_of_limit = name == "active_limit" and active in LIMITED
        extreme = critical_extreme(point, active) if is_of_limit else name
        words.append(brief_condition_words(recommendation, point, extreme))
    return " / ".join(dict.fromkeys(word for word in words if word))


def _floats(values: Iterable[Any]) -> tuple[float, ...]:
    """Returns the values of a variable as built-in floats."""
    return tuple(float(value) for value in values)


def _changes_block(recommendation: xr.Dataset) -> Block:
    """Returns a table of the values of assumptions at which the other method becomes better."""
    title = "What would change the choice"
    names = flag_names(recommendation["change"])
    rows = tuple(_change_row(recommendation.isel(change=k), name) for k, name in enumerate(names))
    if not rows:
        return Block(title, lines=("No other method to compare.",))
    return Block(title, ("now", "other method better"), rows, place="lead")


def _change_row(change: xr.Dataset, name: str) -> Row:
    """Returns the row of an assumption: its value now, and where the other method is better.

    change: variables of `CHANGES` at the assumption of that name.
    """
    words, unit = change_words(name)
    below = float(change["other_better_below"])
    above = float(change["other_better_above"])
    if name == GROOVE_KEY:
        preposition = "with" if math.isfinite(below) else "not with"
        return Row(words, unit, ("worn", f"{preposition} a Hertzian groove"), name)

    def value_text(value: float) -> str:
        return digits((100.0 if unit == "%" else 1.0) * value)

    phrases = []
    if math.isfinite(below):
        phrases.append(f"below {value_text(below)}")
    if math.isfinite(above):
        phrases.append(f"above {value_text(above)}")
    if not phrases:
        low = value_text(float(change["tried_from"]))
        high = value_text(float(change["tried_to"]))
        phrases.append(f"not within {low} to {high}")
    now = value_text(float(change["value_now"]))
    return Row(words, unit, (now, " or ".join(phrases)), name)


def change_words(name: str) -> tuple[str, str]:
    """Returns the words and the unit of an assumption that may change; see `Change.name`."""
    if name in CHANGE_WORDS:
        return CHANGE_WORDS[name]
    measure = LIMITED[name.removeprefix(LIMIT_KEY)]
    return f"{'required' if measure.falls else 'permitted'} {measure.words}", measure.unit


def brief_rows(points: Sequence[xr.Dataset]) -> list[Row]:
    """Returns rows of a short table of design points, with a value for each.

    They are the life, the worst values of `SHORT_TABLE`, the residual preload at the end, and the
    violated requirements.
    """
    life_row = Row("life", "h", tuple(float(point["life"]) for point in points), "life")
    rows = []
    for measure in SHORT_TABLE:
        worst = [measure.worst(point) for point in points]
        rows.append(_measure_row(measure, measure.short, worst, measure.key))
    end_label, _ = RECOMMENDED_WORDS[AT_END]
    end_row = quantity_row(end_label, "N", [point[AT_END] for point in points], AT_END)
    violations = Row("requirements violated", "", tuple(map(violated_words, points)))
    return [life_row, *rows, end_row, violations]


def violated_words(point: xr.Dataset) -> str:
    """Returns which requirements a design point violates, or why it has no life, in words.

    point: dataset of the point, with the limits in its attributes.
    """
    if int(point["status"]) != OK:
        return f"not solved: {name_in_words(STATUS_NAMES[int(point['status'])])}"
    limits = limits_of(point)
    margins = zip(limits.effective, limit_margins(point, limits), strict=True)
    violated = [
        LIMITED[name].words if name in limits.given else "a bearing lifts off"
        for name, margin in margins
        if not margin >= -SAME
    ]
    impractical_flag = int(point["impractical"])
    if impractical_flag:
        flag_name = IMPRACTICAL_FLAGS[impractical_flag]
        violated.append(f"impractical design: {name_in_words(flag_name)}")
    if float(point["life"]) == 0.0:
        ending = ending_measure(point)
        if ending is not None:
            violated.append(f"{ending.words}: end-of-life criterion met when new")
    return ", ".join(violated) or NONE_VIOLATED


def _map_block(design: xr.Dataset) -> Block:
    """Returns a table of every preload of the map, by each method, at the scene's own speed."""
    lines = methods(line_of_scene(design))
    count = design.sizes["preload"]
    points = [line.isel(preload=k) for k in range(count) for _, line in lines]
    preloads = _floats(point["preload"] for point in points)
    names = tuple(method_names(design)) * count
    rows = [
        Row("preload", "N", preloads, "preload", given=True),
        Row("preload method", "", names, "preload_method"),
        *brief_rows(points),
    ]
    return Block("Life and requirements against preload", rows=tuple(rows), axes=2, place="charted")
