"""Figures of the design study from its files, which must belong together."""

from __future__ import annotations

from pathlib import Path

from bearingwear.plotting.drawing import Figure, with_data_files
from bearingwear.results.netcdf import load_kind
from bearingwear.studies.design.choice import design_files
from bearingwear.studies.design.figures import choice, map_figure, uncertainty_figure


def draw_design(design: Path, recommendation: Path, uncertainty: Path | None = None) -> Figure:
    """Returns the figure of the recommended preload in a map, from files of one scene.

    CaseFileError as `design_files`.
    """
    files = [path for path in (design, recommendation, uncertainty) if path]
    figure = choice.design_figure(*design_files(design, recommendation, uncertainty))
    return with_data_files(figure, *files)


def draw_map(design: Path) -> Figure:
    """Step: returns the figure of lives and worst values over preload and friction in a map."""
    return with_data_files(map_figure.map_overview(load_kind(design, "design map")), design)


def draw_uncertainty(design: Path, recommendation: Path, uncertainty: Path) -> Figure:
    """Step: returns the figure of the spread of lives at the preloads of a study of uncertainty.

    design, recommendation: files of the same scene; else a CaseFileError is raised.
    """
    _, _, sampled = design_files(design, recommendation, uncertainty)
    assert sampled is not None
    return with_data_files(uncertainty_figure.uncertainty_figure(sampled), uncertainty)
