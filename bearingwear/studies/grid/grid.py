"""The grid of a study: its cases, their names, and their differences from the scene.

This file imports nothing heavy, since the Snakefile imports it each time it is parsed.
"""

import functools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.axis import GRID_KEYS, MOST_DECIMALS, loss_name, mu_name

GRID_AXES = ("preload_method", "friction", "ball_diameter_loss_um")
"""Keys of a grid in a configuration."""


@dataclass(frozen=True)
class Case:
    """One point of the grid."""

    preload_method: str  # one of `scene.PRELOAD_METHODS`
    friction: float  # ball/race friction coefficient [1]
    ball_diameter_loss_um: float  # [um]

    @property
    def id(self) -> str:
        """Returns the name of the case and of its file, such as rigid-mu0.050-loss1.00."""
        return f"{self.line_id}-{self.loss_id}"

    @property
    def loss_id(self) -> str:
        """Returns the part of the name that states the wear, such as loss1.00."""
        return f"loss{loss_name(self.ball_diameter_loss_um)}"

    @property
    def line_id(self) -> str:
        """Returns the part of the name that cases of the same line of the grid share."""
        return f"{self.preload_method}-mu{mu_name(self.friction)}"

    @property
    def changes(self) -> dict[str, Any]:
        """Returns the values of this case by the dotted keys of a scene, in units of a scene."""
        # the fields are in the order of the keys
        return dict(zip(GRID_KEYS.values(), vars(self).values(), strict=True))

    @property
    def label(self) -> str:
        """Returns the case in words, such as "constant force, mu 0.050, loss 1.00 um"."""
        method = self.preload_method.replace("_", " ")
        loss = loss_name(self.ball_diameter_loss_um)
        return f"{method}, mu {mu_name(self.friction)}, loss {loss} um"


@dataclass(frozen=True)
class Grid:
    """The axes of a study of one scene, each sorted; a case is one point of their product."""

    preload_method: tuple[str, ...]
    friction: tuple[float, ...]
    ball_diameter_loss_um: tuple[float, ...]

    def __post_init__(self) -> None:
        """Raises a ValueError for an axis without a value, or with one repeated or not allowed."""
        for axis, values in vars(self).items():
            if not values:
                raise ValueError(f"{axis}: got no value, expected at least one")
            if len(set(values)) < len(values):
                raise ValueError(f"{axis}: got {list(values)}, expected each value once")
        for method in self.preload_method:
            if method not in PRELOAD_METHODS:
                raise ValueError(f"preload_method: got {method}, expected {PRELOAD_METHODS}")
        for axis in ("friction", "ball_diameter_loss_um"):
            for value in getattr(self, axis):
                if not value >= 0.0 or value != round(value, MOST_DECIMALS):
                    raise ValueError(
                        f"{axis}: got {value}, expected a number >= 0 with at most {MOST_DECIMALS} "
                        "decimal places"
                    )

    @classmethod
    def from_lists(
        cls,
        preload_method: Iterable[str],
        friction: Iterable[float],
        ball_diameter_loss_um: Iterable[float],
    ) -> "Grid":
        """Returns the grid of values in any order, which may be whole numbers.

        ValueError: no value on an axis, a repeated one, or one that is not allowed.
        """
        return cls(
            preload_method=tuple(sorted(preload_method)),
            friction=tuple(sorted(float(mu) for mu in friction)),
            ball_diameter_loss_um=tuple(sorted(float(loss) for loss in ball_diameter_loss_um)),
        )

    def cases(self) -> Mapping[str, Case]:
        """Returns every case of the grid by its id."""
        return _cases(self)

    @property
    def friction_names(self) -> list[str]:
        """Returns the friction coefficients as in the names of files."""
        return [mu_name(mu) for mu in self.friction]

    @property
    def loss_names(self) -> list[str]:
        """Returns the losses of ball diameter as in the names of files."""
        return [loss_name(loss) for loss in self.ball_diameter_loss_um]

    def chunks(self, points: int | None) -> list[str]:
        """Returns the names of files that contain several whole lines of the grid each.

        A line has the cases of all losses at one preload method and friction. The list is empty if
        a file would contain one line or less: each point then has a file.

        points: number wanted in a file; None for one.
        """
        lines_per_file = (points or 0) // len(self.ball_diameter_loss_um)
        if lines_per_file < 2:
            return []
        names = self.friction_names
        starts = range(0, len(names), lines_per_file)
        parts = [names[start : start + lines_per_file] for start in starts]
        return [
            f"{method}-mu{part[0]}-to-mu{part[-1]}"
            for method in self.preload_method
            for part in parts
        ]

    def friction_names_between(self, first: str, last: str) -> list[str]:
        """Returns the friction coefficients from one to another, as in the names of files.

        first, last: of the coefficients, as in the names of files; both are included.
        """
        return [mu for mu in self.friction_names if float(first) <= float(mu) <= float(last)]

    def cases_of_each_value(self) -> list[Case]:
        """Returns the first case of the grid, and those that differ from it in one value."""
        first_case = Case(**{axis: values[0] for axis, values in vars(self).items()})
        cases = [
            replace(first_case, **{axis: value})
            for axis, values in vars(self).items()
            for value in values
        ]
        return list(dict.fromkeys(cases))


@functools.cache  # the rules of the workflow look up the case of each job
def _cases(grid: Grid) -> Mapping[str, Case]:
    """Returns the cases of a grid by id; read-only, because the mapping is cached."""
    cases = (
        Case(preload_method=method, friction=mu, ball_diameter_loss_um=loss)
        for method in grid.preload_method
        for mu in grid.friction
        for loss in grid.ball_diameter_loss_um
    )
    return MappingProxyType({case.id: case for case in cases})
