"""A scene as one bearing, and as the pair whose half that is: what a rotor on two changes."""

from dataclasses import replace
from typing import Any

from bearingwear.scene.arrangement import PAIRS, Arrangement
from bearingwear.scene.scene import Scene

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
