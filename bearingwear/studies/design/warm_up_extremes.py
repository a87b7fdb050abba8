"""The worst values of limited quantities during a warm-up."""

from __future__ import annotations

import functools
from typing import Any

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.scene.slip import at_speed_share
from bearingwear.solvers.warmup.transient import STEP_TOLERANCE, NoState, ramp, warm_up
from bearingwear.studies.design.condition_extremes import (
    KEPT,
    UNLOADED,
    ConditionExtremes,
    state_extremes,
    worst_extremes,
)
from bearingwear.studies.design.conditions import NEW, WARMING, OperatingCondition

ROUGHER = 100.0
"""Factor on the tolerance of the steps of a warm-up that shows where to look for a preload.

Peaks of preload and pressure are within 2e-4 of those of fine steps.
"""


@functools.lru_cache(maxsize=256)  # quick and exact lives ask for the same new bearings
def warm_up_extremes(scene: Scene, seconds: float, quick: bool) -> ConditionExtremes:
    """Returns extremes of new bearings from rest to steady temperatures, or where that failed.

    If some bearing carries nothing after the start, that is no failure: the share of its preload
    that is kept is 0, with the condition of the last instant solved.

    seconds: time of the ramp from rest to speed [s].
    quick: whether the steps are coarser than those of `bearingwear warmup`.
    """
    tolerance = STEP_TOLERANCE * (ROUGHER if quick else 1.0)
    where: dict[str, Any] = {}  # after the loop, that of the last instant
    try:
        warming = warm_up(scene, ramp(seconds), tolerance=tolerance)
    except NoState as no_state:
        mounted = OperatingCondition(at_speed_share(scene, 0.0), WARMING)
        where = mounted.where(wear=NEW, time_s=0.0)
        status_name = code.STATUS_NAMES[no_state.status]
        return ConditionExtremes({}, 0, no_state.status, where | {"status": status_name})
    parts = []
    for instant in warming.instants:
        condition = OperatingCondition(at_speed_share(scene, instant.share), WARMING)
        where = condition.where(wear=NEW, time_s=instant.time)
        parts.append(state_extremes(condition.scene, instant.states, where, with_quasistatic=False))
    if warming.status in UNLOADED:
        parts.append({KEPT: where | {"value": 0.0}})
    elif warming.status != code.OK:
        unsolved = where | {"status": code.STATUS_NAMES[warming.status]}
        return ConditionExtremes({}, len(parts), warming.status, unsolved)
    return ConditionExtremes(worst_extremes(parts), len(parts))
