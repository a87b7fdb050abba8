"""The shortest ramp to speed on which a limit of preload or contact pressure is kept."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.solvers.warmup.transient import COARSER, STEP_TOLERANCE, ramp, warm_up
from bearingwear.studies.warmup.result import peaks_of


class PeakLimit(NamedTuple):
    """A peak of a warm-up that a ramp may keep below a limit."""

    peak: str
    unit_size: float  # [SI]
    unit: str


LIMITS = {
    "pressure": PeakLimit("maximum_pressure", 1e9, "GPa"),
    "preload": PeakLimit("residual_preload", 1.0, "N"),
}

FIRST_RAMP, LONGEST_RAMP = 1.0, 1e5
"""Ramps [s] between which the shortest one is looked for."""

RAMP_TOLERANCE = 0.02
"""Relative accuracy of the ramp, which is rounded up."""


def limits_hold(scene: Scene, seconds: float, limits: Mapping[str, float]) -> bool:
    """Returns whether all limits hold from rest to the steady temperatures at speed."""
    warmup = warm_up(scene, ramp(seconds), tolerance=COARSER * STEP_TOLERANCE)
    if warmup.status != code.OK:
        return False
    peaks = peaks_of(scene, warmup)
    return all(
        peaks[f"peak_{LIMITS[name].peak}"] <= limit * LIMITS[name].unit_size
        for name, limit in limits.items()
    )


def shortest_ramp(scene: Scene, limits: Mapping[str, float]) -> float | None:
    """Returns the shortest time from rest to speed [s] that keeps all limits; None without one.

    It is zero where they hold without a ramp. A longer ramp is taken to have lower peaks, as the
    housing has more time to follow.
    """
    if limits_hold(scene, 0.0, limits):
        return 0.0
    if not limits_hold(scene, LONGEST_RAMP, limits):
        return None
    low, high = FIRST_RAMP, LONGEST_RAMP
    if limits_hold(scene, low, limits):
        return low
    while high > (1.0 + RAMP_TOLERANCE) * low:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if limits_hold(scene, middle, limits) else (middle, high)
    return float(f"{1.005 * high:.3g}")
