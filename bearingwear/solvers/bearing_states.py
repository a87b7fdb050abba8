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
from bearingwear.solvers.warm import Warm


def states_of(bearings: Alone | OnRotor, conditions: Conditions, rotor: RotorState) -> States:
    """Returns the state of each bearing on a rotor, with the values of the arrangement.

    They include the thermal margin if it may end the life. If the rotor was not solved, the states
    have its status and their loss alone.

    conditions: that the bearings were solved in.
    rotor: their solution.
    """
    if rotor.status != code.OK:
        return tuple(State.unsolved(rotor.status, condition.loss) for condition in conditions)
    values = rotor.values
    if ends_by_thermal_margin(bearings.scene):
        values |= margin_values(bearings, conditions, rotor)
    return tuple(
        solver.state(solution).with_values(values)
        for solver, solution in zip(bearings.sides, rotor.sides, strict=True)
    )


def ends_by_thermal_margin(scene: Scene) -> bool:
    """Returns whether the thermal margin may end the life."""
    end = scene.wear.end_of_life
    return end is not None and end.thermal_margin is not None


def bearings_at_temperatures(
    bearings: Alone | OnRotor, temperatures: np.ndarray, networks: Sequence[Thermal] = ()
) -> Alone | OnRotor | None:
    """Returns bearings with thermal networks at given temperatures, not at those of their heat.

    None if one of them cannot be so warm.

    temperatures: (bearing, part) [degC].
    networks: with the temperatures of shafts and housings, if not those of the scene.
    """
    solvers = []
    for k, (solver, part_temperatures) in enumerate(zip(bearings.sides, temperatures, strict=True)):
        network = networks[k] if networks else solver.scene.thermal
        assert isinstance(solver, Warm) and network is not None
        try:
            temperature = network.parts(*map(float, part_temperatures))
            scene = replace(solver.scene, temperature=temperature, thermal=None)
        except SceneError:
            return None
        solvers.append(Warm(solver.solver, Warmed.as_given(scene)))
    if isinstance(bearings, Alone):
        return Alone(bearings.scene, tuple(solvers), bearings.near)
    return replace(bearings, sides=tuple(solvers), nearby=Nearby(), near=list(bearings.near))


def heats_of(bearings: Alone | OnRotor, rotor: RotorState) -> tuple[HeatFlow, ...]:
    """Returns the heat of each bearing in a state of the rotor."""
    return tuple(
        solver.heat(solution) for solver, solution in zip(bearings.sides, rotor.sides, strict=True)
    )


def margin_values(
    bearings: Alone | OnRotor, conditions: Conditions, rotor: RotorState
) -> dict[str, float]:
    """Returns the thermal margin of bearings in a state of the rotor, as a result variable.

    It is infinite without a thermal network. Empty if the state was not solved, or if only one of
    two bearings has a network.
    """
    networks = [side.scene.thermal for side in bearings.sides]
    if not any(networks):
        return {"thermal_margin": math.inf}  # temperatures that are given do not run away
    if rotor.status not in USABLE or not all(networks):
        return {}

    def heats(temperatures: np.ndarray) -> np.ndarray | None:
        """Returns the heat of all parts at other temperatures; None without a state."""
        bearings_there = bearings_at_temperatures(bearings, temperatures)
        if bearings_there is None:
            return None
        rotor_there = bearings_there.solve(conditions)
        if rotor_there.status not in USABLE:
            return None
        return heat_of_parts(heats_of(bearings_there, rotor_there))

    warmth = [solution.warmed.scene.temperature for solution in rotor.sides if solution.warmed]
    parts = np.array(
        [(t.inner_ring_C, t.balls_C, t.outer_ring_C) for t in warmth if t], dtype=float
    )
    all_networks = [network for network in networks if network]
    return {"thermal_margin": thermal_margin(all_networks, heat_slopes(heats, parts))}
