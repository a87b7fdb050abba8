"""Steps of the design study that draw figures: the files are read, and must belong together."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import xarray as xr

from bearingwear.plotting.drawing import Figure
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.studies.design.figures import choice, map_figure, uncertainty_figure


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

    Raises
    ------
    CaseFileError
        One line: a file of another kind, or not of the scene or the preload methods of the map.
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


def draw_design(design: Path, recommendation: Path, uncertainty: Path | None = None) -> Figure:
    """Which preload to take."""
    files = design_files(design, recommendation, uncertainty)
    return choice.design_figure(files.design, files.recommendation, files.uncertainty)


def draw_map(design: Path) -> Figure:
    """Life, stiffness and slip around the preload."""
    found = load(design)
    if found.attrs.get("kind") != "design map":
        raise CaseFileError(f"{design}: not a file of the kind design map")
    return map_figure.map_overview(found)


def draw_uncertainty(design: Path, recommendation: Path, uncertainty: Path) -> Figure:
    """The spread of its life."""
    files = design_files(design, recommendation, uncertainty)
    assert files.uncertainty is not None
    return uncertainty_figure.uncertainty_figure(files.uncertainty)
