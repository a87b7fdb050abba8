"""Files of the design study that belong together, and the line of a map that a scene is on."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.words import scene_of


@dataclass(frozen=True, kw_only=True)
class DesignFiles:
    """Design map, recommendation and, if its lives were sampled, uncertainty of one scene."""

    design: xr.Dataset
    recommendation: xr.Dataset
    uncertainty: xr.Dataset | None = None


def design_files(
    design: Path, recommendation: Path, uncertainty: Path | None = None
) -> DesignFiles:
    """Read the files of one scene.

    CaseFileError: a file of another kind, or not of the scene or the preload methods of the
    map.
    """
    kinds = {design: "design map", recommendation: "recommendation"}
    if uncertainty is not None:
        kinds[uncertainty] = "uncertainty"
    found = {path: load(path) for path in kinds}
    for path, kind in kinds.items():
        if found[path].attrs.get("kind") != kind:
            raise CaseFileError(f"{path}: not a file of the kind {kind}")
        if found[path].attrs["scene"] != found[design].attrs["scene"]:
            raise CaseFileError(f"{path}: not of the scene of {design}")
        if not found[path]["preload_method"].equals(found[design]["preload_method"]):
            raise CaseFileError(f"{path}: not of the preload methods of {design}")
    return DesignFiles(
        design=found[design],
        recommendation=found[recommendation],
        uncertainty=None if uncertainty is None else found[uncertainty],
    )


def at_scene(design: xr.Dataset) -> xr.Dataset:
    """The line of a map at the scene's own friction and speed."""
    scene = scene_of(design)
    return design.sel(
        friction=scene["friction"]["ball_race"], shaft_speed=scene["operation"]["shaft_speed_rpm"]
    )
