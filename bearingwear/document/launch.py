"""The sheet of a launch: what each load does to both bearings, and how far gap and dent are."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence

from bearingwear.document.bearing_line import operation_lines
from bearingwear.document.document import Block, Document, Row
from bearingwear.results.units import digits
from bearingwear.scene.requirements import Launch
from bearingwear.scene.scene import Scene
from bearingwear.solvers.bearing.launch import Launched, LaunchLoad, RestingBearing

_UM, _MM, _GPA = 1e6, 1e3, 1e-9
_ROUNDING = 1e-9

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


def launch_document(scene: Scene, found: Launched) -> Document:
    """Report on the bearings of a scene at launch."""
    columns = tuple(load.name for load in found.loads)
    blocks = [Block("axial acceleration limits", (), _limits(found))]
    if found.loads:
        blocks += [Block("rotor", columns, tuple(_rotor_rows(found.loads)))]
        blocks += [
            Block(f"bearing {k + 1}", columns, tuple(_bearing_rows(found.loads, k)))
            for k in range(2)
        ]
    said = launch_verdict(found)
    facts = {"kind": "launch", "scene": scene.name, "verdict": said}
    heading = (operation_lines(json.loads(scene.json))[0], *_asked(scene, found))
    return Document((*heading, *said), facts, tuple(blocks))


def launch_verdict(found: Launched) -> list[str]:
    """Whether it gaps and whether it dents, in sentences."""
    said = [
        f"{load.name}: the spring does not support the rotor; increase the spring force, or add a "
        f"stop (arrangement.stop_um)"
        for load in found.loads
        if load.rotor is None
    ]
    opened = [
        (bearing.gap, k + 1, load.name)
        for load in found.loads
        if load.rotor is not None
        for k, bearing in enumerate(load.rotor.bearings)
        if not bearing.load.any()
    ]
    if opened:
        gap, k, name = max(opened)
        said.append(f"bearing {k} gaps by {digits(_UM * gap)} um, {name}")
    elif found.loads and not said:
        said.append("no gap: every bearing remains loaded")
    if found.loads:
        share = 100.0 * found.pressure_share
        verb = "dents" if share > 100.0 else "no dents"
        said.append(
            f"{verb}: the peak pressure is {digits(share)} % of "
            f"{digits(_GPA * found.pressure)} GPa, {found.source}"
        )
    return said


def _asked(scene: Scene, found: Launched) -> list[str]:
    a, asked = scene.arrangement, scene.launch or Launch()
    assert a is not None
    parts = [f"at rest, rotor mass {a.rotor_mass_kg:g} kg"]
    parts += (
        [f"centre of mass {a.rotor_offset_mm:g} mm from the midpoint"] if a.rotor_offset_mm else []
    )
    for way, g in (("axial", found.axial_g), ("radial", found.radial_g)):
        parts += [f"{digits(g)} g {way}"] if g else []
    lines = [", ".join(parts)]
    if found.frequencies is not None and (
        asked.axial_density_g2_Hz is not None or asked.radial_density_g2_Hz is not None
    ):
        axial, radial, _ = found.frequencies
        lines.append(
            f"accelerations from Miles' equation (three sigma, Q = {asked.amplification:g}) at "
            f"{digits(axial)} Hz axial, {digits(radial)} Hz radial"
        )
    return lines


def _limits(found: Launched) -> tuple[Row, ...]:
    rows = [
        Row("gapping starts at", "g", (found.opening_g,), "opening_g"),
        Row("denting starts at", "g", (found.denting_g,), "denting_g"),
    ]
    if found.frequencies is not None:
        names = ("axial", "radial", "conical")
        rows += [
            Row(f"{name} natural frequency at rest", "Hz", (float(f),), f"{name}_frequency")
            for name, f in zip(names, found.frequencies, strict=True)
        ]
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
