"""Figures of dynamic cases: compared with the steady ones, and averages as they settle."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from bearingwear.kernels.status import OK, STATUS_NAMES
from bearingwear.measures import plain
from bearingwear.plotting.drawing import (
    Figure,
    draw_lines,
    failed_keys,
    frame,
    key,
    label_edges,
    list_failed,
    method_keys,
    new_figure,
    power_of_ten,
    start_at_zero,
    ten_to_the,
)
from bearingwear.results.netcdf import CaseFileError
from bearingwear.results.units import Display, display
from bearingwear.results.words import friction_text, methods, plain_scene
from bearingwear.studies.grid.figures.quasistatic import WEAR_RATE

_OF_DYNAMIC_CASES = {
    "linestyle": "none",
    "markerfacecolor": "white",
    "markersize": 6,
    "zorder": 3,
    "clip_on": False,
}
_CAGE = {
    "cage_wear_rate": ("cage pockets", "D"),
    "cage_land_wear_rate": ("cage land", "v"),
}
REFERENCE = {"color": "black", "linestyle": "none", "marker": "o"}
REFERENCE_COLUMNS = ["part", "time_s", "wear_rate_m3_s"]
PARTS = {"ball_1": "ball 1", "cage": "the cage"}
_POCKET, _LAND = "history_cage_pocket_wear_rate", "history_cage_land_wear_rate"


class RunningAverage(NamedTuple):
    """A line of the figure of running averages."""

    part: str  # of `PARTS`, which has a panel
    histories: tuple[str, ...]  # variables whose sum is averaged
    look: dict[str, Any]  # of the line


RUNNING = {
    "ball 1": RunningAverage("ball_1", ("history_ball_wear_rate",), {"color": "C2"}),
    "cage, pockets and land": RunningAverage("cage", (_POCKET, _LAND), {"color": "C3"}),
    "pockets": RunningAverage("cage", (_POCKET,), {"color": "C3", "linestyle": "--"}),
    "land": RunningAverage("cage", (_LAND,), {"color": "C3", "linestyle": ":"}),
}


def dynamic_and_steady_figure(dynamic: xr.Dataset, steady: xr.Dataset) -> Figure:
    """Returns a figure of QV and wear rates against wear, with a column for each friction.

    Steady cases are lines, dynamic ones marks.

    steady: cases of the same scene, among which is every case of `dynamic`.
    """
    frictions = dynamic["friction"].values.tolist()
    columns = len(frictions)
    cage_parts = {name: words_and_mark for name, words_and_mark in _CAGE.items() if name in dynamic}
    rows = 3 if cage_parts else 2
    figure, panels = new_figure(
        rows, columns, max(4.4, 3.6 * columns), 2.2 * rows + 0.6, sharex=True, sharey="row"
    )
    power = display("W", steady["total_qv"], dynamic["total_qv"])
    failed = False
    for column, mu in zip(panels.T, frictions, strict=True):
        dynamic_at_mu = dynamic.sel(friction=mu)
        steady_at_mu = steady.sel(friction=mu, preload_method=dynamic["preload_method"])
        failed |= _draw_both_models(column, dynamic_at_mu, steady_at_mu, power)
        for name, (_, marker) in cage_parts.items():
            draw_lines(
                column[2],
                dynamic_at_mu[name],
                "ball_diameter_loss",
                "wear rate of the cage\n",
                WEAR_RATE,
                dynamic_at_mu["status"],
                marker=marker,
                **_OF_DYNAMIC_CASES,
            )
        column[0].set_title(friction_text(mu))
    label_edges(panels)
    for panel in panels[:, 0]:
        start_at_zero(panel)
    figure.align_ylabels()
    grey = {"color": "0.3", **_OF_DYNAMIC_CASES}
    frame(
        figure,
        f"{plain_scene(dynamic)['name']}: {_agreement_sentence(dynamic, steady, bool(cage_parts))}",
        method_keys(name for name, _ in methods(dynamic))
        + [key("steady", color="0.3"), key("dynamic", marker="o", **grey)]
        + [key(f"{part}, dynamic", marker=marker, **grey) for part, marker in cage_parts.values()]
        + failed_keys(failed),
        columns=2 if columns == 1 else 4,
    )
    return figure


def _draw_both_models(
    column: np.ndarray, dynamic: xr.Dataset, steady: xr.Dataset, power: Display
) -> bool:
    """Draws QV and the mean wear rate of a ball in two panels, steady lines and dynamic marks.

    Returns whether a dynamic case is unsolved, which has a cross.

    column: panels, of which the first two are drawn in.
    dynamic, steady: cases over the loss and the preload method.
    power: unit of QV.
    """
    quantities = {
        "total_qv": ("QV of the bearing", power),
        "ball_wear_rate": ("wear rate of one ball\n", WEAR_RATE),
    }
    failed = False
    # a third panel is that of the cage
    for panel, (name, (label, unit)) in zip(column, quantities.items(), strict=False):
        over_balls = ["ball"] if "ball" in dynamic[name].dims else []
        draw_lines(panel, steady[name].mean(over_balls), "ball_diameter_loss", label, unit)
        failed |= draw_lines(
            panel,
            dynamic[name].mean(over_balls),
            "ball_diameter_loss",
            label,
            unit,
            dynamic["status"],
            marker="o",
            **_OF_DYNAMIC_CASES,
        )
    return failed


def _agreement_sentence(dynamic: xr.Dataset, steady: xr.Dataset, has_cage: bool) -> str:
    """Returns a sentence on the largest differences over all cases solved with both models.

    They are the magnitudes of dynamic over steady values less 1, of QV and of a ball's wear rate.

    steady: cases of the same scene, among which is every dynamic one.
    has_cage: whether the dynamic cases have a cage.
    """
    steady = steady.sel({axis: dynamic[axis] for axis in dynamic["status"].dims})
    dims_to_average: dict[str, tuple[str, ...]] = {"total_qv": (), "ball_wear_rate": ("ball",)}
    differences = [
        float(abs(dynamic[name].mean(dims) / steady[name].mean(dims) - 1.0).max())
        for name, dims in dims_to_average.items()
    ]
    if not np.isfinite(differences).all():
        return "no case was solved with both models"
    qv, wear = (f"{plain(100.0 * difference, 2)} %" for difference in differences)
    model = "with the dynamic model and the cage" if has_cage else "with the dynamic model"
    return (
        f"{model}, QV differs from the steady value by up to {qv}, and the wear rate of a ball by "
        f"up to {wear}"
    )


def running_average_figure(case: xr.Dataset, reference: str | Path | None = None) -> Figure:
    """Returns a figure of the wear rates of ball 1 and the cage, averaged from the start.

    It corresponds to Fig. 6 of Zhang, Chen, Gu and Wang (2018). Each part has a panel if the case
    or the reference has values of it; without any, there is an empty panel of ball 1. The status of
    a case that was not solved is written in the panels.

    case: dynamic case.
    reference: a table of `REFERENCE_COLUMNS` with values to draw over the averages.
    """
    is_solved = int(case["status"]) == OK
    means = {
        label: mean_so_far(_history(case, line.histories))
        for label, line in RUNNING.items()
        if is_solved and set(line.histories) <= set(case)
    }
    reference_points = reference_values(reference) if reference else {}
    parts_with_means = {RUNNING[label].part for label in means}
    parts = [
        part for part in PARTS if part in parts_with_means or len(reference_points.get(part, ()))
    ]
    parts = parts or ["ball_1"]
    figure, panels = new_figure(1, len(parts), 3.6 * max(len(parts), 1.5), 3.6)
    time_unit = display("s", *(mean["time"] for mean in means.values()))
    messages = []
    for panel, part in zip(panels[0], parts, strict=True):
        part_means = {label: mean for label, mean in means.items() if RUNNING[label].part == part}
        points = reference_points.get(part, np.empty((0, 2)))
        _draw_running_averages(panel, part_means, points, time_unit)
        panel.set_title(PARTS[part])
        if part_means:
            whole_part = next(iter(part_means.values()))  # the first of its part in `RUNNING`
            messages.append(_change_phrase(part, whole_part, _turn_duration(case)))
        elif not is_solved:
            list_failed(panel, [STATUS_NAMES[int(case["status"])]])
    keys = [key(label, **RUNNING[label].look) for label in means]
    if any(len(points) for points in reference_points.values()):
        keys.append(key(f"reference: {Path(str(reference)).stem}", **REFERENCE))
    message = f"the last shaft turn changed the mean wear rate of {' and that of '.join(messages)}"
    frame(
        figure,
        f"{plain_scene(case)['name']}: {message if messages else 'no wear rates'}",
        keys,
        columns=max(len(keys), 1),
    )
    return figure


def _draw_running_averages(
    panel: Any, means: Mapping[str, xr.DataArray], points: np.ndarray, time_unit: Display
) -> None:
    """Draws the mean wear rates [m3/s] of a part over time, and reference values.

    means: over `time`, by the labels of `RUNNING`.
    points: reference values (n, 2), time [s] and wear rate [m3/s].
    """
    exponent = power_of_ten([*means.values(), xr.DataArray(points[:, 1])])
    for label, mean in means.items():
        panel.plot(time_unit.of(mean["time"]), 10.0**-exponent * mean, **RUNNING[label].look)
    panel.plot(time_unit.of(points[:, 0]), 10.0**-exponent * points[:, 1], **REFERENCE)
    panel.set_xlabel(time_unit.label("time"))
    panel.set_ylabel(f"mean wear rate since the start ({_wear_rate_unit(exponent)})")
    panel.set_xlim(left=0.0)
    start_at_zero(panel)


def _history(case: xr.Dataset, names: Sequence[str]) -> xr.DataArray:
    """Returns the sum of histories of a case over `time`, of ball 1 where each ball has its own."""
    rates = case[list(names)].astype(float)
    rates = rates.isel(ball=0) if "ball" in rates.dims else rates
    return rates.to_array("of").sum("of", skipna=False)


def mean_so_far(rate: xr.DataArray) -> xr.DataArray:
    """Returns the mean of a history from the start to each instant.

    A wear rate of a history is the mean over the interval that ends at its instant, and all
    intervals are equally long.
    """
    return rate.copy(data=np.cumsum(rate.values) / np.arange(1, rate.size + 1))


def _change_phrase(part: str, mean: xr.DataArray, turn: float) -> str:
    """Returns a phrase on how much the last shaft turn changed a mean, in percent with a sign.

    A dash stands for the percentage where the mean was 0 before that turn.

    mean: over `time` [s], of a part of `PARTS`.
    turn: duration of a turn [s].
    """
    last = float(mean[-1])
    before_turn = float(np.interp(float(mean["time"][-1]) - turn, mean["time"], mean))
    change = "– %"
    if before_turn > 0.0:
        change = f"{plain(100.0 * (last / before_turn - 1.0), 2, '+')} %"
    return f"{PARTS[part]} by {change.replace('-', '−')}"


def _turn_duration(case: xr.Dataset) -> float:
    """Returns the duration [s] of a turn of the shaft, or of the outer race if that is faster.

    case: dynamic case.
    """
    operation = plain_scene(case)["operation"]
    speeds_rpm = operation["shaft_speed_rpm"], operation.get("outer_speed_rpm", 0.0)
    return 60.0 / max(map(abs, speeds_rpm))


def reference_values(path: str | Path) -> dict[str, np.ndarray]:
    """Returns the values (n, 2) of each part in a table: time [s] and wear rate [m3/s].

    path: CSV file with the header `REFERENCE_COLUMNS`; lines that begin with # are comments.
    CaseFileError: a file that cannot be read, or has other columns or parts.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeError) as error:
        raise CaseFileError(f"{path}: cannot be read ({error})") from None
    rows = list(csv.reader(line for line in text.splitlines() if line and line[0] != "#"))
    if not rows or rows[0] != REFERENCE_COLUMNS:
        header = ",".join(REFERENCE_COLUMNS)
        raise CaseFileError(f"{path}: expected a table with the header {header}")
    points_by_part: dict[str, list[tuple[float, float]]] = {part: [] for part in PARTS}
    for row in rows[1:]:
        try:
            part, time, rate = row
            points_by_part[part].append((float(time), float(rate)))
        except (KeyError, ValueError):
            raise CaseFileError(
                f"{path}: got {','.join(row)}, expected {' or '.join(PARTS)}, then two numbers"
            ) from None
    return {part: np.array(points).reshape(-1, 2) for part, points in points_by_part.items()}


def _wear_rate_unit(exponent: int) -> str:
    """Returns the unit of 10^exponent m3/s as text."""
    return f"{ten_to_the(exponent)}\N{NO-BREAK SPACE}m³/s" if exponent else "m³/s"
