"""Bearings whose grooves are followed as they wear (theory.md section 21)."""

import copy
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.ends import Criteria, largest_loss
from bearingwear.lives.follow import Life, Node, States, follow
from bearingwear.lives.methods import Adams
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.outputs import wear_values
from bearingwear.solvers.compose import worn_bearings, worn_elsewhere
from bearingwear.solvers.condition import innermost
from bearingwear.solvers.rotor import states_of
from bearingwear.solvers.state import State
from bearingwear.solvers.worn.depths import WornDepths, WornPoint
from bearingwear.solvers.worn.solver import Worn

WORN_CELLS = (48, 10)  # along the major axis, and on each side of it
FEWER_CELLS = (32, 8)  # to see the error of the others
STEP = 0.24  # deepest wear of a step, over the gap A a^2
TOO_DEEP = 2.0  # times the depth that a step is to wear
FILM_STEP = 0.12  # likewise, over the thickness of a film that still covers
LONGER_STEP = 1.5 * STEP  # of quick lives, and to see the error of the others
ON_THE_WAY_BALANCED = 1e-4  # force left on a rotor in the middle of a step, over the larger one
_ROUGH_END = 1e-2  # of the last step, to which the end of a rough life is found
_SHORT = 0.3  # of the step before

Wears = tuple[WornDepths, ...]


def point_of(state: State) -> WornPoint:
    return state.answer.answer


class Grooves:
    """The wear of the grooves and balls of a bearing, or of two on a rotor.

    Where `only_times` count, states have no stiffness unless the life ends by it. Those of a
    `rough` life are balanced as on the way, and unchecked.
    """

    origin, range = 0.0, math.inf

    def __init__(
        self,
        scene: Scene,
        cells: tuple[int, int] = WORN_CELLS,
        step: float = STEP,
        only_times: bool = False,
        rough: bool = False,
    ):
        self.scene, self.depth, self.rough = scene, step, rough
        end = scene.wear.end_of_life
        self.by_stiffness = end is not None and end.system_axial_stiffness_N_um is not None
        self.only_times = only_times
        self.solves = 0
        self.status, self.bearings = worn_bearings(scene, cells)
        self.sides: tuple[Worn, ...] = ()
        if self.status == code.OK:
            self.sides = tuple(map(innermost, self.bearings.sides))
        self.start: Wears = tuple(side.bearing.unworn() for side in self.sides)
        self.last: States = ()  # solved, not on the way

    def state(self, worn: Wears, on_the_way: bool = False) -> States:
        """The bearings with some wear; on the way, their answers alone."""
        if self.status != code.OK:
            return self.new_states()
        self.solves += 1
        rough = on_the_way or self.rough
        for side in self.sides:
            side.bearing.on_the_way = rough
        conditions = tuple(map(Worn.condition, worn))
        tolerance = ON_THE_WAY_BALANCED if rough else None
        found = self.bearings.solve(conditions, tolerance=tolerance)
        if found.status != code.OK:
            return tuple(State.unsolved(found.status, math.nan) for _ in self.sides)
        for side, one in zip(self.sides, found.sides, strict=True):
            side.bearing.count_from(one.answer)
        if on_the_way:
            return tuple(State(found.status, {}, one) for one in found.sides)
        self._found = found
        self.last = states_of(self.bearings.sides, conditions, found)
        if self.by_stiffness:
            self.last = self.with_stiffness()
        return self.last

    def new_states(self) -> States:
        """Whether the new bearings are solved, and no more."""
        losses = (scene.wear.ball_diameter_loss_um[0] for scene in self.scene.one_of_alike.sides)
        return tuple(State.unsolved(self.status, loss * parameters.UM) for loss in losses)

    def elsewhere(self, scene: Scene, worn: Wears) -> States:
        """The bearings with some wear at another speed or temperature, with their stiffnesses.

        Nothing can be followed further afterwards.
        """
        other = copy.copy(self)
        other.scene, other.bearings = scene, worn_elsewhere(self.bearings, scene)
        other.sides = tuple(map(innermost, other.bearings.sides))
        found = other.state(worn)
        solved = all(state.is_solved for state in found)
        return other.with_stiffness() if solved and not self.by_stiffness else found

    def with_stiffness(self) -> States:
        """The states found last, with both stiffnesses."""
        each = zip(self.sides, self._found.sides, strict=True)
        sides = tuple(side.with_stiffness(one) for side, one in each)
        of_rotor = self.bearings.arranged(sides, self._found).values
        return tuple(
            replace(state.with_values(one.stiffnesses | of_rotor), answer=one)
            for state, one in zip(self.last, sides, strict=True)
        )

    def completed(self, node: Node) -> Node:
        """A node that a life keeps, which has its stiffnesses; not if only times count."""
        if self.by_stiffness or self.only_times or node.status != code.OK:
            return node
        states = node.states if node.states is self.last else self.state(node.worn)
        solved = all(state.is_solved for state in states)
        return node._replace(states=self.with_stiffness()) if solved else node

    def rates(self, node: Node) -> Wears:
        """Wear per second of each bearing."""
        each = zip(self.sides, node.states, strict=True)
        return tuple(side.rate(point_of(state)) for side, state in each)

    def moved(
        self, worn: Wears, spans: Sequence[tuple[float, Wears]], on_the_way: bool = False
    ) -> tuple[Wears, States]:
        """Wear after some times at a rate each, and the bearings with it."""
        for dt, rates in spans:
            worn = tuple(wear.plus(dt, rate) for wear, rate in zip(worn, rates, strict=True))
        return worn, self.state(worn, on_the_way)

    def start_ahead(self, before: Node, now: Node, share: float) -> None:
        """Start the next solves so many times the last step ahead."""
        for side, was, state in zip(self.sides, before.states, now.states, strict=True):
            side.bearing.start_ahead(point_of(was), point_of(state), share)

    def longest_step(self, now: Node, rates: Wears) -> float:
        """Time in which the deepest place wears by a part of the gap at the edge [s]."""
        lengths = []
        for side, state, rate in zip(self.sides, now.states, rates, strict=True):
            deepest = rate.grooves.max(axis=1) + rate.band.max(initial=0.0) + 0.5 * rate.ball
            gap = side.bearing.gap_at_edge(point_of(state))
            fastest = (deepest / gap).max()  # 0 at rest
            lengths.append(self.depth / fastest if fastest else math.inf)
            if (films := side.bearing.films) is not None:
                through = films.time_through(point_of(state).wear.deepest, rate.deepest)
                lengths.append(FILM_STEP * self.depth / STEP * through)
        return float(min(lengths))

    def is_too_deep(self, now: Node, new: Node) -> bool:
        """Whether a groove wore by far more, having worn through a film."""
        for side, *states in zip(self.sides, now.states, new.states, strict=True):
            if side.bearing.films is None:
                continue
            before, after = map(point_of, states)
            worn = (after.wear.grooves - before.wear.grooves).max(axis=1)
            if (worn / side.bearing.gap_at_edge(before)).max() > TOO_DEEP * self.depth:
                return True
        return False

    def wears(self, node: Node) -> bool:
        return max(max(side.factors) for side in self.sides) > 0.0

    def events(self, node: Node) -> np.ndarray:
        left = [
            1.0 - state.loss / largest_loss(side.scene)
            for side, state in zip(self.sides, node.states, strict=True)
        ]
        return np.array([min(left)])

    def passes(self, event: int, node: Node) -> bool:
        return False


def follow_grooves(wearing: Grooves, ends: Criteria | None = None) -> Life:
    """The life with grooves as they wear, and the rates at which its even losses grow.

    It ends by the criteria of the scene if there are no others.
    """
    method = Adams()
    if wearing.rough:
        method.root = _ROUGH_END
    life = follow(wearing, ends or Criteria(wearing.scene), method)
    life.solves = wearing.solves
    if life.nodes[0].status == code.OK:
        each = zip(wearing.sides, life.bearings, strict=True)
        rates = [_loss_rates(side, states, life.times) for side, states in each]
        for k, of_node in enumerate(zip(*rates, strict=True)):
            found = zip(life.nodes[k].states, of_node, strict=True)
            states = (one.with_values({"ball_diameter_loss_rate": rate}) for one, rate in found)
            life.nodes[k] = life.nodes[k]._replace(states=tuple(states))
    return life


def _loss_rates(side: Worn, states: list[State], times: np.ndarray) -> list[float]:
    """Rates at which the even loss of a bearing grows, of each state [m/s]."""
    if len(states) < 2:
        first, point = states[0], point_of(states[0])
        worn_by = first["qv"][None], first["semi_major_axis"][None], point.track[None]
        return [wear_values(side.scene, np.array([point.D]), *worn_by)["ball_diameter_loss_rate"]]
    loss = np.array([state.loss for state in states])
    # A last step that is short says nothing of a rate.
    steps = np.diff(times)
    n = len(times) - (len(times) > 2 and steps[-1] < _SHORT * steps[-2])
    rates = np.gradient(loss[:n], times[:n], edge_order=2 if n > 2 else 1)
    return np.append(rates, rates[-1:])[: len(times)].tolist()
