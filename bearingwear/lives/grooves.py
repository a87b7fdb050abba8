"""Bearings whose grooves are followed as they wear (theory.md section 21)."""

import copy
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.ends import Criteria, largest_loss
from bearingwear.lives.follow import Life, Node, States, follow
from bearingwear.lives.methods import Adams
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing import parameters
from bearingwear.solvers.bearing.outputs import wear_values
from bearingwear.solvers.bearing_states import states_of
from bearingwear.solvers.compose import worn_bearings, worn_elsewhere
from bearingwear.solvers.condition import innermost
from bearingwear.solvers.rotor import RotorState
from bearingwear.solvers.state import State
from bearingwear.solvers.worn.depths import WornDepths, WornPoint
from bearingwear.solvers.worn.solver import Worn

STEP = 0.24  # deepest wear of an exact step, over the gap A a^2
FILM_STEP = 0.12  # likewise, over the thickness of a film that still covers
LEAST_FILM_STEP = 0.125  # over a step without a film, where one goes on to go
ROUGHLY_BALANCED = 1e-4  # force left on a rotor where states are rough, over the larger one
_ROUGH_END = 1e-2  # of the last step, to which the end of a rough life is found
_SHORT = 0.3  # of the step before

Wears = tuple[WornDepths, ...]


class GrooveMode(NamedTuple):
    """How exactly grooves are followed."""

    cells: tuple[int, int]  # along the major axis, and on each side of it
    step: float  # deepest wear of a step, over the gap A a^2
    rough: bool  # whether states are balanced roughly, as in the middle of a step, and unchecked


EXACT_GROOVES = GrooveMode(cells=(48, 10), step=STEP, rough=False)
QUICK_GROOVES = GrooveMode(cells=(32, 8), step=1.5 * STEP, rough=True)
"""The two modes of a life with worn grooves."""


def point_of(state: State) -> WornPoint:
    return state.answer.answer


class Grooves:
    """The wear of the grooves and balls of a bearing, or of two on a rotor.

    States have no stiffness unless the life ends by it.
    """

    origin, range = 0.0, math.inf

    def __init__(self, scene: Scene, mode: GrooveMode = EXACT_GROOVES):
        self.scene, self.mode = scene, mode
        end = scene.wear.end_of_life
        self.by_stiffness = end is not None and end.system_axial_stiffness_N_um is not None
        self.solves = 0
        self.status, self.bearings = worn_bearings(scene, mode.cells)
        self.sides: tuple[Worn, ...] = ()
        if self.status == code.OK:
            self.sides = tuple(map(innermost, self.bearings.sides))
        self.start: Wears = tuple(side.bearing.unworn() for side in self.sides)
        self.last: States = ()  # solved, not in the middle of a step

    def state(self, worn: Wears) -> States:
        """The bearings with some wear."""
        if self.status != code.OK:
            return self.new_states()
        found = self._solved(worn, self.mode.rough)
        if found.status != code.OK:
            return tuple(State.unsolved(found.status, math.nan) for _ in self.sides)
        self._found = found
        conditions = tuple(map(Worn.condition, worn))
        self.last = states_of(self.bearings, conditions, found)
        if self.by_stiffness:
            self.last = self.with_stiffness()
        return self.last

    def new_states(self) -> States:
        """Whether the new bearings are solved, and no more."""
        losses = (scene.wear.ball_diameter_loss_um[0] for scene in self.scene.one_of_alike.sides)
        return tuple(State.unsolved(self.status, loss * parameters.UM) for loss in losses)

    def middle_state(self, worn: Wears) -> States:
        """Rough answers of the bearings in the middle of a step, without values."""
        found = self._solved(worn, True)
        if found.status != code.OK:
            return tuple(State.unsolved(found.status, math.nan) for _ in self.sides)
        return tuple(State(found.status, {}, one) for one in found.sides)

    def _solved(self, worn: Wears, rough: bool) -> RotorState:
        self.solves += 1
        for side in self.sides:
            side.bearing.on_the_way = rough
        tolerance = ROUGHLY_BALANCED if rough else None
        found = self.bearings.solve(tuple(map(Worn.condition, worn)), tolerance=tolerance)
        if found.status == code.OK:
            for side, one in zip(self.sides, found.sides, strict=True):
                side.bearing.count_from(one.answer)
        return found

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
        of_rotor = self.bearings.with_sides(sides, self._found).values
        return tuple(
            replace(state.with_values(one.stiffnesses | of_rotor), answer=one)
            for state, one in zip(self.last, sides, strict=True)
        )

    def completed(self, node: Node) -> Node:
        """A node that a life keeps."""
        return node

    def rates(self, node: Node) -> Wears:
        """Wear per second of each bearing."""
        each = zip(self.sides, node.states, strict=True)
        return tuple(side.rate(state.answer) for side, state in each)

    def worn_on(self, worn: Wears, spans: Sequence[tuple[float, Wears]]) -> Wears:
        """Wear after some times at a rate each."""
        for dt, rates in spans:
            worn = tuple(wear.plus(dt, rate) for wear, rate in zip(worn, rates, strict=True))
        return worn

    def start_ahead(self, before: Node, now: Node, share: float) -> None:
        """Start the next solves so many times the last step ahead."""
        for side, was, state in zip(self.sides, before.states, now.states, strict=True):
            side.bearing.start_ahead(point_of(was), point_of(state), share)

    def longest_step(self, now: Node, rates: Wears) -> float:
        """Time in which the deepest place wears by a part of the gap at the edge [s]."""
        lengths = []
        for side, state, rate in zip(self.sides, now.states, rates, strict=True):
            deepest = rate.grooves.max(axis=1) + 0.5 * rate.ball
            gap = side.bearing.gap_at_edge(point_of(state))
            fastest = (deepest / gap).max()  # 0 at rest
            length = self.mode.step / fastest if fastest else math.inf
            if (films := side.bearing.films) is not None:
                share, least = FILM_STEP * self.mode.step / STEP, LEAST_FILM_STEP * length
                wear = point_of(state).wear
                length = min(length, films.longest_time(wear, rate, share, least))
            lengths.append(length)
        return float(min(lengths))

    def bares(self, before: Node, now: Node) -> bool:
        """Whether a film has begun to leave its deepest place between two nodes, or has left it.

        Rates have a kink there.
        """
        return any(
            (films.bare_parts(was) != films.bare_parts(wear)).any()
            for side, was, wear in zip(self.sides, before.worn, now.worn, strict=True)
            if (films := side.bearing.films) is not None
        )

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


class StiffGrooves(Grooves):
    """Grooves whose nodes along a life all know their stiffnesses."""

    def completed(self, node: Node) -> Node:
        if self.by_stiffness or node.status != code.OK:
            return node
        states = node.states if node.states is self.last else self.state(node.worn)
        solved = all(state.is_solved for state in states)
        return node._replace(states=self.with_stiffness()) if solved else node


def follow_grooves(wearing: Grooves, ends: Criteria | None = None) -> Life:
    """The life with grooves as they wear, and the rates at which its even losses grow.

    It ends by the criteria of the scene if there are no others.
    """
    method = Adams()
    if wearing.mode.rough:
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
        values = wear_values(first.answer.scene, np.array([point.D]), *worn_by)
        return [float(values["ball_diameter_loss_rate"])]
    loss = np.array([state.loss for state in states])
    # A last step that is short says nothing of a rate.
    steps = np.diff(times)
    n = len(times) - (len(times) > 2 and steps[-1] < _SHORT * steps[-2])
    rates = np.gradient(loss[:n], times[:n], edge_order=2 if n > 2 else 1)
    return np.append(rates, rates[-1:])[: len(times)].tolist()
