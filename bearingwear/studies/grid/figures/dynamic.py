"""Figures of dynamic cases: compared with the steady ones, and averages as they settle."""

import csv
from collections.abc import Sequence
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
from bearingwear.results.units import display
from bearingwear.results.words import friction_text, methods, plain_scene
from bearingwear.studies.grid.figures.quasistatic import WEAR_RATE

IN_TIME = {
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

    part: str
    histories: tuple[str, ...]  # to add
    look: dict[str, Any]


RUNNING = {
    "ball 1": RunningAverage("ball_1", ("history_ball_wear_rate",), {"color": "C2"}),
    "cage, pockets and land": RunningAverage("cage", (_POCKET, _LAND), {"color": "C3"}),
    "pockets": RunningAverage("cage", (_POCKET,), {"color": "C3", "linestyle": "--"}),
    "land": RunningAverage("cage", (_LAND,), {"color": "C3", "linestyle": ":"}),
}


def beside_steady_figure(study: xr.Dataset, dynamic: xr.Dataset) -> Figure:
    """Draws QV and wear rates against wear: steady cases as lines, dynamic ones as marks.

    study: steady cases of a scene; every case of `dynamic` is among them.
    """
    frictions = dynamic["friction"].values.tolist()
    parts = {name: look for name, look in _CAGE.items() if name in dynamic}
    rows, columns = 3 if parts else 2, len(frictions)
    figure, panels = new_figure(
        rows, columns, max(4.4, 3.6 * columns), 2.2 * rows + 0.6, sharex=True, sharey="row"
    )
    power = display("W", study["total_qv"], dynamic["total_qv"])
    rows_of = {
        "total_qv": ("QV of the bearing", power),
        "ball_wear_rate": ("wear rate of one ball\n", WEAR_RATE),
    }
    failed = False
    for column, mu in zip(panels.T, frictions, strict=True):
        dynamic_at_mu = dynamic.sel(friction=mu)
        steady_at_mu = study.sel(friction=mu)
        for data, look in ((steady_at_mu, {}), (dynamic_at_mu, IN_TIME | {"marker": "o"})):
            cases = data.sel(preload_method=dynamic_at_mu["preload_method"])
            status = cases["status"] if look else None
            for panel, (name, (label, unit)) in zip(column, rows_of.items(), strict=False):
                values = cases[name].mean("ball") if "ball" in cases[name].dims else cases[name]
                failed |= draw_lines(
                    panel, values, "ball_diameter_loss", label, unit, status, **look
                )
        for name, (_, marker) in parts.items():
            look, label = IN_TIME | {"marker": marker}, "wear rate of the cage\n"
            rate, status = dynamic_at_mu[name], dynamic_at_mu["status"]
            draw_lines(column[2], rate, "ball_diameter_loss", label, WEAR_RATE, status, **look)
        column[0].set_title(friction_text(mu))
    label_edges(panels)
    for panel in panels[:, 0]:
        start_at_zero(panel)
    figure.align_ylabels()
    grey = {"color": "0.3", **IN_TIME}
    frame(
        figure,
        f"{plain_scene(dynamic)['name']}: {_agreement(study, dynamic, bool(parts))}",
        method_keys(name for name, _ in methods(dynamic))
        + [key("steady", color="0.3"), key("dynamic", marker="o", **grey)]
        + [key(f"{part}, dynamic", marker=marker, **grey) for part, marker in parts.values()]
        + failed_keys(failed),
        columns=2 if columns == 1 else 4,
    )
    return figure


def _agreement(study: xr.Dataset, dynamic: xr.Dataset, has_cage: bool) -> str:
    """States the largest differences over all cases solved with both models."""
    steady = study.sel({axis: dynamic[axis] for axis in dynamic["status"].dims})
    differences = [
        float(abs(dynamic[name].mean(over) / steady[name].mean(over) - 1.0).max())
        for name, over in (("total_qv", ()), ("ball_wear_rate", "ball"))
    ]
    if not np.isfinite(differences).all():
        return "no case was solved with both models"
    qv, wear = (f"{plain(100.0 * difference, 2)} %" for difference in differences)
    solved = "with the dynamic model and the cage" if has_cage else "with the dynamic model"
    return (
        f"{solved}, QV differs from the steady value by up to {qv}, and the wear rate of a ball by "
        f"up to {wear}"
    )


def running_average_figure(case: xr.Dataset, reference: str | Path | None = None) -> Figure:
    """Draws wear rates of ball 1 and of the cage, averaged from the start (Fig. 6).

    reference: a table of `REFERENCE_COLUMNS` with values to draw over the averages.
    """
    solved = int(case["status"]) == OK
    means = {
        label: mean_so_far(_history(case, line.histories))
        for label, line in RUNNING.items()
        if solved and set(line.histories) <= set(case)
    }
    reference_points = reference_values(reference) if reference else {}
    parts = [
        part
        for part in PARTS
        if len(reference_points.get(part, ()))
        or any(RUNNING[label].part == part for label in means)
    ] or ["ball_1"]
    figure, panels = new_figure(1, len(parts), 3.6 * max(len(parts), 1.5), 3.6)
    span = display("s", *(mean["time"] for mean in means.values()))
    messages = []
    for panel, part in zip(panels[0], parts, strict=True):
        part_means = {label: mean for label, mean in means.items() if RUNNING[label].part == part}
        points = reference_points.get(part, np.empty((0, 2)))
        unit = power_of_ten([*part_means.values(), xr.DataArray(points[:, 1])])
        for label, mean in part_means.items():
            panel.plot(span.of(mean["time"]), 10.0**-unit * mean, **RUNNING[label].look)
        panel.plot(span.of(points[:, 0]), 10.0**-unit * points[:, 1], **REFERENCE)
        if part_means:
            messages.append(
                _change_phrase(part, next(iter(part_means.values())), _turn_duration(case))
            )
        elif not solved:
            list_failed(panel, [STATUS_NAMES[int(case["status"])]])
        panel.set_title(PARTS[part])
        panel.set_xlabel(span.label("time"))
        panel.set_ylabel(f"mean wear rate since the start ({_unit(unit)})")
        panel.set_xlim(left=0.0)
        start_at_zero(panel)
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


def _history(case: xr.Dataset, names: Sequence[str]) -> xr.DataArray:
    """Returns the sum of histories of a case, those of ball 1 where each ball has its own."""
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
    """States by how much the last shaft turn changed a mean."""
    last = float(mean[-1])
    before_turn = float(np.interp(float(mean["time"][-1]) - turn, mean["time"], mean))
    change = "– %"
    if before_turn > 0.0:
        change = f"{plain(100.0 * (last / before_turn - 1.0), 2, '+')} %"
    return f"{PARTS[part]} by {change.replace('-', '−')}"


def _turn_duration(case: xr.Dataset) -> float:
    """Returns the duration of a turn of the shaft or of a faster outer race [s]."""
    operation = plain_scene(case)["operation"]
    speeds = operation["shaft_speed_rpm"], operation.get("outer_speed_rpm", 0.0)
    return 60.0 / max(map(abs, speeds))


def reference_values(path: str | Path) -> dict[str, np.ndarray]:
    """Reads reference values by part: rows of time [s] and wear rate [m3/s]; # is a comment."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except (OSError, UnicodeError) as error:
        raise CaseFileError(f"{path}: cannot be read ({error})") from None
    rows = list(csv.reader(line for line in text.splitlines() if line and line[0] != "#"))
    if not rows or rows[0] != REFERENCE_COLUMNS:
        header = ",".join(REFERENCE_COLUMNS)
        raise CaseFileError(f"{path}: expected a table with the header {header}")
    values_of_part: dict[str, list[tuple[float, float]]] = {part: [] for part in PARTS}
    for row in rows[1:]:
        try:
            part, time, rate = row
            values_of_part[part].append((float(time), float(rate)))
        except (KeyError, ValueError):
            raise CaseFileError(
                f"{path}: got {','.join(row)}, expected {' or '.join(PARTS)}, then two numbers"
            ) from None
    return {part: np.array(values).reshape(-1, 2) for part, values in values_of_part.items()}


def _unit(exponent: int) -> str:
    """Writes the unit of a wear rate that is divided by a power of ten."""
    return f"{ten_to_the(exponent)}\N{NO-BREAK SPACE}m³/s" if exponent else "m³/s"
