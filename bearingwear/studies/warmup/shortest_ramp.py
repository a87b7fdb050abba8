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

RAMPS = (0.0, *(float(f"{10.0 ** (k / 2):.3g}") for k in range(11)))
"""Ramps [s] that are tried one after the other: none, and from 1 s to 1e5 s."""

RAMP_TOLERANCE = 0.02
"""Relative accuracy of the ramp, which is rounded up."""


class ShortestRamp(NamedTuple):
    """The shortest ramp that keeps all limits, among those that are tried."""

    seconds: float
    broken_by: tuple[float, ...]  # longer ramps of `RAMPS` that break a limit again [s]


def limits_hold(
    scene: Scene,
    seconds: float,
    limits: Mapping[str, float],
    tolerance: float = COARSER * STEP_TOLERANCE,
) -> bool:
    """Returns whether all limits hold from rest to the steady temperatures at speed."""
    warmup = warm_up(scene, ramp(seconds), tolerance=tolerance)
    if warmup.status != code.OK:
        return False
    peaks = peaks_of(scene, warmup)
    return all(
        peaks[f"peak_{LIMITS[name].peak}"] <= limit * LIMITS[name].unit_size
        for name, limit in limits.items()
    )


def shortest_ramp(scene: Scene, limits: Mapping[str, float]) -> ShortestRamp | None:
    """Returns the shortest time from rest to speed that keeps all limits; None without one.

    It is zero where they hold without a ramp. All of `RAMPS` are tried, as a longer ramp need not
    have lower peaks: it may meet a shaft that is warm in a housing that is not. Between the first
    of them that keeps the limits and the one before, a longer ramp is taken to have lower peaks.
    The answer keeps them with the steps of `bearingwear warmup`.
    """
    keeps = [limits_hold(scene, seconds, limits) for seconds in RAMPS]
    for first in (k for k, holds in enumerate(keeps) if holds):
        seconds = _between(scene, limits, first) if first > 1 else RAMPS[first]
        while not limits_hold(scene, seconds, limits, STEP_TOLERANCE):
            seconds = float(f"{(1.0 + RAMP_TOLERANCE) * seconds:.3g}")
            if not 0.0 < seconds <= RAMPS[first]:
                break
        else:
            later = zip(RAMPS[first:], keeps[first:], strict=True)
            return ShortestRamp(seconds, tuple(longer for longer, holds in later if not holds))
    return None


def _between(scene: Scene, limits: Mapping[str, float], first: int) -> float:
    """Returns the shortest ramp [s] that keeps all limits up to one that does, rounded up.

    first: number of that one, of `RAMPS`.
    """
    low, high = RAMPS[first - 1], RAMPS[first]
    while high > (1.0 + RAMP_TOLERANCE) * low:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if limits_hold(scene, middle, limits) else (middle, high)
    return min(float(f"{1.005 * high:.3g}"), RAMPS[first])
