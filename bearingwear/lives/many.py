"""Many lives of a scene: with different ends, quickly, and of the worse bearing of a pair."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.lives.duty.cycle import cycle_of
from bearingwear.lives.duty.lives import (
    criteria_of,
    cycle_with_enough_points,
    duty_life,
    grooves_wear,
    hertzian_duty_life,
)
from bearingwear.lives.ends import with_end
from bearingwear.lives.follow import Life
from bearingwear.lives.groove_life import grooves_followed, met_when_new
from bearingwear.lives.grooves import (
    EXACT_GROOVES,
    QUICK_GROOVES,
    Grooves,
    StiffGrooves,
    follow_grooves,
)
from bearingwear.lives.surfaces import is_one_integral, surface_life
from bearingwear.measures import MEASURES, Measure
from bearingwear.scene.cases import cases_that_wear
from bearingwear.scene.scene import EndOfLife, Scene
from bearingwear.solvers.bearing.arrangement import lowest_frequency
from bearingwear.solvers.compose import WELL_BALANCED, Remembered, solver_of
from bearingwear.solvers.condition import States
from bearingwear.solvers.state import OF_EACH_CONTACT, State


class HertzianLives:
    """Lives of a scene with different ends; known states are not solved again.

    Quick ones have longer steps: 95 in 100 are known to 1e-4. Where a life is no integral of the
    loss alone, it is always quick: it has the same length.
    """

    def __init__(self, scene: Scene, quick: bool = False):
        self.quick = quick or not is_one_integral(scene)
        self.states = solver_of(scene, tolerance=WELL_BALANCED)
        self._of_duty: list[Remembered] = []
        if scene.duty is not None:
            cycle = cycle_with_enough_points(scene)
            self._points = cycle.points
            self._of_duty = [solver_of(one, tolerance=WELL_BALANCED) for one in cycle.scenes]

    def __call__(self, scene: Scene) -> Life:
        """The life of the scene, which may have another end; over its duty if it has one."""
        if scene.duty is not None:
            return hertzian_duty_life(cycle_of(scene, self._points), self._of_duty, self.quick)
        return surface_life(scene, self.states, quick=self.quick)


def worn_life(scene: Scene, quick: bool = True) -> Life | None:
    """The life with grooves as they wear, where `life` follows them; None where it does not.

    A quick one has fewer cells and longer steps: 2.5e-3 of the life in the median, 7e-3 in nine of
    ten, 3 % at worst, for two fifths of the time. States have no stiffness unless the life ends by
    it, which saves a fifth of the time. It is that over the duty if the scene has one.
    """
    return _worn_life(scene, Grooves, quick)


def worn_life_with_stiffness(scene: Scene, quick: bool = True) -> Life | None:
    """`worn_life` whose states know their stiffnesses."""
    return _worn_life(scene, StiffGrooves, quick)


def _worn_life(scene: Scene, grooves: type[Grooves], quick: bool) -> Life | None:
    if scene.duty is not None:
        found = duty_life(scene, "steady", quick, grooves)
        return found.life if found.is_worn else None
    alone, _ = grooves_followed(scene, "steady")
    if alone is None:
        return None
    life = follow_grooves(grooves(alone, QUICK_GROOVES if quick else EXACT_GROOVES))
    is_solved = life.nodes[0].status == code.OK
    return life if is_solved else met_when_new(alone) or life


def lives_by_case(scene: Scene, quick: bool = False) -> dict[str, Life]:
    """Lives along which requirements of a scene hold, by the names of its cases.

    Over a duty they are one life, with the states of its bearings in each case of the duty; else
    those of each case in which something wears. The life of the scene is the shortest.
    """
    if scene.duty is not None:
        return duty_life(scene, quick=quick).by_case
    return {
        name: worn_life_with_stiffness(one, quick) or HertzianLives(one, quick)(one)
        for name, one in cases_that_wear(scene).items()
    }


def worse_states(life: Life, scene: Scene) -> list[State]:
    """States along a life that limits look at: of each measure the value of the worse bearing.

    Of a pair, the preload is that of the worse side, with all its bearings in tandem; angles, loads
    and major axes are those of both bearings (2, 2).
    """
    return [worse_state(node.states, scene) for node in life.nodes]


def worse_state(states: States, scene: Scene) -> State:
    """What limits look at of the bearings in one state, as `worse_states`."""
    if len(states) == 1:
        return states[0]
    one, other = whole_sides(states, scene)
    worse = {
        name: _worse(one[name], other[name], measure)
        for measure in MEASURES
        for name in measure.variables
        if name in one.values or name in other.values
    }
    worse["losses"] = tuple(state.loss for state in states)
    worse["lowest_frequency"] = lowest_frequency(scene, states)
    worse |= {name: np.stack([one[name], other[name]]) for name in OF_EACH_CONTACT}
    if "film_left" in one.values:
        worse["film_left"] = np.minimum(one["film_left"], other["film_left"])
    return one.with_values(worse)


def whole_sides(states: States, scene: Scene) -> States:
    """States of both sides of a pair, whose preload is that of all bearings in tandem."""
    assert scene.pair is not None
    return tuple(
        state.with_values({"residual_preload": n * state["residual_preload"]})
        for n, state in zip(scene.pair.tandem, states, strict=True)
    )


def _worse(first: Any, second: Any, measure: Measure) -> Any:
    """Of two values, or of each value of two arrays, the one closer to a limit or known."""
    is_second = second < first if measure.falls else np.abs(second) > np.abs(first)
    return np.where(is_second | np.isnan(first), second, first)[()]


def lives_by_end(
    scene: Scene, farthest: EndOfLife, quick: bool = False
) -> Callable[[EndOfLife], float]:
    """Function from an end of life to the life [s], NaN where it was not solved.

    Grooves are followed where `life` does, with its cells and steps unless `quick`. They wear alike
    whatever ends the life, so they are followed once, to the `farthest` end: every limit as loose
    as it is asked for.
    """
    if scene.cases and scene.duty is None:
        wearing = cases_that_wear(scene).values()
        each = [lives_by_end(one, farthest, quick) for one in wearing]
        return lambda end: float(np.min([length(end) for length in each]))
    if not grooves_wear(scene):
        lives = HertzianLives(scene)

        def length(end: EndOfLife) -> float:
            life = lives(with_end(scene, end))
            return life.last.time if life.status == code.OK else np.nan

        return length
    asked = replace(with_end(scene, farthest), model=replace(scene.model, contact="worn"))
    life = worn_life(asked, quick)
    assert life is not None

    @cache
    def first(name: str, limit: float) -> float:
        return life.first(criteria_of(with_end(asked, EndOfLife(**{name: limit}))))

    # NaN for a criterion that is not met
    return lambda end: float(np.fmin.reduce([first(*one) for one in end.criteria.items()]))
