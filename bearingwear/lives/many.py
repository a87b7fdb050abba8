"""Many lives of a scene: quick ones, with different ends, by case, and of the worse bearing."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
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
from bearingwear.lives.groove_life import groove_choice, life_if_ended_when_new
from bearingwear.lives.grooves import Grooves, StiffGrooves, follow_grooves, quick_groove_life
from bearingwear.lives.surfaces import is_one_integral, surface_life
from bearingwear.measures import MEASURES, Measure
from bearingwear.scene.cases import cases_that_wear
from bearingwear.scene.scene import EndOfLife, Scene
from bearingwear.solvers.bearing.arrangement import lowest_frequency
from bearingwear.solvers.compose import WELL_BALANCED, Remembered, solver_of
from bearingwear.solvers.condition import States
from bearingwear.solvers.state import OF_EACH_CONTACT, State


class HertzianLives:
    """Lives of a scene with different ends, for which each state is solved only once.

    Quick ones have longer steps: 95 in 100 are known to a relative error of 1e-4. Where a life is
    no integral of the loss alone, it is always quick: fewer of its states are kept, with no change
    of its length.
    """

    def __init__(self, scene: Scene, quick: bool = False):
        """Makes the solvers of a scene, and of each condition of its duty if it has one."""
        self.quick = quick or not is_one_integral(scene)
        self.solver = solver_of(scene, tolerance=WELL_BALANCED)
        self._duty_solvers: list[Remembered] = []
        if scene.duty is not None:
            cycle = cycle_with_enough_points(scene)
            self._points = cycle.points
            self._duty_solvers = [
                solver_of(condition, tolerance=WELL_BALANCED) for condition in cycle.scenes
            ]

    def __call__(self, scene: Scene) -> Life:
        """Returns the life of a scene, over its duty if it has one.

        scene: that of the solvers, but for its end of life.
        """
        if scene.duty is not None:
            return hertzian_duty_life(cycle_of(scene, self._points), self._duty_solvers, self.quick)
        return surface_life(scene, self.solver, quick=self.quick)


def worn_life(scene: Scene, quick: bool = True) -> Life | None:
    """Returns the life with grooves as they wear; None where `life` does not follow them.

    A quick one has fewer cells and longer steps. Its length differs by 2.5e-3 in the median, by up
    to 7e-3 in nine of ten scenes, and by 3 % at worst; it takes two fifths of the time. States have
    no stiffness unless the life ends by it, which saves a fifth of the time. The life is that over
    the duty if the scene has one.
    """
    return _worn_life(scene, Grooves, quick)


def worn_life_with_stiffness(scene: Scene, quick: bool = True) -> Life | None:
    """Returns the life with grooves as they wear, whose states know their stiffnesses.

    None where `life` does not follow grooves; a quick one is that of `worn_life`.
    """
    return _worn_life(scene, StiffGrooves, quick)


def _worn_life(scene: Scene, kind: type[Grooves], quick: bool) -> Life | None:
    """Returns the life with grooves as they wear; None where `life` does not follow them.

    kind: `StiffGrooves`, whose states have stiffnesses, or `Grooves`.
    """
    if scene.duty is not None:
        over_duty = duty_life(scene, "steady", quick, kind)
        return over_duty.life if over_duty.is_worn else None
    single = groove_choice(scene, "steady").scene
    if single is None:
        return None
    life = quick_groove_life(partial(kind, single)) if quick else follow_grooves(kind(single))
    if life.nodes[0].status == code.OK:
        return life
    return life_if_ended_when_new(single) or life


def lives_by_case(scene: Scene, quick: bool = False) -> dict[str, Life]:
    """Returns the lives along which the requirements of a scene are checked, by names of cases.

    Over a duty, all cases have the same life, each with the states of the bearings in that case.
    Otherwise each case in which a race turns has its life alone, or every case if none turns; the
    life of the scene is the shortest. A scene without cases has one, by the name of the nominal
    case.

    quick: as in `worn_life` and `HertzianLives`.
    """
    if scene.duty is not None:
        return duty_life(scene, quick=quick).by_case
    return {
        name: worn_life_with_stiffness(case, quick) or HertzianLives(case, quick)(case)
        for name, case in cases_that_wear(scene).items()
    }


def worse_states(life: Life, scene: Scene) -> list[State]:
    """Returns the states along a life, with the value of the worse bearing for each measure.

    Requirements are checked against these, each as `worse_state` returns it.
    """
    return [worse_state(node.states, scene) for node in life.nodes]


def worse_state(states: States, scene: Scene) -> State:
    """Returns one state for the bearings of a scene: of each measure the worse value.

    A single state stands for both bearings of a symmetric pair, and is returned as it is. Of two,
    the preload is that of the worse side, with all its bearings in tandem. Their state has also
    `losses` [m] and `lowest_frequency` [Hz], and the values `OF_EACH_CONTACT` by bearing and race
    (2, 2). Values of no measure are those of the first bearing.
    """
    if len(states) == 1:
        (state,) = states
        return state
    first, second = with_tandem_preload(states, scene)
    worse = {
        name: _worse(first[name], second[name], measure)
        for measure in MEASURES
        for name in measure.variables
        if name in first.values or name in second.values
    }
    worse["losses"] = tuple(state.loss for state in states)
    worse["lowest_frequency"] = lowest_frequency(scene, states)
    worse |= {name: np.stack([first[name], second[name]]) for name in OF_EACH_CONTACT}
    if "film_left" in first.values:
        worse["film_left"] = np.minimum(first["film_left"], second["film_left"])
    return first.with_values(worse)


def with_tandem_preload(states: States, scene: Scene) -> States:
    """Returns the states of both sides of a pair, with the preload of all bearings of a side [N].

    The preload of one bearing is multiplied by the number of those in tandem.
    """
    assert scene.pair is not None
    return tuple(
        state.with_values({"residual_preload": n * state["residual_preload"]})
        for n, state in zip(scene.pair.tandem, states, strict=True)
    )


def _worse(first: Any, second: Any, measure: Measure) -> Any:
    """Returns the value closer to the limit of a measure, elementwise for arrays.

    It is the smaller value of a measure that falls, else the one of the larger magnitude. Where one
    is NaN, it is the other.
    """
    is_second = second < first if measure.falls else np.abs(second) > np.abs(first)
    return np.where(is_second | np.isnan(first), second, first)[()]  # a number if both are


def lives_by_end(
    scene: Scene, farthest: EndOfLife, quick: bool = False
) -> Callable[[EndOfLife], float]:
    """Returns a function from an end of life to the life [s]; NaN where it meets no criterion.

    The life of a scene with cases is the shortest of theirs, NaN if one is. Grooves are followed
    where `life` does, with its cells and steps unless `quick`. They wear alike whatever ends the
    life, so they are followed once, to the `farthest` end.

    farthest: an end with every criterion of which lives are wanted, at its loosest limit.
    """
    if scene.cases and scene.duty is None:
        lengths = [lives_by_end(case, farthest, quick) for case in cases_that_wear(scene).values()]
        return lambda end: float(np.min([length(end) for length in lengths]))
    if not grooves_wear(scene):
        lives = HertzianLives(scene)

        def hertzian_length(end: EndOfLife) -> float:
            """Returns the length of the life with an end [s]; NaN where it does not meet it."""
            life = lives(with_end(scene, end))
            return life.last.time if life.status == code.OK else np.nan

        return hertzian_length
    worn = replace(with_end(scene, farthest), model=replace(scene.model, contact="worn"))
    life = worn_life(worn, quick)
    assert life is not None

    @cache
    def time_to_limit(name: str, limit: float) -> float:
        """Returns the time at which the life meets one criterion [s]; NaN if it does not."""
        return life.time_to(criteria_of(with_end(worn, EndOfLife(**{name: limit}))))

    def worn_length(end: EndOfLife) -> float:
        """Returns the time at which the life meets the first criterion [s]; NaN if none."""
        times = [time_to_limit(name, limit) for name, limit in end.criteria.items()]
        return float(np.fmin.reduce(times))  # leaves out NaN, of a criterion that is not met

    return worn_length
