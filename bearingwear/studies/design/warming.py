"""The worst of limited quantities on the way to speed."""

from __future__ import annotations

import functools

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.scene.slip import at_share
from bearingwear.solvers.warmup.transient import COARSER, STEP_TOLERANCE, ramp, warm_up
from bearingwear.studies.design.conditions import NEW, WARMING, OperatingCondition
from bearingwear.studies.design.everywhere import OtherSpeeds, merged, state_extremes


@functools.lru_cache(maxsize=64)  # new bearings are looked at by several kinds of lives
def warm_up_extremes(scene: Scene, seconds: float) -> OtherSpeeds:
    """Extremes of new bearings from rest to the steady temperatures, or how they got lost.

    seconds: time of the ramp from rest to speed.
    """
    warmed = warm_up(scene, ramp(seconds), tolerance=COARSER * STEP_TOLERANCE)
    each, where = [], {}
    for instant in warmed.instants:
        place = OperatingCondition(at_share(scene, instant.share), WARMING)
        where = place.where(wear=NEW, time_s=instant.time)
        each.append(state_extremes(place.scene, instant.states, where, own=False))
    if warmed.status != code.OK:
        lost = where | {"status": code.STATUS_NAMES[warmed.status]}
        return OtherSpeeds({}, len(each), warmed.status, lost)
    return OtherSpeeds(merged(each), len(each))
