"""Every point of the study of accuracy as CSV, and its main part of docs/accuracy.md."""

import csv
import io
import math
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.document.table import cell_text
from bearingwear.results.units import display, span
from workflow.studies.accuracy.checked_table import Agreement, CheckedTable
from workflow.studies.accuracy.gather import names, points_where
from workflow.studies.accuracy.plan import FIRST, AccuracyPlan, TableRow

_PERCENT = display("1", shown="%")
ERRORS = {
    "median QV": "total_qv",
    "QV": "total_qv",
    "contact": "contact_qv",
    "preload": "residual_preload",
    "wear": "wear_rate",
    "life": "life",
}
SECTIONS = {
    "steady": "Numbers, steady state",
    "ellipse": "Numbers, steady state with slip over the ellipse",
    "short": "Numbers, dynamic, the same turns",
    "long": "Numbers, dynamic, turns and settledness",
    "model": "Differences of model",
}
LOOSE = Agreement(10.0, 0.1)
"""Of single scenes: runs with a cage part after some turns."""
LOOSE_ERROR = LOOSE._replace(unit="%")


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


def cells(trade: xr.Dataset, row: TableRow) -> list:
    """Number of scenes, errors in percent, times as fast; NaN where there is none."""
    points = points_where(trade, sweep=row.sweep, label=row.label)
    solved = points.isel(point=points["status"].values == 0)
    errors = [
        _over(
            np.median if name == "QV, median" else np.max, np.abs(solved[f"error_{error}"].values)
        )
        for name, error in ERRORS.items()
    ]
    ratio = solved["reference_time"].values / solved["wall_time"].values
    faster = _over(np.median, ratio)
    return [solved.sizes["point"], *(100.0 * error for error in errors), faster]


def _over(reduce: Any, values: np.ndarray) -> float:
    """Median or most of the values that are known."""
    known = values[np.isfinite(values)]
    return float(reduce(known)) if known.size else math.nan


def section(plan: AccuracyPlan, row: TableRow) -> str:
    """Which part of the table a row belongs to."""
    sweep = plan.sweeps[row.sweep]
    if sweep.kind == "model":
        return "model"
    return sweep.base if sweep.against == FIRST else sweep.against


def section_tables(trade: xr.Dataset, plan: AccuracyPlan) -> list[CheckedTable]:
    """What each simplification costs and saves."""
    tables, tolerance = [], plan.tolerance
    for name, title in SECTIONS.items():
        floor = tolerance.floor if name == "steady" else tolerance.floor_dynamic
        error = Agreement(1.05 * tolerance.error, 100.0 * floor, "%")  # and what digits round off
        columns = {
            "scenes": Agreement(1.0),
            **dict.fromkeys(ERRORS, error),
            "speed": Agreement(tolerance.time),
        }
        rows = [[r.text, *cells(trade, r)] for r in plan.table if section(plan, r) == name]
        if rows:
            tables.append(CheckedTable(title=title, axes=("what",), columns=columns, rows=rows))
    return tables


def accuracy_part(trade: xr.Dataset, plan: AccuracyPlan) -> list[str | CheckedTable]:
    """What settings and models cost and save; presets; estimates of errors against true ones."""
    tolerance = plan.tolerance
    of_table = trade["scene"].values[np.isin(trade["sweep"].values, [r.sweep for r in plan.table])]
    scenes = ", ".join(f"`{name}`" for name in plan.scenes if name in of_table)
    return [
        "## Accuracy against time",
        "Made by `snakemake -j2 accuracy` and `make accuracy-docs`; not to be edited here. Errors "
        "are absolute values relative to each scene's reference (`config/accuracy.yaml`). The "
        "first column is the median over the scenes; the others refer to the worst scene and, for "
        "a single contact, to the worse contact. All other settings are as in the reference. "
        "Speeds are relative to that reference: medians over the scenes, with compiled code on an "
        f"idle machine. Scenes: {scenes}.",
        f"Repeated runs agree within a factor of {tolerance.error:g} in errors and "
        f"{tolerance.time:g} in times. Errors below {100.0 * tolerance.floor:g} % (dynamic: "
        f"{100.0 * tolerance.floor_dynamic:g} %) are noise. The study checks these tables.",
        *section_tables(trade, plan),
        "Unless a row states otherwise, all models here follow the paper: slip is evaluated on the "
        "centre line, and the balance of normal forces neglects traction. A single ball would "
        "displace the race radially, so three balls represent all. With a cage, two runs that "
        "differ in the last digit diverge after some turns; only their means agree. The motion "
        "neglects the Coriolis force and the circumferential component of the normal forces. The "
        "energy account includes their work, as a share of the heat: "
        f"{booked(trade)}. {of_weight(trade)}",
        presets(trade),
        "Errors are those of the life for steady solves and of the loss rate for dynamic ones, "
        "relative to each scene's reference. QV of a single contact is far more sensitive than "
        "total QV. Speeds compare draft with standard, and standard with reference.",
        estimates(trade),
        "All points with an error estimate are included, even the extremes of the sweeps. An error "
        "counts as covered if it exceeds its estimate by no more than the uncertainty of the "
        'reference (its own estimate plus its check). "Over error" is the median ratio of estimate '
        "to error.",
    ]


def of_weight(trade: xr.Dataset) -> str:
    """What a cage wears without its weight, over what it wears with it."""
    points = points_where(trade, sweep="weight")
    ratios = 1.0 + points["error_cage_wear_rate"].values[1::2]  # each against the point before it
    return f"Over the averaged turns, a weightless cage wears {span(ratios)} times as much."


def booked(trade: xr.Dataset) -> str:
    """Work of the forces left out, over the heat: the most of all scenes."""
    points = points_where(trade, sweep="long", label="reference")
    texts = []
    for name, text in (("coriolis", "Coriolis"), ("azimuth", "circumferential")):
        most = _over(np.max, np.abs(points[f"{name}_energy_share"].values))
        texts.append(f"{text} up to {_PERCENT.text(most)} %")
    return ", ".join(texts)


def presets(trade: xr.Dataset) -> CheckedTable:
    """Errors of draft and standard in each scene, and the time they save."""
    rows: list[list] = []
    for sweep, last in (("steady", "life"), ("dynamic", "wear_rate")):
        points = points_where(trade, sweep=f"preset_{sweep}")
        for scene in names(points, "scene"):
            here = {
                label: points_where(points, scene=scene, label=label).isel(point=0)
                for label in ("draft", "standard", "reference")
            }
            for (preset, one), slower in zip(here.items(), [*here.values()][1:], strict=False):
                errors = [
                    100.0 * abs(float(one[f"error_{name}"]))
                    for name in ("total_qv", "contact_qv", last)
                ]
                speed = float(slower["wall_time"] / one["wall_time"])
                rows.append([sweep, scene, preset, *errors, speed])
    columns = dict.fromkeys(("QV", "contact", "life"), LOOSE_ERROR) | {"speed": LOOSE}
    title, axes = "The presets, scene by scene", ("solve", "scene", "preset")
    return CheckedTable(title=title, axes=axes, columns=columns, rows=rows)


def estimates(trade: xr.Dataset) -> CheckedTable:
    """How often the estimates that results carry are above the true error."""
    quantities = {"total_qv": "QV", "residual_preload": "preload", "wear_rate": "wear rate"}
    columns = {"points": LOOSE, "covered": LOOSE_ERROR, "over error": LOOSE}
    rows = []
    for name, text in (quantities | {"life": "life"}).items():
        for solve, against in (("steady", "steady"), ("dynamic", "long")):
            points = points_where(trade, against=against, kind="numerical")
            error = np.abs(points[f"error_{name}"].values)
            doubt = {s: doubts(trade, s, against, name) for s in set(points["scene"].values)}
            estimate = points[f"estimate_{name}"].values
            least = error - [doubt[s] for s in points["scene"].values]
            both = np.isfinite(error) & np.isfinite(estimate)
            error, estimate, least = error[both], estimate[both], least[both]
            share = 100.0 * np.mean(estimate >= least) if both.any() else math.nan
            over = _over(np.median, estimate / np.maximum(error, 1e-9))
            rows.append([text, solve, int(both.sum()), float(share), over])
    title, axes = "Estimated and true errors", ("estimate of", "solve")
    return CheckedTable(title=title, axes=axes, columns=columns, rows=rows)


def doubts(trade: xr.Dataset, scene: str, reference: str, name: str) -> float:
    """Doubt of a reference: its own error estimate and the difference of its check."""
    points = points_where(trade, scene=scene, sweep=reference)
    own = points_where(points, label="reference")[f"estimate_{name}"].values
    other = np.abs(points_where(points, label="check")[f"error_{name}"].values)
    return float(np.nansum(own) + np.nansum(other))
