"""Ensembles of cages: speed, coverage, tolerance, short against long runs.

    python benchmarks/cage_ensembles.py FOLDER

Files of the folder are gone on from. All of gyro_s1, weightless and as its scene has it, but for
the last part. Ten minutes of CPU time.

Repeats are disjoint stretches of one ensemble, since its draws are independent: each takes runs
until its interval is met. What they should hold is the mean over all runs.
"""

import resource
import sys
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.scene.variant import variant
from bearingwear.studies.cage.ensemble import half_interval, is_met, kept_in
from bearingwear.studies.cage.plan import FEWEST, Ensemble
from bearingwear.studies.cage.show import shares_in_words
from bearingwear.studies.dataset import write_dataset

SCENE = "config/scenes/gyro_s1.yaml"
GRAVITY = {"operation.gravity_m_s2": [0.0, 0.0, -9.81]}
POOL, FEW = 400, 40
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


def coverage(pool: xr.Dataset) -> None:
    """How many repeats hold the mean of all runs, and how many runs each takes."""
    rows = [{"work": float(work)} for work in pool["work"].values]
    plan, truth, sizes, held = Ensemble(), np.mean([row["work"] for row in rows]), [], 0
    while rows:
        some = rows[:FEWEST]
        while len(some) < len(rows) and not (len(some) % 10 == 0 and is_met(some, plan)):
            some = rows[: len(some) + 1]
        if not is_met(some, plan):
            break
        values = np.array([row["work"] for row in some])
        held += abs(values.mean() - truth) <= half_interval(values)
        sizes.append(len(some))
        rows = rows[len(some) :]
    print(
        f"repeats: {held} of {len(sizes)} intervals hold the mean over all; "
        f"{min(sizes)} to {max(sizes)} runs each, {np.mean(sizes):.0f} on average"
    )


def main() -> None:
    folder = Path(sys.argv[1])
    made(folder, "as_it_is", {})
    made(folder, "half_tolerance", {"model.dynamic_tolerance": 5e-4}, runs=60, within=ALL)
    made(folder, "tolerance", {}, runs=60, within=ALL)
    heavy = GRAVITY | {"cage_uncertainty": {}}
    made(folder, "short", heavy, runs=FEW, within=ALL)
    made(folder, "long", heavy, runs=FEW, within=ALL, least_turns=450, most_turns=450)
    coverage(made(folder, "pool", {}, runs=POOL, within=ALL))


if __name__ == "__main__":
    main()
