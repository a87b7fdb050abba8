"""Sentences and a table of the torque margin in every corner, the worst of which decides.

A corner is a combination of case, wear and friction.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from bearingwear.document.document import Block, Row
from bearingwear.lives.margin import Corner
from bearingwear.results.units import digits, display
from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.requirements import STANDARDS, Drive
from bearingwear.scene.scene import Scene


def worst_corner(corners: Sequence[Corner]) -> Corner:
    """Returns the corner with the smallest margin among those computed; the first if none was.

    corners: at least one.
    """
    return min(corners, key=lambda corner: math.inf if is_missing(corner) else corner.margin)


def is_missing(corner: Corner) -> bool:
    """Returns whether a corner was not computed."""
    return math.isnan(corner.torque)


def corner_words(corner: Corner) -> str:
    """Names a corner: its case, its wear, and its friction or shear strength."""
    name = "friction" if corner.key.endswith("ball_race") else "shear strength"
    return f"{corner.case}, {corner.wear}, {name} {digits(corner.friction)}"


def margin_sentences(scene: Scene, corners: Sequence[Corner]) -> list[str]:
    """States the margin, its worst corner and its standard, and what the corners do not cover.

    scene: it has the block `drive`.
    corners: at least one, computed or not.
    """
    assert scene.drive is not None
    missing = [corner for corner in corners if is_missing(corner)]
    sentences = [_verdict_sentence(worst_corner(corners), is_complete=not missing)]
    if missing:
        reasons = "; ".join(dict.fromkeys(corner.why for corner in missing))
        sentences.append(f"{len(missing)} of {len(corners)} corners were not computed: {reasons}")
    sentences.append(_standard_sentence(scene.drive))
    if all(corner.wear == "new" for corner in corners):
        sentences.append("new bearings only: no end-of-life criterion was given")
    if all(corner.case == NOMINAL for corner in corners):
        sentences.append("the scene contains no cases, so cold and hot operation were not checked")
    return sentences


def _verdict_sentence(worst: Corner, is_complete: bool) -> str:
    """States the margin in the worst corner, or its bound if not all corners were computed."""
    if is_missing(worst):
        return f"torque margin unknown: no corner was computed ({worst.why})"
    words, percent = corner_words(worst), f"{digits(100.0 * worst.margin)} %"
    if worst.stalls:
        return f"the drive stalls: the resisting torque exceeds the drive torque ({words})"
    if worst.margin < 0.0:
        return f"torque margin {percent}, INSUFFICIENT; worst corner: {words}"
    if not is_complete:
        return f"torque margin unknown; it is at most {percent} ({words})"
    return f"torque margin {percent}, sufficient; worst corner: {words}"


def _standard_sentence(drive: Drive) -> str:
    """States the standard, the source of the torques, and the factors on the torques."""
    factors = [
        f"{drive.rule[drive.bearings]:g} on the bearing torque (class {drive.bearings})",
        *(
            f"{drive.rule[name]:g} on {torque_Nm:g} N m {name}"
            for name, torque_Nm in drive.resistances_Nm.items()
        ),
    ]
    return (
        f"standard: {STANDARDS[drive.standard]}; data from {drive.data}; "
        f"factors: {', '.join(factors)}"
    )


def _corner_note(corner: Corner, worst: Corner) -> str:
    """States that a corner was not computed, that the drive stalls, or that it is the worst.

    Empty for any other corner.
    """
    if is_missing(corner):
        return f"not computed ({corner.why})"
    if corner.stalls:
        return "stalls"
    return "worst" if corner is worst else ""


def margin_block(scene: Scene, corners: Sequence[Corner]) -> Block:
    """Returns a table of torque, required torque and margin in every corner.

    The torques have one unit, and margins are in percent.

    scene: it has the block `drive`.
    corners: at least one; one that was not computed has NaN.
    """
    drive, worst = scene.drive, worst_corner(corners)
    assert drive is not None
    required = [drive.required_torque(corner.torque) for corner in corners]
    unit = display("N m", [*(corner.torque for corner in corners), *required])
    rows = tuple(
        Row(
            corner_words(corner),
            "",
            (float(unit.of(corner.torque)), float(unit.of(limit)), 100.0 * corner.margin),
            note=_corner_note(corner, worst),
        )
        for corner, limit in zip(corners, required, strict=True)
    )
    columns = (f"torque, {unit.unit}", f"required, {unit.unit}", "margin, %")
    line = f"drive: {digits(float(unit.of(drive.torque_Nm)))} {unit.unit}"
    return Block("torque margin", columns, rows, (line,))
