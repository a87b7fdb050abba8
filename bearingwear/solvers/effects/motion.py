"""How the dynamic model finds a motion: marched until it settles, or directly as a periodic one."""

import numpy as np

from bearingwear.scene.scene import Scene
from bearingwear.solvers.errors import NotAvailable

LIKE = 1e-9  # of the diameter: balls that differ by less are alike


def why_not_periodic(scene: Scene) -> str:
    """Why a scene (with its cage if that is solved) has no periodic motion; empty if it has one."""
    operation = scene.operation
    standing = any(operation.radial_load_N) or operation.tilt_mrad
    if scene.cage is not None:
        return "a cage"
    if 1e-3 * np.ptp(scene.wear.ball_diameter_loss_um) > LIKE * scene.bearing.ball_diameter_mm:
        return "unequal ball diameters"
    if standing and operation.rotating_load_N:
        return "loads that stand still beside one that turns"
    if not standing and not operation.rotating_load_N:
        return "thrust alone"
    return ""


def is_found_periodic(scene: Scene) -> bool:
    """Whether a periodic motion is looked for: on request, or where no history is asked for."""
    asked = scene.model.dynamic_solution
    if asked == "auto":
        return not (scene.model.history_points_per_turn or why_not_periodic(scene))
    return asked == "periodic"


def check_solution(scene: Scene) -> None:
    """Refuse to look for a periodic motion where there is none.

    Raises
    ------
    NotAvailable
    """
    if scene.model.dynamic_solution == "periodic" and (why := why_not_periodic(scene)):
        raise NotAvailable(
            f"{scene.name}: model.dynamic_solution: got periodic with {why}, expected auto, march"
        )


def motion_sentence(scene: Scene) -> str:
    """How the motion is found, and why, in words."""
    if is_found_periodic(scene):
        return "motion: found as a periodic one, the balls evenly spaced as a cage would keep them"
    if scene.model.dynamic_solution == "march":
        return "motion: marched until it settles (model.dynamic_solution)"
    why = why_not_periodic(scene) or "histories are asked for (model.history_points_per_turn)"
    return f"motion: marched until it settles, since no periodic one is sought: {why}"
