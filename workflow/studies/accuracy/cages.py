"""What short runs and coarse steps change in an ensemble of cages: a part of docs/accuracy.md."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.results.netcdf import load
from bearingwear.results.units import Rough
from bearingwear.studies.cage.ensemble import half_interval
from workflow.studies.accuracy.checked_table import Agreement, CheckedTable
from workflow.studies.accuracy.plan import AccuracyPlan

_MEANS = {"turns": "turns", "work": "work", "pockets": "pocket_work", "land": "land_work"}
_COLUMNS = (*_MEANS, "90 %, +-", "same motion")


def gathered_cages(paths: Sequence[Path]) -> xr.Dataset:
    """Step: turns, work and motion of every run, along `point` (the ensemble) and `run`."""
    parts = [load(path)[[*_MEANS.values(), "motion"]] for path in paths]
    return xr.concat(parts, "point", combine_attrs="override")


def cages_part(trade: xr.Dataset, plan: AccuracyPlan) -> list[str | CheckedTable]:
    """Each ensemble over the first, whose runs have the same samples."""
    rows, first = [], trade.isel(point=0)
    for k, row in enumerate(plan.cages.ensembles.values()):
        solved = np.isfinite(trade["work"].values[k]) & np.isfinite(first["work"].values)
        part, long = (each.isel(run=solved) for each in (trade.isel(point=k), first))
        ratios = [float(part[name].mean() / long[name].mean()) for name in _MEANS.values()]
        apart = half_interval((part["work"] - long["work"]).values) / float(long["work"].mean())
        alike = float((part["motion"].values == long["motion"].values).mean())
        rows.append([row.text, *map(Rough, (*ratios, apart, alike))])
    # which motion comes may depend on the last bits
    loose = Agreement(plan.tolerance.time)
    title = "ensembles of a cage, relative to the first"
    return [
        f"Made by `make cages-docs`; not to be edited here. {plan.cages.runs} runs of "
        f"`{plan.cages.file}` with a horizontal shaft and the same starts in every row "
        "(`config/accuracy.yaml`), relative to the first row: turns, mean work per turn, its parts "
        "in the pockets and at the land, half of the 90 % interval of the work (of the paired "
        "differences), and the share of the runs that end in the motion of the long run.",
        CheckedTable(
            title=title, axes=("what",), columns=dict.fromkeys(_COLUMNS, loose), rows=rows
        ),
    ]
