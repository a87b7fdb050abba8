"""Sampled lives with grooves that are followed as they wear.

Some lives are followed. The ratio of these to the lives with Hertzian grooves is interpolated
between them for the others, and its error is measured on lives that it was not fitted to
(docs/theory.md, section 15). More are followed until that error is small, at most a few hundred.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.spatial.distance import cdist

from bearingwear.kernels.status import OK
from bearingwear.lives.groove_life import grooves_followed
from bearingwear.lives.many import worn_life
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.scene import COUNTS, Scene
from bearingwear.studies.pool import Tell, processes, told_in_lines

FITTED, HELD_OUT = (24, 48, 96, 192), 64
"""Lives that are followed where there are more: to fit the ratio, and to see its error."""

KNOWN_TO = 5e-3
"""rms error of the ratio for which no more are followed: quick lives are no better themselves."""

STEEP = 0.2
"""Change of the ratio from the nearest followed life, as a logarithm: beyond it a life is followed,
since another end of life lies between."""

_RACES = COUNTS.index("ball_and_races")
_SEED = 0  # of the choice of those that are followed


@dataclass(frozen=True, kw_only=True)
class FollowedLives:
    """Sampled lives with the grooves that a life follows.

    Attributes
    ----------
    life : (n, 2) ndarray
        By both ways of counting wear [s].
    status, end_criterion : (n,) ndarray
    followed : int
        Lives whose grooves were followed.
    error : float
        Root mean square, relative, of lives by the interpolated ratio; zero where all were
        followed, NaN where none was.
    """

    life: np.ndarray
    status: np.ndarray
    end_criterion: np.ndarray
    followed: int = 0
    error: float = np.nan


def with_followed_grooves(
    scenes: Sequence[Scene | None],
    places: np.ndarray,
    hertzian: FollowedLives,
    workers: int = 1,
    tell: Tell | None = None,
) -> FollowedLives:
    """Lives with the grooves that `life` would follow, from those with Hertzian ones.

    Parameters
    ----------
    scenes : sequence of Scene
        None where there is no such bearing.
    places : (n, values) ndarray
        What differs between them.
    hertzian : FollowedLives
    workers : int
        Processes that share the lives.
    """
    lived = (hertzian.status == OK) & (hertzian.life[:, _RACES] > 0.0)
    asked = np.flatnonzero(lived)
    first = next((scene for scene in scenes if scene is not None), None)
    if first is None or not asked.size or not any(map(_follows, scenes)):
        return hertzian
    order = np.random.default_rng(_SEED).permutation(asked)
    status, criterion = hertzian.status.copy(), hertzian.end_criterion.copy()
    ratio, error, done = np.ones(len(scenes)), 0.0, 0
    with processes(workers, "uncertainty") as each:

        def follow(new: np.ndarray) -> None:
            lives = each(_followed, [scenes[k] for k in new])
            if tell:
                what = "{} of {} lives, grooves as they wear"
                lives = told_in_lines(lives, new.size, what, tell=tell)
            for k, (solved, ended, life) in zip(new, lives, strict=True):
                status[k], criterion[k] = solved, ended
                own = life / hertzian.life[k, _RACES]
                ratio[k] = 1.0 if np.isnan(own) else own

        for count in FITTED:
            follow(order[done : HELD_OUT + count])
            done = min(HELD_OUT + count, order.size)
            good = order[:done][status[order[:done]] == OK]
            checked, fitted = good[:HELD_OUT], good[HELD_OUT:]
            if done == order.size or fitted.size < 2:
                continue
            found, steep = _interpolated(places, fitted, ratio, checked)
            error = float(np.sqrt(np.mean((found / ratio[checked] - 1.0)[~steep] ** 2)))
            if error <= KNOWN_TO:
                break
        if done < order.size:
            others = order[done:]
            ratio[others], steep = _interpolated(places, good, ratio, others)
            follow(others[steep])
            done += int(steep.sum())
    life = hertzian.life.copy()
    life[:, _RACES] *= ratio
    life[status != OK] = np.nan
    return FollowedLives(
        life=life, status=status, end_criterion=criterion, followed=done, error=error
    )


def _follows(scene: Scene | None) -> bool:
    return scene is not None and grooves_followed(scene, "steady")[0] is not None


def _followed(scene: Scene | None) -> tuple[int, int, float]:
    """Status, end criterion and life [s]; NaN where it stays the Hertzian one."""
    assert scene is not None
    worn = worn_life(scene, only_times=True)
    if worn is None:
        return OK, len(CRITERIA) - 1, np.nan
    life = float(worn.last.time[1]) if worn.status == OK else np.nan
    return worn.status, worn.criterion, life


def _interpolated(
    places: np.ndarray, known: np.ndarray, ratio: np.ndarray, asked: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The ratio at some places from those where it is known, linear far from them, and where it
    is steep.
    """
    spread = places[known].std(axis=0)
    used = spread > 0.0
    if not used.any():
        return np.full(asked.size, float(ratio[known].mean())), np.zeros(asked.size, bool)
    x, y = places[:, used] / spread[used], np.log(ratio[known])
    found = RBFInterpolator(x[known], y, kernel="linear", degree=1)(x[asked])
    nearest = cdist(x[asked], x[known]).argmin(axis=1)
    return np.exp(found), np.abs(found - y[nearest]) > STEEP
