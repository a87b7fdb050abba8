"""Ways to wear over a duty: one state of wear, and the states of all conditions of a cycle with it.

The wear of a cycle is the mean of what wears in each phase and on the way to its speed.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.duty.cycle import Cycle
from bearingwear.lives.ends import Criteria
from bearingwear.lives.follow import Node
from bearingwear.lives.grooves import EXACT_GROOVES, GrooveMode, Grooves, StiffGrooves, Wears
from bearingwear.lives.surfaces import Surfaces
from bearingwear.solvers.compose import Remembered
from bearingwear.solvers.condition import States
from bearingwear.solvers.worn.depths import WornDepths


class DutyCriteria(Criteria):
    """End-of-life criteria in every phase of a duty."""

    def __init__(self, cycle: Cycle):
        self.each = [Criteria(one) for one in cycle.scenes[: len(cycle.cases)]]

    def margins(self, states: Sequence[Any]) -> np.ndarray:
        """Margins of the nearest phase to each criterion; ramps have none."""
        found: np.ndarray = np.min(self.of_cases(states), axis=0)
        return found

    def of_cases(self, states: Sequence[Any]) -> list[np.ndarray]:
        """Margins of each case."""
        count = len(self.each[0].preloads_N)
        parts = (states[k * count : (k + 1) * count] for k in range(len(self.each)))
        return [one.margins(part) for one, part in zip(self.each, parts, strict=True)]


class _Mixed:
    """What the ways to wear over a duty have in common: a way for each condition of its cycle."""

    cycle: Cycle
    each: Sequence[Any]

    def nodes(self, node: Node) -> list[Node]:
        """A node of each condition."""
        n = self.cycle.bearings
        parts = (node.states[k * n : (k + 1) * n] for k in range(len(self.each)))
        return [node._replace(states=part) for part in parts]

    def states_by(self, solve: Callable[[Any], States]) -> States:
        """States of the conditions, up to the first that is not solved."""
        found: list[Any] = []
        for way in self.each:
            found += solve(way)
            if any(state.status != code.OK for state in found[-self.cycle.bearings :]):
                break
        return tuple(found)

    def weighted(self, node: Node) -> list[tuple[float, Any, Node]]:
        """Share, way and node of each condition."""
        return [*zip(self.cycle.shares.tolist(), self.each, self.nodes(node), strict=True)]


class DutySurfaces(_Mixed):
    """Bearings whose contacts stay Hertzian, over a duty."""

    def __init__(self, cycle: Cycle, solvers: Sequence[Remembered]):
        self.cycle = cycle
        self.each = [
            Surfaces(one.one_of_alike, states)
            for one, states in zip(cycle.scenes, solvers, strict=True)
        ]
        first = self.each[0]
        for other in self.each[1:]:
            for own, shared in zip(other.each, first.each, strict=True):
                own.coating = shared.coating  # the same films wear in all phases
        self.start, self.origin, self.range = first.start, first.origin, first.range

    def state(self, worn: np.ndarray) -> States:
        return self.states_by(lambda way: way.state(worn))

    def rates(self, node: Node) -> np.ndarray:
        rates: np.ndarray = sum(share * way.rates(one) for share, way, one in self.weighted(node))
        return rates

    def loss_rate(self, node: Node) -> float:
        """Sum of the mean rates at which the bearings lose, as counted [m/s]."""
        return float(sum(share * way.loss_rate(one) for share, way, one in self.weighted(node)))

    def wears(self, node: Node) -> bool:
        rates = [
            [share * state.rate for state in one.states] for share, _, one in self.weighted(node)
        ]
        return bool(np.sum(rates, axis=0).min() > 0.0)

    def events(self, node: Node) -> np.ndarray:
        events: np.ndarray = self.each[0].events(self.nodes(node)[0])
        return events

    def passes(self, event: int, node: Node) -> bool:
        return bool(self.each[0].passes(event, self.nodes(node)[0]))


class DutyGrooves(_Mixed, Grooves):
    """Bearings whose grooves are followed as they wear, over a duty.

    The grids lie on the grooves as in the case with the largest contact.
    """

    def __init__(
        self, cycle: Cycle, mode: GrooveMode = EXACT_GROOVES, kind: type[Grooves] = StiffGrooves
    ):
        self.cycle, self.mode = cycle, mode
        # on the way to a speed, nobody asks for stiffnesses
        count = len(cycle.cases)
        self.each = [kind(one, mode) for one in cycle.scenes[:count]]
        self.each += [Grooves(one, mode) for one in cycle.scenes[count:]]
        self.scene = self.each[0].scene
        self.status = next((one.status for one in self.each if one.status != code.OK), code.OK)
        self.sides = tuple(side for one in self.each for side in one.sides)
        self.start: Wears = ()
        if self.status == code.OK:
            widest = max(self.each, key=lambda one: one.sides[0].bearing.major.sum())
            for other in self.each:
                if other is not widest:
                    for own, shared in zip(other.sides, widest.sides, strict=True):
                        own.bearing.lie_on(shared.bearing)
            self.start = widest.start

    @property
    def solves(self) -> int:  # type: ignore[override]
        return sum(one.solves for one in self.each)

    def nodes(self, node: Node) -> list[Node]:
        """A node of each condition, with the states that its way knows as the last ones."""
        return [
            one._replace(states=way.last) if _are_same(way.last, one.states) else one
            for way, one in zip(self.each, super().nodes(node), strict=True)
        ]

    def state(self, worn: Wears) -> States:
        if self.status != code.OK:
            return self.states_by(lambda way: way.new_states())
        return self.states_by(lambda way: way.state(worn))

    def middle_state(self, worn: Wears) -> States:
        return self.states_by(lambda way: way.middle_state(worn))

    def completed(self, node: Node) -> Node:
        if node.status != code.OK:
            return node
        found: list[Any] = []
        for way, one in zip(self.each, self.nodes(node), strict=True):
            done = way.completed(one)
            found += done.states
            if done.status != code.OK:
                break
        return node._replace(states=tuple(found))

    def rates(self, node: Node) -> Wears:
        each = self.weighted(node)
        mean = [WornDepths(0.0, 0.0 * w.grooves) for w in self.start]
        for share, way, one in each:
            rates = way.rates(one)
            mean = [total.plus(share, rate) for total, rate in zip(mean, rates, strict=True)]
        return tuple(mean)

    def start_ahead(self, before: Node, now: Node, share: float) -> None:
        for way, *nodes in zip(self.each, self.nodes(before), self.nodes(now), strict=True):
            way.start_ahead(*nodes, share)

    def longest_step(self, now: Node, rates: Wears) -> float:
        each = zip(self.each, self.nodes(now), strict=True)
        return min(way.longest_step(one, rates) for way, one in each)

    def bares(self, before: Node, now: Node) -> bool:
        return bool(self.each[0].bares(before, now))

    def wears(self, node: Node) -> bool:
        return any(way.wears(one) for way, one in zip(self.each, self.nodes(node), strict=True))

    def events(self, node: Node) -> np.ndarray:
        each = zip(self.each, self.nodes(node), strict=True)
        return np.min([way.events(one) for way, one in each], axis=0, keepdims=True)[0]


def _are_same(some: Sequence[Any], others: Sequence[Any]) -> bool:
    pairs = zip(some, others, strict=False)
    return len(some) == len(others) and all(a is b for a, b in pairs)
