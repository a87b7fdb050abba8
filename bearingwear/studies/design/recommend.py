"""The preload to take, between those of a design map.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.console import ProgressLines
from bearingwear.lives.errors import groove_errors
from bearingwear.lives.groove_life import grooves_followed
from bearingwear.lives.life import life
from bearingwear.measures import LIMITED
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.variable import HOURS_PER_SECOND, Variable, table
from bearingwear.results.warnings import gathered_warnings, warnings_in
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.cases import cases_that_wear
from bearingwear.scene.decisive import decisive_data
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.studies.design.choice import (
    ACTIVE,
    ACTIVE_LIMIT,
    AT_CLIFF,
    END_OF_RANGE,
    NEXT_NOT_SOLVED,
    NO_PRELOAD,
    NOT_PRACTICAL,
    OTHER_END,
    UNLIMITED,
    least_violations,
    limit_margins,
    limits_of,
    why_none,
    with_choices,
)
from bearingwear.studies.design.conditions import (
    AT_SPEED_ONLY,
    CONDITIONS,
    DECIDING,
    conditions_of,
)
from bearingwear.studies.design.document.words import LIMIT_KEY, NONE_BECAUSE
from bearingwear.studies.design.machine import MACHINE, machine_answers
from bearingwear.studies.design.map import (
    CASE_POINTS,
    MAP_AXES,
    NO_LIFE,
    POINT,
    WARNED,
    filled_points,
    followed_point,
    map_of,
    new_point,
    scenes_of_map,
    worst_cases,
)
from bearingwear.studies.design.plan import (
    COARSE,
    DesignLimits,
    MapAxes,
    most_preload,
    round_factor,
)
from bearingwear.studies.design.preload_line import PreloadLine, denser
from bearingwear.studies.design.room import (
    Assumption,
    criteria_room,
    friction_end,
    friction_room,
    held,
    limit_end,
    longer,
    verdict_on,
)
from bearingwear.studies.design.search import (
    GAIN,
    Asking,
    Found,
    Request,
    answered,
    search,
    settable,
)
from bearingwear.studies.pool import (
    Tell,
    TimeLeft,
    processes,
    to_stderr,
    told_in_lines,
)
from bearingwear.studies.solve import life_scene

RECOMMENDATION = "recommendation"
_IN_HOURS = {name for name, one in POINT.items() if one.scale == HOURS_PER_SECOND}
RECOMMENDED_PRELOAD = Variable("preload", (), "N", "recommended initial axial preload",
    comment="rounded to three significant digits, or to more if the requirements or the life "
        "demand it"
)  # fmt: skip
LIFE_ERROR = Variable("life_error_estimate", (), "1", "estimated numerical error in the life")

CLIFF = table(
    Variable("cliff_preload", (), "N",
        "nearest preload, within 5 % of the recommended one, at which the life is at least 10 % "
        "shorter"),
    Variable("cliff_life", (), "h", "wear life at cliff_preload", scale=HOURS_PER_SECOND),
    Variable("clear_preload", (), "N", "preload that satisfies the requirements and differs from "
        "cliff_preload by at least 5 %"),
    Variable("clear_life", (), "h", "wear life at clear_preload", scale=HOURS_PER_SECOND),
)  # fmt: skip
BEYOND_RANGE = table(
    Variable("beyond_preload", (), "N",
        "preload far outside the range in which the recommended preload lies"),
    Variable("beyond_life", (), "h", "wear life at beyond_preload", scale=HOURS_PER_SECOND),
    Variable("beyond_running_preload", (), "N", "running preload at beyond_preload, when new"),
)  # fmt: skip
SETTABLE = table(
    Variable("least_preload", (), "N", "least preload that may be set in place of the recommended "
        "one: requirements hold, and the life is at least 90 % as long"),
    Variable("most_preload", (), "N", "most preload that may be set in place of the recommended "
        "one: requirements hold, and the life is at least 90 % as long"),
)  # fmt: skip
WORST_CASES = "worst_cases"
"""Attribute of a recommendation: for each method, the case that is the worst of each quantity."""

ATTRIBUTES = ("warnings", WORST_CASES, MACHINE)
"""What is found of a recommended preload and is no variable."""

_MAP, _SEARCH, _LIMITS, _BESIDE = "map", "search", "limits", "beside"
_EXACT = 2.7  # time of an exact life over that of a quick one


def _usual_work(methods: int, limits: int) -> dict[str, tuple[float, float]]:
    """How many quick lives the stages of a recommendation usually take, and the time of each.

    The limits are one job: their lives wait for each other, which tells nothing of the pace. The
    six jobs of what stands beside the preloads are solved meanwhile.
    """
    found = {_MAP: (0.0, _EXACT), _BESIDE: (6.0, 2.0)}
    if limits:
        found |= {_SEARCH: (18.0 * methods, 1.0), _LIMITS: (1.0, 16.0 + 13.0 * limits)}
    return found


NOT_ASKED = NO_LIFE["status"]
NEW_APART = 0.1  # in log preload, new bearings between the preloads of a map
_WAYS = (False, True)  # down and up
AT_LIMIT = 5e-3  # what is left to a limit, relative, that counts as nothing
STEP_BEYOND, STEPS_BEYOND = 8.0, 3
"""Beyond an end of the map at which the life is longest: a step, and how many of them at most."""

LITTLE_LONGER = 1.1
"""A life that is longer by less than this after a step is not worth one."""


def recommendation_of(scene: Path, design: Path) -> xr.Dataset:
    """Step: the preload to take, from a scene and its design map."""
    return recommendation(life_scene(scene), load(design))


def small_map(
    scene: Path, axes: Mapping[str, Any], limits: Mapping[str, Any], workers: int = 1
) -> tuple[xr.Dataset, xr.Dataset]:
    """Step: a map and the preload to take of it.

    axes, limits: `MapAxes` and `DesignLimits` by their names.
    workers: as of `mapped`.
    """

    def tell(text: str) -> None:
        to_stderr(f"{scene.stem}: {text}")

    return mapped(life_scene(scene), MapAxes(**axes), DesignLimits(**limits), workers, tell)


def mapped(
    scene: Scene,
    axes: MapAxes,
    limits: DesignLimits,
    workers: int = 1,
    tell: Tell | None = None,
    quick: bool = False,
) -> tuple[xr.Dataset, xr.Dataset]:
    """A map and the preload to take of it.

    workers: processes that share the lives, where these take long.
    tell: given a line of text now and then, where lives take long.
    quick: whether the lives of the map are but a guide to the best preload within limits. They are
        solved where these need them, and none is in the map.
    """
    scenes = scenes_of_map(scene, axes.values)
    unlike = len(scene.one_of_alike.sides) == 2
    if not (unlike or any(grooves_followed(one, "steady")[0] for one in scenes)):
        workers, tell = 1, None
    waiting = tell if isinstance(tell, ProgressLines) else None
    left = TimeLeft(_usual_work(len(axes.preload_method), len(limits.given)))
    with processes(workers, "recommend", some_here=True) as each:
        lives: Iterator[dict[str, Any]] = iter([{}] * len(scenes))
        if not quick:
            lives = each(_followed, [(one, limits, False) for one in scenes])
        if not quick and tell is not None:
            line, timed = "{} of {} lives in the map", waiting is not None
            lives = told_in_lines(
                lives, len(scenes), line, tell=tell, kind=_MAP, left=left, timed=timed
            )
        design = map_of(scene, axes.values, limits, list(lives))
        design = with_choices(design.assign_attrs(limits=json.dumps(limits.stored)))
        if waiting is not None:
            waiting.left = left
        return design, recommendation(scene, design, each, tell, left)


def recommendation(
    scene: Scene,
    design: xr.Dataset,
    each: Callable[..., Iterator[Any]] = map,
    tell: Tell | None = None,
    left: TimeLeft | None = None,
) -> xr.Dataset:
    """The preload to take for each method at the scene's own friction and speed, between the
    map's preloads.

    The map shows where to look. What is recommended, and where the choice is reversed, comes from
    lives as `life` prints them, at the preloads that are named.

    design: the map.
    each: `map`, or one whose calls share processes.
    tell: given a line of text now and then.
    left: counts what is done.
    CaseFileError: where the map is of another scene or does not hold its friction and speed.
    """
    if not is_of_scene(design, scene):
        raise CaseFileError("the design map belongs to another scene")
    point = {"friction": scene.friction.coefficient, "shaft_speed": scene.operation.shaft_speed_rpm}
    for axis, value in point.items():
        if value not in design[axis]:
            raise CaseFileError(f"the design map does not contain the scene's {axis} ({value:g})")
    lines = design.sel(point, drop=True)
    search = Search(
        scene, limits_of(design), each, tell or (lambda text: None), left or TimeLeft({})
    )
    rows, none, held_so = search.answers(lines)
    found = _dataset(rows, lines).merge(held_so, combine_attrs="override")
    found.attrs["warnings"] = gathered_warnings({"warnings": r.get("warnings", "[]")} for r in rows)
    if any(row.get(MACHINE) for row in rows):
        found.attrs[MACHINE] = json.dumps([row.get(MACHINE, {}) for row in rows])
    if scene.cases:
        found.attrs[WORST_CASES] = json.dumps([row.get(WORST_CASES, {}) for row in rows])
    found.attrs[DECIDING] = json.dumps([row.get(DECIDING, {}) for row in rows])
    found.attrs[CONDITIONS] = json.dumps(conditions_of(scene, search.limits.at_speed_only))
    found.attrs[AT_SPEED_ONLY] = int(search.limits.at_speed_only)
    return found.assign_attrs({NONE_BECAUSE: json.dumps(none)} if none else {})


@dataclass(frozen=True)
class Search:
    """The best preloads of a scene within limits, and how far the choice of the method holds."""

    scene: Scene
    limits: DesignLimits
    each: Callable[..., Iterator[Any]]  # `map`, or one whose calls share processes
    tell: Tell
    left: TimeLeft

    def answers(self, lines: xr.Dataset) -> tuple[list[dict[str, Any]], dict[str, str], xr.Dataset]:
        """Best point of each method, reasons for none, and robustness of the choice.

        lines: lives over `preload_method` and `preload`.
        """
        if self.limits.given:
            self.tell("requirements as functions of preload, for new bearings")
        known = [self._line(one) for _, one in lines.groupby("preload_method")]
        found: list[Found | None] = [None] * len(known)
        if self.limits.given:
            self.tell("best preloads between those in the map")
            solve = partial(self._solve, _SEARCH)
            found = answered([self._searched(one) for one in known], solve)
        self.left.limit(_SEARCH)
        rows: list[dict[str, Any]] = [{"active_limit": NO_PRELOAD, "status": -1} for _ in known]
        none = {}
        for k, (line, one) in enumerate(zip(known, found, strict=True)):
            if one is None:
                none[line.method] = self._why_none(line)
            else:
                rows[k] = _row(line, one, self.limits)
        self._set_ranges(known, rows)
        if self.limits.given:
            self.tell("robustness of the choice")
        held_so, beside = self._held(known, rows)
        return [row | more for row, more in zip(rows, beside, strict=True)], none, held_so

    def _set_ranges(self, lines: Sequence[PreloadLine], rows: list[dict[str, Any]]) -> None:
        """Add to the row of the best method the range in which its preload may be set."""
        lives = [float(row["life"]) if "life" in row else 0.0 for row in rows]
        if not max(lives) > 0.0:
            return
        k = int(np.argmax(lives))
        line, solve = lines[k], partial(self._solve, _SEARCH)
        while True:
            longest = line.longest(self.limits)
            best = line.tried[rows[k]["preload"]]
            ((low, high),) = answered([settable(line, best, self.limits)], solve)
            if line.longest(self.limits) <= GAIN * longest:
                break
            # the lives that show the range may be longer than all before
            (found,) = answered([self._searched(line)], solve)
            assert found is not None
            rows[k] = _row(line, found, self.limits)
        rows[k] |= {"least_preload": low, "most_preload": high}

    def _searched(self, line: PreloadLine) -> Asking:
        """`search`, beyond an end of the map while that makes the longest life longer."""
        found: Found | None = yield from search(line, self.limits)
        for _ in range(STEPS_BEYOND):
            if found is None or held_back_by(line, found, self.limits) != END_OF_RANGE:
                break
            end, best = found.best.preload, found.best.life
            step = STEP_BEYOND if end == max(line.tried) else 1.0 / STEP_BEYOND
            *between, far = (float(f"{end * step ** (k / 3):.3g}") for k in (1, 2, 3))
            if far > most_preload():
                break
            yield [(line, far, True)]
            one = line.tried[far]
            if one.is_allowed(self.limits) and best <= one.life < LITTLE_LONGER * best:
                return replace(found, beyond=line.leave_out(far))
            ahead = sorted([*line.ahead, *between, far])
            line.lengthen(ahead, self._new(line.method, ahead[0], ahead[-1]))
            self.left.expect(_SEARCH, 12.0)
            found = yield from search(line, self.limits)
        return found

    def _at(self, method: str, preload: float) -> Scene:
        return held_by(self.scene, method, preload)

    def _line(self, one: xr.Dataset) -> PreloadLine:
        """Lives of one method that were solved, as they are in a file."""
        one = one.squeeze("preload_method")
        method, preloads = PRELOAD_METHODS[int(one["preload_method"])], one["preload"].values
        new = self._new(method, preloads[0], preloads[-1])
        line = PreloadLine(method, new, ahead=preloads.tolist())
        for k, preload in enumerate(line.ahead):
            if one["status"].values[k] == NOT_ASKED:
                continue
            values = {name: one[name].values[k] for name in POINT if name in one}
            for name in _IN_HOURS & set(values):
                values[name] = values[name] / HOURS_PER_SECOND
            line.add(preload, values, exact=True)
        return line

    def _why_none(self, line: PreloadLine) -> str:
        """Why no preload of a line is allowed, and how near one comes, whatever map it is from.

        At the coarse preloads that every map around the scene has, by exact lives where it counts.
        """
        preloads = list(line.ahead)
        if (own := self.scene.operation.preload_N) > 0.0:
            coarse = [p for f in COARSE if (p := round_factor(f, own)) in preloads]
            preloads = coarse if len(coarse) == len(COARSE) else preloads
        for _ in preloads:
            of_line = self._at_preloads(line, preloads)
            failed, _ = least_violations(of_line, self.limits)
            named = {preloads[k] for k in failed.values()}
            rough = [p for p in sorted(named) if DECIDING not in line.tried[p].values]
            rough = rough or [p for p in sorted(named) if not line.is_exact(p)]
            if not rough:
                break
            self._add(line, rough, exact=True)
        points = [line.tried[preload].values for preload in preloads]
        cases = bool(self.scene.cases)
        return why_none(of_line, self.limits, points, cases)

    def _add(self, line: PreloadLine, preloads: Sequence[float], exact: bool) -> None:
        requests = [(line, preload, exact) for preload in preloads]
        for preload, values in zip(preloads, self._solve(_SEARCH, requests), strict=True):
            line.add(preload, values, exact)

    def _at_preloads(self, line: PreloadLine, preloads: Sequence[float]) -> xr.Dataset:
        """Lives at some preloads, over these alone; those not tried are solved."""
        self._add(line, [p for p in preloads if p not in line.tried], exact=False)
        points = [line.tried[preload].values for preload in preloads]
        operation = self.scene.operation
        place = [self.scene.friction.coefficient], [operation.shaft_speed_rpm], preloads
        made = map_of(self.scene, ([line.method], *place), self.limits, points)
        return made.isel(preload_method=0, friction=0, shaft_speed=0)

    def _new(self, method: str, low: float, high: float) -> dict[str, np.ndarray] | None:
        """What limits look at, of new bearings between two preloads [N]; denser where some limit
        is passed by less than on both sides.
        """
        if not self.limits.given:
            return None
        points: dict[float, dict[str, Any]] = {}
        more = np.geomspace(low, high, 1 + math.ceil(math.log(high / low) / NEW_APART)).tolist()
        while more:
            points |= {p: new_point(self._at(method, p), self.limits) for p in more}
            preloads = sorted(points)
            names = {name for point in points.values() for name in point}
            names |= {name for limit in self.limits.held for name in LIMITED[limit].extremes}
            found = {
                name: np.array([points[p].get(name, math.nan) for p in preloads]) for name in names
            }
            more = denser(preloads, limit_margins(found, self.limits))
        return found | {"preload": np.array(preloads)}

    def _solve(self, kind: str, requests: Sequence[Request]) -> list[dict[str, Any]]:
        jobs = [
            (self._at(line.method, preload), self.limits, not exact)
            for line, preload, exact in requests
        ]
        solved = []
        for one, (*_, exact) in zip(self.each(_followed, jobs), requests, strict=True):
            solved.append(one)
            if kind == _SEARCH:
                self.left.done(kind, _EXACT if exact else 1.0)
        return solved

    def _held(
        self, lines: Sequence[PreloadLine], rows: Sequence[dict[str, Any]]
    ) -> tuple[xr.Dataset, list[dict[str, Any]]]:
        """How far the choice holds: limits with new preloads, all else at the recommended ones.

        Also what stands beside the recommended preload of each row.
        """
        lives = [float(r["life"]) if "life" in r else math.nan for r in rows]
        scenes = [
            self._at(line.method, r["preload"]) if "preload" in r else None
            for line, r in zip(lines, rows, strict=True)
        ]
        given_scenes = [one for one in scenes if one is not None]
        first = longer(np.nan_to_num(lives).tolist()) if len(lives) == 2 else None
        compared = given_scenes, lives, first or 0
        both = first is not None and len(given_scenes) == 2
        # begun before the lives of the limits, which wait for each other
        asked: list[Callable[[], Any]] = []
        if both:
            asked += [partial(friction_end, *compared, up) for up in _WAYS]
            asked.append(partial(criteria_room, *compared))
        asked += [
            partial(_printed, scene, row)
            for scene, row in zip(scenes, rows, strict=True)
            if scene is not None
        ]
        answers = self.each(_called, asked)
        room = [] if first is None else self._limits_room(lines, first)
        self.left.done(_LIMITS, 1.0)
        found = []
        for one in answers:
            found.append(one)
            self.left.done(_BESIDE, 1.0)
        if both:
            low, high, ends, *found = found
            room += [*ends, *friction_room(given_scenes[0], low, high)]
        beside = [{} if scene is None else found.pop(0) for scene in scenes]
        errors = [one.get("life_error_estimate", math.nan) for one in beside]
        return held(room, verdict_on(lives, errors, room)), beside

    def _limits_room(self, lines: Sequence[PreloadLine], first: int) -> list[Assumption]:
        names = list(self.limits.given)
        asking = [
            limit_end(lines, self.limits, name, upward, first) for name in names for upward in _WAYS
        ]
        ends = answered(asking, partial(self._solve, _LIMITS))
        return [
            Assumption(name=f"{LIMIT_KEY}{name}", now=self.limits.given[name], low=low, high=high)
            for name, low, high in zip(names, ends[::2], ends[1::2], strict=True)
        ]


def _followed(job: tuple[Scene, DesignLimits, bool]) -> dict[str, Any]:
    return followed_point(*job)


def _called(asked: Callable[[], Any]) -> Any:
    return asked()


def _printed(scene: Scene, point: Mapping[str, Any]) -> dict[str, Any]:
    """What stands beside a recommended preload."""
    return {**_as_printed(scene, point), MACHINE: machine_answers(scene)}


def _as_printed(scene: Scene, point: Mapping[str, Any]) -> dict[str, Any]:
    """What `life` says beside a life of the map: its numerical error, and the warnings.

    Of several cases the largest error, the warnings of all, and which is the worst.
    """
    if scene.duty is not None:
        answer = life(scene)
        error = answer.values.get("life_error_estimate", math.nan)
        kept = {"life_error_estimate": error, "warnings": answer.attrs["warnings"]}
        return kept | ({WORST_CASES: worst_cases(point)} if scene.cases else {})
    if scene.cases:
        points = point[CASE_POINTS]
        parts = {name: _as_printed(one, points[name]) for name, one in scene.in_cases.items()}
        errors = [parts[name]["life_error_estimate"] for name in cases_that_wear(scene)]
        return {
            "life_error_estimate": max(errors),
            "warnings": _with_cases(gathered_warnings(parts.values()), parts),
            WORST_CASES: worst_cases(point),
        }
    grooves, _ = grooves_followed(scene, "steady")
    if grooves is not None and WARNED in point:
        found = groove_errors(grooves, float(point["life"]), int(point["end_criterion"]))
        error = found.get("life_error_estimate", math.nan)
        return {"life_error_estimate": error, WARNED: point[WARNED]}
    answer = life(scene)
    error = answer.values.get("life_error_estimate", math.nan)
    return {"life_error_estimate": error, "warnings": answer.attrs["warnings"]}


def _with_cases(gathered: str, parts: Mapping[str, Mapping[str, Any]]) -> str:
    """Warnings of all cases, each with the names of those in which it stands."""
    found = json.loads(gathered)
    for one in found:
        one["in_cases"] = [
            name
            for name, part in parts.items()
            if any(one["id"] == other["id"] for other in warnings_in(part))
        ]
    return json.dumps(found)


def _row(line: PreloadLine, found: Found, limits: DesignLimits) -> dict[str, Any]:
    """A recommended preload and the cliff beside it."""
    row = dict(found.best.values) | {
        "preload": found.best.preload,
        "active_limit": held_back_by(line, found, limits),
    }
    for name, one in (("cliff", found.cliff), ("clear", found.clear)):
        if one is not None and one is not found.best:
            row |= {f"{name}_preload": one.preload, f"{name}_life": one.life}
    if one := found.beyond:
        running = one.values["residual_preload_at_start"]
        row |= {"beyond_preload": one.preload, "beyond_life": one.life}
        row |= {"beyond_running_preload": running}
    return row


def held_back_by(line: PreloadLine, found: Found, limits: DesignLimits) -> int:
    """Index into `ACTIVE`: what keeps the best preload from one with a longer life."""
    known, best = line.in_order, found.best
    k = known.index(best)
    neighbours = [known[n] for n in (k - 1, k + 1) if 0 <= n < len(known)]
    names = [*limits.held, ACTIVE[NOT_PRACTICAL]]
    margins = best.margins(limits)
    passed = [t.margins(limits) for t in neighbours if t.solved and t.life > best.life]
    passed = [m for m in passed if m.min() < 0.0]
    if passed:
        by_most = int(np.argmin(min(passed, key=lambda m: m.min())))
        # of several that a neighbour passes, one that is met here
        is_met = margins.min() < AT_LIMIT <= margins[by_most]
        return ACTIVE.index(names[int(np.argmin(margins)) if is_met else by_most])
    near = [*neighbours, *([found.cliff] if found.cliff else [])]
    if any(not t.solved for t in near):
        return NEXT_NOT_SOLVED
    if found.cliff or found.clear:
        return AT_CLIFF
    if margins.min() < AT_LIMIT:
        return ACTIVE.index(names[int(np.argmin(margins))])
    if len(neighbours) < 2:
        return END_OF_RANGE
    ends = {int(t.values["end_criterion"]) for t in (*neighbours, best)}
    return OTHER_END if len(ends) > 1 else UNLIMITED


def _dataset(rows: Sequence[dict[str, Any]], lines: xr.Dataset) -> xr.Dataset:
    more = table(
        RECOMMENDED_PRELOAD,
        ACTIVE_LIMIT,
        LIFE_ERROR,
        *CLIFF.values(),
        *BEYOND_RANGE.values(),
        *SETTABLE.values(),
    )
    axes = {MAP_AXES["preload_method"]: lines["preload_method"].values}
    known = [{name: row[name] for name in row if name not in ATTRIBUTES} for row in rows]
    made = filled_points(axes, known, more)
    made["status"].attrs["missing"] = "-1: nothing to solve"
    made.attrs = lines.attrs | {"kind": RECOMMENDATION, "title": "Recommended preload"}
    return made


def is_of_scene(found: xr.Dataset, scene: Scene) -> bool:
    """Whether a file was computed for a scene: all agrees that decides a life."""
    return decisive_data(json.loads(found.attrs["scene"])) == decisive_data(scene.to_dict())


def recommended_for(scene: Scene, recommendation: xr.Dataset | None) -> xr.Dataset:
    """The same, if it is the recommendation of this scene.

    CaseFileError: where it is not.
    """
    if recommendation is None or recommendation.attrs.get("kind") != RECOMMENDATION:
        raise CaseFileError("the recommended preload requires a recommendation file")
    if not is_of_scene(recommendation, scene):
        raise CaseFileError("the recommendation belongs to another scene")
    return recommendation


def best_method(recommendation: xr.Dataset) -> int | None:
    """Number of the method with the longest recommended life; None if no preload is allowed."""
    lives = recommendation["life"].values
    return int(np.nanargmax(lives)) if np.isfinite(lives).any() else None
