"""Lives of a scene with grooves as they wear, by the loss that ends them, by cells and steps."""

from dataclasses import replace

from bearingwear.lives.groove_life import wear_over_gap
from bearingwear.lives.grooves import STEP, WORN_CELLS, Grooves, follow_grooves
from bearingwear.lives.history import life_values
from bearingwear.lives.life import life
from bearingwear.scene.blocks import EndOfLife
from bearingwear.scene.scene import Scene
from workflow.studies.accuracy.plan import SweepPoint

PRELOAD_LEFT = 0.4
"""Of the preload, at which a life ends as well."""


def ended_scene(scene: Scene, end: str) -> Scene:
    """The scene whose life ends at a loss of so many gaps at the contact's edge, A a^2.

    Or at 40 % of its preload, whichever comes first.
    """
    if not end:
        return scene

    def by(loss_um: float, method: str) -> Scene:
        limits = EndOfLife(ball_diameter_loss_um=loss_um, preload_fraction=PRELOAD_LEFT)
        operation = replace(scene.operation, preload_method=method)
        wear = replace(scene.wear, end_of_life=limits, ball_diameter_loss_um=(0.0,))
        return replace(scene, operation=operation, wear=wear)

    gaps_of_1_um = wear_over_gap(by(1.0, "constant_force"))
    return by(float(end) / gaps_of_1_um, scene.operation.preload_method)


def lived_through(fresh: Scene, point: SweepPoint) -> dict:
    """Values of a life: as `life` has it, or once with the cells and steps of a point."""
    if not (point.cells or point.step):
        return life(fresh, point.fidelity).values
    along, across = map(int, point.cells.split(" x ")) if point.cells else WORN_CELLS
    wearing = Grooves(fresh, (along, across), float(point.step or STEP))
    return life_values(fresh, follow_grooves(wearing))
