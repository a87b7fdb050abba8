"""What following the grooves changes and costs: its own marked part of docs/accuracy.md."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.lives.groove_life import REQUIRED
from bearingwear.results.units import digits, span
from bearingwear.scene.checking.check import read_record
from bearingwear.studies.dataset import loaded
from workflow.studies.accuracy.factor_table import (
    ERROR,
    FACTOR,
    TIME_FACTOR,
    WHETHER,
    FactorTable,
    answers_agree_within,
    table_differences,
    tables_text,
)
from workflow.studies.accuracy.marked import MarkedPart
from workflow.studies.accuracy.plan import AccuracyPlan
from workflow.studies.accuracy.points import names, points_where

_PART = MarkedPart("grooves")
_RATIOS = (("life", FACTOR), ("end_qv", FACTOR), ("life_processor_time", TIME_FACTOR))
LIFE_COLUMNS = {
    "life": FACTOR,
    "life, bands": FACTOR,
    "end QV": FACTOR,
    "QV, bands": FACTOR,
    "time": TIME_FACTOR,
    "time, bands": TIME_FACTOR,
    "`auto` follows": WHETHER,
}
CELL_COLUMNS = {"life": ERROR, "end QV": ERROR, "times as fast": TIME_FACTOR}
WORST = "worst"
"""Stands for the scene in a table of cells and steps."""


def by_end(points: xr.Dataset, scene: str) -> Iterator[tuple[str, dict[str, xr.Dataset]]]:
    """Lives of a scene that end at the same loss: `hertz`, `worn`, `bands` at each end."""
    here = points_where(points, scene=scene)
    ends = dict.fromkeys(label.partition(", ")[0] for label in here["label"].values)
    for end in ends:
        yield (
            end,
            {
                groove: points_where(here, label=f"{end}, {groove}").isel(point=0)
                for groove in ("hertz", "worn", "bands")
            },
        )


def groove_tables(trade: xr.Dataset, plan: AccuracyPlan) -> list[FactorTable]:
    """Worn grooves over Hertz' by the loss at the end; cells and steps."""
    tables = []
    for sweep in plan.groove_sweeps:
        points, rows = points_where(trade, sweep=sweep), []
        for scene in names(points, "scene"):
            for end, one in by_end(points, scene):
                ratios = [
                    float(one[groove][name] / one["hertz"][name])
                    for name, _ in _RATIOS
                    for groove in ("worn", "bands")
                ]
                followed = float(one["worn"]["wear_over_gap"] > REQUIRED)
                rows.append((f"loss of {end} A a²", scene, [*ratios, followed]))
        tables.append(FactorTable(plan.sweeps[sweep].title, LIFE_COLUMNS, rows))
    return [*tables, *(cell_table(trade, plan, sweep) for sweep in plan.cell_sweeps)]


def against_finest(points: xr.Dataset) -> Iterator[tuple[str, str, xr.Dataset]]:
    """Track, settings and point of each life, its `error_*` and `faster` against the finest."""
    for scene in names(points, "scene"):
        here = points_where(points, scene=scene)
        finest: dict[str, xr.Dataset] = {}
        for k in range(here.sizes["point"]):
            point = here.isel(point=k)
            track, _, settings = str(point["label"].values).partition(", ")
            first = finest.setdefault(track, point)
            errors = {
                f"error_{name}": abs(point[name] / first[name] - 1.0) for name in ("life", "end_qv")
            }
            faster = first["life_processor_time"] / point["life_processor_time"]
            yield track, settings, point.assign(errors | {"faster": faster})


def cell_table(trade: xr.Dataset, plan: AccuracyPlan, sweep: str) -> FactorTable:
    """The worst error of all scenes and tracks, and the median of how much faster."""
    found: dict[str, list[xr.Dataset]] = {}
    for _, settings, point in against_finest(points_where(trade, sweep=sweep)):
        found.setdefault(settings, []).append(point)
    rows = []
    for settings, points in found.items():
        step, _, cells = settings.partition(", ")
        errors = [max(float(p[f"error_{n}"]) for p in points) for n in ("life", "end_qv")]
        faster = float(np.median([float(p["faster"]) for p in points]))
        rows.append((f"{cells} cells, steps of {step}", WORST, [*errors, faster]))
    return FactorTable(plan.sweeps[sweep].title, CELL_COLUMNS, rows)


def what_auto_saves(trade: xr.Dataset, plan: AccuracyPlan) -> str:
    """What lives lose and save whose grooves `auto` does not follow."""
    errors: dict[str, list[float]] = {"worn": [], "bands": []}
    saved, lives = [], 0
    for sweep in plan.groove_sweeps:
        points = points_where(trade, sweep=sweep)
        for scene in names(points, "scene"):
            for _, one in by_end(points, scene):
                lives += 1
                if float(one["worn"]["wear_over_gap"]) > REQUIRED:
                    continue
                times = [float(one[of]["life_processor_time"]) for of in ("worn", "hertz")]
                saved.append(float(f"{times[0] / times[1]:.2g}"))
                for track, found in errors.items():
                    found.append(abs(float(one["hertz"]["life"] / one[track]["life"]) - 1.0))
    if not saved:
        return "`auto` selects worn grooves for all of these lives."
    even, bands = (digits(100.0 * max(found)) for found in errors.values())
    return (
        f"`auto` selects Hertzian contact for the {len(saved)} of these {lives} lives that end "
        f"below {REQUIRED:g} gaps. This reduces the time by factors of {span(saved)}. The lives "
        f"differ from those with worn grooves by up to {even} % (even ball wear) and {bands} % "
        "(bands)."
    )


def groove_block(trade: xr.Dataset, plan: AccuracyPlan) -> str:
    """The marked part of docs/accuracy.md."""
    return _PART.holding(
        f"""Made by `snakemake -j1 results/accuracy/effects.nc` and `make effects-docs`; not
to be edited here.
Lives end at the stated multiple of A a², the gap between ball and groove at the edge of the new
contact, or at 40 % of the preload. The first tables list ratios to the life with Hertzian contact
that ends at the same loss, for balls that wear evenly and in bands. "End QV" is QV at the end of
life. Times are CPU times of lives with all error estimates. The last tables list errors relative to
the finest cells and steps (as fractions of the gap), without error estimates: the worst of all
scenes and wear patterns. The study checks these tables: results agree within
{answers_agree_within()}, errors within a factor of {plan.tolerance.error:g}, times within a factor
of {plan.tolerance.time:g}.

{what_auto_saves(trade, plan)}

{tables_text(groove_tables(trade, plan))}"""
    )


def grooves_table(trade: Path, plan: Path) -> str:
    """Step: the tables alone."""
    tables = groove_tables(loaded(trade, point=()), read_record(AccuracyPlan, plan))
    return tables_text(tables) + "\n"


def docs_with_grooves(trade: Path, plan: Path, docs: Path) -> str:
    """Step: the docs with the block of this run in the place of the old one.

    Raises
    ------
    CaseFileError
        Where they have no such block.
    """
    text = groove_block(loaded(trade, point=()), read_record(AccuracyPlan, plan))
    return _PART.renewed(docs, text)


def groove_differences(trade: xr.Dataset, plan: AccuracyPlan, docs: Path) -> list[str]:
    """Where the block of the docs differs from a run; a line each."""
    return table_differences(groove_tables(trade, plan), _PART, docs, plan.tolerance)
