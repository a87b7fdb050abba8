"""Lives of one method over preload: those that were solved, and what may lie between them.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from bearingwear.kernels.status import OK
from bearingwear.measures import LIMITED
from bearingwear.studies.design.choice import limit_margins
from bearingwear.studies.design.plan import DesignLimits

DIGITS = 3  # of a preload, at least
STEEPEST_LIFE = 1.5
"""How fast a life rises between two preloads at most, as a power, other than at a jump or beside
one."""

_SLACK = 0.4  # by which a slope inside an interval may differ from those outside of it
_WIDE = 0.45  # width in log preload of an interval that needs most of that
_SAFETY = 2.0  # widths to where a limit is met, as interpolated
_WITHIN = 1e-3  # in log preload: how far within a limit to look
_BEND = 0.25  # of how much wear takes of a limit: how far that may bend between two preloads
_LEAST = -0.99  # of a margin, as nothing is a logarithm of minus infinity
_NEAR_LIMIT = 0.5  # of a limit: how far a peak of margins may be for a limit to be met beside it
_NARROW = 0.01  # of gaps between new bearings, in log preload
_BESIDE = 0.3  # in log preload, as far as quick lives are corrected by an exact one
_SAME = 1e-9


@dataclass(frozen=True)
class Tried:
    """A preload whose life was solved."""

    preload: float  # [N]
    values: Mapping[str, Any]  # as of `followed_point`
    life: float  # [s]; zero where it was not solved
    exact: bool  # whether it is the life that is printed, not a quick one

    @property
    def solved(self) -> bool:
        return bool(self.values["status"] == OK)

    def margins(self, limits: DesignLimits) -> np.ndarray:
        """How far each limit is, as `_room`; last whether a bearing would be built so (1 or -1)."""
        return _margins([self], limits)[:, 0]

    def is_allowed(self, limits: DesignLimits) -> bool:
        return self.life > 0.0 and bool(np.all(self.margins(limits) >= 0.0))


class Guess(NamedTuple):
    """Known lives at preloads: those tried, and bounds between them from new bearings."""

    x: np.ndarray  # (n,) logarithm of the preload [N]
    life: np.ndarray  # (n,) [s]; zero where it is not known
    room: np.ndarray  # (limits + 1, n) how far the limits are, as `_room`
    spread: np.ndarray  # (limits + 1, n) by how much that may be more between two preloads
    at: Mapping[float, int]  # places by the preloads tried


class Neighbours(NamedTuple):
    """Two neighbouring preloads and those outside of them, where there are some."""

    before: Tried | None
    a: Tried
    b: Tried
    after: Tried | None
    guess: Guess

    @property
    def width(self) -> float:
        return math.log(self.b.preload / self.a.preload)

    @property
    def _places(self) -> slice:
        return slice(self.guess.at[self.a.preload], self.guess.at[self.b.preload] + 1)

    @property
    def _least_room(self) -> np.ndarray:
        """How far the nearest limit is, from one end to the other."""
        return self.guess.room[:, self._places].min(axis=0)

    def longest(self) -> float:
        """No life [s] within the limits between the two is taken to be longer than this."""
        lives, width = (self.a.life, self.b.life), self.width
        may_be = (self.guess.room + self.guess.spread)[:, self._places].min(axis=0) >= 0.0
        if not (max(lives) > 0.0 and may_be.any()):
            return 0.0
        if self.jumps:
            return max(lives) * math.exp(STEEPEST_LIFE * width)
        slack = _SLACK * min(1.0, 0.25 + width / _WIDE)
        step = math.log(lives[1] / lives[0])
        # beyond the ends of the map the trend between these two continues
        before = (self.before, self.a) if self.before else (self.a, self.b)
        after = (self.b, self.after) if self.after else (self.a, self.b)
        rise, fall = _rise(_slope(*before), slack), -_rise(-_slope(*after), slack)
        if (met := self.limit_met()) is not None:
            end, share, is_all = met
            if is_all and (rise if end is self.a else -fall) <= STEEPEST_LIFE:
                growth = max(step if end is self.a else -step, 0.0) + slack * width
                return end.life * math.exp(growth * min(1.0, _SAFETY * share))
        if rise * width <= step or -fall * width <= -step:
            return max(lives)
        crossing = (step - fall * width) / (rise - fall)  # of both lines
        most = max(lives) * math.exp(STEEPEST_LIFE * width)
        return min(lives[0] * math.exp(rise * crossing), most)

    @property
    def jumps(self) -> bool:
        """Whether the life changes more than it does anywhere but at a jump."""
        lives = self.a.life, self.b.life
        if not min(lives) > 0.0:
            return True
        return abs(math.log(lives[1] / lives[0])) > STEEPEST_LIFE * self.width

    def limit_met(self) -> tuple[Tried, float, bool] | None:
        """If one end is within the limits: that end, over which share of the width they are still
        kept, and whether they are kept nowhere else between.
        """
        room, x = self._least_room, self.guess.x[self._places]
        kept = room >= 0.0
        if kept[0] == kept[-1]:
            return None
        if not kept[0]:
            room, x, kept = room[::-1], x[::-1], kept[::-1]
        k = int(np.argmin(kept))
        met = x[k - 1] + (x[k] - x[k - 1]) * room[k - 1] / (room[k - 1] - room[k])
        share = abs(met - x[0]) / self.width
        end = self.a if self._least_room[0] >= 0.0 else self.b
        return end, float(share), not kept[k:].any()

    def split(self) -> float:
        """The preload to solve next: where a limit is met, or in the middle [N]."""
        low, high = math.log(self.a.preload), math.log(self.b.preload)
        middle = 0.5 * (low + high)
        met = self.limit_met()
        built, other = (not one.values.get("impractical") for one in (self.a, self.b))
        if met is not None and not self.jumps and built == other:
            end, share, _ = met
            share = min(max(share - _WITHIN / self.width, 0.02), 0.98)
            middle = low + share * (high - low) if end is self.a else high - share * (high - low)
        elif met is None and len(room := self._least_room) > 2 and max(room[0], room[-1]) < 0.0:
            middle = self.guess.x[self._places][1 + int(np.argmax(room[1:-1]))]
        return round_number(math.exp(middle), self.a.preload, self.b.preload)


def _slope(a: Tried, b: Tried) -> float:
    """Of the life over preload, both as logarithms; a life of zero is as short as can be."""
    lives = (max(one.life, sys.float_info.min) for one in (a, b))
    first, second = map(math.log, lives)
    return (second - first) / math.log(b.preload / a.preload)


def _rise(slope: float, slack: float) -> float:
    """How fast a life goes on to rise at most behind an interval in which it rose by a slope.

    Where it rose faster than anywhere but at a jump, the jump may not be over: it may be a rise
    that lasts until another criterion ends the life. Nothing is known of it behind a fall so fast.
    """
    if slope <= -STEEPEST_LIFE:
        return STEEPEST_LIFE
    return max(min(slope + slack, STEEPEST_LIFE), slope)


def _room(values: Mapping[str, Any], limits: DesignLimits) -> np.ndarray:
    """Logarithms of limits over values, or of values over limits that are least ones (limits, ...).

    What goes as a power of the preload is straight in them; they are positive within the limits.
    """
    margins = limit_margins(values, limits)
    found = []
    for name, margin in zip(limits.held, np.array(margins, dtype=float), strict=True):
        sign = 1.0 if LIMITED[name].falls else -1.0
        found.append(sign * np.log1p(np.maximum(sign * margin, _LEAST)))
    return np.array(found)


def _margins(tried: Sequence[Tried], limits: DesignLimits) -> np.ndarray:
    """`Tried.margins` of each (limits + 1, n); -1 where its life was not solved."""
    extremes = {extreme for limit in limits.held for extreme in LIMITED[limit].extremes}
    values = {name: np.array([t.values.get(name, math.nan) for t in tried]) for name in extremes}
    practical = [-1.0 if t.values.get("impractical") else 1.0 for t in tried]
    found = np.array([*_room(values, limits), practical])
    found[:, [not t.solved for t in tried]] = -1.0
    return np.nan_to_num(found, nan=-1.0)  # what is not known is not within a limit


def round_number(target: float, low: float, high: float) -> float:
    """The number nearest to a target with the fewest digits, between two others."""
    for decimals in range(DIGITS - 1 - math.floor(math.log10(target)), 12):
        unit = 10.0**-decimals
        near = [round(target + k * unit, decimals) for k in (0, -1, 1)]
        inside = [p for p in near if low * (1.0 + _SAME) < p < high * (1.0 - _SAME)]
        if inside:
            return min(inside, key=lambda p: abs(p - target))
    return target


def _corrected(x: np.ndarray, rows: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """Values (rows, n) at places (n,), of quick lives corrected by what exact ones beside differ
    by.
    """
    found = rows.copy()
    for row, values in zip(found, rows, strict=True):
        quick, sure = (np.isfinite(values) & each for each in (~exact, exact))
        if quick.any() and sure.any():
            differ = values[sure] - np.interp(x[sure], x[quick], values[quick])
            nearest = np.abs(x[quick, None] - x[sure]).min(axis=1)
            fades = np.clip(1.0 - nearest / _BESIDE, 0.0, 1.0)
            row[quick] += fades * np.interp(x[quick], x[sure], differ)
    return found


def denser(preloads: Sequence[float], margins: Sequence[np.ndarray]) -> list[float]:
    """Middles of the gaps, until these are narrow, beside preloads [N] that come nearer to the
    limits than others on both sides, or are just within them.
    """
    x, least = np.log(preloads), np.min(margins, axis=0)
    peaks = [
        k
        for k in range(1, len(x) - 1)
        if abs(least[k]) < _NEAR_LIMIT and least[k] >= max(least[k - 1], least[k + 1])
    ]
    gaps = sorted({j for k in peaks for j in (k - 1, k) if x[j + 1] - x[j] > _NARROW})
    return [math.exp(0.5 * (x[j] + x[j + 1])) for j in gaps]


@dataclass
class PreloadLine:
    """Lives of one method over preload."""

    method: str
    # what `new_point` finds at many preloads, as arrays, and these as `preload` [N]: it shows where
    # limits are met between the preloads tried
    new: Mapping[str, np.ndarray] | None = None
    tried: dict[float, Tried] = field(default_factory=dict)  # by preload [N]
    # preloads of the map, whose lives are solved where limits need them [N]
    ahead: Sequence[float] = ()
    _guesses: dict[DesignLimits, Guess] = field(default_factory=dict)

    def add(self, preload: float, values: Mapping[str, Any], exact: bool) -> None:
        solved = values["status"] == OK
        life = float(values["life"]) if solved else 0.0
        life = life if life > 0.0 else 0.0
        self.tried[preload] = Tried(preload, values, life, exact)
        self._guesses.clear()

    def uncovered(self, limits: DesignLimits) -> list[float]:
        """Preloads of the map not tried, between those that new bearings allow, and one beyond."""
        if self.new is None:
            return []
        least, preloads = np.min(_room(self.new, limits), axis=0), self.new["preload"]
        allowed = np.flatnonzero((least >= 0.0) | (self.new["status"] != OK))
        if not allowed.size:
            return []
        low, high = preloads[max(allowed[0] - 1, 0)], preloads[min(allowed[-1] + 1, least.size - 1)]
        first, last = np.searchsorted(self.ahead, [low, high])
        return [p for p in self.ahead[max(first - 1, 0) : last + 1] if p not in self.tried]

    def is_exact(self, preload: float) -> bool:
        return preload in self.tried and self.tried[preload].exact

    def leave_out_quick(self, low: float, high: float) -> None:
        """Forget quick lives between two exact ones, which see limits and jumps less sharply."""
        inner = [p for p, t in self.tried.items() if low < p < high and not t.exact]
        for preload in inner:
            del self.tried[preload]
        self._guesses.clear()

    def lengthen(self, ahead: Sequence[float], new: Mapping[str, np.ndarray] | None) -> None:
        """Preloads [N] and new bearings of a wider map."""
        self.ahead, self.new = ahead, new
        self._guesses.clear()

    def leave_out(self, preload: float) -> Tried:
        """Forget the life at a preload [N]; returns it."""
        self._guesses.clear()
        return self.tried.pop(preload)

    @property
    def in_order(self) -> list[Tried]:
        return [self.tried[preload] for preload in sorted(self.tried)]

    def intervals(self, limits: DesignLimits) -> Iterator[Neighbours]:
        if not self.tried:
            return
        known, guess = [None, *self.in_order, None], self.guess(limits)
        for k in range(1, len(known) - 2):
            yield Neighbours(*known[k - 1 : k + 3], guess)  # type: ignore[arg-type,call-arg]

    def best(self, limits: DesignLimits, gain: float) -> Tried | None:
        """The longest life within the limits; a quick one if it is so much longer."""
        allowed = [t for t in self.in_order if t.is_allowed(limits)]
        exact = max((t for t in allowed if t.exact), key=lambda t: t.life, default=None)
        quick = max((t for t in allowed if not t.exact), key=lambda t: t.life, default=None)
        if exact is None or quick is None:
            return exact or quick
        return quick if quick.life > gain * exact.life else exact

    def doubtful(self, limits: DesignLimits, enough: float, narrowest: float) -> Neighbours | None:
        """Interval that may contain a longer permitted life, and its bound [s]."""
        wide = ((one.longest(), one) for one in self.intervals(limits) if one.width > narrowest)
        longest, one = max(wide, key=lambda pair: pair[0], default=(0.0, None))
        return one if longest > enough else None

    def longest(self, limits: DesignLimits) -> float:
        """The longest life within the limits that was solved [s]."""
        return max((t.life for t in self.in_order if t.is_allowed(limits)), default=0.0)

    def interpolated_best(self, limits: DesignLimits) -> tuple[float, float]:
        """Longest life within the limits [s] and its preload [N], as guessed between those tried;
        zero where there is none.
        """
        if not self.tried:
            return 0.0, math.nan
        x, lives, kept, *_ = self.guess(limits)
        alive = (lives[:-1] > 0.0) & (lives[1:] > 0.0)
        start, step = kept[:, :-1], np.diff(kept, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            root = -start / step
            low = np.max(np.where(step > 0.0, root, 0.0), axis=0, initial=0.0)
            high = np.min(np.where(step < 0.0, root, 1.0), axis=0, initial=1.0)
            never = np.any((step == 0.0) & (start < 0.0), axis=0)
            k = np.flatnonzero(alive & ~never & (low <= high))
            shares, y = np.array([low, high])[:, k], np.log(lives)
        alone = np.flatnonzero((lives > 0.0) & np.all(kept >= 0.0, axis=0))
        log_preloads = np.concatenate([x[alone], *(x[k] + shares * (x[k + 1] - x[k]))])
        found = np.concatenate([y[alone], *(y[k] + shares * (y[k + 1] - y[k]))])
        if not found.size:
            return 0.0, math.nan
        best = int(np.argmax(found))
        return math.exp(found[best]), math.exp(log_preloads[best])

    def guess(self, limits: DesignLimits) -> Guess:
        """Lives and how far the limits are: as new, less what wear takes at the preloads tried.

        Between these, that is linear, as is the logarithm of the life.
        """
        if limits not in self._guesses:
            known = self.in_order
            tried = np.log([t.preload for t in known])
            margins = _margins(known, limits)
            every = tried if self.new is None else np.log(self.new["preload"])
            every = every[(every >= tried[0]) & (every <= tried[-1])]
            x = np.unique(np.concatenate([tried, every]))
            new = np.array([*self._new_room(limits, x), np.zeros(len(x))])
            index = np.searchsorted(x, tried)
            exact = np.array([t.exact for t in known])
            worn = _corrected(tried, margins - new[:, index], exact)
            steps = np.diff(worn, axis=1, append=worn[:, -1:])
            spread = _BEND * np.abs(steps[:, np.searchsorted(tried, x, side="right") - 1])
            spread[:, index] = spread[-1] = 0.0
            room = new + [np.interp(x, tried, row) for row in worn]
            room[:, index[exact]] = margins[:, exact]
            with np.errstate(divide="ignore", invalid="ignore"):
                lives = _corrected(tried, np.log([[t.life for t in known]]), exact)
                life = np.exp(np.interp(x, tried, lives[0]))
            life[index] = np.exp(lives[0])
            places = {t.preload: int(k) for t, k in zip(known, index, strict=True)}
            self._guesses[limits] = Guess(x, np.nan_to_num(life), room, spread, places)
        return self._guesses[limits]

    def _new_room(self, limits: DesignLimits, x: np.ndarray) -> np.ndarray:
        """How far the limits (limits, n) are as new at logarithms of preloads (n,)."""
        if self.new is None:
            return np.zeros((len(limits.held), len(x)))
        solved = self.new["status"] == OK
        log_preloads = np.log(self.new["preload"])[solved]
        if not log_preloads.size:
            return np.zeros((len(limits.held), len(x)))
        return np.array(
            [np.interp(x, log_preloads, row[solved]) for row in _room(self.new, limits)]
        )
