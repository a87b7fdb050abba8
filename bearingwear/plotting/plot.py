"""Draws a result file with the figure of its kind."""

from collections.abc import Iterable
from pathlib import Path

import xarray as xr

from bearingwear.plotting.drawing import Figure, save
from bearingwear.results.kinds import Registry, function, kind_of
from bearingwear.results.netcdf import CaseFileError, load
from bearingwear.results.pair_variables import BEARINGS, OF_BEARING


def figure_of(
    dataset: xr.Dataset, name: str | Path, figures: Registry, bearing: str | None = None
) -> Figure:
    """The figure of a dataset as files have it.

    name: what the error calls it.
    figures: for each kind that can be drawn, a function that takes the dataset and returns a
        figure.
    bearing {"first", "second"}: which bearing of a pair.

    CaseFileError: a kind that cannot be drawn.
    """
    kind = kind_of(dataset)
    is_pair = OF_BEARING in dataset.dims and not dataset["status"].dims
    if bearing is not None:
        if not is_pair or bearing not in BEARINGS:
            allowed = (
                " or ".join(BEARINGS) if is_pair else "no bearing, because the file contains one"
            )
            raise CaseFileError(f"{name}: got the bearing {bearing}, expected {allowed}")
        dataset = dataset.isel({OF_BEARING: BEARINGS.index(bearing)}, drop=True)
    elif is_pair:
        dataset = _one_of_both(dataset, name)
    if kind not in figures:
        known = ", ".join(figures) or "none"
        raise CaseFileError(f"{name}: got a file of the kind {kind}, expected {known}")
    figure: Figure = function(figures[kind])(dataset)
    return figure


def _one_of_both(dataset: xr.Dataset, name: str | Path) -> xr.Dataset:
    """What each of two bearings has, if they are alike."""
    first, second = (dataset.isel({OF_BEARING: k}, drop=True) for k in range(2))
    if not first.equals(second):
        raise CaseFileError(
            f"{name}: got a file of two different bearings, expected a choice of one: "
            "--bearing first or second; in Python plot(..., bearing='first')"
        )
    return first


def plot(
    path: str | Path,
    outputs: Iterable[str | Path],
    figures: Registry,
    bearing: str | None = None,
) -> None:
    """Draw a result file into files whose suffixes name their formats.

    May raise CaseFileError, OutputError.
    """
    save(figure_of(load(path), path, figures, bearing), outputs)
