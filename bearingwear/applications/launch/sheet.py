"""The sheet of a launch: what each load does to both bearings, and how far gap and dent are."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence

from bearingwear.document.bearing_line import operation_lines
from bearingwear.document.document import Block, Document, Row
from bearingwear.document.launch import denting_share, launch_gap, launch_verdict, worst_state
from bearingwear.results.units import span
from bearingwear.scene.new.minimum_preload import minimum_preload_line
from bearingwear.scene.requirements import Launch
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.launch import Launched, LaunchLoad, RestingBearing

_UM, _MM, _GPA = 1e6, 1e3, 1e-9
_ROUNDING = 1e-9
_SHOWN = 2  # states of one case: new and worn
_NEW_ONLY = "new bearings only: without an end of life that can be computed, wear is not known"

SOFT_PAIR_GAPS = (
    "a spring-loaded pair that gaps strikes back: its loads may be 2 to 4 times those of three "
    "sigma, as measured (docs/launch.md)"
)

_OF_BEARING: tuple[tuple[str, str, str, Callable[[RestingBearing], float]], ...] = (
    ("axial load", "N", "axial_load", lambda one: one.axial),
    ("radial load", "N", "radial_load", lambda one: one.radial),
    ("maximum ball load", "N", "largest_ball_load", lambda one: float(one.load.max())),
    ("minimum ball load", "N", "least_ball_load", lambda one: float(one.load.min())),
    ("unloaded balls", "", "loose_balls", lambda one: int((one.load == 0.0).sum())),
    ("peak pressure, inner", "GPa", "pressure_inner", lambda one: _GPA * one.pressure[:, 0].max()),
    ("peak pressure, outer", "GPa", "pressure_outer", lambda one: _GPA * one.pressure[:, 1].max()),
    ("gap", "um", "gap", lambda one: _UM * one.gap),
)


def launch_document(scene: Scene, found: Mapping[str, Launched]) -> Document:
    """Report on the bearings of a scene at launch.

    found: as of `lives.margin.launched_by_wear`.
    """
    states = list(found.values())
    blocks = [Block("axial acceleration limits", tuple(found), _limits(states))]
    if states[0].random:
        title = f"random vibration over {(scene.launch or Launch()).duration_s:g} s"
        blocks.append(Block(title, tuple(found), _random_rows(states)))
    for words in _told(found):
        loads, state = found[words].loads, f", {words}" if len(found) > 1 else ""
        if loads:
            columns = tuple(load.name for load in loads)
            blocks += [Block(f"rotor{state}", columns, tuple(_rotor_rows(loads)))]
            blocks += [
                Block(f"bearing {k + 1}{state}", columns, tuple(_bearing_rows(loads, k)))
                for k in range(2)
            ]
    said = launch_verdict(found) + _soft_pair_lines(scene, found)
    facts = {"kind": "launch", "scene": scene.name, "verdict": said}
    data = json.loads(scene.json)
    minimum = minimum_preload_line(data["bearing"], data["operation"])
    heading = (operation_lines(data)[0], *_asked(scene, found), *filter(None, [minimum]), *said)
    return Document(heading, facts, tuple(blocks))


def _told(found: Mapping[str, Launched]) -> list[str]:
    """States that are shown at each load: new and worn; of several cases those that decide."""
    if len(found) <= _SHOWN:
        return list(found)
    return list(dict.fromkeys([worst_state(found, launch_gap), worst_state(found, denting_share)]))


def _soft_pair_lines(scene: Scene, found: Mapping[str, Launched]) -> list[str]:
    """That a pair on a spring that gaps sees higher loads than any computed at rest."""
    gaps = scene.operation.preload_method == "constant_force" and launch_gap(
        found[worst_state(found, launch_gap)]
    )
    return [SOFT_PAIR_GAPS] if gaps else []


def _asked(scene: Scene, found: Mapping[str, Launched]) -> list[str]:
    a, asked = scene.arrangement, scene.launch or Launch()
    assert a is not None
    parts = [f"at rest, rotor mass {a.rotor_mass_kg:g} kg"]
    parts += (
        [f"centre of mass {a.rotor_offset_mm:g} mm from the midpoint"] if a.rotor_offset_mm else []
    )
    states = list(found.values())
    for way, values in (
        ("axial", [one.axial_g for one in states]),
        ("radial", [one.radial_g for one in states]),
    ):
        parts += [f"{span(values)} g {way}"] if any(values) else []
    lines = [", ".join(parts)]
    lines += [_NEW_ONLY] if len(found) == len(scene.in_cases) else []
    if asked.axial_density_g2_Hz is not None or asked.radial_density_g2_Hz is not None:
        axial, radial = (
            span(float(one.frequencies[k]) for one in states if one.frequencies is not None)
            for k in range(2)
        )
        largest = "three sigma"
        if asked.duration_s > 0.0:
            largest = f"the largest expected in {asked.duration_s:g} s, at least three sigma"
        lines.append(
            f"accelerations from Miles' equation ({largest}; Q = {asked.amplification:g}) at "
            f"{axial} Hz axial, {radial} Hz radial"
        )
    return lines


def _limits(found: Sequence[Launched]) -> tuple[Row, ...]:
    rows = [
        Row("gapping starts at", "g", tuple(one.opening_g for one in found), "opening_g"),
        Row("denting starts at", "g", tuple(one.denting_g for one in found), "denting_g"),
    ]
    known = [one.frequencies for one in found if one.frequencies is not None]
    if known:
        rows += [
            Row(f"{name} natural frequency at rest", "Hz", tuple(map(float, frequencies)),
                f"{name}_frequency")
            for name, frequencies in zip(
                ("axial", "radial", "conical"), zip(*known, strict=True), strict=True
            )
        ]  # fmt: skip
    return tuple(rows)


def _random_rows(states: Sequence[Launched]) -> tuple[Row, ...]:
    """Largest accelerations expected, beside three sigma."""
    rows = []
    for way in states[0].random:
        responses = [one.random[way] for one in states]
        for label, unit, name, values in (
            (f"{way}, largest expected", "g", "largest_g", [one.largest_g for one in responses]),
            ("over the rms", "", "expected_peak", [one.expected for one in responses]),
            ("three sigma", "g", "three_sigma_g", [one.three_sigma_g for one in responses]),
        ):
            rows.append(Row(label, unit, tuple(values), f"{way}_{name}"))
    return tuple(rows)


def _rotor_rows(loads: Sequence[LaunchLoad]) -> list[Row]:
    held = [load.rotor for load in loads]
    rows = [
        Row("axial force", "N", tuple(load.axial for load in loads), "axial_force"),
        Row("radial force", "N", tuple(load.radial for load in loads), "radial_force"),
    ]
    for label, unit, name, value_of in (
        ("axial shift", "um", "shift", lambda one: _UM * one.shift),
        ("radial shift", "um", "across", lambda one: _UM * one.across),
        ("tilt", "mrad", "tilt", lambda one: _MM * one.tilt),
        ("spring extension", "um", "slide", lambda one: _UM * one.slide),
        ("force on the stop", "N", "on_stop", lambda one: one.on_stop),
    ):
        values = tuple(math.nan if one is None else _unrounded(value_of(one)) for one in held)
        if name not in ("slide", "on_stop") or any(values):
            rows.append(Row(label, unit, values, name))
    return rows


def _bearing_rows(loads: Sequence[LaunchLoad], k: int) -> list[Row]:
    return [
        Row(
            label,
            unit,
            tuple(
                math.nan if one.rotor is None else _unrounded(value_of(one.rotor.bearings[k]))
                for one in loads
            ),
            name,
        )
        for label, unit, name, value_of in _OF_BEARING
    ]


def _unrounded(value: float) -> float:
    """A value, and nothing in place of the rounding of what balls in a circle cancel."""
    return 0.0 if abs(value) < _ROUNDING else value
