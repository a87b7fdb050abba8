"""Conditions of a bearing, its solutions, and the interface of the solvers."""

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
    """An axial displacement that is kept."""

    delta_a: float  # [m]


class Force(NamedTuple):
    """An axial force that is kept."""

    F_x: float  # [N]


class Condition(NamedTuple):
    """Inputs that determine the state of a bearing along its life."""

    loss: float  # of ball diameter [m]
    bare: Bare = COVERED  # the contacts on which no film is left
    depths: WornDepths | None = None  # of grooves that are followed as they wear
    hold: Place | Force | None = None  # in place of the preload of the scene


Conditions = tuple[Condition, ...]
"""Conditions of one bearing, or of both on a rotor."""

States = tuple[State, ...]


class Accuracy(Enum):
    """Settings of a solve, by what it is for."""

    CHECKED = auto()  # with a finer rule that the checks of a case compare with
    BRIEF = auto()  # without that: for lives
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
    slope: float = math.nan  # axial stiffness of a solution nearby, where this one has none
    place: float = math.nan  # axial displacement [m]
    problem: Any = None  # that was solved
    answer: Any = None  # of the model's own solver
    warmed: Warmed | None = None  # where a network finds the temperatures

    @property
    def is_usable(self) -> bool:
        """Returns whether other solves may start from the solution, though unverified."""
        return self.status in USABLE

    @property
    def stiffnesses(self) -> dict[str, float]:
        """Returns result variables of the axial stiffness, without one that is not known."""
        values = {
            "axial_stiffness": self.stiffness,
            "quasistatic_axial_stiffness": self.quasistatic,
        }
        return {name: value for name, value in values.items() if not math.isnan(value)}

    @property
    def steepness(self) -> float:
        """Returns the slope of force over place for the next step of a rotor, about [N/m].

        It is that of a solution nearby if there is one, else the quasi-static stiffness if that is
        positive, else the dynamic one.
        """
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
        """Returns the relative error of the heat, where the balance of the solver is rough."""

    def __call__(self, condition: Condition, near: SolvedBearing | None = None) -> SolvedBearing:
        """Returns the bearing solved, from a usable solution nearby if there is one."""

    def mechanics(self, loss: float, Omega: float | None = None) -> Mechanics:
        """Returns the bearing without friction, its balls orbiting freely or at `Omega` [rad/s]."""

    def with_motion_of_case(
        self, solution: SolvedBearing, values: dict[str, Any]
    ) -> SolvedBearing | None:
        """Returns the solution with the motion in result variables of a case, None if it has that.

        values: result variables of the case.
        """

    def at(self, scene: Scene) -> "Solver":
        """Returns the solver at other temperatures, those of a scene."""

    def heat(self, solution: SolvedBearing) -> HeatFlow:
        """Returns the heat of friction and drag in a solution."""

    def state(self, solution: SolvedBearing) -> State:
        """Returns a solution as a state along a life: its status, and result variables."""

    def case(self, solution: SolvedBearing) -> CaseValues:
        """Returns a solution as a case: all its values and attributes."""


class Wrapper:
    """A solver around another one, to which it passes on what it does not change."""

    def __init__(self, solver: Solver):
        self.solver, self.scene = solver, solver.scene
        self.mounted, self.start, self.unsteady = solver.mounted, solver.start, solver.unsteady

    @property
    def heat_error(self) -> float:
        """Returns the relative error of the heat, as the solver within has it."""
        return self.solver.heat_error

    def mechanics(self, loss: float, Omega: float | None = None) -> Mechanics:
        """Returns the bearing without friction at a loss [m], as the solver within has it."""
        return self.solver.mechanics(loss, Omega)

    def heat(self, solution: SolvedBearing) -> HeatFlow:
        """Returns the heat of friction and drag, as the solver within has it."""
        return self.solver.heat(solution)

    def state(self, solution: SolvedBearing) -> State:
        """Returns the state of a life, as the solver within has it."""
        return self.solver.state(solution)

    def case(self, solution: SolvedBearing) -> CaseValues:
        """Returns values and attributes of the case, as the solver within has them."""
        return self.solver.case(solution)

    def with_motion_of_case(
        self, solution: SolvedBearing, values: dict[str, Any]
    ) -> SolvedBearing | None:
        """Returns the solution with the motion in a case's result variables `values`.

        None if the solution has that motion, as the solver within has it.
        """
        return self.solver.with_motion_of_case(solution, values)


def innermost(solver: Any) -> Any:
    """Returns the solver within all wrappers."""
    while isinstance(solver, Wrapper):
        solver = solver.solver
    return solver
