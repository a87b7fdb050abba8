"""The solver of a scene, composed of a model, temperatures and what the bearings stand on."""

import bisect
from collections.abc import Sequence
from operator import itemgetter

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

WORN_BALANCED = 1e-6  # force left on a rotor with worn grooves, over the larger one
WELL_BALANCED = 1e-7  # of many lives: a tenth of a life's tolerance
LIFE_BALANCED = 1e-9  # force left on the rotor in a state of a life, over the larger one


_LOSS = itemgetter(0)


class Remembered:
    """States by their conditions, each solved once.

    One bearing starts from the nearest loss that is known, two from their last state.
    """

    def __init__(self, bearings: Alone | OnRotor):
        self.bearings = bearings
        self._known: dict[Conditions, States] = {}
        self._solved: dict[Bare, list[tuple[float, SolvedBearing]]] = {}
        self.failed = 0
        """How many of them were not found."""

    def __call__(self, conditions: Conditions) -> States:
        if conditions not in self._known:
            near = self._nearest(conditions[0]) if len(conditions) == 1 else None
            found = self.bearings.solve(conditions, near)
            if found.status != code.OK:
                self.failed += 1
            elif len(conditions) == 1:
                loss, bare, *_ = conditions[0]
                known = self._solved.setdefault(bare, [])
                bisect.insort(known, (loss, found.sides[0]), key=_LOSS)
            self._known[conditions] = states_of(self.bearings, conditions, found)
        return self._known[conditions]

    def _nearest(self, condition: Condition) -> SolvedBearing | None:
        """The bearing at the nearest loss, with the same films where there is one."""
        loss, near = condition.loss, list[tuple[float, SolvedBearing]]()
        same = self._solved.get(condition.bare)
        for known in [same] if same else self._solved.values():
            k = bisect.bisect(known, loss, key=_LOSS)
            near += known[max(k - 1, 0) : k + 1]
        return min(near, key=lambda one: abs(one[0] - loss))[1] if near else None

    def at(self, loss: float, bare: Bare = COVERED) -> State:
        """State of one bearing at a loss of ball diameter [m], in some contacts without film."""
        return self((Condition(loss, bare),))[0]

    @property
    def solves(self) -> int:
        return len(self._known)


def solver_of(
    scene: Scene,
    fidelity: str = "steady",
    accuracy: Accuracy = Accuracy.BRIEF,
    tolerance: float | None = None,
) -> Remembered:
    """The states of a scene, by the fidelity `steady` or `race_control`.

    The tolerance is the force left on a rotor, over the larger one, if not what goes with the
    accuracy.
    """
    sides = tuple(
        _wrapped(Steady(one, accuracy) if fidelity == "steady" else RaceControl(one))
        for one in scene.one_of_alike.sides
    )
    if len(sides) == 1:
        return Remembered(Alone(scene, sides))
    assert scene.pair is not None
    if tolerance is None:
        tolerance = ROTOR_BALANCED if accuracy is Accuracy.CHECKED else LIFE_BALANCED
    return Remembered(OnRotor(scene, scene.pair, sides, tolerance))


def _wrapped(solver: Solver) -> Solver:
    """The solver with the effects on the state that its scene asks for."""
    return solver if solver.scene.thermal is None else Warm(solver)


def worn_bearings(scene: Scene, cells: tuple[int, int]) -> tuple[int, Alone | OnRotor]:
    """The bearings of a scene with grooves that are followed as they wear, unworn at the start.

    Returns the status of the unworn state, and its bearings, which are `Worn` where it was found.
    """
    bearings = solver_of(scene, accuracy=Accuracy.CHECKED).bearings
    found = bearings.solve(bearings.start)
    if found.status != code.OK:
        return found.status, bearings
    sides: list[Solver] = []
    for side, unworn in zip(bearings.sides, found.sides, strict=True):
        worn = Worn(side.scene, unworn, cells)
        if worn.bearing.status != code.OK:
            return worn.bearing.status, bearings
        sides.append(_wrapped(worn))
    return found.status, _arranged(scene, bearings, sides)


def worn_elsewhere(bearings: Alone | OnRotor, scene: Scene) -> Alone | OnRotor:
    """Bearings of `worn_bearings` with their grooves at another speed or temperature.

    Their rotor starts where it stood last: even wear says little of where it is.
    """
    each = zip(bearings.sides, scene.one_of_alike.sides, strict=True)
    sides = [_wrapped(innermost(side).elsewhere(one)) for side, one in each]
    arranged = _arranged(scene, bearings, sides)
    if isinstance(bearings, OnRotor) and isinstance(arranged, OnRotor):
        losses, place = bearings.nearby.last
        arranged.nearby = Nearby(place=place, losses=losses)
    return arranged


def _arranged(scene: Scene, bearings: Alone | OnRotor, sides: Sequence[Solver]) -> Alone | OnRotor:
    """Sides in the arrangement of others."""
    if isinstance(bearings, Alone):
        return Alone(scene, tuple(sides))
    assert scene.pair is not None
    return OnRotor(scene, scene.pair, tuple(sides), WORN_BALANCED)
