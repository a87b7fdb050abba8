"""The sheet and the figure of a warm-up."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import xarray as xr

from bearingwear.document.document import Block, Document, Row
from bearingwear.document.rows import values
from bearingwear.kernels.status import OK, STATUS_NAMES, sentence_of
from bearingwear.measures import plain
from bearingwear.plotting.drawing import Figure, frame, new_figure
from bearingwear.results.units import display
from bearingwear.studies.warmup.result import ENDINGS, PEAKS

LOW_MARGIN = 1.5
"""Thermal margin below which a design is warned of."""

PARTS = ("inner ring", "balls", "outer ring")
_SHOWN = {"K": "K"}


def warm_up_sheet(file: Any) -> Document:
    """How a warm-up ends, its peaks with their times, and the thermal margin."""
    scene = json.loads(file.scene)
    ending = ENDINGS[int(values(file, "ending"))]
    end, margin = (float(values(file, name)) for name in ("end_time", "thermal_margin"))
    heading = [f"{scene['name']}: {_ending_sentence(file, ending, end)}"]
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
    temperature = [Row(part, "degC", tuple(T[:, k].tolist())) for k, part in enumerate(PARTS)]
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
        return f"no state after {plain(end)} s ({STATUS_NAMES[status]}: {sentence_of(status)})"
    return f"{'steady' if ending == 'steady' else 'followed'} after {plain(end)} s"


def warm_up_figure(found: xr.Dataset) -> Figure:
    """Temperatures above, preload and pressure below, over time."""
    figure, axes = new_figure(3, 1, sharex=True)
    time = found["time"].values
    for bearing in range(found.sizes["bearing"]):
        style = "-" if bearing == 0 else "--"
        one = found.isel(bearing=bearing)
        name = f" {bearing + 1}" if found.sizes["bearing"] > 1 else ""
        for k, part in enumerate(PARTS):
            axes[0].plot(time, one["part_temperature"][:, k], style, color=f"C{k}", label=part + name)
        axes[1].plot(time, one["residual_preload"], style, color="C0")
        axes[2].plot(time, 1e-9 * one["maximum_pressure"], style, color="C0")
    frame(axes[0], "", "temperature (°C)")
    return figure
