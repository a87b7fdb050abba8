"""Ways to wear over a duty: one state of wear, and the states of all conditions of a cycle with it.

The wear of a cycle is the mean of what wears in each phase and on the way to its speed.
"""

import operator
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

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
        self.criteria = [Criteria(scene) for scene in cycle.case_scenes]

    def margins(self, states: Sequence[Any]) -> np.ndarray:
        """Returns the margin of the nearest case to each criterion; ramps have none (n,).

        states: of the bearings, in each condition of the cycle one after the other.
        """
        margins: np.ndarray = np.min(self.margins_by_case(states), axis=0)
        return margins

    def margins_by_case(self, states: Sequence[Any]) -> list[np.ndarray]:
        """Returns the margins to each criterion in each case, as `Criteria.margins`."""
        n = len(self.criteria[0].preloads_N)  # of bearings in each condition
        return [
            criteria.margins(states[k * n : (k + 1) * n])
            for k, criteria in enumerate(self.criteria)
        ]


class _WeightedNode(NamedTuple):
    """A condition of a cycle in one node of a life."""

    share: float  # of the condition, in the mean over a cycle
    way: Any  # to wear in the condition
    node: Node  # with the states of the condition alone


class _DutyWear:
    """The common part of both ways to wear over a duty.

    ways: the way to wear of each condition of the cycle, `Surfaces` or `Grooves`.
    """

    cycle: Cycle
    ways: Sequence[Any]

    def nodes(self, node: Node) -> list[Node]:
        """Returns a node for each condition, with the states of this condition alone."""
        n = self.cycle.bearings
        return [
            node._replace(states=node.states[k * n : (k + 1) * n]) for k in range(len(self.ways))
        ]

    def states_by(self, solve: Callable[[Any], States]) -> States:
        """Returns the states of all conditions in one sequence, up to the first that is not solved.

        solve: returns the states of one condition by its way to wear.
        """
        states: list[Any] = []
        for way in self.ways:
            states += solve(way)
            if any(state.status != code.OK for state in states[-self.cycle.bearings :]):
                break
        return tuple(states)

    def weighted(self, node: Node) -> list[_WeightedNode]:
        """Returns the share, the way to wear and the node of each condition."""
        shares = self.cycle.shares.tolist()
        return [
            _WeightedNode(share=share, way=way, node=part)
            for share, way, part in zip(shares, self.ways, self.nodes(node), strict=True)
        ]


class DutySurfaces(_DutyWear):
    """A way to wear over a duty: bearings whose contacts stay Hertzian."""

    def __init__(self, cycle: Cycle, solvers: Sequence[Remembered]):
        self.cycle = cycle
        self.ways = [
            Surfaces(scene.symmetric_half, solver)
            for scene, solver in zip(cycle.scenes, solvers, strict=True)
        ]
        first = self.ways[0]
        for way in self.ways[1:]:
            for bearing, shared in zip(way.bearings, first.bearings, strict=True):
                bearing.coating = shared.coating  # the same films wear in all phases
        self.start, self.origin, self.range = first.start, first.origin, first.range

    def state(self, worn: np.ndarray) -> States:
        """Returns the states with some wear in all conditions, see `states_by`."""
        return self.states_by(lambda way: way.state(worn))

    def rates(self, node: Node) -> np.ndarray:
        """Returns the mean wear per second over a cycle."""
        conditions = self.weighted(node)
        rates: np.ndarray = sum(part.share * part.way.rates(part.node) for part in conditions)
        return rates

    def loss_rate(self, node: Node) -> float:
        """Returns the sum of the rates of loss of all bearings, as the mean over a cycle [m/s]."""
        conditions = self.weighted(node)
        return float(sum(part.share * part.way.loss_rate(part.node) for part in conditions))

    def wears(self, node: Node) -> bool:
        """Returns whether all bearings lose diameter in the mean over a cycle."""
        rates = [
            [part.share * state.rate for state in part.node.states] for part in self.weighted(node)
        ]
        return bool(np.sum(rates, axis=0).min() > 0.0)

    def events(self, node: Node) -> np.ndarray:
        """Returns the shares left of the largest loss and of films, as `Surfaces.events` [1].

        They are those of the first condition, as wear and films are the same in all.
        """
        events: np.ndarray = self.ways[0].events(self.nodes(node)[0])
        return events

    def pass_event(self, event: int, node: Node) -> bool:
        """Removes a film that is gone; returns False where the largest loss is reached."""
        return bool(self.ways[0].pass_event(event, self.nodes(node)[0]))


class DutyGrooves(_DutyWear, Grooves):
    """A way to wear over a duty: bearings whose grooves are followed as they wear.

    The grids lie on the grooves as in the case with the largest contact.
    """

    def __init__(
        self, cycle: Cycle, mode: GrooveMode = EXACT_GROOVES, kind: type[Grooves] = StiffGrooves
    ):
        self.cycle, self.mode = cycle, mode
        # stiffnesses are not needed on the way to a speed
        self.ways = [kind(scene, mode) for scene in cycle.case_scenes]
        self.ways += [Grooves(scene, mode) for scene in cycle.scenes[len(cycle.cases) :]]
        self.scene = self.ways[0].scene
        self.status = next((way.status for way in self.ways if way.status != code.OK), code.OK)
        self.sides = tuple(side for way in self.ways for side in way.sides)
        self.start: Wears = ()
        if self.status == code.OK:
            widest = max(self.ways, key=lambda way: way.sides[0].bearing.major.sum())
            for way in self.ways:
                if way is not widest:
                    for side, shared in zip(way.sides, widest.sides, strict=True):
                        side.bearing.take_grids_of(shared.bearing)
            self.start = widest.start

    @property
    def solves(self) -> int:  # type: ignore[override]
        """Returns the number of solves of all conditions together."""
        return sum(way.solves for way in self.ways)

    def nodes(self, node: Node) -> list[Node]:
        """Returns a node for each condition, with `last` of its way where that has the same states.

        `StiffGrooves.completed` solves any other tuple again, even one of the same states.
        """
        return [
            part._replace(states=way.last) if _are_identical(way.last, part.states) else part
            for way, part in zip(self.ways, super().nodes(node), strict=True)
        ]

    def state(self, worn: Wears) -> States:
        """Returns the states with some wear in all conditions; their status says if they fail.

        They end with those of the first condition that is not solved.
        """
        if self.status != code.OK:
            return self.states_by(lambda way: way.unsolved_states())
        return self.states_by(lambda way: way.state(worn))

    def middle_state(self, worn: Wears) -> States:
        """Returns rough answers in all conditions, see `Grooves.middle_state`."""
        return self.states_by(lambda way: way.middle_state(worn))

    def completed(self, node: Node) -> Node:
        """Returns a node whose states are completed by the ways of all conditions."""
        if node.status != code.OK:
            return node
        states: list[Any] = []
        for way, part in zip(self.ways, self.nodes(node), strict=True):
            completed = way.completed(part)
            states += completed.states
            if completed.status != code.OK:
                break
        return node._replace(states=tuple(states))

    def rates(self, node: Node) -> Wears:
        """Returns the wear per second of each bearing, as the mean over a cycle [m/s]."""
        mean = [WornDepths(0.0, np.zeros_like(wear.grooves)) for wear in self.start]
        for weighted in self.weighted(node):
            rates = weighted.way.rates(weighted.node)
            pairs = zip(mean, rates, strict=True)
            mean = [total.plus(weighted.share, rate) for total, rate in pairs]
        return tuple(mean)

    def start_ahead(self, before: Node, now: Node, share: float) -> None:
        """Sets where the next solves of all conditions start, see `Grooves.start_ahead`."""
        for way, earlier, last in zip(self.ways, self.nodes(before), self.nodes(now), strict=True):
            way.start_ahead(earlier, last, share)

    def longest_step(self, now: Node, rates: Wears) -> float:
        """Returns the shortest of the longest steps of all conditions [s]."""
        pairs = zip(self.ways, self.nodes(now), strict=True)
        return min(way.longest_step(part, rates) for way, part in pairs)

    def bares(self, before: Node, now: Node) -> bool:
        """Returns whether any contact has lost more of its film, see `Grooves.bares`.

        It is that of the first condition, as the wear is the same in all.
        """
        return bool(self.ways[0].bares(before, now))

    def wears(self, node: Node) -> bool:
        """Returns whether anything wears in any condition."""
        return any(way.wears(part) for way, part in zip(self.ways, self.nodes(node), strict=True))

    def events(self, node: Node) -> np.ndarray:
        """Returns the least share of the largest loss that is left in any condition (1,)."""
        events = [way.events(part) for way, part in zip(self.ways, self.nodes(node), strict=True)]
        return np.asarray(np.min(events, axis=0))


def _are_identical(states: Sequence[Any], others: Sequence[Any]) -> bool:
    """Returns whether two sequences hold the very same objects."""
    return len(states) == len(others) and all(map(operator.is_, states, others))
