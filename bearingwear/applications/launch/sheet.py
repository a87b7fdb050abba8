"""The sheet of a launch: loads of both bearings, and margins to gapping and denting."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

import numpy as np

from bearingwear import Scene
from bearingwear.document.bearing_line import operation_lines
from bearingwear.document.document import Block, Document, Row
from bearingwear.document.launch import (
    NEW_AND_WORN,
    launch_verdict,
    state_of_largest_gap,
    state_of_largest_pressure,
    state_suffix,
)
from bearingwear.results.units import span
from bearingwear.scene.new.minimum_preload import minimum_preload_lines
from bearingwear.scene.requirements import Launch
from bearingwear.solvers.bearing.launch import LaunchLoad, LaunchResult, RestingBearing

_UM, _MRAD, _GPA = 1e6, 1e3, 1e-9
_ROUNDING = 1e-9
"""Magnitude below which a number is only rounding, in each unit of these tables."""
_NEW_ONLY = "new bearings only: without an end of life that can be computed, wear is not known"

_BEARING_ROWS: tuple[tuple[str, str, str, Callable[[RestingBearing], float]], ...] = (
    ("axial load", "N", "axial_load", lambda bearing: bearing.axial),
    ("radial load", "N", "radial_load", lambda bearing: bearing.radial),
    ("maximum ball load", "N", "largest_ball_load", lambda bearing: float(bearing.load.max())),
    ("minimum ball load", "N", "least_ball_load", lambda bearing: float(bearing.load.min())),
    ("unloaded balls", "", "loose_balls", lambda bearing: int((bearing.load == 0.0).sum())),
    ("peak pressure, inner", "GPa", "pressure_inner",
     lambda bearing: _GPA * bearing.pressure[:, 0].max()),
    ("peak pressure, outer", "GPa", "pressure_outer",
     lambda bearing: _GPA * bearing.pressure[:, 1].max()),
    ("gap", "um", "gap", lambda bearing: _UM * bearing.gap),
)  # fmt: skip
"""Label, unit, name and value of each row of a bearing."""


def launch_document(scene: Scene, states: Mapping[str, LaunchResult]) -> Document:
    """Returns the report on the bearings of a scene at launch.

    states: results by the name of the state of wear, from `lives.margin.launched_by_wear`.
    """
    columns = tuple(states)
    blocks = [
        Block("axial acceleration limits", columns, _acceleration_limit_rows(states.values()))
    ]
    if next(iter(states.values())).random:
        title = f"random vibration over {(scene.launch or Launch()).duration_s:g} s"
        blocks.append(Block(title, columns, _random_rows(list(states.values()))))
    for state in _states_with_load_blocks(states):
        blocks += _load_blocks(states[state].loads, state_suffix(state, states))
    verdict = launch_verdict(scene, states)
    facts = {"kind": "launch", "scene": scene.name, "verdict": verdict}
    heading = (
        operation_lines(scene.plain)[0],
        *_vibration_lines(scene, states),
        *minimum_preload_lines(scene.plain),
    )
    return Document((*heading, *verdict), facts, tuple(blocks))


def _load_blocks(loads: Sequence[LaunchLoad], suffix: str) -> list[Block]:
    """Returns blocks of the rotor and of both bearings, with a column for each load.

    Without loads there are no blocks.

    suffix: of the titles, which names the state of wear.
    """
    if not loads:
        return []
    columns = tuple(load.name for load in loads)
    return [
        Block(f"rotor{suffix}", columns, tuple(_rotor_rows(loads))),
        *(
            Block(f"bearing {k + 1}{suffix}", columns, tuple(_bearing_rows(loads, k)))
            for k in range(2)
        ),
    ]


def _states_with_load_blocks(states: Mapping[str, LaunchResult]) -> list[str]:
    """Returns the names of the states that are shown in detail.

    These are all states of one case; of several cases, those of the largest gap and pressure.
    """
    if len(states) <= NEW_AND_WORN:
        return list(states)
    gap_state, pressure_state = state_of_largest_gap(states), state_of_largest_pressure(states)
    return [gap_state] if gap_state == pressure_state else [gap_state, pressure_state]


def _vibration_lines(scene: Scene, states: Mapping[str, LaunchResult]) -> list[str]:
    """Returns lines on the rotor, its accelerations and, for random vibration, their computation.

    If only new bearings were computed, a line says so.
    """
    arrangement, launch = scene.arrangement, scene.launch or Launch()
    assert arrangement is not None
    phrases = [f"at rest, rotor mass {arrangement.rotor_mass_kg:g} kg"]
    if arrangement.rotor_offset_mm:
        phrases.append(f"centre of mass {arrangement.rotor_offset_mm:g} mm from the midpoint")
    axial_g = [state.axial_g for state in states.values()]
    radial_g = [state.radial_g for state in states.values()]
    if any(axial_g):
        phrases.append(f"{span(axial_g)} g axial")
    if any(radial_g):
        phrases.append(f"{span(radial_g)} g radial")
    lines = [", ".join(phrases)]
    if len(states) == len(scene.in_cases):  # no case has a worn state besides the new one
        lines.append(_NEW_ONLY)
    if launch.axial_density_g2_Hz is not None or launch.radial_density_g2_Hz is not None:
        frequencies = _natural_frequencies(states.values())
        axial_Hz = span(float(axial) for axial, _, _ in frequencies)
        radial_Hz = span(float(radial) for _, radial, _ in frequencies)
        largest = "three sigma"
        if launch.duration_s > 0.0:
            largest = f"the largest expected in {launch.duration_s:g} s, at least three sigma"
        lines.append(
            f"accelerations from Miles' equation ({largest}; Q = {launch.amplification:g}) at "
            f"{axial_Hz} Hz axial, {radial_Hz} Hz radial"
        )
    return lines


def _natural_frequencies(states: Iterable[LaunchResult]) -> list[np.ndarray]:
    """Returns the axial, radial and conical natural frequency of each state (3,) [Hz].

    The list is empty if the scene does not contain the distance of the bearings.
    """
    return [state.frequencies for state in states if state.frequencies is not None]


def _acceleration_limit_rows(states: Collection[LaunchResult]) -> tuple[Row, ...]:
    """Returns rows of the accelerations at which gapping and denting start, and of frequencies.

    Each has a value for each state. Frequencies that are not known have no rows.
    """
    rows = [
        Row("gapping starts at", "g", tuple(state.opening_g for state in states), "opening_g"),
        Row("denting starts at", "g", tuple(state.denting_g for state in states), "denting_g"),
    ]
    if frequencies := _natural_frequencies(states):
        for k, mode in enumerate(("axial", "radial", "conical")):
            values = tuple(float(state[k]) for state in frequencies)
            label = f"{mode} natural frequency at rest"
            rows.append(Row(label, "Hz", values, f"{mode}_frequency"))
    return tuple(rows)


def _random_rows(states: Sequence[LaunchResult]) -> tuple[Row, ...]:
    """Returns rows of the largest accelerations expected, their ratios to rms, and three sigma.

    There are three rows for each direction, and each has a value for each state.
    """
    rows = []
    for direction in states[0].random:
        responses = [state.random[direction] for state in states]
        largest_g = tuple(response.largest_g for response in responses)
        over_rms = tuple(response.expected for response in responses)
        three_sigma_g = tuple(response.three_sigma_g for response in responses)
        rows += [
            Row(f"{direction}, largest expected", "g", largest_g, f"{direction}_largest_g"),
            Row("over the rms", "", over_rms, f"{direction}_expected_peak"),
            Row("three sigma", "g", three_sigma_g, f"{direction}_three_sigma_g"),
        ]
    return tuple(rows)


def _rotor_rows(loads: Sequence[LaunchLoad]) -> list[Row]:
    """Returns rows of forces and shifts of the rotor, with a value for each load.

    A shift is NaN where the spring does not support the rotor. Rows of the spring are left out if
    all their values are 0.
    """
    rows = [
        Row("axial force", "N", tuple(load.axial for load in loads), "axial_force"),
        Row("radial force", "N", tuple(load.radial for load in loads), "radial_force"),
    ]
    for label, unit, name, value_of in (
        ("axial shift", "um", "shift", lambda rotor: _UM * rotor.shift),
        ("radial shift", "um", "across", lambda rotor: _UM * rotor.across),
        ("tilt", "mrad", "tilt", lambda rotor: _MRAD * rotor.tilt),
        ("spring extension", "um", "slide", lambda rotor: _UM * rotor.slide),
        ("force on the stop", "N", "on_stop", lambda rotor: rotor.on_stop),
    ):
        values = tuple(
            math.nan if load.rotor is None else _without_rounding(value_of(load.rotor))
            for load in loads
        )
        if name not in ("slide", "on_stop") or any(values):
            rows.append(Row(label, unit, values, name))
    return rows


def _bearing_rows(loads: Sequence[LaunchLoad], k: int) -> list[Row]:
    """Returns rows of loads, pressures and gap of bearing k (0 or 1) under each load.

    They are NaN where the spring does not support the rotor.
    """
    rows = []
    for label, unit, name, value_of in _BEARING_ROWS:
        values = tuple(
            math.nan if load.rotor is None else _without_rounding(value_of(load.rotor.bearings[k]))
            for load in loads
        )
        rows.append(Row(label, unit, values, name))
    return rows


def _without_rounding(value: float) -> float:
    """Returns a value, or 0 if its magnitude is below `_ROUNDING`.

    Forces that cancel in a circle of balls leave as much.
    """
    return 0.0 if abs(value) < _ROUNDING else value
