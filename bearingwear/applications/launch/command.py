"""`bearingwear launch`, and the same in Python."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from bearingwear.console import SUCCESS
from bearingwear.options import given_scene
from bearingwear.printing import print_sheet

if TYPE_CHECKING:
    import xarray as xr

    from bearingwear.scene.read import Source


def launch_command(args: argparse.Namespace) -> int:
    """Prints the sheet of the bearings of a rotor at launch, and returns SUCCESS.

    It does so even if they gap or dent. SceneError: the scene lacks what a launch requires.
    """
    from bearingwear.applications.launch.sheet import launch_document
    from bearingwear.lives.margin import launched_by_wear
    from bearingwear.solvers.bearing.launch import check_launch

    accelerations = {"axial": args.axial, "radial": args.radial}
    args.set += [
        f"launch.{direction}_g={g:g}" for direction, g in accelerations.items() if g is not None
    ]
    scene = given_scene(args)
    check_launch(scene, args.scene)
    print_sheet(launch_document(scene, launched_by_wear(scene)), args)
    return SUCCESS


def launch(scene: Source, axial: float | None = None, radial: float | None = None) -> xr.Dataset:
    """Computes gaps and pressures of the bearings of a rotor at launch, like `bearingwear launch`.

    Parameters
    ----------
    scene : path, dict or Scene
        A scene with `arrangement.rotor_mass_kg`.
    axial, radial : float, optional
        Accelerations [g], in place of `launch.axial_g` and `launch.radial_g` of the scene.

    Returns
    -------
    xarray.Dataset
        By `state` of wear (in each case, if there are several): the accelerations at which a
        bearing gaps and dents; by `load`, the displacement of the rotor; by `bearing`, its load,
        its gap and its peak pressures. They are NaN where no force supports the rotor.

    Raises
    ------
    SceneError
        A ValueError with a one-line message.
    """
    from bearingwear.applications.launch.dataset import launch_dataset
    from bearingwear.lives.margin import launched_by_wear
    from bearingwear.scene.read import as_scene
    from bearingwear.solvers.bearing.launch import check_launch

    accelerations = {"launch.axial_g": axial, "launch.radial_g": radial}
    changes = {key: value for key, value in accelerations.items() if value is not None}
    changed_scene = as_scene(scene).with_(changes)
    check_launch(changed_scene, changed_scene.name)
    return launch_dataset(changed_scene, launched_by_wear(changed_scene))
