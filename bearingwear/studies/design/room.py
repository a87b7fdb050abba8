"""Robustness of the choice of a preload method: how far an assumption may move, and the verdict.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import math
from bisect import bisect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.lives.many import HertzianLives, lives_by_end, worn_life
from bearingwear.measures import ENDS
from bearingwear.results.variable import Variable, table
from bearingwear.scene.blocks import EndOfLife
from bearingwear.scene.cases import cases_that_wear
from bearingwear.scene.scene import Scene, key_of_scene
from bearingwear.solvers.bearing.growth import temperatures
from bearingwear.solvers.roots import brent_root
from bearingwear.studies.dataset import filled
from bearingwear.studies.design.document.words import END_KEY, FRICTION_KEY, WEAR_KEY
from bearingwear.studies.design.plan import DesignLimits
from bearingwear.studies.design.preload_line import PreloadLine, round_number
from bearingwear.studies.design.search import GUIDED, Asking, Request, guide, lives_needed

FARTHEST = 4.0
"""Largest factor by which a limit is moved either way."""

CRITERIA_FARTHEST = 2.0
"""The same for an end of life and for friction."""

FOUND_TO = 4e-3
"""Relative: to which an end of what holds is found."""

WARMINGS = (5.0, 10.0, 20.0, 40.0)
"""Warming of an inner ring alone that is tried [K]."""
_WARMTH_FOUND_TO = 0.05  # [K]

_LIMITS, _CRITERIA, _FRICTIONS = 40, 6, 3  # steps to the farthest value
_GUIDED_GAIN = 1.05  # of a life that the map may miss
_GUIDED = 5  # of the steps of a limit, where quick lives show what the coarse map misses
_NEAREST = 2e-2  # width in log preload, within which there is an exact life
_MOST = 40
_ALIKE = 0.05  # lives that differ by less of the longer one: between them is none to solve
_NO_DOUBT = 2.0 * _ALIKE  # logarithm of a ratio of lives, one of them between two alike
_NO_CHANCE = 50.0  # logarithm of a ratio of lives of which one is nothing
SHARES_OF_ENDS = ("preload_fraction", "gyroscopic_slip_share", "skid_ratio")
_LARGEST_SHARE = 0.999


@dataclass(frozen=True, kw_only=True)
class Assumption:
    name: str  # its key
    # its value, and the ends between which the same method lasts longer; NaN for none found
    now: float
    low: float = math.nan
    high: float = math.nan

    def turns_within(self, share: float) -> bool:
        """Whether a move of a share reverses the choice."""
        return self.low > (1.0 - share) * self.now or self.high < (1.0 + share) * self.now


Advantage = Callable[[float], float]
"""Logarithm of the better method's life over the other's, with an assumption times a factor.

NaN where it is not known.
"""


def advantage(lives: Sequence[float], first: int) -> float:
    """Logarithm of a life over the other one; NaN where one was not solved, or both are nothing."""
    own, other = lives[first], lives[1 - first]
    if not np.isfinite(lives).all() or not max(lives) > 0.0:
        return math.nan
    if not min(lives) > 0.0:
        return math.copysign(_NO_CHANCE, own - other)
    return math.log(own / other)


def longer(lives: Sequence[float]) -> int | None:
    """Which of some lives is the longest; None where one was not solved, or all are nothing."""
    if not np.isfinite(lives).all() or not max(lives) > 0.0:
        return None
    return int(np.argmax(lives))


def reversal(
    guide: Advantage,
    advantage: Advantage,
    factors: Sequence[float],
    to: float,
    now: float | None = None,
) -> float:
    """The factor at which a choice is reversed; NaN where it is not, or not known before.

    guide: close to `advantage`, and cheaper: it shows where to look.
    advantage: solved on both sides of what is returned, closer together than `to`.
    factors: going away from 1, where the choice stands.
    to: relative: how well it is found.
    now: the advantage at 1, where it is known.
    """
    known = {0.0: guide(1.0) if now is None else now}
    last = 0.0
    for position in (0.0, *map(math.log, factors)):
        known[position] = known[position] if position in known else guide(math.exp(position))
        if not known[position] > 0.0:
            near = _root(lambda x: guide(math.exp(x)), known, last, position, to)
            if advantage is guide or math.isnan(near):
                return math.exp(near)
            ends = 0.0, math.log(factors[-1])
            return math.exp(_confirmed(lambda x: advantage(math.exp(x)), near, ends, to))
        last = position
    return math.nan


def _confirmed(advantage: Advantage, near: float, ends: tuple[float, float], to: float) -> float:
    """Where an advantage is lost, close to a place; NaN where it is not known beyond, or held as
    far as the second end.
    """
    away = math.copysign(0.5 * to, ends[1])

    def first(condition: Callable[[float], bool], step: float, end: float) -> float:
        x = near + step
        while (end - x) * step > 0.0 and not condition(x):
            step *= 2.0
            x += step
        return x if (end - x) * step > 0.0 else end

    known: dict[float, float] = {}

    def stands(x: float) -> bool:
        known[x] = advantage(x)
        return known[x] > 0.0

    held = first(stands, -away, ends[0])
    lost = first(lambda x: not stands(x), away, ends[1])
    if lost == ends[1] and stands(lost):
        return math.nan
    inside = [x for x, value in known.items() if value > 0.0]
    held = max([held, *inside], key=lambda x: (x - held) * away)
    if not known[lost] <= 0.0:
        return math.nan
    if abs(lost - held) <= 1.01 * to:
        return 0.5 * (held + lost)
    known.setdefault(held, _NO_CHANCE)
    return _root(advantage, known, held, lost, to)


def _root(
    advantage: Advantage, known: dict[float, float], held: float, lost: float, to: float
) -> float:
    """Where an advantage is lost, between two places at which it is known; NaN where it is not
    known beyond.
    """
    if not known[held] > 0.0:
        return held if known[held] <= 0.0 else math.nan

    def value(x: float) -> float:
        if x not in known:
            known[x] = advantage(x)
        return known[x] if known[x] > 0.0 else min(known[x], -1e-9) if known[x] <= 0.0 else -1.0

    root = brent_root(value, held, lost, xtol=to)
    beyond = [x for x in known if not known[x] > 0.0 and (x - held) * (lost - held) > 0.0]
    nearest = min(beyond, key=lambda x: abs(x - held))
    return root if known[nearest] <= 0.0 else math.nan


def limit_end(
    lines: Sequence[PreloadLine], limits: DesignLimits, name: str, up: bool, first: int
) -> Asking:
    """Ask for the lives that show how far a limit may move; returns that value, or NaN.

    The best preloads are found anew for each value of it.
    """
    now = limits.given[name]
    factors = (FARTHEST if up else 1.0 / FARTHEST) ** np.linspace(0.0, 1.0, _LIMITS + 1)[1:]

    def moved(factor: float) -> DesignLimits:
        changed: Any = {name: factor * now}
        return replace(limits, **changed)

    def ahead(factor: float) -> float:
        return advantage([line.interpolated_best(moved(factor))[0] for line in lines], first)

    for factor in factors[:: _LIMITS // _GUIDED].tolist():
        for line in lines:
            yield from lives_needed(line, moved(factor))
        least = lines[first].interpolated_best(moved(factor))[0]
        yield from guide(lines[1 - first], moved(factor), least=least)
        if not ahead(factor) > 0.0:
            break
    for _ in range(_MOST):
        end = reversal(ahead, ahead, factors.tolist(), 0.01 * FOUND_TO)
        if math.isnan(end):
            return math.nan
        beyond = moved(end * (1.0 + 0.02 * FOUND_TO) ** (1 if up else -1))
        before = [len(line.tried) for line in lines]
        for line in lines:
            least = _GUIDED_GAIN * line.interpolated_best(beyond)[0]
            yield from guide(line, beyond, _GUIDED_GAIN, least)
        if before != [len(line.tried) for line in lines]:
            continue
        sides = [
            _missing(lines, one, width, exact)
            for width, exact in ((GUIDED, False), (_NEAREST, True))
            for one in (moved(end), beyond)
        ]
        if (missing := next(filter(None, sides), None)) is None:
            return end * now
        yield missing
    return math.nan


def _missing(
    lines: Sequence[PreloadLine], limits: DesignLimits, width: float, exact: bool
) -> list[Request]:
    """Lives at the best preloads, where none was solved within a width in log preload."""
    missing: list[Request] = []
    for line in lines:
        _, preload = line.interpolated_best(limits)
        known = [p for p, t in line.tried.items() if t.exact >= exact]
        near = min((abs(math.log(p / preload)) for p in known), default=math.inf)
        if near > width:  # which no preload that is not a number is
            ends = preload * (1.0 - width), preload * (1.0 + width)
            missing.append((line, round_number(preload, *ends), exact))
    return missing


def criteria_room(scenes: Sequence[Scene], lives: Sequence[float], first: int) -> list[Assumption]:
    """Range of each criterion within which the same preload lasts longer.

    By quick lives, times what those of the scenes are over their own quick ones.

    scenes: with the preloads to compare, which stay as they are.
    """
    end = scenes[0].wear.end_of_life or EndOfLife()
    most = {name: _largest(name, limit) for name, limit in end.criteria.items()}
    loose = {
        name: limit / CRITERIA_FARTHEST if ENDS[name].falls else most[name] * limit
        for name, limit in end.criteria.items()
    }
    quick = [lives_by_end(scene, replace(end, **loose), quick=True) for scene in scenes]
    own = [length(end) for length in quick]
    scales = [life / one if one > 0.0 else 1.0 for life, one in zip(lives, own, strict=True)]
    even = np.linspace(0.0, 1.0, _CRITERIA + 1)[1:]
    room = []
    for name, limit in end.criteria.items():

        def moved(factor: float, name: str = name, limit: float = limit) -> EndOfLife:
            return replace(end, **{name: factor * limit})

        def ahead(factor: float, moved: Callable[[float], EndOfLife] = moved) -> float:
            each = zip(scales, quick, strict=True)
            return advantage([scale * life(moved(factor)) for scale, life in each], first)

        above = most[name] ** even if most[name] > 1.0 else np.array([])
        sides = (CRITERIA_FARTHEST**-even, above)
        low, high = (reversal(ahead, ahead, f.tolist(), 0.05 * FOUND_TO) for f in sides)
        room.append(
            Assumption(name=f"{END_KEY}{name}", now=limit, low=low * limit, high=high * limit)
        )
    return room


def _largest(name: str, limit: float) -> float:
    """How many times larger an end of life may be."""
    if name not in SHARES_OF_ENDS:
        return CRITERIA_FARTHEST
    return max(1.0, min(CRITERIA_FARTHEST, _LARGEST_SHARE / limit))


def friction_end(scenes: Sequence[Scene], lives: Sequence[float], first: int, up: bool) -> float:
    """The factor of friction at which the choice is reversed; NaN for none found."""
    mu, most = scenes[0].friction.coefficient, _most_friction(scenes[0])
    if not most > 1.0:
        return math.nan

    def with_friction(one: Scene, factor: float) -> Scene:
        return replace(one, friction=replace(one.friction, ball_race=factor * mu))

    @cache
    def exact(k: int, factor: float) -> float:
        return printed_life(with_friction(scenes[k], factor))

    known = [{1.0: life} for life in lives]

    def quick(k: int, factor: float) -> float:
        known[k][factor] = printed_life(with_friction(scenes[k], factor), quick=True)
        return known[k][factor]

    def ahead(solved: Callable[[int, float], float], factor: float) -> float:
        """By lives that are solved, or that lie between two quick ones which hardly differ."""
        found = [_between(one, factor) or solved(k, factor) for k, one in enumerate(known)]
        return advantage(found, first)

    def confirmed(factor: float) -> float:
        """By exact lives; between quick ones only where these leave no doubt."""
        guess = ahead(exact, factor)
        if abs(guess) > _NO_DOUBT:
            return guess
        return advantage([exact(k, factor) for k in range(len(scenes))], first)

    even = np.linspace(0.0, 1.0, _FRICTIONS + 1)[1:]
    factors = most**even if up else CRITERIA_FARTHEST**-even
    now = advantage(lives, first)
    return reversal(partial(ahead, quick), confirmed, factors.tolist(), FOUND_TO, now)


def _between(lives: Mapping[float, float], factor: float) -> float:
    """A life between two that hardly differ [s]; 0 where there is none."""
    factors = sorted(lives)
    k = bisect(factors, factor)
    if 0 < k < len(factors):
        a, b = factors[k - 1], factors[k]
        if abs(lives[a] - lives[b]) < _ALIKE * max(lives[a], lives[b]):
            return float(np.interp(factor, (a, b), (lives[a], lives[b])))
    return 0.0


def warm_end(scenes: Sequence[Scene], lives: Sequence[float], first: int) -> float:
    """Warming of the inner ring alone that reverses the choice [K]; NaN for none found.

    By quick lives, as `criteria_room`.
    """

    def quick(one: Scene, kelvin: float) -> float:
        now = temperatures(one)
        warm = replace(now, inner_ring_C=(now.inner_ring_C or 0.0) + kelvin)
        return printed_life(replace(one, temperature=warm), quick=True)

    own = [quick(one, 0.0) for one in scenes]
    scales = [life / one if one > 0.0 else 1.0 for life, one in zip(lives, own, strict=True)]

    def ahead(kelvin: float) -> float:
        each = zip(scales, scenes, strict=True)
        return advantage([scale * quick(one, kelvin) for scale, one in each], first)

    held = 0.0
    known = {held: advantage(lives, first)}
    for kelvin in WARMINGS:
        known[kelvin] = ahead(kelvin)
        if not known[kelvin] > 0.0:
            return _root(ahead, known, held, kelvin, _WARMTH_FOUND_TO)
        held = kelvin
    return math.nan


def friction_room(scene: Scene, low: float, high: float) -> list[Assumption]:
    """Range of the wear coefficient, which scales all lives, and of friction between factors."""
    K = scene.materials[scene.bearing.race_material].wear_coefficient
    found, mu = [Assumption(name=WEAR_KEY, now=K)], scene.friction.coefficient
    if _most_friction(scene) > 1.0:
        found.append(Assumption(name=FRICTION_KEY, now=mu, low=low * mu, high=high * mu))
    return found


def _most_friction(scene: Scene) -> float:
    """How many times larger friction may be; 0 where there is none."""
    mu, part = scene.friction.coefficient, key_of_scene(FRICTION_KEY)
    assert part is not None
    return min(CRITERIA_FARTHEST, part.key.ends[1] / mu) if mu > 0.0 else 0.0


def printed_life(scene: Scene, quick: bool = False) -> float:
    """The life that is printed of a scene, or a quick one [s]; NaN where it was not solved."""
    if scene.cases and scene.duty is None:
        each = [printed_life(one, quick) for one in cases_that_wear(scene).values()]
        return float(np.min(each))
    life = worn_life(scene, quick) or HertzianLives(scene)(scene)
    return life.last.time if life.status == OK else math.nan


CLAIMED = 0.05
"""A choice that reverses within this move of one assumption is not claimed."""

VERDICTS = ("nothing_to_compare", "longer", "neither")
NO_COMPARISON, ONE_LONGER, NEITHER_LONGER = range(len(VERDICTS))

HELD = table(
    Variable("assumed", ("assumption",), "", "assumed value, in the unit of its key"),
    Variable("holds_from", ("assumption",), "",
        "lowest value at which the same method remains better"),
    Variable("holds_to", ("assumption",), "",
        "highest value at which the same method remains better"),
    Variable("verdict", (), "", "whether one method is preferred over the other", dtype="i1",
        flags=VERDICTS,
        comment="neither is preferred if a 5 % change in one assumption reverses the order, or if "
        "the lives differ by less than their numerical errors"),
)  # fmt: skip
"""How far a choice holds; `holds_from`, `holds_to`: NaN where it holds over all searched."""


def verdict_on(lives: Sequence[float], errors: Sequence[float], room: Sequence[Assumption]) -> int:
    """Index into `VERDICTS`: whether one of two methods is preferred."""
    better = longer(lives) if len(lives) == 2 else None
    if better is None:
        return NO_COMPARISON
    beyond_errors = lives[better] * (1.0 - np.nansum(errors)) > lives[1 - better]
    turned = any(one.turns_within(CLAIMED) for one in room)
    return ONE_LONGER if beyond_errors and not turned else NEITHER_LONGER


def held(room: Sequence[Assumption], said: int) -> xr.Dataset:
    """Robustness of a choice, as variables of a file over `assumption`."""
    columns = {"holds_from": "low", "assumed": "now", "holds_to": "high"}
    values = {name: [getattr(one, field) for one in room] for name, field in columns.items()}
    names = tuple(one.name for one in room)
    number = Variable("assumption", ("assumption",), "", "assumption", dtype="i1", flags=names)
    return filled(HELD, {number: None}, [{**values, "verdict": said}])
