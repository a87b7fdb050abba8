"""Solves many lines of a grid into one file."""

from collections.abc import Sequence
from pathlib import Path

import xarray as xr

from bearingwear.results.netcdf import dataset
from bearingwear.studies.grid.gather import chunk
from bearingwear.studies.grid.grid import Line
from bearingwear.studies.grid.solve import cases_of, solved_cases


def solved_chunk(scene: Path, lines: Sequence[Line], losses_um: Sequence[float]) -> xr.Dataset:
    """Step: the cases of several lines, along the dimension `case`.

    Profiles over the contact are left out, as from the study gathered from it.
    """
    cases = cases_of([(method, friction) for method, friction in lines], losses_um)
    return chunk(cases, map(dataset, solved_cases(scene, cases)))
