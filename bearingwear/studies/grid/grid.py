"""The study's grid: which cases there are, what each is called and how it differs from its scene.

This file imports nothing heavy: the Snakefile reads it each time it is parsed.
"""

import functools
import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from bearingwear.scene.scene import PRELOAD_METHODS
from bearingwear.studies.axis import GRID_KEYS, MOST_DECIMALS, in_name

GRID_AXES = ("preload_method", "friction", "ball_diameter_loss_um")
"""Keys of a grid in a configuration."""


@dataclass(frozen=True)
class Case:
    """One point of the grid."""

    preload_method: str  # one of `scene.PRELOAD_METHODS`
    friction: float  # ball/race friction coefficient [1]
    ball_diameter_loss_um: float  # state of wear the case is solved at [um]

    @property
    def id(self) -> str:
        """Name of the case and of its file."""
        return f"{self.line_id}-{self.loss_id}"

    @property
    def loss_id(self) -> str:
        """Name of its state of wear."""
        return f"loss{self._loss}"

    @property
    def line_id(self) -> str:
        """Name of the line of the grid that the case is on."""
        return f"{self.preload_method}-mu{self._friction}"

    @property
    def changes(self) -> dict[str, Any]:
        """Changes of the scene for this case."""
        return dict(zip(GRID_KEYS.values(), vars(self).values(), strict=True))

    @property
    def label(self) -> str:
        """The case in words."""
        method = self.preload_method.replace("_", " ")
        return f"{method}, mu {self._friction}, loss {self._loss} um"

    @property
    def _friction(self) -> str:
        return in_name(self.friction, 3)

    @property
    def _loss(self) -> str:
        return in_name(self.ball_diameter_loss_um, 2)


@dataclass(frozen=True)
class Grid:
    """The axes of a study of one scene, each sorted; a case is one point of their product."""

    preload_method: tuple[str, ...]
    friction: tuple[float, ...]
    ball_diameter_loss_um: tuple[float, ...]

    def __post_init__(self) -> None:
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
        """Make the grid from values in any order, whole numbers allowed."""
        return cls(
            tuple(sorted(preload_method)),
            tuple(sorted(float(value) for value in friction)),
            tuple(sorted(float(value) for value in ball_diameter_loss_um)),
        )

    def cases(self) -> Mapping[str, Case]:
        """Every case of the grid by its id."""
        return _cases(self)

    @property
    def friction_names(self) -> list[str]:
        """Friction coefficients as they stand in the names of files."""
        return [in_name(mu, 3) for mu in self.friction]

    @property
    def loss_names(self) -> list[str]:
        """Losses of ball diameter as they stand in the names of files."""
        return [in_name(loss, 2) for loss in self.ball_diameter_loss_um]

    def chunks(self, points: int | None) -> list[str]:
        """Names of the files of which each holds about so many points, in whole lines.

        None where a file would hold one line or less: each point then has a file of its own.
        """
        lines = (points or 0) // len(self.ball_diameter_loss_um)
        if lines < 2:
            return []
        names = self.friction_names
        parts = [names[k : k + lines] for k in range(0, len(names), lines)]
        return [
            f"{method}-mu{part[0]}-to-mu{part[-1]}"
            for method in self.preload_method
            for part in parts
        ]

    def friction_names_between(self, first: str, last: str) -> list[str]:
        """Friction coefficients of a chunk, from the first to the last in its name."""
        return [mu for mu in self.friction_names if float(first) <= float(mu) <= float(last)]

    def every_value(self) -> list[Case]:
        """So few cases that each value of each axis is in one of them."""
        first = [values[0] for values in vars(self).values()]
        places = [
            (*first[:k], value, *first[k + 1 :])
            for k, values in enumerate(vars(self).values())
            for value in values
        ]
        return list(itertools.starmap(Case, dict.fromkeys(places)))


@functools.cache  # the rules look up each of their jobs
def _cases(grid: Grid) -> Mapping[str, Case]:
    points = itertools.product(grid.preload_method, grid.friction, grid.ball_diameter_loss_um)
    return MappingProxyType({case.id: case for case in itertools.starmap(Case, points)})
