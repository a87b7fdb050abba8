"""The one loop of all lives: steps until a criterion is met, or nothing more is solved.

A way to wear (`Wearing`) says what wears, the state of the bearings with it, and how fast it goes.
A method (`bearingwear.lives.methods`) takes steps over the loss or over the time.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.ends import NO_CRITERION, Criteria
from bearingwear.solvers.condition import States
from bearingwear.solvers.roots import brent_root
from bearingwear.solvers.state import State
from kerneljit.interrupt import check_interrupt

_MET = 0.02  # margin left where a criterion counts as met, over that at the last node before

REASONLESS = (code.CRITERION_NOT_REACHED, code.NOT_CONVERGED, code.UNVERIFIED)
"""Statuses without a physical reason for the end of a life."""


class Node(NamedTuple):
    """A state of wear along a life, when it is reached, and the bearings with it."""

    x: float  # what steps go along: the counted loss [m] or the time [s]
    worn: Any  # in the form that the way to wear uses
    states: States
    time: float  # [s]

    @property
    def status(self) -> int:
        """Returns the status of the first bearing that is not solved; OK if all are."""
        return next((state.status for state in self.states if state.status != code.OK), code.OK)


Margins = Callable[[Node], np.ndarray]
"""Margins of a node to each criterion, then to each event of a way to wear."""


class Wearing(Protocol):
    """A way to wear, of one bearing or of two."""

    start: Any  # wear at the start of the life
    origin: float  # of the integration
    range: float  # of the integration: a life that is as long is not followed further

    def state(self, worn: Any) -> States:
        """Returns the bearings with some wear, or why they are not solved."""

    def rates(self, node: Node) -> Any:
        """Returns the wear per second, in the form of `worn`."""

    def wears(self, node: Node) -> bool:
        """Returns whether anything wears that counts."""

    def events(self, node: Node) -> np.ndarray:
        """Returns the distance to each change of the way to wear, zero where it is reached."""

    def pass_event(self, event: int, node: Node) -> bool:
        """Changes the way to wear at an event; returns False if the life ends there."""


@dataclass(frozen=True, kw_only=True)
class LifeStep:
    """Nodes of a step up to its end, or up to the first that was not solved."""

    end: float
    nodes: Sequence[Node] = ()
    error: float = 0.0  # of the times [s]
    is_rough: bool = False  # and has to be shorter


class Method:
    """A method that takes the steps of a life."""

    most_steps = 2000
    root_tolerance = 1e-9  # of the step in which an end is met
    shortening = 0.0  # length of a step after one that failed, over that; 0: no such step
    shortest = 0.0  # step, and what may be left of the way to an end
    length = tried_length = 0.0  # of the next step, and of the last one
    wearing: Any

    def first(self, wearing: Wearing) -> Node:
        """Returns the node that a life begins with."""
        self.wearing = wearing
        return self.node(wearing.origin, wearing.start, 0.0)

    def node_after_event(self, node: Node) -> Node:
        """Returns the last node solved again, as its way to wear has changed."""
        return node._replace(states=self.wearing.state(node.worn))

    def node(self, x: float, worn: Any, time: float) -> Node:
        """Returns the node with some wear, its bearings solved."""
        return Node(x, worn, self.wearing.state(worn), time)

    def step(self, life: "Life", bound: float) -> LifeStep:
        """Returns a step from the end of a life that does not pass a bound."""
        raise NotImplementedError

    def at(self, x: float) -> Node:
        """Returns a node within the last step."""
        raise NotImplementedError

    def solved_at(self, *places: float) -> list[Node]:
        """Returns nodes within the last step, up to the first that was not solved."""
        nodes: list[Node] = []
        for x in places:
            nodes.append(self.at(x))
            if nodes[-1].status != code.OK:
                break
        return nodes

    def kept_nodes(self, step: LifeStep) -> Sequence[Node]:
        """Returns the nodes of a finished step that its life keeps."""
        return step.nodes

    def shorten(self) -> bool:
        """Makes the next step shorter; returns False where it would be too short."""
        self.length = self.shortening * min(self.length, self.tried_length)
        return self.length > self.shortest

    def root(self, margin: Callable[[float], float], a: Node, b: Node) -> float:
        """Returns where a margin is zero between two nodes."""
        negligible = self.root_tolerance * margin(a.x)

        def rounded(x: float) -> float:
            value = margin(x)
            return value if abs(value) > negligible else 0.0

        return brent_root(rounded, a.x, b.x, xtol=self.root_tolerance * (b.x - a.x), rtol=1e-15)

    def error_of_end(self, life: "Life") -> float:
        """Returns the error of the time at which a criterion or an event is reached [s]."""
        return 0.0


@dataclass
class Life:
    """Nodes up to the end of a life, and how it ended."""

    nodes: list[Node]
    wearing: Any
    criterion: int = NO_CRITERION
    status: int = code.CRITERION_NOT_REACHED
    error: float = 0.0  # of the last time, by the steps [s]
    solves: int = 0
    unsolved_node: Node | None = None  # beyond the last one

    @property
    def last(self) -> Node:
        """Returns the last node."""
        return self.nodes[-1]

    @property
    def tried_nodes(self) -> list[Node]:
        """Returns the nodes, and the one that could not be solved."""
        return self.nodes if self.unsolved_node is None else [*self.nodes, self.unsolved_node]

    @property
    def times(self) -> np.ndarray:
        """Returns the times at which the nodes are reached (nodes,) [s]."""
        return np.array([node.time for node in self.nodes])

    @property
    def bearings(self) -> list[list[State]]:
        """Returns the states along the life, of each bearing."""
        return [list(states) for states in zip(*(node.states for node in self.nodes), strict=True)]

    @property
    def states(self) -> list[State]:
        """Returns the states along the life of its first bearing."""
        return [node.states[0] for node in self.nodes]

    def ends_like(self, other: "Life") -> bool:
        """Returns whether two lives have the same status and criterion."""
        return (self.status, self.criterion) == (other.status, other.criterion)

    def three_nodes(self) -> list[Node]:
        """Returns the nodes at the start, in the middle and at the end."""
        return [self.nodes[k] for k in (0, len(self.nodes) // 2, -1)]

    def time_to(self, ends: Criteria) -> float:
        """Returns the time at which the life first meets other criteria [s]; NaN if it does not.

        Between the nodes, margins are monotone cubics of time.
        """
        if self.nodes[0].status != code.OK:
            return np.nan
        from scipy.interpolate import PchipInterpolator  # loads slowly; few lives are asked this

        times, earliest = self.times, np.inf
        for margin in np.array([ends.margins(node.states) for node in self.nodes]).T:
            met = np.flatnonzero(margin <= 0.0)
            if met.size and met[0] == 0:
                return 0.0
            if met.size:
                a, b = times[met[0] - 1], times[met[0]]
                earliest = min(earliest, brent_root(PchipInterpolator(times, margin), a, b))
        return earliest if np.isfinite(earliest) else np.nan

    def fail(self, unsolved_node: Node) -> None:
        """Ends the life before a node that is not solved.

        Its status is that of the node, unless the life has one with a physical reason.
        """
        self.unsolved_node = unsolved_node
        if self.status in REASONLESS:
            self.status = unsolved_node.status


def follow(wearing: Wearing, ends: Criteria, method: Method) -> Life:
    """Returns the life from the present wear to a criterion, or to where solver or range ends.

    wearing: what wears, and how fast.
    ends: criteria that end the life.
    method: takes its steps.
    """

    def margins(node: Node) -> np.ndarray:
        return np.concatenate([ends.margins(node.states), wearing.events(node)])

    life = Life([method.first(wearing)], wearing)
    if life.last.status != code.OK:
        life.status = life.last.status
        return life
    while True:
        met = np.flatnonzero(margins(life.last)[:NO_CRITERION] <= 0.0)
        if met.size:  # at the start, or as an event has changed the state
            life.criterion, life.status = int(met[0]), code.OK
            return life
        if not wearing.wears(life.last):
            return life
        index = _step_to_zero(life, method, margins, wearing.origin + wearing.range)
        if index is None:
            return life
        is_event = index >= NO_CRITERION
        if is_event and not wearing.pass_event(index - NO_CRITERION, life.last):
            return life
        life.error = life.error + method.error_of_end(life)
        if not is_event:
            life.criterion, life.status = index, code.OK
            return life
        node = method.node_after_event(life.last)
        if node.status != code.OK:
            life.fail(node)
            return life
        life.nodes.append(node)


class _Zero(NamedTuple):
    """A place at which a margin falls to zero."""

    x: float
    margin_index: int
    failed: Node | None  # on which the bracket closed, if the margin is not zero there


def _step_to_zero(life: Life, method: Method, margins: Margins, bound: float) -> int | None:
    """Takes steps until a margin is zero, and returns its index; None where none is.

    bound: end of the integration, see `Node.x`.
    """
    zero: _Zero | None = None
    before = margins(life.last)
    for _ in range(method.most_steps):
        check_interrupt()
        if bound - life.last.x <= method.shortest:
            break
        step = method.step(life, bound)
        failed = _first_failed(step.nodes)
        if zero is None:
            solved = step.nodes[:-1] if failed else step.nodes
            zero, after = _first_zero([life.last, *solved], before, method, margins)
            if zero is not None:
                bound = zero.x  # up to there and no further
                if bound < step.end:
                    continue
        kept = [] if failed or step.is_rough else method.kept_nodes(step)
        failed = failed or _first_failed(kept)
        if failed:
            life.fail(failed)
        elif kept:
            life.nodes += kept
            life.error = life.error + step.error
            before = after
            continue
        if not method.shorten():
            break
    if zero is None:
        return None
    if zero.failed:
        life.fail(zero.failed)
        return None
    return zero.margin_index


def _first_failed(nodes: Iterable[Node]) -> Node | None:
    """Returns the first node that is not solved; None if all are."""
    return next((node for node in nodes if node.status != code.OK), None)


@dataclass
class _Margin:
    """One margin within a step; a solve that fails counts as beyond the criterion."""

    index: int
    method: Method
    margins: Margins
    values: dict[float, float]  # at nodes that were solved
    failed: Node | None = None  # the last one that was not

    def __call__(self, x: float) -> float:
        """Returns the margin at a place; -1 where it is not solved."""
        if x not in self.values:
            node = self.method.at(x)
            if node.status != code.OK:
                self.failed = node
                return -1.0
            self.values[x] = float(self.margins(node)[self.index])
        return self.values[x]

    def failed_at(self, root: float, start: float) -> Node | None:
        """Returns the node on which a bracket closed, if the criterion is not met there."""
        last = max(x for x in self.values if x <= root)
        return self.failed if self.values[last] > _MET * self.values[start] else None


def _first_zero(
    nodes: Iterable[Node], before: np.ndarray, method: Method, margins: Margins
) -> tuple[_Zero | None, np.ndarray]:
    """Returns the first zero of a margin along solved nodes, and the margins of the last node.

    None in place of a zero if there is none. The bracket of a zero closes on a solve that fails in
    between.

    before: margins of the first node.
    """
    a, *others = nodes
    for b in others:
        after = margins(b)
        zeros = []
        for k in np.flatnonzero((after <= 0.0) & (before > 0.0)):
            margin = _Margin(int(k), method, margins, {a.x: before[k], b.x: after[k]})
            root = method.root(margin, a, b)
            zeros.append(_Zero(root, int(k), margin.failed_at(root, a.x)))
        if zeros:
            return min(zeros, key=lambda zero: (zero.x, zero.margin_index)), after
        a, before = b, after
    return None, before
