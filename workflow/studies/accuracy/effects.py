"""What single effects change on each scene, and cost: their own marked part of docs/accuracy.md."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.scene.checking.check import read_record
from bearingwear.studies.dataset import loaded
from workflow.studies.accuracy.factor_table import (
    FACTOR,
    TIME_FACTOR,
    FactorTable,
    answers_agree_within,
    table_differences,
    tables_text,
)
from workflow.studies.accuracy.marked import MarkedPart
from workflow.studies.accuracy.plan import AccuracyPlan
from workflow.studies.accuracy.points import names, points_where

_PART = MarkedPart("effects")
EFFECT_COLUMNS = {
    "preload": "residual_preload",
    "QV": "total_qv",
    "life": "life",
    "time of a solve": "processor_time",
    "time of a life": "life_processor_time",
}
EFFECT_KINDS = {
    title: TIME_FACTOR if title.startswith("time") else FACTOR for title in EFFECT_COLUMNS
}

EffectRow = tuple[str, str, str, list[float]]
"""Title of the sweep, effect, scene, and what it multiplies the columns by, or NaN."""


def effect_rows(trade: xr.Dataset, plan: AccuracyPlan) -> Iterator[EffectRow]:
    """Each effect on each scene, over the first point of its sweep there."""
    for row in plan.effects:
        points = points_where(trade, sweep=row.sweep)
        for scene in names(points, "scene"):
            here = points_where(points, scene=scene)
            first, point = here.isel(point=0), points_where(here, label=row.label).isel(point=0)
            with np.errstate(divide="ignore", invalid="ignore"):
                times = [float(point[name] / first[name]) for name in EFFECT_COLUMNS.values()]
            text = row.text if int(point["status"]) == OK else _unsolved(row.text, point)
            yield plan.sweeps[row.sweep].title, text, scene, times


def _unsolved(text: str, point: xr.Dataset) -> str:
    return f"{text}: {STATUS_NAMES[int(point['status'])].replace('_', ' ')}"


def effect_tables(trade: xr.Dataset, plan: AccuracyPlan) -> list[FactorTable]:
    """A table for each sweep."""
    rows = list(effect_rows(trade, plan))
    return [
        FactorTable(title, EFFECT_KINDS, [(w, s, times) for t, w, s, times in rows if t == title])
        for title in dict.fromkeys(row[0] for row in rows)
    ]


def effects_block(trade: xr.Dataset, plan: AccuracyPlan) -> str:
    """The marked part of docs/accuracy.md."""
    return _PART.holding(
        f"""Made by `snakemake -j1 results/accuracy/effects.nc` and `make effects-docs`; not
to be edited here.
Each number is relative to the first point of its sweep (`config/accuracy.yaml`): the bearing as
mounted, a single bearing, or no traction in the balance, always with slip over the whole ellipse.
Preload and QV refer to the first bearing at the wear of the scene. Lives start from new; a life of
0 means that a limit is exceeded when new. Times are CPU times of complete steady solves and lives
with compiled code, medians of {plan.repeats} runs. The study checks this table: results agree
within {answers_agree_within()}, times within a factor of {plan.tolerance.time:g}.

{tables_text(effect_tables(trade, plan))}"""
    )


def effects_table(trade: Path, plan: Path) -> str:
    """Step: the tables alone."""
    tables = effect_tables(loaded(trade, point=()), read_record(AccuracyPlan, plan))
    return tables_text(tables) + "\n"


def docs_with_effects(trade: Path, plan: Path, docs: Path) -> str:
    """Step: the docs with the block of this run in the place of the old one.

    Raises
    ------
    CaseFileError
        Where they have no such block.
    """
    text = effects_block(loaded(trade, point=()), read_record(AccuracyPlan, plan))
    return _PART.renewed(docs, text)


def effect_differences(trade: xr.Dataset, plan: AccuracyPlan, docs: Path) -> list[str]:
    """Where the block of the docs differs from a run; a line each."""
    return table_differences(effect_tables(trade, plan), _PART, docs, plan.tolerance)
