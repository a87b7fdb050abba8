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
from bearingwear.scene.arrangement import with_method
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
    round_number,
    scaled_preload,
)

SWEPT_FACTORS = tuple(2.0 ** (k / 4) for k in range(-12, 21))
"""Preloads of the first lives, over the scene's own: an eighth to 32 times."""

_RANGE_STEP = 8.0
"""Factor by which the range of preloads is extended once, beyond an end with the best life."""

_STEPS_BEYOND_END = 6
"""Number of preloads in the extension of the range."""

_SHARES_BETWEEN = (0.05, 0.95)
"""Least and greatest share of the way between two preloads at which another one is solved."""

_LITTLE_LONGER = 1.1
"""Ratio of the lives beyond an end and at it from which on the preload beyond is chosen."""

_EDGE = 5e-3
"""Width in the logarithm of the preload to which the ends of allowed ranges are found: a life may
change with a power of the preload there."""

_GAIN = 5e-3
"""Relative gain of the life up to which no further life is solved for it."""

_ROUGH = 0.05
"""Relative margin by which a requirement may seem broken by the error of a quick life alone."""

SIMILAR = 0.9
"""Least share of the longest life at which a preload may be set in place of the recommended one."""

_END_WIDTH = 0.06
"""Width in the logarithm of the preload to which the ends of the settable ones are found."""

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
        """Returns the life [s]; zero where it was not solved, or of new bearings alone."""
        life = self.values.get("life", 0.0) if self.values["status"] == OK else 0.0
        return life if life > 0.0 else 0.0

    @property
    def end_criterion(self) -> int | None:
        """Returns the flag of the criterion that ends the life; None for new bearings alone."""
        return self.values.get("end_criterion")

    def margins(self, limits: DesignLimits) -> np.ndarray:
        """Returns the relative margins (n + 1,) of n requirements; negative ones are violated.

        They are in the order of `limits.effective`, each the least of its measure. The last one is
        1 for a practical design, else -1. A margin is -1 where nothing was solved or all values are
        NaN. It is infinite for a measure that new bearings do not have.
        """
        if self.values["status"] != OK:
            return np.full(len(limits.effective) + 1, -1.0)
        margins = []
        for name, limit in limits.effective.items():
            measure = LIMITED[name]
            values = [self.values[key] for key in measure.extremes if key in self.values]
            known_margins = [
                measure.margin(value, limit) for value in values if not math.isnan(value)
            ]
            unknown = math.inf if self.solved == NEW_BEARING and not values else -1.0
            margins.append(min(known_margins, default=unknown))
        margins.append(-1.0 if self.values.get("impractical") else 1.0)
        return np.array(margins)

    def is_allowed(self, limits: DesignLimits) -> bool:
        """Returns whether all requirements are met; of a life, also whether it is above zero."""
        has_life = self.solved == NEW_BEARING or self.life > 0.0
        return has_life and bool(self.margins(limits).min() >= 0.0)


@dataclass
class PreloadLine:
    """What was solved at preloads with one preload method."""

    method: str
    grid: Sequence[float]  # preloads of the first lives [N], rising
    new: dict[float, PreloadPoint] = field(default_factory=dict)  # new bearings, by preload [N]
    lives: dict[float, PreloadPoint] = field(default_factory=dict)  # by preload [N]
    # where the longest life is at an end of the range: the best point beyond it
    best_beyond_end: PreloadPoint | None = None

    def points(self, limits: DesignLimits) -> list[PreloadPoint]:
        """Returns the points with a life, and new bearings that are not allowed, rising in preload.

        At a preload with both, it is the life.
        """
        refused = {p: point for p, point in self.new.items() if not point.is_allowed(limits)}
        return [point for _, point in sorted((refused | self.lives).items())]

    def best(self, limits: DesignLimits) -> PreloadPoint | None:
        """Returns the point with the longest life within the requirements; None without one."""
        allowed = [point for point in self.lives.values() if point.is_allowed(limits)]
        return max(allowed, key=lambda point: point.life, default=None)

    def may_live(self, preload: float, limits: DesignLimits) -> bool:
        """Returns whether a life at a preload [N] may be allowed.

        It cannot be if new bearings were solved there and break a requirement. True where they were
        not tried, or not solved.
        """
        new = self.new.get(preload)
        return new is None or new.values["status"] != OK or new.is_allowed(limits)


AnswersAt = Callable[[Callable[[Any], Any], Sequence[Any]], Iterator[Any]]
"""Evaluates a function at points, in their order: `map` or `Workers.answers_at`."""

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

    The longest life is looked for within all requirements but that on the life itself, so that it
    is known even if it is too short.
    """

    scene: Scene
    limits: DesignLimits
    answers_at: AnswersAt = map
    lines: list[PreloadLine] = field(init=False)
    other_limits: DesignLimits = field(init=False)  # the limits without that on the life

    def __post_init__(self) -> None:
        no_life: dict[str, Any] = {"life_h": None}
        self.other_limits = replace(self.limits, **no_life)
        centre = self.scene.operation.preload_N
        preloads = {scaled_preload(factor, centre) for factor in SWEPT_FACTORS}
        grid = sorted(preload for preload in preloads if preload <= largest_permitted_preload())
        self.lines = [PreloadLine(method, grid) for method in PRELOAD_METHODS]

    def solve(self, choice: PreloadChoice, solved: int, limits: DesignLimits | None = None) -> bool:
        """Solves the chosen preloads of all lines; returns whether any was left to solve.

        New bearings are solved before lives. Where they break a requirement, no life is solved.

        choice: returns the preloads of a line [N].
        solved: NEW_BEARING, QUICK_LIFE or EXACT_LIFE.
        limits: requirements that new bearings must meet; by default those of the search.
        """
        limits = limits or self.limits
        places = [(line, p) for line in self.lines for p in choice(line)]
        if solved != NEW_BEARING:
            self._solve([(line, p) for line, p in places if p not in line.new], NEW_BEARING)
            places = [(line, p) for line, p in places if line.may_live(p, limits)]
        self._solve(places, solved)
        return bool(places)

    def _solve(self, places: Sequence[tuple[PreloadLine, float]], solved: int) -> None:
        """Solves new bearings or lives at preloads [N], and keeps the points in their lines.

        places: each a line, and a preload of it.
        solved: NEW_BEARING, QUICK_LIFE or EXACT_LIFE.
        """
        jobs = [
            _Job(with_method(self.scene, line.method, preload), self.limits, solved)
            for line, preload in places
        ]
        answers = self.answers_at(_solved_values, jobs)
        for (line, preload), values in zip(places, answers, strict=True):
            points = line.new if solved == NEW_BEARING else line.lives
            points[preload] = PreloadPoint(preload, values, solved)

    def run(self) -> None:
        """Finds the best preload of each method, and those that may be set in its place."""
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
        """Returns the preloads [N] of a line whose exact lives are solved next.

        They are those beside the best one or, without any, those at other edges where a life may be
        longer. Without these, too, they show which preloads may be set in place of the best one,
        but only on the line with the longest life.
        """
        preloads = self._preloads_beside_best(line) or self._preloads_at_worn_edges(line)
        if preloads:
            return preloads
        bests = [other.best(self.other_limits) for other in self.lines]
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
        """Returns preloads [N] in the middle of gaps between new bearings, for further ones.

        The requirements are met at only one end of such a gap, or the gap is beside a point that
        breaks them less than its neighbours. Gaps up to the width `_EDGE` are left out.
        """
        points = [line.new[p] for p in sorted(line.new)]
        margins = [point.margins(self.other_limits).min() for point in points]
        is_allowed = [margin >= 0.0 for margin in margins]
        gaps = {k for k in range(len(points) - 1) if is_allowed[k] != is_allowed[k + 1]}
        for k in range(1, len(points) - 1):
            if not is_allowed[k] and margins[k] >= max(margins[k - 1], margins[k + 1]):
                gaps |= {k - 1, k}
        wide_gaps = [k for k in sorted(gaps) if _log_width(points[k], points[k + 1]) > _EDGE]
        return [_middle_preload(points[k], points[k + 1]) for k in wide_gaps]

    def _first_preloads(self, line: PreloadLine) -> list[float]:
        """Returns every second preload [N] of the grid that new bearings allow, for quick lives.

        The ends and the middle of each range that they allow are added. Preloads with a life are
        left out.
        """
        preloads = {p for p in line.grid[::2] if line.may_live(p, self.other_limits)}
        ranges = itertools.groupby(sorted(line.new), lambda p: line.may_live(p, self.other_limits))
        for is_allowed, range_preloads in ranges:
            if is_allowed:
                lowest, *others = range_preloads
                preloads.add(lowest)
                if others:
                    highest = others[-1]
                    middle = _middle_preload(line.new[lowest], line.new[highest])
                    preloads |= {middle, highest}
        return sorted(preloads - set(line.lives))

    def _further_preloads(self, line: PreloadLine) -> list[float]:
        """Returns the other preloads [N] of the grid at which a life may be longer than the best.

        Those between two shorter lives that the same criterion ends are left out.
        """
        best = line.best(self.other_limits)
        longest = best.life if best else 0.0
        solved_preloads = sorted(line.lives)
        preloads = []
        for p in line.grid:
            if p in line.lives or not line.may_live(p, self.other_limits):
                continue
            k = bisect.bisect(solved_preloads, p)
            neighbours = [line.lives[near] for near in solved_preloads[max(k - 1, 0) : k + 1]]
            ends = {point.end_criterion for point in neighbours if point.life > 0.0}
            longest_beside = max((point.life for point in neighbours), default=math.inf)
            if len(ends) != 1 or len(neighbours) < 2 or longest_beside >= longest:
                preloads.append(p)
        return preloads

    def _preloads_at_worn_edges(self, line: PreloadLine) -> list[float]:
        """Returns preloads [N] at the ends of ranges that worn bearings allow.

        They lie between a life that is longer than the best but breaks requirements, and a point
        that meets them. A narrow range between these may be allowed if another criterion soon ends
        the life. Gaps up to the width `_EDGE`, and those beside the best point, are left out.
        """
        best = line.best(self.other_limits)
        longest = best.life if best else 0.0
        preloads = []
        for point, following in itertools.pairwise(line.points(self.other_limits)):
            if _log_width(point, following) <= _EDGE:
                continue
            for broken, met in ((point, following), (following, point)):
                is_longer = broken.solved != NEW_BEARING and broken.life > longest
                is_broken = broken.margins(self.other_limits).min() < 0.0
                is_met = met.margins(self.other_limits).min() >= 0.0
                if is_longer and is_broken and is_met and met is not best:
                    preloads.append(self._preload_between(met, broken))
        return preloads

    def _extend(self, line: PreloadLine) -> PreloadPoint | None:
        """Extends the range of a line once if its best preload is at an end.

        Returns the best point, at that end; None if the grid is as before. The new preloads are not
        solved yet.
        """
        best = line.best(self.other_limits)
        if best is None or line.best_beyond_end:
            return None
        if best.preload not in (line.grid[0], line.grid[-1]):
            return None
        sign = 1.0 if best.preload == line.grid[-1] else -1.0
        steps = np.arange(1, _STEPS_BEYOND_END + 1) / _STEPS_BEYOND_END
        factors = _RANGE_STEP ** (sign * steps)
        preloads = [float(f"{best.preload * factor:.3g}") for factor in factors.tolist()]
        preloads = [p for p in preloads if p <= largest_permitted_preload()]
        line.grid = sorted({*line.grid, *preloads})
        return best if preloads else None

    def _shorten(self, line: PreloadLine, end: PreloadPoint) -> None:
        """Takes back an extension of the range if the life beyond its end is hardly longer.

        Keeps the best point beyond as `best_beyond_end`, and drops all others there. Nothing
        changes if that life is at least `_LITTLE_LONGER` times as long, or not longer at all.

        end: the point at the end of the range before its extension.
        """
        best = line.best(self.other_limits)
        assert best is not None
        if best is end or best.life >= _LITTLE_LONGER * end.life:
            return
        line.best_beyond_end = best
        if best.preload < end.preload:
            line.grid = [p for p in line.grid if p >= end.preload]
        else:
            line.grid = [p for p in line.grid if p <= end.preload]
        lowest, highest = line.grid[0], line.grid[-1]
        line.new = {p: point for p, point in line.new.items() if lowest <= p <= highest}
        line.lives = {p: point for p, point in line.lives.items() if lowest <= p <= highest}

    def _preloads_beside_best(self, line: PreloadLine) -> list[float]:
        """Returns the best preload [N] and those beside it where an exact life may be longer.

        Those with an exact life are left out. A neighbour that a quick life refuses is solved
        itself if it is refused by little, or if no preload between it and the best one is solved.
        Quick lives between exact ones are dropped from the line first.
        """
        line.lives = {p: point for p, point in line.lives.items() if self._is_kept(line, point)}
        best = line.best(self.other_limits)
        if best is None:
            return []
        preloads = {best.preload}
        for near in _neighbours(line.points(self.other_limits), best):
            margin = near.margins(self.other_limits).min()
            may_gain = self._may_gain(best, near)
            is_refused_by_quick_life = near.solved == QUICK_LIFE and margin < 0.0
            if is_refused_by_quick_life and (margin > -_ROUGH or not may_gain):
                preloads.add(near.preload)
            elif may_gain:
                preloads.add(self._preload_between(best, near))
        exact_preloads = {p for p, point in line.lives.items() if point.solved == EXACT_LIFE}
        return sorted(preloads - exact_preloads)

    def _may_gain(self, best: PreloadPoint, near: PreloadPoint) -> bool:
        """Returns whether a life between two preloads may be longer than the best by `_GAIN`.

        If the near preload is not allowed, or another criterion ends its life, the life may rise by
        any power of the preload: then it may gain if both are farther apart than `_EDGE`. Otherwise
        it changes at most in proportion to the preload, and jumps if it falls faster than that from
        the best to the near preload.
        """
        width = abs(_log_width(best, near))
        is_edge = near.solved == NEW_BEARING or not near.is_allowed(self.other_limits)
        if is_edge or best.end_criterion != near.end_criterion:
            return width > _EDGE
        drop = math.log(best.life / near.life)
        # without a jump it rises and then falls in proportion, to a peak where both lines meet
        largest_gain = width if drop > width else 0.5 * (width - drop)
        return largest_gain > _GAIN

    def _preload_between(self, best: PreloadPoint, near: PreloadPoint) -> float:
        """Returns a preload between two [N], just within the requirements that the near one breaks.

        The margins are interpolated. The preload is in the middle if the near point breaks no
        requirement, or if a margin there is -1, of a value that is not known.

        best: a point that meets all requirements.
        """
        inside = best.margins(self.other_limits)
        outside = near.margins(self.other_limits)
        is_broken = (outside < 0.0) & (outside > -1.0)
        if not is_broken.any() or (outside <= -1.0).any():
            return _middle_preload(best, near)
        share = float((inside[is_broken] / (inside[is_broken] - outside[is_broken])).min())
        width = _log_width(best, near)
        least_share, most_share = _SHARES_BETWEEN
        share = min(max(share - 0.5 * _EDGE / abs(width), least_share), most_share)
        low, high = sorted((best.preload, near.preload))
        return round_number(best.preload * math.exp(share * width), low, high)

    def _is_kept(self, line: PreloadLine, point: PreloadPoint) -> bool:
        """Returns whether a line keeps a life: not a quick one between close exact ones.

        Exact lives are close if one on each side is within a step of the first grid.
        """
        if point.solved == EXACT_LIFE:
            return True
        step = SWEPT_FACTORS[1] / SWEPT_FACTORS[0]
        exact_preloads = [p for p, other in line.lives.items() if other.solved == EXACT_LIFE]
        has_below = any(point.preload / step <= p < point.preload for p in exact_preloads)
        has_above = any(point.preload < p <= point.preload * step for p in exact_preloads)
        return not (has_below and has_above)

    def settable_points(self, line: PreloadLine) -> list[PreloadPoint]:
        """Returns the best point and those around it that may be set in its place, rising.

        They are allowed, and their lives are at least `SIMILAR` times the longest. The list is
        empty without a best point.
        """
        best = line.best(self.limits)
        if best is None:
            return []
        points = line.points(self.limits)
        k = _index_at_preload(points, best)

        def is_similar(point: PreloadPoint) -> bool:
            is_long = point.solved != NEW_BEARING and point.life >= SIMILAR * best.life
            return is_long and point.is_allowed(self.limits)

        below = itertools.takewhile(is_similar, points[:k][::-1])
        above = itertools.takewhile(is_similar, points[k + 1 :])
        return [*list(below)[::-1], best, *above]

    def _preloads_at_ends(self, line: PreloadLine) -> list[float]:
        """Returns preloads [N] whose lives show which ones may be set in place of the best one.

        They are the ends of the settable range, unless their lives are exact, and the middle of the
        gap beyond each end if it is wide.
        """
        settable = self.settable_points(line)
        if not settable:
            return []
        points = line.points(self.limits)
        preloads = set()
        for end, step in ((settable[0], -1), (settable[-1], 1)):
            k = _index_at_preload(points, end) + step
            if end.solved != EXACT_LIFE:
                preloads.add(end.preload)
            if 0 <= k < len(points) and abs(_log_width(end, points[k])) > _END_WIDTH:
                preloads.add(_middle_preload(end, points[k]))
        return sorted(preloads)

    def active_limit(self, line: PreloadLine, best: PreloadPoint) -> int:
        """Returns the index into `ACTIVE` of what keeps the best preload from a longer life.

        It is the requirement that a neighbour breaks by most. Otherwise it is a neighbour without
        solution, a requirement that the best preload just meets, the end of the range, another end
        of life, or nothing, in this order.

        best: a point of the line.
        """
        neighbours = _neighbours(line.points(self.other_limits), best)
        names = [*self.other_limits.effective, ACTIVE[NOT_PRACTICAL]]
        margins = best.margins(self.other_limits)
        is_at_limit = margins.min() < _AT_LIMIT
        refused_margins = [
            point.margins(self.other_limits)
            for point in neighbours
            if point.values["status"] == OK
            and point.margins(self.other_limits).min() < 0.0
            and (point.solved == NEW_BEARING or point.life > best.life)
        ]
        if refused_margins:
            most_refused = min(refused_margins, key=np.min)
            worst = int(np.argmin(most_refused))
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
    """Returns the values of new bearings, or of the life, at one preload; see `PreloadPoint`."""
    if job.solved == NEW_BEARING:
        return new_point(job.scene, job.limits)
    return design_point(job.scene, job.limits, quick=job.solved == QUICK_LIFE)


def _index_at_preload(points: Sequence[PreloadPoint], point: PreloadPoint) -> int:
    """Returns the index in a list of the point that has the preload of another."""
    return [other.preload for other in points].index(point.preload)


def _neighbours(points: Sequence[PreloadPoint], point: PreloadPoint) -> list[PreloadPoint]:
    """Returns the points before and after the one that has the preload of another."""
    k = _index_at_preload(points, point)
    return [points[j] for j in (k - 1, k + 1) if 0 <= j < len(points)]


def _log_width(start: PreloadPoint, end: PreloadPoint) -> float:
    """Returns the logarithm of the preload at the end over that at the start."""
    return math.log(end.preload / start.preload)


def _middle_preload(start: PreloadPoint, end: PreloadPoint) -> float:
    """Returns a preload [N] with few digits near the geometric mean of two."""
    low, high = sorted((start.preload, end.preload))
    return round_number(math.sqrt(low * high), low, high)
