"""Gathers the ensembles of all cages of a map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.results.netcdf import load
from bearingwear.results.variable import Variable
from bearingwear.scene.blocks import GUIDES
from bearingwear.scene.read import variant
from bearingwear.studies.dataset import coordinate, stacked_dataset

MAP_KIND = "cage map"

CAGE_AXES = {
    "gravity_m_s2": (
        Variable("gravity", ("gravity",), "m s-2", "gravity perpendicular to the shaft"),
        1.0,
    ),
    "guiding_race": (
        Variable("guide", ("guide",), "", "guidance of the cage", "i1", flags=GUIDES),
        None,
    ),
    "imbalance_um": (Variable("imbalance", ("imbalance",), "m", "imbalance of the cage"), 1e-6),
    "pocket_clearance_mm": (
        Variable("pocket_clearance", ("pocket_clearance",), "m", "diametral pocket clearance"),
        1e-3,
    ),
    "guide_clearance_mm": (
        Variable("guide_clearance", ("guide_clearance",), "m", "diametral clearance at the land"),
        1e-3,
    ),
    "cage_friction": (
        Variable(
            "cage_friction", ("cage_friction",), "1", "friction coefficient of the pockets and land"
        ),
        1.0,
    ),
}
"""Variable of a dimension of a map, and the factor from the unit of its key to SI.

By the key of config/cage.yaml. The factor is None for a dimension of names, which are stored as
codes.
"""


def gathered_ensembles(
    scene: Path,
    paths: Sequence[Path],
    axes: Mapping[str, Sequence[Any]],
    changes: Mapping[str, Any],
) -> xr.Dataset:
    """Returns the means and shares of the ensembles of all cages, over the axes of their map.

    `runs` is the number of runs of each ensemble; the runs themselves are left out.

    scene: file with all values that are not varied.
    paths: files of the ensembles in the order of `plan.cage_points`.
    axes: values along each dimension by the keys of config/cage.yaml, from `plan.cage_axes`.
    changes: values to set in the scene, by dotted keys.
    """
    parts = [load(path) for path in paths]
    shape = {CAGE_AXES[name][0].name: len(values) for name, values in axes.items()}
    ensembles = stacked_dataset(parts, shape, leave_out=("run", "value", "across"))
    counts = np.reshape([part.sizes["run"] for part in parts], tuple(shape.values()))
    attributes = {"long_name": "number of runs in the ensemble", "units": "1"}
    ensembles = ensembles.assign(runs=(tuple(shape), counts, attributes))
    for name, values in axes.items():
        axis, factor = CAGE_AXES[name]
        stored = [GUIDES.index(value) if factor is None else factor * value for value in values]
        ensembles = ensembles.assign_coords(coordinate(axis, stored))
    changed = variant(scene, changes)
    ensembles.attrs = dict(parts[0].attrs) | {
        "title": f"Cage map: {changed.name}",
        "kind": MAP_KIND,
        "scene": changed.json,
    }
    return ensembles
