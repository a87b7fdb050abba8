"""The solver of a scene, composed of a model, temperatures and what the bearings stand on."""

import itertools

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.films import COVERED, Bare
from bearingwear.solvers.bearing.rotor_balance import ROTOR_BALANCED
from bearingwear.solvers.condition import (
    Accuracy,
    Condition,
    Conditions,
    Solver,
    States,
)
from bearingwear.solvers.race_control import RaceControl
from bearingwear.solvers.rotor import Alone, OnRotor, RotorState, states_of
from bearingwear.solvers.state import State
from bearingwear.solvers.steady import Steady
from bearingwear.solvers.warm import Warm
from bearingwear.solvers.worn.solver import Worn

WORN_BALANCED = 1e-6  # force left on a rotor with worn grooves, over the larger one
WELL_BALANCED = 1e-7  # of many lives: a tenth of a life's tolerance
LIFE_BALANCED = 1e-9  # force left on the rotor in a state of a life, over the larger one


class Remembered:
    """States by their conditions, each solved once, from the nearest that is known."""

    def __init__(self, bearings: Alone | OnRotor):
        self.bearings = bearings
        self._known: dict[Conditions, States] = {}
        self._solved: dict[tuple[Bare, ...], list[tuple[float, float, RotorState]]] = {}

    def __call__(self, conditions: Conditions) -> States:
        if conditions not in self._known:
            first, last = conditions[0].loss, conditions[-1].loss  # the same of one bearing
            films = tuple(one.bare for one in conditions)
            found = self.bearings.solve(conditions, self._nearest(films, first, last))
            if found.status == code.OK:
                self._solved.setdefault(films, []).append((first, last, found))
            self._known[conditions] = states_of(self.bearings.sides, conditions, found)
        return self._known[conditions]

    def _nearest(self, films: tuple[Bare, ...], first: float, last: float) -> RotorState | None:
        """The state known of the nearest losses, with the same films where there is one."""
        known = self._solved.get(films) or list(itertools.chain(*self._solved.values()))
        if not known:
            return None
        return min(known, key=lambda one: abs(one[0] - first) + abs(one[1] - last))[2]

    def at(self, loss: float, bare: Bare = COVERED) -> State:
        """State of one bearing at a loss of ball diameter [m], in some contacts without film."""
        return self((Condition(loss, bare),))[0]

    @property
    def solves(self) -> int:
        return len(self._known)

    @property
    def failed(self) -> int:
        """How many of them were not found."""
        return len(self._known) - sum(map(len, self._solved.values()))


def solver_of(
    scene: Scene,
    fidelity: str = "steady",
    accuracy: Accuracy = Accuracy.BRIEF,
    tolerance: float | None = None,
) -> Remembered:
    """The states of a scene.

    Parameters
    ----------
    scene : Scene
    fidelity : str
        `steady` or `race_control`.
    accuracy : Accuracy
    tolerance : float, optional
        Force left on a rotor, over the larger one, if not what goes with the accuracy.
    """
    sides = tuple(_bearing(one, fidelity, accuracy) for one in scene.one_of_alike.sides)
    if len(sides) == 1:
        return Remembered(Alone(scene, sides))
    assert scene.pair is not None
    if tolerance is None:
        tolerance = ROTOR_BALANCED if accuracy is Accuracy.CHECKED else LIFE_BALANCED
    return Remembered(OnRotor(scene, scene.pair, sides, tolerance))


def _bearing(scene: Scene, fidelity: str, accuracy: Accuracy) -> Solver:
    return _warm(Steady(scene, accuracy) if fidelity == "steady" else RaceControl(scene))


def _warm(solver: Solver) -> Solver:
    return solver if solver.scene.thermal is None else Warm(solver)


def worn_bearings(
    scene: Scene, cells: tuple[int, int], accuracy: Accuracy = Accuracy.CHECKED
) -> tuple[int, Alone | OnRotor]:
    """The bearings of a scene with grooves that are followed as they wear, unworn at the start.

    Returns
    -------
    status : int
        Of the unworn state.
    bearings
        By `Worn` where that was found.
    """
    bearings = solver_of(scene, "steady", accuracy, ROTOR_BALANCED).bearings
    found = bearings.solve(bearings.start)
    if found.status != code.OK:
        return found.status, bearings
    sides: list[Solver] = []
    for side, unworn in zip(bearings.sides, found.sides, strict=True):
        worn = Worn(side.scene, unworn, cells)
        if worn.bearing.status != code.OK:
            return worn.bearing.status, bearings
        sides.append(_warm(worn))
    if isinstance(bearings, Alone):
        return found.status, Alone(scene, tuple(sides))
    return found.status, OnRotor(scene, bearings.arrangement, tuple(sides), WORN_BALANCED)
