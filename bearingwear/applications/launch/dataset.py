"""Bearings of a rotor at launch, as a dataset."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import xarray as xr

from bearingwear.applications.launch.sheet import launch_document
from bearingwear.results.variable import Variable, table
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.launch import GRAVITY, Launched, LaunchLoad
from bearingwear.studies.dataset import dataset_of_rows

WEAR_STATE = Variable("state", ("state",), "", "state of wear", "O")
LAUNCH_LOAD = Variable("load", ("load",), "", "direction of the load", "O")
EACH_BEARING = Variable("bearing", ("bearing",), "1", "number of the bearing", "i8")
_ROTOR, _EACH = LAUNCH_LOAD.dims, LAUNCH_LOAD.dims + EACH_BEARING.dims

LAUNCH = table(
    Variable("axial_acceleration", (), "m s-2", "axial acceleration of the rotor"),
    Variable("radial_acceleration", (), "m s-2", "radial acceleration of the rotor"),
    Variable("opening_acceleration", (), "m s-2", "axial acceleration at which a bearing gaps"),
    Variable("denting_acceleration", (), "m s-2",
        "axial acceleration at which a bearing is dented"),
    Variable("denting_pressure", (), "Pa", "pressure that dents the weaker of balls and races"),
    Variable("launch_gap", (), "m", "largest gap of a bearing under any load; infinite where "
        "nothing holds the rotor"),
    Variable("launch_pressure_share", (), "1",
        "largest peak pressure under any load, relative to denting_pressure"),
    Variable("axial_force", _ROTOR, "N", "axial force on the rotor"),
    Variable("radial_force", _ROTOR, "N", "radial force on the rotor"),
    Variable("shift", _ROTOR, "m", "axial displacement of the rotor"),
    Variable("across", _ROTOR, "m", "radial displacement of the rotor"),
    Variable("tilt", _ROTOR, "rad", "tilt of the rotor"),
    Variable("slide", _ROTOR, "m", "extension of the preload spring"),
    Variable("on_stop", _ROTOR, "N", "force on the stop of the preload spring"),
    Variable("axial_load", _EACH, "N", "axial load of a bearing"),
    Variable("radial_load", _EACH, "N", "radial load of a bearing"),
    Variable("largest_ball_load", _EACH, "N", "load of the most loaded ball"),
    Variable("least_ball_load", _EACH, "N", "load of the least loaded ball"),
    Variable("loose_balls", _EACH, "1", "number of balls without load"),
    Variable("pressure_inner", _EACH, "Pa", "largest pressure at the inner race"),
    Variable("pressure_outer", _EACH, "Pa", "largest pressure at the outer race"),
    Variable("gap", _EACH, "m", "gap of a bearing"),
)  # fmt: skip
"""What is known of a launch in one state of wear."""


def launch_dataset(scene: Scene, found: Mapping[str, Launched]) -> xr.Dataset:
    """Launch loads and gaps by the state of wear, as `lives.margin.launched_by_wear` has them."""
    loads = [load.name for load in next(iter(found.values())).loads]
    axes: dict[Any, Any] = {WEAR_STATE: list(found), LAUNCH_LOAD: loads, EACH_BEARING: (1, 2)}
    return dataset_of_rows(
        LAUNCH,
        axes,
        [_row(one) for one in found.values()],
        title=f"Launch of {scene.name}",
        kind="launch",
        scene=scene,
        sheet=launch_document(scene, found).stored,
    )


def _row(one: Launched) -> dict[str, Any]:
    """Values of one state of wear."""
    row: dict[str, Any] = {
        "axial_acceleration": GRAVITY * one.axial_g,
        "radial_acceleration": GRAVITY * one.radial_g,
        "opening_acceleration": GRAVITY * one.opening_g,
        "denting_acceleration": GRAVITY * one.denting_g,
        "denting_pressure": one.pressure,
        "launch_gap": one.gap,
        "launch_pressure_share": one.pressure_share,
        "axial_force": [load.axial for load in one.loads],
        "radial_force": [load.radial for load in one.loads],
    }
    rotors = [_rotor_row(load) for load in one.loads]
    return row | {name: [rotor[name] for rotor in rotors] for name in LAUNCH if name not in row}


def _rotor_row(load: LaunchLoad) -> dict[str, Any]:
    """Values of the rotor and of both bearings under one load; NaN where nothing holds it."""
    rotor = load.rotor
    if rotor is None:
        missing = {_ROTOR: math.nan, _EACH: [math.nan] * 2}
        return {name: missing[one.dims] for name, one in LAUNCH.items() if one.dims}
    each = rotor.bearings
    return {
        "shift": rotor.shift,
        "across": rotor.across,
        "tilt": rotor.tilt,
        "slide": rotor.slide,
        "on_stop": rotor.on_stop,
        "axial_load": [one.axial for one in each],
        "radial_load": [one.radial for one in each],
        "largest_ball_load": [one.load.max() for one in each],
        "least_ball_load": [one.load.min() for one in each],
        "loose_balls": [(one.load == 0.0).sum() for one in each],
        "pressure_inner": [one.pressure[:, 0].max() for one in each],
        "pressure_outer": [one.pressure[:, 1].max() for one in each],
        "gap": [one.gap for one in each],
    }
