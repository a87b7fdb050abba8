"""Many lives with the grooves that `life` would follow."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from bearingwear.kernels import status as code
from bearingwear.model.courses import WearCourses, worse_halves
from bearingwear.model.life import margins
from bearingwear.model.life_integrator import LifeHistory
from bearingwear.model.worn_life import FEWER_CELLS, STEP, WORN_CELLS, WornLife
from bearingwear.model.worn_outputs import grooves_followed
from bearingwear.scene.scene import EndOfLife, Scene

QUICK_STEP = 2.0 * STEP
"""Of a quick life with worn grooves, over the gap A a^2; with it go `FEWER_CELLS`."""


def worn_history(scene: Scene, quick: bool = True, only_times: bool = False) -> LifeHistory | None:
    """The life with grooves as they wear, where `life` follows them; None where it does not.

    Parameters
    ----------
    scene : Scene
        With a steady state and an end of life.
    quick : bool
        With fewer cells and longer steps than `life` has: 3e-3 of the life and 2 % of the least
        stiffness, for a fifth of the time.
    only_times : bool
        As of `WornLife`.
    """
    alone, _ = grooves_followed(scene, "steady")
    if alone is None:
        return None
    cells, step = (FEWER_CELLS, QUICK_STEP) if quick else (WORN_CELLS, STEP)
    found = WornLife(alone, cells=cells, step=step, only_times=only_times).march()
    history = found[0].history
    if alone.pair is None:
        return history
    both = zip(*(one.history.states for one in found), strict=True)
    return replace(history, states=worse_halves(both, alone))


def lives_by_end(scene: Scene, farthest: EndOfLife, basis: int) -> Callable[[EndOfLife], float]:
    """Function from an end of life to the life [s], NaN where it was not solved.

    Grooves are followed where `life` does, with its cells and steps. They wear alike whatever ends
    the life, so they are followed once, to an end that comes after all others.

    Parameters
    ----------
    scene : Scene
    farthest : EndOfLife
        With every limit as loose as it is asked for.
    basis : int
        Index along the loss basis.
    """

    def ended(end: EndOfLife) -> Scene:
        return replace(scene, wear=replace(scene.wear, end_of_life=end))

    if grooves_followed(scene, "steady")[0] is None:
        follow = WearCourses(scene)

        def life(end: EndOfLife) -> float:
            history = follow(ended(end))
            return float(history.times[-1][basis]) if history.status == code.OK else np.nan

        return life
    asked = replace(ended(farthest), model=replace(scene.model, contact="worn"))
    history = worn_history(asked, quick=False, only_times=True)
    assert history is not None
    return lambda end: first_met(history, end, scene.operation.preload_N)


def first_met(history: LifeHistory, end: EndOfLife, preload_N: float) -> float:
    """When a history with worn grooves first meets an end of life [s]; NaN where it does not.

    Between its states, margins are monotone cubics of time.
    """
    if history.states[0].status != code.OK:
        return np.nan
    times = np.array([time[1] for time in history.times])
    first = np.inf
    for margin in np.array([margins(state, end, preload_N) for state in history.states]).T:
        met = np.flatnonzero(margin <= 0.0)
        if not met.size:
            continue
        if met[0] == 0:
            return 0.0
        a, b = times[met[0] - 1], times[met[0]]
        first = min(first, float(brentq(PchipInterpolator(times, margin), a, b)))
    return first if np.isfinite(first) else np.nan
