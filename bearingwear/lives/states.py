"""States of one bearing or two whose contacts stay Hertzian, as a life asks for them."""

from collections.abc import Callable
from typing import NamedTuple

from bearingwear.kernels import status as code
from bearingwear.lives.follow import States
from bearingwear.model.films import COVERED, Bare
from bearingwear.model.pair import Pair, SteadySide
from bearingwear.model.state import State
from bearingwear.model.states_at_loss import race_control_states, steady_states
from bearingwear.model.steady import ThrustProblem
from bearingwear.scene.scene import Scene

LIFE_BALANCED = 1e-9  # force left on the rotor in a state of a life, over the larger one
WELL_BALANCED = 1e-7  # of many lives: a tenth of a life's tolerance


class Condition(NamedTuple):
    """What decides the state of a bearing along its life."""

    loss: float  # of ball diameter [m]
    bare: Bare = COVERED


class KnownStates:
    """States of one bearing or two by their conditions, each solved once."""

    def __init__(self, solve: Callable[[tuple[Condition, ...]], States]):
        self._solve = solve
        self._known: dict[tuple[Condition, ...], States] = {}

    def __call__(self, conditions: tuple[Condition, ...]) -> States:
        if conditions not in self._known:
            self._known[conditions] = self._solve(conditions)
        return self._known[conditions]

    @property
    def solves(self) -> int:
        return len(self._known)

    @property
    def failed(self) -> int:
        """How many of them were not found."""
        return sum(first.status != code.OK for first, *_ in self._known.values())


def is_unlike(scene: Scene) -> bool:
    """Whether two bearings differ, or a force makes them."""
    return scene.pair is not None and not scene.pair.is_symmetric


def one_of_alike(scene: Scene) -> Scene:
    """One of two identical bearings; other scenes as they are."""
    return scene.sides[0] if scene.pair is not None and scene.pair.is_symmetric else scene


def states_of(
    scene: Scene, fidelity: str, balance: float = LIFE_BALANCED, perturbed: int | None = None
) -> KnownStates:
    """States of a scene, by its conditions.

    Parameters
    ----------
    balance : float
        Force left on the rotor of an unlike pair, over the larger one.
    perturbed : int, optional
        Which of `ThrustProblem.perturbed` is solved, instead of the scene's own problem.
    """
    if is_unlike(scene):
        return KnownStates(_of_pair(scene, fidelity, balance, perturbed))
    alone = one_of_alike(scene)
    if fidelity != "steady":
        state = race_control_states(alone)
    elif perturbed is None:
        state = steady_states(alone)
    else:
        state = steady_states(alone, ThrustProblem.of(alone).perturbed(alone)[perturbed])
    return KnownStates(lambda conditions: (state(*conditions[0]),))


def _of_pair(
    scene: Scene, fidelity: str, balance: float, perturbed: int | None
) -> Callable[[tuple[Condition, ...]], States]:
    pair = Pair.of(scene, fidelity, balance)
    for side in pair.sides:
        if not isinstance(side, SteadySide):
            continue
        if perturbed is None:
            side.problem = side.problem.without_finer
        else:
            side.problem = side.problem.perturbed(side.scene)[perturbed]

    def solve(conditions: tuple[Condition, ...]) -> States:
        for side, one in zip(pair.sides, conditions, strict=True):
            side.bare = one.bare
        first, second = (one.loss for one in conditions)
        found = pair.solve((first, second))
        if found.status != code.OK:
            return tuple(State.unsolved(found.status, one.loss) for one in conditions)
        each = zip(pair.sides, conditions, found.sides, strict=True)
        return tuple(
            side.life_state(one.loss, state).with_values(found.of_arrangement)
            for side, one, state in each
        )

    return solve
