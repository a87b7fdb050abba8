"""Steps of the design study that draw figures: the files are read, and must belong together."""

from __future__ import annotations

from pathlib import Path

from bearingwear.plotting.drawing import Figure
from bearingwear.results.netcdf import load_kind
from bearingwear.studies.design.choice import design_files
from bearingwear.studies.design.figures import choice, map_figure, uncertainty_figure


def draw_design(design: Path, recommendation: Path, uncertainty: Path | None = None) -> Figure:
    """Which preload to take."""
    return choice.design_figure(*design_files(design, recommendation, uncertainty))


def draw_map(design: Path) -> Figure:
    """Life, stiffness and slip around the preload."""
    return map_figure.map_overview(load_kind(design, "design map"))


def draw_uncertainty(design: Path, recommendation: Path, uncertainty: Path) -> Figure:
    """The spread of its life."""
    *_, sampled = design_files(design, recommendation, uncertainty)
    assert sampled is not None
    return uncertainty_figure.uncertainty_figure(sampled)
