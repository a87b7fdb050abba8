"""The package as a Python library."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from bearingwear.results.netcdf import dataset
from bearingwear.results.restart import restart_from
from bearingwear.scene.read import as_scene, for_life
from bearingwear.scene.scene import Scene

if TYPE_CHECKING:
    import xarray as xr


def solve(
    scene: str | os.PathLike[str] | Mapping[str, Any] | Scene,
    fidelity: str | None = None,
    restart: str | os.PathLike[str] | None = None,
    progress: Callable[[str], None] | None = None,
) -> xr.Dataset:
    """Solve one scene.

    Parameters
    ----------
    scene : path, dict or Scene
        A scene file, a dict of the same shape, or a `Scene`.
    fidelity : {"auto", "race_control", "steady", "dynamic"}, optional
        Overrides `model.fidelity` of the scene.
    restart : path, optional
        A dynamic case file to go on from the end of. Its scene may differ in `wear` and `model`
        only.
    progress : callable, optional
        Given one line of text every few seconds of a dynamic solve.

    Returns
    -------
    xarray.Dataset
        What a case file holds, and the attribute `wall_time_s`. Its `status` is 0 where the
        numbers may be used.

    Raises
    ------
    SceneError, NotAvailable
        Both are ValueErrors: the scene is wrong, or no model solves it.
    CaseFileError
        A ValueError, too: the file cannot be gone on from.
    """
    checked = as_scene(scene)
    from bearingwear.model.solve import solve as solved

    state = None if restart is None else restart_from(restart, checked)
    return dataset(solved(checked, fidelity, state, progress))


def life(
    scene: str | os.PathLike[str] | Mapping[str, Any] | Scene,
    fidelity: str | None = None,
    progress: Callable[[str], None] | None = None,
) -> xr.Dataset:
    """Wear life of one scene.

    Parameters
    ----------
    scene : path, dict or Scene
        With at least one criterion under `wear.end_of_life`.
    fidelity : {"auto", "race_control", "steady", "dynamic"}, optional
        Overrides `model.fidelity` of the scene.
    progress : callable, optional
        Given one line of text at each step of a life in time.

    Returns
    -------
    xarray.Dataset
        What a life file holds, and the attribute `wall_time_s`.

    Raises
    ------
    SceneError, NotAvailable
        Both are ValueErrors: the scene is wrong, or no model solves it.
    """
    checked = for_life(as_scene(scene))
    from bearingwear.model.life import life as lived

    return dataset(lived(checked, fidelity, progress))
