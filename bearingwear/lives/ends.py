"""How far a bearing is from what ends its life."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bearingwear.measures import ENDS
from bearingwear.scene.scene import LARGEST_LOSS, EndOfLife, Scene
from bearingwear.solvers.bearing.mounted import MM
from bearingwear.solvers.state import State

NO_CRITERION = len(ENDS)
"""Index of no criterion in `CRITERIA`."""


def largest_loss(scene: Scene) -> float:
    """Loss of ball diameter of a bearing beyond which no life is followed [m]."""
    return LARGEST_LOSS * (scene.bearing.ball_diameter_mm * MM)


class Criteria:
    """End-of-life criteria of a scene, of one bearing or of two unequal ones."""

    def __init__(self, scene: Scene):
        self.preloads_N = [side.operation.preload_N for side in scene.one_of_alike.sides]
        end = scene.wear.end_of_life or EndOfLife()
        self._asked = [
            (k, measure, limit)
            for k, (name, measure) in enumerate(ENDS.items())
            if (limit := getattr(end, name)) is not None
        ]

    def margins(self, states: Sequence[State]) -> np.ndarray:
        """Margin of the nearest bearing to each criterion of `CRITERIA`.

        Positive before, zero or below where it is met; infinite where it is not asked for, or the
        state does not know its measure.
        """
        found = np.full(NO_CRITERION, np.inf)
        for state, preload in zip(states, self.preloads_N, strict=True):
            for k, measure, limit in self._asked:
                margin = measure.margin(measure.critical(state.__getitem__, preload)[0], limit)
                if margin < found[k]:  # which none is that is not known
                    found[k] = margin
        return found


def with_end(scene: Scene, end: EndOfLife) -> Scene:
    return replace(scene, wear=replace(scene.wear, end_of_life=end))
