"""The preload with the longest life within requirements, by lives at many preloads.

Quick lives over a range show where to look; exact ones beside the best are what is recommended.
Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import bisect
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

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
    largest_permitted_preload,
    round_factor,
    round_number,
)

SWEPT_FACTORS = tuple(2.0 ** (k / 4) for k in range(-12, 21))
"""Preloads of the first lives, over the scene's own: an eighth to 32 times."""

_RANGE_STEP = 8.0
"""Factor by which the range is extended once, beyond an end with the best life."""

_LITTLE_LONGER = 1.1
"""Ratio of the lives beyond an end and at it up to which the preload at the end is taken."""

_EDGE = 5e-3
"""Width in log preload to which the edges of what requirements allow are found: a life may change
with a power of the preload there."""

_GAIN = 5e-3
"""Share of the life for which no further life is solved."""

_ROUGH = 0.05
"""Share of a requirement; broken by less, it may be the error of a quick life."""

SIMILAR = 0.9
"""Least share of the longest life at which a preload may be set in place of the recommended one."""

_END_WIDTH = 0.06
"""Width in log preload to which the ends of these preloads are found."""

_AT_LIMIT = 5e-3
"""Relative margin of a requirement below which it is on its limit."""

NEW_BEARING, QUICK_LIFE, EXACT_LIFE = range(3)
"""What was solved at a preload: new bearings alone, a quick life, or the life that is printed."""


@dataclass(frozen=True)
class PreloadPoint:
    """A preload at which new bearings or a life were solved."""

    preload: float  # [N]
    values: Mapping[str, Any]  # of `design_point` or `new_point`
    solved: int  # NEW_BEARING, QUICK_LIFE or EXACT_LIFE

    @property
    def life(self) -> float:
        """The life [s]; zero where it was not solved."""
        life = self.values.get("life", 0.0) if self.values["status"] == OK else 0.0
        return life if life > 0.0 else 0.0

    @property
    def end_criterion(self) -> int | None:
        """The criterion that ends the life; None where none is known."""
        return self.values.get("end_criterion")

    def margins(self, limits: DesignLimits) -> np.ndarray:
        """Returns relative margins of the requirements, and last 1 if it is practical, else -1.

        A value that is not known breaks its requirement, but one that new bearings do not have.
        """
        if self.values["status"] != OK:
            return np.full(len(limits.effective) + 1, -1.0)
        margins = []
        for name, limit in limits.effective.items():
            measure = LIMITED[name]
            values = [self.values[key] for key in measure.extremes if key in self.values]
            known_margins = [measure.margin(value, limit) for value in values if value == value]
            unknown = math.inf if self.solved == NEW_BEARING and not values else -1.0
            margins.append(min(known_margins, default=unknown))
        margins.append(-1.0 if self.values.get("impractical") else 1.0)
        return np.array(margins)

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
    # where the longest life is at an end of the range: the best point beyond it
    best_beyond_end: PreloadPoint | None = None

    def points(self, limits: DesignLimits) -> list[PreloadPoint]:
        """Returns lives, and new bearings that do not meet the requirements; rising in preload."""
        refused = {p: point for p, point in self.new.items() if not point.is_allowed(limits)}
        return [point for _, point in sorted((refused | self.lives).items())]

    def best(self, limits: DesignLimits) -> PreloadPoint | None:
        """Returns the longest life that was solved within the requirements."""
        allowed = [point for point in self.lives.values() if point.is_allowed(limits)]
        return max(allowed, key=lambda point: point.life, default=None)

    def may_live(self, preload: float, limits: DesignLimits) -> bool:
        """Whether new bearings at a preload do not rule out that it is allowed worn."""
        new = self.new.get(preload)
        return new is None or new.values["status"] != OK or new.is_allowed(limits)


AnswersAt = Callable[[Callable[[Any], Any], Sequence[Any]], Iterator[Any]]
"""Asks a function at points, in their order: `map`, or `answers_at` of processes."""

PreloadChoice = Callable[[PreloadLine], list[float]]
"""Returns the preloads [N] of a line at which something has to be solved."""


class _Job(NamedTuple):
    """What is solved at one preload."""

    scene: Scene
    limits: DesignLimits
    solved: int  # as of `PreloadPoint`


@dataclass
class PreloadSearch:
    """Lives of a scene over preload, by each method.

    The longest life is looked for within all requirements but that on the life itself: so it is
    known, too, where it is too short.
    """

    scene: Scene
    limits: DesignLimits
    answers_at: AnswersAt = map
    lines: list[PreloadLine] = field(init=False)
    but_life: DesignLimits = field(init=False)  # the limits without that on the life

    def __post_init__(self) -> None:
        no_life: dict[str, Any] = {"life_h": None}
        self.but_life = replace(self.limits, **no_life)
        centre = self.scene.operation.preload_N
        preloads = {round_factor(factor, centre) for factor in SWEPT_FACTORS}
        grid = sorted(preload for preload in preloads if preload <= largest_permitted_preload())
        self.lines = [PreloadLine(method, grid) for method in PRELOAD_METHODS]

    def solve(self, choice: PreloadChoice, solved: int, limits: DesignLimits | None = None) -> bool:
        """Solves the chosen preloads of all lines; returns whether there are any.

        New bearings are solved before lives: a preload at which they break a requirement has none.

        solved: NEW_BEARING, QUICK_LIFE or EXACT_LIFE.
        limits: requirements in place of those of the search.
        """
        limits = limits or self.limits
        places = [(line, p) for line in self.lines for p in choice(line)]
        if solved != NEW_BEARING:
            self._solve([(line, p) for line, p in places if p not in line.new], NEW_BEARING)
            places = [(line, p) for line, p in places if line.may_live(p, limits)]
        self._solve(places, solved)
        return bool(places)

    def _solve(self, places: Sequence[tuple[PreloadLine, float]], solved: int) -> None:
        """Solves at preloads of lines, and keeps the points."""
        jobs = [
            _Job(held_by(self.scene, line.method, preload), self.limits, solved)
            for line, preload in places
        ]
        for (line, preload), values in zip(
            places, self.answers_at(_solved_values, jobs), strict=True
        ):
            point = PreloadPoint(preload, values, solved)
            (line.new if solved == NEW_BEARING else line.lives)[preload] = point

    def run(self) -> None:
        """Solves all that shows the best preload of each method, and where it may be set."""
        self.sweep()
        ends = [self._extend(line) for line in self.lines]
        if any(ends):
            self.sweep()
            for line, end in zip(self.lines, ends, strict=True):
                if end is not None:
                    self._shorten(line, end)
        while self.solve(self._exact_preloads, EXACT_LIFE):
            pass

    def _exact_preloads(self, line: PreloadLine) -> list[float]:
        """Returns preloads beside the best one, whose exact lives are solved.

        Without any, those that show where it may be set, of the line with the longest life.
        """
        preloads = self._preloads_beside_best(line)
        if preloads:
            return preloads
        bests = [other.best(self.but_life) for other in self.lines]
        longest = int(np.argmax([best.life if best else 0.0 for best in bests]))
        return self._preloads_at_ends(line) if line is self.lines[longest] else []

    def sweep(self) -> None:
        """Solves new bearings and quick lives over the preloads of each line."""
        self.solve(lambda line: [p for p in line.grid if p not in line.new], NEW_BEARING)
        while self.solve(self._preloads_between_new, NEW_BEARING):
            pass
        self.solve(self._first_preloads, QUICK_LIFE)
        self.solve(self._further_preloads, QUICK_LIFE)
        while self.solve(self._preloads_at_worn_edges, QUICK_LIFE):
            pass

    def _preloads_between_new(self, line: PreloadLine) -> list[float]:
        """Returns preloads near those where new bearings come to meet the requirements.

        They also lie beside those where they come nearest to that.
        """
        points = [line.new[p] for p in sorted(line.new)]
        least = [point.margins(self.but_life).min() for point in points]
        gaps = set()
        for k, (a, b) in enumerate(itertools.pairwise(points)):
            if (least[k] >= 0.0) != (least[k + 1] >= 0.0) and _width(a, b) > _EDGE:
                gaps.add(k)
        for k in range(1, len(points) - 1):
            is_peak = least[k] < 0.0 and least[k] >= max(least[k - 1], least[k + 1])
            for j in (k - 1, k):
                if is_peak and _width(points[j], points[j + 1]) > _EDGE:
                    gaps.add(j)
        return [_middle(points[k], points[k + 1]) for k in sorted(gaps)]

    def _first_preloads(self, line: PreloadLine) -> list[float]:
        """Returns every second preload of the grid that new bearings allow, for quick lives.

        Of each range that they allow, the ends and the middle are among them.
        """
        preloads = {p for p in line.grid[::2] if line.may_live(p, self.but_life)}
        ranges = itertools.groupby(sorted(line.new), lambda p: line.may_live(p, self.but_life))
        for inside in [[*inside] for is_allowed, inside in ranges if is_allowed]:
            preloads |= {inside[0], inside[-1]}
            if len(inside) > 1:
                preloads.add(_middle(line.new[inside[0]], line.new[inside[-1]]))
        return sorted(preloads - set(line.lives))

    def _further_preloads(self, line: PreloadLine) -> list[float]:
        """Returns the other preloads of the grid at which a life may be longer than the best."""
        best, order, preloads = line.best(self.but_life), sorted(line.lives), []
        longest = best.life if best else 0.0
        for p in line.grid:
            if p in line.lives or not line.may_live(p, self.but_life):
                continue
            k = bisect.bisect(order, p)
            neighbours = [line.lives[near] for near in order[max(k - 1, 0) : k + 1]]
            ends = {point.end_criterion for point in neighbours if point.life > 0.0}
            most = max((point.life for point in neighbours), default=math.inf)
            if len(ends) != 1 or len(neighbours) < 2 or most >= longest:
                preloads.append(p)
        return preloads

    def _preloads_at_worn_edges(self, line: PreloadLine) -> list[float]:
        """Returns preloads where worn bearings come to meet the requirements, for quick lives.

        They lie between a life that is longer than the best but breaks requirements, and one that
        meets them: a narrow range between may be allowed, if another criterion soon ends the life.
        """
        best, points, preloads = line.best(self.but_life), line.points(self.but_life), []
        longest = best.life if best else 0.0
        for pair in itertools.pairwise(points):
            for broken, met in (pair, pair[::-1]):
                is_longer = broken.solved != NEW_BEARING and broken.life > longest
                is_edge = (
                    broken.margins(self.but_life).min() < 0.0 <= met.margins(self.but_life).min()
                )
                if is_longer and is_edge and met is not best and abs(_width(*pair)) > _EDGE:
                    preloads.append(self._preload_between(met, broken))
        return preloads

    def _extend(self, line: PreloadLine) -> PreloadPoint | None:
        """Extends the range of a line if its best preload is at an end, and returns that point."""
        best = line.best(self.but_life)
        if (
            best is None
            or line.best_beyond_end
            or best.preload not in (line.grid[0], line.grid[-1])
        ):
            return None
        sign = 1.0 if best.preload == line.grid[-1] else -1.0
        factors = _RANGE_STEP ** (sign * np.arange(1, 7) / 6)
        more = [float(f"{best.preload * factor:.3g}") for factor in factors.tolist()]
        more = [p for p in more if p <= largest_permitted_preload()]
        line.grid = sorted({*line.grid, *more})
        return best if more else None

    def _shorten(self, line: PreloadLine, end: PreloadPoint) -> None:
        """Leaves out preloads beyond an end of the range if the life is hardly longer there."""
        best = line.best(self.but_life)
        assert best is not None
        if best is end or best.life >= _LITTLE_LONGER * end.life:
            return
        line.best_beyond_end = best
        is_low = best.preload < end.preload
        line.grid = [p for p in line.grid if (p >= end.preload if is_low else p <= end.preload)]
        for points in (line.new, line.lives):
            for p in [p for p in points if not line.grid[0] <= p <= line.grid[-1]]:
                del points[p]

    def _preloads_beside_best(self, line: PreloadLine) -> list[float]:
        """Returns the best preload, and those beside it where an exact life may be longer.

        A neighbour that a quick life refuses by little is solved itself, as is one beside which
        nothing else is solved.
        """
        line.lives = {p: point for p, point in line.lives.items() if self._counts(line, point)}
        best = line.best(self.but_life)
        if best is None:
            return []
        preloads = {best.preload}
        points = line.points(self.but_life)
        k = _index(points, best)
        for near in (*points[max(k - 1, 0) : k], *points[k + 1 : k + 2]):
            margin, may_gain = near.margins(self.but_life).min(), self._may_gain(best, near)
            if near.solved == QUICK_LIFE and margin < 0.0 and (margin > -_ROUGH or not may_gain):
                preloads.add(near.preload)
            elif may_gain:
                preloads.add(self._preload_between(best, near))
        return sorted(
            preloads - {p for p, point in line.lives.items() if point.solved == EXACT_LIFE}
        )

    def _may_gain(self, best: PreloadPoint, near: PreloadPoint) -> bool:
        """Whether a life between two preloads may be longer than the best one.

        Towards an edge, a life may rise by any power of the preload; else at most in proportion.
        """
        width = abs(_width(best, near))
        is_edge = near.solved == NEW_BEARING or not near.is_allowed(self.but_life)
        if is_edge or best.end_criterion != near.end_criterion:
            return width > _EDGE
        drop = math.log(best.life / near.life)
        return (width if drop > width else 0.5 * (width - drop)) > _GAIN  # so steep is a jump

    def _preload_between(self, best: PreloadPoint, near: PreloadPoint) -> float:
        """Returns a preload between two [N]: just within the requirements that near breaks.

        It is in the middle if near breaks none, or one by more than can be interpolated.
        """
        inside, outside = best.margins(self.but_life), near.margins(self.but_life)
        broken = (outside < 0.0) & (outside > -1.0)
        if not broken.any() or (outside <= -1.0).any():
            return _middle(best, near)
        share = float((inside[broken] / (inside[broken] - outside[broken])).min())
        width = _width(best, near)
        share = min(max(share - 0.5 * _EDGE / abs(width), 0.05), 0.95)
        low, high = sorted((best.preload, near.preload))
        return round_number(best.preload * math.exp(share * width), low, high)

    def _counts(self, line: PreloadLine, point: PreloadPoint) -> bool:
        """Whether a life is exact, or has no exact ones on both sides within a step of the grid."""
        if point.solved == EXACT_LIFE:
            return True
        step = SWEPT_FACTORS[1] / SWEPT_FACTORS[0]
        exact = [p for p, other in line.lives.items() if other.solved == EXACT_LIFE]
        is_below = any(point.preload / step <= p < point.preload for p in exact)
        return not (is_below and any(point.preload < p <= point.preload * step for p in exact))

    def settable_points(self, line: PreloadLine) -> list[PreloadPoint]:
        """Returns the best point and those around it that may be set in its place, rising."""
        best = line.best(self.limits)
        if best is None:
            return []
        points = line.points(self.limits)
        k = _index(points, best)

        def is_similar(point: PreloadPoint) -> bool:
            is_long = point.solved != NEW_BEARING and point.life >= SIMILAR * best.life
            return is_long and point.is_allowed(self.limits)

        below = itertools.takewhile(is_similar, points[:k][::-1])
        above = itertools.takewhile(is_similar, points[k + 1 :])
        return [*list(below)[::-1], best, *above]

    def _preloads_at_ends(self, line: PreloadLine) -> list[float]:
        """Returns preloads whose lives show between which ones the best one may be set."""
        settable, points, preloads = self.settable_points(line), line.points(self.limits), set()
        for end, step in ((settable[0], -1), (settable[-1], 1)) if settable else ():
            k = _index(points, end) + step
            if end.solved != EXACT_LIFE:
                preloads.add(end.preload)
            if 0 <= k < len(points) and abs(_width(end, points[k])) > _END_WIDTH:
                preloads.add(_middle(end, points[k]))
        return sorted(preloads)

    def active_limit(self, line: PreloadLine, best: PreloadPoint) -> int:
        """Returns the index into `ACTIVE` of what keeps the best preload from a longer life."""
        points = line.points(self.but_life)
        k = _index(points, best)
        neighbours = [points[j] for j in (k - 1, k + 1) if 0 <= j < len(points)]
        names = [*self.but_life.effective, ACTIVE[NOT_PRACTICAL]]
        margins = best.margins(self.but_life)
        is_at_limit = margins.min() < _AT_LIMIT
        refused = [
            point.margins(self.but_life)
            for point in neighbours
            if point.values["status"] == OK
            and point.margins(self.but_life).min() < 0.0
            and (point.solved == NEW_BEARING or point.life > best.life)
        ]
        if refused:
            worst = int(np.argmin(min(refused, key=np.min)))
            if is_at_limit and margins[worst] >= _AT_LIMIT:
                worst = int(np.argmin(margins))  # the one that is on its limit here
            return ACTIVE.index(names[worst])
        if any(point.values["status"] != OK for point in neighbours):
            return NEXT_NOT_SOLVED
        if is_at_limit:
            return ACTIVE.index(names[int(np.argmin(margins))])
        if len(neighbours) < 2:
            return END_OF_RANGE
        lives = [point for point in (*neighbours, best) if point.solved != NEW_BEARING]
        return OTHER_END if len({point.end_criterion for point in lives}) > 1 else UNLIMITED


def _solved_values(job: _Job) -> dict[str, Any]:
    """Returns the values of the point at one preload."""
    if job.solved == NEW_BEARING:
        return new_point(job.scene, job.limits)
    return design_point(job.scene, job.limits, quick=job.solved == QUICK_LIFE)


def _index(points: Sequence[PreloadPoint], point: PreloadPoint) -> int:
    """Returns the index of the point at the preload of another."""
    return next(k for k, other in enumerate(points) if other.preload == point.preload)


def _width(a: PreloadPoint, b: PreloadPoint) -> float:
    """Returns the width in log preload from one point to another."""
    return math.log(b.preload / a.preload)


def _middle(a: PreloadPoint, b: PreloadPoint) -> float:
    """Returns a round preload in the middle of two [N]."""
    low, high = sorted((a.preload, b.preload))
    return round_number(math.sqrt(low * high), low, high)
