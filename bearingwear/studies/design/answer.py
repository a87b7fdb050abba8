"""What the design study answers: which preload to take, what holds it, how far that holds."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.plotting.drawing import in_words, methods, percent_in_text, scene_of
from bearingwear.results.answer import Answer, AnswerTable
from bearingwear.results.bearing_line import bearing_line
from bearingwear.results.quantiles import QUANTILES_TEXT, RECOMMENDED, Quantile, quantiles_of
from bearingwear.results.units import digits, display, in_print
from bearingwear.results.warnings import warnings_in
from bearingwear.scene.scene import COUNTS
from bearingwear.studies.dataset import counted
from bearingwear.studies.design.choice import (
    ACTIVE,
    LIMITED,
    limit_margins,
    limits_of,
    preload_text,
)
from bearingwear.studies.design.draw import design_files
from bearingwear.studies.design.figures import at_scene
from bearingwear.studies.design.recommend import best_method
from bearingwear.studies.design.show import ROOM_COLUMNS, ROOM_TOLD, room_rows
from bearingwear.studies.design.tables import none_because
from bearingwear.studies.design.words import LIMIT_WORDS, ROOM, limit_text

TAKE = {
    "constant_force": "a spring of {} N (constant force)",
    "fixed_position": "a fixed position preloaded with {} N",
}
"""How a preload is applied, in the words of the headline."""

HELD = {
    "none": "No limit holds it: the life is longest there.",
    "end_of_range": "The map ends there; a longer life may lie beyond it.",
    "not_solved": "The next preload of the map could not be solved; a longer life may lie there.",
    "end_of_life": "No limit holds it: at other preloads something else ends the life sooner.",
}
"""What keeps a preload from one with a longer life, where that is no limit."""

CLOSE = 0.05
"""By how much, relative, a limit or an end of life has to move at least before the other method is
the better one, so that one of them can be said to last longer."""

NO_CLOCK = (
    "Compare lives with each other, not with a clock: they go with hardness over wear coefficient, "
    "and a wear coefficient is known to an order of magnitude at best."
)

SHOWN = {
    "axial_stiffness": ("axial stiffness", ""),
    "system_axial_stiffness": ("stiffness, arrangement", ""),
    "maximum_pressure": ("pressure", ""),
    "friction_power": ("friction power", ""),
    "gyroscopic_slip_share": ("gyroscopic slip share", "%"),
    "residual_preload_at_end": ("preload left at the end", ""),
}
"""What stands beside a life: of each the worst from new to the end of life."""


def design_answer(design: Path, recommendation: Path, uncertainty: Path | None = None) -> str:
    """Step: which preload to take, as JSON."""
    files = design_files(design, recommendation, uncertainty)
    return answer_of(files.design, files.recommendation, files.uncertainty).as_json()


def answer_of(
    design: xr.Dataset, recommendation: xr.Dataset, uncertainty: xr.Dataset | None
) -> Answer:
    """Which preload to take for a scene."""
    scene = scene_of(recommendation)
    name, best = scene["name"], best_method(recommendation)
    room = room_rows(*(recommendation.attrs.get(part, "{}") for part in (ROOM, "limits", "scene")))
    notes = [("Limits, from new to the end of life", [_limits(design)])]
    points: list[tuple[str, list[str]]] = []
    if best is None:
        headline = f"{name}: no preload keeps to all limits"
    else:
        spread = _spread(recommendation, uncertainty)
        apart = _apart(recommendation) and not _close(room)
        headline = _headline(recommendation, best, apart)
        points = [
            ("What it gives", _gives(recommendation, best)),
            ("What limits it", [_held(recommendation.isel(preload_method=best))]),
            ("How far it holds", _holds(room, recommendation)),
            ("How sure that is", _sure(recommendation, best, spread)),
        ]
    none = none_because(recommendation)
    points += [("What is not possible", none)] if none else []
    warned = [f"{one['sentence']}; {one['advice']}." for one in warnings_in(recommendation.attrs)]
    notes += [("Warnings, at their worst", warned)] if warned else []
    tables = [] if best is None else [_recommended(recommendation, spread)]
    tables += [_over_preload(design, recommendation)]
    tables += [_room(room)] if room else []
    return Answer(
        scene=name,
        bearing=bearing_line(scene),
        rank=0,
        title="The preload to take",
        headline=headline,
        points=points,
        notes=notes,
        tables=tables,
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


def _apart(recommendation: xr.Dataset) -> bool:
    """Whether the lives differ by more than their numerical errors."""
    lives, basis = _lives(recommendation), counted(recommendation)
    if len(lives) < 2:
        return True
    errors = [float(one["life_error_estimate"].isel(loss_basis=basis)) for _, one, _ in lives]
    return lives[0][2] / lives[1][2] - 1.0 > np.nansum(errors)


def _close(room: Sequence[tuple[str, str, str, tuple[float, float, float]]]) -> list[str]:
    """Limits and ends of life that need not move far to make the other method the better one."""
    return [
        label
        for _, label, _, (low, now, high) in room
        if any(abs(end / now - 1.0) < CLOSE for end in (low, high) if math.isfinite(end))
    ]


def _headline(recommendation: xr.Dataset, best: int, apart: bool) -> str:
    name = scene_of(recommendation)["name"]
    taken = [TAKE[method].format(preload_text(one)) for method, one, _ in _lives(recommendation)]
    if not apart:
        return f"{name}: neither method lasts longer; take {' or '.join(taken)}"
    return f"{name}: take {taken[0]}"


def _gives(recommendation: xr.Dataset, best: int) -> list[str]:
    lives = _lives(recommendation)
    method, one, life = lives[0]
    way = in_words(COUNTS[counted(recommendation)])
    said = f"It lives {digits(life)} h, counting the wear of {way}"
    if len(lives) > 1:
        other, twin, less = lives[1]
        ratio = life / less if less else math.inf
        times = (
            f"{ratio:.2g} times" if ratio >= 1.1 else f"{percent_in_text(ratio - 1.0)} more than"
        )
        said += f": {times} the {digits(less)} h of {in_words(other)} at {preload_text(twin)} N"
    return [f"{said}."]


def _held(one: xr.Dataset) -> str:
    """What keeps a preload from another one with a longer life."""
    name = ACTIVE[int(one["active_limit"])]
    if name not in LIMITED:
        return HELD[name]
    limit = limits_of(one).given[name]
    return f"A preload with a longer life would pass a limit: {limit_text(name, limit)}."


def _limits(design: xr.Dataset) -> str:
    given = limits_of(design).given
    return f"{'; '.join(limit_text(name, value) for name, value in given.items()) or 'none'}."


def _holds(
    room: Sequence[tuple[str, str, str, tuple[float, float, float]]], recommendation: xr.Dataset
) -> list[str]:
    """Which limit or end of life turns the choice of the method round."""
    if len(_lives(recommendation)) < 2:
        return ["The other method has no preload within the limits."]
    said = []
    for _, label, unit, (low, now, high) in room:
        ends = [
            f"{way} {digits(end)}"
            for way, end in (("below", low), ("above", high))
            if math.isfinite(end)
        ]
        if ends:
            unit = f"\N{NO-BREAK SPACE}{in_print(unit)}"
            said.append(f"{label.removeprefix('end: ')} {' or '.join(ends)}{unit} (now {now:g})")
    if not said:
        return ["No limit and no end of life turns it round, as far as it was looked."]
    close = _close(room)
    sure = f" The first within {100 * CLOSE:g} % of it." if close else ""
    return [f"The other method is the better one with {'; '.join(said)}.{sure}"]


def _spread(
    recommendation: xr.Dataset, uncertainty: xr.Dataset | None
) -> dict[str, Sequence[Quantile]]:
    """L10 and L50 at the recommended preload of each method, where they were sampled."""
    scene, way = scene_of(recommendation), COUNTS[counted(recommendation)]
    known = [] if uncertainty is None else [uncertainty]
    mu = scene["friction"]["ball_race"]
    return {
        method: (quantiles_of(known, scene, method, mu, RECOMMENDED) or {}).get(way, ())
        for method, _ in methods(recommendation)
    }


def _sure(
    recommendation: xr.Dataset, best: int, spread: dict[str, Sequence[Quantile]]
) -> list[str]:
    method, one, _ = _lives(recommendation)[0]
    error = float(one["life_error_estimate"].isel(loss_basis=counted(recommendation)))
    quantiles = ", ".join(q.text for q in spread[method])
    said = [f"{quantiles}."] if quantiles else []
    if math.isfinite(error):
        said.append(f"The numerical error of the life is about {percent_in_text(error)}.")
    return [*said, NO_CLOCK]


def _recommended(recommendation: xr.Dataset, spread: dict[str, Sequence[Quantile]]) -> AnswerTable:
    """The preload to take by each method, and the bearing with it."""
    basis = counted(recommendation)
    columns = methods(recommendation)

    def hours(way: int) -> list[str]:
        return [digits(float(one["life"].isel(loss_basis=way))) for _, one in columns]

    rows = [["preload to set (N)", *(preload_text(one) for _, one in columns)]]
    rows.append(["life (h)", *hours(basis)])
    for name in ("L10", "L50") if any(spread.values()) else ():
        hours_of = {method: {q.name: q.hours for q in found} for method, found in spread.items()}
        known = [hours_of[method].get(name, math.nan) for method, _ in columns]
        rows.append([f"{name} (h)", *map(digits, known)])
    rows.append([f"life, counting {in_words(COUNTS[1 - basis])} (h)", *hours(1 - basis)])
    for name, (label, shown) in SHOWN.items():
        values = recommendation[name]
        unit = display(values.attrs["units"], values, shown=shown)
        rows.append([unit.label(label), *(unit.text(one[name]) for _, one in columns)])
    held = [LIMIT_WORDS[ACTIVE[int(one["active_limit"])]] for _, one in columns]
    rows.append(["held by", *held])
    return AnswerTable(
        title="At the preload to take",
        columns=["", *(in_words(method) for method, _ in columns)],
        rows=rows,
        note="Stiffness, pressure, power and slip are the worst from new to the end of life."
        + (f" {QUANTILES_TEXT}" if any(spread.values()) else ""),
    )


def _over_preload(design: xr.Dataset, recommendation: xr.Dataset) -> AnswerTable:
    """Every preload of the map, by each method, at the scene's friction and speed."""
    line, limits = at_scene(design), limits_of(design)
    basis = counted(design)
    shown = {
        name: (label, display(line[name].attrs["units"], line[name], shown=as_))
        for name, (label, as_) in SHOWN.items()
    }
    rows = []
    for k, preload in enumerate(line["preload"].values):
        for method, of_method in methods(line):
            one = of_method.isel(preload=k)
            passed = [
                LIMIT_WORDS[name]
                for name, margin in zip(limits.given, limit_margins(one, limits), strict=True)
                if not float(margin) >= 0.0
            ]
            solved = int(one["status"]) == OK
            rows.append(
                [
                    f"{preload:g}",
                    in_words(method),
                    digits(float(one["life"].isel(loss_basis=basis))),
                    *(unit.text(one[name]) for name, (_, unit) in shown.items()),
                    (", ".join(passed) or "none")
                    if solved
                    else f"not solved: {in_words(STATUS_NAMES[int(one['status'])])}",
                ]
            )
    best = best_method(recommendation)
    taken = float(recommendation["preload"][best]) if best is not None else math.inf
    nearest = int(np.abs(line["preload"].values - min(taken, 1e300)).argmin())
    return AnswerTable(
        title="Life and limits over the preload",
        columns=[
            "preload (N)",
            "preload method",
            "life (h)",
            *(unit.label(label) for label, unit in shown.values()),
            "limits passed",
        ],
        rows=rows,
        slider=True,
        start=f"{line['preload'].values[nearest]:g}",
    )


def _room(room: Sequence[tuple[str, str, str, tuple[float, float, float]]]) -> AnswerTable:
    rows = [
        [f"{label} ({in_print(unit)})", *map(digits, numbers)] for _, label, unit, numbers in room
    ]
    return AnswerTable(
        title="How far the choice of the method holds",
        columns=["limit", *ROOM_COLUMNS],
        rows=rows,
        note=ROOM_TOLD,
    )
