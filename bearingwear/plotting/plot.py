"""Draws a result file with the figure of its kind."""

from collections.abc import Iterable
from pathlib import Path

import xarray as xr

from bearingwear.plotting.drawing import Figure, save
from bearingwear.results.kinds import Registry, function, kind_of
from bearingwear.results.netcdf import CaseFileError, load


def figure_of(dataset: xr.Dataset, name: str | Path, figures: Registry) -> Figure:
    """The figure of a dataset as files have it.

    Parameters
    ----------
    dataset : Dataset
    name : path
        What the error calls it.
    figures : Registry
        For each kind that can be drawn, a function that takes the dataset and returns a figure.

    Raises
    ------
    CaseFileError
        A kind that cannot be drawn.
    """
    kind = kind_of(dataset)
    if kind not in figures:
        known = ", ".join(figures) or "none"
        raise CaseFileError(f"{name}: given a file of the kind {kind}; allowed {known}")
    figure: Figure = function(figures[kind])(dataset)
    return figure


def plot(path: str | Path, outputs: Iterable[str | Path], figures: Registry) -> None:
    """Draw a result file into files whose suffixes name their formats.

    Raises
    ------
    CaseFileError, OutputError
    """
    save(figure_of(load(path), path, figures), outputs)
