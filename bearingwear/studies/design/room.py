"""How far limits and ends of life may move before the other preload method is the better one.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr
from scipy.optimize import brentq

from bearingwear.kernels.status import OK
from bearingwear.model.courses import WearCourses
from bearingwear.scene.blocks import EndOfLife
from bearingwear.scene.scene import Scene
from bearingwear.studies.design.choice import LIMITED
from bearingwear.studies.design.plan import DesignLimits

FARTHEST = 10.0
"""How many times larger or smaller a limit is looked at."""

CRITERIA_FARTHEST = 4.0
"""The same of an end of life."""

_PRELOADS, _LIMITS, _CRITERIA = 400, 241, 9
_SAME = 1e-6
SHARES_OF_ENDS = ("preload_fraction", "gyroscopic_slip_share", "skid_ratio")

Room = dict[str, tuple[float, float]]
"""Of each limit, the values below and above the given one up to which the choice holds.

NaN where it holds as far as was looked.
"""


def limit_room(at_scene: xr.Dataset, limits: DesignLimits, basis: int) -> Room:
    """How far each limit may move before another method has the longest life.

    Lives and what is limited are interpolated between the preloads of the map; preloads are chosen
    anew for each value of a limit.

    Parameters
    ----------
    at_scene : Dataset
        The map over `preload_method` and `preload`.
    limits : DesignLimits
    basis : int
        Index along the loss basis.
    """
    lines = [
        _dense(at_scene.isel(preload_method=k), basis)
        for k in range(len(at_scene["preload_method"]))
    ]
    if len(lines) < 2:
        return {}

    def best(values: Mapping[str, float]) -> int:
        lives = [_longest_within(line, values) for line in lines]
        return int(np.argmax(lives)) if max(lives) > 0.0 else -1

    given = limits.given
    room = {}
    for name, limit in given.items():

        def choice(factor: float, name: str = name, limit: float = limit) -> int:
            return best(given | {name: factor * limit})

        room[name] = _ends(choice, limit)
    return room


def _dense(line: xr.Dataset, basis: int) -> dict[str, np.ndarray]:
    """What a line has at many preloads between those that were solved."""
    solved = (line["status"] == OK).values
    p, life = line["preload"].values, line["life"].isel(loss_basis=basis).values
    fine = np.geomspace(p[0], p[-1], _PRELOADS) if len(p) > 1 else p
    # between two solved neighbours alone
    whole = np.interp(fine, p, solved.astype(float)) > 1.0 - 1e-9
    known = {"life": np.where(solved, life, 0.0)}
    known |= {one.variable: line[one.variable].values for one in LIMITED.values()}
    x, at = np.log(p), np.log(fine)
    found = {name: np.interp(at, x, np.nan_to_num(v)) for name, v in known.items()}
    found["life"] = np.where(whole, found["life"], 0.0)
    return found


def _longest_within(line: Mapping[str, np.ndarray], values: Mapping[str, float]) -> float:
    allowed = line["life"] > 0.0
    for name, value in values.items():
        one = LIMITED[name]
        allowed &= one.sign * (1.0 - line[one.variable] / (value * one.unit)) >= -_SAME
    return float(np.max(line["life"], where=allowed, initial=0.0))


def _ends(choice: Callable[[float], int], limit: float) -> tuple[float, float]:
    """Values below and above a limit at which a choice over its multiple changes."""
    now = choice(1.0)
    ends = []
    for way in (-1.0, 1.0):
        changes, last = np.nan, 1.0
        for factor in FARTHEST ** (way * np.linspace(0.0, 1.0, _LIMITS)[1:]):
            if choice(float(factor)) != now:
                for _ in range(20):
                    middle = float(np.sqrt(last * factor))
                    last, factor = (middle, factor) if choice(middle) == now else (last, middle)
                changes = last * limit
                break
            last = float(factor)
        ends.append(float(changes))
    return ends[0], ends[1]


def criteria_room(scenes: Sequence[Scene], basis: int) -> Room:
    """How far each end of life may move before the other of two preloads lives longer.

    Parameters
    ----------
    scenes : sequence of Scene
        With the preloads to compare, which stay as they are.
    basis : int
        Index along the loss basis.
    """
    first, second = (WearCourses(scene) for scene in scenes)
    found: Room = {}
    for name, limit in (scenes[0].wear.end_of_life or EndOfLife()).criteria.items():

        def log_ratio(log_factor: float, name: str = name, limit: float = limit) -> float:
            moved = [_with_end(scene, name, float(np.exp(log_factor)) * limit) for scene in scenes]
            lives = [follow(scene) for follow, scene in zip((first, second), moved, strict=True)]
            if any(life.status != OK or not life.times[-1][basis] > 0.0 for life in lives):
                return np.nan
            one, other = (float(life.times[-1][basis]) for life in lives)
            return float(np.log(one / other))

        found[name] = _crossings(log_ratio, limit, name in SHARES_OF_ENDS)
    return found


def _with_end(scene: Scene, name: str, value: float) -> Scene:
    end = replace(scene.wear.end_of_life or EndOfLife(), **{name: value})
    return replace(scene, wear=replace(scene.wear, end_of_life=end))


def _crossings(
    log_ratio: Callable[[float], float], limit: float, share: bool
) -> tuple[float, float]:
    """Values below and above a limit at which a ratio passes one."""
    now = log_ratio(0.0)
    farthest = np.log(CRITERIA_FARTHEST)
    most = min(farthest, np.log(0.999 / limit)) if share and limit < 0.999 else farthest
    ends = []
    for far in (-farthest, 0.0 if share and limit >= 0.999 else most):
        changes, last = np.nan, 0.0
        for at in np.linspace(0.0, far, _CRITERIA)[1:] if far else ():
            here = log_ratio(float(at))
            if not np.isfinite(here) or not np.isfinite(now):
                break
            if here * now < 0.0:
                changes = limit * float(np.exp(brentq(log_ratio, last, at, xtol=1e-4)))
                break
            last = float(at)
        ends.append(float(changes))
    return ends[0], ends[1]


def as_lists(room: Room) -> dict[str, list[float | None]]:
    """For JSON, which has no NaN."""
    return {name: [v if np.isfinite(v) else None for v in ends] for name, ends in room.items()}
