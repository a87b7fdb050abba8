"""Sampled lives, Hertzian or with grooves that are followed as they wear.

Some lives of each sort are solved and the others interpolated (docs/theory.md, section 15).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bearingwear.kernels.status import BEYOND_GROOVE, OK
from bearingwear.lives.groove_life import grooves_followed
from bearingwear.lives.many import HertzianLives, worn_life
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.scene import Scene
from bearingwear.studies.pool import Tell, TimeLeft, processes, told_in_lines
from bearingwear.studies.sampling import perturbed
from bearingwear.studies.uncertainty.surrogate import (
    LEAST_SOUGHT,
    Interpolated,
    Stated,
    fewest,
    interpolated,
)

HERTZIAN, FOLLOWED = (64, 2048), (16, 256)
"""Lives that are solved where there are more, at least and at most."""

HERTZIAN_TO, FOLLOWED_TO = 2e-3, 1e-2
"""Error of 95 in 100 for which no more are solved; lives with worn grooves are themselves quick."""

_QUICK, _WORN = "Hertzian grooves", "worn grooves"
_AT_ONCE = {_QUICK: 16, _WORN: 2}
"""Lives that a process is given at a time."""

_WORN_COST = 6.0
"""Time of a life with worn grooves over that of a Hertzian one, before any is measured."""

_QUANTILES_COST = 0.01
"""Time of interpolation and quantiles for each sampled life, over that of a Hertzian life."""

_NO_CRITERION = len(CRITERIA) - 1

LivesAsked = tuple[Scene, Sequence[str], np.ndarray]
"""A scene, names of its uncertain values, and these values (k, names)."""


@dataclass(frozen=True, kw_only=True)
class FoundLives:
    """Lives at some places."""

    life: np.ndarray  # (n,) [s]; NaN where it was not solved
    status: np.ndarray  # (n,)
    end_criterion: np.ndarray
    solved: int  # lives that were solved with Hertzian grooves; others are interpolated
    known: Stated  # of those interpolated; zero where all were solved
    followed: int = 0  # lives whose grooves were followed
    # likewise, of lives with worn grooves; NaN where none was followed
    worn: Stated = Stated(np.nan, np.nan)


def found_lives(
    scene: Scene,
    names: Sequence[str],
    places: np.ndarray,
    workers: int = 1,
    tell: Tell | None = None,
) -> FoundLives:
    """Lives of a scene at values (n, names), with the grooves that `life` would follow."""
    ahead = {"quantiles": (1.0, _QUANTILES_COST * len(places))}
    ahead[_QUICK] = LEAST_SOUGHT + fewest(places, *HERTZIAN), 1.0
    if grooves_followed(scene, "steady")[0] is not None:
        ahead[_WORN] = LEAST_SOUGHT + fewest(places, *FOLLOWED), _WORN_COST
    left = TimeLeft(ahead)
    with processes(workers, "uncertainty") as each:

        def solver(function: Callable[[LivesAsked], list[Any]], what: str) -> Callable[..., Any]:
            def solve(which: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
                parts = np.array_split(which, math.ceil(which.size / _AT_ONCE[what]))
                found = each(function, [(scene, names, places[part]) for part in parts])
                if tell:
                    line = "{} of {} lives, " + what
                    found = told_in_lines(found, which.size, line, len, tell, what, left)
                life, *kinds = zip(*(one for part in found for one in part), strict=True)
                with np.errstate(divide="ignore"):  # a new bearing beyond a limit lives 0 s
                    return np.log(np.array(life)), np.array(kinds).T

            return solve

        hertzian = interpolated(places, solver(hertzian_lives, _QUICK), *HERTZIAN, HERTZIAN_TO)
        left.limit(_QUICK)
        asked = np.flatnonzero(np.isfinite(hertzian.log[:, 0]))
        if not (asked.size and hertzian.kind[:, 2].any()):
            return _found(hertzian)
        solve = solver(followed_lives, _WORN)

        def worn_lives(which: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            log, kinds = solve(asked[which])
            unlike = kinds[:, 2] == 0
            log[unlike] = hertzian.log[asked[which][unlike]]
            kinds[unlike] = hertzian.kind[asked[which][unlike]]
            return log, kinds

        worn = interpolated(places[asked], worn_lives, *FOLLOWED, FOLLOWED_TO)
    hertzian.log[asked] = worn.log
    hertzian.kind[asked] = worn.kind
    return _found(hertzian, followed=worn.solved, worn=worn.stated)


def _found(interpolated: Interpolated, **grooves: Any) -> FoundLives:
    status = interpolated.kind[:, 0]
    life = np.exp(interpolated.log[:, 0])
    life[status != OK] = np.nan
    return FoundLives(
        life=life,
        status=status,
        end_criterion=interpolated.kind[:, 1],
        solved=interpolated.solved,
        known=interpolated.stated,
        **grooves,
    )


def _scenes(job: LivesAsked) -> list[Scene | None]:
    scene, names, places = job
    return [perturbed(scene, dict(zip(names, place, strict=True))) for place in places.tolist()]


def hertzian_lives(job: LivesAsked) -> list[tuple[tuple[float], int, int, bool]]:
    """Lives (1,) with Hertzian grooves [s], status, end criterion, whether `life` follows them."""
    found = []
    for scene in _scenes(job):
        if scene is None:
            found.append(((np.nan,), BEYOND_GROOVE, _NO_CRITERION, False))
            continue
        life = HertzianLives(scene, quick=True)(scene)
        time = life.last.time if life.status == OK else np.nan
        follows = grooves_followed(scene, "steady")[0] is not None
        found.append(((time,), life.status, life.criterion, follows))
    return found


def followed_lives(job: LivesAsked) -> list[tuple[tuple[float], int, int, bool]]:
    """Lives (1,) with grooves as they wear [s], status and end criterion, whether there are any."""
    found = []
    for scene in _scenes(job):
        assert scene is not None
        worn = worn_life(scene)
        if worn is None:
            found.append(((np.nan,), OK, _NO_CRITERION, False))
        else:
            life = worn.last.time if worn.status == OK else np.nan
            found.append(((life,), worn.status, worn.criterion, True))
    return found
