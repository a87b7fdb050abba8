"""Ensembles of cages: speed, coverage, tolerance.

    python benchmarks/cage_ensembles.py FOLDER

Files of the folder are gone on from. All of gyro_s1, weightless and as its scene has it. Twenty
minutes of CPU time; `coverage` as a second argument makes that part alone. Short and long runs are
compared by `make cages-docs`.

Coverage: twenty ensembles of their own seeds stop as `bearingwear cage` does. Each interval should
contain the mean of an independent ensemble of 400 runs.
"""

import resource
import sys
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.applications.cage.ensemble import half_interval, is_narrow_enough, resumed_ensemble
from bearingwear.applications.cage.plan import FEWEST, Ensemble
from bearingwear.applications.cage.show import shares_in_words
from bearingwear.scene.read import variant
from bearingwear.studies.dataset import write_dataset

SCENE = "config/scenes/gyro_s1.yaml"
ONE_MOTION = {"friction.cage": 0.1}  # every cage whirls
HALF = {"model.dynamic_tolerance": 5e-4}
SEEDS, FRESH, MANY = range(101, 121), 2001, 400
ALL = 1e-9  # an interval that is never met
PARTS = ("work", "pocket_work", "land_work")


def made(folder: Path, name: str, changes: dict, **plan) -> xr.Dataset:
    """An ensemble and its file; prints what it found and the CPU time of new runs."""
    begun = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    with resumed_ensemble(
        folder / f"{name}.nc", variant(SCENE, changes), Ensemble(**plan)
    ) as found:
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
    """How many repeats contain the mean of the reference, and how many runs each takes."""
    repeats = [made(folder, f"seed_{seed}", {}, seed=seed) for seed in SEEDS]
    reference = made(folder, "reference", {}, seed=FRESH, runs=MANY, within=ALL)
    sizes = [one.sizes["run"] for one in repeats]
    for part in PARTS:
        truth = float(reference[f"mean_{part}"][0])
        ends = [one[f"mean_{part}_interval"].values[0] for one in repeats]
        inside = sum(bool(low <= truth <= high) for low, high in ends)
        print(f"{part}: {inside} of {len(ends)} intervals contain {1e6 * truth:.4g} uJ")
    print(f"{min(sizes)} to {max(sizes)} runs each, {np.mean(sizes):.0f} on average")
    resampled(reference)


def resampled(reference: xr.Dataset, ensembles: int = 4000) -> None:
    """How many ensembles of runs of the reference contain its mean, each stopped likewise."""
    random, plan = np.random.default_rng(1), Ensemble()
    columns = zip(*(reference[part].values.tolist() for part in PARTS), strict=True)
    rows = [dict(zip(PARTS, column, strict=True)) for column in columns]
    inside = dict.fromkeys(PARTS, 0)
    for _ in range(ensembles):
        some = [rows[k] for k in random.integers(0, len(rows), plan.runs)]
        size = next(n for n in range(FEWEST, plan.runs + 1, 10) if is_narrow_enough(some[:n], plan))
        for part in PARTS:
            values = np.array([row[part] for row in some[:size]])
            off = abs(values.mean() - float(reference[f"mean_{part}"][0]))
            inside[part] += off <= half_interval(values)
    print(", ".join(f"{part} {n / ensembles:.3f}" for part, n in inside.items()))


def main() -> None:
    folder = Path(sys.argv[1])
    coverage(folder)
    if sys.argv[2:] == ["coverage"]:
        return
    made(folder, "one_motion", ONE_MOTION, seed=FRESH, runs=200, within=ALL)
    for name, changes, runs in (("tolerance", {}, 60), ("one_motion_few", ONE_MOTION, 40)):
        made(folder, name, changes, seed=FRESH, runs=runs, within=ALL)
        made(folder, f"half_{name}", changes | HALF, seed=FRESH, runs=runs, within=ALL)


if __name__ == "__main__":
    main()
