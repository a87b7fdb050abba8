"""The sheet of a torque margin: the worst corner, and every other one."""

from __future__ import annotations

import math
from collections.abc import Sequence

from bearingwear.document.document import Block, Document, Row
from bearingwear.lives.margin import Corner
from bearingwear.results.units import digits, display
from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.requirements import STANDARDS
from bearingwear.scene.scene import Scene


def margin_document(scene: Scene, corners: Sequence[Corner]) -> Document:
    """Torque margin of a scene with a drive."""
    worst = worst_corner(corners)
    heading = (
        f"{scene.name}: torque margin at a preload of {scene.operation.preload_N:g} N",
        *margin_sentences(scene, corners),
    )
    facts = {"kind": "torque margin", "scene": scene.name, "worst": corner_words(worst)}
    return Document(heading, facts, (margin_block(scene, corners),))


def worst_corner(corners: Sequence[Corner]) -> Corner:
    """The corner of the least margin; one that was not solved before all."""
    unsolved = [one for one in corners if math.isnan(one.torque)]
    return unsolved[0] if unsolved else min(corners, key=lambda one: one.margin)


def corner_words(corner: Corner) -> str:
    """A corner in words."""
    name = "friction" if corner.key.endswith("ball_race") else "shear strength"
    return f"{corner.case}, {corner.wear}, {name} {digits(corner.friction)}"


def margin_sentences(scene: Scene, corners: Sequence[Corner]) -> list[str]:
    """The margin and its worst corner, the rule, and what the corners leave out."""
    drive, worst = scene.drive, worst_corner(corners)
    assert drive is not None
    words = corner_words(worst)
    if math.isnan(worst.torque):
        said = f"torque margin unknown: no steady-state solution was found ({words})"
    elif worst.stalls:
        said = f"the drive stalls: the resisting torque exceeds the drive torque ({words})"
    else:
        kept = "sufficient" if worst.margin >= 0.0 else "INSUFFICIENT"
        said = f"torque margin {digits(100.0 * worst.margin)} %, {kept}; worst corner: {words}"
    factors = f"{drive.rule[drive.bearings]:g} on the bearing torque (class {drive.bearings})"
    others = ", ".join(
        f"{drive.rule[name]:g} on {T:g} N m {name}" for name, T in drive.resistances_Nm.items()
    )
    rule = f"standard: {STANDARDS[drive.standard]}; data from {drive.data}; factors: {factors}"
    found = [said, f"{rule}{', ' if others else ''}{others}"]
    if not any(one.wear != "new" for one in corners):
        found.append("new bearings only: no end-of-life criterion was given or met")
    if not any(one.case != NOMINAL for one in corners):
        found.append("the scene contains no cases, so cold and hot operation were not checked")
    return found


def margin_block(scene: Scene, corners: Sequence[Corner]) -> Block:
    """Torque, what the rule requires, and margin in every corner."""
    drive = scene.drive
    assert drive is not None
    required, worst = [drive.required(one.torque) for one in corners], worst_corner(corners)
    unit = display("N m", [*(one.torque for one in corners), *required])
    rows = tuple(
        Row(
            corner_words(one),
            "",
            (float(unit.of(one.torque)), float(unit.of(needed)), 100.0 * one.margin),
            note="stalls" if one.stalls else "worst" if one is worst else "",
        )
        for one, needed in zip(corners, required, strict=True)
    )
    columns = (f"torque, {unit.unit}", f"required, {unit.unit}", "margin, %")
    line = f"drive: {digits(float(unit.of(drive.torque_Nm)))} {unit.unit}"
    return Block("torque margin", columns, rows, (line,))
