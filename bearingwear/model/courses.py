"""Many lives by the steady model, of a bearing or of the worse half of a pair."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from bearingwear.measures import MEASURES, Measure
from bearingwear.model.life import life_history, lives_along
from bearingwear.model.life_integrator import LifeHistory
from bearingwear.model.pair_life import pair_states
from bearingwear.model.rotor import lowest_frequency
from bearingwear.model.state import OF_EACH_CONTACT, State
from bearingwear.model.states_at_loss import steady_states
from bearingwear.model.wear_path import Condition, KnownStates, States
from bearingwear.scene.scene import Scene

WELL_BALANCED = 1e-7  # force left on a rotor, over the larger one: a tenth of a life's tolerance


class WearCourses:
    """Lives of a scene with different ends; known states are not solved again.

    Parameters
    ----------
    scene : Scene
        With a steady state.
    """

    def __init__(self, scene: Scene):
        self._unlike = scene.pair is not None and not scene.pair.is_symmetric
        if self._unlike:
            self._states = pair_states(scene, "steady", WELL_BALANCED)
        else:
            alone = steady_states(scene)
            self._states = KnownStates(lambda conditions: (alone(*conditions[0]),))

    @property
    def solves(self) -> int:
        return self._states.solves

    @property
    def failed(self) -> int:
        return self._states.failed

    def __call__(self, scene: Scene) -> LifeHistory:
        """The life of the scene, which may have another end."""
        if self._unlike:
            return self._of_pair(scene)
        return life_history(scene, lambda *condition: self._states((Condition(*condition),))[0])

    def _of_pair(self, scene: Scene) -> LifeHistory:
        course, times, error = lives_along(scene, self._states, bounded=False, between=(0.5,))
        return LifeHistory(
            states=worse_halves(course.states, scene),
            times=list(times),
            error=error,
            criterion=course.criterion,
            status=course.status,
            solves=self.solves,
        )


def worse_halves(states: Iterable[States], scene: Scene) -> list[State]:
    """What limits look at in each state of a pair: of each measure the value of its worse bearing.

    The preload is that of the worse side, with all its bearings in tandem. Angles, loads and major
    axes are those of both bearings (2, 2).
    """
    assert scene.pair is not None
    found = []
    for both in states:
        one, other = (
            state.with_values({"residual_preload": n * state["residual_preload"]})
            for n, state in zip(scene.pair.tandem, both, strict=True)
        )
        worse = {
            name: _worse(one[name], other[name], measure)
            for measure in MEASURES
            for name in measure.variables
            if name in one.values or name in other.values
        }
        worse["lowest_frequency"] = lowest_frequency(scene, both)
        worse |= {name: np.stack([one[name], other[name]]) for name in OF_EACH_CONTACT}
        found.append(one.with_values(worse))
    return found


def _worse(first: Any, second: Any, measure: Measure) -> Any:
    """Of two values, or of each value of two arrays, the one closer to a limit or known."""
    is_second = second < first if measure.falls else np.abs(second) > np.abs(first)
    return np.where(is_second | np.isnan(first), second, first)[()]
