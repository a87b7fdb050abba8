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
_NARROW_GAP = 0.02  # of a step: without states, and passed on the way to a criterion
_ROOT_RTOL = 1e-15  # of a root of Brent's method, as in double precision: `xtol` decides

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
    """A way to wear, of one bearing or of two.

    Some methods call more than this: `longest_step` in time, `loss_rate` over the loss.
    """

    start: Any  # wear at the start of the life
    origin: float  # of the integration
    range: float  # of `Node.x` from the origin, at whose end a life is not followed further

    def state(self, worn: Any) -> States:
        """Returns the states of the bearings with some wear; their status says if they fail."""

    def rates(self, node: Node) -> Any:
        """Returns the wear per second, in the form of `worn`."""

    def wears(self, node: Node) -> bool:
        """Returns whether anything wears that can bring a life to its end."""

    def events(self, node: Node) -> np.ndarray:
        """Returns the share left to each event, such as a film that is gone (events,) [1].

        It is positive before the event, zero or below from then on, and infinite without one.
        """

    def pass_event(self, event: int, node: Node) -> bool:
        """Changes the way to wear at an event; returns False if the life ends there."""


@dataclass(frozen=True, kw_only=True)
class LifeStep:
    """Nodes of a step up to its end, or up to the first that was not solved.

    The node before the step, at which it starts, is not among them.
    """

    end: float  # as `Node.x`
    nodes: Sequence[Node] = ()
    error: float = 0.0  # of the times [s]
    is_rough: bool = False  # and has to be shorter


class Method:
    """A method that takes the steps of a life; lengths are those of `Node.x` [m] or [s]."""

    most_steps = 2000  # from one event to the next; a life that needs more meets no criterion
    root_tolerance = 1e-9  # of the place of an end, over the step in which it is met
    shortening = 0.0  # length of a step after one that failed, over that; 0: no such step
    shortest = 0.0  # length of a step, and largest rest of the way that is not followed
    length = tried_length = 0.0  # of the next step, and of the last one
    wearing: Any

    def first(self, wearing: Wearing) -> Node:
        """Returns the node that a life begins with; sets `wearing` for all later calls."""
        self.wearing = wearing
        return self.node(wearing.origin, wearing.start, 0.0)

    def node_after_event(self, node: Node) -> Node:
        """Returns the last node solved again, as its way to wear has changed."""
        return node._replace(states=self.wearing.state(node.worn))

    def node(self, x: float, worn: Any, time: float) -> Node:
        """Returns the node with some wear, its bearings solved."""
        return Node(x, worn, self.wearing.state(worn), time)

    def step(self, life: "Life", bound: float) -> LifeStep:
        """Returns a step from the last node of a life; it does not pass a bound of `Node.x`."""
        raise NotImplementedError

    def at(self, x: float) -> Node:
        """Returns the node at a place within the last step, its end included."""
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
        """Returns the nodes of a step that its life keeps, if all of these are solved."""
        return step.nodes

    def shorten(self) -> bool:
        """Sets the length of the next step shorter; returns whether it is still long enough."""
        self.length = self.shortening * min(self.length, self.tried_length)
        return self.length > self.shortest

    def root(self, margin: Callable[[float], float], a: Node, b: Node) -> float:
        """Returns the place between two nodes at which a margin is zero, by Brent's method.

        A margin below `root_tolerance` of that at node a counts as zero.

        margin: of a place; positive at node a, zero or negative at node b.
        """
        negligible = self.root_tolerance * margin(a.x)

        def rounded(x: float) -> float:
            """Returns the margin at a place, 0 where it is negligible."""
            value = margin(x)
            return value if abs(value) > negligible else 0.0

        xtol = self.root_tolerance * (b.x - a.x)
        return brent_root(rounded, a.x, b.x, xtol=xtol, rtol=_ROOT_RTOL)

    def error_of_end(self, life: "Life") -> float:
        """Returns the error of the time at which a criterion or an event is reached [s].

        It is 0 for a method whose roots are as exact as rounding.
        """
        return 0.0


@dataclass
class Life:
    """Nodes up to the end of a life, and how it ended.

    The status is OK if a criterion was met. Otherwise it says why the life was not followed
    further, and the last node is only a lower bound.
    """

    nodes: list[Node]
    wearing: Any
    criterion: int = NO_CRITERION  # index in `CRITERIA`
    status: int = code.CRITERION_NOT_REACHED
    error: float = 0.0  # of the last time, by the steps [s]
    solves: int = 0  # set by those who count them
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
        """Returns a list for each bearing, of its states along the life."""
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
        """Returns the time at which the life first meets any of other criteria [s].

        NaN if it meets none, or if its start is not solved. Between the nodes, margins are monotone
        cubics of time.
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
        """Keeps the unsolved node before which the life ends, and takes its status.

        A status of the life with a physical reason, which is none of `REASONLESS`, stays.
        """
        self.unsolved_node = unsolved_node
        if self.status in REASONLESS:
            self.status = unsolved_node.status


def follow(wearing: Wearing, ends: Criteria, method: Method) -> Life:
    """Returns the life from the present wear to a criterion, or to where it cannot be followed.

    Its status is OK if a criterion is met, and that of the node if one is not solved. It is
    CRITERION_NOT_REACHED if nothing wears, or if the way to wear ends at an event or by its range.
    The same is true after the `most_steps` of the method.

    wearing: what wears, and how fast.
    ends: criteria that end the life.
    method: takes its steps.
    """

    def margins(node: Node) -> np.ndarray:
        """Returns the margins of a node to each criterion, then to each event."""
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
    failed: Node | None  # at which the root search ended, if the margin is not zero there


def _step_to_zero(life: Life, method: Method, margins: Margins, bound: float) -> int | None:
    """Takes steps until a margin is zero, and returns its index.

    Appends the nodes of the steps to the life and adds their errors to its own. None if the bound
    or the `most_steps` come first, or if a node is not solved however short the step; the life then
    has failed with this node.

    bound: of `Node.x`, beyond which no step leads.
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
                    continue  # with a step that ends at the zero, in place of this one
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
    """One margin as a function of a place within a step, for a root search.

    A solve that fails counts as beyond the criterion.
    """

    index: int
    method: Method
    margins: Margins
    values: dict[float, float]  # at nodes that were solved
    failed: Node | None = None  # the last one that was not

    def __call__(self, x: float) -> float:
        """Returns the margin at a place; -1 where it is not solved, which sets `failed`."""
        if x not in self.values:
            node = self.method.at(x)
            if node.status != code.OK:
                self.failed = node
                return -1.0
            self.values[x] = float(self.margins(node)[self.index])
        return self.values[x]

    def failed_at(self, root: float, start: float) -> Node | None:
        """Returns the unsolved node at which a root search ended; None if the criterion is met.

        It counts as met where the margin of the last solved place up to the root is at most `_MET`
        of that at the start. It also does where the next place at which the criterion is met lies
        beyond a `_NARROW_GAP`: states of contacts that hardly carry any load scatter.
        """
        last = max(x for x in self.values if x <= root)
        met = min(
            (x for x, value in self.values.items() if x > root and value <= 0.0), default=root
        )
        is_narrow = met - last <= _NARROW_GAP * (max(self.values) - start)
        is_met = self.values[last] <= _MET * self.values[start]
        return None if is_met or is_narrow else self.failed


def _first_zero(
    nodes: Iterable[Node], before: np.ndarray, method: Method, margins: Margins
) -> tuple[_Zero | None, np.ndarray]:
    """Returns the first zero of any margin along solved nodes, and margins after it.

    The margins are those of the node after the zero; without a zero, None and those of the last
    node. Where a solve fails in between, the search for the zero ends there.

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
