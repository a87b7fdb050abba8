"""Numerical errors of lives, estimated by lives with other settings (see `solvers.estimates`)."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.ends import Criteria
from bearingwear.lives.follow import Life, Node
from bearingwear.lives.grooves import (
    EXACT_GROOVES,
    QUICK_GROOVES,
    Grooves,
    follow_grooves,
)
from bearingwear.lives.surfaces import is_one_integral, surface_life
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.thrust_problem import ThrustProblem
from bearingwear.solvers.compose import Remembered, solver_of
from bearingwear.solvers.condition import Accuracy, States
from bearingwear.solvers.estimates import DOUBLED, HALVED, ROUNDING
from bearingwear.solvers.state import State
from bearingwear.solvers.worn.bearing import ARC_STEP

SCATTER = 2.0  # standard errors
EVERY = 4  # states of worn grooves that are compared
WEIGHTS = {Accuracy.HALF_SLIP: HALVED, Accuracy.TWICE_POINTS: DOUBLED}


def surface_error(scene: Scene, life: Life) -> dict:
    """Estimate for a steady life whose contacts stay Hertzian; none without an end of its own."""
    now = life.last.time
    if life.status != code.OK or not now > 0.0:
        return {}
    total = ROUNDING + life.error / now
    for accuracy, weight in WEIGHTS.items():
        states = solver_of(scene, "steady", accuracy)
        if is_one_integral(scene):
            change = _changed_along(life, states, Criteria(scene))
        else:
            other = surface_life(scene, states, quick=True)
            is_alike = (other.status, other.criterion) == (life.status, life.criterion)
            change = abs(other.last.time - now) / now if is_alike else None
        if change is None:
            return {}
        total = total + weight * change
    return {"life_error_estimate": total}


def _changed_along(life: Life, states: Remembered, ends: Criteria) -> float | None:
    """Relative change of a life by other states at its start, middle and end."""
    nodes = [life.nodes[k] for k in (0, len(life.nodes) // 2, -1)]
    states.bearings.near = nodes[0].states[0].answer  # or the first would be solved from nothing
    others = [states.at(node.x) for node in nodes]
    if not all(one.is_solved for one in others):
        return None
    each = zip(nodes, others, strict=True)
    longer = np.array([node.states[0].rate / one.rate - 1.0 for node, one in each])
    change = changed_by(life, longer, nodes, others[-1:], ends)
    return None if change is None else float(change)


def changed_by(
    life: Life,
    longer: np.ndarray,
    nodes: Sequence[Node],
    other_end: Sequence[State],
    ends: Criteria,
) -> Any:
    """Relative change of a life by other states; None if it would end by another criterion.

    `longer` is the relative change of the inverse rates of one bearing or more at some nodes
    (nodes, ...), which is integrated; the margin of the other state at the end shifts the end, by
    its last slope.
    """
    times = np.array([node.time for node in nodes])
    before, left = life.nodes[-2], ends.margins(other_end)
    if np.delete(left, life.criterion).min() <= 0.0:
        return None
    shift = left[life.criterion] / ends.margins(before.states)[life.criterion]
    change = np.trapezoid(longer, times, axis=0) + shift * (times[-1] - before.time)
    return np.abs(change) / times[-1]


class _Compared(Grooves):
    """Grooves of which every few states are solved again, and with other accuracies.

    Again, because the cells lie otherwise then: that alone changes a state by up to 2 %.
    """

    def __init__(self, scene: Scene):
        super().__init__(scene, QUICK_GROOVES)
        self._kept = 0
        self.compared: list[tuple[Node, list[States]]] = []

    def completed(self, node: Node) -> Node:
        if self._kept % EVERY == 0:
            self.compare(node)
        self._kept += 1
        return node

    def compare(self, node: Node) -> None:
        own = [side.problem for side in self.sides]
        other = [side.problem.perturbed(side.scene) for side in self.sides]
        found = []
        for problems in (own, *zip(*other, strict=True)):
            self._solve_with(problems)
            found.append(self.state(node.worn))
        self._solve_with(own)
        self.compared.append((node, found))

    def _solve_with(self, problems: Sequence[ThrustProblem]) -> None:
        for side, problem in zip(self.sides, problems, strict=True):
            side.problem = problem

    def worn_off(self, states: States) -> np.ndarray:
        """Rate of loss of each bearing, from mean depths over the width when new [m/s]."""
        each, share = zip(self.sides, states, strict=True), 0.5 * ARC_STEP
        rates = [side.rate(state.answer) for side, state in each]
        return np.array([w.ball + share * w.grooves.sum() for w in rates])


def groove_errors(scene: Scene, length: float, criterion: int) -> dict:
    """Bound on the error of the steps, and the estimate of all; by lives in longer steps.

    That of the steps is at most twice what steps half as long again change. That of the cells is
    taken from a life with fewer cells; along that, states with half of v_r and with twice the
    points change its rates and its end.

    length, criterion: of the life [s], and what ended it.
    """
    if not length > 0.0:
        return {}
    wearing = _Compared(scene)
    lives = [
        follow_grooves(Grooves(scene, QUICK_GROOVES._replace(cells=EXACT_GROOVES.cells))),
        follow_grooves(wearing),
    ]
    coarse, few = (
        one.last.time if (one.status, one.criterion) == (code.OK, criterion) else math.nan
        for one in lives
    )
    bound = 2.0 * abs(coarse - length)
    values = {"life_error_bound": bound}
    estimate = ROUNDING + (bound + abs(few - coarse)) / length
    if math.isfinite(estimate):
        estimate += _of_accuracies(wearing, lives[1], Criteria(scene))
    if math.isfinite(estimate):
        values["life_error_estimate"] = estimate
    return values


def _of_accuracies(wearing: _Compared, life: Life, ends: Criteria) -> float:
    """Error of a life by v_r and by points, from the states compared; NaN where it is not known."""
    if wearing.compared[-1][0] is not life.last:
        wearing.compare(life.last)
    nodes, found = zip(*wearing.compared, strict=True)
    if not all(one.is_solved for each in found for states in each for one in states):
        return math.nan
    rates = np.array([[wearing.worn_off(states) for states in each] for each in found])
    total = 0.0
    for k, weight in enumerate(WEIGHTS.values(), 1):
        longer = (rates[:, 0] - rates[:, k]) / np.maximum(rates[:, k], np.finfo(float).tiny)
        change = changed_by(life, longer, nodes, found[-1][k], ends)
        total += math.nan if change is None else weight * change.max()
    return total


def integration_error(time: np.ndarray, rate: np.ndarray) -> float:
    """Bound on the error of a trapezoidal integral by steps and by scatter of the runs.

    A third of the change by steps twice as long, plus twice the standard error of the sum. The
    latter comes from the scatter of the nodes about parabolas through their neighbours.
    """
    last = len(time) - 1
    if last < 2:
        return math.nan
    kept = np.r_[0:last:2, last] if last % 2 == 0 else np.r_[0 : last - 2 : 2, last]
    coarse = np.trapezoid(rate[kept], time[kept])
    steps = abs(float(np.trapezoid(rate, time) - coarse)) / 3.0
    left = []
    for k in range(last - 2):
        t = (time[k : k + 4] - time[k]) / (time[k + 3] - time[k])
        apart = t[:, None] - t + np.eye(4)
        weights = 1.0 / apart.prod(axis=1)  # blind to parabolas
        left.append(weights @ rate[k : k + 4] / np.linalg.norm(weights))
    h = np.diff(time)
    shares = 0.5 * (np.append(h, 0.0) + np.append(0.0, h))
    deviation = math.sqrt(np.mean(np.square(left))) if left else 0.0
    return steps + SCATTER * deviation * float(np.linalg.norm(shares))
