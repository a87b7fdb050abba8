"""What the design study answers: which preload to take, what holds it, how far that holds."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.document.bearing_line import bearing_line
from bearingwear.plotting.drawing import methods, percent_in_text, scene_of
from bearingwear.results.answer import Answer, AnswerTable
from bearingwear.results.pair_variables import is_pair, method_words
from bearingwear.results.quantiles import (
    BEARINGS_BETWEEN,
    RECOMMENDED,
    Spread,
    band_by_wear,
    causes_told,
    load_quantiles,
    spread_cells,
    spreads_of,
)
from bearingwear.results.units import Rough, digits, in_print
from bearingwear.results.warnings import warnings_in
from bearingwear.scene.scene import COUNTS
from bearingwear.studies.dataset import counted
from bearingwear.studies.design.beside import (
    beside_table,
    beside_told,
    load_beside,
    passed,
)
from bearingwear.studies.design.choice import (
    ACTIVE,
    limits_of,
    preload_text,
)
from bearingwear.studies.design.draw import design_files
from bearingwear.studies.design.figures import at_scene
from bearingwear.studies.design.map import WORN_GROOVE
from bearingwear.studies.design.recommend import best_method
from bearingwear.studies.design.show import (
    ROOM_COLUMNS,
    ROOM_TOLD,
    RoomRow,
    cliffs_told,
    room_rows,
    track_told,
)
from bearingwear.studies.design.tables import none_because
from bearingwear.studies.design.verdict import CLAIMED, NEITHER_LONGER
from bearingwear.studies.design.words import (
    GROOVE_WORDS,
    HERTZIAN_LIFE_WORDS,
    NONE_BECAUSE,
    brief_cells,
    brief_units,
    held_words,
    limit_text,
    without_limits,
)

TAKE = {
    "constant_force": "a spring of {} N (constant force)",
    "fixed_position": "a fixed position preloaded with {} N",
    "spring pair": "a spring pair at {} N",
    "rigid pair": "a rigid pair preloaded with {} N",
}
"""How a preload is applied, in the words of the headline, by method or pair."""

_HELD = {
    "none": "No limit decides: the life is longest there.",
    "end_of_range": "The map ends there; a longer life may lie beyond it.",
    "not_solved": "The next preload of the map could not be solved; a longer life may lie there.",
    "end_of_life": "No limit decides: at other preloads something else ends the life sooner.",
    "impractical": "With a preload of a longer life nobody would build or run the bearing.",
    "cliff": "The life falls suddenly beside it.",
}
"""Why no other preload has a longer life, where no limit decides."""

NO_CLOCK = (
    "Compare lives with each other, and promise no hours: a life is inversely proportional to the "
    "wear coefficient, which is known to an order of magnitude at best."
)

CALIBRATED = (
    "Wear and friction come from {rows} tests ({tests}): the interval of the hours is what they "
    "leave unknown, with the scatter between bearings."
)

_COUNTED_WORDS = ("the balls alone", "balls and races")
"""What wear counts, in the order of `COUNTS`."""


def design_answer(
    design: Path,
    recommendation: Path,
    uncertainty: Path | None = None,
    beside: Path | None = None,
    spread: Path | None = None,
) -> str:
    """Step: which preload to take, as JSON.

    Parameters
    ----------
    design, recommendation, uncertainty : path
        As of `design_files`.
    beside : path, optional
        Lives at the recommended preloads with other assumptions (`lives_beside`).
    spread : path, optional
        Quantiles of lives at the recommended preloads, in place of `uncertainty`.
    """
    files = design_files(design, recommendation, uncertainty)
    others = None if beside is None else load_beside(beside, files.recommendation)
    sampled = files.uncertainty if spread is None else load_quantiles(spread)
    return preload_answer(files.design, files.recommendation, sampled, others).as_json()


def preload_answer(
    design: xr.Dataset,
    recommendation: xr.Dataset,
    uncertainty: xr.Dataset | None = None,
    beside: xr.Dataset | None = None,
) -> Answer:
    """Which preload to take for a scene."""
    scene, room = scene_of(recommendation), room_rows(recommendation)
    spread = _spreads(recommendation, uncertainty)
    best = best_method(recommendation)
    points: list[tuple[str, list[str]]] = []
    if best is not None:
        told = [] if beside is None else beside_told(beside, recommendation, best)
        points = [
            ("What it gives", [_gives(recommendation)]),
            ("What limits it", [_held(_lives(recommendation)[0][1]), *_cliffs(recommendation)]),
            ("What would change it", [_holds(room, recommendation), *told]),
            ("How sure", _sure(recommendation, spread)),
        ]
    none = none_because(recommendation)
    missing = "What is not possible" if limits_of(recommendation).given else "What a limit does"
    points += [(missing, none)] if none else []
    notes = [("Limits, from new to the end of life", [_limits(design)])]
    warned = [
        f"{one['sentence'][0].upper()}{one['sentence'][1:]}; {one['advice']}."
        for one in warnings_in(recommendation.attrs)
    ]
    notes += [("Warnings, at their worst", warned)] if warned else []
    return Answer(
        scene=scene["name"],
        bearing=bearing_line(scene),
        rank=0,
        title="The preload to take",
        headline=_headline(design, recommendation),
        points=points,
        notes=notes,
        tables=[
            *([] if best is None else [_recommended(recommendation, spread)]),
            *([] if beside is None else [beside_table(beside, recommendation)]),
            _over_preload(design, recommendation),
            *([_room(room, recommendation)] if room else []),
        ],
        figures=["design", "map", "uncertainty"],
    )


def _lives(recommendation: xr.Dataset) -> list[tuple[str, xr.Dataset, float]]:
    """Each method that has a preload, and its life [h]; the longest first."""
    basis = counted(recommendation)
    found = [
        (method, one, float(one["life"].isel(loss_basis=basis)))
        for method, one in methods(recommendation)
    ]
    return sorted((each for each in found if math.isfinite(each[2])), key=lambda each: -each[2])


def _words(found: xr.Dataset, method: str) -> str:
    """A method in words, of a pair which pair it is."""
    return method_words(scene_of(found), method)


def _headline(design: xr.Dataset, recommendation: xr.Dataset) -> str:
    scene = scene_of(recommendation)
    name = scene["name"]
    taken = [
        TAKE[method_words(scene, method) if is_pair(scene) else method].format(preload_text(one))
        for method, one, _ in _lives(recommendation)
    ]
    if not limits_of(recommendation).given:
        return f"{name}: {without_limits(recommendation.attrs[NONE_BECAUSE])[0]}"
    if not taken:
        return f"{name}: no preload keeps to all limits"
    if int(recommendation["verdict"]) == NEITHER_LONGER:
        return f"{name}: neither method lasts longer; take {' or '.join(taken)}"
    one = _lives(recommendation)[0][1]
    end = ""
    if ACTIVE[int(one["active_limit"])] == "end_of_range":
        least = float(one["preload"]) < float(design["preload"].mean())
        end = f", the {'least' if least else 'largest'} preload tried"
    below = float(one["cliff_preload"])
    if math.isfinite(below):
        near = percent_in_text(abs(below / float(one["preload"]) - 1.0))
        life = Rough(one["cliff_life"]).text
        end = f"; with {near} {'less' if below < one['preload'] else 'more'} it lasts {life} h"
    return f"{name}: take {taken[0]}{end}"


def _gives(recommendation: xr.Dataset) -> str:
    lives = _lives(recommendation)
    life = lives[0][2]
    said = f"{Rough(life).text} h of life, counting {_COUNTED_WORDS[counted(recommendation)]}"
    if len(lives) > 1:
        other, twin, less = lives[1]
        ratio = life / less if less else math.inf
        more = f"{percent_in_text(ratio - 1.0)} more than"
        times = more if ratio < 1.1 else f"{ratio:.2g} times"
        words = _words(recommendation, other)
        words = f"a {words}" if is_pair(scene_of(recommendation)) else words
        said += f": {times} the {Rough(less).text} h of {words} at {preload_text(twin)} N"
    return f"{said}."


def _held(one: xr.Dataset) -> str:
    """What keeps a preload from another one with a longer life."""
    name = ACTIVE[int(one["active_limit"])]
    given = limits_of(one).given
    if name not in given:
        return _HELD[name]
    limit = given[name]
    return f"A preload with a longer life would pass a limit: {limit_text(name, limit)}."


def _cliffs(recommendation: xr.Dataset) -> list[str]:
    return [f"{text[0].upper()}{text[1:]}." for text in cliffs_told(recommendation)]


def _limits(design: xr.Dataset) -> str:
    given = limits_of(design).given
    said = "; ".join(limit_text(name, value) for name, value in given.items()) or "none"
    return f"{said[0].upper()}{said[1:]}."


def _holds(room: Sequence[RoomRow], recommendation: xr.Dataset) -> str:
    """Which assumption reverses the choice of the method."""
    lives = _lives(recommendation)
    if len(lives) < 2:
        return "The other method has no preload within the limits."
    said = []
    for one in room:
        ends = [
            f"{way} {digits(end)}"
            for way, end in (("below", one.low), ("above", one.high))
            if math.isfinite(end)
        ]
        if ends:
            unit = f"\N{NO-BREAK SPACE}{in_print(one.unit)}" if one.unit else ""
            label = one.label.replace("end: ", "an end of life by ")
            said.append(f"{label} {' or '.join(ends)}{unit} (now {digits(one.now)})")
    if not said:
        return "No limit, end of life or friction tried makes the other method better."
    other = _words(recommendation, lives[1][0]).capitalize()
    return f"{other} is the better method with {'; '.join(said)}."


def _spreads(
    recommendation: xr.Dataset, uncertainty: xr.Dataset | None
) -> dict[str, Spread | None]:
    """Of the life at the recommended preload of each method, where it was sampled."""
    scene, way = scene_of(recommendation), COUNTS[counted(recommendation)]
    known = [] if uncertainty is None else [uncertainty]
    mu = scene["friction"]["ball_race"]
    return {
        method: (spreads_of(known, scene, method, mu, RECOMMENDED) or {}).get(way)
        for method, _ in methods(recommendation)
    }


def _sure(recommendation: xr.Dataset, spread: Mapping[str, Spread | None]) -> list[str]:
    method, one, life = _lives(recommendation)[0]
    error = float(one["life_error_estimate"].isel(loss_basis=counted(recommendation)))
    said = []
    if int(recommendation["verdict"]) == NEITHER_LONGER:
        said.append(
            f"Neither method can be said to last longer: a change of {100 * CLAIMED:g} % in one "
            "assumption, or the other ball track, would reverse the order."
        )
    if mine := spread[method]:
        said.append(f"{mine.sentence}, over all that is uncertain.")
    else:
        band, taken = band_by_wear(scene_of(recommendation), life)
        if band:
            by_table = f" ({taken})" if taken else ""
            said.append(f"{BEARINGS_BETWEEN} last {band.text} h by wear alone{by_table}.")
    by = scene_of(recommendation).get("calibrated")
    said += [CALIBRATED.format(**by) if by else NO_CLOCK, *track_told(recommendation)]
    if math.isfinite(error):
        said.append(f"The numerical error of the life is about {percent_in_text(error)}.")
    return said


def _recommended(recommendation: xr.Dataset, spread: Mapping[str, Spread | None]) -> AnswerTable:
    """The preload to take by each method, and the bearing with it."""
    basis = counted(recommendation)
    columns = [one for _, one in methods(recommendation)]

    def hours(name: str, way: int) -> list[str]:
        return [digits(float(one[name].isel(loss_basis=way))) for one in columns]

    rows = [["preload to set (N)", *map(preload_text, columns)]]
    worn = [int(one["groove"]) == WORN_GROOVE for one in columns]
    groove = f", groove {GROOVE_WORDS['worn']}" if any(worn) else ""
    rows.append([f"life{groove} (h)", *hours("life", basis)])
    if groove:
        rows.append([f"life {HERTZIAN_LIFE_WORDS} (h)", *hours("hertzian_life", basis)])
    rows += [[label, *cells] for label, cells in spread_cells([*spread.values()]).items()]
    rows.append([f"life, counting {_COUNTED_WORDS[1 - basis]} (h)", *hours("life", 1 - basis)])
    units = brief_units(recommendation)
    cells = zip(*(brief_cells(units, one) for one in columns), strict=True)
    rows += [[unit.label(label), *texts] for (label, unit), texts in zip(units, cells, strict=True)]
    rows.append(
        [
            "held by",
            *(held_words(ACTIVE[int(one["active_limit"])], one.__getitem__) for one in columns),
        ]
    )
    return AnswerTable(
        title="At the preload to take",
        columns=["", *(_words(recommendation, name) for name, _ in methods(recommendation))],
        rows=rows,
        note="Stiffness, power, pressure and slip are the worst from new to the end of life."
        + (f" {causes_told(scene_of(recommendation))}" if any(spread.values()) else ""),
    )


def _over_preload(design: xr.Dataset, recommendation: xr.Dataset) -> AnswerTable:
    """Every preload of the map, by each method, at the scene's friction and speed."""
    line = at_scene(design)
    basis = counted(design)
    units = brief_units(line)
    rows = [
        [
            f"{preload:g}",
            _words(design, method),
            digits(float(one["life"].isel(loss_basis=basis))),
            *brief_cells(units, one),
            passed(one),
        ]
        for k, preload in enumerate(line["preload"].values)
        for method, of_method in methods(line)
        for one in [of_method.isel(preload=k)]
    ]
    preloads, best = line["preload"].values, best_method(recommendation)
    taken = scene_of(design)["operation"]["preload_N"]
    if best is not None:
        taken = float(recommendation["preload"][best])
    return AnswerTable(
        title="Life and limits over the preload",
        columns=[
            "preload (N)",
            "preload method",
            "life (h)",
            *(unit.label(label) for label, unit in units),
            "limits passed",
        ],
        rows=rows,
        slider=True,
        start=f"{preloads[np.abs(preloads - taken).argmin()]:g}",
    )


def _room(room: Sequence[RoomRow], recommendation: xr.Dataset) -> AnswerTable:
    rows = [
        [
            f"{one.label} ({in_print(one.unit)})" if one.unit else one.label,
            *map(digits, one.numbers),
        ]
        for one in room
    ]
    return AnswerTable(
        title="How far the choice of the method holds",
        columns=["assumed", *ROOM_COLUMNS],
        rows=rows,
        note=" ".join([ROOM_TOLD, *track_told(recommendation)]),
    )
