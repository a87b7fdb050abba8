"""Solves many lines of a grid into one file."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from bearingwear.studies.grid.grid import Case
from bearingwear.studies.solve import solved_variants

if TYPE_CHECKING:
    import xarray as xr


def solved_chunk(
    scene: Path, method: str, friction: Sequence[float], losses_um: Sequence[float]
) -> xr.Dataset:
    """Cases of one preload method over friction and loss, along the dimension `case`.

    Profiles over the contact are left out, as from the study gathered from it.
    """
    from bearingwear.results.netcdf import dataset
    from bearingwear.studies.grid.gather import chunk

    cases = [Case(method, mu, loss) for mu, loss in itertools.product(friction, losses_um)]
    solved = solved_variants(scene, (case.changes for case in cases))
    return chunk(cases, map(dataset, solved))
