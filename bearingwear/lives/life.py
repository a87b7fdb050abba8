"""Wear life: from a `Scene` with an end of life to a `Result`."""

import time
from collections.abc import Callable
from dataclasses import replace

from bearingwear.lives.duty.result import life_over_duty
from bearingwear.lives.errors import surface_error
from bearingwear.lives.groove_life import groove_choice, groove_life
from bearingwear.lives.history import joined, life_values
from bearingwear.lives.surfaces import surface_life, surface_steps_error
from bearingwear.scene.read import scene_for_life
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.growth import lasting_growth
from bearingwear.solvers.compose import solver_of
from bearingwear.solvers.effects.choice import choice_for_life
from bearingwear.solvers.effects.criterion import end_attribute
from bearingwear.solvers.result import Result
from bearingwear.solvers.solve import result_of
from kerneljit.interrupt import Interrupt


def life(
    scene: Scene, fidelity: str | None = None, progress: Callable[[str], None] | None = None
) -> Result:
    """Returns the wear life of a scene from its present loss on, over its duty if it has one.

    Where no criterion was met, `status` says so and the life is a lower bound. Raises SceneError
    where the scene has no criterion, or a preload fraction without a preload. Raises NotAvailable
    where the model, or that which the scene requires, cannot follow such a life.

    fidelity: model in place of that of the scene: `auto`, `steady`, `dynamic` or `race_control`.
    progress: receives one line of text at each step of a dynamic life.
    """
    if scene_for_life(scene, scene.name).duty is not None:
        return life_over_duty(scene, fidelity)
    choice = choice_for_life(scene, fidelity)
    started = time.perf_counter()
    grooves = groove_choice(scene, choice.fidelity)
    if choice.fidelity == "dynamic":
        # its kernels take long to load, and the other models need none of them
        from bearingwear.lives.dynamic_life import motion_life

        values, attrs = motion_life(choice.reduced(scene), progress)
    else:
        choice = replace(choice, grooves=grooves.sentence)
        with Interrupt():
            if grooves.scene is not None:
                values, attrs = groove_life(grooves.scene)
            else:
                values, attrs = hertzian_life(scene.symmetric_half, choice.fidelity)
        if scene.symmetric_half is not scene:
            values = joined([values, values])
    elapsed = time.perf_counter() - started
    values |= lasting_growth(scene)
    attrs |= {"wear_counts": scene.wear.counts}
    return result_of(scene, choice, values, attrs | end_attribute(scene, values), elapsed)


def hertzian_life(scene: Scene, fidelity: str) -> tuple[dict, dict]:
    """Returns values and attributes of a life whose contacts stay Hertzian.

    Values are result variables [SI], as those of `life_values`. By the fidelity `steady` they
    include an estimate of the relative error of the life, where `surface_error` has one.

    fidelity: `steady` or `race_control`.
    """
    solver = solver_of(scene, fidelity)
    followed = surface_life(scene, solver)
    followed.error = surface_steps_error(scene, solver, followed)
    attrs = {"solves": solver.solves}
    values = life_values(scene, followed)
    if fidelity == "steady":
        values |= surface_error(scene, followed)
    return values, attrs
