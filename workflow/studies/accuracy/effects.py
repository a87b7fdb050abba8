"""What single effects change on each scene, and cost: a part of docs/accuracy.md."""

from collections.abc import Iterator

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.units import Rough
from workflow.studies.accuracy.checked_table import Agreement, CheckedTable, answers_agree_within
from workflow.studies.accuracy.gather import names, points_where
from workflow.studies.accuracy.plan import AccuracyPlan, TableRow

EFFECT_COLUMNS = {
    "preload": "residual_preload",
    "QV": "total_qv",
    "life": "life",
    "time of a solve": "processor_time",
    "time of a life": "life_processor_time",
}


def effect_rows(trade: xr.Dataset, row: TableRow) -> Iterator[list]:
    """An effect on each scene, and what it multiplies the columns by: over the first point there.

    NaN where either was not solved.
    """
    points = points_where(trade, sweep=row.sweep)
    for scene in names(points, "scene"):
        here = points_where(points, scene=scene)
        first, point = here.isel(point=0), points_where(here, label=row.label).isel(point=0)
        text, status = row.text, int(point["status"])
        if status != OK:
            text = f"{text}: {STATUS_NAMES[status].replace('_', ' ')}"
        with np.errstate(divide="ignore", invalid="ignore"):
            factors = [float(point[name] / first[name]) for name in EFFECT_COLUMNS.values()]
        yield [text, scene, *factors[:3], *map(Rough, factors[3:])]


def effects_part(trade: xr.Dataset, plan: AccuracyPlan) -> list[str | CheckedTable]:
    """A table for each sweep."""
    times = Agreement(plan.tolerance.time)
    columns = {head: times if head.startswith("time") else Agreement() for head in EFFECT_COLUMNS}
    rows: dict[str, list] = {}
    for effect in plan.effects:
        title = plan.sweeps[effect.sweep].title
        rows.setdefault(title, []).extend(effect_rows(trade, effect))
    return [
        "Made by `snakemake -j1 results/accuracy/effects.nc` and `make effects-docs`; not to be "
        "edited here. Each number is relative to the first point of its sweep "
        "(`config/accuracy.yaml`): the bearing as mounted, a single bearing, or no traction in the "
        "balance, always with slip over the whole ellipse. Preload and QV refer to the first "
        "bearing at the wear of the scene. Lives start from new; a life of 0 means that a limit is "
        "exceeded when new. Times are CPU times of complete steady solves and lives with compiled "
        f"code, medians of {plan.repeats} runs. The study checks this table: results agree within "
        f"{answers_agree_within()}, times within a factor of {plan.tolerance.time:g}.",
        *(CheckedTable(title=title, columns=columns, rows=found) for title, found in rows.items()),
    ]
