"""What would change the choice of the preload method: values at which the other one lives longer.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK
from bearingwear.lives.many import HertzianLives, worn_life
from bearingwear.measures import LIMITED
from bearingwear.results.variable import Variable, table
from bearingwear.scene.arrangement import with_method
from bearingwear.scene.cases import cases_that_wear
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.checking.records import Key
from bearingwear.scene.scene import Scene, key_of_scene
from bearingwear.solvers.bearing.growth import temperatures
from bearingwear.studies.dataset import dataset_of_rows
from bearingwear.studies.design.best import QUICK_LIFE, PreloadLine, PreloadPoint, PreloadSearch
from bearingwear.studies.design.plan import DesignLimits

LIMIT_KEY = "limits."
"""Prefix of the name of a requirement."""

FRICTION_KEY, SHEAR_KEY = "friction.ball_race", "friction.film.shear_strength_MPa"
WARMTH_KEY, GROOVE_KEY = "temperature.inner_ring_C", "groove"

_FRICTION_FACTORS = (0.5, 0.5**0.5, 2.0**0.5, 2.0)
"""Friction that is tried, over the scene's."""

_WARMINGS = (10.0, 20.0, 40.0)
"""Warming of the inner ring alone that is tried [K]."""

_END_WIDTH = 0.02
"""Width to which the ends of friction and warmth are found, over the range that is tried."""

_FARTHEST = 2.0
"""Largest factor by which a requirement is moved either way."""

_MOVES = 24  # number of values of a requirement that are tried, from now to the farthest

CHANGES = table(
    Variable("value_now", ("change",), "", "value now, in the unit of its key"),
    Variable("other_better_below", ("change",), "",
        "value below which the other method gives the longer life"),
    Variable("other_better_above", ("change",), "",
        "value above which the other method gives the longer life"),
    Variable("tried_from", ("change",), "", "lowest value tried"),
    Variable("tried_to", ("change",), "", "highest value tried"),
)  # fmt: skip
"""What would change the choice; NaN where no value that was tried does."""


@dataclass(frozen=True, kw_only=True)
class Change:
    """An assumption, and the values at which the other method lives longer.

    Values are in the unit of the assumption's key. They are NaN where no value that was tried lets
    the other method live longer.
    """

    name: str  # key of a scene, or `LIMIT_KEY` and the name of a requirement
    now: float
    other_better_below: float = math.nan
    other_better_above: float = math.nan
    tried: tuple[float, float]  # lowest and highest


def changes_dataset(changes: Sequence[Change]) -> xr.Dataset:
    """Returns the variables of `CHANGES` over the dimension `change`."""
    columns = {
        "value_now": [change.now for change in changes],
        "other_better_below": [change.other_better_below for change in changes],
        "other_better_above": [change.other_better_above for change in changes],
        "tried_from": [change.tried[0] for change in changes],
        "tried_to": [change.tried[1] for change in changes],
    }
    names = Variable(
        "change", ("change",), "", "what may be otherwise than assumed", dtype="i1",
        flags=tuple(change.name for change in changes),
    )  # fmt: skip
    return dataset_of_rows(CHANGES, {names: None}, [columns])


def choice_changes(search: PreloadSearch, best: Sequence[PreloadPoint | None]) -> list[Change]:
    """Returns what would change the choice between two preload methods.

    It may be requirements and, if both methods have a recommended point, friction, warmth and worn
    grooves. The list is empty if no method has a life.

    search: run before, with a line for each method.
    best: the recommended point of each line; None without one.
    """
    lives = [0.0 if point is None else point.life for point in best]
    if not max(lives) > 0.0:
        return []
    better = int(np.argmax(lives))
    # other values of a requirement are multiples of the present one, so that of zero has none
    names = [name for name, value in search.limits.given.items() if value > 0.0]
    changes = [_limit_change(search, name, better) for name in names]
    points = [point for point in best if point is not None]
    if len(points) == len(search.lines):
        changes += _assumption_changes(search, points, better)
    return changes


def _limit_change(search: PreloadSearch, name: str, better: int) -> Change:
    """Returns how far a requirement may move until the other method is better.

    name: of the requirement.
    better: number of the line with the longer life.
    """
    now = search.limits.given[name]
    low, high = _limit_range(now, name)
    return Change(
        name=f"{LIMIT_KEY}{name}",
        now=now,
        other_better_below=_limit_end(search, name, low, better),
        other_better_above=_limit_end(search, name, high, better),
        tried=(low, high),
    )


def _limit_end(search: PreloadSearch, name: str, farthest: float, better: int) -> float:
    """Returns the value of a requirement at which the other method becomes better.

    Values from the present one to the farthest are tried, each with its own best preloads. Returns
    NaN if none changes the choice, or if neither method has a life any more. Towards looser values,
    it solves quick lives at preloads that become allowed, and adds them to the search.

    name: of the requirement, in whose unit the values are.
    better: number of the line with the longer life now.
    """
    limits = search.limits
    now = limits.given[name]
    is_looser = (farthest > now) != LIMITED[name].falls
    if is_looser:  # preloads that are not allowed now may become so
        loosest = _with_limit(limits, name, farthest)
        search.solve(partial(_newly_allowed, limits=limits, looser=loosest), QUICK_LIFE, loosest)
    # that of the present value, of any size: it matters only if the first value tried has none
    previous_advantage = 1.0
    for value in np.geomspace(now, farthest, _MOVES + 1)[1:].tolist():
        advantage = _advantage(search.lines, _with_limit(limits, name, value), better)
        if math.isnan(advantage):
            return math.nan
        if advantage <= 0.0:
            step = (farthest / now) ** (1.0 / _MOVES)
            return value * step ** (_share_to_zero(previous_advantage, advantage) - 1.0)
        previous_advantage = advantage
    return math.nan


def _limit_range(now: float, name: str) -> tuple[float, float]:
    """Returns the lowest and highest value of a requirement that are tried, in its unit.

    They are half and twice the present one, but not above the largest that is allowed.

    name: of the requirement.
    """
    _, highest = Key(within=LIMITED[name].limit[1]).ends
    return now / _FARTHEST, max(now, min(_FARTHEST * now, highest))


def _with_limit(limits: DesignLimits, name: str, value: float) -> DesignLimits:
    """Returns the requirements with another value of one of them."""
    changed: Any = {name: value}
    return replace(limits, **changed)


def _newly_allowed(line: PreloadLine, limits: DesignLimits, looser: DesignLimits) -> list[float]:
    """Returns every second preload [N] of the grid that only looser requirements allow when new.

    Preloads with a life are left out.

    limits: present requirements.
    """
    refused = [p for p in line.grid[::2] if p not in line.lives and not line.may_live(p, limits)]
    return [p for p in refused if line.may_live(p, looser)]


def _advantage(lines: Sequence[PreloadLine], limits: DesignLimits, better: int) -> float:
    """Returns the logarithm of the better method's best life over the other's.

    Infinite where one has no life, NaN where neither has one.

    lines: of both methods.
    better: number of the better one by the present requirements.
    """
    life = interpolated_best_life(lines[better], limits)
    other_life = interpolated_best_life(lines[1 - better], limits)
    return _log_ratio(life, other_life)


def _log_ratio(life: float, other_life: float) -> float:
    """Returns the logarithm of a life over another, positive if the first is longer.

    It is +inf if only the other is zero, -inf if only the first is, NaN if one is NaN or both are
    zero.
    """
    if math.isnan(life) or math.isnan(other_life) or life == other_life == 0.0:
        return math.nan
    if other_life == 0.0:
        return math.inf
    if life == 0.0:
        return -math.inf
    return math.log(life) - math.log(other_life)


def _share_to_zero(start: float, end: float) -> float:
    """Returns the share of the way from one advantage to another at which it is zero.

    The advantage changes evenly on the way. The share is a half where one end is infinite.

    start, end: different advantages, as from `_log_ratio`.
    """
    return start / (start - end) if math.isfinite(start - end) else 0.5


def interpolated_best_life(line: PreloadLine, limits: DesignLimits) -> float:
    """Returns the longest life [s] of a line within requirements, between the solved preloads.

    Margins and the logarithm of the life change evenly from a preload with a life to the next.
    Returns zero where no preload is allowed.
    """
    solved_points = [point for _, point in sorted((line.new | line.lives).items())]
    points = [point for point in solved_points if point.life > 0.0]
    margins = [point.margins(limits) for point in points]
    lives = [0.0]
    for point, point_margins in zip(points, margins, strict=True):
        if point_margins.min() >= 0.0:
            lives.append(point.life)
    for k, (point, following) in enumerate(itertools.pairwise(points)):
        if max(margins[k].min(), margins[k + 1].min()) >= 0.0:
            start = math.log(point.life)
            end = math.log(following.life)
            for share in _allowed_shares(margins[k], margins[k + 1]):
                lives.append(math.exp(start + share * (end - start)))
    return max(lives)


def _allowed_shares(start: np.ndarray, end: np.ndarray) -> tuple[float, float]:
    """Returns the lowest and highest share of a way between which no margin is negative.

    Margins change evenly on the way.

    start, end: margins (n,) at the ends of the way; at one end at least, none is negative.
    """
    step = end - start
    with np.errstate(divide="ignore", invalid="ignore"):
        zeros = -start / step
    low = max([0.0, *zeros[step > 0.0].tolist()])
    high = min([1.0, *zeros[step < 0.0].tolist()])
    return low, high


def _assumption_changes(
    search: PreloadSearch, best: Sequence[PreloadPoint], better: int
) -> list[Change]:
    """Returns the changes of friction, warmth and grooves, by quick lives at the best preloads.

    Quick lives with a changed assumption are scaled by exact over quick life without the change.

    best: the recommended point of each line.
    better: number of the line with the longer life.
    """
    scenes = [
        with_method(search.scene, line.method, point.preload)
        for line, point in zip(search.lines, best, strict=True)
    ]
    advantage = _log_ratio(best[better].life, best[1 - better].life)
    assumptions = _assumptions(search.scene, advantage)
    exact_over_quick: list[float] = []
    while trials := [
        (assumption, value) for assumption in assumptions for value in assumption.wanted
    ]:
        changed = [
            assumption.change(value, scene) for assumption, value in trials for scene in scenes
        ]
        unchanged = [] if exact_over_quick else scenes  # in the first round
        answers = search.answers_at(quick_life, [*unchanged, *changed])
        lives = [answer.get("life", math.nan) for answer in answers]
        if not exact_over_quick:
            # the first answers are those of the unchanged scenes, one for each point
            exact_over_quick = [
                point.life / life if life > 0.0 else 1.0
                for point, life in zip(best, lives, strict=False)
            ]
        trial_lives = np.reshape(lives[len(unchanged) :], (len(trials), len(scenes)))
        scaled_lives = trial_lives * exact_over_quick
        for (assumption, value), method_lives in zip(trials, scaled_lives.tolist(), strict=True):
            life, other_life = method_lives[better], method_lives[1 - better]
            assumption.advantages[value] = _log_ratio(life, other_life)
        for assumption in assumptions:
            assumption.wanted = assumption.values_between
    return [*(assumption.outcome for assumption in assumptions), *_groove_change(best, better)]


def _assumptions(scene: Scene, advantage: float) -> list[_Assumption]:
    """Returns the assumptions on friction and warmth of a scene, with the values to try first.

    A friction of zero is left out. Warmth is left out where a thermal network determines the
    temperatures, or where the scene allows no warming.

    advantage: of the better method now, as from `_log_ratio`.
    """
    key, friction = friction_of(scene)
    assumptions = []
    if friction > 0.0:
        values = [friction * factor for factor in _FRICTION_FACTORS]
        assumptions.append(
            _Assumption(
                name=key,
                change=with_friction,
                now=friction,
                advantages={friction: advantage},
                wanted=[value for value in values if value <= _highest_value(key)],
            )
        )
    warmings = _allowed_warmings(scene)
    if scene.thermal is None and warmings:
        assumptions.append(
            _Assumption(
                name=WARMTH_KEY,
                change=with_warm_inner_ring,
                now=0.0,
                advantages={0.0: advantage},
                wanted=warmings,
            )
        )
    return assumptions


def _allowed_warmings(scene: Scene) -> list[float]:
    """Returns the warmings of the inner ring that a scene allows [K].

    There are none if its materials differ and lack a thermal expansion.
    """
    allowed = []
    for kelvin in _WARMINGS:
        with contextlib.suppress(SceneError):
            with_warm_inner_ring(kelvin, scene)
            allowed.append(kelvin)
    return allowed


@dataclass(frozen=True)
class _Bracket:
    """Two values of an assumption: at the second, the advantage at the first is lost or unknown."""

    start: float
    end: float
    start_advantage: float
    end_advantage: float

    @property
    def is_open(self) -> bool:
        """Returns whether the advantage is not known at the end."""
        return math.isnan(self.end_advantage)

    @property
    def width(self) -> float:
        """Returns the distance between the two values."""
        return abs(self.end - self.start)

    @property
    def middle(self) -> float:
        """Returns the mean of the two values."""
        return 0.5 * (self.start + self.end)

    @property
    def zero(self) -> float:
        """Returns the value at which the advantage is lost, by a straight line between the ends.

        NaN if the advantage is not known at the end.
        """
        if self.is_open:
            return math.nan
        share = _share_to_zero(self.start_advantage, self.end_advantage)
        return self.start + share * (self.end - self.start)


@dataclass
class _Assumption:
    """An assumption, and the values of it that are tried.

    name: key of the scene that it is about.
    change: returns a scene with a value of the assumption.
    now: its present value.
    advantages: logarithm of the better method's life over the other's, by values of the assumption.
    wanted: values to try next.
    """

    name: str
    change: Callable[[float, Scene], Scene]
    now: float
    advantages: dict[float, float]
    wanted: Sequence[float]

    @property
    def values_between(self) -> list[float]:
        """Returns the values to try next: the middles of the brackets below and above the present.

        A bracket that is narrow enough is left out.
        """
        width = _END_WIDTH * (max(self.advantages) - min(self.advantages))
        brackets = (self._bracket(-1), self._bracket(1))
        return [bracket.middle for bracket in brackets if bracket and bracket.width > width]

    def _bracket(self, sign: int) -> _Bracket | None:
        """Returns the bracket in which the advantage is first lost or unknown; None without one.

        sign: -1 below the present value, 1 above it.
        """
        values = sorted(value for value in self.advantages if sign * (value - self.now) >= 0.0)
        for start, end in itertools.pairwise(values[::sign]):
            if not self.advantages[end] > 0.0:
                return _Bracket(start, end, self.advantages[start], self.advantages[end])
        return None

    @property
    def outcome(self) -> Change:
        """Returns the change: where the other method is better, and the range of values tried.

        The range ends where the advantage is not known any more.
        """
        low = self._bracket(-1)
        high = self._bracket(1)
        return Change(
            name=self.name,
            now=self.now,
            other_better_below=low.zero if low else math.nan,
            other_better_above=high.zero if high else math.nan,
            tried=(
                low.start if low and low.is_open else min(self.advantages),
                high.start if high and high.is_open else max(self.advantages),
            ),
        )


def _groove_change(best: Sequence[PreloadPoint], better: int) -> list[Change]:
    """Returns a list with the change from worn grooves (1) to Hertzian ones (0).

    The other method is better below 1 if its Hertzian life is longer. The list is empty unless all
    lives have worn grooves, and Hertzian lives beside them.

    best: the recommended point of each line.
    better: number of the line with the longer life.
    """
    hertzian_lives = [point.values["hertzian_life"] for point in best]
    has_worn_grooves = all(point.values.get("groove") for point in best)
    if not has_worn_grooves or not np.isfinite(hertzian_lives).all():
        return []
    is_other_better = hertzian_lives[better] < hertzian_lives[1 - better]
    below = 1.0 if is_other_better else math.nan
    return [Change(name=GROOVE_KEY, now=1.0, other_better_below=below, tried=(0.0, 1.0))]


def friction_of(scene: Scene) -> tuple[str, float]:
    """Returns the key of the friction of balls on races, and its value in the unit of the key.

    With a film, it is the film's shear strength.
    """
    film = scene.friction.film
    if film is not None:
        return SHEAR_KEY, film.shear_strength_MPa
    return FRICTION_KEY, scene.friction.coefficient


def _highest_value(key: str) -> float:
    """Returns the highest value that a key of a scene may have."""
    place = key_of_scene(key)
    assert place is not None
    return float(place.key.ends[1])


def with_friction(value: float, scene: Scene) -> Scene:
    """Returns a scene with another friction of balls on races; see `friction_of`."""
    key, _ = friction_of(scene)
    return scene.with_({key: value})


def with_warm_inner_ring(kelvin: float, scene: Scene) -> Scene:
    """Returns a scene whose inner ring alone is warmer by a difference [K].

    SceneError: its materials differ and lack a thermal expansion.
    """
    parts = temperatures(scene)
    warmer = replace(parts, inner_ring_C=(parts.inner_ring_C or 0.0) + kelvin)
    return replace(scene, temperature=warmer)


def quick_life(scene: Scene) -> dict[str, Any]:
    """Returns the shortest quick `life` of a scene's cases [s]; NaN where any was not solved."""
    return {"life": float(np.min([_quick_life(case) for case in cases_that_wear(scene).values()]))}


def _quick_life(scene: Scene) -> float:
    """Returns the quick life of one case [s]; NaN where it was not solved."""
    life = worn_life(scene, quick=True) or HertzianLives(scene)(scene)
    return float(life.last.time) if life.status == OK else math.nan
