"""What single effects change on each scene, and cost: their own marked part of docs/accuracy.md."""

import math
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.results.units import digits
from bearingwear.scene.checking import read_record
from bearingwear.studies.accuracy.figures import names, points_where
from bearingwear.studies.accuracy.marked import MarkedPart
from bearingwear.studies.accuracy.plan import AccuracyPlan
from bearingwear.studies.dataset import loaded

_PART = MarkedPart("effects")
EFFECT_COLUMNS = {
    "preload": "residual_preload",
    "QV": "total_qv",
    "life": "life",
    "time of a solve": "processor_time",
    "time of a life": "life_processor_time",
}
_TIMES = [title.startswith("time") for title in EFFECT_COLUMNS]
_ANSWER = 1.02
"""Factor within which two runs of the same program give the same answer."""

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


def effect_tables(trade: xr.Dataset, plan: AccuracyPlan) -> str:
    """A table for each sweep."""
    rows = list(effect_rows(trade, plan))
    header = ["| " + " | ".join(["what", "scene", *EFFECT_COLUMNS]) + " |"]
    header.append("| --- | --- |" + " ---: |" * len(EFFECT_COLUMNS))
    parts = []
    for title in dict.fromkeys(row[0] for row in rows):
        cells = [[w, f"`{s}`", *factor_texts(times)] for t, w, s, times in rows if t == title]
        lines = ["| " + " | ".join(row) + " |" for row in cells]
        parts += [f"**{title[0].upper()}{title[1:]}**", "\n".join([*header, *lines])]
    return "\n\n".join(parts)


def factor_texts(factors: Sequence[float]) -> list[str]:
    """Factors as cells; what takes time is known to two digits at best."""
    return [
        digits(float(f"{factor:.2g}") if is_time else factor)
        for factor, is_time in zip(factors, _TIMES, strict=True)
    ]


def effects_block(trade: xr.Dataset, plan: AccuracyPlan) -> str:
    """The marked part of docs/accuracy.md."""
    return f"""{_PART.begin}
Made by `snakemake -j1 results/accuracy/effects.nc` and `make effects-docs`; not to be edited here.
Each number is a factor over the first point of its sweep (`config/accuracy.yaml`): the bearing as
mounted, or alone, or without traction, always with slip over the whole ellipse. Preload and QV are
those of the first bearing, at the wear of the scene; a life is that from new, and 0 where a limit
is passed when new. Times are processor times of whole steady solves and lives, compiled code warm,
the median of {plan.repeats}. A run of the study compares: answers agree within
{100.0 * (_ANSWER - 1.0):.0f} %, times within a factor {plan.tolerance.time:g}.

{effect_tables(trade, plan)}
{_PART.end}"""


def effects_table(trade: Path, plan: Path) -> str:
    """Step: the tables alone."""
    return effect_tables(loaded(trade, point=()), read_record(AccuracyPlan, plan)) + "\n"


def docs_with_effects(trade: Path, plan: Path, docs: Path) -> str:
    """Step: the docs with the block of this run in the place of the old one.

    Raises
    ------
    CaseFileError
        Where they have no such block.
    """
    before, _, after = _PART.split(docs)
    return before + effects_block(loaded(trade, point=()), read_record(AccuracyPlan, plan)) + after


def effect_differences(trade: xr.Dataset, plan: AccuracyPlan, docs: Path) -> list[str]:
    """Where the block of the docs differs from a run; a line each."""
    _, old, _ = _PART.split(docs)
    said, title = {}, ""
    for line in old.splitlines():
        if bold := re.fullmatch(r"\*\*(.+)\*\*", line):
            title = bold[1].lower()
        elif line.startswith("| "):
            what, scene, *cells = line.strip("| ").split(" | ")
            said[title, what, scene.strip("`")] = cells
    found = []
    for title, what, scene, times in effect_rows(trade, plan):
        where = f"{docs}: {title}: {what}, {scene}"
        if (title.lower(), what, scene) not in said:
            found.append(f"{where}: missing")
            continue
        cells = said[title.lower(), what, scene]
        for name, is_time, cell, value in zip(EFFECT_COLUMNS, _TIMES, cells, times, strict=True):
            if not _alike(cell, value, plan.tolerance.time if is_time else _ANSWER):
                found.append(f"{where}: {name}: says {cell}, a run gives {digits(value)}")
    return found


def _alike(said: str, value: float, factor: float) -> bool:
    """Whether a cell says a number, within a factor."""
    if said == "–" or not math.isfinite(value):
        return said == "–" and not math.isfinite(value)
    low, high = sorted((float(said), value))
    return bool(high <= factor * low or np.isclose(low, high, atol=1e-3))
