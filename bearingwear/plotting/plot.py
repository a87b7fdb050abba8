"""Draws a result file with the figure of its kind."""

from collections.abc import Iterable
from pathlib import Path

import xarray as xr

from bearingwear.plotting.drawing import Figure, save
from bearingwear.results.kinds import Registry, imported_function, kind_of
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.words import dataset_of_bearing


def figure_of(
    dataset: xr.Dataset, name: str | Path, figures: Registry, bearing: str | None = None
) -> Figure:
    """Returns the figure of a result, which the function of its kind draws.

    CaseFileError: a kind that is not drawn, or two different bearings without a choice.

    dataset: with codes, as in files.
    name: of the file, for messages.
    figures: by kind, the dotted name of a function that takes the dataset and returns a figure.
    bearing: `first` or `second`, if the bearings of a pair differ.
    """
    kind = kind_of(dataset)
    dataset = dataset_of_bearing(dataset, name, bearing)
    if kind not in figures:
        allowed = ", ".join(figures) or "none"
        raise CaseFileError(f"{name}: got a file of kind {kind}, expected {allowed}")
    figure: Figure = imported_function(figures[kind])(dataset)
    return figure


def plot(
    path: str | Path,
    outputs: Iterable[str | Path],
    figures: Registry,
    bearing: str | None = None,
) -> None:
    """Draws a result file into files whose suffixes determine their formats.

    CaseFileError: the file cannot be read, or `figure_of` raises it. OutputError: an output cannot
    be written, or its suffix has no format.

    figures, bearing: as in `figure_of`.
    """
    save(figure_of(load(path), path, figures, bearing), outputs)
