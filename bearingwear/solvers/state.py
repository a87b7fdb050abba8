"""The state of a bearing along a life: values by the names of result variables."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from bearingwear.kernels import status as code

HISTORY = (
    "ball_diameter_loss",
    "residual_preload",
    "total_qv",
    "qv",
    "contact_angle",
    "contact_load",
    "semi_major_axis",
    "maximum_pressure",
    "gyroscopic_slip_share",
    "skid_ratio",
    "ball_diameter_loss_rate",
    "ball_wear_rate",
    "race_wear_rate",
    "axial_displacement",
    "friction_used_by_gyroscopic_moment",
    "system_axial_stiffness",
    "system_quasistatic_axial_stiffness",
    "rotor_axial_shift",
    "part_temperature",
    "thermal_margin",
    "greatest_depth",
)
"""Result variables that are stored for every state along a life."""

OF_EACH_CONTACT = ("contact_load", "contact_angle", "semi_major_axis")


@dataclass(frozen=True, eq=False)
class State:
    """A bearing with some wear, solved or not.

    Values have the names of result variables [SI]; one that is not known is not there. One number,
    or one of each race, represents all balls. The next solve starts from `answer`, the solver's own
    solution.
    """

    status: int
    values: Mapping[str, Any]
    answer: Any = None

    @classmethod
    def unsolved(cls, status: int, loss: float) -> "State":
        """Returns a state that was not solved at a loss of ball diameter [m], with its status."""
        return cls(status, {"ball_diameter_loss": loss})

    @property
    def is_solved(self) -> bool:
        """Returns whether the state is solved and verified."""
        return self.status == code.OK

    @property
    def loss(self) -> float:
        """Returns the total wear depth [m], counted as a loss of ball diameter.

        It includes the depths of both grooves if `wear.counts` of the scene does.
        """
        return self.values["ball_diameter_loss"]

    @property
    def rate(self) -> float:
        """Returns the rate at which `loss` grows [m/s]."""
        return self.values["ball_diameter_loss_rate"]

    def __getitem__(self, name: str) -> Any:
        """Returns a value by its name; NaN where it is not known."""
        return self.values.get(name, math.nan)

    def with_values(self, values: Mapping[str, Any]) -> "State":
        """Returns the state with more values, or others of the same names."""
        return State(self.status, {**self.values, **values}, self.answer)


def case_state(loss: float, values: Mapping[str, Any]) -> State:
    """Returns the state of a solved case at a loss of ball diameter, as in `State.loss` [m].

    Its values are means over the balls, and the largest of some that may end a life. It is
    `unsolved` if the case is. Without friction, `friction_used_by_gyroscopic_moment` is infinite.
    """
    status = int(values["status"])
    if status != code.OK:
        return State.unsolved(status, loss)
    state_values = {
        name: _mean_or_largest(name, values[name]) for name in _OF_A_CASE if name in values
    }
    # a case has it only with friction; else nothing carries the moment
    state_values.setdefault("friction_used_by_gyroscopic_moment", math.inf)
    return State(status, state_values | {"ball_diameter_loss": loss})


_MEANS = {*OF_EACH_CONTACT, "qv", "ball_wear_rate", "friction_coefficient"}
_LARGEST = {"maximum_pressure", "friction_used_by_gyroscopic_moment"}
_LARGEST_OF_EACH_RACE = {"gyroscopic_slip_share"}
_OF_A_CASE = {*HISTORY, "axial_stiffness", "quasistatic_axial_stiffness", "friction_coefficient"}
_OF_A_CASE -= {"ball_diameter_loss"}


def _mean_or_largest(name: str, values: Any) -> Any:
    """Returns one value for all balls: the largest or the mean, by the variable's name.

    A variable that is not of balls keeps its value.

    values: (n,) of each ball, or (n, 2) of each contact. The latter give (2,) values, one for each
        race; a variable of `_LARGEST` gives one.
    """
    if name in _LARGEST:
        return float(np.max(values))
    if name in _LARGEST_OF_EACH_RACE:
        return np.max(values, axis=0)
    return np.mean(values, axis=0) if name in _MEANS else values


def history_values(states: Sequence[State], names: Iterable[str] = HISTORY) -> dict[str, Any]:
    """Returns result variables along a life, and the largest residual of its heat flows.

    Histories have the prefix `history_`; they are NaN where a state lacks a value that others have.
    """
    histories: dict[str, Any] = {}
    for name in names:
        present = [state.values[name] for state in states if name in state.values]
        if present:
            missing = np.full(np.shape(present[0]), math.nan)
            column = [state.values.get(name, missing) for state in states]
            histories[f"history_{name}"] = np.array(column)
    residuals = [
        state["heat_flow_residual"] for state in states if "heat_flow_residual" in state.values
    ]
    if residuals:
        histories["heat_flow_residual"] = max(residuals)
    return histories
