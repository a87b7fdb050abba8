"""The shortest ramp to speed on which a limit of preload or contact pressure is kept."""

from __future__ import annotations

import math
from collections.abc import Mapping

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.solvers.warmup.transient import COARSER, STEP_TOLERANCE, ramp, warm_up
from bearingwear.studies.warmup.result import peaks_of

LIMITS = {"pressure": ("maximum_pressure", 1e9, "GPa"), "preload": ("residual_preload", 1.0, "N")}
"""Of what a ramp may keep below a limit: the peak, the size of its unit [SI], and the unit."""

FIRST_RAMP, LONGEST_RAMP = 1.0, 1e5
"""Ramps [s] between which the shortest one is looked for."""

RAMP_FOUND_TO = 0.02
"""Relative: how well the ramp is found; it is rounded up."""


def keeps(scene: Scene, seconds: float, limits: Mapping[str, float]) -> bool:
    """Whether all limits hold from rest to the steady temperatures at speed."""
    found = warm_up(scene, ramp(seconds), tolerance=COARSER * STEP_TOLERANCE)
    if found.status != code.OK:
        return False
    peaks = peaks_of(scene, found)
    return all(
        peaks[f"peak_{LIMITS[name][0]}"] <= limit * LIMITS[name][1]
        for name, limit in limits.items()
    )


def shortest_ramp(scene: Scene, limits: Mapping[str, float]) -> float | None:
    """Time from rest to speed [s] from which on all limits hold; None where no ramp keeps them.

    Zero where they hold without a ramp. A longer ramp is taken to have lower peaks, as the
    housing has more time to follow.
    """
    if keeps(scene, 0.0, limits):
        return 0.0
    if not keeps(scene, LONGEST_RAMP, limits):
        return None
    low, high = FIRST_RAMP, LONGEST_RAMP
    if keeps(scene, low, limits):
        return low
    while high > (1.0 + RAMP_FOUND_TO) * low:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if keeps(scene, middle, limits) else (middle, high)
    return float(f"{1.005 * high:.3g}")
