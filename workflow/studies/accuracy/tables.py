"""Tables of the study of accuracy, and the part of docs/accuracy.md that is made from it."""

import csv
import io
import math
import re
from pathlib import Path

import numpy as np
import xarray as xr

from bearingwear.document.table import cell_text
from bearingwear.results.units import digits, display, span
from bearingwear.scene.checking.check import read_record
from bearingwear.studies.dataset import loaded
from bearingwear.studies.run_step import NotSolved
from workflow.studies.accuracy.effects import effect_differences
from workflow.studies.accuracy.groove_tables import groove_differences
from workflow.studies.accuracy.marked import MarkedPart
from workflow.studies.accuracy.plan import FIRST, AccuracyPlan, TableRow, Tolerance
from workflow.studies.accuracy.points import points_where

_PART = MarkedPart("accuracy")
_PERCENT = display("1", shown="%")
_HEADER = (
    "| what | scenes | QV, median | total QV | contact QV | preload | wear rate | life "
    "| times as fast |"
)
ERRORS = ("total_qv", "total_qv", "contact_qv", "residual_preload", "wear_rate", "life")
SECTIONS = {
    "steady": "Numbers, steady state",
    "ellipse": "Numbers, steady state with slip over the ellipse",
    "short": "Numbers, dynamic, the same turns",
    "long": "Numbers, dynamic, turns and settledness",
    "model": "Differences of model",
}
_NONE = "–"
_PLAIN = ("scenes", "times as fast")  # columns that hold no percentages
LOOSE, LOOSE_FLOOR = (
    10.0,
    0.1,
)  # percent; spread of single scenes: runs with a cage part after some turns


def accuracy_tables(trade: Path, plan: Path) -> tuple[str, str]:
    """Step: every point as CSV, and what each simplification costs and saves as Markdown."""
    points = loaded(trade, point=())
    return points_csv(points), markdown(points, read_record(AccuracyPlan, plan))


def points_csv(trade: xr.Dataset) -> str:
    """Every point, a row each."""
    order = ("scene", "sweep", "kind", "against", "label", "settings")
    rest = [str(name) for name in trade if name not in (*order, "sweep_title")]
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    units = {name: str(trade[name].attrs.get("units", "")) for name in rest}
    table.writerow([*order, *(f"{n} ({u})" if u else n for n, u in units.items())])
    for k in range(trade.sizes["point"]):
        table.writerow(
            [str(trade[name].values[k]) for name in order]
            + [cell_text(float(trade[name].values[k]), None) for name in rest]
        )
    return text.getvalue()


def cells(trade: xr.Dataset, row: TableRow) -> list[float]:
    """Numbers of a row: scenes, errors, times as fast; NaN where there is none."""
    points = points_where(trade, sweep=row.sweep, label=row.label)
    solved = points.isel(point=points["status"].values == 0)
    found: list[float] = [float(solved.sizes["point"])]
    for k, name in enumerate(ERRORS):
        values = np.abs(solved[f"error_{name}"].values)
        values = values[np.isfinite(values)]
        reduce = np.median if k == 0 else np.max
        found.append(float(reduce(values)) if values.size else math.nan)
    ratio = solved["reference_time"].values / solved["wall_time"].values
    found.append(float(np.median(ratio)) if ratio.size else math.nan)
    return found


def section(plan: AccuracyPlan, row: TableRow) -> str:
    """Which part of the table a row belongs to."""
    sweep = plan.sweeps[row.sweep]
    if sweep.kind == "model":
        return "model"
    return sweep.base if sweep.against == FIRST else sweep.against


def markdown(trade: xr.Dataset, plan: AccuracyPlan) -> str:
    """The table of what each simplification costs and saves."""
    lines = []
    for name, title in SECTIONS.items():
        rows = [row for row in plan.table if section(plan, row) == name]
        if not rows:
            continue
        lines += [f"**{title}**", "", _HEADER, "| --- |" + " ---: |" * 8]
        for row in rows:
            count, *errors, speed = cells(trade, row)
            texts = [f"{count:.0f}", *(_PERCENT.text(e) for e in errors), digits(speed)]
            lines.append(f"| {row.text} | " + " | ".join(texts) + " |")
        lines.append("")
    return "\n".join(lines).rstrip() + "\n"


def block(trade: xr.Dataset, plan: AccuracyPlan) -> str:
    """The marked part of docs/accuracy.md."""
    tolerance = plan.tolerance
    of_table = trade["scene"].values[np.isin(trade["sweep"].values, [r.sweep for r in plan.table])]
    scenes = ", ".join(f"`{name}`" for name in plan.scenes if name in of_table)
    return _PART.holding(
        f"""## Accuracy against time

Made by `snakemake -j2 accuracy` and `make accuracy-docs`; not to be edited here.
Errors are absolute values in percent of each scene's reference (`config/accuracy.yaml`). The first
column is the median over the scenes; the others are the worst scene. All other settings are those
of the reference. "Times as fast" is the speed relative to that reference, the median over the
scenes, measured with compiled code on an idle machine. Scenes: {scenes}.

Repeated runs agree within a factor of {tolerance.error:g} in errors and {tolerance.time:g} in
times. Errors below {100.0 * tolerance.floor:g} % (dynamic: {100.0 * tolerance.floor_dynamic:g} %)
are noise. The study checks these tables.

{markdown(trade, plan)}
Unless a row states otherwise, all models here follow the paper: slip is evaluated on the centre
line, and the balance of normal forces neglects traction. A single ball would displace the race
radially, so three balls represent all. With a cage, two runs that differ in the last digit diverge
after some turns; only their means agree. The motion neglects the Coriolis force and the
circumferential component of the normal forces. The energy account includes their work, as a share
of the heat: {booked(trade)}. {of_weight(trade)}

**The presets, scene by scene**: errors in percent of each scene's reference; of the life for steady
solves, of the loss rate for dynamic ones. QV of a single contact is far more sensitive than total
QV. The last two columns list the speed of draft relative to standard, and of standard relative to
reference.

{presets(trade)}

**Estimated and true errors** of all points with an error estimate, including the extremes of the
sweeps. An error counts as covered if it exceeds its estimate by no more than the uncertainty of the
reference (its own estimate plus its check). "Over error" is the median ratio of estimate to error.

{estimates(trade)}"""
    )


def of_weight(trade: xr.Dataset) -> str:
    """What a cage wears without its weight, over what it wears with it."""
    points = points_where(trade, sweep="weight")
    ratios = 1.0 + points["error_cage_wear_rate"].values[1::2]  # each against the point before it
    return f"A weightless cage wears {span(ratios)} times as much over the averaged turns."


def booked(trade: xr.Dataset) -> str:
    """Work of the forces left out, over the heat: the most of all scenes."""
    points = points_where(trade, sweep="long", label="reference")
    texts = []
    for name, text in (("coriolis", "Coriolis"), ("azimuth", "circumferential")):
        values = np.abs(points[f"{name}_energy_share"].values)
        values = values[np.isfinite(values)]
        most = float(values.max()) if values.size else math.nan
        texts.append(f"{text} up to {_PERCENT.text(most)} %")
    return ", ".join(texts)


def presets(trade: xr.Dataset) -> str:
    """Table of the errors of draft and standard in each scene, and the time they save."""
    lines = [
        "| solve, scene | draft: QV | contact | life | standard: QV | contact | life "
        "| faster | faster |",
        "| --- |" + " ---: |" * 8,
    ]
    for sweep, kind, last in (("steady", "steady", "life"), ("dynamic", "dynamic", "wear_rate")):
        points = points_where(trade, sweep=f"preset_{sweep}")
        for scene in dict.fromkeys(points["scene"].values):
            one = {
                label: points_where(points, scene=scene, label=label)
                for label in ("draft", "standard", "reference")
            }
            cells = [f"{kind}, `{scene}`"]
            for label in ("draft", "standard"):
                for name in ("total_qv", "contact_qv", last):
                    cells.append(_PERCENT.text(abs(float(one[label][f"error_{name}"].values[0]))))
            times = [float(part["wall_time"].values[0]) for part in one.values()]
            cells += [digits(times[1] / times[0]), digits(times[2] / times[1])]
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def estimates(trade: xr.Dataset) -> str:
    """How often the estimates that results carry are above the true error, as a table."""
    lines = [
        "| estimate of | steady: points | covered | over error "
        "| dynamic: points | covered | over error |",
        "| --- |" + " ---: |" * 6,
    ]
    names = {"total_qv": "QV", "residual_preload": "preload", "wear_rate": "wear rate"}
    for name, text in (names | {"life": "life"}).items():
        row = [text]
        for against in ("steady", "long"):
            points = points_where(trade, against=against, kind="numerical")
            error = np.abs(points[f"error_{name}"].values)
            doubt = {s: doubts(trade, s, against, name) for s in set(points["scene"].values)}
            estimate = points[f"estimate_{name}"].values
            least = error - [doubt[s] for s in points["scene"].values]
            both = np.isfinite(error) & np.isfinite(estimate)
            error, estimate, least = error[both], estimate[both], least[both]
            row.append(str(both.sum()))
            if both.any():
                row.append(f"{_PERCENT.text(np.mean(estimate >= least))} %")
                row.append(digits(float(np.median(estimate / np.maximum(error, 1e-9)))))
            else:
                row += [_NONE, _NONE]
        lines.append("| " + " | ".join(row) + " |")
    return "\n".join(lines)


def doubts(trade: xr.Dataset, scene: str, reference: str, name: str) -> float:
    """Doubt of a reference: its own error estimate and the difference of its check."""
    points = points_where(trade, scene=scene, sweep=reference)
    own = points_where(points, label="reference")[f"estimate_{name}"].values
    other = np.abs(points_where(points, label="check")[f"error_{name}"].values)
    return float(np.nansum(own) + np.nansum(other))


def docs_with_block(trade: Path, plan: Path, docs: Path) -> str:
    """Step: the docs with the block of this run in the place of the old one, or at the end."""
    text = block(loaded(trade, point=()), read_record(AccuracyPlan, plan))
    old = docs.read_text(encoding="utf-8") if docs.exists() else "# Accuracy\n"
    if _PART.stands_in(old):
        return _PART.renewed(docs, text)
    return f"{old.rstrip()}\n\n{text}\n"


def check_docs(trade: Path, plan: Path, docs: Path) -> str:
    """Step: says that the docs agree with a run.

    Raises
    ------
    NotSolved
        A line for each number that differs beyond the tolerance.
    """
    points, read = loaded(trade, point=()), read_record(AccuracyPlan, plan)
    lines = differences(points, read, docs) + effect_differences(points, read, docs)
    lines += groove_differences(points, read, docs)
    if lines:
        raise NotSolved("\n".join([*lines, f"{docs}: {len(lines)} numbers differ"]))
    return f"{docs}: agrees\n"


def differences(trade: xr.Dataset, plan: AccuracyPlan, docs: str | Path) -> list[str]:
    """Where docs/accuracy.md differs from a run beyond the tolerance; a line each.

    Raises
    ------
    CaseFileError
        Where the file has no such block.
    """
    docs = Path(docs)
    said = table_rows(_PART.split(docs)[1])
    found = []
    for row in plan.table:
        part = section(plan, row)
        where = f"{SECTIONS[part]}: {row.text}"
        if (SECTIONS[part], row.text) not in said:
            found.append(f"{docs}: {where}: missing")
            continue
        columns = _HEADER.strip("| ").split(" | ")[1:]
        for name, text_said, value in zip(
            columns, said[SECTIONS[part], row.text], cells(trade, row), strict=True
        ):
            if not agree(text_said, value, name, part, plan.tolerance):
                given = digits(value) if name in _PLAIN else _PERCENT.text(value)
                found.append(f"{docs}: {where}: {name}: says {text_said}, a run gives {given}")
    planned = {(SECTIONS[section(plan, row)], row.text) for row in plan.table}
    for key, texts in table_rows(block(trade, plan)).items():
        if key in planned:
            continue
        old = said.get(key, [])
        if len(old) != len(texts) or not all(map(alike, old, texts)):
            found.append(f"{docs}: {key[1]}: says {' '.join(old)}, a run gives {' '.join(texts)}")
    return found


def alike(said: str, given: str) -> bool:
    """Whether two cells of the tables of presets and estimates say the same, within a factor 10."""
    try:
        one, other = (_number(text.removesuffix(" %")) for text in (said, given))
    except ValueError:
        return said == given
    low, high = sorted((max(one, LOOSE_FLOOR), max(other, LOOSE_FLOOR)))
    return high <= LOOSE * low


def _number(said: str) -> float:
    """The number of a cell, or what it says to be below."""
    return float(said.removeprefix("< "))


def table_rows(text: str) -> dict[tuple[str, str], list[str]]:
    """Cells of each row of the block, by section and first cell."""
    rows, title = {}, ""
    for line in text.splitlines():
        if match := re.fullmatch(r"\*\*(.+)\*\*", line):
            title = match[1]
        elif line.startswith("| ") and not line.startswith(("| what", "| ---")):
            first, *rest = (cell.strip() for cell in line.strip("| ").split(" | "))
            rows[title, first] = rest
    return rows


def agree(said: str, value: float, column: str, part: str, tolerance: Tolerance) -> bool:
    """Whether a cell and a number are the same within the tolerance."""
    if said == _NONE or not math.isfinite(value):
        return said == _NONE and not math.isfinite(value)
    number = _number(said)
    if column == "scenes":
        return number == value
    if column == "times as fast":
        factor, floor = tolerance.time, 0.0
    else:
        factor, number = tolerance.error, 0.01 * number
        floor = tolerance.floor if part == "steady" else tolerance.floor_dynamic
        if said.startswith("<"):
            floor = max(floor, number)
    low, high = sorted((max(number, floor), max(value, floor)))
    return high <= factor * 1.05 * low  # and what the digits round off
