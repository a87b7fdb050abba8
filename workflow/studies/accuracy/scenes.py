"""Scenes and lives of the points of sweeps that change what is solved, not how."""

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
"""Of the ball diameter: by how much more the balls of the second bearing are worn."""


def on_a_rotor(scene: Scene, machine: str) -> Scene:
    """The scene as a point of the sweep `machine` has it.

    alone: as it is. alike: two such bearings on a rotor, held as its preload method says. pushed:
    besides, an axial force of half of the preload on the rotor. worn_apart: in place of that, a
    second bearing whose balls are worn more.
    """
    if machine in ("", "alone"):
        return scene
    changes: dict[str, Any] = {}
    if machine == "pushed":
        changes["external_axial_N"] = PUSHED * scene.operation.preload_N
    elif machine == "worn_apart":
        more = 1e3 * WORN_APART * scene.bearing.ball_diameter_mm
        loss = tuple(one + more for one in scene.wear.ball_diameter_loss_um)
        changes["second"] = {"wear.ball_diameter_loss_um": list(loss)}
    kind = PAIRS[scene.operation.preload_method]
    a = replace(scene.arrangement or Arrangement(), kind=kind, **changes)
    return replace(scene, arrangement=a)


NETWORK_KELVIN = 10.0
"""At which each of the conductances of `network` would carry all the heat away by itself."""


def grown_scene(scene: Scene, warmth: str) -> Scene:
    """The scene as a point of the sweep `warmth` has it.

    mounted: as it is. at_speed: the rings grow at speed; a bore that nobody gave is a usual one.
    warm_ring: besides, an inner ring 5 K and balls 2.5 K warmer than the outer ring. network: the
    temperatures found from the friction heat; each conductance alone carries it away at 10 K.
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
    found = solver(Condition(0.0))
    G = solver.heat(found).total / NETWORK_KELVIN if found.status == code.OK else 1.0
    network = Conductance(inner_ring_shaft=G, outer_ring_housing=G, ball_race=G)
    return replace(turning, thermal=Thermal(conductance_W_K=network))


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
    along, across = map(int, point.cells.split(" x ")) if point.cells else EXACT_GROOVES.cells
    mode = EXACT_GROOVES._replace(
        cells=(along, across), step=float(point.step or EXACT_GROOVES.step)
    )
    return life_values(fresh, follow_grooves(StiffGrooves(fresh, mode)))
