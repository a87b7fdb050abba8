"""End-of-life criteria, and the margin that a bearing has left to each."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bearingwear.measures import ENDS
from bearingwear.scene.scene import LARGEST_LOSS, EndOfLife, Scene
from bearingwear.solvers.bearing.mounted import MM
from bearingwear.solvers.state import State

NO_CRITERION = len(ENDS)
"""Index that stands for no criterion, after those in `CRITERIA`."""


def largest_loss(scene: Scene) -> float:
    """Returns the loss of ball diameter [m] beyond which no life of a bearing is followed."""
    return LARGEST_LOSS * (scene.bearing.ball_diameter_mm * MM)


class Criteria:
    """End-of-life criteria of a scene, of one bearing or of two unequal ones."""

    def __init__(self, scene: Scene):
        self.preloads_N = [side.operation.preload_N for side in scene.symmetric_half.sides]
        end = scene.wear.end_of_life or EndOfLife()
        self._limits = [
            (k, measure, getattr(end, name))
            for k, (name, measure) in enumerate(ENDS.items())
            if getattr(end, name) is not None
        ]

    def margins(self, states: Sequence[State]) -> np.ndarray:
        """Returns the margin of the nearest bearing to each criterion, in the order of `ENDS` (n,).

        A margin is positive before the criterion is met, and zero or below from then on. It is
        infinite where the scene has no such criterion, or no state knows its measure.

        states: one for each bearing that is solved.
        """
        margins = np.full(len(ENDS), np.inf)
        for state, preload in zip(states, self.preloads_N, strict=True):
            for k, measure, limit in self._limits:
                value, _ = measure.critical(state.__getitem__, preload)
                margin = measure.margin(value, limit)
                if margin < margins[k]:  # False for NaN, of a measure that is not known
                    margins[k] = margin
        return margins


def with_end(scene: Scene, end: EndOfLife) -> Scene:
    """Returns the scene with another end of life."""
    return replace(scene, wear=replace(scene.wear, end_of_life=end))
