"""Figures of the design study from its files, which must belong together."""

from __future__ import annotations

from pathlib import Path

from bearingwear.plotting.drawing import Figure, with_data_files
from bearingwear.results.netcdf import load_kind
from bearingwear.studies.design.choice import design_files
from bearingwear.studies.design.figures import choice, map_figure, uncertainty_figure


def draw_design(design: Path, recommendation: Path, uncertainty: Path | None = None) -> Figure:
    """Draws which preload to take."""
    files = [path for path in (design, recommendation, uncertainty) if path]
    figure = choice.design_figure(*design_files(design, recommendation, uncertainty))
    return with_data_files(figure, *files)


def draw_map(design: Path) -> Figure:
    """Step: draws life, stiffness and slip around the preload."""
    return with_data_files(map_figure.map_overview(load_kind(design, "design map")), design)


def draw_uncertainty(design: Path, recommendation: Path, uncertainty: Path) -> Figure:
    """Draws the spread of the life at the preload."""
    _, _, sampled = design_files(design, recommendation, uncertainty)
    assert sampled is not None
    return with_data_files(uncertainty_figure.uncertainty_figure(sampled), uncertainty)
