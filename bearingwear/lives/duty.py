"""One state of wear and the steady states of all phases of a duty (theory.md section 28).

The wear of a bearing over a cycle of use is the mean of what wears in each phase and on the way to
its speed. A duty is one more way to wear, whose states are those of all of its conditions.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.ends import NO_CRITERION, Criteria
from bearingwear.lives.follow import Life, Node
from bearingwear.lives.grooves import (
    FEWER_CELLS,
    LONGER_STEP,
    STEP,
    WORN_CELLS,
    Grooves,
    Wears,
    follow_grooves,
)
from bearingwear.lives.surfaces import Surfaces, follow_surfaces
from bearingwear.scene.accuracy import REGULARISATION
from bearingwear.scene.duty import phase_cases
from bearingwear.scene.scene import Scene
from bearingwear.scene.slip import LEAST_REGULARISATION, regularisation_is_given
from bearingwear.solvers.compose import Remembered
from bearingwear.solvers.condition import States
from bearingwear.solvers.worn.depths import WornDepths

NO_FORCE_N = 1e-9
"""External force of a pair that is alike in one phase and not in another: none, but both bearings
are solved."""


def ramp_points(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Speeds over the full one, and weights of the wear rates there, of a ramp by n points.

    A wear rate is the speed times a smooth function of its square, because of the centrifugal
    effects: the mean over a ramp is half the integral of rate over speed over that square. Gauss
    and Radau's points on it include the full speed, at which the phase is solved anyway.
    """
    legendre = np.polynomial.legendre
    low, high = legendre.Legendre.basis(n - 1), legendre.Legendre.basis(n)
    inner = np.sort(((low + high) // legendre.Legendre([1.0, 1.0])).roots().real)
    weights = (1.0 - inner) / (n * low(inner)) ** 2
    squares = 0.5 * (1.0 - np.append(-1.0, inner))  # mirrored: the end is at full speed
    speeds = np.sqrt(squares)
    return speeds, 0.25 * np.append(2.0 / n**2, weights) / speeds


@dataclass(frozen=True)
class Cycle:
    """The conditions of one cycle of a duty, and how much each adds to its mean wear rate.

    Conditions are the cases of the phases, each once, then the speeds on the way to them.
    """

    phases: tuple[str, ...]
    cases: tuple[str, ...]
    scenes: tuple[Scene, ...]  # of the conditions
    case_of_phase: tuple[int, ...]
    running: np.ndarray  # (phases, conditions) shares of the time of a cycle
    starting: np.ndarray  # weights of the rates on the way to the speed of each phase and back

    @property
    def shares(self) -> np.ndarray:
        """Weights (conditions,) of the rates in the mean over a cycle."""
        shares: np.ndarray = (self.running + self.starting).sum(axis=0)
        return shares


def cycle_of(scene: Scene, points: int = 2) -> Cycle:
    """The cycle of a scene's duty, with so many points of each ramp."""
    duty = scene.duty
    assert duty is not None
    scene_of_case = _solved_alike(phase_cases(scene))
    cases = [*scene_of_case]
    ramped = [
        case
        for case in cases
        if duty.ramp_s > 0.0
        and any(p.starts for name, p in duty.phases.items() if duty.case_of(name) == case)
    ]
    speeds, weights = ramp_points(points)
    scenes = [*scene_of_case.values()]
    scenes += [at_speed(scene_of_case[case], s) for case in ramped for s in speeds[1:]]
    running, starting = np.zeros((2, len(duty.phases), len(scenes)))
    for k, (name, phase) in enumerate(duty.phases.items()):
        case = cases.index(duty.case_of(name))
        running[k, case] = duty.running_s(phase) / duty.cycle_s
        if phase.starts and duty.ramp_s > 0.0:
            share = phase.starts * duty.ramp_s / duty.cycle_s
            first = len(cases) + ramped.index(cases[case]) * (points - 1)
            starting[k, case] = share * weights[0]
            starting[k, first : first + points - 1] = share * weights[1:]
    of_phase = tuple(cases.index(duty.case_of(name)) for name in duty.phases)
    return Cycle(tuple(duty.phases), tuple(cases), tuple(scenes), of_phase, running, starting)


def at_speed(scene: Scene, share: float) -> Scene:
    """The scene with both races at a share of their speeds.

    A regularisation that the scene gives follows: its error depends on it over the slip.
    """
    operation = scene.operation
    changes = {
        "operation.shaft_speed_rpm": share * operation.shaft_speed_rpm,
        "operation.outer_speed_rpm": share * operation.outer_speed_rpm,
        "operation.lowest_speed_rpm": 0.0,
    }
    if regularisation_is_given(scene):
        given = share * scene.friction.slip_regularisation_m_s
        changes[REGULARISATION] = max(given, LEAST_REGULARISATION)
    return scene.with_(changes)


def _solved_alike(scenes: dict[str, Scene]) -> dict[str, Scene]:
    """Scenes of cases, each of one bearing or each of two."""
    alone = {name: one.one_of_alike for name, one in scenes.items()}
    if len({len(one.sides) for one in alone.values()}) == 1:
        return alone
    return {
        name: one if len(one.one_of_alike.sides) > 1 else one.with_(
            {"arrangement.external_axial_N": NO_FORCE_N}
        )
        for name, one in scenes.items()
    }  # fmt: skip


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

    @property
    def count(self) -> int:
        """Bearings that are solved in each condition."""
        return len(self.cycle.scenes[0].one_of_alike.sides)

    def nodes(self, node: Node) -> list[Node]:
        """A node of each condition."""
        n = self.count
        parts = (node.states[k * n : (k + 1) * n] for k in range(len(self.each)))
        return [node._replace(states=part) for part in parts]

    def states_by(self, solve: Callable[[Any], States]) -> States:
        """States of the conditions, up to the first that is not solved."""
        found: list[Any] = []
        for way in self.each:
            found += solve(way)
            if any(state.status != code.OK for state in found[-self.count :]):
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
        self,
        cycle: Cycle,
        cells: tuple[int, int] = WORN_CELLS,
        step: float = STEP,
        only_times: bool = False,
        rough: bool = False,
    ):
        self.cycle, self.rough = cycle, rough
        self.each = [Grooves(one, cells, step, only_times, rough) for one in cycle.scenes]
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

    def state(self, worn: Wears, on_the_way: bool = False) -> States:
        return self.states_by(lambda way: way.state(worn, on_the_way))

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
        mean = [WornDepths(0.0, 0.0 * w.grooves, 0.0 * w.band) for w in self.start]
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

    def is_too_deep(self, now: Node, new: Node) -> bool:
        each = zip(self.each, self.nodes(now), self.nodes(new), strict=True)
        return any(way.is_too_deep(*nodes) for way, *nodes in each)

    def wears(self, node: Node) -> bool:
        return any(way.wears(one) for way, one in zip(self.each, self.nodes(node), strict=True))

    def events(self, node: Node) -> np.ndarray:
        each = zip(self.each, self.nodes(node), strict=True)
        return np.min([way.events(one) for way, one in each], axis=0, keepdims=True)[0]


def _are_same(some: Sequence[Any], others: Sequence[Any]) -> bool:
    pairs = zip(some, others, strict=False)
    return len(some) == len(others) and all(a is b for a, b in pairs)


def life_of_case(life: Life, cycle: Cycle, case: int) -> Life:
    """The life over a duty as its bearings are in one of its cases."""
    n = len(cycle.scenes[0].one_of_alike.sides)
    part = slice(case * n, (case + 1) * n)
    nodes = [node._replace(states=node.states[part]) for node in life.nodes]
    return Life(nodes, life.wearing, life.criterion, life.status, life.error, life.solves)


def ending_case(life: Life, cycle: Cycle) -> int:
    """Index of the case that ends a life: in which its criterion is met, or that is not solved.

    The first case of a life without an end of its own.
    """
    if life.status == code.OK and life.criterion < NO_CRITERION:
        of_cases = DutyCriteria(cycle).of_cases(life.last.states)
        return int(np.argmin([margins[life.criterion] for margins in of_cases]))
    failed = life.tried[-1]
    if failed.status != code.OK:
        n = len(cycle.scenes[0].one_of_alike.sides)
        condition = (len(failed.states) - 1) // n
        if condition < len(cycle.cases):
            return condition
        ramp = np.flatnonzero(cycle.starting[:, condition])[0]
        return cycle.case_of_phase[ramp]
    return 0


@dataclass
class DutyLife:
    """A life over a duty, and its cycle."""

    cycle: Cycle
    life: Life

    @property
    def by_case(self) -> dict[str, Life]:
        """The life as its bearings are in each case of the duty: one time, other states."""
        each = enumerate(self.cycle.cases)
        return {name: life_of_case(self.life, self.cycle, k) for k, name in each}


def hertzian_duty_life(
    cycle: Cycle, solvers: Sequence[Remembered], quick: bool = False
) -> Life:
    """The life over a cycle whose contacts stay Hertzian."""
    scene = cycle.scenes[0]
    life = follow_surfaces(DutySurfaces(cycle, solvers), DutyCriteria(cycle), scene, quick)
    life.solves = sum(states.solves for states in solvers)
    return life


def worn_duty_life(cycle: Cycle, quick: bool = False, only_times: bool = False) -> Life:
    """The life over a cycle with grooves as they wear."""
    cells, step = (FEWER_CELLS, LONGER_STEP) if quick else (WORN_CELLS, STEP)
    wearing = DutyGrooves(cycle, cells, step, only_times=only_times, rough=quick)
    return follow_grooves(wearing, DutyCriteria(cycle))
