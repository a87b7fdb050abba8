"""How far an assumption may move before the other preload method is the better one.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.measures import ENDS, LIMITED
from bearingwear.model.worn_courses import lives_by_end
from bearingwear.scene.blocks import BALL_TRACKS, EndOfLife
from bearingwear.scene.scene import Scene, key_of_scene
from bearingwear.studies.design.choice import limit_margins
from bearingwear.studies.design.followed import HERTZIAN_GROOVE, followed_point
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.design.words import END_KEY, FRICTION_KEY, LIMIT_KEY, WEAR_KEY

FARTHEST = 10.0
"""Largest factor by which a limit is moved either way."""

CRITERIA_FARTHEST = 4.0
"""The same for an end of life and for friction."""

_PRELOADS, _LIMITS, _CRITERIA, _FRICTIONS = 400, 240, 8, 6
_SAME, _HALVINGS, _FRICTION_HALVINGS = 1e-6, 20, 5
SHARES_OF_ENDS = ("preload_fraction", "gyroscopic_slip_share", "skid_ratio")
_LARGEST_SHARE = 0.999

Room = dict[str, tuple[float, float, float]]
"""By key: the value up to which a choice holds below, the value now, and the one above.

NaN where it holds over the whole range searched.
"""
Preference = Callable[[float], int | None]
"""Number of the better method with an assumption times a factor; None where it is not known."""


def limit_room(lines: xr.Dataset, limits: DesignLimits, basis: int) -> Room:
    """How far each limit may move before another method has the longest life.

    Lives and what is limited are interpolated between the preloads of the lines; preloads are
    chosen anew for each value of a limit.

    Parameters
    ----------
    lines : Dataset
        The map over `preload_method` and `preload`.
    limits : DesignLimits
    basis : int
        Index along the loss basis.
    """
    dense = [
        _dense(lines.isel(preload_method=k), basis) for k in range(len(lines["preload_method"]))
    ]
    if len(dense) < 2:
        return {}

    def best(moved: DesignLimits) -> int | None:
        return longer([_longest_within(line, moved) for line in dense])

    factors = FARTHEST ** np.linspace(0.0, 1.0, _LIMITS + 1)[1:]
    room: Room = {}
    for name, limit in limits.given.items():

        def choice(factor: float, name: str = name, limit: float = limit) -> int | None:
            return best(replace(limits, **{name: factor * limit}))

        room[f"{LIMIT_KEY}{name}"] = _holds(choice, limit, 1.0 / factors, factors)
    return room


def _dense(line: xr.Dataset, basis: int) -> dict[str, np.ndarray]:
    """What a line has at many preloads between those that were solved."""
    solved = (line["status"] == OK).values
    p, life = line["preload"].values, line["life"].isel(loss_basis=basis).values
    fine = np.geomspace(p[0], p[-1], _PRELOADS) if len(p) > 1 else p
    # between two solved neighbours alone
    whole = np.interp(fine, p, solved.astype(float)) > 1.0 - 1e-9
    known = {"life": np.where(solved, life, 0.0)}
    known |= {name: line[name].values for one in LIMITED.values() for name in one.extremes}
    x, at = np.log(p), np.log(fine)
    found = {name: np.interp(at, x, np.nan_to_num(v)) for name, v in known.items()}
    found["life"] = np.where(whole, found["life"], 0.0)
    return found


def _longest_within(line: Mapping[str, np.ndarray], limits: DesignLimits) -> float:
    allowed = line["life"] > 0.0
    for margin in limit_margins(line, limits):
        allowed = allowed & (margin >= -_SAME)
    return float(np.max(line["life"], where=allowed, initial=0.0))


def _holds(
    choice: Preference, now: float, below: np.ndarray, above: np.ndarray, halvings: int = _HALVINGS
) -> tuple[float, float, float]:
    """Values up to which a choice stays as it is, from factors going away from one."""
    first = choice(1.0)
    ends = []
    for factors in (below, above):
        changes, last = np.nan, 1.0
        for factor in factors.tolist() if first is not None else ():
            here = choice(factor)
            if here is None:
                break
            if here != first:
                for _ in range(halvings):
                    middle = float(np.sqrt(last * factor))
                    last, factor = (middle, factor) if choice(middle) == first else (last, middle)
                changes = last * now
                break
            last = factor
        ends.append(float(changes))
    return ends[0], now, ends[1]


def longer(lives: Sequence[float]) -> int | None:
    """Which of some lives is the longest; None where one was not solved, or all are nothing."""
    if not np.isfinite(lives).all() or not max(lives) > 0.0:
        return None
    return int(np.argmax(lives))


def criteria_room(scenes: Sequence[Scene], basis: int) -> Room:
    """How far each end of life may move before the other of two preloads lasts longer.

    Parameters
    ----------
    scenes : sequence of Scene
        With the preloads to compare, which stay as they are.
    basis : int
        Index along the loss basis.
    """
    end = scenes[0].wear.end_of_life or EndOfLife()
    most = {name: _largest(name, limit) for name, limit in end.criteria.items()}
    loose = {
        name: limit / CRITERIA_FARTHEST if ENDS[name].falls else most[name] * limit
        for name, limit in end.criteria.items()
    }
    lives = [lives_by_end(scene, replace(end, **loose), basis) for scene in scenes]
    even = np.linspace(0.0, 1.0, _CRITERIA + 1)[1:]
    room: Room = {}
    for name, limit in end.criteria.items():

        def choice(factor: float, name: str = name, limit: float = limit) -> int | None:
            moved = replace(end, **{name: factor * limit})
            return longer([life(moved) for life in lives])

        above = most[name] ** even if most[name] > 1.0 else np.array([])
        room[f"{END_KEY}{name}"] = _holds(choice, limit, CRITERIA_FARTHEST**-even, above)
    return room


def _largest(name: str, limit: float) -> float:
    """How many times larger an end of life may be."""
    if name not in SHARES_OF_ENDS:
        return CRITERIA_FARTHEST
    return max(1.0, min(CRITERIA_FARTHEST, _LARGEST_SHARE / limit))


def friction_room(scenes: Sequence[Scene], basis: int) -> Room:
    """The same of friction, and of the wear coefficient, to which all lives are proportional."""
    mu = scenes[0].friction.coefficient
    part = key_of_scene(FRICTION_KEY)
    assert part is not None
    most = min(CRITERIA_FARTHEST, part.key.ends[1] / mu) if mu > 0.0 else 0.0

    def choice(factor: float) -> int | None:
        made = [
            replace(one, friction=replace(one.friction, ball_race=factor * mu)) for one in scenes
        ]
        return longer([_life(one, basis) for one in made])

    K = scenes[0].materials[scenes[0].bearing.race_material].wear_coefficient
    found: Room = {WEAR_KEY: (np.nan, K, np.nan)}
    if most > 1.0:
        even = np.linspace(0.0, 1.0, _FRICTIONS + 1)[1:]
        found[FRICTION_KEY] = _holds(
            choice, mu, CRITERIA_FARTHEST**-even, most**even, _FRICTION_HALVINGS
        )
    return found


def _life(scene: Scene, basis: int) -> float:
    """With the groove that a life follows [s]; NaN where it was not solved."""
    found = followed_point(scene, None)
    return float(found["life"][basis]) if found["status"] == OK else np.nan


def lives_by_track(scenes: Sequence[Scene | None], basis: int) -> np.ndarray:
    """Lives (scenes, `BALL_TRACKS`) [s]; all NaN where none follows a groove."""
    lives, followed = np.full((len(scenes), len(BALL_TRACKS)), np.nan), False
    for i, scene in enumerate(scenes):
        for k, track in enumerate(BALL_TRACKS if scene is not None else ()):
            assert scene is not None
            point = followed_point(replace(scene, wear=replace(scene.wear, ball_track=track)), None)
            followed |= point["groove"] != HERTZIAN_GROOVE
            if point["status"] == OK:
                lives[i, k] = point["life"][basis]
            if not followed:
                return lives * np.nan
    return lives
