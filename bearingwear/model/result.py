"""What a solve returns, before any file format sees it."""

from dataclasses import dataclass, field
from typing import Any

from bearingwear.kernels.status import STATUS_NAMES


@dataclass
class Result:
    """Values of one solve.

    Attributes
    ----------
    values : dict
        Keyed by the variable names of `bearingwear.results.variables`; arrays or numbers in SI
        units and radians. A quantity that was not solved is absent.
    attrs : dict
        Global attributes: scene as JSON, fidelity, what was modelled and why, iterations, ...
    wall_time_s : float
        Duration of the solve alone.
    """

    values: dict[str, Any]
    attrs: dict[str, Any] = field(default_factory=dict)
    wall_time_s: float = 0.0

    @property
    def status(self) -> str:
        """Name of the status code."""
        return STATUS_NAMES[int(self.values["status"])]
