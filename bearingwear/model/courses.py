"""Many lives by the steady model, of a bearing or of the worse half of a pair."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.measures import MEASURES, Measure
from bearingwear.model.films import COVERED, Bare
from bearingwear.model.life import life_history
from bearingwear.model.life_integrator import FIELDS, LifeHistory, WearState
from bearingwear.model.pair_life import PairLife, PairStates, pair_states
from bearingwear.model.rotor import lowest_frequency
from bearingwear.model.states_at_loss import steady_states
from bearingwear.scene.blocks import OF_CAGE
from bearingwear.scene.scene import COUNTS, Scene

WELL_BALANCED = 1e-7  # force left on a rotor, over the larger one: a tenth of a life's tolerance


class WearCourses:
    """Lives of a scene with different ends; known states are not solved again.

    Parameters
    ----------
    scene : Scene
        With a steady state.
    """

    def __init__(self, scene: Scene):
        self._known: dict[tuple[float, Bare], WearState] = {}
        unlike = scene.pair is not None and not scene.pair.is_symmetric
        self._both = pair_states(scene, "steady", WELL_BALANCED) if unlike else None
        self._solve = None if unlike else steady_states(scene)
        self.solves, self.failed = 0, 0

    def __call__(self, scene: Scene) -> LifeHistory:
        """The life of the scene, which may have another end."""
        if self._both is not None:
            return self._of_pair(scene, self._both)
        history = life_history(scene, self._state)
        self.solves = len(self._known)
        self.failed = sum(state.status != code.OK for state in self._known.values())
        return history

    def _state(self, loss: float, bare: Bare = COVERED) -> WearState:
        assert self._solve is not None
        if (loss, bare) not in self._known:
            self._known[loss, bare] = self._solve(loss, bare)
        return self._known[loss, bare]

    def _of_pair(self, scene: Scene, states: PairStates) -> LifeHistory:
        runs = [
            PairLife(states, scene, counts, scene.model.tolerance, between=(0.5,)).integrate()
            for counts in range(len(COUNTS))
        ]
        self.solves, self.failed = states.solves, states.failed
        own = runs[COUNTS.index(scene.wear.counts)]
        ends = [run.times[-1] if run.status == own.status else np.nan for run in runs]
        return LifeHistory(
            states=worse_halves(own.states, scene),
            times=[np.zeros(2)] * (len(own.times) - 1) + [np.array(ends)],
            error=np.full(2, np.nan),
            criterion=own.criterion,
            status=own.status,
            solves=self.solves,
        )


def worse_halves(states: Iterable[tuple[WearState, WearState]], scene: Scene) -> list[WearState]:
    """What limits look at in each state of a pair: of each measure the value of its worse bearing.

    The preload is that of the worse side, with all its bearings in tandem.
    """
    assert scene.pair is not None
    n_1, n_2 = scene.pair.tandem
    found = []
    for one, other in states:
        first = replace(one, preload=n_1 * one.preload)
        second = replace(other, preload=n_2 * other.preload)
        worse = {
            FIELDS.get(name, name): _worse(first[name], second[name], measure)
            for measure in MEASURES
            for name in measure.variables
            if measure.key not in OF_CAGE
        }
        worse["frequency"] = lowest_frequency(scene, (one, other))
        found.append(replace(first, **worse))
    return found


def _worse(first: Any, second: Any, measure: Measure) -> Any:
    """Of two values, or of each value of two arrays, the one closer to a limit."""
    is_second = second < first if measure.falls else np.abs(second) > np.abs(first)
    return np.where(is_second, second, first)[()]
