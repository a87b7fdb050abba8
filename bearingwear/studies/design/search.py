"""The preload with the longest life within limits, found by lives at printed preloads.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass
from typing import Any

from bearingwear.studies.design.map import HERTZIAN_GROOVE
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.design.preload_line import PreloadLine, Tried, round_number

GAIN = 1.004  # of the life, for which no other preload is looked for
GUIDED_GAIN = 1.02  # the same while lives are quick
GUIDED = 0.03  # width in log preload to which quick lives are a guide
NARROWEST = 2e-4  # width in log preload below which nothing is looked for
NO_POCKET = 5e-3  # the same where no preload is within the limits
BESIDE = 1.05
"""How much more or less preload shows whether there is a cliff."""

WINDOW = 1.07  # around the best preload, in which no quick life counts
FALL = 0.9
"""A life that falls to less than this share of the longest stands below a cliff."""

COST = 0.995  # share of the longest life that is kept to stand farther from a cliff
CLIFF_FOUND = 0.005  # width in log preload to which a cliff is found
SIMILAR = 0.9
"""Least share of the longest life at which a preload may be set in place of the recommended one."""

END_FOUND = 0.1
"""Width in log preload to which the ends of these preloads are found."""

_MOST = 80  # exact lives of one search

Request = tuple[PreloadLine, float, bool]
"""A line, a preload [N], and whether its life is exact."""

Asking = Generator[list[Request], None, Any]
"""What asks for lives, goes on when their lines have them, and returns what it has found."""


@dataclass(frozen=True)
class Found:
    """The best preload of a line within limits."""

    best: Tried
    # the nearest preload whose life is shorter by more than a tenth, if that is within `BESIDE`
    cliff: Tried | None = None
    # the preload within the limits that keeps so far away from it; the best itself where that costs
    # next to nothing
    clear: Tried | None = None
    # where the best is at an end of the range: one far beyond it, whose life is hardly longer
    beyond: Tried | None = None


def lives_needed(line: PreloadLine, limits: DesignLimits) -> Asking:
    """Solve quick lives at the preloads of the map that some limits need."""
    if missing := line.uncovered(limits):
        yield [(line, preload, False) for preload in missing]


def guide(
    line: PreloadLine, limits: DesignLimits, gain: float = GAIN, least: float = 0.0
) -> Asking:
    """Solve quick lives until no other preload within the limits seems better by a factor, or
    better than a life [s].
    """
    while True:
        one = line.doubtful(limits, max(gain * line.longest(limits), least), GUIDED)
        if one is None:
            return
        yield [(line, one.split(), False)]


def search(line: PreloadLine, limits: DesignLimits) -> Asking:
    """Ask for the lives that show the best preload within the limits; returns `Found` or None."""
    yield from lives_needed(line, limits)
    yield from guide(line, limits, GUIDED_GAIN)
    while True:
        best = yield from _longest(line, limits)
        if best is None:
            return None
        found = yield from _off_the_cliff(line, best, limits)
        # the lives beside a cliff may be longer than all before
        if line.longest(limits) <= GAIN * best.life:
            return found


def _longest(line: PreloadLine, limits: DesignLimits) -> Asking:
    """Ask for exact lives until no other preload seems better; returns the best one or None."""
    for _ in range(_MOST):
        best = line.best(limits, GAIN)
        if best is not None and (missing := _window(line, best.preload)):
            yield missing
            line.leave_out_quick(*_ends(line, best.preload))
            continue
        narrowest = NO_POCKET if best is None else NARROWEST
        one = line.doubtful(limits, GAIN * line.longest(limits), narrowest)
        if one is None:
            break
        yield [(line, one.split(), True)]
    return line.best(limits, GAIN)


def _ends(line: PreloadLine, preload: float) -> tuple[float, float]:
    """Preloads around one, between which no quick life counts [N]."""
    known = sorted(line.tried)
    low, high = (
        round_number(preload * f, *sorted((preload, preload * f * f))) for f in (1 / WINDOW, WINDOW)
    )
    return max(low, known[0]), min(high, known[-1])


def _window(line: PreloadLine, preload: float) -> list[Request]:
    """Exact lives that are missing at a preload and on both sides of it."""
    low, high = _ends(line, preload)
    missing = [] if line.is_exact(preload) else [preload]
    for end, side in ((low, -1.0), (high, 1.0)):
        exact = [p for p, t in line.tried.items() if t.exact and side * (p - preload) > 0.0]
        far = [p for p in exact if BESIDE <= (p / preload) ** side <= WINDOW**2]
        if not far and not line.is_exact(end):
            missing.append(end)
    return [(line, p, True) for p in missing]


def _off_the_cliff(line: PreloadLine, best: Tried, limits: DesignLimits) -> Asking:
    """Keep away from a cliff as far as that costs next to nothing of the life."""
    sides = []
    for side in (-1.0, 1.0):
        sides.append((yield from _cliff(line, best, side)))
    cliffs = [cliff for cliff in sides if cliff is not None]
    if not cliffs:
        return Found(best)
    cliff = min(cliffs, key=lambda t: abs(math.log(t.preload / best.preload)))
    away = math.copysign(1.0, best.preload - cliff.preload)
    target = cliff.preload * BESIDE**away
    target = round_number(target, *sorted((target, target * BESIDE**away)))
    yield [(line, target, True)]
    clear = line.tried[target]
    if not clear.is_allowed(limits):
        return Found(best, cliff)
    if clear.life >= COST * best.life:
        return Found(clear, None, clear)
    part = 0.9 * math.log(COST) / math.log(clear.life / best.life)
    nearer = best.preload * (target / best.preload) ** part
    nearer = round_number(nearer, *sorted((best.preload, target)))
    yield [(line, nearer, True)]
    moved = line.tried[nearer]
    is_as_good = moved.is_allowed(limits) and moved.life >= COST * best.life
    return Found(moved if is_as_good else best, cliff, clear)


def _cliff(line: PreloadLine, best: Tried, side: float) -> Asking:
    """The nearest preload on one side within `BESIDE` whose life is much shorter, or None."""
    while True:
        neighbours = [
            t for t in line.in_order if t.exact and side * (t.preload - best.preload) > 0.0
        ][:: int(side)]
        low = next((t for t in neighbours if t.life < FALL * best.life), None)
        if low is None:
            return None
        last = [best, *neighbours[: neighbours.index(low)]][-1]
        if abs(math.log(last.preload / best.preload)) >= math.log(BESIDE):
            return None
        ends = sorted((last.preload, low.preload))
        width = math.log(ends[1] / ends[0])
        if width < CLIFF_FOUND:
            near = abs(math.log(low.preload / best.preload)) <= math.log(BESIDE)
            return low if near else None
        yield [(line, round_number(math.sqrt(ends[0] * ends[1]), *ends), True)]


def settable(line: PreloadLine, best: Tried, limits: DesignLimits) -> Asking:
    """Ask for the lives that show how far the preload may be off; returns the least and the most.

    At both ends the limits hold and the life, as it is printed, is at least `SIMILAR` of that of
    the best preload, which belongs to the range.
    """
    ends = []
    for side in (-1.0, 1.0):
        while True:
            near = [t for t in line.in_order if side * (t.preload - best.preload) > 0.0]
            near = near[:: int(side)]
            good = list(itertools.takewhile(lambda t: _is_similar(t, best, limits), near))
            end = good[-1] if good else best
            bad = near[len(good)] if len(near) > len(good) else None
            if bad is not None and abs(math.log(bad.preload / end.preload)) > END_FOUND:
                middle = math.sqrt(end.preload * bad.preload)
                yield [(line, round_number(middle, *sorted((end.preload, bad.preload))), False)]
            elif end.exact:
                break
            else:
                yield [(line, end.preload, True)]
        ends.append(end.preload)
    return tuple(ends)


def _is_similar(one: Tried, best: Tried, limits: DesignLimits) -> bool:
    return one.is_allowed(limits) and one.life >= SIMILAR * best.life


def answered(
    asking: Sequence[Asking],
    solve: Callable[[Sequence[Request]], Sequence[dict[str, Any]]],
) -> list[Any]:
    """Results of several searches, whose lives are solved together.

    They go on in turns, each with the lives it asked for, so that the result does not depend on
    how many processes solve them.

    solve: of requests, what `followed_point` finds for each.
    """
    found: dict[int, Any] = {}
    wanted: dict[int, list[Request]] = {}

    def go_on(k: int) -> None:
        try:
            wanted[k] = next(asking[k])
        except StopIteration as ended:
            found[k] = ended.value
            wanted.pop(k, None)

    for k in range(len(asking)):
        go_on(k)
    while wanted:
        asked = {(id(one[0]), *one[1:]): one for each in wanted.values() for one in each}
        requests = [
            (line, preload, exact)
            for line, preload, exact in asked.values()
            if preload not in line.tried or line.tried[preload].exact < exact
        ]
        for (line, preload, exact), values in zip(requests, solve(requests), strict=True):
            line.add(preload, values, exact or values.get("groove") == HERTZIAN_GROOVE)
        for k in list(wanted):
            go_on(k)
    return [found[k] for k in range(len(asking))]
