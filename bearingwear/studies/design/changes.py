"""What would change the choice of the preload method: values at which the other one lives longer.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

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
from bearingwear.scene.arrangement import held_by
from bearingwear.scene.cases import cases_that_wear
from bearingwear.scene.scene import Scene, key_of_scene
from bearingwear.solvers.bearing.growth import temperatures
from bearingwear.studies.dataset import dataset_of_rows
from bearingwear.studies.design.best import QUICK_LIFE, PreloadLine, PreloadPoint, PreloadSearch
from bearingwear.studies.design.plan import DesignLimits

LIMIT_KEY = "limits."
"""Before the name of a requirement."""

FRICTION_KEY, SHEAR_KEY = "friction.ball_race", "friction.film.shear_strength_MPa"
WARMTH_KEY, GROOVE_KEY = "temperature.inner_ring_C", "groove"

_FRICTION_FACTORS = (0.5, 0.5**0.5, 2.0**0.5, 2.0)
"""Friction that is tried, over the scene's."""

_WARMINGS = (10.0, 20.0, 40.0)
"""Warming of the inner ring alone that is tried [K]."""

_FOUND_TO = 0.02
"""To which the ends of friction and warmth are found, over all that is tried."""

_FARTHEST = 2.0
"""Factor by which a requirement is moved either way, at most."""

_MOVES = 24  # of a requirement from now to the farthest

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
    """An assumption, and the values at which the other method lives longer."""

    name: str
    now: float
    below: float = math.nan
    above: float = math.nan
    tried: tuple[float, float]


def changes_dataset(changes: Sequence[Change]) -> xr.Dataset:
    """What would change the choice, as variables of a file over `change`."""
    columns = {
        "value_now": [one.now for one in changes],
        "other_better_below": [one.below for one in changes],
        "other_better_above": [one.above for one in changes],
        "tried_from": [one.tried[0] for one in changes],
        "tried_to": [one.tried[1] for one in changes],
    }
    names = Variable(
        "change", ("change",), "", "what may be otherwise than assumed", dtype="i1",
        flags=tuple(one.name for one in changes),
    )  # fmt: skip
    return dataset_of_rows(CHANGES, {names: None}, [columns])


def choice_changes(search: PreloadSearch, best: Sequence[PreloadPoint | None]) -> list[Change]:
    """What would change the choice between two methods.

    best: the recommended point of each line of the search.
    """
    lives = [0.0 if one is None else one.life for one in best]
    if not max(lives) > 0.0:
        return []
    first = int(np.argmax(lives))
    movable = [name for name, value in search.limits.given.items() if value > 0.0]  # by factors
    found = [_limit_change(search, name, first) for name in movable]
    known = [one for one in best if one is not None]
    if len(known) == len(search.lines):
        found += _assumption_changes(search, known, first)
    return found


def _limit_change(search: PreloadSearch, name: str, first: int) -> Change:
    """How far a requirement may move; the best preloads are found anew for each value of it."""
    now, (low, high) = search.limits.given[name], _range(search.limits.given[name], name)
    ends: dict[bool, float] = {}
    for is_up, end in ((False, low), (True, high)):
        wider = _moved(search.limits, name, end)
        if is_up != LIMITED[name].falls:  # looser: preloads that are not allowed now come in
            search.solve(partial(_more, limits=search.limits, wider=wider), QUICK_LIFE, wider)
        ends[is_up] = math.nan
        before = 1.0
        for value in np.geomspace(now, end, _MOVES + 1)[1:].tolist():
            ahead = _ahead(search.lines, _moved(search.limits, name, value), first)
            if math.isnan(ahead):
                break
            if ahead <= 0.0:
                share = before / (before - ahead) if math.isfinite(before - ahead) else 0.5
                ends[is_up] = value * ((end / now) ** (1.0 / _MOVES)) ** (share - 1.0)
                break
            before = ahead
    return Change(
        name=f"{LIMIT_KEY}{name}", now=now, below=ends[False], above=ends[True], tried=(low, high)
    )


def _range(now: float, name: str) -> tuple[float, float]:
    """Values of a requirement that are tried."""
    most = 1.0 if LIMITED[name].limit[1].startswith("(0, 1") else math.inf
    return now / _FARTHEST, max(now, min(_FARTHEST * now, most))


def _moved(limits: DesignLimits, name: str, value: float) -> DesignLimits:
    changed: Any = {name: value}
    return replace(limits, **changed)


def _more(line: PreloadLine, limits: DesignLimits, wider: DesignLimits) -> list[float]:
    """Every second preload without a life that new bearings allow by wider requirements alone."""
    refused = [p for p in line.grid[::2] if p not in line.lives and not line.may_live(p, limits)]
    return [p for p in refused if line.may_live(p, wider)]


def _ahead(lines: Sequence[PreloadLine], limits: DesignLimits, first: int) -> float:
    """Logarithm of the better method's best life over the other's; NaN where there is neither."""
    own, other = (interpolated_best_life(lines[k], limits) for k in (first, 1 - first))
    return _log_ratio(own, other)


def _log_ratio(own: float, other: float) -> float:
    """Logarithm of a life over another; NaN where one was not solved, or both are nothing."""
    if not max(own, other) > 0.0 or math.isnan(own + other):
        return math.nan
    if not min(own, other) > 0.0:
        return math.copysign(math.inf, own - other)
    return math.log(own / other)


def interpolated_best_life(line: PreloadLine, limits: DesignLimits) -> float:
    """The longest life [s] of a line within requirements, between the preloads that were solved.

    Margins and the logarithm of the life go evenly from one that is allowed to the next.
    """
    order = [one for _, one in sorted((line.new | line.lives).items())]
    margins = np.array([one.margins(limits) for one in order])
    longest = 0.0
    alive = [k for k, one in enumerate(order) if one.life > 0.0]
    for k in alive:
        if margins[k].min() >= 0.0:
            longest = max(longest, order[k].life)
    for a, b in itertools.pairwise(alive):
        if max(margins[a].min(), margins[b].min()) < 0.0:
            continue
        start, step = margins[a], margins[b] - margins[a]
        with np.errstate(divide="ignore", invalid="ignore"):
            root = -start / step
        low = max([0.0, *root[step > 0.0].tolist()])
        high = min([1.0, *root[step < 0.0].tolist()])
        log_a, log_b = math.log(order[a].life), math.log(order[b].life)
        longest = max(longest, *(math.exp(log_a + s * (log_b - log_a)) for s in (low, high)))
    return longest


def _assumption_changes(
    search: PreloadSearch, best: Sequence[PreloadPoint], first: int
) -> list[Change]:
    """Friction and warmth at the recommended preloads, by quick lives."""
    scenes = [
        held_by(search.scene, line.method, one.preload)
        for line, one in zip(search.lines, best, strict=True)
    ]
    now = _log_ratio(best[first].life, best[1 - first].life)
    key, mu = friction_of(search.scene)
    each = []
    if mu > 0.0:
        values = [mu * factor for factor in _FRICTION_FACTORS if mu * factor <= _most(key)]
        each.append(_Tried(key, with_friction, mu, {mu: now}, values))
    if search.scene.thermal is None:
        each.append(_Tried(WARMTH_KEY, with_warm_inner_ring, 0.0, {0.0: now}, _WARMINGS))
    scales: list[float] = []
    while asked := [(one, value) for one in each for value in one.wanted]:
        changed = [one.change(value, scene) for one, value in asked for scene in scenes]
        own = [] if scales else scenes
        answers = search.answers_at(quick_life, [*own, *changed])
        lives = [answer.get("life", math.nan) for answer in answers]
        if not scales:
            quick = zip(best, lives, strict=False)
            scales = [one.life / life if life > 0.0 else 1.0 for one, life in quick]
        pairs = np.reshape(lives[len(own) :], (len(asked), len(scenes))) * scales
        for (one, value), pair in zip(asked, pairs.tolist(), strict=True):
            one.ahead[value] = _log_ratio(pair[first], pair[1 - first])
        for one in each:
            one.wanted = [mid for end in one.brackets for mid in end.middle(one.width)]
    return [*(one.found for one in each), *_groove_change(best, first)]


@dataclass(frozen=True)
class _Bracket:
    """Two values of an assumption, between which an advantage is lost or is not known any more."""

    held: float
    lost: float
    ahead: tuple[float, float]  # at both

    def middle(self, width: float) -> list[float]:
        """The value between them, if they are farther apart than a width."""
        is_wide = abs(self.lost - self.held) > width
        return [0.5 * (self.held + self.lost)] if is_wide else []

    @property
    def root(self) -> float:
        """Where the advantage is lost; NaN where it is not known beyond."""
        held, lost = self.ahead
        if math.isnan(lost):
            return math.nan
        share = held / (held - lost) if math.isfinite(held - lost) else 0.5
        return self.held + share * (self.lost - self.held)


@dataclass
class _Tried:
    """Values of an assumption, and the logarithm of the better method's life over the other's."""

    name: str
    change: Callable[[float, Scene], Scene]
    now: float
    ahead: dict[float, float]
    wanted: Sequence[float]

    @property
    def width(self) -> float:
        """To which the value is found at which an advantage is lost."""
        return _FOUND_TO * (max(self.ahead) - min(self.ahead))

    @property
    def brackets(self) -> list[_Bracket]:
        """Below and above the present value, where there is one."""
        return [one for one in (self._bracket(-1.0), self._bracket(1.0)) if one]

    def _bracket(self, sign: float) -> _Bracket | None:
        order = sorted(value for value in self.ahead if sign * (value - self.now) >= 0.0)
        for a, b in itertools.pairwise(order[:: int(sign)]):
            if not self.ahead[b] > 0.0:
                return _Bracket(a, b, (self.ahead[a], self.ahead[b]))
        return None

    @property
    def found(self) -> Change:
        ends, tried = [], []
        for sign, farthest in ((-1.0, min(self.ahead)), (1.0, max(self.ahead))):
            one = self._bracket(sign)
            ends.append(one.root if one else math.nan)
            tried.append(one.held if one and math.isnan(one.root) else farthest)
        return Change(
            name=self.name, now=self.now, below=ends[0], above=ends[1], tried=(tried[0], tried[1])
        )


def _groove_change(best: Sequence[PreloadPoint], first: int) -> list[Change]:
    """Whether the other method is better with Hertzian grooves: 1 where it is, as a share."""
    lives = [one.values["hertzian_life"] for one in best]
    if not all(one.values.get("groove") for one in best) or not np.isfinite(lives).all():
        return []
    is_other = lives[first] < lives[1 - first]
    return [Change(name=GROOVE_KEY, now=1.0, below=1.0 if is_other else math.nan, tried=(0.0, 1.0))]


def friction_of(scene: Scene) -> tuple[str, float]:
    """The key of the friction of balls on races, and its value."""
    film = scene.friction.film
    if film is not None:
        return SHEAR_KEY, film.shear_strength_MPa
    return FRICTION_KEY, scene.friction.coefficient


def _most(key: str) -> float:
    part = key_of_scene(key)
    assert part is not None
    return float(part.key.ends[1])


def with_friction(value: float, scene: Scene) -> Scene:
    """A scene with another friction of balls on races."""
    return scene.with_({friction_of(scene)[0]: value})


def with_warm_inner_ring(kelvin: float, scene: Scene) -> Scene:
    """A scene whose inner ring alone is warmer."""
    now = temperatures(scene)
    warm = replace(now, inner_ring_C=(now.inner_ring_C or 0.0) + kelvin)
    return replace(scene, temperature=warm)


def quick_life(scene: Scene) -> dict[str, Any]:
    """The shortest quick life of a scene's cases [s]; NaN where one was not solved."""
    return {"life": min((_quick_life(one) for one in cases_that_wear(scene).values()), key=_rank)}


def _rank(life: float) -> float:
    return life if life == life else -math.inf


def _quick_life(scene: Scene) -> float:
    life = worn_life(scene, quick=True) or HertzianLives(scene)(scene)
    return float(life.last.time) if life.status == OK else math.nan
