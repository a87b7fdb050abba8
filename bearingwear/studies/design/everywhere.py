"""Limited quantities of a scene wherever it runs: from rest to its speed, warm and cold.

Theory: docs/theory.md, section 14.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.follow import Life, Node
from bearingwear.lives.grooves import Grooves
from bearingwear.lives.many import with_tandem_preload, worse_state
from bearingwear.measures import LIMITED, Measure
from bearingwear.scene.scene import Scene
from bearingwear.scene.slip import at_share
from bearingwear.solvers.bearing.arrangement import lowest_frequency
from bearingwear.solvers.compose import WELL_BALANCED, solver_of
from bearingwear.solvers.condition import States
from bearingwear.solvers.state import State
from bearingwear.studies.design.conditions import (
    AT_END_OF_LIFE,
    BETWEEN,
    FINE_SHARES,
    NEW,
    SPEED_SHARES,
    OperatingCondition,
    cold_conditions,
    lower_speed_shares,
    lowest_share,
)

UNLOADED = (code.CONTACT_LOST, code.PRELOAD_GONE, code.LIFTED_OFF, code.RACE_UNSEATED)
"""Statuses of bearings of which one carries nothing."""

SPEED_FOUND_TO = 2e-3
"""Relative: how well the worst value over speed is found of what is limited."""

NEAR_LIMIT = 0.3
"""Margin of a limit up to which the worst value over speed is looked for between the speeds."""

_MOST_BETWEEN = 6  # speeds, of a quantity
_MOVES, _AS_SLOW = (-0.07, 0.07, -0.15, 0.15), 0.01
"""By how much a speed is moved where there is no state at it, over it, and how slow is as good as
at rest, over the full speed."""

_NARROW = 1e-3  # of the full speed: speeds so close are one
_WIDE, _CLOSE = 0.2, 0.02
"""Of the full speed: a span of three speeds round the worst that is halved, and what is no half;
an eighth of both where a limit is just met or broken."""

_AT_LIMIT = 0.1  # margin of a limit, up to which its place is found more closely
_PEAK_HIDDEN = 0.2  # of the worst value: by how much a peak may exceed the speeds beside it

MEASURE_OF = {name: one for one in LIMITED.values() for name in one.extremes}
"""Limited measures by the names of their extremes."""

KEPT, QUASISTATIC = "preload_kept", "quasi-static"

Extremes = dict[str, dict[str, Any]]
"""Of quantities by the names of extremes: `value` [SI], and the condition in which that is."""


class OtherSpeeds(NamedTuple):
    """Extremes at other speeds and temperatures, or where and how they were not solved."""

    extremes: Extremes
    solves: int = 0
    status: int = code.OK
    unsolved: dict[str, Any] | None = None


def frequency(scene: Scene, state: State) -> float:
    """Lowest frequency from a state that has it, or from one that stands for both bearings."""
    if "lowest_frequency" in state.values:
        return float(state["lowest_frequency"])
    return lowest_frequency(scene, (state, state))


def state_extremes(
    scene: Scene, states: States, where: Mapping[str, Any], own: bool = True
) -> Extremes:
    """Limited quantities of bearings in one state, but those at rest by themselves.

    own: whether that is at the scene's own speed. Elsewhere no quasi-static stiffness counts: it
        falls far where the spin of the balls goes over from one race to the other, within some 2 %
        of a speed, which a machine passes.
    """
    worse = worse_state(states, scene)
    worse = worse.with_values({"lowest_frequency": frequency(scene, worse)})
    sides = with_tandem_preload(states, scene) if len(states) == 2 else states
    found = {}
    for one in LIMITED.values():
        if not one.of_speed:
            continue
        for name, variable, kind in zip(one.extremes, one.variables, one.kinds, strict=True):
            if kind == QUASISTATIC and not own:
                continue
            whole = scene.operation.preload_N if one.over_preload else 1.0
            value = one.extreme(worse[variable]) / whole
            each = [one.extreme(side[variable]) / whole for side in sides]
            bearing = 0
            if len(each) == 2 and each[0] != each[1] and value in each:
                bearing = 1 + each.index(value)
            found[name] = {**where, "bearing": bearing, "value": value}
    return found


def along(scene: Scene, nodes: Sequence[Node], where: Mapping[str, Any]) -> Extremes:
    """Limited quantities from the first node of a life to the last one; what is not known of a node
    between them is between what is known of others.
    """
    last = len(nodes) - 1
    each = []
    for k, node in enumerate(nodes):
        wear = NEW if k == 0 else AT_END_OF_LIFE if k == last else BETWEEN
        found = state_extremes(scene, node.states, {**where, "wear": wear})
        if wear == BETWEEN:
            found = {name: one for name, one in found.items() if not math.isnan(one["value"])}
        each.append(found)
    return merged(each)


def merged(each: Iterable[Extremes]) -> Extremes:
    """The worst of each quantity."""
    found: Extremes = {}
    for extremes in each:
        for name, one in extremes.items():
            if name not in found or _is_worse(MEASURE_OF[name], one["value"], found[name]["value"]):
                found[name] = one
    return found


def _is_worse(measure: Measure, value: float, other: float) -> bool:
    """Whether a value is worse than another, as one is that is not known."""
    if math.isnan(value) or math.isnan(other):
        return math.isnan(value) and not math.isnan(other)
    return value < other if measure.falls else abs(value) > abs(other)


class _Unsolved(Exception):
    """A condition was not solved."""

    def __init__(self, status: int, where: dict[str, Any]):
        super().__init__()
        self.status, self.where = status, where


Solve = Callable[[Scene], States]


def new_states(scene: Scene) -> States:
    """Bearings as they are when new."""
    solver = solver_of(scene, tolerance=WELL_BALANCED)
    return solver(solver.bearings.start)


def worn_states(life: Life) -> Solve:
    """Function from a scene, at another speed or temperature, to the bearings as a life left them.

    Worn grooves are those of the life, wherever the contacts then run in them.
    """
    wearing, last = life.wearing, life.last
    if isinstance(wearing, Grooves):
        return lambda scene: wearing.states_elsewhere(scene.one_of_alike, last.worn)
    conditions = tuple(state.answer.condition._replace(hold=None) for state in last.states)
    return lambda scene: solver_of(scene, tolerance=WELL_BALANCED)(conditions)


class Everywhere(NamedTuple):
    """What limits look at beside a scene's own speed."""

    scene: Scene
    limits: Mapping[str, float]
    exactly: bool  # whether the worst speed is looked for however far a limit is

    def beside(self, own: Extremes, solve: Solve, wear: str) -> OtherSpeeds:
        """Extremes of the bearings in one state of wear, from those at the scene's own speed."""
        found = _Speeds(self, solve, wear, {1.0: own})
        try:
            shares = FINE_SHARES if self.exactly and wear != NEW else SPEED_SHARES
            for share in lower_speed_shares(self.scene, shares):
                if found.is_lost:
                    break
                found.add(share)
            for _ in range(_MOST_BETWEEN):
                between = [
                    share
                    for share in self._between(found.known)
                    if all(abs(share - missed) > _NARROW for missed in found.missed)
                ]
                if found.is_lost or not between:
                    break
                for share in between:
                    found.add(share)
            for place in cold_conditions(self.scene):
                if not found.is_lost:
                    found.add_place(place)
        except _Unsolved as lost:
            return OtherSpeeds({}, found.solves, lost.status, lost.where)
        return OtherSpeeds(merged([*found.known.values(), *found.others]), found.solves)

    def _between(self, speeds: Mapping[float, Extremes]) -> list[float]:
        """Speeds at which a limited quantity may be worse than at those known."""
        shares = sorted(speeds)
        found = set()
        for key, limit in self.limits.items():
            one = LIMITED[key]
            if not one.of_speed:
                continue
            for name in one.extremes:
                known = [
                    (share, speeds[share][name]["value"])
                    for share in shares
                    if name in speeds[share] and math.isfinite(speeds[share][name]["value"])
                ]
                share = _turn(one, known, math.inf if self.exactly else NEAR_LIMIT, limit)
                if share is not None:
                    found.add(max(share, lowest_share(self.scene)))
        return sorted(found - set(speeds))


@dataclass
class _Speeds:
    """Extremes of the bearings in one state of wear at speeds and elsewhere, one after another."""

    of: Everywhere
    solve: Solve
    wear: str
    known: dict[float, Extremes]  # by shares of the full speed
    others: list[Extremes] = field(default_factory=list)
    solves: int = 0
    missed: list[float] = field(default_factory=list)  # shares without a state
    is_lost: bool = False  # whether some bearing carries nothing somewhere, which is enough to know

    def add(self, share: float) -> None:
        """Solve at a share of the full speed, or next to it where there is no state at that.

        The speeds are as good as those beside them; at some the motion goes over to another one.
        """
        first = self._at_share(share)
        if first.status == code.OK:
            return
        self.missed.append(share)
        if first.status not in UNLOADED:
            nearby = (max(share * (1.0 + move), _AS_SLOW) for move in _MOVES)
            if any(self._at_share(near).status == code.OK for near in dict.fromkeys(nearby)):
                return
        self.known[share] = self._without(first)

    def _at_share(self, share: float) -> OtherSpeeds:
        """Extremes at a share of the full speed, which are kept if it was solved."""
        found = self.at(OperatingCondition(at_share(self.of.scene, share)))
        if found.status == code.OK:
            self.known[share] = found.extremes
        return found

    def add_place(self, place: OperatingCondition) -> None:
        """Solve at a speed and a temperature."""
        found = self.at(place)
        self.others.append(found.extremes if found.status == code.OK else self._without(found))

    def at(self, place: OperatingCondition) -> OtherSpeeds:
        """Extremes at one speed and temperature, or how they were not solved."""
        where = place.where(wear=self.wear)
        self.solves += 1
        states = self.solve(place.scene)
        status = next((state.status for state in states if state.status != code.OK), code.OK)
        if status == code.OK:
            return OtherSpeeds(state_extremes(place.scene, states, where, own=False))
        return OtherSpeeds({}, 1, status, where | {"status": code.STATUS_NAMES[status]})

    def _without(self, found: OtherSpeeds) -> Extremes:
        """Extremes where some bearing carries nothing. Raises where that is not why."""
        assert found.unsolved is not None
        if found.status not in UNLOADED:
            raise _Unsolved(found.status, found.unsolved)
        self.is_lost = True
        return {KEPT: found.unsolved | {"value": 0.0}}


def _turn(
    one: Measure, known: Sequence[tuple[float, float]], near: float, limit: float
) -> float | None:
    """The share of the speed at which a parabola through three neighbours is worst, if it says
    that a quantity is worse there than anywhere known, by more than `SPEED_FOUND_TO`, or if they
    are far from each other and it is nearly as bad; None where the worst is found.
    """
    if len(known) < 3:
        return None
    sign = 1.0 if one.falls else -1.0
    x = np.array([share for share, _ in known])
    y = sign * np.array([value if one.falls else abs(value) for _, value in known])
    least = y.min()
    margin = abs(one.margin(sign * least, limit))
    if margin > near:
        return None
    wide, close = (_WIDE, _CLOSE) if margin > _AT_LIMIT else (_WIDE / 8.0, _CLOSE / 8.0)
    turns = [_vertex(x[k - 1 : k + 2], y[k - 1 : k + 2]) for k in range(1, len(x) - 1)]
    new = [turn for turn in turns if turn and np.abs(turn[0] - x).min() > _NARROW]
    place, value = min(new, key=lambda turn: turn[1], default=(math.nan, math.inf))
    if value < least - SPEED_FOUND_TO * abs(least):
        return place
    worst = int(np.argmin(y))
    if worst == len(x) - 1 and x[worst] - x[worst - 1] > wide:
        return float(0.5 * (x[worst - 1] + x[worst]))  # it may turn just below the full speed
    for k in _peaks(y):
        if x[k + 1] - x[k - 1] <= (wide if k == worst else _WIDE):
            continue
        # neighbours so far away say little of what is between them
        turn = turns[k - 1]
        if turn and abs(turn[0] - x[k]) > close:
            return turn[0]
        left, right = x[k] - x[k - 1], x[k + 1] - x[k]
        return float(x[k] - 0.5 * left if left > right else x[k] + 0.5 * right)
    return None


def _peaks(y: np.ndarray) -> list[int]:
    """Returns the inner places that are worse than both neighbours and nearly the worst of all, the
    worst first.

    A peak between speeds far from each other may be a fifth higher than the one that is known.
    """
    near_worst = y.min() + _PEAK_HIDDEN * abs(y.min())
    peaks = [k for k in range(1, len(y) - 1) if y[k] <= min(y[k - 1], y[k + 1], near_worst)]
    return sorted(peaks, key=lambda k: y[k])


def _vertex(x: np.ndarray, y: np.ndarray) -> tuple[float, float] | None:
    """Place and value of the lowest point of a parabola through three, if that is between them."""
    (a, b, c), (f, g, h) = x.tolist(), y.tolist()
    first, second = (g - f) / (b - a), (h - g) / (c - b)
    bend = (second - first) / (c - a)
    if not bend > 0.0:
        return None
    place = 0.5 * (a + b - first / bend)
    value = f + first * (place - a) + bend * (place - a) * (place - b)
    return (place, value) if a < place < c else None
