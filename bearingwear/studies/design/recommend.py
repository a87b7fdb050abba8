"""The preload to take, between those of a design map.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import brentq, minimize_scalar

from bearingwear.kernels.status import OK
from bearingwear.model.life import life
from bearingwear.results.netcdf import CaseFileError, data_array, load
from bearingwear.results.variable import HOURS_PER_SECOND, Variable
from bearingwear.results.warnings import gathered_warnings
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.studies.dataset import LOSS_BASIS, counted, dataset_with
from bearingwear.studies.design.choice import (
    ACTIVE,
    ACTIVE_LIMIT,
    OTHER_END,
    UNLIMITED,
    best_within,
    limit_margins,
    limits_of,
    whole_map,
    why_none,
)
from bearingwear.studies.design.followed import (
    WORN_GROOVE,
    as_followed,
    followed_lines,
    followed_point,
    with_grooves,
)
from bearingwear.studies.design.map import solved_part
from bearingwear.studies.design.plan import DesignLimits, MapAxes
from bearingwear.studies.design.room import (
    Room,
    criteria_room,
    friction_room,
    limit_room,
    lives_by_track,
)
from bearingwear.studies.design.verdict import held, verdict_on
from bearingwear.studies.design.words import NONE_BECAUSE
from bearingwear.studies.life_scene import life_scene

RECOMMENDATION = "recommendation"
RECOMMENDED_PRELOAD = Variable(
    "preload",
    (),
    "N",
    "recommended initial axial preload",
    comment="in three digits, or as many more as keep to the limits and to the life",
)
HERTZIAN_PRELOAD = Variable(
    "hertzian_preload", (), "N", "preload of the map, of Hertzian grooves, with the longest life"
)
LIFE_ERROR = Variable(
    "life_error_estimate", LOSS_BASIS.dims, "1", "estimated numerical error of the life"
)
PRELOAD_TOLERANCE = 1e-6  # relative, of the recommended preload
BESIDE = 3e-3  # relative: where it is asked what ends a life beside the longest one
LEAST_LEFT = 0.98  # of the life, where the preload is rounded
AWAY = 0.02  # relative: where it is asked on which side the limits are farther
STEPS_AWAY = 8  # of the last digit, in which they are looked for
AT_LIMIT = 5e-3  # what is left to a limit, relative, that counts as nothing


def recommendation_of(scene: Path, design: Path) -> xr.Dataset:
    """Step: the preload to take, from a scene and its design map."""
    return recommendation(life_scene(scene), load(design))


def small_map(
    scene: Path, axes: Mapping[str, Any], limits: Mapping[str, float]
) -> tuple[xr.Dataset, xr.Dataset]:
    """Step: a map and the preload to take of it, in one process.

    Parameters
    ----------
    scene : path
    axes, limits : mapping
        `MapAxes` and `DesignLimits` by their names.
    """
    return mapped(life_scene(scene), MapAxes(**axes), DesignLimits(**limits))


def mapped(scene: Scene, axes: MapAxes, limits: DesignLimits) -> tuple[xr.Dataset, xr.Dataset]:
    """A map and the preload to take of it."""
    parts = [
        solved_part(
            scene,
            method,
            friction,
            axes.shaft_speed_rpm,
            axes.preload_N,
            limits.gyroscopic_slip_share,
        )
        for method in axes.preload_method
        for friction in axes.friction
    ]
    design = whole_map(parts, limits.given)
    return design, recommendation(scene, design)


def recommendation(scene: Scene, design: xr.Dataset) -> xr.Dataset:
    """The preload to take for each method at the scene's own friction and speed, between the
    map's preloads.

    Where the scene's life follows the grooves as they wear, so do all lives of the lines of
    preloads at its friction and speed, and the choice is made by those. The limit that holds the
    best preload is followed to where it is met exactly; where none does, the longest life between
    the neighbours is looked for.

    Raises
    ------
    CaseFileError
        Where the map is of another scene or does not hold its friction and speed.
    """
    if json.loads(design.attrs["scene"]) != scene.to_dict():
        raise CaseFileError("the design map is not of this scene")
    point = {"friction": scene.friction.coefficient, "shaft_speed": scene.operation.shaft_speed_rpm}
    for axis, value in point.items():
        if value not in design[axis]:
            raise CaseFileError(f"the design map has no {axis} {value:g}, which is the scene's")
    limits, basis = limits_of(design), counted(design)
    at_scene = design.sel(point, drop=True)
    lines = followed_lines(scene, at_scene, limits.gyroscopic_slip_share)
    rows, none = [], {}
    for k, flag in enumerate(lines["preload_method"].values):
        one, method = lines.isel(preload_method=k), PRELOAD_METHODS[int(flag)]
        index, active = (int(found) for found in best_within(one, limits, basis))
        row: dict[str, Any] = {"active_limit": active, "preload": np.nan, "status": -1}
        if index >= 0:
            line = PreloadLine(
                scene=scene,
                method=method,
                limits=limits,
                basis=basis,
                preloads=one["preload"].values,
                lives=one["life"].isel(loss_basis=basis).values,
            )
            row |= _refined(line, index, active)
        else:
            none[method] = why_none(one, limits, basis)
        rows.append(row | {"hertzian_preload": float(at_scene["recommended_preload"][k])})
    found = _dataset(rows, at_scene, design)
    found = found.merge(_held(scene, lines, found, limits, basis), combine_attrs="override")
    if lines is not at_scene:
        found = found.assign(as_followed(lines))
    found.attrs["warnings"] = gathered_warnings({"warnings": r.get("warnings", "[]")} for r in rows)
    return found.assign_attrs({NONE_BECAUSE: json.dumps(none)} if none else {})


def _held(
    scene: Scene, lines: xr.Dataset, found: xr.Dataset, limits: DesignLimits, basis: int
) -> xr.Dataset:
    """How far the choice holds: limits with new preloads, all else at the recommended ones."""
    pairs = zip(found["preload_method"].values, found["preload"].values.tolist(), strict=True)
    scenes = [
        held_by(scene, PRELOAD_METHODS[int(flag)], preload) if np.isfinite(preload) else None
        for flag, preload in pairs
    ]
    room: Room = limit_room(lines, limits, basis)
    both = [one for one in scenes if one is not None]
    if len(both) == 2:
        room |= criteria_room(both, basis) | friction_room(both, basis)
    tracks = lives_by_track(scenes, basis)
    lives = found["life"].isel(loss_basis=basis).values.tolist()
    errors = found["life_error_estimate"].isel(loss_basis=basis).values.tolist()
    return held(room, tracks, verdict_on(lives, errors, room, tracks))


@dataclass(frozen=True, kw_only=True)
class PreloadLine:
    """Lives of one method over preload, and those between the points.

    Attributes
    ----------
    basis : int
        Index along the loss basis.
    preloads : (n,) ndarray
        [N]
    lives : (n,) ndarray
        [h]
    known : dict
        Points that were found, by preload and whether quickly.
    """

    scene: Scene
    method: str
    limits: DesignLimits
    basis: int
    preloads: np.ndarray
    lives: np.ndarray
    known: dict[tuple[float, bool], dict[str, Any]] = field(default_factory=dict)

    def scene_at(self, preload: float) -> Scene:
        return held_by(self.scene, self.method, preload)

    def point(self, preload: float, quick: bool = True) -> dict[str, Any]:
        """What `followed_point` finds at a preload [N]."""
        if (preload, quick) not in self.known:
            slip_limit = self.limits.gyroscopic_slip_share
            self.known[preload, quick] = followed_point(self.scene_at(preload), slip_limit, quick)
        return self.known[preload, quick]

    def follows_grooves(self, preload: float) -> bool:
        return bool(self.point(preload)["groove"] == WORN_GROOVE)

    def margin(self, preload: float, quick: bool = True) -> float:
        """How far the nearest limit is; -1 where the life was not solved, infinite without any."""
        found = self.point(preload, quick)
        if found["status"] != OK:
            return -1.0
        return min(limit_margins(found, self.limits), default=np.inf)

    def life_within(self, preload: float, quick: bool = True) -> float:
        """The life [s]; zero where it was not solved or passes a limit."""
        found = self.point(preload, quick)
        within = found["status"] == OK and all(m >= 0.0 for m in limit_margins(found, self.limits))
        return float(found["life"][self.basis]) if within else 0.0

    def ends_otherwise_beside(self, preload: float) -> bool:
        """Whether lives close by, on either side, are ended by different criteria of the scene."""
        beside = [self.point(times * preload) for times in (1.0 - BESIDE, 1.0 + BESIDE)]
        ends = {one["end_criterion"] for one in beside}
        return all(one["status"] == OK for one in beside) and len(ends) > 1

    def rounded(self, preload: float) -> float:
        """A preload with the fewest digits, three at least, that is as good as this one [N].

        It may be rounded to either side: one of them can pass a limit, or end the life at once.
        """
        enough = LEAST_LEFT * self.life_within(preload)
        least = 2 - math.floor(math.log10(preload))
        for decimals in range(least, 9):
            unit = 10.0**-decimals
            near = sorted(
                (round(unit * side(preload / unit), 9) for side in (math.floor, math.ceil)),
                key=lambda p: abs(p - preload),
            )
            if decimals == least and self.follows_grooves(preload):
                near += self.farther_from_limits(preload, unit)
            for one in near:
                if one > 0.0 and self.life_within(one, quick=False) >= enough > 0.0:
                    return one
        return preload

    def farther_from_limits(self, preload: float, unit: float) -> list[float]:
        """Preloads ever farther from the limits, which a quick life sees with some scatter [N]."""
        more = self.margin(preload * (1.0 + AWAY)) >= self.margin(preload * (1.0 - AWAY))
        first, way = (math.floor(preload / unit), 1) if more else (math.ceil(preload / unit), -1)
        return [round(unit * (first + way * k), 9) for k in range(2, 2 + STEPS_AWAY)]


def _refined(line: PreloadLine, index: int, active: int) -> dict[str, Any]:
    """The best preload near a point of a line, and its life."""
    best = float(line.preloads[index])
    if active < UNLIMITED:
        best = _on_limit(line, index)
    elif active == UNLIMITED:
        best = _longest(line, index)
    values = line.point(best)
    if active <= UNLIMITED:  # between points of the map another limit may be met, or met first
        left = limit_margins(values, line.limits)
        if left and min(left) < AT_LIMIT:
            active = ACTIVE.index(list(line.limits.given)[int(np.argmin(left))])
        elif active == UNLIMITED and line.ends_otherwise_beside(best):
            active = OTHER_END
    to_set = line.rounded(best)
    answer = life(line.scene_at(to_set))
    error = answer.values.get("life_error_estimate", np.full(2, np.nan))
    return line.point(to_set, quick=False) | {
        "preload": to_set,
        "active_limit": active,
        "life_error_estimate": error,
        "warnings": answer.attrs["warnings"],
    }


def _on_limit(line: PreloadLine, index: int) -> float:
    """Where the limit is met that lies between a point and its neighbour with the longer life.

    What a quick life does not see of the margin there is taken for the same nearby.
    """
    lives = line.lives
    ends = [k for k in (index - 1, index + 1) if 0 <= k < len(lives)]
    beyond = max((k for k in ends if lives[k] > lives[index]), key=lambda k: lives[k])
    a, b = float(line.preloads[index]), float(line.preloads[beyond])
    root = _met_at(line, a, b, 0.0)
    if line.follows_grooves(root):
        root = _met_at(line, a, b, line.margin(root, quick=False) - line.margin(root))
    return root


def _met_at(line: PreloadLine, a: float, b: float, unseen: float) -> float:
    """Where the margin, with what is unseen of it, vanishes between `a`, which keeps to the limits,
    and `b`.
    """

    def margin(preload: float) -> float:
        return line.margin(preload) + unseen

    if margin(a) <= 0.0:  # it stands on the limit already
        return a
    if margin(b) >= 0.0:
        return b
    root = brentq(margin, a, b, rtol=PRELOAD_TOLERANCE)
    # the side of the root that keeps to the limits
    near = (root, root + PRELOAD_TOLERANCE * (a - b), root + 1e-3 * (a - b), a)
    return next(p for p in near if margin(p) >= 0.0)


def _longest(line: PreloadLine, index: int) -> float:
    """The preload with the longest life between the neighbours of a point."""
    best = float(line.preloads[index])
    found = minimize_scalar(
        lambda p: -line.life_within(p),
        bounds=(float(line.preloads[index - 1]), float(line.preloads[index + 1])),
        method="bounded",
        options={"xatol": 1e-3 * best},
    )
    return float(found.x) if -found.fun > line.lives[index] / HOURS_PER_SECOND else best


def _dataset(
    rows: Sequence[dict[str, Any]], at_scene: xr.Dataset, design: xr.Dataset
) -> xr.Dataset:
    along = ("preload_method",)
    unknown: dict[str, Any] = {"end_criterion": len(CRITERIA) - 1}
    unknown |= {"life_error_estimate": np.full(2, np.nan)}
    rows = [unknown | row for row in rows]
    variables = with_grooves(rows, {"preload_method": len(rows)})
    variables["status"].attrs["missing"] = "-1: there was none to solve"
    for variable in (
        RECOMMENDED_PRELOAD,
        HERTZIAN_PRELOAD,
        replace(ACTIVE_LIMIT, long_name="what keeps it from a longer life"),
        LIFE_ERROR,
    ):
        column = np.array([row[variable.name] for row in rows])
        variables[variable.name] = data_array(variable, column, along)
    return dataset_with(
        variables,
        {name: at_scene[name].variable for name in ("preload_method", "loss_basis")},
        design.attrs | {"kind": RECOMMENDATION, "title": "Recommended preload"},
    )


def recommended_for(scene: Scene, recommendation: xr.Dataset | None) -> xr.Dataset:
    """The same, if it is the recommendation of this scene.

    Raises
    ------
    CaseFileError
        Where it is not.
    """
    if recommendation is None or recommendation.attrs.get("kind") != RECOMMENDATION:
        raise CaseFileError("the recommended preload needs the file of a recommendation")
    if json.loads(recommendation.attrs["scene"]) != scene.to_dict():
        raise CaseFileError("the recommendation is not of this scene")
    return recommendation


def best_method(recommendation: xr.Dataset) -> int | None:
    """Number of the method with the longest recommended life; None if no preload is allowed."""
    lives = recommendation["life"].isel(loss_basis=counted(recommendation)).values
    return int(np.nanargmax(lives)) if np.isfinite(lives).any() else None
