"""Lives of one method over preload: those that were solved, and what may lie between them.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from bearingwear.kernels.status import OK
from bearingwear.studies.design.choice import limit_margins
from bearingwear.studies.design.plan import DesignLimits

DIGITS = 3  # of a preload, at least
STEEPEST_LIFE = 1.5
"""How fast a life rises between two preloads at most, as a power, other than at a jump."""

_SLACK = 0.4  # by which a slope inside an interval may differ from those outside of it
_NEAR = 0.06  # width in log preload, below which it is half as much
_SAFETY = 2.0  # widths to where a limit is met, as interpolated
_BEND = 0.25  # of a limit's steps: how far it may bend between two preloads
_SAME = 1e-9


@dataclass(frozen=True)
class Tried:
    """A preload whose life was solved.

    Attributes
    ----------
    preload : float
        [N]
    values : mapping
        As of `followed_point`.
    life : float
        [s]; zero where it was not solved.
    exact : bool
        Whether it is the life that is printed, not a quick one.
    """

    preload: float
    values: Mapping[str, Any]
    life: float
    exact: bool

    @property
    def solved(self) -> bool:
        return bool(self.values["status"] == OK)

    def margins(self, limits: DesignLimits) -> np.ndarray:
        """How far each limit is, as `_room`; last whether a bearing would be built so (1 or -1)."""
        if not self.solved:
            return np.full(len(limits.given) + 1, -1.0)
        practical = -1.0 if self.values.get("impractical") else 1.0
        return _room([*limit_margins(self.values, limits), practical])

    def is_allowed(self, limits: DesignLimits) -> bool:
        return self.life > 0.0 and bool(np.all(self.margins(limits) >= 0.0))


class Neighbours(NamedTuple):
    """Two neighbouring preloads and those outside of them, where there are some."""

    before: Tried | None
    a: Tried
    b: Tried
    after: Tried | None

    @property
    def width(self) -> float:
        return math.log(self.b.preload / self.a.preload)

    def longest(self, limits: DesignLimits) -> float:
        """No life [s] within the limits between the two is taken to be longer than this."""
        if not self._may_be_allowed(limits):
            return 0.0
        lives, width = (self.a.life, self.b.life), self.width
        if not max(lives) > 0.0:
            return 0.0
        if self.jumps:
            return max(lives) * math.exp(STEEPEST_LIFE * width)
        slack = _SLACK if width > _NEAR else 0.5 * _SLACK
        step = math.log(lives[1] / lives[0])
        if self.a.is_allowed(limits) != self.b.is_allowed(limits):
            end, share = self.limit_met(limits)
            rise = max(step if end is self.a else -step, 0.0) + slack * width
            return end.life * math.exp(rise * min(1.0, _SAFETY * share))
        rise = min(_slope(self.before, self.a, STEEPEST_LIFE) + slack, STEEPEST_LIFE)
        fall = max(_slope(self.b, self.after, -STEEPEST_LIFE) - slack, -STEEPEST_LIFE)
        if rise * width <= step or -fall * width <= -step:
            return max(lives)
        at = (step - fall * width) / (rise - fall)  # where both lines meet
        return lives[0] * math.exp(rise * at)

    @property
    def jumps(self) -> bool:
        """Whether the life changes more than it does anywhere but at a jump."""
        lives = self.a.life, self.b.life
        if not min(lives) > 0.0:
            return True
        return abs(math.log(lives[1] / lives[0])) > STEEPEST_LIFE * self.width

    def limit_met(self, limits: DesignLimits) -> tuple[Tried, float]:
        """The end within the limits, and which share of the width they are still kept."""
        inside, outside = (self.a, self.b) if self.a.is_allowed(limits) else (self.b, self.a)
        kept, passed = inside.margins(limits), outside.margins(limits)
        shares = [g / (g - h) for g, h in zip(kept, passed, strict=True) if h < 0.0]
        return inside, min(shares, default=0.5)

    def split(self, limits: DesignLimits) -> float:
        """The preload to solve next: where a limit is met, or in the middle [N]."""
        low, high = math.log(self.a.preload), math.log(self.b.preload)
        middle = 0.5 * (low + high)
        flips = self.a.is_allowed(limits) != self.b.is_allowed(limits)
        if flips and min(self.a.life, self.b.life) > 0.0 and not self._turns_impractical():
            end, share = self.limit_met(limits)
            share = min(max(share, 0.02), 0.98)
            middle = low + share * (high - low) if end is self.a else high - share * (high - low)
        return round_number(math.exp(middle), self.a.preload, self.b.preload)

    def _turns_impractical(self) -> bool:
        return bool(self.a.values.get("impractical")) != bool(self.b.values.get("impractical"))

    def _may_be_allowed(self, limits: DesignLimits) -> bool:
        """Whether each limit is kept at an end, or may be between them where its margin peaks."""
        a, b = (t.margins(limits) if t.solved else None for t in (self.a, self.b))
        if a is None or b is None:
            return a is not b
        kept = np.maximum(a, b) >= 0.0
        if kept.all() or not kept[-1]:
            return bool(kept.all())
        rises = falls = np.full(len(a), True)
        steps = [np.abs(b - a)]
        if self.before is not None and self.before.solved:
            steps.append(a - self.before.margins(limits))
            rises = steps[-1] > 0.0
        if self.after is not None and self.after.solved:
            steps.append(self.after.margins(limits) - b)
            falls = steps[-1] < 0.0
        peak = np.maximum(a, b) + _BEND * np.max(np.abs(steps), axis=0)
        return bool(np.all(kept | (rises & falls & (peak >= 0.0))))


def _slope(a: Tried | None, b: Tried | None, unknown: float) -> float:
    """Of the life over preload, both as logarithms; at most the steepest."""
    if a is None or b is None or not min(a.life, b.life) > 0.0:
        return unknown
    slope = math.log(b.life / a.life) / math.log(b.preload / a.preload)
    return slope if abs(slope) < STEEPEST_LIFE else unknown


def _room(margins: Sequence[Any]) -> np.ndarray:
    """Margins on a scale on which what goes as a power of the preload is straighter."""
    values = np.array(margins, dtype=float)
    return np.sign(values) * np.log1p(np.abs(values))


def round_number(target: float, low: float, high: float) -> float:
    """The number nearest to a target with the fewest digits, between two others."""
    for decimals in range(DIGITS - 1 - math.floor(math.log10(target)), 12):
        unit = 10.0**-decimals
        near = [round(target + k * unit, decimals) for k in (0, -1, 1)]
        inside = [p for p in near if low * (1.0 + _SAME) < p < high * (1.0 - _SAME)]
        if inside:
            return min(inside, key=lambda p: abs(p - target))
    return target


@dataclass
class PreloadLine:
    """Lives of one method over preload.

    Attributes
    ----------
    method : str
    tried : dict
        By preload [N].
    """

    method: str
    basis: int
    tried: dict[float, Tried] = field(default_factory=dict)
    _arrays: dict[str, np.ndarray] | None = None

    def add(self, preload: float, values: Mapping[str, Any], exact: bool) -> None:
        solved = values["status"] == OK
        life = float(values["life"][self.basis]) if solved else 0.0
        self.tried[preload] = Tried(preload, values, life if life > 0.0 else 0.0, exact)
        self._arrays = None

    def is_exact(self, preload: float) -> bool:
        return preload in self.tried and self.tried[preload].exact

    def leave_out_quick(self, low: float, high: float) -> None:
        """Forget quick lives between two exact ones, which see limits and jumps less sharply."""
        between = [p for p, t in self.tried.items() if low < p < high and not t.exact]
        for preload in between:
            del self.tried[preload]
            self._arrays = None

    @property
    def in_order(self) -> list[Tried]:
        return [self.tried[preload] for preload in sorted(self.tried)]

    def intervals(self) -> Iterator[Neighbours]:
        known = [None, *self.in_order, None]
        for k in range(1, len(known) - 2):
            yield Neighbours(*known[k - 1 : k + 3])  # type: ignore[arg-type]

    def best(self, limits: DesignLimits, gain: float) -> Tried | None:
        """The longest life within the limits; a quick one if it is so much longer."""
        allowed = [t for t in self.in_order if t.is_allowed(limits)]
        exact = max((t for t in allowed if t.exact), key=lambda t: t.life, default=None)
        quick = max((t for t in allowed if not t.exact), key=lambda t: t.life, default=None)
        if exact is None or quick is None:
            return exact or quick
        return quick if quick.life > gain * exact.life else exact

    def doubtful(self, limits: DesignLimits, enough: float, narrowest: float) -> Neighbours | None:
        """Where a life within the limits may be longest, and longer than is enough [s]."""
        wide = ((one.longest(limits), one) for one in self.intervals() if one.width > narrowest)
        longest, one = max(wide, key=lambda pair: pair[0], default=(0.0, None))
        return one if longest > enough else None

    def longest(self, limits: DesignLimits) -> float:
        """The longest life within the limits that was solved [s]."""
        return max((t.life for t in self.in_order if t.is_allowed(limits)), default=0.0)

    def interpolated_best(self, limits: DesignLimits) -> tuple[float, float]:
        """Longest life within the limits [s] and its preload [N], with lives and limited values
        linear between neighbours; zero where there is none.
        """
        p, lives, kept = self._table(limits)
        both = (lives[:-1] > 0.0) & (lives[1:] > 0.0)
        start, step = kept[:, :-1], np.diff(kept, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            root = -start / step
            low = np.max(np.where(step > 0.0, root, 0.0), axis=0, initial=0.0)
            high = np.min(np.where(step < 0.0, root, 1.0), axis=0, initial=1.0)
            never = np.any((step == 0.0) & (start < 0.0), axis=0)
            shares = np.array([low, high])[:, both & ~never & (low <= high)]
            x, y = np.log(p), np.log(lives)
        k = np.flatnonzero(both & ~never & (low <= high))
        alone = np.flatnonzero((lives > 0.0) & np.all(kept >= 0.0, axis=0))
        at = np.concatenate([x[alone], *(x[k] + shares * (x[k + 1] - x[k]))])
        found = np.concatenate([y[alone], *(y[k] + shares * (y[k + 1] - y[k]))])
        if not found.size:
            return 0.0, math.nan
        best = int(np.argmax(found))
        return math.exp(found[best]), math.exp(at[best])

    def _table(self, limits: DesignLimits) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Preloads (n,), lives (n,) and how far the limits are (limits, n)."""
        if self._arrays is None:
            known = self.in_order
            names = {name for t in known for name in t.values}
            self._arrays = {
                name: np.array([t.values.get(name, np.nan) for t in known], dtype=float)
                for name in names
                if all(np.ndim(t.values.get(name, np.nan)) == 0 for t in known)
            }
            self._arrays["life"] = np.array([t.life for t in known])
            self._arrays["preload"] = np.array([t.preload for t in known])
        values = self._arrays
        margins = _room([*limit_margins(values, limits), 1.0 - 2.0 * (values["impractical"] > 0)])
        return values["preload"], values["life"], np.where(values["status"] == OK, margins, -1.0)
