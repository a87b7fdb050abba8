"""The preload with the longest life within requirements, by lives at many preloads.

Quick lives over a range show where to look; exact ones beside the best are what is recommended.
Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import bisect
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from bearingwear.kernels.status import OK
from bearingwear.measures import LIMITED
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.scene import PRELOAD_METHODS, Scene
from bearingwear.studies.design.choice import (
    ACTIVE,
    END_OF_RANGE,
    NEXT_NOT_SOLVED,
    NOT_PRACTICAL,
    OTHER_END,
    UNLIMITED,
)
from bearingwear.studies.design.map import design_point, new_point
from bearingwear.studies.design.plan import (
    DesignLimits,
    most_preload,
    round_factor,
    round_number,
)

SWEPT_FACTORS = tuple(2.0 ** (k / 4) for k in range(-12, 21))
"""Preloads of the first lives, over the scene's own: an eighth to 32 times."""

_STEP_BEYOND, _STEPS_BEYOND, _LITTLE_LONGER = 8.0, 3, 1.1
"""Beyond an end of the range at which the life is longest: a step, how many at most, and how many
times longer the life has to become for the preload at its end to be taken."""

_BETWEEN = 1.2  # times the longer of two neighbouring lives, at most the life between them
_FAR = 0.1  # of a requirement: so far beyond it on both sides, it is not met between them
_ROUGH = 0.05  # of a requirement: so far beyond it, it may be a quick life that is wrong
_EDGE = 5e-3  # width in log preload to which it is found where new bearings meet the requirements
_PEAK, _NEAR_PEAK = 1e-2, 0.5  # the same beside a peak of their margins, and how far it may be
_GAIN = 5e-3  # of the life, for which no exact life is solved
_NEAR = 0.1  # in log preload, as far as a life is known to go evenly
_EVEN = 0.3  # power by which a life that falls evenly may still rise
_STEEPEST = 1.0  # power of the preload with which a life rises, other than at a jump
_ROUNDS = 6  # of exact lives, at most
SIMILAR = 0.9
"""Least share of the longest life at which a preload may be set in place of the recommended one."""
_END_WIDTH = 0.06  # in log preload, to which the ends of these preloads are found
_AT_LIMIT = 5e-3  # what is left to a requirement, relative, that counts as nothing

NEW_BEARING, QUICK_LIFE, EXACT_LIFE = range(3)
"""What was solved at a preload: new bearings alone, a quick life, or the life that is printed."""


@dataclass(frozen=True)
class PreloadPoint:
    """A preload at which new bearings or a life were solved."""

    preload: float  # [N]
    values: Mapping[str, Any]  # as of `design_point` or `new_point`
    solved: int  # NEW_BEARING, QUICK_LIFE or EXACT_LIFE

    @property
    def life(self) -> float:
        """The life [s]; zero where it was not solved."""
        life = self.values.get("life", 0.0) if self.values["status"] == OK else 0.0
        return life if life > 0.0 else 0.0

    def margins(self, limits: DesignLimits) -> np.ndarray:
        """Relative margins of the requirements, and last whether one would build it (1 or -1).

        What is not known is not met, but by new bearings what depends on the life.
        """
        if self.values["status"] != OK:
            return np.full(len(limits.effective) + 1, -1.0)
        unknown = math.inf if self.solved == NEW_BEARING else -1.0
        found = []
        for name, limit in limits.effective.items():
            one = LIMITED[name]
            known = [self.values[extreme] for extreme in one.extremes if extreme in self.values]
            each = [one.margin(value, limit) for value in known if value == value]
            found.append(min(each) if each else -1.0 if known else unknown)
        found.append(-1.0 if self.values.get("impractical") else 1.0)
        return np.array(found)

    def is_allowed(self, limits: DesignLimits) -> bool:
        """Whether all requirements are met and, if a life was solved, there is one."""
        return (self.solved == NEW_BEARING or self.life > 0.0) and bool(
            self.margins(limits).min() >= 0.0
        )


@dataclass
class PreloadLine:
    """What was solved at preloads with one preload method."""

    method: str
    grid: Sequence[float]  # preloads of the first lives [N], rising
    new: dict[float, PreloadPoint] = field(default_factory=dict)
    lives: dict[float, PreloadPoint] = field(default_factory=dict)
    # where the longest life is at an end of the range: the preload farther away that was tried
    beyond: PreloadPoint | None = None

    def in_order(self, limits: DesignLimits) -> list[PreloadPoint]:
        """Lives, and new bearings that do not meet the requirements."""
        refused = {p: one for p, one in self.new.items() if not one.is_allowed(limits)}
        return [one for _, one in sorted((refused | self.lives).items())]

    def best(self, limits: DesignLimits) -> PreloadPoint | None:
        """The longest life that was solved within the requirements."""
        allowed = [one for one in self.lives.values() if one.is_allowed(limits)]
        return max(allowed, key=lambda one: one.life, default=None)

    def may_live(self, preload: float, limits: DesignLimits) -> bool:
        """Whether new bearings at a preload do not rule out that it is allowed worn."""
        new = self.new.get(preload)
        return new is None or new.values["status"] != OK or new.is_allowed(limits)


AnswersAt = Callable[[Callable[[Any], Any], Sequence[Any]], Iterator[Any]]
"""Asks a function at points, in their order: `map`, or `answers_at` of processes."""

Wanted = Callable[[PreloadLine], list[float]]
"""Preloads [N] of a line at which something has to be solved."""


@dataclass
class PreloadSearch:
    """Lives of a scene over preload, by each method."""

    scene: Scene
    limits: DesignLimits
    answers_at: AnswersAt = map
    lines: list[PreloadLine] = field(init=False)

    def __post_init__(self) -> None:
        own = self.scene.operation.preload_N
        around = {round_factor(factor, own) for factor in SWEPT_FACTORS}
        grid = sorted(preload for preload in around if preload <= most_preload())
        self.lines = [PreloadLine(method, grid) for method in PRELOAD_METHODS]

    def solve(self, wanted: Wanted, solved: int, limits: DesignLimits | None = None) -> bool:
        """Solve what all lines want; returns whether they want anything.

        New bearings are solved first where a life is wanted: a preload at which they break a
        requirement has none.

        limits: requirements in place of those of the search.
        """
        limits = limits or self.limits
        asked = [(line, p) for line in self.lines for p in wanted(line)]
        if solved != NEW_BEARING:
            unseen = [(line, p) for line, p in asked if p not in line.new]
            self._solve(unseen, NEW_BEARING)
            asked = [(line, p) for line, p in asked if line.may_live(p, limits)]
        self._solve(asked, solved)
        return bool(asked)

    def _solve(self, asked: Sequence[tuple[PreloadLine, float]], solved: int) -> None:
        jobs = [
            (held_by(self.scene, line.method, preload), self.limits, solved)
            for line, preload in asked
        ]
        for (line, preload), values in zip(
            asked, self.answers_at(_solved_point, jobs), strict=True
        ):
            point = PreloadPoint(preload, values, solved)
            (line.new if solved == NEW_BEARING else line.lives)[preload] = point

    def run(self) -> None:
        """Solve all that shows the best preload of each method, and where it may be set."""
        self.sweep()
        for _ in range(_STEPS_BEYOND):
            ends = [self._lengthened(line) for line in self.lines]
            if not any(ends):
                break
            self.sweep()
            for line, end in zip(self.lines, ends, strict=True):
                if end is not None:
                    self._shorten(line, end)
        for k in itertools.count():
            if not self.solve(partial(self._refined, is_last=k >= _ROUNDS), EXACT_LIFE):
                break

    def _refined(self, line: PreloadLine, is_last: bool) -> list[float]:
        """Lives beside the best one; where there are none, those that show where it may be set, of
        the line with the longest life.

        is_last: whether no more lives are solved beside the best one.
        """
        beside = self._beside_best(line, is_last)
        if beside:
            return beside
        lives = [best.life if (best := one.best(self.limits)) else 0.0 for one in self.lines]
        return self._at_ends(line) if line is self.lines[int(np.argmax(lives))] else []

    def sweep(self) -> None:
        """Solve new bearings and quick lives over the preloads of each line."""
        self.solve(lambda line: [p for p in line.grid if p not in line.new], NEW_BEARING)
        while self.solve(self._between_new, NEW_BEARING):
            pass
        self.solve(self._first_lives, QUICK_LIFE)
        self.solve(self._lives_between, QUICK_LIFE)

    def _between_new(self, line: PreloadLine) -> list[float]:
        """Where new bearings come to meet the requirements, or nearly do."""
        order = [line.new[p] for p in sorted(line.new)]
        least = [one.margins(self.limits).min() for one in order]
        gaps = set()
        for k, (a, b) in enumerate(itertools.pairwise(order)):
            if (least[k] >= 0.0) != (least[k + 1] >= 0.0) and _width(a, b) > _EDGE:
                gaps.add(k)
        for k in range(1, len(order) - 1):
            is_peak = -_NEAR_PEAK < least[k] < 0.0 and least[k] >= max(least[k - 1], least[k + 1])
            for j in (k - 1, k):
                if is_peak and _width(order[j], order[j + 1]) > _PEAK:
                    gaps.add(j)
        return [_between(order[k], order[k + 1]) for k in sorted(gaps)]

    def _first_lives(self, line: PreloadLine) -> list[float]:
        """Every second preload of the grid that new bearings allow; of each range that they allow,
        the ends and the middle.
        """
        wanted = {p for p in line.grid[::2] if line.may_live(p, self.limits)}
        runs = itertools.groupby(sorted(line.new), lambda p: line.may_live(p, self.limits))
        for run in [[*run] for is_allowed, run in runs if is_allowed]:
            wanted |= {run[0], run[-1]}
            if len(run) > 1:
                wanted.add(_between(line.new[run[0]], line.new[run[-1]]))
        return sorted(wanted - set(line.lives))

    def _lives_between(self, line: PreloadLine) -> list[float]:
        """The other preloads of the grid, where the life may be longer than the best one."""
        best, order, wanted = line.best(self.limits), sorted(line.lives), []
        longest = best.life if best else 0.0
        for p in line.grid:
            k = bisect.bisect(order, p)
            beside = [line.lives[near] for near in order[max(k - 1, 0) : k + 1]]
            ends = {one.values.get("end_criterion") for one in beside if one.life > 0.0}
            most = max((one.life for one in beside), default=math.inf) * _BETWEEN
            if len(ends) != 1 or len(beside) < 2 or (most >= longest and not self._far(*beside)):
                wanted.append(p)
        return [p for p in wanted if p not in line.lives and line.may_live(p, self.limits)]

    def _far(self, a: PreloadPoint, b: PreloadPoint) -> bool:
        """Whether both of two lives break the same requirement by far."""
        return bool((np.maximum(a.margins(self.limits), b.margins(self.limits)) < -_FAR).any())

    def _lengthened(self, line: PreloadLine) -> PreloadPoint | None:
        """The best preload of a line if it is at an end of the range, which goes on then."""
        best = line.best(self.limits)
        if best is None or line.beyond or best.preload not in (line.grid[0], line.grid[-1]):
            return None
        sign = 1.0 if best.preload == line.grid[-1] else -1.0
        steps = _STEP_BEYOND ** (sign * np.arange(1, 7) / 6)
        more = [float(f"{best.preload * step:.3g}") for step in steps.tolist()]
        more = [p for p in more if p <= most_preload()]
        line.grid = sorted({*line.grid, *more})
        return best if more else None

    def _shorten(self, line: PreloadLine, end: PreloadPoint) -> None:
        """Leave out preloads beyond an end where the life is hardly longer there."""
        best = line.best(self.limits)
        assert best is not None
        if best is end or best.life >= _LITTLE_LONGER * end.life:
            return
        line.beyond = best
        is_low = best.preload < end.preload
        line.grid = [p for p in line.grid if (p >= end.preload if is_low else p <= end.preload)]
        for known in (line.new, line.lives):
            for p in [p for p in known if not line.grid[0] <= p <= line.grid[-1]]:
                del known[p]

    def _beside_best(self, line: PreloadLine, is_last: bool) -> list[float]:
        """The best preload and some between it and its neighbours, where a life may be longer.

        A neighbour that a quick life refuses by little is solved itself, as is one beside which
        nothing else is solved.
        is_last: whether no more lives are solved between them.
        """
        line.lives = {p: one for p, one in line.lives.items() if self._counts(line, one)}
        best = line.best(self.limits)
        if best is None:
            return []
        wanted = [best.preload] if best.solved != EXACT_LIFE else []
        order = line.in_order(self.limits)
        k = next(k for k, one in enumerate(order) if one.preload == best.preload)
        for beyond in (order[:k][::-1], order[k + 1 :]):
            if not beyond:
                continue
            near, margin = beyond[0], beyond[0].margins(self.limits).min()
            may_gain = not is_last and self._may_gain(best, *beyond[:2])
            if near.solved == QUICK_LIFE and margin < 0.0 and (margin > -_ROUGH or not may_gain):
                wanted.append(near.preload)
            elif may_gain:
                wanted.append(self._towards(best, near))
        return sorted(
            set(wanted) - {p for p, one in line.lives.items() if one.solved == EXACT_LIFE}
        )

    def _may_gain(
        self, best: PreloadPoint, near: PreloadPoint, next_one: PreloadPoint | None = None
    ) -> bool:
        """Whether a life between two preloads may be longer than the best one.

        next_one: the next point on the same side, by which one sees whether the life goes evenly.
        """
        width = abs(_width(best, near))
        if near.solved == NEW_BEARING or not near.is_allowed(self.limits):
            return width > _EDGE
        ends = {one.values.get("end_criterion") for one in (best, near)}
        if len(ends) > 1:
            return width > _EDGE  # towards where both are met, a life may rise by any power
        drop = math.log(best.life / near.life)
        is_near = width < _NEAR
        if is_near and next_one is not None and next_one.values.get("end_criterion") in ends:
            if 0.0 < next_one.life < near.life and next_one.is_allowed(self.limits):
                return 0.5 * (_EVEN * width - drop) > _GAIN
        rise = _STEEPEST * width
        return (rise if drop > rise else 0.5 * (rise - drop)) > _GAIN  # one so steep is a jump

    def _towards(self, best: PreloadPoint, near: PreloadPoint) -> float:
        """A preload between two: just within the requirements that are met between them, else in
        the middle.
        """
        inside, outside = best.margins(self.limits), near.margins(self.limits)
        passed = (outside < 0.0) & (outside > -1.0)
        if not passed.any() or (outside <= -1.0).any():
            return _between(best, near)
        share = float((inside[passed] / (inside[passed] - outside[passed])).min())
        width = _width(best, near)
        share = min(max(share - 0.5 * _EDGE / abs(width), 0.05), 0.95)
        a, b = sorted((best.preload, near.preload))
        return round_number(best.preload * math.exp(share * width), a, b)

    def _counts(self, line: PreloadLine, one: PreloadPoint) -> bool:
        """Whether a life is exact, or has no exact ones on both sides within a step of the grid."""
        if one.solved == EXACT_LIFE:
            return True
        step = SWEPT_FACTORS[1] / SWEPT_FACTORS[0]
        exact = [p for p, other in line.lives.items() if other.solved == EXACT_LIFE]
        below = any(one.preload / step <= p < one.preload for p in exact)
        return not (below and any(one.preload < p <= one.preload * step for p in exact))

    def similar(self, line: PreloadLine) -> list[PreloadPoint]:
        """Points around the best that may be set in its place, and the best; from the lowest."""
        best = line.best(self.limits)
        if best is None:
            return []
        order = line.in_order(self.limits)
        k = next(k for k, one in enumerate(order) if one.preload == best.preload)

        def is_similar(one: PreloadPoint) -> bool:
            enough = one.solved != NEW_BEARING and one.life >= SIMILAR * best.life
            return enough and one.is_allowed(self.limits)

        below = itertools.takewhile(is_similar, order[:k][::-1])
        above = itertools.takewhile(is_similar, order[k + 1 :])
        return [*list(below)[::-1], best, *above]

    def _at_ends(self, line: PreloadLine) -> list[float]:
        """Lives that show between which preloads the best one may be set."""
        similar, order, wanted = self.similar(line), line.in_order(self.limits), []
        for end, step in ((similar[0], -1), (similar[-1], 1)) if similar else ():
            k = next(k for k, one in enumerate(order) if one.preload == end.preload) + step
            if end.solved != EXACT_LIFE:
                wanted.append(end.preload)
            if 0 <= k < len(order) and abs(_width(end, order[k])) > _END_WIDTH:
                wanted.append(_between(end, order[k]))
        return sorted(set(wanted))

    def active_limit(self, line: PreloadLine, best: PreloadPoint) -> int:
        """Index into `ACTIVE`: what keeps the best preload from one with a longer life."""
        order = line.in_order(self.limits)
        k = next(k for k, one in enumerate(order) if one.preload == best.preload)
        beside = [order[n] for n in (k - 1, k + 1) if 0 <= n < len(order)]
        names = [*self.limits.effective, ACTIVE[NOT_PRACTICAL]]
        margins = best.margins(self.limits)
        refused = [
            one
            for one in beside
            if one.values["status"] == OK
            and one.margins(self.limits).min() < 0.0
            and (one.solved == NEW_BEARING or one.life > best.life)
        ]
        if refused:
            by_most = min(
                (one.margins(self.limits) for one in refused), key=lambda found: found.min()
            )
            worst = int(np.argmin(by_most))
            # of several that a neighbour passes, one that is met here
            is_met = margins.min() < _AT_LIMIT <= margins[worst]
            return ACTIVE.index(names[int(np.argmin(margins)) if is_met else worst])
        if any(one.values["status"] != OK for one in beside):
            return NEXT_NOT_SOLVED
        if margins.min() < _AT_LIMIT:
            return ACTIVE.index(names[int(np.argmin(margins))])
        if len(beside) < 2:
            return END_OF_RANGE
        ends = {
            one.values.get("end_criterion") for one in (*beside, best) if one.solved != NEW_BEARING
        }
        return OTHER_END if len(ends) > 1 else UNLIMITED


def _solved_point(job: tuple[Scene, DesignLimits, int]) -> dict[str, Any]:
    scene, limits, solved = job
    if solved == NEW_BEARING:
        return new_point(scene, limits)
    return design_point(scene, limits, quick=solved == QUICK_LIFE)


def _width(a: PreloadPoint, b: PreloadPoint) -> float:
    """Width in log preload from one point to another."""
    return math.log(b.preload / a.preload)


def _between(a: PreloadPoint, b: PreloadPoint) -> float:
    """A round preload in the middle of two [N]."""
    low, high = sorted((a.preload, b.preload))
    return round_number(math.sqrt(low * high), low, high)
