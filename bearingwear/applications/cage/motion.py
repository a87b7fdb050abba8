"""Motions of a cage over a stretch of time: their names and their criteria."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

MOTIONS = ("floats", "hangs", "turns_with_the_balls", "whirls", "irregular", "jams")
FLOATS, HANGS, WITH_BALLS, WHIRLS, IRREGULAR, JAMS = range(len(MOTIONS))

ONE_SIDED = 0.5
"""Mean place over the root mean square of the distance from which on a cage hangs."""

WITH_THEM = 0.03
"""Relative difference from the balls' rate up to which a cage goes round with them."""

EVEN = 0.1
"""Scatter of the distance from the axis up to which a cage whirls evenly."""


@dataclass(frozen=True)
class CagePath:
    """A cage's path over a stretch: where its centre is, and how it goes round."""

    centre: complex  # mean place, Y + i Z [m]
    offset: float  # mean distance from the axis [m]
    scatter: float  # standard deviation of it [m]
    whirl: float  # turns round the axis for a turn of the shaft [1]
    motion: int


def cage_path(place: np.ndarray, turns: float, power: float, ball_ratio: float) -> CagePath:
    """Returns the motion of a cage over a stretch of time.

    place: positions Y + i Z of its centre from the axis of its guide, at even instants [m].
    turns: shaft turns from one instant to the next.
    power: mean of normal force times slip in pockets and at the land [W].
    ball_ratio: orbit rate of the balls over the speed of the shaft.
    """
    distance = np.abs(place)
    # The angle from one instant to the next, by its area: noise about the axis counts little.
    step = np.angle(np.sum(place[1:] * np.conj(place[:-1])))
    whirl = float(step / (2.0 * np.pi * turns))
    centre, offset, scatter = complex(place.mean()), float(distance.mean()), float(distance.std())
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


def is_drifting(values: Sequence[float], allowed: float) -> bool:
    """Returns whether successive values rise, or fall, all the way by more than allowed.

    allowed: largest change, relative to the last value.
    """
    steps = np.diff(values)
    one_way = bool((steps > 0.0).all() or (steps < 0.0).all())
    return one_way and abs(values[-1] - values[0]) > allowed * abs(values[-1])
