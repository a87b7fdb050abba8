"""Motions of a cage over a stretch of time: their names and their criteria."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

MOTIONS = ("floats", "hangs", "turns_with_the_balls", "whirls", "irregular", "jams")
FLOATS, HANGS, WITH_BALLS, WHIRLS, IRREGULAR, JAMS = range(len(MOTIONS))

ONE_SIDED = 0.5
"""Distance of the mean position, over the rms distance, above which a cage hangs on one side."""

WITH_THEM = 0.03
"""Largest relative difference of the whirl rate of a cage that turns with the balls from theirs."""

EVEN = 0.1
"""Largest standard deviation of the distance from the axis, over its mean, of an even whirl."""


@dataclass(frozen=True)
class CagePath:
    """The path of the centre of a cage over some time, and the motion that it is classified as."""

    centre: complex  # mean position, Y + i Z [m]
    offset: float  # mean distance from the axis [m]
    scatter: float  # standard deviation of the distance [m]
    whirl: float  # orbits about the axis per shaft turn
    motion: int  # index in `MOTIONS`


def cage_path(positions: np.ndarray, turns: float, power: float, ball_ratio: float) -> CagePath:
    """Returns the path of a cage over some time, classified as one of `MOTIONS`.

    A cage without power floats. The other motions are tried in the order hangs, irregular, turns
    with the balls; what is left whirls. A jam is not among these: the status of a run shows it.

    positions: Y + i Z of its centre from the axis of its guide, evenly spaced in time (n,) [m].
    turns: shaft turns from one position to the next.
    power: mean of normal force times slip in pockets and at the land [W].
    ball_ratio: orbit rate of the balls over the speed of the shaft.
    """
    distance = np.abs(positions)
    # Mean angle about the axis from one position to the next. Each is weighted by the distances
    # from the axis, so that noise near the axis counts little.
    step = np.angle(np.sum(positions[1:] * np.conj(positions[:-1])))
    whirl = float(step / (2.0 * np.pi * turns))
    centre, offset, scatter = (
        complex(positions.mean()),
        float(distance.mean()),
        float(distance.std()),
    )
    if power == 0.0:
        motion = FLOATS
    elif abs(centre) > ONE_SIDED * np.sqrt(np.mean(distance**2)):
        motion = HANGS
    elif scatter > EVEN * offset:
        motion = IRREGULAR
    elif abs(whirl - ball_ratio) <= WITH_THEM * ball_ratio:
        motion = WITH_BALLS
    else:
        motion = WHIRLS
    return CagePath(centre=centre, offset=offset, scatter=scatter, whirl=whirl, motion=motion)


def is_drifting(values: Sequence[float], tolerance: float) -> bool:
    """Returns whether values rise at every step, or fall at every step, by more than a tolerance.

    Values are the mean of a quantity over one stretch after another.

    tolerance: largest change from the first to the last value, relative to the last.
    """
    steps = np.diff(values)
    is_monotonic = bool((steps > 0.0).all() or (steps < 0.0).all())
    return is_monotonic and abs(values[-1] - values[0]) > tolerance * abs(values[-1])
