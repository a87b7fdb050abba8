"""Bearings of a rotor at launch, as a dataset."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import xarray as xr

from bearingwear import Scene
from bearingwear.applications.launch.sheet import launch_document
from bearingwear.results.variable import Variable, table
from bearingwear.solvers.bearing.launch import GRAVITY, LaunchLoad, LaunchResult
from bearingwear.studies.dataset import dataset_of_rows

WEAR_STATE = Variable("state", ("state",), "", "state of wear", "O")
LAUNCH_LOAD = Variable("load", ("load",), "", "direction of the load", "O")
EACH_BEARING = Variable("bearing", ("bearing",), "1", "number of the bearing", "i8")
_OF_LOAD, _OF_BEARING = LAUNCH_LOAD.dims, LAUNCH_LOAD.dims + EACH_BEARING.dims

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
    Variable("axial_force", _OF_LOAD, "N", "axial force on the rotor"),
    Variable("radial_force", _OF_LOAD, "N", "radial force on the rotor"),
    Variable("shift", _OF_LOAD, "m", "axial displacement of the rotor"),
    Variable("across", _OF_LOAD, "m", "radial displacement of the rotor"),
    Variable("tilt", _OF_LOAD, "rad", "tilt of the rotor"),
    Variable("slide", _OF_LOAD, "m", "extension of the preload spring"),
    Variable("on_stop", _OF_LOAD, "N", "force on the stop of the preload spring"),
    Variable("axial_load", _OF_BEARING, "N", "axial load of a bearing"),
    Variable("radial_load", _OF_BEARING, "N", "radial load of a bearing"),
    Variable("largest_ball_load", _OF_BEARING, "N", "load of the most loaded ball"),
    Variable("least_ball_load", _OF_BEARING, "N", "load of the least loaded ball"),
    Variable("loose_balls", _OF_BEARING, "1", "number of balls without load"),
    Variable("pressure_inner", _OF_BEARING, "Pa", "largest pressure at the inner race"),
    Variable("pressure_outer", _OF_BEARING, "Pa", "largest pressure at the outer race"),
    Variable("gap", _OF_BEARING, "m", "gap of a bearing"),
)  # fmt: skip
"""Results of a launch in one state of wear."""


def launch_dataset(scene: Scene, states: Mapping[str, LaunchResult]) -> xr.Dataset:
    """Returns loads and gaps at launch as a dataset over state of wear, load and bearing.

    states: results by the name of the state of wear, from `lives.margin.launched_by_wear`; all have
        the same loads.
    """
    loads = [load.name for load in next(iter(states.values())).loads]
    axes: dict[Any, Any] = {WEAR_STATE: list(states), LAUNCH_LOAD: loads, EACH_BEARING: (1, 2)}
    return dataset_of_rows(
        LAUNCH,
        axes,
        [_launch_row(state) for state in states.values()],
        title=f"Launch of {scene.name}",
        kind="launch",
        scene=scene,
        sheet=launch_document(scene, states).stored,
    )


def _launch_row(state: LaunchResult) -> dict[str, Any]:
    """Returns the values of one state of wear by the names of `LAUNCH` [SI].

    Values of each load are lists (loads,), values of each bearing lists of lists (loads, 2).
    """
    row: dict[str, Any] = {
        "axial_acceleration": GRAVITY * state.axial_g,
        "radial_acceleration": GRAVITY * state.radial_g,
        "opening_acceleration": GRAVITY * state.opening_g,
        "denting_acceleration": GRAVITY * state.denting_g,
        "denting_pressure": state.pressure,
        "launch_gap": state.gap,
        "launch_pressure_share": state.pressure_share,
        "axial_force": [load.axial for load in state.loads],
        "radial_force": [load.radial for load in state.loads],
    }
    rotors = [_rotor_row(load) for load in state.loads]
    return row | {name: [rotor[name] for rotor in rotors] for name in LAUNCH if name not in row}


def _rotor_row(load: LaunchLoad) -> dict[str, Any]:
    """Returns the values of rotor and bearings under one load by the names of `LAUNCH` [SI].

    Those of bearings are lists (2,). All are NaN where the spring does not support the rotor.
    """
    rotor = load.rotor
    if rotor is None:
        nan_by_dims = {_OF_LOAD: math.nan, _OF_BEARING: [math.nan, math.nan]}
        return {
            name: nan_by_dims[variable.dims] for name, variable in LAUNCH.items() if variable.dims
        }
    bearings = rotor.bearings
    return {
        "shift": rotor.shift,
        "across": rotor.across,
        "tilt": rotor.tilt,
        "slide": rotor.slide,
        "on_stop": rotor.on_stop,
        "axial_load": [bearing.axial for bearing in bearings],
        "radial_load": [bearing.radial for bearing in bearings],
        "largest_ball_load": [bearing.load.max() for bearing in bearings],
        "least_ball_load": [bearing.load.min() for bearing in bearings],
        "loose_balls": [(bearing.load == 0.0).sum() for bearing in bearings],
        "pressure_inner": [bearing.pressure[:, 0].max() for bearing in bearings],
        "pressure_outer": [bearing.pressure[:, 1].max() for bearing in bearings],
        "gap": [bearing.gap for bearing in bearings],
    }
