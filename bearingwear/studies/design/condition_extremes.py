"""The worst limited quantities of a scene in all its conditions: from rest to speed, warm and cold.

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
from bearingwear.scene.slip import at_speed_share
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
"""Relative accuracy of the worst value over speed of a limited quantity."""

NEAR_LIMIT = 0.3
"""Margin of a limit up to which the worst value over speed is looked for between the speeds."""

_MOST_ROUNDS = 10  # of speeds between those already solved
_NEARBY_STEPS = (-0.07, 0.07, -0.15, 0.15)
"""Relative steps to the speeds that are tried in place of one without a state."""

_LEAST_SHARE = 0.01  # of the full speed: as good as at rest

_NARROW = 1e-3  # of the full speed: speeds this close count as the same one
_WIDE, _CLOSE = 0.2, 0.02
"""Shares of the full speed; where a limit is just met or broken, an eighth of them applies.

If three speeds round the worst one span more than `_WIDE`, another speed is solved between them.
The lowest point of a parabola is not solved if it is within `_CLOSE` of the middle speed.
"""

_AT_LIMIT = 0.1  # margin of a limit up to which its worst speed is found more closely
_PEAK_HIDDEN = 0.2  # of the worst value: by how much a peak may exceed the speeds beside it

MEASURE_OF = {name: measure for measure in LIMITED.values() for name in measure.extremes}
"""Limited measures by the names of their extremes."""

KEPT, QUASISTATIC = "preload_kept", "quasi-static"
_DYNAMIC_STIFFNESSES = {"system_axial_stiffness", "axial_stiffness"}

Extremes = dict[str, dict[str, Any]]
"""Worst values by the names of extremes: `value` [SI], and the keys of the condition with it."""

Solve = Callable[[Scene], States]
"""Solves the bearings in one state of wear, in a scene at some speed and temperature."""


class ConditionExtremes(NamedTuple):
    """Extremes in some conditions, or where and how one of these was not solved."""

    extremes: Extremes  # empty if a condition was not solved
    solves: int = 0  # number of conditions that were solved or tried
    status: int = code.OK  # of the condition that was not solved
    unsolved: dict[str, Any] | None = None  # that condition as plain data, with its status


def rotor_frequency(scene: Scene, state: State) -> float:
    """Returns the rotor's lowest natural frequency [Hz].

    It is that in the state, if this contains one, as for two unlike bearings. Otherwise it is that
    of a rotor on two bearings in this state.
    """
    if "lowest_frequency" in state.values:
        return float(state["lowest_frequency"])
    return lowest_frequency(scene, (state, state))


def state_extremes(
    scene: Scene, states: States, where: Mapping[str, Any], with_quasistatic: bool = True
) -> Extremes:
    """Returns the limited quantities that depend on the speed, in one condition.

    Each is that of the worse bearing. `bearing` is its number 1 or 2, or 0 where both have the same
    value, where there is only one bearing, or where it is a value of the rotor.

    states: one for each bearing that is solved.
    where: the condition, as plain data.
    with_quasistatic: whether the quasi-static stiffness counts, as it does at the scene's own speed
        alone. It falls steeply within about 2 % of the speed at which the spin of the balls changes
        from one race to the other, but a machine only passes that speed.
    """
    worse = worse_state(states, scene)
    worse = worse.with_values({"lowest_frequency": rotor_frequency(scene, worse)})
    sides = with_tandem_preload(states, scene) if len(states) == 2 else states
    extremes = {}
    for measure in LIMITED.values():
        if not measure.of_speed:
            continue
        divisor = scene.operation.preload_N if measure.over_preload else 1.0
        for name, variable, kind in zip(
            measure.extremes, measure.variables, measure.kinds, strict=True
        ):
            if kind == QUASISTATIC and not with_quasistatic:
                continue
            value = measure.extreme(worse[variable]) / divisor
            by_side = [measure.extreme(side[variable]) / divisor for side in sides]
            bearing_number = 0  # both have the value, or there is a single one
            if len(by_side) == 2 and by_side[0] != by_side[1] and value in by_side:
                bearing_number = 1 + by_side.index(value)
            extremes[name] = {**where, "bearing": bearing_number, "value": value}
    return extremes


def extremes_of_life(scene: Scene, nodes: Sequence[Node], where: Mapping[str, Any]) -> Extremes:
    """Returns the extremes from the first node of a life to the last one, in one condition.

    NaN at a node between these is left out, as the value lies between those of its neighbours. NaN
    at the first or the last node is the extreme.

    where: the condition, as plain data without the wear.
    """
    extremes_of_nodes = []
    wear_of_nodes = [NEW, *[BETWEEN] * (len(nodes) - 2)]
    if len(nodes) > 1:
        wear_of_nodes.append(AT_END_OF_LIFE)
    for node, wear in zip(nodes, wear_of_nodes, strict=True):
        extremes = state_extremes(scene, node.states, {**where, "wear": wear})
        if wear == BETWEEN:
            extremes = {
                name: extreme
                for name, extreme in extremes.items()
                if not math.isnan(extreme["value"])
            }
        extremes_of_nodes.append(extremes)
    return worst_extremes(extremes_of_nodes)


def worst_extremes(parts: Iterable[Extremes]) -> Extremes:
    """Returns the worst value of each quantity over several conditions, with its condition.

    NaN is worse than any number. Of equal values, the first counts.
    """
    worst: Extremes = {}
    for extremes in parts:
        for name, extreme in extremes.items():
            if name not in worst or _is_worse(name, extreme["value"], worst[name]["value"]):
                worst[name] = extreme
    return worst


def _is_worse(name: str, value: float, other: float) -> bool:
    """Returns whether a value of an extreme is worse than another; NaN is worse than any number.

    name: of the extreme, a key of `MEASURE_OF`.
    """
    if math.isnan(value) or math.isnan(other):
        return math.isnan(value) and not math.isnan(other)
    return value < other if MEASURE_OF[name].falls else abs(value) > abs(other)


class _Unsolved(Exception):
    """A condition was not solved: its status, and where it is, as plain data."""

    def __init__(self, status: int, where: dict[str, Any]):
        super().__init__()
        self.status, self.where = status, where


def new_states(scene: Scene) -> States:
    """Returns the state of each new bearing of a scene."""
    solver = solver_of(scene, tolerance=WELL_BALANCED)
    return solver(solver.bearings.start)


def worn_states(life: Life) -> Solve:
    """Returns a function that solves the bearings as a life left them, in other conditions.

    Worn grooves keep the profiles of the life, wherever the contacts then run in them.
    """
    grooves = life.wearing
    if isinstance(grooves, Grooves):
        worn = life.last.worn
        return lambda scene: grooves.states_elsewhere(scene.symmetric_half, worn)
    conditions = tuple(state.answer.condition._replace(hold=None) for state in life.last.states)
    return lambda scene: solver_of(scene, tolerance=WELL_BALANCED)(conditions)


class OtherConditions(NamedTuple):
    """The conditions beside a scene's own speed in which limits apply."""

    scene: Scene
    limits: Mapping[str, float]  # by the keys of `LIMITED`
    quick: bool  # whether the worst speed is looked for near a limit only, see `NEAR_LIMIT`

    def extremes(self, at_speed: Extremes, solve: Solve, wear: str) -> ConditionExtremes:
        """Returns the extremes of bearings in one state of wear in all conditions.

        If a condition is not solved, the answer has its status and plain data, but no extremes. A
        bearing that carries nothing is no such failure: the share of its preload that is kept is 0.

        at_speed: extremes at the scene's own speed, which are included.
        solve: solves the bearings in that state of wear.
        wear: of `NEW`, `BETWEEN`, `AT_END_OF_LIFE`.
        """
        search = _ConditionSearch(self.scene, solve, wear, {1.0: at_speed})
        shares = SPEED_SHARES if self.quick or wear == NEW else FINE_SHARES
        try:
            self._search(search, shares)
        except _Unsolved as unsolved:
            return ConditionExtremes({}, search.solves, unsolved.status, unsolved.where)
        parts = [*search.by_share.values(), *search.cold]
        return ConditionExtremes(worst_extremes(parts), search.solves)

    def _search(self, search: _ConditionSearch, shares: Sequence[float]) -> None:
        """Solves lower speeds, those between where a value may be worse, and the cold conditions.

        It ends where some bearing carries nothing, which breaks a limit by itself. Raises _Unsolved
        where neither another condition nor a speed beside it is solved.

        search: collects the extremes.
        shares: of the way from the lowest speed to the full one.
        """
        for share in lower_speed_shares(self.scene, shares):
            if search.is_unloaded:
                return
            search.add_share(share)
        for _ in range(_MOST_ROUNDS):
            between = [
                share
                for share in self._worse_shares(search.by_share)
                if all(abs(share - unsolved) > _NARROW for unsolved in search.unsolved_shares)
            ]
            if search.is_unloaded or not between:
                break
            for share in between:
                search.add_share(share)
        for condition in cold_conditions(self.scene):
            if not search.is_unloaded:
                search.add_cold(condition)

    def _worse_shares(self, by_share: Mapping[float, Extremes]) -> list[float]:
        """Returns shares of the full speed at which a limited quantity may be worse than known.

        by_share: extremes at the shares that were solved.
        """
        near = NEAR_LIMIT if self.quick else math.inf
        worse_shares = set()
        for key, limit in self.limits.items():
            measure = LIMITED[key]
            if not measure.of_speed:
                continue
            for name in measure.extremes:
                values = {
                    share: extremes[name]["value"]
                    for share, extremes in sorted(by_share.items())
                    if name in extremes and math.isfinite(extremes[name]["value"])
                }
                share = _worse_share(measure, values, near, limit)
                if share is not None:
                    worse_shares.add(max(share, lowest_share(self.scene)))
        return sorted(worse_shares - set(by_share))


@dataclass
class _ConditionSearch:
    """Extremes of the bearings in one state of wear, in one condition after another."""

    scene: Scene
    solve: Solve
    wear: str  # of `NEW`, `BETWEEN`, `AT_END_OF_LIFE`
    by_share: dict[float, Extremes]  # by shares of the full speed
    cold: list[Extremes] = field(default_factory=list)  # at mounting temperature
    solves: int = 0
    unsolved_shares: list[float] = field(default_factory=list)
    is_unloaded: bool = False  # whether some bearing carries nothing in a condition

    def add_share(self, share: float) -> None:
        """Adds the extremes at a share of the full speed, or next to it if there is no state at it.

        There may be none where the motion of the balls changes; a speed beside then stands for it.
        Raises _Unsolved if no such speed is solved either, unless some bearing carries nothing:
        then no preload is kept, and `is_unloaded` is set.
        """
        answer = self._extremes_at_share(share)
        if answer.status == code.OK:
            return
        self.unsolved_shares.append(share)
        if answer.status not in UNLOADED:
            nearby = (max(share * (1.0 + step), _LEAST_SHARE) for step in _NEARBY_STEPS)
            for near in dict.fromkeys(nearby):  # without repeats
                if self._extremes_at_share(near).status == code.OK:
                    return
        # raises _Unsolved unless some bearing carries nothing
        self.by_share[share] = self._unloaded_extremes(answer)

    def _extremes_at_share(self, share: float) -> ConditionExtremes:
        """Returns the extremes at a share of the full speed; keeps them in `by_share` if solved."""
        answer = self._extremes_in(OperatingCondition(at_speed_share(self.scene, share)))
        if answer.status == code.OK:
            self.by_share[share] = answer.extremes
        return answer

    def add_cold(self, condition: OperatingCondition) -> None:
        """Adds the extremes in a condition at mounting temperature to `cold`.

        Raises _Unsolved if it is not solved, unless some bearing carries nothing: then no preload
        is kept, and `is_unloaded` is set.
        """
        answer = self._extremes_in(condition)
        is_solved = answer.status == code.OK
        self.cold.append(answer.extremes if is_solved else self._unloaded_extremes(answer))

    def _extremes_in(self, condition: OperatingCondition) -> ConditionExtremes:
        """Returns the extremes in one condition, or how it was not solved; counts the solve."""
        where = condition.where(wear=self.wear)
        self.solves += 1
        states = self.solve(condition.scene)
        status = next((state.status for state in states if state.status != code.OK), code.OK)
        if status == code.OK:
            extremes = state_extremes(condition.scene, states, where, with_quasistatic=False)
            return ConditionExtremes(_without_unknown_stiffness(extremes))
        return ConditionExtremes({}, 1, status, where | {"status": code.STATUS_NAMES[status]})

    def _unloaded_extremes(self, answer: ConditionExtremes) -> Extremes:
        """Returns the extremes where some bearing carries nothing: its share of preload kept is 0.

        Sets `is_unloaded`. Raises _Unsolved where the condition failed for another reason.
        """
        assert answer.unsolved is not None
        if answer.status not in UNLOADED:
            raise _Unsolved(answer.status, answer.unsolved)
        self.is_unloaded = True
        return {KEPT: answer.unsolved | {"value": 0.0}}


def _without_unknown_stiffness(extremes: Extremes) -> Extremes:
    """Returns extremes without a dynamic stiffness that is not known.

    It is NaN at a speed where the motion of the balls changes, but not at speeds beside it.
    """
    return {
        name: extreme
        for name, extreme in extremes.items()
        if name not in _DYNAMIC_STIFFNESSES or not math.isnan(extreme["value"])
    }


class _LowestPoint(NamedTuple):
    """The lowest point of a parabola."""

    x: float
    y: float


def _worse_share(
    measure: Measure, values: Mapping[float, float], near: float, limit: float
) -> float | None:
    """Returns the share of the full speed at which a value should be solved next, or None.

    It is where a parabola through three neighbours is worse than all known values, by more than
    `SPEED_FOUND_TO`. Otherwise it is beside a bad value whose neighbours are far from each other,
    or, at a limit, where a flank of the worst value leads to a worse one. None for fewer than three
    values, for a worst margin above `near`, or without such a place.

    values: of an extreme of the measure [SI], by shares, which rise.
    near: largest magnitude of the relative margin at which a share is looked for.
    limit: of the measure, in the unit of its key.
    """
    if len(values) < 3:
        return None
    # the worst is the lowest point of y over x
    sign = 1.0 if measure.falls else -1.0
    x = np.array([*values])
    y = sign * np.array([value if measure.falls else abs(value) for value in values.values()])
    least = y.min()
    margin = abs(measure.margin(sign * least, limit))
    if margin > near:
        return None
    lowest = [_lowest_point(x[k - 1 : k + 2], y[k - 1 : k + 2]) for k in range(1, len(x) - 1)]
    new_points = [point for point in lowest if point and np.abs(point.x - x).min() > _NARROW]
    best = min(new_points, key=lambda point: point.y, default=_LowestPoint(math.nan, math.inf))
    if best.y < least - SPEED_FOUND_TO * abs(least):
        return best.x
    if margin > _AT_LIMIT:
        return _share_in_wide_gap(x, y, lowest, _WIDE, _CLOSE)
    share = _share_in_wide_gap(x, y, lowest, _WIDE / 8.0, _CLOSE / 8.0)
    return share if share is not None else _share_beyond_flank(x, y)


def _share_in_wide_gap(
    x: np.ndarray, y: np.ndarray, lowest: Sequence[_LowestPoint | None], wide: float, close: float
) -> float | None:
    """Returns a place beside one of the lowest values whose neighbours are far from each other.

    Neighbours so far away say little of what is between them. None if no such value is left.

    x, y: (n,) places, rising, and values; lower ones are worse.
    lowest: (n - 2) lowest points of the parabolas through three neighbours.
    wide: largest distance between neighbours that are not far from each other, at places that may
        hide the lowest value; at others, it is `_WIDE`.
    close: distance from a place within which the lowest point beside it is not returned.
    """
    worst = int(np.argmin(y))
    if worst == len(x) - 1 and x[worst] - x[worst - 1] > wide:
        return float(0.5 * (x[worst - 1] + x[worst]))  # it may turn just below the full speed
    for k in _low_places(y):
        may_hide_worst = k == worst or _extrapolated_low(y, k) < y.min()
        if x[k + 1] - x[k - 1] <= (wide if may_hide_worst else _WIDE):
            continue
        point = lowest[k - 1]
        if point and abs(point.x - x[k]) > close:
            return point.x
        left = x[k] - x[k - 1]
        right = x[k + 1] - x[k]
        return float(x[k] - 0.5 * left if left > right else x[k] + 0.5 * right)
    return None


def _share_beyond_flank(x: np.ndarray, y: np.ndarray) -> float | None:
    """Returns the middle between the lowest value and a neighbour, if a flank leads lower there.

    A value that jumps, as slip does where control changes to the other race, is worst just beside
    the jump, which no parabola finds. None if neither flank leads lower by more than
    `SPEED_FOUND_TO` of the lowest value.

    x, y: (n,) places, rising, and values; lower ones are worse.
    """
    k = int(np.argmin(y))
    if not 0 < k < len(x) - 1:
        return None
    for flank, neighbour in ((k - 1, k + 1), (k + 1, k - 1)):
        step = 0.5 * (x[neighbour] - x[k])
        slope = (y[k] - y[flank]) / (x[k] - x[flank])
        if abs(step) > _NARROW and slope * step < -SPEED_FOUND_TO * abs(y[k]):
            return float(x[k] + step)
    return None


def _low_places(y: np.ndarray) -> list[int]:
    """Returns indices of inner places near which the lowest value may be hidden, lowest first.

    Their values are not above those of their neighbours, and within a fifth of the lowest value, or
    have a steeper flank that leads below it.

    y: values (n,).
    """
    least = y.min()
    nearly_least = least + _PEAK_HIDDEN * abs(least)
    places = [
        k
        for k in range(1, len(y) - 1)
        if y[k] <= min(y[k - 1], y[k + 1])
        and (y[k] <= nearly_least or _extrapolated_low(y, k) < least)
    ]
    return sorted(places, key=lambda k: y[k])


def _extrapolated_low(y: np.ndarray, k: int) -> float:
    """Returns the value at place k, less half of its distance from the higher neighbour.

    A low point beside the place reaches it if its steeper flank goes on for half a step.
    """
    return float(y[k] - 0.5 * (max(y[k - 1], y[k + 1]) - y[k]))


def _lowest_point(x: np.ndarray, y: np.ndarray) -> _LowestPoint | None:
    """Returns the lowest point of a parabola through three points.

    None if the parabola does not bend upwards, or if its lowest point is not between the outer two.

    x, y: coordinates of the points, x rising (3,).
    """
    x0, x1, x2 = x.tolist()
    y0, y1, y2 = y.tolist()
    first_slope = (y1 - y0) / (x1 - x0)
    second_slope = (y2 - y1) / (x2 - x1)
    bend = (second_slope - first_slope) / (x2 - x0)  # second coefficient of Newton's form
    if not bend > 0.0:
        return None
    place = 0.5 * (x0 + x1 - first_slope / bend)
    value = y0 + first_slope * (place - x0) + bend * (place - x0) * (place - x1)
    return _LowestPoint(place, value) if x0 < place < x2 else None
