"""The design map: lives over preload, method, friction and speed.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

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
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.duty import cases_of_use
from bearingwear.scene.scene import PRELOAD_METHODS, EndOfLife, Scene
from bearingwear.solvers.bearing.launch import launch_values
from bearingwear.solvers.effects.choice import choice_for_life
from bearingwear.solvers.effects.table import WARNINGS
from bearingwear.solvers.effects.warnings import warnings_of
from bearingwear.solvers.state import State, history_values
from bearingwear.studies.dataset import dataset_of_rows
from bearingwear.studies.design.conditions import AT_END_OF_LIFE, DECIDING, NEW, OperatingCondition
from bearingwear.studies.design.everywhere import (
    Extremes,
    OtherConditions,
    Solve,
    extremes_of_life,
    frequency,
    new_states,
    state_extremes,
    worn_states,
    worst_extremes,
)
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.design.warming import warm_up_extremes
from bearingwear.studies.solve import life_scene

SLIP_SHARE = "gyroscopic_slip_share"

GROOVE_SHAPES = ("hertzian", "worn")
HERTZIAN_GROOVE, WORN_GROOVE = range(len(GROOVE_SHAPES))

IMPRACTICAL = tuple(warning.id for warning in WARNINGS if warning.impractical)
"""Warnings of a bearing that nobody would build or run; a limit of every recommendation."""

MAP_AXES = table(
    STUDY_COORDINATES["preload_method"],
    STUDY_COORDINATES["friction"],
    Variable("shaft_speed", ("shaft_speed",), "rpm", "shaft speed"),
    Variable("preload", ("preload",), "N", "initial axial preload"),
)

_AND_LATER = "from new to the end of life"


def _extremes() -> list[Variable]:
    """Of every limited measure, the worst from new to the end of life."""
    return [
        Variable(
            name,
            (),
            one.si_unit,
            ", ".join(filter(None, (one.limit[0][0].lower() + one.limit[0][1:], kind, _AND_LATER))),
            comment=one.note or None,
        )
        for one in LIMITED.values()
        if not one.of_life
        for name, kind in zip(one.extremes, one.kinds, strict=True)
    ]


def _at_ends() -> list[Variable]:
    """Of what stands in short tables, the value when new and at the end of life."""
    return [
        Variable(f"{name}_at_{moment}", (), one.si_unit, f"{one.words_of(name)} {when}")
        for one in LIMITED.values()
        if one.brief
        for name in one.extremes
        for moment, when in (("start", "when new"), ("end", "at the end of life"))
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
    *_at_ends(),
    *_extremes(),
    Variable("impractical", (), "", "first warning of an impractical design, new or worn",
        dtype="i1", flags=("none", *IMPRACTICAL)),
    Variable("groove", (), "", "groove model used in the life calculation", dtype="i1",
        flags=GROOVE_SHAPES, 
        comment="worn if the scene requires worn grooves for the life calculation"),
    Variable("hertzian_life", (), "h",
        "wear life at the same preload, computed with Hertzian grooves", scale=HOURS_PER_SECOND),
)  # fmt: skip
"""What a point of the map has: a life, and the extremes along it.

Numbers are NaN where the life was not solved.
"""

MET_WHEN_NEW = EndOfLife(maximum_pressure_GPa=1e-9)
"""An end that every bearing has met when new."""

_NEVER_MET = 1e-9  # thermal margin, but without a state beside the present one

NO_LIFE: dict[str, Any] = dict.fromkeys(("solves", "failed_solves", "impractical", "groove"), 0)
NO_LIFE |= {"status": -1, "end_criterion": len(CRITERIA) - 1}
"""What a point has of whole numbers before any solve."""


WARNED = "warnings"
"""What a point has that is no variable of a map: warnings of an exact life with worn grooves."""


CASE_POINTS = "points"
"""What a point of several cases has that is no variable: the point of each of them."""

NOT_SOLVED_AT = "unsolved"
"""What a point has that is no variable: where, and with which status, something was not solved."""


def life_point(scene: Scene, slip_limit: float | None) -> dict[str, Any]:
    """One life by the steady model at the scene's own speed, or over its duty, and its extremes.

    slip_limit: gyroscopic slip share whose passing is timed.

    Returns: values of `POINT` by their names, SI. Where the status is not ok: `status`,
        `end_criterion`, `solves` and `failed_solves` alone. `time_to_slip_limit` is infinite where
        the share stays below its limit.
    """
    if scene.duty is not None:
        limits = DesignLimits(gyroscopic_slip_share=slip_limit, at_speed_only=True)
        return _duty_point(scene, limits, quick=False)
    return _hertzian_life(scene, slip_limit)[0]


def _hertzian_life(scene: Scene, slip_limit: float | None) -> tuple[dict[str, Any], Life]:
    """`life_point`, and the life that it is of."""
    lives = HertzianLives(scene)
    one = lives(scene)
    found: dict[str, Any] = {"status": one.status, "end_criterion": one.criterion}
    if one.status == OK:
        found |= {"life": one.last.time} | gone_through(scene, worse_states(one, scene))
        if slip_limit is not None:
            found["time_to_slip_limit"] = math.inf
            if found[SLIP_SHARE] >= slip_limit:
                # the same way, ended by the share
                limited = with_end(scene, EndOfLife(gyroscopic_slip_share=slip_limit))
                found["time_to_slip_limit"] = lives(limited).last.time
    found["solves"], found["failed_solves"] = lives.solver.solves, lives.solver.failed
    return found, one


def with_required_measures(scene: Scene, limits: DesignLimits) -> Scene:
    """A scene whose states have what is required of them.

    They have the thermal margin, which takes further solves, if it may end a life.
    """
    end = scene.wear.end_of_life
    if limits.thermal_margin is None or end is None or end.thermal_margin is not None:
        return scene
    never: dict[str, Any] = {"thermal_margin": _NEVER_MET}
    return with_end(scene, replace(end, **never))


def new_point(scene: Scene, limits: DesignLimits) -> dict[str, Any]:
    """Limited quantities of the new bearing (SI), wherever limits look; only its status and where
    it was not solved, if not ok.
    """
    scene = with_required_measures(scene, limits)
    if scene.cases or scene.duty is not None:
        each = {name: new_point(one, limits) for name, one in cases_of_use(scene).items()}
        return worst_point(each)
    limited = with_end(scene, MET_WHEN_NEW)
    limited = with_required_measures(limited, limits)
    one = HertzianLives(limited)(limited)
    if one.status != OK:
        return {"status": one.status, NOT_SOLVED_AT: _unsolved_at(scene, one.status, NEW)}
    values = {"status": one.status} | _extremes_of(scene, worse_states(one, scene))
    return _everywhere(scene, values, one, limits, exactly=False)


def followed_point(scene: Scene, limits: DesignLimits, quick: bool = False) -> dict[str, Any]:
    """`life_point` of the groove that `life` follows, and the life with the Hertzian one.

    Extremes are those wherever limits look, new and worn.

    quick: whether worn grooves have the cells and steps of a quick life, not those of `life`; the
        life with the Hertzian ones is left out.
    """
    scene = with_required_measures(scene, limits)
    if scene.duty is not None:
        return _duty_point(scene, limits, quick)
    each = {name: _case_point(one, limits, quick) for name, one in scene.in_cases.items()}
    found = worst_point(each) if scene.cases else each[NOMINAL]
    if math.isinf(found.get("life", 0.0)):
        found["status"] = CRITERION_NOT_REACHED
    return found


def _duty_point(scene: Scene, limits: DesignLimits, quick: bool) -> dict[str, Any]:
    """`followed_point` over a duty: the worst of its cases along one life."""
    over_duty = duty_life(scene, quick=quick)
    each: dict[str, dict[str, Any]] = {}
    for name, life in over_duty.by_case.items():
        one = scene.in_cases[name]
        found: dict[str, Any] = NO_LIFE | {
            "status": life.status,
            "end_criterion": life.criterion,
            "groove": WORN_GROOVE if over_duty.is_worn else HERTZIAN_GROOVE,
            "hertzian_life": math.nan if over_duty.is_worn else life.last.time,
            "solves": 0 if each else life.solves,
        }
        if life.status != OK:
            return found | {NOT_SOLVED_AT: _unsolved_at(one, life.status, AT_END_OF_LIFE)}
        found |= {"life": life.last.time} | gone_through(one, worse_states(life, one))
        if limits.gyroscopic_slip_share is not None:
            end = EndOfLife(gyroscopic_slip_share=limits.gyroscopic_slip_share)
            is_passed = found[SLIP_SHARE] >= limits.gyroscopic_slip_share
            first = life.time_to(Criteria(with_end(one, end))) if is_passed else math.inf
            found["time_to_slip_limit"] = first
        each[name] = _everywhere(one, found, life, limits, exactly=not quick)
    worst = worst_point(each)
    if worst["status"] != OK:
        return worst
    del worst[DECIDING]["life"]  # which is of all phases, and ends in one of them or in all
    if not over_duty.ends_in_all_cases:
        ending = over_duty.cycle.cases[over_duty.ending_case]
        worst[DECIDING]["life"] = {**each[ending][DECIDING]["life"], "case": ending}
    return worst


def _case_point(scene: Scene, limits: DesignLimits, quick: bool) -> dict[str, Any]:
    """`followed_point` of one case; its life is infinite where nothing turns."""
    if not scene.operation.turns:
        return _still_point(scene, limits)
    found, life = _followed_life(scene, limits.gyroscopic_slip_share, quick)
    if life.status != OK:
        return found | {NOT_SOLVED_AT: _unsolved_at(scene, life.status, AT_END_OF_LIFE)}
    return _everywhere(scene, found, life, limits, exactly=not quick)


def _followed_life(
    scene: Scene, slip_limit: float | None, quick: bool
) -> tuple[dict[str, Any], Life]:
    """Values of a life at the scene's own speed, and that life."""
    only_worn = quick and groove_choice(scene, "steady").follows
    found, even = (dict(NO_LIFE), None) if only_worn else _hertzian_life(scene, slip_limit)
    hertzian = found.get("life", math.nan)
    found |= {"groove": HERTZIAN_GROOVE, "hertzian_life": hertzian}
    if even is not None and hertzian == 0.0:
        return found, even  # beyond a limit when new, whatever the groove
    worn = worn_life_with_stiffness(scene, quick)
    if worn is None:
        assert even is not None
        return found, even
    kept = {"hertzian_life": hertzian, "groove": WORN_GROOVE, "status": worn.status}
    kept |= {"end_criterion": worn.criterion, "solves": found["solves"] + worn.solves}
    kept["failed_solves"] = found["failed_solves"]
    if worn.status != OK:
        return kept, worn
    if not quick:
        kept[WARNED] = json.dumps(_warnings_along(scene, worn))
    kept["life"] = worn.last.time
    kept |= gone_through(scene, worse_states(worn, scene))
    if slip_limit is not None:
        kept["time_to_slip_limit"] = math.inf
        if kept[SLIP_SHARE] >= slip_limit:
            share = EndOfLife(gyroscopic_slip_share=slip_limit)
            kept["time_to_slip_limit"] = worn.time_to(Criteria(with_end(scene, share)))
    return kept, worn


def _still_point(scene: Scene, limits: DesignLimits) -> dict[str, Any]:
    """A point of a scene in which nothing turns: its life is infinite, or over when new."""
    states = new_states(scene)
    status = next((state.status for state in states if state.status != OK), OK)
    found: dict[str, Any] = NO_LIFE | {"status": status, "solves": 1}
    if status != OK:
        return found | {NOT_SOLVED_AT: _unsolved_at(scene, status, NEW)}
    met = np.flatnonzero(Criteria(scene).margins(states) <= 0.0)
    life = 0.0 if met.size else math.inf
    found |= {"end_criterion": int(met[0]) if met.size else NO_CRITERION, "life": life}
    found |= {"groove": HERTZIAN_GROOVE, "hertzian_life": life}
    if limits.gyroscopic_slip_share is not None:
        found["time_to_slip_limit"] = math.inf
    found |= gone_through(scene, [worse_state(states, scene)] * 2)
    node = Node(0.0, None, states, life)
    return _everywhere(scene, found, Life([node], None, status=OK), limits, exactly=True)


def _everywhere(
    scene: Scene, values: dict[str, Any], life: Life, limits: DesignLimits, exactly: bool
) -> dict[str, Any]:
    """Values of a life at the scene's own speed with the extremes wherever limits look."""
    here = OperatingCondition(scene)
    own = extremes_of_life(scene, life.nodes, here.where())
    at_rest = {
        name: here.where(wear=NEW, value=values[name])
        for one in LIMITED.values()
        if one.resting
        for name in one.extremes
    }
    worn = len(life.nodes) > 1
    each = [own]
    if not limits.at_speed_only and (worn or "life" not in values or values["life"] > 0.0):
        looked = OtherConditions(scene, limits.effective, exactly)
        sides: list[tuple[Solve, str, Node]] = [(new_states, NEW, life.nodes[0])]
        sides += [(worn_states(life), AT_END_OF_LIFE, life.last)] if worn else []
        for solve, wear, node in sides:
            at_speed = state_extremes(scene, node.states, here.where(wear=wear))
            beside = looked.extremes(at_speed, solve, wear)
            if "solves" in values:
                values["solves"] += beside.solves
            if beside.status != OK:
                return values | {"status": beside.status, NOT_SOLVED_AT: beside.unsolved}
            each.append(beside.extremes)
    if limits.warmup_s is not None and not _is_broken(worst_extremes(each), limits):
        on_the_way = warm_up_extremes(scene, limits.warmup_s)
        if on_the_way.status != OK:
            return values | {"status": on_the_way.status, NOT_SOLVED_AT: on_the_way.unsolved}
        each.append(on_the_way.extremes)
    deciding = worst_extremes(each)
    values |= {name: one["value"] for name, one in deciding.items()}
    if "life" in values:
        deciding["life"] = here.where(wear=AT_END_OF_LIFE, value=values["life"])
    return values | {DECIDING: deciding | at_rest}


def _is_broken(extremes: Extremes, limits: DesignLimits) -> bool:
    """Whether a requirement on states is broken."""
    return any(
        LIMITED[key].margin(extremes[name]["value"], limit) < 0.0
        for key, limit in limits.effective.items()
        for name in LIMITED[key].extremes
        if name in extremes
    )


def _unsolved_at(scene: Scene, status: int, wear: str) -> dict[str, Any]:
    """Where a life was not solved: at the scene's own speed."""
    return OperatingCondition(scene).where(wear=wear, status=STATUS_NAMES[status])


def worst_point(points: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Limited quantities of the worst of several cases by their names, and the shortest life.

    The first one that was not solved, where there is such a one.
    """
    each = list(points.values())
    counts = {
        name: sum(point[name] for point in each)
        for name in ("solves", "failed_solves")
        if name in each[0]
    }
    for name, point in points.items():
        if point["status"] != OK:
            return {**point, **counts, NOT_SOLVED_AT: {**point[NOT_SOLVED_AT], "case": name}}
    lives = [point.get("life", math.inf) for point in each]
    shortest = int(np.argmin(lives))
    found = {**each[shortest], **counts}
    for name in ("life", "hertzian_life", "time_to_slip_limit"):
        if name in found:
            found[name] = min(point[name] for point in each)
    for one in LIMITED.values():
        for name in one.extremes:
            for end in (name, f"{name}_at_start", f"{name}_at_end"):
                if end in found:
                    found[end] = one.extreme([point[end] for point in each])
    if "impractical" in found:
        found["impractical"] = max(point["impractical"] for point in each)
    named = [
        {quantity: {**one, "case": name} for quantity, one in point[DECIDING].items()}
        for name, point in points.items()
    ]
    lived = {"life": named[shortest]["life"]} if "life" in named[shortest] else {}
    for of_case in named:
        of_case.pop("life", None)
    return found | {DECIDING: worst_extremes(named) | lived, CASE_POINTS: dict(points)}


def worst_cases(point: Mapping[str, Any]) -> dict[str, str]:
    """Of the life and each measure that is known, the case that is the worst."""
    return {
        name: one["case"] for name, one in point[DECIDING].items() if math.isfinite(one["value"])
    }


def gone_through(scene: Scene, states: Sequence[State]) -> dict[str, Any]:
    """Limited quantities of the states of a life."""
    new, worn = states[0], states[-1]
    found: dict[str, Any] = {
        "residual_preload_at_start": new["residual_preload"],
        "residual_preload_at_end": worn["residual_preload"],
        "loss_at_end": worn.loss,
        "impractical": _impractical(scene, [new, worn]),
    }
    for one in LIMITED.values():
        for name in one.extremes if one.brief else ():
            found |= {f"{name}_at_start": one.extreme(new[name])}
            found |= {f"{name}_at_end": one.extreme(worn[name])}
    return found | _extremes_of(scene, states)


def _extremes_of(scene: Scene, states: Sequence[State]) -> dict[str, float]:
    """Of all that may be limited, the worst of some states."""
    # each bearing's wear when new and at the end
    wear = [state.values.get("losses", (state.loss,)) for state in states]
    wear = [wear[0], wear[-1]][: len(wear)]
    found, at_rest = {}, launch_values(scene, wear)
    if scene.drive is not None:
        at_rest = {**at_rest, "torque_margin": least_margin(scene, states)}
    histories = [
        state.with_values({"lowest_frequency": frequency(scene, state), **at_rest})
        for state in states
    ]
    for one in LIMITED.values():
        for name, variable in () if one.of_life else zip(one.extremes, one.variables, strict=True):
            ends = histories[0][variable], histories[-1][variable]
            between = [state[variable] for state in histories[1:-1]]
            # what is not known between is between what is known
            known = [value for value in between if not np.isnan(value).any()]
            extreme = one.extreme([*ends, *known])
            found[name] = extreme / scene.operation.preload_N if one.over_preload else extreme
    return found


def _impractical(scene: Scene, states: Sequence[State]) -> int:
    """Number of a warning in `IMPRACTICAL`, from one; zero without any.

    States of a pair stand for its worse bearing.
    """
    alone = scene.sides[0]
    values = {"end_criterion": len(CRITERIA) - 1, **history_values(list(states))}
    warned = warnings_of(alone, choice_for_life(alone), values)
    return next((IMPRACTICAL.index(one["id"]) + 1 for one in warned if one["impractical"]), 0)


def _warnings_along(scene: Scene, life: Life) -> list[dict[str, Any]]:
    """Warnings of a life with worn grooves, as `life` has them."""
    values = life_values(scene.one_of_alike, life) | {"groove_depth": ((), ())}  # of both
    if scene.one_of_alike is not scene:
        values = joined([values, values])
    return warnings_of(scene, choice_for_life(scene), values)


def scene_at(scene: Scene, method: str, mu: float, speed_rpm: float, preload_N: float) -> Scene:
    """The scene at a point of the map."""
    lowest = min(scene.operation.lowest_speed_rpm, speed_rpm)
    made = held_by(scene, method, preload_N, shaft_speed_rpm=speed_rpm, lowest_speed_rpm=lowest)
    if scene.friction.film is not None:
        return made
    return replace(made, friction=replace(scene.friction, ball_race=mu))


def map_part(
    scene: Path,
    method: str,
    friction: float,
    shaft_speed_rpm: Sequence[float],
    preload_N: Sequence[float],
    slip_limit: float | None = None,
    thermal_margin: float | None = None,
) -> xr.Dataset:
    """Step: lives over preload and speed, for one method and one friction coefficient.

    Each is looked at at its own speed alone.

    slip_limit: gyroscopic slip share whose passing is timed [1].
    thermal_margin: required [1], whose value takes further solves; no other limit matters here.
    """
    axes = [method], [friction], shaft_speed_rpm, preload_N
    base = life_scene(scene, films=True)
    limits = DesignLimits(
        gyroscopic_slip_share=slip_limit, thermal_margin=thermal_margin, at_speed_only=True
    )
    points = [followed_point(one, limits) for one in scenes_of_map(base, axes)]
    return map_of(base, axes, limits, points)


def scenes_of_map(base: Scene, axes: Sequence[Sequence[Any]]) -> list[Scene]:
    """The scenes of a map, by values along each of `MAP_AXES`, the preload fastest."""
    return [scene_at(base, *point) for point in itertools.product(*axes)]


def map_of(
    base: Scene,
    axes: Sequence[Sequence[Any]],
    limits: DesignLimits,
    points: Sequence[Mapping[str, Any]],
) -> xr.Dataset:
    """A map from what `followed_point` gives for its scenes; of limits the slip share is kept."""
    methods, *numbers = axes
    others: dict[str, Any] = dict.fromkeys(set(limits.given) - {SLIP_SHARE})
    values = [PRELOAD_METHODS.index(method) for method in methods], *numbers
    return filled_points(
        dict(zip(MAP_AXES.values(), values, strict=True)),
        points,
        title=f"Design map: {base.name}",
        kind="design map",
        scene=base,
        limits=json.dumps(replace(limits, **others).stored),
    )


NO_VARIABLES = (WARNED, DECIDING, NOT_SOLVED_AT, CASE_POINTS)
"""What points have that is no variable of a file."""


def filled_points(
    axes: Mapping[Any, Any],
    points: Sequence[Mapping[str, Any]],
    more: Mapping[str, Variable] = MappingProxyType({}),
    **attributes: Any,
) -> xr.Dataset:
    """`dataset_of_rows` with what `followed_point` gives, and further variables."""
    points = [{name: p[name] for name in p if name not in NO_VARIABLES} for p in points]
    timed = any("time_to_slip_limit" in point for point in points)
    known = {name: one for name, one in POINT.items() if timed or name != "time_to_slip_limit"}
    return dataset_of_rows(
        {**known, **more}, axes, [{**NO_LIFE, **point} for point in points], **attributes
    )
