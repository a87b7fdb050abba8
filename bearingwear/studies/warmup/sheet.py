"""The sheet and the figure of a warm-up."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import values
from bearingwear.kernels.status import OK, STATUS_NAMES, STATUS_SENTENCES
from bearingwear.measures import plain
from bearingwear.plotting.drawing import Figure, frame, key, new_figure
from bearingwear.results.units import display
from bearingwear.scene.new.minimum_preload import minimum_preload_lines
from bearingwear.solvers.thermal import LOW_MARGIN
from bearingwear.studies.warmup.result import ENDINGS, PEAKS

PART_WORDS = ("inner ring", "balls", "outer ring")
_COLOURS = ("C3", "C1", "C0")
_LINEAR = 1.0  # s: the axis of time is linear at least up to here


def warm_up_sheet(file: Any) -> Document:
    """How a warm-up ends, its peaks with their times, and the thermal margin."""
    scene = json.loads(file.scene)
    ending = ENDINGS[int(values(file, "ending"))]
    end, margin = (float(values(file, name)) for name in ("end_time", "thermal_margin"))
    times, shares = np.reshape(np.atleast_1d(file.course), (2, -1))
    speed = f"{plain(scene['operation']['shaft_speed_rpm'], 6)} r/min"
    way = f"at {speed} from the start" if len(times) == 1 else f"{speed} after {plain(times[-1])} s"
    ended = f"{scene['name']}: {_ending_sentence(file, ending, end)}"
    heading = [ended, way, *minimum_preload_lines(scene)]
    rows = []
    for name, (units, words) in PEAKS.items():
        peak, time, last = (
            float(values(file, f"{kind}_{name}{more}"))
            for kind, more in (("peak", ""), ("peak", "_time"), ("end", ""))
        )
        unit = display(units, peak)
        shown = (float(unit.of(peak)), time, float(unit.of(last)))
        rows.append(Row(words, unit.unit, shown, f"peak_{name}"))
    blocks = [Block("peaks", ("largest", "at time, s", "at the end"), tuple(rows))]
    T = values(file, "part_temperature")[-1]
    columns = tuple(f"bearing {k + 1}" for k in range(len(T))) if len(T) > 1 else ("",)
    temperature = [Row(part, "degC", tuple(T[:, k].tolist())) for k, part in enumerate(PART_WORDS)]
    blocks.append(Block("temperatures at the end", columns, tuple(temperature)))
    lines = []
    if ending in ("steady", "duration"):
        seconds = float(values(file, "time_to_95_percent"))
        lines.append(f"95 % of the temperature rise after {plain(seconds)} s")
    if np.isfinite(margin):
        stable = "stable" if margin > 1.0 else "UNSTABLE"
        lines.append(f"thermal margin {plain(margin)} at the end: {stable}")
        if 1.0 < margin < LOW_MARGIN:
            lines.append(
                f"warning: thermal margin below {LOW_MARGIN:g}: a little more heat or less cooling "
                "makes the temperatures run away"
            )
    error = 100.0 * float(values(file, "error_estimate"))
    lines.append(f"numerical error of the peaks: {plain(error, 2)} %")
    facts = {"kind": "warm-up", "scene": scene["name"], "ending": ending}
    return Document(tuple(heading), facts, (*blocks, Block("", lines=tuple(lines))))


def _ending_sentence(file: Any, ending: str, end: float) -> str:
    status = int(values(file, "status"))
    if ending == "runaway":
        return (
            f"RUNAWAY: the heat outgrows the cooling, and the bearing has no state after "
            f"{plain(end)} s"
        )
    if status != OK:
        name = STATUS_NAMES[status]
        return f"no state after {plain(end)} s ({name}: {STATUS_SENTENCES[name]})"
    return f"{'steady' if ending == 'steady' else 'followed'} after {plain(end)} s"


def warm_up_figure(found: xr.Dataset) -> Figure:
    """Temperatures, preload and contact pressure over time, which is logarithmic once at speed."""
    figure, panels = new_figure(1, 3, 10.0, 3.2)
    temperature, preload, pressure = panels[0]
    time, bearings = found["time"].values, found.sizes["side"]
    times, _ = np.reshape(np.atleast_1d(found.attrs["course"]), (2, -1))
    at_speed = max(times[-1], _LINEAR)
    for k in range(bearings):
        one, style = found.isel(side=k), ("-", "--")[k]
        for part, colour in enumerate(_COLOURS):
            temperature.plot(time, one["part_temperature"][:, part], style, color=colour)
        preload.plot(time, one["residual_preload"], style, color="black")
        pressure.plot(time, 1e-9 * one["maximum_pressure"], style, color="black")
    for panel, words in zip(
        panels[0], ("temperature (°C)", "preload (N)", "contact pressure (GPa)"), strict=True
    ):
        panel.set_xscale("symlog", linthresh=at_speed)
        panel.set_xlim(left=0.0)
        panel.set_xlabel(f"time (s), logarithmic from {plain(at_speed)} s")
        panel.set_ylabel(words)
    handles = [key(part, color=colour) for part, colour in zip(PART_WORDS, _COLOURS, strict=True)]
    if bearings > 1:
        handles += [key(f"bearing {k + 1}", color="k", linestyle=("-", "--")[k]) for k in (0, 1)]
    scene = json.loads(found.attrs["scene"])
    ending = ENDINGS[int(found["ending"])]
    peak, at = float(found["peak_residual_preload"]), float(found["peak_residual_preload_time"])
    title = f"{scene['name']}: warm-up, {ending} after {plain(float(found['end_time']))} s; "
    frame(figure, f"{title}largest preload {plain(peak)} N at {plain(at)} s", handles, len(handles))
    return figure
