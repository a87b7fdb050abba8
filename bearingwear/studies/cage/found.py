"""The ensemble of one cage and its life: `bearingwear cage`."""

from __future__ import annotations

import contextlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.scene.scene import Scene
from bearingwear.studies.cage.ensemble import ensemble_of, kept_in
from bearingwear.studies.cage.life import cage_life, followed, with_cage_end
from bearingwear.studies.cage.plan import Ensemble
from bearingwear.studies.dataset import write_dataset
from bearingwear.studies.pool import Tell


def cage_found(
    scene: Scene,
    plan: Ensemble,
    life: bool = False,
    workers: int = 1,
    tell: Tell | None = None,
    path: Path | None = None,
) -> xr.Dataset:
    """The ensemble of a cage, and its life if that is asked for.

    path: file to write. What is killed goes on from there. Ensembles along the life stand beside
        it, NAME-1.nc and so on.

    May raise SceneError.
    """
    if life:
        with_cage_end(scene)  # refused before anything is solved
    with contextlib.ExitStack() as kept:
        first: list[xr.Dataset] = []

        def found(number: int, depth: np.ndarray) -> xr.Dataset:
            pocket, land = (1e6 * depth).tolist()
            worn = replace(plan, worn_um=(pocket, land))
            if path is None:
                made = ensemble_of(scene, worn, workers, tell)
            else:
                place = path.with_name(f"{path.stem}-{number}{path.suffix}") if number else path
                made = kept.enter_context(kept_in(place, scene, worn, workers, tell))
                write_dataset(made, place)
            first.append(made)
            return made

        if not life:
            return found(0, np.zeros(2))
        of_life = cage_life(followed(scene, found, tell))
        whole = xr.merge([first[0], of_life]).assign_attrs(of_life.attrs | first[0].attrs)
        if path is not None:
            write_dataset(whole, path)
        return whole
