"""A scene grown and warmed in steps, to see what each of them changes and costs."""

from dataclasses import replace

from bearingwear.kernels import status as code
from bearingwear.scene.scene import Scene
from bearingwear.scene.warmth import Conductance, Temperature, Thermal
from bearingwear.solvers.bearing.mounted import MM
from bearingwear.solvers.condition import Condition
from bearingwear.solvers.effects.growth import WARMER, assumed_bore
from bearingwear.solvers.steady import Steady

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
