"""Variables of two bearings on one rotor: a part of the table in `results/variables.py`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from bearingwear.results.variable import Variable, table
from bearingwear.scene.arrangement import METHODS, PAIRS
from bearingwear.sides import SHARED

BEARINGS = ("first", "second")
MODES = ("axial", "radial", "conical")
OF_BEARING = "bearing"
"""The first dimension of variables that have a value for each bearing of a pair."""

PAIR_COORDINATES = table(
    Variable(OF_BEARING, (OF_BEARING,), "", "bearing of the pair", "i1", flags=BEARINGS),
    Variable("mode", ("mode",), "", "motion of the rotor", "i1", flags=MODES),
)

# fmt: off
SYSTEM = table(
    Variable("system_axial_stiffness", (), "N m-1",
        "combined dynamic axial stiffness of the two bearings",
        label="dynamic stiffness of the pair"),
    Variable("system_quasistatic_axial_stiffness", (), "N m-1",
        "combined quasi-static axial stiffness of the two bearings",
        label="quasi-static stiffness of the pair"),
    Variable("lift_off_force", (), "N",
        "minimum axial force on the rotor, in either direction, that unloads one of the bearings "
        "at rest",
        comment="the value allows for ball wear and running temperature",
        label="lift-off force"),
    Variable("rotor_axial_shift", (), "m", "axial shift of the rotor from its mounted position",
        comment="positive towards +X", label="rotor shift"),
    Variable("spring_travel", (), "m",
        "travel of the preload spring from where it was mounted",
        comment="positive where it extends; only of a spring pair", label="spring travel"),
    Variable("natural_frequency", ("mode",), "Hz",
        "natural frequency of the rigid rotor at standstill",
        comment="by default, the centre of mass is midway between the bearings, and "
                "the transverse inertia is that of a slender rod",
        label="natural frequency"),
    Variable("rotor_balance_residual", (), "1",
        "residual of the rotor's force and position balances, relative to the larger preload"),
)
"""Variables of the arrangement, with one value for both bearings."""
# fmt: on


def is_pair(scene: Mapping[str, Any]) -> bool:
    """Whether a scene, as plain data, contains two bearings."""
    return (scene.get("arrangement") or {}).get("kind") in METHODS


def method_words(scene: Mapping[str, Any], method: str) -> str:
    """Returns the words for a preload method; for a pair, those for the kind of the pair.

    scene: plain data; empty for a single bearing.
    """
    name = PAIRS[method] if is_pair(scene) else method
    return name.replace("_", " ")


def pair_table(table: Mapping[str, Variable]) -> dict[str, Variable]:
    """Returns a table of variables for a pair; those not in `SHARED` have a value for each bearing.

    table: variables of a single bearing by name.
    """
    return {
        name: variable if name in SHARED else replace(variable, dims=(OF_BEARING, *variable.dims))
        for name, variable in table.items()
    }
