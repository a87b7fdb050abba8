"""The design map: lives over preload, method, friction and speed.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.kernels.status import CRITERION_NOT_REACHED, OK, STATUS_NAMES
from bearingwear.lives.duty.lives import duty_life
from bearingwear.lives.ends import NO_CRITERION, Criteria, with_end
from bearingwear.lives.follow import Life, Node
from bearingwear.lives.groove_life import groove_choice
from bearingwear.lives.history import joined, life_values
from bearingwear.lives.many import (
    HertzianLives,
    worn_life_with_stiffness,
    worse_state,
    worse_states,
)
from bearingwear.lives.margin import least_margin
from bearingwear.measures import LIMITED
from bearingwear.results.variable import HOURS_PER_SECOND, STATUS, Variable, table
from bearingwear.results.variables import STUDY_COORDINATES
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.duty import cases_of_use
from bearingwear.scene.scene import PRELOAD_METHODS, EndOfLife, Scene
from bearingwear.solvers.bearing.launch import launch_values
from bearingwear.solvers.effects.choice import choice_for_life
from bearingwear.solvers.effects.table import WARNINGS
from bearingwear.solvers.effects.warnings import warnings_of
from bearingwear.solvers.state import State, history_values
from bearingwear.studies.answers import PROBLEM, answers_at
from bearingwear.studies.dataset import dataset_of_rows
from bearingwear.studies.design.condition_extremes import (
    Extremes,
    OtherConditions,
    Solve,
    extremes_of_life,
    new_states,
    rotor_frequency,
    state_extremes,
    worn_states,
    worst_extremes,
)
from bearingwear.studies.design.conditions import AT_END_OF_LIFE, DECIDING, NEW, OperatingCondition
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.design.warm_up_extremes import warm_up_extremes
from bearingwear.studies.solve import life_scene

SLIP_SHARE = "gyroscopic_slip_share"

GROOVE_SHAPES = ("hertzian", "worn")
HERTZIAN_GROOVE, WORN_GROOVE = range(len(GROOVE_SHAPES))

NOT_IMPRACTICAL = "none"
IMPRACTICAL_FLAGS = (
    NOT_IMPRACTICAL,
    *(warning.id for warning in WARNINGS if warning.impractical),
)
"""Warnings of a bearing that nobody would build or run, after the flag of a bearing without one.

No recommendation has a bearing with such a warning.
"""

MAP_AXES = table(
    STUDY_COORDINATES["preload_method"],
    STUDY_COORDINATES["friction"],
    Variable("shaft_speed", ("shaft_speed",), "rpm", "shaft speed"),
    Variable("preload", ("preload",), "N", "initial axial preload"),
)


def _extreme_variables() -> list[Variable]:
    """Returns variables for the worst value of every limited measure, from new to the end of life.

    Measures of a life as a whole are left out.
    """
    variables = []
    for measure in LIMITED.values():
        if measure.of_life:
            continue
        meaning, _ = measure.limit
        for name, kind in zip(measure.extremes, measure.kinds, strict=True):
            parts = [meaning[0].lower() + meaning[1:], kind, "from new to the end of life"]
            words = ", ".join(part for part in parts if part)
            comment = measure.note or None
            variables.append(Variable(name, (), measure.si_unit, words, comment=comment))
    return variables


def _start_and_end_variables() -> list[Variable]:
    """Returns variables for values when new and at the end of life, of measures in short tables."""
    return [
        Variable(f"{name}_at_{end}", (), measure.si_unit, f"{measure.words_of(name)} {when}")
        for measure in LIMITED.values()
        if measure.brief
        for name in measure.extremes
        for end, when in (("start", "when new"), ("end", "at the end of life"))
    ]


POINT = table(
    STATUS,
    Variable("end_criterion", (), "", "criterion that determines the end of life", dtype="i1",
        flags=CRITERIA),
    Variable("solves", (), "1", "number of steady states solved to compute the life", dtype="i4"),
    Variable("failed_solves", (), "1", "number of steady states not found", dtype="i4"),
    Variable("life", (), "h", "wear life", scale=HOURS_PER_SECOND),
    Variable("time_to_slip_limit", (), "h",
        "time until the gyroscopic slip share exceeds the permitted maximum",
        scale=HOURS_PER_SECOND, comment="infinite if the end of life is reached first"),
    Variable("residual_preload_at_start", (), "N", "running preload when new"),
    Variable("residual_preload_at_end", (), "N", "residual preload at the end of life"),
    Variable("loss_at_end", (), "m", "total wear depth at the end of life"),
    *_start_and_end_variables(),
    *_extreme_variables(),
    Variable("impractical", (), "", "first warning of an impractical design, new or worn",
        dtype="i1", flags=IMPRACTICAL_FLAGS),
    Variable("groove", (), "", "groove model used in the life calculation", dtype="i1",
        flags=GROOVE_SHAPES, 
        comment="worn if the scene requires worn grooves for the life calculation"),
    Variable("hertzian_life", (), "h",
        "wear life at the same preload, computed with Hertzian grooves", scale=HOURS_PER_SECOND),
)  # fmt: skip
"""Variables of a point of the map: a life, and the extremes along it.

Numbers are NaN where the life was not solved.
"""

PointValues = dict[str, Any]
"""Values of `POINT` by their names (SI), and of the keys of `NO_VARIABLES`."""

POINT_WARNINGS = "warnings"
"""Key of a point: warnings of an exact life with worn grooves, as JSON."""

CASE_POINTS = "points"
"""Key of a point of several cases: the point of each case, by its name."""

NOT_SOLVED_AT = "unsolved"
"""Key of a point: the condition that was not solved, and its status."""

NO_VARIABLES = (POINT_WARNINGS, DECIDING, NOT_SOLVED_AT, CASE_POINTS, PROBLEM)
"""Keys of points that are no variables of a file."""

NO_LIFE: PointValues = dict.fromkeys(("solves", "failed_solves", "impractical", "groove"), 0)
NO_LIFE |= {"status": -1, "end_criterion": NO_CRITERION}
"""Whole numbers of a point before any solve."""

END_WHEN_NEW = EndOfLife(maximum_pressure_GPa=1e-9)
"""An end of life that every bearing has met when new."""

_UNREACHED_THERMAL_MARGIN = 1e-9  # limit [1] that ends no life, but gives states the margin


class _SolvedLife(NamedTuple):
    """A life, and the values of its point."""

    life: Life
    values: PointValues


def life_point(scene: Scene, slip_limit: float | None) -> PointValues:
    """Returns the design point of a life with Hertzian grooves, at the scene's own speed.

    It has the values of `POINT` by their names [SI]; if the status is not OK, only `status`,
    `end_criterion`, `solves` and `failed_solves`. `time_to_slip_limit` is infinite if the share
    stays below its limit, and left out without one. Over a duty, the point is that of
    `design_point` at the speeds of its cases alone, with the grooves that the model follows.

    slip_limit: gyroscopic slip share [1], the time to which is computed; None without one.
    """
    if scene.duty is not None:
        limits = DesignLimits(gyroscopic_slip_share=slip_limit, at_speed_only=True)
        return _duty_point(scene, limits, quick=False)
    return _hertzian_life(scene, slip_limit).values


def _hertzian_life(scene: Scene, slip_limit: float | None) -> _SolvedLife:
    """Returns the life of `life_point` with its values, for a scene without a duty."""
    lives = HertzianLives(scene)
    life = lives(scene)
    values: PointValues = {"status": life.status, "end_criterion": life.criterion}
    if life.status == OK:
        values |= {"life": life.last.time} | values_of_states(scene, worse_states(life, scene))
        if slip_limit is not None:
            values["time_to_slip_limit"] = math.inf
            if values[SLIP_SHARE] >= slip_limit:
                ended_by_slip = _scene_ended_by_slip(scene, slip_limit)
                values["time_to_slip_limit"] = lives(ended_by_slip).last.time
    values["solves"] = lives.solver.solves
    values["failed_solves"] = lives.solver.failed
    return _SolvedLife(life, values)


def _scene_ended_by_slip(scene: Scene, slip_limit: float) -> Scene:
    """Returns a scene whose life ends by its gyroscopic slip share alone.

    slip_limit: gyroscopic slip share [1].
    """
    return with_end(scene, EndOfLife(gyroscopic_slip_share=slip_limit))


def _time_to_slip_limit(
    scene: Scene, life: Life, values: PointValues, slip_limit: float | None
) -> PointValues:
    """Returns `time_to_slip_limit` [s] of a solved life; an empty dictionary without a limit.

    It is infinite if the life ends before its slip share reaches the limit.

    values: of its point, among which is the largest slip share of the life.
    slip_limit: gyroscopic slip share [1].
    """
    if slip_limit is None:
        return {}
    time = math.inf
    if values[SLIP_SHARE] >= slip_limit:
        time = life.time_to(Criteria(_scene_ended_by_slip(scene, slip_limit)))
    return {"time_to_slip_limit": time}


def with_required_measures(scene: Scene, limits: DesignLimits) -> Scene:
    """Returns a scene whose states have all measures that limits need.

    States have the thermal margin, which takes further solves, only if it may end a life. So a
    scene whose margin is limited gets a criterion that no life meets, if it has an end of life.
    """
    end = scene.wear.end_of_life
    if limits.thermal_margin is None or end is None or end.thermal_margin is not None:
        return scene
    never: dict[str, Any] = {"thermal_margin": _UNREACHED_THERMAL_MARGIN}
    return with_end(scene, replace(end, **never))


def new_point(scene: Scene, limits: DesignLimits) -> PointValues:
    """Returns the limited quantities of new bearings [SI], the worst in all conditions.

    Conditions are those in which the limits apply, in all cases of the scene. The values are those
    of `POINT` without a life. If a condition is not solved, the status says why, and
    `NOT_SOLVED_AT` which one.
    """
    scene = with_required_measures(scene, limits)
    if scene.cases or scene.duty is not None:
        cases = cases_of_use(scene)
        return worst_point({name: new_point(case, limits) for name, case in cases.items()})
    # such a life has a single state, that of the new bearings
    ended = with_required_measures(with_end(scene, END_WHEN_NEW), limits)
    life = HertzianLives(ended)(ended)
    if life.status != OK:
        return {"status": life.status, NOT_SOLVED_AT: _unsolved_at(scene, life.status, NEW)}
    values = {"status": life.status} | _worst_values(scene, worse_states(life, scene))
    return _with_all_conditions(scene, values, life, limits, quick=True)


def design_point(scene: Scene, limits: DesignLimits, quick: bool = False) -> PointValues:
    """Returns the life of a scene and its worst limited quantities, by the names of `POINT` [SI].

    The life has the grooves that the full model follows, worn or Hertzian; `hertzian_life` has
    Hertzian ones. The quantities are the worst in all conditions of the limits, new and worn. If
    nothing turns and no criterion is met when new, the life is infinite, with the status
    CRITERION_NOT_REACHED. If a life or a condition was not solved, the status says why, and
    `NOT_SOLVED_AT` which one.

    quick: whether a life with worn grooves has coarser cells and steps, and NaN as `hertzian_life`;
        the worst speed is looked for near a limit only.
    """
    scene = with_required_measures(scene, limits)
    if scene.duty is not None:
        return _duty_point(scene, limits, quick)
    points = {name: _case_point(case, limits, quick) for name, case in scene.in_cases.items()}
    values = worst_point(points) if scene.cases else points[NOMINAL]
    if math.isinf(values.get("life", 0.0)):
        values["status"] = CRITERION_NOT_REACHED
    return values


def _duty_point(scene: Scene, limits: DesignLimits, quick: bool) -> PointValues:
    """Returns `design_point` over a duty: the worst of its cases along one life.

    The life is over the cycle of all phases, so a case that was not solved leaves no life.

    quick: see `design_point`.
    """
    over_duty = duty_life(scene, quick=quick)
    points: dict[str, PointValues] = {}
    for name, life in over_duty.by_case.items():
        case = scene.in_cases[name]
        values: PointValues = NO_LIFE | {
            "status": life.status,
            "end_criterion": life.criterion,
            "groove": WORN_GROOVE if over_duty.is_worn else HERTZIAN_GROOVE,
            "hertzian_life": math.nan if over_duty.is_worn else life.last.time,
            "solves": 0 if points else life.solves,  # those of all cases, in the first one
        }
        if life.status != OK:
            return values | {NOT_SOLVED_AT: _unsolved_at(case, life.status, AT_END_OF_LIFE)}
        values |= {"life": life.last.time} | values_of_states(case, worse_states(life, case))
        values |= _time_to_slip_limit(case, life, values, limits.gyroscopic_slip_share)
        points[name] = _with_all_conditions(case, values, life, limits, quick)
    worst = worst_point(points)
    if worst["status"] != OK:
        return worst
    # the life is that of all phases; a case decides it only where the life ends in that case alone
    del worst[DECIDING]["life"]
    if not over_duty.ends_in_all_cases:
        ending = over_duty.cycle.cases[over_duty.ending_case_index]
        worst[DECIDING]["life"] = {**points[ending][DECIDING]["life"], "case": ending}
    return worst


def _case_point(scene: Scene, limits: DesignLimits, quick: bool) -> PointValues:
    """Returns `design_point` of a scene without further cases.

    quick: see `design_point`.
    """
    if not scene.operation.turns:
        return _standstill_point(scene, limits)
    life, values = _case_life(scene, limits.gyroscopic_slip_share, quick)
    if life.status != OK:
        return values | {NOT_SOLVED_AT: _unsolved_at(scene, life.status, AT_END_OF_LIFE)}
    return _with_all_conditions(scene, values, life, limits, quick)


def _case_life(scene: Scene, slip_limit: float | None, quick: bool) -> _SolvedLife:
    """Returns the life at the scene's own speed, with worn grooves if the scene requires them.

    slip_limit: see `life_point`.
    quick: see `design_point`.
    """
    hertzian = None
    hertzian_values = dict(NO_LIFE)
    if not (quick and groove_choice(scene, "steady").follows):
        hertzian = _hertzian_life(scene, slip_limit)
        hertzian_values = hertzian.values
    hertzian_life = hertzian_values.get("life", math.nan)
    hertzian_values |= {"groove": HERTZIAN_GROOVE, "hertzian_life": hertzian_life}
    if hertzian is not None and hertzian_life == 0.0:
        return hertzian  # a new bearing has no worn groove
    worn = worn_life_with_stiffness(scene, quick)
    if worn is None:
        assert hertzian is not None
        return hertzian
    values = {
        "hertzian_life": hertzian_life,
        "groove": WORN_GROOVE,
        "status": worn.status,
        "end_criterion": worn.criterion,
        "solves": hertzian_values["solves"] + worn.solves,
        "failed_solves": hertzian_values["failed_solves"],
    }
    if worn.status != OK:
        return _SolvedLife(worn, values)
    if not quick:
        values[POINT_WARNINGS] = json.dumps(_life_warnings(scene, worn))
    values |= {"life": worn.last.time} | values_of_states(scene, worse_states(worn, scene))
    values |= _time_to_slip_limit(scene, worn, values, slip_limit)
    return _SolvedLife(worn, values)


def _standstill_point(scene: Scene, limits: DesignLimits) -> PointValues:
    """Returns the point of a scene in which nothing turns.

    Its life is zero if it meets a criterion when new, else infinite. The status is OK for both.
    """
    node = Node(0.0, None, new_states(scene), 0.0)
    values: PointValues = NO_LIFE | {"status": node.status, "solves": 1}
    if node.status != OK:
        return values | {NOT_SOLVED_AT: _unsolved_at(scene, node.status, NEW)}
    met = np.flatnonzero(Criteria(scene).margins(node.states) <= 0.0)
    life = 0.0 if met.size else math.inf
    values |= {"end_criterion": int(met[0]) if met.size else NO_CRITERION, "life": life}
    values |= {"groove": HERTZIAN_GROOVE, "hertzian_life": life}
    if limits.gyroscopic_slip_share is not None:
        values["time_to_slip_limit"] = math.inf
    values |= values_of_states(scene, [worse_state(node.states, scene)] * 2)  # new and at the end
    standstill = Life([node], None, status=OK)
    return _with_all_conditions(scene, values, standstill, limits, quick=False)


def _with_all_conditions(
    scene: Scene, values: PointValues, life: Life, limits: DesignLimits, quick: bool
) -> PointValues:
    """Returns a point with the extremes in all conditions of the limits, and which ones decide.

    If a condition is not solved, the point has its status and, in `NOT_SOLVED_AT`, the condition. A
    warm-up is not solved if another condition breaks a limit already.

    values: those at the scene's own speed; changed in place, with all solves in `solves`.
    life: solved; it may consist of new bearings alone.
    quick: see `design_point`.
    """
    condition = OperatingCondition(scene)
    parts = [extremes_of_life(scene, life.nodes, condition.where())]
    is_worn = len(life.nodes) > 1
    ends_when_new = not is_worn and values.get("life") == 0.0
    if not limits.at_speed_only and not ends_when_new:
        other_conditions = OtherConditions(scene, limits.effective, quick)
        ends: list[tuple[Solve, str, Node]] = [(new_states, NEW, life.nodes[0])]
        if is_worn:
            ends.append((worn_states(life), AT_END_OF_LIFE, life.last))
        for solve, wear, node in ends:
            at_speed = state_extremes(scene, node.states, condition.where(wear=wear))
            answer = other_conditions.extremes(at_speed, solve, wear)
            if "solves" in values:
                values["solves"] += answer.solves
            if answer.status != OK:
                return values | {"status": answer.status, NOT_SOLVED_AT: answer.unsolved}
            parts.append(answer.extremes)
    if limits.warmup_s is not None and not _breaks_limit(worst_extremes(parts), limits):
        answer = warm_up_extremes(scene, limits.warmup_s, quick)
        if answer.status != OK:
            return values | {"status": answer.status, NOT_SOLVED_AT: answer.unsolved}
        parts.append(answer.extremes)
    deciding = worst_extremes(parts)
    values |= {name: extreme["value"] for name, extreme in deciding.items()}
    if "life" in values:
        deciding["life"] = condition.where(wear=AT_END_OF_LIFE, value=values["life"])
    return values | {DECIDING: deciding | _resting_extremes(scene, values, life)}


def _resting_extremes(scene: Scene, values: PointValues, life: Life) -> Extremes:
    """Returns the extremes of measures at rest: of launch, new or worn, and of the torque margin.

    Those of launch have the speed 0 and the wear at which they are worst. The torque margin has the
    condition of the scene, without wear: it is the least of several states of wear.

    values: of the point, among which are these extremes.
    """
    where = OperatingCondition(scene).where()
    resting = [name for measure in LIMITED.values() if measure.resting for name in measure.extremes]
    when_new = launch_values(scene, [[state.loss for state in life.nodes[0].states]])
    extremes = {name: {**where, "value": values[name]} for name in resting}
    for name, value in when_new.items():
        wear = NEW if value == values[name] else AT_END_OF_LIFE
        extremes[name] |= {"speed_rpm": 0.0, "wear": wear}
    return extremes


def _breaks_limit(extremes: Extremes, limits: DesignLimits) -> bool:
    """Returns whether any extreme breaks its requirement; NaN breaks none."""
    return any(
        LIMITED[key].margin(extremes[name]["value"], limit) < 0.0
        for key, limit in limits.effective.items()
        for name in LIMITED[key].extremes
        if name in extremes
    )


def _unsolved_at(scene: Scene, status: int, wear: str) -> dict[str, Any]:
    """Returns the scene's own condition as plain data, with the status with which it failed.

    wear: of `NEW`, `AT_END_OF_LIFE`.
    """
    return OperatingCondition(scene).where(wear=wear, status=STATUS_NAMES[status])


def worst_point(points: Mapping[str, PointValues]) -> PointValues:
    """Returns the worst of each limited quantity over several cases, and the shortest life.

    Values that are neither are those of the case with the shortest life; solves are added. If a
    case was not solved, the first such point is returned, and `NOT_SOLVED_AT` names its case.

    points: of `design_point` or `new_point`, by the names of cases.
    """
    case_points = list(points.values())
    counts: PointValues = {
        name: sum(point[name] for point in case_points)
        for name in ("solves", "failed_solves")
        if name in case_points[0]
    }
    for case, point in points.items():
        if point["status"] != OK:
            return {**point, **counts, NOT_SOLVED_AT: {**point[NOT_SOLVED_AT], "case": case}}
    shortest = int(np.argmin([point.get("life", math.inf) for point in case_points]))
    worst = {**case_points[shortest], **counts}
    for name in ("life", "hertzian_life", "time_to_slip_limit", "residual_preload_at_end"):
        if name in worst:
            worst[name] = min(point[name] for point in case_points)
    for measure in LIMITED.values():
        for extreme in measure.extremes:
            for name in (extreme, f"{extreme}_at_start", f"{extreme}_at_end"):
                if name in worst:
                    worst[name] = measure.extreme([point[name] for point in case_points])
    if "impractical" in worst:
        # the flag 0 stands for no warning
        worst["impractical"] = max(point["impractical"] for point in case_points)
    deciding = [
        {name: {**where, "case": case} for name, where in point[DECIDING].items()}
        for case, point in points.items()
    ]
    life_conditions = [extremes.pop("life", None) for extremes in deciding]
    worst_by_name = worst_extremes(deciding)
    shortest_life_condition = life_conditions[shortest]
    if shortest_life_condition:
        worst_by_name["life"] = shortest_life_condition
    return worst | {DECIDING: worst_by_name, CASE_POINTS: dict(points)}


def worst_cases(point: Mapping[str, Any]) -> dict[str, str]:
    """Returns the name of the worst case for the life and for each extreme, by their names.

    Without a finite value, they are left out.

    point: of several cases.
    """
    return {
        name: where["case"]
        for name, where in point[DECIDING].items()
        if math.isfinite(where["value"])
    }


def values_of_states(scene: Scene, states: Sequence[State]) -> PointValues:
    """Returns the values of `POINT` that follow from the states along a life.

    states: from new to the end of life, of the worse bearing of a pair: see `worse_states`.
    """
    new, worn = states[0], states[-1]
    values: PointValues = {
        "residual_preload_at_start": new["residual_preload"],
        "residual_preload_at_end": worn["residual_preload"],
        "loss_at_end": worn.loss,
        "impractical": _first_impractical(scene, [new, worn]),
    }
    brief_measures = [measure for measure in LIMITED.values() if measure.brief]
    for measure in brief_measures:
        for name in measure.extremes:
            values[f"{name}_at_start"] = measure.extreme(new[name])
            values[f"{name}_at_end"] = measure.extreme(worn[name])
    return values | _worst_values(scene, states)


def _worst_values(scene: Scene, states: Sequence[State]) -> dict[str, float]:
    """Returns the worst value of every limited measure along the states of a life [SI].

    Values have the names of extremes. One is NaN if that of the first or of the last state is NaN.
    Measures of a life as a whole are left out.
    """
    ends = states[:1] if len(states) == 1 else (states[0], states[-1])
    losses_of_ends = [state.values.get("losses", (state.loss,)) for state in ends]  # by bearing
    at_rest = launch_values(scene, losses_of_ends)
    if scene.drive is not None:
        at_rest = {**at_rest, "torque_margin": least_margin(scene, states)}
    states = [
        state.with_values({"lowest_frequency": rotor_frequency(scene, state), **at_rest})
        for state in states
    ]
    worst = {}
    for measure in LIMITED.values():
        if measure.of_life:
            continue
        divisor = scene.operation.preload_N if measure.over_preload else 1.0
        for name, variable in zip(measure.extremes, measure.variables, strict=True):
            values = [states[0][variable], states[-1][variable]]
            # a value of NaN in between would lie between its neighbours
            values += [
                state[variable] for state in states[1:-1] if not np.isnan(state[variable]).any()
            ]
            worst[name] = measure.extreme(values) / divisor
    return worst


def _first_impractical(scene: Scene, states: Sequence[State]) -> int:
    """Returns the flag of the variable `impractical`: the first such warning, or 0 for none.

    states: when new and at the end of life. Those of the worse bearing of a pair are judged as
        states of the first one.
    """
    bearing = scene.sides[0]
    values = {"end_criterion": NO_CRITERION, **history_values(list(states))}
    warnings = warnings_of(bearing, choice_for_life(bearing), values)
    ids = [warning["id"] for warning in warnings if warning["impractical"]]
    return IMPRACTICAL_FLAGS.index(ids[0] if ids else NOT_IMPRACTICAL)


def _life_warnings(scene: Scene, life: Life) -> list[dict[str, Any]]:
    """Returns the warnings of a life with worn grooves, as the function `life` has them."""
    # the empty depths of both races tell the warnings that grooves are worn
    values = life_values(scene.symmetric_half, life) | {"groove_depth": ((), ())}
    if scene.symmetric_half is not scene:
        values = joined([values, values])
    return warnings_of(scene, choice_for_life(scene), values)


def scene_at(scene: Scene, method: str, mu: float, speed_rpm: float, preload_N: float) -> Scene:
    """Returns the scene at a point of the map.

    A lowest speed above the speed is lowered to it.

    mu: friction coefficient of balls on races; ignored if the scene has a film.
    """
    lowest = min(scene.operation.lowest_speed_rpm, speed_rpm)
    held = with_method(scene, method, preload_N, shaft_speed_rpm=speed_rpm, lowest_speed_rpm=lowest)
    if scene.friction.film is not None:
        return held
    return replace(held, friction=replace(scene.friction, ball_race=mu))


def map_part(
    scene: Path,
    method: str,
    friction: float,
    shaft_speed_rpm: Sequence[float],
    preload_N: Sequence[float],
    slip_limit: float | None = None,
    thermal_margin: float | None = None,
) -> xr.Dataset:
    """Step: returns lives over preload and speed, for one method and one friction coefficient.

    Limits apply at the speed of each life alone.

    slip_limit: gyroscopic slip share [1], the time to which is computed.
    thermal_margin: required [1]; the margin of lives is computed only if it is required.
    """
    axes = [method], [friction], shaft_speed_rpm, preload_N
    base = life_scene(scene, films=True)
    limits = DesignLimits(
        gyroscopic_slip_share=slip_limit, thermal_margin=thermal_margin, at_speed_only=True
    )
    points = answers_at(partial(design_point, limits=limits), scenes_of_map(base, axes), workers=1)
    return map_dataset(base, axes, limits, list(points))


def scenes_of_map(base: Scene, axes: Sequence[Sequence[Any]]) -> list[Scene]:
    """Returns the scene of each point of a map in C order, that is with the preload fastest.

    axes: values along each of `MAP_AXES`.
    """
    return [
        scene_at(base, method, mu, speed, preload)
        for method, mu, speed, preload in itertools.product(*axes)
    ]


def map_dataset(
    base: Scene,
    axes: Sequence[Sequence[Any]],
    limits: DesignLimits,
    points: Sequence[Mapping[str, Any]],
) -> xr.Dataset:
    """Returns the dataset of a map from its design points.

    Of the limits, its attribute has only that of the slip share, and settings such as
    `at_speed_only`.

    axes: values along each of `MAP_AXES`.
    points: in the order of `scenes_of_map`.
    """
    methods, *numbers = axes
    other_limits: dict[str, Any] = dict.fromkeys(set(limits.given) - {SLIP_SHARE})
    values = [PRELOAD_METHODS.index(method) for method in methods], *numbers
    return dataset_of_points(
        dict(zip(MAP_AXES.values(), values, strict=True)),
        points,
        title=f"Design map: {base.name}",
        kind="design map",
        scene=base,
        limits=json.dumps(replace(limits, **other_limits).stored),
    )


def dataset_of_points(
    axes: Mapping[Any, Any],
    points: Sequence[Mapping[str, Any]],
    more: Mapping[str, Variable] = MappingProxyType({}),
    **attributes: Any,
) -> xr.Dataset:
    """Returns a dataset of design points, with the variables of `POINT` and further ones.

    The time to the slip limit is left out where no point has it.

    axes, attributes: as of `dataset_of_rows`.
    more: further variables by name.
    """
    rows = [
        NO_LIFE | {name: point[name] for name in point if name not in NO_VARIABLES}
        for point in points
    ]
    is_timed = any("time_to_slip_limit" in row for row in rows)
    variables = {
        name: variable
        for name, variable in POINT.items()
        if is_timed or name != "time_to_slip_limit"
    }
    return dataset_of_rows({**variables, **more}, axes, rows, **attributes)
