"""Bearings whose grooves are followed as they wear (theory.md section 21)."""

import math
from dataclasses import replace

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.ends import Criteria
from bearingwear.lives.follow import Life, Node, States, follow
from bearingwear.lives.methods import Heun
from bearingwear.model import parameters
from bearingwear.model.heat import SteadyHeat
from bearingwear.model.outputs import wear_values
from bearingwear.model.pair import Pair
from bearingwear.model.pair_balance import SideState
from bearingwear.model.state import State
from bearingwear.model.states_at_loss import in_half_of_pair
from bearingwear.model.steady import ThrustProblem
from bearingwear.model.thermal import warmed
from bearingwear.model.worn_depths import WornDepths, WornPoint
from bearingwear.model.worn_side import WornSide
from bearingwear.scene.scene import LARGEST_LOSS, Scene

WORN_CELLS = (48, 10)  # along the major axis, and on each side of it
FEWER_CELLS = (32, 8)  # to see the error of the others
STEP = 0.08  # deepest wear of a step, over the gap A a^2
QUICK_STEP = 2.0 * STEP
"""Of a quick life, over the gap; with it go `FEWER_CELLS`."""
WORN_ROTOR_BALANCED = 1e-6  # force left on a rotor, over the larger one
ON_THE_WAY_BALANCED = 1e-4  # the same in the middle of a step
_SHORT = 0.3  # of the step before

Wears = tuple[WornDepths, ...]


def point_of(state: State) -> WornPoint:
    """What has been solved."""
    return state.answer.answer


class Grooves:
    """The wear of the grooves and balls of a bearing, or of two on a rotor.

    Parameters
    ----------
    scene : Scene
    cells, step
        Instead of the usual ones.
    perturbed : int, optional
        Which of `ThrustProblem.perturbed` is solved, instead of the scene's own problem.
    only_times : bool
        Whether states have no stiffness where nothing ends by it.
    """

    origin, range = 0.0, math.inf

    def __init__(
        self,
        scene: Scene,
        cells: tuple[int, int] = WORN_CELLS,
        step: float = STEP,
        perturbed: int | None = None,
        only_times: bool = False,
    ):
        self.scene, self.depth, self.cells, self.perturbed = scene, step, cells, perturbed
        end = scene.wear.end_of_life
        self.by_stiffness = end is not None and end.system_axial_stiffness_N_um is not None
        self.only_times = only_times
        self.solves = 0
        self.pair: Pair | None = None
        self.status = code.OK
        self.sides: tuple[WornSide, ...] = self._pair() if scene.pair else self._single()
        for side in self.sides:
            self.status = self.status or side.bearing.status
        self._last: States = ()  # solved, not on the way

    def _single(self) -> tuple[WornSide, ...]:
        problem = self._problem(self.scene)
        self.status = problem.undetermined()
        if self.status != code.OK:
            return ()
        loss = float(self.scene.wear.ball_diameter_loss_um[0]) * parameters.UM
        case = problem.solve(problem.g.D0 - loss)
        if self.scene.thermal is not None:
            heat = SteadyHeat(loss, problem)
            found = warmed(self.scene, heat)
            if found.status != code.OK:
                self.status = found.status
                return ()
            problem, case = heat.problem, heat.case
        self.status = case.status
        if self.status != code.OK:
            return ()
        return (WornSide(self.scene, 1, problem, case, self.cells),)

    def _pair(self) -> tuple[WornSide, ...]:
        pair = self.scene.pair
        assert pair is not None
        hertz = Pair.of(self.scene, "steady")
        found = hertz.solve(hertz.losses)
        self.status = found.status
        if self.status != code.OK:
            return ()
        sides = []
        for scene, n, state in zip(self.scene.sides, pair.tandem, found.sides, strict=True):
            problem = replace(self._problem(scene), g=state.problem.g)
            problem = replace(problem, preload=state.problem.preload)
            sides.append(WornSide(scene, n, problem, state.answer, self.cells))
        self.pair = Pair(self.scene, sides, WORN_ROTOR_BALANCED)
        return tuple(sides)

    def _problem(self, scene: Scene) -> ThrustProblem:
        problem = ThrustProblem.of(scene)
        return problem if self.perturbed is None else problem.perturbed(scene)[self.perturbed]

    @property
    def start(self) -> Wears:
        return tuple(side.bearing.unworn() for side in self.sides)

    def state(self, worn: Wears, on_the_way: bool = False) -> States:
        """The bearings with some wear; on the way, their answers alone."""
        if self.status != code.OK:
            losses = (scene.wear.ball_diameter_loss_um[0] for scene in self.scene.sides)
            return tuple(State.unsolved(self.status, loss * parameters.UM) for loss in losses)
        self.solves += 1
        for side, wear in zip(self.sides, worn, strict=True):
            side.wear = wear
        shift, (first, *others) = math.nan, self.sides
        if self.pair is None:
            found: tuple[SideState, ...] = (first.alone(),)
            status = found[0].status
        else:
            self.pair.tolerance = ON_THE_WAY_BALANCED if on_the_way else WORN_ROTOR_BALANCED
            both = self.pair.solve((first.progress, others[0].progress))
            found, status, shift = both.sides, both.status, both.shift
        if status != code.OK:
            return tuple(State.unsolved(status, math.nan) for _ in self.sides)
        for side, one in zip(self.sides, found, strict=True):
            side.bearing.count_from(one.answer)
        if on_the_way:
            return tuple(State(status, {}, one) for one in found)
        states = []
        for side, one in zip(self.sides, found, strict=True):
            made = replace(side.life_state(0.0, one), answer=one)
            of_pair = made.with_values({"rotor_axial_shift": shift})
            alone = self.pair is None
            states.append(in_half_of_pair(self.scene, side.mounted, made) if alone else of_pair)
        self._last = tuple(states)
        if self.by_stiffness:
            self._last = self.with_stiffness(self._last)
        return self._last

    def with_stiffness(self, states: States) -> States:
        """The states last solved, with both stiffnesses."""
        each = [*zip(self.sides, states, strict=True)]
        found = [side.with_stiffness(state.answer) for side, state in each]
        of_both = {}
        if self.pair is not None:
            dynamic, other = ([one.stiffness for one in found], [one.quasistatic for one in found])
            of_both["system_axial_stiffness"] = self.pair.stiffness(*dynamic)
            of_both["system_quasistatic_axial_stiffness"] = self.pair.stiffness(*other)
        made = []
        for (side, state), one in zip(each, found, strict=True):
            own = {
                "axial_stiffness": one.stiffness / side.tandem,
                "quasistatic_axial_stiffness": one.quasistatic / side.tandem,
            }
            stiff = state.with_values(own | of_both)
            alone = self.pair is None
            made.append(in_half_of_pair(self.scene, side.mounted, stiff) if alone else stiff)
        return tuple(made)

    def completed(self, node: Node) -> Node:
        """A node that a life keeps, which has its stiffnesses; not if only times count."""
        if self.by_stiffness or self.only_times or node.status != code.OK:
            return node
        states = node.states if node.states is self._last else self.state(node.worn)
        solved = all(state.is_solved for state in states)
        return node._replace(states=self.with_stiffness(states)) if solved else node

    def rates(self, node: Node) -> Wears:
        """Wear per second of each bearing."""
        each = zip(self.sides, node.states, strict=True)
        return tuple(side.rate(point_of(state)) for side, state in each)

    def moved(
        self, worn: Wears, dt: float, rates: Wears, on_the_way: bool = False
    ) -> tuple[Wears, States]:
        """What has worn after the time dt, and the bearings with it."""
        after = tuple(wear.plus(dt, rate) for wear, rate in zip(worn, rates, strict=True))
        return after, self.state(after, on_the_way)

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
            lengths.append(self.depth / (deepest / gap).max())
        return float(min(lengths))

    def is_too_deep(self, now: Node, new: Node) -> bool:
        """Whether a groove wore by far more, having worn through a film."""
        return any(
            side.too_deep(point_of(before), point_of(after), self.depth)
            for side, before, after in zip(self.sides, now.states, new.states, strict=True)
        )

    def wears(self, node: Node) -> bool:
        return max(max(side.factors) for side in self.sides) > 0.0

    def events(self, node: Node) -> np.ndarray:
        """The largest loss that is followed."""
        left = [
            1.0 - state.loss / (LARGEST_LOSS * side.scene.bearing.ball_diameter_mm * parameters.MM)
            for side, state in zip(self.sides, node.states, strict=True)
        ]
        return np.array([min(left)])

    def passes(self, event: int, node: Node) -> bool:
        return False


def follow_grooves(wearing: Grooves) -> Life:
    """The life with grooves as they wear, and the rates at which its even losses grow."""
    life = follow(wearing, Criteria(wearing.scene), Heun())
    life.solves = wearing.solves
    if life.nodes[0].status == code.OK:
        each = zip(wearing.sides, life.bearings, strict=True)
        rates = [_loss_rates(side, states, life.times[:, 1]) for side, states in each]
        life.nodes = [
            node._replace(states=tuple(map(_losing, node.states, of_node)))
            for node, of_node in zip(life.nodes, zip(*rates, strict=True), strict=True)
        ]
    return life


def _losing(state: State, rate: np.ndarray) -> State:
    """A state with the rate of its loss, by both ways of counting [m/s]."""
    return state.with_values({"ball_diameter_loss_rate": rate})


def _loss_rates(side: WornSide, states: list[State], times: np.ndarray) -> list[np.ndarray]:
    """Rates (2,) at which the even loss of a bearing grows, of each state [m/s]."""
    if len(states) < 2:
        first, point = states[0], point_of(states[0])
        worn_by = first["qv"][None], first["semi_major_axis"][None], point.track[None]
        return [wear_values(side.scene, np.array([point.D]), *worn_by)["ball_diameter_loss_rate"]]
    loss = np.array([state.loss for state in states])
    # A last step that is short says nothing of a rate.
    steps = np.diff(times)
    n = len(times) - (len(times) > 2 and steps[-1] < _SHORT * steps[-2])
    rates = np.gradient(loss[:n], times[:n], edge_order=2 if n > 2 else 1)
    return [np.array([np.nan, rate]) for rate in np.append(rates, rates[-1:])[: len(times)]]
