"""The torque margin in every corner, as a dataset."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr

from bearingwear import Scene
from bearingwear.applications.margin.sheet import margin_document
from bearingwear.lives.margin import Corner
from bearingwear.results.variable import Variable, table
from bearingwear.scene.requirements import STANDARDS
from bearingwear.studies.dataset import dataset_of_rows

CORNER = Variable("corner", ("corner",), "1", "index of the corner", "i8")

CORNERS = table(
    Variable("case", (), "", "case of the scene", "O"),
    Variable("wear", (), "", "state of wear", "O"),
    Variable("friction", (), "", "friction coefficient, or shear strength of the film [MPa]"),
    Variable("torque", (), "N m", "torque of all bearings together"),
    Variable("required_torque", (), "N m", "torque that the standard requires of the drive"),
    Variable("torque_margin", (), "1", "torque of the drive over the required one, less one"),
    Variable("stalls", (), "", "whether the drive stalls", "i1", flags=("no", "yes")),
    Variable("problem", (), "", "why the torque was not computed", "O"),
)
"""Results of a corner: a case, a state of wear and a friction."""


def margin_dataset(scene: Scene, corners: Sequence[Corner]) -> xr.Dataset:
    """Returns the torque margins of a scene with a drive as a dataset along `corner`.

    Its attributes name the standard, the torque of the drive and the key of the friction.
    """
    drive = scene.drive
    assert drive is not None
    rows = [
        {
            "case": corner.case,
            "wear": corner.wear,
            "friction": corner.friction,
            "torque": corner.torque,
            "required_torque": drive.required_torque(corner.torque),
            "torque_margin": corner.margin,
            "stalls": int(corner.stalls),
            "problem": corner.why,
        }
        for corner in corners
    ]
    return dataset_of_rows(
        CORNERS,
        {CORNER: range(len(rows))},
        rows,
        title=f"Torque margin of {scene.name}",
        kind="torque margin",
        scene=scene,
        standard=STANDARDS[drive.standard],
        drive_torque=drive.torque_Nm,
        friction_key=corners[0].key,
        sheet=margin_document(scene, corners).stored,
    )
