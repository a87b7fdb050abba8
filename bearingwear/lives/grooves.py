"""Bearings whose grooves are followed as they wear (theory.md section 21)."""

import copy
import math
from collections.abc import Callable, Sequence
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

STEP = 0.24  # deepest wear of an exact step, over the gap A a^2 at the edge of the contact
FILM_STEP = 0.12  # likewise, over the thickness of a film that still covers
LEAST_FILM_STEP = 0.125  # shortest step while a film wears through, over one without a film
ROUGHLY_BALANCED = 1e-4  # force left on a rotor where states are rough, over the larger one
_ROUGH_END = 1e-2  # of the last step, to which the end of a rough life is found
_SHORT = 0.3  # last step, over the step before

Wears = tuple[WornDepths, ...]


class GrooveMode(NamedTuple):
    """How exactly grooves are followed."""

    cells: tuple[int, int]  # numbers along the major axis, and on each side of it
    step: float  # deepest wear of a step, over the gap A a^2 at the edge of the contact
    # whether all states are balanced roughly and unchecked, as otherwise only amid a step
    rough: bool


EXACT_GROOVES = GrooveMode(cells=(48, 10), step=STEP, rough=False)
QUICK_GROOVES = GrooveMode(cells=(32, 8), step=1.5 * STEP, rough=True)
"""The two modes of a life with worn grooves; `worn_life` states how exact a quick one is."""


def point_of(state: State) -> WornPoint:
    """Returns the solved contacts and the wear behind a state of a life with worn grooves."""
    return state.answer.answer  # of the solved bearing of the state


class Grooves:
    """A way to wear: the grooves and balls of a bearing, or of two on a rotor.

    Wear is counted from 0 and followed over the time [s]. States have no stiffness unless the
    life ends by it. If the new bearings are not solved, `status` says why, and `sides` is empty.
    """

    origin = 0.0
    range = math.inf

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
        self.last: States = ()  # solved at the end of a step, not in its middle

    def state(self, worn: Wears) -> States:
        """Returns the states of the bearings with some wear; their status says if they fail.

        Keeps solved ones in `last`, for `with_stiffness`.
        """
        if self.status != code.OK:
            return self.unsolved_states()
        rotor = self._solve(worn, self.mode.rough)
        if rotor.status != code.OK:
            return tuple(State.unsolved(rotor.status, math.nan) for _ in self.sides)
        self._last_rotor = rotor
        conditions = tuple(map(Worn.condition, worn))
        self.last = states_of(self.bearings, conditions, rotor)
        if self.by_stiffness:
            self.last = self.with_stiffness()
        return self.last

    def unsolved_states(self) -> States:
        """Returns unsolved states at the present losses, with the status of the new bearings."""
        losses = (scene.wear.ball_diameter_loss_um[0] for scene in self.scene.symmetric_half.sides)
        return tuple(State.unsolved(self.status, loss * parameters.UM) for loss in losses)

    def middle_state(self, worn: Wears) -> States:
        """Returns rough answers of the bearings in the middle of a step, without values."""
        rotor = self._solve(worn, True)
        if rotor.status != code.OK:
            return tuple(State.unsolved(rotor.status, math.nan) for _ in self.sides)
        return tuple(State(rotor.status, {}, solved) for solved in rotor.sides)

    def _solve(self, worn: Wears, rough: bool) -> RotorState:
        """Returns the rotor and its bearings with some wear; its status says if they fail.

        The next solve starts from this one if it is solved.

        rough: whether they are balanced roughly, as in the middle of a step.
        """
        self.solves += 1
        for side in self.sides:
            side.bearing.on_the_way = rough
        tolerance = ROUGHLY_BALANCED if rough else None
        rotor = self.bearings.solve(tuple(map(Worn.condition, worn)), tolerance=tolerance)
        if rotor.status == code.OK:
            for side, solved in zip(self.sides, rotor.sides, strict=True):
                side.bearing.count_from(solved.answer)
        return rotor

    def states_elsewhere(self, scene: Scene, worn: Wears) -> States:
        """Returns the states of the bearings with some wear in another scene, with stiffnesses.

        The bearings are changed for it, so that no life can be followed further afterwards.

        scene: differs from that of the grooves by speed or temperature.
        """
        elsewhere = copy.copy(self)
        elsewhere.scene = scene
        elsewhere.bearings = worn_elsewhere(self.bearings, scene)
        elsewhere.sides = tuple(map(innermost, elsewhere.bearings.sides))
        states = elsewhere.state(worn)
        if self.by_stiffness or not all(state.is_solved for state in states):
            return states
        return elsewhere.with_stiffness()

    def with_stiffness(self) -> States:
        """Returns the states of `last` with the axial stiffness and the quasi-static one."""
        rotor = self._last_rotor
        pairs = zip(self.sides, rotor.sides, strict=True)
        sides = tuple(side.with_stiffness(solved) for side, solved in pairs)
        of_rotor = self.bearings.with_sides(sides, rotor).values
        return tuple(
            replace(state.with_values(solved.stiffnesses | of_rotor), answer=solved)
            for state, solved in zip(self.last, sides, strict=True)
        )

    def completed(self, node: Node) -> Node:
        """Returns the node as it is; a subclass may add values that a life keeps."""
        return node

    def rates(self, node: Node) -> Wears:
        """Returns the wear per second of each bearing, in the form of its wear [m/s]."""
        pairs = zip(self.sides, node.states, strict=True)
        return tuple(side.rate(state.answer) for side, state in pairs)

    def worn_on(self, worn: Wears, spans: Sequence[tuple[float, Wears]]) -> Wears:
        """Returns the wear after spans of time, each with its rates.

        spans: (time [s], wear per second); the time is negative where rates are taken away.
        """
        for dt, rates in spans:
            worn = tuple(wear.plus(dt, rate) for wear, rate in zip(worn, rates, strict=True))
        return worn

    def start_ahead(self, before: Node, now: Node, share: float) -> None:
        """Sets where the next solves start: beyond the node `now`, by a share of the last step.

        before, now: the nodes at both ends of that step.
        """
        for side, earlier, state in zip(self.sides, before.states, now.states, strict=True):
            side.bearing.start_ahead(point_of(earlier), point_of(state), share)

    def longest_step(self, now: Node, rates: Wears) -> float:
        """Returns the time in which the deepest place wears by the step of the mode [s].

        The wear is that of groove and ball together, over the gap at the edge of the contact. Where
        a film still covers, it is at most the time in which a part of the film wears. It is the
        least of both bearings; infinite where nothing wears.
        """
        lengths = []
        for side, state, rate in zip(self.sides, now.states, rates, strict=True):
            deepest_rate = rate.grooves.max(axis=1) + 0.5 * rate.ball
            gap = side.bearing.gap_at_edge(point_of(state))
            fastest = (deepest_rate / gap).max()  # 0 at rest
            length = self.mode.step / fastest if fastest else math.inf
            films = side.bearing.films
            if films is not None:
                share, least = FILM_STEP * self.mode.step / STEP, LEAST_FILM_STEP * length
                wear = point_of(state).wear
                length = min(length, films.longest_time(wear, rate, share, least))
            lengths.append(length)
        return float(min(lengths))

    def bares(self, before: Node, now: Node) -> bool:
        """Returns whether any contact has lost more of its film at `now` than at `before`.

        A film begins to leave its deepest place there, or has left, and rates have a kink.
        """
        for side, earlier, wear in zip(self.sides, before.worn, now.worn, strict=True):
            films = side.bearing.films
            if films is not None and (films.bare_parts(earlier) != films.bare_parts(wear)).any():
                return True
        return False

    def wears(self, node: Node) -> bool:
        """Returns whether balls or races of any bearing have a wear coefficient above 0."""
        return max(max(side.factors) for side in self.sides) > 0.0

    def events(self, node: Node) -> np.ndarray:
        """Returns the share of the largest loss that is left to the most worn bearing (1,) [1]."""
        shares_left = [
            1.0 - state.loss / largest_loss(side.scene)
            for side, state in zip(self.sides, node.states, strict=True)
        ]
        return np.array([min(shares_left)])

    def pass_event(self, event: int, node: Node) -> bool:
        """Returns False: the life ends where the largest loss is reached."""
        return False


class StiffGrooves(Grooves):
    """Grooves whose nodes along a life all know their stiffnesses."""

    def completed(self, node: Node) -> Node:
        """Returns a node with the stiffnesses of its states; as it is if these are not solved."""
        if self.by_stiffness or node.status != code.OK:
            return node
        states = node.states if node.states is self.last else self.state(node.worn)
        if not all(state.is_solved for state in states):
            return node
        return node._replace(states=self.with_stiffness())


def quick_groove_life(
    grooves: Callable[[GrooveMode], Grooves], ends: Criteria | None = None
) -> Life:
    """Returns the life with grooves as they wear, in the quick mode if its states are found.

    Otherwise it is the exact life. Rough states of contacts that hardly carry any load may have
    no next one where exact states have, or seem to lift off.

    grooves: the grooves in a mode, to be followed.
    ends: as in `follow_grooves`.
    """
    life = follow_grooves(grooves(QUICK_GROOVES), ends)
    if life.status in (code.OK, code.CRITERION_NOT_REACHED):
        return life
    return follow_grooves(grooves(EXACT_GROOVES), ends)


def follow_grooves(wearing: Grooves, ends: Criteria | None = None) -> Life:
    """Returns the life with grooves as they wear.

    Its states have the rate at which their loss grows, unless the start is not solved.

    ends: criteria, those of the scene if None.
    """
    method = Adams()
    if wearing.mode.rough:
        method.root_tolerance = _ROUGH_END
    life = follow(wearing, ends or Criteria(wearing.scene), method)
    life.solves = wearing.solves
    if life.nodes[0].status == code.OK:
        pairs = zip(wearing.sides, life.bearings, strict=True)
        rates = [_loss_rates(side, states, life.times) for side, states in pairs]
        for k, node in enumerate(life.nodes):
            states = (
                state.with_values({"ball_diameter_loss_rate": of_side[k]})
                for state, of_side in zip(node.states, rates, strict=True)
            )
            life.nodes[k] = node._replace(states=tuple(states))
    return life


def _loss_rates(side: Worn, states: list[State], times: np.ndarray) -> list[float]:
    """Returns the rate at which `State.loss` of a bearing grows, at each state [m/s].

    It is the slope of the loss over time, to second order. A last step that is short is left out:
    its state has the rate of the one before. A single state has the rate of an unworn contact.

    times: of the states (n,) [s].
    """
    if len(states) < 2:
        first = states[0]
        point = point_of(states[0])
        values = wear_values(
            first.answer.scene,
            np.array([point.D]),
            first["qv"][None],
            first["semi_major_axis"][None],
            point.track[None],
        )
        return [float(values["ball_diameter_loss_rate"])]
    loss = np.array([state.loss for state in states])
    steps = np.diff(times)
    is_last_short = len(times) > 2 and steps[-1] < _SHORT * steps[-2]
    n = len(times) - int(is_last_short)  # rounding of the loss would spoil the slope there
    rates = np.gradient(loss[:n], times[:n], edge_order=2 if n > 2 else 1)
    return np.append(rates, rates[-1:])[: len(times)].tolist()
