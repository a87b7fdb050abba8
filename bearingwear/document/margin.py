"""The sheet of a torque margin: the worst corner, and every other one."""

from __future__ import annotations

import math
from collections.abc import Sequence

from bearingwear.document.document import Block, Document, Row
from bearingwear.lives.margin import Corner
from bearingwear.results.units import digits, display
from bearingwear.scene.cases import NOMINAL
from bearingwear.scene.new.minimum_preload import minimum_preload_line
from bearingwear.scene.requirements import STANDARDS
from bearingwear.scene.scene import Scene


def margin_document(scene: Scene, corners: Sequence[Corner]) -> Document:
    """Torque margin of a scene with a drive."""
    worst = worst_corner(corners)
    data = scene.to_dict()
    minimum = minimum_preload_line(data["bearing"], data["operation"])
    heading = (
        f"{scene.name}: torque margin at a preload of {scene.operation.preload_N:g} N",
        *filter(None, [minimum]),
        *margin_sentences(scene, corners),
    )
    facts = {"kind": "torque margin", "scene": scene.name, "worst": corner_words(worst)}
    return Document(heading, facts, (margin_block(scene, corners),))


def worst_corner(corners: Sequence[Corner]) -> Corner:
    """The corner of the least margin; one that was not computed only where none was."""
    return min(corners, key=lambda one: math.inf if is_missing(one) else one.margin)


def is_missing(corner: Corner) -> bool:
    """Whether a corner was not computed."""
    return math.isnan(corner.torque)


def corner_words(corner: Corner) -> str:
    """A corner in words."""
    name = "friction" if corner.key.endswith("ball_race") else "shear strength"
    return f"{corner.case}, {corner.wear}, {name} {digits(corner.friction)}"


def margin_sentences(scene: Scene, corners: Sequence[Corner]) -> list[str]:
    """The margin and its worst corner, the rule, and what the corners leave out."""
    drive, worst = scene.drive, worst_corner(corners)
    assert drive is not None
    words, missing = corner_words(worst), [one for one in corners if is_missing(one)]
    if is_missing(worst):
        said = f"torque margin unknown: no corner was computed ({worst.why})"
    elif worst.stalls:
        said = f"the drive stalls: the resisting torque exceeds the drive torque ({words})"
    else:
        kept = "sufficient" if worst.margin >= 0.0 else "INSUFFICIENT"
        percent = f"{digits(100.0 * worst.margin)} %"
        said = f"torque margin {percent}, {kept}; worst corner: {words}"
        if missing and worst.margin >= 0.0:
            said = f"torque margin unknown; it is at most {percent} ({words})"
    factors = f"{drive.rule[drive.bearings]:g} on the bearing torque (class {drive.bearings})"
    others = ", ".join(
        f"{drive.rule[name]:g} on {T:g} N m {name}" for name, T in drive.resistances_Nm.items()
    )
    rule = f"standard: {STANDARDS[drive.standard]}; data from {drive.data}; factors: {factors}"
    found = [said, f"{rule}{', ' if others else ''}{others}"]
    if missing:
        whys = "; ".join(dict.fromkeys(one.why for one in missing))
        found.insert(1, f"{len(missing)} of {len(corners)} corners were not computed: {whys}")
    if not any(one.wear != "new" for one in corners):
        found.append("new bearings only: no end-of-life criterion was given")
    if not any(one.case != NOMINAL for one in corners):
        found.append("the scene contains no cases, so cold and hot operation were not checked")
    return found


def _note(corner: Corner, worst: Corner) -> str:
    if is_missing(corner):
        return f"not computed ({corner.why})"
    return "stalls" if corner.stalls else "worst" if corner is worst else ""


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
            note=_note(one, worst),
        )
        for one, needed in zip(corners, required, strict=True)
    )
    columns = (f"torque, {unit.unit}", f"required, {unit.unit}", "margin, %")
    line = f"drive: {digits(float(unit.of(drive.torque_Nm)))} {unit.unit}"
    return Block("torque margin", columns, rows, (line,))
