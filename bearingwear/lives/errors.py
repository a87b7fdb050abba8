"""Estimates of the numerical errors of lives, by lives with other settings.

The weights of the settings are those of `solvers.estimates`.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

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
EVERY = 4  # one in this many states of worn grooves is compared
WEIGHTS = {Accuracy.HALF_SLIP: HALVED, Accuracy.TWICE_POINTS: DOUBLED}


def surface_error(scene: Scene, life: Life) -> dict:
    """Returns the estimate of the relative error of a steady life with Hertzian contacts [1].

    It is `life_error_estimate`: rounding, the error of the steps, and the weighted changes of the
    life by each accuracy of `WEIGHTS`. The dictionary is empty where the life met no criterion, has
    no length, or ends by another criterion with another accuracy.
    """
    length = life.last.time
    if life.status != code.OK or not length > 0.0:
        return {}
    estimate = ROUNDING + life.error / length
    for accuracy, weight in WEIGHTS.items():
        solver = solver_of(scene, "steady", accuracy)
        if is_one_integral(scene):
            change = _change_by_solver(life, solver, Criteria(scene))
        else:
            other = surface_life(scene, solver, quick=True)
            change = abs(other.last.time - length) / length if other.ends_like(life) else None
        if change is None:
            return {}
        estimate = estimate + weight * change
    return {"life_error_estimate": estimate}


def _change_by_solver(life: Life, solver: Remembered, ends: Criteria) -> float | None:
    """Returns the magnitude of the relative change of a life by another solver [1].

    That solver solves the start, the middle and the end of the life, which is that of one bearing
    over its loss. None where a state is not solved, or another criterion ends the life.
    """
    nodes = life.three_nodes()
    solver.bearings.near = nodes[0].states[0].answer  # or the first would be solved from nothing
    others = [solver.at(node.x) for node in nodes]
    if not all(other.is_solved for other in others):
        return None
    pairs = zip(nodes, others, strict=True)
    slowing = np.array([node.states[0].rate / other.rate - 1.0 for node, other in pairs])
    change = relative_life_change(life, slowing, nodes, others[-1:], ends)
    return None if change is None else float(change)


def relative_life_change(
    life: Life,
    slowing: np.ndarray,
    nodes: Sequence[Node],
    other_end: Sequence[State],
    ends: Criteria,
) -> Any:
    """Returns the magnitude of the relative change of a life by other states of its bearings [1].

    It is a number, or one for each bearing if `slowing` has them. The change of the inverse wear
    rates is integrated over time. The margin of the other states at the end shifts the end, by the
    last slope of that margin. None if the other states at the end meet another criterion than that
    of the life.

    slowing: relative changes of the inverse wear rates, (nodes,) or (nodes, bearings) [1].
    nodes: nodes of the life at which `slowing` is known.
    other_end: the other states of the bearings, at the wear of the last node.
    """
    times = np.array([node.time for node in nodes])
    before = life.nodes[-2]
    margins = ends.margins(other_end)
    if np.delete(margins, life.criterion).min() <= 0.0:
        return None
    shift = margins[life.criterion] / ends.margins(before.states)[life.criterion]
    change = np.trapezoid(slowing, times, axis=0) + shift * (times[-1] - before.time)
    return np.abs(change) / times[-1]


class _ComparedNode(NamedTuple):
    """A node of a life with worn grooves, and other states of its bearings with the same wear."""

    node: Node
    solved_again: States
    by_accuracy: list[States]  # in the order of `WEIGHTS`

    @property
    def is_solved(self) -> bool:
        """Returns whether all these states are solved."""
        states_of_node = [self.solved_again, *self.by_accuracy]
        return all(state.is_solved for states in states_of_node for state in states)


class _ComparedGrooves(Grooves):
    """Grooves of which every `EVERY`-th state is solved again, and with other accuracies.

    The state with the accuracy of the life is solved again too: the cells lie otherwise then, which
    alone changes a state by up to 2 %.
    """

    def __init__(self, scene: Scene):
        super().__init__(scene, QUICK_GROOVES)
        self._node_count = 0
        self.compared: list[_ComparedNode] = []

    def completed(self, node: Node) -> Node:
        """Returns the node as it is; appends every `EVERY`-th one to `compared`."""
        if self._node_count % EVERY == 0:
            self.compared.append(self.compared_node(node))
        self._node_count += 1
        return node

    def compared_node(self, node: Node) -> _ComparedNode:
        """Returns a node with its bearings solved again, and with each accuracy of `WEIGHTS`."""
        problems = [side.problem for side in self.sides]
        perturbed = [side.problem.perturbed(side.scene) for side in self.sides]
        solved_again = self._states_by(problems, node)
        by_accuracy = [self._states_by(others, node) for others in zip(*perturbed, strict=True)]
        self._set_problems(problems)
        return _ComparedNode(node, solved_again, by_accuracy)

    def _states_by(self, problems: Sequence[ThrustProblem], node: Node) -> States:
        """Returns the states of a node by other problems; the bearings keep these problems."""
        self._set_problems(problems)
        return self.state(node.worn)

    def _set_problems(self, problems: Sequence[ThrustProblem]) -> None:
        """Replaces the problem of each bearing."""
        for side, problem in zip(self.sides, problems, strict=True):
            side.problem = problem

    def loss_rates(self, states: States) -> np.ndarray:
        """Returns the rate of loss of each bearing (n,) [m/s].

        It adds the rate of the ball diameter and the mean depth rates of both grooves, over the
        width 2 a of a new contact. Arcs are `ARC_STEP` a apart.
        """
        rates = [side.rate(state.answer) for side, state in zip(self.sides, states, strict=True)]
        return np.array([rate.ball + 0.5 * ARC_STEP * rate.grooves.sum() for rate in rates])


def groove_errors(scene: Scene, length: float, criterion: int) -> dict:
    """Returns result variables of the errors of a groove life: of its steps, and of all settings.

    `life_error_bound` is a bound on the error of its steps [s], NaN if the life with longer steps
    ends by another criterion. `life_error_estimate` is its relative error [1], left out where it is
    not finite. The dictionary is empty for a life of no length.

    Steps 1.5 times as long show the error of the steps, of which the bound is twice the change.
    A life with fewer cells shows the error of the cells. Its states are solved again with half of
    the slip regularisation, and with twice the points, for the error of these.

    length, criterion: of the life [s], and the index of the criterion that ended it.
    """
    if not length > 0.0:
        return {}

    def length_of(life: Life) -> float:
        """Returns the length of another life [s]; NaN if it ends by another criterion."""
        ends_alike = life.status == code.OK and life.criterion == criterion
        return life.last.time if ends_alike else math.nan

    grooves = _ComparedGrooves(scene)
    coarse_mode = QUICK_GROOVES._replace(cells=EXACT_GROOVES.cells)
    coarse = length_of(follow_grooves(Grooves(scene, coarse_mode)))
    few_cells_life = follow_grooves(grooves)
    few_cells = length_of(few_cells_life)
    bound = 2.0 * abs(coarse - length)
    values = {"life_error_bound": bound}
    estimate = ROUNDING + (bound + abs(few_cells - coarse)) / length
    if math.isfinite(estimate):
        estimate += _accuracy_error(grooves, few_cells_life, Criteria(scene))
    if math.isfinite(estimate):
        values["life_error_estimate"] = estimate
    return values


def _accuracy_error(grooves: _ComparedGrooves, life: Life, ends: Criteria) -> float:
    """Returns the relative error of a life by the slip regularisation and by quadrature points [1].

    It is the weighted sum of the changes by each accuracy of `WEIGHTS`, each of the bearing with
    the larger one. It is NaN where a state is not solved, or where another criterion ends the life
    with another accuracy.

    grooves: those that the life was computed with; its last node is compared here if need be.
    """
    compared = grooves.compared
    if compared[-1].node is not life.last:
        compared = [*compared, grooves.compared_node(life.last)]
    if not all(entry.is_solved for entry in compared):
        return math.nan
    nodes = [entry.node for entry in compared]
    # (nodes, bearings)
    rates = np.array([grooves.loss_rates(entry.solved_again) for entry in compared])
    total = 0.0
    for k, weight in enumerate(WEIGHTS.values()):
        others = np.array([grooves.loss_rates(entry.by_accuracy[k]) for entry in compared])
        slowing = (rates - others) / np.maximum(others, np.finfo(float).tiny)
        change = relative_life_change(life, slowing, nodes, compared[-1].by_accuracy[k], ends)
        total += math.nan if change is None else weight * change.max()
    return total


def integration_error(time: np.ndarray, rate: np.ndarray) -> float:
    """Returns a bound on the error of a trapezoidal integral by steps and by scatter of the runs.

    NaN for fewer than three nodes. Otherwise it is a third of the change by steps twice as long,
    plus twice the standard error of the sum. The latter comes from the scatter of the nodes about
    parabolas through their neighbours.

    time, rate: of the nodes (n,).
    """
    last = len(time) - 1
    if last < 2:
        return math.nan
    every_other = np.r_[0:last:2, last] if last % 2 == 0 else np.r_[0 : last - 2 : 2, last]
    coarse = np.trapezoid(rate[every_other], time[every_other])
    step_error = abs(float(np.trapezoid(rate, time) - coarse)) / 3.0
    scatter = []
    for k in range(last - 2):
        t = (time[k : k + 4] - time[k]) / (time[k + 3] - time[k])
        distances = t[:, None] - t + np.eye(4)
        coefficients = 1.0 / distances.prod(axis=1)  # of a third difference: blind to parabolas
        scatter.append(coefficients @ rate[k : k + 4] / np.linalg.norm(coefficients))
    h = np.diff(time)
    weights = 0.5 * (np.append(h, 0.0) + np.append(0.0, h))  # of the nodes in the integral
    deviation = math.sqrt(np.mean(np.square(scatter))) if scatter else 0.0
    return step_error + SCATTER * deviation * float(np.linalg.norm(weights))
