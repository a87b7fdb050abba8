"""Scenes and lives of the points of sweeps that change the scene, not the numerical settings."""

from dataclasses import replace
from typing import Any

from bearingwear.kernels import status as code
from bearingwear.lives.groove_life import wear_over_gap
from bearingwear.lives.grooves import EXACT_GROOVES, StiffGrooves, follow_grooves
from bearingwear.lives.history import life_values
from bearingwear.lives.life import life
from bearingwear.scene.arrangement import PAIRS, Arrangement
from bearingwear.scene.blocks import EndOfLife
from bearingwear.scene.scene import Scene
from bearingwear.scene.warmth import Conductance, Temperature, Thermal
from bearingwear.solvers.bearing.mounted import MM
from bearingwear.solvers.condition import Condition
from bearingwear.solvers.effects.growth import WARMER, assumed_bore
from bearingwear.solvers.steady import Steady
from workflow.studies.accuracy.plan import SweepPoint

PUSHED = 0.5
"""External force over the preload."""

WORN_APART = 2e-5
"""Additional loss of the balls of the second bearing, relative to the ball diameter."""


def scene_on_rotor(scene: Scene, machine: str) -> Scene:
    """Returns the scene for a point of the sweep `machine`.

    machine: "alone" or "" for the scene itself; "alike" for two such bearings on a rotor, preloaded
        by its method; "pushed" for an axial force of half the preload on that rotor; "worn_apart"
        for more wear on the balls of the second bearing.
    """
    if machine in ("", "alone"):
        return scene
    changes: dict[str, Any] = {}
    if machine == "pushed":
        changes["external_axial_N"] = PUSHED * scene.operation.preload_N
    elif machine == "worn_apart":
        further_loss = 1e3 * WORN_APART * scene.bearing.ball_diameter_mm
        loss = tuple(value + further_loss for value in scene.wear.ball_diameter_loss_um)
        changes["second"] = {"wear.ball_diameter_loss_um": list(loss)}
    kind = PAIRS[scene.operation.preload_method]
    arrangement = replace(scene.arrangement or Arrangement(), kind=kind, **changes)
    return replace(scene, arrangement=arrangement)


NETWORK_KELVIN = 10.0
"""Temperature difference at which each conductance of `network` alone carries all the heat."""


def scene_with_growth(scene: Scene, warmth: str) -> Scene:
    """Returns the scene for a point of the sweep `warmth`.

    warmth: "mounted" or "" for the scene itself; "at_speed" for rings that grow at speed, where a
        missing bore is assumed; "warm_ring" for, besides, an inner ring that is 5 K and balls that
        are 2.5 K warmer than the outer ring; "network" for temperatures by the friction heat of the
        scene itself, which each conductance alone carries away at `NETWORK_KELVIN`. Conductances
        are 1 W/K if the scene has no steady state.
    """
    if warmth in ("", "mounted"):
        return scene
    turning = replace(scene, bearing=replace(scene.bearing, bore_mm=assumed_bore(scene) / MM))
    if warmth == "at_speed":
        return turning
    if warmth == "warm_ring":
        warm = Temperature(inner_ring_C=20.0 + WARMER, balls_C=20.0 + 0.5 * WARMER)
        return replace(turning, temperature=warm)
    solver = Steady(scene)
    state = solver(Condition(0.0))
    G = solver.heat(state).total / NETWORK_KELVIN if state.status == code.OK else 1.0
    network = Conductance(inner_ring_shaft=G, outer_ring_housing=G, ball_race=G)
    return replace(turning, thermal=Thermal(conductance_W_K=network))


PRELOAD_LEFT = 0.4
"""Fraction of the preload at which a life ends, too."""


def scene_with_end(scene: Scene, end: str) -> Scene:
    """Returns the unworn scene with a life that ends at a loss, or at `PRELOAD_LEFT` before.

    end: number as text, the loss over the gap A a^2 at the contact's edge; empty for the scene
        itself.
    """
    if not end:
        return scene

    def with_end(loss_um: float, method: str) -> Scene:
        """Returns the scene whose life ends at a loss, with a preload method."""
        limits = EndOfLife(ball_diameter_loss_um=loss_um, preload_fraction=PRELOAD_LEFT)
        operation = replace(scene.operation, preload_method=method)
        wear = replace(scene.wear, end_of_life=limits, ball_diameter_loss_um=(0.0,))
        return replace(scene, operation=operation, wear=wear)

    # a loss of 1 um over the gap; under a constant force, no preload is lost that ends it before
    gaps_of_1_um = wear_over_gap(with_end(1.0, "constant_force"))
    return with_end(float(end) / gaps_of_1_um, scene.operation.preload_method)


def life_of_point(new_scene: Scene, point: SweepPoint) -> dict:
    """Returns the values of a life by name, with the cells and steps of a point if it has any.

    A point with either has a life with worn grooves and without error estimates.
    """
    if not (point.cells or point.step):
        return life(new_scene, point.fidelity).values
    along, across = map(int, point.cells.split(" x ")) if point.cells else EXACT_GROOVES.cells
    mode = EXACT_GROOVES._replace(
        cells=(along, across), step=float(point.step or EXACT_GROOVES.step)
    )
    return life_values(new_scene, follow_grooves(StiffGrooves(new_scene, mode)))
