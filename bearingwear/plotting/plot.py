"""Draws a result file with the figure of its kind."""

from collections.abc import Iterable
from pathlib import Path

from bearingwear.plotting.drawing import Figure, save
from bearingwear.results.kinds import Registry, function, kind_of
from bearingwear.results.netcdf import CaseFileError, load


def figure_of(path: str | Path, figures: Registry) -> Figure:
    """The figure of a result file.

    Parameters
    ----------
    path : path
    figures : Registry
        For each kind that can be drawn, a function that takes the dataset and returns a figure.

    Raises
    ------
    CaseFileError
        A file that cannot be read, or of a kind that cannot be drawn.
    """
    dataset = load(path)
    kind = kind_of(dataset)
    if kind not in figures:
        drawn = ", ".join(figures) or "none"
        raise CaseFileError(f"{path}: given a file of the kind {kind}; allowed {drawn}")
    figure: Figure = function(figures[kind])(dataset)
    return figure


def plot(path: str | Path, outputs: Iterable[str | Path], figures: Registry) -> None:
    """Draw a result file into files whose suffixes name their formats.

    Raises
    ------
    CaseFileError, OutputError
    """
    save(figure_of(path, figures), outputs)
