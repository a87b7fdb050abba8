"""The best preload of one method, between those of a line of a design map.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from bearingwear.kernels.status import OK
from bearingwear.model.life import life
from bearingwear.results.variable import HOURS_PER_SECOND
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.scene import Scene
from bearingwear.studies.design.choice import ACTIVE, OTHER_END, UNLIMITED, limit_margins
from bearingwear.studies.design.followed import WORN_GROOVE, followed_point
from bearingwear.studies.design.plan import DesignLimits

PRELOAD_TOLERANCE = 1e-6  # relative, of the recommended preload
BESIDE = 3e-3  # relative: where the ends of neighbouring lives are compared
LEAST_LEFT = 0.98  # of the life, lost by rounding the preload
AWAY = 0.02  # relative: where the margins on both sides are compared
STEPS_AWAY = 8  # of the last digit, in which they are looked for
AT_LIMIT = 5e-3  # what is left to a limit, relative, that counts as nothing


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


def best_point(searched: tuple[PreloadLine, int, int]) -> dict[str, Any]:
    """The best preload near a point of a line, and its life.

    Parameters
    ----------
    searched : tuple
        The line, number of the point, and number of the limit that holds it.
    """
    line, index, active = searched
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

    The part of the margin that a quick life misses there is taken for the same nearby.
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
    """Where the margin, its missed part included, vanishes between `a`, which keeps to the limits,
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
