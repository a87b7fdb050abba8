"""How far a bearing at the temperatures of its own heat is from running away: theory 28."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from bearingwear.scene.warmth import Thermal
from bearingwear.solvers.thermal import HEAT_TO_PARTS, HeatFlow, conductances

PARTS_OF_BEARING = 3
DIFFERENCE = 1e-3
"""Temperature step of a derivative of the heat [K]: truncation and rounding both below 1e-4."""

PartHeats = Callable[[np.ndarray], np.ndarray | None]
"""Heat of all parts (parts,) [W] at temperatures (bearing, part) [degC]; None without a state."""


def heat_of_parts(heats: Sequence[HeatFlow]) -> np.ndarray:
    """Heat that goes to the parts of all bearings (parts,) [W]."""
    return np.concatenate([HEAT_TO_PARTS @ np.array(heat) for heat in heats])


def heat_slopes(heats: PartHeats, temperatures: np.ndarray) -> np.ndarray | None:
    """Change of the heat of all parts by their temperatures (parts, parts) [W/K]."""
    base = heats(temperatures)
    if base is None:
        return None
    slopes = np.empty((temperatures.size, temperatures.size))
    for k in range(temperatures.size):
        moved = temperatures.copy()
        moved.flat[k] += DIFFERENCE
        there = heats(moved)
        if there is None:
            return None
        slopes[:, k] = (there - base) / DIFFERENCE
    return slopes


def all_conductances(networks: Sequence[Thermal]) -> np.ndarray:
    """Conductances of the parts of all bearings (parts, parts) [W/K]."""
    size = PARTS_OF_BEARING * len(networks)
    G = np.zeros((size, size))
    for k, network in enumerate(networks):
        own = slice(PARTS_OF_BEARING * k, PARTS_OF_BEARING * (k + 1))
        G[own, own] = conductances(network)
    return G


def thermal_margin(networks: Sequence[Thermal], slopes: np.ndarray | None) -> float:
    """Conductance over slope of the heat: above 1 a steady state is stable, at its fold 1.

    The largest real eigenvalue of G^-1 dQ/dT, inverted. Infinite where no heat grows with warmth,
    zero where the slope of the heat is not known because a state is missing beside this one.
    """
    if slopes is None:
        return 0.0
    gains = np.linalg.eigvals(np.linalg.solve(all_conductances(networks), slopes))
    fastest = float(gains.real.max())
    return 1.0 / fastest if fastest > 0.0 else math.inf
