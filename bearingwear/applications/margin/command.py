"""`bearingwear margin`, and the same in Python."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from bearingwear import SceneError
from bearingwear.console import INFEASIBLE, NOT_SOLVED, SUCCESS
from bearingwear.options import given_scene
from bearingwear.printing import print_sheet

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear import Scene
    from bearingwear.scene.read import Source


def margin_command(args: argparse.Namespace) -> int:
    """Prints the sheet of a torque margin, and returns an exit status.

    INFEASIBLE: the least margin is negative. NOT_SOLVED: it is not, but a corner has no torque.
    SUCCESS otherwise.
    """
    from bearingwear.applications.margin.sheet import margin_document
    from bearingwear.document.margin import is_missing, worst_corner
    from bearingwear.lives.margin import torque_corners

    changes = {"torque_Nm": args.drive, "standard": args.standard, "data": args.data}
    args.set += [f"drive.{key}={value}" for key, value in changes.items() if value is not None]
    scene = given_scene(args)
    _check_drive(scene, args.scene)
    corners = torque_corners(scene)
    print_sheet(margin_document(scene, corners), args)
    if worst_corner(corners).margin < 0.0:
        return INFEASIBLE
    return NOT_SOLVED if any(is_missing(corner) for corner in corners) else SUCCESS


def margin(
    scene: Source,
    drive: float | None = None,
    standard: str | None = None,
    data: str | None = None,
) -> xr.Dataset:
    """Computes the torque margin of a drive in every case, state of wear and friction.

    Like `bearingwear margin`.

    Parameters
    ----------
    scene : path, dict or Scene
    drive : float, optional
        Torque of the drive [N m], in place of `drive.torque_Nm` of the scene.
    standard : {"ecss", "nasa", "own"}, optional
        Standard of the margin, in place of `drive.standard`.
    data : {"analysis", "test", "extremes"}, optional
        Source of the torque data, in place of `drive.data`.

    Returns
    -------
    xarray.Dataset
        By `corner`: `case`, `wear`, `friction`, `torque`, `required_torque` and `torque_margin`.
        `problem` gives the reason where the torque is NaN.

    Raises
    ------
    SceneError, NotAvailable
        Both are ValueErrors with a one-line message.
    """
    from bearingwear.applications.margin.dataset import margin_dataset
    from bearingwear.lives.margin import torque_corners
    from bearingwear.results.labels import labelled
    from bearingwear.scene.read import as_scene

    drive_keys = {"drive.torque_Nm": drive, "drive.standard": standard, "drive.data": data}
    changes = {key: value for key, value in drive_keys.items() if value is not None}
    changed_scene = as_scene(scene).with_(changes)
    _check_drive(changed_scene, changed_scene.name)
    return labelled(margin_dataset(changed_scene, torque_corners(changed_scene)))


def _check_drive(scene: Scene, source: str) -> None:
    """Raises SceneError for a scene without a drive; the error names `source`."""
    if scene.drive is None:
        problem = "got nothing, expected a drive block, or the torque of the drive (--drive N_M)"
        raise SceneError("drive", problem, source=source)
