"""Gathers the motions of all cages of a map."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from bearingwear.results.netcdf import load
from bearingwear.results.variable import Variable
from bearingwear.scene.variant import variant
from bearingwear.studies.cage.plan import CagePlan
from bearingwear.studies.dataset import coordinate, stacked

CAGE_AXES = (
    Variable("cage_friction", ("cage_friction",), "1", "Coulomb coefficient of pockets and land"),
    Variable("pocket_clearance", ("pocket_clearance",), "m", "diametral clearance of the pockets"),
    Variable("guide_clearance", ("guide_clearance",), "m", "diametral clearance of the land"),
    Variable("gravity", ("gravity",), "m s-2", "gravity across the shaft"),
)


def gathered_motions(scene: Path, paths: Sequence[Path], plan: Mapping[str, Any]) -> xr.Dataset:
    """Step: the motions of all cages, over friction, clearances, gravity and start.

    Parameters
    ----------
    scene : path
        That has all that is not varied.
    paths : sequence of path
        In the order of `CagePlan.points`.
    plan : mapping
        `CagePlan` as plain data.
    """
    checked = CagePlan(**plan)
    parts = [load(path) for path in paths]
    together = stacked(parts, checked.shape)
    axes = (
        checked.cage_friction,
        [1e-3 * c for c in checked.pocket_clearance_mm],
        [1e-3 * c for c in checked.guide_clearance_mm],
        checked.gravity_m_s2,
    )
    for axis, values in zip(CAGE_AXES, axes, strict=True):
        together = together.assign_coords(coordinate(axis, list(values)))
    together.attrs = dict(parts[0].attrs) | {
        "title": "Motions of cages",
        "kind": "cage_map",
        "scene": json.dumps(variant(scene, checked.changes).to_dict()),
        "turns": checked.turns,
        "stretch_turns": checked.stretch_turns,
    }
    return together
