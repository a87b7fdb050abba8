"""The one loop of all lives: steps until a criterion is met, or nothing more is solved.

A way to wear (`Wearing`) says what wears, the state of the bearings with it, and how fast it goes.
A method (`bearingwear.lives.methods`) takes steps over the loss or over the time.
"""

from collections.abc import Iterable, Sequence
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


class Node(NamedTuple):
    x: float  # what steps go along: the counted loss [m] or the time [s]
    worn: Any  # as its way to wear has it
    states: States
    time: float  # [s]

    @property
    def status(self) -> int:
        return next((one.status for one in self.states if one.status != code.OK), code.OK)


class Wearing(Protocol):
    """A way to wear, of one bearing or of two."""

    start: Any  # wear at the start of the life
    origin: float  # of the integration
    range: float  # of the integration: a life that is as long is not followed further

    def state(self, worn: Any) -> States: ...  # bearings with so much worn, or why not solved
    def rates(self, node: Node) -> Any: ...  # wear per second
    def wears(self, node: Node) -> bool: ...  # whether anything that counts does
    def events(self, node: Node) -> np.ndarray: ...  # distance to each change of the way
    def passes(self, event: int, node: Node) -> bool: ...  # change it; False if the life ends


@dataclass(frozen=True, kw_only=True)
class LifeStep:
    """Nodes of a step up to its end, or up to the first that was not solved."""

    end: float
    nodes: Sequence[Node] = ()
    error: float = 0.0  # of the times [s]
    is_rough: bool = False  # and has to be shorter


class Method:
    most_steps = 2000
    root = 1e-9  # of the step in which an end is met
    shorter = 0.0  # a step after one that failed, over that; 0 where there is none
    shortest = 0.0  # step, and what may be left of the way to an end
    length = tried = 0.0  # of the next step, and of the last one
    wearing: Any

    def first(self, wearing: Wearing) -> Node:
        """The node that a life begins with."""
        self.wearing = wearing
        return self.node(wearing.origin, wearing.start, 0.0)

    def again(self, node: Node) -> Node:
        """The last node, where the way has changed."""
        return node._replace(states=self.wearing.state(node.worn))

    def node(self, x: float, worn: Any, time: float) -> Node:
        return Node(x, worn, self.wearing.state(worn), time)

    def step(self, life: "Life", bound: float) -> LifeStep:
        """A step from the end of a life, not beyond a bound."""
        raise NotImplementedError

    def at(self, x: float) -> Node:
        """A node within the last step."""
        raise NotImplementedError

    def solved_at(self, *places: float) -> list[Node]:
        """Nodes within the last step, up to the first that was not solved."""
        nodes: list[Node] = []
        for x in places:
            nodes.append(self.at(x))
            if nodes[-1].status != code.OK:
                break
        return nodes

    def kept(self, step: LifeStep) -> Sequence[Node]:
        """Nodes of a step that is taken."""
        return step.nodes

    def shorten(self) -> bool:
        """Take a shorter step next; False where it would be too short."""
        self.length = self.shorter * min(self.length, self.tried)
        return self.length > self.shortest

    def zero(self, value: Any, a: Node, b: Node) -> float:
        """Root of a margin between two nodes."""
        least = self.root * value(a.x)

        def left(x: float) -> float:
            found = value(x)
            return found if abs(found) > least else 0.0

        return brent_root(left, a.x, b.x, xtol=self.root * (b.x - a.x), rtol=1e-15)

    def error_of_end(self, life: "Life") -> float:
        """Error of the time at which a criterion is reached or a way changes [s]."""
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
    beyond: Node | None = None

    @property
    def last(self) -> Node:
        return self.nodes[-1]

    @property
    def tried(self) -> list[Node]:
        """The nodes, and what could not be solved."""
        return self.nodes if self.beyond is None else [*self.nodes, self.beyond]

    @property
    def times(self) -> np.ndarray:
        """When the nodes are reached (nodes,) [s]."""
        return np.array([node.time for node in self.nodes])

    @property
    def bearings(self) -> list[list[State]]:
        return [list(one) for one in zip(*(node.states for node in self.nodes), strict=True)]

    @property
    def states(self) -> list[State]:
        return [node.states[0] for node in self.nodes]

    def first(self, ends: Criteria) -> float:
        """When it first meets other ends [s]; NaN if it does not.

        Between the nodes, margins are monotone cubics of time.
        """
        if self.nodes[0].status != code.OK:
            return np.nan
        from scipy.interpolate import PchipInterpolator  # loads slowly; few lives are asked this

        times, first = self.times, np.inf
        for margin in np.array([ends.margins(node.states) for node in self.nodes]).T:
            met = np.flatnonzero(margin <= 0.0)
            if met.size and met[0] == 0:
                return 0.0
            if met.size:
                a, b = times[met[0] - 1], times[met[0]]
                first = min(first, brent_root(PchipInterpolator(times, margin), a, b))
        return first if np.isfinite(first) else np.nan

    def fails(self, beyond: Node) -> None:
        """What ends the range of a solver; a physical reason says more than rounding does."""
        self.beyond = beyond
        if self.status in REASONLESS:
            self.status = beyond.status


def follow(wearing: Wearing, ends: Criteria, method: Method) -> Life:
    """The life from the present wear to the first criterion, or to where solver or range ends."""

    def margins(node: Node) -> np.ndarray:
        return np.concatenate([ends.margins(node.states), wearing.events(node)])

    life = Life([method.first(wearing)], wearing)
    if life.last.status != code.OK:
        life.status = life.last.status
        return life
    while True:
        met = np.flatnonzero(margins(life.last)[:NO_CRITERION] <= 0.0)
        end = int(met[0]) if met.size else None
        if end is None and wearing.wears(life.last):
            end = _steps(life, method, margins, wearing.origin + wearing.range)
        if end is None or (
            end >= NO_CRITERION and not wearing.passes(end - NO_CRITERION, life.last)
        ):
            return life
        if not met.size:
            life.error = life.error + method.error_of_end(life)
        if end < NO_CRITERION:
            life.criterion, life.status = end, code.OK
            return life
        node = method.again(life.last)
        if node.status != code.OK:
            life.fails(node)
            return life
        life.nodes.append(node)


def _steps(life: Life, method: Method, margins: Any, bound: float) -> int | None:
    """Take steps until something is met: its index in the margins, None where nothing is."""
    met: int | None = None
    lost: Node | None = None
    before = margins(life.last)
    for _ in range(method.most_steps):
        check_interrupt()
        if bound - life.last.x <= method.shortest:
            break
        step = method.step(life, bound)
        failed = _failed(step.nodes)
        if met is None:
            solved = step.nodes[:-1] if failed else step.nodes
            found, after = _first_zero([life.last, *solved], before, method, margins)
            if found is not None:
                bound, met, lost = found  # up to there and no further
                if bound < step.end:
                    continue
        kept = [] if failed or step.is_rough else method.kept(step)
        failed = failed or _failed(kept)
        if failed:
            life.fails(failed)
        elif kept:
            life.nodes += kept
            life.error = life.error + step.error
            before = after
            continue
        if not method.shorten():
            break
    if lost:
        life.fails(lost)
        return None
    return met


def _failed(nodes: Iterable[Node]) -> Node | None:
    return next((node for node in nodes if node.status != code.OK), None)


@dataclass
class _Left:
    """A margin over the way; a solve that fails counts as beyond the criterion."""

    k: int  # index of the margin
    method: Method
    margins: Any
    known: dict[float, float]  # at nodes that were solved
    failed: Node | None = None  # the last one that was not

    def __call__(self, x: float) -> float:
        if x not in self.known:
            node = self.method.at(x)
            if node.status != code.OK:
                self.failed = node
                return -1.0
            self.known[x] = float(self.margins(node)[self.k])
        return self.known[x]

    def lost(self, start: float, root: float) -> Node | None:
        """The node on which a bracket closed, if the criterion is not met there."""
        last = max(x for x in self.known if x <= root)
        return self.failed if self.known[last] > _MET * self.known[start] else None


def _first_zero(
    nodes: Iterable[Node], before: np.ndarray, method: Method, margins: Any
) -> tuple[tuple[float, int, Node | None] | None, np.ndarray]:
    """Where the first margin falls to zero along solved nodes, and which; and the last margins.

    Those of the first node are given. The bracket closes on a solve that fails in between. If
    nothing is met there, the third is that node, which ends what can be solved.
    """
    a, *others = nodes
    for b in others:
        after, zeros = margins(b), []
        for k in np.flatnonzero((after <= 0.0) & (before > 0.0)):
            left = _Left(int(k), method, margins, {a.x: before[k], b.x: after[k]})
            root = method.zero(left, a, b)
            zeros.append((root, int(k), left.lost(a.x, root)))
        if zeros:
            return min(zeros, key=lambda zero: zero[:2]), after
        a, before = b, after
    return None, before
