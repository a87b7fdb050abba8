"""How far a bearing is from what ends its life."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bearingwear.measures import ENDS
from bearingwear.model.fidelity import NotAvailable
from bearingwear.model.state import State
from bearingwear.scene.scene import EndOfLife, Scene, SceneError

NO_CRITERION = len(ENDS)
"""Index of no criterion in `CRITERIA`."""


def margins(state: State, end: EndOfLife, preload_N: float) -> np.ndarray:
    """How far each criterion of `CRITERIA` is from being met.

    Positive before, zero or below where it is met; infinite where it is not asked for, or the state
    does not know its measure.
    """
    found = np.full(NO_CRITERION, np.inf)
    for k, (name, measure) in enumerate(ENDS.items()):
        limit = getattr(end, name)
        if limit is not None:
            margin = measure.margin(measure.critical(state.__getitem__, preload_N)[0], limit)
            found[k] = np.inf if math.isnan(margin) else margin
    return found


class Criteria:
    """The criteria of a scene, of one bearing or of two."""

    def __init__(self, scene: Scene):
        self.end = scene.wear.end_of_life or EndOfLife()
        self.preloads_N = [side.operation.preload_N for side in scene.sides]

    def margins(self, states: Sequence[State]) -> np.ndarray:
        """`margins` of the bearing that is nearest to each criterion."""
        each = zip(states, self.preloads_N, strict=True)
        return np.min([margins(state, self.end, preload) for state, preload in each], axis=0)


def with_end(scene: Scene, end: EndOfLife) -> Scene:
    """The scene with another end of life."""
    return replace(scene, wear=replace(scene.wear, end_of_life=end))


def check_end(scene: Scene) -> None:
    """Refuse a scene whose life cannot end."""
    end = scene.wear.end_of_life
    if end is None or not end.criteria:
        raise SceneError(
            "wear.end_of_life",
            "got nothing, expected at least one criterion",
            source=scene.name,
        )
    if end.preload_fraction is not None and scene.operation.preload_N == 0.0:
        raise SceneError(
            "wear.end_of_life.preload_fraction",
            "got a fraction of preload_N 0, expected a preload > 0",
            source=scene.name,
        )


def check_depth(scene: Scene) -> None:
    """Refuse a limit on the depth of grooves where the life does not follow them."""
    end = scene.wear.end_of_life
    if end is not None and end.groove_depth_um is not None:
        raise NotAvailable(
            f"{scene.name}: wear.end_of_life.groove_depth_um: got {end.groove_depth_um:g} with "
            "grooves that are not followed, expected model.contact worn"
        )
