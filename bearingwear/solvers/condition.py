"""What a solver of a bearing is asked, and what it answers."""

import math
from enum import Enum, auto
from typing import Any, NamedTuple, Protocol

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.at_rest import Mechanics
from bearingwear.solvers.bearing.films import COVERED, Bare
from bearingwear.solvers.state import State
from bearingwear.solvers.thermal import HeatFlow, Warmed
from bearingwear.solvers.worn.depths import WornDepths

USABLE = (code.OK, code.UNVERIFIED)


class Place(NamedTuple):
    delta_a: float  # [m]


class Force(NamedTuple):
    F_x: float  # [N]


class Condition(NamedTuple):
    """Inputs that determine the state of a bearing along its life."""

    loss: float  # of ball diameter [m]
    bare: Bare = COVERED  # the contacts on which no film is left
    depths: WornDepths | None = None  # of grooves that are followed as they wear
    hold: Place | Force | None = None  # in place of the preload of the scene


Conditions = tuple[Condition, ...]
"""Of one bearing, or of both on a rotor."""

States = tuple[State, ...]


class Accuracy(Enum):
    """Settings of a solve, by what it is for."""

    CHECKED = auto()  # with the finer copies that the checks of a case compare with
    BRIEF = auto()  # without: for lives
    HALF_SLIP = auto()  # half the regularisation of the slip
    TWICE_POINTS = auto()  # twice the points in a contact


class SolvedBearing(NamedTuple):
    """A bearing solved in a condition, or why it is not."""

    status: int
    condition: Condition
    scene: Scene  # at the temperatures of the solution
    force: float = math.nan  # axial, of its inner race on the balls [N]
    stiffness: float = math.nan  # axial, dynamic [N/m]
    quasistatic: float = math.nan  # axial, quasi-static [N/m]
    slope: float = math.nan  # axial stiffness of a solution nearby, where its own is not known
    place: float = math.nan  # axial displacement [m]
    problem: Any = None  # that was solved
    answer: Any = None  # of the model's own solver
    warmed: Warmed | None = None  # where a network finds the temperatures

    @property
    def is_usable(self) -> bool:
        return self.status in USABLE

    @property
    def stiffnesses(self) -> dict[str, float]:
        """Result variables of the axial stiffness, without one that is not known."""
        both = {
            "axial_stiffness": self.stiffness,
            "quasistatic_axial_stiffness": self.quasistatic,
        }
        return {name: value for name, value in both.items() if not math.isnan(value)}

    @property
    def steepness(self) -> float:
        """Of the force over the place, about; NaN and falling ones are no use [N/m]."""
        if not math.isnan(self.slope):
            return self.slope
        return self.quasistatic if self.quasistatic > 0.0 else self.stiffness


CaseValues = tuple[dict[str, Any], dict[str, Any]]
"""Values and attributes of a result."""


class Solver(Protocol):
    """One bearing by one model."""

    scene: Scene
    mounted: float  # axial displacement at rest, unworn, under the preload [m]
    start: Condition  # as the scene has it
    unsteady: int  # status where a rotor finds no place in which it stays

    @property
    def heat_error(self) -> float:
        """Relative error of the heat, where the balance of the solver is rough."""

    def __call__(self, condition: Condition, near: SolvedBearing | None = None) -> SolvedBearing:
        """Solve, from a usable solution nearby where there is one."""

    def mechanics(self, loss: float, Omega: float | None = None) -> Mechanics:
        """The bearing without friction, its balls orbiting as they roll or at `Omega` [rad/s]."""

    def moved(self, solution: SolvedBearing, values: dict[str, Any]) -> SolvedBearing | None:
        """The solution with the motion that a case took in its place; None where it kept it."""

    def at(self, scene: Scene) -> "Solver": ...  # at other temperatures, those of the scene
    def heat(self, solution: SolvedBearing) -> HeatFlow: ...  # of friction and drag
    def state(self, solution: SolvedBearing) -> State: ...  # for a life
    def case(self, solution: SolvedBearing) -> CaseValues: ...  # all that a case has


class Wrapper:
    """A solver round another one, to which it hands on what it does not change."""

    def __init__(self, solver: Solver):
        self.solver, self.scene = solver, solver.scene
        self.mounted, self.start, self.unsteady = solver.mounted, solver.start, solver.unsteady

    @property
    def heat_error(self) -> float:
        return self.solver.heat_error

    def mechanics(self, loss: float, Omega: float | None = None) -> Mechanics:
        return self.solver.mechanics(loss, Omega)

    def heat(self, solution: SolvedBearing) -> HeatFlow:
        return self.solver.heat(solution)

    def state(self, solution: SolvedBearing) -> State:
        return self.solver.state(solution)

    def case(self, solution: SolvedBearing) -> CaseValues:
        return self.solver.case(solution)

    def moved(self, solution: SolvedBearing, values: dict[str, Any]) -> SolvedBearing | None:
        return self.solver.moved(solution, values)


def innermost(solver: Any) -> Any:
    while isinstance(solver, Wrapper):
        solver = solver.solver
    return solver
