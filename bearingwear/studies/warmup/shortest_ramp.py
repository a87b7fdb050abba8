"""The shortest ramp to speed on which a limit of preload or contact pressure is kept."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.solvers.warmup.transient import (
    COARSER,
    STEP_TOLERANCE,
    NoState,
    ramp,
    warm_up,
)
from bearingwear.studies.warmup.result import peaks_of


class PeakLimit(NamedTuple):
    """A peak of a warm-up that a ramp may keep below a limit."""

    peak: str  # of `result.PEAKS`
    unit_size: float  # of the unit of the limit [SI]
    unit: str  # of the limit


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
    """Whether all limits hold from rest to the steady temperatures at speed.

    They do not hold if the bearings have no state at the start or on the way, as in a runaway. A
    peak may equal its limit.

    seconds: duration of the ramp to speed [s].
    limits: values in the units of `LIMITS`, by its names.
    tolerance: of a time step, relative.
    """
    try:
        warmup = warm_up(scene, ramp(seconds), tolerance=tolerance)
    except NoState:
        return False
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
    have lower peaks: it may meet a warm shaft in a cold housing. Only between the first of `RAMPS`
    that keeps the limits and the one before it are longer ramps assumed to have lower peaks. The
    answer keeps the limits with the time steps of `bearingwear warmup`.

    limits: values in the units of `LIMITS`, by its names.
    """
    are_kept = [limits_hold(scene, seconds, limits) for seconds in RAMPS]
    for k, kept in enumerate(are_kept):
        seconds = _fine_ramp(scene, limits, k) if kept else None
        if seconds is not None:
            broken_by = (RAMPS[m] for m in range(k, len(RAMPS)) if not are_kept[m])
            return ShortestRamp(seconds, tuple(broken_by))
    return None


def _fine_ramp(scene: Scene, limits: Mapping[str, float], k: int) -> float | None:
    """Returns the shortest ramp [s] up to `RAMPS[k]` that keeps all limits with fine time steps.

    None if `RAMPS[k]`, which keeps them with coarse time steps, does not. A shorter ramp that
    breaks a limit with fine steps is lengthened by `RAMP_TOLERANCE` until it keeps all of them.

    limits: values in the units of `LIMITS`, by its names.
    """
    # the first two are no ramp and 1 s; zero has no logarithm to bisect
    seconds = _bisected_ramp(scene, limits, k) if k > 1 else RAMPS[k]
    while not limits_hold(scene, seconds, limits, STEP_TOLERANCE):
        seconds = float(f"{(1.0 + RAMP_TOLERANCE) * seconds:.3g}")
        if not 0.0 < seconds <= RAMPS[k]:
            return None
    return seconds


def _bisected_ramp(scene: Scene, limits: Mapping[str, float], k: int) -> float:
    """Returns the shortest ramp [s] above `RAMPS[k - 1]` that keeps all limits, rounded up.

    It is bisected in logarithm, with coarse time steps, to `RAMP_TOLERANCE`.

    limits: values in the units of `LIMITS`, by its names; `RAMPS[k]` keeps them.
    """
    low, high = RAMPS[k - 1], RAMPS[k]
    while high > (1.0 + RAMP_TOLERANCE) * low:
        middle = math.sqrt(low * high)
        if limits_hold(scene, middle, limits):
            high = middle
        else:
            low = middle
    rounded_up = float(f"{1.005 * high:.3g}")  # three digits are rounded by at most 0.5 %
    return min(rounded_up, RAMPS[k])
