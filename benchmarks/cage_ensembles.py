"""Ensembles of cages: speed, coverage, tolerance, short against long runs.

    python benchmarks/cage_ensembles.py FOLDER

Files of the folder are gone on from. All of gyro_s1, weightless and as its scene has it, but where
the shaft is horizontal. Twenty minutes of CPU time; `coverage` as a second argument makes that
part alone.

Coverage: twenty ensembles of their own seeds stop as `bearingwear cage` does. Each interval should
contain the mean over the first twenty runs of all, 400 in number.
"""

import resource
import sys
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.scene.variant import variant
from bearingwear.studies.cage.ensemble import kept_in
from bearingwear.studies.cage.plan import FEWEST, Ensemble
from bearingwear.studies.cage.show import shares_in_words
from bearingwear.studies.dataset import write_dataset

SCENE = "config/scenes/gyro_s1.yaml"
GRAVITY = {"operation.gravity_m_s2": [0.0, 0.0, -9.81]}
SEEDS, FEW = range(101, 121), 40
ALL = 1e-9  # an interval that is never met
PARTS = ("work", "pocket_work", "land_work")


def made(folder: Path, name: str, changes: dict, **plan) -> xr.Dataset:
    """An ensemble and its file; prints what it found and the CPU time of new runs."""
    begun = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    with kept_in(folder / f"{name}.nc", variant(SCENE, changes), Ensemble(**plan)) as found:
        write_dataset(found, folder / f"{name}.nc")
    spent = resource.getrusage(resource.RUSAGE_SELF).ru_utime - begun
    turns = float(found["mean_turns"][0])
    print(f"{name}: {found.sizes['run']} runs of {turns:.0f} turns, {spent:.0f} s of CPU time")
    print(f"  {shares_in_words(found['share'].values)}")
    for part in PARTS:
        mean, (low, high) = float(found[f"mean_{part}"][0]), found[f"mean_{part}_interval"][0]
        print(f"  {part}: {1e6 * mean:.4g} uJ a turn ({1e6 * low:.4g} to {1e6 * high:.4g})")
    return found


def coverage(folder: Path) -> None:
    """How many repeats contain the mean over all runs, and how many runs each takes."""
    repeats = [made(folder, f"seed_{seed}", {}, seed=seed) for seed in SEEDS]
    first = [one.isel(run=slice(FEWEST)) for one in repeats]
    sizes = [one.sizes["run"] for one in repeats]
    for part in PARTS:
        truth = float(np.mean([one[part].values for one in first]))
        ends = [one[f"mean_{part}_interval"].values[0] for one in repeats]
        inside = sum(bool(low <= truth <= high) for low, high in ends)
        print(f"{part}: {inside} of {len(ends)} intervals contain {1e6 * truth:.4g} uJ")
    print(f"{min(sizes)} to {max(sizes)} runs each, {np.mean(sizes):.0f} on average")


def main() -> None:
    folder = Path(sys.argv[1])
    coverage(folder)
    if sys.argv[2:] == ["coverage"]:
        return
    made(folder, "as_it_is", {})
    made(folder, "half_tolerance", {"model.dynamic_tolerance": 5e-4}, runs=60, within=ALL)
    made(folder, "tolerance", {}, runs=60, within=ALL)
    heavy = GRAVITY | {"cage_uncertainty": {}}
    made(folder, "short", heavy, runs=FEW, within=ALL)
    made(folder, "long", heavy, runs=FEW, within=ALL, least_turns=450, most_turns=450)


if __name__ == "__main__":
    main()
