"""The sheet and the figure of a warm-up."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import variable_values
from bearingwear.kernels.status import OK, STATUS_NAMES, STATUS_SENTENCES
from bearingwear.measures import plain
from bearingwear.plotting.drawing import Figure, frame, key, new_figure
from bearingwear.results.units import display
from bearingwear.results.words import plain_scene
from bearingwear.scene.new.minimum_preload import minimum_preload_lines
from bearingwear.solvers.thermal import LOW_MARGIN
from bearingwear.studies.warmup.result import ENDINGS, PEAKS

PART_WORDS = ("inner ring", "balls", "outer ring")
_COLOURS = ("C3", "C1", "C0")  # of the parts
_LINE_STYLES = ("-", "--")  # of two bearings
_LINEAR = 1.0  # s: the axis of time is linear at least up to here


def warm_up_sheet(file: Any) -> Document:
    """Returns the sheet of a warm-up: its end, peaks with their times, and thermal margin.

    file: open netCDF file of `warm_up_dataset`.
    """
    scene = json.loads(file.scene)
    ending = ENDINGS[int(variable_values(file, "ending"))]
    times = _course_times(file.course)
    speed_text = f"{plain(scene['operation']['shaft_speed_rpm'], 6)} r/min"
    if len(times) == 1:
        course = f"at {speed_text} from the start"
    else:
        course = f"{speed_text} after {plain(times[-1])} s"
    summary = f"{scene['name']}: {_ending_sentence(file, ending)}"
    heading = (summary, course, *minimum_preload_lines(scene))
    facts = {"kind": "warm-up", "scene": scene["name"], "ending": ending}
    lines = Block("", lines=tuple(_closing_lines(file, ending)))
    return Document(heading, facts, (_peaks_block(file), _temperatures_block(file), lines))


def _course_times(course: np.ndarray) -> np.ndarray:
    """Returns the times (n,) [s] of the course of the speed in a file of a warm-up.

    A single time, 0, stands for the full speed from the start.

    course: attribute (2 n,): the times, then the shares of the full speed at these times.
    """
    return np.reshape(np.atleast_1d(course), (2, -1))[0]


def _peaks_block(file: Any) -> Block:
    """Returns a table of the peaks, their times [s] and the last values.

    Peaks that the file lacks, such as those of a spring, have no row. Peak and last value are in a
    unit chosen for the peak.
    """
    rows = []
    for name, (units, words) in PEAKS.items():
        if f"peak_{name}" not in file.variables:
            continue
        peak = float(variable_values(file, f"peak_{name}"))
        time = float(variable_values(file, f"peak_{name}_time"))
        last = float(variable_values(file, f"end_{name}"))
        unit = display(units, peak)
        cells = (float(unit.of(peak)), time, float(unit.of(last)))
        rows.append(Row(words, unit.unit, cells, f"peak_{name}"))
    return Block("peaks", ("largest", "at time, s", "at the end"), tuple(rows))


def _temperatures_block(file: Any) -> Block:
    """Returns a table of the last temperatures [degC]: a row for each part, a column a bearing."""
    T = variable_values(file, "part_temperature")[-1]
    columns = tuple(f"bearing {k + 1}" for k in range(len(T))) if len(T) > 1 else ("",)
    rows = [Row(part, "degC", tuple(T[:, k].tolist())) for k, part in enumerate(PART_WORDS)]
    return Block("temperatures at the end", columns, tuple(rows))


def _closing_lines(file: Any, ending: str) -> list[str]:
    """Returns lines on the rise of the temperatures, their stability and the numerical error.

    They include warnings: of a spring at its stop, and of a thermal margin little above 1.

    ending: one of `ENDINGS`; the line on the rise is left out where there was no state.
    """
    lines = []
    if ending in ("steady", "duration"):
        seconds = float(variable_values(file, "time_to_95_percent"))
        lines.append(f"95 % of the temperature rise after {plain(seconds)} s")
    lines += _stop_lines(file)
    margin = float(variable_values(file, "thermal_margin"))
    if np.isfinite(margin):
        stable = "stable" if margin > 1.0 else "UNSTABLE"
        lines.append(f"thermal margin {plain(margin)} at the end: {stable}")
        if 1.0 < margin < LOW_MARGIN:
            lines.append(
                f"warning: thermal margin below {LOW_MARGIN:g}: a little more heat or less cooling "
                "makes the temperatures run away"
            )
    error = 100.0 * float(variable_values(file, "error_estimate"))
    return [*lines, f"numerical error of the peaks: {plain(error, 2)} %"]


def _stop_lines(file: Any) -> list[str]:
    """Returns a line on when the spring is compressed to its stop; no line if it never is."""
    stop_um = (json.loads(file.scene).get("arrangement") or {}).get("stop_um")
    if stop_um is None or "spring_travel" not in file.variables:
        return []
    on_stop = np.flatnonzero(-variable_values(file, "spring_travel") >= 1e-6 * stop_um)
    if not on_stop.size:
        return []
    time = plain(float(variable_values(file, "time")[on_stop[0]]))
    return [
        f"warning: arrangement.stop_um {stop_um:g} is reached after {time} s: the pair is rigid "
        "from then on"
    ]


def _ending_sentence(file: Any, ending: str) -> str:
    """Returns the words for how a warm-up ended, and when.

    ending: one of `ENDINGS`.
    """
    status = int(variable_values(file, "status"))
    end = plain(float(variable_values(file, "end_time")))
    if ending == "runaway":
        return f"RUNAWAY: the heat outgrows the cooling, and the bearing has no state after {end} s"
    if status != OK:
        name = STATUS_NAMES[status]
        return f"no state after {end} s ({name}: {STATUS_SENTENCES[name]})"
    return f"{'steady' if ending == 'steady' else 'followed'} after {end} s"


def warm_up_figure(warmup: xr.Dataset) -> Figure:
    """Returns a figure of temperatures, preload and contact pressure over time.

    The axis of time is logarithmic once the machine is at speed, from 1 s on at the soonest. Lines
    of a second bearing are dashed.

    warmup: dataset of `warm_up_dataset`.
    """
    figure, panels = new_figure(1, 3, 10.0, 3.2)
    temperature, preload, pressure = panels[0]
    time = warmup["time"].values
    bearings = warmup.sizes["side"]
    at_speed = max(_course_times(warmup.attrs["course"])[-1], _LINEAR)
    for k, style in enumerate(_LINE_STYLES[:bearings]):
        bearing = warmup.isel(side=k)
        for part, colour in enumerate(_COLOURS):
            temperature.plot(time, bearing["part_temperature"][:, part], style, color=colour)
        preload.plot(time, bearing["residual_preload"], style, color="black")
        pressure.plot(time, 1e-9 * bearing["maximum_pressure"], style, color="black")
    for panel, words in zip(
        panels[0], ("temperature (°C)", "preload (N)", "contact pressure (GPa)"), strict=True
    ):
        panel.set_xscale("symlog", linthresh=at_speed)
        panel.set_xlim(left=0.0)
        panel.set_xlabel(f"time (s), logarithmic from {plain(at_speed)} s")
        panel.set_ylabel(words)
    handles = [key(part, color=colour) for part, colour in zip(PART_WORDS, _COLOURS, strict=True)]
    if bearings > 1:
        handles += [
            key(f"bearing {k}", color="k", linestyle=style)
            for k, style in enumerate(_LINE_STYLES, 1)
        ]
    frame(figure, _figure_title(warmup), handles, len(handles))
    return figure


def _figure_title(warmup: xr.Dataset) -> str:
    """Returns a title that says how a warm-up ended, and its largest preload.

    warmup: dataset of `warm_up_dataset`.
    """
    name = plain_scene(warmup)["name"]
    ending = ENDINGS[int(warmup["ending"])]
    end = plain(float(warmup["end_time"]))
    peak = plain(float(warmup["peak_residual_preload"]))
    peak_time = plain(float(warmup["peak_residual_preload_time"]))
    return f"{name}: warm-up, {ending} after {end} s; largest preload {peak} N at {peak_time} s"
