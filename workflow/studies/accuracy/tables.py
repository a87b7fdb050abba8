"""Table of all points of the study of accuracy, and its main part of docs/accuracy.md."""

import csv
import io
import itertools
import math

import numpy as np
import xarray as xr

from bearingwear.document.table import cell_text
from bearingwear.kernels.status import OK
from bearingwear.results.units import display, span
from workflow.studies.accuracy.checked_table import ROUNDED_DIGITS, Agreement, CheckedTable
from workflow.studies.accuracy.gather import distinct_texts, finite_statistic, points_where
from workflow.studies.accuracy.plan import FIRST, Plan, reference_name

_PERCENT = display("1", shown="%")
_MEDIAN = "median QV"
ERRORS = {
    _MEDIAN: "total_qv",
    "QV": "total_qv",
    "contact": "contact_qv",
    "preload": "residual_preload",
    "wear": "wear_rate",
    "life": "life",
}
SECTIONS = {
    "steady": "Numerical settings of the steady model",
    "ellipse": "Numerical settings of the steady model with slip over the ellipse",
    "short": "Numerical settings of the dynamic model over the same turns",
    "long": "Settings of the dynamic model, including turns and settling",
    "model": "Differences between models",
}
LOOSE = Agreement(10.0, 0.1)
"""Agreement of single scenes: runs with a cage diverge after some turns."""
LOOSE_ERROR = LOOSE._replace(unit="%")

_LEAST_TRUE_ERROR = 1e-9
"""Errors below this one are rounding, and count as this one in ratios."""


def points_csv(trade: xr.Dataset) -> str:
    """Returns the variables of all points as CSV, a row for each point.

    trade: all points of the study over `point`.
    """
    order = ("scene", "sweep", "kind", "against", "label", "settings")
    columns = [str(name) for name in trade if name not in (*order, "sweep_title")]
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    units = {name: str(trade[name].attrs.get("units", "")) for name in columns}
    headings = (f"{name} ({unit})" if unit else name for name, unit in units.items())
    table.writerow([*order, *headings])
    for k in range(trade.sizes["point"]):
        table.writerow(
            [str(trade[name].values[k]) for name in order]
            + [cell_text(float(trade[name].values[k]), None) for name in columns]
        )
    return text.getvalue()


def row_cells(trade: xr.Dataset, row: Plan) -> list:
    """Returns the cells of a row: number of scenes, errors [%] and relative speed.

    The number is of the scenes that were solved. Errors are magnitudes: the median of that in total
    QV over these scenes, and the largest in each quantity of `ERRORS`. The speed is the median of
    the wall time of the reference over that of the point. Errors and speed are NaN for no scene.

    trade: all points of the study over `point`.
    row: block of the plan's `table`, with `sweep` and `label`.
    """
    points = points_where(trade, sweep=row["sweep"], label=row["label"])
    solved = points.isel(point=points["status"].values == OK)
    errors = []
    for name, quantity in ERRORS.items():
        statistic = np.median if name == _MEDIAN else np.max
        errors.append(finite_statistic(statistic, np.abs(solved[f"error_{quantity}"].values)))
    ratio = solved["reference_time"].values / solved["wall_time"].values
    faster = finite_statistic(np.median, ratio)
    return [solved.sizes["point"], *(100.0 * error for error in errors), faster]


def row_section(plan: Plan, row: Plan) -> str:
    """Returns the section of the table, of `SECTIONS`, to which a block of the plan belongs.

    plan: data of config/accuracy.yaml.
    row: block of the plan's `table`.
    """
    sweep = plan["sweeps"][row["sweep"]]
    if sweep["kind"] == "model":
        return "model"
    return sweep["from"] if reference_name(sweep) == FIRST else reference_name(sweep)


def section_tables(trade: xr.Dataset, plan: Plan) -> list[CheckedTable]:
    """Returns a table of errors and speeds of settings for each section that has any.

    trade: all points of the study over `point`.
    plan: data of config/accuracy.yaml.
    """
    tolerance = plan["tolerance"]
    tables = []
    for name, title in SECTIONS.items():
        floor = tolerance["floor"] if name == "steady" else tolerance["floor_dynamic"]
        errors = Agreement(ROUNDED_DIGITS * tolerance["error"], 100.0 * floor, "%")
        columns = {
            "scenes": Agreement(1.0),
            **dict.fromkeys(ERRORS, errors),
            "speed": Agreement(tolerance["time"]),
        }
        rows = [
            [row["text"], *row_cells(trade, row)]
            for row in plan["table"]
            if row_section(plan, row) == name
        ]
        if rows:
            tables.append(CheckedTable(title=title, axes=("case",), columns=columns, rows=rows))
    return tables


def accuracy_part(trade: xr.Dataset, plan: Plan) -> list[str | CheckedTable]:
    """Returns paragraphs, and tables of settings and models, of presets and of error estimates.

    trade: all points of the study over `point`.
    plan: data of config/accuracy.yaml.
    """
    tolerance = plan["tolerance"]
    table_sweeps = [row["sweep"] for row in plan["table"]]
    scenes_in_table = trade["scene"].values[np.isin(trade["sweep"].values, table_sweeps)]
    scenes = ", ".join(f"`{name}`" for name in plan["scenes"] if name in scenes_in_table)
    return [
        "## Accuracy against time",
        "Generated by `snakemake -j2 accuracy` and `make accuracy-docs`; do not edit. Each error "
        "is the magnitude of the relative difference from the scene's reference solution "
        '(`config/accuracy.yaml`). "Median QV" is the median error in QV over the scenes; all '
        'other errors are those in the worst scene. "Contact" is the error in QV at the worse of '
        "the two contacts. Settings that are not named in a row are those of the reference "
        'solution. "Speed" is the median speed over the scenes relative to that of the reference '
        "solution, measured with compiled code on an idle machine. Scenes: "
        f"{scenes}.",
        f"Errors below {100.0 * tolerance['floor']:g} % "
        f"({100.0 * tolerance['floor_dynamic']:g} % in all tables except the first) are regarded "
        "as noise. The study fails if any larger error differs from its value in these tables by "
        f"more than a factor of {tolerance['error']:g}, or if a time differs by more than a factor "
        f"of {tolerance['time']:g}; for the last two tables, both factors are {LOOSE.factor:g}.",
        *section_tables(trade, plan),
        "Unless a table or row states otherwise, all models here follow the paper: slip is "
        "evaluated on the centre line, and the balance of normal forces neglects traction. In "
        "dynamic runs under pure thrust, three balls represent the full set, because a single ball "
        "would displace the race radially. With a cage, two runs that initially differ only in the "
        "last digit diverge after some turns, and only their means agree. The equations of motion "
        "neglect the Coriolis force and the circumferential component of the normal forces. The "
        "energy balance includes the work done by these neglected forces. The largest values of "
        f"this work, relative to the heat, are {neglected_work_words(trade)}. "
        f"{weight_sentence(trade)}",
        presets_table(trade),
        '"Life" is the error in life for steady solves, and the error in the loss rate for dynamic '
        "solves. Errors are relative to each scene's reference solution. QV at a single contact is "
        "far more sensitive to the settings than total QV is. The speed of `draft` is relative to "
        "that of `standard`, and the speed of `standard` is relative to that of `reference`.",
        estimates_table(trade),
        "All points with an error estimate are included, even those at the extremes of the sweeps. "
        "An error counts as covered if it exceeds its estimate by no more than the uncertainty of "
        "the reference solution. This uncertainty is the sum of the reference solution's own error "
        'estimate and its difference from a check solution. "Estimate/error" is the median ratio '
        "of the estimate to the error.",
    ]


def weight_sentence(trade: xr.Dataset) -> str:
    """Returns a sentence on the wear rate of a cage without weight, relative to one with weight.

    trade: all points of the study over `point`.
    """
    points = points_where(trade, sweep="weight")
    # of each scene: a point with weight, then one without, whose error is against the former
    ratios = 1.0 + points["error_cage_wear_rate"].values[1::2]
    times = f"{span(ratios)} times as fast as a cage with weight"
    return f"Over the averaged turns, a weightless cage wears {times}."


def neglected_work_words(trade: xr.Dataset) -> str:
    """Returns words for the largest work of each neglected force over the scenes, over the heat.

    trade: all points of the study over `point`.
    """
    points = points_where(trade, sweep="long", label="reference")
    force_words = {
        "coriolis_energy_share": "Coriolis force",
        "azimuth_energy_share": "circumferential component",
    }
    texts = []
    for name, words in force_words.items():
        largest = finite_statistic(np.max, np.abs(points[name].values))
        texts.append(f"{_PERCENT.text(largest)} % for the {words}")
    return " and ".join(texts)


def presets_table(trade: xr.Dataset) -> CheckedTable:
    """Returns a table of the errors of draft and standard in each scene, and of their speeds.

    Errors are magnitudes in percent. The speed is relative to that of the next finer preset.

    trade: all points of the study over `point`.
    """
    rows: list[list] = []
    for solve, quantity in (("steady", "life"), ("dynamic", "wear_rate")):
        points = points_where(trade, sweep=f"preset_{solve}")
        for scene in distinct_texts(points, "scene"):
            point_by_preset = {
                preset: points_where(points, scene=scene, label=preset).isel(point=0)
                for preset in ("draft", "standard", "reference")
            }
            for preset, finer_preset in itertools.pairwise(point_by_preset):
                point = point_by_preset[preset]
                errors = [
                    100.0 * abs(float(point[f"error_{name}"]))
                    for name in ("total_qv", "contact_qv", quantity)
                ]
                speed = float(point_by_preset[finer_preset]["wall_time"] / point["wall_time"])
                rows.append([solve, scene, preset, *errors, speed])
    return CheckedTable(
        title="Presets by scene",
        axes=("solve", "scene", "preset"),
        columns=dict.fromkeys(("QV", "contact", "life"), LOOSE_ERROR) | {"speed": LOOSE},
        rows=rows,
    )


def estimates_table(trade: xr.Dataset) -> CheckedTable:
    """Returns a table of how often the error estimates of results cover the true error.

    trade: all points of the study over `point`.
    """
    quantities = {
        "total_qv": "QV",
        "residual_preload": "preload",
        "wear_rate": "wear rate",
        "life": "life",
    }
    rows = [
        [text, solve, *_estimate_cells(trade, name, reference)]
        for name, text in quantities.items()
        for solve, reference in (("steady", "steady"), ("dynamic", "long"))
    ]
    return CheckedTable(
        title="Estimated and true errors",
        axes=("estimate of", "solve"),
        columns={"points": LOOSE, "covered": LOOSE_ERROR, "estimate/error": LOOSE},
        rows=rows,
    )


def _estimate_cells(trade: xr.Dataset, name: str, reference: str) -> tuple[int, float, float]:
    """Returns how many points have an estimate, the share [%] covered, and estimate over error.

    An error is covered if it exceeds its estimate by no more than the reference's uncertainty. The
    last value is the median ratio, where errors count as at least `_LEAST_TRUE_ERROR`. Without any
    point, share and ratio are NaN.

    trade: all points of the study over `point`.
    name: of the quantity.
    reference: name of the reference of the points.
    """
    points = points_where(trade, against=reference, kind="numerical")
    scenes = points["scene"].values
    error = np.abs(points[f"error_{name}"].values)
    estimate = points[f"estimate_{name}"].values
    uncertainties = {
        scene: reference_uncertainty(trade, scene, reference, name) for scene in set(scenes)
    }
    least_error = error - [uncertainties[scene] for scene in scenes]
    has_both = np.isfinite(error) & np.isfinite(estimate)
    is_covered = (estimate >= least_error)[has_both]
    share = 100.0 * float(np.mean(is_covered)) if has_both.any() else math.nan
    ratios = estimate / np.maximum(error, _LEAST_TRUE_ERROR)
    return int(has_both.sum()), share, finite_statistic(np.median, ratios[has_both])


def reference_uncertainty(trade: xr.Dataset, scene: str, reference: str, name: str) -> float:
    """Returns the relative uncertainty of a reference on a scene, in a quantity of a name.

    It is the reference's error estimate plus the magnitude of its difference from its check. Either
    counts as 0 where it is missing.

    trade: all points of the study over `point`.
    """
    points = points_where(trade, scene=scene, sweep=reference)
    estimates = points_where(points, label="reference")[f"estimate_{name}"].values
    differences = np.abs(points_where(points, label="check")[f"error_{name}"].values)
    return float(np.nansum(estimates) + np.nansum(differences))
