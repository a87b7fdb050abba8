"""The solver of a scene, composed of a model, temperatures and the arrangement of the bearings."""

import bisect
from collections.abc import Sequence
from operator import attrgetter
from typing import NamedTuple

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.films import COVERED, Bare
from bearingwear.solvers.bearing.rotor_balance import ROTOR_BALANCED, Nearby
from bearingwear.solvers.bearing_states import states_of
from bearingwear.solvers.condition import (
    Accuracy,
    Condition,
    Conditions,
    SolvedBearing,
    Solver,
    States,
    innermost,
)
from bearingwear.solvers.race_control import RaceControl
from bearingwear.solvers.rotor import Alone, OnRotor
from bearingwear.solvers.state import State
from bearingwear.solvers.steady import Steady
from bearingwear.solvers.warm import Warm
from bearingwear.solvers.worn.solver import Worn

WORN_BALANCED = 1e-6  # unbalanced force on a rotor with worn grooves, over the larger one
WELL_BALANCED = 1e-7  # the same in many lives: a tenth of a life's tolerance
LIFE_BALANCED = 1e-9  # the same in a state of a life


class _SolutionAt(NamedTuple):
    """A solution at a loss of ball diameter."""

    loss: float  # [m]
    solution: SolvedBearing


_LOSS = attrgetter("loss")


class Remembered:
    """States by their conditions, each solved once.

    One bearing starts from the nearest loss that was solved, two from their last state.
    """

    def __init__(self, bearings: Alone | OnRotor):
        self.bearings = bearings
        self._states: dict[Conditions, States] = {}
        self._solutions: dict[Bare, list[_SolutionAt]] = {}  # by rising loss
        self.failed = 0
        """Number of conditions without a state."""

    def __call__(self, conditions: Conditions) -> States:
        """Returns the states of the bearings in their conditions."""
        if conditions not in self._states:
            near = self._nearest_solution(conditions[0]) if len(conditions) == 1 else None
            rotor = self.bearings.solve(conditions, near)
            if rotor.status != code.OK:
                self.failed += 1
            elif len(conditions) == 1:
                (condition,), (solution,) = conditions, rotor.sides
                solutions = self._solutions.setdefault(condition.bare, [])
                bisect.insort(solutions, _SolutionAt(condition.loss, solution), key=_LOSS)
            self._states[conditions] = states_of(self.bearings, conditions, rotor)
        return self._states[conditions]

    def _nearest_solution(self, condition: Condition) -> SolvedBearing | None:
        """Returns the solution at the nearest loss, None if there is none.

        It is one with the same films if there is any.
        """
        loss = condition.loss
        same_films = self._solutions.get(condition.bare)
        candidates = [same_films] if same_films else list(self._solutions.values())
        neighbours: list[_SolutionAt] = []
        for solutions in candidates:
            k = bisect.bisect(solutions, loss, key=_LOSS)
            neighbours += solutions[max(k - 1, 0) : k + 1]
        if not neighbours:
            return None
        return min(neighbours, key=lambda neighbour: abs(neighbour.loss - loss)).solution

    def at(self, loss: float, bare: Bare = COVERED) -> State:
        """Returns the state of one bearing at a loss [m], some contacts without film."""
        return self((Condition(loss, bare),))[0]

    @property
    def solves(self) -> int:
        """Returns the number of conditions solved."""
        return len(self._states)


def solver_of(
    scene: Scene,
    fidelity: str = "steady",
    accuracy: Accuracy = Accuracy.BRIEF,
    tolerance: float | None = None,
) -> Remembered:
    """Returns the solver of a scene's states by the fidelity `steady` or `race_control`.

    accuracy: settings of the fidelity `steady`, and the balance of a rotor.
    tolerance: unbalanced force on a rotor, over the larger one, if it is not that of the accuracy.
    """
    sides = tuple(
        _with_wrappers(Steady(side, accuracy) if fidelity == "steady" else RaceControl(side))
        for side in scene.symmetric_half.sides
    )
    if len(sides) == 1:
        return Remembered(Alone(scene, sides))
    assert scene.pair is not None
    if tolerance is None:
        tolerance = ROTOR_BALANCED if accuracy is Accuracy.CHECKED else LIFE_BALANCED
    return Remembered(OnRotor(scene, scene.pair, sides, tolerance))


def _with_wrappers(solver: Solver) -> Solver:
    """Returns the solver within the wrappers that its scene requires: `Warm` with a network."""
    return solver if solver.scene.thermal is None else Warm(solver)


def worn_bearings(scene: Scene, cells: tuple[int, int]) -> tuple[int, Alone | OnRotor]:
    """Returns a status, and the bearings of a scene with grooves that can wear.

    The unworn state may not be found, or its contacts may not fit into cells. The status is then
    that of the failure, and the bearings are the unworn ones.

    cells: numbers along the major axis, and on each side of it.
    """
    bearings = solver_of(scene, accuracy=Accuracy.CHECKED).bearings
    rotor = bearings.solve(bearings.start)
    if rotor.status != code.OK:
        return rotor.status, bearings
    sides: list[Solver] = []
    for side, unworn in zip(bearings.sides, rotor.sides, strict=True):
        worn = Worn(side.scene, unworn, cells)
        if worn.bearing.status != code.OK:
            return worn.bearing.status, bearings
        sides.append(_with_wrappers(worn))
    return rotor.status, _in_arrangement(scene, bearings, sides)


def worn_elsewhere(bearings: Alone | OnRotor, scene: Scene) -> Alone | OnRotor:
    """Returns bearings of `worn_bearings` with their grooves at another speed or temperature.

    The grooves of the bearings that are passed wear no further, either. The rotor starts from its
    last place, as the losses alone say little about it.

    scene: with that speed or temperature.
    """
    sides = [
        _with_wrappers(innermost(side).elsewhere(side_scene))
        for side, side_scene in zip(bearings.sides, scene.symmetric_half.sides, strict=True)
    ]
    arranged = _in_arrangement(scene, bearings, sides)
    if isinstance(bearings, OnRotor) and isinstance(arranged, OnRotor):
        losses, place = bearings.nearby.last
        arranged.nearby = Nearby(place=place, losses=losses)
    return arranged


def _in_arrangement(
    scene: Scene, bearings: Alone | OnRotor, sides: Sequence[Solver]
) -> Alone | OnRotor:
    """Returns solvers of bearings in a scene's arrangement: alone or on a rotor, as `bearings`."""
    if isinstance(bearings, Alone):
        return Alone(scene, tuple(sides))
    assert scene.pair is not None
    return OnRotor(scene, scene.pair, tuple(sides), WORN_BALANCED)
