"""States of the bearings of a scene, at the temperatures of their heat or at given ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bearingwear.kernels import status as code
from bearingwear.scene.checking.errors import SceneError
from bearingwear.scene.scene import Scene
from bearingwear.scene.warmth import Thermal
from bearingwear.solvers.bearing.rotor_balance import Nearby
from bearingwear.solvers.condition import USABLE, Conditions, States
from bearingwear.solvers.rotor import Alone, OnRotor, RotorState
from bearingwear.solvers.state import State
from bearingwear.solvers.thermal import (
    HeatFlow,
    Warmed,
    heat_of_parts,
    heat_slopes,
    thermal_margin,
)
from bearingwear.solvers.warm import NOTHING, Warm


def states_of(bearings: Alone | OnRotor, conditions: Conditions, found: RotorState) -> States:
    if found.status != code.OK:
        return tuple(State.unsolved(found.status, one.loss) for one in conditions)
    values = found.values
    if ends_by_thermal_margin(bearings.scene):
        values |= margin_values(bearings, conditions, found)
    each = zip(bearings.sides, found.sides, strict=True)
    return tuple(side.state(one).with_values(values) for side, one in each)


def ends_by_thermal_margin(scene: Scene) -> bool:
    end = scene.wear.end_of_life
    return end is not None and end.thermal_margin is not None


def kept_at(
    bearings: Alone | OnRotor, temperatures: np.ndarray, networks: Sequence[Thermal] = ()
) -> Alone | OnRotor | None:
    """Bearings at given temperatures (bearing, part) [degC] in place of those of their heat.

    networks: with the temperatures of shafts and housings, if not those of the scene.
    None where one of them cannot be so warm.
    """
    kept = []
    for k, (side, each) in enumerate(zip(bearings.sides, temperatures, strict=True)):
        network = networks[k] if networks else side.scene.thermal
        assert isinstance(side, Warm) and network is not None
        try:
            t = network.parts(*map(float, each))
            scene = replace(side.scene, temperature=t, thermal=None)
        except SceneError:
            return None
        kept.append(Warm(side.solver, Warmed(code.OK, scene, NOTHING, 0, np.zeros((3, 3)))))
    if isinstance(bearings, Alone):
        return Alone(bearings.scene, tuple(kept), bearings.near)
    return replace(bearings, sides=tuple(kept), nearby=Nearby(), near=list(bearings.near))


def heats_of(bearings: Alone | OnRotor, found: RotorState) -> tuple[HeatFlow, ...]:
    """Heat of each bearing in a state that was found."""
    each = zip(bearings.sides, found.sides, strict=True)
    return tuple(side.heat(one) for side, one in each)


def margin_values(
    bearings: Alone | OnRotor, conditions: Conditions, found: RotorState
) -> dict[str, float]:
    """The thermal margin of bearings with thermal networks in a state that was found."""
    networks = [side.scene.thermal for side in bearings.sides]
    if not any(networks):
        return {"thermal_margin": math.inf}  # temperatures that are given do not run away
    if found.status not in USABLE or not all(networks):
        return {}

    def heats(temperatures: np.ndarray) -> np.ndarray | None:
        kept = kept_at(bearings, temperatures)
        there = None if kept is None else kept.solve(conditions)
        if kept is None or there is None or there.status not in USABLE:
            return None
        return heat_of_parts(heats_of(kept, there))

    warm = [one.warmed.scene.temperature for one in found.sides if one.warmed]
    parts = np.array([(t.inner_ring_C, t.balls_C, t.outer_ring_C) for t in warm if t], dtype=float)
    given = [network for network in networks if network]
    return {"thermal_margin": thermal_margin(given, heat_slopes(heats, parts))}
