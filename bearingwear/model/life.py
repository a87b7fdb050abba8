"""Wear life: follow the loss of ball diameter to the first end-of-life criterion.

Contact state, slip and preload are solved anew at every loss that the integral needs.
"""

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.measures import ENDS
from bearingwear.model import parameters
from bearingwear.model.criterion import end_attribute
from bearingwear.model.estimate import DOUBLED, HALVED, ROUNDING, changed
from bearingwear.model.fidelity import NotAvailable, choice_for_life
from bearingwear.model.film_values import film_values
from bearingwear.model.growth_told import growth_values
from bearingwear.model.interrupt import Interrupt
from bearingwear.model.life_integrator import (
    FIRST_STEP,
    LifeHistory,
    LifeIntegrator,
)
from bearingwear.model.result import Result
from bearingwear.model.solve import provenance
from bearingwear.model.state import State, history_values
from bearingwear.model.states_at_loss import StateAtLoss, race_control_states, steady_states
from bearingwear.model.steady import ThrustProblem
from bearingwear.model.wear_path import KnownStates, PathLives, States, WearPath, path_lives
from bearingwear.scene.friction import changes_as_it_wears
from bearingwear.scene.scene import LARGEST_LOSS, EndOfLife, Scene, SceneError


def margins(state: State, end: EndOfLife, preload_N: float) -> np.ndarray:
    """How far each criterion of `CRITERIA` is from being met.

    Positive before, zero or below where it is met; infinite where it is not asked for, or the state
    does not know its measure.
    """
    found = np.full(len(ENDS), np.inf)
    for k, (name, measure) in enumerate(ENDS.items()):
        limit = getattr(end, name)
        if limit is not None:
            margin = measure.margin(measure.critical(state.__getitem__, preload_N)[0], limit)
            found[k] = np.inf if math.isnan(margin) else margin
    return found


def life(
    scene: Scene, fidelity: str | None = None, progress: Callable[[str], None] | None = None
) -> Result:
    """Wear life of a scene from its present loss of ball diameter on.

    Parameters
    ----------
    scene : Scene
        With `wear.end_of_life`.
    fidelity : str, optional
        Overrides `model.fidelity` of the scene.
    progress : callable, optional
        Given one line of text at each step of a dynamic life; others are done by then.

    Returns
    -------
    Result
        Life, its error bound and the history; where no criterion was met, `status` says so and the
        life is a lower bound.

    Raises
    ------
    SceneError
        Where the scene has no end-of-life criterion, or a preload fraction without a preload.
    NotAvailable
        Where the fidelity asked for cannot solve this scene.
    """
    _check_end(scene)
    chosen = choice_for_life(scene, fidelity)
    end = scene.wear.end_of_life or EndOfLife()
    started = time.perf_counter()
    if chosen.fidelity == "dynamic":
        # its kernels take long to load, and the other models need none of them
        from bearingwear.model.dynamic_life import solve_dynamic_life

        _check_depth(scene, end)
        values, attrs = solve_dynamic_life(chosen.reduced(scene), progress)
    else:
        from bearingwear.model.worn_outputs import grooves_followed

        followed, why = grooves_followed(scene, chosen.fidelity)
        if why:
            chosen = replace(chosen, reasons=(*chosen.reasons, why))
        if followed is None:
            _check_depth(scene, end)
        with Interrupt():
            values, attrs = _solved(scene, chosen.fidelity, followed)
    elapsed = time.perf_counter() - started
    if scene.thermal is None and scene.pair is None:  # or each bearing has its own
        values |= growth_values(scene)
    attrs |= end_attribute(scene, values) | provenance(scene, chosen, values)
    return Result(values, attrs, elapsed)


def _solved(scene: Scene, fidelity: str, followed: Scene | None) -> tuple[dict, dict]:
    """Life by steady states: of the scene whose grooves are followed, of a pair, or of neither."""
    # these need what this module has
    from bearingwear.model.pair_life import of_both, pair_life
    from bearingwear.model.worn_outputs import solve_worn_life

    if followed is not None:
        values, attrs = solve_worn_life(followed)
        # one of two identical bearings, or the scene itself
        return (values if followed is scene else of_both(values, values)), attrs
    if scene.pair is not None:
        return pair_life(scene, fidelity)
    return solve_life_over_loss(scene, fidelity)


def _check_depth(scene: Scene, end: EndOfLife) -> None:
    """Refuse a limit on the depth of grooves where the life does not follow them."""
    if end.groove_depth_um is not None:
        raise NotAvailable(
            f"{scene.name}: wear.end_of_life.groove_depth_um: got {end.groove_depth_um:g} with "
            "grooves that are not followed, expected model.contact worn"
        )


def _check_end(scene: Scene) -> None:
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


def solve_life_over_loss(scene: Scene, fidelity: str) -> tuple[dict, dict]:
    """Values and attributes of a life that depends on the loss alone."""
    if fidelity == "steady":
        history = life_history(scene, steady_states(scene))
        values = life_values(scene, history) | error_estimate(scene, history)
    else:
        history = life_history(scene, race_control_states(scene))
        values = life_values(scene, history)
    return values, {"solves": history.solves}


def life_history(scene: Scene, state: StateAtLoss) -> LifeHistory:
    """Wear states of a scene, given by the function `state`, up to its end of life."""
    end, preload = scene.wear.end_of_life or EndOfLife(), scene.operation.preload_N
    if changes_as_it_wears(scene):
        return _along_films(scene, state)
    integrator = LifeIntegrator(state, lambda s: margins(s, end, preload), scene.model.tolerance)
    D0 = scene.bearing.ball_diameter_mm * parameters.MM
    return integrator.integrate(
        scene.wear.ball_diameter_loss_um[0] * parameters.UM, LARGEST_LOSS * D0, FIRST_STEP * D0
    )


def _along_films(scene: Scene, state: StateAtLoss) -> LifeHistory:
    """Life of a bearing whose films wear through, or whose surfaces run in."""
    states = KnownStates(lambda conditions: (state(*conditions[0]),))
    course, times, error = lives_along(scene, states)
    return LifeHistory(
        states=[one for (one,) in course.states],
        times=list(times),
        error=error,
        criterion=course.criterion,
        status=course.status,
        solves=states.solves,
    )


def lives_along(scene: Scene, states: KnownStates, bounded: bool = True, **more: Any) -> PathLives:
    """Lives of one bearing or of two from their states; `more` as of `WearPath`."""

    def path(*how: Any) -> WearPath:
        return wear_path(scene, states, *how, **more)

    return path_lives(scene, path, bounded)


def wear_path(scene: Scene, states: KnownStates, *how: Any, **more: Any) -> WearPath:
    """The path of a scene to its end of life; the rest as of `WearPath`."""
    end = scene.wear.end_of_life or EndOfLife()

    def worst(found: States) -> np.ndarray:
        each = zip(found, scene.sides, strict=True)
        return np.min([margins(s, end, side.operation.preload_N) for s, side in each], axis=0)

    return WearPath(scene.sides, states, worst, *how, **more)


def error_estimate(scene: Scene, history: LifeHistory) -> dict:
    """Estimated numerical error of a life: the same with other settings (see `estimate`)."""
    now = history.times[-1]
    if history.status != code.OK or not now.min() > 0.0:
        return {}
    total = ROUNDING + history.error / now
    problems = ThrustProblem.of(scene).perturbed(scene)
    for weight, problem in zip((HALVED, DOUBLED), problems, strict=True):
        other = life_history(scene, steady_states(scene, problem))
        if (other.status, other.criterion) != (history.status, history.criterion):
            return {}
        total = total + weight * changed(now, other.times[-1])
    return {"life_error_estimate": total}


def life_values(scene: Scene, history: LifeHistory) -> dict:
    """Result variables of a life."""
    values: dict = {"status": history.status, "end_criterion": history.criterion}
    states = history.states
    if states[0].status != code.OK or not np.fmin.reduce(states[0].rate) > 0.0:
        return values
    factor, _ = parameters.wear_factors(scene)
    values |= {
        "life": history.times[-1],
        "normalised_life": history.times[-1] * factor,
        "life_error_bound": history.error,
        "loss_at_end": states[-1].loss,
        "history_time": np.array(history.times),
    }
    return values | history_values(states) | film_values(scene, states, np.array(history.times))
