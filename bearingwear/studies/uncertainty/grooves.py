"""Sampled lives with grooves that are followed as they wear.

A few hundred lives are followed. The ratio of these to the lives with Hertzian grooves is
interpolated between them for the others, and its error is measured on lives that it was not fitted
to (docs/theory.md, section 15).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import RBFInterpolator

from bearingwear.kernels.status import OK
from bearingwear.lives.groove_life import grooves_followed
from bearingwear.lives.many import worn_life
from bearingwear.scene.blocks import CRITERIA
from bearingwear.scene.scene import COUNTS, Scene
from bearingwear.studies.pool import Tell, in_processes, told_in_lines

FITTED, HELD_OUT = 192, 64
"""Lives that are followed where there are more: to fit the ratio, and to see its error."""

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
    followed = order if order.size <= FITTED + HELD_OUT else order[: FITTED + HELD_OUT]
    chosen = [scenes[k] for k in followed]
    each = in_processes(_followed, chosen, workers, "uncertainty")
    if tell:
        each = told_in_lines(each, len(chosen), "{} of {} lives, grooves as they wear", tell=tell)
    found = np.array(list(each))
    status, criterion = hertzian.status.copy(), hertzian.end_criterion.copy()
    status[followed], criterion[followed] = found[:, 0].astype(int), found[:, 1].astype(int)
    ratio = np.ones(len(scenes))
    own = found[:, 2] / hertzian.life[followed, _RACES]
    ratio[followed] = np.where(np.isnan(found[:, 2]), 1.0, own)
    error = 0.0
    if followed.size < order.size:
        good = followed[found[:, 0] == OK]
        fitted, checked = good[:-HELD_OUT], good[-HELD_OUT:]
        miss = _interpolated(places, fitted, ratio, checked) / ratio[checked] - 1.0
        error = float(np.sqrt(np.mean(miss**2)))
        others = order[followed.size :]
        ratio[others] = _interpolated(places, good, ratio, others)
    life = hertzian.life.copy()
    life[:, _RACES] *= ratio
    life[status != OK] = np.nan
    return FollowedLives(
        life=life, status=status, end_criterion=criterion, followed=followed.size, error=error
    )


def _follows(scene: Scene | None) -> bool:
    return scene is not None and grooves_followed(scene, "steady")[0] is not None


def _followed(scene: Scene | None) -> tuple[int, int, float]:
    """Status, end criterion and life [s]; NaN where it stays the Hertzian one."""
    assert scene is not None
    worn = worn_life(scene)
    if worn is None:
        return OK, len(CRITERIA) - 1, np.nan
    life = float(worn.last.time[1]) if worn.status == OK else np.nan
    return worn.status, worn.criterion, life


def _interpolated(
    places: np.ndarray, known: np.ndarray, ratio: np.ndarray, asked: np.ndarray
) -> np.ndarray:
    """The ratio at some places from those where it is known, linear far from them."""
    spread = places[known].std(axis=0)
    used = spread > 0.0
    if not used.any():
        return np.full(asked.size, float(ratio[known].mean()))
    x = places[:, used] / spread[used]
    fit = RBFInterpolator(x[known], np.log(ratio[known]), kernel="linear", degree=1)
    return np.exp(fit(x[asked]))
