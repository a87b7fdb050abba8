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
"""Dimension of what each bearing of a pair has as its own; it stands first."""

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
    Variable("natural_frequency", ("mode",), "Hz",
        "natural frequency of the rigid rotor at standstill",
        comment="by default, the centre of mass is midway between the bearings, and "
                "the transverse inertia is that of a slender rod",
        label="natural frequency"),
    Variable("rotor_balance_residual", (), "1",
        "residual of the rotor's force and position balances, relative to the larger preload"),
)
"""Of the arrangement, once for both bearings."""
# fmt: on


def is_pair(scene: Mapping[str, Any]) -> bool:
    """Whether a scene, as a file holds it, is of two bearings."""
    return (scene.get("arrangement") or {}).get("kind") in METHODS


def method_words(scene: Mapping[str, Any], method: str) -> str:
    """Preload method in words; for a pair, its kind."""
    return (PAIRS[method] if is_pair(scene) else method).replace("_", " ")


def of_pair(known: Mapping[str, Variable]) -> dict[str, Variable]:
    """A table as a file of a pair has it: what is not shared has a value for each bearing."""
    return {
        name: v if name in SHARED else replace(v, dims=(OF_BEARING, *v.dims))
        for name, v in known.items()
    }
